"""The method "finite-difference" through solve(): other methods, closed forms,
symmetry, limits.
"""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from exhaustive import few_of
from grid_rows import random_row
from mistakes import refused
from networks import UNIT, unit_rod
from runs import gaps_of, step_ends

import rodimpact as ri
from rodimpact.methods.grid import method as finite_difference
from rodimpact.methods.grid.mesh import STEP_TICKS
from rodimpact.methods.grid.signals import _accuracy_sentence

METHOD = "finite-difference"
COURANT = 0.999  # largest Courant number that is chosen


def material(E=1.0, rho=1.0, **options):
    """A material of bar speed 1 m/s, if nothing else is said."""
    return ri.Material("m", youngs_modulus=E, density=rho, **options)


def bar(Z, c, T, velocity=0.0, **options):
    """A rod of unit area with this impedance, wave speed and transit time."""
    length = T * c
    stiffness = Z * c  # E A, N
    mass_per_length = Z / c  # rho A, kg/m
    of_bar = material(E=stiffness, rho=mass_per_length)
    of_bar = material(E=Z * c, rho=Z / c)
    return ri.Rod(length, area=1.0, material=of_bar, velocity=velocity, **options)


def segment(Z, c, T):
    """A segment of unit area with this impedance, wave speed and transit time."""
    length = T * c
    stiffness = Z * c  # E A, N
    mass_per_length = Z / c  # rho A, kg/m
    of_segment = material(E=stiffness, rho=mass_per_length)
    return ri.Segment(length, area=1.0, material=of_segment)


RUN_OPTIONS = ("rtol", "dt", "max_events", "snapshots", "progress")


def solve_row(bodies, until=None, cells=None, gaps=None, contacts=None, **options):
    """The solution of a row on a grid; `options` are those of a run (`RUN_OPTIONS`) or
    of a system.
    """
    of_run = {}
    for name in RUN_OPTIONS:
        if name in options:
            of_run[name] = options.pop(name)
    system = ri.System(bodies, gaps=gaps, contacts=contacts, **options)
    return ri.solve(system, until=until, method=METHOD, cells=cells, **of_run)


def time_step(solution):
    """Time step of a solution on a grid, s."""
    return solution.fields.clock.tick * STEP_TICKS


def times_of_states(solution):
    """Times of the states that a run keeps, s, without the last: the last step may end
    beyond the run.
    """
    steps = solution.fields.motion.when[:-1]
    return steps * time_step(solution)


def order(errors):
    """Mean order of convergence of the errors of meshes, each twice as fine as the one
    before.
    """
    coarsest = errors[0]
    finest = errors[-1]
    refinements = len(errors) - 1
    return math.log2(coarsest / finest) / refinements


# Against exact fronts
# --------------------------------------------------------------------------------------

# Bars and segments by impedance, wave speed and transit time
FIRST = bar(1, 1, 0.7, velocity=1.0)
SECOND = bar(0.5, 1.3, 1.1 / 1.3)
STEPPED = ri.Rod(segments=[segment(1, 1, 0.5), segment(3, 1.2, 0.37)], velocity=1.0)
THICK_BEHIND = ri.Rod(segments=[segment(1, 1, 0.2), segment(8, 1, 0.9)], velocity=1.0)
THIN_BEFORE = ri.Rod(segments=[segment(0.5, 1.2, 0.33), segment(5, 1, 0.7)])
JUMP = ri.Steps([0.0, -0.3], at=[0.31])
STRAINED = bar(1, 1, 0.7, velocity=1.0, strain=JUMP)
STRIKER = bar(1, 1, 0.5, velocity=1.0)
THREE_RODS = [STRIKER, bar(2, 1.3, 0.8), bar(0.7, 0.9, 0.6)]
FOUR_RODS = [STRIKER, bar(1.5, 1, 0.7), bar(2, 1, 0.3), bar(0.8, 1, 0.45)]
BONDED_RODS = [STRIKER, bar(1.5, 1, 0.7), bar(2, 1.1, 0.3)]
ROWS = {
    "unequal impedances": ri.System([FIRST, SECOND]),
    "a gap": ri.System([FIRST, SECOND], gaps=[0.0317]),
    "a stepped rod": ri.System([STEPPED, bar(2, 0.9, math.sqrt(2))]),
    "a wall": ri.System([STEPPED, ri.Wall()], gaps=[0.2]),
    "three rods": ri.System(THREE_RODS, gaps=[0.0, 0.02]),
    "four rods": ri.System(FOUR_RODS, gaps=[0.01, 0.0, 0.03]),
    "a bond": ri.System(BONDED_RODS, contacts=[ri.Rigid(), ri.Bonded()]),
    "contact again": ri.System([THICK_BEHIND, THIN_BEFORE]),
    "strained before": ri.System([STRAINED, bar(0.5, 1.3, 1.1)], gaps=[0.05]),
}


def episodes_of(solution):
    """Number of episodes of each contact, by the histories and by the outcome."""
    in_histories = [len(contact.episodes) for contact in solution.contacts]
    in_outcome = [contact.episodes for contact in solution.outcome.contacts]
    return in_histories, in_outcome


def assert_shut_gaps_are_zero(solution, k):
    """If contact k presses in two successive steps, its gap at the end of the second is
    exactly 0; in the first, it may have closed in the middle. No gap is negative.
    """
    force = solution.contacts[k].push.values  # N [step]
    gap = gaps_of(solution, k)  # m, before and after each step [step + 1]
    assert gap.min() >= 0
    presses = force > 0
    presses_again = presses[1:] & presses[:-1]  # from the second step on
    gap_after = gap[2:]  # each of these steps
    assert np.all(gap_after[presses_again] == 0)


