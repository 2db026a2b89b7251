"""Halving a step until an outcome stands still."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from rodimpact.methods.grid.refinement import (
    DURATION_FACTOR,
    FACTORS,
    SAFETY_FACTOR,
    TIME_RESOLUTION,
    refined,
)
from rodimpact.methods.memory import TooLong


class Run(NamedTuple):
    """Stands for a run with a step of 1 s that is divided by `factor`."""

    factor: int
    stopped_by: str = "final"

    @property
    def step(self):
        """Step of the run, 1 for the coarsest."""
        return 1 / self.factor


class Search(NamedTuple):
    """What a refinement gave."""

    finest: Run
    estimates: dict[str, float]  # relative errors by measure
    factors: list[int]  # of all levels that were run


def search(impulse, rtol, max_factor=64, order=1.0):
    """Refine until the impulse, a function of the factor, is settled; a `Search`."""
    factors = []

    def run_level(factor):
        factors.append(factor)
        return Run(factor)

    def measures(run):
        return {"impulse": np.array([impulse(run.factor)])}

    finest, estimates = refined(run_level, measures, order, rtol, max_factor)
    return Search(finest, estimates, factors)


def test_levels_are_not_powers_of_two_only():
    first_ten = FACTORS[:10]
    assert first_ten == (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)


def test_four_coarser_levels_must_agree_with_the_finest():
    """Levels 3, 4, 6 and 8 agree with 12, at which the search ends."""
    impulses = {1: 0.0, 2: 0.0, 3: 1.0, 4: 1.0, 6: 1.0, 8: 1.0, 12: 1.0}

    result = search(impulses.get, rtol=1e-3)

    assert result.factors == [1, 2, 3, 4, 6, 8, 12]
    assert result.finest.factor == 12
    assert result.estimates == {"impulse": 0.0}


def test_what_powers_of_two_do_not_see_is_seen():
    """A sawtooth that is the same on all powers of two, as of a contact that closes
    inside a step, is refined up to the last level, and its error is stated.
    """

    def sawtooth(factor):
        is_power_of_two = factor & (factor - 1) == 0
        if is_power_of_two:
            return 1.0
        return 1 + 0.1 / factor

    result = search(sawtooth, rtol=1e-3, max_factor=64)

    assert result.factors[-1] == 64
    # From 48 to 64 the impulse changes by 0.1/48; first order makes of that an error of
    # 1/(64/48 - 1) = 3 times the change.
    error = 3 * 0.1 / 48
    estimate = result.estimates["impulse"]
    assert estimate == pytest.approx(SAFETY_FACTOR * error)


@pytest.mark.parametrize("order", [0.5, 1, 2])
def test_the_estimate_is_the_error_of_that_order_times_the_safety_factor(order):
    """An impulse with a known error of this order is refined: the estimate is at most
    rtol, and `SAFETY_FACTOR` times the true error to 2 %.
    """

    def impulse(factor):
        return 1 + 0.01 / factor**order

    result = search(impulse, rtol=1e-3, max_factor=1024, order=order)

    error = 0.01 / result.finest.factor**order
    estimate = result.estimates["impulse"]
    assert estimate <= 1e-3
    assert SAFETY_FACTOR * error == pytest.approx(estimate, rel=0.02)


def test_an_unsettled_duration_is_estimated_but_not_refined_for():
    """The duration is 3 s and 2 s in turn, the impulse constant: the search ends at
    four levels with an error of the duration.
    """

    def measures(run):
        longest = 2.0 + run.factor % 2  # s: 3, 2, 3 and 2 on the first levels
        return {"impulse": np.ones(1), "duration": np.array([0.0, longest])}

    finest, estimates = refined(Run, measures, order=1.0, rtol=0.01, max_factor=64)

    # Four levels are the fewest. From 3 to 4 the duration changes by 1 s; first order
    # makes of that an error of 1/(4/3 - 1) = 3 s, of a duration of 2 s.
    assert finest.factor == 4
    error = DURATION_FACTOR * 3.0 / 2.0
    assert estimates["impulse"] == 0.0
    assert estimates["duration"] == pytest.approx(SAFETY_FACTOR * error)


def test_a_settled_duration_is_known_to_a_part_of_a_step_at_best():
    """Impulse and durations do not change with the mesh: the estimate is 0 for the
    impulse, and a part of the step for the duration.
    """

    def measures(run):
        return {"impulse": np.ones(1), "duration": np.array([0.0, 2.0])}

    finest, estimates = refined(Run, measures, order=1.0, rtol=0.01, max_factor=64)

    assert finest.factor == 4
    error = TIME_RESOLUTION * finest.step
    assert estimates["impulse"] == 0.0
    assert estimates["duration"] == pytest.approx(error / 2.0)


def settled(run):
    """Measures that are the same on all levels."""
    return {"impulse": np.ones(1)}


def test_a_run_that_is_too_long_ends_the_search():
    """If the second mesh raises `TooLong`, the first one is returned with infinite
    estimates.
    """

    def run_level(factor):
        if factor > 1:
            raise TooLong([("until", "no room")])
        return Run(factor)

    finest, estimates = refined(run_level, settled, order=1.0, rtol=1e-3, max_factor=64)

    assert finest.factor == 1
    assert estimates == {"impulse": math.inf}  # of a single level


def test_a_first_run_that_is_too_long_is_refused():
    """`refined` does not catch the TooLong of its first level."""

    def run_level(factor):
        raise TooLong([("until", "no room")])

    with pytest.raises(TooLong, match="no room"):
        refined(run_level, settled, order=1.0, rtol=1e-3, max_factor=64)
