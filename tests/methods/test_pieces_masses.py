"""Rows of masses without a rod, by characteristics: cradles, impacts, stacks,
oscillators.
"""

import math

import numpy as np
import pytest
from exhaustive import few_of
from scipy.integrate import solve_ivp

import rodimpact as ri


def balls(n, law, gaps=None):
    """A system of n masses of 1 kg, of which the first moves at 1 m/s, with this law at
    each contact; not solved.
    """
    striker = ri.RigidMass(1.0, velocity=1.0)
    resting = ri.RigidMass(1.0)
    n_struck = n - 1  # also the number of contacts
    masses = [striker] + [resting] * n_struck
    return ri.System(masses, gaps=gaps, contacts=[law] * n_struck)


def solve_by_characteristics(system, until=None):
    """The solution, by the method chosen for masses, and the velocities after."""
    solution = ri.solve(system, until=until)
    assert solution.method == "characteristics"
    velocities = np.array(solution.outcome.velocities_after)
    return solution, velocities


CRADLES = [  # velocities after as they are printed, and half of the last digit
    (3, [-0.0709524, 0.0764030, 0.9945493], 1.2e-7),
    (5, [-0.071085, -0.0302738, -0.0144636, 0.127045, 0.9887774], 1.2e-6),
]


@pytest.mark.parametrize(("n", "after", "rounding"), CRADLES)
@pytest.mark.parametrize("stiffness", few_of([1.0, 1e8], [1.0]))
def test_balls_of_a_cradle_have_their_published_velocities(
    n, after, rounding, stiffness
):
    """Velocities after are the printed ones, at any stiffness; momentum and energy are
    those of the first ball, of 1 kg at 1 m/s.
    """
    cradle = balls(n, ri.Hertz(stiffness))

    solution, velocities = solve_by_characteristics(cradle)

    assert solution.final
    assert velocities == pytest.approx(after, abs=rounding)
    momentum = velocities.sum()
    assert momentum == pytest.approx(1.0, abs=1e-12)
    twice_energy = velocities @ velocities
    assert twice_energy == pytest.approx(1.0, abs=1e-7)


def duration_and_peak_force(mass, velocity, law):
    """Contact time and largest force of a mass on a wall: the compression d obeys
    d'^2 = v^2 - 2 k d^(p+1)/((p+1) m), p the exponent of the law.
    """
    p = getattr(law, "exponent", 1.0)  # that of a spring is 1
    k = law.stiffness
    q = 1 / (p + 1)
    squared_depth = (p + 1) * mass * velocity**2 / (2 * k)  # for a spring, p = 1
    depth = squared_depth**q  # where d' = 0
    # Integral of 1/sqrt(1 - x^(p+1)) from 0 to 1, there and back
    ratio = math.gamma(1 + q) / math.gamma(0.5 + q)
    integral = math.sqrt(math.pi) * ratio
    duration = 2 * depth / velocity * integral
    peak_force = k * depth**p
    return duration, peak_force


