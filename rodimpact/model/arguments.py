"""Checks of the arguments of functions, by the rules of the model's numbers.

Each check names the argument that it refuses, as `frozen.InvalidModel` has it.
"""

from collections.abc import Collection
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..units import shown
from .frozen import (
    LARGEST,
    OUT_OF_SCALE,
    SMALLEST,
    InvalidModel,
    Problems,
    QuantityField,
    broadcast_shape,
    invalid_argument,
    raise_if_problems,
    require,
)
from .frozen import Number as Number
from .quantities import Floats, floats, is_integer

Array: TypeAlias = Floats

UNCHECKED = ""
"""Sign of a number whose range is checked elsewhere: any float will do, NaN too."""


def array(name: str, value: ArrayLike, unit: str, sign: str = UNCHECKED) -> Array:
    """Return an argument as a new array of floats in its unit.

    A single number gives an array of shape ().

    Parameters
    ----------
    name : str
        Name of the argument, for the message.
    value : float or array
        The argument, in `unit` or with a unit that converts to it.
    unit, sign : str
        Those of a `QuantityField`. With the sign `UNCHECKED` any number passes, also
        nan. With another sign nan is refused, and so are finite numbers above `LARGEST`
        and, where only positive ones are allowed, those below `SMALLEST`: products then
        do not overflow.

    Raises
    ------
    InvalidModel
        If the value is not numeric, or any of its numbers is refused.
    """
    try:
        numbers = floats(value, unit)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
    if sign != UNCHECKED:
        field = QuantityField(unit, sign)
        demand(field.holds(numbers), name, field.wanted, numbers)
        magnitude = np.abs(numbers)
        smallest = 0.0
        if "positive" in sign:
            smallest = SMALLEST
        is_sound = (magnitude >= smallest) & (magnitude <= LARGEST)
        # Infinite numbers that the sign does not allow have been refused above.
        is_infinite = magnitude == np.inf
        demand(is_sound | is_infinite, name, OUT_OF_SCALE, numbers)
    return numbers


def scalar(name: str, value: Any, unit: str, sign: str = "any") -> float:
    """Return an argument as a float in `unit`; InvalidModel if it is no single number.

    With any other sign than `UNCHECKED`, nan and extreme magnitudes are refused, too.
    """
    number = array(name, value, unit, sign)
    if number.ndim:
        raise invalid_argument(name, f"must be a single number, got {shown(value)}")
    return number.item()


def broadcast_arguments(**arguments: tuple[Any, str, str]) -> tuple[Array, ...]:
    """Return arguments as arrays of one shape, in the order in which they are given.

    Each is given as (value, unit, sign), see `array`. The arrays may share memory, and
    must not be changed. InvalidModel names the mistakes of all arguments, or is raised
    because they do not broadcast.
    """
    problems: Problems = []
    arrays = {}
    for name, argument in arguments.items():
        value, unit, sign = argument
        try:
            arrays[name] = array(name, value, unit, sign)
        except InvalidModel as error:
            problems += error.problems
    raise_if_problems(problems)
    broadcast_shape(arrays.items())  # raises with the names if they do not broadcast
    return np.broadcast_arrays(*arrays.values())


def demand(condition: Any, name: str, message: str, *values: Number) -> None:
    """Raise InvalidModel if a condition, an array, does not hold everywhere.

    The error names the argument `name`. In the message, ``{0!r}``, ``{1!r}`` ... are
    replaced by the values at the first index where the condition does not hold, see
    `frozen.require`.
    """
    problems: Problems = []
    require(problems, condition, name, message, *values)
    raise_if_problems(problems)


def check_kind(name: str, value: Any, kind: type, example: str) -> None:
    """Raise InvalidModel if an argument is not of the class `kind`.

    The message shows `example` as an object of this class. If the value has one as its
    attribute, as a case has its system, the message says so.
    """
    if isinstance(value, kind):
        return
    article = "a"
    if kind.__name__[0] in "AEIOU":
        article = "an"
    wanted = f"must be {article} {kind.__name__}, such as {example}"
    part = kind.__name__.lower()  # name of the attribute: `system` for a System
    if isinstance(getattr(value, part, None), kind):
        received = (
            f"a {type(value).__name__}: give its {kind.__name__}, the attribute {part}"
        )
    else:
        received = shown(value)
    raise invalid_argument(name, f"{wanted}, got {received}")


def check_choice(name: str, value: Any, choices: Collection[str]) -> None:
    """Raise InvalidModel unless an argument is one of these words."""
    if not isinstance(value, str) or value not in choices:
        words = ", ".join(map(repr, choices))
        raise invalid_argument(name, f"must be one of {words}, got {shown(value)}")


def integer(name: str, value: Any, low: int, high: int) -> int:
    """Return an argument as an int from `low` to `high`; else InvalidModel.

    Whole numbers of NumPy are taken; floats such as 2.0 and truth values are refused.
    """
    if not is_integer(value) or not low <= int(value) <= high:
        wanted = f"must be a whole number from {low} to {high}"
        raise invalid_argument(name, f"{wanted}, got {shown(value)}")
    return int(value)


def check_flag(name: str, value: Any) -> None:
    """Raise InvalidModel unless an argument is True or False, of Python or of NumPy."""
    if not isinstance(value, bool | np.bool_):
        raise invalid_argument(name, f"must be True or False, got {shown(value)}")


def check_text(name: str, value: Any, example: str) -> None:
    """Raise InvalidModel if an argument is no text; the message shows an `example`."""
    if not isinstance(value, str):
        raise invalid_argument(
            name, f"must be a text such as {example!r}, got {shown(value)}"
        )


def float_or_array(value: Array) -> Number:
    """Return an array of shape () as a Python float, any other as it is."""
    if value.ndim:
        return value
    return value.item()
