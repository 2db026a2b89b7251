"""The manual names the keys of [result], and the record holds all that an outcome finds."""

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


def test_a_record_holds_all_that_an_outcome_finds():
    found = set(ri.Outcome.__dataclass_fields__) - FOLLOW - CHECKS
    found = {name for name in found if not name.endswith("_before")}
    held = {
        *OUTCOME_ENERGIES,
        "velocities_after",
        "vibration_after",
        "contacts",
        "final",
        "status",
    }
    assert found == held
    assert [*BY_CONTACT] == [*ContactTally._fields]
