"""closed_form(): a collision in symbols, and the cell in which the formula holds.

The run is made on fractions that remember how they were made, a hair's breadth away from the
numbers of the system, in a direction in which no two times or velocities that are unlike agree by
chance. Its history, evaluated in symbols, is the formula. Where the system lies on the border of a
cell, as commensurate transit times often do, the cells on all sides are found, and united where
their formulas agree.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from ..methods.duration import Forecast, Progress, warn
from ..methods.registry import check_function
from ..model import System
from ..model.frozen import InvalidModel, Problems, nearest, raise_noted
from ..storage.extras import optional
from .cells import conditions
from .inequalities import factors, reduced
from .naming import Naming
from .numbers import Number, evaluate, mark
from .quotients import Quotient
from .rational import Exact, fractions_of
from .rows import check_cap, check_final, each

SHORT = 1 << 24  # denominator of directions, so that fractions are short
HAIR = Fraction(1, 1 << 120)  # how far from the numbers of the system runs are made, of themselves
DIRECTIONS = 512  # in which sides are looked for
MOST_SIDES = 64
FACTORED = 400  # terms: longer polynomials are shown as they are
FEW = 4  # other formulas, and borders, that are told in short
NEAREST = 3  # conditions that are told beside a formula
LINE = 160  # characters of a condition, and of another formula
MANY = 10**6  # the largest denominator that is shown


class Field:
    """Rational functions of the names of a system, and how they are shown."""

    def __init__(self, naming: Naming, progress: Progress | None = None) -> None:
        self.progress = progress
        self.sympy: Any = optional("sympy", "sympy")
        self.naming = naming
        names = [*naming.base, *naming.speeds]
        self.ring, *generators = self.sympy.polys.rings.ring(names, self.sympy.ZZ)
        self.names = {name: Quotient(x, 1, {}) for name, x in zip(names, generators, strict=True)}
        self.symbols = {name: self.sympy.Symbol(name, **{"real" if name[0] == "v" else "positive":
                                                         True}) for name in naming.base}
        self._shown = [self.symbols.get(name) or self._speed(name) for name in names]

    def _speed(self, name: str) -> Any:
        E, rho = (self.symbols.get(x) or self.rational(x) for x in self.naming.speeds[name])
        return self.sympy.sqrt(E / rho)

    def rational(self, x: Fraction) -> Any:
        """SymPy's number."""
        return self.sympy.Rational(x.numerator, x.denominator)

    def of(self, wanted: Iterable[Number]) -> list[Any]:
        """Numbers of a run as rational functions."""
        return evaluate(list(wanted), self.names, lambda x: Quotient.of(x, self.ring))

    def told(self, polynomials: Sequence[Any]) -> Iterator[Any]:
        """Each of some polynomials that are worked on in turn, with news of how long it takes."""
        forecast = Forecast(warn, "fewer symbols, or some by their whole paths,", self.progress,
                            "finding where the formula holds")
        for i, p in enumerate(polynomials):
            forecast.report(i, len(polynomials), f"{len(polynomials)} polynomials")
            yield p

    def polynomial(self, p: Any) -> Any:
        """A polynomial as SymPy's expression, in factors unless it is long."""
        shown = p.as_expr(*self._shown)
        return shown if len(p) > FACTORED else self.sympy.factor(shown)

    def quotient(self, f: Quotient) -> Any:
        """A rational function as SymPy's expression."""
        return self.polynomial(f.numer) / (f.number * self.sympy.prod(
            p.as_expr(*self._shown) ** n for p, n in f.factors.items()))

    def inequality(self, p: Any) -> Any:
        """A polynomial that is positive, as an inequality between sums."""
        less, more = (
            p.ring.from_dict({powers: abs(c) for powers, c in p.terms() if (c > 0) == sign})
            for sign in (False, True)
        )
        return self.polynomial(less) < self.polynomial(more)

    def at(self, p: Any, values: Mapping[str, Fraction]) -> Fraction:
        """Value of a polynomial."""
        place = [values[name] for name in self.names]
        return sum((Fraction(int(c.numerator), int(c.denominator))
                    * prod(x**n for x, n in zip(place, powers, strict=True) if n)
                    for powers, c in p.terms()), Fraction(0))

    def slope(self, p: Any) -> Any:
        """Change of a polynomial at the numbers of the system, by the share of each free one."""
        base, places = self.naming.values({}), list(self.names)
        return np.array([float(self.at(p.diff(places.index(name)), base) * (base[name] or 1))
                         for name in self.naming.free])

    def distance(self, p: Any) -> float:
        """By which share the numbers of the system must change, at least about, for p to be 0."""
        slope = float(np.linalg.norm(self.slope(p)))
        return float(self.at(p, self.naming.values({}))) / slope if slope else float("inf")


