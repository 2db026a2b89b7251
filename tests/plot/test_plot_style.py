"""Light and dark figures, and sizes for print."""

import threading

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawing import rod, settings, texts_of
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.text import Text

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.panels import figure_of
from rodimpact.plot.style import LOOKS

pytestmark = pytest.mark.usefixtures("laid_out")

MM_PER_INCH = 25.4


def solved_mass():
    """The solution by characteristics of a mass that strikes a rod before a wall."""
    mass = ri.RigidMass(0.1, velocity=1.0)
    bodies = [mass, rod(0.4), ri.Wall()]
    row = ri.System(bodies, gaps=[0.0, 1e-5])
    return ri.solve(row, 2e-4, "characteristics")


SOLUTION = ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))
SMOOTH = solved_mass()
PICTURES = {
    "spacetime": lambda: plot.spacetime(SOLUTION, field="displacement", across=True).ax,
    "cells": lambda: plot.spacetime(SMOOTH, field="energy", across=True).ax,
    "snapshots": lambda: plot.snapshots(SMOOTH).ax,
    "contact": lambda: plot.contact(SOLUTION).force_ax,
    "energy": lambda: plot.energy(SOLUTION).ax,
    "gauge": lambda: plot.gauge(SOLUTION.gauge(1, 0.5)).ax,
    "restitution": lambda: plot.restitution([0.5, 1.0], [0.5, 1.0]).ax,
}


@pytest.fixture
def closing():
    """Close all figures of pyplot after a test."""
    yield
    plt.close("all")


def luminance(colour):
    """Relative luminance of a colour, 0 to 1, as web pages measure it."""
    parts = np.array(to_rgb(colour))
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(a, b):
    """Contrast of two colours, 1 to 21, as web pages measure it."""
    darker, lighter = sorted([luminance(a), luminance(b)])
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("name", LOOKS)
def test_everything_can_be_seen_on_its_paper(name):
    """A contrast is 1 to 21: above 12 of ink, 7 of masses, 3 of other lines."""
    colours = LOOKS[name]
    paper = colours.paper

    assert contrast(colours.ink, paper) > 12
    assert contrast(colours.mass, paper) > 7
    for colour in (colours.faint, *colours.series):
        assert contrast(colour, paper) > 3


def words_of_axes(ax):
    """Labels, numbers and the texts of the legend of an Axes."""
    words = [ax.xaxis.label, ax.yaxis.label, *ax.get_xticklabels()]
    legend = ax.get_legend()
    if legend is not None:
        words += legend.findobj(Text)
    return words


@pytest.mark.parametrize("name", few_of(PICTURES, {"contact", "gauge", "restitution"}))
def test_words_of_dark_figures_are_light_and_paper_is_dark(name):
    """In the dark look, figure and axes are nearly black, and every text is light."""
    with plot.look("dark"):
        figure = PICTURES[name]().figure

    paper = figure.get_facecolor()
    paper_of_axes = figure.axes[0].get_facecolor()
    assert luminance(paper) < 0.01
    assert luminance(paper_of_axes) < 0.01
    for ax in figure.axes:
        for word in words_of_axes(ax):
            assert luminance(word.get_color()) > 0.7


def present_look():
    """The name of the look that figures have now."""
    colours = plot.style.colours()
    (name,) = [name for name in LOOKS if LOOKS[name] == colours]
    return name


def test_light_is_the_default_and_looks_come_back_in_turn():
    """Contexts `plot.look` are nested: after each of them the look outside it applies
    again.
    """
    assert present_look() == "light"
    with plot.look("dark"):
        assert present_look() == "dark"
        with plot.look("light"):
            assert present_look() == "light"
        assert present_look() == "dark"
    assert present_look() == "light"


def test_the_look_before_comes_back_after_an_error():
    with plot.look("dark"):
        with pytest.raises(ValueError, match="--"), plot.look("light"):
            raise ValueError("--")
        assert present_look() == "dark"


def test_a_look_leaves_the_settings_alone():
    """The `rcParams` of matplotlib are the same before and after `plot.look`."""
    before = dict(mpl.rcParams.copy())

    with plot.look("dark"):
        pass

    assert dict(mpl.rcParams.copy()) == before


def test_a_look_is_that_of_one_thread():
    """Another thread has the light look, although the first one is in a dark one."""
    colours = []
    with plot.look("dark"):
        other = threading.Thread(target=lambda: colours.append(plot.style.colours()))
        other.start()
        other.join()

    assert colours == [LOOKS["light"]]


SIZED = {"spacetime"}


