"""Snapshots: the row at instants, one below the other, as in a textbook figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats
from ..model import RigidMass
from ..model.arguments import array
from ..model.frozen import invalid_argument
from ..results.gauges import Gauge, check_gauges
from ..results.solution import Solution, check_has_rod
from .bars import LEGEND, Bars, merged
from .labels import (
    DIGIT,
    break_label,
    rod_labels,
    spread_apart,
    text_width,
)
from .layout import choose_layout
from .moments import events_at, moments, n_hidden_events
from .panels import (
    Draft,
    Picture,
    add_colour_bar,
    axes_or_new,
    figure_of,
    finish,
    format_axes,
    room_below,
    size_in_points,
    units_per_point,
)
from .sampling import rods_of
from .scales import (
    closing_speed,
    engineering,
    first_rod,
    largest_of,
    multiple,
    number_text,
    quantity_text,
    x_scale,
)
from .style import SMALL, centred, colours, ink_on, styled

LETTERS = SMALL + 1  # height of the letters of a row, points
BESIDE = 0.36  # distance of labels from the middle of a bar, in distances between rows
LABEL_SPREAD = 0.02  # spread of velocities with one label, over the largest velocity
MAX_SHIFT = 0.75  # largest shift of a label from its piece, in widths of the label
EVENT_WIDTH = 0.3  # width of the events beside the rows, in widths of the figure
ROW_HEIGHT = 0.72  # inches
MIN_ROW_HEIGHT = 0.55  # inches, in a narrow figure
AROUND_ROWS = 0.9  # inches, height of the axis below all rows


@styled
def snapshots(
    solution: Solution,
    ax: Axes | None = None,
    times: Sequence[float] | Floats | None = None,
    magnification: float | None = None,
    gauges: Mapping[str, Gauge] | None = None,
) -> Picture:
    """Draw the row at chosen times, one below the other, coloured by velocity.

    Every uniform piece is labelled with its velocity in the frame of the picture, as a
    multiple of the closing speed v. If no bodies approach each other, the unit is named
    under the picture. Displacements and gaps are magnified as in `spacetime`.
    Compressed pieces are drawn shorter and thicker, stretched pieces longer and
    thinner. A thick line marks a contact that presses. Small triangles above a bar show
    the direction of a front. Without fronts there is a colour bar, and parts of nearly
    equal velocity are labelled with their mean, to two digits. Rigid masses are dark
    blocks of the width named under the picture, with their velocity below. Fixed ends
    are hatched like walls, absorbing ends are dashed, driven ends have arrow heads.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.
    times : sequence of float, optional
        Times, s; by default at most eight: start, waves half-way, reflections, events
        at the contacts, and end. A line below the picture tells how many events are not
        shown; the first and the last are.
    magnification : float, optional
        Factor of displacements and gaps; by default chosen as in `spacetime`.
    gauges : mapping of str to Gauge, optional
        Strain gauges to be marked, by name, as for `gauges_to_csv`.

    Returns
    -------
    Picture
        With `bars`, a polygon for each uniform piece, row by row (without fronts, many
        pieces to a rod, with `outlines` and a `colour_bar`, otherwise None); `times`,
        `labels`, `fronts`, `walls`, which are fixed ends too, and `masses`.

    Raises
    ------
    ValueError
        If a time is outside the solution, `times` is empty, or the magnification is not
        positive.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> picture = ri.plot.snapshots(solution, times=[0.0, 1e-4])
    >>> bool(picture.ax.figure.get_figwidth() > 0)
    True
    """
    check_has_rod(solution)
    hidden = ""
    if times is None:
        row_times = moments(solution)
        n_hidden = n_hidden_events(solution, row_times)
        if n_hidden:
            hidden = f"times of events at contacts not shown: {n_hidden}"
    else:
        row_times = array("times", times, "s").ravel()
    if row_times.size == 0:
        raise invalid_argument("times", "needs at least one time, got none")
    # This raises ValueError for times outside the solution.
    solution.fields.to_ticks(row_times)
    stop = float(row_times.max())
    layout = choose_layout(solution, 0.0, stop, magnification=magnification)
    x = x_scale(layout.row_length)

    height = AROUND_ROWS + ROW_HEIGHT * row_times.size
    least_height = AROUND_ROWS + MIN_ROW_HEIGHT * row_times.size
    ax = axes_or_new(ax, width=9.6, height=height, least_height=least_height)
    bars = Bars(ax, layout, row_times, x)
    norm = centred(bars.pieces.velocity, layout.frame)
    rods = bars.draw_rods(bars.pieces.velocity, norm)
    outlines = bars.draw_outlines()
    fronts = bars.draw_fronts()
    walls = bars.draw_walls()
    masses = bars.draw_masses()
    bars.draw_marks()
    if gauges is not None:
        bars.draw_gauges(check_gauges(gauges))
    _set_limits(bars)
    _draw_first_ends(bars)

    velocity = _VelocityLabels(bars)
    _name_rows(ax, solution, row_times)
    labels = [layout.label(x, size_in_points(ax)[0]), velocity.unit, LEGEND]
    if hidden:
        labels.append(hidden)
    bar = None
    if bars.is_smooth:
        bar = add_colour_bar(
            ax,
            rods,
            velocity.scale.label,
            layout.frame,
            location="bottom",
            fraction=0.03,
            aspect=50,
            shrink=0.6,
            format=lambda value, _: number_text(
                value * velocity.scale.factor,
                largest=0.0,  # so that no number counts as round-off
            ),
        )
    picture = Picture(
        ax=ax,
        times=row_times,
        bars=rods,
        labels=[],
        fronts=fronts,
        walls=walls,
        masses=masses,
        outlines=outlines,
        colour_bar=bar,
    )

    def set_axis_label() -> None:
        """Write the lines below the picture, broken at its present width."""
        width = room_below(ax)
        ax.set_xlabel("\n".join(break_label(label, width) for label in labels))

    def write_words() -> None:
        """Label the axis anew; write velocities and names of rods."""
        set_axis_label()
        picture.labels = _label_pieces(bars, norm, velocity.write)
        picture.labels += _label_masses(bars, velocity.write)
        _name_rods(bars)

    set_axis_label()
    return finish(Draft(picture, write_words))


def _set_limits(bars: Bars) -> None:
    """Set the limits of the Axes, with room for labels at the rows and at masses.

    All artists so far are included along x.
    """
    ax = bars.ax
    has_masses = any(isinstance(body, RigidMass) for body in bars.system.bodies)
    ax.use_sticky_edges = False  # else a block at the edge would have no margin
    ax.margins(x=0.1 if has_masses else 0.03)
    ax.autoscale_view()
    # The rows are at 0, -1, ..., 1 - size.
    ax.set_ylim(0.45 - bars.times.size, 0.8)


def _draw_first_ends(bars: Bars) -> None:
    """Draw dashed lines down the picture at the right ends that bodies have at first.

    The last body has none.
    """
    for i in range(len(bars.system.bodies) - 1):
        first_row = 0
        bars.ax.axvline(
            float(bars.end(i, is_right=True)[first_row]),
            color=colours().faint,
            linewidth=0.6,
            linestyle=(0, (4, 4)),
            zorder=1,
        )


class _VelocityLabels:
    """Texts of velocities: multiples of the closing speed v, or numbers with a unit.

    A unit is used if no bodies approach each other.

    Attributes
    ----------
    scale : Scale
        Scale of velocities, for the colour bar and for numbers with a unit.
    unit : str
        Line under the picture that names the closing speed or the unit.
    """

    def __init__(self, bars: Bars) -> None:
        """Choose scale and unit: the closing speed of the solution, if there is any.

        The scale fits the largest velocity of all pieces.
        """
        self._largest = largest_of(bars.pieces.velocity)
        self._closing = closing_speed(bars.solution)
        self._frame = bars.layout.frame
        self._is_smooth = bars.is_smooth
        self.scale = engineering("velocity", self._largest, "m/s")
        if self._closing:
            self.unit = f"closing speed v = {quantity_text(self._closing, 'm/s')}"
        else:
            self.unit = f"velocities ({self.scale.unit})"

    def write(self, velocity: float) -> str:
        """Text of a velocity in the picture's frame, as a multiple of v.

        Without a closing speed it is the velocity in the unit of `scale`. In a smooth
        solution it is rounded to hundredths of v, or of the largest velocity.
        """
        if self._closing:
            ratio = (velocity - self._frame) / self._closing
        else:
            ratio = velocity / (self._largest or 1.0)
        if self._is_smooth:
            ratio = round(ratio, 2)
        if self._closing:
            return multiple(ratio, "v")
        largest = self._largest * self.scale.factor
        return number_text(ratio * self._largest * self.scale.factor, largest)


def _name_rows(ax: Axes, solution: Solution, row_times: Floats) -> None:
    """Write the time of each row to its left, the events at this time to its right.

    The time is given in s, ms or µs, and below in transit times of the first rod.
    """
    format_axes(ax)
    time = engineering("time", solution.t_end, "s")
    rod, length = first_rod(solution)
    names = []
    for t in row_times.tolist():
        transits = t / float(rod.transit_time)
        names.append(f"{t * time.factor:.4g} {time.unit}\n{transits:.3g} {length}/c")
    ax.set_yticks(-np.arange(row_times.size), names)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    room = EVENT_WIDTH * 72 * figure_of(ax).get_figwidth()
    for stage, t in enumerate(row_times.tolist()):
        events = []
        for line in events_at(solution, t).splitlines():
            events.append(break_label(line, room))
        ax.text(
            1.01,  # just to the right of the Axes
            -stage,  # height of the row in data coordinates
            "\n".join(events),
            transform=ax.get_yaxis_transform(),
            va="center",
            fontsize=LETTERS,
        )


def _label_masses(bars: Bars, write: Callable[[float], str]) -> list[Text]:
    """Write the velocity of each mass below it in each row, or above it.

    If masses are neighbours, every second one has its label above, so that labels do
    not overlap. `write` makes the text of a velocity.
    """
    labels: list[Text] = []
    is_above = False
    for i, body in enumerate(bars.system.bodies):
        if not isinstance(body, RigidMass):
            is_above = False
            continue
        height = -BESIDE  # of the label above the middle of the row
        va = "top"
        if is_above:
            height = BESIDE
            va = "bottom"
        x = bars.layout.middle(i, bars.times) * bars.x_scale.factor
        velocities = bars.solution.velocity(i, x=0.0, t=bars.times).tolist()
        for stage, velocity in enumerate(velocities):
            y = height - stage  # the middle of row `stage` is at -stage
            labels.append(_write(bars.ax, x[stage], y, write(velocity), va=va))
        is_above = not is_above
    return labels


class _Label(NamedTuple):
    """Label of a piece that is too narrow to bear it."""

    x: float  # middle of the piece, or of the label when it has been moved
    width: float  # width of the label, in the unit of the axis
    text: str


def _label_pieces(bars: Bars, norm: Any, write: Callable[[float], str]) -> list[Text]:
    """Write the velocity into each piece of each row, or below it if it is too narrow.

    Labels below are moved apart, and some are left out. In a smooth solution pieces of
    nearly equal velocity have one label with their mean, and no label stands below.
    `write` makes the text of a velocity.
    """
    pieces = bars.pieces
    if bars.is_smooth:
        # The colours go as far below the velocity of the frame as above it.
        largest = float(norm.vmax - norm.vmin) / 2
        pieces = merged(pieces, LABEL_SPREAD * largest)
    labels: list[Text] = []
    for stage in range(bars.times.size):  # row `stage` is drawn at the height -stage
        below: list[_Label] = []
        for piece in pieces[pieces.row == stage]:
            text = write(piece.velocity)
            width = _width(bars.ax, text)
            x = (piece.left + piece.right) / 2
            if piece.right - piece.left > width:
                ink = ink_on(norm, piece.velocity)
                label = _write(
                    bars.ax, x, float(-stage), text, va="center_baseline", color=ink
                )
                labels.append(label)
            elif not bars.is_smooth:
                below.append(_Label(x, width, text))
        y_below = -stage - BESIDE
        for moved in _with_room_below(below):
            labels.append(_write(bars.ax, moved.x, y_below, moved.text, va="top"))
    return labels


def _with_room_below(labels: list[_Label]) -> list[_Label]:
    """Labels of a row, from left to right, moved apart so that none overlap.

    While a label would move by more than `MAX_SHIFT` of its width, the label that moves
    farthest is left out: the result may be shorter than `labels`, even empty.
    """
    labels = sorted(labels)  # by x
    while labels:
        widths = [label.width for label in labels]
        moved = spread_apart([label.x for label in labels], widths)
        shifts = []
        for label, x in zip(labels, moved, strict=True):
            shifts.append(abs(x - label.x) / label.width)
        farthest = int(np.argmax(shifts))
        if shifts[farthest] <= MAX_SHIFT:
            apart = []
            for label, x in zip(labels, moved, strict=True):
                apart.append(label._replace(x=x))
            return apart
        labels = labels[:farthest] + labels[farthest + 1 :]
    return []


def _name_rods(bars: Bars) -> None:
    """Write the names of the rods, or symbols of their lengths, above the first row.

    `rod_labels` chooses: the names if all have room, else the symbols that have room.
    """
    per_point = float(units_per_point(bars.ax)[0])
    rods = rods_of(bars.system)
    middles = []  # in the unit of the axis
    centres = []  # the same in points
    for i in rods:
        X = float(bars.layout.middle(i, bars.times[0]))
        middle = X * bars.x_scale.factor
        middles.append(middle)
        centres.append(middle / per_point)
    names = rod_labels(bars.system, rods, centres, LETTERS)
    for middle, name in zip(middles, names, strict=True):
        _write(bars.ax, middle, y=0.5, text=name, va="bottom")


def _width(ax: Axes, text: str) -> float:
    """Width of a text and a margin of half a digit, in the unit of the axis of x."""
    points = text_width(text, LETTERS, DIGIT) + DIGIT * LETTERS / 2
    return points * float(units_per_point(ax)[0])


def _write(
    ax: Axes, x: float, y: float, text: str, *, va: str, color: str | None = None
) -> Text:
    """Write a text centred at x, by default in ink."""
    if color is None:
        color = colours().ink
    return ax.text(
        x, y, text, color=color, ha="center", va=va, fontsize=LETTERS, zorder=5
    )
