"""Derivatives: closed forms, an independent solver, what scaling demands, both sides of
kinks.
"""

from fractions import Fraction

import numpy as np
import pytest
from exhaustive import few_of
from method_of_steps import Row, impulses

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.model.paths import numbers_of, with_numbers
from rodimpact.running.differences import sides_of

STEEL = ri.materials.steel
MATERIALS = [
    ri.Material("one", youngs_modulus=100e9, density=4000.0),
    ri.Material("heavy", youngs_modulus=400e9, density=16000.0),
]
LENGTHS_AND_AREAS = (
    "bodies.0.length",
    "bodies.1.length",
    "bodies.0.area",
    "bodies.1.area",
)
AREA = 1e-4  # of a striker, m^2


def pair(length=0.4, struck_length=1.0, struck_area=AREA, velocity=1.0):
    """A striker with the cross-sectional area `AREA`, and a rod at rest; not solved."""
    striker = ri.Rod(length, area=AREA, material=STEEL, velocity=velocity)
    struck = ri.Rod(struck_length, area=struck_area, material=STEEL)
    return ri.System([striker, struck])


def random_row(seed):
    """Rods that approach each other, some stepped or strained, some apart, some before
    a wall.

    Runs of more than 5,000 events are left out for the time that they take.
    """
    rng = np.random.default_rng([18, seed])
    while True:
        system = _any_row(rng, seed)
        if ri.solve(system, method="fronts").events <= 5_000:
            return system


def _any_row(rng, seed):
    """A random row of rods, of which none is faster than that before it.

    The seed decides on steps, strains, gaps, wall and third rod.
    """
    n_segments = 1
    if seed % 3 == 0:
        n_segments = 2
    is_strained = seed % 5 == 0
    has_gaps = seed % 4 > 1
    has_wall = seed % 4 == 1

    def random_segment():
        length = float(rng.uniform(0.1, 1))
        area = float(rng.uniform(0.5, 2) * 1e-4)
        material = MATERIALS[rng.integers(2)]
        return ri.Segment(length, area, material)

    n_rods = 2 + seed % 2
    velocities = np.sort(rng.uniform(0, 1, n_rods))[::-1]  # the fastest first
    bodies = []
    for velocity in velocities:
        segments = [random_segment() for _ in range(n_segments)]
        strain = 0.0
        if is_strained:
            strain = float(1e-5 * rng.uniform(0.5, 1))
        rod = ri.Rod(segments=segments, velocity=float(velocity), strain=strain)
        bodies.append(rod)
    if has_wall:
        bodies.append(ri.Wall(-0.5))
    gaps = [0.0] * (len(bodies) - 1)
    if has_gaps:
        gaps = [float(rng.uniform(1, 2) * 1e-5) for _ in gaps]
    return ri.System(bodies, gaps=gaps)


def paths_of(system, *names):
    """Paths of all numbers of a system that have one of these names and are not 0."""
    paths = []
    for path, value in numbers_of(system).items():
        _, _, name = path.rpartition(".")
        if name in names and value != 0:
            paths.append(path)
    return paths


def velocity_after(system, i):
    """Velocity of body i after the collision."""
    return ri.solve(system, method="fronts").outcome.velocities_after[i]


def test_the_box_has_smooth_derivatives_by_lengths_and_a_kink_at_equal_areas():
    """Waves of rods of equal areas meet in an order that changes nothing by lengths.

    With z = A2/A1 and r = l1/l2 < 1/2 Saint-Venant's e is (2 z + 2 r)/(1 + z) - 1 for
    z >= 1; below, each round trip in the striker adds (1 - z)/(1 + z) of the one before
    to the impulse. So de/dz is (1 - r)/2 above z = 1, and -r below.
    """
    r = 0.4

    g = ri.gradient(pair(length=r, struck_length=1.0), wrt=LENGTHS_AND_AREAS)

    by_striker_length = g["bodies.0.length"]
    by_struck_length = g["bodies.1.length"]
    assert by_striker_length == pytest.approx(1.0, rel=1e-8)  # e = l1/l2
    assert by_struck_length == pytest.approx(-r, rel=1e-8)
    kink = g.kinks["bodies.1.area"]
    slope_above = (1 - r) / 2 / AREA
    slope_below = -r / AREA
    assert kink.above == pytest.approx(slope_above, rel=1e-7)
    assert kink.below == pytest.approx(slope_below, rel=1e-7)
    assert kink.jump == 0
    assert "-4000 below, 3000 above 1/m^2" in str(g)
    assert np.isnan(g["bodies.1.area"])


