"""Ends of a row: what they are, and where each may be."""

import numpy as np
import pytest
from mistakes import assert_told

import rodimpact as ri

ROD = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
MASS = ri.RigidMass(2.0)
OTHERS = [
    ri.Fixed(),
    ri.Absorbing(),
    ri.Pushed(1e3),
    ri.Moved(2.0),
    ri.Pushed(ri.Steps([1e3, 0.0], [1e-4])),
    ri.Moved(ri.Samples([0.0, 1.0], step=1e-5)),
    ri.Incoming(ri.Samples([0.0, -1e-3], step=1e-5)),
]


def test_ends_are_free_unless_something_is_said():
    row = ri.System([ROD, ROD])
    assert row.ends == (ri.Free(), ri.Free())
    assert ri.System([ROD, ROD], ends=[ri.Free(), ri.Free()]) == row
    assert set(row.to_dict()) == {"bodies", "contacts"}


@pytest.mark.parametrize("end", OTHERS, ids=repr)
def test_a_rod_takes_any_end(end):
    row = ri.System([ROD, ri.Wall()], ends=(end, ri.Free()))
    assert ri.System.from_dict(row.to_dict()) == row
    assert row != ri.System([ROD, ri.Wall()])
    assert row.digest != ri.System([ROD, ri.Wall()]).digest


@pytest.mark.parametrize(
    "end", [ri.Free(), ri.Pushed(1.0), ri.Pushed(ri.Steps([1.0, 2.0], [1.0]))]
)
def test_a_mass_may_be_pushed(end):
    assert ri.System([MASS, ROD], ends=(end, ri.Fixed())).ends == (end, ri.Fixed())


@pytest.mark.parametrize(
    ("body", "ends", "wanted"),
    [
        *(
            (ri.Wall(), (ri.Free(), end), {"ends.right": "has no place beyond a wall"})
            for end in OTHERS
        ),
        *(
            (
                MASS,
                (ri.Free(), end),
                {"ends.right": "put a Rod there, or a bonded Wall"},
            )
            for end in (ri.Fixed(), ri.Moved(1.0), ri.Absorbing(), ri.Incoming(1e-3))
        ),
        *(
            (ROD, ends, {"ends": ""})
            for ends in ("free", ri.Free(), (ri.Free(),), 3, [ri.Free()] * 3)
        ),
    ],
)
def test_ends_that_can_not_be(body, ends, wanted):
    assert_told(lambda: ri.System([ROD, body], ends=ends), wanted)


def test_drives_make_families():
    force = ri.Pushed(
        ri.Steps([np.array([1.0, 2.0]), 0.0], [np.array([[1e-3], [2e-3]])])
    )
    row = ri.System([ROD], ends=(ri.Moved([[1.0]]), force))
    assert row.shape == (2, 2)
    assert list(row.parameters) == [
        "ends.left.value",
        "ends.right.value.values.0",
        "ends.right.value.at.0",
    ]
    assert row[1, 0].ends == (ri.Moved(1.0), ri.Pushed(ri.Steps([1.0, 0.0], [2e-3])))
    assert ri.System.from_dict(row.to_dict()) == row
