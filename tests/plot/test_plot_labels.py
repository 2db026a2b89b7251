"""Labels of figures can be read: none collide, none are cut, none are missing."""

import itertools
import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawing import STEEL, C, collisions, render, rod, texts_of
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.labels import spread_apart
from rodimpact.plot.moments import moments

pytestmark = pytest.mark.usefixtures("laid_out")

CONCRETE = ri.Material("concrete", youngs_modulus=30e9, density=2400)
POINTS_PER_INCH = 72
PNG = b"\x89PNG\r\n\x1a\n"


def ten_rods():
    """A rod that strikes a row of nine rods of different lengths; not solved."""
    striker = rod(0.2, 1.0)
    struck = [rod(0.2 + 0.01 * i) for i in range(9)]
    return ri.System([striker, *struck])


def stepped_pair():
    """A rod that strikes one of two segments across a gap; not solved."""
    thin = ri.Segment(0.3, 1e-4, STEEL)
    thick = ri.Segment(0.4, 3e-4, ri.materials.aluminium)
    struck = ri.Rod(segments=[thin, thick])
    return ri.System([rod(0.4, 2.0), struck], gaps=[5e-5])


def driven_pile():
    """A hammer, a rigid mass, that strikes a pile of concrete through a spring; the far
    end of the pile absorbs. Not solved.
    """
    hammer = ri.RigidMass(500.0, velocity=3.0)
    pile = ri.Rod(18.0, area=0.06, material=CONCRETE)
    ends = [ri.Free(), ri.Absorbing()]
    return ri.System([hammer, pile], contacts=[ri.Spring(5e8)], ends=ends)


SYSTEMS = {
    "unequal": ri.System([rod(0.4, 1.0), rod()]),
    "wall": ri.System([rod(0.5, 1.0), ri.Wall()]),
    "ten": ten_rods(),
    "short": ri.System([rod(0.03, 1.0), rod()]),
    "stepped": stepped_pair(),
    "pile": driven_pile(),
}
ENDS = {"pile": 0.03}  # s


def draw_lab(solution):
    """The space-time diagram with displacements."""
    return plot.spacetime(solution, coordinates="lab")


def draw_across(solution):
    """The space-time diagram with time from left to right."""
    return plot.spacetime(solution, across=True)


def draw_across_lab(solution):
    """The space-time diagram of stress with displacements, and time from left to right."""
    return plot.spacetime(solution, across=True, coordinates="lab", field="stress")


FIGURES = {
    "body": plot.spacetime,
    "lab": draw_lab,
    "across": draw_across,
    "across lab": draw_across_lab,
    "snapshots": plot.snapshots,
    "contact": plot.contact,
    "energy": plot.energy,
    "overview": plot.overview,
}


@pytest.fixture(scope="module")
def solved():
    """{name: solution} of `SYSTEMS`."""
    solutions = {}
    for name, system in SYSTEMS.items():
        solutions[name] = ri.solve(system, ENDS.get(name))
    return solutions


COLUMN = 85  # mm; the narrowest figures have the least space
WIDE = [("across lab", "ten", None), ("overview", "pile", None)]
CASES = [*itertools.product(FIGURES, SYSTEMS, [COLUMN]), *WIDE]
USUAL = [("lab", "pile", COLUMN)]


@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_labels_do_not_collide(solved, case):
    """In a figure of a row on a page of some width, no two labels overlap."""
    figure, row, width = case

    with plot.look(width=width):
        drawn = FIGURES[figure](solved[row])

    assert collisions(drawn) == []


@pytest.mark.parametrize(
    ("middles", "expected"),
    [
        ([0.0, 10.0], [0.0, 10.0]),
        ([0.0, 1.0], [-1.5, 2.5]),
    ],
)
def test_two_labels_that_overlap_are_spread_about_their_mean(middles, expected):
    widths = [4.0, 4.0]

    moved = spread_apart(middles, widths)

    assert moved == pytest.approx(expected)


