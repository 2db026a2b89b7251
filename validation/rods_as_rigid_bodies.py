"""From elastic rods to rigid bodies and back.

The waves in two rods determine their coefficient of restitution e. With this e
`rigid.collide` must give the velocities of the rods and the impulse of their contact.
The energy that is lost in the rigid collision must be the vibration energy of the rods.
This is compared for random pairs of uniform rods and of stepped rods, and for rods on
fixed and moving walls. The velocities and the vibration energy of the rods are measured
from the waves at the end of the run, and the impulse at the contact.

Elastic rods are examples for the remarks of the section on e; `box_10_4` treats the
remarks of box 10.4.

- The section notes with surprise that e hardly depends on the speed. For elastic rods e
  does not depend on the speed at all.
- One material can have any e: steel rods with the length ratios 5 to 9 and 15 to 16
  have the values of e that Newton measured with balls of wool and of glass.
- Identical uniform rods collide elastically. Identical stepped rods need not: let each
  rod have a piece of impedance 1 and a piece of impedance 3 with equal transit times.
  If the thin ends collide, e = 1. If the thick ends collide, e = 1/2. So e is not a
  property of a pair of bodies: it also depends on the ends that collide. Rods that are
  not uniform can also collide elastically.

The values for stepped rods are computed by hand, in units of the closing speed and the
lower impedance. Each force lasts for the round trip of one piece. If a rod of
impedances 1 and 3 strikes a wall with the thin end, the forces are 1, 2, 1; with the
thick end the force is 3. If a rod of impedances 1 and 2 strikes a wall with the thin
end, the forces are 1, 5/3, 1/9; with the thick end they are 2, 2/3.

Source: textbook section 10.5, "Collisions in 1D": eq. 10.56, its footnotes, boxes 10.4
and 10.5.
"""

from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

import rodimpact as ri
from rodimpact import rigid

from .table import Case, Rows
from .unit import UNIT, rod

DRAWS = 200  # random systems of each kind
RESTITUTION_ATOL = 1e-12  # round-off of e outside 0 to 1
STEEL = ri.materials.steel
BRASS = ri.materials.brass
STEPPED = {  # impedances of the struck and the far piece: e
    (1.0, 3.0): Fraction(1),
    (3.0, 1.0): Fraction(1, 2),
    (1.0, 2.0): Fraction(23, 27),
    (2.0, 1.0): Fraction(7, 9),
}
NEWTON = {"wool": Fraction(5, 9), "glass": Fraction(15, 16)}  # balls: e


def run() -> Rows:
    """Compare random rods with rigid bodies; then speeds, lengths and ends decide e."""
    rng = default_rng(1905)
    uniform_pairs = []
    for _ in range(DRAWS):
        left = uniform(rng, direction=1.0)
        right = uniform(rng, direction=-1.0)
        uniform_pairs.append(ri.System([left, right]))
    stepped_pairs = []
    for _ in range(DRAWS):
        left = stepped(rng, direction=1.0)
        right = stepped(rng, direction=-1.0)
        stepped_pairs.append(ri.System([left, right]))
    fixed_walls = []
    for _ in range(DRAWS):
        fixed_walls.append(on_wall(rng, velocity=0.0))
    moving_walls = []
    for _ in range(DRAWS):
        wall_velocity = float(rng.uniform(-0.5, 0.5))
        moving_walls.append(on_wall(rng, wall_velocity))
    yield from as_rigid_bodies("pairs of uniform rods", uniform_pairs)
    yield from as_rigid_bodies("pairs of stepped rods", stepped_pairs)
    yield from as_rigid_bodies("stepped rods on a fixed wall", fixed_walls)
    yield from as_rigid_bodies("stepped rods on a moving wall", moving_walls)
    yield from every_speed()
    yield from newtons_ratios()
    yield from thin_or_thick_ends()


def uniform(rng: Generator, direction: float) -> ri.Rod:
    """A random moving rod; impedance and transit time are log-uniform from 1 to 30.

    `direction` is the sign of its velocity, 1.0 or -1.0.
    """
    logarithms = rng.uniform(0, np.log(30.0), 2)
    Z, T = np.exp(logarithms).tolist()
    speed = float(rng.uniform(0.6, 2.0))
    return rod(T, Z, direction * speed)


def stepped(rng: Generator, direction: float) -> ri.Rod:
    """A random moving rod of two or three pieces; transit times are whole numbers.

    `direction` is the sign of its velocity, 1.0 or -1.0.
    """
    pieces = []
    for _ in range(rng.integers(2, 4)):
        transit_time = float(rng.integers(1, 5))
        impedance = float(rng.uniform(0.3, 3.0))
        pieces.append(ri.Segment(transit_time, impedance, UNIT))
    speed = float(rng.uniform(0.6, 2.0))
    return ri.Rod(segments=pieces, velocity=direction * speed)


def on_wall(rng: Generator, velocity: float) -> ri.System:
    """A stepped rod that runs into a wall from the left or from the right.

    `velocity` is that of the wall.
    """
    rod = stepped(rng, direction=1.0)
    system = ri.System([rod, ri.Wall(velocity)])
    if rng.random() < 0.5:
        return system
    return system.mirrored()


