"""Momentum traps: no wave after the first pulse goes back into the bar."""

import numpy as np
import pytest
from steel import STEEL, C, rod

import rodimpact as ri

SPEED = 10.0
ROW = ri.System([rod(0.2, SPEED), rod()])


@pytest.mark.parametrize("material", [STEEL, ri.materials.aluminium])
def test_the_second_pulse_of_a_striker_leaves_with_the_trap(material):
    design = ri.design.momentum_trap(
        ROW, after=1.4 / C, until=3.4 / C, material=material
    )
    trap = design.system.bodies[2]
    bar_impedance = ROW.bodies[1].segments[0].impedance
    assert design.system.gaps[1] == pytest.approx(SPEED * 0.4 / C, rel=1e-12)
    assert trap.transit_time == pytest.approx(0.2 / C)
    assert trap.segments[0].impedance == pytest.approx(bar_impedance)
    assert design.misfit < 1e-12

    end = 6 / C
    solution = ri.solve(design.system, until=end)
    for body, length in ((0, 0.2), (1, 1.0)):
        x = np.linspace(0, length, 41)
        assert solution.velocity(body, x, end) == pytest.approx(0, abs=1e-12 * SPEED)
        assert solution.strain(body, x, end) == pytest.approx(0, abs=1e-12 * SPEED / C)
    momentum = solution.outcome.masses[2] * float(solution.mean_velocity(2, end))
    striker_mass = ROW.bodies[0].segments[0].mass
    assert momentum == pytest.approx(striker_mass * SPEED)


@pytest.mark.parametrize(("power", "mean"), [(1, 2 / np.pi), (2, 1 / 2)])
def test_a_smooth_pulse_is_trapped_too(power, mean):
    """The pulse is a power of a half sine, whose mean over the pulse is known."""
    T = 40e-6
    peak = 2e4

    def force(t):
        return peak * np.where(t < T, np.sin(np.pi * t / T) ** power, 0.0)

    bar = rod()
    push = ri.Pushed(force, duration=2 * T)
    row = ri.System([bar], ends=(push, ri.Free()))

    design = ri.design.momentum_trap(row, after=1 / C + T, until=3 / C + T)

    displacement = 2 * mean * T * peak / bar.segments[0].impedance
    length = float(design.system.bodies[1].length)
    assert design.system.gaps[0] == pytest.approx(displacement, rel=1e-3)
    assert length == pytest.approx(C * T / 2, rel=0.05)
    assert design.misfit < 2.5e-3


@pytest.mark.parametrize(
    ("row", "arguments", "sentence"),
    [
        (rod(), {"until": 1e-3}, "system: must be a System"),
        (
            ri.System([rod(velocity=1.0), ri.Wall()]),
            {"until": 1e-3},
            "system: must end on the right",
        ),
        (ROW, {"until": -1.0}, "until: must be a finite positive .*, got -1.0"),
        (ROW, {"until": 1e-4, "after": 1e-3}, "after: must be from 0 to before until"),
        (ROW, {"until": 0.5 / C}, "until: nothing pushes on the right end"),
        (
            ri.System([rod(0.2), rod(velocity=-SPEED)]),
            {"until": 1e-3, "after": 5e-4},
            "after: the right end is at",
        ),
        (ROW, {"until": 1e-3, "material": "steel"}, "material: must be a Material"),
    ],
)
def test_invalid_arguments_are_refused(row, arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        ri.design.momentum_trap(row, **arguments)
