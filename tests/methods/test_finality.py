"""The proof that a collision is over: its bounds, against independent sums, and its
timing.
"""

import math
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
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


class Part(NamedTuple):
    """A part of a rod between two breaks of its state."""

    length: float
    density: float  # mass per length
    stiffness: float  # E A
    velocity: float
    strain: float


def parts_of(solution, bodies):
    """Uniform parts of a group of bodies at the end of a run, from left to right. Walls
    have none; bodies must be rods otherwise.
    """
    fields = solution.fields
    parts = []
    for body in bodies:
        rod = solution.system.bodies[body]
        if isinstance(rod, ri.Wall):
            continue
        state = fields.profile(body, fields.end)
        edges = state.edges
        middles = (edges[1:] + edges[:-1]) / 2
        # Segments are numbered along the whole row.
        numbers, *_ = fields.locate(body, middles)
        first = fields.clock.spans[body][0]
        for i, number in enumerate(numbers):
            segment = rod.segments[number - first]
            material = segment.material
            part = Part(
                length=edges[i + 1] - edges[i],
                density=material.density * segment.area,
                stiffness=material.youngs_modulus * segment.area,
                velocity=state.velocity[i],
                strain=state.strain[i],
            )
            parts.append(part)
    return parts


class Sway(NamedTuple):
    """Mean motion of a group, and the place of one of its ends beside it."""

    mean_velocity: float  # m/s
    deviation: float  # of the end, away from the group, m
    squared_bound: float  # square of the bound of this deviation, m^2


def expected_sway(parts, wall_velocity):
    """Sway of a group at the end of the last part; `wall_velocity` is None without a
    wall.

    The deviation is integral(g strain dx), at most sqrt(2 U integral(g^2 dx/(E A))), U
    the energy of vibration. g is the share of the mass up to x, or 1 beside a wall: it
    goes linearly from g0 to g1 in each part.
    """
    columns = np.array(parts).T  # [field, part]
    length, density, stiffness, velocity, strain = columns
    mass = length * density
    share = np.cumsum(mass) / mass.sum()  # of the mass, up to the end of each part
    if wall_velocity is None:
        mean = np.sum(mass * velocity) / mass.sum()
        g0 = np.append(0.0, share[:-1])  # at the start of each part
        g1 = share
    else:
        mean = wall_velocity
        g0 = np.ones(len(parts))
        g1 = g0
    mean_g = (g0 + g1) / 2
    deviation = np.sum(strain * length * mean_g)
    velocity_of_vibration = velocity - mean
    kinetic = np.sum(mass * velocity_of_vibration**2) / 2
    elastic = np.sum(stiffness * strain**2 * length) / 2
    mean_squared_g = (g0**2 + g0 * g1 + g1**2) / 3
    compliance = np.sum(length / stiffness * mean_squared_g)
    squared_bound = 2 * (kinetic + elastic) * compliance
    return Sway(mean, deviation, squared_bound)


def wall_velocities(system, group):
    """Velocities of the walls among the bodies of a group, as a list, m/s."""
    velocities = []
    for i in group:
        body = system.bodies[i]
        if isinstance(body, ri.Wall):
            velocities.append(body.velocity)
    return velocities


def sides_of(group, system):
    """Contacts beside a group: their number, and whether the group lies on their
    right.
    """
    sides = []
    first = group[0]
    last = group[-1]
    if last < len(system.contacts):
        sides.append((last, False))
    if first > 0:
        sides.append((first - 1, True))
    return sides


