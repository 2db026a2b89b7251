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
    ri.SmithToe(resistance=400e3, quake=2.5e-3, damping=0.5),
    ri.Cushion(loading=5e8, restitution=0.8),
    ri.Tabulated([1e-4, 1e-3, 1.2e-3], [1e3, 1.2e3, 6e3], unloading=5e7),
]


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_a_law_survives_its_description(law):
    """Each law is restored, equal, from its dict and from its repr."""
    described = law.to_dict()
    kind = CONTACT_LAWS[described["law"]]
    from_description = restored(CONTACT_LAWS, "law", described)
    from_text = eval(repr(law), vars(ri))
    assert kind is type(law)
    assert from_description == law
    assert from_text == law


def test_every_law_has_its_name_and_an_example_here():
    """The contact laws are exactly these twelve names, each with an example in `LAWS`,
    and all differ.
    """
    names = (
        "rigid bonded joint spring spring-dashpot hertz hunt-crossley power yielding "
        "smith-toe cushion tabulated"
    )
    assert list(CONTACT_LAWS) == names.split()
    assert {type(law) for law in LAWS} == set(CONTACT_LAWS.values())
    assert len(set(LAWS)) == len(LAWS)  # laws can be hashed, and all differ


STIFF_LAWS = [
    ri.Spring,
    ri.SpringDashpot,
    ri.Hertz,
    ri.HuntCrossley,
    ri.PowerLaw,
    ri.Yielding,
]


# Mistakes
# --------------------------------------------------------------------------------------
# In tables of mistakes, a text that begins with = is the whole message; "" is any.

INF = math.inf
NAN = math.nan
OAK = ri.materials.oak
DENSE = ri.Material("m", youngs_modulus=1e149, density=1e149, poisson_ratio=0)


@pytest.mark.parametrize("value", [0.0, -1.0, NAN, INF, True, "1 N/m", None])
@pytest.mark.parametrize("law", STIFF_LAWS)
def test_a_stiffness_is_a_positive_number(law, value):
    numbers = dict.fromkeys(law.fields, 1.0)
    numbers["stiffness"] = value
    assert_told(lambda: law(**numbers), {"stiffness": "must be a"})


@pytest.mark.parametrize("law", [ri.SpringDashpot, ri.HuntCrossley])
@pytest.mark.parametrize(
    ("stiffness", "damping", "messages"),
    [(1.0, -1.0, {"damping": ""}), (0.0, NAN, {"stiffness": "", "damping": ""})],
)
def test_a_damping_is_no_negative_number(law, stiffness, damping, messages):
    assert_told(lambda: law(stiffness, damping), messages)


@pytest.mark.parametrize("value", [-0.01, 1.01, NAN, "half", True])
def test_a_restitution_lies_between_0_and_1(value):
    assert_told(lambda: ri.Rigid(value), {"restitution": ""})


@pytest.mark.parametrize(
    ("exponent", "stiffness", "messages"),
    [
        ([1.0, 0.5], 1e9, {"exponent[1]": "=must lie in [1, inf), got 0.5"}),
        (INF, 0.0, {"stiffness": "", "exponent": ""}),
    ],
)
def test_an_exponent_is_at_least_1(exponent, stiffness, messages):
    assert_told(lambda: ri.PowerLaw(stiffness, exponent), messages)


TOO_HARD = "=must be less than the stiffness 1000000000.0, got 1000000000.0"


@pytest.mark.parametrize(
    ("strength", "hardening", "messages"),
    [
        (1e3, [0.0, 1e9], {"hardening[1]": TOO_HARD}),
        (-1.0, -1.0, {"yield_force": "", "hardening": ""}),
    ],
)
def test_what_yields_hardens_less_than_its_stiffness(strength, hardening, messages):
    assert_told(lambda: ri.Yielding(1e9, strength, hardening), messages)


TABLE_MISTAKES = {
    "no compression": ([], [1.0], {"compression": ""}),
    "numbers": (1e-4, 1e3, {"compression": "", "force": ""}),
    "40 compressions": ([1.0] * 40, [1.0], {"compression": ""}),
    "2 for 1": (
        [1.0, 2.0],
        [1.0],
        {"compression": "as many as forces, got 2 for 1"},
    ),
    "nothing": ([], [], {"compression": "1 to 16 numbers"}),
    "negative": ([1.0, -1.0], [1.0, 2.0], {"compression.1": ""}),
    "falling": (
        [1.0, 1.0],
        [2.0, 1.0],
        {
            "compression.1": "=must lie above 1.0, got 1.0",
            "force.1": "=must lie above 2.0, got 1.0",
        },
    ),
}


