"""When contacts press, from means over steps."""

import numpy as np
import pytest

from rodimpact.methods.grid.measures import pressed_spans


def spans(force, gap):
    return np.array(pressed_spans(np.array(force), np.array(gap)))


@pytest.mark.parametrize("share", [0.0625, 0.3, 0.75, 1.0])
def test_a_force_that_ends_with_a_jump_ends_inside_its_step(share):
    found = spans([0, 4, 4, 4, 4 * share, 0], [0, 0, 0, 0, 0, 0, 0.1])
    assert found == pytest.approx(np.array([[1.0, 4 + share]]))


def test_a_force_that_changes_evenly_before_a_jump_is_whole_in_its_last_step():
    force = np.exp(-np.arange(8) / 20)
    found = spans([*force, 0, 0], [0.0] * 11)
    assert found == pytest.approx(np.array([[0.0, 8.0]]))


def test_a_force_that_falls_evenly_ends_where_its_line_does():
    line = 3.3 - np.arange(8) - 0.5  # means over steps of a line that is 0 at 3.3
    found = spans(np.maximum(line, 0), [0.0] * 9)
    assert found == pytest.approx(np.array([[0.0, 3.3]]))


def test_a_contact_begins_where_its_gap_would_close():
    found = spans([0, 0, 5, 8, 0], [0.9, 0.7, 0.1, -0.1, 0.3, 0.5])
    assert found == pytest.approx(np.array([[2 + 1 / 6, 3.25]]))


def test_a_force_that_goes_on_has_no_end():
    found = spans([0, 1, 0, 2, 2], [0.0] * 6)
    assert found == pytest.approx(np.array([[1.0, 2.0], [3.0, np.nan]]), nan_ok=True)