@given(st.integers(0, 10**6), st.floats(0.5, 6.0))
def test_mean_motions_and_bounds_of_groups_are_those_of_sums_over_parts(seed, transits):
    """At each contact of a random row the bonded group beside it has the mean motion
    and the bound of `expected_sway`.
    """
    system = random_system(seed, bodies=4)
    until = horizon(system, transits=transits)
    run = tracked(system, until=until, max_events=20_000)
    solution = solution_of(run, until=until)
    for group in groups(system):
        walls = wall_velocities(system, group)
        parts = parts_of(solution, group)
        if not parts or len(walls) > 1:  # a wall alone, or nothing that can move
            continue
        wall_velocity = walls[0] if walls else None
        for contact, on_right in sides_of(group, system):
            # Groups end at contacts that can open, and not at bonds.
            node = run.layout.contacts[contact]
            assert run.nodes[node].status >= Status.OPEN
            motion = group_of(run, contact, right=on_right)
            if on_right:
                parts_to_contact = parts[::-1]
            else:
                parts_to_contact = parts
            sway = expected_sway(parts_to_contact, wall_velocity=wall_velocity)
            assert_motion_is_that_of_sums(motion, sway, run, on_right)
            is_bounded = motion.is_end_velocity_bounded
            if is_bounded and has_waves(parts, system, group):
                assert motion.min_end_velocity == motion.max_end_velocity


def assert_motion_is_that_of_sums(motion, sway, run, on_right):
    """Assert that a motion, in ticks and in the frame of the clock, is a sway, in m and
    m/s.
    """
    tick = run.clock.tick
    velocity = motion.mean_velocity + run.clock.frame
    assert velocity == pytest.approx(sway.mean_velocity, abs=1e-11)
    to_the_right = -sway.deviation if on_right else sway.deviation
    round_off = 1e-11 * horizon(run.clock.system)
    deviation = motion.end_deviation * tick
    assert deviation == pytest.approx(to_the_right, abs=round_off)
    if motion.deviation_bound_squared > 0:
        squared = motion.deviation_bound_squared * tick**2
        expected = sway.squared_bound
        assert squared == pytest.approx(expected, rel=1e-9, abs=1e-24)


def has_waves(parts, system, group):
    """Whether waves run in a group that has a step or a wall.

    The velocity of its end is then bounded only if the waves in it have come to rest.
    """
    velocities = {part.velocity for part in parts}
    strains = {part.strain for part in parts}
    n_segments = 0
    for i in group:
        segments = getattr(system.bodies[i], "segments", ())  # a wall has none
        n_segments += len(segments)
    has_wall = bool(wall_velocities(system, group))
    is_uniform = n_segments == 1 and not has_wall
    n_states = max(len(velocities), len(strains))
    return n_states > 1 and not is_uniform


def strained(velocity, strain):
    """A stepped rod with this uniform velocity, m/s, and strain."""
    thin = ri.Segment(1.0, area=1.0, material=M)
    thick = ri.Segment(0.7, area=2.0, material=M)
    return ri.Rod(segments=[thin, thick], velocity=velocity, strain=strain)


def test_the_proof_waits_until_the_mean_gap_is_beyond_the_reach_of_both_ends():
    """A stretched and a compressed stepped rod drift apart. The tick that is foreseen at
    the start for the proof is that at which their mean gap, which grows by the drift,
    is as large as the bound on the deviations of both ends.
    """
    gap = 0.001
    drift = 1e-3
    rods = [
        strained(velocity=0.0, strain=0.02),
        strained(velocity=drift, strain=-0.01),
    ]
    system = ri.System(rods, gaps=[gap])
    run = tracked(system, until=0.0)
    solution = solution_of(run, until=0.0)
    parts_of_left = parts_of(solution, [0])
    left = expected_sway(parts_of_left, wall_velocity=None)
    # The sway is that of the end of the last part, which is the left end here.
    parts_to_gap = parts_of(solution, [1])[::-1]
    right = expected_sway(parts_to_gap, wall_velocity=None)
    # A deviation towards the gap narrows it, so the mean gap is wider by it.
    mean_gap = gap + left.deviation + right.deviation
    # The proof takes the root of twice the sum of both squared bounds, which is at
    # least the sum of the bounds.
    sum_of_squares = left.squared_bound + right.squared_bound
    reach = np.sqrt(2 * sum_of_squares)

    proof_tick = finality.finality_tick(records_of(run), 0)

    wait = (reach - mean_gap) / drift
    proof_time = proof_tick * run.clock.tick
    # The proof waits 1e-6 longer, so that it succeeds then.
    assert proof_time == pytest.approx(wait, rel=2e-6)


