"""The twelve problems of the textbook's section on collisions in one dimension.

If a problem gives numbers, the expected results are computed by hand, as fractions. If
a problem asks for a formula, the formula is compared with rodimpact on a grid or for
random numbers, and the table gives the largest deviation. Bounces and bullets are also
followed collision by collision, with `rigid.collide` alone.

Source: textbook section 10.5, "Collisions in 1D", problems 10.5.1 to 10.5.12.
"""

import math
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

from rodimpact import rigid

from .table import Case, Rows, largest_magnitude

DRAWS = 10_000  # random collisions
BOUNCES = 400  # bounces that are followed one by one
GRAVITY = 9.81  # m/s^2; heights of bounces do not depend on it
BALL_MASS = 0.3  # kg; beside the infinite mass of the ground any value will do


def run() -> Rows:
    """Compare problems 10.5.1 to 10.5.12; 10.5.9 has numbers and formulas."""
    yield from eleven_questions()
    yield from two_heights()
    yield from embedded_bullet()
    yield from one_bounce()
    yield from matrix_form()
    yield from impulse_and_velocities()
    yield from energy_lost()
    yield from bounces_without_end()
    yield from bullet_through_block()
    yield from random_bullets()
    yield from ball_on_ball()
    yield from no_energy_from_nothing()
    yield from largest_loss()


def relative_difference(got: rigid.Number, expected: rigid.Number) -> float:
    """Largest relative difference."""
    return largest_magnitude(np.asarray(got) / expected - 1)


def eleven_questions() -> Rows:
    """10.5.1, eleven numbers: 1 kg at 10 m/s hits 2 kg at 5 m/s, goes on at 6 m/s.

    e follows from the impulse; `rigid.collide` with this e then gives all numbers.
    """
    m1 = 1.0
    v1 = 10.0
    w1 = 6.0  # after the collision
    m2 = 2.0
    v2 = 5.0
    impulse = m1 * (v1 - w1)
    reduced_mass = rigid.reduced_mass(m1, m2)
    e = float(impulse / (reduced_mass * (v1 - v2)) - 1)  # P = (1 + e) mu v_rel
    after = rigid.collide(m1, v1, m2, v2, e)
    momentum_a = m1 * after.velocity_1
    momentum_b = m2 * after.velocity_2
    total_momentum = (m1 + m2) * after.centre_of_mass_velocity
    w2 = momentum_b / m2
    measured_e = rigid.restitution_from_velocities(v1, v2, w1, w2)
    answers = {  # quantity: expected, computed
        "a: momentum of A before, kg m/s": (10.0, momentum_a + after.impulse),
        "b: momentum of B before, kg m/s": (10.0, momentum_b - after.impulse),
        "c: momentum of both before, kg m/s": (20.0, total_momentum),
        "d: momentum of A after, kg m/s": (6.0, momentum_a),
        "e: momentum of both after, kg m/s": (20.0, momentum_a + momentum_b),
        "f: momentum of B after, kg m/s": (14.0, momentum_b),
        "g: impulse of A on B, N s": (4.0, after.impulse),
        "h: impulse of B on A, N s": (-4.0, -after.impulse),
        "i: kinetic energy before, J": (75.0, after.energy_before),
        "j: kinetic energy after, J": (67.0, after.energy_after),
        "k: e": (0.2, measured_e),
    }
    case = Case("1 kg on 2 kg, one velocity after known", "textbook, problem 10.5.1")
    for quantity, numbers in answers.items():
        expected, computed = numbers
        round_off = 4e-15 * max(1.0, abs(expected))
        yield case.row(quantity, expected, computed, round_off)


