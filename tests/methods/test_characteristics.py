"""The method "characteristics" through solve(): closed forms, other methods, symmetry,
refusals.
"""

import math
import re

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import refused
from networks import UNIT, unit_rod
from scipy.integrate import solve_ivp
from systems import horizon, random_system

import rodimpact as ri
from rodimpact.methods import kernels

METHOD = "characteristics"
MASS = ri.RigidMass(1.0)
FRONTS_TOL = 1e-12
"""Largest difference from fronts: relative, or of velocities in m/s."""


def solve_row(bodies, until=None, gaps=None, contacts=None, rtol=None, **options):
    """The solution of a row by characteristics; `options` are those of `ri.System`."""
    system = ri.System(bodies, gaps=gaps, contacts=contacts, **options)
    return ri.solve(system, until=until, method=METHOD, rtol=rtol)


def largest_residual(solution, times):
    """Largest energy missing in the balance at some times, J."""
    balance = solution.energy(times)
    return np.abs(balance.residual).max()


# Against exact fronts
# --------------------------------------------------------------------------------------


def largest_impulse(outcome, until):
    """Scale of the impulses of a run, N s; 1 where nothing collides.

    It is the largest impulse, or what the largest force gives by the end of the run.
    """
    scale = 0.0
    for contact in outcome.contacts:
        of_peak_force = contact.peak_force * until
        scale = max(scale, abs(contact.impulse))
        scale = max(scale, of_peak_force)
    return scale if scale > 0 else 1.0


def n_begun_episodes(contact, until):
    """Number of episodes of a contact that begin before the end of the run, s.

    An episode that begins just at the end is left out: round-off decides about it.
    """
    before_end = until * (1 - 1e-9)
    n_begun = 0
    for episode in contact.episodes:
        if episode.start < before_end:
            n_begun += 1
    return n_begun


@pytest.mark.parametrize("seed", few_of(range(60), range(4)))
def test_fronts_are_met_to_round_off_or_to_the_error_stated_of_smoothed_waves(seed):
    """Contacts and motion of random rows of four bodies agree with fronts to
    `FRONTS_TOL`, and contacts have equally many episodes. Where the status says that
    waves were smoothed, they agree to the stated errors.
    """
    system = random_system(seed, bodies=4)
    until = horizon(system, transits=8)
    exact = ri.solve(system, until=until, method="fronts")

    solution = ri.solve(system, until=until, method=METHOD)

    if "Such waves are smoothed" in solution.status:
        bounds = solution.accuracy
        velocities = exact.outcome.velocities_before
        largest_velocity = np.abs(velocities).max()
        velocity_bound = bounds["velocity"] * largest_velocity
    else:
        bounds = {"impulse": FRONTS_TOL, "duration": FRONTS_TOL}
        velocity_bound = FRONTS_TOL
        pairs = zip(exact.contacts, solution.contacts, strict=True)
        for fronts, contact in pairs:
            n_episodes = n_begun_episodes(contact, until)
            assert n_episodes == n_begun_episodes(fronts, until)
    assert_contacts_are_near(exact.outcome, solution.outcome, bounds, until)
    assert_motion_is_near(exact, solution, velocity_bound, until)


def assert_contacts_are_near(exact, outcome, bounds, until):
    """Impulses, durations and first touches of two outcomes are near.

    The bounds are relative: of impulses to the largest, of times to the run.
    """
    impulse_scale = largest_impulse(exact, until)
    impulse_bound = bounds["impulse"] * impulse_scale
    time_bound = bounds["duration"] * until
    pairs = zip(exact.contacts, outcome.contacts, strict=True)
    for fronts, contact in pairs:
        assert contact.impulse == pytest.approx(fronts.impulse, abs=impulse_bound)
        duration = pytest.approx(fronts.duration, rel=1e-9, abs=time_bound)
        assert contact.duration == duration
        first = pytest.approx(fronts.first, rel=1e-9, abs=time_bound, nan_ok=True)
        assert contact.first == first


def assert_motion_is_near(exact, solution, velocity_bound, until):
    """Mean velocities at the end are near, to the bound in m/s, and so are
    displacements inside of rods.
    """
    # Places and times that are no simple fractions, so that few waves are just there
    shares = (np.arange(11) + 0.3) / 11
    times = until * shares[:, None]  # [time, 1]
    displacement_bound = velocity_bound * until
    for i, body in enumerate(exact.system.bodies):
        velocity = float(solution.mean_velocity(i, until))
        exact_velocity = float(exact.mean_velocity(i, until))
        assert velocity == pytest.approx(exact_velocity, abs=velocity_bound)
        if isinstance(body, ri.Rod):
            shares = (np.arange(4) + 0.37) / 4
            x = body.length * shares
            displacement = solution.displacement(i, x, times)
            expected = exact.displacement(i, x, times)
            assert displacement == pytest.approx(expected, abs=displacement_bound)


# Masses and rods
# --------------------------------------------------------------------------------------


