"""Files that earlier versions saved open in this one, and say what they said then."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

import rodimpact as ri

KEPT = Path(__file__).parent / "kept"  # of schema 6
FACTS = json.loads((KEPT / "facts.json").read_text(encoding="utf-8"))
ALIKE = {"rel": 1e-12, "abs": 1e-15}


@pytest.mark.parametrize("method", ["fronts", "characteristics", "finite-difference"])
def test_a_kept_solution_opens(method):
    solution, facts = ri.load(KEPT / f"{method}.npz"), FACTS[method]
    outcome, rod = solution.outcome, facts["rod"]
    assert (solution.method, solution.status) == (method, facts["status"])
    assert outcome.velocities_after == pytest.approx(
        tuple(facts["velocities_after"]), **ALIKE
    )
    assert [c.impulse for c in outcome.contacts] == pytest.approx(
        facts["impulses"], **ALIKE
    )
    assert [len(c.episodes) for c in solution.contacts] == facts["episodes"]
    for name in ("velocity", "strain"):
        value = getattr(solution, name)(rod, 0.1, 2e-4)
        assert value == pytest.approx(facts[name], **ALIKE)
    assert solution.contacts[0].force(4e-5) == pytest.approx(facts["force"], **ALIKE)
    assert solution.energy(2e-4).total == pytest.approx(facts["energy"], **ALIKE)
    book = solution.energy(np.linspace(0.0, solution.t_end, 20))  # works are read, too
    lost = 1e-9 if method == "characteristics" else 1e-14
    assert book.residual == pytest.approx(0.0, abs=lost * book.total[0])


def test_a_kept_family_opens():
    family, facts = ri.load(KEPT / "sweep.npz"), FACTS["sweep"]
    assert np.array(family.velocities_after) == pytest.approx(
        np.array(facts["velocities_after"]), **ALIKE
    )
    assert family.strain == pytest.approx(np.array(facts["strain"]), **ALIKE)
    assert family.system.bodies[0].length.tolist() == [0.2, 0.4]


def test_a_field_that_comes_later_has_its_default():
    """Read without an entry that has one, as an older file would be."""
    from rodimpact.results.run_file import put_together, take_apart

    run = ri.load(KEPT / "characteristics.npz").run
    document, arrays = take_apart(run)
    assert document["content"].pop("accuracy") is not None
    assert document["content"]["clock"].pop("scale") > 0
    older = put_together(document, arrays)
    assert (older.accuracy, older.clock.scale, older.t_end) == ({}, 0.0, run.t_end)


def test_an_older_version_says_that_it_cannot_read_a_newer_file(tmp_path, monkeypatch):
    solution = ri.solve(
        ri.System(
            [
                ri.Rod(0.2, area=1e-4, material=ri.materials.steel, velocity=1.0),
                ri.Wall(),
            ]
        ),
        method="finite-difference",
        cells=20,
        until=5e-5,
    )
    solution.save(tmp_path / "run.npz")
    monkeypatch.setattr("rodimpact.storage.reading.SCHEMA", 5)
    with pytest.raises(ri.FileFormatError, match=r"of schema 6.*which reads schema 5"):
        ri.load(tmp_path / "run.npz")


def test_what_files_hold_changes_with_the_number_of_their_schema():
    """Else an older version would call a newer file damaged: raise SCHEMA, and tell both here."""
    from rodimpact.results.run_file import RUN_CLASSES, names_of
    from rodimpact.storage.writing import SCHEMA

    held = json.dumps({kind.__name__: names_of(kind) for kind in RUN_CLASSES})
    assert (SCHEMA, hashlib.sha256(held.encode()).hexdigest()[:8]) == (6, "20d22a00")
