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
def smooth_solution():
    """A solution whose waves are smooth, by characteristics."""
    row = ri.System(
        [rod(0.2, 5.0), ri.RigidMass(0.1), rod(0.4)],
        gaps=[1e-6, 0.0],
        contacts=[ri.Hertz(5e9), ri.Bonded()],
        ends=(ri.Pushed(100.0), ri.Absorbing()),
    )
    return ri.solve(row, 3e-4, "characteristics")


def width_at(polygon, y):
    """Width of a convex polygon [point, (x, y)] at a height y at which no corner lies."""
    crossings = []
    next_points = np.roll(polygon, -1, axis=0)
    for start, end in zip(polygon, next_points, strict=True):
        x0, y0 = start
        x1, y1 = end
        starts_below = y0 < y
        ends_below = y1 < y
        if starts_below != ends_below:
            fraction = (y - y0) / (y1 - y0)
            crossings.append(x0 + (x1 - x0) * fraction)
    if not crossings:
        return 0.0
    return max(crossings) - min(crossings)


def time_scale(ax):
    """Number of units of the axis of times in a second; its label ends with "(unit)"."""
    unit = ax.get_ylabel()[-3:-1]
    return {"µs": 1e6, "ms": 1e3}[unit]


def energy_scale(colour_bar):
    """The unit of the colour bar in J/m."""
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
            velocity = float(solution.mean_velocity(i, t))
            mass += body_mass
            momentum += body_mass * velocity
    energy = float(solution.energy(t).total)
    return energy - frame * momentum + frame**2 / 2 * mass


# Energy


@some_rows
def test_energy_per_length_sums_up_to_the_energy_of_the_solution(solved, name):
    """At three times, the drawn energies per length, times the widths of their regions,
    sum to the energy of the solution in the frame of the picture.
    """
    solution = solved[name]
    frame = FRAME_VELOCITIES.get(name, 0.0)

    picture = plot.spacetime(solution, axes(), "energy", coordinates="body")

    unit = energy_scale(picture.colour_bar)  # J/m
    energies = picture.regions.get_array() * unit
    for fraction in (0.1234, 0.456, 0.789):
        t = fraction * solution.t_end
        height = t * time_scale(picture.ax)
        widths = [width_at(polygon, height) for polygon in corners(picture)]
        drawn_energy = energies @ widths
        energy = energy_in_frame(solution, t, frame)
        assert drawn_energy == pytest.approx(energy, rel=1e-6)


def test_dimensionless_energy_of_the_moving_rod_is_a_half(solved):
    picture = plot.spacetime(solved["unequal"], axes(), "energy", dimensionless=True)

    energies = picture.regions.get_array()
    assert energies.max() == pytest.approx(0.5)


# Displacement


def starts_of_bodies(system):
    """Material coordinates of the left ends of the bodies and of the right end of the
    last one, m.
    """
    lengths = [getattr(body, "length", 0.0) for body in system.bodies]
    return np.cumsum([0.0, *lengths])


@some_rows
def test_displacements_are_those_of_the_solution_and_linear_between(solved, name):
    """The mean over the corners of a triangle is the displacement at its centroid."""
    solution = solved[name]
    frame = FRAME_VELOCITIES.get(name, 0.0)
    regions = ri.regions_of(solution)

    picture = plot.spacetime(solution, axes(), "displacement", coordinates="body")

    assert isinstance(picture.regions, TriMesh)
    mesh = picture.regions._triangulation
    triangles = mesh.triangles  # [triangle, corner], indices of points
    # A region of n corners is cut into n - 2 triangles.
    assert len(triangles) == len(regions.x) - 2 * len(regions)
    body_of_points = np.repeat(regions.body, np.diff(regions.start))
    bodies = body_of_points[triangles[:, 0]]
    starts = starts_of_bodies(solution.system)[bodies]
    x = mesh.x[triangles].mean(axis=1) - starts
    t = mesh.y[triangles].mean(axis=1) / time_scale(picture.ax)
    values = np.asarray(picture.regions.get_array()) / picture.scale.factor
    means = values[triangles].mean(axis=1)
    tolerance = 1e-6 * np.abs(values).max()
    forty_triangles = np.linspace(0, len(triangles) - 1, 40).astype(int)
    for i in forty_triangles:
        body = int(bodies[i])
        displacement = float(solution.displacement(body, x[i], t[i]))
        in_frame = displacement - frame * t[i]
        assert means[i] == pytest.approx(in_frame, abs=tolerance)


