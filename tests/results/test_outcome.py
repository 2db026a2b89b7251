"""What a collision did: `Outcome.as_rigid` in rigid-body mechanics, and what its
balances miss.
"""

import math
import re

import numpy as np
import pytest
from exhaustive import few_of
from runs import tracked

import rodimpact as ri
from rodimpact.methods.fronts.method import make_run, totals_of
from rodimpact.methods.restitution import effective_restitution
from rodimpact.results.outcome import outcome_of

# Its impedance is the area of a rod, its transit time the length.
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def rod(Z, T, velocity=0.0):
    """A rod with this impedance and transit time."""
    return ri.Rod(T, area=Z, material=UNIT, velocity=velocity)


def segment(Z, T):
    """A segment with this impedance and transit time."""
    return ri.Segment(T, Z, UNIT)


def stepped(impedances, velocity=0.0):
    """A rod of segments of transit time 1."""
    return ri.Rod(segments=[segment(Z, 1.0) for Z in impedances], velocity=velocity)


def assert_stands_for(rigid, outcome):
    """The rigid bodies move as the rods do, and lose what the rods keep as
    vibration.
    """
    contact = outcome.unilateral[0]  # the contact that is no bond
    v1 = outcome.velocities_after[contact]
    v2 = outcome.velocities_after[contact + 1]
    assert rigid.velocity_1 == pytest.approx(v1, abs=1e-13)
    assert rigid.velocity_2 == pytest.approx(v2, abs=1e-13)
    assert rigid.impulse == pytest.approx(outcome.impulse, rel=1e-13)
    vibration_before = sum(outcome.vibration_before)
    gained = sum(outcome.vibration_after) - vibration_before
    assert rigid.energy_lost == pytest.approx(gained, abs=1e-13)


# Walls
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("wall", [0.0, -0.25, 0.5])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_stepped_rod_on_a_wall_as_a_rigid_body_of_its_restitution(wall, mirrored):
    """The thick end of a rod stepped 3 : 1 leaves a wall with e = 1/2.

    `wall` is the velocity of the wall. The energy of its infinite mass is infinite if
    it moves.
    """
    mass = 4.0  # of the rod, kg
    closing = 1.0 - wall
    system = ri.System([stepped([1.0, 3.0], velocity=1.0), ri.Wall(wall)])

    if mirrored:
        outcome = ri.solve(system.mirrored()).outcome
        rigid = outcome.as_rigid()
        rod_velocity = -rigid.velocity_2
        wall_velocity = -rigid.velocity_1
    else:
        outcome = ri.solve(system).outcome
        rigid = outcome.as_rigid()
        rod_velocity = rigid.velocity_1
        wall_velocity = rigid.velocity_2

    e = 0.5
    impulse = mass * (1 + e) * closing
    energy_lost = (1 - e**2) * mass * closing**2 / 2
    assert wall_velocity == wall
    assert rod_velocity == pytest.approx(wall - e * closing)
    assert rigid.impulse == pytest.approx(impulse)
    assert rigid.energy_lost == pytest.approx(energy_lost)
    wall_moves = wall != 0
    assert math.isinf(rigid.energy_before) == wall_moves
    assert_stands_for(rigid, outcome)


# Stepped and bonded rods
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("impedances", "e"),
    [([1, 3], 1.0), ([3, 1], 1 / 2), ([1, 2], 23 / 27), ([2, 1], 7 / 9)],
)
def test_mirror_images_of_stepped_rods_part_with_their_restitution(impedances, e):
    """A stepped rod collides with its mirror image: the restitution is that of each on
    a wall by its closed form, and the centre of mass stays at rest.
    """
    left = stepped(impedances[::-1], velocity=1.0)
    right = stepped(impedances, velocity=-1.0)
    outcome = ri.collide(left, right)
    rigid = outcome.as_rigid()
    closing = 2.0  # m/s
    assert rigid.relative_velocity_after == pytest.approx(closing * e)
    assert rigid.centre_of_mass_velocity == pytest.approx(0.0, abs=1e-15)
    assert_stands_for(rigid, outcome)


