"""What bounds the rods in a space-time diagram, ends, contacts, masses and walls; and gauges."""

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
from matplotlib import collections, patches, patheffects
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from ..methods.signals import Floats
from ..model import Absorbing, Joint, Moved, Pushed, Rigid, RigidMass, Rod
from ..results.gauges import Gauge
from .plane import Plane
from .polygons import Polygons, Raster
from .sampling import evenly, is_stepped
from .scales import ROUND_OFF
from .style import SMALL, colours

Cut: TypeAlias = Polygons | Raster
WALL = 0.04  # depth of a wall, in lengths of the row
DRIVEN: dict[type, str] = {Pushed: "driven by a force", Moved: "driven at a velocity"}
ARROWS = 8  # marks of a driven end
POINTS = 1000  # of a path that is drawn point by point, at most
CENTRES = 101  # points of the path of a centre of mass


class Borders:
    """Draws what bounds the rods."""

    def __init__(self, plane: Plane, cut: Cut) -> None:
        self.ax, self.plan, self.cut, self.plane = plane.ax, plane.plan, cut, plane
        self.colours, self.system = colours(), self.plan.solution.system
        self.times = np.linspace(*plane.span, POINTS)

    def _track(self, body: int, right: bool, times: Floats) -> Floats:
        """Path of an end of a body, straight between `times`."""
        return self.plane.points(self.plan.end(body, right, times), times)

    def _strip(self, left: Floats, right: Floats, **style: Any) -> patches.Polygon:
        """Fill what lies between two paths."""
        strip = patches.Polygon(np.concatenate((left, right[::-1])), **style)
        self.ax.add_patch(strip)
        return strip

    def _lines(self, paths: list[Floats], **style: Any) -> collections.LineCollection:
        lines = collections.LineCollection(
            paths, **{"colors": self.colours.ink, **style}
        )
        self.ax.add_collection(lines)
        return lines

    def ends(self) -> collections.LineCollection:
        """Paths of the ends of all rods; dashed where waves leave for good."""
        last, edges = len(self.system.bodies) - 1, self.plan.solution.fields.edges
        outer = dict(zip([(0, False), (last, True)], self.system.ends, strict=True))
        ends = [
            (i, right)
            for i, body in enumerate(self.system.bodies)
            if isinstance(body, Rod)
            for right in (False, True)
        ]
        drawn = [
            mark("open") if isinstance(outer.get(end), Absorbing) else mark("end")
            for end in ends
        ]
        return self._lines(
            [
                self._track(i, right, self.cut.bends(i, edges(i)[-right]))
                for i, right in ends
            ],
            zorder=3,
            **{key: [each[key] for each in drawn] for key in mark("end")},
        )

    def contacts(self) -> list[collections.LineCollection]:
        """Where bodies press, where they touch without force, and where a gap has no width."""
        paths: tuple[list[Floats], ...] = [], [], []
        stepped = is_stepped(self.plan.solution)
        for history in self.plan.solution.contacts:
            if history.law.opens:
                turns = self.times if stepped else history.breakpoints()[0]
                told = [
                    t
                    for episode in history.episodes[:POINTS]
                    for t in episode
                    if t == t
                ]
                times = self._within([*turns, *told])
                force = np.diff(history.impulse_until(times)) / np.diff(times)
                gap = np.abs(history.gap(times))
                closed = np.maximum(gap[:-1], gap[1:]) <= ROUND_OFF * gap.max()
                presses = force > ROUND_OFF * history.peak_force
                touches = closed & ~presses & isinstance(history.law, Rigid)
                apart = ~presses & ~touches & (self.plan.magnification == 0)
                left, right = (
                    self.plan.end(history.index + i, not i, times) for i in (0, 1)
                )
                track = self.plane.points((left + right) / 2, times)
                for each, inside in zip(paths, (presses, touches, apart), strict=True):
                    each += _stretches(track, inside)
        casing = [patheffects.withStroke(linewidth=4.5, foreground=self.colours.paper)]
        looks: dict[str, Any] = {
            "pressing": {"linewidths": 3.0, "zorder": 5, "path_effects": casing},
            "touching": {"linewidths": 1.2, "zorder": 4},
            "apart": {"zorder": 4, **mark("apart")},
        }
        return [
            self._lines(track, label=label, capstyle="butt", **look)
            for track, (label, look) in zip(paths, looks.items(), strict=True)
        ]

    def _within(self, times: ArrayLike) -> Floats:
        """The times in the picture, with its first and its last."""
        return np.unique(np.clip(np.append(times, self.plane.span), *self.plane.span))

    def springs(self) -> list[patches.Polygon]:
        """Where the springs of compliant contacts are pressed."""
        bands = []
        for history, *faces in self.plan.springs(self.times):
            if history.law.opens:
                ends = np.stack(
                    [self.plane.points(x, self.times) for x in faces], axis=1
                )
                bands += [
                    self._strip(
                        band[:, 0],
                        band[:, 1],
                        zorder=1.5,
                        label="spring, pressed",
                        facecolor=self.colours.wall,
                    )
                    for band in _stretches(ends, history.gap(self.times)[:-1] < 0)
                ]
        return bands

    def walls(self) -> list[patches.Polygon]:
        """Hatched bands beyond the faces of walls and fixed ends."""
        depth, times, bands = WALL * self.plan.row, np.array(self.plane.span), []
        for i, right in self.plan.walls():
            places = self.plan.end(i, right, times)
            face = self.plane.points(places, times)
            back = self.plane.points(places + (depth if right else -depth), times)
            bands.append(self._strip(face, back, zorder=1, **mark("wall")))
            self.ax.plot(*face.T, color=self.colours.ink, linewidth=1.5, zorder=3.5)
        return bands

    def masses(self) -> list[patches.Polygon]:
        """Dark strips along the paths of rigid masses."""
        return [
            self._strip(
                *(
                    self._track(i, right, self.cut.bends(i, 0.0))
                    for right in (False, True)
                ),
                zorder=2.5,
                label="rigid mass",
                **mark("mass"),
            )
            for i, body in enumerate(self.system.bodies)
            if isinstance(body, RigidMass)
        ]

    def joints(self) -> list[patches.Polygon]:
        """Hatched strips between the faces that joints hold together."""
        style = {
            "facecolor": self.colours.paper,
            "edgecolor": self.colours.ink,
            "hatch": "xxxxx",
            "linewidth": 3.0,
            "linestyle": (0, (0.5, 0.5)),
            "zorder": 2.5,
            "label": "joint",
        }
        return [
            self._strip(
                self._track(i, True, self.times),
                self._track(i + 1, False, self.times),
                **style,
            )
            for i, law in enumerate(self.system.contacts)
            if isinstance(law, Joint)
        ]

    def centres(self) -> list[Line2D]:
        """Dashed paths of the centres of mass of rods that move in the picture."""
        times = np.linspace(*self.plane.span, CENTRES)
        casing = [
            patheffects.withStroke(
                linewidth=2.2, foreground=self.colours.paper, alpha=0.6
            )
        ]
        return [
            line
            for i, body in enumerate(self.system.bodies)
            if isinstance(body, Rod) and self.plan.magnification
            for line in self.ax.plot(
                *self.plane.points(self.plan.centre(i, times), times).T,
                linestyle=(0, (5, 4)),
                color=self.colours.ink,
                linewidth=0.9,
                zorder=4.5,
                path_effects=casing,
                label="centre of mass",
            )
        ]

    def gauges(self, records: Mapping[str, Gauge]) -> list[Line2D]:
        """Paths of strain gauges, each with its name."""
        casing = [patheffects.withStroke(linewidth=2.4, foreground=self.colours.paper)]
        turn: Any = (
            {"rotation": 0, "ha": "left", "xytext": (3, 2)}
            if self.plane.across
            else {"rotation": 90, "ha": "right", "xytext": (-2, 3)}
        )
        paths = []
        for name, record in records.items():
            times = self._within(record.times[evenly(record.times.size, POINTS)])
            track = self.plane.path(record.body, record.x, times)
            paths += self.ax.plot(
                *track.T,
                color=self.colours.ink,
                linewidth=1.0,
                linestyle="-.",
                zorder=5,
                path_effects=casing,
                label=name,
            )
            self.ax.annotate(
                name,
                track[0],
                textcoords="offset points",
                va="bottom",
                zorder=6,
                fontsize=SMALL + 1,
                color=self.colours.ink,
                path_effects=casing,
                parse_math=False,
                **turn,
            )
        return paths

    def drives(self) -> list[Line2D]:
        """Arrow heads along the paths of driven ends, towards the row."""
        times = np.linspace(*self.plane.span, 2 * ARROWS + 1)[1::2]
        heads = "^v" if self.plane.across else "><"
        return [
            arrow
            for side, end in enumerate(self.system.ends)
            if type(end) in DRIVEN
            for arrow in self.ax.plot(
                *self._track(side * (len(self.system.bodies) - 1), bool(side), times).T,
                marker=heads[side],
                markersize=5.0,
                zorder=6,
                clip_on=False,
                label=DRIVEN[type(end)],
                **mark("drive"),
            )
        ]


