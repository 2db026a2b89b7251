"""Runs of the kernels on records: plain Python first, compiled where that pays."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .. import compiling, kernels
from ..duration import Forecast
from ..laws import Stop
from ..memory import ask
from ..run import Stopped
from . import march
from .records import NEVER, PIECE, TURN
from .rows import RECORDS, Layout
from .series import N

LISTS = {"log": PIECE, "turn": TURN}
ROOM, TURNS = 256, 2048  # pieces of the log, and changes of contacts, at first
CALL = 64  # members between two looks whether to stop
PLAIN = 500  # steps in plain Python between two looks at the clock
STEP_TIME = 1.5e-3  # s, about what such a step takes
BRIEF = 0.02  # s that a run takes at least: many short ones are worth machine code, too
SLICE = 100_000  # compiled steps between two looks at the clock


def matrix_of(node: Any) -> Any:
    """Room for the equations of the longest chain."""
    unknowns = N * int(node["links"].max())
    return np.zeros((unknowns, unknowns + 1))


class Machine:
    """Runs members of a layout, one after the other, on their own records and one log.

    Attributes
    ----------
    layout : Layout
    log, turn : array
        Pieces and changes of contacts of the member that ran last, as many as its run says.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout, self.turn = layout, np.zeros(TURNS, TURN)
        self.log = np.zeros(ROOM + 2 * layout.first.shape[1], PIECE)
        self._matrix = matrix_of(layout.node)

    def run_all(
        self, members: Iterable[int], stop: Callable[[], bool] = lambda: False,
        forecast: Forecast | None = None,
    ) -> None:
        """Run some members; raise Stopped if `stop`, asked now and then, says so."""
        for count, m in enumerate(members):
            if count % CALL == 0 and stop():
                raise Stopped
            self.go(m, forecast)

    def records(self, member: int = 0) -> dict[str, Any]:
        """Arrays of the records of a member, in the order of the kernel's arguments."""
        own = {name: getattr(self.layout, name)[member] for name in RECORDS}
        return own | {"log": self.log, "turn": self.turn, "matrix": self._matrix}

    def start(self, member: int = 0) -> dict[str, Any]:
        """Enter what is known of a member at t = 0 in the log; return its records."""
        known = self.layout.first[member]
        self.log[: len(known)] = known
        return self.records(member)

    def go(self, member: int = 0, forecast: Forecast | None = None) -> None:
        """Run a member to its end, in slices."""
        self.start(member)
        own, run = self.layout.own, self.layout.run_of(member)
        limit, spent, stop = int(run.limit), BRIEF, Stop.CAP
        while stop == Stop.CAP and run.steps < limit:
            taken = int(run.steps)
            fast = compiling.can_be(own) and kernels.worth_compiling(spent, march.follow)
            plain = max(PLAIN, taken // 2)  # as all records change their form each time
            run.limit = min(limit, taken + (SLICE if fast else plain))
            stop = self._slice(member, fast)
            spent = (int(run.steps) - taken) * STEP_TIME
            if stop == Stop.CAP and forecast:
                self._tell(forecast, run, limit, int(self.layout.node[member]["now"].min()))
        run.limit = limit

    def _tell(self, forecast: Forecast, run: Any, limit: int, now: int) -> None:
        """Say how far the run is, of its time if there is an end, else of the cap."""
        steps = int(run.steps)
        if run.extra == NEVER and now > 0:
            limit = min(limit, int(steps * (float(run.end) / now)) + 1)
        else:  # nobody knows: as long again
            limit = min(limit, 2 * steps)
        forecast.report(steps, limit, f"some {limit:.2g} steps of nodes")

    def _slice(self, member: int, fast: bool) -> Stop:
        """Run on: on arrays of records, or on lists of objects in plain Python."""
        own, held = self.layout.own, self.records(member)
        matrix = held.pop("matrix")
        if fast:
            follow: Any = compiling.compiled(march.follow, own)
        else:
            follow, matrix = compiling.interpreted(march.follow, own), matrix.tolist()
            held = {name: compiling.as_objects(array) for name, array in held.items()}
        while (stop := Stop(follow(*held.values(), matrix))) == Stop.FULL:
            pieces = len(held["log"])
            ask(4 * pieces * PIECE.itemsize / 8, "until",
                f"a run of more than {pieces} pieces of waves",
                "stop earlier, or take a larger rtol")
            for name, kind in LISTS.items():
                held[name] = compiling.lengthened(held[name], kind)
        if not fast:
            held = {name: compiling.as_records(held[name], kind)
                    for name, kind in (RECORDS | LISTS).items()}
            for name in RECORDS:
                getattr(self.layout, name)[member] = held[name]
        self.log, self.turn = held["log"], held["turn"]
        return stop
