"""What a run may take is counted before it is taken, and bounds what it takes."""

import threading
import time
import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import refused
from systems import rod

import rodimpact as ri
from rodimpact.methods import kernels, memory
from rodimpact.methods.fronts import batch
from rodimpact.running import chunks

HERTZ = ri.Hertz(1e10)


PAIR = ri.System([rod(velocity=1.0), rod()], contacts=[HERTZ])
ROWS = {
    "pair": PAIR,
    "between walls": ri.System(
        [ri.Wall(), rod(velocity=1.0), ri.Wall()], contacts=[HERTZ, HERTZ]
    ),
    "row": ri.System([rod(velocity=1.0), *[rod()] * 4], contacts=[HERTZ] * 4),
    "chain of masses": ri.System(
        [rod(velocity=1.0), *[ri.RigidMass(0.1)] * 6, rod()], contacts=[HERTZ] * 7
    ),
}


def peak_of(system, **options):
    """Bytes that a solution takes at most, asked for all that tables and figures
    need.
    """
    tracemalloc.start()
    try:
        solution = ri.solve(system, **options)
        str(solution)
        solution.energy(np.linspace(0.0, solution.t_end, 20))
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.skipif(
    not kernels.enabled(), reason="plain Python takes long for so many steps"
)
@pytest.mark.parametrize("name", few_of(ROWS, {"pair", "row"}))
def test_the_estimate_bounds_what_is_taken(monkeypatch, name):
    pytest.importorskip(
        "numba"
    )  # plain Python, which short jobs run, has lists beside arrays
    bytes_asked_for = []
    options = {"method": "finite-difference", "cells": 40, "until": 0.06}
    monkeypatch.setattr(memory, "MAX_BYTES", np.inf)
    monkeypatch.setattr(memory, "SHARE", np.inf)
    with kernels.forced(True):
        peak_of(PAIR, **options | {"until": 1e-3})  # with what is made once
    monkeypatch.setattr(
        "rodimpact.methods.grid.run.require_memory",
        lambda numbers, *rest: bytes_asked_for.append(8 * numbers),
    )
    with kernels.forced(True):
        peak = peak_of(ROWS[name], **options)
    assert peak <= max(bytes_asked_for) + 1e6
    assert max(bytes_asked_for) <= 8 * peak


@pytest.mark.parametrize(
    ("until", "snapshots"), [(1.0, 10**15), (1.0, np.linspace(0, 1, 500_000))]
)
def test_what_is_too_much_is_refused_with_figure_and_remedy(until, snapshots):
    tracemalloc.start()
    try:
        with pytest.raises(
            memory.TooLong, match=r"snapshots: .*needs .* GB of memory, .* GB; "
        ):
            ri.solve(PAIR, until, "finite-difference", cells=100, snapshots=snapshots)
        assert tracemalloc.get_traced_memory()[1] < 1e8
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("until", [1e20, 1e150])
def test_an_end_beyond_the_clock_is_refused_with_figure_and_remedy(until):
    said = "more than the clock can count; stop before"
    assert refused(said, ri.solve, PAIR, until, "characteristics") == ["until"]


def test_a_small_machine_allows_a_quarter_of_its_memory(monkeypatch):
    monkeypatch.setattr(memory, "installed", lambda: 4e6)
    memory.require_memory(125_000, "until", "this", "do less")
    with pytest.raises(
        memory.TooLong, match=r"until: this needs .* GB.* 0\.001 GB; do less"
    ):
        memory.require_memory(125_001, "until", "this", "do less")


@pytest.mark.parametrize(
    "run",
    [
        lambda system: ri.solve(system, max_events=10**15),
        lambda system: ri.sweep(system, max_events=10**15),
    ],
)
def test_fronts_that_multiply_for_ever_are_refused(monkeypatch, run):
    monkeypatch.setattr(
        memory,
        "MAX_BYTES",
        8.0 * batch.NUMBERS_PER_LIST_ROW * batch.INITIAL_LOG_ROWS * 8,
    )
    walls = [ri.Wall(), rod(velocity=1.0), rod(0.3781), rod(0.271), ri.Wall()]
    with pytest.raises(
        memory.TooLong, match=r"max_events: .* needs .* GB .*; lower the cap"
    ):
        run(ri.System(walls))


@pytest.mark.exhaustive
def test_many_steps_on_the_grid_keep_every_velocity_of_a_mass():
    row = ri.System([ri.RigidMass(1.0, velocity=1.0), rod(0.5)], [1e3])
    s = ri.solve(row, 2.0**17 * 1e-5 + 1.0, "finite-difference", cells=8)
    assert s.run.end > 2**17 * s.fields.resolution
    assert s.outcome.velocities_after == (1.0, 0.0)


def test_threads_that_take_more_than_their_share_go_one_after_the_other(monkeypatch):
    monkeypatch.setattr(
        memory, "installed", lambda: 4 * 8 * 400.0
    )  # numbers: 400, of 4 threads
    together = threading.Barrier(4, timeout=20)
    at_work = []
    most = []

    def work(number):
        memory.require_memory(100, "until", "this", "do less")
        together.wait()  # all have their share at the same time
        memory.require_memory(101, "until", "this", "do less")
        at_work.append(number)
        memory.require_memory(400, "until", "this", "do less")  # has its turn already
        time.sleep(0.01)
        most.append(len(at_work))
        at_work.remove(number)
        memory.give_back()

    with ThreadPoolExecutor(
        4, initializer=memory.limit_to_share, initargs=(4,)
    ) as pool:
        list(pool.map(work, range(4)))
    assert most == [1] * 4
    assert not memory._turn.locked()


def test_a_sweep_takes_no_more_memory_with_more_threads(monkeypatch):
    """Members are as without threads, though each is larger than a thread's share."""
    even = ri.Samples([1.0, 1.0])
    family = ri.System(
        [rod(np.linspace(0.3, 0.5, 20), velocity=even), rod()], contacts=[HERTZ]
    )
    alone = ri.sweep(family, "finite-difference", cells=200, workers=1)
    share = memory.limit_to_share
    solution = chunks.Solution
    turns = []
    monkeypatch.setattr(
        memory, "limit_to_share", lambda threads: share(10**9 * threads)
    )

    def watched(run, options):
        turns.append(memory._turn.locked())
        return solution(run, options)

    monkeypatch.setattr(chunks, "Solution", watched)
    result = ri.sweep(family, "finite-difference", cells=200, workers=4)
    assert turns == [True] * 20
    assert not memory._turn.locked()
    assert result.restitution.tobytes() == alone.restitution.tobytes()
