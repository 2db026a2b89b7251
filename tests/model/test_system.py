"""Rods, masses, walls and rows of them: what is refused, kept, mirrored and stepped."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mistakes import assert_told, problems

import rodimpact as ri
from rodimpact.materials import glass, steel
from rodimpact.methods.registry import Options

NAN = float("nan")
LOVE = {"lateral_inertia": "rayleigh-love"}
MINDLIN_HERRMANN = {"lateral_inertia": "mindlin-herrmann"}
ROUND_LOVE = {"polar_moment": "circular", **LOVE}
ROUND_MINDLIN_HERRMANN = {"polar_moment": "circular", **MINDLIN_HERRMANN}
MASS = ri.RigidMass(2.0, velocity=-1.0)
SEGMENT = ri.Segment(1.0, 1.0, steel)
WALL = ri.Wall()
HERTZ = ri.Hertz(1e9)


def rod(**changes):
    """A rod 1 m long, with these fields changed or added."""
    fields = {"length": 1.0, "area": 1e-4, "material": steel}
    fields.update(changes)
    return ri.Rod(**fields)


def cone(length=1.0, first_area=1e-4, **changes):
    """A rod whose diameter doubles from end to end."""

    def area(x):
        return first_area * (1 + x / length) ** 2

    return rod(length=length, area=area, **changes)


def material(E=1.0, rho=1.0, **more):
    """A material with a wave speed of 1 m/s, if nothing else is said."""
    return ri.Material("m", youngs_modulus=E, density=rho, **more)


def row(*bodies, **more):
    """A system of these bodies."""
    return ri.System(bodies, **more)


class InheritedLaw(ri.Hertz):
    """A contact law of a user, which no method knows."""


BAD_NUMBERS = [0.0, -1.0, NAN, float("inf"), True, "1 m", None, 1j, [], {}]


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize("field", ["length", "area"])
def test_sizes_must_be_positive_numbers(field, value):
    """A rod with a bad length or area is refused with one message, for this field."""
    messages = problems(lambda: rod(**{field: value}))

    assert list(messages) == [field]
    message = messages[field]
    missing = "is missing; give it, or the diameter of a round rod"
    assert "must" in message or message == missing


def table_of(cases):
    """Parametrize a test with a table {name of the case: arguments}."""
    return [pytest.param(*arguments, id=name) for name, arguments in cases.items()]


# Each table of mistakes: a call, and by path a part of the message. A text that begins
# with = is the whole message.

OUT_OF_RANGE = (
    "must be 0 or of a magnitude from 1e-150 to 1e+150 in consistent units, got "
)
NUMBERS = {
    "three fields at once": (
        lambda: rod(length=-1.0, area=NAN, velocity="x"),
        {"length": "must be", "area": "must be", "velocity": "must be"},
    ),
    "33 axes": (
        lambda: rod(length=np.ones((1,) * 33)),
        {"length": "=must have at most 32 axes, got 33"},
    ),
    "a wave speed that overflows": (
        lambda: material(1e300, 1e-300),
        {"youngs_modulus": "", "density": ""},
    ),
    "a wave speed that underflows": (
        lambda: material(1e-300, 1e300),
        {"youngs_modulus": "", "density": ""},
    ),
    "an impedance that overflows": (
        lambda: rod(area=1e140, material=material(1e100, 1e100)),
        {"area": "impedance"},
    ),
    "a mass that overflows": (
        lambda: rod(length=1e100, material=material(1e130, 1e140)),
        {"area": "impedance"},
    ),
    "a member with a tiny transit time": (
        lambda: rod(length=[1.0, 1e-149], material=material(1e20, 1e10)),
        {"area[1]": "impedance"},
    ),
    "a subnormal area": (lambda: rod(area=1e-320), {"area": f"={OUT_OF_RANGE}1e-320"}),
    "a large area of a member": (
        lambda: rod(area=[1e-4, 1e308]),
        {"area[1]": f"={OUT_OF_RANGE}1e+308"},
    ),
    "a subnormal velocity": (
        lambda: rod(velocity=-5e-324),
        {"velocity": f"={OUT_OF_RANGE}-5e-324"},
    ),
    "a large sample": (
        lambda: ri.Samples([0.0, -1e200]),
        {"values[1]": f"={OUT_OF_RANGE}-1e+200"},
    ),
    "a late end": (
        lambda: ri.Options(until=1e308),
        {"until": f"={OUT_OF_RANGE}1e+308"},
    ),
}

SEGMENTS = {
    "a length beside segments": (
        lambda: ri.Rod(1.0, segments=[SEGMENT]),
        {"segments": ""},
    ),
    "a polar moment beside segments": (
        lambda: ri.Rod(segments=[SEGMENT], polar_moment="circular"),
        {"segments": "polar_moment"},
    ),
    "no segment": (lambda: ri.Rod(segments=[]), {"segments": ""}),
    "a text among segments": (
        lambda: ri.Rod(segments=[SEGMENT, "x"]),
        {"segments.1": ""},
    ),
    "one value for two steps": (lambda: ri.Steps([1.0], [0.5]), {"values": ""}),
    "two jumps at one place": (
        lambda: ri.Steps([1.0, 2.0, 3.0], [0.5, 0.5]),
        {"at.1": ""},
    ),
    "a number for a list": (lambda: ri.Steps(1.0, []), {"values": ""}),
    "a text among values": (lambda: ri.Steps([1.0, "2"], [0.5]), {"values.1": ""}),
    "a jump at the end of a rod": (
        lambda: rod(velocity=ri.Steps([1.0, 2.0], [1.0])),
        {"velocity.at.0": ""},
    ),
}

NOTHING_MOVES = {"bodies": "=needs a rod or a rigid mass that is not bonded to a wall"}
ROWS = {
    "no body": (lambda: row(), {"bodies": ""}),
    "two walls": (lambda: row(WALL, WALL, contacts=[ri.Rigid()]), NOTHING_MOVES),
    "a mass that is bonded to a wall": (
        lambda: row(WALL, MASS, contacts=[ri.Bonded()]),
        NOTHING_MOVES,
    ),
    "two masses that are bonded to walls": (
        lambda: row(
            WALL,
            MASS,
            MASS,
            WALL,
            contacts=[ri.Bonded(), ri.Spring(1.0), ri.Bonded()],
        ),
        NOTHING_MOVES,
    ),
    "a wall between rods": (lambda: row(rod(), WALL, rod()), {"bodies.1": ""}),
    "a text for a body": (lambda: row(rod(), "rod"), {"bodies.1": ""}),
    "a negative gap": (lambda: row(rod(), rod(), gaps=[-1e-9]), {"gaps.0": ""}),
    "a gap too many": (lambda: row(rod(), rod(), gaps=[0.0, 0.0]), {"gaps": ""}),
    "a number for gaps": (lambda: row(rod(), rod(), gaps=0.0), {"gaps": ""}),
    "a text for a law": (
        lambda: row(rod(), rod(), contacts=["rigid"]),
        {"contacts.0": ""},
    ),
    "a bond across a gap": (
        lambda: row(rod(), rod(), gaps=[1.0], contacts=[ri.Bonded()]),
        {"gaps.0": ""},
    ),
    "five mistakes at once": (
        lambda: row(rod(), WALL, rod(), gaps=[-1.0, NAN], contacts=[None, None]),
        {
            "bodies.1": "",
            "gaps.0": "",
            "contacts.0": "",
            "gaps.1": "",
            "contacts.1": "",
        },
    ),
    "a text beside a law that needs both bodies": (
        lambda: row(rod(), "mass", MASS, contacts=[ri.Rigid(1.0), ri.Rigid()]),
        {"bodies.1": ""},
    ),
    "a law of a user's class": (
        lambda: row(rod(), rod(), contacts=[InheritedLaw(1e9)]),
        {
            "contacts.0": "must be a contact law itself, one of Rigid, Bonded, Joint, "
            "Spring"
        },
    ),
    "bonded masses of unequal velocities": (
        lambda: row(
            MASS,
            ri.RigidMass(2.0, velocity=[-1.0, 2.0]),
            rod(),
            contacts=[ri.Bonded(), ri.Bonded()],
        ),
        {
            "bodies.1.velocity[1]": "=must be -1.0, that of the rigid body it is "
            "bonded to, got 2.0"
        },
    ),
}

DAMPING = {
    "a negative loss factor without a frequency": (
        lambda: steel.damped(-0.1, 0.0),
        {"loss_factor": "", "frequency": ""},
    ),
    "no loss factor": (lambda: steel.damped(NAN, 1.0), {"loss_factor": ""}),
    "a text for a frequency": (lambda: steel.damped(0.1, "1 kHz"), {"frequency": ""}),
    "a negative frequency of a member": (
        lambda: steel.damped(0.1, [1.0, -1.0]),
        {"frequency[1]": ""},
    ),
    "a viscosity that overflows": (
        lambda: steel.damped(1e100, 1e-100),
        {"viscosity": ""},
    ),
}

TAPERS = {
    "a function for rods of unequal lengths": (
        lambda: rod(length=[1.0, 2.0], area=lambda x: 1 + x),
        {"area": "differ in length; give Samples"},
    ),
    "a function for a rod of negative length": (
        lambda: rod(length=-1.0, area=lambda x: -x),
        {"length": ""},
    ),
    "five mistakes at once": (
        lambda: rod(
            area=ri.Steps([1.0, -2.0, [1.0, 0.0]], [0.25, 0.5]),
            material=7,
            polar_moment="square",
            velocity="x",
            **LOVE,
        ),
        {
            "polar_moment": "",
            "material": "",
            "area.values.1": "",
            "area.values.2[1]": "",
            "velocity": "",
        },
    ),
    "steps on a rod whose length is a text": (
        lambda: rod(length="x", area=ri.Steps([1.0, -2.0], [3.0])),
        {"length": ""},
    ),
    "a step at the end of a rod": (
        lambda: rod(area=ri.Steps([1.0, 2.0], [1.0])),
        {"area.at.0": "inside the rod of length 1.0, got 1.0"},
    ),
    "steps along a segment": (
        lambda: ri.Segment(1.0, ri.Steps([1.0, 2.0], [0.5]), steel),
        {"area": "Rod(area=Steps(...))"},
    ),
}

ONLY_CIRCULAR = 'must be "circular" along a taper and with a diameter, or left out, got'
NO_SECTION = "needs the diameter of a round rod, or a polar_moment; give one of them"
NO_THEORY = 'give lateral_inertia="rayleigh-love" too, or'
LATERAL_INERTIA = {
    "a number for the polar moment of a taper": (
        lambda: cone(polar_moment=1e-8, **LOVE),
        {"polar_moment": ONLY_CIRCULAR},
    ),
    "no section": (
        lambda: rod(lateral_inertia="mindlin-herrmann"),
        {"lateral_inertia": NO_SECTION},
    ),
    "a word that is not complete": (
        lambda: rod(polar_moment="circular", lateral_inertia="mindlin"),
        {"lateral_inertia": "perhaps 'mindlin-herrmann' is meant"},
    ),
    "a section without a theory": (
        lambda: rod(polar_moment="circular"),
        {"polar_moment": NO_THEORY},
    ),
    "a diameter without a theory": (
        lambda: rod(polar_moment="circular", area=None, diameter=0.02),
        {"polar_moment": NO_THEORY},
    ),
    "an incompressible material": (
        lambda: rod(
            material=steel.replace(poisson_ratio=0.5), **ROUND_MINDLIN_HERRMANN
        ),
        {"material.poisson_ratio": 'must be below 0.5 for "mindlin-herrmann", got 0.5'},
    ),
    "a material without a Poisson ratio": (
        lambda: rod(material=ri.materials.oak, **ROUND_MINDLIN_HERRMANN),
        {"material.poisson_ratio": "is missing in 'oak'; lateral inertia needs it"},
    ),
}


@pytest.mark.parametrize(("make", "messages"), table_of(NUMBERS))
def test_numbers_out_of_range_are_refused(make, messages):
    assert_told(make, messages)


@pytest.mark.parametrize("nu", [-1.0, 0.51, NAN, "0.3"])
def test_poisson_ratios_out_of_range_are_refused(nu):
    assert_told(lambda: material(poisson_ratio=nu), {"poisson_ratio": "must"})


@pytest.mark.parametrize(("make", "messages"), table_of(SEGMENTS))
def test_mistakes_in_segments_and_their_profiles_are_refused(make, messages):
    assert_told(make, messages)


@pytest.mark.parametrize(("make", "messages"), table_of(ROWS))
def test_mistakes_in_rows_are_refused_all_at_once_and_by_their_paths(make, messages):
    assert_told(make, messages)


UNDECIDED = (
    "no wave decides this contact: give Rigid(restitution=...) or a compliant law such "
    "as Hertz"
)


@pytest.mark.parametrize("body", [MASS, WALL])
@pytest.mark.parametrize("laws", [None, [ri.Rigid(), ri.Rigid()]])
def test_rigid_contact_between_rigid_bodies_needs_a_restitution(body, laws):
    messages = {"contacts.1": UNDECIDED}
    assert_told(lambda: row(rod(), MASS, body, contacts=laws), messages)


@pytest.mark.parametrize("body", [rod(), WALL, MASS])
def test_rigid_contact_of_a_rod_takes_no_restitution(body):
    law = ri.Rigid(restitution=1.0)
    messages = {"contacts.0.restitution": "waves of a rod decide"}
    assert_told(lambda: row(rod(), body, contacts=[law]), messages)


@pytest.mark.parametrize(("make", "messages"), table_of(DAMPING))
def test_mistakes_in_damping_are_refused(make, messages):
    assert_told(make, messages)


@given(st.floats(1e-3, 1e6), st.floats(1e-3, 1e6))
def test_a_material_has_the_wave_speed_that_it_was_given(speed, density):
    """A material made from a wave speed has it, keeps a replaced one, and is equal
    after `to_dict`.
    """
    made = ri.Material("m", wave_speed=speed, density=density)
    twice_as_fast = made.replace(wave_speed=2 * speed)
    restored = ri.Material(**made.to_dict())
    assert made.wave_speed == pytest.approx(speed, rel=1e-15)
    assert twice_as_fast.wave_speed == pytest.approx(2 * speed, rel=1e-15)
    assert restored == made


def test_wave_speeds_make_a_family():
    speeds = np.array([5000.0, 5100.0, 5200.0])
    made = ri.Material("m", wave_speed=speeds, density=[[7800.0], [7900.0]])

    assert made.youngs_modulus.shape == (2, 3)
    assert np.allclose(made.wave_speed, speeds, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize(
    ("numbers", "messages"),
    [
        ({}, {"youngs_modulus": "is missing; give it, or the wave_speed"}),
        (
            {"youngs_modulus": 2e11, "wave_speed": 5000.0},
            {"wave_speed": "give either youngs_modulus or wave_speed"},
        ),
        (
            {"wave_speed": -5.0, "viscosity": -1.0},
            {
                "wave_speed": "finite positive number of m/s, got -5.0",
                "viscosity": "non-negative",
            },
        ),
        ({"wave_speed": 1e100}, {"wave_speed": "no finite Young's modulus"}),
        (
            {"wave_speed": [1.0, 2.0], "density": [1.0, 2.0, 3.0]},
            {"density": "arrays do not broadcast: density has shape (3,), wave_speed"},
        ),
    ],
)
def test_mistakes_in_wave_speeds_of_materials_are_refused(numbers, messages):
    arguments = {"density": 8000.0}
    arguments.update(numbers)
    assert_told(lambda: ri.Material("m", **arguments), messages)


@pytest.mark.parametrize("n", [0, 100001, 2.0, True, "3", None])
def test_numbers_of_steps_that_are_not_in_range_are_refused(n):
    message = f"whole number from 1 to 100000, got {n!r}"
    assert_told(lambda: cone().in_steps(n), {"n": message})


@pytest.mark.parametrize(("make", "messages"), table_of(TAPERS))
def test_mistakes_in_tapers_are_refused(make, messages):
    assert_told(make, messages)


@pytest.mark.parametrize("kind", [ri.Rod, ri.Segment])
@pytest.mark.parametrize(
    ("area", "path", "message"),
    [
        pytest.param(
            ri.Samples([1.0, 2.0, -3.0]),
            "area.values[2]",
            "positive number of square metres, got -3.0",
            id="a negative sample",
        ),
        pytest.param(
            lambda x: 0.5 - x,
            "area",
            "function that returns positive numbers, got 0.0 at 0.5",
            id="a function that crosses 0",
        ),
        pytest.param(
            lambda x: x / 0.0,
            "area",
            "cannot be evaluated: ZeroDivisionError",
            id="a function that fails",
        ),
        pytest.param(
            ri.Samples([1.0, 2.0], step=0.1),
            "area.step",
            "from end to end; leave it out",
            id="samples with a step",
        ),
        pytest.param(ri.Samples([1e149, 1.0]), "area", "area 1e+149", id="too large"),
    ],
)
def test_areas_that_no_taper_has_are_refused(kind, area, path, message):
    assert_told(lambda: kind(1.0, area=area, material=steel), {path: message})


@pytest.mark.parametrize("kind", [ri.Rod, ri.Segment])
@pytest.mark.parametrize(
    ("sizes", "path"),
    [
        pytest.param({"diameter": -1.0}, "diameter", id="negative"),
        pytest.param({}, "area", id="missing"),
        pytest.param({"diameter": 0.1, "area": 1.0}, "diameter", id="given twice"),
    ],
)
def test_a_section_is_an_area_or_a_diameter(kind, sizes, path):
    assert_told(lambda: kind(0.4, material=steel, **sizes), {path: ""})


@pytest.mark.parametrize(("make", "messages"), table_of(LATERAL_INERTIA))
def test_mistakes_in_lateral_inertia_are_refused(make, messages):
    assert_told(make, messages)


@pytest.mark.parametrize(
    "make",
    [
        lambda: rod(length=np.ones(4000), area=np.ones((4000, 1))),
        lambda: row(rod(velocity=np.ones(10**4)), ri.RigidMass(np.ones((1001, 1)))),
    ],
    ids=["one rod", "two bodies"],
)
def test_families_of_too_many_members_are_refused_before_they_are_laid_out(make):
    messages = str(problems(make))
    assert "members, more than 10000000; take one part after another" in messages


@pytest.mark.parametrize("pair", [[MASS, MASS], [MASS, WALL]])
@pytest.mark.parametrize(
    "law", [ri.Rigid(0.0), ri.Rigid([0.5, 1.0]), ri.Hertz(1.0), ri.Spring(1.0)]
)
def test_between_rigid_bodies_a_law_decides(pair, law):
    system = row(rod(), *pair, contacts=[ri.Rigid(), law])
    assert system.contacts[1] == law


def test_wave_speed_transit_time_impedance_and_mass_of_a_segment():
    """For a segment with E = 16 and a density of 4, the four are those of their
    formulas.
    """
    density = 4.0
    length = 0.5
    area = 2e-4
    segment = ri.Segment(length, area, material(E=16.0, rho=density))
    wave_speed = 2.0  # the root of 16/4
    impedance = density * wave_speed * area
    mass = density * area * length
    assert segment.wave_speed == wave_speed
    assert segment.transit_time == length / wave_speed
    assert segment.impedance == pytest.approx(impedance)
    assert segment.mass == pytest.approx(mass)


def test_gravity_of_0_is_left_out_of_the_description():
    """Gravity of 0 or -0.0 gives an equal system, whose description does not mention
    it.
    """
    system = ri.System([rod()])
    with_zero = ri.System([rod()], gravity=0)
    with_minus_zero = ri.System([rod()], gravity=-0.0)
    assert with_zero == system
    assert with_minus_zero == system
    assert set(system.to_dict()) == {"bodies", "contacts"}


def test_gravity_counts_for_the_description_and_the_digest():
    on_a_floor = ri.System([rod(), ri.Wall()])
    falling = ri.System([rod(), ri.Wall()], gravity=9.81)
    assert falling.to_dict()["gravity"] == 9.81
    assert falling.digest != on_a_floor.digest


PLAIN_DIGEST = "51c200387baca463a5a1708cea88cf999560e2752560410e72916cb4cb4c1414"
FAMILY_DIGEST = "b30b44bb2ada05120df8008049d58f1df3d1f6c184bce26c2f475d60d4942001"


def test_descriptions_of_plain_rows_stay_as_they_were():
    """The contacts of a row as dicts, and the digests of the row and of a family, are as
    they were noted once. Digests name files and sweeps on disk.
    """
    bodies = [rod(velocity=1.0), rod(), ri.Wall()]
    system = ri.System(bodies, gaps=[0.0, 1e-5], contacts=[ri.Bonded(), ri.Rigid()])
    lengths = np.array([1.0, 2.0])
    family = ri.System([rod(length=lengths), ri.Wall()])

    description = system.to_dict()

    bond = {"gap": 0.0, "law": "bonded"}
    contact = {"gap": 1e-5, "law": "rigid"}
    assert description["contacts"] == [bond, contact]
    assert system.digest == PLAIN_DIGEST
    assert family.digest == FAMILY_DIGEST


def test_equal_objects_have_equal_hashes_whatever_the_sign_of_zero():
    wall = ri.Wall(0.0)
    negative = ri.Wall(-0.0)
    assert negative == wall
    assert hash(negative) == hash(wall)


def test_equal_objects_have_equal_digests_whatever_the_sign_of_zero():
    """A mirror changes the sign of gravity, also of that which is 0."""
    system = ri.System([rod(), ri.Wall()], gravity=[1.0, 0.0])
    mirrored_twice = system.mirrored().mirrored()
    assert mirrored_twice == system
    assert mirrored_twice.digest == system.digest


@pytest.fixture(scope="module")
def family():
    """A row of shape (3, 2) in which every number that may vary does."""
    two = np.array([1.0, 2.0])
    three = np.array([[1.0], [2.0], [3.0]])
    masses = ri.RigidMass(two, velocity=three)
    bodies = [ri.Wall(), masses, ri.RigidMass(1.0), rod(), rod(), MASS]
    gaps = [0.0, two, 0.0, 0.0, 0.0]
    laws = [
        ri.Rigid(two / 2),
        ri.SpringDashpot(three, two),
        ri.Hertz(two),
        ri.HuntCrossley(two, three),
        ri.Spring(three),
    ]
    ends = (ri.Free(), ri.Pushed(three))
    return ri.System(bodies, gaps, laws, gravity=two, ends=ends)


def test_numbers_of_every_kind_make_families_by_their_paths(family):
    """A family of shape (3, 2) in which numbers of masses, contacts, gravity and an end
    vary has exactly the paths of these numbers as parameters.
    """
    assert family.shape == (3, 2)
    assert set(family.parameters) == {
        "bodies.1.mass",
        "bodies.1.velocity",
        "contacts.1.gap",
        "contacts.0.restitution",
        "contacts.1.stiffness",
        "contacts.1.damping",
        "contacts.2.stiffness",
        "contacts.3.stiffness",
        "contacts.3.damping",
        "contacts.4.stiffness",
        "gravity",
        "ends.right.value",
    }


def test_a_family_of_every_kind_of_number_survives_its_description(family):
    restored = ri.System.from_dict(family.to_dict())
    assert restored == family


def test_a_member_of_a_family_has_its_own_numbers(family):
    """The member [2, 1] of a family has its numbers of a mass, a contact, gravity and
    an end.
    """
    member = family[2, 1]
    assert member.shape == ()
    assert member.bodies[1] == ri.RigidMass(2.0, velocity=3.0)
    assert member.contacts[1] == ri.SpringDashpot(3.0, 2.0)
    assert member.gravity == 2.0
    assert member.ends[1] == ri.Pushed(3.0)


def test_a_part_of_a_family_is_a_family(family):
    first_column = family[:, 0]
    last_rows = family[1:]
    gravity = last_rows.parameters["gravity"]
    assert first_column.shape == (3,)
    assert gravity.shape == (1, 2)  # it varies along the second axis only


def test_objects_are_frozen():
    frozen = rod()
    with pytest.raises(AttributeError, match="frozen"):
        frozen.velocity = 2.0
    with pytest.raises(AttributeError, match="frozen"):
        del frozen.velocity
    assert frozen == rod()


def test_objects_compare_by_value():
    """Two equal rods are equal, with the same hash, and one in a set; a moving rod, or
    a text, is not equal to them.
    """
    first = rod()
    second = rod()
    moving = rod(velocity=1.0)
    different = {first, second, ri.Wall()}
    assert first == second
    assert hash(first) == hash(second)
    assert first != moving
    assert first != "rod"
    assert len(different) == 2


def plain_row():
    """A wall bonded to a rod with steps of velocity, and a stepped rod."""
    moving = rod(velocity=ri.Steps([1.0, 0.0], [0.25]), strain=1e-4)
    thin = ri.Segment(0.2, 1e-4, steel)
    thick = ri.Segment(0.3, 2e-4, glass)
    stepped = ri.Rod(segments=[thin, thick])
    wall = ri.Wall(1.0)
    laws = [ri.Bonded(), ri.Rigid()]
    return row(wall, moving, stepped, gaps=[0.0, 1e-5], contacts=laws)


def row_of_masses():
    """Masses and rods on a wall: two Hertz contacts, and rigid ones behind them."""
    laws = [HERTZ, HERTZ, ri.Rigid(), ri.Rigid(), ri.Rigid(), ri.Rigid()]
    return row(WALL, MASS, MASS, rod(), MASS, rod(), MASS, contacts=laws)


def family_of_two_axes():
    """Rods of three lengths and two velocities before a wall."""
    lengths = np.array([0.1, 0.2, 0.3])[:, None]
    velocities = np.array([1.0, 2.0])
    return row(rod(length=lengths, velocity=velocities), WALL)


HERTZ_PAIR = row(MASS, MASS, contacts=[HERTZ])
FALLING = row(rod(), WALL, gravity=9.81)


@pytest.mark.parametrize(
    "system",
    [plain_row(), row_of_masses(), HERTZ_PAIR, FALLING, family_of_two_axes()],
    ids=["plain", "masses", "Hertz", "gravity", "family"],
)
def test_a_system_survives_its_description(system):
    read = ri.System.from_dict(system.to_dict())
    assert read == system
    assert read.digest == system.digest


def test_a_mirror_turns_gravity_and_drives():
    """The mirrored row has the opposite gravity, bodies, contacts and ends in reverse
    order, opposite velocities, and unchanged pushes. Mirrored twice, it is the row
    itself.
    """
    push = ri.Pushed(ri.Steps([1.0, 2.0], [1e-3]))
    pull = ri.Moved(ri.Samples([1.0, 2.0], step=1e-3))
    bodies = [rod(velocity=1.0), MASS, rod()]
    gaps = [0.0, 0.5]
    laws = [ri.Rigid(), ri.Hertz(1.0)]
    system = ri.System(bodies, gaps, laws, gravity=9.81, ends=(push, pull))

    image = system.mirrored()

    # A push is positive towards the body, a velocity to the right.
    mirrored_pull = ri.Moved(ri.Samples([-1.0, -2.0], step=1e-3))
    mirrored_mass = MASS.replace(velocity=-MASS.velocity)
    assert image.gravity == -9.81
    assert image.ends == (mirrored_pull, push)
    assert image.bodies[1] == mirrored_mass
    assert image.contacts == (ri.Hertz(1.0), ri.Rigid())
    assert image.mirrored() == system


def velocities_of(system):
    """Velocity of each body, m/s."""
    return [body.velocity for body in system.bodies]


def test_gravity_and_held_ends_stay_when_time_is_turned_round():
    """Velocities change their sign; gravity and ends do not."""
    bodies = [rod(velocity=1.0), MASS, ri.Wall(1.0)]
    laws = [ri.Hertz(1.0), ri.Rigid(restitution=1)]
    ends = (ri.Fixed(), ri.Free())
    system = ri.System(bodies, contacts=laws, gravity=9.81, ends=ends)

    back = system.reversed()

    assert back.gravity == 9.81
    assert back.ends == system.ends
    assert velocities_of(system) == [1.0, -1.0, 1.0]
    assert velocities_of(back) == [-1.0, 1.0, -1.0]
    assert back.reversed() == system


def test_no_film_runs_backwards_where_something_is_lost():
    """`reversed` is refused for a row with viscosity, damping, imperfect restitution
    and an absorbing end: each of the six is named.
    """
    viscous = steel.replace(viscosity=1.0)
    elastic_segment = ri.Segment(1.0, 1e-4, steel)
    viscous_segment = ri.Segment(1.0, 1e-4, viscous)
    stepped = ri.Rod(segments=[elastic_segment, viscous_segment])
    bodies = [rod(), rod(material=viscous), stepped, MASS, ri.Wall()]
    laws = [
        ri.SpringDashpot(stiffness=1.0, damping=1.0),
        ri.HuntCrossley(stiffness=1.0, damping=[0.0, 1.0]),
        ri.Spring(1.0),
        ri.Rigid(restitution=[1.0, 0.0]),
    ]
    ends = (ri.Absorbing(), ri.Free())
    system = ri.System(bodies, contacts=laws, ends=ends)

    messages = problems(system.reversed)

    assert list(messages) == [
        "bodies.1.material.viscosity",
        "bodies.2.segments.1.material.viscosity",
        "contacts.0.damping",
        "contacts.1.damping",
        "contacts.3.restitution",
        "ends.left",
    ]


def test_no_film_runs_backwards_where_a_contact_yields():
    """`reversed` refuses a system with a yielding contact, by its path."""
    law = ri.Yielding(stiffness=1.0, yield_force=1.0)
    system = ri.System([rod(), rod()], contacts=[law])
    messages = problems(system.reversed)
    assert list(messages) == ["contacts.0"]


def test_a_film_runs_backwards_where_dampings_are_0():
    """A row whose dampings are 0 is reversed: it has the same contacts and the opposite
    velocities.
    """
    laws = [
        ri.SpringDashpot(stiffness=1.0, damping=0.0),
        ri.HuntCrossley(stiffness=1.0, damping=0.0),
    ]
    system = ri.System([rod(velocity=1.0), rod(), rod()], contacts=laws)

    back = system.reversed()

    assert back.contacts == system.contacts
    assert velocities_of(back) == [-1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "drive", [ri.Pushed(0.0), ri.Moved(0.0), ri.Incoming(0.0)], ids=repr
)
def test_no_film_runs_backwards_where_an_end_is_driven(drive):
    system = ri.System([rod()], ends=(ri.Free(), drive))
    messages = problems(system.reversed)
    assert list(messages) == ["ends.right"]


def test_the_repr_of_a_rod_has_its_numbers_and_the_name_of_its_material():
    text = "Rod(length=1.0, area=0.0001, material=steel, velocity=0.0, strain=0.0)"
    assert repr(rod()) == text


@pytest.mark.parametrize(
    ("length", "profile", "mirrored_values"),
    [
        pytest.param(
            1000.0,
            ri.Steps([1.0, 2.0, 3.0], [0.1, np.nextafter(0.1, 1)]),
            (-3.0, -1.0),
            id="inside",
        ),
        pytest.param(1.0, ri.Steps([1.0, 2.0], [1e-17]), (-2.0,), id="at the end"),
    ],
)
def test_a_mirror_drops_steps_that_lose_their_width(length, profile, mirrored_values):
    """Their places, as distances from the other end, are equal or that end itself."""
    system = ri.System([rod(length=length, velocity=profile)])
    image = system.mirrored()
    assert image.bodies[0].velocity.values == mirrored_values


def test_a_loss_factor_is_a_viscosity_at_its_frequency():
    """A material with the loss factor eta at f has the viscosity eta E/(2 pi f)."""
    loss_factor = 0.02
    frequency = 1e3  # Hz
    damped = steel.damped(loss_factor, frequency)
    viscosity = loss_factor * damped.youngs_modulus / (2 * np.pi * frequency)
    assert damped.viscosity == pytest.approx(viscosity)


def test_damping_replaces_that_of_before():
    damped = steel.damped(loss_factor=0.02, frequency=1e3)
    undamped = damped.damped(loss_factor=0.0, frequency=5.0)
    assert undamped == steel


def test_loss_factors_make_a_family():
    damped = steel.damped(loss_factor=0.02, frequency=1e3)
    family = steel.damped(loss_factor=[0.01, 0.02], frequency=1e3)
    assert family.viscosity[1] == damped.viscosity


def tapered_segment():
    """A segment of 0.5 m whose area grows from 1e-4 m^2 by 1 m^2 for each metre."""
    return ri.Segment(0.5, lambda x: 1e-4 + x, steel)


def test_a_taper_runs_from_end_to_end_of_its_segment():
    """A tapered segment of 0.5 m has the areas of its function at both ends, and the
    wave speed and transit time of a uniform one.
    """
    tapered = tapered_segment()
    areas = tapered.area.values
    assert areas[0] == 1e-4
    assert areas[-1] == 0.5001
    assert tapered.wave_speed == steel.wave_speed
    assert tapered.transit_time == 0.5 / steel.wave_speed


def test_what_is_tapered_says_so():
    """`tapered` is true for a tapered segment and for a rod with one, and false for a
    uniform segment and rod.
    """
    tapered = tapered_segment()
    uniform = ri.Segment(0.5, 1e-4, steel)
    rod_of_both = ri.Rod(segments=[uniform, tapered])
    assert tapered.tapered
    assert not uniform.tapered
    assert not rod().tapered
    assert rod_of_both.tapered


def test_the_mass_of_a_taper_is_exact_for_straight_lines():
    """The mass of a segment with three areas is density times the sum of mean area
    times length of its two lines.
    """
    areas = ri.Samples([1.0, 2.0, 6.0])
    segment = ri.Segment(0.5, areas, steel)
    volume = (1.5 + 4.0) * 0.25  # mean areas of two lines, each 0.25 m long
    mass = steel.density * volume
    assert segment.mass == pytest.approx(mass, rel=1e-15)


def test_tapers_of_a_family_of_lengths_have_masses_in_proportion():
    lengths = np.array([1.0, 3.0])
    family = rod(length=lengths, area=ri.Samples([1e-4, 2e-4]))
    masses = steel.density * lengths * 1.5e-4  # of the mean area
    assert family.mass == pytest.approx(masses, rel=1e-15)


def test_the_mass_of_a_cone_is_nearly_that_of_the_curve_itself():
    """A cone is kept as samples of its area. Its mass is, to 1e-6, that of a frustum
    whose area grows from A to 4 A: density times length times (A + sqrt(A 4 A) + 4
    A)/3.
    """
    first_area = 1e-4
    length = 1.0
    volume = length * (1 + 2 + 4) * first_area / 3
    mass = steel.density * volume
    assert cone(length, first_area).mass == pytest.approx(mass, rel=1e-6)


def test_the_impedance_of_a_taper_is_no_single_number():
    """The impedance of a tapered segment raises ValueError, which recommends
    `in_steps`.
    """
    (segment,) = cone().segments
    message = r"varies along a tapered segment; .*rod.in_steps\(n\)"
    with pytest.raises(ValueError, match=message):
        segment.impedance  # noqa: B018


AREAS = st.lists(st.floats(1e-6, 1e-2), min_size=2, max_size=20)
LENGTHS = st.floats(0.01, 10)
CUTS = st.lists(st.floats(0.001, 0.999), max_size=6, unique=True)


@given(AREAS, LENGTHS, CUTS)
def test_areas_between_places_hold_the_volume(areas, length, cuts):
    """Mean areas of a random taper between edges hold the mass of the segment, and lie
    between its smallest and largest area.
    """
    segment = ri.Segment(length, ri.Samples(areas), steel)
    edges = np.array([0.0, *sorted(cuts), 1.0]) * length

    mean_areas = segment.area_between(edges)

    volume = np.sum(mean_areas * np.diff(edges))
    mass = volume * steel.density
    smallest = min(areas)
    largest = max(areas)
    assert mass == pytest.approx(segment.mass, rel=1e-12)
    assert np.all(mean_areas > smallest * (1 - 1e-6))
    assert np.all(mean_areas < largest * (1 + 1e-6))


@given(AREAS, st.integers(1, 50))
def test_a_taper_in_steps_keeps_mass_length_state_and_uniform_segments(areas, n):
    """A tapered segment becomes n uniform ones with its mean areas; mass, length,
    velocity, strain, polar moment and the uniform segment behind it stay.
    """
    tapered = ri.Segment(1.0, ri.Samples(areas), steel, **ROUND_LOVE)
    uniform = ri.Segment(0.5, 1e-4, glass)
    rod_of_both = ri.Rod(
        segments=[tapered, uniform],
        velocity=ri.Steps([1.0, 2.0], [0.25]),
        strain=lambda x: x,
    )

    stepped = rod_of_both.in_steps(n)

    *steps, last = stepped.segments
    polar_moments = {step.polar_moment for step in steps}
    (first_area,) = tapered.area_between([0.0, 1 / n])
    assert len(steps) == n
    assert last == uniform
    assert not stepped.tapered
    assert polar_moments == {"circular"}
    assert steps[0].area == pytest.approx(first_area)
    assert stepped.mass == pytest.approx(rod_of_both.mass, rel=1e-13)
    assert stepped.length == pytest.approx(1.0 + 0.5, rel=1e-14)
    assert stepped.velocity == rod_of_both.velocity
    assert stepped.strain == rod_of_both.strain


def test_members_of_a_family_of_stepped_tapers_are_those_alone():
    """A taper of two lengths, cut into steps, is a family of two; its second member is
    that made alone.
    """
    taper = ri.Samples([1e-4, 3e-4])
    lengths = np.array([1.0, 3.0])
    stepped = rod(length=lengths, area=taper).in_steps(2)
    second_alone = rod(length=3.0, area=taper).in_steps(2)
    family = ri.System([stepped])
    assert family.shape == (2,)
    assert family[1] == ri.System([second_alone])


def test_a_uniform_rod_in_steps_is_itself():
    uniform = rod(velocity=1.0)
    assert uniform.in_steps(7) == uniform


def test_an_area_of_a_single_step_makes_a_uniform_rod():
    area = ri.Steps([1e-4], [])
    assert rod(area=area) == rod(area=1e-4)


def test_steps_of_the_area_make_a_stepped_rod():
    """Three areas with steps at 0.25 and 0.5 m make segments of 0.25, 0.25 and 0.5 m
    with these areas; x of the velocity runs along the whole rod, not each segment.
    """
    area = ri.Steps([1e-4, 2e-4, 3e-4], [0.25, 0.5])
    stepped = rod(area=area, velocity=lambda x: x)
    sizes = [(segment.length, segment.area) for segment in stepped.segments]
    assert sizes == [(0.25, 1e-4), (0.25, 2e-4), (0.5, 3e-4)]
    assert stepped.velocity.values[-1] == 1.0  # at its end, x = 1 m


def test_lengths_between_steps_are_differences_of_decimals():
    """Steps at 0.1 and 0.3 m make a segment of 0.2 m, although the floats 0.3 and 0.1
    differ by 0.19999999999999998.
    """
    area = ri.Steps([1e-4, 2e-4, 3e-4], [0.1, 0.3])
    stepped = rod(length=0.4, area=area)
    lengths = [segment.length for segment in stepped.segments]
    assert lengths == [0.1, 0.2, 0.1]


def test_lengths_between_steps_of_a_family_are_differences_of_decimals():
    """A rod with three areas and two lengths has segments with the decimal lengths 0.2,
    and 0.1 and 0.4, without round-off.
    """
    area = ri.Steps([1e-4, 2e-4, 3e-4], [0.1, 0.3])
    ends = np.array([0.4, 0.7])
    stepped = rod(length=ends, area=area)
    _, middle, last = stepped.segments
    assert middle.length == 0.2
    assert last.length.tolist() == [0.1, 0.4]


def test_each_step_of_a_round_rod_is_round():
    """Both segments of a rod with two areas keep its circular polar moment."""
    area = ri.Steps([1e-4, 2e-4], [0.25])
    stepped = rod(area=area, **ROUND_LOVE)
    polar_moments = [segment.polar_moment for segment in stepped.segments]
    assert polar_moments == ["circular", "circular"]


def test_areas_of_steps_make_families():
    """Two values for the second area of a stepped rod are a family over the area of its
    segment 1.
    """
    second_areas = np.array([1.0, 2.0])
    area = ri.Steps([1e-4, second_areas], [0.25])
    family = ri.System([rod(area=area)])
    assert list(family.parameters) == ["bodies.0.segments.1.area"]


def test_places_of_steps_make_families():
    """A step of the area at 0.25 and 0.5 m makes a family of two rods, each of two
    segments.
    """
    places = np.array([0.25, 0.5])
    area = ri.Steps([1e-4, 2e-4], [places])
    first, second = rod(area=area).segments
    assert first.length.tolist() == [0.25, 0.5]
    assert second.length.tolist() == [0.75, 0.5]


def test_the_polar_moment_of_a_disc_is_that_of_its_radius():
    radius = 0.01
    area = np.pi * radius**2
    disc = ri.Segment(1.0, area, steel, **ROUND_LOVE)
    moment = np.pi * radius**4 / 2
    assert disc.polar_moments(area) == pytest.approx(moment, rel=1e-15)


def test_a_tube_has_the_polar_moment_that_was_given_and_a_bar_none():
    areas = [1e-4, 2e-4]
    tube = ri.Segment(1.0, 1e-4, steel, polar_moment=3e-8, **LOVE)
    bar = ri.Segment(1.0, 1e-4, steel)
    assert tube.polar_moments(areas).tolist() == [3e-8, 3e-8]
    assert bar.polar_moments(areas).tolist() == [0.0, 0.0]


def test_polar_moments_of_a_round_taper_are_those_of_discs():
    areas = np.array([1.0, 2.0])
    tapered = ri.Segment(1.0, ri.Samples(areas), steel, **ROUND_LOVE)
    moments = areas**2 / (2 * np.pi)
    assert tapered.polar_moments(areas) == pytest.approx(moments, rel=1e-15)


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_a_word_and_a_diameter_are_enough_for_lateral_inertia(word):
    """A rod with a diameter and a word for lateral inertia has the polar moment of a
    round section, and is not ideal.
    """
    radius = 0.01
    area = math.pi * radius**2
    thick = rod(area=None, diameter=2 * radius, lateral_inertia=word)
    round_rod = rod(area=area, polar_moment="circular", lateral_inertia=word)
    (segment,) = thick.segments
    (round_segment,) = round_rod.segments
    assert thick == thick.replace(polar_moment="circular")
    assert segment.polar_moments([1.0]) == round_segment.polar_moments([1.0])
    assert not segment.ideal


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_a_rod_with_lateral_inertia_survives_its_description(word):
    thick = rod(area=None, diameter=0.02, lateral_inertia=word)
    system = ri.System([thick])
    restored = ri.System.from_dict(system.to_dict())
    assert restored.bodies == (thick,)


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_lateral_inertia_can_be_taken_away(word):
    """A rod whose lateral inertia is replaced by None is equal to one without."""
    thick = rod(area=None, diameter=0.02, lateral_inertia=word)
    bar = thick.replace(lateral_inertia=None)
    (segment,) = bar.segments
    assert bar == rod(area=None, diameter=0.02)
    assert segment.ideal


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_segments_have_the_lateral_inertia_of_their_rod(word):
    """The only segment of a rod has its lateral inertia and its polar moment."""
    tube = rod(polar_moment=2e-8, lateral_inertia=word)
    (segment,) = tube.segments
    assert segment.polar_moment == 2e-8
    assert segment.lateral_inertia == word


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_steps_of_a_rod_with_lateral_inertia_differ_in_their_sizes_only(word):
    """A rod with two areas and lateral inertia has two segments, which differ only by
    length and area.
    """
    area = ri.Steps([1e-4, 2e-4], [0.25])
    stepped = rod(area=area, polar_moment="circular", lateral_inertia=word)
    first, second = stepped.segments
    assert second == first.replace(length=0.75, area=2e-4)


def test_every_field_of_a_section_counts_for_equality_and_digest():
    """Eight rods that differ in one field are different and have different digests."""
    rods = [
        rod(),
        rod(area=ri.Samples([1e-4, 1e-4])),
        rod(area=ri.Samples([1e-4, 2e-4])),
        rod(polar_moment=1e-8, **LOVE),
        rod(polar_moment=2e-8, **LOVE),
        rod(**ROUND_LOVE),
        rod(area=None, diameter=0.01),
        rod(**ROUND_MINDLIN_HERRMANN),
    ]
    different_rods = set(rods)
    digests = {body.digest for body in rods}
    assert len(different_rods) == len(rods)
    assert len(digests) == len(rods)
    assert rod(**ROUND_LOVE) == rod(**ROUND_LOVE)


def test_the_description_of_a_bar_has_nothing_of_lateral_inertia():
    (segment,) = rod().segments
    assert set(segment.to_dict()) == {"length", "area", "material"}


def test_a_taper_is_for_a_grid_and_in_steps_for_fronts():
    """The method that is chosen for a cone is the grid, and fronts for the cone in
    steps.
    """
    tapered = cone(velocity=1.0)
    options = Options()
    of_taper = ri.System([tapered, rod()])
    of_steps = ri.System([tapered.in_steps(4), rod()])

    assert options.method_for(of_taper) == "finite-difference"
    assert options.method_for(of_steps) == "fronts"
    outcome = ri.solve(of_steps).outcome
    assert outcome.momentum_residual == pytest.approx(0, abs=1e-12)


OF_EACH_CLASS = [
    steel,
    ri.Segment(0.4, 1e-4, steel, **ROUND_LOVE),
    ri.Segment(0.4, ri.Samples([1e-4, 2e-4]), steel),
    ri.Segment(0.4, material=steel, diameter=0.01, **MINDLIN_HERRMANN),
    rod(velocity=ri.Steps([1.0, 0.0], [0.1])),
    ri.Rod(segments=[SEGMENT, SEGMENT], strain=1e-4),
    ri.RigidMass(2.0, velocity=1.0),
    ri.Wall(0.5),
    ri.Steps([1.0, 2.0], [0.1]),
    ri.Samples([1.0, 2.0], step=0.1),
    ri.Rigid(0.5),
    ri.Bonded(),
    ri.Spring(1e6),
    ri.SpringDashpot(1e6, 2.0),
    ri.Hertz(1e9),
    ri.HuntCrossley(1e9, 0.1),
    ri.PowerLaw(1e9, 2.0),
    ri.Yielding(1e9, 1e3, 1e7),
    ri.Free(),
    ri.Fixed(),
    ri.Absorbing(),
    ri.Pushed(1e3),
    ri.Moved(1.0),
    ri.Incoming(1e-3),
    ri.System([rod(), ri.Wall()], [1e-3], gravity=1.0),
]


def numbers_of(instance):
    """The fields of an object that are numbers, by name."""
    described = instance.to_dict().items()
    numbers = {name: value for name, value in described if isinstance(value, float)}
    return {name: numbers[name] for name in instance.fields if name in numbers}


@pytest.mark.parametrize(
    "instance", OF_EACH_CLASS, ids=lambda instance: type(instance).__name__
)
def test_replace_changes_the_number_that_it_is_told_and_nothing_else(instance):
    """Each number of an object is halved by `replace` and set back: the object is equal
    to the first.
    """
    assert instance.replace() == instance
    for name, value in numbers_of(instance).items():
        half = value / 2
        changed = instance.replace(**{name: half})
        restored = changed.replace(**{name: value})
        assert getattr(changed, name) == half
        assert restored == instance


@pytest.mark.parametrize(
    "instance", OF_EACH_CLASS, ids=lambda instance: type(instance).__name__
)
def test_replace_refuses_names_of_no_parameter(instance):
    message = f"colour: is no parameter of {type(instance).__name__}"
    with pytest.raises(ri.InvalidModel, match=message):
        instance.replace(colour="red")


def test_replace_names_the_nearest_parameter():
    message = "lenght: is no parameter of Rod; perhaps 'length'"
    with pytest.raises(ri.InvalidModel, match=message):
        rod().replace(lenght=1.0)


def test_replace_checks_values():
    spring = ri.Spring(1.0)
    message = "stiffness: must be a finite positive number of N/m"
    with pytest.raises(ri.InvalidModel, match=message):
        spring.replace(stiffness=-1.0)


@pytest.mark.parametrize("kind", [ri.Rod, ri.Segment])
def test_a_diameter_is_that_of_a_round_section(kind):
    """Two diameters give the masses of the round areas; the description has the
    diameters and no area.
    """
    diameter = np.array([0.01, 0.02])
    area = math.pi * diameter * diameter / 4
    by_diameter = kind(0.4, material=steel, diameter=diameter)
    by_area = kind(0.4, area=area, material=steel)
    assert by_diameter.mass.tolist() == by_area.mass.tolist()
    described = by_diameter.to_dict()
    assert described["diameter"] == diameter.tolist()
    assert "area" not in described
