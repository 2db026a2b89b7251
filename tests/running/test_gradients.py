"""Derivatives: closed forms, an independent solver, what scaling demands, both sides of kinks."""

from fractions import Fraction

import numpy as np
import pytest
from exhaustive import few_of
from method_of_steps import Row, impulses

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.model.paths import numbers_of, with_numbers
from rodimpact.running.differences import sides_of

STEEL = ri.materials.steel
MATERIALS = [
    ri.Material("one", youngs_modulus=100e9, density=4000.0),
    ri.Material("heavy", youngs_modulus=400e9, density=16000.0),
]
BY = ("bodies.0.length", "bodies.1.length", "bodies.0.area", "bodies.1.area")


def pair(length=0.4, other=1.0, area=1e-4, velocity=1.0):
    return ri.System(
        [
            ri.Rod(length, area=1e-4, material=STEEL, velocity=velocity),
            ri.Rod(other, area=area, material=STEEL),
        ]
    )


def random_row(seed):
    """Rods that approach each other, some stepped or strained, some apart, some before a wall.

    Runs of more than 5,000 events are left out for the time that they take.
    """
    rng = np.random.default_rng([18, seed])
    while True:
        system = _any_row(rng, seed)
        if ri.solve(system, method="fronts").events <= 5_000:
            return system


def _any_row(rng, seed):
    def rod(velocity):
        segments = [
            ri.Segment(
                float(rng.uniform(0.1, 1)),
                float(rng.uniform(0.5, 2) * 1e-4),
                MATERIALS[rng.integers(2)],
            )
            for _ in range(1 + (seed % 3 == 0))
        ]
        strain = float(1e-5 * rng.uniform(0.5, 1)) if seed % 5 == 0 else 0.0
        return ri.Rod(segments=segments, velocity=velocity, strain=strain)

    bodies = [rod(float(v)) for v in np.sort(rng.uniform(0, 1, 2 + seed % 2))[::-1]]
    if seed % 4 == 1:
        bodies.append(ri.Wall(-0.5))
    gaps = [
        float(rng.uniform(1, 2) * 1e-5) if seed % 4 > 1 else 0.0 for _ in bodies[1:]
    ]
    return ri.System(bodies, gaps=gaps)


def fields(system, *names):
    """Paths of the numbers other than 0 that have one of these names."""
    return [
        path
        for path, value in numbers_of(system).items()
        if path.rpartition(".")[2] in names and value != 0
    ]


def weighted(g, system, paths):
    """Sum of number times derivative."""
    return sum(numbers_of(system)[path] * g[path] for path in paths)


def after(system, i):
    """Velocity of body i after the collision."""
    return ri.solve(system, method="fronts").outcome.velocities_after[i]


def test_the_box_meets_waves_whose_order_changes_nothing():
    g = ri.gradient(pair(0.4, 1.0), wrt=BY)
    np.testing.assert_allclose([g[path] for path in BY[:2]], [1.0, -0.4], rtol=1e-8)
    kink = g.kinks["bodies.1.area"]
    assert kink.above == pytest.approx(0.3e4, rel=1e-7)  # of the formula above, r = 1
    assert kink.below == pytest.approx(-0.4e4, rel=1e-7)
    assert kink.jump == 0
    assert "-4000 below, 3000 above 1/m^2" in str(g)
    assert np.isnan(g["bodies.1.area"])
    g = ri.gradient(pair(0.4, 1.0), "impulse.0", BY[1::2])
    assert (g.unit, *g.units.values()) == ("N s", "(N s)/m", "(N s)/m^2")
    assert all(unit in str(g) for unit in g.units.values())


def test_equal_rods_have_a_kink_on_both_sides_of_which_e_falls():
    g = ri.gradient(pair(0.4, 0.4), wrt=["bodies.0.length", "bodies.1.area"])
    kink = g.kinks["bodies.0.length"]
    assert (kink.below, kink.above) == pytest.approx(
        (2.5, -2.5), rel=1e-8
    )  # e = l1/l2, l2/l1
    assert kink.jump == 0
    assert g["bodies.1.area"] == pytest.approx(
        0, abs=1e-8
    )  # e = 1 for equal transit times
    assert "bodies.1.area" in str(g)


