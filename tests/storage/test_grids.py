"""Any number of a case may vary on a grid; the case is then a family with an axis for
each.
"""

import json
import math

import numpy as np
import pytest
from case_texts import (
    A_MASS,
    A_ROD,
    A_WALL,
    CONTACT,
    HEAD,
    LAW,
    LEFT,
    STEEL,
    problems,
)
from hypothesis import given
from hypothesis import strategies as st

import rodimpact as ri
from rodimpact.storage.casefile import parse_case, read_case

# Families


PROFILES_AND_SEGMENTS = """
schema = 1
[materials."a.b"]
youngs_modulus = "5 GPa"
density = 1000
poisson_ratio = 0.25
[[bodies]]
kind = "wall"
[[bodies]]
kind = "rod"
length = "0.4 m"
diameter = 0.01
material = "a.b"
velocity = {values = [1.0, "2 m/s"], at = [0.2]}
[[bodies]]
kind = "rod"
velocity = 0.5
[[bodies.segments]]
length = 0.1
area = "1 cm^2"
material = "steel"
[[bodies.segments]]
length = 0.2
area = "3 cm^2"
material = "a.b"
"""
GAPS = "[[contacts]]\n[[contacts]]\ngap = 1e-5\n"


ALL_KINDS = """
schema = 1
gravity = 1
materials.ball = {youngs_modulus = "100 GPa", density = 5000, poisson_ratio = 0.3}
bodies = [
    {kind = "mass", mass = 1},
    {kind = "mass", mass = 2, velocity = 3},
    {kind = "rod", length = 0.4, area = 1e-4, material = "steel"},
    {kind = "mass", mass = 5},
    {kind = "rod", length = 0.4, area = 1e-4, material = "steel"},
]
contacts = [
    {restitution = 0.5},
    {law = "hunt-crossley", stiffness = 1e9, damping = 0.1},
    {law = "spring-dashpot", stiffness = 1e6, damping = 10},
    {law = "hertz", left_radius = 0.05, left_material = "ball"},
]
[ends]
left = {kind = "pushed", value = {values = [1, 0], at = [1e-3]}}
right = {kind = "moved", value = {samples = [0, 1], step = 1e-3}}
"""


