"""What a force did, read from means over steps and gaps at their ends: polynomials as oracles."""

import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodimpact.methods.grid import measures as mk

EVEN = np.linspace(0, 1, 41)
CUT = np.unique(np.concatenate((EVEN, EVEN[:-1] + 0.007)))


def means(force, times):
    whole = force.integ()
    return np.diff(whole(times)) / np.diff(times)


@pytest.mark.parametrize("way", [1, -1])
def test_a_parabola_has_the_means_of_three_steps(way):
    force, begin = Polynomial([0.3, -2, 5]), CUT[8] if way > 0 else CUT[9]
    a, b, c = mk.parabola(CUT, means(force, CUT), 8, way)
    x = way * 0.01
    assert a + b * abs(x) + c * x * x == pytest.approx(force(begin + x))


def test_an_indentation_ends_where_its_parabola_does():
    x = Polynomial([-0.9, 0.2, 0.11])  # gaps at the ends 0, 1, 2, 3
    exact = max(x.roots())
    times, gap = np.arange(6.0), x(np.arange(6.0))
    assert mk.end_of_force(times, np.ones(5), gap, 0, 3) == pytest.approx(exact, rel=1e-3)
    assert mk.end_of_force(times, np.ones(5), gap, 2, 3) == pytest.approx(
        2 - gap[2] / (gap[3] - gap[2])  # a line where there are too few ends
    )
    shut = np.full(6, -1.0)
    assert mk.end_of_force(times, np.ones(5), shut, 0, 3) == 3.0


@pytest.mark.parametrize("end", [0.501, 0.507, 0.52])
def test_a_dashpot_lets_go_inside_a_part_while_there_is_an_indentation(end):
    force = Polynomial([end, -1.0])
    passed = force.integ()(np.minimum(CUT, end))
    gap = np.full(len(CUT), -0.1)
    mean = np.diff(passed) / np.diff(CUT)
    last = int(np.flatnonzero(mean > 0)[-1]) + 1
    assert mk.end_of_force(CUT, mean, gap, 0, last) == pytest.approx(end, rel=1e-9)


def test_a_faint_first_force_is_none():
    times, gap = np.arange(4.0), np.array([0.0, 0.0, 0.0, 0.0])
    assert mk.begin_of_force(times, np.array([1e-7, 1.0, 1.0]), gap, 0) == 1.0
    far = np.array([5.1, 5.0, 0.0, 0.0])  # what does not close within two steps begins at once
    assert mk.begin_of_force(times, np.array([0.0, 1.0, 1.0]), far, 1) == 1.0


@pytest.mark.parametrize(("force", "share"), [
    ([3], 1.0), ([4, 1], 0.25), ([4, 5], 1.0), ([4, 4, 1], 0.25), ([4, 4, 4, 1], 0.25),
    ([1, 4, 1], 0.25), ([1, 4, 5], 1.0), ([4, 3.6, 1.6], 0.5), ([1.0, 0.9, 0.81, 0.729], 1.0),
    ([4, 3.6, 3.2, 2.1], 0.75),
])
def test_the_share_of_the_last_step_that_a_jump_leaves(force, share):
    assert mk.share_of_jump(np.array(force, float), 0, len(force)) == pytest.approx(share)


def test_a_largest_force_beside_a_jump_is_that_of_its_own_side():
    force = means(Polynomial([2, -1]), EVEN)
    padded = np.concatenate(([0.0] * 3, force))
    times = np.concatenate((EVEN[0] - 0.025 * np.arange(3, 0, -1), EVEN))
    assert mk.largest_force(times, padded) == pytest.approx(2.0, abs=1e-12)
    assert math.isclose(mk.largest_force(EVEN, means(Polynomial([0, 4, -4]), EVEN)), 1.0)
    rising = np.concatenate((means(Polynomial([0, 4, -4]), EVEN[:17]), [0.0] * 3))
    assert mk.largest_force(EVEN[:20], rising) == pytest.approx(0.96)
