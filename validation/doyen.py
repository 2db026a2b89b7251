"""A bar meets a rigid floor: thrown without gravity, and dropped with it, three bounces.

E = 900, rho = 1, L = 10, A = 1, so c = 30, Z = 30 and L/c = 1/3; the bar starts at a height of 5.

- Thrown at speed 10 without gravity: contact from 0.5 to 7/6 with the force Z v = 300, then the bar
  goes back as it came.
- Dropped from rest at g = 10: it falls for 1, presses for 2 L/c = 2/3 with a force that ramps from
  300 to 500, and takes off vibrating. After a flight of 2 the second force ramps from 500 to 300
  and takes the vibration out again; the bar rises for 1, and all begins anew with period 16/3. Each
  contact hands over 800/3.

With a step that divides L/c, contacts open and close on steps: times, impulses and the averages of
the force over steps are those of the exact answer to round-off, at every step.

Source: D. Doyen, A. Ern, S. Piperno, Time-integration schemes for the finite element dynamic
Signorini problem, SIAM Journal on Scientific Computing 33 (2011); the ramps by hand.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Rows

SOURCE = "Doyen, Ern and Piperno 2011"
MATERIAL = ri.Material("bar", youngs_modulus=900.0, density=1.0)
PERIODS, PERIOD = 3, 16 / 3
STEP = 1 / 150  # between two looks, a 50th of L/c


def run() -> Rows:
    """The bar to the right of the floor, thrown and dropped."""
    return thrown(), dropped()


def thrown() -> Rows:
    """Without gravity."""
    bar = ri.Rod(10.0, area=1.0, material=MATERIAL, velocity=-10.0)
    solution = ri.solve(ri.System([ri.Wall(), bar], gaps=[5.0]))
    o, episode = solution.outcome, solution.contacts[0].episodes[0]
    case = Case("Doyen et al., bar on floor", SOURCE)
    yield case.row("contact begins", 0.5, episode.start, 1e-14)
    yield case.row("contact ends", 7 / 6, episode.opening, 1e-14)
    yield case.row("force", 300.0, o.peak_force, 1e-11)
    yield case.row("velocity after", 10.0, o.velocities_after[1], 1e-12)
    yield case.row("vibration energy after", 0.0, o.vibration_after[1], 1e-11)


def dropped() -> Rows:
    """With gravity, three periods."""
    bar = ri.Rod(10.0, area=1.0, material=MATERIAL)
    end = PERIODS * PERIOD
    solution = ri.solve(
        ri.System([ri.Wall(), bar], gaps=[5.0], gravity=-10.0), until=end
    )
    floor = solution.contacts[0]
    case = Case(f"Doyen et al., bar dropped on floor, {PERIODS} periods", SOURCE)
    t = (np.arange(round(end / STEP)) + 0.5) * STEP
    phase = t % PERIOD
    ramps = np.select(
        [(phase > 1) & (phase < 5 / 3), (phase > 11 / 3) & (phase < 13 / 3)],
        [300 + 300 * (phase - 1), 500 - 300 * (phase - 11 / 3)],
        0.0,
    )
    yield case.row("contacts", 2.0 * PERIODS, len(floor.episodes), 0.0)
    for i, episode in enumerate(floor.episodes):
        start = i // 2 * PERIOD + (1 + i % 2 * 8 / 3)
        handed = floor.impulse_until(episode.force_end) - floor.impulse_until(
            episode.start
        )
        yield case.row(f"contact {i + 1} begins", start, episode.start, 1e-12)
        yield case.row(f"contact {i + 1} ends", start + 2 / 3, episode.force_end, 1e-12)
        yield case.row(f"contact {i + 1}, impulse", 800 / 3, handed, 1e-9)
    ends = PERIOD * np.arange(PERIODS + 1)
    book = solution.energy(end)
    yield case.zero(
        "force, largest difference from the ramps",
        floor.force(t) - ramps,
        1e-9,
        "by hand",
    )
    yield case.zero(
        "height after each period, largest difference", floor.gap(ends) - 5.0, 1e-11
    )
    yield case.row(
        "energy after - before - work of gravity", 0.0, book.residual, 1e-9, "conserved"
    )
