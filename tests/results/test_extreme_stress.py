"""The largest tension and compression of a rod: closed forms, random rows, every
method.
"""

import math

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import random_row
from networks import UNIT, random_network, unit_rod
from systems import horizon, random_system

import rodimpact as ri

METHODS = ("fronts", "characteristics", "finite-difference")
SEEDS = few_of(range(40), range(2))


# Closed forms
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("reflected", [0.02, 0.07, 0.1])
@pytest.mark.parametrize("length", [0.2, 0.31])
def test_the_tension_behind_a_reflected_triangular_pulse(reflected, length):
    """A pulse of stress s and length l, its front ahead: tension 2 d s/l at d from the
    free end.

    It is largest on the reflected front, so at the end of the run, as the front is
    `reflected` m from that end.
    """
    stress = 3e-3
    pulse = ri.Samples([-stress, 0.0], step=length)
    bar = ri.System([unit_rod()], ends=(ri.Incoming(pulse), ri.Free()))
    solution = ri.solve(bar, until=1.0 + reflected)
    tension, compression = solution.extreme_stress(0)
    assert tension.stress == pytest.approx(2 * reflected * stress / length, rel=1e-9)
    assert tension.x == pytest.approx(1 - reflected)
    assert tension.t == pytest.approx(1 + reflected)
    assert compression == pytest.approx((-stress, 0.0, 0.0), rel=1e-9, abs=1e-12)


def test_the_tension_is_that_of_the_pulse_once_half_of_it_has_come_back():
    """From then on the front meets no compression."""
    pulse = ri.Samples([-3e-3, 0.0], step=0.2)
    bar = ri.System([unit_rod()], ends=(ri.Incoming(pulse), ri.Free()))
    tension = ri.solve(bar, until=1.7).extreme_stress(0).tension
    assert tension == pytest.approx((3e-3, 0.9, 1.1), rel=1e-9)


@pytest.mark.parametrize("mass", [1.0, 2.0, 4.0])
def test_the_stress_of_a_rod_between_a_striking_mass_and_a_fixed_end(mass):
    """Saint-Venant: at the fixed end it reaches 2 (1 + exp(-2 m/M)) times rho c V.

    m is the mass of the rod, 1 kg. That is at t = 3 L/c; both ends are struck by fronts
    that decay as exp(-t/M).
    """
    striker = ri.RigidMass(mass, velocity=1e-3)
    row = ri.System([striker, unit_rod()], ends=(ri.Free(), ri.Fixed()))
    compression = ri.solve(row, until=3.5).extreme_stress(1).compression
    largest = 2 * (1 + math.exp(-2 / mass))
    assert compression == pytest.approx((-1e-3 * largest, 1.0, 3.0), rel=1e-9)


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_the_stress_of_a_rod_that_strikes_one_of_another_impedance(method):
    """The contact stress is rho c v Z2/(Z1 + Z2) in rod 1 until the first wave is
    back.
    """
    row = ri.System([unit_rod(0.5, area=2.0, velocity=1e-3), unit_rod(1.0, area=3.0)])
    extreme = ri.solve(row, 0.9, method).extreme_stress(0)
    largest = 1e-3 * 3 / 5
    assert extreme.compression.stress == pytest.approx(-largest, rel=1e-9)
    assert extreme.compression.x == 0.5
    assert extreme.compression.t == 0.0
    assert extreme.largest == -extreme.compression.stress
    assert extreme.tension.stress == 0.0
    assert math.isnan(extreme.tension.t)


@pytest.mark.parametrize(
    ("method", "cells", "near"),
    [("characteristics", None, 1e-9), ("finite-difference", 200, 1e-3)],
)
def test_the_extremes_of_a_standing_wave_are_in_the_middle(method, cells, near):
    """sigma = 1e-3 sin(pi x) cos(pi t): tension at t = 0, compression at t = 1."""
    rod = unit_rod(strain=lambda x: 1e-3 * math.sin(math.pi * x))
    solution = ri.solve(ri.System([rod]), 1.25, method, cells=cells)
    tension, compression = solution.extreme_stress(0)
    assert tension.stress == pytest.approx(1e-3, rel=near)
    assert compression.stress == pytest.approx(-1e-3, rel=near)
    # A flat top: places and times are known to the root of the accuracy.
    assert tension.x == pytest.approx(0.5, abs=0.02)
    assert tension.t == pytest.approx(0.0, abs=0.02)
    assert compression.x == pytest.approx(0.5, abs=0.02)
    assert compression.t == pytest.approx(1.0, abs=0.02)


# Random rows
# --------------------------------------------------------------------------------------


def solved(method, seed):
    """A random row, of a kind that the method carries; none is refused."""
    if method == "fronts":
        system = random_system(seed, bodies=2 + seed % 4)
        return ri.solve(system, horizon(system, 3.0), method, max_events=3000)
    driven = seed % 2 == 0
    if method == "characteristics":
        system = random_network(seed, bodies=4, driven=driven)
        return ri.solve(system, 3.0, method, rtol=1e-8, max_events=30_000)
    system = random_row(seed, bodies=4, driven=driven)
    return ri.solve(system, 3.0, method, dt=1 / 32)