@given(st.integers(0, 10**6))
def test_the_collision_of_every_free_row_is_proved_to_be_over(seed):
    """Rows of two or three rods without walls run until their proof."""
    system = random_system(seed, bodies=3, walls=False)

    solution = ri.solve(system, max_events=200_000)

    assert solution.stopped_by == "final", solution.status


def test_a_clamped_rod_that_is_struck_is_final_only_when_it_strikes_no_more():
    """A rod strikes one that is bonded to a wall. A run 20 times as long as the final
    one has no later contact. This is not trivial: velocities in the clamped rod change
    sign, so that its waves bound nothing.
    """
    striker = ri.Rod(0.2, area=0.1, material=M, velocity=0.2)
    clamped = ri.Rod(1.0, area=1.0, material=M)
    laws = [ri.Rigid(), ri.Bonded()]
    system = ri.System([striker, clamped, ri.Wall()], contacts=laws)

    solution = ri.solve(system)
    longer = ri.solve(system, until=20 * solution.t_end)

    assert solution.final
    contact = solution.outcome.contacts[0]
    longer_contact = longer.outcome.contacts[0]
    assert longer_contact.last <= solution.t_final
    assert longer_contact.episodes == contact.episodes


def test_a_grazing_contact_that_presses_again_is_one_episode():
    """Two compressive pulses, one after the other, pass from rod to rod; between them
    the ends only touch.
    """
    jumps = [1.0, 1.5, 2.0, 2.5]
    # With v = -c strain and c = 1 m/s, the pulses run to the right.
    velocity = ri.Steps([0, 1, 0, 1, 0], at=jumps)
    strain = ri.Steps([0, -1, 0, -1, 0], at=jumps)
    pulses = ri.Rod(3.0, area=1.0, material=M, velocity=velocity, strain=strain)
    struck = ri.Rod(3.0, area=1.0, material=M)
    system = ri.System([pulses, struck])

    solution = ri.solve(system, until=3.0)

    # The front of the first pulse is 0.5 m from the contact; each is 0.5 m long.
    contact = solution.contacts[0]
    times = [0.25, 0.75, 1.25, 1.75, 2.25]
    forces = contact.force(times)
    assert forces.tolist() == [0, 1, 0, 1, 0]
    (episode,) = contact.episodes
    assert episode.start == 0.5
    assert episode.force_end == 2.0
    total = solution.outcome.contacts[0]
    assert total.episodes == 1
    assert total.first == 0.5
    assert total.last == 2.0
    assert total.duration == 1.0


@pytest.mark.parametrize(
    ("gap", "rate", "closing", "after"),
    [
        pytest.param(
            5.0, 0.0, 1.0, (Status.PRESS, 0.0, 0.0), id="about to close from now on"
        ),
        pytest.param(
            105.0, -1.0, -1.0, (Status.OPEN, 0.0, 1.0), id="touched and parted"
        ),
        pytest.param(200.0, -1.0, 1.0, (Status.OPEN, 100.0, -1.0), id="far"),
    ],
)
def test_a_gap_closes_now_if_it_would_within_the_window_and_parts_if_it_opens(
    gap, rate, closing, after
):
    """A gap, in m, has changed at its old rate for 100 ticks; from now on it closes
    with `closing`. `after` has the new status, gap and rate. The window has 10 ticks.
    """
    (node,) = blank(1, NODE)
    node.status = Status.OPEN.value
    node.gap = gap
    node.gap_rate = rate

    status = contacts.resolve_contact(
        node, closing=closing, dt=100, tolerance=1e-9, window=10
    )

    result = (status, node.gap, node.gap_rate)
    assert result == after


