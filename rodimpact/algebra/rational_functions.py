"""Rational functions of the names of a row, and inequalities between them.

An inequality is a polynomial that is positive, an element of SymPy's ring. All names
but velocities stand for positive numbers. Polynomials are split into factors, and those
that others imply are left out.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

from ..model.frozen import invalid_argument
from ..progress import Progress, ProgressFunction, Report
from ..storage.extras import optional
from .symbolic_row import SymbolicRow
from .traced_fraction import Program, TracedFraction

MAX_FACTORED_TERMS = 400
"""Longer polynomials are not factored."""
MAX_PRODUCT_TERMS = 10**6
"""Largest number of terms in a product of two rational functions, or in their sum."""
MAX_COMPARED_TERMS = 40
"""Whether others imply a polynomial is not tried for longer ones."""
MAX_SHARE_DENOMINATOR = 10**6
"""Largest denominator of the shares with which linear forms are tried."""


class RationalFunctions:
    """Rational functions of the names of a row, and how they are shown.

    Parameters
    ----------
    row : SymbolicRow
    progress : bool or function
        Whether a bar may show that the work goes on.

    Attributes
    ----------
    sympy : module
    base : dict of str to Fraction
        Values of all names in the system.
    """

    def __init__(
        self, row: SymbolicRow, progress: bool | ProgressFunction = True
    ) -> None:
        self.sympy: Any = optional("sympy", "sympy")
        self.row = row
        self.base = row.values({})
        names = [*row.base, *row.wave_speeds]
        self._field, *generators = self.sympy.polys.fields.field(names, self.sympy.ZZ)
        self._generators = dict(zip(names, generators, strict=True))
        self._shown_generators = self._display_symbols()
        self._progress = progress
        self._steps = 0  # operations and polynomials so far

    def _display_symbols(self) -> list[Any]:
        """Symbols as users see them, in the order of the names; c as sqrt(E/rho)."""
        sympy = self.sympy
        symbols: dict[Any, Any] = {}
        for name in self.row.base:
            if name.startswith("v"):
                symbols[name] = sympy.Symbol(name, real=True)
            else:
                symbols[name] = sympy.Symbol(name, positive=True)
        shown = list(symbols.values())
        for speed in self.row.wave_speeds.values():
            squared_speed = []
            for part in speed:
                if part in symbols:
                    squared_speed.append(symbols[part])
                else:
                    squared_speed.append(sympy.Rational(part))
            E, rho = squared_speed
            shown.append(sympy.sqrt(E / rho))
        return shown

    # Progress

    def work(self) -> Progress:
        """Progress of what is computed in symbols; its amount is not known before."""
        return Progress(self._progress, "formula", "steps")

    def _count_step(self, report: Report) -> None:
        self._steps += 1
        report(self._steps, None)

    def _counted(self, polynomials: Sequence[Any]) -> Iterator[Any]:
        """Polynomials in turn, each reported as a step."""
        with self.work() as report:
            for p in polynomials:
                self._count_step(report)
                yield p

    # Rational functions and their signs

    def functions_of(self, numbers: Iterable[TracedFraction]) -> list[Any]:
        """Numbers of a run as rational functions.

        Raises
        ------
        InvalidModel
            If they become too long.
        """

        def constant(x: Fraction) -> Any:
            return self._field(x.numerator) / x.denominator

        program = Program(list(numbers), constant)
        with self.work() as report:

            def before_operation(left: Any, right: Any) -> None:
                self._count_step(report)
                check_length(left, right)

            return program(self._generators, before_operation)

    def factors(
        self, numbers: Iterable[TracedFraction], point: Mapping[str, Fraction]
    ) -> list[Any]:
        """Factors whose signs decide the signs of numbers.

        Each is taken with the sign with which it is positive at a point.
        """
        factors: dict[Any, None] = {}
        for f in self._counted(self.functions_of(numbers)):
            for factor in _odd_factors(f):
                if definite(factor) or definite(-factor):
                    continue
                p = _over_rationals(factor).primitive()[1]
                if self.value(p, point) <= 0:
                    p = -p
                factors[p] = None
        return list(factors)

    def without_implied(self, polynomials: Iterable[Any]) -> list[Any]:
        """Polynomials without those that others imply: linear ones, then the rest.

        The result may still imply one another, where that is harder to see.
        """
        ordered = sorted(polynomials, key=lambda p: (len(p), str(p)))
        linear = [p for p in ordered if p.is_linear]
        nonlinear = [p for p in ordered if not p.is_linear]
        for p in self._counted(linear[::-1]):  # the longest first
            shorter_list = [q for q in linear if q is not p]
            if _follows(p, shorter_list):
                linear = shorter_list
        independent = [*linear]
        for p in self._counted(nonlinear):
            if not any(map(definite, _in_new_variables(p, linear))):
                independent.append(p)
        return independent

    def value(self, p: Any, values: Mapping[str, Fraction]) -> Fraction:
        """Value of a polynomial at a point."""
        point = [values[name] for name in self._generators]
        total = Fraction(0)
        for powers, coefficient in p.terms():
            term = Fraction(int(coefficient.numerator), int(coefficient.denominator))
            total += term * prod(x**n for x, n in zip(point, powers, strict=True) if n)
        return total

    def slope(self, p: Any) -> Any:
        """Derivatives of a polynomial at the numbers of the system.

        They are relative to each number that is free: d p / d(log x), or d p / dx if x
        = 0.
        """
        names = list(self._generators)
        derivatives = []
        for name in self.row.free_names:
            derivative = self.value(p.diff(names.index(name)), self.base)
            scale = self.base[name]
            if scale == 0:
                scale = Fraction(1)
            derivatives.append(float(derivative * scale))
        return np.array(derivatives)

    def distance(self, p: Any) -> float:
        """Relative change of the numbers of the system that makes p zero, about."""
        slope = float(np.linalg.norm(self.slope(p)))
        if not slope:
            return float("inf")
        return float(self.value(p, self.base)) / slope

    # Display

    def expression_of_polynomial(self, p: Any) -> Any:
        """A polynomial as SymPy's expression, in factors unless it is long."""
        shown = p.as_expr(*self._shown_generators)
        if len(p) > MAX_FACTORED_TERMS:
            return shown
        return self.sympy.factor(shown)

    def expression(self, f: Any) -> Any:
        """A rational function as SymPy's expression."""
        numerator = self.expression_of_polynomial(f.numer)
        return numerator / self.expression_of_polynomial(f.denom)

    def inequality(self, p: Any) -> Any:
        """A polynomial that is positive, as an inequality between sums."""
        terms = p.terms()
        larger = p.ring.from_dict({powers: c for powers, c in terms if c > 0})
        smaller = larger - p
        return self.expression_of_polynomial(smaller) < self.expression_of_polynomial(
            larger
        )


