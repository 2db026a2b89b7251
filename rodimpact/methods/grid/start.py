"""The state of motion at t = 0 on a grid."""

import numpy as np

from ...model import Rod
from ...model.profiles import averages
from ..laws import Law
from ..row import Array
from . import scheme
from .mesh import Mesh, quotient
from .records import Grid

LITTLE_RETARDATION = 1 / 64  # eta/E in steps, where ends shut with half of the delay
MOST_RETARDATION = 1 / 64  # eta/E over the longest transit, up to which ends shut without delay

Overlaps = list[tuple[int, float, int]]
"""Cells, by how much they are to be strained before the first kick, and the link that shuts."""


def begin(mesh: Mesh, step: float, grid: Grid) -> Overlaps:
    """Enter the state at t = 0: velocities then, forces half a step before."""
    v, strain = grid.velocity, np.zeros(len(grid.force))
    v[:] = _velocities(mesh, strain)
    v += _dragged(mesh, step, grid)
    radial = quotient(-mesh.cells.coupling, mesh.cells.radial) * strain
    grid.strain[:] = radial / step
    tension = mesh.stiffness * strain + mesh.cells.coupling * radial
    kick = _first_kick(mesh, step, grid, tension)
    grid.force[:] = tension + grid.stiffness * np.diff(kick - v, prepend=0.0, append=0.0) / 2
    grid.piece["place"] = kick[mesh.starts] / 2
    for side, sign in ((0, 1), (1, -1)):
        cell = mesh.ends[side] + (1 if side == 0 else 0)
        if mesh.row.outside[side][0] == "absorbing":  # v - F/Z, seen from the row
            # carried on to the end itself from means over half a cell and over a cell
            inside, node = cell + sign, mesh.ends[side]
            pull = tension[cell] - (tension[inside] - tension[cell]) / 2
            speed = v[node] - (v[node + sign] - v[node]) / 3
            grid.end["rest"][side] = float(speed - sign * pull / scheme.impedance(mesh, side))
    link = grid.link
    closing = v[link["left"]] - v[link["right"]]
    link["shut"][link["gap"] <= closing / 2] = 1  # closes before the first kick
    return _parted(mesh, step, grid, closing, kick)


def _velocities(mesh: Mesh, strain: Array) -> Array:
    """Velocities of nodes; enters the strains of cells, as changes of length."""
    row, v = mesh.row, np.zeros(len(mesh.mass))
    for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
        if not isinstance(body, Rod):
            continue
        left = 0.0
        for s in range(start, stop + 1):
            a, b, L = mesh.first[s], mesh.last[s], float(row.segments[s - 1].length)
            N = mesh.counts[s - 1]
            halves = averages(body.velocity, left + L * np.arange(2 * N + 1) / (2 * N),
                              float(body.length))
            m = np.repeat(mesh.cell_mass[a + 1 : b + 1] / 2, 2)
            v[a : b + 1] += np.bincount((np.arange(2 * N) + 1) // 2, m * halves)
            edges = left + L * np.arange(N + 1) / N
            strain[a + 1 : b + 1] = averages(body.strain, edges, float(body.length)) * L / N
            left += L
    for place, node in enumerate(mesh.node_of_mass):
        v[node] += row.masses[place] * row.mass_velocity[place]
    return np.where(mesh.mass > 0, quotient(v, mesh.mass) - row.frame, 0.0)


def _dragged(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Changes of velocity where held ends jump: lateral inertia takes neighbours along."""
    jump, bound = np.zeros(len(mesh.mass)), mesh.lateral / step
    for node, (kind, value) in zip(mesh.ends, mesh.row.outside, strict=True):
        if kind == "velocity":
            jump[node] = scheme.moved(mesh.row, step, value, np.zeros(1))[0] - grid.velocity[node]
    return scheme.answered(scheme.eliminated(mesh, mesh.mass / step, bound), jump)


def _first_kick(mesh: Mesh, step: float, grid: Grid, tension: Array) -> Array:
    """Velocities that half a kick by the forces at t = 0 gives.

    In the middle of the first step nodes are where these bring them: a force that begins at t = 0
    lies between two kicks, and would leave a wave from node to node otherwise.
    """
    row, force = mesh.row, np.diff(tension)
    for side, (kind, _) in enumerate(row.outside):
        if kind == "force":
            force[mesh.ends[side]] += (1, -1)[side] * scheme.driven(mesh, step, side, 1)[0]
        elif kind == "absorbing":
            wave = scheme.driven(mesh, step, side, 1)[0]
            force[mesh.ends[side]] = scheme.impedance(mesh, side) * wave
    for at in grid.link:
        left, right = at["left"], at["right"]
        if at["law"] == Law.RIGID and at["gap"] == 0 and force[left] > force[right]:
            force[left] = force[right] = 0.0
        elif at["law"] == Law.JOINT:
            force[left] += at["stiffness"] * at["gap"]
            force[right] -= at["stiffness"] * at["gap"]
    multipliers = grid.into, grid.inverse, grid.back
    return scheme.answered(multipliers, np.where(mesh.held == 1, 0.0, force / 2))


def _parted(mesh: Mesh, step: float, grid: Grid, closing: Array, kick: Array) -> Overlaps:
    """Put ends apart that shut before the first kick, the lighter one more.

    By half the velocity by which they then close, `kick` with it, where they touch at t = 0; by
    nothing where they meet at the kick, nor where viscosity rules: strain would linger there.
    Without viscosity all follows half a step late, but a sharp front that comes back to a
    contact at a kick, as it left it, opens it as it shut: ends get back what they lost.
    """
    link, (l, r) = grid.link, (grid.link["left"], grid.link["right"])
    parting = kick[r] - kick[l]
    overlap = (closing - parting) / 2 - link["gap"]
    ease = quotient(mesh.held == 0, mesh.mass)
    late = (link["law"] == Law.RIGID) & (link["shut"] == 1) & (ease[l] + ease[r] > 0)
    late &= (overlap > grid.run["tolerance"]) & (closing > 2 * parting)
    retardation = quotient(mesh.viscous, mesh.stiffness)[[l, r + 1]].max(axis=0)
    late &= retardation <= MOST_RETARDATION * max(mesh.counts) * step
    overlap *= retardation / (retardation + LITTLE_RETARDATION * step)
    overlaps: Overlaps = []
    for i in np.flatnonzero(late).tolist():
        share = overlap[i] / (ease[l[i]] + ease[r[i]])
        for n, shift in ((l[i], -ease[l[i]] * share), (r[i], ease[r[i]] * share)):
            grid.piece["place"][grid.piece["start"] == n] += shift
            overlaps += [(int(cell), float(sign * shift), i) for cell, sign in ((n, 1), (n + 1, -1))
                         if mesh.stiffness[cell] > 0]
    return overlaps


def part(grid: Grid, overlaps: Overlaps) -> None:
    """Strain the cells whose ends shut before the first kick; links lose what that takes."""
    v, force = grid.velocity, grid.force
    for i, stretch, link in overlaps:
        k = grid.stiffness[i]
        tension = force[i] + k * (v[i] - v[i - 1]) / 2
        grid.link["early"][link] -= stretch * (tension + k * stretch / 2)
        force[i] += k * stretch
