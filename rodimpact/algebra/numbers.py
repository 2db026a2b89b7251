"""Numbers that carry more through the kernels: how they were made, or their derivatives.

A `Number` is a fraction, and the operation and operands it came from, back to the named numbers of
the model. Every branch of a kernel is taken on the fractions, and what was computed can afterwards
be evaluated for other numbers, or in symbols. What depends on no name is a mere fraction. A `Dual`
is a float or a whole number with its derivatives.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "since": lambda passed, x: (passed >= 0) * x,
}
NEUTRAL = {"+": 0, "-": 0, "*": 1, "/": 1}
"""By operation, the right operand that changes nothing."""
# value and derivatives of what an operation makes of x and y, whose derivatives are dx and dy
RULES: dict[str, Callable[[Any, Any, Any, Any], tuple[Any, Any]]] = {
    "+": lambda x, dx, y, dy: (x + y, dx + dy),
    "-": lambda x, dx, y, dy: (x - y, dx - dy),
    "*": lambda x, dx, y, dy: (x * y, dx * y + x * dy),
    "/": lambda x, dx, y, dy: (x / y, (dx - x / y * dy) / y),
}
HALF = Fraction(1, 2)


def _judged(compare: Callable[[Any, Any], Any]) -> Callable[[Any, Any], bool]:
    return lambda x, y: bool(compare(x.value, y.value if isinstance(y, Judged) else y))


def _both_sides(
    operation: str,
) -> tuple[Callable[[Any, Any], Any], Callable[[Any, Any], Any]]:
    return (lambda x, y: x.combine(operation, x, y)), (
        lambda y, x: y.combine(operation, x, y)
    )


class Judged:
    """A number that carries more: kernels decide by its value alone.

    What an operation makes of two such numbers is what `combine` of their class says.
    """

    __slots__ = ()
    value: Any
    combine: Callable[[str, Any, Any], Any]

    __eq__, __lt__, __le__, __gt__, __ge__ = map(
        _judged, (operator.eq, operator.lt, operator.le, operator.gt, operator.ge)
    )
    (
        (__add__, __radd__),
        (__sub__, __rsub__),
        (__mul__, __rmul__),
        (__truediv__, __rtruediv__),
    ) = map(_both_sides, NEUTRAL)
    __hash__ = None  # type: ignore[assignment]

    def __neg__(self) -> Any:
        return 0 - self

    def __int__(self) -> int:
        return int(self.value)


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

    @staticmethod
    def combine(operation: str, x: Any, y: Any) -> Number:
        """What an operation makes of two numbers; one of them where the other changes nothing."""
        a = x if isinstance(x, Number) else Number(x)
        b = y if isinstance(y, Number) else Number(y)
        left, right = a.made or a.value, b.made or b.value
        if right == NEUTRAL[operation]:
            return a
        if operation in "+*" and left == NEUTRAL[operation]:
            return b
        if (left == 0 and operation in "*/") or (right == 0 and operation == "*"):
            return ZERO
        return _made(operation, a, b)

    def __abs__(self) -> Number:
        return -self if self.value < 0 else self

    def __trunc__(self) -> Number:
        """Time in whole ticks is truncated half a tick later; exact time needs no ticks."""
        return Number.combine("-", self, HALF)

    def __float__(self) -> float:
        return float(self.value)


ZERO = Number(0)


def _made(operation: str, a: Number, b: Number) -> Number:
    value = OPERATIONS[operation](a.value, b.value)
    return Number(value, (operation, a, b) if a.made or b.made else ())


class Dual(Judged):
    """A number, whole or not, and its derivatives in some directions.

    Attributes
    ----------
    value : int or float
    d : float or array
        Derivatives, [direction]; 0.0 where nothing changes.
    """

    __slots__ = ("d", "value")

    def __init__(self, value: Any, d: Any = 0.0) -> None:
        self.value, self.d = value, d

    @staticmethod
    def combine(operation: str, a: Any, b: Any) -> Dual:
        """What an operation makes of two numbers, by the rules of derivatives."""
        x, dx = (a.value, a.d) if type(a) is Dual else (a, 0.0)
        y, dy = (b.value, b.d) if type(b) is Dual else (b, 0.0)
        return Dual(*RULES[operation](x, dx, y, dy))

    def __abs__(self) -> Any:  # kernels compare it, and do no more
        return abs(self.value)

    def __trunc__(self) -> Dual:  # time in whole ticks changes as time itself
        return Dual(int(self.value), self.d)


def since(passed: Number, x: Number, told: bool) -> Number:
    """`x` if this time is not negative, else 0; if `told` that is decided by what it is here."""
    if told:
        return x if passed >= 0 else ZERO
    return _made("since", passed, x)


class Program:
    """Numbers to be computed anew for other values of the names, again and again.

    Parameters
    ----------
    wanted : list of Number
    constant : callable
        Makes of a fraction what goes with what stands for the names.
    """

    def __init__(
        self, wanted: list[Number], constant: Callable[[Fraction], Any]
    ) -> None:
        places: dict[tuple[Any, ...], int] = {}
        at: dict[int, int] = {}
        stack = wanted[::-1]
        while stack:
            x = stack.pop()
            missing = [y for y in x.made[1:] if id(y) not in at]
            if missing:  # operands go first
                stack += [x, *missing]
                continue
            step: tuple[Any, ...] = x.made or (None, x.value)
            if len(step) == 3:
                step = OPERATIONS[step[0]], at[id(step[1])], at[id(step[2])]
            at[id(x)] = places.setdefault(step, len(places))
        self._steps = [
            (None, constant(step[1])) if step[0] is None else step for step in places
        ]
        self._wanted = [at[id(x)] for x in wanted]

    def __call__(
        self,
        names: Mapping[str, Any],
        before: Callable[[Any, Any], None] | None = None,
    ) -> list[Any]:
        """Compute them of what stands for each name: fractions, symbols or arrays.

        The function `before` is called with the operands of each operation.
        """
        found: list[Any] = []
        for step in self._steps:
            if len(step) == 3:
                if before is not None:
                    before(found[step[1]], found[step[2]])
                found.append(step[0](found[step[1]], found[step[2]]))
            else:
                found.append(names[step[0]] if len(step) == 1 else step[1])
        return [found[i] for i in self._wanted]
