"""Flat cells in space and time, for a solution that changes a little in every time step."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.text import Text

from ..contacts import ContactHistory
from ..model import Rod
from ..signals import Floats
from ..solution import Solution
from .placing import Placing
from .sampling import averaged, pieces
from .scales import ROUND_OFF, Scale
from .style import DIVERGING

ROWS = 400  # cells one above the other


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
            raise ValueError(f"stop: must be later than start = {start!r} s, got {stop!r}")
        self.solution = solution
        self.times = np.linspace(start, stop, min(ROWS, ticks) + 1)
        self._rods = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)]

    def values(self, field: str) -> Floats:
        """Velocity, strain or stress of each cell [times, places], SI; nan between rods."""
        columns = []
        for body in self._rods:
            velocity, strain = averaged(self.solution, body, self.times)
            if field == "velocity":
                columns.append(velocity)
            elif field == "strain":
                columns.append(strain)
            else:
                edges, _ = pieces(self.solution, body)
                rod = self.solution.system.bodies[body]
                assert isinstance(rod, Rod)
                ends = self.solution.fields.edges(body)[1:-1]
                which = np.searchsorted(ends, (edges[:-1] + edges[1:]) / 2)
                modulus = [float(s.material.youngs_modulus) for s in rod.segments]
                columns.append(strain * np.array(modulus)[which, None])
            columns.append(np.full((1, self.times.size - 1), np.nan))
        return np.concatenate(columns[:-1]).T

    def bends(self, body: int, x: float) -> Floats:  # noqa: ARG002  (as in `Polygons`)
        """Times between which the path of a rod's end is drawn straight."""
        return self.times

    def cuts(self, history: ContactHistory) -> Floats:
        """Times between which a contact presses, touches or is open."""
        turns = np.array([t for episode in history.episodes[:ROWS] for t in episode])
        return np.union1d(self.times, turns[np.isfinite(turns)])

    def pressing(self, history: ContactHistory, times: Floats) -> tuple[Floats, Floats]:
        """Mean force between times, and the wider gap of their two; round-off is 0."""
        force = np.diff(history.impulse_until(times)) / np.diff(times)
        gap = np.abs(history.gap(times))
        wider = np.maximum(gap[:-1], gap[1:])
        least = ROUND_OFF * history.peak_force
        return np.where(force > least, force, 0.0), np.where(
            wider > ROUND_OFF * gap.max(), wider, 0.0)

    def draw(
        self, ax: Axes, plan: Placing, numbers: Floats, norm: Normalize, time: Scale, place: Scale
    ) -> QuadMesh:
        """Draw the cells with these numbers, as pixels in vector files too."""
        places = []
        for body in self._rods:
            edges, _ = pieces(self.solution, body)
            x, t = np.broadcast_arrays(edges, self.times[:, None])
            moved = self.solution.displacement(body, x, t)
            places.append(plan.place(body, x, t, moved) * place.factor)
        x = np.concatenate(places, axis=1)
        y = np.broadcast_to(self.times[:, None] * time.factor, x.shape)
        return ax.pcolormesh(
            x, y, np.ma.masked_invalid(numbers), cmap=DIVERGING, norm=norm, zorder=2,
            shading="flat", rasterized=True, antialiased=False, edgecolors="none", linewidth=0,
        )

    def finish(self) -> list[Text]:
        """Cells bear no numbers."""
        return []
