"""From elastic rods to rigid bodies and back.

The waves in two rods decide their coefficient of restitution. Given that one number,
`rigid.collide` must find the velocities of the rods and the impulse of their contact, and the
energy it calls lost must be the vibration the rods are left with: for pairs of uniform rods, pairs
of stepped rods, and rods on fixed and moving walls, at random. The rods' velocities and vibration
are measured in the waves at the end of the run, the impulse at the contact.

What rods add to the section's remarks on e, beside what `box_10_4` says of box 10.4:

- The section marvels that e hardly depends on the speed. Elastic rods have exactly one e at all
  speeds.
- One material gives any e: steel rods with lengths as 5 to 9, or 15 to 16, have the ratios that
  Newton measured with balls of wool and of glass.
- Identical rods collide elastically if they are uniform. Take two rods, each a piece of impedance 1
  and one of impedance 3 with equal transit times: meeting with the thin ends they have e = 1, with
  the thick ends e = 1/2. So e belongs not to a pair of bodies but to how they meet, and there are
  elastic collisions of rods that are not uniform.

The values for stepped rods are worked out by hand. With the closing speed and the lower impedance
as units, a rod that strikes a wall with the thin end of 1 : 3 presses with 1, 2, 1, each for a
round trip of one piece, and with the thick end with 3; with the thin end of 1 : 2 it presses with
1, 5/3, 1/9, and with the thick end with 2, 2/3.

Source: textbook section 10.5, "Collisions in 1D": eq. 10.56, its footnotes, boxes 10.4 and 10.5.
"""

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

import rodimpact as ri
from rodimpact import rigid

from .table import Case, Row, Rows
from .unit import UNIT, rod

MANY = 200
STEPPED = {  # impedances of the struck and the far piece: e
    (1.0, 3.0): Fraction(1),
    (3.0, 1.0): Fraction(1, 2),
    (1.0, 2.0): Fraction(23, 27),
    (2.0, 1.0): Fraction(7, 9),
}


def run() -> Rows:
    """Rods against rigid bodies, and what decides e."""
    rng = np.random.default_rng(1905)
    pairs = [ri.System([uniform(rng, 1.0), uniform(rng, -1.0)]) for _ in range(MANY)]
    steps = [ri.System([stepped(rng, 1.0), stepped(rng, -1.0)]) for _ in range(MANY)]
    fixed = [on_wall(rng, 0.0) for _ in range(MANY)]
    moving = [on_wall(rng, float(rng.uniform(-0.5, 0.5))) for _ in range(MANY)]
    return (
        as_rigid_bodies("pairs of uniform rods", pairs),
        as_rigid_bodies("pairs of stepped rods", steps),
        as_rigid_bodies("stepped rods on a fixed wall", fixed),
        as_rigid_bodies("stepped rods on a moving wall", moving),
        every_speed(),
        newtons_ratios(),
        thin_or_thick_ends(),
    )


def uniform(rng: np.random.Generator, direction: float) -> ri.Rod:
    """A rod of impedance and transit time log-uniform over 1 : 30, moving in a direction."""
    Z, T = np.exp(rng.uniform(0, np.log(30.0), 2)).tolist()
    return rod(T, Z, direction * float(rng.uniform(0.6, 2.0)))


def stepped(rng: np.random.Generator, direction: float) -> ri.Rod:
    """A rod of two or three pieces, whose transit times are whole numbers."""
    pieces = [
        ri.Segment(float(rng.integers(1, 5)), float(rng.uniform(0.3, 3.0)), UNIT)
        for _ in range(rng.integers(2, 4))
    ]
    return ri.Rod(segments=pieces, velocity=direction * float(rng.uniform(0.6, 2.0)))


def on_wall(rng: np.random.Generator, velocity: float) -> ri.System:
    """A stepped rod that runs into a wall from the left or from the right."""
    system = ri.System([stepped(rng, 1.0), ri.Wall(velocity)])
    return system if rng.random() < 0.5 else system.mirrored()