@pytest.mark.parametrize(
    ("text", "path", "grid", "values", "unit", "read"),
    [
        *(
            (PROFILES_AND_SEGMENTS + contacts, *more)
            for contacts in ("", GAPS)
            for more in [
                (
                    "bodies.1.length",
                    "30 cm,0.5",
                    [0.3, 0.5],
                    "m",
                    lambda s: s.bodies[1].segments[0].length,
                ),
                (
                    "bodies.1.velocity.values.0",
                    "-1,7",
                    [-1, 7],
                    "m/s",
                    lambda s: s.bodies[1].velocity.values[0],
                ),
                (
                    "bodies.1.velocity.at.0",
                    "1 mm,0.3",
                    [1e-3, 0.3],
                    "m",
                    lambda s: s.bodies[1].velocity.at[0],
                ),
                (
                    "bodies.1.strain",
                    "0.1 %,0",
                    [1e-3, 0],
                    "",
                    lambda s: s.bodies[1].strain,
                ),
                (
                    "bodies.0.velocity",
                    "0,-2 mm/s",
                    [0, -2e-3],
                    "m/s",
                    lambda s: s.bodies[0].velocity,
                ),
                (
                    "bodies.2.segments.0.area",
                    "1 mm^2,2",
                    [1e-6, 2],
                    "m^2",
                    lambda s: s.bodies[2].segments[0].area,
                ),
                ("contacts.0.gap", "0,2 um", [0, 2e-6], "m", lambda s: s.gaps[0]),
                (
                    "materials.a.b.density",
                    "1 g/cm^3,2000",
                    [1000, 2000],
                    "kg/m^3",
                    lambda s: s.bodies[1].segments[0].material.density,
                ),
                (
                    "materials.a.b.viscosity",
                    "0,1 kPa s",
                    [0, 1000],
                    "Pa s",
                    lambda s: s.bodies[1].segments[0].material.viscosity,
                ),
            ]
        ),
        *(
            (ALL_KINDS, *more)
            for more in [
                ("gravity", "2,9.81 m/s^2", [2, 9.81], "m/s^2", lambda s: s.gravity),
                (
                    "bodies.0.mass",
                    "1,500 g",
                    [1, 0.5],
                    "kg",
                    lambda s: s.bodies[0].mass,
                ),
                (
                    "contacts.0.restitution",
                    "10 %,1",
                    [0.1, 1],
                    "",
                    lambda s: s.contacts[0].restitution,
                ),
                (
                    "contacts.1.stiffness",
                    "1,2 kN/m^1.5",
                    [1, 2000],
                    "N/m^1.5",
                    lambda s: s.contacts[1].stiffness,
                ),
                (
                    "contacts.1.damping",
                    "1,2 s/m",
                    [1, 2],
                    "s/m",
                    lambda s: s.contacts[1].damping,
                ),
                (
                    "ends.left.value.values.0",
                    "1,2 kN",
                    [1, 2000],
                    "N",
                    lambda s: s.ends[0].value.values[0],
                ),
                (
                    "ends.left.value.at.0",
                    "1,2 ms",
                    [1, 2e-3],
                    "s",
                    lambda s: s.ends[0].value.at[0],
                ),
                (
                    "ends.right.value.step",
                    "1,2 ms",
                    [1, 2e-3],
                    "s",
                    lambda s: s.ends[1].value.step,
                ),
            ]
        ),
    ],
)
def test_any_number_may_vary_given_in_the_file_or_not_and_nothing_else_changes(
    text, path, grid, values, unit, read
):
    """`values` are those of the grid in SI units, which `read` finds in a member."""
    case = parse_case(text, vary={path: grid})

    (varied,) = case.varied
    without_grid = parse_case(text).system
    most_changes = 1
    if "materials" in path:
        most_changes = 2  # the material is that of two rods
    assert varied.path == path
    assert varied.values.tolist() == values
    assert varied.unit == unit
    assert case.system.shape == (2,)
    for i, value in enumerate(values):
        member = case.system[i]
        changes = count_changes(member, without_grid)
        assert read(member) == value
        assert changes <= most_changes
        if value != read(without_grid):
            assert changes > 0


def count_changes(system, other):
    """Number of words that differ between two systems in JSON, where a number is one
    word.
    """
    words = json.dumps(system.to_dict()).split()
    other_words = json.dumps(other.to_dict()).split()
    changes = 0
    for word, other_word in zip(words, other_words, strict=True):
        changes += word != other_word
    return changes


def test_parameters_of_a_family_have_the_paths_that_were_varied():
    paths = ["gravity", "contacts.2.gap", "ends.left.value.at.0", "bodies.0.mass"]
    vary = dict.fromkeys(paths, "1,2")

    system = parse_case(ALL_KINDS, vary=vary).system

    assert set(system.parameters) == set(paths)


@pytest.mark.parametrize(
    ("path", "grid"),
    [
        ("contacts.3.left_radius", "1 cm,0.02"),
        ("materials.ball.youngs_modulus", "1 GPa,2e9"),
    ],
)
def test_radii_and_materials_of_faces_vary_the_stiffness(path, grid):
    """A grid of two values over a radius or a number of a material makes a family over
    the stiffness of the Hertz contact, with the stiffnesses of `Hertz.from_radii`.
    """
    faces = {"left_radius": 0.05, "right_radius": math.inf}
    ball = {"youngs_modulus": 100e9, "density": 5000, "poisson_ratio": 0.3}

    case = parse_case(ALL_KINDS, vary={path: grid})

    (varied,) = case.varied
    _, _, name = path.rpartition(".")
    if "contacts" in path:
        faces[name] = varied.values
    else:
        ball[name] = varied.values
    material = ri.Material("ball", **ball)
    expected = ri.Hertz.from_radii(
        **faces, left_material=material, right_material=STEEL
    )
    system = case.system
    assert system.shape == (2,)
    assert list(system.parameters) == ["contacts.3.stiffness"]
    law = system.contacts[3]
    assert law.stiffness.tolist() == expected.stiffness.tolist()


