"""A steel rod with a spherical end on a wall, and a ball on a rod: against the method of steps.

Where a rod of free far end is struck with the force F, the wave that left its end comes back after
2 T, so its end yields by Y F(t) + 2 Y [F(t - 2 T) + F(t - 4 T) + ...], Y = 1/Z. A mass M yields by
J(t)/M, J the impulse so far. The indentation d therefore obeys the delay equation

    d' = V - sum over rods of Y [F(t) + 2 F(t - 2 T) + ...] - J/M,  F = k max(d, 0)^(3/2),

solved from one reflection to the next with scipy's DOP853 at a relative tolerance of 1e-12: no
time step in common with the package, and no line of code.

The rod is 0.5 m long and 20 mm thick, its end a sphere of 50 mm, E* = E/(2 (1 - nu^2)) as against a
wall of the same steel, V = 2 m/s; the ball is a rigid mass with that stiffness. Expected at the
default tolerance: the impulse to 1e-8, and the peak force to the 6 digits that the reference has.
At a relative tolerance of 1e-10 the energy is kept to 1e-13.

Source: H. Hertz, Über die Berührung fester elastischer Körper, Journal für die reine und angewandte
Mathematik 92 (1881); method of steps for delay equations.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

import rodimpact as ri

from .table import Row, Rows

STEEL = ri.Material("steel", youngs_modulus=210e9, density=7800.0, poisson_ratio=0.3)
LENGTH, DIAMETER, RADIUS, SPEED = 0.5, 0.02, 0.05, 2.0
SOURCE = "method of steps"


class Reference(NamedTuple):
    """Impulse of a contact, N s, and its largest force, N."""

    impulse: float
    peak: float


def method_of_steps(
    k: float,
    V: float,
    rods: Sequence[tuple[float, float]],
    mass: float = math.inf,
    until: float = 0.0,
) -> Reference:
    """Hertz contact of stiffness k closing at V between one or two rods and what is left.

    Parameters
    ----------
    k : float
        N/m^1.5.
    V : float
        m/s.
    rods : sequence of (float, float)
        Impedance, kg/s, and transit time, s, of each rod that takes part.
    mass : float
        kg, of the rigid body that takes part; infinite for a wall or none.
    until : float
        End, s.
    """
    turns = {2 * n * T for _, T in rods for n in range(1, math.ceil(until / (2 * T)))}
    edges = [0.0, *sorted(turns), until]
    pieces: list[tuple[float, float, OdeSolution]] = []

    def before(t: float) -> float:
        """Force at a time of the past."""
        for start, end, dense in reversed(pieces):
            if start <= t <= end:
                return k * max(float(dense(t)[0]), 0.0) ** 1.5
        return 0.0

    def rate(t: float, y: np.ndarray, upto: float) -> list[float]:
        F = k * max(y[0], 0.0) ** 1.5
        yielding = y[1] / mass
        for Z, T in rods:
            back = sum(
                before(t - 2 * n * T) for n in range(1, round_trips(upto, T) + 1)
            )
            yielding += (F + 2 * back) / Z
        return [V - yielding, F]

    y, peak = np.zeros(2), 0.0
    for start, end in pairwise(edges):
        flight = solve_ivp(
            rate,
            (start, end),
            y,
            method="DOP853",
            rtol=1e-12,
            dense_output=True,
            atol=[1e-14 * V * until, 1e-14 * k * (V * until) ** 1.5 * until],
            args=(start,),
        )
        pieces.append((start, end, flight.sol))
        y = flight.y[:, -1]
        indented = np.maximum(flight.sol(np.linspace(start, end, 2001))[0], 0.0)
        peak = max(peak, k * float(indented.max()) ** 1.5)
    return Reference(float(f"{y[1]:.9g}"), float(f"{peak:.6g}"))


def round_trips(t: float, T: float) -> int:
    """Reflections that have come back by the time t, where a step of the method begins."""
    return math.floor(t / (2 * T) * (1 + 1e-12))


def run() -> Rows:
    """The rod on the wall, the ball on the rod."""
    area = math.pi * DIAMETER**2 / 4
    law = ri.Hertz.from_radii(
        RADIUS, math.inf, left_material=STEEL, right_material=STEEL
    )
    moving = ri.Rod(LENGTH, area=area, material=STEEL, velocity=SPEED)
    resting = ri.Rod(LENGTH, area=area, material=STEEL)
    Z, T, m = moving.segments[0].impedance, moving.transit_time, moving.mass
    by_hand = 4 / 3 * 210e9 / (2 * (1 - 0.3**2)) * math.sqrt(RADIUS)
    yield Row(
        "sphere of 50 mm, steel on steel",
        "stiffness of Hertz.from_radii, relative",
        "4/3 E* sqrt(R)",
        1.0,
        law.stiffness / by_hand,
        1e-14,
    )
    cases = {
        "sphere-ended rod on wall": (
            ri.System([moving, ri.Wall()], contacts=[law]),
            math.inf,
        ),
        "ball of half the rod's mass on rod": (
            ri.System([ri.RigidMass(m / 2, velocity=SPEED), resting], contacts=[law]),
            m / 2,
        ),
    }
    for case, (system, mass) in cases.items():
        exact = method_of_steps(by_hand, SPEED, [(Z, T)], mass, until=4 * T)
        o = ri.solve(system).outcome
        yield Row(
            case, "impulse, N s", SOURCE, exact.impulse, o.impulse, 1e-8 * exact.impulse
        )
        yield Row(
            case, "peak force, N", SOURCE, exact.peak, o.peak_force, 2e-6 * exact.peak
        )
        yield Row(
            case,
            "energy after - before, relative, rtol 1e-10",
            "conserved",
            0.0,
            ri.solve(system, rtol=1e-10).outcome.energy_residual,
            1e-13,
        )
