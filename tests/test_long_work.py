"""One rule for long work: it reports its progress, and Ctrl-C ends it."""

import threading

import numpy as np
import pytest
from systems import rod

import rodimpact as ri
from rodimpact.running import chunks

PAIR = ri.System([rod(0.4, 1.0), rod(1.0, area=2e-4)])


FAMILY = ri.System([rod(np.array([0.4, 0.5]), 1.0), rod(1.0)])


def solve_by_fronts(progress):
    ri.solve(PAIR, until=0.05, progress=progress)


def solve_on_a_grid(progress):
    options = {"method": "finite-difference", "cells": 10}
    ri.solve(PAIR, until=1e-4, progress=progress, **options)


def sweep(progress):
    options = {"method": "finite-difference", "cells": 10}
    ri.sweep(FAMILY, until=1e-4, progress=progress, **options)


def atlas(progress):
    lengths = ("bodies.1.length", 0.6, 1.5)
    areas = ("bodies.1.area", 5e-5, 2e-4)
    ri.atlas(PAIR, lengths, areas, most_cells=2, progress=progress)


def print_closed_form(progress):
    three_rods = ri.System([rod(0.4, 1.0), rod(1.0), rod(0.7)])
    str(ri.closed_form(three_rods, ["length"], progress=progress))


def first_mode(progress):
    radii = np.linspace(0, 0.3, 300)
    ri.waves.first_mode(radii, poisson_ratio=0.29, progress=progress)


def fit(progress):
    """Fit the velocity of a striker to a record of it."""
    until = 2e-4
    record = ri.solve(PAIR, until=until).gauge(1, 0.4).signal(1e-6)
    measured = ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0)
    vary = {"bodies.0.velocity": (0.5, 2.0)}
    ri.fit(PAIR, measured, vary, until, starts=1, progress=progress)


def design_a_striker(progress):
    """Design a striker of two segments for a force that grows to 1 kN in 0.1 ms."""
    force = ri.Signal([0.0, 1e3], [0.0, 1e-4], unit="N")
    ri.design.striker(
        force, rod(2.0), velocity=1.0, duration=1e-4, segments=2, progress=progress
    )


WORK = [
    solve_by_fronts,
    solve_on_a_grid,
    sweep,
    atlas,
    print_closed_form,
    first_mode,
    fit,
    design_a_striker,
]
"""Functions that do long work and take an argument `progress`."""


@pytest.mark.parametrize("work", WORK)
def test_long_work_reports_its_progress(work):
    """The work calls its `progress` at least once, with a count of at least 0 and at
    most the total, which may be None.
    """
    heard = []

    def listen(done, total):
        heard.append((done, total))

    work(listen)

    assert heard
    for done, total in heard:
        assert done >= 0
        assert total is None or done <= total


@pytest.mark.parametrize("work", WORK)
def test_long_work_can_be_stopped_by_an_error_of_its_progress(work):
    """An error that `progress` raises ends each work in `WORK`, and is raised."""

    def stop(done, total):
        raise StopIteration

    with pytest.raises(StopIteration):
        work(stop)


@pytest.mark.parametrize("work", WORK)
@pytest.mark.parametrize("wrong", [3, None])
def test_progress_must_be_true_false_or_a_function(work, wrong):
    with pytest.raises(ri.InvalidModel, match="progress: must be True, False or a"):
        work(wrong)


def test_an_interrupted_sweep_does_not_wait_for_the_members_that_run(monkeypatch):
    """A sweep is interrupted while a chunk waits: KeyboardInterrupt is raised before
    the chunk has ended.
    """
    begun = threading.Event()
    may_end = threading.Event()
    ended = threading.Event()

    def run_until_told(*_):
        begun.set()
        may_end.wait(30)
        ended.set()
        raise chunks.Stopped

    def interrupt(*_):
        if begun.is_set():
            raise KeyboardInterrupt

    monkeypatch.setattr(chunks, "run_chunk", run_until_told)
    with pytest.raises(KeyboardInterrupt):
        ri.sweep(FAMILY, workers=1, progress=interrupt)
    assert not ended.is_set()
    may_end.set()
