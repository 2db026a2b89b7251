"""Figures: what is drawn is the solution, to scale, labelled, and written the same every time."""

import re
import subprocess
import sys
from inspect import signature

import matplotlib as mpl
import numpy as np
import pytest
from drawing import STEEL, C, axes, corners, render, rod, settings, top_of, vector_file
from exhaustive import few_of
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from systems import horizon, random_system

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.moments import moments, round_trips
from rodimpact.plot.style import RISING

MINUS = "\N{MINUS SIGN}"


ROWS = {
    "identical": (ri.System([rod(velocity=1.0), rod()]), None),
    "unequal": (ri.System([rod(0.4, 1.0), rod()]), None),
    "wall": (ri.System([rod(0.5, 1.0), ri.Wall()]), None),
    "impedances": (ri.System([rod(0.25, 1.0, area=3e-4), rod()]), None),
    "stepped": (
        ri.System(
            [
                rod(0.4, 2.0),
                ri.Rod(
                    segments=[
                        ri.Segment(0.3, 1e-4, STEEL),
                        ri.Segment(0.4, 3e-4, STEEL),
                    ]
                ),
            ]
        ),
        None,
    ),
    "cradle": (ri.System([rod(velocity=1.0), *[rod()] * 4]), None),
    "bouncing": (
        ri.System([ri.Wall(), rod(0.3, 10.0), ri.Wall()], gaps=[1e-3, 2e-3]),
        8e-4,
    ),
    "released": (ri.System([rod(0.5, strain=-1e-4), rod()], gaps=[1e-6]), 1e-3),
    "receding": (ri.System([rod(0.5, -1.0), rod(1.0, 0.5)]), None),
    "single": (ri.System([rod(0.5, 1.0)]), 4e-4),
    "tiny": (ri.System([rod(0.4, 1e-9), rod()]), None),
    "drifting": (ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]), None),
    "closing gap": (ri.System([rod(0.4, 1.0), rod(0.6)], gaps=[5e-5]), None),
    "moving wall": (
        ri.System([ri.Wall(2.0), rod(0.4), rod(0.6, -1.0)], gaps=[5e-5, 2e-5]),
        1e-3,
    ),
    "bonded": (
        ri.System(
            [rod(0.4, 1.0), rod(0.3, area=2e-4), rod(0.6)],
            contacts=[ri.Rigid(), ri.Bonded()],
        ),
        None,
    ),
    "at rest": (ri.System([rod(), rod()]), 1e-3),
}
every_row = pytest.mark.parametrize("name", ROWS)
some_rows = pytest.mark.parametrize(
    "name",
    few_of(
        ROWS, {"unequal", "impedances", "bonded", "drifting", "moving wall", "bouncing"}
    ),
)


@pytest.fixture(scope="module")
def solved():
    return {name: ri.solve(system, until) for name, (system, until) in ROWS.items()}


def fronts(picture):
    (lines,) = (each for each in picture.ax.collections if each.get_label() == "fronts")
    return lines


def area(points):
    x, y = points.T
    return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


# Space-time diagram -----------------------------------------------------------------------------


@some_rows
def test_regions_tile_each_rod_between_its_ends(solved, name):
    picture = plot.spacetime(solved[name], axes())
    paths = picture.ends.get_segments()
    strips = [
        np.concatenate((left, right[::-1]))
        for left, right in zip(paths[::2], paths[1::2], strict=True)
    ]
    assert sum(map(area, corners(picture))) == pytest.approx(
        sum(map(area, strips)), rel=1e-9
    )


@some_rows
def test_rods_never_overlap_and_gaps_are_drawn_to_the_same_scale(solved, name):
    solution = solved[name]
    picture = plot.spacetime(solution, axes(), coordinates="lab", magnification=50.0)
    scale = {"µs": 1e6, "ms": 1e3}[picture.ax.get_ylabel()[-3:-1]]
    paths = picture.ends.get_segments()
    rods = [
        i for i, body in enumerate(solution.system.bodies) if isinstance(body, ri.Rod)
    ]
    times = np.linspace(0, solution.t_end, 50)
    for right, left, k in zip(paths[1:-1:2], paths[2::2], rods, strict=False):
        drawn = np.interp(times, left[:, 1] / scale, left[:, 0]) - np.interp(
            times, right[:, 1] / scale, right[:, 0]
        )
        assert drawn == pytest.approx(50.0 * solution.contacts[k].gap(times), abs=1e-9)


