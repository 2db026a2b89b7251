"""Radial motion of cells on a grid, by Mindlin and Herrmann: a strain q of its own in each cell.

In a cell of stiffness k at constant q, du being how much longer it is, and between neighbours,

    tension = k du + b q,    J q_tt = change of (s times the change of q) - G q - b du

so that G q + b du is (G - b^2/k) q + b/k times the tension. Both are kicked and drift together with
the nodes, which keeps v M v/2 + (u K u - v K v/4)/2 with q among the displacements u.
"""

from __future__ import annotations

from typing import Any


def drift(strain: Any, rate: Any, coupling: Any, force: Any) -> None:
    """Radial strains in the middle of the step, and what they add to the forces."""
    for i in range(len(strain)):
        strain[i] += rate[i]
        force[i] += coupling[i] * rate[i]


def kick(
    strain: Any, rate: Any, ease: Any, own: Any, share: Any, shear: Any, force: Any
) -> None:
    """Rates of radial strain."""
    before = 0.0
    for i in range(len(strain) - 1):
        after = shear[i] * (strain[i + 1] - strain[i])
        rate[i] += ease[i] * (after - before - own[i] * strain[i] - share[i] * force[i])
        before = after