def test_labels_that_overlap_are_spread_about_their_mean_and_others_stay():
    """Three overlapping labels of width 4 are moved 4 apart with the same mean; a lone
    one stays.
    """
    widths = [4.0, 4.0, 4.0, 4.0]

    moved = spread_apart([0.0, 1.0, 4.0, 30.0], widths)

    *overlapping, alone = moved
    least_distance = np.diff(moved).min()
    assert least_distance == pytest.approx(4.0)
    assert np.mean(overlapping) == pytest.approx(5 / 3)  # of 0, 1 and 4
    assert alone == 30.0


def axis_of_positions(ax, across):
    """The axis of x of a space-time diagram: the y axis if time runs `across`."""
    if across:
        return ax.yaxis
    return ax.xaxis


@pytest.mark.exhaustive
@pytest.mark.parametrize("across", few_of([False, True], [True]))
@pytest.mark.parametrize(
    ("row", "count"),
    [("ten", 10), pytest.param("short", 2, marks=pytest.mark.exhaustive)],
)
def test_ten_rods_are_all_named_and_short_rods_too(solved, row, count, across):
    """In a diagram of this row all `count` rods are named at the axis of positions, the
    y axis if time runs `across`.
    """
    ax = plot.spacetime(solved[row], across=across).ax

    names = []
    axis = axis_of_positions(ax, across)
    for label in texts_of(axis.get_minorticklabels()):
        *_, name = label.split("\n")  # it is below the symbol of the length, if any
        if name:
            names.append(name)
    assert len(names) == count


@pytest.mark.parametrize("across", few_of([False, True], [True]))
def test_a_rod_whose_middle_is_at_a_tick_is_named(solved, across):
    """The middle of a rod, 0.2 m, is a major tick: it is nevertheless a minor one,
    which bears the name, as that of the other rod.
    """
    ax = plot.spacetime(solved["unequal"], coordinates="lab", across=across).ax

    axis = axis_of_positions(ax, across)
    middles_of_rods = [0.2, 0.9]
    assert axis.get_minorticklocs() == pytest.approx(middles_of_rods)
    ticks = axis.get_majorticklocs().round(9)
    assert 0.2 in ticks


@pytest.mark.exhaustive
def test_a_short_rod_is_named_in_films(solved):
    film = plot.animation(solved["short"], frames=2)

    diagram = film.figure.axes[0]
    names = texts_of(diagram.get_xminorticklabels())
    assert names == ["\nrod 1", "\nrod 2"]  # in the line below the numbers


@pytest.mark.exhaustive
def test_a_short_rod_is_named_in_snapshots(solved):
    picture = plot.snapshots(solved["short"])

    names = texts_of(picture.ax.texts)
    assert "rod 1" in names
    assert "rod 2" in names


def words_along_fronts(picture):
    """Texts (artists) that name what a front adds to the stress."""
    words = []
    for text in picture.ax.texts:
        if text.get_text() in ("compression", "tension"):
            words.append(text)
    return words


def half_width(word, dpi):
    """Upper bound of half the width, in pixels, of a text that is turned."""
    angle = np.radians(word.get_rotation())
    height = word.get_fontsize()  # points
    mean_width_of_letter = 0.55 * height
    length = mean_width_of_letter * len(word.get_text())
    half_of_length = length / 2 * abs(np.cos(angle))
    whole_height = height * abs(np.sin(angle))  # half of it, and a margin
    points = half_of_length + whole_height
    return points * dpi / POINTS_PER_INCH


@pytest.mark.exhaustive
@pytest.mark.parametrize("width", few_of([85, None], [85]))
def test_words_along_fronts_keep_clear_of_the_contact(solved, width):
    """In a diagram of a given width, each word along a front is further from the line
    of the contact than half its own width.
    """
    with plot.look(width=width):
        picture = plot.spacetime(solved["unequal"])
    render(picture)

    to_pixels = picture.ax.transData.transform
    dpi = picture.ax.figure.dpi
    first_line, *_ = picture.pressing.get_segments()  # [point, (x, t)]
    x_of_contact = first_line[0, 0]
    contact, _ = to_pixels((x_of_contact, 0.0))
    half_line = 1.5 * dpi / POINTS_PER_INCH  # of a width of 3 points
    words = words_along_fronts(picture)
    assert words
    for word in words:
        middle, _ = to_pixels(word.get_position())
        distance = abs(middle - contact)
        assert distance > half_width(word, dpi) + half_line