def two_heights() -> Rows:
    """10.5.2, e and second bounce: a ball dropped from 10 m rises to 6.4 m.

    The height of the second bounce follows from two collisions with the ground.
    """
    e = rigid.restitution_from_heights(drop=10.0, rebound=6.4)
    bounces = follow_bounces(
        h=np.array(10.0), e=np.array(e), g=np.array(GRAVITY), bounces=2
    )
    height = bounces.last_height
    case = Case("ball dropped from 10 m", "textbook, problem 10.5.2")
    yield case.row("e", 0.8, e, 1e-15, detail="sqrt 0.64")
    yield case.row(
        "height of the second bounce, m",
        4.096,
        float(height),
        1e-14,
        detail="6.4^2/10",
    )


def embedded_bullet() -> Rows:
    """10.5.3: a bullet of 20 g at 500 m/s stays in a block of 50 kg.

    The common velocity by hand gives e; with this e, a collision gives the velocity of
    the block back.
    """
    bullet_mass = Fraction(2, 100)
    common = bullet_mass * 500 / (50 + bullet_mass)
    common_velocity = float(common)
    e = rigid.restitution_from_velocities(
        v1_before=500.0,
        v2_before=0.0,
        v1_after=common_velocity,
        v2_after=common_velocity,
    )
    after = rigid.collide(m1=0.02, v1=500.0, m2=50.0, v2=0.0, restitution=e)
    velocity_2 = after.velocity_2
    quantity = f"velocity of the block after, {common_velocity:.6f} m/s"
    case = Case("bullet that stays in a block", "textbook, problem 10.5.3")
    yield case.row("e", 0.0, e, 0.0, detail="one velocity after")
    yield case.row(quantity, common, velocity_2, 1e-16, detail="10/50.02")


def one_bounce() -> Rows:
    """10.5.4, largest error of the height of a bounce: e^2 h at any gravity.

    The error is relative, over heights, gravities and restitutions. The height follows
    from the velocity after the collision with the ground.
    """
    heights = [0.1, 1.0, 30.0]  # m
    gravities = [1.6, 9.81, 25.0]  # m/s^2
    restitutions = np.linspace(0.05, 0.95, 19)
    h, e, g = np.meshgrid(heights, restitutions, gravities)
    impact_velocity = -np.sqrt(2 * g * h)
    speed = rigid.collide(math.inf, 0.0, BALL_MASS, impact_velocity, e).velocity_2
    height = e**2 * h
    by_energy = relative_difference(speed**2 / (2 * g), height)
    case = Case("ball after one bounce", "textbook, problem 10.5.4: e^2 h")
    yield case.row(
        "height by energy from the velocity after, largest relative difference",
        0.0,
        by_energy,
        1e-14,
    )


def matrix_form() -> Rows:
    """10.5.5: two linear equations, 2 kg at 2.6 m/s on 0.5 kg at rest, e = 0.8.

    m1 w1 + m2 w2 = m1 v1 + m2 v2  and  w1 - w2 = -e (v1 - v2). The velocities w of
    `rigid.collide` are those by hand, and those by elimination from the equations.
    """
    m1 = 2.0
    v1 = 2.6
    m2 = 0.5
    v2 = 0.0
    e = 0.8
    matrix = np.array([[m1, m2], [1.0, -1.0]])
    momentum = m1 * v1 + m2 * v2
    separation = -e * (v1 - v2)
    right_side = [momentum, separation]
    after = rigid.collide(m1, v1, m2, v2, e)
    velocities = [after.velocity_1, after.velocity_2]
    differences = np.subtract(velocities, np.linalg.solve(matrix, right_side))
    case = Case("two linear equations", "textbook, problem 10.5.5")
    yield case.row("velocity of A, m/s", 1.664, after.velocity_1, 1e-15)
    yield case.row("velocity of B, m/s", 3.744, after.velocity_2, 1e-15)
    yield case.zero(
        "velocities by elimination, largest difference",
        differences,
        1e-15,
        detail="[2 0.5; 1 -1] w = [5.2; -2.08]",
    )


