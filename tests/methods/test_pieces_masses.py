"""Rows of masses without a rod, by characteristics: cradles, impacts, stacks, oscillators."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from scipy.integrate import solve_ivp

import rodimpact as ri


def balls(n, law, gaps=None, **options):
    row = [ri.RigidMass(1.0, velocity=float(i == 0)) for i in range(n)]
    return ri.System(row, gaps, [law] * (n - 1), **options)


def velocities(system, until=None, **options):
    s = ri.solve(system, until, **options)
    assert s.method == "characteristics"
    return s, np.array(s.outcome.velocities_after)


@pytest.mark.parametrize(
    ("n", "after"),
    [
        (3, [-0.0709524, 0.0764030, 0.9945493]),
        (5, [-0.071085, -0.0302738, -0.0144636, 0.127045, 0.9887774]),
    ],
)
@pytest.mark.parametrize("stiffness", few_of([1.0, 1e8], [1.0]))
def test_cradles_of_balls(n, after, stiffness):
    s, found = velocities(balls(n, ri.Hertz(stiffness)))
    assert s.final
    assert found == pytest.approx(
        np.array(after), abs=1.2e-6 if n == 5 else 1.2e-7
    )  # as printed
    assert found.sum() == pytest.approx(1.0, abs=1e-12)
    assert found @ found == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize(
    "law",
    [
        ri.Spring(3.0),
        ri.Hertz(3.0),
        *(ri.PowerLaw(3.0, n) for n in (1.2, 2.2, 7.5, 20.0)),
    ],
)
@pytest.mark.parametrize("wall", [False, True])
def test_two_bodies_exchange_what_rigid_bodies_do(law, wall):
    """Peak force and duration from the energy: d'^2 = v^2 - 2 k d^(p+1)/((p+1) m)."""
    M, v = (2.0, 1.5) if not wall else (2.0, 2.0)
    row = [ri.RigidMass(M, velocity=v), ri.Wall() if wall else ri.RigidMass(3.0)]
    s, found = velocities(ri.System(row, [0.1], [law]))
    m = M if wall else M * 3 / (M + 3)
    p = getattr(law, "exponent", 1.0)
    k = law.stiffness
    expected = [-v, 0.0] if wall else [(M - 3) / (M + 3) * v, 2 * M / (M + 3) * v]
    depth = ((p + 1) * m * v * v / (2 * k)) ** (1 / (p + 1))
    half = (
        math.sqrt(math.pi) * math.gamma(1 + 1 / (p + 1)) / math.gamma(0.5 + 1 / (p + 1))
    )
    stated = s.accuracy
    assert max(stated.values()) <= 1e-6
    assert found == pytest.approx(np.array(expected), abs=stated["velocity"] * v)
    assert s.outcome.peak_force == pytest.approx(k * depth**p, rel=stated["peak force"])
    assert s.outcome.duration == pytest.approx(
        2 * depth / v * half, rel=stated["duration"]
    )
    assert s.outcome.impulse == pytest.approx(2 * m * v, rel=stated["impulse"])
    assert s.contacts[0].episodes[0].start == pytest.approx(0.1 / v, rel=1e-12)


@pytest.mark.parametrize(
    ("gap", "e", "after"),
    [
        (0.0, 1.0, [-1 / 3, 2 / 3, 2 / 3]),
        (1e-9, 1.0, [0.0, 0.0, 1.0]),
        (1e-9, 0.5, [0.203125, 0.234375, 0.5625]),
    ],
)
def test_rigid_masses_in_contact_strike_together_and_apart_one_by_one(gap, e, after):
    """With e = 0.5 the first ball, at 0.25, meets the second, at 0.1875, again."""
    _, found = velocities(balls(3, ri.Rigid(restitution=e), [gap, gap]), 1e-6)
    assert found == pytest.approx(np.array(after), abs=1e-12)


