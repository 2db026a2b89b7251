"""Value of a line at a tick, and integrals up to it; the page has this as JavaScript.

In Python `signals` reads whole arrays.
"""

from bisect import bisect_right
from typing import Any

from . import lines


def waves_of(log: Any, count: int) -> list[Any]:
    """The pieces of each of `count` lines of a log, as a table by line.

    Each table has the ``log``, and lists by piece, in order of time: ``piece``, its
    ``place`` in the log, its ``start``, tick, and ``passed``, what `passed_by` gives up
    to the start: the integrals of the wave and of its square. A line without pieces has
    empty lists.
    """
    waves: list[Any] = [
        {"log": log, "piece": [], "place": [], "start": [], "passed": []}
        for _ in range(count)
    ]
    for i, piece in enumerate(log):
        wave = waves[piece.line]
        passed = (0.0, 0.0)
        if len(wave["piece"]) > 0:
            passed = passed_by(wave, piece.start)
        wave["passed"].append(passed)
        wave["piece"].append(piece)
        wave["place"].append(i)
        wave["start"].append(piece.start)
    return waves


def place_of(wave: Any, tick: float) -> int:
    """Number of the piece of a wave that holds at a tick.

    Before all pieces it is the first one.
    """
    return max(0, bisect_right(wave["start"], tick) - 1)


def share_of(piece: Any, tick: float) -> float:
    """Place of a tick in a piece, from -1 to 1.

    It is -1 at its start, and 1 at its end and after it.
    """
    return min(1.0, 2 * ((tick - piece.start) / (piece.end - piece.start)) - 1)


def value_at(wave: Any, tick: float) -> float:
    """Value of a wave at a tick; the last one holds on."""
    piece = wave["piece"][place_of(wave, tick)]
    return float(lines.at(piece, share_of(piece, tick)))


def passed_by(wave: Any, tick: float) -> tuple[float, float]:
    """Integrals of a wave and of its square, over ticks, up to a tick.

    They go from the start of its line, and are 0 before. `wave` is a table of
    `waves_of`: its ``passed`` are the integrals up to the piece at this tick, and what
    this piece adds is integrated.
    """
    i = place_of(wave, tick)
    begin = wave["start"][i]
    passed, squares = wave["passed"][i]
    if tick > begin:
        duration = tick - begin
        # `moments` integrates over y from -1 to 1; this is the ticks for a unit of y.
        half = duration / 2
        place = wave["place"][i]
        mean = 0.0  # velocity from which `moments` counts the wave
        integrals = lines.moments(wave["log"], place, begin, duration, mean)
        passed = passed + half * integrals.whole
        squares = squares + half * integrals.square
    return passed, squares
