"""The first mode of Pochhammer and Chree against its equation in complex numbers and
its limits.
"""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jv

import rodimpact as ri
from rodimpact import waves

STEEL = ri.materials.steel.replace(poisson_ratio=0.29)
RATIOS = [0.0, 0.1, 0.25, 0.29, 0.345, 0.45, 0.5]
TABLE = {  # c/c0 by nu and a/wavelength; that of 0.29 is Bancroft's bar of 1941
    0.25: {
        0.05: 0.998428,
        0.1: 0.993330,
        0.2: 0.965585,
        0.3: 0.886809,
        0.5: 0.693445,
        0.6: 0.647116,
        0.8: 0.604799,
        1.0: 0.589328,
    },
    0.29: {
        0.05: 0.99789,
        0.1: 0.99113,
        0.15: 0.97826,
        0.2: 0.95645,
        0.25: 0.92175,
        0.3: 0.87299,
        0.4: 0.76558,
        0.5: 0.68927,
        0.6: 0.64404,
        0.8: 0.60188,
        1.0: 0.58607,
    },
    0.345: {
        0.05: 0.997026,
        0.1: 0.987661,
        0.2: 0.943386,
        0.3: 0.854995,
        0.5: 0.682675,
        0.6: 0.639166,
        0.8: 0.597548,
        1.0: 0.581443,
    },
}


def pochhammer_chree(x, G, nu):
    """Left-hand side of the equation of Pochhammer and Chree, over its largest term.

    It is taken at the phase velocity x c0, as it stands in books; G = 2 pi a/wavelength
    is the wave number for the radius a = 1. It is 0 where a wave can run.
    """
    dilatation = (1 + nu) * (1 - 2 * nu) / (1 - nu)  # (c0/c1)^2
    shear = 2 * (1 + nu)  # (c0/c2)^2
    A = np.sqrt(G**2 * (x**2 * dilatation - 1) + 0j)
    B = np.sqrt(G**2 * (x**2 * shear - 1) + 0j)
    terms = np.array(
        [
            2 * A * (B**2 + G**2) * jv(1, A) * jv(1, B),
            -((B**2 - G**2) ** 2) * jv(0, A) * jv(1, B),
            -4 * G**2 * A * B * jv(1, A) * jv(0, B),
        ]
    )
    largest = np.abs(terms).max()
    if largest == 0:
        return 0.0
    return abs(terms.sum()) / largest


RADII = np.array([0.03, 0.17, 0.3, 0.42, 0.58, 0.77, 1.0, 1.9])
"""Radii over the wavelength."""


@pytest.mark.parametrize("nu", RATIOS)
def test_the_first_mode_solves_its_equation_and_nothing_slower_does(nu):
    slowest = 0.9 * waves.rayleigh_speed(nu)
    for radius, speed in zip(RADII, waves.first_mode(RADII, nu), strict=True):
        G = 2 * math.pi * radius
        assert pochhammer_chree(speed, G, nu) < 1e-9
        slower = np.linspace(slowest, speed - 1e-3, 50)
        assert min(pochhammer_chree(x, G, nu) for x in slower) > 1e-5


@pytest.mark.parametrize(("nu", "table"), TABLE.items())
def test_the_first_mode_has_the_phase_velocities_of_the_tables(nu, table):
    speeds = waves.first_mode(list(table), nu)
    np.testing.assert_allclose(speeds, list(table.values()), rtol=0, atol=3.2e-5)


@pytest.mark.parametrize("nu", RATIOS[1:])
def test_long_waves_of_the_first_mode_are_as_rayleigh_says_short_ones_on_a_surface(nu):
    """Long ones are slower than c0 by nu^2 G^2/4 of it, G the wave number times the
    radius.
    """
    G = 1e-3
    slower_by = 1 - waves.first_mode(G / (2 * math.pi), nu)
    assert slower_by == pytest.approx(nu**2 * G**2 / 4, rel=1e-5)
    assert waves.first_mode(0.0, nu) == 1
    short = waves.first_mode(500.0, nu)
    assert short == pytest.approx(waves.rayleigh_speed(nu), rel=2e-4)


@pytest.fixture(scope="module")
def bar():
    return waves.Bar(5000.0, 0.29, 0.01)


@pytest.fixture(scope="module")
def frequencies(bar):
    return np.linspace(0.0, 2 * bar.cut_off, 151)


def test_wave_numbers_and_phase_velocities_of_a_bar_are_those_of_the_first_mode(
    bar, frequencies
):
    k = bar.wavenumber(frequencies)
    c = bar.phase_velocity(frequencies)
    np.testing.assert_allclose(k * c, 2 * math.pi * frequencies, rtol=1e-13)
    first_mode = waves.first_mode(k * bar.radius / (2 * math.pi), 0.29)
    np.testing.assert_allclose(first_mode, c / 5000.0, rtol=1e-11)
    assert k[0] == 0.0
    assert c[0] == 5000.0
    assert isinstance(bar.phase_velocity(1e3), float)


def test_the_group_velocity_is_the_slope_of_the_frequency(bar, frequencies):
    k = bar.wavenumber(frequencies)
    group = bar.group_velocity(frequencies)
    omega = 2 * math.pi * frequencies
    slope = (omega[2:] - omega[:-2]) / (k[2:] - k[:-2])
    np.testing.assert_allclose(group[1:-1], slope, rtol=2e-3)
    assert group[0] == 5000.0


def test_delays_of_a_bar_are_those_of_its_phase_velocity(bar, frequencies):
    below = frequencies[frequencies <= bar.cut_off]
    exact = 1 / bar.phase_velocity(below) - 1 / 5000.0
    np.testing.assert_allclose(bar.delays(below), exact, rtol=0, atol=1e-8 / 5000.0)


