"""Search for the cells of a plane, and for the points where its formulas change.

Points are given as shares of the axes, from 0 to 1. Wherever a point lies in no cell
yet, the collision is solved there in fractions; its cell reaches as far as the
conditions hold. Points at random and the nodes of a lattice find the cells. On an edge
of the lattice between two cells, the border is where the conditions of either cell end.
If there is room between these two ends, the edge is cut there, as another cell lies
between.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..progress import ProgressReport
from .checks import FormulaTooLong, check_final
from .plane_cell import Floats, PlaneCell
from .symbolic_row import SymbolicRow

Indices = NDArray[np.int64]

LATTICE = 32
"""Steps of the lattice along each axis."""
POINT_STEPS = 1 << 12
"""Steps along each axis to which points are rounded, so that fractions are short."""
RANDOM_POINTS = 2 * LATTICE**2
EDGES = 2 * LATTICE * (LATTICE + 1)
ALL_POINTS = RANDOM_POINTS + LATTICE**2 + EDGES
"""Approximate number of points of a search: random ones, nodes, and one an edge."""
SEED = 1867
BORDER_TOLERANCE = 1e-11
"""Two cells whose ends on an edge are nearer, as a share of the edge, touch there."""
MAX_EDGE_CUTS = 12
"""Largest number of times that an edge is cut in two."""
UNRESOLVED = -1
"""Cell of a point whose collision is not over, or was not run due to a cap."""
UNDECIDED = -2
"""Cell of a point so near a border that floats do not decide a condition's sign."""


class PlaneAxis(NamedTuple):
    """A number of the system that varies along an axis."""

    path: str
    low: float
    high: float


class BorderPoints(NamedTuple):
    """Points on edges of the lattice where the formula changes."""

    points: Floats  # [point, 2], shares of the axes
    regions: Indices  # [point, 2], regions on both sides, -1 if unresolved
    edges: Indices  # [point], edge of the lattice; those along x come first


class Edges(NamedTuple):
    """Edges of the lattice, or parts of them."""

    start: Floats  # [edge, 2], shares of the axes
    end: Floats  # [edge, 2]
    cells: Indices  # [edge, 2], cells at start and end
    lattice_edge: Indices  # [edge], the edge of the lattice of which it is a part

    def select(self, mask: Any) -> Edges:
        """Edges for which a mask is true."""
        return Edges(*(values[mask] for values in self))

    def points_at(self, share: Any) -> Floats:
        """Points at shares of the way from start to end."""
        points: Floats = self.start + (self.end - self.start) * share[:, None]
        return points

    def cut(self, points: Floats, cells: Indices) -> Edges:
        """Both parts of each edge, one after the other, cut at a point in a cell.

        Parameters
        ----------
        points : [edge, 2] array
            Where each edge is cut.
        cells : [edge] array of int
            Cells of these points.
        """
        # [edge, part, 2] each; then parts become edges of their own
        starts = np.stack([self.start, points], axis=1)
        ends = np.stack([points, self.end], axis=1)
        cells_of_first_parts = np.column_stack([self.cells[:, 0], cells])
        cells_of_second_parts = np.column_stack([cells, self.cells[:, 1]])
        cells_of_parts = np.stack([cells_of_first_parts, cells_of_second_parts], axis=1)
        return Edges(
            starts.reshape(-1, 2),
            ends.reshape(-1, 2),
            cells_of_parts.reshape(-1, 2),
            np.repeat(self.lattice_edge, 2),
        )


