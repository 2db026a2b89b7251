"""Stiff and damped contacts by characteristics: faults of a clock that had steps."""

import math

import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri


def pair(law):
    """System of a rod at 1 m/s that strikes a longer one through a law."""
    striker = unit_rod(0.4, velocity=1.0)
    return ri.System([striker, unit_rod(1.0)], contacts=[law])


LAWS = []
for exponent_of_ten in (2, 4, 6, 8, 10):
    LAWS.append(ri.Spring(10.0**exponent_of_ten))
    LAWS.append(ri.Hertz(10.0**exponent_of_ten))


@pytest.mark.parametrize(
    "law", few_of(LAWS, [ri.Spring(1e4), ri.Spring(1e10), ri.Hertz(1e10)])
)
def test_stiff_contacts_of_rods_are_near_rigid_ones_in_few_steps(law):
    """The force of a spring rises in about Z/k, that of a Hertz contact in about
    (Z/(k sqrt(V)))^(2/3), Z = 0.5 of both rods and V = 1.
    """
    rise_time = 0.5 / law.stiffness
    if isinstance(law, ri.Hertz):
        rise_time = rise_time ** (2 / 3)
    bound = 20 * rise_time + 1e-9

    with_rigid = ri.solve(pair(ri.Rigid()))
    solution = ri.solve(pair(law))

    assert solution.final
    outcome = solution.outcome
    velocities = outcome.velocities_after
    expected = with_rigid.outcome.velocities_after
    assert velocities == pytest.approx(expected, abs=bound)
    rigid_force = 0.5 * 1.0  # Z V
    assert outcome.peak_force == pytest.approx(rigid_force, abs=bound)
    assert abs(outcome.energy_residual) <= 1e-9
    # Steps of the rise time of the stiffest spring would be 4e10.
    assert solution.events <= 2000
    assert solution.accuracy["impulse"] <= 1e-6
    assert solution.accuracy["velocity"] <= 1e-6


@pytest.mark.parametrize("k", few_of([10.0**n for n in range(2, 11)], [1e5, 1e10]))
@pytest.mark.parametrize("law", [ri.Spring, ri.Hertz])
def test_impulses_on_a_mass_between_stiff_contacts_are_near_those_of_rigid_ones(law, k):
    """The force on the mass m = 0.5 rises in about sqrt(m/k) through springs, and in
    (m/k)^(1/3) or so through Hertz contacts. All balances close.
    """
    first = unit_rod(1.0, velocity=1.0)
    mass = ri.RigidMass(0.5)
    last = unit_rod(1.0, area=2.0)
    bodies = [first, mass, last]
    until = 1.5
    rise_time = 1 / math.sqrt(k)  # of the force on the mass, about
    if law is ri.Hertz:
        rise_time = k ** (-1 / 3)
    bound = 10 * rise_time + 1e-9

    stiff_law = law(k)
    stiff_row = ri.System(bodies, contacts=[stiff_law, stiff_law])
    rigid_row = ri.System(bodies)

    solution = ri.solve(stiff_row, until=until)
    with_rigid = ri.solve(rigid_row, until=until)

    contacts = zip(solution.contacts, with_rigid.contacts, strict=True)
    for stiff, rigid in contacts:
        assert stiff.impulse == pytest.approx(rigid.impulse, abs=bound)
    assert abs(solution.outcome.momentum_residual) <= 1e-12
    residual = solution.energy(until).residual
    assert abs(residual) <= 1e-8
    # Where a graze ends is a matter of round-off; velocities and impulses are not.
    assert solution.accuracy["impulse"] <= 1e-6
    assert solution.accuracy["velocity"] <= 1e-6


@pytest.mark.parametrize("damping", few_of([0.01, 0.3, 2.0, 30.0], [0.01, 2.0]))
@pytest.mark.parametrize("k", [0.05, 3.0, 300.0])
def test_a_dashpot_between_endless_bars_lets_go_on_time(k, damping):
    """Without a force the bars would close by v = 1 for half a second, then by -1.

    They have the impedance 2, so that d' = v - F. The force F = k d + c d' ends where
    k d = -c v, at a known time.
    """
    velocity = ri.Steps([-1.0, 1.0], at=[0.5])
    striker = unit_rod(1.0, area=2.0, velocity=velocity)
    struck = unit_rod(1.0, area=2.0)
    law = ri.SpringDashpot(k, damping=damping)
    absorbing_ends = [ri.Absorbing(), ri.Absorbing()]
    system = ri.System([striker, struck], contacts=[law], ends=absorbing_ends)
    share = 1 / (1 + damping)  # F = (k d + c v) share
    rate = k * share
    d_at_turn = share * -math.expm1(-rate / 2) / rate  # as v turns, at 0.5
    if k * d_at_turn > damping:
        # d = (d_at_turn + 1/k) exp(-rate t) - 1/k, until k d = c
        ratio = (k * d_at_turn + 1) / (damping + 1)
        end = 0.5 + math.log(ratio) / rate
        d_at_end = damping / k
    else:  # the force ends at once
        end = 0.5
        d_at_end = d_at_turn
    path = 0.5 - (end - 0.5)  # integral of v
    impulse = path - d_at_end  # as d' = v - F

    solution = ri.solve(system, until=4.0)

    contact = solution.contacts[0]
    episode = contact.episodes[0]
    assert episode.start == pytest.approx(0.0, abs=1e-8)
    assert episode.force_end == pytest.approx(end, abs=1e-8)
    duration_bound = solution.accuracy["duration"] * end + 1e-12
    assert contact.duration == pytest.approx(end, abs=duration_bound)
    assert contact.impulse == pytest.approx(impulse, abs=1e-8)
    # Without a force the overlap that is left goes back by 1 m/s.
    opening = end + d_at_end
    assert episode.opening == pytest.approx(opening, abs=1e-8)
