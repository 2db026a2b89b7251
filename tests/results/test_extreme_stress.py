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
SEEDS = few_of(range(40), range(6))


# Closed forms -------------------------------------------------------------------------


@pytest.mark.parametrize("reflected", [0.02, 0.07, 0.1])
@pytest.mark.parametrize("length", [0.2, 0.31])
def test_spall_by_a_triangular_pulse(reflected, length):
    """A pulse of stress s and length l, its front ahead: tension 2 d s/l at d from the
    free end.

    It is largest on the reflected front, so at the end of the run.
    """
    stress = 3e-3
    pulse = ri.Samples([-stress, 0.0], step=length)
    bar = ri.System([unit_rod()], ends=(ri.Incoming(pulse), ri.Free()))
    solution = ri.solve(bar, until=1.0 + reflected)
    tension, compression = solution.extreme_stress(0)
    assert tension.stress == pytest.approx(2 * reflected * stress / length, rel=1e-9)
    assert (tension.x, tension.t) == pytest.approx((1 - reflected, 1 + reflected))
    assert compression == pytest.approx((-stress, 0.0, 0.0), rel=1e-9, abs=1e-12)


def test_spall_where_half_of_the_pulse_has_come_back():
    """From then on the front meets no compression: the tension is that of the pulse."""
    pulse = ri.Samples([-3e-3, 0.0], step=0.2)
    bar = ri.System([unit_rod()], ends=(ri.Incoming(pulse), ri.Free()))
    tension = ri.solve(bar, until=1.7).extreme_stress(0).tension
    assert tension == pytest.approx((3e-3, 0.9, 1.1), rel=1e-9)


@pytest.mark.parametrize("mass", [1.0, 2.0, 4.0])
def test_a_mass_on_a_fixed_rod(mass):
    """Saint-Venant: the stress at the fixed end reaches 2 (1 + exp(-2 m/M)) times rho c
    V.

    That is at t = 3 L/c; both ends are struck by fronts that decay as exp(-t/M).
    """
    striker = ri.RigidMass(mass, velocity=1e-3)
    row = ri.System([striker, unit_rod()], ends=(ri.Free(), ri.Fixed()))
    compression = ri.solve(row, until=3.5).extreme_stress(1).compression
    largest = 2 * (1 + math.exp(-2 / mass))
    assert compression == pytest.approx((-1e-3 * largest, 1.0, 3.0), rel=1e-9)


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_two_rods_of_unequal_impedance(method):
    """The contact stress is rho c v Z2/(Z1 + Z2) in rod 1 until the first wave is
    back.
    """
    row = ri.System([unit_rod(0.5, area=2.0, velocity=1e-3), unit_rod(1.0, area=3.0)])
    extreme = ri.solve(row, 0.9, method).extreme_stress(0)
    largest = 1e-3 * 3 / 5
    assert extreme.compression.stress == pytest.approx(-largest, rel=1e-9)
    assert (extreme.compression.x, extreme.compression.t) == (0.5, 0.0)
    assert extreme.largest == -extreme.compression.stress
    assert extreme.tension.stress == 0.0
    assert math.isnan(extreme.tension.t)


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_a_standing_wave(method):
    """sigma = sin(pi x) cos(pi t): tension in the middle at t = 0, compression at t =
    1.
    """
    rod = unit_rod(strain=lambda x: 1e-3 * math.sin(math.pi * x))
    options = {"cells": 200} if method == "finite-difference" else {}
    extreme = ri.solve(ri.System([rod]), 1.25, method, **options).extreme_stress(0)
    near = 1e-9 if method == "characteristics" else 1e-3
    assert extreme.tension.stress == pytest.approx(1e-3, rel=near)
    assert extreme.compression.stress == pytest.approx(-1e-3, rel=near)
    # A flat top: the place is known to the root of the accuracy.
    assert (extreme.tension.x, extreme.tension.t) == pytest.approx((0.5, 0.0), abs=0.02)
    assert extreme.compression[1:] == pytest.approx((0.5, 1.0), abs=0.02)


# Random rows --------------------------------------------------------------------------


def solved(method, seed):
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
    try:
        solution = solved(method, seed)
    except ri.InvalidModel:  # a mass squeezed by walls
        return
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
    try:
        solution = solved(method, seed)
    except ri.InvalidModel:
        return
    stated = max(1e-9, solution.accuracy.get("peak force", 0.0))
    for body in rods_of(solution.system):
        segments = solution.system.bodies[body].segments
        if any(segment.lateral_inertia is not None for segment in segments):
            continue  # which takes a share of the force
        largest = solution.extreme_stress(body).largest
        for contact, segment, end in ((body - 1, 0, 0), (body, -1, -1)):
            if not 0 <= contact < len(solution.contacts):
                continue
            peak = solution.contacts[contact].peak_force
            area = segments[segment].area
            if isinstance(area, ri.Samples):
                area = area.values[end]
            if not math.isnan(peak):
                assert largest >= peak / area * (1 - stated)


@pytest.mark.parametrize("law", [ri.SpringDashpot(0.3, 0.2), ri.Hertz(2.0)])
@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_families_and_single_runs_agree(method, law):
    """The column was too low by 1.2 % beside the peak force on the same area."""
    left = unit_rod(velocity=np.array([1.0, 0.9]))
    family = ri.System([left, unit_rod()], contacts=[law])
    options = {} if method == "characteristics" else {"cells": 50}
    result = ri.sweep(family, method, until=6.0, also=["largest_stress"], **options)
    for i in range(2):
        solution = ri.solve(family[i], 6.0, method, **options)
        for body in (0, 1):
            column = result.largest_stresses[body][i]
            assert column == solution.extreme_stress(body).largest
            assert column >= result.contacts[0].peak_force[i] * (1 - 1e-12)


@pytest.mark.parametrize("viscosity", [0.0, 0.02])
def test_a_grid_comes_to_the_stress_of_the_waves(viscosity):
    """Smooth contacts: within the stated error of the peak force, or order 2 of the
    mesh.
    """
    lossy = UNIT.replace(viscosity=viscosity)
    rods = [
        ri.Rod(0.7, area=1.0, material=lossy, velocity=1e-3),
        ri.Rod(1.1, area=0.6, material=lossy),
    ]
    row = ri.System(rods, contacts=[ri.Hertz(50.0)])
    fine = ri.solve(row, 3.0, "finite-difference", cells=800)
    if viscosity == 0:
        fine = ri.solve(row, 3.0, "characteristics")
    errors = []
    for cells in (50, 100, 200):
        grid = ri.solve(row, 3.0, "finite-difference", cells=cells)
        errors.append(0.0)
        for body in (0, 1):
            pairs = zip(
                grid.extreme_stress(body), fine.extreme_stress(body), strict=True
            )
            for mesh, exact in pairs:
                error = abs(mesh.stress / exact.stress - 1)
                errors[-1] = max(errors[-1], error)
    assert errors[0] <= 5e-3
    assert errors[-1] <= errors[0] / 8


# Mistakes -----------------------------------------------------------------------------


def test_only_a_rod_has_stress():
    row = ri.System([ri.Wall(), unit_rod(velocity=-1.0), ri.RigidMass(1.0)])
    solution = ri.solve(row, 1.0)
    with pytest.raises(ValueError, match="body: 0 is a wall"):
        solution.extreme_stress(0)
    with pytest.raises(ValueError, match="body: 2 is a rigid mass"):
        solution.extreme_stress(2)
    with pytest.raises(ValueError, match="body"):
        solution.extreme_stress(3)
