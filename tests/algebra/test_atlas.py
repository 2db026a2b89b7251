"""atlas(): borders against Saint-Venant's, formulas against the solver of floats."""

import numpy as np
import pytest
from drawing import texts_of
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.algebra import exact_run
from rodimpact.algebra.plane_cell import PlaneCell
from rodimpact.algebra.symbolic_row import SymbolicRow
from rodimpact.methods.fronts.simulation import start_simulation

LENGTH = "bodies.1.length"
AREA = "bodies.1.area"


@pytest.fixture(scope="module")
def uniform_atlas():
    """Atlas of two uniform rods over length l2 and area A2; l1 = A1 = 1."""
    first = unit_rod(velocity=1.0)
    second = unit_rod(2.0, 0.7)
    system = ri.System([first, second])
    return ri.atlas(system, (LENGTH, 0.55, 3.6), (AREA, 0.4, 1.7))


@pytest.fixture(scope="module")
def stepped_atlas():
    """Atlas of a striker with a step and a uniform rod."""
    thick = ri.Segment(0.3, 1.5, UNIT)
    thin = ri.Segment(0.2, 1.0, UNIT)
    striker = ri.Rod(segments=[thick, thin], velocity=1.0)
    struck = unit_rod(1.0, 3.0)
    system = ri.System([striker, struck])
    return ri.atlas(system, (LENGTH, 0.6, 2.0), (AREA, 0.8, 6.0))


# The formulas and their borders


def test_borders_are_saint_venants(uniform_atlas):
    """Formulas change at l2 = l1 and A2 = A1, and for A2 < A1 at all l2 = K l1."""
    # x = l2/l1 and y = A2/A1, since l1 = A1 = 1.
    x, y = uniform_atlas.borders.T

    # Distances of each point from the nearest border of Saint-Venant's
    to_nearest_multiple = np.abs(x - np.round(x))
    to_equal_length = np.abs(x - 1)
    to_length = np.where(y < 1, to_nearest_multiple, to_equal_length)
    to_equal_area = np.abs(y - 1)
    distances = np.minimum(to_length, to_equal_area)
    assert distances.max() <= 1e-9
    is_below_equal_areas = y < 0.9
    multiples = set(np.round(x[is_below_equal_areas], 9))
    assert {1, 2, 3} <= multiples


def test_there_are_as_many_regions_as_saint_venants_with_one_contact_in_each(
    uniform_atlas,
):
    """The atlas of two uniform rods up to l2 = 3.6 l1 has six regions: two above equal
    areas, four below; each has one episode of contact.
    """
    # K l1 <= l2 < (K + 1) l1, for lengths up to l2 = 3.6 l1.
    regions_above_equal_areas = ["x < 1", "x > 1"]
    regions_below_equal_areas = ["x < 1", "K = 1", "K = 2", "K = 3"]
    expected = len(regions_above_equal_areas) + len(regions_below_equal_areas)
    assert len(uniform_atlas.contacts) == expected
    assert set(uniform_atlas.contacts) == {(1,)}


def points_in(plane, count):
    """Coordinates x and y, each [count], of random points in the plane of an atlas."""
    rng = np.random.default_rng(3)
    _, x_low, x_high = plane.x
    _, y_low, y_high = plane.y
    x = rng.uniform(x_low, x_high, count)
    y = rng.uniform(y_low, y_high, count)
    return x, y


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("uniform_atlas", 12),
        pytest.param("uniform_atlas", 100, marks=pytest.mark.exhaustive),
        pytest.param("stepped_atlas", 100, marks=pytest.mark.exhaustive),
    ],
)
def test_points_lie_in_the_cell_whose_formula_is_right(name, count, request):
    """2000 random points of an atlas lie in cells, and the restitution by the formulas
    of these cells is that of a sweep for the first `count` points.
    """
    plane = request.getfixturevalue(name)
    x, y = points_in(plane, 2000)
    # All points are located; the solver runs for the first `count` of them.
    striker = plane.system.bodies[0]
    struck = ri.Rod(x[:count], area=y[:count], material=UNIT)
    family = ri.System([striker, struck])

    cells = plane.locate(x, y)
    by_formula = plane.restitution(x, y)

    assert (cells >= 0).all()
    by_solver = ri.sweep(family).restitution
    first_by_formula = by_formula[:count]
    assert first_by_formula == pytest.approx(by_solver, rel=0, abs=1e-12)


def test_borders_are_found_where_floats_do_not_decide_the_sign():
    """The border of equal areas of two rods is found from the lowest length on, without
    a gap of more than 0.08 m between its points.
    """
    first = unit_rod(0.4, velocity=1.0)
    second = unit_rod(1.0, 2.0)
    system = ri.System([first, second])

    plane = ri.atlas(system, ("bodies.0.length", 0.3, 1.5), (AREA, 0.5, 4.0))

    x, y = plane.borders.T
    has_equal_areas = np.abs(y - 1) <= 1e-9
    x_of_equal_areas = np.sort(x[has_equal_areas])
    # At equal areas e = l1/l2, and the second rod holds many waves. That border begins
    # at the lowest length, 0.3 m, and goes on without a hole.
    assert x_of_equal_areas[0] < 0.301
    distances = np.diff(x_of_equal_areas)
    assert distances.max() < 0.08


# Caps


