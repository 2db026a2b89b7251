"""How kernels become machine code: stock numba, by its public names.

A kernel module holds plain functions, whole constants and tables of numbers (nested
lists), and imports other kernel modules whole. Plain Python runs it as it stands.
Compiled, it has a twin in which every function is jitted and every table is an array.
State is lists of records, see `record_lists`.

Numba counts references to the arrays of a function, atomically, unless it sees that
each is last used in one place that is always reached, and that no call before may
raise. A kernel that runs often returns at its end, and uses no array for the last time
behind a condition: loops around it do that. Or it is given arrays that are `borrowed`,
of which no references are counted.
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
"""Functions of the user in place of `user_force`, by its first argument."""

OPTIONS = {
    "error_model": "numpy",  # division by zero gives inf, as the kernels expect
    "nogil": True,  # threads run side by side
    "no_rewrites": True,  # numba need not look for array expressions: kernels have none
}
"""Options of every kernel for numba."""

INNER = OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of functions that only kernels call.

Without an entry from Python they compile faster.
"""

OPTIMISATION_LEVEL = 2
"""LLVM's level for kernels.

Level 3, numba's default, takes longer, and its code is no faster.
"""

LARGE_FRAME = 1 << 15
"""Words of a stack frame that is larger than a chunk of CPython's stack."""

ONE_AT_A_TIME = threading.RLock()
"""Lock for threads that start numba or compile; a forking thread waits, too."""


def compiler() -> Any:
    """Numba, which starts now if it has not yet; raises what is wrong with it."""
    with ONE_AT_A_TIME:
        import numba

        return numba


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Context without the garbage collector; behind it, it runs if it did before.

    Numba makes millions of objects that stay; looking through them takes a seventh of
    its time.
    """
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


@contextlib.contextmanager
def optimised_for_kernels() -> Iterator[None]:
    """Context in which numba compiles at `OPTIMISATION_LEVEL`.

    It compiles at a lower level if NUMBA_OPT asks for that. Behind the context numba
    has its level again. Numba documents the variable NUMBA_OPT, and that its values are
    in `numba.config`; it reads this one whenever it compiles.
    """
    config = compiler().config
    before = config.OPT
    if before > OPTIMISATION_LEVEL:
        # `config.OPT` is a number of a class of numba's own.
        config.OPT = type(before)(OPTIMISATION_LEVEL)
    try:
        yield
    finally:
        config.OPT = before


def _call(function: Kernel, argument: Any) -> None:
    """Call a function with an argument."""
    function(argument)


call_on_deep_stack = FunctionType(
    _call.__code__.replace(co_stacksize=LARGE_FRAME), globals()
)
"""Call a function with an argument, with room on the stack for a thousand frames.

CPython keeps the frames of Python functions in chunks of 16 kB. A call that crosses the
end of a chunk allocates the next one, and its return frees it. Numba calls so deeply,
and so often at one depth, that this took a quarter of the time of compiling. A frame
larger than a chunk gets one that holds twice as much as the frame, so that all calls
below fit into it.

`code.replace` is documented; the chunks are an implementation detail of CPython 3.11 to
3.14. If that changes, compiling takes longer and nothing else changes.
"""


class DamagedCache(UserWarning):
    """Machine code on disk cannot be read, and is compiled again.

    Examples
    --------
    A program that shall stop instead:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ri.DamagedCache)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


