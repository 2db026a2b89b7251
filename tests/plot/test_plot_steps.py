"""Figures of solutions with smooth waves: cells, masses, ends, losses; true, and small in files."""

import itertools

import numpy as np
import pytest
from drawing import STEEL, axes, legend, render, rod, top_of, vector_file
from exhaustive import few_of
from matplotlib.collections import QuadMesh

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.moments import moments

PULSE = ri.Steps([2e3, 0.0], at=[1e-4])
RAMP = ri.Samples([1.0, 0.5], step=3e-4)
ROWS = {
    "hertz": (
        ri.System(
            [rod(0.2, 5.0), rod(0.6), ri.RigidMass(0.05), rod(0.4)],
            contacts=[ri.Hertz(5e9), ri.Spring(1e8), ri.Bonded()],
            ends=(ri.Free(), ri.Absorbing()),
        ),
        5e-4,
    ),
    "falling": (ri.System([ri.Wall(), rod()], gaps=[1e-5], gravity=-9.81), 4e-3),
    "hopkinson": (
        ri.System(
            [rod(0.3, 10.0), rod(), rod(0.8)],
            contacts=[ri.Rigid(), ri.Spring(2e8)],
            ends=(ri.Free(), ri.Absorbing()),
        ),
        7e-4,
    ),
    "mass": (
        ri.System(
            [ri.RigidMass(0.3, velocity=2.0), rod(0.5)], ends=(ri.Free(), ri.Fixed())
        ),
        1e-3,
    ),
    "pushed": (
        ri.System(
            [rod(0.5), ri.RigidMass(0.2), rod(0.3)],
            gaps=[0.0, 1e-6],
            contacts=[ri.Bonded(), ri.HuntCrossley(1e10, 0.2)],
            ends=(ri.Pushed(PULSE), ri.Fixed()),
        ),
        1e-3,
    ),
    "driven": (ri.System([rod(0.5)], ends=(ri.Moved(RAMP), ri.Absorbing())), 3e-4),
    "stepped": (
        ri.System(
            [
                ri.RigidMass(1.0, velocity=1.0),
                ri.Rod(
                    segments=[
                        ri.Segment(0.3, 1e-4, STEEL),
                        ri.Segment(0.2, 3e-4, ri.materials.aluminium),
                    ]
                ),
            ]
        ),
        4e-4,
    ),
    "masses": (
        ri.System(
            [rod(0.4, 1.0), ri.RigidMass(0.2), ri.RigidMass(0.1)],
            gaps=[0.0, 1e-5],
            contacts=[ri.Rigid(), ri.Rigid(0.5)],
        ),
        3e-4,
    ),
}
USUAL = [("hertz", "velocity"), ("pushed", "stress"), ("stepped", "strain")]


@pytest.fixture(scope="module")
def solved():
    return {
        name: ri.solve(system, until, "characteristics")
        for name, (system, until) in ROWS.items()
    }


def cells(picture):
    """Values [times, places], and corners [times + 1, places + 1, 2]."""
    assert isinstance(picture.regions, QuadMesh)
    corners = np.asarray(picture.regions.get_coordinates())
    return np.ma.asarray(picture.regions.get_array()).reshape(
        corners.shape[0] - 1, corners.shape[1] - 1
    ), corners


# Space-time diagram -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "field"),
    [
        case if case in USUAL else pytest.param(*case, marks=pytest.mark.exhaustive)
        for case in itertools.product(ROWS, ["velocity", "stress", "strain"])
    ],
)
def test_cells_hold_the_mean_of_the_field_over_their_time(solved, name, field):
    solution = solved[name]
    picture = plot.spacetime(
        solution, axes(), field, coordinates="lab", magnification=1.0
    )
    (values, _), scale = cells(picture), picture.colour_bar.ax.get_ylabel()
    factor = {
        "(m/s)": 1,
        "(mm/s)": 1e3,
        "(MPa)": 1e-6,
        "(kPa)": 1e-3,
        "(10⁻⁶)": 1e6,
        "(10⁻³)": 1e3,
        "(10⁻⁹)": 1e9,
    }[scale[scale.rindex("(") :]]
    edges = np.linspace(0, solution.t_end, values.shape[0] + 1)
    rods = [i for i, b in enumerate(solution.system.bodies) if isinstance(b, ri.Rod)]
    between = np.flatnonzero(np.ma.getmaskarray(values)[0])
    assert between.size == len(rods) - 1
    starts, stops = [0, *(between + 1)], [*between, values.shape[1]]
    largest = np.abs(values).max()
    for body, start, stop in zip(rods, starts, stops, strict=True):
        length = float(solution.system.bodies[body].length)
        if name == "stepped":  # pieces as long as they can be without crossing the step
            x = np.concatenate(
                (
                    0.3 * (np.arange(180) + 0.5) / 180,
                    0.3 + 0.2 * (np.arange(120) + 0.5) / 120,
                )
            )
        else:
            x = length * (np.arange(stop - start) + 0.5) / (stop - start)
        assert x.size == stop - start
        for row in (0, 57, values.shape[0] - 1):
            t = edges[row] + (np.arange(400) + 0.5) / 400 * (
                edges[row + 1] - edges[row]
            )
            where, when = np.broadcast_arrays(x[:, None], t)
            mean = getattr(solution, field)(body, where, when).mean(axis=1) * factor
            assert np.asarray(values[row, start:stop]) == pytest.approx(
                mean, abs=0.005 * largest
            )