@pytest.mark.parametrize("unit", [2.0**-60, 1.0, 2.0**60])
def test_blows_do_not_depend_on_the_unit_of_mass(unit):
    """The second body, which cannot leave the third behind, strikes with the mass of both."""
    row = [
        ri.RigidMass(m * unit, velocity=v)
        for m, v in ((1.0, 1.0), (3.0, 0.0), (2.0, 0.0))
    ]
    _, found = velocities(
        ri.System(row, contacts=[ri.Rigid(restitution=0.5)] * 2), 1e-6
    )
    assert found == pytest.approx(np.array([-0.25, 0.25, 0.25]), abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("gap", [0.0, 0.3])
def test_a_blow_of_two_masses(gap, e):
    row = [ri.RigidMass(2.0, velocity=1.0), ri.RigidMass(3.0, velocity=-0.5)]
    s, found = velocities(ri.System(row, [gap], [ri.Rigid(restitution=e)]), 1.0)
    impulse = (1 + e) * 1.2 * 1.5
    assert s.outcome.contacts[0].duration == 0
    assert found == pytest.approx(
        np.array([1 - impulse / 2, -0.5 + impulse / 3]), abs=1e-12
    )
    assert s.outcome.impulse == pytest.approx(impulse, rel=1e-12)
    assert s.contacts[0].episodes[0].start == pytest.approx(gap / 1.5, rel=1e-12)
    assert s.energy(1.0).dissipated == pytest.approx(
        (1 - e * e) * 1.2 * 1.5**2 / 2, abs=1e-12
    )


@pytest.mark.parametrize(
    "law", [ri.Rigid(restitution=0.5), ri.SpringDashpot(1e4, 150.0)]
)
def test_a_stack_comes_to_rest_and_carries_its_weight(law):
    row = [ri.RigidMass(1.0), ri.RigidMass(2.0), ri.RigidMass(3.0), ri.Wall()]
    s = ri.solve(ri.System(row, [0.01, 0.02, 0.03], [law] * 3, gravity=10.0), 3.0)
    assert [float(s.velocity(i, 0.0, 3.0)) for i in range(3)] == pytest.approx(
        [0, 0, 0], abs=1e-6
    )
    forces = [float(c.force(2.99)) for c in s.contacts]
    assert forces == pytest.approx([10.0, 30.0, 60.0], rel=1e-5)
    impulses = [c.impulse for c in s.contacts]
    assert impulses == pytest.approx([30.0, 90.0, 180.0], rel=1e-6)


@pytest.mark.parametrize("ends", [(ri.Free(), ri.Free()), (ri.Pushed(0.7), ri.Free())])
def test_masses_on_joints_swing_as_an_oscillator(ends):
    """Two masses on a spring and dashpot, the first pushed or not."""
    row = [ri.RigidMass(2.0, velocity=1.0), ri.RigidMass(3.0)]
    s = ri.solve(ri.System(row, contacts=[ri.Joint(5.0, 0.4)], ends=ends), 9.0)
    push = getattr(ends[0], "value", 0.0)

    def rate(_, y):
        F = 5 * y[0] + 0.4 * (y[1] - y[2])
        return y[1] - y[2], (push - F) / 2, F / 3

    exact = solve_ivp(
        rate,
        (0, 9),
        [0.0, 1.0, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
        dense_output=True,
    )
    t = np.linspace(0, 9, 50)
    for i in (0, 1):
        assert s.velocity(i, 0.0, t) == pytest.approx(exact.sol(t)[1 + i], abs=1e-7)


@pytest.mark.parametrize("law", [ri.Hertz(431.0), ri.Spring(431.0), ri.Rigid(0.5)])
@pytest.mark.parametrize("gap", [0.0, 1e-4, 1e150])
@pytest.mark.parametrize("other", [ri.Wall(), ri.RigidMass(2.0)])
def test_masses_at_rest_stay(law, gap, other):
    row = ri.System([ri.RigidMass(1.0), other], gaps=[gap], contacts=[law])
    rest = ri.solve(row)
    assert rest.final
    assert rest.outcome.contacts[0].impulse == 0
    assert rest.velocity(0, 0, rest.t_end) == 0


# Long flights ----------------------------------------------------------------------------------


def hertz_time(mass, velocity, stiffness):
    """Contact time of a mass on a Hertz contact: d/v times the integral of 2/sqrt(1 - x^2.5)."""
    depth = (1.25 * mass * velocity**2 / stiffness) ** 0.4
    integral = 0.8 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
    return integral * depth / velocity


@pytest.mark.parametrize("stiffness", [1e6, 1e10])
@pytest.mark.parametrize("gap", [1.0, 1e2, 1e4])
def test_the_stated_error_of_a_contact_after_a_long_flight_bounds_the_true_one(
    gap, stiffness
):
    law = ri.Hertz(stiffness)
    row = ri.System([ri.RigidMass(1.0, velocity=1.0), ri.Wall()], [gap], [law])
    solution = ri.solve(row)
    duration = solution.contacts[0].duration
    right = hertz_time(1.0, 1.0, stiffness)
    assert abs(duration - right) <= solution.accuracy["duration"] * duration


@pytest.mark.parametrize("gap", [1e10, 1e20])
def test_a_contact_too_short_for_the_clock_is_refused(gap):
    row = ri.System(
        [ri.RigidMass(1.0, velocity=1.0), ri.Wall()], [gap], [ri.Hertz(1e10)]
    )
    with pytest.raises(ri.InvalidModel, match=r"it lasts about 0\.0003 s, too short"):
        ri.solve(row)
