"""Fields, regions, gauges, contacts and outcome of solutions."""

import copy
import math
import pickle
import subprocess
import sys

import numpy as np
import pytest
from systems import rod

import rodimpact as ri
from rodimpact.materials import aluminium, steel
from rodimpact.methods import kernels
from rodimpact.results.regions import readable_until, regions_of

C = steel.wave_speed


@pytest.fixture(scope="module")
def unequal():
    return ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))


@pytest.fixture(scope="module")
def mixed():
    stepped = ri.Rod(
        segments=[ri.Segment(0.3, 1e-4, steel), ri.Segment(0.5, 2e-4, aluminium)],
        velocity=ri.Steps([0.2, -0.4], [0.3]),
        strain=ri.Steps([0.0, 1e-5, 0.0], [0.1, 0.6]),
    )
    row = [ri.Wall(0.05), rod(0.4, -1.0), stepped, rod(0.25, -2.0, area=3e-4)]
    return ri.solve(ri.System(row, [1e-5, 2e-5, 0.0]), until=1e-3)


def test_lengths_too_far_apart_say_so():
    with pytest.raises(ri.InvalidModel, match=r"bodies.0: its transit time"):
        ri.collide(rod(1e-13, 1.0), rod(1.0))


def test_the_box(unequal):
    outcome = unequal.outcome
    t1 = 0.4 / C
    assert outcome.velocities_after == pytest.approx((0.0, 0.4), abs=1e-14)
    contact = unequal.contacts[0]
    assert contact.episodes[0] == pytest.approx((0.0, 2 * t1, 2 / C), rel=1e-14)
    assert contact.force(t1) == pytest.approx(steel.density * 1e-4 * C / 2)
    assert contact.force(2 * t1, side="left") > 0
    assert contact.force(2 * t1) == 0
    assert contact.gap(2 / C + 1e-6) == pytest.approx(1e-6)
    energy = 0.5 * outcome.masses[0]
    assert sum(outcome.vibration_after) == pytest.approx(
        (1 - 0.4**2) * energy / 1.4, rel=1e-13
    )
    assert unequal.final
    assert unequal.stopped_by == "final"
    assert unequal.t_final == contact.episodes[0].opening
    assert unequal.t_proved == pytest.approx(2 * t1)
    assert unequal.t_end == pytest.approx(2 * t1 + 2 / C)


def test_fields_of_the_box(unequal):
    t = 0.2 / C
    assert unequal.velocity(0, [0.1, 0.3], t).tolist() == [1.0, 0.5]
    assert unequal.velocity(1, [0.1, 0.3], t).tolist() == [0.5, 0.0]
    assert unequal.stress(1, 0.1, t) == pytest.approx(-steel.density * C / 2)
    assert unequal.axial_force(1, 0.1, t) == pytest.approx(
        -unequal.contacts[0].force(t)
    )
    front = unequal.velocity(1, 0.2, t, side="left"), unequal.velocity(1, 0.2, t)
    assert (float(front[0]), float(front[1])) == (0.0, 0.5)
    assert unequal.displacement(1, 0.0, t) == pytest.approx(0.5 * t)
    assert unequal.displacement(0, 0.0, 0.4 / C) == pytest.approx(0.4 / C)
    assert unequal.mean_velocity(1, 0.4 / C) == pytest.approx(0.5 * 0.4)


@pytest.mark.parametrize("transposed", [False, True])
@pytest.mark.parametrize("compiling", [False, True])
def test_grids_and_points_agree_bit_for_bit(mixed, compiling, transposed):
    x = np.linspace(0, 0.8, 41)
    t = np.linspace(0, 1e-3, 57)
    shape = (x[None, :], t[:, None]) if transposed else (x[:, None], t)
    with kernels.forced(compiling):
        grid = mixed.velocity(2, *shape)
    points = np.meshgrid(x, t, indexing="ij")
    single = mixed.velocity(2, points[0].ravel(), points[1].ravel()).reshape(41, 57)
    assert (grid == (single.T if transposed else single)).all()
    strain = mixed.strain(2, *shape)
    assert strain.shape == grid.shape
    back = t[::-1].copy()
    assert (mixed.velocity(2, x[:, None], back) == single[:, ::-1]).all()
    assert (mixed.velocity(2, x[::-1, None], t) == single[::-1]).all()


def test_walls_have_a_velocity_but_no_inside(mixed):
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


