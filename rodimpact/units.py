"""Numbers with units, as people write them: "10 mm" to 0.01 and 0.000385 s to "385 us".

Every unit known here is a power of ten of its SI unit. A conversion therefore only shifts the
decimal exponent, and the decimal number is rounded to binary once: "10 mm" is the same float as
0.01, and "7.85 g/cm^3" the same as 7850.0.
"""

from __future__ import annotations

import difflib
import math
import re
from decimal import Decimal

TIMES = "\N{MULTIPLICATION SIGN}"

UNITS: dict[str, dict[str, int]] = {
    "length": {"m": 0, "cm": -2, "mm": -3, "um": -6, "nm": -9, "km": 3},
    "area": {"m^2": 0, "cm^2": -4, "mm^2": -6},
    "polar moment": {"m^4": 0, "cm^4": -8, "mm^4": -12},
    "pressure": {"Pa": 0, "kPa": 3, "MPa": 6, "GPa": 9},
    "density": {"kg/m^3": 0, "g/cm^3": 3},
    "velocity": {"m/s": 0, "cm/s": -2, "mm/s": -3, "km/s": 3},
    "time": {"s": 0, "ms": -3, "us": -6, "ns": -9},
    "frequency": {"Hz": 0, "kHz": 3, "MHz": 6},
    "force": {"N": 0, "mN": -3, "kN": 3, "MN": 6},
    "mass": {"kg": 0, "g": -3, "mg": -6, "t": 3},
    "acceleration": {"m/s^2": 0, "cm/s^2": -2, "mm/s^2": -3},
    "dimensionless": {"%": -2},
    "stiffness": {"N/m": 0, "N/mm": 3, "kN/m": 3, "kN/mm": 6, "MN/m": 6},
    "viscosity": {"Pa s": 0, "mPa s": -3, "kPa s": 3, "MPa s": 6},
    "damping": {"N s/m": 0, "N s/mm": 3, "kN s/m": 3},
    "Hertz stiffness": {"N/m^1.5": 0, "kN/m^1.5": 3, "MN/m^1.5": 6, "GN/m^1.5": 9},
    "inverse velocity": {"s/m": 0, "s/cm": 2, "s/mm": 3},
}
"""For each dimension its units, each with its power of ten relative to the SI unit."""

