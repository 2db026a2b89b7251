"""Energy and momentum of runs: where it comes from and where it goes."""

import numpy as np
import pytest
from networks import unit_rod

import rodimpact as ri

# Cases with numbers -------------------------------------------------------------------------------


def solved(row, until=4.0, **options):
    gaps = options.pop("gaps", None)
    contacts = options.pop("contacts", None)
    return ri.solve(ri.System(row, gaps, contacts, **options), until, "characteristics")


@pytest.mark.parametrize("gravity", [0.0, -0.7])
@pytest.mark.parametrize(
    ("method", "cells", "near", "tick"),
    [("characteristics", None, 1e-13, 1e-13), ("finite-difference", 32, 1e-12, 1e-7)],
)
def test_a_mass_bonded_to_a_wall_belongs_to_the_wall(
    method, cells, near, tick, gravity
):
    laws = [ri.Bonded(), ri.Rigid()]
    t = np.linspace(0, 4, 65)
    plain = ri.solve(
        ri.System([ri.Wall(0.1), unit_rod(velocity=-1.0)], [0.2], gravity=gravity),
        4.0,
        method,
        cells=cells,
    )
    left = ri.System(
        [ri.Wall(0.1), ri.RigidMass(3.0, velocity=0.1), unit_rod(velocity=-1.0)],
        [0.0, 0.2],
        laws,
        gravity=gravity,
    )
    for system, mass, rod, sign in ((left, 1, 2, 1.0), (left.mirrored(), 1, 0, -1.0)):
        s = ri.solve(system, 4.0, method, cells=cells)
        assert np.abs(s.energy(t).residual).max() <= near
        assert s.energy(t).total == pytest.approx(plain.energy(t).total, abs=near)
        assert abs(s.outcome.momentum_residual) <= near
        expected = sign * plain.outcome.velocities_after[1]
        assert s.outcome.velocities_after[rod] == pytest.approx(expected, abs=near)
        assert s.outcome.velocities_after[mass] == sign * 0.1
        assert s.velocity(mass, 0.0, t) == pytest.approx(
            np.full(65, sign * 0.1), abs=near
        )
        assert s.displacement(mass, 0.0, t) == pytest.approx(sign * 0.1 * t, abs=tick)


def test_a_blow_on_a_mass_bonded_to_a_wall_is_one_on_the_wall():
    row = ri.System(
        [ri.Wall(), ri.RigidMass(3.0), ri.RigidMass(2.0, velocity=-1.0)],
        [0.0, 0.1],
        [ri.Bonded(), ri.Rigid(restitution=0.5)],
    )
    for system in (row, row.mirrored()):
        outcome = ri.solve(system, 1.0).outcome
        assert [c.impulse for c in outcome.contacts] == pytest.approx(
            [3.0, 3.0], rel=1e-12
        )
        assert abs(outcome.momentum_residual) <= 1e-14


def test_absorbing_end_radiates_exactly_what_arrives():
    left = unit_rod(2.0, 3.0, velocity=ri.Steps([0.0, 1.0, 0.0], [0.5, 1.5]))
    s = solved([left], ends=(ri.Free(), ri.Absorbing()))
    ledger = s.energy(np.array([0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 3.5, 4.0]))
    # half of the pulse runs right and leaves from 0.5 to 1.5, half comes back from the free end
    pulse = 3.0 * 1.0 * 1.0**2 / 4
    assert ledger.radiated == pytest.approx(
        pulse * np.array([0, 0, 0.5, 1, 1, 1.5, 2, 2]), abs=1e-14
    )
    assert ledger.total == pytest.approx(2 * pulse - ledger.radiated, abs=1e-14)
    quiet = s.velocity(0, np.linspace(0, 2, 9)[:, None], np.linspace(3.6, 4, 5))
    assert np.abs(quiet).max() <= 1e-15


def test_energy_of_a_dashpot_under_the_cut():
    """The spring still overlaps while the force is cut to 0; what it stored is lost."""
    rod = unit_rod(1.0, velocity=ri.Steps([-1.0, 1.0], [0.5]))
    s = solved([rod, unit_rod()], until=1.5, contacts=[ri.SpringDashpot(0.2, 1.0)])
    contact = s.contacts[0]
    t = np.linspace(0, 1.5, 193)
    cut = (contact.force(t) == 0) & (contact.gap(t) < 0)
    cut = cut[1:] & cut[:-1]
    assert cut.sum() > 10
    ledger = s.energy(t)
    assert np.abs(ledger.residual).max() <= 1e-9
    assert np.all(np.diff(ledger.dissipated)[cut] > 0)
    assert np.all(np.diff(ledger.contact)[cut] < 0)
