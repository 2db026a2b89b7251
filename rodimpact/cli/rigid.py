"""Collide two rigid bodies on a line: momentum is kept, e says how fast they part.

rodimpact rigid --m1 2 --v1 0.5 --m2 10 --v2 0.2 -e 1
"""

from __future__ import annotations

import argparse
import math

from .. import rigid
from ..model.frozen import raise_noted
from ..storage.tables import align, as_json, clean, finite
from ..units import format_si
from . import DONE
from .asking import Given, Number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Two masses, two velocities, a restitution."""
    for i, where in ((1, "left"), (2, "right")):
        parser.add_argument(f"--m{i}", required=True, metavar="MASS",
                            help=f'mass of the {where} body, "2 kg", or inf for a wall')
        parser.add_argument(f"--v{i}", required=True, action=Number, dimension="velocity",
                            help='its velocity, "0.5 m/s", positive to the right')
    parser.add_argument("--restitution", "-e", required=True, action=Number,
                        dimension="dimensionless", metavar="E",
                        help="coefficient of restitution: 0 they stick, 1 no energy is lost; "
                        "below 0 one passes through the other")
    parser.add_argument("--energy-release", action="store_true",
                        help="allow |e| > 1, as when something explodes between the bodies")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: Given) -> tuple[str, int]:
    """Table or JSON of the collision."""
    m1, m2 = (math.inf if text.strip().lower() == "inf" else given.number(option, text, "mass")
              for option, text in (("--m1", given.m1), ("--m2", given.m2)))
    v1, v2, e = given.v1, given.v2, given.restitution
    raise_noted(given.problems)
    collision = given.attempt(rigid.collide, m1, v1, m2, v2, e,
                              allow_energy_release=given.energy_release)
    raise_noted([(option, message.replace("set allow_energy_release=True", "give --energy-release")
                  .replace("m1", "--m1")) for option, message in given.problems])
    assert collision is not None  # or there were problems
    after = {name: float(value) for name, value in collision._asdict().items()}
    if given.json:
        inputs = {"m1": m1, "v1": v1, "m2": m2, "v2": v2, "restitution": e}
        numbers = {name: finite(value) for name, value in {**inputs, **after}.items()}
        return as_json(**numbers), DONE

    def velocity(v: float) -> str:
        return f"{clean(v, max(abs(v1), abs(v2))):.6g} m/s"

    def total(value: float, unit: str) -> str:
        return format_si(value if math.isfinite(value) else math.nan, unit)

    def momentum(m: float, v: float) -> str:
        scale = min(m1, m2) * max(abs(v1), abs(v2))
        return total(clean(m * v, scale) if math.isfinite(m) else math.nan, "N s")

    bodies = [(m1, v1, after["velocity_1"]), (m2, v2, after["velocity_2"])]
    table = align([
        ["body", "mass", "velocity before", "velocity after", "momentum before", "momentum after"],
        *([str(i), format_si(m, "kg"), velocity(v), velocity(w), momentum(m, v), momentum(m, w)]
          for i, (m, v, w) in enumerate(bodies, 1)),
    ])
    sums = align([
        ["coefficient of restitution e", format_si(e, "")],
        ["speed of approach", velocity(-after["relative_velocity_before"])],
        ["speed of separation", velocity(after["relative_velocity_after"])],
        ["impulse on body 2", format_si(after["impulse"], "N s")],
        ["velocity of the centre of mass", velocity(after["centre_of_mass_velocity"])],
        ["kinetic energy before", total(after["energy_before"], "J")],
        ["kinetic energy after", total(after["energy_after"], "J")],
        ["kinetic energy lost", format_si(after["energy_lost"], "J")],
    ])
    return f"{table}\n\n{sums}", DONE