@pytest.mark.parametrize("cells", few_of([70, 110], [70]))
@pytest.mark.parametrize("system", ROWS.values(), ids=ROWS)
def test_contacts_of_rods_have_the_exact_number_of_episodes(system, cells):
    """Rods on a grid have the numbers of episodes of fronts: contacts do not chatter.
    While rigid contacts press, their gaps are exactly 0.
    """
    exact = ri.solve(system, method="fronts")

    solution = ri.solve(
        system, until=exact.t_end, method=METHOD, cells=cells, snapshots=5
    )

    assert episodes_of(solution) == episodes_of(exact)
    for k, contact in enumerate(exact.contacts):
        if isinstance(contact.law, ri.Rigid):
            assert_shut_gaps_are_zero(solution, k)


def impulses_of(outcome):
    """Impulse of each contact, N s."""
    return np.array([contact.impulse for contact in outcome.contacts])


def largest_error(values, exact_values):
    """Largest difference of two sequences of numbers."""
    differences = np.subtract(values, exact_values)
    return np.abs(differences).max()


@pytest.mark.parametrize("system", ROWS.values(), ids=ROWS)
def test_velocities_and_impulses_of_rows_of_rods_are_near_the_exact_ones(system):
    """Rods that strike at 1 m/s are solved on a grid of 110 cells: velocities differ
    from those of fronts by 6e-3 m/s at most, impulses by 0.01 N s.
    """
    exact = ri.solve(system, method="fronts")

    solution = ri.solve(
        system, until=exact.t_end, method=METHOD, cells=110, snapshots=5
    )

    velocities = solution.outcome.velocities_after
    exact_velocities = exact.outcome.velocities_after
    assert largest_error(velocities, exact_velocities) <= 6e-3  # m/s
    impulses = impulses_of(solution.outcome)
    exact_impulses = impulses_of(exact.outcome)
    assert largest_error(impulses, exact_impulses) <= 1e-2  # N s


def viscous_pair(first_length, second_length, viscosity):
    """A rod at 1 m/s and one at rest, both with this viscosity, Pa s."""
    lossy = material(viscosity=viscosity)
    return [
        ri.Rod(first_length, area=1.0, material=lossy, velocity=1.0),
        ri.Rod(second_length, area=1.0, material=lossy),
    ]


def test_viscous_ends_that_touch_at_the_start_are_no_part_of_a_step_late():
    """Half of the impulse is passed on when the wave has come to the far end of the
    first rod, of 0.4 m: to a tenth of a step.
    """
    pair = viscous_pair(0.4, 1.0, viscosity=1e-3)

    solution = solve_row(pair, until=2.0, cells=100)

    edges = step_ends(solution)
    force = solution.contacts[0].push.values  # N [step]
    impulses_of_steps = force * np.diff(edges)
    impulse = np.append(0.0, impulses_of_steps.cumsum())  # until each edge, N s
    half = impulse[-1] / 2  # of the impulse at the end of the run
    time_of_half = np.interp(half, impulse, edges)
    transit = 0.4  # of the first rod, at 1 m/s
    first_step = edges[1]
    assert time_of_half == pytest.approx(transit, abs=0.1 * first_step)


def mean_error_of_fields(solution, exact, times):
    """Mean errors of velocity and of strain at 500 points of each rod, their sum over
    the rods.
    """
    error = 0.0
    for i, rod in enumerate(exact.system.bodies):
        middles = (np.arange(500) + 0.5) / 500  # of 500 equal parts of the rod
        x = rod.length * middles[:, None]  # [point, 1]
        velocity_errors = solution.velocity(i, x, times) - exact.velocity(i, x, times)
        strain_errors = solution.strain(i, x, times) - exact.strain(i, x, times)
        error += np.abs(velocity_errors).mean()
        error += np.abs(strain_errors).mean()
    return error


def test_mean_errors_of_fields_with_jumps_are_of_order_one_half():
    """Velocities and strains with wave fronts are compared with fronts on meshes of 50
    to 400 cells.
    """
    system = ROWS["unequal impedances"]
    exact = ri.solve(system, method="fronts")
    times = np.array([0.4, 1.3, 2.0])

    errors = []
    for cells in (50, 100, 200, 400):
        solution = ri.solve(
            system, until=exact.t_end, method=METHOD, cells=cells, snapshots=times
        )
        errors.append(mean_error_of_fields(solution, exact, times))

    assert order(errors) >= 0.4
    assert errors[-1] <= 0.01  # the sum of four means, about 0.007


@pytest.mark.parametrize(("left", "right"), [(0.7, 1.1), (0.5, 1.0), (0.9, 0.4)])
def test_an_opening_is_where_the_gap_begins(left, right):
    """Damped rods, `left` and `right` m long, part slowly: the gap is 0 when the
    contact opens, and positive from then on.
    """
    pair = viscous_pair(left, right, viscosity=0.01)

    solution = solve_row(pair, cells=200)

    contact = solution.contacts[0]
    step = time_step(solution)
    (episode,) = contact.episodes
    opening = episode.opening
    force_end = episode.force_end
    assert force_end <= opening <= force_end + 2 * step
    # The tolerances are lengths as well: waves cross 1 m in 1 s.
    assert contact.gap(opening) <= 1e-4 * step
    first_time = opening + 0.01 * step
    later = np.linspace(first_time, solution.t_end, 999)
    assert np.all(contact.gap(later) > 0)


# Against characteristics
# --------------------------------------------------------------------------------------

RAMP = ri.Samples([0.0, 0.5, -0.3, 0.2, 0.0], step=0.5)
COSINE = np.cos(np.linspace(0, 3, 65))
WAVE = ri.Samples((0.3 * COSINE).tolist())
STRIKER_AND_BAR = [unit_rod(0.4, velocity=1.0), unit_rod(1.0, area=2.0)]
BARS = [unit_rod(), unit_rod(0.7, area=0.5)]


