"""Ends of a row: what they are, and where each may be."""

import numpy as np
import pytest
from mistakes import assert_told

import rodimpact as ri

ROD = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
MASS = ri.RigidMass(2.0)
ENDS = [
    ri.Fixed(),
    ri.Absorbing(),
    ri.Pushed(1e3),
    ri.Moved(2.0),
    ri.Pushed(ri.Steps([1e3, 0.0], [1e-4])),
    ri.Moved(ri.Samples([0.0, 1.0], step=1e-5)),
    ri.Incoming(ri.Samples([0.0, -1e-3], step=1e-5)),
]


def test_ends_are_free_unless_something_is_said():
    """A system without ends equals one with two free ends, and neither is described."""
    system = ri.System([ROD, ROD])
    said = ri.System([ROD, ROD], ends=[ri.Free(), ri.Free()])
    description = system.to_dict()
    assert system.ends == (ri.Free(), ri.Free())
    assert said == system
    assert set(description) == {"bodies", "contacts"}  # and no ends


@pytest.mark.parametrize("end", ENDS, ids=repr)
def test_a_rod_takes_any_end_which_is_kept_in_its_description(end):
    """A system is equal after its description is read; its digest depends on the end."""
    bodies = [ROD, ri.Wall()]
    with_free_ends = ri.System(bodies)
    system = ri.System(bodies, ends=(end, ri.Free()))
    restored = ri.System.from_dict(system.to_dict())
    assert restored == system
    assert system != with_free_ends
    assert system.digest != with_free_ends.digest


@pytest.mark.parametrize(
    "end", [ri.Free(), ri.Pushed(1.0), ri.Pushed(ri.Steps([1.0, 2.0], [1.0]))]
)
def test_a_mass_may_be_free_or_pushed(end):
    ends = (end, ri.Fixed())
    system = ri.System([MASS, ROD], ends=ends)
    assert system.ends == ends


def row_with_right_end(last_body, end):
    """A rod and a body, beside which is this end."""
    return ri.System([ROD, last_body], ends=(ri.Free(), end))


@pytest.mark.parametrize("end", ENDS, ids=repr)
def test_a_wall_has_no_end(end):
    message = "has no place beyond a wall"
    assert_told(lambda: row_with_right_end(ri.Wall(), end), {"ends.right": message})


@pytest.mark.parametrize(
    "end", [ri.Fixed(), ri.Moved(1.0), ri.Absorbing(), ri.Incoming(1e-3)], ids=repr
)
def test_a_mass_takes_no_end_but_a_push(end):
    message = "put a Rod there, or a bonded Wall"
    assert_told(lambda: row_with_right_end(MASS, end), {"ends.right": message})


@pytest.mark.parametrize(
    "ends", ["free", ri.Free(), (ri.Free(),), 3, [ri.Free(), ri.Free(), ri.Free()]]
)
def test_ends_are_two(ends):
    assert_told(lambda: ri.System([ROD, ROD], ends=ends), {"ends": ""})


def test_numbers_of_drives_make_families():
    """A velocity, two forces and two times of drives at both ends make a family of
    shape (2, 2) with these three parameters; a member has its own drive, and the family
    survives `to_dict`.
    """
    forces = np.array([1.0, 2.0])
    times = np.array([[1e-3], [2e-3]])
    moved = ri.Moved([[1.0]])
    pushed = ri.Pushed(ri.Steps([forces, 0.0], [times]))

    family = ri.System([ROD], ends=(moved, pushed))

    assert family.shape == (2, 2)  # [time, force]
    assert list(family.parameters) == [
        "ends.left.value",
        "ends.right.value.values.0",
        "ends.right.value.at.0",
    ]
    first_force_until_second_time = ri.Pushed(ri.Steps([1.0, 0.0], [2e-3]))
    member = family[1, 0]
    assert member.ends == (ri.Moved(1.0), first_force_until_second_time)
    restored = ri.System.from_dict(family.to_dict())
    assert restored == family
