"""Compute a collision of two rigid bodies on a line.

rodimpact rigid --m1 2 --v1 0.5 --m2 10 --v2 0.2 -e 1

The momentum is conserved. --restitution gives the coefficient of restitution e: the
speed of separation divided by the speed of approach.
"""

import argparse
import math
from typing import NamedTuple

from .. import rigid
from ..model.frozen import raise_if_problems
from ..storage.tables import align, versioned_json, without_round_off
from ..units import format_si
from .arguments import Arguments, NumberAction, add_number
from .exit_status import DONE, CommandResult

HEADER = [
    "body",
    "mass",
    "velocity before",
    "velocity after",
    "momentum before",
    "momentum after",
]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add options: two masses, two velocities, e, --energy-release and --json.

    The five numbers are required.
    """
    for i, side in ((1, "left"), (2, "right")):
        parser.add_argument(
            f"--m{i}",
            required=True,
            metavar="MASS",
            help=f'mass of the {side} body, such as "2 kg"; inf for a wall',
        )
        add_number(
            parser,
            f"--v{i}",
            "velocity",
            f'velocity of the {side} body, such as "0.5 m/s"; positive to the right',
            required=True,
        )
    parser.add_argument(
        "--restitution",
        "-e",
        required=True,
        metavar="E",
        action=NumberAction,
        const="dimensionless",
        help="coefficient of restitution: 1 if no energy is lost, 0 if the bodies "
        "stick together, below 0 if one body passes through the other",
    )
    parser.add_argument(
        "--energy-release",
        action="store_true",
        help="allow e above 1 or below -1: an explosion between the bodies adds energy",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: Arguments) -> CommandResult:
    """Collide the bodies; two tables, of the bodies and of the collision, or JSON.

    InvalidModel is raised for numbers that cannot be read or are not possible.
    """
    m1 = _mass(args, "--m1", args.m1)
    m2 = _mass(args, "--m2", args.m2)
    raise_if_problems(args.problems)
    e = args.restitution
    with args.naming_mistakes():
        collision = rigid.collide(
            m1, args.v1, m2, args.v2, e, allow_energy_release=args.energy_release
        )
    numbers = {name: float(value) for name, value in collision._asdict().items()}
    if args.json:
        text = versioned_json(
            m1=m1, v1=args.v1, m2=m2, v2=args.v2, restitution=e, **numbers
        )
        return CommandResult(text, DONE)
    bodies = [
        Body(m1, args.v1, numbers["velocity_1"]),
        Body(m2, args.v2, numbers["velocity_2"]),
    ]
    fastest = max(abs(args.v1), abs(args.v2))
    # The scale has the smaller mass, since the mass of a wall is infinite.
    scales = Scales(velocity=fastest, momentum=min(m1, m2) * fastest)
    rows = [HEADER]
    for number, body in enumerate(bodies, 1):
        rows.append(_row(number, body, scales))
    sums = [
        ["coefficient of restitution e", format_si(e, "")],
        # Relative velocities are those of body 2, so approach is negative.
        ["speed of approach", scales.speed_text(-numbers["relative_velocity_before"])],
        ["speed of separation", scales.speed_text(numbers["relative_velocity_after"])],
        ["impulse on body 2", format_si(numbers["impulse"], "N s")],
        [
            "velocity of the centre of mass",
            scales.speed_text(numbers["centre_of_mass_velocity"]),
        ],
        ["kinetic energy before", format_si(numbers["energy_before"], "J")],
        ["kinetic energy after", format_si(numbers["energy_after"], "J")],
        ["kinetic energy lost", format_si(numbers["energy_lost"], "J")],
    ]
    return CommandResult(f"{align(rows)}\n\n{align(sums)}", DONE)


def _mass(args: Arguments, option: str, text: str) -> float:
    """Mass of a body, kg; infinite for "inf"; nan, with a problem, for a wrong text."""
    if text.strip().lower() == "inf":
        return math.inf
    return args.number(option, text, "mass")


class Body(NamedTuple):
    """A body before and after the collision."""

    mass: float  # kg
    velocity_before: float  # m/s
    velocity_after: float


class Scales(NamedTuple):
    """Scales of a collision; numbers that are round-off beside them are shown as 0."""

    velocity: float  # m/s
    momentum: float  # N s

    def speed_text(self, v: float) -> str:
        """A velocity as a text."""
        return f"{without_round_off(v, scale=self.velocity):.6g} m/s"

    def momentum_text(self, mass: float, v: float) -> str:
        """The momentum of a mass as a text."""
        return format_si(without_round_off(mass * v, scale=self.momentum), "N s")


def _row(number: int, body: Body, scales: Scales) -> list[str]:
    """Row of the table: mass, and velocities and momenta of a body before and after."""
    return [
        str(number),
        format_si(body.mass, "kg"),
        scales.speed_text(body.velocity_before),
        scales.speed_text(body.velocity_after),
        scales.momentum_text(body.mass, body.velocity_before),
        scales.momentum_text(body.mass, body.velocity_after),
    ]
