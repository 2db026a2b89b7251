"""Momentum traps: nothing that arrives after the first pulse goes back into the bar."""

import numpy as np
import pytest
from steel import STEEL, C, rod

import rodimpact as ri

SPEED = 10.0
ROW = ri.System([rod(0.2, SPEED), rod()])


@pytest.mark.parametrize("material", [STEEL, ri.materials.aluminium])
def test_the_second_pulse_of_a_striker_leaves_with_the_trap(material):
    found = ri.design.momentum_trap(
        ROW, after=1.4 / C, until=3.4 / C, material=material
    )
    trap = found.system.bodies[2]
    assert found.system.gaps[1] == pytest.approx(SPEED * 0.4 / C, rel=1e-12)
    assert trap.transit_time == pytest.approx(0.2 / C)
    assert trap.segments[0].impedance == pytest.approx(
        ROW.bodies[1].segments[0].impedance
    )
    assert found.misfit < 1e-12
    end = 6 / C
    solution = ri.solve(found.system, until=end)
    for body, length in ((0, 0.2), (1, 1.0)):
        x = np.linspace(0, length, 41)
        assert solution.velocity(body, x, end) == pytest.approx(0, abs=1e-12 * SPEED)
        assert solution.strain(body, x, end) == pytest.approx(0, abs=1e-12 * SPEED / C)
    momentum = solution.outcome.masses[2] * float(solution.mean_velocity(2, end))
    assert momentum == pytest.approx(ROW.bodies[0].segments[0].mass * SPEED)


@pytest.mark.parametrize(("power", "mean"), [(1, 2 / np.pi), (2, 1 / 2)])
def test_a_smooth_pulse_is_trapped_too(power, mean):
    T, force = 40e-6, 2e4
    bar, push = (
        rod(),
        ri.Pushed(
            lambda t: force * np.where(t < T, np.sin(np.pi * t / T) ** power, 0.0),
            duration=2 * T,
        ),
    )
    found = ri.design.momentum_trap(
        ri.System([bar], ends=(push, ri.Free())), after=1 / C + T, until=3 / C + T
    )
    moved = 2 * mean * T * force / bar.segments[0].impedance
    assert found.system.gaps[0] == pytest.approx(moved, rel=1e-3)
    assert float(found.system.bodies[1].length) == pytest.approx(C * T / 2, rel=0.05)
    assert found.misfit < 2.5e-3


@pytest.mark.parametrize(
    ("row", "times", "sentence"),
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
def test_what_cannot_be_is_said(row, times, sentence):
    with pytest.raises(ValueError, match=sentence):
        ri.design.momentum_trap(row, **times)
