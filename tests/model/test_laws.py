"""Contact laws say what they are made of, and refuse what makes none."""

import math

import numpy as np
import pytest
from mistakes import assert_told

import rodimpact as ri
from rodimpact.methods import contact_laws, record_lists
from rodimpact.methods.grid import contact_kernel as ck
from rodimpact.methods.grid.records import LINK
from rodimpact.methods.link import Law
from rodimpact.model.laws import CONTACT_LAWS, UNREACHED
from rodimpact.model.system import restored

STEEL = ri.materials.steel
LAWS = [
    ri.Rigid(),
    ri.Rigid(restitution=0.5),
    ri.Bonded(),
    ri.Spring(stiffness=1e6),
    ri.Joint(stiffness=1e6, damping=20.0, stretch=-1e-6),
    ri.Joint(0.0, 20.0),
    ri.SpringDashpot(stiffness=1e6, damping=20.0),
    ri.Hertz(stiffness=1e9),
    ri.HuntCrossley(stiffness=1e9, damping=0.1),
    ri.PowerLaw(stiffness=1e9, exponent=2.0),
    ri.Yielding(stiffness=1e9, yield_force=1e3, hardening=1e7),
    ri.Tabulated([1e-4, 1e-3, 1.2e-3], [1e3, 1.2e3, 6e3], unloading=5e7),
]


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_a_law_survives_its_description(law):
    described = law.to_dict()
    assert CONTACT_LAWS[described["law"]] is type(law)
    assert restored(CONTACT_LAWS, "law", described) == law
    assert eval(repr(law), vars(ri)) == law


def test_names():
    assert list(CONTACT_LAWS) == [
        "rigid",
        "bonded",
        "joint",
        "spring",
        "spring-dashpot",
        "hertz",
        "hunt-crossley",
        "power",
        "yielding",
        "tabulated",
    ]
    assert len(set(LAWS)) == len(LAWS)


# Mistakes

INF = math.inf
NAN = math.nan
OAK = ri.materials.oak
DENSE = ri.Material("m", youngs_modulus=1e149, density=1e149, poisson_ratio=0)


def stiff(law, value):
    """A law of this stiffness, whose other numbers are 1."""
    return law(
        stiffness=value, **{name: 1.0 for name in law.fields if name != "stiffness"}
    )


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        *(
            (lambda law=law, value=value: stiff(law, value), {"stiffness": "must be a"})
            for law in (
                ri.Spring,
                ri.SpringDashpot,
                ri.Hertz,
                ri.HuntCrossley,
                ri.PowerLaw,
                ri.Yielding,
            )
            for value in (0.0, -1.0, NAN, INF, True, "1 N/m", None)
        ),
        *(
            (lambda law=law, k=k, c=c: law(k, c), wanted)
            for law in (ri.SpringDashpot, ri.HuntCrossley)
            for k, c, wanted in (
                (1.0, -1.0, {"damping": ""}),
                (0.0, NAN, {"stiffness": "", "damping": ""}),
            )
        ),
        *(
            (lambda value=value: ri.Rigid(value), {"restitution": ""})
            for value in (-0.01, 1.01, NAN, "half", True)
        ),
        (
            lambda: ri.PowerLaw(1e9, [1.0, 0.5]),
            {"exponent[1]": "=must lie in [1, inf), got 0.5"},
        ),
        (lambda: ri.PowerLaw(0.0, INF), {"stiffness": "", "exponent": ""}),
        (
            lambda: ri.Yielding(1e9, 1e3, [0.0, 1e9]),
            {
                "hardening[1]": "=must be less than the stiffness 1000000000.0, got 1000000000.0"
            },
        ),
        (lambda: ri.Yielding(1e9, -1.0, -1.0), {"yield_force": "", "hardening": ""}),
        (lambda: ri.Tabulated([], [1.0]), {"compression": ""}),
        (lambda: ri.Tabulated(1e-4, 1e3), {"compression": "", "force": ""}),
        (lambda: ri.Tabulated([1.0] * 40, [1.0]), {"compression": ""}),
        (
            lambda: ri.Tabulated([1.0, 2.0], [1.0]),
            {"compression": "as many as forces, got 2 for 1"},
        ),
        (lambda: ri.Tabulated([], []), {"compression": "1 to 16 numbers"}),
        (lambda: ri.Tabulated([1.0, -1.0], [1.0, 2.0]), {"compression.1": ""}),
        (
            lambda: ri.Tabulated([1.0, 1.0], [2.0, 1.0]),
            {
                "compression.1": "=must lie above 1.0, got 1.0",
                "force.1": "=must lie above 2.0, got 1.0",
            },
        ),
        (
            lambda: ri.Tabulated([1.0, 2.0], [1.0, 3.0], unloading=1.9),
            {"unloading": "=must be at least that of the steepest line, 2.0, got 1.9"},
        ),
        *(
            (lambda radii=radii: ri.Hertz.from_radii(*radii), wanted)
            for radii, wanted in (
                (
                    (0.0, 1.0, STEEL, STEEL),
                    {"left_radius": "positive number of metres or infinite, got 0.0"},
                ),
                ((INF, INF, STEEL, STEEL), {"right_radius": "two flat faces"}),
                (
                    ([1.0, INF], INF, STEEL, STEEL),
                    {"right_radius[1]": "two flat faces"},
                ),
                (
                    (1.0, 1.0, None, None),
                    {"right_material": "one of the faces must be elastic"},
                ),
                (
                    (1.0, 1.0, "steel", None),
                    {"left_material": "must be a Material with a poisson_ratio"},
                ),
                ((1.0, 1.0, STEEL, OAK), {"right_material": "with a poisson_ratio"}),
                (
                    (1e150, 1e150, DENSE, None),
                    {"stiffness": "must be 0 or of a magnitude from 1e-150 to 1e+150"},
                ),
                (
                    (-1.0, "x", OAK, 3),
                    dict.fromkeys(
                        (
                            "left_radius",
                            "left_material",
                            "right_radius",
                            "right_material",
                        ),
                        "",
                    ),
                ),
            )
        ),
    ],
)
def test_mistakes_of_laws(make, wanted):
    assert_told(make, wanted)


