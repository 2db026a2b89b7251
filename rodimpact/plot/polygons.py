"""Coloured regions of a space-time diagram: exact polygons of constant state, with values.

A solution that changes smoothly has flat cells instead.
"""

import math
from typing import Any

import numpy as np
from matplotlib import cm, collections, colors
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats, Ints
from ..model import Rod
from ..model.frozen import refusal
from ..results.regions import readable_until, regions_of
from ..results.solution import Solution
from .plane import Plane
from .sampling import is_stepped, pieces, properties
from .scales import ROUND_OFF, digits
from .style import SMALL, colours, extent, ink_on

SPARSE = 12.0  # least mean distance between the lines of fronts, points
FAINTEST = 0.1  # least darkness of a line, which is the square root of the jump
ALONG = 0.65  # length of a front that bears a word, in heights of its letters for each letter
CLEAR = 2.4  # least distance of a front with a word from the number in its region, in heights
NAMED = 16  # fronts, at most, in a picture that says what they are
REGIONS = 20_000  # more cannot be read
ROWS = 400  # cells one above the other


class Polygons:
    """The regions between the fronts of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution, or has more than 100 000 regions.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        self.system, self.regions = solution.system, regions_of(solution, start, stop)
        starts = self.regions.start
        self._region = np.repeat(
            np.arange(len(self.regions)), np.diff(starts)
        )  # of each corner
        self._body, self._first = self.regions.body[self._region], starts[self._region]
        self._next = np.arange(1, self._body.size + 1)  # corner of the same region
        self._next[starts[1:] - 1] = starts[:-1]

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each region; displacements, in a frame, at its corners; SI."""
        r = self.regions
        if field == "displacement":
            return r.displacement - frame * r.t
        if field == "energy":
            bodies: Any = self.system.bodies
            parts = [
                bodies[i].segments[j]
                for i, j in zip(r.body.tolist(), r.segment.tolist(), strict=True)
            ]
            mass, c = np.array(
                [(float(p.mass / p.length), float(p.wave_speed)) for p in parts]
            ).T
            return np.asarray(
                mass * ((r.velocity - frame) ** 2 + (c * r.strain) ** 2) / 2
            )
        return np.asarray(getattr(r, field))

    def bends(self, body: int, x: float) -> Floats:
        """Times at which the path of a rod's end at x, m, may bend, with first and last."""
        return np.unique(self.regions.t[(self._body == body) & (self.regions.x == x)])

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the regions with these numbers: one each, or one for each corner."""
        r, ax = self.regions, plane.ax
        places = plane.plan.place(self._body, r.x, r.t, r.displacement)
        self._corners = corners = plane.points(places, r.t)
        self._numbers, self._norm, self._plane = numbers, norm, plane
        if numbers.size == len(r):
            drawn = collections.PolyCollection(
                np.split(corners, r.start[1:-1]),
                array=numbers,
                cmap=colours().signed,
                norm=norm,
                zorder=2,
                edgecolors="face",
                linewidths=0.4,
            )
            ax.add_collection(drawn)
            return drawn
        inner = np.flatnonzero(
            (self._next != self._first) & (np.arange(r.x.size) != self._first)
        )
        return ax.tripcolor(
            corners[:, 0],
            corners[:, 1],
            numbers,
            shading="gouraud",
            cmap=colours().signed,
            norm=norm,
            zorder=1.9,
            rasterized=True,
            triangles=np.column_stack((self._first[inner], inner, self._next[inner])),
        )

    def finish(self) -> list[Text]:
        """Once limits are set: lines of fronts, and words and numbers where there is room."""
        ax, r = self._plane.ax, self.regions
        # ends of the sides that two regions share [n, 2], and these regions, the earlier first
        corners = list(
            zip(self._body.tolist(), r.t.tolist(), r.x.tolist(), strict=True)
        )
        known = {(corners[i], corners[j]): i for i, j in enumerate(self._next.tolist())}
        shared = [
            (i, known[b, a]) for (a, b), i in known.items() if a < b and (b, a) in known
        ]
        both = np.array(shared, dtype=np.int64).reshape(-1, 2)
        middle = np.add.reduceat(r.t, r.start[:-1]) / np.diff(r.start)
        earlier = np.argsort(middle[self._region[both]], axis=1, kind="stable")
        owners = np.take_along_axis(self._region[both], earlier, axis=1)
        sides = np.column_stack((both[:, 0], self._next[both[:, 0]]))
        jumps = np.abs(np.diff(r.velocity[owners]))[:, 0]
        steps = np.ptp(r.x[sides], axis=1) == 0  # of area or material
        strength = np.where(
            steps, 1.0, np.sqrt(jumps / (jumps.max(initial=0.0) or 1.0))
        )
        lengths = np.hypot(*np.diff(_points(ax, self._corners[sides]), axis=1)[:, 0].T)
        strongest = np.argsort(-strength, kind="stable")
        crowded = np.cumsum(lengths[strongest]) > math.prod(extent(ax)) / SPARSE
        seen = strength > strength[strongest[crowded]].max(initial=FAINTEST) * (
            1 + ROUND_OFF
        )
        if seen.any():
            ax.add_collection(
                collections.LineCollection(
                    list(self._corners[sides[seen]]),
                    colors=colours().ink,
                    alpha=strength[seen],
                    linewidths=0.5,
                    zorder=2.2,
                    label="fronts",
                )
            )
        if self._numbers.size != len(r):
            return []
        if seen.sum() <= NAMED:
            self._name(ax, sides[seen & ~steps], owners[seen & ~steps])
        return self._labels(ax)

    def _centres(self, corners: Floats) -> Floats:
        """Centre of area of each region, [n, 2]."""
        origin, starts = corners[self._first], self.regions.start[:-1]
        one, other = corners - origin, corners[self._next] - origin
        turn = _cross(one, other)[:, None]
        areas = np.add.reduceat(turn, starts)
        areas[areas == 0] = np.nan  # of a region without area; no number fits there
        away: Floats = np.add.reduceat(turn * (one + other), starts) / (3 * areas)
        return origin[starts] + away

    def _name(self, ax: Axes, sides: Ints, owners: Ints) -> None:
        """Write along each front, on its later side, whether it compresses or stretches the rod."""
        stress, centres = self.regions.stress, _points(ax, self._centres(self._corners))
        for side, (before, after) in zip(self._corners[sides], owners, strict=True):
            word = "compression" if stress[after] < stress[before] else "tension"
            start, stop = _points(ax, side)
            length = math.hypot(*(stop - start))
            clear = (
                abs(_cross(stop - start, centres[after] - start)) / length
            )  # of its number
            if length > ALONG * SMALL * len(word) and clear > CLEAR * SMALL:
                dx, dy = np.diff(side[side[:, 0].argsort()], axis=0)[0]
                x, y = side.mean(axis=0)
                ax.text(
                    x,
                    y,
                    word,
                    rotation=math.degrees(math.atan2(dy, dx)),
                    rotation_mode="anchor",
                    transform_rotates_text=True,
                    ha="center",
                    zorder=6,
                    fontsize=SMALL,
                    va="top" if self._plane.across and dy > 0 else "bottom",
                    color=ink_on(self._norm, self._numbers[after]),
                )

    def _labels(self, ax: Axes) -> list[Text]:
        """Write each number where its region has room for it; boxed, over paths that cross it."""
        low, high = self._norm.inverse(np.array([0.0, 1.0])).tolist()
        reach = (high - low) / 2
        count = 3 + max(0, math.ceil(math.log10(max(-low, high) / reach)))
        texts = [digits(value, reach, count) for value in self._numbers.tolist()]
        # a text fits if half its width and height, and more, lie inside of every side
        half = np.array(
            [(0.35 * SMALL * len(text) + 1.0, 0.6 * SMALL + 1.0) for text in texts]
        )
        centres, corners = self._centres(self._corners), _points(ax, self._corners)
        side = corners[self._next] - corners
        room = np.abs(_cross(side, _points(ax, centres)[self._region] - corners))
        roomy = room > (np.abs(side[:, ::-1]) * half[self._region]).sum(axis=1)
        fits = np.logical_and.reduceat(roomy, self.regions.start[:-1])
        box = (
            {"edgecolor": "none", "pad": 1.0}
            if self._plane.plan.magnification
            else None
        )
        written = []
        for i, (x, y) in zip(
            np.flatnonzero(fits).tolist(), centres[fits].tolist(), strict=True
        ):
            written.append(
                ax.text(
                    x,
                    y,
                    texts[i],
                    ha="center",
                    va="center",
                    zorder=6,
                    fontsize=SMALL,
                    color=ink_on(self._norm, self._numbers[i]),
                    bbox=box
                    and {
                        **box,
                        "facecolor": colours().signed(self._norm(self._numbers[i])),
                    },
                )
            )
        return written


class Raster:
    """Averages over cells of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        stop = solution.t_end if stop is None else stop
        ticks = int(np.diff(solution.fields.to_ticks([start, stop]))[0])
        if ticks <= 0:
            raise refusal(
                "stop", f"must be later than start = {start!r} s, got {stop!r}"
            )
        self.solution = solution
        self.times = np.linspace(start, stop, min(ROWS, ticks) + 1)
        self._rods = [
            i for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)
        ]

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each cell [times, places], SI; nan between rods.

        Displacements, in a frame, are those in the middle; the energy is that of the mean motion.
        """
        between = np.full((1, self.times.size - 1), np.nan)
        t, columns = (self.times[:-1] + self.times[1:]) / 2, list[Floats]()
        for body in self._rods:
            edges = pieces(self.solution, body)
            middle = (edges[:-1] + edges[1:]) / 2
            if field == "displacement":
                moved = self.solution.displacement(body, middle[:, None], t) - frame * t
                columns += [moved, between]
                continue
            # exact means over time: waves too quick for the picture leave no false pattern in it
            velocity, strain = self.solution.fields.averaged(body, middle, self.times)
            area, modulus, density = properties(self.solution, body, middle[:, None])
            stress = modulus * strain
            values: dict[str, Floats] = {
                "velocity": velocity,
                "strain": strain,
                "stress": stress,
                "energy": area
                * (density * (velocity - frame) ** 2 + stress * strain)
                / 2,
            }
            columns += [values[field], between]
        return np.concatenate(columns[:-1]).T

    def bends(self, body: int, x: float) -> Floats:  # noqa: ARG002  (as in `Polygons`)
        """Times between which the path of a rod's end is drawn straight."""
        return self.times

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the cells with these numbers, as pixels in vector files too."""
        corners = np.concatenate(
            [
                plane.path(body, pieces(self.solution, body), self.times[:, None])
                for body in self._rods
            ],
            axis=1,
        )
        return plane.ax.pcolormesh(
            *np.moveaxis(corners, -1, 0),
            np.ma.masked_invalid(numbers),
            cmap=colours().signed,
            norm=norm,
            zorder=2,
            shading="flat",
            rasterized=True,
            antialiased=False,
            edgecolors="none",
            linewidth=0,
        )

    def finish(self) -> list[Text]:
        """Cells bear no numbers."""
        return []


def drawn_until(solution: Solution) -> float:
    """Latest of the times t_end, t_end/2, t_end/4, ..., s, up to which the regions can be read."""
    return solution.t_end if is_stepped(solution) else readable_until(solution, REGIONS)


def _points(ax: Axes, corners: Floats) -> Floats:
    """Corners in printer's points."""
    pixels = ax.transData.transform(corners.reshape(-1, 2)).reshape(corners.shape)
    return np.asarray(pixels * (72.0 / ax.figure.dpi))


def _cross(a: Floats, b: Floats) -> Any:
    """Cross product of vectors [..., 2]."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
