"""A row laid out on nodes and cells."""

import math

import numpy as np
import pytest
from mistakes import refused
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh
from rodimpact.methods.grid.method import _mesh_size
from rodimpact.methods.walk import walk


def mesh_of(row, counts, contacts=None, gaps=None, **options):
    return Mesh(walk(ri.System(row, gaps, contacts, **options)), counts)


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
    counts, step = _mesh_size(walk(ri.System(row)), None, None, None)
    courant = step * np.array(counts) / [1.0, 0.75, math.sqrt(0.5)]
    assert 100 <= counts[0] < 200
    assert courant.max() == pytest.approx(0.999, rel=1e-12)
    assert courant.min() >= 0.997
    counts, _ = _mesh_size(
        walk(ri.System([unit_rod(), unit_rod(0.02)])), None, None, None
    )
    assert min(counts) >= 8


def test_the_scale_of_velocities_is_that_of_the_mirror_image():
    """Each end's force counts once, over the least impedance."""
    ends = ri.Pushed(3.0), ri.Pushed(ri.Steps([1.0, -2.0], [1.0]))
    row = ri.System([unit_rod(area=0.5, velocity=0.25), unit_rod()], ends=ends)
    assert (
        walk(row).scale == walk(row.mirrored()).scale == pytest.approx(0.25 + 3.0 / 0.5)
    )