def check_length(left: Any, right: Any) -> None:
    """Raise InvalidModel before two long rational functions are added or multiplied.

    The greatest common divisor of the result would take minutes.
    """
    terms = 1
    for f in (left, right):
        terms *= len(f.numer) + len(f.denom)
    if terms > MAX_PRODUCT_TERMS:
        raise invalid_argument(
            "symbols",
            f"a formula in these is too long: a single step multiplies {terms} terms, "
            f"of {MAX_PRODUCT_TERMS} at most; name fewer numbers, or some by their "
            "whole paths, such as bodies.0.length",
        )


def definite(p: Any) -> bool:
    """Whether a polynomial is seen to be positive: all its coefficients are.

    Terms with velocities have no sign of their own.
    """
    velocities = []
    for i, symbol in enumerate(p.ring.symbols):
        if symbol.name.startswith("v"):
            velocities.append(i)
    for powers, coefficient in p.terms():
        if coefficient <= 0 or any(powers[i] for i in velocities):
            return False
    return True


def _odd_factors(f: Any) -> list[Any]:
    """Factors with an odd power in a rational function: they change its sign."""
    if len(f.numer) > MAX_FACTORED_TERMS or f.numer.is_linear:
        powers_of_factors = [(f.numer, 1)]
    else:
        powers_of_factors = f.numer.factor_list()[1]
    powers_of_factors = [*powers_of_factors, *f.denom.factor_list()[1]]
    return [factor for factor, power in powers_of_factors if power % 2]


def _over_rationals(p: Any) -> Any:
    """The polynomial with coefficients in the rationals in place of the integers."""
    return p.set_ring(p.ring.clone(domain=p.ring.domain.get_field()))


# Implied inequalities -----------------------------------------------------------------


def _follows(p: Any, forms: list[Any]) -> bool:
    """Whether a linear form is a positive combination of other forms and of names.

    Non-negative least squares propose the combination; it is tested in fractions.
    """
    ring = p.ring
    monomials = (1, *ring.gens)
    coefficients = np.zeros((1 + len(forms), len(monomials)))
    for i, q in enumerate([p, *forms]):
        for j, x in enumerate(monomials):
            coefficients[i, j] = float(q.coeff(x))
    positive = [0]  # the constant and the names of positive numbers
    for i, x in enumerate(ring.gens, 1):
        if definite(x):
            positive.append(i)
    units = np.eye(len(monomials))[positive]
    shares, _ = nnls(np.vstack([coefficients[1:], units]).T, coefficients[0])
    remainder = p
    for q, share in zip(forms, shares, strict=False):
        exact = Fraction(share).limit_denominator(MAX_SHARE_DENOMINATOR)
        remainder -= q * ring.domain(exact.numerator, exact.denominator)
    if not remainder:
        return True
    return definite(remainder)


class Substitution(NamedTuple):
    """A variable in terms of a linear form, which takes the name of the variable."""

    variable: Any
    expression: Any


def _in_new_variables(p: Any, linear: list[Any]) -> Iterator[Any]:
    """The polynomial with one or two variables replaced by positive linear forms."""
    if len(p) > MAX_COMPARED_TERMS:
        return
    for form in linear:
        for first in _substitutions(form):
            once = p.compose(*first)
            yield once
            for second in _second_substitutions(linear, form, first):
                yield once.compose(*second)


def _second_substitutions(
    linear: list[Any], form: Any, first: Substitution
) -> Iterator[Substitution]:
    """Substitutions by another linear form, after a first one by `form`."""
    for other in linear:
        if other is form:
            continue
        for second in _substitutions(other.compose(*first)):
            if second.variable != first.variable:
                yield second


def _substitutions(form: Any) -> list[Substitution]:
    """Each variable that grows with a linear form, solved for by means of the form."""
    substitutions = []
    for x in form.ring.gens:
        a = form.coeff(x)
        if a > 0:
            substitutions.append(Substitution(x, (x - (form - a * x)) / a))
    return substitutions
