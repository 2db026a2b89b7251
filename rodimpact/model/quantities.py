"""Conversion of the numbers that users give, to floats.

Quantities of pint, astropy, unyt and similar libraries are converted by their own unit.
A value that would lose a part is refused: labels, a mask, an imaginary part, or a size
beyond a float. Values that only look like numbers are refused, too: truth values, text,
bytes and dates.
"""

import re
from numbers import Integral, Rational
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..units import dimension_of, parse, shown

Floats: TypeAlias = NDArray[np.float64]

MAX_AXES = 32
"""Number of axes of a family, at most: NumPy broadcasts no more."""
_BARE_TYPES = frozenset({float, int, np.float64})
"""Types of the values that are converted without any check."""
_UNIT_WORDS = {
    "m": "metres",
    "m^2": "square metres",
    "s": "seconds",
    "Hz": "hertz",
    "kg": "kilograms",
    "N": "newtons",
    "Pa": "pascals",
}


def floats(value: Any, unit: str) -> Floats:
    """Return numbers as a new array of floats, of shape () for a single number.

    Parameters
    ----------
    value : object
        A number, an array, or lists of them. A quantity with a unit becomes its
        magnitude in `unit`, wherever it stands in a list.
    unit : str
        A unit of the SI, such as ``"kg/m^3"``; ``""`` for a pure number.

    Raises
    ------
    ValueError
        If the value is no number or too large for a float, a unit does not convert to
        `unit`, an array would lose its labels or its mask, lists are ragged, or there
        are more than `MAX_AXES` axes.

    Examples
    --------
    >>> floats([0.4, 1], "m")
    array([0.4, 1. ])
    """
    reason = ""
    if isinstance(value, str):
        reason = f"; units.parse reads text with a unit: {_reading_of(value, unit)}"
    # A ValueError of `_strip_units`, or on the axes, has a message of its own and is
    # not caught.
    try:
        bare = _strip_units(value, unit)
        try:
            # A number that overflows to infinity is refused as infinite later.
            with np.errstate(over="ignore"):
                numbers = np.array(bare, dtype=np.float64)
        except ValueError:
            # Text was refused by `_strip_units`: only ragged lists are left.
            reason = "; lists must be of equal lengths"
        else:
            if numbers.ndim > MAX_AXES:
                message = f"must have at most {MAX_AXES} axes, got {numbers.ndim}"
                raise ValueError(message)
            return numbers
    except OverflowError:
        reason = "; it is too large for a floating-point number"
    except (TypeError, RecursionError):
        pass  # there is no other reason than "must be a number"
    raise ValueError(f"must be a number{of_unit(unit)}, got {shown(value)}{reason}")


def _reading_of(text: str, unit: str) -> str:
    """Code that reads a text with a unit, such as ``units.parse('5 mm', 'length')``.

    If the text cannot be read in the dimension of `unit`, the reason is returned.
    """
    dimension = dimension_of(unit)
    try:
        parse(text, dimension)
    except ValueError as error:
        # "cannot read '1 cm2' as area: why. Use one of m^2, ..."
        _, _, reason = str(error).partition(": ")
        return reason.partition(". Use one of ")[0]
    return f"units.parse({text.strip()!r}, {dimension!r})"


def is_integer(value: Any) -> bool:
    """Whether a value is a whole number by its type, of Python or of NumPy.

    Floats such as 2.0, truth values and time spans of NumPy are none.
    """
    if isinstance(value, bool | np.timedelta64):
        return False
    return isinstance(value, Integral)


def of_unit(unit: str) -> str:
    """Words that follow "a number" in a message: " of metres"; "" for a pure number."""
    if not unit:
        return ""
    return f" of {_UNIT_WORDS.get(unit, unit)}"


def _strip_units(value: Any, unit: str) -> Any:
    """Numbers of a value in `unit`: a bare number or list itself, else a list or array.

    Lists may be nested. TypeError if the value is not numeric, or is a truth value.
    ValueError if its unit does not convert, or if it would lose a mask, an index or
    named dimensions.
    """
    if type(value) in _BARE_TYPES:
        return value
    if isinstance(value, list | tuple):
        # For speed: a list of bare numbers is returned as it is.
        if _BARE_TYPES.issuperset(map(type, value)):
            return value
        return [_strip_units(item, unit) for item in value]
    if isinstance(value, bool | bytes | bytearray | memoryview):
        raise TypeError
    if isinstance(value, Rational):
        return float(value)
    loss = _loss_of(value)
    if loss:
        raise ValueError(f"must be bare numbers, got a {type(value).__name__}: {loss}")
    if hasattr(value, "units") or hasattr(value, "unit"):
        return _strip_units(_magnitude(value, unit), unit)
    array = np.asarray(value)
    if array.dtype.kind == "O" and array.ndim:  # an array of objects: look at each
        return _strip_units(array.tolist(), unit)
    is_numeric = array.dtype.kind in "fiu"  # floats, signed and unsigned integers
    if not is_numeric:
        raise TypeError
    return array


def _magnitude(quantity: Any, unit: str) -> Any:
    """Magnitude of a quantity of Pint or Astropy in a unit of the SI.

    ValueError if the unit of the quantity does not convert to it.
    """
    try:
        converted = quantity.to(_library_spelling(unit))
        if hasattr(converted, "magnitude"):
            return converted.magnitude
        return converted.value
    except Exception:  # each library of units raises its own
        wanted = "have no unit"
        if unit:
            wanted = f"be in a unit that converts to {unit}"
        raise ValueError(f"must {wanted}, got {shown(quantity)}") from None


def _loss_of(value: Any) -> str:
    """Text on the part that a value would lose as bare numbers, with the remedy.

    Such a part is the named dimensions of xarray, the index of pandas, or the mask of
    NumPy. "" if nothing would be lost.
    """
    if hasattr(value, "dims"):
        return (
            "dimensions are not matched by name here; give .values of arrays from "
            "xarray.broadcast"
        )
    if hasattr(value, "index") and not callable(value.index):
        return "its index is not matched; give .to_numpy()"
    if hasattr(value, "mask"):
        return "its mask would be lost; give .compressed() or .filled(...)"
    return ""


def _library_spelling(unit: str) -> str:
    """A unit as all libraries of units read it: ``"N/m**(1.5)"``."""
    return re.sub(r"\^([0-9.]+)", r"**(\1)", unit).replace(" ", "*")
