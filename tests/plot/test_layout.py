"""One layout of a row, for figures, films and the page."""

import re
from fractions import Fraction

import numpy as np
import pytest
from drawing import rod
from exhaustive import few_of

import rodimpact as ri
from rodimpact import plot
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import scene_of
from rodimpact.plot.layout import choose_layout
from rodimpact.results.magnification import PICTURED_MOVEMENT

pytestmark = pytest.mark.usefixtures("laid_out")


def strained_rods():
    strained = rod(0.4, 1.0).replace(strain=1e-4)
    return ri.System([strained, rod()], gaps=[1e-4])


def rod_between_masses():
    bodies = [ri.RigidMass(0.1, velocity=2.0), rod(0.4), ri.RigidMass(0.2)]
    return ri.System(bodies, contacts=[ri.Hertz(1e10), ri.Rigid()])


SYSTEMS = {preset.key: preset.case.system for preset in presets()} | {
    "drifting": ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]),
    "gap": strained_rods(),
    "struck wall": ri.System([rod(0.4), ri.Wall(-1.0)]),
    "masses": rod_between_masses(),
    "driven": ri.System([rod(0.4)], ends=(ri.Moved(1.0), ri.Fixed())),
}
OPTIONS = {
    "masses": {"until": 3e-4},
    "driven": {"until": 2e-4, "method": "characteristics"},
}
USUAL = {"drifting", "masses"}


@pytest.fixture(scope="module", params=few_of(SYSTEMS, USUAL))
def solution(request):
    name = request.param
    options = OPTIONS.get(name, {})
    return ri.solve(SYSTEMS[name], **options)


@pytest.fixture
def layout(solution):
    """The layout of the row in figures."""
    return choose_layout(solution, 0.0, solution.t_end)


@pytest.fixture
def row(solution):
    """The layout of the row in the page, a dict."""
    options = {"until": solution.t_end, "method": solution.method}
    case = with_gauges(ri.Case(solution.system, options))
    tables = tables_of(case)
    return scene_of(tables["case"], tables["gauges"], LIBRARY)["row"]


@pytest.mark.exhaustive
def test_the_page_magnifies_as_figures_do_in_the_same_frame(layout, row):
    assert row["magnification"] == layout.magnification
    assert row["frame"] == layout.frame
    assert layout.mass_width in (0, row["mass_width"])
    note = ", ".join(row["notes"])
    assert layout.scale in note
    assert ("frame" in note) == (layout.frame != 0)


def test_figures_magnify_by_the_same_factor_in_the_same_frame(solution, layout):
    diagram = plot.spacetime(solution, coordinates="lab")
    snapshots = plot.snapshots(solution, times=[0.0, solution.t_end])

    for picture in (diagram, snapshots):
        label = " ".join(picture.ax.get_xlabel().split())
        assert layout.scale in label
        assert ("in a frame moving" in label) == (layout.frame != 0)


@pytest.mark.exhaustive
def test_films_magnify_by_the_same_factor(solution, layout):
    film = plot.animation(solution, frames=2)

    label = film.figure.axes[0].get_xlabel()
    assert layout.scale in " ".join(label.split())


def test_the_page_and_the_figures_draw_bodies_at_the_same_places(solution, layout, row):
    tolerance = 1e-6 * layout.row_length
    for t in np.linspace(0.0, solution.t_end, 5):
        for i in range(len(solution.system.bodies)):
            u = float(solution.displacement(i, 0.0, t))
            movement = row["offsets"][i] + u - row["frame"] * t
            left = layout.left[i] + row["magnification"] * movement
            drawn = float(layout.end(i, is_right=False, t=t))
            assert left == pytest.approx(drawn, abs=tolerance)


def test_a_magnification_is_1_2_or_5_times_a_power_of_ten(layout):
    assert re.fullmatch(r"[125]0*", f"{layout.magnification:g}")


def test_bodies_move_no_farther_than_a_part_of_the_row(solution, layout):
    times = np.linspace(0.0, solution.t_end, 101)
    length = 0.0
    movements = []
    for i, body in enumerate(solution.system.bodies):
        left = layout.left[i]
        width = layout.widths[i]
        movements.append(layout.end(i, is_right=False, t=times) - left)
        movements.append(layout.end(i, is_right=True, t=times) - left - width)
        if isinstance(body, ri.Rod):
            length += width

    assert np.ptp(np.array(movements)) <= PICTURED_MOVEMENT * length * (1 + 1e-9)


def test_a_magnification_of_any_kind_of_number_is_a_float(solution):
    layout = choose_layout(solution, 0.0, solution.t_end, Fraction(1, 4))

    assert layout.magnification.hex() == (0.25).hex()
    assert layout.scale.endswith("0.25")


def test_walls_are_walls_and_fixed_ends_by_the_side_they_bound():
    ends = (ri.Free(), ri.Fixed())
    system = ri.System([ri.Wall(), rod(0.4, 1.0)], gaps=[1e-4], ends=ends)
    solution = ri.solve(system, until=1e-4)

    layout = choose_layout(solution, 0.0, 1e-4)

    assert layout.walls() == [(0, False), (1, True)]
