"""How a kernel becomes machine code: in one piece with all that it calls, kept on disk.

Left to itself, numba finishes every function as a library of its own, callable from Python, and
then once more inside each of its callers. Here what a kernel calls stays as it was lowered until
it stands in the kernel, and is optimised there, once; that takes less than half the time.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import hashlib
import pickle
import sys
import types
from pathlib import Path
from typing import Any

import numba
from llvmlite.binding import Linkage
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.serialize import dumps

from . import machine_code
from .columns import see
from .kernel_parts import callees, sources

NEWEST = (0, 68)  # numba whose insides are known; any newer is left to itself, and takes longer
SWITCHES = {"nogil": True}
INSIDE = {
    "_nrt": False,  # kernels make no arrays, whose references would be counted
    "no_rewrites": True, "no_cfunc_wrapper": True,
}
TAG = sys.implementation.cache_tag


@functools.cache
def translate(kernel: types.FunctionType) -> Any:
    """Return the kernel as machine code, made at its first call or found on disk."""
    fast = _dispatcher(kernel, **({"pipeline_class": Around} if _known() else {}))
    with contextlib.suppress(RuntimeError):  # there is no place for a cache
        fast._cache = Kept(fast.py_func)
    return fast


def directory(kernel: types.FunctionType) -> str:
    """Where the machine code of this kernel is kept; empty if it is kept nowhere."""
    return str(translate(kernel).stats.cache_path or "")


def on_disk(kernel: types.FunctionType) -> bool:
    """Whether there is machine code of this kernel, of these sources and this compiler."""
    cache = translate(kernel)._cache
    return isinstance(cache, Kept) and any(cache.files())


class Kept(FunctionCache):
    """Machine code of one kernel on disk: a file for each signature and processor."""

    def files(self, made: str = "") -> list[Path]:
        """Files of these sources and this compiler, or of those with that digest."""
        return list(Path(self.cache_path).glob(f"{self._stem(made or _made())}*.nbc"))

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return what was kept for this signature, None if nothing was."""
        target.refresh()
        kept = machine_code.read(self._file(signature, target.codegen()))
        code = kept and self._impl.rebuild(target, pickle.loads(kept))
        return code if code and code.signature.args == signature else None

    def save_overload(self, signature: Any, code: Any) -> None:
        """Keep machine code; what other sources or compilers left goes."""
        if self._impl.check_cachable(code):
            file = self._file(signature, code.codegen)
            machine_code.write(file, dumps(self._impl.reduce(code)))
            for old in set(self.files("*")) - set(self.files()):
                with contextlib.suppress(OSError):
                    old.unlink()

    def _stem(self, made: str) -> str:
        return f"{self._py_func.__module__}.{self._py_func.__name__}.{TAG}-{made}-"

    def _file(self, signature: Any, codegen: Any) -> Path:
        which = repr((signature, codegen.magic_tuple()))
        return Path(self.cache_path) / f"{self._stem(_made())}{_digest(which.encode())}.nbc"


def _made() -> str:
    """Of what machine code is made, and how."""
    return _digest(sources() + repr((numba.__version__, SWITCHES, INSIDE)).encode())


def _digest(data: bytes) -> str:
    return hashlib.blake2b(data, digest_size=8).hexdigest()


class Part(JITCodeLibrary):
    """A function within others: linked with what it calls, and neither optimised nor finished."""

    def finalize(self) -> None:
        """Make it fit for being linked."""
        for library in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalized = True

    @property
    def codegen(self) -> Any:
        """Who sets up its environment, which nothing in it uses."""
        return self

    def set_env(self, name: str, env: Any) -> None:
        """Do nothing: there is no machine code yet."""


class Within(Compiler):
    """Makes a part of a function."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.state.library = Part(self.state.targetctx.codegen(), "part")


class Whole(JITCodeLibrary):
    """A function with its parts, that nobody else calls: they are inlined where that pays."""

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if function.linkage == Linkage.linkonce_odr:
                function.linkage = Linkage.internal
        super()._optimize_final_module()


class Around(Compiler):
    """Makes a function with its parts."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.state.library = Whole(self.state.targetctx.codegen(), "whole")
        self.state.library.enable_object_caching()

    def compile_extra(self, function: Any) -> Any:
        """Make it, and look for garbage only then: almost all is in use until it is done."""
        collecting = gc.isenabled()
        gc.disable()
        try:
            return super().compile_extra(function)
        finally:
            if collecting:
                gc.enable()


@functools.cache
def _part(kernel: types.FunctionType) -> Any:
    """Return a kernel for use within others."""
    if _known():
        fast = _dispatcher(kernel, no_cpython_wrapper=True, pipeline_class=Within)
        fold = fast._compiler.fold_argument_types

        def fold_alike(args: Any, names: Any) -> Any:
            signature, found = fold(args, names)
            return signature, tuple(map(numba.types.unliteral, found))

        fast._compiler.fold_argument_types = fold_alike  # or it were made anew for each constant
        return fast
    return _dispatcher(kernel)


def _known() -> bool:
    """Whether the insides of this numba are those that `Part`, `Columns` and INSIDE need."""
    return bool(numba.version_info[:2] <= NEWEST)


def _dispatcher(kernel: types.FunctionType, **switches: Any) -> Any:
    """Let numba have a twin of the kernel that calls twins of its callees."""
    scope = dict(kernel.__globals__)
    for callee in callees(kernel):
        scope[callee.__name__] = _part(callee)
    twin = types.FunctionType(kernel.__code__, scope, kernel.__name__, kernel.__defaults__)
    twin.__qualname__, twin.__module__ = kernel.__qualname__, kernel.__module__
    if _known():
        switches |= INSIDE
        for made in scope.values():
            if isinstance(made, type) and issubclass(made, tuple) and hasattr(made, "_fields"):
                see(made)
    return numba.njit(twin, **SWITCHES, **switches)
