"""Jobs of a sweep on workers whose time is simulated."""

import heapq
import itertools
import math
from concurrent.futures import Executor, Future
from types import SimpleNamespace

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.running import chunks, jobs
from rodimpact.running.columns import layout_of

STEEL = ri.materials.steel


class Cluster(Executor):
    """Workers, each with one job at a time; what a job takes is told by a clock that it
    moves.

    A job ends when the sweep can do no more than wait: as many are in flight as it
    wants, or all.
    """

    def __init__(self, workers, members, clock):
        self.workers = workers
        self.clock = clock
        self.free = [0.0] * workers
        self.flying = []
        self.number = itertools.count()
        self.now = 0.0
        self.to_come = members
        self.lasted = []

    def submit(self, run, chunk):
        begun = self.clock.now = max(self.now, heapq.heappop(self.free))
        result = run(chunk)
        end = self.clock.now
        heapq.heappush(self.free, end)
        self.lasted.append(end - begun)
        self.to_come -= math.prod(chunk.system.shape)
        future = Future()
        heapq.heappush(self.flying, (end, next(self.number), result, future))
        while len(self.flying) == 2 * self.workers or (
            self.flying and not self.to_come
        ):
            self.now, _, news, done = heapq.heappop(self.flying)
            done.set_result(news)
        return future


@pytest.fixture
def clock(monkeypatch):
    """What jobs look at; running members moves it by what stands for their cost, their
    length.
    """
    clock = SimpleNamespace(now=0.0)

    def run_chunk(chunk):
        system = chunk.system
        cost = np.broadcast_to(system.bodies[0].length, system.shape).ravel()
        clock.now += cost.sum()
        columns = {
            name: np.zeros((len(cost), *beyond), kind)
            for name, (kind, beyond) in layout_of(system, chunk.readings).items()
        }
        columns["restitution"] += cost
        return columns

    monkeypatch.setattr(chunks, "run_chunk", run_chunk)
    return clock


def family(costs):
    """Members that are solved one by one; the length of a rod stands for its cost."""
    rod = ri.Rod(np.asarray(costs), area=1e-4, material=STEEL, velocity=1.0)
    return ri.System([rod, ri.Wall()])


def swept(costs, cluster, **options):
    """A sweep of members with these costs, on a cluster."""
    return ri.sweep(
        family(costs),
        "finite-difference",
        executor=cluster,
        workers=cluster.workers,
        **options,
    )


@pytest.mark.parametrize("workers", [2, 3, 16])
def test_workers_end_together_though_the_last_tenth_takes_ten_times_as_long(
    clock, workers
):
    seconds = np.append(np.full(900, 0.1), np.full(100, 1.0))
    cluster = Cluster(workers, len(seconds), clock)
    result = swept(seconds, cluster)
    assert result.restitution.tolist() == seconds.tolist()
    assert sum(cluster.lasted) == pytest.approx(seconds.sum())
    assert max(cluster.free) < 1.2 * seconds.sum() / workers


@pytest.mark.parametrize(
    ("members", "workers", "count"),
    [(1000, 2, 16), (5, 2, 5), (1, 64, 1), (160, 4, 32), (161, 4, 27)],
)
def test_a_worker_gets_about_eight_jobs(clock, members, workers, count):
    cluster = Cluster(workers, members, clock)
    swept(np.ones(members), cluster)
    assert len(cluster.lasted) == count


def test_an_executor_that_does_not_say_has_64_workers(clock):
    cluster = Cluster(2, 2048, clock)
    ri.sweep(family(np.ones(2048)), "finite-difference", executor=cluster)
    assert len(cluster.lasted) == 512


def test_a_checkpoint_has_finer_jobs(clock, tmp_path):
    cluster = Cluster(2, 1000, clock)
    swept(np.ones(1000), cluster, checkpoint=tmp_path)
    assert len(cluster.lasted) == 200


@pytest.mark.parametrize(
    ("members", "row", "count", "most", "size"),
    [
        (10, 10, 16, 10, 1),
        (100, 10, 8, 100, 10),  # 13, cut to a whole row
        (10_000, 100, 16, 8192, 600),
        (1_000_000, 1000, 16, 8192, 8000),
        (1_000_000, 500_000, 16, 8192, 8192),
        (4, 4, 16, 1024, 1),
    ],
)
def test_jobs_are_whole_rows_of_the_family_where_they_fit(
    members, row, count, most, size
):
    assert jobs.job_size(members, row, count, most) == size


def test_spans_are_cut_at_multiples_of_the_size():
    assert list(jobs.cut([(3, 9), (12, 13)], 4)) == [(3, 4), (4, 8), (8, 9), (12, 13)]


def test_jobs_fill_a_checkpoint_that_others_go_on_with(clock, tmp_path):
    """Interrupted once, then gone on with on a cluster of another size."""
    seconds = np.where(np.arange(500) < 250, 0.01, 10.0)

    def interrupt(done, total):
        if done > 200:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swept(seconds, Cluster(3, 500, clock), checkpoint=tmp_path, progress=interrupt)
    (part,) = tmp_path.iterdir()
    with np.load(part) as file:
        done = file["status"].size
    assert 200 < done < 400
    cluster = Cluster(5, 500 - done, clock)
    result = swept(seconds, cluster, checkpoint=tmp_path)
    assert result.restitution.tolist() == seconds.tolist()
    assert cluster.to_come == 0
    again = swept(seconds, Cluster(1, 0, clock), checkpoint=tmp_path)
    assert again.restitution.tolist() == seconds.tolist()


def test_an_interrupt_cancels_what_waits(clock):
    """Workers that never end a job: the first news is that there is none."""
    handed = []

    class Stuck(Executor):
        workers = 3

        def submit(self, *_):
            handed.append(Future())
            return handed[-1]

    def interrupt(done, total):
        assert (done, total) == (0, 50)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swept(np.ones(50), Stuck(), progress=interrupt)
    assert len(handed) == 6
    assert all(job.cancelled() for job in handed)
