"""A cell: the numbers of a row with which its collision goes the same way, and its results there.

An atlas tries many places of a plane at once, in floats. A formula asks in fractions, and for the
polynomials that border the cell.
"""

from collections.abc import Collection, Mapping, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .conditions import conditions
from .exact import Exact, ExactRun, each
from .field import Field
from .naming import Naming
from .numbers import Number, Program

Floats = NDArray[np.float64]
CUTS = 64  # in which a way is cut where a border is looked for, and each of these again
ROUNDS = 8
DECIMALS = 150  # with which formulas are evaluated to be told apart


class Cell:
    """What a run came to, and what must hold for another to come to the same.

    Parameters
    ----------
    naming : Naming
    run : ExactRun
    place : dict of str to Fraction
        Numbers in the run.
    field : Field, optional
        For what is asked of the cell by a formula.
    names : list of str, optional
        Of the two numbers whose plane is looked at in floats.
    """

    def __init__(
        self,
        naming: Naming,
        run: ExactRun,
        place: Mapping[str, Fraction],
        field: Field | None = None,
        names: Sequence[str] = (),
    ) -> None:
        self.results, self.place = run.results, place
        self._conditions = conditions(run, in_order=field is not None)
        self._names, self._speeds = names, naming.speeds
        self._field: Any = field
        self._program = Program(self._conditions if names else [], float)

    def mark(self, *, times: bool) -> tuple[Any, ...]:
        """What is the same for cells of one formula, that of contact times too if these count."""
        values: list[Number] = []
        each(
            self.results if times else self.results._replace(contact_times=()),
            values.append,
        )
        random = Random(1867)
        with localcontext(
            prec=DECIMALS
        ):  # values at names of no sort tell formulas apart
            there = {name: Decimal(1 + random.random()) for name in self.place}
            program = Program(values, lambda x: Decimal(x.numerator) / x.denominator)
            marks = [round(x, 40) for x in program(there)]
        return (*map(len, self.results.contact_times), *marks)

    # Places of the plane

    def inside(self, x: Floats, y: Floats) -> Any:
        """Whether places lie in the cell."""
        return self._hold(self._program, x, y).all(axis=0)

    def end(self, x: Floats, y: Floats, across: Floats, up: Floats) -> Floats:
        """Share of ways from places inside at which the cell ends, by cutting them again."""
        holds = self._hold(self._program, x + across, y + up).all(axis=1)
        broken = Program([self._conditions[i] for i in np.flatnonzero(~holds)], float)
        x, y, across, up = (of[:, None] for of in (x, y, across, up))
        low = np.zeros(x.shape)
        for n in range(1, ROUNDS + 1):
            shares = low + np.arange(1, CUTS + 1) / CUTS**n
            inside = self._hold(broken, x + across * shares, y + up * shares).all(
                axis=0
            )
            inside[:, -1] = False
            low += inside.argmin(axis=1, keepdims=True) / CUTS**n
        return low[:, 0]

    def restitution(self, x: Floats, y: Floats) -> Floats:
        """The formula of e, nan where there is none; [place]."""
        e = self.results.restitution
        found = np.nan if e is None else Program([e], float)(self._at(x, y))[0]
        return np.broadcast_to(found, x.shape)

    def _hold(self, program: Program, x: Floats, y: Floats) -> Any:
        """Which conditions hold; [condition][place]."""
        with np.errstate(all="ignore"):
            return np.array(np.broadcast_arrays(x, *program(self._at(x, y))))[1:] > 0

    def _at(self, x: Floats, y: Floats) -> dict[str, Any]:
        """All numbers of the run at places of the plane, wave speeds of its materials too."""
        at: dict[str, Any] = {name: float(value) for name, value in self.place.items()}
        at.update(zip(self._names, (x, y), strict=True))
        for c, (E, rho) in self._speeds.items():
            if E in self._names or rho in self._names:
                modulus, density = (
                    at[of] if of in at else float(of) for of in (E, rho)
                )
                at[c] = np.sqrt(modulus / density)
        return at

    # Formulas

    @cached_property
    def functions(self) -> Exact:
        """The results as rational functions."""
        values: list[Number] = []
        each(self.results, values.append)
        functions = iter(self._field.of(values))
        return each(self.results, lambda _: next(functions))

    def contains(
        self, values: Mapping[str, Fraction], open_to: Collection[Any] = ()
    ) -> bool:
        """Whether the cell has this place inside, or on one of the borders `open_to`."""
        found = _values(self._conditions, values)
        return all(x >= 0 for x in found) and all(
            self._field.at(p, values) > 0 or p in open_to for p in self._zero(found)
        )

    @cached_property
    def borders(self) -> Any:
        """Polynomials that are positive inside; they border the cell."""
        return self._field.reduced(self._field.factors(self._conditions, self.place))

    @cached_property
    def ties(self) -> Any:
        """Borders on which the numbers of the system lie."""
        field, base = self._field, self._field.base
        zero = self._zero(_values(self._conditions, base))
        return field.reduced(p for p in zero if field.at(p, base) == 0)

    @cached_property
    def slopes(self) -> Any:
        """Of the ties, along each name that is free, of the size of its value."""
        rows = [self._field.slope(p) for p in self.ties]
        return [row / np.linalg.norm(row) for row in rows if row.any()]

    def _zero(self, found: list[Fraction]) -> Any:
        """Factors of the conditions of which 0 is found."""
        zero = [
            x for x, value in zip(self._conditions, found, strict=True) if value == 0
        ]
        return self._field.factors(zero, self.place)


def _values(wanted: list[Number], values: Mapping[str, Fraction]) -> list[Fraction]:
    """Values of numbers at a place; 0 where they have none but in the limit."""
    try:
        return Program(wanted, Fraction)(values)
    except ZeroDivisionError:
        if len(wanted) == 1:
            return [Fraction(0)]
        return [value for x in wanted for value in _values([x], values)]
