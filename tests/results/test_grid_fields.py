"""Fields from states on a grid: what they say at places and times."""

import math

import numpy as np
import pytest
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import STEP_TICKS

METHOD = "finite-difference"
THICK = ri.Material(
    "thick", youngs_modulus=2.0, density=0.5, viscosity=0.02, poisson_ratio=0.3
)
CONE = ri.Segment(
    0.5,
    ri.Samples([1.0, 0.5]),
    THICK,
    polar_moment="circular",
    lateral_inertia="rayleigh-love",
)
ROW = ri.System(
    [
        unit_rod(1.0, 2.0, velocity=0.5),
        ri.RigidMass(0.5, velocity=-0.25),
        ri.Rod(
            segments=[CONE, ri.Segment(0.75, 0.5, UNIT)],
            velocity=ri.Samples([0.0, -0.2, 0.3]),
        ),
        ri.RigidMass(1.5, velocity=-1.0),
        ri.RigidMass(0.3),
        unit_rod(0.5, velocity=0.1),
    ],
    [0.1, 0.05, 0.0, 0.1, 0.0],
    [
        ri.Hertz(20.0),
        ri.Rigid(),
        ri.HuntCrossley(10.0, 0.3),
        ri.Rigid(restitution=0.5),
        ri.Bonded(),
    ],
    gravity=-0.4,
    ends=(ri.Moved(ri.Samples([0.5, 1.0, -0.5], step=1.0)), ri.Pushed(0.2)),
)


@pytest.fixture(scope="module")
def row():
    return ri.solve(ROW, 3.0, METHOD, cells=64)


def states_of(solution):
    t = solution.fields.motion.when * solution.fields.clock.tick * STEP_TICKS
    return t[t <= solution.t_end]


# At the start -------------------------------------------------------------------------------------


def test_what_is_linear_is_met_exactly_inside():
    """v = x/2 and strain = 0.3 - 0.1 x; in half a cell at either end v is a mean.

    The end cells have begun to give way: free ends hold no strain.
    """
    rod = unit_rod(2.0, velocity=ri.Samples([0.0, 1.0]), strain=ri.Samples([0.3, 0.1]))
    s = ri.solve(ri.System([rod]), 0.999, METHOD, cells=20)
    x = np.linspace(0.1, 1.9, 37)
    assert s.velocity(0, x, 0.0) == pytest.approx(x / 2, abs=1e-14)
    edge = s.velocity(0, [0.0, 2.0], 0.0)
    assert edge == pytest.approx(
        [0.0125, 0.9875], abs=1e-14
    )  # the mean over half a cell
    x = np.linspace(0.15, 1.85, 35)
    h = s.fields.clock.tick * STEP_TICKS
    assert s.strain(0, x, 0.0) == pytest.approx(0.3 - 0.1 * x, abs=1e-14)
    assert s.strain(0, [0.0, 2.0], 0.0) == pytest.approx([0.0, 0.0], abs=1e-14)
    assert float(s.strain(0, 0.05, 0.0)) == pytest.approx(0.295 / 2, abs=3e-3)
    assert s.stress(0, x, 0.0) == pytest.approx(s.strain(0, x, 0.0), abs=0)
    assert h == pytest.approx(0.0999)
    inside = s.displacement(0, 1.9, 0.0) - s.displacement(0, 0.1, 0.0)
    assert float(inside) == pytest.approx(0.2 * 1.8, abs=1e-14)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.48, 0.7])
def test_fields_of_the_mirrored_row_are_those_of_the_row(row, share):
    """Also within half a cell of either end of a rod, where its end has values of its own."""
    image = ri.solve(ROW.mirrored(), 3.0, METHOD, cells=64)
    t = np.linspace(0.2, 3.0, 9)
    last = len(ROW.bodies) - 1
    for body in (0, 2, 5):
        length = ROW.bodies[body].length
        x = length * share / 32 * np.array([1.0, 3.0, 20.0])[:, None]
        for name, sign in (
            ("velocity", -1),
            ("displacement", -1),
            ("stress", 1),
            ("strain", 1),
        ):
            here = getattr(row, name)
            there = getattr(image, name)
            for place, opposite in ((x, length - x), (length - x, x)):
                assert there(last - body, opposite, t) == pytest.approx(
                    sign * here(body, place, t), rel=1e-8, abs=1e-8
                )


