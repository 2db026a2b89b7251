"""Jobs of a sweep on workers whose time is simulated."""

import heapq
import itertools
import math
import threading
from concurrent.futures import Executor, Future
from types import SimpleNamespace

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.running import jobs, sweeping
from rodimpact.running.columns import STATUS, arrays_of

STEEL = ri.materials.steel


class Cluster(Executor):
    """Workers, each with one job at a time; what a job takes is told by a clock that it moves.

    A job ends when the sweep can do no more than wait: as many are in flight as it wants, or all.
    """

    def __init__(self, workers, members, clock):
        self._max_workers, self.clock = workers, clock
        self.free, self.flying, self.number = [0.0] * workers, [], itertools.count()
        self.now, self.to_come, self.lasted = 0.0, members, []

    def submit(self, run, members, *options):
        begun = self.clock.now = max(self.now, heapq.heappop(self.free))
        result = run(members, *options)
        end = self.clock.now
        heapq.heappush(self.free, end)
        self.lasted.append(end - begun)
        self.to_come -= math.prod(members.shape)
        future = Future()
        heapq.heappush(self.flying, (end, next(self.number), result, future))
        while len(self.flying) == 2 * self._max_workers or (
            self.flying and not self.to_come
        ):
            self.now, _, news, done = heapq.heappop(self.flying)
            done.set_result(news)
        return future


@pytest.fixture
def clock(monkeypatch):
    """What jobs look at; running members moves it by what stands for their cost, their length."""
    clock = SimpleNamespace(now=0.0)

    def run_chunk(system, options, readings):
        cost = np.broadcast_to(system.bodies[0].length, system.shape).ravel()
        clock.now += cost.sum()
        columns = {
            name: np.zeros((len(cost), *beyond), kind)
            for name, (kind, beyond) in arrays_of(system, readings).items()
        }
        columns["restitution"] += cost
        columns["status"][np.isin(cost, clock.bad)] = STATUS.index("max_events")
        return columns

    clock.bad = []
    monkeypatch.setattr(
        sweeping, "time", SimpleNamespace(perf_counter=lambda: clock.now)
    )
    monkeypatch.setattr(sweeping, "run_chunk", run_chunk)
    return clock


def family(costs):
    """Members that are solved one by one."""
    rod = ri.Rod(np.asarray(costs), area=1e-4, material=STEEL, velocity=1.0)
    return ri.System([rod, ri.Wall()])


