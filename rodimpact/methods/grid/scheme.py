"""From a mesh and a step to the arrays of the kernels, all but the state of motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...model.profiles import averages
from .. import compiling
from ..laws import KNOTS, UNREACHED, Beyond
from ..row import Array, Row, whole
from ..walk import wave_of_strain
from . import elimination_kernel as elimination
from . import records
from .mesh import Mesh
from .records import NONE, Grid

LEAST = 2.0**-800  # stiffness, where time is counted in steps
TOLERANCE = 2.0**-40  # of the velocities, below which contacts graze: round-off of many steps
GAP_RESOLUTION = 1.0  # of what bodies cover in a step: dispersed waves open smaller gaps
KINDS = {"none": Beyond.STEADY, "force": Beyond.PUSHED, "velocity": Beyond.MOVED,
         "absorbing": Beyond.ENDLESS}


def grid_of(mesh: Mesh, step: float) -> Grid:
    """Everything at rest and without force, gaps as they are."""
    row, h, n = mesh.row, step, len(mesh.mass)
    mass, bound = mesh.mass / h, bound_of(mesh, h)
    for side, (kind, _) in enumerate(row.outside):
        if kind == "absorbing":
            mass[mesh.ends[side]] += impedance(mesh, side) / 2
    implicit = spans_of(mesh)
    node = _nodes(mesh, implicit, mass, bound)
    mobility = np.where(mesh.hidden, 0.0, mobility_of(mesh, mass))
    stiffness, cells = mesh.stiffness * h, mesh.cells
    swells = cells.swelling > 0
    constant = np.where(cells.stiffness > 0, cells.stiffness, 1.0)
    return Grid(
        run=filled(records.RUN, 1, tolerance=TOLERANCE * row.scale,
                   resolution=GAP_RESOLUTION * row.scale, swells=mesh.swells),
        velocity=np.zeros(n), force=np.zeros(n + 1), mobility=mobility, stiffness=stiffness,
        piece=filled(records.PIECE, len(mesh.starts), start=mesh.starts),
        implicit=implicit, node=node, viscous=mesh.viscous, lost=np.zeros(n + 1),
        change=np.zeros(n), old=np.zeros(n),
        strain=np.zeros(n + 1), rate=np.zeros(n + 1),
        ease=np.divide(h, cells.swelling, out=np.zeros(n + 1), where=swells),
        coupling=cells.coupling * h,
        own=(cells.radial - cells.coupling**2 / constant) * h, share=cells.coupling / constant,
        shear=np.append(mesh.shear * h, 0.0),
        link=_links(mesh, h, mobility, node),
        end=filled(records.END, 2, kind=[KINDS[kind] for kind, _ in row.outside], node=mesh.ends,
                   impedance=[impedance(mesh, side) for side in (0, 1)]),
        watched=whole(mesh.watched), pulled=whole(mesh.pulled),
    )


def bound_of(mesh: Mesh, step: float) -> Array:
    """By what a cell joins the changes of velocity at its nodes [cell]."""
    bound: Array = mesh.lateral / step + mesh.viscous / 2
    return bound


def filled(kind: Any, count: int, /, **columns: Any) -> Array:
    """Records of a kind, some of whose fields are given."""
    found = np.zeros(count, kind)
    for name, values in columns.items():
        found[name] = values
    return found


def impedance(mesh: Mesh, side: int) -> float:
    """Impedance sqrt(E A rho A) of the rod's last cell at an end."""
    cell = mesh.ends[side] + (1 if side == 0 else 0)
    return math.sqrt(float(mesh.cells.relaxed[cell] * mesh.cell_mass[cell]))


def mobility_of(mesh: Mesh, mass: Array) -> Array:
    """1/mass of nodes, 0 where the velocity is given."""
    return np.where(mesh.held == 1, 0.0, 1 / np.where(mass > 0, mass, 1.0))


# Implicit pieces ----------------------------------------------------------------------------------


