"""Fractions that remember how they were computed.

Kernels run on a `Number` as on a float, and decide every branch by its value, a fraction. A
`Number` also keeps its operation and operands, back to the named numbers of the model. A `Program`
evaluates this history again: for other values of the names, or in symbols. A result that depends on
no name is a fraction without a history.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

Operation = Callable[[Any, Any], Any]

OPERATIONS: dict[str, Operation] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "since": lambda passed, x: (passed >= 0) * x,
}
NEUTRAL = {"+": 0, "-": 0, "*": 1, "/": 1}
"""Right operand of each operation that changes nothing."""
HALF = Fraction(1, 2)


def _comparison(compare: Operation) -> Callable[[Any, Any], bool]:
    """Method that compares the value with a number or with the value of a `Number`."""

    def method(x: Number, y: Any) -> bool:
        other = y.value if isinstance(y, Number) else y
        return bool(compare(x.value, other))

    return method


def _method(operation: str) -> Callable[[Number, Any], Number]:
    """Method for an operation whose left operand is the number."""
    return lambda left, right: Number.combine(operation, left, right)


def _reflected_method(operation: str) -> Callable[[Number, Any], Number]:
    """Method for an operation whose right operand is the number."""
    return lambda right, left: Number.combine(operation, left, right)


class Number:
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
        """Apply an operation; return the other operand if one of them changes nothing."""
        a = x if isinstance(x, Number) else Number(x)
        b = y if isinstance(y, Number) else Number(y)
        left = a.made or a.value
        right = b.made or b.value
        if right == NEUTRAL[operation]:
            return a
        if operation in "+*" and left == NEUTRAL[operation]:
            return b
        if (left == 0 and operation in "*/") or (right == 0 and operation == "*"):
            return ZERO
        return _computed(operation, a, b)

    __eq__ = _comparison(operator.eq)
    __lt__ = _comparison(operator.lt)
    __le__ = _comparison(operator.le)
    __gt__ = _comparison(operator.gt)
    __ge__ = _comparison(operator.ge)
    __hash__ = None  # type: ignore[assignment]

    __add__ = _method("+")
    __radd__ = _reflected_method("+")
    __sub__ = _method("-")
    __rsub__ = _reflected_method("-")
    __mul__ = _method("*")
    __rmul__ = _reflected_method("*")
    __truediv__ = _method("/")
    __rtruediv__ = _reflected_method("/")

    def __neg__(self) -> Number:
        return 0 - self

    def __abs__(self) -> Number:
        return -self if self.value < 0 else self

    def __trunc__(self) -> Number:
        """Undo half a tick: kernels round a time by trunc(t + 1/2), and exact times need none."""
        return Number.combine("-", self, HALF)

    def __int__(self) -> int:
        return int(self.value)

    def __float__(self) -> float:
        return float(self.value)


ZERO = Number(0)


def _computed(operation: str, a: Number, b: Number) -> Number:
    value = OPERATIONS[operation](a.value, b.value)
    has_history = a.made or b.made
    return Number(value, (operation, a, b) if has_history else ())


def since(passed: Number, x: Number, decided: bool) -> Number:
    """Compute H(passed) x, with H the unit step: 0 for negative numbers, else 1.

    If `decided`, H is taken from the value in this run. Otherwise it stays in the history.
    """
    if decided:
        return x if passed >= 0 else ZERO
    return _computed("since", passed, x)


class Program:
    """Operations that compute numbers again for other values of the names.

    Parameters
    ----------
    wanted : list of Number
        Numbers to compute.
    constant : callable
        Converts a fraction to the kind of number that stands for the names.
    """

    def __init__(
        self, wanted: list[Number], constant: Callable[[Fraction], Any]
    ) -> None:
        places: dict[tuple[Any, ...], int] = {}  # place of each step in the program
        place_of: dict[int, int] = {}  # the same by id of the number
        stack = wanted[::-1]
        while stack:
            x = stack.pop()
            missing = [y for y in x.made[1:] if id(y) not in place_of]
            if missing:  # operands go first
                stack += [x, *missing]
                continue
            step: tuple[Any, ...] = x.made or (None, x.value)
            if len(step) == 3:
                operation, left, right = step
                step = (
                    OPERATIONS[operation],
                    place_of[id(left)],
                    place_of[id(right)],
                )
            place_of[id(x)] = places.setdefault(step, len(places))
        self._steps: list[tuple[Any, ...]] = []
        for step in places:
            if step[0] is None:
                step = (None, constant(step[1]))
            self._steps.append(step)
        self._wanted = [place_of[id(x)] for x in wanted]

    def __call__(
        self,
        names: Mapping[str, Any],
        before: Callable[[Any, Any], None] | None = None,
    ) -> list[Any]:
        """Compute the numbers from a fraction, symbol or array for each name.

        The function `before` is called with the operands of each operation.
        """
        results: list[Any] = []
        for step in self._steps:
            if len(step) == 3:
                operation, left, right = step
                if before is not None:
                    before(results[left], results[right])
                results.append(operation(results[left], results[right]))
            elif len(step) == 1:
                results.append(names[step[0]])
            else:
                results.append(step[1])
        return [results[place] for place in self._wanted]