def impulse_and_velocities() -> Rows:
    """10.5.6, impulse and velocities after: 7 kg at 6 m/s on 9 kg at 2 m/s, e = 1/2."""
    m1 = 7.0
    v1 = 6.0
    m2 = 9.0
    v2 = 2.0
    after = rigid.collide(m1, v1, m2, v2, restitution=0.5)
    impulse = Fraction(189, 8)
    velocity_a = Fraction(21, 8)
    velocity_b = Fraction(37, 8)
    velocity_1 = after.velocity_1
    velocity_2 = after.velocity_2
    case = Case("7 kg on 9 kg", "textbook, problem 10.5.6")
    yield case.row("impulse of A on B, 23.625 N s", impulse, after.impulse, 1e-14)
    yield case.row("velocity of A after, 2.625 m/s", velocity_a, velocity_1, 1e-15)
    yield case.row("velocity of B after, 4.625 m/s", velocity_b, velocity_2, 1e-15)


def energy_lost() -> Rows:
    """10.5.7, energy lost: 2 kg at 5 m/s on 5 kg at 1 m/s, e = 1/2.

    It is compared with the value by hand, as `energy_lost` and as a difference.
    """
    m1 = 2.0
    v1 = 5.0
    m2 = 5.0
    v2 = 1.0
    after = rigid.collide(m1, v1, m2, v2, restitution=0.5)
    expected = Fraction(60, 7)
    lost = after.energy_before - after.energy_after
    case = Case("2 kg on 5 kg", "textbook, problem 10.5.7")
    yield case.row("energy lost, 8.571429 J", expected, after.energy_lost, 1e-14)
    yield case.row("kinetic energy before - after, J", expected, lost, 1e-14)


class Bounces(NamedTuple):
    """What a dropped ball has done when it meets the ground after its last bounce."""

    time: np.ndarray  # s
    path: np.ndarray  # m
    last_height: np.ndarray  # height to which the last bounce rises, m
    failed_rises: int  # bounces after which a ball no longer rises


def follow_bounces(
    h: np.ndarray, e: np.ndarray, g: np.ndarray, bounces: int
) -> Bounces:
    """A ball dropped from the height h, collision by collision.

    From one bounce to the next it rises for rising/g and falls for as long. The result
    has the time and the path until it meets the ground after the last bounce, the
    height of the last rise, and the number of rises without any height.
    """
    falling = np.sqrt(2 * g * h)  # speed at the ground
    time = falling / g
    path = h.copy()
    failed_rises = 0
    for _ in range(bounces):
        rising = rigid.collide(math.inf, 0.0, BALL_MASS, -falling, e).velocity_2
        height = rising**2 / (2 * g)
        failed_rises += int(np.sum(height <= 0))
        time = time + 2 * rising / g
        path = path + 2 * height
        falling = rising
    return Bounces(time, path, height, failed_rises)


def bounces_without_end() -> Rows:
    """10.5.8: number, time and path of all bounces of a dropped ball.

    Each ball of a grid is followed through 400 bounces. What then is left of its time
    and path, at most e^400 < 1e-18 of them, is below round-off.
    """
    restitutions = [0.5, 0.6, 0.7, 0.8, 0.9]
    drop_heights = [0.1, 2.0, 30.0]  # m
    gravities = [1.6, 9.81]  # m/s^2
    h, e, g = np.meshgrid(drop_heights, restitutions, gravities)
    one_by_one = follow_bounces(h, e, g, BOUNCES)
    expected_height = e ** (2 * BOUNCES) * h
    height_error = relative_difference(one_by_one.last_height, expected_height)
    fall_time = np.sqrt(2 * h / g)
    total_time = fall_time * (1 + e) / (1 - e)
    time_error = relative_difference(one_by_one.time, total_time)
    total_path = h * (1 + e**2) / (1 - e**2)
    path_error = relative_difference(one_by_one.path, total_path)
    case = Case("ball that bounces to rest", "textbook, problem 10.5.8")
    yield case.row(
        f"bounces of the first {BOUNCES} after which the ball no longer rises",
        0.0,
        float(one_by_one.failed_rises),
        0.0,
        detail="it never stops bouncing",
    )
    yield case.row(
        f"height after bounce n = {BOUNCES}, relative difference",
        0.0,
        height_error,
        1e-14,
        detail="e^(2 n) h, small but not 0",
    )
    yield case.row(
        f"time of {BOUNCES} bounces one by one, relative difference",
        0.0,
        time_error,
        1e-14,
        detail="until rest sqrt(2 h/g) (1 + e)/(1 - e)",
    )
    yield case.row(
        f"path of {BOUNCES} bounces one by one, relative difference",
        0.0,
        path_error,
        1e-14,
        detail="until rest h (1 + e^2)/(1 - e^2)",
    )


