"""What must hold for random rows by each of the methods, with any bodies, laws and ends."""

import math

import numpy as np
import pytest
from grid_rows import random_row
from hypothesis import given
from hypothesis import strategies as st
from networks import STEP, random_network, shifted
from systems import horizon, with_ends

import rodimpact as ri

seeds = st.integers(0, 10**6)
ROWS = {
    "fronts": lambda seed, driven: with_ends(seed, driven, moving_walls=driven),
    "characteristics": lambda seed, driven: random_network(
        seed, bodies=4, driven=driven
    ),
    "finite-difference": lambda seed, driven: random_row(seed, bodies=4, driven=driven),
}
NEAR = {"fronts": 1e-10, "characteristics": 1e-6, "finite-difference": 1e-10}
by_method = pytest.mark.parametrize("method", ROWS)
LOSSES = "dissipated", "damped", "numerical"
WORKS = "wall_work", "drive_work", "gravity_work", "radiated"


def solved(system, method):
    until = 2.0
    options = {}
    if method == "fronts":
        until = horizon(system, 12.0)
        options = {"max_events": 20_000}
    if method == "finite-difference":
        until = 1.5
        options = {"dt": STEP}
    return ri.solve(system, until, method, **options)


def assert_books_balance(solution, driven, near):
    """Energies add up at every time and are no less than 0; what is lost stays lost."""
    ledger = solution.energy(np.linspace(0, solution.t_end, 33))
    works = [getattr(ledger, name) for name in WORKS]
    scale = ledger.total.max() + max(np.abs(work).max() for work in works) + 1e-300
    assert np.abs(ledger.residual).max() <= near * scale
    for entry in (
        ledger.kinetic,
        ledger.vibrational_kinetic,
        ledger.strain,
        ledger.contact,
    ):
        assert entry.min() >= -1e-12 * scale
    for entry in (getattr(ledger, name) for name in LOSSES):
        assert entry[0] == 0
        assert driven or np.diff(entry).min() >= -near * scale
    for entry in works[:3] if not driven else ():
        assert np.abs(entry).max() <= 1e-12 * scale
    outcome = solution.outcome
    assert abs(outcome.momentum_residual) <= near / 10
    assert abs(outcome.energy_residual) <= near
    told = [outcome.kinetic_after, sum(outcome.vibration_after), outcome.contact_energy]
    told += [getattr(outcome, name) for name in (*LOSSES, *WORKS)]
    last = [
        getattr(ledger, name)[-1]
        for name in ("kinetic", "vibration", "contact", *LOSSES, *WORKS)
    ]
    assert told == pytest.approx(last, abs=near * scale)


def assert_forces_move_bodies(solution, near):
    """Contacts, ends and gravity between them change the momentum of each body.

    The force on a fixed end is not kept by all methods.
    """
    system = solution.system
    t = np.linspace(0, solution.t_end, 9)
    ticks = solution.fields.to_ticks(t)
    tick = solution.fields.clock.tick
    outer = [
        side.push.integral(0, ticks) * tick
        if side
        else t * (math.nan if isinstance(end, ri.Fixed) else 0.0)
        for side, end in zip(
            solution.run.signals.boundary_actions, system.ends, strict=True
        )
    ]
    walls = [isinstance(system.bodies[i], ri.Wall) for i in (0, -1)]
    forces = [
        *outer[: not walls[0]],
        *(c.impulse_until(t) for c in solution.contacts),
        *outer[2 - (not walls[1]) :],
    ]
    free = [i for i, body in enumerate(system.bodies) if not isinstance(body, ri.Wall)]
    masses = solution.outcome.masses
    scale = sum(masses[i] for i in free) * solution.fields.clock.scale + np.nansum(
        np.abs(forces)
    )
    for i, before, after in zip(free, forces[:-1], forces[1:], strict=True):
        V = solution.mean_velocity(i, t)
        impulse = before - after
        gained = masses[i] * (V - V[0] - system.gravity * t)
        assert np.isnan(impulse[-1]) or gained == pytest.approx(
            impulse, abs=near * scale + 1e-15
        )


def assert_gaps_are_between_ends(solution, near):
    t = np.linspace(0, solution.t_end, 23)
    for i, contact in enumerate(solution.contacts):
        end = getattr(solution.system.bodies[i], "length", 0.0)
        distance = solution.position(i + 1, 0.0, t) - solution.position(i, end, t)
        if not isinstance(
            contact.law, ri.Yielding
        ):  # whose gap grows by what is crushed
            assert contact.gap(t) == pytest.approx(distance, abs=near)


def assert_strains_stretch_rods(solution):
    """At two times, but for the jumps between 400 places."""
    t = np.array([0.0, 0.7 * solution.t_end])
    for i, body in enumerate(solution.system.bodies):
        if isinstance(body, ri.Rod):
            x = (np.arange(400)[:, None] + 0.5) / 400 * body.length
            strain = solution.strain(i, x, t)
            moved = [solution.displacement(i, end, t) for end in (0.0, body.length)]
            near = 0.1 * body.length * np.abs(strain).max() + 1e-15
            assert moved[1] - moved[0] == pytest.approx(
                body.length * strain.mean(axis=0), abs=near
            )


@by_method
@given(seeds, st.booleans())
def test_energy_momentum_and_gaps(method, seed, driven):
    solution = solved(ROWS[method](seed, driven), method)
    near = NEAR[method]
    assert_books_balance(solution, driven, near)
    assert_forces_move_bodies(solution, near)
    if method != "finite-difference":  # where strains at the start are means over cells
        assert_gaps_are_between_ends(solution, 20 * near)
        assert_strains_stretch_rods(solution)


def assert_alike(one, other, sign, shift, near):
    """Velocities, gaps and impulses of two runs of a row, the second mirrored or shifted."""
    count = len(one.system.bodies)
    t = np.linspace(0, one.t_end, 17)
    for i in range(count):
        found = sign * other.mean_velocity(count - 1 - i if sign < 0 else i, t) - shift
        assert found == pytest.approx(one.mean_velocity(i, t), abs=near)
    for a, b in zip(one.contacts, other.contacts[::sign], strict=True):
        assert b.gap(t) == pytest.approx(a.gap(t), abs=near)
        assert b.impulse == pytest.approx(a.impulse, abs=near)


@by_method
@given(seeds)
def test_mirror(method, seed):
    system = ROWS[method](seed, driven=True)
    assert_alike(
        *(solved(s, method) for s in (system, system.mirrored())), -1, 0.0, NEAR[method]
    )


@by_method
@given(seeds, st.sampled_from([1.0, -30.0]))
def test_galilean_shift_changes_nothing(method, seed, v):
    system = ROWS[method](seed, driven=True)
    near = NEAR[method] * (1 + 10 * (method == "finite-difference")) * (1 + abs(v))
    assert_alike(*(solved(s, method) for s in (system, shifted(system, v))), 1, v, near)
