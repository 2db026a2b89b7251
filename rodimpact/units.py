"""Numbers with units: "10 mm" is read as 0.01, and 0.000385 s is shown as "385 us".

Every unit of `UNITS` is an exact multiple of its SI unit, and the product is rounded to
binary once: "10 mm" is the same float as 0.01, and "7.85 g/cm^3" the same as 7850.0.
`shown` gives a short text of a value for messages.

>>> parse("10 mm", "length"), format_si(0.000385, "s")
(0.01, '385 us')
"""

import difflib
import math
import re
import reprlib
from collections.abc import Collection
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

__all__ = ["conversion", "format_si", "in_si", "parse"]

if not TYPE_CHECKING:  # a type checker must not take every name for granted

    def __getattr__(name: str) -> object:
        """Raise AttributeError that names the public functions."""
        message = f"module {__name__!r} has no attribute {name!r}"
        if not name.startswith("_"):  # Python itself asks for names with an underscore
            message += f"; use one of {', '.join(__all__)}"
        raise AttributeError(message, name=name)


TIMES = "\N{MULTIPLICATION SIGN}"
"""Sign between the digits of a number and its power of ten."""
MOST_CHARACTERS = 1000
"""Characters of a number with its unit, at most; a longer text is not read."""
MOST_SHOWN = 60
"""Characters of a value that a message shows, at most."""
MOST_SHOWN_OF_PATH = 240
"""Characters of the name of a file that a message shows, at most."""
MAX_POWER = 9
"""Largest power of a unit that is recognised in a compound."""
ROUNDING_GUARD = 1e-9
"""Added to a decimal logarithm, whose round-off may put it below a whole number."""

# US customary units by their definitions: foot and pound of 1959, and the standard
# gravity of 9.80665 m/s^2.
FOOT = Fraction("0.3048")
INCH = FOOT / 12
POUND = Fraction("0.45359237")
POUND_FORCE = POUND * Fraction("9.80665")
KIP = 1000 * POUND_FORCE

UnitFactors: TypeAlias = dict[str, str | Fraction]
UNITS: dict[str, UnitFactors] = {
    "length": {
        "m": "1",
        "cm": "1e-2",
        "mm": "1e-3",
        "um": "1e-6",
        "nm": "1e-9",
        "km": "1e3",
        "ft": FOOT,
        "in": INCH,
    },
    "area": {
        "m^2": "1",
        "cm^2": "1e-4",
        "mm^2": "1e-6",
        "ft^2": FOOT**2,
        "in^2": INCH**2,
    },
    "polar moment": {"m^4": "1", "cm^4": "1e-8", "mm^4": "1e-12", "in^4": INCH**4},
    "pressure": {
        "Pa": "1",
        "kPa": "1e3",
        "MPa": "1e6",
        "GPa": "1e9",
        "psi": POUND_FORCE / INCH**2,
        "ksi": KIP / INCH**2,
    },
    "density": {
        "kg/m^3": "1",
        "g/cm^3": "1e3",
        "lb/ft^3": POUND / FOOT**3,
        "lb/in^3": POUND / INCH**3,
    },
    "velocity": {
        "m/s": "1",
        "cm/s": "1e-2",
        "mm/s": "1e-3",
        "km/s": "1e3",
        "km/h": "5/18",
        "ft/s": FOOT,
        "in/s": INCH,
        "mph": 5280 * FOOT / 3600,
    },
    "time": {"s": "1", "ms": "1e-3", "us": "1e-6", "ns": "1e-9"},
    "frequency": {"Hz": "1", "kHz": "1e3", "MHz": "1e6"},
    "rate": {"1/s": "1", "1/ms": "1e3"},
    "force": {
        "N": "1",
        "mN": "1e-3",
        "kN": "1e3",
        "MN": "1e6",
        "lbf": POUND_FORCE,
        "kip": KIP,
    },
    "energy": {
        "J": "1",
        "mJ": "1e-3",
        "kJ": "1e3",
        "ft lbf": FOOT * POUND_FORCE,
        "ft kip": FOOT * KIP,
    },
    "mass": {"kg": "1", "g": "1e-3", "mg": "1e-6", "t": "1e3", "lb": POUND},
    "acceleration": {
        "m/s^2": "1",
        "cm/s^2": "1e-2",
        "mm/s^2": "1e-3",
        "ft/s^2": FOOT,
        "in/s^2": INCH,
    },
    "dimensionless": {"%": "1e-2", "microstrain": "1e-6"},
    "voltage": {"V": "1", "mV": "1e-3", "uV": "1e-6", "kV": "1e3"},
    "stiffness": {
        "N/m": "1",
        "N/mm": "1e3",
        "kN/m": "1e3",
        "kN/mm": "1e6",
        "MN/m": "1e6",
        "GN/m": "1e9",
        "lbf/in": POUND_FORCE / INCH,
        "lbf/ft": POUND_FORCE / FOOT,
        "kip/in": KIP / INCH,
        "kip/ft": KIP / FOOT,
    },
    "viscosity": {
        "Pa s": "1",
        "mPa s": "1e-3",
        "kPa s": "1e3",
        "MPa s": "1e6",
        "psi s": POUND_FORCE / INCH**2,
    },
    "damping": {
        "N s/m": "1",
        "N s/mm": "1e3",
        "kN s/m": "1e3",
        "lbf s/in": POUND_FORCE / INCH,
        "lbf s/ft": POUND_FORCE / FOOT,
        "kip s/ft": KIP / FOOT,
    },
    "Hertz stiffness": {
        "N/m^1.5": "1",
        "kN/m^1.5": "1e3",
        "MN/m^1.5": "1e6",
        "GN/m^1.5": "1e9",
    },
    "inverse velocity": {"s/m": "1", "s/cm": "1e2", "s/mm": "1e3", "s/ft": 1 / FOOT},
}
"""Units of each dimension, each with its exact value in the SI unit of the dimension.

The value is a fraction or the text of one; "1" marks the SI unit itself.
"""

