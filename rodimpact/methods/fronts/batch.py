"""The records of members that run one after the other, as lists or as arrays.

Plain Python runs on lists of objects, until machine code pays: then all goes on in
arrays of records.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import kernels
from ..memory import require_memory
from ..record_lists import as_objects, as_records, blank, lengthened
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

INITIAL_LOG_ROWS = 32  # rows of the log, in addition to those at t = 0
NUMBERS_PER_ROW = (
    18  # memory of a row of the log with its signals, in numbers of 8 bytes
)
NUMBERS_PER_LIST_ROW = 60  # the same in plain Python
PLAIN_ROW_TIME = 1e-5  # s, approximate cost of a row of the log in plain Python

RECORD_TYPES = {
    "runs": RUN,
    "durations": CACHED_DURATION,
    "initial_pieces": INITIAL_PIECE,
    "segments": SEGMENT,
    "nodes": NODE,
    "lines": LINE,
    "log": FRONT,
}
"""Types of the records of a `State`, by its fields."""


class RunRequest(NamedTuple):
    """What is wanted of a run: fields of `records.Run`."""

    until: float | None  # end, s; None: to the proof of finality
    max_events: int
    run_past_proof: bool = False
    record_max_stress: bool = False
    perturb_rounding: bool = False

    def store(self, run: Run) -> None:
        """Store the request in the record of a run."""
        run.until = -1.0 if self.until is None else self.until
        run.max_events = self.max_events
        run.run_past_proof = int(self.run_past_proof)
        run.record_max_stress = int(self.record_max_stress)
        run.perturb_rounding = int(self.perturb_rounding)


class Batch:
    """Members of a family that run one after the other on the same records.

    Parameters
    ----------
    layout : FamilyLayout
    request : RunRequest
    is_compiled : bool
        Whether they run in machine code.

    Attributes
    ----------
    state : State
        In machine code of arrays, else of lists of objects.
    """

    def __init__(
        self, layout: FamilyLayout, request: RunRequest, *, is_compiled: bool
    ) -> None:
        self.layout = layout
        self.is_compiled = False
        self.state = make_state(layout, INITIAL_LOG_ROWS, [])
        request.store(self.state.runs[0])
        self._result_buffer = np.empty((0, len(layout.closed_status)), NODE_RESULT)
        if is_compiled:
            self.to_arrays()

    def load_members(self, values: Array) -> None:
        """Take the values of other members, [member, value]."""
        member_count = len(values)
        node_count = len(self.layout.closed_status)
        if self.is_compiled:
            # Results reuse the memory: new memory takes longer than a run.
            if len(self._result_buffer) < member_count:
                self._result_buffer = np.empty((member_count, node_count), NODE_RESULT)
            results: Any = self._result_buffer[:member_count]
            rows: Any = values
        else:
            results = [blank(node_count, NODE_RESULT) for _ in range(member_count)]
            rows = values.tolist()
        self.state = self.state._replace(values=rows, results=results)

    def run(self) -> bool:
        """Run the members; return whether all have ended, else the log must grow."""
        kernel: Any = run_members
        if self.is_compiled:
            kernel = kernels.compiled(run_members)
        return bool(kernel(self.state))

    def grow_log(self) -> None:
        """Make the log longer; TooLong if that takes too much memory."""
        rows = len(self.state.log)
        numbers = rows * NUMBERS_PER_LIST_ROW
        if self.is_compiled:
            numbers = rows * 2 * NUMBERS_PER_ROW  # takes memory as its rows are used
        require_memory(
            numbers,
            "max_events",
            f"a run of more than {rows} fronts",
            "lower the cap, or stop earlier (until)",
        )
        self.state = self.state._replace(log=lengthened(self.state.log, FRONT))

    def compile_if_long(self) -> None:
        """Go on in machine code if the present member has taken long in plain Python."""
        if self.is_compiled:
            return
        # An unfinished run is expected to take as long again as it has taken so far.
        seconds = len(self.state.log) * PLAIN_ROW_TIME
        if kernels.worth_compiling(seconds, run_members):
            self.to_arrays()

    def to_arrays(self) -> None:
        """Go on in machine code."""
        arrays: dict[str, Any] = {name: self.array(name) for name in RECORD_TYPES}
        arrays["values"] = np.array(self.state.values, dtype=float)
        arrays["queue"] = np.array(self.state.queue)
        arrays["results"] = self.results()
        self.state = State(**arrays)
        self.is_compiled = True

    def array(self, name: str) -> Any:
        """The records of a field of the state as an array."""
        records = getattr(self.state, name)
        if self.is_compiled:
            return records
        return as_records(records, RECORD_TYPES[name])

    def objects(self, name: str) -> list[Any]:
        """The records of a field of the state as objects."""
        records: Any = getattr(self.state, name)
        if self.is_compiled:
            return as_objects(records)
        objects: list[Any] = records
        return objects

    def results(self) -> Any:
        """Results of the members as an array, [member, node]."""
        results: Any = self.state.results
        if self.is_compiled:
            return results
        members: Sequence[Any] = results
        return np.array([as_records(member, NODE_RESULT) for member in members])

    @property
    def progress(self) -> Run:
        """The record of the run."""
        run: Run = self.objects("runs")[0]
        return run
