"""Figures of families: curves and maps show the result, its axes in words and units, and theory."""

import numpy as np
import pytest
from drawing import C, axes, legend, render, rod, vector_file
from exhaustive import few_of

import rodimpact as ri
from rodimpact import plot
from rodimpact.methods.registry import Options
from rodimpact.plot.scales import scale_of
from rodimpact.results import labels
from rodimpact.running.sweep_result import SweepResult

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def column(values):
    return np.asarray(values)[:, None]


LENGTHS, AREAS = np.geomspace(0.25, 4, 17), np.geomspace(2e-5, 5e-4, 21)
SYSTEMS = {
    "lengths": ri.System([rod(np.linspace(0.1, 3, 60), 1.0), rod()]),
    "few": ri.System([rod(np.linspace(0.25, 2.5, 10), 1.0, area=3e-4), rod()]),
    "areas": ri.System([rod(0.5, 1.0, area=np.linspace(2e-5, 3e-4, 57)), rod()]),
    "map": ri.System([rod(column(LENGTHS), 1.0), rod(area=AREAS)]),
    "speeds": ri.System(
        [rod(column(np.linspace(0.5, 1.5, 9)), np.linspace(-1, 2, 7)), rod()]
    ),
    "wall": ri.System([rod(np.linspace(0.1, 1, 10), 1.0), ri.Wall()]),
    "left wall": ri.System(
        [ri.Wall(0.5), rod(column(np.linspace(0.1, 1, 4)), np.linspace(-2, 1, 9))]
    ),
    "gaps": ri.System(
        [rod(0.2, 1.0), rod(0.3), rod(0.2)], gaps=[np.linspace(0, 2e-4, 9), 1e-5]
    ),
    "heads": ri.System(
        [
            rod(1.0, 1.0, area=1.0, material=UNIT),
            ri.Rod(
                segments=[
                    ri.Segment(
                        column(np.linspace(1.1, 2.9, 7)), np.linspace(1.1, 2.6, 6), UNIT
                    ),
                    ri.Segment(20.0, 10.0, UNIT),
                ]
            ),
        ]
    ),
    "strains": ri.System([rod(0.5, 1.0), rod(strain=np.linspace(-1e-4, 1e-4, 5))]),
    "receding": ri.System([rod(np.linspace(0.5, 1, 4), -1.0), rod()]),
}


@pytest.fixture(scope="module")
def swept():
    with np.errstate(all="raise", under="ignore"):
        return {name: ri.sweep(system) for name, system in SYSTEMS.items()}


def showing(values):
    """A family of lengths, or of lengths and areas, with these results, whatever the physics."""
    lengths, areas = np.linspace(1, 2, values.shape[0]), 1e-4
    if values.ndim == 2:
        lengths, areas = column(lengths), np.linspace(1e-4, 2e-4, values.shape[1])
    system = ri.System([rod(lengths, 1.0, strain=1e-6), rod(area=areas)])
    columns = {"restitution": values, "episodes.0": values}
    return SweepResult(system, Options(method="fronts"), columns)


def limits(picture):
    return (*picture.ax.get_xlim(), *picture.ax.get_ylim())


def levels_of(picture):
    return [] if picture.contours is None else list(picture.contours.levels)


def finite(x, y):
    known = np.isfinite(y)
    return x[known], y[known]


# Curves -----------------------------------------------------------------------------------------


def test_a_curve_goes_through_the_results(swept):
    picture = plot.sweep(swept["lengths"], axes())
    lengths = np.linspace(0.1, 3, 60)
    assert picture.values.get_xdata() == pytest.approx(lengths)
    assert picture.values.get_ydata() == pytest.approx(np.minimum(lengths, 1 / lengths))
    assert picture.values.get_linestyle() == "-"
    assert picture.ax.get_xlabel() == "length of rod 1 (m)"
    assert picture.ax.get_ylabel() == "coefficient of restitution e"
    assert picture.ax.get_xscale() == "linear"


def test_the_closed_form_lies_under_it_and_is_smooth_between_few_points(swept):
    picture = plot.sweep(swept["few"], axes())
    assert picture.values.get_marker() == "o"
    assert picture.values.get_linestyle() == "None"
    x, y = picture.theory.get_data()
    assert x.size >= 400
    exact = ri.theory.saint_venant(3.0, x, 1.0, 1.0).restitution
    assert y == pytest.approx(exact, abs=1e-12)
    assert picture.theory.get_zorder() <= picture.values.get_zorder()
    assert legend(picture) == ["closed form", "computed"]


