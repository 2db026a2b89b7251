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
    """Workers that run one job at a time each, by a simulated clock.

    A job runs at once and moves the clock. Its future is done later: as soon as the
    sweep can only wait, since as many jobs are in flight as it wants, two a worker, or
    all members are handed out.

    Attributes
    ----------
    free : list of float
        Times at which the workers are free, s; a heap.
    in_flight : list of tuple
        End, number, result and future of jobs whose future is not done; a heap.
    now : float
        Time at which the sweep heard of a job last, s.
    members_to_come : int
        Members that were not handed out.
    durations : list of float
        Times that the jobs took, s.
    """

    def __init__(self, workers, members, clock):
        """A simulated cluster at time 0, whose `workers` are all free, for this number
        of members.
        """
        self.workers = workers
        self.clock = clock
        self.free = [0.0] * workers
        self.in_flight = []
        self.job_numbers = itertools.count()
        self.now = 0.0
        self.members_to_come = members
        self.durations = []

    def submit(self, run, chunk):
        """Run the job at once; its future gets the result at the simulated time at
        which a worker would have finished it.
        """
        start = max(self.now, heapq.heappop(self.free))
        self.clock.now = start
        result = run(chunk)
        end = self.clock.now
        heapq.heappush(self.free, end)
        self.durations.append(end - start)
        self.members_to_come -= math.prod(chunk.system.shape)
        future = Future()
        # The number decides between jobs that end at the same time.
        job = (end, next(self.job_numbers), result, future)
        heapq.heappush(self.in_flight, job)
        while self.sweep_can_only_wait():
            self.now, _, first_result, first_future = heapq.heappop(self.in_flight)
            first_future.set_result(first_result)
        return future

    def sweep_can_only_wait(self):
        """Whether no further job comes until one has ended."""
        if len(self.in_flight) == 2 * self.workers:
            return True
        return bool(self.in_flight) and self.members_to_come == 0


@pytest.fixture
def clock(monkeypatch):
    """The clock that jobs look at; each member moves it by the length of its first
    body, which stands for its cost, s.

    That length is also the restitution of the member.
    """
    clock = SimpleNamespace(now=0.0)

    def run_chunk(chunk):
        system = chunk.system
        cost = np.broadcast_to(system.bodies[0].length, system.shape).ravel()
        clock.now += cost.sum()
        columns = {}
        layout = layout_of(system, chunk.readings)
        for name, (dtype, shape_of_entry) in layout.items():
            columns[name] = np.zeros((len(cost), *shape_of_entry), dtype)
        columns["restitution"] += cost
        return columns

    monkeypatch.setattr(chunks, "run_chunk", run_chunk)
    return clock


def family(costs):
    """Members that are solved one by one; the length of a rod stands for its cost, s."""
    rod = ri.Rod(np.asarray(costs), area=1e-4, material=STEEL, velocity=1.0)
    return ri.System([rod, ri.Wall()])


def swept(costs, cluster, **options):
    """A sweep on a simulated cluster, whose members take `costs` seconds; their
    restitution is their cost.
    """
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
    """900 members take 0.1 s each and the last 100 take 1 s. All results are right, and
    the last worker ends before 1.2 times the shortest possible time.
    """
    short = np.full(900, 0.1)  # s
    long = np.full(100, 1.0)
    seconds = np.append(short, long)
    cluster = Cluster(workers, len(seconds), clock)

    result = swept(seconds, cluster)

    assert result.restitution.tolist() == seconds.tolist()
    total = seconds.sum()
    assert sum(cluster.durations) == pytest.approx(total)
    shortest_time = total / workers  # if all workers end at the same time
    assert max(cluster.free) < 1.2 * shortest_time


@pytest.mark.parametrize(
    ("members", "workers", "jobs_run"),
    [(1000, 2, 16), (5, 2, 5), (1, 64, 1), (160, 4, 32), (161, 4, 27)],
)
def test_a_worker_gets_about_eight_jobs_if_there_are_so_many(
    clock, members, workers, jobs_run
):
    """A sweep of `members` equal members on a cluster of `workers` runs `jobs_run`
    jobs.
    """
    cluster = Cluster(workers, members, clock)
    swept(np.ones(members), cluster)
    assert len(cluster.durations) == jobs_run


@pytest.mark.exhaustive
def test_an_executor_that_does_not_say_is_taken_to_have_64_workers(clock):
    cluster = Cluster(2, 2048, clock)
    ri.sweep(family(np.ones(2048)), "finite-difference", executor=cluster)
    assert len(cluster.durations) == 64 * 8


def test_a_checkpoint_has_finer_jobs(clock, tmp_path):
    cluster = Cluster(2, 1000, clock)
    swept(np.ones(1000), cluster, checkpoint=tmp_path)
    assert len(cluster.durations) == 200


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
    spans = [(3, 9), (12, 13)]
    parts = list(jobs.cut(spans, 4))
    assert parts == [(3, 4), (4, 8), (8, 9), (12, 13)]


def test_jobs_fill_a_checkpoint_that_others_go_on_with(clock, tmp_path):
    """A sweep of 500 members is interrupted after more than 200. Another cluster of
    another size solves the rest, and a third sweep hands on no job. Both results are
    those of an uninterrupted sweep.
    """
    seconds = np.where(np.arange(500) < 250, 0.01, 10.0)

    def interrupt(done, total):
        if done > 200:
            raise KeyboardInterrupt

    first_cluster = Cluster(3, 500, clock)
    with pytest.raises(KeyboardInterrupt):
        swept(seconds, first_cluster, checkpoint=tmp_path, progress=interrupt)
    (part,) = tmp_path.iterdir()
    with np.load(part) as file:
        done = file["status"].size
    assert 200 < done < 400  # of 500: more than at the interrupt, and not all

    cluster = Cluster(5, 500 - done, clock)
    result = swept(seconds, cluster, checkpoint=tmp_path)
    # The third sweep finds all members, and hands no job to its cluster.
    idle_cluster = Cluster(1, 0, clock)
    again = swept(seconds, idle_cluster, checkpoint=tmp_path)

    assert result.restitution.tolist() == seconds.tolist()
    assert cluster.members_to_come == 0
    assert again.restitution.tolist() == seconds.tolist()
    assert idle_cluster.durations == []


def test_an_interrupt_cancels_jobs_that_wait(clock):
    """Workers never end a job: progress tells that none is done, and interrupts."""
    futures = []

    class Stuck(Executor):
        workers = 3

        def submit(self, *_):
            future = Future()
            futures.append(future)
            return future

    def interrupt(done, total):
        assert done == 0
        assert total == 50
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swept(np.ones(50), Stuck(), progress=interrupt)

    assert len(futures) == 2 * Stuck.workers
    for future in futures:
        assert future.cancelled()
