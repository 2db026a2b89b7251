"""Tridiagonal equations of a row, which damping and lateral inertia make.

The left side of equation i is x[i] where its value is prescribed, else

    diagonal[i] x[i] - off_diagonal[i] x[i - 1] - off_diagonal[i + 1] x[i + 1].

Pieces are not coupled to each other, so all of them are
solved at once, from both ends of the row to its middle: two recurrences that do not wait for each
other.
"""

from typing import Any


def factor(
    off_diagonal: Any, diagonal: Any, prescribed: Any
) -> tuple[list[float], ...]:
    """LU factors of the equations: `lower`, `inverse_diagonal` and `upper`, each [node].

    `prescribed` is 1 at nodes whose values are prescribed. The factors of the middle node are those
    of its neighbours: `lower` of the left one, `upper` of the right one.
    """
    n = len(diagonal)
    m = (n - 1) // 2
    # The last entry is beside both ends.
    lower = [0.0] * (n + 1)
    inverse_diagonal = [0.0] * (n + 1)
    upper = [0.0] * (n + 1)
    for i in (*range(m), *range(n - 1, m, -1), m):
        inverse_diagonal[i] = 1.0
        if prescribed[i]:
            continue
        before = i - 1
        near = i
        far = i + 1
        if i > m:
            before = i + 1
            near = i + 1
            far = i
        lower[i] = off_diagonal[near] * inverse_diagonal[before]
        pivot = diagonal[i] - off_diagonal[near] * upper[before]
        if i == m:
            upper[i] = off_diagonal[far] * inverse_diagonal[far]
            pivot -= off_diagonal[far] * upper[far]
        inverse_diagonal[i] = 1 / pivot
        if i != m:
            upper[i] = off_diagonal[far] * inverse_diagonal[i]
    return lower[:n], inverse_diagonal[:n], upper[:n]


def substitute(lower: Any, inverse_diagonal: Any, upper: Any, x: Any) -> None:
    """Solve the equations: x holds their right sides and becomes the solution."""
    n = len(x)
    m = (n - 1) // 2
    last = 2 * m
    y = 0.0
    z = 0.0
    for i in range(last + 1, n):  # an even number has one node more on the right
        z = x[i]
    for i in range(m):
        y = x[i] + lower[i] * y
        z = x[last - i] + lower[last - i] * z
        x[i] = y
        x[last - i] = z
    y = inverse_diagonal[m] * (x[m] + lower[m] * y + upper[m] * z)
    z = y
    x[m] = y
    for i in range(m - 1, -1, -1):
        y = inverse_diagonal[i] * x[i] + upper[i] * y
        z = inverse_diagonal[last - i] * x[last - i] + upper[last - i] * z
        x[i] = y
        x[last - i] = z
    for i in range(last + 1, n):
        x[i] = inverse_diagonal[i] * x[i] + upper[i] * z
