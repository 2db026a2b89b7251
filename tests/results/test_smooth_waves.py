"""Solutions whose waves are polynomials between breaks, beside closed forms.

A mass that strikes a rod, until the wave has come back, and a rod that vibrates for
ever.
"""

from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebinterpolate
from scipy.integrate import quad

import rodimpact as ri
from rodimpact.methods.clock import Clock
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.run import Run, Signals, Waves
from rodimpact.methods.signals import LINE_RTOL, Pieces
from rodimpact.model.profiles import averages
from rodimpact.results.solution import Solution

ROD = ri.Rod(
    2.0, area=0.5, material=ri.Material("unit", youngs_modulus=2.0, density=2.0)
)
LENGTH = 2.0  # of the rod, m
T = 2.0  # transit time, s
TICKS = (1 << 50) + 7  # of the transit time
TICK = T / TICKS  # s
Z = 1.0  # impedance of the rod, kg/s
C = 1.0  # wave speed, m/s
MASS = 1.5  # that strikes the rod, kg
SPEED = 3.0  # of this mass, m/s
VIBRATION = 5.0  # angular frequency of a part of the wave, rad/s
FALL = 0.7  # gravity, m/s^2
DRIFT = 1.25  # velocity of the frame in which the waves are, m/s


def pieces_of(function, marks):
    """A function of time in s as `Pieces` of degree 16 between consecutive `marks`, s."""
    ticks = [round(mark / TICK) for mark in marks]
    coefficients = []
    for start, stop in pairwise(ticks):
        middle = (start + stop) / 2
        half = (stop - start) / 2

        def on_piece(y, middle=middle, half=half):
            return function((middle + half * y) * TICK)

        coefficients.append(chebinterpolate(on_piece, 16))
    return Pieces(ticks[:-1], coefficients, ticks[-1])


def solution_from_waves(system, right_going, left_going, end):
    """The solution of a rod from the waves that leave its ends, until `end`, s."""
    row = build_row(system)
    clock = Clock(row, TICK, [TICKS], DRIFT, SPEED, impedance=[0.0, Z, 0.0])
    waves = Waves([None, None, right_going, left_going, None, None])
    signals = Signals(waves, contacts=(), boundary_actions=(None, None))
    run = Run(
        method="characteristics",
        until=end,
        clock=clock,
        end=round(end / TICK),
        t_end=end,
        t_final=np.nan,
        stopped_by="until",
        status="Ran to the end.",
        events=1,
        contacts=(),
        make_signals=lambda: signals,
    )
    return Solution(run, ri.Options(end))


@pytest.fixture(scope="module")
def struck_solution():
    """The solution of a mass that strikes a rod: its velocity falls as exp(-Z t/M)."""
    system = ri.System([ri.RigidMass(MASS, velocity=SPEED), ROD])
    return ri.solve(system, 3.5, "characteristics", rtol=1e-12)


# Times between which the pieces of the waves are, s
RIGHT_MARKS = [-2.0, -1.1, 0.0, 0.6, 1.3, 2.1, 3.0, 4.0, 4.7, 5.3, 5.9]
LEFT_MARKS = [-2.0, -1.4, -0.7, 0.5, 2.0, 2.9, 3.3, 4.1, 5.0, 5.9]


@pytest.fixture(scope="module")
def vibrating_solution():
    """The solution of a rod with free ends in free fall: each wave turns back as the
    other one, with its jump.
    """
    right_going = pieces_of(shape, RIGHT_MARKS)
    left_going = pieces_of(lambda t: shape(t + T), LEFT_MARKS)
    system = ri.System([ROD], gravity=FALL)
    return solution_from_waves(system, right_going, left_going, 5.5)


def shape(t):
    """The wave that leaves the left end of the rod that vibrates.

    It comes again after a round trip of 4 s, in which it jumps at 0 and at 1.3 s.
    """
    t = np.mod(t, 2 * T)
    return np.where(t < 1.3, np.sin(VIBRATION * t), 0.5 * (t - 2.5) ** 3)


def waves(x, t):
    """The waves that run right and left at place x and time t."""
    right_going = shape(t - x / C)
    left_going = shape(t + x / C)
    return right_going, left_going


def velocity(x, t):
    """Velocity of the rod that vibrates."""
    right, left = waves(x, t)
    return (right + left) / 2 + DRIFT + FALL * t


def strain(x, t):
    """Strain of the rod that vibrates."""
    right, left = waves(x, t)
    return (left - right) / (2 * C)


def integral(function, start, stop, breaks):
    """Integral from start to stop by SciPy, from break to break."""
    inside = [mark for mark in breaks if start < mark < stop]
    total = 0.0
    for low, high in pairwise([start, *sorted(inside), stop]):
        total += quad(function, low, high, epsabs=1e-13)[0]
    return total


