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


def peak_bytes(call):
    """Largest number of bytes that a call has taken at any one time."""
    tracemalloc.start()
    try:
        call()
        _, peak = tracemalloc.get_traced_memory()
        return peak
    finally:
        tracemalloc.stop()


def solve_and_read(system, until):
    """Solve a system on a grid of 40 cells, print the solution, and compute energies at
    20 times; nothing is returned.
    """
    solution = ri.solve(system, until=until, method="finite-difference", cells=40)
    str(solution)
    times = np.linspace(0.0, solution.t_end, 20)
    solution.energy(times)


@pytest.mark.skipif(
    not kernels.enabled(), reason="plain Python takes long for so many steps"
)
@pytest.mark.parametrize("name", few_of(ROWS, {"pair"}))
def test_the_memory_asked_for_bounds_what_is_taken_and_is_8_times_as_much_at_most(
    monkeypatch, name
):
    """A row of `ROWS` is solved on a grid and its energies are read, in machine code;
    the bytes that it takes are traced.
    """
    pytest.importorskip("numba")  # plain Python has lists beside arrays
    bytes_asked_for = []

    def note_memory(numbers, *_):
        bytes_asked_for.append(8 * numbers)  # a number has 8 bytes

    monkeypatch.setattr(memory, "MAX_BYTES", np.inf)
    monkeypatch.setattr(memory, "SHARE", np.inf)
    with kernels.forced(compiling=True):
        solve_and_read(PAIR, until=1e-3)  # what is made once is made here
    monkeypatch.setattr("rodimpact.methods.grid.run.require_memory", note_memory)
    with kernels.forced(compiling=True):
        peak = peak_bytes(lambda: solve_and_read(ROWS[name], until=0.06))
    asked_for = max(bytes_asked_for)
    small_objects = 1e6  # bytes, of the solution and its texts
    assert peak <= asked_for + small_objects
    assert asked_for <= 8 * peak


@pytest.mark.parametrize(
    "snapshots",
    [
        10**15,
        pytest.param(np.linspace(0, 1, 500_000), marks=pytest.mark.exhaustive),
    ],
)
def test_snapshots_that_are_too_many_are_refused_before_they_take_memory(
    snapshots,
):
    """The refusal itself takes less than 0.1 GB."""
    options = {"method": "finite-difference", "cells": 100, "snapshots": snapshots}
    message = r"snapshots: .*needs .* GB of memory, .* GB; "

    def solve():
        with pytest.raises(memory.TooLong, match=message):
            ri.solve(PAIR, until=1.0, **options)

    assert peak_bytes(solve) < 1e8  # 0.1 GB


@pytest.mark.parametrize("until", [1e20, 1e150])
def test_an_end_beyond_the_clock_is_refused_with_a_remedy(until):
    said = "more than the clock can count; stop before"
    paths = refused(said, ri.solve, PAIR, until, "characteristics")
    assert paths == ["until"]


def test_a_small_machine_allows_a_quarter_of_its_memory(monkeypatch):
    """With 4 MB installed, 1 MB is allowed; one number more raises `TooLong` with the
    sizes and the remedy.
    """
    monkeypatch.setattr(memory, "installed", lambda: 4e6)  # bytes
    allowed = 125_000  # numbers of 8 bytes
    message = r"until: this needs .* GB.* 0\.001 GB; do less"

    memory.require_memory(allowed, "until", "this", "do less")
    with pytest.raises(memory.TooLong, match=message):
        memory.require_memory(allowed + 1, "until", "this", "do less")


@pytest.mark.parametrize(
    "run",
    [
        lambda system: ri.solve(system, max_events=10**15),
        lambda system: ri.sweep(system, max_events=10**15),
    ],
)
def test_fronts_that_multiply_for_ever_are_refused(monkeypatch, run):
    """Three rods between walls outgrow a log with room for eight times its first rows."""
    rows = 8 * batch.INITIAL_LOG_ROWS  # of the log, for which there is room
    max_bytes = 8.0 * batch.NUMBERS_PER_LIST_ROW * rows
    monkeypatch.setattr(memory, "MAX_BYTES", max_bytes)
    moving = rod(velocity=1.0)
    bodies = [ri.Wall(), moving, rod(0.3781), rod(0.271), ri.Wall()]

    message = r"max_events: .* needs .* GB .*; lower the cap"
    with pytest.raises(memory.TooLong, match=message):
        run(ri.System(bodies))


@pytest.mark.exhaustive
def test_the_velocity_of_a_mass_is_kept_over_more_than_131_072_steps():
    """A mass flies for 2^17 steps and more; the rod, 1 km away, is never met."""
    n_steps = 2**17
    mass = ri.RigidMass(1.0, velocity=1.0)
    row = ri.System([mass, rod(0.5)], gaps=[1e3])
    until = n_steps * 1e-5 + 1.0  # steps are shorter than 1e-5 s

    solution = ri.solve(row, until=until, method="finite-difference", cells=8)

    assert solution.run.end > n_steps * solution.fields.resolution
    assert solution.outcome.velocities_after == (1.0, 0.0)


def test_threads_that_take_more_than_their_share_go_one_after_the_other(monkeypatch):
    """Four threads take their shares at the same time; beyond these only one of them is
    at work at a time.
    """
    # A quarter of the memory holds 400 numbers of 8 bytes: 100 for each of 4 threads.
    monkeypatch.setattr(memory, "installed", lambda: 4 * 8 * 400.0)
    together = threading.Barrier(4, timeout=20)
    at_work = []  # threads beyond their share
    counts = []  # how many there were beside each of them, itself included

    def work(number):
        memory.require_memory(100, "until", "this", "do less")
        together.wait()  # all have their share at the same time
        memory.require_memory(101, "until", "this", "do less")
        at_work.append(number)
        memory.require_memory(400, "until", "this", "do less")  # has its turn already
        time.sleep(0.01)
        counts.append(len(at_work))
        at_work.remove(number)
        memory.end_turn()

    with ThreadPoolExecutor(
        4, initializer=memory.limit_to_share, initargs=(4,)
    ) as pool:
        list(pool.map(work, range(4)))
    assert counts == [1] * 4
    assert not memory._turn.locked()


@pytest.mark.exhaustive
def test_members_larger_than_the_share_of_a_thread_run_in_turn_and_as_alone(
    monkeypatch,
):
    """Each member of a sweep in four threads has its turn; restitutions are bit for bit
    those without threads.
    """
    even = ri.Samples([1.0, 1.0])
    lengths = np.linspace(0.3, 0.5, 8)  # m, of the members
    striker = rod(lengths, velocity=even)
    family = ri.System([striker, rod()], contacts=[HERTZ])
    without_threads = ri.sweep(family, "finite-difference", cells=200, workers=1)
    limit_to_share = memory.limit_to_share
    make_solution = chunks.Solution
    has_turn = []  # whether a thread has its turn, as each member ends

    def limit_to_tiny_share(threads):
        limit_to_share(10**9 * threads)

    def watched(run, options):
        has_turn.append(memory._turn.locked())
        return make_solution(run, options)

    monkeypatch.setattr(memory, "limit_to_share", limit_to_tiny_share)
    monkeypatch.setattr(chunks, "Solution", watched)
    result = ri.sweep(family, "finite-difference", cells=200, workers=4)
    assert has_turn == [True] * 8
    assert not memory._turn.locked()
    restitution = result.restitution.tobytes()
    assert restitution == without_threads.restitution.tobytes()
