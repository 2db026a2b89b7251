"""From SI values to the numbers on an axis: engineering units, and dimensionless ones."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from matplotlib.ticker import EngFormatter

from ..model import Rod
from ..model.frozen import refusal
from ..model.profiles import extremes
from ..results.labels import Quantity
from ..results.solution import Solution
from ..units import format_power
from .moments import length_name
from .placing import Placing

FIELDS = {
    "velocity": ("velocity", "m/s"),
    "stress": ("stress, tension positive", "Pa"),
    "strain": ("strain", ""),
    "displacement": ("displacement", "m"),
    "energy": ("kinetic and strain energy per length", "J/m"),
}
"""Names and units of the fields that a space-time diagram shows."""
ROUND_OFF = 1e-9  # beside the largest value shown, as good as nothing
MINUS = "\N{MINUS SIGN}"
SIGMA, RHO = "\N{GREEK SMALL LETTER SIGMA}", "\N{GREEK SMALL LETTER RHO}"
LEAST, MOST = -15, 12  # powers of ten that have a prefix here


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
        return signed(f"{value * self.factor:.3g} {self.unit}").strip()


def written(value: float, unit: str) -> str:
    """Write an SI value to three digits in its engineering unit."""
    return engineering("", value, unit).write(value)


def engineering(name: str, largest: float, unit: str) -> Scale:
    """Scale on which `largest` lies between 1 and 1000.

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
    whole = math.log10(largest * (1 + ROUND_OFF)) / 3 if largest > 0 else 0.0
    exponent = 3 * math.floor(whole)
    if not unit:
        return Scale(10.0**-exponent, name, format_power(exponent) if exponent else "")
    exponent = min(max(exponent, LEAST), MOST)
    return Scale(10.0**-exponent, name, EngFormatter.ENG_PREFIXES[exponent] + unit)


def scale_of(quantity: Quantity, largest: float) -> Scale:
    """Scale of an axis for a quantity with values up to `largest`, as an engineer would choose it.

    Powers of units other than lengths, and counts, are shown as they are.
    """
    name, unit = quantity.name, quantity.unit
    for digit, raised in zip("234", "²³⁴", strict=True):
        unit = unit.replace(f"^{digit}", raised)
    if unit in ("1", "kg/m³", "m⁴", "m/s²", "s/m"):
        return Scale(1.0, name, unit.removeprefix("1"))
    if unit == "kg":
        scale = engineering(name, 1e3 * largest, "g")
        return scale._replace(factor=1e3 * scale.factor)
    if unit == "m":
        return place_scale(largest)._replace(name=name)
    if unit == "m²":  # in mm² between 0.01 and 10 000 mm²
        side = engineering(name, 10 * math.sqrt(largest), "m")
        return Scale(side.factor**2, name, f"{side.unit}²")
    return engineering(name, largest, unit)


def digits(value: float, largest: float, count: int = 3) -> str:
    """Write a number to some digits; round-off beside the largest number shown is 0.

    Round-off does not decide which way a half is rounded.
    """
    seen = abs(value) > ROUND_OFF * largest
    return signed(f"{value * (1 + ROUND_OFF):.{count}g}" if seen else "0")


def signed(text: str) -> str:
    """Write the minus as a minus."""
    return text.replace("-", MINUS)


def multiple(value: float, unit: str) -> str:
    """Write value times unit as people do, as a fraction where a simple one is near.

    Examples
    --------
    >>> [multiple(x, "v") for x in (0, 1, 0.5, 0.4, 0.8928926)]
    ['0', 'v', 'v/2', '2v/5', '0.893v']
    """
    near = Fraction(value).limit_denominator(12)
    if abs(value - near) > ROUND_OFF * max(1.0, abs(value)):
        return signed(f"{value:.3g}{unit}")
    if near == 0:
        return "0"
    sign = MINUS if near < 0 else ""
    top, bottom = abs(near.numerator), near.denominator
    return (
        sign
        + (str(top) if top > 1 else "")
        + unit
        + (f"/{bottom}" if bottom > 1 else "")
    )


