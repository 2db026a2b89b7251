"""Soil along the shaft of a rod: against a chain of lumped masses, and what it must
keep.
"""

import math

import numpy as np
import pytest
from exhaustive import few_of
from lumped_pile import LumpedPile, strike
from numpy.random import default_rng
from runs import step_ends

import rodimpact as ri
from rodimpact.methods import kernels

STEEL = ri.Material("pile steel", youngs_modulus=200e9, density=78.5e3 / 9.81)
SOFT = ri.Material("soft", youngs_modulus=1.0, density=1.0)
AREA = math.pi * 0.009525 * (0.3239 - 0.009525)  # of a pipe, m^2
RAM_MASS = 4536.19  # kg
RAM_VELOCITY = 3.466251  # m/s
CUSHION = 5e8  # N/m
QUAKE = 2.5e-3  # m
LENGTH = 15.0  # m


def rod_in(soil, velocity=1.0):
    """A rod of 1 m, 1 m^2 and the soft material, at 1 m/s if nothing else is said,
    in this soil.
    """
    return ri.Rod(1.0, area=1.0, material=SOFT, velocity=velocity, shaft=soil)


def pile_in_soil(soil, toe):
    """A ram that strikes a pile through a cushion, a system that is not solved.

    `soil` holds the shaft, None if nothing does; the contact law `toe` holds the tip.
    """
    ram = ri.RigidMass(RAM_MASS, velocity=RAM_VELOCITY)
    pile = ri.Rod(LENGTH, area=AREA, material=STEEL, shaft=soil)
    bodies = [ram, pile, ri.Wall()]
    cushion = ri.Spring(CUSHION)
    return ri.System(bodies, contacts=[cushion, toe])


def random_resistance(rng, length):
    """An even resistance, N, or one per length, N/m, that steps at a place of the
    shaft.
    """
    if rng.random() < 0.5:
        return float(rng.uniform(0, 3))
    values = rng.uniform(0, 3, 2)
    step = length * rng.uniform(0.1, 0.9)
    return ri.Steps(values.tolist(), at=[step])


def random_rod_in_soil(rng):
    """A rod of one segment, at random in soil of either law, and perhaps viscous."""
    length = float(rng.uniform(0.5, 2))
    resistance = random_resistance(rng, length)
    quake = 10 ** rng.uniform(-2, 0)
    some_damping = 10 ** rng.uniform(-2, 1)
    damping = rng.choice([0.0, some_damping])
    law = rng.choice(["smith", "viscous"])
    mobilised = rng.uniform(-1, 1)
    soil = ri.Soil(
        resistance,
        quake=float(quake),
        damping=float(damping),
        law=str(law),
        mobilised=float(mobilised),
    )
    viscosity = rng.choice([0.0, 0.05])
    area = float(rng.uniform(0.5, 2))
    material = SOFT.replace(viscosity=viscosity)
    velocity = float(rng.uniform(-1, 1))
    return ri.Rod(length, area=area, material=material, velocity=velocity, shaft=soil)


def random_pile(seed):
    """Two moving rods in different soils, in half of the cases with a wall at the
    toe.
    """
    rng = default_rng(seed)
    bodies = [random_rod_in_soil(rng), random_rod_in_soil(rng)]
    laws = [ri.Bonded(), ri.Rigid(), ri.Spring(5.0)]
    contact = laws[rng.integers(3)]
    contacts = [contact]
    if rng.random() < 0.5:
        toe = ri.SmithToe(1.0, quake=0.1, damping=0.5)
        bodies.append(ri.Wall())
        contacts.append(toe)
    gravity = float(rng.choice([0.0, 0.3]))
    return ri.System(bodies, contacts=contacts, gravity=gravity)


@pytest.mark.parametrize(
    ("resistance", "limit"),  # N, and m
    [(400e3, 65.726e-3), (800e3, 31.708e-3)],
)
def test_a_pile_with_a_toe_alone_is_set_by_the_limit_of_lumped_masses(
    resistance, limit
):
    """The set of the toe is the limit to which sets of a `LumpedPile` of ever more
    masses go.
    """
    toe = ri.SmithToe(resistance, quake=QUAKE)
    system = pile_in_soil(soil=None, toe=toe)

    exact = ri.solve(system, until=0.25)

    toe_set = exact.contacts[1].permanent_set()
    assert toe_set == pytest.approx(limit, rel=2e-5)


