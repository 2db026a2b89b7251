"""A row laid out on nodes and cells."""

import math

import numpy as np
import pytest
from grid_rows import random_row
from hypothesis import given
from hypothesis import strategies as st
from mistakes import refused
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import Mesh
from rodimpact.methods.grid.method import _mesh_size
from rodimpact.methods.laws import Law
from rodimpact.methods.row import Row


def mesh_of(row, counts, contacts=None, gaps=None, **options):
    return Mesh(Row(ri.System(row, gaps, contacts, **options)), counts)


def test_bonded_bodies_share_a_node_and_walls_have_one():
    row = [ri.Wall(), unit_rod(), ri.RigidMass(3.0), unit_rod(), ri.RigidMass(2.0), ri.Wall()]
    laws = [ri.Rigid(), ri.Bonded(), ri.Bonded(), ri.Spring(1.0), ri.Bonded()]
    mesh = mesh_of(row, [2, 2], laws)
    assert (mesh.starts, mesh.stops) == ([0, 1, 6], [0, 5, 6])
    assert mesh.node_of_mass == [3]  # the other one belongs to its wall
    assert mesh.touching == {0: (0, 1), 3: (5, 6)}  # links of the plan, not contacts
    assert mesh.mass[3] == 3.0 + 0.5
    assert mesh.mass[[0, 6]].tolist() == [0.0, 0.0]
    assert np.flatnonzero(mesh.held).tolist() == [0, 6]
    assert mesh.bonds == {1: (3, 3), 2: (3, 4)}


def test_bonds_are_read_on_the_side_of_a_rod():
    laws = [ri.Rigid(), ri.Bonded()]
    mesh = mesh_of([unit_rod(), ri.RigidMass(3.0), unit_rod()], [2, 2], laws)
    assert mesh.bonds == {2: (3, 4)}
    mesh = mesh_of([unit_rod(), ri.RigidMass(3.0), unit_rod()], [2, 2], laws[::-1])
    assert mesh.bonds == {1: (2, 2)}
    mesh = mesh_of([unit_rod()], [2], ends=(ri.Fixed(), ri.Moved(1.0)))
    assert mesh.bonds == {0: (0, 1), 1: (2, 2)}
    assert np.flatnonzero(mesh.held).tolist() == [0, 2]
    mesh = mesh_of([unit_rod()], [2], ends=(ri.Absorbing(), ri.Pushed(1.0)))
    assert mesh.bonds == {}
    assert not np.any(mesh.held)


@given(st.integers(0, 10**6), st.booleans())
def test_every_row(seed, driven):
    system = random_row(seed, driven=driven)
    plan = Row(system)
    counts, step = _mesh_size(plan, None, 1 / 32, None)
    mesh = Mesh(plan, counts)
    assert mesh.starts[0] == 0
    assert mesh.starts[1:] == [b + 1 for b in mesh.stops[:-1]]
    assert mesh.stops[-1] + 1 == len(mesh.mass) == len(mesh.stiffness) - 1
    assert set(mesh.touching) == {i for i, law in enumerate(plan.links) if law.law >= Law.JOINT}
    assert len(mesh.touching) == len(mesh.starts) - 1
    for (left, right), a, b in zip(
        mesh.touching.values(), mesh.stops[:-1], mesh.starts[1:], strict=True
    ):
        assert (left, right) == (a, b)
    rods = sum(float(s.mass) for s in plan.segments)
    assert mesh.mass.sum() == pytest.approx(rods + sum(plan.masses), rel=1e-12)
    assert np.all((mesh.mass > 0) | (mesh.held == 1))
    for N, a, b, s in zip(counts, mesh.first[1:], mesh.last[1:], plan.segments, strict=True):
        assert b - a == N
        assert np.all(mesh.stiffness[a + 1 : b + 1] > 0)
        assert step * N <= float(s.transit_time) * (1 + 1e-9)
    between = np.ones(len(mesh.stiffness), bool)
    for a, b in zip(mesh.starts, mesh.stops, strict=True):
        between[a + 1 : b + 1] = False
    assert not np.any(mesh.stiffness[between])
    bonds = {i for i in plan.contact_link if i >= 0 and plan.links[i].law == Law.BOND}
    assert bonds <= set(mesh.bonds)
    image = Mesh(Row(system.mirrored()), counts[::-1])
    assert image.mass[::-1] == pytest.approx(mesh.mass, rel=1e-12)
    assert np.array_equal(image.held[::-1], mesh.held)
    assert image.stiffness[::-1] == pytest.approx(mesh.stiffness, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "polar", "field"),
    [({"viscosity": 1e9}, None, "material.viscosity"), ({}, 1e9, "lateral_inertia")],
)
def test_cells_that_hardly_move_are_refused(options, polar, field):
    stuff = ri.Material("m", youngs_modulus=1.0, density=1.0, poisson_ratio=0.3, **options)
    pieces = [ri.Segment(1.0, 1.0, UNIT), ri.Segment(1.0, 1.0, stuff, polar_moment=polar,
                                                       lateral_inertia=polar and "rayleigh-love")]
    row = [unit_rod(), ri.Rod(segments=pieces)]
    assert refused("round-off hides the motion", mesh_of, row, [3, 3, 30]) == [
        f"bodies.1.segments.1.{field}"]
    mesh_of([ri.Rod(segments=pieces)], [3, 1])


def test_the_mesh_that_wastes_least():
    """Courant numbers are as near to 1 as the first hundred numbers of cells allow."""
    row = [unit_rod(1.0), unit_rod(0.75), unit_rod(math.sqrt(0.5))]
    counts, step = _mesh_size(Row(ri.System(row)), None, None, None)
    courant = step * np.array(counts) / [1.0, 0.75, math.sqrt(0.5)]
    assert 100 <= counts[0] < 200
    assert courant.max() == pytest.approx(0.999, rel=1e-12)
    assert courant.min() >= 0.997
    counts, _ = _mesh_size(Row(ri.System([unit_rod(), unit_rod(0.02)])), None, None, None)
    assert min(counts) >= 8


def test_the_scale_of_velocities_is_that_of_the_mirror_image():
    """Each end's force counts once, over the least impedance."""
    ends = ri.Pushed(3.0), ri.Pushed(ri.Steps([1.0, -2.0], [1.0]))
    row = ri.System([unit_rod(area=0.5, velocity=0.25), unit_rod()], ends=ends)
    assert Row(row).scale == Row(row.mirrored()).scale == pytest.approx(0.25 + 3.0 / 0.5)
