"""Absorbing and driven ends, carried by the fronts themselves."""

import numpy as np
import pytest
from exhaustive import few_of
from hypothesis import assume, given
from hypothesis import strategies as st
from networks import unit_rod
from runs import group_of, tracked
from systems import horizon, random_end, random_system, with_ends

import rodimpact as ri

STEP = 1 / 16
CAP = 20_000
seeds = st.integers(0, 10**6)


def commensurate(seed):
    """Bonded rods of whole numbers of steps, with any ends."""
    rng = np.random.default_rng(seed)
    rods = []
    for _ in range(rng.integers(1, 4)):
        length = float(rng.integers(2, 9)) / 4
        state = [
            ri.Steps(rng.uniform(-1, 1, 2).tolist(), [length / 2]) for _ in range(2)
        ]
        area = float(rng.uniform(0.3, 3))
        rods.append(unit_rod(length, area, velocity=state[0], strain=state[1]))
    ends = [random_end(rng, body, 1.0, True) for body in (rods[0], rods[-1])]
    return ri.System(rods, contacts=[ri.Bonded()] * (len(rods) - 1), ends=ends)


# Against the other method ------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(30), range(8)))
def test_fields_are_those_of_the_other_method(seed):
    system = commensurate(seed)
    until = 8.0
    exact = ri.solve(system, until, "fronts")
    steps = ri.solve(system, until, "characteristics")
    t = STEP * (np.arange(until / STEP) + 0.55)  # on no front
    for body, piece in enumerate(system.bodies):
        x = np.linspace(0, float(piece.length), 9)[:, None]
        for name in ("velocity", "strain"):
            ours, theirs = (getattr(s, name)(body, x, t) for s in (exact, steps))
            assert np.abs(ours - theirs).max() < 1e-9
    ours = exact.outcome
    theirs = steps.outcome
    assert ours.velocities_after == pytest.approx(theirs.velocities_after, abs=1e-9)
    assert ours.velocities_before == pytest.approx(theirs.velocities_before, abs=1e-9)
    assert ours.vibration_after == pytest.approx(theirs.vibration_after, abs=1e-9)
    for name in ("radiated", "drive_work", "kinetic_after", "driven"):
        assert getattr(ours, name) == pytest.approx(getattr(theirs, name), abs=1e-9), (
            name
        )


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_an_incoming_wave_is_that_of_a_long_rod(method, mirrored):
    """What comes out of a rod with that wave in it, or in through an end, drives a bar alike."""
    c = 2.0
    L = 6.0
    at = [0.25, 1.0, 1.5]
    strains = [-0.1, -0.3, 0.05, 0.0]
    fast = ri.Material("fast", youngs_modulus=4.0, density=1.0)
    places = [L - c * t for t in reversed(at)]
    wave = ri.Steps(strains[::-1], places)
    long = ri.Rod(
        L,
        area=1.0,
        material=fast,
        strain=wave,
        velocity=ri.Steps([0.2 - c * e for e in wave.values], places),
    )
    bar = ri.Rod(1.5, area=1.0, material=fast, velocity=0.2)
    other = ri.Rod(2.0, area=0.7, material=fast)
    whole = ri.System([long, bar, other], [0.0, 0.1], [ri.Bonded(), ri.Rigid()])
    cut = ri.System(
        [bar, other], [0.1], ends=(ri.Incoming(ri.Steps(strains, at)), ri.Free())
    )
    bodies = (1, 2), (0, 1)
    if mirrored:
        whole, cut, bodies = whole.mirrored(), cut.mirrored(), ((1, 0), (1, 0))
    until = 5.0
    t = np.linspace(0.013, 4.95, 100)
    expected = ri.solve(whole, until, method)
    found = ri.solve(cut, until, method)
    for theirs, ours in zip(*bodies, strict=True):
        v = expected.velocity(theirs, 0.7, t)
        assert np.abs(found.velocity(ours, 0.7, t) - v).max() < 1e-14
    assert found.outcome.contacts[0].impulse == pytest.approx(
        expected.outcome.contacts[0].impulse
    )
    assert np.abs(found.energy(t).residual).max() < 1e-13
    brought = (
        4.0 * (0.25 * 0.01 + 0.75 * 0.09 + 0.5 * 0.0025) * c
    )  # E A c times strain squared
    still = cut.replace(bodies=[body.replace(velocity=0.0) for body in cut.bodies])
    early = ri.solve(still, 1.5, method)  # nothing has come back yet
    assert early.energy(1.5).radiated == pytest.approx(-brought, rel=1e-13)


# Closed forms ------------------------------------------------------------------------------------