class Differences(NamedTuple):
    """Differences between rods and the rigid bodies with the rods' e, dimensionless."""

    velocity: float  # largest, over the closing speed
    impulse: float  # over reduced mass times closing speed
    energy: float  # vibration left - energy lost, over mu v_rel^2/2
    restitution: float  # the rods' e


def differences_of(system: ri.System) -> Differences:
    """Relative differences between the collision of two rods and of rigid bodies.

    The rigid bodies have the e of the rods, which is returned as well. The difference
    of velocities is the largest absolute one; those of impulse and energy are signed,
    rods minus rigid bodies. The units are closing speed v, m v and m v^2/2, with the
    reduced mass m.
    """
    solution = ri.solve(system)
    outcome = solution.outcome
    bodies = outcome.as_rigid()  # the collision of rigid bodies
    mass = rigid.reduced_mass(*outcome.masses)
    closing = -bodies.relative_velocity_before
    velocity_1 = float(solution.mean_velocity(body=0, t=solution.t_end))
    velocity_2 = float(solution.mean_velocity(body=1, t=solution.t_end))
    difference_1 = abs(velocity_1 - bodies.velocity_1)
    difference_2 = abs(velocity_2 - bodies.velocity_2)
    impulse = solution.contacts[0].impulse - bodies.impulse
    energy = sum(outcome.vibration_after) - bodies.energy_lost
    return Differences(
        velocity=max(difference_1, difference_2) / closing,
        impulse=impulse / (mass * closing),
        energy=energy / (mass * closing**2 / 2),
        restitution=outcome.restitution,
    )


def as_rigid_bodies(kind: str, systems: Iterable[ri.System]) -> Rows:
    """Largest differences between rods and the rigid bodies that stand for them.

    The last row counts the values of e outside 0 to 1.
    """
    differences = [differences_of(system) for system in systems]
    velocity = [difference.velocity for difference in differences]
    impulse = [difference.impulse for difference in differences]
    energy = [difference.energy for difference in differences]
    outside = 0
    for difference in differences:
        e = difference.restitution
        if not -RESTITUTION_ATOL <= e <= 1 + RESTITUTION_ATOL:
            outside += 1
    case = Case(f"{kind}, {DRAWS} random", "`rigid.collide` with the rods' e")
    yield case.zero(
        "velocity after, over the closing speed, largest difference", velocity, 1e-13
    )
    yield case.zero(
        "impulse, over reduced mass times closing speed, largest difference",
        impulse,
        1e-13,
    )
    yield case.zero(
        "vibration left - energy lost, over mu v_rel^2/2, largest difference",
        energy,
        1e-13,
    )
    yield case.row(
        "e outside 0 to 1, number",
        0.0,
        outside,
        0.0,
        source="rods that do not vibrate before",
    )


def every_speed() -> Rows:
    """Spread of e of steel on brass at closing speeds from 1 um/s to 100 m/s."""
    restitutions = []
    speeds = 10.0 ** np.arange(-6, 3)
    for speed in speeds.tolist():
        first = ri.Rod(0.7, area=1e-4, material=STEEL, velocity=speed)
        second = ri.Rod(1.1, area=2e-4, material=BRASS)
        restitutions.append(ri.collide(first, second).restitution)
    spread = max(restitutions) - min(restitutions)
    case = Case("steel on brass, 1e-6 to 100 m/s", "the wave equation is linear")
    yield case.row("e, largest - smallest", 0.0, spread, 1e-13)


def newtons_ratios() -> Rows:
    """e of steel rods whose lengths have the ratios of e that Newton measured.

    For each kind of ball, e must be the ratio of the lengths.
    """
    source = "Newton, Principia, translated by Motte and Cajori (1947), page 25"
    for ball, e in NEWTON.items():
        short = e.numerator / 20
        long = e.denominator / 20
        first = ri.Rod(short, area=1e-4, material=STEEL, velocity=1.0)
        second = ri.Rod(long, area=1e-4, material=STEEL)
        outcome = ri.collide(first, second)
        case = Case(f"steel rods {short:g} : {long:g}", source)
        yield case.row(f"e, as of balls of {ball}", e, outcome.restitution, 1e-14)


def thin_or_thick_ends() -> Rows:
    """e of stepped rods on a wall, and of two of them as mirror images.

    Both are compared with e by hand, for each pair of impedances in `STEPPED`.
    """
    for impedances, e in STEPPED.items():
        pieces = [ri.Segment(1.0, Z, UNIT) for Z in impedances]
        rod = ri.Rod(segments=pieces, velocity=-1.0)
        left_wall = ri.System([ri.Wall(), rod])
        mirrored = left_wall.mirrored()
        image = mirrored.bodies[0]
        pair = ri.System([image, rod])
        e_on_wall = ri.solve(left_wall).outcome.restitution
        e_of_pair = ri.solve(pair).outcome.restitution
        name = "stepped rod, {:g} : {:g} from the struck end".format(*impedances)
        case = Case(name, "by hand")
        yield case.row("e on a wall", e, e_on_wall, 1e-14)
        yield case.row("e of two of them, mirror images", e, e_of_pair, 1e-14)