class Compiled:
    """A kernel as machine code, made at its first call or found on disk.

    Attributes
    ----------
    place : str
        Directory of its machine code; empty if it is kept nowhere.
    """

    def __init__(self, kernel: Any, user_functions: Functions = ()) -> None:
        """Prepare the machine code of a kernel.

        It is compiled or read at the first call.
        """
        self._twin = _entry(kernel, user_functions)
        # Code that calls functions of the user is theirs, and is not kept.
        self._make(keep=not user_functions)

    def _make(self, keep: bool) -> None:
        """Set `_fast`, the machine code, and `place`, where it is kept on disk.

        Nothing is compiled or read yet: `_ready` becomes False. Without `keep`, or
        where no directory can be written, each process compiles anew, and `place` is
        empty.
        """
        njit = compiler().njit
        options = {"no_cfunc_wrapper": True, **OPTIONS}
        self._fast: Any = njit(**options)(self._twin)
        if keep:
            # Numba raises RuntimeError where it finds no directory: `_fast` stays.
            with contextlib.suppress(RuntimeError):
                self._fast = njit(cache=True, **options)(self._twin)
        self.place: str = self._fast.stats.cache_path or ""
        self._ready = False

    def __call__(self, *arguments: Any) -> Any:
        """Run the machine code with these arguments, and return what it returns.

        At the first call it is read from disk, or compiled for the types of the
        arguments. If that or the run fails, the machine code on disk is taken for
        damaged: it is deleted with a warning, compiled anew, not kept, and run. On a
        full disk nothing is deleted. Errors of numba's own, and all errors of code that
        is kept nowhere, are raised.
        """
        try:
            if not self._ready:
                # A fork waits for this lock; numba's own is private.
                with ONE_AT_A_TIME, uncollected(), optimised_for_kernels():
                    types = tuple(map(compiler().typeof, arguments))
                    call_on_deep_stack(self._fast.compile, types)
                self._ready = True
            return self._fast(*arguments)
        except Exception as error:
            # Such an error is not the cache's.
            if not self.place or type(error).__module__.startswith("numba"):
                raise
            # Writing to the cache fails with an OSError, most often for want of space.
            is_disk_full = isinstance(error, OSError)
            if not is_disk_full:
                self._discard_cache()
            self._make(keep=False)
            return self(*arguments)

    def _discard_cache(self) -> None:
        """Delete the files that list machine code of this kernel; warn DamagedCache.

        Files that cannot be deleted stay. The warning points at the caller of the
        function that called the kernel.
        """
        for file in self.files():
            with contextlib.suppress(OSError):
                file.unlink()
        message = "machine code in the compiler's cache is damaged; it is made anew"
        # Level 1 is this function, 2 `__call__`, 3 the function that called the kernel
        # (such as `Batch.run`), and 4 its caller.
        warnings.warn(message, DamagedCache, stacklevel=4)

    def files(self) -> list[Path]:
        """Files on disk that list machine code of this kernel.

        They may be of these sources or of others; there are none if it is kept nowhere.
        """
        if not self.place:
            return []
        return list(Path(self.place).glob(f"*.{self._twin.__name__}-*.nbi"))


def compiled(kernel: Kernel, user_functions: Functions = ()) -> Compiled:
    """Return a kernel as machine code, the same object at every call.

    `user_functions`, which numba has compiled, take the place of `user_force`.
    """
    with ONE_AT_A_TIME:
        return _compiled(kernel, user_functions)


_compiled = functools.cache(Compiled)


@functools.cache
def interpreted(kernel: Any, user_functions: Functions = ()) -> Kernel:
    """Return a kernel in plain Python, with these functions for `user_force`.

    It is the kernel itself if there are none, else the same function of a copy of its
    module; for the same arguments always the same one.
    """
    if not user_functions:
        return kernel  # type: ignore[no-any-return]
    twin = _twin(sys.modules[kernel.__module__], user_functions)
    return getattr(twin, kernel.__name__)  # type: ignore[no-any-return]


def can_be(user_functions: Functions) -> bool:
    """Whether numba has compiled all of these functions."""
    return all(hasattr(function, "py_func") for _, function in user_functions)


def _entry(kernel: Any, user_functions: Functions) -> FunctionType:
    """The twin of a kernel: the function of plain Python that numba is to compile.

    It has the code of the kernel, and closes over a digest of its sources; its globals
    are those of a copy of the kernel's module in which all functions are jitted.
    Functions that only one other function uses are inlined there.

    Numba compiles anew a function that closes over another value than the one on disk,
    and else looks at the kernel's file alone. So a change in any source compiles the
    kernel anew.
    """
    module = sys.modules[kernel.__module__]
    code = kernel.__code__.replace(co_freevars=("digest",))
    # What is closed over is a tuple of cells, one for each name in `co_freevars`.
    digest = (CellType(f"{kernel.__name__} {digest_of(module)}"),)
    scope = vars(_twin(module, user_functions, _names_used_once(module)))
    twin = FunctionType(code, scope, kernel.__name__, kernel.__defaults__, digest)
    twin.__qualname__ = kernel.__qualname__
    twin.__module__ = kernel.__module__
    return twin


def _names_used_once(module: ModuleType) -> frozenset[str]:
    """Names that exactly one function of a kernel module and its imports uses.

    They are global names of any kind, and names of attributes, which count too.
    """
    uses: Counter[str] = Counter()  # how many functions use each name
    for each in _modules(module):
        for value in vars(each).values():
            if isinstance(value, FunctionType):
                uses.update(set(value.__code__.co_names))  # each name once a function
    return frozenset(name for name, users in uses.items() if users == 1)


