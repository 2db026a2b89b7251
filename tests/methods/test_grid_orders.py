"""Order of every field of a grid, at ends as inside, against modal sums."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from kelvin_voigt import rod_on_wall
from networks import UNIT

import rodimpact as ri

METHOD = "finite-difference"
PLACES = np.array([0.0, 0.31, 0.5, 0.83, 0.995, 1.0])
FIELDS = ("velocity", "stress", "displacement")


def damped_rod(viscosity):
    """A rod of unit length and velocity."""
    material = UNIT.replace(viscosity=viscosity)
    return ri.Rod(1.0, area=1.0, material=material, velocity=1.0)


def largest_errors(solution, times, exact, gap=0.0):
    """Largest error of each field at each of `PLACES` [field, place].

    `exact` has values by the names of fields [place, time]. The rod comes to the wall
    of this exact solution `gap` m further and, at 1 m/s, as many seconds later.
    """
    errors = []
    for name, exact_values in exact.items():
        field = getattr(solution, name)
        x = PLACES[:, None]
        values = field(0, x, times + gap)
        if name == "displacement":
            values = values - gap
        differences = np.abs(values - exact_values)
        largest = differences.max(axis=1)
        errors.append(largest)
    return np.array(errors)


@pytest.mark.parametrize("gap", few_of([0.0, 0.0937], [0.0937]))
@pytest.mark.parametrize("viscosity", few_of([0.01, 0.05, 0.3], [0.05]))
def test_errors_of_a_damped_rod_that_falls_on_a_wall_are_of_order_two(viscosity, gap):
    """The velocity of the end once alternated by 4e-4, and fields were half a step
    late.
    """
    times = np.array([0.6, 0.9, 1.25, 2.5, 2.6, 2.7, 3.2])
    fields, opening = rod_on_wall(PLACES, times, viscosity)
    assert 1.25 < opening < 2.5  # the times are before and after
    exact = {name: getattr(fields, name) for name in FIELDS}
    rod = damped_rod(viscosity)
    system = ri.System([rod, ri.Wall()], gaps=[gap])

    errors = []
    for cells in (50, 100, 200, 400):
        solution = ri.solve(system, until=3.5, method=METHOD, cells=cells)
        errors_of_mesh = largest_errors(solution, times, exact, gap=gap)
        errors.append(errors_of_mesh)

    coarsest, *_, finest = errors
    # The stress of the free end is 0, and some other errors are small by accident.
    is_clear = finest > 5e-7
    refinements = 3
    ratios = coarsest[is_clear] / finest[is_clear]
    orders = np.log2(ratios) / refinements
    assert orders.min() >= 1.6
    assert finest.max() <= 1e-4


@pytest.mark.parametrize("viscosity", [0.01, 0.3])
def test_velocities_do_not_alternate_from_node_to_node(viscosity):
    """Third differences are 8 times an alternation, and small of a smooth field."""
    rod = damped_rod(viscosity)
    system = ri.System([rod, ri.Wall()])

    solution = ri.solve(system, until=3.0, method=METHOD, cells=100)

    x = np.linspace(0.9, 1.0, 11)  # the last nodes
    for t in (2.5, 2.505, 2.6):
        velocity = solution.velocity(0, x, t)
        third_differences = np.diff(velocity, 3)
        assert np.abs(third_differences).max() <= 2e-5


def solve_with_snapshots(cells, snapshots):
    """A damped rod on a wall; `snapshots` is a number, or times, of states to keep."""
    rod = damped_rod(0.05)
    system = ri.System([rod, ri.Wall()])
    return ri.solve(system, until=3.0, method=METHOD, cells=cells, snapshots=snapshots)


@pytest.fixture(scope="module", params=[50, 400])
def full(request):
    """A run of so many cells that keeps the states of all steps."""
    return solve_with_snapshots(request.param, snapshots=None)


def test_fields_at_chosen_times_are_as_good_as_those_with_all_states(full):
    """About each time there are two states with their neighbours, so that velocities
    are smoothed as with all states.
    """
    t = np.array([0.61, 1.3, 2.618])
    (cells,) = full.fields.motion.counts

    chosen = solve_with_snapshots(cells, snapshots=t)

    n_states = len(chosen.fields.motion.when)
    assert n_states <= 4 * 3 + 4 + 3  # also about the start and the end
    x = PLACES[:, None]
    for name in FIELDS:
        field = getattr(chosen, name)
        field_with_all_states = getattr(full, name)
        values = field(0, x, t)
        expected = field_with_all_states(0, x, t)
        assert values == pytest.approx(expected, rel=1e-12, abs=1e-13)


def test_velocities_at_a_few_states_are_as_good_as_those_with_all_states(full):
    """States come in threes, so that the middle one is smoothed as with all states."""
    x = PLACES[:, None]
    (cells,) = full.fields.motion.counts

    few = solve_with_snapshots(cells, snapshots=40)

    when = few.fields.motion.when  # steps at which states are kept
    assert len(when) <= 40 + 3
    follows_at_once = np.diff(when) == 1
    is_middle = follows_at_once[1:] & follows_at_once[:-1]
    inner = when[1:-1]
    middles_of_threes = inner[is_middle] * few.fields.step  # s
    assert len(middles_of_threes) >= 8
    velocity = few.velocity(0, x, middles_of_threes)
    expected = full.velocity(0, x, middles_of_threes)
    assert velocity == pytest.approx(expected, rel=1e-9, abs=1e-12)


ENDS = {
    "free": (ri.Free(), ri.Free()),
    "fixed": (ri.Fixed(), ri.Fixed()),
}


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("viscosity", few_of([0.0, 0.04], [0.04]))
def test_errors_of_a_mode_are_of_order_two_everywhere(ends, viscosity):
    """u = sin(w t)/w exp(-d t) shape(x), d = viscosity pi^2/2, w^2 = pi^2 - d^2."""
    times = np.linspace(0.2, 2.4, 12)
    decay = viscosity * math.pi**2 / 2
    w = math.sqrt(math.pi**2 - decay**2)
    fade = np.exp(-decay * times)
    displacement = np.sin(w * times) / w
    amplitude = displacement * fade
    rate = np.cos(w * times) * fade - decay * amplitude
    phase = math.pi * PLACES
    if ends == "free":
        shape_function = np.cos
        slope = -np.sin(phase) * math.pi
    else:
        shape_function = np.sin
        slope = np.cos(phase) * math.pi
    shape = shape_function(phase)
    damped_amplitude = amplitude + viscosity * rate
    exact = {
        "velocity": np.outer(shape, rate),
        "stress": np.outer(slope, damped_amplitude),
        "displacement": np.outer(shape, amplitude),
    }

    def initial_velocity(x):
        return float(shape_function(math.pi * x))

    rod = damped_rod(viscosity).replace(velocity=initial_velocity)
    system = ri.System([rod], ends=ENDS[ends])
    errors = []
    for cells in (50, 100, 200, 400):
        solution = ri.solve(system, until=2.5, method=METHOD, cells=cells)
        errors_of_mesh = largest_errors(solution, times, exact)
        errors.append(errors_of_mesh)

    # Smaller errors, where fields are 0, have no order.
    coarsest, *_, finest = np.maximum(errors, 1e-9)
    has_order = coarsest > 1e-9
    refinements = 3
    orders = np.log2(coarsest / finest) / refinements
    assert orders[has_order].min() >= 1.7
    assert finest.max() <= 1e-4
