"""Tridiagonal equations of a row, which damping and lateral inertia make.

The row of node i is diagonal[i] x[i] - bound[i] x[i - 1] - bound[i + 1] x[i + 1], or x[i] where its
value is given. Pieces are not bound to each other, so that all of them are solved at once.
"""

from __future__ import annotations

from typing import Any


def factor(into: Any, inverse: Any, back: Any, bound: Any, diagonal: Any, held: Any) -> None:
    """Enter the multipliers of the elimination; `held` nodes have given values."""
    for i in range(len(diagonal)):
        into[i] = back[i] = 0.0
        inverse[i] = 1.0
        if held[i] == 0:
            pivot = diagonal[i]
            if i > 0:
                into[i] = bound[i] * inverse[i - 1]
                pivot -= bound[i] * back[i - 1]
            inverse[i] = 1 / pivot
            back[i] = bound[i + 1] * inverse[i]


def substitute(into: Any, inverse: Any, back: Any, x: Any) -> None:
    """Solve the equations: x holds their right sides and becomes the solution."""
    y = 0.0
    for i in range(len(x)):
        y = x[i] + into[i] * y
        x[i] = y
    y = 0.0
    for i in range(len(x) - 1, -1, -1):
        y = inverse[i] * x[i] + back[i] * y
        x[i] = y
