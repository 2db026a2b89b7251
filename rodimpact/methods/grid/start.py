"""The state of motion at t = 0 on a grid.

Velocities are known at t = 0, forces of cells half a step before and after. So the
first kick by the forces at t = 0 decides how far cells have come half a step before.
"""

from typing import Any

import numpy as np

from ...model.profiles import averages
from ..contact_laws import mean_force
from ..link import Law
from ..record_lists import as_objects
from ..row import Array
from ..run import INWARD
from . import scheme
from .mesh import Mesh, half_cell_edges, nodes_of_half_cells, quotient
from .records import LINK, Grid

LITTLE_RETARDATION = 1 / 64
"""Retardation time eta/E, in steps, that halves the slowing of touching ends."""


def begin(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Store the state at t = 0 in a grid: velocities then, forces half a step before.

    Displacements of pieces, radial strains, the resistance of soil, waves from endless
    bars and contacts that are closed are set too. A grid counts time in steps and
    lengths in m/s, see `records`.

    Returns
    -------
    array
        Changes of velocity by half a kick of the forces at t = 0, m/s [node].
    """
    v = grid.velocity
    elongation = np.zeros(len(grid.force))
    v[:] = _velocities(mesh, elongation)  # this sets `elongation`
    v += _changes_by_driven_ends(mesh, step, grid)
    cells = mesh.cells
    # At t = 0 the radial strain follows the stretching: G q + b du = 0.
    radial = quotient(-cells.coupling, cells.radial_stiffness) * elongation
    grid.radial_strain[:] = radial / step
    tension = mesh.stiffness * elongation + cells.coupling * radial
    kick = _first_kick(mesh, step, grid, tension)
    # Half a step after t = 0 the tension is T + k (v + kick)/2, by differences of
    # neighbours. As the first drift adds k v, it is T + k (kick - v)/2 half a step
    # before.
    stretching = np.diff(kick - v, prepend=0.0, append=0.0)
    grid.force[:] = tension + grid.stiffness * stretching / 2
    _begin_soil(grid, kick)
    grid.pieces["displacement"] = kick[mesh.starts] / 2
    grid.ends["background_wave"] = _background_waves(mesh, grid, tension)
    # Contacts whose gaps vanish before the first kick are closed.
    links = grid.links
    closing = v[links["left_node"]] - v[links["right_node"]]
    links["is_closed"][links["gap"] <= closing / 2] = 1
    return kick


def _begin_soil(grid: Grid, kick: Array) -> None:
    """Move the static resistance of soil to half a step before t = 0.

    The tension of cells is there, too. `kick` are the changes of velocity by half a
    kick at t = 0.
    """
    soil = grid.soil
    # Against the ground: the velocity at t = 0, and its change by half a kick
    v = grid.velocity[soil["node"]] - grid.run["ground_velocity"]
    change = kick[soil["node"]] - grid.run["ground_acceleration"] / 2
    # As for cells: half a step later the resistance
    # is R + k (v + change)/2, a step adds k v.
    soil["resistance"] += soil["stiffness"] * (change - v) / 2


def _background_waves(mesh: Mesh, grid: Grid, tension: Array) -> Array:
    """Waves that come from semi-infinite bars in the state at t = 0, m/s [end].

    They are v - F/Z on the left and v + F/Z on the right, F the tension. Both are
    extrapolated to the end from means over half a cell (v) and over a cell (F).
    """
    v = grid.velocity
    nodes = np.array(mesh.ends)
    cells = np.array(mesh.end_cells)
    # INWARD is 1 at the left end and -1 at the right one: it leads to the next node or
    # cell. The end is half a cell from the middle of its cell; the mean over half a
    # cell is that at a quarter of a cell from the end, and the next one is three
    # quarters of a cell further on.
    in_last_cell = tension[cells]
    tension_at_end = in_last_cell - (tension[cells + INWARD] - in_last_cell) / 2
    velocity_at_end = v[nodes] - (v[nodes + INWARD] - v[nodes]) / 3
    from_tension = INWARD * quotient(tension_at_end, grid.ends["impedance"])
    return np.asarray(velocity_at_end - from_tension)


def _velocities(mesh: Mesh, elongation: Array) -> Array:
    """Velocities of all nodes at t = 0 in the frame, m/s [node].

    The velocity of a node is the mean of those of the half cells beside it, and of its
    rigid mass, by their masses. `elongation` becomes that of each cell, m [cell].
    """
    row = mesh.row
    momentum = np.zeros(len(mesh.mass))  # kg m/s [node]
    for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
        left = 0.0
        for s in range(start, stop + 1):  # none of a wall or a mass
            # Segments count from 1; cell i is on the left of node i.
            first = mesh.first[s]
            last = mesh.last[s]
            L = float(row.segments[s - 1].length)
            N = mesh.counts[s - 1]
            edges = half_cell_edges(left, L, N)
            # Momenta of half cells are added up for each node.
            halves = averages(body.velocity, edges, float(body.length))
            masses = np.repeat(mesh.cell_mass[first + 1 : last + 1] / 2, 2)
            half_nodes = nodes_of_half_cells(N)
            momentum[first : last + 1] += np.bincount(half_nodes, masses * halves)
            strains = averages(body.strain, edges[::2], float(body.length))
            elongation[first + 1 : last + 1] = strains * L / N
            left += L
    momentum[mesh.node_of_mass] += np.multiply(row.masses, row.mass_velocity)
    velocity = quotient(momentum, mesh.mass)
    return np.where(mesh.mass > 0, velocity - row.frame, 0.0)


def _changes_by_driven_ends(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Changes of velocity, m/s [node], by driven ends whose velocity jumps at t = 0.

    Lateral inertia takes neighbours of the end along: the equations are (M + J) dv = 0
    with the jump prescribed at the end.
    """
    jump = np.zeros(len(mesh.mass))
    off_diagonal = mesh.lateral_inertia / step
    for node, (kind, value) in zip(mesh.ends, mesh.row.boundaries, strict=True):
        if kind == "velocity":
            start = scheme.boundary_velocity(mesh.row, step, value, np.zeros(1))[0]
            jump[node] = start - grid.velocity[node]
    diagonal = mesh.mass / step + off_diagonal[:-1] + off_diagonal[1:]
    factors = scheme.factorise(mesh, diagonal, off_diagonal)
    return scheme.velocity_changes(factors, jump)


def _first_kick(mesh: Mesh, step: float, grid: Grid, tension: Array) -> Array:
    """Changes of velocity, m/s [node], that half a kick by the forces at t = 0 makes.

    In the middle of the first step the nodes are where these velocities bring them. A
    force that begins at t = 0 lies between two kicks, and would otherwise leave a
    motion that changes its sign from node to node.
    """
    row = mesh.row
    force = np.diff(tension)  # forces on the nodes
    soil = grid.soil
    ground = grid.run["ground_velocity"] + grid.run["ground_acceleration"] / 2
    v = grid.velocity[soil["node"]] - ground  # mean of the ground over the step
    # The damping is that of this step already, also that by Smith.
    np.subtract.at(force, soil["node"], soil["resistance"] + soil["damping"] * v)
    for side, (kind, _) in enumerate(row.boundaries):
        node = mesh.ends[side]
        if kind == "force":
            force[node] += INWARD[side] * scheme.boundary_values(mesh, step, side, 1)[0]
        elif kind == "absorbing":
            # The background wave holds the state at t = 0:
            # the given wave alone changes it.
            # So this force replaces that of the cells; at both ends a positive velocity
            # of the wave pushes to the right.
            wave = scheme.boundary_values(mesh, step, side, 1)[0]
            force[node] = grid.ends["impedance"][side] * wave
    for link in grid.links:
        left = link["left_node"]
        right = link["right_node"]
        touches = link["law"] == Law.RIGID and link["gap"] == 0
        if touches and force[left] > force[right]:
            # These press the faces together. The contact takes them for this half kick:
            # the first step solves for its force.
            force[left] = 0.0
            force[right] = 0.0
        elif link["law"] == Law.JOINT:
            force[left] += link["stiffness"] * link["gap"]
            force[right] -= link["stiffness"] * link["gap"]
        elif link["gap"] < 0:  # a compliant contact with an overlap
            push = _initial_push(grid, link)
            force[left] -= push
            force[right] += push
    factors = scheme.Factors(grid.lower, grid.inverse_diagonal, grid.upper)
    # In the frame that falls, what is held gains velocity as the ground does,
    # half of that of a step.
    held = grid.run["ground_acceleration"] / 2
    return scheme.velocity_changes(
        factors, np.where(mesh.is_prescribed == 1, held, force / 2)
    )


def _initial_push(grid: Grid, link: Any) -> float:
    """Mean force over the first step of a compliant contact that begins pressed, N.

    As in the links of a grid, the overlap is divided by the step: it is in m/s, and a
    closing velocity is its change in a step.
    """
    v = grid.velocity
    closing = v[link["left_node"]] - v[link["right_node"]]
    (as_object,) = as_objects(np.array([link], LINK))
    overlap = -as_object.gap
    push, _ = mean_force(as_object, overlap, overlap + float(closing))
    return float(push)


def slow_down(mesh: Mesh, step: float, grid: Grid, kick: Array) -> None:
    """Slow down ends that close before the first kick.

    A step before t = 0 would have done so. Velocities, displacements of pieces, lost
    energy of cells, and `initial_force` and `initial_loss` of the links are changed.

    An end that closes inside a step is stopped over two steps, so that the mean force
    is right from then on. Where ends touch at t = 0 the first of the two would begin
    before. It takes half of the velocity by which they close, or the part that closes
    beyond a small gap; `kick` is the velocity that half a kick by the forces at t = 0
    gives. Links and damped cells lose this energy.

    Without viscosity all follows half a step late: a sharp front that comes back to a
    contact at a kick, as it left it, opens it as it closed, and ends get back the
    energy that they lost.
    """
    v = grid.velocity
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    late_overlap = _late_overlaps(mesh, step, grid, kick)
    is_late = late_overlap > 0
    if not is_late.any():
        return
    # The pushes are blows at t = 0, in which damping of soil takes no part.
    factors = scheme.factorise(mesh, grid.diagonal, grid.off_diagonal)
    responses = scheme.responses_to_pushes(mesh, factors)
    mobility = responses.by_last[left] / 2 + responses.by_first[right] / 2
    for i in np.flatnonzero(is_late):
        link = links[i]
        v_before = v.copy()
        # This takes the late overlap from the closing velocity:
        # mobilities have half of one.
        push = late_overlap[i] / (2 * mobility[i])
        nodes = slice(link["leftmost_node"], link["left_node"] + 1)
        v[nodes] -= responses.by_last[nodes] * push
        nodes = slice(link["right_node"], link["rightmost_node"] + 1)
        v[nodes] += responses.by_first[nodes] * push
        dv = v - v_before
        grid.pieces["displacement"] += dv[mesh.starts] / 2
        # Changes of the kinetic energy, m v dv with the mean velocity v, and the same
        # for lateral inertia; and work of the forces that are there on half a step of
        # dv.
        mean = (v + v_before) / 2
        stretching = _stretching(mean)
        dv_stretching = _stretching(dv)
        kinetic = mesh.mass @ (mean * dv) + mesh.lateral_inertia @ (
            stretching * dv_stretching
        )
        # In steps: masses of the grid are those of the mesh over the step.
        gain = kinetic / step + grid.force @ dv_stretching / 2
        heat = grid.viscous * stretching**2
        grid.lost[:] += heat
        link["initial_force"] = push
        link["initial_loss"] = -gain - heat.sum()  # what the link itself loses


def _late_overlaps(mesh: Mesh, step: float, grid: Grid, kick: Array) -> Array:
    """Overlaps at the first kick that a step before t = 0 would have kept, m/s [link].

    They are 0 but for closed rigid links, with viscosity beside them, whose ends close
    faster than the forces at t = 0 part them. `kick` is that of `slow_down`.
    """
    v = grid.velocity
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    closing = v[left] - v[right]
    # Velocity at which the forces at t = 0 part the ends
    parting = kick[right] - kick[left]
    # Overlap at the first kick, half a step after t = 0
    overlap = (closing - parting) / 2 - links["gap"]
    is_late = (links["law"] == Law.RIGID) & (links["is_closed"] == 1)
    is_late &= links["self_mobility"] > 0  # one of the ends can move
    is_late &= overlap > grid.run["velocity_tolerance"]
    is_late &= closing > 2 * parting
    retardation = quotient(mesh.viscous, mesh.stiffness)  # eta/E of cells
    retardation = retardation[[left, right + 1]].max(axis=0)  # that beside each link
    # Part of the slowing down that is done: 0 without viscosity, 1 with much of it
    share = retardation / (retardation + LITTLE_RETARDATION * step)
    return np.where(is_late, share * overlap, 0.0)


def _stretching(v: Array) -> Array:
    """Rates of elongation of the cells, m/s [cell], by velocities of the nodes.

    Cells beyond the ends, which stand for nothing, have 0.
    """
    stretching = np.diff(v, prepend=0.0, append=0.0)
    stretching[[0, -1]] = 0.0
    return np.asarray(stretching)
