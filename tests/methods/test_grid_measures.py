"""What a force did, read from means over steps and gaps at their ends: polynomials as oracles."""


import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodimpact.methods.grid import measures as mk

EVEN = np.arange(41.0)


def means(force, times):
    return np.diff(force.integ()(times))


@pytest.mark.parametrize("way", [1, -1])
def test_a_parabola_has_the_means_of_three_steps(way):
    force, begin = Polynomial([0.3, -2, 5]), 8.0 if way > 0 else 9.0
    a, b, c = mk.parabola(means(force, EVEN), 8, way)
    assert a + b / 4 + c / 16 == pytest.approx(force(begin + way / 4))


def test_an_indentation_ends_where_its_parabola_does():
    x = Polynomial([-0.9, 0.2, 0.11])  # gaps at the ends 0, 1, 2, 3
    exact = max(x.roots())
    gap = x(np.arange(6.0))
    assert mk.end_of_force(np.ones(5), gap, 0, 3) == pytest.approx(exact, rel=1e-3)
    assert mk.end_of_force(np.ones(5), gap, 2, 3) == pytest.approx(
        2 - gap[2] / (gap[3] - gap[2])  # a line where there are too few ends
    )
    shut = np.full(6, -1.0)
    assert mk.end_of_force(np.ones(5), shut, 0, 3) == 3.0


@pytest.mark.parametrize("end", [20.04, 20.28, 20.8])
def test_a_dashpot_lets_go_inside_a_step_while_there_is_an_indentation(end):
    mean = np.diff(Polynomial([end, -1.0]).integ()(np.minimum(EVEN, end)))
    assert mk.end_of_force(mean, np.full(41, -0.1), 0, 21) == pytest.approx(end, rel=1e-9)


def test_a_faint_first_force_is_none():
    gap = np.array([0.0, 0.0, 0.0, 0.0])
    assert mk.begin_of_force(np.array([1e-7, 1.0, 1.0]), gap, 0) == 1.0
    far = np.array([5.1, 5.0, 0.0, 0.0])  # what does not close within two steps begins at once
    assert mk.begin_of_force(np.array([0.0, 1.0, 1.0]), far, 1) == 1.0


@pytest.mark.parametrize(("force", "share"), [
    ([3], 1.0), ([4, 1], 0.25), ([4, 5], 1.0), ([4, 4, 1], 0.25), ([4, 4, 4, 1], 0.25),
    ([1, 4, 1], 0.25), ([1, 4, 5], 1.0), ([4, 3.6, 1.6], 0.5), ([1.0, 0.9, 0.81, 0.729], 1.0),
    ([4, 3.6, 3.2, 2.1], 0.75),
])
def test_the_share_of_the_last_step_that_a_jump_leaves(force, share):
    assert mk.share_of_jump(np.array(force, float), 0, len(force)) == pytest.approx(share)