def test_derivatives_have_units():
    """The derivative of an impulse by length and area has the units N s/m and N s/m^2,
    which are printed.
    """
    units = {"bodies.1.length": "N s/m", "bodies.1.area": "N s/m^2"}
    g = ri.gradient(pair(), of="impulse.0", wrt=list(units))
    assert g.unit == "N s"
    assert g.units == units
    for unit in units.values():
        assert unit in str(g)


@pytest.mark.parametrize(
    ("law", "number", "unit"),
    [
        (ri.Hertz(1e9), "stiffness", "m^1.5/N"),
        pytest.param(
            ri.HuntCrossley(1e9, damping=0.3),
            "damping",
            "m/s",
            marks=pytest.mark.exhaustive,
        ),
        pytest.param(
            ri.PowerLaw(1e9, 1.7),
            "stiffness",
            "1/(N/m^p)",
            marks=pytest.mark.exhaustive,
        ),
    ],
)
def test_derivatives_of_e_have_short_units(law, number, unit):
    """The derivatives of e by a velocity and by a number of the contact law have the
    units s/m and `unit`.
    """
    path = f"contacts.0.{number}"
    row = pair(0.4, 1.0).replace(contacts=[law])

    g = ri.gradient(row, wrt=["bodies.0.velocity", path])

    units = {"bodies.0.velocity": "s/m", path: unit}
    assert g.units == units


def test_a_printed_derivative_has_its_stated_error():
    """de/dl1 = 1/l2 = 1 1/m of a rod of 1 m."""
    g = ri.gradient(pair(struck_length=1.0), wrt=["bodies.0.length"])

    error = g.errors["bodies.0.length"]
    assert str(g).endswith(f"1 1/m, stated error {error:.1g}")


def test_e_of_equal_rods_falls_on_both_sides_of_a_kink_by_length_and_not_by_area():
    """For two equal rods, e has the slopes 1/l below and -1/l above the length of the
    first rod, without a jump, and the slope 0 by the area of the second.
    """
    length = 0.4
    equal_rods = pair(length, struck_length=length)

    g = ri.gradient(equal_rods, wrt=["bodies.0.length", "bodies.1.area"])

    kink = g.kinks["bodies.0.length"]
    slope_below = 1 / length  # of e = l1/l2
    slope_above = -1 / length  # of e = l2/l1
    assert kink.below == pytest.approx(slope_below, rel=1e-8)
    assert kink.above == pytest.approx(slope_above, rel=1e-8)
    assert kink.jump == 0
    by_area = g["bodies.1.area"]
    assert by_area == pytest.approx(0, abs=1e-8)  # e = 1 for equal transit times
    assert "bodies.1.area" in str(g)


def test_a_gap_of_0_has_a_derivative_above_and_none_below():
    """A contact is closed at the start. The derivative of the last velocity by its gap
    is nan from below, and from above that of a one-sided difference; the gap has a
    kink, and its derivative is nan.
    """
    first, second = pair(0.4, 0.8).bodies
    last = ri.Rod(0.6, area=AREA, material=STEEL)
    system = ri.System([first, second, last])
    path = "contacts.1.gap"

    def velocity_with(gap):
        """Velocity of the last rod after the collision."""
        with_gap = with_numbers(system, {path: gap})
        return velocity_after(with_gap, 2)

    # The difference is one-sided, and of second order.
    step = 1e-7  # m
    shut = velocity_with(0.0)
    near = velocity_with(step)
    far = velocity_with(2 * step)
    slope = (4 * near - far - 3 * shut) / (2 * step)

    g = ri.gradient(system, "velocity_after.2", [path])

    below, above = g.one_sided[path]
    assert np.isnan(below)
    assert above == pytest.approx(slope, rel=1e-5)
    assert path in g.kinks
    assert np.isnan(g[path])


