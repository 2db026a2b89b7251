"""Figures: they show the solution, to scale, labelled, and are the same every time."""

import re
import subprocess
import sys
from inspect import signature

import matplotlib as mpl
import numpy as np
import pytest
from drawing import (
    STEEL,
    C,
    axes,
    corners,
    legend,
    render,
    rod,
    settings,
    texts_of,
    top_of,
    vector_file,
)
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from systems import horizon, random_system

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.moments import moments, round_trips
from rodimpact.plot.style import RISING

MINUS = "\N{MINUS SIGN}"
MICROSECONDS = 1e6  # in a second
AREA = 1e-4  # m^2, of `rod`
POINTS_PER_INCH = 72


def stepped_rod():
    """A rod of two segments, of 0.3 m and of 0.4 m with the threefold area."""
    thin = ri.Segment(0.3, AREA, STEEL)
    thick = ri.Segment(0.4, 3 * AREA, STEEL)
    return ri.Rod(segments=[thin, thick])


def bonded_rods():
    """A rod that strikes two bonded rods; not solved."""
    rods = [rod(0.4, 1.0), rod(0.3, area=2e-4), rod(0.6)]
    return ri.System(rods, contacts=[ri.Rigid(), ri.Bonded()])


def between_walls():
    """A rod that flies between two walls; not solved."""
    bodies = [ri.Wall(), rod(0.3, 10.0), ri.Wall()]
    return ri.System(bodies, gaps=[1e-3, 2e-3])


def with_moving_wall():
    """A wall that moves against two rods, the second of which comes to meet it; not
    solved.
    """
    bodies = [ri.Wall(2.0), rod(0.4), rod(0.6, -1.0)]
    return ri.System(bodies, gaps=[5e-5, 2e-5])


SYSTEMS = {
    "identical": ri.System([rod(velocity=1.0), rod()]),
    "unequal": ri.System([rod(0.4, 1.0), rod()]),
    "wall": ri.System([rod(0.5, 1.0), ri.Wall()]),
    "impedances": ri.System([rod(0.25, 1.0, area=3e-4), rod()]),
    "stepped": ri.System([rod(0.4, 2.0), stepped_rod()]),
    "cradle": ri.System([rod(velocity=1.0), rod(), rod(), rod(), rod()]),
    "bouncing": between_walls(),
    "released": ri.System([rod(0.5, strain=-1e-4), rod()], gaps=[1e-6]),
    "receding": ri.System([rod(0.5, -1.0), rod(1.0, 0.5)]),
    "single": ri.System([rod(0.5, 1.0)]),
    "tiny": ri.System([rod(0.4, 1e-9), rod()]),
    "drifting": ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]),
    "closing gap": ri.System([rod(0.4, 1.0), rod(0.6)], gaps=[5e-5]),
    "moving wall": with_moving_wall(),
    "bonded": bonded_rods(),
    "at rest": ri.System([rod(), rod()]),
}
ENDS = {  # ends of runs that have no end of their own, s
    "bouncing": 8e-4,
    "released": 1e-3,
    "single": 4e-4,
    "moving wall": 1e-3,
    "at rest": 1e-3,
}
MOST_DIFFERENT = {"bonded", "drifting", "moving wall"}
every_row = pytest.mark.parametrize("name", SYSTEMS)
some_rows = pytest.mark.parametrize("name", few_of(SYSTEMS, MOST_DIFFERENT))


@pytest.fixture(scope="module")
def solved():
    """{name: solution} of `SYSTEMS`."""
    solutions = {}
    for name, system in SYSTEMS.items():
        solutions[name] = ri.solve(system, ENDS.get(name))
    return solutions


def fronts(picture):
    """The collection of the lines of all fronts."""
    for lines in picture.ax.collections:
        if lines.get_label() == "fronts":
            return lines
    raise AssertionError("the picture has no fronts")


def polygon_area(points):
    """Area of a polygon of points [point, (x, y)], by the shoelace formula."""
    x, y = points.T
    next_x = np.roll(x, -1)
    next_y = np.roll(y, -1)
    twice_the_area = np.dot(x, next_y) - np.dot(y, next_x)
    return abs(twice_the_area) / 2


# Space-time diagram


@some_rows
def test_regions_tile_each_rod_between_its_ends(solved, name):
    """Areas of all regions sum to the area between the ends, in position and time."""
    picture = plot.spacetime(solved[name], axes())

    # Paths of the left and the right end of each rod in turn, [point, (x, t)]
    paths = picture.ends.get_segments()
    rod_area = 0.0
    for left, right in zip(paths[::2], paths[1::2], strict=True):
        outline = np.concatenate((left, right[::-1]))
        rod_area += polygon_area(outline)
    region_area = sum(map(polygon_area, corners(picture)))
    assert region_area == pytest.approx(rod_area, rel=1e-9)


@some_rows
def test_rods_never_overlap_and_gaps_are_drawn_to_the_same_scale(solved, name):
    """The distance of drawn ends is the gap of the solution, magnified as displacements
    are.
    """
    solution = solved[name]
    magnification = 50.0

    picture = plot.spacetime(
        solution, axes(), coordinates="lab", magnification=magnification
    )

    time_unit = picture.ax.get_ylabel()[-3:-1]  # the label ends with "(µs)" or "(ms)"
    units_per_second = {"µs": 1e6, "ms": 1e3}[time_unit]
    times = np.linspace(0, solution.t_end, 50)  # s

    def positions(path):
        """Positions of an end at the times, from its path [point, (x, t)]."""
        x, t = path.T
        return np.interp(times, t / units_per_second, x)

    # Paths of the left and the right end of each rod in turn
    paths = picture.ends.get_segments()
    right_ends = paths[1:-1:2]  # of each rod but the last one
    left_ends = paths[2::2]  # of the next rod
    bodies = solution.system.bodies
    rods = [i for i, body in enumerate(bodies) if isinstance(body, ri.Rod)]
    for right, left, k in zip(right_ends, left_ends, rods, strict=False):
        # The contact between two bodies has the number of the first one.
        gap = magnification * solution.contacts[k].gap(times)
        drawn_gap = positions(left) - positions(right)
        assert drawn_gap == pytest.approx(gap, abs=1e-9)


FIELDS = ["velocity", "stress", "strain"]


