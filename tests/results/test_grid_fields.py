"""Fields from states on a grid: what they say at places and times."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.grid.mesh import STEP_TICKS

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
"""All that a grid knows: a damped, tapered and stepped body, and two driven ends."""


@pytest.fixture(scope="module")
def row():
    return ri.solve(ROW, 3.0, METHOD, cells=64)


@pytest.fixture(scope="module")
def mirrored_row():
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
def linear():
    """A rod of 2 m with 20 cells, v = x/2 and strain = 0.3 - 0.1 x at the start."""
    velocity = ri.Samples([0.0, 1.0])
    rod = unit_rod(2.0, velocity=velocity, strain=ri.Samples([0.3, 0.1]))
    return ri.solve(ri.System([rod]), 0.999, METHOD, cells=20)


def test_a_linear_velocity_is_met_exactly_inside(linear):
    """The nodes at the ends hold means over the half cells beside them."""
    x = np.linspace(0.1, 1.9, 37)
    assert linear.velocity(0, x, 0.0) == pytest.approx(x / 2, abs=1e-14)
    at_ends = linear.velocity(0, [0.0, 2.0], 0.0)
    # A half cell is 0.05 m: these are x/2 at 0.025 and at 1.975 m.
    assert at_ends == pytest.approx([0.0125, 0.9875], abs=1e-14)


def test_a_linear_strain_is_met_exactly_inside(linear):
    """The end cells have begun to give way: free ends hold no strain."""
    x = np.linspace(0.15, 1.85, 35)
    strain = linear.strain(0, x, 0.0)
    assert strain == pytest.approx(0.3 - 0.1 * x, abs=1e-14)
    assert linear.stress(0, x, 0.0) == pytest.approx(strain, abs=0)
    at_ends = linear.strain(0, [0.0, 2.0], 0.0)
    assert at_ends == pytest.approx([0.0, 0.0], abs=1e-14)
    # The strain in the middle of the first cell, 0.295, has fallen to half.
    in_first_cell = float(linear.strain(0, 0.05, 0.0))
    assert in_first_cell == pytest.approx(0.295 / 2, abs=3e-3)
    assert time_step(linear) == pytest.approx(0.0999)  # almost a cell by its wave


def test_a_linear_strain_lengthens_by_its_mean(linear):
    lengthening = linear.displacement(0, 1.9, 0.0) - linear.displacement(0, 0.1, 0.0)
    mean_strain = 0.2  # 0.3 - 0.1 x in the middle, at x = 1
    assert float(lengthening) == pytest.approx(mean_strain * (1.9 - 0.1), abs=1e-14)


@pytest.mark.parametrize("share", few_of([0.02, 0.3, 0.48, 0.7], [0.3]))
@pytest.mark.parametrize(
    ("field", "sign"),
    [("velocity", -1), ("displacement", -1), ("stress", 1), ("strain", 1)],
)
def test_fields_of_the_mirrored_row_are_those_of_the_row(
    row, mirrored_row, share, field, sign
):
    """Also within half a cell of either end of a rod, where its end has values of its
    own. Places are odd and even multiples of a `share` of 1/32 of the length.
    """
    times = np.linspace(0.2, 3.0, 9)
    last = len(ROW.bodies) - 1
    for body in (0, 2, 5):  # the rods
        length = ROW.bodies[body].length
        near_left = length * share / 32 * np.array([1.0, 3.0, 20.0])[:, None]
        for x in (near_left, length - near_left):  # [place, 1]
            values = getattr(row, field)(body, x, times)
            mirrored = getattr(mirrored_row, field)(last - body, length - x, times)
            assert mirrored == pytest.approx(sign * values, rel=1e-8, abs=1e-8)


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
    s1, s2 = np.roots([1.0, viscosity * w * w, w * w]).astype(complex)
    u = (np.exp(s1 * t) - np.exp(s2 * t)) / (s1 - s2)
    velocity = (s1 * np.exp(s1 * t) - s2 * np.exp(s2 * t)) / (s1 - s2)
    return velocity.real, (w * u).real


@pytest.mark.parametrize("viscosity", [0.0, 0.04, 4.0])
def test_errors_of_a_damped_mode_between_held_ends_are_of_order_two(viscosity):
    t = np.linspace(0.2, 2.4, 23)
    velocity, strain = damped_mode(viscosity, t)
    # The velocity is sin(pi x) times that in the middle: at x = 0 the strain rate is pi
    # times that in the middle; at x = 1 strain and stress have the opposite sign.
    stress = strain + viscosity * math.pi * velocity
    lossy = ri.Material("m", youngs_modulus=1.0, density=1.0, viscosity=viscosity)
    rod = ri.Rod(1.0, area=2.0, velocity=mode, material=lossy)
    system = ri.System([rod], ends=(ri.Fixed(), ri.Fixed()))

    errors = []
    for cells in (20, 40, 80):
        solution = ri.solve(system, 2.5, METHOD, cells=cells)
        errors_of_mesh = [
            largest(solution.stress(0, 0.0, t) - stress),
            largest(solution.stress(0, 1.0, t) + stress),
            largest(solution.strain(0, 0.0, t) - strain),
            largest(solution.velocity(0, 0.5, t) - velocity),
        ]
        errors.append(errors_of_mesh)

    assert orders(errors)[-1].min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_a_damped_rod_shows_the_contact_force_at_its_end():
    lossy = ri.Material("m", youngs_modulus=1.0, density=1.0, viscosity=0.02)
    striker = ri.Rod(0.7, area=1, material=lossy, velocity=1)
    struck = ri.Rod(1.1, area=2, material=lossy)

    solution = ri.solve(ri.System([striker, struck]), 3.0, METHOD, cells=60)

    force = solution.contacts[0].push.values  # means over steps, N [step]
    edges = np.arange(1, len(force)) * time_step(solution)  # between two steps, s
    at_edges = (force[1:] + force[:-1]) / 2
    near = 1e-6  # N, by which a time that is rounded to ticks changes the force
    assert solution.axial_force(0, 0.7, edges) == pytest.approx(-at_edges, abs=near)
    assert solution.axial_force(1, 0.0, edges) == pytest.approx(-at_edges, abs=near)


def test_errors_of_strains_beside_contacts_jumps_of_area_and_masses_are_of_order_two():
    """And the axial force does not jump with the area."""
    jump = 0.6  # place where the area doubles, m
    rod = ri.Rod(segments=[ri.Segment(jump, 1.0, UNIT), ri.Segment(0.5, 2.0, UNIT)])
    bodies = [ri.RigidMass(0.5, velocity=1.0), rod, ri.RigidMass(0.7)]
    system = ri.System(bodies, [0.1, 0.0], [ri.Hertz(5.0), ri.Bonded()])
    t = np.linspace(0.6, 2.4, 41)
    exact = ri.solve(system, 2.5, "characteristics")
    places = (0.0, 0.005, jump - 1e-9, jump, 0.605, 1.1)

    errors = []  # mean over times [mesh, place]
    for cells in (20, 40, 80):
        solution = ri.solve(system, 2.5, METHOD, cells=cells)
        errors_of_mesh = []
        for x in places:
            error = solution.strain(1, x, t) - exact.strain(1, x, t)
            errors_of_mesh.append(np.abs(error).mean())
        errors.append(errors_of_mesh)
        before = solution.axial_force(1, jump - 1e-12, t)
        behind = solution.axial_force(1, jump, t)
        assert before == pytest.approx(behind, abs=1e-9)

    mean_orders = orders(errors).mean(axis=0)  # [place]
    assert mean_orders.min() >= 1.7
    assert max(errors[-1]) <= 2e-4


def test_errors_of_forces_at_driven_and_absorbing_ends_are_of_order_two():
    def push(t):
        return 0.3 * np.sin(2 * t)

    ends = (ri.Pushed(push, duration=3.0), ri.Absorbing())
    system = ri.System([unit_rod(area=2.0)], ends=ends)
    t = np.linspace(0.1, 2.9, 57)
    smooth = np.abs(t - 1) > 0.3  # away from the kink of the wave front

    errors = []
    for cells in (20, 40, 80):
        solution = ri.solve(system, 3.0, METHOD, cells=cells)
        driven = solution.axial_force(0, 0.0, t) + push(t)
        absorbed = solution.axial_force(0, 1.0, t) + push(t - 1) * (t > 1)
        errors.append([largest(driven), largest(absorbed[smooth])])

    assert orders(errors).min() >= 1.7
    assert max(errors[-1]) <= 2e-3


def test_stress_of_damped_material_includes_that_of_its_strain_rate():
    rod = ri.Rod(1.0, area=3.0, material=THICK, velocity=lambda x: 0.4 * x)
    solution = ri.solve(ri.System([rod]), 0.5, METHOD, cells=10)
    x = np.array([0.3, 0.5, 0.6])
    strain_rate = 0.4  # of a velocity of 0.4 x; there is no strain yet
    stress = np.full(3, THICK.viscosity * strain_rate)
    assert solution.stress(0, x, 0.0) == pytest.approx(stress, rel=1e-12)
    assert solution.axial_force(0, x, 0.0) == pytest.approx(3 * stress, rel=1e-12)


# Fields agree with each other
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "x"), [(0, 0.0), (0, 0.3125), (0, 1.0), (2, 0.8125), (5, 0.5)]
)
def test_displacement_is_the_integral_of_velocity(row, body, x):
    """A node moves half of a step with the velocity before the change and half with
    that after it: by their mean.
    """
    times = times_of_states(row)
    velocity = row.velocity(body, x, times)
    rate = np.diff(row.displacement(body, x, times)) / np.diff(times)
    mean = (velocity[1:] + velocity[:-1]) / 2
    assert rate == pytest.approx(mean, abs=1e-11)


@pytest.mark.parametrize("x", [0.0, 0.25])
def test_velocities_of_damped_rods_are_those_over_two_steps(row, x):
    times = times_of_states(row)
    displacement = row.displacement(2, x, times)
    rate = (displacement[4:] - displacement[2:-2]) / (times[4:] - times[2:-2])
    velocity = row.velocity(2, x, times)
    # The first and the last state, beyond which there is no step, are left out.
    assert rate == pytest.approx(velocity[3:-1], abs=1e-11)


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
def test_gap_is_the_distance_of_the_ends(row, contact, length, bound):
    """But for what a grid moves as a rigid contact shuts, of the size of a step.

    `length` is that of the body on the left of the contact, 0 of a mass.
    """
    times = times_of_states(row)
    left = row.position(contact, length, times)  # bodies are numbered as contacts
    right = row.position(contact + 1, 0.0, times)
    assert row.contacts[contact].gap(times) == pytest.approx(right - left, abs=bound)


def test_energies_balance_and_strain_energy_is_the_integral_over_the_cells(row):
    times = times_of_states(row)[::16]
    energy = row.energy(times)
    assert largest(energy.residual) <= 1e-12
    x = (np.arange(64) + 0.5) / 64  # middles of the cells of body 0, of 1 m
    area = 2.0
    for time in times:
        tick = int(row.fields.to_ticks(time))
        _, strain_energy, *_ = row.fields.energy(0, tick, 0.0)
        mean_square = np.mean(row.strain(0, x, time) ** 2)
        # E A/2 times the integral of strain^2, with E = 1 and over 1 m
        assert strain_energy == pytest.approx(area / 2 * mean_square, rel=1e-11)


def test_the_kinetic_energy_of_a_rod_at_the_start_is_that_of_its_velocity(row):
    kinetic_energy, *_ = row.fields.energy(5, 0, 0.0)
    mass = 0.5  # of 0.5 m, area and density 1
    assert kinetic_energy == pytest.approx(mass * 0.1**2 / 2, rel=0.05)


FIELDS = ["velocity", "strain", "stress", "axial_force", "displacement", "position"]


@pytest.mark.parametrize("field", FIELDS)
def test_places_and_times_broadcast_to_values_of_each_alone(row, field):
    x = np.linspace(0, 1.25, 7)
    times = np.linspace(0, 3, 5)
    values = getattr(row, field)(2, x[:, None], times)
    assert values.shape == (7, 5)
    for i in range(7):
        for j in range(5):
            alone = getattr(row, field)(2, float(x[i]), float(times[j]))
            assert values[i, j] == alone


@pytest.mark.parametrize("side", ["right", "left"])
def test_velocities_on_a_grid_are_the_same_on_both_sides_of_a_time(row, side):
    x = np.linspace(0, 1.25, 7)[:, None]
    times = np.linspace(0, 3, 5)
    velocity = row.velocity(2, x, times)
    assert np.array_equal(row.velocity(2, x, times, side), velocity)


def test_a_field_at_one_place_and_time_is_a_number(row):
    assert np.shape(row.velocity(0, 0.5, 0.5)) == ()


def test_a_gauge_has_the_fields_at_its_place_and_waves_that_add_to_its_strain():
    system = ri.System(ROW.bodies[:3], ROW.gaps[:2], ROW.contacts[:2])
    solution = ri.solve(system, 1.5, METHOD, cells=64)

    gauge = solution.gauge(2, 0.625)

    inside = gauge.times <= solution.t_end
    times = gauge.times[inside]
    strain = solution.strain(2, 0.625, times)
    velocity = solution.velocity(2, 0.625, times)
    assert gauge.strain[inside] == pytest.approx(strain, abs=1e-13)
    assert gauge.velocity[inside] == pytest.approx(velocity, abs=1e-13)
    waves = gauge.rightward + gauge.leftward
    change = gauge.strain - gauge.strain[0]
    assert change == pytest.approx(waves - waves[0], abs=1e-13)


def test_averages_between_times_are_those_of_a_free_vibration():
    rod = unit_rod(velocity=lambda x: math.cos(math.pi * x))
    solution = ri.solve(ri.System([rod]), 2.0, METHOD, cells=80)
    x = np.array([0.0, 0.25, 0.7])
    t = np.array([0.0, 0.33, 1.1, 2.0])

    velocity, strain = solution.fields.averaged(0, x, t)

    # v = cos(pi x) cos(pi t) and strain = -sin(pi x) sin(pi t)
    mean_of_cos = np.diff(np.sin(math.pi * t) / math.pi) / np.diff(t)
    mean_of_sin = np.diff(-np.cos(math.pi * t) / math.pi) / np.diff(t)
    exact_velocity = np.outer(np.cos(math.pi * x), mean_of_cos)
    exact_strain = -np.outer(np.sin(math.pi * x), mean_of_sin)
    assert velocity == pytest.approx(exact_velocity, abs=2e-3)
    assert strain == pytest.approx(exact_strain, abs=2e-3)


@pytest.mark.parametrize(
    ("t", "is_open"), [(0.5, True), (1.0, False)], ids=["open", "pressed"]
)
def test_a_state_can_be_continued(t, is_open):
    """To within what averages over cells change."""
    striker = unit_rod(velocity=lambda x: 0.4 + 0.3 * math.cos(math.pi * x))
    system = ri.System([striker, unit_rod(0.7)], [0.2], [ri.Spring(4.0)])

    errors = []
    for cells in (40, 160):
        whole = ri.solve(system, 3.0, METHOD, cells=cells)
        assert (float(whole.contacts[0].gap(t)) > 0) == is_open
        second_part = ri.solve(whole.system_at(t), 3.0 - t, METHOD, cells=cells)
        error = 0.0
        for body in (0, 1):
            velocity = float(second_part.mean_velocity(body, 3.0 - t))
            expected = float(whole.mean_velocity(body, 3.0))
            error = max(error, abs(velocity - expected))
        errors.append(error)

    assert errors[-1] <= 2e-3
    assert errors[-1] <= errors[0]


@pytest.mark.parametrize(("body", "kind"), [(1, "a rigid mass"), (2, "a wall")])
@pytest.mark.parametrize("field", ["strain", "stress"])
def test_a_wall_and_a_rigid_mass_on_a_grid_have_no_strain(body, kind, field):
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    laws = [ri.Spring(1e8), ri.Spring(1e8)]
    system = ri.System([rod, ri.RigidMass(0.1), ri.Wall()], [0.0, 1e-3], laws)
    solution = ri.solve(system, 1e-5, METHOD, cells=20)
    with pytest.raises(ri.InvalidModel, match=f"{body} is {kind} and has no"):
        getattr(solution, field)(body, 0.0, 0.0)
