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


UNTIL = 3.0  # end of the runs of `run_of`, s


def run_of(end, **options):
    """Motion until 3 s of a rod of 1 m and 1 m/s, with this end on its left, free on
    its right.
    """
    system = ri.System([ROD], ends=(end, ri.Free()))
    return ri.solve(system, until=UNTIL, **options)


def end_on_corners():
    """An end that moves on straight lines between `CORNERS`."""
    samples = ri.Samples(CORNERS, step=STEP)
    return ri.Moved(position=samples)


def swinging_end():
    """An end that moves as `swing`."""
    return ri.Moved(position=swing, duration=UNTIL)


def test_straight_lines_make_a_velocity_in_steps():
    """0 to the second corner, then by 0.1 m in 0.125 s; after the last corner it stops."""
    end = end_on_corners()

    speed = 0.1 / STEP
    corner_times = [1 * STEP, 3 * STEP, 4 * STEP]
    assert end.value == ri.Steps([0.0, speed, -speed, 0.0], at=corner_times)


@pytest.mark.parametrize("origin", [0.0, -3.0])
def test_the_velocity_does_not_depend_on_the_origin_of_positions(origin):
    """Positions there and back, from any origin, give an end the velocities 2, -2 and 0
    m/s; equal positions, or a single one, give 0.
    """
    there_and_back = ri.Samples([origin, origin + 1.0, origin], step=0.5)
    at_rest = ri.Samples([origin, origin], step=1.0)

    end = ri.Moved(position=there_and_back)
    end_at_rest = ri.Moved(position=at_rest)
    end_at_origin = ri.Moved(position=origin)

    assert end.value == ri.Steps([2.0, -2.0, 0.0], at=[0.5, 1.0])
    assert end_at_rest.value == 0.0
    assert end_at_origin.value == 0.0


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_an_end_is_where_it_should_be_to_round_off(method):
    """An end with positions linear between corners has these positions by each method,
    and energy balances.
    """
    t = np.linspace(0.0, UNTIL, 41)

    solution = run_of(end_on_corners(), method=method)

    corner_times = STEP * np.arange(len(CORNERS))
    position = np.interp(t, corner_times, CORNERS)
    displacement = solution.displacement(0, 0.0, t)
    assert displacement == pytest.approx(position, abs=1e-14)
    assert abs(solution.outcome.energy_residual) < 1e-13


def test_a_function_is_followed_to_round_off_and_its_velocity_to_its_stated_error():
    """An end that is moved by a function has this displacement to 1e-11, and its
    velocity to the stated error, until the drive ends.
    """
    t = np.linspace(0.0, UNTIL, 41)

    solution = run_of(swinging_end())

    assert solution.method == "characteristics"
    displacement = solution.displacement(0, 0.0, t)
    assert displacement == pytest.approx(swing(t), abs=1e-11)
    before_end = t[:-1]  # at the last time, where the drive ends, the end stops
    velocity = solution.velocity(0, 0.0, before_end)
    error = np.abs(velocity - swing_velocity(before_end)).max()
    stated = solution.accuracy["velocity"] * solution.fields.clock.scale  # m/s
    assert error <= stated + 1e-14


def test_a_wave_runs_ahead_of_a_moved_end():
    """v(x, t) = x_0'(t - x/c) until the wave is back from the far end."""
    x = np.linspace(0.0, 1.0, 9)
    t = 1.0  # the wave is at the far end; c = 1 m/s

    solution = run_of(swinging_end())

    velocity = solution.velocity(0, x, t)
    expected = swing_velocity(t - x)
    assert velocity == pytest.approx(expected, abs=1e-9)


def test_an_end_stops_after_its_last_sample():
    """An end with sampled positions stays at the last one afterwards, at rest."""
    t = np.linspace(0.0, 1.0, 11)
    positions = 0.1 * np.sin(t)  # it stops with a jolt
    samples = ri.Samples(positions, step=0.1, smooth=True)

    solution = run_of(ri.Moved(position=samples))

    last_position = 0.1 * math.sin(1.0)
    displacement = solution.displacement(0, 0.0, [1.0, 2.0, 3.0])
    velocity = solution.velocity(0, 0.0, 2.0)
    assert displacement == pytest.approx(last_position, abs=1e-9)
    assert velocity == pytest.approx(0.0, abs=1e-12)


def test_errors_of_a_grid_at_a_moved_end_fall_with_the_square_of_the_step():
    """A rod with one moved end is solved with 25, 50 and 100 cells. The errors of the
    velocity of its far end, against characteristics, fall with order 2.
    """
    t = np.linspace(0.0, 2.5, 26)
    far_end = 1.0  # m
    exact = run_of(swinging_end()).velocity(0, far_end, t)

    errors = []
    for cells in (25, 50, 100):
        half_of_stable = 0.5 / cells  # s
        solution = run_of(
            swinging_end(), method="finite-difference", cells=cells, dt=half_of_stable
        )
        velocity = solution.velocity(0, far_end, t)
        error = np.abs(velocity - exact).max()
        errors.append(error)

    ratios = np.array(errors[:-1]) / errors[1:]
    orders = np.log2(ratios)
    assert orders == pytest.approx(2.0, abs=0.3)


def test_mirrored_ends_move_to_the_other_side():
    """A row whose left end has given positions is mirrored: its right end has the
    negated velocities. Mirrored twice, it is the row itself.
    """
    system = ri.System([ROD], ends=(end_on_corners(), ri.Free()))

    mirrored = system.mirrored()

    right_end = mirrored.ends[1]
    assert right_end.value.values == (0.0, -0.8, 0.8, 0.0)
    assert mirrored.mirrored() == system


def test_a_prescribed_position_survives_the_description_of_its_system():
    system = ri.System([ROD], ends=(end_on_corners(), ri.Free()))
    restored = ri.System.from_dict(system.to_dict())
    assert restored == system


def test_members_of_a_family_of_speeds_are_those_alone():
    """Two steps of the sampled positions of an end make a family, whose swept
    velocities are those of its members solved alone.
    """
    samples = ri.Samples([0.0, 0.1], step=[0.5, 1.0])
    end = ri.Moved(position=samples)
    system = ri.System([ROD], ends=(end, ri.Free()))
    assert list(system.parameters) == ["ends.left.position.step"]

    family = ri.sweep(system, until=2.0, workers=1)

    velocities = family.columns["velocity_after.0"]
    for i in range(2):
        alone = ri.solve(system[i], until=2.0).outcome
        assert velocities[i] == alone.velocities_after[0]


def test_a_position_is_replaced_by_a_velocity_and_the_reverse():
    """`replace` of a moved end with a velocity drops its position, and with a position
    its velocity.
    """
    end = end_on_corners()

    with_velocity = end.replace(value=1.0)
    with_position = ri.Moved(1.0).replace(position=end.position)

    assert with_velocity == ri.Moved(1.0)
    assert with_position == end


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
