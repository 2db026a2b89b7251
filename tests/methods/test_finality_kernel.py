"""The proof that two sides never meet again, from what it asks of each."""

import math

import pytest

from rodimpact.methods.finality_kernel import NEVER, Side, bound_of, separation_time

TOL = 1e-12


def side(mean, deviation=0.0, bound=0.0, low=-math.inf, high=math.inf):
    return Side(mean, low, high, deviation, bound)


def test_sides_whose_ends_cannot_approach_are_apart_at_once():
    left, right = side(0.0, bound=9.0, low=-1.0, high=0.5), side(0.0, bound=9.0, low=0.5, high=2.0)
    assert separation_time(0.0, left, right, TOL) == 0
    assert separation_time(-1e-9, left, right, TOL) == NEVER
    assert separation_time(0.0, right, left, TOL) == NEVER


@pytest.mark.parametrize("gap", [0.0, 0.25, 1.0])
def test_the_wait_is_until_the_mean_gap_is_beyond_the_reach_of_both(gap):
    left, right = side(-1.0, deviation=0.2, bound=3.0), side(0.5, deviation=-0.1, bound=2.0)
    wait = separation_time(gap, left, right, TOL)
    now = gap + 0.2 + 0.1
    assert now + 1.5 * (wait - 1) <= 5.0 < now + 1.5 * wait
    later = gap + 1.5 * wait  # the deviations are gone, the bounds are not
    assert separation_time(later + 1e-9, side(-1.0, bound=3.0), side(0.5, bound=2.0), TOL) <= 1


def test_a_gap_beyond_reach_is_enough_if_it_does_not_close():
    assert separation_time(5.1, side(0.0, bound=3.0), side(0.0, bound=2.0), TOL) == 0
    assert separation_time(4.9, side(0.0, bound=3.0), side(0.0, bound=2.0), TOL) == NEVER
    assert separation_time(5.1, side(0.1, bound=3.0), side(0.0, bound=2.0), TOL) == NEVER


def test_an_opening_that_takes_for_ever_is_never():
    assert separation_time(0.0, side(0.0, bound=1e9), side(2e-12, bound=0.0), 1e-13) == NEVER


def test_the_bound_of_a_bar_at_one_end():
    """A rod of E A = 2, L = 3, held at its far end, all of whose energy 5 is strain: u = F L/EA."""
    assert bound_of(5.0, 3 / 2) == pytest.approx(math.sqrt(2 * 5 * 3 / 2))
    assert bound_of(-1e-30, 1.0) == 0.0
