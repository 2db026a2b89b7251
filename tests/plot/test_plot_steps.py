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
    """Two rods with a Hertz contact, a spring, and a mass bonded to an infinite rod."""
    bodies = [rod(0.2, 5.0), rod(0.6), ri.RigidMass(0.05), rod(0.4)]
    contacts = [ri.Hertz(5e9), ri.Spring(1e8), ri.Bonded()]
    ends = (ri.Free(), ri.Absorbing())
    return ri.System(bodies, contacts=contacts, ends=ends)


def hopkinson():
    """A striker and two bars with a spring between them; the last one is infinite."""
    bodies = [rod(0.3, 10.0), rod(), rod(0.8)]
    contacts = [ri.Rigid(), ri.Spring(2e8)]
    ends = (ri.Free(), ri.Absorbing())
    return ri.System(bodies, contacts=contacts, ends=ends)


def mass_on_fixed_rod():
    """A mass that strikes a rod whose far end is held."""
    mass = ri.RigidMass(0.3, velocity=2.0)
    ends = (ri.Free(), ri.Fixed())
    return ri.System([mass, rod(0.5)], ends=ends)


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
    mass = ri.RigidMass(1.0, velocity=1.0)
    return ri.System([mass, stepped])


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
    """Corners of the cells, [times + 1, positions + 1, (x, t)]."""
    assert isinstance(picture.regions, QuadMesh)
    return np.asarray(picture.regions.get_coordinates())


def cell_values(picture):
    """Values of the cells, [times, positions], masked between rods."""
    rows, columns, _ = cell_corners(picture).shape
    values = np.ma.asarray(picture.regions.get_array())
    return values.reshape(rows - 1, columns - 1)


def unit_factor(label):
    """Factor from SI units to the unit in parentheses at the end of a label."""
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
    """Middles of `count` equal parts of a length."""
    return length * (np.arange(count) + 0.5) / count


def indices_of_rods(system):
    """Indices of the rods among the bodies of a system."""
    indices = []
    for i, body in enumerate(system.bodies):
        if isinstance(body, ri.Rod):
            indices.append(i)
    return indices


def positions_of_cells(name, length, count):
    """Middles of the `count` cells of a rod, which do not cross a step of its section.

    The stepped rod has 300 cells in segments of 0.3 m and 0.2 m.
    """
    if name == "stepped":
        in_thin_segment = middles(0.3, 180)
        in_thick_segment = 0.3 + middles(0.2, 120)
        return np.concatenate((in_thin_segment, in_thick_segment))
    return middles(length, count)


# Space-time diagram


FIELDS = ["velocity", "stress", "strain"]
CASES = list(itertools.product(SYSTEMS, FIELDS))
USUAL = [("stepped", "strain")]


@pytest.mark.exhaustive
@pytest.mark.parametrize("case", few_of(CASES, USUAL))
def test_cells_hold_the_mean_of_the_field_over_their_time(solved, case):
    """The mean is that of 400 samples of the solution in the middle of each cell."""
    name, field = case
    solution = solved[name]
    bodies = solution.system.bodies
    field_at = getattr(solution, field)

    picture = plot.spacetime(
        solution, axes(), field, coordinates="lab", magnification=1.0
    )

    label = picture.colour_bar.ax.get_ylabel()
    factor = unit_factor(label)
    values = cell_values(picture)
    steps, columns = values.shape
    edges = np.linspace(0, solution.t_end, steps + 1)  # of the cells in time
    rods = indices_of_rods(solution.system)
    # One masked column stands between neighbouring rods.
    (between_rods,) = np.nonzero(np.ma.getmaskarray(values)[0])
    starts = [0, *(between_rods + 1)]
    stops = [*between_rods, columns]
    tolerance = 0.005 * np.abs(values).max()
    for body, start, stop in zip(rods, starts, stops, strict=True):
        length = float(bodies[body].length)
        x = positions_of_cells(name, length, stop - start)
        assert x.size == stop - start
        for step in (0, 57, steps - 1):  # the first, any, and the last one
            begin = edges[step]
            duration = edges[step + 1] - begin
            t = begin + middles(duration, 400)
            samples = field_at(body, x[:, np.newaxis], t)  # [position, time]
            mean = samples.mean(axis=1) * factor
            drawn = np.asarray(values[step, start:stop])
            assert drawn == pytest.approx(mean, abs=tolerance)


