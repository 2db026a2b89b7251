"""A row laid out on a step, below the search for an accurate one."""

from __future__ import annotations

import numpy as np

from rodimpact.methods import kernels
from rodimpact.methods.abilities import driven
from rodimpact.methods.clock import STEP_TICKS
from rodimpact.methods.finality_kernel import NEVER
from rodimpact.methods.row import Row
from rodimpact.methods.steps import level_kernel as lk
from rodimpact.methods.steps.delays import edges_of_parts
from rodimpact.methods.steps.machine import Machine
from rodimpact.methods.steps.step_kernel import CUTS, DONE, STEP, finality_time, run


class LaidOut:
    """On arrays, with room for so many parts of steps, which are cut at some ticks."""

    def __init__(self, system, room, step, cuts=()):
        self.row = Row(system)
        machine = Machine(self.row)
        machine.to_arrays()
        level = machine.work.level
        level.step[0], level.at[lk.ASKED] = step, room
        lk.put_on_ticks(machine.work.numbers, level)
        level.places[: len(cuts) + 2] = [0, *sorted(cuts), STEP_TICKS]
        level.at[lk.PARTS] = len(cuts) + 1
        while self._lay_out(machine) == lk.FULL:
            machine.enlarge()
        machine.fill()
        machine.work.clock[CUTS] = 0
        work = self.work = machine.work
        self.state, self.tally, self.signals = work.state, work.tally, work.signals
        self.points, self.links, self.clock = work.points, work.links, work.clock
        self.places = work.level.places[: len(cuts) + 2]
        self.tol = lk.TOLERANCE * self.row.scale

    @staticmethod
    def _lay_out(machine):
        w = machine.work
        return lk.lay_out(
            w.make, w.numbers, w.limit, w.level, w.state, w.tally, w.signals, w.clock
        )

    @property
    def taken(self):
        return int(self.clock[STEP])

    def edges(self, first, last):
        return edges_of_parts(self.places, first, last)

    def advance(self, end):
        flag = kernels.compiled(run)(
            self.state, self.tally, self.signals, self.points, self.links, self.clock, end, self.tol
        )
        return flag == DONE

    def finality_time(self):
        if driven(self.row.system):
            return NEVER
        prove = kernels.compiled(finality_time)
        wait, parts = int(prove(self.state, self.signals, self.taken, self.tol)), len(self.places)
        return wait if wait >= NEVER // parts else wait * (parts - 1)


def on_whole_steps(system, step):
    """Whether all transit times are whole numbers of steps."""
    machine = Machine(Row(system))
    machine.work.level.step[0] = step
    return lk.put_on_ticks(machine.work.numbers, machine.work.level)


def places_of(system, step):
    """Where in a step it is cut at first, in steps."""
    machine = Machine(Row(system))
    level = machine.work.level
    level.step[0], level.at[lk.CUT] = step, 1
    lk.cut_steps(machine.work.make, machine.work.numbers, level)
    return np.array(level.places[1 : level.at[lk.PARTS]]) / STEP_TICKS
