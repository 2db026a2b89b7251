"""Figures of families: curves and maps show results, labels with units, and theory."""

import numpy as np
import pytest
from drawing import C, axes, legend, render, rod, texts_of, vector_file
from exhaustive import few_of

import rodimpact as ri
from rodimpact import plot
from rodimpact.methods.registry import Options
from rodimpact.plot.scales import scale_of
from rodimpact.results import labels
from rodimpact.running.sweep_result import SweepResult
from rodimpact.storage.casefile import parse_case

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def column(values):
    """Values along the first axis of a family of two axes, of shape (n, 1)."""
    return np.asarray(values)[:, np.newaxis]


def rods_with_heads():
    """A family [7, 6]: a rod strikes a heavy one, by the length and the area of the thin
    head of the heavy one. Not swept.
    """
    lengths = column(np.linspace(1.1, 2.9, 7))
    areas = np.linspace(1.1, 2.6, 6)
    head = ri.Segment(lengths, areas, UNIT)
    body = ri.Segment(20.0, 10.0, UNIT)
    striker = rod(1.0, 1.0, area=1.0, material=UNIT)
    return ri.System([striker, ri.Rod(segments=[head, body])])


def speeds():
    """A map over length and velocity of the striker, some of which recede; not solved."""
    lengths = column(np.linspace(0.5, 1.5, 9))
    velocities = np.linspace(-1, 2, 7)
    return ri.System([rod(lengths, velocities), rod()])


def moving_wall():
    """A map over length and velocity of a rod beside a moving wall; not solved."""
    lengths = column(np.linspace(0.1, 1, 4))
    velocities = np.linspace(-2, 1, 9)
    return ri.System([ri.Wall(0.5), rod(lengths, velocities)])


def gaps():
    """Rows of three rods with many gaps before the second one; not solved."""
    rods = [rod(0.2, 1.0), rod(0.3), rod(0.2)]
    first_gaps = np.linspace(0, 2e-4, 9)
    return ri.System(rods, gaps=[first_gaps, 1e-5])


SIXTY_LENGTHS = np.linspace(0.1, 3, 60)  # m
TEN_LENGTHS = np.linspace(0.25, 2.5, 10)  # m
STRIKER_AREAS = np.linspace(2e-5, 3e-4, 57)  # m^2
LENGTHS = np.geomspace(0.25, 4, 17)  # m, of the map
AREAS = np.geomspace(2e-5, 5e-4, 21)  # m^2, of the map
SYSTEMS = {
    "lengths": ri.System([rod(SIXTY_LENGTHS, 1.0), rod()]),
    "few": ri.System([rod(TEN_LENGTHS, 1.0, area=3e-4), rod()]),
    "areas": ri.System([rod(0.5, 1.0, area=STRIKER_AREAS), rod()]),
    "map": ri.System([rod(column(LENGTHS), 1.0), rod(area=AREAS)]),
    "speeds": speeds(),
    "wall": ri.System([rod(np.linspace(0.1, 1, 10), 1.0), ri.Wall()]),
    "left wall": moving_wall(),
    "gaps": gaps(),
    "heads": rods_with_heads(),
    "strains": ri.System([rod(0.5, 1.0), rod(strain=np.linspace(-1e-4, 1e-4, 5))]),
    "receding": ri.System([rod(np.linspace(0.5, 1, 4), -1.0), rod()]),
}


@pytest.fixture(scope="module")
def swept():
    """{name: result of the sweep} of the families `SYSTEMS`.

    It fails if a sweep divides by zero, overflows or makes an invalid operation.
    """
    results = {}
    with np.errstate(all="raise", under="ignore"):
        for name, system in SYSTEMS.items():
            results[name] = ri.sweep(system)
    return results


def result_of(values):
    """A sweep over lengths, or over lengths and areas, with these values as its
    results.
    """
    lengths = np.linspace(1, 2, values.shape[0])
    areas = 1e-4
    if values.ndim == 2:
        lengths = column(lengths)
        areas = np.linspace(1e-4, 2e-4, values.shape[1])
    system = ri.System([rod(lengths, 1.0, strain=1e-6), rod(area=areas)])
    columns = {"restitution": values, "episodes.0": values}
    options = Options(method="fronts")
    return SweepResult(system, options, columns)


def swept_map(lengths, second_rod):
    """Sweep a map over lengths of rod 1, at 1 m/s, and a parameter of rod 2."""
    first_rod = rod(column(lengths), 1.0)
    return ri.sweep(ri.System([first_rod, second_rod]))


def limits(picture):
    """Limits of both axes, (left, right, bottom, top)."""
    ax = picture.ax
    return (*ax.get_xlim(), *ax.get_ylim())