@pytest.mark.exhaustive
def test_masses_are_strips_of_the_width_that_the_label_names(solved):
    """A mass in a diagram is a strip 0.05 m wide, as the label says; its left side
    follows the position of the mass, and the next rod begins at its right side.
    """
    solution = solved["hertz"]

    picture = plot.spacetime(solution, axes(), coordinates="lab", magnification=1.0)

    label = "place x (m), masses drawn 0.05 m wide, true to scale"
    assert picture.ax.get_xlabel() == label
    (strip,) = picture.masses
    # Up the left side in time, down the right side, and closed by the first point
    left_side, right_side = np.split(strip.get_xy()[:-1], 2)
    left_x, t = left_side.T
    right_x = right_side[::-1, 0]
    assert right_x - left_x == pytest.approx(0.05)
    position = solution.position(2, 0.0, t / MICROSECONDS)
    assert left_x == pytest.approx(position, abs=1e-9)
    # The left end of the third rod, which is bonded to the right side
    bonded_end = picture.ends.get_segments()[4]
    bonded_x = bonded_end[:, 0]
    assert bonded_x == pytest.approx(right_x)


@pytest.mark.exhaustive
def test_rows_without_masses_have_no_strips(solved):
    picture = plot.spacetime(solved["hopkinson"], axes())

    assert picture.masses == []


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
    """A row with a fixed right end has one hatched wall beyond 1.4 m in the diagram,
    and one in each snapshot.
    """
    ends = (ri.Free(), ri.Fixed())
    system = ri.System([rod(0.4, 1.0), rod()], ends=ends)
    solution = ri.solve(system, 1e-3, method=method)

    picture = plot.spacetime(solution, axes())
    snapshots = plot.snapshots(solution, axes(), [0.0, 5e-4])

    (wall,) = picture.walls
    assert wall.get_hatch()
    corners_x = wall.get_xy()[:, 0]
    face = corners_x[:2]  # at the start and the end of the run
    back = corners_x[2:4]
    assert face == pytest.approx([1.4, 1.4])
    assert all(back > 1.4)
    faces_of_snapshots = [block.get_x() for block in snapshots.walls]
    assert faces_of_snapshots == pytest.approx([1.4, 1.4])


@pytest.mark.exhaustive
def test_an_absorbing_end_is_dashed_and_no_other(solved):
    """Of six lines of ends in a diagram, only the last one, absorbing, is dashed."""
    picture = plot.spacetime(solved["hopkinson"], axes())

    styles = picture.ends.get_linestyle()  # (offset, dashes) of each of six ends
    *other_dashes, last_dashes = [dashes for _, dashes in styles]
    assert other_dashes == [None] * 5
    assert last_dashes is not None


@pytest.mark.exhaustive
def test_contacts_press_as_long_as_their_episodes(solved):
    """Lines of pressing last as long as the force of all episodes, in sum."""
    solution = solved["hertz"]
    expected = 0.0  # s, duration of all episodes
    for contact in solution.contacts:
        for episode in contact.episodes:
            end = episode.force_end
            if math.isnan(end):  # it still presses
                end = solution.t_end
            end = min(end, solution.t_end)
            expected += end - episode.start

    picture = plot.spacetime(solution, axes())

    lines = picture.pressing.get_segments()
    durations = [np.ptp(line[:, 1]) for line in lines]
    drawn_duration = sum(durations) / MICROSECONDS
    assert drawn_duration == pytest.approx(expected, rel=1e-6)


