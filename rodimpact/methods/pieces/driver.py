"""From a row, or a family of them, to the records of the kernels, and their runs.

Plain Python goes first, machine code where that pays.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ...progress import ProgressReport, no_report
from ..batch import Batch
from ..memory import require_memory
from ..record_lists import as_objects
from ..row import Row
from ..run import Stopped
from ..states import Stop
from . import layout, march
from .accuracy import Ended
from .clock_setup import family_clock, own_laws
from .initial_lines import InitialLines, records_of_family
from .layout import RunRequest
from .records import (
    CONTACT_EVENT,
    GROUP_PART,
    LINE,
    LINK,
    MASS,
    NEVER,
    NODE,
    PIECE,
    RUN,
    Run,
    State,
)
from .series import N

RECORD_TYPES = {
    "runs": RUN,
    "nodes": NODE,
    "links": LINK,
    "masses": MASS,
    "lines": LINE,
    "parts": GROUP_PART,
    "log": PIECE,
    "contact_log": CONTACT_EVENT,
}
"""Types of the records of a `State`, by its fields."""
MEMBER_FIELDS = ("runs", "nodes", "links", "masses", "lines", "parts")
"""Fields of which every member has its own records; the others are handed on."""
INITIAL_LOG_ROWS = 256
"""Rows of the log of pieces at first, besides two for each that is known at t = 0."""
INITIAL_CONTACT_ROWS = 2048
"""Rows of the log of contacts at first.