@pytest.mark.parametrize("seed", few_of(range(8), range(1)))
@pytest.mark.parametrize(
    ("quantity", "by_size", "by_area", "by_speed"),
    [
        pytest.param("velocity_after.0", 0, 0, 1, marks=pytest.mark.exhaustive),
        ("impulse.0", 1, 1, 1),
        pytest.param("duration.0", 1, 0, 0, marks=pytest.mark.exhaustive),
    ],
)
def test_a_quantity_grows_by_powers_of_all_lengths_areas_and_velocities(
    seed, quantity, by_size, by_area, by_speed
):
    """Euler: the sum of number times derivative is the power times the quantity.

    Gaps grow with lengths, and with velocities and strains.
    """
    system = random_row(seed)
    numbers = numbers_of(system)
    gaps = paths_of(system, "gap")
    sizes = [*paths_of(system, "length"), *gaps]
    areas = paths_of(system, "area")
    speeds = [*paths_of(system, "velocity", "strain"), *gaps]
    each_path = list(dict.fromkeys([*sizes, *areas, *speeds]))  # gaps are in two lists

    with kernels.forced(compiling=True):
        g = ri.gradient(system, quantity, each_path)

    assert not g.kinks.keys()
    for paths, power in ((sizes, by_size), (areas, by_area), (speeds, by_speed)):
        weighted_sum = 0.0
        stated_error = 0.0
        for path in paths:
            number = numbers[path]
            weighted_sum += number * g[path]
            stated_error += abs(number) * g.errors[path]
        expected = power * g.value
        assert abs(weighted_sum - expected) <= stated_error
        # A stated error is small, so that it can be exceeded.
        assert stated_error <= 1e-8 * (abs(g.value) + 1e-6)


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "struck_lengths", few_of([(1.0, 1.03, 0.4), (1.0, 0.4)], [(1.0, 0.4)])
)
def test_derivatives_of_families_are_those_of_members_compiled_and_in_plain_python(
    struck_lengths,
):
    """Derivatives of a family by length and area of rod 2 are the same compiled and in
    plain Python, and those of each member alone, one-sided values and kinks included.
    """
    family = pair(0.4, np.array(struck_lengths))
    n_members = len(struck_lengths)
    paths = ["bodies.1.length", "bodies.1.area"]

    with kernels.forced(compiling=False):
        plain = ri.gradient(family, wrt=paths)
    with kernels.forced(compiling=True):
        compiled = ri.gradient(family, wrt=paths)

    assert np.shape(plain) == (n_members, 2)  # [member, path]
    assert np.array_equal(plain, compiled, equal_nan=True)
    assert f"{n_members} members" in str(plain)
    for index in range(n_members):
        alone = ri.gradient(family[index], wrt=paths)
        for path in paths:
            sides = [side[index] for side in plain.one_sided[path]]
            assert np.array_equal(sides, alone.one_sided[path])
            has_kink = np.isfinite(plain.kinks[path].below[index])
            assert (path in alone.kinks) == has_kink


def test_a_member_that_does_not_collide_has_no_value_and_no_derivative():
    """A family of two pairs, of which the second moves apart: its value and its
    derivative are nan, and the derivative of the first is finite.
    """
    family = pair(velocity=[1.0, -1.0])

    g = ri.gradient(family, wrt=["bodies.0.length"])

    colliding, receding = g["bodies.0.length"]
    assert np.isfinite(colliding)
    assert np.isnan(receding)
    assert np.isnan(g.value[1])


def test_the_restitution_of_rods_that_do_not_collide_has_no_derivative():
    receding = pair(velocity=-1.0)
    with pytest.raises(ri.UndefinedRestitution, match="nothing collided"):
        ri.gradient(receding, wrt=["bodies.0.length"])


