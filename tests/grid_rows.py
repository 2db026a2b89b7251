"""Random rows with everything that a grid can carry."""

import numpy as np
from networks import STEP, logarithmic, random_network
from scipy.linalg import block_diag

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh
from rodimpact.methods.grid.method import _mesh_size, run_grid
from rodimpact.methods.grid.run import GridRun
from rodimpact.methods.row_builder import build_row

SECONDS = 3.0


def thicken(rng, segment):
    """The same segment, perhaps damped, with lateral inertia, or tapered."""
    m = segment.material
    area = segment.area
    polar = None
    eta = m.youngs_modulus * logarithmic(rng, 1e-4, 10) if rng.random() < 0.5 else 0.0
    if rng.random() < 0.4:
        polar = logarithmic(rng, 1e-4, 1)
    if rng.random() < 0.4:
        area = ri.Samples((area * rng.uniform(0.3, 3, rng.integers(2, 6))).tolist())
        polar = polar and "circular"
    material = ri.Material(
        f"{m.name}, {eta}",
        youngs_modulus=m.youngs_modulus,
        density=m.density,
        poisson_ratio=0.3,
        viscosity=eta,
    )
    theory = polar and ("mindlin-herrmann" if rng.random() < 0.5 else "rayleigh-love")
    if theory == "mindlin-herrmann" and polar != "circular":
        polar = max(polar, 0.02 * area)  # or the step would have to be shorter
    return ri.Segment(
        segment.length, area, material, polar_moment=polar, lateral_inertia=theory
    )


def random_row(seed, *, driven=False, bodies=5):
    """A random network, half of whose rods are damped, tapered, or have lateral inertia."""
    system = random_network(seed, bodies=bodies, driven=driven)
    rng = np.random.default_rng([seed, 1])
    row = [
        ri.Rod(
            segments=[thicken(rng, s) for s in body.segments],
            velocity=body.velocity,
            strain=body.strain,
        )
        if isinstance(body, ri.Rod) and rng.random() < 0.5
        else body
        for body in system.bodies
    ]
    return ri.System(
        row, system.gaps, system.contacts, gravity=system.gravity, ends=system.ends
    )


def matrices(mesh):
    """Mass, damping and stiffness of one piece: of its nodes, then of the radial strains."""
    n = len(mesh.mass)
    inner, between = (np.diff(np.eye(size), axis=0) for size in (n, n - 1))
    k, d, j, J, b, G = (
        getattr(mesh.cells, name)[1:n, None]
        for name in (
            "stiffness",
            "viscous",
            "lateral",
            "swelling",
            "coupling",
            "radial",
        )
    )
    swelling = np.diag(G[:, 0]) + between.T @ (mesh.shear[1 : n - 1, None] * between)
    return (
        block_diag(np.diag(mesh.mass) + inner.T @ (j * inner), np.diag(J[:, 0])),
        block_diag(inner.T @ (d * inner), np.zeros((n - 1, n - 1))),
        np.block([[inner.T @ (k * inner), inner.T * b[:, 0]], [b * inner, swelling]]),
    )


def grid_run(system, room, snapshots=None, step=STEP):
    """A run that has not begun."""
    plan = build_row(system)
    counts, step = _mesh_size(plan, None, step, None)
    return GridRun(Mesh(plan, counts), step, snapshots, room)


def run_row(system, until=SECONDS, step=STEP):
    return run_grid(build_row(system), until, 10**9, dt=step)
