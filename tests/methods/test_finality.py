"""The proof that a collision is over: its bounds, against independent sums, and its timing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from runs import group_of, records_of, solution_of, tracked
from systems import horizon, random_system

import rodimpact as ri
from rodimpact.methods.fronts import contact as contacts
from rodimpact.methods.fronts import finality
from rodimpact.methods.fronts.records import FRONT, NODE, RUN
from rodimpact.methods.groups import groups
from rodimpact.methods.record_lists import blank
from rodimpact.methods.states import Status

M = ri.Material("m", youngs_modulus=1.0, density=1.0)


def pieces_of(solution, bodies):
    """The group's pieces at the end: (length, mass per length, E A, velocity, strain)."""
    a = solution.fields.clock
    found = []
    for body in bodies:
        rod = solution.system.bodies[body]
        if isinstance(rod, ri.Wall):
            continue
        state = solution.fields.profile(body, solution.fields.end)
        middles = (state.edges[1:] + state.edges[:-1]) / 2
        for i, s in enumerate(solution.fields.locate(body, middles)[0]):
            piece = rod.segments[s - a.spans[body][0]]
            found.append(
                (
                    state.edges[i + 1] - state.edges[i],
                    piece.material.density * piece.area,
                    piece.material.youngs_modulus * piece.area,
                    state.velocity[i],
                    state.strain[i],
                )
            )
    return found


def expected_sway(pieces, wall_velocity):
    """Deviation of the right end from the mean motion, and the square of its bound."""
    length, density, stiffness, v, strain = (
        np.array(x) for x in zip(*pieces, strict=True)
    )
    mass = length * density
    mean = wall_velocity
    if mean is None:
        mean = np.sum(mass * v) / mass.sum()
    beyond = np.cumsum(mass) / mass.sum()
    g0 = np.concatenate(([0.0], beyond[:-1]))
    g1 = beyond
    if wall_velocity is not None:
        g0 = g1 = np.ones(len(pieces))
    deviation = np.sum(strain * length * (g0 + g1) / 2)
    energy = np.sum(mass * (v - mean) ** 2 + stiffness * strain**2 * length) / 2
    compliance = np.sum(length / stiffness * (g0**2 + g0 * g1 + g1**2) / 3)
    return mean, deviation, 2 * energy * compliance


@given(st.integers(0, 10**6), st.floats(0.5, 6.0))
def test_mean_motion_and_bounds(seed, transits):
    system = random_system(seed, bodies=4)
    until = horizon(system, transits)
    run = tracked(system, until, 20_000)
    solution = solution_of(run, until)
    tick = run.clock.tick
    for group in groups(system):
        walls = [
            b.velocity for i in group if isinstance(b := system.bodies[i], ri.Wall)
        ]
        pieces = pieces_of(solution, group)
        if not pieces or len(walls) > 1:
            continue
        for right_side, contact in ((False, group[-1]), (True, group[0] - 1)):
            if not 0 <= contact < len(system.contacts):
                continue
            assert run.nodes[run.layout.contacts[contact]].status >= Status.OPEN
            mean, deviation, bound2 = expected_sway(
                pieces[::-1] if right_side else pieces, walls[0] if walls else None
            )
            it = group_of(run, contact, right_side)
            assert it.mean_velocity + run.clock.frame == pytest.approx(mean, abs=1e-11)
            sign = -1 if right_side else 1
            assert it.end_deviation * tick == pytest.approx(
                sign * deviation, abs=1e-11 * horizon(system)
            )
            if it.deviation_bound_squared:
                assert it.deviation_bound_squared * tick**2 == pytest.approx(
                    bound2, rel=1e-9, abs=1e-24
                )
            moving = any(len(np.unique([p[k] for p in pieces])) > 1 for k in (3, 4))
            stepped = len(pieces_of(solution, group)) > 1 and (
                walls or sum(len(system.bodies[i].segments) for i in group) > 1
            )
            if it.is_end_velocity_bounded and moving and stepped:
                assert it.min_end_velocity == it.max_end_velocity  # nothing under way


