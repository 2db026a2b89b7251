"""Collide two rigid bodies on a line: momentum is kept, e says how fast they part.

rodimpact rigid --m1 2 --v1 0.5 --m2 10 --v2 0.2 -e 1
"""

import argparse
import math

from .. import rigid
from ..model.frozen import raise_noted
from ..storage.tables import align, as_json, clean
from ..units import format_si
from . import DONE
from .asking import Given, Number, number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Two masses, two velocities, a restitution."""
    for i, where in ((1, "left"), (2, "right")):
        parser.add_argument(
            f"--m{i}",
            required=True,
            metavar="MASS",
            help=f'mass of the {where} body, "2 kg", or inf for a wall',
        )
        number(
            parser,
            f"--v{i}",
            "velocity",
            'its velocity, "0.5 m/s", positive to the right',
            required=True,
        )
    parser.add_argument(
        "--restitution",
        "-e",
        required=True,
        metavar="E",
        action=Number,
        const="dimensionless",
        help="coefficient of restitution: 0 they stick, 1 no energy is lost; "
        "below 0 one passes through the other",
    )
    parser.add_argument(
        "--energy-release",
        action="store_true",
        help="allow |e| > 1, as when something explodes between the bodies",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: Given) -> tuple[str, int]:
    """Table or JSON of the collision."""
    m1, m2 = (
        math.inf
        if text.strip().lower() == "inf"
        else given.number(option, text, "mass")
        for option, text in (("--m1", given.m1), ("--m2", given.m2))
    )
    v1, v2, e = given.v1, given.v2, given.restitution
    raise_noted(given.problems)
    with given.naming():
        collision = rigid.collide(
            m1, v1, m2, v2, e, allow_energy_release=given.energy_release
        )
    found = {name: float(value) for name, value in collision._asdict().items()}
    if given.json:
        return as_json(m1=m1, v1=v1, m2=m2, v2=v2, restitution=e, **found), DONE
    fastest = max(abs(v1), abs(v2))

    def velocity(v: float) -> str:
        return f"{clean(v, fastest):.6g} m/s"

    def momentum(m: float, v: float) -> str:
        return format_si(clean(m * v, min(m1, m2) * fastest), "N s")

    rows = [
        [
            "body",
            "mass",
            "velocity before",
            "velocity after",
            "momentum before",
            "momentum after",
        ]
    ]
    for i, m, v, w in (
        (1, m1, v1, found["velocity_1"]),
        (2, m2, v2, found["velocity_2"]),
    ):
        rows.append(
            [
                str(i),
                format_si(m, "kg"),
                velocity(v),
                velocity(w),
                momentum(m, v),
                momentum(m, w),
            ]
        )
    sums = [
        ["coefficient of restitution e", format_si(e, "")],
        ["speed of approach", velocity(-found["relative_velocity_before"])],
        ["speed of separation", velocity(found["relative_velocity_after"])],
        ["impulse on body 2", format_si(found["impulse"], "N s")],
        ["velocity of the centre of mass", velocity(found["centre_of_mass_velocity"])],
        ["kinetic energy before", format_si(found["energy_before"], "J")],
        ["kinetic energy after", format_si(found["energy_after"], "J")],
        ["kinetic energy lost", format_si(found["energy_lost"], "J")],
    ]
    return f"{align(rows)}\n\n{align(sums)}", DONE