@pytest.mark.exhaustive
def test_every_narrow_piece_has_its_own_label(solved):
    """The second snapshot has four pieces, two of which are narrow."""
    with plot.look(width=85):
        picture = plot.snapshots(solved["unequal"])

    # Snapshots stand at y = 0, -1, -2 ...: labels of the second lie about -1.
    second_row = []
    for label in picture.labels:
        _, y = label.get_position()
        if -1.4 < y < -0.9:
            second_row.append(label.get_text())
    assert sorted(second_row) == ["0", "v", "v/2", "v/2"]


def test_snapshots_show_the_first_reflection_at_the_far_end(solved):
    transit = 0.4 / C  # of the striker

    times = moments(solved["unequal"], 7) / transit

    # The wave is reflected at the far end of the struck rod, of 1 m, at 2.5 transits.
    assert times == pytest.approx([0, 0.5, 1, 2, 2.5, 5, 7])


@pytest.mark.exhaustive
@pytest.mark.parametrize("width", few_of([85, None], [85]))
@pytest.mark.parametrize("row", few_of(["unequal", "wall"], ["unequal"]))
def test_captions_of_a_contact_hide_the_lines_behind_them_and_stay_inside(
    solved, row, width
):
    """The captions of events in the figure of a contact have the colour of the paper as
    background, lie above all lines, and end within the axes.
    """
    with plot.look(width=width):
        picture = plot.contact(solved[row])
    render(picture)

    paper = to_rgba(plot.style.colours().paper)
    assert picture.marks
    for mark in picture.marks:
        ax = mark.axes
        background = mark.get_bbox_patch()
        assert background.get_facecolor() == paper
        highest_line = max(line.get_zorder() for line in ax.get_lines())
        assert mark.get_zorder() > highest_line
        box = mark.get_window_extent()
        assert box.x0 > 0
        assert box.x1 < ax.bbox.x1 + 2  # pixels


def test_the_last_circle_of_computed_restitutions_is_whole():
    """The frame does not cut the circle of the computed e = 1 at l1/l2 = 1, at the
    edge of the diagram: its right half has ink.
    """
    ratios = [0.5, 1.0]
    picture = plot.restitution(ratios, values=ratios)
    canvas = FigureCanvasAgg(picture.ax.figure)

    canvas.draw()

    x, y = picture.ax.transData.transform((1.0, 1.0)).round().astype(int)
    pixels = np.asarray(canvas.buffer_rgba())[::-1]  # [row from below, column, colour]
    # The rim is 2 to 5 pixels right of the centre.
    right_half = pixels[y, x + 2 : x + 6, :3]
    assert right_half.min() < 120  # darker than the paper, 255


@pytest.mark.exhaustive
@pytest.mark.parametrize("width", few_of([85, None], [85]))
def test_labels_of_contours_keep_clear_of_each_other_of_lines_and_of_the_frame(width):
    """On a map of a given width, at least five labels of contours overlap neither each
    other nor the line of equal transit times, and lie within the frame.
    """
    lengths = np.linspace(0.1, 2, 40)[:, np.newaxis]
    areas = np.linspace(1e-5, 3e-4, 30)
    striker = rod(lengths, 1.0, area=areas)
    result = ri.sweep(ri.System([striker, rod()]))

    with plot.look(width=width):
        picture = plot.sweep(result, quantity="velocity_after.0")

    assert collisions(picture) == []
    assert len(picture.labels) >= 5
    ax = picture.ax
    box = ax.bbox
    to_pixels = ax.transData.transform
    equal_transits, *_ = picture.theory
    upright_line = equal_transits.allsegs[0][0]  # [point, (x, y)]
    x_of_line, _ = to_pixels(upright_line)[0]
    for label in picture.labels:
        x, _ = to_pixels(label.get_position())
        angle = np.radians(label.get_rotation())
        half = length_of(label) / 2 * abs(np.cos(angle))
        assert abs(x - x_of_line) > half
        assert box.x0 < x - half
        assert x + half < box.x1


