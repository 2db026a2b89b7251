"""Light and dark figures, and sizes for print."""

import threading

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawing import rod, settings
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.text import Text

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.panels import figure_of
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
        ({"mode": "grey"}, "'light', 'dark'"),
        ({"width": 20}, "50 to 1000 mm"),
        ({"width": float("nan")}, "finite number of mm"),
    ],
)
def test_wrong_looks_are_refused(wrong, named):
    with pytest.raises(ValueError, match=named), plot.look(**wrong):
        pass


def test_the_style_sheets_have_names_and_differ_in_colours_only():
    sheets = {}
    for mode in ("light", "dark"):
        with plt.style.context(f"rodimpact.plot.{mode}"):
            sheets[mode] = settings()
            figure, ax = plt.subplots()
            assert to_hex(figure.get_facecolor()) == LOOKS[mode].paper
            assert to_hex(ax.xaxis.label.get_color()) == LOOKS[mode].ink
            (line,) = ax.plot([0, 1])
            assert line.get_color() == LOOKS[mode].series[0]
            assert not ax.spines["top"].get_visible()
            plt.close(figure)
    differ = {
        name for name, value in sheets["light"].items() if value != sheets["dark"][name]
    }
    assert differ == {
        "figure.facecolor", "axes.facecolor", "text.color", "axes.labelcolor",
        "xtick.labelcolor", "ytick.labelcolor", "axes.edgecolor", "xtick.color",
        "ytick.color", "grid.color", "axes.prop_cycle",
    }  # fmt: skip


def test_axes_of_pyplot_look_like_axes_of_the_package():
    solution = SOLUTION
    figure, ax = plt.subplots()
    upper_lower = plt.subplots(2)
    try:
        picture = plot.energy(solution, ax=ax)
        own = plot.energy(solution)
        assert picture.ax is ax
        assert [t.get_text() for t in picture.labels] == [
            t.get_text() for t in own.labels
        ]
        assert not ax.spines["top"].get_visible()
        pair = plot.contact(solution, ax=upper_lower[1])
        assert pair.gap_ax is upper_lower[1][1]
        part = figure.subfigures(1, 2)[0].subplots()
        assert figure_of(plot.spacetime(solution, ax=part)) is figure
    finally:
        plt.close("all")


def test_show_opens_a_window_and_waits(monkeypatch):
    shown = []
    own = plot.energy(SOLUTION)
    figure, ax = plt.subplots()
    given = plot.energy(SOLUTION, ax=ax)
    try:
        monkeypatch.setattr(plt, "get_backend", lambda: "a window")
        monkeypatch.setattr(plt, "show", lambda: shown.append(plt.get_fignums()))
        plot.show(given)
        assert shown == [[figure.number]]  # pyplot has it already
        plot.show(own)
        plot.show(own.ax.figure)
        assert [len(numbers) for numbers in shown] == [1, 2, 2]
        assert plt.figure(shown[-1][-1]) is own.ax.figure
    finally:
        plt.close("all")
    with pytest.raises(ValueError, match="must be a figure"):
        plot.show("energy.png")
