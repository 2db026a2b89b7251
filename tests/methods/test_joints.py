"""Joints: springs and dashpots that pull as well, between rods, masses and walls."""

import math

import numpy as np
import pytest
from grid_rows import grid_run
from mistakes import assert_told
from networks import unit_rod
from scipy.linalg import expm

import rodimpact as ri
from rodimpact.methods.grid.proof import group_at_contact, present_motion

QUICK = ri.Material("quick", youngs_modulus=6.0, density=1.5)  # wave speed 2
METHODS = {"characteristics": {}, "finite-difference": {"cells": 64}}
both_methods = pytest.mark.parametrize("method", METHODS)


def solve_by(method, system, until=None, **options):
    """The solution by a method, with its options of `METHODS`."""
    options |= METHODS[method]
    return ri.solve(system, until=until, method=method, **options)


def quick_rod(length=1.0, **state):
    """A rod of the material `QUICK`."""
    return ri.Rod(length, area=0.7, material=QUICK, **state)


# A chain of masses
# --------------------------------------------------------------------------------------

WALL_STIFFNESS = 3.0  # of the spring between wall and first mass
MIDDLE_STIFFNESS = 5.0  # of the spring between the masses
DAMPING = 0.3  # of the dashpot between the masses
FIRST_MASS = 0.4
SECOND_MASS = 0.7
STRETCH = 0.2  # of the spring at the wall in the beginning


def chain_of_masses():
    """System of a wall, a spring, a mass, a spring with a dashpot, a mass; the rod
    beyond is never met. It is not solved.
    """
    first = ri.RigidMass(FIRST_MASS)
    second = ri.RigidMass(SECOND_MASS, velocity=1.0)
    far_rod = unit_rod()
    bodies = [ri.Wall(), first, second, far_rod]
    wall_spring = ri.Joint(WALL_STIFFNESS, stretch=STRETCH)
    dashpot = ri.Joint(MIDDLE_STIFFNESS, damping=DAMPING)
    laws = [wall_spring, dashpot, ri.Rigid()]
    return ri.System(bodies, gaps=[0.0, 0.0, 100.0], contacts=laws)


def exact_chain(times):
    """Stretches from the wall to each mass, then the velocities of both [time, 4], by
    the matrix exponential.
    """
    k0 = WALL_STIFFNESS
    k1 = MIDDLE_STIFFNESS
    K = np.array([[k0 + k1, -k1], [-k1, k1]])
    of_relative_motion = np.array([[1.0, -1.0], [-1.0, 1.0]])
    C = DAMPING * of_relative_motion
    inverse = np.diag([1 / FIRST_MASS, 1 / SECOND_MASS])
    # M x'' + C x' + K x = 0 as rates of (x, x')
    zeros = np.zeros((2, 2))
    rates_of_stretches = [zeros, np.eye(2)]
    rates_of_velocities = [-inverse @ K, -inverse @ C]
    A = np.block([rates_of_stretches, rates_of_velocities])
    start = np.array([STRETCH, STRETCH, 0.0, 1.0])
    states = [expm(A * time) @ start for time in times]
    return np.array(states)


@pytest.mark.parametrize(
    ("method", "residual"),
    [("characteristics", 1e-10), ("finite-difference", 1e-13)],
)
def test_a_chain_of_masses_swings_as_its_matrix_says(method, residual):
    """Gaps and velocity are those of `exact_chain`; the energy balances, and
    dissipation only grows.
    """
    times = np.arange(0, 6, 1 / 8)
    first, second, _, velocity = exact_chain(times).T

    solution = solve_by(method, chain_of_masses(), until=6.0)

    wall_spring, dashpot, _ = solution.contacts
    velocity_of_second = solution.velocity(2, 0.0, times)
    assert wall_spring.gap(times) == pytest.approx(first, abs=1e-3)
    assert dashpot.gap(times) == pytest.approx(second - first, abs=1e-3)
    assert velocity_of_second == pytest.approx(velocity, abs=3e-3)
    energy = solution.energy(times)
    assert np.abs(energy.residual).max() < residual
    stored_at_start = energy.contact[0]
    expected = WALL_STIFFNESS * STRETCH**2 / 2
    assert stored_at_start == pytest.approx(expected, rel=1e-14)
    dissipated = energy.dissipated
    assert np.diff(dissipated).min() >= 0
    assert dissipated[-1] > 0.1  # J, of 0.41 at the start


