"""Characteristics against the method of steps: random rows, causes before effects, no
pulling.
"""

import functools

import numpy as np
import pytest
from compliant_rows import KINDS, random_row
from exhaustive import few_of
from networks import UNIT
from rows_by_steps import solve_by_steps

import rodimpact as ri

ORACLE = 3e-12  # relative error of the method of steps, in integrals
ORACLE_PEAK = 3e-11  # of its forces, which miss their laws by its tolerance
ORACLE_TIME = 5e-9  # and of its times, where a dashpot starts softly
LONGEST = 1.6  # s: until then the random rows are run
FAINTEST = 1e-9  # s: a longer time with almost no force makes the force duration ill-conditioned


def rows(count, usual):
    """Pairs of a kind and a seed: so many seeds of each kind, of which the first run
    always.
    """
    pairs = [(kind, seed) for kind in KINDS for seed in range(count)]
    return few_of(pairs, {pair for pair in pairs if pair[1] < usual})


@functools.cache
def reference(kind, seed):
    """System, end, and outcome by the method of steps."""
    system, until = random_row(kind, seed)
    until = min(until, LONGEST)
    fine = solve_by_steps(system, until, 1e-11)
    return system, until, fine


def errors_of(solution, reference):
    """Error of each measure, over its largest value, and that value."""
    contacts = solution.run.contacts
    velocities = np.array(solution.outcome.velocities_after)
    pairs = {
        "velocity": (velocities, reference.velocities),
        "impulse": ([c.impulse for c in contacts], reference.impulses),
        "peak force": ([c.peak_force for c in contacts], reference.peaks),
        "duration": ([c.duration for c in contacts], reference.durations),
        "time": ([c.first for c in contacts], reference.firsts),
    }
    errors = {}
    for name, (values, wanted) in pairs.items():
        values = np.nan_to_num(np.asarray(values, dtype=float), nan=-1.0)
        wanted = np.nan_to_num(wanted, nan=-1.0)
        whole = float(np.abs(wanted).max())
        if name == "velocity":
            whole = solution.fields.clock.scale
        if name == "time":
            whole = solution.t_end
        errors[name] = (
            float(np.abs(values - wanted).max()) / whole if whole > 0 else 0.0
        )
    return errors


@pytest.mark.parametrize("row", rows(12, 2))
def test_random_rows_are_right_to_the_stated_error(row):
    system, until, wanted = reference(*row)
    solution = ri.solve(system, until, "characteristics")
    for name, error in errors_of(solution, wanted).items():
        ill_conditioned = wanted.faint.max() > FAINTEST
        if name in ("duration", "time") and ill_conditioned:
            continue
        allowed = ORACLE
        if name == "peak force":
            allowed = ORACLE_PEAK
        if name in ("duration", "time"):
            allowed = ORACLE_TIME
        assert error <= solution.accuracy[name] + allowed, name


@pytest.mark.parametrize(("seed", "rtol"), [(25, 1e-10), (47, 1e-10), (68, 1e-6)])
def test_two_runs_that_miss_a_peak_alike_do_not_hide_its_error(seed, rtol):
    """Peaks at which a wave jumps in a dashpot: both runs followed them by the same
    pieces.
    """
    system, until = random_row("dashpot", seed)
    solution = ri.solve(system, until, "characteristics", rtol=rtol)
    exact = ri.solve(system, until, "characteristics", rtol=1e-13)
    peaks = np.array([c.peak_force for c in solution.run.contacts])
    right = np.array([c.peak_force for c in exact.run.contacts])
    error = np.abs(peaks - right).max() / right.max()
    stated = solution.accuracy["peak force"] + exact.accuracy["peak force"]
    assert error <= stated


def test_half_the_stated_errors_are_less_than_a_hundred_times_the_true_ones():
    ratios = []
    for kind in KINDS:
        for seed in range(4):
            system, until, wanted = reference(kind, seed)
            solution = ri.solve(system, until, "characteristics")
            error = errors_of(solution, wanted)["velocity"]
            ratios.append(solution.accuracy["velocity"] / max(error, 1e-15))
    assert np.median(ratios) < 100


# Effects come after their causes
# --------------------------------------------------------------


def touching_rods(*contacts):
    """Three rods that touch; the right one strikes the middle one, whose transit time
    is .73.
    """
    sizes = ((0.8, 0.0, 1.0), (0.73, 0.0, 1.0), (0.36, -1.0, 0.85))
    rods = []
    for length, velocity, area in sizes:
        rods.append(ri.Rod(length, area=area, material=UNIT, velocity=velocity))
    return ri.System(rods, contacts=contacts)


