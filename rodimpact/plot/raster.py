"""Flat cells in space and time, for a solution that changes smoothly."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.text import Text

from ..methods.signals import Floats
from ..model import Rod
from ..model.frozen import refusal
from ..results.solution import Solution
from .placing import Placing
from .plane import Plane
from .sampling import averaged, mean_areas, pieces
from .style import colours

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
            raise refusal("stop", f"must be later than start = {start!r} s, got {stop!r}")
        self.solution = solution
        self.times = np.linspace(start, stop, min(ROWS, ticks) + 1)
        self._rods = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, Rod)]

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each cell [times, places], SI; nan between rods.

        Displacements, in a frame, are those in the middle; the energy is that of the mean motion.
        """
        between = np.full((1, self.times.size - 1), np.nan)
        columns = [part for i in self._rods for part in (self._of_rod(i, field, frame), between)]
        return np.concatenate(columns[:-1]).T

    def _of_rod(self, body: int, field: str, frame: float) -> Floats:
        """Values [places, times] in a rod."""
        edges, segment = pieces(self.solution, body)
        if field == "displacement":
            middle, t = (edges[:-1] + edges[1:]) / 2, (self.times[:-1] + self.times[1:]) / 2
            x, t = np.broadcast_arrays(middle[:, None], t)
            return self.solution.displacement(body, x, t) - frame * t
        velocity, strain = averaged(self.solution, body, self.times)
        if field in ("velocity", "strain"):
            return velocity if field == "velocity" else strain
        rod, which = self.solution.system.bodies[body], segment - segment[0]
        assert isinstance(rod, Rod)
        materials = [rod.segments[i].material for i in which.tolist()]
        stress = strain * np.array([[float(m.youngs_modulus)] for m in materials])
        if field == "stress":
            return np.asarray(stress)
        density = np.array([[float(m.density)] for m in materials])
        area = mean_areas(rod, edges, which)[:, None]
        return np.asarray(area * (density * (velocity - frame) ** 2 + stress * strain) / 2)

    def bends(self, body: int, x: float) -> Floats:  # noqa: ARG002  (as in `Polygons`)
        """Times between which the path of a rod's end is drawn straight."""
        return self.times

    def draw(
        self, ax: Axes, plan: Placing, plane: Plane, numbers: Floats, norm: Normalize
    ) -> QuadMesh:
        """Draw the cells with these numbers, as pixels in vector files too."""
        places = []
        for body in self._rods:
            edges, _ = pieces(self.solution, body)
            x, t = np.broadcast_arrays(edges, self.times[:, None])
            places.append(plan.place(body, x, t, self.solution.displacement(body, x, t)))
        across = np.concatenate(places, axis=1)
        when = np.broadcast_to(self.times[:, None], across.shape)
        return ax.pcolormesh(
            *np.moveaxis(plane.points(across, when), -1, 0), np.ma.masked_invalid(numbers),
            cmap=colours().signed, norm=norm, zorder=2, shading="flat", rasterized=True,
            antialiased=False, edgecolors="none", linewidth=0)

    def finish(self, ax: Axes) -> list[Text]:  # noqa: ARG002  (as in `Polygons`)
        """Cells bear no numbers."""
        return []
