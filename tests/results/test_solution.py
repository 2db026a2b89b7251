"""Fields, regions, gauges, contacts and outcome of solutions."""

import copy
import math
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from systems import rod

import rodimpact as ri
from rodimpact.materials import aluminium, steel
from rodimpact.methods import kernels
from rodimpact.methods.status import ROUNDED
from rodimpact.results.regions import readable_until, regions_of

C = steel.wave_speed


@pytest.fixture(scope="module")
def box_solution():
    """The solution of a rod of 0.4 m that strikes one of 1 m of the same section at 1
    m/s.

    Its force is the "box" of theory: constant while the wave runs through the striker
    and back.
    """
    striker = rod(length=0.4, velocity=1.0)
    struck = rod(length=1.0)
    return ri.solve(ri.System([striker, struck]))


@pytest.fixture(scope="module")
def mixed_solution():
    """The solution of a moving wall and rods of 0.4, 0.8 and 0.25 m; the rod of 0.8 m
    has two segments and steps of initial velocity and strain.
    """
    thin = ri.Segment(0.3, 1e-4, steel)
    thick = ri.Segment(0.5, 2e-4, aluminium)
    stepped = ri.Rod(
        segments=[thin, thick],
        velocity=ri.Steps([0.2, -0.4], [0.3]),
        strain=ri.Steps([0.0, 1e-5, 0.0], [0.1, 0.6]),
    )
    wall = ri.Wall(0.05)
    thin_rod = rod(0.4, velocity=-1.0)
    thick_rod = rod(0.25, velocity=-2.0, area=3e-4)
    bodies = [wall, thin_rod, stepped, thick_rod]
    gaps = [1e-5, 2e-5, 0.0]
    return ri.solve(ri.System(bodies, gaps), until=1e-3)


def test_lengths_too_far_apart_are_refused():
    short = rod(1e-13, velocity=1.0)
    with pytest.raises(ri.InvalidModel, match=r"bodies.0: its transit time"):
        ri.collide(short, rod(1.0))


def test_the_outcome_of_the_box(box_solution):
    """The striker is at rest afterwards, and the struck rod has e times its velocity."""
    outcome = box_solution.outcome
    e = 0.4  # the ratio of the lengths
    striker_mass, struck_mass = outcome.masses
    energy_before = striker_mass * 1.0**2 / 2
    energy_moving = struck_mass * e**2 / 2
    vibration = energy_before - energy_moving
    vibration_after = sum(outcome.vibration_after)
    assert outcome.velocities_after == pytest.approx((0.0, e), abs=1e-14)
    assert vibration_after == pytest.approx(vibration, rel=1e-13)


def test_the_contact_of_the_box(box_solution):
    """Two unequal rods: the only episode begins at 0, its force ends after the round
    trip of the striker, and the gap opens after that of the struck rod; force and gap
    have their exact values, and at the end of the force `side` chooses.
    """
    force_end = 2 * 0.4 / C  # the wave has run through the striker and back
    opening = 2 * 1.0 / C  # the wave has run through the struck rod and back
    force = steel.density * C * 1e-4 / 2  # rho c A v/2, N
    (contact,) = box_solution.contacts
    (episode,) = contact.episodes
    assert episode == pytest.approx((0.0, force_end, opening), rel=1e-14)
    assert contact.force(force_end / 2) == pytest.approx(force)
    assert contact.force(force_end, side="left") > 0
    assert contact.force(force_end) == 0
    # The end of the struck rod leaves with 1 m/s, and the striker is at rest.
    gap = contact.gap(opening + 1e-6)
    assert gap == pytest.approx(1e-6)


def test_the_box_is_final_at_opening_and_proved_so_as_the_force_ends(box_solution):
    """`t_final` is the opening, `t_proved` the end of the force, and the run ends one
    round trip after the proof.
    """
    force_end = 2 * 0.4 / C  # the wave has run through the striker and back
    round_trip = 2 * 1.0 / C  # in the struck rod; a run goes on for it after its proof
    assert box_solution.final
    assert box_solution.stopped_by == "final"
    assert box_solution.t_final == box_solution.contacts[0].episodes[0].opening
    assert box_solution.t_proved == pytest.approx(force_end)
    assert box_solution.t_end == pytest.approx(force_end + round_trip)


