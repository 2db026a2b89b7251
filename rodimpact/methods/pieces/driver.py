"""Runs of the kernels on records: plain Python first, compiled where that pays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .. import compiling, kernels
from ..duration import Forecast
from ..laws import Stop
from ..memory import ask
from . import march
from .accuracy import Ended
from .records import NEVER, PIECE, TURN
from .rows import Layout
from .series import N

FIRST_ROOM = 256  # pieces of a log, at first
FIRST_TURNS = 2048
PLAIN = 500  # steps in plain Python between two looks at the clock
STEP_TIME = 1.5e-3  # s, about what such a step takes
BRIEF = 0.02  # s that a run takes at least: many short ones are worth machine code, too
SLICE, LONG_SLICE = 20_000, 200_000  # compiled steps between two looks at the clock
ORDER = ("run", "node", "link", "mass", "line", "log", "turn", "part")  # of the kernel's arguments


def matrix_of(node: Any) -> Any:
    """Room for the equations of the longest chain."""
    unknowns = N * max(2 * int(node["links"].max()) - 1, 1)
    return np.zeros((unknowns, unknowns + 1))


class Machine:
    """One collision on its records: lists of objects in plain Python, then arrays of records.

    Attributes
    ----------
    records : dict of str to array
        After `go`.
    """

    def __init__(self, layout: Layout, member: int = 0) -> None:
        known = layout.first[member]
        log = np.zeros(FIRST_ROOM + 2 * len(known), PIECE)
        log[: len(known)] = known
        self.records: dict[str, Any] = {
            name: getattr(layout, name)[member].copy()
            for name in ("node", "link", "mass", "line", "part")
        }
        self.records |= {"run": layout.run[member : member + 1].copy(), "log": log,
                         "turn": np.zeros(FIRST_TURNS, TURN)}
        self.records["run"]["pieces"] = len(known)
        self._kinds = {name: array.dtype for name, array in self.records.items()}
        self._own = layout.own
        self._matrix = matrix_of(self.records["node"])

    @property
    def run(self) -> Any:
        """The one record of the run, by names of its fields."""
        return self.records["run"].view(np.recarray)[0]

    @property
    def ended(self) -> Ended:
        """What is known of it after `go`."""
        run, link, part = (
            compiling.as_objects(self.records[name]) for name in ("run", "link", "part"))
        return Ended(run[0], link, part)

    def go(self, forecast: Forecast | None = None) -> Stop:
        """Run to the end, in slices; return why it stopped."""
        limit = int(self.run["limit"])
        stop, more, spent = Stop.CAP, SLICE, BRIEF
        while stop == Stop.CAP and self.run["steps"] < limit:
            taken = int(self.run["steps"])
            compiled = compiling.can_be(self._own) and kernels.worth_compiling(spent, march.follow)
            plain = max(PLAIN, taken // 2)  # as all records change their form each time
            self.records["run"]["limit"] = min(limit, taken + (more if compiled else plain))
            if compiled:
                stop, more = self._compiled(), LONG_SLICE
            else:
                stop = self._plain()
                spent = (int(self.run["steps"]) - taken) * STEP_TIME
            if stop == Stop.CAP and forecast:
                self._tell(forecast, limit)
        self.records["run"]["limit"] = limit
        return stop

    def _tell(self, forecast: Forecast, limit: int) -> None:
        """Say how far the run is, of its time if there is an end, else of the cap."""
        steps, now = int(self.run["steps"]), int(self.records["node"]["now"].min())
        if self.run["extra"] == NEVER and now > 0:
            limit = min(limit, int(steps * (float(self.run["end"]) / now)) + 1)
        else:  # nobody knows: as long again
            limit = min(limit, 2 * steps)
        forecast.report(steps, limit, f"some {limit:.2g} steps of nodes")

    def _compiled(self) -> Stop:
        """Run on arrays of records."""
        follow = compiling.compiled(march.follow, self._own)
        while (stop := Stop(follow(*self._arguments(), self._matrix))) == Stop.FULL:
            self._more()
        return stop

    def _plain(self) -> Stop:
        """Run on lists of objects, in plain Python."""
        matrix = self._matrix.tolist()
        self.records = {name: compiling.as_objects(a) for name, a in self.records.items()}
        try:
            follow = compiling.interpreted(march.follow, self._own)
            while (stop := Stop(follow(*self._arguments(), matrix))) == Stop.FULL:
                self._more()
            return stop
        finally:
            self.records = {
                name: compiling.as_records(objects, self._kinds[name])
                for name, objects in self.records.items()
            }

    def _arguments(self) -> Iterator[Any]:
        return (self.records[name] for name in ORDER)

    def _more(self) -> None:
        """Double the log."""
        r = self.records
        size = len(r["log"]) * self._kinds["log"].itemsize / 8
        ask(4 * size, "until", f"a run of more than {len(r['log'])} pieces of waves",
            "stop earlier, or take a larger rtol")
        for name in ("log", "turn"):
            r[name] = compiling.lengthened(r[name], self._kinds[name])