def test_what_may_be_left_out_or_be_0():
    assert (
        ri.SpringDashpot(1.0, 0.0).damping == ri.HuntCrossley(1.0, 0.0).damping == 0.0
    )
    assert ri.Yielding(1e9, 1e3).hardening == 0.0
    law = ri.Tabulated([1e-4, 3e-4], [1e3, 5e3])
    assert law.stiffness == max(law.slopes) == pytest.approx(2e7)


# Hertz contact of spheres


def test_the_force_between_a_sphere_and_a_flat_is_that_of_its_contact_circle():
    """F = 4 E* a^3/(3 R) and d = a^2/R, with a the radius of the circle: Johnson, section 4.2."""
    R = 0.02
    a = 1e-4
    law = ri.Hertz.from_radii(math.inf, R, ri.materials.brass, STEEL)
    compliance = (1 - 0.35**2) / 100.6e9 + (1 - 0.29**2) / 200e9
    force = 4 / (3 * compliance) * a**3 / R
    assert law.stiffness * (a * a / R) ** 1.5 == pytest.approx(force, rel=1e-14)


def test_a_rigid_face_does_not_yield():
    both = ri.Hertz.from_radii(0.01, math.inf, STEEL, STEEL)
    one = ri.Hertz.from_radii(0.01, math.inf, STEEL, None)
    assert one.stiffness == pytest.approx(2 * both.stiffness, rel=1e-15)
    assert ri.Hertz.from_radii(0.01, math.inf, None, STEEL) == one


def test_radii_make_a_family():
    law = ri.Hertz.from_radii(np.array([0.01, math.inf]), 0.02, STEEL, STEEL)
    alone = [
        ri.Hertz.from_radii(r, 0.02, STEEL, STEEL).stiffness for r in (0.01, math.inf)
    ]
    assert law.stiffness.tolist() == pytest.approx(alone, rel=1e-15)
    material = ri.Material(
        "m", youngs_modulus=[1e9, 2e9], density=1000, poisson_ratio=[[0.1], [0.2]]
    )
    assert ri.Hertz.from_radii(0.01, 0.01, material, None).stiffness.shape == (2, 2)


# A force that is a power of the indentation


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_the_mean_force_of_a_power_is_accurate_where_indentations_are_near(exponent):
    rng = np.random.default_rng(1)
    for power in range(-14, 3):
        x0 = float(rng.uniform(0.1, 2))
        for x1 in (x0 * (1 + 10.0**power), x0 / (1 + 10.0**power), x0):
            expected = 3 * (x0 + x1) / 2
            slope = 1.5
            if exponent == 1.5:  # without a difference, by r = sqrt(x)
                r = math.sqrt(x0)
                s = math.sqrt(x1)
                powers = sum(r ** (4 - n) * s**n for n in range(5))
                expected = 6 * powers / (5 * (r + s))
                slope = (
                    3
                    * (3 * s**3 + 6 * r * s * s + 4 * s * r * r + 2 * r**3)
                    / (5 * (r + s) ** 2)
                )
            F, dF = contact_laws.mean_power(3.0, exponent, x0, x1)
            assert pytest.approx(expected, rel=2e-15) == F
            assert dF == pytest.approx(slope, rel=1e-9)


