"""The twelve problems of the textbook's section on collisions in one dimension.

Where the problem gives numbers, the expected ones are worked out by hand, as fractions. Where it
asks for a formula, the formula is compared with rodimpact over a grid or over random draws, and the
row gives the largest deviation. Bounces and bullets are also followed collision by collision, from
`rigid.collide` alone.

Source: textbook section 10.5, "Collisions in 1D", problems 10.5.1 to 10.5.12.
"""

import math
from fractions import Fraction
from typing import Any

import numpy as np

from rodimpact import rigid

from .table import Case, Rows, largest

DRAWS = 10_000


def run() -> Rows:
    """Problems 10.5.1 to 10.5.12."""
    return (
        eleven_questions(),
        two_heights(),
        embedded_bullet(),
        one_bounce(),
        matrix_form(),
        impulse_and_velocities(),
        energy_lost(),
        bounces_without_end(),
        bullet_through_block(),
        ball_on_ball(),
        no_energy_from_nothing(),
        largest_loss(),
    )


def eleven_questions() -> Rows:
    """10.5.1: 1 kg at 10 m/s runs into 2 kg at 5 m/s and goes on at 6 m/s."""
    case = Case("1 kg on 2 kg, one velocity after known", "textbook, problem 10.5.1")
    impulse = 1.0 * (10.0 - 6.0)
    e = float(
        impulse / (rigid.contact_mass(1.0, 2.0) * (10.0 - 5.0)) - 1
    )  # P = (1+e) m_coll v_rel
    after = rigid.collide(1.0, 10.0, 2.0, 5.0, e)
    momenta_after = 1.0 * after.velocity_1, 2.0 * after.velocity_2
    for quantity, expected, got in (
        ("a: momentum of A before, kg m/s", 10.0, momenta_after[0] + after.impulse),
        ("b: momentum of B before, kg m/s", 10.0, momenta_after[1] - after.impulse),
        (
            "c: momentum of both before, kg m/s",
            20.0,
            3.0 * after.centre_of_mass_velocity,
        ),
        ("d: momentum of A after, kg m/s", 6.0, momenta_after[0]),
        ("e: momentum of both after, kg m/s", 20.0, sum(momenta_after)),
        ("f: momentum of B after, kg m/s", 14.0, momenta_after[1]),
        ("g: impulse of A on B, N s", 4.0, after.impulse),
        ("h: impulse of B on A, N s", -4.0, -after.impulse),
        ("i: kinetic energy before, J", 75.0, after.energy_before),
        ("j: kinetic energy after, J", 67.0, after.energy_after),
        (
            "k: e",
            0.2,
            rigid.restitution_from_velocities(10.0, 5.0, 6.0, momenta_after[1] / 2.0),
        ),
    ):
        yield case.row(quantity, expected, got, 4e-15 * max(1.0, abs(expected)))


def two_heights() -> Rows:
    """10.5.2: dropped from 10 m, up to 6.4 m."""
    case = Case("ball dropped from 10 m", "textbook, problem 10.5.2")
    e = rigid.restitution_from_heights(10.0, 6.4)
    yield case.row("e", 0.8, e, 1e-15, ": sqrt 0.64")
    yield case.row(
        "height of the second bounce, m",
        4.096,
        rebounds(10.0, e, 2)[1],
        1e-14,
        ": 6.4^2/10",
    )


def embedded_bullet() -> Rows:
    """10.5.3: 20 g at 500 m/s stay in a block of 50 kg."""
    case = Case("bullet that stays in a block", "textbook, problem 10.5.3")
    common = Fraction(2, 100) * 500 / (50 + Fraction(2, 100))
    e = rigid.restitution_from_velocities(500.0, 0.0, float(common), float(common))
    yield case.row("e", 0.0, e, 0.0, ": one velocity after")
    yield case.row(
        f"velocity of the block after, {float(common):.6f} m/s",
        common,
        rigid.collide(0.02, 500.0, 50.0, 0.0, e).velocity_2,
        1e-16,
        ": 10/50.02",
    )


def one_bounce() -> Rows:
    """10.5.4: height of a bounce, whatever the gravity."""
    case = Case("ball after one bounce", "textbook, problem 10.5.4: e^2 h")
    h, e, g = np.meshgrid(
        [0.1, 1.0, 30.0], np.linspace(0.05, 0.95, 19), [1.6, 9.81, 25.0]
    )
    speed = rigid.collide(math.inf, 0.0, 0.3, -np.sqrt(2 * g * h), e).velocity_2
    yield case.row(
        "height by energy from the velocity after, largest relative difference",
        0.0,
        off(speed**2 / (2 * g), e**2 * h),
        1e-14,
    )
    yield case.row(
        "`rebounds`, largest relative difference",
        0.0,
        off(rebounds(h, e, 1)[..., 0], e**2 * h),
        1e-14,
    )


