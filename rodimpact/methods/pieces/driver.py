"""Runs of the kernels on records: plain Python first, compiled where that pays."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import compiling, kernels
from ..duration import Forecast
from ..memory import ask
from . import march
from .layout import ENDLESS, Layout
from .records import PIECE, TURN, Stop
from .series import N

FIRST_ROOM = 256  # pieces of a log, at first
FIRST_TURNS = 2048
PLAIN = 2000  # steps that a process takes in plain Python before it compiles
SLICE, LONG_SLICE = 20_000, 200_000  # compiled steps between two looks at the clock
OWN = ("run", "node", "link", "mass", "line", "part")


class Machine:
    """One collision on its records: lists of objects in plain Python, then arrays of records.

    Attributes
    ----------
    records : dict of str to array
        After `go`.
    """

    taken = 0  # steps, by all in plain Python

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
        self._size = N * max(2 * int(self.records["node"]["links"].max()) - 1, 1)

    @property
    def run(self) -> Any:
        """The one record of the run."""
        return self.records["run"][0]

    def go(self, forecast: Forecast | None = None) -> Stop:
        """Run to the end, in slices; return why it stopped."""
        compilable, limit = not kernels.why_not(), int(self.run["limit"])
        stop, slice_ = Stop.CAP, SLICE
        while stop == Stop.CAP and self.run["steps"] < limit:
            plain = not compilable or Machine.taken < PLAIN
            taken = int(self.run["steps"])
            self.records["run"]["limit"] = min(limit, taken + (PLAIN if plain else slice_))
            if plain:
                stop = self._plain()
                Machine.taken += int(self.run["steps"]) - taken
            else:
                stop = self._compiled()
                slice_ = LONG_SLICE
            if stop == Stop.CAP and forecast:
                self._tell(forecast, limit)
        self.records["run"]["limit"] = limit
        return stop

    def _tell(self, forecast: Forecast, limit: int) -> None:
        """Say how far the run is, of its time if there is an end, else of the cap."""
        steps, now = int(self.run["steps"]), int(self.records["node"]["now"].min())
        if self.run["extra"] == ENDLESS and now > 0:
            limit = min(limit, int(steps * (float(self.run["end"]) / now)) + 1)
        forecast.report(steps, limit, f"some {limit:.2g} steps of nodes")

    def _compiled(self) -> Stop:
        """Run as a family of one."""
        kernel, r = compiling.compiled(march, "family_of"), self.records
        none = np.zeros((1, 0), r["log"].dtype)
        while True:
            kernel(r["run"], *(r[name][None] for name in OWN[1:]), none, r["log"], r["turn"])
            if self.run["stop"] != Stop.FULL:
                return Stop(self.run["stop"])
            self._more(np.zeros, np.concatenate)

    def _plain(self) -> Stop:
        """Run on lists of objects, in plain Python."""
        matrix = np.zeros((self._size, self._size + 1)).tolist()
        r = self.records = {name: compiling.as_objects(a) for name, a in self.records.items()}
        try:
            while True:
                stop = Stop(march.follow(
                    r["run"], *(r[name] for name in OWN[1:-1]), r["log"], r["turn"], r["part"],
                    matrix))
                if stop != Stop.FULL:
                    return stop
                self._more(_objects, _joined)
        finally:
            self.records = {
                name: compiling.as_records(objects, self._kinds[name])
                for name, objects in self.records.items()
            }

    def _more(self, room: Any, joined: Any) -> None:
        """Double the log."""
        r = self.records
        size = len(r["log"]) * self._kinds["log"].itemsize / 8
        ask(4 * size, "until", f"a run of more than {len(r['log'])} pieces of waves",
            "stop earlier, or take a larger rtol")
        for name in ("log", "turn"):
            r[name] = joined((r[name], room(len(r[name]), self._kinds[name])))


def _objects(count: int, record: Any) -> list[Any]:
    return compiling.as_objects(np.zeros(count, record))


def _joined(lists: Any) -> list[Any]:
    first, second = lists
    return [*first, *second]
