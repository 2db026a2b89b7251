"""A compressed bar, clamped at one end, is released above a floor: exactly periodic.

L = c = 1, E A = 1. The bar is clamped at x = 1 and has a unilateral floor at x = 0. It is released
at rest with u = 1/2 - x/2, so it is compressed by 1/2 and its lower end is 1/2 above the floor. The
end falls at speed 1/2, reaches the floor at t = 1, rests on it with force 1/2 until t = 2, rises
until t = 3, and everything begins anew with period 3.

Source: demo_dynamic_contact_1D of GetFEM, after F. Dabaghi, A. Petrov, J. Pousin, Y. Renard,
Convergence of mass redistribution method for the one-dimensional wave equation with a unilateral
constraint at the boundary, ESAIM: Mathematical Modelling and Numerical Analysis 48 (2014).
"""

from __future__ import annotations

import numpy as np

import rodimpact as ri

from .table import Row

X = np.linspace(0.0, 1.0, 41)


def run() -> list[Row]:
    """Floor, bar, wall bonded to the bar."""
    unit = ri.Material("unit", youngs_modulus=1.0, density=1.0)
    bar = ri.Rod(1.0, area=1.0, material=unit, strain=-0.5)
    row = ri.System(
        [ri.Wall(), bar, ri.Wall()], gaps=[0.5, 0.0], contacts=[ri.Rigid(), ri.Bonded()]
    )
    solution = ri.solve(row, until=6.75)
    floor = solution.contacts[0]
    case, source = "GetFEM, released bar", "Dabaghi et al. 2014"
    t = np.linspace(0.0, 6.75, 271)
    phase = t % 3.0
    height = np.where(phase < 1, (1 - phase) / 2, np.where(phase < 2, 0.0, (phase - 2) / 2))
    middle = (t + 0.0125)[:-1]
    force = np.where((middle % 3.0 > 1) & (middle % 3.0 < 2), 0.5, 0.0)
    rows = [
        Row(case, "height of the lower end, largest difference", source, 0.0,
            float(np.abs(floor.gap(t) - height).max()), 1e-13),
        Row(case, "contact force, largest difference", source, 0.0,
            float(np.abs(floor.force(middle) - force).max()), 1e-14),
    ]
    for i, episode in enumerate(floor.episodes):
        rows += [
            Row(case, f"contact {i + 1} begins", source, 1.0 + 3 * i, episode.start, 1e-14),
            Row(case, f"contact {i + 1} ends", source, 2.0 + 3 * i, episode.opening, 1e-14),
        ]
    for later in (3.0, 6.0):
        apart = [
            np.abs(field(1, X, later) - field(1, X, 0.0)).max()
            for field in (solution.velocity, solution.strain, solution.displacement)
        ]
        rows.append(Row(case, f"state at t = {later:g}, largest difference from t = 0", source,
                        0.0, float(max(apart)), 1e-13))
    return rows
