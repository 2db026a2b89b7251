"""Every door takes the same paths of numbers, and tells a wrong one alike."""

import numpy as np
import pytest
from mistakes import problems

import rodimpact as ri

STEEL = ri.materials.steel
FRACTIONAL = STEEL.replace(
    youngs_modulus=7850 * 5000.0**2
)  # a wave speed that exact() knows
PULSE = ri.Signal([0.0, 1.0, 1.0, 0.0], dt=1e-6)


def chain(n=2, material=STEEL, last=None, gap=0.0):
    rods = [
        ri.Rod(0.1, area=1e-4, material=material, velocity=1.0 * (i == 0))
        for i in range(n)
    ]
    last = ri.Rod(0.2, area=1e-4, material=last or material)
    return ri.System([*rods, last], gaps=[gap] * n)


DOORS = {
    "gradient": lambda s, path: ri.gradient(s, of="velocity_after.1", wrt=[path]),
    "closed_form": lambda s, path: ri.closed_form(s, [path]),
    "exact": lambda s, path: ri.exact(s, {path: 7850}),
    "atlas": lambda s, path: ri.atlas(
        s, (path, 1.0, 2.0), ("bodies.0.length", 0.1, 0.2)
    ),
    "fit": lambda s, path: ri.fit(
        s, ri.Measured(PULSE, gauge=(1, 0.05)), {path: (1, 2)}, 1e-5
    ),
    "read_case": lambda s, path: ri.parse_case(ri.write_case(s), vary={path: "1,2"}),
}


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("bodies.1.lenght", "perhaps 'bodies.1.length' is meant"),
        ("bodies.1.stiffness", "bodies.1.length, "),
        ("colour", "use one that begins with "),
        ("bodies.1.material.hue", "bodies.1.material.density"),
    ],
)
def test_a_wrong_path_is_told_with_the_nearest_of_its_object(door, path, said):
    [message] = problems(
        lambda: DOORS[door](chain(20, FRACTIONAL, gap=1e-4), path)
    ).values()
    assert said in message
    assert "..." not in message


@pytest.mark.parametrize(
    "path", ["materials.brass.density", "bodies.2.material.density"]
)
def test_materials_go_by_name_and_by_body(path):
    """A brass of 8000 kg/m^3 is the same wherever it is asked for."""
    brass = ri.materials.brass
    system = chain(last=brass)
    heavy = chain(last=brass.replace(density=8000.0))
    v = ri.solve(heavy).outcome.velocities_after
    form = ri.closed_form(system, [path])
    (name,) = form.symbols
    assert float(form.at(**{name: 8000}).velocities_after[2]) == pytest.approx(
        v[2], rel=1e-12
    )
    family = ri.parse_case(ri.write_case(system), vary={path: "8000,8001"}).system
    assert ri.sweep(family).velocities_after[2][0] == pytest.approx(v[2], rel=1e-12)
    there, here = (
        ri.gradient(heavy, of="velocity_after.2", wrt=[p])[p]
        for p in (path, "bodies.2.material.density")
    )
    assert there == here


@pytest.mark.parametrize(
    "path", ["materials.steel.density", "bodies.0.material.density"]
)
def test_an_atlas_over_a_density_says_what_a_run_there_does(path):
    """Wave speeds follow the density; they stayed behind, and e was that of no system."""

    def pair(density):
        return ri.System(
            [
                ri.Rod(
                    0.4,
                    area=1e-4,
                    material=STEEL.replace(density=density),
                    velocity=1.0,
                ),
                ri.Rod(1.0, area=1e-4, material=ri.materials.brass),
            ]
        )

    plane = ri.atlas(pair(7850), (path, 7000, 9000), ("bodies.1.length", 0.9, 1.1))
    for density in (7100, 8900):
        e = ri.solve(pair(density)).outcome.restitution
        assert float(plane.restitution(density, 1.0)) == pytest.approx(e, rel=1e-12)
    assert str(plane).endswith(f"where rho1 = {path}, l2 = bodies.1.length")


def test_a_round_rod_goes_by_its_diameter_and_by_its_area():
    round_one = ri.Rod(0.4, diameter=0.01, material=STEEL, velocity=1.0)
    system = ri.System([round_one, ri.Rod(1.0, area=1e-4, material=STEEL)])
    d = "bodies.0.diameter"
    A = "bodies.0.area"
    found = ri.gradient(system, of="velocity_after.1", wrt=[d, A])
    assert found[d] == pytest.approx(found[A] * np.pi * 0.01 / 2, rel=1e-12)
