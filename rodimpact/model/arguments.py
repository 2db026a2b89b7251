"""Arguments of functions are checked as the numbers of the model are, and refused alike."""

from collections.abc import Collection
from numbers import Integral
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..units import shown
from .frozen import (
    Field,
    InvalidModel,
    Problems,
    broadcast_shape,
    raise_noted,
    refusal,
    require,
)
from .frozen import Number as Number
from .quantities import Floats, floats

Array: TypeAlias = Floats


def array(name: str, value: ArrayLike, unit: str, sign: str = "") -> Array:
    """The argument as an array in that unit; InvalidModel if it has none.

    `unit` and `sign` are those of a `Field`; without a sign any float will do, nan too.
    """
    try:
        x = floats(value, unit)
    except ValueError as error:
        raise refusal(name, str(error)) from None
    if sign:
        field = Field(unit, sign)
        demand(field.holds(x), name, field.wanted, x)
    return x


def single(name: str, value: Any, unit: str, sign: str = "any") -> float:
    """The argument as a number; InvalidModel if it is none, or several."""
    x = array(name, value, unit, sign)
    if x.ndim:
        raise refusal(name, f"must be a single number, got {shown(value)}")
    return x.item()


def together(**arguments: tuple[Any, str, str]) -> tuple[Array, ...]:
    """Arguments, each with its unit and sign, as arrays that are broadcast."""
    problems: Problems = []
    arrays = {}
    for name, given in arguments.items():
        try:
            arrays[name] = array(name, *given)
        except InvalidModel as error:
            problems += error.problems
    raise_noted(problems)
    broadcast_shape(arrays.items())
    return np.broadcast_arrays(*arrays.values())


def demand(good: Any, name: str, message: str, *values: Number) -> None:
    """InvalidModel where something does not hold, with the message and values of `require`."""
    problems: Problems = []
    require(problems, good, name, message, *values)
    raise_noted(problems)


def of_kind(name: str, value: Any, kind: type, example: str) -> None:
    """InvalidModel if the argument is not of that class; the example says how to come by one."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        message = (
            f"must be {article} {kind.__name__}, such as {example}, got {shown(value)}"
        )
        raise refusal(name, message)


def one_of(name: str, value: Any, choices: Collection[str]) -> None:
    """InvalidModel if the argument is none of these words."""
    if not isinstance(value, str) or value not in choices:
        known = ", ".join(map(repr, choices))
        raise refusal(name, f"must be one of {known}, got {shown(value)}")


def whole(name: str, value: Any, low: int, high: int) -> int:
    """The argument as a whole number from `low` to `high`; InvalidModel if it is none."""
    if (
        isinstance(value, bool)
        or not isinstance(value, Integral)
        or not low <= int(value) <= high
    ):
        raise refusal(
            name, f"must be a whole number from {low} to {high}, got {shown(value)}"
        )
    return int(value)


def plain(value: Array) -> Number:
    """A Python float instead of an array without dimensions."""
    return value if value.ndim else value.item()