@pytest.mark.parametrize("name", few_of(SYSTEMS, {"drifting"}))
@pytest.mark.parametrize("field", few_of(FIELDS, ["velocity"]))
def test_colour_limits_are_symmetric_about_rest_and_hold_all_values(
    solved, name, field
):
    """The limits of the colours enclose all drawn values, and their middle is 0, or the
    drift for the velocity of a drifting row.
    """
    picture = plot.spacetime(solved[name], axes(), field)

    at_rest = 0.0
    if (name, field) == ("drifting", "velocity"):
        at_rest = 100.0  # m/s, of the drift
    norm = picture.regions.norm
    values = picture.regions.get_array()
    middle = (norm.vmin + norm.vmax) / 2
    assert middle == pytest.approx(at_rest, abs=1e-9)
    assert norm.vmin <= values.min() <= values.max() <= norm.vmax
    assert norm.vmax > norm.vmin


@pytest.mark.parametrize(
    ("field", "scale"),
    [
        pytest.param("velocity", 1.0, marks=pytest.mark.exhaustive),
        ("stress", 1e-6),
        pytest.param("strain", 1e6, marks=pytest.mark.exhaustive),
    ],
)
def test_colour_of_each_region_is_the_field_in_its_middle(solved, field, scale):
    """The value drawn for each region of a diagram is the field of the solution at the
    mean of its corners, in the unit of the picture.
    """
    solution = solved["impedances"]
    regions = ri.regions_of(solution)

    values = plot.spacetime(solution, axes(), field).regions.get_array()

    field_at = getattr(solution, field)
    for i, begin in enumerate(regions.start[:-1]):
        end = regions.start[i + 1]
        x = regions.x[begin:end].mean()  # of the corners
        t = regions.t[begin:end].mean()
        body = int(regions.body[i])
        expected = float(field_at(body, x, t)) * scale
        assert values[i] == pytest.approx(expected, abs=1e-9)


@pytest.fixture(scope="module")
def crowded_solution():
    """The solution of a collision with so many fronts that lines at all of them would
    fill the diagram.
    """
    segments = []
    for i in range(5):
        length = 0.1 + 0.03 * (7 * i % 5)  # each one another, in no order
        area = AREA * (1 + 3 * i % 4)
        segments.append(ri.Segment(length, area, STEEL))
    struck = ri.Rod(segments=segments)
    return ri.solve(ri.System([rod(0.4, 1.0), struck]))


@pytest.fixture(scope="module")
def crowded_picture(crowded_solution):
    """The space-time diagram of `crowded_solution`."""
    return plot.spacetime(crowded_solution, axes())


@pytest.mark.exhaustive
def test_a_crowd_has_lines_at_its_strongest_fronts_alone(crowded_picture):
    """Fewer than a third of the regions have a line, and lines are 12 points apart in
    the mean.
    """
    ax = crowded_picture.ax
    lines = fronts(crowded_picture).get_segments()
    n_regions = crowded_picture.regions.get_array().size
    assert 10 < len(lines) < n_regions / 3

    points_per_pixel = POINTS_PER_INCH / ax.figure.dpi
    pixels = ax.transData.transform(np.concatenate(lines))
    ends = pixels.reshape(-1, 2, 2) * points_per_pixel  # [line, end, (x, y)], points
    dx, dy = (ends[:, 1] - ends[:, 0]).T
    length_of_all_lines = np.hypot(dx, dy).sum()
    width, height = ax.get_window_extent().size * points_per_pixel
    # Lines are 12 points apart or more, in the mean.
    assert length_of_all_lines <= width * height / 12


@pytest.mark.exhaustive
def test_the_strongest_front_of_a_crowd_has_a_line(crowded_picture):
    """The first front into the struck rod is 0.5 m/s strong, most others are faint."""
    impact = np.array([0.4, 0.0])  # m, us
    distances = []
    for line in fronts(crowded_picture).get_segments():
        start, end = line[:2]
        distances.append(np.abs(start - impact).max())
        distances.append(np.abs(end - impact).max())
    assert min(distances) < 1e-9


def test_bars_of_a_crowd_merge_and_keep_length_and_momentum(crowded_solution):
    """In a snapshot with many pieces, those of nearly the same velocity are drawn as
    one bar: fewer than half as many, with the length and momentum of both rods.
    """
    end = crowded_solution.t_end

    stages = plot.snapshots(crowded_solution, axes(), [end], magnification=1.0)

    boxes = [path.get_extents() for path in stages.bars.get_paths()]
    widths = np.array([box.width for box in boxes])
    fields = crowded_solution.fields
    n_pieces = 0
    momentum = 0.0  # of a unit of mass per length: the integral of velocity, m^2/s
    for body in (0, 1):
        profile = fields.profile(body, fields.end)
        n_pieces += profile.velocity.size
        lengths = np.diff(profile.edges)
        momentum += float(profile.velocity @ lengths)
    assert len(boxes) < n_pieces / 2
    assert widths.sum() == pytest.approx(1.2, abs=1e-3)  # m, of both rods
    drawn_momentum = stages.bars.get_array() @ widths
    assert drawn_momentum == pytest.approx(momentum, rel=1e-3)


def times_of_ends(line):
    """Times of the first and the last point of a line [point, (x, t)]."""
    times = line[:, 1]
    return times[0], times[-1]


def test_contact_presses_then_touches_then_opens(solved):
    """In a diagram of two unequal rods, the contact presses until the wave is back from
    the free end of the striker, touches until that of the struck rod is back, and is
    apart until the run ends; pressing is drawn wider, and the legend names all three.
    """
    transit = 0.4 / C * MICROSECONDS  # of the striker
    force_end = 2 * transit
    opening = 5 * transit  # 2 l2/c, with l2 = 1 m = 2.5 l1
    end = 7 * transit

    picture = plot.spacetime(solved["unequal"], axes())

    (pressing,) = picture.pressing.get_segments()
    (touching,) = picture.touching.get_segments()
    (apart,) = picture.apart.get_segments()
    assert times_of_ends(pressing) == pytest.approx((0, force_end))
    assert times_of_ends(touching) == pytest.approx((force_end, opening))
    assert times_of_ends(apart) == pytest.approx((opening, end))
    positions = apart[:, 0]
    assert positions == pytest.approx([0.4, 0.4])
    pressing_width, *_ = picture.pressing.get_linewidth()
    touching_width, *_ = picture.touching.get_linewidth()
    assert pressing_width > touching_width
    assert legend(picture) == ["pressing", "touching", "apart"]


