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
def unequal():
    """A rod of 0.4 m that strikes one of 1 m of the same section at 1 m/s: the box of
    force that theory knows.
    """
    return ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))


@pytest.fixture(scope="module")
def mixed():
    """A moving wall, and rods of 0.4, 0.8 and 0.25 m; that of 0.8 m has two segments
    and steps of initial velocity and strain.
    """
    thin = ri.Segment(0.3, 1e-4, steel)
    thick = ri.Segment(0.5, 2e-4, aluminium)
    stepped = ri.Rod(
        segments=[thin, thick],
        velocity=ri.Steps([0.2, -0.4], [0.3]),
        strain=ri.Steps([0.0, 1e-5, 0.0], [0.1, 0.6]),
    )
    bodies = [ri.Wall(0.05), rod(0.4, -1.0), stepped, rod(0.25, -2.0, area=3e-4)]
    return ri.solve(ri.System(bodies, [1e-5, 2e-5, 0.0]), until=1e-3)


def test_lengths_too_far_apart_say_so():
    with pytest.raises(ri.InvalidModel, match=r"bodies.0: its transit time"):
        ri.collide(rod(1e-13, 1.0), rod(1.0))


def test_the_outcome_of_the_box(unequal):
    outcome = unequal.outcome
    assert outcome.velocities_after == pytest.approx((0.0, 0.4), abs=1e-14)
    energy_before = 0.5 * outcome.masses[0]
    # The struck rod has 1/0.4 times the mass of the striker, and 0.4 m/s.
    energy_moving = energy_before / 0.4 * 0.4**2
    vibration = energy_before - energy_moving
    assert sum(outcome.vibration_after) == pytest.approx(vibration, rel=1e-13)


def test_the_contact_of_the_box(unequal):
    t1 = 0.4 / C  # transit time of the striker
    (contact,) = unequal.contacts
    (episode,) = contact.episodes
    # The force ends with the striker's wave, the contact with that of the struck rod.
    assert episode == pytest.approx((0.0, 2 * t1, 2 / C), rel=1e-14)
    assert contact.force(t1) == pytest.approx(steel.density * 1e-4 * C / 2)
    assert contact.force(2 * t1, side="left") > 0
    assert contact.force(2 * t1) == 0
    assert contact.gap(2 / C + 1e-6) == pytest.approx(1e-6)


def test_the_box_is_final_at_opening_and_proved_so_as_the_force_ends(unequal):
    force_duration = 2 * 0.4 / C
    assert unequal.final
    assert unequal.stopped_by == "final"
    assert unequal.t_final == unequal.contacts[0].episodes[0].opening
    assert unequal.t_proved == pytest.approx(force_duration)
    assert unequal.t_end == pytest.approx(force_duration + 2 / C)


def test_fields_of_the_box(unequal):
    t = 0.2 / C  # the waves are 0.2 m from the contact, at x = 0.2 m of either rod
    contact = unequal.contacts[0]
    assert unequal.velocity(0, [0.1, 0.3], t).tolist() == [1.0, 0.5]
    assert unequal.velocity(1, [0.1, 0.3], t).tolist() == [0.5, 0.0]
    assert unequal.stress(1, 0.1, t) == pytest.approx(-steel.density * C / 2)
    assert unequal.axial_force(1, 0.1, t) == pytest.approx(-contact.force(t))
    before_front = unequal.velocity(1, 0.2, t, side="left")
    behind_front = unequal.velocity(1, 0.2, t)
    assert float(before_front) == 0.0
    assert float(behind_front) == 0.5


