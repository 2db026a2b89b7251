"""Axes of a space-time diagram: which way time runs, and ticks at lengths of rods.

In material coordinates the axis of x has a tick at both ends of every rod, and the
symbol of its length between them. The axis of time has a tick at each instant at which
a force ends or a gap opens after whole round trips of a wave, such as 2 l1/c.
"""

from typing import NamedTuple

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import AutoLocator
from numpy.typing import ArrayLike

from ..methods.signals import Floats
from .labels import (
    LETTER,
    NAME_GAP,
    length_name,
    rod_labels,
    text_width,
)
from .layout import PictureLayout
from .moments import round_trips
from .panels import format_axes, room_below, size_in_points
from .sampling import rods_of
from .scales import AxisScales, number_text
from .style import NORMAL

NUMBER_COLUMN = 26.0  # points beside the axis of x, if it is upright, for its numbers


class Span(NamedTuple):
    """Interval of time, s."""

    start: float
    stop: float


class RodOnAxis(NamedTuple):
    """A rod on the axis of x."""

    body: int
    left: float  # position on the axis, in its unit
    right: float
    left_number: float  # material coordinate, in the same unit
    right_number: float


class Plane:
    """Axes of a space-time diagram.

    Attributes
    ----------
    ax : Axes
    layout : PictureLayout
        Layout of the row.
    scales : AxisScales
    span : Span
    across : bool
        Whether time runs to the right and x upward, instead of the other way round.
    """

    def __init__(
        self,
        ax: Axes,
        layout: PictureLayout,
        scales: AxisScales,
        span: Span,
        across: bool,
    ) -> None:
        """Keep the arguments; the Axes is not changed until `format`."""
        self.ax = ax
        self.layout = layout
        self.scales = scales
        self.span = span
        self.across = across

    @property
    def time_axis(self) -> Axis:
        """The axis of time."""
        if self.across:
            return self.ax.xaxis
        return self.ax.yaxis

    @property
    def x_axis(self) -> Axis:
        """The axis of x."""
        if self.across:
            return self.ax.yaxis
        return self.ax.xaxis

    def points(self, x: Floats, times: Floats) -> Floats:
        """Points [..., 2] of the picture in units of the axes, from X, m, and times, s.

        `x` and `times` are broadcast against each other. The first number of a point
        counts to the right: it is X, or the time if time runs across.
        """
        scaled_x = x * self.scales.x.factor
        scaled_t = times * self.scales.time.factor
        pair = np.broadcast_arrays(scaled_x, scaled_t)
        if self.across:
            pair = pair[::-1]
        return np.stack(pair, axis=-1)

    def path(self, body: int, x: ArrayLike, times: Floats) -> Floats:
        """Path [time, 2] in the picture of a point of a body, x m from its left end."""
        return self.points(self.layout.point(body, x, times), times)

    def format(self) -> None:
        """Set the limits of the Axes, and labels and ticks for its present size.

        The axis of time has the limits of `span`; the axis of x includes all artists.
        """
        ax = self.ax
        format_axes(ax)
        ax.use_sticky_edges = False  # else margins would end at the cells of a raster
        low = self.span.start * self.scales.time.factor
        high = self.span.stop * self.scales.time.factor
        if self.across:
            ax.margins(0.0, 0.02)
            ax.autoscale_view()
            ax.set_xlim(low, high)
        else:
            ax.margins(0.02, 0.0)
            ax.autoscale_view()
            ax.set_ylim(low, high)
        self.fit_labels()

    def fit_labels(self) -> None:
        """Set labels and ticks of both axes that have room at their present lengths.

        The axis of x has numbers only in material coordinates.
        """
        width, height = size_in_points(self.ax)
        time_length = width if self.across else height
        x_length = height if self.across else width
        self.time_axis.set_label_text(self.scales.time.label)
        room_of_x_label = height if self.across else room_below(self.ax)
        label = self.layout.label(self.scales.x, room_of_x_label)
        self.x_axis.set_label_text(label)
        self._fit_times(time_length)
        # Length of one point on paper, in units of the axis of x
        per_point = np.ptp(self.x_axis.get_view_interval()) / x_length
        rods = self._rods()
        is_still = self.layout.magnification == 0  # material coordinates
        if is_still:
            self._fit_numbers(rods, per_point)
        self._fit_names(rods, per_point)

    def _fit_times(self, length: float) -> None:
        """Set ticks at whole round trips with their names, and numbers between them.

        `length` is that of the axis of time, points. Numbers too near to a name are
        left out. If no whole round trip has room, matplotlib's own ticks stay.
        """
        factor = self.scales.time.factor
        low = self.span.start * factor
        high = self.span.stop * factor
        # Least distance of two ticks, in heights of letters, which are `NORMAL` points:
        # names beside each other need more than names one above the other.
        distance = 1.3
        if self.across:
            distance = 3.0
        # The same distance in units of the axis
        least = distance * NORMAL * (high - low) / length

        marks: dict[float, str] = {}
        for t, name in round_trips(self.layout.solution).items():
            inside = self.span.start < t <= self.span.stop
            if inside and _is_clear(t * factor, marks, least):
                marks[t * factor] = name
        if not marks:
            return
        locator = AutoLocator()
        locator.set_axis(self.time_axis)
        numbers: dict[float, str] = {}
        for x in locator.tick_values(low, high):
            if low <= x <= high and _is_clear(x, marks, least):
                numbers[x] = number_text(x, high)
        ticks = numbers | marks
        labels = list(ticks.values())
        self.time_axis.set_ticks(list(ticks), labels=labels)

    def _rods(self) -> list[RodOnAxis]:
        """The rods from left to right, with their ends on the axis at the start.

        The start is that of the span. Each rod also has the numbers of its ends in
        material coordinates. All are in the unit of the axis.
        """
        layout = self.layout
        factor = self.scales.x.factor
        start = self.span.start
        rods = []
        for i in rods_of(layout.solution.system):
            left = layout.end(i, is_right=False, t=start)
            right = layout.end(i, is_right=True, t=start)
            left_number, right_number = layout.material_ends(i)
            rods.append(
                RodOnAxis(
                    body=i,
                    left=float(left) * factor,
                    right=float(right) * factor,
                    left_number=left_number * factor,
                    right_number=right_number * factor,
                )
            )
        return rods

    def _fit_numbers(self, rods: list[RodOnAxis], per_point: float) -> None:
        """Set ticks with material coordinates at ends of rods, where they have room.

        An end too near to a tick before it has none. `per_point` is the length of a
        point on paper, in units of the axis.
        """
        # Least distance of two ticks, in heights of letters: the width of five letters,
        # or more than a line if the numbers stand one above the other.
        distance = 5 * LETTER
        if self.across:
            distance = 1.5
        least = distance * NORMAL * per_point  # in units of the axis
        last = max(rod.right_number for rod in rods)
        numbers: dict[float, str] = {}
        for rod in rods:
            for x, number in (
                (rod.left, rod.left_number),
                (rod.right, rod.right_number),
            ):
                if _is_clear(x, numbers, least):
                    numbers[x] = number_text(number, last)
        labels = list(numbers.values())
        self.x_axis.set_ticks(list(numbers), labels=labels)

    def _fit_names(self, rods: list[RodOnAxis], per_point: float) -> None:
        """Write labels of the rods, and symbols of their lengths, along the axis.

        Both are the text of a minor tick in the middle of the rod. Its second line is
        the label of the rod from `rod_labels`: its name, or the symbol of its length,
        or "". Its first line is the symbol of the length, between the numbers at both
        ends of the rod. The first line is empty if the symbol has no room or is the
        label already, and where bodies move. If the axis is upright, only the label is
        written.
        """
        system = self.layout.solution.system
        size = rcParams["xtick.labelsize"]
        middles = [(rod.left + rod.right) / 2 for rod in rods]
        centres = [middle / per_point for middle in middles]
        bodies = [rod.body for rod in rods]
        labels_of_rods = rod_labels(system, bodies, centres, size)
        # matplotlib leaves out minor ticks at a major one, such as a middle at 0.2
        self.x_axis.remove_overlapping_locs = False
        if self.across:  # time runs to the right: the axis of x is upright
            self.x_axis.set_ticks(
                middles, labels=labels_of_rods, minor=True, rotation=90, va="center"
            )
            self.x_axis.set_tick_params(which="minor", length=0, pad=NUMBER_COLUMN)
            return
        texts = []
        for rod, label in zip(rods, labels_of_rods, strict=True):
            symbol = length_name(system, rod.body)
            number = number_text(rod.right_number, largest=rod.right_number)
            length = (rod.right - rod.left) / per_point  # of the rod, points
            # The numbers at both ends take half of their widths from the rod. The left
            # one is hardly wider than the right one, which is the larger number.
            free = length - text_width(number, size)
            needed = text_width(symbol, size) + NAME_GAP
            bodies_move = self.layout.magnification != 0
            is_label = symbol == label
            has_room = free >= needed
            if bodies_move or is_label or not has_room:
                symbol = ""
            texts.append(f"{symbol}\n{label}")
        self.x_axis.set_ticks(middles, labels=texts, minor=True)
        self.x_axis.set_tick_params(which="minor", length=0)


def _is_clear(x: float, taken: dict[float, str], least: float) -> bool:
    """Whether x is farther than `least` from every tick that is taken."""
    return all(abs(x - tick) > least for tick in taken)
