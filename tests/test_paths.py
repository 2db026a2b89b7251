"""Every door takes the same paths of numbers, and tells a wrong one alike."""

import numpy as np
import pytest
from mistakes import problems

import rodimpact as ri

STEEL = ri.materials.steel
FRACTIONAL = STEEL.replace(youngs_modulus=7850 * 5000.0**2)
"""Steel with a wave speed of 5000 m/s: exact() needs a fraction."""
PULSE = ri.Signal([0.0, 1.0, 1.0, 0.0], dt=1e-6)


def chain(n=2, material=STEEL, last=None, gap=0.0):
    """n rods of 0.1 m, of which the first moves, and one of 0.2 m behind them.

    `last` is the material of that one, if it is another; all gaps are equal.
    """
    if last is None:
        last = material
    first = ri.Rod(0.1, area=1e-4, material=material, velocity=1.0)
    equal = ri.Rod(0.1, area=1e-4, material=material)
    others = [equal] * (n - 1)
    last_rod = ri.Rod(0.2, area=1e-4, material=last)
    bodies = [first, *others, last_rod]
    return ri.System(bodies, gaps=[gap] * n)


def gradient(system, path):
    return ri.gradient(system, of="velocity_after.1", wrt=[path])


def closed_form(system, path):
    return ri.closed_form(system, [path])


def exact(system, path):
    return ri.exact(system, {path: 7850})


def atlas(system, path):
    x = (path, 1.0, 2.0)
    y = ("bodies.0.length", 0.1, 0.2)
    return ri.atlas(system, x, y)


def fit(system, path):
    measured = ri.Measured(PULSE, gauge=(1, 0.05))
    return ri.fit(system, measured, {path: (1, 2)}, 1e-5)


def read_case(system, path):
    text = ri.format_case(system)
    return ri.parse_case(text, vary={path: "1,2"})


FUNCTIONS = [gradient, closed_form, exact, atlas, fit, read_case]
"""Functions that take a path of a number."""


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize(
    ("path", "advice"),
    [
        ("bodies.1.lenght", "perhaps 'bodies.1.length' is meant"),
        ("bodies.1.stiffness", "bodies.1.length, "),
        ("colour", "use one that begins with "),
        ("bodies.1.material.hue", "bodies.1.material.density"),
    ],
)
def test_a_wrong_path_is_told_with_the_nearest_of_its_object(function, path, advice):
    system = chain(20, FRACTIONAL, gap=1e-4)
    messages = problems(lambda: function(system, path))
    (message,) = messages.values()
    assert advice in message
    assert "..." not in message  # the message is not too long to be shown


@pytest.fixture(scope="module")
def heavy():
    """A chain whose last rod is of a brass of 8000 kg/m^3."""
    heavy_brass = ri.materials.brass.replace(density=8000.0)
    return chain(last=heavy_brass)


by_both_paths = pytest.mark.parametrize(
    "path", ["materials.brass.density", "bodies.2.material.density"]
)


@by_both_paths
def test_closed_forms_take_materials_by_name_and_by_body(heavy, path):
    """The velocity of the last rod by the formula of a lighter chain is that of a run of
    `heavy`.
    """
    *_, velocity = ri.solve(heavy).outcome.velocities_after
    light = chain(last=ri.materials.brass)

    form = ri.closed_form(light, [path])

    (name,) = form.symbols
    density = {name: 8000}  # that of `heavy`
    outcome = form.at(**density)
    *_, by_formula = outcome.velocities_after
    assert float(by_formula) == pytest.approx(velocity, rel=1e-12)


@by_both_paths
def test_families_take_materials_by_name_and_by_body(heavy, path):
    """The velocity of the last rod in a family over the density is that of a run of
    `heavy`.
    """
    *_, velocity = ri.solve(heavy).outcome.velocities_after
    light = chain(last=ri.materials.brass)
    text = ri.format_case(light)

    family = ri.parse_case(text, vary={path: "8000,8001"}).system
    *_, velocities = ri.sweep(family).velocities_after  # of the last rod [member]

    assert velocities[0] == pytest.approx(velocity, rel=1e-12)


def test_gradients_take_materials_by_name_and_by_body(heavy):
    """The derivative by the density of brass is the same by the path of this material
    and by that of the only body of brass.
    """
    of_last = "velocity_after.2"  # the velocity of the rod of brass
    by_name = ri.gradient(heavy, of_last, wrt=["materials.brass.density"])
    by_body = ri.gradient(heavy, of_last, wrt=["bodies.2.material.density"])
    assert by_name["materials.brass.density"] == by_body["bodies.2.material.density"]


def steel_on_brass(density):
    """A striker of steel of this density, kg/m^3, and a longer rod of brass."""
    steel = STEEL.replace(density=density)
    striker = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    struck = ri.Rod(1.0, area=1e-4, material=ri.materials.brass)
    return ri.System([striker, struck])


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "path", ["materials.steel.density", "bodies.0.material.density"]
)
def test_an_atlas_over_a_density_has_the_restitution_of_a_run_there(path):
    """Wave speeds follow the density: if they did not, e would be that of no system.

    The atlas says which path its symbol stands for.
    """
    densities = (path, 7000, 9000)
    lengths = ("bodies.1.length", 0.9, 1.1)

    plane = ri.atlas(steel_on_brass(7850), densities, lengths)

    for density in (7100, 8900):
        system = steel_on_brass(density)
        e = ri.solve(system).outcome.restitution
        by_atlas = float(plane.restitution(density, 1.0))
        assert by_atlas == pytest.approx(e, rel=1e-12)
    assert str(plane).endswith(f"where rho1 = {path}, l2 = bodies.1.length")


def test_gradients_of_a_round_rod_take_its_diameter_and_its_area():
    """The derivative by the diameter of a rod is that by its area times pi d/2."""
    diameter = 0.01
    striker = ri.Rod(0.4, diameter=diameter, material=STEEL, velocity=1.0)
    struck = ri.Rod(1.0, area=1e-4, material=STEEL)
    system = ri.System([striker, struck])
    paths = ["bodies.0.diameter", "bodies.0.area"]
    slopes = ri.gradient(system, of="velocity_after.1", wrt=paths)
    area_by_diameter = np.pi * diameter / 2  # of pi d^2/4
    expected = slopes["bodies.0.area"] * area_by_diameter
    by_diameter = slopes["bodies.0.diameter"]
    assert by_diameter == pytest.approx(expected, rel=1e-12)
