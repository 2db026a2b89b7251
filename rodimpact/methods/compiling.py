"""How kernels become machine code: by numba, through its public names.

A kernel module holds plain functions, integer constants and tables of numbers (nested
lists), and imports other kernel modules as modules. Plain Python runs it unchanged. For
machine code it has a twin, a copy in which every function is jitted and every table is
an array. The state of a kernel is lists of records, see `record_lists`.

Numba counts the references to the arrays of a function, with atomic operations, unless
it can prove that the last use of each array is in one place that is always reached, and
that no earlier call can raise. So a kernel that runs often returns only at its end, and
has no last use of an array behind a condition; the loops around it have such uses. Or
it gets arrays that are `borrowed`, whose references are not counted.
"""

import contextlib
import functools
import gc
import hashlib
import sys
import threading
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CellType, FunctionType, ModuleType
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
Kernel = Callable[..., Any]
Functions = tuple[tuple[int, Any], ...]
"""Pairs (number, function) of the user's functions.

They replace `user_force`, whose first argument is the number.
"""

OPTIONS = {
    "error_model": "numpy",  # division by zero gives inf, as the kernels expect
    "nogil": True,  # threads run in parallel
    "no_rewrites": True,  # no search for array expressions, which kernels do not have
}
"""Options of numba for every kernel."""

INNER = OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of numba for functions that only kernels call.

Without wrappers for calls from Python or C they compile faster.
"""

OPTIMISATION_LEVEL = 2
"""Optimisation level of LLVM for kernels.

Level 3, numba's default, takes longer to compile, and its code is no faster.
"""

LARGE_FRAME = 1 << 15
"""Size of a stack frame, in words, that exceeds a chunk of CPython's stack."""

ONE_AT_A_TIME = threading.RLock()
"""Lock for threads that start numba or compile; a forking thread waits for it, too."""


def compiler() -> Any:
    """Import numba, and return the module; an error of its start is raised."""
    with ONE_AT_A_TIME:
        import numba

        return numba


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Context without the garbage collector; afterwards its former setting applies.

    Numba makes millions of objects that remain in use. Collecting would search them,
    and take a seventh of the time of compiling.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextlib.contextmanager
def optimised_for_kernels() -> Iterator[None]:
    """Context in which numba compiles at `OPTIMISATION_LEVEL` at most.

    A lower level, set by the environment variable NUMBA_OPT, is kept. Afterwards the
    previous level applies again. Numba documents NUMBA_OPT, and that `numba.config` has
    its value as `OPT`; it reads this value whenever it compiles.
    """
    config = compiler().config
    previous = config.OPT
    if previous > OPTIMISATION_LEVEL:
        # The level must be an object of numba's own class of levels.
        config.OPT = type(previous)(OPTIMISATION_LEVEL)
    try:
        yield
    finally:
        config.OPT = previous


def _call(function: Kernel, argument: Any) -> None:
    """Call a function with an argument."""
    function(argument)


call_on_deep_stack = FunctionType(
    _call.__code__.replace(co_stacksize=LARGE_FRAME), globals()
)
"""Call a function with an argument, with room on the stack for a thousand frames.

CPython keeps the frames of Python functions in chunks of 16 kB. A call that crosses the
end of a chunk allocates the next chunk, and its return frees it. Numba makes so many
calls at a depth where this happens that it took a quarter of the time of compiling. For
a frame larger than a chunk, CPython allocates a chunk twice as large as the frame, so
that the frames of all inner calls fit into the rest of it.

`code.replace` is documented; the chunks are an implementation detail of CPython 3.11 to
3.14. If it changes, compiling takes longer, and nothing else changes.
"""


