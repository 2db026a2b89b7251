"""atlas(): the plane of two numbers of a case, in regions with one formula each.

The search for the cells and their borders is in `plane_search`. Cells with the same
formula and equal numbers of episodes make a region.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..hints import explain_arguments, explain_missing, listed
from ..model import System
from ..model.arguments import broadcast_arguments
from ..model.frozen import InvalidModel, quantity, raise_if_problems
from ..progress import Progress, ProgressFunction
from ..units import shown
from .border_lines import join_points
from .checks import check_arguments
from .formula import MAX_LISTED, shortened, shown_results
from .plane_cell import Floats, PlaneCell
from .plane_search import PlaneAxis, PlaneSearch, locate
from .rational_functions import RationalFunctions
from .symbolic_row import SymbolicRow

MAX_CELLS = 300
"""Default cap on the cells of an atlas."""
REGION_SAMPLES = 60
"""Points along each axis at which sizes of regions are taken."""
SIGNS = {"velocity": "any", "gap": "non-negative"}
"""Signs that an axis may have.

Other axes are positive: near 0 the number of cells is infinite.
"""


@explain_arguments
def atlas(
    system: System,
    x: Sequence[Any],
    y: Sequence[Any],
    *,
    most_cells: int = MAX_CELLS,
    max_events: int = 1000,
    progress: bool | ProgressFunction = True,
) -> Atlas:
    """Divide the plane of two numbers of a case into regions with a formula each.

    Parameters
    ----------
    system : System
        A system as for `closed_form`.
    x, y : (str, float, float)
        Path of a number, as for `closed_form`, and the ends of its axis.
    most_cells : int
        Cap on the cells, including those in which a collision is not over after
        `max_events`. Points that are not reached by then are left unresolved.
    max_events : int
        Cap on the events of a run; points where it is reached are left unresolved.
    progress : bool or function
        Whether a bar may show how far the search is. A function is called with the
        number of points that are done, and of all points.

    Returns
    -------
    Atlas

    Raises
    ------
    InvalidModel
        If a path names nothing, or several numbers; if an end of an axis is no value of
        its number; if the system has physics that this method lacks.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(1.0, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(2.0, area=1e-4, material=ri.materials.steel)
    >>> plane = atlas(ri.System([left, right]),
    ...               ("bodies.1.length", 0.55, 1.9), ("bodies.1.area", 1.1e-4, 3e-4))
    >>> len(plane.contacts), round(float(plane.restitution(1.25, 2e-4)), 12)
    (2, 0.866666666667)
    """
    check_arguments(progress, most_cells=most_cells, max_events=max_events)
    x_axis = _axis("x", x)
    y_axis = _axis("y", y)
    row = SymbolicRow(system, [x_axis.path, y_axis.path])
    names = [_name(row, "x", x_axis.path), _name(row, "y", y_axis.path)]
    if names[0] == names[1]:
        message = f"must be another number than x, got {shown(y[0])} for both"
        raise InvalidModel([("y", message)])
    with Progress(progress, "atlas", "places") as report:
        search = PlaneSearch(
            row,
            names,
            [x_axis, y_axis],
            max_runs=most_cells,
            max_events=max_events,
            report=report,
        )
        borders = search.run()
    lines = join_points(borders)
    return Atlas(
        system=row.row.system,
        x=x_axis,
        y=y_axis,
        cells=search.cells,
        region=search.regions,
        borders=search.in_plane(borders.points),
        between=borders.regions,
        lines=search.in_plane(lines.ends),
        of_line=lines.points,
        _row=row,
    )


def _axis(name: str, value: Any) -> PlaneAxis:
    """The axis that the user gave as path, low and high; InvalidModel if it is none.

    The ends must be numbers of the sign that the number at the path has, low < high.
    """
    if isinstance(value, list | tuple) and len(value) == 3:
        path, *ends = value
        if isinstance(path, str):
            _, _, last_word = path.rpartition(".")
            number = quantity("", SIGNS.get(last_word, "positive"))
            problems: list[tuple[str, str]] = []
            low = number.checked(problems, f"{name}, {path}", ends[0])
            high = number.checked(problems, f"{name}, {path}", ends[1])
            raise_if_problems(problems)
            if isinstance(low, float) and isinstance(high, float) and low < high:
                return PlaneAxis(path, low, high)
    message = (
        "must be a path, its lowest and its highest value, such as "
        f'("bodies.0.length", 0.1, 1.0), got {shown(value)}'
    )
    raise InvalidModel([(name, message)])


def _name(row: SymbolicRow, axis: str, path: str) -> str:
    """Name in the row, such as l1, of the number that the path of an axis names.

    The path names at least one number of the row. InvalidModel is raised if it names
    several.
    """
    names = []
    paths = []
    for name, path_of_name in row.paths.items():
        if row.symbol_of(path_of_name) == path:
            names.append(name)
            paths.append(path_of_name)
    if len(names) > 1:
        remedy = f"give the path of one: {listed(paths)}"
        raise InvalidModel([(axis, f"{path!r} names {len(names)} numbers; {remedy}")])
    return names[0]


class Region(NamedTuple):
    """A region of an atlas."""

    share: float  # part of the plane that it takes
    place: tuple[float, float]  # a point inside
    formula: str


@explain_missing()
@dataclass(frozen=True, eq=False)
class Atlas:
    """The plane of two numbers of a case, divided into regions with one formula each.

    Attributes
    ----------
    system : System
    x, y : (str, float, float)
        Path, lowest and highest value.
    cells : list of PlaneCell
        Cells overlap only where they have the same formula.
    region : [cell] list of int
        Region of each cell.
    borders : [point, 2] array
        Points where the formula changes, on the edges of a lattice; exact to round-off.
        The collision is solved in fractions where floats do not decide the sign of an
        inequality.
    between : [point, 2] array of int
        Regions on both sides of each border point, -1 for an unresolved side.
    lines : [line, 2, 2] array
        Pieces of the borders, straight from point to point.
    of_line : [line] array of int
        Index of a point of `borders` on each line.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> plane = ri.atlas(ri.System([left, right]),
    ...                  ("bodies.0.length", 0.3, 0.9), ("bodies.1.length", 1.0, 2.0))
    >>> len(plane.cells), round(float(plane.restitution(0.6, 1.5)), 12)
    (1, 0.4)
    """

    system: System
    x: tuple[str, float, float]
    y: tuple[str, float, float]
    cells: list[PlaneCell]
    region: list[int]
    borders: Floats
    between: NDArray[np.int64]
    lines: Floats
    of_line: NDArray[np.int64]
    _row: SymbolicRow

    def __repr__(self) -> str:
        return f"<Atlas over {self.x[0]}, {self.y[0]}: {self._region_count} regions>"

    def __str__(self) -> str:
        """Title, the largest regions with share and formula, and the names' paths.

        At most `MAX_LISTED` regions are listed. Without SymPy the text is the title and
        the reason.
        """
        title = f"{self._region_count} regions over {self.x[0]} and {self.y[0]}"
        try:
            largest = self.largest(MAX_LISTED)
        except ImportError as error:
            return f"{title}; {error}"
        lines = [title]
        for region in largest:
            lines.append(f"{region.share:6.1%}  {region.formula}")
        if self._region_count > len(largest):
            lines.append("...")
        if largest:
            legend = []
            for name, path in self._row.paths.items():
                legend.append(f"{name} = {self._row.symbol_of(path)}")
            lines.append("where " + ", ".join(legend))
        return "\n".join(lines)

    @property
    def _region_count(self) -> int:
        """Number of regions."""
        return len(set(self.region))

    def largest(self, most: int) -> list[Region]:
        """The largest regions, with their formulas; needs sympy.

        The size of a region is its share of points that fill the plane evenly.
        Unresolved points belong to no region.

        Parameters
        ----------
        most : int
            Largest number of regions.

        Returns
        -------
        list of Region
            The largest first.

        Raises
        ------
        InvalidModel
            If `most` is no positive whole number.
        """
        check_arguments(most=most)
        algebra = RationalFunctions(self._row)
        x, y = self._sample_points()
        region_of_cell = np.append(self.region, -1)  # index -1 gives region -1
        regions = region_of_cell[self.locate(x, y)]  # the region of each point
        sampled, counts = np.unique(regions[regions >= 0], return_counts=True)
        largest_first = np.argsort(-counts, kind="stable")
        largest = []
        for region in sampled[largest_first][:most].tolist():
            inside = np.flatnonzero(regions == region)
            i = _most_central(x, y, inside)
            formula = self._formula_of(region, algebra)
            point = (float(x[i]), float(y[i]))
            largest.append(Region(len(inside) / len(x), point, shortened(formula)))
        return largest

    def _sample_points(self) -> tuple[Floats, Floats]:
        """Coordinates x and y of points that fill the plane evenly, [point] each.

        They are the middles of `REGION_SAMPLES` equal steps along each axis.
        """
        _, x_low, x_high = self.x
        _, y_low, y_high = self.y
        # Of points at half steps, every second one is the middle of a step.
        x = np.linspace(x_low, x_high, 2 * REGION_SAMPLES + 1)[1::2]
        y = np.linspace(y_low, y_high, 2 * REGION_SAMPLES + 1)[1::2]
        x_mesh, y_mesh = np.meshgrid(x, y)
        return x_mesh.ravel(), y_mesh.ravel()

    def _formula_of(self, region: int, algebra: RationalFunctions) -> str:
        """The formula of a region as a text, such as "e = l1/l2".

        Without a formula of e these are the velocities after, separated by commas.
        """
        cell = self.cells[self.region.index(region)]  # the first cell of the region
        results = dict(shown_results(cell.results))
        functions = algebra.functions_of(results.values())
        equations = []
        for name, function in zip(results, functions, strict=True):
            equations.append(f"{name} = {algebra.expression(function)}")
        return ", ".join(equations)

    def locate(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.int64]:
        """Index of the cell in which each point lies, -1 for unresolved points."""
        # The two empty texts allow any unit and any sign.
        xs, ys = broadcast_arguments(x=(x, "", ""), y=(y, "", ""))
        return locate(self.cells, xs, ys)

    def restitution(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """e at points, by the formula of their cell; nan without a cell or formula.

        `x` and `y` are broadcast against each other.
        """
        # The two empty texts allow any unit and any sign.
        xs, ys = broadcast_arguments(x=(x, "", ""), y=(y, "", ""))
        cell_of_point = self.locate(xs, ys)
        e = np.full(xs.shape, np.nan)
        for i, cell in enumerate(self.cells):
            inside = cell_of_point == i
            e[inside] = cell.restitution(xs[inside], ys[inside])
        return e

    @cached_property
    def contacts(self) -> list[tuple[int, ...]]:
        """Number of episodes of each contact, a tuple for each region, in their order.

        They are those of the region's first cell.
        """
        episodes = []
        for region in sorted(set(self.region)):
            cell = self.cells[self.region.index(region)]
            episodes.append(tuple(map(len, cell.results.contact_times)))
        return episodes


def _most_central(x: Floats, y: Floats, inside: NDArray[np.int64]) -> int:
    """Index of the point inside a region that is nearest to the mean of its points.

    Offsets are divided by the size of the plane along each axis.
    """
    x_offset = (x[inside] - x[inside].mean()) / np.ptp(x)
    y_offset = (y[inside] - y[inside].mean()) / np.ptp(y)
    nearest = np.argmin(x_offset**2 + y_offset**2)
    return int(inside[nearest])
