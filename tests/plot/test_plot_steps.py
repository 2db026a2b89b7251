"""Figures of solutions with smooth waves: cells, masses, ends and losses, in small
files.
"""

import itertools
import math

import numpy as np
import pytest
from drawing import STEEL, axes, legend, render, rod, texts_of, top_of
from exhaustive import few_of
from matplotlib.collections import QuadMesh

import rodimpact as ri
from rodimpact import plot
from rodimpact.plot.moments import contact_event_times, moments

MICROSECONDS = 1e6  # in a second


def hertz():
    """Two rods with a Hertz contact, a spring, and a mass bonded to an endless rod."""
    bodies = [rod(0.2, 5.0), rod(0.6), ri.RigidMass(0.05), rod(0.4)]
    contacts = [ri.Hertz(5e9), ri.Spring(1e8), ri.Bonded()]
    return ri.System(bodies, contacts=contacts, ends=(ri.Free(), ri.Absorbing()))


def hopkinson():
    """A striker and two bars with a spring between them, of which one is endless."""
    bodies = [rod(0.3, 10.0), rod(), rod(0.8)]
    contacts = [ri.Rigid(), ri.Spring(2e8)]
    return ri.System(bodies, contacts=contacts, ends=(ri.Free(), ri.Absorbing()))


def mass_on_fixed_rod():
    """A mass that strikes a rod whose far end is held."""
    bodies = [ri.RigidMass(0.3, velocity=2.0), rod(0.5)]
    return ri.System(bodies, ends=(ri.Free(), ri.Fixed()))


def pushed():
    """A rod pushed for 0.1 ms, with a mass bonded to it, and a rod that is held."""
    pulse = ri.Steps([2e3, 0.0], at=[1e-4])
    return ri.System(
        [rod(0.5), ri.RigidMass(0.2), rod(0.3)],
        gaps=[0.0, 1e-6],
        contacts=[ri.Bonded(), ri.HuntCrossley(1e10, 0.2)],
        ends=(ri.Pushed(pulse), ri.Fixed()),
    )


def driven():
    """A rod whose left end is moved, and whose right end absorbs all waves."""
    ramp = ri.Samples([1.0, 0.5], step=3e-4)
    return ri.System([rod(0.5)], ends=(ri.Moved(ramp), ri.Absorbing()))


def mass_on_stepped_rod():
    """A mass that strikes a rod of two segments."""
    thin = ri.Segment(0.3, 1e-4, STEEL)
    thick = ri.Segment(0.2, 3e-4, ri.materials.aluminium)
    stepped = ri.Rod(segments=[thin, thick])
    return ri.System([ri.RigidMass(1.0, velocity=1.0), stepped])


def rod_and_masses():
    """A rod that strikes two masses."""
    bodies = [rod(0.4, 1.0), ri.RigidMass(0.2), ri.RigidMass(0.1)]
    contacts = [ri.Rigid(), ri.Rigid(0.5)]
    return ri.System(bodies, gaps=[0.0, 1e-5], contacts=contacts)


SYSTEMS = {
    "hertz": hertz(),
    "falling": ri.System([ri.Wall(), rod()], gaps=[1e-5], gravity=-9.81),
    "hopkinson": hopkinson(),
    "mass": mass_on_fixed_rod(),
    "pushed": pushed(),
    "driven": driven(),
    "stepped": mass_on_stepped_rod(),
    "masses": rod_and_masses(),
}
ENDS = {  # s
    "hertz": 5e-4,
    "falling": 4e-3,
    "hopkinson": 7e-4,
    "mass": 1e-3,
    "pushed": 1e-3,
    "driven": 3e-4,
    "stepped": 4e-4,
    "masses": 3e-4,
}


@pytest.fixture(scope="module")
def solved():
    """{name: solution} of `SYSTEMS`, by characteristics."""
    solutions = {}
    for name, system in SYSTEMS.items():
        solutions[name] = ri.solve(system, ENDS[name], "characteristics")
    return solutions


def cell_corners(picture):
    """Corners of the cells, [times + 1, places + 1, 2]."""
    assert isinstance(picture.regions, QuadMesh)
    return np.asarray(picture.regions.get_coordinates())