@pytest.mark.parametrize("name", ["lengths", "areas", "few", "wall"])
def test_theory_and_results_agree(swept, name):
    for quantity in (
        "restitution",
        "impulse.0",
        "peak_force.0",
        "duration.0",
        "vibration",
        "velocity_after.0",
        "velocity_after.1",
    ):
        picture = plot.sweep(swept[name], axes(), quantity)
        x, y = finite(*picture.values.get_data())
        law_x, law_y = finite(*picture.theory.get_data())
        nearest = np.abs(law_x[:, None] / x - 1).argmin(axis=0)
        assert law_x[nearest] == pytest.approx(x, rel=1e-9)
        scale = max(1.0, np.abs(y).max())
        assert y == pytest.approx(law_y[nearest], rel=1e-9, abs=1e-9 * scale), quantity


def test_no_theory_where_none_is_known(swept):
    for name, quantity in (
        ("strains", "restitution"),
        ("gaps", "velocity_after.2"),
        ("lengths", "final"),
        ("lengths", "episodes.0"),
    ):
        picture = plot.sweep(swept[name], axes(), quantity)
        assert picture.theory is None
        assert legend(picture) == []


def test_a_curve_is_broken_where_it_jumps_and_only_there(swept):
    picture = plot.sweep(swept["areas"], axes(), "duration.0")
    x, y = picture.values.get_data()
    (gap,) = np.flatnonzero(np.isnan(y))
    assert x[gap - 1] == pytest.approx(100.0)
    assert x[gap + 1] == pytest.approx(105.0)
    assert y[[gap - 1, gap + 1]] == pytest.approx([1e6 / C, 2e6 / C])
    (gap,) = np.flatnonzero(np.isnan(picture.theory.get_ydata()))
    assert picture.theory.get_xdata()[gap] == pytest.approx(100.0, abs=1.0)
    assert picture.ax.get_xlabel() == "area of rod 1 (mm²)"
    assert picture.ax.get_ylabel() == "force duration (µs)"
    for quantity in (
        "restitution",
        "velocity_after.0",
        "impulse.0",
    ):  # a corner is no jump
        assert np.isfinite(
            plot.sweep(swept["areas"], axes(), quantity).values.get_ydata()
        ).all()


@pytest.mark.parametrize(
    "values",
    [
        1.5 ** np.arange(20),
        np.abs(np.arange(20) - 9.5) ** 3,
        np.sqrt(np.arange(20)),
        np.maximum(np.arange(20) - 9.0, 0),
        1 + 1e-16 * (np.arange(20) % 7 == 3) * np.arange(20),
        np.maximum(np.arange(20) - 9.0, 0.01 * (np.arange(20) > 4)),
    ],
)
def test_steepness_round_off_and_trifles_are_no_jumps(values):
    assert np.isfinite(plot.sweep(showing(values), axes()).values.get_ydata()).all()


def test_collisions_without_a_value_leave_a_gap():
    velocities = np.linspace(-0.5, 1.5, 9)
    picture = plot.sweep(ri.sweep(ri.System([rod(0.5, velocities), rod()])), axes())
    assert np.isnan(picture.values.get_ydata()).tolist() == [True] * 3 + [False] * 6
    x, y = finite(*picture.theory.get_data())
    assert y == pytest.approx(np.full(y.shape, 0.5))
    assert x.min() > 0


def test_words_instead_of_codes(swept):
    picture = plot.sweep(swept["lengths"], axes(), "status")
    assert [t.get_text() for t in picture.ax.get_yticklabels()] == [
        "final",
        "max_events",
        "clock",
        "refused",
        "until",
    ]
    picture = plot.sweep(swept["map"], axes(), "final")
    assert [t.get_text() for t in picture.colour_bar.ax.get_yticklabels()] == [
        "not proved",
        "proved",
    ]


def test_values_in_any_order_are_drawn_in_increasing_order():
    lengths = np.array([2.0, 0.5, 1.0, 0.25])
    areas = np.array([3e-4, 1e-4, 2e-4])
    picture = plot.sweep(ri.sweep(ri.System([rod(lengths, 1.0), rod()])), axes())
    assert picture.values.get_xdata() == pytest.approx([0.25, 0.5, 1.0, 2.0])
    assert picture.values.get_ydata() == pytest.approx([0.25, 0.5, 1.0, 0.5])
    result = ri.sweep(ri.System([rod(column(lengths), 1.0), rod(area=areas)]))
    cells = np.asarray(plot.sweep(result, axes()).cells.get_array())
    assert cells == pytest.approx(result.restitution[np.ix_([3, 1, 2, 0], [1, 2, 0])].T)


