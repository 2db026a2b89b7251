"""Families that earlier versions saved open in this one, and say what they said
then.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import rodimpact as ri

KEPT = Path(__file__).parent / "kept"  # of schema 6
FACTS = json.loads((KEPT / "facts.json").read_text(encoding="utf-8"))
ALIKE = {"rel": 1e-12, "abs": 1e-15}


def test_a_kept_family_opens():
    family = ri.load(KEPT / "sweep.npz")
    facts = FACTS["sweep"]
    assert np.array(family.velocities_after) == pytest.approx(
        np.array(facts["velocities_after"]), **ALIKE
    )
    assert family.strain == pytest.approx(np.array(facts["strain"]), **ALIKE)
    assert family.system.bodies[0].length.tolist() == [0.2, 0.4]


def test_an_older_version_says_that_it_cannot_read_a_newer_file(monkeypatch):
    monkeypatch.setattr("rodimpact.storage.reading.FILE_SCHEMA", 5)
    with pytest.raises(ri.FileFormatError, match=r"of schema 6.*which reads schema 5"):
        ri.load(KEPT / "sweep.npz")
