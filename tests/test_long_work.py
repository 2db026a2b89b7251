"""One rule for long work: it reports its progress, and Ctrl-C ends it."""

import threading

import numpy as np
import pytest
from systems import rod

import rodimpact as ri
from rodimpact.running import chunks

PAIR = ri.System([rod(0.4, 1.0), rod(1.0, area=2e-4)])


def fit(progress):
    """Fit the velocity of a striker to a record of it."""
    record = ri.solve(PAIR, until=2e-4).gauge(1, 0.4).signal(1e-6)
    measured = ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0)
    ri.fit(
        PAIR,
        measured,
        {"bodies.0.velocity": (0.5, 2.0)},
        2e-4,
        starts=1,
        progress=progress,
    )


WORK = {  # functions that do long work and take an argument `progress`
    "fronts": lambda progress: ri.solve(PAIR, until=0.05, progress=progress),
    "grid": lambda progress: ri.solve(
        PAIR, until=1e-4, method="finite-difference", cells=10, progress=progress
    ),
    "sweep": lambda progress: ri.sweep(
        ri.System([rod(np.array([0.4, 0.5]), 1.0), rod(1.0)]),
        "finite-difference",
        until=1e-4,
        cells=10,
        progress=progress,
    ),
    "atlas": lambda progress: ri.atlas(
        PAIR,
        ("bodies.1.length", 0.6, 1.5),
        ("bodies.1.area", 5e-5, 2e-4),
        most_cells=2,
        progress=progress,
    ),
    "closed_form": lambda progress: str(
        ri.closed_form(
            ri.System([rod(0.4, 1.0), rod(1.0), rod(0.7)]),
            ["length"],
            progress=progress,
        )
    ),
    "first_mode": lambda progress: ri.waves.first_mode(
        np.linspace(0, 0.3, 300), 0.29, progress=progress
    ),
    "fit": fit,
    "striker": lambda progress: ri.design.striker(
        ri.Signal([0.0, 1e3], [0.0, 1e-4], unit="N"),
        rod(2.0),
        velocity=1.0,
        duration=1e-4,
        segments=2,
        progress=progress,
    ),
}


@pytest.mark.parametrize("work", WORK.values(), ids=WORK)
def test_long_work_reports_its_progress_and_can_be_stopped(work):
    heard = []

    def listen(done, total):
        heard.append((done, total))

    def stop(done, total):
        raise StopIteration

    work(listen)
    assert heard
    for done, total in heard:
        assert done >= 0
        assert total is None or done <= total

    with pytest.raises(StopIteration):
        work(stop)


@pytest.mark.parametrize("work", WORK.values(), ids=WORK)
@pytest.mark.parametrize("wrong", [3, None])
def test_progress_must_be_true_false_or_a_function(work, wrong):
    with pytest.raises(ri.InvalidModel, match="progress: must be True, False or a"):
        work(wrong)


def test_an_interrupted_sweep_does_not_wait_for_the_members_that_run(monkeypatch):
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
    family = ri.System([rod(np.array([0.4, 0.5]), 1.0), rod(1.0)])
    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family, workers=1, progress=interrupt)
    assert not ended.is_set()
    may_end.set()
