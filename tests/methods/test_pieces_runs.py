"""Runs of characteristics: what stays the same however they run, and beside finite
differences.
"""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from networks import random_network, unit_rod
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.methods.pieces import driver, method

METHOD = "characteristics"


def numbers_of(solution):
    """Velocities of rods, forces and totals of contacts, one behind the other, in one
    array.
    """
    times = np.linspace(0, solution.t_end, 9)
    numbers = []
    for i, body in enumerate(solution.system.bodies):
        if isinstance(body, ri.Rod):
            x = 0.3 * body.length
            numbers.append(solution.velocity(i, x, times))
    for contact in solution.contacts:
        totals = [contact.impulse, contact.peak_force, contact.duration]
        numbers.append(contact.force(times))
        numbers.append(totals)
    return np.concatenate(numbers)


def solved(system, compiling):
    """The solution by characteristics to 2 s, compiled or in plain Python."""
    with kernels.forced(compiling):
        return ri.solve(system, until=2.0, method=METHOD)


# The same however it is run
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(2), [1]))
def test_a_run_that_starts_with_little_room_comes_to_the_same_numbers(
    monkeypatch, seed
):
    """A random row is run with short logs, which are lengthened on the way: all numbers
    are those of a usual run.
    """
    system = random_network(seed)
    expected = solved(system, compiling=False)
    monkeypatch.setattr(driver, "INITIAL_LOG_ROWS", 4)
    monkeypatch.setattr(driver, "INITIAL_CONTACT_ROWS", 1100)

    solution = solved(system, compiling=False)

    numbers = numbers_of(solution)
    assert np.array_equal(numbers, numbers_of(expected))


def family():
    """A family of 2 x 4 members, by stiffness and length."""
    lengths = np.array([0.4, 0.7, 1.0, 0.9])
    stiffnesses = np.array([[10.0], [1e5]])
    striker = unit_rod(lengths, velocity=1.0)
    bodies = [striker, ri.RigidMass(0.5), unit_rod(1.3)]
    laws = [ri.Hertz(stiffnesses), ri.HuntCrossley(20.0, damping=0.2)]
    return ri.System(bodies, gaps=[0.0, 0.01], contacts=laws)


def totals_of(result):
    """Velocities after, and totals of the contacts, of all members of a sweep, as
    lists.
    """
    columns = [velocities.tolist() for velocities in result.velocities_after]
    for contact in result.contacts:
        for name in ("impulse", "peak_force", "duration", "episodes"):
            totals = getattr(contact, name)
            columns.append(totals.tolist())
    return columns


needs_compiler = pytest.mark.skipif(
    bool(kernels.why_not()), reason="there is no compiler"
)


@pytest.fixture(scope="module")
def swept():
    """Results of the whole `family`, of all members at once."""
    return ri.sweep(family())


@needs_compiler
def test_members_are_the_same_in_threads_and_in_any_chunks(monkeypatch, swept):
    """A family swept in threads, or in small chunks with a short log, has the totals of
    the usual sweep.
    """
    with ThreadPoolExecutor(2) as executor:
        in_threads = ri.sweep(family(), executor=executor)

    monkeypatch.setattr(method, "MAX_MEMBERS_PER_CALL", 3)
    monkeypatch.setattr(driver, "MEMBERS_PER_CHECK", 2)
    monkeypatch.setattr(driver, "INITIAL_LOG_ROWS", 8)
    in_small_chunks = ri.sweep(family())

    assert totals_of(in_threads) == totals_of(swept)
    assert totals_of(in_small_chunks) == totals_of(swept)