def test_axes_carry_units_and_the_magnification(solved):
    """The labels of a diagram of stress name m, us and MPa, and end with the
    magnification of the displacements.
    """
    picture = plot.spacetime(solved["unequal"], axes(), "stress", coordinates="lab")

    ax = picture.ax
    label = ax.get_xlabel()
    assert "(m)" in label
    assert label.endswith("displacements \N{MULTIPLICATION SIGN} 2000")
    assert ax.get_ylabel() == "time t (µs)"
    colour_bar = picture.colour_bar.ax
    assert colour_bar.get_ylabel() == "stress, tension positive (MPa)"


def test_units_fit_the_numbers(solved):
    """Small and large values have a prefix in the labels: nm/s, ms."""
    strain = plot.spacetime(solved["unequal"], axes(), "strain")
    slow = plot.spacetime(solved["tiny"], axes())
    long = plot.spacetime(solved["cradle"], axes())

    bar_of_strain = strain.colour_bar.ax
    bar_of_slow = slow.colour_bar.ax
    assert bar_of_strain.get_ylabel() == "strain (10⁻⁶)"
    assert bar_of_slow.get_ylabel() == "velocity (nm/s)"
    assert long.ax.get_ylabel() == "time t (ms)"


@pytest.mark.exhaustive
def test_a_drifting_row_is_drawn_in_a_moving_frame(solved):
    """A row that drifts at 100 m/s is drawn in a frame that moves at this speed, and
    its label says so. The regions have the corners of the row without drift.
    """
    still = plot.spacetime(solved["unequal"], axes(), coordinates="lab")
    drifting = plot.spacetime(solved["drifting"], axes(), coordinates="lab")

    label = drifting.ax.get_xlabel()
    assert "frame moving at 100 m/s" in label
    assert "frame" not in still.ax.get_xlabel()
    pairs = zip(corners(still), corners(drifting), strict=True)
    for still_corners, drifting_corners in pairs:
        assert still_corners == pytest.approx(drifting_corners, abs=1e-6)


def face_of(wall):
    """Positions of the face of a drawn wall, at the start and the end of the run.

    They are x of the first two corners [corner, (x, t)].
    """
    return wall.get_xy()[:2, 0]


def test_a_wall_is_hatched(solved):
    (wall,) = plot.spacetime(solved["wall"], axes()).walls

    assert wall.get_hatch()
    assert face_of(wall) == pytest.approx([0.5, 0.5])


def test_a_wall_moves_as_it_does(solved):
    """In a diagram without magnification, the face of a wall of 2 m/s begins at 0 and
    ends at the distance it has moved.
    """
    solution = solved["moving wall"]

    picture = plot.spacetime(solution, axes(), coordinates="lab", magnification=1.0)

    (wall,) = picture.walls
    distance = 2.0 * ENDS["moving wall"]
    assert face_of(wall) == pytest.approx([0.0, distance])


def test_dimensionless_diagram_has_the_textbook_numbers(solved):
    """Lengths and times are those of the striker, stress is that of its velocity."""
    picture = plot.spacetime(solved["unequal"], axes(), "stress", dimensionless=True)

    stress = picture.regions.get_array()
    assert stress.min() == pytest.approx(-0.5, abs=1e-12)
    assert stress.max() == pytest.approx(0.5, abs=1e-12)
    _, times = np.concatenate(corners(picture)).T
    expected = [0, 1, 2, 2.5, 3.5, 4.5, 5, 6, 7]
    assert np.unique(times.round(9)) == pytest.approx(expected)
    (pressing,) = picture.pressing.get_segments()
    start_of_contact, *_ = pressing  # (x, t)
    assert start_of_contact == pytest.approx([1, 0])
    ax = picture.ax
    assert "c/ℓ₁" in ax.get_ylabel()
    assert "x/ℓ₁" in ax.get_xlabel()


@pytest.mark.parametrize(("field", "largest"), [("velocity", 1.0), ("strain", 0.5)])
def test_dimensionless_fields_have_the_textbook_numbers(solved, field, largest):
    picture = plot.spacetime(solved["unequal"], axes(), field, dimensionless=True)

    values = picture.regions.get_array()
    assert values.max() == pytest.approx(largest)


@pytest.mark.parametrize(
    ("name", "limits", "values"),
    [
        pytest.param(
            "unequal", (0.0, 1.0), {"0", "0.5", "1"}, marks=pytest.mark.exhaustive
        ),
        ("wall", (-1.0, 1.0), {"1", "0", MINUS + "1"}),
        ("drifting", (100, 101), {"101", "100.5", "100"}),
    ],
)
def test_the_colour_bar_shows_the_colours_in_use_and_labels_are_its_values(
    solved, name, limits, values
):
    picture = plot.spacetime(solved[name])

    colour_bar = picture.colour_bar.ax
    assert colour_bar.get_ylim() == pytest.approx(limits)
    assert set(texts_of(picture.labels)) == values


NAN = float("nan")
MOVED_IN_BODY = {"coordinates": "body", "magnification": 2.0}
REFUSED = [
    (plot.spacetime, {"field": "heat"}, "'velocity', 'stress', 'strain'"),
    (plot.spacetime, {"magnification": 0.0}, "magnification"),
    (plot.spacetime, {"magnification": NAN}, "magnification"),
    (plot.spacetime, {"start": 2e-4, "stop": 1e-4}, "stop: must be later"),
    (plot.spacetime, {"stop": 1.0}, "t: must lie in the solution"),
    (plot.spacetime, {"coordinates": "rod"}, "'lab', 'body'"),
    (plot.spacetime, MOVED_IN_BODY, "magnification: nothing moves"),
    (plot.snapshots, {"times": []}, "at least one time"),
    (plot.snapshots, {"times": [1.0]}, "must lie in the solution"),
    (plot.snapshots, {"gauges": [(1, 0.0)]}, "must be records by name"),
    (plot.contact, {"contact": 1}, "from 0 to 0, got 1"),
    (plot.contact, {"ax": axes()}, "ax: needs a pair of Axes"),
    (plot.contact, {"ax": [axes()]}, "ax: needs a pair of Axes"),
    (plot.animation, {"field": "energy"}, "field: must be one of 'velocity', 'stress'"),
    (plot.animation, {"frames": 1}, "frames: must be a whole number from 2 to 10000"),
    (plot.animation, {"frames": 2.5}, "frames"),
    (plot.animation, {"fps": 51}, "fps: must be 1 to 50"),
    (plot.animation, {"fps": NAN}, "fps"),
    (plot.animation, {"stop": 0.0}, "stop: must be later than start"),
    (plot.animation, {"stop": 1.0}, r"t\[1\]: must lie in the solution"),
    (plot.animation, {"magnification": -1.0}, "magnification"),
]


