"""What is right in a case file means what it says; every mistake is told at once, with
its path.
"""

import dataclasses
import math

import pytest
from case_texts import (
    A_GUM,
    A_MASS,
    A_ROD,
    A_WALL,
    CONTACT,
    HEAD,
    LAW,
    LEFT,
    ROD,
    STEEL,
    problems,
    with_area,
)

import rodimpact as ri
from rodimpact.model.ends import ENDS
from rodimpact.storage.casefile import Case, format_case, parse_case

# What is right


def test_a_case_of_every_table_means_what_it_says():
    """A case file with every kind of table and many units is read: system, options,
    output and name are those that are written out in Python.
    """
    case = parse_case(
        """
        schema = 1
        [materials.steel]
        youngs_modulus = "210 GPa"
        density = "7.8 g/cm^3"
        [materials."my rubber"]
        youngs_modulus = 5e6
        density = 1100
        poisson_ratio = "49 %"
        viscosity = "2 kPa s"
        [[bodies]]
        kind = "wall"
        velocity = "1 mm/s"
        [[bodies]]
        kind = "rod"
        length = "400 mm"
        diameter = "20 mm"
        material = "steel"
        velocity = {values = ["1 m/s", 0], at = ["10 cm"]}
        strain = "0.01 %"
        [[bodies]]
        kind = "rod"
        velocity = -2
        strain = {values = [0.0, 1e-3], at = [0.15]}
        [[bodies.segments]]
        length = 0.1
        area = "1 cm^2"
        material = "my rubber"
        [[bodies.segments]]
        length = 0.2
        area = "2 cm^2"
        material = "brass"
        [[contacts]]
        [[contacts]]
        gap = "50 um"
        law = "rigid"
        [solve]
        until = "3 ms"
        method = "fronts"
        max_events = 1000
        [output]
        plot = "a.png"
        save = "a.toml"
    """,
        "name",
    )
    steel = ri.Material("steel", youngs_modulus=210e9, density=7800)
    rubber = ri.Material(
        "my rubber", youngs_modulus=5e6, density=1100, poisson_ratio=0.49, viscosity=2e3
    )
    left = ri.Rod(
        0.4,
        diameter=0.02,
        material=steel,
        velocity=ri.Steps([1, 0], [0.1]),
        strain=1e-4,
    )
    right = ri.Rod(
        segments=[
            ri.Segment(0.1, 1e-4, rubber),
            ri.Segment(0.2, 2e-4, ri.materials.brass),
        ],
        velocity=-2,
        strain=ri.Steps([0, 1e-3], [0.15]),
    )
    assert case == Case(
        ri.System([ri.Wall(1e-3), left, right], gaps=[0, 50e-6]),
        {"until": 3e-3, "method": "fronts", "max_events": 1000},
        {"plot": "a.png", "save": "a.toml"},
        "name",
    )