# The proof that a collision is over
# --------------------------------------------------------------------------------------


@both_methods
def test_a_joined_mass_and_rod_are_struck_as_one_body(method):
    """A rod strikes a mass with a rod joined to it. These two go on with one velocity,
    which gives e; the joint has no episodes, and in a run five times as long the
    striker does not meet them again.
    """
    striker = unit_rod(velocity=1.0)
    mass = ri.RigidMass(0.5)
    bodies = [striker, mass, quick_rod()]
    joint = ri.Joint(2.0, damping=0.1)
    system = ri.System(bodies, contacts=[ri.Rigid(), joint])

    solution = solve_by(method, system)
    later = 5 * solution.t_final
    longer = solve_by(method, system, until=later)

    outcome = solution.outcome
    assert solution.final
    assert outcome.unilateral == (0,)  # contacts, of which the joint is none
    assert solution.contacts[1].episodes == ()
    velocities = outcome.velocities_after
    after_striker, after_mass, after_rod = velocities
    assert after_mass == after_rod
    assert after_mass > after_striker
    momentum = outcome.masses @ np.array(velocities)
    assert momentum == pytest.approx(1.0, abs=1e-12)  # that of the striker, 1 kg
    parting = after_mass - after_striker  # the closing velocity was 1 m/s
    assert outcome.restitution == pytest.approx(parting, abs=1e-14)
    assert_last_contact_is_the_same(longer, solution)
    times = np.linspace(solution.t_proved, longer.t_end, 200)
    gap = longer.contacts[0].gap(times)
    assert gap.min() > 0


def assert_last_contact_is_the_same(longer, solution):
    """Assert that the last contact of a longer run is no later, except for round-off:
    the clock of that run is another one.
    """
    first_contact = longer.outcome.contacts[0]
    assert first_contact.last <= solution.t_final * (1 + 1e-12)


@both_methods
@pytest.mark.parametrize(
    "joint", [ri.Joint(0.0, damping=0.5), ri.Joint(0.5)], ids=["dashpot", "spring"]
)
def test_a_row_with_a_joint_is_proved_final_only_after_its_last_contact(method, joint):
    """A run four times as long has no later contact.

    The proof counts on how far a joint gives way: what leaves slowly may still be
    caught by the swing of what hangs on the other side.
    """
    first = unit_rod(velocity=0.99)
    second = unit_rod(velocity=1.0)
    third = quick_rod(velocity=-0.9)
    laws = [ri.Rigid(), joint]
    system = ri.System([first, second, third], gaps=[0.3, 0.0], contacts=laws)

    solution = solve_by(method, system)
    later = 4 * solution.t_final
    longer = solve_by(method, system, until=later)

    assert solution.final
    first_contact = solution.outcome.contacts[0]
    assert first_contact.episodes >= 1  # though the gap widens at first
    assert_last_contact_is_the_same(longer, solution)


def sides_of(system, steps):
    """Mean velocity, deviation and bound of it, as the proof takes them, of the end on
    the left of the last contact.

    One triple at the end of each of these steps of 1/64 s, in the laboratory and in SI
    units.
    """
    run = grid_run(system, room=steps[-1], step=1 / 64)
    left_nodes = run.grid.links["left_node"]
    node = int(left_nodes[-1])  # of the last contact
    sides = []
    for step in steps:
        run.advance(step)
        state = present_motion(run)
        side = group_at_contact(run, node, right_end=True, state=state)
        velocity = side.mean + run.row.frame
        sides.append((velocity, side.deviation, side.max_deviation))
    return sides