def mark(
    kind: Literal["wall", "mass", "drive", "apart", "open", "end"],
) -> dict[str, Any]:
    """Style of walls and fixed ends, rigid masses, driven ends, gaps without width, and ends.

    Waves leave through an open end for good.
    """
    paper, ink, faint, wall, mass, *_ = colours()
    styles: dict[str, dict[str, Any]] = {
        "wall": {
            "facecolor": wall,
            "edgecolor": faint,
            "hatch": "////",
            "linewidth": 0.0,
        },
        "mass": {"facecolor": mass, "edgecolor": ink, "linewidth": 0.6},
        "drive": {"linestyle": "", "color": ink, "markerfacecolor": paper},
        "apart": {
            "color": paper,
            "linewidth": 2.4,
            "path_effects": [patheffects.withStroke(linewidth=3.6, foreground=ink)],
        },
        "open": {"color": ink, "linewidth": 1.6, "linestyle": (0, (3, 2))},
        "end": {"color": ink, "linewidth": 0.8, "linestyle": "-"},
    }
    return styles[kind]


def _stretches(track: Floats, inside: NDArray[np.bool_]) -> list[Floats]:
    """Unbroken parts of a track; inside[i] says whether track[i] to track[i + 1] belongs to one."""
    turns = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False]))))
    return [track[i : j + 1] for i, j in turns.reshape(-1, 2)]
