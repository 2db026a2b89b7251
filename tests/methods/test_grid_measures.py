"""What a force did, read from means over steps and gaps at their ends: polynomials as oracles."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodimpact.methods.grid.measures import (
    contact_intervals,
    largest_force,
    share_of_jump,
)

EVEN = np.arange(41.0)


def spans(force, gap):
    return contact_intervals(np.array(force, float), np.array(gap, float), np.inf)[
        :, :2
    ]


def means(force, times):
    return np.diff(force.integ()(times))


def test_peaks_behind_averages():
    hump = Polynomial([1 - 20.3**2 / 1600, 2 * 20.3 / 1600, -1 / 1600])
    assert largest_force(means(hump, EVEN)) == pytest.approx(1.0, abs=1e-12)
    assert largest_force(np.zeros(3)) == 0.0
    jump = means(Polynomial([1.0, -0.02, 1e-4]), EVEN)
    for force in (jump, jump[::-1]):
        padded = np.concatenate(([0.0, 0.0], force, [0.0, 0.0]))
        assert largest_force(padded) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("roots", [(-2.3, 2.7), (2.7, 9.0), (0.5, 2.7)])
def test_an_indentation_ends_where_its_parabola_does(roots):
    """It may have to turn first; a line where there are too few ends."""
    x = Polynomial.fromroots(roots)
    gap = x(np.arange(6.0)) * (-1 if roots[1] > 3 else 1)
    assert spans([1, 1, 1, 0, 0], gap)[0, 1] == pytest.approx(2.7)
    line = 2 - gap[2] / (gap[3] - gap[2])
    assert spans([0, 0, 1, 0, 0], gap)[0, 1] == pytest.approx(line)
    assert spans([1, 1, 1, 0, 0], [-1.0] * 6)[0, 1] == 3.0


@pytest.mark.parametrize("end", [20.04, 20.28, 20.8])
def test_a_dashpot_lets_go_inside_a_step_while_there_is_an_indentation(end):
    mean = means(Polynomial([end, -1.0]), np.minimum(EVEN, end))
    assert spans(mean, np.full(41, -0.1)) == pytest.approx(
        np.array([[0.0, end]]), rel=1e-9
    )


def test_when_a_force_begins():
    """Where the gap would close, if that is within two steps; a faint first force is none."""
    found = spans([0, 0, 5, 8, 0], [0.9, 0.7, 0.1, -0.1, 0.3, 0.5])
    assert found == pytest.approx(np.array([[2 + 1 / 6, 3.25]]))
    assert spans([0, 1, 1], [5.1, 5.0, 0.0, 0.0])[0, 0] == 1.0
    assert spans([1e-7, 1, 1], [0.0] * 4)[0, 0] == 1.0


@pytest.mark.parametrize(
    ("force", "end"),
    [
        ([0, 4, 4, 4, 4 * 0.3, 0], 4.3),
        ([*np.exp(-np.arange(8) / 20), 0, 0], 8.0),  # changes evenly before the jump
        (
            [*np.maximum(3.3 - np.arange(8) - 0.5, 0), 0],
            3.3,
        ),  # means of a line that falls to 0
    ],
)
def test_a_rigid_contact_lets_go(force, end):
    assert spans(force, [0.0] * (len(force) + 1))[0, 1] == pytest.approx(end)


def test_a_force_that_goes_on_has_no_end():
    found = spans([0, 1, 0, 2, 2], [0.0] * 6)
    assert found == pytest.approx(np.array([[1.0, 2.0], [3.0, np.nan]]), nan_ok=True)
    assert spans([0, 0], [0.0] * 3).shape == (0, 2)


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
    assert share_of_jump(np.array(force, float)) == pytest.approx(share)
