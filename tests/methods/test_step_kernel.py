"""The kernel of steps in time, below the model: laws, chains, proofs, and the same bits always."""

import ast
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from exhaustive import few_of
from hypothesis import given, settings
from hypothesis import strategies as st
from laid_out import LaidOut, on_whole_steps
from networks import STEP, UNIT, random_network, run_network, unit_rod
from scipy.integrate import quad

import rodimpact as ri
from rodimpact.methods import contact_law_kernel as lk
from rodimpact.methods import finality_kernel, kernels
from rodimpact.methods.clock import STEP_TICKS as TICKS
from rodimpact.methods.steps import search_kernel
from rodimpact.methods.steps import step_kernel as ck

PARTS = ("state", "tally", "signals")


def machine_of(system, room, step=STEP, cuts=()):
    return LaidOut(system, room, step, cuts)


def whole_network(seed):
    """A row with free ends whose transits are whole numbers of steps, so that these may be cut."""
    rng = np.random.default_rng(seed)
    while True:
        system = random_network(int(rng.integers(10**6)))
        closed = all(isinstance(end, ri.Free) for end in system.ends)
        if closed and on_whole_steps(system, STEP):
            return system


def bits(machine):
    return {
        (part, name): np.asarray(column).tobytes()
        for part in PARTS for name, column in getattr(machine, part)._asdict().items()
    }


def run_plain(machine, end):
    lists = [type(x)(*(c.tolist() for c in x))
             for x in (machine.state, machine.tally, machine.signals, machine.points,
                       machine.links)]
    flag = ck.run(*lists, machine.clock.tolist(), end, machine.tol)
    assert flag == ck.DONE
    for whole, found in zip((machine.state, machine.tally, machine.signals), lists, strict=False):
        for column, values in zip(whole, found, strict=True):
            column[:] = values


# One source, the same bits ------------------------------------------------------------------------


@pytest.mark.parametrize("kernel", [ck, lk, finality_kernel])
def test_kernels_import_kernels_only(kernel):
    tree = ast.parse(Path(kernel.__file__).read_text())
    imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    imported |= {a.name for node in ast.walk(tree) if isinstance(node, ast.Import)
                 for a in node.names}
    assert imported <= {"__future__", "math", "typing", "contact_law_kernel", "finality_kernel"}


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_compiled_and_plain_runs_are_bit_identical():
    for seed in range(150):
        system = random_network(seed, driven=seed % 2 == 1)
        plain, fast = machine_of(system, 64), machine_of(system, 64)
        run_plain(plain, 64)
        flag = kernels.compiled(ck.run)(
            fast.state, fast.tally, fast.signals, fast.points, fast.links, fast.clock, 64, fast.tol
        )
        assert flag == ck.DONE
        assert bits(plain) == bits(fast), seed


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_compiled_and_plain_proofs_and_steps_agree():
    for seed in range(40):
        machine = machine_of(random_network(seed), 96)
        machine.advance(96)
        fast = kernels.compiled(ck.finality_time)(machine.state, machine.signals, 96, machine.tol)
        assert fast == ck.finality_time(machine.state, machine.signals, 96, machine.tol)
        transits = np.random.default_rng(seed).uniform(0.1, 1, 1 + seed % 5)
        found = ck.choose_step(transits.tolist(), 64, 500, 1e-6, 1.0)
        assert kernels.compiled(ck.choose_step)(transits, 64, 500, 1e-6, 1.0) == found


@pytest.mark.parametrize("driven", [False, True])
def test_a_run_in_pieces_is_the_whole_run(driven):
    for seed in range(40):
        system = random_network(seed, driven=driven)
        whole, pieces = machine_of(system, 100), machine_of(system, 100)
        whole.advance(100)
        for end in (*np.random.default_rng(seed).choice(np.arange(1, 100), 5).cumsum(), 100):
            if end < 100:
                pieces.advance(int(end))
        pieces.advance(100)
        assert bits(whole) == bits(pieces), seed


def test_a_run_that_outgrows_its_room_is_the_run_with_enough_room(monkeypatch):
    for seed in range(12):
        system = random_network(seed, bodies=2)
        whole = ri.solve(system, dt=STEP, max_events=3000)
        with monkeypatch.context() as patch, kernels.forced(False):
            patch.setattr(search_kernel, "FIRST_ROOM", 3)
            assert ri.solve(system, dt=STEP, max_events=3000).run.contacts == whole.run.contacts