def mass_on_a_stiff_spring(M, k):
    """Impulse, largest force and duration, as a mass strikes a rod through a spring.

    The mass M has unit velocity, the rod unit length, wave speed and impedance. Until
    the wave is back, at t = 2, the indentation is a sum of two exponentials; then the
    equation with its echo is integrated, up to t = 4 at most.
    """
    root = math.sqrt(k * k - 4 * k / M)
    slow = (-k + root) / 2
    fast = (-k - root) / 2

    def indentation(t):
        difference = math.exp(slow * t) - math.exp(fast * t)
        return difference / root

    def rates_with_echo(t, state):
        compression, velocity = state
        echo = 2 * k * indentation(t)
        rate = velocity - echo - k * compression
        acceleration = -k / M * compression
        return rate, acceleration

    def compression_of(_, state):
        return state[0]

    compression_of.terminal = True

    integral_of_slow = math.expm1(slow * 2) / slow
    integral_of_fast = math.expm1(fast * 2) / fast
    indentation_integral = (integral_of_slow - integral_of_fast) / root
    velocity_at_echo = 1 - k / M * indentation_integral
    state_at_echo = (indentation(2), velocity_at_echo)
    after_echo = solve_ivp(
        rates_with_echo,
        (0, 2),  # from the echo on
        state_at_echo,
        events=compression_of,
        method="DOP853",
        rtol=1e-12,
        atol=1e-15,
    )
    last_velocity = after_echo.y[1, -1]
    impulse = M * (1 - last_velocity)
    time_of_peak = math.log(fast / slow) / root
    peak_force = k * indentation(time_of_peak)
    (end_times,) = after_echo.t_events
    duration = 2 + end_times[0]
    return impulse, peak_force, duration


@pytest.mark.parametrize(
    ("M", "k", "gap"),
    [(0.1, 500.0, 0.0), (1.0, 500.0, 0.33), (1.0, 2e4, 0.0), (0.3, 1e6, 0.33)],
)
def test_the_blow_of_a_mass_through_a_stiff_spring_is_resolved_in_few_steps(M, k, gap):
    """Impulse, peak force and duration are those of `mass_on_a_stiff_spring`, and the
    run takes 500 events at most. M is the mass, kg, and k the stiffness, N/m.
    """
    impulse, peak_force, duration = mass_on_a_stiff_spring(M, k)
    mass = ri.RigidMass(M, velocity=1.0)
    rod = unit_rod()
    spring = ri.Spring(k)

    solution = solve_row([mass, rod], gaps=[gap], contacts=[spring])

    outcome = solution.outcome
    assert outcome.impulse == pytest.approx(impulse, rel=1e-8)
    assert outcome.peak_force == pytest.approx(peak_force, rel=1e-8)
    assert outcome.duration == pytest.approx(duration, rel=1e-8)
    assert abs(outcome.energy_residual) <= 1e-9
    # Steps of 1/k, the time of the fast exponential, would be 1000 to 2 million.
    assert solution.run.events <= 500


LIGHT_MASS = ri.RigidMass(1.0)
MIDDLE_MASS = ri.RigidMass(2.0)
HEAVY_MASS = ri.RigidMass(3.0)
BOND = ri.Bonded()
BONDED_TWICE = [BOND, BOND, ri.Hertz(9.0)]


def forces_until_2_s(contacts):
    """Force of each contact at 64 times from t = 0 to 2 s, N [contact][time]."""
    times = (np.arange(64) + 0.5) / 32
    return [contact.force(times) for contact in contacts]


@pytest.mark.parametrize("gravity", [0.0, -0.5])
def test_bonds_carry_a_push_less_what_accelerates_the_masses_before_them(gravity):
    """Three bonded masses, pushed from the left with 0.7 N, strike a rod and move as
    one. Each bond has the force of the push minus that which accelerates the masses on
    its left; gravity accelerates all bodies alike and takes no force. The impulse of a
    bond is the integral of this force over the run.
    """
    push = 0.7
    mass = 1.0 + 2.0 + 3.0
    rod = unit_rod(velocity=-1.0)

    solution = solve_row(
        [LIGHT_MASS, MIDDLE_MASS, HEAVY_MASS, rod],
        until=2.0,
        contacts=BONDED_TWICE,
        gravity=gravity,
        ends=(ri.Pushed(push), ri.Free()),
    )

    first, second, last = forces_until_2_s(solution.contacts)
    acceleration = (push - last) / mass  # without gravity
    expected_first = push - 1.0 * acceleration  # before it is the mass of 1 kg
    assert first == pytest.approx(expected_first, abs=1e-8)
    expected_second = push - 3.0 * acceleration  # before it are 1 and 2 kg
    assert second == pytest.approx(expected_second, abs=1e-8)
    # In 2 s the push has changed the velocity of the 3 kg before the second bond.
    *_, bond, hertz = solution.outcome.contacts
    total_change = push * 2.0 - hertz.impulse  # of the momentum of all masses
    velocity_change = total_change / mass
    impulse = push * 2.0 - 3.0 * velocity_change
    assert bond.impulse == pytest.approx(impulse, rel=1e-9)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("gravity", [0.0, -0.5])
