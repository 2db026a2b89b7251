"""Solutions whose waves are polynomials between breaks, beside closed forms.

A mass that strikes a rod, until the wave has come back, and a rod that vibrates for ever.
"""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebinterpolate
from scipy.integrate import quad

import rodimpact as ri
from rodimpact.methods.clock import Clock
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.run import Run, Signals, Waves
from rodimpact.methods.signals import Pieces
from rodimpact.model.profiles import averages
from rodimpact.results.solution import Solution

ROD = ri.Rod(
    2.0, area=0.5, material=ri.Material("unit", youngs_modulus=2.0, density=2.0)
)
T, TICKS = 2.0, (1 << 50) + 7  # transit in s and in ticks
TICK = T / TICKS
Z = 1.0
C = 1.0
MASS = 1.5
SPEED = 3.0
VIBRATION = 5.0
FALL = 0.7
DRIFT = 1.25


def pieces_of(function, marks):
    """A function of time, s, in pieces of degree 16 between marks, s."""
    ticks = [round(m / TICK) for m in marks]
    coefficients = [
        chebinterpolate(
            lambda y, a=a, b=b: function((a + b + (b - a) * y) / 2 * TICK), 16
        )
        for a, b in pairwise(ticks)
    ]
    return Pieces(ticks[:-1], coefficients, ticks[-1])


def solved(system, a, b, end):
    """The solution of a rod from the waves that leave its ends."""
    clock = Clock(
        build_row(system),
        TICK,
        [TICKS],
        DRIFT,
        SPEED,
        impedance=[0.0, Z, 0.0],
    )
    signals = Signals(Waves([None, None, a, b, None, None]), (), (None, None), None, {})
    return Solution(
        Run(
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
        ),
        ri.Options(end),
    )


@cache
def struck():
    """A mass that strikes a rod: the velocity of its face falls as exp(-Z t/M)."""
    row = ri.System([ri.RigidMass(MASS, velocity=SPEED), ROD])
    return ri.solve(row, 3.5, "characteristics", rtol=1e-12)


@cache
def vibrating():
    """A rod with free ends in free fall: each wave turns back as the other one, with its jump."""
    a = pieces_of(shape, [-2.0, -1.1, 0.0, 0.6, 1.3, 2.1, 3.0, 4.0, 4.7, 5.3, 5.9])
    b = pieces_of(
        lambda t: shape(t + T), [-2.0, -1.4, -0.7, 0.5, 2.0, 2.9, 3.3, 4.1, 5.0, 5.9]
    )
    return solved(ri.System([ROD], gravity=FALL), a, b, 5.5)


def shape(t):
    """The wave that leaves the left end of the rod that vibrates; it jumps at 0 and 1.3."""
    t = np.mod(t, 2 * T)
    return np.where(t < 1.3, np.sin(VIBRATION * t), 0.5 * (t - 2.5) ** 3)


def waves(x, t):
    """The waves that run right and left there and then."""
    return shape(t - x / C), shape(t + x / C)


def velocity(x, t):
    return sum(waves(x, t)) / 2 + DRIFT + FALL * t


def strain(x, t):
    right, left = waves(x, t)
    return (left - right) / (2 * C)


def integral(function, start, stop, breaks):
    """By SciPy, between the breaks."""
    edges = [start, *sorted(b for b in breaks if start < b < stop), stop]
    return sum(quad(function, a, b, epsabs=1e-13)[0] for a, b in pairwise(edges))


def jumps_in_time(x):
    return [
        n * 2 * T + j + s * x / C
        for n in (-1, 0, 1, 2)
        for j in (0.0, 1.3)
        for s in (-1, 1)
    ]


def jumps_along(t):
    return [
        s * C * (n * 2 * T + j - t)
        for n in (-1, 0, 1, 2)
        for j in (0.0, 1.3)
        for s in (-1, 1)
    ]


def away(x, t):
    """Whether no jump is near."""
    phase = np.mod(np.stack(np.broadcast_arrays(t - x / C, t + x / C)), 2 * T)
    near = [np.abs(phase - j) for j in (0.0, 1.3, 2 * T)]
    return np.min(near, axis=(0, 1)) > 1e-9


# The rod that vibrates


def test_velocity_and_strain_are_sums_of_waves():
    s = vibrating()
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 2, 500)
    t = rng.uniform(0, 5.5, 500)
    far = away(x, t)
    for field, known in ((s.velocity, velocity), (s.strain, strain)):
        assert field(0, x, t)[far] == pytest.approx(known(x, t)[far], abs=1e-11)
        places = np.sort(x)[:40]
        times = np.sort(t)[:30]
        one_by_one = np.array(
            [[field(0, place, when) for when in times] for place in places]
        )
        assert field(0, places[:, None], times) == pytest.approx(one_by_one, abs=1e-14)
    assert s.velocity(0, 0.0, 1.3, "left") == pytest.approx(
        np.sin(6.5) + DRIFT + FALL * 1.3
    )
    assert s.velocity(0, 0.0, 1.3) == pytest.approx(
        0.5 * -(1.2**3) + DRIFT + FALL * 1.3
    )


@pytest.mark.parametrize(("x", "t"), [(0.0, 5.5), (0.4, 0.0), (1.1, 2.35), (2.0, 4.9)])
def test_displacement_is_the_integral_of_velocity_and_of_strain(x, t):
    path = integral(lambda t: velocity(x, t), 0.0, t, jumps_in_time(x))
    stretch = integral(lambda x: strain(x, 0.0), 0.0, x, jumps_along(0.0))
    assert vibrating().displacement(0, x, t) == pytest.approx(path + stretch, abs=1e-11)


