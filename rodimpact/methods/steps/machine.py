"""A single run of this method: the kernels' work space, on lists or arrays, and what drives them.

A run begins on lists, in plain Python, and goes on in compiled code once that pays.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...model import Rod
from ...model.frozen import InvalidModel
from ...model.profiles import averages
from .. import kernels
from ..clock import STEP_TICKS
from ..duration import Forecast
from ..memory import most_numbers
from ..row import Array, Row, squeezed, whole
from .delays import edges_of_parts
from .layout import Work, check_memory, is_even, make_of, memory_of, numbers_of, space
from .level_kernel import (
    FULL,
    PARTS,
    PERIOD,
    ROOM,
    TOO_LONG,
    TRIES,
    VANISHED,
    Level,
    Make,
    Numbers,
)
from .search_kernel import (
    EVENLY,
    EXTEND,
    FILL,
    FIXED,
    MOST_STEPS,
    NEXT,
    PREPARE,
    SEARCH,
    TOO_SHORT,
    Results,
    work_on,
)
from .step_kernel import SQUEEZED, STEP, inside

LESS = "a larger rtol, a longer dt or an earlier end (until)"
FASTER = 50  # times is compiled code
LINK_TIME = 3e-6  # s, about what plain Python takes for a link and a step; in a chain 5 times that


class Machine:
    """What the kernels of a run need.

    Parameters
    ----------
    row : Row
        Of a single system.
    until : float or None
        s; by default to the proof of finality.
    most_parts : int
        After which the run gives up where no end is given.
    """

    def __init__(self, row: Row, until: float | None = None, most_parts: int = 1 << 60) -> None:
        self.row, self.until, self.even = row, until, is_even(row)
        self.compiled = False
        self._make = make_of(row)
        self.work = self._space(0, 0)
        numbers = Numbers(*([float(x) for x in column] for column in numbers_of(row)))
        self.work = self.work._replace(numbers=numbers)
        limit = self.work.limit
        limit.until[0], limit.steps[0] = -1.0 if until is None else until, most_parts
        limit.numbers[:] = [most_numbers(), *memory_of(row, True)]

    def _space(self, room: int, before: int) -> Work:
        if self.compiled:
            return space(Make(*map(whole, self._make)), np.full, room, before)
        return space(self._make, lambda size, zero: [zero] * size, room, before)

    def search(
        self, dt: float | None, goal: float, announce: Callable[[str], None] | None = None
    ) -> None:
        """Run level after level until the outcome stands still; or once, with the step dt, s.

        `announce` is called with a sentence where that takes long.

        Raises
        ------
        TooLong
            If the first level takes too much memory.
        InvalidModel
            If a rigid mass cannot move, or a transit time is too short beside the longest.
        """
        search, level = self.work.search, self.work.level
        search.goal[0], search.at[FIXED], search.at[NEXT] = goal, int(dt is not None), PREPARE
        level.step[0] = dt or 0.0
        flag, forecast, decided = FILL, Forecast(announce, LESS), False
        while flag in (FILL, FULL):
            flag = self._do(SEARCH)
            if flag in (FILL, FULL) and not decided:
                self._decide()
            decided = flag == FULL  # on what is laid out again
            if flag == FILL:
                self.fill()
                if (seconds := self._seconds()) > 1:
                    forecast.expect(seconds, f"about {self.work.level.at[ROOM]} steps")
            elif flag == FULL:
                self.enlarge()
            elif flag == TOO_LONG and not self.compiled and kernels.enabled():
                self.to_arrays()
                flag = FULL
        if flag == TOO_SHORT:
            raise self._too_short()
        level, at = self.work.level, self.work.level.at
        if flag == SQUEEZED:
            raise squeezed(float(level.edges[self.work.clock[STEP]]) / STEP_TICKS * level.step[0])
        if flag == TOO_LONG:
            self._refuse(level.step[0], at[PARTS], at[ROOM])
        if flag == VANISHED:
            self.row.stiffness_in_steps(level.step[0])

    def _refuse(self, step: float, parts: float, room: int) -> None:
        """Raise TooLong for a run on a step, s, that is cut into so many parts."""
        parts = parts * STEP_TICKS / self.work.level.at[PERIOD]
        before = parts * sum(self.work.numbers.transit) / step
        least = 0.0 if self.until is None else parts * self.until / step
        for count in (least, max(least, room)):
            check_memory(self.row, step, count, before, not self.compiled)

    def extend(self) -> None:
        """Run on after the proof for a round trip of the longest rod."""
        self._do(EXTEND)

    def _do(self, job: int) -> int:
        """Let the kernel do one of its jobs on the work space."""
        if not self.compiled:
            return work_on(*self.work, [], [], 0.0, NO_RESULTS, job)
        kernel = kernels.compiled(work_on)
        return int(kernel(*self.work, NOTHING, NOTHING > 0, 0.0, NO_RESULTS, job))

    def _decide(self) -> None:
        """Hand over to arrays if compiling pays for the run that was laid out."""
        if not self.compiled and kernels.worth_compiling(self._seconds(), work_on):
            self.to_arrays()

    def _seconds(self) -> float:
        """About how long the run takes that was laid out, s."""
        chains = len(self.row.masses) + len({*self.row.first}) - 1
        links = len(self.row.laws) + 5 * chains
        parts = self.work.level.at[ROOM] / (2 if self.until is None else 1)
        return float(parts * links * LINK_TIME / (FASTER if self.compiled else 1))

    def to_arrays(self) -> None:
        """Hand the work space over to arrays."""
        if self.compiled:
            return
        lists, self.compiled = self.work, True
        arrays: list[Any] = [
            type(old)(*(np.array(x, kind.dtype) for x, kind in zip(old, new, strict=True)))
            if isinstance(old, tuple) else np.array(old, new.dtype)
            for old, new in zip(lists, self._space(0, 0), strict=True)
        ]
        self.work = Work(*arrays)
        self.work.limit.numbers[1:] = memory_of(self.row, False)

    def enlarge(self) -> None:
        """Make room for the run that was laid out, which is to be laid out again."""
        old = self.work
        room, before = int(old.level.at[ROOM]) + 1, averages_before(old.level)
        check_memory(self.row, old.level.step[0], room, before, not self.compiled)
        of_part, of_average = memory_of(self.row, not self.compiled)
        more = room + room // 2
        if old.level.at[TRIES] > 1 and more * of_part + before * of_average <= most_numbers():
            room = more  # for the next cuts, too, where one was laid out after another
        new = self._space(room, before)
        for was, now in zip(old[1:5], new[1:5], strict=True):  # the rest is laid out
            for column, wider in zip(was, now, strict=True):
                wider[: len(column)] = column
        self.work = new

    def fill(self) -> None:
        """Fill in waves at t = 0, and what comes from outside."""
        if self.even:
            self._do(EVENLY)
        else:
            self._initial_state()
            self._drive()

    def _edges(self, first: int, last: int) -> Array:
        """Ticks at which the parts from `first` on begin, up to `last`, where it ends."""
        places = np.array(self.work.level.places[: self.work.level.at[PARTS] + 1])
        return edges_of_parts(places, first, last)

    def _enter(self, start: int, wave: Array) -> None:
        """Enter averages of a wave from a place in the signals on."""
        column = self.work.signals.wave
        column[start : start + len(wave)] = wave if self.compiled else wave.tolist()

    def _initial_state(self) -> None:
        row, work = self.row, self.work
        for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
            if not isinstance(body, Rod):
                continue
            begin = 0.0
            for s in range(start, stop + 1):
                T, segment = work.level.ticks[s], row.segments[s - 1]
                L, c = float(segment.length), float(segment.wave_speed)
                ago = -np.maximum(self._edges(-inside(work.state, s), 0), -T) / T
                for line, x in ((2 * s, begin + L * ago[::-1]), (2 * s + 1, begin + L * (1 - ago))):
                    v = averages(body.velocity, x, float(body.length)) - row.frame
                    stretch = averages(body.strain, x, float(body.length)) * c
                    wave = (v - stretch)[::-1] if line == 2 * s else v + stretch
                    self._enter(int(work.signals.wave_start[line]) - len(wave), wave)
                begin += L

    def _drive(self) -> None:
        """Fill the lines that come from outside with means between edges."""
        row, level, signals = self.row, self.work.level, self.work.signals
        n, ticks = len(row.segments), [*self._edges(-1, -1), *level.edges[: level.at[ROOM] + 1]]
        edges = level.step[0] / STEP_TICKS * np.array(ticks)
        for side, line, own in ((0, 0, 2), (1, 2 * n + 3, 2 * n + 1)):
            kind, value = row.outside[side]
            if kind == "none":
                continue
            found = averages(value, edges, 0.0)
            if kind == "absorbing":  # beside what left this end just before t = 0
                came = signals.wave[signals.wave_start[own] - 1]
                found = row.wave_of_strain(side) * found + came
            elif kind == "velocity":
                found = found - row.frame - row.gravity * (edges[1:] + edges[:-1]) / 2
            self._enter(int(signals.wave_start[line]) - 1, found)

    def _too_short(self) -> InvalidModel:
        transits = self.work.numbers.transit
        longest, short = max(transits), min(range(len(transits)), key=transits.__getitem__)
        message = (
            f"its transit time or that of a contact is so short beside the longest, "
            f"{longest:.3g} s, that this would take more than {MOST_STEPS} steps; leave it out, "
            "soften the contact of a mass, or give the step dt"
        )
        return InvalidModel([(self.row.paths[short + 1], message)])


def no_results(count: int, *widths: int) -> Results:
    """Zeros for so many members, of which each column has so many numbers; the last are whole."""
    columns: list[Any] = [np.zeros(count, dtype=np.int64) for _ in range(3)]
    columns += [np.zeros((count, width)) for width in widths[:-1]]
    columns.append(np.zeros((count, widths[-1]), dtype=np.int64))
    return Results(*columns)


NOTHING = np.zeros(0)
NO_RESULTS = Results(*(column.reshape(-1) for column in no_results(0, *[0] * 7)))


def averages_before(level: Level) -> int:
    """Averages from before t = 0 of a line, all segments together."""
    parts, period = level.at[PARTS], level.at[PERIOD]
    return int(sum(T // period * parts + (T % period > 0) for T in level.ticks))
