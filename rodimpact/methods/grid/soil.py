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
    """Numbers of the bodies of a row on which soil or drag acts along their shafts.

    They are those of `system.bodies`, from left to right. A shaft's place in this list
    is its number in the records of soil.
    """
    bodies = []
    for i, body in enumerate(row.system.bodies):
        if isinstance(body, Rod) and body.shaft is not None:
            bodies.append(i)
    return bodies


def soil_of(mesh: Mesh, step: float) -> Array:
    """Soil and drag of all rods at t = 0 as `records.SOIL`, from left to right.

    There is a record for each node that soil or drag holds; where two rods are bonded,
    one for either. Without any the array is empty. Stiffnesses are for time in steps of
    `step`, s.
    """
    parts = [filled(records.SOIL, 0)]  # empty, as np.concatenate needs one
    for shaft_index, body in enumerate(shaft_bodies(mesh.row)):
        if isinstance(mesh.row.system.bodies[body].shaft, Drag):
            parts.append(_drag_of_rod(mesh, shaft_index, body))
        else:
            parts.append(_soil_of_rod(mesh, step, shaft_index, body))
    return np.concatenate(parts)


def _soil_of_rod(mesh: Mesh, step: float, shaft_index: int, body: int) -> Array:
    """Soil of one rod at t = 0 as `records.SOIL`, [node in soil].

    A node has the ultimate resistance of the halves of the cells beside it, and the
    part of it that is mobilised, with its sign; nodes without ultimate resistance have
    no record. The damping by Smith's law is that of the mobilised part, else that of
    the ultimate one. `shaft_index` is the place of the rod among the `shaft_bodies`.
    """
    rod = mesh.row.system.bodies[body]
    soil = rod.shaft
    edges = _edges_of_half_cells(mesh, body)
    length = float(rod.length)
    nodes = _nodes_of_half_cells(mesh, body)
    half_cell_ultimate = resistances(soil, edges, length)  # N
    mobilised = mobilised_shares(soil, edges, length)  # -1 to 1
    # Sums over the half cells of each node of the rod
    at_nodes = np.bincount(nodes, half_cell_ultimate)
    mobilised_at_nodes = np.bincount(nodes, half_cell_ultimate * mobilised)
    in_soil = np.flatnonzero(at_nodes)  # nodes, counted from the left end of the rod
    ultimate = at_nodes[in_soil]
    # Round-off may leave a resistance beyond the ultimate one.
    resistance = np.clip(mobilised_at_nodes[in_soil], -ultimate, ultimate)
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

    Each node has that of the halves of the cells beside it, as a damping, N s/m,
    without resistance; nodes without drag have no record. `shaft_index` is the place of
    the rod among the `shaft_bodies`.
    """
    rod = mesh.row.system.bodies[body]
    edges = _edges_of_half_cells(mesh, body)
    nodes = _nodes_of_half_cells(mesh, body)
    # Drag coefficients of half cells, N s/m, added up for each node
    damping = np.bincount(nodes, coefficients(rod.shaft, edges, float(rod.length)))
    dragged = np.flatnonzero(damping)  # nodes, counted from the left end of the rod
    drag_records = _records_at(mesh, body, shaft_index, dragged)
    drag_records["damping"] = damping[dragged]
    return drag_records


def _records_at(mesh: Mesh, body: int, shaft_index: int, places: Array) -> Array:
    """Blank records `records.SOIL` of `places`, nodes of a rod, [place].

    Places are counted from the left end of the rod. The records have the node in the
    mesh, `shaft_index`, and -1 or 1 where the node is the left or right end of the rod;
    all else is 0.
    """
    last_place = _nodes_of_half_cells(mesh, body)[-1]
    is_first_node = np.where(places == 0, 1, 0)
    is_last_node = np.where(places == last_place, 1, 0)
    first_segment, _ = mesh.row.spans[body]
    blank_records: Array = filled(
        records.SOIL,
        len(places),
        node=mesh.first[first_segment] + places,
        shaft=shaft_index,
        end_of_rod=is_last_node - is_first_node,
    )
    return blank_records


def _nodes_of_half_cells(mesh: Mesh, body: int) -> Array:
    """Node of each half cell of a rod, counted from its left end, [half cell]."""
    first, last = mesh.row.spans[body]
    return nodes_of_half_cells(sum(mesh.counts[first - 1 : last]))


def _edges_of_half_cells(mesh: Mesh, body: int) -> Array:
    """Edges of the half cells of a rod, m from its left end, [half cell + 1].

    Edges between segments are there once.
    """
    edges = [np.zeros(1)]  # the left end of the rod
    left = 0.0  # left end of the segment
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

    All segments of a rod have that of the whole rod. It is 0 without soil, and for
    drag.
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

    They are fields of `records.Run`, by name. The ground rests, the frame moves and
    falls.
    """
    row = mesh.row
    return {
        "ground_velocity": -float(row.frame),
        "ground_acceleration": -float(row.system.gravity) * step,
    }
