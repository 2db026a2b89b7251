"""Drag along a rod: against the telegraph equation, and what it must keep."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import assert_told
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.methods import kernels

SOFT = ri.Material("soft", youngs_modulus=1.0, density=1.0)
LENGTH = 1.0  # m
HALF_PERIOD = 1.0  # of the lowest mode of a free rod with wave speed 1, s
PLACES = np.linspace(0.0, LENGTH, 9)


def standing_wave(drag, mean_velocity=0.0):
    """A free rod in drag, which starts with the velocities of its lowest mode."""
    x = np.linspace(0.0, LENGTH, 257)
    lowest_mode = np.cos(math.pi * x)
    velocity = ri.Samples(mean_velocity + lowest_mode, smooth=True)
    return ri.Rod(LENGTH, area=1.0, material=SOFT, velocity=velocity, shaft=drag)


def amplitude(t, damping):
    """Velocity of the mode at x = 0 by the telegraph equation u_tt + d u_t = u_xx.

    It is 1 at t = 0. The displacement, whose derivative it is, is exp(-d t/2) sin(w t)/w
    with w^2 = pi^2 - d^2/4: an oscillation or, where w^2 < 0, a motion that creeps back.
    The damping must not be 2 pi, where w = 0.
    """
    w_squared = math.pi**2 - damping**2 / 4
    w = np.sqrt(complex(w_squared))
    decay = np.exp(-damping * t / 2)
    share_of_sine = damping / (2 * w)
    oscillation = np.cos(w * t) - share_of_sine * np.sin(w * t)
    return (decay * oscillation).real


@pytest.mark.parametrize("damping", [0.3, 3.0, 30.0])
def test_a_standing_wave_dies_out_as_the_telegraph_equation_says(damping):
    """A free rod in drag starts with its lowest mode. Its velocity at nine positions is
    `amplitude` times cos(pi x), for two half periods.
    """
    rod = standing_wave(ri.Drag(damping))
    system = ri.System([rod])
    t = np.linspace(0.0, 2 * HALF_PERIOD, 21)

    solution = ri.solve(system, until=2 * HALF_PERIOD, cells=400)

    x = PLACES[:, None]
    exact = amplitude(t, damping) * np.cos(math.pi * x)
    velocity = solution.velocity(0, x, t)
    assert velocity == pytest.approx(exact, abs=2e-4)


def test_errors_of_the_velocity_of_an_end_fall_with_the_square_of_the_step():
    """The velocity of a standing wave in drag is compared with `amplitude` on meshes of
    25 to 200 cells.
    """
    # With the 257 samples of other tests the error of the finest mesh is that of the
    # samples.
    x = np.linspace(0.0, LENGTH, 2049)
    wave = ri.Samples(np.cos(math.pi * x))
    rod = standing_wave(ri.Drag(3.0))
    system = ri.System([rod.replace(velocity=wave)])
    t = 0.7
    exact = amplitude(t, damping=3.0)

    errors = []
    for cells in (25, 50, 100, 200):
        dt = t / (2 * cells)  # 0.35 of the longest stable step
        solution = ri.solve(system, until=t, cells=cells, dt=dt)
        velocity = float(solution.velocity(0, 0.0, t))
        errors.append(abs(velocity - exact))

    ratios = np.array(errors[:-1]) / errors[1:]  # from one mesh to the next finer one
    orders = np.log2(ratios)
    assert orders == pytest.approx(2.0, abs=0.02)


def test_a_front_loses_half_of_the_rate_of_a_whole_rod():
    """Behind a front that has run for t the force is F exp(-d t/2), d the damping.

    A whole rod, on which no force acts, slows down as exp(-d t).
    """
    damping = 1.0  # drag per mass of the rod, 1/s
    drag = ri.Drag(2 * damping)  # over the length; the rod has 2 kg in 2 m
    rod = ri.Rod(2.0, area=1.0, material=SOFT, shaft=drag)
    push = ri.Pushed(1.0)
    system = ri.System([rod], ends=(push, ri.Free()))

    solution = ri.solve(system, until=1.5, cells=1000)

    just_behind = 1.5 - 0.02  # m; the front has run 1.5 m
    force = -solution.axial_force(0, just_behind, 1.5)
    expected = 1.0 * math.exp(-damping * 1.5 / 2)  # N
    assert force == pytest.approx(expected, rel=0.02)


def test_a_rod_slows_down_exponentially_and_drag_takes_its_energy():
    """A rigid motion of 2 m/s falls as exp(-damping t), and the work of drag is the
    kinetic energy lost.
    """
    damping = 0.8
    drag = ri.Drag(damping)
    rod = ri.Rod(LENGTH, area=1.0, material=SOFT, velocity=2.0, shaft=drag)
    system = ri.System([rod])
    t = np.linspace(0.0, 3.0, 13)

    solution = ri.solve(system, until=3.0, cells=50, dt=1e-2)
    ledger = solution.energy(t)

    velocity = 2.0 * np.exp(-damping * t)
    lost = (2.0**2 - velocity**2) / 2  # J, of 1 kg
    mean_velocity = solution.mean_velocity(0, t)
    assert mean_velocity == pytest.approx(velocity, abs=1e-5)
    assert ledger.drag_work == pytest.approx(lost, abs=2e-3)
    assert ledger.soil_work == pytest.approx(0.0)
    assert np.abs(ledger.residual).max() < 1e-13
    outcome = solution.outcome
    work_until_end = ledger.drag_work[-1]
    assert outcome.drag_work == pytest.approx(work_until_end)
    assert "lost to drag" in str(outcome)


def random_row(seed):
    """Two moving rods in drag of their own, which may meet or be bonded, and a mass
    behind them.
    """
    rng = default_rng(seed)
    rods = []
    for _ in range(2):
        length = float(rng.uniform(0.5, 2))
        coefficient = float(10 ** rng.uniform(-2, 2))
        if rng.random() < 0.5:
            second_value = float(rng.choice([0.0, 1.0]))
            values = [coefficient, second_value]
            step = length * float(rng.uniform(0.1, 0.9))
            coefficient = ri.Steps(values, at=[step])
        area = float(rng.uniform(0.5, 2))
        viscosity = float(rng.choice([0.0, 0.05]))
        velocity = float(rng.uniform(-1, 1))
        rod = ri.Rod(
            length,
            area=area,
            material=SOFT.replace(viscosity=viscosity),
            velocity=velocity,
            shaft=ri.Drag(coefficient),
        )
        rods.append(rod)
    laws = [ri.Bonded(), ri.Rigid(), ri.Spring(5.0)]
    between_rods = laws[rng.integers(3)]
    gravity = float(rng.choice([0.0, 0.3]))
    mass = ri.RigidMass(1.0)
    contacts = [between_rods, ri.Spring(3.0)]
    return ri.System([*rods, mass], contacts=contacts, gravity=gravity)


@pytest.mark.parametrize("seed", few_of(range(60), range(6)))
def test_balances_of_random_rows_close_and_drag_gives_nothing(seed):
    """Momentum and energy balance to round-off, and the energy lost to drag never
    falls.
    """
    round_off = 1e-15

    row = random_row(seed)

    solution = ri.solve(row, until=3.0, cells=24)

    outcome = solution.outcome
    assert abs(outcome.momentum_residual) < 1e-13
    assert abs(outcome.energy_residual) < 1e-12
    times = np.linspace(0.0, 3.0, 40)
    lost = solution.energy(times).drag_work
    lost_at_end = lost[-1]
    assert lost_at_end > 0
    increases = np.diff(lost)
    assert increases.min() > -round_off


def outcome_of(row, compiling):
    """The outcome of 1 s as a dict, by machine code if `compiling`, else by Python."""
    with kernels.forced(compiling):
        solution = ri.solve(row, until=1.0, cells=16)
    return solution.outcome.to_dict()


@pytest.mark.parametrize("seed", few_of(range(12), range(2)))
def test_outcomes_of_random_rows_are_the_same_in_machine_code(seed):
    """The outcome of a random row with drag is equal in plain Python and compiled."""
    row = random_row(seed)

    plain = outcome_of(row, compiling=False)
    compiled = outcome_of(row, compiling=True)

    assert plain == compiled


def test_a_mirrored_row_moves_alike():
    """Velocities after the run of a random row are those of its mirror image, in reverse
    order and with the other sign.
    """
    row = random_row(1)
    mirrored_row = row.mirrored()

    solution = ri.solve(row, until=1.0, cells=20)
    mirrored = ri.solve(mirrored_row, until=1.0, cells=20)

    # The last body of the row is the first of the mirrored one, and moves to the left.
    velocities = -np.array(mirrored.outcome.velocities_after)
    expected = solution.outcome.velocities_after
    assert velocities[::-1] == pytest.approx(expected, abs=1e-9)


def test_a_continued_run_is_one_that_did_not_stop():
    """A run that goes on from its state at 0.5 s has the velocities of the whole one."""
    rod = standing_wave(ri.Drag(2.0), mean_velocity=0.5)
    system = ri.System([rod])

    whole = ri.solve(system, until=1.5, cells=400)
    continued = whole.system_at(0.5)
    second_part = ri.solve(continued, until=1.0, cells=400)

    x = PLACES[:, None]
    t = np.linspace(0.0, 1.0, 11)
    expected = whole.velocity(0, x, t + 0.5)
    velocity = second_part.velocity(0, x, t)
    assert velocity == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_other_methods_say_that_they_have_no_drag(method):
    """The other methods refuse a rod in drag at the path of its shaft; the message
    names the method that has drag.
    """
    rod = standing_wave(ri.Drag(1.0))
    system = ri.System([rod])

    with pytest.raises(ri.InvalidModel) as caught:
        ri.solve(system, until=0.01, method=method)

    messages = dict(caught.value.problems)
    lacks = f'method "{method}" has no drag along a shaft'
    remedy = 'method "finite-difference" has'
    assert messages["bodies.0.shaft"] == f"{lacks}; {remedy}"


def test_a_run_in_drag_needs_an_end():
    rod = standing_wave(ri.Drag(1.0))
    system = ri.System([rod])
    with pytest.raises(ri.InvalidModel, match=r"until: must be given.*drag"):
        ri.solve(system)


def test_members_of_a_family_have_drags_of_their_own():
    """A sweep over two coefficients gives the velocities of two single runs."""
    coefficients = [0.5, 5.0]
    rod = standing_wave(ri.Drag(coefficients), mean_velocity=1.0)
    system = ri.System([rod])
    options = {"until": 1.0, "cells": 30}

    family = ri.sweep(system, **options, workers=1)

    velocities = family.columns["velocity_after.0"]
    for i in range(2):
        alone = ri.solve(system[i], **options)
        (velocity,) = alone.outcome.velocities_after
        assert velocities[i] == velocity
    # The larger drag per mass, 5/s, takes nearly all of 1 m/s: exp(-5) is left.
    assert velocities[1] < 0.1


@pytest.mark.exhaustive
def test_a_drag_coefficient_is_found_from_a_record():
    """A fit that begins at the coefficient 1 finds the 2 of the rod from its strain in
    the middle.
    """
    rod = standing_wave(ri.Drag(2.0), mean_velocity=1.0)
    system = ri.System([rod])
    place = (0, 0.5)  # body, m
    gauge = ri.solve(system, until=1.0, cells=60).gauge(*place)
    record = ri.Measured(gauge.signal(0.01), gauge=place)
    first_guess = rod.replace(shaft=ri.Drag(1.0))
    guess = ri.System([first_guess])
    coefficient = "bodies.0.shaft.coefficient"
    vary = {coefficient: (0.5, 5.0)}

    fitted = ri.fit(guess, record, vary, until=1.0, cells=60)

    value = fitted.values[coefficient]
    assert value == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("make", "path", "message"),
    [
        (lambda: ri.Drag(-1.0), "coefficient", "non-negative"),
        (lambda: ri.Drag("1 N"), "coefficient", "must be a number"),
        (
            lambda: standing_wave(ri.Drag(ri.Steps([1.0, -1.0], at=[0.5]))),
            "shaft.coefficient.values.1",
            "non-negative",
        ),
        (
            lambda: standing_wave(ri.Drag(ri.Steps([1.0, 2.0], at=[1.5]))),
            "shaft.coefficient.at.0",
            "must lie inside the rod",
        ),
        (lambda: standing_wave(3.0), "shaft", "must be a Soil, a Drag or None"),
    ],
)
def test_mistakes_are_named(make, path, message):
    assert_told(make, {path: message})


def test_a_rod_that_hangs_in_drag_stays_at_rest_and_has_no_soil():
    """A rod in drag, bonded to a wall, keeps the state of `at_rest`; its solution
    refuses to tell of soil.
    """
    drag = ri.Drag(1.0)
    rod = ri.Rod(LENGTH, area=1.0, material=SOFT, shaft=drag)
    bonds = [ri.Bonded()]
    hanging = ri.System([ri.Wall(), rod], contacts=bonds, gravity=0.1)

    at_rest = ri.at_rest(hanging, cells=20)
    solution = ri.solve(at_rest, until=1.0, cells=20)

    _, rod_at_rest = at_rest.bodies
    assert rod_at_rest.shaft == drag
    x = PLACES[:, None]
    velocity = solution.velocity(1, x, [0.3, 1.0])
    assert np.abs(velocity).max() < 1e-12
    with pytest.raises(ri.InvalidModel, match="has no soil along its shaft"):
        solution.soil(1, 0.5)