@pytest.mark.parametrize("stiffness", few_of([0.05, 0.6, 5.0, 30.0], {0.6, 30.0}))
@pytest.mark.parametrize("exponent", [1.5, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("first", ["rigid", "alike"])
def test_no_force_acts_before_a_wave_can_arrive(first, exponent, stiffness):
    law = ri.PowerLaw(stiffness, exponent)
    left = ri.Rigid() if first == "rigid" else law
    solution = ri.solve(touching_rods(left, law), 6.0, "characteristics")
    tally = solution.run.contacts[0]
    assert tally.first == pytest.approx(0.73, abs=1e-12)
    before = np.linspace(0.0, 0.73, 4001)[:-1]
    assert not np.any(solution.contacts[0].force(before))
    assert not np.any(solution.velocity(0, 0.4, before))


def test_a_drive_that_starts_late_and_softly_moves_nothing_before():
    times = np.linspace(0.0, 3.0, 301)
    force = np.where(times > 1.0, (times - 1.0) ** 4, 0.0)
    rod = ri.Rod(0.5, area=1.0, material=UNIT)
    row = ri.System(
        [rod, rod],
        contacts=[ri.Hertz(3.0)],
        ends=[ri.Pushed(ri.Samples(force, step=0.01)), ri.Free()],
    )
    solution = ri.solve(row, 3.0, "characteristics")
    assert solution.run.contacts[0].first == pytest.approx(1.5, abs=1e-9)
    assert not np.any(solution.velocity(0, 0.25, np.linspace(0.0, 1.249, 1000)))


def test_a_force_that_grows_slowly_begins_when_the_contact_closes():
    """The first waves of Hertz make an overlap that is round-off for a millionth of a
    second.
    """
    system, until = random_row("dashpot", 4)
    tally = ri.solve(system, until, "characteristics").run.contacts[1]
    (segment,) = system.bodies[1].segments
    arrival = segment.length / segment.material.wave_speed
    assert tally.first == pytest.approx(arrival, abs=1e-12)
    assert tally.duration == pytest.approx(until - arrival, abs=1e-12)


def test_a_contact_that_presses_for_a_moment_is_not_missed():
    """Two jumps arrive 7e-5 s apart: the dashpot presses between them."""
    system, until = random_row("dashpot", 7)
    solution = ri.solve(system, until, "characteristics")
    assert solution.run.contacts[0].last == pytest.approx(2.8365247256, abs=1e-9)


# No contact pulls
# ------------------------------------------------------------------------------


@pytest.mark.parametrize("row", rows(20, 3))
def test_no_contact_pulls_at_any_time(row):
    system, until = random_row(*row)
    solution = ri.solve(system, until, "characteristics")
    times = np.linspace(0.0, until, 20_001)
    for contact in solution.contacts:
        assert contact.force(times).min() >= 0.0
        assert contact.push.integral(0, solution.fields.to_ticks(until)) * (
            solution.fields.clock.tick
        ) == pytest.approx(contact.impulse, rel=1e-12, abs=1e-14)
    gained = 0.0
    for body, velocity in zip(
        system.bodies, solution.outcome.velocities_after, strict=True
    ):
        if isinstance(body, ri.Wall):
            gained += solution.contacts[-1].impulse
        else:
            gained += body.mass * (velocity - body.velocity)
    stated = solution.accuracy["velocity"] * solution.fields.clock.scale
    masses = sum(getattr(body, "mass", 0.0) for body in system.bodies)
    assert abs(gained) <= 2 * masses * stated + 1e-14


@pytest.mark.parametrize("exponent", [1.5, 4.0])
def test_the_end_of_a_rod_is_never_in_tension_where_it_touches(exponent):
    system = touching_rods(*[ri.PowerLaw(0.6, exponent)] * 2)
    solution = ri.solve(system, 6.0, "characteristics")
    times = np.linspace(0.0, 6.0, 20_001)
    peak = solution.contacts[0].peak_force
    end = solution.axial_force(0, 0.8, times)  # tension is positive
    assert end.max() <= 1e-7 * peak


# Runs that go on
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("row", rows(10, 2))
def test_a_run_that_goes_on_is_as_exact_as_one_that_does_not_stop(row):
    system, until = random_row(*row)
    whole = ri.solve(system, until, "characteristics", rtol=1e-10)
    half = ri.solve(system, until / 2, "characteristics", rtol=1e-10)
    second_part = ri.solve(
        half.system_at(until / 2), until / 2, "characteristics", rtol=1e-10
    )
    scale = whole.fields.clock.scale
    stated = whole.accuracy["velocity"] * scale
    stated += second_part.accuracy["velocity"] * second_part.fields.clock.scale
    off = np.abs(
        np.subtract(
            whole.outcome.velocities_after, second_part.outcome.velocities_after
        )
    )
    assert off.max() <= stated + 1e-12 * scale
    assert off.max() <= 1e-9 * scale


def test_a_state_carries_the_stated_error_of_its_run():
    solution = ri.solve(
        touching_rods(ri.Hertz(30.0), ri.Hertz(30.0)), 2.0, "characteristics"
    )
    state = solution.system_at(1.0)
    velocity = state.bodies[1].velocity
    assert isinstance(velocity, ri.Polynomials)
    error = solution.accuracy["velocity"] * solution.fields.clock.scale
    assert velocity.error == error
    second_part = ri.solve(state, 1.0, "characteristics")
    assert second_part.accuracy["velocity"] * second_part.fields.clock.scale >= error


def test_a_state_is_written_and_read_again():
    solution = ri.solve(
        touching_rods(ri.Hertz(30.0), ri.Hertz(30.0)), 2.0, "characteristics"
    )
    state = solution.system_at(1.0)
    assert ri.parse_case(ri.format_case(state)).system == state
    assert state.mirrored().mirrored().bodies[0].velocity.at == pytest.approx(
        state.bodies[0].velocity.at
    )
