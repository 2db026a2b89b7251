"""Values of a line at a tick, and its integrals up to a tick.

The web page has these functions as JavaScript. Python code reads whole arrays with
`signals` instead.
"""

from bisect import bisect_right
from typing import Any

from . import lines


def waves_of(log: Any, count: int) -> list[Any]:
    """A list with one table for each of the first `count` lines of a log.

    A table has the ``log`` and four lists with an entry for each piece of the line, in
    order of time: ``piece``, the piece itself; ``row``, its row in the log; ``start``,
    the tick at which it starts; and ``passed``, the result of `passed_by` at this tick.
    The lists of a line without pieces are empty.
    """
    waves: list[Any] = [
        {"log": log, "piece": [], "row": [], "start": [], "passed": []}
        for _ in range(count)
    ]
    for i, piece in enumerate(log):
        wave = waves[piece.line]
        passed = (0.0, 0.0)  # integrals of the wave and of its square
        if len(wave["piece"]) > 0:
            passed = passed_by(wave, piece.start)
        wave["passed"].append(passed)
        wave["piece"].append(piece)
        wave["row"].append(i)
        wave["start"].append(piece.start)
    return waves


def piece_index_at(wave: Any, tick: float) -> int:
    """Index in the table of a wave of its piece at a tick.

    Before the first piece it is 0. Where two pieces meet it is that of the later one.
    """
    return max(0, bisect_right(wave["start"], tick) - 1)


def position_in(piece: Any, tick: float) -> float:
    """Position y of a tick in a piece: -1 at its start, 1 at its end and after it."""
    return min(1.0, 2 * ((tick - piece.start) / (piece.end - piece.start)) - 1)


def value_at(wave: Any, tick: float) -> float:
    """Value of a wave at a tick; after its end, its last value."""
    piece = wave["piece"][piece_index_at(wave, tick)]
    return float(lines.at(piece, position_in(piece, tick)))


def passed_by(wave: Any, tick: float) -> tuple[float, float]:
    """Integrals of a wave and of its square, over ticks, up to a tick.

    They start at the first piece of the wave, and are 0 before it. `wave` is a table of
    `waves_of`, which has the integrals up to the start of each piece: only the piece at
    this tick is integrated here.
    """
    i = piece_index_at(wave, tick)
    begin = wave["start"][i]
    integral, square_integral = wave["passed"][i]
    if tick > begin:
        duration = tick - begin
        # `moments` integrates over y from -1 to 1: this converts it to ticks.
        ticks_per_y = duration / 2
        row = wave["row"][i]
        speed = 0.0  # nothing is subtracted from the wave
        integrals = lines.moments(wave["log"], row, begin, duration, speed)
        integral = integral + ticks_per_y * integrals.whole
        square_integral = square_integral + ticks_per_y * integrals.square
    return integral, square_integral
