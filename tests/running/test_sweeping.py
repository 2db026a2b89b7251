"""Families of collisions: the same numbers as one at a time, whoever runs them."""

import csv
import itertools
import multiprocessing
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import problems
from networks import random_network
from systems import MATERIALS, with_ends

import rodimpact as ri
from rodimpact import theory
from rodimpact.methods import compiling, kernels
from rodimpact.methods.run import ALSO
from rodimpact.running.jobs import SerialExecutor

STEEL = ri.materials.steel


def pair(lengths, areas, velocity=1.0):
    """A striker of these lengths and a rod of 1 m of these areas, which broadcast; not
    solved.
    """
    striker = ri.Rod(lengths, area=1e-4, material=STEEL, velocity=velocity)
    struck = ri.Rod(1.0, area=areas, material=STEEL)
    return ri.System([striker, struck])


def small_map(n_lengths=7, n_areas=5):
    """A family [length of the striker, area of the struck rod]; not solved."""
    lengths = np.linspace(0.1, 1.3, n_lengths)[:, np.newaxis]
    areas = np.geomspace(2e-5, 8e-4, n_areas)
    return pair(lengths, areas)


def have_same_bits(first, second):
    """Whether all columns of two sweeps of one family are equal bit for bit.

    They must have the same names.
    """
    first_columns = first.columns
    second_columns = second.columns
    assert first_columns.keys() == second_columns.keys()
    for name, column in first_columns.items():
        other_column = second_columns[name]
        if column.tobytes() != other_column.tobytes():
            return False
    return True


def swings_for_ever(system):
    """Whether a body of the system is held at a wall by a law that never opens, so that
    it may swing for ever.
    """
    neighbours = itertools.pairwise(system.bodies)
    for law, (left, right) in zip(system.contacts, neighbours, strict=True):
        is_beside_a_wall = isinstance(left, ri.Wall) or isinstance(right, ri.Wall)
        if is_beside_a_wall and not law.opens:
            return True
    return False


CONTACT_TOTALS = ("impulse", "peak_force", "duration", "episodes")


def assert_equal_to_one_at_a_time(result, **options):
    """Compare each member with a run of its own.

    The columns of its outcome are equal bit for bit, the energy left in vibration to
    round-off.

    A contact that presses for ever has no totals, and a system that swings for ever has
    no vibration after the collision: these are left out.
    """
    for index in np.ndindex(result.shape):
        outcome = ri.solve(result.system[index], **options).outcome
        member = {name: column[index] for name, column in result.columns.items()}
        for i, velocity in enumerate(outcome.velocities_after):
            assert member[f"velocity_after.{i}"] == velocity
        if "goes on pressing" not in outcome.status:
            assert_same_totals(member, outcome.contacts)
        assert member["final"] == outcome.final
        if not swings_for_ever(result.system):
            assert_same_vibration(member, outcome)
        if outcome.why_no_restitution():
            assert np.isnan(member["restitution"])
        else:
            assert member["restitution"] == outcome.restitution


def assert_same_totals(member, contacts):
    """Columns of a member of a sweep are bit for bit the totals of the contacts of a
    run.
    """
    for k, contact in enumerate(contacts):
        for name in CONTACT_TOTALS:
            total = member[f"{name}.{k}"]
            expected = getattr(contact, name)
            assert np.array_equal(total, expected, equal_nan=True)


def assert_same_vibration(member, outcome):
    """The column of vibration energy is the sum over the bodies of a run."""
    energy_before = outcome.kinetic_before + sum(outcome.vibration_before)
    vibration = sum(outcome.vibration_after)
    round_off = 1e-14 * energy_before
    assert member["vibration"] == pytest.approx(vibration, rel=1e-12, abs=round_off)


# Numbers
# --------------------------------------------------------------------------------------


def test_restitution_and_impulse_of_a_map_equal_the_closed_form():
    """A map of 60 lengths and 50 areas is swept: all members are final, restitution and
    impulse are those of Saint-Venant to 1e-11.
    """
    family = small_map(n_lengths=60, n_areas=50)
    striker = family.bodies[0].segments[0]
    struck = family.bodies[1].segments[0]
    exact = theory.saint_venant(
        striker.impedance,
        striker.transit_time,
        struck.impedance,
        struck.transit_time,
        closing_speed=1.0,
    )

    result = ri.sweep(family)

    assert result.shape == (60, 50)
    assert result.final.all()
    statuses = set(result.status.ravel())
    assert statuses == {"final"}
    errors = np.abs(result.restitution - exact.restitution)
    assert errors.max() < 1e-11
    np.testing.assert_allclose(result.impulse, exact.impulse, rtol=1e-11)


