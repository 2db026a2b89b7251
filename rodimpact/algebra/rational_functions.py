"""Rational functions of the names of a row, and inequalities between them.

An inequality is a polynomial that is positive, an element of SymPy's ring. All names
but velocities stand for positive numbers. Polynomials are split into factors, and those
that others imply are left out.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ..progress import Progress, ProgressFunction, ProgressReport
from ..storage.extras import optional
from .checks import FormulaTooLong
from .symbolic_row import SymbolicRow
from .traced_fraction import Program, TracedFraction

MAX_FACTORED_TERMS = 400
"""Longer polynomials are not factored."""
MAX_PRODUCT_TERMS = 10**6
"""Largest number of terms in a product of two rational functions, or in their sum."""
MAX_CONDITION_TERMS = 100_000
"""Largest number of terms that are multiplied for the conditions of a cell.

That takes some seconds; without a bound, stepped rods take hours.
"""
CONDITIONS_REFUSAL = (
    "the conditions under which the formula holds are too long: name fewer numbers, or "
    "some by their whole paths, such as bodies.0.length"
)
MAX_COMPARED_TERMS = 40
"""Longer polynomials are kept without testing whether others imply them."""
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
    row : SymbolicRow
    base_values : dict of str to Fraction
        Values of all names in the system, wave speeds included.
    """

    def __init__(
        self, row: SymbolicRow, progress: bool | ProgressFunction = True
    ) -> None:
        """Import SymPy, and make its field of rational functions of the row's names.

        ImportError is raised without SymPy.
        """
        self.sympy: Any = optional("sympy", extra="sympy")
        self.row = row
        self.base_values = row.values({})
        names = [*row.base, *row.wave_speeds]
        self._field, *generators = self.sympy.polys.fields.field(names, self.sympy.ZZ)
        self._generators = dict(zip(names, generators, strict=True))
        self._symbols = self._symbols_for_users()
        self._progress = progress
        self._steps = 0  # operations and polynomials so far

    def _symbols_for_users(self) -> list[Any]:
        """Symbols as users see them, in the order of the names; c as sqrt(E/rho).

        All of them but velocities are positive for SymPy, so that roots simplify.
        """
        sympy = self.sympy
        symbols: dict[Any, Any] = {}
        for name in self.row.base:
            if name.startswith("v"):
                symbols[name] = sympy.Symbol(name, real=True)
            else:
                symbols[name] = sympy.Symbol(name, positive=True)
        shown = list(symbols.values())

        def symbol_or_number(part: Any) -> Any:
            """Symbol of a name, or a fraction itself."""
            if part in symbols:
                return symbols[part]
            return sympy.Rational(part)

        for speed in self.row.wave_speeds.values():
            E = symbol_or_number(speed.youngs_modulus)
            rho = symbol_or_number(speed.density)
            shown.append(sympy.sqrt(E / rho))
        return shown

    # Progress

    def work(self) -> Progress:
        """Progress of what is computed in symbols; its amount is not known before."""
        return Progress(self._progress, "formula", "steps")

    def _count_step(self, report: ProgressReport) -> None:
        """Report one step more."""
        self._steps += 1
        report(self._steps, None)

    def _counted(self, polynomials: Sequence[Any]) -> Iterator[Any]:
        """Polynomials in turn, each reported as a step."""
        with self.work() as report:
            for p in polynomials:
                self._count_step(report)
                yield p

    # Rational functions and their signs

    def functions_of(
        self, numbers: Iterable[TracedFraction], max_terms: float = math.inf
    ) -> list[Any]:
        """Numbers of a run as rational functions, elements of SymPy's field.

        `max_terms` bounds the terms that all steps together multiply.

        Raises
        ------
        FormulaTooLong
            If a single step, or all steps together, multiply too many terms.
        """
        multiplied = 0  # terms so far

        def constant(x: Fraction) -> Any:
            """A fraction as a rational function."""
            return self._field(x.numerator) / x.denominator

        program = Program(list(numbers), constant)
        with self.work() as report:

            def count_and_check(left: Any, right: Any) -> None:
                """Count an operation, and check the lengths of its operands."""
                nonlocal multiplied
                self._count_step(report)
                multiplied += check_length(left, right)
                if multiplied > max_terms:
                    raise FormulaTooLong([("symbols", CONDITIONS_REFUSAL)])

            return program(self._generators, before_operation=count_and_check)

    def factors(
        self,
        numbers: Iterable[TracedFraction],
        point: Mapping[str, Fraction],
        max_terms: float = math.inf,
    ) -> list[Any]:
        """Factors whose signs decide the signs of numbers, each once.

        Each is a polynomial with integer coefficients without a common divisor. Its
        sign is chosen so that it is positive at the point. Factors with only positive
        or only negative coefficients, and no velocity, are left out. `max_terms` is a
        limit of `functions_of`, which raises FormulaTooLong.
        """
        factors: dict[Any, None] = {}  # the keys are the factors, in order
        for f in self._counted(self.functions_of(numbers, max_terms)):
            for factor in _odd_factors(f):
                if definite(factor) or definite(-factor):
                    continue
                _, p = _over_rationals(factor).primitive()
                if self.value(p, point) <= 0:
                    p = -p
                factors[p] = None
        return list(factors)

    def without_implied(self, polynomials: Iterable[Any]) -> list[Any]:
        """Polynomials without those that others imply: linear ones, then the rest.

        Each part is sorted by length. Some that others imply may remain, since only
        simple implications are found.
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
            # p follows from linear forms if it is a sum of positive terms in them.
            is_implied = any(map(definite, _in_new_variables(p, linear)))
            if not is_implied:
                independent.append(p)
        return independent

    def value(self, p: Any, values: Mapping[str, Fraction]) -> Fraction:
        """Value of a polynomial at a point, the sum of its terms c x1^n1 x2^n2 ..."""
        point = [values[name] for name in self._generators]
        total = Fraction(0)
        for powers, c in p.terms():
            coefficient = Fraction(int(c.numerator), int(c.denominator))
            # Most powers n are 0: their factors 1 are left out.
            monomial = math.prod(x**n for x, n in zip(point, powers, strict=True) if n)
            total += coefficient * monomial
        return total

    def slope(self, p: Any) -> Any:
        """Derivatives of a polynomial at the numbers of the system, [free name] array.

        They are relative to each free number x: dp/d(log x) = x dp/dx, or dp/dx if x is
        0.
        """
        names = list(self._generators)
        derivatives = []
        for name in self.row.free_names:
            derivative = self.value(p.diff(names.index(name)), self.base_values)
            scale = self.base_values[name]
            if scale == 0:
                scale = Fraction(1)
            derivatives.append(float(derivative * scale))
        return np.array(derivatives)

    def distance(self, p: Any) -> float:
        """Estimate of the relative change of the system's numbers that makes p zero.

        It is p/norm(slope of p), inf if the slope is 0.
        """
        slope = float(np.linalg.norm(self.slope(p)))
        if not slope:
            return float("inf")
        return float(self.value(p, self.base_values)) / slope

    # Display

    def expression_of_polynomial(self, p: Any) -> Any:
        """A polynomial as SymPy's expression, in factors unless it is long.

        It is written in the symbols of the user, so that wave speeds become
        sqrt(E/rho).
        """
        shown = p.as_expr(*self._symbols)
        if len(p) > MAX_FACTORED_TERMS:
            return shown
        return self.sympy.factor(shown)

    def expression(self, f: Any) -> Any:
        """A rational function as SymPy's expression."""
        numerator = self.expression_of_polynomial(f.numer)
        return numerator / self.expression_of_polynomial(f.denom)

    def inequality(self, p: Any) -> Any:
        """The inequality p > 0 between sums of positive terms: smaller < larger.

        The larger sum has the terms of p with positive coefficients, so that p = larger
        - smaller.
        """
        terms = p.terms()
        larger = p.ring.from_dict({powers: c for powers, c in terms if c > 0})
        smaller = larger - p
        shown_smaller = self.expression_of_polynomial(smaller)
        shown_larger = self.expression_of_polynomial(larger)
        return shown_smaller < shown_larger