# Laws ---------------------------------------------------------------------------------------------

EXPONENT = {lk.SPRING: 1.0, lk.HERTZ: 1.5, lk.HUNT: 1.5}
indentations = st.floats(-2, 2).filter(lambda x: x == 0 or abs(x) > 1e-3)


def force(law, k, d, x, w):
    p = max(x, 0.0)
    if law == lk.SPRING:
        return max(k * p + d * w, 0.0) if x > 0 else 0.0
    return k * p**1.5 * ((1 + d * w) if law == lk.HUNT else 1.0)


@settings(max_examples=150)
@given(st.sampled_from([lk.SPRING, lk.HERTZ, lk.HUNT]), st.floats(0.1, 1e3), st.floats(0, 3),
       indentations, indentations)
def test_mean_force_is_the_mean_along_a_straight_path(law, k, d, x0, x1):
    if law == lk.HERTZ:
        d = 0.0
    found, dF = lk.mean_force(law, k, EXPONENT[law], d, x0, x1)
    w = x1 - x0
    if abs(w) > 1e-9:
        kinks = (-x0 / w, -x0 / w - d / k)  # it touches, and a dashpot lets go
        cuts = [s for s in kinks if 0 < s < 1] or None
        mean, _ = quad(lambda s: force(law, k, d, x0 + s * w, w), 0, 1, points=cuts)
        assert found == pytest.approx(max(mean, 0.0), rel=1e-7, abs=1e-9 * k)
    if found > 1e-6 * k and x1 != 0:  # where a dashpot lets go, the slope jumps
        eps = 1e-6 * max(1.0, abs(x1))
        up, down = (lk.mean_force(law, k, EXPONENT[law], d, x0, x1 + s)[0] for s in (eps, -eps))
        assert dF == pytest.approx((up - down) / (2 * eps), rel=1e-4, abs=1e-4 * k)
    assert found >= 0
    assert dF >= 0


@settings(max_examples=150)
@given(st.sampled_from([lk.SPRING, lk.HERTZ]), st.floats(0.1, 1e3), indentations, indentations)
def test_elastic_mean_force_is_the_discrete_gradient(law, k, x0, x1):
    F, _ = lk.mean_force(law, k, EXPONENT[law], 0.0, x0, x1)
    gained = lk.stored(law, k, EXPONENT[law], -x1) - lk.stored(law, k, EXPONENT[law], -x0)
    assert F * (x1 - x0) == pytest.approx(gained, rel=1e-12, abs=1e-13 * k)


@settings(max_examples=200)
@given(st.sampled_from([lk.SPRING, lk.HERTZ, lk.HUNT]), st.floats(-6, 12), st.floats(0, 3),
       st.floats(0, 0.5), st.floats(-2, 2), st.floats(-3, 3), st.floats(-2, 2))
def test_squeeze_solves_its_equation_from_any_guess(law, power, d, x0, c, q, guess):
    k, y, d = 10.0**power, 10.0**q, 0.0 if law == lk.HERTZ else d
    F, x1, _ = lk.solve_law(law, k, EXPONENT[law], d, x0, c, y, guess)
    assert F >= 0
    size = abs(x0) + abs(c) + y * F
    assert x1 == pytest.approx(x0 + c - y * F, abs=1e-14 * size + 1e-300)
    expected, slope = lk.mean_force(law, k, EXPONENT[law], d, x0, x1)
    assert pytest.approx(expected, rel=1e-11, abs=(1 + slope) * 1e-13 * size) == F


def test_stored_energy():
    assert lk.stored(lk.SPRING, 3.0, 1.0, -0.5) == 0.375
    assert lk.stored(lk.HERTZ, 5.0, 1.5, -0.25) == lk.stored(lk.HUNT, 5.0, 1.5, -0.25) == 0.0625
    assert lk.stored(lk.SPRING, 3.0, 1.0, 0.5) == lk.stored(lk.RIGID, 3.0, 1.0, -0.5) == 0.0


@settings(max_examples=150)
@given(st.floats(0.1, 1e3), st.floats(0, 0.95), st.floats(1e-3, 1e2), st.floats(-2, 1),
       st.floats(-3, 3), st.floats(-6, 3))
