"""Numbers that carry more than their value: a unit, or the names of dimensions.

Quantities of pint, astropy, unyt and their like are converted by their own unit. Arrays whose
elements are found by name are refused, for here arrays broadcast by position.
"""

from __future__ import annotations

import re
import reprlib
from typing import Any

import numpy as np

_PLAIN = frozenset({float, int, np.float64, np.ndarray})


def numbers_in(value: Any, unit: str) -> Any:
    """Return the bare numbers of `value` in that unit.

    Parameters
    ----------
    value : object
        A quantity with a unit becomes its magnitude in `unit`, wherever it stands in a list; what
        is bare already stays as it is, and need not be a number.
    unit : str
        A unit of the SI, such as ``"kg/m^3"``; ``""`` for a pure number.

    Raises
    ------
    ValueError
        If a unit does not convert to `unit`, or an array would lose its labels or its mask.

    Examples
    --------
    >>> numbers_in([0.4, 1.0], "m")
    [0.4, 1.0]
    """
    if type(value) in _PLAIN:
        return value
    if isinstance(value, list | tuple):
        if _PLAIN.issuperset(map(type, value)):
            return value
        return [numbers_in(item, unit) for item in value]
    if lost := _lost(value):
        raise ValueError(f"must be bare numbers, got a {type(value).__name__}: {lost}")
    if not (hasattr(value, "units") or hasattr(value, "unit")):
        return value
    try:
        converted = value.to(_spelt(unit))
        bare = converted.magnitude if hasattr(converted, "magnitude") else converted.value
    except Exception:  # each library of units raises its own
        wanted = f"be in a unit that converts to {unit}" if unit else "have no unit"
        raise ValueError(f"must {wanted}, got {reprlib.repr(value)}") from None
    return numbers_in(bare, unit)


def _lost(value: Any) -> str:
    """What an array means besides its numbers, with the remedy; empty if nothing."""
    if hasattr(value, "dims"):
        return (
            "its dimensions are not matched by name; give its .values with an axis for each "
            "dimension of the family, as in .values[:, None]"
        )
    if hasattr(value, "index") and not callable(value.index):
        return "its index is not matched; give .to_numpy()"
    if hasattr(value, "mask"):
        return "its mask would be lost; give .compressed() or .filled(...)"
    return ""


def _spelt(unit: str) -> str:
    """A unit as all libraries read it: ``"N/m**(1.5)"``."""
    return re.sub(r"\^([0-9.]+)", r"**(\1)", unit).replace(" ", "*")