def test_masses_gravity_laws_ends_and_a_time_step_are_read_and_written_as_they_are():
    """A case file with masses, gravity, five laws, drives at both ends and a time step
    is read as the system written out in Python, and is the same after writing and
    reading.
    """
    case = parse_case("""
        schema = 1
        gravity = "-9.81 m/s^2"
        bodies = [
            {kind = "mass", mass = "500 g", velocity = "2 m/s"},
            {kind = "mass", mass = 2},
            {kind = "rod", length = 0.4, area = 1e-4, material = "steel", \
             velocity = {samples = [0, "1 m/s", 2.0]}, strain = {samples = ["0.1 %", 0]}},
            {kind = "rod", length = 0.4, area = 1e-4, material = "steel"},
            {kind = "mass", mass = "1 t"},
            {kind = "rod", length = 0.4, area = 1e-4, material = "steel"},
        ]
        contacts = [
            {restitution = "80 %"},
            {law = "spring-dashpot", stiffness = "3 kN/mm", damping = "4 N s/m", gap = "1 mm"},
            {law = "hertz", stiffness = "12 GN/m^1.5"},
            {law = "hunt-crossley", stiffness = 1e9, damping = "0.2 s/m"},
            {law = "spring", stiffness = 1e6},
        ]
        [ends]
        left = {kind = "pushed", value = {values = ["1 kN", 0], at = ["1 ms"]}}
        right = {kind = "moved", value = {samples = [0, "1 cm/s"], step = "10 us"}}
        [solve]
        dt = "0.1 us"
        method = "auto"
    """)
    moving = ri.Rod(
        0.4,
        area=1e-4,
        material=STEEL,
        velocity=ri.Samples([0, 1, 2]),
        strain=ri.Samples([1e-3, 0]),
    )
    assert case.system == ri.System(
        [
            ri.RigidMass(0.5, velocity=2.0),
            ri.RigidMass(2),
            moving,
            ROD,
            ri.RigidMass(1000),
            ROD,
        ],
        gaps=[0, 1e-3, 0, 0, 0],
        contacts=[
            ri.Rigid(0.8),
            ri.SpringDashpot(3e6, 4.0),
            ri.Hertz(12e9),
            ri.HuntCrossley(1e9, 0.2),
            ri.Spring(1e6),
        ],
        gravity=-9.81,
        ends=(
            ri.Pushed(ri.Steps([1e3, 0], [1e-3])),
            ri.Moved(ri.Samples([0, 0.01], step=1e-5)),
        ),
    )
    assert case.solve == {"dt": 1e-7, "method": "auto"}
    assert parse_case(format_case(case)) == case


@pytest.mark.parametrize(
    ("written", "end"),
    [
        ('"fixed"', ri.Fixed()),
        ('"absorbing"', ri.Absorbing()),
        ('"free"', ri.Free()),
        ('"pushed"\nvalue = "-2 kN"', ri.Pushed(-2000)),
        ('"velocity"\nvalue = 3', ri.Moved(3)),
        (
            '"incoming"\nvalue = {samples = [0, -1e-3], step = "2 us"}',
            ri.Incoming(ri.Samples([0, -1e-3], step=2e-6)),
        ),
    ],
)
def test_an_end_is_read_on_either_side_and_written_as_it_is(written, end):
    """An end written in a case file at the left or the right is this end there, and is
    the same after writing and reading.
    """
    on_left = parse_case(HEAD + A_ROD + LEFT + written)
    on_right = parse_case(HEAD + A_ROD + "[ends.right]\nkind = " + written)

    assert on_left.system == ri.System([ROD], ends=(end, ri.Free()))
    assert on_right.system.ends == (ri.Free(), end)
    assert parse_case(format_case(on_left)).system == on_left.system


@pytest.mark.parametrize(
    ("earlier", "end"), [("force", ri.Pushed(2.0)), ("velocity", ri.Moved(2.0))]
)
def test_earlier_kinds_of_ends_are_read_from_cases_and_dicts(earlier, end):
    """An earlier name of a kind of end is read from a case and a dict, and written with
    the present name.
    """
    case = parse_case(HEAD + A_ROD + LEFT + f"'{earlier}'\nvalue = 2")

    data = case.system.to_dict()
    left = data["ends"]["left"]
    assert case.system.ends[0] == end
    assert left["kind"] == type(end).__name__.lower()
    left["kind"] = earlier
    assert ri.System.from_dict(data) == case.system


def test_kinds_of_ends_bear_the_names_of_python():
    for kind, end in ENDS.items():
        assert kind == end.__name__.lower()


def test_an_end_that_is_moved_by_its_position_has_a_velocity_and_may_vary():
    """An end with sampled positions is read with the velocity that follows, is equal
    after writing and reading, and its step may vary.
    """
    position = 'position = {samples = ["0 mm", "1 mm"], step = "2 ms"}'
    left = LEFT + f"'moved'\n{position}\n"

    case = parse_case(HEAD + A_ROD + left)
    vary = {"ends.left.position.step": "1 ms, 2 ms"}
    family = parse_case(HEAD + A_ROD + left, vary=vary).system

    assert case.system.ends[0].value == ri.Steps([0.5, 0.0], at=[2e-3])
    assert parse_case(format_case(case)) == case
    assert family[0].ends[0].value == ri.Steps([1.0, 0.0], at=[1e-3])
    assert family[1] == case.system


