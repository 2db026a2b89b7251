"""Families that earlier versions saved open in this one, with the numbers that they had
then.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import rodimpact as ri

KEPT = Path(__file__).parent / "kept"  # of schema 6
FACTS = json.loads((KEPT / "facts.json").read_text(encoding="utf-8"))
ROUND_OFF = {"rel": 1e-12, "abs": 1e-15}


def test_a_kept_family_opens_with_its_velocities_strains_and_lengths():
    """A saved family in the repository is loaded: velocities and strains are those
    noted, to round-off, and the lengths 0.2 and 0.4 m.
    """
    family = ri.load(KEPT / "sweep.npz")
    facts = FACTS["sweep"]
    velocities = np.array(facts["velocities_after"])
    strain = np.array(facts["strain"])
    assert np.array(family.velocities_after) == pytest.approx(velocities, **ROUND_OFF)
    assert family.strain == pytest.approx(strain, **ROUND_OFF)
    assert family.system.bodies[0].length.tolist() == [0.2, 0.4]


def test_an_older_version_says_that_it_cannot_read_a_newer_file(monkeypatch):
    monkeypatch.setattr("rodimpact.storage.reading.FILE_SCHEMA", 5)
    with pytest.raises(ri.FileFormatError, match=r"of schema 6.*which reads schema 5"):
        ri.load(KEPT / "sweep.npz")
