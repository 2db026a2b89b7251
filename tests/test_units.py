"""Units: the decimal number is rounded once, and a mistake is named with its remedy."""

import math
import re
import subprocess
import sys
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rodimpact import units

PREFIXED = ["s", "N", "m", "Pa", "m/s", "N/m", "Pa s"]


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("10 mm", "length", 0.01),
        ("1 cm^2", "area", 1e-4),
        ("200 GPa", "pressure", 200e9),
        ("7.85 g/cm^3", "density", 7850.0),
        ("5 m/s", "velocity", 5.0),
        ("5 us", "time", 5e-6),
        ("7 cm^4", "polar moment", 7e-8),
        ("80 %", "dimensionless", 0.8),
        ("2 ft", "length", 0.6096),
        ("3 lb", "mass", 1.36077711),
        ("10 lbf", "force", 44.482216152605),
        ("36 km/h", "velocity", 10.0),
        ("60 mph", "velocity", 26.8224),
        ("30 ksi", "pressure", 206842718.79505083),
        ("30000 psi", "pressure", 206842718.79505083),
        ("100 kip", "force", 444822.16152605),
        ("5 kN/m", "stiffness", 5000.0),
        ("0.15 s/ft", "inverse velocity", 0.4921259842519685),
        ("490 lb/ft^3", "density", 7849.047053240469),
        ("40 ft\u00b7kip", "energy", 54232.71793325602),
        ("40 kip ft", "energy", 54232.71793325602),
        ("12 in^2", "area", 0.00774192),
        ("1e-3", "length", 1e-3),
        ("+.5e1mm", "length", 0.005),
        ("  7.\tmm ", "length", 0.007),
        (3, "length", 3.0),
        ("5 \u00b5s", "time", 5e-6),
        ("5 \u03bcs", "time", 5e-6),
        ("1 cm\u00b2", "area", 1e-4),
        ("1 mm\u2074", "polar moment", 1e-12),
        ("4 N\u00b7s/m", "damping", 4.0),
        ("4 N*s/m", "damping", 4.0),
    ],
)
def test_texts_are_read_exactly_as_floats(text, dimension, value):
    result = units.parse(text, dimension)
    assert result == value
    assert type(result) is float


@given(st.decimals(allow_nan=False, allow_infinity=False, places=9), st.data())
def test_the_product_of_number_and_unit_is_rounded_once(number, data):
    """`units.parse` gives the float next to the exact product of a decimal number and
    the factor of its unit.
    """
    dimension = data.draw(st.sampled_from(sorted(units.UNITS)))
    factors = units.UNITS[dimension]  # decimal texts by unit
    unit = data.draw(st.sampled_from(sorted(factors)))
    exact = Fraction(number) * Fraction(factors[unit])

    value = units.parse(f"{number} {unit}", dimension)

    assert value == float(exact)


def test_every_unit_is_what_it_is_to_pint():
    """Each unit of each dimension has the factor to SI units that pint has, to 1e-14."""
    quantity = pytest.importorskip("pint").application_registry.get().Quantity
    factors = {}
    pint_factors = {}
    for units_of_dimension in units.UNITS.values():
        for name, factor in units_of_dimension.items():
            one_in_pint = quantity(1.0, name).to_base_units()
            factors[name] = float(Fraction(factor))
            pint_factors[name] = one_in_pint.magnitude
    assert pint_factors == pytest.approx(factors, rel=1e-14)


def test_no_unit_belongs_to_two_dimensions():
    """The names of the units of all dimensions are distinct."""
    names = []
    for units_of_dimension in units.UNITS.values():
        names += units_of_dimension
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("text", "dimension", "wanted"),
    [
        (
            "5 kg",
            "length",
            r"'5 kg' as length: 'kg' is a unit of mass.* km, ft, in, or",
        ),
        ("5 m/s", "time", r"'m/s' is a unit of velocity"),
        ("5 parsec", "length", r"unknown unit 'parsec'\. Use one of m, cm"),
        ("5 N s/cm", "damping", r"unknown unit 'N s/cm'. Use one of N s/m"),
        (
            "5 N/m",
            "Hertz stiffness",
            r"as Hertz stiffness: 'N/m' is a unit of stiffness",
        ),
        ("5 mn", "force", r"perhaps 'mN' or 'MN' is meant"),
        ("1,5 mm", "length", r"not a decimal number followed by a unit"),
        ("", "length", r"not a decimal number"),
        ("inf m", "length", r"not a decimal number"),
        ("1e999 m", "length", r"not a finite number"),
        ("1e-400 m", "length", r"too small for a floating-point number"),
        ("1e999999999 m", "length", r"its power of ten is out of range"),
        (
            "9" * 16_000,
            "length",
            r"999\.\.\.999.* as length: it is longer than 1000 characters",
        ),
        ("9" * 999 + "x", "length", r"unknown unit 'x'"),
        ("5 \x1b[31m\u202e", "length", r"unknown unit '\\x1b\[31m\\u202e'"),
        pytest.param(
            10**5000,
            "length",
            r"a value of type int as length: it is not a finite",
            id="5001 digits",
        ),
        (math.nan, "length", r"nan as length: it is not a finite number"),
        (True, "length", r"True as length: it is not a number"),
        (None, "length", r"None as length: it is not a number"),
        ("5 m", "distance", r"unknown dimension 'distance'\. Use one of length, area"),
    ],
)
def test_refusals_name_the_value_and_the_remedy(text, dimension, wanted):
    with pytest.raises(ValueError, match=wanted):
        units.parse(text, dimension)