# Balances ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(30), range(6)))
def test_the_peak_force_of_a_bond_is_the_largest_of_its_force(seed):
    solution = ri.solve(
        with_ends(seed), horizon(with_ends(seed), 4.0), "fronts", max_events=CAP
    )
    for contact, tally in zip(
        solution.contacts, solution.outcome.contacts, strict=True
    ):
        ticks = contact.push.ticks
        force = contact.push.values
        long = (
            np.diff(ticks, append=solution.fields.end)
            > solution.fields.clock.longest >> 40
        )
        largest = force[long].max(initial=0.0)
        assert tally.peak_force == pytest.approx(largest, rel=1e-9, abs=1e-9)


# Finality ----------------------------------------------------------------------------------------


@given(seeds, st.booleans(), st.booleans())
def test_an_end_stays_within_its_bound(seed, right, endless):
    """A vibrating rod far from anything; one that goes on for ever comes to rest."""
    system = random_system(seed, bodies=3, walls=False)
    pieces = [s for b in system.bodies for s in b.segments]
    length = sum(float(s.length) for s in pieces)
    rng = np.random.default_rng(seed)
    v, strain = (
        ri.Steps((size * rng.uniform(-1, 1, 2)).tolist(), [length * part])
        for size, part in ((1.0, 0.3), (1e-4, 0.7))
    )
    body = ri.Rod(segments=pieces, velocity=v, strain=strain)
    other = ri.Rod(
        0.1, area=1e-4, material=pieces[0].material, velocity=-9.0 if right else 9.0
    )
    row = [body, other]
    ends = (ri.Absorbing() if endless else ri.Free(), ri.Free())
    if right:
        row, ends = row[::-1], ends[::-1]
    row = ri.System(row, [10.0], ends=ends)
    run = tracked(row, 0.0)
    it = group_of(run, 0, right)
    a = run.clock
    reach = np.sqrt(it.deviation_bound_squared) * a.tick
    until = horizon(row, 60.0)
    solution = ri.solve(row, until, max_events=10 * CAP)
    assume(solution.stopped_by == "until")
    t = np.linspace(0, until, 2000)
    end = solution.displacement(int(right), 0.0 if right else length, t)
    place = end - end[0] - (it.mean_velocity + a.frame) * t + it.end_deviation * a.tick
    assert np.abs(place).max() <= reach * (1 + 1e-9) + 1e-12 * np.abs(end).max()
    late = np.abs(place[t > 0.9 * until]).max()
    assert not endless or late <= 0.25 * reach + 1e-12 * np.abs(end).max()


@pytest.mark.parametrize("area", [0.3, 1.0, 1.1, 2.0, 10.0])
def test_a_striker_on_an_endless_bar_comes_to_its_end(area):
    """e = (1 - r)/(1 + r), r the ratio of impedances, or 0 if the striker has the larger one."""
    rods = [unit_rod(1.0, area, velocity=1e-3), unit_rod(0.5)]
    row = ri.System(rods, ends=(ri.Free(), ri.Absorbing()))
    solution = ri.solve(row)
    assert solution.final
    assert "The collision is final" in solution.status
    e = max(0.0, (1 - area) / (1 + area))
    assert solution.outcome.restitution == pytest.approx(e, abs=1e-12)


# Times -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("trips", [1, 3, 40])
def test_a_drive_that_ends_as_a_wave_returns_leaves_no_sliver(trips):
    """Aluminium and steel are no whole ratio; the drive is timed by the aluminium."""
    slow = ri.materials.aluminium
    fast = ri.materials.steel
    row = [ri.Rod(0.3, area=1e-4, material=slow), ri.Rod(0.7, area=2e-4, material=fast)]
    T = float(row[0].transit_time)
    force = ri.Pushed(ri.Steps([1e3, 0.0], [2 * trips * T]))
    system = ri.System(row, contacts=[ri.Bonded()], ends=(force, ri.Absorbing()))
    solution = ri.solve(system, until=2.5 * trips * T)
    ticks = solution.fields.motion.lines[2].ticks.tolist()
    assert 2 * trips * solution.fields.clock.ticks[1] in ticks
    lines = [np.diff(wave.ticks) for wave in solution.fields.motion.lines if wave]
    assert min(spans.min() for spans in lines if len(spans)) > 2**20


def test_times_beyond_the_longest_transit_change_no_transit():
    """Lengths 0.3 and 0.1 stay 3 to 1, whatever the times of the drive are."""
    rods = [unit_rod(0.3), unit_rod(0.1)]
    force = ri.Pushed(ri.Steps([0.0, 1.0, 2.0, 3.0], [0.1 * np.pi, 7.0, 1e3]))
    run = tracked(ri.System(rods, ends=(force, ri.Free())), 50.0)
    _, first, second, _ = run.clock.ticks
    assert first == 3 * second
    assert run.clock.transit_error < 1e-15
    log = run.log[: run.run.initial_rows]
    outside = log[log["line"] == 0]
    (_, t1, t2), (f0, _, _) = outside["tick"].tolist(), outside["value"].tolist()
    assert f0 == 0.0
    assert t1 * run.clock.tick == pytest.approx(0.1 * np.pi, rel=1e-14)
    assert 3 * t2 == 70 * first  # the last jump is never reached