def test_displacements_of_the_box(unequal):
    t = 0.2 / C
    t1 = 0.4 / C
    assert unequal.displacement(1, 0.0, t) == pytest.approx(0.5 * t)
    assert unequal.displacement(0, 0.0, t1) == pytest.approx(t1)  # not reached, 1 m/s
    # By then 0.4 m of the struck rod, of 1 m, move at 0.5 m/s.
    assert unequal.mean_velocity(1, t1) == pytest.approx(0.5 * 0.4)


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("compiling", [False, True])
def test_grids_and_points_agree_bit_for_bit(mixed, compiling, transposed):
    x = np.linspace(0, 0.8, 41)
    t = np.linspace(0, 1e-3, 57)
    # A grid of places and times is read in another way than as many single points.
    all_x, all_t = np.meshgrid(x, t, indexing="ij")
    at_points = mixed.velocity(2, all_x.ravel(), all_t.ravel()).reshape(41, 57)
    if transposed:
        grid = (x[None, :], t[:, None])
        at_points = at_points.T
    else:
        grid = (x[:, None], t)

    with kernels.forced(compiling):
        velocity = mixed.velocity(2, *grid)

    assert (velocity == at_points).all()
    assert mixed.strain(2, *grid).shape == velocity.shape


def test_the_order_of_places_and_times_is_free(mixed):
    x = np.linspace(0, 0.8, 41)
    t = np.linspace(0, 1e-3, 57)
    velocity = mixed.velocity(2, x[:, None], t)
    backwards = t[::-1].copy()
    assert (mixed.velocity(2, x[:, None], backwards) == velocity[:, ::-1]).all()
    assert (mixed.velocity(2, x[::-1, None], t) == velocity[::-1]).all()


def test_walls_have_a_velocity_but_no_stress(mixed):
    assert mixed.velocity(0, 0.0, 1e-4) == 0.05
    assert mixed.mean_velocity(0, [0.0, 1e-3]).tolist() == [0.05, 0.05]
    assert mixed.displacement(0, 0.0, 1e-3) == pytest.approx(5e-5)
    with pytest.raises(ValueError, match="wall"):
        mixed.stress(0, 0.0, 0.0)


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
def test_questions_outside_the_solution_are_refused(mixed, call, name):
    with pytest.raises(ValueError, match=name):
        call(mixed)


def polygon_area(x, t):
    """Area of a polygon by the coordinates of its corners."""
    return abs(np.dot(x, np.roll(t, -1)) - np.dot(t, np.roll(x, -1))) / 2


@pytest.mark.parametrize(("body", "length"), [(1, 0.4), (2, 0.8), (3, 0.25)])
def test_regions_tile_the_plane_and_agree_with_the_fields(mixed, body, length):
    start = 1e-5
    stop = 2e-4
    regions = regions_of(mixed, start, stop)
    assert regions.t.min() == pytest.approx(start)
    assert regions.t.max() == pytest.approx(stop)
    area = 0.0
    for i in np.flatnonzero(regions.body == body):
        corners = slice(regions.start[i], regions.start[i + 1])
        x = regions.x[corners]
        t = regions.t[corners]
        area += polygon_area(x, t)
        inside = (x.mean(), t.mean())  # regions are convex
        assert mixed.velocity(body, *inside) == regions.velocity[i]
        assert mixed.strain(body, *inside) == regions.strain[i]
        stress = pytest.approx(regions.stress[i], rel=1e-14)
        assert mixed.stress(body, *inside) == stress
        displacement = pytest.approx(regions.displacement[corners], abs=1e-15)
        assert mixed.displacement(body, x, t) == displacement
    assert area == pytest.approx(length * (stop - start), rel=1e-12)


@pytest.mark.parametrize("limit", [100, 8, 4])
def test_a_run_is_halved_until_it_has_few_enough_regions_and_no_further(unequal, limit):
    stop = readable_until(unequal, limit)
    halvings = np.log2(unequal.t_end / stop)
    assert halvings == round(halvings)
    assert len(regions_of(unequal, stop=stop)) <= limit
    if halvings > 0:
        assert len(regions_of(unequal, stop=2 * stop)) > limit


def test_more_regions_than_a_picture_shows_are_refused_with_the_number(unequal):
    with pytest.raises(ValueError, match=r"more than 1 regions .* fewer pieces"):
        readable_until(unequal, 1)


