"""Stiff, damped and driven contacts by characteristics: what went wrong where time had
steps.
"""

import math

import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri


def pair(law):
    return ri.System([unit_rod(0.4, velocity=1.0), unit_rod(1.0)], contacts=[law])


@pytest.mark.parametrize(
    "law",
    few_of(
        [kind(10.0**n) for n in (2, 4, 6, 8, 10) for kind in (ri.Spring, ri.Hertz)],
        [ri.Spring(1e4), ri.Spring(1e10), ri.Hertz(1e10)],
    ),
)
def test_stiff_contacts_of_rods_tend_to_rigid_ones(law):
    """A spring is slower by about Z/k, a Hertz contact by about (Z/(k
    sqrt(V)))^(2/3).
    """
    slow = (
        (0.5 / law.stiffness) if law.exponent == 1 else (0.5 / law.stiffness) ** (2 / 3)
    )
    solution = ri.solve(pair(law))
    rigid = ri.solve(pair(ri.Rigid()))
    assert solution.final
    assert solution.outcome.velocities_after == pytest.approx(
        rigid.outcome.velocities_after, abs=20 * slow + 1e-9
    )
    assert solution.outcome.peak_force == pytest.approx(0.5, abs=20 * slow + 1e-9)
    assert abs(solution.outcome.energy_residual) <= 1e-9
    assert solution.events <= 2000
    assert max(solution.accuracy["impulse"], solution.accuracy["velocity"]) <= 1e-6


@pytest.mark.parametrize("k", few_of([10.0**n for n in range(2, 11)], [1e5, 1e10]))
@pytest.mark.parametrize("law", [ri.Spring, ri.Hertz])
def test_a_mass_between_two_stiff_contacts(law, k):
    """Against rigid contacts: the mass is one with both rods as long as all press."""
    row = [unit_rod(1.0, velocity=1.0), ri.RigidMass(0.5), unit_rod(1.0, 2.0)]
    until = 1.5
    solution = ri.solve(ri.System(row, contacts=[law(k), law(k)]), until)
    rigid = ri.solve(ri.System(row), until)
    slow = 1 / math.sqrt(k) if law is ri.Spring else k ** (-1 / 3)
    for a, b in zip(solution.contacts, rigid.contacts, strict=True):
        assert a.impulse == pytest.approx(b.impulse, abs=10 * slow + 1e-9)
    assert abs(solution.outcome.momentum_residual) <= 1e-12
    assert abs(solution.energy(until).residual) <= 1e-8
    # where a graze ends is a matter of round-off; velocities and impulses are not
    assert max(solution.accuracy["impulse"], solution.accuracy["velocity"]) <= 1e-6


@pytest.mark.parametrize("damping", [0.01, 0.3, 2.0, 30.0])
@pytest.mark.parametrize("k", [0.05, 3.0, 300.0])
def test_a_dashpot_between_endless_bars_lets_go_on_time(k, damping):
    """v = 1 for half a second, then -1: F = k d + c d' ends where k d = -c v, at a
    known time.
    """
    rods = [
        unit_rod(1.0, 2.0, velocity=ri.Steps([-1.0, 1.0], [0.5])),
        unit_rod(1.0, 2.0),
    ]
    s = ri.solve(
        ri.System(
            rods,
            contacts=[ri.SpringDashpot(k, damping)],
            ends=[ri.Absorbing(), ri.Absorbing()],
        ),
        4.0,
    )
    share = 1 / (1 + damping)  # F = (k d + c v) share, d' = v - F
    rate = k * share
    grown = share * -math.expm1(-rate / 2) / rate  # d when the wave turns
    end = 0.5
    if k * grown > damping:  # d = (grown + 1/k) exp(-rate t) - 1/k, until k d = c
        end += math.log((k * grown + 1) / (damping + 1)) / rate
    contact = s.contacts[0]
    solution = contact.episodes[0]
    assert (solution.start, solution.force_end) == pytest.approx((0.0, end), abs=1e-8)
    assert contact.duration == pytest.approx(
        end, abs=s.accuracy["duration"] * end + 1e-12
    )
    left = grown if end == 0.5 else damping / k
    moved = 0.5 - (end - 0.5)  # integral of v, of which d is what is left of F
    assert contact.impulse == pytest.approx(moved - left, abs=1e-8)
    assert solution.opening == pytest.approx(
        end + left, abs=1e-8
    )  # with v = -1, no force
