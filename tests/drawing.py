"""What tests of figures share: steel rods, an empty Axes, and what is read off a picture."""

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from steel import STEEL, C, rod  # noqa: F401

from rodimpact import plot
from rodimpact.plot.style import figure_of


def axes():
    return Figure(figsize=(5, 5)).add_subplot()


def render(drawn):
    figure = figure_of(drawn)
    figure.set_dpi(50)
    FigureCanvasAgg(figure).draw()


def settings():
    return {
        name: value for name, value in mpl.rcParams.copy().items() if name != "backend"
    }


def corners(picture):
    return [path.vertices[:-1] for path in picture.regions.get_paths()]


def top_of(band):
    """Upper edge of a band as {time: value}."""
    points = band.get_paths()[0].vertices
    return {x: max(points[points[:, 0] == x, 1]) for x in points[:, 0]}


def legend(drawn):
    shown = getattr(drawn, "ax", drawn).get_legend()
    return [] if shown is None else [text.get_text() for text in shown.get_texts()]


def vector_file(draw, folder):
    """The bytes of an SVG, which are the same every time it is drawn."""
    files = []
    for name in ("a.svg", "b.svg"):
        plot.save(draw(), folder / name)
        files.append((folder / name).read_bytes())
    assert files[0] == files[1]
    return files[0]
