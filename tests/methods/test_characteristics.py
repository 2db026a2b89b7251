"""The method "characteristics" through solve(): closed forms, other methods, symmetry, refusals."""

import math
import re

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import refused
from networks import UNIT, unit_rod
from scipy.integrate import solve_ivp
from systems import horizon, random_system

import rodimpact as ri
from rodimpact.methods import kernels

METHOD = "characteristics"
MASS = ri.RigidMass(1.0)


def solved(row, until=None, gaps=None, contacts=None, **options):
    arguments = {
        name: options.pop(name) for name in ("rtol", "max_events") if name in options
    }
    return ri.solve(
        ri.System(row, gaps, contacts, **options), until, METHOD, **arguments
    )


# Against exact fronts -----------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(60), range(12)))
def test_fronts_are_met_to_round_off(seed):
    system = random_system(seed, bodies=4)
    until = horizon(system, 8)
    exact = ri.solve(system, until, "fronts")
    found = ri.solve(system, until, METHOD)
    pairs = list(zip(exact.outcome.contacts, found.outcome.contacts, strict=True))
    scale = (
        max((max(abs(a.impulse), a.peak_force * until) for a, _ in pairs), default=0)
        or 1.0
    )
    largest = max(map(abs, exact.outcome.velocities_before))
    dense = "Such waves are smoothed" in found.status  # then it is as right as it says
    for a, b in pairs:
        bound = found.accuracy["impulse"] if dense else 1e-12
        assert b.impulse == pytest.approx(a.impulse, abs=bound * scale)
        bound = found.accuracy["duration"] if dense else 1e-12
        assert b.duration == pytest.approx(a.duration, rel=1e-9, abs=bound * until)
        assert b.first == pytest.approx(
            a.first, rel=1e-9, abs=bound * until, nan_ok=True
        )
    for a, b in zip(exact.contacts, found.contacts, strict=True):
        begun = [sum(e[0] < until * (1 - 1e-9) for e in c.episodes) for c in (a, b)]
        assert (
            begun[0] == begun[1] or dense
        )  # what touches at the very end may or may not have
    for i, body in enumerate(system.bodies):
        v = float(exact.mean_velocity(i, until))
        bound = found.accuracy["velocity"] * largest
        assert float(found.mean_velocity(i, until)) == pytest.approx(
            v, abs=bound if dense else 1e-12
        )
        if isinstance(body, ri.Rod):
            x = (np.arange(4) + 0.37) / 4 * body.length
            t = (np.arange(11) + 0.3)[:, None] / 11 * until
            a, b = (s.displacement(i, x, t) for s in (exact, found))
            assert b == pytest.approx(a, abs=(bound if dense else 1e-12) * until)


# Masses and rods ----------------------------------------------------------------------------------


def mass_on_a_stiff_spring(M, k):
    """Impulse, largest force and duration: two exponentials, and an equation with their echo."""
    root = math.sqrt(k * k - 4 * k / M)
    slow = (-k + root) / 2
    fast = (-k - root) / 2

    def indentation(t):
        return (math.exp(slow * t) - math.exp(fast * t)) / root

    speed = (
        1 - k / M * (math.expm1(slow * 2) / slow - math.expm1(fast * 2) / fast) / root
    )
    top = indentation(math.log(fast / slow) / root)

    def apart(_, y):
        return y[0]

    apart.terminal = True
    echo = solve_ivp(
        lambda t, y: (y[1] - 2 * k * indentation(t) - k * y[0], -k / M * y[0]),
        (0, 2),
        (indentation(2), speed),
        events=apart,
        method="DOP853",
        rtol=1e-12,
        atol=1e-15,
    )
    return M * (1 - echo.y[1, -1]), k * top, 2 + echo.t_events[0][0]