def levels_of(values):
    """Levels of the contours of a map of values."""
    picture = plot.sweep(result_of(values), axes())
    return list(picture.contours.levels)


def contours_of(picture):
    """Level and path of each contour."""
    contours = picture.contours
    return zip(contours.levels, contours.get_paths(), strict=True)


def finite_points(line):
    """Arrays x and y of the points of a line that have a finite y."""
    x, y = line.get_data()
    is_finite = np.isfinite(y)
    return x[is_finite], y[is_finite]


# Curves


def test_a_curve_goes_through_the_results(swept):
    """The struck rod is 1 m long: e is the shorter length over the longer one."""
    picture = plot.sweep(swept["lengths"], axes())

    e = np.minimum(SIXTY_LENGTHS, 1 / SIXTY_LENGTHS)
    drawn_lengths, drawn_e = picture.values.get_data()
    assert drawn_lengths == pytest.approx(SIXTY_LENGTHS)
    assert drawn_e == pytest.approx(e)
    assert picture.values.get_linestyle() == "-"
    ax = picture.ax
    assert ax.get_xlabel() == "length of rod 1 (m)"
    assert ax.get_ylabel() == "coefficient of restitution e"
    assert ax.get_xscale() == "linear"


def test_a_curve_of_many_points_has_marks_where_no_line_goes():
    """Points 0 and 2, whose neighbours are missing, have a mark; all others do not."""
    values = np.linspace(0.1, 1.0, 60)
    values[[1, 3]] = np.nan

    picture = plot.sweep(result_of(values), axes())

    curve = picture.values
    marked_indices = curve.get_markevery()
    marked = curve.get_ydata()[marked_indices]
    expected = [values[0], values[2]]
    assert marked.tolist() == expected


def test_the_closed_form_lies_under_few_points_and_is_smooth_between_them(swept):
    """A sweep over few lengths is drawn as points without lines; below them,
    Saint-Venant's restitution is drawn as a curve of at least 400 points, exact to
    1e-12. The legend names both.
    """
    picture = plot.sweep(swept["few"], axes())

    computed = picture.values
    assert computed.get_marker() == "o"
    assert computed.get_linestyle() == "None"
    x, y = picture.theory.get_data()
    assert x.size >= 400
    # The impedance ratio is 3; the struck rod is 1 m long, the striker has 1 m/s.
    exact = ri.theory.saint_venant(3.0, x, 1.0, 1.0).restitution
    assert y == pytest.approx(exact, abs=1e-12)
    assert picture.theory.get_zorder() <= computed.get_zorder()
    assert legend(picture) == ["closed form", "computed"]


def test_curves_of_two_families_are_told_apart(swept):
    """Three families in one axes have different colours and names in the legend, the
    last one "family 3", and the limits hold all curves.
    """
    ax = axes()
    shorter_lengths = swept["lengths"].system[:40]

    first = plot.sweep(swept["few"], ax, label="thin")
    second = plot.sweep(ri.sweep(shorter_lengths), ax, "vibration", label="thick")
    third = plot.sweep(swept["few"], ax)

    curves = [first.values, second.values, third.values]
    colours = {curve.get_color() for curve in curves}
    assert len(colours) == 3
    assert legend(third) == ["closed form", "thin", "thick", "family 3"]
    left, right = ax.get_xlim()
    _, top = ax.get_ylim()
    for curve in curves:
        x, y = curve.get_data()
        assert left <= min(x)
        assert max(x) <= right
        assert np.nanmax(y) <= top


def test_displacements_are_in_millimetres_as_in_tables():
    """A sweep of displacements is drawn in mm, up to the largest one."""
    lengths = np.linspace(0.5, 2.0, 4)
    family = ri.System([rod(lengths, 1.0), rod()])
    moved = ri.sweep(family, until=0.2, also=["displacement"])

    ax = plot.sweep(moved, axes(), "displacement.1").ax

    assert ax.get_ylabel().endswith("(mm)")
    _, top = ax.get_ylim()
    largest = 1e3 * max(moved.displacements[1])  # mm
    assert top == pytest.approx(largest, rel=0.1)


