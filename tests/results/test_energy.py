"""Energy and momentum of runs on a time step: where it comes from and where it goes."""

import math
from itertools import count, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from networks import (
    SECONDS,
    STEP,
    energy_of_bodies,
    energy_of_contacts,
    momentum_of_bodies,
    radiated,
    random_network,
    run_network,
    smeared,
    unit_rod,
)
from runs import solution_of

import rodimpact as ri
from rodimpact.methods.contact_law_kernel import IMPACT, RIGID
from rodimpact.methods.groups import movable

seeds = st.integers(0, 10**6)


# Passivity ----------------------------------------------------------------------------------------


@settings(max_examples=500)
@given(seeds)
def test_energy_never_rises_without_work(seed):
    run = run_network(random_network(seed))
    total = energy_of_bodies(run) + energy_of_contacts(run) + radiated(run)
    assert np.diff(total).max() <= 1e-12 * total[0]
    assert np.diff(total + smeared(run)).max() <= 1e-12 * total[0]
    for k, link in enumerate(run.row.contact_link):
        if link >= 0 and run.row.laws[link] >= RIGID:
            force, gap = run.contact(k)
            assert force.min() >= 0
            if run.row.laws[link] == RIGID:
                assert gap.min() >= 0
                assert np.all(force * gap == 0)
    h = run.step
    lost = (np.sum(run.tally.lost) + np.sum(run.tally.numerical)) * h
    assert min(run.tally.lost.min(), run.tally.numerical.min()) >= -1e-14 * total[0] / h
    lost += smeared(run)[-1]
    assert lost == pytest.approx(total[0] - total[-1], abs=1e-11 * total[0])


def has_rigid_bodies_in_contact(row):
    return any(
        isinstance(law, ri.Rigid) and not any(isinstance(body, ri.Rod) for body in pair)
        for law, pair in zip(row.contacts, pairwise(row.bodies), strict=True)
    )


@settings(max_examples=40)
@given(seeds)
def test_impacts_of_rigid_bodies_never_overlap_by_more_than_a_step(seed):
    row = next(filter(has_rigid_bodies_in_contact, map(random_network, count(seed))))
    run = run_network(row)
    impacts = [k for k, link in enumerate(run.row.contact_link)
               if link >= 0 and run.row.laws[link] == IMPACT]
    assert impacts
    for k in impacts:
        _, gap = run.contact(k)
        assert gap.min() >= -run.row.scale * run.step


@settings(max_examples=150)
@given(seeds, st.booleans())
def test_momentum_and_energy_balance(seed, driven):
    run = run_network(random_network(seed, driven=driven))
    outcome = solution_of(run, SECONDS).outcome
    assert abs(outcome.momentum_residual) <= 1e-12
    assert abs(outcome.energy_residual) <= 1e-11


# Every entry at every step end --------------------------------------------------------------------


def ledger_of(seed, driven, seconds=2.0):
    run = run_network(random_network(seed, bodies=4, driven=driven), until=seconds)
    solution = solution_of(run, seconds)
    return run, solution, solution.energy(np.arange(run.steps + 1) * run.step)


@settings(max_examples=30)
@given(seeds, st.booleans())
def test_every_entry_at_every_step_end(seed, driven):
    run, solution, ledger = ledger_of(seed, driven)
    works = ledger.wall_work, ledger.drive_work, ledger.gravity_work, ledger.radiated
    scale = ledger.total.max() + max(np.abs(w).max() for w in works)
    close = {"rtol": 0, "atol": 1e-11 * scale}
    np.testing.assert_allclose(ledger.residual, 0.0, **close)
    inside = ledger.kinetic + ledger.vibration
    np.testing.assert_allclose(inside, energy_of_bodies(run), **close)
    np.testing.assert_allclose(ledger.contact, energy_of_contacts(run), **close)
    for entry in (ledger.kinetic, ledger.vibrational_kinetic, ledger.strain, ledger.contact):
        assert entry.min() >= -1e-12 * scale
    for entry in (ledger.dissipated, ledger.numerical):
        assert entry[0] == 0
        assert np.diff(entry).min() >= -1e-12 * scale
    shut = run.tally.numerical.sum() * run.step
    lost = run.tally.lost.sum() * run.step, shut + smeared(run)[-1]
    found = ledger.dissipated[-1], ledger.numerical[-1]
    np.testing.assert_allclose(found, lost, **close)
    if not driven:
        np.testing.assert_allclose(ledger.radiated, radiated(run), **close)
        for entry in works[:3]:
            np.testing.assert_allclose(entry, 0.0, **close)
    outcome = solution.outcome
    ends = (outcome.kinetic_after, sum(outcome.vibration_after), outcome.contact_energy,
            outcome.dissipated, outcome.numerical, outcome.radiated, outcome.wall_work,
            outcome.drive_work, outcome.gravity_work)
    last = (ledger.kinetic, ledger.vibration, ledger.contact, ledger.dissipated,
            ledger.numerical, ledger.radiated, ledger.wall_work, ledger.drive_work,
            ledger.gravity_work)
    np.testing.assert_allclose(ends, [entry[-1] for entry in last], **close)


