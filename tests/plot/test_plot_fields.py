"""Space-time diagrams of energy and displacement, with time across, and in places of the bodies."""

import numpy as np
import pytest
from drawing import STEEL, axes, corners, rod
from matplotlib.collections import TriMesh

import rodimpact as ri
from rodimpact import plot

ROWS = {
    "unequal": (ri.System([rod(0.4, 1.0), rod(area=2e-4)]), None),
    "stepped": (
        ri.System(
            [
                rod(0.4, 2.0),
                ri.Rod(
                    segments=[
                        ri.Segment(0.3, 1e-4, STEEL),
                        ri.Segment(0.4, 3e-4, ri.materials.aluminium),
                    ]
                ),
            ],
            gaps=[1e-5],
        ),
        1e-3,
    ),
    "drifting": (ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]), None),
    "wall": (
        ri.System([ri.Wall(0.5), rod(0.5, strain=-1e-4)], ends=(ri.Free(), ri.Free())),
        8e-4,
    ),
}
every_row = pytest.mark.parametrize("name", ROWS)
FRAME = {"drifting": 100.0}


@pytest.fixture(scope="module")
def solved():
    return {name: ri.solve(system, until) for name, (system, until) in ROWS.items()}


@pytest.fixture(scope="module")
def stepwise():
    row = ri.System(
        [rod(0.2, 5.0), ri.RigidMass(0.1), rod(0.4)],
        gaps=[1e-6, 0.0],
        contacts=[ri.Hertz(5e9), ri.Bonded()],
        ends=(ri.Pushed(100.0), ri.Absorbing()),
    )
    return ri.solve(row, 3e-4, "characteristics")


def width_at(polygon, y):
    """Width of a convex polygon at a height at which no corner lies."""
    crossed = []
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if (y0 - y) * (y1 - y) < 0:
            crossed.append(x0 + (x1 - x0) * (y - y0) / (y1 - y0))
    return max(crossed) - min(crossed) if crossed else 0.0


# Energy -----------------------------------------------------------------------------------------


@every_row
def test_energy_per_length_sums_up_to_that_of_the_ledger(solved, name):
    solution, frame = solved[name], FRAME.get(name, 0.0)
    picture = plot.spacetime(solution, axes(), "energy", coordinates="body")
    unit = picture.colour_bar.ax.get_ylabel()
    factor = {"mJ/m": 1e-3, "J/m": 1.0}[unit[unit.rindex("(") + 1 : -1]]
    scale = {"µs": 1e6, "ms": 1e3}[picture.ax.get_ylabel()[-3:-1]]
    values = picture.regions.get_array()
    moving = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, ri.Rod)]
    masses = solution.outcome.masses
    for part in (0.1234, 0.456, 0.789):
        t = part * solution.t_end
        summed = sum(
            value * width_at(polygon, t * scale)
            for value, polygon in zip(values, corners(picture), strict=True)
        )
        momentum = sum(masses[i] * float(solution.mean_velocity(i, t)) for i in moving)
        total = (
            float(solution.energy(t).total)
            - frame * momentum
            + frame**2 / 2 * sum(masses[i] for i in moving)
        )
        assert summed * factor == pytest.approx(total, rel=1e-6)


def test_dimensionless_energy_of_the_coming_rod_is_a_half(solved):
    values = plot.spacetime(
        solved["unequal"], axes(), "energy", True
    ).regions.get_array()
    assert values.max() == pytest.approx(0.5)


# Displacement -----------------------------------------------------------------------------------


@every_row
def test_displacements_are_those_of_the_solution_and_linear_between(solved, name):
    solution, frame = solved[name], FRAME.get(name, 0.0)
    picture = plot.spacetime(solution, axes(), "displacement", coordinates="body")
    assert isinstance(picture.regions, TriMesh)
    triangles = picture.regions._triangulation
    scale = {"µs": 1e6, "ms": 1e3}[picture.ax.get_ylabel()[-3:-1]]
    values = np.asarray(picture.regions.get_array()) / picture.scale.factor
    regions = ri.regions_of(solution)
    body = np.repeat(regions.body, np.diff(regions.start))[triangles.triangles[:, 0]]
    starts = np.cumsum(
        [0.0, *(getattr(b, "length", 0.0) for b in solution.system.bodies)]
    )
    middle = triangles.x[triangles.triangles].mean(axis=1) - starts[body]
    t = triangles.y[triangles.triangles].mean(axis=1) / scale
    means = values[triangles.triangles].mean(axis=1)
    largest = np.abs(values).max()
    assert len(body) == len(regions.x) - 2 * len(regions)
    for i in np.linspace(0, len(body) - 1, 40).astype(int):
        expected = (
            float(solution.displacement(int(body[i]), middle[i], t[i])) - frame * t[i]
        )
        assert means[i] == pytest.approx(expected, abs=1e-6 * largest)