def jumps_of_waves():
    """Times at which the wave jumps at the left end, from -2 T to 6 T."""
    periods = 2 * T * np.arange(-1, 3)
    return np.concatenate([periods, periods + 1.3])


def jumps_in_time(x):
    """Times at which the state jumps at x, among others."""
    jumps = jumps_of_waves()
    return np.concatenate([jumps + x / C, jumps - x / C])


def jumps_along(t):
    """Places at which the state jumps at t, among others."""
    distances = C * (jumps_of_waves() - t)
    return np.concatenate([distances, -distances])


def is_away_from_jumps(x, t):
    """Whether no wave jumps within 1e-9 s of each of these places and times."""
    waves_left_at = np.broadcast_arrays(t - x / C, t + x / C)
    phases = np.mod(np.stack(waves_left_at), 2 * T)  # [wave, place or time]
    distances = [np.abs(phases - jump) for jump in (0.0, 1.3, 2 * T)]
    return np.min(distances, axis=(0, 1)) > 1e-9


# The rod that vibrates
# --------------------------------------------------------------------------------------

FIELDS = {"velocity": velocity, "strain": strain}


@pytest.mark.parametrize("field", FIELDS)
def test_velocity_and_strain_are_sums_of_waves(vibrating_solution, field):
    """Values at 500 random points are compared with formulas, away from jumps."""
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 2, 500)
    t = rng.uniform(0, 5.5, 500)
    away = is_away_from_jumps(x, t)
    values_at = getattr(vibrating_solution, field)
    values = values_at(0, x, t)
    expected = FIELDS[field](x, t)
    assert values[away] == pytest.approx(expected[away], abs=1e-11)


@pytest.mark.parametrize("field", FIELDS)
def test_places_and_times_broadcast_to_values_of_each_alone(vibrating_solution, field):
    """A field at 12 positions and 10 times in one call has the values of single calls
    to 1e-14.
    """
    rng = np.random.default_rng(1)
    x = np.sort(rng.uniform(0, 2, 12))
    t = np.sort(rng.uniform(0, 5.5, 10))
    values_at = getattr(vibrating_solution, field)
    one_by_one = np.empty((12, 10))
    for i in range(12):
        for j in range(10):
            one_by_one[i, j] = values_at(0, float(x[i]), float(t[j]))
    values = values_at(0, x[:, None], t)
    assert values == pytest.approx(one_by_one, abs=1e-14)


def test_a_velocity_that_jumps_has_two_sides(vibrating_solution):
    """At a jump of the arriving wave, the velocity of a free end has the exact values
    before and after it; the wave leaves the end at once.
    """
    t = 1.3
    common = DRIFT + FALL * t
    before = vibrating_solution.velocity(0, 0.0, t, side="left")
    after = vibrating_solution.velocity(0, 0.0, t)
    wave_before = np.sin(VIBRATION * t)
    wave_after = 0.5 * (t - 2.5) ** 3
    assert before == pytest.approx(wave_before + common)
    assert after == pytest.approx(wave_after + common)


@pytest.mark.parametrize(("x", "t"), [(0.0, 5.5), (0.4, 0.0), (1.1, 2.35), (2.0, 4.9)])
def test_displacement_is_the_integral_of_velocity_and_of_strain(
    vibrating_solution, x, t
):
    """The displacement at x and t is the integral of the exact velocity over time and
    of the initial strain along x.
    """
    moved = integral(lambda t: velocity(x, t), 0.0, t, jumps_in_time(x))
    stretch = integral(lambda x: strain(x, 0.0), 0.0, x, jumps_along(0.0))
    expected = moved + stretch
    displacement = vibrating_solution.displacement(0, x, t)
    assert displacement == pytest.approx(expected, abs=1e-11)


def integral_along_rod(function, t):
    """Integral along the rod of a function of x that jumps with the state at t."""
    return integral(function, 0.0, LENGTH, jumps_along(t))


SOME_TIME = 3.21  # s: in the second period, at no jump


def mean_along_rod(t):
    """Mean velocity of the rod that vibrates, by its waves."""
    return integral_along_rod(lambda x: velocity(x, t), t) / LENGTH


def test_the_mean_velocity_is_that_along_the_rod(vibrating_solution):
    expected = mean_along_rod(SOME_TIME)
    mean = vibrating_solution.mean_velocity(0, SOME_TIME)
    assert mean == pytest.approx(expected, abs=1e-11)