@pytest.mark.parametrize("name", few_of(ROWS, {"unequal", "drifting", "moving wall"}))
@pytest.mark.parametrize("field", ["velocity", "stress", "strain"])
def test_colour_limits_are_symmetric_about_rest_and_hold_all_values(
    solved, name, field
):
    picture = plot.spacetime(solved[name], axes(), field)
    rest = 100.0 if name == "drifting" and field == "velocity" else 0.0
    norm, values = picture.regions.norm, picture.regions.get_array()
    assert (norm.vmin + norm.vmax) / 2 == pytest.approx(rest, abs=1e-9)
    assert norm.vmin <= values.min() <= values.max() <= norm.vmax
    assert norm.vmax > norm.vmin


def test_colour_of_each_region_is_the_field_in_its_middle(solved):
    solution = solved["impedances"]
    regions = ri.regions_of(solution)
    for field, scale in (("velocity", 1.0), ("stress", 1e-6), ("strain", 1e6)):
        values = plot.spacetime(solution, axes(), field).regions.get_array()
        for i, (begin, end) in enumerate(
            zip(regions.start, regions.start[1:], strict=False)
        ):
            x, t = regions.x[begin:end].mean(), regions.t[begin:end].mean()
            expected = getattr(solution, field)(int(regions.body[i]), x, t) * scale
            assert values[i] == pytest.approx(float(expected), abs=1e-9)


def test_a_crowd_has_lines_at_its_strongest_fronts_alone():
    head = ri.Rod(
        segments=[
            ri.Segment(0.1 + 0.03 * (7 * i % 5), 1e-4 * (1 + 3 * i % 4), STEEL)
            for i in range(5)
        ]
    )
    solution = ri.solve(ri.System([rod(0.4, 1.0), head]))
    picture = plot.spacetime(solution, axes())
    lines = fronts(picture)
    drawn = lines.get_segments()
    assert 10 < len(drawn) < picture.regions.get_array().size / 3
    ends = picture.ax.transData.transform(np.concatenate(drawn)).reshape(-1, 2, 2)
    length = np.hypot(*np.diff(ends, axis=1)[:, 0].T).sum() * 72 / picture.ax.figure.dpi
    area = (
        np.prod(picture.ax.get_window_extent().size) * (72 / picture.ax.figure.dpi) ** 2
    )
    assert length <= area / 12  # no nearer than 12 points, in the mean
    # the first front into the struck rod is 0.5 m/s strong, most others are faint
    first = min(drawn, key=lambda line: np.hypot(*(line.mean(axis=0) - [0.4, 0.0])))
    assert {tuple(first[0].round(9)), tuple(first[1].round(9))} >= {(0.4, 0.0)}
    stages = plot.snapshots(solution, axes(), [solution.t_end], magnification=1.0)
    boxes = [path.get_extents() for path in stages.bars.get_paths()]
    profiles = [solution.fields.profile(i, solution.fields.end) for i in (0, 1)]
    assert len(boxes) < sum(p.velocity.size for p in profiles) / 2
    assert sum(box.width for box in boxes) == pytest.approx(1.2, abs=1e-3)
    speeds = stages.bars.get_array()
    momentum = sum(v * box.width for v, box in zip(speeds, boxes, strict=True))
    assert momentum == pytest.approx(
        sum(float(p.velocity @ np.diff(p.edges)) for p in profiles), rel=1e-3
    )