@pytest.mark.parametrize(
    ("compression", "force", "messages"), TABLE_MISTAKES.values(), ids=TABLE_MISTAKES
)
def test_a_table_has_rising_points(compression, force, messages):
    assert_told(lambda: ri.Tabulated(compression, force), messages)


def test_a_table_unloads_no_softer_than_it_loads():
    compression = [1.0, 2.0]
    force = [1.0, 3.0]
    message = "=must be at least that of the steepest line, 2.0, got 1.9"
    assert_told(
        lambda: ri.Tabulated(compression, force, unloading=1.9), {"unloading": message}
    )


SPHERE_MISTAKES = {
    "no radius": (
        (0.0, 1.0, STEEL, STEEL),
        {"left_radius": "positive number of metres or infinite, got 0.0"},
    ),
    "two flat faces": (
        (INF, INF, STEEL, STEEL),
        {"right_radius": "two flat faces"},
    ),
    "two flat faces of a member": (
        ([1.0, INF], INF, STEEL, STEEL),
        {"right_radius[1]": "two flat faces"},
    ),
    "two rigid faces": (
        (1.0, 1.0, None, None),
        {"right_material": "one of the faces must be elastic"},
    ),
    "a text": (
        (1.0, 1.0, "steel", None),
        {"left_material": "must be a Material with a poisson_ratio"},
    ),
    "no Poisson ratio": (
        (1.0, 1.0, STEEL, OAK),
        {"right_material": "with a poisson_ratio"},
    ),
    "a stiffness that overflows": (
        (1e150, 1e150, DENSE, None),
        {"stiffness": "must be 0 or of a magnitude from 1e-150 to 1e+150"},
    ),
    "four mistakes at once": (
        (-1.0, "x", OAK, 3),
        {
            "left_radius": "",
            "left_material": "",
            "right_radius": "",
            "right_material": "",
        },
    ),
}


@pytest.mark.parametrize(
    ("faces", "messages"), SPHERE_MISTAKES.values(), ids=SPHERE_MISTAKES
)
def test_mistakes_of_spheres_are_named(faces, messages):
    assert_told(lambda: ri.Hertz.from_radii(*faces), messages)


@pytest.mark.parametrize("law", [ri.SpringDashpot, ri.HuntCrossley])
def test_a_damping_may_be_0(law):
    without_damping = law(stiffness=1.0, damping=0.0)
    assert without_damping.damping == 0.0


def test_what_yields_does_not_harden_unless_something_is_said():
    law = ri.Yielding(stiffness=1e9, yield_force=1e3)
    assert law.hardening == 0.0


def test_a_table_unloads_along_its_steepest_line_unless_something_is_said():
    """Without `unloading`, the `stiffness` on unloading is the largest of the slopes."""
    table = ri.Tabulated(compression=[1e-4, 3e-4], force=[1e3, 5e3])
    steepest = (5e3 - 1e3) / (3e-4 - 1e-4)
    assert table.stiffness == max(table.slopes)
    assert table.stiffness == pytest.approx(steepest)


# Hertz contact of spheres
# --------------------------------------------------------------------------------------


def test_the_force_between_a_sphere_and_a_flat_is_that_of_its_contact_circle():
    """F = 4 E* a^3/(3 R) and d = a^2/R, with a the radius of the circle: Johnson,
    section 4.2.
    """
    R = 0.02
    a = 1e-4
    of_brass = (1 - 0.35**2) / 100.6e9
    of_steel = (1 - 0.29**2) / 200e9
    effective_modulus = 1 / (of_brass + of_steel)  # E*
    expected = 4 * effective_modulus * a**3 / (3 * R)
    overlap = a * a / R

    law = ri.Hertz.from_radii(INF, R, ri.materials.brass, STEEL)

    force = law.stiffness * overlap**1.5
    assert force == pytest.approx(expected, rel=1e-14)


def test_a_rigid_face_makes_a_contact_of_like_faces_twice_as_stiff():
    """A Hertz contact of two steel faces gets twice its stiffness if either of them is
    rigid (None).
    """
    both_elastic = ri.Hertz.from_radii(0.01, INF, STEEL, STEEL)
    left_elastic = ri.Hertz.from_radii(0.01, INF, STEEL, right_material=None)
    right_elastic = ri.Hertz.from_radii(
        0.01, INF, left_material=None, right_material=STEEL
    )
    twice = 2 * both_elastic.stiffness
    assert left_elastic.stiffness == pytest.approx(twice, rel=1e-15)
    assert right_elastic == left_elastic