A step may add `march.MAX_STATUS_CHANGES` and more.
"""
MEMBERS_PER_CHECK = 64
"""Number of members between two questions whether to stop."""
PLAIN_STEPS = 500
"""Least number of steps in plain Python between two decisions whether to compile."""
STEP_TIME = 1.5e-3
"""Estimated time of a step in plain Python, s."""
MIN_RUN_TIME = 0.02
"""Least time that is counted for a run, s: many short runs are worth compiling."""
UNEQUAL_TRANSITS = 1000
"""Ratio of transit times from which on the shortest decides the number of pieces."""
COMPILED_STEPS = 100_000
"""Number of compiled steps between two reports."""


class Members:
    """Records of every member of a family, [member, i], which run one after the other.

    They run on one `Batch`, on which the records of one member are at a time. A single
    collision is a family of one.

    Parameters
    ----------
    row : Row
        A family has no profiles, see `clock_setup.has_profiles`.
    request : RunRequest

    Attributes
    ----------
    runs, nodes, links, masses, lines, parts : [member, i] array
        Records; there is one run of each member.
    first_pieces : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit : float
        Largest miss of the pieces at t = 0, as of `InitialLines`, relative to the
        velocity scale.
    carried : float
        Stated error of the run from whose state this one goes on, relative to the
        velocity scale.

    Raises
    ------
    InvalidModel
        If transit times are too far apart for one clock, or the run is too long for it.
    """

    def __init__(self, row: Row, request: RunRequest) -> None:
        """Lay out the records of all members, and put the first member on a `Batch`.

        The clock is chosen, and the pieces at t = 0 are made; `fit` and `carried` are
        those of `InitialLines`. The batch is in machine form, with empty logs and a
        matrix for the largest node. Nothing runs yet.
        """
        self.row = row
        self.request = request
        self.clock, jumps = family_clock(row, request.until)
        initial = InitialLines(row, self.clock, jumps, request)
        laid = layout.lay_out(row, self.clock, request, initial.lines, initial.outside)
        self.first_pieces = np.concatenate(initial.log, axis=1)
        self.fit = initial.fit
        self.carried = initial.carried
        runs, nodes, links, masses, lines, parts = laid
        self.runs = records_of_family(runs, RUN, row)
        self.nodes = records_of_family(nodes, NODE, row)
        self.links = records_of_family(links, LINK, row)
        self.masses = records_of_family(masses, MASS, row)
        self.lines = records_of_family(lines, LINE, row)
        self.parts = records_of_family(parts, GROUP_PART, row)
        # Each link of a node may have an unknown force, with a value at each of N
        # stages; the matrix of the equations has a column more, their right side.
        unknowns = N * int(self.nodes["link_count"].max())
        arrays: dict[str, Any] = {name: self.records(name)[0] for name in MEMBER_FIELDS}
        log_rows = INITIAL_LOG_ROWS + 2 * self.first_pieces.shape[1]
        arrays["log"] = np.zeros(log_rows, PIECE)
        arrays["contact_log"] = np.zeros(INITIAL_CONTACT_ROWS, CONTACT_EVENT)
        arrays["matrix"] = np.zeros((unknowns, unknowns + 1))
        state = State(**arrays)
        self.batch = Batch[State](
            march.run_nodes,
            state,
            RECORD_TYPES,
            is_compiled=True,
            user_laws=own_laws(row),
        )

    def records(self, name: str) -> Any:
        """Records of all members of one kind, [member, i].

        `name` is one of `MEMBER_FIELDS`.
        """
        return getattr(self, name)

    def state(self) -> Any:
        """The `State` of the member that ran last, as arrays.

        The form of the batch does not matter.
        """
        return State(*[self.batch.array(name) for name in State._fields])

    def ended(self, member: int) -> Ended:
        """Copies of the run, links and parts of a member that has run, as objects."""
        runs = as_objects(self.runs[member])
        links = as_objects(self.links[member])
        parts = as_objects(self.parts[member])
        return Ended(runs[0], links, parts)

    def run_all(
        self,
        members: Iterable[int],
        should_stop: Callable[[], bool] = lambda: False,
        report: ProgressReport = no_report,
    ) -> None:
        """Run members of these numbers, one after another, each to its end.

        `should_stop` is asked before the first of every MEMBERS_PER_CHECK members.
        `report` is handed to each run.

        Raises
        ------
        Stopped
            If `should_stop` says so.
        """
        for count, m in enumerate(members):
            if count % MEMBERS_PER_CHECK == 0 and should_stop():
                raise Stopped
            self.run_member(m, report)

    def load(self, member: int = 0) -> None:
        """Put the records of a member on the batch, in the form of the batch.

        Its pieces at t = 0 go to the beginning of the log there; further rows stay.
        """
        batch = self.batch
        records = {}
        for name in MEMBER_FIELDS:
            records[name] = self._in_form(self.records(name)[member])
        batch.state = batch.state._replace(**records)
        log: Any = batch.state.log
        pieces = self._in_form(self.first_pieces[member])
        log[: len(pieces)] = pieces

    def _in_form(self, array: Any) -> Any:
        """Records in the form of the batch: an array, or a list of objects."""
        if self.batch.is_compiled:
            return array
        return as_objects(array)

    def store(self, member: int) -> None:
        """Copy the records of the batch to those of a member."""
        for name in MEMBER_FIELDS:
            self.records(name)[member] = self.batch.array(name)

    def run_member(self, member: int = 0, report: ProgressReport = no_report) -> None:
        """Run a member to its end, or to the limit of steps, and store its records.

        It runs in slices of steps. A slice before the end of the run stops with CAP:
        then the steps are reported, and the run may change from plain Python to machine
        code.
        """
        batch = self.batch
        batch.choose_form(MIN_RUN_TIME)  # plain Python, until machine code pays
        self.load(member)
        limit = self.request.limit
        steps = 0  # done so far
        stop = Stop.CAP
        while stop == Stop.CAP and steps < limit:
            if batch.is_compiled:
                slice_steps = COMPILED_STEPS
            else:
                # Each slice is half as long as all before it: few decisions, none late
                slice_steps = max(PLAIN_STEPS, steps // 2)
            self._set_limit(min(limit, steps + slice_steps))
            stop = self._run_slice()
            run = batch.objects("runs")[0]
            seconds = (run.steps - steps) * STEP_TIME
            steps = run.steps
            if stop == Stop.CAP:
                report(steps, self._expected_steps(run))
                batch.choose_form(seconds)
        self._set_limit(limit)  # the limit of the last slice may be smaller
        self.store(member)

    def _set_limit(self, limit: int) -> None:
        """Set the largest number of steps of the run in the batch."""
        runs: Any = self.batch.state.runs
        if self.batch.is_compiled:
            runs["max_steps"] = limit
        else:
            runs[0].max_steps = limit

    def _expected_steps(self, run: Run) -> int | None:
        """Estimated number of steps of a run to a given time.

        It is at most the limit of the request. Steps are taken to be evenly spread over
        time. It is None where a proof ends the run, and as long as some node is at t =
        0.
        """
        reached = min(node.now for node in self.batch.objects("nodes"))
        is_ended_by_proof = run.ticks_after_proof != NEVER
        if is_ended_by_proof or reached <= 0:
            return None
        expected = int(run.steps * (float(run.end_tick) / reached)) + 1
        return min(self.request.limit, expected)

    def _run_slice(self) -> Stop:
        """Run on up to the limit of the run; return why it stopped, never FULL.

        Logs that are full are made longer, as often as it takes.

        Raises
        ------
        TooLong
            If the pieces of the run take too much memory.
        """
        batch = self.batch
        stop = Stop(batch.run())
        while stop == Stop.FULL:
            pieces = len(batch.state.log)
            # The longer log has up to four times as many pieces, and stands beside this
            # one for a while. Numbers are of 8 bytes.
            require_memory(
                4 * pieces * PIECE.itemsize / 8,
                "until",
                f"a run of more than {pieces} pieces of waves",
                self._remedy(),
            )
            batch.lengthen("log", "contact_log")
            stop = Stop(batch.run())
        return stop

    def _remedy(self) -> str:
        """Advice, for an error, against too many pieces.

        It is to stop earlier, or to take a larger rtol. Where transit times are very
        unequal it names the shortest segment instead.
        """
        transits = [float(np.max(transit)) for transit in self.clock.transits]
        shortest = min(transits, default=0.0)
        longest = max(transits, default=0.0)
        if longest <= UNEQUAL_TRANSITS * shortest:
            return "stop earlier, or take a larger rtol"
        s = transits.index(shortest)  # counted from 0, while paths are from 1
        path = self.row.paths[s + 1]
        return (
            f"no piece is longer than the transit time of {path}, which is "
            f"{shortest / longest:.1g} of the longest: make it longer, replace it by a "
            "rigid mass, or stop earlier"
        )