def test_contact_presses_then_touches_then_opens(solved):
    picture = plot.spacetime(solved["unequal"], axes())
    (pressing,), (touching,) = (
        picture.pressing.get_segments(),
        picture.touching.get_segments(),
    )
    transit = 0.4 / C * 1e6
    assert pressing[[0, -1], 1] == pytest.approx([0, 2 * transit])
    assert touching[[0, -1], 1] == pytest.approx([2 * transit, 5 * transit])
    assert picture.pressing.get_linewidth()[0] > picture.touching.get_linewidth()[0]
    assert [text.get_text() for text in picture.ax.get_legend().get_texts()] == [
        "pressing",
        "touching",
        "apart",
    ]
    (apart,) = picture.apart.get_segments()
    assert apart[:, 0] == pytest.approx([0.4, 0.4])
    assert apart[[0, -1], 1] == pytest.approx([5 * transit, 7 * transit])


def test_axes_carry_units_and_the_magnification(solved):
    picture = plot.spacetime(solved["unequal"], axes(), "stress", coordinates="lab")
    assert picture.ax.get_ylabel() == "time t (µs)"
    label = picture.ax.get_xlabel()
    assert "(m)" in label
    assert label.endswith("displacements \N{MULTIPLICATION SIGN} 2000")
    assert picture.colour_bar.ax.get_ylabel() == "stress, tension positive (MPa)"
    assert plot.spacetime(solved["cradle"], axes()).ax.get_ylabel() == "time t (ms)"
    assert plot.spacetime(
        solved["unequal"], axes(), "strain"
    ).colour_bar.ax.get_ylabel() == ("strain (10⁻⁶)")
    assert (
        plot.spacetime(solved["tiny"], axes()).colour_bar.ax.get_ylabel()
        == "velocity (nm/s)"
    )


def test_a_drifting_row_is_drawn_in_a_moving_frame(solved):
    still, drifting = (
        plot.spacetime(solved[n], axes(), coordinates="lab")
        for n in ("unequal", "drifting")
    )
    assert "frame moving at 100 m/s" in drifting.ax.get_xlabel()
    assert "frame" not in still.ax.get_xlabel()
    for a, b in zip(corners(still), corners(drifting), strict=True):
        assert a == pytest.approx(b, abs=1e-6)


def test_walls_are_hatched_and_move_as_they_do(solved):
    (wall,) = plot.spacetime(solved["wall"], axes()).walls
    assert wall.get_hatch()
    assert wall.get_xy()[:2, 0] == pytest.approx([0.5, 0.5])
    (wall,) = plot.spacetime(
        solved["moving wall"], axes(), coordinates="lab", magnification=1.0
    ).walls
    assert wall.get_xy()[:2, 0] == pytest.approx([0.0, 2.0 * 1e-3])


def test_dimensionless_diagram_has_the_textbook_numbers(solved):
    picture = plot.spacetime(solved["unequal"], axes(), "stress", dimensionless=True)
    values = picture.regions.get_array()
    assert values.min() == pytest.approx(-0.5, abs=1e-12)
    assert values.max() == pytest.approx(0.5, abs=1e-12)
    assert sorted(
        {round(y, 9) for path in corners(picture) for _, y in path}
    ) == pytest.approx([0, 1, 2, 2.5, 3.5, 4.5, 5, 6, 7])
    assert picture.pressing.get_segments()[0][0] == pytest.approx([1, 0])
    assert "c/ℓ₁" in picture.ax.get_ylabel()
    assert "x/ℓ₁" in picture.ax.get_xlabel()
    for field in ("velocity", "strain"):
        values = plot.spacetime(
            solved["unequal"], axes(), field, True
        ).regions.get_array()
        assert values.max() == pytest.approx({"velocity": 1.0, "strain": 0.5}[field])


@pytest.mark.parametrize(
    ("name", "limits", "values"),
    [
        ("unequal", (0.0, 1.0), {"0", "0.5", "1"}),
        ("wall", (-1.0, 1.0), {"1", "0", MINUS + "1"}),
        ("drifting", (100, 101), {"101", "100.5", "100"}),
    ],
)
def test_the_colour_bar_shows_the_colours_in_use_and_labels_are_its_values(
    solved, name, limits, values
):
    picture = plot.spacetime(solved[name])
    assert picture.colour_bar.ax.get_ylim() == pytest.approx(limits)
    assert {text.get_text() for text in picture.labels} == values


