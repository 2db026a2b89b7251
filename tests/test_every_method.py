"""What must hold for random rows by each of the methods, with any bodies, laws and
ends.
"""

import math

import numpy as np
import pytest
from grid_rows import random_row
from hypothesis import given
from hypothesis import strategies as st
from networks import STEP, random_network, shifted
from systems import horizon, with_ends

import rodimpact as ri

SEEDS = st.integers(0, 10**6)


def row_for_fronts(seed, driven):
    """A random row of rods and walls, as fronts carry it."""
    return with_ends(seed, driven, moving_walls=driven)


def row_for_characteristics(seed, driven):
    """A random row of all bodies and laws."""
    return random_network(seed, bodies=4, driven=driven)


def row_for_a_grid(seed, driven):
    """A random row, some of whose rods are damped, tapered or have lateral inertia."""
    return random_row(seed, bodies=4, driven=driven)


ROWS = {
    "fronts": row_for_fronts,
    "characteristics": row_for_characteristics,
    "finite-difference": row_for_a_grid,
}
BALANCE_RTOL = {"fronts": 1e-10, "characteristics": 1e-6, "finite-difference": 1e-10}
"""Relative errors that each method may make of energies and momenta."""
by_method = pytest.mark.parametrize("method", ROWS)
LOSSES = ("dissipated", "damped", "numerical")
WORKS = ("wall_work", "drive_work", "gravity_work", "radiated")
STORED = ("kinetic", "vibrational_kinetic", "strain", "contact")


def solve_by(method, system):
    """A solution by a method, to a time that takes each method about as long."""
    if method == "fronts":
        until = horizon(system, transits=12.0)
        return ri.solve(system, until, method, max_events=20_000)
    if method == "finite-difference":
        return ri.solve(system, until=1.5, method=method, dt=STEP)
    return ri.solve(system, until=2.0, method=method)


def energy_scale(energy):
    """Largest energy or work of a run, J; above 0."""
    works = [np.abs(getattr(energy, name)).max() for name in WORKS]
    return energy.total.max() + max(works) + 1e-300


def assert_energies_balance(solution, driven, rtol):
    """Energies add up at 33 times and are no less than 0; what is lost stays lost.

    Nothing works on a row that is not driven; in a driven one losses are not compared,
    as drives may jump against them. Bounds are `rtol` of the largest energy or work.
    """
    energy = solution.energy(np.linspace(0, solution.t_end, 33))
    scale = energy_scale(energy)
    assert np.abs(energy.residual).max() <= rtol * scale
    for name in STORED:
        assert getattr(energy, name).min() >= -1e-12 * scale
    for name in LOSSES:
        loss = getattr(energy, name)
        assert loss[0] == 0
        if not driven:
            assert np.diff(loss).min() >= -rtol * scale
    if not driven:
        for name in ("wall_work", "drive_work", "gravity_work"):
            assert np.abs(getattr(energy, name)).max() <= 1e-12 * scale


def assert_outcome_is_that_at_the_end(solution, rtol):
    """Energies of the outcome are those at the end, and its balances close.

    Bounds are `rtol` of the largest energy or work.
    """
    energy = solution.energy(np.linspace(0, solution.t_end, 33))
    outcome = solution.outcome
    totals = {
        "kinetic": outcome.kinetic_after,
        "vibration": sum(outcome.vibration_after),
        "contact": outcome.contact_energy,
    }
    for name in (*LOSSES, *WORKS):
        totals[name] = getattr(outcome, name)

    assert abs(outcome.momentum_residual) <= rtol / 10
    assert abs(outcome.energy_residual) <= rtol
    near = rtol * energy_scale(energy)
    for name, total in totals.items():
        at_end = getattr(energy, name)[-1]
        assert total == pytest.approx(at_end, abs=near), name


def impulses_on_ends(solution, times):
    """Impulses on the left and on the right end of the row up to some times, N s
    [end][time].

    The force on a fixed end is not kept by all methods: its impulse is nan here.
    """
    ticks = solution.fields.to_ticks(times)
    impulses = []
    actions = solution.run.signals.boundary_actions
    for action, end in zip(actions, solution.system.ends, strict=True):
        if action:
            impulse = action.push.integral(0, ticks) * solution.fields.clock.tick
        elif isinstance(end, ri.Fixed):
            impulse = np.full(len(times), math.nan)
        else:
            impulse = np.zeros(len(times))
        impulses.append(impulse)
    return impulses


