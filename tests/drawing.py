"""What tests of figures share: steel rods, an empty Axes, and what is read off a
picture.
"""

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from steel import STEEL, C, rod  # noqa: F401

from rodimpact import plot
from rodimpact.plot.panels import figure_of


def axes():
    """An empty Axes."""
    return Figure(figsize=(5, 5)).add_subplot()


def render(drawn):
    """Draw a figure without a display."""
    figure = figure_of(drawn)
    figure.set_dpi(50)
    FigureCanvasAgg(figure).draw()


def settings():
    """All settings of matplotlib but its backend, a dict."""
    all_settings = dict(mpl.rcParams.copy())
    del all_settings["backend"]
    return all_settings


def corners(picture):
    """Corners of each region [corner, 2]."""
    return [path.vertices[:-1] for path in picture.regions.get_paths()]


def top_of(band):
    """Upper edge of a filled band, as {time: value}."""
    points = band.get_paths()[0].vertices  # [corner, (time, value)]
    times = points[:, 0]
    edge = {}
    for time in times:
        edge[time] = max(points[times == time, 1])
    return edge


def legend(drawn):
    """Texts of the legend of a picture or an Axes, as a list; empty without a legend."""
    shown = getattr(drawn, "ax", drawn).get_legend()
    if shown is None:
        return []
    return texts_of(shown.get_texts())


def vector_file(draw, folder):
    """The bytes of the SVG of what `draw()` returns.

    It is drawn and saved twice, and must be the same both times.
    """
    files = []
    for name in ("a.svg", "b.svg"):
        plot.save(draw(), folder / name)
        files.append((folder / name).read_bytes())
    assert files[0] == files[1]
    return files[0]


def axis_texts(axis):
    """Texts (artists) of an axis: its label, and the labels of its ticks within view."""
    texts = [axis.label]
    low, high = sorted(axis.get_view_interval())
    for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
        if low <= tick.get_loc() <= high:
            texts.append(tick.label1)
    return texts


def written(figure):
    """Texts (artists) of a drawn figure that are visible and not empty."""
    texts = list(figure.texts)
    for ax in figure.axes:
        texts += [*ax.texts, ax.title, ax._left_title, ax._right_title]
        legend_of_ax = ax.get_legend()
        if legend_of_ax is not None:
            texts += legend_of_ax.get_texts()
        for axis in (ax.xaxis, ax.yaxis):
            if ax.axison and axis.get_visible():
                texts += axis_texts(axis)
    return [text for text in texts if text.get_text().strip() and text.get_visible()]


def collisions(drawn, dpi=100):
    """Pairs of texts that overlap on a figure, and texts that leave it at a side.

    Texts that are not level or upright, such as words along fronts, are left out.
    """
    figure = figure_of(drawn)
    figure.set_dpi(dpi)
    FigureCanvasAgg(figure).draw()
    boxes = []
    for text in written(figure):
        box = text.get_window_extent().frozen()
        if text.get_text().startswith("\n"):  # a name in the line below the numbers
            box.p1 = (box.x1, (box.y0 + box.y1) / 2)
        if text.get_rotation() % 90 == 0:
            boxes.append((text.get_text(), box))
    overlaps = []
    for k, (name, box) in enumerate(boxes):
        for other, other_box in boxes[:k]:
            across = min(box.x1, other_box.x1) - max(box.x0, other_box.x0)
            along = min(box.y1, other_box.y1) - max(box.y0, other_box.y0)
            if across > 1 and along > 3:  # boxes reach a little over their letters
                overlaps.append((other, name))
        if box.x0 < -1 or box.x1 > figure.bbox.x1 + 1:
            overlaps.append((name, "frame of the figure"))
    return overlaps


def texts_of(artists):
    """Texts of these artists."""
    return [artist.get_text() for artist in artists]
