"""Random rows with everything that a grid can carry."""

import numpy as np
from networks import STEP, logarithmic, random_network
from numpy.random import default_rng
from scipy.linalg import block_diag

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh
from rodimpact.methods.grid.method import mesh_size, run_grid
from rodimpact.methods.grid.run import GridRun
from rodimpact.methods.row_builder import build_row

SECONDS = 3.0
"""Time of a run, s: the longest transits take about one."""


def thicken(rng, segment):
    """The same segment, perhaps damped, with lateral inertia, or tapered.

    Each of them happens by itself in about half of the cases.
    """
    material = segment.material
    area = segment.area
    polar_moment = None
    viscosity = 0.0
    if rng.random() < 0.5:
        viscosity = material.youngs_modulus * logarithmic(rng, 1e-4, 10)
    if rng.random() < 0.4:
        polar_moment = logarithmic(rng, 1e-4, 1)
    if rng.random() < 0.4:
        n_places = rng.integers(2, 6)
        factors = rng.uniform(0.3, 3, n_places)
        area = ri.Samples((area * factors).tolist())
        if polar_moment:
            polar_moment = "circular"
    lossy = ri.Material(
        f"{material.name}, {viscosity}",
        youngs_modulus=material.youngs_modulus,
        density=material.density,
        poisson_ratio=0.3,
        viscosity=viscosity,
    )
    theory = None
    if polar_moment:
        theory = "rayleigh-love"
        if rng.random() < 0.5:
            theory = "mindlin-herrmann"
    if theory == "mindlin-herrmann" and polar_moment != "circular":
        # A smaller one would need a shorter step.
        polar_moment = max(polar_moment, 0.02 * area)
    return ri.Segment(
        segment.length,
        area,
        lossy,
        polar_moment=polar_moment,
        lateral_inertia=theory,
    )


def random_row(seed, *, driven=False, bodies=5):
    """A random network, half of whose rods are damped, tapered, or have lateral
    inertia.
    """
    system = random_network(seed, bodies=bodies, driven=driven)
    rng = default_rng([seed, 1])
    row = []
    for body in system.bodies:
        if isinstance(body, ri.Rod) and rng.random() < 0.5:
            segments = [thicken(rng, segment) for segment in body.segments]
            body = ri.Rod(segments=segments, velocity=body.velocity, strain=body.strain)
        row.append(body)
    return system.replace(bodies=row)


def matrices(mesh):
    """Mass, damping and stiffness of a mesh of one piece, as dense matrices.

    Their rows are those of its n nodes, then of the radial strains of its n - 1 cells
    [2n - 1, 2n - 1].
    """
    n = len(mesh.mass)
    cells = mesh.cells
    # They take differences: of nodes [cell, node], and of cells [inner node, cell].
    between_nodes = np.diff(np.eye(n), axis=0)
    between_cells = np.diff(np.eye(n - 1), axis=0)

    def of_cells(name):
        """A property of the cells, as a column to weight their rows [cell, 1].

        Cell 0 of the mesh lies outside of the piece.
        """
        return getattr(cells, name)[1:n, None]

    lateral = between_nodes.T @ (of_cells("lateral_inertia") * between_nodes)
    axial_mass = np.diag(mesh.mass) + lateral
    radial_mass = np.diag(of_cells("radial_inertia")[:, 0])
    mass = block_diag(axial_mass, radial_mass)

    viscous = between_nodes.T @ (of_cells("viscous") * between_nodes)
    damping = block_diag(viscous, np.zeros((n - 1, n - 1)))

    axial = between_nodes.T @ (of_cells("stiffness") * between_nodes)
    coupling = of_cells("coupling") * between_nodes
    shear = between_cells.T @ (mesh.shear_stiffness[1 : n - 1, None] * between_cells)
    radial = np.diag(of_cells("radial_stiffness")[:, 0]) + shear
    stiffness = np.block([[axial, coupling.T], [coupling, radial]])
    return mass, damping, stiffness


def grid_run(system, room, snapshots=None, step=STEP):
    """A run on a grid, a `GridRun`, that has not begun.

    `room` is the number of steps that its memory is checked for, `step` the time step
    in s, `snapshots` the number of states that are kept.
    """
    row = build_row(system)
    cell_counts, step = mesh_size(row, cells=None, dt=step, until=None)
    return GridRun(Mesh(row, cell_counts), step, snapshots, room)


def run_row(system, until=SECONDS, step=STEP):
    """A run on a grid to `until`, s, a `GridRun`, with as many events as it takes."""
    return run_grid(build_row(system), until, max_events=10**9, dt=step)
