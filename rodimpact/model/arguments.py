"""Arguments of functions: what has been checked goes in, plain floats come out of formulae."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..units import shown
from .quantities import Floats, floats
from .quantities import Number as Number

Array: TypeAlias = Floats


def array(name: str, value: ArrayLike, unit: str) -> Array:
    """The argument as an array in that unit, "" for a pure number; ValueError if it has none."""
    try:
        return floats(value, unit)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def positive(name: str, value: ArrayLike, unit: str) -> Array:
    """The argument as an array; ValueError if any of it is not positive and finite."""
    x = array(name, value, unit)
    refuse(~((x > 0) & (x < np.inf)), f"must be positive and finite [{unit or 1}]", **{name: x})
    return x


def finite(name: str, value: ArrayLike, unit: str) -> Array:
    """The argument as an array; ValueError if any of it is not finite."""
    x = array(name, value, unit)
    refuse(~np.isfinite(x), "must be finite", **{name: x})
    return x


def single(name: str, value: Any, unit: str) -> float:
    """The argument as a number; ValueError if it is none, or several."""
    x = array(name, value, unit)
    if x.ndim:
        raise ValueError(f"{name}: must be a single number, got {shown(value)}")
    return x.item()


def of_kind(name: str, value: Any, kind: type, example: str) -> None:
    """ValueError if the argument is not of that class; the example says how to come by one."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        message = f"must be {article} {kind.__name__}, such as {example}, got {shown(value)}"
        raise ValueError(f"{name}: {message}")


def together(**arguments: Array) -> tuple[Array, ...]:
    """The arguments, broadcast; ValueError with their shapes if they do not."""
    try:
        return np.broadcast_arrays(*arguments.values())
    except ValueError:
        shapes = ", ".join(f"{name} has shape {x.shape}" for name, x in arguments.items())
        raise ValueError(f"{shapes}: these do not broadcast") from None


def refuse(wrong: NDArray[np.bool_], wanted: str, **arguments: Array) -> None:
    """Raise for the first `wrong` element, naming the arguments, their values and the index."""
    if not np.any(wrong):
        return
    index = tuple(int(i) for i in np.argwhere(wrong)[0])
    given = ", ".join(
        f"{name} = {np.broadcast_to(values, wrong.shape)[index].item()}"
        for name, values in arguments.items()
    )
    place = f" at index {index}" if index else ""
    raise ValueError(f"{given}{place}: {wanted}")


def plain(value: Array) -> Number:
    """A Python float instead of an array without dimensions."""
    return value if value.ndim else value.item()