def costs(order, members):
    """Seconds from 0.01 to 10."""
    rng = np.random.default_rng(3)
    dear = np.exp(rng.uniform(np.log(0.01), np.log(10), members))
    halves = np.where(np.arange(members) < members // 2, 0.01, 10.0)
    return {
        "mixed": dear,
        "rising": np.sort(dear),
        "falling": np.sort(dear)[::-1],
        "halves": halves,
    }[order]


@pytest.mark.parametrize(
    "order", few_of(["mixed", "rising", "falling", "halves"], ["falling", "halves"])
)
@pytest.mark.parametrize(
    ("workers", "members"),
    [
        (16, 1500),
        pytest.param(64, 8_000, marks=pytest.mark.exhaustive),
    ],
)
def test_workers_are_busy_though_costs_differ_a_thousandfold(
    clock, order, workers, members
):
    seconds = costs(order, members)
    cluster = Cluster(workers, members, clock)
    result = ri.sweep(family(seconds), "finite-difference", executor=cluster)
    assert result.restitution.tolist() == seconds.tolist()
    assert sum(cluster.lasted) == pytest.approx(seconds.sum())
    assert seconds.sum() / workers > 0.9 * max(cluster.free)


def test_what_is_raised_is_the_first_member_in_c_order_whichever_ends_first(
    clock, monkeypatch
):
    seconds, handed = np.full(200, 0.1), []
    seconds[[3, 5, 120]] = clock.bad = [9.0, 0.01, 0.02]
    monkeypatch.setattr(ri.SweepResult, "explain", lambda result, index: "stopped")

    class Late(Executor):
        """Tells of the first members last."""

        _max_workers = 4

        def submit(self, run, *members):
            job, result = Future(), run(*members)
            delay = 0.0 if len(handed) > 4 else 0.05 * (5 - len(handed))
            handed.append(math.prod(members[0].shape))
            threading.Timer(delay, job.set_result, [result]).start()
            return job

    with pytest.raises(ri.SweepError) as caught:
        ri.sweep(
            family(seconds), "finite-difference", executor=Late(), on_error="raise"
        )
    assert caught.value.index == (3,)
    assert sum(handed) < 200  # what comes after it is not begun any more


@pytest.mark.parametrize(
    ("seconds", "longest"),
    [
        (np.full(20_000, 1e-3), 1.0),
        (np.append(1e-9, np.ones(99)), jobs.GROWTH),  # one cheap member tells little
    ],
)
def test_jobs_take_about_a_second(clock, seconds, longest):
    cluster = Cluster(1, len(seconds), clock)
    ri.sweep(family(seconds), "finite-difference", executor=cluster)
    assert max(cluster.lasted) == pytest.approx(longest, rel=0.01)


@pytest.mark.parametrize(
    ("shape", "most", "unit"),
    [
        ((10, 10), 0, 1),
        ((5,), 99, 3),
        ((3, 7), 99, 14),
        ((4, 5), 4, 4),
        ((100, 100), 8192, 5000),
        ((101, 101), 8192, 5151),
        ((1000, 1000), 8192, 8000),
        ((2, 500_000), 8192, 8065),
    ],
)
def test_chunks_are_whole_rows_of_the_family_and_an_even_number(shape, most, unit):
    assert sweeping._unit(SimpleNamespace(shape=shape), most) == unit


def test_jobs_fill_a_checkpoint_that_others_go_on_with(clock, monkeypatch, tmp_path):
    """Interrupted once, then gone on with on a cluster of another size."""
    monkeypatch.setattr(sweeping, "TOGETHER", 8)
    seconds = costs("halves", 500)

    def interrupt(done, total):
        if done > 200:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(
            family(seconds),
            "fronts",
            executor=Cluster(3, 500, clock),
            checkpoint=tmp_path,
            progress=interrupt,
        )
    (part,) = tmp_path.iterdir()
    with np.load(part) as file:
        done = file["status"].size
    assert 200 < done < 400
    cluster = Cluster(5, 500 - done, clock)
    result = ri.sweep(family(seconds), "fronts", executor=cluster, checkpoint=tmp_path)
    assert result.restitution.tolist() == seconds.tolist()
    assert cluster.to_come == 0
    again = ri.sweep(
        family(seconds), "fronts", executor=Cluster(1, 0, clock), checkpoint=tmp_path
    )
    assert again.restitution.tolist() == seconds.tolist()


def test_an_interrupt_cancels_what_waits(clock):
    """Workers that never end a job: the first news is that there is none."""
    handed = []

    class Stuck(Executor):
        _max_workers = 3

        def submit(self, *_):
            handed.append(Future())
            return handed[-1]

    def interrupt(done, total):
        assert (done, total) == (0, 50)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(
            family(np.ones(50)),
            "finite-difference",
            executor=Stuck(),
            progress=interrupt,
        )
    assert len(handed) == 6
    assert all(job.cancelled() for job in handed)


@pytest.mark.parametrize(
    ("says", "workers"),
    [
        ({"_max_workers": 5}, 5),
        ({}, jobs.UNKNOWN),
        ({"_client": SimpleNamespace(ncores=lambda: {"a": 4, "b": 2})}, 6),
        ({"_client": SimpleNamespace(ncores=dict)}, jobs.UNKNOWN),
    ],
)
def test_an_executor_is_asked_for_its_workers(says, workers):
    assert jobs.workers_of(SimpleNamespace(**says)) == workers
