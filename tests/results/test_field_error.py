"""Stated errors of field values on a grid: never below the true ones."""

import numpy as np
import pytest
from exhaustive import few_of
from kelvin_voigt import rod_on_wall
from networks import UNIT, unit_rod

import rodimpact as ri

METHOD = "finite-difference"


@pytest.mark.parametrize("seed", few_of(range(20), range(1)))
def test_stated_errors_of_damped_rows_are_not_too_small(seed):
    """A rod that falls on a wall, at both ends, beside one, and at random places and
    times.
    """
    rng = np.random.default_rng([seed, 7])
    viscosity = float(np.exp(rng.uniform(np.log(0.005), np.log(0.5))))
    gap = float(rng.choice([0.0, rng.uniform(0.01, 0.3)]))
    rod = ri.Rod(
        1.0, area=1.0, material=UNIT.replace(viscosity=viscosity), velocity=1.0
    )
    rtol = float(rng.choice([1e-2, 1e-3]))
    solution = ri.solve(ri.System([rod, ri.Wall()], gaps=[gap]), 3.5, METHOD, rtol=rtol)
    t = np.sort(rng.uniform(0.02, 3.1, 9))
    x = np.concatenate(([0.0, 1.0, 0.995], rng.uniform(0, 1, 9)))
    exact, _ = rod_on_wall(x, t, viscosity)
    stated = solution.field_error(t + gap)
    for name in ("velocity", "stress", "displacement"):
        values = getattr(solution, name)(0, x[:, None], t + gap)
        if name == "displacement":
            values = values - gap
        error = np.abs(values - getattr(exact, name)).max(axis=0)  # [time]
        bound = getattr(stated, name)
        assert np.all(error <= bound + 2e-7)  # as exact as the modal sums are
        assert np.median(bound / error) <= 60


def test_errors_have_the_shape_of_the_times_and_bound_those_of_velocities():
    row = ri.System([unit_rod(velocity=0.5), unit_rod()], contacts=[ri.Hertz(2.0)])
    solution = ri.solve(row, 2.0, METHOD)
    assert solution.field_error(1.0).velocity.shape == ()
    error = solution.field_error([[0.5, 1.0], [1.5, 2.0]])
    assert error.stress.shape == (2, 2)
    assert np.all(error.displacement > 0)
    exact = ri.solve(row, 2.0, rtol=1e-10)
    x = np.linspace(0, 1, 41)[:, None]
    for t, bound in ((1.0, error.velocity[0, 1]), (2.0, error.velocity[1, 1])):
        difference = solution.velocity(0, x, t) - exact.velocity(0, x, t)
        assert np.abs(difference).max() <= bound <= 0.01
    with pytest.raises(ValueError, match="t: must lie in the solution"):
        solution.field_error(2.1)


def test_where_waves_jump_errors_are_infinite_but_for_displacements():
    """No mesh has the value at a jump."""
    row = ri.System([unit_rod(velocity=1.0), unit_rod(0.7)])
    error = ri.solve(row, 1.5, METHOD, rtol=0.02).field_error([0.5, 1.5])
    assert np.all(np.isinf(error.velocity))
    assert np.all(np.isinf(error.stress))
    assert np.all(error.displacement < 0.2)


def test_errors_are_refused_where_no_meshes_were_compared():
    row = ri.System([unit_rod(velocity=1.0), unit_rod()], contacts=[ri.Spring(1.0)])
    for solution in (ri.solve(row, 1.0, METHOD, cells=50), ri.solve(row, 1.0)):
        with pytest.raises(ValueError, match="field_error: is stated where a grid"):
            solution.field_error(0.5)
