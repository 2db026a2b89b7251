"""Halving a step until an outcome stands still."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from rodimpact.methods.refinement import TooLong, peak, refined


class Run(NamedTuple):
    factor: int
    stopped_by: str = "final"


def search(values, goal, last=64):
    """Values of one measure by level, and the levels that were run."""
    run = []

    def level(factor):
        run.append(factor)
        return Run(factor)

    return *refined(level, lambda r: {"impulse": np.array([values(r.factor)])}, goal, last), run


def test_one_small_change_is_no_convergence():
    """Half the change before the last one counts."""
    found, estimates, run = search({1: 0.0, 2: 1.0, 4: 1.1, 8: 1.1, 16: 1.1}.get, 1e-3)
    assert run == [1, 2, 4, 8, 16]
    assert found.factor == 16
    assert estimates == {"impulse": 0.0}


@pytest.mark.parametrize("order", [1, 2])
def test_the_estimate_of_a_first_order_method_is_its_error(order):
    found, estimates, _ = search(lambda factor: 1 + 0.1 / factor**order, 1e-3, 1024)
    error = 0.1 / found.factor**order
    assert estimates["impulse"] <= 1e-3
    assert error <= estimates["impulse"] * 1.01


def test_the_search_ends_at_the_last_factor():
    found, estimates, run = search(lambda factor: (-1) ** int(math.log2(factor)), 1e-3, last=8)
    assert run == [1, 2, 4, 8]
    assert estimates["impulse"] == 2.0
    assert found.factor == 8


def test_a_run_that_is_too_long_ends_the_search():
    def level(factor):
        if factor > 1:
            raise TooLong([("until", "no room")])
        return Run(factor)

    found, estimates = refined(level, lambda _: {"impulse": np.ones(1)}, 1e-3, 64)
    assert found.factor == 1
    assert estimates == {"impulse": math.inf}


def test_a_run_that_met_its_cap_is_not_taken():
    def level(factor):
        return Run(factor, "max_events" if factor > 2 else "final")

    found, _ = refined(level, lambda r: {"impulse": np.array([1.0 / r.factor])}, 1e-9, 64)
    assert found.factor == 2


def test_peaks_behind_averages():
    t = np.arange(101.0)
    smooth = 1 - ((t - 50.3) / 40) ** 2
    assert peak(smooth) == pytest.approx(1.0, abs=1e-4)
    assert peak(np.zeros(3)) == 0.0
