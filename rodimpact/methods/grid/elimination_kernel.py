"""Tridiagonal equations of a row, needed with damping and lateral inertia.

The left side of equation i is x[i] if its value is prescribed, else

    diagonal[i] x[i] - off_diagonal[i] x[i - 1] - off_diagonal[i + 1] x[i + 1].

Pieces are not coupled to each other, so all of them are solved at once, from both ends
of the row to its middle. The two recurrences are independent, which is faster. "The
node before i", which is already eliminated, is i - 1 in the left half and i + 1 in the
right half.
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
    """Write the LU factors of the equations to the last three arguments, [node] each.

    Elimination goes from both ends of the row to its middle node. `off_diagonal` [cell]
    has the entries of the matrix with opposite sign; cell i is on the left of node i,
    and there is one cell more than nodes. `is_prescribed` is 1 at nodes whose values
    are prescribed: their equation is x[i] = right side, and their factors are 0, 1 and
    0.

    With the entry d of `diagonal`, and the entries e, towards the node before, and f,
    towards the node after it, of `off_diagonal`, the factors of a node are

        lower = e inverse_before,  inverse_diagonal = 1/(d - e upper_before),
        upper = f inverse_diagonal.

    The middle node has two nodes before it and none after it: its `lower` belongs to
    the left one, and its `upper` is e inverse_before of the right one.
    """
    n = len(diagonal)
    # The middle node. The left half is empty if n is 1 or 2, the right half if n is 1:
    # the factors of the missing node count as 0.
    m = (n - 1) // 2
    # Left half: `inverse_diagonal` and `upper` of the node before i, which is i - 1
    inverse_before = 0.0
    upper_before = 0.0
    for i in range(m):
        # Factors of a prescribed node; those of any other node follow below.
        lower[i] = 0.0
        inverse = 1.0
        upper_here = 0.0
        if is_prescribed[i] == 0:
            lower[i] = off_diagonal[i] * inverse_before
            inverse = 1 / (diagonal[i] - off_diagonal[i] * upper_before)
            upper_here = off_diagonal[i + 1] * inverse
        inverse_diagonal[i] = inverse
        upper[i] = upper_here
        inverse_before = inverse
        upper_before = upper_here
    # Values of the node on the left of the middle node
    left_inverse = inverse_before
    left_upper = upper_before
    # Right half: the same, where the node before i is i + 1
    inverse_before = 0.0
    upper_before = 0.0
    for i in range(n - 1, m, -1):
        lower[i] = 0.0
        inverse = 1.0
        upper_here = 0.0
        if is_prescribed[i] == 0:
            lower[i] = off_diagonal[i + 1] * inverse_before
            inverse = 1 / (diagonal[i] - off_diagonal[i + 1] * upper_before)
            upper_here = off_diagonal[i] * inverse
        inverse_diagonal[i] = inverse
        upper[i] = upper_here
        inverse_before = inverse
        upper_before = upper_here
    # Values of the node on the right of the middle node
    right_inverse = inverse_before
    right_upper = upper_before
    # Middle node: both neighbours are before it.
    lower[m] = 0.0
    upper[m] = 0.0
    inverse_diagonal[m] = 1.0
    if is_prescribed[m] == 0:
        lower[m] = off_diagonal[m] * left_inverse
        upper[m] = off_diagonal[m + 1] * right_inverse
        pivot = diagonal[m] - off_diagonal[m] * left_upper
        pivot -= off_diagonal[m + 1] * right_upper
        inverse_diagonal[m] = 1 / pivot


def substitute(lower: Any, inverse_diagonal: Any, upper: Any, x: Any) -> None:
    """Solve the equations: x has their right sides and becomes the solution.

    The factors are those of `factor`. Both halves of the row are solved at once: node i
    of the left half together with its mirror node 2 m - i in the right half, where m is
    the middle node. In the left half the recurrences are

        y[i] = x[i] + lower[i] y[i - 1] towards the middle, and
        x[i] = inverse_diagonal[i] y[i] + upper[i] x[i + 1] back to the end.

    In the right half they are the same from the other side, with z in place of y. Terms
    are added, not subtracted, as the off-diagonal entries of the equations are
    negative.
    """
    n = len(x)
    m = (n - 1) // 2  # the middle node
    last = 2 * m  # mirror of node 0
    # Towards the middle. y and z belong to the node before, in the left and right half.
    y = 0.0
    z = 0.0
    # If n is even, the last node has no mirror node. It comes first; the loop stands
    # for a condition, as it runs once or not at all.
    for i in range(last + 1, n):
        z = x[i]
    for i in range(m):
        mirror = last - i
        y = x[i] + lower[i] * y
        z = x[mirror] + lower[mirror] * z
        x[i] = y
        x[mirror] = z
    # Both neighbours of the middle node are before it; `upper` is for the right one.
    x_middle = inverse_diagonal[m] * (x[m] + lower[m] * y + upper[m] * z)
    x[m] = x_middle
    # Back to the ends. These are the solutions at the node after i, in the left and
    # right half.
    x_left = x_middle
    x_right = x_middle
    for i in range(m - 1, -1, -1):
        mirror = last - i
        x_left = inverse_diagonal[i] * x[i] + upper[i] * x_left
        x_right = inverse_diagonal[mirror] * x[mirror] + upper[mirror] * x_right
        x[i] = x_left
        x[mirror] = x_right
    for i in range(last + 1, n):  # the node without a mirror comes last
        x[i] = inverse_diagonal[i] * x[i] + upper[i] * x_right
