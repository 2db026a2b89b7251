"""A rigid mass strikes a rod: with its far end free, and with its far end fixed.

Free: with mu = m/M, the rod's mass over the striker's, the force is Z V exp(-t Z/M) for 2 L/c; then
the reflected wave meets the mass and ends it. e = (1 - exp(-2 mu))/mu - exp(-2 mu), impulse
M V (1 - exp(-2 mu)). Expected: that to 1e-12 at the default tolerance.

Fixed: the blow goes to and fro while the mass presses. Contact time in L/c, peak stress in rho c V
at the struck and at the fixed end, velocity of the mass over V as it lets go: the table is for the
first contact. For M/m = 1, 4 and 6 the rod swings back and strikes the mass once more, which leaves
for good with another velocity. Timoshenko and Goodier are remembered to give 7.419 for M/m = 6; two
computations independent of this one give 7.4077.

Source: B. de Saint-Venant and J. Boussinesq, in S. P. Timoshenko and J. N. Goodier, Theory of
Elasticity, longitudinal impact of bars.
"""

import math

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SOURCE = "Saint-Venant, Boussinesq"
ROD = rod(1.0)  # mass, impedance and transit time 1
MASSES = (1.0, 2.0, 4.0, 6.0)
FIRST = {  # contact: time, peak at the struck end, at the fixed end, velocity of the mass after it
    1.0: (3.068, 2.1353, 2.2707, -0.6876),
    2.0: (4.709, 2.3679, 2.7358, -0.9252),
    4.0: (5.900, 2.9744, 3.2131, -0.8169),
    6.0: (7.408, 3.4688, 3.5045, -0.9297),
}
LAST = {1.0: (2, -0.69888), 2.0: (1, -0.92525), 4.0: (2, -0.95927), 6.0: (2, -0.93941)}
"""Contacts in all, velocity of the mass after the last one."""


def run() -> Rows:
    """Free rods, fixed rods."""
    return free(), fixed()


def exact(ratio: float) -> tuple[float, float]:
    """Restitution and impulse for a mass of `ratio` at speed 1 on a free rod."""
    mu = 1 / ratio
    passed = -math.expm1(-2 * mu)
    return round(passed / mu - (1 - passed), 12), round(ratio * passed, 12)


def free() -> Rows:
    """Three masses at the default tolerance."""
    for ratio in (0.25, 1.0, 4.0):
        o = ri.solve(ri.System([ri.RigidMass(ratio, velocity=1.0), ROD])).outcome
        case, (e, impulse) = (
            Case(f"mass on free rod, M/m = {ratio:g}", SOURCE),
            exact(ratio),
        )
        yield case.row("e", e, o.restitution, 1e-12)
        yield case.row("impulse over m V", impulse, o.impulse, 1e-12)
        yield case.row("contact time, L/c", 2.0, o.duration, 1e-12)
        yield case.row(
            "energy after - before, relative",
            0.0,
            o.energy_residual,
            1e-13,
            "conserved",
        )


def fixed() -> Rows:
    """The first contact, and what is left after the last."""
    for ratio in MASSES:
        time, speed, struck, held = first_contact(ratio)
        case = Case(
            f"mass on rod with fixed end, M/m = {ratio:g}",
            "delay equation, step by step",
        )
        names = (
            "time, L/c",
            "peak stress at the struck end, rho c V",
            "peak stress at the fixed end, rho c V",
            "velocity of the mass after it, V",
        )
        bounds = (5e-4, 5e-5, 5e-5, 5e-5)  # half of the last digit
        for name, expected, got, bound in zip(
            names, FIRST[ratio], (time, struck, held, speed), bounds, strict=True
        ):
            yield case.row(f"first contact: {name}", expected, got, bound, SOURCE)
        o, (contacts, velocity) = ri.solve(on_fixed_rod(ratio)).outcome, LAST[ratio]
        yield case.row(
            "contacts until it is final", contacts, o.contacts[0].episodes, 0.0
        )
        yield case.row(
            "velocity of the mass after the last contact, V",
            velocity,
            o.velocities_after[0] if o.final else math.nan,
            5e-6,
        )


def on_fixed_rod(ratio: float) -> ri.System:
    """A mass at speed 1 touches the rod, whose other end is fixed."""
    striker = ri.RigidMass(ratio, velocity=1.0)
    return ri.System([striker, ROD], ends=(ri.Free(), ri.Fixed()))


def first_contact(ratio: float) -> np.ndarray:
    """Contact time, velocity of the mass after it, peak stress at struck and fixed end."""
    solution = ri.solve(on_fixed_rod(ratio), until=9.0)
    end = solution.contacts[0].episodes[0].force_end
    near, far = (
        np.union1d(np.linspace(0, t, 4001), np.arange(t)) for t in (end, end + 1)
    )
    force, stress = solution.contacts[0].force(near), -solution.stress(1, 1.0, far)
    after = float(solution.velocity(0, 0.0, end))
    return np.array([end, after, force.max(), stress.max()])
