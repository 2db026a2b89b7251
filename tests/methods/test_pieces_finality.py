"""The proof that a collision is over, from pieces: what it states bounds what happens
later.
"""

import numpy as np
import pytest
from exhaustive import few_of
from networks import UNIT, unit_rod
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.methods import record_lists
from rodimpact.methods.link import Law
from rodimpact.methods.pieces import finality
from rodimpact.methods.pieces.driver import Members
from rodimpact.methods.pieces.layout import RunRequest
from rodimpact.methods.pieces.records import GROUP_PART, LINK, RUN
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.states import Status


def stepped_rod(rng, velocity, n=3):
    """A rod of n segments, with steps of velocity about a mean and of strain."""
    lengths = rng.integers(2, 9, n) / 8
    areas = rng.uniform(0.3, 3, n)
    segments = []
    for length, area in zip(lengths, areas, strict=True):
        segment = ri.Segment(float(length), area=float(area), material=UNIT)
        segments.append(segment)
    total = float(lengths.sum())
    places = [0.3 * total, 0.6 * total]
    velocities = velocity + rng.uniform(-1, 1, 3)
    strains = 0.3 * rng.uniform(-1, 1, 3)
    velocity_steps = ri.Steps(velocities.tolist(), at=places)
    strain_steps = ri.Steps(strains.tolist(), at=places)
    return ri.Rod(segments=segments, velocity=velocity_steps, strain=strain_steps)


def parts_at_start(system):
    """Records GROUP_PART of all parts of a row at t = 0, with the motion that
    `update_groups` gives them. Nothing runs.
    """
    # The motion at t = 0 does not depend on these options.
    request = RunRequest(until=8.0, tolerance=1e-8, max_steps=10**6, keeps_history=True)
    members = Members(build_row(system), request)
    # Records as lists of plain Python, into which the only member is loaded
    members.batch.to_lists()
    members.load()
    state = members.batch.state
    finality.update_groups(state, 0)
    return state.parts


def rod_with_a_mass(rng, rod):
    """A row of a rod and a random mass on a random joint."""
    kilograms = float(rng.uniform(0.1, 2))
    velocity = float(rng.uniform(-1, 1))
    mass = ri.RigidMass(kilograms, velocity=velocity)
    stiffness = float(rng.uniform(0.5, 5))
    stretch = float(rng.uniform(-0.1, 0.1))
    joint = ri.Joint(stiffness, stretch=stretch)
    return ri.System([rod, mass], contacts=[joint])


@pytest.mark.parametrize("seed", few_of(range(12), range(4)))
def test_the_ends_of_a_group_deviate_within_their_bounds(seed):
    """Both ends of a stepped rod, or of one with a mass on a joint, stay within the
    bound for 8 s; the bound is at most 20 times what is reached.
    """
    rng = default_rng(seed)
    rod = stepped_rod(rng, velocity=0.2)
    right_end = (0, rod.length)  # body, and material coordinate
    system = ri.System([rod])
    if seed % 2 == 1:
        system = rod_with_a_mass(rng, rod)
        right_end = (1, 0.0)
    group = parts_at_start(system)[0]
    t = np.linspace(0, 8, 801)

    solution = ri.solve(system, until=8.0, method="characteristics")

    velocity = group.group_velocity + solution.run.clock.frame
    ends = [(0, 0.0), right_end]
    for side, (body, x) in enumerate(ends):
        displacement = solution.displacement(body, x, t)
        change = displacement - displacement[0]
        mean_motion = velocity * t
        deviation = group.end_deviations[side] + change - mean_motion
        largest = np.abs(deviation).max()
        compliance = group.compliance_integrals[side]
        bound = np.sqrt(2 * group.reference_energy * compliance)
        assert largest <= bound * (1 + 1e-9)
        assert largest >= 0.05 * bound  # a bound that says something


