"""Numbers with units, as people write them: "10 mm" to 0.01 and 0.000385 s to "385 us".

Every unit known here is an exact multiple of its SI unit, and the product is rounded to binary
once: "10 mm" is the same float as 0.01, and "7.85 g/cm^3" the same as 7850.0. What was given and
cannot be read is shown in a few words, by `shown`.

>>> parse("10 mm", "length"), format_si(0.000385, "s")
(0.01, '385 us')
"""

import difflib
import math
import re
import reprlib
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import Any, NamedTuple

__all__ = ["conversion", "format_si", "in_si", "parse"]

TIMES = "\N{MULTIPLICATION SIGN}"
MOST_CHARACTERS = (
    1000  # of a number with its unit; a float written out in full has no more
)
MOST_SHOWN = 60  # characters of what was given

UNITS: dict[str, dict[str, str]] = {
    "length": {
        "m": "1",
        "cm": "1e-2",
        "mm": "1e-3",
        "um": "1e-6",
        "nm": "1e-9",
        "km": "1e3",
        "ft": "0.3048",
        "in": "0.0254",
    },
    "area": {"m^2": "1", "cm^2": "1e-4", "mm^2": "1e-6"},
    "polar moment": {"m^4": "1", "cm^4": "1e-8", "mm^4": "1e-12"},
    "pressure": {"Pa": "1", "kPa": "1e3", "MPa": "1e6", "GPa": "1e9"},
    "density": {"kg/m^3": "1", "g/cm^3": "1e3"},
    "velocity": {
        "m/s": "1",
        "cm/s": "1e-2",
        "mm/s": "1e-3",
        "km/s": "1e3",
        "km/h": "5/18",
    },
    "time": {"s": "1", "ms": "1e-3", "us": "1e-6", "ns": "1e-9"},
    "frequency": {"Hz": "1", "kHz": "1e3", "MHz": "1e6"},
    "rate": {"1/s": "1", "1/ms": "1e3"},
    "force": {
        "N": "1",
        "mN": "1e-3",
        "kN": "1e3",
        "MN": "1e6",
        "lbf": "4.4482216152605",
    },
    "energy": {"J": "1", "mJ": "1e-3", "kJ": "1e3"},
    "mass": {"kg": "1", "g": "1e-3", "mg": "1e-6", "t": "1e3", "lb": "0.45359237"},
    "acceleration": {"m/s^2": "1", "cm/s^2": "1e-2", "mm/s^2": "1e-3"},
    "dimensionless": {"%": "1e-2", "microstrain": "1e-6"},
    "voltage": {"V": "1", "mV": "1e-3", "uV": "1e-6", "kV": "1e3"},
    "stiffness": {
        "N/m": "1",
        "N/mm": "1e3",
        "kN/m": "1e3",
        "kN/mm": "1e6",
        "MN/m": "1e6",
        "GN/m": "1e9",
    },
    "viscosity": {"Pa s": "1", "mPa s": "1e-3", "kPa s": "1e3", "MPa s": "1e6"},
    "damping": {"N s/m": "1", "N s/mm": "1e3", "kN s/m": "1e3"},
    "Hertz stiffness": {
        "N/m^1.5": "1",
        "kN/m^1.5": "1e3",
        "MN/m^1.5": "1e6",
        "GN/m^1.5": "1e9",
    },
    "inverse velocity": {"s/m": "1", "s/cm": "1e2", "s/mm": "1e3"},
}
"""For each dimension its units, each with what it is in the SI unit, exactly."""

DIMENSION = {unit: dimension for dimension, units in UNITS.items() for unit in units}