REFUSED = [
    (plot.spacetime, {"field": "heat"}, "'velocity', 'stress', 'strain'"),
    (plot.spacetime, {"magnification": 0.0}, "magnification"),
    (plot.spacetime, {"magnification": float("nan")}, "magnification"),
    (plot.spacetime, {"start": 2e-4, "stop": 1e-4}, "stop: must be later"),
    (plot.spacetime, {"stop": 1.0}, "t: must lie in the solution"),
    (plot.spacetime, {"coordinates": "rod"}, "'lab', 'body'"),
    (
        plot.spacetime,
        {"coordinates": "body", "magnification": 2.0},
        "magnification: nothing moves",
    ),
    (plot.snapshots, {"times": []}, "at least one time"),
    (plot.snapshots, {"times": [1.0]}, "must lie in the solution"),
    (plot.snapshots, {"gauges": [(1, 0.0)]}, "must be records by name"),
    (plot.contact, {"contact": 1}, "from 0 to 0, got 1"),
    (plot.contact, {"ax": axes()}, "ax: needs a pair of Axes"),
    (plot.contact, {"ax": [axes()]}, "ax: needs a pair of Axes"),
    (
        plot.animation,
        {"field": "energy"},
        "field: must be one of 'velocity', 'stress', 'strain'",
    ),
    (plot.animation, {"frames": 1}, "frames: must be a whole number from 2 to 10000"),
    (plot.animation, {"frames": 2.5}, "frames"),
    (plot.animation, {"fps": 51}, "fps: must be 1 to 50"),
    (plot.animation, {"fps": float("nan")}, "fps"),
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


def ticks(axis, minor=False):
    places = axis.get_minorticklocs() if minor else axis.get_majorticklocs()
    texts = axis.get_ticklabels(minor=minor)
    return {text.get_text(): x for text, x in zip(texts, places, strict=True)}


def test_the_axes_show_lengths_names_and_round_trips(solved):
    ax = plot.spacetime(solved["unequal"]).ax
    assert ticks(ax.xaxis) == pytest.approx({"0": 0.0, "0.4": 0.4, "1.4": 1.4})
    assert ticks(ax.xaxis, True) == pytest.approx({"ℓ₁\nrod 1": 0.2, "ℓ₂\nrod 2": 0.9})
    times = ticks(ax.yaxis)
    assert times["2 ℓ₁/c"] == pytest.approx(0.8e6 / C)
    assert times["2 ℓ₂/c"] == pytest.approx(2e6 / C)
    assert (
        min(np.diff(sorted(times.values()))) > 20
    )  # numbers that would touch a name are left out
    assert "100" in times
    assert "2 ℓ₁/c" in ticks(plot.spacetime(solved["unequal"], across=True).ax.xaxis)
    assert not any(
        "c" in name for name in ticks(plot.spacetime(solved["closing gap"]).ax.yaxis)
    )


def test_round_trips_of_two_materials_have_two_speeds():
    pair = ri.System([rod(0.4, 1.0), rod(material=ri.materials.aluminium)])
    names = round_trips(ri.solve(pair)).values()
    assert names
    assert all(re.fullmatch("[0-9]+ .([₁₂])/c\\1", name) for name in names)


def test_fronts_are_named_by_what_they_add_to_the_stress(solved):
    picture = plot.spacetime(solved["wall"], field="stress")
    words = {
        t.get_text(): t.get_position()
        for t in picture.ax.texts
        if t.get_text().isalpha()
    }
    transit = 0.5 / C * 1e6
    assert set(words) == {
        "compression",
        "tension",
    }  # the first front, and its reflection
    assert words["compression"] == pytest.approx((0.25, 0.5 * transit))
    assert words["tension"] == pytest.approx((0.25, 1.5 * transit))


def test_centres_of_mass_are_dashed_and_move_as_they_do(solved):
    solution = solved["stepped"]
    assert plot.spacetime(solution).centres == []
    picture = plot.spacetime(solution, coordinates="lab", magnification=100.0)
    assert "centre of mass" in [
        t.get_text() for t in picture.ax.get_legend().get_texts()
    ]
    for body, line in enumerate(picture.centres):
        place, time = line.get_data()
        speed = np.diff(place) / np.diff(time * 1e-6)
        middle = (time[1:] + time[:-1]) / 2e6
        assert speed == pytest.approx(
            100 * solution.mean_velocity(body, middle), abs=1.0
        )
    assert picture.centres[0].get_xdata()[0] == pytest.approx(0.2)
    assert picture.centres[1].get_xdata()[0] == pytest.approx(
        0.4 + (0.3 * 0.15 + 1.2 * 0.5) / 1.5
    )


# Snapshots --------------------------------------------------------------------------------------


def test_instructive_moments(solved):
    assert moments(solved["identical"]) * C == pytest.approx([0, 0.5, 1, 1.5, 2, 4])
    assert moments(solved["unequal"]) * C / 0.4 == pytest.approx(
        [0, 0.5, 1, 2, 2.5, 4.5, 5, 7]
    )


@every_row
def test_moments_are_few_and_inside_the_solution(solved, name):
    times = moments(solved[name])
    assert 3 <= times.size <= 8
    assert times[0] == 0
    assert times[-1] == pytest.approx(solved[name].t_end)
    assert np.all(np.diff(times) > 0)


def test_pieces_bear_their_velocity_in_parts_of_the_closing_speed(solved):
    picture = plot.snapshots(solved["identical"], times=[0.0, 0.5 / C, 3 / C])
    assert [t.get_text() for t in picture.labels] == [
        "v",
        "0",
        "v",
        "v/2",
        "v/2",
        "0",
        "0",
        "v",
    ]
    assert "v = 1 m/s" in picture.ax.get_xlabel()
    assert [t.get_text() for t in picture.ax.get_yticklabels()] == [
        "0 µs\n0 ℓ₁/c",
        "99.06 µs\n0.5 ℓ₁/c",
        "594.3 µs\n3 ℓ₁/c",
    ]
    boxes = [path.get_extents() for path in picture.bars.get_paths()]
    free, pressed = boxes[2], boxes[3]  # compressed pieces are shorter and thicker
    assert pressed.width < free.width
    assert pressed.height > free.height
    assert boxes[0].width == pytest.approx(1.0)
    assert [line.get_marker() for line in picture.fronts] == [
        "<",
        ">",
    ]  # the way they run
    picture = plot.snapshots(solved["receding"], times=[0.0])
    assert [t.get_text() for t in picture.labels] == [MINUS + "1", "0.5"]
    assert "\nvelocities (m/s)\n" in picture.ax.get_xlabel()


# Histories --------------------------------------------------------------------------------------


def test_force_and_gap_are_exact_steps_and_lines(solved):
    solution = solved["impedances"]
    drawn = plot.contact(solution)
    data = drawn.forces[0].get_data()
    transit = 0.25 / C * 1e6
    first = STEEL.density * C * 1e-4 * 0.75
    assert data.edges[:5] == pytest.approx(
        [0, 2 * transit, 4 * transit, 6 * transit, 8 * transit]
    )
    assert data.values[:4] * 1e3 == pytest.approx(first / 2.0 ** np.arange(4))
    assert data.edges[-1] == pytest.approx(solution.t_end * 1e6)
    times, gap = drawn.gaps[0].get_data()
    assert gap[-1] * 1e-6 == pytest.approx(
        float(solution.contacts[0].gap(solution.t_end))
    )
    assert times[-1] * 1e-6 == pytest.approx(solution.t_end)
    assert drawn.force_ax.get_ylabel() == "contact force (kN)"
    assert drawn.gap_ax.get_ylabel() == "gap (µm)"
    assert drawn.gap_ax.get_xlabel() == "time t (µs)"


@pytest.mark.parametrize("name", ["unequal", "drifting"])
def test_energy_bands_add_up_to_what_there_was(solved, name):
    drawn = plot.energy(solved[name], axes())
    motion, _, total = map(top_of, drawn.bands)
    initial = 0.5 * STEEL.density * 1e-4 * 0.4 * 1e3
    assert list(total.values()) == pytest.approx([initial] * len(total))
    end = max(motion)
    assert motion[end] / initial == pytest.approx(0.4, rel=1e-6)
    assert drawn.work is None
    assert [t.get_text() for t in drawn.labels] == [
        "moving as a whole",
        "vibration",
        "strain",
    ]
    assert drawn.ax.get_ylabel() == (
        "energy (mJ)"
        if name == "unequal"
        else "energy in a frame moving at 100 m/s (mJ)"
    )


def test_gauge_record_is_in_microstrain_and_microseconds(solved):
    record = solved["unequal"].gauge(1, 0.5)
    drawn = plot.gauge(record, axes())
    data = drawn.strain.get_data()
    assert data.values[:3] == pytest.approx([0, -0.5 / C * 1e6, 0])
    assert data.edges[1:3] == pytest.approx([0.5 / C * 1e6, 1.3 / C * 1e6])
    total = drawn.rightward.get_data().values + drawn.leftward.get_data().values
    assert total == pytest.approx(data.values)
    assert drawn.ax.get_ylabel() == "strain (microstrain)"
    assert drawn.ax.get_xlabel() == "time t (µs)"


def test_restitution_notes_the_residual():
    drawn = plot.restitution([0.2, 0.4, 0.6, 0.8], [0.2, 0.4, np.nan, 0.81], axes())
    assert "1.0e-02\nin 3 collisions" in drawn.residual.get_text()
    assert drawn.law.get_xdata() == pytest.approx(drawn.law.get_ydata())
    assert drawn.points.get_ydata() == pytest.approx([0.2, 0.4, 0.81])
    with pytest.raises(ValueError, match="shape"):
        plot.restitution([0.1, 0.2], [0.1], axes())
    with pytest.raises(ValueError, match="finite"):
        plot.restitution([0.1], [np.nan], axes())


def test_a_driven_end_is_marked_in_space_and_time():
    solution = ri.solve(
        ri.System([rod()], ends=(ri.Pushed(1e3), ri.Absorbing())), until=5e-4
    )
    ax = axes()
    plot.spacetime(solution, ax)
    assert [line.get_marker() for line in ax.get_lines()] == [
        ">"
    ]  # it is pushed to the right


@pytest.mark.parametrize("body", [rod(0.4, 1.0), ri.RigidMass(0.3, velocity=1.0)])
def test_a_solution_without_duration_has_a_snapshot_but_no_history(body):
    solution = ri.solve(
        ri.System([body, rod()], ends=(ri.Free(), ri.Fixed())), until=0.0
    )
    picture = plot.snapshots(solution)
    assert picture.times.tolist() == [0.0]
    if isinstance(body, ri.Rod):
        assert [t.get_text() for t in picture.labels] == ["v", "0"]
    for draw in (plot.contact, plot.energy, plot.overview, plot.spacetime):
        with pytest.raises(ValueError, match=r"until > 0|stop: must be later"):
            draw(solution)
    with pytest.raises(ValueError, match="until > 0"):
        plot.gauge(solution.gauge(1, 0.1))


# Page, files, manners ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", few_of(ROWS, {"bonded", "single"}))
def test_overview_of_any_row_renders(solved, name):
    figure = plot.overview(solved[name])
    render(figure)
    labels = {ax.get_ylabel() for ax in figure.axes}
    assert any(label.startswith("velocity") for label in labels)
    assert any(label.startswith("stress") for label in labels)
    assert any(label.startswith("energy") for label in labels)
    labels |= {ax.get_title("left") for ax in figure.axes}  # of many contacts
    assert any(label.startswith("contact force") for label in labels) == (
        name != "single"
    )
    render(plot.snapshots(solved[name]).ax.figure)


def test_slivers_between_random_fronts_are_drawn_without_complaint():
    system = random_system(23)
    render(plot.overview(ri.solve(system, until=horizon(system, 12.0))))


@pytest.mark.parametrize("width", few_of([85, 120, 170, 300], {85, 300}))
def test_words_of_a_page_of_any_width_stay_apart_and_inside(solved, width):
    with plot.look(width=width):
        figure = plot.overview(solved["unequal"])
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    words = [figure._suptitle]
    for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)):
        low, high = axis.get_view_interval()
        words += [
            axis.label,
            *(
                tick.label1
                for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
                if low <= tick.get_loc() <= high
            ),
        ]
    boxes = [
        text.get_window_extent()
        for text in words
        if text.get_visible() and text.get_text()
    ]
    assert len(boxes) > 30
    for i, box in enumerate(boxes):
        assert -2 < box.x0 < box.x1 < figure.bbox.width + 2
        assert -2 < box.y0 < box.y1 < figure.bbox.height + 2
        assert not any(box.shrunk(0.9, 0.9).overlaps(other) for other in boxes[:i])
    assert min(ax.get_window_extent().height for ax in figure.axes) > figure.dpi / 2


