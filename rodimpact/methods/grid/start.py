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
    bars and contacts that are closed are set too. Lengths of the grid are in m/s, as it
    counts time in steps, see `records`; `step` is in s.

    Returns
    -------
    array
        Changes of velocity by half a kick of the forces at t = 0, m/s [node].
    """
    v = grid.velocity
    initial_velocity, elongation = _initial_motion(mesh)
    v[:] = initial_velocity
    v += _changes_by_driven_ends(mesh, step, grid)
    cells = mesh.cells
    # At t = 0 the radial strain follows the stretching: G q + b du = 0.
    radial = quotient(-cells.coupling, cells.radial_stiffness) * elongation
    grid.radial_strain[:] = radial / step
    tension = mesh.stiffness * elongation + cells.coupling * radial
    kick = _first_kick(mesh, step, grid, tension)
    # In the half step after t = 0 nodes move with the velocity v + kick, see
    # `_first_kick`. The tension is T + k (v + kick)/2 then, by differences of
    # neighbours. As the first drift adds k v, it is T + k (kick - v)/2 half a step
    # before t = 0.
    stretching = np.diff(kick - v, prepend=0.0, append=0.0)
    grid.force[:] = tension + grid.stiffness * stretching / 2
    _begin_soil(grid, kick)
    # The first drift adds v/2: pieces have moved by (v + kick)/2 then.
    grid.pieces["displacement"] = kick[mesh.starts] / 2
    grid.ends["background_wave"] = _background_waves(mesh, grid, tension)
    # Contacts whose gaps vanish before the first kick, half a step after t = 0, are
    # closed.
    links = grid.links
    closing = v[links["left_node"]] - v[links["right_node"]]
    is_closed = links["gap"] <= closing / 2
    links["is_closed"][is_closed] = 1
    return kick


def _begin_soil(grid: Grid, kick: Array) -> None:
    """Move the static resistance of soil from t = 0 to half a step before.

    The tension of cells is there, too. `resistance` of the soil is changed in place;
    `kick` are the changes of velocity by half a kick at t = 0, m/s [node].
    """
    soil = grid.soil
    # Velocity against the ground at t = 0, and its change by half a kick. The ground
    # gains `ground_acceleration`, m/s, in a step, and half of it in half a kick.
    v = grid.velocity[soil["node"]] - grid.run["ground_velocity"]
    change = kick[soil["node"]] - grid.run["ground_acceleration"] / 2
    # As with the tension of cells, the resistance is R + k (v + change)/2 half a step
    # after t = 0, and a step adds k v: before t = 0 it is R + k (change - v)/2.
    soil["resistance"] += soil["stiffness"] * (change - v) / 2


def _background_waves(mesh: Mesh, grid: Grid, tension: Array) -> Array:
    """Waves that come from semi-infinite bars in the state at t = 0, m/s [end].

    They are v - F/Z on the left and v + F/Z on the right, F the tension. v and F are
    extrapolated to the end from means over the outer half cell (v) and over the outer
    cell (F). At an end without a bar the value is v, and means nothing.
    """
    v = grid.velocity
    nodes = np.array(mesh.ends)
    cells = np.array(mesh.end_cells)
    # INWARD is 1 at the left end and -1 at the right one: it leads to the next node or
    # cell, and is the sign of F/Z, too.
    # F is that in the middle of a cell: half a cell from the end, and one further on.
    outer = tension[cells]
    inner = tension[cells + INWARD]
    tension_at_end = outer - (inner - outer) / 2
    # v of the outer node is that a quarter of a cell from the end, v of the next node
    # that three quarters further on: a third of their difference leads to the end.
    velocity_at_end = v[nodes] - (v[nodes + INWARD] - v[nodes]) / 3
    from_tension = INWARD * quotient(tension_at_end, grid.ends["impedance"])
    return np.asarray(velocity_at_end - from_tension)


def _initial_motion(mesh: Mesh) -> tuple[Array, Array]:
    """Velocities of the nodes and elongations of the cells at t = 0.

    Returns
    -------
    array
        Velocity in the frame, m/s [node]: the mean of those of the half cells beside
        the node, and of its rigid mass, by their masses. It is 0 at a node without
        mass, as of a wall.
    array
        Elongation of each cell by the mean strain in it, m [cell].
    """
    row = mesh.row
    momentum = np.zeros(len(mesh.mass))  # kg m/s [node]
    elongation = np.zeros(len(mesh.cell_mass))
    for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
        left = 0.0  # left end of the segment, m from that of the rod
        for s in range(start, stop + 1):  # none of a wall or a mass
            # Segments count from 1. Cell i is on the left of node i.
            nodes = slice(mesh.first[s], mesh.last[s] + 1)
            cells = slice(mesh.first[s] + 1, mesh.last[s] + 1)
            L = float(row.segments[s - 1].length)
            N = mesh.counts[s - 1]
            half_edges = half_cell_edges(left, L, N)
            # Momenta of half cells are added up for each node.
            velocities = averages(body.velocity, half_edges, float(body.length))
            masses = np.repeat(mesh.cell_mass[cells] / 2, 2)
            momenta = masses * velocities  # [half cell]
            momentum[nodes] += np.bincount(nodes_of_half_cells(N), momenta)
            edges = half_edges[::2]  # of whole cells
            strains = averages(body.strain, edges, float(body.length))
            elongation[cells] = strains * L / N
            left += L
    momentum[mesh.node_of_mass] += np.multiply(row.masses, row.mass_velocity)
    velocity = quotient(momentum, mesh.mass)
    in_frame = np.where(mesh.mass > 0, velocity - row.frame, 0.0)
    return in_frame, elongation


def _changes_by_driven_ends(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Changes of velocity, m/s [node], by driven ends whose velocity jumps at t = 0.

    An end jumps to its given velocity from that in `grid`, which is not changed.
    Lateral inertia takes neighbours of the end along: the equations are (M + J) dv = 0
    with the jump prescribed at the end. Without driven ends all changes are 0.
    """
    # Forces on nodes, 0; at prescribed nodes the equation is dv = right side.
    right_side = np.zeros(len(mesh.mass))
    at_start = np.zeros(1)  # the time t = 0
    for node, (kind, value) in zip(mesh.ends, mesh.row.boundaries, strict=True):
        if kind == "velocity":
            (velocity,) = scheme.boundary_velocity(mesh.row, step, value, at_start)
            right_side[node] = velocity - grid.velocity[node]
    off_diagonal = mesh.lateral_inertia / step  # with opposite sign [cell]
    # Node i lies between the cells i and i + 1.
    diagonal = mesh.mass / step + off_diagonal[:-1] + off_diagonal[1:]
    factors = scheme.factorise(mesh, diagonal, off_diagonal)
    return scheme.velocity_changes(factors, right_side)


