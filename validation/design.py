"""Designs solved backwards and forwards: stepped strikers, a momentum trap.

Stepped strikers: ten segments with the transit time T/20, with areas from e^-4 to e^1.5
of the area of the bar. The desired pulse has the duration T, and its peak is 0.8 of the
peak that a striker with the section of the bar gives. The misfit is computed from the
mean force over each step, for the time 2 T, which includes ringing: the root mean
square of the difference, divided by the peak. In addition, the best staircase differs
from the desired shape within its steps by 4.5, 5.9 and 2.0 %. The expected misfit is 0.
The bounds are slightly above the misfit that least squares reach from many random
starts.

Hidden strikers: twenty strikers with ten such steps, bonded to the bar so that they can
pull. The logarithms of their areas are uniformly distributed between the limits. Their
pulse over 2 T is computed here from the reflections at each step, and the design must
find the striker from its pulse. Large steps hide the steps behind them: the sixteen
digits of a pulse then do not determine the areas to 1e-6. This happened to two of a
hundred strikers, and is allowed for one of the twenty.

Trap: the pulse of the striker, with the momentum m V, runs back and forth in the bar,
and leaves the bar at its second arrival. The gap is the displacement of the end of the
bar during the pulse, V 2 L/c.

Source: closed forms; for traps in tension bars S. Nemat-Nasser, J. B. Isaacs and J. E.
Starrett, Proceedings of the Royal Society A 435 (1991) 371.
"""

import math

import numpy as np
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.model.quantities import Floats

from .table import Case, Rows, largest_magnitude

STEEL = ri.materials.steel
C = STEEL.wave_speed
AREA = 3e-4  # m^2
BAR = ri.Rod(1.0, area=AREA, material=STEEL)
Z = BAR.segments[0].impedance
SPEED = 10.0  # speed of the striker, m/s
DURATION = 100e-6  # duration of the pulse, s
SEGMENTS = 10  # segments of a striker
AREA_RATIO = (math.exp(-4.0), math.exp(1.5))  # limits of areas over that of the bar
HIDDEN_STRIKERS = 20
AREA_RTOL = 1e-6  # error that an area of a hidden striker may have
STRIKER_LENGTH = 0.2  # length of the striker before a momentum trap, m


def run() -> Rows:
    """Strikers for three pulses, hidden strikers, and a momentum trap."""
    s = np.linspace(0, 1, 2001)
    half_sine = np.sin(np.pi * s)
    corners = [0, 0.3, 0.8, 1]
    heights = [0, 1, 1, 0]
    trapezoid = np.interp(s, corners, heights)
    corners_text = "corners at 0, .3, .8, 1"
    yield from striker_for("half sine", half_sine, bound=0.045)
    yield from striker_for(f"trapezoid, {corners_text}", trapezoid, bound=0.062)
    yield from striker_for("ramp, then 0", s, bound=0.128)
    yield from hidden_strikers()
    yield from momentum_trap()


def striker_for(name: str, shape: Floats, bound: float) -> Rows:
    """Misfit of a stepped striker for a pulse of a shape, given at equal times.

    The part of the misfit that no choice of areas can remove is subtracted.
    """
    peak = 0.8 * Z * SPEED / 2  # a striker like the bar gives Z V/2
    times = np.linspace(0, 1, 2001) * DURATION
    pulse = ri.Signal(peak * shape, times, unit="N")
    design = ri.design.striker(
        pulse,
        BAR,
        velocity=SPEED,
        duration=DURATION,
        segments=SEGMENTS,
        area_ratio=AREA_RATIO,
    )
    misfit = math.sqrt(design.misfit**2 - design.staircase**2)
    case = Case(f"striker for a pulse: {name}", "the wanted shape")
    yield case.row("misfit of the steps over the peak", 0.0, misfit, bound)


def glued_pulse(ratios: Floats, round_trips: int) -> Floats:
    """Force over Z V on a bar that a striker is glued to, one value a round trip.

    `ratios` are impedances of the striker's segments over that of the bar, from the
    struck end on. A round trip is that of one segment. At a step from Z1 to Z2 the
    waves a and b that arrive make the velocity v = (Z1 a + Z2 b)/(Z1 + Z2); 2 v - a and
    2 v - b leave.
    """
    towards = np.ones(len(ratios))  # waves that run towards the bar, one a segment
    away = np.ones(len(ratios))  # waves that run away from the bar
    sums = ratios[:-1] + ratios[1:]
    forces = []
    for half in range(2 * round_trips):  # half a round trip is one transit
        # No wave arrives in the bar (b = 0): its force over Z V is its velocity over V.
        force = towards[0] / (1 / ratios[0] + 1)
        if half % 2 == 0:
            forces.append(force)
        from_near_segment = ratios[:-1] * away[:-1]
        from_far_segment = ratios[1:] * towards[1:]
        v = (from_near_segment + from_far_segment) / sums  # velocity of each step
        next_towards = np.append(2 * v - away[:-1], away[-1])  # the far end is free
        reflected = towards[0] - 2 * force / ratios[0]  # the wave that the bar reflects
        away = np.append(reflected, 2 * v - towards[1:])
        towards = next_towards
    return np.array(forces)


