"""Numbers that carry their derivatives through the kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .numbers import Judged

RULES: dict[str, Callable[[Any, Any, Any, Any], tuple[Any, Any]]] = {
    "+": lambda x, dx, y, dy: (x + y, dx + dy),
    "-": lambda x, dx, y, dy: (x - y, dx - dy),
    "*": lambda x, dx, y, dy: (x * y, dx * y + x * dy),
    "/": lambda x, dx, y, dy: (x / y, (dx - x / y * dy) / y),
}


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

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.d)

    def __abs__(self) -> Any:  # kernels compare it, and do no more
        return abs(self.value)

    def __trunc__(self) -> Dual:  # time in whole ticks changes as time itself
        return Dual(int(self.value), self.d)