def test_fields_of_the_box(box_solution):
    """When the waves of two equal rods are 0.2 m from the contact, velocities before
    and behind them are 1, 0.5 and 0 m/s; stress and axial force are those of v/2, and
    at the front `side` chooses the value.
    """
    t = 0.2 / C  # the waves are 0.2 m from the contact, at x = 0.2 m of either rod
    x = [0.1, 0.3]
    in_striker = box_solution.velocity(0, x, t)
    in_struck = box_solution.velocity(1, x, t)
    assert in_striker.tolist() == [1.0, 0.5]
    assert in_struck.tolist() == [0.5, 0.0]
    stress = -steel.density * C / 2  # rho c v/2, Pa
    force = box_solution.contacts[0].force(t)
    assert box_solution.stress(1, 0.1, t) == pytest.approx(stress)
    assert box_solution.axial_force(1, 0.1, t) == pytest.approx(-force)
    before_front = box_solution.velocity(1, 0.2, t, side="left")
    behind_front = box_solution.velocity(1, 0.2, t)
    assert before_front == 0.0
    assert behind_front == 0.5


def test_displacements_of_the_box(box_solution):
    """Displacements of both rods of the box while the first wave runs, and the mean
    velocity of the struck rod, are those of the known motion.
    """
    t = 0.2 / C
    transit = 0.4 / C  # of the striker
    beside_contact = box_solution.displacement(1, 0.0, t)
    far_end = box_solution.displacement(0, 0.0, transit)
    mean_velocity = box_solution.mean_velocity(1, transit)
    assert beside_contact == pytest.approx(0.5 * t)
    assert far_end == pytest.approx(1.0 * transit)  # the wave has just come there
    # By then 0.4 m of the struck rod, of 1 m, move at 0.5 m/s.
    assert mean_velocity == pytest.approx(0.4 * 0.5)


PLACES_IN_STEPPED = np.linspace(0, 0.8, 41)  # in body 2 of `mixed_solution`, m
TIMES_OF_MIXED = np.linspace(0, 1e-3, 57)  # from its begin to its end, s


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("compiling", [False, True])
def test_grids_and_points_agree_bit_for_bit(mixed_solution, compiling, transposed):
    """Velocities on a grid of positions and times, which are computed in another way,
    equal those at as many single points, compiled or not, also with the axes exchanged.
    The strain has the same shape.
    """
    if transposed:
        x = PLACES_IN_STEPPED[None, :]
        t = TIMES_OF_MIXED[:, None]
    else:
        x = PLACES_IN_STEPPED[:, None]
        t = TIMES_OF_MIXED[None, :]
    all_x, all_t = np.broadcast_arrays(x, t)
    at_points = mixed_solution.velocity(2, all_x.ravel(), all_t.ravel())

    with kernels.forced(compiling):
        velocity = mixed_solution.velocity(2, x, t)
        strain = mixed_solution.strain(2, x, t)

    assert np.array_equal(velocity.ravel(), at_points)
    assert strain.shape == velocity.shape


def test_the_order_of_places_and_times_is_free(mixed_solution):
    """Positions or times in reverse give the same values in reverse."""
    x = PLACES_IN_STEPPED
    t = TIMES_OF_MIXED
    velocity = mixed_solution.velocity(2, x[:, None], t)

    times_reversed = mixed_solution.velocity(2, x[:, None], t[::-1].copy())
    places_reversed = mixed_solution.velocity(2, x[::-1, None], t)

    assert np.array_equal(times_reversed, velocity[:, ::-1])
    assert np.array_equal(places_reversed, velocity[::-1])