A_MASS_TO_VARY = A_MASS.replace("mass = 2", "")
NUMBERS_LEFT_OUT = (
    HEAD
    + A_MASS_TO_VARY
    + A_ROD
    + A_ROD
    + LAW
    + "'spring'\n"
    + CONTACT
    + LEFT
    + "'force'"
)
NUMBERS_GRIDS = {
    "bodies.0.mass": "1,2",
    "contacts.0.stiffness": "1,2",
    "ends.left.value": "1,2",
}


def test_numbers_may_be_left_to_the_grid_and_are_missing_without_it():
    """A case file that leaves out three numbers, for which grids of two values are
    given, is read as a family. Without one of the grids, that number is the only
    mistake.
    """
    case = parse_case(NUMBERS_LEFT_OUT, vary=NUMBERS_GRIDS)

    without_value = NUMBERS_GRIDS.copy()
    del without_value["ends.left.value"]
    messages = problems(NUMBERS_LEFT_OUT, without_value)
    assert case.system.shape == (2, 2, 2)
    assert list(messages) == ["ends.left.value"]


def test_nothing_is_said_of_grids_of_a_law_or_an_end_that_is_unknown():
    """Only the unknown law and the unknown kind of end are mistakes."""
    text = NUMBERS_LEFT_OUT.replace("spring", "sprung").replace("force", "farce")

    messages = problems(text, NUMBERS_GRIDS)

    assert list(messages) == ["contacts.0.law", "ends.left.kind"]


def test_a_diameter_in_metres_varies_the_area():
    """A grid over three diameters gives the members these round areas; the first is the
    system of the file, whose diameter is the same.
    """
    vary = {"bodies.1.diameter": "1 cm:2 cm:3"}

    case = parse_case(PROFILES_AND_SEGMENTS, vary=vary)

    (axis,) = case.varied
    assert axis.unit == "m"
    areas = []
    for i in range(3):
        rod = case.system[i].bodies[1]
        segment = rod.segments[0]
        areas.append(segment.area)
    diameters = np.array([0.01, 0.015, 0.02])
    expected = math.pi / 4 * diameters**2
    assert areas == pytest.approx(expected, rel=1e-15)
    # The diameter in the file is 1 cm, too.
    of_file = parse_case(PROFILES_AND_SEGMENTS).system
    assert case.system[0] == of_file


def test_the_first_to_vary_is_the_first_axis():
    """Three numbers vary: the shape of the family and one member are compared."""
    gaps = [0, 1, 2]
    lengths = [1, 2, 3, 4]
    diameters = [0.01, 1]
    vary = {
        "contacts.1.gap": "0,1,2",
        "bodies.1.length": "1:4:4",
        "bodies.1.diameter": "0.01:1:2",
    }

    case = parse_case(PROFILES_AND_SEGMENTS, vary=vary)

    system = case.system
    assert system.shape == (3, 4, 2)
    paths = [axis.path for axis in case.varied]
    assert paths == list(vary)
    varied_gap = system.gaps[1]
    assert varied_gap.shape == (3, 1, 1)
    member = system[2, 1, 1]
    assert member.gaps[1] == gaps[2]
    rod = member.bodies[1]
    assert rod.length == lengths[1]
    area = math.pi / 4 * diameters[1] ** 2
    assert rod.segments[0].area == area


def test_a_file_read_with_a_grid_is_a_family_and_without_one_a_collision(tmp_path):
    """A file read with two lengths is a family of shape (2,); with no lengths it is
    read as by `read_case` alone.
    """
    path = tmp_path / "case.toml"
    path.write_text(PROFILES_AND_SEGMENTS)

    without_grid = read_case(path, {})
    family = read_case(path, {"bodies.1.length": "1,2"})

    assert without_grid == read_case(path)
    assert without_grid.system.shape == ()
    assert family.system.shape == (2,)


