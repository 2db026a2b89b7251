"""Rational functions of the names of a row, inequalities between them, and how SymPy shows them.

An inequality is a polynomial that is positive, an element of SymPy's ring. All names but velocities
are of positive numbers. Polynomials are cut into factors, and those left out that others imply.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

import numpy as np
from scipy.optimize import nnls

from ..model.frozen import refusal
from ..progress import Progress, ProgressFunction, Report
from ..storage.extras import optional
from .naming import Naming
from .numbers import Number, Program

FACTORED = 400  # terms: longer polynomials are not factored
LARGEST_PRODUCT = (
    10**6
)  # terms: a sum or product of rational functions multiplies these
COMPARED = 40  # terms: of longer ones it is not tried whether others imply them
LARGEST_SHARE = 10**6  # denominator of the shares that are tried


class Field:
    """Rational functions of the names of a system, and how they are shown."""

    def __init__(
        self, naming: Naming, progress: bool | ProgressFunction = True
    ) -> None:
        self._progress = progress
        self._steps = 0  # operations and polynomials so far
        self.sympy: Any = optional("sympy", "sympy")
        self.naming, self.base = naming, naming.values({})
        names = [*naming.base, *naming.speeds]
        self.field, *generators = self.sympy.polys.fields.field(names, self.sympy.ZZ)
        self.names = dict(zip(names, generators, strict=True))
        symbols = {
            name: self.sympy.Symbol(
                name, **{"real" if name[0] == "v" else "positive": True}
            )
            for name in naming.base
        }
        self._shown = list(symbols.values())
        for pair in naming.speeds.values():
            E, rho = (symbols.get(x) or self.sympy.Rational(x) for x in pair)
            self._shown.append(self.sympy.sqrt(E / rho))

    def work(self) -> Progress:
        """Progress of what is computed in symbols; how much it is nobody knows."""
        return Progress(self._progress, "formula", "steps")

    def of(self, wanted: Iterable[Number]) -> list[Any]:
        """Numbers of a run as rational functions.

        Raises
        ------
        InvalidModel
            If they become too long.
        """
        program = Program(
            list(wanted), lambda x: self.field(x.numerator) / x.denominator
        )
        with self.work() as report:

            def before(left: Any, right: Any) -> None:
                self._count(report)
                check_length(left, right)

            return program(self.names, before)

    def _count(self, report: Report) -> None:
        """Report one more step."""
        self._steps += 1
        report(self._steps, None)

    def factors(
        self, numbers: Iterable[Number], place: Mapping[str, Fraction]
    ) -> list[Any]:
        """Factors whose signs decide those of numbers, each with the sign it has at a place."""
        found: dict[Any, None] = {}
        for f in self._counted(self.of(numbers)):
            whole = len(f.numer) > FACTORED or f.numer.is_linear
            upper = [(f.numer, 1)] if whole else f.numer.factor_list()[1]
            for p, power in [*upper, *f.denom.factor_list()[1]]:
                if power % 2 and not definite(p) and not definite(-p):
                    p = p.set_ring(
                        p.ring.clone(domain=p.ring.domain.get_field())
                    ).primitive()[1]
                    found[p if self.at(p, place) > 0 else -p] = None
        return list(found)

    def reduced(self, polynomials: Iterable[Any]) -> list[Any]:
        """Leave out what others imply: of the linear ones first, then of the rest.

        What is left may imply one another still, where that is harder to see.
        """
        ordered = sorted(polynomials, key=lambda p: (len(p), str(p)))
        linear = [p for p in ordered if p.is_linear]
        for p in self._counted(linear[::-1]):  # the longest first
            others = [q for q in linear if q is not p]
            if _follows(p, others):
                linear = others
        others = [p for p in ordered if not p.is_linear]
        return [
            *linear,
            *(
                p
                for p in self._counted(others)
                if not any(map(definite, _in_new_variables(p, linear)))
            ),
        ]

    def _counted(self, polynomials: Sequence[Any]) -> Iterator[Any]:
        """Polynomials that are worked on in turn."""
        with self.work() as report:
            for p in polynomials:
                self._count(report)
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
        return sum(
            (
                Fraction(int(c.numerator), int(c.denominator))
                * prod(x**n for x, n in zip(place, powers, strict=True) if n)
                for powers, c in p.terms()
            ),
            Fraction(0),
        )

    def slope(self, p: Any) -> Any:
        """Change of a polynomial at the numbers of the system, by the share of each free one."""
        return np.array(
            [
                float(
                    self.at(p.diff(list(self.names).index(name)), self.base)
                    * (self.base[name] or 1)
                )
                for name in self.naming.free
            ]
        )

    def distance(self, p: Any) -> float:
        """By which share the numbers of the system must change, at least about, for p to be 0."""
        slope = float(np.linalg.norm(self.slope(p)))
        return float(self.at(p, self.base)) / slope if slope else float("inf")


def check_length(left: Any, right: Any) -> None:
    """Raise InvalidModel before two long rational functions are added or multiplied.

    The greatest common divisor of what comes out would take minutes.
    """
    terms = 1
    for f in (left, right):
        terms *= len(f.numer) + len(f.denom)
    if terms > LARGEST_PRODUCT:
        raise refusal(
            "symbols",
            f"a formula in these is too long: a single step multiplies {terms} terms, "
            f"of {LARGEST_PRODUCT} at most; name fewer numbers, or some by their whole "
            "paths, such as bodies.0.length",
        )


def definite(p: Any) -> bool:
    """Whether a polynomial is positive for positive numbers at a glance: all coefficients are."""
    signed = [i for i, x in enumerate(p.ring.symbols) if x.name.startswith("v")]
    return all(c > 0 and not any(powers[i] for i in signed) for powers, c in p.terms())


def _follows(p: Any, others: list[Any]) -> bool:
    """Whether a linear form is a sum of positive shares of others and of positive numbers."""
    rows = np.array(
        [[float(q.coeff(x)) for x in (1, *p.ring.gens)] for q in [p, *others]]
    )
    units = np.eye(rows.shape[1])[
        [0, *(i for i, x in enumerate(p.ring.gens, 1) if definite(x))]
    ]
    shares, _ = nnls(np.vstack([rows[1:], units]).T, rows[0])
    rest = p
    for q, share in zip(others, shares, strict=False):
        exact = Fraction(share).limit_denominator(LARGEST_SHARE)
        rest -= q * p.ring.domain(exact.numerator, exact.denominator)
    return not rest or definite(rest)


def _in_new_variables(p: Any, linear: list[Any]) -> Iterable[Any]:
    """The polynomial, with variables replaced by one or two linear forms that are positive."""
    if len(p) > COMPARED:
        return
    solved = [(q, x, form) for q in linear for x, form in _solved(q)]
    for q, x, form in solved:
        once = p.compose(x, form)
        yield once
        for r in linear:
            for y, other in _solved(r.compose(x, form)) if r is not q else ():
                if y != x:
                    yield once.compose(y, other)


def _solved(q: Any) -> list[tuple[Any, Any]]:
    """Each variable that grows with a linear form, in terms of the form, named as itself."""
    return [(x, (x - (q - a * x)) / a) for x in q.ring.gens if (a := q.coeff(x)) > 0]