def test_walls_have_a_velocity_but_no_stress(mixed_solution):
    """A moving wall has its speed as velocity and mean velocity, and the displacement
    that follows; its stress raises ValueError.
    """
    wall = 0
    speed = 0.05  # m/s
    until = 1e-3  # s
    mean_velocity = mixed_solution.mean_velocity(wall, [0.0, until])
    displacement = mixed_solution.displacement(wall, 0.0, until)
    assert mixed_solution.velocity(wall, 0.0, 1e-4) == speed
    assert mean_velocity.tolist() == [speed, speed]
    assert displacement == pytest.approx(speed * until)
    with pytest.raises(ValueError, match="wall"):
        mixed_solution.stress(wall, 0.0, 0.0)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda s: s.velocity(1, 0.2, 1.0), "t:"),
        (lambda s: s.velocity(1, 0.41, 0.0), "x:"),
        (lambda s: s.strain(1, -0.1, 0.0), "x:"),
        (lambda s: s.velocity(4, 0.1, 0.0), "body:"),
        (lambda s: s.gauge(0, 0.1), "wall"),
        (lambda s: s.velocity(1, 0.1, 0.0, side="up"), "side:"),
        (lambda s: s.energy(2.0), "t:"),
        (lambda s: s.contacts[0].force(2.0), "t:"),
        (lambda s: s.system_at(2.0), "t:"),
    ],
)
def test_questions_outside_the_solution_are_refused(mixed_solution, call, name):
    with pytest.raises(ValueError, match=name):
        call(mixed_solution)


def polygon_area(x, t):
    """Area of a polygon by the coordinates of its corners (the shoelace formula)."""
    next_x = np.roll(x, -1)
    next_t = np.roll(t, -1)
    return abs(np.dot(x, next_t) - np.dot(t, next_x)) / 2


@pytest.mark.parametrize(("body", "length"), [(1, 0.4), (2, 0.8), (3, 0.25)])
def test_regions_tile_the_plane_and_agree_with_the_fields(mixed_solution, body, length):
    """The plane is that of places in a rod, of `length`, and times."""
    start = 1e-5
    stop = 2e-4

    regions = regions_of(mixed_solution, start, stop)

    assert regions.t.min() == pytest.approx(start)
    assert regions.t.max() == pytest.approx(stop)
    area = 0.0
    for i in np.flatnonzero(regions.body == body):
        corners = slice(regions.start[i], regions.start[i + 1])
        x = regions.x[corners]
        t = regions.t[corners]
        area += polygon_area(x, t)
        inside_x = x.mean()  # regions are convex
        inside_t = t.mean()
        stress = mixed_solution.stress(body, inside_x, inside_t)
        displacement = mixed_solution.displacement(body, x, t)
        assert mixed_solution.velocity(body, inside_x, inside_t) == regions.velocity[i]
        assert mixed_solution.strain(body, inside_x, inside_t) == regions.strain[i]
        assert stress == pytest.approx(regions.stress[i], rel=1e-14)
        of_regions = regions.displacement[corners]
        assert displacement == pytest.approx(of_regions, abs=1e-15)
    plane = length * (stop - start)
    assert area == pytest.approx(plane, rel=1e-12)


@pytest.mark.parametrize("limit", [100, 8, 4])
def test_a_run_is_halved_until_it_has_few_enough_regions_and_no_further(
    box_solution, limit
):
    """`readable_until` gives the end of the run over a power of 2, up to which there
    are at most `limit` regions; up to twice this time there are more.
    """
    stop = readable_until(box_solution, limit)
    halvings = np.log2(box_solution.t_end / stop)
    count = len(regions_of(box_solution, stop=stop))
    assert halvings == round(halvings)
    assert count <= limit
    if halvings > 0:
        count_of_longer = len(regions_of(box_solution, stop=2 * stop))
        assert count_of_longer > limit


def test_more_regions_than_a_picture_shows_are_refused_with_the_number(box_solution):
    with pytest.raises(ValueError, match=r"more than 1 regions .* fewer pieces"):
        readable_until(box_solution, 1)


