import numpy as np
import pytest

import rodimpact as ri
from rodimpact.materials import glass, steel


def rod(**changes):
    fields = {"length": 1.0, "area": 1e-4, "material": steel, **changes}
    return ri.Rod(**fields)


def problems(make):
    with pytest.raises(ri.InvalidModel) as caught:
        make()
    return caught.value.problems


BAD_NUMBERS = [0.0, -1.0, float("nan"), float("inf"), True, "1 m", None, 1j, [], {}]


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize("field", ["length", "area"])
def test_sizes_must_be_positive_numbers(field, value):
    found = problems(lambda: rod(**{field: value}))
    assert [path for path, _ in found] == [field]
    assert "must" in found[0][1]


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize("field", ["youngs_modulus", "density"])
def test_material_constants_must_be_positive_numbers(field, value):
    fields = {"youngs_modulus": 1.0, "density": 1.0, field: value}
    assert [path for path, _ in problems(lambda: ri.Material("m", **fields))] == [field]


@pytest.mark.parametrize("value", [float("nan"), float("-inf"), False, "fast", None])
def test_velocities_must_be_numbers(value):
    assert problems(lambda: rod(velocity=value))[0][0] == "velocity"
    assert problems(lambda: ri.Wall(value))[0][0] == "velocity"


def test_the_message_names_field_and_value():
    message = r"length: must be a finite positive number of metres, got -2.0"
    with pytest.raises(ri.InvalidModel, match=message):
        rod(length=-2.0)


def test_all_mistakes_are_reported_at_once():
    found = problems(lambda: rod(length=-1.0, area=float("nan"), velocity="x"))
    assert [path for path, _ in found] == ["length", "area", "velocity"]


@pytest.mark.parametrize(("modulus", "density"), [(1e300, 1e-300), (1e-300, 1e300)])
def test_a_wave_speed_out_of_range_is_refused(modulus, density):
    assert problems(lambda: ri.Material("m", youngs_modulus=modulus, density=density))


@pytest.mark.parametrize(("size", "modulus", "density"), [
    ({"area": 1e308}, 1e100, 1e100), ({"length": 1e-320}, 1e100, 1e-100),
    ({"area": 1e-320}, 1e-10, 1e-10),
])
def test_an_impedance_or_transit_out_of_range_is_refused(size, modulus, density):
    material = ri.Material("m", youngs_modulus=modulus, density=density)
    assert "impedance" in problems(lambda: rod(material=material, **size))[0][1]


@pytest.mark.parametrize("nu", [-1.0, 0.51, float("nan"), "0.3"])
def test_poisson_ratio_range(nu):
    found = problems(lambda: ri.Material("m", youngs_modulus=1.0, density=1.0, poisson_ratio=nu))
    assert found[0][0] == "poisson_ratio"


def test_viscosity_is_not_negative():
    found = problems(lambda: ri.Material("m", youngs_modulus=1.0, density=1.0, viscosity=-1.0))
    assert found[0][0] == "viscosity"


def test_derived_quantities():
    segment = ri.Segment(0.5, 2e-4, ri.Material("m", youngs_modulus=16.0, density=4.0))
    assert (segment.wave_speed, segment.transit_time) == (2.0, 0.25)
    assert segment.impedance == pytest.approx(4.0 * 2e-4 * 2.0)
    assert segment.mass == pytest.approx(4.0 * 2e-4 * 0.5)


def test_either_segments_or_sizes():
    piece = ri.Segment(1.0, 1.0, steel)
    assert problems(lambda: ri.Rod(1.0, segments=[piece]))[0][0] == "segments"
    assert problems(lambda: ri.Rod(segments=[]))[0][0] == "segments"
    assert problems(lambda: ri.Rod(segments=[piece, "x"]))[0][0] == "segments.1"


def test_rows_are_checked():
    wall, one = ri.Wall(), rod()
    assert problems(lambda: ri.System([]))[0][0] == "bodies"
    assert problems(lambda: ri.System([wall, wall]))[0][0] == "bodies"
    assert problems(lambda: ri.System([one, wall, one]))[0][0] == "bodies.1"
    assert problems(lambda: ri.System([one, "rod"]))[0][0] == "bodies.1"
    assert problems(lambda: ri.System([one, one], [-1e-9]))[0][0] == "gaps.0"
    assert problems(lambda: ri.System([one, one], [0.0, 0.0]))[0][0] == "gaps"
    assert problems(lambda: ri.System([one, one], 0.0))[0][0] == "gaps"
    assert problems(lambda: ri.System([one, one], contacts=["rigid"]))[0][0] == "contacts.0"
    assert problems(lambda: ri.System([one, one], [1.0], [ri.Bonded()]))[0][0] == "gaps.0"
    found = problems(lambda: ri.System([one, wall, one], [-1.0, float("nan")], [None, None]))
    paths = [path for path, _ in found]
    assert paths == ["bodies.1", "gaps.0", "gaps.1", "contacts.0", "contacts.1"]