@pytest.mark.parametrize(("draw", "wrong", "named"), REFUSED)
def test_wrong_arguments_are_named(solved, draw, wrong, named):
    with pytest.raises(ri.InvalidModel, match=named):
        draw(solved["unequal"], **wrong)


def test_a_single_rod_has_no_contact_to_draw(solved):
    with pytest.raises(ValueError, match="two bodies"):
        plot.contact(solved["single"])


def major_ticks(axis):
    """Places of the numbers of an axis, by their texts."""
    texts = texts_of(axis.get_ticklabels())
    return dict(zip(texts, axis.get_majorticklocs(), strict=True))


def minor_ticks(axis):
    """Places of the names of an axis, by their texts."""
    texts = texts_of(axis.get_ticklabels(minor=True))
    return dict(zip(texts, axis.get_minorticklocs(), strict=True))


def test_the_axes_show_lengths_names_and_round_trips(solved):
    """The axes of a diagram have marks at the ends of the rods and their round trips,
    and names in the middle; numbers that would touch a name are left out.
    """
    ax = plot.spacetime(solved["unequal"]).ax

    lengths = major_ticks(ax.xaxis)
    names = minor_ticks(ax.xaxis)
    times = major_ticks(ax.yaxis)
    assert lengths == pytest.approx({"0": 0.0, "0.4": 0.4, "1.4": 1.4})
    assert names == pytest.approx({"ℓ₁\nrod 1": 0.2, "ℓ₂\nrod 2": 0.9})
    first_round_trip = 2 * 0.4 / C * MICROSECONDS
    second_round_trip = 2 * 1.0 / C * MICROSECONDS
    assert times["2 ℓ₁/c"] == pytest.approx(first_round_trip)
    assert times["2 ℓ₂/c"] == pytest.approx(second_round_trip)
    assert "100" in times
    # Numbers that would touch a name are left out.
    distances = np.diff(sorted(times.values()))
    assert min(distances) > 20


@pytest.mark.exhaustive
def test_round_trips_stand_at_the_axis_of_times_if_contact_begins_with_the_run(solved):
    """The axis of times has the names of round trips if contact begins at 0, here with
    time across, and none if a gap closes first.
    """
    time_across = plot.spacetime(solved["unequal"], axes(), across=True)
    later_contact = plot.spacetime(solved["closing gap"], axes())

    assert "2 ℓ₁/c" in major_ticks(time_across.ax.xaxis)
    for name in major_ticks(later_contact.ax.yaxis):
        assert "c" not in name  # as in the names of round trips, over c


def test_times_of_a_longer_row_are_not_named_by_lengths_that_add_up():
    """Three rods leave a wall after 2 (l1 + l2 + l3)/c, which is 4 l3/c by chance."""
    rods = [rod(0.2, 1.0), rod(0.3, 1.0), rod(0.5, 1.0)]

    solution = ri.solve(ri.System([*rods, ri.Wall()]))

    *_, contact_at_wall = solution.contacts
    opening = contact_at_wall.episodes[0].opening
    assert opening == pytest.approx(4 * 0.5 / C)
    assert opening not in round_trips(solution)


def test_round_trips_of_two_materials_have_two_speeds():
    """For rods of two materials, the marks of round trips name the length and the speed
    with the same index.
    """
    second = rod(material=ri.materials.aluminium)
    solution = ri.solve(ri.System([rod(0.4, 1.0), second]))

    names = round_trips(solution).values()

    assert names
    for name in names:
        # Such as "2 ℓ₁/c₁": the index of the length and of the speed are the same.
        assert re.fullmatch("[0-9]+ .([₁₂])/c\\1", name)


def test_fronts_are_named_by_what_they_add_to_the_stress(solved):
    """In a diagram of stress of a rod at a wall, the first front is named compression
    and its reflection tension, each in the middle of its path.
    """
    transit = 0.5 / C * MICROSECONDS

    picture = plot.spacetime(solved["wall"], field="stress")

    positions = {}
    for text in picture.ax.texts:
        word = text.get_text()
        if word.isalpha():
            positions[word] = text.get_position()  # (x, t)
    assert set(positions) == {"compression", "tension"}
    # The middle of the first front and of its reflection, in a rod of 0.5 m
    assert positions["compression"] == pytest.approx((0.25, 0.5 * transit))
    assert positions["tension"] == pytest.approx((0.25, 1.5 * transit))


def test_centres_of_mass_are_dashed_and_move_as_they_do(solved):
    """In a magnified diagram, the line of each centre has the slope of the mean
    velocity of its rod and begins at its centre of mass, also for a stepped rod; the
    legend names it.
    """
    solution = solved["stepped"]
    magnification = 100.0

    picture = plot.spacetime(
        solution, axes(), coordinates="lab", magnification=magnification
    )

    assert "centre of mass" in legend(picture)
    for body, line in enumerate(picture.centres):
        x, t = line.get_data()
        times = t / MICROSECONDS
        drawn_velocity = np.diff(x) / np.diff(times)
        middles = (times[1:] + times[:-1]) / 2
        velocity = magnification * solution.mean_velocity(body, middles)
        assert drawn_velocity == pytest.approx(velocity, abs=1.0)
    first, second = picture.centres
    first_start, *_ = first.get_xdata()
    second_start, *_ = second.get_xdata()
    # Of 0.3 m with a centre at 0.15 m, and 0.4 m of the threefold area at 0.5 m
    in_stepped_rod = (0.3 * 0.15 + 3 * 0.4 * 0.5) / (0.3 + 3 * 0.4)
    assert first_start == pytest.approx(0.2)
    assert second_start == pytest.approx(0.4 + in_stepped_rod)