def test_a_gauge_separates_the_waves_and_has_the_fields_at_its_place(box_solution):
    """A gauge in the middle of the struck rod: its two waves add to its strain, the
    first change is the incident wave, when it arrives, and between changes strain and
    velocity are those of the solution.
    """
    x = 0.5
    gauge = box_solution.gauge(1, x)
    waves = gauge.rightward + gauge.leftward
    assert gauge.strain == pytest.approx(waves, abs=1e-20)
    # Its first change is the wave from the contact, of 0.5 m/s: v = -c strain.
    wave = -0.5 / C
    arrival = x / C
    assert gauge.times[1] == pytest.approx(arrival)
    assert gauge.strain[1] == pytest.approx(wave)
    assert gauge.rightward[1] == gauge.strain[1]
    assert gauge.leftward[1] == 0
    between = (gauge.times[:-1] + gauge.times[1:]) / 2
    strain = box_solution.strain(1, x, between)
    velocity = box_solution.velocity(1, x, between)
    assert np.array_equal(strain, gauge.strain[:-1])
    assert np.array_equal(velocity, gauge.velocity[:-1])


def test_strains_of_a_gauge_are_written_exactly(box_solution, tmp_path):
    """The strains of a gauge, written to a CSV file and read by numpy, are equal bit
    for bit.
    """
    path = tmp_path / "gauge.csv"
    gauge = box_solution.gauge(1, 0.5)

    gauge.to_csv(path)

    table = np.genfromtxt(path, delimiter=",", names=True)
    written = table["strain_1"]  # of the head "strain [1]"
    assert np.array_equal(written, gauge.strain)


def test_a_distant_wall_is_still_reached():
    """A rod at 1 mm/s strikes a wall at a distance of 10 m."""
    speed = 1e-3  # m/s
    gap = 10.0  # m
    outcome = ri.collide(rod(0.3, speed), ri.Wall(), gap=gap)
    assert outcome.restitution == pytest.approx(1.0, abs=1e-12)
    assert outcome.contacts[0].first == pytest.approx(gap / speed, rel=1e-12)


def test_a_transit_time_that_the_clock_rounds_is_named():
    """A very short rod, whose transit time the clock rounds, is named by the status."""
    short = rod(1.2345678901234e-9)
    system = ri.System([rod(1.0, velocity=1.0), short])
    solution = ri.solve(system, until=1e-5)
    assert solution.transit_error > ROUNDED
    assert "The clock rounds the transit time of bodies.1" in solution.status


def test_public_names_are_listed_and_an_unknown_one_is_said():
    assert set(ri.__all__) <= set(dir(ri))
    with pytest.raises(AttributeError, match="nonsense"):
        _ = ri.nonsense


def test_the_package_imports_next_to_nothing():
    """Python's own modules too: contextlib alone would take longer than the package."""
    code = """
import sys
from pathlib import Path
import importlib
before = set(sys.modules)
import rodimpact
print(*sorted(set(sys.modules) - before))
"""
    folder = Path(ri.__file__).parents[1]
    command = [sys.executable, "-S", "-c", code]
    done = subprocess.run(
        command,
        check=True,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(folder)},
    )
    assert done.stdout == "rodimpact rodimpact.version\n"


@pytest.fixture(scope="module")
def rebounding_solution():
    """The solution of a rod between two walls, over so many ticks that a time in a
    float does not distinguish one from the next.

    The time of a jump must still have two sides.
    """
    system = ri.System([ri.Wall(), rod(0.3, 10.0), ri.Wall()], gaps=[0.001, 0.002])
    solution = ri.solve(system, until=0.1)
    assert solution.fields.end > 2**56  # ticks; a float has 53 bits
    return solution


def test_sides_of_forces_are_right_after_a_thousand_transits(rebounding_solution):
    """The force begins and ends with a jump, of which each side is told."""
    for contact in rebounding_solution.contacts:
        assert len(contact.episodes) > 100
        for episode in contact.episodes[:-1]:  # the end of the run may cut the last
            start = episode.start
            end = episode.force_end
            assert contact.force(start, side="left") == 0
            assert contact.force(start) > 0
            assert contact.force(end, side="left") > 0
            assert contact.force(end) == 0


def test_sides_of_strains_are_right_after_a_thousand_transits(rebounding_solution):
    """After many transits, the strains of the solution at the times of a gauge are the
    recorded ones, and with side="left" those before each change.
    """
    gauge = rebounding_solution.gauge(1, 0.1)
    after = rebounding_solution.strain(1, 0.1, gauge.times)
    before = rebounding_solution.strain(1, 0.1, gauge.times[1:], side="left")
    assert np.array_equal(after, gauge.strain)
    assert np.array_equal(before, gauge.strain[:-1])