FIRST_ROD = quick_rod(velocity=0.2)
SECOND_ROD = unit_rod(velocity=0.4)
RODS_ON_A_MASS = [ri.RigidMass(0.5, velocity=-1.0), FIRST_ROD, SECOND_ROD]
RODS_ON_A_WALL = [ri.Wall(), FIRST_ROD, SECOND_ROD]
SOFT = [ri.Joint(0.02, stretch=0.3), ri.Joint(0.05, damping=0.01)]
DASHPOTS = [ri.Joint(0.0, damping=0.05), ri.Joint(0.0, damping=0.3)]


@pytest.mark.parametrize(
    "bodies", [RODS_ON_A_MASS, RODS_ON_A_WALL], ids=["free", "wall"]
)
@pytest.mark.parametrize("joints", [SOFT, DASHPOTS], ids=["soft", "dashpot"])
def test_an_end_beyond_joints_is_where_the_proof_says_and_stays_within_its_bound(
    bodies, joints
):
    """The end of a row of joined bodies, far from the next body, moves with their
    centre of mass and deviates, within the bound, by strains and stretches. The
    yielding of a dashpot is bounded, but not stated.
    """
    laws = [*joints, ri.Rigid()]
    far_rod = unit_rod()
    row = [*bodies, far_rod]
    system = ri.System(row, gaps=[0.0, 0.0, 90.0], contacts=laws)
    steps = [0, 64, 320, 640, 1280]  # of 1/64 s
    times = np.array(steps[1:]) / 64
    solution = ri.solve(system, until=20.0, method="finite-difference", dt=1 / 64)
    displacements = solution.displacement(2, 1.0, times)  # of the right end of the rod

    side_at_start, *later_sides = sides_of(system, steps)

    V, deviation, bound = side_at_start
    mean_motion = V * times
    deviations = displacements - mean_motion + deviation
    largest_deviation = np.abs(deviations).max()
    assert largest_deviation <= bound
    assert largest_deviation > bound / 10  # a bound that says something
    pairs = zip(deviations, later_sides, strict=True)
    for later_deviation, side in pairs:
        velocity, stated_deviation, later_bound = side
        assert velocity == pytest.approx(V, abs=1e-10)
        assert later_bound <= bound * (1 + 1e-9)
        if joints is SOFT:
            assert later_deviation == pytest.approx(stated_deviation, abs=1e-9)


# States
# --------------------------------------------------------------------------------------


@both_methods
def test_a_compressed_joint_sets_a_row_at_rest_in_motion(method):
    """A compressed joint drives two rods at rest apart, so far that the second strikes
    the third, which moves afterwards.
    """
    bodies = [unit_rod(), unit_rod(), unit_rod()]
    compressed = ri.Joint(2.0, stretch=-0.1)
    system = ri.System(
        bodies,
        gaps=[0.0, 0.02],
        contacts=[compressed, ri.Rigid()],
        ends=(ri.Fixed(), ri.Free()),
    )

    solution = solve_by(method, system, max_events=20_000)

    outcome = solution.outcome
    rigid_contact = outcome.contacts[1]
    assert rigid_contact.episodes >= 1
    *_, velocity_of_third = outcome.velocities_after
    assert velocity_of_third > 0


@both_methods
def test_a_stretched_joint_holds_prestressed_rods_at_rest(method):
    """Rods under tension between fixed ends do not move; the joint between them carries
    the tension and stores its energy.
    """
    tension = 0.02  # N
    unit_strain = tension  # E = 1 Pa, A = 1 m^2
    quick_strain = tension / (QUICK.youngs_modulus * 0.7)
    stiffness = 5.0
    stretch = tension / stiffness
    rods = [unit_rod(strain=unit_strain), quick_rod(strain=quick_strain)]
    joint = ri.Joint(stiffness, damping=0.4, stretch=stretch)
    fixed_ends = (ri.Fixed(), ri.Fixed())
    system = ri.System(rods, contacts=[joint], ends=fixed_ends)

    solution = solve_by(method, system, until=3.0)

    times = np.linspace(0, 3, 50)
    force = solution.contacts[0].force(times)
    assert force == pytest.approx(-tension, abs=1e-14)
    velocity = solution.velocity(0, 0.7, times)
    assert np.abs(velocity).max() < 1e-14
    stored = tension**2 / (2 * stiffness)
    stored_before = solution.outcome.contact_energy_before
    assert stored_before == pytest.approx(stored)


