"""Soil along the shafts of the rods of a mesh, as records for `soil_kernel`."""

from typing import Any

import numpy as np

from ...model import Rod
from ...model.soil import largest_stiffness, mobilised_shares, resistances
from ..row import Array, Row
from . import records
from .mesh import Mesh
from .records import filled


def shaft_bodies(row: Row) -> list[int]:
    """Rods of a row that soil holds along their shafts."""
    bodies = []
    for i, body in enumerate(row.system.bodies):
        if isinstance(body, Rod) and body.shaft is not None:
            bodies.append(i)
    return bodies


def soil_of(mesh: Mesh, step: float) -> Array:
    """Soil of all rods, a record for each node that it holds, from left to right.

    Where two rods are bonded, a node has a record for either.
    """
    parts = [filled(records.SOIL, 0)]
    for shaft, body in enumerate(shaft_bodies(mesh.row)):
        parts.append(_soil_of_rod(mesh, step, shaft, body))
    return np.concatenate(parts)


def _soil_of_rod(mesh: Mesh, step: float, shaft: int, body: int) -> Array:
    """Soil of a rod: each node has that of the halves of the cells beside it."""
    rod = mesh.row.system.bodies[body]
    soil = rod.shaft
    edges = half_cell_edges(mesh, body)
    length = float(rod.length)
    nodes = nodes_of_half_cells(mesh, body)
    of_half_cells = resistances(soil, edges, length)
    shares = mobilised_shares(soil, edges, length)
    ultimate = np.bincount(nodes, of_half_cells)
    resistance = np.bincount(nodes, of_half_cells * shares)
    held = np.flatnonzero(ultimate)
    ultimate = ultimate[held]
    resistance = np.clip(resistance[held], -ultimate, ultimate)
    damping_factor = np.full(len(held), float(soil.damping))
    is_smith = soil.law == "smith"
    damping = damping_factor * ultimate
    if is_smith:
        damping = damping_factor * np.abs(resistance)
    first, _ = mesh.row.spans[body]
    soil_records: Array = filled(
        records.SOIL,
        len(held),
        node=mesh.first[first] + held,
        shaft=shaft,
        end_of_rod=np.where(held == nodes[-1], 1, 0) - np.where(held == 0, 1, 0),
        is_smith=is_smith,
        stiffness=ultimate / float(soil.quake) * step,
        ultimate=ultimate,
        resistance=resistance,
        damping_factor=damping_factor,
        damping=damping,
    )
    return soil_records


def half_cell_edges(mesh: Mesh, body: int) -> Array:
    """Edges of the half cells of a rod, m from its left end."""
    edges = [np.zeros(1)]
    left = 0.0
    start, stop = mesh.row.spans[body]
    for s in range(start, stop + 1):
        length = float(mesh.row.segments[s - 1].length)
        halves = 2 * mesh.counts[s - 1]
        edges.append(left + length * np.arange(1, halves + 1) / halves)
        left += length
    return np.concatenate(edges)


def nodes_of_half_cells(mesh: Mesh, body: int) -> Array:
    """Node of each half cell of a rod, counted from its left end."""
    start, stop = mesh.row.spans[body]
    cells = sum(mesh.counts[start - 1 : stop])
    return np.asarray((np.arange(2 * cells) + 1) // 2)


def soil_stiffnesses(row: Row) -> list[float]:
    """Largest stiffness of the soil along each segment of a row, N/m^2; 0 without soil."""
    stiffnesses = [0.0] * len(row.segments)
    for body in shaft_bodies(row):
        rod = row.system.bodies[body]
        largest = largest_stiffness(rod.shaft, float(rod.length))
        start, stop = row.spans[body]
        for s in range(start, stop + 1):
            stiffnesses[s - 1] = largest
    return stiffnesses


def ground_velocities(mesh: Mesh, step: float) -> dict[str, Any]:
    """Velocity of the ground in the frame at t = 0, m/s, and its change in a step."""
    row = mesh.row
    return {
        "ground_velocity": -float(row.frame),
        "ground_acceleration": -float(row.system.gravity) * step,
    }
