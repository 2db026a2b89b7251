"""Fields from states on a grid: what they say at places and times."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import STEP_TICKS
from rodimpact.results.grid_velocities import _means_over_two_steps

METHOD = "finite-difference"
THICK = ri.Material(
    "thick", youngs_modulus=2.0, density=0.5, viscosity=0.02, poisson_ratio=0.3
)
CONE = ri.Segment(
    0.5,
    ri.Samples([1.0, 0.5]),
    THICK,
    polar_moment="circular",
    lateral_inertia="rayleigh-love",
)
CONE_AND_BAR = ri.Rod(
    segments=[CONE, ri.Segment(0.75, 0.5, UNIT)],
    velocity=ri.Samples([0.0, -0.2, 0.3]),
)
BODIES = [
    unit_rod(1.0, 2.0, velocity=0.5),
    ri.RigidMass(0.5, velocity=-0.25),
    CONE_AND_BAR,
    ri.RigidMass(1.5, velocity=-1.0),
    ri.RigidMass(0.3),
    unit_rod(0.5, velocity=0.1),
]
LAWS = [
    ri.Hertz(20.0),
    ri.Rigid(),
    ri.HuntCrossley(10.0, 0.3),
    ri.Rigid(restitution=0.5),
    ri.Bonded(),
]
ROW = ri.System(
    BODIES,
    [0.1, 0.05, 0.0, 0.1, 0.0],
    LAWS,
    gravity=-0.4,
    ends=(ri.Moved(ri.Samples([0.5, 1.0, -0.5], step=1.0)), ri.Pushed(0.2)),
)
"""All that a grid can carry: a damped, tapered and stepped body, and two driven ends.
"""


@pytest.fixture(scope="module")
def row_solution():
    """The solution of `ROW` on a grid, until 3 s."""
    return ri.solve(ROW, 3.0, METHOD, cells=64)


@pytest.fixture(scope="module")
def mirrored_solution():
    """The solution of the mirrored `ROW` on a grid, until 3 s."""
    return ri.solve(ROW.mirrored(), 3.0, METHOD, cells=64)


def time_step(solution):
    """Time step, s."""
    return solution.fields.clock.tick * STEP_TICKS


def times_of_states(solution):
    """Times of the states that a solution keeps, s [state]: here of every step."""
    times = solution.fields.motion.when * time_step(solution)
    return times[times <= solution.t_end]


# At the start
# --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def linear_solution():
    """The solution of a rod of 2 m with 20 cells, v = x/2 and strain = 0.3 - 0.1 x at
    the start.
    """
    velocity = ri.Samples([0.0, 1.0])
    strain = ri.Samples([0.3, 0.1])
    rod = unit_rod(2.0, velocity=velocity, strain=strain)
    return ri.solve(ri.System([rod]), 0.999, METHOD, cells=20)


def test_a_linear_velocity_is_met_exactly_inside(linear_solution):
    """The nodes at the ends hold means over the half cells beside them."""
    x = np.linspace(0.1, 1.9, 37)
    velocity = linear_solution.velocity(0, x, 0.0)
    expected = x / 2
    assert velocity == pytest.approx(expected, abs=1e-14)
    at_ends = linear_solution.velocity(0, [0.0, 2.0], 0.0)
    middles = np.array([0.025, 1.975])  # of the half cells, of 0.05 m
    expected_at_ends = middles / 2
    assert at_ends == pytest.approx(expected_at_ends, abs=1e-14)


def test_a_linear_strain_is_met_exactly_inside(linear_solution):
    """The end cells have begun to give way: free ends hold no strain."""
    x = np.linspace(0.15, 1.85, 35)
    strain = linear_solution.strain(0, x, 0.0)
    expected = 0.3 - 0.1 * x
    assert strain == pytest.approx(expected, abs=1e-14)
    stress = linear_solution.stress(0, x, 0.0)
    assert np.array_equal(stress, strain)  # E = 1
    at_ends = linear_solution.strain(0, [0.0, 2.0], 0.0)
    assert at_ends == pytest.approx([0.0, 0.0], abs=1e-14)

    # A step is almost the time of the wave through a cell: by a half of it the strain
    # of the cell has almost fallen to half.
    assert time_step(linear_solution) == pytest.approx(0.0999)
    middle_of_cell = 0.05
    in_first_cell = float(linear_solution.strain(0, middle_of_cell, 0.0))
    given_strain = 0.3 - 0.1 * middle_of_cell
    half_of_it = given_strain / 2
    assert in_first_cell == pytest.approx(half_of_it, abs=3e-3)


def test_a_linear_strain_lengthens_a_rod_by_its_mean(linear_solution):
    """At the start, the displacements at 0.1 m and 1.9 m of a rod with a linear strain
    differ by the mean strain times the distance.
    """
    left, right = linear_solution.displacement(0, [0.1, 1.9], 0.0)
    lengthening = right - left
    mean_strain = 0.3 - 0.1 * 1.0  # 0.3 - 0.1 x in the middle, at x = 1 m
    expected = mean_strain * (1.9 - 0.1)
    assert lengthening == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("share", few_of([0.02, 0.3, 0.48, 0.7], [0.3]))
@pytest.mark.parametrize(
    ("field", "sign"),
    [("velocity", -1), ("displacement", -1), ("stress", 1), ("strain", 1)],
)
def test_fields_of_the_mirrored_row_are_those_of_the_row(
    row_solution, mirrored_solution, share, field, sign
):
    """Also within half a cell of either end of a rod, where its end has values of its
    own. Places are odd and even multiples of a `share` of 1/32 of the length.
    """
    times = np.linspace(0.2, 3.0, 9)
    last = len(ROW.bodies) - 1
    multiples = np.array([1.0, 3.0, 20.0])[:, np.newaxis]  # [position, 1]
    values_at = getattr(row_solution, field)
    mirrored_values_at = getattr(mirrored_solution, field)
    for body in (0, 2, 5):  # the rods
        length = ROW.bodies[body].length
        near_left = length * share / 32 * multiples
        near_right = length - near_left
        for x in (near_left, near_right):
            values = values_at(body, x, times)
            mirrored = mirrored_values_at(last - body, length - x, times)
            expected = sign * values
            assert mirrored == pytest.approx(expected, rel=1e-8, abs=1e-8)


# At the ends
# --------------------------------------------------------------------------------------


def orders(errors):
    """Orders of convergence from mesh to mesh of errors [mesh, place].

    Each mesh has twice the cells of the one before.
    """
    coarse = np.array(errors[:-1])
    fine = np.array(errors[1:])
    return np.log2(coarse / fine)


def mode(x):
    """Initial velocity of a rod of 1 m between held ends."""
    return math.sin(math.pi * x)


def largest(differences):
    """Largest magnitude."""
    return np.abs(differences).max()


def damped_mode(viscosity, t):
    """Velocity in the middle of the mode u(t) sin(pi x), and strain at its left end.

    Its amplitude obeys u'' + viscosity w^2 u' + w^2 u = 0, with u = 0 and u' = 1 at
    first, w = pi.
    """
    w = math.pi
    # The amplitude is a sum of exp(s1 t) and exp(s2 t).
    polynomial = [1.0, viscosity * w * w, w * w]
    s1, s2 = np.roots(polynomial).astype(complex)
    decay_1 = np.exp(s1 * t)
    decay_2 = np.exp(s2 * t)
    u = (decay_1 - decay_2) / (s1 - s2)
    velocity = (s1 * decay_1 - s2 * decay_2) / (s1 - s2)
    strain = w * u
    return velocity.real, strain.real


@pytest.mark.parametrize("viscosity", [0.0, 0.04, 4.0])
def test_errors_of_a_damped_mode_between_held_ends_are_of_order_two(viscosity):
    """A viscous rod between fixed ends vibrates in its first mode. Stress at both ends,
    strain and velocity differ from the exact mode with order 1.7 at least between 40
    and 80 cells, by 2e-3 at most.
    """
    t = np.linspace(0.2, 2.4, 23)
    velocity, strain = damped_mode(viscosity, t)
    # The velocity is sin(pi x) times that in the middle: at x = 0 the strain rate is pi
    # times that in the middle; at x = 1 strain and stress have the opposite sign.
    stress = strain + viscosity * math.pi * velocity
    lossy = UNIT.replace(viscosity=viscosity)
    rod = ri.Rod(1.0, area=2.0, velocity=mode, material=lossy)
    held_ends = (ri.Fixed(), ri.Fixed())
    system = ri.System([rod], ends=held_ends)

    errors = []
    for cells in (20, 40, 80):
        solution = ri.solve(system, 2.5, METHOD, cells=cells)
        left_stress = solution.stress(0, 0.0, t)
        right_stress = solution.stress(0, 1.0, t)
        left_strain = solution.strain(0, 0.0, t)
        middle_velocity = solution.velocity(0, 0.5, t)
        errors_of_mesh = [
            largest(left_stress - stress),
            largest(right_stress + stress),
            largest(left_strain - strain),
            largest(middle_velocity - velocity),
        ]
        errors.append(errors_of_mesh)

    *_, orders_of_finest = orders(errors)  # each [mesh, error]
    assert orders_of_finest.min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_a_damped_rod_shows_the_contact_force_at_its_end():
    """Two viscous rods collide on a grid: the axial force at both touching ends is the
    negative contact force, as a mean of two steps.
    """
    lossy = UNIT.replace(viscosity=0.02)
    striker = ri.Rod(0.7, area=1, material=lossy, velocity=1)
    struck = ri.Rod(1.1, area=2, material=lossy)
    system = ri.System([striker, struck])

    solution = ri.solve(system, 3.0, METHOD, cells=60)

    means = solution.contacts[0].push.values  # of the force, N [step]
    edges = np.arange(1, len(means)) * time_step(solution)  # between two steps, s
    force = (means[1:] + means[:-1]) / 2  # at the edges
    near = 1e-6  # N, by which a time that is rounded to ticks changes the force
    in_striker = solution.axial_force(0, 0.7, edges)
    in_struck = solution.axial_force(1, 0.0, edges)
    assert in_striker == pytest.approx(-force, abs=near)
    assert in_struck == pytest.approx(-force, abs=near)


JUMP = 0.6  # place where the area of the rod of `masses_and_stepped_rod` doubles, m


def masses_and_stepped_rod():
    """A mass that strikes a rod through a Hertz contact, and a mass behind it that is
    bonded to it.
    """
    thin = ri.Segment(JUMP, 1.0, UNIT)
    thick = ri.Segment(0.5, 2.0, UNIT)
    rod = ri.Rod(segments=[thin, thick])
    bodies = [ri.RigidMass(0.5, velocity=1.0), rod, ri.RigidMass(0.7)]
    return ri.System(bodies, [0.1, 0.0], [ri.Hertz(5.0), ri.Bonded()])


@pytest.fixture(scope="module")
def meshes_of_stepped_rod():
    """Solutions of `masses_and_stepped_rod` on three meshes, each with twice the cells
    of the one before.
    """
    system = masses_and_stepped_rod()
    return [ri.solve(system, 2.5, METHOD, cells=cells) for cells in (20, 40, 80)]


TIMES_OF_WAVES = np.linspace(0.6, 2.4, 41)
"""Times at which waves run in this rod, s."""


def test_errors_of_strains_beside_contacts_jumps_of_area_and_masses_are_of_order_two(
    meshes_of_stepped_rod,
):
    """The reference is characteristics. Errors are means over times."""
    beside_mass = 1.1  # right end of the rod, m
    before_jump = JUMP - 1e-9
    positions = (0.0, 0.005, before_jump, JUMP, JUMP + 0.005, beside_mass)
    t = TIMES_OF_WAVES
    exact = ri.solve(masses_and_stepped_rod(), 2.5, "characteristics")

    errors = []  # [mesh, position]
    for solution in meshes_of_stepped_rod:
        errors_of_mesh = []
        for x in positions:
            strain = solution.strain(1, x, t)
            exact_strain = exact.strain(1, x, t)
            mean_error = np.abs(strain - exact_strain).mean()
            errors_of_mesh.append(mean_error)
        errors.append(errors_of_mesh)

    mean_orders = orders(errors).mean(axis=0)  # [position]
    assert mean_orders.min() >= 1.7
    assert max(errors[-1]) <= 2e-4


def test_the_axial_force_does_not_jump_with_the_area(meshes_of_stepped_rod):
    """On every mesh, the forces just before a jump of the area and at it are equal."""
    for solution in meshes_of_stepped_rod:
        before = solution.axial_force(1, JUMP - 1e-12, TIMES_OF_WAVES)
        behind = solution.axial_force(1, JUMP, TIMES_OF_WAVES)
        assert before == pytest.approx(behind, abs=1e-9)


def test_errors_of_forces_at_driven_and_absorbing_ends_are_of_order_two():
    """A rod is pushed at its left end and absorbs at its right one. The axial forces
    there are the push, and the push 1 s later, with order 1.7 at least; times near the
    wave front are left out at the right.
    """

    def push(t):
        return 0.3 * np.sin(2 * t)

    ends = (ri.Pushed(push, duration=3.0), ri.Absorbing())
    system = ri.System([unit_rod(area=2.0)], ends=ends)
    t = np.linspace(0.1, 2.9, 57)
    smooth = np.abs(t - 1) > 0.3  # away from the kink of the wave front

    errors = []
    for cells in (20, 40, 80):
        solution = ri.solve(system, 3.0, METHOD, cells=cells)
        # A push is a compression, and an axial force a tension: their sum is the error.
        force_at_driven = solution.axial_force(0, 0.0, t)
        error_at_driven = force_at_driven + push(t)
        # The wave takes 1 s to the absorbing end.
        arrived = push(t - 1) * (t > 1)
        force_at_absorbing = solution.axial_force(0, 1.0, t)
        error_at_absorbing = force_at_absorbing + arrived
        error_away_from_kink = error_at_absorbing[smooth]
        errors.append([largest(error_at_driven), largest(error_away_from_kink)])

    assert orders(errors).min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_stress_of_damped_material_includes_that_of_its_strain_rate():
    """A viscous rod without strain is stretched at 0.4/s: its stress is viscosity times
    this rate, and its axial force this times the area.
    """
    strain_rate = 0.4  # 1/s
    area = 3.0

    def velocity(x):
        return strain_rate * x

    rod = ri.Rod(1.0, area=area, material=THICK, velocity=velocity)
    solution = ri.solve(ri.System([rod]), 0.5, METHOD, cells=10)
    x = np.array([0.3, 0.5, 0.6])

    stress = solution.stress(0, x, 0.0)
    force = solution.axial_force(0, x, 0.0)

    expected_stress = THICK.viscosity * strain_rate  # there is no strain yet
    expected_force = area * expected_stress
    assert stress == pytest.approx(expected_stress, rel=1e-12)
    assert force == pytest.approx(expected_force, rel=1e-12)


# Fields agree with each other
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "x"), [(0, 0.0), (0, 0.3125), (0, 1.0), (2, 0.8125), (5, 0.5)]
)
def test_displacement_is_the_integral_of_velocity(row_solution, body, x):
    """A node moves half of a step with the velocity before the change and half with
    that after it: by their mean.
    """
    times = times_of_states(row_solution)
    displacement = row_solution.displacement(body, x, times)
    velocity = row_solution.velocity(body, x, times)
    rate = np.diff(displacement) / np.diff(times)
    mean = (velocity[1:] + velocity[:-1]) / 2
    assert rate == pytest.approx(mean, abs=1e-11)


@pytest.mark.parametrize("x", [0.0, 0.25])
def test_velocities_of_damped_rods_are_means_over_the_steps_before_and_after(
    row_solution, x
):
    """At x of a damped rod, the velocity at a state is the change of displacement over
    the two steps around it; the first and last states are left out.
    """
    damped_rod = 2  # index of the body
    times = times_of_states(row_solution)
    displacement = row_solution.displacement(damped_rod, x, times)
    velocity = row_solution.velocity(damped_rod, x, times)
    # At states 3 to -2: the first and the last ones have no such step on one side.
    change = displacement[4:] - displacement[2:-2]
    duration = times[4:] - times[2:-2]
    rate = change / duration
    inner_velocity = velocity[3:-1]
    assert rate == pytest.approx(inner_velocity, abs=1e-11)


@pytest.mark.parametrize(
    ("contact", "length", "bound"),
    [
        (0, 1.0, 1e-12),
        (1, 0.0, 2e-2),
        (2, 1.25, 1e-12),
        (3, 0.0, 2e-2),
        (4, 0.0, 1e-12),
    ],
)
def test_gap_is_the_distance_of_the_ends(row_solution, contact, length, bound):
    """At all states of a row on a grid, the gap of this contact is the distance of the
    two ends, to `bound`, m: the motion of one step at rigid contacts. `length` is that
    of the body on the left, 0 for a mass.
    """
    times = times_of_states(row_solution)
    gap = row_solution.contacts[contact].gap(times)
    left = row_solution.position(
        contact, length, times
    )  # bodies are numbered as contacts
    right = row_solution.position(contact + 1, 0.0, times)
    distance = right - left
    assert gap == pytest.approx(distance, abs=bound)


def test_energies_balance_and_strain_energy_is_the_integral_over_the_cells(
    row_solution,
):
    """The energies of a row on a grid balance to 1e-12, and the strain energy of its
    first rod is the integral of its strains in the middles of the cells.
    """
    times = times_of_states(row_solution)[::16]  # every 16th, to save time
    energy = row_solution.energy(times)
    assert largest(energy.residual) <= 1e-12
    x = (np.arange(64) + 0.5) / 64  # middles of the cells of body 0, of 1 m
    area = 2.0  # of body 0; E = 1
    for time in times:
        tick = int(row_solution.fields.to_ticks(time))
        _, strain_energy, *_ = row_solution.fields.energy(0, tick, 0.0)
        strain = row_solution.strain(0, x, time)
        integral = np.mean(strain**2)  # over 1 m
        expected = area / 2 * integral
        assert strain_energy == pytest.approx(expected, rel=1e-11)


def test_the_kinetic_energy_of_a_rod_at_the_start_is_that_of_its_velocity(row_solution):
    body = 5
    kinetic_energy, *_ = row_solution.fields.energy(body, 0, 0.0)
    mass = 0.5  # of 0.5 m, area and density 1
    velocity = 0.1
    expected = mass * velocity**2 / 2
    assert kinetic_energy == pytest.approx(expected, rel=0.05)


FIELDS = ["velocity", "strain", "stress", "axial_force", "displacement", "position"]


@pytest.mark.parametrize("field", FIELDS)
def test_places_and_times_broadcast_to_values_of_each_alone(row_solution, field):
    """Values of 7 positions and 5 times are those of 35 single calls."""
    x = np.linspace(0, 1.25, 7)
    times = np.linspace(0, 3, 5)
    values_at = getattr(row_solution, field)

    values = values_at(2, x[:, np.newaxis], times)

    assert values.shape == (7, 5)
    for i, position in enumerate(x.tolist()):
        for j, time in enumerate(times.tolist()):
            alone = values_at(2, position, time)
            assert values[i, j] == alone


@pytest.mark.parametrize("side", ["right", "left"])
def test_velocities_on_a_grid_are_the_same_on_both_sides_of_a_time(row_solution, side):
    """A grid has no jumps: `side` changes nothing."""
    x = np.linspace(0, 1.25, 7)[:, np.newaxis]
    times = np.linspace(0, 3, 5)
    velocity = row_solution.velocity(2, x, times)
    velocity_on_side = row_solution.velocity(2, x, times, side)
    assert np.array_equal(velocity_on_side, velocity)


def test_a_field_at_one_place_and_time_is_a_number(row_solution):
    velocity = row_solution.velocity(0, 0.5, 0.5)
    assert np.shape(velocity) == ()


def test_a_gauge_has_the_fields_at_its_place_and_waves_that_add_to_its_strain():
    """A gauge on a grid records strain and velocity of the solution at its position;
    the changes of its two waves add to that of its strain.
    """
    first_bodies = ROW.bodies[:3]
    system = ri.System(first_bodies, ROW.gaps[:2], ROW.contacts[:2])
    solution = ri.solve(system, 1.5, METHOD, cells=64)

    x = 0.625
    gauge = solution.gauge(2, x)

    before_end = gauge.times <= solution.t_end
    times = gauge.times[before_end]
    strain = solution.strain(2, x, times)
    velocity = solution.velocity(2, x, times)
    recorded_strain = gauge.strain[before_end]
    recorded_velocity = gauge.velocity[before_end]
    assert recorded_strain == pytest.approx(strain, abs=1e-13)
    assert recorded_velocity == pytest.approx(velocity, abs=1e-13)
    waves = gauge.rightward + gauge.leftward
    change = gauge.strain - gauge.strain[0]
    change_of_waves = waves - waves[0]
    assert change == pytest.approx(change_of_waves, abs=1e-13)


def test_averages_between_times_are_those_of_a_free_vibration():
    """Means of velocity and strain between four times, at three positions of a free rod
    that starts with v = cos(pi x), are those of the formula to 2e-3.
    """
    rod = unit_rod(velocity=lambda x: math.cos(math.pi * x))
    solution = ri.solve(ri.System([rod]), 2.0, METHOD, cells=80)
    x = np.array([0.0, 0.25, 0.7])
    t = np.array([0.0, 0.33, 1.1, 2.0])

    velocity, strain = solution.fields.averaged(0, x, t)

    # v = cos(pi x) cos(pi t) and strain = -sin(pi x) sin(pi t)
    w = math.pi
    integral_of_cos = np.diff(np.sin(w * t) / w)
    integral_of_sin = np.diff(-np.cos(w * t) / w)
    mean_of_cos = integral_of_cos / np.diff(t)
    mean_of_sin = integral_of_sin / np.diff(t)
    exact_velocity = np.outer(np.cos(w * x), mean_of_cos)
    exact_strain = -np.outer(np.sin(w * x), mean_of_sin)
    assert velocity == pytest.approx(exact_velocity, abs=2e-3)
    assert strain == pytest.approx(exact_strain, abs=2e-3)


@pytest.mark.parametrize(
    ("t", "is_open"), [(0.5, True), (1.0, False)], ids=["open", "pressed"]
)
def test_a_run_from_a_state_continues_the_whole_run(t, is_open):
    """Mean velocities at the end agree within the error of averages over cells. The
    state is taken at t, while the contact is open or pressed.
    """

    def velocity(x):
        return 0.4 + 0.3 * math.cos(math.pi * x)

    striker = unit_rod(velocity=velocity)
    system = ri.System([striker, unit_rod(0.7)], [0.2], [ri.Spring(4.0)])
    until = 3.0
    rest = until - t  # s, after the state

    errors = []
    for cells in (40, 160):
        whole = ri.solve(system, until, METHOD, cells=cells)
        gap = whole.contacts[0].gap(t)
        assert (gap > 0) == is_open
        state = whole.system_at(t)
        second_part = ri.solve(state, rest, METHOD, cells=cells)
        error = 0.0
        for body in (0, 1):
            mean_velocity = second_part.mean_velocity(body, rest)
            expected = whole.mean_velocity(body, until)
            error = max(error, abs(mean_velocity - expected))
        errors.append(error)

    coarse_error, fine_error = errors
    assert fine_error <= 2e-3
    assert fine_error <= coarse_error


@pytest.mark.parametrize(("body", "kind"), [(1, "a rigid mass"), (2, "a wall")])
@pytest.mark.parametrize("field", ["strain", "stress"])
def test_a_wall_and_a_rigid_mass_on_a_grid_have_no_strain(body, kind, field):
    bodies = [unit_rod(velocity=1.0), ri.RigidMass(0.1), ri.Wall()]
    laws = [ri.Spring(1.0), ri.Spring(1.0)]
    system = ri.System(bodies, [0.0, 1e-3], laws)
    solution = ri.solve(system, 0.1, METHOD, cells=20)
    value_at = getattr(solution, field)
    with pytest.raises(ri.InvalidModel, match=f"{body} is {kind} and has no"):
        value_at(body, 0.0, 0.0)


@pytest.mark.parametrize(
    "steps", [[0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 9], range(5), [0, 1, 2, 3, 4, 9]]
)
def test_no_mean_over_steps_counts_the_velocity_before_a_jump_at_the_start(steps):
    """`steps` are those of the states kept. The velocity is 5 m/s at step 0, then 1
    m/s.
    """
    when = np.array(steps)  # [state]
    velocity_of_states = np.where(when == 0, 5.0, 1.0)  # m/s; it jumps at the start
    velocity = velocity_of_states[:, np.newaxis]  # [state, node]

    means = _means_over_two_steps(velocity, when)

    np.testing.assert_array_equal(means, velocity)