def test_bonds_of_held_masses_carry_the_contact_force_and_the_weight(gravity, mirrored):
    """A rod strikes two masses that are bonded to a wall. Each bond carries the force
    of the contact, less the weight of the masses between the two.
    """
    rod = unit_rod(velocity=-1.0)
    bodies = [ri.Wall(), LIGHT_MASS, MIDDLE_MASS, rod]
    system = ri.System(bodies, contacts=BONDED_TWICE, gravity=gravity)

    if mirrored:
        solution = ri.solve(system.mirrored(), until=2.0)
        contacts = solution.contacts[::-1]  # again from the wall on
    else:
        solution = ri.solve(system, until=2.0)
        contacts = solution.contacts

    first, second, last = forces_until_2_s(contacts)
    assert last.max() > 0.3  # the rod strikes
    # Gravity is to the left where it is negative; the masses are 1 and 2 kg.
    weight_of_middle = 2 * gravity
    assert second == pytest.approx(last - weight_of_middle, abs=1e-8)
    weight_of_both = (1 + 2) * gravity
    assert first == pytest.approx(last - weight_of_both, abs=1e-8)


# Compliant contacts
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kappa", "e"), [(1e-3, 1.0), (1.0, 0.94410), (10.0, 0.61670), (1e3, 0.41102)]
)
def test_hertz_ends_carry_e_from_one_to_the_ratio_of_lengths(kappa, e):
    """The restitution e of two rods goes from that of rigid bodies, 1, at a soft
    contact to the ratio of their lengths, 0.4, at a rigid one. kappa is the stiffness
    of the contact.

    The values in between were computed in two independent ways to three digits; see
    validation/hertz_ends.py.
    """
    striker = unit_rod(0.4, velocity=1.0)
    struck = unit_rod()
    until = 6.0 + 18 * kappa**-0.4  # softer contacts last longer
    law = ri.Hertz(kappa)

    solution = solve_row([striker, struck], until=until, contacts=[law])

    restitution = solution.outcome.restitution
    assert restitution == pytest.approx(e, abs=4e-4)


LAWS = {  # law, and its force for the compression p and the closing speed w
    "spring": (ri.Spring(5.0), lambda p, w: 5 * p),
    "spring and dashpot": (ri.SpringDashpot(5.0, damping=1.0), lambda p, w: 5 * p + w),
    "Hertz": (ri.Hertz(5.0), lambda p, w: 5 * p**1.5),
    "Hunt-Crossley": (
        ri.HuntCrossley(5.0, damping=0.4),
        lambda p, w: 5 * p**1.5 * (1 + 0.4 * w),
    ),
}


def force_on_bar(force, compression, velocity, Z):
    """Force F on a bar of impedance Z, whose end moves with F/Z: F = force(x, V - F/Z).

    By bisection from 0 N: the right side decreases with F. A force that would pull
    is 0.
    """
    low = 0.0
    high = 1e3  # N, more than any force here
    for _ in range(60):
        F = (low + high) / 2
        closing = velocity - F / Z
        if force(compression, closing) > F:
            low = F
        else:
            high = F
    return F


def impulse_on_endless_bar(force, M, Z, duration):
    """Impulse of a mass M at unit velocity through a law on a bar of impedance Z, N s,
    until they part, or for `duration`, s.

    The end of the bar moves with F/Z, as a dashpot would. The law is given by its
    `force` for a compression and a closing speed; it does not pull.
    """

    def rates(_, state):
        """Of compression, velocity of the mass, and impulse."""
        x, V, _ = state
        if x <= 0:
            return [V, 0.0, 0.0]
        F = force_on_bar(force, x, V, Z)
        rate = V - F / Z
        return [rate, -F / M, F]

    def parting(_, state):
        # The motion begins at a compression of about 0, which must not end it.
        return state[0] + 1e-12

    parting.terminal = True
    parting.direction = -1
    touching = [1e-13, 1.0, 0.0]  # just compressed, so that there is a force
    interval = (0, duration)
    motion = solve_ivp(rates, interval, touching, rtol=1e-9, atol=1e-11, events=parting)
    return motion.y[2, -1]


@pytest.mark.parametrize(("law", "force"), LAWS.values(), ids=LAWS)
def test_the_impulse_of_a_mass_through_a_law_on_an_endless_bar(law, force):
    """The impulse is that of `impulse_on_endless_bar`, which integrates the motion of
    the mass.
    """
    M = 0.5
    Z = 2.0
    gap = 0.0837
    mass = ri.RigidMass(M, velocity=1.0)
    bar = unit_rod(1.0, area=Z)
    absorbing = (ri.Free(), ri.Absorbing())
    system = ri.System([mass, bar], gaps=[gap], contacts=[law], ends=absorbing)

    outcome = ri.solve(system, until=4.0).outcome

    touch_time = gap  # at 1 m/s
    duration = 4.0 - touch_time
    expected = impulse_on_endless_bar(force, M, Z, duration)
    assert outcome.impulse == pytest.approx(expected, abs=1e-8)


TABLE_X = np.array([0.0, 0.1, 0.6, 0.7])  # compressions of a table, m
TABLE_F = np.array([0.0, 0.5, 0.8, 2.5])  # and its forces, N