def random_family(seed, driven):
    """A family of a random row, whose shape is at most [2, 6]. Velocities, strains,
    drives, with the positions and times of their jumps, and gaps become arrays of 6;
    some areas become arrays [2, 1].
    """
    rng = np.random.default_rng(seed)
    data = with_ends(seed, driven).to_dict()

    def vary(fields, name):
        """Vary the entry of this name in place, if there is one: a number, or the first
        value and all jumps of steps.
        """
        value = fields.get(name)
        if isinstance(value, float):
            fields[name] = value * rng.uniform(-1, 1, 6)
        elif name in fields:
            factors = rng.uniform(0.3, 1, 6)
            first, *later_values = value["values"]
            value["values"] = [first * factors, *later_values]
            value["at"] = [jump * factors for jump in value["at"]]

    for end in data.get("ends", {}).values():
        vary(end, "value")
    for body in data["bodies"]:
        vary(body, "velocity")
        vary(body, "strain")
        segments = body.get("segments", [])
        if body["kind"] == "rod" and not segments:
            segments = [body]  # a uniform rod has its own area
        for segment in segments:
            if rng.random() < 0.5:
                segment["area"] = segment["area"] * rng.uniform(0.5, 2, (2, 1))
    for contact in data["contacts"]:
        if contact["law"] == "rigid":
            contact["gap"] = contact["gap"] * rng.uniform(0, 2, 6).round()
    return ri.System.from_dict(data)


ON_GRID = {"method": "finite-difference", "cells": 20}


@pytest.mark.parametrize(
    ("law", "options"),
    [
        (ri.Bonded(), {}),
        (ri.Bonded(), {"until": 1e-3}),
        (ri.Joint(stiffness=1e9), {"until": 1e-3, **ON_GRID}),
    ],
    ids=["bond", "bond until", "joint on a grid"],
)
def test_bonds_and_joints_have_the_totals_of_single_runs(law, options):
    """A contact that cannot open has an impulse and a peak force."""
    lengths = np.array([0.3, 0.5])
    rods = [
        ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1.0),
        ri.Rod(1.0, area=1e-4, material=STEEL),
        ri.Rod(0.7, area=2e-4, material=STEEL),
    ]
    family = ri.System(rods, contacts=[ri.Rigid(), law])

    result = ri.sweep(family, **options)

    peak_forces = result.contacts[1].peak_force  # of the contact that cannot open
    assert (peak_forces > 0).all()
    assert_equal_to_one_at_a_time(result, **options)


def mean_of(profile):
    """Mean of a number, or of the values of steps or samples."""
    values = getattr(profile, "values", profile)
    return float(np.mean(values))


def family_of_network(seed):
    """Two members of a random row: masses, laws, ends, gravity.

    Areas, strains and gaps vary. Profiles are replaced by their means.
    """
    system = random_network(seed, bodies=3, driven=seed % 2 == 1)
    factors = np.array([1.0, 0.9])

    bodies = []
    for body in system.bodies:
        if isinstance(body, ri.Rod):
            segments = []
            for segment in body.segments:
                segments.append(segment.replace(area=segment.area * factors))
            body = ri.Rod(
                segments=segments,
                velocity=mean_of(body.velocity),
                strain=mean_of(body.strain) * factors,
            )
        bodies.append(body)
    ends = []
    for end in system.ends:
        if isinstance(end, ri.Pushed | ri.Moved):
            end = type(end)(mean_of(end.value))
        ends.append(end)
    gaps = [gap * factors for gap in system.gaps]
    return ri.System(bodies, gaps, system.contacts, gravity=system.gravity, ends=ends)


@pytest.mark.parametrize("seed", few_of(range(0, 300, 25), range(75, 300, 75)))
def test_members_of_characteristics_equal_one_at_a_time_compiled_and_plain(seed):
    """Members of a random family by characteristics equal those solved one at a time,
    and have the same bits in plain Python.
    """
    system = family_of_network(seed)
    options = {"method": "characteristics", "until": 1.5, "rtol": 1e-2}
    with kernels.forced(compiling=True):
        result = ri.sweep(system, **options)
        assert_equal_to_one_at_a_time(result, **options)

    # Plain Python takes long: these runs are shorter.
    with kernels.forced(compiling=True):
        compiled = ri.sweep(system, "characteristics", until=0.5)
    with kernels.forced(compiling=False):
        plain = ri.sweep(system, "characteristics", until=0.5, workers=1)
    assert have_same_bits(plain, compiled)


MAX_MEMBERS_PER_CALL = "rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL"


@pytest.mark.parametrize("members", [5, 8, 14])
def test_a_family_of_35_in_chunks_of_any_size_has_the_members_of_single_runs(
    monkeypatch, members
):
    """A map is swept in chunks of `members`: each member equals its single run."""
    monkeypatch.setattr(MAX_MEMBERS_PER_CALL, members)
    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER", 1)

    result = ri.sweep(small_map(), workers=1)

    assert_equal_to_one_at_a_time(result)


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_columns_are_the_same_bits_whatever_the_number_of_workers(method):
    """All columns of a sweep by 1, 2, 3 and 12 workers are equal, and equal to those of
    a sweep of each row of the family alone. Sums in them, such as the vibration energy,
    would depend on the order in which members are run.
    """
    family = small_map(n_lengths=6, n_areas=2)
    one_worker = ri.sweep(family, method, workers=1)

    for workers in (2, 3, 12):
        result = ri.sweep(family, method, workers=workers)
        assert have_same_bits(result, one_worker)
    rows = [ri.sweep(family[i], method, workers=1) for i in range(6)]
    for name, column in one_worker.columns.items():
        columns_of_rows = [row.columns[name] for row in rows]
        assert np.array_equal(column, columns_of_rows, equal_nan=True)