def test_a_quantity_of_a_run_that_a_cap_stops_has_no_derivative():
    with pytest.raises(ri.UndefinedRestitution, match="cap of 1 events"):
        ri.gradient(pair(), "impulse.0", ["bodies.0.length"], max_events=1)


ROD = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)


def test_a_rod_on_a_moving_wall_leaves_with_twice_the_velocity_of_the_wall():
    """v' = 2 V - v, and the wall keeps its velocity V."""
    system = ri.System([ROD, ri.Wall(-1.0)])
    v = "bodies.0.velocity"
    V = "bodies.1.velocity"

    of_rod = ri.gradient(system, "velocity_after.0", [v, V])
    of_wall = ri.gradient(system, "velocity_after.1", [V])

    assert of_rod[v] == pytest.approx(-1.0, rel=1e-10)
    assert of_rod[V] == pytest.approx(2.0, rel=1e-10)
    assert of_wall[V] == 1


def rod_on_fixed_rod():
    """`ROD` that strikes a rod whose far end is fixed; not solved."""
    _, struck = pair().bodies
    ends = [ri.Free(), ri.Fixed()]
    return ri.System([ROD, struck], ends=ends)


def test_the_impulse_beside_a_fixed_end_is_proportional_to_the_velocity():
    """The velocity is 1 m/s, and -1 m/s in the mirrored row."""
    system = rod_on_fixed_rod()

    g = ri.gradient(system, "impulse.0", ["bodies.0.velocity"])
    mirrored = ri.gradient(system.mirrored(), "impulse.0", ["bodies.1.velocity"])

    slope = g["bodies.0.velocity"]
    mirrored_slope = mirrored["bodies.1.velocity"]
    assert slope == pytest.approx(g.value, rel=1e-12)
    assert mirrored_slope == pytest.approx(-mirrored.value, rel=1e-12)


@pytest.mark.exhaustive
def test_one_sided_derivatives_beside_a_fixed_end_are_those_of_the_mirrored_row():
    """Both one-sided derivatives by an area are finite and equal those of the mirrored
    row.
    """
    system = rod_on_fixed_rod()

    g = ri.gradient(system, "impulse.0", ["bodies.0.area"])
    mirrored = ri.gradient(system.mirrored(), "impulse.0", ["bodies.1.area"])

    sides = g.one_sided["bodies.0.area"]
    mirrored_sides = mirrored.one_sided["bodies.1.area"]
    assert np.isfinite(sides).all()
    assert sides == pytest.approx(mirrored_sides, rel=1e-9)


@pytest.mark.parametrize("mirrored", few_of([False, True], [True]))
@pytest.mark.parametrize("area", few_of([1e-4, 1.7e-4], [1.7e-4]))
def test_derivatives_of_a_striker_on_an_endless_bar_are_those_of_its_formula(
    area, mirrored
):
    """It takes (r - 1)/(r + 1) of its speed back; r is the ratio of impedances."""
    length = 0.4
    bodies = pair(length, struck_length=0.5, struck_area=area).bodies
    system = ri.System(bodies, ends=[ri.Free(), ri.Absorbing()])
    striker = 0
    bar = 1
    direction = 1  # velocity of the striker, m/s
    if mirrored:
        system = system.mirrored()
        striker = 1
        bar = 0
        direction = -1
    paths = [
        f"bodies.{striker}.velocity",
        f"bodies.{striker}.length",
        f"bodies.{bar}.length",
    ]
    bar_area = f"bodies.{bar}.area"

    of_velocity = ri.gradient(system, f"velocity_after.{striker}", paths)
    of_impulse = ri.gradient(system, "impulse.0", paths)
    by_area = ri.gradient(system, f"velocity_after.{striker}", [bar_area])

    r = area / AREA
    rebound = (r - 1) / (r + 1)  # over the speed
    rebound_by_area = 2 / (1 + r) ** 2 / AREA
    mass = STEEL.density * AREA * length
    impulse = mass * (1 + rebound)
    # By the velocity and the length of the striker, and the length of the bar
    velocity_slopes = [-rebound, 0, 0]
    impulse_slopes = [direction * impulse, impulse / length, 0]
    np.testing.assert_allclose(of_velocity, velocity_slopes, atol=1e-12)
    np.testing.assert_allclose(of_impulse, impulse_slopes, atol=1e-12)
    _, above = by_area.one_sided[bar_area]  # below is another formula for equal areas
    area_slope = -direction * rebound_by_area
    assert above == pytest.approx(area_slope, rel=1e-7)