def cell_values(picture):
    """Values of the cells, [times, places], masked between rods."""
    rows, columns, _ = cell_corners(picture).shape
    values = np.ma.asarray(picture.regions.get_array())
    return values.reshape(rows - 1, columns - 1)


def unit_factor(label):
    """Values that are shown, for each SI unit of the value."""
    factors = {
        "m/s": 1,
        "mm/s": 1e3,
        "MPa": 1e-6,
        "kPa": 1e-3,
        "10⁻⁶": 1e6,
        "10⁻³": 1e3,
        "10⁻⁹": 1e9,
    }
    unit = label[label.rindex("(") + 1 : -1]
    return factors[unit]


def middles(length, count):
    """Middles of equal parts of a length."""
    return length * (np.arange(count) + 0.5) / count


def indices_of_rods(system):
    return [i for i, body in enumerate(system.bodies) if isinstance(body, ri.Rod)]


def places_of_cells(name, length, count):
    """Middles of the cells of a rod, which do not cross a step of its section."""
    if name == "stepped":
        return np.concatenate((middles(0.3, 180), 0.3 + middles(0.2, 120)))
    return middles(length, count)


# Space-time diagram


FIELDS = ["velocity", "stress", "strain"]
CASES = list(itertools.product(SYSTEMS, FIELDS))
USUAL = [("stepped", "strain")]


@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_cells_hold_the_mean_of_the_field_over_their_time(solved, case):
    name, field = case
    solution = solved[name]
    bodies = solution.system.bodies
    compute = getattr(solution, field)

    picture = plot.spacetime(
        solution, axes(), field, coordinates="lab", magnification=1.0
    )

    values = cell_values(picture)
    factor = unit_factor(picture.colour_bar.ax.get_ylabel())
    steps, columns = values.shape
    edges = np.linspace(0, solution.t_end, steps + 1)
    rods = indices_of_rods(solution.system)
    (between,) = np.nonzero(np.ma.getmaskarray(values)[0])
    starts = [0, *(between + 1)]
    stops = [*between, columns]
    tolerance = 0.005 * np.abs(values).max()
    for body, start, stop in zip(rods, starts, stops, strict=True):
        length = float(bodies[body].length)
        x = places_of_cells(name, length, stop - start)
        assert x.size == stop - start
        for step in (0, 57, steps - 1):
            duration = edges[step + 1] - edges[step]
            t = edges[step] + middles(duration, 400)
            mean = compute(body, x[:, None], t).mean(axis=1) * factor
            drawn = np.asarray(values[step, start:stop])
            assert drawn == pytest.approx(mean, abs=tolerance)


@pytest.mark.exhaustive
def test_masses_are_strips_of_the_width_that_the_label_names(solved):
    solution = solved["hertz"]

    picture = plot.spacetime(solution, axes(), coordinates="lab", magnification=1.0)

    (strip,) = picture.masses
    left, right = np.split(strip.get_xy()[:-1], 2)
    right_x = right[::-1, 0]
    t = left[:, 1] / MICROSECONDS
    label = "place x (m), masses drawn 0.05 m wide, true to scale"
    bonded_end = picture.ends.get_segments()[4]  # of the rod bonded to its right side
    assert picture.ax.get_xlabel() == label
    assert right_x - left[:, 0] == pytest.approx(0.05)
    assert left[:, 0] == pytest.approx(solution.position(2, 0.0, t), abs=1e-9)
    assert bonded_end[:, 0] == pytest.approx(right_x)


@pytest.mark.exhaustive
def test_rows_without_masses_have_no_strips(solved):
    assert plot.spacetime(solved["hopkinson"], axes()).masses == []


BORDERS = {
    "hertz": ["pressing", "apart", "rigid mass", "absorbing end"],
    "hopkinson": ["pressing", "touching", "apart", "absorbing end"],
    "mass": ["pressing", "apart", "rigid mass"],
    "driven": ["driven at a velocity", "absorbing end"],
}


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", few_of(BORDERS, {"hopkinson", "driven"}))
def test_borders_are_named_in_the_legend(solved, name):
    picture = plot.spacetime(solved[name], axes())

    assert legend(picture) == BORDERS[name]


