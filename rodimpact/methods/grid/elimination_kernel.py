"""Tridiagonal equations of a piece, eliminated from both ends to the middle.

These are two independent recurrences at a time. Multipliers are in NODE records, and in the
IMPLICIT record of the piece. The row of node i is
diagonal[i] x[i] - bound[i] x[i - 1] - bound[i + 1] x[i + 1].
"""

from __future__ import annotations

from typing import Any


def factor(piece: Any, node: Any, bound: Any, diagonal: Any, held: Any) -> None:
    """Eliminate a piece; `held` nodes have given velocities."""
    a, m, b = piece.first, piece.middle, piece.last
    middle = diagonal[m]
    for i, step, end in ((a, 1, m), (b, -1, m)):
        carried = 0.0
        while i != end:
            cell = i + 1 if step > 0 else i
            node[i].inverse = 1.0 if held[i] else 1 / (diagonal[i] - carried)
            node[i].back = 0.0 if held[i] else bound[cell] * node[i].inverse
            node[i + step].into = bound[cell] * node[i].inverse
            carried = bound[cell] * node[i].back
            i += step
        middle -= carried
    piece.left = piece.right = 0.0
    node[m].inverse = 1.0
    if not held[m]:
        node[m].inverse = 1 / middle
        if m > a:
            piece.left = bound[m] * node[m - 1].inverse
        if m < b:
            piece.right = bound[m + 1] * node[m + 1].inverse


def substitute(piece: Any, node: Any, x: Any) -> None:
    """Solve for a piece; x holds the right side and becomes the solution.

    There are as many nodes on the left of the middle as on the right, or one less.
    """
    a, m, b = piece.first, piece.middle, piece.last
    near, far = m - a, b - m
    y, z = x[a], x[b]
    for i in range(1, near):
        left, right = a + i, b - i
        y = x[left] + node[left].into * y
        z = x[right] + node[right].into * z
        x[left], x[right] = y, z
    if far > near > 0:
        z = x[m + 1] + node[m + 1].into * z
        x[m + 1] = z
    y = x[m]
    if near > 0:
        y += piece.left * x[m - 1]
    if far > 0:
        y += piece.right * x[m + 1]
    y *= node[m].inverse
    x[m], z = y, y
    for i in range(1, near + 1):
        left, right = m - i, m + i
        y = node[left].inverse * x[left] + node[left].back * y
        z = node[right].inverse * x[right] + node[right].back * z
        x[left], x[right] = y, z
    if far > near:
        x[b] = node[b].inverse * x[b] + node[b].back * z
