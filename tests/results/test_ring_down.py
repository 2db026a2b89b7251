"""How vibration dies out after a collision."""

import math

import numpy as np
import pytest

import rodimpact as ri

STEEL = ri.materials.steel
LOSSY = STEEL.damped(loss_factor=0.05, frequency=1e3)


def pair(material):
    """A rod of 0.4 m that strikes one of 1 m at 1 m/s."""
    striker = ri.Rod(0.4, area=1e-4, material=material, velocity=1.0)
    struck = ri.Rod(1.0, area=1e-4, material=material)
    return ri.System([striker, struck])


def test_energy_falls_to_that_of_the_rigid_motion_as_the_slowest_mode_decays():
    """Two lossy rods collide and ring down: the energy of vibration falls to below 1e-5
    of its start without ever rising, that of the rigid motion stays, and the decay time
    is that of the slowest mode to 0.5 %.
    """
    solution = ri.solve(pair(LOSSY), until=8e-3, cells=20)

    decay = solution.ring_down()

    vibration = decay.vibration  # J [state]
    round_off = 1e-12 * vibration[0]
    assert np.all(np.diff(vibration) <= round_off)
    assert vibration[-1] < 1e-5 * vibration[0]
    kinetic_after = solution.outcome.kinetic_after
    assert decay.rigid == pytest.approx(kinetic_after, rel=1e-9)
    total = solution.energy(decay.times).total
    assert total == pytest.approx(decay.rigid + vibration, rel=1e-12)
    assert decay.momentum_change < 1e-13
    assert decay.decay_time == pytest.approx(decay.modal_decay_time, rel=5e-3)


def test_without_damping_vibration_never_decays():
    """Rods without damping: the energy of vibration is constant, both decay times are
    infinite, and the text says "never".
    """
    solution = ri.solve(pair(STEEL), until=3e-3, method="finite-difference", cells=40)

    decay = solution.ring_down()

    at_start = decay.vibration[0]
    assert decay.vibration == pytest.approx(at_start, rel=1e-11)
    assert decay.decay_time == math.inf
    assert decay.modal_decay_time == math.inf
    assert "never" in str(decay)


@pytest.mark.exhaustive
def test_the_body_that_vibrates_longest_is_the_longest_rod_beside_a_mass():
    """Two lossy rods and a mass collide on a grid: the body of the ring-down is the
    longest rod, and its rigid energy is the kinetic energy after.
    """
    mass = ri.RigidMass(0.1, velocity=-1.0)
    bodies = [*pair(LOSSY).bodies, mass]
    laws = [ri.Rigid(), ri.Rigid()]
    row = ri.System(bodies, gaps=[0.0, 1e-2], contacts=laws)
    solution = ri.solve(row, until=12e-3, method="finite-difference", cells=20)
    assert solution.final

    decay = solution.ring_down()

    long_rod = 1  # the body of 1 m
    kinetic_after = solution.outcome.kinetic_after
    assert decay.body == long_rod
    assert decay.rigid == pytest.approx(kinetic_after, rel=1e-9)


def test_a_collision_that_is_not_over_has_no_ring_down():
    unfinished = ri.solve(pair(LOSSY), until=1e-5, cells=20)
    message = r"ring_down: the collision is not over\. Stopped at"
    with pytest.raises(ValueError, match=message):
        unfinished.ring_down()


def test_a_driven_row_has_no_ring_down():
    system = ri.System(pair(LOSSY).bodies, ends=(ri.Free(), ri.Pushed(1.0)))
    driven = ri.solve(system, until=1e-3, method="finite-difference", cells=20)
    with pytest.raises(ValueError, match="ring_down"):
        driven.ring_down()


def test_a_row_without_a_rod_has_no_ring_down():
    bodies = [ri.RigidMass(0.1, velocity=1.0), ri.Wall()]
    system = ri.System(bodies, contacts=[ri.Rigid(restitution=0.5)])
    with pytest.raises(ValueError, match=r"ring_down: the row has no rod"):
        ri.solve(system).ring_down()


def test_too_few_states_are_no_ring_down():
    solution = ri.solve(pair(LOSSY), until=8e-3, cells=40, snapshots=10)
    message = r"ring_down: only .* states were kept .*snapshots"
    with pytest.raises(ValueError, match=message):
        solution.ring_down()