@pytest.mark.skipif(not kernels.enabled(), reason="takes long in plain Python")
@pytest.mark.exhaustive
@pytest.mark.parametrize("law", ["smith", "viscous"])
@pytest.mark.parametrize("resistance", [200e3, 600e3, 1000e3])
def test_a_blow_is_that_of_a_chain_of_lumped_masses(law, resistance):
    """Set of the toe, work on the soil and largest compression are those of a
    `LumpedPile`.
    """
    half = resistance / 2  # of the shaft, and of the toe, N
    soil = ri.Soil(half, quake=QUAKE, damping=0.16, law=law)
    toe = ri.SmithToe(half, quake=QUAKE, damping=0.5)
    system = pile_in_soil(soil, toe)
    chain = LumpedPile(
        ram_mass=RAM_MASS,
        ram_velocity=RAM_VELOCITY,
        cushion=CUSHION,
        length=LENGTH,
        area=AREA,
        modulus=STEEL.youngs_modulus,
        density=STEEL.density,
        shaft_resistance=half,
        toe_resistance=half,
        quake=QUAKE,
        shaft_damping=0.16,
        toe_damping=0.5,
        is_viscous=law == "viscous",
    )

    blow = ri.solve(system, until=0.1, cells=200)
    lumped = strike(chain, segments=150, duration=0.1, step=4e-6)

    toe_set = blow.contacts[1].permanent_set()
    compression = blow.extreme_stress(1).compression  # of the pile
    largest_compression = -compression.stress * AREA  # N
    soil_work = blow.outcome.soil_work
    expected_compression = lumped.largest_compression
    assert toe_set == pytest.approx(lumped.toe_set, rel=1e-3)
    assert soil_work == pytest.approx(lumped.soil_work, rel=1e-3)
    assert largest_compression == pytest.approx(expected_compression, rel=1e-2)


@pytest.mark.parametrize("seed", few_of(range(60), range(8)))
def test_balances_of_random_soils_close(seed):
    """Momentum and energy of random piles balance to round-off."""
    pile = random_pile(seed)

    outcome = ri.solve(pile, until=4.0, cells=24).outcome

    assert abs(outcome.momentum_residual) < 1e-13
    assert abs(outcome.energy_residual) < 1e-12


def outcome_of(system, compiling):
    """The outcome of 2 s as a dict, by machine code if `compiling`, else by Python."""
    with kernels.forced(compiling):
        solution = ri.solve(system, until=2.0, cells=16)
    return solution.outcome.to_dict()


@pytest.mark.parametrize("seed", few_of(range(12), range(3)))
def test_outcomes_of_random_soils_are_the_same_in_machine_code(seed):
    system = random_pile(seed)

    plain = outcome_of(system, compiling=False)
    compiled = outcome_of(system, compiling=True)

    assert plain == compiled


ELASTIC_SOIL = ri.Soil(50.0, quake=10.0, damping=1.0, mobilised=0.3)
"""It starts at 0.3 of its resistance of 50 N and does not come near to all of it."""


def energies_with_elastic_soil(soil):
    """Energy of a rod that soil swings to and fro, and of the springs of the soil, J.

    It has a value at the end of each step of 4 s [step + 1].
    """
    system = ri.System([rod_in(soil)])
    solution = ri.solve(system, until=4.0, cells=40)
    times = step_ends(solution)
    stored = []
    for time in times:
        profile = solution.soil(0, time)
        mobilised = profile.mobilised
        assert abs(mobilised).max() < 0.9  # the soil does not yield
        force = mobilised * profile.resistance  # N [node]
        stiffness = profile.resistance / soil.quake  # N/m [node]
        energies = force**2 / (2 * stiffness)  # J [node]
        stored.append(energies.sum())
    energy_of_rod = solution.energy(times).total
    return energy_of_rod + stored


@pytest.mark.exhaustive
def test_soil_without_damping_gives_back_all_that_its_springs_store():
    """The energy of a rod and of the springs of its elastic soil stays what it is at
    the start.
    """
    soil = ELASTIC_SOIL.replace(damping=0.0)

    energy = energies_with_elastic_soil(soil)

    force = 0.3 * 50.0  # mobilised of the resistance, N
    stiffness = 50.0 / 10.0  # resistance over quake, N/m
    stored = force**2 / (2 * stiffness)
    kinetic = 0.5  # of 1 kg at 1 m/s, J
    expected = stored + kinetic
    assert energy == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("law", ["smith", "viscous"])
def test_damping_takes_energy_in_every_step(law):
    """The energy of a rod and of the springs of its soil falls in each step, also as
    the rod swings back.
    """
    soil = ELASTIC_SOIL.replace(law=law)

    energy = energies_with_elastic_soil(soil)

    changes = np.diff(energy)
    assert changes.max() < 0