def test_without_a_gap_there_is_one_side():
    system = ri.System([*pair(0.4, 0.8).bodies, ri.Rod(0.6, area=1e-4, material=STEEL)])
    path = "contacts.1.gap"
    g = ri.gradient(system, "velocity_after.2", [path])
    below, above = g.one_sided[path]
    v0, v1, v2 = (
        after(with_numbers(system, {path: gap}), 2) for gap in (0.0, 1e-7, 2e-7)
    )
    assert np.isnan(below)
    assert above == pytest.approx((4 * v1 - v2 - 3 * v0) / 2e-7, rel=1e-5)
    assert path in g.kinks
    assert np.isnan(g[path])


@pytest.mark.parametrize("seed", few_of(range(12), range(2)))
def test_scaling(seed):
    system = random_row(seed)
    lengths = fields(system, "length")
    gaps = fields(system, "gap")
    areas = fields(system, "area")
    motion = fields(system, "velocity", "strain")
    paths = [*lengths, *gaps, *areas, *motion]
    for of, of_size in (("velocity_after.0", 0), ("impulse.0", 1), ("duration.0", 1)):
        with kernels.forced(True):
            g = ri.gradient(system, of, paths)
        assert not g.kinks.keys()
        for chosen, power in (
            ([*lengths, *gaps], of_size),
            (areas, int(of == "impulse.0")),
            ([*motion, *gaps], int(of != "duration.0")),
        ):
            sizes = [abs(numbers_of(system)[path]) for path in chosen]
            error = np.dot(sizes, [g.errors[path] for path in chosen])
            off = abs(weighted(g, system, chosen) - power * g.value)
            assert off <= error
            assert error <= 1e-8 * (abs(g.value) + 1e-6)


def test_families_compiled_and_in_plain_python():
    family = pair(np.array([[0.4], [0.41]]), np.array([1.0, 1.03, 0.4]))
    with kernels.forced(False):
        plain = ri.gradient(family, wrt=BY)
    with kernels.forced(True):
        fast = ri.gradient(family, wrt=BY)
    assert np.asarray(plain).shape == (2, 3, 4)
    assert np.array_equal(plain, fast, equal_nan=True)
    for index in np.ndindex(2, 3):
        single = ri.gradient(family[index], wrt=BY)
        for path in BY:
            assert np.array_equal(
                [side[index] for side in plain.one_sided[path]], single.one_sided[path]
            )
            here = np.isfinite(plain.kinks[path].below[index])
            assert (path in single.kinks) == here
    assert "6 members" in str(plain)


def test_a_member_that_does_not_collide_has_none():
    g = ri.gradient(pair(velocity=[1.0, -1.0]), wrt=["bodies.0.length"])
    assert np.isfinite(g["bodies.0.length"][0])
    assert np.isnan(g.value[1])
    assert np.isnan(g["bodies.0.length"][1])
    with pytest.raises(ri.UndefinedRestitution, match="nothing collided"):
        ri.gradient(pair(velocity=-1.0), wrt=["bodies.0.length"])
    with pytest.raises(ri.UndefinedRestitution, match="cap of 1 events"):
        ri.gradient(pair(), "impulse.0", ["bodies.0.length"], max_events=1)


def test_what_holds_a_rod():
    rod = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
    wall = ri.System([rod, ri.Wall(-1.0)])
    g = ri.gradient(
        wall, "velocity_after.0", ["bodies.0.velocity", "bodies.1.velocity"]
    )
    np.testing.assert_allclose(g, [-1.0, 2.0], rtol=1e-10)
    assert (
        ri.gradient(wall, "velocity_after.1", ["bodies.1.velocity"])[
            "bodies.1.velocity"
        ]
        == 1
    )
    fixed = ri.System([rod, pair().bodies[1]], ends=[ri.Free(), ri.Fixed()])
    for held, moving in ((fixed, 0), (fixed.mirrored(), 1)):
        path = f"bodies.{moving}.velocity"
        g = ri.gradient(held, "impulse.0", [path])
        assert g[path] == pytest.approx(g.value * (1 - 2 * moving), rel=1e-12)
    left, right = (
        ri.gradient(held, "impulse.0", [path]).one_sided[path]
        for held, path in (
            (fixed, "bodies.0.area"),
            (fixed.mirrored(), "bodies.1.area"),
        )
    )
    assert np.isfinite(left).all()
    assert left == pytest.approx(right, rel=1e-9)


