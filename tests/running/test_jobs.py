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
from rodimpact.running.sweep_result import STATUS, arrays_of

STEEL = ri.materials.steel


class Cluster(Executor):
    """Workers, each with one job at a time; what a job takes is told by a clock that it moves.

    A job ends when the sweep can do no more than wait: as many are in flight as it wants, or all.
    """

    def __init__(self, workers, members, clock):
        self._max_workers, self.clock = workers, clock
        self.free, self.flying, self.number = [0.0] * workers, [], itertools.count()
        self.now, self.kept_back, self.lasted = 0.0, members, []

    def submit(self, run, members, *options):
        begun = self.clock.now = max(self.now, heapq.heappop(self.free))
        result = run(members, *options)
        end = self.clock.now
        heapq.heappush(self.free, end)
        self.lasted.append(end - begun)
        size, future = math.prod(members.shape), Future()
        self.kept_back -= size
        heapq.heappush(self.flying, (end, next(self.number), size - result[0], result, future))
        while len(self.flying) == 2 * self._max_workers or (self.flying and not self.kept_back):
            self.now, _, back, news, done = heapq.heappop(self.flying)
            self.kept_back += back
            done.set_result(news)
        return future


@pytest.fixture
def clock(monkeypatch):
    """What jobs look at; running members moves it by what stands for their cost, their length."""
    clock = SimpleNamespace(now=0.0)

    def run_chunk(system, options, readings):
        cost = np.broadcast_to(system.bodies[0].length, system.shape).ravel()
        clock.now += cost.sum()
        columns = {name: np.zeros((len(cost), *beyond), kind)
                   for name, (kind, beyond) in arrays_of(system, readings).items()}
        columns["restitution"] += cost
        columns["status"][np.isin(cost, clock.bad)] = STATUS.index("max_events")
        return columns

    clock.bad = []
    monkeypatch.setattr(jobs, "time", SimpleNamespace(perf_counter=lambda: clock.now))
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
    return {"mixed": dear, "rising": np.sort(dear), "falling": np.sort(dear)[::-1],
            "halves": halves}[order]


@pytest.mark.parametrize(
    "order", few_of(["mixed", "rising", "falling", "halves"], ["falling", "halves"]))
@pytest.mark.parametrize(("workers", "members"), [
    (16, 1500), pytest.param(64, 8_000, marks=pytest.mark.exhaustive),
])
def test_workers_are_busy_though_costs_differ_a_thousandfold(clock, order, workers, members):
    seconds = costs(order, members)
    cluster = Cluster(workers, members, clock)
    result = ri.sweep(family(seconds), "finite-difference", executor=cluster)
    assert result.restitution.tolist() == seconds.tolist()
    assert sum(cluster.lasted) == pytest.approx(seconds.sum())
    assert seconds.sum() / workers > 0.9 * max(cluster.free)


def test_what_is_raised_is_the_first_member_in_c_order_whichever_ends_first(clock, monkeypatch):
    seconds, handed = np.full(200, 0.1), []
    seconds[[3, 5, 120]] = clock.bad = [9.0, 0.01, 0.02]
    monkeypatch.setattr(sweeping.table, "explanation", lambda member, options: "stopped")

    class Late(Executor):
        """Tells of the first members last."""

        _max_workers = 4

        def submit(self, run, *members):
            job, result = Future(), run(*members)
            delay = 0.0 if len(handed) > 4 else 0.05 * (5 - len(handed))
            handed.append(result[0])
            threading.Timer(delay, job.set_result, [result]).start()
            return job

    with pytest.raises(ri.SweepError) as caught:
        ri.sweep(family(seconds), "finite-difference", executor=Late(), on_error="raise")
    assert caught.value.index == (3,)
    assert sum(handed) < 200  # what comes after it is not begun any more


def test_a_job_that_takes_too_long_hands_back_what_it_has_not_begun(clock):
    """Cheap members make large jobs; the one that meets dear ones ends soon, and so do the next."""
    seconds = np.where(np.arange(4000) < 2000, 1e-3, 20.0)
    cluster = Cluster(1, 4000, clock)
    result = ri.sweep(family(seconds), "finite-difference", executor=cluster)
    assert result.restitution.tolist() == seconds.tolist()
    assert np.median(cluster.lasted) == 20.0


def test_jobs_that_are_cut_short_fill_a_checkpoint(clock, monkeypatch, tmp_path):
    """Interrupted once, then gone on with on a cluster of another size."""
    monkeypatch.setattr(sweeping, "TOGETHER", 8)
    seconds = costs("halves", 500)

    def interrupt(done, total):
        if done > 200:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ri.sweep(family(seconds), "fronts", executor=Cluster(3, 500, clock), checkpoint=tmp_path,
                 progress=interrupt)
    (part,) = tmp_path.iterdir()
    with np.load(part) as file:
        done = file["status"].size
    assert 200 < done < 400
    cluster = Cluster(5, 500 - done, clock)
    result = ri.sweep(family(seconds), "fronts", executor=cluster, checkpoint=tmp_path)
    assert result.restitution.tolist() == seconds.tolist()
    assert cluster.kept_back == 0
    again = ri.sweep(family(seconds), "fronts", executor=Cluster(1, 0, clock), checkpoint=tmp_path)
    assert again.restitution.tolist() == seconds.tolist()


@pytest.mark.parametrize("seed", range(20))
def test_parts_of_a_job_keep_to_its_units(clock, seed):
    """Whatever the parts take, a job that is cut short ends where a unit does."""
    rng = np.random.default_rng(seed)
    unit = int(rng.integers(1, 8))
    most, count = unit + int(rng.integers(0, 100)), int(rng.integers(1, 1000))
    spans = []

    def run(start, stop):
        spans.append((start, stop))
        clock.now += rng.choice([0.01, 0.03, 0.5])

    _, done, seconds = jobs.run_parts(run, count, unit, most)
    assert seconds == clock.now
    assert [at for at, _ in spans] == [0, *(stop for _, stop in spans[:-1])]
    assert max(stop - start for start, stop in spans) <= most
    assert done == spans[-1][1]
    assert done == count or (done % unit == 0 and seconds >= jobs.LONGEST)


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
        ri.sweep(family(np.ones(50)), "finite-difference", executor=Stuck(), progress=interrupt)
    assert len(handed) == 6
    assert all(job.cancelled() for job in handed)


@pytest.mark.parametrize(("says", "workers"), [
    ({"_max_workers": 5}, 5), ({}, jobs.UNKNOWN),
    ({"_client": SimpleNamespace(ncores=lambda: {"a": 4, "b": 2})}, 6),
    ({"_client": SimpleNamespace(ncores=dict)}, jobs.UNKNOWN),
])
def test_an_executor_is_asked_for_its_workers(says, workers):
    assert jobs.workers_of(SimpleNamespace(**says)) == workers
