"""What bounds the rods in a space-time diagram, ends, contacts, masses and walls, and gauges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model import Absorbing, Joint, Moved, Pushed, Rigid, RigidMass, Rod
from ..results.gauges import Gauge
from .placing import Placing
from .plane import Plane
from .polygons import Polygons
from .raster import Raster
from .springs import length
from .style import SMALL, colours
from .thinning import evenly

Cut: TypeAlias = Polygons | Raster
WALL = 0.04  # depth of a wall, in lengths of the row
OPEN_END = (0, (3, 2))  # dashes of an end through which waves leave
DRIVEN = {Pushed: "driven by a force", Moved: "driven at a velocity"}
ARROWS = 8  # marks of a driven end
POINTS = 1000  # of the path of a gauge, at most
INSTANTS = 1000  # of the faces of a joint, or of a spring


class Borders:
    """Draws what bounds the rods."""

    def __init__(self, plan: Placing, cut: Cut, plane: Plane) -> None:
        self.plan, self.cut, self.plane, self.colours = plan, cut, plane, colours()
        self.system = plan.solution.system

    def _track(self, body: int, right: bool, times: Floats) -> Floats:
        """Path of an end of a body, straight between `times`."""
        return self.plane.points(self.plan.end(body, right, times), times)

    def ends(self) -> LineCollection:
        """Paths of the ends of all rods; dashed where waves leave for good."""
        outer = {(0, False): self.system.ends[0],
                 (len(self.system.bodies) - 1, True): self.system.ends[1]}
        ends = [(i, right) for i, body in enumerate(self.system.bodies) if isinstance(body, Rod)
                for right in (False, True)]
        absorbing = [isinstance(outer.get(end), Absorbing) for end in ends]
        edges = self.plan.solution.fields.edges
        paths = [self._track(i, right, self.cut.bends(i, edges(i)[-right])) for i, right in ends]
        return LineCollection(
            paths, colors=self.colours.ink, zorder=3,
            linewidths=[1.6 if a else 0.8 for a in absorbing],
            linestyles=[OPEN_END if a else "-" for a in absorbing])

    def contacts(self) -> tuple[LineCollection, LineCollection, LineCollection]:
        """Where bodies press, where they touch without force, and where a gap has no width."""
        pressing, touching, apart = [], [], []
        start, stop = self.plane.span
        for history in self.plan.solution.contacts:
            if not history.law.opens:
                continue
            cuts = self.cut.cuts(history)
            times = np.concatenate(([start], cuts[(cuts > start) & (cuts < stop)], [stop]))
            track = self.plane.points(self.plan.between(history.index, times), times)
            force, gap = self.cut.pressing(history, times)
            presses, touches = force > 0, (gap == 0) & isinstance(history.law, Rigid)
            pressing += _stretches(track, presses)
            touching += _stretches(track, touches & ~presses)
            if not self.plan.magnification:
                apart += _stretches(track, ~touches & ~presses)
        casing = withStroke(linewidth=4.5, foreground=self.colours.paper)
        how: Any = {"colors": self.colours.ink, "capstyle": "butt"}
        return (LineCollection(pressing, linewidths=3.0, zorder=5, path_effects=[casing],
                               label="pressing", **how),
                LineCollection(touching, linewidths=1.2, zorder=4, label="touching", **how),
                LineCollection(apart, linewidths=2.4, zorder=4, label="apart", capstyle="butt",
                               colors=self.colours.paper, path_effects=apart_style()))

    def springs(self, ax: Axes) -> list[Polygon]:
        """Where the springs of compliant contacts are pressed."""
        bands = []
        times = np.linspace(*self.plane.span, INSTANTS)
        for history in self.plan.solution.contacts:
            free = length(self.plan, history.index)
            if not (free and history.law.opens):
                continue
            left = self.plan.end(history.index, True, times)
            right = np.minimum(self.plan.end(history.index + 1, False, times), left + free)
            faces = np.stack([self.plane.points(x, times) for x in (left, right)], axis=1)
            for band in _stretches(faces, history.gap(times)[:-1] < 0):
                bands.append(Polygon(np.concatenate((band[:, 0], band[::-1, 1])), zorder=1.5,
                                     facecolor=self.colours.wall, label="spring, pressed"))
                ax.add_patch(bands[-1])
        return bands

    def walls(self, ax: Axes) -> list[Polygon]:
        """Hatched bands beyond the faces of walls and fixed ends."""
        depth, times, bands = WALL * self.plan.row, np.array(self.plane.span), []
        for i, right in self.plan.walls():
            places = self.plan.end(i, right, times)
            face = self.plane.points(places, times)
            back = self.plane.points(places + (depth if right else -depth), times)
            bands.append(Polygon(np.concatenate((face, back[::-1])), zorder=1, **wall_style()))
            ax.add_patch(bands[-1])
            ax.plot(*face.T, color=self.colours.ink, linewidth=1.5, zorder=3.5)
        return bands

    def masses(self, ax: Axes) -> list[Polygon]:
        """Dark strips along the paths of rigid masses."""
        strips = []
        for i, body in enumerate(self.system.bodies):
            if isinstance(body, RigidMass):
                left, right = (self._track(i, side, self.cut.bends(i, 0.0))
                               for side in (False, True))
                strips.append(Polygon(np.concatenate((left, right[::-1])), zorder=2.5,
                                      label="rigid mass", **mass_style()))
                ax.add_patch(strips[-1])
        return strips

    def gauges(self, ax: Axes, records: Mapping[str, Gauge]) -> list[Line2D]:
        """Paths of strain gauges, each with its name."""
        casing = [withStroke(linewidth=2.4, foreground=self.colours.paper)]
        turn: Any = {"rotation": 0, "ha": "left", "xytext": (3, 2)} if self.plane.across else {
            "rotation": 90, "ha": "right", "xytext": (-2, 3)}
        paths = []
        for name, record in records.items():
            start, stop = self.plane.span
            inside = record.times[(record.times > start) & (record.times < stop)]
            times = np.concatenate(([start], inside[evenly(inside.size, POINTS)], [stop]))
            moved = self.plan.moved(record.body, record.x, times)
            track = self.plane.points(
                self.plan.place(record.body, record.x, times, moved), times)
            paths += ax.plot(*track.T, color=self.colours.ink, linewidth=1.0, linestyle="-.",
                             zorder=5, path_effects=casing, label=name)
            ax.annotate(name, track[0], textcoords="offset points", va="bottom", zorder=6,
                        fontsize=SMALL + 1, color=self.colours.ink, path_effects=casing,
                        parse_math=False, **turn)
        return paths

    def joints(self, ax: Axes) -> list[Polygon]:
        """Hatched strips between the faces that joints hold together."""
        strips, times = [], np.linspace(*self.plane.span, INSTANTS)
        for i, law in enumerate(self.system.contacts):
            if isinstance(law, Joint):
                left, right = self._track(i, True, times), self._track(i + 1, False, times)
                strips.append(Polygon(np.concatenate((left, right[::-1])), zorder=2.5,
                                      label="joint", **joint_style()))
                ax.add_patch(strips[-1])
        return strips

    def drives(self, ax: Axes) -> list[Line2D]:
        """Arrow heads along the paths of driven ends, towards the row."""
        marks = []
        times = np.linspace(*self.plane.span, 2 * ARROWS + 1)[1::2]
        heads = "^v" if self.plane.across else "><"
        for side, end in enumerate(self.system.ends):
            if isinstance(end, Pushed | Moved):
                path = self._track(side * (len(self.system.bodies) - 1), bool(side), times)
                marks += ax.plot(*path.T, marker=heads[side], markersize=5.0, zorder=6,
                                 clip_on=False, label=DRIVEN[type(end)], **drive_style())
        return marks


def wall_style() -> dict[str, Any]:
    """Patches of walls and fixed ends."""
    return {"facecolor": colours().wall, "edgecolor": colours().faint, "hatch": "////",
            "linewidth": 0.0}


def mass_style() -> dict[str, Any]:
    """Patches of rigid masses."""
    return {"facecolor": colours().mass, "edgecolor": colours().ink, "linewidth": 0.6}


def joint_style() -> dict[str, Any]:
    """Patches between the faces of a joint."""
    return {"facecolor": colours().paper, "edgecolor": colours().ink, "hatch": "xxxxx",
            "linewidth": 3.0, "linestyle": (0, (0.5, 0.5))}


def drive_style() -> dict[str, Any]:
    """Marks of driven ends."""
    return {"linestyle": "", "color": colours().ink, "markerfacecolor": colours().paper}


def apart_style() -> list[Any]:
    """Edges of the line that stands for a gap."""
    return [withStroke(linewidth=3.6, foreground=colours().ink)]


def apart_mark() -> Line2D:
    """What the line that stands for a gap looks like in a legend."""
    return Line2D([], [], color=colours().paper, linewidth=2.4, path_effects=apart_style(),
                  label="apart")


def open_style() -> dict[str, Any]:
    """Lines of ends through which waves leave for good."""
    return {"color": colours().ink, "linewidth": 1.6, "linestyle": OPEN_END}


def _stretches(track: Floats, inside: NDArray[np.bool_]) -> list[Floats]:
    """Unbroken parts of a track; inside[i] says whether track[i] to track[i + 1] belongs to one."""
    turns = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False]))))
    return [track[i : j + 1] for i, j in turns.reshape(-1, 2)]
