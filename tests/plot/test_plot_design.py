"""Figures of designs: wanted and reached pulse, as the results have them."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot

BAR = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
DURATION = 100e-6  # s


@pytest.fixture(scope="module")
def striker():
    """The design of a striker of three segments for a pulse that rises to 10 kN."""
    times = [0.0, DURATION / 2, DURATION]
    wanted = ri.Signal([0.0, 1e4, 1e4], times, unit="N")
    return ri.design.striker(wanted, BAR, velocity=10.0, duration=DURATION, segments=3)


def assert_is_drawn(line, signal):
    """A line shows a signal in microseconds and kilonewtons."""
    x, y = line.get_data()
    assert x == pytest.approx(1e6 * signal.times)
    assert y == pytest.approx(1e-3 * signal.values)


def test_wanted_and_reached_pulse_are_drawn_over_time(striker):
    picture = plot.design(striker)

    assert_is_drawn(picture.wanted, striker.wanted)
    assert_is_drawn(picture.reached, striker.reached)
    assert picture.ax.get_ylabel() == "force on the bar (kN)"


def test_the_outline_of_the_striker_is_drawn_to_scale(striker):
    rod = striker.system.bodies[0]
    areas = np.array([segment.area for segment in rod.segments])

    radii, edges, _ = plot.design(striker).outline.get_data()  # mm, m

    drawn_areas = np.pi * radii**2
    assert drawn_areas == pytest.approx(1e6 * areas)
    assert edges[-1] == pytest.approx(rod.length)


@pytest.mark.exhaustive
def test_a_given_axes_takes_the_pulses_alone(striker):
    ax = Figure().add_subplot()

    picture = plot.design(striker, ax)

    assert picture.ax is ax
    assert picture.outline is None


def test_notebooks_show_the_figure_above_the_table(striker):
    html = striker._repr_html_()

    assert html.startswith("<img")
    assert "misfit" in html


def test_a_rod_is_no_design():
    with pytest.raises(ValueError, match="result: must be a PulseDesign"):
        plot.design(BAR)