def test_rods_that_are_drawn_without_displacement_have_no_centres_of_mass(solved):
    picture = plot.spacetime(solved["stepped"], axes())

    assert picture.centres == []


# Snapshots


def test_moments_are_events_and_times_between_them(solved):
    """Moments are the times at which snapshots are drawn."""
    # Times in units of the transit time of the first rod, of 1 m and of 0.4 m
    of_identical = moments(solved["identical"]) * C
    of_unequal = moments(solved["unequal"]) * C / 0.4

    assert of_identical == pytest.approx([0, 0.5, 1, 1.5, 2, 4])
    assert of_unequal == pytest.approx([0, 0.5, 1, 2, 2.5, 4.5, 5, 7])


@every_row
def test_moments_are_few_and_inside_the_solution(solved, name):
    """The `moments` of a solution are three to eight rising times, from 0 to the end of
    the run.
    """
    solution = solved[name]

    times = moments(solution)

    assert 3 <= times.size <= 8
    assert times[0] == 0
    assert times[-1] == pytest.approx(solution.t_end)
    assert np.all(np.diff(times) > 0)


def test_pieces_bear_their_velocity_in_parts_of_the_closing_speed(solved):
    """Snapshots of two equal rods at three times: each uniform piece is labelled v, v/2
    or 0, times are in us and transits, and both fronts have arrows.
    """
    picture = plot.snapshots(solved["identical"], times=[0.0, 0.5 / C, 3 / C])

    # Two rods at 0 s, four pieces as two fronts run, two rods at the end
    velocities = ["v", "0", "v", "v/2", "v/2", "0", "0", "v"]
    assert texts_of(picture.labels) == velocities
    ax = picture.ax
    assert "v = 1 m/s" in ax.get_xlabel()
    times = ["0 µs\n0 ℓ₁/c", "99.06 µs\n0.5 ℓ₁/c", "594.3 µs\n3 ℓ₁/c"]
    assert texts_of(ax.get_yticklabels()) == times
    directions = [line.get_marker() for line in picture.fronts]
    assert directions == ["<", ">"]


def test_compressed_pieces_are_shorter_and_thicker(solved):
    """In a snapshot, the compressed piece of a rod is narrower and higher than the free
    one beside it.
    """
    picture = plot.snapshots(solved["identical"], times=[0.0, 0.5 / C, 3 / C])

    # Two rods at 0 s, then the pieces on both sides of the two fronts
    boxes = [path.get_extents() for path in picture.bars.get_paths()]
    whole_rod, _, free_piece, pressed_piece, *_ = boxes
    assert whole_rod.width == pytest.approx(1.0)
    assert pressed_piece.width < free_piece.width
    assert pressed_piece.height > free_piece.height


def test_pieces_of_rods_that_do_not_close_bear_their_velocity(solved):
    """In a snapshot of receding rods, pieces are labelled with their velocities in m/s,
    as the axis says, not as shares of a closing speed.
    """
    picture = plot.snapshots(solved["receding"], times=[0.0])

    velocities = [MINUS + "1", "0.5"]
    assert texts_of(picture.labels) == velocities
    label = picture.ax.get_xlabel()
    assert "\nvelocities (m/s)\n" in label


# Histories


def test_the_force_is_drawn_as_exact_steps(solved):
    """The contact force of rods with an impedance ratio of 3 is drawn in kN as steps,
    halved in each round trip, up to the end of the run.
    """
    solution = solved["impedances"]
    transit = 0.25 / C * MICROSECONDS
    first_force = STEEL.density * C * AREA * 0.75  # Z1 Z2/(Z1 + Z2) = 3/4 Z2

    drawn = plot.contact(solution)

    steps = drawn.forces[0].get_data()
    first_edges = transit * np.array([0, 2, 4, 6, 8])
    assert steps.edges[:5] == pytest.approx(first_edges)
    end = solution.t_end * MICROSECONDS
    assert steps.edges[-1] == pytest.approx(end)
    first_forces = first_force / 2.0 ** np.arange(4)
    assert steps.values[:4] * 1e3 == pytest.approx(first_forces)  # N from kN
    label = drawn.force_ax.get_ylabel()
    assert label == "contact force (kN)"


def test_the_gap_is_drawn_as_an_exact_line(solved):
    """The gap is drawn in um over us; its last point is the gap at the end of the run."""
    solution = solved["impedances"]

    drawn = plot.contact(solution)

    times, gap = drawn.gaps[0].get_data()  # us, um
    end = solution.t_end
    last_gap = float(solution.contacts[0].gap(end))
    assert times[-1] * 1e-6 == pytest.approx(end)
    assert gap[-1] * 1e-6 == pytest.approx(last_gap)
    ax = drawn.gap_ax
    assert ax.get_ylabel() == "gap (µm)"
    assert ax.get_xlabel() == "time t (µs)"


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("unequal", "energy (mJ)"),
        ("drifting", "energy in a frame moving at 100 m/s (mJ)"),
    ],
)
def test_energy_bands_add_up_to_the_initial_energy(solved, name, label):
    """The bands of energy add up to the initial kinetic energy at all times, and the
    motion as a whole keeps 0.4 of it; there is no work, and the bands are named.
    """
    initial = 0.5 * STEEL.density * AREA * 0.4 * 1e3  # mJ

    drawn = plot.energy(solved[name], axes())

    motion, _, total = map(top_of, drawn.bands)  # {time: upper edge}
    totals = np.array(list(total.values()))
    expected = np.full(totals.shape, initial)
    assert totals == pytest.approx(expected)
    last_time = max(motion)
    fraction = motion[last_time] / initial
    assert fraction == pytest.approx(0.4, rel=1e-6)  # l1/l2
    assert drawn.work is None
    names = ["moving as a whole", "vibration, kinetic part", "strain energy"]
    assert texts_of(drawn.labels) == names
    assert drawn.ax.get_ylabel() == label


def test_gauge_record_is_in_microstrain_and_microseconds(solved):
    """The record of a gauge shows the incident pulse of v/(2 c) at its times, and its
    waves add up to the strain; the axes name the units.
    """
    record = solved["unequal"].gauge(1, 0.5)
    arrival = 0.5 / C * MICROSECONDS
    end = 1.3 / C * MICROSECONDS  # later by the round trip of the striker of 0.4 m
    strain = -0.5 / C * 1e6  # v/(2 c), in compression

    drawn = plot.gauge(record, axes())

    steps = drawn.strain.get_data()
    rightward = drawn.rightward.get_data().values
    leftward = drawn.leftward.get_data().values
    assert steps.values[:3] == pytest.approx([0, strain, 0])
    assert steps.edges[1:3] == pytest.approx([arrival, end])
    assert rightward + leftward == pytest.approx(steps.values)
    ax = drawn.ax
    assert ax.get_ylabel() == "strain (microstrain)"
    assert ax.get_xlabel() == "time t (µs)"


