"""atlas(): borders against Saint-Venant's, formulas against the solver of floats."""

import numpy as np
import pytest
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.algebra import exact_run
from rodimpact.methods.fronts.simulation import start_simulation

LENGTH = "bodies.1.length"
AREA = "bodies.1.area"


@pytest.fixture(scope="module")
def pair():
    system = ri.System([unit_rod(velocity=1.0), unit_rod(2.0, 0.7)])
    return ri.atlas(system, (LENGTH, 0.55, 3.6), (AREA, 0.4, 1.7))


@pytest.fixture(scope="module")
def stepped():
    segments = [ri.Segment(0.3, 1.5, UNIT), ri.Segment(0.2, 1.0, UNIT)]
    striker = ri.Rod(segments=segments, velocity=1.0)
    system = ri.System([striker, unit_rod(1.0, 3.0)])
    return ri.atlas(system, (LENGTH, 0.6, 2.0), (AREA, 0.8, 6.0))


# The formulas and their borders -------------------------------------------------------


def test_borders_are_saint_venants(pair):
    """Formulas change at l2 = l1 and A2 = A1, and for A2 < A1 at all l2 = K l1."""
    x, y = pair.borders.T

    from_nearest_multiple = np.abs(x - np.round(x))
    from_one = np.abs(x - 1)
    from_length = np.where(y < 1, from_nearest_multiple, from_one)
    from_area = np.abs(y - 1)
    assert np.minimum(from_length, from_area).max() <= 1e-9

    lengths_below = np.round(x[y < 0.9], 9)
    assert {1, 2, 3} <= set(lengths_below)


def test_regions_are_saint_venants(pair):
    above = ["x < 1", "x > 1"]
    below = ["x < 1", "K = 1", "K = 2", "K = 3"]
    assert len(pair.contacts) == len(above) + len(below)
    assert set(pair.contacts) == {(1,)}


def points_in(plane, count):
    rng = np.random.default_rng(3)
    _, x_low, x_high = plane.x
    _, y_low, y_high = plane.y
    x = rng.uniform(x_low, x_high, count)
    y = rng.uniform(y_low, y_high, count)
    return x, y


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("pair", 12),
        pytest.param("pair", 400, marks=pytest.mark.exhaustive),
        pytest.param("stepped", 400, marks=pytest.mark.exhaustive),
    ],
)
def test_points_lie_in_the_cell_whose_formula_is_right(name, count, request):
    plane = request.getfixturevalue(name)
    x, y = points_in(plane, 2000)
    assert (plane.locate(x, y) >= 0).all()

    struck = ri.Rod(x[:count], area=y[:count], material=UNIT)
    e = ri.sweep(ri.System([plane.system.bodies[0], struck])).restitution

    assert np.abs(plane.restitution(x, y)[:count] - e).max() <= 1e-12


def test_borders_are_found_where_floats_do_not_tell_the_sign():
    system = ri.System([unit_rod(0.4, velocity=1.0), unit_rod(1.0, 2.0)])
    plane = ri.atlas(system, ("bodies.0.length", 0.3, 1.5), (AREA, 0.5, 4.0))

    x, y = plane.borders.T
    x_of_equal_areas = np.sort(x[np.abs(y - 1) <= 1e-9])
    # there e = l1/l2, and the second rod holds many waves
    assert x_of_equal_areas[0] < 0.301
    assert np.diff(x_of_equal_areas).max() < 0.08


# Caps ---------------------------------------------------------------------------------


def test_cells_beyond_the_cap_are_unresolved(pair):
    plane = ri.atlas(pair.system, pair.x, pair.y, most_cells=2)
    assert len(plane.cells) == 2
    assert repr(plane) == f"<Atlas over {pair.x[0]}, {pair.y[0]}: 2 regions>"

    x, y = np.meshgrid(np.linspace(0.6, 3.5, 20), np.linspace(0.5, 1.6, 20))
    cells = plane.locate(x, y)
    assert set(np.unique(cells)) == {-1, 0, 1}
    assert np.array_equal(np.isnan(plane.restitution(x, y)), cells < 0)


def test_runs_that_do_not_end_count_as_cells(pair, monkeypatch):
    runs = []

    def counted_start(*arguments):
        runs.append(arguments)
        return start_simulation(*arguments)

    monkeypatch.setattr(exact_run, "start_simulation", counted_start)
    plane = ri.atlas(pair.system, pair.x, pair.y, most_cells=40, max_events=5)
    assert len(plane.cells) < len(runs) == 40


@pytest.mark.parametrize(
    ("x", "sentence"),
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
def test_mistaken_axes_are_refused(pair, x, sentence):
    with pytest.raises(ri.InvalidModel, match=sentence):
        ri.atlas(pair.system, x, pair.y)


# Texts and figures --------------------------------------------------------------------


def test_a_figure_shows_what_changes(pair):
    picture = ri.plot.atlas(pair)
    assert picture.ax.get_xlabel() == "length of rod 2 (m)"

    borders = {lines.get_label(): lines for lines in picture.borders}
    assert borders.keys() == {"another formula", "e = 1"}
    x_of_ones = np.concatenate(borders["e = 1"].get_segments())[:, 0]
    assert np.allclose(x_of_ones, 1.0, rtol=0, atol=1e-9)


def test_the_largest_regions_print_and_draw_their_formulas(pair):
    pytest.importorskip("sympy")
    first, second = pair.largest(2)
    assert 1 > first.share > second.share > 0
    for region in (first, second):
        x, y = region.place
        name, formula = region.formula.split(" = ")
        value = eval(formula, {"l2": x, "A2": y})
        assert name == "e"
        assert value == pytest.approx(float(pair.restitution(x, y)), rel=1e-12)
        assert region.formula in str(pair)

    texts = [text.get_text() for text in ri.plot.atlas(pair).ax.texts]
    assert {"1", "2", "3"} <= {*texts}
    assert any(first.formula[:20] in text for text in texts)
