"""Collisions of a wanted e, found along a family."""

import numpy as np
import pytest
from steel import rod

import rodimpact as ri


@pytest.mark.parametrize("e", [0.2, 0.45, 0.777, 1.0])
def test_of_two_rods_of_one_section_e_is_the_ratio_of_lengths(e):
    found = ri.design.restitution(
        e, ri.System([rod(np.linspace(0.1, 2.3, 12), 1.0), rod()])
    )
    assert found.values["bodies.0.length"] == pytest.approx(e, abs=1e-6)
    assert found.system == ri.System([rod(found.values["bodies.0.length"], 1.0), rod()])
    assert ri.solve(found.system).outcome.restitution == pytest.approx(
        found.reached, abs=1e-9
    )
    assert found.misfit == pytest.approx(0, abs=1e-6)


def test_several_numbers_vary_together_and_no_closed_form_is_needed():
    lengths = np.array([0.2, 0.9])
    family = ri.System(
        [rod(lengths, 1.0), rod(2 * lengths), rod(0.5)],
        contacts=[ri.Rigid(), ri.Bonded()],
    )
    low, high = ri.sweep(family).restitution
    found = ri.design.restitution((low + high) / 2, family)
    assert ri.solve(found.system).outcome.restitution == pytest.approx(
        (low + high) / 2, abs=1e-9
    )
    first, second = found.values.values()
    assert second == pytest.approx(2 * first)
    assert str(found).splitlines()[0].startswith("bodies.0.length")


@pytest.mark.parametrize(
    ("wanted", "family", "sentence"),
    [
        (
            0.5,
            ri.System([rod(velocity=1.0), rod()]),
            "family: must vary along one axis with two",
        ),
        (0.5, rod(), "family: must be a System"),
        (
            -0.1,
            ri.System([rod([0.1, 0.2], 1.0), rod()]),
            "wanted: must be .*, got -0.1",
        ),
        (
            0.5,
            ri.System([rod([0.1, 0.2]), rod()]),
            "family: none of its members has an e",
        ),
        (
            0.5,
            ri.System([rod([0.1, 0.2], 1.0), rod()]),
            "for these values of bodies.0.length, e lies between 0.1 and 0.2",
        ),
    ],
)
def test_what_cannot_be_is_said(wanted, family, sentence):
    with pytest.raises(ValueError, match=sentence.replace("(", r"\(")):
        ri.design.restitution(wanted, family)
