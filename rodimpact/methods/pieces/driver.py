"""From a row, or a family of them, to the records of the kernels, and their runs.

Plain Python goes first, machine code where that pays.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ...progress import Report, no_report
from .. import compiling, kernels, record_lists
from ..memory import require_memory
from ..row import Row
from ..run import Stopped
from ..states import Stop
from . import layout, march
from .accuracy import Ended
from .known import Known, as_family
from .layout import RunRequest
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
ROOM = 256
"""Rows of the log of pieces at first, besides two for each that is known at t = 0."""
TURNS = 2048
"""Rows of the log of contacts at first."""
CALL = 64
"""Number of members between two looks whether to stop."""
PLAIN_STEPS = 500
"""Least number of steps in plain Python between two decisions whether to compile."""
STEP_TIME = 1.5e-3
"""Estimated time of a step in plain Python, s."""
MIN_RUN_TIME = 0.02
"""Time that is counted for a run at least, s: many short runs are worth compiling, too."""
UNEQUAL_TRANSITS = 1000
"""Ratio of transit times from which on the shortest decides the number of pieces."""
COMPILED_STEPS = 100_000
"""Number of compiled steps between two reports."""


class Members:
    """Every member of a family on records, [member, i]; a single collision is a family of one.

    They run one after the other, on their own records and one log.

    Parameters
    ----------
    row : Row
        Or a family of even ones.
    request : RunRequest

    Attributes
    ----------
    run, node, link, mass, line, part : [member, i] array
        Records; there is one run of each member.
    first : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit : float
        Largest miss of the pieces at t = 0, as of `Known`, relative to the velocity scale.
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

    def __init__(self, row: Row, request: RunRequest) -> None:
        self.row = row
        self.request = request
        self.own = own_laws(row)
        self.clock, jumps = family_clock(row, request.until)
        known = Known(row, self.clock, jumps, request)
        laid = layout.lay_out(row, self.clock, request, known.lines, known.outside)
        self.first = np.concatenate(known.log, axis=1)
        self.fit = known.fit
        self.carried = known.carried
        runs, nodes, links, masses, lines, parts = laid
        self.run = as_family(runs, RUN, row)
        self.node = as_family(nodes, NODE, row)
        self.link = as_family(links, LINK, row)
        self.mass = as_family(masses, MASS, row)
        self.line = as_family(lines, LINE, row)
        self.part = as_family(parts, PART, row)
        self.log = np.zeros(ROOM + 2 * self.first.shape[1], PIECE)
        self.turn = np.zeros(TURNS, TURN)
        longest_chain = int(self.node["links"].max())
        unknowns = N * longest_chain
        self._matrix = np.zeros((unknowns, unknowns + 1))

    def run_of(self, member: int) -> Any:
        """The record of the run of a member, by names of its fields."""
        return self.run[member].view(np.recarray)[0]

    def ended(self, member: int) -> Ended:
        """Records of a member at the end of its run, as objects."""
        runs = record_lists.as_objects(self.run[member])
        links = record_lists.as_objects(self.link[member])
        parts = record_lists.as_objects(self.part[member])
        return Ended(runs[0], links, parts)

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
        records = {name: getattr(self, name)[member] for name in RECORDS}
        records["log"] = self.log
        records["turn"] = self.turn
        records["matrix"] = self._matrix
        return records

    def start(self, member: int = 0) -> dict[str, Any]:
        """Enter the pieces of a member at t = 0 in the log; return its records."""
        self.log[: self.first.shape[1]] = self.first[member]
        return self.records(member)

    def go(self, member: int = 0, report: Report = no_report) -> None:
        """Run a member to its end, in slices."""
        self.start(member)
        run = self.run_of(member)
        limit = int(run.limit)
        spent = MIN_RUN_TIME
        stop = Stop.CAP
        while stop == Stop.CAP and run.steps < limit:
            taken = int(run.steps)
            fast = compiling.can_be(self.own)
            fast = fast and kernels.worth_compiling(spent, march.follow)
            steps = COMPILED_STEPS
            if not fast:  # all records change their form each time
                steps = max(PLAIN_STEPS, taken // 2)
            run.limit = min(limit, taken + steps)
            stop = self._slice(member, fast)
            spent = (int(run.steps) - taken) * STEP_TIME
            if stop == Stop.CAP:
                report(int(run.steps), self._expected_steps(member, limit))
        run.limit = limit

    def _expected_steps(self, member: int, limit: int) -> int | None:
        """Estimated number of steps of a run to a given time; None where a proof ends it."""
        run = self.run_of(member)
        reached = int(self.node[member]["now"].min())
        if run.extra != NEVER or reached <= 0:
            return None
        expected = int(run.steps * (float(run.end) / reached)) + 1
        return min(limit, expected)

    def _remedy(self) -> str:
        """Advice for a run of too many pieces."""
        transits = [float(np.max(transit)) for transit in self.clock.transits]
        shortest = min(transits, default=0.0)
        longest = max(transits, default=0.0)
        if longest <= UNEQUAL_TRANSITS * shortest:
            return "stop earlier, or take a larger rtol"
        path = self.row.paths[transits.index(shortest) + 1]
        return (
            f"no piece is longer than the transit time of {path}, which is "
            f"{shortest / longest:.1g} of the longest: make it longer, replace it by a rigid "
            "mass, or stop earlier"
        )

    def _slice(self, member: int, fast: bool) -> Stop:
        """Run on up to the limit of the run, on arrays of records or in plain Python."""
        if fast:
            return self._compiled_slice(member)
        return self._plain_slice(member)

    def _compiled_slice(self, member: int) -> Stop:
        """Run on in machine code, which works on the records themselves."""
        records = self.records(member)
        stop = self._follow(compiling.compiled(march.follow, self.own), records)
        self.log = records["log"]
        self.turn = records["turn"]
        return stop

    def _plain_slice(self, member: int) -> Stop:
        """Run on in plain Python, which works on lists of objects: they are copied back."""
        lists = {}
        for name, array in self.records(member).items():
            lists[name] = record_lists.as_objects(array)
        stop = self._follow(compiling.interpreted(march.follow, self.own), lists)
        for name, kind in RECORDS.items():
            getattr(self, name)[member] = record_lists.as_records(lists[name], kind)
        self.log = record_lists.as_records(lists["log"], PIECE)
        self.turn = record_lists.as_records(lists["turn"], TURN)
        return stop

    def _follow(self, follow: Any, records: dict[str, Any]) -> Stop:
        """Call the kernel on these records, with longer logs as often as they are full."""
        stop = Stop(follow(*records.values()))
        while stop == Stop.FULL:
            pieces = len(records["log"])
            require_memory(
                4 * pieces * PIECE.itemsize / 8,
                "until",
                f"a run of more than {pieces} pieces of waves",
                self._remedy(),
            )
            for name, kind in LISTS.items():
                records[name] = record_lists.lengthened(records[name], kind)
            stop = Stop(follow(*records.values()))
        return stop