@pytest.mark.parametrize("area", [1e-4, 1.7e-4])
def test_a_striker_on_an_endless_bar(area):
    """It takes (r - 1)/(r + 1) of its speed back; r is the ratio of impedances."""
    row = ri.System(pair(0.4, 0.5, area).bodies, ends=[ri.Free(), ri.Absorbing()])
    mass = 0.4 * 1e-4 * STEEL.density
    r = area / 1e-4
    for system, striker, bar in ((row, 0, 1), (row.mirrored(), 1, 0)):
        back = (r - 1) / (r + 1)
        v = 1 - 2 * striker
        paths = [
            f"bodies.{striker}.velocity",
            f"bodies.{striker}.length",
            f"bodies.{bar}.length",
        ]
        g = ri.gradient(system, f"velocity_after.{striker}", paths)
        np.testing.assert_allclose(g, [-back, 0, 0], atol=1e-12)
        g = ri.gradient(system, "impulse.0", paths)
        np.testing.assert_allclose(
            g, [v * mass * (1 + back), mass * (1 + back) / 0.4, 0], atol=1e-12
        )
        path = f"bodies.{bar}.area"
        slope = ri.gradient(system, f"velocity_after.{striker}", [path]).one_sided[
            path
        ][1]
        assert slope == pytest.approx(-v * 2e4 / (1 + r) ** 2, rel=1e-7)