def test_radii_make_a_family():
    """Two radii, one of them infinite, give the stiffnesses of two single contacts."""
    left_radii = np.array([0.01, INF])
    family = ri.Hertz.from_radii(left_radii, 0.02, STEEL, STEEL)
    sphere = ri.Hertz.from_radii(0.01, 0.02, STEEL, STEEL)
    flat = ri.Hertz.from_radii(INF, 0.02, STEEL, STEEL)
    alone = [sphere.stiffness, flat.stiffness]
    assert family.stiffness == pytest.approx(alone, rel=1e-15)


def test_numbers_of_a_material_make_a_family():
    """A Hertz contact of a material with two moduli and, along another axis, two
    Poisson's ratios has four stiffnesses.
    """
    moduli = [1e9, 2e9]
    ratios = [[0.1], [0.2]]
    material = STEEL.replace(youngs_modulus=moduli, poisson_ratio=ratios)
    family = ri.Hertz.from_radii(0.01, 0.01, material, right_material=None)
    assert family.stiffness.shape == (2, 2)  # [ratio, modulus]


def mean_hertz_force(x0, x1):
    """Mean of 3 x^1.5 from x0 to x1, and its derivative by x1.

    Nothing is subtracted, so that no digits are lost as x1 comes near to x0: in terms
    of the square roots, the difference of the integrals is divisible by x1 - x0.
    """
    r = math.sqrt(x0)
    s = math.sqrt(x1)
    powers = sum(r ** (4 - n) * s**n for n in range(5))  # (s^5 - r^5)/(s - r)
    mean = 6 * powers / (5 * (r + s))
    cubic = 3 * s**3 + 6 * r * s * s + 4 * s * r * r + 2 * r**3
    slope = 3 * cubic / (5 * (r + s) ** 2)
    return mean, slope


def mean_spring_force(x0, x1):
    """Mean of 3 x from x0 to x1, and its derivative by x1."""
    mean = 3 * (x0 + x1) / 2
    slope = 3 / 2
    return mean, slope


# A force that is a power of the indentation
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("exponent", "expected"), [(1.0, mean_spring_force), (1.5, mean_hertz_force)]
)
def test_the_mean_force_of_a_power_is_accurate_where_indentations_are_near(
    exponent, expected
):
    """Mean force of a power law between two overlaps, and its slope, are the exact ones
    for ratios from 1 + 1e-14 to 101, in both directions, and for equal overlaps.
    """
    rng = np.random.default_rng(1)
    for power in range(-14, 3):
        factor = 1 + 10.0**power  # almost 1 at first, 101 at last
        x0 = float(rng.uniform(0.1, 2))
        for x1 in (x0 * factor, x0 / factor, x0):
            mean, slope = contact_laws.mean_power(3.0, exponent, x0, x1)
            exact_mean, exact_slope = expected(x0, x1)
            assert mean == pytest.approx(exact_mean, rel=2e-15)
            assert slope == pytest.approx(exact_slope, rel=1e-9)


def power_link(stiffness, exponent):
    """A link of a grid with the law F = k x^n."""
    (link,) = record_lists.blank(1, LINK)
    link.law = Law.POWER
    link.stiffness = stiffness
    link.exponent = exponent
    return link


def random_overlaps(rng):
    """200 pairs of overlaps before and after a step, negative where there is a gap."""
    return rng.uniform(-1, 2, (200, 2)).tolist()