_QUANTITY = re.compile(
    r"(?P<mantissa>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE](?P<exponent>[+-]?[0-9]{1,9}))?"
    r"\s*(?P<unit>[^0-9\s.,+-].*)?"
)
_SPELLINGS = str.maketrans(
    {"\u00b5": "u", "\u03bc": "u", "\u00b2": "^2", "\u00b3": "^3", "\u2074": "^4", "\u00b7": " ",
     "*": " "}
)
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = {-9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# A prefix on m^2 would be squared as well, and kg has one already.
_TAKES_PREFIX = re.compile(r"(?!kg)[A-Za-z]+(?![A-Za-z^])")


def parse(text: str | float | int, dimension: str) -> float:
    """Read a quantity and return its value in SI units.

    Parameters
    ----------
    text : str, float or int
        A decimal number with a unit ("200 GPa"), or a bare number, taken to be in SI units
        already.
    dimension : str
        What the quantity must be: a key of `UNITS`, such as "length" or "pressure", or a compound
        unit that stands there under none, such as "N/m^p", and is then the only one.

    Returns
    -------
    float
        The value in the SI unit of `dimension`: the float nearest to the decimal number.

    Raises
    ------
    ValueError
        If `text` is not a finite number, or its unit is unknown or of another dimension; also if
        `dimension` is not a key of `UNITS`.

    Examples
    --------
    >>> parse("7.85 g/cm^3", "density")
    7850.0
    >>> parse("10 mm", "length") == 0.01
    True
    >>> parse("5 m/s", "time")
    Traceback (most recent call last):
        ...
    ValueError: cannot read '5 m/s' as time: 'm/s' is a unit of velocity. \
Use one of s, ms, us, ns, or a bare number in SI units.
    """
    if dimension not in UNITS and "/" not in dimension:
        raise ValueError(f"unknown dimension {dimension!r}. Use one of {', '.join(UNITS)}.")
    units = UNITS.get(dimension, {dimension: 0})

    def refusal(reason: str) -> ValueError:
        return ValueError(
            f"cannot read {text!r} as {dimension}: {reason}. "
            f"Use one of {', '.join(units)}, or a bare number in SI units."
        )

    if isinstance(text, str):
        quantity = _QUANTITY.fullmatch(text.strip())
        if quantity is None:
            raise refusal("it is not a decimal number followed by a unit")
        unit = " ".join((quantity["unit"] or "").translate(_SPELLINGS).split())
        if unit and unit not in units:
            raise refusal(_explain(unit, units))
        power = int(quantity["exponent"] or 0) + (units[unit] if unit else 0)
        value = float(f"{quantity['mantissa']}e{power}")
    elif isinstance(text, int | float) and not isinstance(text, bool):
        try:
            value = float(text)
        except OverflowError:
            value = math.inf
    else:
        raise refusal("it is not a number")
    if not math.isfinite(value):
        raise refusal("it is not a finite number")
    return value


def dimension_of(unit: str) -> str:
    """Dimension of which this is the SI unit; the unit itself if it stands in no dimension.

    Examples
    --------
    >>> dimension_of("N/m"), dimension_of(""), dimension_of("N/m^p")
    ('stiffness', 'dimensionless', 'N/m^p')
    """
    return next((name for name in UNITS if unit == si_unit(name)), unit)


def si_unit(dimension: str) -> str:
    """SI unit of a dimension; "" for pure numbers."""
    units = UNITS.get(dimension, {dimension: 0})
    return next((unit for unit, power in units.items() if power == 0), "")


def _explain(unit: str, units: dict[str, int]) -> str:
    """Why `unit` is not among `units`: of another dimension, or unknown and perhaps misspelt."""
    for dimension, others in UNITS.items():
        if unit in others:
            return f"{unit!r} is a unit of {dimension}"
    near = [name for name in units if name.casefold() == unit.casefold()]
    near = near or difflib.get_close_matches(unit, units, n=1)
    if near:
        return f"unknown unit {unit!r}; perhaps {' or '.join(near)} is meant"
    return f"unknown unit {unit!r}"


def format_si(value: float, unit: str, digits: int = 6) -> str:
    """Write a quantity for people, with an engineering prefix on its SI unit.

    Units that take no prefix (kg, kg/m^3, m^2) and magnitudes outside nano to giga are written
    without one.

    Parameters
    ----------
    value : float
        The value in `unit`. NaN, which stands for "no such number", becomes a dash.
    unit : str
        An SI unit without prefix, such as "s" or "N/m"; "" for a pure number.
    digits : int
        Significant digits to keep; trailing zeros are dropped.

    Returns
    -------
    str
        The number and its unit.

    Examples
    --------
    >>> format_si(0.000385, "s"), format_si(1270.8, "N"), format_si(7850.0, "kg/m^3")
    ('385 us', '1.2708 kN', '7850 kg/m^3')
    """
    if math.isnan(value):
        return "-"
    if math.isfinite(value) and _TAKES_PREFIX.match(unit):
        # Rounding comes before the choice of a prefix: 999.9999999 N is 1 kN, not 1000 N.
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        within, thousands = int(exponent) % 3, int(exponent) // 3 * 3
        if thousands in _PREFIXES:
            number = Decimal(mantissa).scaleb(within).normalize() + 0
            return f"{number:f} {_PREFIXES[thousands]}{unit}"
    return f"{value + 0.0:.{digits}g} {unit}".rstrip()


def format_power(exponent: int) -> str:
    """Write a power of ten in superscripts."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def format_factor(number: float) -> str:
    """Write a factor 1, 2 or 5 times a power of ten, or any other."""
    if number < 1e5:
        return f"{number:g}"
    exponent = math.floor(math.log10(number) + 1e-9)
    lead = f"{number / 10.0**exponent:.3g}"
    return format_power(exponent) if lead == "1" else f"{lead}{TIMES}{format_power(exponent)}"