@pytest.mark.exhaustive
@pytest.mark.parametrize("field", ["displacement", "energy"])
def test_the_frame_of_displacement_and_energy_is_named(solved, field):
    """The colour bar of a drifting row names the moving frame, that of a row at rest
    none.
    """
    drifting = plot.spacetime(solved["drifting"], axes(), field)
    still = plot.spacetime(solved["unequal"], axes(), field)

    drifting_label = drifting.colour_bar.ax.get_ylabel()
    still_label = still.colour_bar.ax.get_ylabel()
    assert "in a frame moving at 100 m/s" in drifting_label
    assert "frame" not in still_label


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
    velocity = solution.velocity(0, x, t)
    strain = solution.strain(0, x, t)
    kinetic = STEEL.density * velocity**2 / 2  # J/m^3
    elastic = STEEL.youngs_modulus * strain**2 / 2
    return AREA * (kinetic + elastic)


def displacement(solution, x, t):
    """Displacement of the first rod, m."""
    return solution.displacement(0, x, t)


@pytest.mark.parametrize(
    ("field", "field_at"),
    [("displacement", displacement), ("energy", energy_per_length)],
)
def test_cells_have_the_field_in_their_middle(smooth_solution, field, field_at):
    """Cells of the first rod, of 0.2 m; in the mean within 1 % of the largest value."""
    picture = plot.spacetime(
        smooth_solution, axes(), field, coordinates="lab", magnification=1.0
    )

    values = np.ma.asarray(picture.regions.get_array())  # [time, position]
    n_times, _ = values.shape
    edges = np.linspace(0, smooth_solution.t_end, n_times + 1)
    t = (edges[:-1] + edges[1:]) / 2
    # Cells between rods are masked: the first of them follows those of the first rod.
    is_between_rods = np.ma.getmaskarray(values)[0]
    n_cells = np.flatnonzero(is_between_rods)[0]
    x = 0.2 * (np.arange(n_cells) + 0.5) / n_cells
    exact = field_at(smooth_solution, x, t[:, np.newaxis])
    drawn = np.asarray(values[:, :n_cells]) / picture.scale.factor
    mean_error = np.abs(drawn - exact).mean()
    assert mean_error < 0.01 * np.abs(exact).max()


# Time across, bodies at rest


def assert_on_its_side(upright, across):
    """Two lists of arrays [point, (x, y)] are equal except for the order of x and y."""
    for upright_points, points_across in zip(upright, across, strict=True):
        swapped = points_across[:, ::-1]
        assert swapped == pytest.approx(upright_points)


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", few_of(SYSTEMS, {"drifting"}))
def test_time_across_is_the_same_picture_on_its_side(solved, name):
    """A diagram with time across has the regions, lines, walls, labels and limits of
    time of the upright one with x and y exchanged.
    """
    upright = plot.spacetime(solved[name], axes(), "stress", across=False)
    across = plot.spacetime(solved[name], axes(), "stress", across=True)

    assert_on_its_side(corners(upright), corners(across))
    for lines in ("ends", "pressing", "touching"):
        upright_lines = getattr(upright, lines).get_segments()
        lines_across = getattr(across, lines).get_segments()
        assert_on_its_side(upright_lines, lines_across)
    upright_walls = [wall.get_xy() for wall in upright.walls]
    walls_across = [wall.get_xy() for wall in across.walls]
    assert_on_its_side(upright_walls, walls_across)
    across_ax = across.ax
    upright_ax = upright.ax
    assert across_ax.get_xlabel() == upright_ax.get_ylabel()
    # Labels are broken into lines at other words.
    words = across_ax.get_ylabel().split()
    assert words == upright_ax.get_xlabel().split()
    assert across_ax.get_xlim() == pytest.approx(upright_ax.get_ylim())


@some_rows
def test_in_material_coordinates_nothing_moves(solved, name):
    """In a diagram over material coordinates, the ends of all rods are vertical lines
    at their coordinates, and the label says so.
    """
    picture = plot.spacetime(solved[name], axes(), coordinates="body")

    positions = set()
    for path in picture.ends.get_segments():
        x = path[:, 0]
        assert np.ptp(x) == 0.0
        positions.add(x[0])
    coordinates = np.unique(starts_of_bodies(solved[name].system))
    assert sorted(positions) == pytest.approx(coordinates)
    label = " ".join(picture.ax.get_xlabel().split())  # without line breaks
    assert label == "material coordinate x (m), rods laid end to end, gaps left out"
