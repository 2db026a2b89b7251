"""Collide two rigid bodies on a line: momentum is kept, e says how fast they part.

rodimpact rigid --m1 2 --v1 0.5 --m2 10 --v2 0.2 -e 1
"""

from __future__ import annotations

import argparse
import json
import math

from .. import rigid
from ..report import SCHEMA_VERSION, align, clean
from ..units import format_si
from . import DONE
from .asking import Mistakes, Problems, quantity


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Two masses, two velocities, a restitution."""
    for i, where in ((1, "left"), (2, "right")):
        parser.add_argument(f"--m{i}", required=True, metavar="MASS",
                            help=f'mass of the {where} body, "2 kg", or inf for a wall')
        parser.add_argument(f"--v{i}", required=True, metavar="VELOCITY",
                            help='its velocity, "0.5 m/s", positive to the right')
    parser.add_argument("-e", "--restitution", required=True, metavar="E",
                        help="coefficient of restitution, from 0 (they stick) to 1 (no loss)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Table or JSON of the collision."""
    given = vars(arguments)
    problems: Problems = []
    m1, m2 = (
        math.inf if given[name].strip() == "inf"
        else quantity(problems, f"--{name}", given[name], "mass")
        for name in ("m1", "m2")
    )
    v1, v2 = (quantity(problems, f"--{n}", given[n], "velocity") for n in ("v1", "v2"))
    e = quantity(problems, "-e", given["restitution"], "dimensionless")
    if problems:
        raise Mistakes(problems)
    try:
        collision = rigid.collide(m1, v1, m2, v2, e)
    except ValueError as error:
        given_wrong, _, wanted = str(error).partition(": ")
        raise Mistakes([(given_wrong, wanted)]) from error
    after = {name: float(value) for name, value in collision._asdict().items()}
    if arguments.json:
        inputs = {"m1": m1, "v1": v1, "m2": m2, "v2": v2, "restitution": e}
        numbers = {
            name: value if math.isfinite(value) else None
            for name, value in {**inputs, **after}.items()
        }
        return json.dumps({"schema_version": SCHEMA_VERSION, **numbers}, indent=2), DONE

    def velocity(v: float) -> str:
        return f"{clean(v, max(abs(v1), abs(v2))):.6g} m/s"

    table = align([
        ["body", "mass", "velocity before", "velocity after"],
        ["1", format_si(m1, "kg"), velocity(v1), velocity(after["velocity_1"])],
        ["2", format_si(m2, "kg"), velocity(v2), velocity(after["velocity_2"])],
    ])
    sums = align([
        ["coefficient of restitution e", format_si(e, "")],
        ["impulse", format_si(after["impulse"], "N s")],
        ["velocity of the centre of mass", velocity(after["centre_of_mass_velocity"])],
        ["kinetic energy before", format_si(after["energy_before"], "J")],
        ["kinetic energy after", format_si(after["energy_after"], "J")],
        ["kinetic energy lost", format_si(after["energy_lost"], "J")],
    ])
    return f"{table}\n\n{sums}", DONE