def test_a_material_has_a_wave_speed_in_place_of_a_modulus_and_either_may_vary():
    """A material that is given by its wave speed is read, and is the same after writing
    and reading; grids over the wave speed or the modulus give each member its material.
    """
    text = """
        [materials.bar]
        wave_speed = "5.1 km/s"
        density = "7850 kg/m^3"
        """
    a_rod = A_ROD.replace('"steel"', '"bar"')
    bar = ri.Material("bar", wave_speed=5100.0, density=7850.0)

    case = parse_case(HEAD + text + a_rod)
    family = parse_case(
        HEAD + text + a_rod, vary={"materials.bar.wave_speed": "5000:5200:3"}
    )
    moduli = parse_case(
        HEAD + text + a_rod, vary={"materials.bar.youngs_modulus": "1 GPa, 2 GPa"}
    )

    assert case.system.bodies[0].segments[0].material == bar
    assert parse_case(format_case(case)) == case
    for i, speed in enumerate((5000.0, 5100.0, 5200.0)):
        material = family.system[i].bodies[0].segments[0].material
        assert material.wave_speed == pytest.approx(speed, rel=1e-15)
    assert moduli.system[1].bodies[0].segments[0].material.youngs_modulus == 2e9


def test_drag_along_rods_is_read_and_written_and_may_vary():
    """Drag with a unit, and in steps, is read, equal after writing and reading, and may
    vary by a grid.
    """
    shaft = '[bodies.shaft]\nkind = "drag"\ncoefficient = '
    steps = "{values = [3, 0], at = ['10 cm']}"

    vary = {"bodies.0.shaft.coefficient": "1:3:3"}

    case = parse_case(HEAD + A_ROD + shaft + "'2 kN s/m'\n" + A_ROD + shaft + steps)
    family = parse_case(HEAD + A_ROD + shaft + "1", vary=vary).system

    uniform, stepped = case.system.bodies
    assert uniform.shaft == ri.Drag(2000.0)
    assert stepped.shaft == ri.Drag(ri.Steps([3.0, 0.0], at=[0.1]))
    assert parse_case(format_case(case)) == case
    assert family[2].bodies[0].shaft == ri.Drag(3.0)


def test_a_shaft_without_a_kind_is_soil():
    shaft = "[bodies.shaft]\nresistance = 1e5\nquake = 2e-3\n"

    case = parse_case(HEAD + A_ROD + shaft)

    assert case.system.bodies[0].shaft == ri.Soil(1e5, 2e-3)
    assert parse_case(format_case(case)) == case


def test_profiles_along_a_shaft_have_units_per_length():
    """Steps of a resistance in kN/m and of a drag in N s/m^2 are read in SI units."""
    soil = "[bodies.shaft]\nquake = 2e-3\nresistance = {values = ['5 kN/m', 0], at = [0.1]}\n"
    drag = "[bodies.shaft]\nkind = 'drag'\ncoefficient = {values = ['2 N s/m^2', 0], at = [0.1]}\n"

    in_soil, dragged = parse_case(HEAD + A_ROD + soil + A_ROD + drag).system.bodies

    assert in_soil.shaft == ri.Soil(ri.Steps([5e3, 0.0], at=[0.1]), 2e-3)
    assert dragged.shaft == ri.Drag(ri.Steps([2.0, 0.0], at=[0.1]))


BRASS_ROD = A_ROD.replace("steel", "brass")
STEPPED = "[[bodies]]\nkind = 'rod'\n" + "".join(
    f"[[bodies.segments]]\nlength = 0.1\narea = 1e-4\nmaterial = '{name}'\n"
    for name in ("glass", "copper")
)


