"""What a collision did: `Outcome.as_rigid` in rigid-body mechanics, and what its balances miss."""

import math
import re

import numpy as np
import pytest
from runs import tracked

import rodimpact as ri
from rodimpact.methods.fronts.method import make_run, totals_of
from rodimpact.methods.restitution import effective_restitution
from rodimpact.results.outcome import outcome_of as read

UNIT = ri.Material(
    "unit", youngs_modulus=1.0, density=1.0
)  # impedance = area, transit = length


def rod(Z, T, velocity=0.0, **more):
    return ri.Rod(T, area=Z, material=UNIT, velocity=velocity, **more)


def stepped(impedances, velocity=0.0):
    """A rod of pieces of transit time 1."""
    return ri.Rod(
        segments=[ri.Segment(1.0, Z, UNIT) for Z in impedances], velocity=velocity
    )


def outcome_of(*bodies, **more):
    return ri.solve(ri.System(list(bodies), **more)).outcome


def assert_stands_for(body, outcome):
    """The rigid bodies move as the rods do, and lose what the rods keep as vibration."""
    k = outcome.unilateral[0]
    assert body.velocity_1 == pytest.approx(outcome.velocities_after[k], abs=1e-13)
    assert body.velocity_2 == pytest.approx(outcome.velocities_after[k + 1], abs=1e-13)
    assert body.impulse == pytest.approx(outcome.impulse, rel=1e-13)
    gained = sum(outcome.vibration_after) - sum(outcome.vibration_before)
    assert body.energy_lost == pytest.approx(gained, abs=1e-13)


# Walls


@pytest.mark.parametrize("wall", [0.0, -0.25, 0.5])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_rod_on_a_wall(wall, mirrored):
    # The thick end of a rod stepped 3 : 1 leaves a wall with e = 1/2.
    system = ri.System([stepped([1.0, 3.0], velocity=1.0), ri.Wall(wall)])
    outcome = ri.solve(system.mirrored() if mirrored else system).outcome
    body = outcome.as_rigid()
    moved = body.velocity_1
    kept = body.velocity_2
    if mirrored:
        moved, kept = -kept, -moved
    assert kept == wall
    assert moved == pytest.approx(wall - (1 - wall) / 2)
    assert body.impulse == pytest.approx(4 * 1.5 * (1 - wall))
    assert body.energy_lost == pytest.approx(0.75 * 4 * (1 - wall) ** 2 / 2)
    assert math.isinf(body.energy_before) == (wall != 0)
    assert_stands_for(body, outcome)


# Stepped and bonded rods


@pytest.mark.parametrize(
    ("impedances", "e"),
    [([1, 3], 1.0), ([3, 1], 1 / 2), ([1, 2], 23 / 27), ([2, 1], 7 / 9)],
)
def test_mirror_images_of_stepped_rods(impedances, e):
    outcome = ri.collide(stepped(impedances[::-1], 1.0), stepped(impedances, -1.0))
    body = outcome.as_rigid()
    assert body.relative_velocity_after == pytest.approx(2 * e)
    assert body.centre_of_mass_velocity == pytest.approx(0.0, abs=1e-15)
    assert_stands_for(body, outcome)


def test_masses_of_bonded_rods_are_summed():
    rigid_contact = ri.Rigid()
    bonded = ri.Bonded()
    outcome = outcome_of(
        rod(1.0, 1.0, 1.0),
        rod(2.0, 1.0, 1.0),
        rod(3.0, 2.0),
        rod(1.0, 1.0),
        rod(0.5, 2.0),
        contacts=[bonded, rigid_contact, bonded, bonded],
    )
    in_one_piece = ri.collide(
        stepped([1.0, 2.0], 1.0),
        ri.Rod(
            segments=[
                ri.Segment(*piece, UNIT)
                for piece in ((2.0, 3.0), (1.0, 1.0), (2.0, 0.5))
            ]
        ),
    )
    body = outcome.as_rigid()
    assert body == pytest.approx(in_one_piece.as_rigid(), rel=1e-13)
    assert body.centre_of_mass_velocity == pytest.approx(3 / (3 + 8))
    assert_stands_for(body, outcome)


# Held at both ends

METHODS = {"fronts": 1e-14, "characteristics": 1e-14, "finite-difference": 2e-3}


def held(piece, left, right):
    """A rod whose ends follow walls; `None` for a fixed end."""
    bodies = [piece]
    for v, place in ((left, 0), (right, 2)):
        if v is not None:
            bodies.insert(place, ri.Wall(v))
    ends = [ri.Fixed() if v is None else ri.Free() for v in (left, right)]
    return ri.System(bodies, contacts=[ri.Bonded()] * (len(bodies) - 1), ends=ends)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("walls", [(1.0, 0.0), (1.0, None), (None, -1.0)])
@pytest.mark.parametrize("method", METHODS)
def test_a_rod_between_walls_that_move_apart_has_its_own_velocity(
    method, walls, mirrored
):
    # The wave of the one that moves has been at the other and come back a quarter of the way.
    system = held(rod(1.0, 1.0), *walls)
    turn = -1 if mirrored else 1
    if walls[0] is None:
        turn = -turn
    if mirrored:
        system = system.mirrored()
    outcome = ri.solve(system, 1.25, method).outcome
    near = METHODS[method]
    for body, before, after in zip(
        system.bodies, outcome.velocities_before, outcome.velocities_after, strict=True
    ):
        if isinstance(body, ri.Wall):
            assert before == after == body.velocity
        else:
            assert before == pytest.approx(0.0, abs=near)
            assert after == pytest.approx(turn * 0.75, abs=near)
    assert sum(outcome.vibration_after) == pytest.approx(0.96875, abs=near)
    assert outcome.kinetic_after == pytest.approx(0.75**2 / 2, abs=near)
    assert outcome.final  # no contact of this row can open