def matrix_form() -> Rows:
    """10.5.5: two linear equations, 2 kg at 2.6 m/s on 0.5 kg at rest, e = 0.8.

    m1 w1 + m2 w2 = m1 v1 + m2 v2  and  w1 - w2 = -e (v1 - v2).
    """
    case = Case("two linear equations", "textbook, problem 10.5.5")
    (m1, v1, m2, v2), e = (2.0, 2.6, 0.5, 0.0), 0.8
    matrix, right = (
        np.array([[m1, m2], [1.0, -1.0]]),
        [m1 * v1 + m2 * v2, -e * (v1 - v2)],
    )
    yield case.zero(
        "matrix, largest difference",
        matrix - [[2.0, 0.5], [1.0, -1.0]],
        0.0,
        ": [2 0.5; 1 -1]",
    )
    yield case.zero(
        "right-hand side, largest difference",
        np.subtract(right, [5.2, -2.08]),
        1e-15,
        ": [5.2; -2.08]",
    )
    found = np.linalg.solve(matrix, right)
    for body, expected, got in zip("AB", (1.664, 3.744), found, strict=True):
        yield case.row(f"velocity of {body}, m/s", expected, got, 1e-15)


def impulse_and_velocities() -> Rows:
    """10.5.6: 7 kg at 6 m/s on 9 kg at 2 m/s, e = 1/2."""
    case = Case("7 kg on 9 kg", "textbook, problem 10.5.6")
    after = rigid.collide(7.0, 6.0, 9.0, 2.0, 0.5)
    yield case.row(
        "impulse of A on B, 23.625 N s", Fraction(189, 8), after.impulse, 1e-14
    )
    yield case.row(
        "velocity of A after, 2.625 m/s", Fraction(21, 8), after.velocity_1, 1e-15
    )
    yield case.row(
        "velocity of B after, 4.625 m/s", Fraction(37, 8), after.velocity_2, 1e-15
    )


def energy_lost() -> Rows:
    """10.5.7: 2 kg at 5 m/s on 5 kg at 1 m/s, e = 1/2."""
    case = Case("2 kg on 5 kg", "textbook, problem 10.5.7")
    after = rigid.collide(2.0, 5.0, 5.0, 1.0, 0.5)
    yield case.row("energy lost, 8.571429 J", Fraction(60, 7), after.energy_lost, 1e-14)
    yield case.row(
        "kinetic energy before - after, J",
        Fraction(60, 7),
        after.energy_before - after.energy_after,
        1e-14,
    )


def bounces_without_end() -> Rows:
    """10.5.8: number, time and path of all bounces, followed through 400 of them."""
    case = Case("ball that bounces to rest", "textbook, problem 10.5.8")
    h, e, g = np.meshgrid([0.1, 2.0, 30.0], [0.5, 0.6, 0.7, 0.8, 0.9], [1.6, 9.81])
    bounces = 400
    falling = np.sqrt(2 * g * h)
    time, path = falling / g, h.copy()
    for _ in range(bounces):
        rising = rigid.collide(math.inf, 0.0, 0.3, -falling, e).velocity_2
        time, path = time + 2 * rising / g, path + rising**2 / g
        falling = rising
    heights = rebounds(h, e, bounces)
    total_time = np.sqrt(2 * h / g) * (1 + e) / (1 - e)
    total_path = h * (1 + e**2) / (1 - e**2)
    yield case.row(
        f"bounces of the first {bounces} after which the ball no longer rises",
        0.0,
        np.sum(heights <= 0),
        0.0,
        ": it never stops bouncing",
    )
    yield case.row(
        f"height after bounce n = {bounces}, relative difference",
        0.0,
        off(heights[..., -1], e ** (2 * bounces) * h),
        1e-14,
        ": e^(2 n) h, small but not 0",
    )
    yield case.row(
        "time until rest, relative difference",
        0.0,
        off(np.sqrt(2 * h / g) * ((1 + e) / (1 - e)), total_time),
        1e-14,
        ": sqrt(2 h/g) (1 + e)/(1 - e)",
    )
    yield case.row(
        f"time of {bounces} bounces one by one, relative difference",
        0.0,
        off(time, total_time),
        1e-14,
        "the same",
    )
    yield case.row(
        "path until rest, relative difference",
        0.0,
        off(h * ((1 + e * e) / ((1 - e) * (1 + e))), total_path),
        1e-14,
        ": h (1 + e^2)/(1 - e^2)",
    )
    yield case.row(
        f"path of {bounces} bounces one by one, relative difference",
        0.0,
        off(path, total_path),
        1e-14,
        "the same",
    )


