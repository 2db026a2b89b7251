"""From SI values to the numbers on an axis: engineering or dimensionless units."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from matplotlib.ticker import EngFormatter

from ..methods.signals import Floats
from ..model import Rod
from ..model.frozen import invalid_argument
from ..model.profiles import extremes
from ..results.labels import Quantity
from ..results.solution import Solution
from ..units import format_power
from .labels import length_name

FIELDS = {
    "velocity": ("velocity", "m/s"),
    "stress": ("stress, tension positive", "Pa"),
    "strain": ("strain", ""),
    "displacement": ("displacement", "m"),
    "energy": ("kinetic and strain energy per length", "J/m"),
}
"""Names and units of the fields that a space-time diagram shows."""
NEGLIGIBLE_RTOL = 1e-9  # part of the largest value shown: smaller values are round-off
APPROACH_RTOL = 1e-12  # part of the largest velocity: slower approach is round-off
MINUS = "\N{MINUS SIGN}"
SIGMA = "\N{GREEK SMALL LETTER SIGMA}"
RHO = "\N{GREEK SMALL LETTER RHO}"
MIN_PREFIX_POWER = -15  # power of ten
MAX_PREFIX_POWER = 12
MAX_DENOMINATOR = 12  # denominator of a multiple that is written as a fraction
PLAIN_UNITS = ("1", "kg/m³", "m⁴", "m/s²", "s/m")  # without prefixes
MIN_ROW_IN_METRES = 0.1  # m; smaller rows are shown in mm


class Scale(NamedTuple):
    """What an axis shows: the number there is `factor` times the value in SI units."""

    factor: float
    name: str
    unit: str = ""

    @property
    def label(self) -> str:
        """Label of the axis."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def write(self, value: float) -> str:
        """Write an SI value to three digits, with its unit: 158 µs."""
        return with_minus_signs(f"{value * self.factor:.3g} {self.unit}").strip()


def quantity_text(value: float, unit: str) -> str:
    """An SI value as a text, to three digits in its engineering unit."""
    return engineering("", value, unit).write(value)


def engineering(name: str, largest: float, unit: str) -> Scale:
    """Scale on which `largest` lies between 1 and 1000: a unit with an SI prefix.

    The value 0 keeps the unit. Beyond the prefixes f and T the number on the axis may
    lie outside this range.

    Parameters
    ----------
    name : str
        What is measured.
    largest : float
        Largest absolute value to be shown, in `unit`.
    unit : str
        SI unit; "" for strain, which is written in powers of ten.
    """
    largest = abs(largest)
    exponent = 0  # power of ten, a multiple of three
    if largest > 0:
        # A number that round-off leaves just below 1000 counts as 1000.
        thousands = math.log10(largest * (1 + NEGLIGIBLE_RTOL)) / 3
        exponent = 3 * math.floor(thousands)
    if not unit:
        power = ""
        if exponent:
            power = format_power(exponent)
        return Scale(10.0**-exponent, name, power)
    exponent = min(max(exponent, MIN_PREFIX_POWER), MAX_PREFIX_POWER)
    return Scale(10.0**-exponent, name, EngFormatter.ENG_PREFIXES[exponent] + unit)


def scale_of(quantity: Quantity, largest: float) -> Scale:
    """Scale of an axis for a quantity with values up to `largest`, in customary units.

    Numbers without unit and those with `PLAIN_UNITS` are shown as they are, lengths in
    the units of `x_scale`, masses in g with a prefix, areas in the square of a prefixed
    m, and other quantities in their unit with a prefix.
    """
    name = quantity.name
    unit = quantity.unit
    for power, raised in (("^2", "²"), ("^3", "³"), ("^4", "⁴")):
        unit = unit.replace(power, raised)
    if unit in PLAIN_UNITS:
        if unit == "1":
            unit = ""
        return Scale(1.0, name, unit)
    if unit == "kg":
        scale = engineering(name, 1e3 * largest, "g")  # scale of values in g
        return scale._replace(factor=1e3 * scale.factor)
    if unit == "m":
        return x_scale(largest)._replace(name=name)
    if unit == "m²":  # the factor 10 keeps areas from 0.01 to 10 000 mm² in mm²
        side = engineering(name, 10 * math.sqrt(largest), "m")
        return Scale(side.factor**2, name, f"{side.unit}²")
    return engineering(name, largest, unit)


def largest_of(values: Floats) -> float:
    """Largest absolute value of an array."""
    return float(np.abs(values).max())


def number_text(value: float, largest: float, count: int = 3) -> str:
    """A number as a text with `count` significant digits.

    It is "0" if it is negligible beside `largest`, the largest number shown. A half in
    the digit after the last one is rounded away from 0.
    """
    if abs(value) <= NEGLIGIBLE_RTOL * largest:
        return "0"
    # Round-off may leave a half a little too small.
    return with_minus_signs(f"{value * (1 + NEGLIGIBLE_RTOL):.{count}g}")


def with_minus_signs(text: str) -> str:
    """A text with the printed minus sign in place of each hyphen."""
    return text.replace("-", MINUS)


