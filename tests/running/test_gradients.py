"""Derivatives: closed forms, an independent solver, what scaling demands, both sides of
kinks.
"""

from fractions import Fraction

import numpy as np
import pytest
from exhaustive import few_of
from method_of_steps import Row, impulses

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.model.paths import numbers_of, with_numbers
from rodimpact.running.differences import sides_of

STEEL = ri.materials.steel
MATERIALS = [
    ri.Material("one", youngs_modulus=100e9, density=4000.0),
    ri.Material("heavy", youngs_modulus=400e9, density=16000.0),
]
BY = ("bodies.0.length", "bodies.1.length", "bodies.0.area", "bodies.1.area")


def pair(length=0.4, struck_length=1.0, struck_area=1e-4, velocity=1.0):
    """A striker of 1 cm^2, and a rod at rest."""
    striker = ri.Rod(length, area=1e-4, material=STEEL, velocity=velocity)
    struck = ri.Rod(struck_length, area=struck_area, material=STEEL)
    return ri.System([striker, struck])


def random_row(seed):
    """Rods that approach each other, some stepped or strained, some apart, some before
    a wall.

    Runs of more than 5,000 events are left out for the time that they take.
    """
    rng = np.random.default_rng([18, seed])
    while True:
        system = _any_row(rng, seed)
        if ri.solve(system, method="fronts").events <= 5_000:
            return system


def _any_row(rng, seed):
    n_segments = 1
    if seed % 3 == 0:
        n_segments = 2
    is_strained = seed % 5 == 0
    has_gaps = seed % 4 > 1
    has_wall = seed % 4 == 1

    def random_segment():
        length = float(rng.uniform(0.1, 1))
        area = float(rng.uniform(0.5, 2) * 1e-4)
        return ri.Segment(length, area, MATERIALS[rng.integers(2)])

    velocities = np.sort(rng.uniform(0, 1, 2 + seed % 2))[::-1]
    bodies = []
    for velocity in velocities:
        segments = [random_segment() for _ in range(n_segments)]
        strain = 0.0
        if is_strained:
            strain = float(1e-5 * rng.uniform(0.5, 1))
        rod = ri.Rod(segments=segments, velocity=float(velocity), strain=strain)
        bodies.append(rod)
    if has_wall:
        bodies.append(ri.Wall(-0.5))
    gaps = [0.0] * (len(bodies) - 1)
    if has_gaps:
        gaps = [float(rng.uniform(1, 2) * 1e-5) for _ in gaps]
    return ri.System(bodies, gaps=gaps)


def paths_of(system, *names):
    """Paths of the numbers other than 0 that have one of these names."""
    paths = []
    for path, value in numbers_of(system).items():
        _, _, name = path.rpartition(".")
        if name in names and value != 0:
            paths.append(path)
    return paths


def weighted(g, system, paths):
    """Sum of number times derivative."""
    numbers = numbers_of(system)
    return sum(numbers[path] * g[path] for path in paths)


def velocity_after(system, i):
    """Velocity of body i after the collision."""
    return ri.solve(system, method="fronts").outcome.velocities_after[i]


def test_the_box_has_smooth_derivatives_by_lengths_and_a_kink_at_equal_areas():
    """Waves of rods of equal areas meet in an order that changes nothing by lengths."""
    g = ri.gradient(pair(0.4, 1.0), wrt=BY)

    # e = l1/l2
    assert g["bodies.0.length"] == pytest.approx(1.0, rel=1e-8)
    assert g["bodies.1.length"] == pytest.approx(-0.4, rel=1e-8)
    kink = g.kinks["bodies.1.area"]
    assert kink.above == pytest.approx(0.3e4, rel=1e-7)
    assert kink.below == pytest.approx(-0.4e4, rel=1e-7)
    assert kink.jump == 0
    assert "-4000 below, 3000 above 1/m^2" in str(g)
    assert np.isnan(g["bodies.1.area"])


def test_derivatives_have_units():
    g = ri.gradient(pair(0.4, 1.0), "impulse.0", ["bodies.1.length", "bodies.1.area"])
    units = {"bodies.1.length": "N s/m", "bodies.1.area": "N s/m^2"}
    assert g.unit == "N s"