def bullet_through_block() -> Rows:
    """10.5.9: a bullet goes through block A and stays in block B."""
    source = "textbook, problem 10.5.9"
    case = Case("bullet of 20 g through 1 kg at 4 m/s into 2 kg at 3 m/s", source)
    for quantity, expected, got in zip(
        (
            "initial speed, m/s",
            "speed between A and B, m/s",
            "energy lost in A, J",
            "energy lost in B, J",
        ),
        (503.0, 303.0, 1604.0, 909.0),
        shot(0.02, 1.0, 2.0, v_a=4.0, v_b=3.0),
        strict=True,
    ):
        yield case.row(quantity, expected, got, 1e-15 * expected)
    rng = np.random.default_rng(9)
    m, m_a, m_b, v_a = 10.0 ** rng.uniform(-2, 0, (4, DRAWS))
    v_b = v_a + rng.uniform(0, 1, DRAWS)  # so the bullet leaves A faster than A moves
    between = (m + m_b) * v_b / m
    initial = (m_a * v_a + (m + m_b) * v_b) / m
    lost_a = (m * initial**2 - m * between**2 - m_a * v_a**2) / 2
    lost_b = (m * between**2 - (m + m_b) * v_b**2) / 2
    came, went_on, in_a, in_b = shot(m, m_a, m_b, v_a, v_b)
    through = rigid.collide(m, initial, m_a, 0.0, (v_a - between) / initial)
    stuck = rigid.collide(m, through.velocity_1, m_b, 0.0, 0.0)
    energy = m * initial**2 / 2
    case = Case(f"bullets through A into B, {DRAWS} random", source)
    yield case.row(
        "initial speed, largest relative difference",
        0.0,
        off(came, initial),
        4e-15,
        ": (m_A v_A + (m + m_B) v_B)/m",
    )
    yield case.row(
        "speed between, largest relative difference",
        0.0,
        off(went_on, between),
        4e-15,
        ": (m + m_B) v_B/m",
    )
    yield case.zero(
        "energy lost in A, largest difference over the bullet's energy",
        (in_a - lost_a) / energy,
        1e-14,
        ": kinetic energies before - after",
    )
    yield case.zero(
        "energy lost in B, largest difference over the bullet's energy",
        (in_b - lost_b) / energy,
        1e-14,
        ": kinetic energies before - after",
    )
    yield case.row(
        "velocity of B, shot forwards by two collisions, largest relative difference",
        0.0,
        off(stuck.velocity_2, v_b),
        1e-13,
    )
    yield case.row(
        "loss in A and B of the two collisions, largest relative difference",
        0.0,
        off(through.energy_lost + stuck.energy_lost, in_a + in_b),
        1e-14,
    )


def shot(m: Any, m_a: Any, m_b: Any, v_a: Any, v_b: Any) -> tuple[Any, ...]:
    """Initial speed of a bullet, speed between the blocks, energies lost in A and in B.

    From the speeds v_a and v_b of the blocks afterwards, by momentum balance at B, then at A.
    """
    between = v_b + m_b * v_b / m
    initial = between + m_a * v_a / m
    return (
        initial,
        between,
        m_a * v_a * (initial + (between - v_a)) / 2,
        m_b * v_b * between / 2,
    )


def rebounds(height: Any, e: Any, bounces: int) -> np.ndarray:
    """Heights of the bounces of a dropped ball, along a last axis: each is e^2 of the last."""
    powers = np.asarray(e)[..., np.newaxis] ** np.arange(bounces)
    return (
        np.asarray(height)[..., np.newaxis]
        * (np.asarray(e)[..., np.newaxis] * powers) ** 2
    )