def test_what_varies_along_with_it_is_named():
    lengths = np.linspace(0.1, 1, 5)
    result = ri.sweep(ri.System([rod(1.0, 1.0), *[rod(lengths)] * 4]))
    picture = plot.sweep(result, axes(), "velocity_after.4")
    assert picture.ax.get_xlabel() == (
        "length of rod 2 (m)\nwith length of rod 3 and 2 more"
    )
    assert picture.ax.get_ylabel() == "velocity of rod 5 after (m/s)"


# Maps -------------------------------------------------------------------------------------------


def test_a_map_has_a_cell_for_each_collision(swept):
    picture = plot.sweep(swept["map"], axes())
    assert np.asarray(picture.cells.get_array()) == pytest.approx(
        swept["map"].restitution.T
    )
    corners = np.asarray(picture.cells.get_coordinates())
    x, y = corners[0, :, 0], corners[:, 0, 1]
    middle = np.sqrt(LENGTHS[:-1] * LENGTHS[1:])
    assert x[1:-1] == pytest.approx(middle)
    assert x[[0, -1]] == pytest.approx([0.25 / 2**0.125, 4 * 2**0.125])
    assert np.sqrt(y[:-1] * y[1:]) == pytest.approx(AREAS * 1e6)
    assert limits(picture) == pytest.approx((*x[[0, -1]], *y[[0, -1]]))
    assert (picture.ax.get_xscale(), picture.ax.get_yscale()) == ("log", "log")
    assert picture.ax.get_xlabel() == "length of rod 1 (m)"
    assert picture.ax.get_ylabel() == "area of rod 2 (mm²)"
    assert picture.colour_bar.ax.get_ylabel() == "coefficient of restitution e"
    assert picture.cells.get_rasterized()


def test_lines_of_equal_times_and_impedances(swept):
    picture = plot.sweep(swept["map"], axes())
    times, impedances = (lines.get_paths()[0].vertices for lines in picture.theory)
    assert times[:, 0] == pytest.approx(1.0)
    assert np.ptp(times[:, 1]) == pytest.approx(480)
    assert impedances[:, 1] == pytest.approx(100.0)
    assert np.ptp(impedances[:, 0]) == pytest.approx(3.75)
    assert legend(picture) == ["equal transit times: e = 1", "equal impedances"]


def test_lines_that_do_not_cross_the_map_are_not_drawn(swept):
    thicker = ri.sweep(
        ri.System([rod(column([0.2, 0.5, 0.8]), 1.0), rod(area=[2e-4, 3e-4])])
    )
    assert plot.sweep(thicker, axes()).theory == []
    assert plot.sweep(swept["left wall"], axes()).theory == []
    assert plot.sweep(swept["heads"], axes()).theory == []
    alike = np.linspace(0.1, 2, 20)
    almost = alike * (1 + 3e-16 * (np.arange(20) % 3 - 1))
    twins = ri.sweep(
        ri.System([rod(column(alike), 1.0), rod(column(almost), area=[2e-4, 3e-4])])
    )
    assert plot.sweep(twins, axes()).theory == []
    (times,) = plot.sweep(swept["speeds"], axes()).theory
    assert times.get_paths()[0].vertices[:, 1].min() == pytest.approx(
        0.5
    )  # none collide below


def test_contour_lines_follow_the_law():
    lengths = np.linspace(0.05, 0.95, 40)
    result = ri.sweep(
        ri.System([rod(column(lengths), 1.0), rod(np.linspace(1, 2, 30))])
    )
    picture = plot.sweep(result, axes())
    assert levels_of(picture) == pytest.approx([0.2, 0.4, 0.6, 0.8])
    for level, path in zip(
        picture.contours.levels, picture.contours.get_paths(), strict=True
    ):
        x, y = path.vertices.T
        assert x / y == pytest.approx(np.full(x.shape, level), abs=1e-3)
    assert sorted({text.get_text() for text in picture.labels}) == [
        "0.2",
        "0.4",
        "0.6",
        "0.8",
    ]


def test_contour_lines_end_at_a_jump():
    lengths, areas = np.geomspace(0.1, 10, 61), np.geomspace(1e-5, 1e-3, 60)
    result = ri.sweep(ri.System([rod(column(lengths), 1.0), rod(area=areas)]))
    picture = plot.sweep(result, axes(), "duration.0")
    assert picture.colour_bar.ax.get_ylabel() == "force duration (ms)"
    assert levels_of(picture)
    for level, path in zip(
        picture.contours.levels, picture.contours.get_paths(), strict=True
    ):
        x, y = path.vertices.T
        assert np.all(y > 100)
        assert x == pytest.approx(np.full(x.shape, level * 1e-3 * C / 2), rel=0.02)


