import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mistakes import assert_told, problems

import rodimpact as ri
from rodimpact.materials import glass, steel
from rodimpact.methods.registry import Options

LOVE = {"lateral_inertia": "rayleigh-love"}


def rod(**changes):
    fields = {"length": 1.0, "area": 1e-4, "material": steel, **changes}
    return ri.Rod(**fields)


def cone(length=1.0, start=1e-4, **changes):
    return rod(length=length, area=lambda x: start * (1 + x / length) ** 2, **changes)


def material(E=1.0, rho=1.0, **more):
    return ri.Material("m", youngs_modulus=E, density=rho, **more)


BAD_NUMBERS = [0.0, -1.0, float("nan"), float("inf"), True, "1 m", None, 1j, [], {}]


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize("field", ["length", "area"])
def test_sizes_must_be_positive_numbers(field, value):
    [(path, message)] = problems(lambda: rod(**{field: value})).items()
    assert path == field
    assert (
        "must" in message
        or message == "is missing; give it, or the diameter of a round rod"
    )


MASS = ri.RigidMass(2.0, velocity=-1.0)
PIECE = ri.Segment(1.0, 1.0, steel)
WALL = ri.Wall()
NAN = float("nan")
TOO_MUCH = "must be 0 or of a magnitude from 1e-150 to 1e+150 in consistent units, got "
UNDECIDED = (
    "no wave decides this contact: give Rigid(restitution=...) or a compliant law such as "
    "Hertz"
)
NO_WORD = 'give lateral_inertia="rayleigh-love" too, or'
MINDLIN = {"polar_moment": "circular", "lateral_inertia": "mindlin-herrmann"}


def row(*bodies, **more):
    return ri.System(bodies, **more)


class MyLaw(ri.Hertz):
    pass