QUANTITIES = (
    "restitution",
    "impulse.0",
    "peak_force.0",
    "duration.0",
    "vibration",
    "velocity_after.0",
    "velocity_after.1",
)


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("name", ["lengths", "areas", "few", "wall"])
def test_theory_and_results_agree(swept, name, quantity):
    """At each result of a sweep, the drawn theory has a point at the same place, with
    the same value to 1e-9.
    """
    picture = plot.sweep(swept[name], axes(), quantity)

    x, y = finite_points(picture.values)
    theory_x, theory_y = finite_points(picture.theory)
    distances = np.abs(column(theory_x) / x - 1)  # [point of the theory, result]
    nearest = distances.argmin(axis=0)
    assert theory_x[nearest] == pytest.approx(x, rel=1e-9)
    expected = theory_y[nearest]
    scale = max(1.0, np.abs(y).max())
    assert y == pytest.approx(expected, rel=1e-9, abs=1e-9 * scale)


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("strains", "restitution"),
        ("gaps", "velocity_after.2"),
        ("lengths", "final"),
        ("lengths", "episodes.0"),
    ],
)
def test_no_theory_where_none_is_known(swept, name, quantity):
    picture = plot.sweep(swept[name], axes(), quantity)

    assert picture.theory is None
    assert legend(picture) == []


def test_a_curve_is_broken_at_a_jump(swept):
    """The curve and the closed form have one gap, at equal areas."""
    picture = plot.sweep(swept["areas"], axes(), "duration.0")

    x, y = picture.values.get_data()  # mm^2, us
    (gap,) = np.flatnonzero(np.isnan(y))
    before = gap - 1
    after = gap + 1
    assert x[before] == pytest.approx(100.0)
    assert x[after] == pytest.approx(105.0)
    # At equal areas, 100 mm^2, the duration jumps from 2 l1/c to 2 l2/c.
    assert y[before] == pytest.approx(1e6 / C)
    assert y[after] == pytest.approx(2e6 / C)
    theory_x, theory_y = picture.theory.get_data()
    (theory_gap,) = np.flatnonzero(np.isnan(theory_y))
    assert theory_x[theory_gap] == pytest.approx(100.0, abs=1.0)
    ax = picture.ax
    assert ax.get_xlabel() == "area of rod 1 (mm²)"
    assert ax.get_ylabel() == "force duration (µs)"


@pytest.mark.parametrize("quantity", ["restitution", "velocity_after.0", "impulse.0"])
def test_a_curve_is_not_broken_at_a_corner(swept, quantity):
    picture = plot.sweep(swept["areas"], axes(), quantity)

    drawn = picture.values.get_ydata()
    assert np.isfinite(drawn).all()


N = np.arange(20)
WITHOUT_JUMPS = {
    "steep": 1.5**N,
    "cubic": np.abs(N - 9.5) ** 3,
    "root": np.sqrt(N),
    "corner": np.maximum(N - 9.0, 0),
    "round-off": 1 + 1e-16 * (N % 7 == 3) * N,
    "trifle": np.maximum(N - 9.0, 0.01 * (N > 4)),
}


@pytest.mark.parametrize("values", WITHOUT_JUMPS.values(), ids=WITHOUT_JUMPS)
def test_steepness_round_off_and_trifles_do_not_break_a_curve(values):
    """The values are a function without a jump; all of them are drawn."""
    picture = plot.sweep(result_of(values), axes())

    drawn = picture.values.get_ydata()
    assert np.isfinite(drawn).all()


def test_collisions_without_a_value_leave_a_gap():
    """In a sweep over velocities, members that do not collide have no point, and the
    theory, e = 0.5, begins above 0.
    """
    velocities = np.linspace(-0.5, 1.5, 9)
    family = ri.System([rod(0.5, velocities), rod()])

    picture = plot.sweep(ri.sweep(family), axes())

    does_not_collide = velocities <= 0
    drawn = picture.values.get_ydata()
    assert np.array_equal(np.isnan(drawn), does_not_collide)
    x, e = finite_points(picture.theory)
    assert x.min() > 0
    expected = np.full(e.shape, 0.5)  # the ratio of the lengths
    assert e == pytest.approx(expected)


def test_codes_of_a_status_are_words(swept):
    picture = plot.sweep(swept["lengths"], axes(), "status")

    words = ["final", "max_events", "clock", "refused", "until"]
    assert texts_of(picture.ax.get_yticklabels()) == words


def test_codes_of_a_map_are_words(swept):
    picture = plot.sweep(swept["map"], axes(), "final")

    colour_bar = picture.colour_bar.ax
    assert texts_of(colour_bar.get_yticklabels()) == ["not proved", "proved"]


UNORDERED_LENGTHS = np.array([2.0, 0.5, 1.0, 0.25])


def test_values_in_any_order_are_drawn_in_increasing_order():
    family = ri.System([rod(UNORDERED_LENGTHS, 1.0), rod()])

    picture = plot.sweep(ri.sweep(family), axes())

    lengths, restitutions = picture.values.get_data()
    assert lengths == pytest.approx([0.25, 0.5, 1.0, 2.0])
    assert restitutions == pytest.approx([0.25, 0.5, 1.0, 0.5])