class Side:
    """One cell: a run near the numbers of the system, what it came to, and on what it depends."""

    def __init__(self, field: Field, direction: Mapping[str, Fraction], max_events: int) -> None:
        self.field, naming = field, field.naming
        run = naming.run({name: HAIR * share for name, share in direction.items()}, max_events)
        check_final(run, max_events)
        self.results, self.conditions = run.results, conditions(run)
        self._flat: list[Number] = []
        each(self.results, self._flat.append)
        self.place = {**naming.base, **naming.place}

    @cached_property
    def mark(self) -> tuple[int, ...]:
        """What is the same for cells of one formula."""
        return (*map(len, self.results.contact_times), *mark(self._flat, self.place))

    def results_as(self, what: Callable[[Any], Any]) -> tuple[Any, Any, Any, Any]:
        """What `what` makes of each result as a rational function."""
        functions = dict(zip(map(id, self._flat), self._functions, strict=True))
        return each(self.results, lambda x: what(functions[id(x)]))

    @cached_property
    def _functions(self) -> list[Any]:
        return self.field.of(self._flat)

    def contains(self, values: Mapping[str, Fraction], open_to: Collection[Any] = ()) -> bool:
        """Whether the cell has this place inside, or on one of the borders `open_to`."""
        found = self._at(values)
        return all(x >= 0 for x in found) and all(
            self.field.at(p, values) > 0 or p in open_to
            for p in self._factors(x for x, value in zip(self.conditions, found, strict=True)
                                   if value == 0)
        )

    def _at(self, values: Mapping[str, Fraction]) -> list[Fraction]:
        """Values of the conditions; 0 where they have none but in the limit."""
        try:
            return evaluate(self.conditions, values, Fraction)
        except ZeroDivisionError:
            found = []
            for x in self.conditions:
                try:
                    found += evaluate([x], values, Fraction)
                except ZeroDivisionError:
                    found.append(Fraction(0))
            return found

    def _factors(self, numbers: Iterable[Number]) -> list[Any]:
        told = self.field.told(self.field.of(numbers))
        return factors(told, lambda p: self.field.at(p, self.place))

    @cached_property
    def borders(self) -> list[Any]:
        """Polynomials that are positive inside; they border the cell."""
        return reduced(self._factors(self.conditions), self.field.told)

    @cached_property
    def ties(self) -> list[Any]:
        """Borders on which the numbers of the system lie."""
        base = self.field.naming.values({})
        zero = (x for x, value in zip(self.conditions, self._at(base), strict=True) if value == 0)
        return reduced((p for p in self._factors(zero) if self.field.at(p, base) == 0),
                       self.field.told)

    @cached_property
    def slopes(self) -> Any:
        """Of the ties, along each name that is free, of the size of its value."""
        rows = [self.field.slope(p) for p in self.ties]
        return [row / np.linalg.norm(row) for row in rows if row.any()]


