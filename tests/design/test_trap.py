"""Momentum traps: no wave after the first pulse goes back into the bar."""

import numpy as np
import pytest
from steel import STEEL, C, rod

import rodimpact as ri

SPEED = 10.0  # m/s
STRIKER_LENGTH = 0.2  # m
STRIKER = rod(STRIKER_LENGTH, SPEED)
ROW = ri.System([STRIKER, rod()])


def second_pulse_trap(material):
    """Design of a trap for the second pulse of the striker in a bar of 1 m."""
    after = 1.4 / C  # s, when the first pulse has left the right end of the bar
    until = 3.4 / C
    return ri.design.momentum_trap(ROW, after=after, until=until, material=material)


@pytest.mark.parametrize("material", [STEEL, ri.materials.aluminium])
def test_a_trap_has_transit_time_of_the_striker_and_impedance_of_the_bar(material):
    """The trap that is designed has the transit time of the striker and the impedance
    of the bar. Its gap is the distance that the end of the bar moves during the first
    pulse; the misfit is 0.
    """
    design = second_pulse_trap(material)

    trap = design.system.bodies[2]
    # The end of the bar moves with V for the duration of the first pulse, 2 l/c.
    gap = SPEED * 2 * STRIKER_LENGTH / C
    bar_impedance = ROW.bodies[1].segments[0].impedance
    _, trap_gap = design.system.gaps
    assert trap_gap == pytest.approx(gap, rel=1e-12)
    assert trap.transit_time == pytest.approx(STRIKER_LENGTH / C)
    trap_impedance = trap.segments[0].impedance
    assert trap_impedance == pytest.approx(bar_impedance)
    assert design.misfit < 1e-12


def assert_at_rest(solution, body, t):
    """Assert that nothing moves in a rod at a time t, and that nothing is strained."""
    length = solution.system.bodies[body].length
    x = np.linspace(0, length, 41)
    relative_velocity = solution.velocity(body, x, t) / SPEED
    relative_strain = solution.strain(body, x, t) * C / SPEED
    assert relative_velocity == pytest.approx(0, abs=1e-12)
    assert relative_strain == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("material", [STEEL, ri.materials.aluminium])
def test_the_second_pulse_of_a_striker_leaves_with_the_trap(material):
    """After six transits striker and bar are at rest, and the trap has the momentum."""
    design = second_pulse_trap(material)
    end = 6 / C  # s, six transits of the bar of 1 m

    solution = ri.solve(design.system, until=end)

    assert_at_rest(solution, 0, end)
    assert_at_rest(solution, 1, end)
    velocity = float(solution.mean_velocity(2, end))
    momentum = solution.outcome.masses[2] * velocity
    striker_mass = STRIKER.segments[0].mass
    assert momentum == pytest.approx(striker_mass * SPEED)


@pytest.mark.parametrize(
    ("power", "mean"),
    [(2, 1 / 2), pytest.param(1, 2 / np.pi, marks=pytest.mark.exhaustive)],
)
def test_a_smooth_pulse_is_trapped_too(power, mean):
    """The pulse is a power of a half sine, whose mean over the pulse is known."""
    T = 40e-6  # s
    peak = 2e4  # N

    def force(t):
        sine = np.sin(np.pi * t / T)
        return peak * np.where(t < T, sine**power, 0.0)

    bar = rod()
    push = ri.Pushed(force, duration=2 * T)
    ends = (push, ri.Free())
    row = ri.System([bar], ends=ends)

    # The pulse is reflected at the right end from 1/c to 1/c + T, where c is the wave
    # speed, and is back there after two more transits of the bar.
    after = 1 / C + T
    until = 3 / C + T
    design = ri.design.momentum_trap(row, after=after, until=until)

    impulse = mean * T * peak
    displacement = 2 * impulse / bar.segments[0].impedance  # of a free end
    (gap,) = design.system.gaps
    _, trap = design.system.bodies
    length = float(trap.length)
    assert gap == pytest.approx(displacement, rel=1e-3)
    assert length == pytest.approx(C * T / 2, rel=0.05)
    assert design.misfit < 2.5e-3


ON_WALL = ri.System([rod(velocity=1.0), ri.Wall()])
RECEDING = ri.System([rod(0.2), rod(velocity=-SPEED)])


@pytest.mark.parametrize(
    ("row", "arguments", "message"),
    [
        (rod(), {"until": 1e-3}, "system: must be a System"),
        (ON_WALL, {"until": 1e-3}, "system: must end on the right"),
        (ROW, {"until": -1.0}, "until: must be a finite positive .*, got -1.0"),
        (ROW, {"until": 1e-4, "after": 1e-3}, "after: must be from 0 to before until"),
        (ROW, {"until": 0.5 / C}, "until: nothing pushes on the right end"),
        (RECEDING, {"until": 1e-3, "after": 5e-4}, "after: the right end is at"),
        (ROW, {"until": 1e-3, "material": "steel"}, "material: must be a Material"),
    ],
)
def test_invalid_arguments_are_refused(row, arguments, message):
    with pytest.raises(ValueError, match=message):
        ri.design.momentum_trap(row, **arguments)
