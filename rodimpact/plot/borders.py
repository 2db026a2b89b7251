"""What bounds the rods in a space-time diagram: their ends, contacts, masses and walls."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..model import Absorbing, Bonded, Fixed, Force, Rigid, RigidMass, Rod, Velocity, Wall
from ..signals import Floats
from .placing import Placing
from .polygons import Polygons
from .raster import Raster
from .scales import Scale
from .style import FAINT, INK, MASS, WALL

Cut: TypeAlias = Polygons | Raster
OPEN_END = (0, (3, 2))  # dashes of an end through which waves leave
DRIVEN = {Force: "driven by a force", Velocity: "driven at a velocity"}
ARROWS = 8  # marks of a driven end
_CASING = [withStroke(linewidth=4.5, foreground="white")]


class Borders:
    """Draws what bounds the rods, at places and times in the units of two scales."""

    def __init__(
        self, plan: Placing, cut: Cut, span: tuple[float, float], time: Scale, place: Scale
    ) -> None:
        self.plan, self.cut, self.span, self.time, self.place = plan, cut, span, time, place
        self.system = plan.solution.system

    def _points(self, places: Floats, times: Floats) -> Floats:
        """[n, 2] points of the picture."""
        return np.column_stack((places * self.place.factor, times * self.time.factor))

    def _track(self, body: int, right: bool, times: Floats) -> Floats:
        """Path of an end of a body, straight between `times`."""
        return self._points(self.plan.end(body, right, times), times)

    def ends(self) -> LineCollection:
        """Paths of the ends of all rods; dashed where waves leave for good."""
        paths, absorbing = [], []
        outer = {(0, False): self.system.ends[0],
                 (len(self.system.bodies) - 1, True): self.system.ends[1]}
        for i, body in enumerate(self.system.bodies):
            if not isinstance(body, Rod):
                continue
            for right, x in ((False, 0.0), (True, self.plan.solution.fields.edges(i)[-1])):
                paths.append(self._track(i, right, self.cut.bends(i, x)))
                absorbing.append(isinstance(outer.get((i, right)), Absorbing))
        return LineCollection(
            paths, colors=INK, zorder=3, linewidths=[1.6 if a else 0.8 for a in absorbing],
            linestyles=[OPEN_END if a else "-" for a in absorbing],
        )

    def contacts(self) -> tuple[LineCollection, LineCollection]:
        """Where bodies press, and where they touch without force."""
        pressing, touching = [], []
        start, stop = self.span
        for history in self.plan.solution.contacts:
            if isinstance(history.law, Bonded):
                continue
            cuts = self.cut.cuts(history)
            times = np.concatenate(([start], cuts[(cuts > start) & (cuts < stop)], [stop]))
            track = self._points(self.plan.between(history.index, times), times)
            force, gap = self.cut.pressing(history, times)
            pressing += _stretches(track, force > 0)
            if isinstance(history.law, Rigid):
                touching += _stretches(track, (force <= 0) & (gap == 0))
        return (LineCollection(pressing, colors=INK, linewidths=3.0, zorder=5, capstyle="butt",
                               path_effects=_CASING),
                LineCollection(touching, colors=INK, linewidths=1.2, zorder=4, capstyle="butt"))

    def walls(self, ax: Axes) -> list[Polygon]:
        """Hatched bands beyond the faces of walls and fixed ends."""
        depth = 0.04 * self.plan.row * self.place.factor
        last, times = len(self.system.bodies) - 1, np.array(self.span)
        bands = []
        for i, body in enumerate(self.system.bodies):
            fixed = [right for right, outermost in ((False, 0), (True, last)) if i == outermost
                     and isinstance(self.system.ends[right], Fixed)]
            for right in [i > 0] if isinstance(body, Wall) else fixed:
                face = self._track(i, right, times)
                back = face[::-1] + np.array([depth if right else -depth, 0.0])
                bands.append(Polygon(
                    np.concatenate((face, back)), facecolor=WALL, edgecolor=FAINT, hatch="////",
                    linewidth=0.0, zorder=1,
                ))
                ax.add_patch(bands[-1])
                ax.plot(*face.T, color=INK, linewidth=1.5, zorder=3.5)
        return bands

    def masses(self, ax: Axes) -> list[Polygon]:
        """Dark strips along the paths of rigid masses."""
        strips = []
        for i, body in enumerate(self.system.bodies):
            if isinstance(body, RigidMass):
                left, right = (self._track(i, side, self.cut.bends(i, 0.0))
                               for side in (False, True))
                strips.append(Polygon(
                    np.concatenate((left, right[::-1])), facecolor=MASS, edgecolor=INK,
                    linewidth=0.6, zorder=2.5, label="rigid mass",
                ))
                ax.add_patch(strips[-1])
        return strips

    def drives(self, ax: Axes) -> list[Line2D]:
        """Arrow heads along the paths of driven ends, towards the row."""
        marks = []
        times = np.linspace(*self.span, 2 * ARROWS + 1)[1::2]
        for side, end in enumerate(self.system.ends):
            if isinstance(end, Force | Velocity):
                path = self._track(side * (len(self.system.bodies) - 1), bool(side), times)
                marks += ax.plot(
                    *path.T, linestyle="", marker="<" if side else ">", markersize=5.0, color=INK,
                    markerfacecolor="white", zorder=6, clip_on=False, label=DRIVEN[type(end)],
                )
        return marks


def absorbing_end() -> Line2D:
    """The line of an end through which waves leave, for a legend."""
    return Line2D([], [], color=INK, linewidth=1.6, linestyle=OPEN_END, label="absorbing end")


def _stretches(track: Floats, inside: NDArray[np.bool_]) -> list[Floats]:
    """Unbroken parts of a track; inside[i] says whether track[i] to track[i + 1] belongs to one."""
    turns = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False]))))
    return [track[i : j + 1] for i, j in turns.reshape(-1, 2)]
