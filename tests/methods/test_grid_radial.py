"""Lateral inertia by Mindlin and Herrmann on a grid: limits, symmetries, and the stable
step.
"""

import math

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import matrices
from scipy.linalg import eigh

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh, lasting_mode, most_cells, stable_step
from rodimpact.methods.grid.method import run_grid
from rodimpact.methods.row_builder import build_row

METHOD = "finite-difference"
THEORY = "mindlin-herrmann"
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0, poisson_ratio=0.3)


def segment(length, radius=0.05, material=UNIT, theory=THEORY):
    """A round segment; without a `theory` it has no lateral inertia."""
    return ri.Segment(
        length, material=material, diameter=2 * radius, lateral_inertia=theory
    )


def rod(*segments, **options):
    """A rod of these segments."""
    return ri.Rod(segments=list(segments), **options)


def exact_stable_step(segments, counts):
    """Largest stable step, s, of a rod of these segments with so many cells in each.

    It is 2 over the largest angular frequency, from the whole matrices of the mesh.
    """
    system = ri.System([rod(*segments)])
    row = build_row(system)
    mesh = Mesh(row, counts)
    M, _, K = matrices(mesh)
    every_node = np.ones(len(mesh.mass), bool)
    has_radial_motion = mesh.cells.radial_inertia[1:-1] > 0  # [cell]
    is_in_motion = np.append(every_node, has_radial_motion)
    chosen = np.ix_(is_in_motion, is_in_motion)
    eigenvalues = eigh(K[chosen], M[chosen], eigvals_only=True)
    largest_frequency = math.sqrt(eigenvalues[-1])
    return 2 / largest_frequency


@pytest.mark.parametrize("count", few_of([3, 10, 40, 100], [3, 10, 40]))
def test_the_stable_step_is_that_of_the_fastest_motion_and_gives_the_cells(count):
    """Coarse cells are bound by the cut-off of the second branch, fine ones by its
    waves. `count` cells are the most, of up to ten times as many, for a step as long.
    """
    piece = segment(1.0)
    exact = exact_stable_step([piece], [count])

    step = stable_step(piece, count)
    just_shorter = step * (1 - 1e-9)
    cells = most_cells(piece, 10 * count, just_shorter)

    assert step == pytest.approx(exact, rel=2e-3)
    assert step <= exact * (1 + 1e-12)
    assert cells == count


def test_the_stable_step_is_none_too_long_where_sections_and_theories_differ():
    """The shortest step of four unlike segments is at most that of their whole
    matrices, and 90 % of it at least.
    """
    section = {"polar_moment": "circular", "lateral_inertia": THEORY}
    taper = ri.Samples([0.02, 0.004])  # areas, m^2
    cone = ri.Segment(0.5, area=taper, material=UNIT, **section)
    thick = segment(0.3, radius=0.1)
    without_inertia = segment(0.2, theory=None)
    segments = [segment(0.5), cone, thick, without_inertia]
    counts = [20, 9, 5, 4]

    step = min(map(stable_step, segments, counts))

    exact = exact_stable_step(segments, counts)
    assert 0.9 < step / exact <= 1 + 1e-12


def test_a_step_too_long_for_the_radial_motion_is_refused():
    uniform = rod(segment(1.0))
    system = ri.System([uniform])
    with pytest.raises(ri.InvalidModel, match=r"would be unstable in bodies\.0, where"):
        ri.solve(system, until=1.0, method=METHOD, dt=0.06)


def test_a_held_rod_strained_evenly_stays_at_rest():
    """w = -nu a u_x at the start: the radius is that of slow stretching."""
    strain = 1e-3
    radius = 0.05
    piece = segment(1.0, radius=radius)
    strained = rod(piece, strain=strain)
    fixed_ends = (ri.Fixed(), ri.Fixed())
    system = ri.System([strained], ends=fixed_ends)
    area = math.pi * radius**2
    strain_energy = area * strain**2 / 2  # J, of 1 m with E = 1 Pa

    solution = ri.solve(system, until=1.0, method=METHOD, cells=40)
    row = build_row(system)
    run = run_grid(row, 1.0, max_events=10**9, cells=40)

    x = np.linspace(0, 1, 21)[:, None]
    t = np.linspace(0, 1, 11)
    velocity = solution.velocity(0, x, t)
    assert np.abs(velocity).max() <= 1e-15
    strain_found = solution.strain(0, x, t)
    assert strain_found == pytest.approx(strain, abs=1e-15)
    energy = solution.energy(t)
    assert energy.strain == pytest.approx(strain_energy, rel=1e-12)
    assert run.largest_strain == pytest.approx(strain, rel=1e-12)


def test_a_collision_of_thin_rods_is_proved_over_and_ends_like_that_of_ideal_ones():
    """Two thin rods with radial inertia are solved on a grid. The solution is final,
    and the restitution is the ratio of their lengths, as for ideal rods of equal
    section, to 0.01; energy balances.
    """
    short = segment(0.4, radius=0.01)
    long = segment(1.0, radius=0.01)
    striker = rod(short, velocity=1.0)
    system = ri.System([striker, rod(long)])

    solution = ri.solve(system, method=METHOD, cells=100)

    outcome = solution.outcome
    assert solution.final
    ratio_of_lengths = 0.4 / 1.0
    assert outcome.restitution == pytest.approx(ratio_of_lengths, abs=0.01)
    assert abs(outcome.energy_residual) <= 1e-12
    assert outcome.numerical > 0  # J: jumps lose energy on a grid


LOSSY = UNIT.replace(viscosity=1e-3)
SPEED_OF_LOWEST_MODE = float(ri.waves.mindlin_herrmann(0.05, 0.3)[0])
"""Speed of waves 2 m long in a rod of 1 m; the radius, 0.1 m, is 0.05 of the length."""


@pytest.mark.parametrize(
    ("segments", "omega", "share"),
    [
        pytest.param(
            [segment(1.0, radius=0.1, material=LOSSY)],
            math.pi * SPEED_OF_LOWEST_MODE,
            1.0,
            id="with lateral inertia",
        ),
        pytest.param(
            [segment(0.2, radius=0.1, material=LOSSY, theory=None)],
            math.pi / 0.2,
            1.0,
            id="without",
        ),
        # The strain energy of the lowest mode is the same in either half.
        pytest.param(
            [
                segment(0.5, radius=0.1, material=UNIT, theory=None),
                segment(0.5, radius=0.1, material=LOSSY, theory=None),
            ],
            math.pi,
            0.5,
            id="half of the material damps",
        ),
    ],
)
def test_the_mode_that_lasts_longest_is_the_lowest_of_the_rod(segments, omega, share):
    """`lasting_mode` gives its angular frequency and the rate at which it decays;
    `share` is the part of its strain energy that is damped.
    """
    decay_if_all_damps = ri.theory.kelvin_voigt_decay(1.0, 1e-3, omega)

    frequency, rate = lasting_mode(segments)

    assert frequency == pytest.approx(omega, rel=3e-4)
    expected_rate = share * decay_if_all_damps
    assert rate == pytest.approx(expected_rate, rel=1e-2)