def test_a_long_member_goes_on_in_machine_code_to_the_same_bits(monkeypatch):
    """The time that it has spent grows while it runs, until compiling pays."""
    system = pair(lengths=np.array([0.4, 0.41421356, 0.43]), areas=3e-4)
    with kernels.forced(compiling=False):
        plain = ri.sweep(system, until=0.02, workers=1)
    seconds_spent = []
    compiled = []
    compile_kernel = compiling.compiled

    def pays_at_the_fourth_question(seconds, kernel, ahead=0.0):
        seconds_spent.append(seconds)
        return len(seconds_spent) > 3

    def note_and_compile(kernel, user_laws=()):
        compiled.append(kernel)
        return compile_kernel(kernel, user_laws)

    monkeypatch.setattr(kernels, "worth_compiling", pays_at_the_fourth_question)
    monkeypatch.setattr(compiling, "compiled", note_and_compile)

    result = ri.sweep(system, until=0.02, workers=1)

    # The first question is asked before any member runs.
    _, *seconds_while_running = seconds_spent[:4]
    assert have_same_bits(result, plain)
    assert seconds_while_running == sorted(seconds_while_running)
    assert len(compiled) == 1  # all members run in one block, which began in Python


def test_a_single_collision_is_a_family_without_axes():
    """A sweep of a single system has the shape (), no axes, the restitution of `solve`,
    and its explanation.
    """
    system = pair(0.4, 1e-4)
    outcome = ri.solve(system).outcome

    result = ri.sweep(system)

    assert result.shape == ()
    assert result.axes == ()
    restitution = float(result.restitution)
    assert restitution == outcome.restitution
    only_member = ()  # its index
    explanation = result.explain(only_member)
    assert explanation.startswith("The collision is final")


@pytest.mark.parametrize("is_compiled", [False, True])
def test_members_that_outgrow_the_log_have_the_same_bits(monkeypatch, is_compiled):
    """A family of three rods is swept with a log that begins with a single row and has
    to grow; the columns have the bits of a sweep with the usual log.
    """
    lengths = 0.1 * np.sqrt([2, 3, 5, 7])  # no common unit, so that fronts multiply
    striker = ri.Rod(lengths, area=1e-4, material=MATERIALS[0], velocity=1.0)
    middle = ri.Rod(0.13, area=3e-4, material=MATERIALS[1])
    last = ri.Rod(0.17, area=5e-4, material=MATERIALS[0], velocity=-1.0)
    system = ri.System([striker, middle, last])
    with_usual_log = ri.sweep(system)
    monkeypatch.setattr("rodimpact.methods.fronts.batch.INITIAL_LOG_ROWS", 1)

    with kernels.forced(is_compiled):
        result = ri.sweep(system)

    assert have_same_bits(result, with_usual_log)


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_blocks_may_run_in_plain_python_and_then_compiled(monkeypatch):
    """Blocks of a sweep run in plain Python and compiled in turn: the bits are those of
    a usual sweep, and the estimate of the remaining time falls.
    """
    family = small_map(n_lengths=10, n_areas=10)
    plain = ri.sweep(family)
    seconds_ahead = []

    def in_turns(seconds, kernel, ahead=0.0):
        seconds_ahead.append(ahead)
        return len(seconds_ahead) % 2 == 0

    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER", 1)
    monkeypatch.setattr("rodimpact.methods.fronts.driver.BLOCK_TIME", 0.0)
    monkeypatch.setattr("rodimpact.methods.fronts.driver.FIRST_BLOCK_SIZE", 8)
    monkeypatch.setattr(kernels, "worth_compiling", in_turns)

    result = ri.sweep(family, workers=1)

    assert have_same_bits(result, plain)
    assert len(seconds_ahead) > 9  # members ran in ten blocks or more
    # The time that the other members will take gets shorter.
    assert max(seconds_ahead) > seconds_ahead[-1]


# Runs to a time
# --------------------------------------------------------------------------------------


def chain():
    """A family of three: ten rods with gaps, the first of three lengths, which collide
    again and again; not swept.
    """
    struck = [ri.Rod(0.1, area=1e-4, material=STEEL)] * 9
    lengths = np.linspace(0.05, 0.5, 3)
    striker = ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1.0)
    return ri.System([striker, *struck], gaps=[1e-4] * 9)


@pytest.mark.parametrize("seed", few_of(range(20), [1, 4]))
@pytest.mark.parametrize("until", few_of([None, 0.0, 1.4e-4, 1.86e-3], [None, 1.4e-4]))
def test_members_of_random_rows_equal_one_at_a_time(seed, until):
    """Members of a random family by fronts, compiled or not, equal those solved one at
    a time; incomplete are exactly those that the cap on events stopped.
    """
    system = random_family(seed, driven=until is not None)
    options = {"until": until, "max_events": 2000, "method": "fronts"}
    is_compiled = seed % 4 != 0  # one seed in four runs in plain Python
    with kernels.forced(is_compiled):
        result = ri.sweep(system, **options)
    assert_equal_to_one_at_a_time(result, **options)
    is_capped = result.status == "max_events"
    assert result.incomplete.tolist() == is_capped.tolist()


def test_a_member_that_stops_early_keeps_what_is_known():
    """Three members stop at 200 events: incomplete, without e, explained, and equal to
    single runs.
    """
    result = ri.sweep(chain(), max_events=200)
    statuses = result.status.tolist()
    assert statuses == ["max_events"] * 3
    assert result.incomplete.all()
    assert np.isnan(result.restitution).all()
    assert "cap of 200" in result.explain(0)
    assert_equal_to_one_at_a_time(result, max_events=200)