def sides_of(field: Field, max_events: int) -> tuple[list[Side], bool]:
    """Cells that meet at the numbers of the system, that in the first direction first.

    Those in which the collision is not over after `max_events`, and those beyond `MOST_SIDES`,
    are not among them; whether there are such is told. The first cannot be left out.
    """
    names = field.naming.free
    directions = np.random.default_rng(1867).uniform(-1, 1, (DIRECTIONS, len(names)))
    directions[0] = np.linspace(1, 2, len(names)) + directions[0] / 1000  # no two steps alike
    directions = np.round(directions * SHORT) / SHORT
    unseen = np.ones(DIRECTIONS, dtype=bool)
    sides: list[Side] = []
    unsolved = False
    while unseen.any() and len(sides) < MOST_SIDES:
        i = int(np.flatnonzero(unseen)[0])
        unseen[i] = False
        try:
            side = Side(field, dict(zip(names, map(Fraction, directions[i]), strict=True)),
                        max_events)
        except InvalidModel:
            if not sides:
                raise
            unsolved = True
            continue
        sides.append(side)
        if not len(side.slopes):
            unseen[:] = False
        else:
            unseen &= ~(directions @ np.transpose(side.slopes) > 0).all(axis=1)
    return sides, unsolved or bool(unseen.any())


