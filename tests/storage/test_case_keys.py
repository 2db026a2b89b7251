"""The page of the manual on case files lists every key that the reader takes, and no
other.
"""

import inspect
import re
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.methods.registry import METHOD_NAMES
from rodimpact.model import GAP
from rodimpact.model.bodies import BODIES, WAVE_SPEED
from rodimpact.model.ends import ENDS
from rodimpact.model.frozen import REQUIRED
from rodimpact.model.lateral_inertia import THEORIES
from rodimpact.model.laws import CONTACT_LAWS, FACE_RADIUS
from rodimpact.model.shaft import SHAFTS
from rodimpact.storage.casefile import case_from
from rodimpact.units import UNITS, parse

PAGE = (Path(__file__).parents[2] / "docs" / "input.md").read_text("utf-8")
ROD = {"kind": "rod", "length": 1, "area": 1e-4, "material": "steel"}
SIGNS = {
    "any": "any number",
    "positive": "> 0",
    "non-negative": ">= 0",
    "positive or infinite": '> 0, or "inf"',
}
KINDS = {"[materials.NAME]": ri.Material, "[[bodies.segments]]": ri.Segment}
KINDS |= {f'[bodies.shaft] kind = "{kind}"': shaft for kind, shaft in SHAFTS.items()}
KINDS |= {f'[[bodies]] kind = "{kind}"': body for kind, body in BODIES.items()}
KINDS |= {f'[[contacts]] law = "{law}"': kind for law, kind in CONTACT_LAWS.items()}
KINDS |= {f'[ends.SIDE] kind = "{kind}"': end for kind, end in ENDS.items()}
KINDS |= {"[solve]": ri.Options}
"""The class that declares the numbers of each table."""


class Key(NamedTuple):
    """A row of the table of keys."""

    unit: str
    takes: str
    default: str


class Table(NamedTuple):
    """A section of the page."""

    text: str
    keys: dict[str, Key]
    example: str


def read_page():
    """{title: Table} of every table of a case file that the page describes."""
    listing = PAGE.partition("## Every table and its keys")[2].partition("\n## ")[0]
    tables = {}
    for section in listing.split("\n### ")[1:]:
        title, _, text = section.partition("\n")
        keys = {}
        for name, row in re.findall(r"^\| `(\w+)` \|(.*)\|$", text, re.M):
            keys[name] = Key(*[cell.strip() for cell in row.split("|")])
        (example,) = re.findall(r"```toml\n(.*?)```", text, re.S)
        tables[title.strip("`")] = Table(text, keys, example)
    return tables


TABLES = read_page()


def complete_case(example):
    """The data of a whole case file with the tables of an example.

    Bodies that the example lacks are `ROD`, so that there are two; an example of
    segments makes a rod alone.
    """
    data = {"schema": 1, "bodies": [ROD, ROD], "solve": {"until": 1e-4}, **example}
    bodies = data["bodies"]
    if "segments" in bodies:
        # [[bodies.segments]] alone makes a table of `bodies`.
        data["bodies"] = [{"kind": "rod", **bodies}]
    elif len(bodies) == 1:
        data["bodies"] = [ROD, *bodies]
    return data


def known_keys(example):
    """Keys that the reader names beside an unknown one in the last table of the
    example.
    """
    with pytest.raises(ri.InvalidModel) as mistakes:
        # The key is like no other, so that the message names all choices.
        case_from(complete_case(tomllib.loads(example + "\nqqqqqqqq = 0")))
    ((_, message),) = mistakes.value.problems
    choices = re.fullmatch(r"unknown key; use one of (.*)", message)[1]
    assert not choices.endswith("...")
    return set(choices.split(", ")) - {"kind", "law"}


@pytest.mark.parametrize("title", TABLES)
def test_the_page_lists_the_keys_that_the_reader_knows(title):
    """The keys that the page on case files lists for a table are those that the reader
    offers for an unknown key in the example of this table.
    """
    keys = set(TABLES[title].keys) - {"law"}
    if title == "At the top":
        keys.add("result")  # written by `save`; the page has a section on it
        other_tables = [title for title in TABLES if title.startswith("[")]
        keys |= {re.search(r"\w+", other)[0] for other in other_tables}
    elif title.startswith("[[contacts]]"):
        keys.add("gap")
    if title == "[[contacts]]":  # a rigid contact, if no law is named
        keys |= set(TABLES['[[contacts]] law = "rigid"'].keys)
    example = TABLES[title].example
    if title.endswith('"hertz"'):
        # The keys for the materials of the faces are known beside radii only.
        example = re.sub("stiffness = .*", "left_radius = 0.02", example)
    assert keys == known_keys(example)


