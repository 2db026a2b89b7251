"""Runs of the kernels on records: one collision in plain Python or compiled, families compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import compiling
from . import march
from .layout import Layout
from .records import PIECE, TURN, Stop
from .series import N

FIRST_ROOM = 256
FIRST_TURNS = 2048


class Machine:
    """One collision on its records: lists of objects in plain Python, then arrays of records."""

    def __init__(self, layout: Layout, member: int = 0, compiled: bool = False) -> None:
        self.layout = layout
        known = layout.first[member]
        log = np.zeros(FIRST_ROOM + 2 * len(known), PIECE)
        log[: len(known)] = known
        run = layout.run[member : member + 1].copy()
        run["pieces"] = len(known)
        self.records = {
            "run": run, "log": log, "turn": np.zeros(FIRST_TURNS, TURN),
            **{name: getattr(layout, name)[member].copy()
               for name in ("node", "link", "mass", "line", "part")},
        }
        self.kinds = {name: array.dtype for name, array in self.records.items()}
        unknowns = N * max(2 * int(self.records["node"]["links"].max()) - 1, 1)
        self._size = unknowns
        self.compiled = compiled
        if not compiled:
            self.records = {name: compiling.as_objects(a) for name, a in self.records.items()}

    def to_records(self) -> None:
        if not self.compiled:
            self.records = {
                name: compiling.as_records(objects, self.kinds[name])
                for name, objects in self.records.items()
            }
            self.compiled = True

    def go(self) -> int:
        while True:
            G: Any = np.zeros((self._size, self._size + 1))
            follow: Any = march.follow
            if self.compiled:
                follow = compiling.compiled(march, "follow")
            else:
                G = G.tolist()
            r = self.records
            stop = Stop(follow(r["run"] if self.compiled else r["run"], *(r[name] for name in (
                "node", "link", "mass", "line", "log", "turn", "part")), G))
            if stop != Stop.FULL:
                return stop
            for name in ("log", "turn"):
                more: Any = np.zeros(len(r[name]), self.kinds[name])
                r[name] = np.concatenate((r[name], more)) if self.compiled else (
                    r[name] + compiling.as_objects(more))