@pytest.mark.exhaustive
def test_cells_of_values_in_any_order_are_drawn_in_increasing_order():
    """A map over lengths and areas in no order has its cells sorted by both."""
    areas = np.array([3e-4, 1e-4, 2e-4])
    result = swept_map(UNORDERED_LENGTHS, rod(area=areas))

    picture = plot.sweep(result, axes())

    by_length = [3, 1, 2, 0]  # indices of UNORDERED_LENGTHS, smallest first
    by_area = [1, 2, 0]
    in_order = result.restitution[by_length][:, by_area]
    cells = np.asarray(picture.cells.get_array())  # [area, length]
    assert cells == pytest.approx(in_order.T)


def test_parameters_that_vary_together_are_named():
    """Four rods share the varied length: the axis names rod 2, rod 3 and "2 more"."""
    striker = rod(1.0, 1.0)
    alike = rod(np.linspace(0.1, 1, 5))
    family = ri.System([striker, alike, alike, alike, alike])

    ax = plot.sweep(ri.sweep(family), axes(), "velocity_after.4").ax

    label = "length of rod 2 (m)\nwith length of rod 3 and 2 more"
    assert ax.get_xlabel() == label
    assert ax.get_ylabel() == "velocity of rod 5 after (m/s)"


# Maps


def varied_case(**vary):
    """A case of two rods of a material called bar, with grids by paths or variables."""
    text = """
schema = 1
materials.bar = {wave_speed = 5000, density = 8000}
bodies = [
    {kind = "rod", length = 0.4, area = 1e-4, material = "bar", velocity = 1},
    {kind = "rod", length = 1.0, area = 1e-4, material = "bar"},
]
"""
    return parse_case(text, vary=vary)


@pytest.mark.parametrize(
    ("vary", "label", "first_value"),
    [
        (
            {"materials.bar.wave_speed": "4 km/s:6 km/s:3"},
            "wave speed of material bar (km/s)",
            4.0,
        ),
        (
            {"L": "20cm:60cm:3", "bodies.0.length": "L", "bodies.1.length": "2.5*L"},
            "L (m)",
            0.2,
        ),
        (
            {"n": "1,2,3", "bodies.0.length": "n*100mm", "bodies.1.length": "0.3*n"},
            "n",
            1.0,
        ),
    ],
)
def test_an_axis_is_named_by_what_the_user_varied(vary, label, first_value):
    """The axis of a sweep that is given `varied` has this label and holds `first_value`
    in its unit; without it, the axis is named by a number of the system.
    """
    case = varied_case(**vary)
    result = ri.sweep(case.system, workers=1)

    ax = ri.plot.sweep(result, quantity="impulse.0", varied=case.varied).ax
    ax_of_system = ri.plot.sweep(result, quantity="impulse.0").ax

    assert ax.get_xlabel() == label
    assert ax_of_system.get_xlabel() != label
    left, right = ax.get_xlim()
    assert left < first_value < right


def test_an_axis_that_no_body_of_the_family_has_is_named_by_its_path():
    case = varied_case(**{"bodies.0.length": "1:2:3"})
    result = ri.sweep(case.system, workers=1)
    elsewhere = case.varied[0]._replace(path="bodies.9.length")

    picture = ri.plot.sweep(result, quantity="impulse.0", varied=[elsewhere])

    assert picture.ax.get_xlabel() == "bodies.9.length (m)"


@pytest.mark.parametrize("varied", ["L", [1], [("L", np.ones(3), "m")], []])
def test_what_is_no_list_of_what_varies_is_refused(varied):
    case = varied_case(**{"bodies.0.length": "1:2:3"})
    result = ri.sweep(case.system, workers=1)

    with pytest.raises(ri.InvalidModel, match="varied: must be the `varied` of the"):
        ri.plot.sweep(result, varied=varied)


def test_something_else_after_what_varies_is_refused():
    case = varied_case(**{"bodies.0.length": "1:2:3"})
    result = ri.sweep(case.system, workers=1)

    with pytest.raises(ri.InvalidModel, match="varied: must be the `varied` of the"):
        ri.plot.sweep(result, varied=[*case.varied, 5])


@pytest.fixture(scope="module")
def map_picture(swept):
    """The coefficient of restitution over lengths and areas."""
    return plot.sweep(swept["map"], axes())