@pytest.mark.parametrize("walls", [(0.5, 0.5), (0.0, None), (None, 0.0), (None, None)])
@pytest.mark.parametrize("method", METHODS)
def test_a_rod_between_walls_of_one_velocity_has_theirs(method, walls):
    outcome = ri.solve(held(rod(1.0, 1.0, 1.0), *walls), 1.25, method).outcome
    assert set(outcome.velocities_after) == {walls[0] or 0.0}


# Where nothing parts


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "impedances", [(1, 2, 4), (1, 3, 9), (1, 1.5, 3), (2, 3, 4), (1, 5, 1), (4, 1, 4)]
)
def test_a_bar_without_end_that_a_wall_pushes_stays_at_the_wall(impedances, mirrored):
    system = ri.System(
        [ri.Wall(1.0), stepped(impedances)], ends=(ri.Free(), ri.Absorbing())
    )
    if mirrored:
        system = system.mirrored()
    assert ri.solve(system).outcome.restitution == 0.0
    assert ri.sweep(system).restitution == 0.0


def test_round_off_is_no_restitution_and_a_small_one_is():
    parting = np.array([-1e-3, -6e-14, 0.0, 6e-14, 5e-12, 0.4])
    after = (np.zeros(6), parting)
    e = effective_restitution(True, 1, (np.ones(6), np.zeros(6)), after)
    assert e.tolist() == [0.0, 0.0, 0.0, 0.0, 5e-12, 0.4]
    far = effective_restitution(
        True, 1, (1e4 + 0.125, 1e4), (1e4, math.nextafter(1e4, 2e4))
    )
    assert float(far) == 0.0
    assert np.isnan(effective_restitution(False, 1, (1.0, 0.0), (0.0, -1e-14)))


# Vibration before


def test_the_film_backwards_releases_vibration():
    forwards = ri.solve(ri.System([rod(1.0, 1.0, 1.0), rod(1.0, 2.0)]))
    outcome = ri.solve(forwards.system_at(forwards.t_end).reversed()).outcome
    body = outcome.as_rigid()
    assert forwards.outcome.restitution == pytest.approx(0.5)
    assert outcome.restitution == pytest.approx(2.0)
    assert body.velocity_1 == pytest.approx(-1.0)
    assert body.velocity_2 == pytest.approx(0.0, abs=1e-13)
    assert body.energy_lost == pytest.approx(-forwards.outcome.as_rigid().energy_lost)
    assert_stands_for(body, outcome)


# Balances


@pytest.mark.parametrize(
    ("bodies", "ends", "until", "momentum", "energy"),
    [
        # M is all mass, V the largest difference of velocities: M V and M V^2/2 always count.
        # two rods of mass 1 and 2, V = 3: J = 3, and 1 2^2/2 + 2 1^2/2
        ([rod(1, 1, 2.0), rod(1, 2, -1.0)], (ri.Free(), ri.Free()), None, 12.0, 16.5),
        # a wave of half a rod, V = 4: no impulse, and m 3^2/4 + m 1^2/4
        (
            [rod(1, 1, ri.Steps([3.0, -1.0], [0.5]))],
            (ri.Free(), ri.Free()),
            1.0,
            4.0,
            10.5,
        ),
        # held at its left end, V = 2: the impulse Z v T of that end, and m v^2/2
        ([rod(1, 1, -2.0)], (ri.Fixed(), ri.Free()), 1.0, 4.0, 4.0),
        # an absorbing end, V = 2: its impulse Z v T/4 and energy Z v^2 T/8, and m v^2/4
        (
            [rod(1, 1, ri.Steps([2.0, 0.0], [0.5]))],
            (ri.Absorbing(), ri.Free()),
            1.0,
            2.5,
            3.5,
        ),
    ],
)
def test_what_is_missing_is_told_relative_to_what_took_part(
    bodies, ends, until, momentum, energy
):
    run = tracked(ri.System(bodies, ends=ends), until)
    whole = totals_of(run)
    assert whole.momentum_residual == pytest.approx(0.0, abs=1e-14)
    assert whole.energy_residual == pytest.approx(0.0, abs=1e-14)
    run.segments[1].momentum += 1e-3 / run.clock.tick
    run.segments[1].vibration_energy += 1e-3 / run.clock.tick
    wrong = totals_of(run)
    told = read(make_run(run, until), wrong)
    assert told.momentum_residual == pytest.approx(1e-3 / momentum, rel=1e-9)
    assert told.energy_residual == pytest.approx(1e-3 / energy, rel=1e-9)
    assert re.search(
        "does not close: .* of the momentum and .* of the energy", told.status
    )
    assert told.status.startswith(read(make_run(run, until), whole).status)


def test_a_light_rod_that_hits_a_heavy_one_closes_its_balances():
    """Waves in the heavy rod are below the smallest front; they are no missing momentum."""
    steel = ri.materials.steel
    light = ri.Rod(0.0537, area=6.77e-12, material=steel, velocity=80.0)
    heavy = ri.Rod(5.56e-5, area=6.6e5, material=steel)
    outcome = ri.solve(ri.System([light, heavy]), until=1e-3).outcome
    assert abs(outcome.momentum_residual) < 1e-12
    assert "balance" not in outcome.status