def test_soil_resists_a_mirrored_row_alike():
    """A rod that is thrown to the left makes soil yield as one that is thrown to the
    right.
    """
    resistance = ri.Steps([3.0, 1.0], at=[0.3])
    soil = ri.Soil(resistance, quake=0.05, damping=0.4)
    system = ri.System([rod_in(soil)])
    mirrored_system = system.mirrored()

    right = ri.solve(system, until=0.4, cells=20)
    left = ri.solve(mirrored_system, until=0.4, cells=20)

    of_right = right.soil(0, 0.4)
    of_left = left.soil(0, 0.4)
    mirrored_mobilised = -of_left.mobilised[::-1]
    mirrored_set = -of_left.plastic_set[::-1]
    assert mirrored_mobilised == pytest.approx(of_right.mobilised)
    assert mirrored_set == pytest.approx(of_right.plastic_set)
    least_set = of_right.plastic_set.min()
    assert least_set > 0.1  # m: it yields along all of the shaft
    work_to_the_right = right.outcome.soil_work
    assert left.outcome.soil_work == pytest.approx(work_to_the_right)


def test_errors_of_a_smooth_motion_fall_with_the_square_of_the_step():
    """The velocity of an end on three meshes is compared with that on a mesh four times
    as fine as the finest of them.
    """
    soil = ri.Soil(3.0, quake=0.5, damping=0.4)
    cosine = np.cos(np.linspace(0, np.pi, 65))
    rod = rod_in(soil, velocity=ri.Samples(cosine))
    system = ri.System([rod])
    until = 0.8

    velocities = []
    for cells in (25, 50, 100, 400):
        dt = until / (2 * cells)  # 0.4 of the longest stable step
        solution = ri.solve(system, until=until, cells=cells, dt=dt)
        velocity_of_end = solution.velocity(0, 1.0, until)
        velocities.append(float(velocity_of_end))

    *coarse, fine = velocities
    errors = np.abs(np.array(coarse) - fine)
    first, second, third = errors
    # Halving the step makes an error of order 2 four times as small.
    assert first / second > 3
    assert second / third > 3


def test_a_pile_that_soil_carries_stays_at_rest():
    """The soil has mobilised just what carries the weight of the pile."""
    weight = STEEL.density * AREA * LENGTH * 9.81
    resistance = 400e3
    mobilised = weight / resistance
    soil = ri.Soil(resistance, quake=QUAKE, damping=0.16, mobilised=mobilised)
    pile = ri.Rod(LENGTH, area=AREA, material=STEEL, shaft=soil)

    system = ri.System([pile], gravity=9.81)

    resting = ri.solve(system, until=0.05, cells=50)

    x = np.linspace(0.0, LENGTH, 7)[:, None]
    t = np.linspace(0.0, 0.05, 40)
    velocity = resting.velocity(0, x, t)
    assert np.abs(velocity).max() < 1e-9
    soil_work = resting.outcome.soil_work
    assert soil_work == pytest.approx(0.0, abs=1e-6)


def test_two_bonded_halves_in_soil_are_one_pile():
    """Velocity of the toe and force in the middle are those of the whole pile; each
    half has half of the resistance.
    """
    soil = ri.Soil(400e3, quake=QUAKE, damping=0.16)
    toe = ri.SmithToe(400e3, quake=QUAKE, damping=0.5)
    whole = pile_in_soil(soil, toe)
    ram, pile, wall = whole.bodies
    # The resistance of soil is that along all of its rod.
    half_of_soil = soil.replace(resistance=200e3)
    half = pile.replace(length=LENGTH / 2, shaft=half_of_soil)
    cushion = whole.contacts[0]
    contacts = [cushion, ri.Bonded(), toe]
    halves = ri.System([ram, half, half, wall], contacts=contacts)

    by_whole = ri.solve(whole, until=0.02, cells=80)
    by_halves = ri.solve(halves, until=0.02, cells=40)

    t = np.linspace(0.0, 0.02, 50)
    middle = LENGTH / 2
    toe_velocity = by_halves.velocity(2, middle, t)
    expected_velocity = by_whole.velocity(1, LENGTH, t)
    assert toe_velocity == pytest.approx(expected_velocity, abs=1e-2)
    bond_force = by_halves.contacts[1].force(t)
    middle_force = -by_whole.axial_force(1, middle, t)
    bound = 0.02 * np.abs(middle_force).max()
    # The front of the blow, which a grid does not resolve, passes before these times.
    later_force = bond_force[5:]
    expected_force = middle_force[5:]
    assert later_force == pytest.approx(expected_force, abs=bound)


