"""closed_form(): a collision in symbols, and the cell in which the formula holds.

The collision is run on traced fractions at a point very near the numbers of the system,
in a direction in which no two different times or velocities agree by chance. Its
history, evaluated in symbols, is the formula. A system may lie on the border of a cell,
as it often does with commensurate transit times. Then the cells on all sides are found,
and those with the same formula are united.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing, nearest
from ..model import System
from ..model.arguments import check_text
from ..model.frozen import InvalidModel
from ..progress import ProgressFunction
from .checks import FormulaTooLong, check_arguments, check_final, fractions_of
from .exact_results import Exact, map_numbers
from .formula_cell import FormulaCell
from .rational_functions import RationalFunctions
from .symbolic_row import SymbolicRow

OFFSET = Fraction(1, 1 << 120)
"""Distance of runs from the numbers of the system, relative to the numbers."""
DIRECTION_DENOMINATOR = 1 << 24
"""Denominator of the components of directions, so that fractions are short."""
DIRECTIONS = 512
"""Number of directions in which cells are looked for."""
SEED = 1867
MAX_CELLS = 64
"""Largest number of cells around the numbers of the system."""
MAX_LISTED = 4
"""Other formulas, and borders, that a printed formula lists at most."""
NEAREST_CONDITIONS = 3
"""Conditions that are printed beside a formula."""
MAX_LINE_LENGTH = 160
"""Characters of a condition, and of another formula, at most."""
CONDITIONS_TOO_LONG = (
    "where conditions hold that are too long to print: fewer symbols make them "
    "shorter, and .holds() in Python tells for numbers"
)
"""Line in place of the conditions of a formula if `FormulaTooLong` says so."""
MAX_DENOMINATOR = 10**6
"""A value with a larger denominator is printed as a float."""


@explain_arguments
def closed_form(
    system: System,
    symbols: Sequence[str] = ("transit_time", "impedance"),
    *,
    max_events: int = 1000,
    progress: bool | ProgressFunction = True,
) -> ClosedForm:
    """Solve a collision in symbols.

    A system may lie on the border of several cells. Then the formula belongs to the
    cell that is reached if the chosen numbers grow, each by a larger share than the one
    before it; the last grows twice as fast as the first. The formulas of the other
    cells are the `sides`.

    Parameters
    ----------
    system : System
        Uniform or stepped rods, free or against walls, in rigid or bonded contact; no
        family.
    symbols : sequence of str
        Which numbers have names; the others keep their values. Paths of the case, such
        as ``bodies.0.length``, or the last words of such paths, which name all of
        these: ``transit_time`` T, ``impedance`` Z, ``length`` l, ``area`` A,
        ``youngs_modulus`` E, ``density`` rho, ``velocity`` v, ``gap`` g. They are
        counted from left to right: segments, materials, bodies (v) and contacts (g).
    max_events : int
        Cap on the events of a run.
    progress : bool or function
        Whether a bar may show that the work goes on, here and later when conditions are
        computed or printed. A function is called with the number of steps that are
        done, and None, since the number of all steps is not known.

    Returns
    -------
    ClosedForm

    Raises
    ------
    InvalidModel
        If a symbol names nothing, or the system has physics that this method lacks; if
        the collision is not over after `max_events`; if the formula is too long.
    ImportError
        Without SymPy, which the extra ``sympy`` brings.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> print(closed_form(ri.System([left, right]), ["length"]))
    e = l1/l2
    where l1 < l2
    """
    if isinstance(symbols, str):
        symbols = [symbols]
    check_arguments(progress, max_events=max_events)
    algebra = RationalFunctions(SymbolicRow(system, symbols), progress)
    with algebra.work():  # shows the progress
        around = cells_around(algebra, max_events)
        cells_by_formula: dict[Any, list[FormulaCell]] = {}
        for cell in around.cells:
            cells_by_formula.setdefault(cell.signature(), []).append(cell)
        # The cell found first is that of the first direction, in which numbers grow.
        first_cells, *groups = cells_by_formula.values()
        _ = first_cells[0].functions  # a formula that is too long is refused here
    sides = []
    for cells in groups:
        sides.append(_form(algebra, cells, around, sides=()))
    return _form(algebra, first_cells, around, sides=tuple(sides))


class CellsAround(NamedTuple):
    """Cells that meet at the numbers of a system, that of the first direction first."""

    cells: list[FormulaCell]
    is_incomplete: bool  # a collision did not end below the cap, or more cells exist


def cells_around(algebra: RationalFunctions, max_events: int) -> CellsAround:
    """Cells of formulas that meet at the numbers of the system.

    The collision is run near these numbers in each direction that no cell contains yet,
    until all directions are contained or there are `MAX_CELLS` cells. The first cell is
    that in which all numbers grow.

    Raises
    ------
    FormulaTooLong
        If the collision in the first direction is not over after `max_events`, or its
        fractions are too long.
    """
    row = algebra.row
    directions = _directions(len(row.free_names))
    is_untried = np.ones(DIRECTIONS, dtype=bool)
    cells: list[FormulaCell] = []
    is_incomplete = False
    while is_untried.any() and len(cells) < MAX_CELLS:
        i = int(np.flatnonzero(is_untried)[0])
        is_untried[i] = False
        values = _values_near(algebra, directions[i])
        try:
            run = row.run(values, max_events)
            check_final(run.is_final, max_events)
            cell = FormulaCell(algebra, run, values)
        except FormulaTooLong:
            if not cells:
                raise
            is_incomplete = True
            continue
        cells.append(cell)
        # A direction lies in the cell if it leads to the inner side of all ties. With
        # an empty list of ties `reshape` makes 0 rows.
        normals = np.reshape(cell.tie_normals, (-1, len(row.free_names)))
        is_inside = (directions @ normals.T > 0).all(axis=1)
        is_untried &= ~is_inside
    if is_untried.any():
        is_incomplete = True
    return CellsAround(cells, is_incomplete)


def _directions(dimensions: int) -> Any:
    """Directions from the numbers of the system, [direction, free name].

    In the first one numbers grow, no two of them alike; the others are random.
    """
    rng = np.random.default_rng(SEED)
    directions = rng.uniform(-1, 1, (DIRECTIONS, dimensions))
    # A small random part keeps the components of the first one out of simple ratios.
    directions[0] = np.linspace(1, 2, dimensions) + directions[0] / 1000
    # Rounded to short fractions, so that runs on fractions stay short.
    return np.round(directions * DIRECTION_DENOMINATOR) / DIRECTION_DENOMINATOR


def _values_near(algebra: RationalFunctions, direction: Any) -> dict[str, Fraction]:
    """Values of all names near those of the system, at `OFFSET` in a direction.

    A number x with the component d of the direction becomes x + x OFFSET d, or OFFSET d
    if x is 0.
    """
    values = dict(algebra.base_values)
    for name, component in zip(algebra.row.free_names, direction, strict=True):
        scale = values[name]
        if scale == 0:
            scale = Fraction(1)
        values[name] += scale * OFFSET * Fraction(component)
    return values


def _form(
    algebra: RationalFunctions,
    cells: list[FormulaCell],
    around: CellsAround,
    sides: tuple[ClosedForm, ...],
) -> ClosedForm:
    """The formula of `cells`, which are some of the cells around the system.

    The other cells around it become the `_others` of the formula.
    """
    other_cells = [cell for cell in around.cells if cell not in cells]
    return ClosedForm(
        algebra, tuple(cells), tuple(other_cells), sides, around.is_incomplete
    )


class Ties(NamedTuple):
    """Borders on which the numbers of the system lie."""

    inner: set[Any]  # polynomials of borders between cells of the same formula
    outer: set[Any]  # polynomials of borders to cells of other formulas


@explain_missing()
@dataclass(frozen=True, eq=False)
class ClosedForm:
    """A collision in symbols, and the region in which the formulas hold.

    Attributes
    ----------
    sides : tuple of ClosedForm
        Formulas of the other cells, if the numbers of the system lie on a border
        between them.
    unsolved : bool
        Whether there are more sides: cells in which the collision is not over after
        `max_events`, or cells beyond the cap.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> form = ri.closed_form(ri.System([left, right]), ["length"])
    >>> print(form)
    e = l1/l2
    where l1 < l2
    """

    _algebra: RationalFunctions
    _cells: tuple[FormulaCell, ...]  # cells of this formula around the system
    _others: tuple[FormulaCell, ...]  # cells of the other formulas there
    sides: tuple[ClosedForm, ...]
    unsolved: bool

    @property
    def symbols(self) -> dict[str, str]:
        """Path of the number of each symbol; of several numbers the first."""
        return dict(self._algebra.row.paths)

    @property
    def values(self) -> dict[str, Fraction]:
        """Values of the symbols in the system.

        They are rounded to 400 bits where a wave speed is irrational.
        """
        return dict(self._algebra.row.base)

    # The formula

    @property
    def restitution(self) -> Any:
        """e; None where not exactly one contact can open, or nothing collides."""
        return self._results.restitution

    @property
    def velocities_after(self) -> tuple[Any, ...]:
        """Velocity of the centre of mass of each body, m/s."""
        return self._results.velocities_after

    @property
    def impulses(self) -> tuple[Any, ...]:
        """Impulse of each contact, N s; that of a bond is the average."""
        return self._results.impulses

    @property
    def contact_times(self) -> tuple[tuple[tuple[Any, Any], ...], ...]:
        """Start and end of the force of each contact, for each of its episodes, s."""
        return self._results.contact_times

    @cached_property
    def _results(self) -> Exact:
        """The results as SymPy's expressions."""
        return map_numbers(self._cells[0].functions, self._algebra.expression)

    def at(self, **values: Any) -> Exact:
        """Evaluate the formula in fractions; None for numbers that are 0/0 there.

        A formula may have a limit there, which is not computed.

        Parameters
        ----------
        **values : Fraction, int, float or str
            Values of symbols; the others keep their values of the system. A float is
            taken as it is written: 0.1 is one tenth.
        """
        point = self._point(values)
        algebra = self._algebra

        def value(f: Any) -> Fraction | None:
            """Value of a rational function; None if its denominator is 0."""
            denominator = algebra.value(f.denom, point)
            if denominator == 0:
                return None
            return algebra.value(f.numer, point) / denominator

        return map_numbers(self._cells[0].functions, value)

    # Where it holds

    @cached_property
    def cell(self) -> tuple[Any, ...]:
        """Inequalities between the symbols; the formula holds where all are true."""
        return tuple(map(self._algebra.inequality, self._borders))

    @cached_property
    def nearest(self) -> tuple[Any, ...]:
        """Three of the inequalities in `cell`: those whose borders are nearest.

        They are in the order of `cell`. Distance is the relative change of the numbers
        of the system up to the border.
        """
        distances = [self._algebra.distance(border) for border in self._borders]
        nearest_first = np.argsort(distances, kind="stable")
        in_order_of_cell = sorted(nearest_first[:NEAREST_CONDITIONS])
        return tuple(self.cell[i] for i in in_order_of_cell)

    def where(self, remedy: str) -> str:
        """A line "where ..." with the nearest conditions, and how many more there are.

        It is "where always" without conditions. If they are too long to compute, the
        line says so, and what to do.

        Parameters
        ----------
        remedy : str
            How to see all conditions, such as "--conditions shows all".
        """
        check_text("remedy", remedy, ".cell has all")
        line = "where always"
        try:
            nearest_conditions = self.nearest
        except FormulaTooLong:
            return CONDITIONS_TOO_LONG
        if nearest_conditions:
            line = "where " + ", ".join(map(shortened, nearest_conditions))
        more = len(self.cell) - len(nearest_conditions)
        if more:
            line += f", and {more} more; {remedy}"
        return line

    def holds(self, **values: Any) -> bool:
        """Whether the formula holds at values of the symbols, given as in `at`.

        The formula consists of one or more cells. It holds also on a border between two
        of them, but not on a border to another formula, nor if a number other than a
        velocity is 0 or negative.
        """
        point = self._point(values)
        for name, value in point.items():
            if value <= 0 and not name.startswith("v"):
                return False
        if any(cell.contains(point) for cell in self._cells):
            return True
        # A point on an inner border, between two cells of this formula, is inside no
        # cell. It belongs to the formula unless it lies in a cell of another formula or
        # on the border of such a cell.
        inner = self._ties.inner
        if not any(cell.contains(point, open_borders=inner) for cell in self._cells):
            return False
        for other in self._others:
            if other.contains(point, open_borders=other.borders):
                return False
        return True

    @cached_property
    def _borders(self) -> list[Any]:
        """Borders of all cells of the formula together, or those of the first cell.

        The cells are united if each tie has a normal and every cell of another formula
        lies across an outer tie. Inner ties are then no borders. Those that others
        imply are left out.
        """
        cells = self._cells
        ties = self._ties
        # A tie p > 0 of one cell is a tie -p > 0 of the cell on its other side.
        can_unite = True
        for cell in cells:
            if len(cell.tie_normals) != len(cell.ties):
                can_unite = False
        for other in self._others:
            if not any(-p in ties.outer for p in other.ties):
                can_unite = False
        borders = cells[0].borders
        if can_unite:
            all_borders: set[Any] = set()
            for cell in cells:
                all_borders |= set(cell.borders)
            other_borders = all_borders - ties.inner - ties.outer
            borders = [*other_borders, *ties.outer]
        return self._algebra.without_implied(borders)

    @cached_property
    def _ties(self) -> Ties:
        """Borders p = 0 of this formula's cells on which the numbers of the system lie.

        Such a border is inner if another of these cells has the border -p, else outer.
        """
        ties: set[Any] = set()
        for cell in self._cells:
            ties |= set(cell.ties)
        inner = {p for p in ties if -p in ties}
        return Ties(inner, ties - inner)

    def _point(self, values: Mapping[str, Any]) -> dict[str, Fraction]:
        """Values of all names: the given ones, the others from the system.

        InvalidModel is raised for a name that is no symbol.
        """
        for name in values:
            if name not in self.symbols:
                message = f"is no symbol here; {nearest(name, self.symbols)}"
                raise InvalidModel([(name, message)])
        return self._algebra.row.values(fractions_of(values))

    # Display

    def __str__(self) -> str:
        """The formula, where it holds, and the formulas that it meets here.

        Of stepped rods the symbols come first: which segment has which number.
        """
        lines = []
        if any(".segments." in path for path in self.symbols.values()):
            lines += self._lines_of_symbols()
        for name, value in shown_results(self._results):
            lines.append(f"{name} = {value}")
        lines.append(self.where(".cell has all"))
        if self.sides:
            lines += self._lines_of_sides()
        if self.unsolved:
            lines.append(
                "There are more cells, left out by max_events or by the cap on cells."
            )
        return "\n".join(lines)

    def _lines_of_symbols(self) -> list[str]:
        """Lines that say for which number each symbol stands."""
        return [f"{name}: {path}" for name, path in self.symbols.items()]

    def _lines_of_sides(self) -> list[str]:
        """Lines that say where other formulas meet this one, and which they are.

        At most `MAX_LISTED` formulas are listed; e at the system is given if it exists,
        as a decimal number if its denominator is `MAX_DENOMINATOR` or larger.
        """
        equations = []
        for inequality in self._separating_inequalities[:MAX_LISTED]:
            equations.append(shortened(f"{inequality.lhs} = {inequality.rhs}"))
        border = ", ".join(equations)
        neighbours = "another formula"
        if len(self.sides) > 1:
            neighbours = f"{len(self.sides)} other formulas"
        e = self.at().restitution
        value_here = ""
        if e is not None:
            if e.denominator >= MAX_DENOMINATOR:
                e = float(e)
            value_here = f" (e = {e})"
        lines = [f"It meets {neighbours} where {border}, as here{value_here}:"]
        for side in self.sides[:MAX_LISTED]:
            lines.append(side._line())
        if len(self.sides) > MAX_LISTED:
            lines.append("... see the others in .sides")
        return lines

    def _line(self) -> str:
        """The formula, and the inequalities that divide it from its neighbours.

        It is one line. A sentence replaces a formula that is too long.
        """
        formula = "a formula that is too long to print"
        try:
            equations = []
            for name, value in shown_results(self._results):
                equations.append(f"{name} = {value}")
            formula = ", ".join(equations)
        except FormulaTooLong:
            pass
        inequalities = self._separating_inequalities[:MAX_LISTED]
        where = ", ".join(map(shortened, inequalities))
        return f"{shortened(formula)} where {where}"

    @property
    def _separating_inequalities(self) -> list[Any]:
        """Inequalities p > 0 that divide the first cell from cells of other formulas.

        They are its ties p, if a cell of another formula has the tie -p.
        """
        ties_of_others: set[Any] = set()
        for other in self._others:
            ties_of_others |= set(other.ties)
        inequalities = []
        for p in self._cells[0].ties:
            if -p in ties_of_others:
                inequalities.append(self._algebra.inequality(p))
        return inequalities

    def _repr_latex_(self) -> str:
        """The formula and its nearest conditions in LaTeX, for a notebook.

        The number of further conditions follows. A sentence replaces conditions that
        are too long to compute.
        """
        latex = self._algebra.sympy.latex
        equations = []
        for name, value in shown_results(self._results):
            equations.append(f"{name} &= {latex(value)}")
        formula = "\\\\".join(equations)
        aligned = f"\\begin{{aligned}}{formula}\\end{{aligned}}"
        try:
            nearest_conditions = self.nearest
        except FormulaTooLong:
            return f"$${aligned}$$ {CONDITIONS_TOO_LONG}"
        conditions = ",\\ ".join(map(latex, nearest_conditions))
        more = len(self.cell) - NEAREST_CONDITIONS
        if more > 0:
            conditions += f"\\ \\text{{and {more} more}}"
        return f"$${aligned}\\qquad {conditions}$$"


def shown_results(results: Exact) -> list[tuple[str, Any]]:
    """Name and value of printed results: e, or the velocities where there is no e."""
    if results.restitution is not None:
        return [("e", results.restitution)]
    return [(f"V{i}", v) for i, v in enumerate(results.velocities_after, 1)]


def shortened(expression: Any) -> str:
    """The text of an expression.

    A text that is too long for a line is cut after a word, and " ..." is added.
    """
    text = str(expression)
    if len(text) <= MAX_LINE_LENGTH:
        return text
    whole_words = text[:MAX_LINE_LENGTH].rsplit(" ", 1)[0]
    return whole_words + " ..."