def test_restitution_notes_the_largest_residual_and_leaves_out_collisions_without_e():
    """Of four restitutions, one is nan: three points are drawn, beside the line e =
    l1/l2, and the note has the largest residual, 0.01, of three collisions.
    """
    ratios = [0.2, 0.4, 0.6, 0.8]
    restitutions = [0.2, 0.4, np.nan, 0.81]

    drawn = plot.restitution(ratios, restitutions, axes())

    note = drawn.residual.get_text()
    assert "1.0e-02\nin 3 collisions" in note  # 0.81 - 0.8
    law_x, law_y = drawn.law.get_data()
    assert law_x == pytest.approx(law_y)
    points = drawn.points.get_ydata()
    assert points == pytest.approx([0.2, 0.4, 0.81])


def test_restitution_refuses_numbers_that_do_not_match_or_are_missing():
    """`plot.restitution` refuses two ratios with one value, and a value that is NaN
    alone.
    """
    with pytest.raises(ValueError, match="shape"):
        plot.restitution([0.1, 0.2], [0.1], axes())
    with pytest.raises(ValueError, match="finite"):
        plot.restitution([0.1], [np.nan], axes())


def test_a_driven_end_is_marked_in_space_and_time():
    """A diagram of a rod pushed at its left end has one marker, ">"."""
    ends = (ri.Pushed(1e3), ri.Absorbing())
    solution = ri.solve(ri.System([rod()], ends=ends), until=5e-4)
    ax = axes()

    plot.spacetime(solution, ax)

    markers = [line.get_marker() for line in ax.get_lines()]
    assert markers == [">"]  # it is pushed to the right


def solved_at_once(body):
    """The collision of a body and a rod, which ends as it begins."""
    system = ri.System([body, rod()], ends=(ri.Free(), ri.Fixed()))
    return ri.solve(system, until=0.0)


@pytest.mark.exhaustive
def test_a_solution_without_duration_has_a_snapshot():
    picture = plot.snapshots(solved_at_once(rod(0.4, 1.0)))

    times = picture.times.tolist()
    assert times == [0.0]
    assert texts_of(picture.labels) == ["v", "0"]


def test_a_mass_without_duration_has_a_snapshot():
    mass = ri.RigidMass(0.3, velocity=1.0)

    picture = plot.snapshots(solved_at_once(mass))

    times = picture.times.tolist()
    assert times == [0.0]


@pytest.mark.parametrize("body", [rod(0.4, 1.0), ri.RigidMass(0.3, velocity=1.0)])
def test_a_solution_without_duration_has_no_history(body):
    """Four figures, and that of a gauge, of a solution that ends at 0 s raise
    ValueError.
    """
    solution = solved_at_once(body)

    for draw in (plot.contact, plot.energy, plot.overview, plot.spacetime):
        with pytest.raises(ValueError, match=r"until > 0|stop: must be later"):
            draw(solution)
    with pytest.raises(ValueError, match="until > 0"):
        plot.gauge(solution.gauge(1, 0.1))


# Page, files, manners


RENDERED = ["bonded", "bouncing", "single", "stepped", "at rest"]


def has_label(figure, *beginnings):
    """Whether an Axes has a label, or a title in its place, that begins like one of
    these.
    """
    for ax in figure.axes:
        for label in (ax.get_ylabel(), ax.get_title("left")):
            words = " ".join(label.split())  # a narrow figure wraps its labels
            if words.startswith(beginnings):
                return True
    return False


@pytest.mark.exhaustive
@pytest.mark.usefixtures("laid_out")
@pytest.mark.parametrize("name", RENDERED)
def test_overview_of_any_row_shows_velocity_stress_energy_and_force(solved, name):
    """A single rod has no contact force."""
    figure = plot.overview(solved[name])

    render(figure)
    assert has_label(figure, "velocity")
    assert has_label(figure, "stress")
    assert has_label(figure, "energy")
    has_force = has_label(figure, "contact force", "force at contact")
    assert has_force == (name != "single")


@pytest.mark.exhaustive
@pytest.mark.usefixtures("laid_out")
@pytest.mark.parametrize("name", few_of(RENDERED, ["bonded"]))
def test_snapshots_of_any_row_render(solved, name):
    render(plot.snapshots(solved[name]).ax.figure)


@pytest.mark.exhaustive
@pytest.mark.usefixtures("laid_out")
@pytest.mark.parametrize(
    "draw", few_of([plot.spacetime, plot.overview], [plot.spacetime])
)
def test_slivers_between_random_fronts_are_drawn_without_complaint(draw):
    """Fronts of a random row lie very near to each other; drawing raises nothing."""
    system = random_system(23)
    solution = ri.solve(system, until=horizon(system, 12.0))

    render(draw(solution))


def words_of_axis(axis):
    """Texts (artists) of an axis: its label, and the labels of its ticks within view."""
    low, high = axis.get_view_interval()
    words = [axis.label]
    for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
        if low <= tick.get_loc() <= high:
            words.append(tick.label1)
    return words


def boxes_of_words(figure):
    """Boxes, in pixels, around the title of a page and all texts of its axes."""
    words = [figure._suptitle]
    for ax in figure.axes:
        words += words_of_axis(ax.xaxis)
        words += words_of_axis(ax.yaxis)
    boxes = []
    for word in words:
        if word.get_visible() and word.get_text():
            box = word.get_window_extent()
            boxes.append(box)
    return boxes