@pytest.mark.parametrize("title", TABLES)
def test_the_example_of_each_table_is_read_and_has_all_required_keys(title):
    table = TABLES[title]
    assert case_from(complete_case(tomllib.loads(table.example)))
    for key, row in table.keys.items():
        if row.default == "required":
            assert re.search(rf"^{key} = ", table.example, re.M)


def test_every_declared_class_has_a_table_that_names_and_explains_it():
    """The page on case files has a table for each declared class, with its name and the
    summary of its docstring.
    """
    assert set(KINDS) <= set(TABLES)
    for title, kind in KINDS.items():
        summary = inspect.getdoc(kind).partition("\n")[0]
        text = TABLES[title].text
        assert f"{{class}}`rodimpact.{kind.__name__}`" in text
        if title != "[solve]":
            assert summary in text


def field_as_written(field):
    """The `Key` of a declared number, as the page writes it."""
    takes = SIGNS.get(field.sign, field.sign)
    if field.many:
        takes = "a list of increasing positive numbers"
    if field.word:
        takes += f', or "{field.word}"'
    if field.along == "time":
        takes += ", or a profile in time"
    elif field.along:
        takes += ", or a profile along the rod"
    if field.default is REQUIRED:
        default = "required"
    elif field.default is None:
        default = "none"
    else:
        default = f"{field.default:g}"
    return Key(field.unit or "1", takes, default)


@pytest.mark.parametrize("title", KINDS)
def test_units_signs_and_defaults_are_those_of_the_declared_numbers(title):
    """The page on case files shows each number of a table with the unit, sign and
    default of its declared field, except for pairs of which one suffices.
    """
    fields = KINDS[title].fields
    if title == '[[bodies]] kind = "rod"':
        fields = ri.Segment.fields | fields
    for name, field in fields.items():
        row = TABLES[title].keys[name]
        expected = field_as_written(field)
        if name == "area":
            expected = expected._replace(default="required, or diameter")
        elif name == "position":
            expected = expected._replace(default="in place of value")
        elif (title, name) == ('[ends.SIDE] kind = "moved"', "value"):
            expected = expected._replace(default="required, or position")
        elif name == "youngs_modulus":
            expected = expected._replace(default="required, or wave_speed")
        elif name == "diameter":
            expected = expected._replace(default="in place of area")
        assert row == expected


def test_units_and_signs_of_numbers_that_belong_to_no_class():
    """The key reference has those that the reader checks."""
    speed = field_as_written(WAVE_SPEED)._replace(default="in place of youngs_modulus")
    assert TABLES["[materials.NAME]"].keys["wave_speed"] == speed
    gravity = field_as_written(ri.System.fields["gravity"])
    assert TABLES["At the top"].keys["gravity"] == gravity
    gap = TABLES["[[contacts]]"].keys["gap"]
    assert gap.takes.startswith(SIGNS[GAP.sign])
    assert gap.unit == GAP.unit
    hertz = TABLES['[[contacts]] law = "hertz"'].keys
    for side in ("left", "right"):
        assert hertz[f"{side}_radius"].takes == SIGNS[FACE_RADIUS.sign]


def test_methods_theories_and_defaults_are_those_that_are_known():
    """The page on case files lists exactly the methods and theories of the package, and
    the defaults of `Options`.
    """
    options = ri.Options()
    solve = TABLES["[solve]"].keys
    assert re.findall('"(.*?)"', solve["method"].takes) == [*METHOD_NAMES]
    for name in ("method", "max_events"):
        assert solve[name].default == str(getattr(options, name))
    for title in ("[[bodies.segments]]", '[[bodies]] kind = "rod"'):
        words = TABLES[title].keys["lateral_inertia"].takes
        assert re.findall('"(.*?)"', words) == [*THEORIES]


def test_help_tells_its_topics_and_the_manual(capsys):
    assert main(["help"]) == 0

    topics = capsys.readouterr().out
    assert "rodimpact help units" in topics
    assert "docs/input.md" in topics


def test_help_on_units_tells_every_unit_that_can_be_read(capsys):
    """`help units` has a row for each dimension, and each unit in it can be read as one
    of this dimension; the first is the SI unit.
    """
    assert main(["help", "units"]) == 0

    # A row holds the dimension, its SI unit, and other units with commas between them.
    rows = capsys.readouterr().out.splitlines()[1:-2]
    assert [row.split("  ")[0] for row in rows] == list(UNITS)
    for dimension, row in zip(UNITS, rows, strict=True):
        units = row.removeprefix(dimension).strip().replace("  ", ", ").split(", ")
        si_unit, *other_units = units
        if si_unit == "1":
            assert parse("1", dimension) == 1
        else:
            assert parse(f"1 {si_unit}", dimension) == 1
        for unit in other_units:
            if unit.strip():
                assert parse(f"1 {unit.strip()}", dimension) > 0
