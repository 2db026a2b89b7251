"""Numbers without rounding that know how they were made.

A `Number` is a fraction, and the operation and operands it came from, back to the named numbers of
the model. The kernels run on it: every branch is taken on the fractions, and what was computed can
afterwards be evaluated for other numbers, or in symbols. What depends on no name is a mere
fraction.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal, localcontext
from fractions import Fraction
from random import Random
from typing import Any

OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "since": lambda passed, x: (passed >= 0) * x,
}
HALF = Fraction(1, 2)
DECIMALS = 150  # with which formulas are evaluated to be told apart


class Judged:
    """A number that carries more: kernels decide by its value alone."""

    __slots__ = ()
    value: Any

    def __int__(self) -> int:
        return int(self.value)

    def __eq__(self, other: object) -> bool:
        return bool(self.value == value_of(other))

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < value_of(other))

    def __le__(self, other: Any) -> bool:
        return bool(self.value <= value_of(other))

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > value_of(other))

    def __ge__(self, other: Any) -> bool:
        return bool(self.value >= value_of(other))

    __hash__ = None  # type: ignore[assignment]


class Number(Judged):
    """A fraction with its history.

    Attributes
    ----------
    value : Fraction
    made : tuple
        ``(operation, left, right)``, ``(name,)`` of a number that has a name, or ``()``.
    """

    __slots__ = ("made", "value")

    def __init__(self, value: Any, made: tuple[Any, ...] = ()) -> None:
        self.value = value if type(value) is Fraction else Fraction(value)
        self.made = made

    def __add__(self, other: Any) -> Number:
        right = number(other)
        if not right.made and not right.value:
            return self
        if not self.made and not self.value:
            return right
        return _made("+", self, right)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Number:
        other = number(other)
        return self if not other.made and not other.value else _made("-", self, other)

    def __rsub__(self, other: Any) -> Number:
        return number(other) - self

    def __mul__(self, other: Any) -> Number:
        other = number(other)
        for a, b in ((self, other), (other, self)):
            if not a.made and a.value in (0, 1):
                return b if a.value else ZERO
        return _made("*", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Number:
        if not self.made and not self.value:
            return ZERO
        return _made("/", self, number(other))

    def __rtruediv__(self, other: Any) -> Number:
        return number(other) / self

    def __neg__(self) -> Number:
        return ZERO - self

    def __abs__(self) -> Number:
        return -self if self.value < 0 else self

    def __trunc__(self) -> Number:
        """Time in whole ticks is truncated half a tick later; exact time needs no ticks."""
        return self - HALF

    def __float__(self) -> float:
        return float(self.value)


ZERO = Number(0)


def number(x: Any) -> Number:
    """Take `x` as a number without a history, unless it has one."""
    return x if isinstance(x, Number) else Number(x)


def value_of(x: Any) -> Any:
    """The value of a number that carries more; others as they are."""
    return x.value if isinstance(x, Judged) else x


def _made(operation: str, a: Number, b: Number) -> Number:
    value = OPERATIONS[operation](a.value, b.value)
    return Number(value, (operation, a, b) if a.made or b.made else ())


def since(passed: Number, x: Number, told: bool) -> Number:
    """`x` if this time is not negative, else 0; if `told` that is decided by what it is here."""
    if told:
        return x if passed >= 0 else ZERO
    return _made("since", passed, x)


def steps_to(wanted: Iterable[Number]) -> list[Number]:
    """All numbers from which the wanted ones were made, and these, each after its operands."""
    done: dict[int, Number] = {}
    stack = list(wanted)[::-1]
    while stack:
        x = stack[-1]
        missing = [y for y in x.made[1:] if id(y) not in done]
        if missing and id(x) not in done:
            stack += missing
        else:
            done.setdefault(id(x), stack.pop())
    return list(done.values())


class Program:
    """Numbers to be computed anew for other values of the names, again and again.

    Parameters
    ----------
    wanted : list of Number
    constant : callable
        Makes of a fraction what goes with what stands for the names.
    """

    def __init__(self, wanted: list[Number], constant: Callable[[Fraction], Any]) -> None:
        self._steps: list[tuple[Any, ...]] = []
        places: dict[Any, int] = {}
        at: dict[int, int] = {}
        for x in steps_to(wanted):
            step: tuple[Any, ...] = (None, x.value)
            if len(x.made) == 3:
                operation, a, b = x.made
                step = OPERATIONS[operation], at[id(a)], at[id(b)]
            elif x.made:
                step = x.made
            at[id(x)] = places.setdefault(step, len(places))
            if len(places) > len(self._steps):
                self._steps.append((None, constant(x.value)) if step[0] is None else step)
        self._wanted = [at[id(x)] for x in wanted]

    def __call__(self, names: Mapping[str, Any]) -> list[Any]:
        """Compute them of what stands for each name: fractions, symbols or arrays."""
        found: list[Any] = []
        for step in self._steps:
            if len(step) == 3:
                found.append(step[0](found[step[1]], found[step[2]]))
            else:
                found.append(names[step[0]] if len(step) == 1 else step[1])
        return [found[i] for i in self._wanted]


def evaluate(
    wanted: list[Number], names: Mapping[str, Any], constant: Callable[[Fraction], Any]
) -> list[Any]:
    """Compute numbers anew, once; see `Program`."""
    return Program(wanted, constant)(names)


def mark(wanted: list[Number], names: Iterable[str]) -> tuple[Decimal, ...]:
    """What tells formulas apart: their values, to 40 decimals, where names are of no sort."""
    random = Random(1867)
    with localcontext(prec=DECIMALS):
        there = {name: Decimal(1 + random.random()) for name in names}
        found = evaluate(wanted, there, lambda x: Decimal(x.numerator) / x.denominator)
        return tuple(round(x, 40) for x in found)