def closed_form(
    system: System, symbols: Sequence[str] = ("transit_time", "impedance"), *,
    max_events: int = 1000, progress: Progress | None = None,
) -> ClosedForm:
    """Solve a collision in symbols.

    Where the system lies on borders between cells, the formula is that of the cell into which its
    chosen numbers lead as they grow, the later ones by the larger shares: twice those of the first
    for the last. The other formulas that meet there are the `sides`.

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
    progress : function, optional
        Called while it takes long, here or when conditions are asked for or printed, with the
        polynomials that are done, and how many there are.

    Raises
    ------
    InvalidModel
        If a symbol names nothing, or something acts of which this method knows nothing; if the
        collision is not over after `max_events`.
    ImportError
        Without SymPy, which the extra ``sympy`` brings.

    Warns
    -----
    LongRun
        As soon as it is known that something takes more than five seconds, with what takes less.

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
    check_cap("max_events", max_events)
    problems: Problems = []
    check_function(problems, "progress", progress)
    raise_noted(problems)
    field = Field(Naming(system, symbols), progress)
    sides, unsolved = sides_of(field, max_events)
    groups: dict[Any, list[Side]] = {}
    for side in sides:
        groups.setdefault(side.mark, []).append(side)

    def form(group: list[Side], more: tuple[ClosedForm, ...] = ()) -> ClosedForm:
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
        Whether there are more sides, where the collision is not over after `max_events`, or
        beyond the cap on cells.
    """

    _field: Field
    _cells: tuple[Side, ...]  # those of this formula that meet at the numbers of the system
    _others: tuple[Side, ...]
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

    @cached_property
    def restitution(self) -> Any:
        """e; None where not exactly one contact can open, or nothing collides."""
        return self._results[0]

    @property
    def velocities_after(self) -> tuple[Any, ...]:
        """Of the centres of mass, m/s."""
        return tuple(self._results[1])

    @property
    def impulses(self) -> tuple[Any, ...]:
        """At each contact, N s; at a bond its average, as vibration goes on."""
        return tuple(self._results[2])

    @property
    def contact_times(self) -> tuple[tuple[tuple[Any, Any], ...], ...]:
        """At each contact, when its force began and ended, s."""
        return tuple(self._results[3])

    @cached_property
    def _results(self) -> tuple[Any, Any, Any, Any]:
        return self._cells[0].results_as(self._field.quotient)

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
        first = sorted(range(len(distances)), key=distances.__getitem__)[:NEAREST]
        return tuple(self.cell[i] for i in sorted(first))

    def where(self, remedy: str) -> str:
        """The nearest conditions in a line; where there are more, how many, and what shows all."""
        told = ", ".join(map(_short, self.nearest)) or "always"
        more = len(self.cell) - len(self.nearest)
        return f"where {told}" + (f", and {more} more; {remedy}" if more else "")

    @cached_property
    def _borders(self) -> list[Any]:
        return reduced(self._united(), self._field.told)

    def _united(self) -> list[Any]:
        """Borders of the cells together, without those between them; or those of the first."""
        ties = {p for cell in self._cells for p in cell.ties}
        kept = {p for p in ties if -p not in ties}
        crossed = all(len(cell.slopes) == len(cell.ties) for cell in self._cells)
        if not (crossed and all(any(-p in kept for p in other.ties) for other in self._others)):
            return self._cells[0].borders
        outer = {p for cell in self._cells for p in cell.borders if p not in ties}
        return [*outer, *kept]

    def at(self, **values: Any) -> Exact:
        """Evaluate the formula in fractions; None for what is 0/0 there, but in a limit.

        Parameters
        ----------
        **values : Fraction, int, float or str
            Of symbols; the others keep their values of the system. Floats are what they are
            written as.
        """
        known, at = self._values(values), self._field.at

        def value(f: Quotient) -> Fraction | None:
            under = at(f.denom, known)
            return at(f.numer, known) / under if under else None

        return Exact(*self._cells[0].results_as(value), 1.0)

    def holds(self, **values: Any) -> bool:
        """Whether the formula holds for values as `at` takes them; on its outer borders not."""
        known = self._values(values)
        if any(x <= 0 for name, x in known.items() if name[0] != "v"):
            return False
        if any(cell.contains(known) for cell in self._cells):
            return True
        ties = {p for cell in self._cells for p in cell.ties}
        between = {p for p in ties if -p in ties}
        return any(cell.contains(known, between) for cell in self._cells) and not any(
            other.contains(known, other.borders) for other in self._others)

    def _values(self, values: Mapping[str, Any]) -> dict[str, Fraction]:
        names = self.symbols
        unknown = [name for name in values if name not in names]
        if unknown:
            raise InvalidModel([(unknown[0], f"is no symbol here; {nearest(unknown[0], names)}")])
        return self._field.naming.values(fractions_of(values))

    def __str__(self) -> str:
        lines = [f"{name} = {value}" for name, value in self._named()]
        lines.append(self.where(".cell has all"))
        if self.sides:
            border = ", ".join(_short(f"{tie.lhs} = {tie.rhs}") for tie in self._ties[:FEW])
            count = len(self.sides)
            others = f"{count} other formulas" if count > 1 else "another formula"
            e = self.at().restitution
            here = "" if e is None else f" (e = {e if e.denominator < MANY else float(e)})"
            lines.append(f"It meets {others} where {border}, as here{here}:")
            lines += map(_line, self.sides[:FEW])
            if len(self.sides) > FEW:
                lines.append("... see the others in .sides")
        if self.unsolved:
            lines.append("There are more, which max_events or the cap on cells has left out.")
        return "\n".join(lines)

    @property
    def _ties(self) -> list[Any]:
        """What tells the cell, or the first of them, from those beside it, the simplest first."""
        beside = {p for other in self._others for p in other.ties}
        return [self._field.inequality(p) for p in self._cells[0].ties if -p in beside]

    def _repr_latex_(self) -> str:
        latex = self._field.sympy.latex
        lines = [f"{name} &= {latex(value)}" for name, value in self._named()]
        cell = ",\\ ".join(map(latex, self.nearest))
        if len(self.cell) > NEAREST:
            cell += f"\\ \\text{{and {len(self.cell) - NEAREST} more}}"
        return "$$\\begin{aligned}" + "\\\\".join(lines) + "\\end{aligned}\\qquad " + cell + "$$"

    def _named(self) -> list[tuple[str, Any]]:
        if self.restitution is not None:
            return [("e", self.restitution)]
        return [(f"V{i}", v) for i, v in enumerate(self.velocities_after, 1)]


def _line(form: ClosedForm) -> str:
    """A formula beside another, in short."""
    formula = _short(", ".join(f"{name} = {value}" for name, value in form._named()))
    return f"{formula} where {', '.join(map(_short, form._ties[:FEW]))}"


def _short(told: Any) -> str:
    """The beginning of what is too long for a line."""
    text = str(told)
    return text if len(text) <= LINE else text[:LINE].rsplit(" ", 1)[0] + " ..."