def test_a_gauge_separates_the_waves_and_has_the_fields_at_its_place(unequal):
    gauge = unequal.gauge(1, 0.5)
    assert gauge.strain == pytest.approx(gauge.rightward + gauge.leftward, abs=1e-20)
    # Its first change is the wave from the contact, 0.5 m away: of 0.5 m/s, v = -c e.
    assert gauge.times[1] == pytest.approx(0.5 / C)
    assert gauge.strain[1] == gauge.rightward[1]
    assert gauge.strain[1] == pytest.approx(-0.5 / C)
    assert gauge.leftward[1] == 0
    between = (gauge.times[:-1] + gauge.times[1:]) / 2
    assert (unequal.strain(1, 0.5, between) == gauge.strain[:-1]).all()
    assert (unequal.velocity(1, 0.5, between) == gauge.velocity[:-1]).all()


def test_strains_of_a_gauge_are_written_exactly(unequal, tmp_path):
    gauge = unequal.gauge(1, 0.5)
    gauge.to_csv(tmp_path / "gauge.csv")
    table = np.genfromtxt(tmp_path / "gauge.csv", delimiter=",", names=True)
    assert (table["strain_1"] == gauge.strain).all()


def test_a_distant_wall_is_still_reached():
    outcome = ri.collide(rod(0.3, 1e-3), ri.Wall(), gap=10.0)
    assert outcome.restitution == pytest.approx(1.0, abs=1e-12)
    assert outcome.contacts[0].first == pytest.approx(1e4, rel=1e-12)


def test_a_transit_time_that_the_clock_rounds_is_named():
    system = ri.System([rod(1.0, 1.0), rod(1.2345678901234e-9)])
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
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        check=True,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(folder)},
    )
    assert done.stdout == "rodimpact rodimpact.version\n"


@pytest.fixture(scope="module")
def between_walls():
    """A rod that rebounds between two walls, over so many ticks that a time in a float
    does not tell one from the next.

    The time of a jump must still have two sides.
    """
    system = ri.System([ri.Wall(), rod(0.3, 10.0), ri.Wall()], gaps=[0.001, 0.002])
    solution = ri.solve(system, until=0.1)
    assert solution.fields.end > 2**56  # ticks; a float has 53 bits
    return solution


def test_sides_of_forces_are_right_after_a_thousand_transits(between_walls):
    for contact in between_walls.contacts:
        assert len(contact.episodes) > 100
        for episode in contact.episodes[:-1]:  # the end of the run may cut the last
            assert contact.force(episode.start, side="left") == 0
            assert contact.force(episode.start) > 0
            assert contact.force(episode.force_end, side="left") > 0
            assert contact.force(episode.force_end) == 0


def test_sides_of_strains_are_right_after_a_thousand_transits(between_walls):
    gauge = between_walls.gauge(1, 0.1)
    after = between_walls.strain(1, 0.1, gauge.times)
    before = between_walls.strain(1, 0.1, gauge.times[1:], side="left")
    assert (after == gauge.strain).all()
    assert (before == gauge.strain[:-1]).all()


def test_bodies_that_move_apart_however_distant_are_final_as_they_are():
    far = ri.solve(ri.System([rod(0.4, -1.0), rod(1.0, 1.0)], gaps=[1e13]))
    assert far.final
    assert far.outcome.velocities_after == pytest.approx((-1.0, 1.0))


def test_places_and_times_that_do_not_broadcast_are_named(unequal):
    with pytest.raises(ValueError, match=r"x: shape \(2,\) does not broadcast"):
        unequal.velocity(1, [0.1, 0.2], [0.0, 1e-5, 2e-5])


@pytest.mark.parametrize(
    "options",
    [{}, {"method": "characteristics"}, {"method": "finite-difference", "cells": 20}],
)
@pytest.mark.parametrize(
    "copied", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy]
)
def test_a_solution_can_be_copied_and_sent(options, copied):
    solution = ri.solve(ri.System([rod(0.4, velocity=1.0), rod(1.0)]), **options)
    received = copied(solution)
    assert received.outcome == solution.outcome
    t = np.linspace(0, solution.t_end, 9)
    velocity = solution.velocity(0, 0.1, t)
    assert np.array_equal(received.velocity(0, 0.1, t), velocity)
    force = solution.contacts[0].force(t)
    assert np.array_equal(received.contacts[0].force(t), force)