def assert_forces_move_bodies(solution, rtol):
    """Only contacts, ends and gravity change the momentum of each body but walls.

    Bodies at a fixed end are left out. The bound is `rtol` of all momenta and impulses.
    """
    system = solution.system
    times = np.linspace(0, solution.t_end, 9)
    left, right = impulses_on_ends(solution, times)
    of_contacts = [contact.impulse_until(times) for contact in solution.contacts]
    impulses = [left, *of_contacts, right]  # impulses[i] acts on the left of body i
    free = []  # bodies that are no walls
    for i, body in enumerate(system.bodies):
        if not isinstance(body, ri.Wall):
            free.append(i)
    masses = solution.outcome.masses
    momentum = sum(masses[i] for i in free) * solution.fields.clock.scale
    near = rtol * (momentum + np.nansum(np.abs(impulses))) + 1e-15
    for i in free:
        velocity = solution.mean_velocity(i, times)
        change = velocity - velocity[0] - system.gravity * times  # without the fall
        impulse = impulses[i] - impulses[i + 1]
        if not np.isnan(impulse[-1]):  # not at a fixed end
            assert masses[i] * change == pytest.approx(impulse, abs=near)


def assert_gaps_are_between_ends(solution, near):
    """Gaps are the distances of ends at 23 times, to within `near`, m.

    Those of laws that yield are left out: they grow by what is crushed.
    """
    times = np.linspace(0, solution.t_end, 23)
    for i, contact in enumerate(solution.contacts):
        if isinstance(contact.law, ri.Yielding):
            continue
        end = getattr(solution.system.bodies[i], "length", 0.0)
        left = solution.position(i, end, times)
        right = solution.position(i + 1, 0.0, times)
        assert contact.gap(times) == pytest.approx(right - left, abs=near)


def assert_strains_stretch_rods(solution):
    """Rods are longer by the integral of their strain, at two times.

    It is a sum over 400 places, which misses where between two of them it jumps: it is
    known to a tenth of the largest strain.
    """
    times = np.array([0.0, 0.7 * solution.t_end])
    shares = (np.arange(400)[:, None] + 0.5) / 400
    for i, body in enumerate(solution.system.bodies):
        if not isinstance(body, ri.Rod):
            continue
        strain = solution.strain(i, shares * body.length, times)  # [place, time]
        left = solution.displacement(i, 0.0, times)
        right = solution.displacement(i, body.length, times)
        stretch = body.length * strain.mean(axis=0)
        near = 0.1 * body.length * np.abs(strain).max() + 1e-15
        assert right - left == pytest.approx(stretch, abs=near)


@by_method
@given(SEEDS, st.booleans())
def test_energies_momenta_gaps_and_strains_fit_together(method, seed, driven):
    solution = solve_by(method, ROWS[method](seed, driven))
    rtol = BALANCE_RTOL[method]
    assert_energies_balance(solution, driven, rtol)
    assert_outcome_is_that_at_the_end(solution, rtol)
    assert_forces_move_bodies(solution, rtol)
    if method != "finite-difference":  # where strains at the start are means over cells
        assert_gaps_are_between_ends(solution, 20 * rtol)
        assert_strains_stretch_rods(solution)


def assert_contacts_are_alike(contacts, others, times, near):
    """Gaps at these times and impulses at the end are equal to within `near`."""
    for contact, other in zip(contacts, others, strict=True):
        assert other.gap(times) == pytest.approx(contact.gap(times), abs=near)
        assert other.impulse == pytest.approx(contact.impulse, abs=near)


@by_method
@given(SEEDS)
def test_velocities_gaps_and_impulses_of_a_mirror_image_are_mirrored(method, seed):
    system = ROWS[method](seed, driven=True)
    near = BALANCE_RTOL[method]  # velocities and lengths are of the order of 1

    solution = solve_by(method, system)
    image = solve_by(method, system.mirrored())

    times = np.linspace(0, solution.t_end, 17)
    last = len(system.bodies) - 1
    for i in range(len(system.bodies)):
        velocity = solution.mean_velocity(i, times)
        image_velocity = image.mean_velocity(last - i, times)
        assert -image_velocity == pytest.approx(velocity, abs=near)
    assert_contacts_are_alike(solution.contacts, image.contacts[::-1], times, near)


@by_method
@given(SEEDS, st.sampled_from([1.0, -30.0]))
def test_velocities_gaps_and_impulses_are_the_same_in_a_moving_frame(method, seed, v):
    system = ROWS[method](seed, driven=True)
    near = BALANCE_RTOL[method] * (
        1 + abs(v)
    )  # round-off of velocities that are v more
    if method == "finite-difference":
        near *= 11  # round-off of each of its steps adds up

    solution = solve_by(method, system)
    moving = solve_by(method, shifted(system, v))

    times = np.linspace(0, solution.t_end, 17)
    for i in range(len(system.bodies)):
        velocity = solution.mean_velocity(i, times)
        velocity_in_frame = moving.mean_velocity(i, times) - v
        assert velocity_in_frame == pytest.approx(velocity, abs=near)
    assert_contacts_are_alike(solution.contacts, moving.contacts, times, near)