def ball_on_ball() -> Rows:
    """10.5.10: a rubber ball falls behind a basketball; height in units of the drop."""
    case = Case("rubber ball on a basketball", "textbook, problem 10.5.10")

    def rise(ratio: np.ndarray, e_b: np.ndarray, e_r: np.ndarray) -> np.ndarray:
        masses = np.stack([np.ones_like(ratio), ratio], axis=-1)
        return np.asarray(
            rigid.stack_drop(masses, np.stack([e_b, e_r], axis=-1), 1.0).top_height
        )

    parts = np.linspace(0, 1, 21)
    ratio, e_b, e_r = np.meshgrid(np.logspace(3, -9, 49), parts, parts, indexing="ij")
    heights = rise(ratio, e_b, e_r)
    speed = np.maximum((e_b + e_r + e_b * e_r - ratio) / (1 + ratio), 0.0)
    falls = [max(0.0, -float(np.diff(heights, axis=axis).min())) for axis in range(3)]
    small = np.array([1e-5])
    slope = (9.0 - rise(small, np.ones(1), np.ones(1))) / small
    growing = ": each step helps"
    yield case.zero(
        "height over that of the drop, largest difference on a grid",
        heights - speed**2,
        1e-14,
        ": ((m_b (e_b + e_r + e_b e_r) - m_r)/(m_b + m_r))^2",
    )
    yield case.row(
        "height lost by a lighter rubber ball, largest on the grid",
        0.0,
        falls[0],
        4e-15,
        growing,
    )
    yield case.row(
        "height lost by a larger e_b, largest on the grid", 0.0, falls[1], 0.0, growing
    )
    yield case.row(
        "height lost by a larger e_r, largest on the grid", 0.0, falls[2], 0.0, growing
    )
    yield case.row(
        "largest height on the grid, at m_r/m_b = 1e-9 and e_b = e_r = 1",
        9.0,
        heights.max(),
        3e-8,
        ": 9 h in the limit m_r/m_b = 0",
    )
    yield case.row(
        "what 1e-5 of mass takes off 9 h, over that mass",
        24.0,
        slope[0],
        1e-3,
        "slope of the formula: 24",
    )


def no_energy_from_nothing() -> Rows:
    """10.5.11: energy is gained outside -1 <= e <= 1, and only there."""
    case = Case(
        f"energy gained, {DRAWS} random collisions", "textbook, problem 10.5.11"
    )
    rng = np.random.default_rng(11)
    m1, v1, m2, v2 = approaching(rng)
    beyond = rng.choice([-1, 1], DRAWS) * rng.uniform(1.01, 3.0, DRAWS)
    gained = rigid.collide(m1, v1, m2, v2, beyond, allow_energy_release=True)
    lost = rigid.collide(m1, v1, m2, v2, rng.uniform(-1, 1, DRAWS))
    edge = rigid.collide(m1, v1, m2, v2, rng.choice([-1.0, 1.0], DRAWS))
    yield case.row(
        "with abs(e) > 1.01 and no more energy after",
        0.0,
        np.sum(gained.energy_after <= gained.energy_before),
        0.0,
        ": none",
    )
    yield case.row(
        "with abs(e) < 1 and more energy after, beyond round-off",
        0.0,
        np.sum(lost.energy_after > lost.energy_before * (1 + 1e-15)),
        0.0,
        ": none",
    )
    yield case.row(
        "with e = 1 or e = -1, energy after, largest relative difference",
        0.0,
        off(edge.energy_after, edge.energy_before),
        2e-15,
        ": the same",
    )


def largest_loss() -> Rows:
    """10.5.12: of all e, 0 loses most."""
    case = Case(f"energy lost, {DRAWS} random collisions", "textbook, problem 10.5.12")
    m1, v1, m2, v2 = approaching(np.random.default_rng(12))
    e = np.linspace(-1, 1, 41)[:, np.newaxis]
    after = rigid.collide(m1, v1, m2, v2, e)
    lost = np.subtract(after.energy_before, after.energy_after)
    expected = (1 - e**2) * m1 * m2 / (m1 + m2) * (v1 - v2) ** 2 / 2
    yield case.zero(
        "e of the greatest loss, of 41 from -1 to 1, largest abs(e)",
        e[lost.argmax(axis=0), 0],
        0.0,
        ": e = 0",
    )
    yield case.zero(
        "energy before - after, largest difference over the energy before",
        (lost - expected) / after.energy_before,
        4e-15,
        ": (1 - e^2) m_coll (v1 - v2)^2/2",
    )


def approaching(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Masses within 1 : 100 and velocities of bodies that approach each other."""
    m1, m2 = 10.0 ** rng.uniform(-1, 1, (2, DRAWS))
    v2, v1 = np.sort(rng.normal(0, 10, (2, DRAWS)), axis=0)
    return m1, v1, m2, v2


def off(got: rigid.Number, expected: rigid.Number) -> float:
    """Largest relative difference."""
    return largest(np.asarray(got) / expected - 1)