@settings(max_examples=40)
@given(seeds)
def test_gravity_works_along_the_way_of_the_centre_of_mass(seed):
    run, solution, ledger = ledger_of(seed, driven=True)
    momentum = momentum_of_bodies(run)
    way = np.concatenate(([0.0], np.cumsum((momentum[1:] + momentum[:-1]) / 2) * run.step))
    expected = float(solution.system.gravity) * way
    scale = np.abs(expected).max() + ledger.total.max()
    np.testing.assert_allclose(ledger.gravity_work, expected, rtol=0, atol=1e-11 * scale)


@settings(max_examples=40)
@given(seeds)
def test_walls_and_drives_work_along_the_way_of_their_point(seed):
    run, solution, ledger = ledger_of(seed, driven=True)
    wall = drive = 0.0
    bodies, scale = solution.system.bodies, 1.0
    for side, end in enumerate(solution.system.ends):
        body = (0, len(bodies) - 1)[side]
        outside = solution.run.signals.outside[side]
        kind, force = (outside.kind, outside.push.values) if outside else ("", np.zeros(1))
        scale += np.abs(force).sum() * run.step
        if kind == "wall":
            wall += (1, -1)[side] * force.sum() * run.step * bodies[body].velocity
        elif kind == "drive":
            x = bodies[body].length if side and isinstance(bodies[body], ri.Rod) else 0.0
            t = np.arange(run.steps + 1) * run.step
            moved = np.diff(solution.displacement(body, x, t))
            drive += (1, -1)[side] * np.sum(force * moved)
            if isinstance(end, ri.Pushed) and isinstance(end.value, float):
                waves = run.row.scale * max(s.impedance for s in run.row.segments)
                assert force == pytest.approx(end.value, abs=1e-15 * max(1.0, waves))
            if isinstance(end, ri.Moved) and isinstance(end.value, float):
                assert moved == pytest.approx(end.value * run.step, abs=1e-13)
    assert ledger.wall_work[-1] == pytest.approx(wall, abs=1e-12 * scale)
    assert ledger.drive_work[-1] == pytest.approx(drive, abs=1e-12 * scale)


# Cases with numbers -------------------------------------------------------------------------------


def solved(row, until=4.0, dt=STEP, **options):
    gaps, contacts = options.pop("gaps", None), options.pop("contacts", None)
    return ri.solve(ri.System(row, gaps, contacts, **options), until=until, dt=dt)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("gap", [0.0, 0.123, 0.5])
def test_impact_of_masses_loses_what_newton_says(e, gap):
    row = [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0, velocity=-0.5), unit_rod()]
    s = solved(row, gaps=[gap, 50.0], contacts=[ri.Rigid(restitution=e), ri.Rigid()])
    lost = (1 - e * e) * (2 / 3) * 1.5**2 / 2
    ledger = s.energy(np.arange(129) * STEP)
    assert ledger.dissipated[-1] == pytest.approx(lost, abs=1e-14)
    assert np.abs(ledger.residual).max() <= 1e-14
    assert s.outcome.contacts[0].impulse == pytest.approx((1 + e) * (2 / 3) * 1.5, rel=1e-14)
    assert s.outcome.velocities_after[1] - s.outcome.velocities_after[0] == pytest.approx(e * 1.5)


