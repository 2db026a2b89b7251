"""The collisions of the textbook's box 10.4, "The axial collision of elastic rods".

- A rod hits an identical rod at rest. The contact lasts 2 L/c. Then the first rod is at
  rest, and the second rod has its velocity: e = 1. No vibration remains.
- A rod hits a rigid wall: e = 1.
- Rods of one material have different lengths. After the collision the short rod is at
  rest, and the long rod has the mean velocity (l1/l2) v, so e = l1/l2. The vibration
  energy is (1 - e^2) mu v^2/2 with the reduced mass mu = m1 m2/(m1 + m2).

The text of the textbook is inaccurate in three places:

- The text states a wave speed of about 1000 m/s for metals, and a few milliseconds for
  the collision of rods of 1 m. Steel has about 5000 m/s, and such rods separate after
  0.4 ms.
- The text says that its two elastic examples may be the only ones. In fact any two rods
  of equal transit time collide with e = 1, for all impedances.
- The text says that unequal rods separate when the wave of the short rod returns. In
  fact only the force ends at this time, 2 l1/c. The ends then touch without force, and
  the gap opens at 2 l2/c.

Source: textbook section 10.5, "Collisions in 1D", box 10.4, which credits the solution
by waves to E. J. Routh.
"""

import math

import numpy as np

import rodimpact as ri

from .table import Case, Rows, largest_magnitude

BOX = "textbook, box 10.4"
STEEL = ri.materials.steel
DENSITY = 7850.0  # kg/m^3
C = math.sqrt(200e9 / DENSITY)  # m/s
AREA = 1e-4  # m^2
SPEED = 2.0  # m/s
LENGTHS = {  # lengths of the short and the long rod, m
    "0.1 : 0.3": (0.1, 0.3),
    "0.4 : 1": (0.4, 1.0),
    "0.3 : 0.7": (0.3, 0.7),
    "1 : sqrt 2": (1.0, math.sqrt(2.0)),
    "0.99 : 1": (0.99, 1.0),
}
AREA_RATIOS = (0.1, 3.0, 20.0)  # brass over steel


def run() -> Rows:
    """Compare identical rods, a rod on a wall, unequal lengths, equal transit times."""
    yield from identical_rods()
    yield from rod_on_wall()
    for name, (short, long) in LENGTHS.items():
        case = Case(f"rods {name}", BOX)
        yield from different_lengths(case, short, long)
    yield from equal_transit_times()


def rod(length: float, velocity: float = 0.0) -> ri.Rod:
    """A steel rod."""
    return ri.Rod(length, area=AREA, material=STEEL, velocity=velocity)


def identical_rods() -> Rows:
    """e, velocities, vibration and contact time of two identical steel rods of 1 m.

    The second one is at rest before. The wave speed of steel is compared, too.
    """
    striker = rod(1.0, SPEED)
    struck = rod(1.0)
    outcome = ri.collide(striker, struck)
    left_after, right_after = outcome.velocities_after
    vibration = sum(outcome.vibration_after)
    duration = outcome.duration
    expected_duration = 2 / C
    round_off = 1e-14 * expected_duration
    e = outcome.restitution
    case = Case("identical rods", BOX)
    yield case.row("e", 1.0, e, 1e-14)
    yield case.row("velocity left after, m/s", 0.0, left_after, 1e-14)
    yield case.row("velocity right after, m/s", SPEED, right_after, 1e-14)
    yield case.row("vibration energy after, J", 0.0, vibration, 1e-14)
    yield case.row(
        "contact time, s", expected_duration, duration, round_off, detail="2 L/c"
    )
    milliseconds = 1e3 * duration
    source = "about 0.4 ms; the textbook says a few ms"
    yield case.row(
        "contact time, 1 m of steel, ms", 0.4, milliseconds, 0.005, source=source
    )
    source = "about 5000 m/s; the textbook says about 1000"
    wave_speed = STEEL.wave_speed
    yield case.row("wave speed of steel, m/s", 5000.0, wave_speed, 100.0, source=source)


