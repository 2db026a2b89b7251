"""The proof of finality on a grid: how each side of a contact moves, from the present state.

On each side stands a group of pieces with the joints between them. A far endless bar of impedance Z
gives way by the momentum it has taken, over Z, and a joint that is a dashpot alone by the change of
momentum over its c.
"""

import math
from typing import NamedTuple

import numpy as np

from .. import abilities, finality_kernel
from ..link import Law
from ..row import Array
from .mesh import GridMotion, quotient
from .run import GridRun


class Side(NamedTuple):
    """One side of a contact, SI."""

    mean: float  # velocity
    deviation: float  # of the end from the mean motion, positive to the right
    bound: float  # that it can ever reach


def finality_time(run: GridRun) -> float:
    """Time until it may be proved that nothing meets again, s: 0 if it is, inf if not as it is."""
    if abilities.driven(run.row.system):
        return math.inf
    wait, tol, now = 0.0, float(run.grid.run["velocity_tolerance"][0]), present(run)
    still = tol * run.step  # a bound up to which ends move as their groups do
    for at in run.grid.links[run.grid.links["law"] != Law.JOINT]:
        gap = float(at["gap"]) * run.step
        if gap < 0:
            return math.inf
        one, other = (
            side_of(run, at["left_node"], True, now),
            side_of(run, at["right_node"], False, now),
        )
        reach, opening = one.bound + other.bound, other.mean - one.mean
        least = opening if max(one.bound, other.bound) <= still else -math.inf
        apart = gap + one.deviation - other.deviation
        wait = max(
            wait,
            finality_kernel.separation_time(opening, least, apart, reach * reach, tol),
        )
    return wait


def present(run: GridRun) -> tuple[GridMotion, Array]:
    """The last state, and by how much cells are longer in it, m."""
    motion = run.motion(slice(-1, None))
    return motion, motion.stretches(run.step)[0]


def side_of(
    run: GridRun, node: int, right_end: bool, now: tuple[GridMotion, Array]
) -> Side:
    """What the proof asks of a group that has this node at its right or left end.

    The end is half a step ahead of the cells, by no more than the velocity that the energy gives.
    """
    mesh, (motion, longer), h = run.mesh, now, run.step
    a, b = next((a, b) for a, b in mesh.groups if a <= node <= b)
    nodes, far = slice(a, b + 1), a if right_end else b
    m, v = mesh.mass[nodes], motion.velocity[0, nodes]
    # relative to the first node, so that a body without vibration has no deviation
    mean, Z = float(v[0] + m @ (v - v[0]) / (m.sum() or 1.0)), 0.0
    if mesh.held[far]:
        mean = float(motion.velocity[0, far])
    for side, (kind, _) in enumerate(run.row.outside):
        if kind == "absorbing" and mesh.ends[side] == far:
            Z, mean = (
                float(run.grid.ends[name][side])
                for name in ("impedance", "background_wave")
            )
    if a == b:
        return Side(mean, 0.0, 0.0)
    beyond = np.cumsum(m[:-1]) / m.sum()
    g = np.ones(b - a) if mesh.held[far] or Z else beyond if right_end else 1 - beyond
    energy = sum(motion.energies(nodes, m, 0, v - mean, h))
    stretch, loose = longer[a + 1 : b + 1].copy(), 0.0
    slack = quotient(1.0, mesh.cells.relaxed[a + 1 : b + 1])
    for place, (link, (_, right)) in enumerate(mesh.touching.items()):
        if a < right <= b:
            cell, k = right - a - 1, float(run.row.links[link].stiffness)
            if k > 0:
                stretch[cell] = run.grid.links["gap"][place] * h
                slack[cell] = 1 / k
                energy += k * stretch[cell] ** 2 / 2
            else:
                loose += 2 * g[cell] / float(run.row.links[link].damping)
    d, yielding = float(stretch @ g) * (1 if right_end else -1), float(g * g @ slack)
    if Z > 0:
        d -= float(m @ (v - mean)) / Z
        yielding = 2 * (yielding + m.sum() / (Z * Z))
    if loose > 0:
        yielding = 2 * (yielding + m.sum() * loose * loose)
    energy = max(energy, 0.0)
    bound = math.sqrt(2 * energy * yielding) + h * math.sqrt(
        energy / (2 * mesh.mass[node])
    )
    return Side(mean, d, bound)