@pytest.mark.parametrize(
    ("grid", "values"),
    [
        ("0.1", [0.1]),
        ("0.1,0.3,0.2", [0.1, 0.3, 0.2]),
        (" 10 mm , 2 cm,3e-2", [0.01, 0.02, 0.03]),
        ("50 mm:1 m:3", [0.05, 0.525, 1.0]),
        ("1 : 0.5 : 2", [1.0, 0.5]),
        ("2:2:1", [2.0]),
        ("1e-5:1e-3:3:log", [1e-5, 1e-4, 1e-3]),
        ("8 m:1:004: log", [8.0, 4.0, 2.0, 1.0]),
        ("1e-150:1e150:3:log", [1e-150, 1.0, 1e150]),
    ],
)
def test_grids_have_their_values_and_hold_both_ends_exactly(grid, values):
    case = parse_case(HEAD + A_ROD + A_WALL, vary={"contacts.0.gap": grid})

    (varied,) = case.varied
    read = varied.values
    assert read == pytest.approx(values, rel=1e-14)
    assert read[0] == values[0]
    assert read[-1] == values[-1]


@given(
    ends=st.tuples(*[st.floats(1e-3, 1e3)] * 2),
    count=st.integers(2, 300),
    log=st.booleans(),
)
def test_random_grids_hold_both_ends_exactly_at_equal_steps(ends, count, log):
    """A random grid "start:end:count", linear or logarithmic, has both ends exactly,
    the number of values, and equal steps or ratios.
    """
    start, end = ends
    grid = f"{start!r}:{end!r}:{count}"
    if log:
        grid += ":log"

    case = parse_case(HEAD + A_ROD + A_WALL, vary={"contacts.0.gap": grid})

    values = case.varied[0].values
    steps = np.diff(values)
    if log:
        steps = np.diff(np.log(values))
    assert values[0] == start
    assert values[-1] == end
    assert len(values) == count
    assert steps == pytest.approx(steps.mean(), rel=1e-6, abs=1e-12)


LEAD = "[materials.lead]\nyoungs_modulus = '16 GPa'\ndensity = 11340\n"
WITH_UNTIL = PROFILES_AND_SEGMENTS + "[solve]\nuntil = 1\n"


@pytest.mark.parametrize(
    ("text", "path", "grid", "where", "said"),
    [
        # what is no grid
        *(
            (HEAD + A_ROD, "bodies.0.length", grid, "bodies.0.length", said)
            for grid, said in [
                ("", "cannot read '' as length"),
                (
                    "1:2",
                    "must be start:stop:count, start:stop:count:log or a list such as "
                    "0.1,0.2,0.4, with 1 to 10000000 values; got '1:2'",
                ),
                *(
                    (text, "must be start:stop:count")
                    for text in (
                        "1:2:3:lin",
                        "1:2:0",
                        "1:2:2.5",
                        "1:2:\u00b2",
                        "1:2:10000001",
                        "1:2:" + "9" * 5000,
                        {"start": 1},
                    )
                ),
                ("1:2:1", "cannot be at both ends"),
                ("1:2 kg:3", "'kg' is a unit of mass"),
                ("1,,2", "cannot read '' as length"),
                ("0:1:3:log", "needs ends above 0 for equal ratios, got '0:1:3:log'"),
                ("1:inf:3", "it is not a decimal number"),
                ("-1e308:1e308:3", "are too far apart"),
            ]
        ),
        # numbers that the model refuses are named by their place
        (
            PROFILES_AND_SEGMENTS,
            "bodies.1.length",
            "1,0,2",
            "bodies.1.length[1]",
            "positive number of metres, got 0.0",
        ),
        (
            PROFILES_AND_SEGMENTS,
            "bodies.1.diameter",
            "1,2,-1",
            "bodies.1.diameter[2]",
            "must be a finite positive number of metres, got -1.0",
        ),
        (
            PROFILES_AND_SEGMENTS,
            "bodies.1.velocity.at.0",
            "0.1,0.4",
            "bodies.1.velocity.at.0[1]",
            "inside the rod",
        ),
        (
            PROFILES_AND_SEGMENTS,
            "bodies.1.diameter",
            "1,1e90",
            "bodies.1.area[1]",
            "from 1e-150 to 1e+150",
        ),
        # what cannot vary
        *(
            (WITH_UNTIL, path, "1,2", path, said)
            for path, said in [
                ("bodies.1.lenght", "perhaps 'bodies.1.length' is meant"),
                ("bodies.7.velocity", "perhaps 'bodies.2.velocity' is meant"),
                (
                    "bodies.2.length",
                    "perhaps one of bodies.2.segments.0.length, bodies.2.segm",
                ),
                (
                    "bodies.1.velocity.values.2",
                    "use one of bodies.1.velocity.values.0, bodies.1.velocity.values.1",
                ),
                ("bodies.0.length", "use one of bodies.0.velocity"),
                (
                    "bodies.1.stiffness",
                    "use one that begins with bodies.1.length, bodies.1.area",
                ),
                ("contacts.2.gap", "perhaps 'contacts.1.gap' is meant"),
                ("materials.a.b.dens", "perhaps 'materials.a.b.density' is meant"),
                ("schema", "is no number that can vary; use one that begins with "),
                ("", "is no number that can vary"),
                ("x", "use one that begins with materials, "),
                ("x", ", bodies, contacts"),
            ]
        ),
        # what changes nothing
        (
            ALL_KINDS,
            "materials.ball.density",
            "1,2",
            "materials.ball.density",
            "changes nothing",
        ),
        (
            HEAD + LEAD + A_ROD,
            "materials.lead.density",
            "1,2",
            "materials.lead.density",
            "changes nothing in this row",
        ),
    ],
)
def test_mistakes_of_grids_are_named(text, path, grid, where, said):
    """`where` is the path of the mistake, and `said` a part of its message."""
    messages = problems(text, {path: grid})
    assert list(messages) == [where]
    assert said in messages[where]
    if path == "x":
        # A long choice names every object.
        assert "..." not in messages[where]