def test_bonded_rods_are_as_rigid_as_rods_in_one_piece():
    """Five rods in two bonded groups have the rigid quantities, `as_rigid`, of two
    stepped rods with the same segments; the velocity of the centre of mass is 3/11 m/s.
    """
    bond = ri.Bonded()
    rods = [
        rod(1.0, 1.0, velocity=1.0),
        rod(2.0, 1.0, velocity=1.0),
        rod(3.0, 2.0),
        rod(1.0, 1.0),
        rod(0.5, 2.0),
    ]
    bonded = ri.System(rods, contacts=[bond, ri.Rigid(), bond, bond])
    striker = stepped([1.0, 2.0], velocity=1.0)
    segments = [segment(3.0, 2.0), segment(1.0, 1.0), segment(0.5, 2.0)]
    struck = ri.Rod(segments=segments)
    in_one_piece = ri.collide(striker, struck)

    outcome = ri.solve(bonded).outcome

    rigid = outcome.as_rigid()
    assert rigid == pytest.approx(in_one_piece.as_rigid(), rel=1e-13)
    moving = 3.0  # kg, at 1 m/s; the mass of a rod here is Z T
    at_rest = 8.0  # kg
    centre_of_mass_velocity = moving * 1.0 / (moving + at_rest)
    assert rigid.centre_of_mass_velocity == pytest.approx(centre_of_mass_velocity)
    assert_stands_for(rigid, outcome)


# Held at both ends
# --------------------------------------------------------------------------------------

OPTIONS = {
    "fronts": {},
    "characteristics": {},
    "finite-difference": {"cells": 400},
}
ERRORS = {"fronts": 1e-14, "characteristics": 1e-14, "finite-difference": 2e-3}


def held(rod, left, right):
    """A rod whose ends follow walls of these velocities; `None` for a fixed end."""
    bodies = [rod]
    left_end = ri.Fixed()
    right_end = ri.Fixed()
    if left is not None:
        bodies.insert(0, ri.Wall(left))
        left_end = ri.Free()
    if right is not None:
        bodies.append(ri.Wall(right))
        right_end = ri.Free()
    n_contacts = len(bodies) - 1
    bonds = [ri.Bonded()] * n_contacts
    return ri.System(bodies, contacts=bonds, ends=(left_end, right_end))


@pytest.mark.parametrize("mirrored", few_of([False, True], [True]))
@pytest.mark.parametrize(
    ("left", "right", "direction"), [(1.0, 0.0, 1), (1.0, None, 1), (None, -1.0, -1)]
)
@pytest.mark.parametrize(("method", "error"), ERRORS.items())
def test_a_rod_between_walls_that_move_apart_has_its_own_velocity(
    method, error, left, right, direction, mirrored
):
    """At 1.25 s the wave from the moving wall is reflected at the other end and has run
    back through a quarter of the rod: this quarter is at rest, the others have 1 m/s.

    `None` stands for a fixed end, and `direction` for the sign of the velocity.
    """
    system = held(rod(1.0, 1.0), left, right)
    if mirrored:
        system = system.mirrored()
        direction = -direction

    outcome = ri.solve(system, 1.25, method, **OPTIONS[method]).outcome

    velocities_before = outcome.velocities_before
    velocities_after = outcome.velocities_after
    for i, body in enumerate(system.bodies):
        before = velocities_before[i]
        after = velocities_after[i]
        if isinstance(body, ri.Wall):
            assert before == body.velocity
            assert after == body.velocity
        else:
            assert before == pytest.approx(0.0, abs=error)
            assert after == pytest.approx(direction * 0.75, abs=error)
    # The rod has E A = 1, a mass of 1 kg and 1 m. Its mean velocity is 3/4 m/s.
    rigid_motion = 0.75**2 / 2
    kinetic = 0.75 * 1.0**2 / 2
    elastic = (0.75 * 1.0**2 + 0.25 * 2.0**2) / 2  # its strain is 1, then 2
    vibration = kinetic + elastic - rigid_motion
    assert sum(outcome.vibration_after) == pytest.approx(vibration, abs=error)
    assert outcome.kinetic_after == pytest.approx(rigid_motion, abs=error)
    assert outcome.final  # no contact of this row can open