@pytest.mark.parametrize(
    ("before", "last_opening"),
    [
        (Status.OPEN, 7),
        (Status.TOUCH, 7),
        (Status.GRAZE, 9),
        (Status.PRESS, 9),
    ],
)
def test_only_a_contact_that_has_pressed_counts_as_opening(before, last_opening):
    """A contact opens at tick 9. What has touched without a force since it closed
    leaves the last opening, 7, as it is.
    """
    (run,) = blank(1, RUN)
    (node,) = blank(1, NODE)
    (row,) = blank(1, FRONT)
    node.status = before.value
    node.last_opening_tick = 7

    contacts.log_contact_change(
        run, node, row, k=1, tick=9, status=Status.OPEN.value, mobility=1.0
    )

    assert node.last_opening_tick == last_opening
    assert row.tick == 9
    assert row.next_row == 1
    assert row.value == Status.OPEN


@pytest.mark.parametrize("delay", [0, 3, 900])
def test_a_closing_joins_an_arrival_within_the_window(delay):
    """The gap closes `delay` ticks before a front from the middle of the striker
    arrives there; the force begins at the tick of the front.
    """
    velocity = ri.Steps([1.0, 0.5], at=[0.5])
    striker = ri.Rod(1.0, area=1.0, material=M, velocity=velocity)
    struck = ri.Rod(1.0, area=1.0, material=M)
    system = ri.System([striker, struck], gaps=[1e-3])
    clock = tracked(system, until=1.0).clock
    arrival = clock.ticks[1] // 2  # of the front, after half of a transit
    time_of_closing = (arrival - delay) * clock.tick
    gap = 0.5 * time_of_closing  # it closes at 0.5 m/s
    system_with_gap = system.replace(gaps=[gap])

    run = tracked(system_with_gap, until=1.0)

    assert run.clock.ticks == clock.ticks  # the gap changes no tick
    assert run.run.round_off_window > 900  # ticks, the longest delay
    contact_node = run.nodes[1]
    assert contact_node.first_force_tick == arrival


def test_round_off_of_cuts_makes_no_fronts():
    """A rod cut into bonded pieces of awkward impedance sends no echoes from the cuts:
    velocities are those of the whole rod, with at most twice as many events.
    """
    odd = ri.Material("odd", youngs_modulus=1.23456789, density=0.987654321)
    area = 0.7654321
    segment = ri.Segment(0.1, area=area, material=odd)
    strain = ri.Steps([0.1, 0.0], at=[0.33])
    whole = ri.Rod(0.7, area=area, material=odd, velocity=0.3, strain=strain)
    cut = ri.Rod(segments=[segment] * 7, velocity=0.3, strain=strain)
    struck = ri.Rod(0.7, area=area, material=odd)
    pair = ri.System([whole, struck])
    cut_pair = ri.System([cut, struck])

    solution = ri.solve(pair, until=100.0)
    solution_of_cut = ri.solve(cut_pair, until=100.0)

    velocities = solution.outcome.velocities_after
    velocities_of_cut = solution_of_cut.outcome.velocities_after
    assert velocities_of_cut == pytest.approx(velocities, abs=1e-12)
    assert solution_of_cut.events <= 2 * solution.events


OPPOSITE_HALVES = ri.Steps([1.0, -1.0], at=[0.5])
VIBRATING = ri.Rod(1.0, area=1.0, material=M, velocity=OPPOSITE_HALVES)


def test_a_vibrating_rod_alone_is_final_at_once():
    """A rod alone, whose halves move at 1 and -1 m/s, is final at t = 0, and its run
    has the length of a round trip of waves, 2 s.
    """
    system = ri.System([VIBRATING])
    solution = ri.solve(system)
    assert solution.stopped_by == "final"
    assert solution.t_final == 0.0
    assert solution.t_end == 2.0  # a round trip is shown