def test_no_contour_follows_a_plateau():
    x, y = column(np.linspace(0, 1, 40)), np.linspace(0, 1, 40)
    noise = 1e-12 * np.random.default_rng(1).uniform(-1, 1, (40, 40))
    values = (
        np.minimum(x + y, 1) + np.maximum(x + y - 1.5, 0) * 2 + noise
    )  # 1 over a wide band
    levels = levels_of(plot.sweep(showing(values), axes()))
    assert 1.0 not in levels
    assert {0.5, 1.5} <= set(levels)
    ridge = 1 - np.abs(x - 0.5) * (1 + y) + noise  # up to 1 and a little more
    assert 0.8 <= max(levels_of(plot.sweep(showing(ridge), axes()))) < 1
    assert max(levels_of(plot.sweep(showing(1.005 * x + 0 * y), axes()))) == 0.8
    picture = plot.sweep(showing(1 + noise), axes())
    assert picture.contours is None
    assert picture.labels == []
    assert picture.cells.norm.vmin == 0


def test_colours_are_symmetric_only_where_signs_differ(swept):
    norm = plot.sweep(swept["map"], axes(), "velocity_after.0").cells.norm
    assert norm.vmin == -norm.vmax < 0
    norm = plot.sweep(swept["map"], axes()).cells.norm
    assert norm.vmin == swept["map"].restitution.min() > 0


def test_counts_have_a_colour_each(swept):
    picture = plot.sweep(swept["heads"], axes(), "episodes.0")
    assert picture.cells.get_array().tolist() == swept["heads"].episodes.T.tolist()
    assert picture.cells.norm.boundaries.tolist() == [0.5, 1.5, 2.5]
    assert picture.contours is None
    assert picture.ax.get_xlabel() == "length of segment 1 of rod 2 (m)"
    assert picture.ax.get_ylabel() == "area of segment 1 of rod 2 (m²)"
    one = plot.sweep(swept["map"], axes(), "episodes.0")
    assert one.cells.norm.boundaries.tolist() == [0.5, 1.5]
    render(one)


def drawable(result):
    return [q for q, values in result.columns.items() if np.isfinite(values).any()]


@pytest.mark.parametrize("name", few_of(SYSTEMS, {"lengths", "map", "heads"}))
def test_every_family_renders(swept, name):
    render(plot.sweep(swept[name], quantity=drawable(swept[name])[0]))


@pytest.mark.parametrize("name", few_of(SYSTEMS, {"few", "map"}))
def test_every_quantity_of_every_family_is_drawn(swept, name):
    for quantity in drawable(swept[name]):
        assert plot.sweep(swept[name], axes(), quantity).ax.get_xlabel()


# Words ------------------------------------------------------------------------------------------


WALLED = ri.System([rod(), rod(), ri.Wall()])
MASSES = ri.System(
    [rod(), *[ri.RigidMass(1.0)] * 3, rod()],
    contacts=[
        ri.SpringDashpot(1e8, 1e3),
        ri.HuntCrossley(1e9, 0.1),
        ri.Rigid(0.5),
        ri.Rigid(),
    ],
    ends=(ri.Pushed(1e3), ri.Moved(1.0)),
)
WORDS = {
    (labels.parameter, WALLED): [
        ("bodies.0.length", 2.0, "length of rod 1 (m)"),
        ("bodies.0.area", 1e-3, "area of rod 1 (mm²)"),
        ("bodies.1.segments.2.area", 1e-4, "area of segment 3 of rod 2 (mm²)"),
        ("bodies.0.polar_moment", 1e-9, "polar moment of rod 1 (m⁴)"),
        (
            "bodies.1.segments.0.material.youngs_modulus",
            2e11,
            "Young's modulus of segment 1 of rod 2 (GPa)",
        ),
        ("bodies.2.velocity", 0.5, "velocity of wall (mm/s)"),
        ("bodies.0.strain", 2e-4, "strain of rod 1 (10⁻⁶)"),
        ("bodies.0.velocity.values.1", 3.0, "velocity of piece 2 of rod 1 (m/s)"),
        ("bodies.0.strain.at.0", 0.5, "place of jump 1 of strain, rod 1 (m)"),
        ("contacts.0.gap", 3e-5, "gap 1-2 (µm)"),
        ("contacts.1.stiffness", 3e5, "contacts.1.stiffness"),
    ],
    (labels.parameter, MASSES): [
        ("gravity", 9.81, "gravity (m/s²)"),
        ("bodies.1.mass", 0.05, "mass 2 (g)"),
        ("bodies.1.velocity", 0.5, "velocity of mass 2 (mm/s)"),
        ("contacts.0.stiffness", 3e8, "stiffness of contact 1-2 (MN/m)"),
        ("contacts.1.damping", 0.2, "damping of contact 2-3 (s/m)"),
        ("contacts.2.restitution", 1.0, "coefficient of restitution of contact 3-4"),
        ("contacts.3.stiffness", 1.0, "contacts.3.stiffness"),
        ("ends.left.value.values.1", 2e3, "piece 2 of force on the left end (kN)"),
        ("ends.left.value.at.0", 1e-4, "time of jump 1 of force on the left end (µs)"),
        ("ends.right.value", 2.0, "velocity of the right end (m/s)"),
        (
            "ends.right.value.step",
            1e-6,
            "time between samples of velocity of the right end (µs)",
        ),
    ],
    (labels.outcome, WALLED): [
        ("restitution", 1.0, "coefficient of restitution e"),
        ("velocity_after.2", 2.0, "velocity of wall after (m/s)"),
        ("impulse.1", 0.3, "impulse at contact 2-wall (mN s)"),
        ("peak_force.0", 2e3, "peak force at contact 1-2 (kN)"),
        ("duration.0", 4e-4, "force duration at contact 1-2 (µs)"),
        ("episodes.1", 3, "episodes of contact at contact 2-wall"),
    ],
    (labels.outcome, ri.System([rod(), rod()])): [("impulse.0", 0.3, "impulse (mN s)")],
}