def test_overview_names_the_result_and_what_is_missing(solved, monkeypatch):
    figure = plot.overview(solved["unequal"])
    assert figure.get_supxlabel() == ""
    assert figure.get_suptitle() == (
        "2 rods, closing speed 1 m/s, restitution e = 0.4, impulse 314 mN s, "
        "force duration 158 µs"
    )
    assert (
        solved["bouncing"].status in plot.overview(solved["bouncing"]).get_supxlabel()
    )
    monkeypatch.setattr("rodimpact.plot.polygons.READABLE_REGIONS", 30)
    assert "the first 396 µs" in plot.overview(solved["impedances"]).get_supxlabel()


def test_overview_of_many_contacts_draws_each_on_a_line_of_its_own(solved):
    figure = plot.overview(solved["cradle"])
    assert figure.get_suptitle().endswith("velocities after 0, 0, 0, 0, 1 m/s")
    ax = next(
        ax
        for ax in figure.axes
        if ax.get_title(loc="left").startswith("contact force, largest 1.98 kN")
    )
    assert [t.get_text() for t in ax.get_yticklabels()] == [
        f"contact {i}-{i + 1}" for i in range(1, 5)
    ]
    for i, (steps, contact) in enumerate(
        zip(ax.patches, solved["cradle"].contacts, strict=True)
    ):
        values, edges, baseline = steps.get_data()
        assert baseline == i
        pressing = np.flatnonzero(values > i)
        assert values.max() == pytest.approx(i + 0.85)
        (episode,) = contact.episodes
        assert edges[[pressing[0], pressing[-1] + 1]] == pytest.approx(
            [1e3 * episode.start, 1e3 * episode.force_end]
        )