@pytest.mark.parametrize("damping", [0.3, 3.0])
def test_a_mass_on_a_dashpot_deviates_within_its_bound(damping):
    """A rod of the mass 1 moves the mass 1/2 through a dashpot c alone, which gives way
    for ever.

    From the mass, 2/3 of all mass lies beyond the dashpot, so that the mass deviates by
    at most sqrt(2 E) (sqrt(s) + 2 (2/3)/c), with s = (2/3)^2 L/(3 E A) = 4/27.
    """
    rod = unit_rod(1.0, velocity=1.0)
    mass = ri.RigidMass(0.5, velocity=-0.5)
    dashpot = ri.Joint(0.0, damping=damping)
    system = ri.System([rod, mass], contacts=[dashpot])
    group = parts_at_start(system)[0]
    reach = np.sqrt(4 / 27) + 2 * (2 / 3) / damping
    right_end = 1
    compliance = group.compliance_integrals[right_end]
    assert compliance == pytest.approx(reach**2, rel=1e-9)

    solution = ri.solve(system, until=8.0, method="characteristics")

    t = np.linspace(0, 8, 801)
    displacement = solution.displacement(1, 0.0, t)
    change = displacement - displacement[0]
    velocity = group.group_velocity + solution.run.clock.frame
    deviation = change - velocity * t
    largest = np.abs(deviation).max()
    bound = np.sqrt(2 * group.reference_energy) * reach
    assert largest <= bound
    assert largest > 0.1 * bound  # a bound that says something


@pytest.mark.parametrize("seed", few_of(range(12), range(2)))
@pytest.mark.parametrize("law", [ri.Hertz(20.0), ri.SpringDashpot(20.0, damping=0.5)])
def test_a_run_three_times_as_long_as_a_final_one_has_the_same_contacts(seed, law):
    """Two rods and a mass between them collide through a law and a spring. A run three
    times as long as the final one has the same episodes and the same final time.
    """
    rng = default_rng(seed)
    left = stepped_rod(rng, velocity=1.0, n=1)
    mass = ri.RigidMass(0.5)
    right = stepped_rod(rng, velocity=-0.3, n=1)
    laws = [law, ri.Spring(50.0)]
    system = ri.System([left, mass, right], gaps=[0.1, 0.1], contacts=laws)

    solution = ri.solve(system)
    longer = ri.solve(system, until=3 * solution.t_end)

    assert solution.final
    for contact, other in zip(solution.contacts, longer.contacts, strict=True):
        assert len(other.episodes) == len(contact.episodes)
        for episode, same in zip(contact.episodes, other.episodes, strict=True):
            assert tuple(same) == pytest.approx(tuple(episode), abs=1e-6)
    assert longer.t_final == pytest.approx(solution.t_final, rel=1e-6)
    assert solution.t_final <= solution.t_proved <= solution.t_end


def test_the_energy_about_the_mean_is_that_of_the_ledger():
    """In a group of one rod the reference energy is the energy of vibration."""
    rng = default_rng(3)
    rod = stepped_rod(rng, velocity=0.4)
    system = ri.System([rod])
    solution = ri.solve(system, until=1.0, method="characteristics")
    vibration = float(solution.energy(0.0).vibration)

    group, *_ = parts_at_start(system)

    assert group.reference_energy == pytest.approx(vibration, rel=1e-12)


def blank(record):
    """An object with the fields of a record, all of which are 0."""
    (only,) = record_lists.blank(1, record)
    return only


def part_within_1_m():
    """A part that deviates by up to 1 m: sqrt(2 E s), its energy E = 2 J and its
    compliance integral s = 1/4 m^2/J.
    """
    part = blank(GROUP_PART)
    part.reference_energy = 2.0
    part.compliance_integrals = [0.25, 0.25]
    part.min_wave = -3.0
    part.max_wave = 3.0
    return part


@pytest.mark.parametrize(
    ("gap", "opening", "is_over"),
    [
        (2.01, 1e-3, True),
        (1.99, 1e-3, False),
        (9.0, -1e-3, False),
        (-2.01, 1e-3, False),
    ],
)
def test_a_contact_is_over_if_its_gap_is_beyond_both_bounds_and_opens(
    gap, opening, is_over
):
    """The parts beside the gap deviate by up to 1 m each; it opens with `opening`,
    m/s.
    """
    run = blank(RUN)
    run.velocity_scale = 1.0
    run.tolerance = 1e-12
    run.tick_duration = 1e-9
    link = blank(LINK)
    link.law = Law.SPRING
    link.status = Status.OPEN
    link.left_group = 0
    link.right_group = 1
    link.overlap = -gap
    left = part_within_1_m()
    right = part_within_1_m()
    right.reference_velocity = opening

    time = finality.time_until_over(run, [link], [left, right])

    assert (time == 0) is is_over