def test_bodies_that_move_apart_however_distant_are_final_as_they_are():
    """Two rods, 10 billion kilometres apart, move apart: the run is final, and they
    keep their velocities.
    """
    bodies = [rod(0.4, velocity=-1.0), rod(1.0, velocity=1.0)]
    far = ri.System(bodies, gaps=[1e13])
    solution = ri.solve(far)
    assert solution.final
    assert solution.outcome.velocities_after == pytest.approx((-1.0, 1.0))


def test_places_and_times_that_do_not_broadcast_are_named(box_solution):
    with pytest.raises(ValueError, match=r"x: shape \(2,\) does not broadcast"):
        box_solution.velocity(1, [0.1, 0.2], [0.0, 1e-5, 2e-5])


def sent(value):
    """What another process would receive of a value."""
    return pickle.loads(pickle.dumps(value))


@pytest.mark.parametrize(
    "options",
    [{}, {"method": "characteristics"}, {"method": "finite-difference", "cells": 20}],
)
@pytest.mark.parametrize("copied", [sent, copy.deepcopy])
def test_a_solution_can_be_copied_and_sent(options, copied):
    """A solution that is copied, or pickled and read, has the same outcome, velocities
    and forces.
    """
    system = ri.System([rod(0.4, velocity=1.0), rod(1.0)])
    solution = ri.solve(system, **options)

    received = copied(solution)

    t = np.linspace(0, solution.t_end, 9)
    velocity = solution.velocity(0, 0.1, t)
    force = solution.contacts[0].force(t)
    assert received.outcome == solution.outcome
    assert np.array_equal(received.velocity(0, 0.1, t), velocity)
    assert np.array_equal(received.contacts[0].force(t), force)


X = np.array([0.0, 0.2, 0.4, 0.8])  # m from the left end of each body
TIMES = np.array([0.0, 1e-4, 1e-3])  # s


@pytest.fixture(scope="module")
def dataset(mixed_solution):
    """The bodies of `mixed_solution` at the places `X` and `TIMES`, as xarray has them."""
    pytest.importorskip("xarray")
    return mixed_solution.to_xarray(X, TIMES)


@pytest.mark.parametrize(
    ("field", "places_in_wall"),
    [
        ("velocity", 1),
        ("displacement", 1),
        ("position", 1),
        ("strain", 0),
        ("stress", 0),
        ("axial_force", 0),
    ],
)
def test_to_xarray_has_the_fields_of_the_solution_and_nan_outside_the_bodies(
    mixed_solution, dataset, field, places_in_wall
):
    """A field in the dataset is finite at as many positions as each body has, at all
    times, and equals that of the solution.
    """
    values = dataset[field].transpose("body", "time", "x")
    # Of the places in X the rods, of 0.4, 0.8 and 0.25 m, have 3, 4 and 2.
    places_in_body = [places_in_wall, 3, 4, 2]
    counts = np.isfinite(values).sum("x").values  # [body, time]
    for counts_at_time in counts.T:
        assert counts_at_time.tolist() == places_in_body
    field_at = getattr(mixed_solution, field)
    of_solution = field_at(2, X, TIMES[:, None])
    of_dataset = values.sel(body=2).values
    assert np.array_equal(of_dataset, of_solution)


def test_to_xarray_has_kinds_gaps_mean_velocities_and_energies(mixed_solution, dataset):
    """The dataset of a solution has the expected sizes, the kinds of the bodies, and
    gaps, mean velocities and strain energies of the solution.
    """
    sizes = {"body": 4, "x": 4, "time": 3, "contact": 3, "part": 14}
    kinds = dataset["kind"].values
    gap = dataset["gap"].sel(contact=1)
    mean_velocity = dataset["mean_velocity"].sel(body=3)
    strain_energy = dataset["energy"].sel(part="strain")
    assert dict(dataset.sizes) == sizes
    assert kinds.tolist() == ["wall", "rod", "rod", "rod"]
    assert np.array_equal(gap, mixed_solution.contacts[1].gap(TIMES))
    assert np.array_equal(mean_velocity, mixed_solution.mean_velocity(3, TIMES))
    assert np.array_equal(strain_energy, mixed_solution.energy(TIMES).strain)


