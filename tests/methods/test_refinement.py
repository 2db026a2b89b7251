"""Halving a step until an outcome stands still."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from rodimpact.methods.grid.refinement import (
    FACTORS,
    SAFETY_FACTOR,
    TIME_RESOLUTION,
    refined,
)
from rodimpact.methods.memory import TooLong


class Run(NamedTuple):
    factor: int
    stopped_by: str = "final"

    @property
    def step(self):
        return 1 / self.factor


def search(values, goal, last=64, order=1.0):
    """Values of one measure by level, and the levels that were run."""
    run = []

    def level(factor):
        run.append(factor)
        return Run(factor)

    finest, estimates = refined(
        level, lambda r: {"impulse": np.array([values(r.factor)])}, order, goal, last
    )
    return finest, estimates, run


def test_levels_are_not_powers_of_two_only():
    assert FACTORS[:10] == (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)


def test_coarser_levels_must_agree():
    values = {1: 0.0, 2: 0.0, 3: 1.0, 4: 1.0, 6: 1.0, 8: 1.0, 12: 1.0}.get
    finest, estimates, run = search(values, 1e-3)
    assert run == [1, 2, 3, 4, 6, 8, 12]
    assert finest.factor == 12
    assert estimates == {"impulse": 0.0}


def test_what_powers_of_two_do_not_see_is_seen():
    """A sawtooth that is the same on all of them, as of a contact that closes inside a
    step.
    """
    _, estimates, run = search(lambda n: 1.0 if n & (n - 1) == 0 else 1 + 0.1 / n, 1e-3)
    assert run[-1] == 64
    assert estimates["impulse"] == pytest.approx(SAFETY_FACTOR * 0.1 / 48 * 3)


@pytest.mark.parametrize("order", [0.5, 1, 2])
def test_the_estimate_bounds_the_error_of_a_method_of_that_order(order):
    finest, estimates, _ = search(
        lambda factor: 1 + 0.01 / factor**order, 1e-3, 1024, order
    )
    error = 0.01 / finest.factor**order
    assert estimates["impulse"] <= 1e-3
    assert SAFETY_FACTOR * error == pytest.approx(estimates["impulse"], rel=0.02)


def test_a_duration_is_known_to_a_part_of_a_step_at_best_and_not_waited_for():
    def measures(run):
        return {
            "impulse": np.ones(1),
            "duration": np.array([0.0, 2.0 + run.factor % 2]),
        }

    finest, estimates = refined(Run, measures, 1.0, 0.01, 64)
    assert finest.factor == 4
    assert estimates == {
        "impulse": 0.0,
        "duration": pytest.approx(SAFETY_FACTOR * 5 / 3 * 3.0 / 2),
    }
    _, estimates = refined(Run, lambda _: {**measures(finest)}, 1.0, 0.01, 64)
    assert estimates == {
        "impulse": 0.0,
        "duration": pytest.approx(TIME_RESOLUTION / 4 / 2),
    }


def test_a_run_that_is_too_long_ends_the_search():
    def level(factor):
        if factor > 1:
            raise TooLong([("until", "no room")])
        return Run(factor)

    finest, estimates = refined(level, lambda _: {"impulse": np.ones(1)}, 1.0, 1e-3, 64)
    assert finest.factor == 1
    assert estimates == {"impulse": math.inf}


def test_a_first_run_that_is_too_long_is_refused():
    def level(factor):
        raise TooLong([("until", "no room")])

    with pytest.raises(TooLong, match="no room"):
        refined(level, lambda _: {"impulse": np.ones(1)}, 1.0, 1e-3, 64)
