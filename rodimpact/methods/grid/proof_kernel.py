"""What the proof of finality asks of a grid.

On each side of a contact stands a group of pieces with the joints between them. A far endless bar
of impedance Z gives way by the momentum it has taken, over Z, and a joint that is a dashpot alone
by the change of momentum over its c.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from .. import finality_kernel as proof
from ..laws import Law
from .records import NONE, End


class Side(NamedTuple):
    """One side of a contact; times in steps, lengths as velocities."""

    mean: float  # velocity
    low: float  # bounds of the end's velocity as long as it is free; infinite if not known
    high: float
    deviation: float  # of the end from the mean motion, positive to the right
    bound: float  # that it can ever reach


def finality_time(grid: Any, group: Any, cell: Any) -> float:
    """Steps until it may be proved that nothing meets again: 0 if it is, inf if not as it is.

    For rows whose ends are not driven.
    """
    wait, link, tol = 0.0, grid.link, grid.run[0].tolerance
    stretch(cell, grid.velocity, grid.force, grid.stiffness, grid.strain, grid.rate, link)
    for i in range(len(link)):
        at = link[i]
        if at.law != Law.JOINT:
            if at.gap < 0:
                return math.inf
            left = side_of(group[at.left_group], cell, grid.velocity, grid.end, True, tol)
            right = side_of(group[at.right_group], cell, grid.velocity, grid.end, False, tol)
            reach = left.bound + right.bound
            wait = max(wait, proof.separation_time(
                right.mean - left.mean, right.low - left.high,
                at.gap + left.deviation - right.deviation, reach * reach, tol))
    return wait


def stretch(
    cell: Any, v: Any, force: Any, stiffness: Any, strain: Any, rate: Any, link: Any
) -> None:
    """Find how much cells and joints are stretched, with what energy, and how much they yield."""
    for i in range(1, len(v)):
        at, k, change = cell[i], stiffness[i], v[i] - v[i - 1]
        now = force[i] + k * change / 2 + at.coupling * rate[i] / 2
        at.slack, at.loose = at.relaxed, 0.0
        if at.joint != NONE:
            k, change = link[at.joint].stiffness, 0.0
            now, at.slack = k * link[at.joint].gap, k
            if k == 0:
                at.loose = link[at.joint].damping
        if k > 0:
            at.moving = at.lateral * change * change / 2
            at.strained = (now * now - k * k * change * change / 4) / (2 * k)
            at.strain = (now - at.coupling * (strain[i] + rate[i] / 2)) / k
        at.radial = 0.0
        if at.ease > 0:
            at.radial = radial_energy(at, change, strain, rate, i)


def radial_energy(at: Any, change: float, strain: Any, rate: Any, i: int) -> float:
    """What its q adds to the energy of cell i, whose nodes part at the velocity `change`.

    That of its shear against the next cell is with it.
    """
    p, q = rate[i], strain[i] + rate[i] / 2
    stiffness = at.own + at.share * at.coupling
    energy: float = p * p / (2 * at.ease) + at.own * q * q / 2
    energy -= (2 * at.coupling * change * p + stiffness * p * p) / 8
    if at.shear > 0:
        faster = rate[i + 1] - p
        slope = strain[i + 1] - strain[i] + faster / 2
        energy += at.shear * (slope * slope - faster * faster / 4) / 2
    return energy


def side_of(
    group: Any, cell: Any, v: Any, end: Any, right_end: bool, tol: float
) -> Side:
    """What the proof asks of a group, whose right or left end is at the contact.

    The end is half a step ahead of the cells, by no more than the velocity that the energy gives.
    """
    a, b = group.first, group.last
    near, far = (b, a) if right_end else (a, b)
    mass, Z = 0.0, 0.0
    momentum = 0.0  # relative to the first node, so that a body without vibration has none
    for n in range(a, b + 1):
        mass += cell[n].mass
        momentum += cell[n].mass * (v[n] - v[a])
    held = cell[far].held > 0
    if held:
        mean = v[far]
    else:
        mean = v[a] + momentum / mass
        for s in range(2):
            if end[s].node == far and end[s].kind == End.ENDLESS:
                Z, mean = end[s].impedance, end[s].rest
    if a == b:
        return Side(mean, mean, mean, 0.0, 0.0)
    energy = taken = beyond = d = slack = loose = 0.0
    for n in range(a, b + 1):
        u = v[n] - mean
        energy += cell[n].mass * u * u / 2
        taken += cell[n].mass * u
        if n < b:
            at, g = cell[n + 1], 1.0
            beyond += cell[n].mass / mass
            if not held and Z == 0:
                g = beyond if right_end else 1 - beyond
            if at.loose > 0:
                loose += 2 * g / at.loose
                continue
            energy += at.moving
            energy += at.strained
            energy += at.radial
            d += at.strain * g
            slack += g * g / at.slack
    if not right_end:
        d = -d
    if Z > 0:
        d -= taken / Z
        slack = 2 * (slack + mass / (Z * Z))
    if loose > 0:
        slack = 2 * (slack + mass * loose * loose)
    energy = max(energy, 0.0)
    bound = math.sqrt(2 * energy * slack) + math.sqrt(energy / (2 * cell[near].mass))
    if bound <= tol:
        return Side(mean, mean, mean, d, bound)
    return Side(mean, -math.inf, math.inf, d, bound)