@pytest.mark.parametrize(
    ("left", "right", "velocity"),
    [(0.5, 0.5, 0.5), (0.0, None, 0.0), (None, 0.0, 0.0), (None, None, 0.0)],
)
@pytest.mark.parametrize("method", OPTIONS)
def test_a_rod_between_walls_of_one_velocity_has_it_after(
    method, left, right, velocity
):
    """A rod held by two walls of one velocity has exactly this velocity after, as the
    walls.
    """
    moving_rod = rod(1.0, 1.0, velocity=1.0)
    system = held(moving_rod, left, right)
    outcome = ri.solve(system, 1.25, method, **OPTIONS[method]).outcome
    assert set(outcome.velocities_after) == {velocity}


# Where nothing parts
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "impedances", [(1, 2, 4), (1, 3, 9), (1, 1.5, 3), (2, 3, 4), (1, 5, 1), (4, 1, 4)]
)
def test_a_bar_without_end_that_a_wall_pushes_stays_at_the_wall(impedances, mirrored):
    """A moving wall meets a bar whose far end absorbs: e = 0, by `solve` and by
    `sweep`, also mirrored.
    """
    bodies = [ri.Wall(1.0), stepped(impedances)]
    system = ri.System(bodies, ends=(ri.Free(), ri.Absorbing()))
    if mirrored:
        system = system.mirrored()
    assert ri.solve(system).outcome.restitution == 0.0
    assert ri.sweep(system).restitution == 0.0


def test_a_restitution_of_round_off_is_0_and_a_small_one_stays():
    """`parting` is the relative velocity afterwards, of six members that close at 1
    m/s.
    """
    parting = np.array([-1e-3, -6e-14, 0.0, 6e-14, 5e-12, 0.4])  # m/s
    before = (np.ones(6), np.zeros(6))  # they close at 1 m/s
    after = (np.zeros(6), parting)
    e = effective_restitution(final=True, episodes=1, before=before, after=after)
    assert e.tolist() == [0.0, 0.0, 0.0, 0.0, 5e-12, 0.4]


def test_a_restitution_of_the_round_off_of_a_common_velocity_is_0():
    """Velocities after that differ by the last bit of 1e4 m/s give e = 0."""
    common = 1e4  # m/s
    next_velocity = math.nextafter(common, math.inf)
    before = (common + 0.125, common)
    after = (common, next_velocity)
    e = effective_restitution(final=True, episodes=1, before=before, after=after)
    assert e == 0.0


def test_bodies_that_have_not_parted_have_no_restitution():
    """e is NaN for a collision that is not over, with velocities equal to 1e-14 m/s."""
    before = (1.0, 0.0)
    after = (0.0, -1e-14)
    e = effective_restitution(final=False, episodes=1, before=before, after=after)
    assert np.isnan(e)


# Vibration before
# --------------------------------------------------------------------------------------


def test_the_film_backwards_has_the_inverse_restitution_and_releases_vibration():
    """The state at the end of a collision is turned round in time and solved."""
    e = 0.5  # of a rod that strikes one twice as long: the ratio of the lengths
    striker = rod(1.0, 1.0, velocity=1.0)
    struck = rod(1.0, 2.0)
    forwards = ri.solve(ri.System([striker, struck]))
    at_end = forwards.system_at(forwards.t_end)

    backwards = ri.solve(at_end.reversed()).outcome

    rigid = backwards.as_rigid()
    assert forwards.outcome.restitution == pytest.approx(e)
    assert backwards.restitution == pytest.approx(1 / e)
    # The bodies have their velocities before the collision, turned round.
    assert rigid.velocity_1 == pytest.approx(-1.0)
    assert rigid.velocity_2 == pytest.approx(0.0, abs=1e-13)
    lost_forwards = forwards.outcome.as_rigid().energy_lost
    assert rigid.energy_lost == pytest.approx(-lost_forwards)
    assert_stands_for(rigid, backwards)