def test_gauges_are_marked_where_they_are(solved):
    solution = solved["unequal"]
    gauges = {"struck": solution.gauge(0, 0.1), "far": solution.gauge(1, 0.25)}
    lines = plot.spacetime(solution, gauges=gauges).gauges
    assert [set(line.get_xdata().round(9)) for line in lines] == [{0.1}, {0.65}]
    picture = plot.snapshots(
        solution, times=[0.0, solution.t_end], magnification=1.0, gauges=gauges
    )
    assert {"struck", "far"} <= {text.get_text() for text in picture.ax.texts}
    (line,) = (line for line in picture.ax.lines if line.get_label() == "far")
    assert line.get_xdata() == pytest.approx(
        [0.65, float(solution.position(1, 0.25, solution.t_end))]
    )


def test_a_vector_file_has_paths_and_text_under_a_title(solved, tmp_path):
    file = vector_file(lambda: plot.spacetime(solved["impedances"]).ax.figure, tmp_path)
    assert file.count(b"<image") == 1  # the colour bar
    assert file.count(b"<path") > 40
    assert b"<dc:date>" not in file
    (title,) = re.findall("<title>(.*)</title>", file.decode())
    assert "time" in title
    assert "material coordinate" in title
    assert file.count(b"<text") >= 8


@pytest.mark.parametrize(
    ("suffix", "magic"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("SVG", b"<?xml")]
)
def test_suffix_names_the_format(solved, tmp_path, suffix, magic):
    files = []
    for name in ("a", "b"):
        target = tmp_path / f"{name}.{suffix}"
        plot.save(plot.energy(solved["unequal"]).ax.figure, target)
        files.append(target.read_bytes())
    assert files[0].startswith(magic)
    assert files[0] == files[1]


