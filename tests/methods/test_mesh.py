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


def mesh_of(row, counts, contacts=None, gaps=None, **options):
    return Mesh(build_row(ri.System(row, gaps, contacts, **options)), counts)


@pytest.mark.parametrize(
    ("options", "polar", "field"),
    [({"viscosity": 1e9}, None, "material.viscosity"), ({}, 1e9, "lateral_inertia")],
)
def test_cells_that_hardly_move_are_refused(options, polar, field):
    stuff = ri.Material(
        "m", youngs_modulus=1.0, density=1.0, poisson_ratio=0.3, **options
    )
    pieces = [
        ri.Segment(1.0, 1.0, UNIT),
        ri.Segment(
            1.0,
            1.0,
            stuff,
            polar_moment=polar,
            lateral_inertia=polar and "rayleigh-love",
        ),
    ]
    row = [unit_rod(), ri.Rod(segments=pieces)]
    assert refused("round-off hides the motion", mesh_of, row, [3, 3, 30]) == [
        f"bodies.1.segments.1.{field}"
    ]
    mesh_of([ri.Rod(segments=pieces)], [3, 1])


def test_the_mesh_that_wastes_least():
    """Courant numbers are as near to 1 as the first hundred numbers of cells allow."""
    row = [unit_rod(1.0), unit_rod(0.75), unit_rod(math.sqrt(0.5))]
    counts, step = mesh_size(build_row(ri.System(row)), None, None, None)
    courant = step * np.array(counts) / [1.0, 0.75, math.sqrt(0.5)]
    assert 100 <= counts[0] < 200
    assert courant.max() == pytest.approx(0.999, rel=1e-12)
    assert courant.min() >= 0.997
    counts, _ = mesh_size(
        build_row(ri.System([unit_rod(), unit_rod(0.02)])), None, None, None
    )
    assert min(counts) >= 8


def test_the_scale_of_velocities_is_that_of_the_mirror_image():
    """Each end's force counts once, over the least impedance."""
    ends = ri.Pushed(3.0), ri.Pushed(ri.Steps([1.0, -2.0], [1.0]))
    row = ri.System([unit_rod(area=0.5, velocity=0.25), unit_rod()], ends=ends)
    assert (
        build_row(row).scale
        == build_row(row.mirrored()).scale
        == pytest.approx(0.25 + 3.0 / 0.5)
    )


@pytest.mark.parametrize("theory", ["rayleigh-love", "mindlin-herrmann"])
@pytest.mark.parametrize("diameter", [1e-38, 1e-36, 1e37, 1e38])
def test_sections_beyond_floats_are_refused(theory, diameter):
    """Squares of their radial inertia or stiffness would overflow or vanish."""
    stuff = ri.materials.steel
    rod = ri.Rod(0.5, diameter=diameter, material=stuff, lateral_inertia=theory)
    row = ri.System([rod.replace(velocity=1.0), ri.Wall()])
    run = {"method": "finite-difference", "cells": 20, "until": 1e-5}
    assert refused("overflow or vanish", ri.solve, row, **run) == ["bodies.0.area"]


@pytest.mark.parametrize("damping", [0.0, 0.02])
def test_a_taper_with_one_huge_section(damping):
    """It reflects as a wall does, whatever its size."""
    steel = ri.materials.steel
    if damping:
        steel = steel.damped(loss_factor=damping, frequency=1e3)
    areas = [4e-4, 3.5e-4, 3e-4, 2.6e-4, 2.2e-4, 1.9e-4, 1.0, 1.26e-4, 1e-4]
    striker = ri.Rod(0.4, area=4e-4, material=steel, velocity=1.0)
    velocities = []
    for huge in (1e4, 8.4e11, 1e100):
        areas[6] = huge
        horn = ri.Rod(0.5, area=ri.Samples(areas), material=steel)
        row = ri.System([striker, horn])
        run = ri.solve(row, method="finite-difference", cells=100, until=4e-4)
        velocities.append(run.mean_velocity(0, 4e-4))
        assert abs(run.energy(4e-4).residual) < 1e-12 * striker.mass
    assert velocities[0] == pytest.approx(velocities[2], rel=1e-3)
    assert velocities[1] == pytest.approx(velocities[2], rel=1e-9)
