"""Ends whose position is prescribed: the velocity that this makes, and the motion."""

import math

import numpy as np
import pytest
from mistakes import assert_told

import rodimpact as ri

SOFT = ri.Material("soft", youngs_modulus=1.0, density=1.0)
ROD = ri.Rod(1.0, area=1.0, material=SOFT)
CORNERS = [0.0, 0.0, 0.1, 0.2, 0.1]  # positions, m, between which lines run
STEP = 0.125  # s from corner to corner


def swing(t):
    """A smooth motion that begins from rest, m."""
    return 0.1 * np.sin(t) ** 5


def swing_velocity(t):
    """Its derivative, m/s."""
    return 0.5 * np.sin(t) ** 4 * np.cos(t)


def run_of(end, **options):
    """A rod whose left end is this one, its right end free, until 3 s."""
    system = ri.System([ROD], ends=(end, ri.Free()))
    return ri.solve(system, until=3.0, **options)


def test_straight_lines_make_a_velocity_in_steps():
    end = ri.Moved(position=ri.Samples(CORNERS, step=STEP))

    assert end.value == ri.Steps([0.0, 0.8, -0.8, 0.0], at=[0.125, 0.375, 0.5])


@pytest.mark.parametrize("origin", [0.0, -3.0])
def test_the_velocity_does_not_depend_on_the_origin_of_positions(origin):
    samples = [origin, origin + 1.0, origin]

    end = ri.Moved(position=ri.Samples(samples, step=0.5))

    assert end.value == ri.Steps([2.0, -2.0, 0.0], at=[0.5, 1.0])
    assert ri.Moved(position=origin).value == 0.0
    assert ri.Moved(position=ri.Samples([origin, origin], step=1.0)).value == 0.0


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_an_end_is_where_it_should_be_to_round_off(method):
    end = ri.Moved(position=ri.Samples(CORNERS, step=STEP))
    t = np.linspace(0.0, 3.0, 41)

    solution = run_of(end, method=method)

    position = np.interp(t, STEP * np.arange(len(CORNERS)), CORNERS)
    assert solution.displacement(0, 0.0, t) == pytest.approx(position, abs=1e-14)
    assert abs(solution.outcome.energy_residual) < 1e-13


def test_a_function_is_followed_to_round_off_and_its_velocity_to_its_stated_error():
    end = ri.Moved(position=swing, duration=3.0)
    t = np.linspace(0.0, 3.0, 41)

    solution = run_of(end)

    assert solution.method == "characteristics"
    assert solution.displacement(0, 0.0, t) == pytest.approx(swing(t), abs=1e-11)
    velocity = swing_velocity(t)
    stated = solution.accuracy["velocity"] * solution.fields.clock.scale
    # At the last time, where the drive ends, the end stops.
    error = np.abs(solution.velocity(0, 0.0, t[:-1]) - velocity[:-1]).max()
    assert error <= stated + 1e-14


def test_a_wave_runs_ahead_of_a_moved_end():
    """v(x, t) = x_0'(t - x/c) until the wave is back from the far end."""
    x = np.linspace(0.0, 1.0, 9)

    solution = run_of(ri.Moved(position=swing, duration=3.0))

    velocity = swing_velocity(1.0 - x)
    assert solution.velocity(0, x, 1.0) == pytest.approx(velocity, abs=1e-9)


def test_an_end_stops_after_its_last_sample():
    t = np.linspace(0.0, 1.0, 11)
    samples = ri.Samples(0.1 * np.sin(t), step=0.1, smooth=True)  # it stops with a jolt

    solution = run_of(ri.Moved(position=samples))

    at_rest = solution.displacement(0, 0.0, [1.0, 2.0, 3.0])
    assert at_rest == pytest.approx(0.1 * math.sin(1.0), abs=1e-9)
    assert solution.velocity(0, 0.0, 2.0) == pytest.approx(0.0, abs=1e-12)


def test_errors_of_a_grid_at_a_moved_end_fall_with_the_square_of_the_step():
    t = np.linspace(0.0, 2.5, 26)
    exact = run_of(ri.Moved(position=swing, duration=3.0))
    errors = []
    for cells in (25, 50, 100):
        solution = run_of(
            ri.Moved(position=swing, duration=3.0),
            method="finite-difference",
            cells=cells,
            dt=0.5 / cells,
        )
        difference = solution.velocity(0, 1.0, t) - exact.velocity(0, 1.0, t)
        errors.append(float(np.abs(difference).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.3)


def test_mirrored_ends_move_to_the_other_side():
    end = ri.Moved(position=ri.Samples(CORNERS, step=STEP))
    system = ri.System([ROD], ends=(end, ri.Free()))

    mirrored = system.mirrored()

    assert mirrored.ends[1].value.values == (0.0, -0.8, 0.8, 0.0)
    assert mirrored.mirrored() == system
    assert ri.System.from_dict(system.to_dict()) == system


def test_members_of_a_family_of_speeds_are_those_alone():
    end = ri.Moved(position=ri.Samples([0.0, 0.1], step=[0.5, 1.0]))
    system = ri.System([ROD], ends=(end, ri.Free()))

    assert list(system.parameters) == ["ends.left.position.step"]
    family = ri.sweep(system, until=2.0, workers=1)
    for i in range(2):
        alone = ri.solve(system[i], until=2.0).outcome
        assert family.columns["velocity_after.0"][i] == alone.velocities_after[0]


def test_a_position_is_replaced_by_a_velocity_and_the_reverse():
    end = ri.Moved(position=ri.Samples(CORNERS, step=STEP))

    assert end.replace(value=1.0) == ri.Moved(1.0)
    assert ri.Moved(1.0).replace(position=end.position) == end


@pytest.mark.parametrize(
    ("make", "messages"),
    [
        (lambda: ri.Moved(), {"value": "is missing; give a velocity, or a position"}),
        (
            lambda: ri.Moved(1.0, position=2.0),
            {"position": "give either value or position"},
        ),
        (
            lambda: ri.Moved(position=ri.Steps([0.0, 1.0], at=[0.5])),
            {"position": "jumps, and an end cannot jump; give Samples"},
        ),
        (
            lambda: ri.Moved(position=ri.Samples([0.0, 1.0])),
            {"position.step": "is missing; give the seconds between two samples"},
        ),
        (
            lambda: ri.Moved(position=swing),
            {"duration": "is missing; give the seconds"},
        ),
        (lambda: ri.Moved(position="1 m"), {"position": "must be a number of metres"}),
        (
            lambda: ri.Moved(position=ri.Samples([0, 1, 0], step=1.0, smooth=True)),
            {"position.values": "must be more than 5 samples for a smooth curve"},
        ),
        (
            lambda: ri.Moved(
                position=ri.Samples(np.arange(9.0), step=[1.0, 2.0], smooth=True)
            ),
            {"position.step": "must be a single number for a smooth curve"},
        ),
    ],
)
def test_mistakes_in_positions_are_refused(make, messages):
    assert_told(make, messages)