def spans_of(mesh: Mesh) -> Array:
    """Pieces with damping or lateral inertia, before their elimination."""
    first, last = (np.array(nodes)[mesh.implicit] for nodes in (mesh.starts, mesh.stops))
    return filled(records.IMPLICIT, len(first), first=first, middle=(first + last) // 2, last=last)


def eliminated(
    mesh: Mesh, implicit: Array, mass: Array, bound: Array
) -> tuple[list[Any], list[Any]]:
    """Implicit pieces and nodes as objects, with their multipliers."""
    pieces = compiling.as_objects(implicit)
    nodes = compiling.as_objects(np.zeros(len(mass), records.NODE))
    diagonal, bounds = (mass + bound[:-1] + bound[1:]).tolist(), bound.tolist()
    for piece in pieces:
        elimination.factor(piece, nodes, bounds, diagonal, mesh.held.tolist())
    return pieces, nodes


def _nodes(mesh: Mesh, implicit: Array, mass: Array, bound: Array) -> Array:
    """Nodes of implicit pieces; enters in the pieces what their middle takes."""
    if not len(implicit):
        return np.zeros(len(mass), records.NODE)
    pieces, nodes = eliminated(mesh, implicit, mass, bound)
    implicit[:] = compiling.as_records(pieces, records.IMPLICIT)
    found: Array = compiling.as_records(nodes, records.NODE)
    for name, ends in (("by_first", implicit["first"]), ("by_last", implicit["last"])):
        push = np.zeros(len(nodes))
        push[ends] = mesh.held[ends] == 0
        found[name] = answered(pieces, nodes, push)
    return found


def answered(pieces: list[Any], nodes: list[Any], push: Array) -> Array:
    """By how much implicit pieces change their velocities for these forces [node]."""
    x = push.tolist()
    for piece in pieces:
        elimination.substitute(piece, nodes, x)
    return np.array(x)


# Links -------------------------------------------------------------------------------------------


def _links(mesh: Mesh, h: float, mobility: Array, node: Array) -> Array:
    """Links, each between two neighbouring pieces."""
    row, chosen, hidden = mesh.row, list(mesh.touching), np.array(mesh.implicit)
    left, right = np.array(mesh.stops[:-1], np.int64), np.array(mesh.starts[1:], np.int64)
    order = np.where(hidden, np.cumsum(hidden) - 1, NONE)  # of implicit pieces, by piece
    to_left = np.where(hidden[:-1], node["by_last"][left], mobility[left]) / 2
    to_right = np.where(hidden[1:], node["by_first"][right], mobility[right]) / 2
    # two links feel each other through a piece of one node, or one that answers as a whole
    shared = np.zeros(len(chosen))
    shared[1:] = np.where(hidden[1:-1], node["by_first"][left[1:]], np.where(
        left[1:] == right[:-1], mobility[left[1:]], 0.0)) / 2
    begins = np.flatnonzero(shared == 0)
    last = np.full(len(chosen), NONE)
    last[begins] = np.append(begins[1:], len(chosen)) - 1
    gap = np.array(row.gap, float)[chosen] / h
    columns = {name: np.array(getattr(row, name))[chosen]
               for name in ("exponent", "damping", "strength")}
    knots, shares = np.full((len(chosen), KNOTS), UNREACHED), np.zeros((len(chosen), KNOTS))
    for i, k in enumerate(chosen):
        for j, (force, hardening) in enumerate(row.table[k]):
            knots[i, j], shares[i, j] = force, hardening
    return filled(
        records.LINK, len(chosen), law=np.array(row.laws)[chosen],
        stiffness=stiffness_in_steps(row, h)[chosen], left=left, right=right,
        left_implicit=order[:-1], right_implicit=order[1:], last=last, own=to_left + to_right,
        shared=shared, gap=gap, knots=knots, shares=shares, open=1, shut=gap == 0, **columns,
    )


def stiffness_in_steps(row: Row, step: float) -> Array:
    """Stiffness of each link where time is counted in steps, s, and lengths as velocities."""
    scaled = [k * step**p for k, p in zip(row.stiffness, row.exponent, strict=True)]
    for k, p, small in zip(row.stiffness, row.exponent, scaled, strict=True):
        if k > 0 and small < LEAST:
            message = f"a force of {k!r} times the indentation to the {p:g} vanishes in steps"
            raise InvalidModel([("contacts", f"{message} of {step:.3g} s; use a lower power")])
    return np.array(scaled)


# What drives the ends -----------------------------------------------------------------------------


def driven(mesh: Mesh, step: float, side: int, steps: int) -> Array:
    """What is given at an end in each step: force, wave, or velocity at its end in the frame."""
    kind, value = mesh.row.outside[side]
    if kind == "velocity":
        return moved(mesh.row, step, value, step * np.arange(1, steps + 1))
    if kind == "none":
        return np.zeros(steps)
    pushes = pushed(step, value, steps)
    return pushes if kind == "force" else wave_of_strain(mesh.row, side) * pushes


def pushed(step: float, value: Any, steps: int) -> Array:
    """What drives an end at each kick: its mean over two steps, which waves can follow."""
    halves = averages(value, step / 2 * np.arange(2 * steps + 2), 0.0)
    around = np.concatenate((halves[:1], halves))
    mean: Array = (around[:-3:2] + around[1:-2:2] + around[2:-1:2] + around[3::2]) / 4
    return mean


def moved(row: Row, step: float, value: Any, t: Array) -> Array:
    """Velocity of a wall or a driven end, averaged over a step about times t, in the frame."""
    if isinstance(value, float):
        found: Array = np.full(len(t), value)
    else:
        edges = np.append(t - step / 2, t[-1:] + step / 2)
        found = averages(value, np.maximum(edges, 0.0), 0.0)
    result: Array = found - row.frame - row.gravity * t
    return result
