"""atlas(): borders against Saint-Venant's, formulas against the solver of floats."""

import numpy as np
import pytest
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.algebra import exact_run
from rodimpact.methods.fronts.simulation import start_simulation


@pytest.fixture(scope="module")
def pair():
    system = ri.System([unit_rod(velocity=1.0), unit_rod(2.0, 0.7)])
    return ri.atlas(system, ("bodies.1.length", 0.55, 3.6), ("bodies.1.area", 0.4, 1.7))


@pytest.fixture(scope="module")
def stepped():
    striker = ri.Rod(
        segments=[ri.Segment(0.3, 1.5, UNIT), ri.Segment(0.2, 1.0, UNIT)], velocity=1.0
    )
    return ri.atlas(
        ri.System([striker, unit_rod(1.0, 3.0)]),
        ("bodies.1.length", 0.6, 2.0),
        ("bodies.1.area", 0.8, 6.0),
    )


def test_borders_are_saint_venants(pair):
    x, y = pair.borders.T
    whole = np.where(y < 1, np.abs(x - np.round(x)), np.abs(x - 1))
    assert np.minimum(whole, np.abs(y - 1)).max() <= 1e-9
    assert {1, 2, 3} <= set(np.round(x[(y < 0.9)], 9))
    assert (
        len(pair.contacts) == 6
    )  # y > 1: x < 1, x > 1; y < 1: x < 1 and three with K = 1, 2, 3
    assert set(pair.contacts) == {(1,)}


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("pair", 12),
        *(
            pytest.param(name, 400, marks=pytest.mark.exhaustive)
            for name in ("pair", "stepped")
        ),
    ],
)
def test_places_lie_in_the_cell_whose_formula_is_right(name, count, request):
    plane = request.getfixturevalue(name)
    rng = np.random.default_rng(3)
    x, y = (rng.uniform(low, high, 2000) for _, low, high in (plane.x, plane.y))
    assert (plane.locate(x, y) >= 0).all()
    family = ri.System(
        [plane.system.bodies[0], ri.Rod(x[:count], area=y[:count], material=UNIT)]
    )
    e = ri.sweep(family).restitution
    assert np.abs(plane.restitution(x, y)[:count] - e).max() <= 1e-12


def test_what_the_cap_leaves_is_unresolved(pair):
    plane = ri.atlas(pair.system, pair.x, pair.y, most_cells=2)
    assert len(plane.cells) == 2
    assert repr(plane) == f"<Atlas over {pair.x[0]}, {pair.y[0]}: 2 regions>"
    x, y = np.meshgrid(np.linspace(0.6, 3.5, 20), np.linspace(0.5, 1.6, 20))
    found = plane.locate(x, y)
    assert set(np.unique(found)) == {-1, 0, 1}
    assert np.array_equal(np.isnan(plane.restitution(x, y)), found < 0)


def test_a_figure_shows_what_changes(pair):
    picture = ri.plot.atlas(pair)
    assert {lines.get_label() for lines in picture.borders} == {
        "another formula",
        "e = 1",
    }
    assert picture.ax.get_xlabel() == "length of rod 2 (m)"
    (ones,) = (lines for lines in picture.borders if lines.get_label() == "e = 1")
    assert np.allclose(
        np.concatenate(ones.get_segments())[:, 0], 1.0, rtol=0, atol=1e-9
    )


def test_runs_that_do_not_end_count_as_cells(pair, monkeypatch):
    begun = []
    monkeypatch.setattr(
        exact_run,
        "start_simulation",
        lambda *args: begun.append(1) or start_simulation(*args),
    )
    plane = ri.atlas(pair.system, pair.x, pair.y, most_cells=40, max_events=5)
    assert len(plane.cells) < len(begun) == 40


@pytest.mark.parametrize(
    ("x", "said"),
    [
        (
            ("bodies.1.length", 2.0, 1.0),
            "x: must be a path, its lowest and its highest value",
        ),
        (
            ("length", 1.0, 2.0),
            r"x: 'length' names 2 numbers; .*: bodies.0.length, bodies.1.length",
        ),
        (
            ("bodies.1.length", -1.0, 2.0),
            "x, bodies.1.length: must be a finite positive number",
        ),
        (("bodies.1.area", 1.0, 2.0), "y: must be another number than x"),
    ],
)
def test_mistaken_axes_are_told(pair, x, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.atlas(pair.system, x, pair.y)


def test_borders_that_floats_do_not_tell_are_there():
    system = ri.System([unit_rod(0.4, velocity=1.0), unit_rod(1.0, 2.0)])
    found = ri.atlas(system, ("bodies.0.length", 0.3, 1.5), ("bodies.1.area", 0.5, 4.0))
    x, y = found.borders.T
    level = np.sort(x[np.abs(y - 1) <= 1e-9])
    assert level[0] < 0.301  # where e = l1/l2 and the second rod holds many waves
    assert np.diff(level).max() < 0.08


def test_the_largest_regions_print_and_draw_their_formulas(pair):
    pytest.importorskip("sympy")
    first, second = pair.largest(2)
    assert 1 > first.share > second.share > 0
    for region in (first, second):
        name, formula = region.formula.split(" = ")
        x, y = region.place
        value = eval(formula, {"l2": x, "A2": y})
        assert (name, value) == (
            "e",
            pytest.approx(float(pair.restitution(x, y)), rel=1e-12),
        )
        assert region.formula in str(pair)
    texts = [text.get_text() for text in ri.plot.atlas(pair).ax.texts]
    assert {"1", "2", "3"} <= {*texts}
    assert any(first.formula[:20] in text for text in texts)