def multiple(value: float, unit: str) -> str:
    """Write value times unit, as a fraction if one with a small denominator is equal.

    The denominator is `MAX_DENOMINATOR` at most; any other value has three digits.
    Values up to 1 may differ by `NEGLIGIBLE_RTOL` from their fraction, larger ones by
    this share of themselves.

    Examples
    --------
    >>> [multiple(x, "v") for x in (0, 1, 0.5, 0.4, 0.8928926)]
    ['0', 'v', 'v/2', '2v/5', '0.893v']
    """
    fraction = Fraction(value).limit_denominator(MAX_DENOMINATOR)
    is_near = abs(value - fraction) <= NEGLIGIBLE_RTOL * max(1.0, abs(value))
    if not is_near:
        return with_minus_signs(f"{value:.3g}{unit}")
    if fraction == 0:
        return "0"
    text = unit
    if abs(fraction.numerator) > 1:  # 1 is not written
        text = f"{abs(fraction.numerator)}{text}"
    if fraction.denominator > 1:
        text = f"{text}/{fraction.denominator}"
    if fraction < 0:
        text = f"{MINUS}{text}"
    return text


def joined_by_and(names: Sequence[str]) -> str:
    """One or more names as a list in a sentence: a, b and c."""
    if len(names) == 1:
        return names[0]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def closing_speed(solution: Solution) -> float:
    """Largest initial speed at which bodies approach at a contact that can open, m/s.

    It is 0 if none approach, or if only round-off makes them approach.
    """
    velocities = solution.outcome.velocities_before
    largest = 0.0
    for k in solution.outcome.unilateral:
        largest = max(largest, velocities[k] - velocities[k + 1])
    largest_speed = max(map(abs, velocities))
    if largest <= APPROACH_RTOL * largest_speed:
        return 0.0
    return largest


class ReferenceRod(NamedTuple):
    """Leftmost rod, which scales dimensionless pictures, and the name of its length."""

    rod: Rod
    length: str


def first_rod(solution: Solution) -> ReferenceRod:
    """The leftmost rod of the row, and the symbol of its length.

    InvalidModel is raised if the row has no rod.
    """
    system = solution.system
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod):
            return ReferenceRod(body, length_name(system, i))
    raise invalid_argument("solution", "has no rod")


def time_scale(end: float) -> Scale:
    """Scale of an axis of time from 0 to `end`, s; ValueError unless `end` > 0."""
    if not end > 0:
        raise invalid_argument(
            "solution", f"lasts {end!r} s and has no history; solve it with until > 0"
        )
    return engineering("time t", end, "s")


def x_scale(width: float) -> Scale:
    """Scale of the axis of x for a row `width` m wide: metres, but mm for a small row.

    A row is small below `MIN_ROW_IN_METRES`; a still smaller one is shown in µm or nm.
    """
    if width >= MIN_ROW_IN_METRES:
        return Scale(1.0, "place x", "m")
    return engineering("place x", width, "m")


class AxisScales(NamedTuple):
    """Scales of the two axes of a space-time diagram."""

    time: Scale
    x: Scale


def axis_scales(
    solution: Solution, dimensionless: bool, duration: float, width: float
) -> AxisScales:
    """Scales for times up to `duration`, s, and a picture `width` m wide.

    Dimensionless times are t c/l1 and dimensionless positions x/l1, with the length l1
    and the wave speed c of the first rod.
    """
    if not dimensionless:
        return AxisScales(time_scale(duration), x_scale(width))
    rod, length = first_rod(solution)
    return AxisScales(
        Scale(1 / float(rod.transit_time), f"time t c/{length}"),
        Scale(1 / float(rod.length), f"place x/{length}"),
    )


def field_scale(
    solution: Solution, field: str, dimensionless: bool, largest: float
) -> Scale:
    """Scale of a field of `FIELDS`, for values up to `largest`, SI.

    A dimensionless scale divides by the closing speed v0 and by numbers of the first
    rod: its length, and c, rho and largest area of its first segment. `largest` does
    not matter then.

    Raises
    ------
    ValueError
        If a dimensionless scale is wanted where no bodies approach each other.
    """
    name, unit = FIELDS[field]
    if not dimensionless:
        return engineering(name, largest, unit)
    v0 = closing_speed(solution)
    if v0 == 0:
        raise invalid_argument(
            "dimensionless",
            "velocities are scaled by the closing speed, but no bodies "
            "approach in this row; use dimensionless=False",
        )
    rod, length = first_rod(solution)
    material = rod.segments[0].material
    rho = float(material.density)
    c = float(material.wave_speed)
    if field == "velocity":
        return Scale(1 / v0, "velocity v/v₀")
    if field == "stress":
        return Scale(1 / (rho * c * v0), f"stress {SIGMA}/({RHO} c v₀)")
    if field == "strain":
        return Scale(c / v0, "strain ε c/v₀")
    if field == "displacement":
        factor = c / (v0 * float(rod.length))
        return Scale(factor, f"displacement u c/(v₀ {length})")
    _, area = extremes(rod.segments[0].area)  # the largest area
    factor = 1 / (rho * area * v0**2)
    return Scale(factor, f"energy per length w/({RHO} A₁ v₀²)")