@pytest.mark.parametrize("exponent", [1.01, 1.5, 2.0, 2.7, 6.0])
def test_its_mean_force_is_the_difference_quotient_of_its_energy(exponent):
    rng = np.random.default_rng(2)
    link = record_lists.blank(1, LINK)[0]
    link.law = Law.POWER
    link.stiffness = 5.0
    link.exponent = exponent
    for x0, x1 in rng.uniform(-1, 2, (200, 2)).tolist():
        F, dF = contact_laws.mean_force(link, x0, x1)
        held, holds = (
            5.0 * max(x, 0.0) ** (exponent + 1) / (exponent + 1) for x in (x0, x1)
        )
        assert F * (x1 - x0) == pytest.approx(holds - held, rel=1e-12, abs=1e-13)
        up, down = (contact_laws.mean_force(link, x0, x1 + s)[0] for s in (1e-6, -1e-6))
        assert dF == pytest.approx((up - down) / 2e-6, rel=1e-4, abs=1e-3)


def test_what_yields_meets_its_mean_force_on_any_table():
    link = record_lists.blank(1, LINK)[0]
    for seed in range(200):
        rng = np.random.default_rng(seed)
        k = 10 ** rng.uniform(-3, 8)
        strength = 10 ** rng.uniform(-4, 2)
        count = rng.integers(6)
        link.law = Law.YIELD
        link.stiffness = k
        link.yield_force = strength
        link.self_mobility = 10 ** rng.uniform(-4, 4)
        link.knots = [
            *(strength + np.cumsum(10 ** rng.uniform(-3, 2, count))),
            UNREACHED,
        ]
        link.hardening_share, *link.shares = rng.uniform(0, 1, count + 1)
        x0 = strength / k * min(1.0, rng.uniform(-3, 2))
        c = (
            rng.choice([1, -1])
            * 10 ** rng.uniform(-8, 1)
            * rng.choice([1.0, strength / k])
        )
        link.gap = -x0
        link.overlap = x0 + c * rng.random()
        F, x, _ = ck.solve_link(link, c)
        size = abs(x) + abs(x0) + abs(c)
        assert x == pytest.approx(x0 + c - link.self_mobility * F, abs=1e-11 * size), (
            seed
        )
        mean, _ = contact_laws.mean_force(link, x0, x)
        assert (
            pytest.approx(mean, rel=1e-6, abs=1e-11 * size / link.self_mobility) == F
        ), seed


# What yields --------------------------------------------------------------------------------------


def test_a_table_that_has_yielded_goes_on_where_it_was():
    law = ri.Tabulated([1.0, 2.0, 3.0], [1.0, 1.5, 3.5], unloading=4.0)
    assert law.hardened(0.0) == law
    later = law.hardened(1.25)  # at a compression of 1.5
    np.testing.assert_allclose(
        later.compression, [1.25 / 4, 1.25 / 4 + 0.5, 1.25 / 4 + 1.5]
    )
    assert later.force == (1.25, 1.5, 3.5)
    assert later.hardened(1.0) == later
    beyond = law.hardened(5.5)
    np.testing.assert_allclose(beyond.slopes, [4.0, 2.0])


@pytest.mark.parametrize(
    "law",
    [
        ri.Yielding(1e8, [1e3, 1.5e3], 1e7),
        ri.Tabulated([1e-5, [1e-4, 2e-4]], [1e3, 2e3], unloading=2e8),
    ],
)
def test_a_case_file_and_a_family_name_what_yields(law):
    rods = [
        ri.Rod(L, area=1e-4, material=STEEL, velocity=v)
        for L, v in ((1.0, 1.0), (2.0, 0.0))
    ]
    family = ri.System(rods, contacts=[law])
    swept = ri.sweep(family, also=["set"])
    for i in range(2):
        assert ri.parse_case(ri.write_case(family[i])).system == family[i]
        outcome = ri.solve(family[i]).outcome
        assert swept.restitution[i] == outcome.restitution
        assert swept.peak_force[i] == outcome.contacts[0].peak_force > 1e3
        assert swept.sets[0][i] > 0
    assert swept.restitution[0] != swept.restitution[1]


def test_points_of_a_table_may_have_units_in_a_case_file():
    law = ri.Tabulated([1e-5, 1e-4], [1e3, 2e3])
    row = ri.System(
        [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)], contacts=[law]
    )
    text = ri.write_case(row).replace("[1e-05, 0.0001]", '["10 um", "0.1 mm"]')
    assert "10 um" in text
    assert ri.parse_case(text).system == row
    with pytest.raises(ValueError, match=r"contacts\.0\.force\.1"):
        ri.parse_case(text.replace("2000.0]", '"2 mm"]'))
