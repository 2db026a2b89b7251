"""A pile at rest stays at rest, and a row that cannot rest is refused in a sentence."""

import numpy as np
import pytest

import rodimpact as ri

STEEL = ri.materials.steel
SOIL = ri.Soil(300e3, quake=2.5e-3, damping=0.16)
TOE = ri.SmithToe(300e3, quake=2.5e-3, damping=0.5)
PILE = ri.Rod(15.0, area=9.4e-3, material=STEEL, shaft=SOIL)
HELMET = ri.RigidMass(510.0)
GRAVITY = 9.81  # m/s^2
UNTIL = 0.02  # s


def largest_velocity(system, body, cells):
    """Largest speed, m/s, of a rod and of the body before it in a run of 20 ms on a
    grid.
    """
    run = ri.solve(system, until=UNTIL, cells=cells)
    t = np.linspace(0.0, UNTIL, 50)
    length = float(system.bodies[body].length)
    x = np.linspace(0.0, length, 16)[:, np.newaxis]
    velocity = run.velocity(body, x, t)  # [position, time]
    velocity_before = run.velocity(body - 1, 0.0, t)
    speed = np.abs(velocity).max()
    speed_before = np.abs(velocity_before).max()
    return max(speed, speed_before)


def pile_with_helmet(contact):
    """A helmet on a pile with this contact, and a ram above it that flies up; not
    solved.
    """
    ram = ri.RigidMass(4500.0, velocity=-1.0)
    cushion = ri.Cushion(5e8, restitution=0.8)
    bodies = [ram, HELMET, PILE, ri.Wall()]
    gaps = [0.1, 0.0, 0.0]
    laws = [cushion, contact, TOE]
    return ri.System(bodies, gaps, laws, gravity=GRAVITY)


@pytest.mark.parametrize(
    ("contact", "bound"),
    [
        (ri.Spring(1e9), 1e-8),
        (ri.Cushion(1e9, restitution=0.7), 1e-8),
        # A grid finds the force of a rigid contact in the first steps only.
        (ri.Rigid(), 2e-4),
    ],
)
def test_a_pile_stays_at_rest_under_its_weight_and_that_of_a_helmet(contact, bound):
    """A pile with a helmet, put to rest by `at_rest`, has no velocity above `bound`,
    m/s, in 20 ms, and one above 0.01 m/s otherwise. The forces of soil and toe are the
    weight of both.
    """
    pile = 2  # index of the body, below ram and helmet
    system = pile_with_helmet(contact)

    resting = ri.at_rest(system, cells=40)

    assert largest_velocity(resting, pile, cells=40) < bound
    assert largest_velocity(system, pile, cells=40) > 1e-2
    run = ri.solve(resting, until=1e-4, cells=40)
    profile = run.soil(pile, 0.0)
    on_shaft = float(profile.resistance @ profile.mobilised)  # N, over all nodes
    overlap_at_toe = -resting.gaps[2]
    below_toe = overlap_at_toe * TOE.stiffness
    support = on_shaft + below_toe
    weight = (HELMET.mass + PILE.mass) * GRAVITY
    assert support == pytest.approx(weight, rel=1e-6)


def test_a_finer_grid_moves_a_resting_pile_by_little():
    """A pile put to rest with 50 cells has no velocity above 1e-9 m/s on this grid, and
    none above 1e-4 m/s on one of 200 cells.
    """
    pile = 2  # index of the body, below ram and helmet
    system = pile_with_helmet(ri.Spring(1e9))

    resting = ri.at_rest(system, cells=50)

    assert largest_velocity(resting, pile, cells=50) < 1e-9
    assert largest_velocity(resting, pile, cells=200) < 1e-4


def test_bonded_piles_with_a_joint_rest_on_the_compressed_joint():
    """The joint is between the pile and a rod without soil."""
    half_soil = SOIL.replace(resistance=150e3)
    half = PILE.replace(length=7.5, shaft=half_soil)
    bare = PILE.replace(length=2.0, shaft=None)
    bodies = [HELMET, half, half, bare, ri.Wall()]
    contacts = [ri.Spring(1e9), ri.Bonded(), ri.Joint(1e9), TOE]
    system = ri.System(bodies, contacts=contacts, gravity=GRAVITY)

    resting = ri.at_rest(system, cells=30)

    joint = resting.contacts[2]
    assert largest_velocity(resting, 1, cells=30) < 1e-9
    assert joint.stretch < 0


def test_what_is_at_rest_without_weight_stays_as_it_is():
    """Gaps are 0 and the pile has no strain."""
    bodies = [HELMET, PILE, ri.Wall()]
    laws = [ri.Spring(1e9), TOE]
    system = ri.System(bodies, contacts=laws)

    resting = ri.at_rest(system, cells=10)

    assert resting.gaps == (0.0, 0.0)
    _, pile, _ = resting.bodies
    assert not np.any(pile.strain.values)


