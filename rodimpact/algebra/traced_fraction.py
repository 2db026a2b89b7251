"""Fractions that record how they were computed.

A kernel runs on a `TracedFraction` as on a float, and decides every branch by its
value, a fraction. The traced fraction also keeps the operation that made it and the
operands, back to the named numbers of the model. A `Program` evaluates this history
again, with other values of the names or with symbols. A result that depends on no name
is a constant without a history.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from .checks import FormulaTooLong

BinaryFunction = Callable[[Any, Any], Any]
Expression = None | str | tuple[str, "TracedFraction", "TracedFraction"]

HALF = Fraction(1, 2)
HEAVISIDE = "H"
"""The operation H(x) y with the unit step H: 0 if x is negative, else y."""
NEUTRAL = {"+": 0, "-": 0, "*": 1, "/": 1}
"""Right operand of each operation that changes nothing."""
MAX_BITS = 1 << 16
"""Largest number of binary digits of a denominator: then an event takes 10 ms."""
COMMUTATIVE = "+*"
"""Operations in which a left operand with this value changes nothing, either."""


def _heaviside(x: Any, y: Any) -> Any:
    """H(x) y for numbers or arrays: 0 where x is negative, else y."""
    return (x >= 0) * y


FUNCTIONS: dict[str, BinaryFunction] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    HEAVISIDE: _heaviside,
}


def _comparison(compare: BinaryFunction) -> Callable[[Any, Any], bool]:
    """Make a method that compares the value with a number or with a traced fraction.

    The method returns a bool, and no history records the comparison.
    """

    def method(x: TracedFraction, y: Any) -> bool:
        other = y
        if isinstance(y, TracedFraction):
            other = y.value
        return bool(compare(x.value, other))

    return method


def _method(operation: str) -> Callable[[TracedFraction, Any], TracedFraction]:
    """Make a method for an operation whose left operand is the traced fraction."""

    def method(left: TracedFraction, right: Any) -> TracedFraction:
        return TracedFraction.combine(operation, left, right)

    return method


def _reflected_method(
    operation: str,
) -> Callable[[TracedFraction, Any], TracedFraction]:
    """Make a method for an operation whose right operand is the traced fraction."""

    def method(right: TracedFraction, left: Any) -> TracedFraction:
        return TracedFraction.combine(operation, left, right)

    return method


class TracedFraction:
    """A fraction with its history.

    Attributes
    ----------
    value : Fraction
    expression : None, str or tuple
        None for a constant, the name of a named number, or
        ``(operation, left, right)`` with two traced fractions.
    """

    __slots__ = ("expression", "value")

    def __init__(self, value: Any, expression: Expression = None) -> None:
        """Take any value of which a fraction can be made; a constant by default."""
        if type(value) is not Fraction:
            value = Fraction(value)
        self.value = value
        self.expression = expression

    @staticmethod
    def combine(operation: str, x: Any, y: Any) -> TracedFraction:
        """Apply an operation; return an operand itself if the other changes nothing.

        Only constants are simplified: a named number may be 0 or 1 by chance. The
        constant 0 divided by anything is 0, whatever value the divisor has, even 0. Any
        other division by 0 raises ZeroDivisionError.
        """
        left = x if isinstance(x, TracedFraction) else TracedFraction(x)
        right = y if isinstance(y, TracedFraction) else TracedFraction(y)
        if right.expression is None:
            if right.value == NEUTRAL[operation]:  # x + 0, x - 0, x 1, x/1
                return left
            if right.value == 0 and operation == "*":  # x 0
                return ZERO
        if left.expression is None:
            if operation in COMMUTATIVE and left.value == NEUTRAL[operation]:
                return right  # 0 + y, 1 y
            if left.value == 0 and operation in "*/":  # 0 y, 0/y
                return ZERO
        return _computed(operation, left, right)

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

    def __neg__(self) -> TracedFraction:
        return 0 - self

    def __abs__(self) -> TracedFraction:
        if self.value < 0:
            return -self
        return self

    def __trunc__(self) -> TracedFraction:
        """Subtract 1/2, without truncation.

        Kernels round a time t to trunc(t + 1/2). Exact times need no rounding, so the
        result is t itself.
        """
        return TracedFraction.combine("-", self, HALF)

    def __int__(self) -> int:
        return int(self.value)

    def __float__(self) -> float:
        return float(self.value)


ZERO = TracedFraction(0)


def _computed(
    operation: str, left: TracedFraction, right: TracedFraction
) -> TracedFraction:
    """Apply an operation to values and histories; two constants make a constant.

    FormulaTooLong is raised if the value of a number that depends on names is too long.
    """
    value = FUNCTIONS[operation](left.value, right.value)
    if left.expression is None and right.expression is None:
        return TracedFraction(value)
    if value.denominator.bit_length() > MAX_BITS:
        message = (
            "fractions of a formula in these are too long: a denominator has more than "
            f"{MAX_BITS} binary digits; name fewer numbers"
        )
        raise FormulaTooLong([("symbols", message)])
    return TracedFraction(value, (operation, left, right))


def heaviside_times(x: TracedFraction, y: TracedFraction) -> TracedFraction:
    """Compute H(x) y with the unit step H: 0 if x is negative, else y.

    The step stays in the history, so it is decided anew for other values of the names.
    """
    return _computed(HEAVISIDE, x, y)


class Constant(NamedTuple):
    """Step of a program: a number."""

    value: Any  # a fraction, or the kind of number of the program


class Name(NamedTuple):
    """Step of a program: the value that is given for a name."""

    name: str


class Operation(NamedTuple):
    """Step of a program: a function of the results of two earlier steps."""

    function: BinaryFunction
    left: int  # index of the step of the left operand
    right: int


Step = Constant | Name | Operation


class Program:
    """Operations that compute traced fractions again for other values of the names.

    Parameters
    ----------
    wanted : list of TracedFraction
        Numbers to compute.
    constant : callable
        Converts a fraction to the kind of number that stands for the names.
    """

    def __init__(
        self, wanted: list[TracedFraction], constant: Callable[[Fraction], Any]
    ) -> None:
        """List the steps of the histories in order: operands before their operation.

        Equal steps, also of different numbers, become one.
        """
        index_of_step: dict[Step, int] = {}  # equal steps are computed once
        index_of: dict[int, int] = {}  # step of each traced fraction, by its id
        pending = wanted[::-1]  # a stack, reversed so that the first number comes first
        while pending:
            x = pending.pop()
            operands: tuple[TracedFraction, ...] = ()
            if isinstance(x.expression, tuple):
                operands = x.expression[1:]
            missing = [y for y in operands if id(y) not in index_of]
            if missing:  # x goes back on the stack, below its missing operands
                pending += [x, *missing]
                continue
            step = _step_of(x, index_of)
            next_index = len(index_of_step)
            index_of[id(x)] = index_of_step.setdefault(step, next_index)
        self._steps: list[Step] = []
        for step in index_of_step:
            if isinstance(step, Constant):
                step = Constant(constant(step.value))
            self._steps.append(step)
        self._wanted = [index_of[id(x)] for x in wanted]

    def __call__(
        self,
        names: Mapping[str, Any],
        before_operation: Callable[[Any, Any], None] | None = None,
    ) -> list[Any]:
        """Compute the wanted numbers, in their order.

        Parameters
        ----------
        names : mapping of str
            Fraction, symbol or array for each name.
        before_operation : callable, optional
            Called with the two operands before each operation.
        """
        results: list[Any] = []
        for step in self._steps:
            if isinstance(step, Operation):
                left = results[step.left]
                right = results[step.right]
                if before_operation is not None:
                    before_operation(left, right)
                results.append(step.function(left, right))
            elif isinstance(step, Name):
                results.append(names[step.name])
            else:
                results.append(step.value)
        return [results[index] for index in self._wanted]


def _step_of(x: TracedFraction, index_of: Mapping[int, int]) -> Step:
    """Step that computes a traced fraction.

    Its operands are computed by earlier steps: `index_of` has the index of this step
    for the id of each operand.
    """
    if x.expression is None:
        return Constant(x.value)
    if isinstance(x.expression, str):
        return Name(x.expression)
    operation, left, right = x.expression
    return Operation(FUNCTIONS[operation], index_of[id(left)], index_of[id(right)])