def test_masses_are_strips_of_the_width_that_the_label_names(solved):
    picture = plot.spacetime(
        solved["hertz"], axes(), coordinates="lab", magnification=1.0
    )
    (strip,) = picture.masses
    label = picture.ax.get_xlabel()
    assert label == "place x (m), masses drawn 0.05 m wide, true to scale"
    path = strip.get_xy()[:-1]
    left, right = np.split(path, 2)
    assert right[::-1, 0] - left[:, 0] == pytest.approx(0.05)
    t = left[:, 1] * 1e-6
    assert left[:, 0] == pytest.approx(solved["hertz"].position(2, 0.0, t), abs=1e-9)
    ends = picture.ends.get_segments()
    assert ends[4][:, 0] == pytest.approx(
        right[::-1, 0]
    )  # the rod bonded to its right side
    assert plot.spacetime(solved["hopkinson"], axes()).masses == []


def test_borders_are_told_in_the_legend(solved):
    for name, told in {
        "hertz": ["pressing", "apart", "rigid mass", "absorbing end"],
        "hopkinson": ["pressing", "touching", "apart", "absorbing end"],
        "mass": ["pressing", "apart", "rigid mass"],
        "driven": ["driven at a velocity", "absorbing end"],
    }.items():
        assert legend(plot.spacetime(solved[name], axes()).ax) == told
    assert "driven by a force" in legend(plot.spacetime(solved["pushed"], axes()).ax)


def test_a_fixed_end_is_hatched_like_a_wall_by_every_method():
    for method in ("fronts", "characteristics"):
        solution = ri.solve(
            ri.System([rod(0.4, 1.0), rod()], ends=(ri.Free(), ri.Fixed())),
            1e-3,
            method=method,
        )
        (wall,) = plot.spacetime(solution, axes()).walls
        assert wall.get_hatch()
        assert wall.get_xy()[:2, 0] == pytest.approx([1.4, 1.4])
        assert all(wall.get_xy()[2:4, 0] > 1.4)
        blocks = plot.snapshots(solution, axes(), [0.0, 5e-4]).walls
        assert [block.get_x() for block in blocks] == pytest.approx([1.4, 1.4])


def test_an_absorbing_end_is_dashed_and_no_other(solved):
    styles = plot.spacetime(solved["hopkinson"], axes()).ends.get_linestyle()
    assert [dashes is None for _, dashes in styles] == [True] * 5 + [False]


def test_contacts_press_as_long_as_their_episodes(solved):
    solution = solved["hertz"]
    picture = plot.spacetime(solution, axes())
    pressing = (
        sum(np.ptp(path[:, 1]) for path in picture.pressing.get_segments()) * 1e-6
    )
    expected = sum(
        min(e.force_end if e.force_end == e.force_end else np.inf, solution.t_end)
        - e.start
        for c in solution.contacts
        for e in c.episodes
    )
    assert pressing == pytest.approx(expected, rel=1e-6)


def test_an_interval(solved):
    picture = plot.spacetime(solved["mass"], axes(), start=1e-4, stop=2e-4)
    _, corners = cells(picture)
    assert corners[[0, -1], 0, 1] == pytest.approx([100, 200])


def test_cells_stay_pixels_so_that_vector_files_are_small(solved, tmp_path):
    file = vector_file(lambda: plot.spacetime(solved["hertz"]), tmp_path)
    assert file.count(b"<image") == 2  # cells and colour bar
    assert len(file) < 500_000


# Snapshots --------------------------------------------------------------------------------------


def test_moments_hold_what_happens_at_the_contacts(solved):
    solution = solved["hopkinson"]
    turns = {t for c in solution.contacts for e in c.episodes for t in e if t == t}
    assert turns <= set(moments(solution).tolist())


def test_pieces_have_the_velocity_and_outline_of_the_rods(solved):
    solution = solved["hopkinson"]
    t = 2.5e-4
    picture = plot.snapshots(solution, axes(), [t], magnification=1.0)
    boxes = [path.get_extents() for path in picture.bars.get_paths()]
    assert 250 < len(boxes) < 350
    count = round(300 * 0.3 / 2.1)
    x = 0.3 * (np.arange(count) + 0.5) / count
    drawn = np.asarray(picture.bars.get_array())[:count]
    assert drawn == pytest.approx(solution.velocity(0, x, t))
    assert boxes[0].x0 == pytest.approx(float(solution.position(0, 0.0, t)))
    assert boxes[-1].x1 == pytest.approx(float(solution.position(2, 0.8, t)))
    assert len(picture.outlines.get_segments()) == 3
    assert picture.colour_bar.ax.get_xlabel() == "velocity (m/s)"


