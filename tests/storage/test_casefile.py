"""Files that are no cases are told as such; the worked cases say what comes out."""

import functools
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from case_texts import A_ROD, HEAD, ROD, STEEL
from exhaustive import few_of
from grid_rows import random_row

import rodimpact as ri
from rodimpact import format_case, parse_case, read_case
from rodimpact.storage.casefile import Case, GaugePlace, case_from

CASES = Path(__file__).parents[2] / "validation" / "cases"


def test_byte_order_mark_and_line_ends_of_windows_are_read(tmp_path):
    path = tmp_path / "case.toml"
    text = (HEAD + A_ROD).replace("\n", "\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())

    assert read_case(path) == Case(ri.System([ROD]), path=str(path))
    assert read_case(str(path)).path == str(path)


# What is no TOML


def file_problem(path):
    """The message with which `read_case` refuses a file as a whole.

    It is one line, told under the name of the file, and hides the error behind it.
    """
    with pytest.raises(ri.InvalidModel) as caught:
        read_case(path)
    ((name, message),) = caught.value.problems
    assert name == str(path)
    assert caught.value.__cause__ is None
    assert "\n" not in message
    return message


def test_files_that_cannot_be_read_are_refused_with_the_reason(tmp_path):
    assert "cannot be read: No such file" in file_problem(tmp_path / "none.toml")
    assert (
        "cannot be read: Is a directory; add the name of a file in it"
        in file_problem(tmp_path)
    )
    assert "cannot be read: Not a directory" in file_problem(f"{__file__}/x.toml")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_pipe_or_a_device_which_may_never_end_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert "it is not a regular file" in file_problem(tmp_path / "pipe")
    assert "it is not a regular file" in file_problem("/dev/zero")


def test_a_file_too_large_for_a_case_is_not_read(tmp_path):
    """The file has 10**12 bytes, which take no space on the disk."""
    path = tmp_path / "sparse.toml"
    with path.open("wb") as file:
        file.truncate(10**12)
    assert file_problem(path) == "has more than 10000000 bytes; is it a case file?"


@pytest.mark.parametrize("value", [None, 1, [], {1: 2}, b"case.toml", object()])
@pytest.mark.parametrize(
    ("function", "name", "kind"),
    [
        (read_case, "path", "the name of a file"),
        (parse_case, "case", "the text of a case file"),
        (format_case, "case", "a Case or a System"),
        (Case, "system", "a System, such as .*"),
    ],
)
def test_a_value_that_is_no_case_at_all_is_refused(function, name, kind, value):
    with pytest.raises(ri.InvalidModel, match=f"^{name}: must be {kind}, got "):
        function(value)


@pytest.mark.parametrize("value", [None, 1, [], b"case.toml", object()])
def test_tables_of_a_case_must_be_a_dict(value):
    with pytest.raises(ri.InvalidModel, match="case: must be the tables of a case fil"):
        case_from(value)


@pytest.mark.parametrize("value", [1, [], {1: 2}, b"case.toml", object()])
def test_grids_of_a_case_must_be_a_dict_of_paths(value):
    with pytest.raises(ri.InvalidModel, match="vary: must name numbers by their paths"):
        parse_case(HEAD + A_ROD, vary=value)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"schema = 1\nlength 3\n", r"not valid TOML: .*line 2"),
        (b"schema = 1\n\nschema = 1\n", r"not valid TOML: .*line 3"),
        (b"[solve]\n[solve]\n", r"not valid TOML: .*line 2"),
        (b"a = " + b"9" * 5000, r"not valid TOML: .* value has 5000 digits$"),
        (b"a = " + b"[" * 50_000, "not valid TOML"),
        (
            b"schema = 1\n\nlength = 400 mm  # long\n",
            r'not valid TOML: .*line 3, column 14\); put text in quotes, "400 mm"$',
        ),
        (b"a = [0.1 m, 0.2]\n", r'line 1.*; put text in quotes, "0.1 m"$'),
        (b"a = {k = 1, b = 5 kg}\n", r'line 1.*; put text in quotes, "5 kg"$'),
        (b'a = "x"\nmaterial = steel\n', r'line 2.*; put text in quotes, "steel"$'),
        (b'a = "x" "400 mm"\n', r"line 1, column \d+\)$"),
        (b"schema = 1\n# L\xe4nge\n", r"not text in UTF-8 \(at line 2\)"),
        (b"PK\x03\x04\x00\xff", "not text in UTF-8|not valid TOML"),
    ],
)
def test_files_that_are_no_toml_are_refused_with_the_line(tmp_path, content, said):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    assert re.search(said, file_problem(path))