def check_length(left: Any, right: Any) -> int:
    """Number of terms that are multiplied if two rational functions are combined.

    FormulaTooLong is raised if there are more than `MAX_PRODUCT_TERMS`: the greatest
    common divisor of the result would then take minutes.
    """
    terms = 1
    for f in (left, right):
        terms *= len(f.numer) + len(f.denom)
    if terms > MAX_PRODUCT_TERMS:
        message = (
            f"a formula in these is too long: a single step multiplies {terms} terms, "
            f"of {MAX_PRODUCT_TERMS} at most; name fewer numbers, or some by their "
            "whole paths, such as bodies.0.length"
        )
        raise FormulaTooLong([("symbols", message)])
    return terms


def definite(p: Any) -> bool:
    """Whether a polynomial is certainly positive: all its coefficients are positive.

    The answer is also no if a velocity occurs in it, since velocities have any sign.
    """
    velocities = []  # indices of the variables
    for i, symbol in enumerate(p.ring.symbols):
        if symbol.name.startswith("v"):
            velocities.append(i)
    for powers, coefficient in p.terms():
        has_velocity = any(powers[i] > 0 for i in velocities)
        if coefficient <= 0 or has_velocity:
            return False
    return True


def _odd_factors(f: Any) -> list[Any]:
    """Factors with an odd power in numerator or denominator: the sign depends on them.

    A numerator that is linear, or has more than `MAX_FACTORED_TERMS` terms, is a factor
    by itself.
    """
    if len(f.numer) > MAX_FACTORED_TERMS or f.numer.is_linear:
        factors_of_numerator = [(f.numer, 1)]
    else:
        _, factors_of_numerator = f.numer.factor_list()
    _, factors_of_denominator = f.denom.factor_list()
    odd_factors = []
    for factor, power in [*factors_of_numerator, *factors_of_denominator]:
        if power % 2 == 1:
            odd_factors.append(factor)
    return odd_factors