def test_a_contact_that_would_pull_opens():
    """Two piles in soil, of which the first one shrinks back from its stretch."""
    stretched = PILE.replace(strain=1e-4)
    system = ri.System([stretched, PILE], contacts=[ri.Spring(1e8)])

    resting = ri.at_rest(system, cells=10)

    assert largest_velocity(resting, 1, cells=10) < 1e-9
    assert resting.gaps[0] > 0


@pytest.mark.parametrize("is_hanging", [True, False])
def test_a_string_on_a_fixed_end_rests_with_the_strain_of_its_weight(is_hanging):
    """The strain of the pipe is (W + rho A (L - x) g)/(E A) at the middles of cells.

    W is the weight of the collar, x the distance from the fixed end. A string that
    stands on the fixed end is compressed. A run of 1 s from this state stays at rest.
    """
    pipe = ri.Rod(3000.0, area=3.4e-3, material=STEEL)
    collar = ri.Rod(200.0, area=24e-3, material=STEEL)
    bodies = [pipe, collar]
    ends = [ri.Fixed(), ri.Free()]
    if not is_hanging:
        bodies.reverse()
        ends.reverse()
    bond = ri.Bonded()
    string = ri.System(bodies, contacts=[bond], ends=ends, gravity=GRAVITY)

    resting = ri.at_rest(string, cells=60)

    body = bodies.index(pipe)
    resting_pipe = resting.bodies[body]
    strain = np.array(resting_pipe.strain.values)  # [cell]
    middles = (np.arange(60) + 0.5) / 60 * pipe.length  # x [cell]
    length_beyond = pipe.length - middles
    stress_of_collar = collar.mass * GRAVITY / 3.4e-3
    stress = stress_of_collar + STEEL.density * GRAVITY * length_beyond
    if not is_hanging:
        # The fixed end is on the right.
        stress = -stress[::-1]
    expected = stress / STEEL.youngs_modulus
    assert strain == pytest.approx(expected, rel=1e-9)
    run = ri.solve(resting, 1.0, "finite-difference", cells=60)
    t = np.linspace(0.0, 1.0, 40)
    x = np.linspace(0.0, pipe.length, 7)[:, np.newaxis]
    velocity = run.velocity(body, x, t)
    assert np.abs(velocity).max() < 1e-9


REFUSED = [
    (ri.System([PILE.replace(shaft=None)], gravity=GRAVITY), "bodies.0: .*holds"),
    (
        ri.System([PILE.replace(shaft=SOIL.replace(resistance=1e3))], gravity=GRAVITY),
        "bodies.0.shaft: .*the soil yields at 0 m; raise",
    ),
    (
        ri.System(
            [PILE.replace(shaft=None), ri.Wall()],
            contacts=[TOE.replace(resistance=3e3)],
            gravity=GRAVITY,
        ),
        "contacts.0: .*the contact yields; raise",
    ),
    (
        ri.System([HELMET, PILE], contacts=[ri.Hertz(1e9)], gravity=GRAVITY),
        "contacts.0: .*no constant stiffness.*Hertz",
    ),
    (ri.System([PILE], ends=(ri.Absorbing(), ri.Free())), "ends.left: must be free or"),
    (ri.System([PILE], ends=(ri.Free(), ri.Moved(1.0))), "ends.right: must be free or"),
    (ri.System([ri.Wall(velocity=1.0), PILE]), "bodies.0: is a wall that moves"),
    (ri.System([ri.RigidMass([1.0, 2.0]), PILE]), "system: is a family"),
]


@pytest.mark.parametrize(("system", "message"), REFUSED)
def test_a_row_that_cannot_rest_is_refused(system, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.at_rest(system)


def test_the_profile_of_the_soil_tells_resistance_displacement_and_what_yielded():
    """A pile is driven through soil: the profile sums to the resistance, has the
    displacements of the run, and its elastic part is the mobilised share of the quake.
    """
    pile = PILE.replace(velocity=2.0)
    run = ri.solve(ri.System([pile]), until=UNTIL, cells=50)

    profile = run.soil(0, UNTIL)

    total_resistance = profile.resistance.sum()
    assert total_resistance == pytest.approx(SOIL.resistance)
    displacement = run.displacement(0, profile.x, UNTIL)
    assert profile.displacement == pytest.approx(displacement, abs=1e-15)
    assert np.all(profile.plastic_set > 0)
    elastic = profile.displacement - profile.plastic_set
    expected_elastic = profile.mobilised * SOIL.quake
    assert elastic == pytest.approx(expected_elastic, abs=1e-15)


def test_a_rod_without_soil_has_no_profile_of_it():
    rod = ri.Rod(1.0, area=1.0, material=STEEL)
    run = ri.solve(ri.System([rod]), until=1e-4)

    with pytest.raises(ValueError, match=r"body: has no soil along its shaft"):
        run.soil(0, 0.0)