def test_a_map_has_a_cell_for_each_collision(swept, map_picture):
    """The map over lengths and areas has a cell with the restitution of each member;
    its borders are the geometric means of neighbouring values, the outer ones half a
    ratio beyond.
    """
    cells = map_picture.cells
    assert cells.get_rasterized()
    values = np.asarray(cells.get_array())  # [area, length]
    restitution = swept["map"].restitution  # [length, area]
    assert values == pytest.approx(restitution.T)

    corners = np.asarray(cells.get_coordinates())  # [area, length, (x, y)]
    x = corners[0, :, 0]  # m, borders of the lengths
    y = corners[:, 0, 1]  # mm^2, borders of the areas
    left, *inner_borders, right = x
    # Both axes are logarithmic: borders are geometric means.
    middles = np.sqrt(LENGTHS[:-1] * LENGTHS[1:])
    assert inner_borders == pytest.approx(middles)
    # Lengths have a ratio of 2**(1/4): outer borders lie half of that beyond them.
    assert left == pytest.approx(0.25 / 2**0.125)
    assert right == pytest.approx(4 * 2**0.125)
    middles_of_areas = np.sqrt(y[:-1] * y[1:])
    assert middles_of_areas == pytest.approx(AREAS * 1e6)
    outer_borders = (left, right, y[0], y[-1])
    assert limits(map_picture) == pytest.approx(outer_borders)


def test_a_map_of_few_collisions_has_a_tick_at_each_number():
    """A map of 3 x 3 has its lengths and velocities as ticks."""
    lengths = [0.25, 0.5, 0.75]  # m
    velocities = [1.0, 2.0, 3.0]  # m/s
    striker = rod(column(lengths), np.array(velocities))
    family = ri.System([striker, rod()])

    ax = plot.sweep(ri.sweep(family), quantity="restitution").ax

    assert ax.get_xticks().tolist() == lengths
    assert ax.get_yticks().tolist() == velocities


def test_a_map_of_many_collisions_or_of_neighbours_keeps_round_ticks():
    """Lengths that are too near each other, and velocities that are too many, are no
    ticks.
    """
    lengths = [0.31, 0.32, 0.93]  # m
    velocities = np.linspace(0.91, 4.03, 7)  # m/s
    striker = rod(column(lengths), velocities)
    family = ri.System([striker, rod()])

    ax = plot.sweep(ri.sweep(family), quantity="restitution").ax

    assert lengths[0] not in ax.get_xticks()  # too near to the second length
    assert velocities[0] not in ax.get_yticks()  # one of too many velocities


def test_a_map_has_logarithmic_axes_and_labels_with_units(map_picture):
    ax = map_picture.ax
    colour_bar = map_picture.colour_bar.ax
    assert ax.get_xscale() == "log"
    assert ax.get_yscale() == "log"
    assert ax.get_xlabel() == "length of rod 1 (m)"
    assert ax.get_ylabel() == "area of rod 2 (mm²)"
    assert colour_bar.get_ylabel() == "coefficient of restitution e"


def first_path(lines):
    """Arrays x and y of the first path of a collection of lines."""
    return lines.get_paths()[0].vertices.T


def test_lines_of_equal_times_and_impedances_cross_the_map(map_picture):
    """A map over the length of one rod, 0.25 to 4 m, and the area of the other, 20 to
    500 mm^2, has two named lines across all of it: equal transit times at 1 m, and
    equal impedances at 100 mm^2.
    """
    equal_times, equal_impedances = map_picture.theory
    lengths, areas = first_path(equal_times)  # m, mm^2
    assert lengths == pytest.approx(1.0)
    assert np.ptp(areas) == pytest.approx(500 - 20)
    lengths, areas = first_path(equal_impedances)
    assert areas == pytest.approx(100.0)
    assert np.ptp(lengths) == pytest.approx(4 - 0.25)
    assert legend(map_picture) == ["equal transit times: e = 1", "equal impedances"]


@pytest.mark.parametrize("name", ["left wall", "heads"])
def test_systems_without_lines_of_equal_times_or_impedances_have_none(swept, name):
    picture = plot.sweep(swept[name], axes())

    assert picture.theory == []


def test_lines_that_do_not_cross_the_map_are_not_drawn():
    """All strikers are shorter, and all struck rods thicker, than the other rod."""
    thicker = rod(area=[2e-4, 3e-4])
    result = swept_map([0.2, 0.5, 0.8], thicker)

    picture = plot.sweep(result, axes())

    assert picture.theory == []


def test_no_line_is_drawn_between_lengths_that_differ_by_round_off():
    """A map with struck lengths equal to the last bit has no theory lines."""
    lengths = np.linspace(0.1, 2, 20)
    signs = np.arange(20) % 3 - 1  # -1, 0, 1 in turn
    almost_equal_lengths = lengths * (1 + 3e-16 * signs)
    struck = rod(column(almost_equal_lengths), area=[2e-4, 3e-4])
    result = swept_map(lengths, struck)

    picture = plot.sweep(result, axes())

    assert picture.theory == []