@pytest.mark.parametrize("entry", ["area = 1e-4", "diameter = 0.01"])
@pytest.mark.parametrize("varied", [("area", "diameter"), ("area",), ("diameter",)])
def test_of_area_and_diameter_only_the_one_in_the_file_may_vary(entry, varied):
    """Grids over area, diameter or both: only that over the number in the file alone
    makes a family; the others are refused.
    """
    text = HEAD + A_ROD.replace("area = 1e-4", entry)
    vary = {f"bodies.0.{name}": "0.01,0.02" for name in varied}
    name_in_file, _, _ = entry.partition(" ")

    if varied == (name_in_file,):
        family = parse_case(text, vary=vary).system
        assert family.shape == (2,)
    else:
        messages = problems(text, vary)
        said = "give either area or diameter, not both"
        assert messages == {"bodies.0.diameter": said}


@pytest.mark.parametrize("other", ["bodies.0.strain", "contacts.0.gap"])
def test_too_many_collisions_are_refused_before_any_is_laid_out(other):
    """Two grids of 10000 values and one of two make 200 million members."""
    grids = {
        "bodies.0.length": "1:2:10000",
        "bodies.0.velocity": "1,2",
        other: "0:1:10000",
    }
    members = 10000 * 2 * 10000

    (message,) = problems(HEAD + A_ROD + A_WALL, grids).values()

    sentence = f"makes a family of {members} members, more than 10000000; take one part"
    assert sentence in message


PILE = """
schema = 1
bodies = [
    {kind = "mass", mass = 4000, velocity = 3},
    {kind = "rod", length = 15, area = 1e-2, material = "steel"},
    {kind = "wall"},
]
contacts = [
    {law = "spring", stiffness = 5e8},
    {law = "yielding", stiffness = 1e8, yield_force = 1e5},
]
"""


def test_a_number_follows_another_one_by_a_factor():
    """In each member, the yield force is 2.5 mm times the stiffness, which varies; it
    is no axis of the family.
    """
    stiffnesses = [80e6, 160e6, 240e6]
    vary = {
        "contacts.1.yield_force": "2.5 mm*contacts.1.stiffness",
        "contacts.1.stiffness": "80MN/m:240MN/m:3",
        "bodies.1.length": "10,20",
    }

    case = parse_case(PILE, vary=vary)

    assert case.system.shape == (3, 2)
    paths = [axis.path for axis in case.varied]
    assert paths == ["contacts.1.stiffness", "bodies.1.length"]
    last_member = case.system[2, 1]
    _, toe = last_member.contacts
    stiffness = stiffnesses[2]
    yield_force = 2.5e-3 * stiffness
    assert toe.stiffness == stiffness
    assert toe.yield_force == pytest.approx(yield_force, rel=1e-15)


