"""The closed form that holds for a collision is found, and none where none holds."""

import numpy as np
import pytest
from systems import STEEL, rod

import rodimpact as ri
from rodimpact.results.pair_theory import COLUMNS, pair_theory

DAMPED = ri.Material("damped", youngs_modulus=1e9, density=1000.0, viscosity=[1.0, 2.0])

LEFT = rod(0.4, 1.0)
RIGHT = rod()
MASS = ri.RigidMass(0.7, velocity=1.0)
STEPPED = ri.Rod(segments=[ri.Segment(0.1, area, STEEL) for area in (1e-4, 2e-4)])
PAIR = ri.System([LEFT, RIGHT])


@pytest.mark.parametrize(
    ("system", "source"),
    [
        (PAIR, "Saint-Venant 1867"),
        (ri.System([LEFT, ri.Wall()]), "textbook, box 10.4"),
        (ri.System([ri.Wall(1.0), RIGHT]), "textbook, box 10.4"),
        (ri.System([MASS, RIGHT]), "Boussinesq"),
        (ri.System([LEFT, ri.RigidMass(0.7)]), "Boussinesq"),
    ],
)
def test_a_closed_form_is_that_of_the_collision(system, source):
    outcome = ri.solve(system).outcome
    theory = pair_theory(system)
    assert theory.source == source
    found = theory.collision()
    for name in ("restitution", "impulse", "duration", "peak_force"):
        assert getattr(found, name) == pytest.approx(getattr(outcome, name), rel=1e-5)
    after = [theory.column(f"velocity_after.{i}").item() for i in (0, 1)]
    assert after == pytest.approx(outcome.velocities_after, abs=1e-5)


@pytest.mark.parametrize(
    "system",
    [
        ri.System([LEFT, RIGHT], contacts=[ri.Hertz(1e10)]),
        ri.System([LEFT, RIGHT, RIGHT]),
        ri.System([LEFT]),
        ri.System([RIGHT, LEFT]),
        ri.System([LEFT, RIGHT], gravity=1.0),
        ri.System([LEFT, RIGHT], ends=(ri.Free(), ri.Absorbing())),
        ri.System([rod(velocity=ri.Steps([1.0, 2.0], [0.5])), rod(area=[1e-4, 2e-4])]),
        ri.System([rod(strain=ri.Steps([0.0, 1e-5], [0.5])), rod(area=[1e-4, 2e-4])]),
        ri.System([LEFT, rod(material=DAMPED)]),
        ri.System([LEFT, rod(area=ri.Samples([1e-4, 2e-4]))]),
        ri.System([LEFT, STEPPED]),
    ],
)
def test_there_is_none_where_none_holds(system):
    assert pair_theory(system) is None


@pytest.mark.parametrize("other", [RIGHT, ri.Wall(), MASS])
def test_a_family_has_the_values_of_its_members(other):
    family = ri.System([other, rod(0.4, [-1.0, 0.5, -2.0])])
    theory = pair_theory(family)
    for name in COLUMNS:
        members = [pair_theory(family[i]) for i in range(3)]
        alone = [np.nan if one is None else one.column(name).item() for one in members]
        np.testing.assert_array_equal(theory.column(name), alone)
