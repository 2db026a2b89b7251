"""Space-time diagrams of energy and displacement, with time across, and of bodies at
rest.
"""

import numpy as np
import pytest
from drawing import STEEL, axes, corners, rod
from exhaustive import few_of
from matplotlib.collections import TriMesh

import rodimpact as ri
from rodimpact import plot

AREA = 1e-4  # m^2, of `rod`


def stepped_pair():
    """A rod that strikes one of two segments."""
    thin = ri.Segment(0.3, AREA, STEEL)
    thick = ri.Segment(0.4, 3 * AREA, ri.materials.aluminium)
    struck = ri.Rod(segments=[thin, thick])
    return ri.System([rod(0.4, 2.0), struck], gaps=[1e-5])


def released_at_wall():
    """A compressed rod at rest, and a wall that moves against it."""
    bodies = [ri.Wall(0.5), rod(0.5, strain=-1e-4)]
    return ri.System(bodies, ends=(ri.Free(), ri.Free()))


SYSTEMS = {
    "unequal": ri.System([rod(0.4, 1.0), rod(area=2e-4)]),
    "stepped": stepped_pair(),
    "drifting": ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]),
    "wall": released_at_wall(),
}
ENDS = {"stepped": 1e-3, "wall": 8e-4}  # s
FRAME_VELOCITIES = {"drifting": 100.0}  # m/s
some_rows = pytest.mark.parametrize("name", few_of(SYSTEMS, {"drifting", "wall"}))


@pytest.fixture(scope="module")
def solved():
    """{name: solution} of `SYSTEMS`."""
    solutions = {}
    for name, system in SYSTEMS.items():
        solutions[name] = ri.solve(system, ENDS.get(name))
    return solutions


@pytest.fixture(scope="module")
def smooth():
    """A solution whose waves are smooth, by characteristics."""
    row = ri.System(
        [rod(0.2, 5.0), ri.RigidMass(0.1), rod(0.4)],
        gaps=[1e-6, 0.0],
        contacts=[ri.Hertz(5e9), ri.Bonded()],
        ends=(ri.Pushed(100.0), ri.Absorbing()),
    )
    return ri.solve(row, 3e-4, "characteristics")


def width_at(polygon, y):
    """Width of a convex polygon at a height at which no corner lies."""
    crossings = []
    next_points = np.roll(polygon, -1, axis=0)
    for start, end in zip(polygon, next_points, strict=True):
        x0, y0 = start
        x1, y1 = end
        if (y0 - y) * (y1 - y) < 0:
            crossings.append(x0 + (x1 - x0) * (y - y0) / (y1 - y0))
    if not crossings:
        return 0.0
    return max(crossings) - min(crossings)


def time_scale(ax):
    """Number of units of the axis of times in a second."""
    unit = ax.get_ylabel()[-3:-1]
    return {"µs": 1e6, "ms": 1e3}[unit]


def energy_scale(colour_bar):
    """J/m in the unit of the colour bar."""
    label = colour_bar.ax.get_ylabel()
    unit = label[label.rindex("(") + 1 : -1]
    return {"mJ/m": 1e-3, "J/m": 1.0}[unit]


def energy_in_frame(solution, t, frame):
    """Energy of a solution in a frame that moves with a velocity, J."""
    momentum = 0.0
    mass = 0.0
    for i, body in enumerate(solution.system.bodies):
        if isinstance(body, ri.Rod):
            body_mass = solution.outcome.masses[i]
            mass += body_mass
            momentum += body_mass * float(solution.mean_velocity(i, t))
    energy = float(solution.energy(t).total)
    return energy - frame * momentum + frame**2 / 2 * mass


# Energy


@some_rows
def test_energy_per_length_sums_up_to_the_energy_of_the_solution(solved, name):
    solution = solved[name]
    frame = FRAME_VELOCITIES.get(name, 0.0)

    picture = plot.spacetime(solution, axes(), "energy", coordinates="body")

    energies = picture.regions.get_array() * energy_scale(picture.colour_bar)
    for share in (0.1234, 0.456, 0.789):
        t = share * solution.t_end
        height = t * time_scale(picture.ax)
        widths = [width_at(polygon, height) for polygon in corners(picture)]
        energy = energy_in_frame(solution, t, frame)
        assert energies @ widths == pytest.approx(energy, rel=1e-6)


def test_dimensionless_energy_of_the_moving_rod_is_a_half(solved):
    picture = plot.spacetime(solved["unequal"], axes(), "energy", dimensionless=True)

    assert picture.regions.get_array().max() == pytest.approx(0.5)


# Displacement


def starts_of_bodies(system):
    """Material coordinates of the left ends of the bodies, m."""
    lengths = [getattr(body, "length", 0.0) for body in system.bodies]
    return np.cumsum([0.0, *lengths])