@pytest.mark.parametrize(
    ("value", "unit", "digits", "text"),
    [
        (0.000385, "s", 6, "385 us"),
        (1270.8, "N", 6, "1.2708 kN"),
        (0, "s", 6, "0 s"),
        (-0.0, "s", 6, "0 s"),
        (math.nan, "s", 6, "-"),
        (-math.inf, "s", 6, "-inf s"),
        (-0.00127, "m", 6, "-1.27 mm"),
        (999.9999999, "N", 6, "1 kN"),
        (123.456, "m/s", 2, "120 m/s"),
        (0.4, "", 6, "0.4"),
        (1234.5678, "", 6, "1234.57"),
        (1.2e10, "N/m^1.5", 6, "12 GN/m^1.5"),
        (1.234e12, "Pa", 6, "1234 GPa"),  # beside other numbers in GPa
        (1e-15, "J", 6, "1e-15 J"),
        (2e15, "Pa", 6, "2e+15 Pa"),
    ],
)
def test_numbers_are_written_with_the_prefix_that_people_use(value, unit, digits, text):
    assert units.format_si(value, unit, digits) == text


PREFIXES = {"n": -9, "u": -6, "m": -3, "": 0, "k": 3, "M": 6, "G": 9}
"""Powers of ten."""


@given(st.floats(1e-8, 1e11), st.sampled_from([-1, 1]), st.sampled_from(PREFIXED))
def test_what_is_written_has_the_value_to_its_digits(size, sign, unit):
    """`format_si` writes a size from 1 to 1000 with a prefixed unit, right to six
    digits.
    """
    text = units.format_si(sign * size, unit)
    number, prefixed_unit = text.split(" ", 1)
    power = PREFIXES[prefixed_unit.removesuffix(unit)]
    assert 1 <= abs(float(number)) < 1000
    # Six digits are off by half of the sixth at most: 5e-6 of a number from 1 on.
    assert float(number) * 10.0**power == pytest.approx(sign * size, rel=5.1e-6)


class RaisingRepr:
    """An object that has no repr: asking for it fails."""

    def __repr__(self):
        raise RuntimeError


class LongRepr:
    """An object with a long repr of many lines and escapes of a terminal."""

    def __repr__(self):
        return "two\nlines \x1b[0m" * 100


def assert_is_one_short_line(line):
    """Without what a terminal would obey, such as escapes."""
    assert len(line) <= units.MOST_SHOWN
    assert line.isprintable()


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-2.0, "-2.0"),
        ("a\nb\x00\u202e", r"'a\nb\x00\u202e'"),
        ([1, [2, "x"]], "[1, [2, 'x']]"),
        pytest.param(10**5000, "a value of type int", id="5001 digits"),
    ],
)
def test_what_was_given_is_shown_in_one_short_line(value, text):
    line = units.shown(value)
    assert line == text
    assert_is_one_short_line(line)


@pytest.mark.parametrize(
    ("value", "pattern"),
    [
        pytest.param(RaisingRepr(), "<RaisingRepr instance at 0x", id="no repr"),
        pytest.param(LongRepr(), r"two lines \\x1b\[0mtwo.*\.\.\.", id="long repr"),
        pytest.param("x" * 10**6, "'x+\\.\\.\\.x+'", id="long text"),
        pytest.param({"key" * 99: ["x" * 99] * 99}, "{'key.*", id="large dictionary"),
    ],
)
def test_what_is_long_or_has_no_repr_is_shown_in_one_short_line(value, pattern):
    line = units.shown(value)
    assert re.match(pattern, line)
    assert_is_one_short_line(line)


def test_what_is_nested_3000_levels_deep_is_shown_in_short():
    deep = {}
    for _ in range(3000):
        deep = {"a": [deep]}
    assert len(units.shown(deep)) <= units.MOST_SHOWN


def test_units_are_imported_without_numpy():
    code = "import sys; sys.modules['numpy'] = None; import rodimpact.units"
    subprocess.run([sys.executable, "-B", "-c", code], check=True)


def test_a_long_text_of_blanks_shows_that_it_is_cut():
    text = "first" + 200 * " " + "second"
    assert units.one_line(text) == "first..."
    assert units.one_line("first" + 200 * " ") == "first"