MISTAKES = [  # a call; by paths, what the messages bear, which ends them after an equals sign
    (
        lambda: rod(length=-1.0, area=NAN, velocity="x"),
        {"length": "must be", "area": "must be", "velocity": "must be"},
    ),
    (
        lambda: rod(length=np.ones((1,) * 33)),
        {"length": "=must have at most 32 axes, got 33"},
    ),
    (lambda: material(1e300, 1e-300), {"youngs_modulus": "", "density": ""}),
    (lambda: material(1e-300, 1e300), {"youngs_modulus": "", "density": ""}),
    (lambda: rod(area=1e140, material=material(1e100, 1e100)), {"area": "impedance"}),
    (lambda: rod(length=1e100, material=material(1e130, 1e140)), {"area": "impedance"}),
    (
        lambda: rod(length=[1.0, 1e-149], material=material(1e20, 1e10)),
        {"area[1]": "impedance"},
    ),
    (lambda: rod(area=1e-320), {"area": f"={TOO_MUCH}1e-320"}),
    (lambda: rod(area=[1e-4, 1e308]), {"area[1]": f"={TOO_MUCH}1e+308"}),
    (lambda: rod(velocity=-5e-324), {"velocity": f"={TOO_MUCH}-5e-324"}),
    (lambda: ri.Samples([0.0, -1e200]), {"values[1]": f"={TOO_MUCH}-1e+200"}),
    (lambda: ri.Options(until=1e308), {"until": f"={TOO_MUCH}1e+308"}),
    *(
        (lambda nu=nu: material(poisson_ratio=nu), {"poisson_ratio": "must"})
        for nu in (-1.0, 0.51, NAN, "0.3")
    ),
    # Segments and their profiles
    (lambda: ri.Rod(1.0, segments=[PIECE]), {"segments": ""}),
    (
        lambda: ri.Rod(segments=[PIECE], polar_moment="circular"),
        {"segments": "polar_moment"},
    ),
    (lambda: ri.Rod(segments=[]), {"segments": ""}),
    (lambda: ri.Rod(segments=[PIECE, "x"]), {"segments.1": ""}),
    (lambda: ri.Steps([1.0], [0.5]), {"values": ""}),
    (lambda: ri.Steps([1.0, 2.0, 3.0], [0.5, 0.5]), {"at.1": ""}),
    (lambda: ri.Steps(1.0, []), {"values": ""}),
    (lambda: ri.Steps([1.0, "2"], [0.5]), {"values.1": ""}),
    (lambda: rod(velocity=ri.Steps([1.0, 2.0], [1.0])), {"velocity.at.0": ""}),
    # Rows
    (lambda: row(), {"bodies": ""}),
    *(
        (
            lambda bodies=bodies, laws=laws: row(*bodies, contacts=laws),
            {"bodies": "=needs a rod or a rigid mass that is not bonded to a wall"},
        )
        for bodies, laws in (
            ([WALL, WALL], [ri.Rigid()]),
            ([WALL, MASS], [ri.Bonded()]),
            ([WALL, MASS, MASS, WALL], [ri.Bonded(), ri.Spring(1.0), ri.Bonded()]),
        )
    ),
    (lambda: row(rod(), WALL, rod()), {"bodies.1": ""}),
    (lambda: row(rod(), "rod"), {"bodies.1": ""}),
    (lambda: row(rod(), rod(), gaps=[-1e-9]), {"gaps.0": ""}),
    (lambda: row(rod(), rod(), gaps=[0.0, 0.0]), {"gaps": ""}),
    (lambda: row(rod(), rod(), gaps=0.0), {"gaps": ""}),
    (lambda: row(rod(), rod(), contacts=["rigid"]), {"contacts.0": ""}),
    (lambda: row(rod(), rod(), gaps=[1.0], contacts=[ri.Bonded()]), {"gaps.0": ""}),
    (
        lambda: row(rod(), WALL, rod(), gaps=[-1.0, NAN], contacts=[None, None]),
        dict.fromkeys(("bodies.1", "gaps.0", "contacts.0", "gaps.1", "contacts.1"), ""),
    ),
    (
        lambda: row(rod(), "mass", MASS, contacts=[ri.Rigid(1.0), ri.Rigid()]),
        {"bodies.1": ""},
    ),
    (
        lambda: row(rod(), rod(), contacts=[MyLaw(1e9)]),
        {
            "contacts.0": "must be a contact law itself, one of Rigid, Bonded, Joint, Spring"
        },
    ),
    (
        lambda: row(
            MASS,
            ri.RigidMass(2.0, velocity=[-1.0, 2.0]),
            rod(),
            contacts=[ri.Bonded()] * 2,
        ),
        {
            "bodies.1.velocity[1]": "=must be -1.0, that of the rigid body it is bonded to, got 2.0"
        },
    ),
    *(
        (
            lambda end=end, laws=laws: row(rod(), MASS, end, contacts=laws),
            {"contacts.1": UNDECIDED},
        )
        for end in (MASS, WALL)
        for laws in (None, [ri.Rigid(), ri.Rigid()])
    ),
    *(
        (
            lambda end=end: row(rod(), end, contacts=[ri.Rigid(1.0)]),
            {"contacts.0.restitution": "waves of a rod decide"},
        )
        for end in (rod(), WALL, MASS)
    ),
    # Damping
    (lambda: steel.damped(-0.1, 0.0), {"loss_factor": "", "frequency": ""}),
    (lambda: steel.damped(NAN, 1.0), {"loss_factor": ""}),
    (lambda: steel.damped(0.1, "1 kHz"), {"frequency": ""}),
    (lambda: steel.damped(0.1, [1.0, -1.0]), {"frequency[1]": ""}),
    (lambda: steel.damped(1e100, 1e-100), {"viscosity": ""}),
    # Tapers
    *(
        (
            lambda n=n: cone().in_steps(n),
            {"n": f"whole number from 1 to 100000, got {n!r}"},
        )
        for n in (0, 100001, 2.0, True, "3", None)
    ),
    *(
        (lambda make=make, area=area: make(area=area), {path: said})
        for make in (rod, lambda area: ri.Segment(1.0, area, steel))
        for area, path, said in (
            (
                ri.Samples([1.0, 2.0, -3.0]),
                "area.values[2]",
                "positive number of square metres, got -3.0",
            ),
            (
                lambda x: 0.5 - x,
                "area",
                "function that returns positive numbers, got 0.0 at 0.5",
            ),
            (lambda x: x / 0.0, "area", "cannot be evaluated: ZeroDivisionError"),
            (
                ri.Samples([1.0, 2.0], step=0.1),
                "area.step",
                "from end to end; leave it out",
            ),
            (ri.Samples([1e149, 1.0]), "area", "area 1e+149"),
        )
    ),
    (
        lambda: rod(length=[1.0, 2.0], area=lambda x: 1 + x),
        {"area": "differ in length; give Samples"},
    ),
    (lambda: rod(length=-1.0, area=lambda x: -x), {"length": ""}),
    (
        lambda: rod(
            area=ri.Steps([1.0, -2.0, [1.0, 0.0]], [0.25, 0.5]),
            material=7,
            polar_moment="square",
            velocity="x",
            **LOVE,
        ),
        dict.fromkeys(
            (
                "polar_moment",
                "material",
                "area.values.1",
                "area.values.2[1]",
                "velocity",
            ),
            "",
        ),
    ),
    (lambda: rod(length="x", area=ri.Steps([1.0, -2.0], [3.0])), {"length": ""}),
    (
        lambda: rod(area=ri.Steps([1.0, 2.0], [1.0])),
        {"area.at.0": "inside the rod of length 1.0, got 1.0"},
    ),
    (
        lambda: ri.Segment(1.0, ri.Steps([1.0, 2.0], [0.5]), steel),
        {"area": "Rod(area=Steps(...))"},
    ),
    # Sections and lateral inertia
    *(
        (lambda kind=kind, sizes=sizes: kind(0.4, material=steel, **sizes), {path: ""})
        for kind in (ri.Rod, ri.Segment)
        for sizes, path in (
            ({"diameter": -1.0}, "diameter"),
            ({}, "area"),
            ({"diameter": 0.1, "area": 1.0}, "diameter"),
        )
    ),
    (
        lambda: cone(polar_moment=1e-8, **LOVE),
        {
            "polar_moment": 'must be "circular" along a taper and with a diameter, or left out, got'
        },
    ),
    (
        lambda: rod(lateral_inertia="mindlin-herrmann"),
        {
            "lateral_inertia": "needs the diameter of a round rod, or a polar_moment; "
            "give one of them"
        },
    ),
    (
        lambda: rod(polar_moment="circular", lateral_inertia="mindlin"),
        {"lateral_inertia": "perhaps 'mindlin-herrmann' is meant"},
    ),
    (lambda: rod(polar_moment="circular"), {"polar_moment": NO_WORD}),
    (
        lambda: rod(polar_moment="circular", area=None, diameter=0.02),
        {"polar_moment": NO_WORD},
    ),
    (
        lambda: rod(material=steel.replace(poisson_ratio=0.5), **MINDLIN),
        {"material.poisson_ratio": 'must be below 0.5 for "mindlin-herrmann", got 0.5'},
    ),
    (
        lambda: rod(material=ri.materials.oak, **MINDLIN),
        {"material.poisson_ratio": "is missing in 'oak'; lateral inertia needs it"},
    ),
]