@pytest.mark.parametrize(
    ("bodies", "entries", "faces"),
    [
        (
            (A_ROD, BRASS_ROD),
            ["left_radius = '2 cm'", "right_radius = 0.01"],
            (0.02, 0.01, "steel", "brass"),
        ),
        (
            (A_ROD, BRASS_ROD),
            ["left_radius = 0.02", "right_radius = 'inf'"],
            (0.02, math.inf, "steel", "brass"),
        ),
        (
            (A_ROD, BRASS_ROD),
            ["right_radius = 0.02"],
            (math.inf, 0.02, "steel", "brass"),
        ),
        # The face is that of the segment at the contact.
        ((STEPPED, A_ROD), ["left_radius = 0.02"], (0.02, math.inf, "copper", "steel")),
        ((A_ROD, STEPPED), ["left_radius = 0.02"], (0.02, math.inf, "steel", "glass")),
        # A rigid body is not compressed, unless the file says of what it is made.
        ((A_ROD, A_WALL), ["left_radius = 0.02"], (0.02, math.inf, "steel", None)),
        (
            (A_ROD, A_WALL),
            ["left_radius = 0.02", "right_material = 'glass'"],
            (0.02, math.inf, "steel", "glass"),
        ),
    ],
)
def test_a_hertz_contact_has_the_stiffness_of_radii_and_materials_of_its_faces(
    bodies, entries, faces
):
    """A Hertz contact in a case file, given by radii and materials, has the stiffness
    of `Hertz.from_radii`, also after writing and reading.
    """
    left_radius, right_radius, left_name, right_name = faces
    left_material = ri.materials.TABLE[left_name]
    right_material = None
    if right_name is not None:
        right_material = ri.materials.TABLE[right_name]
    expected = ri.Hertz.from_radii(
        left_radius, right_radius, left_material, right_material
    )

    case = parse_case(HEAD + "".join(bodies) + LAW + "'hertz'\n" + "\n".join(entries))

    assert case.system.contacts[0].stiffness == expected.stiffness
    assert parse_case(format_case(case)).system == case.system


def test_a_case_is_frozen():
    case = parse_case(HEAD + A_ROD)

    with pytest.raises(dataclasses.FrozenInstanceError):
        case.system = None


# Mistakes