def test_momentum_and_energy_are_integrals_along_the_rod():
    s = vibrating()
    t = 3.21
    mean = integral(lambda x: velocity(x, t), 0.0, 2.0, jumps_along(t)) / 2
    assert s.mean_velocity(0, t) == pytest.approx(mean, abs=1e-11)
    assert s.mean_velocity(0, [0.0, t, 5.5]) - FALL * np.array(
        [0, t, 5.5]
    ) == pytest.approx(s.mean_velocity(0, 0.0), abs=1e-11)
    book = s.energy(t)
    kinetic = integral(
        lambda x: (velocity(x, t) - mean) ** 2 / 2, 0.0, 2.0, jumps_along(t)
    )
    strained = integral(lambda x: strain(x, t) ** 2 / 2, 0.0, 2.0, jumps_along(t))
    assert (book.vibrational_kinetic, book.strain) == pytest.approx(
        (kinetic, strained), abs=1e-11
    )
    assert s.energy(np.linspace(0, 5.5, 20)).residual == pytest.approx(0.0, abs=1e-11)
    assert s.outcome.energy_residual == pytest.approx(0.0, abs=1e-11)


def test_a_gauge_follows_the_strain():
    s = vibrating()
    x = 0.45
    gauge = s.gauge(0, x)
    t = np.random.default_rng(2).uniform(0, 5.5, 2000)
    t = t[away(x, t)]
    assert gauge.strain_at(t) == pytest.approx(strain(x, t), abs=1e-11)
    assert gauge.strain == pytest.approx(gauge.rightward + gauge.leftward, abs=1e-14)
    assert gauge.velocity == pytest.approx(s.velocity(0, x, gauge.times), abs=1e-11)
    for values, known in ((gauge.strain, strain), (gauge.velocity, velocity)):
        lines = np.interp(t, gauge.times, values)
        assert np.abs(lines - known(x, t)).max() < 2e-4 * np.ptp(values)
    assert (gauge.times[0], gauge.times[-1]) == pytest.approx((0.0, 5.5))
    assert len(gauge.times) < 3000
    slopes = gauge.strain_rate[:-1] * np.diff(gauge.times)
    assert gauge.strain_after[:-1] + slopes == pytest.approx(
        s.strain(0, x, gauge.times[1:], side="left"), abs=1e-6
    )


def test_a_system_at_a_time_holds_the_state():
    s = vibrating()
    t = 2.2
    rod = s.system_at(t).bodies[0]
    places = np.linspace(0.0, 2.0, 201)
    jumps = jumps_along(t)
    for profile, known in ((rod.velocity, velocity), (rod.strain, strain)):
        means = averages(profile, places, 2.0)
        wanted = [
            integral(lambda x, known=known: known(x, t), a, b, jumps) / (b - a)
            for a, b in pairwise(places)
        ]
        assert means == pytest.approx(np.array(wanted), abs=1e-9)
        whole = integral(lambda x, known=known: known(x, t), 0.0, 2.0, jumps)
        assert means.sum() * places[1] == pytest.approx(whole, abs=1e-9)


def test_a_state_of_constant_pieces_is_exact():
    wave = Pieces([-TICKS, -(TICKS // 4)], [[1.0, 0.0], [2.0, 0.0]], TICKS)
    rod = solved(ri.System([ROD]), wave, wave, 0.9).system_at(0.0).bodies[0]
    assert rod.velocity.values == (1.5 + DRIFT, 1.0 + DRIFT, 1.5 + DRIFT)
    assert rod.strain.values == (-0.5, 0.0, 0.5)
    assert rod.strain.at == pytest.approx((0.5, 1.5), rel=1e-14)


# The mass that strikes a rod


def speed(t):
    """Of the mass and of the end of the rod."""
    return SPEED * np.exp(-Z * t / MASS)


def test_force_and_work_of_a_contact():
    contact = struck().contacts[0]
    t = np.linspace(0.0, 3.5, 50)
    assert contact.force(t) == pytest.approx(Z * speed(t), abs=1e-12)
    assert contact.impulse_until(t) == pytest.approx(
        MASS * (SPEED - speed(t)), abs=1e-12
    )
    assert contact.work_until(t) == pytest.approx(0.0, abs=1e-12)
    times, force, gap = contact.breakpoints()
    dense = np.linspace(0.0, 3.5, 1000)
    assert np.interp(dense, times, force) == pytest.approx(
        Z * speed(dense), abs=1e-4 * SPEED
    )
    assert (gap == 0).all()


def test_motion_of_a_mass():
    s = struck()
    t = np.linspace(0.0, 3.5, 50)
    assert s.velocity(0, 0.0, t) == pytest.approx(speed(t), abs=1e-12)
    assert s.displacement(0, 0.0, t) == pytest.approx(
        MASS * (SPEED - speed(t)) / Z, abs=1e-12
    )
    assert s.displacement(1, 0.0, t) == pytest.approx(
        MASS * (SPEED - speed(t)) / Z, abs=1e-12
    )
    book = s.energy(t)
    start = MASS * SPEED**2 / 2
    assert book.total == pytest.approx(start, abs=1e-11)
    assert book.residual == pytest.approx(0.0, abs=1e-11)
    assert s.outcome.momentum_residual == pytest.approx(0.0, abs=1e-12)
    assert s.system_at(1.0).bodies[0].velocity == pytest.approx(speed(1.0), abs=1e-12)


def test_there_are_no_regions_of_constant_state():
    with pytest.raises(ValueError, match="no fronts to draw between"):
        ri.regions_of(struck())


def test_a_run_without_duration_has_the_velocities_that_were_given():
    struck = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    row = ri.System([ri.RigidMass(0.5, velocity=1.0), struck])
    assert ri.solve(row, until=0.0).velocity(0, 0.0, 0.0) == 1.0
