"""Collisions to begin with, each with its gauges."""

from typing import NamedTuple

from ..materials import steel
from ..model import System
from ..model.bodies import Material, Rod, Wall
from ..storage.casefile import Case, GaugePlace

AREA = 1e-4  # m^2, of the rods of the box


class Preset(NamedTuple):
    """A collision to begin with: its key, its name, what it shows, and its case."""

    key: str
    title: str
    remark: str
    case: Case


def presets() -> list[Preset]:
    """The collisions of the textbook's box 10.4, and three more."""
    half_speed = Material(
        "half-speed metal", youngs_modulus=50e9, density=7850.0
    )  # of steel's
    rows: list[
        tuple[str, str, str, list[Rod | Wall], list[int]]
    ] = [  # and rods with gauges
        (
            "identical",
            "Identical rods",
            "They swap velocities: e = 1, and nothing is left to vibrate.",
            [steel_rod(1.0, 1.0), steel_rod(1.0)],
            [1],
        ),
        (
            "wall",
            "A rod on a rigid wall",
            "The wave runs to the free end and back; the rod leaves as fast as it came.",
            [steel_rod(1.0, 1.0), Wall()],
            [0],
        ),
        (
            "unequal",
            "Rods of different length",
            "The short rod stops dead, the long one keeps vibrating: e = l₁/l₂.",
            [steel_rod(0.4, 1.0), steel_rod(1.0)],
            [1],
        ),
        (
            "equal-transits",
            "Equal transit times",
            "Waves take equally long in both, so e = 1, whatever lengths and impedances are.",
            [steel_rod(1.0, 1.0), Rod(0.5, area=3 * AREA, material=half_speed)],
            [1],
        ),
        (
            "hopkinson",
            "Hopkinson bar",
            "A striker sends a pulse twice its length through the incident and the transmission "
            "bar, past a gauge on each.",
            [steel_rod(0.2, 10.0), steel_rod(1.0), steel_rod(1.0)],
            [1, 2],
        ),
        (
            "chain",
            "Chain of five",
            "Equal rods hand the velocity on; the last one leaves with all of it.",
            [steel_rod(0.2, 1.0), *(steel_rod(0.2) for _ in range(4))],
            [2],
        ),
    ]
    return [
        Preset(
            key,
            title,
            remark,
            Case(
                System(bodies), gauges=tuple(GaugePlace(body, 0.5) for body in gauges)
            ),
        )
        for key, title, remark, bodies, gauges in rows
    ]


def steel_rod(length: float, velocity: float = 0.0) -> Rod:
    """A rod of the box."""
    return Rod(length, area=AREA, material=steel, velocity=velocity)
