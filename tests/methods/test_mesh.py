"""A row laid out on nodes and cells."""

import math

import numpy as np
import pytest
from mistakes import refused
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh
from rodimpact.methods.grid.method import mesh_size
from rodimpact.methods.row_builder import build_row

STEEL = ri.materials.steel
VISCOUS = ri.Material("viscous", youngs_modulus=1.0, density=1.0, viscosity=1e9)
CONTRACTING = ri.Material("m", youngs_modulus=1.0, density=1.0, poisson_ratio=0.3)
WIDE = {"polar_moment": 1e9, "lateral_inertia": "rayleigh-love"}


@pytest.mark.parametrize(
    ("segment", "field"),
    [
        (ri.Segment(1.0, area=1.0, material=VISCOUS), "material.viscosity"),
        (ri.Segment(1.0, area=1.0, material=CONTRACTING, **WIDE), "lateral_inertia"),
    ],
    ids=["viscosity", "lateral inertia"],
)
def test_cells_that_hardly_move_are_refused_unless_they_are_few(segment, field):
    """30 cells of a segment with much viscosity or lateral inertia, but not one."""

    def mesh_of(bodies, counts):
        system = ri.System(bodies)
        return Mesh(build_row(system), counts)

    plain = ri.Segment(1.0, area=1.0, material=UNIT)
    rod = ri.Rod(segments=[plain, segment])
    bodies = [unit_rod(), rod]

    message = "round-off hides the motion"
    paths = refused(message, mesh_of, bodies, counts=[3, 3, 30])

    assert paths == [f"bodies.1.segments.1.{field}"]
    mesh_of([rod], counts=[3, 1])  # is not refused


def test_the_mesh_is_chosen_whose_courant_numbers_are_nearest_to_1():
    """The mesh of three rods has 100 to 199 cells in the longest one and Courant
    numbers from 0.997 to 0.999.
    """
    lengths = [1.0, 0.75, math.sqrt(0.5)]  # and transit times
    rods = [unit_rod(length) for length in lengths]
    row = build_row(ri.System(rods))

    counts, step = mesh_size(row, cells=None, dt=None, until=None)

    courant = step * np.array(counts) / lengths  # [segment]
    assert 100 <= counts[0] < 200
    largest = courant.max()
    assert largest == pytest.approx(0.999, rel=1e-12)
    assert courant.min() >= 0.997  # 0.2 % below the largest


def test_the_shortest_rod_has_8_cells_at_least():
    """A rod 50 times shorter than another gets at least 8 cells; a hundred cells in the
    longest rod would leave it two.
    """
    system = ri.System([unit_rod(), unit_rod(0.02)])
    row = build_row(system)

    counts, _ = mesh_size(row, cells=None, dt=None, until=None)

    assert min(counts) >= 8


def test_the_scale_of_velocities_is_that_of_the_mirror_image():
    """The largest force at either end counts once, over the least impedance."""
    steps = ri.Steps([1.0, -2.0], at=[1.0])
    ends = (ri.Pushed(3.0), ri.Pushed(steps))
    first = unit_rod(area=0.5, velocity=0.25)
    system = ri.System([first, unit_rod()], ends=ends)

    scale = build_row(system).scale
    scale_of_mirrored = build_row(system.mirrored()).scale

    largest_force = 3.0
    least_impedance = 0.5
    expected = 0.25 + largest_force / least_impedance
    assert scale == pytest.approx(expected)
    assert scale_of_mirrored == scale


@pytest.mark.parametrize("theory", ["rayleigh-love", "mindlin-herrmann"])
@pytest.mark.parametrize("diameter", [1e-38, 1e-36, 1e37, 1e38])
def test_sections_beyond_floats_are_refused(theory, diameter):
    """Squares of their radial inertia or stiffness would overflow or vanish."""
    rod = ri.Rod(
        0.5, diameter=diameter, material=STEEL, velocity=1.0, lateral_inertia=theory
    )
    row = ri.System([rod, ri.Wall()])
    options = {"method": "finite-difference", "cells": 20, "until": 1e-5}
    paths = refused("overflow or vanish", ri.solve, row, **options)
    assert paths == ["bodies.0.area"]


@pytest.mark.parametrize(
    "material", [STEEL, STEEL.damped(loss_factor=0.02, frequency=1e3)]
)
def test_a_huge_section_in_a_taper_reflects_as_a_wall_whatever_its_size(material):
    """The velocity of what strikes the tapered rod does not depend on the size."""
    before = [4e-4, 3.5e-4, 3e-4, 2.6e-4, 2.2e-4, 1.9e-4]  # m^2
    after = [1.26e-4, 1e-4]
    striker = ri.Rod(0.4, area=4e-4, material=material, velocity=1.0)

    velocities = []  # of the striker, by size
    for huge in (1e4, 8.4e11, 1e100):
        areas = ri.Samples([*before, huge, *after])
        horn = ri.Rod(0.5, area=areas, material=material)
        row = ri.System([striker, horn])
        solution = ri.solve(row, method="finite-difference", cells=100, until=4e-4)
        velocity = solution.mean_velocity(0, 4e-4)
        velocities.append(velocity)
        residual = solution.energy(4e-4).residual
        assert abs(residual) < 1e-12 * striker.mass

    large, larger, largest = velocities
    assert large == pytest.approx(largest, rel=1e-3)
    assert larger == pytest.approx(largest, rel=1e-9)
