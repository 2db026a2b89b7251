"""The manual names the keys of [result], and the record holds all that an outcome
finds.
"""

import re
from pathlib import Path

import rodimpact as ri
from rodimpact.methods.run import MEASURES, ContactTally
from rodimpact.storage.saved_result import BY_BODY, BY_CONTACT, OUTCOME_ENERGIES, WORDS

MANUAL = Path(__file__).parents[2] / "docs" / "input.md"
OF_SYSTEM = {"bodies", "masses", "unilateral", "driven"}
"""Entries of an outcome that follow from the system alone."""
RESIDUALS = {"momentum_residual", "energy_residual"}
"""Entries of an outcome that are computed from the others."""


def keys_under(head):
    """Keys, in their order, of the table of the manual whose first column has this
    head.
    """
    text = MANUAL.read_text(encoding="utf-8")
    # The row of the head, the row of dashes, and the rows of keys.
    table = rf"\n\| key of `{re.escape(head)}` \|.*\n\|-.*\n((?:\|.*\n)+)"
    (rows,) = re.findall(table, text)
    keys = []
    for row in rows.splitlines():
        keys.append(re.match(r'\| `"?([\w. ]+)"?` \|', row)[1])
    return keys


def test_the_manual_names_every_key_in_order():
    numbers = [f"{name}.I" for name in BY_BODY]
    numbers += [f"{name}.K" for name in BY_CONTACT]
    numbers += OUTCOME_ENERGIES
    assert keys_under("[result]") == [*WORDS, "final"]
    assert keys_under("[result.numbers]") == numbers
    assert keys_under("[result.accuracy]") == list(MEASURES)


def test_energies_that_files_of_earlier_versions_lack_are_0(tmp_path):
    """The works of soil and drag are removed from a saved solution: it is read with 0
    for both.
    """
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    path = tmp_path / "run.toml"
    ri.solve(ri.System([rod, ri.Wall()])).save(path)
    lines = path.read_text().splitlines()
    earlier_lines = []
    for line in lines:
        if "soil_work" not in line and "drag_work" not in line:
            earlier_lines.append(line)
    assert len(earlier_lines) == len(lines) - 2
    path.write_text("\n".join(earlier_lines))

    case = ri.read_case(path)

    assert case.result.numbers["drag_work"] == 0.0
    assert case.result.numbers["soil_work"] == 0.0


def test_a_record_holds_all_that_an_outcome_finds():
    """The fields of `Outcome` that do not follow from the system are exactly those that
    are stored, and all totals of a contact are stored.
    """
    computed = set(ri.Outcome.__dataclass_fields__) - OF_SYSTEM - RESIDUALS
    # Velocities and energies before the collision follow from the system, too.
    found = {name for name in computed if not name.endswith("_before")}
    stored = {
        *OUTCOME_ENERGIES,
        "velocities_after",
        "vibration_after",
        "contacts",
        "final",
        "status",
    }
    assert found == stored
    # All totals of a contact are stored, too.
    assert tuple(BY_CONTACT) == ContactTally._fields
