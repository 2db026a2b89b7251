"""Stated errors of field values on a grid: never below the true ones."""

import numpy as np
import pytest
from exhaustive import few_of
from kelvin_voigt import rod_on_wall
from networks import UNIT, logarithmic, unit_rod

import rodimpact as ri

METHOD = "finite-difference"


MODAL_SUM_ERROR = 2e-7
"""Error of the sums over modes that the exact fields are."""


def random_fall_on_wall(rng):
    """Viscosity of a rod of 1 m that falls on a wall at 1 m/s, s, and its gap, m."""
    viscosity = logarithmic(rng, 0.005, 0.5)
    gap = float(rng.choice([0.0, rng.uniform(0.01, 0.3)]))
    return viscosity, gap


@pytest.mark.parametrize("seed", few_of(range(20), range(1)))
def test_stated_errors_of_a_damped_rod_on_a_wall_bound_the_true_ones(seed):
    """A damped rod falls on a wall. At both ends, beside one, and at random positions
    and times, velocity, stress and displacement differ from the exact ones by the
    stated errors at most; in the median these are at most 60 times too large.
    """
    rng = np.random.default_rng([seed, 7])
    viscosity, gap = random_fall_on_wall(rng)
    damped = UNIT.replace(viscosity=viscosity)
    rod = ri.Rod(1.0, area=1.0, material=damped, velocity=1.0)
    system = ri.System([rod, ri.Wall()], gaps=[gap])
    rtol = float(rng.choice([1e-2, 1e-3]))
    solution = ri.solve(system, 3.5, METHOD, rtol=rtol)
    since_impact = np.sort(rng.uniform(0.02, 3.1, 9))
    t = since_impact + gap  # the rod falls at 1 m/s
    x = np.concatenate(([0.0, 1.0, 0.995], rng.uniform(0, 1, 9)))

    stated = solution.field_error(t)

    exact, _ = rod_on_wall(x, since_impact, viscosity)
    for name in ("velocity", "stress", "displacement"):
        values = getattr(solution, name)(0, x[:, None], t)
        if name == "displacement":
            values = values - gap  # the exact one counts from the impact
        differences = np.abs(values - getattr(exact, name))
        error = differences.max(axis=0)  # [time]
        bound = getattr(stated, name)
        assert np.all(error <= bound + MODAL_SUM_ERROR)
        assert np.median(bound / error) <= 60


@pytest.fixture(scope="module")
def hertz_row():
    """A rod that strikes its like at 0.5 m/s through a Hertz contact; not solved."""
    bodies = [unit_rod(velocity=0.5), unit_rod()]
    return ri.System(bodies, contacts=[ri.Hertz(2.0)])


@pytest.fixture(scope="module")
def hertz_solution(hertz_row):
    """The solution of `hertz_row` on a grid, until 2 s."""
    return ri.solve(hertz_row, 2.0, METHOD)


def test_errors_have_the_shape_of_the_times(hertz_solution):
    """`field_error` at one time has errors of shape (), at times [2, 2] of shape (2,
    2), all above 0.
    """
    at_one_time = hertz_solution.field_error(1.0)
    at_times = hertz_solution.field_error([[0.5, 1.0], [1.5, 2.0]])
    assert at_one_time.velocity.shape == ()
    assert at_times.stress.shape == (2, 2)
    assert np.all(at_times.displacement > 0)


def test_stated_errors_of_velocities_bound_those_against_characteristics(
    hertz_row, hertz_solution
):
    """At two times, the velocities of a Hertz row on a grid differ from those by
    characteristics by the stated error at most, and this is at most 0.01.
    """
    exact = ri.solve(hertz_row, 2.0, rtol=1e-10)
    x = np.linspace(0, 1, 41)[:, None]
    for t in (1.0, 2.0):
        bound = hertz_solution.field_error(t).velocity
        difference = hertz_solution.velocity(0, x, t) - exact.velocity(0, x, t)
        error = np.abs(difference).max()
        assert error <= bound
        assert bound <= 0.01


def test_errors_after_the_end_of_the_solution_are_refused(hertz_solution):
    with pytest.raises(ValueError, match="t: must lie in the solution"):
        hertz_solution.field_error(2.1)


def test_where_waves_jump_errors_are_infinite_but_for_displacements():
    """No mesh has the value at a jump."""
    row = ri.System([unit_rod(velocity=1.0), unit_rod(0.7)])
    solution = ri.solve(row, 1.5, METHOD, rtol=0.02)

    error = solution.field_error([0.5, 1.5])

    assert np.all(np.isinf(error.velocity))
    assert np.all(np.isinf(error.stress))
    assert np.all(error.displacement < 0.2)


@pytest.mark.parametrize(
    "options", [{"method": METHOD, "cells": 50}, {"method": "characteristics"}]
)
def test_errors_are_refused_where_no_meshes_were_compared(options):
    """`field_error` of a run by another method, or on a single mesh, raises ValueError."""
    bodies = [unit_rod(velocity=1.0), unit_rod()]
    row = ri.System(bodies, contacts=[ri.Spring(1.0)])
    solution = ri.solve(row, until=1.0, **options)
    with pytest.raises(ValueError, match="field_error: is stated where a grid"):
        solution.field_error(0.5)