class DamagedCache(UserWarning):
    """Machine code on disk cannot be read, and is compiled again.

    Examples
    --------
    A program that stops instead:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ri.DamagedCache)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


class Compiled:
    """A kernel as machine code, which is compiled or read from disk at the first call.

    Attributes
    ----------
    place : str
        Directory of its machine code; "" if the code is not stored on disk.
    """

    def __init__(self, kernel: Any, user_functions: Functions = ()) -> None:
        """Prepare the machine code of a kernel; nothing is compiled or read yet.

        With functions of the user, the code will not be stored on disk.
        """
        self._twin = _entry(kernel, user_functions)
        self._make(keep=not user_functions)

    def _make(self, keep: bool) -> None:
        """Set `_fast`, the jitted function, and `place`, the directory of its code.

        Nothing is compiled or read yet: `_ready` becomes False. If `keep` is false, or
        if numba finds no writable directory, the code is not stored on disk: each
        process compiles it, and `place` is "".
        """
        njit = compiler().njit
        options = {"no_cfunc_wrapper": True, **OPTIONS}
        self._fast: Any = njit(**options)(self._twin)
        if keep:
            # Numba raises RuntimeError if it finds no directory: `_fast` is then the
            # function without a cache.
            with contextlib.suppress(RuntimeError):
                self._fast = njit(cache=True, **options)(self._twin)
        self.place: str = self._fast.stats.cache_path or ""
        self._ready = False

    def __call__(self, *arguments: Any) -> Any:
        """Run the machine code with these arguments, and return its result.

        At the first call it is read from disk, or compiled for the types of the
        arguments. If this or the run fails, the machine code on disk is assumed to be
        damaged: it is deleted with the warning DamagedCache, compiled again without
        being stored, and run. If the error is an OSError, as on a full disk, nothing is
        deleted. Errors of numba itself, and all errors of code that is not stored on
        disk, are raised.
        """
        try:
            if not self._ready:
                # Numba has a private lock; a fork must also wait for this one.
                with ONE_AT_A_TIME, uncollected(), optimised_for_kernels():
                    types = tuple(map(compiler().typeof, arguments))
                    call_on_deep_stack(self._fast.compile, types)
                self._ready = True
            return self._fast(*arguments)
        except Exception as error:
            # An error without a cache, or of numba itself, is not due to the cache.
            if not self.place or type(error).__module__.startswith("numba"):
                raise
            # If writing to the cache fails with an OSError, the disk is usually full.
            is_disk_full = isinstance(error, OSError)
            if not is_disk_full:
                self._discard_cache()
            self._make(keep=False)
            # `place` is "" now, so that a second error is raised.
            return self(*arguments)

    def _discard_cache(self) -> None:
        """Delete the index files of this kernel's machine code, and warn.

        Files that cannot be deleted remain. The warning, DamagedCache, points at the
        caller of the function that called the kernel.
        """
        for file in self.files():
            with contextlib.suppress(OSError):
                file.unlink()
        message = "machine code in the compiler's cache is damaged; it is made anew"
        # Level 1 is this function, 2 `__call__`, 3 the function that called the kernel
        # (such as `Batch.run`), and 4 its caller.
        warnings.warn(message, DamagedCache, stacklevel=4)

    def files(self) -> list[Path]:
        """Index files on disk of machine code of this kernel.

        They may belong to these sources or to other versions. The list is empty if the
        code is not stored on disk.
        """
        if not self.place:
            return []
        return list(Path(self.place).glob(f"*.{self._twin.__name__}-*.nbi"))


def compiled(kernel: Kernel, user_functions: Functions = ()) -> Compiled:
    """Return a kernel as machine code; the same arguments give the same object.

    `user_functions`, which numba has compiled, replace `user_force`.
    """
    with ONE_AT_A_TIME:
        return _compiled(kernel, user_functions)


_compiled = functools.cache(Compiled)


@functools.cache
def interpreted(kernel: Any, user_functions: Functions = ()) -> Kernel:
    """Return a kernel in plain Python, in which these functions replace `user_force`.

    Without functions it is the kernel itself; otherwise it is the function of the same
    name in a copy of its module. The same arguments give the same function.
    """
    if not user_functions:
        return kernel  # type: ignore[no-any-return]
    twin = _twin(sys.modules[kernel.__module__], user_functions)
    return getattr(twin, kernel.__name__)  # type: ignore[no-any-return]


def can_be(user_functions: Functions) -> bool:
    """Whether all of these functions are jitted by numba, so that kernels can use them.

    Without functions it is True.
    """
    return all(hasattr(function, "py_func") for _, function in user_functions)


def _entry(kernel: Any, user_functions: Functions) -> FunctionType:
    """The twin of a kernel: the Python function that numba compiles in its place.

    It has the code of the kernel. Its globals are those of a copy of the kernel's
    module in which all functions are jitted, and functions that only one other function
    uses are inlined. It closes over a digest of all sources of the kernel. Numba
    compares the values of a closure, and otherwise only the file of the kernel, with
    the code on disk. So, thanks to the digest, a change of any source compiles the
    kernel again.
    """
    module = sys.modules[kernel.__module__]
    code = kernel.__code__.replace(co_freevars=("digest",))
    # A closure is a tuple of cells, one for each name in `co_freevars`.
    digest = (CellType(f"{kernel.__name__} {digest_of(module)}"),)
    scope = vars(_twin(module, user_functions, _names_used_once(module)))
    twin = FunctionType(code, scope, kernel.__name__, kernel.__defaults__, digest)
    twin.__qualname__ = kernel.__qualname__
    twin.__module__ = kernel.__module__
    return twin


def _names_used_once(module: ModuleType) -> frozenset[str]:
    """Names that exactly one function in a kernel module and its imports uses.

    A function uses a name if the name occurs in its code, as a global or as an
    attribute.
    """
    uses: Counter[str] = Counter()  # number of functions that use each name
    for kernel_module in _with_imported_kernels(module):
        for value in vars(kernel_module).values():
            if isinstance(value, FunctionType):
                # As a set, each name counts once a function.
                uses.update(set(value.__code__.co_names))
    return frozenset(name for name, users in uses.items() if users == 1)


@functools.cache
def _twin(
    module: ModuleType, user_functions: Functions, once: frozenset[str] | None = None
) -> ModuleType:
    """Copy a kernel module, with the functions of the user in place of `user_force`.

    The kernel modules that it imports are copied as well. If `once` is None, the copy
    is for plain Python. Otherwise it is for machine code: functions are jitted, lists
    become arrays, and `borrowed` becomes its compiled form. `once` then has the names
    that only one function uses: functions with these names are inlined, as passing
    arrays to a function takes time. The same arguments give the same copy.
    """
    twin = ModuleType(module.__name__)

    def jit(function: Any, name: str = "") -> Any:
        """The function, jitted if the twin is for machine code."""
        if once is None:
            return function
        return compiler().njit(**INNER, forceinline=name in once)(function)

    for name, value in vars(module).items():
        counterpart = value  # the same for constants and functions of other modules
        if name == "user_force" and user_functions:
            counterpart = _one_of(user_functions, jit)
        elif name == "borrowed" and once is not None:
            counterpart = _borrowing()
        elif isinstance(value, FunctionType) and value.__module__ == module.__name__:
            # A copy of the function whose globals are those of the twin
            scope = vars(twin)
            copy = FunctionType(value.__code__, scope, name, value.__defaults__)
            counterpart = jit(copy, name)
        elif _is_kernel(value):  # a kernel module that this one imports
            counterpart = _twin(value, user_functions, once)
        elif isinstance(value, list) and once is not None:
            counterpart = np.array(value)
        if not name.startswith("__"):  # not `__name__`, `__doc__` and the like
            setattr(twin, name, counterpart)
    return twin


def borrowed(array: T) -> T:
    """Return the array itself; in machine code, an array without reference counts.

    See `_borrowing`.
    """
    return array


@functools.cache
def _borrowing() -> Any:
    """Return the compiled form of the kernel function `borrowed`, a jitted function.

    It takes an array, and returns another array on the same memory, which does not own
    it: numba then has no references to count. The memory must exist until the kernel
    returns, which is so because the caller of the kernel holds the original array.
    """
    numba = compiler()
    pointer = numba.types.voidptr

    # This turns an address, a whole number, into a pointer. The compiler calls an
    # intrinsic with a context and the types of its arguments; the intrinsic returns its
    # signature, and a function that generates its code.
    @numba.extending.intrinsic  # type: ignore[untyped-decorator]
    def pointer_to(_: Any, address: Any) -> Any:
        def code(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(pointer))

        # In numba, result_type(argument_type) is a signature.
        signature = pointer(address)
        return signature, code

    @numba.njit(**INNER, forceinline=True)  # type: ignore[untyped-decorator]
    def borrowed(array: Any) -> Any:
        address = pointer_to(array.ctypes.data)
        return numba.carray(address, array.shape, array.dtype)

    return borrowed


def _one_of(functions: Functions, jit: Any) -> Any:
    """Make a function of (number, d, rate) that calls the user's function of `number`.

    `functions` has at least one pair (number, function). The made function compares the
    numbers in order; for a number that is not among them it calls the last function.
    Its result is a float. `jit` is applied to all functions that are made here.
    """
    number, function = functions[0]
    other_functions = functions[1:]
    if len(other_functions) == 0:  # the last one is called for any number
        return jit(lambda _, d, rate: float(function(d, rate)))
    call_others: Any = _one_of(other_functions, jit)

    def chosen(which: int, d: float, rate: float) -> float:
        """Force of the law of number `which`."""
        if which == number:
            return float(function(d, rate))
        return float(call_others(which, d, rate))

    return jit(chosen)


def _is_kernel(value: Any) -> bool:
    """Whether a value, found in a kernel module, is another kernel module.

    It is if it is a module of this package: kernel modules import no other modules of
    it.
    """
    package = __name__.partition(".")[0]
    return isinstance(value, ModuleType) and value.__name__.startswith(f"{package}.")


def _with_imported_kernels(module: ModuleType) -> list[ModuleType]:
    """A kernel module and all kernel modules that it imports, directly or indirectly.

    The module itself comes first; each module occurs once.
    """
    modules = [module]
    for kernel_module in modules:  # the list grows during the loop
        for value in vars(kernel_module).values():
            if _is_kernel(value) and value not in modules:
                modules.append(value)
    return modules


def digest_of(module: ModuleType) -> str:
    """Digest of all sources of a kernel module, as 32 hexadecimal digits.

    The sources are all Python files in the folder of the module, in the folders of the
    kernel modules that it imports, directly or indirectly, and this file. Whole folders
    are taken because a module does not show from which files its imported constants and
    records come.
    """
    modules = _with_imported_kernels(module)
    folders = {Path(str(each.__file__)).parent for each in modules}
    files = {Path(__file__)}
    for folder in folders:
        files.update(folder.glob("*.py"))
    digest = hashlib.blake2b(digest_size=16)
    for file in sorted(files):
        digest.update(hashlib.blake2b(file.read_bytes()).digest())
    return digest.hexdigest()
