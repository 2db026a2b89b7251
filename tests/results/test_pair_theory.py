"""The closed form that holds for a collision is found, and none where none holds."""

import numpy as np
import pytest
from systems import STEEL, rod

import rodimpact as ri
from rodimpact.results.pair_theory import COLUMNS, pair_theory

DAMPED = ri.Material("damped", youngs_modulus=1e9, density=1000.0, viscosity=[1.0, 2.0])
STRIKER = rod(0.4, 1.0)
STRUCK = rod()
MASS = ri.RigidMass(0.7, velocity=1.0)
STEPPED = ri.Rod(segments=[ri.Segment(0.1, 1e-4, STEEL), ri.Segment(0.1, 2e-4, STEEL)])


@pytest.mark.parametrize(
    ("system", "source"),
    [
        (ri.System([STRIKER, STRUCK]), "Saint-Venant 1867"),
        (ri.System([STRIKER, ri.Wall()]), "textbook, box 10.4"),
        (ri.System([ri.Wall(1.0), STRUCK]), "textbook, box 10.4"),
        (ri.System([MASS, STRUCK]), "Boussinesq"),
        (ri.System([STRIKER, ri.RigidMass(0.7)]), "Boussinesq"),
    ],
)
def test_the_closed_form_of_a_pair_has_the_numbers_of_its_solution(system, source):
    """The closed form of a pair names its source; restitution, impulse, duration, peak
    force and velocities after are those of the solution to 1e-5.
    """
    outcome = ri.solve(system).outcome

    theory = pair_theory(system)

    assert theory.source == source
    collision = theory.collision()
    for name in ("restitution", "impulse", "duration", "peak_force"):
        value = getattr(collision, name)
        computed = getattr(outcome, name)
        assert value == pytest.approx(computed, rel=1e-5)
    for i, computed in enumerate(outcome.velocities_after):
        velocity = theory.column(f"velocity_after.{i}")
        assert velocity.item() == pytest.approx(computed, abs=1e-5)


VIBRATING = rod(velocity=ri.Steps([1.0, 2.0], [0.5]))
STRAINED = rod(strain=ri.Steps([0.0, 1e-5], [0.5]))
TAPERED = rod(area=ri.Samples([1e-4, 2e-4]))
FAMILY = rod(area=[1e-4, 2e-4])
ENDLESS = (ri.Free(), ri.Absorbing())


@pytest.mark.parametrize(
    "system",
    [
        ri.System([STRIKER, STRUCK], contacts=[ri.Hertz(1e10)]),
        ri.System([STRIKER, STRUCK, STRUCK]),
        ri.System([STRIKER]),
        ri.System([STRUCK, STRIKER]),
        ri.System([STRIKER, STRUCK], gravity=1.0),
        ri.System([STRIKER, STRUCK], ends=ENDLESS),
        ri.System([VIBRATING, FAMILY]),
        ri.System([STRAINED, FAMILY]),
        ri.System([STRIKER, rod(material=DAMPED)]),
        ri.System([STRIKER, TAPERED]),
        ri.System([STRIKER, STEPPED]),
        ri.System([MASS, ri.Wall()], contacts=[ri.Rigid(restitution=0.5)]),
    ],
)
def test_there_is_no_closed_form_where_none_holds(system):
    assert pair_theory(system) is None


def value_of(system, name):
    """A column of the closed form of a single pair, a float; nan where there is no
    closed form.
    """
    theory = pair_theory(system)
    if theory is None:
        return np.nan
    return theory.column(name).item()


@pytest.mark.parametrize("left", [STRUCK, ri.Wall(), MASS])
def test_a_family_has_the_values_of_its_members(left):
    """The closed form of a family of three velocities has, in each column, the values
    of its members; nan where a member has none.
    """
    velocities = [-1.0, 0.5, -2.0]
    family = ri.System([left, rod(0.4, velocities)])
    theory = pair_theory(family)
    for name in COLUMNS:
        values = theory.column(name)
        alone = [value_of(family[i], name) for i in range(3)]
        np.testing.assert_array_equal(values, alone)