@pytest.mark.parametrize(("make", "wanted"), MISTAKES)
def test_mistakes_are_refused_all_at_once_and_by_their_paths(make, wanted):
    assert_told(make, wanted)


@pytest.mark.parametrize(
    "make",
    [
        lambda: rod(length=np.ones(4000), area=np.ones((4000, 1))),
        lambda: row(rod(velocity=np.ones(10**4)), ri.RigidMass(np.ones((1001, 1)))),
    ],
)
def test_families_of_too_many_members_are_refused_before_they_are_laid_out(make):
    assert "members, more than 10000000; take one part after another" in str(
        problems(make)
    )


@pytest.mark.parametrize("pair", [[MASS, MASS], [MASS, WALL]])
@pytest.mark.parametrize(
    "law", [ri.Rigid(0.0), ri.Rigid([0.5, 1.0]), ri.Hertz(1.0), ri.Spring(1.0)]
)
def test_between_rigid_bodies_a_law_decides(pair, law):
    assert row(rod(), *pair, contacts=[ri.Rigid(), law]).contacts[1] == law


def test_derived_quantities():
    segment = ri.Segment(0.5, 2e-4, material(16.0, 4.0))
    assert (segment.wave_speed, segment.transit_time) == (2.0, 0.25)
    assert segment.impedance == pytest.approx(4.0 * 2e-4 * 2.0)
    assert segment.mass == pytest.approx(4.0 * 2e-4 * 0.5)