def random_ratios(seed: int) -> Floats:
    """Impedances of a hidden striker over that of the bar, from the struck end on."""
    rng = default_rng(seed)
    return np.exp(rng.uniform(-4, 1.5, SEGMENTS))


def reconstructed(ratios: Floats) -> ri.design.PulseDesign:
    """Design of a striker for the pulse of a hidden one with these impedance ratios.

    The pulse is that of the hidden striker glued to the bar, in steps; the design also
    has a bonded contact.
    """
    force = Z * SPEED * glued_pulse(ratios, 2 * SEGMENTS)
    step = DURATION / SEGMENTS
    edges = step * np.arange(1, force.size)
    pulse = ri.Steps(force, edges)
    return ri.design.striker(
        pulse,
        BAR,
        velocity=SPEED,
        duration=DURATION,
        contact=ri.Bonded(),
        area_ratio=AREA_RATIO,
    )


def hidden_strikers() -> Rows:
    """Errors of strikers that are found from the pulses of hidden, random ones.

    They are the median error of the areas, the number of strikers with a wrong area,
    and the largest misfit of a pulse.
    """
    area_errors = []
    misfits = []
    for seed in range(HIDDEN_STRIKERS):
        ratios = random_ratios(seed)
        design = reconstructed(ratios)
        segments = design.system.bodies[0].segments
        areas = np.array([segment.area for segment in segments])
        # Segments count from the left; the struck end is on the right.
        from_struck_end = areas[::-1] / BAR.segments[0].area
        area_errors.append(largest_magnitude(from_struck_end / ratios - 1))
        misfits.append(design.misfit)
    median_error = np.median(area_errors)
    largest_misfit = max(misfits)
    wrong = np.sum(np.array(area_errors) > AREA_RTOL)
    name = f"{HIDDEN_STRIKERS} hidden strikers of ten steps"
    case = Case(name, "the hidden one")
    yield case.row(
        "areas, largest relative error, median of the strikers",
        0.0,
        median_error,
        1e-9,
    )
    yield case.row(
        "strikers with an area off by more than 1e-6",
        0.0,
        wrong,
        1.0,
        source="the hidden ones",
    )
    yield case.row(
        "largest misfit of the pulse over the peak",
        0.0,
        largest_misfit,
        1e-12,
        source="reflections step by step",
    )


def momentum_trap() -> Rows:
    """Gap, length and velocity of a trap that takes the second arrival of a pulse.

    The motion that remains in the bar is compared with 0.
    """
    striker = ri.Rod(STRIKER_LENGTH, area=AREA, material=STEEL, velocity=SPEED)
    system = ri.System([striker, BAR])
    # The pulse, 0.4/c long, reaches the end of the bar at 1/c, and again at 3/c.
    design = ri.design.momentum_trap(system, after=1.4 / C, until=3.4 / C)
    end = 10 / C
    solution = ri.solve(design.system, until=end)
    gap = 1e3 * design.system.gaps[1]
    expected_gap = 1e3 * SPEED * 0.4 / C
    trap_length = design.system.bodies[2].length
    trap_velocity = solution.mean_velocity(2, end)
    x = np.linspace(0, 1, 101)
    velocity = solution.velocity(1, x, end) / SPEED
    strain = solution.strain(1, x, end) * C / SPEED
    motion_left = np.concatenate([velocity, strain])
    name = "momentum trap behind a bar of 1 m, striker of 0.2 m at 10 m/s"
    case = Case(name, "the striker's")
    yield case.row("gap, mm", expected_gap, gap, 1e-12, source="V 2 L/c")
    yield case.row("length of the trap, m", STRIKER_LENGTH, trap_length, 1e-12)
    yield case.row("velocity of the trap, m/s", SPEED, trap_velocity, 1e-10)
    yield case.zero(
        "v or c strain left in the bar over V, largest",
        motion_left,
        1e-12,
        source="at rest",
    )
