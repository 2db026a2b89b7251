"""Tridiagonal equations of a row, which damping and lateral inertia make.

The row of node i is diagonal[i] x[i] - bound[i] x[i - 1] - bound[i + 1] x[i + 1], or x[i] where its
value is given. Pieces are not bound to each other, so that all of them are solved at once, from
both ends of the row to its middle: two recurrences that do not wait for each other.
"""

from typing import Any


def factor(bound: Any, diagonal: Any, held: Any) -> tuple[list[float], ...]:
    """Multipliers `into`, `inverse` and `back` of the elimination; `held` nodes have given values.

    Those of the middle are for its neighbours: `into` for the left one, `back` for the right one.
    """
    n = len(diagonal)
    m = (n - 1) // 2
    into, inverse, back = (
        [0.0] * (n + 1) for _ in range(3)
    )  # the last is beside both ends
    for i in (*range(m), *range(n - 1, m, -1), m):
        inverse[i] = 1.0
        if held[i]:
            continue
        before, near, far = (i - 1, i, i + 1) if i <= m else (i + 1, i + 1, i)
        into[i] = bound[near] * inverse[before]
        pivot = diagonal[i] - bound[near] * back[before]
        if i == m:
            back[i] = bound[far] * inverse[far]
            pivot -= bound[far] * back[far]
        inverse[i] = 1 / pivot
        if i != m:
            back[i] = bound[far] * inverse[i]
    return into[:n], inverse[:n], back[:n]


def substitute(into: Any, inverse: Any, back: Any, x: Any) -> None:
    """Solve the equations: x holds their right sides and becomes the solution."""
    n = len(x)
    m, y, z = (n - 1) // 2, 0.0, 0.0
    last = 2 * m
    for i in range(last + 1, n):  # an even number has a node more on the right
        z = x[i]
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
    for i in range(last + 1, n):
        x[i] = inverse[i] * x[i] + back[i] * z