BASE_UNITS = {
    "N": {"m": 1, "kg": 1, "s": -2},
    "J": {"m": 2, "kg": 1, "s": -2},
    "Pa": {"m": -1, "kg": 1, "s": -2},
    "Hz": {"s": -1},
}
"""Powers of m, kg and s in the derived units of the SI."""

DIMENSION_OF_UNIT: dict[str, str] = {}
"""Dimension of each unit."""
for _dimension, _units in UNITS.items():
    DIMENSION_OF_UNIT.update(dict.fromkeys(_units, _dimension))

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
    "lbf ft": "ft lbf",
    "kip ft": "ft kip",
}
_OTHER_NAMES = {
    "fps": "ft/s",
    "ips": "in/s",
    "pcf": "lb/ft^3",
    "tonne": "t",
    "tonnes": "t",
}
"""Units of `UNITS` that a hint names for these words, which are not read as units."""
_METRIC_FORCE = "1 kgf is 9.80665 N"
_TON_OF_FORCE = "a metric one is 9.80665 kN, a US one 2 kip, a British one 2.24 kip"
_TON = "a metric one is 1 t, a US one 2000 lb, a British one 2240 lb"
_UNREAD_UNITS = {
    "kgf": _METRIC_FORCE,
    "kp": _METRIC_FORCE,
    "tf": _TON_OF_FORCE,
    "tonf": _TON_OF_FORCE,
    "ton": _TON,
    "tons": _TON,
}
"""Units that are not read, most of them ambiguous, with their values in other units."""
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = {-9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
_LARGEST_PREFIX = max(_PREFIXES)
# A prefix on m^2 would be squared as well, and kg has one already.
_TAKES_PREFIX = re.compile(r"(?!kg)[A-Za-z]+(?![A-Za-z^])")


def parse(text: str | float | int, dimension: str) -> float:
    """Read a quantity and return its value in SI units.

    Parameters
    ----------
    text : str, float or int
        A decimal number with a unit ("200 GPa"), or a plain number in SI units.
    dimension : str
        A key of `UNITS`, such as "length" or "pressure"; or a compound unit that is not
        in `UNITS`, such as "N/m^p", which is then the only allowed unit.

    Returns
    -------
    float
        The value in the SI unit of `dimension`: the float nearest to the decimal
        number.

    Raises
    ------
    ValueError
        If `text` is not a finite number or is too small for a float, if its unit is
        unknown or has another dimension, or if `dimension` is neither a key nor a unit.

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
    is_word = isinstance(dimension, str)
    # A compound unit that is its own dimension, such as "N/m^p", has a slash.
    if not is_word or (dimension not in UNITS and "/" not in dimension):
        raise ValueError(
            f"unknown dimension {shown(dimension)}. Use one of {', '.join(UNITS)}."
        )
    units: UnitFactors = UNITS.get(dimension, {dimension: "1"})
    try:
        value = _exact_value(text, units)
    except ValueError as error:
        raise ValueError(
            f"cannot read {shown(text)} as {dimension}: {error}. "
            f"Use one of {', '.join(units)}, or a bare number in SI units."
        ) from None
    return value


class Amount(NamedTuple):
    """A number with its unit."""

    value: float  # in the SI unit
    unit: str  # SI unit; "" of a bare number


def read_amount(text: str) -> Amount:
    """Read a number with any unit of `UNITS`, or a bare number.

    The value is returned in the SI unit of its dimension, together with this unit. A
    bare number has the unit "".

    Raises
    ------
    ValueError
        If the text is no number, or its unit is unknown.

    Examples
    --------
    >>> read_amount("2.5 mm"), read_amount("0.5")
    (Amount(value=0.0025, unit='m'), Amount(value=0.5, unit=''))
    """
    quantity = _QUANTITY.fullmatch(text.strip())  # None is refused by `parse` below
    dimension = "dimensionless"
    if quantity is not None and quantity["unit"] is not None:
        unit = _spelt(quantity["unit"])
        if unit not in DIMENSION_OF_UNIT:
            hint = _hint(unit, DIMENSION_OF_UNIT)
            raise ValueError(f"unknown unit {shown(unit)}{hint}")
        dimension = DIMENSION_OF_UNIT[unit]
    return Amount(parse(text, dimension), si_unit(dimension))


def is_amount(text: str) -> bool:
    """Whether a text is a number, with any unit of `UNITS` or without."""
    try:
        read_amount(text)
    except ValueError:
        return False
    return True


def _exact_value(given: Any, units: UnitFactors) -> float:
    """Value in the SI unit of a number, or of a text with one of these units.

    A number, or a text without a unit, is in the SI unit already. ValueError, with the
    reason, if there is no value: also if it is infinite, nan, or too small for a float.
    """
    exact: Any = given
    if isinstance(given, str):
        exact = _fraction(given, units)
    elif not isinstance(given, int | float) or isinstance(given, bool):
        raise ValueError("it is not a number")
    try:
        value = float(exact)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ValueError("it is not a finite number")
    if exact != 0 and value == 0:
        raise ValueError("it is too small for a floating-point number")
    return value


def _fraction(text: str, units: UnitFactors) -> Fraction:
    """Exact value, in the SI unit, of the text of a number with one of these units.

    A number without a unit is in the SI unit already. ValueError, with the reason, if
    the text is no such number or its unit is none of these.
    """
    if len(text) > MOST_CHARACTERS:
        raise ValueError(f"it is longer than {MOST_CHARACTERS} characters")
    quantity = _QUANTITY.fullmatch(text.strip())
    if quantity is None:
        raise ValueError("it is not a decimal number followed by a unit")
    unit = ""
    if quantity["unit"] is not None:
        unit = _spelt(quantity["unit"])
    if unit and unit not in units:
        dimension = DIMENSION_OF_UNIT.get(unit)
        if dimension is not None:
            reason = f"{unit!r} is a unit of {dimension}"
            if unit == "g" and "m/s^2" in units:  # grams for an acceleration
                reason += ", and 1 g of standard gravity is '9.80665 m/s^2'"
            raise ValueError(reason)
        raise ValueError(f"unknown unit {shown(unit)}{_hint(unit, units)}")
    power = 0
    if quantity["power"] is not None:
        power = int(quantity["power"])
    if abs(power) > 2 * MOST_CHARACTERS:  # the fraction would have as many digits
        raise ValueError("its power of ten is out of range")
    factor = Fraction(1)
    if unit:
        factor = Fraction(units[unit])
    return Fraction(quantity["number"]) * factor


class Conversion(NamedTuple):
    """Conversion of a unit to the SI."""

    unit: str  # SI unit
    factor: Fraction  # value of one unit in the SI unit


def conversion(unit: str) -> Conversion | None:
    """Conversion of a unit to the SI; None if the unit is unknown.

    Parameters
    ----------
    unit : str
        A unit of one of the dimensions of `UNITS`, or another spelling of it; "" and
        "1" stand for pure numbers.

    Returns
    -------
    Conversion or None

    Raises
    ------
    ValueError
        If the unit is no text.

    Examples
    --------
    >>> conversion("mV"), conversion("microstrain").unit, conversion("furlong")
    (Conversion(unit='V', factor=Fraction(1, 1000)), '', None)
    """
    if not isinstance(unit, str):
        raise ValueError(f"unit: must be a text such as 'mm', got {shown(unit)}")
    spelt = _spelt(unit)
    if not spelt:  # "" or "1"
        return Conversion("", Fraction(1))
    dimension = DIMENSION_OF_UNIT.get(spelt)
    if dimension is None:
        return None
    return Conversion(si_unit(dimension), Fraction(UNITS[dimension][spelt]))


def in_si(values: Any, unit: Any) -> tuple[Any, str]:
    """Convert numbers to the SI; return them with their SI unit.

    Parameters
    ----------
    values : float or array
        Numbers in `unit`.
    unit : str
        A unit as `conversion` takes it.

    Returns
    -------
    float or array, str

    Raises
    ------
    ValueError
        If the unit is unknown, or the values are no numbers.

    Examples
    --------
    >>> in_si(250.0, "us")
    (0.00025, 's')
    """
    to_si = None
    if isinstance(unit, str):
        to_si = conversion(unit)
    if to_si is None:
        hint = _hint(shown(unit)[1:-1], DIMENSION_OF_UNIT)  # without the quotes
        if not hint:
            hint = "; use one such as 'V', 'mV' or 'N'"
        raise ValueError(f"unknown unit {shown(unit)}{hint}")
    if not _has_numbers(values):
        raise ValueError(f"values: must be numbers of {unit}, got {shown(values)}")
    factor = to_si.factor
    # A factor such as 1/1000 has no exact float, but its inverse 1000 has: dividing by
    # the inverse rounds only once.
    try:
        if factor >= 1:
            return values * float(factor), to_si.unit
        return values / float(1 / factor), to_si.unit
    except (TypeError, OverflowError):  # a real number that floats cannot multiply
        message = f"values: must be numbers of {unit}, got {shown(values)}"
        raise ValueError(message) from None


def _has_numbers(values: Any) -> bool:
    """Whether a value is a real number, or an array of real numbers without a mask."""
    dtype = getattr(values, "dtype", None)
    if dtype is None:
        is_truth_value = isinstance(values, bool)
        return isinstance(values, Real) and not is_truth_value
    is_masked = hasattr(values, "mask")
    # Kinds of floats and of signed and unsigned integers
    return getattr(dtype, "kind", "") in "fiu" and not is_masked


def dimension_of(unit: str) -> str:
    """Dimension of an SI unit; the unit itself if `UNITS` has no such dimension.

    Examples
    --------
    >>> dimension_of("N/m"), dimension_of(""), dimension_of("N/m^p")
    ('stiffness', 'dimensionless', 'N/m^p')
    """
    for dimension in UNITS:
        if unit == si_unit(dimension):
            return dimension
    return unit


def si_unit(dimension: str) -> str:
    """SI unit of a dimension; "" for pure numbers.

    A compound unit that `UNITS` does not have, such as "N/m^p", is its own dimension:
    it is returned as it is.
    """
    units: UnitFactors = UNITS.get(dimension, {dimension: "1"})
    for unit, factor in units.items():
        if factor == "1":  # the unit is that of the SI
            return unit
    return ""


def multiply_unit(powers: dict[str, float], unit: str, sign: int) -> None:
    """Multiply a product by a unit such as N s/m^2, or divide it if the sign is -1.

    `powers` holds the power of each symbol of the product, and is changed. A symbol
    that cancels keeps the power 0. ValueError if a power of the unit is no number.
    """
    above, _, below = unit.partition("/")
    # Symbols below the slash have the opposite sign.
    for product, direction in ((above, sign), (below, -sign)):
        for factor in product.split():
            symbol, has_power, exponent = factor.partition("^")
            power = 1.0
            if has_power:
                power = float(exponent)
            if symbol != "1":  # the 1 of a unit such as 1/s is no symbol
                powers[symbol] = powers.get(symbol, 0.0) + direction * power


def written_unit(powers: dict[str, float]) -> str:
    """Unit of a product, from the powers of its symbols; "" for a pure number.

    Examples
    --------
    >>> written_unit({"N": 1, "s": 1, "m": -2})
    'N s/m^2'
    """
    above = [_power(symbol, n) for symbol, n in powers.items() if n > 0]
    below = [_power(symbol, -n) for symbol, n in powers.items() if n < 0]
    text = " ".join(above)
    if not below:
        return text
    if not above:
        text = "1"
    divisor = " ".join(below)
    if len(below) > 1:
        divisor = f"({divisor})"
    return f"{text}/{divisor}"


def _power(symbol: str, power: float) -> str:
    """A symbol to a power: m^1.5, or m for the power 1."""
    if power == 1:
        return symbol
    return f"{symbol}^{power:g}"


def in_base_units(powers: dict[str, float]) -> dict[str, float]:
    """Powers of m, kg, s and V of a unit, from those of any symbols of the SI.

    Symbols that cancel are left out; unknown symbols are kept.

    Examples
    --------
    >>> in_base_units({"N": 1, "m": -1})
    {'kg': 1, 's': -2}
    """
    base: dict[str, float] = {}
    for symbol, power in powers.items():
        for base_symbol, base_power in BASE_UNITS.get(symbol, {symbol: 1}).items():
            base[base_symbol] = base.get(base_symbol, 0) + base_power * power
    return {symbol: power for symbol, power in base.items() if power != 0}


def _spelt(unit: str) -> str:
    """A unit in the spelling of `UNITS`: no Greek letters, superscripts or dots.

    An unknown unit is respelt in the same way. "1" becomes "".
    """
    spelt = " ".join(unit.translate(_SPELLINGS).split())
    return _ALIASES.get(spelt, spelt)


def _hint(word: str, units: Collection[str]) -> str:
    """End of a sentence, "; perhaps 'mm' is meant"; "" if no unit is near.

    The hint for a word of `_UNREAD_UNITS` is its value in other units. The hint for a
    compound of known units, such as mm/ms, names the units that are equal to it, or is
    "". For other words it names the unit of that name in `_OTHER_NAMES`, or all units
    that differ by capitals alone, or the unit with the most similar spelling.
    """
    if word in _UNREAD_UNITS:
        return f"; {_UNREAD_UNITS[word]}"
    compound = None
    if "/" in word or " " in word:
        compound = _worth_of_compound(word)
    # A compound gets no hint on spelling: a similar unit may be a different one.
    if compound is not None:
        equal = []
        for unit in units:
            if _worth_of_compound(unit) == compound:
                equal.append(repr(unit))
        if not equal:
            return ""
        return f"; it is {' or '.join(equal)}"
    near = []
    other_name = _OTHER_NAMES.get(word)
    if other_name is not None and other_name in units:
        near.append(repr(other_name))
    else:
        for unit in units:
            if unit.casefold() == word.casefold():
                near.append(repr(unit))
    if not near:
        matches = difflib.get_close_matches(word[:MOST_SHOWN], units, n=1)
        near = list(map(repr, matches))
    if not near:
        return ""
    return f"; perhaps {' or '.join(near)} is meant"


class _Worth(NamedTuple):
    """Value of a unit in base units of the SI."""

    factor: Fraction  # value of one unit in base units
    powers: dict[str, float]  # of the base units m, kg, s and V


def _worth_of_compound(unit: str) -> _Worth | None:
    """Value of a product or quotient of units; None if a part of it is unknown.

    Parts may have whole powers up to `MAX_POWER`: N/mm^2 is 1e6 kg/(m s^2).
    """
    power_of_symbol: dict[str, float] = {}
    try:
        multiply_unit(power_of_symbol, unit, 1)  # 1 multiplies by it
    except ValueError:
        return None
    factor = Fraction(1)
    powers: dict[str, float] = {}
    for symbol, power in power_of_symbol.items():
        to_si = conversion(symbol)
        is_small_integer = abs(power) <= MAX_POWER and power % 1 == 0
        if to_si is None or not is_small_integer:
            return None
        factor *= to_si.factor ** int(power)
        sign = 1
        if power < 0:
            sign = -1
        for _ in range(abs(int(power))):  # the SI unit of the symbol, to this power
            multiply_unit(powers, to_si.unit, sign)
    return _Worth(factor, in_base_units(powers))


def shown(value: Any) -> str:
    """A value as messages show it, in one line of at most `MOST_SHOWN` characters.

    A value that cannot be written is shown by its type.

    Examples
    --------
    >>> shown([0.4, "2 mm", [True]])
    "[0.4, '2 mm', [True]]"
    >>> len(shown("long" * 1000))
    60
    """
    try:
        return one_line(_SHORT.repr(value))  # `one_line` cuts it to MOST_SHOWN
    except Exception:  # the value's own repr fails, or an integer has too many digits
        return f"a value of type {one_line(type(value).__name__)}"


def shown_path(path: Any) -> str:
    """The name of a file as messages show it, in quotes.

    A name of more than `MOST_SHOWN_OF_PATH` characters is cut to that number: its
    beginning and its end are shown with "..." between them.

    Examples
    --------
    >>> shown_path("shot.csv"), len(shown_path("long/" * 1000))
    ("'shot.csv'", 243)
    """
    name = repr(str(path))
    if len(name) <= MOST_SHOWN_OF_PATH:
        return name
    half = MOST_SHOWN_OF_PATH // 2
    return f"{name[:half]}...{name[-half:]}"


def one_line(text: str) -> str:
    """A text in one line; a long text is cut to `MOST_SHOWN` characters and ends "...".

    Characters that do not print are written as escapes, and white space as one blank.
    A text with much white space may be cut shorter.
    """
    line = ""
    # Twice as many characters as are shown: white space may shrink. The rest of a very
    # long text is not processed, which saves time.
    beginning = text[: 2 * MOST_SHOWN]
    is_cut = text[2 * MOST_SHOWN :].strip() != ""
    words = beginning.split()
    for character in " ".join(words):
        if character.isprintable():
            line += character
        else:
            line += ascii(character)[1:-1]  # without the quotes
    if is_cut or len(line) > MOST_SHOWN:
        return f"{line[: MOST_SHOWN - 3]}..."
    return line


_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = MOST_SHOWN


def format_si(value: float, unit: str, digits: int = 6) -> str:
    """Write a quantity for people, with an engineering prefix on its SI unit.

    Units without prefixes (kg, kg/m^3, m^2), and magnitudes outside nano to a million
    giga, are written without a prefix.

    Parameters
    ----------
    value : float
        The value in `unit`. NaN is written as a dash, and infinity as "inf" with the
        unit.
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
        If the value is no number, the unit no text, or `digits` no number of digits.

    Examples
    --------
    >>> format_si(0.000385, "s"), format_si(1270.8, "N"), format_si(7850.0, "kg/m^3")
    ('385 us', '1.2708 kN', '7850 kg/m^3')
    """
    number: Any = value
    is_number = isinstance(number, Real)
    is_unit = isinstance(unit, str)
    if not is_number or not is_unit or not _is_digit_count(digits):
        raise ValueError(
            f"cannot write {shown(value)} in {shown(unit)} to {shown(digits)} digits"
        )
    if not _has_numbers(value):  # a bool, or a masked number
        raise ValueError(f"value: must be a number, got {shown(value)}")
    try:
        value = float(value)
    except OverflowError:
        raise ValueError(f"value: is too large, got {shown(value)}") from None
    if math.isnan(value):
        return "-"
    if math.isfinite(value) and _TAKES_PREFIX.match(unit):
        # The prefix is chosen after rounding: 999.9999999 N is 1 kN, not 1000 N.
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        power = int(exponent) // 3 * 3  # power of ten of the prefix, a multiple of 3
        shift = int(exponent) % 3  # power of ten that remains
        if power == _LARGEST_PREFIX + 3:
            # 1000 GPa and more are written in GPa too, like the numbers beside them.
            power = _LARGEST_PREFIX
            shift += 3
        if power in _PREFIXES:
            # `normalize` drops trailing zeros; adding 0 drops the sign of -0.
            decimal = Decimal(mantissa).scaleb(shift).normalize() + 0
            return f"{decimal:f} {_PREFIXES[power]}{unit}"
    return f"{value + 0.0:.{digits}g} {unit}".rstrip()  # + 0.0: no -0


def _is_digit_count(digits: Any) -> bool:
    """Whether a value is a whole number of digits, from 1 to `MOST_CHARACTERS` - 1."""
    if not isinstance(digits, int):
        return False
    return 0 < digits < MOST_CHARACTERS


def format_power(exponent: int) -> str:
    """Write a power of ten in superscripts: 10⁻³ for -3."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def format_factor(number: float) -> str:
    """Write a positive factor: as it is from 1e-3 to 1e5, else with a power of ten.

    The power of ten has a factor of three digits before it, left out if it is 1.
    """
    if 1e-3 <= number < 1e5:
        return f"{number:g}"
    # The guard: the logarithm of 10^n may be less than n by round-off.
    exponent = math.floor(math.log10(number) + ROUNDING_GUARD)
    lead = f"{number / 10.0**exponent:.3g}"
    if lead == "1":
        return format_power(exponent)
    return f"{lead}{TIMES}{format_power(exponent)}"