STRIKER_AND_ROD = pair().bodies
INFINITE_PAIR = ri.System(STRIKER_AND_ROD, ends=[ri.Free(), ri.Absorbing()])
HERTZ_PAIR = ri.System(STRIKER_AND_ROD, contacts=[ri.Hertz(1e10)])
BESIDE_A_WALL = ri.System([ri.Wall(), *STRIKER_AND_ROD])


@pytest.mark.parametrize(
    ("system", "arguments", "message"),
    [
        (pair(), {"of": "e"}, "of: must be one of velocity_after.0, .*restitution"),
        (pair(), {"wrt": "bodies.0.length"}, "wrt: must be a list of paths"),
        (pair(), {"wrt": ["bodies.0.lenght"]}, "perhaps 'bodies.0.length' is meant"),
        (
            BESIDE_A_WALL,
            {"wrt": ["gravity"], "of": "impulse.0"},
            "until: must be given",
        ),
        (pair(), {"progress": 3}, "progress: must be"),
        (pair(), {"workers": 0, "max_events": 0}, "max_events: must be a positive"),
        (
            INFINITE_PAIR,
            {"of": "velocity_after.1"},
            "of: must be one of velocity_after.0, impulse.0, peak_force.0, duration.0, "
            "got",
        ),
        (HERTZ_PAIR, {"method": "fronts"}, 'method "fronts" has no compliant'),
    ],
)
def test_quantities_and_paths_without_derivatives_are_refused(
    system, arguments, message
):
    arguments = {"wrt": ["bodies.0.length"], **arguments}
    with pytest.raises(ri.InvalidModel, match=message):
        ri.gradient(system, **arguments)


def random_rods(rng, count):
    """Rods of different sections and materials that come together."""
    rods = []
    for velocity in np.sort(rng.uniform(0, 1, count))[::-1]:
        material = ri.Material(
            f"material {len(rods)}",
            youngs_modulus=float(rng.uniform(1e11, 4e11)),
            density=float(rng.uniform(4e3, 12e3)),
        )
        rod = ri.Rod(
            float(rng.uniform(0.1, 1)),
            area=float(rng.uniform(0.5, 2) * 1e-4),
            material=material,
            velocity=float(velocity),
        )
        rods.append(rod)
    return rods


def rigid_row(seed):
    """A row of two rods, or of three for an odd seed, with at most 24 events, so that
    its formulas are short; and the generator of random numbers in its present state.
    """
    rng = np.random.default_rng([44, seed])
    n_rods = 2 + seed % 2
    gaps = [0.0, 1e-5][: n_rods - 1]
    while True:
        rods = random_rods(rng, n_rods)
        system = ri.System(rods, gaps=gaps)
        if ri.solve(system).events <= 24:
            return system, rng


@pytest.mark.parametrize("seed", few_of(range(30), range(3)))
def test_stated_errors_of_rigid_rows_bound_the_difference_from_the_formula(seed):
    """The derivative of the velocity of rod 2 by one number of a random row of rigid
    contacts differs from that of the closed form by its stated error at most. This
    error is at most 1e-8 of the scale.
    """
    system, rng = rigid_row(seed)
    paths = paths_of(system, "length", "area", "velocity", "gap")
    path = str(rng.choice(paths))
    form = ri.closed_form(system, [path])
    ((symbol, x),) = form.values.items()  # of the one number that varies
    step = Fraction(1, 10**30)  # the formula is rational, and evaluated in fractions

    def velocity(x):
        """Velocity of the second rod after the collision, by the formula."""
        outcome = form.at(**{symbol: x})
        return outcome.velocities_after[1]

    difference = velocity(x + step) - velocity(x - step)
    slope = float(difference / (2 * step))

    g = ri.gradient(system, "velocity_after.1", [path])

    stated_error = g.errors[path]
    assert abs(g[path] - slope) <= stated_error
    scale = abs(slope) + abs(g.value) / float(x)
    assert stated_error <= 1e-8 * scale