def test_a_yielding_contact_is_solved(k, hardening, strength, start, c, size):
    """Its mean force is that along the path, and takes back what the path lacks."""
    most, y = strength / k, 10**size
    x0 = min(start, most)

    def solve(c):
        return lk.solve_link(lk.YIELD, k, 1.0, hardening, strength, 0.5, x0, c, y, 0.1)

    F, x1, slope = solve(c)
    assert x1 == pytest.approx(x0 + c - y * F, abs=1e-12 * (1 + abs(c) + y * F))

    def force(x):
        return max(0.0, min(k * x, strength + hardening * k * (x - most)))

    w = x1 - x0
    if abs(w) > 1e-6:
        cuts = [(x - x0) / w for x in (0.0, most) if 0 < (x - x0) / w < 1]
        mean, _ = quad(lambda s: force(x0 + s * w), 0, 1, points=cuts or None)
        assert abs(F - mean) <= 1e-7 * mean + 1e-8 * k + 1e-9 * abs(c) / y
        again = solve(c + 1e-5 * abs(w))
        assert again[0] - F == pytest.approx(slope * (again[1] - x1), rel=1e-3, abs=1e-8 * k)


# A chain on its own: masses and walls, no rod -----------------------------------------------------


def chain(masses, speeds, laws, gaps=None, walls=(None, None), damping=0.0, stiffness=0.0,
          room=50):
    """Masses in a row; a wall moves at the velocity given, None is a free end."""
    m, links = len(masses), len(masses) + 1
    law = [lk.FREE if walls[0] is None else laws[0], *laws[1:-1],
           lk.FREE if walls[1] is None else laws[-1]]
    row = ck.State(
        [0, 0], [0.0, 0.0], [0.0, 0.0], [1], [1.0], [0.0, 0.0], [0, m], list(masses), law,
        [stiffness] * links, [EXPONENT.get(each, 1.0) for each in laws], [damping] * links,
        [0.0] * links, gaps or [0.0] * links, [0.0] * links, [0.0] * links, [1] * links,
        list(speeds), [0.0], [math.inf],
    )
    wave = [w or 0.0 for w in walls for _ in range(room + 1)]
    signals = ck.Signals(
        wave, [1, -1, -1, room + 2], [0.0] * (links * room), [0.0] * (links * room),
        [i * room for i in range(links)], [0.0] * (m * room), [i * room for i in range(m)],
    )
    tally = lk.Tally(*([0.0] * links for _ in range(4)), [-1] * links, [-1] * links, [0] * links,
                     [0] * links)
    points = ck.Points([0.0] * (m + 2), [0.0] * (m + 2))
    room_for_links = lk.Chain(*([0.0] * links for _ in lk.Chain._fields))
    return row, tally, signals, points, room_for_links, [0, 0, 0]


@pytest.mark.parametrize("law", [lk.RIGID, lk.IMPACT])
def test_a_mass_squeezed_between_walls_stops_the_run(law):
    parts = chain([1.0], [0.0], [law, law], [0.0, 3.0], walls=(1.0, 0.0))
    assert ck.run(*parts, 50, 1e-12) == ck.SQUEEZED
    assert 2 <= parts[-1][ck.STEP] <= 6
    assert parts[-1][ck.LINK] == 0


@pytest.mark.parametrize("e", [0.0, 0.25, 0.6, 1.0])
@pytest.mark.parametrize("gap", [0.0, 0.3, 2.0])
def test_impact_of_two_masses_is_newtons(e, gap):
    M, V = (1.0, 3.0), (2.0, -0.5)
    laws = [lk.FREE, lk.IMPACT, lk.FREE]
    row, tally, *rest = chain(M, V, laws, [0.0, gap, 0.0], damping=e)
    assert ck.run(row, tally, *rest, 50, 1e-12) == ck.DONE
    centre = (M[0] * V[0] + M[1] * V[1]) / 4
    after = (centre - M[1] / 4 * e * 2.5, centre + M[0] / 4 * e * 2.5)
    assert row.speed == pytest.approx(after, abs=1e-14)
    assert tally.lost[1] == pytest.approx((1 - e * e) * 0.75 * 2.5**2 / 2, rel=1e-13, abs=1e-15)
    assert tally.episodes[1] == 1
    assert tally.pressed[1] == 1


def test_touching_impacts_of_a_row_are_simultaneous():
    row, *rest = chain([1.0] * 3, [1.0, 0.0, 0.0], [lk.FREE, *[lk.IMPACT] * 2, lk.FREE],
                       damping=1.0)
    ck.run(row, *rest, 20, 1e-12)
    assert row.speed == pytest.approx([-1 / 3, 2 / 3, 2 / 3], abs=1e-15)


