"""Light and dark figures, and sizes for print."""

import threading

import matplotlib as mpl
import numpy as np
import pytest
from drawing import rod
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.text import Text

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.style import LOOKS

SOLUTION = ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))
STEPWISE = ri.solve(
    ri.System([ri.RigidMass(0.1, velocity=1.0), rod(0.4), ri.Wall()], gaps=[0.0, 1e-5]),
    2e-4,
    "characteristics",
)
PICTURES = {
    "spacetime": lambda: plot.spacetime(SOLUTION, field="displacement", across=True).ax,
    "cells": lambda: plot.spacetime(STEPWISE, field="energy", across=True).ax,
    "snapshots": lambda: plot.snapshots(STEPWISE).ax,
    "contact": lambda: plot.contact(SOLUTION).force_ax,
    "energy": lambda: plot.energy(SOLUTION).ax,
    "gauge": lambda: plot.gauge(SOLUTION.gauge(1, 0.5)).ax,
    "restitution": lambda: plot.restitution([0.5, 1.0], [0.5, 1.0]).ax,
}
every_picture = pytest.mark.parametrize("name", PICTURES)


def luminance(colour):
    parts = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
        for c in to_rgb(colour)
    ]
    return float(np.dot(parts, [0.2126, 0.7152, 0.0722]))


def contrast(a, b):
    """Of two colours, 1 to 21, as web pages measure it."""
    lighter, darker = sorted((luminance(a), luminance(b)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("name", LOOKS)
def test_everything_can_be_seen_on_its_paper(name):
    paper, ink, faint, _, mass, series, _ = LOOKS[name]
    assert contrast(ink, paper) > 12
    assert contrast(mass, paper) > 7
    assert min(contrast(colour, paper) for colour in (faint, *series)) > 3


@every_picture
def test_words_of_dark_figures_are_light_and_paper_is_dark(name):
    with plot.look("dark"):
        figure = PICTURES[name]().figure
    assert luminance(figure.get_facecolor()) < 0.01
    assert luminance(figure.axes[0].get_facecolor()) < 0.01
    labels = [
        label
        for ax in figure.axes
        for label in (ax.xaxis.label, ax.yaxis.label, *ax.get_xticklabels())
    ]
    assert labels
    assert all(luminance(label.get_color()) > 0.7 for label in labels)
    for legend in (ax.get_legend() for ax in figure.axes):
        texts = [] if legend is None else legend.findobj(Text)
        assert all(luminance(text.get_color()) > 0.7 for text in texts)


def test_light_is_usual_and_comes_back():
    def look():
        return next(
            name for name, colours in LOOKS.items() if colours == plot.style.colours()
        )

    before = dict(mpl.rcParams.copy())
    assert look() == "light"
    with plot.look("dark"):
        assert look() == "dark"
        with plot.look("light"):
            assert look() == "light"
        assert look() == "dark"
        with pytest.raises(ValueError, match="--"), plot.look("light"):
            raise ValueError("--")
        assert look() == "dark"
    assert look() == "light"
    assert dict(mpl.rcParams.copy()) == before


def test_a_look_is_that_of_one_thread():
    seen = []
    with plot.look("dark"):
        other = threading.Thread(target=lambda: seen.append(plot.style.colours()))
        other.start()
        other.join()
    assert seen == [LOOKS["light"]]


@pytest.mark.parametrize(
    "name", few_of(PICTURES, {"spacetime", "cells", "snapshots", "energy"})
)
def test_a_column_is_as_wide_as_asked_and_labels_stay_inside(name):
    with plot.look(width=85):
        figure = PICTURES[name]().figure
    assert figure.get_figwidth() * 25.4 == pytest.approx(85)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    box = figure.get_tightbbox(canvas.get_renderer())
    assert box.x0 > -0.02
    assert box.x1 < figure.get_figwidth() + 0.02
    assert box.y0 > -0.02
    assert box.y1 < figure.get_figheight() + 0.02


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"name": "grey"}, "'light', 'dark'"),
        ({"width": 20}, "50 to 1000 mm"),
        ({"width": float("nan")}, "finite number of mm"),
    ],
)
def test_wrong_looks_are_refused(wrong, named):
    with pytest.raises(ValueError, match=named), plot.look(**wrong):
        pass
