"""The three collisions of the textbook's box 10.4, "The axial collision of elastic rods".

- A rod runs into an identical rod at rest: the contact lasts 2 L/c, then the first rod rests, the
  second has its velocity, e = 1, and no vibration is left.
- A rod on a rigid wall: the same from the wall's side, e = 1.
- Rods of one material and different lengths: the short rod is left at rest, the long one has the
  mean velocity (l1/l2) v, so e = l1/l2; the vibration keeps (1 - e^2) m_coll v^2/2.

Where the text is loose:

- It puts the wave speed of metals at about 1000 m/s and the collision of 1 m rods at a few
  thousandths of a second. Steel has about 5000 m/s, and 1 m rods part after 0.4 ms.
- It says that its two elastic examples may be the only ones. Any two rods of equal transit time
  collide with e = 1, whatever their impedances.
- It says that unequal rods separate when the wave of the short one returns. The force ends then,
  after 2 l1/c; the ends go on touching without force and part after 2 l2/c.

Source: textbook section 10.5, "Collisions in 1D", box 10.4, which credits the solution by waves to
E. J. Routh.
"""

import math

import numpy as np

import rodimpact as ri

from .table import Case, Rows

BOX = "textbook, box 10.4"
STEEL, AREA, SPEED = ri.materials.steel, 1e-4, 2.0
C = math.sqrt(200e9 / 7850.0)
RATIOS = {
    "0.1 : 0.3": (0.1, 0.3),
    "0.4 : 1": (0.4, 1.0),
    "0.3 : 0.7": (0.3, 0.7),
    "1 : sqrt 2": (1.0, math.sqrt(2.0)),
    "0.99 : 1": (0.99, 1.0),
}


def run() -> Rows:
    """Identical rods, a rod on a wall, rods of different length, rods of equal transit time."""
    yield from identical_rods()
    yield from rod_on_wall()
    for name, (short, long) in RATIOS.items():
        yield from different_lengths(Case(f"rods {name}", BOX), short, long)
    yield from equal_transit_times()


def rod(length: float, velocity: float = 0.0) -> ri.Rod:
    """A steel rod."""
    return ri.Rod(length, area=AREA, material=STEEL, velocity=velocity)


def identical_rods() -> Rows:
    """Steel rods of 1 m."""
    o = ri.collide(rod(1.0, SPEED), rod(1.0))
    case = Case("identical rods", BOX)
    yield case.row("e", 1.0, o.restitution, 1e-14)
    yield case.row("velocity left after, m/s", 0.0, o.velocities_after[0], 1e-14)
    yield case.row("velocity right after, m/s", SPEED, o.velocities_after[1], 1e-14)
    yield case.row("vibration energy after, J", 0.0, sum(o.vibration_after), 1e-14)
    yield case.row("contact time, s", 2 / C, o.duration, 1e-14 * 2 / C, ": 2 L/c")
    yield case.row(
        "contact time, 1 m of steel, ms",
        0.4,
        o.duration * 1e3,
        0.005,
        "about 0.4 ms; the textbook says a few ms",
    )
    yield case.row(
        "wave speed of steel, m/s",
        5000.0,
        STEEL.wave_speed,
        100.0,
        "about 5000 m/s; the textbook says about 1000",
    )


def rod_on_wall() -> Rows:
    """A steel rod of 1 m on a wall."""
    o = ri.collide(rod(1.0, SPEED), ri.Wall())
    case = Case("rod on a rigid wall", BOX)
    yield case.row("e", 1.0, o.restitution, 1e-14)
    yield case.row("velocity after, m/s", -SPEED, o.velocities_after[0], 1e-14)
    yield case.row("vibration energy after, J", 0.0, o.vibration_after[0], 1e-14)
    yield case.row("contact time, s", 2 / C, o.duration, 1e-14 * 2 / C, ": 2 L/c")


def different_lengths(case: Case, short: float, long: float) -> Rows:
    """A short rod runs into a long one."""
    solution = ri.solve(ri.System([rod(short, SPEED), rod(long)]))
    o, contact = solution.outcome, solution.contacts[0]
    e = short / long
    m1, m2 = 7850.0 * AREA * short, 7850.0 * AREA * long
    lost = (1 - e * e) * m1 * m2 / (m1 + m2) * SPEED**2 / 2
    x, t = (
        np.linspace(0, short, 50)[:, None],
        np.linspace(2 * short / C, solution.t_end, 50)[1:],
    )
    residue = max(
        np.abs(solution.velocity(0, x, t)).max(), np.abs(solution.strain(0, x, t)).max()
    )
    yield case.row("e", e, o.restitution, 1e-13, ": l1/l2")
    yield case.row(
        "mean velocity right after, m/s",
        e * SPEED,
        o.velocities_after[1],
        1e-13,
        ": (l1/l2) v",
    )
    yield case.row(
        "largest velocity (m/s) or strain left in the short rod",
        0.0,
        residue,
        1e-13,
        ": at rest",
    )
    yield case.row(
        "vibration energy after, J",
        lost,
        sum(o.vibration_after),
        1e-13,
        "(1 - e^2) m_coll v^2/2",
    )
    yield case.row(
        "force ends at, s", 2 * short / C, o.contacts[0].last, 1e-16, ": 2 l1/c"
    )
    yield case.row(
        "gap opens at, s",
        2 * long / C,
        contact.episodes[0].opening,
        1e-16,
        "2 l2/c: touching without force until then",
    )


def equal_transit_times() -> Rows:
    """Steel on brass rods of equal transit time and very different impedance."""
    brass = ri.materials.brass
    length = 0.5 * float(brass.wave_speed) / float(STEEL.wave_speed)
    for factor in (0.1, 3.0, 20.0):
        other = ri.Rod(length, area=factor * AREA, material=brass)
        ratio = float(other.segments[0].impedance) / float(
            rod(0.5).segments[0].impedance
        )
        o = ri.collide(rod(0.5, SPEED), other)
        case = Case(
            f"equal transit times, impedances 1 : {ratio:.3g}",
            "Saint-Venant: 1 at equal transit times",
        )
        yield case.row("e", 1.0, o.restitution, 1e-13)
