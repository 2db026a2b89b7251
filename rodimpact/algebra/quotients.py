"""Rational functions whose denominators are known in factors.

The denominators of a collision are products of few small factors, such as Z1 + Z2, to powers. Where
they are known, a sum needs no greatest common divisor: only factors that both terms have to the
same power can cancel, and a place where such a factor is 0 tells whether they do.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from math import gcd, prod
from typing import Any

from .numbers import PRIME, anywhere


class Quotient:
    """An integer polynomial over a whole number and powers of irreducible polynomials."""

    __slots__ = ("factors", "number", "numer")

    def __init__(self, numer: Any, number: int, factors: dict[Any, int]) -> None:
        common = gcd(number, int(numer.content()))
        self.numer = numer.quo_ground(common) if common > 1 else numer
        self.number, self.factors = number // common, factors if numer else {}

    @classmethod
    def of(cls, x: Fraction, ring: Any) -> Quotient:
        """A fraction."""
        return cls(ring(x.numerator), x.denominator, {})

    def __add__(self, other: Quotient) -> Quotient:
        return self._sum(other, 1)

    def __sub__(self, other: Quotient) -> Quotient:
        return self._sum(other, -1)

    def __mul__(self, other: Quotient) -> Quotient:
        left, yours = _cancelled(self.numer, other.factors, other.factors)
        right, mine = _cancelled(other.numer, self.factors, self.factors)
        powers = {f: mine.get(f, 0) + yours.get(f, 0) for f in {**mine, **yours}}
        return Quotient(left * right, self.number * other.number, powers)

    def __truediv__(self, other: Quotient) -> Quotient:
        content, factors = other.numer.factor_list()
        sign = -1 if content < 0 else 1
        upper = _product(other.numer.ring(sign * other.number), other.factors)
        return self * Quotient(upper, int(abs(content)), dict(factors))

    def _sum(self, other: Quotient, sign: int) -> Quotient:
        mine, yours = self.factors, other.factors
        powers = {f: max(mine.get(f, 0), yours.get(f, 0)) for f in {**mine, **yours}}
        left, right = (
            _product(x.numer, {f: n - x.factors.get(f, 0) for f, n in powers.items()}) * y.number
            for x, y in ((self, other), (other, self))
        )
        numer, powers = _cancelled(
            left + right * sign, powers, [f for f in powers if mine.get(f) == yours.get(f)])
        return Quotient(numer, self.number * other.number, powers)

    @property
    def denom(self) -> Any:
        """The denominator, multiplied out."""
        return _product(self.numer.ring(self.number), self.factors)


def _product(p: Any, powers: dict[Any, int]) -> Any:
    return prod((f**n for f, n in powers.items() if n), start=p)


def _cancelled(p: Any, powers: dict[Any, int], able: Iterable[Any]) -> tuple[Any, dict[Any, int]]:
    """Divide a polynomial by those able of the factors below it, as often as they go into it."""
    left = dict(powers)
    for f in able:
        while left.get(f) and p and _may_divide(f, p):
            quotient, rest = p.div(f)
            if rest:
                break
            p, left[f] = quotient, left[f] - 1
        if not left[f]:
            del left[f]
    return p, left


def _may_divide(f: Any, p: Any) -> bool:
    """Whether a polynomial is 0, modulo a prime, at some place where a factor is 0."""
    place = _root(f)
    return place is None or _at(p, place) == 0


@cache
def _root(f: Any) -> tuple[int, ...] | None:
    """A place of no sort where a polynomial is 0 modulo a prime; None if it is linear in none."""
    place = anywhere(f.ring.ngens)
    for i, x in enumerate(f.ring.gens):
        if f.degree(x) == 1:
            low, high = (_at(f, (*place[:i], end, *place[i + 1 :])) for end in (0, 1))
            place[i] = -low * pow(high - low, -1, PRIME) % PRIME
            return tuple(place)
    return None


def _at(p: Any, place: tuple[int, ...]) -> int:
    total = 0
    for powers, factor in p.terms():
        for x, n in zip(place, powers, strict=True):
            if n:
                factor = factor * pow(x, n, PRIME) % PRIME
        total += factor
    return int(total % PRIME)