def test_labels_of_neighbouring_masses_do_not_meet(solved):
    picture = plot.snapshots(solved["masses"], axes(), [0.0])
    assert [text.get_position()[1] for text in picture.labels[-2:]] == [-0.36, 0.36]


# Histories --------------------------------------------------------------------------------------


def test_overlap_is_named_where_there_is_some(solved):
    drawn = plot.contact(solved["hertz"])
    assert "below 0\noverlap" in drawn.gap_ax.get_ylabel()
    assert min(drawn.gaps[0].get_ydata()) < drawn.gap_ax.get_ylim()[1]
    assert drawn.gap_ax.get_ylim()[0] < min(drawn.gaps[0].get_ydata()) < 0
    assert plot.contact(solved["hopkinson"]).gap_ax.get_ylabel().startswith("gap (")


def test_a_joint_is_stretched_and_drawn_between_its_faces():
    row = ri.System(
        [rod(0.4, 1.0), rod(0.3), rod(0.5)], contacts=[ri.Rigid(), ri.Joint(1e8, 1e3)]
    )
    s = ri.solve(row, 0.4e-3)
    assert plot.contact(s, contact=1).gap_ax.get_ylabel().startswith("stretch (")
    label = plot.contact(s, contact=[0, 1]).gap_ax.get_ylabel()
    assert label.startswith("gap,\nor stretch (")
    picture = plot.spacetime(s, coordinates="lab")
    strip = next(p for p in picture.ax.patches if p.get_label() == "joint")
    x, t = strip.get_xy().T
    n = len(x) // 2
    wide = x[2 * n - 1 : n - 1 : -1] - x[:n]
    stretch = s.contacts[1].gap(np.minimum(t[:n] * 1e-6, s.t_end))
    magnified = (wide - wide[0]) @ stretch / (stretch @ stretch)
    assert magnified > 1
    assert wide - wide[0] == pytest.approx(magnified * stretch, abs=1e-9)
    assert wide.min() > 0
    pressing = np.concatenate(picture.pressing.get_segments())
    assert pressing[:, 0].max() < (x[:n] + wide / 2).min()
    line = next(p for p in plot.spacetime(s).ax.patches if p.get_label() == "joint")
    assert np.ptp(line.get_xy()[:, 0]) == pytest.approx(
        0.0, abs=1e-12
    )  # seen by its edge alone
    assert line.get_linewidth() > 0.5
    zigzags = [each for each in plot.snapshots(s).ax.lines if len(each.get_xdata()) > 9]
    widths = [np.ptp(each.get_xdata()) for each in zigzags]
    assert min(widths) < widths[0] < max(widths)  # pressed together, and drawn out


def test_the_force_of_an_impact_is_named_a_mean(solved):
    label = plot.contact(solved["masses"], contact=1).force_ax.get_ylabel()
    assert "mean over" in label
    assert "ns" in label
    assert "mean" not in plot.contact(solved["masses"]).force_ax.get_ylabel()


# Energy -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", few_of(ROWS, {"falling", "pushed"}))
def test_bands_reach_the_initial_energy_and_the_works(solved, name):
    solution = solved[name]
    drawn = plot.energy(solution, axes())
    assert (drawn.work is not None) == (name in ("falling", "pushed", "driven"))
    tops = top_of(drawn.bands[-1])
    if drawn.work is None:
        assert list(tops.values()) == pytest.approx(
            [max(tops.values())] * len(tops), rel=1e-6
        )
        return
    supplied = dict(zip(*drawn.work.get_data(), strict=True))
    largest = max(supplied.values())
    for x, y in supplied.items():
        assert tops[x] == pytest.approx(y, abs=1e-6 * largest)


# Page, command line -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", few_of(ROWS, {"masses"}))
def test_every_picture_renders(solved, name):
    solution = solved[name]
    render(plot.overview(solution))
    render(plot.snapshots(solution).ax.figure)


@pytest.mark.parametrize("coordinates", ["body", "lab"])
def test_a_mass_in_front_leaves_the_pile_where_it_is(coordinates):
    concrete = ri.Material("concrete", youngs_modulus=30e9, density=2400)
    pile = ri.Rod(18.0, area=0.06, material=concrete)
    hammer = ri.RigidMass(500.0, velocity=3.0)
    solution = ri.solve(ri.System([hammer, pile]), 0.02, "characteristics")
    picture = plot.spacetime(
        solution, coordinates=coordinates, magnification=None, start=0.0
    )
    start = [path[0, 0] for path in picture.ends.get_segments()]
    assert start == pytest.approx([0.0, 18.0], abs=1e-9)
    if coordinates == "body":
        assert picture.ax.get_xticks().tolist() == pytest.approx([0.0, 18.0])
        assert [t.get_text() for t in picture.ax.get_xticklabels()] == ["0", "18"]


def test_ticks_beyond_a_mass_are_material_coordinates(solved):
    picture = plot.spacetime(solved["pushed"])
    assert [t.get_text() for t in picture.ax.get_xticklabels()] == ["0", "0.5", "0.8"]
    assert "masses drawn" in picture.ax.get_xlabel().replace("\n", " ")