@pytest.mark.parametrize(("method", "cap"), [("fronts", 3), ("characteristics", 10)])
def test_a_cap_after_the_proof_is_not_why_a_run_ended(method, cap):
    """The cap on events cuts the vibration that a single run shows after the proof: run
    and member of a sweep are "final", and the status of the run names the cap.
    """
    system = pair(lengths=np.array([0.4]), areas=1e-4)

    result = ri.sweep(system, method, max_events=cap)
    solution = ri.solve(system[0], method=method, max_events=cap)

    assert f"The cap of {cap}" in solution.status
    assert solution.stopped_by == "final"
    assert result.status[0] == "final"
    assert solution.final
    assert result.final[0]


def stepped_rod_on_a_wall():
    """A family of two rods of two segments that strike a wall."""
    areas = np.array([1e-4, 2e-4])
    first = ri.Segment(0.1, areas, STEEL)
    second = ri.Segment(0.2, 2e-4, STEEL)
    strain = ri.Steps([1e-5, 0.0], [0.15])
    rod = ri.Rod(segments=[first, second], velocity=-1.0, strain=strain)
    return ri.System([ri.Wall(), rod])


def mass_rod_and_wall():
    """A mass of two velocities above a rod on a wall."""
    mass = ri.RigidMass(0.1, velocity=np.array([1.0, 2.0]))
    rod = ri.Rod(0.5, area=1e-4, material=STEEL)
    return ri.System([mass, rod, ri.Wall()], gravity=9.81)


def rod_on_a_wall():
    """A rod of two velocities on a wall."""
    velocities = np.array([1.0, 2.0])
    rod = ri.Rod(0.3, area=1e-4, material=STEEL, velocity=velocities)
    return ri.System([rod, ri.Wall()])


def test_a_cap_before_the_time_asked_for_is_reported_although_the_outcome_is_final():
    """Two members are final, but the cap stops them before `until`: status and
    explanation say so.
    """
    system = pair(lengths=np.array([0.4, 0.7]), areas=1e-4)
    result = ri.sweep(system, until=1.0, max_events=500)
    assert result.final.all()
    statuses = result.status.tolist()
    assert statuses == ["max_events"] * 2
    assert "cap of" in result.explain(1)


# Strain gauges
# --------------------------------------------------------------------------------------

PLACES = [(0, 0.05), (1, 0.5), (1, 0.0), (0, 0.1)]  # body and coordinate, m
TIMES = np.linspace(0.0, 4e-4, 41)  # s


@pytest.mark.parametrize(
    ("system", "options", "gauges"),
    [
        pytest.param(
            small_map(n_lengths=3, n_areas=2), {"until": 3e-4}, PLACES, id="four gauges"
        ),
        pytest.param(
            small_map(n_lengths=3, n_areas=2),
            {},
            [(1, 0.7)],
            id="to the end",
            marks=pytest.mark.exhaustive,
        ),
        pytest.param(
            stepped_rod_on_a_wall(),
            {"until": 4e-4},
            [(1, 0.1), (1, 0.25)],
            id="stepped rod",
            marks=pytest.mark.exhaustive,
        ),
        pytest.param(
            mass_rod_and_wall(), {"until": 3e-4}, [(1, 0.2)], id="characteristics"
        ),
        pytest.param(
            rod_on_a_wall(), {"until": 3e-4, **ON_GRID}, [(0, 0.1), (0, 0.3)], id="grid"
        ),
    ],
)
def test_gauges_equal_those_of_single_solutions_and_change_no_column(
    system, options, gauges
):
    """Strains after the end of a run are nan."""
    without_gauges = ri.sweep(system, **options)

    result = ri.sweep(system, gauges=gauges, times=TIMES, **options)

    assert have_same_bits(result, without_gauges)
    assert result.gauges == tuple(gauges)
    assert result.times.tolist() == TIMES.tolist()
    strains = result.strain  # [*member, gauge, time]
    assert strains.shape == (*system.shape, len(gauges), len(TIMES))
    assert np.nanmax(np.abs(strains)) > 0
    for index in np.ndindex(system.shape):
        solution = ri.solve(system[index], **options)
        is_in_run = solution.t_end * (1 + 1e-12) >= TIMES
        times_in_run = TIMES[is_in_run]
        for gauge, (body, x) in enumerate(gauges):
            strain = strains[index][gauge]  # [time]
            expected = solution.gauge(body, x).strain_at(times_in_run)
            assert strain[is_in_run].tolist() == expected.tolist()
            assert np.isnan(strain[~is_in_run]).all()


def test_a_refused_member_has_no_strain():
    system = pair(lengths=np.array([0.5, 1e-13]), areas=1e-4)  # too short for a clock
    result = ri.sweep(system, gauges=[(1, 0.5)], times=TIMES)
    has_no_strain = np.isnan(result.strain).all(axis=(1, 2))  # [member]
    assert has_no_strain.tolist() == [False, True]


@pytest.mark.parametrize(
    ("options", "path"),
    [
        ({"times": TIMES}, "times"),
        ({"gauges": [(1, 0.5)], "times": [-1.0]}, "times[0]"),
        ({"gauges": [(2, 0.5)], "times": TIMES}, "gauges.0.body"),
        ({"gauges": [(1, 0.5), (1.0, 0.5)], "times": TIMES}, "gauges.1.body"),
        ({"gauges": [(0, 0.3)], "times": TIMES}, "gauges.0.x"),
        ({"gauges": [(1, [0.1, 0.2])], "times": TIMES}, "gauges.0.x"),
    ],
)
def test_wrong_gauges_and_times_are_named(options, path):
    system = pair(np.array([0.4, 0.2]), 1e-4)
    messages = problems(lambda: ri.sweep(system, **options))
    assert list(messages) == [path]


