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
    """A stretched rod that moves across a gap to another one; not solved."""
    strained = rod(0.4, 1.0).replace(strain=1e-4)
    return ri.System([strained, rod()], gaps=[1e-4])


def rod_between_masses():
    """A mass that strikes a rod with a mass behind it; not solved."""
    striker = ri.RigidMass(0.1, velocity=2.0)
    bodies = [striker, rod(0.4), ri.RigidMass(0.2)]
    laws = [ri.Hertz(1e10), ri.Rigid()]
    return ri.System(bodies, contacts=laws)


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
    """The solution of one of `SYSTEMS`."""
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
    scene = scene_of(tables["case"], tables["gauges"], LIBRARY)
    return scene["row"]


@pytest.mark.exhaustive
def test_the_page_magnifies_as_figures_do_in_the_same_frame(layout, row):
    """The row on the page has magnification, frame and width of masses of the layout,
    and its note names the scale, and the frame if it moves.
    """
    assert row["magnification"] == layout.magnification
    assert row["frame"] == layout.frame
    assert layout.mass_width in (0, row["mass_width"])
    note = ", ".join(row["notes"])
    assert layout.scale in note
    frame_is_named = "frame" in note
    frame_moves = layout.frame != 0
    assert frame_is_named == frame_moves


@pytest.mark.exhaustive
def test_figures_magnify_by_the_same_factor_in_the_same_frame(solution, layout):
    """The labels of a diagram and of snapshots in the laboratory both name the scale of
    the layout, and a moving frame exactly if the layout has one.
    """
    diagram = plot.spacetime(solution, coordinates="lab")
    snapshots = plot.snapshots(solution, times=[0.0, solution.t_end])

    frame_moves = layout.frame != 0
    for picture in (diagram, snapshots):
        label = " ".join(picture.ax.get_xlabel().split())  # without line breaks
        assert layout.scale in label
        frame_is_named = "in a frame moving" in label
        assert frame_is_named == frame_moves


@pytest.mark.exhaustive
def test_films_magnify_by_the_same_factor(solution, layout):
    """The diagram of a film names the scale of displacements that `choose_layout` gives
    for figures of this solution.
    """
    film = plot.animation(solution, frames=2)

    diagram = film.figure.axes[0]
    label = " ".join(diagram.get_xlabel().split())  # without line breaks
    assert layout.scale in label


@pytest.mark.exhaustive
def test_the_page_and_the_figures_draw_bodies_at_the_same_places(solution, layout, row):
    """Left ends of all bodies are compared at five times."""
    tolerance = 1e-6 * layout.row_length
    for t in np.linspace(0.0, solution.t_end, 5):
        for i in range(len(solution.system.bodies)):
            displacement = float(solution.displacement(i, 0.0, t))
            in_frame = displacement - row["frame"] * t
            movement = row["offsets"][i] + in_frame
            on_page = layout.left[i] + row["magnification"] * movement
            in_figure = float(layout.end(i, is_right=False, t=t))
            assert on_page == pytest.approx(in_figure, abs=tolerance)


def test_a_magnification_is_1_2_or_5_times_a_power_of_ten(layout):
    assert re.fullmatch(r"[125]0*", f"{layout.magnification:g}")


def test_bodies_move_no_farther_than_a_part_of_the_row(solution, layout):
    """Drawn movements of all ends are compared with the length of all rods."""
    times = np.linspace(0.0, solution.t_end, 101)
    length = 0.0
    movements = []
    for i, body in enumerate(solution.system.bodies):
        left = layout.left[i]
        width = layout.widths[i]
        left_end = layout.end(i, is_right=False, t=times)
        right_end = layout.end(i, is_right=True, t=times)
        movements.append(left_end - left)
        movements.append(right_end - left - width)
        if isinstance(body, ri.Rod):
            length += width

    largest = PICTURED_MOVEMENT * length
    assert np.ptp(np.array(movements)) <= largest * (1 + 1e-9)


def test_a_magnification_of_any_kind_of_number_is_a_float(solution):
    layout = choose_layout(solution, 0.0, solution.t_end, Fraction(1, 4))

    assert isinstance(layout.magnification, float)
    assert layout.magnification == 0.25
    assert layout.scale.endswith("0.25")


def test_walls_are_walls_and_fixed_ends_by_the_side_they_bound():
    """Each is given by the index of a body and whether it bounds its right side."""
    ends = (ri.Free(), ri.Fixed())
    system = ri.System([ri.Wall(), rod(0.4, 1.0)], gaps=[1e-4], ends=ends)
    solution = ri.solve(system, until=1e-4)

    layout = choose_layout(solution, 0.0, 1e-4)

    wall = (0, False)
    fixed_end = (1, True)
    assert layout.walls() == [wall, fixed_end]
