"""The reference solver of the tests against closed forms, published numbers and exact fronts."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from method_of_steps import solve
from networks import mixed_network, unit_rod

import rodimpact as ri


def striking(mass, **ends):
    return ri.System([ri.RigidMass(mass, velocity=1.0), unit_rod()], **ends)


@pytest.mark.parametrize("seed", [0, 2, 4, 9, 26])
def test_rigid_rows_are_those_of_fronts(seed):
    system, until, _ = mixed_network(np.random.default_rng(seed), ("walls", "gaps", "stepped"))
    mine, exact = solve(system, until), ri.solve(system, until, method="fronts")
    for one, other in zip(mine.contacts, exact.contacts, strict=True):
        assert one.impulse == pytest.approx(other.impulse, rel=1e-11, abs=1e-12)
        assert one.peak_force == pytest.approx(other.peak_force, rel=1e-11, abs=1e-12)
        assert one.duration == pytest.approx(other.duration, rel=1e-11, abs=1e-12)
        assert one.gap(until) == pytest.approx(float(other.gap(until)), abs=1e-11)
        assert [tuple(e) for e in one.episodes] == [
            pytest.approx(tuple(e), abs=1e-11, nan_ok=True) for e in other.episodes]
    means = [float(exact.mean_velocity(k, until)) for k in range(len(system.bodies))]
    assert mine.velocities == pytest.approx(means, abs=1e-11)


@pytest.mark.parametrize("mass", [0.25, 1.0, 4.0])
def test_mass_on_a_free_rod(mass):
    result = solve(striking(mass), 4.0)
    mu = 1 / mass
    e = (1 - math.exp(-2 * mu)) / mu - math.exp(-2 * mu)
    assert result.velocities[1] - result.velocities[0] == pytest.approx(e, abs=1e-13)


@pytest.mark.parametrize(("mass", "duration", "peak", "rebound"), [
    (1, 3.068, 2.1353, -0.6876), (2, 4.709, 2.3679, -0.9252), (4, 5.900, 2.9744, -0.8169),
    (6, 7.408, 3.4688, -0.9297),
])
def test_mass_on_a_fixed_rod_as_saint_venant(mass, duration, peak, rebound):
    result = solve(striking(mass, ends=[ri.Free(), ri.Fixed()]), duration + 0.01)
    assert result.contacts[0].duration == pytest.approx(duration, abs=5e-4)
    assert result.contacts[0].peak_force == pytest.approx(peak, abs=5e-5)
    assert result.velocities[0] == pytest.approx(rebound, abs=5e-5)


@pytest.mark.parametrize(("loss", "rebound"), [(0.05, 0.917772), (0.2, 0.714045), (0.5, 0.436895)])
def test_sphere_on_an_endless_rod_as_zener(loss, rebound):
    row = [ri.RigidMass(1.0, velocity=1.0), unit_rod(area=1 / loss)]
    system = ri.System(row, contacts=[ri.Hertz(1.0)], ends=[ri.Free(), ri.Absorbing()])
    assert solve(system, 5.0).velocities[0] == pytest.approx(-rebound, abs=5e-7)


@pytest.mark.parametrize("stiffness", few_of([1.0, 10.0, 1e3], [10.0]))
def test_rods_with_round_ends(stiffness):
    e = {1.0: 0.944, 10.0: 0.617, 1e3: 0.411}[stiffness]
    rods = [unit_rod(0.4, velocity=1.0), unit_rod(1.0)]
    result = solve(ri.System(rods, contacts=[ri.Hertz(stiffness)]), 8.0, 1e-10)
    assert result.velocities[1] - result.velocities[0] == pytest.approx(e, abs=5e-4)


def test_cradle_of_three_balls():
    balls = [ri.RigidMass(1.0, velocity=float(k == 0)) for k in range(3)]
    system = ri.System([*balls, unit_rod()], gaps=[0, 0, 99], contacts=[ri.Hertz(1.0)] * 3)
    newton = [-0.07095235, 0.07640304, 0.99454931]  # Radau, DOP853 and LSODA agree
    assert solve(system, 30.0, 1e-11).velocities[:3] == pytest.approx(newton, abs=5e-9)


def test_step_through_a_spring_between_endless_bars():
    k, strain = 3.0, -0.25
    ends = [ri.Incoming(strain), ri.Absorbing()]
    system = ri.System([unit_rod(), unit_rod()], contacts=[ri.Spring(k)], ends=ends)
    impulse = solve(system, 2.0).contacts[0].impulse
    arrived = 1.0 - (1 - math.exp(-2 * k)) / (2 * k)  # integral of 1 - exp(-2 k t)
    assert impulse == pytest.approx(-strain * arrived, abs=1e-13)


@pytest.mark.parametrize("seed", few_of([40, 42, 43, 46], [43]))
def test_agrees_with_itself_at_a_coarser_tolerance(seed):
    system, until, _ = mixed_network(np.random.default_rng(seed))
    fine, coarse = solve(system, until), solve(system, until, 1e-10)
    for one, other in zip(fine.contacts, coarse.contacts, strict=True):
        assert one.impulse == pytest.approx(other.impulse, abs=1e-8)
    assert fine.velocities == pytest.approx(coarse.velocities, abs=1e-8)


def test_mass_that_bounces_ever_less_comes_to_rest():
    masses = [ri.RigidMass(1.0), ri.RigidMass(1.0)]
    system = ri.System(
        [unit_rod(), *masses, ri.Wall()], gaps=[99, 0, 0.1], gravity=1.0,
        contacts=[ri.Rigid(), ri.Rigid(restitution=0.5), ri.Rigid(restitution=0.5)],
    )
    result = solve(system, 4.0)
    assert result.velocities[1:3] == pytest.approx([0, 0], abs=1e-12)
    assert [c.impulse for c in result.contacts] == pytest.approx([0, 4, 8], abs=1e-11)
