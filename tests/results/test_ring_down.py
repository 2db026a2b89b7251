"""How vibration dies out after a collision."""

import math

import numpy as np
import pytest

import rodimpact as ri

STEEL = ri.materials.steel
LOSSY = STEEL.damped(loss_factor=0.05, frequency=1e3)


def pair(material, *, lengths=(0.4, 1.0), area=1e-4):
    return ri.System(
        [
            ri.Rod(x, area=area, material=material, velocity=v)
            for x, v in zip(lengths, (1.0, 0.0), strict=True)
        ]
    )


def test_energy_falls_to_that_of_the_rigid_motion():
    solution = ri.solve(pair(LOSSY), until=8e-3, cells=40)
    decay = solution.ring_down()
    E = decay.vibration
    assert np.all(np.diff(E) <= 1e-12 * E[0])
    assert E[-1] < 1e-5 * E[0]
    assert decay.rigid == pytest.approx(solution.outcome.kinetic_after, rel=1e-9)
    total = solution.energy(decay.times).total
    assert total == pytest.approx(decay.rigid + E, rel=1e-12)
    assert decay.momentum_change < 1e-13
    assert decay.decay_time == pytest.approx(decay.modal_decay_time, rel=5e-3)


def test_without_damping_it_never_does():
    solution = ri.solve(pair(STEEL), until=3e-3, method="finite-difference", cells=40)
    decay = solution.ring_down()
    assert decay.vibration == pytest.approx(decay.vibration[0], rel=1e-11)
    assert decay.decay_time == decay.modal_decay_time == math.inf
    assert "never" in str(decay)


def test_masses_and_the_rod_that_lasts():
    mass = ri.RigidMass(0.1, velocity=-1.0)
    row = ri.System(
        [*pair(LOSSY).bodies, mass], gaps=[0.0, 1e-2], contacts=[ri.Rigid()] * 2
    )
    solution = ri.solve(row, until=12e-3, method="finite-difference", cells=20)
    assert solution.final
    decay = solution.ring_down()
    assert decay.body == 1
    assert decay.rigid == pytest.approx(solution.outcome.kinetic_after, rel=1e-9)


def test_what_has_no_ring_down_says_so():
    with pytest.raises(
        ValueError, match=r"ring_down: the collision is not over\. Stopped at"
    ):
        ri.solve(pair(LOSSY), until=1e-5, cells=20).ring_down()
    driven = ri.System(pair(LOSSY).bodies, ends=(ri.Free(), ri.Pushed(1.0)))
    with pytest.raises(ValueError, match="ring_down"):
        ri.solve(driven, until=1e-3, method="finite-difference", cells=20).ring_down()


def test_too_few_states_are_no_record():
    with pytest.raises(
        ValueError, match=r"ring_down: only .* states were kept .*snapshots"
    ):
        ri.solve(pair(LOSSY), until=8e-3, cells=40, snapshots=10).ring_down()