@pytest.mark.exhaustive
@pytest.mark.usefixtures("laid_out")
@pytest.mark.parametrize("width", few_of([85, 120, 170, 300], {85}))
def test_words_of_a_page_of_any_width_stay_apart_and_inside(solved, width):
    """In an overview of a given width no two texts overlap and none leaves the page;
    axes are higher than half an inch, and all labels are there.
    """
    with plot.look(width=width):
        figure = plot.overview(solved["unequal"])
    FigureCanvasAgg(figure).draw()

    boxes = boxes_of_words(figure)
    assert len(boxes) > 30
    paper = figure.bbox.padded(2)  # pixels
    for i, box in enumerate(boxes):
        assert paper.x0 < box.x0 < box.x1 < paper.x1
        assert paper.y0 < box.y0 < box.y1 < paper.y1
        inner = box.shrunk(0.9, 0.9)
        for earlier in boxes[:i]:
            assert not inner.overlaps(earlier)
    heights = [ax.get_window_extent().height for ax in figure.axes]
    assert min(heights) > figure.dpi / 2
    for beginning in ("velocity", "stress", "energy", "contact force"):
        assert has_label(figure, beginning)


@pytest.mark.exhaustive
def test_overview_names_the_result(solved):
    """The title of the overview has bodies, closing speed, e, impulse and duration; a
    final run has no note.
    """
    figure = plot.overview(solved["unequal"])

    title = (
        "2 rods, closing speed 1 m/s, restitution e = 0.4, impulse 314 mN s, "
        "force duration 158 µs"
    )
    assert figure.get_suptitle() == title
    assert figure.get_supxlabel() == ""  # the note on a run that is not final


@pytest.mark.exhaustive
def test_overview_says_that_a_run_is_not_final(solved):
    solution = solved["bouncing"]

    note = plot.overview(solution).get_supxlabel()

    assert solution.status in note


@pytest.mark.exhaustive
def test_overview_says_that_it_shows_a_part(solved, monkeypatch):
    monkeypatch.setattr("rodimpact.plot.polygons.READABLE_REGIONS", 30)

    figure = plot.overview(solved["impedances"])

    assert "the first 396 µs" in figure.get_supxlabel()


def axes_titled(figure, title):
    """The Axes of a figure whose left title begins with `title`."""
    for ax in figure.axes:
        if ax.get_title(loc="left").startswith(title):
            return ax
    raise AssertionError(f"no Axes has the title {title}")


@pytest.mark.exhaustive
def test_overview_of_many_contacts_draws_each_on_a_line_of_its_own(solved):
    """In the overview of a cradle, each of four contacts has its own line with its
    name; its force begins and ends with its episode, at one scale.
    """
    solution = solved["cradle"]

    figure = plot.overview(solution)

    title = figure.get_suptitle()
    assert title.endswith("velocities after 0, 0, 0, 0, 1 m/s")
    ax = axes_titled(figure, "contact force, largest 1.98 kN")
    names = ["contact 1-2", "contact 2-3", "contact 3-4", "contact 4-5"]
    assert texts_of(ax.get_yticklabels()) == names
    contacts = solution.contacts
    assert len(ax.patches) == len(contacts)
    for i, steps in enumerate(ax.patches):
        (episode,) = contacts[i].episodes
        values, edges, baseline = steps.get_data()
        is_pressing = np.flatnonzero(values > i)
        start = edges[is_pressing[0]]  # ms
        end = edges[is_pressing[-1] + 1]  # of the last step that presses
        assert baseline == i
        assert values.max() == pytest.approx(i + 0.85)  # the largest force, to scale
        assert start == pytest.approx(1e3 * episode.start)
        assert end == pytest.approx(1e3 * episode.force_end)


def test_gauges_are_marked_at_their_places(solved):
    solution = solved["unequal"]
    gauges = {"struck": solution.gauge(0, 0.1), "far": solution.gauge(1, 0.25)}

    struck, far = plot.spacetime(solution, axes(), gauges=gauges).gauges

    assert struck.get_xdata() == pytest.approx(0.1, abs=5e-10)
    # The coordinate 0.25 m in the second rod, after the first one of 0.4 m
    assert far.get_xdata() == pytest.approx(0.65, abs=5e-10)


def test_gauges_move_in_snapshots(solved):
    """The line of a gauge goes from its first to its last position."""
    solution = solved["unequal"]
    end = solution.t_end
    gauges = {"struck": solution.gauge(0, 0.1), "far": solution.gauge(1, 0.25)}

    picture = plot.snapshots(
        solution, times=[0.0, end], magnification=1.0, gauges=gauges
    )

    ax = picture.ax
    names = texts_of(ax.texts)
    assert "struck" in names
    assert "far" in names
    (line,) = [line for line in ax.lines if line.get_label() == "far"]
    last_position = float(solution.position(1, 0.25, end))
    assert line.get_xdata() == pytest.approx([0.65, last_position])


@pytest.mark.exhaustive
@pytest.mark.usefixtures("laid_out")
def test_a_vector_file_has_paths_and_text_under_a_title(solved, tmp_path):
    """The SVG file of a diagram has one image, the colour bar, and otherwise paths and
    texts, a title and no date.
    """

    def draw():
        return plot.spacetime(solved["impedances"]).ax.figure

    file = vector_file(draw, tmp_path)

    assert file.count(b"<image") == 1  # the colour bar
    assert file.count(b"<path") > 40
    assert b"<dc:date>" not in file
    (title,) = re.findall("<title>(.*)</title>", file.decode())
    assert "time" in title
    assert "material coordinate" in title
    assert file.count(b"<text") >= 8


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("suffix", "magic"),
    [
        ("png", b"\x89PNG"),
        ("pdf", b"%PDF"),
        ("SVG", b"<?xml"),
    ],
)
def test_the_suffix_names_the_format_and_files_are_the_same_every_time(
    solved, tmp_path, suffix, magic
):
    """The same figure saved twice with a suffix: both files begin as this format does,
    and are equal byte for byte.
    """
    files = []
    for name in ("a", "b"):
        path = tmp_path / f"{name}.{suffix}"
        figure = plot.energy(solved["unequal"]).ax.figure
        plot.save(figure, path)
        files.append(path.read_bytes())

    first, second = files
    assert first.startswith(magic)
    assert first == second


@pytest.fixture(scope="module")
def small_figure():
    """A figure that takes little time to draw."""
    return plot.restitution([0.2, 0.4], [0.2, 0.4]).ax.figure


@pytest.mark.parametrize("name", ["a.gif", "a"])
def test_save_names_the_formats_of_a_figure(small_figure, tmp_path, name):
    """A wrong suffix or none is refused, with those that can be saved."""
    with pytest.raises(ValueError, match=r"\.png, \.svg, \.pdf"):
        plot.save(small_figure, tmp_path / name)


