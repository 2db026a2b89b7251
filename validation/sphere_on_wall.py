"""A steel rod with a spherical end on a wall, and a ball on a rod: method of steps.

If a rod with a free far end is struck with the force F, the wave that left the struck
end returns after 2 T. The velocity of the struck end, with Y = 1/Z, is

    Y F(t) + 2 Y [F(t - 2 T) + F(t - 4 T) + ...].

A mass M gets the velocity J(t)/M, where J is the impulse until t. So the overlap d
obeys the delay equation

    d' = V - sum over rods of Y [F(t) + 2 F(t - 2 T) + ...] - J/M,
    F = k max(d, 0)^(3/2).

This equation is solved from one reflection to the next with DOP853 of scipy, at a
relative tolerance of 1e-12. The solution shares neither time steps nor code with the
package.

The rod is 0.5 m long, with a diameter of 20 mm and an end of radius 50 mm. The wall is
of the same steel, so E* = E/(2 (1 - nu^2)). The speed is V = 2 m/s. The ball is a rigid
mass with the same contact stiffness. Expected at the default tolerance: the impulse to
1e-8, and the peak force to the 6 digits of the reference. At a relative tolerance of
1e-10 the energy is conserved to 1e-13.

Source: H. Hertz, Über die Berührung fester elastischer Körper, Journal für die reine
und angewandte Mathematik 92 (1881); method of steps for delay equations.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

import rodimpact as ri

from .table import Case, Rows

YOUNGS_MODULUS = 210e9  # Pa
NU = 0.3  # Poisson's ratio
STEEL = ri.Material(
    "steel", youngs_modulus=YOUNGS_MODULUS, density=7800.0, poisson_ratio=NU
)
LENGTH = 0.5  # m
DIAMETER = 0.02  # m
RADIUS = 0.05  # radius of the spherical end, m
SPEED = 2.0  # m/s


class StruckRod(NamedTuple):
    """A uniform rod whose far end is free."""

    impedance: float  # kg/s
    transit_time: float  # s


class Reference(NamedTuple):
    """A contact by the method of steps."""

    impulse: float  # N s
    peak_force: float  # N


class Span(NamedTuple):
    """The indentation between two reflections."""

    start: float  # s
    end: float  # s
    state: OdeSolution  # indentation, m, and impulse, N s, at a time


def method_of_steps(
    k: float,
    V: float,
    rods: Sequence[StruckRod],
    mass: float = math.inf,
    until: float = 0.0,
) -> Reference:
    """Hertz contact of stiffness k, which closes at speed V, by the method of steps.

    The delay equation for the indentation d, with J' = F = k max(d, 0)^(3/2),
    d' = V - J/M - sum over rods of (F + 2 F(t - 2 T) + 2 F(t - 4 T) + ...)/Z, is solved
    from one reflection to the next. Nine digits of the impulse and six of the peak
    force are kept.

    Parameters
    ----------
    k : float
        Stiffness, N/m^1.5.
    V : float
        Closing speed, m/s.
    rods : sequence of StruckRod
        The one or two rods that take part.
    mass : float
        Mass of the rigid body that takes part, kg; infinite for a wall or none.
    until : float
        End, s.
    """
    spans: list[Span] = []

    def past_force(t: float) -> float:
        """Force at a time in the spans that are solved; 0 outside them."""
        for span in reversed(spans):
            if span.start <= t <= span.end:
                indentation = max(float(span.state(t)[0]), 0.0)
                return k * indentation**1.5
        return 0.0

    def rate(t: float, y: np.ndarray, span_start: float) -> list[float]:
        """Rates of the indentation y[0] and of the impulse y[1]."""
        F = k * max(y[0], 0.0) ** 1.5
        # Velocity at which the bodies give way, as they take up the impulse
        yielding = y[1] / mass
        for Z, T in rods:
            reflected = 0
            for n in range(1, round_trips(span_start, T) + 1):
                reflected += past_force(t - 2 * n * T)
            yielding += (F + 2 * reflected) / Z
        return [V - yielding, F]

    y = np.zeros(2)
    peak_force = 0.0
    indentation_atol = 1e-14 * V * until
    impulse_atol = 1e-14 * k * (V * until) ** 1.5 * until
    for start, end in pairwise(reflection_times(rods, until)):
        solved = solve_ivp(
            rate,
            (start, end),
            y,
            method="DOP853",
            rtol=1e-12,
            dense_output=True,
            atol=[indentation_atol, impulse_atol],
            args=(start,),
        )
        spans.append(Span(start, end, solved.sol))
        y = solved.y[:, -1]
        times = np.linspace(start, end, 2001)
        indentation = solved.sol(times)[0]
        deepest = float(np.maximum(indentation, 0.0).max())
        peak_force = max(peak_force, k * deepest**1.5)
    # Only certain digits are kept: the peak is that of 2001 times in each span.
    return Reference(float(f"{y[1]:.9g}"), float(f"{peak_force:.6g}"))


def reflection_times(rods: Sequence[StruckRod], until: float) -> list[float]:
    """Start, times at which reflections come back to the contact, and end, s.

    They are sorted, each once; reflections come back after 2 n T in each of the rods.
    """
    times = set()
    for _, T in rods:
        for n in range(1, math.ceil(until / (2 * T))):
            times.add(2 * n * T)
    return [0.0, *sorted(times), until]


def round_trips(t: float, T: float) -> int:
    """Reflections that have come back by the time t, the start of a step."""
    return math.floor(t / (2 * T) * (1 + 1e-12))


def run() -> Rows:
    """Compare the stiffness, a sphere-ended rod on a wall, and a ball on a rod."""
    area = math.pi * DIAMETER**2 / 4
    contact = ri.Hertz.from_radii(
        RADIUS, math.inf, left_material=STEEL, right_material=STEEL
    )
    moving = ri.Rod(LENGTH, area=area, material=STEEL, velocity=SPEED)
    resting = ri.Rod(LENGTH, area=area, material=STEEL)
    ball_mass = moving.mass / 2
    ball = ri.RigidMass(ball_mass, velocity=SPEED)

    case = Case("sphere of 50 mm, steel on steel", "4/3 E* sqrt(R)")
    stiffness_ratio = contact.stiffness / stiffness_by_hand()
    quantity = "stiffness of Hertz.from_radii, relative"
    yield case.row(quantity, 1.0, stiffness_ratio, 1e-14)

    on_wall = ri.System([moving, ri.Wall()], contacts=[contact])
    yield from against_steps("sphere-ended rod on wall", on_wall, math.inf)
    on_rod = ri.System([ball, resting], contacts=[contact])
    yield from against_steps("ball of half the rod's mass on rod", on_rod, ball_mass)


def stiffness_by_hand() -> float:
    """k = 4/3 E* sqrt(R), E* = E/(2 (1 - nu^2)), N/m^1.5."""
    compliance = 2 * (1 - NU**2)
    return 4 / 3 * YOUNGS_MODULUS / compliance * math.sqrt(RADIUS)


def against_steps(name: str, system: ri.System, mass: float) -> Rows:
    """Impulse, peak force and energy of a rod that a sphere or a rigid mass strikes.

    `mass` is that of the rigid mass, kg, or infinite for a wall.
    """
    rod = next(body for body in system.bodies if isinstance(body, ri.Rod))
    struck = StruckRod(rod.segments[0].impedance, rod.transit_time)
    until = 4 * rod.transit_time
    k = stiffness_by_hand()
    exact = method_of_steps(k, SPEED, [struck], mass, until)
    outcome = ri.solve(system).outcome
    accurate = ri.solve(system, rtol=1e-10)
    residual = accurate.outcome.energy_residual
    impulse_bound = 1e-8 * exact.impulse
    force_bound = 2e-6 * exact.peak_force
    impulse = outcome.impulse
    peak_force = outcome.peak_force
    case = Case(name, "method of steps")
    yield case.row("impulse, N s", exact.impulse, impulse, impulse_bound)
    yield case.row("peak force, N", exact.peak_force, peak_force, force_bound)
    yield case.row(
        "energy after - before, relative, rtol 1e-10",
        0.0,
        residual,
        1e-13,
        source="conserved",
    )
