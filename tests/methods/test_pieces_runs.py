"""Runs of characteristics: what stays the same however they run, and beside finite differences."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from networks import random_network, unit_rod

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.methods.pieces import driver, method

METHOD = "characteristics"


def everything(solution):
    """Numbers that a run comes to, and its waves at some places."""
    t = np.linspace(0, solution.t_end, 9)
    rods = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, ri.Rod)]
    waves = [
        solution.velocity(i, 0.3 * solution.system.bodies[i].length, t) for i in rods
    ]
    forces = [c.force(t) for c in solution.contacts]
    tallies = [(c.impulse, c.peak_force, c.duration) for c in solution.contacts]
    return np.concatenate([*waves, *forces, *map(np.array, tallies)])


# The same however it is run -----------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(2))
def test_a_run_that_finds_too_little_room_goes_on_with_more(monkeypatch, seed):
    system = random_network(seed)
    with kernels.forced(False):
        whole = everything(ri.solve(system, 2.0, METHOD))
        monkeypatch.setattr(driver, "INITIAL_LOG_ROWS", 4)
        monkeypatch.setattr(driver, "INITIAL_CONTACT_ROWS", 1100)
        assert everything(ri.solve(system, 2.0, METHOD)).tolist() == whole.tolist()


def family():
    return ri.System(
        [
            unit_rod(np.array([0.4, 0.7, 1.0, 0.9]), velocity=1.0),
            ri.RigidMass(0.5),
            unit_rod(1.3),
        ],
        [0.0, 0.01],
        [ri.Hertz(np.array([[10.0], [1e5]])), ri.HuntCrossley(20.0, 0.2)],
    )


def totals(result):
    names = ("impulse", "peak_force", "duration", "episodes")
    return [
        *(v.tolist() for v in result.velocities_after),
        *(getattr(c, name).tolist() for c in result.contacts for name in names),
    ]


@pytest.mark.skipif(bool(kernels.why_not()), reason="there is no compiler")
def test_members_are_single_solves_in_any_chunks(monkeypatch):
    system = family()
    whole = ri.sweep(system)
    with ThreadPoolExecutor(2) as executor:
        assert totals(ri.sweep(system, executor=executor)) == totals(whole)
    monkeypatch.setattr(method, "MAX_MEMBERS_PER_CALL", 3)
    monkeypatch.setattr(driver, "MEMBERS_PER_CHECK", 2)
    monkeypatch.setattr(driver, "INITIAL_LOG_ROWS", 8)
    assert totals(ri.sweep(system)) == totals(whole)
    for index in ((0, 0), (1, 2)):
        with kernels.forced(False):
            single = ri.solve(system[index]).outcome
        assert (
            tuple(v[index] for v in whole.velocities_after) == single.velocities_after
        )
        for many, one in zip(whole.contacts, single.contacts, strict=True):
            assert (
                many.impulse[index],
                many.peak_force[index],
                many.duration[index],
            ) == (one.impulse, one.peak_force, one.duration)


@pytest.mark.skipif(bool(kernels.why_not()), reason="there is no compiler")
def test_plain_python_runs_the_same_bits():
    found = []
    for fast in (False, True):
        systems = [
            random_network(seed, bodies=4, driven=seed % 2 == 1) for seed in range(6)
        ]
        with kernels.forced(fast):
            found.append(
                [everything(ri.solve(s, 2.0, METHOD)).tolist() for s in systems]
            )
    assert repr(found[0]) == repr(found[1])


# Beside another method ----------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(60), range(10)))
def test_random_rows_are_those_of_finite_differences(seed):
    """Two methods that share the row and nothing else, on all bodies, laws and ends."""
    system = random_network(seed, bodies=4, driven=seed % 2 == 1)
    s = ri.solve(system, 1.0, METHOD)
    grid = ri.solve(system, 1.0, "finite-difference", cells=400, snapshots=2)
    for body in range(len(system.bodies)):
        v = float(grid.mean_velocity(body, 1.0))
        assert float(s.mean_velocity(body, 1.0)) == pytest.approx(v, abs=0.01)
    for one, other in zip(s.contacts, grid.contacts, strict=True):
        assert one.impulse == pytest.approx(other.impulse, rel=5e-3, abs=5e-3)
    book = s.energy(np.linspace(0, 1.0, 33))
    moved = np.abs(book.kinetic).max() + np.abs(book.vibration).max() + 1.0
    assert np.abs(book.residual).max() <= 1e-8 * moved + np.abs(book.numerical).max()


# Waves too dense to be followed -------------------------------------------------------------------


def test_waves_that_are_smoothed_keep_their_momentum():
    """What the two contacts of a rod give it is its change of momentum."""
    rng = np.random.default_rng(22)
    lengths = rng.uniform(0.11, 1.3, 4)
    areas = rng.uniform(0.3, 2.0, 4)
    bodies = [
        unit_rod(length, area, velocity=v)
        for length, area, v in zip(lengths, areas, (1.0, 0.2, -0.1, -0.7), strict=True)
    ]
    found = ri.solve(ri.System(bodies, ends=(ri.Fixed(), ri.Fixed())), 10.0, METHOD)
    assert "Such waves are smoothed" in found.status
    impulses = [contact.impulse for contact in found.contacts]
    changes = np.subtract(
        found.outcome.velocities_after, found.outcome.velocities_before
    )
    for i in (1, 2):
        assert impulses[i - 1] - impulses[i] == pytest.approx(
            bodies[i].mass * changes[i], abs=1e-8
        )
