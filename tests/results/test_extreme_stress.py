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


PULSE_STRESS = 3e-3
"""Compression at the front of the triangular pulse, in units of E: Pa of `UNIT`."""


def solve_under_pulse(length, until):
    """A rod of 1 m and 1 m/s, into which a triangular pulse of compression runs at
    x = 0.

    It falls from its front to its end over `length`, m. The other end is free.
    """
    strain = ri.Samples([-PULSE_STRESS, 0.0], step=length)
    ends = (ri.Incoming(strain), ri.Free())
    bar = ri.System([unit_rod()], ends=ends)
    return ri.solve(bar, until)


@pytest.mark.parametrize("reflected", [0.02, 0.07, 0.1])
@pytest.mark.parametrize("length", [0.2, 0.31])
def test_the_tension_behind_a_reflected_triangular_pulse(reflected, length):
    """A pulse of stress s and length l, its front ahead: tension 2 d s/l at d from the
    free end.

    It is largest on the reflected front, so at the end of the run, as the front is
    `reflected` m from that end.
    """
    solution = solve_under_pulse(length, until=1.0 + reflected)

    tension, compression = solution.extreme_stress(0)
    largest_tension = 2 * reflected * PULSE_STRESS / length
    assert tension.stress == pytest.approx(largest_tension, rel=1e-9)
    assert tension.x == pytest.approx(1 - reflected)
    assert tension.t == pytest.approx(1 + reflected)
    front_enters = (-PULSE_STRESS, 0.0, 0.0)  # stress, place and time
    assert compression == pytest.approx(front_enters, rel=1e-9, abs=1e-12)


def test_the_tension_is_that_of_the_pulse_once_half_of_it_has_come_back():
    """A rod with a compressive pulse: its largest tension is that of the pulse, at the
    position and time at which half of the pulse has come back from the free end; from
    then on the front meets no compression.
    """
    length = 0.2
    half = length / 2

    solution = solve_under_pulse(length, until=1.7)

    tension = solution.extreme_stress(0).tension
    half_is_back = (PULSE_STRESS, 1 - half, 1 + half)  # stress, place and time
    assert tension == pytest.approx(half_is_back, rel=1e-9)


@pytest.mark.parametrize("mass", [1.0, 2.0, 4.0])
def test_the_stress_of_a_rod_between_a_striking_mass_and_a_fixed_end(mass):
    """Saint-Venant: at the fixed end it reaches 2 (1 + exp(-2 m/M)) times rho c V.

    m is the mass of the rod, 1 kg. That is at t = 3 L/c; both ends are struck by fronts
    that decay as exp(-t/M).
    """
    speed = 1e-3  # V, m/s; rho c = 1
    striker = ri.RigidMass(mass, velocity=speed)
    ends = (ri.Free(), ri.Fixed())
    row = ri.System([striker, unit_rod()], ends=ends)

    solution = ri.solve(row, until=3.5)

    compression = solution.extreme_stress(1).compression
    stress = -2 * (1 + math.exp(-2 / mass)) * speed
    at_fixed_end = (stress, 1.0, 3.0)  # stress, place and time
    assert compression == pytest.approx(at_fixed_end, rel=1e-9)


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_the_stress_of_a_rod_that_strikes_one_of_another_impedance(method):
    """The contact stress is rho c v Z2/(Z1 + Z2) in rod 1 until the first wave is
    back.
    """
    speed = 1e-3  # v, m/s; rho c = 1
    Z1 = 2.0
    Z2 = 3.0
    striker = unit_rod(length=0.5, area=Z1, velocity=speed)
    struck = unit_rod(length=1.0, area=Z2)
    row = ri.System([striker, struck])

    solution = ri.solve(row, 0.9, method)  # the first wave is back at 1 s

    tension, compression = solution.extreme_stress(0)
    contact_stress = speed * Z2 / (Z1 + Z2)
    assert compression.stress == pytest.approx(-contact_stress, rel=1e-9)
    assert compression.x == 0.5  # at the contact
    assert compression.t == 0.0
    assert tension.stress == 0.0
    assert math.isnan(tension.t)  # there is none
    assert solution.extreme_stress(0).largest == -compression.stress


@pytest.mark.parametrize(
    ("method", "cells", "near"),
    [("characteristics", None, 1e-9), ("finite-difference", 200, 1e-3)],
)
def test_the_extremes_of_a_standing_wave_are_in_the_middle(method, cells, near):
    """sigma = 1e-3 sin(pi x) cos(pi t): tension at t = 0, compression at t = 1."""
    amplitude = 1e-3
    rod = unit_rod(strain=lambda x: amplitude * math.sin(math.pi * x))
    system = ri.System([rod])

    solution = ri.solve(system, 1.25, method, cells=cells)

    tension, compression = solution.extreme_stress(0)
    assert tension.stress == pytest.approx(amplitude, rel=near)
    assert compression.stress == pytest.approx(-amplitude, rel=near)
    # A flat top: places and times are known to the root of the accuracy.
    near_in_x_and_t = 0.02
    assert tension.x == pytest.approx(0.5, abs=near_in_x_and_t)
    assert tension.t == pytest.approx(0.0, abs=near_in_x_and_t)
    assert compression.x == pytest.approx(0.5, abs=near_in_x_and_t)
    assert compression.t == pytest.approx(1.0, abs=near_in_x_and_t)


# Random rows
# --------------------------------------------------------------------------------------