def compliant_row(rng, rods, varied):
    """A `Row` of random rods with power laws for the other solver, the time at which to
    stop, and the index of the element of the field `varied` that is to vary.

    Velocities fall along the row, and gaps are open: contacts close one after another.
    An exponent that varies is 1.5.
    """
    row = Row(
        T=rng.uniform(0.4, 1, rods),
        Z=rng.uniform(0.5, 2, rods),
        v=np.sort(rng.uniform(-1, 1, rods))[::-1],
        gap=rng.uniform(0.02, 0.3, rods - 1),
        K=rng.uniform(0.5, 20, rods - 1),
        p=rng.choice([1.0, 1.5, 2.0, 2.5], rods - 1),
    )
    until = float(rng.uniform(1.5, 3))
    i = int(rng.integers(len(getattr(row, varied))))
    if varied == "p":
        row.p[i] = 1.5  # smaller exponents than 1 are refused
    return row, until, i


def system_of(row):
    """The `System` of a `Row`, whose rods have unit wave speed and density."""
    bodies = []
    for length, area, velocity in zip(row.T, row.Z, row.v, strict=True):
        numbers = {"area": float(area), "velocity": float(velocity)}
        bodies.append(ri.Rod(float(length), material=UNIT, **numbers))
    laws = []
    for stiffness, exponent in zip(row.K, row.p, strict=True):
        laws.append(ri.PowerLaw(float(stiffness), float(exponent)))
    return ri.System(bodies, gaps=row.gap.tolist(), contacts=laws)


def unit_change(row, varied, i):
    """A `Row` with the derivative of the numbers by one of them: 1 for element i of the
    field `varied`, 0 elsewhere.
    """
    change = Row(*map(np.zeros_like, row))
    field = getattr(change, varied)
    field[i] = 1.0
    return change


UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
COMPLIANT_NUMBERS = {
    "bodies.{}.length": "T",
    "bodies.{}.area": "Z",
    "bodies.{}.velocity": "v",
    "contacts.{}.gap": "gap",
    "contacts.{}.stiffness": "K",
    "contacts.{}.exponent": "p",
}
"""Paths of rods of unit wave speed and density, by the fields of `Row`."""


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", few_of(range(20), [0]))
def test_stated_errors_of_compliant_rows_bound_the_difference_from_another_solver(seed):
    """The derivative of an impulse by one number of a random compliant row differs from
    that of an independent solver by its stated error at most, which is 1e-6 of the
    slope at most.
    """
    patterns = list(COMPLIANT_NUMBERS)
    pattern = patterns[seed % len(patterns)]  # of the path of the number that varies
    varied = COMPLIANT_NUMBERS[pattern]
    rng = np.random.default_rng([45, seed])
    n_rods = 2
    if seed % 3 == 2:
        n_rods = 3
    row, until, i = compliant_row(rng, n_rods, varied)
    change = unit_change(row, varied, i)
    values, slopes = impulses(row, change, until)  # [contact]

    path = pattern.format(i)
    g = ri.gradient(system_of(row), "impulse.0", [path], until=until)

    impulse = values[0]
    slope = slopes[0]
    stated_error = g.errors[path]
    assert g.value == pytest.approx(impulse, abs=1e-12)
    assert abs(g[path] - slope) <= stated_error + 1e-12
    assert stated_error <= 1e-6 * max(abs(slope), 1.0)


QUANTITIES = ["velocity_after.0", "impulse.0", "peak_force.0", "duration.0"]


