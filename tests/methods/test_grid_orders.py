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


def errors_at(system, until, cells, times, exact, gap=0.0):
    """Largest error of each field at each place, [field, place]."""
    solution = ri.solve(system, until, METHOD, cells=cells)
    errors = []
    for name in FIELDS:
        values = getattr(solution, name)(0, PLACES[:, None], times + gap)
        if name == "displacement":
            values = values - gap
        errors.append(np.abs(values - getattr(exact, name)).max(axis=1))
    return np.array(errors)


@pytest.mark.parametrize("gap", [0.0, 0.0937])
@pytest.mark.parametrize("viscosity", few_of([0.01, 0.05, 0.3], [0.05]))
def test_a_damped_rod_that_falls_on_a_wall(viscosity, gap):
    """The velocity of the end alternated by 4e-4, and all fields were half a step
    late.
    """
    times = np.array([0.6, 0.9, 1.25, 2.5, 2.6, 2.7, 3.2])
    exact, opening = rod_on_wall(PLACES, times, viscosity)
    assert 1.25 < opening < 2.5
    rod = ri.Rod(
        1.0, area=1.0, material=UNIT.replace(viscosity=viscosity), velocity=1.0
    )
    system = ri.System([rod, ri.Wall()], gaps=[gap])
    errors = []
    for cells in (50, 100, 200, 400):
        errors.append(errors_at(system, 3.5, cells, times, exact, gap))
    # The stress of the free end is 0, and some other errors are small by accident.
    clear = errors[-1] > 5e-7
    orders = np.log2(errors[0][clear] / errors[-1][clear]) / 3
    assert orders.min() >= 1.6
    assert errors[-1].max() <= 1e-4


@pytest.mark.parametrize("viscosity", [0.01, 0.3])
def test_velocities_do_not_alternate_from_node_to_node(viscosity):
    rod = ri.Rod(
        1.0, area=1.0, material=UNIT.replace(viscosity=viscosity), velocity=1.0
    )
    solution = ri.solve(ri.System([rod, ri.Wall()]), 3.0, METHOD, cells=100)
    x = np.linspace(0.9, 1.0, 11)  # the nodes
    for t in (2.5, 2.505, 2.6):
        v = solution.velocity(0, x, t)
        assert np.abs(np.diff(v, 3)).max() <= 2e-5


@pytest.mark.parametrize("cells", [50, 400])
def test_smoothed_velocities_where_few_states_are_kept(cells):
    """States come in threes, so that their velocities are as good as those of all
    states.
    """
    rod = ri.Rod(1.0, area=1.0, material=UNIT.replace(viscosity=0.05), velocity=1.0)
    system = ri.System([rod, ri.Wall()])
    full = ri.solve(system, 3.0, METHOD, cells=cells)
    t = np.array([0.61, 1.3, 2.618])
    chosen = ri.solve(system, 3.0, METHOD, cells=cells, snapshots=t)
    x = PLACES[:, None]
    assert len(chosen.fields.motion.when) <= 4 * 3 + 4 + 3
    for name in FIELDS:
        values_of_chosen = getattr(chosen, name)(0, x, t)
        assert values_of_chosen == pytest.approx(
            getattr(full, name)(0, x, t), rel=1e-12, abs=1e-13
        )
    few = ri.solve(system, 3.0, METHOD, cells=cells, snapshots=40)
    when = few.fields.motion.when
    assert len(when) <= 40 + 3
    middle = when[1:-1][(np.diff(when)[1:] == 1) & (np.diff(when)[:-1] == 1)]
    states = middle * few.fields.step
    assert len(states) >= 8
    assert few.velocity(0, x, states) == pytest.approx(
        full.velocity(0, x, states), rel=1e-9, abs=1e-12
    )


SMOOTH = {
    "free": (ri.Free(), ri.Free()),
    "fixed": (ri.Fixed(), ri.Fixed()),
}


@pytest.mark.parametrize("ends", SMOOTH)
@pytest.mark.parametrize("viscosity", [0.0, 0.04])
def test_a_mode_is_of_order_two_everywhere(ends, viscosity):
    """u = sin(w t)/w exp(-d t) shape(x), d = eta w^2/2, of the frequency pi."""
    times = np.linspace(0.2, 2.4, 12)
    decay = viscosity * math.pi**2 / 2
    w = math.sqrt(math.pi**2 - decay**2)
    fade = np.exp(-decay * times)
    q = np.sin(w * times) / w * fade
    rate = np.cos(w * times) * fade - decay * q
    shape = np.cos if ends == "free" else np.sin
    slope = np.cos(math.pi * PLACES) * math.pi
    if ends == "free":
        slope = -np.sin(math.pi * PLACES) * math.pi
    exact = {
        "velocity": np.outer(shape(math.pi * PLACES), rate),
        "stress": np.outer(slope, q + viscosity * rate),
        "displacement": np.outer(shape(math.pi * PLACES), q),
    }
    material = UNIT.replace(viscosity=viscosity)
    rod = ri.Rod(
        1.0, area=1.0, material=material, velocity=lambda x: float(shape(math.pi * x))
    )
    system = ri.System([rod], ends=SMOOTH[ends])
    errors = []
    for cells in (50, 100, 200, 400):
        solution = ri.solve(system, 2.5, METHOD, cells=cells)
        errors_of_mesh = []
        for name, values in exact.items():
            field = getattr(solution, name)(0, PLACES[:, None], times)
            errors_of_mesh.append(np.abs(field - values).max(axis=1))
        errors.append(errors_of_mesh)
    errors = np.maximum(errors, 1e-9)
    zero = errors[0] <= 1e-9
    orders = np.log2(errors[0] / errors[-1]) / 3
    assert orders[~zero].min() >= 1.7
    assert errors[-1].max() <= 1e-4
