"""closed_form(): a collision in symbols, and the cell in which the formula holds.

The run is made on fractions that remember how they were made, a hair's breadth away from the
numbers of the system, in a direction in which no two times or velocities that are unlike agree by
chance. Its history, evaluated in symbols, is the formula. Where the system lies on the border of a
cell, as commensurate transit times often do, the cells on all sides are found, and united where
their formulas agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from ..model import System
from ..model.frozen import InvalidModel, nearest
from ..progress import ProgressFunction
from .cell import Cell
from .exact import Exact, check_arguments, check_final, each, fractions_of
from .field import Field
from .naming import Naming

SHORT = 1 << 24  # denominator of directions, so that fractions are short
HAIR = Fraction(
    1, 1 << 120
)  # how far from the numbers of the system runs are made, of themselves
DIRECTIONS = 512  # in which sides are looked for
MOST_SIDES = 64
FEW = 4  # other formulas, and borders, that are told in short
NEAREST = 3  # conditions that are told beside a formula
LINE = 160  # characters of a condition, and of another formula
MANY = 10**6  # the largest denominator that is shown


def sides_of(field: Field, max_events: int) -> tuple[list[Cell], bool]:
    """Cells that meet at the numbers of the system, that in the first direction first.

    Those in which the collision is not over after `max_events`, and those beyond `MOST_SIDES`,
    are not among them; whether there are such is told. The first cannot be left out.
    """
    names = field.naming.free
    directions = np.random.default_rng(1867).uniform(-1, 1, (DIRECTIONS, len(names)))
    directions[0] = (
        np.linspace(1, 2, len(names)) + directions[0] / 1000
    )  # no two steps alike
    directions = np.round(directions * SHORT) / SHORT
    unseen = np.ones(DIRECTIONS, dtype=bool)
    sides: list[Cell] = []
    unsolved = False
    while unseen.any() and len(sides) < MOST_SIDES:
        i = int(np.flatnonzero(unseen)[0])
        unseen[i] = False
        values = dict(field.base)
        for name, share in zip(names, directions[i], strict=True):
            values[name] += (values[name] or 1) * HAIR * Fraction(share)
        run = field.naming.run(values, max_events)
        if not sides:
            check_final(run, max_events)
        unsolved |= not run.final
        if run.final:
            sides.append(Cell(field.naming, run, values, field))
            slopes = np.reshape(sides[-1].slopes, (-1, len(names)))
            unseen &= ~(directions @ slopes.T > 0).all(axis=1)
    return sides, unsolved or bool(unseen.any())


def closed_form(
    system: System,
    symbols: Sequence[str] = ("transit_time", "impedance"),
    *,
    max_events: int = 1000,
    progress: bool | ProgressFunction = True,
) -> ClosedForm:
    """Solve a collision in symbols.

    A system may lie on the border of several cells. Then the formula belongs to the cell that is
    reached if the chosen numbers grow, each by a larger share than the one before it; the last
    grows twice as fast as the first. The formulas of the other cells are the `sides`.

    Parameters
    ----------
    system : System
        Uniform or stepped rods, free or against walls, in rigid or bonded contact; no family.
    symbols : sequence of str
        Which numbers have names; the others keep their values. Paths of the case, such as
        ``bodies.0.length``, or the last words of such paths, which name all of these:
        ``transit_time`` T, ``impedance`` Z, ``length`` l, ``area`` A, ``youngs_modulus`` E,
        ``density`` rho, ``velocity`` v, ``gap`` g. They are counted from left to right: segments,
        materials, bodies (v) and contacts (g).
    max_events : int
        Cap on the events of a run.
    progress : bool or function
        Whether a bar may show that the work goes on, here and later when conditions are computed or
        printed. A function is called with the number of steps that are done, and None: nobody knows
        how many there are.

    Raises
    ------
    InvalidModel
        If a symbol names nothing, or something acts of which this method knows nothing; if the
        collision is not over after `max_events`; if the formula is too long.
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
    field = Field(Naming(system, symbols), progress)
    groups: dict[Any, list[Cell]] = {}
    with field.work():
        sides, unsolved = sides_of(field, max_events)
        for side in sides:
            groups.setdefault(side.mark(times=True), []).append(side)

    def form(group: list[Cell], more: tuple[ClosedForm, ...] = ()) -> ClosedForm:
        others = tuple(side for side in sides if side not in group)
        return ClosedForm(field, tuple(group), others, more, unsolved)

    first, *rest = groups.values()
    return form(first, tuple(map(form, rest)))


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """A collision in symbols, and where that holds.

    Attributes
    ----------
    sides : tuple of ClosedForm
        Formulas of the other cells, if the numbers of the system lie on a border between them.
    unsolved : bool
        Whether there are more sides: cells in which the collision is not over after `max_events`,
        or cells beyond the cap.

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

    _field: Field
    _cells: tuple[
        Cell, ...
    ]  # those of this formula that meet at the numbers of the system
    _others: tuple[Cell, ...]
    sides: tuple[ClosedForm, ...]
    unsolved: bool

    @property
    def symbols(self) -> dict[str, str]:
        """Paths of the numbers for which the symbols stand; of several the first."""
        return dict(self._field.naming.paths)

    @property
    def values(self) -> dict[str, Fraction]:
        """What the symbols are in the system, to 400 bits where a wave speed is irrational."""
        return dict(self._field.naming.base)

    @property
    def restitution(self) -> Any:
        """e; None where not exactly one contact can open, or nothing collides."""
        return self._results.restitution

    @property
    def velocities_after(self) -> tuple[Any, ...]:
        """Of the centres of mass, m/s."""
        return self._results.velocities_after

    @property
    def impulses(self) -> tuple[Any, ...]:
        """At each contact, N s; at a bond its average, as vibration goes on."""
        return self._results.impulses

    @property
    def contact_times(self) -> tuple[tuple[tuple[Any, Any], ...], ...]:
        """At each contact, when its force began and ended, s."""
        return self._results.contact_times

    @cached_property
    def _results(self) -> Exact:
        return each(self._cells[0].functions, self._field.quotient)

    @cached_property
    def cell(self) -> tuple[Any, ...]:
        """Inequalities between the symbols; the formula holds where all are true."""
        return tuple(map(self._field.inequality, self._borders))

    @cached_property
    def nearest(self) -> tuple[Any, ...]:
        """Those of `cell` that end the formula first as the numbers of the system change.

        The three whose borders are nearest, by the shares of the numbers that must change.
        """
        distances = list(map(self._field.distance, self._borders))
        return tuple(
            self.cell[i] for i in sorted(np.argsort(distances, kind="stable")[:NEAREST])
        )

    def where(self, remedy: str) -> str:
        """The nearest conditions in a line; where there are more, how many, and what shows all."""
        told = ", ".join(map(short, self.nearest)) or "always"
        more = len(self.cell) - len(self.nearest)
        return f"where {told}" + (f", and {more} more; {remedy}" if more else "")

    @cached_property
    def _borders(self) -> list[Any]:
        """Borders of the cells together, without those between them; or those of the first."""
        between, outer = self._tied
        crossed = all(len(cell.slopes) == len(cell.ties) for cell in self._cells)
        found = self._cells[0].borders
        if crossed and all(
            any(-p in outer for p in other.ties) for other in self._others
        ):
            others = {p for cell in self._cells for p in cell.borders}
            found = [*others - between - outer, *outer]
        return self._field.reduced(found)

    @cached_property
    def _tied(self) -> tuple[set[Any], set[Any]]:
        """Borders on which the numbers of the system lie: those between the cells, and others."""
        ties = {p for cell in self._cells for p in cell.ties}
        between = {p for p in ties if -p in ties}
        return between, ties - between

    def at(self, **values: Any) -> Exact:
        """Evaluate the formula in fractions; None for what is 0/0 there, but in a limit.

        Parameters
        ----------
        **values : Fraction, int, float or str
            Of symbols; the others keep their values of the system. Floats are what they are
            written as.
        """
        known, at = self._values(values), self._field.at

        def value(f: Any) -> Fraction | None:
            under = at(f.denom, known)
            return at(f.numer, known) / under if under else None

        return each(self._cells[0].functions, value)

    def holds(self, **values: Any) -> bool:
        """Whether the formula holds for values as `at` takes them; on its outer borders not."""
        known = self._values(values)
        if any(x <= 0 for name, x in known.items() if name[0] != "v"):
            return False
        if any(cell.contains(known) for cell in self._cells):
            return True
        return any(
            cell.contains(known, self._tied[0]) for cell in self._cells
        ) and not any(other.contains(known, other.borders) for other in self._others)

    def _values(self, values: Mapping[str, Any]) -> dict[str, Fraction]:
        names = self.symbols
        unknown = [name for name in values if name not in names]
        if unknown:
            raise InvalidModel(
                [(unknown[0], f"is no symbol here; {nearest(unknown[0], names)}")]
            )
        return self._field.naming.values(fractions_of(values))

    def __str__(self) -> str:
        lines = [f"{name} = {value}" for name, value in named(self._results)]
        lines.append(self.where(".cell has all"))
        if self.sides:
            border = ", ".join(
                short(f"{tie.lhs} = {tie.rhs}") for tie in self._ties[:FEW]
            )
            count = len(self.sides)
            others = f"{count} other formulas" if count > 1 else "another formula"
            e = self.at().restitution
            here = (
                "" if e is None else f" (e = {e if e.denominator < MANY else float(e)})"
            )
            lines.append(f"It meets {others} where {border}, as here{here}:")
            lines += map(_line, self.sides[:FEW])
            if len(self.sides) > FEW:
                lines.append("... see the others in .sides")
        if self.unsolved:
            lines.append(
                "There are more cells, left out by max_events or by the cap on cells."
            )
        return "\n".join(lines)

    @property
    def _ties(self) -> list[Any]:
        """What tells the cell, or the first of them, from those beside it, the simplest first."""
        beside = {p for other in self._others for p in other.ties}
        return [self._field.inequality(p) for p in self._cells[0].ties if -p in beside]

    def _repr_latex_(self) -> str:
        latex = self._field.sympy.latex
        lines = [f"{name} &= {latex(value)}" for name, value in named(self._results)]
        cell = ",\\ ".join(map(latex, self.nearest))
        if len(self.cell) > NEAREST:
            cell += f"\\ \\text{{and {len(self.cell) - NEAREST} more}}"
        return (
            "$$\\begin{aligned}"
            + "\\\\".join(lines)
            + "\\end{aligned}\\qquad "
            + cell
            + "$$"
        )


def _line(form: ClosedForm) -> str:
    """A formula beside another, in short."""
    formula = ", ".join(f"{name} = {value}" for name, value in named(form._results))
    return f"{short(formula)} where {', '.join(map(short, form._ties[:FEW]))}"


def named(results: Exact) -> list[tuple[str, Any]]:
    """What a formula tells: e, or where there is none the velocities after."""
    if results.restitution is not None:
        return [("e", results.restitution)]
    return [(f"V{i}", v) for i, v in enumerate(results.velocities_after, 1)]


def short(told: Any) -> str:
    """The beginning of what is too long for a line."""
    text = str(told)
    return text if len(text) <= LINE else text[:LINE].rsplit(" ", 1)[0] + " ..."