@pytest.mark.parametrize(
    ("system", "given", "message"),
    [
        (pair(), {"of": "e"}, "of: must be one of velocity_after.0, .*restitution"),
        (pair(), {"wrt": "bodies.0.length"}, "wrt: must be a list of paths"),
        (pair(), {"wrt": ["bodies.0.lenght"]}, "perhaps 'bodies.0.length' is meant"),
        (
            ri.System([ri.Wall(), *pair().bodies]),
            {"wrt": ["gravity"], "of": "impulse.0"},
            "until: must be given",
        ),
        (pair(), {"progress": 3}, "progress: must be"),
        (pair(), {"workers": 0, "max_events": 0}, "max_events: must be a positive"),
        (
            ri.System(pair().bodies, ends=[ri.Free(), ri.Absorbing()]),
            {"of": "velocity_after.1"},
            "of: must be one of velocity_after.0, impulse.0, peak_force.0, duration.0, got",
        ),
        (
            ri.System(pair().bodies, contacts=[ri.Hertz(1e10)]),
            {"method": "fronts"},
            'method "fronts" has no compliant',
        ),
    ],
)
def test_what_has_no_derivatives(system, given, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.gradient(system, **{"wrt": ["bodies.0.length"], **given})


def random_rods(rng, count):
    """Rods of different sections and materials that come together."""
    rods = []
    for velocity in np.sort(rng.uniform(0, 1, count))[::-1]:
        material = ri.Material(
            f"material {len(rods)}",
            youngs_modulus=float(rng.uniform(1e11, 4e11)),
            density=float(rng.uniform(4e3, 12e3)),
        )
        rod = ri.Rod(
            float(rng.uniform(0.1, 1)),
            area=float(rng.uniform(0.5, 2) * 1e-4),
            material=material,
            velocity=float(velocity),
        )
        rods.append(rod)
    return rods


def rigid_row(seed):
    """Two or three rods whose formulas are short, and the random numbers for the rest."""
    rng = np.random.default_rng([44, seed])
    while True:
        rods = random_rods(rng, 2 + seed % 2)
        gaps = [0.0, 1e-5][: len(rods) - 1]
        system = ri.System(rods, gaps=gaps)
        if ri.solve(system).events <= 24:
            return system, rng


@pytest.mark.parametrize("seed", few_of(range(60), range(6)))
def test_stated_errors_of_rigid_rows_bound_the_difference_from_the_formula(seed):
    system, rng = rigid_row(seed)
    paths = fields(system, "length", "area", "velocity", "gap")
    path = str(rng.choice(paths))
    form = ri.closed_form(system, [path])
    ((symbol, x),) = form.values.items()
    step = Fraction(1, 10**30)  # the formula is rational, and evaluated in fractions
    above = form.at(**{symbol: x + step})
    below = form.at(**{symbol: x - step})
    slope = float((above.velocities_after[1] - below.velocities_after[1]) / (2 * step))
    g = ri.gradient(system, "velocity_after.1", [path])
    assert abs(g[path] - slope) <= g.errors[path]
    assert g.errors[path] <= 1e-8 * (abs(slope) + abs(g.value) / float(x))


UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
COMPLIANT_NUMBERS = {
    "bodies.{}.length": "T",
    "bodies.{}.area": "Z",
    "bodies.{}.velocity": "v",
    "contacts.{}.gap": "gap",
    "contacts.{}.stiffness": "K",
    "contacts.{}.exponent": "p",
}
"""Paths of rods of unit wave speed and density, by the fields of `Row`."""


@pytest.mark.parametrize("seed", few_of(range(40), range(6)))
def test_stated_errors_of_compliant_rows_bound_the_difference_from_another_solver(seed):
    rng = np.random.default_rng([45, seed])
    rods = 2 + (seed % 3 == 2)
    row = Row(
        T=rng.uniform(0.4, 1, rods),
        Z=rng.uniform(0.5, 2, rods),
        v=np.sort(rng.uniform(-1, 1, rods))[::-1],
        gap=rng.uniform(0.02, 0.3, rods - 1),
        K=rng.uniform(0.5, 20, rods - 1),
        p=rng.choice([1.0, 1.5, 2.0, 2.5], rods - 1),
    )
    until = float(rng.uniform(1.5, 3))
    bodies = []
    for T, Z, v in zip(row.T, row.Z, row.v, strict=True):
        bodies.append(ri.Rod(float(T), area=float(Z), material=UNIT, velocity=float(v)))
    laws = [ri.PowerLaw(float(k), float(p)) for k, p in zip(row.K, row.p, strict=True)]
    system = ri.System(bodies, gaps=row.gap.tolist(), contacts=laws)

    name = list(COMPLIANT_NUMBERS)[seed % 6]
    field = COMPLIANT_NUMBERS[name]
    i = int(rng.integers(len(getattr(row, field))))
    if field == "p":
        row.p[i] = 1.5  # smaller exponents than 1 are refused
        laws[i] = ri.PowerLaw(float(row.K[i]), 1.5)
        system = ri.System(bodies, gaps=row.gap.tolist(), contacts=laws)
    nothing = Row(*(np.zeros_like(numbers) for numbers in row))
    direction = np.eye(len(getattr(row, field)))[i]
    P, slopes = impulses(row, nothing._replace(**{field: direction}), until)

    path = name.format(i)
    g = ri.gradient(system, "impulse.0", [path], until=until)
    assert g.value == pytest.approx(P[0], abs=1e-12)
    assert abs(g[path] - slopes[0]) <= g.errors[path] + 1e-12
    assert g.errors[path] <= 1e-6 * max(abs(slopes[0]), 1.0)


def mass_on_an_endless_bar(M, k, Z, V):
    """Velocity after, impulse, peak force and duration of a spring contact, underdamped."""
    a = k / (2 * Z)
    w = np.sqrt(k / M - a * a)
    peak_time = np.arctan(w / a) / w
    back = V * np.exp(-a * np.pi / w)
    peak = k * V / w * np.exp(-a * peak_time) * np.sin(w * peak_time)
    return np.array([-back, M * (V + back), peak, np.pi / w])


def test_a_mass_on_a_spring_at_an_endless_bar():
    """Its equation is that of a damped oscillator: complex steps give exact derivatives."""
    numbers = {
        "bodies.0.mass": 0.7,
        "contacts.0.stiffness": 1.6,
        "bodies.1.area": 1.3,
        "bodies.0.velocity": 0.9,
    }
    M, k, Z, V = numbers.values()
    system = ri.System(
        [ri.RigidMass(M, velocity=V), ri.Rod(1.0, area=Z, material=UNIT)],
        contacts=[ri.Spring(k)],
        ends=[ri.Free(), ri.Absorbing()],
    )
    values = mass_on_an_endless_bar(M, k, Z, V)
    for q, of in enumerate(
        ("velocity_after.0", "impulse.0", "peak_force.0", "duration.0")
    ):
        g = ri.gradient(system, of, list(numbers))
        assert g.value == pytest.approx(values[q], rel=1e-9)
        for n, path in enumerate(numbers):
            there = np.array(list(numbers.values()), complex)
            there[n] += 1e-30j
            slope = mass_on_an_endless_bar(*there)[q].imag / 1e-30
            assert abs(g[path] - slope) <= g.errors[path] + 1e-14
            assert g.errors[path] <= 1e-7


def test_a_mass_on_a_free_rod():
    """Rigid contact lasts 2 T; e = (1 - exp(-2 mu))/mu - exp(-2 mu), mu the ratio of masses."""
    system = ri.System(
        [ri.RigidMass(2.0, velocity=1.0), ri.Rod(1.0, area=1.0, material=UNIT)]
    )
    g = ri.gradient(system, wrt=["bodies.0.mass", "bodies.1.area"])
    mu = 0.5
    by_mu = (np.exp(-2 * mu) * (2 * mu + 1) - 1) / mu**2 + 2 * np.exp(-2 * mu)
    for path, slope in zip(g.wrt, (-by_mu / 4, by_mu / 2), strict=True):
        assert abs(g[path] - slope) <= g.errors[path]
        assert g.errors[path] <= 1e-8


def test_a_duration_jumps_where_the_short_rod_becomes_the_thicker_one():
    """It is 2 T of the short rod below, and 2 T of the long rod above equal impedances."""
    path = "bodies.0.area"
    system = ri.System(
        [
            ri.Rod(0.6, area=1.0, material=UNIT, velocity=1.0),
            ri.Rod(1.0, area=1.0, material=UNIT),
        ]
    )
    g = ri.gradient(system, "duration.0", [path])
    assert g.kinks[path].jump == pytest.approx(0.8, rel=1e-9)
    assert np.isnan(g[path])
    assert "a jump by 0.8 s" in str(g)
    assert g.one_sided[path] == pytest.approx((0, 0), abs=1e-6)


@pytest.mark.parametrize("distance", [1e-3, 1e-5, 3e-7])
def test_a_kink_beside_the_number_is_not_at_the_number(distance):
    """Rods of one section: e = l1/l2 for l1 < l2, and l2/l1 above."""
    length = 1.0 - distance
    g = ri.gradient(pair(length, 1.0), wrt=["bodies.0.length"])
    assert not g.kinks
    assert abs(g["bodies.0.length"] - 1.0) <= g.errors["bodies.0.length"]
    assert g.errors["bodies.0.length"] < 1e-3


def test_progress_counts_collisions_and_may_stop_them():
    counts = []
    ri.gradient(
        pair(0.4, 0.9),
        wrt=["bodies.0.length", "bodies.1.length"],
        progress=lambda done, total: counts.append((done, total)),
    )
    assert counts == sorted(counts)
    assert counts[-1][0] >= 1 + 2 * 12
    assert {total for _, total in counts} == {None}

    def stop(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        ri.gradient(pair(), wrt=["bodies.0.length"], progress=stop)


def test_what_varies_may_take_another_method():
    """Gravity is 0 here, and "fronts" has none: a rod that falls on a wall gains g t."""
    rod = ri.Rod(1.0, area=1.0, material=UNIT, velocity=-1.0)
    system = ri.System([ri.Wall(), rod], gaps=[3.0])
    g = ri.gradient(system, "velocity_after.1", ["gravity"], until=2.0)
    assert abs(abs(g["gravity"]) - 2.0) <= g.errors["gravity"] + 1e-12


@pytest.mark.exhaustive
def test_the_grid_agrees_with_characteristics_within_its_stated_error():
    system = ri.System(pair().bodies, contacts=[ri.Hertz(1e10)])
    paths = ["bodies.0.length", "contacts.0.stiffness"]
    exact = ri.gradient(system, "impulse.0", paths)
    grid = ri.gradient(system, "impulse.0", paths, method="finite-difference")
    for path in paths:
        assert abs(grid[path] - exact[path]) <= grid.errors[path] + exact.errors[path]
        assert grid.errors[path] <= 0.2 * abs(exact[path])


@pytest.mark.parametrize("noise", [0.0, 1e-12, 1e-6])
def test_bounds_of_differences_hold_for_noisy_values(noise):
    """exp(x) below 0 and 1 + 2 sin(x) above: the slope jumps from 1 to 2, the value does not."""
    steps = 2.0 ** -np.arange(3, 15)
    random = np.random.default_rng(3).uniform(-noise, noise, (2, 12, 50))
    below = np.exp(-steps)[:, None] + random[0]
    above = 1 + 2 * np.sin(steps)[:, None] + random[1]
    sides = sides_of(below, above, steps[:, None], np.full(50, noise + 1e-16))
    assert (np.abs(sides.below.value - 1) <= sides.below.error).all()
    assert (np.abs(sides.above.value - 2) <= sides.above.error).all()
    assert (np.abs(sides.jump.value) <= sides.jump.error).all()
    assert not sides.smooth.any()