@functools.cache
def _twin(
    module: ModuleType, user_functions: Functions, once: frozenset[str] | None = None
) -> ModuleType:
    """Copy a kernel module, with the functions of the user in place of `user_force`.

    The kernel modules that it imports are copied as well. With `once` None the copy is
    for plain Python. Else it is for machine code: functions are jitted, lists become
    arrays, and `borrowed` becomes its compiled form. `once` then has the names of
    functions that one function alone uses: they are inlined there, as handing arrays
    over takes time. The same arguments give the same copy.
    """
    twin = ModuleType(module.__name__)

    def jit(function: Any, name: str = "") -> Any:
        """A function of the twin, jitted if the twin is for machine code."""
        if once is None:
            return function
        return compiler().njit(**INNER, forceinline=name in once)(function)

    for name, value in vars(module).items():
        counterpart = value  # constants, and what other modules define
        if name == "user_force" and user_functions:
            counterpart = _one_of(user_functions, jit)
        elif name == "borrowed" and once is not None:
            counterpart = _borrowing()
        elif isinstance(value, FunctionType) and value.__module__ == module.__name__:
            # The copy finds the functions and tables that it uses in the twin.
            scope = vars(twin)
            copy = FunctionType(value.__code__, scope, name, value.__defaults__)
            counterpart = jit(copy, name)
        elif _is_kernel(value):  # a kernel module that this one imports
            counterpart = _twin(value, user_functions, once)
        elif isinstance(value, list) and once is not None:
            counterpart = np.array(value)
        if not name.startswith("__"):
            setattr(twin, name, counterpart)
    return twin


def borrowed(array: T) -> T:
    """Return the array itself; compiled, one of which no references are counted."""
    return array


@functools.cache
def _borrowing() -> Any:
    """Return the compiled form of the kernel function `borrowed`, a jitted function.

    It takes an array, and makes another of the same memory that owns nothing: numba has
    no references of it to count, and leaves the counting out where it sees so. The
    memory must stay until the kernel returns, which the caller's own array sees to.
    """
    numba = compiler()
    pointer = numba.types.voidptr

    # An address as a pointer. An intrinsic is called by the compiler, with a context
    # and the types of its arguments. It returns its signature, and a function that
    # makes its code.
    @numba.extending.intrinsic  # type: ignore[untyped-decorator]
    def pointer_to(_: Any, address: Any) -> Any:
        def code(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(pointer))

        signature = pointer(address)  # in numba a type called with types is a signature
        return signature, code

    @numba.njit(**INNER, forceinline=True)  # type: ignore[untyped-decorator]
    def borrowed(array: Any) -> Any:
        address = pointer_to(array.ctypes.data)
        return numba.carray(address, array.shape, array.dtype)

    return borrowed


def _one_of(functions: Functions, jit: Any) -> Any:
    """A function of (number, d, rate) that calls the function of the user `number`.

    `functions` has pairs (number, function), one at least. The numbers are compared one
    after the other; for a number that is none of them the last function is called. The
    result is a float. `jit` is applied to all functions that are made here.
    """
    number, function = functions[0]
    later = functions[1:]
    if not later:  # the last one is called whatever the number
        return jit(lambda _, d, rate: float(function(d, rate)))
    call_later: Any = _one_of(later, jit)

    def chosen(which: int, d: float, rate: float) -> float:
        """Force of the law of number `which`."""
        if which == number:
            return float(function(d, rate))
        return float(call_later(which, d, rate))

    return jit(chosen)


def _is_kernel(value: Any) -> bool:
    """Whether a value is a module of this package.

    Modules that kernels import are kernels.
    """
    package = __name__.partition(".")[0]
    return isinstance(value, ModuleType) and value.__name__.startswith(f"{package}.")


def _modules(module: ModuleType) -> list[ModuleType]:
    """A kernel module, and all kernel modules that it imports, also through others.

    The module itself comes first; each module is there once.
    """
    modules = [module]
    for each in modules:  # the list grows
        for value in vars(each).values():
            if _is_kernel(value) and value not in modules:
                modules.append(value)
    return modules


def digest_of(module: ModuleType) -> str:
    """Digest of all sources of a kernel module, as 32 hexadecimal digits.

    They are all Python files in its folder, in the folders of the kernel modules that
    it imports, directly or through others, and this file. Whole folders are taken
    because a module imports constants and records by value: it does not tell from which
    files they come.
    """
    folders = {Path(str(each.__file__)).parent for each in _modules(module)}
    files = {Path(__file__)}
    for folder in folders:
        files.update(folder.glob("*.py"))
    digest = hashlib.blake2b(digest_size=16)
    for file in sorted(files):
        digest.update(hashlib.blake2b(file.read_bytes()).digest())
    return digest.hexdigest()
