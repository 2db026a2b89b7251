"""Numbers that carry their derivatives through the kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .numbers import Judged


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

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.d)

    def __abs__(self) -> Any:  # kernels compare it, and do no more
        return abs(self.value)

    def __trunc__(self) -> Dual:  # time in whole ticks changes as time itself
        return Dual(int(self.value), self.d)


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
        other = (y.value, y.d) if type(y) is Dual else (y, 0.0)
        return Dual(*rule(x.value, x.d, *other))

    setattr(Dual, f"__{name}__", forward)
    setattr(Dual, f"__r{name}__", lambda y, x: Dual(*rule(x, 0.0, y.value, y.d)))


for _name in RULES:
    _derived(_name)
