"""Radial motion of cells on a grid, by Mindlin and Herrmann: a strain q of its own in each cell.

In a cell of stiffness k at constant q, du being how much longer it is, and between neighbours,

    tension = k du + b q,    J q_tt = change of (s times the change of q) - G q - b du

so that G q + b du is (G - b^2/k) q + b/k times the tension. Both are kicked and drift together with
the nodes, which keeps v M v/2 + (u K u - v K v/4)/2 with q among the displacements u.

Units are those of `contact_law_kernel`: J/h, G h, b h, s h, and q/h for the strain.
"""

from __future__ import annotations

from typing import Any, NamedTuple

FAR = (1 << 40) - 1  # n & FAR tells the compiler that n >= 0, so that its loops run in vectors


class Radial(NamedTuple):
    """Cells with a radial strain of their own; 0 in the others."""

    first: Any  # [stretch] of such cells one after the other: its first and
    last: Any  # [stretch] last cell
    strain: Any  # [cell] q in the middle of the last step
    rate: Any  # [cell]
    ease: Any  # [cell] 1/J
    coupling: Any  # [cell] b
    own: Any  # [cell] G - b^2/k
    share: Any  # [cell] b/k
    shear: Any  # [node] s between its cells


def drift_radially(radial: Radial, force: Any) -> None:
    """Radial strains in the middle of the step, and what they add to the forces."""
    strain, rate, coupling = radial.strain, radial.rate, radial.coupling
    for g in range(len(radial.first)):
        for i in range(radial.first[g] & FAR, (radial.last[g] & FAR) + 1):
            strain[i] += rate[i]
            force[i] += coupling[i] * rate[i]


def kick_radially(radial: Radial, force: Any) -> None:
    """Rates of radial strain."""
    strain, rate, ease, shear = radial.strain, radial.rate, radial.ease, radial.shear
    own, share = radial.own, radial.share
    for g in range(len(radial.first)):
        b, before = radial.last[g] & FAR, 0.0
        for i in range(radial.first[g] & FAR, b):
            after = shear[i] * (strain[i + 1] - strain[i])
            rate[i] += ease[i] * (after - before - own[i] * strain[i] - share[i] * force[i])
            before = after
        rate[b] += ease[b] * (-before - own[b] * strain[b] - share[b] * force[b])


def energy_of_cell(radial: Radial, i: int, change: float) -> float:
    """What its q adds to the energy of cell i, whose nodes part at the velocity `change`.

    That of its shear against the next cell is with it.
    """
    p, s = radial.rate[i], radial.shear[i]
    if radial.ease[i] == 0:
        return 0.0
    q, coupling = radial.strain[i] + p / 2, radial.coupling[i]
    stiffness = radial.own[i] + radial.share[i] * coupling
    energy: float = p * p / (2 * radial.ease[i]) + radial.own[i] * q * q / 2
    energy -= (2 * coupling * change * p + stiffness * p * p) / 8
    if s > 0:
        faster = radial.rate[i + 1] - p
        slope = radial.strain[i + 1] - radial.strain[i] + faster / 2
        energy += s * (slope * slope - faster * faster / 4) / 2
    return energy
