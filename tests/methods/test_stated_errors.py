"""What characteristics state as errors is never less than the errors, against a finer
run.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from compliant_rows import KINDS, random_compliant_row
from exhaustive import few_of
from networks import random_network, unit_rod

import rodimpact as ri

METHOD = "characteristics"
EXACT_RTOL = 1e-13  # tolerance of the finer run


def by_characteristics(system, until, rtol=None):
    """The solution by characteristics to `until`, s."""
    return ri.solve(system, until=until, method=METHOD, rtol=rtol)


def row_of(kind, seed):
    """A random row of this kind, and the time until which it is run, s."""
    if kind not in ("network", "driven network"):
        return random_compliant_row(kind, seed)
    driven = kind == "driven network"
    system = random_network(seed, bodies=4, driven=driven)
    return system, 2.0


def measures_of(solution):
    """{measure: values of all bodies or contacts}; bonds are left out, and a missing
    time is 0.
    """
    contacts = []
    last_openings = []
    for i, law in enumerate(solution.system.contacts):
        if not isinstance(law, ri.Bonded):
            contacts.append(solution.run.contacts[i])
            episodes = solution.contacts[i].episodes
            if episodes:
                last_episode = episodes[-1]
                last_openings.append(last_episode.opening)
    firsts = [c.first for c in contacts]
    lasts = [c.last for c in contacts]
    times = [*firsts, *lasts, *last_openings]
    values = {
        "velocity": solution.outcome.velocities_after,
        "impulse": [c.impulse for c in contacts],
        "peak force": [c.peak_force for c in contacts],
        "duration": [c.duration for c in contacts],
        "time": times,
    }
    measures = {}
    for name, value in values.items():
        measures[name] = np.nan_to_num(value)
    return measures


class MeasureError(NamedTuple):
    """Largest error of a measure, and the scale beside which errors are stated."""

    error: float
    scale: float


def errors_of(solution, exact):
    """Error of each measure of a run beside a finer one, by the names of measures."""
    exact_measures = measures_of(exact)
    errors = {}
    for name, values in measures_of(solution).items():
        exact_values = exact_measures[name]
        error = np.abs(values - exact_values).max(initial=0.0)
        scale = np.abs(exact_values).max(initial=0.0)
        if name == "velocity":
            scale = solution.fields.clock.scale
        errors[name] = MeasureError(error, scale)
    return errors


def assert_bounded(system, until, rtol):
    """A run differs from one of a smaller rtol by no more than both runs state as their
    errors.
    """
    solution = by_characteristics(system, until, rtol)
    exact = by_characteristics(system, until, EXACT_RTOL)
    errors = errors_of(solution, exact)
    for name, (error, scale) in errors.items():
        stated = solution.accuracy[name] + exact.accuracy[name]
        assert error <= stated * scale, name


MEDIANS = {
    "velocity": 30,
    "impulse": 30,
    "peak force": 30,
    "duration": 100,
    "time": 100,
}
"""Largest median of the stated errors over the true ones."""
LEAST_ERROR = 1e-14  # true one that a finer run can show


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "seeds", few_of([range(50, 58), range(40, 60)], [range(50, 58)])
)
def test_half_of_the_stated_errors_are_near_the_true_ones(seeds):
    """For random rows of all kinds, the median ratio of the stated to the true error of
    each measure is at most that in `MEDIANS`.
    """
    ratios = {name: [] for name in MEDIANS}
    for kind, seed in product(KINDS, seeds):
        system, until = random_compliant_row(kind, seed)
        solution = by_characteristics(system, until)
        exact = by_characteristics(system, until, EXACT_RTOL)
        errors = errors_of(solution, exact)
        for name, (error, scale) in errors.items():
            if scale > 0:
                relative_error = max(error / scale, LEAST_ERROR)
                ratio = solution.accuracy[name] / relative_error
                ratios[name].append(ratio)

    for name, largest in MEDIANS.items():
        median = np.median(ratios[name])
        assert median <= largest, name


ONCE_UNSEEN = {  # kind and seed of the row, and rtol
    "a first piece in a chain of masses, as long at any tolerance": (
        "network",
        59,
        1e-8,
    ),
    "an opening whose time depends on one value of a polynomial": ("mixed", 74, 1e-8),
    "a peak beside a kink, of which both runs took the same pieces": (
        "power",
        48,
        1e-8,
    ),
    "a peak that is hidden by the error of its piece": ("dashpot", 47, 1e-10),
    "a stiff contact that opens early in a long piece": ("network", 76, 1e-6),
    "a gap that closes slowly": ("driven network", 59, 1e-10),
}


@pytest.mark.parametrize("case", ONCE_UNSEEN.values(), ids=ONCE_UNSEEN)
def test_an_error_that_was_once_not_seen_is_stated(case):
    """Errors beside a finer run are at most what both runs state."""
    kind, seed, rtol = case
    system, until = row_of(kind, seed)
    assert_bounded(system, until, rtol)


ALL_KINDS = (*KINDS, "network", "driven network")
ROWS = list(product(ALL_KINDS, (1, 5, 9), (1e-6, 1e-8, 1e-10)))
USUAL = [(kind, 9, 1e-8) for kind in ALL_KINDS]


@pytest.mark.parametrize("case", few_of(ROWS, USUAL))
def test_stated_errors_bound_those_of_random_rows(case):
    """Errors beside a finer run are at most what both runs state."""
    kind, seed, rtol = case
    system, until = row_of(kind, seed)
    assert_bounded(system, until, rtol)


def test_a_spring_whose_force_ends_before_it_opens_states_the_difference():
    """The time between is within the stated error of times. The last piece of the
    spring has a force that counts as none, for its overlap is too small.
    """
    system, until = random_compliant_row("power", 34)

    solution = by_characteristics(system, until, EXACT_RTOL)

    end_of_force = solution.run.contacts[0].last
    last_episode = solution.contacts[0].episodes[-1]
    opening = last_episode.opening
    difference = opening - end_of_force
    assert 0 < difference < 1e-5
    times = measures_of(solution)["time"]
    largest_time = times.max()
    stated = solution.accuracy["time"] * largest_time
    assert difference <= stated < 1e-2


@pytest.mark.parametrize("restitution", [0.3, 0.7])
def test_bodies_that_are_set_at_rest_state_the_velocity_that_they_lose(restitution):
    """A ball on a floor bounces until it would part by less than 1e-8 of the velocity
    scale and is set at rest. The stated error of velocities is about as large.
    """
    # The floor is the wall on the left. The rod is too far away to be struck.
    ball = ri.RigidMass(1.0, velocity=0.0)
    bodies = [ri.Wall(), ball, unit_rod()]
    laws = [ri.Rigid(restitution=restitution), ri.Rigid()]
    system = ri.System(bodies, gaps=[0.1, 90.0], contacts=laws, gravity=-1.0)

    solution = by_characteristics(system, 4.0, rtol=1e-12)

    assert "set at rest" in solution.status
    stated = solution.accuracy["velocity"]
    assert 1e-8 / 10 < stated <= 1e-8 * 10