def distance_at_joint(solution):
    """Distance of the two ends at the joint at the end of the run, m."""
    end = solution.t_end
    left = solution.position(0, 1.0, end)
    right = solution.position(1, 0.0, end)
    return right - left


def test_a_state_goes_on_with_its_stretch():
    """The state of two joined rods in the middle of a run has the stretch of the joint
    and no gap. A run from this state has the gaps, and at the end the distance, of the
    whole run.
    """
    striker = unit_rod(velocity=1.0)
    joint = ri.Joint(3.0, damping=0.4)
    system = ri.System([striker, quick_rod()], contacts=[joint])
    whole = solve_by("characteristics", system, until=4.0)
    whole_joint = whole.contacts[0]

    state = whole.system_at(1.5)
    second_part = solve_by("characteristics", state, until=2.5)

    assert state.gaps == (0.0,)
    (continued_joint,) = state.contacts
    stretch = continued_joint.stretch
    assert stretch == float(whole_joint.gap(1.5))
    assert stretch != 0
    # Jumps of the state became straight lines over two samples: gaps change a little.
    rounding = 2e-6  # m
    times = np.linspace(0, 2.5, 40)
    gap = second_part.contacts[0].gap(times)
    expected = whole_joint.gap(1.5 + times)
    assert gap == pytest.approx(expected, abs=rounding)
    at_end = whole_joint.gap(4.0)
    distance = distance_at_joint(second_part)
    distance_of_whole = distance_at_joint(whole)
    assert distance == pytest.approx(at_end, abs=rounding)
    assert distance_of_whole == pytest.approx(at_end, abs=rounding)


def test_ever_stiffer_joints_come_to_a_bond():
    """The restitution with a joint goes to that with a bond: a joint 100 times as stiff
    is more than 10 times as near to it.
    """

    def restitution_with(law):
        """Restitution of a rod that strikes two rods which the law joins."""
        striker = unit_rod(velocity=1.0)
        bodies = [striker, unit_rod(0.5), quick_rod()]
        system = ri.System(bodies, contacts=[ri.Rigid(), law])
        solution = ri.solve(system, method="characteristics")
        return solution.outcome.restitution

    bonded = restitution_with(ri.Bonded())
    stiff = restitution_with(ri.Joint(1e3))
    stiffer = restitution_with(ri.Joint(1e5))

    error = abs(stiffer - bonded)
    assert error < 1e-3
    error_of_softer_joint = abs(stiff - bonded)
    assert error < error_of_softer_joint / 10


PAIR = [unit_rod(), unit_rod()]
MISTAKES = {
    "no stiffness and no damping": (
        lambda: ri.Joint(0.0),
        {"stiffness": "=must be positive where the damping is 0, got 0.0"},
    ),
    "a member without both": (
        lambda: ri.Joint([1.0, 0.0], damping=[0.0, 0.0]),
        {"stiffness[1]": ""},
    ),
    "three mistakes at once": (
        lambda: ri.Joint(-1.0, damping=math.nan, stretch=math.inf),
        {"stiffness": "", "damping": "", "stretch": ""},
    ),
    "a gap": (
        lambda: ri.System(PAIR, gaps=[1e-3], contacts=[ri.Joint(1.0)]),
        {"gaps.0": "must be 0 where bodies are joined, got 0.001; a Joint takes"},
    ),
    "a dashpot backwards in time": (
        lambda: ri.System(PAIR, contacts=[ri.Joint(1.0, damping=0.1)]).reversed(),
        {"contacts.0.damping": ""},
    ),
    "too stiff": (
        lambda: ri.solve(ri.System(PAIR, contacts=[ri.Joint(1e30)]), until=1.0),
        {"contacts.0.stiffness": "use Bonded()"},
    ),
}


@pytest.mark.parametrize(("make", "messages"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_of_joints_are_named(make, messages):
    assert_told(make, messages)