def test_to_xarray_names_every_variable_and_its_unit(dataset):
    assert dataset["force"].attrs["units"] == "N"
    for variable in dataset.variables.values():
        assert {"long_name", "units"} <= set(variable.attrs)


def test_to_xarray_refuses_places_beyond_all_bodies(mixed_solution):
    pytest.importorskip("xarray")
    message = r"x\[1\]: must lie in a body, from 0 to 0.8 m, got 0.9"
    with pytest.raises(ValueError, match=message):
        mixed_solution.to_xarray([0.1, 0.9], TIMES)


def test_in_xarray_masses_have_a_velocity_and_no_strain():
    pytest.importorskip("xarray")
    mass = ri.RigidMass(0.5, velocity=2.0)
    system = ri.System([mass, rod(0.4)], contacts=[ri.Hertz(1e9)])
    dataset = ri.solve(system, until=1e-4).to_xarray(0.0, [0.0, 1e-4])
    assert dataset["velocity"].sel(body=0, x=0.0, time=0.0) == 2.0
    assert dataset["strain"].sel(body=0).isnull().all()


def test_in_xarray_a_single_body_has_forces_of_no_contact():
    pytest.importorskip("xarray")
    solution = ri.solve(ri.System([rod(0.4)]), until=1e-4)
    dataset = solution.to_xarray([0.1], [0.0])
    assert dataset["force"].shape == (0, 1)  # [contact, time]


@pytest.mark.parametrize("short", [1e-7, 1.2345678e-7, 3.3e-7 * math.sqrt(2)])
@pytest.mark.parametrize("ratio", [1.0, 0.3])
def test_the_effect_of_rounded_transits_is_stated(short, ratio):
    """A short rod on a long one: impulse and duration have closed forms, and their
    errors are those of rounding a transit time to ticks.
    """
    striker = rod(short, velocity=1.0)
    struck = rod(1.0, area=1e-4 / ratio)
    thin = striker.segments[0]
    thick = struck.segments[0]
    theory = ri.theory.saint_venant(
        thin.impedance, thin.transit_time, thick.impedance, thick.transit_time
    )

    solution = ri.solve(ri.System([striker, struck]))

    stated = solution.accuracy
    outcome = solution.outcome
    (episode,) = solution.contacts[0].episodes
    impulse_error = abs(outcome.impulse / theory.impulse - 1)
    duration_error = abs(outcome.duration / theory.duration - 1)
    time_error = abs(episode.force_end - theory.duration) / episode.opening
    assert solution.transit_error > ROUNDED
    assert 0 < impulse_error <= stated["impulse"] < 1e-6
    assert 0 < duration_error <= stated["duration"] < 1e-6
    assert time_error <= stated["time"] < 1e-6
    assert "Stated relative error: " in solution.status


def test_no_error_is_stated_of_transits_that_are_exact(box_solution):
    assert box_solution.accuracy == {}


@pytest.mark.parametrize(
    ("name", "interval"),
    [("limit", {"limit": 3}), ("stop", {"start": 1e-5, "stop": 1e-5})],
)
def test_intervals_without_regions_or_with_too_many_are_refused(
    box_solution, name, interval
):
    with pytest.raises(ValueError, match=name):
        regions_of(box_solution, **interval)


def test_families_and_what_is_no_system_are_refused():
    """`solve` refuses a family, with `sweep` as the remedy, and a list of bodies."""
    lengths = np.array([0.1, 0.2])
    family = ri.System([rod(lengths, velocity=1.0), rod(1.0)])
    with pytest.raises(ri.InvalidModel, match=r"a family of shape \(2,\).*sweep"):
        ri.solve(family)
    with pytest.raises(ri.InvalidModel, match="system"):
        ri.solve([rod(1.0)])
