"""Runs of a row, or of all members of a family.

The records of all members are made from the row. Kernels run on them in plain Python at
first, and in machine code where compiling pays.
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
"""Fields of a `State` that each member has for itself; all members share the others."""
INITIAL_LOG_ROWS = 256
"""Rows of the log of pieces at first, besides two for each piece known at t = 0."""
INITIAL_CONTACT_ROWS = 2048
"""Rows of the log of contacts at first.

One step may add somewhat more than `march.MAX_STATUS_CHANGES`.
"""
MEMBERS_PER_CHECK = 64
"""Number of members between two calls of `should_stop`."""
PLAIN_STEPS = 500
"""Smallest number of steps in plain Python between two decisions whether to compile."""
STEP_TIME = 1.5e-3
"""Estimated time of a step in plain Python, s."""
MIN_RUN_TIME = 0.02
"""Least time that is counted for a run, s: many short runs are worth compiling."""
UNEQUAL_TRANSITS = 1000
"""Ratio of longest to shortest transit, above which errors name the shortest segment.

The shortest transit decides the number of pieces then.
"""
COMPILED_STEPS = 100_000
"""Number of compiled steps between two reports."""


class Members:
    """Records of all members of a family, which run one after another.

    A single collision is a family with one member. All members run on one `Batch`,
    which holds the records of one member at a time.

    Parameters
    ----------
    row : Row
        A family has no profiles, see `clock_setup.has_profiles`.
    request : RunRequest

    Attributes
    ----------
    runs, nodes, links, masses, lines, parts : [member, i] array
        Records; each member has one run.
    first_pieces : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit_error : float
        Largest difference of profiles from these pieces, as in `InitialLines`, relative
        to the velocity scale.
    carried_error : float
        Stated error of the run from whose state this one goes on, relative to the
        velocity scale.

    Raises
    ------
    InvalidModel
        If transit times are too unequal for one clock, the run is too long for it, or a
        contact in a row without rods is too short.
    """

    def __init__(self, row: Row, request: RunRequest) -> None:
        """Make the clock, the records of all members, and a `Batch`; nothing runs yet.

        The batch holds the first member, as arrays for machine code, with empty logs
        and a matrix for the largest node.
        """
        self.row = row
        self.request = request
        self.clock, jumps = family_clock(row, request.until)
        initial = InitialLines(row, self.clock, jumps, request)
        laid = layout.lay_out(row, self.clock, request, initial.lines, initial.outside)
        self.first_pieces = np.concatenate(initial.log, axis=1)
        self.fit_error = initial.fit_error
        self.carried_error = initial.carried_error
        runs, nodes, links, masses, lines, parts = laid
        self.runs = records_of_family(runs, RUN, row)
        self.nodes = records_of_family(nodes, NODE, row)
        self.links = records_of_family(links, LINK, row)
        self.masses = records_of_family(masses, MASS, row)
        self.lines = records_of_family(lines, LINE, row)
        self.parts = records_of_family(parts, GROUP_PART, row)
        # Each link of a node may have an unknown force, with a value at each of N
        # stages. The matrix of the equations has one more column for the right side.
        unknowns = N * int(self.nodes["link_count"].max())
        # Arrays by field of `State`
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
        """The `State` of the member that ran last, as arrays."""
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
        """Run the members with these numbers, one after another, each to its end.

        `should_stop` is called before the first member, and again after every
        MEMBERS_PER_CHECK members. `report` gets the progress of each run. The results
        are stored in the records of the members.

        Raises
        ------
        Stopped
            If `should_stop` returns True.
        TooLong
            If a run takes too much memory.
        """
        for count, m in enumerate(members):
            if count % MEMBERS_PER_CHECK == 0 and should_stop():
                raise Stopped
            self.run_member(m, report)

    def load(self, member: int = 0) -> None:
        """Load the records of a member into the batch, in its present form.

        The pieces of the member at t = 0 become the first rows of the log of the batch;
        its other rows are left as they are, since runs overwrite them.
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
        """Records in the present form of the batch: the array, or a list of objects."""
        if self.batch.is_compiled:
            return array
        return as_objects(array)

    def store(self, member: int) -> None:
        """Copy the records in the batch to the records of a member."""
        for name in MEMBER_FIELDS:
            self.records(name)[member] = self.batch.array(name)

    def run_member(self, member: int = 0, report: ProgressReport = no_report) -> None:
        """Run a member to its end, or to the cap on steps, and store its records.

        It runs in slices of steps. A slice that does not reach the end of the run stops
        with CAP. Then `report` gets the numbers of steps so far and of expected steps,
        and the run may change from plain Python to machine code.

        Raises
        ------
        TooLong
            If the run takes too much memory.
        """
        batch = self.batch
        batch.choose_form(MIN_RUN_TIME)  # plain Python, until machine code pays
        self.load(member)
        max_steps = self.request.max_steps
        steps = 0  # done so far
        stop = Stop.CAP
        while stop == Stop.CAP and steps < max_steps:
            if batch.is_compiled:
                slice_steps = COMPILED_STEPS
            else:
                # A slice is half as long as all slices before it: there are few
                # decisions whether to compile, and none is late.
                slice_steps = max(PLAIN_STEPS, steps // 2)
            self._set_max_steps(min(max_steps, steps + slice_steps))
            stop = self._run_slice()
            run = batch.objects("runs")[0]
            slice_time = (run.steps - steps) * STEP_TIME  # s, in plain Python
            steps = run.steps
            if stop == Stop.CAP:
                report(steps, self._expected_steps(run))
                batch.choose_form(slice_time)
        self._set_max_steps(max_steps)  # the record keeps this, not that of a slice
        self.store(member)

    def _set_max_steps(self, max_steps: int) -> None:
        """Set `max_steps`, the largest number of steps, of the run in the batch."""
        runs: Any = self.batch.state.runs
        if self.batch.is_compiled:
            runs["max_steps"] = max_steps
        else:
            runs[0].max_steps = max_steps

    def _expected_steps(self, run: Run) -> int | None:
        """Estimated number of all steps of a run to a given end, or None.

        It assumes that steps are evenly spread over time, and is at most the cap of
        the request. It is None if a proof may end the run, and as long as some node is
        still at t = 0.
        """
        reached = min(node.now for node in self.batch.objects("nodes"))
        is_ended_by_proof = run.ticks_after_proof != NEVER
        if is_ended_by_proof or reached <= 0:
            return None
        expected = int(run.steps * (float(run.end_tick) / reached)) + 1  # rounded up
        return min(self.request.max_steps, expected)

    def _run_slice(self) -> Stop:
        """Continue the run up to its `max_steps`; return why it stopped, never FULL.

        If a log is full, both logs are lengthened, and the run goes on.

        Raises
        ------
        TooLong
            If the pieces of the run take too much memory.
        """
        batch = self.batch
        stop = Stop(batch.run())
        while stop == Stop.FULL:
            pieces = len(batch.state.log)
            # `lengthen` makes the log two or four times as long: 4 is the upper bound.
            # Memory is counted in numbers of 8 bytes.
            numbers = 4 * pieces * PIECE.itemsize / 8
            require_memory(
                numbers,
                "until",
                f"a run of more than {pieces} pieces of waves",
                self._remedy(),
            )
            batch.lengthen("log", "contact_log")
            stop = Stop(batch.run())
        return stop

    def _remedy(self) -> str:
        """Advice in an error message about too many pieces.

        It is to stop earlier, or to take a larger rtol. If transit times are very
        unequal, it names the shortest segment instead.
        """
        transits = [float(np.max(transit)) for transit in self.clock.transits]
        shortest = min(transits, default=0.0)
        longest = max(transits, default=0.0)
        if longest <= UNEQUAL_TRANSITS * shortest:
            return "stop earlier, or take a larger rtol"
        s = transits.index(shortest)  # number of the segment, from 0
        path = self.row.paths[s + 1]  # paths count segments from 1
        return (
            f"no piece is longer than the transit time of {path}, which is "
            f"{shortest / longest:.1g} of the longest: make it longer, replace it by a "
            "rigid mass, or stop earlier"
        )
