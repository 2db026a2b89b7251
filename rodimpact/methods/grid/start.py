"""The state of motion at t = 0 on a grid."""

import numpy as np

from ...model.profiles import averages
from ..link import Law
from ..row import Array
from ..run import INWARD
from . import scheme
from .mesh import Mesh, quotient
from .records import Grid

LITTLE_RETARDATION = 1 / 64  # eta/E in steps, where ends shut with half of the delay


def begin(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Enter the state at t = 0: velocities then, forces half a step before.

    Returns
    -------
    array
        Velocities that half a kick by the forces at t = 0 gives.
    """
    v = grid.velocity
    strain = np.zeros(len(grid.force))
    v[:] = _velocities(mesh, strain)
    v += _dragged(mesh, step, grid)
    radial = quotient(-mesh.cells.coupling, mesh.cells.radial) * strain
    grid.radial_strain[:] = radial / step
    tension = mesh.stiffness * strain + mesh.cells.coupling * radial
    kick = _first_kick(mesh, step, grid, tension)
    stretching = np.diff(kick - v, prepend=0.0, append=0.0)
    grid.force[:] = tension + grid.stiffness * stretching / 2
    grid.pieces["displacement"] = kick[mesh.starts] / 2
    # v - F/Z, seen from the row, comes from an endless bar. It is carried on to the end from
    # means over half a cell and over a cell.
    nodes = np.array(mesh.ends)
    cells = np.array(mesh.end_cells)
    pull = tension[cells] - (tension[cells + INWARD] - tension[cells]) / 2
    speed = v[nodes] - (v[nodes + INWARD] - v[nodes]) / 3
    grid.ends["background_wave"] = speed - INWARD * quotient(
        pull, grid.ends["impedance"]
    )
    # Contacts that close before the first kick are shut.
    link = grid.links
    closing = v[link["left_node"]] - v[link["right_node"]]
    link["is_closed"][link["gap"] <= closing / 2] = 1
    return kick


def _velocities(mesh: Mesh, strain: Array) -> Array:
    """Velocities of nodes; enters the strains of cells, as changes of length."""
    row = mesh.row
    v = np.zeros(len(mesh.mass))
    for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
        left = 0.0
        for s in range(start, stop + 1):
            first = mesh.first[s]
            last = mesh.last[s]
            L = float(row.segments[s - 1].length)
            N = mesh.counts[s - 1]
            edges = left + L * np.arange(2 * N + 1) / (2 * N)  # of half cells
            halves = averages(body.velocity, edges, float(body.length))
            masses = np.repeat(mesh.cell_mass[first + 1 : last + 1] / 2, 2)
            nodes = (np.arange(2 * N) + 1) // 2
            v[first : last + 1] += np.bincount(nodes, masses * halves)
            strains = averages(body.strain, edges[::2], float(body.length))
            strain[first + 1 : last + 1] = strains * L / N
            left += L
    v[mesh.node_of_mass] += np.multiply(row.masses, row.mass_velocity)
    return np.where(mesh.mass > 0, quotient(v, mesh.mass) - row.frame, 0.0)


def _dragged(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Changes of velocity where held ends jump: lateral inertia takes neighbours along."""
    jump = np.zeros(len(mesh.mass))
    bound = mesh.lateral / step
    for node, (kind, value) in zip(mesh.ends, mesh.row.outside, strict=True):
        if kind == "velocity":
            start = scheme.boundary_velocity(mesh.row, step, value, np.zeros(1))[0]
            jump[node] = start - grid.velocity[node]
    return scheme.velocity_changes(
        scheme.factorise(mesh, mesh.mass / step, bound), jump
    )


def _first_kick(mesh: Mesh, step: float, grid: Grid, tension: Array) -> Array:
    """Velocities that half a kick by the forces at t = 0 gives.

    In the middle of the first step nodes are where these bring them: a force that begins at t = 0
    lies between two kicks, and would leave a wave from node to node otherwise.
    """
    row = mesh.row
    force = np.diff(tension)
    for side, (kind, _) in enumerate(row.outside):
        node = mesh.ends[side]
        if kind == "force":
            force[node] += INWARD[side] * scheme.boundary_values(mesh, step, side, 1)[0]
        elif kind == "absorbing":
            wave = scheme.boundary_values(mesh, step, side, 1)[0]
            force[node] = grid.ends["impedance"][side] * wave
    for link in grid.links:
        left = link["left_node"]
        right = link["right_node"]
        touches = link["law"] == Law.RIGID and link["gap"] == 0
        if touches and force[left] > force[right]:
            force[left] = 0.0
            force[right] = 0.0
        elif link["law"] == Law.JOINT:
            force[left] += link["stiffness"] * link["gap"]
            force[right] -= link["stiffness"] * link["gap"]
    factors = scheme.Factors(grid.lower, grid.inverse_diagonal, grid.upper)
    return scheme.velocity_changes(factors, np.where(mesh.held == 1, 0.0, force / 2))


def slow_down(mesh: Mesh, step: float, grid: Grid, kick: Array) -> None:
    """Slow ends down that shut before the first kick, as a step before t = 0 would have done.

    An end that shuts inside a step is stopped over two of them, so that the mean force is right
    from then on. Where ends touch at t = 0 the first of them would begin before. It takes half of
    the velocity by which they close, or what closes beyond a small gap; `kick` is what forces give.
    Links and damped cells lose what that takes. Without viscosity all follows half a step late: a
    sharp front that comes back to a contact at a kick, as it left it, opens it as it shut, and ends
    get back what they lost.
    """
    v = grid.velocity
    force = grid.force
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    closing = v[left] - v[right]
    parting = kick[right] - kick[left]
    excess = (closing - parting) / 2 - links["gap"]
    late = (
        (links["law"] == Law.RIGID)
        & (links["is_closed"] == 1)
        & (links["self_mobility"] > 0)
    )
    late &= (excess > grid.run["velocity_tolerance"]) & (closing > 2 * parting)
    retardation = quotient(mesh.viscous, mesh.stiffness)[[left, right + 1]].max(axis=0)
    share = retardation / (retardation + LITTLE_RETARDATION * step)
    late &= share > 0
    for i in np.flatnonzero(late):
        link = links[i]
        before = v.copy()
        push = share[i] * excess[i] / (2 * link["self_mobility"])
        nodes = slice(link["leftmost_node"], link["left_node"] + 1)
        v[nodes] -= grid.velocity_by_last[nodes] * push
        nodes = slice(link["right_node"], link["rightmost_node"] + 1)
        v[nodes] += grid.velocity_by_first[nodes] * push
        gained = v - before
        grid.pieces["displacement"] += gained[mesh.starts] / 2
        # What the kinetic energy, and the strain energy of forces that are there, lose.
        mean = (v + before) / 2
        stretching = np.diff(mean, prepend=0.0, append=0.0)
        faster = np.diff(gained, prepend=0.0, append=0.0)
        stretching[[0, -1]] = 0.0
        faster[[0, -1]] = 0.0
        gain = mesh.mass @ (mean * gained) + mesh.lateral @ (stretching * faster)
        gain = gain / step + force @ faster / 2
        heat = grid.viscous * stretching**2
        grid.lost[:] += heat
        link["initial_force"] = push
        link["initial_loss"] = -gain - heat.sum()