@some_rows
def test_displacements_are_those_of_the_solution_and_linear_between(solved, name):
    solution = solved[name]
    frame = FRAME_VELOCITIES.get(name, 0.0)
    regions = ri.regions_of(solution)

    picture = plot.spacetime(solution, axes(), "displacement", coordinates="body")

    assert isinstance(picture.regions, TriMesh)
    mesh = picture.regions._triangulation
    triangles = mesh.triangles  # [triangle, corner], indices of points
    bodies = np.repeat(regions.body, np.diff(regions.start))[triangles[:, 0]]
    values = np.asarray(picture.regions.get_array()) / picture.scale.factor
    means = values[triangles].mean(axis=1)
    starts = starts_of_bodies(solution.system)[bodies]
    x = mesh.x[triangles].mean(axis=1) - starts
    t = mesh.y[triangles].mean(axis=1) / time_scale(picture.ax)
    tolerance = 1e-6 * np.abs(values).max()
    assert len(bodies) == len(regions.x) - 2 * len(regions)
    for i in np.linspace(0, len(bodies) - 1, 40).astype(int):
        displacement = float(solution.displacement(int(bodies[i]), x[i], t[i]))
        assert means[i] == pytest.approx(displacement - frame * t[i], abs=tolerance)


@pytest.mark.parametrize("field", ["displacement", "energy"])
def test_the_frame_of_displacement_and_energy_is_named(solved, field):
    drifting = plot.spacetime(solved["drifting"], axes(), field)
    still = plot.spacetime(solved["unequal"], axes(), field)

    assert "in a frame moving at 100 m/s" in drifting.colour_bar.ax.get_ylabel()
    assert "frame" not in still.colour_bar.ax.get_ylabel()


def fronts(picture):
    """Lines of all fronts, a list of points [point, (x, t)]."""
    for lines in picture.ax.collections:
        if lines.get_label() == "fronts":
            return lines.get_segments()
    raise AssertionError("no fronts are drawn")


@pytest.mark.exhaustive
def test_the_same_fronts_lie_over_displacements(solved):
    velocity = plot.spacetime(solved["stepped"], axes(), "velocity")
    displacement = plot.spacetime(solved["stepped"], axes(), "displacement")

    assert np.array_equal(fronts(velocity), fronts(displacement))


# Cells of smooth waves


def energy_per_length(solution, x, t):
    """Energy of the first rod per length, J/m."""
    v = solution.velocity(0, x, t)
    strain = solution.strain(0, x, t)
    return AREA * (STEEL.density * v**2 + STEEL.youngs_modulus * strain**2) / 2


def displacement(solution, x, t):
    """Displacement of the first rod, m."""
    return solution.displacement(0, x, t)


@pytest.mark.parametrize(
    ("field", "compute"),
    [("displacement", displacement), ("energy", energy_per_length)],
)
def test_cells_have_the_field_in_their_middle(smooth, field, compute):
    picture = plot.spacetime(
        smooth, axes(), field, coordinates="lab", magnification=1.0
    )

    values = np.ma.asarray(picture.regions.get_array())  # [time, place]
    edges = np.linspace(0, smooth.t_end, values.shape[0] + 1)
    t = (edges[:-1] + edges[1:]) / 2
    # Cells between rods are masked: the first of them follows those of the first rod.
    is_between_rods = np.ma.getmaskarray(values)[0]
    pieces = np.flatnonzero(is_between_rods)[0]
    x = 0.2 * (np.arange(pieces) + 0.5) / pieces
    exact = compute(smooth, x, t[:, None])
    drawn = np.asarray(values[:, :pieces]) / picture.scale.factor
    assert np.abs(drawn - exact).mean() < 0.01 * np.abs(exact).max()


# Time across, bodies at rest


def assert_on_its_side(upright, across):
    """Two lists of points are equal but for the order of their coordinates."""
    for a, b in zip(upright, across, strict=True):
        assert b[:, ::-1] == pytest.approx(a)


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", few_of(SYSTEMS, {"drifting"}))
def test_time_across_is_the_same_picture_on_its_side(solved, name):
    upright = plot.spacetime(solved[name], axes(), "stress", across=False)
    across = plot.spacetime(solved[name], axes(), "stress", across=True)

    assert_on_its_side(corners(upright), corners(across))
    for lines in ("ends", "pressing", "touching"):
        upright_lines = getattr(upright, lines).get_segments()
        assert_on_its_side(upright_lines, getattr(across, lines).get_segments())
    upright_walls = [wall.get_xy() for wall in upright.walls]
    assert_on_its_side(upright_walls, [wall.get_xy() for wall in across.walls])
    assert across.ax.get_xlabel() == upright.ax.get_ylabel()
    assert across.ax.get_ylabel().split() == upright.ax.get_xlabel().split()
    assert across.ax.get_xlim() == pytest.approx(upright.ax.get_ylim())


@some_rows
def test_in_material_coordinates_nothing_moves(solved, name):
    picture = plot.spacetime(solved[name], axes(), coordinates="body")

    starts = set()
    for path in picture.ends.get_segments():
        assert np.ptp(path[:, 0]) == 0.0
        starts.add(path[0, 0])
    coordinates = starts_of_bodies(solved[name].system)
    label = " ".join(picture.ax.get_xlabel().split())
    assert sorted(starts) == pytest.approx(np.unique(coordinates))
    assert label == "material coordinate x (m), rods laid end to end, gaps left out"
