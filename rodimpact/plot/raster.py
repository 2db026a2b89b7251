"""Cells of the space-time diagram of a smooth solution: averages over time.

Samples at single times would show false patterns of waves that are quicker than a cell;
exact averages over the time of each cell do not.
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
        """Divide the interval into rows of cells: one for each tick, or `MAX_ROWS`.

        `stop` is by default the end of the solution. InvalidModel is raised unless it
        is at least a tick later than `start`.
        """
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
        self.averaged_over = 0.0  # duration of a cell, s; 0 if it is a single tick
        if rows < ticks:
            self.averaged_over = float(self.times[1] - self.times[0])
        self._rods = rods_of(solution.system)

    def values(self, field: str, frame: float) -> Floats:
        """Values of a field in each cell [times, pieces of all rods], SI.

        A column of NaN is between two rods. Velocity, strain and stress are averages
        over the time of the cell; the energy is computed from averages; displacements
        are those in the middle of the cell. Displacements and energies are seen from a
        frame that moves at `frame`, m/s.
        """
        between_rods = np.full((1, self.times.size - 1), np.nan)
        columns: list[Floats] = []
        for body in self._rods:
            columns += [self._values_in_rod(body, field, frame), between_rods]
        return np.concatenate(columns[:-1]).T  # nothing after the last rod

    def _values_in_rod(self, body: int, field: str, frame: float) -> Floats:
        """Values of a field in the cells [pieces, times] of a rod, as in `values`.

        Displacements are those in the middle of a cell; all other fields are averages
        over its time. Only displacements and energies are seen from the frame. The
        energy per length is A (rho v^2 + stress strain)/2, with v in the frame. Any
        field but displacement, velocity, strain and stress is taken for the energy.
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
        """Times, s, between which paths are drawn straight: those between the rows.

        They are the same for all ends.
        """
        return self.times

    def draw(
        self, plane: Plane, numbers: Floats, norm: colors.Normalize
    ) -> cm.ScalarMappable:
        """Draw the cells, coloured by `numbers` [times, pieces], and return the mesh.

        Their corners lie on the paths of the edges of pieces. They are pixels also in
        SVG and PDF files.
        """
        corners = []  # of the cells of each rod [time, edge, 2]
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
        """Write nothing, as cells bear no numbers; return []."""
        return []