def peak_force_of_table(energy):
    """Force of the tabulated law, N, up to which its work is this energy, J."""
    widths = np.diff(TABLE_X)
    mean_forces = (TABLE_F[1:] + TABLE_F[:-1]) / 2
    works_of_lines = widths * mean_forces
    work = np.append(0.0, works_of_lines.cumsum())  # up to each point, J
    # The energy is reached on the line from this point to the next.
    point = int(np.searchsorted(work, energy))
    start = min(point, 3) - 1  # the last line goes on beyond the table
    end = start + 1
    rise = TABLE_F[end] - TABLE_F[start]
    slope = rise / (TABLE_X[end] - TABLE_X[start])
    work_left = energy - work[start]
    # On a line the square of the force grows by twice the slope times the work.
    squared_force = TABLE_F[start] ** 2 + 2 * slope * work_left
    return math.sqrt(squared_force)


@pytest.mark.parametrize("speed", [0.2, 1.0, 1.6, 2.0])
@pytest.mark.parametrize(
    "method", few_of(["characteristics", "finite-difference"], ["characteristics"])
)
def test_two_masses_rebound_by_what_a_table_gives_back(method, speed):
    """Two masses strike through a tabulated law. Velocity of rebound, peak force and
    loss follow from the area below the table, the energy of the blow, and from
    unloading with the slope k, which gives back F^2/(2 k). The fastest mass goes beyond
    the last point.
    """
    unloading = 20.0  # stiffness k, N/m
    first_mass = 0.5  # kg
    second_mass = 0.8
    reduced_mass = first_mass * second_mass / (first_mass + second_mass)
    energy = reduced_mass * speed**2 / 2
    peak_force = peak_force_of_table(energy)
    given_back = peak_force**2 / (2 * unloading)
    rebound = math.sqrt(2 * given_back / reduced_mass)

    law = ri.Tabulated(TABLE_X[1:], TABLE_F[1:], unloading=unloading)
    # The rod, far away, gives the row the transit time that methods need.
    far_rod = unit_rod()
    striker = ri.RigidMass(first_mass, velocity=speed)
    struck = ri.RigidMass(second_mass)
    system = ri.System(
        [striker, struck, far_rod], gaps=[0.01, 100.0], contacts=[law, ri.Rigid()]
    )
    solution = ri.solve(system, until=6.0, method=method, rtol=1e-6)

    first, second, _ = solution.outcome.velocities_after
    assert second - first == pytest.approx(rebound, abs=2e-5)
    contact = solution.contacts[0]
    assert contact.peak_force == pytest.approx(peak_force, rel=1e-3)
    dissipated = solution.outcome.dissipated
    expected_loss = energy - given_back
    assert dissipated == pytest.approx(expected_loss, abs=1e-5)
    times = np.linspace(0, 6, 40)
    assert largest_residual(solution, times) < 1e-8
    continued = solution.system_at(5.9)
    hardened = continued.contacts[0]
    largest_elastic_force = hardened.force[0]
    assert largest_elastic_force == pytest.approx(peak_force, rel=1e-3)


@pytest.mark.parametrize("compiling", few_of([False, True], [False]))
@pytest.mark.parametrize(
    "method", few_of(["characteristics", "finite-difference"], ["characteristics"])
)
def test_what_yields_is_a_table_of_two_points(method, compiling):
    """Peak force and velocities with `Yielding` are those with `Tabulated`, whose lines
    run from (0, 0) by way of the yield point along the line of hardening.
    """
    cells = 100 if method == "finite-difference" else None
    striker = unit_rod(1.0, velocity=2.0)
    struck = unit_rod(2.0)
    yielding_law = ri.Yielding(10.0, yield_force=0.5, hardening=2.0)
    yield_point = 0.5 / 10.0  # m
    compressions = [yield_point, yield_point + 1.0]
    forces = [0.5, 0.5 + 2.0]  # it hardens by 2 N/m
    table_law = ri.Tabulated(compressions, forces)

    def outcome_of(law):
        system = ri.System([striker, struck], contacts=[law])
        solution = ri.solve(system, until=12.0, method=method, cells=cells)
        return solution.outcome

    with kernels.forced(compiling):
        yielding = outcome_of(yielding_law)
        table = outcome_of(table_law)

    assert yielding.peak_force > 1.1 * 0.5  # well beyond yield
    peak_force = yielding.peak_force
    assert table.peak_force == pytest.approx(peak_force, rel=1e-5)
    expected = yielding.velocities_after
    np.testing.assert_allclose(table.velocities_after, expected, rtol=1e-4)


