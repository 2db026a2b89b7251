"""From a row, or a family of them, to the records of the kernels, and their runs.

Plain Python goes first, machine code where that pays.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ...progress import Report, no_report
from .. import compiling, kernels, record_lists
from ..memory import ask
from ..row import Row
from ..run import Stopped
from ..states import Stop
from . import layout, march
from .accuracy import Ended
from .known import Known, as_family
from .layout import Asked
from .records import LINE, LINK, MASS, NEVER, NODE, PART, PIECE, RUN, TURN
from .rows import family_clock, own_laws
from .series import N

RECORDS = {
    "run": RUN,
    "node": NODE,
    "link": LINK,
    "mass": MASS,
    "line": LINE,
    "part": PART,
}
LISTS = {"log": PIECE, "turn": TURN}
ROOM, TURNS = 256, 2048  # pieces of the log, and changes of contacts, at first
CALL = 64  # members between two looks whether to stop
PLAIN = 500  # steps in plain Python between two looks at the clock
STEP_TIME = 1.5e-3  # s, about what such a step takes
BRIEF = 0.02  # s that a run takes at least: many short ones are worth machine code, too
UNEQUAL = 1000  # ratio of transit times from which on the shortest decides the number of pieces
SLICE = 100_000  # compiled steps between two looks at the clock


class Members:
    """Every member of a family on records, [member, i]; a single collision is a family of one.

    They run one after the other, on their own records and one log.

    Parameters
    ----------
    row : Row
        Or a family of even ones.
    asked : Asked

    Attributes
    ----------
    run, node, link, mass, line, part : [member, i] array
        Records; there is one run of each member.
    first : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit : float
        By how much samples miss the functions that they stand for, relative to the velocity scale.
    carried : float
        Stated error of the run from whose state this one goes on, relative to the velocity scale.
    own : tuple of (int, function)
        Laws of the user, by link.
    log, turn : array
        Pieces and changes of contacts of the member that ran last, as many as its run says.

    Raises
    ------
    InvalidModel
        If transit times are too far apart for one clock, or the run is too long for it.
    """

    def __init__(self, row: Row, asked: Asked) -> None:
        self.row, self.asked, self.own = row, asked, own_laws(row)
        self.clock, jumps = family_clock(row, asked.until)
        known = Known(row, self.clock, jumps, asked)
        laid = layout.lay_out(row, self.clock, asked, known.lines, known.outside)
        self.first = np.concatenate(known.log, axis=1)
        self.fit = known.fit
        self.carried = known.carried
        self.run, self.node, self.link, self.mass, self.line, self.part = (
            as_family(objects, kind, row)
            for kind, objects in zip(RECORDS.values(), laid, strict=True)
        )
        self.log, self.turn = (
            np.zeros(ROOM + 2 * self.first.shape[1], PIECE),
            np.zeros(TURNS, TURN),
        )
        unknowns = N * int(self.node["links"].max())  # of the longest chain
        self._matrix = np.zeros((unknowns, unknowns + 1))

    def run_of(self, member: int) -> Any:
        """The record of the run of a member, by names of its fields."""
        return self.run[member].view(np.recarray)[0]

    def ended(self, member: int) -> Ended:
        """What a member came to, as objects."""
        run, link, part = map(
            record_lists.as_objects,
            (self.run[member], self.link[member], self.part[member]),
        )
        return Ended(run[0], link, part)

    def run_all(
        self,
        members: Iterable[int],
        stop: Callable[[], bool] = lambda: False,
        report: Report = no_report,
    ) -> None:
        """Run some members; raise Stopped if `stop`, asked now and then, says so."""
        for count, m in enumerate(members):
            if count % CALL == 0 and stop():
                raise Stopped
            self.go(m, report)

    def records(self, member: int = 0) -> dict[str, Any]:
        """Arrays of the records of a member, in the order of the kernel's arguments."""
        own = {name: getattr(self, name)[member] for name in RECORDS}
        return own | {"log": self.log, "turn": self.turn, "matrix": self._matrix}

    def start(self, member: int = 0) -> dict[str, Any]:
        """Enter what is known of a member at t = 0 in the log; return its records."""
        self.log[: self.first.shape[1]] = self.first[member]
        return self.records(member)

    def go(self, member: int = 0, report: Report = no_report) -> None:
        """Run a member to its end, in slices."""
        self.start(member)
        run = self.run_of(member)
        limit, spent, stop = int(run.limit), BRIEF, Stop.CAP
        while stop == Stop.CAP and run.steps < limit:
            taken = int(run.steps)
            fast = compiling.can_be(self.own) and kernels.worth_compiling(
                spent, march.follow
            )
            plain = max(PLAIN, taken // 2)  # as all records change their form each time
            run.limit = min(limit, taken + (SLICE if fast else plain))
            stop = self._slice(member, fast)
            spent = (int(run.steps) - taken) * STEP_TIME
            if stop == Stop.CAP:
                report(int(run.steps), self._expected_steps(member, limit))
        run.limit = limit

    def _expected_steps(self, member: int, limit: int) -> int | None:
        """About how many steps a run to a given time has; None where a proof ends it."""
        run = self.run_of(member)
        reached = int(self.node[member]["now"].min())
        if run.extra != NEVER or reached <= 0:
            return None
        return min(limit, int(run.steps * (float(run.end) / reached)) + 1)

    def _remedy(self) -> str:
        """What to do where a run has too many pieces."""
        transits = [float(np.max(transit)) for transit in self.clock.transits]
        shortest = min(transits, default=0.0)
        longest = max(transits, default=0.0)
        if longest <= UNEQUAL * shortest:
            return "stop earlier, or take a larger rtol"
        path = self.row.paths[transits.index(shortest) + 1]
        return (
            f"no piece is longer than the transit time of {path}, which is "
            f"{shortest / longest:.1g} of the longest: make it longer, replace it by a rigid "
            "mass, or stop earlier"
        )

    def _slice(self, member: int, fast: bool) -> Stop:
        """Run on: on arrays of records, or on lists of objects in plain Python."""
        held = self.records(member)
        if fast:
            follow: Any = compiling.compiled(march.follow, self.own)
        else:
            follow = compiling.interpreted(march.follow, self.own)
            held = {
                name: record_lists.as_objects(array) for name, array in held.items()
            }
        while (stop := Stop(follow(*held.values()))) == Stop.FULL:
            pieces = len(held["log"])
            ask(
                4 * pieces * PIECE.itemsize / 8,
                "until",
                f"a run of more than {pieces} pieces of waves",
                self._remedy(),
            )
            for name, kind in LISTS.items():
                held[name] = record_lists.lengthened(held[name], kind)
        if not fast:
            held = {
                name: record_lists.as_records(held[name], kind)
                for name, kind in (RECORDS | LISTS).items()
            }
            for name in RECORDS:
                getattr(self, name)[member] = held[name]
        self.log, self.turn = held["log"], held["turn"]
        return stop
