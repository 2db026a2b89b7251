"""Blows on a pile: when one is over, what the next one finds, and what is no pile."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from lumped_pile import LumpedPile, strike_again

import rodimpact as ri
from rodimpact.methods import kernels

STEEL = ri.materials.steel
SOIL = ri.Soil(300e3, quake=2.5e-3, damping=0.16)
TOE = ri.SmithToe(300e3, quake=2.5e-3, damping=0.5)
PILE = ri.Rod(15.0, area=9.4e-3, material=STEEL, shaft=SOIL)
RAM = ri.RigidMass(4536.0, velocity=3.466)
HELMET = ri.RigidMass(510.0)
CUSHION = ri.Cushion(5e8, restitution=0.8)
ONE_ROD_PILE = ri.System([RAM, PILE, ri.Wall()], contacts=[CUSHION, TOE])
WITH_HELMET = ri.System(
    [RAM, HELMET, PILE, ri.Wall()], contacts=[CUSHION, ri.Spring(2e9), TOE]
)
needs_compiler = pytest.mark.skipif(
    not kernels.enabled(), reason="takes long in plain Python"
)


def random_soil(rng, length):
    """Random soil along a rod of this length; half of it in two layers."""
    resistance = float(rng.uniform(50e3, 500e3))  # N
    if rng.random() < 0.5:
        share_of_layers = rng.uniform(0.1, 1.0, 2)
        per_length = share_of_layers * resistance / length  # N/m
        boundary = length * rng.uniform(0.1, 0.9)
        resistance = ri.Steps(per_length.tolist(), [boundary])
    quake = float(rng.uniform(1e-3, 5e-3))
    damping = float(rng.choice([0.0, rng.uniform(0.05, 0.6)]))
    law = str(rng.choice(["smith", "viscous"]))
    return ri.Soil(resistance, quake=quake, damping=damping, law=law)


def random_toe(rng):
    """The contact of a toe with random soil below it."""
    resistance = float(rng.uniform(100e3, 600e3))  # N
    quake = float(rng.uniform(1e-3, 8e-3))  # m
    damping = float(rng.choice([0.0, rng.uniform(0.1, 1.0)]))
    return ri.SmithToe(resistance, quake=quake, damping=damping)


def random_pile(seed):
    """A pile in random soil, with or without a helmet, weight, damping and a second
    rod.

    A pile with weight is at rest.
    """
    rng = np.random.default_rng(seed)
    length = float(rng.uniform(5.0, 20.0))
    pile = PILE.replace(length=length, shaft=random_soil(rng, length))
    toe = random_toe(rng)
    velocity = float(rng.uniform(1.0, 4.0))
    mass = float(rng.uniform(500, 5000))
    ram = ri.RigidMass(mass, velocity=velocity)
    restitution = float(rng.uniform(0.5, 1.0))
    cushion = ri.Cushion(5e8, restitution=restitution)
    bodies = [ram]
    contacts = [cushion]
    if rng.random() < 0.5:
        bodies.append(HELMET)
        contacts.append(ri.Spring(2e9))
    bodies.append(pile)
    if rng.random() < 0.3:
        soil = random_soil(rng, 3.0)
        second_rod = PILE.replace(length=3.0, shaft=soil)
        bodies.append(second_rod)
        contacts.append(ri.Bonded())
    bodies.append(ri.Wall())
    contacts.append(toe)
    system = ri.System(bodies, contacts=contacts)
    if rng.random() < 0.4:
        with_weight = system.replace(gravity=9.81)
        system = ri.at_rest(with_weight, cells=24)
    return system


def is_held(body):
    """Whether soil holds a body along its shaft."""
    return getattr(body, "shaft", None) is not None


def without_caught(run, hammer):
    """The state when a run ends, a System, without masses that are off and rise.

    These are masses from the top on, of the `hammer` rigid masses above the pile: they
    have been off for two transits of the row.
    """
    end = run.t_end
    state = run.system_at(end)
    transits = [getattr(body, "transit_time", 0.0) for body in state.bodies]
    round_trip = 2 * sum(transits)
    times = np.linspace(end - round_trip, end, 2000)
    caught = 0
    while caught < hammer:
        gap = run.contacts[caught].gap(times)
        is_off = np.all(gap > 0)
        falls = run.mean_velocity(caught, end) > 0  # to the right is down
        if falls or not is_off:
            break
        caught += 1
    return state.replace(
        bodies=state.bodies[caught:],
        gaps=state.gaps[caught:],
        contacts=state.contacts[caught:],
    )


def hammer_size(run):
    """Number of rigid masses above the pile."""
    return run.system.kinds.index("rod")


@pytest.mark.exhaustive
@needs_compiler
@pytest.mark.parametrize("seed", few_of(range(40), [1, 2]))
def test_a_blow_that_is_over_makes_no_soil_yield_later(seed):
    """The run goes on for 0.3 s after the blow, without masses that fly up."""
    system = random_pile(seed)
    (blow,) = ri.blows(system, 1, cells=24)
    if not blow.is_over:
        # Only undamped soil may keep a pile, or a ram on it, in motion.
        dampings = [system.contacts[-1].damping]
        for body in system.bodies[-3:-1]:  # the rods, before the wall
            if is_held(body):
                dampings.append(body.shaft.damping)
        assert 0.0 in dampings
        return
    last = blow.solution
    if blow.settling is not None:  # the run of the pile without the caught ram
        last = blow.settling
    state = without_caught(last, hammer_size(last))

    later = ri.solve(state, until=0.3, cells=24)

    toe_set = later.contacts[-1].permanent_set()
    assert toe_set == pytest.approx(0.0, abs=1e-12)
    for i, body in enumerate(state.bodies):
        if is_held(body):
            profile = later.soil(i, later.t_end)
            assert profile.plastic_set == pytest.approx(0.0, abs=1e-12)


@pytest.mark.exhaustive
@needs_compiler
def test_the_ram_is_caught_after_its_first_bounce():
    """Ram and helmet fly up at 0.9 m/s and would come down again, hard, after 0.21 s.
    The blow ends before, even if a later end is given, so that the second impact is
    part of neither set nor tension.
    """
    soil = SOIL.replace(quake=2.54e-3)
    pile = ri.Rod(18.3, area=0.01, material=STEEL, shaft=soil)
    toe = TOE.replace(resistance=620e3, quake=2.54e-3)
    ram = RAM.replace(velocity=3.96)
    helmet = ri.RigidMass(680.0)
    cushion = CUSHION.replace(loading=3.5e9)
    bodies = [ram, helmet, pile, ri.Wall()]
    contacts = [cushion, ri.Rigid(), toe]
    system = ri.System(bodies, contacts=contacts, gravity=9.81)
    resting = ri.at_rest(system, cells=40)

    (blow,) = ri.blows(resting, 1, cells=40)
    (long,) = ri.blows(resting, 1, cells=40, until=0.5)

    tension = blow.tension
    assert blow.is_over
    assert tension.t < 0.1
    assert long.solution.t_end < 0.13
    assert long.set == pytest.approx(blow.set, rel=1e-4)
    assert long.tension.stress == pytest.approx(tension.stress, rel=0.05)
    # The ram does strike hard if nothing catches it.
    uncaught = ri.solve(resting, until=0.5, cells=40)
    times_of_return = np.linspace(0.15, 0.5, 1000)
    second_impact = uncaught.contacts[1].force(times_of_return)
    second_tension = uncaught.extreme_stress(2).tension
    assert second_impact.max() > 1e5
    assert second_tension.stress > 5 * tension.stress


@needs_compiler
def test_a_ram_that_rattles_on_the_pile_is_not_caught():
    """A ram leaves the pile for less than a round trip of waves, more than twice, and
    is struck again from below: the blow goes on beyond 0.03 s.
    """
    system = random_pile(1)  # its ram rattles

    (blow,) = ri.blows(system, 1, cells=24)

    end = blow.solution.t_end
    times = np.linspace(0.0, end, 2000)
    force = blow.solution.contacts[0].force(times)
    presses = force[:-1] > 0
    lets_go = presses & (force[1:] == 0)  # from each time to the next
    assert end > 0.03
    assert np.count_nonzero(lets_go) > 2


@pytest.mark.exhaustive
@needs_compiler
def test_a_pile_comes_to_rest_where_a_blow_says():
    """A run 30 times as long as the blow ends with the same displacement and mobilised
    soil.
    """
    (blow,) = ri.blows(ONE_ROD_PILE, 1, cells=40)

    until = 30 * blow.solution.t_end
    later = ri.solve(ONE_ROD_PILE, until=until, cells=40, snapshots=300)

    late_times = [0.9 * until, until]
    toe_displacement = later.displacement(1, PILE.length, late_times)
    assert toe_displacement == pytest.approx(blow.displacement, abs=1e-7)
    mobilised = later.soil(1, until).mobilised  # [node]
    _, resting_pile, _ = blow.next_system.bodies
    expected = np.array(resting_pile.shaft.mobilised.values)
    assert mobilised == pytest.approx(expected, abs=2e-4)


LUMPED = LumpedPile(
    ram_mass=RAM.mass,
    ram_velocity=RAM.velocity,
    cushion=CUSHION.stiffness,
    length=PILE.length,
    area=9.4e-3,
    modulus=STEEL.youngs_modulus,
    density=STEEL.density,
    shaft_resistance=SOIL.resistance,
    toe_resistance=TOE.resistance,
    quake=SOIL.quake,  # and of the toe
    shaft_damping=SOIL.damping,
    toe_damping=TOE.damping,
    is_viscous=True,
)
"""The pile of one rod with an elastic cushion, in viscous soil, as a chain of masses.
"""


@needs_compiler
def test_sets_of_blows_grow_as_those_of_a_chain_of_lumped_masses_and_get_steady():
    """The first blow leaves residual stress, with which the next one drives deeper.

    In a steady series the pile moves with every blow by its set.
    """
    viscous_pile = PILE.replace(shaft=SOIL.replace(law="viscous"))
    elastic_cushion = ri.Spring(CUSHION.stiffness)
    bodies = [RAM, viscous_pile, ri.Wall()]
    system = ri.System(bodies, contacts=[elastic_cushion, TOE])

    series = ri.blows(system, 3, cells=50)

    lumped_sets = strike_again(LUMPED, 2, segments=60, duration=0.15, step=2e-5)
    first, second, third = series
    first_sets = [first.set, second.set]
    assert first_sets == pytest.approx(lumped_sets, rel=1e-3)
    assert second.set > 1.01 * first.set
    assert third.displacement == pytest.approx(third.set, rel=1e-3)


@needs_compiler
@pytest.mark.parametrize("gravity", few_of([0.0, 9.81], [9.81]))
def test_a_pile_is_at_rest_between_blows(gravity):
    """After a blow, the next system has the first ram and helmet and no gap. If its ram
    rises, the pile does not move within 20 ms, though it has residual stress. With and
    without gravity.
    """
    system = WITH_HELMET
    if gravity > 0:
        with_weight = system.replace(gravity=gravity)
        system = ri.at_rest(with_weight, cells=30)

    blow, _ = ri.blows(system, 2, cells=30)
    between = blow.next_system

    ram, helmet, pile, wall = between.bodies
    assert ram == system.bodies[0]
    assert helmet == system.bodies[1]
    assert between.gaps[0] == 0.0
    # A ram that rises leaves the pile alone: it stays at rest, with residual stress.
    rising_ram = RAM.replace(velocity=-1.0)
    lifted = between.replace(bodies=[rising_ram, helmet, pile, wall])
    until = 0.02  # s
    motion = ri.solve(lifted, until=until, cells=30)
    t = np.linspace(0.0, until, 40)
    x = np.linspace(0.0, PILE.length, 31)[:, np.newaxis]
    velocity = motion.velocity(2, x, t)  # m/s [position, time]
    residual_stress = motion.stress(2, x, 0.0)  # Pa [position, 1]
    assert np.abs(velocity).max() < 1e-7
    assert np.abs(residual_stress).max() > 1e6


def test_a_blow_that_is_cut_short_says_so_and_has_no_next_one():
    """Three blows of 5 ms are asked for: there is one, not over, with no next system, a
    displacement of nan, and advice.
    """
    series = ri.blows(ONE_ROD_PILE, 3, cells=20, until=5e-3)

    assert len(series) == 1
    (blow,) = series
    assert not blow.is_over
    assert blow.next_system is None
    assert math.isnan(blow.displacement)
    assert "Not over after 5 ms" in blow.status
    assert "raise until=" in blow.status


def test_a_blow_prints_as_a_sentence():
    """A blow prints set, compression, status and, without tension, "no tension"; its
    repr is short.
    """
    (blow,) = ri.blows(ONE_ROD_PILE, 1, cells=20, until=5e-3)
    no_tension = blow.tension._replace(stress=0.0)
    without_tension = blow._replace(tension=no_tension)

    sentence = str(blow)

    assert sentence.startswith("set ")
    assert "largest compression " in sentence
    assert blow.status in sentence
    assert len(repr(blow)) < 400  # no arrays
    assert "no tension" in str(without_tension)


def test_nothing_holds_a_bare_pile_without_weight_for_a_second_blow():
    """Two blows are asked for on a pile without soil and weight: there is only one,
    over, whose status says why; its blow count is 1/set.
    """
    bare_pile = PILE.replace(shaft=None)
    bodies = [RAM, bare_pile, ri.Wall()]
    bare = ri.System(bodies, contacts=[CUSHION, TOE])

    series = ri.blows(bare, 2, cells=20)

    (blow,) = series  # there is no second one
    assert blow.is_over
    assert "no soil holds" in blow.status
    blows_per_metre = 1 / blow.set
    assert blow.blow_count == pytest.approx(blows_per_metre)


@pytest.mark.exhaustive
def test_drag_along_a_shaft_bears_nothing_at_rest_and_is_no_share_of_resistance():
    """A pile of a rod with drag and one in soil: the blow ends and the drag is
    unchanged after it; the share of the shaft, 0.5, leaves the drag out. Too few cells
    are refused.
    """
    dragged = PILE.replace(length=2.0, shaft=ri.Drag(3e3))
    bodies = [RAM, dragged, PILE, ri.Wall()]
    laws = [CUSHION, ri.Bonded(), TOE]
    system = ri.System(bodies, contacts=laws)
    with_weight = system.replace(gravity=9.81)
    at_rest = ri.at_rest(with_weight, cells=20)

    (blow,) = ri.blows(at_rest, 1, cells=20)
    graph = ri.bearing_graph(system, 600e3, cells=16, until=0.01)

    assert blow.is_over
    next_dragged = blow.next_system.bodies[1]
    assert next_dragged.shaft == dragged.shaft
    assert graph.shaft_share == 0.5  # of SOIL and TOE, which bear 300 kN each
    # The short rod has too few cells of the coarse mesh that tells the errors.
    with pytest.raises(ri.InvalidModel, match=r"cells: half of them are too few"):
        ri.bearing_graph(system, 600e3, cells=8, until=0.01)


def test_a_pile_of_two_rods_has_set_and_tension_of_one_rod():
    """A pile of two bonded halves has the set of a whole one to 0.1 %, its largest
    tension to 2 %, and the position of this, measured from the head, to 1 m.
    """
    # The resistance of soil is that along the whole rod.
    half_soil = SOIL.replace(resistance=SOIL.resistance / 2)
    half_length = PILE.length / 2
    half = PILE.replace(length=half_length, shaft=half_soil)
    bodies = [RAM, half, half, ri.Wall()]
    laws = [CUSHION, ri.Bonded(), TOE]
    two = ri.System(bodies, contacts=laws)

    (one_rod,) = ri.blows(ONE_ROD_PILE, 1, cells=40, until=0.04)
    (two_rods,) = ri.blows(two, 1, cells=20, until=0.04)

    assert two_rods.set == pytest.approx(one_rod.set, rel=1e-3)
    tension = two_rods.tension
    expected = one_rod.tension
    assert tension.stress == pytest.approx(expected.stress, rel=0.02)
    # x is measured from the head of the pile, also in the second rod. Cells are 0.4 m
    # long.
    assert tension.x == pytest.approx(expected.x, abs=1.0)


REFUSED = [
    (ri.System([RAM, PILE]), "bodies: must end with a wall"),
    (
        ri.System([PILE, ri.Wall()]),
        "bodies: must be a ram, perhaps masses such as a helmet, a pile and a wall; "
        "these 2 lack the ram or the pile",
    ),
    (
        ri.System(
            [RAM.replace(velocity=-1.0), PILE, ri.Wall()], contacts=[CUSHION, TOE]
        ),
        "bodies.0: must be the ram",
    ),
    (
        ri.System([RAM, HELMET, ri.Wall()], contacts=[CUSHION, TOE]),
        "bodies: must have a Rod",
    ),
    (
        ri.System(
            [RAM, PILE.replace(velocity=1.0), ri.Wall()], contacts=[CUSHION, TOE]
        ),
        "bodies.1: must be at rest",
    ),
    (
        ri.System([RAM, PILE, ri.Wall()], contacts=[CUSHION, ri.Spring(1e8)]),
        "contacts.1: must be SmithToe",
    ),
    (
        ri.System(
            [RAM.replace(mass=[1.0, 2.0]), PILE, ri.Wall()], contacts=[CUSHION, TOE]
        ),
        "system: is a family",
    ),
]


@pytest.mark.parametrize(("system", "message"), REFUSED)
def test_a_row_that_is_no_pile_is_refused(system, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.blows(system, 1)


@pytest.mark.parametrize(
    "arguments", [{"count": 0}, {"count": 1, "cells": 1}, {"count": 1, "until": -1.0}]
)
def test_wrong_arguments_are_refused(arguments):
    with pytest.raises(ri.InvalidModel):
        ri.blows(ONE_ROD_PILE, **arguments)
