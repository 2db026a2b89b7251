"""The kernel of the method "characteristics" on arrays: laid out, driven, and run on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...model import Rod
from ...model.profiles import averages
from .. import kernels
from ..abilities import driven
from ..clock import STEP_TICKS
from ..contact_law_kernel import RIGID, Chain, Tally
from ..finality_kernel import NEVER
from ..memory import ask
from ..row import Array, Row, squeezed, whole
from .delays import edges_of_parts
from .step_kernel import DONE, SQUEEZED, STEP, Points, Signals, State, finality_time, inside, run

TOLERANCE = 2.0**-48  # of the velocities, below which contacts graze
PROOF_TIME = 2e-6  # s, about what plain Python takes for a contact and an average in a rod
LINK_TIME = 3e-6  # s, about what plain Python takes for a link and a step; in a chain 5 times that


def check_memory(row: Row, step: float, seconds: float, parts: int) -> None:
    """Raise TooLong where a run, and what results make of it, takes too much memory.

    Parameters
    ----------
    row : Row
    step, seconds : float
        Of the run, s.
    parts : int
        Of a step.
    """
    steps, lines = parts * seconds / step, 2 * len(row.segments)
    before = parts * sum(float(s.transit_time) for s in row.segments) / step
    contacts, masses = len(row.contact_link), sum(m >= 0 for m in row.mass_of)
    ends = sum(kind != "none" for kind, _ in row.outside)
    # waves and their integrals; force, gap, path, rate and power with integrals; edges and times
    numbers = steps * (2 * lines + 10 * contacts + 5 * masses + 6 * ends + 10) + 4 * before
    if not kernels.enabled():  # lists take four times what arrays take, and stand beside them
        numbers += 4 * (steps * (lines + 2 * contacts + masses + ends) + 2 * before)
    if steps < before:
        ask(numbers, "dt", f"keeping waves over {before:.4g} steps", "take a longer step")
    what = f"a run of {steps:.4g} steps of {step:.3g} s"
    ask(numbers, "until", what, "stop earlier, or take a longer step (dt or rtol)")


class Machine:
    """The kernel's state on arrays, and the room that it needs.

    Parameters
    ----------
    plan : Plan
    ticks : list of int
        Transit times of the segments.
    step : float
        s; of `STEP_TICKS` ticks.
    room : int
        Parts of steps to make room for.
    cuts : list of int
        Ticks inside a step where all steps are cut into parts.
    """

    def __init__(
        self, row: Row, ticks: list[int], step: float, room: int, cuts: Sequence[int] = ()
    ) -> None:
        self.row, self.step, self.room = row, step, room
        self.places = np.array([0, *sorted(cuts), STEP_TICKS])
        n, h, links, masses = len(ticks), step, len(row.laws), len(row.masses)
        parts = len(self.places) - 1
        mobility = [0.0, *(1 / float(s.impedance) for s in row.segments), 0.0]
        for side, s in ((0, 1), (1, n)):
            if row.outside[side][0] == "absorbing":
                mobility[(n + 1) * side] = mobility[s]
        transits = np.array([0, *ticks, 0])
        self.state = State(
            transits // STEP_TICKS * parts, transits % STEP_TICKS / STEP_TICKS,
            transits / STEP_TICKS,
            np.diff(self.places) / STEP_TICKS, np.array(mobility), whole(row.first),
            np.array(row.masses) / h, whole(row.laws), row.stiffness_in_steps(h),
            np.array(row.exponent), np.array(row.damping), np.array(row.gap) / h,
            np.zeros(links), np.zeros(links), np.ones(links, np.int64),
            np.array(row.mass_velocity) - row.frame, np.zeros(1),
        )
        self.tally = Tally(*(np.zeros(links) for _ in range(4)),
                           *(np.full(links, v, np.int64) for v in (-1, -1, 0, 0)))
        self.points = Points(*np.zeros((2, masses + 2)))
        self.links = Chain(*np.zeros((len(Chain._fields), masses + 1)))
        self.clock = whole([0, 0, 0])
        self.taken = 0
        self.signals = self._allocate(room)
        self._initial_state(ticks)
        self._drive(-1, self.edges(-1, room))
        self.tol = TOLERANCE * row.scale

    def edges(self, first: int, last: int) -> Array:
        """Ticks at which the parts from `first` on begin, up to `last`, where it ends."""
        found: Array = edges_of_parts(self.places, first, last)
        return found

    def _before(self) -> list[int]:
        """By line: averages from before t = 0."""
        inner = [inside(self.state, line // 2) for line in range(1, 2 * len(self.state.steps) - 1)]
        return [1, *inner, 1]

    def _allocate(self, room: int) -> Signals:
        """Empty signals with room for so many steps."""
        state, row = self.state, self.row
        before = self._before()
        n = len(state.steps) - 2
        kept = [line for line in range(2 * n + 4) if 2 <= line <= 2 * n + 1]
        kept += [line for side, line in ((0, 0), (1, 2 * n + 3)) if row.outside[side][0] != "none"]
        starts, size = [-1] * (2 * n + 4), 0
        for line in kept:
            starts[line] = size + before[line]
            size += before[line] + room
        wanted = [i for i, law in enumerate(row.laws) if law >= RIGID]
        link_start = [-1] * len(row.laws)
        for place, i in enumerate(wanted):
            link_start[i] = place * room
        return Signals(
            np.zeros(size), whole(starts), np.zeros(len(wanted) * room),
            np.zeros(len(wanted) * room), whole(link_start), np.zeros(len(row.masses) * room),
            whole([m * room for m in range(len(row.masses))]),
        )

    def _initial_state(self, ticks: list[int]) -> None:
        row, signals = self.row, self.signals
        for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
            if not isinstance(body, Rod):
                continue
            begin = 0.0
            for s in range(start, stop + 1):
                T, L, c = ticks[s - 1], float(row.segments[s - 1].length), float(
                    row.segments[s - 1].wave_speed)
                ago = -np.maximum(self.edges(-inside(self.state, s), 0), -T) / T
                for line, x in ((2 * s, begin + L * ago[::-1]), (2 * s + 1, begin + L * (1 - ago))):
                    v = averages(body.velocity, x, float(body.length)) - row.frame
                    stretch = averages(body.strain, x, float(body.length)) * c
                    wave = (v - stretch)[::-1] if line == 2 * s else v + stretch
                    place = signals.wave_start[line]
                    signals.wave[place - len(wave) : place] = wave
                begin += L

    def _drive(self, since: int, ticks: Array) -> None:
        """Fill the lines that come from outside, from part `since` on, with means between ticks."""
        n, row = len(self.state.steps) - 2, self.row
        edges = self.step / STEP_TICKS * ticks
        for side, line, own in ((0, 0, 2), (1, 2 * n + 3, 2 * n + 1)):
            kind, value = row.outside[side]
            if kind == "none":
                continue
            start = int(self.signals.wave_start[line])
            if kind == "absorbing":  # what left this end just before t = 0
                found: Any = self.signals.wave[self.signals.wave_start[own] - 1]
            else:
                found = averages(value, edges, 0.0)
                if kind == "velocity":
                    found = found - row.frame - row.gravity * (edges[1:] + edges[:-1]) / 2
            self.signals.wave[start + since : start + since + len(ticks) - 1] = found

    def grow(self, room: int) -> None:
        """Make room for more steps."""
        parts = len(self.state.part)
        check_memory(self.row, self.step, room / parts * self.step, parts)
        old, was = self.signals, self.room
        self.signals, self.room = self._allocate(room), room
        for name, starts in (("wave", "wave_start"), ("force", "link_start"), ("gap", "link_start"),
                             ("speed", "mass_start")):
            source, target = getattr(old, name), getattr(self.signals, name)
            before = [0] * len(getattr(old, starts))
            if name == "wave":
                before = self._before()
            for i, start in enumerate(getattr(old, starts)):
                if start >= 0:
                    to = getattr(self.signals, starts)[i]
                    target[to - before[i] : to + was] = source[start - before[i] : start + was]
        self._drive(was, self.edges(was, room))

    def advance(self, end: int) -> bool:
        """Run to part `end`; False where a contact closes inside a part, and the run is to stop."""
        if end > self.room:
            self.grow(max(end, 2 * self.room))
        chains = len(self.row.masses) + len({*self.row.first}) - 1
        links = len(self.row.laws) + 5 * chains
        converting = sum(map(len, self.signals)) * kernels.LIST_TIME
        if kernels.worth_compiling((end - self.taken) * links * LINK_TIME + converting, run):
            flag = kernels.compiled(run)(
                self.state, self.tally, self.signals, self.points, self.links, self.clock, end,
                self.tol,
            )
        else:
            parts = (self.state, self.tally, self.signals, self.points, self.links)
            lists = [kernels.as_lists(x) for x in parts]
            clock = self.clock.tolist()
            state, tally, signals, points, links = lists
            flag = run(state, tally, signals, points, links, clock, end, self.tol)
            for part, found in zip(parts, lists, strict=True):
                kernels.copy_back(found, part)
            self.clock[:] = clock
        self.taken = int(self.clock[STEP])
        if flag == SQUEEZED:
            raise squeezed(float(self.edges(self.taken, self.taken)[0]) / STEP_TICKS * self.step)
        return bool(flag == DONE)

    def finish(self, end: int) -> bool:
        """Run on to tick `end`, with what there is of the last part of a step."""
        rest = end - int(self.edges(self.taken, self.taken)[0])
        if rest == 0:
            return True
        whole_row, d = self.state, rest / STEP_TICKS
        last = self.taken % len(whole_row.part)
        self.state = whole_row._replace(
            part=np.where(np.arange(len(whole_row.part)) == last, d, whole_row.part),
            share=np.minimum(1.0, whole_row.share / d),
        )
        self._drive(self.taken, np.array([end - rest, end]))
        going = self.advance(self.taken + 1)
        self.state = whole_row
        return going

    def finality_time(self) -> int:
        """Parts until it may be proved that the collision is over; NEVER if not as it is."""
        if driven(self.row.system):
            return NEVER
        averages_read = int(np.sum(self.state.steps)) * len(self.row.laws)
        slow = kernels.worth_compiling(averages_read * PROOF_TIME, finality_time)
        prove: Callable[..., int] = kernels.compiled(finality_time) if slow else finality_time
        wait = int(prove(self.state, self.signals, self.taken, self.tol))
        return wait if wait >= NEVER // len(self.state.part) else wait * len(self.state.part)