def test_a_diagram_from_start_to_stop_shows_that_interval(solved):
    picture = plot.spacetime(solved["mass"], axes(), start=1e-4, stop=2e-4)

    times = cell_corners(picture)[:, 0, 1]
    assert times[0] == pytest.approx(100)  # us
    assert times[-1] == pytest.approx(200)


@pytest.mark.exhaustive
def test_cells_stay_pixels_so_that_vector_files_are_small(solved, tmp_path):
    """An SVG file of a space-time diagram with cells has two images, and less than 500
    kB.
    """
    path = tmp_path / "a.svg"
    figure = plot.spacetime(solved["hertz"]).ax.figure

    plot.save(figure, path)

    file = path.read_bytes()
    assert file.count(b"<image") == 2  # cells and colour bar
    assert len(file) < 500_000


# Snapshots


def test_moments_hold_all_events_at_the_contacts(solved):
    """The `moments` of a bar test contain all finite times of its episodes."""
    solution = solved["hopkinson"]
    events = set()
    for contact in solution.contacts:
        for episode in contact.episodes:
            for time in episode:
                if not math.isnan(time):  # it has not come about
                    events.add(time)

    times = set(moments(solution).tolist())

    assert events <= times


@pytest.mark.exhaustive
def test_snapshots_show_the_first_and_last_of_many_events_and_count_the_hidden():
    """Snapshots of a row with many events show eight times, with the first and last
    event, and the caption counts the others; at chosen times it counts none.
    """
    steel = ri.materials.steel
    rods = []
    for length in (0.2, 0.3, 0.5):
        rods.append(ri.Rod(length, area=1e-4, material=steel, velocity=1.0))
    system = ri.System([*rods, ri.Wall()], gaps=[1e-5, 1e-5, 1e-5])
    solution = ri.solve(system)
    events = set(contact_event_times(solution))

    picture = plot.snapshots(solution)
    at_chosen_times = plot.snapshots(solution, times=[0.0, 1e-4])

    shown = set(picture.times.tolist())
    assert len(shown) == picture.times.size == 8
    assert min(events) in shown
    assert max(events) in shown
    n_hidden = len(events - shown)
    caption = picture.ax.get_xlabel()
    assert f"times of events at contacts not shown: {n_hidden}" in caption
    assert "not shown" not in at_chosen_times.ax.get_xlabel()


def test_pieces_have_the_velocity_and_outline_of_the_rods(solved):
    """A snapshot of a bar test has some 300 coloured pieces from the first end to the
    last; those of the striker have its velocity, and each of the three rods an outline.
    """
    solution = solved["hopkinson"]
    t = 2.5e-4

    picture = plot.snapshots(solution, axes(), [t], magnification=1.0)

    boxes = [path.get_extents() for path in picture.bars.get_paths()]
    assert 250 < len(boxes) < 350
    first, *_, last = boxes
    left_end = float(solution.position(0, 0.0, t))
    right_end = float(solution.position(2, 0.8, t))
    assert first.x0 == pytest.approx(left_end)
    assert last.x1 == pytest.approx(right_end)
    n_striker = round(300 * 0.3 / 2.1)  # pieces of 0.3 m of 2.1 m in all
    drawn = np.asarray(picture.bars.get_array())[:n_striker]
    velocity = solution.velocity(0, middles(0.3, n_striker), t)
    assert drawn == pytest.approx(velocity)
    outlines = picture.outlines.get_segments()
    assert len(outlines) == 3
    colour_bar = picture.colour_bar.ax
    assert colour_bar.get_xlabel() == "velocity (m/s)"


def test_labels_of_neighbouring_masses_do_not_meet(solved):
    """The label of the first mass stands below it, that of the second one above."""
    picture = plot.snapshots(solved["masses"], axes(), [0.0])

    _, *labels_of_masses = picture.labels
    heights = [label.get_position()[1] for label in labels_of_masses]
    assert heights == [-0.36, 0.36]


# Histories


