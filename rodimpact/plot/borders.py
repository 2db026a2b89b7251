"""Borders in a space-time diagram: ends, contacts, masses, walls; and gauges.

Each method of `Borders` follows one kind of border through time and draws its paths.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib import collections, patches, patheffects
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from ..methods.signals import Floats
from ..model import Absorbing, Joint, Moved, Pushed, Rigid, RigidMass
from ..results.contacts import ContactHistory
from ..results.gauges import Gauge
from .layout import RowEnd
from .moments import event_times
from .plane import Plane
from .polygons import Polygons
from .raster import Raster
from .sampling import evenly, is_smooth, rods_of
from .scales import NEGLIGIBLE_RTOL
from .style import SMALL, colours

Cut: TypeAlias = Polygons | Raster
"""How the rods are cut: into polygons between fronts, or into a raster of cells."""
Stretches: TypeAlias = list[Floats]
"""Parts of paths in the picture, each an array [time, 2] in units of the axes."""

WALL_DEPTH = 0.04  # depth of a wall in the picture, in lengths of the row
DRIVE_NAMES: dict[type, str] = {
    Pushed: "driven by a force",
    Moved: "driven at a velocity",
}
ARROWS_OF_DRIVE = 8
MAX_POINTS = 1000  # points of a path that is drawn point by point
POINTS_OF_CENTRE = 101  # points of the path of a centre of mass


class ContactLines(NamedTuple):
    """Lines of contacts, by their state."""

    pressing: collections.LineCollection  # with force
    touching: collections.LineCollection  # closed without force
    apart: collections.LineCollection  # open gaps, where the picture leaves gaps out


class Borders:
    """Draws the borders of the rods in a plane."""

    def __init__(self, plane: Plane, cut: Cut) -> None:
        """Keep the plane and `cut`, which knows where the paths of ends bend.

        Nothing is drawn.
        """
        self.plane = plane
        self.ax = plane.ax
        self.layout = plane.layout
        self.solution = plane.layout.solution
        self.system = self.solution.system
        self.cut = cut
        self.times = np.linspace(*plane.span, MAX_POINTS)

    def ends(self) -> collections.LineCollection:
        """Draw the paths of both ends of all rods, as one collection of lines.

        Paths of absorbing ends are dashed.
        """
        absorbing = self._absorbing_ends()
        paths = []
        styles = []
        for i in rods_of(self.system):
            edges = self.solution.fields.edges(i)
            for is_right, x in ((False, edges[0]), (True, edges[-1])):
                times = self.cut.bends(i, x)
                paths.append(self._end_path(i, is_right, times))
                is_open = RowEnd(i, is_right) in absorbing
                styles.append(open_end_style() if is_open else end_style())
        return self._draw_lines(
            paths,
            zorder=3,
            color=[style["color"] for style in styles],
            linewidth=[style["linewidth"] for style in styles],
            linestyle=[style["linestyle"] for style in styles],
        )

    def _absorbing_ends(self) -> list[RowEnd]:
        """The ends of the row that are `Absorbing`: none, one or both."""
        absorbing = []
        for outer, end in zip(self.layout.outer_ends(), self.system.ends, strict=True):
            if isinstance(end, Absorbing):
                absorbing.append(outer)
        return absorbing

    def contacts(self) -> ContactLines:
        """Draw lines along contacts that can open: pressing, touching, or apart.

        A contact presses while its mean force is not negligible. A rigid contact
        touches while it is closed without force. A contact is drawn as apart only in
        material coordinates, which leave out gaps; elsewhere the gap itself is seen.
        """
        pressing: Stretches = []
        touching: Stretches = []
        apart: Stretches = []
        for contact in self.solution.contacts:
            if not contact.law.opens:
                continue
            # State of the contact in each interval between neighbouring times
            times = self._times_of(contact)
            mean_force = np.diff(contact.impulse_until(times)) / np.diff(times)
            gap = np.abs(contact.gap(times))
            wider_gap = np.maximum(gap[:-1], gap[1:])  # of both ends of the interval
            is_closed = wider_gap <= NEGLIGIBLE_RTOL * gap.max()
            presses = mean_force > NEGLIGIBLE_RTOL * contact.peak_force
            touches = is_closed & ~presses & isinstance(contact.law, Rigid)
            leaves_out_gaps = self.layout.magnification == 0
            is_apart = ~presses & ~touches & leaves_out_gaps

            left = self.layout.end(contact.index, is_right=True, t=times)
            right = self.layout.end(contact.index + 1, is_right=False, t=times)
            path = self.plane.points((left + right) / 2, times)
            pressing += _stretches(path, presses)
            touching += _stretches(path, touches)
            apart += _stretches(path, is_apart)

        # A border in the colour of the paper
        casing = [patheffects.withStroke(linewidth=4.5, foreground=colours().paper)]
        return ContactLines(
            self._draw_lines(
                pressing,
                label="pressing",
                capstyle="butt",
                linewidths=3.0,
                zorder=5,
                path_effects=casing,
            ),
            self._draw_lines(
                touching, label="touching", capstyle="butt", linewidths=1.2, zorder=4
            ),
            self._draw_lines(
                apart, label="apart", capstyle="butt", zorder=4, **apart_style()
            ),
        )

    def _times_of(self, contact: ContactHistory) -> Floats:
        """Times in the picture between which a contact keeps its state, in order.

        They are the times of its events and those at which its force or gap bends. A
        smooth solution has many even times instead of the latter.
        """
        events = event_times(contact, MAX_POINTS)
        if is_smooth(self.solution):
            return self._inside([*self.times, *events])
        bends, _, _ = contact.breakpoints()
        return self._inside([*bends, *events])

    def _inside(self, times: ArrayLike) -> Floats:
        """The times inside the picture in order, with its first and its last time."""
        with_span = np.append(times, self.plane.span)
        # Times outside become the first or the last, which `unique` keeps once.
        return np.unique(np.clip(with_span, *self.plane.span))

    def springs(self) -> list[patches.Polygon]:
        """Draw bands where springs are pressed, at compliant contacts that can open.

        A band fills the space between the ends of the spring while the gap is negative.
        A contact has a band for each time that it is pressed; all bands are returned.
        """
        bands = []
        for contact, start, stop in self.layout.springs(self.times):
            if not contact.law.opens:
                continue
            starts = self.plane.points(start, self.times)
            stops = self.plane.points(stop, self.times)
            # An interval between two times counts as pressed if it is so at its start.
            is_pressed = contact.gap(self.times)[:-1] < 0
            both_ends = np.stack([starts, stops], axis=1)  # [time, end, 2]
            for band in _stretches(both_ends, is_pressed):
                strip = self._fill(
                    band[:, 0],
                    band[:, 1],
                    zorder=1.5,
                    label="spring, pressed",
                    facecolor=colours().wall,
                )
                bands.append(strip)
        return bands

    def walls(self) -> list[patches.Polygon]:
        """Draw hatched bands beyond the faces of walls and fixed ends.

        Each face is a line. The bands are returned.
        """
        depth = WALL_DEPTH * self.layout.row_length
        times = np.array(self.plane.span)  # the path of a face is straight
        bands = []
        for body, is_right in self.layout.walls():
            x = self.layout.end(body, is_right, times)
            beyond = x + depth if is_right else x - depth
            face = self.plane.points(x, times)
            back = self.plane.points(beyond, times)
            band = self._fill(face, back, zorder=1, **wall_style())
            bands.append(band)
            self.ax.plot(*face.T, color=colours().ink, linewidth=1.5, zorder=3.5)
        return bands

    def masses(self) -> list[patches.Polygon]:
        """Draw a dark strip for each rigid mass, between the paths of its two ends.

        The strips are returned; the list is empty if there are no masses.
        """
        strips = []
        for i, body in enumerate(self.system.bodies):
            if isinstance(body, RigidMass):
                times = self.cut.bends(i, x=0.0)
                strip = self._fill(
                    self._end_path(i, is_right=False, times=times),
                    self._end_path(i, is_right=True, times=times),
                    zorder=2.5,
                    label="rigid mass",
                    **mass_style(),
                )
                strips.append(strip)
        return strips

    def joints(self) -> list[patches.Polygon]:
        """Draw a hatched strip for each joint, between the paths of its two faces.

        In material coordinates the faces coincide: the dotted border of the strip is a
        dotted line there.
        """
        strips = []
        for i, law in enumerate(self.system.contacts):
            if isinstance(law, Joint):
                strip = self._fill(
                    self._end_path(i, is_right=True, times=self.times),
                    self._end_path(i + 1, is_right=False, times=self.times),
                    facecolor=colours().paper,
                    edgecolor=colours().ink,
                    hatch="xxxxx",
                    linewidth=3.0,
                    linestyle=(0, (0.5, 0.5)),
                    zorder=2.5,
                    label="joint",
                )
                strips.append(strip)
        return strips

    def centres(self) -> list[Line2D]:
        """Draw a dashed path of the centre of mass of each rod.

        In material coordinates, where bodies do not move, nothing is drawn and [] is
        returned.
        """
        if self.layout.magnification == 0:
            return []
        times = np.linspace(*self.plane.span, POINTS_OF_CENTRE)
        casing = patheffects.withStroke(
            linewidth=2.2, foreground=colours().paper, alpha=0.6
        )
        lines: list[Line2D] = []
        for i in rods_of(self.system):
            X = self.layout.centre(i, times)
            path = self.plane.points(X, times)
            lines += self.ax.plot(
                *path.T,
                linestyle=(0, (5, 4)),
                color=colours().ink,
                linewidth=0.9,
                zorder=4.5,
                path_effects=[casing],
                label="centre of mass",
            )
        return lines

    def gauges(self, gauges: Mapping[str, Gauge]) -> list[Line2D]:
        """Draw the path of each strain gauge, and write its name where the path begins.

        The name is upright beside a path that runs upward. A path joins `MAX_POINTS`
        times of the gauge at most, those in the picture. The lines are returned.
        """
        # A border in the colour of the paper
        casing = [patheffects.withStroke(linewidth=2.4, foreground=colours().paper)]
        # How a name stands at the beginning of its path; the shift is in points.
        stand: dict[str, Any] = {"rotation": 90, "ha": "right", "xytext": (-2, 3)}
        if self.plane.across:
            stand = {"rotation": 0, "ha": "left", "xytext": (3, 2)}
        lines: list[Line2D] = []
        for name, gauge in gauges.items():
            chosen = evenly(gauge.times.size, MAX_POINTS)
            times = self._inside(gauge.times[chosen])
            path = self.plane.path(gauge.body, gauge.x, times)
            lines += self.ax.plot(
                *path.T,
                color=colours().ink,
                linewidth=1.0,
                linestyle="-.",
                zorder=5,
                path_effects=casing,
                label=name,
            )
            self.ax.annotate(
                name,
                path[0],
                textcoords="offset points",
                va="bottom",
                zorder=6,
                fontsize=SMALL + 1,
                color=colours().ink,
                path_effects=casing,
                parse_math=False,
                **stand,
            )
        return lines

    def drives(self) -> list[Line2D]:
        """Draw `ARROWS_OF_DRIVE` arrow heads along the path of each driven end.

        They are at equal times and point towards the row. The legend names the kind of
        drive. Other ends have no arrow heads.
        """
        # The middles of equal parts of the span
        times = np.linspace(*self.plane.span, 2 * ARROWS_OF_DRIVE + 1)[1::2]
        heads = (">", "<")  # at the left and at the right end of the row
        if self.plane.across:  # the left end is below, the right end above
            heads = ("^", "v")
        arrows: list[Line2D] = []
        for head, outer, end in zip(
            heads, self.layout.outer_ends(), self.system.ends, strict=True
        ):
            if type(end) in DRIVE_NAMES:
                path = self._end_path(outer.body, outer.is_right, times)
                arrows += self.ax.plot(
                    *path.T,
                    marker=head,
                    markersize=5.0,
                    zorder=6,
                    clip_on=False,
                    label=DRIVE_NAMES[type(end)],
                    **drive_style(),
                )
        return arrows

    def _end_path(self, body: int, is_right: bool, times: Floats) -> Floats:
        """Path [time, 2] in the picture of an end of a body at the times, s."""
        X = self.layout.end(body, is_right, times)
        return self.plane.points(X, times)

    def _fill(self, left: Floats, right: Floats, **style: Any) -> patches.Polygon:
        """Fill the strip between two paths [n, 2]."""
        # The outline goes along one path and back along the other.
        strip = patches.Polygon(np.concatenate((left, right[::-1])), **style)
        self.ax.add_patch(strip)
        return strip

    def _draw_lines(self, paths: Stretches, **style: Any) -> collections.LineCollection:
        """Draw paths as one collection, by default in the colour of ink."""
        style.setdefault("color", colours().ink)
        lines = collections.LineCollection(paths, **style)
        self.ax.add_collection(lines)
        return lines


# Styles that space-time diagrams, snapshots and films share ---------------------------


def wall_style() -> dict[str, Any]:
    """Style of walls and fixed ends."""
    return {
        "facecolor": colours().wall,
        "edgecolor": colours().faint,
        "hatch": "////",
        "linewidth": 0.0,
    }


def mass_style() -> dict[str, Any]:
    """Style of rigid masses."""
    return {"facecolor": colours().mass, "edgecolor": colours().ink, "linewidth": 0.6}


def drive_style() -> dict[str, Any]:
    """Style of arrow heads at driven ends."""
    return {
        "linestyle": "",
        "color": colours().ink,
        "markerfacecolor": colours().paper,
    }


def apart_style() -> dict[str, Any]:
    """Style of an open gap that is drawn without width: a double line."""
    # A line in the colour of the paper over a wider one in ink
    casing = patheffects.withStroke(linewidth=3.6, foreground=colours().ink)
    return {"color": colours().paper, "linewidth": 2.4, "path_effects": [casing]}


def open_end_style() -> dict[str, Any]:
    """Style of an absorbing end."""
    return {"color": colours().ink, "linewidth": 1.6, "linestyle": (0, (3, 2))}


def end_style() -> dict[str, Any]:
    """Style of any other end of a rod."""
    return {"color": colours().ink, "linewidth": 0.8, "linestyle": "-"}


def _stretches(path: Floats, inside: NDArray[np.bool_]) -> Stretches:
    """Parts of a path [n, ...] whose intervals are inside; `inside` is [n - 1].

    inside[i] says that the interval from path[i] to path[i + 1] belongs to a part.
    Neighbouring intervals are in one part.
    """
    # Between two values of [False, *inside, False] that differ, a part begins or ends.
    is_limit = np.diff(np.concatenate(([False], inside, [False])))
    limits = np.flatnonzero(is_limit).reshape(-1, 2)
    return [path[first : last + 1] for first, last in limits]