@pytest.mark.parametrize(
    ("M", "k", "gap"),
    [(0.1, 500.0, 0.0), (1.0, 500.0, 0.33), (1.0, 2e4, 0.0), (0.3, 1e6, 0.33)],
)
def test_a_stiff_spring_is_resolved_in_few_steps(M, k, gap):
    s = solved(
        [ri.RigidMass(M, velocity=1.0), unit_rod()], gaps=[gap], contacts=[ri.Spring(k)]
    )
    impulse, top, lasts = mass_on_a_stiff_spring(M, k)
    o = s.outcome
    assert o.impulse == pytest.approx(impulse, rel=1e-8)
    assert o.peak_force == pytest.approx(top, rel=1e-8)
    assert o.duration == pytest.approx(lasts, rel=1e-8)
    assert abs(o.energy_residual) <= 1e-9
    assert s.run.events <= 500


@pytest.mark.parametrize("gravity", [0.0, -0.5])
def test_forces_in_bonds_of_rigid_bodies(gravity):
    masses = [ri.RigidMass(m) for m in (1.0, 2.0, 3.0)]
    laws = [ri.Bonded(), ri.Bonded(), ri.Hertz(9.0)]
    rod = unit_rod(velocity=-1.0)
    t = (np.arange(64) + 0.5) / 32
    s = solved(
        [*masses, rod],
        2.0,
        contacts=laws,
        gravity=gravity,
        ends=(ri.Pushed(0.7), ri.Free()),
    )
    first, second, last = (c.force(t) for c in s.contacts)
    a = (0.7 - last) / 6
    assert first == pytest.approx(0.7 - a, abs=1e-8)
    assert second == pytest.approx(0.7 - 3 * a, abs=1e-8)
    impulse = 0.7 - (0.7 * 2 - s.outcome.contacts[2].impulse) / 6 * 3 + 0.7
    assert s.outcome.contacts[1].impulse == pytest.approx(impulse, rel=1e-9)
    held = ri.System([ri.Wall(), *masses[:2], rod], contacts=laws, gravity=gravity)
    image = ri.solve(held.mirrored(), 2.0)
    for contacts in (ri.solve(held, 2.0).contacts, image.contacts[::-1]):
        first, second, last = (c.force(t) for c in contacts)
        assert last.max() > 0.3
        assert second == pytest.approx(last - 2 * gravity, abs=1e-8)
        assert first == pytest.approx(last - 3 * gravity, abs=1e-8)


# Compliant contacts -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kappa", "e"), [(1e-3, 1.0), (1.0, 0.94410), (10.0, 0.61670), (1e3, 0.41102)]
)
def test_hertz_ends_carry_e_from_one_to_the_ratio_of_lengths(kappa, e):
    duration = 6.0 + 18 * kappa**-0.4
    row = [unit_rod(0.4, velocity=1.0), unit_rod()]
    s = solved(row, duration, contacts=[ri.Hertz(kappa)])
    assert s.outcome.restitution == pytest.approx(e, abs=4e-4)