def test_lines_end_where_nothing_collides(swept):
    """The velocities are -1, -0.5, 0, 0.5 ... 2 m/s: 0.5 is the first that collides."""
    (equal_times,) = plot.sweep(swept["speeds"], axes()).theory

    _, velocities = first_path(equal_times)
    assert velocities.min() == pytest.approx(0.5)


def test_contour_lines_of_e_are_those_of_l1_over_l2():
    """A map over two lengths has labelled contours at 0.2, 0.4, 0.6 and 0.8, on which
    the ratio of the lengths is this level.
    """
    lengths = np.linspace(0.05, 0.95, 40)
    struck = rod(np.linspace(1, 2, 30))
    result = swept_map(lengths, struck)

    picture = plot.sweep(result, axes())

    levels = list(picture.contours.levels)
    assert levels == pytest.approx([0.2, 0.4, 0.6, 0.8])
    for level, path in contours_of(picture):
        first_length, second_length = path.vertices.T
        expected = np.full(first_length.shape, level)
        assert first_length / second_length == pytest.approx(expected, abs=1e-3)
    assert set(texts_of(picture.labels)) == {"0.2", "0.4", "0.6", "0.8"}


@pytest.mark.exhaustive
def test_contour_lines_of_the_duration_end_where_it_jumps():
    """Above equal areas, 100 mm^2, the duration is 2 l1/c."""
    lengths = np.geomspace(0.1, 10, 61)
    areas = np.geomspace(1e-5, 1e-3, 60)
    result = swept_map(lengths, rod(area=areas))

    picture = plot.sweep(result, axes(), "duration.0")

    colour_bar = picture.colour_bar.ax
    assert colour_bar.get_ylabel() == "force duration (ms)"
    assert picture.contours.levels.size > 0
    for duration, path in contours_of(picture):  # ms
        drawn_lengths, drawn_areas = path.vertices.T  # m, mm^2
        assert np.all(drawn_areas > 100)
        length = duration * 1e-3 * C / 2
        expected = np.full(drawn_lengths.shape, length)
        assert drawn_lengths == pytest.approx(expected, rel=0.02)


X = column(np.linspace(0, 1, 40))
Y = np.linspace(0, 1, 40)
NOISE = 1e-12 * np.random.default_rng(1).uniform(-1, 1, (40, 40))


def test_no_contour_follows_a_plateau():
    """Values are 1 over a wide band, in which noise would make contours at 1."""
    plateau = np.minimum(X + Y, 1)  # 1 over a wide band
    beyond = np.maximum(X + Y - 1.5, 0) * 2

    levels = levels_of(plateau + beyond + NOISE)

    assert 1.0 not in levels
    assert {0.5, 1.5} <= set(levels)


def test_no_contour_follows_a_ridge():
    """At the height of the ridge noise would make contours."""
    ridge = 1 - np.abs(X - 0.5) * (1 + Y)

    highest = max(levels_of(ridge + NOISE))  # values reach a little above 1

    assert 0.8 <= highest < 1


def test_no_contour_follows_the_frame():
    """A contour of 1.0 would lie 0.005 from the frame."""
    slope = 1.005 * X + 0 * Y

    highest = max(levels_of(slope))

    assert highest == 0.8


def test_a_constant_map_has_no_contours():
    """A map of ones with noise of 1e-12 has no contours; its colours begin at 0."""
    picture = plot.sweep(result_of(1 + NOISE), axes())

    assert picture.contours is None
    assert picture.labels == []
    assert picture.cells.norm.vmin == 0


@pytest.mark.exhaustive
def test_colours_are_symmetric_where_signs_differ(swept):
    """The velocity of the striker afterwards has both signs."""
    norm = plot.sweep(swept["map"], axes(), "velocity_after.0").cells.norm

    assert norm.vmin == -norm.vmax < 0


def test_colours_begin_at_the_smallest_value_of_one_sign(swept, map_picture):
    norm = map_picture.cells.norm

    assert norm.vmin == swept["map"].restitution.min() > 0


def test_counts_have_a_colour_each(swept):
    """A map of numbers of episodes draws 1 and 2 in a colour each, without contours;
    its axes name the varied numbers.
    """
    picture = plot.sweep(swept["heads"], axes(), "episodes.0")

    cells = picture.cells
    drawn_counts = cells.get_array()  # [area, length]
    counts = swept["heads"].episodes.T
    assert drawn_counts.tolist() == counts.tolist()
    boundaries = cells.norm.boundaries.tolist()
    assert boundaries == [0.5, 1.5, 2.5]
    assert picture.contours is None
    ax = picture.ax
    assert ax.get_xlabel() == "length of segment 1 of rod 2 (m)"
    assert ax.get_ylabel() == "area of segment 1 of rod 2 (m²)"


