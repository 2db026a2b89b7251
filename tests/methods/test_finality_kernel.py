"""The proof that two sides never meet again, from what methods ask of them."""

import math
from fractions import Fraction

import pytest

from rodimpact.methods.finality_kernel import separation_time, undecided

VELOCITY_ATOL = 1e-12  # velocity that counts as zero, m/s
REACH = 5.0  # distance that vibration can bridge, m


def wait_of_vibrating(opening, mean_gap):
    """Separation time, s, of two sides whose ends may approach at any velocity.

    The mean gap, m, opens with `opening`, m/s.
    """
    return separation_time(opening, -math.inf, mean_gap, REACH**2, VELOCITY_ATOL)


def test_ends_that_cannot_approach_are_apart_at_once():
    """However far they vibrate: their least opening is 0."""
    wait = separation_time(
        opening=0.5,
        least_opening=0.0,
        mean_gap=0.0,
        bound_squared=18.0**2,
        tolerance=VELOCITY_ATOL,
    )

    assert wait == 0


def test_a_mean_gap_that_closes_is_never_enough():
    """The wait has no end, without vibration and beyond the reach of vibrations."""
    wait_without_vibration = separation_time(
        opening=-0.5,
        least_opening=-1.5,
        mean_gap=99.0,
        bound_squared=0.0,
        tolerance=VELOCITY_ATOL,
    )
    wait_beyond_reach = wait_of_vibrating(opening=-0.1, mean_gap=REACH + 0.1)

    assert wait_without_vibration == math.inf
    assert wait_beyond_reach == math.inf


@pytest.mark.parametrize("gap", [0.0, 0.25, 1.0])
def test_the_wait_is_until_the_mean_gap_is_beyond_the_reach_of_both(gap):
    """At an opening of 1.5, the wait ends when the mean gap has grown to `REACH`; from
    there on it is 0.
    """
    opening = 1.5

    wait = wait_of_vibrating(opening, mean_gap=gap)
    gap_then = gap + opening * wait
    wait_from_then = wait_of_vibrating(opening, mean_gap=gap_then + 1e-9)

    assert gap_then == pytest.approx(REACH)
    assert wait_from_then == 0


def test_a_mean_gap_that_stays_is_enough_if_it_is_beyond_reach():
    assert wait_of_vibrating(opening=0.0, mean_gap=REACH + 0.1) == 0
    assert wait_of_vibrating(opening=0.0, mean_gap=REACH - 0.1) == math.inf
    assert wait_of_vibrating(opening=0.0, mean_gap=-REACH - 0.1) == math.inf


def test_fractions_are_decided_without_a_root():
    """A float would not tell a gap just beyond the reach, which is 1, from it."""

    def wait_of_gap_that_stays(gap):
        opening = Fraction(0)
        reach_squared = Fraction(1)
        return separation_time(opening, -math.inf, gap, reach_squared, tolerance=0)

    just_beyond = 1 + Fraction(1, 10**20)
    assert wait_of_gap_that_stays(just_beyond) == 0
    assert wait_of_gap_that_stays(Fraction(1)) == math.inf


@pytest.mark.parametrize(
    ("opening", "least_opening", "is_undecided"),
    [(0.0, -1.0, True), (1.0, -1.0, True), (-1.0, -2.0, False), (1.0, 0.0, False)],
)
def test_velocities_decide_if_means_close_or_ends_cannot_approach(
    opening, least_opening, is_undecided
):
    assert undecided(opening, least_opening, VELOCITY_ATOL) == is_undecided
