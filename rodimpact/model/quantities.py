"""Every number that is given becomes a float here, or is refused.

Quantities of pint, astropy, unyt and their like are converted by their own unit. What would lose
something on the way is refused: labels, a mask, an imaginary part, digits beyond a float; so is
what only looks like a number: truth values, text, bytes and dates.
"""

import re
from numbers import Rational
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..units import shown

Floats: TypeAlias = NDArray[np.float64]

MOST_AXES = 32  # of a family; NumPy broadcasts no more
_PLAIN = frozenset({float, int, np.float64})
_WORDS = {
    "m": "metres",
    "m^2": "square metres",
    "s": "seconds",
    "Hz": "hertz",
    "kg": "kilograms",
    "N": "newtons",
    "Pa": "pascals",
}


def floats(value: Any, unit: str) -> Floats:
    """Return the numbers given as a new array of floats, without dimensions for a single one.

    Parameters
    ----------
    value : object
        A number, an array, or lists of them. A quantity with a unit becomes its magnitude in
        `unit`, wherever it stands in a list.
    unit : str
        A unit of the SI, such as ``"kg/m^3"``; ``""`` for a pure number.

    Raises
    ------
    ValueError
        If that is no number or one too large for a float, a unit does not convert to `unit`, or an
        array would lose its labels or its mask.

    Examples
    --------
    >>> floats([0.4, 1], "m")
    array([0.4, 1. ])
    """
    why = "; units.parse reads text with a unit" if isinstance(value, str) else ""
    try:
        bare = _bare(value, unit)
        try:
            with np.errstate(over="ignore"):  # what is infinite then is refused as such
                numbers = np.array(bare, dtype=np.float64)
        except ValueError:  # lists of unequal lengths
            why = "; lists must be of equal lengths"
        else:
            if numbers.ndim > MOST_AXES:
                raise ValueError(
                    f"must have at most {MOST_AXES} axes, got {numbers.ndim}"
                )
            return numbers
    except OverflowError:
        why = "; it is too large for a floating-point number"
    except (TypeError, RecursionError):
        pass
    raise ValueError(f"must be a number{number_of(unit)}, got {shown(value)}{why}")


def number_of(unit: str) -> str:
    """How a sentence goes on after "a number": " of metres", or nothing where there is no unit."""
    return f" of {_WORDS.get(unit, unit)}" if unit else ""


def _bare(value: Any, unit: str) -> Any:
    """What of lists and arrays NumPy makes numbers of; TypeError for what is no number."""
    if type(value) in _PLAIN:
        return value
    if isinstance(value, list | tuple):
        if _PLAIN.issuperset(map(type, value)):
            return value
        return [_bare(item, unit) for item in value]
    if isinstance(value, bool | bytes | bytearray | memoryview):
        raise TypeError
    if isinstance(value, Rational):
        return float(value)
    if lost := _lost(value):
        raise ValueError(f"must be bare numbers, got a {type(value).__name__}: {lost}")
    if hasattr(value, "units") or hasattr(value, "unit"):
        try:
            converted = value.to(_spelt(unit))
            bare = (
                converted.magnitude
                if hasattr(converted, "magnitude")
                else converted.value
            )
        except Exception:  # each library of units raises its own
            wanted = f"be in a unit that converts to {unit}" if unit else "have no unit"
            raise ValueError(f"must {wanted}, got {shown(value)}") from None
        return _bare(bare, unit)
    array = np.asarray(value)
    if array.dtype.kind == "O" and array.ndim:
        return _bare(array.tolist(), unit)
    if array.dtype.kind not in "fiu":
        raise TypeError
    return array


def _lost(value: Any) -> str:
    """What an array means besides its numbers, with the remedy; empty if nothing."""
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


def _spelt(unit: str) -> str:
    """A unit as all libraries read it: ``"N/m**(1.5)"``."""
    return re.sub(r"\^([0-9.]+)", r"**(\1)", unit).replace(" ", "*")