def yielding_on_endless_bar(M, Z, k, strength, hardening):
    """Impulse and largest force of a mass M of unit velocity on a bar of impedance Z.

    What is between them loads as a spring k up to the force `strength`, yields with the
    slope `hardening`, and unloads as a spring k. Yielding ends when the mass and the
    end of the bar move together.
    """

    def follow(stiffness, state, event):
        """State of force, velocity of the mass and impulse, where the event is 0."""

        def rates(_, state):
            F, V, _ = state
            rate = stiffness * (V - F / Z)
            return [rate, -F / M, F]

        event.terminal = True
        interval = (0, 99.0)  # longer than it takes
        motion = solve_ivp(rates, interval, state, rtol=1e-11, atol=1e-13, events=event)
        return motion.y[:, -1]

    def force_below_strength(_, state):
        return state[0] - strength

    def closing_velocity(_, state):
        F, V, _ = state
        return V - F / Z

    def force(_, state):
        return state[0]

    touching = [0.0, 1.0, 0.0]  # force, velocity, impulse
    at_yield = follow(k, touching, force_below_strength)
    at_peak = follow(hardening, at_yield, closing_velocity)
    at_end = follow(k, at_peak, force)
    impulse = at_end[2]
    peak_force = at_peak[0]
    return impulse, peak_force


@pytest.mark.parametrize(
    ("mirrored", "hardening"), [(False, 0.7), (True, 0.7), (False, 0.0)]
)
def test_a_blow_on_an_endless_bar_through_what_yields_is_as_integrated(
    mirrored, hardening
):
    """Impulse and largest force of a mass are those of `yielding_on_endless_bar`. The
    energies balance, and the law is left with the largest force as its yield force.
    """
    M = 0.5
    Z = 2.0
    k = 5.0
    strength = 0.3
    mass = ri.RigidMass(M, velocity=1.0)
    bar = unit_rod(1.0, area=Z)
    law = ri.Yielding(k, yield_force=strength, hardening=hardening)
    absorbing = (ri.Free(), ri.Absorbing())
    system = ri.System([mass, bar], contacts=[law], ends=absorbing)
    if mirrored:
        system = system.mirrored()

    solution = ri.solve(system, until=6.0)

    impulse, peak_force = yielding_on_endless_bar(M, Z, k, strength, hardening)
    outcome = solution.outcome
    assert outcome.impulse == pytest.approx(impulse, abs=1e-9)
    assert outcome.peak_force == pytest.approx(peak_force, abs=1e-9)
    times = np.linspace(0, 6, 40)
    assert largest_residual(solution, times) < 1e-9
    continued = solution.system_at(5.9)
    (hardened,) = continued.contacts
    assert hardened.yield_force == pytest.approx(peak_force, rel=1e-9)
    assert hardened.hardening == hardening


# The functions of a solution agree with each other
# --------------------------------------------------------------------------------------

THICK = ri.Segment(0.5, area=1.0, material=UNIT)
THIN = ri.Segment(0.75, area=0.5, material=UNIT)
WAVE = ri.Samples([0.0, -0.2, 0.3])
STEPPED = ri.Rod(segments=[THICK, THIN], velocity=WAVE)
BODIES = [
    unit_rod(1.0, area=2.0, velocity=0.5),
    ri.RigidMass(0.5, velocity=-0.25),
    STEPPED,
    ri.RigidMass(1.5, velocity=-1.0),
]
HERTZ = ri.Hertz(20.0)
HUNT_CROSSLEY = ri.HuntCrossley(10.0, damping=0.3)


@pytest.fixture(scope="module")
def driven():
    """Solution until t = 4 of a row of rods and masses with three laws, gravity and two
    driven ends.
    """
    velocity_of_end = ri.Samples([0.5, 1.0, -0.5], step=1.0)
    moved = ri.Moved(velocity_of_end)
    return solve_row(
        BODIES,
        until=4.0,
        gaps=[0.1, 0.05, 0.0],
        contacts=[HERTZ, ri.Rigid(), HUNT_CROSSLEY],
        rtol=1e-11,
        ends=(moved, ri.Pushed(0.2)),
        gravity=-0.4,
    )


TIMES = np.linspace(0, 4, 129)


def overlap_at_times(contact):
    """Depth by which the bodies of a contact overlap at `TIMES`, m; 0 while apart."""
    gap = contact.gap(TIMES)
    return np.maximum(-gap, 0.0)


def test_compliant_forces_follow_their_laws(driven):
    """The forces of the Hertz and the Hunt-Crossley contact are those of their laws for
    the overlaps and closing velocities of the solution.
    """
    hertz, _, hunt_crossley = driven.contacts

    overlap = overlap_at_times(hertz)
    expected = 20 * overlap**1.5
    force = hertz.force(TIMES)
    assert force == pytest.approx(expected, abs=1e-8)
    is_pressed = overlap > 0
    assert is_pressed.sum() > 20  # of 129 times

    rod_end = driven.velocity(2, 1.25, TIMES)
    mass = driven.velocity(3, 0.0, TIMES)
    closing = rod_end - mass
    overlap = overlap_at_times(hunt_crossley)
    law_force = 10 * overlap**1.5 * (1 + 0.3 * closing)
    expected = np.maximum(law_force, 0.0)  # it does not pull
    force = hunt_crossley.force(TIMES)
    assert force == pytest.approx(expected, abs=1e-8)