def rods_of(system):
    return [i for i, body in enumerate(system.bodies) if isinstance(body, ri.Rod)]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_no_stress_of_the_fields_is_beyond_the_extremes(method, seed):
    """Fields are evaluated at random places and times, and at both ends of each rod."""
    solution = solved(method, seed)
    rng = np.random.default_rng(seed)
    for body in rods_of(solution.system):
        length = float(solution.system.bodies[body].length)
        x = np.concatenate(([0.0, length], rng.uniform(0, length, 30)))
        t = np.sort(rng.uniform(0, solution.t_end, 400))
        stress = solution.stress(body, x[:, None], t)
        tension, compression = solution.extreme_stress(body)
        slack = 1e-9 * np.abs(stress).max()
        assert stress.max() <= tension.stress + slack
        assert stress.min() >= compression.stress - slack


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("method", METHODS)
def test_the_stress_is_no_less_than_the_peak_force_over_the_area(method, seed):
    solution = solved(method, seed)
    stated = max(1e-9, solution.accuracy.get("peak force", 0.0))
    for body in rods_of(solution.system):
        segments = solution.system.bodies[body].segments
        if any(segment.lateral_inertia is not None for segment in segments):
            continue  # which takes a share of the force
        largest = solution.extreme_stress(body).largest
        contact_on_left = body - 1
        contact_on_right = body
        for contact, end in ((contact_on_left, 0), (contact_on_right, -1)):
            if not 0 <= contact < len(solution.contacts):
                continue
            peak = solution.contacts[contact].peak_force
            area = segments[end].area
            if isinstance(area, ri.Samples):  # a taper
                area = area.values[end]
            if not math.isnan(peak):
                assert largest >= peak / area * (1 - stated)


HERTZ = ri.Hertz(2.0)
LAWS = [ri.SpringDashpot(0.3, 0.2), HERTZ]


@pytest.mark.parametrize("law", few_of(LAWS, [HERTZ]))
@pytest.mark.parametrize(
    ("method", "cells"), [("characteristics", None), ("finite-difference", 50)]
)
def test_largest_stresses_of_members_are_those_alone_and_no_less_than_of_the_peak_force(
    method, cells, law
):
    """They were once too low by 1.2 % beside the peak force on the same area."""
    left = unit_rod(velocity=np.array([1.0, 0.9]))
    family = ri.System([left, unit_rod()], contacts=[law])
    result = ri.sweep(family, method, until=6.0, also=["largest_stress"], cells=cells)
    for i in range(2):
        solution = ri.solve(family[i], 6.0, method, cells=cells)
        for body in (0, 1):
            column = result.largest_stresses[body][i]
            assert column == solution.extreme_stress(body).largest
            assert column >= result.contacts[0].peak_force[i] * (1 - 1e-12)


@pytest.mark.parametrize("viscosity", few_of([0.0, 0.02], [0.0]))
def test_errors_of_the_extremes_on_a_grid_fall_with_the_square_of_the_step(viscosity):
    """At a smooth contact: almost to a 16th in cells of a fourth.

    The reference is characteristics or, with damping, a fine grid.
    """
    lossy = UNIT.replace(viscosity=viscosity)
    rods = [
        ri.Rod(0.7, area=1.0, material=lossy, velocity=1e-3),
        ri.Rod(1.1, area=0.6, material=lossy),
    ]
    row = ri.System(rods, contacts=[ri.Hertz(50.0)])
    if viscosity == 0:
        fine = ri.solve(row, 3.0, "characteristics")
    else:
        fine = ri.solve(row, 3.0, "finite-difference", cells=800)
    errors = []  # largest of each mesh, relative
    for cells in (50, 100, 200):
        grid = ri.solve(row, 3.0, "finite-difference", cells=cells)
        errors_of_mesh = []
        for body in (0, 1):
            tension, compression = grid.extreme_stress(body)
            exact_tension, exact_compression = fine.extreme_stress(body)
            errors_of_mesh.append(abs(tension.stress / exact_tension.stress - 1))
            error = abs(compression.stress / exact_compression.stress - 1)
            errors_of_mesh.append(error)
        errors.append(max(errors_of_mesh))
    assert errors[0] <= 5e-3
    assert errors[-1] <= errors[0] / 8


# Mistakes
# --------------------------------------------------------------------------------------


def test_only_a_rod_has_extreme_stresses():
    row = ri.System([ri.Wall(), unit_rod(velocity=-1.0), ri.RigidMass(1.0)])
    solution = ri.solve(row, 1.0)
    with pytest.raises(ValueError, match="body: 0 is a wall"):
        solution.extreme_stress(0)
    with pytest.raises(ValueError, match="body: 2 is a rigid mass"):
        solution.extreme_stress(2)
    with pytest.raises(ValueError, match="body"):
        solution.extreme_stress(3)
