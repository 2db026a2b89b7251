"""The manual names the keys of [result], and the record holds all that an outcome
finds.
"""

import re
from pathlib import Path

import rodimpact as ri
from rodimpact.methods.run import MEASURES, ContactTally
from rodimpact.storage.saved_result import BY_BODY, BY_CONTACT, OUTCOME_ENERGIES, WORDS

MANUAL = Path(__file__).parents[2] / "docs" / "input.md"
FOLLOW = {"bodies", "masses", "unilateral", "driven"}
"""Entries of an outcome that follow from the system alone."""
CHECKS = {"momentum_residual", "energy_residual"}


def keys_under(head):
    """Keys of the table of the manual whose first column has this head."""
    text = MANUAL.read_text(encoding="utf-8")
    [rows] = re.findall(
        rf"\n\| key of `{re.escape(head)}` \|.*\n\|-.*\n((?:\|.*\n)+)", text
    )
    return [re.match(r'\| `"?([\w. ]+)"?` \|', row)[1] for row in rows.splitlines()]


def test_the_manual_names_every_key():
    assert keys_under("[result]") == [*WORDS, "final"]
    assert keys_under("[result.numbers]") == [
        *(f"{name}.I" for name in BY_BODY),
        *(f"{name}.K" for name in BY_CONTACT),
        *OUTCOME_ENERGIES,
    ]
    assert keys_under("[result.accuracy]") == list(MEASURES)


def test_files_of_earlier_versions_lack_later_energies(tmp_path):
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    path = tmp_path / "run.toml"
    ri.solve(ri.System([rod, ri.Wall()])).save(path)
    lines = path.read_text().splitlines()
    earlier = [line for line in lines if "soil_work" not in line]
    earlier = [line for line in earlier if "drag_work" not in line]
    path.write_text("\n".join(earlier))

    case = ri.read_case(path)

    assert len(earlier) == len(lines) - 2
    assert case.result.numbers["drag_work"] == case.result.numbers["soil_work"] == 0.0


def test_a_record_holds_all_that_an_outcome_finds():
    names = set(ri.Outcome.__dataclass_fields__) - FOLLOW - CHECKS
    names = {name for name in names if not name.endswith("_before")}
    held = {
        *OUTCOME_ENERGIES,
        "velocities_after",
        "vibration_after",
        "contacts",
        "final",
        "status",
    }
    assert names == held
    assert [*BY_CONTACT] == [*ContactTally._fields]
