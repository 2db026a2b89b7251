"""Contact laws say what they are made of, and refuse what makes none."""

import math

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.laws import CONTACT_LAWS, law_from

STEEL = ri.materials.steel
LAWS = [
    ri.Rigid(), ri.Rigid(restitution=0.5), ri.Bonded(), ri.Spring(stiffness=1e6),
    ri.SpringDashpot(stiffness=1e6, damping=20.0), ri.Hertz(stiffness=1e9),
    ri.HuntCrossley(stiffness=1e9, damping=0.1),
]


def problems(make):
    with pytest.raises(ri.InvalidModel) as caught:
        make()
    return dict(caught.value.problems)


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_a_law_survives_its_description(law):
    described = law.to_dict()
    assert CONTACT_LAWS[described["law"]] is type(law)
    assert law_from(described) == law
    assert eval(repr(law), vars(ri)) == law


def test_names():
    assert list(CONTACT_LAWS) == [
        "rigid", "bonded", "spring", "spring-dashpot", "hertz", "hunt-crossley",
    ]
    assert len(set(LAWS)) == len(LAWS)


def test_a_plain_rigid_contact_is_described_by_its_name_alone():
    assert ri.Rigid().to_dict() == {"law": "rigid"}
    assert repr(ri.Rigid()) == "Rigid()"
    assert ri.Rigid(0.5).to_dict() == {"law": "rigid", "restitution": 0.5}
    assert ri.Rigid(1.0) != ri.Rigid()


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, True, "1 N/m", None])
@pytest.mark.parametrize("law", [ri.Spring, ri.SpringDashpot, ri.Hertz, ri.HuntCrossley])
def test_a_stiffness_is_positive(law, value):
    more = {"damping": 1.0} if law in (ri.SpringDashpot, ri.HuntCrossley) else {}
    found = problems(lambda: law(stiffness=value, **more))
    assert list(found) == ["stiffness"]
    assert "must be a" in found["stiffness"]


@pytest.mark.parametrize("law", [ri.SpringDashpot, ri.HuntCrossley])
def test_damping_is_not_negative(law):
    assert law(1.0, 0.0).damping == 0.0
    assert list(problems(lambda: law(1.0, -1.0))) == ["damping"]
    assert list(problems(lambda: law(0.0, math.nan))) == ["stiffness", "damping"]


@pytest.mark.parametrize("value", [-0.01, 1.01, math.nan, "half", True])
def test_a_restitution_lies_between_0_and_1(value):
    assert list(problems(lambda: ri.Rigid(value))) == ["restitution"]


def test_a_family_names_its_bad_member():
    assert list(problems(lambda: ri.Rigid([0.0, 1.0, 1.5]))) == ["restitution[2]"]
    assert list(problems(lambda: ri.Hertz([1.0, 0.0]))) == ["stiffness[1]"]


# Hertz contact of spheres


def test_equal_spheres():
    """Johnson's formulae by hand: E* = E/(2 (1 - nu^2)), R* = R/2."""
    law = ri.Hertz.from_radii(0.01, 0.01, STEEL, STEEL)
    modulus = 200e9 / (2 * (1 - 0.29**2))
    assert law.stiffness == pytest.approx(4 / 3 * modulus * math.sqrt(0.005), rel=1e-14)


def test_the_force_between_a_sphere_and_a_flat_is_that_of_its_contact_circle():
    """F = 4 E* a^3/(3 R) and d = a^2/R, with a the radius of the circle: Johnson, section 4.2."""
    R, a = 0.02, 1e-4
    law = ri.Hertz.from_radii(math.inf, R, ri.materials.brass, STEEL)
    compliance = (1 - 0.35**2) / 100.6e9 + (1 - 0.29**2) / 200e9
    force = 4 / (3 * compliance) * a**3 / R
    assert law.stiffness * (a * a / R) ** 1.5 == pytest.approx(force, rel=1e-14)


def test_the_sides_may_be_exchanged():
    one = ri.Hertz.from_radii(0.01, 0.03, STEEL, ri.materials.glass)
    assert ri.Hertz.from_radii(0.03, 0.01, ri.materials.glass, STEEL) == one


def test_a_rigid_face_does_not_yield():
    both = ri.Hertz.from_radii(0.01, math.inf, STEEL, STEEL)
    one = ri.Hertz.from_radii(0.01, math.inf, STEEL, None)
    assert one.stiffness == pytest.approx(2 * both.stiffness, rel=1e-15)
    assert ri.Hertz.from_radii(0.01, math.inf, None, STEEL) == one


def test_radii_make_a_family():
    law = ri.Hertz.from_radii(np.array([0.01, math.inf]), 0.02, STEEL, STEEL)
    alone = [ri.Hertz.from_radii(r, 0.02, STEEL, STEEL).stiffness for r in (0.01, math.inf)]
    assert law.stiffness.tolist() == pytest.approx(alone, rel=1e-15)
    material = ri.Material(
        "m", youngs_modulus=[1e9, 2e9], density=1000, poisson_ratio=[[0.1], [0.2]]
    )
    assert ri.Hertz.from_radii(0.01, 0.01, material, None).stiffness.shape == (2, 2)


@pytest.mark.parametrize(
    ("arguments", "path", "said"),
    [
        ((0.0, 1.0, STEEL, STEEL), "left_radius", "positive number of metres or infinite, got 0.0"),
        ((-1.0, 1.0, STEEL, STEEL), "left_radius", "positive number of metres or infinite"),
        ((1.0, math.nan, STEEL, STEEL), "right_radius", "positive number of metres or infinite"),
        ((1.0, "flat", STEEL, STEEL), "right_radius", "must be a number of metres, got 'flat'"),
        ((math.inf, math.inf, STEEL, STEEL), "right_radius", "two flat faces"),
        (([1.0, math.inf], math.inf, STEEL, STEEL), "right_radius[1]", "two flat faces"),
        ((1.0, 1.0, None, None), "right_material", "one of two faces must yield"),
        ((1.0, 1.0, "steel", None), "left_material", "must be a Material"),
        ((1.0, 1.0, STEEL, ri.materials.oak), "right_material", "'oak' has none"),
        ((1e-320, 1.0, STEEL, STEEL), "stiffness", "finite positive number of N/m^1.5"),
        ((1e300, 1e300, ri.Material("m", youngs_modulus=1e290, density=1e290, poisson_ratio=0),
          None), "stiffness", "finite positive number of N/m^1.5, got inf"),
    ],
)
def test_radii_that_make_no_contact(arguments, path, said):
    found = problems(lambda: ri.Hertz.from_radii(*arguments))
    assert list(found) == [path]
    assert said in found[path]


def test_all_mistakes_of_radii_at_once():
    found = problems(lambda: ri.Hertz.from_radii(-1.0, "x", ri.materials.oak, 3))
    assert list(found) == ["left_radius", "left_material", "right_radius", "right_material"]