def test_a_rigid_contact_never_has_both_a_force_and_a_gap(driven):
    """The rigid contact of `driven` has each of them at some of the times in `TIMES`."""
    rigid = driven.contacts[1]
    force = rigid.force(TIMES)
    gap = rigid.gap(TIMES)
    has_force = force > 0
    has_gap = gap > 0
    assert has_force.any()
    assert has_gap.any()
    has_both = has_force & has_gap
    assert not has_both.any()


def test_the_outcome_of_contacts_is_that_of_their_histories(driven):
    """Number of episodes, first touch and peak force are compared."""
    totals = driven.outcome.contacts
    for contact, total in zip(driven.contacts, totals, strict=True):
        assert len(contact.episodes) == total.episodes
        first_episode = contact.episodes[0]
        assert first_episode.start == total.first
        times = np.linspace(0, 4, 4001)
        sampled_force = contact.force(times)
        peak_force = sampled_force.max()  # which may lie between two samples
        assert peak_force <= total.peak_force * (1 + 1e-9)
        assert total.peak_force == pytest.approx(peak_force, rel=1e-3)


@pytest.mark.parametrize("law", [ri.Spring(30.0), ri.Rigid()])
def test_a_state_in_which_no_bodies_touch_can_be_continued(law):
    """A run in two parts, cut when no bodies touch, ends with the velocities of one
    that did not stop.
    """
    system = ri.System(
        BODIES,
        gaps=[0.1, 0.05, 0.4],
        contacts=[HERTZ, law, HUNT_CROSSLEY],
        gravity=-0.4,
        ends=(ri.Absorbing(), ri.Pushed(0.2)),
    )
    whole = ri.solve(system, until=3.0)
    times = np.arange(1, 128) / 64
    gaps = np.array([contact.gap(times) for contact in whole.contacts])
    all_are_apart = (gaps >= 0).all(axis=0)  # [time]
    times_without_touch = times[all_are_apart]
    middle = len(times_without_touch) // 2
    cut = times_without_touch[middle]

    system_at_cut = whole.system_at(cut)
    second_part = ri.solve(system_at_cut, until=3.0 - cut)

    end = second_part.t_end
    for body in range(len(BODIES)):
        velocity = float(second_part.mean_velocity(body, end))
        expected = float(whole.mean_velocity(body, 3.0))
        assert velocity == pytest.approx(expected, abs=1e-7)


def test_a_row_with_driven_ends_cannot_be_continued(driven):
    with pytest.raises(ValueError, match=r"ends\.left: is driven"):
        driven.system_at(1.0)


def test_a_rigid_mass_has_no_strain(driven):
    with pytest.raises(ValueError, match="is a rigid mass"):
        driven.strain(1, 0.0, 1.0)


# Tolerance
# --------------------------------------------------------------------------------------

STRIKING_MASS = ri.RigidMass(0.2, velocity=1.0)


@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
@pytest.mark.parametrize(
    ("bodies", "laws"),
    [
        pytest.param(
            [ri.RigidMass(1.0, velocity=1.0), unit_rod()], [ri.Rigid()], id="rigid"
        ),
        pytest.param(
            [unit_rod(0.4, velocity=1.0), unit_rod()], [ri.Hertz(50.0)], id="Hertz"
        ),
        pytest.param(
            [STRIKING_MASS, unit_rod(), ri.RigidMass(0.3)],
            [ri.Hertz(1e3), ri.Spring(1e2)],
            id="two laws",
        ),
    ],
)
def test_impulses_are_as_exact_as_rtol_says(bodies, laws, rtol):
    """The impulses of a row differ from those of a run with rtol 1e-11 by at most rtol
    times the largest.
    """
    fine = solve_row(bodies, until=4.0, contacts=laws, rtol=1e-11)

    rough = solve_row(bodies, until=4.0, contacts=laws, rtol=rtol)

    impulses = [contact.impulse for contact in rough.outcome.contacts]
    expected = [contact.impulse for contact in fine.outcome.contacts]
    bound = rtol * max(expected)
    assert impulses == pytest.approx(expected, abs=bound)


GAPS = np.linspace(0.1, 0.12, 21).tolist()  # m


@pytest.mark.parametrize("gap", [*few_of(GAPS, GAPS[::5]), 0.1105])
def test_a_gap_of_any_width_closes_on_time(gap):
    """A rod at 1 m/s closes a gap at t = gap; the contact ends when the wave in the
    struck rod, 0.75 m long, is back. Episode, duration, e and the energy lost by the
    method, 0, are exact to 1e-11.
    """
    # The velocity is a function so that fronts, which take none, are not chosen.
    striker = unit_rod(velocity=lambda x: 1.0 + 0 * x)
    struck = unit_rod(0.75, area=0.4)
    duration = 2 * 0.75  # s
    struck_impedance = 0.4  # the striker's is 1
    force = struck_impedance / (1 + struck_impedance)
    impulse = force * duration
    struck_mass = 0.75 * 0.4  # the striker's is 1
    restitution = impulse * (1 + 1 / struck_mass) - 1  # 6/7
    system = ri.System([striker, struck], gaps=[gap])

    solution = ri.solve(system)

    assert solution.method == METHOD
    outcome = solution.outcome
    assert outcome.restitution == pytest.approx(restitution, abs=1e-11)
    (contact,) = solution.contacts
    (episode,) = contact.episodes
    end = gap + duration
    expected = (gap, end, end)  # start, end of the force, opening
    assert episode == pytest.approx(expected, abs=1e-11)
    assert outcome.duration == pytest.approx(duration, abs=1e-11)
    assert outcome.numerical == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("until", [1e-12, 0.013, 0.5123, 1.9])