@pytest.mark.parametrize("exponent", [1.01, 1.5, 2.0, 2.7, 6.0])
def test_mean_force_times_change_is_the_work_of_a_power_also_across_a_gap(exponent):
    """Between random overlaps, also negative ones, the mean force times the change is
    the difference of the energy.
    """
    rng = np.random.default_rng(2)
    link = power_link(stiffness=5.0, exponent=exponent)

    def energy(x):
        overlap = max(x, 0.0)
        return 5.0 * overlap ** (exponent + 1) / (exponent + 1)

    for x0, x1 in random_overlaps(rng):
        mean, _ = contact_laws.mean_force(link, x0, x1)
        work = energy(x1) - energy(x0)
        change = x1 - x0
        assert mean * change == pytest.approx(work, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("exponent", [1.01, 1.5, 2.0, 2.7, 6.0])
def test_the_slope_of_the_mean_force_is_its_derivative_by_the_later_overlap(exponent):
    """The slope that `mean_force` gives, between random overlaps, is the central
    difference of the mean force by the later overlap.
    """
    rng = np.random.default_rng(2)
    link = power_link(stiffness=5.0, exponent=exponent)
    step = 1e-6
    for x0, x1 in random_overlaps(rng):
        _, slope = contact_laws.mean_force(link, x0, x1)
        later_mean, _ = contact_laws.mean_force(link, x0, x1 + step)
        earlier_mean, _ = contact_laws.mean_force(link, x0, x1 - step)
        quotient = (later_mean - earlier_mean) / (2 * step)
        assert slope == pytest.approx(quotient, rel=1e-4, abs=1e-3)


# What yields
# --------------------------------------------------------------------------------------


def random_table(rng):
    """A link that yields by a random table, with a random gap and mobility, and how far
    its faces would close in a step if it had no force.
    """
    (link,) = record_lists.blank(1, LINK)
    stiffness = 10 ** rng.uniform(-3, 8)
    yield_force = 10 ** rng.uniform(-4, 2)
    count = rng.integers(6)
    link.law = Law.YIELD
    link.stiffness = stiffness
    link.yield_force = yield_force
    link.self_mobility = 10 ** rng.uniform(-4, 4)
    knots = yield_force + np.cumsum(10 ** rng.uniform(-3, 2, count))
    link.knots = [*knots, UNREACHED]
    # Slopes over the stiffness: below the first knot, and from each knot on.
    slopes = rng.uniform(0, 1, count + 1)
    link.hardening_share = slopes[0]
    link.shares = slopes[1:]
    # The start is a gap in most cases, and just at yield in every fifth.
    overlap = yield_force / stiffness * min(1.0, rng.uniform(-3, 2))
    sign = rng.choice([1, -1])
    size = 10 ** rng.uniform(-8, 1)
    scale = rng.choice([1.0, yield_force / stiffness])
    closing = sign * size * scale
    link.gap = -overlap
    # The solver starts from this guess of the overlap at the end of the step.
    link.overlap = overlap + closing * rng.random()
    return link, closing


def test_the_force_of_a_step_is_the_mean_force_of_any_yielding_table():
    """The link of each of 200 random yielding tables is solved over a step: its new
    overlap follows from the force, and this is the mean force between both overlaps.
    """
    for seed in range(200):
        link, closing = random_table(np.random.default_rng(seed))
        x0 = -link.gap

        F, x1, _ = ck.solve_link(link, closing)

        round_off = 1e-11 * (abs(x1) + abs(x0) + abs(closing))
        expected_overlap = x0 + closing - link.self_mobility * F
        assert x1 == pytest.approx(expected_overlap, abs=round_off), seed
        mean, _ = contact_laws.mean_force(link, x0, x1)
        error_of_force = round_off / link.self_mobility
        assert pytest.approx(mean, rel=1e-6, abs=error_of_force) == F, seed


TABLE = ri.Tabulated([1.0, 2.0, 3.0], [1.0, 1.5, 3.5], unloading=4.0)
"""Compressions and forces of points, which straight lines join; the slope of unloading.
"""


def test_a_table_hardened_by_a_peak_force_is_elastic_up_to_it_and_then_goes_on():
    """A table that is hardened by a force between two points begins with this force,
    reached along the unloading line, and goes on with the later points, shifted.
    """
    # A force of 1.25 is halfway along the second line, from (1, 1) to (2, 1.5): at a
    # compression of 1.5, 0.5 before the next point.
    peak_force = 1.25
    elastic = peak_force / 4.0  # compression along the unloading line

    hardened = TABLE.hardened(peak_force)

    compression = [elastic, elastic + 0.5, elastic + 1.5]
    np.testing.assert_allclose(hardened.compression, compression)
    assert hardened.force == (peak_force, 1.5, 3.5)


def test_a_force_below_the_peak_does_not_harden_a_table():
    """A table is unchanged by a force of 0, and a hardened one by a force below that
    which hardened it.
    """
    hardened = TABLE.hardened(1.25)
    not_loaded = TABLE.hardened(0.0)
    hardened_again = hardened.hardened(1.0)
    assert not_loaded == TABLE
    assert hardened_again == hardened


def test_a_table_hardened_beyond_its_last_point_goes_on_along_its_last_line():
    """From (2, 1.5) to (3, 3.5), with a slope of 2."""
    hardened = TABLE.hardened(5.5)
    np.testing.assert_allclose(hardened.slopes, [4.0, 2.0])


@pytest.fixture(params=["yielding", "tabulated"])
def yielding_family(request):
    """A family of two members whose law yields, at 1 kN or at 1.5 kN."""
    if request.param == "yielding":
        law = ri.Yielding(1e8, [1e3, 1.5e3], 1e7)
    else:
        law = ri.Tabulated([1e-5, [1e-4, 2e-4]], [1e3, 2e3], unloading=2e8)
    striker = ri.Rod(1.0, area=1e-4, material=STEEL, velocity=1.0)
    struck = ri.Rod(2.0, area=1e-4, material=STEEL)
    return ri.System([striker, struck], contacts=[law])


def test_members_of_a_yielding_family_are_those_alone_and_yield(yielding_family):
    """Restitution and peak force of a swept family of yielding contacts are those of
    its members solved alone; both members yield and have a set.
    """
    swept = ri.sweep(yielding_family, also=["set"])
    for i in range(2):
        outcome = ri.solve(yielding_family[i]).outcome
        peak_force = outcome.contacts[0].peak_force
        assert swept.restitution[i] == outcome.restitution
        assert swept.peak_force[i] == peak_force
        assert peak_force > 1.5e3  # N, the yield force or more
        assert swept.sets[0][i] > 0
    assert swept.restitution[0] != swept.restitution[1]


def test_a_case_file_keeps_what_yields(yielding_family):
    """Each member of a yielding family is the same system after writing and reading a
    case file.
    """
    for i in range(2):
        member = yielding_family[i]
        text = ri.format_case(member)
        case = ri.parse_case(text)
        assert case.system == member


def test_points_of_a_table_may_have_units_in_a_case_file():
    """Overlaps of a tabulated law with units in a case file are read as the same law; a
    force in mm is refused.
    """
    law = ri.Tabulated([1e-5, 1e-4], [1e3, 2e3])
    masses = [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)]
    system = ri.System(masses, contacts=[law])

    bare = ri.format_case(system)
    text = bare.replace("[1e-05, 0.0001]", '["10 um", "0.1 mm"]')
    case = ri.parse_case(text)

    assert "10 um" in text
    assert case.system == system
    length_for_force = text.replace("2000.0]", '"2 mm"]')
    with pytest.raises(ValueError, match=r"contacts\.0\.force\.1"):
        ri.parse_case(length_for_force)