def test_without_gravity_nothing_is_said_of_it():
    assert (
        ri.System([rod()], gravity=0)
        == ri.System([rod()], gravity=-0.0)
        == ri.System([rod()])
    )
    assert set(ri.System([rod()]).to_dict()) == {"bodies", "contacts"}
    falling = ri.System([rod(), ri.Wall()], gravity=9.81)
    assert falling.to_dict()["gravity"] == 9.81
    assert falling.digest != ri.System([rod(), ri.Wall()]).digest


def test_descriptions_of_plain_rows_stay_as_they_were():
    """Digests name files and sweeps on disk."""
    row = ri.System(
        [rod(velocity=1.0), rod(), ri.Wall()], [0.0, 1e-5], [ri.Bonded(), ri.Rigid()]
    )
    assert row.to_dict()["contacts"] == [
        {"gap": 0.0, "law": "bonded"},
        {"gap": 1e-5, "law": "rigid"},
    ]
    assert (
        row.digest == "51c200387baca463a5a1708cea88cf999560e2752560410e72916cb4cb4c1414"
    )
    family = ri.System([rod(length=np.array([1.0, 2.0])), ri.Wall()])
    assert (
        family.digest
        == "b30b44bb2ada05120df8008049d58f1df3d1f6c184bce26c2f475d60d4942001"
    )


def test_equal_objects_have_equal_digests_whatever_the_sign_of_zero():
    assert ri.Wall(-0.0) == ri.Wall(0.0)
    assert hash(ri.Wall(-0.0)) == hash(ri.Wall(0.0))
    row = ri.System([rod(), ri.Wall()], gravity=[1.0, 0.0])
    again = row.mirrored().mirrored()
    assert (again, again.digest) == (row, row.digest)


