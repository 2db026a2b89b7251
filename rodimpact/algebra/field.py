"""Rational functions of the names of a row, and how SymPy shows them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

import numpy as np

from ..methods.duration import Forecast, Progress, warn
from ..storage.extras import optional
from .inequalities import FACTORED
from .naming import Naming
from .numbers import Number, Program


class Field:
    """Rational functions of the names of a system, and how they are shown."""

    def __init__(self, naming: Naming, progress: Progress | None = None) -> None:
        self.progress = progress
        self.sympy: Any = optional("sympy", "sympy")
        self.naming, self.base = naming, naming.values({})
        names = [*naming.base, *naming.speeds]
        self.field, *generators = self.sympy.polys.fields.field(names, self.sympy.ZZ)
        self.names = dict(zip(names, generators, strict=True))
        symbols = {name: self.sympy.Symbol(name, **{"real" if name[0] == "v" else "positive": True})
                   for name in naming.base}
        self._shown = list(symbols.values())
        for pair in naming.speeds.values():
            E, rho = (symbols.get(x) or self.sympy.Rational(x) for x in pair)
            self._shown.append(self.sympy.sqrt(E / rho))

    def of(self, wanted: Iterable[Number]) -> list[Any]:
        """Numbers of a run as rational functions."""
        program = Program(list(wanted), lambda x: self.field(x.numerator) / x.denominator)
        return program(self.names)

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

    def quotient(self, f: Any) -> Any:
        """A rational function as SymPy's expression."""
        return self.polynomial(f.numer) / self.polynomial(f.denom)

    def inequality(self, p: Any) -> Any:
        """A polynomial that is positive, as an inequality between sums."""
        more = p.ring.from_dict({powers: c for powers, c in p.terms() if c > 0})
        return self.polynomial(more - p) < self.polynomial(more)

    def at(self, p: Any, values: Mapping[str, Fraction]) -> Fraction:
        """Value of a polynomial."""
        place = [values[name] for name in self.names]
        return sum((Fraction(int(c.numerator), int(c.denominator))
                    * prod(x**n for x, n in zip(place, powers, strict=True) if n)
                    for powers, c in p.terms()), Fraction(0))

    def slope(self, p: Any) -> Any:
        """Change of a polynomial at the numbers of the system, by the share of each free one."""
        return np.array([
            float(self.at(p.diff(list(self.names).index(name)), self.base) * (self.base[name] or 1))
            for name in self.naming.free])

    def distance(self, p: Any) -> float:
        """By which share the numbers of the system must change, at least about, for p to be 0."""
        slope = float(np.linalg.norm(self.slope(p)))
        return float(self.at(p, self.base)) / slope if slope else float("inf")