def listed(names: Sequence[str]) -> str:
    """Write names as a list: a, b and c."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def closing_speed(solution: Solution) -> float:
    """Largest speed at which neighbours approach before the collision, m/s; 0 if none do."""
    V = solution.outcome.velocities_before
    closing = max((V[k] - V[k + 1] for k in solution.outcome.unilateral), default=0.0)
    return closing if closing > 1e-12 * max(map(abs, V)) else 0.0


def first_rod(solution: Solution) -> tuple[Rod, str]:
    """Leftmost rod, by which pictures without dimensions are scaled, and the name of its length."""
    system = solution.system
    return next(
        (body, length_name(system, i))
        for i, body in enumerate(system.bodies)
        if isinstance(body, Rod)
    )


def time_scale(end: float) -> Scale:
    """Scale of an axis of time from 0 to `end` s; raise ValueError if that is no time at all."""
    if not end > 0:
        raise refusal(
            "solution", f"lasts {end!r} s and has no history; solve it with until > 0"
        )
    return engineering("time t", end, "s")


def place_scale(width: float) -> Scale:
    """Scale of an axis of places, for a row `width` m wide: metres unless it is small."""
    return (
        Scale(1.0, "place x", "m")
        if width >= 0.1
        else engineering("place x", width, "m")
    )


def place_label(plan: Placing, place: Scale) -> str:
    """Label of an axis of places: in which frame and how much magnified they are drawn."""
    if not plan.magnification:
        label = place._replace(
            name=place.name.replace("place", "material coordinate")
        ).label
        label += ", rods laid end to end, gaps left out"
        return label + mass_width(plan, place)
    label = place.label
    if plan.frame:
        label += f" in a frame moving at {written(plan.frame, 'm/s')}"
    label += mass_width(plan, place)
    if plan.free.any():
        label += ", springs drawn long"
    return f"{label}, {plan.scale}"


def mass_width(plan: Placing, place: Scale) -> str:
    """Width at which rigid masses are drawn, as a part of a label; "" without masses."""
    if not plan.block:
        return ""
    width = f"{plan.block * place.factor:g} {place.unit}".rstrip()
    return f", masses drawn {width} wide"


def axis_scales(
    solution: Solution, dimensionless: bool, duration: float, width: float
) -> tuple[Scale, Scale]:
    """Scales of time and place, for times up to `duration` s and a picture `width` m wide."""
    if dimensionless:
        rod, length = first_rod(solution)
        return (
            Scale(1 / float(rod.transit_time), f"time t c/{length}"),
            Scale(1 / float(rod.length), f"place x/{length}"),
        )
    return time_scale(duration), place_scale(width)


def field_scale(
    solution: Solution, field: str, dimensionless: bool, largest: float
) -> Scale:
    """Scale of a field of `FIELDS`, for values up to `largest`.

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
        raise refusal(
            "dimensionless",
            "velocities are scaled by the closing speed, but no bodies "
            "approach in this row; use dimensionless=False",
        )
    rod, length = first_rod(solution)
    material, area = rod.segments[0].material, extremes(rod.segments[0].area)[1]
    rho, c = float(material.density), float(material.wave_speed)
    return {
        "velocity": Scale(1 / v0, "velocity v/v₀"),
        "stress": Scale(1 / (rho * c * v0), f"stress {SIGMA}/({RHO} c v₀)"),
        "strain": Scale(c / v0, "strain ε c/v₀"),
        "displacement": Scale(
            c / (v0 * float(rod.length)), f"displacement u c/(v₀ {length})"
        ),
        "energy": Scale(
            1 / (rho * area * v0**2), f"energy per length w/({RHO} A₁ v₀²)"
        ),
    }[field]