def test_a_bar_takes_its_numbers_from_a_round_rod_or_segment_or_a_given_radius():
    rod = ri.Rod(1.0, diameter=0.02, material=STEEL)
    round_bar = waves.Bar.of(rod)
    assert round_bar.radius == pytest.approx(0.01, rel=1e-14)
    assert round_bar.wave_speed == STEEL.wave_speed
    assert round_bar.poisson_ratio == 0.29
    assert waves.Bar.of(rod.segments[0]) == round_bar
    square = ri.Rod(1.0, area=1e-4, material=STEEL)
    assert waves.Bar.of(square, radius=6e-3).radius == 6e-3


def mindlin_herrmann_matrices(k, nu):
    """Stiffness and mass of u = exp(i k x), q = i exp(i k x); a = E = rho = 1.

    u is the axial displacement and q the radial one; the factors of the theory are
    m = 2 * 0.81 of the radial inertia and s = 0.81 of the shear.
    """
    lame = nu / ((1 + nu) * (1 - 2 * nu))
    mu = 1 / (2 + 2 * nu)
    coupling = 2 * lame * k
    axial = (lame + 2 * mu) * k * k
    radial = 4 * (lame + mu) + 0.81 * mu * k * k / 2
    return [[axial, coupling], [coupling, radial]], np.diag([1, 0.81])


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_both_speeds_of_mindlin_and_herrmann_are_roots_of_their_determinant(nu):
    """That of K - omega^2 M, stiffness and mass."""
    radii = np.array([1e-3, 0.05, 0.3, 2.0])
    slow, fast = waves.mindlin_herrmann(radii, nu)
    for k, slow_speed, fast_speed in zip(2 * np.pi * radii, slow, fast, strict=True):
        stiffness, mass = mindlin_herrmann_matrices(k, nu)
        squares, _ = eigh(stiffness, mass)
        speeds = np.sqrt(squares) / k
        assert [slow_speed, fast_speed] == pytest.approx(speeds, rel=1e-9)


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_speeds_of_mindlin_and_herrmann_have_their_limits_for_long_and_short_waves(nu):
    lame = nu / ((1 + nu) * (1 - 2 * nu))
    mu = 1 / (2 + 2 * nu)
    of_short_waves = sorted([np.sqrt(lame + 2 * mu), np.sqrt(mu / 2)])
    speeds = waves.mindlin_herrmann(1e150, nu)
    assert list(speeds) == pytest.approx(of_short_waves, rel=1e-12)

    assert waves.mindlin_herrmann(0.0, nu) == (1.0, np.inf)
    slow, _ = waves.mindlin_herrmann(1e-3, nu)
    dispersion = 1.62 - 0.81 * mu
    assert slow == pytest.approx(1 - dispersion * (nu * np.pi * 1e-3) ** 2, abs=1e-9)


def test_slow_waves_of_mindlin_and_herrmann_are_within_a_percent_of_the_first_mode():
    radii = np.linspace(0.01, 0.6, 30)[:, None]
    nu = np.array([0.25, 0.29, 0.33, 0.345])
    slow, _ = waves.mindlin_herrmann(radii, nu)
    largest = np.abs(slow - waves.first_mode(radii, nu)).max()
    assert 0.009 < largest <= 0.01  # as `rodimpact.model.lateral_inertia` states it


NOT_UNIFORM = "bar: must be a uniform Rod"
UNKNOWN = ri.Material("x", youngs_modulus=1e9, density=1e3)


@pytest.mark.parametrize(
    ("bar", "message"),
    [
        pytest.param(
            ri.Rod(1.0, area=1e-4, material=STEEL),
            "bar.section: is not said to be round; .*radius=, the equivalent radius",
            id="not round",
        ),
        pytest.param(
            ri.Rod(1.0, area=1e-4, material=UNKNOWN),
            "bar.material.poisson_ratio: is missing in 'x'",
            id="no Poisson ratio",
        ),
        pytest.param(
            ri.Rod(1.0, area=ri.Steps([1e-4, 2e-4], [0.5]), material=STEEL),
            NOT_UNIFORM,
            id="stepped",
        ),
        pytest.param(
            ri.Rod(1.0, area=ri.Samples([1e-4, 2e-4]), material=STEEL),
            NOT_UNIFORM,
            id="tapered",
        ),
        pytest.param(
            3, NOT_UNIFORM + " or Segment, or a waves.Bar, got 3", id="number"
        ),
    ],
)
def test_what_is_no_bar_is_refused(bar, message):
    with pytest.raises(ValueError, match=message):
        waves.Bar.of(bar)


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (
            waves.mindlin_herrmann,
            (1.0, 0.5),
            r"poisson_ratio: must lie in \(-1, 0.5\), got 0",
        ),
        (
            waves.first_mode,
            (-1.0, 0.3),
            "radius_over_wavelength: must be a finite non-neg",
        ),
        (
            waves.first_mode,
            (1.0, 0.6),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.6",
        ),
        (waves.first_mode, ([1, 2], [0.1, 0.2, 0.3]), "do not broadcast"),
        (
            waves.rayleigh_speed,
            (-0.1,),
            r"poisson_ratio: must lie in \[0, 0.5\], got -0.1",
        ),
        (
            waves.Bar(5000.0, 0.3, 0.01).wavenumber,
            (-1.0,),
            "frequency: must be .*, got -1.0",
        ),
        (
            waves.Bar,
            (5000.0, 0.7, 0.01),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.7",
        ),
        (
            waves.Bar,
            (5000.0, 0.3, [0.01, 0.02]),
            "radius: must be a single number",
        ),
    ],
)
def test_wrong_arguments_of_waves_are_refused(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        function(*arguments)
