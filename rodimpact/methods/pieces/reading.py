"""What a line holds at a tick, and its integral up to it; the page has this as JavaScript.

In Python `signals` reads whole arrays.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from . import lines
from .series import POINTS, WEIGHTS, N, X


def primitive(c: Any) -> list[float]:
    """Coefficients of the integral of a series from -1 on."""
    found = [0.0] * (POINTS + 1)
    for m in range(POINTS):
        found[m + 1] += c[m] / (2 * (m + 1)) if m > 0 else c[0]
        if m > 1:
            found[m - 1] -= c[m] / (2 * (m - 1))
    for m in range(1, POINTS + 1):
        found[0] += found[m] if m % 2 == 1 else -found[m]
    return found


def sum_of(c: Any, y: float) -> float:
    """Sum of a series of any length at y, by Clenshaw's recurrence."""
    b1 = b2 = 0.0
    for m in range(len(c) - 1, 0, -1):
        b1, b2 = 2 * y * b1 - b2 + c[m], b1
    return float(y * b1 - b2 + c[0])


def waves_of(pieces: Any, count: int) -> list[Any]:
    """Pieces by lines: each `start`, tick, and the integrals up to it, `passed` and of `squares`.

    Parameters
    ----------
    pieces : list of PIECE
    count : int
        Lines.
    """
    waves: list[Any] = [
        {"piece": [], "start": [], "primitive": [], "passed": [], "squares": []}
        for _ in range(count)]
    for piece in pieces:
        wave = waves[piece.line]
        last, passed, squares = len(wave["piece"]) - 1, 0.0, 0.0
        if last >= 0:
            passed = passed_by(wave, wave["piece"][last].stop)
            squares = squares_by(wave, wave["piece"][last].stop)
        wave["squares"].append(squares)
        wave["piece"].append(piece)
        wave["start"].append(piece.start)
        wave["primitive"].append(primitive(piece.coefficient) if piece.degree > 0 else [])
        wave["passed"].append(passed)
    return waves


def place_of(wave: Any, tick: float) -> int:
    """Number of the piece that holds at a tick."""
    return max(0, bisect_right(wave["start"], tick) - 1)


def share_of(piece: Any, tick: float) -> float:
    """Where a tick is in a piece, from -1 to 1."""
    return min(1.0, 2 * ((tick - piece.start) / (piece.stop - piece.start)) - 1)


def value_at(wave: Any, tick: float) -> float:
    """Value at a tick; the last one holds on."""
    piece = wave["piece"][place_of(wave, tick)]
    return float(lines.at(piece, share_of(piece, tick)))


def passed_by(wave: Any, tick: float) -> float:
    """Integral from the start of the line to a tick, in ticks."""
    i = place_of(wave, tick)
    piece, passed = wave["piece"][i], wave["passed"][i]
    if piece.degree == 0:
        return float(passed + piece.coefficient[0] * (tick - piece.start))
    half = (piece.stop - piece.start) / 2
    return float(passed + half * sum_of(wave["primitive"][i], share_of(piece, tick)))


def squares_by(wave: Any, tick: float) -> float:
    """Integral of the square from the start of the line to a tick, in ticks."""
    i = place_of(wave, tick)
    piece, sum_of_squares = wave["piece"][i], 0.0
    if piece.degree == 0:
        return float(wave["squares"][i] + piece.coefficient[0] ** 2 * (tick - piece.start))
    half = (share_of(piece, tick) + 1) / 2
    for j in range(N):
        sum_of_squares += WEIGHTS[j] * lines.at(piece, half * (X[j + 1] + 1) - 1) ** 2
    return float(wave["squares"][i] + half * (piece.stop - piece.start) / 2 * sum_of_squares)