def test_a_run_ends_where_it_was_asked_to_end(until):
    """A mass strikes a rod; at `until`, s, its velocity is exp(-until), and the impulse
    is what it has lost.
    """
    velocity = math.exp(-until)  # of a mass on a rod, until the wave is back at 2

    mass = ri.RigidMass(1.0, velocity=1.0)

    solution = solve_row([mass, unit_rod()], until=until)

    assert solution.t_end == until
    tick = solution.fields.clock.tick
    end = solution.fields.end * tick
    assert end == pytest.approx(until, abs=tick)
    outcome = solution.outcome
    velocity_after, _ = outcome.velocities_after
    assert velocity_after == pytest.approx(velocity, abs=1e-9)
    lost_momentum = 1 - velocity  # of 1 kg
    assert outcome.impulse == pytest.approx(lost_momentum, abs=1e-9)
    assert abs(outcome.energy_residual) <= 1e-9


# Which method
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("direction", [1, -1])
def test_large_strains_are_those_of_the_rod_in_which_they_are(direction):
    """Both methods warn of the largest strain in a slow rod that is struck: the largest
    wave over the wave speed, in the frame that moves with the mean of both velocities.
    """
    slow = ri.Material("slow", youngs_modulus=0.01, density=1.0)
    slow_speed = 0.1  # m/s, of waves; also the impedance, the other one being 1
    striker_velocity = 0.04
    striker = unit_rod(velocity=striker_velocity * direction)
    slow_rod = ri.Rod(0.1, area=1.0, material=slow)
    bodies = [striker, slow_rod]
    if direction == -1:
        bodies.reverse()
    # The wave that enters the slow rod has twice the amplitude that joins both.
    mean_velocity = striker_velocity / 2
    wave = 2 * striker_velocity / (1 + slow_speed)
    largest_strain = (wave - mean_velocity) / slow_speed

    by_characteristics = solve_row(bodies, until=0.9)
    system = ri.System(bodies)
    by_fronts = ri.solve(system, until=0.9)

    sentence = f"Strains may reach up to {largest_strain:.2g}"
    assert sentence in by_characteristics.status
    assert sentence in by_fronts.status


def test_no_strain_is_warned_of_where_only_the_frame_falls():
    """A string of drill pipe that swings at a fixed end has strains of 0.3 %, nearly
    twice those of its weight at rest.
    """
    steel = ri.materials.steel
    pipe = ri.Rod(3048.0, area=3.4e-3, material=steel)
    collar = ri.Rod(183.0, area=24e-3, material=steel)
    hanging = (ri.Fixed(), ri.Free())
    bonds = [ri.Bonded()]
    string = ri.System([pipe, collar], contacts=bonds, ends=hanging, gravity=9.81)
    stretched_pipe = pipe.replace(strain=2e-3)
    free_pipe = ri.System([stretched_pipe], gravity=9.81)
    heavy_string = string.replace(gravity=50.0)

    swinging = ri.solve(string, until=5.0)
    falling = ri.solve(free_pipe, until=10.0)
    overstrained = ri.solve(heavy_string, until=5.0)

    largest_stress = swinging.extreme_stress(0).largest
    largest_strain = largest_stress / steel.youngs_modulus
    assert 0.003 < largest_strain < 0.0033
    assert "Strains" not in swinging.status
    assert "Strains" not in falling.status
    assert "Strains may reach up to 0.01" in overstrained.status


PAIR = ri.System([unit_rod(velocity=1.0), unit_rod()])


def test_auto_takes_fronts_where_it_can():
    """Without a method, a pair of rods and a rod with a fixed end are solved by fronts."""
    fixed_end = (ri.Fixed(), ri.Free())
    fixed_rod = ri.System([unit_rod()], ends=fixed_end)

    of_pair = ri.solve(PAIR)
    of_fixed_rod = ri.solve(fixed_rod, until=1.0)

    assert of_pair.method == "fronts"
    assert of_fixed_rod.method == "fronts"


def test_auto_takes_characteristics_for_a_tolerance_and_for_masses():
    """Without a method, rods with rtol, and a mass with a rod, are solved by
    characteristics.
    """
    mass = ri.RigidMass(1.0, velocity=1.0)
    mass_and_rod = ri.System([mass, unit_rod()])

    with_tolerance = ri.solve(PAIR, rtol=1e-3)
    with_mass = ri.solve(mass_and_rod)

    assert with_tolerance.method == METHOD
    assert with_mass.method == METHOD


def test_fronts_take_no_tolerance():
    message = 'is for method "characteristics" or "finite-difference"'

    paths = refused(message, ri.solve, PAIR, method="fronts", rtol=0.1)

    assert paths == ["rtol"]