def test_save_replaces_a_file_only_by_force(small_figure, tmp_path):
    """Without force, `plot.save` leaves an existing file as it is and raises
    FileExistsError; with force, the file is a PNG afterwards.
    """
    path = tmp_path / "picture.png"
    path.write_text("mine")

    with pytest.raises(FileExistsError):
        plot.save(small_figure, path)
    assert path.read_text() == "mine"

    plot.save(small_figure, path, force=True)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_colours_grow_lighter_all_the_way():
    values = np.linspace(0, 1, 101)
    colours = RISING(values)[:, :3]  # red, green, blue; without opacity

    lightness = colours**2.2 @ [0.2126, 0.7152, 0.0722]

    assert np.all(np.diff(lightness) > 0)


def test_a_given_axes_is_used_and_settings_are_left_alone(solved):
    """`plot` draws into a given axes; a figure of its own has its own look in spite of
    the settings of the user, and these are unchanged afterwards.
    """
    before = settings()
    of_user = {"text.color": "red", "font.size": 30.0, "figure.facecolor": "black"}
    solution = solved["unequal"]
    family = ri.System([rod([[0.4], [0.5]], 1.0), rod([0.6, 0.7])])

    with mpl.rc_context(of_user):
        ax = axes()
        picture = plot.spacetime(solution, ax)
        own_figure = plot.spacetime(solution).ax.figure
        plot.sweep(ri.sweep(family))

    assert picture.ax is ax
    assert picture.regions.axes is ax
    paper = to_rgb(own_figure.get_facecolor())
    assert paper == (1.0, 1.0, 1.0)
    label = own_figure.axes[0].xaxis.label
    assert label.get_fontsize() < 12
    assert settings() == before


NO_AXES = {"look", "save", "show"}
# Several Axes, arranged on a figure of their own
OWN_FIGURE = {"overview", "animation"}
TWO_SUBJECTS = {"comparison", "restitution"}


@pytest.mark.parametrize("name", sorted(set(plot.__all__) - NO_AXES - OWN_FIGURE))
def test_axes_are_the_first_argument_of_a_figure_after_its_subject(name):
    """The signature of each function of `plot` names `ax` directly after the one or two
    things that it draws.
    """
    _, *arguments = signature(getattr(plot, name)).parameters
    if name in TWO_SUBJECTS:
        arguments.pop(0)

    assert arguments[0] == "ax"


DRAWINGS = [
    "ri.plot.contact(solution)",
    "ri.plot.sweep(ri.sweep(family))",
    "ri.plot.animation(solution, frames=2).frame(1)",
    "solution._repr_html_()",
]


@pytest.mark.exhaustive
@pytest.mark.parametrize("drawing", few_of(DRAWINGS, ["ri.plot.contact(solution)"]))
def test_drawing_needs_no_pyplot_and_the_package_no_matplotlib(drawing):
    """In a new process, solving does not import matplotlib, nor does drawing import
    pyplot.
    """
    code = f"""
import sys
import rodimpact as ri
rod = ri.Rod([0.4, 0.5], area=1e-4, material=ri.materials.steel, velocity=1.0)
other = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
family = ri.System([rod, other])
solution = ri.solve(family[0])
assert "matplotlib" not in sys.modules
{drawing}
assert "matplotlib.pyplot" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.fixture(scope="module")
def solved_masses():
    """The solution of two rigid masses that collide by a Hertzian contact."""
    masses = [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)]
    row = ri.System(masses, gaps=[1e-3], contacts=[ri.Hertz(1e8)])
    return ri.solve(row)


@pytest.mark.exhaustive
def test_rows_of_masses_have_contacts_and_energy_to_draw(solved_masses):
    """A collision of masses is drawn: the picture of contacts has one force and one
    gap, the total of energy is constant to 1e-6, and the overview has three axes.
    """
    contact = plot.contact(solved_masses)
    energy = plot.energy(solved_masses)
    overview = plot.overview(solved_masses)

    assert len(contact.forces) == len(contact.gaps) == 1
    total = energy.bands[-1]  # the highest band
    energies = np.array(list(top_of(total).values()))
    constant = np.full(energies.shape, energies.max())
    assert energies == pytest.approx(constant, rel=1e-6)
    assert len(overview.axes) == 3


def test_a_narrow_page_of_a_single_mass_shows_its_energy():
    """The overview of a mass that moves alone has one diagram on a narrow page, that of
    its energy.
    """
    solution = ri.solve(ri.System([ri.RigidMass(1.0, velocity=1.0)]), until=1e-3)
    with plot.look(width=85):
        figure = plot.overview(solution)

    (ax,) = figure.axes
    assert ax.get_ylabel() == "energy (mJ)"


@pytest.mark.parametrize("draw", [plot.spacetime, plot.snapshots, plot.animation])
def test_rows_of_masses_have_no_rods_to_draw(solved_masses, draw):
    with pytest.raises(ValueError, match=r"solution: has no rod.*plot\.overview"):
        draw(solved_masses)


@pytest.mark.exhaustive
def test_cells_that_average_a_short_blow_say_so():
    """The blow of 0.2 ms is weaker in cells of 1 ms each."""
    falling = ri.Rod(0.5, area=AREA, material=STEEL)
    row = ri.System([ri.Wall(), falling], gaps=[0.1], gravity=-9.81)
    solution = ri.solve(row, until=0.4)

    stress = plot.spacetime(solution, axes(), field="stress")
    displacement = plot.spacetime(solution, axes(), field="displacement")

    stress_label = stress.colour_bar.ax.get_ylabel()
    displacement_label = displacement.colour_bar.ax.get_ylabel()
    assert "mean over 1 ms" in stress_label
    assert "mean" not in displacement_label


def test_an_impact_is_a_mean_over_a_thousandth_of_the_run():
    """The label of the force of a run of 1 s says that it is a mean over 1 ms."""
    ball = ri.RigidMass(1.0, velocity=1.0)
    row = ri.System([ball, ri.RigidMass(2.0)], contacts=[ri.Rigid(restitution=0.5)])
    solution = ri.solve(row, until=1.0)

    picture = plot.contact(solution)

    label = " ".join(picture.force_ax.get_ylabel().split())
    assert "mean over 1 ms" in label