@pytest.mark.parametrize(
    ("words", "system", "name", "largest", "label"),
    [(*what, *case) for what, cases in WORDS.items() for case in cases],
)
def test_numbers_and_results_in_words(words, system, name, largest, label):
    assert scale_of(words(system, name), largest).label == label


# Errors, manners --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("restituton", "perhaps 'restitution' is meant"),
        ("episodes", r"perhaps 'episodes\.\d' is meant"),
        (
            "impulse.7",
            r"no result is called 'impulse\.7'; perhaps 'impulse\.1' is meant",
        ),
        (
            "heat",
            r"no result is called 'heat'; use one of restitution, velocity_after\.0, ",
        ),
    ],
)
def test_an_unknown_quantity_is_named_with_what_there_is(swept, quantity, message):
    with pytest.raises(ValueError, match=message):
        plot.sweep(swept["gaps"], axes(), quantity)


def test_a_quantity_without_values_is_refused(swept):
    for name in ("gaps", "receding"):
        with pytest.raises(
            ValueError, match=r"no value anywhere .* result.explain\(index\)"
        ):
            plot.sweep(swept[name], axes())


def test_families_without_axis_or_with_three_are_refused():
    for system in (
        ri.System([rod(0.4, 1.0), rod()]),
        ri.System([rod([0.4], 1.0), rod()]),
    ):
        with pytest.raises(ValueError, match=r"one axis and a map two; give an array"):
            plot.sweep(ri.sweep(system), axes())
    cube = ri.System(
        [
            rod(np.array([0.3, 0.4])[:, None, None], column([1.0, 2.0])),
            rod(area=[1e-4, 2e-4]),
        ]
    )
    with pytest.raises(ValueError, match=r"shape \(2, 2, 2\).*system\[0\]"):
        plot.sweep(ri.sweep(cube), axes())
    assert plot.sweep(ri.sweep(cube[0]), axes()).cells.get_array().shape == (2, 2)


def test_many_cells_make_a_small_file_with_the_same_bytes_every_time(tmp_path):
    x = np.linspace(0, 1, 500)
    result = showing(np.hypot(column(x), np.sin(5 * x)))
    file = vector_file(lambda: plot.sweep(result), tmp_path)
    assert file.count(b"<image") == 2  # cells and colour bar
    assert len(file) < 250_000


def test_a_text_in_place_of_the_axes_is_refused_with_the_name_of_its_argument():
    family = ri.sweep(SYSTEMS["few"])
    with pytest.raises(ri.InvalidModel) as refused:
        ri.plot.sweep(family, "duration.0")
    assert str(refused.value) == (
        "ax: must be an Axes, got 'duration.0'; give the text by name, "
        "quantity='duration.0'"
    )
    with pytest.raises(ri.InvalidModel, match="field='stress'"):
        ri.plot.spacetime(ri.solve(SYSTEMS["few"][0]), "stress")
    with pytest.raises(ri.InvalidModel, match="got 'x'; leave it out"):
        ri.plot.energy(ri.solve(SYSTEMS["few"][0]), "x")