def test_the_mean_velocity_grows_by_the_fall(vibrating_solution):
    """The mean velocity of a vibrating rod under gravity, less gravity times time, is
    the same at three times.
    """
    times = np.array([0.0, SOME_TIME, 5.5])
    mean = vibrating_solution.mean_velocity(0, times)
    without_fall = mean - FALL * times
    assert without_fall == pytest.approx(mean[0], abs=1e-11)


def test_energies_are_integrals_along_the_rod(vibrating_solution):
    """Vibrational kinetic energy and strain energy of a rod, at a time, are the
    integrals of its exact fields.
    """
    t = SOME_TIME
    mean = mean_along_rod(t)
    # The mass per length and E A are 1.
    kinetic = integral_along_rod(lambda x: (velocity(x, t) - mean) ** 2 / 2, t)
    elastic = integral_along_rod(lambda x: strain(x, t) ** 2 / 2, t)

    energy = vibrating_solution.energy(t)

    assert energy.vibrational_kinetic == pytest.approx(kinetic, abs=1e-11)
    assert energy.strain == pytest.approx(elastic, abs=1e-11)


def test_the_energy_balance_of_the_rod_closes(vibrating_solution):
    times = np.linspace(0, 5.5, 20)
    residuals = vibrating_solution.energy(times).residual
    assert residuals == pytest.approx(0.0, abs=1e-11)
    assert vibrating_solution.outcome.energy_residual == pytest.approx(0.0, abs=1e-11)


GAUGE = 0.45  # place of the gauge, m


@pytest.fixture(scope="module")
def gauge(vibrating_solution):
    """The record of a gauge on the rod that vibrates."""
    return vibrating_solution.gauge(0, GAUGE)


def times_away_from_jumps():
    """Random times of the run at which the state at the gauge does not jump, s."""
    t = np.random.default_rng(2).uniform(0, 5.5, 2000)
    return t[is_away_from_jumps(GAUGE, t)]


def test_a_gauge_follows_the_fields_and_its_waves_add_to_its_strain(
    vibrating_solution, gauge
):
    """A gauge of a vibrating rod has the exact strain away from jumps, the velocity of
    the solution, and waves that add to its strain.
    """
    t = times_away_from_jumps()
    expected_strain = strain(GAUGE, t)
    sum_of_waves = gauge.rightward + gauge.leftward
    expected_velocity = vibrating_solution.velocity(0, GAUGE, gauge.times)
    assert gauge.strain_at(t) == pytest.approx(expected_strain, abs=1e-11)
    assert gauge.strain == pytest.approx(sum_of_waves, abs=1e-14)
    assert gauge.velocity == pytest.approx(expected_velocity, abs=1e-11)


@pytest.mark.parametrize("field", FIELDS)
def test_straight_lines_between_times_of_a_gauge_follow_its_field(gauge, field):
    """Straight lines between the times of a gauge miss its exact field by less than 4
    `LINE_RTOL` of its range, from the start to the end of the run, with less than 3000
    times.
    """
    t = times_away_from_jumps()
    values = getattr(gauge, field)
    lines = np.interp(t, gauge.times, values)
    expected = FIELDS[field](GAUGE, t)
    error = np.abs(lines - expected).max()
    assert error < 4 * LINE_RTOL * np.ptp(values)
    assert gauge.times[0] == pytest.approx(0.0)
    assert gauge.times[-1] == pytest.approx(5.5)
    assert len(gauge.times) < 3000  # in 21 pieces of two waves


def test_the_strain_rate_of_a_gauge_leads_to_its_next_strain(vibrating_solution, gauge):
    """Strain after a time plus rate times interval is the strain before the next time."""
    changes = gauge.strain_rate[:-1] * np.diff(gauge.times)
    before_jumps = vibrating_solution.strain(0, GAUGE, gauge.times[1:], side="left")
    reached = gauge.strain_after[:-1] + changes
    assert reached == pytest.approx(before_jumps, abs=1e-6)


@pytest.mark.parametrize("field", FIELDS)
def test_averages_of_a_system_at_a_time_are_those_of_the_state(
    vibrating_solution, field
):
    """`system_at` at 2.2 s: the averages of its profile over 200 parts of the rod, and
    over all of it, are those of the exact field.
    """
    t = 2.2
    edges = np.linspace(0.0, LENGTH, 201)
    jumps = jumps_along(t)

    def exact(x):
        return FIELDS[field](x, t)

    (rod,) = vibrating_solution.system_at(t).bodies
    profile = getattr(rod, field)
    means = averages(profile, edges, LENGTH)

    part = LENGTH / 200  # m
    expected = []
    for start, stop in pairwise(edges):
        mean = integral(exact, start, stop, jumps) / part
        expected.append(mean)
    assert means == pytest.approx(np.array(expected), abs=1e-9)
    total = means.sum() * part
    expected_total = integral(exact, 0.0, LENGTH, jumps)
    assert total == pytest.approx(expected_total, abs=1e-9)


