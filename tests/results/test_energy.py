"""Energy and momentum of runs: where it comes from and where it goes."""

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri

WALL_SPEED = 0.1  # m/s


@pytest.mark.parametrize("mirrored", few_of([False, True], [True]))
@pytest.mark.parametrize("gravity", few_of([0.0, -0.7], [-0.7]))
@pytest.mark.parametrize(
    ("method", "cells", "near", "displacement_error"),
    [("characteristics", None, 1e-13, 1e-13), ("finite-difference", 32, 1e-12, 1e-7)],
)
def test_a_mass_bonded_to_a_wall_belongs_to_the_wall(
    method, cells, near, displacement_error, gravity, mirrored
):
    """A rod meets a moving wall with a mass bonded to it: energies and the velocity of
    the rod are as without the mass, to `near`, and the mass moves with the wall.
    Displacements on a grid have an error of their own, as times are rounded to ticks.
    """
    wall = ri.Wall(WALL_SPEED)
    rod = unit_rod(velocity=-1.0)
    mass = ri.RigidMass(3.0, velocity=WALL_SPEED)
    without_mass = ri.System([wall, rod], [0.2], gravity=gravity)
    laws = [ri.Bonded(), ri.Rigid()]
    system = ri.System([wall, mass, rod], [0.0, 0.2], laws, gravity=gravity)
    direction = 1.0
    rod_body = 2
    if mirrored:
        system = system.mirrored()
        direction = -1.0
        rod_body = 0
    mass_body = 1  # the middle one, also mirrored
    until = 4.0  # s
    plain = ri.solve(without_mass, until, method, cells=cells)  # not mirrored

    solution = ri.solve(system, until, method, cells=cells)

    times = np.linspace(0, until, 65)
    energy = solution.energy(times)
    expected_energy = plain.energy(times).total
    assert np.abs(energy.residual).max() <= near
    assert energy.total == pytest.approx(expected_energy, abs=near)
    outcome = solution.outcome
    assert abs(outcome.momentum_residual) <= near
    rod_velocity = outcome.velocities_after[rod_body]
    expected_velocity = direction * plain.outcome.velocities_after[1]
    assert rod_velocity == pytest.approx(expected_velocity, abs=near)
    wall_velocity = direction * WALL_SPEED
    assert outcome.velocities_after[mass_body] == wall_velocity
    velocity = solution.velocity(mass_body, 0.0, times)
    assert velocity == pytest.approx(wall_velocity, abs=near)
    displacement = solution.displacement(mass_body, 0.0, times)
    moved = wall_velocity * times
    assert displacement == pytest.approx(moved, abs=displacement_error)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_blow_on_a_mass_bonded_to_a_wall_is_one_on_the_wall(mirrored):
    """A mass strikes another that is bonded to a wall. Contact and bond both have the
    impulse (1 + e) m v, and momentum balances; also mirrored.
    """
    e = 0.5
    striker = ri.RigidMass(2.0, velocity=-1.0)
    bodies = [ri.Wall(), ri.RigidMass(3.0), striker]
    laws = [ri.Bonded(), ri.Rigid(restitution=e)]
    system = ri.System(bodies, [0.0, 0.1], laws)
    if mirrored:
        system = system.mirrored()

    outcome = ri.solve(system, until=1.0).outcome

    impulses = [contact.impulse for contact in outcome.contacts]
    blow = (1 + e) * 2.0 * 1.0  # of 2 kg at 1 m/s, N s
    # It acts on the mass, and through the bond on the wall.
    assert impulses == pytest.approx([blow, blow], rel=1e-12)
    assert abs(outcome.momentum_residual) <= 1e-14


def test_an_absorbing_end_radiates_what_arrives_and_leaves_the_rod_at_rest():
    """Half of the pulse leaves from 0.5 to 1.5 s, half comes back from the free end."""
    pulse = ri.Steps([0.0, 1.0, 0.0], [0.5, 1.5])  # 1 m/s over 1 m
    area = 3.0  # also the mass of 1 m, kg, and the impedance, kg/s
    rod = unit_rod(length=2.0, area=area, velocity=pulse)
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([rod], ends=ends)

    solution = ri.solve(system, until=4.0, method="characteristics")

    pulse_mass = area * 1.0
    half_of_pulse = pulse_mass * 1.0**2 / 4  # half of m v^2/2, J
    times = np.array([0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 3.5, 4.0])
    halves_radiated = np.array([0, 0, 0.5, 1, 1, 1.5, 2, 2])
    radiated = half_of_pulse * halves_radiated
    energy = solution.energy(times)
    assert energy.radiated == pytest.approx(radiated, abs=1e-14)
    kept = 2 * half_of_pulse - energy.radiated
    assert energy.total == pytest.approx(kept, abs=1e-14)
    places = np.linspace(0, 2, 9)[:, None]
    after_pulse = np.linspace(3.6, 4, 5)  # all of it has left at 3.5 s
    velocity = solution.velocity(0, places, after_pulse)
    assert np.abs(velocity).max() <= 1e-15


def test_a_dashpot_whose_force_is_cut_loses_what_its_spring_stored():
    """The spring still overlaps while the force, which would pull, is cut to 0."""
    # The right half strikes first; the left half, which moves away, then pulls back.
    velocity = ri.Steps([-1.0, 1.0], [0.5])
    bodies = [unit_rod(velocity=velocity), unit_rod()]
    law = ri.SpringDashpot(stiffness=0.2, damping=1.0)
    system = ri.System(bodies, contacts=[law])

    solution = ri.solve(system, until=1.5, method="characteristics")

    contact = solution.contacts[0]
    times = np.linspace(0, 1.5, 193)
    overlaps = contact.gap(times) < 0
    is_cut = overlaps & (contact.force(times) == 0)
    stays_cut = is_cut[1:] & is_cut[:-1]  # from each time to the next
    assert stays_cut.sum() > 10  # else nothing is tested
    energy = solution.energy(times)
    dissipated = np.diff(energy.dissipated)
    stored = np.diff(energy.contact)
    assert np.abs(energy.residual).max() <= 1e-9
    assert np.all(dissipated[stays_cut] > 0)
    assert np.all(stored[stays_cut] < 0)