@pytest.mark.exhaustive
def test_overlap_is_named_where_there_is_some(solved):
    """The axis of the gap of a Hertz contact names the overlap below 0, and its limits
    hold the least gap.
    """
    drawn = plot.contact(solved["hertz"])

    ax = drawn.gap_ax
    assert "below 0\noverlap" in ax.get_ylabel()
    low, high = ax.get_ylim()
    least_gap = min(drawn.gaps[0].get_ydata())
    assert low < least_gap < min(0, high)


def test_a_gap_without_overlap_is_a_gap(solved):
    drawn = plot.contact(solved["hopkinson"], contact=0)

    label = drawn.gap_ax.get_ylabel()
    assert label.startswith("gap (")


@pytest.fixture(scope="module")
def joined_solution():
    """The solution of three rods; the last two are joined by a spring and a dashpot."""
    rods = [rod(0.4, 1.0), rod(0.3), rod(0.5)]
    row = ri.System(rods, contacts=[ri.Rigid(), ri.Joint(1e8, 1e3)])
    return ri.solve(row, 0.4e-3)


@pytest.fixture(scope="module")
def joined_picture(joined_solution):
    """The space-time diagram of `joined_solution`, with displacements."""
    return plot.spacetime(joined_solution, axes(), coordinates="lab")


def joint_patch(picture):
    """The patch that shows the joint."""
    patches = picture.ax.patches
    (joint,) = [patch for patch in patches if patch.get_label() == "joint"]
    return joint


def test_the_gap_of_a_joint_is_its_stretch(joined_solution):
    """The axis of a joint is labelled stretch; of a contact and a joint together, gap
    or stretch.
    """
    joint = plot.contact(joined_solution, contact=1)
    both = plot.contact(joined_solution, contact=[0, 1])

    force_of_joint = joint.force_ax.get_ylabel()
    gap_of_joint = joint.gap_ax.get_ylabel()
    gap_of_both = both.gap_ax.get_ylabel()
    assert force_of_joint.startswith("force at contact 2-3")
    assert gap_of_joint.startswith("stretch (")
    assert gap_of_both.startswith("gap,\nor stretch (")


def test_a_joint_is_drawn_between_its_faces(joined_solution, joined_picture):
    """The drawn width grows by the stretch of the joint, magnified."""
    # The outline goes along the left face in time, and back along the right one.
    x, t = joint_patch(joined_picture).get_xy().T
    n = len(x) // 2
    left = x[:n]
    right = x[n : 2 * n][::-1]
    width = right - left
    growth = width - width[0]
    times = t[:n] / MICROSECONDS
    times = np.minimum(times, joined_solution.t_end)  # without round-off
    stretch = joined_solution.contacts[1].gap(times)
    magnification = growth @ stretch / (stretch @ stretch)  # least squares
    assert magnification > 1
    assert growth == pytest.approx(magnification * stretch, abs=1e-9)
    assert width.min() > 0


def test_a_joint_is_not_drawn_as_pressing(joined_picture):
    """In a space-time diagram, all lines of pressing contacts are left of the patch of
    the joint.
    """
    joint_x, _ = joint_patch(joined_picture).get_xy().T
    lines = joined_picture.pressing.get_segments()  # each [point, (x, t)]
    pressing_x, _ = np.concatenate(lines).T
    assert pressing_x.max() < joint_x.min()


@pytest.mark.exhaustive
def test_a_joint_is_a_line_in_material_coordinates(joined_solution):
    """Over material coordinates the patch of a joint has an outline, and no width."""
    line = joint_patch(plot.spacetime(joined_solution))

    x, _ = line.get_xy().T
    assert np.ptp(x) == pytest.approx(0.0, abs=1e-12)
    assert line.get_linewidth() > 0.5


