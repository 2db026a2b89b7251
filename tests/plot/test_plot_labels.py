"""Labels of figures can be read: none collide, none are cut, and none are missing for room."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawing import STEEL, C, collisions, render, rod
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.labels import spread_apart
from rodimpact.plot.moments import moments

CONCRETE = ri.Material("concrete", youngs_modulus=30e9, density=2400)
ROWS = {
    "unequal": (ri.System([rod(0.4, 1.0), rod()]), None),
    "wall": (ri.System([rod(0.5, 1.0), ri.Wall()]), None),
    "ten": (ri.System([rod(0.2, 1.0), *[rod(0.2 + 0.01 * i) for i in range(9)]]), None),
    "short": (ri.System([rod(0.03, 1.0), rod()]), None),
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
            gaps=[5e-5],
        ),
        None,
    ),
    "pile": (
        ri.System(
            [
                ri.RigidMass(500.0, velocity=3.0),
                ri.Rod(18.0, area=0.06, material=CONCRETE),
            ],
            contacts=[ri.Spring(5e8)],
            ends=[ri.Free(), ri.Absorbing()],
        ),
        0.03,
    ),
}
FIGURES = {
    "body": plot.spacetime,
    "lab": lambda solution: plot.spacetime(solution, coordinates="lab"),
    "across": lambda solution: plot.spacetime(solution, across=True),
    "across lab": lambda solution: plot.spacetime(
        solution, across=True, coordinates="lab", field="stress"
    ),
    "snapshots": plot.snapshots,
    "contact": plot.contact,
    "energy": plot.energy,
    "overview": plot.overview,
}


@pytest.fixture(scope="module")
def solved():
    return {name: ri.solve(system, until) for name, (system, until) in ROWS.items()}


CASES = [
    (figure, row, width) for figure in FIGURES for row in ROWS for width in (85, None)
]
USUAL = [
    ("body", "ten", 85),
    ("across", "ten", 85),
    ("across lab", "ten", None),
    ("lab", "pile", 85),
    ("snapshots", "stepped", 85),
    ("contact", "wall", 85),
    ("energy", "short", 85),
    ("overview", "unequal", 85),
]


@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_labels_do_not_collide(solved, case):
    figure, row, width = case
    with plot.look(width=width):
        drawn = FIGURES[figure](solved[row])
    assert collisions(drawn) == []


def test_labels_that_overlap_are_spread_about_their_mean():
    assert spread_apart([0.0, 10.0], [4.0, 4.0]) == [0.0, 10.0]
    assert spread_apart([0.0, 1.0], [4.0, 4.0]) == pytest.approx([-1.5, 2.5])
    moved = spread_apart([0.0, 1.0, 4.0, 30.0], [4.0, 4.0, 4.0, 4.0])
    assert np.diff(moved).min() == pytest.approx(4.0)
    assert np.mean(moved[:3]) == pytest.approx(5 / 3)
    assert moved[3] == 30.0


def test_ten_rods_are_all_named_at_full_width_and_short_rods_too(solved):
    for row, count in (("ten", 10), ("short", 2)):
        for across in (False, True):
            ax = plot.spacetime(solved[row], across=across).ax
            axis = ax.yaxis if across else ax.xaxis
            names = [t.get_text().split("\n")[-1] for t in axis.get_minorticklabels()]
            assert len([name for name in names if name]) == count


@pytest.mark.parametrize("across", [False, True])
def test_a_rod_whose_middle_is_at_a_tick_is_named(solved, across):
    ax = plot.spacetime(solved["unequal"], coordinates="lab", across=across).ax
    axis = ax.yaxis if across else ax.xaxis
    assert axis.get_minorticklocs() == pytest.approx([0.2, 0.9])
    assert 0.2 in axis.get_majorticklocs().round(9)


def test_a_short_rod_is_named_in_films_and_snapshots(solved):
    film = plot.animation(solved["short"], frames=2)
    names = [t.get_text() for t in film.figure.axes[0].get_xminorticklabels()]
    assert names == ["\nrod 1", "\nrod 2"]
    texts = [t.get_text() for t in plot.snapshots(solved["short"]).ax.texts]
    assert {"rod 1", "rod 2"} <= set(texts)


@pytest.mark.parametrize("width", [85, None])
def test_words_along_fronts_keep_clear_of_the_contact(solved, width):
    with plot.look(width=width):
        picture = plot.spacetime(solved["unequal"])
    render(picture)
    words = [t for t in picture.ax.texts if t.get_text() in ("compression", "tension")]
    assert words
    ((x, _), *_) = picture.pressing.get_segments()[0]
    contact = picture.ax.transData.transform((x, 0.0))[0]
    half_line = 1.5 * picture.ax.figure.dpi / 72
    for word in words:
        middle = picture.ax.transData.transform(word.get_position())
        angle = np.radians(word.get_rotation())
        height = word.get_fontsize()
        points = 0.55 * height * len(word.get_text()) / 2 * abs(np.cos(angle))
        half = (points + height * abs(np.sin(angle))) * picture.ax.figure.dpi / 72
        assert abs(middle[0] - contact) > half + half_line


def test_every_narrow_piece_has_its_own_label(solved):
    with plot.look(width=85):
        picture = plot.snapshots(solved["unequal"])
    row = [t.get_text() for t in picture.labels if -1.4 < t.get_position()[1] < -0.9]
    assert sorted(row) == ["0", "v", "v/2", "v/2"]


def test_snapshots_show_the_first_reflection_at_the_far_end(solved):
    times = moments(solved["unequal"], 7) * C / 0.4
    assert times == pytest.approx([0, 0.5, 1, 2, 2.5, 5, 7])


@pytest.mark.parametrize("width", [85, None])
def test_captions_of_a_contact_hide_the_lines_behind_them_and_stay_inside(
    solved, width
):
    for row in ("unequal", "wall"):
        with plot.look(width=width):
            picture = plot.contact(solved[row])
        render(picture)
        assert picture.marks
        for mark in picture.marks:
            paper = mark.get_bbox_patch().get_facecolor()
            assert paper == to_rgba(plot.style.colours().paper)
            lines = mark.axes.get_lines()
            assert mark.get_zorder() > max(line.get_zorder() for line in lines)
            box = mark.get_window_extent()
            assert box.x0 > 0
            assert box.x1 < mark.axes.bbox.x1 + 2


def test_the_last_mark_of_the_law_is_whole():
    picture = plot.restitution([0.5, 1.0], [0.5, 1.0])
    figure = picture.ax.figure
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    x, y = picture.ax.transData.transform((1.0, 1.0))
    row = np.asarray(canvas.buffer_rgba())[::-1][round(y)]
    outside = row[round(x) + 2 : round(x) + 6, :3]
    assert outside.min() < 120  # ink of the right half of the circle


@pytest.mark.parametrize("width", [85, None])
def test_labels_of_contours_keep_clear_of_each_other_of_lines_and_of_the_frame(width):
    lengths = np.linspace(0.1, 2, 40)[:, None]
    areas = np.linspace(1e-5, 3e-4, 30)
    family = ri.sweep(ri.System([rod(lengths, 1.0, area=areas), rod()]))
    with plot.look(width=width):
        picture = plot.sweep(family, quantity="velocity_after.0")
    assert collisions(picture) == []
    assert len(picture.labels) >= 5
    ax = picture.ax
    across = picture.theory[0].allsegs[0][0]  # equal transit times: an upright line
    line = ax.transData.transform(across)[0, 0]
    for label in picture.labels:
        x, _ = ax.transData.transform(label.get_position())
        half = 0.5 * 0.57 * 8 * len(label.get_text()) * ax.figure.dpi / 72
        angle = np.radians(label.get_rotation())
        assert abs(x - line) > half * abs(np.cos(angle))
        assert ax.bbox.x0 < x - half * abs(np.cos(angle))
        assert x + half * abs(np.cos(angle)) < ax.bbox.x1


# Members in no order ----------------------------------------------------------------------------


def scattered(shape):
    noise = np.random.default_rng(1)
    lengths = noise.uniform(0.3, 0.7, shape)
    areas = noise.uniform(1e-4, 3e-4, shape)
    return ri.System([rod(lengths, 1.0, area=areas), rod()])


def test_members_in_no_order_are_points_beside_a_histogram():
    family = ri.sweep(scattered(60))
    picture = plot.sweep(family)
    assert picture.values.get_linestyle() == "None"
    assert sorted(picture.values.get_ydata()) == pytest.approx(
        sorted(family.columns["restitution"])
    )
    assert sum(bar.get_width() for bar in picture.histogram) == 60
    assert collisions(picture) == []


def test_numbers_that_rise_together_are_a_curve():
    lengths = np.array([0.5, 0.3, 0.4, 0.8, 0.7, 0.6])
    family = ri.sweep(ri.System([rod(lengths, 1.0, area=lengths * 1e-4), rod()]))
    picture = plot.sweep(family)
    assert np.diff(picture.values.get_xdata()) == pytest.approx(0.1)
    assert not hasattr(picture, "histogram")


def test_a_map_of_members_in_no_order_is_refused_with_a_remedy_that_works():
    system = scattered((9, 1))
    both = system.replace(
        bodies=[system.bodies[0], rod(area=np.array([1e-4, 2e-4, 4e-4]))]
    )
    with pytest.raises(ValueError, match=r"no order along axis 0.*system\[:, 0\]"):
        plot.sweep(ri.sweep(both))
    assert plot.sweep(ri.sweep(both[:, 0])).histogram is not None


# Windows and style sheets -----------------------------------------------------------------------


def test_show_says_where_the_figure_is_without_a_display(solved, capsys, monkeypatch):
    monkeypatch.setattr(plt, "get_backend", lambda: "agg")
    assert plot.show(plot.energy(solved["unequal"])) is None
    said = capsys.readouterr().err
    assert "No window can be opened here" in said
    path = said.split("the figure is in ")[1].split(".png")[0] + ".png"
    with open(path, "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
