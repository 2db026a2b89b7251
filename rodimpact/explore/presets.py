"""Collisions to begin with, each with its gauges."""

from __future__ import annotations

from typing import NamedTuple

from ..materials import steel
from ..model import System
from ..model.bodies import Material, Rod, Wall
from ..storage.casefile import Case
from .design import Design, GaugePlace

AREA = 1e-4  # m^2, of the rods of the box


class Preset(NamedTuple):
    """A collision to begin with: its key in the address of the page, its name, what it shows."""

    key: str
    title: str
    remark: str
    design: Design


def presets() -> list[Preset]:
    """The collisions of the textbook's box 10.4, and three more."""
    return [
        Preset(
            "identical", "Identical rods",
            "They swap velocities: e = 1, and nothing is left to vibrate.",
            _design([_steel(1.0, 1.0), _steel(1.0)], GaugePlace(1, 0.5)),
        ),
        Preset(
            "wall", "A rod on a rigid wall",
            "The wave runs to the free end and back; the rod leaves as fast as it came.",
            _design([_steel(1.0, 1.0), Wall()], GaugePlace(0, 0.5)),
        ),
        Preset(
            "unequal", "Rods of different length",
            "The short rod stops dead, the long one keeps vibrating: e = l1/l2.",
            _design([_steel(0.4, 1.0), _steel(1.0)], GaugePlace(1, 0.5)),
        ),
        Preset(
            "equal-transits", "Equal transit times",
            "Waves take equally long in both, so e = 1, whatever lengths and impedances are.",
            _design(
                [
                    Rod(1.0, area=AREA, material=steel, velocity=1.0),
                    Rod(0.5, area=3 * AREA, material=_SLOW),
                ],
                GaugePlace(1, 0.5),
            ),
        ),
        Preset(
            "hopkinson", "Hopkinson bar",
            "A striker sends a pulse twice its length through the incident and the transmission "
            "bar, past a gauge on each.",
            _design(
                [_steel(0.2, 10.0), _steel(1.0), _steel(1.0)], GaugePlace(1, 0.5),
                GaugePlace(2, 0.5),
            ),
        ),
        Preset(
            "chain", "Chain of five",
            "Equal rods hand the velocity on; the last one leaves with all of it.",
            _design([_steel(0.2, 1.0), *(_steel(0.2) for _ in range(4))], GaugePlace(2, 0.5)),
        ),
    ]


_SLOW = Material("half-speed metal", youngs_modulus=50e9, density=7850.0)
"""Half the bar speed of steel, exactly: transit times are to be equal."""


def _steel(length: float, velocity: float = 0.0) -> Rod:
    return Rod(length, area=AREA, material=steel, velocity=velocity)


def _design(bodies: list[Rod | Wall], *gauges: GaugePlace) -> Design:
    return Design(Case(System(bodies)), gauges)
