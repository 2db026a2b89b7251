"""Tridiagonal equations of a row, which damping and lateral inertia make.

The row of node i is diagonal[i] x[i] - bound[i] x[i - 1] - bound[i + 1] x[i + 1], or x[i] where its
value is given. Pieces are not bound to each other, so that all of them are solved at once, from
both ends of the row to its middle: two recurrences that do not wait for each other.
"""

from __future__ import annotations

from typing import Any


def factor(into: Any, inverse: Any, back: Any, bound: Any, diagonal: Any, held: Any) -> None:
    """Enter the multipliers of the elimination; `held` nodes have given values.

    Those of the middle are for its neighbours: `into` for the left one, `back` for the right one.
    """
    n = len(diagonal)
    m = (n - 1) // 2
    for i in range(n):
        into[i] = back[i] = 0.0
        inverse[i] = 1.0
    for i, step in ((0, 1), (n - 1, -1)):
        nearer, farther = (0, 1) if step > 0 else (1, 0)
        while i != m:
            if held[i] == 0:
                pivot, before = diagonal[i], i - step
                if 0 <= before < n:  # not at the end of the row
                    into[i] = bound[i + nearer] * inverse[before]
                    pivot -= bound[i + nearer] * back[before]
                inverse[i] = 1 / pivot
                back[i] = bound[i + farther] * inverse[i]
            i += step
    if held[m] == 0:
        pivot = diagonal[m]
        if m > 0:
            into[m] = bound[m] * inverse[m - 1]
            pivot -= bound[m] * back[m - 1]
        if m < n - 1:
            back[m] = bound[m + 1] * inverse[m + 1]
            pivot -= bound[m + 1] * back[m + 1]
        inverse[m] = 1 / pivot


def substitute(into: Any, inverse: Any, back: Any, x: Any) -> None:
    """Solve the equations: x holds their right sides and becomes the solution."""
    n = len(x)
    m, last, y, z = (n - 1) // 2, n - 1, 0.0, 0.0
    if n % 2 == 0:  # there is a node more on the right
        z, last = x[last], last - 1
    for i in range(m):
        y = x[i] + into[i] * y
        z = x[last - i] + into[last - i] * z
        x[i], x[last - i] = y, z
    y = z = inverse[m] * (x[m] + into[m] * y + back[m] * z)
    x[m] = y
    for i in range(m - 1, -1, -1):
        y = inverse[i] * x[i] + back[i] * y
        z = inverse[last - i] * x[last - i] + back[last - i] * z
        x[i], x[last - i] = y, z
    if last < n - 1:
        x[n - 1] = inverse[n - 1] * x[n - 1] + back[n - 1] * z