def test_save_refuses_unknown_suffixes_and_existing_files(solved, tmp_path):
    figure = plot.energy(solved["unequal"]).ax.figure
    film = plot.animation(solved["unequal"], frames=2)
    for drawn, name, suffixes in (
        (figure, "a.gif", ".png, .svg, .pdf"),
        (figure, "a", ".png, .svg, .pdf"),
        (film, "a.png", ".gif, .mp4"),
        (film, "a", ".gif, .mp4"),
    ):
        with pytest.raises(ValueError, match=suffixes):
            plot.save(drawn, tmp_path / name)
    target = tmp_path / "picture.png"
    target.write_text("mine")
    with pytest.raises(FileExistsError):
        plot.save(figure, target)
    assert target.read_text() == "mine"
    plot.save(figure, target, force=True)
    assert target.read_bytes().startswith(b"\x89PNG")


def test_colours_grow_lighter_all_the_way():
    lightness = RISING(np.linspace(0, 1, 101))[:, :3] ** 2.2 @ [0.2126, 0.7152, 0.0722]
    assert np.all(np.diff(lightness) > 0)


def test_a_given_axes_is_used_and_settings_are_left_alone(solved):
    before = settings()
    with mpl.rc_context(
        {"text.color": "red", "font.size": 30.0, "figure.facecolor": "black"}
    ):
        ax = axes()
        picture = plot.spacetime(solved["unequal"], ax)
        fresh = plot.spacetime(solved["unequal"]).ax.figure
        plot.sweep(ri.sweep(ri.System([rod([[0.4], [0.5]], 1.0), rod([0.6, 0.7])])))
    assert picture.ax is ax is picture.regions.axes
    assert to_rgb(fresh.get_facecolor()) == (1.0, 1.0, 1.0)
    assert fresh.axes[0].xaxis.label.get_fontsize() < 12
    assert settings() == before


