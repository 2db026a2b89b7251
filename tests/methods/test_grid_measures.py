"""What a force did, read from means over steps and gaps at their ends: polynomials as
oracles.
"""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodimpact.methods.grid.measures import (
    contact_intervals,
    largest_force,
    share_of_jump,
)

STEP_ENDS = np.arange(41.0)  # of 40 steps


def intervals(force, gap):
    """Begin and end of each interval of contact, in steps [interval, 2].

    The forces are means over steps [step], the gaps those at their ends [step + 1].
    """
    forces = np.array(force, float)
    gaps = np.array(gap, float)
    rows = contact_intervals(forces, gaps, np.inf)
    return rows[:, :2]


def means(force, times):
    """Integrals of a polynomial from time to time: its means over steps of 1."""
    integral = force.integ()
    return np.diff(integral(times))


def test_the_peak_of_a_hump_is_found_behind_its_means():
    """From the means over steps of a parabola with the peak 1 inside a step,
    `largest_force` finds the peak to 1e-12.
    """
    peak = 20.3
    distance = Polynomial([-peak, 1.0]) / 40
    hump = 1 - distance**2

    force = largest_force(means(hump, STEP_ENDS))

    assert force == pytest.approx(1.0, abs=1e-12)


def test_no_force_has_no_peak():
    assert largest_force(np.zeros(3)) == 0.0


@pytest.mark.parametrize("direction", [1, -1])
def test_the_peak_of_a_jump_is_that_at_the_jump(direction):
    """Before it the force falls evenly from 1, or after it rises evenly to 1: then
    `direction` is -1 and the order of the means is reversed.
    """
    polynomial = Polynomial([1.0, -0.02, 1e-4])
    falling = means(polynomial, STEP_ENDS)
    beside_jump = falling[::direction]
    nothing = [0.0, 0.0]
    force = np.concatenate((nothing, beside_jump, nothing))
    assert largest_force(force) == pytest.approx(1.0, abs=1e-12)


PARABOLAS = {  # gaps over time, of an indentation that ends at 2.7
    "shuts again": -Polynomial.fromroots((2.7, 9.0)),
    "shut at the start": Polynomial.fromroots((-2.3, 2.7)),
    "open at the start": Polynomial.fromroots((0.5, 2.7)),
}


@pytest.mark.parametrize("parabola", PARABOLAS.values(), ids=PARABOLAS)
def test_an_indentation_ends_where_its_parabola_does(parabola):
    """The gap is a parabola of time with a zero at 2.7, and the force has ended before."""
    gap = parabola(np.arange(6.0))

    force = [1, 1, 1, 0, 0]

    (interval,) = intervals(force, gap)

    _, end = interval
    assert end == pytest.approx(2.7)


@pytest.mark.parametrize("parabola", PARABOLAS.values(), ids=PARABOLAS)
def test_an_indentation_of_a_single_step_ends_on_a_line(parabola):
    """There are too few gaps for a parabola, so the gap of the line through two of them
    counts.
    """
    gap = parabola(np.arange(6.0))
    slope = gap[3] - gap[2]  # of the line through the gaps at 2 and 3
    zero_of_line = 2 - gap[2] / slope
    force = [0, 0, 1, 0, 0]

    (interval,) = intervals(force, gap)

    _, end = interval
    assert end == pytest.approx(zero_of_line)


def test_an_indentation_that_does_not_end_ends_with_its_force():
    """The gap stays negative after the force has ended: the interval of contact ends at
    the end of the force.
    """
    force = [1, 1, 1, 0, 0]
    gap = [-1.0] * 6
    (interval,) = intervals(force, gap)
    _, end = interval
    assert end == 3.0


@pytest.mark.parametrize("end", [20.04, 20.28, 20.8])
def test_a_dashpot_lets_go_inside_a_step_while_there_is_an_indentation(end):
    """The force falls along a line to 0; the gap stays below 0."""
    line = Polynomial([end, -1.0])
    force = means(line, np.minimum(STEP_ENDS, end))
    gap = np.full(41, -0.1)

    begins_and_ends = intervals(force, gap)

    expected = np.array([[0.0, end]])
    assert begins_and_ends == pytest.approx(expected, rel=1e-9)


def test_a_force_begins_and_ends_where_lines_of_the_gap_are_0():
    """The lines go through the two gaps before the force and the two after it."""
    force = [0, 0, 5, 8, 0]
    gap = [0.9, 0.7, 0.1, -0.1, 0.3, 0.5]

    begins_and_ends = intervals(force, gap)

    # Before the force the gap falls by 0.6 a step, after it rises by 0.4.
    begin = 2 + 0.1 / 0.6
    end = 3 + 0.1 / 0.4
    expected = np.array([[begin, end]])
    assert begins_and_ends == pytest.approx(expected)


@pytest.mark.parametrize(
    ("force", "gap"),
    [
        pytest.param([0, 1, 1], [5.1, 5.0, 0.0, 0.0], id="the gap closes far away"),
        pytest.param([1e-7, 1, 1], [0.0] * 4, id="a faint first force is none"),
    ],
)
def test_a_force_begins_with_its_first_step(force, gap):
    (interval,) = intervals(force, gap)
    begin, _ = interval
    assert begin == 1.0


LINE_TO_ZERO = np.maximum(3.3 - np.arange(8) - 0.5, 0)
"""Means of a line that falls to 0 at 3.3, but for that of its last step."""
EVEN_CHANGE = np.exp(-np.arange(8) / 20)


@pytest.mark.parametrize(
    ("force", "end"),
    [
        pytest.param([0, 4, 4, 4, 4 * 0.3, 0], 4.3, id="jump"),
        pytest.param([*EVEN_CHANGE, 0, 0], 8.0, id="even change before a jump"),
        pytest.param([*LINE_TO_ZERO, 0], 3.3, id="line"),
    ],
)
def test_a_rigid_contact_lets_go_where_its_means_tell(force, end):
    """After a jump the share of the mean of the last step tells how long it lasted."""
    shut = np.zeros(len(force) + 1)
    (interval,) = intervals(force, shut)
    _, end_of_force = interval
    assert end_of_force == pytest.approx(end)


def test_a_force_that_goes_on_has_no_end():
    """Of two intervals of force, the second goes on to the end of the run: its end is
    nan.
    """
    force = [0, 1, 0, 2, 2]
    shut = [0.0] * 6
    begins_and_ends = intervals(force, shut)

    expected = np.array([[1.0, 2.0], [3.0, np.nan]])
    assert begins_and_ends == pytest.approx(expected, nan_ok=True)


def test_without_force_there_is_no_interval():
    force = [0, 0]
    shut = [0.0] * 3
    assert intervals(force, shut).shape == (0, 2)


@pytest.mark.parametrize(
    ("force", "share"),
    [
        ([3], 1.0),
        ([4, 1], 0.25),
        ([4, 5], 1.0),
        ([4, 4, 1], 0.25),
        ([4, 4, 4, 1], 0.25),
        ([1, 4, 1], 0.25),
        ([1, 4, 5], 1.0),
        ([4, 3.6, 1.6], 0.5),
        ([1.0, 0.9, 0.81, 0.729], 1.0),
        ([4, 3.6, 3.2, 2.1], 0.75),
    ],
)
def test_the_share_of_the_last_step_that_a_jump_leaves(force, share):
    """1 where the last mean is as large as the ones before let expect."""
    forces = np.array(force, float)
    assert share_of_jump(forces) == pytest.approx(share)