def solve_random_row(method, seed):
    """The solution, by `method`, of a random row of bodies and laws that it can carry."""
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
    """Numbers of the bodies that are rods."""
    return [i for i, body in enumerate(system.bodies) if isinstance(body, ri.Rod)]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_no_stress_of_the_fields_is_beyond_the_extremes(method, seed):
    """Stresses at both ends of each rod and at 30 random positions, at 400 random
    times, lie between the extreme tension and compression of the rod.
    """
    solution = solve_random_row(method, seed)
    rng = np.random.default_rng(seed)
    for body in rods_of(solution.system):
        length = float(solution.system.bodies[body].length)
        ends = [0.0, length]
        inside = rng.uniform(0, length, 30)
        x = np.concatenate((ends, inside))
        t = np.sort(rng.uniform(0, solution.t_end, 400))
        stress = solution.stress(body, x[:, None], t)
        tension, compression = solution.extreme_stress(body)
        round_off = 1e-9 * np.abs(stress).max()
        assert stress.max() <= tension.stress + round_off
        assert stress.min() >= compression.stress - round_off


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("method", METHODS)
def test_the_stress_is_no_less_than_the_peak_force_over_the_area(method, seed):
    """In each rod of a random row the largest stress is at least the peak force of
    either neighbouring contact over the area there, to the stated error. Rods with
    lateral inertia are left out.
    """
    solution = solve_random_row(method, seed)
    stated_error = solution.accuracy.get("peak force", 0.0)
    error = max(1e-9, stated_error)  # relative; round-off at least
    for body in rods_of(solution.system):
        segments = solution.system.bodies[body].segments
        if any(segment.lateral_inertia is not None for segment in segments):
            continue  # lateral inertia takes a share of the force
        largest = solution.extreme_stress(body).largest
        contact_on_left = body - 1
        contact_on_right = body
        for contact, end in ((contact_on_left, 0), (contact_on_right, -1)):
            if not 0 <= contact < len(solution.contacts):
                continue  # an end of the row
            peak_force = solution.contacts[contact].peak_force
            area = segments[end].area
            if isinstance(area, ri.Samples):  # a taper
                area = area.values[end]
            if not math.isnan(peak_force):
                stress = peak_force / area
                assert largest >= stress * (1 - error)


HERTZ = ri.Hertz(2.0)
LAWS = [ri.SpringDashpot(0.3, 0.2), HERTZ]


@pytest.mark.parametrize("law", few_of(LAWS, [HERTZ]))
@pytest.mark.parametrize(
    ("method", "cells"), [("characteristics", None), ("finite-difference", 50)]
)
def test_largest_stresses_of_members_are_those_alone_and_no_less_than_of_the_peak_force(
    method, cells, law
):
    """The largest stresses of a swept family of two are those of its members solved
    alone, and at least the peak force over the area, which is 1 here; once they were
    1.2 % too low.
    """
    left = unit_rod(velocity=np.array([1.0, 0.9]))
    family = ri.System([left, unit_rod()], contacts=[law])
    result = ri.sweep(family, method, until=6.0, also=["largest_stress"], cells=cells)
    for i in range(2):
        solution = ri.solve(family[i], 6.0, method, cells=cells)
        for body in (0, 1):
            column = result.largest_stresses[body][i]
            assert column == solution.extreme_stress(body).largest
            assert column >= result.contacts[0].peak_force[i] * (1 - 1e-12)


def stresses_of_pair(solution):
    """Largest tension and compression of the first, then of the second rod, Pa [4]."""
    stresses = []
    for body in (0, 1):
        tension, compression = solution.extreme_stress(body)
        stresses += [tension.stress, compression.stress]
    return np.array(stresses)


@pytest.mark.parametrize("viscosity", few_of([0.0, 0.02], [0.0]))
def test_errors_of_the_extremes_on_a_grid_fall_with_the_square_of_the_step(viscosity):
    """Two rods with a Hertz contact on 50, 100 and 200 cells: the error of the largest
    stresses is 0.5 % at most on the first mesh and falls to an eighth at most on the
    last, where the square would be a sixteenth. The reference is characteristics or,
    with damping, a fine grid.
    """
    lossy = UNIT.replace(viscosity=viscosity)
    rods = [
        ri.Rod(0.7, area=1.0, material=lossy, velocity=1e-3),
        ri.Rod(1.1, area=0.6, material=lossy),
    ]
    row = ri.System(rods, contacts=[ri.Hertz(50.0)])
    until = 3.0  # s
    if viscosity == 0:
        reference = ri.solve(row, until, "characteristics")
    else:
        reference = ri.solve(row, until, "finite-difference", cells=800)
    exact = stresses_of_pair(reference)

    errors = []  # largest of each mesh, relative
    for cells in (50, 100, 200):
        grid = ri.solve(row, until, "finite-difference", cells=cells)
        ratios = stresses_of_pair(grid) / exact
        error = np.abs(ratios - 1).max()
        errors.append(error)

    assert errors[0] <= 5e-3
    assert errors[-1] <= errors[0] / 8


# Mistakes
# --------------------------------------------------------------------------------------


def test_only_a_rod_has_extreme_stresses():
    """`extreme_stress` of a wall, of a rigid mass, and of a body that is not there
    raises ValueError.
    """
    row = ri.System([ri.Wall(), unit_rod(velocity=-1.0), ri.RigidMass(1.0)])
    solution = ri.solve(row, 1.0)
    with pytest.raises(ValueError, match="body: 0 is a wall"):
        solution.extreme_stress(0)
    with pytest.raises(ValueError, match="body: 2 is a rigid mass"):
        solution.extreme_stress(2)
    with pytest.raises(ValueError, match="body"):
        solution.extreme_stress(3)