def test_one_count_has_a_colour(swept):
    """All members of the map have one episode: the only colour goes from 0.5 to 1.5, and
    the picture can be drawn.
    """
    picture = plot.sweep(swept["map"], axes(), "episodes.0")

    boundaries = picture.cells.norm.boundaries.tolist()
    assert boundaries == [0.5, 1.5]
    render(picture)


def drawable(result):
    """Names of the quantities of a sweep that are finite for at least one member."""
    quantities = []
    for quantity, values in result.columns.items():
        if np.isfinite(values).any():
            quantities.append(quantity)
    return quantities


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_family_renders(swept, name):
    first, *_ = drawable(swept[name])

    render(plot.sweep(swept[name], quantity=first))


@pytest.mark.parametrize("name", few_of(SYSTEMS, {"few"}))
def test_every_quantity_of_every_family_is_drawn(swept, name):
    for quantity in drawable(swept[name]):
        picture = plot.sweep(swept[name], axes(), quantity)
        assert picture.ax.get_xlabel()


# Words


def rods_and_masses():
    """Three masses between two rods, with each kind of number in laws and ends; not
    solved.
    """
    mass = ri.RigidMass(1.0)
    contacts = [
        ri.SpringDashpot(1e8, 1e3),
        ri.HuntCrossley(1e9, 0.1),
        ri.Rigid(0.5),
        ri.Rigid(),
    ]
    ends = (ri.Pushed(1e3), ri.Moved(1.0))
    return ri.System([rod(), mass, mass, mass, rod()], contacts=contacts, ends=ends)


PAIR = ri.System([rod(), rod()])
WALLED = ri.System([rod(), rod(), ri.Wall()])
MASSES = rods_and_masses()


@pytest.mark.parametrize(
    ("system", "name", "largest", "label"),
    [
        (WALLED, "bodies.0.length", 2.0, "length of rod 1 (m)"),
        (WALLED, "bodies.0.area", 1e-3, "area of rod 1 (mm²)"),
        (
            WALLED,
            "bodies.1.segments.2.area",
            1e-4,
            "area of segment 3 of rod 2 (mm²)",
        ),
        (WALLED, "bodies.0.polar_moment", 1e-9, "polar moment of rod 1 (m⁴)"),
        (
            WALLED,
            "bodies.1.segments.0.material.youngs_modulus",
            2e11,
            "Young's modulus of segment 1 of rod 2 (GPa)",
        ),
        (WALLED, "bodies.2.velocity", 0.5, "velocity of wall (mm/s)"),
        (WALLED, "bodies.0.strain", 2e-4, "strain of rod 1 (10⁻⁶)"),
        (
            WALLED,
            "bodies.0.velocity.values.1",
            3.0,
            "velocity of piece 2 of rod 1 (m/s)",
        ),
        (
            WALLED,
            "bodies.0.strain.at.0",
            0.5,
            "place of jump 1 of strain, rod 1 (m)",
        ),
        (WALLED, "contacts.0.gap", 3e-5, "gap 1-2 (µm)"),
        (WALLED, "contacts.1.stiffness", 3e5, "contacts.1.stiffness"),
        (MASSES, "gravity", 9.81, "gravity (m/s²)"),
        (MASSES, "bodies.1.mass", 0.05, "mass 2 (g)"),
        (MASSES, "bodies.1.velocity", 0.5, "velocity of mass 2 (mm/s)"),
        (
            MASSES,
            "contacts.0.stiffness",
            3e8,
            "stiffness of contact 1-2 (MN/m)",
        ),
        (MASSES, "contacts.1.damping", 0.2, "damping of contact 2-3 (s/m)"),
        (
            MASSES,
            "contacts.2.restitution",
            1.0,
            "coefficient of restitution of contact 3-4",
        ),
        (MASSES, "contacts.3.stiffness", 1.0, "contacts.3.stiffness"),
        (
            MASSES,
            "ends.left.value.values.1",
            2e3,
            "piece 2 of force on the left end (kN)",
        ),
        (
            MASSES,
            "ends.left.value.at.0",
            1e-4,
            "time of jump 1 of force on the left end (µs)",
        ),
        (MASSES, "ends.right.value", 2.0, "velocity of the right end (m/s)"),
        (
            MASSES,
            "ends.right.value.step",
            1e-6,
            "time between samples of velocity of the right end (µs)",
        ),
    ],
)
def test_parameters_have_a_label_in_words_with_a_unit(system, name, largest, label):
    words = labels.quantity_of_parameter(system, name)

    assert scale_of(words, largest).label == label


