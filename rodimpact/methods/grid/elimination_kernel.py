"""Tridiagonal equations of a row, which damping and lateral inertia make.

The left side of equation i is x[i] where its value is prescribed, else

    diagonal[i] x[i] - off_diagonal[i] x[i - 1] - off_diagonal[i + 1] x[i + 1].

Pieces are not coupled to each other, so all of them are solved at once, from both ends
of the row to its middle: two recurrences that do not wait for each other. Seen from its
end, the node before i is i - 1 in the left half and i + 1 in the right half, and is
eliminated already.
"""

from typing import Any


def factor(
    off_diagonal: Any,
    diagonal: Any,
    is_prescribed: Any,
    lower: Any,
    inverse_diagonal: Any,
    upper: Any,
) -> None:
    """Store the LU factors of the equations, [node] each.

    They are `lower`, `inverse_diagonal` and `upper`. `is_prescribed` is 1 at nodes
    whose values are prescribed: their equation is x[i] = right side. The factors of the
    middle node are those of its neighbours: `lower` of the left one, `upper` of the
    right one.

    With the entries d of the diagonal and e of the off-diagonal towards the node before
    and f towards the one after it, the factors of a node are

        lower = e inverse_before,  inverse_diagonal = 1/(d - e upper_before),
        upper = f inverse_diagonal.
    """
    n = len(diagonal)
    m = (n - 1) // 2  # the middle node
    # `inverse_diagonal` and `upper` of the node before, in the left half
    left_inverse = 0.0
    left_share = 0.0
    for i in range(m):
        # Factors of a prescribed node; another one gets its own below
        lower[i] = 0.0
        inverse = 1.0
        share = 0.0
        if is_prescribed[i] == 0:
            lower[i] = off_diagonal[i] * left_inverse
            inverse = 1 / (diagonal[i] - off_diagonal[i] * left_share)
            share = off_diagonal[i + 1] * inverse
        inverse_diagonal[i] = inverse
        upper[i] = share
        left_inverse = inverse
        left_share = share
    # The same in the right half, where the node before i is i + 1
    right_inverse = 0.0
    right_share = 0.0
    for i in range(n - 1, m, -1):
        lower[i] = 0.0
        inverse = 1.0
        share = 0.0
        if is_prescribed[i] == 0:
            lower[i] = off_diagonal[i + 1] * right_inverse
            inverse = 1 / (diagonal[i] - off_diagonal[i + 1] * right_share)
            share = off_diagonal[i] * inverse
        inverse_diagonal[i] = inverse
        upper[i] = share
        right_inverse = inverse
        right_share = share
    lower[m] = 0.0
    upper[m] = 0.0
    inverse_diagonal[m] = 1.0
    if is_prescribed[m] == 0:
        lower[m] = off_diagonal[m] * left_inverse
        upper[m] = off_diagonal[m + 1] * right_inverse
        pivot = diagonal[m] - off_diagonal[m] * left_share
        pivot -= off_diagonal[m + 1] * right_share
        inverse_diagonal[m] = 1 / pivot


def substitute(lower: Any, inverse_diagonal: Any, upper: Any, x: Any) -> None:
    """Solve the equations: x holds their right sides and becomes the solution.

    The factors are those of `factor`. Node i of the left half goes together with node 2
    m - i of the right half, m the middle node. In the left half the recurrences are

        y[i] = x[i] + lower[i] y[i - 1] to the middle, and
        x[i] = inverse_diagonal[i] y[i] + upper[i] x[i + 1] back,

    and the same from the other side in the right half, whose values are z. The terms
    are added, as the off-diagonal entries of the equations are negative.
    """
    n = len(x)
    m = (n - 1) // 2  # the middle node
    last = 2 * m
    y = 0.0  # value of the node before in the left half
    z = 0.0  # the same in the right half
    # This is done once or not at all: an even n has one node more in the right half.
    for i in range(last + 1, n):
        z = x[i]
    for i in range(m):
        y = x[i] + lower[i] * y
        z = x[last - i] + lower[last - i] * z
        x[i] = y
        x[last - i] = z
    # The middle node has both neighbours before it.
    y = inverse_diagonal[m] * (x[m] + lower[m] * y + upper[m] * z)
    z = y
    x[m] = y
    for i in range(m - 1, -1, -1):
        y = inverse_diagonal[i] * x[i] + upper[i] * y
        z = inverse_diagonal[last - i] * x[last - i] + upper[last - i] * z
        x[i] = y
        x[last - i] = z
    for i in range(last + 1, n):  # once or not at all
        x[i] = inverse_diagonal[i] * x[i] + upper[i] * z