def test_stiff_chain_keeps_energy_and_momentum():
    rng = np.random.default_rng(3)
    for law in (lk.SPRING, lk.HERTZ):
        for k in (1e-2, 1.0, 1e4, 1e12):
            M, V = rng.uniform(0.1, 10, 6).tolist(), rng.uniform(-1, 1, 6).tolist()
            row, tally, *rest = chain(M, V, [lk.FREE, *[law] * 5, lk.FREE], stiffness=k)
            ck.run(row, tally, *rest, 50, 1e-12)
            held = sum(lk.stored(law, k, EXPONENT[law], g) for g in row.gap)
            before, after = (sum(m * v * v for m, v in zip(M, S, strict=True)) / 2 + E
                             for S, E in ((V, 0.0), (row.speed, held)))
            assert after == pytest.approx(before, rel=1e-12)
            assert np.dot(M, row.speed) == pytest.approx(np.dot(M, V), abs=1e-12)
            assert min(tally.peak) >= 0


# The step -----------------------------------------------------------------------------------------


def worst_smear(transits, number):
    w = np.array(transits) / max(transits) * number % 1
    return np.max(w * (1 - w))


def test_commensurate_transits_are_whole():
    for transits, number in (([0.3, 0.1, 0.7], 70), ([0.4, 1.0], 65), ([5.0], 64)):
        found, smear = ck.choose_step(transits, 64, 1000, 1e-12, 0.0)
        assert smear < 1e-12
        assert found == number
        for T in transits:
            ratio = Fraction(T).limit_denominator(100) / Fraction(max(transits)).limit_denominator(
                100
            )
            assert (ratio * found).denominator == 1


def test_the_best_number_of_steps_is_found():
    rng = np.random.default_rng(5)
    for n in (2, 3, 5):
        transits = rng.uniform(0.2, 1, n).tolist()
        every = np.array([worst_smear(transits, k) for k in range(64, 2001)])
        for power in (0.0, 1.0):
            number, smear = ck.choose_step(transits, 64, 2000, 0.0, power)
            cost = every / np.arange(64, 2001) ** power
            assert number == 64 + np.argmin(cost)
            assert smear == pytest.approx(every[number - 64], rel=1e-9)
        enough = 2 * every.min()
        number, smear = ck.choose_step(transits, 64, 2000, enough, 0.0)
        assert number == 64 + np.flatnonzero(every <= enough)[0]


# Steps that are cut -------------------------------------------------------------------------------


def by_steps(values, places, steps):
    """Means over whole steps of what is known by their parts."""
    widths = np.diff(places) / TICKS
    return values[: steps * len(widths)].reshape(-1, len(widths)) @ widths


