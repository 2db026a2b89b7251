"""What `rodimpact help` says of case files and units is what the reader takes."""

import tomllib

import pytest

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.model.bodies import BODIES, Material, Segment
from rodimpact.model.ends import ENDS
from rodimpact.model.laws import CONTACT_LAWS
from rodimpact.storage.case_reading import case_from
from rodimpact.storage.case_reference import sections
from rodimpact.units import UNITS, parse

ROD = {"kind": "rod", "length": 1, "area": 1e-4, "material": "steel"}


def whole(example):
    """A case around one table."""
    data = {"schema": 1, "bodies": [ROD, ROD], "solve": {"until": 1e-4}, **example}
    if "segments" in data["bodies"]:
        data["bodies"] = [{"kind": "rod", **data["bodies"]}]
    elif len(data["bodies"]) == 1:
        data["bodies"] = [ROD, *data["bodies"]]
    return data


@pytest.mark.parametrize("table", sections(), ids=lambda table: table.title)
def test_each_example_is_read_and_every_key_that_is_told_is_known(table):
    assert case_from(whole(tomllib.loads(table.example)))
    wrong = [
        entry.key for entry in table.entries if f"{entry.key} =" not in table.example
    ]
    lines = [f"{key} = []" for key in wrong if key != "law"]
    data = whole(tomllib.loads("\n".join([table.example, *lines, "nonsense = 0"])))
    with pytest.raises(ri.InvalidModel) as mistakes:
        case_from(data)
    unknown = {
        path.split(".")[-1]
        for path, text in mistakes.value.problems
        if text.startswith("unknown key")
    }
    assert unknown == {"nonsense"}


def test_every_class_of_the_model_is_told_with_all_its_numbers():
    told = {table.title: {entry.key for entry in table.entries} for table in sections()}
    kinds = {"[materials.NAME]": Material, "[[bodies.segments]]": Segment}
    kinds |= {f'[[bodies]] kind = "{kind}"': body for kind, body in BODIES.items()}
    kinds |= {f'[[contacts]] law = "{name}"': law for name, law in CONTACT_LAWS.items()}
    kinds |= {f'[ends.SIDE] kind = "{kind}"': end for kind, end in ENDS.items()}
    for title, kind in kinds.items():
        assert told[title] >= set(kind.fields)


def test_help_tells_every_table_and_every_unit(capsys):
    assert main(["help"]) == 0
    topics = capsys.readouterr().out
    assert all(f"rodimpact help {topic} " in topics for topic in ("case", "units"))
    assert main(["help", "case"]) == 0
    text = capsys.readouterr().out
    assert all(table.title in text and table.example in text for table in sections())
    assert main(["help", "units"]) == 0
    rows = capsys.readouterr().out.splitlines()[1:-2]
    assert [row.split("  ")[0] for row in rows] == list(UNITS)
    for dimension, row in zip(UNITS, rows, strict=True):
        si, *others = (
            row.removeprefix(dimension).strip().replace("  ", ", ").split(", ")
        )
        assert parse(f"1 {si}" if si != "1" else "1", dimension) == 1
        assert all(
            parse(f"1 {unit.strip()}", dimension) > 0 for unit in others if unit.strip()
        )