@pytest.mark.parametrize(
    "path",
    [
        "foo",
        "bodies.0.foo",
        "bodies.0.foo.at.0",
        "bodies.0.foo.values.0",
        "bodies.0.length.values.x",
        "bodies.9.length",
        "contacts.0.foo",
        "contacts.0.opens",
        "contacts.7.gap",
        "contacts.x.gap",
        "ends.left.value",
        "materials.steel.foo",
    ],
)
def test_an_unknown_path_is_its_own_name(path):
    assert labels.quantity_of_parameter(WALLED, path) == (path, "1")


@pytest.mark.parametrize(
    ("system", "name", "largest", "label"),
    [
        (WALLED, "restitution", 1.0, "coefficient of restitution e"),
        (WALLED, "velocity_after.2", 2.0, "velocity of wall after (m/s)"),
        (WALLED, "impulse.1", 0.3, "impulse at contact 2-wall (mN s)"),
        (WALLED, "peak_force.0", 2e3, "peak force at contact 1-2 (kN)"),
        (WALLED, "duration.0", 4e-4, "force duration at contact 1-2 (µs)"),
        (WALLED, "episodes.1", 3, "episodes of contact at contact 2-wall"),
        (PAIR, "impulse.0", 0.3, "impulse (mN s)"),
    ],
)
def test_results_have_a_label_in_words_with_a_unit(system, name, largest, label):
    words = labels.quantity_of_column(system, name)

    assert scale_of(words, largest).label == label


# Errors, manners


OTHER_IMPULSE = r"no result is called 'impulse\.7'; perhaps 'impulse\.1' is meant"
ALL_RESULTS = r"no result is called 'heat'; use one of restitution, velocity_after\.0, "


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("restituton", "perhaps 'restitution' is meant"),
        ("episodes", r"perhaps 'episodes\.\d' is meant"),
        ("impulse.7", OTHER_IMPULSE),
        ("heat", ALL_RESULTS),
    ],
)
def test_an_unknown_quantity_is_named_with_those_there_are(swept, quantity, message):
    with pytest.raises(ValueError, match=message):
        plot.sweep(swept["gaps"], axes(), quantity)


@pytest.mark.parametrize("name", ["gaps", "receding"])
def test_a_quantity_without_values_is_refused(swept, name):
    message = r"no value anywhere .* result.explain\(index\)"
    with pytest.raises(ValueError, match=message):
        plot.sweep(swept[name], axes())


@pytest.mark.parametrize("lengths", [0.4, [0.4]])
def test_families_without_axis_are_refused(lengths):
    family = ri.System([rod(lengths, 1.0), rod()])
    result = ri.sweep(family)

    with pytest.raises(ValueError, match=r"one axis and a map two; give an array"):
        plot.sweep(result, axes())


def test_a_family_of_three_axes_is_refused_and_a_member_is_drawn():
    """A family of shape (2, 2, 2) is refused with the advice of its first part, which
    is drawn as a map.
    """
    lengths = np.reshape([0.3, 0.4], (2, 1, 1))
    velocities = column([1.0, 2.0])
    areas = [1e-4, 2e-4]
    cube = ri.System([rod(lengths, velocities), rod(area=areas)])

    with pytest.raises(ValueError, match=r"shape \(2, 2, 2\).*system\[0\]"):
        plot.sweep(ri.sweep(cube), axes())
    picture = plot.sweep(ri.sweep(cube[0]), axes())

    cells = picture.cells.get_array()
    assert cells.shape == (2, 2)


@pytest.mark.exhaustive
def test_many_cells_make_a_small_file_with_the_same_bytes_every_time(tmp_path):
    x = np.linspace(0, 1, 500)
    values = np.hypot(column(x), np.sin(5 * x))
    result = result_of(values)

    file = vector_file(lambda: plot.sweep(result), tmp_path)

    assert file.count(b"<image") == 2  # cells and colour bar
    assert len(file) < 250_000


def test_a_text_in_place_of_the_axes_is_refused_with_the_name_of_its_argument():
    """A quantity given as the second argument of `plot.sweep` is refused: the message
    names ax, and quantity= as the remedy.
    """
    family = ri.sweep(SYSTEMS["few"])

    with pytest.raises(ri.InvalidModel) as refused:
        ri.plot.sweep(family, "duration.0")

    message = (
        "ax: must be an Axes, got 'duration.0'; give the text by name, "
        "quantity='duration.0'"
    )
    assert str(refused.value) == message


def test_a_text_in_place_of_the_axes_is_refused_by_every_figure():
    """`plot.spacetime` and `plot.energy` refuse a text as the second argument, and name
    the remedy.
    """
    solution = ri.solve(SYSTEMS["few"][0])

    with pytest.raises(ri.InvalidModel, match="field='stress'"):
        ri.plot.spacetime(solution, "stress")
    with pytest.raises(ri.InvalidModel, match="got 'x'; leave it out"):
        ri.plot.energy(solution, "x")
