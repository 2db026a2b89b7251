"""Cover the box of numbers with tolerances by cells, and bound the results in each.

A run on fractions in the box has a formula, and inequalities within which that holds. Those that
are true all over the box are done with; the others border the cell. What lies beyond each of them
is looked into in the same way, until every corner of the box is in a cell or shown to be empty:
there a sum of the inequalities, with positive shares, is nowhere positive. In a cell, any positive
share of an inequality can be added to a result without loss of a bound, which takes account of
where the cell ends. The shares are found in floats by linear programming; what follows from them is
rounded outwards. Where borders are too bent for this, the box is cut in two.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from scipy.optimize import linprog

from ..model.frozen import InvalidModel
from .cells import conditions
from .formula import Field
from .inequalities import factors, is_linear
from .intervals import ALL, SLOPES, Bounds, Floats, Range, constant, constants, together, variable
from .naming import Naming
from .numbers import ZERO, Number, evaluate
from .quotients import Quotient
from .rows import check_final

STEPS = 1 << 32  # of places in a box, so that fractions are short
HAIR = Fraction(1, STEPS)  # how far beside these, so that nothing agrees by chance
MATTERS = 0.01  # share of the largest velocity, impulse or duration
MOST_CUTS = 32
CUT = Fraction(53, 109)  # not in the middle, where formulas like to meet
EXACTLY = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
LONG = 2_000  # terms: of products with more, derivatives are not made
TIGHT, LOOSE = 1.001, 3.0  # times as wide as if results changed evenly all over the box

Span = tuple[Fraction, Fraction]
Place = Mapping[str, Fraction]
Parts = list[list[list[Bounds]]]


class Covering:
    """All the cells that a box meets.

    Parameters
    ----------
    field : Field
    most_cells, max_events : int
        Caps.
    """

    def __init__(self, field: Field, most_cells: int, max_events: int) -> None:
        self.field, self.most_cells, self.max_events = field, most_cells, max_events
        self.cells: list[Cell] = []
        self._random = np.random.default_rng(1867)

    def bounds(self, spans: Mapping[str, Span]) -> Parts:
        """Bounds of e, if any, velocities, impulses and durations; [part of the box][kind][i]."""
        widths = {x: high - low for x, (low, high) in spans.items()}
        found: Parts = []
        boxes: deque[tuple[Box, Parts]] = deque([(Box(spans, widths), [])])
        cuts = 0
        while boxes:
            box, parts = boxes.popleft()
            try:
                parts = list(self._parts(box, []))
                done = not box.is_loose
            except (Bent, ZeroDivisionError):  # the bounds of the box it is part of hold, if any
                done = False
            if done or cuts == MOST_CUTS or not any(box.half.values()):
                if not parts:
                    raise _undecided(f"in {cuts + 1} parts of the box of the tolerances")
                found += parts
            else:
                boxes += [(part, parts) for part in box.parts()]
                cuts += 1
        return found

    def _parts(self, box: Box, held: list[Any]) -> Iterator[list[list[Bounds]]]:
        """Bounds in each cell of the part of a box where polynomials are positive."""
        place = self.find(box, held)
        if place is None:
            return
        cell = self._cell(place)
        if cell not in box.borders:
            box.borders[cell] = cell.borders_in(box, self.field)
        beyond = [p for p in box.borders[cell]
                  if p not in held and box.polynomial(p).bounds[0] <= 0]
        positive = [*held, *beyond]
        yield [[box.within(f, positive) for f in cell.results_in(box, kind, self.field)]
               for kind in cell.results]
        for i, p in enumerate(beyond):
            yield from self._parts(box, [*held, *beyond[:i], -p])

    def _cell(self, place: Place) -> Cell:
        for known in self.cells:
            if known.holds(place):
                return known
        if len(self.cells) == self.most_cells:
            raise _undecided(f"after {self.most_cells} formulas")
        self.cells.append(Cell(self.field.naming, place, self.max_events))
        return self.cells[-1]

    def find(self, box: Box, held: list[Any]) -> Place | None:
        """A place in a box where polynomials are positive; None if there is none."""
        hair = self._random.uniform(-1, 1, len(box.spans))
        if not held:
            return box.place(0 * hair, hair)
        ranges = [box.to_scale(p) for p in held]
        if any(-p in held for p in held) or any(x.bounds[1] <= 0 for x in ranges):
            return None
        # where the borders are farthest away, as far as they are straight
        slopes, levels = np.array([x.slopes for x in ranges]), [x.middle for x in ranges]
        best = linprog([*(0 * hair), -1], np.c_[-slopes, np.ones(len(held))], levels,
                       bounds=[(-1, 1)] * len(hair) + [(None, None)], options=EXACTLY)
        if not best.success:
            raise Bent
        if best.x[-1] > 0:
            place = box.place(best.x[:-1], hair)
            values = {**self.field.naming.values({}), **place}
            if all(self.field.at(p, values) > 0 for p in held):
                return place
        shares = np.maximum(-best.ineqlin.marginals, 0)
        if box.total(shares, ranges).bounds[1] < 0 or self._cancel(
                [p for p, share in zip(held, shares, strict=True) if share]):
            return None
        raise Bent

    def _cancel(self, polynomials: list[Any]) -> bool:
        """Whether linear forms add up to 0, with positive shares: then not all are positive."""
        if not all(map(is_linear, polynomials)):
            return False
        columns = [[p.coeff(x) for x in (1, *p.ring.gens)] for p in polynomials]
        shares = self.field.sympy.Matrix(columns).T.nullspace()
        return any(all(x > 0 for x in v) or all(x < 0 for x in v) for v in shares)


class Bent(Exception):
    """Borders are not straight enough to see whether something lies between them."""


def _undecided(where: str) -> InvalidModel:
    message = f"undecided {where}: too many formulas meet; give smaller tolerances"
    return InvalidModel([("tolerances", message)])


class Cell:
    """A run at a place, what it came to, and the numbers that are positive in its cell."""

    def __init__(self, naming: Naming, place: Place, max_events: int) -> None:
        self.place = {**naming.values({}), **place}
        run = naming.run_at(place, max_events)
        check_final(run, max_events)
        e, velocities, impulses, times = run.results
        durations = [sum((end - begin for begin, end in of), ZERO) for of in times]
        self.results: list[list[Number]] = [
            [] if e is None else [e], list(velocities), list(impulses), durations]
        self.conditions = conditions(run)
        self._borders: dict[int, list[Any]] = {}
        self._formulas: dict[int, Quotient] = {}

    def holds(self, place: Place) -> bool:
        """Whether a place is inside."""
        return all(x > 0 for x in evaluate(self.conditions, place, Fraction))

    def results_in(self, box: Box, kind: list[Number], field: Field) -> list[Range]:
        """What results can be in a box: as they were computed or, if that is loose, by formula."""
        try:
            found: list[Any] = box.of(kind)
        except ZeroDivisionError:  # by what cancels in the formula, perhaps
            found = [None] * len(kind)
        for i, x in enumerate(kind):
            if found[i] is None or found[i].is_wider_than(TIGHT):
                if id(x) not in self._formulas:
                    self._formulas[id(x)] = field.of([x])[0]
                found[i] = box.quotient(self._formulas[id(x)])
        size = max((abs(x) for f in found for x in f.bounds), default=0.0)
        box.is_loose |= any(f.is_wider_than(LOOSE) and f.width > MATTERS * size for f in found)
        return found

    def borders_in(self, box: Box, field: Field) -> list[Any]:
        """Polynomials that are positive in the cell, but perhaps not all over a box."""
        found: dict[Any, None] = {}
        for i, x in enumerate(box.of(self.conditions)):
            if x.bounds[0] <= 0:
                if i not in self._borders:
                    self._borders[i] = factors(
                        field.of([self.conditions[i]]), lambda p: field.at(p, self.place))
                found |= dict.fromkeys(self._borders[i])
        return list(found)


class Box:
    """Values that names can have, and what polynomials and results can be there.

    Parameters
    ----------
    spans : mapping of str to (Fraction, Fraction)
        Lowest and highest value of each name.
    widths : mapping of str to Fraction
        Those of the box of which this is a part.
    """

    def __init__(self, spans: Mapping[str, Span], widths: Place) -> None:
        self.spans, self.widths = spans, widths
        self.middle = {x: (low + high) / 2 for x, (low, high) in spans.items()}
        self.half = {x: (high - low) / 2 for x, (low, high) in spans.items()}
        self._ranges = {x: variable(i, len(spans), self.middle[x], self.half[x])
                        for i, x in enumerate(spans)}
        self._polynomials: dict[Any, Range] = {}
        self.is_loose = False
        self.borders: dict[Cell, list[Any]] = {}  # those that may cross this box

    def number(self, x: Fraction | float) -> Range:
        """A number that is the same all over the box."""
        return constant(Fraction(x), len(self.spans))

    def of(self, wanted: list[Number]) -> list[Range]:
        """What numbers of a run can be."""
        return evaluate(wanted, self._ranges, self.number)

    def polynomial(self, p: Any) -> Range:
        """What a polynomial can be."""
        if not p:
            return self.number(0)
        if p not in self._polynomials:
            total = constants((Fraction(int(x.numerator), int(x.denominator)) for x in p.coeffs()),
                              len(self.spans))
            for x, powers in zip(p.ring.symbols, np.transpose(p.monoms()), strict=True):
                if powers.any():
                    of_x = [self.number(1)]
                    for _ in range(powers.max()):
                        of_x.append(of_x[-1] * self._ranges[x.name])
                    total *= together(of_x)[powers]
            self._polynomials[p] = total.total()
        return self._polynomials[p]

    def quotient(self, f: Quotient) -> Range:
        """What a rational function can be: at the ends of what it grows with, or falls with."""
        if not f.numer:
            return self.number(0)
        over, under = f.numer, f.denom
        denominator = self.polynomial(under)
        found = self.polynomial(over) / denominator
        if len(over) * len(under) > LONG:
            return found
        low, high = found.low.copy(), found.high.copy()
        variables = {x.name: t for x, t in zip(over.ring.symbols, over.ring.gens, strict=True)}
        ends: list[dict[str, Span]] = [dict(self.spans), dict(self.spans)]
        for i, (x, (least, most)) in enumerate(self.spans.items(), SLOPES):
            t = variables[x]
            change = self.polynomial(over.diff(t) * under - over * under.diff(t))
            slope = self.number(self.half[x]) * change / (denominator * denominator)
            low[i], high[i] = slope.bounds
            if low[i] >= 0 or high[i] <= 0:
                places = [(least, least), (most, most)]
                ends[0][x], ends[1][x] = places if low[i] >= 0 else places[::-1]
        if ends[0] != self.spans:
            lowest, highest = (Box(spans, self.widths).quotient(f).bounds for spans in ends)
            low[ALL], high[ALL] = max(low[ALL], lowest[0]), min(high[ALL], highest[1])
        return Range(low, high)

    def within(self, f: Range, positive: list[Any]) -> Bounds:
        """Bounds of a result where polynomials are positive."""
        low, high = f.bounds
        ranges = [x for x in map(self.to_scale, positive) if x.slopes.any()]
        if not ranges or low == high:
            return low, high
        slopes, levels = [-x.slopes for x in ranges], [x.middle for x in ranges]
        highest = []
        for sign in (1, -1):
            best = linprog(-sign * f.slopes, slopes, levels, bounds=(-1, 1), options=EXACTLY)
            shares = np.zeros(len(ranges))
            if best.success:
                shares = np.maximum(-best.ineqlin.marginals, 0)
            highest.append((self.number(sign) * f + self.total(shares, ranges)).bounds[1])
        return max(low, -highest[1]), min(high, highest[0])

    def to_scale(self, p: Any) -> Range:
        """What a polynomial can be, times a positive number with which its slopes add up to 1."""
        found = self.polynomial(p)
        return self.number(1 / (float(np.abs(found.slopes).sum()) or 1.0)) * found

    def total(self, shares: Floats, ranges: list[Range]) -> Range:
        """Sum of quantities, each times its share."""
        total = self.number(0)
        for share, x in zip(shares, ranges, strict=True):
            if share:
                total += self.number(float(share)) * x
        return total

    def place(self, shares: Floats, hair: Floats) -> Place:
        """Go these shares of the way from the middle to the ends, and a hair aside."""
        return {
            x: self.middle[x] + self.half[x] * (
                Fraction(round(share * (STEPS - 1)), STEPS) + Fraction(aside) * HAIR)
            for x, share, aside in zip(self.spans, shares, hair, strict=True)
        }

    def parts(self) -> list[Box]:
        """Two boxes, cut where this is widest, compared with the first."""
        name = max(self.spans, key=lambda x: self.half[x] / (self.widths[x] or 1))
        low, high = self.spans[name]
        between = low + CUT * (high - low)
        return [Box({**self.spans, name: span}, self.widths)
                for span in ((low, between), (between, high))]