@pytest.mark.exhaustive
def test_an_end_driven_by_a_force_is_named_in_the_legend(solved):
    picture = plot.spacetime(solved["pushed"], axes())

    assert "driven by a force" in legend(picture)


@pytest.mark.parametrize(
    "method", few_of(["fronts", "characteristics"], ["characteristics"])
)
def test_a_fixed_end_is_hatched_like_a_wall(method):
    ends = (ri.Free(), ri.Fixed())
    system = ri.System([rod(0.4, 1.0), rod()], ends=ends)
    solution = ri.solve(system, 1e-3, method=method)

    picture = plot.spacetime(solution, axes())
    snapshots = plot.snapshots(solution, axes(), [0.0, 5e-4])

    (wall,) = picture.walls
    outline = wall.get_xy()
    blocks = [block.get_x() for block in snapshots.walls]
    assert wall.get_hatch()
    assert outline[:2, 0] == pytest.approx([1.4, 1.4])
    assert all(outline[2:4, 0] > 1.4)
    assert blocks == pytest.approx([1.4, 1.4])


def test_an_absorbing_end_is_dashed_and_no_other(solved):
    picture = plot.spacetime(solved["hopkinson"], axes())

    dashes = [dash for _, dash in picture.ends.get_linestyle()]
    *others, last = dashes
    assert others == [None] * 5
    assert last is not None


def test_contacts_press_as_long_as_their_episodes(solved):
    solution = solved["hertz"]
    expected = 0.0
    for contact in solution.contacts:
        for episode in contact.episodes:
            end = episode.force_end
            if math.isnan(end):  # it still presses
                end = solution.t_end
            expected += min(end, solution.t_end) - episode.start

    picture = plot.spacetime(solution, axes())

    durations = [np.ptp(path[:, 1]) for path in picture.pressing.get_segments()]
    assert sum(durations) / MICROSECONDS == pytest.approx(expected, rel=1e-6)


def test_a_diagram_from_start_to_stop_shows_that_interval(solved):
    picture = plot.spacetime(solved["mass"], axes(), start=1e-4, stop=2e-4)

    times = cell_corners(picture)[:, 0, 1]
    assert times[0] == pytest.approx(100)
    assert times[-1] == pytest.approx(200)


@pytest.mark.exhaustive
def test_cells_stay_pixels_so_that_vector_files_are_small(solved, tmp_path):
    plot.save(plot.spacetime(solved["hertz"]).ax.figure, tmp_path / "a.svg")

    file = (tmp_path / "a.svg").read_bytes()
    assert file.count(b"<image") == 2  # cells and colour bar
    assert len(file) < 500_000


# Snapshots


def test_moments_hold_all_events_at_the_contacts(solved):
    solution = solved["hopkinson"]
    events = set()
    for contact in solution.contacts:
        for episode in contact.episodes:
            events.update(time for time in episode if not math.isnan(time))

    assert events <= set(moments(solution).tolist())


@pytest.mark.exhaustive
def test_snapshots_show_the_first_and_last_of_many_events_and_count_the_hidden():
    steel = ri.materials.steel
    rods = []
    for length in (0.2, 0.3, 0.5):
        rods.append(ri.Rod(length, area=1e-4, material=steel, velocity=1.0))
    solution = ri.solve(ri.System([*rods, ri.Wall()], gaps=[1e-5, 1e-5, 1e-5]))
    events = set(contact_event_times(solution))

    picture = plot.snapshots(solution)

    shown = set(picture.times.tolist())
    assert picture.times.size == 8
    assert {min(events), max(events)} <= shown
    caption = picture.ax.get_xlabel()
    assert f"times of events at contacts not shown: {len(events - shown)}" in caption
    chosen = plot.snapshots(solution, times=[0.0, 1e-4])
    assert "not shown" not in chosen.ax.get_xlabel()