class PlaneSearch:
    """Search for the cells of a plane.

    Parameters
    ----------
    row : SymbolicRow
    names : sequence of str
        Names of the numbers along x and y.
    axes : sequence of PlaneAxis
    max_runs : int
        Cap on the runs that begin a cell.
    max_events : int
        Cap on the events of a run.
    report : function
        Receives the number of points that are done, and of all.

    Attributes
    ----------
    cells : list of PlaneCell
    regions : [cell] list of int
        Region of each cell: cells of one formula and equal episodes are one region.
    """

    def __init__(
        self,
        row: SymbolicRow,
        names: Sequence[str],
        axes: Sequence[PlaneAxis],
        *,
        max_runs: int,
        max_events: int,
        report: ProgressReport,
    ) -> None:
        """Store the arguments and the ends of the axes; there is no cell yet."""
        self.cells: list[PlaneCell] = []
        self.regions: list[int] = []
        self._region_of: dict[tuple[Any, ...], int] = {}  # region of each signature
        self._row = row
        self._names = names
        self._axes = axes
        _, low, high = zip(*axes, strict=True)
        self._low = np.array(low)
        self._high = np.array(high)
        self._max_runs = max_runs
        self._max_events = max_events
        self._report = report
        self._points_done = 0
        self._runs = 0

    def run(self) -> BorderPoints:
        """Find the cells, then the points on the lattice where formulas change."""
        rng = np.random.default_rng(SEED)
        self._cells_at(_rounded(rng.random((RANDOM_POINTS, 2))))
        return self._find_borders(self._lattice_edges())

    def in_plane(self, shares: Floats) -> Floats:
        """Points of the plane, from shares of the axes."""
        points: Floats = self._low + (self._high - self._low) * shares
        return points

    # Cells

    def _cells_at(self, shares: Floats) -> Indices:
        """Index of the cell of each point; the collision is solved where none is known.

        New cells are added to `cells`. A point is UNRESOLVED if its collision is not
        over at the cap on events or the cap on runs is reached, and UNDECIDED if floats
        do not find it inside its own cell.
        """
        points = self.in_plane(shares)
        all_x, all_y = points.T
        cells = locate(self.cells, all_x, all_y)
        for i in range(len(points)):
            if cells[i] != UNRESOLVED or self._runs >= self._max_runs:
                continue
            self._report(min(self._points_done + i, ALL_POINTS), ALL_POINTS)
            self._runs += 1
            cell = self._solve(shares[i])
            if cell is None:
                continue
            unresolved = np.flatnonzero(cells == UNRESOLVED)
            x, y = points[unresolved].T
            inside = unresolved[cell.inside(x, y)]
            if i in inside:
                cells[inside] = len(self.cells)
                self._add(cell)
            else:  # its own cell does not contain the point, in floats
                cells[i] = UNDECIDED
        self._points_done = min(self._points_done + len(points), ALL_POINTS)
        return cells

    def _add(self, cell: PlaneCell) -> None:
        """Add a cell, and the number of its region.

        Cells of equal signatures share a region; a new signature gets the next number.
        """
        next_region = len(self._region_of)
        region = self._region_of.setdefault(cell.signature(), next_region)
        self.cells.append(cell)
        self.regions.append(region)

    def _solve(self, shares: Floats) -> PlaneCell | None:
        """The cell of a point, by a run on fractions, not added to `cells`.

        `shares` are the point's two shares of the axes. The result is None if the
        collision is not over at the cap on events, or the formula is too long.
        """
        changed = {}
        for name, share, axis in zip(self._names, shares, self._axes, strict=True):
            low = Fraction(axis.low)
            high = Fraction(axis.high)
            changed[name] = low + Fraction(float(share)) * (high - low)
        values = self._row.values(changed)
        try:
            run = self._row.run(values, self._max_events)
            check_final(run.is_final, self._max_events)  # raises FormulaTooLong, too
            return PlaneCell(self._row, run, values, self._names)
        except FormulaTooLong:
            return None

    # Borders

    def _lattice_edges(self) -> Edges:
        """Edges of the lattice, first those along x, with the cells of their nodes.

        The collision is solved at each node whose cell is not known.
        """
        shares = np.arange(LATTICE + 1) / LATTICE
        mesh = np.stack(np.meshgrid(shares, shares, indexing="ij"), axis=-1)
        nodes = _rounded(mesh.reshape(-1, 2))
        # maximum() turns UNDECIDED, which is -2, into UNRESOLVED, which is -1.
        cells = np.maximum(self._cells_at(nodes), UNRESOLVED)
        # node_at[i, j] is the node in step i along x and j along y; an edge along x
        # ends one step further in i, an edge along y in j.
        node_at = np.arange(len(nodes)).reshape(LATTICE + 1, LATTICE + 1)
        starts = np.concatenate([node_at[:-1].ravel(), node_at[:, :-1].ravel()])
        ends = np.concatenate([node_at[1:].ravel(), node_at[:, 1:].ravel()])
        return Edges(
            nodes[starts],
            nodes[ends],
            np.column_stack([cells[starts], cells[ends]]),
            np.arange(len(starts)),
        )

    def _find_borders(self, edges: Edges) -> BorderPoints:
        """Points on edges where the formula changes, with the regions on both sides.

        An edge with a third cell between those of its ends is cut there, and each part
        is looked at again. Parts that are left after `MAX_EDGE_CUTS` rounds have no
        border point.
        """
        pieces: list[BorderPoints] = []
        for _ in range(MAX_EDGE_CUTS):
            regions = self._regions_at(edges)
            is_change = regions[:, 0] != regions[:, 1]
            edges = edges.select(is_change)
            regions = regions[is_change]
            # As shares of an edge: the cell of its start ends at `left`, the cell of
            # its end begins at `right`.
            left = self._share_inside(edges.start, edges.end, edges.cells[:, 0])
            right = 1 - self._share_inside(edges.end, edges.start, edges.cells[:, 1])
            points = edges.points_at((left + right) / 2)
            touch = right - left < BORDER_TOLERANCE
            apart = ~touch

            # Find the cell between two cells that are apart. An edge is about 1/LATTICE
            # of the axis long, so `room` is a share of the axis.
            room = (right - left) / LATTICE
            cut_points = points.copy()
            cut_points[apart] = _rounded(points[apart], room[apart, None])
            cells = np.full(len(points), UNDECIDED)  # stays where two cells touch
            cells[apart] = self._cells_at(cut_points[apart])

            # The border is where two cells touch, or where floats cannot decide.
            borders = [*np.flatnonzero(touch)]
            is_resolved = (edges.cells >= 0).all(axis=1)
            undecided = np.flatnonzero(apart & (cells == UNDECIDED) & is_resolved)
            for count, i in enumerate(undecided, 1):
                point = self._bisect(
                    edges.start[i],
                    edges.end[i],
                    (left[i], right[i]),
                    regions[i].tolist(),
                )
                if point is not None:
                    points[i] = point
                    borders.append(i)
                # The search ends with these points, about.
                points_done = ALL_POINTS - len(undecided) + count
                self._report(max(self._points_done, points_done), ALL_POINTS)
            pieces.append(
                BorderPoints(
                    points[borders], regions[borders], edges.lattice_edge[borders]
                )
            )
            is_third_cell = (cells[:, None] != edges.cells).all(axis=1)
            to_cut = is_third_cell & (cells != UNDECIDED)
            edges = edges.select(to_cut).cut(cut_points[to_cut], cells[to_cut])
        # The pieces field by field
        all_points, all_regions, lattice_edges = zip(*pieces, strict=True)
        return BorderPoints(
            np.concatenate(all_points),
            np.concatenate(all_regions),
            np.concatenate(lattice_edges),
        )

    def _regions_at(self, edges: Edges) -> Indices:
        """Regions at start and end of edges, [edge, 2]; -1 for unresolved points."""
        region_of_cell = np.append(self.regions, -1)  # index -1 gives region -1
        regions: Indices = region_of_cell[edges.cells]
        return regions

    def _share_inside(self, start: Floats, end: Floats, cells: Indices) -> Floats:
        """Share of each way from start to end that lies in the cell of the start.

        `cells` has the cell of each start. The share is 0 for UNRESOLVED ones.
        """
        shares = np.zeros(len(start))
        for c in set(cells.tolist()) - {UNRESOLVED}:
            of_cell = np.flatnonzero(cells == c)
            x, y = self.in_plane(start[of_cell]).T
            x_end, y_end = self.in_plane(end[of_cell]).T
            shares[of_cell] = self.cells[c].share_inside(x, y, x_end - x, y_end - y)
        return shares

    def _bisect(
        self,
        start: Floats,
        end: Floats,
        interval: tuple[float, float],
        regions: list[int],
    ) -> Floats | None:
        """Border between two regions on an edge, by solving in fractions.

        This finds a border at which the conditions have no certain sign in floats.

        Parameters
        ----------
        start, end : [2] arrays
        interval : (float, float)
            Shares of the edge between which the border lies.
        regions : [int, int]
            Regions at start and end.

        Returns
        -------
        [2] array or None
            None if there is a third region in between, or a collision is too long.
        """
        low, high = interval
        while high - low > BORDER_TOLERANCE:
            middle = (low + high) / 2
            cell = self._solve(start + (end - start) * middle)
            if cell is None:
                return None
            region = self._region_of.get(cell.signature())
            if region == regions[0]:
                low = middle
            elif region == regions[1]:
                high = middle
            else:
                return None
        point: Floats = start + (end - start) * (low + high) / 2
        return point