@pytest.fixture(scope="module")
def result_with_gauge():
    """A family of shape (3, 2) with one gauge."""
    return ri.sweep(
        small_map(n_lengths=3, n_areas=2), until=3e-4, gauges=[(1, 0.5)], times=TIMES
    )


def test_gauges_are_saved_and_loaded_bit_for_bit(tmp_path, result_with_gauge):
    path = tmp_path / "family.npz"

    result_with_gauge.save(path)
    loaded = ri.load(path)

    assert loaded.strain.tobytes() == result_with_gauge.strain.tobytes()
    assert loaded.gauges == result_with_gauge.gauges
    assert loaded.options == result_with_gauge.options
    assert loaded.times.tolist() == TIMES.tolist()


def test_gauges_of_a_dataset_have_dimensions_places_and_units(result_with_gauge):
    """The xarray dataset of a map with a gauge has the strain by length, area, gauge
    and time, with its values, body and x of the gauge; every variable has a name and a
    unit.
    """
    pytest.importorskip("xarray")
    k = 30  # index of a time within the run

    data = result_with_gauge.to_xarray()

    strain = data["strain"]
    dimensions = ("bodies.0.length", "bodies.1.area", "gauge", "time")
    assert strain.dims == dimensions
    strain_at_time = strain.sel(time=TIMES[k]).isel(gauge=0).values  # [length, area]
    expected = result_with_gauge.strain[:, :, 0, k]
    assert strain_at_time.tolist() == expected.tolist()
    assert np.isfinite(strain_at_time).all()
    # The gauge of the fixture is 0.5 m along body 1.
    bodies_of_gauges = data["body"].values.tolist()
    x_of_gauges = data["x"].values.tolist()
    assert bodies_of_gauges == [1]
    assert x_of_gauges == [0.5]
    for variable in data.variables.values():
        assert {"long_name", "units"} <= set(variable.attrs)


# Members without a result
# ------------------------------------------------------------------------


def test_a_refused_member_has_no_numbers_and_the_others_have_theirs():
    """One of 100 x 100 members has transit times too far apart for one clock: it is not
    final, explained, and nan in six columns; all others have e = l1/l2.
    """
    length = 0.5
    short = (33, 33)
    lengths = np.full((100, 100), length)
    lengths[short] = 1e-13

    result = ri.sweep(pair(lengths, areas=1e-4))

    is_refused = result.status != "final"
    refused_indices = np.argwhere(is_refused).tolist()
    assert refused_indices == [list(short)]
    assert not result.final[short]
    explanation = result.explain(short)
    assert "too short beside the longest" in explanation
    restitution_of_others = result.restitution[~is_refused]
    expected = length / 1.0  # l1/l2
    np.testing.assert_allclose(restitution_of_others, expected, atol=1e-15)
    for name in (
        "restitution",
        "velocity_after.0",
        "impulse.0",
        "vibration",
        "peak_force.0",
        "duration.0",
    ):
        column = result.columns[name]
        assert np.isnan(column[short])


def test_members_that_do_not_collide_have_no_restitution_and_no_episode():
    """Of three velocities, one approaches: the other two members have a restitution of
    nan, no episode, and an explanation; all are final.
    """
    velocities = np.array([1.0, -1.0, 0.0])  # the second moves away, the third rests
    result = ri.sweep(pair(0.4, 1e-4, velocity=velocities))
    has_no_restitution = np.isnan(result.restitution).tolist()
    assert has_no_restitution == [False, True, True]
    assert result.final.all()
    episodes = result.episodes.tolist()
    assert episodes == [1, 0, 0]
    assert "move apart" in result.explain(1)


@pytest.mark.parametrize(
    ("options", "path"),
    [
        ({"method": "magic"}, "method"),
        ({"progress": None}, "progress"),
        ({"workers": 0}, "workers"),
        ({"max_events": 1.5}, "max_events"),
        ({"executor": object()}, "executor"),
        ({"executor": "processes"}, "executor"),
        ({"executor": 4}, "executor"),
        ({"executor": ProcessPoolExecutor}, "executor"),
    ],
)
def test_wrong_arguments_are_named(options, path):
    messages = problems(lambda: ri.sweep(pair(0.4, 1e-4), **options))
    assert list(messages) == [path]


# Executors
# --------------------------------------------------------------------------------------


@pytest.fixture
def small_chunks(monkeypatch):
    """Families are run in chunks of four members, so that small ones have many."""
    monkeypatch.setattr(MAX_MEMBERS_PER_CALL, 4)