def test_axes_are_the_first_that_any_figure_takes_after_its_subject():
    whole = {"overview", "animation"}  # several Axes, arranged on a figure of their own
    for name in set(plot.__all__) - {"look", "save", "show"} - whole:
        _, *names = signature(getattr(plot, name)).parameters
        assert names[name in ("comparison", "restitution")] == "ax", name


def test_drawing_needs_no_pyplot_and_the_package_no_matplotlib():
    code = """
import sys
import rodimpact as ri
rod = ri.Rod([0.4, 0.5], area=1e-4, material=ri.materials.steel, velocity=1.0)
family = ri.System([rod, ri.Rod([[0.5], [1.0]], area=1e-4, material=ri.materials.steel)])
solution, result = ri.solve(family[0, 0]), ri.sweep(family)
assert "matplotlib" not in sys.modules
ri.plot.animation(solution, frames=2).frame(1), solution._repr_html_(), ri.plot.sweep(result)
assert "matplotlib.pyplot" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_rows_of_masses_have_contacts_and_energy_to_draw():
    row = ri.System(
        [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)],
        gaps=[1e-3],
        contacts=[ri.Hertz(1e8)],
    )
    solution = ri.solve(row)
    plot.contact(solution)
    assert plot.energy(solution)
    assert len(plot.overview(solution).axes) == 3
    for draw in (plot.spacetime, plot.snapshots, plot.animation):
        with pytest.raises(ValueError, match="solution: has no rod"):
            draw(solution)