def locate(cells: Sequence[PlaneCell], x: Floats, y: Floats) -> Indices:
    """Index of the first cell in which each point lies; UNRESOLVED if there is none.

    The points are (x, y), arrays of one shape, which the result has too.
    """
    indices = np.full(x.shape, UNRESOLVED)
    for i, cell in enumerate(cells):
        remaining = indices == UNRESOLVED
        if remaining.any():
            is_inside = cell.inside(x[remaining], y[remaining])
            indices[remaining] = np.where(is_inside, i, UNRESOLVED)
    return indices


def _rounded(shares: Floats, room: Any = 1.0) -> Floats:
    """Points near the given ones, whose shares of the axes are short fractions.

    Shares of y are an eighth of a step larger than those of x. Otherwise points with
    equal numbers on both axes, such as velocities of both bodies, would lie on a
    border.

    Parameters
    ----------
    shares : [point, 2] array
    room : float or [point, 1] array
        Change of a share that is allowed, about `POINT_STEPS` steps.
    """
    # The number of steps in an axis is a power of two. A share becomes the middle of
    # its step, (k + 1/2)/steps; 1 becomes the middle of the last step.
    steps = POINT_STEPS * 2.0 ** np.ceil(np.log2(1 / room))
    rounded: Floats = (2 * np.floor(steps * shares) + 1) / (2 * steps)
    rounded = np.minimum(rounded, 1 - 1 / (2 * steps))
    rounded += np.array([0.0, 1 / 8]) / steps
    return rounded