# What is written reads back equal


def test_written_cases_read_back_equal():
    """A case with options, a strange file name and two gauges is equal after writing
    and reading.
    """
    case = Case(
        ri.System([ROD]),
        solve={"until": 1e-3, "method": "fronts", "max_events": 5},
        output={"plot": 'a "b" \\ \x7f\n€.png'},
        gauges=(GaugePlace(0, 0.25), GaugePlace(0, 1.0)),
    )
    again = parse_case(format_case(case), source="")
    assert again == case


@pytest.mark.parametrize("count", few_of([15, 40], [15]))
def test_random_systems_come_back_equal_from_toml_and_json(count):
    """`count` random rows are written and read."""
    for seed in range(count):
        system = random_row(seed, driven=True)

        from_toml = parse_case(format_case(system)).system
        text = json.dumps(system.to_dict())
        from_json = ri.System.from_dict(json.loads(text))

        assert from_toml == system, seed
        assert from_toml.digest == system.digest
        assert from_json == system


def test_ends_that_are_mirrored_twice_are_the_same():
    for seed in range(40):
        system = random_row(seed, driven=True)
        assert system.mirrored().mirrored().ends == system.ends, seed


@pytest.mark.parametrize("name", ["two words", "a.b", 'quote"', "Ä", "steel"])
def test_materials_of_any_name_read_back_equal(name):
    material = ri.Material(name, youngs_modulus=0.1, density=1e100, viscosity=3)
    system = ri.System([ri.Rod(0.4, area=1e-4, material=material, velocity=-1e-7)])
    assert parse_case(format_case(system)).system == system


def test_a_family_is_no_case_and_its_member_is_one():
    """`format_case` refuses a family and names its index as the remedy; its text of a
    member is read as an equal system.
    """
    family = ri.System([ri.Rod([1.0, 2.0], area=1e-4, material=STEEL)])
    with pytest.raises(ri.InvalidModel, match=r"shape \(2,\).*system\[index\]"):
        format_case(family)
    member = family[1]
    assert parse_case(format_case(member)).system == member


def test_materials_of_one_name_have_a_table_each():
    """Five rods of four different materials, three of them named steel, are written with
    four tables of materials, and read as the same system. A material is named
    "steel 2", as the writer would name a second steel.
    """
    materials = [
        STEEL,
        ri.Material("steel", youngs_modulus=1e9, density=1e3),
        ri.Material("steel 2", youngs_modulus=1e9, density=2e3),
        ri.Material("steel", youngs_modulus=1e9, density=3e3),
        STEEL,
    ]
    rods = [ri.Rod(1.0, area=1e-4, material=material) for material in materials]
    system = ri.System(rods)

    text = format_case(system)

    different_materials = 4  # the steel of the library stands in two rods
    assert parse_case(text).system == system
    assert text.count("[materials.") == different_materials


def test_a_name_that_no_file_holds_is_refused():
    material = ri.Material("a\udcff", youngs_modulus=1e9, density=1e3)
    system = ri.System([ri.Rod(1.0, area=1e-4, material=material)])
    with pytest.raises(ri.InvalidModel, match=r"^case: .*udcff.*rename"):
        format_case(system)