@pytest.mark.skipif(not kernels.enabled(), reason="takes long in plain Python")
@pytest.mark.parametrize("law", few_of(["smith", "viscous"], ["smith"]))
def test_a_continued_blow_is_one_that_did_not_stop(law):
    """The sets of the two parts of a blow, cut at 0.02 s, add up to that of the whole;
    in the second part the toe moves as in the whole.
    """
    soil = ri.Soil(400e3, quake=QUAKE, damping=0.16, law=law)
    toe = ri.SmithToe(400e3, quake=QUAKE, damping=0.5)
    system = pile_in_soil(soil, toe)

    whole = ri.solve(system, until=0.05, cells=150)
    first_part = ri.solve(system, until=0.02, cells=150)
    continued = whole.system_at(0.02)
    second_part = ri.solve(continued, until=0.03, cells=150)

    set_of_first = first_part.contacts[1].permanent_set()
    set_of_second = second_part.contacts[1].permanent_set()
    total_set = set_of_first + set_of_second
    set_of_whole = whole.contacts[1].permanent_set()
    assert total_set == pytest.approx(set_of_whole, rel=1e-3)
    t = np.linspace(0.0, 0.03, 30)
    toe_velocity = second_part.velocity(1, LENGTH, t)
    expected = whole.velocity(1, LENGTH, t + 0.02)
    assert toe_velocity == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize("side", ["left", "right"])
def test_contacts_that_begin_pressed_push_from_the_start_on(side):
    """A spring between a rod and a mass begins pressed by 0.1 m. The velocity of the
    rod's end is that by characteristics, to an error that falls with the step. The rod
    lies on this `side`.
    """
    rod = ri.Rod(1.0, area=1.0, material=SOFT)
    mass = ri.RigidMass(1.0)
    spring = ri.Spring(2.0)
    system = ri.System([rod, mass], gaps=[-0.1], contacts=[spring])
    x = 1.0  # end of the rod at the contact
    body = 0
    if side == "right":
        system = system.mirrored()
        x = 0.0
        body = 1
    t = np.linspace(0.1, 0.9, 9)

    exact = ri.solve(system, until=1.0, method="characteristics")
    errors = []
    for cells in (50, 200):
        grid = ri.solve(system, until=1.0, method="finite-difference", cells=cells)
        velocity = grid.velocity(body, x, t)
        exact_velocity = exact.velocity(body, x, t)
        difference = velocity - exact_velocity
        errors.append(float(np.abs(difference).max()))

    coarse_error, fine_error = errors
    assert fine_error < coarse_error / 3  # with a quarter of the step
    assert coarse_error < 5e-3


def test_characteristics_say_that_they_have_no_soil():
    """The method of characteristics refuses a pile with soil along its shaft and a toe:
    the message names the shaft.
    """
    soil = ri.Soil(1e5, quake=QUAKE)
    toe = ri.SmithToe(1e5, quake=QUAKE)
    system = pile_in_soil(soil, toe)
    with pytest.raises(ri.InvalidModel, match=r"bodies.1.shaft.*soil along a shaft"):
        ri.solve(system, until=0.01, method="characteristics")


def test_a_run_in_soil_needs_an_end():
    """A rod that moves in soil is refused if `until` is not given."""
    soil = ri.Soil(1.0, quake=QUAKE)
    rod = ri.Rod(1.0, area=1.0, material=STEEL, velocity=1.0, shaft=soil)
    system = ri.System([rod])
    with pytest.raises(ri.InvalidModel, match=r"until.*soil"):
        ri.solve(system)


def test_members_of_a_family_have_soils_of_their_own():
    """A sweep over two resistances gives the sets of two single runs."""
    soil = ri.Soil([200e3, 400e3], quake=QUAKE, damping=0.16)
    toe = ri.SmithToe(400e3, quake=QUAKE)
    system = pile_in_soil(soil, toe)
    options = {"until": 0.02, "cells": 30}

    family = ri.sweep(system, **options, workers=1, also=["set"])

    set_of_toe = family.sets[1]  # m [member]
    for i in range(2):
        alone = ri.solve(system[i], **options)
        toe = alone.contacts[1]
        assert set_of_toe[i] == toe.permanent_set()
    assert set_of_toe[0] != set_of_toe[1]


@pytest.mark.parametrize("owner", ["shaft", "toe"])
def test_a_quake_of_metres_is_doubted(owner):
    """The status doubts 2.5 m at the shaft or the toe, a usual slip for 2.5 mm."""
    quakes = {"shaft": 2.5e-3, "toe": 2.5e-3}
    quakes[owner] = 2.5
    paths = {"shaft": "bodies.0.shaft.quake", "toe": "contacts.0.quake"}
    shaft = ri.Soil(1e5, quake=quakes["shaft"])
    toe = ri.SmithToe(1e5, quake=quakes["toe"])
    steel = ri.materials.steel
    pile = ri.Rod(10.0, area=0.01, material=steel, velocity=1.0, shaft=shaft)
    row = ri.System([pile, ri.Wall()], contacts=[toe])

    solution = ri.solve(row, until=1e-3, cells=20)

    path = paths[owner]
    doubt = f"{path} is 2.5 m: quakes of soil are a few millimetres"
    assert doubt in solution.status
