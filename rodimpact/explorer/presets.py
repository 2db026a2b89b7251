"""Collisions to begin with, each with its gauges."""

from typing import NamedTuple

from ..materials import steel
from ..model import System
from ..model.bodies import Material, Rod, Wall
from ..storage.casefile import Case, GaugePlace

AREA = 1e-4
"""Cross-sectional area of the rods of the box, m^2."""
HALF_SPEED_METAL = Material("half-speed metal", youngs_modulus=50e9, density=7850.0)
"""Material with half the bar speed of steel."""


class Preset(NamedTuple):
    """A collision to begin with."""

    key: str  # name in addresses
    title: str
    remark: str  # what the collision shows
    case: Case


def presets() -> list[Preset]:
    """The six collisions with which a user of the page may begin.

    They are the rods of the textbook's box 10.4 (identical, on a wall, of different
    length), equal transit times, a Hopkinson bar, and a chain of five rods. The strings
    are texts of the page; each case has gauges in the middles of some rods.
    """
    return [
        Preset(
            "identical",
            "Identical rods",
            "They swap velocities: e = 1, and nothing is left to vibrate.",
            case_of([steel_rod(1.0, velocity=1.0), steel_rod(1.0)], gauges=[1]),
        ),
        Preset(
            "wall",
            "A rod on a rigid wall",
            "The wave runs to the free end and back; the rod leaves as fast as it "
            "came.",
            case_of([steel_rod(1.0, velocity=1.0), Wall()], gauges=[0]),
        ),
        Preset(
            "unequal",
            "Rods of different length",
            "The short rod stops dead, the long one keeps vibrating: e = l₁/l₂.",
            case_of([steel_rod(0.4, velocity=1.0), steel_rod(1.0)], gauges=[1]),
        ),
        Preset(
            "equal-transits",
            "Equal transit times",
            "Waves take equally long in both, so e = 1, whatever lengths and "
            "impedances are.",
            case_of(
                [
                    steel_rod(1.0, velocity=1.0),
                    Rod(0.5, area=3 * AREA, material=HALF_SPEED_METAL),
                ],
                gauges=[1],
            ),
        ),
        Preset(
            "hopkinson",
            "Hopkinson bar",
            "A striker sends a pulse twice its length through the incident and the "
            "transmission bar, past a gauge on each.",
            case_of(
                [steel_rod(0.2, velocity=10.0), steel_rod(1.0), steel_rod(1.0)],
                gauges=[1, 2],
            ),
        ),
        Preset(
            "chain",
            "Chain of five",
            "Equal rods hand the velocity on; the last one leaves with all of it.",
            case_of([steel_rod(0.2, velocity=1.0), *[steel_rod(0.2)] * 4], gauges=[2]),
        ),
    ]


def case_of(bodies: list[Rod | Wall], gauges: list[int]) -> Case:
    """Case of these bodies, with a gauge in the middle of each rod in `gauges`."""
    places = tuple(GaugePlace(body, fraction=0.5) for body in gauges)
    return Case(System(bodies), gauges=places)


def steel_rod(length: float, velocity: float = 0.0) -> Rod:
    """A rod of the box: uniform, of steel, with the cross-sectional area `AREA`."""
    return Rod(length, area=AREA, material=steel, velocity=velocity)