def test_the_time_of_the_proof_takes_the_swing_of_both_ends_into_account():
    """Two stretched stepped rods drift apart; the gap of their mean motions is not the gap."""

    def stretched(velocity, strain):
        pieces = [ri.Segment(1.0, 1.0, M), ri.Segment(0.7, 2.0, M)]
        return ri.Rod(segments=pieces, velocity=velocity, strain=strain)

    system = ri.System([stretched(0.0, 0.02), stretched(1e-3, -0.01)], gaps=[0.001])
    run = tracked(system, 0.0)
    solution = solution_of(run, 0.0)
    _, left, bound_left = expected_sway(pieces_of(solution, [0]), None)
    _, right, bound_right = expected_sway(pieces_of(solution, [1])[::-1], None)
    mean_gap = (
        0.001 + left + right
    )  # both deviations are measured outwards, towards the gap
    wait = (np.sqrt(2 * (bound_left + bound_right)) - mean_gap) / 1e-3
    when = finality.finality_tick(records_of(run), 0)
    assert when * run.clock.tick == pytest.approx(wait, rel=2e-6)


@given(st.integers(0, 10**6))
def test_every_free_row_settles(seed):
    system = random_system(seed, bodies=3, walls=False)
    solution = ri.solve(system, max_events=200_000)
    assert solution.stopped_by == "final", solution.status


def test_a_clamped_rod_swings_back():
    """Velocities in a rod with a fixed end change sign, so its waves bound nothing."""
    row = ri.System(
        [
            ri.Rod(0.2, area=0.1, material=M, velocity=0.2),
            ri.Rod(1.0, area=1.0, material=M),
            ri.Wall(),
        ],
        contacts=[ri.Rigid(), ri.Bonded()],
    )
    solution = ri.solve(row)
    longer = ri.solve(row, until=20 * solution.t_end)
    assert solution.final
    assert longer.outcome.contacts[0].last <= solution.t_final
    assert longer.outcome.contacts[0].episodes == solution.outcome.contacts[0].episodes


def test_a_grazing_contact_that_presses_again_is_one_episode():
    """Two compressive pulses, one after the other, pass from rod to rod; between them the ends
    only touch."""
    at = [1.0, 1.5, 2.0, 2.5]
    pulse = ri.Rod(
        3.0,
        area=1.0,
        material=M,
        velocity=ri.Steps([0, 1, 0, 1, 0], at),
        strain=ri.Steps([0, -1, 0, -1, 0], at),
    )
    solution = ri.solve(
        ri.System([pulse, ri.Rod(3.0, area=1.0, material=M)]), until=3.0
    )
    contact = solution.contacts[0]
    assert contact.force([0.25, 0.75, 1.25, 1.75, 2.25]).tolist() == [0, 1, 0, 1, 0]
    assert solution.outcome.contacts[0].episodes == 1
    assert len(contact.episodes) == 1
    assert contact.episodes[0].start == 0.5
    assert contact.episodes[0].force_end == 2.0
    tally = solution.outcome.contacts[0]
    assert (tally.first, tally.last, tally.duration) == (0.5, 2.0, 1.0)


@pytest.mark.parametrize(
    ("gap", "rate", "closing", "after"),
    [
        (
            5.0,
            0.0,
            1.0,
            (Status.PRESS, 0.0, 0.0),
        ),  # about to close by the new velocities
        (
            105.0,
            -1.0,
            -1.0,
            (Status.OPEN, 0.0, 1.0),
        ),  # touched by the old ones, and parted
        (200.0, -1.0, 1.0, (Status.OPEN, 100.0, -1.0)),
    ],
)
def test_a_gap_about_to_close_closes_now(gap, rate, closing, after):
    (at,) = blank(1, NODE)
    at.status = Status.OPEN.value
    at.gap = gap
    at.gap_rate = rate
    assert (
        contacts.resolve_contact(at, closing, 100, 1e-9, 10),
        at.gap,
        at.gap_rate,
    ) == after


@pytest.mark.parametrize(
    ("before", "opened"),
    [
        (Status.OPEN, 7),
        (Status.TOUCH, 7),
        (Status.GRAZE, 9),
        (Status.PRESS, 9),
    ],
)
def test_only_a_contact_that_has_pressed_opens(before, opened):
    """What touched without force since it closed leaves the last opening as it is."""
    (run,), (at,), (row,) = blank(1, RUN), blank(1, NODE), blank(1, FRONT)
    at.status = before.value
    at.last_opening_tick = 7
    contacts.log_contact_change(run, at, row, 1, 9, Status.OPEN.value, 1.0)
    assert (at.last_opening_tick, row.tick, row.next_row, row.value) == (
        opened,
        9,
        1,
        Status.OPEN,
    )


