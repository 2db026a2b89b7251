"""Derivatives: closed forms, what scaling demands, differences, and both sides of a kink."""

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.model.paths import numbers_of, with_numbers

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

    Runs of more than 20,000 events are left out: they round their results by more than differences
    can bear, on one processor more than on another.
    """
    rng = np.random.default_rng([18, seed])
    while True:
        system = _any_row(rng, seed)
        if ri.solve(system, method="fronts").events <= 20_000:
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


def of_run(system, of):
    o = ri.solve(system, method="fronts").outcome
    name, _, i = of.partition(".")
    if name == "restitution":
        return o.restitution
    if name == "velocity_after":
        return o.velocities_after[int(i)]
    return getattr(o.contacts[int(i)], name)


def test_the_box_meets_waves_whose_order_changes_nothing():
    g = ri.gradient(pair(0.4, 1.0), wrt=BY)
    np.testing.assert_allclose([g[path] for path in BY[:2]], [1.0, -0.4], rtol=1e-8)
    kink = g.kinks["bodies.1.area"]
    assert kink.above == pytest.approx(0.3e4, rel=1e-7)  # of the formula above, r = 1
    assert kink.below == pytest.approx(-0.4e4, rel=1e-7)
    assert "without force" in kink.event
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
    assert (kink.jump, kink.node) == (0, 1)
    assert kink.time == pytest.approx(0.8 / STEEL.wave_speed)
    assert g["bodies.1.area"] == pytest.approx(
        0, abs=1e-8
    )  # e = 1 for equal transit times
    assert "waves from both sides" in str(g)
    assert "bodies.1.area" in str(g)


def test_without_a_gap_there_is_one_side():
    system = ri.System([*pair(0.4, 0.8).bodies, ri.Rod(0.6, area=1e-4, material=STEEL)])
    path = "contacts.1.gap"
    g = ri.gradient(system, "velocity_after.2", [path])
    below, above = g.one_sided[path]
    v0, v1, v2 = (
        of_run(with_numbers(system, {path: gap}), "velocity_after.2")
        for gap in (0.0, 1e-7, 2e-7)
    )
    assert np.isnan(below)
    assert above == pytest.approx((4 * v1 - v2 - 3 * v0) / 2e-7, rel=1e-5)
    assert "no gap" in g.kinks[path].event


@pytest.mark.parametrize("seed", few_of(range(20), range(4)))
def test_scaling(seed):
    system = random_row(seed)
    lengths, gaps = fields(system, "length"), fields(system, "gap")
    areas, motion = fields(system, "area"), fields(system, "velocity", "strain")
    paths = [*lengths, *gaps, *areas, *motion]
    for of, of_size in (("velocity_after.0", 0), ("impulse.0", 1), ("duration.0", 1)):
        g = ri.gradient(system, of, paths)
        assert not g.kinks.keys() - set(gaps)
        size = abs(g.value) + 1e-6
        assert weighted(g, system, [*lengths, *gaps]) == pytest.approx(
            of_size * g.value, abs=1e-11 * size
        )
        assert weighted(g, system, areas) == pytest.approx(
            (of == "impulse.0") * g.value, abs=1e-11 * size
        )
        assert weighted(g, system, [*motion, *gaps]) == pytest.approx(
            (of != "duration.0") * g.value, abs=1e-11 * size
        )


@pytest.mark.parametrize("seed", few_of(range(60), range(6)))
def test_differences(seed):
    system = random_row(seed)
    of = "restitution" if len(system.bodies) == 2 else "velocity_after.1"
    paths = fields(
        system, "length", "area", "density", "wave_speed", "gap", "velocity", "strain"
    )
    g = ri.gradient(system, of, paths)
    for path in paths:
        x = float(numbers_of(system)[path])
        errors = []
        for h in (1e-6 * x, 1e-7 * x):
            up, down = (
                of_run(with_numbers(system, {path: x + d}), of) for d in (h, -h)
            )
            errors.append(abs((up - down) / (2 * h) - g[path]) * abs(x))
        assert path in g.kinks or min(errors) < 1e-7 * max(
            abs(g.value), abs(x * g[path])
        ), path


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
            assert (path in single.kinks) == bool(plain.kinks[path].event[index])
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
    np.testing.assert_allclose(g, [-1.0, 2.0], rtol=1e-13)
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
    mass, r = 0.4 * 1e-4 * STEEL.density, area / 1e-4
    for system, striker, bar in ((row, 0, 1), (row.mirrored(), 1, 0)):
        back, v = (r - 1) / (r + 1), 1 - 2 * striker
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
        (pair(), {"wrt": ["gravity"]}, "gravity is for other methods"),
        (pair(), {"workers": 0, "max_events": 0}, "max_events: must be a positive"),
        (
            ri.System(pair().bodies, ends=[ri.Free(), ri.Absorbing()]),
            {"of": "velocity_after.1"},
            "of: must be one of velocity_after.0, impulse.0, duration.0, got",
        ),
        (
            ri.System(
                [
                    ri.Rod(
                        1.0,
                        area=1e-4,
                        material=STEEL,
                        velocity=ri.Steps([1.0, 0.0], [0.5]),
                    ),
                    ri.Wall(),
                ]
            ),
            {},
            "bodies.0.velocity: jumps",
        ),
        (
            ri.System(pair().bodies, contacts=[ri.Hertz(1e10)]),
            {},
            'method "fronts" has no compliant',
        ),
    ],
)
def test_what_has_no_derivatives(system, given, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.gradient(system, **{"wrt": ["bodies.0.length"], **given})