def chain_of_bonded_masses():
    """A mass strikes a row of bonded masses and rods through a spring."""
    bodies = [
        ri.RigidMass(0.5, velocity=1.0),
        ri.RigidMass(0.2),
        unit_rod(),
        ri.RigidMass(0.3),
        unit_rod(0.7, area=0.5),
    ]
    laws = [ri.Spring(4.0), ri.Bonded(), ri.Bonded(), ri.Bonded()]
    return ri.System(bodies, contacts=laws)


def row_between_walls():
    """A rod with a mass bonded to it, with a gap to a wall on either side."""
    rod = unit_rod(velocity=-0.5)
    bodies = [ri.Wall(), rod, ri.RigidMass(0.4), ri.Wall()]
    laws = [ri.Spring(9.0), ri.Bonded(), ri.Hertz(30.0)]
    return ri.System(bodies, gaps=[0.1, 0.0, 0.1], contacts=laws)


def bonds_between_driven_ends():
    """A rod with a bonded mass, and another rod, between a moved and a pushed end."""
    driven_rod = unit_rod(velocity=WAVE)
    mass = ri.RigidMass(0.5, velocity=WAVE.values[-1])  # that of the rod's right end
    other_rod = unit_rod(0.6, area=2.0)
    laws = [ri.Bonded(), ri.Spring(4.0)]
    push = ri.Pushed(np.sin, duration=3.0)
    ends = (ri.Moved(0.3), push)
    bodies = [driven_rod, mass, other_rod]
    return ri.System(bodies, contacts=laws, gravity=0.3, ends=ends)


COMPLIANT = {
    "spring": ri.System(STRIKER_AND_BAR, contacts=[ri.Spring(3.0)]),
    "Hertz": ri.System(STRIKER_AND_BAR, gaps=[0.05], contacts=[ri.Hertz(5.0)]),
    "Hunt-Crossley": ri.System(
        STRIKER_AND_BAR, contacts=[ri.HuntCrossley(5.0, damping=0.3)]
    ),
    "masses": ri.System(
        [ri.RigidMass(0.5, velocity=1.0), unit_rod(), ri.RigidMass(0.7)],
        gaps=[0.1, 0.05],
        contacts=[ri.Hertz(5.0), ri.Spring(4.0)],
    ),
    "bonded masses": chain_of_bonded_masses(),
    "a wall": row_between_walls(),
    "a force": ri.System(
        BARS,
        gaps=[0.02],
        contacts=[ri.Spring(5.0)],
        ends=(ri.Pushed(RAMP), ri.Absorbing()),
    ),
    "a velocity": ri.System(
        BARS, gaps=[0.02], contacts=[ri.Hertz(5.0)], ends=(ri.Moved(RAMP), ri.Fixed())
    ),
    "bonds between driven ends": bonds_between_driven_ends(),
    "a power": ri.System(STRIKER_AND_BAR, contacts=[ri.PowerLaw(5.0, exponent=2.0)]),
    "yielding": ri.System(
        STRIKER_AND_BAR, contacts=[ri.Yielding(5.0, yield_force=0.2, hardening=0.5)]
    ),
    "an incoming wave": ri.System(
        [unit_rod(0.4), unit_rod(1.0, area=2.0, velocity=0.3)],
        contacts=[ri.Hertz(5.0)],
        ends=(ri.Incoming(RAMP), ri.Free()),
    ),
    "an absorbing end": ri.System(
        [ri.RigidMass(0.5, velocity=0.6), unit_rod(velocity=WAVE)],
        contacts=[ri.Spring(4.0)],
        ends=(ri.Free(), ri.Absorbing()),
    ),
}
USUAL = {
    "Hunt-Crossley",
    "masses",
    "yielding",
    "an absorbing end",
}
SMOOTH_BOUNDS = (2e-4, 1.1)
"""Bound of the largest error of 160 cells, and least order, of rows not in `BOUNDS`."""
BOUNDS = {
    "a wall": (6e-3, 0.3),  # velocities jump as bodies meet at walls
    "masses": (2e-4, 1.85),
    "bonded masses": (2e-4, 1.85),
}


def motions_and_contacts_of(solution, times):
    """All that is compared at some times: mean velocities, displacements (inside of
    rods), impulses and gaps [quantity, time].
    """
    quantities = []
    for i, body in enumerate(solution.system.bodies):
        quantities.append(solution.mean_velocity(i, times))
        if isinstance(body, ri.Rod):
            x = 0.37 * float(body.length)  # no node of the meshes
            quantities.append(solution.displacement(i, x, times))
        elif isinstance(body, ri.RigidMass):
            quantities.append(solution.displacement(i, 0.0, times))
    for contact in solution.contacts:
        quantities.append(contact.impulse_until(times))
        quantities.append(contact.gap(times))
    return np.array(quantities)


@pytest.mark.parametrize("name", few_of(COMPLIANT, USUAL))
def test_rows_converge_to_characteristics_and_keep_the_balances(name):
    """Errors of motions and contacts on meshes of 40, 80 and 160 cells fall with second
    order where all is smooth, and between first and second where forces have kinks.
    Energy and momentum balance to round-off.
    """
    system = COMPLIANT[name]
    error_bound, least_order = BOUNDS.get(name, SMOOTH_BOUNDS)
    times = np.linspace(0, 2.3, 24)
    characteristics = ri.solve(system, until=2.3, method="characteristics")
    exact = motions_and_contacts_of(characteristics, times)

    errors = []
    for cells in (40, 80, 160):
        solution = ri.solve(system, until=2.3, method=METHOD, cells=cells)
        quantities = motions_and_contacts_of(solution, times)
        errors.append(largest_error(quantities, exact))
        outcome = solution.outcome
        assert abs(outcome.energy_residual) <= 1e-12
        assert abs(outcome.momentum_residual) <= 1e-12

    *_, finest_error = errors
    assert finest_error <= error_bound
    assert order(errors) >= least_order