def length_of(label):
    """Length of the text of a contour's label, of 8 points, in pixels."""
    mean_width_of_digit = 0.57 * 8  # points
    points = mean_width_of_digit * len(label.get_text())
    return points * label.axes.figure.dpi / POINTS_PER_INCH


@pytest.mark.exhaustive
def test_no_dot_of_a_contour_is_left_between_its_label_and_the_frame():
    """On a map, each label of a contour ends more than 6 points before the frame, so
    that no short rest of the line is seen between.
    """
    lengths = np.linspace(0.05, 1.5, 200)[:, np.newaxis]
    areas = np.geomspace(1e-5, 1e-3, 200)
    family = ri.System([rod(lengths, 1.0), rod(area=areas)])

    picture = plot.sweep(ri.sweep(family))

    ax = picture.ax
    box = ax.bbox
    point = ax.figure.dpi / POINTS_PER_INCH  # pixels
    assert len(picture.labels) >= 4
    for label in picture.labels:
        x, y = ax.transData.transform(label.get_position())
        half = length_of(label) / 2
        to_frame = min(x - box.x0, box.x1 - x, y - box.y0, box.y1 - y)
        assert to_frame - half > 6 * point


# Members in no order


def random_family(shape):
    """Strikers of random lengths and areas, a family of this shape; not solved."""
    rng = np.random.default_rng(1)
    lengths = rng.uniform(0.3, 0.7, shape)
    areas = rng.uniform(1e-4, 3e-4, shape)
    striker = rod(lengths, 1.0, area=areas)
    return ri.System([striker, rod()])


@pytest.mark.exhaustive
def test_members_in_no_order_are_points_beside_a_histogram():
    """A sweep over 60 random members is drawn as points without lines, with a histogram
    of all 60 beside them; no texts overlap.
    """
    result = ri.sweep(random_family(60))

    picture = plot.sweep(result)

    points = picture.values
    assert points.get_linestyle() == "None"
    drawn = sorted(points.get_ydata())
    restitutions = sorted(result.columns["restitution"])
    assert drawn == pytest.approx(restitutions)
    counts = [bar.get_width() for bar in picture.histogram]
    assert sum(counts) == 60
    assert collisions(picture) == []


def test_numbers_that_rise_together_are_a_curve():
    """Lengths are in no order, but areas rise with them."""
    lengths = np.array([0.5, 0.3, 0.4, 0.8, 0.7, 0.6])
    areas = lengths * 1e-4  # they rise with the lengths
    family = ri.System([rod(lengths, 1.0, area=areas), rod()])

    picture = plot.sweep(ri.sweep(family))

    drawn_lengths = picture.values.get_xdata()
    assert np.diff(drawn_lengths) == pytest.approx(0.1)  # in increasing order
    assert not hasattr(picture, "histogram")


def test_a_map_of_members_in_no_order_is_refused_with_a_remedy_that_works():
    """A family whose first axis has no order is refused, with the advice to draw a part
    of it; this part is drawn with a histogram.
    """
    random_rods, _ = random_family((9, 1)).bodies
    areas = np.array([1e-4, 2e-4, 4e-4])
    rods_in_order = rod(area=areas)
    family = ri.System([random_rods, rods_in_order])  # no order along axis 0 alone

    with pytest.raises(ValueError, match=r"no order along axis 0.*system\[:, 0\]"):
        plot.sweep(ri.sweep(family))
    picture = plot.sweep(ri.sweep(family[:, 0]))

    assert picture.histogram is not None  # as of all members in no order


# Windows


@pytest.mark.exhaustive
def test_show_names_the_file_of_the_figure_without_a_display(
    solved, capsys, monkeypatch
):
    """Without a display, `show` returns None, and standard error names a PNG file in
    which the figure is.
    """
    monkeypatch.setattr(plt, "get_backend", lambda: "agg")
    picture = plot.energy(solved["unequal"])

    assert plot.show(picture) is None

    message = capsys.readouterr().err
    assert "No window can be opened here" in message
    path = re.search(r"the figure is in (.*\.png)", message)[1]
    with open(path, "rb") as file:
        assert file.read(len(PNG)) == PNG