def mass_on_an_infinite_bar(M, k, Z, V):
    """Array of the four `QUANTITIES` of a mass that strikes an infinite bar by a
    spring.

    The equation of the overlap is that of a damped oscillator, u'' + (k/Z) u' + (k/M) u
    = 0, here underdamped: the contact opens after half a period.
    """
    a = k / (2 * Z)
    w = np.sqrt(k / M - a * a)
    half_period = np.pi / w
    rebound = V * np.exp(-a * half_period)
    impulse = M * (V + rebound)
    # u = V/w exp(-a t) sin(w t)
    peak_time = np.arctan(w / a) / w
    peak_overlap = V / w * np.exp(-a * peak_time) * np.sin(w * peak_time)
    peak_force = k * peak_overlap
    return np.array([-rebound, impulse, peak_force, half_period])


@pytest.mark.parametrize("quantity", few_of(QUANTITIES, ["peak_force.0"]))
def test_stated_errors_of_a_mass_on_a_spring_at_an_infinite_bar_hold(quantity):
    """Derivatives of the formulas are exact: f(x + ih) = f(x) + ih f'(x) for small h."""
    M = 0.7
    k = 1.6
    Z = 1.3
    V = 0.9
    mass = ri.RigidMass(M, velocity=V)
    bar = ri.Rod(1.0, area=Z, material=UNIT)  # its impedance is its area
    ends = [ri.Free(), ri.Absorbing()]
    system = ri.System([mass, bar], contacts=[ri.Spring(k)], ends=ends)
    # In the order of M, k, Z and V
    paths = [
        "bodies.0.mass",
        "contacts.0.stiffness",
        "bodies.1.area",
        "bodies.0.velocity",
    ]

    g = ri.gradient(system, quantity, paths)

    index = QUANTITIES.index(quantity)
    value = mass_on_an_infinite_bar(M, k, Z, V)[index]
    assert g.value == pytest.approx(value, rel=1e-9)
    h = 1e-30
    for n, path in enumerate(paths):
        stepped = np.array([M, k, Z, V], complex)
        stepped[n] += 1j * h
        stepped_value = mass_on_an_infinite_bar(*stepped)[index]
        slope = stepped_value.imag / h
        stated_error = g.errors[path]
        assert abs(g[path] - slope) <= stated_error + 1e-14
        assert stated_error <= 1e-7


def test_stated_errors_of_a_mass_on_a_free_rod_hold():
    """Rigid contact lasts 2 T; e = (1 - exp(-2 mu))/mu - exp(-2 mu), mu the ratio of
    masses.
    """
    M = 2.0
    A = 1.0
    mu = A / M  # of a rod of unit length and density
    rod = ri.Rod(1.0, area=A, material=UNIT)
    system = ri.System([ri.RigidMass(M, velocity=1.0), rod])
    decay = np.exp(-2 * mu)
    by_mu = (decay * (2 * mu + 1) - 1) / mu**2 + 2 * decay  # de/dmu
    by_mass = by_mu * -A / M**2
    by_area = by_mu / M
    slopes = {"bodies.0.mass": by_mass, "bodies.1.area": by_area}

    g = ri.gradient(system, wrt=list(slopes))

    for path, slope in slopes.items():
        assert abs(g[path] - slope) <= g.errors[path]
        assert g.errors[path] <= 1e-8


def test_a_duration_jumps_where_the_short_rod_becomes_the_thicker_one():
    """As a function of the area of the short rod, the duration jumps at equal impedances
    from 2 T of the short rod to 2 T of the long rod. The gradient is nan, the jump is
    stated, and both slopes are 0.
    """
    path = "bodies.0.area"
    T_short = 0.6  # transit times, which are lengths, as the wave speed is 1
    T_long = 1.0
    striker = ri.Rod(T_short, area=1.0, material=UNIT, velocity=1.0)
    struck = ri.Rod(T_long, area=1.0, material=UNIT)
    system = ri.System([striker, struck])

    g = ri.gradient(system, "duration.0", [path])

    jump = g.kinks[path].jump
    expected_jump = 2 * T_long - 2 * T_short
    assert jump == pytest.approx(expected_jump, rel=1e-9)
    assert np.isnan(g[path])
    assert "a jump by 0.8 s" in str(g)
    one_sided = g.one_sided[path]  # slopes below and above
    assert one_sided == pytest.approx((0, 0), abs=1e-6)