# Closed forms
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("wave", [1, 3])
def test_a_mode_with_lateral_inertia_swings_at_its_slower_frequency(wave):
    """A free rod starts with v = cos(k x); the velocity of its end is cos(w t) with w^2
    = E k^2/(rho (1 + nu^2 k^2 I_p/A)).
    """
    nu = 0.3
    polar_moment = 0.8
    area = 2.0
    k = wave * math.pi  # 1/m
    lateral_inertia = nu**2 * k**2 * polar_moment / area  # over the axial one
    w = k / math.sqrt(1 + lateral_inertia)  # 1/s
    rod = ri.Rod(
        1.0,
        area=area,
        material=material(poisson_ratio=nu),
        polar_moment=polar_moment,
        lateral_inertia="rayleigh-love",
        velocity=lambda x: math.cos(k * x),
    )

    errors = []
    for cells in (40, 80):
        solution = solve_row([rod], until=4.0, cells=cells)
        times = times_of_states(solution)
        velocity_of_left_end = solution.velocity(0, 0.0, times)
        expected = np.cos(w * times)
        errors.append(largest_error(velocity_of_left_end, expected))

    assert errors[-1] <= 1e-3  # of an amplitude of 1; 6e-4 in mode 3
    assert order(errors) >= 1.8


# Options
# --------------------------------------------------------------------------------------

UNEQUAL = [unit_rod(velocity=1.0), unit_rod(0.37)]


def test_cells_are_those_of_the_longest_rod():
    """50 cells are asked for. The shorter rod, of 0.37 m, gets no shorter cells than
    the longer one; the steps are whole in number.
    """
    longest_step = COURANT / 50
    n_steps = math.ceil(2.0 / longest_step)

    solution = solve_row(UNEQUAL, until=2.0, cells=50)

    cells_of_shorter_rod = math.floor(0.37 * 50)
    assert solution.fields.motion.counts == [50, cells_of_shorter_rod]
    assert time_step(solution) == pytest.approx(2.0 / n_steps)
    assert "68 cells." in solution.status  # 50 + 18


def test_a_time_step_gives_the_cells():
    """A step of 0.03 s is asked for. Each rod has as many cells as it can if waves take
    this step or longer to cross one; then the step is shortened, so that a whole number
    of steps ends at `until`.
    """
    n_steps = math.ceil(2.0 / 0.03)  # 67 of 29.85 ms

    solution = solve_row(UNEQUAL, until=2.0, dt=0.03)

    cells_of_longer_rod = math.floor(1.0 / 0.03)
    cells_of_shorter_rod = math.floor(0.37 / 0.03)
    fields = solution.fields
    assert fields.motion.counts == [cells_of_longer_rod, cells_of_shorter_rod]
    assert time_step(solution) == pytest.approx(2.0 / n_steps, rel=1e-14)
    assert "Time step 29.8507 ms" in solution.status
    assert solution.t_end == 2.0
    assert fields.end == STEP_TICKS * n_steps