@pytest.mark.parametrize(
    ("text", "path", "said"),
    [
        # the frame
        (A_ROD, "schema", "must be 1; begin the file with schema = 1"),
        ("schema = true\n" + A_ROD, "schema", "must be 1; begin the file"),
        ("schema = 2\nnews = 1\n", "schema", "is 2; this rodimpact reads 1"),
        (HEAD, "bodies", "is missing; describe each body in a [[bodies]] table"),
        (
            HEAD + "bodies = 3",
            "bodies",
            "must be tables that each begin [[bodies]], got 3",
        ),
        (
            HEAD + "friction = 1\n" + A_ROD,
            "friction",
            "unknown key; use one of schema, materials, gravity, bodies, contacts, "
            "ends, solve",
        ),
        (
            HEAD + "gravity = '9.81 m/s'\n" + A_ROD,
            "gravity",
            "'m/s' is a unit of velocity",
        ),
        (
            HEAD + "gravity = [1, 2]\n" + A_ROD,
            "gravity",
            'vary={"gravity": "start:stop:count"}',
        ),
        (HEAD + A_ROD + "[solv]", "solv", "unknown key; perhaps 'solve' is meant"),
        # bodies
        (
            HEAD + "[[bodies]]",
            "bodies.0.kind",
            "is missing; use one of rod, mass, wall",
        ),
        (
            HEAD + "[[bodies]]\nkind='Rood'",
            "bodies.0.kind",
            "unknown kind 'Rood'; perhaps 'rod'",
        ),
        (
            HEAD + "[[bodies]]\nkind='ground'",
            "bodies.0.kind",
            "unknown kind 'ground'; use 'wall'; a kind is rod, mass or wall",
        ),
        (
            HEAD + "[[bodies]]\nkind='Ram'",
            "bodies.0.kind",
            "unknown kind 'Ram'; use 'mass'; a kind is rod, mass or wall",
        ),
        (
            HEAD + A_ROD + "velocty = 1",
            "bodies.0.velocty",
            "unknown key; perhaps 'velocity'",
        ),
        (
            HEAD + A_ROD + "diameter = 1",
            "bodies.0.diameter",
            "either area or diameter, not both",
        ),
        *(
            (
                HEAD + A_ROD.replace("area = 1e-4", f"diameter = {wrong}"),
                "bodies.0.diameter",
                said,
            )
            for wrong, said in [
                ("0", "positive"),
                ("-1", "positive"),
                ("'1 kg'", "a unit of mass"),
                ("nan", "finite"),
                ("[1]", "cannot read"),
            ]
        ),
        *(
            (
                HEAD + A_ROD.replace("0.4", wrong),
                "bodies.0.length",
                "must be 0 or of a magnitude from 1e-150 to 1e+150",
            )
            for wrong in ("1e-320", "1e-308", "1e308", "'1e-300 m'")
        ),
        (HEAD + A_ROD + "velocity = true", "bodies.0.velocity", "it is not a number"),
        (
            HEAD + A_ROD + "velocity = [1, 2]",
            "bodies.0.velocity",
            'vary={"bodies.0.velocity": "start:stop:count"} varies it',
        ),
        (
            HEAD + A_ROD + "strain = [1, 2]",
            "bodies.0.strain",
            "A profile is written {values = [...], at = [...]} or {samples = [...]}; "
            "vary=",
        ),
        (
            HEAD + "[[bodies]]\nkind='mass'\n" + A_ROD + LAW + "'hertz'\nstiffness=1",
            "bodies.0.mass",
            "is missing; give a number in SI units or text with one of kg, g",
        ),
        (
            HEAD + A_MASS.replace("2", "-2") + A_ROD,
            "bodies.0.mass",
            "must be a finite positive number of kilograms, got -2.0",
        ),
        (HEAD + A_ROD + A_WALL + A_ROD, "bodies.1", "only at an end of the row"),
        (HEAD + A_WALL + A_WALL, "bodies", "a rod or a rigid mass"),
        # profiles
        (
            HEAD + A_ROD + "velocity = {values=[1,2]}",
            "bodies.0.velocity.at",
            "is missing",
        ),
        (
            HEAD + A_ROD + "velocity = {values=1, at=[]}",
            "bodies.0.velocity.values",
            "a list",
        ),
        (
            HEAD + A_ROD + "velocity = {values=[1,2], at=['1 s']}",
            "bodies.0.velocity.at.0",
            "'s' is a unit of time",
        ),
        (
            HEAD + A_ROD + "strain = {values=[1,[2]], at=[0.1]}",
            "bodies.0.strain.values.1",
            "cannot read [2] as dimensionless: it is not a number",
        ),
        (
            HEAD + A_ROD + "velocity = {samples=[1]}",
            "bodies.0.velocity.samples",
            "must be a list of at least two numbers, got [1.0]",
        ),
        (
            HEAD + A_ROD + "velocity = {samples=[1, 2], step=1}",
            "bodies.0.velocity.step",
            "unknown key; use one of samples",
        ),
        # tapers and lateral inertia
        (
            HEAD + with_area("{samples = [1, '2 cm']}"),
            "bodies.0.area.samples.1",
            "'cm' is a unit of length",
        ),
        (
            HEAD + with_area("{values = [1, -2], at = [0.1]}"),
            "bodies.0.area.values.1",
            "positive number of square metres, got -2.0",
        ),
        (
            HEAD + with_area("[1, 2]"),
            "bodies.0.area",
            "A profile is written {values = [...], at",
        ),
        (
            HEAD
            + with_area(
                "{samples = [1, 2]}\npolar_moment = 1\n"
                "lateral_inertia = 'rayleigh-love'"
            ),
            "bodies.0.polar_moment",
            'must be "circular" along a taper',
        ),
        (
            HEAD + A_ROD + "polar_moment = 'circle'",
            "bodies.0.polar_moment",
            "unknown polar_moment 'circle'; perhaps 'circular' is meant",
        ),
        (
            HEAD + A_ROD + "polar_moment = 'circular'\nlateral_inertia = 'mindlin'",
            "bodies.0.lateral_inertia",
            "unknown lateral_inertia 'mindlin'; perhaps 'mindlin-herrmann' is meant",
        ),
        (
            HEAD + A_ROD + "polar_moment = '1 cm^3'",
            "bodies.0.polar_moment",
            "perhaps 'cm^4' is",
        ),
        (
            HEAD
            + "[[bodies]]\nkind='rod'\n[[bodies.segments]]\nlength=1\nmaterial='steel'\n"
            "area={values=[1, 2], at=[0.5]}",
            "bodies.0.segments.0.area",
            "jumps inside a segment",
        ),
        # segments
        (
            HEAD + A_ROD + "segments = []",
            "bodies.0.segments",
            "either segments or length",
        ),
        (
            HEAD + "[[bodies]]\nkind='rod'\nsegments = []",
            "bodies.0.segments",
            "at least one",
        ),
        (
            HEAD
            + "[[bodies]]\nkind='rod'\n[[bodies.segments]]\nlength=1\narea=1\nmaterial='steel'\n"
            "velocity=1",
            "bodies.0.segments.0.velocity",
            "unknown key",
        ),
        # materials
        (
            HEAD + A_ROD.replace("steel", "Steal"),
            "bodies.0.material",
            "unknown material 'Steal'; perhaps 'steel' is meant",
        ),
        (
            HEAD + A_ROD.replace('"steel"', "3"),
            "bodies.0.material",
            "unknown material 3",
        ),
        (
            HEAD + A_ROD + "[bodies.shaft]\nkind = 'darg'",
            "bodies.0.shaft.kind",
            "perhaps 'drag' is meant",
        ),
        (
            HEAD + A_ROD + "[bodies.shaft]\nkind = 'drag'",
            "bodies.0.shaft.coefficient",
            "is missing; give a number in SI units",
        ),
        (
            HEAD + A_ROD + A_GUM + "wave_speed = 1",
            "materials.x.wave_speed",
            "give either youngs_modulus or wave_speed",
        ),
        (
            HEAD + A_ROD + "[materials.x]\nwave_speed = '1 m'\ndensity = 1",
            "materials.x.wave_speed",
            "a unit of length",
        ),
        (
            HEAD + A_ROD + "[materials.x]\nyoungs_modulus=1",
            "materials.x.density",
            "is missing; give a number in SI units or text with one of kg/m^3, g/cm^3",
        ),
        (
            HEAD
            + A_ROD
            + "[materials.x]\nyoung_modulus=1\nyoungs_modulus=1\ndensity=1",
            "materials.x.young_modulus",
            "perhaps 'youngs_modulus'",
        ),
        (
            HEAD + A_ROD + A_GUM + "loss_factor=1",
            "materials.x.loss_frequency",
            "is missing; give a number in SI units or text with one of Hz, kHz, MHz",
        ),
        (
            HEAD + A_ROD + A_GUM + "loss_factor=1\nloss_frequency=1\nviscosity=0",
            "materials.x.viscosity",
            "either viscosity or loss_factor and loss_frequency, not both",
        ),
        (
            HEAD + A_ROD + A_GUM + "loss_frequency=1",
            "materials.x.loss_factor",
            "is missing; give a number",
        ),
        (
            HEAD + A_ROD + "[[materials]]\nx = 3",
            "materials",
            "must be a table, got [{'x': 3}]",
        ),
        # contacts
        (
            HEAD + A_ROD + A_WALL + "[[contacts]]\ngap = -1",
            "contacts.0.gap",
            "non-negative",
        ),
        (
            HEAD + A_ROD + A_WALL + "[[contacts]]\ngap = 1\nlaw = 'bonded'",
            "contacts.0.gap",
            "must be 0 where bodies are joined",
        ),
        (
            HEAD + A_ROD + A_WALL + "[[contacts]]\nlaw = 'glued'",
            "contacts.0.law",
            "unknown law 'glued'; use one of rigid, bonded, joint, spring, "
            "spring-dashpot, hertz",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'Hertzian'\nstiffness = 1",
            "contacts.0.law",
            "perhaps 'hertz' is meant",
        ),
        (
            HEAD + A_MASS + A_MASS + A_ROD,
            "contacts.0",
            "no wave decides this contact: give Rigid(",
        ),
        (
            HEAD + A_ROD + A_WALL + CONTACT + "restitution = 1",
            "contacts.0.restitution",
            "the waves of a rod decide this contact: leave it out",
        ),
        (
            HEAD
            + A_MASS
            + A_MASS
            + A_ROD
            + CONTACT
            + "restitution = '120 %'\n"
            + CONTACT,
            "contacts.0.restitution",
            "must lie in [0, 1], got 1.2",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'spring'",
            "contacts.0.stiffness",
            "is missing; give a number in SI units or text with one of N/m, N/mm",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'spring'\nstiffness = 1\ndamping = 1",
            "contacts.0.damping",
            "unknown key; use one of gap, law, stiffness",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'hunt-crossley'\nstiffness = 1",
            "contacts.0.damping",
            "is missing; give a number in SI units or text with one of s/m",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'hertz'",
            "contacts.0.stiffness",
            "give either the stiffness, or left_radius and right_radius",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'hertz'\nstiffness = 1\nleft_radius = 1",
            "contacts.0.stiffness",
            "either the stiffness, or left_radius and right_radius",
        ),
        (
            HEAD + A_ROD + A_WALL + LAW + "'hertz'\nleft_radius = 'inf'",
            "contacts.0.right_radius",
            "two flat faces make no Hertz contact",
        ),
        (
            HEAD
            + A_ROD.replace("steel", "oak")
            + A_WALL
            + LAW
            + "'hertz'\nleft_radius = 1",
            "contacts.0.left_material",
            "must be a Material with a poisson_ratio",
        ),
        (
            HEAD
            + A_MASS
            + A_MASS
            + A_ROD
            + LAW
            + "'hertz'\nleft_radius = 1\n"
            + CONTACT,
            "contacts.0.right_material",
            "one of the faces must be elastic",
        ),
        # ends
        (HEAD + A_ROD + "ends = 3", "bodies.0.ends", "unknown key"),
        (
            HEAD + A_ROD + "[ends]\nleft = 'fixed'",
            "ends.left",
            "must be a table, got 'fixed'",
        ),
        (
            HEAD + A_ROD + "[ends.top]\nkind = 'fixed'",
            "ends.top",
            "use one of left, right",
        ),
        (
            HEAD + A_ROD + "[ends.left]",
            "ends.left.kind",
            "is missing; use one of free, fixed, absorbing, pushed, moved, incoming",
        ),
        (
            HEAD + A_ROD + LEFT + "'clamped'\nvalue = 1",
            "ends.left.kind",
            "unknown kind 'clamped'",
        ),
        (
            HEAD + A_ROD + LEFT + "'force'",
            "ends.left.value",
            "or text with one of N, mN",
        ),
        (
            HEAD + A_ROD + LEFT + "'moved'\n",
            "ends.left.value",
            "is missing; give a velocity, or a position",
        ),
        (
            HEAD + A_ROD + LEFT + "'moved'\nposition = {values=[0, 1], at=[1]}",
            "ends.left.position",
            "jumps, and an end cannot jump; give Samples of the position",
        ),
        (
            HEAD + A_ROD + LEFT + "'moved'\nvalue = [1, 2]",
            "ends.left.value",
            "is written {values = [...], at = [...]} or {samples = [...], step = ...}; "
            "vary=",
        ),
        (
            HEAD + A_ROD + LEFT + "'force'\nvalue = {samples=[1, 2]}",
            "ends.left.value.step",
            "is missing; give a number in SI units or text with one of s",
        ),
        (
            HEAD + A_WALL + A_ROD + LEFT + "'fixed'",
            "ends.left",
            "no place beyond a wall",
        ),
        (
            HEAD + A_ROD + A_WALL + "[[contacts]]\nLaw = 'rigid'",
            "contacts.0.Law",
            "perhaps 'law'",
        ),
        (
            HEAD + A_ROD + A_ROD + A_WALL + "[[contacts]]",
            "contacts",
            "pair, 2 in all, got",
        ),
        # what to do
        (
            HEAD + A_ROD + "[solve]\nuntil = -1",
            "solve.until",
            "non-negative number of seconds",
        ),
        (
            HEAD + A_ROD + "[solve]\nmethod = 'front'",
            "solve.method",
            "one of 'auto', 'fronts'",
        ),
        (HEAD + A_ROD + "[solve]\ndt = 1\nrtol = 1e-6", "solve.dt", "give one of them"),
        (
            HEAD + A_ROD + "[solve]\nmax_event = 1",
            "solve.max_event",
            "perhaps 'max_events'",
        ),
        (
            HEAD + A_ROD + "[solve]\nsnapshots = '9'",
            "solve.snapshots",
            "or a list of times",
        ),
        (
            HEAD + A_ROD + "[output]\nplot = ''",
            "output.plot",
            "must be the name of a file",
        ),
        (
            HEAD + A_ROD + '[output]\nplot = "a\\u0000b"',
            "output.plot",
            r"must be the name of a file, got 'a\x00b'",
        ),
        (
            HEAD + A_ROD + "[output]\nplots = 'a'",
            "output.plots",
            "perhaps 'plot' is meant",
        ),
    ],
)
def test_each_mistake_alone_is_named_with_its_path(text, path, said):
    """A case file with one mistake is refused at one path with these words; profiles
    are mentioned only where one is possible.
    """
    messages = problems(text)
    assert list(messages) == [path]
    assert said in messages[path]
    # Profiles are spoken of only where a number may be one.
    may_be_profile = (
        "bodies.0.area",
        "bodies.0.velocity",
        "bodies.0.strain",
        "ends.left.value",
    )
    if path not in may_be_profile:
        assert "{values" not in messages[path]