# At the ends --------------------------------------------------------------------------------------


def orders(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def mode(x):
    return math.sin(math.pi * x)


@pytest.mark.parametrize("viscosity", [0.0, 0.04, 4.0])
def test_a_damped_mode_between_held_ends_is_of_order_two(viscosity):
    """u'' + eta w^2/E u' + w^2 u = 0 for the mode sin(pi x)."""
    w = math.pi
    t = np.linspace(0.2, 2.4, 23)
    errors = []
    decay = viscosity * w * w / 2
    s = np.roots([1.0, 2 * decay, w * w]).astype(complex)
    for n in (20, 40, 80):
        rod = ri.Rod(
            1.0,
            area=2.0,
            velocity=mode,
            material=ri.Material(
                "m", youngs_modulus=1.0, density=1.0, viscosity=viscosity
            ),
        )
        found = ri.solve(
            ri.System([rod], ends=(ri.Fixed(), ri.Fixed())), 2.5, METHOD, cells=n
        )
        rate = (s[0] * np.exp(s[0] * t) - s[1] * np.exp(s[1] * t)) / (s[0] - s[1])
        u = (np.exp(s[0] * t) - np.exp(s[1] * t)) / (s[0] - s[1])
        strain = (w * u).real
        stress = (w * (u + viscosity * rate)).real
        errors.append(
            [
                np.abs(found.stress(0, x, t) - sign * stress).max()
                for x, sign in ((0.0, 1), (1.0, -1))
            ]
            + [
                np.abs(found.strain(0, 0.0, t) - strain).max(),
                np.abs(found.velocity(0, 0.5, t) - rate.real).max(),
            ]
        )
    assert orders(errors)[-1].min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_a_damped_rod_shows_the_contact_force_at_its_end():
    lossy = ri.Material("m", youngs_modulus=1.0, density=1.0, viscosity=0.02)
    row = [
        ri.Rod(L, area=A, material=lossy, velocity=v)
        for L, A, v in ((0.7, 1, 1), (1.1, 2, 0))
    ]
    s = ri.solve(ri.System(row), 3.0, METHOD, cells=60)
    h = s.fields.clock.tick * STEP_TICKS
    F = s.contacts[0].push.values
    between = np.arange(1, len(F)) * h
    mean = (F[1:] + F[:-1]) / 2
    assert s.axial_force(0, 0.7, between) == pytest.approx(-mean, abs=1e-6)  # ticks
    assert s.axial_force(1, 0.0, between) == pytest.approx(-mean, abs=1e-6)


def test_strains_beside_contacts_steps_and_masses_are_of_order_two():
    """Against end signals, whose means over a step are the values in its middle."""
    rod = ri.Rod(segments=[ri.Segment(0.6, 1.0, UNIT), ri.Segment(0.5, 2.0, UNIT)])
    row = [ri.RigidMass(0.5, velocity=1.0), rod, ri.RigidMass(0.7)]
    system = ri.System(row, [0.1, 0.0], [ri.Hertz(5.0), ri.Bonded()])
    h = 1 / 3200
    t = np.linspace(0.6, 2.4, 41)
    exact = ri.solve(system, 2.5, "characteristics")
    before = (np.floor(t / h - 0.5) + 0.5) * h
    share = (t - before) / h
    errors = []
    for n in (20, 40, 80):
        s = ri.solve(system, 2.5, METHOD, cells=n)
        errors.append([])
        for x in (0.0, 0.005, 0.6 - 1e-9, 0.6, 0.605, 1.1):
            near = (exact.strain(1, x, before + d) for d in (0.0, h))
            value = sum(w * e for w, e in zip((1 - share, share), near, strict=True))
            errors[-1].append(np.abs(s.strain(1, x, t) - value).mean())
        sides = (s.axial_force(1, x, t) for x in (0.6 - 1e-12, 0.6))
        assert next(sides) == pytest.approx(next(sides), abs=1e-9)
    assert orders(errors).mean(axis=0).min() >= 1.7
    assert max(errors[-1]) <= 2e-4


def test_an_end_that_is_driven_or_absorbs_shows_its_force():
    ends = ri.Pushed(lambda t: 0.3 * math.sin(2 * t), duration=3.0), ri.Absorbing()
    t = np.linspace(0.1, 2.9, 57)
    errors = []
    for n in (20, 40, 80):
        s = ri.solve(ri.System([unit_rod(area=2.0)], ends=ends), 3.0, METHOD, cells=n)
        driven = s.axial_force(0, 0.0, t) + 0.3 * np.sin(2 * t)
        away = s.axial_force(0, 1.0, t) + 0.3 * np.sin(2 * (t - 1)) * (t > 1)
        errors.append([np.abs(driven).max(), np.abs(away)[np.abs(t - 1) > 0.3].max()])
    assert orders(errors).min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_stress_of_damped_material_has_its_rate():
    rod = ri.Rod(1.0, area=3.0, material=THICK, velocity=lambda x: 0.4 * x)
    s = ri.solve(ri.System([rod]), 0.5, METHOD, cells=10)
    x = np.array([0.3, 0.5, 0.6])
    assert s.stress(0, x, 0.0) == pytest.approx(np.full(3, 0.02 * 0.4), rel=1e-12)
    assert s.axial_force(0, x, 0.0) == pytest.approx(np.full(3, 3 * 0.008), rel=1e-12)


# Fields agree with each other ---------------------------------------------------------------------


def test_displacement_is_the_integral_of_velocity(row):
    """Between two states velocities change evenly, but nodes drift half a step before the kick.

    In damped rods velocities are those of the displacement over two steps.
    """
    t = states_of(row)
    for body, x in ((0, 0.0), (0, 0.3125), (0, 1.0), (2, 0.8125), (5, 0.5)):
        path = np.diff(row.displacement(body, x, t)) / np.diff(t)
        v = row.velocity(body, x, t)
        assert path == pytest.approx((v[1:] + v[:-1]) / 2, abs=1e-11)
    for x in (0.0, 0.25):
        moved = row.displacement(2, x, t)
        path = (moved[4:] - moved[2:-2]) / (t[4:] - t[2:-2])
        assert path == pytest.approx(row.velocity(2, x, t)[3:-1], abs=1e-11)


def test_gap_is_the_distance_of_the_ends(row):
    """But for what a grid moves as a contact shuts, of the size of a step."""
    t = states_of(row)
    for k, length in enumerate((1.0, 0.0, 1.25, 0.0, 0.0)):
        ends = row.position(k + 1, 0.0, t) - row.position(k, length, t)
        allowed = 1e-12 if k in (0, 2, 4) else 2e-2
        assert row.contacts[k].gap(t) == pytest.approx(ends, abs=allowed)


def test_energies_and_their_integrals(row):
    t = states_of(row)[::16]
    ledger = row.energy(t)
    assert np.abs(ledger.residual).max() <= 1e-12
    x = (np.arange(64) + 0.5) / 64
    for i, time in enumerate(t):
        tick = int(row.fields.to_ticks(time))
        strain = row.fields.energy(0, tick, 0.0)[1]
        assert strain == pytest.approx(
            np.mean(row.strain(0, x, time) ** 2) * 2 / 2, rel=1e-11
        )
        assert ledger.total[i] >= strain
    kinetic = row.fields.energy(5, 0, 0.0)[0]
    assert kinetic == pytest.approx(0.5 * 0.01 / 2, rel=0.05)


def test_broadcasting_and_sides(row):
    x = np.linspace(0, 1.25, 7)[:, None]
    t = np.linspace(0, 3, 5)
    for name in (
        "velocity",
        "strain",
        "stress",
        "axial_force",
        "displacement",
        "position",
    ):
        found = getattr(row, name)(2, x, t)
        assert found.shape == (7, 5)
        for i in range(7):
            for j in range(5):
                assert found[i, j] == getattr(row, name)(2, float(x[i, 0]), float(t[j]))
    for side in ("right", "left"):
        assert np.array_equal(row.velocity(2, x, t, side), row.velocity(2, x, t))
    assert np.shape(row.velocity(0, 0.5, 0.5)) == ()


def test_gauge_is_the_field_at_its_place():
    s = ri.solve(
        ri.System(ROW.bodies[:3], ROW.gaps[:2], ROW.contacts[:2]), 1.5, METHOD, cells=64
    )
    gauge = s.gauge(2, 0.625)
    inside = gauge.times <= s.t_end
    t = gauge.times[inside]
    assert gauge.strain[inside] == pytest.approx(s.strain(2, 0.625, t), abs=1e-13)
    assert gauge.velocity[inside] == pytest.approx(s.velocity(2, 0.625, t), abs=1e-13)
    assert gauge.strain - gauge.strain[0] == pytest.approx(
        gauge.rightward + gauge.leftward - gauge.rightward[0] - gauge.leftward[0],
        abs=1e-13,
    )


def test_means_between_times():
    rod = unit_rod(velocity=lambda x: math.cos(math.pi * x))
    s = ri.solve(ri.System([rod]), 2.0, METHOD, cells=80)
    x = np.array([0.0, 0.25, 0.7])
    t = np.array([0.0, 0.33, 1.1, 2.0])
    velocity, strain = s.fields.averaged(0, x, t)
    exact = (
        np.diff(np.sin(math.pi * t) / math.pi)
        / np.diff(t)
        * np.cos(math.pi * x)[:, None]
    )
    assert velocity == pytest.approx(exact, abs=2e-3)
    inside = (
        -np.diff(-np.cos(math.pi * t) / math.pi)
        / np.diff(t)
        * np.sin(math.pi * x)[:, None]
    )
    assert strain[1:] == pytest.approx(inside[1:], abs=2e-3)


@pytest.mark.parametrize("t", [0.5, 1.0])
def test_a_state_can_be_continued(t):
    """To within what averages over cells change; the contact is open, then pressed."""
    hit = unit_rod(velocity=lambda x: 0.4 + 0.3 * math.cos(math.pi * x))
    system = ri.System([hit, unit_rod(0.7)], [0.2], [ri.Spring(4.0)])
    errors = []
    for n in (40, 160):
        whole = ri.solve(system, 3.0, METHOD, cells=n)
        assert (float(whole.contacts[0].gap(t)) > 0) == (t == 0.5)
        rest = ri.solve(whole.system_at(t), 3.0 - t, METHOD, cells=n)
        errors.append(
            max(
                abs(
                    float(rest.mean_velocity(i, 3.0 - t))
                    - float(whole.mean_velocity(i, 3.0))
                )
                for i in (0, 1)
            )
        )
    assert errors[-1] <= 2e-3
    assert errors[-1] <= errors[0]


def test_a_wall_and_a_rigid_mass_on_a_grid_have_no_strain():
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    mass = ri.RigidMass(0.1)
    row = ri.System([rod, mass, ri.Wall()], [0.0, 1e-3], [ri.Spring(1e8)] * 2)
    solution = ri.solve(row, 1e-5, "finite-difference", cells=20)
    for body, kind in ((1, "a rigid mass"), (2, "a wall")):
        with pytest.raises(ri.InvalidModel, match=f"{body} is {kind} and has no"):
            solution.strain(body, 0.0, 0.0)
        with pytest.raises(ri.InvalidModel, match=f"{body} is {kind} and has no"):
            solution.stress(body, 0.0, 0.0)
