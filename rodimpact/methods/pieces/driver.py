"""Runs of the kernels on records: plain Python first, compiled where that pays."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import compiling, kernels
from . import march
from .layout import Layout
from .records import PIECE, TURN, Stop
from .series import N

FIRST_ROOM = 256  # pieces of a log, at first
FIRST_TURNS = 2048
PLAIN = 2000  # steps that a process takes in plain Python before it compiles
COLUMNS = ("node", "link", "mass", "line", "log", "turn", "part")


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

    def go(self) -> Stop:
        """Run to the end; return why it stopped."""
        compilable = not kernels.why_not()
        limit = int(self.run["limit"])
        stop = Stop.CAP
        if not compilable or Machine.taken < PLAIN:
            if compilable:
                self.records["run"]["limit"] = min(limit, PLAIN)
            stop = self._plain()
            Machine.taken += int(self.run["steps"])
        if stop == Stop.CAP and compilable and self.run["steps"] < limit:
            self.records["run"]["limit"] = limit
            stop = self._follow(compiling.compiled(march, "follow"), np.zeros, np.concatenate)
        return stop

    def _plain(self) -> Stop:
        """Run on lists of objects."""
        self.records = {name: compiling.as_objects(a) for name, a in self.records.items()}
        try:
            return self._follow(
                march.follow, lambda *given: compiling.as_objects(np.zeros(*given)), _joined)
        finally:
            self.records = {
                name: compiling.as_records(objects, self._kinds[name])
                for name, objects in self.records.items()
            }

    def _follow(self, follow: Any, room: Any, joined: Any) -> Stop:
        matrix: Any = np.zeros((self._size, self._size + 1))
        r = self.records
        if isinstance(r["run"], list):
            matrix = matrix.tolist()
        while True:
            stop = Stop(follow(r["run"], *(r[name] for name in COLUMNS), matrix))
            if stop != Stop.FULL:
                return stop
            for name in ("log", "turn"):
                r[name] = joined((r[name], room(len(r[name]), self._kinds[name])))


def _joined(lists: Any) -> Any:
    return lists[0] + lists[1]