LAWS = {
    "spring": (ri.Spring(5.0), lambda p, w: 5 * p),
    "spring and dashpot": (ri.SpringDashpot(5.0, 1.0), lambda p, w: 5 * p + w),
    "Hertz": (ri.Hertz(5.0), lambda p, w: 5 * p**1.5),
    "Hunt-Crossley": (
        ri.HuntCrossley(5.0, 0.4),
        lambda p, w: 5 * p**1.5 * (1 + 0.4 * w),
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_mass_through_a_law_on_an_endless_bar(name):
    """A bar that absorbs is a dashpot Z: an ordinary differential equation."""
    law, force = LAWS[name]
    M = 0.5
    Z = 2.0
    gap = 0.0837

    def rate(_, y):
        x, V, _ = y
        if x <= 0:
            return [V, 0.0, 0.0]
        low, high = 0.0, 1e3  # F = force(x, V - F/Z) decreases on the right
        for _ in range(60):
            F = (low + high) / 2
            low, high = (F, high) if force(x, V - F / Z) > F else (low, F)
        return [V - F / Z, -F / M, F]

    def leaves(_, y):
        return y[0] + 1e-12

    leaves.terminal = True
    leaves.direction = -1
    exact = solve_ivp(
        rate, (0, 4.0 - gap), [1e-13, 1.0, 0.0], rtol=1e-9, atol=1e-11, events=leaves
    )
    system = ri.System(
        [ri.RigidMass(M, velocity=1.0), unit_rod(1.0, Z)],
        [gap],
        [law],
        ends=(ri.Free(), ri.Absorbing()),
    )
    assert ri.solve(system, 4.0).outcome.contacts[0].impulse == pytest.approx(
        exact.y[2, -1], abs=1e-8
    )


@pytest.mark.parametrize("speed", [0.2, 1.0, 1.6, 2.0])
@pytest.mark.parametrize(
    "method", few_of(["characteristics", "finite-difference"], ["characteristics"])
)
def test_restitution_of_masses_through_a_table(method, speed):
    """The area below the table is the energy; what unloads gives back F^2/(2 k)."""
    x = np.array([0.0, 0.1, 0.6, 0.7])
    F = np.array([0.0, 0.5, 0.8, 2.5])
    k = 20.0
    m = 0.5 * 0.8 / 1.3
    area = np.concatenate(([0.0], np.cumsum(np.diff(x) * (F[1:] + F[:-1]) / 2)))
    energy = m * speed**2 / 2
    i = min(int(np.searchsorted(area, energy)), 3) - 1  # the line on which it ends
    slope = (F[i + 1] - F[i]) / (x[i + 1] - x[i])
    largest = math.sqrt(F[i] ** 2 + 2 * slope * (energy - area[i]))
    law = ri.Tabulated(x[1:], F[1:], unloading=k)
    system = ri.System(
        [ri.RigidMass(0.5, velocity=speed), ri.RigidMass(0.8), unit_rod()],
        [0.01, 100.0],
        [law, ri.Rigid()],
    )
    s = ri.solve(system, 6.0, method, rtol=1e-6)
    v = s.outcome.velocities_after
    assert v[1] - v[0] == pytest.approx(math.sqrt(largest**2 / k / m), abs=2e-5)
    assert s.contacts[0].peak_force == pytest.approx(largest, rel=1e-3)
    assert s.outcome.dissipated == pytest.approx(
        energy - largest**2 / (2 * k), abs=1e-5
    )
    assert np.abs(s.energy(np.linspace(0, 6, 40)).residual).max() < 1e-8
    hardened = s.system_at(5.9).contacts[0]
    assert hardened.force[0] == pytest.approx(largest, rel=1e-3)


@pytest.mark.parametrize("compiling", few_of([False, True], [False]))
@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_what_yields_is_a_table_of_two_points(method, compiling):
    yields = ri.Yielding(10.0, 0.5, 2.0)
    table = ri.Tabulated([0.05, 1.05], [0.5, 2.5])
    found = []
    with kernels.forced(compiling):
        for law in (yields, table):
            rods = [unit_rod(1.0).replace(velocity=2.0), unit_rod(2.0)]
            system = ri.System(rods, contacts=[law])
            cells = 100 if method == "finite-difference" else None
            found.append(ri.solve(system, 12.0, method, cells=cells).outcome)
    assert found[0].peak_force > 0.55
    assert found[1].peak_force == pytest.approx(found[0].peak_force, rel=1e-5)
    np.testing.assert_allclose(
        found[1].velocities_after, found[0].velocities_after, rtol=1e-4
    )


@pytest.mark.parametrize(
    ("mirrored", "hardening"), [(False, 0.7), (True, 0.7), (False, 0.0)]
)
def test_mass_through_what_yields_on_an_endless_bar(mirrored, hardening):
    """Loads as a spring, yields until both move together, and unloads as a spring."""
    M = 0.5
    Z = 2.0
    k = 5.0
    strength = 0.3

    def follow(stiffness, y, ends):  # F, V, impulse
        ends.terminal = True
        found = solve_ivp(
            lambda _, y: [stiffness * (y[1] - y[0] / Z), -y[0] / M, y[0]],
            (0, 99.0),
            y,
            rtol=1e-11,
            atol=1e-13,
            events=ends,
        )
        return found.y[:, -1]

    y = follow(k, [0.0, 1.0, 0.0], lambda _, y: y[0] - strength)
    y = follow(hardening, y, lambda _, y: y[1] - y[0] / Z)
    largest = y[0]
    y = follow(k, y, lambda _, y: y[0])
    system = ri.System(
        [ri.RigidMass(M, velocity=1.0), unit_rod(1.0, Z)],
        contacts=[ri.Yielding(k, strength, hardening)],
        ends=(ri.Free(), ri.Absorbing()),
    )
    system = system.mirrored() if mirrored else system
    s = ri.solve(system, 6.0)
    found = s.outcome.contacts[0]
    assert found.impulse == pytest.approx(y[2], abs=1e-9)
    assert found.peak_force == pytest.approx(largest, abs=1e-9)
    assert np.abs(s.energy(np.linspace(0, 6, 40)).residual).max() < 1e-9
    after = s.system_at(5.9).contacts[-mirrored]
    assert after.yield_force == pytest.approx(largest, rel=1e-9)
    assert after.hardening == hardening


# Symmetry -----------------------------------------------------------------------------------------


# The functions of a solution agree with each other ------------------------------------------------

ROW = {
    "row": [
        unit_rod(1.0, 2.0, velocity=0.5),
        ri.RigidMass(0.5, velocity=-0.25),
        ri.Rod(
            segments=[ri.Segment(0.5, 1.0, UNIT), ri.Segment(0.75, 0.5, UNIT)],
            velocity=ri.Samples([0.0, -0.2, 0.3]),
        ),
        ri.RigidMass(1.5, velocity=-1.0),
    ],
    "gaps": [0.1, 0.05, 0.0],
    "contacts": [ri.Hertz(20.0), ri.Rigid(), ri.HuntCrossley(10.0, 0.3)],
    "ends": (ri.Moved(ri.Samples([0.5, 1.0, -0.5], step=1.0)), ri.Pushed(0.2)),
    "gravity": -0.4,
}


@pytest.fixture(scope="module")
def row():
    return solved(**ROW, until=4.0, rtol=1e-11)


T = np.linspace(0, 4, 129)


def test_contact_forces_follow_their_laws(row):
    hertz, rigid, dashpot = row.contacts
    overlap = np.maximum(-hertz.gap(T), 0.0)
    assert hertz.force(T) == pytest.approx(20 * overlap**1.5, abs=1e-8)
    assert (overlap > 0).sum() > 20
    assert len(rigid.episodes) >= 1
    assert np.all(rigid.force(T) * np.maximum(rigid.gap(T), 0) == 0)
    rate = row.velocity(2, 1.25, T) - row.velocity(3, 0.0, T)
    overlap = np.maximum(-dashpot.gap(T), 0.0)
    expected = np.maximum(10 * overlap**1.5 * (1 + 0.3 * rate), 0.0)
    assert dashpot.force(T) == pytest.approx(expected, abs=1e-8)
    for contact, tally in zip(row.contacts, row.outcome.contacts, strict=True):
        assert len(contact.episodes) == tally.episodes
        assert contact.episodes[0].start == tally.first
        force = contact.force(np.linspace(0, 4, 4001))
        assert force.max() <= tally.peak_force * (1 + 1e-9)
        assert tally.peak_force == pytest.approx(force.max(), rel=1e-3)


@pytest.mark.parametrize("law", [ri.Spring(30.0), ri.Rigid()])
def test_a_state_can_be_continued(law):
    contacts = [ROW["contacts"][0], law, ROW["contacts"][2]]
    system = ri.System(
        ROW["row"],
        [0.1, 0.05, 0.4],
        contacts,
        gravity=-0.4,
        ends=(ri.Absorbing(), ri.Pushed(0.2)),
    )
    whole = ri.solve(system, 3.0)
    open_at = [
        t
        for t in np.arange(1, 128) / 64
        if all(float(c.gap(t)) >= 0 for c in whole.contacts)
    ]
    t = open_at[len(open_at) // 2]
    rest = ri.solve(whole.system_at(t), 3.0 - t)
    for body in range(4):
        assert float(rest.mean_velocity(body, rest.t_end)) == pytest.approx(
            float(whole.mean_velocity(body, 3.0)), abs=1e-7
        )


def test_what_cannot_be_continued_says_so(row):
    with pytest.raises(ValueError, match=r"ends\.left: is driven"):
        row.system_at(1.0)
    with pytest.raises(ValueError, match="is a rigid mass"):
        row.strain(1, 0.0, 1.0)


# Tolerance --------------------------------------------------------------------------------------


@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
def test_rtol_is_kept(rtol):
    for row, laws in (
        ([ri.RigidMass(1.0, velocity=1.0), unit_rod()], [ri.Rigid()]),
        ([unit_rod(0.4, velocity=1.0), unit_rod()], [ri.Hertz(50.0)]),
        (
            [ri.RigidMass(0.2, velocity=1.0), unit_rod(), ri.RigidMass(0.3)],
            [ri.Hertz(1e3), ri.Spring(1e2)],
        ),
    ):
        rough, fine = (solved(row, 4.0, contacts=laws, rtol=r) for r in (rtol, 1e-11))
        scale = max(c.impulse for c in fine.outcome.contacts)
        for a, b in zip(rough.outcome.contacts, fine.outcome.contacts, strict=True):
            assert a.impulse == pytest.approx(b.impulse, abs=rtol * scale)


# What is stated bounds what is wrong --------------------------------------------------------------


GAPS = np.linspace(0.1, 0.12, 21).tolist()


@pytest.mark.parametrize("gap", [*few_of(GAPS, GAPS[::5]), 0.1105])
def test_a_gap_of_any_width_closes_on_time(gap):
    # fronts take no function, though it is the same everywhere
    row = [unit_rod(velocity=lambda x: 1.0 + 0 * x), unit_rod(0.75, 0.4)]
    s = ri.solve(ri.System(row, [gap]))
    assert s.method == METHOD
    assert s.outcome.restitution == pytest.approx(6 / 7, abs=1e-11)
    (episode,) = s.contacts[0].episodes
    assert episode == pytest.approx((gap, gap + 1.5, gap + 1.5), abs=1e-11)
    assert s.outcome.duration == pytest.approx(1.5, abs=1e-11)
    assert s.outcome.numerical == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("until", [1e-12, 0.013, 0.5123, 1.9])
def test_a_run_ends_where_it_was_asked_to_end(until):
    row = [ri.RigidMass(1.0, velocity=1.0), unit_rod()]
    s = solved(row, until)
    v = math.exp(-until)  # of a mass that presses on a long rod
    assert s.t_end == until
    assert abs(s.fields.end * s.fields.clock.tick - until) <= s.fields.clock.tick
    assert s.outcome.velocities_after[0] == pytest.approx(v, abs=1e-9)
    assert s.outcome.impulse == pytest.approx(1 - v, abs=1e-9)
    assert abs(s.outcome.energy_residual) <= 1e-9


# Ends of a run ------------------------------------------------------------------------------------


# Which method -------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [1, -1])
def test_large_strains_are_those_of_the_rod_in_which_they_are(order):
    """The largest wave over the wave speed, in the frame of the mean of both velocities."""
    slow = ri.Material("slow", youngs_modulus=0.01, density=1.0)  # c = Z = 0.1
    rods = [unit_rod(velocity=0.04 * order), ri.Rod(0.1, area=1.0, material=slow)]
    most = (2 * 0.04 / 1.1 - 0.02) / 0.1
    assert f"Strains reach up to {most:.2g}" in solved(rods[::order], 0.9).status
    assert (
        f"Strains reach up to {most:.2g}"
        in ri.solve(ri.System(rods[::order]), 0.9).status
    )


def test_auto_takes_fronts_where_it_can():
    row = [unit_rod(velocity=1.0), unit_rod()]
    assert ri.solve(ri.System(row)).method == "fronts"
    assert (
        ri.solve(ri.System([unit_rod()], ends=(ri.Fixed(), ri.Free())), 1.0).method
        == "fronts"
    )
    assert ri.solve(ri.System(row), rtol=1e-3).method == METHOD
    assert ri.collide(ri.RigidMass(1.0, velocity=1.0), unit_rod()).restitution < 1
    said = 'is for method "characteristics" or "finite-difference"'
    assert refused(said, ri.solve, ri.System(row), None, "fronts", rtol=0.1) == ["rtol"]


# Restitution --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "options", "said"),
    [
        (
            [unit_rod(velocity=1.0), ri.Wall()],
            {"gravity": 0.1},
            "gravity or a driven end",
        ),
        ([unit_rod(velocity=1.0), unit_rod(), unit_rod()], {}, "this row has 2"),
        ([unit_rod(), unit_rod(velocity=1.0)], {}, "move apart"),
        ([unit_rod(), unit_rod()], {}, "nothing collided; the bodies do not approach"),
        (
            [unit_rod(velocity=ri.Steps([-1.0, 1.0], [0.5])), unit_rod()],
            {},
            "centres of mass did not approach",
        ),
        (
            [unit_rod(velocity=1.0), unit_rod()],
            {"contacts": [ri.Spring(1e-4)]},
            "is not over",
        ),
        (
            [unit_rod(velocity=1.0), MASS],
            {"contacts": [ri.Bonded()]},
            "no contact of this row",
        ),
    ],
)
def test_why_there_is_no_restitution(row, options, said):
    outcome = solved(row, 4.0, **options).outcome
    assert said in outcome.why_no_restitution()
    with pytest.raises(ri.UndefinedRestitution, match=said):
        _ = outcome.restitution
    with pytest.raises(ri.UndefinedRestitution, match=said):
        outcome.as_rigid()


@pytest.mark.parametrize("moving", [0.0, 0.2])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_ball_on_a_floor_bounces_by_its_restitution_and_comes_to_rest(
    moving, mirrored
):
    """The wall and the mass approach each other, wherever both are falling."""
    row = [ri.Wall(moving), ri.RigidMass(2.0, velocity=moving), unit_rod()]
    system = ri.System(
        row, [0.3, 90.0], [ri.Rigid(restitution=0.5), ri.Rigid()], gravity=-1.0
    )
    s = ri.solve(system.mirrored() if mirrored else system, 4.0)
    t = np.linspace(0, 4, 257)
    sign = -1 if mirrored else 1
    floor = s.contacts[-mirrored]
    hit = math.sqrt(0.6)
    body = 1
    assert floor.episodes[0].start == pytest.approx(hit, abs=1e-9)
    before, after = (
        moving - sign * s.velocity(body, 0.0, hit + d) for d in (-1e-6, 1e-6)
    )
    assert (before, after) == pytest.approx((hit, -hit / 2), abs=2e-6)
    approach = moving - sign * s.velocity(body, 0.0, t)
    assert np.abs(approach[t > 3.7]).max() <= 1e-9
    assert floor.force(t[t > 3.7]) == pytest.approx(2.0, abs=1e-9)
    assert np.abs(s.energy(t).residual).max() <= 1e-8


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
@pytest.mark.parametrize("velocity", [1e150, 1e-160])
def test_velocities_whose_energy_is_no_number_are_refused(method, velocity):
    row = ri.System([unit_rod(velocity=velocity), unit_rod()])
    said = rf"bodies: .*{re.escape(repr(velocity))} m/s make energies or forces that overflow or"
    with pytest.raises(ri.InvalidModel, match=said):
        ri.solve(row, method=method, until=1.0)


@pytest.mark.parametrize("law", [ri.Spring(1e40), ri.Hertz(1e140)])
@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_contacts_as_good_as_rigid_are_refused(law, method):
    row = ri.System([unit_rod(velocity=1.0), unit_rod()], contacts=[law])
    with pytest.raises(
        ri.InvalidModel, match=r"contacts\.0\.stiffness: .*use Rigid\(\)"
    ):
        ri.solve(row, method=method, until=1.0)