class Shot(NamedTuple):
    """A bullet through block A that stays in block B; speeds m/s, energies J."""

    initial_speed: Any
    speed_between: Any
    lost_in_a: Any
    lost_in_b: Any


def shot(m: Any, m_a: Any, m_b: Any, v_a: Any, v_b: Any) -> Shot:
    """What the bullet did, from the speeds v_a and v_b of the blocks afterwards.

    The momentum is balanced at B first, then at A. Each block takes the energy of its
    impulse, m_a v_a or m_b v_b, times the mean of the relative velocities before and
    after.
    """
    between = v_b + m_b * v_b / m
    initial = between + m_a * v_a / m
    lost_in_a = m_a * v_a * (initial + (between - v_a)) / 2
    lost_in_b = m_b * v_b * between / 2
    return Shot(initial, between, lost_in_a, lost_in_b)


def bullet_through_block() -> Rows:
    """10.5.9, speeds and losses: a bullet of 20 g through 1 kg into 2 kg.

    A leaves at 4 m/s, B at 3 m/s with the bullet in it. `shot` is compared with values
    by hand.
    """
    bullet = shot(m=0.02, m_a=1.0, m_b=2.0, v_a=4.0, v_b=3.0)
    answers = {  # quantity: expected, computed
        "initial speed, m/s": (503.0, bullet.initial_speed),
        "speed between A and B, m/s": (303.0, bullet.speed_between),
        "energy lost in A, J": (1604.0, bullet.lost_in_a),
        "energy lost in B, J": (909.0, bullet.lost_in_b),
    }
    name = "bullet of 20 g through 1 kg at 4 m/s into 2 kg at 3 m/s"
    case = Case(name, "textbook, problem 10.5.9")
    for quantity, numbers in answers.items():
        expected, computed = numbers
        yield case.row(quantity, expected, computed, 1e-15 * expected)


def random_bullets() -> Rows:
    """10.5.9 as formulas, errors of speeds and losses of random bullets.

    They go through A and stay in B. The masses are m of the bullet, m_a and m_b of the
    blocks; v_a and v_b are the speeds of the blocks afterwards.
    """
    rng = default_rng(9)
    logarithms = rng.uniform(-2, 0, (4, DRAWS))
    m, m_a, m_b, v_a = 10.0**logarithms
    v_b = v_a + rng.uniform(0, 1, DRAWS)  # so that the bullet leaves A faster than A
    between = (m + m_b) * v_b / m
    initial = (m_a * v_a + (m + m_b) * v_b) / m
    lost_a = (m * initial**2 - m * between**2 - m_a * v_a**2) / 2
    lost_b = (m * between**2 - (m + m_b) * v_b**2) / 2
    energy = m * initial**2 / 2

    bullet = shot(m, m_a, m_b, v_a, v_b)
    initial_error = relative_difference(bullet.initial_speed, initial)
    between_error = relative_difference(bullet.speed_between, between)
    error_a = (bullet.lost_in_a - lost_a) / energy
    error_b = (bullet.lost_in_b - lost_b) / energy
    lost = bullet.lost_in_a + bullet.lost_in_b

    # shot forwards: in A with e < 0, as the bullet goes through, and in B with e = 0
    e_of_a = (v_a - between) / initial
    through = rigid.collide(m, initial, m_a, v2=0.0, restitution=e_of_a)
    stuck = rigid.collide(m, through.velocity_1, m_b, v2=0.0, restitution=0.0)
    forwards_error = relative_difference(stuck.velocity_2, v_b)
    lost_forwards = through.energy_lost + stuck.energy_lost
    loss_error = relative_difference(lost_forwards, lost)

    name = f"bullets through A into B, {DRAWS} random"
    case = Case(name, "textbook, problem 10.5.9")
    yield case.row(
        "initial speed, largest relative difference",
        0.0,
        initial_error,
        4e-15,
        detail="(m_A v_A + (m + m_B) v_B)/m",
    )
    yield case.row(
        "speed between, largest relative difference",
        0.0,
        between_error,
        4e-15,
        detail="(m + m_B) v_B/m",
    )
    by_energy = "kinetic energies before - after"
    yield case.zero(
        "energy lost in A, largest difference over the bullet's energy",
        error_a,
        1e-14,
        detail=by_energy,
    )
    yield case.zero(
        "energy lost in B, largest difference over the bullet's energy",
        error_b,
        1e-14,
        detail=by_energy,
    )
    yield case.row(
        "velocity of B, shot forwards by two collisions, largest relative difference",
        0.0,
        forwards_error,
        1e-13,
    )
    yield case.row(
        "loss in A and B of the two collisions, largest relative difference",
        0.0,
        loss_error,
        1e-14,
    )