_QUANTITY = re.compile(
    r"(?P<number>[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE](?P<power>[+-]?[0-9]+))?)"
    r"\s*(?P<unit>(?<=\s)1/\w+|[^0-9\s.,+-].*)?"
)
_SPELLINGS = str.maketrans(
    {
        "\u00b5": "u",
        "\u03bc": "u",
        "\u00b2": "^2",
        "\u00b3": "^3",
        "\u2074": "^4",
        "\u00b7": " ",
        "*": " ",
    }
)
_ALIASES = {
    "1": "",
    "um/m": "microstrain",
    "ustrain": "microstrain",
    "u\u03b5": "microstrain",
}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = {-9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
LARGE = max(_PREFIXES)
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
        A key of `UNITS`, such as "length" or "pressure"; or a compound unit that is not in `UNITS`,
        such as "N/m^p". Then no other unit is allowed.

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
    if not isinstance(dimension, str) or (
        dimension not in UNITS and "/" not in dimension
    ):
        raise ValueError(
            f"unknown dimension {shown(dimension)}. Use one of {', '.join(UNITS)}."
        )
    units = UNITS.get(dimension, {dimension: "1"})

    def refusal(reason: str) -> ValueError:
        return ValueError(
            f"cannot read {shown(text)} as {dimension}: {reason}. "
            f"Use one of {', '.join(units)}, or a bare number in SI units."
        )

    exact: Any = text
    if isinstance(text, str):
        if len(text) > MOST_CHARACTERS:
            raise refusal(f"it is longer than {MOST_CHARACTERS} characters")
        quantity = _QUANTITY.fullmatch(text.strip())
        if quantity is None:
            raise refusal("it is not a decimal number followed by a unit")
        unit = _spelt(quantity["unit"] or "")
        if unit and unit not in units:
            unknown = f"unknown unit {shown(unit)}{_meant(unit, units)}"
            other = DIMENSION.get(unit)
            raise refusal(f"{unit!r} is a unit of {other}" if other else unknown)
        if abs(int(quantity["power"] or 0)) > 2 * MOST_CHARACTERS:
            raise refusal("its power of ten is out of range")
        exact = Fraction(quantity["number"]) * Fraction(units[unit] if unit else 1)
    elif not isinstance(text, int | float) or isinstance(text, bool):
        raise refusal("it is not a number")
    try:
        value = float(exact)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise refusal("it is not a finite number")
    if exact and not value:
        raise refusal("it is too small for a floating-point number")
    return value


class Conversion(NamedTuple):
    """A unit of the SI, and the factor that makes one of it."""

    unit: str
    factor: Fraction


def conversion(unit: str) -> Conversion | None:
    """Unit of the SI for any unit known here; None if it is not known.

    Examples
    --------
    >>> conversion("mV"), conversion("microstrain").unit, conversion("furlong")
    (Conversion(unit='V', factor=Fraction(1, 1000)), '', None)
    """
    if not isinstance(unit, str):
        raise ValueError(f"unit: must be a text such as 'mm', got {shown(unit)}")
    spelt = _spelt(unit)
    if not spelt:
        return Conversion("", Fraction(1))
    if not (dimension := DIMENSION.get(spelt, "")):
        return None
    return Conversion(si_unit(dimension), Fraction(UNITS[dimension][spelt]))


def in_si(values: Any, unit: Any) -> tuple[Any, str]:
    """Numbers in a unit as numbers in the SI, and its unit; ValueError if there is no such unit.

    Examples
    --------
    >>> in_si(250.0, "us")
    (0.00025, 's')
    """
    known = conversion(unit) if isinstance(unit, str) else None
    if known is None:
        hint = (
            _meant(shown(unit)[1:-1], DIMENSION) or "; use one such as 'V', 'mV' or 'N'"
        )
        raise ValueError(f"unknown unit {shown(unit)}{hint}")
    si, factor = known
    try:  # one operation, which rounds once
        return (
            values * float(factor) if factor >= 1 else values / float(1 / factor)
        ), si
    except (TypeError, OverflowError):
        raise ValueError(
            f"values: must be numbers of {unit}, got {shown(values)}"
        ) from None


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
    units = UNITS.get(dimension, {dimension: "1"})
    return next((unit for unit, factor in units.items() if factor == "1"), "")


def _spelt(unit: str) -> str:
    """A unit as `UNITS` spells it."""
    spelt = " ".join(unit.translate(_SPELLINGS).split())
    return _ALIASES.get(spelt, spelt)


def _meant(word: str, units: Iterable[str]) -> str:
    """Which of the units may be meant: all that differ by capitals alone, or the nearest one."""
    near = [repr(name) for name in units if name.casefold() == word.casefold()]
    near = near or list(
        map(repr, difflib.get_close_matches(word[:MOST_SHOWN], units, n=1))
    )
    return f"; perhaps {' or '.join(near)} is meant" if near else ""


def shown(value: Any) -> str:
    """A value that was given, as messages show it: in one line of `MOST_SHOWN` characters at most.

    Examples
    --------
    >>> shown([0.4, "2 mm", [True]])
    "[0.4, '2 mm', [True]]"
    >>> len(shown("long" * 1000))
    60
    """
    try:
        return one_line(_SHORT.repr(value))
    except Exception:  # of the value's own repr, or an integer of too many digits
        return f"a value of type {one_line(type(value).__name__)}"


def one_line(text: str) -> str:
    """The text in one line, cut, and with escapes for what does not print."""
    line = " ".join(text[: 2 * MOST_SHOWN].split())
    line = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
    return line if len(line) <= MOST_SHOWN else f"{line[: MOST_SHOWN - 3]}..."


_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = MOST_SHOWN


def format_si(value: float, unit: str, digits: int = 6) -> str:
    """Write a quantity for people, with an engineering prefix on its SI unit.

    Units that take no prefix (kg, kg/m^3, m^2) and magnitudes outside nano to a million giga are
    written without one.

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

    Raises
    ------
    ValueError
        If that is no number, no unit, or no number of digits.

    Examples
    --------
    >>> format_si(0.000385, "s"), format_si(1270.8, "N"), format_si(7850.0, "kg/m^3")
    ('385 us', '1.2708 kN', '7850 kg/m^3')
    """
    kinds: tuple[tuple[Any, type], ...] = (value, Real), (unit, str), (digits, int)
    if not all(isinstance(*pair) for pair in kinds) or not 0 < digits < MOST_CHARACTERS:
        raise ValueError(
            f"cannot write {shown(value)} in {shown(unit)} to {shown(digits)} digits"
        )
    if math.isnan(value):
        return "-"
    if math.isfinite(value) and _TAKES_PREFIX.match(unit):
        # Rounding comes before the choice of a prefix: 999.9999999 N is 1 kN, not 1000 N.
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        within, thousands = int(exponent) % 3, int(exponent) // 3 * 3
        if (
            thousands == LARGE + 3
        ):  # 1000 GPa and more, beside which other numbers are in GPa
            within, thousands = within + 3, LARGE
        if thousands in _PREFIXES:
            number = Decimal(mantissa).scaleb(within).normalize() + 0
            return f"{number:f} {_PREFIXES[thousands]}{unit}"
    return f"{value + 0.0:.{digits}g} {unit}".rstrip()


def format_power(exponent: int) -> str:
    """Write a power of ten in superscripts."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def format_factor(number: float) -> str:
    """Write a factor 1, 2 or 5 times a power of ten, or any other."""
    if 1e-3 <= number < 1e5:
        return f"{number:g}"
    exponent = math.floor(math.log10(number) + 1e-9)
    lead = f"{number / 10.0**exponent:.3g}"
    return (
        format_power(exponent)
        if lead == "1"
        else f"{lead}{TIMES}{format_power(exponent)}"
    )