def test_steps_are_checked():
    assert problems(lambda: ri.Steps([1.0], [0.5]))[0][0] == "values"
    assert problems(lambda: ri.Steps([1.0, 2.0, 3.0], [0.5, 0.5]))[0][0] == "at.1"
    assert problems(lambda: ri.Steps(1.0, []))[0][0] == "values"
    assert problems(lambda: ri.Steps([1.0, "2"], [0.5]))[0][0] == "values.1"
    assert problems(lambda: rod(velocity=ri.Steps([1.0, 2.0], [1.0])))[0][0] == "velocity.at.0"


def test_objects_are_frozen_and_compare_by_value():
    one = rod()
    with pytest.raises(AttributeError, match="frozen"):
        one.velocity = 2.0
    with pytest.raises(AttributeError, match="frozen"):
        del one.velocity
    assert one == rod()
    assert hash(one) == hash(rod())
    assert one != rod(velocity=1.0)
    assert one != "rod"
    assert len({rod(), rod(), ri.Wall()}) == 2


def test_a_system_survives_its_description():
    row = ri.System(
        [ri.Wall(1.0), rod(velocity=ri.Steps([1.0, 0.0], [0.25]), strain=1e-4),
         ri.Rod(segments=[ri.Segment(0.2, 1e-4, steel), ri.Segment(0.3, 2e-4, glass)])],
        [0.0, 1e-5], [ri.Bonded(), ri.Rigid()],
    )
    again = ri.System.from_dict(row.to_dict())
    assert again == row
    assert again.digest == row.digest


def test_families_broadcast():
    family = ri.System([
        rod(length=np.array([0.1, 0.2, 0.3])[:, None], velocity=np.array([1.0, 2.0])), ri.Wall(),
    ])
    assert family.shape == (3, 2)
    member = family[2, 1]
    assert member.shape == ()
    assert member == ri.System([rod(length=0.3, velocity=2.0), ri.Wall()])
    assert family[:, 0].shape == (3,)
    assert ri.System.from_dict(family.to_dict()) == family


def test_family_arrays_are_copied_and_read_only():
    lengths = np.array([1.0, 2.0])
    one = rod(length=lengths)
    lengths[0] = 7.0
    assert one.length[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        one.segments[0].length[0] = 3.0


def test_a_family_names_its_bad_member_and_shape():
    assert problems(lambda: rod(length=np.array([1.0, -1.0])))[0][0] == "length[1]"
    two, three = rod(length=np.ones(2)), rod(length=np.ones(3))
    found = problems(lambda: ri.System([two, three]))
    assert "(2,)" in found[0][1]
    assert "(3,)" in found[0][1]


def test_integers_and_numpy_scalars_are_numbers():
    assert rod(length=np.float32(0.5)).length == 0.5
    assert rod(length=2).length == 2.0


def test_mirror_and_reversal_undo_themselves():
    moving = rod(velocity=ri.Steps([1.0, 2.0], [0.25]))
    row = ri.System([moving, rod(strain=1e-3), ri.Wall(-1.0)], [0.5, 0.25])
    assert row.mirrored().mirrored() == row
    assert row.reversed().reversed() == row
    assert row.mirrored().bodies[0] == ri.Wall(1.0)


def test_repr_can_be_read():
    assert repr(rod()) == "Rod(length=1.0, area=0.0001, material=steel, velocity=0.0, strain=0.0)"


def test_a_mirror_drops_pieces_that_lose_their_width():
    profile = ri.Steps([1.0, 2.0, 3.0], [0.1, np.nextafter(0.1, 1)])
    mirrored = rod(length=1000.0, velocity=profile)
    image = ri.System([mirrored]).mirrored().bodies[0].velocity
    assert image.values == (-3.0, -1.0)
    edge = ri.System([rod(velocity=ri.Steps([1.0, 2.0], [1e-17]))]).mirrored().bodies[0].velocity
    assert edge.values == (-2.0,)