@pytest.mark.parametrize(
    ("force", "stiffness"),
    [("R", "R/2.5mm"), ("1*R", "1 * R / 2.5 mm"), ("R*1", "1 mm * R / 2.5 mm^2")],
)
def test_several_numbers_follow_a_variable(force, stiffness):
    """A grid over a variable R, a resistance, with formulas of it: the yield force of
    the toe is R, and the stiffness R over 2.5 mm, in both members; R is the only axis.
    """
    vary = {
        "R": "200 kN, 1 MN",
        "contacts.1.yield_force": force,
        "contacts.1.stiffness": stiffness,
    }

    case = parse_case(PILE, vary=vary)

    (axis,) = case.varied
    assert axis.path == "R"
    assert axis.unit == "N"
    assert axis.values.tolist() == [200e3, 1e6]
    for i, resistance in enumerate(axis.values):
        toe = case.system[i].contacts[1]
        assert toe.yield_force == resistance
        assert toe.stiffness == pytest.approx(resistance / 2.5e-3, rel=1e-15)


@pytest.mark.parametrize(
    ("vary", "path", "said"),
    [
        (
            {"contacts.1.stiffness": "2mm*contacts.1.yield", "bodies.1.length": "1,2"},
            "contacts.1.stiffness",
            "is tied to nothing that varies, got '2mm*contacts.1.yield'; write "
            "FACTOR*NAME with one of bodies.1.length",
        ),
        (
            {"contacts.1.stiffness": "2*contacts.1.yield_force"},
            "contacts.1.stiffness",
            "vary the number to which it is tied, too",
        ),
        ({"R": "1:2:3"}, "R", "is no number that can vary"),
        (
            {"R": "1:2:3", "contacts.1.stiffness": "2 furlong*R"},
            "contacts.1.stiffness",
            "unknown unit 'furlong'",
        ),
        (
            {"R": "1:2:3", "contacts.1.stiffness": "R/0"},
            "contacts.1.stiffness",
            "divides by 0, got 'R/0'",
        ),
        (
            {"R": "1:x:3", "contacts.1.stiffness": "R"},
            "contacts.1.stiffness",
            "cannot read 'x'",
        ),
        (
            {"R": "1:2:3", "S": "2*R", "contacts.1.stiffness": "S"},
            "contacts.1.stiffness",
            "is tied to S, which is tied itself; tie it to a grid",
        ),
        (
            {"R": "-1:2:3", "contacts.1.stiffness": "R"},
            "contacts.1.stiffness[0]",
            "positive number",
        ),
        (
            {"R": "1:2:3", "contacts.1.stifness": "R"},
            "contacts.1.stifness",
            "perhaps 'contacts.1.stiffness' is meant",
        ),
    ],
)
def test_mistakes_of_ties_are_named(vary, path, said):
    assert said in problems(PILE, vary)[path]


@pytest.mark.parametrize(
    ("vary", "path", "said"),
    [
        (
            {"h": "500mm:1500mm:3", "bodies.0.velocity": "h"},
            "bodies.0.velocity",
            "is in m/s, but 'h' is in m; tie it to such a quantity",
        ),
        (
            {"R": "200kN:1MN:3", "contacts.1.stiffness": "R*2.5mm"},
            "contacts.1.stiffness",
            "is in N/m, but 'R*2.5mm' is in N m; tie it to such a quantity, or give "
            "the factor its unit, as in R/2.5mm for a stiffness",
        ),
        (
            {"R": "200kN:1MN:3", "contacts.1.stiffness": "400*R"},
            "contacts.1.stiffness",
            "is in N/m, but '400*R' is in N",
        ),
        (
            {"bodies.1.length": "1:2:3", "contacts.1.stiffness": "bodies.1.length"},
            "contacts.1.stiffness",
            "is in N/m, but 'bodies.1.length' is in m",
        ),
    ],
)
def test_ties_to_another_quantity_are_refused_with_both_units(vary, path, said):
    assert said in problems(PILE, vary)[path]