def rise(ratio: np.ndarray, e_b: np.ndarray, e_r: np.ndarray) -> np.ndarray:
    """Height to which a rubber ball on a basketball of mass 1 rises, dropped from 1.

    `ratio` is the mass of the rubber ball; e_b is the restitution at the ground, e_r
    that between the balls.
    """
    one = np.ones_like(ratio)
    masses = np.stack([one, ratio], axis=-1)
    restitutions = np.stack([e_b, e_r], axis=-1)
    drop = rigid.stack_drop(masses, restitutions, height=1.0)
    return np.asarray(drop.top_height)


def largest_fall(heights: np.ndarray, axis: int) -> float:
    """Largest decrease of a height along an axis, from one value to the next; or 0."""
    growth = np.diff(heights, axis=axis)
    return max(0.0, -float(growth.min()))


def ball_on_ball() -> Rows:
    """10.5.10: a rubber ball falls behind a basketball, from a height of 1.

    On a grid of mass ratios and both restitutions its height is that of the formula; it
    grows with lighter rubber balls and larger restitutions, up to 9 in the limit.
    """
    restitutions = np.linspace(0, 1, 21)
    ratios = np.logspace(3, -9, 49)  # m_r/m_b, of ever lighter rubber balls
    ratio, e_b, e_r = np.meshgrid(ratios, restitutions, restitutions, indexing="ij")
    heights = rise(ratio, e_b, e_r)
    velocity = (e_b + e_r + e_b * e_r - ratio) / (1 + ratio)
    speed = np.maximum(velocity, 0.0)
    height_error = heights - speed**2
    largest_height = heights.max()
    by_mass = largest_fall(heights, axis=0)
    by_e_b = largest_fall(heights, axis=1)
    by_e_r = largest_fall(heights, axis=2)
    small = np.array([1e-5])
    one = np.ones(1)
    height = rise(ratio=small, e_b=one, e_r=one)
    slope = (9.0 - height) / small
    growing = "each step helps"
    case = Case("rubber ball on a basketball", "textbook, problem 10.5.10")
    yield case.zero(
        "height over that of the drop, largest difference on a grid",
        height_error,
        1e-14,
        detail="((m_b (e_b + e_r + e_b e_r) - m_r)/(m_b + m_r))^2",
    )
    yield case.row(
        "height lost by a lighter rubber ball, largest on the grid",
        0.0,
        by_mass,
        4e-15,
        detail=growing,
    )
    yield case.row(
        "height lost by a larger e_b, largest on the grid",
        0.0,
        by_e_b,
        0.0,
        detail=growing,
    )
    yield case.row(
        "height lost by a larger e_r, largest on the grid",
        0.0,
        by_e_r,
        0.0,
        detail=growing,
    )
    yield case.row(
        "largest height on the grid, at m_r/m_b = 1e-9 and e_b = e_r = 1",
        9.0,
        largest_height,
        3e-8,
        detail="9 h in the limit m_r/m_b = 0",
    )
    yield case.row(
        "what 1e-5 of mass takes off 9 h, over that mass",
        24.0,
        slope[0],
        1e-3,
        source="slope of the formula: 24",
    )