def test_all_that_a_rod_must_have_is_named():
    assert list(problems(HEAD + "[[bodies]]\nkind = 'rod'")) == [
        "bodies.0.length",
        "bodies.0.material",
        "bodies.0.area",
    ]


def test_all_mistakes_at_once_each_with_its_path():
    """A case file with a mistake nearly everywhere is refused with the path of every
    mistake, and no message contains None or nan.
    """
    messages = problems("""
        schema = 1
        foo = 1
        gravity = "down"
        materials.rubber = {youngs_modulus = "5 kg", density = 0}
        bodies = [
            {kind = "rod", length = -1, area = 0, material = "stel", \
             velocity = {values = [1, "x"], at = [0.1]}, strain = {values = [1, 2]}},
            {kind = "wall", velocity = inf, size = 3},
            {kind = "rod", segments = [{length = "x", area = -1, material = "rubber"}, \
                                       {material = "steel"}]},
            {kind = "blob"},
            {kind = "mass", mass = 0},
        ]
        contacts = [{gap = -1}, {gap = "y", law = 7, stiffness = 3},
                    {law = "hertz", left_radius = "x", right_material = "y"},
                    {restitution = 0.5}, {}]
        ends = {left = {kind = "pushed", value = "hard"}, right = {kind = "moved"}}
        solve = {until = "never", method = "magic", max_events = -1, dt = 0, rtol = 0}
        output = {plot = 1}
    """)
    assert set(messages) == {
        "foo",
        "gravity",
        "materials.rubber.youngs_modulus",
        "materials.rubber.density",
        "bodies.0.length",
        "bodies.0.area",
        "bodies.0.material",
        "bodies.0.velocity.values.1",
        "bodies.0.strain.at",
        "bodies.1.velocity",
        "bodies.1.size",
        "bodies.1",
        "bodies.2.segments.0.length",
        "bodies.2.segments.0.area",
        "bodies.2.segments.1.length",
        "bodies.2.segments.1.area",
        "bodies.3.kind",
        "bodies.4.mass",
        "contacts",
        "contacts.0.gap",
        "contacts.1.gap",
        "contacts.1.law",
        "contacts.2.left_radius",
        "contacts.2.right_material",
        "ends.left.value",
        "ends.right.value",
        "solve.until",
        "solve.method",
        "solve.max_events",
        "solve.dt",
        "solve.rtol",
        "output.plot",
    }
    for message in messages.values():
        assert "None" not in message
        assert "nan" not in message
