"""The first mode of Pochhammer and Chree against its equation in complex numbers and its limits."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jv

import rodimpact as ri
from rodimpact import waves

STEEL = ri.materials.steel.replace(poisson_ratio=0.29)
RATIOS = [0.0, 0.1, 0.25, 0.29, 0.345, 0.45, 0.5]
TABLE = {  # c/c0 over a/wavelength; the second is Bancroft's bar of 1941
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
    """Left-hand side at c = x c0 as it stands in books, with a = c0 = 1, over its largest term."""
    A, B = (
        np.sqrt(G**2 * (x**2 * s - 1) + 0j)
        for s in ((1 + nu) * (1 - 2 * nu) / (1 - nu), 2 * (1 + nu))
    )
    terms = (
        2 * A * (B**2 + G**2) * jv(1, A) * jv(1, B),
        -((B**2 - G**2) ** 2) * jv(0, A) * jv(1, B),
        -4 * G**2 * A * B * jv(1, A) * jv(0, B),
    )
    return abs(sum(terms)) / (max(map(abs, terms)) or math.inf)


@pytest.mark.parametrize("nu", RATIOS)
def test_solves_the_equation_and_nothing_slower_does(nu):
    places = np.array([0.03, 0.17, 0.3, 0.42, 0.58, 0.77, 1.0, 1.9])
    for s, x in zip(places, waves.first_mode(places, nu), strict=True):
        G = 2 * math.pi * s
        assert pochhammer_chree(x, G, nu) < 1e-9
        slower = np.linspace(0.9 * waves.rayleigh_speed(nu), x - 1e-3, 50)
        assert min(pochhammer_chree(y, G, nu) for y in slower) > 1e-5


@pytest.mark.parametrize(("nu", "table"), TABLE.items())
def test_the_table(nu, table):
    ratios = waves.first_mode(list(table), nu)
    np.testing.assert_allclose(ratios, list(table.values()), rtol=0, atol=3.2e-5)


@pytest.mark.parametrize("nu", RATIOS[1:])
def test_long_and_short_waves(nu):
    G = 1e-3
    assert 1 - waves.first_mode(G / (2 * math.pi), nu) == pytest.approx(
        nu**2 * G**2 / 4, rel=1e-5
    )
    assert waves.first_mode(0.0, nu) == 1
    assert waves.first_mode(500.0, nu) == pytest.approx(
        waves.rayleigh_speed(nu), rel=2e-4
    )


def test_frequencies_and_wave_numbers_of_a_bar():
    bar = waves.Bar(5000.0, 0.29, 0.01)
    f = np.linspace(0.0, 2 * bar.cut_off, 301)
    k = bar.wavenumber(f)
    c = bar.phase_velocity(f)
    group = bar.group_velocity(f)
    np.testing.assert_allclose(k * c, 2 * math.pi * f, rtol=1e-13)
    np.testing.assert_allclose(
        waves.first_mode(k * bar.radius / (2 * math.pi), 0.29), c / 5000.0, rtol=1e-11
    )
    middle = (f[2:] - f[:-2]) * 2 * math.pi / (k[2:] - k[:-2])
    np.testing.assert_allclose(group[1:-1], middle, rtol=2e-3)
    assert (c[0], group[0], k[0]) == (5000.0, 5000.0, 0.0)
    assert isinstance(bar.phase_velocity(1e3), float)
    below = f[f <= bar.cut_off]
    exact = 1 / bar.phase_velocity(below) - 1 / 5000.0
    np.testing.assert_allclose(bar.delays(below), exact, rtol=0, atol=1e-8 / 5000.0)


def test_a_bar_of_a_rod():
    rod = ri.Rod(1.0, diameter=0.02, material=STEEL)
    round_bar = waves.Bar.of(rod)
    assert round_bar.radius == pytest.approx(0.01, rel=1e-14)
    assert (round_bar.wave_speed, round_bar.poisson_ratio) == (STEEL.wave_speed, 0.29)
    assert waves.Bar.of(rod.segments[0]) == round_bar
    square = ri.Rod(1.0, area=1e-4, material=STEEL)
    assert waves.Bar.of(square, radius=6e-3).radius == 6e-3


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.29, 0.45])
def test_mindlin_herrmann_against_a_matrix(nu):
    """Roots of det(K - omega^2 M) for u = exp(i k x), q = i exp(i k x); a = E = rho = 1."""
    s = np.array([1e-3, 0.05, 0.3, 2.0, 1e150])
    slow, fast = waves.mindlin_herrmann(s, nu)
    lame = nu / ((1 + nu) * (1 - 2 * nu))
    mu = 1 / (2 + 2 * nu)
    for k, *found in zip(2 * np.pi * s[:-1], slow, fast, strict=False):
        K = [
            [(lame + 2 * mu) * k * k, 2 * lame * k],
            [2 * lame * k, 4 * (lame + mu) + 0.81 * mu * k * k / 2],
        ]
        assert found == pytest.approx(
            np.sqrt(eigh(K, np.diag([1, 0.81]))[0]) / k, rel=1e-9
        )
    ends = sorted([np.sqrt(lame + 2 * mu), np.sqrt(mu / 2)])
    assert [slow[-1], fast[-1]] == pytest.approx(ends, rel=1e-12)
    assert waves.mindlin_herrmann(0.0, nu) == (1.0, np.inf)
    factor = 1.62 - 0.81 / (2 + 2 * nu)  # of the dispersion of long waves
    assert slow[0] == pytest.approx(1 - factor * (nu * np.pi * 1e-3) ** 2, abs=1e-9)


def test_mindlin_herrmann_is_near_the_first_mode():
    s = np.linspace(0.01, 0.6, 30)[:, None]
    nu = np.array([0.25, 0.29, 0.33, 0.345])
    apart = waves.mindlin_herrmann(s, nu)[0] - waves.first_mode(s, nu)
    assert 0.009 < np.abs(apart).max() <= 0.01


ROUND = "bar: must be a uniform Rod"


@pytest.mark.parametrize(
    ("call", "said"),
    [
        *(
            (lambda bar=bar: waves.Bar.of(bar), said)
            for bar, said in (
                (
                    ri.Rod(1.0, area=1e-4, material=STEEL),
                    "bar.section: is not said to be round; .*radius=, the equivalent radius",
                ),
                (
                    ri.Rod(
                        1.0,
                        area=1e-4,
                        material=ri.Material("x", youngs_modulus=1e9, density=1e3),
                    ),
                    "bar.material.poisson_ratio: is missing in 'x'",
                ),
                (
                    ri.Rod(1.0, area=ri.Steps([1e-4, 2e-4], [0.5]), material=STEEL),
                    ROUND,
                ),
                (ri.Rod(1.0, area=ri.Samples([1e-4, 2e-4]), material=STEEL), ROUND),
                (3, ROUND + " or Segment, or a waves.Bar, got 3"),
            )
        ),
        (
            lambda: waves.mindlin_herrmann(1.0, 0.5),
            r"poisson_ratio: must lie in \(-1, 0.5\), got 0",
        ),
        (
            lambda: waves.first_mode(-1.0, 0.3),
            "radius_over_wavelength: must be a finite non-neg",
        ),
        (
            lambda: waves.first_mode(1.0, 0.6),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.6",
        ),
        (lambda: waves.first_mode([1, 2], [0.1, 0.2, 0.3]), "do not broadcast"),
        (
            lambda: waves.rayleigh_speed(-0.1),
            r"poisson_ratio: must lie in \[0, 0.5\], got -0.1",
        ),
        (
            lambda: waves.Bar(5000.0, 0.3, 0.01).wavenumber(-1.0),
            "frequency: must be .*, got -1.0",
        ),
        (
            lambda: waves.Bar(5000.0, 0.7, 0.01),
            r"poisson_ratio: must lie in \[0, 0.5\], got 0.7",
        ),
        (
            lambda: waves.Bar(5000.0, 0.3, [0.01, 0.02]),
            "radius: must be a single number",
        ),
    ],
)
def test_wrong_arguments(call, said):
    with pytest.raises(ValueError, match=said):
        call()