def test_numbers_of_every_kind_make_families_by_their_paths():
    two = np.array([1.0, 2.0])
    three = np.array([[1.0], [2.0], [3.0]])
    row = ri.System(
        [
            ri.Wall(),
            ri.RigidMass(two, velocity=three),
            ri.RigidMass(1.0),
            rod(),
            rod(),
            MASS,
        ],
        gaps=[0.0, two, 0.0, 0.0, 0.0],
        contacts=[
            ri.Rigid(two / 2),
            ri.SpringDashpot(three, two),
            ri.Hertz(two),
            ri.HuntCrossley(two, three),
            ri.Spring(three),
        ],
        gravity=two,
        ends=(ri.Free(), ri.Pushed(three)),
    )
    assert row.shape == (3, 2)
    assert set(row.parameters) == {
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
    assert ri.System.from_dict(row.to_dict()) == row
    member = row[2, 1]
    assert member.shape == ()
    assert member.bodies[1] == ri.RigidMass(2.0, velocity=3.0)
    assert member.contacts[1] == ri.SpringDashpot(3.0, 2.0)
    assert (member.gravity, member.ends[1]) == (2.0, ri.Pushed(3.0))
    assert row[:, 0].shape == (3,)
    assert row[1:].parameters["gravity"].shape == (1, 2)  # along what it varies alone


def test_objects_are_frozen_and_compare_by_value():
    one = rod()
    with pytest.raises(AttributeError, match="frozen"):
        one.velocity = 2.0
    with pytest.raises(AttributeError, match="frozen"):
        del one.velocity
    assert one == rod()
    assert hash(one) == hash(rod())
    assert one != rod(velocity=1.0)
    assert one != "rod"
    assert len({rod(), rod(), ri.Wall()}) == 2


HERTZ = ri.Hertz(1e9)


@pytest.mark.parametrize(
    "system",
    [
        row(
            ri.Wall(1.0),
            rod(velocity=ri.Steps([1.0, 0.0], [0.25]), strain=1e-4),
            ri.Rod(
                segments=[ri.Segment(0.2, 1e-4, steel), ri.Segment(0.3, 2e-4, glass)]
            ),
            gaps=[0.0, 1e-5],
            contacts=[ri.Bonded(), ri.Rigid()],
        ),
        row(
            WALL,
            MASS,
            MASS,
            rod(),
            MASS,
            rod(),
            MASS,
            contacts=[HERTZ, HERTZ, *[ri.Rigid()] * 4],
        ),
        row(MASS, MASS, contacts=[HERTZ]),
        row(rod(), WALL, gravity=9.81),
        row(
            rod(
                length=np.array([0.1, 0.2, 0.3])[:, None], velocity=np.array([1.0, 2.0])
            ),
            WALL,
        ),
    ],
)
def test_a_system_survives_its_description(system):
    again = ri.System.from_dict(system.to_dict())
    assert again == system
    assert again.digest == system.digest


def test_a_mirror_turns_gravity_and_drives():
    push = ri.Pushed(ri.Steps([1.0, 2.0], [1e-3]))
    pull = ri.Moved(ri.Samples([1.0, 2.0], step=1e-3))
    row = ri.System(
        [rod(velocity=1.0), MASS, rod()],
        [0.0, 0.5],
        [ri.Rigid(), ri.Hertz(1.0)],
        gravity=9.81,
        ends=(push, pull),
    )
    image = row.mirrored()
    assert image.gravity == -9.81
    assert image.ends == (ri.Moved(ri.Samples([-1.0, -2.0], step=1e-3)), push)
    assert image.bodies[1] == ri.RigidMass(2.0, velocity=1.0)
    assert image.contacts == (ri.Hertz(1.0), ri.Rigid())
    assert image.mirrored() == row


def test_gravity_and_held_ends_stay_when_time_is_turned_round():
    row = ri.System(
        [rod(velocity=1.0), MASS, ri.Wall(1.0)],
        contacts=[ri.Hertz(1.0), ri.Rigid(1)],
        gravity=9.81,
        ends=(ri.Fixed(), ri.Free()),
    )
    back = row.reversed()
    assert (back.gravity, back.ends) == (9.81, row.ends)
    assert [body.velocity for body in back.bodies] == [-1.0, 1.0, -1.0]
    assert back.reversed() == row


def test_no_film_runs_backwards_where_something_is_lost_or_driven():
    sticky = ri.Material("s", youngs_modulus=1e9, density=1e3, viscosity=1.0)
    pieces = [ri.Segment(1.0, 1e-4, steel), ri.Segment(1.0, 1e-4, sticky)]
    row = ri.System(
        [rod(), rod(material=sticky), ri.Rod(segments=pieces), MASS, ri.Wall()],
        contacts=[
            ri.SpringDashpot(1.0, 1.0),
            ri.HuntCrossley(1.0, [0.0, 1.0]),
            ri.Spring(1.0),
            ri.Rigid([1.0, 0.0]),
        ],
        ends=(ri.Absorbing(), ri.Free()),
    )
    found = problems(row.reversed)
    assert list(found) == [
        "bodies.1.material.viscosity",
        "bodies.2.segments.1.material.viscosity",
        "contacts.0.damping",
        "contacts.1.damping",
        "contacts.3.restitution",
        "ends.left",
    ]
    for end in (ri.Pushed(0.0), ri.Moved(0.0), ri.Incoming(0.0)):
        found = problems(ri.System([rod()], ends=(ri.Free(), end)).reversed)
        assert list(found) == ["ends.right"]
    found = problems(
        ri.System([rod(), rod()], contacts=[ri.Yielding(1.0, 1.0)]).reversed
    )
    assert list(found) == ["contacts.0"]
    calm = [ri.SpringDashpot(1.0, 0.0), ri.HuntCrossley(1.0, 0.0)]
    ri.System([rod(), rod(), rod()], contacts=calm).reversed()


def test_repr_can_be_read():
    assert (
        repr(rod())
        == "Rod(length=1.0, area=0.0001, material=steel, velocity=0.0, strain=0.0)"
    )


def test_a_mirror_drops_pieces_that_lose_their_width():
    profile = ri.Steps([1.0, 2.0, 3.0], [0.1, np.nextafter(0.1, 1)])
    mirrored = rod(length=1000.0, velocity=profile)
    image = ri.System([mirrored]).mirrored().bodies[0].velocity
    assert image.values == (-3.0, -1.0)
    edge = (
        ri.System([rod(velocity=ri.Steps([1.0, 2.0], [1e-17]))])
        .mirrored()
        .bodies[0]
        .velocity
    )
    assert edge.values == (-2.0,)


# Damping


def test_a_loss_factor_is_a_viscosity_at_its_frequency():
    damped = steel.damped(0.02, 1e3)
    assert damped.viscosity * 2 * np.pi * 1e3 / damped.youngs_modulus == pytest.approx(
        0.02
    )
    assert damped.damped(0.0, 5.0) == steel
    family = steel.damped([0.01, 0.02], 1e3)
    assert family.viscosity[1] == damped.viscosity


# Tapers


def test_a_taper_runs_from_end_to_end_of_its_segment():
    segment = ri.Segment(0.5, lambda x: 1e-4 + x, steel)
    assert segment.tapered
    assert (segment.area.values[0], segment.area.values[-1]) == (1e-4, 0.5001)
    assert (segment.wave_speed, segment.transit_time) == (
        steel.wave_speed,
        0.5 / steel.wave_speed,
    )
    assert not ri.Segment(0.5, 1e-4, steel).tapered
    assert not rod().tapered
    assert ri.Rod(segments=[ri.Segment(0.5, 1e-4, steel), segment]).tapered


def test_the_mass_of_a_taper_is_exact_for_straight_lines():
    segment = ri.Segment(0.5, ri.Samples([1.0, 2.0, 6.0]), steel)
    assert segment.mass == pytest.approx(7850 * (1.5 + 4.0) * 0.25, rel=1e-15)
    assert cone().mass == pytest.approx(
        7850 * 1e-4 * 7 / 3, rel=1e-6
    )  # of the cone itself
    family = rod(length=[1.0, 3.0], area=ri.Samples([1e-4, 2e-4]))
    assert family.mass == pytest.approx([7850 * 1.5e-4, 7850 * 4.5e-4], rel=1e-15)


def test_the_impedance_of_a_taper_is_no_single_number():
    with pytest.raises(
        ValueError, match=r"varies along a tapered segment; .*rod.in_steps\(n\)"
    ):
        cone().segments[0].impedance  # noqa: B018


AREAS = st.lists(st.floats(1e-6, 1e-2), min_size=2, max_size=20)


@given(
    AREAS,
    st.floats(0.01, 10),
    st.lists(st.floats(0.001, 0.999), max_size=6, unique=True),
)
def test_areas_between_places_hold_the_volume(areas, length, cuts):
    segment = ri.Segment(length, ri.Samples(areas), steel)
    edges = np.array([0.0, *sorted(cuts), 1.0]) * length
    between = segment.area_between(edges)
    volume = np.sum(between * np.diff(edges))
    assert volume * 7850 == pytest.approx(segment.mass, rel=1e-12)
    assert np.all(between > min(areas) * (1 - 1e-6))
    assert np.all(between < max(areas) * (1 + 1e-6))


@given(AREAS, st.integers(1, 50))
def test_steps_keep_the_mass_of_a_taper(areas, n):
    profile = ri.Steps([1.0, 2.0], [0.25])
    tapered = ri.Segment(1.0, ri.Samples(areas), steel, polar_moment="circular", **LOVE)
    whole = ri.Rod(
        segments=[tapered, ri.Segment(0.5, 1e-4, glass)],
        velocity=profile,
        strain=lambda x: x,
    )
    steps = whole.in_steps(n)
    assert len(steps.segments) == n + 1
    assert not steps.tapered
    assert steps.mass == pytest.approx(whole.mass, rel=1e-13)
    assert steps.length == pytest.approx(1.5, rel=1e-14)
    assert (steps.velocity, steps.strain) == (whole.velocity, whole.strain)
    assert steps.segments[-1] == whole.segments[-1]
    assert {s.polar_moment for s in steps.segments[:-1]} == {"circular"}
    assert steps.segments[0].area == pytest.approx(
        tapered.area_between([0.0, 1 / n])[0]
    )


def test_a_family_of_tapers_in_steps():
    assert rod(velocity=1.0).in_steps(7) == rod(velocity=1.0)
    family = rod(length=np.array([1.0, 3.0]), area=ri.Samples([1e-4, 3e-4]))
    row = ri.System([family.in_steps(2)])
    assert row.shape == (2,)
    assert row[1] == ri.System(
        [rod(length=3.0, area=ri.Samples([1e-4, 3e-4])).in_steps(2)]
    )


def test_steps_of_the_area_make_a_stepped_rod():
    stepped = rod(area=ri.Steps([1e-4, 2e-4, 3e-4], [0.25, 0.5]), velocity=lambda x: x)
    sizes = [(s.length, s.area) for s in stepped.segments]
    assert sizes == [(0.25, 1e-4), (0.25, 2e-4), (0.5, 3e-4)]
    assert stepped.velocity.values[-1] == 1.0
    assert rod(area=ri.Steps([1e-4], [])) == rod()
    round_ones = rod(
        area=ri.Steps([1e-4, 2e-4], [0.25]), polar_moment="circular", **LOVE
    ).segments
    assert [s.polar_moment for s in round_ones] == ["circular"] * 2
    family = ri.System([rod(area=ri.Steps([1e-4, np.array([1.0, 2.0])], [0.25]))])
    assert list(family.parameters) == ["bodies.0.segments.1.area"]
    moving = rod(area=ri.Steps([1e-4, 2e-4], [np.array([0.25, 0.5])]))
    assert [s.length.tolist() for s in moving.segments] == [[0.25, 0.5], [0.75, 0.5]]


# Lateral inertia


def test_polar_moments():
    disc = ri.Segment(1.0, np.pi * 0.01**2, steel, polar_moment="circular", **LOVE)
    assert disc.polar_moments(disc.area) == pytest.approx(
        np.pi * 0.01**4 / 2, rel=1e-15
    )
    tube = ri.Segment(1.0, 1e-4, steel, polar_moment=3e-8, **LOVE)
    assert tube.polar_moments([1e-4, 2e-4]).tolist() == [3e-8, 3e-8]
    assert ri.Segment(1.0, 1e-4, steel).polar_moments([1e-4, 2e-4]).tolist() == [
        0.0,
        0.0,
    ]
    cone = ri.Segment(
        1.0, ri.Samples([1.0, 2.0]), steel, polar_moment="circular", **LOVE
    )
    moments = cone.polar_moments([1.0, 2.0])
    assert moments == pytest.approx(np.array([1.0, 4.0]) / (2 * np.pi), rel=1e-15)


@pytest.mark.parametrize("word", ["rayleigh-love", "mindlin-herrmann"])
def test_a_word_and_a_diameter_are_enough_for_lateral_inertia(word):
    one = ri.Rod(1.0, diameter=0.02, material=steel, lateral_inertia=word)
    assert one == one.replace(polar_moment="circular")
    disc = rod(
        area=math.pi * 1e-4, polar_moment="circular", lateral_inertia=word
    ).segments[0]
    assert one.segments[0].polar_moments([1.0]) == disc.polar_moments([1.0])
    bar = one.replace(lateral_inertia=None)
    assert bar == ri.Rod(1.0, diameter=0.02, material=steel)
    assert (bar.segments[0].ideal, one.segments[0].ideal) == (True, False)
    assert ri.System.from_dict(ri.System([one]).to_dict()).bodies == (one,)
    tube = rod(polar_moment=2e-8, lateral_inertia=word)
    assert tube.segments[0].polar_moment == 2e-8
    steps = rod(
        area=ri.Steps([1e-4, 2e-4], [0.25]),
        polar_moment="circular",
        lateral_inertia=word,
    )
    assert steps.segments[1] == steps.segments[0].replace(length=0.75, area=2e-4)


# What is new, in all that a system can do


def test_every_new_field_counts_for_equality_and_digest():
    rods = [
        rod(),
        rod(area=ri.Samples([1e-4, 1e-4])),
        rod(area=ri.Samples([1e-4, 2e-4])),
        rod(polar_moment=1e-8, **LOVE),
        rod(polar_moment=2e-8, **LOVE),
        rod(polar_moment="circular", **LOVE),
        rod(area=None, diameter=0.01),
        rod(polar_moment="circular", lateral_inertia="mindlin-herrmann"),
    ]
    assert len(set(rods)) == len({one.digest for one in rods}) == len(rods)
    assert rod(polar_moment="circular", **LOVE) == rod(polar_moment="circular", **LOVE)
    assert set(rod().segments[0].to_dict()) == {"length", "area", "material"}


# What the methods lack


def test_a_taper_in_steps_is_for_every_method():
    row = ri.System([cone(velocity=1.0).in_steps(4), rod()])
    assert Options().method_for(row) == "fronts"
    assert Options().method_for(ri.System([cone()])) == "finite-difference"
    assert ri.solve(row).outcome.momentum_residual == pytest.approx(0, abs=1e-12)


# The same with other values

EVERYTHING = [
    steel,
    ri.Segment(0.4, 1e-4, steel, polar_moment="circular", **LOVE),
    ri.Segment(0.4, ri.Samples([1e-4, 2e-4]), steel),
    ri.Rod(0.4, area=1e-4, material=steel, velocity=ri.Steps([1.0, 0.0], [0.1])),
    ri.Rod(
        segments=[ri.Segment(0.4, 1e-4, steel), ri.Segment(0.1, 2e-4, steel)],
        strain=1e-4,
    ),
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
    ri.Segment(0.4, None, steel, diameter=0.01, lateral_inertia="mindlin-herrmann"),
    ri.System([ri.Rod(0.4, area=1e-4, material=steel), ri.Wall()], [1e-3], gravity=1.0),
]


@pytest.mark.parametrize("thing", EVERYTHING, ids=lambda thing: type(thing).__name__)
def test_replace_changes_only_what_it_is_told(thing):
    assert thing.replace() == thing
    for name, value in thing.to_dict().items():
        if name in thing.fields and isinstance(value, float):
            changed = thing.replace(**{name: value / 2})
            assert getattr(changed, name) == value / 2
            assert changed.replace(**{name: value}) == thing
    with pytest.raises(
        ri.InvalidModel, match=f"colour: is no parameter of {type(thing).__name__}"
    ):
        thing.replace(colour="red")


def test_replace_names_the_nearest_parameter_and_checks_values():
    with pytest.raises(
        ri.InvalidModel, match="lenght: is no parameter of Rod; perhaps 'length'"
    ):
        EVERYTHING[3].replace(lenght=1.0)
    with pytest.raises(
        ri.InvalidModel, match="stiffness: must be a finite positive number of N/m"
    ):
        ri.Spring(1.0).replace(stiffness=-1.0)


@pytest.mark.parametrize("kind", [ri.Rod, ri.Segment])
def test_a_diameter_is_that_of_a_round_section(kind):
    d = np.array([0.01, 0.02])
    thick = kind(0.4, material=steel, diameter=d)
    assert (
        thick.mass.tolist()
        == kind(0.4, area=math.pi * d * d / 4, material=steel).mass.tolist()
    )
    assert thick.to_dict()["diameter"] == d.tolist()
    assert "area" not in thick.to_dict()
