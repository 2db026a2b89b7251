"""The proof that two sides never meet again, from what methods ask of them."""

import math
from fractions import Fraction

import pytest

from rodimpact.methods.finality_kernel import separation_time, undecided

TOL = 1e-12


def test_ends_that_cannot_approach_are_apart_at_once():
    assert separation_time(0.5, 0.0, 0.0, 324.0, TOL) == 0
    assert separation_time(-0.5, -1.5, 99.0, 0.0, TOL) == math.inf


@pytest.mark.parametrize("gap", [0.0, 0.25, 1.0])
def test_the_wait_is_until_the_mean_gap_is_beyond_the_reach_of_both(gap):
    wait = separation_time(1.5, -math.inf, gap, 25.0, TOL)
    assert gap + 1.5 * wait == pytest.approx(5.0)
    assert separation_time(1.5, -math.inf, gap + 1.5 * wait + 1e-9, 25.0, TOL) == 0


def test_a_gap_beyond_reach_is_enough_if_it_does_not_close():
    assert separation_time(0.0, -math.inf, 5.1, 25.0, TOL) == 0
    assert separation_time(0.0, -math.inf, 4.9, 25.0, TOL) == math.inf
    assert separation_time(0.0, -math.inf, -5.1, 25.0, TOL) == math.inf
    assert separation_time(-0.1, -math.inf, 5.1, 25.0, TOL) == math.inf


def test_on_fractions_it_is_decided_without_a_root():
    apart = Fraction(10**20 + 1, 10**20)
    square = Fraction(1)
    assert separation_time(Fraction(0), -math.inf, apart, square, 0) == 0
    assert separation_time(Fraction(0), -math.inf, Fraction(1), square, 0) == math.inf


@pytest.mark.parametrize(
    ("opening", "least", "open_still"),
    [(0.0, -1.0, True), (1.0, -1.0, True), (-1.0, -2.0, False), (1.0, 0.0, False)],
)
def test_velocities_alone_may_tell(opening, least, open_still):
    assert undecided(opening, least, TOL) == open_still
