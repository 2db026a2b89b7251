"""Soil and drag along the shafts of rods, as records for `soil_kernel`."""

from typing import Any

import numpy as np

from ...model import Drag, Rod
from ...model.drag import coefficients
from ...model.soil import SMITH, largest_stiffness, mobilised_shares, resistances
from ..row import Array, Row
from . import records
from .mesh import Mesh, half_cell_edges, nodes_of_half_cells
from .records import filled


def shaft_bodies(row: Row) -> list[int]:
    """Indices of the bodies of a row that have soil or drag along their shafts.

    They are indices into `system.bodies`, from left to right. The index of a shaft in
    this list is the `shaft` in the records of soil.
    """
    bodies = []
    for i, body in enumerate(row.system.bodies):
        if isinstance(body, Rod) and body.shaft is not None:
            bodies.append(i)
    return bodies


def soil_of(mesh: Mesh, step: float) -> Array:
    """Soil and drag of all rods at t = 0 as `records.SOIL`, from left to right.

    There is a record for each node with soil or drag, and two for a node that two such
    rods share. Without soil and drag the array is empty. Stiffnesses are those for time
    in steps of `step`, s.
    """
    parts = [filled(records.SOIL, 0)]  # empty, as np.concatenate needs one array
    for shaft_index, body in enumerate(shaft_bodies(mesh.row)):
        if isinstance(mesh.row.system.bodies[body].shaft, Drag):
            parts.append(_drag_of_rod(mesh, shaft_index, body))
        else:
            parts.append(_soil_of_rod(mesh, step, shaft_index, body))
    return np.concatenate(parts)


def _soil_of_rod(mesh: Mesh, step: float, shaft_index: int, body: int) -> Array:
    """Soil of one rod at t = 0 as `records.SOIL`, [node in soil].

    The ultimate resistance of a node is the sum over the half cells beside it; its
    resistance is the mobilised part of that, with its sign. Nodes without ultimate
    resistance have no record. The damping is proportional to the mobilised resistance
    by Smith's law, else to the ultimate resistance. `shaft_index` is the index of the
    rod in `shaft_bodies`.
    """
    rod = mesh.row.system.bodies[body]
    soil = rod.shaft
    edges = _half_cell_edges_of_rod(mesh, body)
    length = float(rod.length)
    nodes = _half_cell_nodes_of_rod(mesh, body)
    half_cell_ultimate = resistances(soil, edges, length)  # N [half cell]
    mobilised = mobilised_shares(soil, edges, length)  # -1 to 1 [half cell]
    # Sums over the half cells of each node of the rod, N
    node_ultimate = np.bincount(nodes, half_cell_ultimate)
    node_mobilised = np.bincount(nodes, half_cell_ultimate * mobilised)
    # Nodes in soil, counted from the left end of the rod
    in_soil = np.flatnonzero(node_ultimate)
    ultimate = node_ultimate[in_soil]
    # Round-off may make a resistance larger than the ultimate one.
    resistance = np.clip(node_mobilised[in_soil], -ultimate, ultimate)
    damping_factor = np.full(len(in_soil), float(soil.damping))
    is_smith = soil.law == SMITH
    if is_smith:
        damping = damping_factor * np.abs(resistance)
    else:
        damping = damping_factor * ultimate
    soil_records = _records_at(mesh, body, shaft_index, in_soil)
    soil_records["is_smith"] = is_smith
    soil_records["stiffness"] = ultimate / float(soil.quake) * step  # time in steps
    soil_records["ultimate"] = ultimate
    soil_records["resistance"] = resistance
    soil_records["damping_factor"] = damping_factor
    soil_records["damping"] = damping
    return soil_records


