"""Rigid-body laws: the balances, limits and refusals; validation/ has the textbook's
numbers.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.random import default_rng

import rodimpact as ri
from rodimpact import rigid

EPS = np.finfo(float).eps
MASS = st.floats(1e-3, 1e3)
VELOCITY = st.floats(-100, 100)
RESTITUTION = st.floats(0, 1)


# The balances
# --------------------------------------------------------------------------------------


class Collisions(NamedTuple):
    """Ten thousand random collisions, kg and m/s, and what they come to."""

    m1: np.ndarray
    v1: np.ndarray
    m2: np.ndarray
    v2: np.ndarray
    after: rigid.RigidCollision


@pytest.fixture(scope="module")
def collisions():
    """`Collisions` of masses from 1 mg to 1000 t; the faster body is on the left."""
    rng = default_rng(1)
    exponents = rng.uniform(-6, 6, size=(2, 10_000))
    m1, m2 = 10.0**exponents
    velocities = rng.normal(scale=10.0, size=(2, 10_000))
    v2, v1 = np.sort(velocities, axis=0)
    restitution = rng.uniform(-1, 1, size=10_000)
    after = rigid.collide(m1, v1, m2, v2, restitution)
    return Collisions(m1, v1, m2, v2, after)


def test_momentum_is_kept_and_the_impulse_is_the_change_of_either_momentum(collisions):
    """All differences are at most a few roundings of the sums of magnitudes."""
    m1, v1, m2, v2, after = collisions
    w1 = after.velocity_1
    w2 = after.velocity_2
    momentum_before = m1 * v1 + m2 * v2
    momentum_after = m1 * w1 + m2 * w2
    magnitudes_before = m1 * abs(v1) + m2 * abs(v2)
    magnitudes_after = m1 * abs(w1) + m2 * abs(w2)
    round_off = 4 * EPS * (magnitudes_before + magnitudes_after)
    gained_momentum = momentum_after - momentum_before
    change_of_second = m2 * (w2 - v2)
    change_of_first = m1 * (v1 - w1)
    assert np.all(abs(gained_momentum) <= round_off)
    assert np.all(abs(change_of_second - after.impulse) <= round_off)
    assert np.all(abs(change_of_first - after.impulse) <= round_off)


def test_energy_is_never_gained_and_what_is_lost_is_the_difference(collisions):
    """For 10,000 collisions the energy does not grow, and `energy_lost` is its
    decrease, to round-off.
    """
    after = collisions.after
    difference = after.energy_before - after.energy_after
    round_off = 8 * EPS * after.energy_before
    assert np.all(difference >= -round_off)
    assert np.all(after.energy_lost >= 0)
    unexplained = difference - after.energy_lost
    assert np.all(abs(unexplained) <= round_off)


@given(MASS, VELOCITY, MASS, VELOCITY, RESTITUTION)
def test_velocities_after_have_the_restitution_that_was_given(m1, v1, m2, v2, e):
    assume(v1 - v2 > 1e-3)  # m/s: a slower approach loses digits of e
    after = rigid.collide(m1, v1, m2, v2, e)
    w1 = after.velocity_1
    w2 = after.velocity_2
    measured = rigid.restitution_from_velocities(v1, v2, w1, w2)
    assert measured == pytest.approx(e, abs=1e-9)


@given(MASS, VELOCITY, MASS, VELOCITY, RESTITUTION, VELOCITY)
def test_velocities_after_are_the_same_in_a_moving_frame(m1, v1, m2, v2, e, u):
    """If u is added to both velocities before a collision, it is added to both after
    it.
    """
    assume(v1 - v2 > 1e-3)
    after = rigid.collide(m1, v1, m2, v2, e)
    moving = rigid.collide(m1, v1 + u, m2, v2 + u, e)
    velocity_1 = moving.velocity_1 - u
    velocity_2 = moving.velocity_2 - u
    assert velocity_1 == pytest.approx(after.velocity_1, abs=1e-12)
    assert velocity_2 == pytest.approx(after.velocity_2, abs=1e-12)


@given(MASS, VELOCITY, MASS, VELOCITY, RESTITUTION)
def test_a_collision_is_the_same_in_a_mirror(m1, v1, m2, v2, e):
    """The bodies change sides, velocities their sign; velocities after, impulse and
    lost energy correspond.
    """
    assume(v1 - v2 > 1e-3)
    after = rigid.collide(m1, v1, m2, v2, e)
    mirror = rigid.collide(m2, -v2, m1, -v1, e)  # body 2 is on the left in it
    velocity_1 = -mirror.velocity_2
    velocity_2 = -mirror.velocity_1
    assert velocity_1 == pytest.approx(after.velocity_1, abs=1e-12)
    assert velocity_2 == pytest.approx(after.velocity_2, abs=1e-12)
    assert mirror.impulse == pytest.approx(after.impulse)
    assert mirror.energy_lost == pytest.approx(after.energy_lost)


@given(MASS, VELOCITY, MASS, VELOCITY)
def test_a_plastic_collision_leaves_one_velocity(m1, v1, m2, v2):
    """With e = 0 both velocities after are that of the centre of mass."""
    assume(v1 > v2)
    after = rigid.collide(m1, v1, m2, v2, 0.0)
    assert after.velocity_1 == after.centre_of_mass_velocity
    assert after.velocity_2 == after.centre_of_mass_velocity


@given(MASS, VELOCITY, MASS, VELOCITY)
def test_a_restitution_of_minus_one_changes_nothing(m1, v1, m2, v2):
    """With e = -1 both masses keep their velocities, without impulse and loss."""
    assume(v1 > v2)
    after = rigid.collide(m1, v1, m2, v2, -1.0)
    assert after.velocity_1 == pytest.approx(v1, abs=1e-12)
    assert after.velocity_2 == pytest.approx(v2, abs=1e-12)
    assert after.impulse == 0.0
    assert after.energy_lost == 0.0


def test_a_moving_wall_keeps_its_velocity_and_has_infinite_energy():
    """A wall is a body of infinite mass."""
    after = rigid.collide(m1=0.5, v1=10.0, m2=math.inf, v2=-2.0, restitution=1.0)
    assert after.velocity_2 == -2.0
    # The body comes to the wall with 12 m/s, and leaves it with 12 m/s.
    assert after.velocity_1 == -14.0
    assert after.energy_before == math.inf
    assert after.energy_after == math.inf
    assert after.energy_lost == 0.0


# Stacks
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 5])
def test_a_stack_of_light_balls_tends_to_the_square_of_two_to_the_n_less_one(n):
    """Its top is thrown to that many times the height of the drop."""
    masses = 1e-9 ** np.arange(n)  # from below, each much lighter than the last
    restitutions = np.ones(n)
    drop = rigid.stack_drop(masses, restitutions, height=1.0)
    velocity_ratio = 2**n - 1
    assert drop.top_height == pytest.approx(velocity_ratio**2, rel=1e-6)


def test_a_stack_is_a_row_of_collisions():
    """Velocities and height of `stack_drop` for three balls are those of two
    collisions: the lowest ball, thrown back by the ground, meets the second, which then
    meets the third; both still fall at v.
    """
    g = 9.81  # m/s^2
    height = 1.5  # m
    v = math.sqrt(2 * g * height)
    thrown_back = 0.9 * v
    first = rigid.collide(m1=3.0, v1=thrown_back, m2=2.0, v2=-v, restitution=0.8)
    after_first = first.velocity_2
    second = rigid.collide(m1=2.0, v1=after_first, m2=1.0, v2=-v, restitution=0.7)
    expected = [first.velocity_1, second.velocity_1, second.velocity_2]

    drop = rigid.stack_drop([3.0, 2.0, 1.0], [0.9, 0.8, 0.7], height)

    assert drop.velocities == pytest.approx(expected)
    top_height = second.velocity_2**2 / (2 * g)
    assert drop.top_height == pytest.approx(top_height)


# Shapes
# --------------------------------------------------------------------------------------


def test_a_small_gap_makes_stacked_balls_collide_one_after_another():
    """Two masses fall on a wall, with a gap of 1 um between them. The velocity of the
    upper one after its first contact is that of `stack_drop`. The tutorial and two
    docstrings name this gap.
    """
    masses = [0.6, 0.06]
    laws = [ri.Rigid(restitution=0.9), ri.Rigid(restitution=0.6)]
    first = ri.RigidMass(masses[0])
    second = ri.RigidMass(masses[1])
    gaps = [1.0, 1e-6]
    system = ri.System([ri.Wall(), first, second], gaps, laws, gravity=-9.81)

    solution = ri.solve(system, until=0.5)
    first_episode, *_ = solution.contacts[1].episodes
    after = first_episode.start + 1e-6  # s
    velocity = solution.velocity(2, x=0.0, t=after)

    drop = rigid.stack_drop(masses, [0.9, 0.6], height=1.0)
    *_, expected = drop.velocities  # of the top
    assert velocity == pytest.approx(expected, rel=1e-4)
    docs = Path(__file__).parent.parent / "docs"
    tutorial = docs / "student.md"
    assert "gaps=[1.0, 1e-6]" in tutorial.read_text()
    assert "gaps=[1.0, 1e-6]" in rigid.stack_drop.__doc__
    assert "close at the same time are solved as one" in ri.System.__doc__


def test_shapes_of_results_are_those_of_the_broadcast_arguments():
    """`collide`, `stack_drop` and `reduced_mass` of a column and a row have results of
    shape (2, 3); velocities of stacks have one axis more.
    """
    column = np.array([[1.0], [2.0]])
    row = np.array([0.0, 0.5, 1.0])
    masses_of_3_stacks = np.ones((3, 2))  # [stack, ball]

    after = rigid.collide(m1=column, v1=1.0, m2=1.0, v2=0.0, restitution=row)
    drop = rigid.stack_drop(masses_of_3_stacks, [0.9, 0.9], height=column)
    reduced_mass = rigid.reduced_mass(column, row + 1)

    assert {entry.shape for entry in after} == {(2, 3)}
    assert drop.velocities.shape == (2, 3, 2)
    assert drop.top_height.shape == (2, 3)
    assert reduced_mass.shape == (2, 3)


# Refusals
# --------------------------------------------------------------------------------------

COLLISION = {"m1": 1.0, "v1": 1.0, "m2": 2.0, "v2": 0.0, "restitution": 0.5}


@pytest.mark.parametrize("e", [1.1, -1.1])
def test_a_restitution_beyond_1_needs_permission_and_releases_energy(e):
    """It is refused, also as one of several; with `allow_energy_release` the lost
    energy is negative.
    """
    collision = {"m1": 1.0, "v1": 1.0, "m2": 1.0, "v2": 0.0}
    message = rf"restitution\[1\]: .*, got {e}, .*set allow_energy_release=True"

    with pytest.raises(ValueError, match=message):
        rigid.collide(**collision, restitution=[0.5, e])
    after = rigid.collide(**collision, restitution=e, allow_energy_release=True)

    assert after.energy_lost < 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"m1": 0.0}, r"m1: must be a positive .*or infinite, got 0\.0"),
        ({"m2": [1.0, math.nan]}, r"m2\[1\]: .*, got nan"),
        ({"m1": math.inf, "m2": math.inf}, r"m2: .*, got inf"),
        ({"v1": math.nan}, r"v1: must be a finite number of m/s, got nan"),
        ({"restitution": math.nan}, r"restitution: must be a finite number, got nan"),
        (
            {"v1": [1.0, 3.0], "v2": 2.0},
            r"v1\[0\]: must be above the velocity of body 2, 2\.0",
        ),
    ],
)
def test_impossible_collisions_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        rigid.collide(**(COLLISION | changes))


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (
            rigid.restitution_from_velocities,
            (1, 1, 0, 0),
            r"v1_before: .*, 1\.0, got 1",
        ),
        (
            rigid.restitution_from_velocities,
            (1, 0, math.nan, 0),
            "v1_after: must be .* nan",
        ),
        (
            rigid.restitution_from_heights,
            (0, 0),
            r"drop: must be a .*positive .*, got 0\.0",
        ),
        (
            rigid.restitution_from_heights,
            (1, -1),
            r"rebound: .*non-negative .*, got -1",
        ),
        (
            rigid.restitution_from_heights,
            (1, 2),
            r"rebound: .* the drop, 1\.0, got 2\.0",
        ),
        (
            rigid.stack_drop,
            ([1, 0], [1, 1], 1),
            r"masses\[1\]: must be .*, got 0\.0",
        ),
        (
            rigid.stack_drop,
            ([1, 1], [1, 2], 1),
            r"restitutions\[1\]: must .*, got 2\.0",
        ),
        (
            rigid.stack_drop,
            ([1, 1], [1], 1),
            "masses has 2 balls and restitutions 1",
        ),
        (rigid.stack_drop, ([], [], 1), "at least one ball"),
        (rigid.stack_drop, ([1], [1], 1, -1), r"gravity: must be .*, got -1\.0"),
    ],
)
def test_impossible_velocities_heights_and_stacks_are_refused(
    function, arguments, message
):
    with pytest.raises(ValueError, match=message):
        function(*arguments)