@pytest.mark.parametrize(
    "law",
    [
        ri.Spring(3.0),
        ri.Hertz(3.0),
        ri.PowerLaw(3.0, exponent=1.2),
        ri.PowerLaw(3.0, exponent=2.2),
        ri.PowerLaw(3.0, exponent=7.5),
        ri.PowerLaw(3.0, exponent=20.0),
    ],
    ids=repr,
)
@pytest.mark.parametrize(
    ("velocity", "other", "reduced_mass", "after"),
    [
        # 2*3/(2 + 3) kg; (2 - 3)/(2 + 3) and 2*2/(2 + 3) of 1.5 m/s
        pytest.param(1.5, ri.RigidMass(3.0), 1.2, [-0.3, 1.2], id="mass"),
        pytest.param(2.0, ri.Wall(), 2.0, [-2.0, 0.0], id="wall"),
    ],
)
def test_two_bodies_collide_as_closed_forms_say_to_the_stated_errors(
    law, velocity, other, reduced_mass, after
):
    """A mass of 2 kg strikes another body over a gap: velocities are those of rigid
    bodies, force and duration those of `duration_and_peak_force`, each to the stated
    error, and the contact begins when the gap is crossed.
    """
    striker = ri.RigidMass(2.0, velocity=velocity)
    system = ri.System([striker, other], gaps=[0.1], contacts=[law])
    duration, peak_force = duration_and_peak_force(reduced_mass, velocity, law)

    solution, velocities = solve_by_characteristics(system)

    stated = solution.accuracy
    outcome = solution.outcome
    assert max(stated.values()) <= 1e-6
    bound = stated["velocity"] * velocity
    assert velocities == pytest.approx(after, abs=bound)
    force_error = stated["peak force"]
    assert outcome.peak_force == pytest.approx(peak_force, rel=force_error)
    duration_error = stated["duration"]
    assert outcome.duration == pytest.approx(duration, rel=duration_error)
    # All laws are elastic: the closing velocity is reversed.
    impulse = 2 * reduced_mass * velocity
    impulse_error = stated["impulse"]
    assert outcome.impulse == pytest.approx(impulse, rel=impulse_error)
    (episode,) = solution.contacts[0].episodes
    flight = 0.1 / velocity  # over the gap
    assert episode.start == pytest.approx(flight, rel=1e-12)


@pytest.mark.parametrize(
    ("gap", "e", "after"),
    [
        (0.0, 1.0, [-1 / 3, 2 / 3, 2 / 3]),
        (1e-9, 1.0, [0.0, 0.0, 1.0]),
        (1e-9, 0.5, [0.203125, 0.234375, 0.5625]),
    ],
)
def test_rigid_balls_in_contact_strike_together_and_apart_one_by_one(gap, e, after):
    """Three equal balls without gaps are struck as one; with gaps each struck ball
    takes (1 + e)/2 of the closing velocity.

    With e = 0.5 it takes 0.75, and passes 0.5625 on; the first ball, at 0.25 m/s, then
    meets the second, at 0.1875 m/s, again.
    """
    law = ri.Rigid(restitution=e)
    system = balls(3, law, gaps=[gap, gap])
    _, velocities = solve_by_characteristics(system, until=1e-6)

    assert velocities == pytest.approx(after, abs=1e-12)


