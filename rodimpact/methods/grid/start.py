"""The state of motion at t = 0 on a grid.

Velocities are known at t = 0, forces of cells half a step before and after it. So the
forces half a step before t = 0 depend on the change of velocity by the forces at t = 0.
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
"""Retardation time eta/E, in steps, at which `slow_down` takes half of its effect."""


def begin(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Store the initial state in a grid.

    Velocities are those at t = 0, forces of cells those half a step before. Also set
    are displacements of pieces, radial strains, the resistance of soil, the waves from
    semi-infinite bars, and which contacts are closed. The grid counts time in steps, so
    its lengths are in m/s, see `records`; `step` is in s.

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
    half_kick = _half_kick(mesh, step, grid, tension)
    # In the half step after t = 0 nodes move with the velocity v + dv, where dv is
    # `half_kick`. So the tension T at t = 0 becomes T + k (v + dv)/2 half a step later,
    # where v and dv stand for differences of neighbouring nodes. The first drift adds
    # k v. Therefore the tension begins with T + k (dv - v)/2.
    # [cell]; the values of the outer cells do not count, as these have no stiffness.
    differences = np.diff(half_kick - v, prepend=0.0, append=0.0)
    grid.force[:] = tension + grid.stiffness * differences / 2
    _begin_soil(grid, half_kick)
    # Half a step after t = 0 a piece has moved by (v + dv)/2, of which the first drift
    # adds v/2.
    grid.pieces["displacement"] = half_kick[mesh.starts] / 2
    grid.ends["background_wave"] = _background_waves(mesh, grid, tension)
    # Contacts whose gaps vanish before the first kick, half a step after t = 0, begin
    # closed.
    links = grid.links
    closing = v[links["left_node"]] - v[links["right_node"]]
    is_closed = links["gap"] <= closing / 2  # the way in half a step
    links["is_closed"][is_closed] = 1
    return half_kick


def _begin_soil(grid: Grid, half_kick: Array) -> None:
    """Move the static resistance of soil from t = 0 to half a step before t = 0.

    The tension of cells is known at that time, too. `resistance` R of the soil is
    changed in place, by k (change - v)/2 with the stiffness k: the first step, which
    adds k v, then makes it R + k (v + change)/2. Here v is the velocity against the
    ground at t = 0, and `change` is its change by half a kick, which follows from
    `half_kick`, the changes of the velocities of nodes by half a kick of the forces at
    t = 0, m/s [node]. The resistance is not limited here: the first step limits it.
    """
    soil = grid.soil
    # Velocity v against the ground at t = 0, and its change by half a kick. The ground
    # gains `ground_acceleration`, m/s per step, and half of it in half a step.
    v = grid.velocity[soil["node"]] - grid.run["ground_velocity"]
    change = half_kick[soil["node"]] - grid.run["ground_acceleration"] / 2
    # As for the tension of cells: in the half step after t = 0 the rod moves by
    # (v + change)/2 against the soil, with velocities in m/s and time in steps.
    soil["resistance"] += soil["stiffness"] * (change - v) / 2


def _background_waves(mesh: Mesh, grid: Grid, tension: Array) -> Array:
    """Waves that come from semi-infinite bars in the state at t = 0, m/s [end].

    With the tension F the wave is v - F/Z on the left and v + F/Z on the right. v and F
    are extrapolated to the end from the two outer nodes and the two outer cells. At an
    end without a bar the value is v; it is not used.
    """
    v = grid.velocity
    nodes = np.array(mesh.ends)
    cells = np.array(mesh.end_cells)
    # INWARD is 1 at the left end and -1 at the right end: added to an index it gives
    # the next node or cell, and it is also the sign of F/Z.
    # The tension of a cell is that in its middle, 1/2 cell from the end, that of the
    # next cell 1 cell further inside: half of their difference leads to the end.
    outer = tension[cells]
    inner = tension[cells + INWARD]
    tension_at_end = outer - (inner - outer) / 2
    # The velocity of a node is the mean over its half cells. The outer node has a
    # single one, with its middle 1/4 cell from the end; the next node is at 1 cell. A
    # third of their difference, over 3/4 cell, leads to the end.
    velocity_at_end = v[nodes] - (v[nodes + INWARD] - v[nodes]) / 3
    from_tension = INWARD * quotient(tension_at_end, grid.ends["impedance"])
    return np.asarray(velocity_at_end - from_tension)


def _initial_motion(mesh: Mesh) -> tuple[Array, Array]:
    """Velocities of the nodes and elongations of the cells at t = 0.

    Returns
    -------
    array
        Velocity in the frame, m/s [node]: the mean over the half cells beside the node
        and its rigid mass, weighted by mass. It is 0 at a node without mass, as that of
        a wall.
    array
        Elongation of each cell by the mean strain in it, m [cell].
    """
    row = mesh.row
    momentum = np.zeros(len(mesh.mass))  # kg m/s [node]
    elongation = np.zeros(len(mesh.cell_mass))
    for body, (start, stop) in zip(row.system.bodies, row.spans, strict=True):
        left = 0.0  # left end of the segment, m from the left end of the rod
        for s in range(start, stop + 1):  # a wall or a mass has no segments
            # Segments count from 1. Cell i is on the left of node i.
            nodes = slice(mesh.first[s], mesh.last[s] + 1)
            cells = slice(mesh.first[s] + 1, mesh.last[s] + 1)
            L = float(row.segments[s - 1].length)
            N = mesh.counts[s - 1]
            half_edges = half_cell_edges(left, L, N)
            velocities = averages(body.velocity, half_edges, float(body.length))
            masses = np.repeat(mesh.cell_mass[cells] / 2, 2)  # two half cells a cell
            momenta = masses * velocities  # [half cell]
            # The momenta of half cells are added up for each node.
            momentum[nodes] += np.bincount(nodes_of_half_cells(N), momenta)
            edges = half_edges[::2]  # of whole cells
            strains = averages(body.strain, edges, float(body.length))
            elongation[cells] = strains * L / N  # L/N is the length of a cell
            left += L
    momentum[mesh.node_of_mass] += np.multiply(row.masses, row.mass_velocity)
    velocity = quotient(momentum, mesh.mass)
    in_frame = np.where(mesh.mass > 0, velocity - row.frame, 0.0)
    return in_frame, elongation


def _changes_by_driven_ends(mesh: Mesh, step: float, grid: Grid) -> Array:
    """Changes of velocity, m/s [node], by driven ends whose velocity jumps at t = 0.

    The velocity of a driven end jumps from its value in `grid` to the mean of the given
    velocity over the first half step, see `scheme.boundary_velocity`; `grid` is not
    changed. Lateral inertia drags neighbouring nodes along: the equations are
    (M + J) dv = 0 with the masses M, the lateral inertias J, and dv prescribed at the
    end. Without driven ends all changes are 0.
    """
    # No forces act; at a prescribed node the equation is dv = right side.
    right_side = np.zeros(len(mesh.mass))
    at_start = np.zeros(1)  # t = 0, where the mean over the first half step is taken
    for node, (kind, value) in zip(mesh.ends, mesh.row.boundaries, strict=True):
        if kind == "velocity":
            (velocity,) = scheme.boundary_velocity(mesh.row, step, value, at_start)
            right_side[node] = velocity - grid.velocity[node]
    # (M + J)/step, as in the equations of a step. A jump takes no time, so viscosity
    # has no part in it.
    off_diagonal = mesh.lateral_inertia / step  # with opposite sign [cell]
    # Node i lies between the cells i and i + 1.
    diagonal = mesh.mass / step + off_diagonal[:-1] + off_diagonal[1:]
    factors = scheme.factorise(mesh, diagonal, off_diagonal)
    return scheme.velocity_changes(factors, right_side)


def _half_kick(mesh: Mesh, step: float, grid: Grid, tension: Array) -> Array:
    """Changes of velocity, m/s [node], by half a kick of the forces at t = 0.

    The forces are `tension` [cell], N, those of soil, those prescribed at the ends, and
    those of links. The positions in the middle of the first step follow from the
    changed velocities. Without this change a force that begins at t = 0, between two
    kicks, would leave a motion that changes its sign from node to node. A node whose
    velocity is prescribed changes it as the ground does in the falling frame. No
    argument is changed.
    """
    # N [node], to the right: there is one cell more than nodes, as a cell lies outside
    # each end
    force = np.diff(tension)
    soil = grid.soil
    # Mean velocity of the ground over the first step: half of the gain in this step,
    # `ground_acceleration` in m/s per step, is added.
    ground = grid.run["ground_velocity"] + grid.run["ground_acceleration"] / 2
    against_ground = grid.velocity[soil["node"]] - ground  # velocity, m/s
    # The damping is that of the first step, also by Smith's law.
    pull = soil["resistance"] + soil["damping"] * against_ground
    np.subtract.at(force, soil["node"], pull)
    _add_forces_at_ends(mesh, step, grid, force)
    _add_link_forces(grid, force)
    factors = scheme.Factors(grid.lower, grid.inverse_diagonal, grid.upper)
    # In the falling frame a node whose velocity is prescribed gains velocity as the
    # ground does, in half a kick half of the gain in a step.
    prescribed_gain = grid.run["ground_acceleration"] / 2
    # `velocity_changes` gives the changes in a step by given forces, as the factors
    # contain the masses and time is counted in steps: half of the force, half a kick.
    right_side = np.where(mesh.is_prescribed == 1, prescribed_gain, force / 2)
    return scheme.velocity_changes(factors, right_side)


def _add_forces_at_ends(mesh: Mesh, step: float, grid: Grid, force: Array) -> None:
    """Enter the prescribed forces at both ends in the first step in `force`, N [node].

    At a pushed end the given force is added to the force on its node. At a
    semi-infinite bar the force of the given wave replaces the force on the node: the
    background wave keeps the state at t = 0 in balance, so that only the given wave
    changes it.
    """
    for side, (kind, _) in enumerate(mesh.row.boundaries):
        node = mesh.ends[side]
        if kind == "force":
            (push,) = scheme.boundary_values(mesh, step, side, steps=1)
            force[node] += INWARD[side] * push
        elif kind == "absorbing":
            # At either end a wave of positive velocity pushes to the right: no INWARD.
            (wave,) = scheme.boundary_values(mesh, step, side, steps=1)
            force[node] = grid.ends["impedance"][side] * wave


def _add_link_forces(grid: Grid, force: Array) -> None:
    """Enter the forces of links at t = 0 in `force`, N [node].

    A joint pulls by its stretch, without the force of its dashpot. A compliant contact
    with an overlap pushes. If the forces on the two nodes of a rigid contact without a
    gap press them together, both become 0: the contact carries them in the first half
    kick, and its own force follows from the first step. Other links have no force.
    """
    for link in grid.links:
        left = link["left_node"]
        right = link["right_node"]
        touches = link["law"] == Law.RIGID and link["gap"] == 0
        # Forces are positive to the right: these press the nodes together.
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
    """Mean force over the first step of a compliant contact with an initial overlap, N.

    The overlap at t = 0 is -link.gap. Gaps are divided by the step and are in m/s, so
    the overlap grows in a step by the closing velocity at t = 0. The result is the mean
    force over this change.
    """
    v = grid.velocity
    closing = v[link["left_node"]] - v[link["right_node"]]
    (as_object,) = as_objects(np.array([link], LINK))  # `mean_force` reads attributes
    overlap = -as_object.gap  # at t = 0, per step, so in m/s
    push, _ = mean_force(as_object, overlap, overlap + float(closing))
    return float(push)


def slow_down(mesh: Mesh, step: float, grid: Grid, half_kick: Array) -> None:
    """Slow down damped ends of rigid contacts that close before the first kick.

    The ends of a rigid contact that closes inside a step are stopped over two steps, so
    that the mean force is right from then on. If the ends touch at t = 0, the first of
    these two steps would lie before t = 0. The push in that step is made up for here:
    it reduces the closing velocity of the ends by `_late_overlaps`. Velocities,
    displacements of pieces, lost energy of cells, and `initial_force` and
    `initial_loss` of these links are changed. `half_kick` are the changes of velocity
    by half a kick of the forces at t = 0, m/s [node].

    Without viscosity all `_late_overlaps` are 0, and nothing is changed. Such ends
    begin to slow down half a step late, which is harmless: a sharp front returns to the
    contact just at a kick and opens it equally late, and the ends regain the energy
    that they lost as they closed.
    """
    v = grid.velocity
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    # m/s, as time is counted in steps [link]
    late_overlap = _late_overlaps(mesh, step, grid, half_kick)
    is_late = late_overlap > 0
    if not is_late.any():
        return
    # The pushes are instantaneous, so damping of soil has no effect on them: `diagonal`
    # is without soil.
    factors = scheme.factorise(mesh, grid.diagonal, grid.off_diagonal)
    responses = scheme.responses_to_pushes(mesh, factors)
    # Decrease of the closing velocity by a unit push, (m/s)/N [link]: that from before
    # to after the push, which is not halved as the mean over a step would be.
    mobility = responses.by_last[left] + responses.by_first[right]
    for i in np.flatnonzero(is_late):
        link = links[i]
        v_before = v.copy()
        push = late_overlap[i] / mobility[i]  # N
        # Nodes of both pieces whose velocity the push changes
        on_left = slice(link["leftmost_node"], link["left_node"] + 1)
        on_right = slice(link["right_node"], link["rightmost_node"] + 1)
        v[on_left] -= responses.by_last[on_left] * push
        v[on_right] += responses.by_first[on_right] * push
        dv = v - v_before
        # The push replaces a kick half a step before t = 0. Until t = 0 the change dv
        # moves the pieces by dv/2.
        grid.pieces["displacement"] += dv[mesh.starts] / 2
        # Gain of kinetic energy, J: m v dv with the mean velocity v, and the same for
        # lateral inertia with rates of elongation in place of velocities
        mean_v = (v + v_before) / 2
        stretch_rate = _stretch_rates(mean_v)
        rate_change = _stretch_rates(dv)
        by_mass = mesh.mass @ (mean_v * dv)
        by_lateral_inertia = mesh.lateral_inertia @ (stretch_rate * rate_change)
        kinetic_gain = by_mass + by_lateral_inertia
        # Gain of strain energy: work of the tensions on the elongation dv/2. The grid
        # divides energies by the step, as it counts time in steps.
        gain = kinetic_gain / step + grid.force @ rate_change / 2
        heat = grid.viscous * stretch_rate**2  # in the step of that kick [cell]
        grid.lost[:] += heat
        link["initial_force"] = push
        # The bodies lose the energy -gain. The part of it that is not heat in the cells
        # is lost in the link.
        link["initial_loss"] = -gain - heat.sum()


def _late_overlaps(mesh: Mesh, step: float, grid: Grid, half_kick: Array) -> Array:
    """Overlaps at the first kick that a push before t = 0 would have avoided [link].

    They are in m/s, as time is counted in steps. The overlap is
    (closing - parting)/2 - gap: the ends approach with the velocity `closing` at t = 0,
    and half a kick of the forces at t = 0 reduces it by `parting`. It counts for closed
    rigid links with an end that can move, if it exceeds round-off and `closing` is more
    than twice `parting`. With little viscosity beside the link only a fraction of it is
    returned. For all other links, and without viscosity, the result is 0. `half_kick`
    is that of `slow_down`.
    """
    v = grid.velocity
    links = grid.links
    left = links["left_node"]
    right = links["right_node"]
    closing = v[left] - v[right]
    # Velocity that the forces at t = 0 take from it in half a kick
    parting = half_kick[right] - half_kick[left]
    # Overlap at the first kick, half a step after t = 0, hence the factor 1/2
    overlap = (closing - parting) / 2 - links["gap"]
    is_late = (links["law"] == Law.RIGID) & (links["is_closed"] == 1)
    is_late &= links["self_mobility"] > 0  # one of the ends can move
    is_late &= overlap > grid.run["velocity_tolerance"]
    is_late &= closing > 2 * parting
    cell_retardation = quotient(mesh.viscous, mesh.stiffness)  # eta/E, s [cell]
    # The larger value of the two cells beside each link. Cell i is on the left of node
    # i, so the cell on the right of the link has the index right + 1.
    retardation = cell_retardation[[left, right + 1]].max(axis=0)
    # 0 without viscosity, nearly 1 with much viscosity
    share = retardation / (retardation + LITTLE_RETARDATION * step)
    return np.where(is_late, share * overlap, 0.0)


def _stretch_rates(v: Array) -> Array:
    """Rates of elongation of the cells, m/s [cell], from velocities of the nodes.

    The first and the last cell, beyond the ends of the row, have the rate 0.
    """
    rates = np.diff(v, prepend=0.0, append=0.0)  # one cell more than nodes
    rates[[0, -1]] = 0.0
    return np.asarray(rates)