def test_pieces_have_the_velocity_and_outline_of_the_rods(solved):
    solution = solved["hopkinson"]
    t = 2.5e-4

    picture = plot.snapshots(solution, axes(), [t], magnification=1.0)

    boxes = [path.get_extents() for path in picture.bars.get_paths()]
    pieces = round(300 * 0.3 / 2.1)  # of the striker, 0.3 m of 2.1 m in all
    drawn = np.asarray(picture.bars.get_array())[:pieces]
    velocity = solution.velocity(0, middles(0.3, pieces), t)
    left = float(solution.position(0, 0.0, t))
    right = float(solution.position(2, 0.8, t))
    assert 250 < len(boxes) < 350
    assert drawn == pytest.approx(velocity)
    assert boxes[0].x0 == pytest.approx(left)
    assert boxes[-1].x1 == pytest.approx(right)
    assert len(picture.outlines.get_segments()) == 3
    assert picture.colour_bar.ax.get_xlabel() == "velocity (m/s)"


def test_labels_of_neighbouring_masses_do_not_meet(solved):
    picture = plot.snapshots(solved["masses"], axes(), [0.0])

    heights = [label.get_position()[1] for label in picture.labels[-2:]]
    assert heights == [-0.36, 0.36]


# Histories


@pytest.mark.exhaustive
def test_overlap_is_named_where_there_is_some(solved):
    drawn = plot.contact(solved["hertz"])

    low, high = drawn.gap_ax.get_ylim()
    least_gap = min(drawn.gaps[0].get_ydata())
    assert "below 0\noverlap" in drawn.gap_ax.get_ylabel()
    assert low < least_gap < min(0, high)


def test_a_gap_without_overlap_is_a_gap(solved):
    drawn = plot.contact(solved["hopkinson"], contact=0)

    assert drawn.gap_ax.get_ylabel().startswith("gap (")


@pytest.fixture(scope="module")
def joined():
    """Three rods, of which the last two are joined by a spring and a dashpot."""
    rods = [rod(0.4, 1.0), rod(0.3), rod(0.5)]
    row = ri.System(rods, contacts=[ri.Rigid(), ri.Joint(1e8, 1e3)])
    return ri.solve(row, 0.4e-3)


@pytest.fixture(scope="module")
def joined_picture(joined):
    return plot.spacetime(joined, axes(), coordinates="lab")


def joint_patch(picture):
    (patch,) = [patch for patch in picture.ax.patches if patch.get_label() == "joint"]
    return patch


def test_the_gap_of_a_joint_is_its_stretch(joined):
    joint = plot.contact(joined, contact=1)
    assert joint.force_ax.get_ylabel().startswith("force at contact 2-3")
    both = plot.contact(joined, contact=[0, 1])

    assert joint.gap_ax.get_ylabel().startswith("stretch (")
    assert both.gap_ax.get_ylabel().startswith("gap,\nor stretch (")


def test_a_joint_is_drawn_between_its_faces(joined, joined_picture):
    # The outline goes along the left face in time, and back along the right one.
    x, t = joint_patch(joined_picture).get_xy().T
    n = len(x) // 2
    left = x[:n]
    right = x[n : 2 * n][::-1]
    width = right - left
    growth = width - width[0]
    times = np.minimum(t[:n] / MICROSECONDS, joined.t_end)
    stretch = joined.contacts[1].gap(times)
    magnification = growth @ stretch / (stretch @ stretch)  # least squares
    assert magnification > 1
    assert growth == pytest.approx(magnification * stretch, abs=1e-9)
    assert width.min() > 0


def test_a_joint_is_not_drawn_as_pressing(joined_picture):
    x_of_joint = joint_patch(joined_picture).get_xy()[:, 0]
    pressing = np.concatenate(joined_picture.pressing.get_segments())  # [point, (x, t)]
    assert pressing[:, 0].max() < x_of_joint.min()


@pytest.mark.exhaustive
def test_a_joint_is_a_line_in_places_of_the_bodies(joined):
    line = joint_patch(plot.spacetime(joined))

    assert np.ptp(line.get_xy()[:, 0]) == pytest.approx(0.0, abs=1e-12)
    assert line.get_linewidth() > 0.5


@pytest.mark.exhaustive
def test_a_joint_is_pressed_together_and_drawn_out_in_snapshots(joined):
    lines = plot.snapshots(joined).ax.lines

    # A joint is a zigzag of many points, one in each snapshot.
    widths = []
    for line in lines:
        x = line.get_xdata()
        if len(x) > 9:
            widths.append(np.ptp(x))
    width_at_rest = widths[0]
    assert min(widths) < width_at_rest < max(widths)