@pytest.mark.parametrize("delay", [0, 3, 900])
def test_a_closing_joins_an_arrival_within_the_window(delay):
    """The gap closes `delay` ticks before a front comes back from the far end."""
    striker = ri.Rod(1.0, area=1.0, material=M, velocity=ri.Steps([1.0, 0.5], [0.5]))
    system = ri.System([striker, ri.Rod(1.0, area=1.0, material=M)], [1e-3])
    clock = tracked(system, 1.0).clock
    arrival = clock.ticks[1] // 2
    gap = (arrival - delay) * 0.5 * clock.tick
    run = tracked(system.replace(gaps=[gap]), 1.0)
    assert run.clock.ticks == clock.ticks
    assert run.run.closing_window > 900
    assert run.nodes[1].first_force_tick == arrival


def test_round_off_makes_no_fronts():
    """A rod cut into bonded pieces of awkward impedance sends no echoes from the cuts."""
    odd = ri.Material("odd", youngs_modulus=1.23456789, density=0.987654321)
    pieces = [ri.Segment(0.1, 0.7654321, odd)] * 7
    sizes = {"length": 0.7, "area": 0.7654321, "material": odd}
    state = {"velocity": 0.3, "strain": ri.Steps([0.1, 0.0], [0.33])}
    cut = ri.Rod(segments=pieces, **state)
    whole = ri.Rod(**sizes, **state)
    broken, one = (
        ri.solve(ri.System([r, ri.Rod(**sizes)]), until=100.0) for r in (cut, whole)
    )
    assert broken.outcome.velocities_after == pytest.approx(
        one.outcome.velocities_after, abs=1e-12
    )
    assert broken.events <= 2 * one.events


def test_a_vibrating_rod_alone_is_final_at_once():
    vibrating = ri.Rod(1.0, area=1.0, material=M, velocity=ri.Steps([1.0, -1.0], [0.5]))
    solution = ri.solve(ri.System([vibrating]))
    assert (solution.stopped_by, solution.t_final, solution.t_end) == (
        "final",
        0.0,
        2.0,
    )


@pytest.mark.parametrize(("drift", "end"), [(1e-4, "final"), (1e-8, "clock")])
def test_a_slow_drift_is_waited_for_as_long_as_the_clock_counts(drift, end):
    vibrating = ri.Rod(1.0, area=1.0, material=M, velocity=ri.Steps([1.0, -1.0], [0.5]))
    other = ri.Rod(1.0, area=1.0, material=M, velocity=drift)
    solution = ri.solve(ri.System([vibrating, other], [0.7]), max_events=50_000)
    assert solution.stopped_by == end
    assert solution.outcome.contacts[0].episodes == 0
    assert 1000 < solution.events < 20_000


# When the last contact ended ----------------------------------------------------------------------

PAIR = [
    ri.Rod(0.4, area=1.0, material=M, velocity=1.0),
    ri.Rod(1.0, area=1.0, material=M),
]
SPRING = ri.Spring(0.5)


@pytest.mark.parametrize(
    ("law", "method", "options", "error"),
    [
        (ri.Rigid(), "fronts", {}, 1e-14),
        (ri.Rigid(), "finite-difference", {"cells": 200}, 0.01),
        (SPRING, "finite-difference", {"cells": 200}, 1e-3),
    ],
)
def test_the_last_contact_ended_whatever_the_end_and_the_method(
    law, method, options, error
):
    """The force of rigid rods ends at 0.8, and they touch to 2: a wave opens the gap."""
    row = ri.System(PAIR, contacts=[law])
    opening = (
        2.0
        if law == ri.Rigid()
        else ri.solve(row, 9.0).contacts[0].episodes[-1].opening
    )
    for until in (None, 3.0, 12.0, 40.0):
        solution = ri.solve(row, until, method, **options)
        assert solution.t_final == pytest.approx(opening, rel=error)
        assert solution.t_final == solution.contacts[0].episodes[-1].opening
        assert "The collision is final: the last contact ended at " in solution.status
        assert "last contact ended at" in str(solution).split("run to")[0]


def test_without_an_opening_the_end_of_the_contact_says_why():
    touching = ri.solve(ri.System(PAIR), until=1.0)
    assert touching.final
    assert math.isnan(touching.t_final)
    assert "Bodies still touch at the end of the run." in touching.status
    striker = ri.Rod(0.5, area=1.0, material=M, velocity=1.0)
    bar = PAIR[1]
    at_rest = ri.System([striker, bar], ends=(ri.Free(), ri.Absorbing()))
    assert [ri.solve(at_rest, until).t_final for until in (None, 9.0, 99.0)] == [
        1.0
    ] * 3
    squeezed = ri.Rod(1.0, area=1.0, material=M, strain=-1e-4)
    assert ri.solve(ri.System([ri.Wall(), squeezed, ri.Wall()])).t_final == math.inf