@pytest.mark.parametrize("distance", [1e-3, 1e-5, 3e-7])
def test_a_kink_beside_the_number_is_not_at_the_number(distance):
    """Rods of one section: e = l1/l2 for l1 < l2, and l2/l1 above."""
    slightly_shorter = pair(1.0 - distance, struck_length=1.0)
    path = "bodies.0.length"

    g = ri.gradient(slightly_shorter, wrt=[path])

    slope = 1.0  # 1/l2
    stated_error = g.errors[path]
    assert not g.kinks
    assert abs(g[path] - slope) <= stated_error
    assert stated_error < 1e-3


def test_progress_counts_collisions():
    """A gradient by two lengths reports a rising count of at least 25 collisions, and
    None as the total.
    """
    counts = []
    lengths = ["bodies.0.length", "bodies.1.length"]

    def note(done, total):
        counts.append(done)
        assert total is None  # steps are made as small as is needed

    ri.gradient(pair(0.4, 0.9), wrt=lengths, progress=note)

    # The collision itself, and at least 12 beside it for each length
    fewest = 1 + 12 * len(lengths)
    assert counts == sorted(counts)
    assert counts[-1] >= fewest


def test_progress_may_stop_a_gradient():
    def stop(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        ri.gradient(pair(), wrt=["bodies.0.length"], progress=stop)


def test_a_number_that_varies_may_take_another_method():
    """Gravity is 0 here, and "fronts" has none: a rod that falls for a time t gains
    g t.
    """
    rod = ri.Rod(1.0, area=1.0, material=UNIT, velocity=-1.0)
    system = ri.System([ri.Wall(), rod], gaps=[3.0])  # the wall is not reached
    until = 2.0

    g = ri.gradient(system, "velocity_after.1", ["gravity"], until=until)

    magnitude = abs(g["gravity"])
    assert abs(magnitude - until) <= g.errors["gravity"] + 1e-12


@pytest.mark.exhaustive
def test_the_grid_agrees_with_characteristics_within_its_stated_error():
    """The derivatives of an impulse by length and stiffness on a grid differ from those
    by characteristics by the stated errors at most, and these are at most 20 %.
    """
    system = ri.System(pair().bodies, contacts=[ri.Hertz(1e10)])
    paths = ["bodies.0.length", "contacts.0.stiffness"]
    exact = ri.gradient(system, "impulse.0", paths)
    grid = ri.gradient(system, "impulse.0", paths, method="finite-difference")
    for path in paths:
        grid_error = grid.errors[path]
        difference = abs(grid[path] - exact[path])
        assert difference <= grid_error + exact.errors[path]
        assert grid_error <= 0.2 * abs(exact[path])


@pytest.mark.parametrize("noise", [0.0, 1e-12, 1e-6])
def test_bounds_of_differences_hold_for_noisy_values(noise):
    """Values are exp(-h) below a point and 1 + 2 sin(h) above it, with noise: the slope
    jumps from 1 to 2, the value does not. Estimates of the slopes and of the jump of
    the value are wrong by their stated errors at most, and the point is not called
    smooth.
    """
    steps = 2.0 ** -np.arange(3, 15)[:, np.newaxis]  # 12 steps
    rng = np.random.default_rng(3)
    # Values are [step, member], of 50 members.
    noise_below, noise_above = rng.uniform(-noise, noise, (2, 12, 50))
    below = np.exp(-steps) + noise_below
    above = 1 + 2 * np.sin(steps) + noise_above
    error_of_values = np.full(50, noise + 1e-16)

    sides = sides_of(below, above, steps, error_of_values)

    def is_bounded(estimate, exact):
        """Whether the stated error of each member bounds the true one."""
        errors = np.abs(estimate.value - exact)
        return (errors <= estimate.error).all()

    assert is_bounded(sides.below, exact=1)
    assert is_bounded(sides.above, exact=2)
    assert is_bounded(sides.jump, exact=0)
    assert not sides.smooth.any()