@needs_compiler
@pytest.mark.parametrize("index", few_of([(0, 0), (1, 2)], [(1, 2)]))
def test_members_are_single_solves(swept, index):
    """Velocities and totals of a member are those of its own run, bit for bit."""
    with kernels.forced(compiling=False):
        solution = ri.solve(family()[index])

    outcome = solution.outcome
    velocities = [column[index] for column in swept.velocities_after]
    assert tuple(velocities) == outcome.velocities_after
    for columns, contact in zip(swept.contacts, outcome.contacts, strict=True):
        assert columns.impulse[index] == contact.impulse
        assert columns.peak_force[index] == contact.peak_force
        assert columns.duration[index] == contact.duration


@needs_compiler
def test_plain_python_runs_the_same_bits_as_machine_code():
    """Two random rows, one of them driven, have the same numbers in plain Python and
    compiled, also the sign of 0.
    """
    for seed in range(2):
        driven = seed % 2 == 1
        system = random_network(seed, bodies=4, driven=driven)
        plain = solved(system, compiling=False)
        compiled = solved(system, compiling=True)

        # Texts tell 0.0 from -0.0, and nan is as nan.
        plain_text = repr(numbers_of(plain).tolist())
        compiled_text = repr(numbers_of(compiled).tolist())
        assert plain_text == compiled_text, seed


# Beside another method
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(30), range(2)))
def test_random_rows_are_near_those_of_finite_differences_and_keep_their_energy(seed):
    """Two methods that share the row and nothing else, on all bodies, laws and ends:
    velocities differ by 0.01 m/s at most, impulses by 0.5 %.
    """
    driven = seed % 2 == 1
    system = random_network(seed, bodies=4, driven=driven)
    grid = ri.solve(
        system, until=1.0, method="finite-difference", cells=400, snapshots=2
    )

    solution = ri.solve(system, until=1.0, method=METHOD)

    for body in range(len(system.bodies)):
        expected = float(grid.mean_velocity(body, 1.0))
        velocity = float(solution.mean_velocity(body, 1.0))
        assert velocity == pytest.approx(expected, abs=0.01)
    for contact, on_grid in zip(solution.contacts, grid.contacts, strict=True):
        impulse = on_grid.impulse
        assert contact.impulse == pytest.approx(impulse, rel=5e-3, abs=5e-3)
    times = np.linspace(0, 1.0, 33)
    energy = solution.energy(times)
    largest_kinetic = np.abs(energy.kinetic).max()
    largest_vibration = np.abs(energy.vibration).max()
    scale = largest_kinetic + largest_vibration + 1.0
    # The residual may be as large as the energy that rigid contacts are stated to lose.
    numerical = np.abs(energy.numerical).max()
    residual = np.abs(energy.residual).max()
    assert residual <= 1e-8 * scale + numerical


# Waves too dense to be followed
# --------------------------------------------------------------------------------------


@pytest.mark.exhaustive
def test_waves_that_are_smoothed_keep_the_momentum_of_each_rod():
    """Four rods run so long that their waves are smoothed, as the status says. The
    momentum of each inner rod changes by the impulses of its two contacts.
    """
    rng = default_rng(22)
    lengths = rng.uniform(0.11, 1.3, 4)
    areas = rng.uniform(0.3, 2.0, 4)
    velocities = (1.0, 0.2, -0.1, -0.7)
    bodies = []
    for length, area, velocity in zip(lengths, areas, velocities, strict=True):
        rod = unit_rod(length, area=area, velocity=velocity)
        bodies.append(rod)
    fixed_ends = (ri.Fixed(), ri.Fixed())
    system = ri.System(bodies, ends=fixed_ends)

    solution = ri.solve(system, until=10.0, method=METHOD)

    assert "Such waves are smoothed" in solution.status
    outcome = solution.outcome
    impulses = [contact.impulse for contact in solution.contacts]
    for i in (1, 2):  # the rods between two contacts
        velocity_before = outcome.velocities_before[i]
        change = outcome.velocities_after[i] - velocity_before
        momentum_gained = bodies[i].mass * change
        impulse = impulses[i - 1] - impulses[i]
        assert impulse == pytest.approx(momentum_gained, abs=1e-8)