def test_a_variable_without_unit_stands_for_any_quantity():
    """The same variable is a velocity, and times 0.5 a length."""
    vary = {"x": "1,2", "bodies.0.velocity": "x", "bodies.1.length": "0.5*x"}

    (axis,) = parse_case(PILE, vary=vary).varied

    assert axis.unit == ""


@pytest.mark.parametrize("grid", [5, [], np.array(5.0), {}, None])
def test_the_grid_of_a_variable_must_be_text_or_a_list(grid):
    messages = problems(PILE, {"R": grid, "bodies.0.velocity": "R"})

    assert messages["bodies.0.velocity"].startswith("must be start:stop:count")


HEIGHTS = np.array([0.5, 1.0, 1.5])  # m


@pytest.mark.parametrize(
    ("grid", "values"),
    [
        ([1.0, 2], [1.0, 2.0]),
        ((3.0,), [3.0]),
        (["1 m/s", "200 cm/s"], [1.0, 2.0]),
        (np.sqrt(2 * 9.81 * HEIGHTS), np.sqrt(2 * 9.81 * HEIGHTS).tolist()),
        (np.array([1, 2]), [1.0, 2.0]),
    ],
)
def test_a_list_or_an_array_takes_the_place_of_a_grid(grid, values):
    """Velocities as a list or an array, beside a grid of lengths, are read with their
    unit, and the last member has the last one.
    """
    vary = {"bodies.1.length": "10,20", "bodies.0.velocity": grid}

    case = parse_case(PILE, vary=vary)

    lengths, velocities = case.varied
    assert lengths.values.tolist() == [10.0, 20.0]
    assert velocities.unit == "m/s"
    assert velocities.values.tolist() == values
    last_member = case.system[1, -1]  # [length, velocity]
    first_body = last_member.bodies[0]
    assert first_body.velocity == values[-1]


@pytest.mark.parametrize("grid", [[200e3, 1e6], ["200 kN", "1 MN"]])
def test_numbers_may_be_tied_to_a_list(grid):
    vary = {"R": grid, "contacts.1.yield_force": "R"}

    (axis,) = parse_case(PILE, vary=vary).varied

    assert axis.values.tolist() == [200e3, 1e6]


@pytest.mark.parametrize(
    ("grid", "said"),
    [
        (np.ones((2, 2)), "cannot read [1.0, 1.0] as velocity"),
        ([1.0, math.nan], "cannot read nan as velocity"),
        ([1.0, "2 kg"], "'kg' is a unit of mass"),
        ([], "must be start:stop:count"),
    ],
)
def test_mistakes_of_listed_values_are_named(grid, said):
    messages = problems(PILE, {"bodies.0.velocity": grid})

    assert said in messages["bodies.0.velocity"]


@pytest.mark.parametrize(
    ("vary", "path", "said"),
    [
        (
            {"r": "1,2", "bodies.0.mass": "r*bodies.1.length"},
            "bodies.0.mass",
            "has bodies.1.length as a factor, which does not vary, got "
            "'r*bodies.1.length'; write its value in its place",
        ),
        (
            {"h": "2ft:4ft:3", "bodies.0.velocity": "sqrt(2*9.81*h)"},
            "bodies.0.velocity",
            "must be a product with h, as FACTOR*h or h/DIVISOR, got "
            "'sqrt(2*9.81*h)'; else compute its values and list them, and leave out h",
        ),
        (
            {"h": "1,2", "bodies.0.velocity": "h + 1"},
            "bodies.0.velocity",
            "must be a product with h",
        ),
        (
            {"R": "1,2", "L": "3,4", "bodies.0.mass": "R*L"},
            "bodies.0.mass",
            "is a product with L, which varies, too, got 'R*L'; tie it to one of both",
        ),
    ],
)
def test_ties_that_are_no_product_with_one_number_have_one_mistake(vary, path, said):
    messages = problems(PILE, vary)

    assert [*messages] == [path]
    assert said in messages[path]


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("bodies.1.material", "write a case with each material, and solve each by"),
        (
            "contacts.0.stiffness",
            'is no number that can vary; give contacts.0 a law that has it, one of "jo',
        ),
        ("contacts.0.stifness", "use one of contacts.0.gap, contacts.0.restitution"),
        ("contacts.1.yield", "perhaps 'contacts.1.yield_force' is meant"),
    ],
)
def test_what_cannot_vary_has_a_remedy_that_works(path, said):
    """`said` is the remedy in the message."""
    text = PILE.replace('{law = "spring", stiffness = 5e8}', "{}")

    assert said in problems(text, {path: "1,2"})[path]