# Contacts that begin pressed ----------------------------------------------------------


def pressed_cushion(law, gap):
    """A mass at rest that presses a rod through a law; the gap is minus the overlap."""
    mass = ri.RigidMass(500.0)
    bar = ri.Rod(1.0, area=9.4e-3, material=ri.materials.steel)
    return ri.System([mass, bar], contacts=[law], gaps=[gap])


@pytest.mark.parametrize(
    ("law", "least_gap"),
    [
        (ri.Cushion(1e9, restitution=0.8), "0.0"),
        (ri.Yielding(1e9, 1e4, hardening=1e8), "-1e-05"),
        (ri.SmithToe(1e5, 2.5e-3), "-0.0025"),
    ],
)
def test_an_overlap_beyond_that_of_yielding_is_refused(law, least_gap):
    message = f"^gaps.0: must be {least_gap} m or more"
    with pytest.raises(ri.InvalidModel, match=message):
        pressed_cushion(law, gap=-1e-2)


@pytest.mark.parametrize("excess", [0.0, 1e-10])
def test_a_cushion_that_begins_pressed_at_rest_pushes_alike_by_both_methods(excess):
    """Round-off may put its overlap just beyond that at which it yields."""
    yield_force = 1e4  # N
    law = ri.Cushion(1e9, restitution=0.8).hardened(yield_force)
    overlap = yield_force / law.stiffness
    system = pressed_cushion(law, gap=-overlap * (1 + excess))
    until = 1e-3  # s

    by_waves = ri.solve(system, until, "characteristics").outcome
    on_grid = ri.solve(system, until, "finite-difference", cells=200).outcome

    expected = by_waves.velocities_after
    peak_force = by_waves.contacts[0].peak_force
    assert on_grid.velocities_after == pytest.approx(expected, rel=5e-3)
    assert peak_force == pytest.approx(yield_force, rel=1e-6)