def test_regions_tile_the_plane_and_agree_with_the_fields(mixed):
    start = 1e-5
    stop = 2e-4
    regions = regions_of(mixed, start, stop)
    assert (regions.t.min(), regions.t.max()) == pytest.approx((start, stop))
    for body, length in ((1, 0.4), (2, 0.8), (3, 0.25)):
        area = 0.0
        for i in np.flatnonzero(regions.body == body):
            corners = slice(regions.start[i], regions.start[i + 1])
            x = regions.x[corners]
            t = regions.t[corners]
            area += abs(np.dot(x, np.roll(t, -1)) - np.dot(t, np.roll(x, -1))) / 2
            inside = x.mean(), t.mean()
            assert mixed.velocity(body, *inside) == regions.velocity[i]
            assert mixed.strain(body, *inside) == regions.strain[i]
            assert mixed.stress(body, *inside) == pytest.approx(
                regions.stress[i], rel=1e-14
            )
            assert mixed.displacement(body, x, t) == pytest.approx(
                regions.displacement[corners], abs=1e-15
            )
        assert area == pytest.approx(length * (stop - start), rel=1e-12)


@pytest.mark.parametrize("limit", [100, 8, 4])
def test_the_interval_that_has_few_regions_is_the_longest_of_its_kind(unequal, limit):
    stop = readable_until(unequal, limit)
    halvings = np.log2(unequal.t_end / stop)
    assert halvings == round(halvings)
    assert len(regions_of(unequal, stop=stop)) <= limit
    if halvings:
        assert len(regions_of(unequal, stop=2 * stop)) > limit


def test_more_regions_than_a_picture_shows_are_refused_with_the_number(unequal):
    with pytest.raises(ValueError, match=r"more than 1 regions .* fewer pieces"):
        readable_until(unequal, 1)


def test_a_gauge_separates_the_waves(unequal, tmp_path):
    gauge = unequal.gauge(1, 0.5)
    assert gauge.strain == pytest.approx(gauge.rightward + gauge.leftward, abs=1e-20)
    assert gauge.times[1] == pytest.approx(0.5 / C)
    assert gauge.strain[1] == gauge.rightward[1] == pytest.approx(-0.5 / C)
    assert gauge.leftward[1] == 0
    later = (gauge.times[:-1] + gauge.times[1:]) / 2
    assert (unequal.strain(1, 0.5, later) == gauge.strain[:-1]).all()
    assert (unequal.velocity(1, 0.5, later) == gauge.velocity[:-1]).all()
    gauge.to_csv(tmp_path / "gauge.csv")
    table = np.genfromtxt(tmp_path / "gauge.csv", delimiter=",", names=True)
    assert (table["strain_1"] == gauge.strain).all()


def test_a_distant_wall_is_still_reached():
    outcome = ri.collide(rod(0.3, 1e-3), ri.Wall(), gap=10.0)
    assert outcome.restitution == pytest.approx(1.0, abs=1e-12)
    assert outcome.contacts[0].first == pytest.approx(1e4, rel=1e-12)


def test_transit_error_is_reported():
    awkward = ri.solve(ri.System([rod(1.0, 1.0), rod(1.2345678901234e-9)]), until=1e-5)
    assert awkward.transit_error > 2.0**-36
    assert "The clock rounds the transit time of bodies.1" in awkward.status


def test_public_names_are_listed_and_an_unknown_one_is_said():
    assert set(ri.__all__) <= set(dir(ri))
    with pytest.raises(AttributeError, match="nonsense"):
        _ = ri.nonsense


def test_importing_is_cheap():
    code = "import sys, rodimpact; rodimpact.__version__; print('numpy' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "False"


def test_limits_are_right_after_a_thousand_transits():
    """A float cannot name one tick of so many; a jump's own time still has two sides."""
    row = ri.System([ri.Wall(), rod(0.3, 10.0), ri.Wall()], gaps=[0.001, 0.002])
    solution = ri.solve(row, until=0.1)
    assert solution.fields.end > 2**56
    for contact in solution.contacts:
        assert len(contact.episodes) > 100
        for episode in contact.episodes[:-1]:
            for t, after in ((episode.start, 1), (episode.force_end, 0)):
                assert (contact.force(t) > 0) == after
                assert (contact.force(t, side="left") > 0) == 1 - after
    gauge = solution.gauge(1, 0.1)
    assert (solution.strain(1, 0.1, gauge.times) == gauge.strain).all()
    assert (
        solution.strain(1, 0.1, gauge.times[1:], side="left") == gauge.strain[:-1]
    ).all()


def test_bodies_moving_apart_over_any_distance():
    far = ri.solve(ri.System([rod(0.4, -1.0), rod(1.0, 1.0)], gaps=[1e13]))
    assert far.final
    assert far.outcome.velocities_after == pytest.approx((-1.0, 1.0))