X = np.array([0.0, 0.2, 0.4, 0.8])  # m from the left end of each body
TIMES = np.array([0.0, 1e-4, 1e-3])  # s


@pytest.fixture(scope="module")
def dataset(mixed):
    """The bodies of `mixed` at the places `X` and `TIMES`, as xarray has them."""
    pytest.importorskip("xarray")
    return mixed.to_xarray(X, TIMES)


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
    mixed, dataset, field, places_in_wall
):
    values = dataset[field].transpose("body", "time", "x")
    # Of the places in X the rods, of 0.4, 0.8 and 0.25 m, have 3, 4 and 2.
    places_in_body = [places_in_wall, 3, 4, 2]
    counts = np.isfinite(values).sum("x").values  # [body, time]
    for time in range(len(TIMES)):
        assert counts[:, time].tolist() == places_in_body
    of_solution = getattr(mixed, field)(2, X, TIMES[:, None])
    assert np.array_equal(values.sel(body=2).values, of_solution)


def test_to_xarray_has_kinds_gaps_mean_velocities_and_energies(mixed, dataset):
    sizes = {"body": 4, "x": 4, "time": 3, "contact": 3, "part": 14}
    assert dict(dataset.sizes) == sizes
    assert dataset["kind"].values.tolist() == ["wall", "rod", "rod", "rod"]
    gap = mixed.contacts[1].gap(TIMES)
    assert np.array_equal(dataset["gap"].sel(contact=1), gap)
    mean_velocity = mixed.mean_velocity(3, TIMES)
    assert np.array_equal(dataset["mean_velocity"].sel(body=3), mean_velocity)
    strain_energy = mixed.energy(TIMES).strain
    assert np.array_equal(dataset["energy"].sel(part="strain"), strain_energy)


def test_to_xarray_names_every_variable_and_its_unit(dataset):
    assert dataset["force"].attrs["units"] == "N"
    for variable in dataset.variables.values():
        assert {"long_name", "units"} <= set(variable.attrs)


def test_to_xarray_refuses_places_beyond_all_bodies(mixed):
    pytest.importorskip("xarray")
    message = r"x\[1\]: must lie in a body, from 0 to 0.8 m, got 0.9"
    with pytest.raises(ValueError, match=message):
        mixed.to_xarray([0.1, 0.9], TIMES)


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
    striker = rod(short, 1.0)
    struck = ri.Rod(1.0, area=1e-4 / ratio, material=steel)
    theory = ri.theory.saint_venant(
        striker.segments[0].impedance,
        striker.segments[0].transit_time,
        struck.segments[0].impedance,
        struck.segments[0].transit_time,
    )

    solution = ri.solve(ri.System([striker, struck]))

    stated = solution.accuracy
    assert solution.transit_error > ROUNDED
    impulse_error = abs(solution.outcome.impulse / theory.impulse - 1)
    assert 0 < impulse_error <= stated["impulse"] < 1e-6
    duration_error = abs(solution.outcome.duration / theory.duration - 1)
    assert 0 < duration_error <= stated["duration"] < 1e-6
    (episode,) = solution.contacts[0].episodes
    time_error = abs(episode.force_end - theory.duration) / episode.opening
    assert time_error <= stated["time"] < 1e-6
    assert "Stated relative error: " in solution.status


def test_no_error_is_stated_of_transits_that_are_exact(unequal):
    assert unequal.accuracy == {}


@pytest.mark.parametrize(
    ("name", "interval"),
    [("limit", {"limit": 3}), ("stop", {"start": 1e-5, "stop": 1e-5})],
)
def test_intervals_without_regions_or_with_too_many_are_refused(
    unequal, name, interval
):
    with pytest.raises(ValueError, match=name):
        regions_of(unequal, **interval)


def test_families_and_what_is_no_system_are_refused():
    family = ri.System([rod(np.array([0.1, 0.2]), 1.0), rod(1.0)])
    with pytest.raises(ri.InvalidModel, match=r"a family of shape \(2,\).*sweep"):
        ri.solve(family)
    with pytest.raises(ri.InvalidModel, match="system"):
        ri.solve([rod(1.0)])