# Restitution
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bodies", "options", "reason"),
    [
        pytest.param(
            [unit_rod(velocity=1.0), ri.Wall()],
            {"gravity": 0.1},
            "gravity, a driven end, soil or drag",
            id="gravity",
        ),
        pytest.param(
            [unit_rod(velocity=1.0), unit_rod(), unit_rod()],
            {},
            "this row has 2",
            id="two contacts",
        ),
        pytest.param(
            [unit_rod(), unit_rod(velocity=1.0)], {}, "move apart", id="apart"
        ),
        pytest.param(
            [unit_rod(), unit_rod()],
            {},
            "nothing collided; the bodies do not approach",
            id="at rest",
        ),
        pytest.param(
            [unit_rod(velocity=ri.Steps([-1.0, 1.0], at=[0.5])), unit_rod()],
            {},
            "centres of mass did not approach",
            id="vibration",
        ),
        pytest.param(
            [unit_rod(velocity=1.0), unit_rod()],
            {"contacts": [ri.Spring(1e-4)]},
            "is not over",
            id="not over",
        ),
        pytest.param(
            [unit_rod(velocity=1.0), MASS],
            {"contacts": [ri.Bonded()]},
            "no contact of this row",
            id="bonded",
        ),
    ],
)
def test_an_outcome_without_restitution_says_why(bodies, options, reason):
    """The reason is given by `why_no_restitution`, and by the errors of `restitution`
    and `as_rigid`.
    """
    solution = solve_row(bodies, until=4.0, **options)
    outcome = solution.outcome

    assert reason in outcome.why_no_restitution()
    with pytest.raises(ri.UndefinedRestitution, match=reason):
        _ = outcome.restitution
    with pytest.raises(ri.UndefinedRestitution, match=reason):
        outcome.as_rigid()


@pytest.mark.parametrize("wall_velocity", [0.0, 0.2])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_ball_on_a_floor_bounces_by_its_restitution_and_comes_to_rest(
    wall_velocity, mirrored
):
    """A ball falls on a wall from 0.3 m and comes back with half of its speed; after
    3.7 s it lies still, and its weight is the contact force. If the wall moves, this
    holds relative to the wall. Also mirrored.
    """
    ball = ri.RigidMass(2.0, velocity=wall_velocity)
    bodies = [ri.Wall(wall_velocity), ball, unit_rod()]
    laws = [ri.Rigid(restitution=0.5), ri.Rigid()]
    gaps = [0.3, 90.0]  # the rod is out of reach
    system = ri.System(bodies, gaps=gaps, contacts=laws, gravity=-1.0)
    if mirrored:
        solution = ri.solve(system.mirrored(), until=4.0)
        direction = -1
        floor = solution.contacts[-1]
    else:
        solution = ri.solve(system, until=4.0)
        direction = 1
        floor = solution.contacts[0]

    def approach(times):
        """Velocity with which the gap between wall and ball closes, m/s."""
        velocity = solution.velocity(1, 0.0, times)  # of the ball
        return wall_velocity - direction * velocity

    impact_speed = math.sqrt(2 * 0.3)  # after a fall of 0.3 m
    impact_time = impact_speed  # falling from rest at unit gravity
    first_episode = floor.episodes[0]
    assert first_episode.start == pytest.approx(impact_time, abs=1e-9)
    approach_before = approach(impact_time - 1e-6)
    approach_after = approach(impact_time + 1e-6)
    assert approach_before == pytest.approx(impact_speed, abs=2e-6)
    assert approach_after == pytest.approx(-impact_speed / 2, abs=2e-6)
    times = np.linspace(0, 4, 257)
    # Its flights take 1, 1/2, 1/4 ... of the time of the fall, and end after 2.3 s.
    at_rest = times[times > 3.7]
    weight = 2.0  # N, of 2 kg at unit gravity
    velocity = approach(at_rest)
    assert np.abs(velocity).max() <= 1e-9
    force = floor.force(at_rest)
    assert force == pytest.approx(weight, abs=1e-9)
    assert largest_residual(solution, times) <= 1e-8


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
@pytest.mark.parametrize("velocity", [1e150, 1e-160])
def test_velocities_whose_energy_is_no_number_are_refused(method, velocity):
    """A velocity so large or small that energies overflow or vanish is refused by each
    method, with its number.
    """
    striker = unit_rod(velocity=velocity)
    system = ri.System([striker, unit_rod()])
    number = re.escape(repr(velocity))
    message = rf"bodies: .*{number} m/s make energies or forces that overflow or"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.solve(system, method=method, until=1.0)


@pytest.mark.parametrize("law", [ri.Spring(1e40), ri.Hertz(1e140)])
@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_contacts_as_good_as_rigid_are_refused(law, method):
    """Both methods refuse a spring and a Hertz contact of extreme stiffness, with
    `Rigid()` as the remedy.
    """
    striker = unit_rod(velocity=1.0)
    system = ri.System([striker, unit_rod()], contacts=[law])
    message = r"contacts\.0\.stiffness: .*use Rigid\(\)"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.solve(system, method=method, until=1.0)