def _first_kick(mesh: Mesh, step: float, grid: Grid, tension: Array) -> Array:
    """Changes of velocity, m/s [node], that half a kick by the forces at t = 0 makes.

    The forces are `tension` [cell], N, those of soil, of what is given at the ends and
    of links that press. In the middle of the first step the nodes are where these
    changed velocities bring them: a force that begins at t = 0 lies between two kicks,
    and would otherwise leave a motion that changes its sign from node to node. Nothing
    is changed.
    """
    force = np.diff(tension)  # N [node], to the right
    soil = grid.soil
    # Mean velocity of the ground over the first step: half of what it gains counts.
    ground = grid.run["ground_velocity"] + grid.run["ground_acceleration"] / 2
    v = grid.velocity[soil["node"]] - ground
    # The damping is that of this step already, also that by Smith.
    np.subtract.at(force, soil["node"], soil["resistance"] + soil["damping"] * v)
    _add_forces_at_ends(mesh, step, grid, force)
    _add_link_forces(grid, force)
    factors = scheme.Factors(grid.lower, grid.inverse_diagonal, grid.upper)
    # In the frame that falls, what is held gains velocity as the ground does, here half
    # of that of a step.
    held = grid.run["ground_acceleration"] / 2
    right_side = np.where(mesh.is_prescribed == 1, held, force / 2)
    return scheme.velocity_changes(factors, right_side)


def _add_forces_at_ends(mesh: Mesh, step: float, grid: Grid, force: Array) -> None:
    """Enter what is given at both ends in the first step in `force`, N [node].

    The force on a pushed end is added to that on its node. That of an endless bar, by
    the given wave, takes its place: the background wave holds the state at t = 0, and
    the given wave alone changes it.
    """
    for side, (kind, _) in enumerate(mesh.row.boundaries):
        node = mesh.ends[side]
        if kind == "force":
            (push,) = scheme.boundary_values(mesh, step, side, steps=1)
            force[node] += INWARD[side] * push
        elif kind == "absorbing":
            # At both ends a positive velocity of the wave pushes to the right.
            (wave,) = scheme.boundary_values(mesh, step, side, steps=1)
            force[node] = grid.ends["impedance"][side] * wave


def _add_link_forces(grid: Grid, force: Array) -> None:
    """Enter the forces of links at t = 0 in `force` on the nodes, N [node].

    A joint pulls by its stretch, a compliant contact with an overlap pushes. Where the
    forces press the faces of a rigid contact without a gap together, both become 0: the
    contact takes them for the first half kick, and the first step solves for its force.
    """
    for link in grid.links:
        left = link["left_node"]
        right = link["right_node"]
        touches = link["law"] == Law.RIGID and link["gap"] == 0
        if touches and force[left] > force[right]:
            force[left] = 0.0
            force[right] = 0.0
        elif link["law"] == Law.JOINT:
            # The gap of a joint is its stretch.
            force[left] += link["stiffness"] * link["gap"]
            force[right] -= link["stiffness"] * link["gap"]
        elif link["gap"] < 0:  # a compliant contact with an overlap
            push = _initial_push(grid, link)
            force[left] -= push
            force[right] += push