def approaching(rng: Generator) -> tuple[np.ndarray, ...]:
    """m1, v1, m2, v2 of random bodies that approach each other, v1 > v2; [draw] each.

    Masses lie between 0.1 and 10.
    """
    logarithms = rng.uniform(-1, 1, (2, DRAWS))
    m1, m2 = 10.0**logarithms
    velocities = rng.normal(0, 10, (2, DRAWS))
    v2, v1 = np.sort(velocities, axis=0)
    return m1, v1, m2, v2


def no_energy_from_nothing() -> Rows:
    """10.5.11, random collisions with a wrong change of energy: none.

    Energy is gained outside -1 <= e <= 1, and only there.
    """
    rng = default_rng(11)
    m1, v1, m2, v2 = approaching(rng)
    signs = rng.choice([-1, 1], DRAWS)
    outside = signs * rng.uniform(1.01, 3.0, DRAWS)
    gained = rigid.collide(m1, v1, m2, v2, outside, allow_energy_release=True)
    inside = rng.uniform(-1, 1, DRAWS)
    lost = rigid.collide(m1, v1, m2, v2, inside)
    at_limit = rng.choice([-1.0, 1.0], DRAWS)
    conserved = rigid.collide(m1, v1, m2, v2, at_limit)

    without_gain = np.sum(gained.energy_after <= gained.energy_before)
    round_off_limit = lost.energy_before * (1 + 1e-15)
    with_gain = np.sum(lost.energy_after > round_off_limit)
    difference = relative_difference(conserved.energy_after, conserved.energy_before)
    name = f"energy gained, {DRAWS} random collisions"
    case = Case(name, "textbook, problem 10.5.11")
    yield case.row(
        "with abs(e) > 1.01 and no more energy after",
        0.0,
        without_gain,
        0.0,
        detail="none",
    )
    yield case.row(
        "with abs(e) < 1 and more energy after, beyond round-off",
        0.0,
        with_gain,
        0.0,
        detail="none",
    )
    yield case.row(
        "with e = 1 or e = -1, energy after, largest relative difference",
        0.0,
        difference,
        2e-15,
        detail="the same",
    )


def largest_loss() -> Rows:
    """10.5.12, energy lost in random collisions at 41 values of e: 0 loses most.

    The e of the largest loss and the loss itself, (1 - e^2) mu v_rel^2/2, are compared.
    """
    rng = default_rng(12)
    m1, v1, m2, v2 = approaching(rng)
    restitutions = np.linspace(-1, 1, 41)
    e = restitutions[:, np.newaxis]
    after = rigid.collide(m1, v1, m2, v2, e)
    lost = np.subtract(after.energy_before, after.energy_after)
    closing = v1 - v2
    expected = (1 - e**2) * m1 * m2 / (m1 + m2) * closing**2 / 2
    e_of_largest_loss = e[lost.argmax(axis=0), 0]
    loss_error = (lost - expected) / after.energy_before
    name = f"energy lost, {DRAWS} random collisions"
    case = Case(name, "textbook, problem 10.5.12")
    yield case.zero(
        "e of the greatest loss, of 41 from -1 to 1, largest abs(e)",
        e_of_largest_loss,
        0.0,
        detail="e = 0",
    )
    yield case.zero(
        "energy before - after, largest difference over the energy before",
        loss_error,
        4e-15,
        detail="(1 - e^2) mu (v1 - v2)^2/2",
    )
