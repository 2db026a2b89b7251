"""exact(): fractions in and out, against closed forms and the compiled solver."""

from fractions import Fraction

import pytest
from systems import STEEL, random_system, rod

import rodimpact as ri

UNIT = ri.Material("unit", youngs_modulus=4.0, density=1.0)  # wave speed 2
STRIKER = rod(0.4, velocity=1.0)
STRUCK = rod(1.0)
BOX = ri.System([STRIKER, STRUCK])


def only_contact(collision):
    """Start and end of the contact of two bodies that meet once."""
    (episode,) = collision.contact_times[0]
    return episode


def test_the_box_is_two_fifths():
    """The exact collision of the box: e = 2/5, the striker stops, the struck rod has
    2/5 m/s, and the impulse is the momentum of the striker.
    """
    # The striker stops: the impulse is its momentum, rho A l times 1 m/s.
    momentum = Fraction("7850") * Fraction("1e-4") * Fraction("0.4")

    collision = ri.exact(BOX)

    assert collision.restitution == Fraction(2, 5)
    assert collision.velocities_after == (0, Fraction(2, 5))
    assert collision.impulses == (momentum,)


def test_steps_of_an_area_are_borders_as_they_are_written():
    """A rod of 0.4 m whose area steps at 0.1 m has, in fractions, the collision of a
    rod with segments of 0.1 m and 0.3 m.
    """
    area = ri.Steps([1e-4, 2e-4], at=[0.1])
    by_steps = ri.Rod(0.4, area=area, material=STEEL, velocity=1.0)
    thin = ri.Segment(0.1, 1e-4, STEEL)
    thick = ri.Segment(0.3, 2e-4, STEEL)
    by_segments = ri.Rod(segments=[thin, thick], velocity=1.0)

    collision = ri.exact(ri.System([by_steps, STRUCK]))
    expected = ri.exact(ri.System([by_segments, STRUCK]))

    assert collision == expected


def test_times_of_the_box_are_the_metres_that_its_waves_run():
    """The contact of the box lasts from 0 to 4/5, twice the length of the striker in m;
    the unit of time is that in which a wave runs 1 m.
    """
    collision = ri.exact(BOX)

    start, end = only_contact(collision)
    seconds_per_metre = 1 / STEEL.wave_speed
    assert start == 0
    assert end == Fraction(4, 5)  # m, twice the length of the striker
    assert collision.time_unit == pytest.approx(seconds_per_metre, rel=1e-15)


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 7])
def test_velocities_and_contact_times_agree_with_those_of_floats(seed):
    """A random row is solved in fractions and in floats: velocities after, number of
    episodes, first and last time of each contact agree to round-off.
    """
    system = random_system(seed, bodies=3, vibrating=False, bonded=False)
    outcome = ri.solve(system).outcome

    collision = ri.exact(system)

    velocities = list(map(float, collision.velocities_after))
    assert collision.time_unit == 1  # the materials have whole wave speeds
    assert velocities == pytest.approx(outcome.velocities_after, rel=0, abs=1e-11)
    contacts = zip(outcome.contacts, collision.contact_times, strict=True)
    for contact, episodes in contacts:
        assert len(episodes) == contact.episodes
        if episodes:
            first, _ = episodes[0]
            _, last = episodes[-1]
            assert float(first) == pytest.approx(contact.first, rel=1e-9, abs=1e-15)
            assert float(last) == pytest.approx(contact.last, rel=1e-9)


def test_a_gap_closes_at_a_fraction_of_a_second():
    """Two rods with a gap: the only contact begins at the exact time of flight and ends
    a round trip of the first rod later.
    """
    first = rod(1.0, velocity=1.0, material=UNIT)
    second = rod(2.0, velocity=0.7, material=UNIT)
    system = ri.System([first, second], gaps=[0.1])

    start, end = only_contact(ri.exact(system))

    closing = Fraction("0.1") / Fraction("0.3")  # s, gap over the relative velocity
    round_trip = 1  # s, twice the length of the first rod over its wave speed
    assert start == closing
    assert end == closing + round_trip


def test_a_density_sets_the_wave_speed_if_the_impedance_is_given():
    """Impedances and a density are given as fractions: the contact lasts from 0 to the
    round trip of the striker at the wave speed 4 m/s.
    """
    first = rod(0.4, velocity=1.0, material=UNIT)
    second = rod(1.0, material=UNIT)
    values = {
        "bodies.0.impedance": 2,
        "bodies.0.material.density": "1/4",
        "bodies.1.impedance": 2,
    }
    system = ri.System([first, second])

    start, end = only_contact(ri.exact(system, values))

    # c = sqrt(E/rho) = sqrt(4/(1/4)) = 4 m/s, and the striker has a length of 0.4 m.
    assert start == 0
    assert end == 2 * Fraction("0.4") / 4


STEPPED_VELOCITY = ri.Steps([1.0, 0.0], [0.2])
WITHOUT_FRACTIONS = [
    (
        ri.System([STRIKER, rod(1.0, material=UNIT)]),
        "bodies.1: has an irrational wave",
    ),
    (
        ri.System([STRIKER, ri.RigidMass(1.0)]),
        "bodies.1: formulas and fractions know no",
    ),
    (
        ri.System([rod(0.4, velocity=[1.0, 2.0]), STRUCK]),
        "system: has members",
    ),
    (
        ri.System([STRIKER, STRUCK], ends=(ri.Fixed(), ri.Free())),
        "ends.left: ",
    ),
    (
        ri.System([rod(0.4, velocity=STEPPED_VELOCITY), STRUCK]),
        "bodies.0: .* uniform",
    ),
    (
        ri.System([rod(0.4), ri.Wall()], contacts=[ri.Bonded()]),
        "contacts.0: .* bonded to a wall",
    ),
]


@pytest.mark.parametrize(("system", "message"), WITHOUT_FRACTIONS)
def test_systems_without_fractions_are_refused(system, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.exact(system)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (
            "bodies.0.lenght",
            1,
            "lenght: is not a parameter .* 'bodies.0.length'",
        ),
        (
            "bodies.0.length",
            "x",
            "bodies.0.length: must be a number or a text",
        ),
        (
            "bodies.0.length",
            -1,
            "bodies.0: needs numbers above 0, got transit -1",
        ),
        (
            "bodies.0.material.density",
            0,
            "bodies.0.material: needs numbers above 0",
        ),
    ],
)
def test_wrong_values_are_named(path, value, message):
    values = {path: value}

    with pytest.raises(ri.InvalidModel, match=message):
        ri.exact(BOX, values)
