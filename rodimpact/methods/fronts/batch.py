"""Requests for runs, and batches of members that run one after the other on a state."""

from typing import Any, NamedTuple

import numpy as np

from ...progress import ProgressReport, no_report
from ..batch import Batch
from ..memory import require_memory
from ..record_lists import blank
from ..row import Array
from .family_layout import FamilyLayout, make_state
from .members import run_members
from .records import (
    CACHED_DURATION,
    FRONT,
    INITIAL_PIECE,
    LINE,
    NODE,
    NODE_RESULT,
    RUN,
    SEGMENT,
    Run,
    State,
)

INITIAL_LOG_ROWS = 32
"""Rows of the log, in addition to those at t = 0."""
NUMBERS_PER_ROW = 18
"""Memory of a row of the log with its signals, in numbers of 8 bytes, if compiled."""
NUMBERS_PER_LIST_ROW = 60
"""Memory of a row of the log with its signals in plain Python, in the same numbers."""
PLAIN_ROW_TIME = 1e-5
"""Approximate time that plain Python takes for a row of the log, s."""

RECORD_TYPES = {
    "runs": RUN,
    "durations": CACHED_DURATION,
    "initial_pieces": INITIAL_PIECE,
    "segments": SEGMENT,
    "nodes": NODE,
    "lines": LINE,
    "log": FRONT,
    "results": NODE_RESULT,
}
"""Types of the records of a `State`, by its fields."""


class RunRequest(NamedTuple):
    """The request for a run: fields of `records.Run`."""

    until: float | None  # end, s; None: to the proof of finality
    max_events: int
    run_past_proof: bool = False
    record_max_stress: bool = False
    perturb_rounding: bool = False

    def store(self, run: Run) -> None:
        """Copy the fields of the request to the record of a run; flags become 0 or 1.

        If `until` is None, that of the record becomes -1: no end is given, and the
        clock counts the whole default horizon, see `records.Run`.
        """
        run.until = -1.0 if self.until is None else self.until
        run.max_events = self.max_events
        run.run_past_proof = int(self.run_past_proof)
        run.record_max_stress = int(self.record_max_stress)
        run.perturb_rounding = int(self.perturb_rounding)


class FrontBatch(Batch[State]):
    """Members of a family that run one after the other on the same records.

    Parameters
    ----------
    layout : FamilyLayout
    request : RunRequest
    is_compiled : bool
        Whether they run in machine code.
    """

    def __init__(
        self, layout: FamilyLayout, request: RunRequest, *, is_compiled: bool
    ) -> None:
        """Make the state for a layout and a request; `load_members` adds the members.

        The request is stored in the record of the run. Records are lists of objects, or
        arrays if the members are to run in machine code.
        """
        state = make_state(layout, INITIAL_LOG_ROWS, values=[])  # no members yet
        request.store(state.runs[0])
        # `make_state` makes lists; `to_arrays` below turns them into arrays.
        super().__init__(run_members, state, RECORD_TYPES, is_compiled=False)
        self.layout = layout
        self._result_buffer = np.empty((0, len(layout.closed_status)), NODE_RESULT)
        if is_compiled:
            self.to_arrays()

    def load_members(self, values: Array) -> None:
        """Replace the members of the state by those with `values`, [member, value].

        The state gets new blank records for the results of these members. In machine
        code it gets the array of earlier results instead, or a longer one, with any old
        content, which the run overwrites. Nothing runs yet.
        """
        member_count = len(values)
        node_count = len(self.layout.closed_status)  # one status for each node
        if self.is_compiled:
            # A new array takes longer than a run, so that one is made only if the
            # buffer is too small.
            if len(self._result_buffer) < member_count:
                self._result_buffer = np.empty((member_count, node_count), NODE_RESULT)
            results: Any = self._result_buffer[:member_count]
            rows: Any = values
        else:
            results = [blank(node_count, NODE_RESULT) for _ in range(member_count)]
            rows = values.tolist()
        self.state = self.state._replace(values=rows, results=results)

    def run_to_end(self, report: ProgressReport = no_report) -> None:
        """Run the loaded members to their ends; their results in the state are set.

        Whenever the log is full it grows, and the state may change from lists to
        arrays. `report` is then called with the number of events so far, and with the
        expected number or None, see `expected_events`.

        Raises
        ------
        TooLong
            If the log of one of them takes too much memory.
        """
        while not self.run():  # the log is full
            # An unfinished run is expected to take as long again as it has so far.
            self.choose_form(len(self.state.log) * PLAIN_ROW_TIME)
            progress = self.progress
            report(int(progress.events), expected_events(progress))
            self._require_memory_for_log()
            self.lengthen("log")

    def _require_memory_for_log(self) -> None:
        """Raise TooLong if the next, longer log takes too much memory.

        Its signals count, too. The log is not changed. A thread with a share of memory
        may have to wait here, see `require_memory`.
        """
        rows = len(self.state.log)
        # Numbers of 8 bytes that the longer log and its signals take
        if self.is_compiled:
            # The array grows to four times its rows, but rows take memory only when
            # they are used: twice the present rows are counted.
            numbers = rows * 2 * NUMBERS_PER_ROW
        else:
            numbers = rows * NUMBERS_PER_LIST_ROW
        require_memory(
            numbers,
            "max_events",
            f"a run of more than {rows} fronts",
            "lower the cap, or stop earlier (until)",
        )

    @property
    def progress(self) -> Run:
        """The record of the run, as an object; in machine code it is a copy."""
        run: Run = self.objects("runs")[0]
        return run


def expected_events(run: Run) -> int | None:
    """Expected number of events of a run to a given end, at most its `max_events`.

    The mean rate of events so far is assumed to continue. The number is None if the run
    has no given end, or if it is still at t = 0.
    """
    if run.end_tick <= 0 or run.now <= 0:  # NONE, without a given end, is -1
        return None
    expected = int(run.events) * int(run.end_tick) // int(run.now)
    return min(int(run.max_events), expected)