def _initial_push(grid: Grid, link: Any) -> float:
    """Mean force over the first step of a compliant contact that begins pressed, N.

    It is that on the way from its overlap, -gap of the link, by the closing velocity at
    t = 0: time is counted in steps, so this velocity is the change of the overlap.
    """
    v = grid.velocity
    closing = v[link["left_node"]] - v[link["right_node"]]
    (as_object,) = as_objects(np.array([link], LINK))  # `mean_force` reads attributes
    overlap = -as_object.gap  # m/s
    push, _ = mean_force(as_object, overlap, overlap + float(closing))
    return float(push)


def slow_down(mesh: Mesh, step: float, grid: Grid, kick: Array) -> None:
    """Slow down damped ends of rigid contacts that close before the first kick.

    An end that closes inside a step is stopped over two steps, so that the mean force
    is right from then on. Where ends touch at t = 0, the first of the two steps would
    lie before: its push is made up for here. It takes the velocity `_late_overlaps`
    from that at which the ends close. Velocities, displacements of pieces, lost energy
    of cells, and `initial_force` and `initial_loss` of these links are changed. `kick`
    are the changes of velocity by half a kick of the forces at t = 0, m/s [node].

    Without viscosity `_late_overlaps` are 0, and nothing is done: such ends begin to
    slow down half a step late, which does no harm. A sharp front comes back to the
    contact just at a kick and opens it in the same way. Then the ends get back the
    energy that they lost as they closed.
    """
    v = grid.velocity
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    # m/s: lengths are divided by the step
    late_overlap = _late_overlaps(mesh, step, grid, kick)
    is_late = late_overlap > 0
    if not is_late.any():
        return
    # The pushes are blows at t = 0, in which damping of soil takes no part.
    factors = scheme.factorise(mesh, grid.diagonal, grid.off_diagonal)
    responses = scheme.responses_to_pushes(mesh, factors)
    # Closing velocity that a unit push takes away, m/s per N [link]
    mobility = responses.by_last[left] + responses.by_first[right]
    for i in np.flatnonzero(is_late):
        link = links[i]
        v_before = v.copy()
        push = late_overlap[i] / mobility[i]  # takes the overlap from the closing
        on_left = slice(link["leftmost_node"], link["left_node"] + 1)
        on_right = slice(link["right_node"], link["rightmost_node"] + 1)
        v[on_left] -= responses.by_last[on_left] * push
        v[on_right] += responses.by_first[on_right] * push
        dv = v - v_before
        # As by a kick: the first drift adds half of the new velocity.
        grid.pieces["displacement"] += dv[mesh.starts] / 2
        # Gain of kinetic energy: m v dv with the mean velocity v, and the same of
        # lateral inertia with rates of elongation
        mean = (v + v_before) / 2
        stretching = _stretching(mean)
        dv_stretching = _stretching(dv)
        by_mass = mesh.mass @ (mean * dv)
        by_lateral_inertia = mesh.lateral_inertia @ (stretching * dv_stretching)
        kinetic_gain = by_mass + by_lateral_inertia  # J
        # Energies of the grid are divided by the step, as time is counted in steps.
        # Strain energy: the tensions work on half a step of dv.
        gain = kinetic_gain / step + grid.force @ dv_stretching / 2
        heat = grid.viscous * stretching**2  # [cell]
        grid.lost[:] += heat
        link["initial_force"] = push
        # The bodies lose -gain. What is not heat in the cells is lost in the link.
        link["initial_loss"] = -gain - heat.sum()


def _late_overlaps(mesh: Mesh, step: float, grid: Grid, kick: Array) -> Array:
    """Overlaps at the first kick that a push before t = 0 would have avoided [link].

    Lengths are in m/s, as time is counted in steps. The overlap is half of the velocity
    at which the ends close, less half of that at which the forces at t = 0 part them,
    less the gap. It counts for closed rigid links whose ends close at more than twice
    the velocity at which they are parted; with little viscosity beside the link only a
    share of it does. For all other links, and without viscosity, it is 0. `kick` is
    that of `slow_down`.
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
    cell_retardation = quotient(mesh.viscous, mesh.stiffness)  # eta/E, s [cell]
    # The larger one of the cells on both sides of each link; cell i is on the left of
    # node i.
    retardation = cell_retardation[[left, right + 1]].max(axis=0)
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
