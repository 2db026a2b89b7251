"""Figures of designs: wanted and reached, as the results have them."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot

STEEL = ri.materials.steel
BAR = ri.Rod(1.0, area=1e-4, material=STEEL)
T = 100e-6


@pytest.fixture(scope="module")
def striker():
    wanted = ri.Signal([0.0, 1e4, 1e4], [0.0, T / 2, T], unit="N")
    return ri.design.striker(wanted, BAR, velocity=10.0, duration=T, segments=3)


def test_pulses_over_time_below_the_silhouette_of_the_striker(striker):
    picture = plot.design(striker)
    for line, signal in (
        (picture.wanted, striker.wanted),
        (picture.reached, striker.reached),
    ):
        assert line.get_xdata() == pytest.approx(1e6 * signal.times)
        assert line.get_ydata() == pytest.approx(1e-3 * signal.values)
    radii, edges, _ = picture.outline.get_data()
    areas = [piece.area for piece in striker.system.bodies[0].segments]
    assert np.pi * radii**2 == pytest.approx(1e6 * np.array(areas))
    assert edges[-1] == pytest.approx(striker.system.bodies[0].length)
    assert picture.ax.get_ylabel() == "force on the bar (kN)"


def test_a_given_axes_takes_the_pulses_alone(striker):
    ax = Figure().add_subplot()
    picture = plot.design(striker, ax)
    assert picture.ax is ax
    assert picture.outline is None


def test_notebooks_show_the_figure_above_the_table(striker):
    html = striker._repr_html_()
    assert html.startswith("<img")
    assert "misfit" in html


def test_what_is_no_design_is_refused():
    with pytest.raises(ValueError, match="result: must be a PulseDesign"):
        plot.design(BAR)