@pytest.mark.parametrize("unit", [2.0**-60, 1.0, 2.0**60])
def test_blows_do_not_depend_on_the_unit_of_mass(unit):
    """The second body touches the third and cannot pass it, so both are struck as one.

    A mass of 1 at 1 m/s strikes one of 5, which is 3 + 2, with e = 0.5.
    """
    striker = ri.RigidMass(1.0 * unit, velocity=1.0)
    second = ri.RigidMass(3.0 * unit)
    third = ri.RigidMass(2.0 * unit)
    law = ri.Rigid(restitution=0.5)
    system = ri.System([striker, second, third], contacts=[law, law])
    after_striker = (1 - 0.5 * 5) / 6
    after_struck = (1 + 0.5) / 6  # of the second and the third
    after = [after_striker, after_struck, after_struck]

    _, velocities = solve_by_characteristics(system, until=1e-6)

    assert velocities == pytest.approx(after, abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("gap", [0.0, 0.3])
def test_a_blow_of_two_rigid_masses_takes_no_time_and_its_share_of_the_energy(gap, e):
    """Velocities, impulse and lost energy are those of the reduced mass; the contact
    begins after the flight over the gap and lasts for 0 s.
    """
    first = ri.RigidMass(2.0, velocity=1.0)
    second = ri.RigidMass(3.0, velocity=-0.5)
    law = ri.Rigid(restitution=e)
    system = ri.System([first, second], gaps=[gap], contacts=[law])
    reduced_mass = 2 * 3 / (2 + 3)
    closing = 1.0 + 0.5
    impulse = (1 + e) * reduced_mass * closing
    after_first = 1 - impulse / 2
    after_second = -0.5 + impulse / 3
    relative_energy = reduced_mass * closing**2 / 2
    lost = (1 - e**2) * relative_energy

    solution, velocities = solve_by_characteristics(system, until=1.0)

    assert velocities == pytest.approx([after_first, after_second], abs=1e-12)
    outcome = solution.outcome
    assert outcome.duration == 0
    assert outcome.impulse == pytest.approx(impulse, rel=1e-12)
    (episode,) = solution.contacts[0].episodes
    flight = gap / closing  # s
    assert episode.start == pytest.approx(flight, rel=1e-12)
    energy = solution.energy(1.0)
    assert energy.dissipated == pytest.approx(lost, abs=1e-12)


@pytest.mark.parametrize(
    "law", [ri.Rigid(restitution=0.5), ri.SpringDashpot(1e4, damping=150.0)]
)
def test_a_stack_comes_to_rest_and_carries_its_weight(law):
    """Three masses fall on a floor. In the end they are at rest, and each contact has
    the force and the impulse of the weight above it.
    """
    masses = [ri.RigidMass(1.0), ri.RigidMass(2.0), ri.RigidMass(3.0)]
    floor = ri.Wall()
    system = ri.System(
        [*masses, floor], gaps=[0.01, 0.02, 0.03], contacts=[law] * 3, gravity=10.0
    )

    solution = ri.solve(system, until=3.0)

    masses_above = np.array([1.0, 1.0 + 2.0, 1.0 + 2.0 + 3.0])  # of each contact
    weights = 10.0 * masses_above
    for i in range(3):
        velocity = float(solution.velocity(i, 0.0, 3.0))
        assert velocity == pytest.approx(0, abs=1e-6)
    forces = [float(contact.force(2.99)) for contact in solution.contacts]
    assert forces == pytest.approx(weights, rel=1e-5)
    # All began at rest and is at rest again, so impulses are those of the weights.
    impulses = [contact.impulse for contact in solution.contacts]
    assert impulses == pytest.approx(weights * 3.0, rel=1e-6)


@pytest.mark.parametrize(
    ("end", "push"), [(ri.Free(), 0.0), (ri.Pushed(0.7), 0.7)], ids=["free", "pushed"]
)
def test_masses_on_joints_swing_as_an_oscillator(end, push):
    """Two masses are joined by a spring and dashpot, and the first is pushed or free.
    Their velocities over 9 s are those of the integrated equations of motion.
    """
    first = ri.RigidMass(2.0, velocity=1.0)
    second = ri.RigidMass(3.0)
    joint = ri.Joint(5.0, damping=0.4)

    def rates(_, state):
        """Time derivatives of the compression of the joint and of both velocities."""
        compression, v0, v1 = state
        closing = v0 - v1
        force = 5 * compression + 0.4 * closing
        first_acceleration = (push - force) / 2
        return closing, first_acceleration, force / 3

    times = np.linspace(0, 9, 50)
    start = [0.0, 1.0, 0.0]
    exact = solve_ivp(
        rates,
        (0, 9),
        start,
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
        t_eval=times,
    )
    _, v0, v1 = exact.y
    ends = (end, ri.Free())
    system = ri.System([first, second], contacts=[joint], ends=ends)

    solution = ri.solve(system, until=9.0)

    first_velocity = solution.velocity(0, 0.0, times)
    second_velocity = solution.velocity(1, 0.0, times)
    assert first_velocity == pytest.approx(v0, abs=1e-7)
    assert second_velocity == pytest.approx(v1, abs=1e-7)


@pytest.mark.parametrize("law", [ri.Hertz(431.0), ri.Spring(431.0), ri.Rigid(0.5)])
@pytest.mark.parametrize("gap", few_of([0.0, 1e-4, 1e150], [1e-4]))
@pytest.mark.parametrize("other", [ri.Wall(), ri.RigidMass(2.0)])
def test_masses_at_rest_stay_at_rest_at_any_gap(law, gap, other):
    """A mass at rest beside a wall or another mass: the run is final, without impulse
    or velocity.
    """
    mass = ri.RigidMass(1.0)
    system = ri.System([mass, other], gaps=[gap], contacts=[law])

    solution = ri.solve(system)

    assert solution.final
    assert solution.outcome.impulse == 0
    velocity_at_end = solution.velocity(0, 0, solution.t_end)
    assert velocity_at_end == 0


# Long flights
# --------------------------------------------------------------------------------------


STRIKER = ri.RigidMass(1.0, velocity=1.0)


@pytest.mark.parametrize("stiffness", [1e6, 1e10])
@pytest.mark.parametrize("gap", [1.0, 1e2, 1e4])
def test_the_stated_error_of_a_duration_after_a_long_flight_bounds_the_true_one(
    gap, stiffness
):
    """A mass flies over the gap, m, to a wall; the true duration is that of
    `duration_and_peak_force`.
    """
    law = ri.Hertz(stiffness)
    system = ri.System([STRIKER, ri.Wall()], gaps=[gap], contacts=[law])
    exact, _ = duration_and_peak_force(mass=1.0, velocity=1.0, law=law)

    solution = ri.solve(system)

    (contact,) = solution.contacts
    relative_error = solution.accuracy["duration"]
    error = abs(contact.duration - exact)
    assert error <= relative_error * contact.duration


@pytest.mark.parametrize("gap", [1e10, 1e20])
def test_a_contact_too_short_for_the_clock_is_refused(gap):
    """A contact that is short beside the flight over the gap, which the same clock
    counts, is refused with its duration.
    """
    law = ri.Hertz(1e10)
    system = ri.System([STRIKER, ri.Wall()], gaps=[gap], contacts=[law])
    with pytest.raises(ri.InvalidModel, match=r"it lasts about 0\.0003 s, too short"):
        ri.solve(system)


def test_a_run_to_the_end_of_the_clock_says_so_and_its_advice_helps():
    """A mass that bounces between two walls for ever is never proved final: the run
    ends with its clock, long before the cap on events. A given end may be later.
    """
    bounce = ri.Rigid(restitution=1.0)
    bodies = [ri.Wall(), STRIKER, ri.Wall()]
    system = ri.System(bodies, gaps=[0.1, 0.1], contacts=[bounce, bounce])

    solution = ri.solve(system)
    later = ri.solve(system, until=1.5 * solution.t_end)

    assert not solution.final
    assert solution.status.startswith("Stopped at the end of the clock, 409.6 s, ")
    assert "Give until= to set another end." in solution.status
    assert "cap" not in solution.status
    assert later.t_end == 1.5 * solution.t_end


@pytest.mark.parametrize("wall_velocity", [0.0, -0.25])
@pytest.mark.parametrize("is_on_left", [True, False])
def test_a_mass_bonded_to_a_wall_has_its_velocity(wall_velocity, is_on_left):
    """A push of 100 N on the other end of the row does not change the velocity of the
    wall and of the mass on it.
    """
    free = ri.RigidMass(1.0)
    bonded = ri.RigidMass(2.0, velocity=wall_velocity)
    wall = ri.Wall(velocity=wall_velocity)
    bodies = [free, bonded, wall]
    contacts = [ri.Spring(1e6), ri.Bonded()]
    ends = [ri.Pushed(100.0), ri.Free()]
    if is_on_left:
        for each in (bodies, contacts, ends):
            each.reverse()
    system = ri.System(bodies, contacts=contacts, ends=tuple(ends))

    solution, _ = solve_by_characteristics(system, until=1e-3)

    times = [0.0, 5e-4, 1e-3]
    velocity = solution.fields.velocity(1, 0.0, times)
    assert velocity == pytest.approx(wall_velocity, abs=1e-12)