@pytest.mark.parametrize(("drift", "stop"), [(1e-4, "final"), (1e-8, "clock")])
def test_a_slow_drift_is_waited_for_as_long_as_the_clock_counts(drift, stop):
    """A vibrating rod and another one drift apart: slowly, or too slowly for the clock.
    The cap on events, 50,000, ends neither run.
    """
    drifting = ri.Rod(1.0, area=1.0, material=M, velocity=drift)
    system = ri.System([VIBRATING, drifting], gaps=[0.7])

    solution = ri.solve(system, max_events=50_000)

    assert solution.stopped_by == stop
    (contact,) = solution.outcome.contacts
    assert contact.episodes == 0  # the rods never touch
    assert 1000 < solution.events < 20_000  # it waits, but not for ever


# When the last contact ended
# --------------------------------------------------------------------------------------

MOVING = ri.Rod(0.4, area=1.0, material=M, velocity=1.0)
RESTING = ri.Rod(1.0, area=1.0, material=M)
PAIR = [MOVING, RESTING]
SPRING = ri.Spring(0.5)
RIGID_OPENING = 2.0
"""When rigid rods part, s; from 0.8 s on, where their force ends, they only touch."""


@pytest.mark.parametrize("until", few_of([None, 3.0, 12.0, 40.0], [None, 12.0]))
@pytest.mark.parametrize(
    ("law", "method", "options", "error"),
    [
        (ri.Rigid(), "fronts", {}, 1e-14),
        (ri.Rigid(), "finite-difference", {"cells": 200}, 0.01),
        (SPRING, "finite-difference", {"cells": 200}, 1e-3),
    ],
)
def test_the_last_contact_ended_whatever_the_end_and_the_method(
    law, method, options, error, until
):
    """`t_final` is the known opening to this relative `error`, whenever the run ends,
    and the status says so.
    """
    system = ri.System(PAIR, contacts=[law])
    opening = RIGID_OPENING
    if law == SPRING:
        by_other_method = ri.solve(system, until=9.0)
        last_episode = by_other_method.contacts[0].episodes[-1]
        opening = last_episode.opening

    solution = ri.solve(system, until=until, method=method, **options)

    last_episode = solution.contacts[0].episodes[-1]
    assert solution.t_final == pytest.approx(opening, rel=error)
    assert solution.t_final == last_episode.opening
    assert "The collision is final: the last contact ended at " in solution.status
    before_end_of_run, *_ = str(solution).split("run to")
    assert "last contact ended at" in before_end_of_run


def test_where_bodies_still_touch_no_end_of_contact_is_stated():
    """Two rods still touch at the end of a final run: t_final is nan, and the status
    says so.
    """
    system = ri.System(PAIR)
    solution = ri.solve(system, until=1.0)
    assert solution.final
    assert math.isnan(solution.t_final)
    assert "Bodies still touch at the end of the run." in solution.status


@pytest.mark.parametrize("until", [None, 9.0, 99.0])
def test_bodies_that_come_to_rest_together_end_with_their_force(until):
    """A rod strikes another whose far end absorbs, and both come to rest. The collision
    is final at 1 s, when the force ends, however long the run is.
    """
    striker = ri.Rod(0.5, area=1.0, material=M, velocity=1.0)
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([striker, RESTING], ends=ends)
    solution = ri.solve(system, until=until)
    assert solution.t_final == 1.0


def test_bodies_that_are_squeezed_for_ever_have_no_end_of_contact():
    """A compressed rod between two walls has the final time inf."""
    squeezed = ri.Rod(1.0, area=1.0, material=M, strain=-1e-4)
    system = ri.System([ri.Wall(), squeezed, ri.Wall()])
    solution = ri.solve(system)
    assert solution.t_final == math.inf