def test_a_variable_may_be_called_like_a_unit():
    vary = {"m": "1 m,2 m", "bodies.1.length": "m", "bodies.0.velocity": "1 m/s"}

    assert parse_case(PILE, vary=vary).system.shape == (2, 1)


def test_32_numbers_may_vary_and_33_are_refused():
    """NumPy has no more axes."""
    springs = (LAW + "'spring'\nstiffness = 1\n") * 40
    text = HEAD + A_ROD + A_MASS * 40 + springs
    grids_of_32 = {f"bodies.{i}.mass": "1" for i in range(1, 33)}
    grids_of_33 = grids_of_32 | {"bodies.33.mass": "1"}

    family = parse_case(text, vary=grids_of_32).system
    messages = problems(text, grids_of_33)

    message = "is one of 33 numbers; at most 32 vary at once"
    assert family.shape == (1,) * 32
    assert messages == {"bodies.33.mass": message}


def test_all_mistakes_at_once_with_those_of_the_grids():
    """A wrong case file with six grids, five of them wrong: exactly these six paths are
    reported.
    """
    messages = problems(
        HEAD
        + "[materials]\nx = 3\n"
        + A_ROD.replace("0.4", "-1")
        + "[[bodies]]\nkind = 'blob'\n"
        + A_WALL,
        {
            "bodies.0.length": "1:2",
            "bodies.0.area": "1 m,2 m^2",
            "bodies.0.colour": "1,2",
            "bodies.1.length": "1,2",
            "materials.x.density": "1,2",
            "contacts.0.gap": "-1 m,1",
        },
    )
    # Nothing is said of the grids of a body of unknown kind, and of a material that is
    # no table: these mistakes are named already.
    assert set(messages) == {
        "materials.x",
        "bodies.0.length",
        "bodies.0.area",
        "bodies.0.colour",
        "bodies.1.kind",
        "contacts.0.gap[0,0,0,0,0,0]",
    }


@given(
    path=st.sampled_from(
        ["bodies.0.length", "contacts.0.gap", "x", "bodies.0.velocity.at.0"]
    ),
    grid=st.text(alphabet="0123456789.,:-+e kgm%log\n", max_size=12),
)
def test_no_grid_escapes_as_another_error(path, grid):
    """A grid of any text makes a family, or is refused with its problems."""
    try:
        case = parse_case(HEAD + A_ROD + A_WALL, vary={path: grid})
    except ri.InvalidModel as error:
        # Some grids are right, so that `pytest.raises` would not do.
        assert error.problems  # noqa: PT017
    else:
        assert case.system.shape == (len(case.varied[0].values),)


@pytest.mark.parametrize(
    ("path", "speeds"),  # of both rods in the second member
    [
        ("materials.steel.wave_speed", (6000, 6000)),
        ("bodies.1.material.wave_speed", (STEEL.wave_speed, 6000)),
    ],
)
def test_materials_of_the_library_vary_by_name_and_by_body(path, speeds):
    """`speeds` are the wave speeds of both rods of the second member."""
    family = parse_case(HEAD + A_ROD + A_ROD, vary={path: "5000,6000"}).system

    for body, speed in zip(family[1].bodies, speeds, strict=True):
        assert body.segments[0].wave_speed == pytest.approx(speed, rel=1e-15)


def test_a_grid_may_stand_in_for_a_profile():
    """A velocity that has steps in the case file gets a grid of two numbers: a family
    of two uniform velocities.
    """
    text = HEAD + A_ROD + "velocity = {values = [1, 0], at = [0.1]}\n" + A_WALL

    case = parse_case(text, vary={"bodies.0.velocity": "1,2"})

    assert case.system.shape == (2,)
    assert case.system[1].bodies[0].velocity == 2.0