def _over_rationals(p: Any) -> Any:
    """The polynomial with coefficients in the rationals in place of the integers."""
    return p.set_ring(p.ring.clone(domain=p.ring.domain.get_field()))


# Implied inequalities -----------------------------------------------------------------


def _follows(p: Any, forms: list[Any]) -> bool:
    """Whether a linear form is a positive combination of other forms and of names.

    p = sum(share q) + remainder, with shares >= 0 of the forms q, and a remainder that
    is 0 or a positive combination of 1 and of the names of positive numbers.
    Non-negative least squares propose the shares; the remainder is tested in fractions.
    """
    from scipy.optimize import nnls

    ring = p.ring
    monomials = (1, *ring.gens)
    coefficients = np.zeros((1 + len(forms), len(monomials)))  # the first row is p
    for i, q in enumerate([p, *forms]):
        for j, x in enumerate(monomials):
            coefficients[i, j] = float(q.coeff(x))
    positive = [0]  # indices of the constant and of the names of positive numbers
    for j, x in enumerate(ring.gens, 1):
        if definite(x):
            positive.append(j)
    positive_monomials = np.eye(len(monomials))[positive]
    parts = np.vstack([coefficients[1:], positive_monomials])
    shares, _ = nnls(parts.T, coefficients[0])
    remainder = p
    # `zip` leaves out the last shares, those of the monomials: their parts stay in the
    # remainder.
    for q, share in zip(forms, shares, strict=False):
        exact = Fraction(share).limit_denominator(MAX_SHARE_DENOMINATOR)
        remainder -= q * ring.domain(exact.numerator, exact.denominator)
    if not remainder:
        return True
    return definite(remainder)


class Substitution(NamedTuple):
    """A variable in terms of a linear form, which takes the name of the variable.

    Its fields are the arguments of SymPy's `compose`.
    """

    variable: Any
    expression: Any


def _in_new_variables(p: Any, linear: list[Any]) -> Iterator[Any]:
    """The polynomial with one or two variables replaced by positive linear forms.

    One polynomial is yielded for each choice of variables and forms; none if p has more
    than `MAX_COMPARED_TERMS` terms.
    """
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
    """Substitutions for a second variable by the other linear forms.

    The first substitution, by `form`, is made in these forms before.
    """
    for other in linear:
        if other is form:
            continue
        for second in _substitutions(other.compose(*first)):
            if second.variable != first.variable:
                yield second


def _substitutions(form: Any) -> list[Substitution]:
    """Substitutions for each variable x whose coefficient a in a linear form is > 0.

    From form = a x + rest follows x = (form - rest)/a. In the result the name x stands
    for the form: a new variable, which is positive as x was.
    """
    substitutions = []
    for x in form.ring.gens:
        a = form.coeff(x)
        if a > 0:
            rest = form - a * x
            # This x is the new variable, the form itself.
            substitutions.append(Substitution(x, (x - rest) / a))
    return substitutions