def test_the_frame_of_displacement_and_energy_is_named(solved):
    for field in ("displacement", "energy"):
        label = plot.spacetime(
            solved["drifting"], axes(), field
        ).colour_bar.ax.get_ylabel()
        assert "in a frame moving at 100 m/s" in label
        label = plot.spacetime(
            solved["unequal"], axes(), field
        ).colour_bar.ax.get_ylabel()
        assert "frame" not in label


def test_the_same_fronts_lie_over_displacements(solved):
    drawn = [
        plot.spacetime(solved["stepped"], axes(), field).ax.collections
        for field in ("velocity", "displacement")
    ]
    one, other = ([c for c in found if c.get_label() == "fronts"] for found in drawn)
    assert np.array_equal(one[0].get_segments(), other[0].get_segments())


# On a time step ---------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["displacement", "energy"])
def test_cells_have_the_field_in_their_middle(stepwise, field):
    picture = plot.spacetime(
        stepwise, axes(), field, coordinates="lab", magnification=1.0
    )
    values = np.ma.asarray(picture.regions.get_array())
    times = np.linspace(0, stepwise.t_end, values.shape[0] + 1)
    t = (times[:-1] + times[1:]) / 2
    pieces = np.flatnonzero(np.ma.getmaskarray(values)[0])[0]
    x = 0.2 * (np.arange(pieces) + 0.5) / pieces
    place, when = np.broadcast_arrays(x, t[:, None])
    if field == "displacement":
        exact = stepwise.displacement(0, place, when)
    else:
        v, strain = stepwise.velocity(0, place, when), stepwise.strain(0, place, when)
        exact = 1e-4 * (STEEL.density * v**2 + STEEL.youngs_modulus * strain**2) / 2
    off = np.abs(np.asarray(values[:, :pieces]) / picture.scale.factor - exact)
    assert off.mean() < 0.01 * np.abs(exact).max()


# Time across, places of the bodies ----------------------------------------------------------------


def flipped(artist):
    return [segment[:, ::-1] for segment in artist.get_segments()]


@every_row
def test_time_across_is_the_same_picture_on_its_side(solved, name):
    up, across = (
        plot.spacetime(solved[name], axes(), "stress", across=a) for a in (False, True)
    )
    for a, b in zip(corners(up), corners(across), strict=True):
        assert b[:, ::-1] == pytest.approx(a)
    for what in ("ends", "pressing", "touching"):
        for a, b in zip(
            getattr(up, what).get_segments(),
            flipped(getattr(across, what)),
            strict=True,
        ):
            assert b == pytest.approx(a)
    for a, b in zip(up.walls, across.walls, strict=True):
        assert b.get_xy()[:, ::-1] == pytest.approx(a.get_xy())
    assert across.ax.get_xlabel() == up.ax.get_ylabel()
    assert across.ax.get_ylabel().split() == up.ax.get_xlabel().split()
    assert across.ax.get_xlim() == pytest.approx(up.ax.get_ylim())


@every_row
def test_in_places_of_the_bodies_nothing_moves(solved, name):
    picture = plot.spacetime(solved[name], axes(), coordinates="body")
    for path in picture.ends.get_segments():
        assert np.ptp(path[:, 0]) == 0.0
    lengths = [b.length for b in solved[name].system.bodies if isinstance(b, ri.Rod)]
    starts = np.unique([path[0, 0] for path in picture.ends.get_segments()])
    assert starts == pytest.approx([0.0, *np.cumsum(lengths)])
    label = " ".join(picture.ax.get_xlabel().split())
    assert label == "material coordinate x (m), rods laid end to end, gaps left out"