def _drag_of_rod(mesh: Mesh, shaft_index: int, body: int) -> Array:
    """Drag of one rod as `records.SOIL`, [node with drag].

    The damping of a node, N s/m, is the sum of the drag coefficients of the half cells
    beside it. There is no resistance. Nodes without drag have no record. `shaft_index`
    is the index of the rod in `shaft_bodies`.
    """
    rod = mesh.row.system.bodies[body]
    edges = _half_cell_edges_of_rod(mesh, body)
    nodes = _half_cell_nodes_of_rod(mesh, body)
    half_cell_damping = coefficients(rod.shaft, edges, float(rod.length))  # N s/m
    damping = np.bincount(nodes, half_cell_damping)  # sums for each node
    # Nodes with drag, counted from the left end of the rod
    with_drag = np.flatnonzero(damping)
    drag_records = _records_at(mesh, body, shaft_index, with_drag)
    drag_records["damping"] = damping[with_drag]
    return drag_records


def _records_at(mesh: Mesh, body: int, shaft_index: int, nodes: Array) -> Array:
    """Records `records.SOIL` for some nodes of a rod, without numbers of soil, [node].

    `nodes` are counted from the left end of the rod. Three fields are set: `node`, its
    number in the mesh, `shaft`, and `end_of_rod`, which is -1 at the left end of the
    rod, 1 at its right end, and 0 elsewhere. All other fields are 0.
    """
    last_node = _half_cell_nodes_of_rod(mesh, body)[-1]
    is_first_node = np.where(nodes == 0, 1, 0)
    is_last_node = np.where(nodes == last_node, 1, 0)
    first_segment, _ = mesh.row.spans[body]
    blank_records: Array = filled(
        records.SOIL,
        len(nodes),
        node=mesh.first[first_segment] + nodes,
        shaft=shaft_index,
        end_of_rod=is_last_node - is_first_node,
    )
    return blank_records


def _half_cell_nodes_of_rod(mesh: Mesh, body: int) -> Array:
    """Node of each half cell of a rod, counted from its left end, [half cell].

    `body` is the index of the rod in the system.
    """
    first, last = mesh.row.spans[body]  # segments count from 1
    return nodes_of_half_cells(sum(mesh.counts[first - 1 : last]))


def _half_cell_edges_of_rod(mesh: Mesh, body: int) -> Array:
    """Edges of the half cells of a rod, m from its left end, [half cell + 1].

    `body` is the index of the rod in the system. An edge between two segments is listed
    once.
    """
    edges = [np.zeros(1)]  # the left end of the rod
    left = 0.0  # left end of the segment, m from the left end of the rod
    start, stop = mesh.row.spans[body]
    for s in range(start, stop + 1):
        length = float(mesh.row.segments[s - 1].length)  # segments count from 1
        segment_edges = half_cell_edges(left, length, mesh.counts[s - 1])
        # The first edge of a segment is the last one of the segment before it.
        edges.append(segment_edges[1:])
        left += length
    return np.concatenate(edges)


def soil_stiffnesses(row: Row) -> list[float]:
    """Largest stiffness of the soil along the rod of each segment, N/m^2 [segment].

    All segments of a rod have the largest value of the whole rod. It is 0 for rods
    without soil, also for rods with drag.
    """
    stiffnesses = [0.0] * len(row.segments)
    for body in shaft_bodies(row):
        rod = row.system.bodies[body]
        if isinstance(rod.shaft, Drag):
            continue
        largest = largest_stiffness(rod.shaft, float(rod.length))
        start, stop = row.spans[body]  # segments count from 1
        for s in range(start, stop + 1):
            stiffnesses[s - 1] = largest
    return stiffnesses


def ground_velocities(mesh: Mesh, step: float) -> dict[str, Any]:
    """Velocity of the ground in the frame at t = 0, and its change in a step, m/s.

    They are returned by the names of the fields of `records.Run`. The ground is at
    rest; the frame has the velocity row.frame + gravity t, hence the minus signs.
    """
    row = mesh.row
    return {
        "ground_velocity": -float(row.frame),
        "ground_acceleration": -float(row.system.gravity) * step,
    }
