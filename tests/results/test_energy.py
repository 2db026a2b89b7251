"""Energy and momentum of runs: where it comes from and where it goes."""

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri


def solve_by_pieces(bodies, until=4.0, contacts=None, **options):
    """Solve a row by characteristics; options are those of a system."""
    system = ri.System(bodies, contacts=contacts, **options)
    return ri.solve(system, until, "characteristics")


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
    """All energies and velocities are as if it were not there, and it moves with the
    wall. Displacements on a grid have times that are rounded to ticks.
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
    plain = ri.solve(without_mass, 4.0, method, cells=cells)  # wall and rod, unmirrored

    solution = ri.solve(system, 4.0, method, cells=cells)

    times = np.linspace(0, 4, 65)
    energy = solution.energy(times)
    assert np.abs(energy.residual).max() <= near
    assert energy.total == pytest.approx(plain.energy(times).total, abs=near)
    outcome = solution.outcome
    assert abs(outcome.momentum_residual) <= near
    rod_velocity = direction * plain.outcome.velocities_after[1]
    assert outcome.velocities_after[rod_body] == pytest.approx(rod_velocity, abs=near)
    wall_velocity = direction * WALL_SPEED
    assert outcome.velocities_after[1] == wall_velocity
    velocity = solution.velocity(1, 0.0, times)
    assert velocity == pytest.approx(np.full(65, wall_velocity), abs=near)
    displacement = solution.displacement(1, 0.0, times)
    expected = pytest.approx(wall_velocity * times, abs=displacement_error)
    assert displacement == expected


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_blow_on_a_mass_bonded_to_a_wall_is_one_on_the_wall(mirrored):
    bodies = [ri.Wall(), ri.RigidMass(3.0), ri.RigidMass(2.0, velocity=-1.0)]
    laws = [ri.Bonded(), ri.Rigid(restitution=0.5)]
    system = ri.System(bodies, [0.0, 0.1], laws)
    if mirrored:
        system = system.mirrored()
    outcome = ri.solve(system, 1.0).outcome
    # (1 + e) times 2 kg at 1 m/s, on the mass and on the wall behind it
    impulses = [contact.impulse for contact in outcome.contacts]
    assert impulses == pytest.approx([3.0, 3.0], rel=1e-12)
    assert abs(outcome.momentum_residual) <= 1e-14


def test_an_absorbing_end_radiates_what_arrives_and_leaves_the_rod_at_rest():
    """Half of the pulse leaves from 0.5 to 1.5 s, half comes back from the free end."""
    velocity = ri.Steps([0.0, 1.0, 0.0], [0.5, 1.5])
    rod = unit_rod(2.0, 3.0, velocity=velocity)
    half_of_pulse = 3.0 * 1.0 * 1.0**2 / 4  # half of m v^2/2, J
    times = np.array([0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 3.5, 4.0])
    halves_radiated = np.array([0, 0, 0.5, 1, 1, 1.5, 2, 2])

    solution = solve_by_pieces([rod], ends=(ri.Free(), ri.Absorbing()))

    energy = solution.energy(times)
    radiated = half_of_pulse * halves_radiated
    assert energy.radiated == pytest.approx(radiated, abs=1e-14)
    kept = 2 * half_of_pulse - energy.radiated
    assert energy.total == pytest.approx(kept, abs=1e-14)
    places = np.linspace(0, 2, 9)[:, None]
    at_rest = solution.velocity(0, places, np.linspace(3.6, 4, 5))
    assert np.abs(at_rest).max() <= 1e-15


def test_a_dashpot_whose_force_is_cut_loses_what_its_spring_stored():
    """The spring still overlaps while the force, which would pull, is cut to 0."""
    rod = unit_rod(1.0, velocity=ri.Steps([-1.0, 1.0], [0.5]))
    law = ri.SpringDashpot(0.2, 1.0)

    solution = solve_by_pieces([rod, unit_rod()], 1.5, contacts=[law])

    contact = solution.contacts[0]
    times = np.linspace(0, 1.5, 193)
    is_cut = (contact.force(times) == 0) & (contact.gap(times) < 0)
    stays_cut = is_cut[1:] & is_cut[:-1]  # from each time to the next
    assert stays_cut.sum() > 10
    energy = solution.energy(times)
    assert np.abs(energy.residual).max() <= 1e-9
    assert np.all(np.diff(energy.dissipated)[stays_cut] > 0)
    assert np.all(np.diff(energy.contact)[stays_cut] < 0)