def test_cuts_change_nothing_where_waves_are_even():
    """Rods, rigid contacts and walls do not care how a step is divided: the means are the same."""
    cuts, found = [TICKS // 5, TICKS // 2, TICKS // 8 * 7], 0
    for seed in range(80):
        system = whole_network(seed)
        plain = all(isinstance(b, ri.Rod | ri.Wall) for b in system.bodies) and all(
            isinstance(law, ri.Bonded) for law in system.contacts)
        if not plain:
            continue
        found += 1
        whole, cut = machine_of(system, 64), machine_of(system, 256, cuts=cuts)
        whole.advance(64)
        cut.advance(256)
        for line in range(2, 2 * len(whole.state.steps) - 2):
            a, b = int(whole.signals.wave_start[line]), int(cut.signals.wave_start[line])
            merged = by_steps(cut.signals.wave[b : b + 256], cut.places, 64)
            assert merged == pytest.approx(whole.signals.wave[a : a + 64], abs=1e-13), seed
    assert found >= 3


def test_parts_of_steps_keep_energy_and_momentum():
    for seed in range(40):
        system = whole_network(seed)
        machine = machine_of(system, 300, cuts=[TICKS // 7, TICKS // 3])
        held = []
        for end in range(0, 300, 7):  # at parts in the middle of a step too
            machine.advance(end)
            held.append(contents(machine))
        (energy, lost), scale = np.array(held).T, held[0][0]
        assert np.all(np.diff(energy) <= 1e-12 * scale), seed
        assert energy + lost == pytest.approx(np.full(len(energy), scale), abs=1e-11 * scale)


def contents(machine):
    """Energy in rods, masses and contacts, and what was lost in contacts, over the step."""
    row, tally = machine.state, machine.tally
    energy = sum(
        M * v * v / 2 for M, v in zip(row.mass, row.speed, strict=True)
    ) + sum(lk.stored(*x) for x in zip(row.law, row.stiffness, row.exponent, row.gap, strict=True))
    for s in range(1, len(row.steps) - 1):
        for line in (2 * s, 2 * s + 1):
            for i in range(machine.taken - row.steps[s], machine.taken):
                wave = machine.signals.wave[machine.signals.wave_start[line] + i]
                energy += ck.stay(row, s, i, machine.taken) / row.mobility[s] / 4 * wave * wave
    return energy, float(np.sum(tally.lost) + np.sum(tally.numerical))


@pytest.mark.parametrize("mass", [0.0, 2.0])
@pytest.mark.parametrize("law", [ri.SpringDashpot(5.0, 2.0), ri.HuntCrossley(20.0, 3.0)])
def test_losses_do_not_depend_on_cuts(law, mass):
    """Rates are lengths over durations of parts."""
    body = ri.RigidMass(mass, velocity=1.0) if mass else unit_rod(velocity=1.0)
    system = ri.System([body, unit_rod(1.5, 2.0)], [0.25], [law])
    whole, cut = machine_of(system, 256, 1 / 64), machine_of(
        system, 1024, 1 / 64, cuts=[TICKS // 9, TICKS // 4, TICKS // 8 * 5])
    whole.advance(256)
    cut.advance(1024)
    for name in ("impulse", "lost"):
        a, b = getattr(whole.tally, name)[1], getattr(cut.tally, name)[1]
        assert a > 0.01
        assert b == pytest.approx(a, rel=2e-3)


@pytest.mark.parametrize("mass", [0.0, 2.0])
def test_a_rigid_contact_tells_where_in_its_step_it_closes(mass):
    body = ri.RigidMass(mass, velocity=1.0) if mass else unit_rod(velocity=1.0)
    system = ri.System([body, unit_rod(2.0, 3.0)], [0.3])
    machine = machine_of(system, 64, step=1 / 8)
    machine.clock[ck.CUTS] = 1
    assert not machine.advance(64)
    assert (machine.taken, machine.clock[ck.LINK]) == (2, 1)
    assert machine.state.closed[0] == pytest.approx(0.4)  # 0.3 is 2.4 steps
    cut = machine_of(system, 64, step=1 / 8, cuts=[round(0.4 * TICKS)])
    cut.clock[ck.CUTS] = 1
    assert cut.advance(64)
    assert cut.tally.first[1] == 5
    assert cut.tally.numerical[1] == pytest.approx(0.0, abs=1e-12)


def test_a_gap_closes_early_by_round_off_only():
    """What is left of a gap that is no round-off is a gap."""
    for short, shut in ((1e-13, True), (1e-8, False)):
        system = ri.System([unit_rod(velocity=1.0), unit_rod(velocity=-1.0)], [0.5 + short])
        machine = machine_of(system, 64, step=1 / 8)
        machine.advance(2)  # both move by 1/8 a step
        assert (machine.state.gap[1] == 0) == shut


def test_forces_below_the_tolerance_are_none_in_every_link_of_a_chain():
    row, tally, signals, *rest = chain([1.0, 1.0, 1.0], [1e-13, 0.0, -1e-13],
                                       [lk.FREE, lk.RIGID, lk.RIGID, lk.FREE])
    ck.run(row, tally, signals, *rest, 1, 1e-12)
    assert row.force == [0.0] * 4
    assert row.speed == [1e-13, 0.0, -1e-13]


# Proof of finality --------------------------------------------------------------------------------


@pytest.mark.parametrize("rows", few_of([50, 150], [50]))
def test_after_the_proof_nothing_presses(rows):
    proved = met = 0
    for seed in range(rows):
        system = random_network(seed, bodies=3)
        machine = machine_of(system, 2000)
        while machine.taken < 400 and machine.finality_time():
            machine.advance(machine.taken + 16)
        if machine.finality_time() == 0:
            proved += 1
            met += sum(machine.tally.episodes.tolist()) > 0
            before = machine.tally.impulse.copy()
            machine.advance(1500)
            link = machine.state.law >= lk.RIGID
            added = np.abs(machine.tally.impulse - before)[link]
            assert np.all(added <= 1e-12 * (1e-3 + np.abs(before).max())), seed
    assert proved >= 0.4 * rows
    assert met >= 0.2 * rows


@pytest.mark.parametrize("right", [False, True])
@pytest.mark.parametrize("cuts", [(), (TICKS // 5, TICKS // 2)])
def test_an_end_is_where_its_strains_put_it(right, cuts):
    """integral(strain g dx), g the mass fraction beyond: uneven waves tell left from right."""
    wave = ri.Samples([0.0, 1.0, 0.0, 0.0, 0.0, 0.3, -0.8, 0.0])
    rod = unit_rod(velocity=wave, strain=ri.Samples([0.4, 0.0, -0.1, 0.7]))
    system = ri.System([ri.Wall(), rod] if right else [rod, ri.Wall()], [5.0])
    machine = machine_of(system, 128, step=1 / 32, cuts=cuts)
    machine.advance(7 * (len(machine.places) - 1))
    row, signals, j, k = machine.state, machine.signals, machine.taken, 0 if right else 1
    group = ck.group_motion(row, signals, k, 0, right, j, machine.tol)
    away, bound = ck.deviation_bound(row, signals, k, 0, right, j, group, machine.tol)
    steps = int(row.steps[1])
    edges = machine.edges(j - steps, j) / TICKS
    a, b = (signals.wave[signals.wave_start[line] + j - steps : signals.wave_start[line] + j]
            for line in (2, 3))
    age = (edges[-1] - (edges[1:] + edges[:-1]) / 2) / 32  # of waves that left, in transits

    def beyond(x):
        return 1 - x if right else x

    expected = np.sum((b * beyond(1 - age) - a * beyond(age)) * np.diff(edges)) / 2
    assert away == pytest.approx(-expected if right else expected, rel=1e-12)
    assert abs(away) < bound


def test_only_uniform_ends_are_bounded_by_the_waves_under_way():
    """In a stepped rod, or one with a mass, waves grow where impedance changes."""
    velocity, pieces = ri.Steps([1.0, 0.0], [0.5]), [ri.Segment(0.5, A, UNIT) for A in (3.0, 1.0)]
    uniform, stepped = unit_rod(velocity=velocity), ri.Rod(segments=pieces, velocity=velocity)
    for rod, bounds in ((uniform, (0.0, 1.0)), (stepped, (-np.inf, np.inf))):
        machine = machine_of(ri.System([rod, ri.Wall()], [9.0]), 64)
        shift = machine.row.frame
        n = len(machine.state.steps) - 2
        side = ck.group_motion(machine.state, machine.signals, n, 0, False, 0, machine.tol)
        assert (side.low + shift, side.high + shift) == pytest.approx(bounds)
        assert side.mean + shift == pytest.approx(0.5 if rod is uniform else 0.75)


def test_the_proof_waits_no_longer_than_it_says():
    """It promises when it may be asked again: not before, if nothing happens until then."""
    for seed in range(150):
        system = random_network(seed, bodies=2)
        machine = machine_of(system, 400)
        machine.advance(200)
        wait = machine.finality_time()
        pressed = machine.tally.pressed.copy()
        if 0 < wait <= 2000:
            machine.advance(machine.taken + wait + 1)
            if np.array_equal(pressed, machine.tally.pressed):
                assert machine.finality_time() == 0, seed


def test_a_squeezed_mass_is_told_in_a_sentence(monkeypatch):
    from rodimpact.methods.steps import level_kernel

    monkeypatch.setattr(level_kernel, "run", lambda *_: ck.SQUEEZED)
    with kernels.forced(False), pytest.raises(ri.InvalidModel, match=r"squeezed.*no room.*"):
        run_network(random_network(0))


def test_tallies_are_sums_over_the_signals():
    for seed in range(60):
        run = run_network(random_network(seed, driven=True), 3.0)
        plan, tally = run.row, run.tally
        for k, link in enumerate(plan.contact_link):
            if link < 0 or plan.laws[link] < lk.RIGID:
                continue
            F, _ = run.contact(k)
            pressed = np.flatnonzero(F > 0)
            assert tally.impulse[link] == pytest.approx(F.sum(), rel=1e-12)
            assert tally.peak[link] == F.max()
            assert tally.pressed[link] == len(pressed)
            edges = (pressed[0], pressed[-1] + 1) if len(pressed) else (-1, -1)
            assert (tally.first[link], tally.last[link]) == edges
        for side, link in ((0, 0), (1, -1)):
            if plan.outside[side][0] == "none" or (side and plan.laws[link] >= lk.RIGID):
                continue
            F, _ = run.outer(side)
            assert tally.impulse[link] == pytest.approx(F.sum(), abs=1e-12 * np.abs(F).sum())
