"""A rigid mass strikes a rod: with its far end free, and with its far end fixed.

Free end: let mu = m/M be the mass of the rod divided by the mass of the striker. The
force is Z V exp(-t Z/M) for 2 L/c. Then the reflected wave arrives at the mass and ends
the force:

    e = (1 - exp(-2 mu))/mu - exp(-2 mu), impulse = M V (1 - exp(-2 mu)).

Both are expected to 1e-12 at the default tolerance.

Fixed end: the wave runs back and forth while the mass presses. The compared quantities
are the contact time divided by L/c, the peak stress at the struck end and at the fixed
end divided by rho c V, and the velocity of the mass at the opening divided by V. The
table is for the first contact, and its bounds are half of the last digit. For M/m = 1,
4 and 6 the rod strikes the mass again, and the mass then leaves with another velocity.
For M/m = 6 Timoshenko and Goodier probably give 7.419; two computations independent of
this one give 7.4077.

Source: B. de Saint-Venant and J. Boussinesq, in S. P. Timoshenko and J. N. Goodier,
Theory of Elasticity, longitudinal impact of bars.
"""

import math
from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

SOURCE = "Saint-Venant, Boussinesq"
ROD = rod(1.0)  # mass, impedance and transit time are 1
FREE_MASSES = (0.25, 1.0, 4.0)  # mass ratios M/m on a free rod


class FirstContact(NamedTuple):
    """The first contact of a mass with a rod with a fixed end, in units of the rod."""

    duration: float  # L/c
    struck_stress: float  # peak stress at the struck end, rho c V
    fixed_stress: float  # peak stress at the fixed end, rho c V
    velocity: float  # velocity of the mass after the contact, V


class LastContact(NamedTuple):
    """The last contact of the same mass."""

    number: int  # contacts in all
    velocity: float  # velocity of the mass after it, V


FIRST_CONTACTS = {  # keys: mass ratios M/m; right to half of the last digit
    1.0: FirstContact(3.068, 2.1353, 2.2707, -0.6876),
    2.0: FirstContact(4.709, 2.3679, 2.7358, -0.9252),
    4.0: FirstContact(5.900, 2.9744, 3.2131, -0.8169),
    6.0: FirstContact(7.408, 3.4688, 3.5045, -0.9297),
}
LAST_CONTACTS = {  # keys: mass ratios M/m
    1.0: LastContact(2, -0.69888),
    2.0: LastContact(1, -0.92525),
    4.0: LastContact(2, -0.95927),
    6.0: LastContact(2, -0.93941),
}


def run() -> Rows:
    """Compare free rods, fixed rods."""
    for mass_ratio in FREE_MASSES:
        yield from on_free_rod(mass_ratio)
    for mass_ratio in FIRST_CONTACTS:
        yield from on_fixed_rod(mass_ratio)


class FreeImpact(NamedTuple):
    """The impact of a mass on a free rod."""

    restitution: float
    impulse: float  # over m V


def exact_on_free_rod(mass_ratio: float) -> FreeImpact:
    """Closed form of the impact of a mass M = mass_ratio m on a free rod.

    With mu = m/M: e = (1 - exp(-2 mu))/mu - exp(-2 mu), J = M V (1 - exp(-2 mu)). The
    result is e and J/(m V), both rounded to 12 decimals.
    """
    mu = 1 / mass_ratio
    transferred = -math.expm1(-2 * mu)
    restitution = transferred / mu - (1 - transferred)
    impulse = mass_ratio * transferred
    return FreeImpact(round(restitution, 12), round(impulse, 12))


def on_free_rod(mass_ratio: float) -> Rows:
    """e, impulse, contact time and energy of a mass that strikes a free rod.

    The reference is the closed form of `exact_on_free_rod`.
    """
    striker = ri.RigidMass(mass_ratio, velocity=1.0)
    system = ri.System([striker, ROD])
    outcome = ri.solve(system).outcome
    exact = exact_on_free_rod(mass_ratio)
    residual = outcome.energy_residual
    e = outcome.restitution
    impulse = outcome.impulse
    duration = outcome.duration
    case = Case(f"mass on free rod, M/m = {mass_ratio:g}", SOURCE)
    yield case.row("e", exact.restitution, e, 1e-12)
    yield case.row("impulse over m V", exact.impulse, impulse, 1e-12)
    yield case.row("contact time, L/c", 2.0, duration, 1e-12)
    yield case.row(
        "energy after - before, relative", 0.0, residual, 1e-13, source="conserved"
    )


def fixed_rod(mass_ratio: float) -> ri.System:
    """A mass at speed 1 touches the rod, whose other end is fixed."""
    striker = ri.RigidMass(mass_ratio, velocity=1.0)
    ends = (ri.Free(), ri.Fixed())
    return ri.System([striker, ROD], ends=ends)


def on_fixed_rod(mass_ratio: float) -> Rows:
    """First contact of a mass and a fixed rod, and velocity after the last contact.

    Of the first contact these are time, peak stresses, and velocity after it. The
    velocity after the last contact is nan if the collision is not final.
    """
    name = f"mass on rod with fixed end, M/m = {mass_ratio:g}"
    case = Case(name, "delay equation, step by step")
    computed = first_contact(mass_ratio)
    expected = FIRST_CONTACTS[mass_ratio]
    duration = computed.duration
    yield case.row(
        "first contact: time, L/c",
        expected.duration,
        duration,
        5e-4,
        source=SOURCE,
    )
    struck_stress = computed.struck_stress
    yield case.row(
        "first contact: peak stress at the struck end, rho c V",
        expected.struck_stress,
        struck_stress,
        5e-5,
        source=SOURCE,
    )
    fixed_stress = computed.fixed_stress
    yield case.row(
        "first contact: peak stress at the fixed end, rho c V",
        expected.fixed_stress,
        fixed_stress,
        5e-5,
        source=SOURCE,
    )
    yield case.row(
        "first contact: velocity of the mass after it, V",
        expected.velocity,
        computed.velocity,
        5e-5,
        source=SOURCE,
    )

    last = LAST_CONTACTS[mass_ratio]
    outcome = ri.solve(fixed_rod(mass_ratio)).outcome
    contacts = outcome.contacts[0].episodes
    velocity = math.nan
    if outcome.final:
        velocity = outcome.velocities_after[0]
    yield case.row("contacts until it is final", last.number, contacts, 0.0)
    yield case.row(
        "velocity of the mass after the last contact, V", last.velocity, velocity, 5e-6
    )


def peak_times(end: float) -> np.ndarray:
    """Times up to an end, with the whole numbers at which waves arrive."""
    even = np.linspace(0, end, 4001)
    arrivals = np.arange(end)
    return np.union1d(even, arrivals)


def first_contact(mass_ratio: float) -> FirstContact:
    """The first contact as rodimpact computes it, in units of the rod.

    The peak at the fixed end comes up to one transit after the end of the force.
    """
    solution = ri.solve(fixed_rod(mass_ratio), until=9.0)
    contact = solution.contacts[0]
    end = contact.episodes[0].force_end
    force = contact.force(peak_times(end))
    wave_arrives = end + 1  # the last arrival at the fixed end
    stress = -solution.stress(1, 1.0, peak_times(wave_arrives))
    velocity = float(solution.velocity(0, 0.0, end))
    return FirstContact(end, force.max(), stress.max(), velocity)