def test_all_contacts_are_drawn_and_named(joined):
    drawn = plot.contact(joined)

    names = [text.get_text() for text in drawn.force_ax.get_legend().get_texts()]
    assert names == ["contact 1-2", "contact 2-3"]
    assert drawn.force_ax.get_ylabel().startswith("contact force (")
    assert len(drawn.forces) == len(drawn.gaps) == 2


def test_of_many_contacts_those_of_the_largest_forces_are_drawn():
    small = rod(0.1)
    row = ri.System([rod(0.1, 1.0), *[small] * 12, ri.Wall()])
    solution = ri.solve(row, until=6e-5)  # the wave has not reached the last contacts

    drawn = plot.contact(solution)

    names = [force.get_label() for force in drawn.forces]
    assert names == [f"contact {k}-{k + 1}" for k in range(1, 13)]
    assert drawn.force_ax.get_title(loc="left") == "12 of 13 contacts"


def test_the_force_of_an_impact_is_named_a_mean(solved):
    impact = plot.contact(solved["masses"], contact=1).force_ax
    pressing = plot.contact(solved["masses"], contact=0).force_ax

    label = impact.get_ylabel()
    assert "mean over" in label
    assert "ns" in label
    assert "mean" not in pressing.get_ylabel()


# Energy


WITH_WORK = {"falling", "pushed", "driven"}
WITHOUT_WORK = sorted(set(SYSTEMS) - WITH_WORK)


@pytest.mark.parametrize("name", few_of(WITHOUT_WORK, {"hopkinson"}))
def test_bands_reach_the_initial_energy(solved, name):
    drawn = plot.energy(solved[name], axes())

    energies = list(top_of(drawn.bands[-1]).values())
    initial = [max(energies)] * len(energies)
    assert drawn.work is None
    assert energies == pytest.approx(initial, rel=1e-6)


@pytest.mark.parametrize("name", few_of(sorted(WITH_WORK), {"falling"}))
def test_bands_reach_the_initial_energy_and_the_work_from_outside(solved, name):
    drawn = plot.energy(solved[name], axes())

    tops = top_of(drawn.bands[-1])
    times, energies = drawn.work.get_data()
    tolerance = 1e-6 * max(energies)
    for time, energy in zip(times, energies, strict=True):
        assert tops[time] == pytest.approx(energy, abs=tolerance)


# Page


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_picture_renders(solved, name):
    solution = solved[name]

    render(plot.overview(solution))
    render(plot.snapshots(solution))


@pytest.fixture(scope="module")
def driven_pile():
    """The run of a hammer that strikes a pile of concrete."""
    concrete = ri.Material("concrete", youngs_modulus=30e9, density=2400)
    pile = ri.Rod(18.0, area=0.06, material=concrete)
    hammer = ri.RigidMass(500.0, velocity=3.0)
    return ri.solve(ri.System([hammer, pile]), 0.02, "characteristics")


@pytest.mark.parametrize("coordinates", few_of(["body", "lab"], ["lab"]))
def test_a_mass_in_front_leaves_the_pile_at_its_place(driven_pile, coordinates):
    picture = plot.spacetime(driven_pile, axes(), coordinates=coordinates)

    places_of_ends = [path[0, 0] for path in picture.ends.get_segments()]
    assert places_of_ends == pytest.approx([0.0, 18.0], abs=1e-9)


def test_ticks_beside_a_mass_are_material_coordinates(driven_pile):
    ax = plot.spacetime(driven_pile, axes()).ax

    assert ax.get_xticks().tolist() == pytest.approx([0.0, 18.0])
    assert texts_of(ax.get_xticklabels()) == ["0", "18"]


@pytest.mark.exhaustive
def test_ticks_beyond_a_mass_are_material_coordinates(solved):
    ax = plot.spacetime(solved["pushed"]).ax

    assert texts_of(ax.get_xticklabels()) == ["0", "0.5", "0.8"]
    assert "masses drawn" in ax.get_xlabel().replace("\n", " ")
