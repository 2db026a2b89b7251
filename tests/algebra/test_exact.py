"""exact(): fractions in and out, against closed forms in fractions and the compiled solver."""

from fractions import Fraction

import numpy as np
import pytest
from systems import STEEL, random_system, rod

import rodimpact as ri

UNIT = ri.Material("unit", youngs_modulus=4.0, density=1.0)


def test_the_box_is_two_fifths():
    done = ri.exact(ri.System([rod(0.4, velocity=1.0), rod(1.0)]))
    assert done.restitution == Fraction(2, 5)
    assert done.velocities_after == (0, Fraction(2, 5))
    assert done.impulses == (Fraction("7850") * Fraction("1e-4") * Fraction("0.4"),)
    assert done.contact_times == (((0, Fraction(4, 5)),),)  # metres of the wave's way
    assert done.time_unit == pytest.approx(1 / STEEL.wave_speed, rel=1e-15)


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 7])
def test_rows_are_what_floats_come_near(seed):
    system = random_system(seed, bodies=3, vibrating=False, bonded=False)
    outcome = ri.solve(system).outcome
    done = ri.exact(system)
    assert done.time_unit == 1  # the materials have whole wave speeds
    assert np.allclose(
        [float(v) for v in done.velocities_after],
        outcome.velocities_after,
        rtol=0,
        atol=1e-11,
    )
    for contact, episodes in zip(outcome.contacts, done.contact_times, strict=True):
        assert len(episodes) == contact.episodes
        if episodes:
            assert float(episodes[0][0]) == pytest.approx(
                contact.first, rel=1e-9, abs=1e-15
            )
            assert float(episodes[-1][1]) == pytest.approx(contact.last, rel=1e-9)


def test_a_gap_closes_between_ticks():
    pair = [
        rod(1.0, velocity=1.0, material=UNIT),
        rod(2.0, velocity=0.7, material=UNIT),
    ]
    done = ri.exact(ri.System(pair, gaps=[0.1]))
    assert done.contact_times == (((Fraction(1, 3), Fraction(4, 3)),),)


def test_a_density_sets_the_wave_speed_where_the_impedance_is_given():
    pair = ri.System([rod(0.4, velocity=1.0, material=UNIT), rod(1.0, material=UNIT)])
    done = ri.exact(
        pair,
        {
            "bodies.0.impedance": 2,
            "bodies.0.material.density": "1/4",
            "bodies.1.impedance": 2,
        },
    )
    assert done.contact_times == (((0, Fraction(1, 5)),),)


PAIR = [rod(0.4, velocity=1.0), rod(1.0)]


@pytest.mark.parametrize(
    ("bodies", "more", "values", "said"),
    [
        (
            [PAIR[0], rod(1.0, material=UNIT)],
            {},
            {},
            "bodies.1: has an irrational wave",
        ),
        (
            [PAIR[0], ri.RigidMass(1.0)],
            {},
            {},
            "bodies.1: formulas and fractions know no",
        ),
        ([rod(0.4, velocity=[1.0, 2.0]), PAIR[1]], {}, {}, "system: has members"),
        (PAIR, {"ends": (ri.Fixed(), ri.Free())}, {}, "ends.left: "),
        (
            [rod(0.4, velocity=ri.Steps([1.0, 0.0], [0.2])), PAIR[1]],
            {},
            {},
            "bodies.0: .* uniform",
        ),
        (
            [rod(0.4), ri.Wall()],
            {"contacts": [ri.Bonded()]},
            {},
            "contacts.0: .* bonded to a wall",
        ),
        (
            PAIR,
            {},
            {"bodies.0.lenght": 1},
            "lenght: is not a parameter .* 'bodies.0.length'",
        ),
        (
            PAIR,
            {},
            {"bodies.0.length": "x"},
            "bodies.0.length: must be a number or a text",
        ),
        (
            PAIR,
            {},
            {"bodies.0.length": -1},
            "bodies.0: needs numbers above 0, got transit -1",
        ),
        (
            PAIR,
            {},
            {"bodies.0.material.density": 0},
            "bodies.0.material: needs numbers above 0",
        ),
    ],
)
def test_mistakes_and_what_has_no_fractions_are_told(bodies, more, values, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.exact(ri.System(bodies, **more), values)
