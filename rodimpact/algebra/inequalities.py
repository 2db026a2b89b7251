"""Inequalities between polynomials: cut into factors, and those left out that others imply.

All names but velocities are of positive numbers. Polynomials are SymPy's ring elements; each stands
for polynomial > 0.
"""

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

import numpy as np
from scipy.optimize import nnls

FACTORED = 400  # terms: longer polynomials are not factored, neither here nor where they are shown
COMPARED = 40  # terms: of longer ones it is not tried whether others imply them
LARGEST_SHARE = 10**6  # denominator of the shares that are tried


def definite(p: Any) -> bool:
    """Whether a polynomial is positive for positive numbers at a glance: all coefficients are."""
    signed = [i for i, x in enumerate(p.ring.symbols) if x.name.startswith("v")]
    return all(c > 0 and not any(powers[i] for i in signed) for powers, c in p.terms())


def factors(functions: Iterable[Any], value: Callable[[Any], Fraction]) -> list[Any]:
    """Factors whose signs decide those of rational functions, each signed as `value` has it.

    Parameters
    ----------
    functions : iterable
        Elements of SymPy's field of rational functions.
    value : callable
        Value of a polynomial at a place inside.
    """
    found: dict[Any, None] = {}
    for f in functions:
        whole = len(f.numer) > FACTORED or f.numer.is_linear
        upper = [(f.numer, 1)] if whole else f.numer.factor_list()[1]
        for p, power in [*upper, *f.denom.factor_list()[1]]:
            if power % 2 and not definite(p) and not definite(-p):
                p = p.set_ring(p.ring.clone(domain=p.ring.domain.get_field())).primitive()[1]
                found[p if value(p) > 0 else -p] = None
    return list(found)


def reduced(
    polynomials: Iterable[Any], told: Callable[[list[Any]], Iterable[Any]] = iter
) -> list[Any]:
    """Leave out what others imply: of the linear ones first, then of the rest, the longest first.

    `told` hears of those that are worked on, in turn. What is left may imply one another still,
    where that is harder to see.
    """
    ordered = sorted(polynomials, key=lambda p: (len(p), str(p)))
    linear = [p for p in ordered if p.is_linear]
    for p in linear[::-1]:
        others = [q for q in linear if q is not p]
        if _follows(p, others):
            linear = others
    others = [p for p in ordered if not p.is_linear]
    return [*linear, *(p for p in told(others)
                       if not any(map(definite, _in_new_variables(p, linear))))]


def _follows(p: Any, others: list[Any]) -> bool:
    """Whether a linear form is a sum of positive shares of others and of positive numbers."""
    rows = np.array([[float(q.coeff(x)) for x in (1, *p.ring.gens)] for q in [p, *others]])
    positive = [x for x in p.ring.gens if definite(x)]
    units = np.eye(rows.shape[1])[[0, *(p.ring.gens.index(x) + 1 for x in positive)]]
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
