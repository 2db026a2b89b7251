"""Cells of the space-time diagram of a smooth solution: averages over time.

The exact mean over each cell's time leaves no false pattern of waves too quick for it.
"""

import numpy as np
from matplotlib import cm, colors
from matplotlib.text import Text

from ..methods.signals import Floats
from ..model.frozen import invalid_argument
from ..results.solution import Solution
from .plane import Plane
from .sampling import middles, pieces, properties, rods_of
from .style import colours

MAX_ROWS = 400  # cells one above the other


class Raster:
    """Averages over cells of a solution, in an interval of time, s.

    Raises
    ------
    ValueError
        If the interval is empty or outside the solution.
    """

    def __init__(self, solution: Solution, start: float, stop: float | None) -> None:
        """Divide the interval into rows of cells: one a tick, `MAX_ROWS` at most."""
        if stop is None:
            stop = solution.t_end
        first_tick, last_tick = solution.fields.to_ticks([start, stop])
        ticks = int(last_tick - first_tick)
        if ticks <= 0:
            raise invalid_argument(
                "stop", f"must be later than start = {start!r} s, got {stop!r}"
            )
        self.solution = solution
        rows = min(MAX_ROWS, ticks)
        self.times = np.linspace(start, stop, rows + 1)
        self.averaged_over = 0.0  # s, what a cell averages; 0 for a tick, the shortest
        if rows < ticks:
            self.averaged_over = float(self.times[1] - self.times[0])
        self._rods = rods_of(solution.system)

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each cell [times, pieces], SI; NaN between rods.

        Displacements, in a frame, are those in the middle; the energy is that of the
        mean motion.
        """
        between = np.full((1, self.times.size - 1), np.nan)
        columns: list[Floats] = []
        for body in self._rods:
            columns += [self._values_in_rod(body, field, frame), between]
        return np.concatenate(columns[:-1]).T

    def _values_in_rod(self, body: int, field: str, frame: float) -> Floats:
        """Values of a field in the cells [pieces, times] of a rod, as in `values`.

        The energy per length is A (rho v^2 + stress strain)/2.
        """
        x = middles(pieces(self.solution, body))
        if field == "displacement":
            t = middles(self.times)
            displacement = self.solution.displacement(body, x[:, None], t)
            return displacement - frame * t
        velocity, strain = self.solution.fields.averaged(body, x, self.times)
        area, modulus, density = properties(self.solution, body, x[:, None])
        stress = modulus * strain
        if field == "velocity":
            return velocity
        if field == "strain":
            return strain
        if field == "stress":
            return stress
        twice_kinetic = density * (velocity - frame) ** 2
        return area * (twice_kinetic + stress * strain) / 2

    def bends(self, body: int, x: float) -> Floats:  # noqa: ARG002  (as in `Polygons`)
        """Times between which paths are drawn straight, the same for all ends."""
        return self.times

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the cells with these numbers, as pixels in vector files too."""
        corners = []
        for body in self._rods:
            edges = pieces(self.solution, body)
            corners.append(plane.path(body, edges, self.times[:, None]))
        points = np.concatenate(corners, axis=1)
        x, y = np.moveaxis(points, -1, 0)
        return plane.ax.pcolormesh(
            x,
            y,
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

    def write(self) -> list[Text]:
        """Cells bear no numbers."""
        return []
