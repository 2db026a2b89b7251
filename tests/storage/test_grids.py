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


RICH = """
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
            (RICH + contacts, *more)
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
def test_any_number_may_vary_given_in_the_file_or_not(
    text, path, grid, values, unit, read
):
    case = parse_case(text, vary={path: grid})
    [varied] = case.varied
    assert (varied.path, varied.values.tolist(), varied.unit) == (path, values, unit)
    assert case.system.shape == (2,)
    alone = parse_case(text).system
    for i in range(2):
        assert read(case.system[i]) == values[i]
        # and nothing else has changed
        described, plain = (json.dumps(s.to_dict()) for s in (case.system[i], alone))
        changes = [
            (a, b)
            for a, b in zip(described.split(), plain.split(), strict=True)
            if a != b
        ]
        assert len(changes) <= (2 if "materials" in path else 1)
        assert changes or values[i] == read(alone)


def test_parameters_of_a_family_have_the_paths_that_were_varied():
    paths = ["gravity", "contacts.2.gap", "ends.left.value.at.0", "bodies.0.mass"]
    system = parse_case(ALL_KINDS, vary=dict.fromkeys(paths, "1,2")).system
    assert {*system.parameters} == {*paths}


@pytest.mark.parametrize(
    ("path", "grid"),
    [
        ("contacts.3.left_radius", "1 cm,0.02"),
        ("materials.ball.youngs_modulus", "1 GPa,2e9"),
    ],
)
def test_radii_and_materials_of_faces_vary_the_stiffness(path, grid):
    case = parse_case(ALL_KINDS, vary={path: grid})
    assert case.system.shape == (2,)
    assert list(case.system.parameters) == ["contacts.3.stiffness"]
    faces = {"left_radius": 0.05, "right_radius": math.inf}
    ball = {"youngs_modulus": 100e9, "density": 5000, "poisson_ratio": 0.3}
    (faces if "contacts" in path else ball)[path.split(".")[-1]] = case.varied[0].values
    law = ri.Hertz.from_radii(
        **faces, left_material=ri.Material("ball", **ball), right_material=STEEL
    )
    assert case.system.contacts[3].stiffness.tolist() == law.stiffness.tolist()


def test_numbers_may_be_left_to_the_grid():
    text = (
        HEAD
        + A_MASS.replace("mass = 2", "")
        + A_ROD
        + A_ROD
        + LAW
        + "'spring'\n"
        + CONTACT
    )
    text += LEFT + "'force'"
    grids = {
        "bodies.0.mass": "1,2",
        "contacts.0.stiffness": "1,2",
        "ends.left.value": "1,2",
    }
    case = parse_case(text, vary=grids)
    assert case.system.shape == (2, 2, 2)
    assert list(problems(text, dict(list(grids.items())[:2]))) == ["ends.left.value"]
    # beside a law or a kind that is none, nothing is said of their numbers
    said = problems(text.replace("spring", "sprung").replace("force", "farce"), grids)
    assert list(said) == ["contacts.0.law", "ends.left.kind"]


def test_a_diameter_varies_the_area():
    case = parse_case(RICH, vary={"bodies.1.diameter": "1 cm:2 cm:3"})
    areas = [case.system[i].bodies[1].segments[0].area for i in range(3)]
    assert areas == pytest.approx(
        [math.pi / 4 * d * d for d in (0.01, 0.015, 0.02)], rel=1e-15
    )
    assert case.system[0] == parse_case(RICH).system  # its diameter is 1 cm
    assert case.varied[0].unit == "m"


def test_the_first_to_vary_is_the_first_axis():
    vary = {
        "contacts.1.gap": "0,1,2",
        "bodies.1.length": "1:4:4",
        "bodies.1.diameter": "0.01:1:2",
    }
    case = parse_case(RICH, vary=vary)
    assert case.system.shape == (3, 4, 2)
    assert [v.path for v in case.varied] == list(vary)
    assert case.system.gaps[1].shape == (3, 1, 1)
    assert case.system[2, 1, 0].gaps[1] == 2.0
    assert case.system[2, 1, 0].bodies[1].length == 2.0
    assert case.system[2, 1, 1].bodies[1].segments[0].area == math.pi / 4


def test_nothing_to_vary_makes_one_collision(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(RICH)
    assert read_case(path, {}) == read_case(path)
    assert read_case(path, {}).system.shape == ()
    assert read_case(path, {"bodies.1.length": "1,2"}).system.shape == (2,)


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
def test_grids(grid, values):
    [varied] = parse_case(HEAD + A_ROD + A_WALL, vary={"contacts.0.gap": grid}).varied
    assert varied.values == pytest.approx(values, rel=1e-14)
    assert varied.values[[0, -1]].tolist() == [values[0], values[-1]]


@given(
    ends=st.tuples(*[st.floats(1e-3, 1e3)] * 2),
    count=st.integers(2, 300),
    log=st.booleans(),
)
def test_grids_hold_both_ends_exactly(ends, count, log):
    grid = f"{ends[0]!r}:{ends[1]!r}:{count}" + ":log" * log
    [varied] = parse_case(HEAD + A_ROD + A_WALL, vary={"contacts.0.gap": grid}).varied
    assert (varied.values[0], varied.values[-1]) == ends
    assert len(varied.values) == count
    spread = np.diff(np.log(varied.values) if log else varied.values)
    assert spread == pytest.approx(spread.mean(), rel=1e-6, abs=1e-12)


LEAD = "[materials.lead]\nyoungs_modulus = '16 GPa'\ndensity = 11340\n"
UNTIL = RICH + "[solve]\nuntil = 1\n"


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
                        [1, 2],
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
            RICH,
            "bodies.1.length",
            "1,0,2",
            "bodies.1.length[1]",
            "positive number of metres, got 0.0",
        ),
        (
            RICH,
            "bodies.1.diameter",
            "1,2,-1",
            "bodies.1.diameter[2]",
            "must be a finite positive number of metres, got -1.0",
        ),
        (
            RICH,
            "bodies.1.velocity.at.0",
            "0.1,0.4",
            "bodies.1.velocity.at.0[1]",
            "inside the rod",
        ),
        (
            RICH,
            "bodies.1.diameter",
            "1,1e90",
            "bodies.1.area[1]",
            "from 1e-150 to 1e+150",
        ),
        # what cannot vary
        *(
            (UNTIL, path, "1,2", path, said)
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
def test_mistakes_of_grids(text, path, grid, where, said):
    messages = problems(text, {path: grid})
    assert list(messages) == [where]
    assert said in messages[where]
    assert (
        path != "x" or "..." not in messages[where]
    )  # a long choice names every object


@pytest.mark.parametrize("given", ["area = 1e-4", "diameter = 0.01"])
@pytest.mark.parametrize("varied", [("area", "diameter"), ("area",), ("diameter",)])
def test_area_and_diameter_do_not_go_together(given, varied):
    text = HEAD + A_ROD.replace("area = 1e-4", given)
    vary = {f"bodies.0.{name}": "0.01,0.02" for name in varied}
    if len(varied) == 1 and given.startswith(varied):
        assert parse_case(text, vary=vary).system.shape == (2,)
    else:
        said = {"bodies.0.diameter": "give either area or diameter, not both"}
        assert problems(text, vary) == said


@pytest.mark.parametrize("other", ["bodies.0.strain", "contacts.0.gap"])
def test_too_many_collisions_are_refused_before_any_is_laid_out(other):
    grids = {
        "bodies.0.length": "1:2:10000",
        "bodies.0.velocity": "1,2",
        other: "0:1:10000",
    }
    (said,) = problems(HEAD + A_ROD + A_WALL, grids).values()
    assert (
        "makes a family of 200000000 members, more than 10000000; take one part" in said
    )


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
    stiffnesses = [80e6, 160e6, 240e6]
    vary = {
        "contacts.1.yield_force": "2.5 mm*contacts.1.stiffness",
        "contacts.1.stiffness": "80MN/m:240MN/m:3",
        "bodies.1.length": "10,20",
    }

    case = parse_case(PILE, vary=vary)

    assert case.system.shape == (3, 2)
    assert [axis.path for axis in case.varied] == list(vary)[1:]
    toe = case.system[2, 1].contacts[1]
    assert toe.stiffness == stiffnesses[2]
    assert toe.yield_force == pytest.approx(2.5e-3 * stiffnesses[2], rel=1e-15)


@pytest.mark.parametrize(
    ("force", "stiffness"),
    [("R", "R/2.5mm"), ("1*R", "400 1/m * R"), ("R*1", "1 * R / 2.5 mm")],
)
def test_several_numbers_follow_a_variable(force, stiffness):
    vary = {
        "R": "200 kN, 1 MN",
        "contacts.1.yield_force": force,
        "contacts.1.stiffness": stiffness.replace("400 1/m", "400"),
    }

    case = parse_case(PILE, vary=vary)

    assert [(axis.path, axis.unit) for axis in case.varied] == [("R", "N")]
    assert case.varied[0].values.tolist() == [200e3, 1e6]
    for i, resistance in enumerate((200e3, 1e6)):
        toe = case.system[i].contacts[1]
        assert toe.yield_force == resistance
        assert toe.stiffness == pytest.approx(400 * resistance, rel=1e-15)


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


def test_more_numbers_than_numpy_has_axes_for_are_refused():
    text = HEAD + A_ROD + A_MASS * 40
    grids = {f"bodies.{i}.mass": "1" for i in range(1, 34)}
    message = "is one of 33 numbers; at most 32 vary at once"
    assert problems(text, grids) == {"bodies.33.mass": message}
    del grids["bodies.33.mass"]
    law = LAW + "'spring'\nstiffness = 1\n"
    assert parse_case(text + law * 40, vary=grids).system.shape == (1,) * 32


def test_all_mistakes_at_once_with_those_of_the_grids():
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
    # of a body of unknown kind, and of a material that is no table, nothing is said
    # twice
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
    try:
        case = parse_case(HEAD + A_ROD + A_WALL, vary={path: grid})
    except ri.InvalidModel as error:
        assert error.problems  # noqa: PT017  (some grids are right)
    else:
        assert case.system.shape == (len(case.varied[0].values),)


@pytest.mark.parametrize(
    ("path", "changed"),
    [
        ("materials.steel.wave_speed", 2),
        ("bodies.1.material.wave_speed", 1),
    ],
)
def test_materials_of_the_library_vary_by_name_and_by_body(path, changed):
    after = parse_case(HEAD + A_ROD + A_ROD, vary={path: "5000,6000"}).system[1]
    speeds = [body.segments[0].wave_speed for body in after.bodies]
    assert speeds[-changed:] == pytest.approx([6000] * changed)
    assert speeds[:-changed] == [STEEL.wave_speed] * (2 - changed)


def test_a_grid_may_stand_in_for_a_profile():
    text = HEAD + A_ROD + "velocity = {values = [1, 0], at = [0.1]}\n" + A_WALL
    case = parse_case(text, vary={"bodies.0.velocity": "1,2"})
    assert case.system.shape == (2,)
    assert case.system[1].bodies[0].velocity == 2.0