def test_every_executor_gives_the_same_bytes(small_chunks):
    """A serial executor, compiled code, one worker, five workers and a process pool are
    compared.
    """
    family = small_map()
    serial = ri.sweep(family, executor=SerialExecutor())
    with kernels.forced(compiling=True):
        compiled = ri.sweep(family)
    assert have_same_bits(compiled, serial)

    readings = {"until": 3e-4, "gauges": [(0, 0.05), (1, 0.5)], "times": TIMES}
    serial_readings = ri.sweep(family, executor=SerialExecutor(), **readings)
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        for runner in ({"workers": 1}, {"workers": 5}, {"executor": pool}):
            result = ri.sweep(family, **runner)
            result_with_readings = ri.sweep(family, **readings, **runner)
            strain = result_with_readings.strain
            assert have_same_bits(result, serial)
            assert have_same_bits(result_with_readings, serial_readings)
            assert strain.tobytes() == serial_readings.strain.tobytes()


@pytest.mark.exhaustive
def test_a_dask_cluster_gives_the_same_bytes(small_chunks):
    """A map that is swept by a local dask cluster of two workers has the bits of a
    serial sweep.
    """
    distributed = pytest.importorskip("distributed")
    family = small_map()
    serial = ri.sweep(family, executor=SerialExecutor())
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        with (
            distributed.LocalCluster(
                n_workers=2,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            result = ri.sweep(family, executor=client.get_executor())
    assert have_same_bits(result, serial)


def test_progress_counts_collisions(small_chunks):
    """`progress` is called with the number of members done and of all, in rising order."""
    members = 7 * 5
    counts = []

    def note(done, total):
        assert total == members
        counts.append(done)

    ri.sweep(small_map(n_lengths=7, n_areas=5), progress=note)

    assert counts == sorted(counts)
    assert counts[-1] == members


def test_axes_and_parameters_have_the_names_of_a_case_file():
    """A sweep over lengths, gaps and areas of a segment has axes in this order, named
    by their paths, with their values.
    """
    lengths = np.linspace(0.1, 0.4, 4)[:, None, None]
    gaps = np.array([0.0, 1e-5, 2e-5])[:, None]
    areas = np.array([1e-4, 2e-4])
    striker = ri.Rod(lengths, area=1e-4, material=STEEL, velocity=1)
    segments = [ri.Segment(0.2, areas, STEEL), ri.Segment(0.2, 1e-4, STEEL)]
    system = ri.System([striker, ri.Rod(segments=segments)], gaps=[gaps])

    result = ri.sweep(system)

    assert result.shape == (4, 3, 2)
    names = [axis.name for axis in result.axes]
    assert names == ["bodies.0.length", "contacts.0.gap", "bodies.1.segments.0.area"]
    axis_of_areas = result.axes[2]
    assert axis_of_areas.values.tolist() == areas.tolist()
    assert set(result.parameters) == set(names)


def test_csv_holds_every_digit(tmp_path):
    """The CSV file of a map has its areas and restitutions bit for bit, parameters
    first and the status last.
    """
    result = ri.sweep(small_map(n_lengths=3, n_areas=2))
    path = tmp_path / "map.csv"

    result.to_csv(path)

    with path.open() as file:
        rows = list(csv.DictReader(file))
    first_row = rows[0]
    first_columns = list(first_row)[:3]
    assert first_columns == ["bodies.0.length", "bodies.1.area", "restitution"]
    *_, status = first_row.values()
    assert status == "final"
    areas = [float(row["bodies.1.area"]) for row in rows]
    areas_of_a_length = result.axes[1].values.tolist()
    assert areas == areas_of_a_length * 3  # there are three lengths
    restitutions = [float(row["restitution"]) for row in rows]
    assert restitutions == result.restitution.ravel().tolist()


@pytest.fixture(scope="module")
def result_of_six():
    """A swept family of shape (3, 2)."""
    return ri.sweep(small_map(n_lengths=3, n_areas=2))


def test_a_family_shows_its_shape_and_axes(result_of_six):
    text = "<SweepResult of shape (3, 2) over bodies.0.length, bodies.1.area>"
    assert repr(result_of_six) == text


def test_a_data_frame_has_a_row_for_each_member(result_of_six):
    pytest.importorskip("pandas")
    frame = result_of_six.to_dataframe()
    restitutions = result_of_six.restitution.ravel()
    assert frame["restitution"].tolist() == restitutions.tolist()
    assert set(frame["status"]) == {"final"}


def test_a_dataset_has_coordinates_names_and_units(result_of_six):
    """The xarray dataset of a map has restitutions by area and length, statuses, and
    names and units of its variables.
    """
    pytest.importorskip("xarray")
    data = result_of_six.to_xarray()
    of_thinnest = data["restitution"].sel({"bodies.1.area": 2e-5})
    expected = result_of_six.restitution[:, 0]  # the first area is the smallest
    assert of_thinnest.values.tolist() == expected.tolist()
    statuses = data["status"].values.tolist()
    assert statuses == [["final"] * 2] * 3
    velocity = data["velocity_after.1"]
    length = data["bodies.0.length"]
    assert velocity.attrs == {"long_name": "velocity of rod 2 after", "units": "m/s"}
    assert length.attrs == {"long_name": "length of rod 1", "units": "m"}


def test_a_number_that_varies_is_labelled_in_a_row_of_several_contacts():
    """In the dataset of three rods, the varied length and the impulse of the second
    contact have their names.
    """
    pytest.importorskip("xarray")
    striker = ri.Rod(np.array([0.2, 0.4]), area=1e-4, material=STEEL, velocity=1.0)
    struck = ri.Rod(0.4, area=1e-4, material=STEEL)
    system = ri.System([striker, struck, struck])

    data = ri.sweep(system).to_xarray()

    length = data["bodies.0.length"].attrs
    impulse = data["impulse.1"].attrs
    assert length["long_name"] == "length of rod 1"
    assert impulse["long_name"] == "impulse at contact 2-3"


def test_a_missing_package_is_named(monkeypatch):
    result = ri.sweep(pair(0.4, 1e-4))
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install 'rodimpact\[dataframe\]'"):
        result.to_dataframe()


@pytest.mark.parametrize("selected", ["by a mask", "by a slice"])
@pytest.mark.parametrize("keep", [False, True])
def test_a_family_with_no_members_is_refused_before_a_checkpoint_is_made(
    tmp_path, selected, keep
):
    """A family without members, by a mask or a slice, is refused with its shape, and no
    folder is made for a checkpoint.
    """
    family = small_map()
    if selected == "by a mask":
        nowhere = np.zeros(family.shape, dtype=bool)
        empty = family[nowhere]
    else:
        empty = family[:0]
    options = {}
    if keep:
        options["checkpoint"] = tmp_path / "kept"

    with pytest.raises(ri.InvalidModel, match="system: has no members, its shape is"):
        ri.sweep(empty, **options)

    assert not (tmp_path / "kept").exists()


# What is asked for besides
# ------------------------------------------------------------------------


def steel_rod(length, velocity=0.0, area=1e-4, **strain):
    """A rod of steel, at rest and of 1 cm^2 unless given otherwise."""
    return ri.Rod(length, area=area, material=STEEL, velocity=velocity, **strain)


LENGTHS = np.array([0.3, 0.77])


def bonded_rods_and_wall():
    """Strikers of `LENGTHS`, and a rod that is bonded to a moving wall; not solved."""
    striker = steel_rod(LENGTHS, 1.0)
    struck = steel_rod(1.0, area=3e-4)
    gaps = [1e-5, 0.0]
    laws = [ri.Rigid(), ri.Bonded()]
    return ri.System([striker, struck, ri.Wall(-0.1)], gaps, laws)


def vibrating_pair():
    """Rods of `LENGTHS` with steps of velocity and strain, beside a rod at rest; not
    solved.
    """
    velocity = ri.Steps([1.0, 0.0, 2.0], at=[0.1, 0.2])
    strain = ri.Steps([1e-4, 0.0], at=[0.15])
    vibrating = steel_rod(LENGTHS, velocity, strain=strain)
    return ri.System([vibrating, steel_rod(1.0)])


def driven_pair():
    """Rods of `LENGTHS` pushed for 0.1 ms, beside one whose far end absorbs all waves;
    not solved.
    """
    force = ri.Steps([1e3, 0.0], at=[1e-4])
    ends = (ri.Pushed(force), ri.Absorbing())
    rods = [steel_rod(LENGTHS), steel_rod(1.0)]
    return ri.System(rods, ends=ends)


@pytest.mark.parametrize("compiling", few_of([False, True], [True]))
@pytest.mark.parametrize(
    "system",
    [bonded_rods_and_wall(), vibrating_pair(), driven_pair()],
    ids=["bond and wall", "vibration", "drive"],
)
@pytest.mark.parametrize("until", few_of([4e-5, 1e-3], [1e-3]))
def test_mean_displacements_and_largest_stresses_are_those_of_another_method_and_fields(
    system, until, compiling
):
    """Further readings of a sweep by fronts equal those by characteristics and, for the
    second member, those from its fields; nothing is dissipated.
    """
    with kernels.forced(compiling):
        result = ri.sweep(system, until=until, also=ALSO)

    assert result.method == "fronts"
    assert not result.dissipated.any()
    assert_readings_are_those_of_characteristics(result, until)
    assert_readings_of_second_member_are_those_of_fields(result, until)


def assert_readings_are_those_of_characteristics(result, until):
    """Compare mean displacements and largest stresses of all members and bodies with
    those of another method; a wall has no stress.
    """
    system = result.system
    by_pieces = ri.sweep(system, "characteristics", until=until, also=ALSO, rtol=1e-6)
    for i, body in enumerate(system.bodies):
        displacement = result.displacements[i]  # m [member]
        expected_displacement = by_pieces.displacements[i]
        np.testing.assert_allclose(
            displacement, expected_displacement, rtol=1e-5, atol=1e-9
        )
        if isinstance(body, ri.Wall):
            assert i not in result.largest_stresses
            continue
        stress = result.largest_stresses[i]  # Pa [member]
        expected_stress = by_pieces.largest_stresses[i]
        np.testing.assert_allclose(stress, expected_stress, rtol=1e-5, atol=1.0)


def assert_readings_of_second_member_are_those_of_fields(result, until):
    """Compare mean displacements and largest stresses of the rods of the second member
    with those of fields on fine grids of places and times.
    """
    member = result.system[1]
    solution = ri.solve(member, until=until)
    times = np.linspace(0, solution.t_end, 1001)
    for i, body in enumerate(member.bodies):
        if isinstance(body, ri.Wall):
            continue
        length = float(body.length)
        x = np.linspace(0, length, 2001)
        at_start = solution.displacement(i, x, 0.0)
        at_end = solution.displacement(i, x, solution.t_end)
        mean_displacement = np.trapezoid(at_end - at_start, x) / length
        stress = solution.stress(i, x[::10, None], times)  # [place, time], Pa
        largest_stress = np.abs(stress).max()
        displacement = result.displacements[i][1]
        assert displacement == pytest.approx(mean_displacement, rel=1e-4, abs=1e-9)
        stress_of_member = result.largest_stresses[i][1]
        assert stress_of_member == pytest.approx(largest_stress, rel=1e-9)


def test_the_displacement_of_a_pile_counts_the_soil_along_its_shaft():
    """The mean displacement of a pile in soil, from a sweep, is the integral over that
    of its solution, and less than 0.9 of that without soil.
    """
    soil = ri.Soil(resistance=4e5, quake=2.5e-3)
    length = 15.0
    speeds = np.array([1.0, 2.0])
    pile = ri.Rod(length, area=0.0094, material=STEEL, velocity=speeds, shaft=soil)
    family = ri.System([pile])
    until = 3e-3

    result = ri.sweep(family, until=until, cells=50, also=["displacement"])

    x = np.linspace(0.0, length, 2001)
    solution = ri.solve(family[1], until=until, cells=50)
    mean_displacement = np.trapezoid(solution.displacement(0, x, until), x) / length
    without_soil = speeds[1] * until
    displacement = result.displacements[0][1]
    assert displacement == pytest.approx(mean_displacement, rel=1e-6)
    assert displacement < 0.9 * without_soil


def test_ground_that_yields_takes_the_yield_force_times_the_set():
    """The slow pile of two leaves the ground elastic. Stresses are not asked for."""
    yield_force = 1.8e4
    speeds = np.array([0.1, 5.0])
    pile = ri.Rod(1.0, area=1e-3, material=STEEL, velocity=speeds)
    ground = ri.Yielding(stiffness=1e8, yield_force=yield_force)
    system = ri.System([pile, ri.Wall()], contacts=[ground])

    result = ri.sweep(system, until=8e-3, also=["dissipated", "set"])

    slow_set, fast_set = result.sets[0]
    assert slow_set == pytest.approx(0.0, abs=1e-12)
    assert fast_set > 1e-4
    work = yield_force * result.sets[0]
    np.testing.assert_allclose(result.dissipated, work, rtol=1e-6, atol=1e-6)
    with pytest.raises(ValueError, match="largest_stress: was not asked for"):
        _ = result.largest_stresses


def test_readings_that_are_asked_for_are_in_tables_datasets_and_files(tmp_path):
    """A sweep with further readings has them as columns in CSV, with units in the
    dataset, and bit for bit in a loaded file.
    """
    lengths = np.array([0.2, 0.4])
    path = tmp_path / "family.npz"
    units = {"dissipated": "J", "largest_stress.0": "Pa", "displacement.1": "m"}

    result = ri.sweep(pair(lengths, 1e-4), until=1e-3, also=ALSO)

    header = next(result.csv_lines())
    columns = set(header.split(","))
    assert set(units) <= columns
    data = result.to_xarray()
    for name, unit in units.items():
        assert data[name].attrs["units"] == unit
    result.save(path)
    loaded = ri.load(path)
    assert have_same_bits(result, loaded)
    assert loaded.readings.also == ALSO


@pytest.mark.parametrize(
    ("also", "message"),
    [
        ("set", "must be a list of"),
        (["weight"], "got 'weight'"),
        (["displacement"], "until"),
    ],
)
def test_wrong_readings_are_refused(also, message):
    with pytest.raises(ri.InvalidModel, match=f"also: .*{message}"):
        ri.sweep(small_map(), also=also)


def test_a_sweep_runs_where_no_thread_can_start(monkeypatch, small_chunks):
    """If threads cannot start, a sweep has the bits of a threaded one."""
    family = small_map()
    threaded = ri.sweep(family)

    def refuses(thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", refuses)

    without_threads = ri.sweep(family)

    assert have_same_bits(without_threads, threaded)


def test_several_contacts_have_columns_of_their_own():
    """A sweep of three rods has duration and peak force for each contact; those of the
    first are those of two rods. Its `impulse` without a contact raises ValueError.
    """
    velocities = [1.0, 2.0]
    striker = steel_rod(0.2, velocities)
    struck = steel_rod(0.2)

    of_two = ri.sweep(ri.System([striker, struck]))
    of_three = ri.sweep(ri.System([striker, struck, struck]))

    last_velocities = of_three.velocities_after[2]
    np.testing.assert_allclose(last_velocities, velocities, rtol=1e-14)
    with pytest.raises(ValueError, match=r"result\.contacts"):
        _ = of_three.impulse
    first_contact = of_three.contacts[0]
    assert of_two.duration.tolist() == first_contact.duration.tolist()
    assert of_two.peak_force.tolist() == first_contact.peak_force.tolist()


def test_a_law_that_other_processes_cannot_import_is_refused_with_a_remedy():
    """A sweep with a lambda as its law on a pool of processes is refused with advice,
    before a process starts.
    """
    masses = [ri.RigidMass([1.0, 2.0], velocity=1.0), ri.Wall()]
    family = ri.System(masses, contacts=[ri.Law(lambda d, rate: 1e8 * d)])
    remedy = (
        "contacts.0: .* define it with def at the top of a module, or leave executor"
    )
    with ProcessPoolExecutor(1) as pool:
        with pytest.raises(ri.InvalidModel, match=remedy):
            ri.sweep(family, executor=pool)
        # A pool starts no process before its first job.
        assert not pool._processes
