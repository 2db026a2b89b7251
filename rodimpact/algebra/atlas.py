"""atlas(): the plane of two numbers of a case, in cells with a formula each.

Wherever a place lies in no cell yet, the collision is solved there on fractions; its cell is what
the inequalities say, however far it reaches. Between two places of different cells the border is
where an inequality of either ends; if there is room between the two ends, another cell is there,
and is solved. Cells with the same formula and the same contacts make a region.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model import System
from ..model.frozen import InvalidModel, listed, quantity, raise_noted
from ..progress import Progress, ProgressFunction, Report
from ..units import shown
from .cell import Cell, Floats
from .exact import check_arguments
from .field import Field
from .formula import FEW, named, short
from .naming import Naming

LATTICE = 32  # places a side where cells are looked for
FINE = 1 << 12  # steps a side to which these are rounded, so that fractions are short
PLACES = 3 * LATTICE**2 + 2 * LATTICE * (
    LATTICE + 1
)  # at random, of the lattice; its edges
CLOSE = 1e-11  # of the way between two places: as good as touching
MOST_BETWEEN = 12  # times that an edge is cut where there is room for another cell
MOST_CELLS = 300
SAMPLES = 60  # places a side at which the sizes of regions are taken
NOWHERE = -2  # the cell of a place in which floats do not see the place
SIGNS = {
    "velocity": "any",
    "gap": "non-negative",
}  # of the ends of axes, where they may be 0


class Region(NamedTuple):
    """A region of an atlas: its share of the plane, a place inside, and what holds there."""

    share: float
    place: tuple[float, float]
    formula: str


@dataclass(frozen=True, eq=False)
class Atlas:
    """The plane of two numbers of a case, divided into regions with one formula each.

    Attributes
    ----------
    system : System
    x, y : (str, float, float)
        Path, lowest and highest value.
    cells : list of Cell
        They overlap only where they have the same formula.
    region : [cell] list of int
    borders : [point, 2] array
        Places where the formula changes, on the lines of a lattice; exact to round-off. Where
        floats cannot tell the sign of an inequality, fractions are used.
    between : [point, 2] array of int
        The regions there, -1 for what is unresolved.
    lines : [line, 2, 2] array
        Pieces of the borders, straight from place to place.
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
    cells: list[Cell]
    region: list[int]
    borders: Floats
    between: NDArray[np.int64]
    lines: Floats
    of_line: NDArray[np.int64]
    _naming: Naming

    def __repr__(self) -> str:
        return f"<Atlas over {self.x[0]}, {self.y[0]}: {len(set(self.region))} regions>"

    def __str__(self) -> str:
        lines = [f"{len(set(self.region))} regions over {self.x[0]} and {self.y[0]}"]
        try:
            found = self.largest(FEW)
        except ImportError as error:
            return f"{lines[0]}; {error}"
        lines += [f"{region.share:6.1%}  {region.formula}" for region in found]
        if len(set(self.region)) > len(found):
            lines.append("...")
        if found:
            naming = self._naming
            lines.append(
                "where "
                + ", ".join(
                    f"{name} = {naming.symbol_of(path)}"
                    for name, path in naming.paths.items()
                )
            )
        return "\n".join(lines)

    def largest(self, most: int) -> list[Region]:
        """The largest regions, with their formulas; needs sympy.

        Parameters
        ----------
        most : int
            How many at most.
        """
        formulas = Field(self._naming)
        ends = [
            np.linspace(low, high, 2 * SAMPLES + 1)[1::2]
            for _, low, high in (self.x, self.y)
        ]
        x, y = (side.ravel() for side in np.meshgrid(*ends))
        regions = np.append(self.region, -1)[self.locate(x, y)]
        names, counts = np.unique(regions[regions >= 0], return_counts=True)
        found = []
        for r in names[np.argsort(-counts, kind="stable")][:most]:
            here = np.flatnonzero(regions == r)
            off = [(v[here] - v[here].mean()) / np.ptp(v) for v in (x, y)]
            middle = here[np.argmin(off[0] ** 2 + off[1] ** 2)]
            results = dict(named(self.cells[self.region.index(int(r))].results))
            formula = ", ".join(
                f"{name} = {formulas.quotient(f)}"
                for name, f in zip(results, formulas.of(results.values()), strict=True)
            )
            place = float(x[middle]), float(y[middle])
            found.append(Region(len(here) / len(x), place, short(formula)))
        return found

    def locate(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.int64]:
        """Index of the cell in which places lie, -1 for what is unresolved."""
        return _locate(self.cells, *np.array(np.broadcast_arrays(x, y), dtype=float))

    def restitution(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """e by the formula of the cell in which places lie; nan where there is none."""
        xs, ys = np.array(np.broadcast_arrays(x, y), dtype=float)
        found, e = self.locate(xs, ys), np.full(xs.shape, np.nan)
        for i, cell in enumerate(self.cells):
            here = found == i
            e[here] = cell.restitution(xs[here], ys[here])
        return e

    @cached_property
    def contacts(self) -> list[tuple[int, ...]]:
        """How often each contact presses, by region."""
        first = map(self.region.index, sorted(set(self.region)))
        return [tuple(map(len, self.cells[i].results.contact_times)) for i in first]


def atlas(
    system: System,
    x: Sequence[Any],
    y: Sequence[Any],
    *,
    most_cells: int = MOST_CELLS,
    max_events: int = 1000,
    progress: bool | ProgressFunction = True,
) -> Atlas:
    """Divide the plane of two numbers of a case into regions with a formula each.

    Parameters
    ----------
    system : System
        As for `closed_form`.
    x, y : (str, float, float)
        Path of a number, as for `closed_form`, and the ends of its axis.
    most_cells : int
        Cap on the cells, those included in which a run does not come to its end; what is not
        reached by then is left unresolved.
    max_events : int
        Cap on the events of a run; places where it is reached are left unresolved.
    progress : bool or function
        Whether a bar may show how far the search is. A function is called with the places that are
        done, and how many there are.

    Raises
    ------
    InvalidModel
        If a path names nothing, or several numbers; if an end of an axis is no value of its number;
        if something acts of which this method knows nothing.

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
    axes = [_axis("x", x), _axis("y", y)]
    naming = Naming(system, [path for path, *_ in axes])
    names = [
        _name(naming, axis, path) for axis, (path, *_) in zip("xy", axes, strict=True)
    ]
    if names[0] == names[1]:
        raise InvalidModel(
            [("y", f"must be another number than x, got {shown(y[0])} for both")]
        )
    with Progress(progress, "atlas", "places") as report:
        return _Search(naming, names, axes, most_cells, max_events, report).atlas()


def _axis(name: str, given: Any) -> tuple[str, float, float]:
    """Path of a number and the ends of its axis; InvalidModel for anything else."""
    if (
        isinstance(given, list | tuple)
        and len(given) == 3
        and isinstance(given[0], str)
    ):
        path, problems = given[0], list[tuple[str, str]]()
        # near 0 there are cells without end
        field = quantity("", SIGNS.get(path.rpartition(".")[2], "positive"))
        low, high = (
            field.checked(problems, f"{name}, {path}", end) for end in given[1:]
        )
        raise_noted(problems)
        if isinstance(low, float) and isinstance(high, float) and low < high:
            return path, low, high
    message = (
        'must be a path, its lowest and its highest value, such as ("bodies.0.length"'
    )
    raise InvalidModel([(name, f"{message}, 0.1, 1.0), got {shown(given)}")])


def _name(naming: Naming, axis: str, path: str) -> str:
    """Name of the one number that a path stands for."""
    paths = {p: name for name, p in naming.paths.items() if naming.symbol_of(p) == path}
    if len(paths) > 1:
        remedy = f"give the path of one: {listed(list(paths))}"
        raise InvalidModel([(axis, f"{path!r} names {len(paths)} numbers; {remedy}")])
    return paths.popitem()[1]


def _locate(cells: list[Cell], x: Floats, y: Floats) -> NDArray[np.int64]:
    found = np.full(x.shape, -1)
    for i, cell in enumerate(cells):
        open_ = found < 0
        if open_.any():
            found[open_] = np.where(cell.inside(x[open_], y[open_]), i, -1)
    return found


def _rounded(places: Floats, room: Any = 1.0) -> Floats:
    """Shares of the axes, within a little of the room that is there, as short fractions.

    Those of y lie an eighth of a step off those of x: else places of two axes that are alike, such
    as velocities of both bodies, would lie on the border itself.
    """
    fine = FINE * 2.0 ** np.ceil(np.log2(1 / room))
    shares: Floats = np.minimum(
        (2 * np.floor(fine * places) + 1) / (2 * fine), 1 - 1 / (2 * fine)
    )
    shares += np.array([0.0, 1 / 8]) / fine
    return shares


@dataclass
class _Search:
    """Finds the cells of a plane; places are shares of the axes."""

    naming: Naming
    names: list[str]
    axes: list[Any]
    most: int
    max_events: int
    report: Report
    done: int = 0  # places and edges
    runs: int = 0  # that began a cell, also one that is not told
    cells: list[Cell] = field(default_factory=list)
    region: list[int] = field(default_factory=list)
    _formulas: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def atlas(self) -> Atlas:
        rng = np.random.default_rng(1867)
        self._fill(_rounded(rng.random((2 * LATTICE * LATTICE, 2))))
        grid = np.arange(LATTICE + 1) / LATTICE
        nodes = _rounded(
            np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
        )
        owner = np.maximum(self._fill(nodes), -1).reshape(LATTICE + 1, LATTICE + 1)
        at = np.arange(owner.size).reshape(owner.shape)
        edges = np.concatenate(
            [
                np.stack([at[:-1], at[1:]], axis=-1).reshape(-1, 2),
                np.stack([at[:, :-1], at[:, 1:]], axis=-1).reshape(-1, 2),
            ]
        )
        places, between, of = self._cross(nodes[edges], owner.ravel()[edges])
        lines, of_line = self._join(places, between, of)
        x, y = self.axes
        return Atlas(
            self.naming.row.system,
            x,
            y,
            self.cells,
            self.region,
            self._plane(places),
            between,
            self._plane(lines),
            of_line,
            self.naming,
        )

    def _plane(self, places: Floats) -> Any:
        low, high = (np.array([axis[i] for axis in self.axes]) for i in (1, 2))
        return low + (high - low) * places

    def _fill(self, places: Floats) -> NDArray[np.int64]:
        """Cells of places, solved where they are in none yet; -1 or `NOWHERE` where this fails."""
        plane = self._plane(places)
        found = _locate(self.cells, *plane.T)
        for i in range(len(places)):
            if found[i] == -1 and self.runs < self.most:
                self.report(min(self.done + i, PLACES), PLACES)
                self.runs += 1
                cell = self._solved(places[i])
                if cell:
                    open_ = np.flatnonzero(found == -1)
                    inside = open_[cell.inside(*plane[open_].T)]
                    found[i] = NOWHERE  # unless floats tell the cell
                    if i in inside:
                        found[inside] = len(self.cells)
                        self.cells.append(cell)
                        self.region.append(
                            self._formulas.setdefault(
                                cell.mark(times=False), len(self._formulas)
                            )
                        )
        self.done = min(self.done + len(places), PLACES)
        return found

    def _solved(self, place: Floats) -> Cell | None:
        """The cell of a place; None if its collision does not come to an end."""
        values = self.naming.values(
            {
                name: Fraction(low)
                + Fraction(float(at)) * (Fraction(high) - Fraction(low))
                for name, at, (_, low, high) in zip(
                    self.names, place, self.axes, strict=True
                )
            }
        )
        run = self.naming.run(values, self.max_events)
        return Cell(self.naming, run, values, names=self.names) if run.final else None

    def _narrowed(
        self, P: Floats, Q: Floats, low: float, high: float, regions: list[int]
    ) -> Floats | None:
        """Where one region turns into another and floats do not tell, by solving in between."""
        while high - low > CLOSE:
            middle = (low + high) / 2
            cell = self._solved(P + (Q - P) * middle)
            region = self._formulas.get(cell.mark(times=False)) if cell else None
            if region not in regions:
                return None
            low, high = (middle, high) if region == regions[0] else (low, middle)
        found: Floats = P + (Q - P) * (low + high) / 2
        return found

    def _cross(self, ends: Floats, cells: Any) -> tuple[Floats, Any, Any]:
        """Where the formula changes along edges: places, regions on both sides, and the edge."""
        of, halves, found = np.arange(len(ends)), [[0, 1], [1, 2]], []
        for _ in range(MOST_BETWEEN):
            regions = np.append(self.region, -1)[cells]
            differ = regions[:, 0] != regions[:, 1]
            ends, cells, regions, of = (
                part[differ] for part in (ends, cells, regions, of)
            )
            P, Q = ends[:, 0], ends[:, 1]
            left, right = self._end(P, Q, cells[:, 0]), 1 - self._end(Q, P, cells[:, 1])
            middle = P + (Q - P) * ((left + right) / 2)[:, None]
            close = right - left < CLOSE
            places = _rounded(middle[~close], ((right - left) / LATTICE)[~close, None])
            there = np.full(len(of), NOWHERE)
            there[~close] = self._fill(places)
            hard = np.flatnonzero(
                ~close & (there == NOWHERE) & (cells >= 0).all(axis=1)
            )
            told = [*np.flatnonzero(close)]
            for k, i in enumerate(hard, 1):
                border = self._narrowed(
                    P[i], Q[i], left[i], right[i], regions[i].tolist()
                )
                if border is not None:
                    middle[i] = border
                    told.append(i)
                self.report(max(self.done, PLACES - len(hard) + k), PLACES)
            found.append((middle[told], regions[told], of[told]))
            middle[~close] = places
            between = (there != NOWHERE) & (there[:, None] != cells).all(axis=1)
            ends = np.stack([P, middle, Q], axis=1)[between][:, halves].reshape(
                -1, 2, 2
            )
            cells = np.column_stack([cells[:, 0], there, cells[:, 1]])[between][
                :, halves
            ]
            cells, of = cells.reshape(-1, 2), np.repeat(of[between], 2)
        places, sides, edges = map(np.concatenate, zip(*found, strict=True))
        return places, sides, edges

    def _end(self, P: Floats, Q: Floats, cells: Any) -> Floats:
        """Share of the way from P to Q at which cells end."""
        ends = np.zeros(len(P))
        for c in set(cells.tolist()) - {-1}:
            here = np.flatnonzero(cells == c)
            first, last = self._plane(P[here]), self._plane(Q[here])
            ends[here] = self.cells[c].end(*first.T, *(last - first).T)
        return ends

    def _join(
        self, places: Floats, between: Any, of: Any
    ) -> tuple[Floats, NDArray[np.int64]]:
        """Straight lines between the places on the edges of each mesh, and a place of each."""
        n, up = LATTICE, LATTICE * (LATTICE + 1)
        on: dict[int, list[int]] = {}  # places by edge
        for p, e in enumerate(of.tolist()):
            on.setdefault(e, []).append(p)
        drawn: list[tuple[int, Any]] = []  # a place, and where a line goes from there
        for i, j in np.ndindex(n, n):
            sides = (
                i * (n + 1) + j,
                i * (n + 1) + j + 1,
                up + i * n + j,
                up + (i + 1) * n + j,
            )
            points = [p for e in sides for p in on.get(e, ())]
            alike: dict[Any, list[int]] = {}
            for p in points:
                alike.setdefault(frozenset(between[p].tolist()), []).append(p)
            pairs = [pair for pair in alike.values() if len(pair) == 2]
            points = [p for p in points if not any(p in pair for pair in pairs)]
            if len(points) == 2:
                pairs.append(points)
            drawn += [(p, places[q]) for p, q in pairs]
            if len(points) > 2:
                centre = places[points].mean(axis=0)
                for axis in (
                    0,
                    1,
                ):  # borders along the axes meet where edges across say
                    across = [p for p in points if (of[p] >= up) == bool(axis)]
                    if across:
                        centre[axis] = places[across, axis].mean()
                drawn += [(p, centre) for p in points]
        lines = np.array([(places[p], end) for p, end in drawn]).reshape(-1, 2, 2)
        return lines, np.array([p for p, _ in drawn], dtype=int)