def test_a_state_of_constant_pieces_is_exact():
    """Each wave is 1 m/s until a quarter of the transit time before t = 0, then 2 m/s.

    So a quarter of the rod at either end has a wave of 2 m/s, and the middle none.
    """
    wave = Pieces([-TICKS, -(TICKS // 4)], [[1.0, 0.0], [2.0, 0.0]], TICKS)
    solution = solution_from_waves(ri.System([ROD]), wave, wave, 0.9)

    (rod,) = solution.system_at(0.0).bodies

    at_ends = (2.0 + 1.0) / 2 + DRIFT
    in_middle = (1.0 + 1.0) / 2 + DRIFT
    assert rod.velocity.values == (at_ends, in_middle, at_ends)
    assert rod.strain.values == (-0.5, 0.0, 0.5)
    assert rod.strain.at == pytest.approx((0.5, 1.5), rel=1e-14)


# The mass that strikes a rod
# --------------------------------------------------------------------------------------


def speed(t):
    """Velocity of the mass and of the end of the rod until the wave is back, at 4 s."""
    return SPEED * np.exp(-Z * t / MASS)


TIMES = np.linspace(0.0, 3.5, 50)


def test_force_impulse_and_work_of_a_contact_are_those_of_a_dashpot(struck_solution):
    """The rod is a dashpot for the mass; a rigid contact takes no energy."""
    force = Z * speed(TIMES)
    impulse = MASS * (SPEED - speed(TIMES))
    contact = struck_solution.contacts[0]
    assert contact.force(TIMES) == pytest.approx(force, abs=1e-12)
    assert contact.impulse_until(TIMES) == pytest.approx(impulse, abs=1e-12)
    assert contact.work_until(TIMES) == pytest.approx(0.0, abs=1e-12)


def test_straight_lines_between_breakpoints_follow_the_force_and_gaps_are_0(
    struck_solution,
):
    """Between the breakpoints of a contact, straight lines miss the exact force by 1e-4
    at most, and the gap is 0.
    """
    times, force, gap = struck_solution.contacts[0].breakpoints()
    between = np.linspace(0.0, 3.5, 1000)
    lines = np.interp(between, times, force)
    expected = Z * speed(between)
    assert lines == pytest.approx(expected, abs=1e-4 * SPEED)
    assert np.all(gap == 0)


def test_a_mass_and_the_end_of_the_rod_move_as_one_and_a_state_has_its_velocity(
    struck_solution,
):
    """A mass strikes a rod: its velocity decays as known, its displacement and that of
    the end of the rod are the integral of this, and the state at 1 s has the velocity.
    """
    moved = MASS * (SPEED - speed(TIMES)) / Z  # the integral of the velocity
    velocity_of_mass = struck_solution.velocity(0, 0.0, TIMES)
    displacement_of_mass = struck_solution.displacement(0, 0.0, TIMES)
    displacement_of_end = struck_solution.displacement(1, 0.0, TIMES)
    mass = struck_solution.system_at(1.0).bodies[0]
    assert velocity_of_mass == pytest.approx(speed(TIMES), abs=1e-12)
    assert displacement_of_mass == pytest.approx(moved, abs=1e-12)
    assert displacement_of_end == pytest.approx(moved, abs=1e-12)
    assert mass.velocity == pytest.approx(speed(1.0), abs=1e-12)


def test_energy_and_momentum_of_a_mass_and_a_rod_are_kept(struck_solution):
    """A mass strikes a rod: at all times the total energy is that of the mass, and
    momentum balances.
    """
    energy = struck_solution.energy(TIMES)
    energy_of_mass = MASS * SPEED**2 / 2
    assert energy.total == pytest.approx(energy_of_mass, abs=1e-11)
    assert energy.residual == pytest.approx(0.0, abs=1e-11)
    assert struck_solution.outcome.momentum_residual == pytest.approx(0.0, abs=1e-12)


def test_there_are_no_regions_of_constant_state(struck_solution):
    with pytest.raises(ValueError, match="no fronts to draw between"):
        ri.regions_of(struck_solution)


def test_a_run_without_duration_has_the_velocities_that_were_given():
    """A mass and a rod that touch do not yet have one velocity."""
    system = ri.System([ri.RigidMass(MASS, velocity=SPEED), ROD])
    solution = ri.solve(system, until=0.0)
    assert solution.velocity(0, 0.0, 0.0) == SPEED
