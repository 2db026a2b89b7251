"""Lateral inertia by Mindlin and Herrmann on a grid: limits, symmetries, and the stable
step.
"""

import math

import numpy as np
import pytest
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
    return ri.Segment(
        length, None, material, diameter=2 * radius, lateral_inertia=theory
    )


def rod(*pieces, **options):
    return ri.Rod(segments=list(pieces), **options)


def solved(bodies, until=1.0, contacts=None, **mesh):
    return ri.solve(
        ri.System(bodies, contacts=contacts), until, METHOD, **mesh or {"dt": 0.008}
    )


def fastest(mesh):
    """Largest angular frequency of a mesh, from its whole matrices."""
    M, _, K = matrices(mesh)
    every_node = np.ones(len(mesh.mass), bool)
    has_radial_motion = mesh.cells.radial_inertia[1:-1] > 0
    is_in_motion = np.append(every_node, has_radial_motion)
    chosen = np.ix_(is_in_motion, is_in_motion)
    eigenvalues = eigh(K[chosen], M[chosen], eigvals_only=True)
    return math.sqrt(eigenvalues[-1])


def mesh_of(pieces, counts):
    """Mesh of a rod of these segments, with so many cells in each."""
    row = build_row(ri.System([rod(*pieces)]))
    return Mesh(row, counts)


@pytest.mark.parametrize("count", [3, 10, 40, 100])
def test_the_stable_step_is_that_of_the_fastest_motion(count):
    """Coarse cells are bound by the cut-off of the second branch, fine ones by its
    waves.
    """
    piece = segment(1.0)
    exact = 2 / fastest(mesh_of([piece], [count]))

    step = stable_step(piece, count)

    assert step == pytest.approx(exact, rel=2e-3)
    assert step <= exact * (1 + 1e-12)
    assert most_cells(piece, 10 * count, step * (1 - 1e-9)) == count


def test_the_stable_step_holds_where_sections_and_theories_differ():
    section = {"polar_moment": "circular", "lateral_inertia": THEORY}
    cone = ri.Segment(0.5, ri.Samples([0.02, 0.004]), UNIT, **section)
    pieces = [segment(0.5), cone, segment(0.3, 0.1), segment(0.2, theory=None)]
    counts = [20, 9, 5, 4]

    step = min(map(stable_step, pieces, counts))

    largest_step = 2 / fastest(mesh_of(pieces, counts))
    assert 0.9 < step / largest_step <= 1 + 1e-12


def test_a_step_beyond_the_radial_motion_is_refused():
    with pytest.raises(ri.InvalidModel, match=r"would be unstable in bodies\.0, where"):
        solved([rod(segment(1.0))], dt=0.06)


def test_a_held_rod_strained_evenly_stays_at_rest():
    """w = -nu a u_x at the start: the radius is that of slow stretching."""
    strained = rod(segment(1.0), strain=1e-3)
    system = ri.System([strained], ends=(ri.Fixed(), ri.Fixed()))

    solution = ri.solve(system, 1.0, METHOD, cells=40)
    run = run_grid(build_row(system), 1.0, 10**9, cells=40)

    x = np.linspace(0, 1, 21)[:, None]
    t = np.linspace(0, 1, 11)
    strain_energy = math.pi * 0.05**2 * 1e-6 / 2
    assert np.abs(solution.velocity(0, x, t)).max() <= 1e-15
    assert solution.strain(0, x, t) == pytest.approx(1e-3, abs=1e-15)
    assert solution.energy(t).strain == pytest.approx(strain_energy, rel=1e-12)
    assert run.largest_strain == pytest.approx(1e-3, rel=1e-12)


def test_a_collision_of_thin_rods_is_proved_to_be_over_and_ends_like_that_of_ideal_ones():
    first = rod(segment(0.4, 0.01), velocity=1.0)
    second = rod(segment(1.0, 0.01))

    solution = ri.solve(ri.System([first, second]), method=METHOD, cells=100)

    outcome = solution.outcome
    assert solution.final
    assert outcome.restitution == pytest.approx(0.4, abs=0.01)
    assert abs(outcome.energy_residual) <= 1e-12
    assert outcome.numerical > 0


LOSSY = UNIT.replace(viscosity=1e-3)


@pytest.mark.parametrize(
    ("pieces", "omega", "share"),
    [
        (
            [segment(1.0, 0.1, LOSSY)],
            math.pi * float(ri.waves.mindlin_herrmann(0.05, 0.3)[0]),
            1.0,
        ),
        ([segment(0.2, 0.1, LOSSY, None)], math.pi / 0.2, 1.0),
        # half of the material damps: the strain energy of the lowest mode is even
        ([segment(0.5, 0.1, stuff, None) for stuff in (UNIT, LOSSY)], math.pi, 0.5),
    ],
)
def test_the_lasting_mode(pieces, omega, share):
    frequency, rate = lasting_mode(pieces)
    assert frequency == pytest.approx(omega, rel=3e-4)
    assert rate == pytest.approx(
        share * ri.theory.kelvin_voigt_decay(1.0, 1e-3, omega), rel=1e-2
    )