def test_cells_beyond_the_cap_are_unresolved(uniform_atlas):
    """An atlas of at most 2 cells has exactly 2. Points outside them are located in
    cell -1, and only these have a restitution of nan.
    """
    lengths = np.linspace(0.6, 3.5, 20)
    areas = np.linspace(0.5, 1.6, 20)
    x, y = np.meshgrid(lengths, areas)

    plane = ri.atlas(
        uniform_atlas.system, uniform_atlas.x, uniform_atlas.y, most_cells=2
    )

    assert len(plane.cells) == 2
    assert repr(plane) == f"<Atlas over {LENGTH}, {AREA}: 2 regions>"
    cells = plane.locate(x, y)
    unresolved = -1
    assert set(np.unique(cells)) == {unresolved, 0, 1}
    has_no_e = np.isnan(plane.restitution(x, y))
    is_unresolved = cells == unresolved
    assert np.array_equal(has_no_e, is_unresolved)


def test_runs_that_do_not_end_count_as_cells(uniform_atlas, monkeypatch):
    """At most 5 events are allowed a run, too few for some. An atlas of at most 40
    cells then starts 40 runs and has fewer cells.
    """
    runs = []

    def counted_start(*arguments, **options):
        runs.append(arguments)
        return start_simulation(*arguments, **options)

    monkeypatch.setattr(exact_run, "start_simulation", counted_start)

    plane = ri.atlas(
        uniform_atlas.system,
        uniform_atlas.x,
        uniform_atlas.y,
        most_cells=40,
        max_events=5,
    )

    assert len(runs) == 40
    assert len(plane.cells) < 40


def test_a_point_whose_cell_needs_too_many_events_is_unresolved(uniform_atlas):
    """An atlas over lengths up to 1e30 m allows 10 events a run, and the waves run far
    more often through the first rod. It has fewer cells than allowed, and some long
    rods are located in none (-1).
    """
    # Waves run 1e30 times through the first rod before they return in the second.
    lengths_up_to_1e30 = (LENGTH, 0.5, 1e30)

    plane = ri.atlas(
        uniform_atlas.system,
        lengths_up_to_1e30,
        uniform_atlas.y,
        most_cells=3,
        max_events=10,
    )

    assert len(plane.cells) < 3
    x, y = np.meshgrid([1e29, 5e29, 9e29], [0.6, 1.1, 1.5])
    unresolved = -1
    assert unresolved in plane.locate(x, y)


def test_a_cell_ends_where_the_gap_never_closes():
    """The cell of a run with a gap holds a point of closing velocities. Points of equal
    velocities, where the time of contact is gap/0, and of opening ones lie outside.
    """
    paths = ["bodies.0.velocity", "bodies.1.velocity"]
    first = unit_rod(velocity=1.0)
    second = unit_rod(2.0)
    row = SymbolicRow(ri.System([first, second], gaps=[0.5]), paths)
    values = row.values({})
    run = row.run(values, max_events=100)
    cell = PlaneCell(row, run, values, axes=["v1", "v2"])
    v1 = np.array([1.0, 0.0, -1.0, 0.0])
    v2 = np.array([0.5, 0.0, -1.0, 1.0])
    assert cell.inside(v1, v2).tolist() == [True, False, False, False]


@pytest.mark.parametrize(
    ("x", "message"),
    [
        (
            (LENGTH, 2.0, 1.0),
            "x: must be a path, its lowest and its highest value",
        ),
        (
            ("length", 1.0, 2.0),
            r"x: 'length' names 2 numbers; .*: bodies.0.length, bodies.1.length",
        ),
        (
            (LENGTH, -1.0, 2.0),
            "x, bodies.1.length: must be a finite positive number",
        ),
        ((AREA, 1.0, 2.0), "y: must be another number than x"),
    ],
)
def test_mistaken_axes_are_refused(uniform_atlas, x, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.atlas(uniform_atlas.system, x, uniform_atlas.y)


# Texts and figures


def test_a_figure_shows_the_borders(uniform_atlas):
    """The figure of an atlas has borders named "another formula" and "e = 1"; the
    latter lies at x = 1.
    """
    picture = ri.plot.atlas(uniform_atlas)

    assert picture.ax.get_xlabel() == "length of rod 2 (m)"
    borders = {lines.get_label(): lines for lines in picture.borders}
    assert borders.keys() == {"another formula", "e = 1"}
    segments = borders["e = 1"].get_segments()
    x, _ = np.concatenate(segments).T  # of [point, (x, y)]
    assert x == pytest.approx(1.0, rel=0, abs=1e-9)


def test_the_largest_regions_come_first_and_print_the_formula_of_e(uniform_atlas):
    """The two largest regions have falling shares; each prints a formula that gives, at
    its place, the restitution of the atlas.
    """
    pytest.importorskip("sympy")

    first, second = uniform_atlas.largest(2)

    assert 1 > first.share > second.share > 0
    for region in (first, second):
        x, y = region.place
        name, formula = region.formula.split(" = ")
        # Symbols count bodies from 1, paths from 0: bodies.1 has l2 and A2.
        value = eval(formula, {"l2": x, "A2": y})
        e = float(uniform_atlas.restitution(x, y))
        assert name == "e"
        assert value == pytest.approx(e, rel=1e-12)
        assert region.formula in str(uniform_atlas)


def test_a_figure_numbers_regions_and_shows_the_formula_of_the_largest(uniform_atlas):
    """The figure of an atlas has the numbers 1 to 3 of its regions and the beginning of
    the formula of the largest.
    """
    pytest.importorskip("sympy")
    (first,) = uniform_atlas.largest(1)

    picture = ri.plot.atlas(uniform_atlas)

    texts = texts_of(picture.ax.texts)
    assert {"1", "2", "3"} <= set(texts)
    beginning = first.formula[:20]  # the figure may break a long formula after it
    all_texts = "\n".join(texts)
    assert beginning in all_texts