# Balances
# --------------------------------------------------------------------------------------

PULSE = ri.Steps([2.0, 0.0], [0.5])
TWO_WAVES = ri.Steps([3.0, -1.0], [0.5])


@pytest.mark.parametrize(
    ("system", "until", "momentum", "energy"),
    [
        # M is all mass, V the largest difference of velocities: M V and M V^2/2 always
        # count. Rods of mass 1 and 2, V = 3: J = 3, and 1 2^2/2 + 2 1^2/2.
        pytest.param(
            ri.System([rod(1, 1, velocity=2.0), rod(1, 2, velocity=-1.0)]),
            None,
            12.0,
            16.5,
            id="pair",
        ),
        # A wave of half a rod, V = 4: no impulse, and m 3^2/4 + m 1^2/4.
        pytest.param(ri.System([rod(1, 1, TWO_WAVES)]), 1.0, 4.0, 10.5, id="wave"),
        # Held at its left end, V = 2: the impulse Z v T of that end, and m v^2/2.
        pytest.param(
            ri.System([rod(1, 1, velocity=-2.0)], ends=(ri.Fixed(), ri.Free())),
            1.0,
            4.0,
            4.0,
            id="fixed end",
        ),
        # An absorbing end, V = 2: its impulse Z v T/4 and energy Z v^2 T/8, and m
        # v^2/4.
        pytest.param(
            ri.System([rod(1, 1, PULSE)], ends=(ri.Absorbing(), ri.Free())),
            1.0,
            2.5,
            3.5,
            id="absorbing end",
        ),
    ],
)
def test_what_is_missing_is_told_relative_to_what_took_part(
    system, until, momentum, energy
):
    """`momentum` and `energy` are all that took part, in N s and J.

    A little of both is added to the first segment of a run whose balances close.
    """
    run = tracked(system, until)
    closed_totals = totals_of(run)
    missing = 1e-3  # N s, and J
    missing_in_ticks = missing / run.clock.tick  # as the numbers of a segment count
    first_segment = run.segments[1]
    first_segment.momentum += missing_in_ticks
    first_segment.vibration_energy += missing_in_ticks
    spoilt_totals = totals_of(run)
    whole_run = make_run(run, until)

    closed = outcome_of(whole_run, closed_totals)
    outcome = outcome_of(whole_run, spoilt_totals)

    assert closed_totals.momentum_residual == pytest.approx(0.0, abs=1e-14)
    assert closed_totals.energy_residual == pytest.approx(0.0, abs=1e-14)
    assert outcome.momentum_residual == pytest.approx(missing / momentum, rel=1e-9)
    assert outcome.energy_residual == pytest.approx(missing / energy, rel=1e-9)
    sentence = "does not close: .* of the momentum and .* of the energy"
    assert re.search(sentence, outcome.status)
    assert outcome.status.startswith(closed.status)


def test_a_light_rod_that_hits_a_heavy_one_closes_its_balances():
    """Waves in the heavy rod are below the smallest front; they are no missing
    momentum.
    """
    steel = ri.materials.steel
    light = ri.Rod(0.0537, area=6.77e-12, material=steel, velocity=80.0)
    heavy = ri.Rod(5.56e-5, area=6.6e5, material=steel)
    outcome = ri.solve(ri.System([light, heavy]), until=1e-3).outcome
    assert abs(outcome.momentum_residual) < 1e-12  # round-off
    assert "balance" not in outcome.status