@pytest.mark.parametrize("name", few_of(PICTURES, SIZED))
def test_a_column_is_as_wide_as_asked_and_labels_stay_inside(name):
    """The figure is 85 mm wide; labels leave it by 0.02 inches at most."""
    with plot.look(width=85):
        figure = PICTURES[name]().figure
    canvas = FigureCanvasAgg(figure)
    canvas.draw()

    width = figure.get_figwidth()  # inches
    height = figure.get_figheight()
    assert width * MM_PER_INCH == pytest.approx(85)
    box = figure.get_tightbbox(canvas.get_renderer())  # around all labels, inches
    assert box.x0 > -0.02
    assert box.x1 < width + 0.02
    assert box.y0 > -0.02
    assert box.y1 < height + 0.02


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"mode": "grey"}, "'light', 'dark'"),
        ({"width": 20}, "50 to 1000 mm"),
        ({"width": float("nan")}, "finite number of mm"),
    ],
)
def test_wrong_looks_are_refused(wrong, named):
    with pytest.raises(ValueError, match=named), plot.look(**wrong):
        pass


@pytest.mark.parametrize("mode", ["light", "dark"])
@pytest.mark.usefixtures("closing")
def test_style_sheets_have_paper_ink_and_series_of_the_looks(mode):
    """A matplotlib figure in the style sheet of a look has its paper, ink and first
    colour, and no line at the top.
    """
    with plt.style.context(f"rodimpact.plot.{mode}"):
        figure, ax = plt.subplots()
        (line,) = ax.plot([0, 1])

    colours = LOOKS[mode]
    paper = to_hex(figure.get_facecolor())
    ink = to_hex(ax.xaxis.label.get_color())
    assert paper == colours.paper
    assert ink == colours.ink
    assert line.get_color() == colours.series[0]
    top_line = ax.spines["top"]
    assert not top_line.get_visible()


COLOURS = {
    "figure.facecolor",
    "axes.facecolor",
    "text.color",
    "axes.labelcolor",
    "xtick.labelcolor",
    "ytick.labelcolor",
    "axes.edgecolor",
    "xtick.color",
    "ytick.color",
    "grid.color",
    "axes.prop_cycle",
}


def test_the_style_sheets_differ_in_colours_only():
    with plt.style.context("rodimpact.plot.light"):
        light = settings()
    with plt.style.context("rodimpact.plot.dark"):
        dark = settings()

    different = {name for name in light if light[name] != dark[name]}
    assert different == COLOURS


@pytest.mark.usefixtures("closing")
def test_axes_of_pyplot_look_like_axes_of_the_package():
    """A diagram of energy on Axes of pyplot has the labels of one on Axes of the
    package, and no line at its top.
    """
    _, ax = plt.subplots()

    picture = plot.energy(SOLUTION, ax=ax)

    own = plot.energy(SOLUTION)
    assert picture.ax is ax
    assert texts_of(picture.labels) == texts_of(own.labels)
    top_line = ax.spines["top"]
    assert not top_line.get_visible()


@pytest.mark.usefixtures("closing")
def test_a_pair_of_axes_of_pyplot_can_be_given():
    _, (upper, lower) = plt.subplots(2)

    picture = plot.contact(SOLUTION, ax=[upper, lower])

    assert picture.gap_ax is lower


@pytest.mark.usefixtures("closing")
def test_axes_of_a_part_of_a_figure_can_be_given():
    """A diagram on Axes of a subfigure belongs to the whole figure."""
    figure = plt.figure()
    left, _ = figure.subfigures(1, 2)

    picture = plot.spacetime(SOLUTION, ax=left.subplots())

    assert figure_of(picture) is figure


@pytest.fixture
def windows(closing, monkeypatch):
    """A list to which each call of `pyplot.show` adds the numbers of the open figures."""
    calls = []
    monkeypatch.setattr(plt, "get_backend", lambda: "a window")
    monkeypatch.setattr(plt, "show", lambda: calls.append(plt.get_fignums()))
    return calls


def test_show_opens_the_window_of_a_figure_of_pyplot(windows):
    figure, ax = plt.subplots()

    plot.show(plot.energy(SOLUTION, ax=ax))

    assert windows == [[figure.number]]


def test_show_gives_a_figure_of_the_package_to_pyplot_once(windows):
    """A picture, and then its figure, are shown in the same window of pyplot."""
    own = plot.energy(SOLUTION)

    plot.show(own)
    plot.show(own.ax.figure)

    (number,), (same_number,) = windows
    assert same_number == number
    assert plt.figure(number) is own.ax.figure


def test_show_refuses_a_text():
    with pytest.raises(ValueError, match="must be a figure"):
        plot.show("energy.png")
