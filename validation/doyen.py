"""A bar meets a rigid floor: thrown without gravity, dropped with it, three bounces.

With E = 900, rho = 1, L = 10 and A = 1, c = 30, Z = 30 and L/c = 1/3. The bar starts at
a height of 5.

- Thrown at the speed 10 without gravity: the contact lasts from 0.5 to 7/6 with the
  force Z v = 300. Then the bar returns at its initial speed.
- Dropped from rest with g = 10: the bar falls for the time 1 and presses for 2 L/c =
  2/3. The force grows linearly from 300 to 500. The bar rebounds with vibration. After
  a flight of 2 the second force falls linearly from 500 to 300 and cancels the
  vibration. The bar rises for the time 1, and the motion repeats with the period 16/3.
  The impulse of each contact is 800/3.

If L/c is a multiple of the time step, contacts open and close at the end of a step.
Then the times, the impulses and the mean forces over steps are exact to round-off at
every step.

Source: D. Doyen, A. Ern, S. Piperno, Time-integration schemes for the finite element
dynamic Signorini problem, SIAM Journal on Scientific Computing 33 (2011); the ramps by
hand.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Rows

SOURCE = "Doyen, Ern and Piperno 2011"
MATERIAL = ri.Material("bar", youngs_modulus=900.0, density=1.0)
LENGTH = 10.0
AREA = 1.0
HEIGHT = 5.0  # height of the lower end at the start
SPEED = 10.0  # speed of the bar that is thrown
GRAVITY = 10.0
PERIOD = 16 / 3  # period of the bar that is dropped, L/c being 1/3
PERIODS = 3
FORCE_DURATION = 2 / 3  # 2 L/c
IMPULSE = 800 / 3  # impulse of one contact of the bar that is dropped
STEP = 1 / 150  # step of the times at which forces are compared, a 50th of L/c


def run() -> Rows:
    """Compare the bar on the right of the floor, when thrown and when dropped."""
    yield from thrown()
    yield from dropped()


def thrown() -> Rows:
    """Times, force and velocity of the bar that is thrown at the floor, no gravity.

    They are compared with values by hand: the force is constant, and e = 1.
    """
    bar = ri.Rod(LENGTH, area=AREA, material=MATERIAL, velocity=-SPEED)
    bodies = [ri.Wall(), bar]
    system = ri.System(bodies, gaps=[HEIGHT])
    solution = ri.solve(system)
    outcome = solution.outcome
    episode = solution.contacts[0].episodes[0]
    velocity = outcome.velocities_after[1]
    vibration = outcome.vibration_after[1]
    start = episode.start
    opening = episode.opening
    peak_force = outcome.peak_force
    case = Case("Doyen et al., bar on floor", SOURCE)
    yield case.row("contact begins", 0.5, start, 1e-14)
    yield case.row("contact ends", 7 / 6, opening, 1e-14)
    yield case.row("force", 300.0, peak_force, 1e-11)
    yield case.row("velocity after", SPEED, velocity, 1e-12)
    yield case.row("vibration energy after", 0.0, vibration, 1e-11)


def falling_bar() -> ri.System:
    """The bar at rest above the floor, with gravity."""
    bar = ri.Rod(LENGTH, area=AREA, material=MATERIAL)
    return ri.System([ri.Wall(), bar], gaps=[HEIGHT], gravity=-GRAVITY)


def ramps(t: np.ndarray) -> np.ndarray:
    """Force of the floor at times t: up in the first contact of a period, then down.

    Between the contacts the force is 0. The period begins when the bar is dropped.
    """
    phase = t % PERIOD
    first = (phase > 1) & (phase < 5 / 3)
    second = (phase > 11 / 3) & (phase < 13 / 3)
    rising = 300 + 300 * (phase - 1)
    falling = 500 - 300 * (phase - 11 / 3)
    return np.select([first, second], [rising, falling], 0.0)


def dropped() -> Rows:
    """Contacts, force, height and energy of the dropped bar over three periods.

    Each period has two contacts, with a rising and a falling ramp of the force. All is
    compared with values by hand.
    """
    end = PERIODS * PERIOD
    solution = ri.solve(falling_bar(), until=end)
    floor = solution.contacts[0]
    case = Case(f"Doyen et al., bar dropped on floor, {PERIODS} periods", SOURCE)
    contacts = len(floor.episodes)
    yield case.row("contacts", 2.0 * PERIODS, contacts, 0.0)
    for i, episode in enumerate(floor.episodes):
        period = i // 2  # each has two contacts, which begin at 1 and 1 + 8/3
        in_period = 1 + (i % 2) * 8 / 3
        start = period * PERIOD + in_period
        impulse = floor.impulse_until(episode.force_end)
        impulse -= floor.impulse_until(episode.start)
        name = f"contact {i + 1}"
        yield case.row(f"{name} begins", start, episode.start, 1e-12)
        force_end = start + FORCE_DURATION
        yield case.row(f"{name} ends", force_end, episode.force_end, 1e-12)
        yield case.row(f"{name}, impulse", IMPULSE, impulse, 1e-9)

    steps = round(end / STEP)
    t = (np.arange(steps) + 0.5) * STEP  # between steps, as the force jumps at steps
    force_error = floor.force(t) - ramps(t)
    yield case.zero(
        "force, largest difference from the ramps", force_error, 1e-9, source="by hand"
    )
    ends = PERIOD * np.arange(PERIODS + 1)
    height_error = floor.gap(ends) - HEIGHT
    yield case.zero("height after each period, largest difference", height_error, 1e-11)
    residual = solution.energy(end).residual
    yield case.row(
        "energy after - before - work of gravity",
        0.0,
        residual,
        1e-9,
        source="conserved",
    )