@pytest.mark.exhaustive
def test_a_joint_is_pressed_together_and_drawn_out_in_snapshots(joined_solution):
    """In the snapshots, the zigzag of a joint is narrower than at the start in one, and
    wider in another.
    """
    lines = plot.snapshots(joined_solution).ax.lines

    # A joint is a zigzag of many points, one in each snapshot.
    widths = []
    for line in lines:
        x = line.get_xdata()
        if len(x) > 9:
            widths.append(np.ptp(x))
    width_at_rest = widths[0]
    assert min(widths) < width_at_rest < max(widths)


def test_all_contacts_are_drawn_and_named(joined_solution):
    drawn = plot.contact(joined_solution)

    ax = drawn.force_ax
    assert legend(ax) == ["contact 1-2", "contact 2-3"]
    assert ax.get_ylabel().startswith("contact force (")
    assert len(drawn.forces) == len(drawn.gaps) == 2


def test_of_many_contacts_those_of_the_largest_forces_are_drawn():
    """Of 13 contacts, the first 12, where the wave has been, are drawn in order, and
    the title says "12 of 13 contacts".
    """
    striker = rod(0.1, 1.0)
    small_rods = [rod(0.1)] * 12
    row = ri.System([striker, *small_rods, ri.Wall()])
    solution = ri.solve(row, until=6e-5)  # the wave has not reached the last contacts

    drawn = plot.contact(solution)

    names = [force.get_label() for force in drawn.forces]
    assert names == [f"contact {k}-{k + 1}" for k in range(1, 13)]
    title = drawn.force_ax.get_title(loc="left")
    assert title == "12 of 13 contacts"


def test_the_force_of_an_impact_is_named_a_mean(solved):
    """The axis of a contact of two masses names the time over which its force is a
    mean; that of a pressing contact does not.
    """
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
    """The upper edge of the highest band is constant: nothing works from outside."""
    drawn = plot.energy(solved[name], axes())

    highest_band = drawn.bands[-1]
    energies = np.array(list(top_of(highest_band).values()))
    constant = np.full(energies.shape, energies.max())
    assert energies == pytest.approx(constant, rel=1e-6)
    assert drawn.work is None


@pytest.mark.parametrize("name", few_of(sorted(WITH_WORK), {"falling"}))
def test_bands_reach_the_initial_energy_and_the_work_from_outside(solved, name):
    """The upper edge of the highest band is at the drawn work at all times."""
    drawn = plot.energy(solved[name], axes())

    highest_band = drawn.bands[-1]
    tops = top_of(highest_band)  # {time: energy}
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
def pile_solution():
    """The run of a hammer that strikes a pile of concrete."""
    concrete = ri.Material("concrete", youngs_modulus=30e9, density=2400)
    pile = ri.Rod(18.0, area=0.06, material=concrete)
    hammer = ri.RigidMass(500.0, velocity=3.0)
    system = ri.System([hammer, pile])
    return ri.solve(system, 0.02, "characteristics")


@pytest.mark.parametrize("coordinates", few_of(["body", "lab"], ["lab"]))
def test_the_pile_begins_at_0_m_behind_a_drawn_mass(pile_solution, coordinates):
    picture = plot.spacetime(pile_solution, axes(), coordinates=coordinates)

    paths = picture.ends.get_segments()  # each [point, (x, t)]
    initial_positions = [path[0, 0] for path in paths]
    assert initial_positions == pytest.approx([0.0, 18.0], abs=1e-9)


def test_ticks_beside_a_mass_are_material_coordinates(pile_solution):
    ax = plot.spacetime(pile_solution, axes()).ax

    ticks = ax.get_xticks().tolist()
    assert ticks == pytest.approx([0.0, 18.0])
    assert texts_of(ax.get_xticklabels()) == ["0", "18"]


@pytest.mark.exhaustive
def test_ticks_beyond_a_mass_are_material_coordinates(solved):
    ax = plot.spacetime(solved["pushed"]).ax

    assert texts_of(ax.get_xticklabels()) == ["0", "0.5", "0.8"]
    label = " ".join(ax.get_xlabel().split())  # without line breaks
    assert "masses drawn" in label
