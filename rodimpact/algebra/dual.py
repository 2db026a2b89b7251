"""Numbers that carry their derivatives through the kernels."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any


class Dual:
    """A number, whole or not, and its derivatives in some directions.

    Kernels take every decision on the number alone, as they do without derivatives.

    Attributes
    ----------
    v : int or float
    d : float or array
        Derivatives, [direction]; 0.0 where nothing changes.
    """

    __slots__ = ("d", "v")

    def __init__(self, v: Any, d: Any = 0.0) -> None:
        self.v, self.d = v, d

    def __neg__(self) -> Dual:
        return Dual(-self.v, -self.d)

    def __abs__(self) -> Any:  # kernels compare it, and do no more
        return abs(self.v)

    def __int__(self) -> int:
        return int(self.v)

    def __trunc__(self) -> Dual:  # time in whole ticks changes as time itself
        return Dual(int(self.v), self.d)


RULES: dict[str, Callable[[Any, Any, Any, Any], tuple[Any, Any]]] = {
    "add": lambda x, dx, y, dy: (x + y, dx + dy),
    "sub": lambda x, dx, y, dy: (x - y, dx - dy),
    "mul": lambda x, dx, y, dy: (x * y, dx * y + x * dy),
    "truediv": lambda x, dx, y, dy: (x / y, (dx - x / y * dy) / y),
}


def _derived(name: str) -> None:
    """Give `Dual` an operation, with a number on either side."""
    rule = RULES[name]

    def forward(x: Dual, y: Any) -> Dual:
        return Dual(*(rule(x.v, x.d, y.v, y.d) if type(y) is Dual else rule(x.v, x.d, y, 0.0)))

    setattr(Dual, f"__{name}__", forward)
    setattr(Dual, f"__r{name}__", lambda y, x: Dual(*rule(x, 0.0, y.v, y.d)))


def _compared(name: str) -> None:
    compare = getattr(operator, name)
    setattr(Dual, f"__{name}__",
            lambda x, y: compare(x.v, y.v if type(y) is Dual else y))


for _name in RULES:
    _derived(_name)
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    _compared(_name)
