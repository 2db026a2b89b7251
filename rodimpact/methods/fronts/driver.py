"""Runs of the kernels: a single collision, or the members of a family."""

import time
from collections.abc import Callable, Sequence

import numpy as np

from ...progress import ProgressReport, no_report
from .. import kernels
from ..row import Array
from ..run import Stopped
from .batch import INITIAL_LOG_ROWS, PLAIN_ROW_TIME, FrontBatch, RunRequest
from .family_layout import FamilyLayout
from .members import run_members
from .records import NODE_RESULT

PLAIN_PAIR_TIME = 4e-7  # s, comparison of two durations in plain Python

FIRST_BLOCK_SIZE = 64  # members
MAX_BLOCK_SIZE = 2048  # members
BLOCK_GROWTH = 16  # growth factor of the block size after a quick block
BLOCK_TIME = 0.1  # s; blocks settle below it, so that `should_stop` is called often
# In a browser Python has no `thread_time`.
processor_time = getattr(time, "thread_time", time.perf_counter)


# A single collision -------------------------------------------------------------------


def solve_one(
    layout: FamilyLayout,
    request: RunRequest,
    report: ProgressReport = no_report,
) -> FrontBatch:
    """Run a single collision, and return the batch that has its records.

    If the request gives an end `until`, the run ends there, otherwise one round trip of
    the longest body after the proof; it ends earlier at the cap on events. The flag
    `run_past_proof` of the request is replaced by True.

    Parameters
    ----------
    layout : FamilyLayout
    request : RunRequest
    report : function
        Called now and then with the numbers of events so far and expected.

    Returns
    -------
    FrontBatch
        If the collision has no clock, it has not run, and its stop reason is OVERFLOW,
        LONG or SHORT; `FrontRun` then raises InvalidModel.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    """
    # Time of the tick rule in plain Python, s. It compares all pairs of durations; four
    # comparisons a pair are counted. `run_to_end` adds the time of the run itself.
    tick_rule_time = (2 * layout.duration_count) ** 2 * PLAIN_PAIR_TIME
    is_compiled = kernels.worth_compiling(tick_rule_time, run_members)
    batch = FrontBatch(
        layout, request._replace(run_past_proof=True), is_compiled=is_compiled
    )
    batch.load_members(np.array([layout.values], dtype=float))  # a single member
    batch.run_to_end(report)  # may raise TooLong
    return batch


# Families -----------------------------------------------------------------------------


def solve_many(
    layout: FamilyLayout,
    request: RunRequest,
    fields: Sequence[tuple[str, int]],
    should_stop: Callable[[], bool] = lambda: False,
    later_members: int = 0,
) -> dict[tuple[str, int], Array]:
    """Run every member of a family to `until`, or to its proof of finality.

    Members run in blocks whose records are small enough for the processor's cache, in
    plain Python until machine code pays. The block size grows after a quick block, one
    of less than a quarter of `BLOCK_TIME`, and is halved after any other, so that
    blocks settle below `BLOCK_TIME`.

    Parameters
    ----------
    layout : FamilyLayout
    request : RunRequest
        Its cap on events is for each member.
    fields : sequence of (str, int)
        Fields of `records.NodeResult` to return, each with the node.
    should_stop : callable
        Called before each block; True ends the run with Stopped.
    later_members : int
        Number of members that other calls will run in this process.

    Returns
    -------
    dict of (str, int) to array
        Results by field and node, as `fields` names them, [member] in C order. The
        results of a member without a clock are meaningless, except `stop_reason`:
        OVERFLOW, LONG or SHORT.

    Raises
    ------
    Stopped
        If `should_stop` returned True.
    TooLong
        If a member takes too much memory.
    """
    count = layout.row.members
    members = MemberValues(layout)
    columns: dict[tuple[str, int], Array] = {}
    for name, k in fields:
        columns[name, k] = np.empty(count, NODE_RESULT[name])
    # Time of a member in plain Python, s: estimated at first, then measured
    member_time = INITIAL_LOG_ROWS * PLAIN_ROW_TIME
    is_measured = False
    batch = FrontBatch(layout, request, is_compiled=False)
    first = 0
    size = FIRST_BLOCK_SIZE
    while first < count:
        if should_stop():
            raise Stopped
        block = slice(first, min(first + size, count))
        length = block.stop - first
        begin = processor_time()
        # Time in plain Python of the members after this block, s; 0 as long as it is
        # only estimated
        ahead = 0.0
        if is_measured:
            members_after = count - block.stop + later_members
            ahead = member_time * members_after
        is_compiled = kernels.worth_compiling(
            member_time * length, run_members, ahead=ahead
        )
        if is_compiled != batch.is_compiled:  # the form changes: lists or arrays
            batch = FrontBatch(layout, request, is_compiled=is_compiled)
        run_block(batch, members, block, columns)
        first = block.stop
        seconds = processor_time() - begin
        is_quick = seconds < BLOCK_TIME / 4
        if not batch.is_compiled:
            member_time = seconds / length
            if not is_quick:  # the time of a quick block is not exact
                is_measured = True
        if is_quick:
            size = min(BLOCK_GROWTH * size, MAX_BLOCK_SIZE)
        else:
            size = max(1, size // 2)
    return columns


def run_block(
    batch: FrontBatch,
    members: "MemberValues",
    block: slice,
    columns: dict[tuple[str, int], Array],
) -> None:
    """Run a block of members to their ends, and store their results in `columns`.

    `block` is a range of members. Each column, by field and node, has an entry for
    every member of the family; the entries of the block are set. The batch is changed.
    """
    batch.load_members(members.values_of(block))
    batch.run_to_end()
    results = batch.array("results")
    for (name, k), column in columns.items():
        column[block] = results[name][:, k]  # results[name] is [member, node]


class MemberValues:
    """The values of the members of a family, block by block.

    A block is a range of members. Its values are in `_block`, [member, value]: those
    that all members share are filled in once, the others for each block.
    """

    def __init__(self, layout: FamilyLayout) -> None:
        """Fill `_block` with the values that all members share.

        `_varying` gets the values that vary, [member] each, by their index.
        """
        size = min(layout.row.members, MAX_BLOCK_SIZE)
        self._block = np.empty((size, len(layout.values)))
        self._varying: dict[int, Array] = {}
        for j, value in enumerate(layout.values):
            if np.ndim(value) == 0:  # all members share it
                self._block[:, j] = value
            else:
                shape = layout.row.system.shape
                self._varying[j] = np.broadcast_to(value, shape).ravel()

    def values_of(self, block: slice) -> Array:
        """Values of the members of a block, [member, value].

        The array is a view of `_block`, which the next call overwrites.
        """
        values = self._block[: block.stop - block.start]
        for j, value in self._varying.items():
            values[:, j] = value[block]
        return values
