"""The door to numba for kernels on records: one source, as plain Python or as machine code.

A kernel module holds plain functions, whole constants and tables of numbers (nested lists), and
imports other kernel modules by name. `compiled` makes a twin of such a module in which every
function is jitted and every table is an array; plain Python runs the module as it stands. State is
arrays of records: structured arrays compiled, lists of small objects in plain Python.
"""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

OPTIONS = {"error_model": "numpy", "nogil": True}
"""Of every kernel: a division by zero is inf, as the kernels expect; threads run side by side."""

INNER = OPTIONS | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Of what kernels call: nothing else does, so it needs no door to Python, and compiles faster."""


Functions = tuple[tuple[int, Any], ...]
"""Functions of the user that stand for the kernel function `own`, by its first argument."""


@functools.cache
def compiled(module: ModuleType, factory: str, own: Functions = ()) -> Any:
    """Return a kernel as machine code, which numba keeps on disk if nothing in it is the user's.

    Parameters
    ----------
    module : module
    factory : str
        Name of the function that makes the kernel from a digest of its sources: numba compiles
        anew what closes over another one.
    own : tuple of (int, function), optional
        Compiled functions.
    """
    import numba

    kernel = getattr(module, factory)(f"{module.__name__} {_digest(module)}")
    twin = FunctionType(
        kernel.__code__, vars(_twin(module, own, True)), kernel.__name__, None, kernel.__closure__)
    return numba.njit(cache=not own, **OPTIONS)(twin)


@functools.cache
def interpreted(module: ModuleType, factory: str, own: Functions = ()) -> Any:
    """Return a kernel in plain Python."""
    kernel = getattr(module, factory)("")
    if not own:
        return kernel
    return FunctionType(
        kernel.__code__, vars(_twin(module, own, False)), kernel.__name__, None, kernel.__closure__)


def can_be(own: Functions) -> bool:
    """Whether numba has compiled all of these functions."""
    return all(hasattr(function, "py_func") for _, function in own)


@functools.cache
def _twin(module: ModuleType, own: Functions, jitted: bool) -> ModuleType:
    """The same module with its functions jitted, its tables as arrays, and the user's functions."""
    twin = ModuleType(module.__name__)
    if jitted:
        import numba

        jit: Any = numba.njit(**INNER)
    else:
        jit = _as_it_is
    for name, value in vars(module).items():
        made = value
        if name == "own" and own:
            made = _one_of(own, jit, jitted)
        elif _is_own(value, module):
            made = jit(FunctionType(value.__code__, vars(twin), name, value.__defaults__))
        elif _is_kernel(value):
            made = _twin(value, own, jitted)
        elif isinstance(value, list) and jitted:
            made = np.array(value)
        if not name.startswith("__"):
            setattr(twin, name, made)
    return twin


def _as_it_is(function: Any) -> Any:
    return function


def _one_of(functions: Functions, jit: Any, jitted: bool) -> Any:
    """A function of a number and arguments that calls the function with that number."""
    (number, function), *others = functions
    first: Any = function if jitted else getattr(function, "py_func", function)
    if not others:
        return jit(lambda _, d, rate: float(first(d, rate)))
    rest: Any = _one_of(tuple(others), jit, jitted)

    def chosen(which: int, d: float, rate: float) -> float:
        if which == number:
            return float(first(d, rate))
        return float(rest(which, d, rate))

    return jit(chosen)


def _is_own(value: Any, module: ModuleType) -> bool:
    return isinstance(value, FunctionType) and value.__module__ == module.__name__


def _is_kernel(value: Any) -> bool:
    """Whether a module is one of ours."""
    return isinstance(value, ModuleType) and value.__name__.startswith(f"{__package__}.")


def _digest(module: ModuleType) -> str:
    """Of all sources in the folders of a kernel module and of those that it imports.

    Constants and records come from files of which a module keeps no more than names.
    """
    folders, seen, waiting = set[Path](), set[str](), [module]
    while waiting:
        here = waiting.pop()
        if here.__name__ not in seen:
            seen.add(here.__name__)
            folders.add(Path(str(here.__file__)).parent)
            waiting += [value for value in vars(here).values() if _is_kernel(value)]
    digest = hashlib.blake2b(digest_size=16)
    for file in sorted(file for folder in folders for file in folder.glob("*.py")):
        digest.update(hashlib.blake2b(file.read_bytes()).digest())
    return digest.hexdigest()


@functools.cache
def _slots(record: Any) -> type:
    """A class with the fields of a record."""
    return type("Record", (), {"__slots__": tuple(record.names)})


def as_objects(records: Any) -> list[Any]:
    """Return an array of records as a list of small objects with lists, for plain Python."""
    kind, names = _slots(records.dtype), records.dtype.names
    objects = []
    for row in zip(*(records[name].tolist() for name in names), strict=True):
        one = kind()
        for name, value in zip(names, row, strict=True):
            setattr(one, name, value)
        objects.append(one)
    return objects


def as_records(objects: list[Any], record: Any) -> Any:
    """Return objects of `as_objects` as an array of records."""
    records = np.zeros(len(objects), record)
    for name in record.names if objects else ():
        records[name] = [getattr(one, name) for one in objects]
    return records