def as_rigid_bodies(kind: str, systems: Iterable[ri.System]) -> Rows:
    """Largest differences between rods and the rigid bodies that stand for them."""
    worst, outside = np.zeros(3), 0
    for system in systems:
        solution = ri.solve(system)
        outcome = solution.outcome
        body = outcome.as_rigid()
        mass, closing = (
            rigid.contact_mass(*outcome.masses),
            -body.relative_velocity_before,
        )
        velocities = [float(solution.mean_velocity(i, solution.t_end)) for i in (0, 1)]
        worst = np.maximum(
            worst,
            np.abs(
                [
                    max(
                        abs(velocities[0] - body.velocity_1),
                        abs(velocities[1] - body.velocity_2),
                    )
                    / closing,
                    (solution.contacts[0].impulse - body.impulse) / (mass * closing),
                    (sum(outcome.vibration_after) - body.energy_lost)
                    / (mass * closing**2 / 2),
                ]
            ),
        )
        outside += not -1e-12 <= outcome.restitution <= 1 + 1e-12
    case = Case(f"{kind}, {MANY} random", "`rigid.collide` with the rods' e")
    yield case.row(
        "velocity after, over the closing speed, largest difference",
        0.0,
        worst[0],
        1e-13,
    )
    yield case.row(
        "impulse, over contact mass times closing speed, largest difference",
        0.0,
        worst[1],
        1e-13,
    )
    yield case.row(
        "vibration left - energy lost, over m_coll v_rel^2/2, largest difference",
        0.0,
        worst[2],
        1e-13,
    )
    yield case.row(
        "e outside 0 to 1, number", 0.0, outside, 0.0, "rods that do not vibrate before"
    )


def every_speed() -> Rows:
    """Steel on brass at closing speeds from 1 um/s to 100 m/s."""
    speeds = 10.0 ** np.arange(-6, 3)
    e = [
        ri.collide(
            ri.Rod(0.7, area=1e-4, material=ri.materials.steel, velocity=float(v)),
            ri.Rod(1.1, area=2e-4, material=ri.materials.brass),
        ).restitution
        for v in speeds
    ]
    yield Row(
        "steel on brass, 1e-6 to 100 m/s",
        "e, largest - smallest",
        "the wave equation is linear",
        0.0,
        max(e) - min(e),
        1e-13,
    )


def newtons_ratios() -> Rows:
    """Steel rods whose lengths have the ratios that Newton measured."""
    source = "Newton, Principia, translated by Motte and Cajori (1947), page 25"
    for ball, e in (("wool", Fraction(5, 9)), ("glass", Fraction(15, 16))):
        short, long = e.numerator / 20, e.denominator / 20
        outcome = ri.collide(
            ri.Rod(short, area=1e-4, material=ri.materials.steel, velocity=1.0),
            ri.Rod(long, area=1e-4, material=ri.materials.steel),
        )
        yield Row(
            f"steel rods {short:g} : {long:g}",
            f"e, as of balls of {ball}",
            source,
            e,
            outcome.restitution,
            1e-14,
        )


def thin_or_thick_ends() -> Rows:
    """Stepped rods on a wall, and two of them as mirror images."""
    for impedances, e in STEPPED.items():
        pieces = [ri.Segment(1.0, Z, UNIT) for Z in impedances]
        right = ri.System([ri.Wall(), ri.Rod(segments=pieces, velocity=-1.0)])
        left = right.mirrored()
        both = ri.System([left.bodies[0], right.bodies[1]])
        case = Case(
            "stepped rod, {:g} : {:g} from the struck end".format(*impedances),
            "by hand",
        )
        yield case.row("e on a wall", e, ri.solve(right).outcome.restitution, 1e-14)
        yield case.row(
            "e of two of them, mirror images",
            e,
            ri.solve(both).outcome.restitution,
            1e-14,
        )