def test_functions_come_back_as_the_curves_that_they_became():
    """Functions for area, velocity and force became smooth profiles with an error above
    0; the system is equal after writing and reading.
    """

    def pulse(t):
        """A force of 1 kN at 0.1 ms, N."""
        return 1e3 * np.exp(-(((t - 1e-4) / 3e-5) ** 2))

    rod = ri.Rod(
        0.4,
        area=lambda x: 1e-4 + x**2,
        material=STEEL,
        velocity=lambda x: np.sin(9 * x),
    )
    push = ri.Pushed(pulse, duration=2e-4)
    system = ri.System([rod], ends=[push, ri.Free()])
    for profile in (rod.segments[0].area, rod.velocity, push.value):
        assert profile.smooth
        assert profile.error > 0
    assert parse_case(format_case(system)).system == system


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("smooth = 1", "smooth: must be True or False, got 1"),
        ("error = -1", "error: must be a finite non-negative number"),
        ("error = 'a'", "error: must be a number"),
        ("error = [1]", "error: must be a single number"),
        ("erro = 1", "erro: unknown key"),
    ],
)
def test_mistakes_in_the_entries_of_a_curve_are_named(entry, said):
    text = HEAD + A_ROD + f"velocity = {{samples = [1, 2], {entry}}}"
    with pytest.raises(ri.InvalidModel, match=rf"^bodies\.0\.velocity\.{said}"):
        parse_case(text)


# The worked cases say what comes out


@functools.cache
def solved(name):
    """Solution of a worked case, by the name of its file."""
    case = read_case(CASES / f"{name}.toml")
    return ri.solve(case.system, **case.solve)


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda p: p.stem)
def test_every_worked_case_comes_back_equal_and_begins_with_a_comment(path):
    case = read_case(path)
    again = parse_case(format_case(case), source=str(path))
    assert again == case
    assert path.read_text().startswith("# ")


def contact(k, name):
    """A function that reads an attribute of contact k of a solution."""
    return lambda solution: getattr(solution.contacts[k], name)


def episode(k, name):
    """A function that reads an attribute of the first episode of contact k."""
    return lambda solution: getattr(solution.contacts[k].episodes[0], name)


@pytest.mark.parametrize(
    ("name", "read", "said", "rel"),
    [
        ("unequal-rods", lambda s: s.outcome.restitution, 0.4, 1e-12),
        ("unequal-rods", episode(0, "force_end"), 0.1585e-3, 1e-3),
        ("unequal-rods", episode(0, "opening"), 0.3962e-3, 1e-3),
        ("rod-on-wall", episode(0, "start"), 0.5e-3, 1e-6),
        ("rod-on-wall", contact(0, "duration"), 0.38545e-3, 1e-5),
        ("rod-on-wall", contact(0, "peak_force"), 1270.8, 1e-4),
        ("hopkinson-bar", contact(0, "duration"), 51.06e-6, 2e-4),
        (
            "hopkinson-bar",
            lambda s: s.gauge(body=1, x=0.635).strain.min(),
            -1.0e-3,
            1e-2,
        ),
        ("hopkinson-specimen", contact(0, "peak_force"), 7737, 2e-4),
        ("hopkinson-specimen", contact(1, "peak_force"), 0.733 * 7737, 1e-3),
        ("rounded-rod-on-wall", lambda s: s.outcome.restitution, 0.9949, 5e-5),
        ("rounded-rod-on-wall", contact(0, "duration"), 0.1916e-3, 1e-3),
        ("newtons-cradle", lambda s: s.outcome.velocities_after[4], 1.0, 1e-13),
        ("newtons-cradle", episode(3, "opening"), 99.1e-6, 1e-3),
        ("stepped-rods", lambda s: s.outcome.restitution, 0.9434, 5e-5),
        (
            "between-walls",
            lambda s: np.abs(s.mean_velocity(1, np.linspace(0, s.t_end, 99))).max(),
            9,
            1e-9,
        ),
        ("clamped-bar", episode(0, "opening"), 2.0, 1e-15),
        ("lossy-rods", lambda s: s.outcome.restitution, 0.4, 1e-4),
        ("lossy-rods", lambda s: s.ring_down().frequency, 2524, 1e-3),
        ("lossy-rods", lambda s: s.ring_down().modal_decay_time, 1.249e-3, 1e-3),
        ("horn", lambda s: s.velocity(1, 0.0, 3e-6), 0.5, 2e-2),
    ],
)
def test_the_worked_cases_say_what_comes_out(name, read, said, rel):
    """Their comments say it, to as many digits as `rel`, the relative bound, allows."""
    value = read(solved(name))
    assert value == pytest.approx(said, rel=rel)
