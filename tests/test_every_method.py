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
    largest_works = []
    for name in WORKS:
        work = getattr(energy, name)
        largest_works.append(np.abs(work).max())
    return energy.total.max() + max(largest_works) + 1e-300


def assert_energies_balance(solution, driven, rtol):
    """Energies add up at 33 times and are no less than 0; what is lost stays lost.

    Nothing works on a row that is not driven; in a driven one losses are not compared,
    as drives may jump against them. Bounds are `rtol` of the largest energy or work.
    """
    times = np.linspace(0, solution.t_end, 33)
    energy = solution.energy(times)
    scale = energy_scale(energy)
    missing = np.abs(energy.residual).max()
    assert missing <= rtol * scale
    for name in STORED:
        stored = getattr(energy, name)
        assert stored.min() >= -1e-12 * scale
    for name in LOSSES:
        loss = getattr(energy, name)
        assert loss[0] == 0
        if not driven:
            changes = np.diff(loss)
            assert changes.min() >= -rtol * scale
    if not driven:
        for name in ("wall_work", "drive_work", "gravity_work"):
            work = getattr(energy, name)
            assert np.abs(work).max() <= 1e-12 * scale


def assert_outcome_is_that_at_the_end(solution, rtol):
    """Energies of the outcome are those at the end, and its balances close.

    Bounds are `rtol` of the largest energy or work.
    """
    times = np.linspace(0, solution.t_end, 33)
    energy = solution.energy(times)
    outcome = solution.outcome
    vibration = sum(outcome.vibration_after)
    totals = {
        "kinetic": outcome.kinetic_after,
        "vibration": vibration,
        "contact": outcome.contact_energy,
    }
    for name in (*LOSSES, *WORKS):
        totals[name] = getattr(outcome, name)

    assert abs(outcome.momentum_residual) <= rtol / 10
    assert abs(outcome.energy_residual) <= rtol
    near = rtol * energy_scale(energy)
    for name, total in totals.items():
        history = getattr(energy, name)
        at_end = history[-1]
        assert total == pytest.approx(at_end, abs=near), name


def impulses_on_ends(solution, times):
    """Impulses on the left and on the right end of the row up to some times, N s
    [end][time].

    The force on a fixed end is not kept by all methods: its impulse is nan here.
    """
    ticks = solution.fields.to_ticks(times)
    impulses = []
    actions = solution.run.signals.boundary_actions
    tick = solution.fields.clock.tick
    ends = solution.system.ends
    for action, end in zip(actions, ends, strict=True):
        if action:
            impulse = action.push.integral(0, ticks) * tick
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
    mass = sum(masses[i] for i in free)
    momentum = mass * solution.fields.clock.scale
    total_impulse = np.nansum(np.abs(impulses))
    near = rtol * (momentum + total_impulse) + 1e-15
    for i in free:
        velocity = solution.mean_velocity(i, times)
        fall = system.gravity * times
        change = velocity - velocity[0] - fall
        impulse = impulses[i] - impulses[i + 1]
        is_known = not np.isnan(impulse[-1])  # it is not known at a fixed end
        if is_known:
            momentum_gained = masses[i] * change
            assert momentum_gained == pytest.approx(impulse, abs=near)


def assert_gaps_are_between_ends(solution, near):
    """Gaps are the distances of ends at 23 times, to within `near`, m.

    Those of laws that yield are left out: they grow by what is crushed.
    """
    times = np.linspace(0, solution.t_end, 23)
    for i, contact in enumerate(solution.contacts):
        if isinstance(contact.law, ri.Yielding):
            continue
        body = solution.system.bodies[i]
        end = getattr(body, "length", 0.0)  # a mass or a wall has none
        left = solution.position(i, end, times)
        right = solution.position(i + 1, 0.0, times)
        distance = right - left
        assert contact.gap(times) == pytest.approx(distance, abs=near)


def assert_strains_stretch_rods(solution):
    """Rods are longer by the integral of their strain, at two times.

    It is a sum over 400 places, which misses where between two of them it jumps: it is
    known to a tenth of the largest strain.
    """
    times = np.array([0.0, 0.7 * solution.t_end])
    middles = (np.arange(400) + 0.5) / 400
    shares = middles[:, None]
    for i, body in enumerate(solution.system.bodies):
        if not isinstance(body, ri.Rod):
            continue
        x = shares * body.length
        strain = solution.strain(i, x, times)  # [place, time]
        left = solution.displacement(i, 0.0, times)
        right = solution.displacement(i, body.length, times)
        stretch = body.length * strain.mean(axis=0)
        largest_strain = np.abs(strain).max()
        near = 0.1 * body.length * largest_strain + 1e-15
        assert right - left == pytest.approx(stretch, abs=near)


@by_method
@given(SEEDS, st.booleans())
def test_energies_momenta_gaps_and_strains_fit_together(method, seed, driven):
    """Energies and momenta balance; except on a grid, gaps and strains are those of the
    positions of ends.
    """
    system = ROWS[method](seed, driven)
    solution = solve_by(method, system)
    rtol = BALANCE_RTOL[method]
    assert_energies_balance(solution, driven, rtol)
    assert_outcome_is_that_at_the_end(solution, rtol)
    assert_forces_move_bodies(solution, rtol)
    if method != "finite-difference":  # where strains at the start are means over cells
        assert_gaps_are_between_ends(solution, 20 * rtol)
        assert_strains_stretch_rods(solution)


def assert_contacts_are_alike(contacts, others, times, near):
    """Gaps at these times, and impulses at the end, of two runs are equal to within
    `near`.
    """
    for contact, other in zip(contacts, others, strict=True):
        gap = contact.gap(times)
        assert other.gap(times) == pytest.approx(gap, abs=near)
        assert other.impulse == pytest.approx(contact.impulse, abs=near)


@by_method
@given(SEEDS)
def test_velocities_gaps_and_impulses_of_a_mirror_image_are_mirrored(method, seed):
    """A random driven row and its mirror image are solved by each method."""
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
    contacts_of_image = image.contacts[::-1]
    assert_contacts_are_alike(solution.contacts, contacts_of_image, times, near)


@by_method
@given(SEEDS, st.sampled_from([1.0, -30.0]))
def test_velocities_gaps_and_impulses_are_the_same_in_a_moving_frame(method, seed, v):
    """A random driven row is solved by each method, at rest and with v, m/s, added to
    all velocities.
    """
    system = ROWS[method](seed, driven=True)
    speed = 1 + abs(v)  # round-off of velocities that are v more
    near = BALANCE_RTOL[method] * speed
    if method == "finite-difference":
        near *= 11  # round-off of each of its steps adds up

    solution = solve_by(method, system)
    moving_system = shifted(system, v)
    moving = solve_by(method, moving_system)

    times = np.linspace(0, solution.t_end, 17)
    for i in range(len(system.bodies)):
        velocity = solution.mean_velocity(i, times)
        velocity_in_frame = moving.mean_velocity(i, times) - v
        assert velocity_in_frame == pytest.approx(velocity, abs=near)
    assert_contacts_are_alike(solution.contacts, moving.contacts, times, near)