@pytest.mark.parametrize("gravity", [0.0, -0.7])
def test_a_mass_bonded_to_a_wall_belongs_to_the_wall(gravity):
    laws, t = [ri.Bonded(), ri.Rigid()], np.linspace(0, 4, 65)
    plain = solved([ri.Wall(0.1), unit_rod(velocity=-1.0)], gaps=[0.2], gravity=gravity)
    left = ri.System([ri.Wall(0.1), ri.RigidMass(3.0, velocity=0.1), unit_rod(velocity=-1.0)],
                     [0.0, 0.2], laws, gravity=gravity)
    for system, mass, rod, sign in ((left, 1, 2, 1.0), (left.mirrored(), 1, 0, -1.0)):
        s = ri.solve(system, until=4.0, dt=STEP)
        assert np.abs(s.energy(t).residual).max() <= 1e-13
        assert s.energy(t).total == pytest.approx(plain.energy(t).total, abs=1e-13)
        assert abs(s.outcome.momentum_residual) <= 1e-14
        expected = sign * plain.outcome.velocities_after[1]
        assert s.outcome.velocities_after[rod] == pytest.approx(expected, abs=1e-14)
        assert s.outcome.velocities_after[mass] == sign * 0.1
        assert s.velocity(mass, 0.0, t) == pytest.approx(np.full(65, sign * 0.1), abs=1e-14)
        assert s.displacement(mass, 0.0, t) == pytest.approx(sign * 0.1 * t, abs=1e-13)


def test_movable_bodies():
    rod, mass, wall = unit_rod(), ri.RigidMass(1.0), ri.Wall()
    bond, hertz = ri.Bonded(), ri.Hertz(1.0)
    assert movable(ri.System([wall, mass, mass, rod], contacts=[bond, bond, bond])) == [3]
    assert movable(ri.System([wall, mass, mass, rod], contacts=[bond, hertz, bond])) == [2, 3]
    assert movable(ri.System([rod, mass, wall], contacts=[hertz, bond])) == [0]
    assert movable(ri.System([rod, mass, wall], contacts=[bond, hertz])) == [0, 1]
    assert movable(ri.System([wall, rod, wall], contacts=[bond, bond])) == [1]
    assert movable(ri.System([mass, rod])) == [0, 1]


def test_a_row_at_rest_has_no_energy_and_no_residual():
    s = solved([unit_rod(), unit_rod()], contacts=[ri.Spring(1.0)])
    assert s.outcome.energy_residual == s.outcome.momentum_residual == 0.0
    assert not np.any(s.energy(np.linspace(0, 4, 9)).total)


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
    s = solved([rod, unit_rod()], until=1.5, dt=1 / 128, contacts=[ri.SpringDashpot(0.2, 1.0)])
    contact, t = s.contacts[0], np.arange(193) / 128
    cut = (contact.force(t[:-1]) == 0) & (contact.gap(t[1:]) < 0) & (contact.gap(t[:-1]) < 0)
    assert cut.sum() > 10
    ledger = s.energy(t)
    assert np.abs(ledger.residual).max() <= 1e-14
    assert np.all(np.diff(ledger.dissipated)[cut] > 0)
    assert np.all(np.diff(ledger.contact)[cut] < 0)


def test_forces_and_steps_that_pump_a_row():
    """Constant force on a mass far from anything: work F^2 t^2/2M, and with gravity besides."""
    mass, rod = ri.RigidMass(2.0, velocity=0.5), unit_rod()
    for g in (0.0, -3.0):
        s = solved([mass, rod], until=1.0, gaps=[100.0], gravity=g,
                   contacts=[ri.Spring(1.0)], ends=(ri.Pushed(4.0), ri.Free()))
        way = 0.5 + (2.0 + g) / 2
        assert float(s.displacement(0, 0.0, 1.0)) == pytest.approx(way, rel=1e-14)
        assert float(s.velocity(0, 0.0, 1.0)) == pytest.approx(2.5 + g, rel=1e-14)
        book = s.energy(np.array([1.0]))
        assert book.drive_work[0] == pytest.approx(4.0 * way, rel=1e-14)
        fallen = 2.0 * g * way + g * g / 2
        assert book.gravity_work[0] == pytest.approx(fallen, rel=1e-13, abs=1e-15)
        assert abs(book.residual[0]) <= 1e-13


def test_moving_wall_lends_energy():
    s = solved([ri.Wall(0.5), unit_rod(velocity=-1.0)], until=5.0)
    outcome = s.outcome
    assert outcome.velocities_after[1] == pytest.approx(2.0, abs=1e-14)
    assert outcome.wall_work == pytest.approx(1.5, abs=1e-13)
    assert outcome.restitution == pytest.approx(1.0, abs=1e-14)
    assert math.isclose(outcome.kinetic_after, 2.0, rel_tol=1e-13)