def rod_on_wall() -> Rows:
    """e, velocity, vibration and contact time of a steel rod of 1 m on a rigid wall.

    The expected values are those of the textbook: e = 1, the velocity reversed, no
    vibration, and the time 2 L/c.
    """
    striker = rod(1.0, SPEED)
    outcome = ri.collide(striker, ri.Wall())
    velocity = outcome.velocities_after[0]
    vibration = outcome.vibration_after[0]
    duration = 2 / C
    round_off = 1e-14 * duration
    e = outcome.restitution
    case = Case("rod on a rigid wall", BOX)
    yield case.row("e", 1.0, e, 1e-14)
    yield case.row("velocity after, m/s", -SPEED, velocity, 1e-14)
    yield case.row("vibration energy after, J", 0.0, vibration, 1e-14)
    yield case.row(
        "contact time, s", duration, outcome.duration, round_off, detail="2 L/c"
    )


def motion_left(solution: ri.Solution, length: float, since: float) -> float:
    """Largest absolute velocity (m/s) or strain in the first rod after a time, s."""
    x = np.linspace(0, length, 50)[:, None]
    t = np.linspace(since, solution.t_end, 50)[1:]  # at `since` itself fields jump
    velocity = solution.velocity(0, x, t)
    strain = solution.strain(0, x, t)
    return max(largest_magnitude(velocity), largest_magnitude(strain))


def lost_energy(short: float, long: float) -> float:
    """Energy that rods of these lengths lose to vibration: (1 - e^2) mu v^2/2, J.

    mu = m1 m2/(m1 + m2) is the reduced mass, v the closing speed, and e = short/long.
    """
    e = short / long
    m1 = DENSITY * AREA * short
    m2 = DENSITY * AREA * long
    lost_share = 1 - e * e
    return lost_share * m1 * m2 / (m1 + m2) * SPEED**2 / 2


def different_lengths(case: Case, short: float, long: float) -> Rows:
    """A short rod runs into a long one: the short one is left at rest, e = l1/l2.

    Velocity and vibration of the long one, the end of the force and the opening of the
    gap are compared as well.
    """
    striker = rod(short, SPEED)
    struck = rod(long)
    system = ri.System([striker, struck])
    solution = ri.solve(system)
    outcome = solution.outcome
    episode = solution.contacts[0].episodes[0]
    e = short / long
    velocity = outcome.velocities_after[1]
    force_end = 2 * short / C
    opening = 2 * long / C
    vibration = sum(outcome.vibration_after)
    lost = lost_energy(short, long)
    yield case.row("e", e, outcome.restitution, 1e-13, detail="l1/l2")
    yield case.row(
        "mean velocity right after, m/s",
        e * SPEED,
        velocity,
        1e-13,
        detail="(l1/l2) v",
    )
    residue = motion_left(solution, short, since=force_end)
    yield case.row(
        "largest velocity (m/s) or strain left in the short rod",
        0.0,
        residue,
        1e-13,
        detail="at rest",
    )
    yield case.row(
        "vibration energy after, J",
        lost,
        vibration,
        1e-13,
        source="(1 - e^2) mu v^2/2",
    )
    last_force = outcome.contacts[0].last
    yield case.row("force ends at, s", force_end, last_force, 1e-16, detail="2 l1/c")
    yield case.row(
        "gap opens at, s",
        opening,
        episode.opening,
        1e-16,
        source="2 l2/c: touching without force until then",
    )


def impedance(rod: ri.Rod) -> float:
    """Impedance of a uniform rod, kg/s."""
    return float(rod.segments[0].impedance)


def equal_transit_times() -> Rows:
    """e of steel on brass at equal transit times and very different impedances: 1.

    There is one row for each ratio of areas.
    """
    brass = ri.materials.brass
    length = 0.5 * float(brass.wave_speed) / float(STEEL.wave_speed)
    for area_ratio in AREA_RATIOS:
        first = rod(0.5, SPEED)
        second = ri.Rod(length, area=area_ratio * AREA, material=brass)
        ratio = impedance(second) / impedance(first)
        outcome = ri.collide(first, second)
        e = outcome.restitution
        case = Case(
            f"equal transit times, impedances 1 : {ratio:.3g}",
            "Saint-Venant: 1 at equal transit times",
        )
        yield case.row("e", 1.0, e, 1e-13)