def test_places_and_times_that_do_not_fit_are_named(unequal):
    with pytest.raises(ValueError, match=r"x: shape \(2,\) does not broadcast"):
        unequal.velocity(1, [0.1, 0.2], [0.0, 1e-5, 2e-5])


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"method": "characteristics"},
        {"method": "finite-difference", "cells": 20},
    ],
)
@pytest.mark.parametrize(
    "copied", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy]
)
def test_a_solution_can_be_copied_and_sent(options, copied):
    solution = ri.solve(ri.System([rod(0.4, velocity=1.0), rod(1.0)]), **options)
    again = copied(solution)
    assert again.outcome == solution.outcome
    t = np.linspace(0, solution.t_end, 9)
    assert np.array_equal(again.velocity(0, 0.1, t), solution.velocity(0, 0.1, t))
    assert np.array_equal(again.contacts[0].force(t), solution.contacts[0].force(t))


def test_to_xarray_asks_every_field_and_labels_it(mixed):
    pytest.importorskip("xarray")
    x = np.array([0.0, 0.2, 0.4, 0.8])
    t = np.array([0.0, 1e-4, 1e-3])
    data = mixed.to_xarray(x, t)
    assert dict(data.sizes) == {"body": 4, "x": 4, "time": 3, "contact": 3, "part": 12}
    assert data["kind"].values.tolist() == ["wall", "rod", "rod", "rod"]
    for name in (
        "velocity",
        "strain",
        "stress",
        "axial_force",
        "displacement",
        "position",
    ):
        fields = data[name].transpose("body", "time", "x")
        inside = (
            [1, 3, 4, 2]
            if name in ("velocity", "displacement", "position")
            else [0, 3, 4, 2]
        )
        assert np.isfinite(fields).sum("x").values.tolist() == [[n] * 3 for n in inside]
        asked = getattr(mixed, name)(2, x, t[:, None])
        assert np.array_equal(fields.sel(body=2).values, asked)
    assert np.array_equal(data["gap"].sel(contact=1), mixed.contacts[1].gap(t))
    assert np.array_equal(data["mean_velocity"].sel(body=3), mixed.mean_velocity(3, t))
    assert np.array_equal(data["energy"].sel(part="strain"), mixed.energy(t).strain)
    assert data["force"].attrs["units"] == "N"
    assert all(
        {"long_name", "units"} <= set(one.attrs) for one in data.variables.values()
    )
    with pytest.raises(
        ValueError, match=r"x\[1\]: must lie in a body, from 0 to 0.8 m, got 0.9"
    ):
        mixed.to_xarray([0.1, 0.9], t)


def test_to_xarray_of_masses_and_of_a_single_body():
    pytest.importorskip("xarray")
    struck = ri.System(
        [ri.RigidMass(0.5, velocity=2.0), rod(0.4)], contacts=[ri.Hertz(1e9)]
    )
    data = ri.solve(struck, until=1e-4).to_xarray(0.0, [0.0, 1e-4])
    assert data["velocity"].sel(body=0, x=0.0, time=0.0) == 2.0
    assert data["strain"].sel(body=0).isnull().all()
    alone = ri.solve(ri.System([rod(0.4)]), until=1e-4).to_xarray([0.1], [0.0])
    assert alone["force"].shape == (0, 1)


@pytest.mark.parametrize("short", [1e-7, 1.2345678e-7, 3.3e-7 * math.sqrt(2)])
@pytest.mark.parametrize("ratio", [1.0, 0.3])
def test_the_effect_of_rounded_transits_is_stated(short, ratio):
    """A short rod on a long one: the impulse has a closed form, and its error is that of a tick."""
    system = ri.System(
        [rod(short, 1.0), ri.Rod(1.0, area=1e-4 / ratio, material=steel)]
    )
    s = ri.solve(system)
    pieces = [body.segments[0] for body in system.bodies]
    theory = ri.theory.saint_venant(
        *(x for p in pieces for x in (p.impedance, p.transit_time))
    )
    assert s.transit_error > 2.0**-36
    for name, found, exact in (
        ("impulse", s.outcome.impulse, theory.impulse),
        ("duration", s.outcome.duration, theory.duration),
    ):
        assert 0 < abs(found / exact - 1) <= s.accuracy[name] < 1e-6
    (episode,) = s.contacts[0].episodes
    wrong = abs(episode.force_end - theory.duration) / episode.opening
    assert wrong <= s.accuracy["time"] < 1e-6
    assert "Stated relative error: " in s.status
    assert ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)])).accuracy == {}


def test_intervals_without_regions_or_with_too_many_are_refused(unequal):
    for name, wrong in (
        ("limit", {"limit": 3}),
        ("stop", {"start": 1e-5, "stop": 1e-5}),
    ):
        with pytest.raises(ValueError, match=name):
            regions_of(unequal, **wrong)


def test_families_and_what_is_no_system_are_refused():
    with pytest.raises(ri.InvalidModel, match=r"a family of shape \(2,\).*sweep"):
        ri.solve(ri.System([rod(np.array([0.1, 0.2]), 1.0), rod(1.0)]))
    with pytest.raises(ri.InvalidModel, match="system"):
        ri.solve([rod(1.0)])
