"""A bar thrown on a rigid floor without gravity.

E = 900, rho = 1, L = 10, A = 1, from a height of 5 at speed 10: contact from 0.5 to 7/6 with the
force Z v = 300, then the bar goes back as it came.

Source: D. Doyen, A. Ern, S. Piperno, Time-integration schemes for the finite element dynamic
Signorini problem, SIAM Journal on Scientific Computing 33 (2011).
"""

from __future__ import annotations

import rodimpact as ri

from .table import Row


def run() -> list[Row]:
    """The bar to the right of the floor."""
    material = ri.Material("bar", youngs_modulus=900.0, density=1.0)
    bar = ri.Rod(10.0, area=1.0, material=material, velocity=-10.0)
    solution = ri.solve(ri.System([ri.Wall(), bar], gaps=[5.0]))
    o, episode = solution.outcome, solution.contacts[0].episodes[0]
    case, source = "Doyen et al., bar on floor", "Doyen, Ern and Piperno 2011"
    return [
        Row(case, "contact begins", source, 0.5, episode.start, 1e-14),
        Row(case, "contact ends", source, 7 / 6, episode.opening, 1e-14),
        Row(case, "force", source, 300.0, o.peak_force, 1e-11),
        Row(case, "velocity after", source, 10.0, o.velocities_after[1], 1e-12),
        Row(case, "vibration energy after", source, 0.0, o.vibration_after[1], 1e-11),
    ]
