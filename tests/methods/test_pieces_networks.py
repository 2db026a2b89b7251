"""Random rows by characteristics, beside the independent solver of the tests."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from method_of_steps import solve
from networks import mixed_network, sine, with_sines

import rodimpact as ri
from rodimpact.methods.pieces import driver

STATED = ("velocity", "impulse", "peak force", "duration", "time")
BOUND = {"velocity": 1e-7, "impulse": 1e-7, "peak force": 1e-6, "duration": 1e-6, "time": 1e-6,
         "gap": 1e-6}
USUAL = (2001, 2003, 2004, 2005, 2006, 2012, 2018, 2024, 2030, 2036, 2063)


@pytest.fixture(autouse=True)
def nothing_is_compiled(monkeypatch):
    monkeypatch.setattr(driver, "PLAIN", 1 << 40)


def largest(values):
    return max((abs(v) for v in values if not math.isnan(v)), default=0.0)


def errors(system, until, one, other):
    """Largest errors of contacts and velocities, relative to the largest value of each."""
    pairs = [(law, a, b) for law, a, b in zip(system.contacts, one.contacts, other.contacts,
                                              strict=True) if None not in (a, b)]
    free = [(a, b) for law, a, b in pairs if law.opens]
    off = {
        "velocity": [a - b for a, b in zip(one.velocities, other.velocities, strict=True)],
        "impulse": [a.impulse - b.impulse for _, a, b in pairs],
        "peak force": [a.peak_force - b.peak_force for law, a, b in pairs
                       if not isinstance(law, ri.Bonded)],
        "duration": [a.duration - b.duration for a, b in free],
        "gap": [a.gap(until) - b.gap(until) for a, b in free],
        "time": [x - y for a, b in free for e, f in zip(a.episodes, b.episodes, strict=True)
                 for x, y in zip(e, f, strict=True)],
    }
    V = largest(one.velocities)
    size = {
        "velocity": V, "impulse": largest(a.impulse for _, a, _ in pairs),
        "peak force": largest(a.peak_force for _, a, _ in pairs), "duration": until,
        "time": until, "gap": max(largest(a.gap(until) for a, _ in free), V * until / 10),
    }
    return {name: largest(off[name]) / (size[name] or 1.0) for name in off}


def turns(system, result):
    """When the contacts that can open press, let go and open."""
    pairs = zip(system.contacts, result.contacts, strict=True)
    return [t for law, c in pairs if law.opens for e in c.episodes for t in e]


class Found:
    """What a solution says, in the words of the reference."""

    def __init__(self, system, solution, until):
        rigid = [isinstance(law, ri.Bonded)
                 and not any(isinstance(b, ri.Rod) for b in system.bodies[k : k + 2])
                 for k, law in enumerate(system.contacts)]
        self.contacts = [None if bond else c
                         for bond, c in zip(rigid, solution.contacts, strict=True)]
        self.velocities = [float(solution.mean_velocity(i, until))
                           for i in range(len(system.bodies))]


@pytest.mark.parametrize("seed", few_of(range(2000, 2070), USUAL))
def test_random_rows_are_those_of_an_independent_solver(seed):
    system, until, sines = mixed_network(np.random.default_rng(seed))
    drives = {k: sine(*numbers) for k, numbers in sines.items()}
    reference = solve(system, until, 1e-13, drives)
    solution = ri.solve(with_sines(system, sines, until), until, "characteristics")
    found = Found(system, solution, until)
    assert turns(system, found) == pytest.approx(
        turns(system, reference), abs=BOUND["time"] * until, nan_ok=True)
    true, doubt = errors(system, until, reference, found), dict.fromkeys(BOUND, 1e-12)
    if any(solution.accuracy[name] < true[name] - doubt[name] for name in STATED) or any(
            true[name] > BOUND[name] for name in BOUND):
        others = [errors(system, until, reference, solve(system, until, tolerance, drives))
                  for tolerance in (1e-12, 1e-11)]  # its round-off shows in the nearer one, too
        doubt = {name: 2 * max(other[name] for other in others) for name in BOUND}
    for name in BOUND:
        assert true[name] <= BOUND[name] + 10 * doubt[name], name
    for name in STATED:
        assert solution.accuracy[name] >= true[name] - doubt[name] - 1e-12, name