def test_a_courant_number_of_1_is_stable():
    """Two rods with a step in which a wave crosses exactly one cell: the energy
    balances to 1e-13.
    """
    step = 0.1  # a wave crosses one of the 10 cells in it

    solution = solve_row(UNEQUAL, until=2.0, cells=10, dt=step)

    assert solution.fields.motion.counts == [10, 3]
    residual = solution.outcome.energy_residual
    assert residual == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize(
    ("options", "path", "message"),
    [
        pytest.param(
            {"cells": 10, "dt": 0.15},
            "dt",
            r"would be unstable in bodies\.0, where 10 cells allow 0\.1 s, got 0\.15; "
            "take",
            id="unstable",
        ),
        pytest.param(
            {"dt": 0.5},
            "dt",
            r"must be 0\.37 s or less for a cell in bodies\.1, which waves cross in "
            r"0\.37 s",
            id="too long for a cell",
        ),
        pytest.param(
            {"cells": 2},
            "cells",
            "must be 3 or more for a cell in bodies.1, which waves cross in",
            id="too few cells",
        ),
        pytest.param(
            {"cells": 10**6},
            "cells",
            r"asks for 1370000 cells, of 1048576",
            id="too many cells",
        ),
        pytest.param({"dt": 1e-7}, "dt", r"asks for .* cells, of", id="too short"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_refused(options, path, message):
    """The row has a rod of 1 m, crossed in 1 s, and one of 0.37 m, crossed in 0.37 s."""
    paths = refused(message, solve_row, UNEQUAL, until=2.0, **options)
    assert paths == [path]


def test_an_overlong_run_is_refused_before_a_warning_of_how_long_it_takes():
    message = r"a run of \S+ steps .* needs .* GB .*, more than .* GB; stop earlier, keep fewer"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        paths = refused(message, solve_row, UNEQUAL, until=1e8, cells=100)
    assert paths == ["until"]


def test_a_segment_that_is_too_short_is_refused():
    """A segment of 1e-7 m beside one of 1 m would need too many cells; the message
    names its path.
    """
    long_segment = ri.Segment(1.0, area=1.0, material=UNIT)
    short_segment = ri.Segment(1e-7, area=1.0, material=UNIT)
    rod = ri.Rod(segments=[long_segment, short_segment])

    message = (
        r"its transit time, 1e-07 s, asks for .* cells, of 1048576 at most; "
        r"leave this segment"
    )
    paths = refused(message, solve_row, [rod], until=1.0)
    assert paths == ["bodies.0.segments.1"]


STEP = COURANT / 20  # the longest step of a unit rod of 20 cells, s
SIZES = [{"cells": 20}, {"dt": STEP}]  # two ways to ask for the same mesh
STRIKER_AND_MASS = [unit_rod(velocity=1.0), ri.RigidMass(1.0)]
TOOK_NO_STEP = "ends before half a step, and none was taken"  # words of a status


def assert_balanced(solution, until):
    """Assert that no energy is lost or gained from the start to `until`, s."""
    start_and_end = np.array([0.0, until])
    residual = solution.energy(start_and_end).residual
    assert np.abs(residual).max() <= 1e-14


@pytest.mark.parametrize("until", [0.026, 0.1, 1.0])
@pytest.mark.parametrize("size", SIZES)
def test_a_run_ends_where_it_was_asked_to_end(until, size):
    """A run on a grid ends exactly at `until`: it takes whole steps, which are
    shortened for this. The velocity in the middle of the rod is that of the wave from
    the mass, and the balances hold.
    """
    solution = solve_row(STRIKER_AND_MASS, until=until, **size)

    assert solution.t_end == until
    end = solution.fields.end  # ticks
    n_steps = end // STEP_TICKS
    assert n_steps == math.ceil(until / STEP)
    tick = solution.fields.clock.tick  # s
    assert end * tick == pytest.approx(until, rel=1e-14)
    assert TOOK_NO_STEP not in solution.status
    expected = 1.0  # m/s in the middle of the rod, which a wave from the mass reaches
    time_after_wave = until - 0.5  # s, from when on the wave has passed the middle
    if time_after_wave > 0:
        # Impedance and mass are 1: the mass moves at 1 - exp(-t).
        expected = 1 - math.exp(-time_after_wave)
    velocity = float(solution.velocity(0, 0.5, until))
    # With 20 cells the velocity is 0.05 m/s too small.
    assert velocity == pytest.approx(expected, abs=0.06)
    assert_balanced(solution, until)


@pytest.mark.parametrize("until", [0.0, 1e-300, 1e-12, 0.013])
@pytest.mark.parametrize("size", SIZES)
def test_a_run_of_less_than_half_a_step_takes_none_and_says_so(until, size):
    """All stays as at the start, and the status says why, except for a run of 0 s."""
    solution = solve_row(STRIKER_AND_MASS, until=until, **size)

    n_steps = solution.fields.end // STEP_TICKS  # the end is in ticks
    assert solution.t_end == until
    assert n_steps == 0
    says_so = TOOK_NO_STEP in solution.status
    assert says_so == (until > 0)
    velocity_of_middle = float(solution.velocity(0, 0.5, until))
    assert velocity_of_middle == pytest.approx(1.0, abs=0.1)
    assert_balanced(solution, until)
    outcome = solution.outcome
    velocities = outcome.velocities_after
    assert velocities == outcome.velocities_before
    assert velocities == pytest.approx((1.0, 0.0), abs=1e-15)
    assert outcome.impulse == 0.0
    displacement_of_mass = solution.displacement(1, 0.0, until)
    assert displacement_of_mass == pytest.approx(0.0, abs=1e-300)


NOT_CONVERGED = " Not converged to 0.001. Take a larger rtol, or give more cells."


@pytest.mark.parametrize(
    ("velocity", "peak", "stated", "warning"),
    [
        pytest.param(
            1e-3,
            math.inf,
            " Stated relative error: velocity 0.001, duration 0.02.",
            "",
            id="converged",
        ),
        pytest.param(
            2e-3,
            0.03,
            " Stated relative error: velocity 0.002, peak force 0.03, duration 0.02.",
            NOT_CONVERGED,
            id="rough",
        ),
        pytest.param(
            math.inf,
            math.inf,
            " Stated relative error: duration 0.02.",
            NOT_CONVERGED,
            id="unknown",
        ),
    ],
)
def test_every_known_error_is_stated_and_rough_ones_are_not_waited_for(
    velocity, peak, stated, warning
):
    """Errors that are infinite are unknown. Only that of the velocity must fall below
    rtol, 1e-3; those of peak force and duration may stay rough.
    """
    estimates = {"velocity": velocity, "peak force": peak, "duration": 0.02}
    row = SimpleNamespace(unbonded_links={0: 1})  # it has one contact
    run = SimpleNamespace(rtol=1e-3, row=row, estimates=estimates)

    sentence = _accuracy_sentence(run)

    assert sentence == stated + warning


def test_a_refined_mesh_meets_the_exact_restitution_to_rtol(monkeypatch):
    """The first mesh, of 20 cells, has an error of 0.0107."""
    pair = [unit_rod(0.7, velocity=1.0), unit_rod(1.1, area=0.5)]
    exact = ri.collide(*pair)
    monkeypatch.setattr(finite_difference, "MIN_LONGEST_CELLS", 20)

    solution = solve_row(pair, rtol=1e-2)

    restitution = solution.outcome.restitution
    assert restitution == pytest.approx(exact.restitution, abs=1e-2)


def test_what_has_not_converged_says_so_after_the_stated_errors(monkeypatch):
    """The mesh may grow from 20 to 40 cells only, with which nothing converges to 1e-9:
    the status lists the stated errors, then "Not converged" with advice.
    """
    pair = [unit_rod(0.7, velocity=1.0), unit_rod(1.1, area=0.5)]
    monkeypatch.setattr(finite_difference, "MIN_LONGEST_CELLS", 20)
    monkeypatch.setattr(finite_difference, "MAX_REFINED_CELLS", 40)

    solution = solve_row(pair, rtol=1e-9)

    errors = [f"{name} {error:.1g}" for name, error in solution.accuracy.items()]
    _, sentences = solution.status.split(" Stated relative error: ")
    stated, warning = sentences.split(". Not converged to ")
    assert stated == ", ".join(errors)
    assert warning.startswith("1e-09. Take a larger rtol, or give more cells.")


VIBRATING = ri.Steps([1.0, 1.45], at=[0.736])
STATED_ERRORS = {
    "impulse": "impulse",
    "peak_force": "peak force",
    "duration": "duration",
}
"""Names of stated errors by the fields of the outcome of a contact."""


@pytest.mark.parametrize(
    ("rods", "until"),  # each rod by its length, area and velocity
    [
        ([(1.326, 2.49, 1.0), (0.393, 2.86, -0.29)], 5.6),
        ([(0.581, 2.72, 1.0), (1.231, 2.44, 0.21)], 5.6),
        ([(1.325, 2.58, VIBRATING), (1.08, 1.47, 0.03)], 3.6),
        pytest.param(
            [(0.9, 1.0, 1.0), (0.7, 2.0, 0.2), (1.1, 0.6, 0.0)],
            4.0,
            marks=pytest.mark.exhaustive,
        ),
        ([(0.5, 0.786, 0.674), (0.1875, 1.176, -0.255)], None),
        ([(0.125, 0.883, 0.740), (0.4375, 0.456, 0.577)], None),
    ],
)
def test_stated_errors_bound_those_of_the_outcome(rods, until):
    """Rods are solved on a grid and by fronts: velocities differ by the stated error
    times the velocity scale at most, and impulses, peak forces and durations by theirs
    times the largest of them.
    """
    bodies = []
    for length, area, velocity in rods:
        bodies.append(unit_rod(length, area=area, velocity=velocity))
    system = ri.System(bodies)
    exact = ri.solve(system, until=until).outcome
    solution = ri.solve(system, until=until, method=METHOD, snapshots=2)

    assert "Not converged" not in solution.status
    outcome = solution.outcome
    scale = solution.fields.clock.scale
    velocity_error = largest_error(outcome.velocities_after, exact.velocities_after)
    assert velocity_error / scale <= solution.accuracy["velocity"]
    for field, name in STATED_ERRORS.items():
        values = [getattr(contact, field) for contact in outcome.contacts]
        exact_values = [getattr(contact, field) for contact in exact.contacts]
        relative_error = largest_error(values, exact_values) / max(exact_values)
        assert relative_error <= solution.accuracy[name], name


def test_velocities_that_are_round_off_need_no_refinement(monkeypatch):
    """A rod that is squeezed from both sides stays where it is, and one whose halves
    move at 1 and -1 m/s vibrates about its place.
    """
    monkeypatch.setattr(finite_difference, "MIN_LONGEST_CELLS", 10)
    rod_between_walls = [ri.Wall(0.5), unit_rod(), ri.Wall(-0.5)]
    opposite_halves = ri.Steps([1.0, -1.0], at=[0.5])

    squeezed = solve_row(rod_between_walls, until=0.4, rtol=1e-2)
    vibrating = solve_row([unit_rod(velocity=opposite_halves)])

    assert "Not converged" not in squeezed.status
    # Errors are estimated from the fourth level on, which has four times the cells.
    cells = sum(vibrating.fields.motion.counts)
    assert cells == 4 * 10


def solve_with_snapshots(snapshots, until=3.0):
    """A rod with a wave that strikes another through a spring.

    `snapshots` is a number of states, or a list of times, s; if None, all are kept.
    """
    bodies = [unit_rod(velocity=WAVE), unit_rod(0.7)]
    laws = [ri.Spring(2.0)]
    return solve_row(bodies, until=until, cells=40, contacts=laws, snapshots=snapshots)


@pytest.fixture(scope="module")
def with_all_states():
    """A run that keeps the states of all steps."""
    return solve_with_snapshots(snapshots=None)


def test_a_number_of_snapshots_is_kept_and_changes_no_outcome(with_all_states):
    """With snapshots=10 between 4 and 12 states are kept; impulse and velocities are
    those of a run with all states.
    """
    solution = solve_with_snapshots(10)

    n_states = len(solution.fields.motion.when)
    assert 4 <= n_states <= 10 + 2  # with start and end
    assert solution.outcome.impulse == with_all_states.outcome.impulse
    velocities = solution.outcome.velocities_after
    expected = with_all_states.outcome.velocities_after
    assert velocities == pytest.approx(expected, abs=1e-14)


def test_fields_at_times_of_snapshots_are_those_with_all_states(with_all_states):
    """A run with three snapshots keeps few states; at these times, velocities and
    strains are those of a run with all states, bit for bit, and the energy balances.
    """
    times = np.array([0.31, 1.234567, 2.9])
    x = np.linspace(0, 1, 23)[:, None]

    solution = solve_with_snapshots(times)

    n_states = len(solution.fields.motion.when)
    assert n_states <= 2 * 3 + 2  # two about each time, the start and the end
    velocity = solution.velocity(0, x, times)
    assert np.array_equal(velocity, with_all_states.velocity(0, x, times))
    strain = solution.strain(0, x, times)
    assert np.array_equal(strain, with_all_states.strain(0, x, times))
    residual = solution.energy(times).residual
    assert np.abs(residual).max() <= 1e-13


def test_snapshots_beyond_the_end_are_taken_at_the_end():
    solution = solve_with_snapshots([0.5, 1e9], until=None)

    last_kept_step = solution.fields.motion.when.max()
    assert last_kept_step == solution.fields.end // STEP_TICKS


@pytest.mark.parametrize("steps_later", [0.0, 0.5], ids=["kept", "between"])
def test_errors_of_fields_at_chosen_times_are_of_order_two(steps_later):
    """Velocity and strain of the mode v = cos(pi x) cos(pi t) are compared at times of
    states, or half a step later, on meshes of 20, 40 and 80 cells.
    """
    x = np.linspace(0.06, 0.94, 21)[:, None]
    cosine = np.cos(math.pi * x)
    sine = np.sin(math.pi * x)
    rod = unit_rod(velocity=lambda x: np.cos(math.pi * x))
    until = 60 * COURANT / 20  # whole steps of each of the meshes
    chosen_times = np.array([0.377, 1.411, 2.9])

    velocity_errors = []
    strain_errors = []
    for cells in (20, 40, 80):
        step = COURANT / cells
        nearest_steps = np.rint(chosen_times / step)
        t = (nearest_steps + steps_later) * step
        solution = solve_row([rod], until=until, cells=cells, snapshots=t)
        velocity = cosine * np.cos(math.pi * t)
        strain = -sine * np.sin(math.pi * t)  # its rate is the slope of the velocity
        velocity_errors.append(largest_error(solution.velocity(0, x, t), velocity))
        strain_errors.append(largest_error(solution.strain(0, x, t), strain))

    assert order(velocity_errors) >= 1.8
    assert order(strain_errors) >= 1.8
    *_, finest_velocity_error = velocity_errors
    *_, finest_strain_error = strain_errors
    assert finest_velocity_error <= 1e-3
    assert finest_strain_error <= 1e-3


# Finality
# --------------------------------------------------------------------------------------


def solutions_proved_final(seeds):
    """Yield seed and solution of each random row that has an episode of contact and is
    proved final. Rows of a single body are left out.
    """
    for seed in seeds:
        system = random_row(seed, bodies=3)
        if len(system.bodies) < 2:  # `bodies` is the largest number
            continue
        solution = ri.solve(
            system, method=METHOD, dt=1 / 32, max_events=1500, snapshots=2
        )
        contacts = solution.outcome.contacts
        collided = any(contact.episodes for contact in contacts)
        if solution.final and collided:
            yield seed, solution


@pytest.mark.parametrize("seeds", few_of([range(12), range(36)], [range(12)]))
def test_what_is_proved_final_has_no_further_contact_for_20_times_as_long(seeds):
    """Random rows are run 20 times as long: contacts have no more episodes, and no
    touch after the proof.
    """
    n_proved = 0
    for seed, solution in solutions_proved_final(seeds):
        n_proved += 1
        end = 20 * solution.t_end
        longer = ri.solve(
            solution.system, until=end, method=METHOD, dt=1 / 32, snapshots=2
        )
        assert longer.final
        contacts = solution.outcome.contacts
        longer_contacts = longer.outcome.contacts
        for contact, longer_contact in zip(contacts, longer_contacts, strict=True):
            assert longer_contact.episodes == contact.episodes, seed
            if not math.isnan(contact.last):  # if it has touched at all
                assert longer_contact.last <= solution.t_proved + 1e-9, seed
    assert n_proved >= len(seeds) / 6  # so that the claim is not empty


# Odd input
# --------------------------------------------------------------------------------------


def test_rods_of_one_cell_collide_and_have_fields():
    """The collision is final with a restitution between 0 and 1; velocity and strain
    have the right shapes.
    """
    solution = solve_row([unit_rod(velocity=1.0), unit_rod()], cells=1)

    assert solution.fields.motion.counts == [1, 1]
    assert solution.final
    assert 0 < solution.outcome.restitution < 1
    x = [0.0, 0.5, 1.0]
    end = solution.t_end
    times = [[0.0], [0.7], [end]]
    assert solution.velocity(0, x, times).shape == (3, 3)
    assert solution.strain(0, x, end).shape == (3,)


def test_one_cell_between_fixed_ends_does_not_move():
    """Both nodes of the only cell are held, whatever the velocity at the start."""
    rod = unit_rod(velocity=1.0)
    ends = (ri.Fixed(), ri.Fixed())

    solution = solve_row([rod], until=2.0, cells=1, ends=ends)

    times = np.linspace(0, 2, 9)
    velocity = solution.velocity(0, 0.5, times)  # of the middle
    assert not np.any(velocity)


LOVE = {"lateral_inertia": "rayleigh-love"}


@pytest.mark.parametrize(
    ("viscosity", "theory"),
    [
        pytest.param(1e7, {}, id="much viscosity"),
        pytest.param(0.0, {"polar_moment": 1e7, **LOVE}, id="much lateral inertia"),
        pytest.param(1e-300, {}, id="little viscosity"),
    ],
)
def test_extreme_viscosity_and_lateral_inertia_keep_the_balances(viscosity, theory):
    """A viscous rod with this lateral inertia strikes another: momentum and energy
    balance to 1e-8.
    """
    lossy = material(poisson_ratio=0.3, viscosity=viscosity)
    rod = ri.Rod(1.0, area=1.0, material=lossy, velocity=1.0, **theory)

    solution = solve_row([rod, unit_rod(2.0)], until=81 * STEP, cells=40)

    outcome = solution.outcome
    assert abs(outcome.momentum_residual) <= 1e-8
    assert abs(outcome.energy_residual) <= 1e-8


# The start of a contact
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("velocity", [-0.05, 0.05])
def test_compressed_ends_that_touch_while_they_part_or_meet_gain_no_energy(velocity):
    """Two rods are pressed together by their strain, while they move apart or towards
    each other. On a grid the energy never grows, the gap is never negative, and the
    impulse is that of fronts to 2 %.
    """
    left_rod = unit_rod(velocity=velocity, strain=-0.2)
    right_rod = unit_rod(0.8, strain=-0.2)
    system = ri.System([left_rod, right_rod])
    exact = ri.solve(system, until=1.5, method="fronts").outcome

    solution = ri.solve(system, until=1.5, method=METHOD, cells=100)

    times = times_of_states(solution)
    total_energy = solution.energy(times).total
    assert np.diff(total_energy).max() <= 1e-13
    impulse = solution.outcome.impulse
    assert impulse == pytest.approx(exact.impulse, rel=0.02)
    assert gaps_of(solution, 0).min() == 0.0


@pytest.mark.parametrize("strain", [0.0, 0.3])
def test_ends_that_approach_at_the_start_have_no_negative_gap(strain):
    """Stretched rods contract, so that they part at once and have no episode."""
    bodies = [unit_rod(velocity=0.1, strain=strain), unit_rod(strain=strain)]

    solution = solve_row(bodies, until=1.0, cells=50)

    gap = gaps_of(solution, 0)
    assert gap.min() == 0.0
    if strain > 0:
        (contact,) = solution.outcome.contacts
        assert contact.episodes == 0
        assert np.all(gap[1:40] > 0)  # after each of the first steps


@pytest.mark.exhaustive
def test_a_peak_that_grows_with_the_mesh_is_named(monkeypatch):
    """Flat ends of viscous rods meet with a force that has no largest value."""
    monkeypatch.setattr(finite_difference, "MIN_LONGEST_CELLS", 16)
    lossy = ri.materials.steel.damped(0.02, 1e3)
    bodies = [
        ri.Rod(0.4, area=1e-4, material=lossy, velocity=1.0),
        ri.Rod(1.0, area=1e-4, material=lossy),
    ]
    flat_ends = ri.System(bodies)
    ends_with_spring = ri.System(bodies, contacts=[ri.Spring(1e6)])

    flat = ri.solve(flat_ends, rtol=0.05)
    soft = ri.solve(ends_with_spring, rtol=0.05)

    assert flat.accuracy["peak force"] == math.inf
    sentence = "The peak force is that of this mesh: flat ends meet, and a finer"
    assert sentence in flat.status
    assert "The peak force is that" not in soft.status


def peak_force_of(solution):
    """The largest force of all contacts, N."""
    contacts = solution.outcome.contacts
    return max(contact.peak_force for contact in contacts)


@pytest.mark.exhaustive
@pytest.mark.parametrize("cells", [100, 200])
def test_a_peak_that_overshoots_by_a_percent_is_named(cells):
    """The status says by how much the largest force is beyond that of fronts, or by
    more: it names three quarters of the overshoot at least.
    """
    sentence = "The peak force is that of this mesh: waves overshoot beside jumps"
    first_segment = segment(1, 1, 0.15 * math.sqrt(2))
    second_segment = segment(2.5, 1, 0.3)
    stepped = ri.Rod(segments=[first_segment, second_segment], velocity=1.0)

    overshoots = []  # over the exact force, relative
    for area in (0.5, 1.0, 2.0):
        last_rod = unit_rod(0.7, area=area)
        system = ri.System([stepped, last_rod, ri.Wall()])
        exact = ri.solve(system, until=3.0, method="fronts")
        solution = ri.solve(system, until=3.0, method=METHOD, cells=cells)
        overshoot = peak_force_of(solution) / peak_force_of(exact) - 1
        overshoots.append(overshoot)
        is_named = sentence in solution.status
        assert is_named == (overshoot > 0.01)
        if overshoot > 0.02:
            _, after = solution.status.split("lower by ")
            percent = float(after.split()[0])
            assert percent / 100 >= 0.75 * overshoot
    assert max(overshoots) > 0.02  # so that a percentage was read


@pytest.mark.parametrize(
    ("closing", "episodes"), [(2.0**-39, 0), (2.0**-39 + 2.0**-52, 1)]
)
def test_ends_that_close_by_no_more_than_the_tolerance_only_graze(closing, episodes):
    """A contact takes away half of the closing velocity of touching ends. The tolerance
    is 2^-40 of the velocity scale, 1 m/s: that of a third rod, which is far away.
    """
    bodies = [unit_rod(velocity=closing), unit_rod(), unit_rod(velocity=1.0)]

    solution = solve_row(bodies, until=0.25, dt=1 / 32, gaps=[0.0, 1.0])

    assert solution.outcome.contacts[0].episodes == episodes


@pytest.mark.parametrize("end", [ri.Fixed(), ri.Moved(0.5)])
def test_a_rod_that_hangs_keeps_its_velocity_from_the_first_step_on(end):
    """A rod under its own weight keeps the velocity of the end that holds it, 0 or 0.5
    m/s. This end falls behind the frame, which falls freely, in the first half step as
    in all others.
    """
    cells = 20
    gravity = 0.1
    nodes = np.arange(cells + 1) / cells  # ends of the cells, m
    middles = (nodes[1:] + nodes[:-1]) / 2
    below = 1.0 - middles  # length that hangs from each cell, m
    strain = gravity * below  # of a rod of unit stiffness and density
    velocity = 0.0
    if isinstance(end, ri.Moved):
        velocity = 0.5  # that of the end
    steps_of_strain = ri.Steps(strain, at=nodes[1:-1])  # constant in each cell
    rod = unit_rod(velocity=velocity, strain=steps_of_strain)
    ends = (end, ri.Free())

    solution = solve_row([rod], until=1.0, cells=cells, ends=ends, gravity=gravity)

    velocities = solution.velocity(0, nodes[:, None], [0.0, 0.3, 1.0])
    assert largest_error(velocities, velocity) < 1e-12
