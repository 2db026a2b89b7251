"""What must hold for every row, whatever is in it."""

from functools import partial

import numpy as np
import pytest
from exhaustive import few_of
from hypothesis import assume, given
from hypothesis import strategies as st
from runs import bits_of
from systems import horizon, random_system, with_ends

import rodimpact as ri
from rodimpact.methods import kernels

SEEDS = st.integers(0, 10**6)
CAP = 20_000
"""Largest number of events of a run."""
any_row = pytest.mark.parametrize(
    "row",
    [random_system, partial(with_ends, driven=False)],
    ids=["free ends", "any ends"],
)


def run(system, transits=15.0):
    """A solution until so many transits of the longest rod, or until the cap."""
    until = horizon(system, transits)
    return ri.solve(system, until=until, max_events=CAP)


def waves(solution, factor=1.0):
    """Ticks and values, times a factor, of the wave on each line; None on a line that
    has none.

    Two lines lie outside each end, and two in each segment.
    """
    lines = []
    for wave in solution.fields.motion.lines:
        if wave:
            values = factor * wave.values
            lines.append((wave.ticks.tolist(), values.tolist()))
        else:
            lines.append(None)
    return lines


@given(SEEDS)
def test_forces_and_gaps_are_never_negative_and_one_of_them_is_0_at_every_event(seed):
    """At all breakpoints of the contacts of a random row, force and gap are at least 0,
    and their product is 0.
    """
    system = random_system(seed, bonded=False)
    solution = run(system)
    for contact in solution.contacts:
        _, force, gap = contact.breakpoints()
        assert (force >= 0).all()
        assert (gap >= 0).all()
        product = force * gap
        assert (product == 0).all()


@given(SEEDS)
def test_totals_of_contacts_agree_with_their_signals(seed):
    """Impulse, duration, peak force and number of episodes are those of the breakpoints
    of a random run.
    """
    solution = run(random_system(seed))
    t_end = solution.t_end
    totals = solution.outcome.contacts
    for contact, total in zip(solution.contacts, totals, strict=True):
        times, force, _ = contact.breakpoints()
        ends = np.append(times[1:], t_end)  # each force lasts until the next
        spans = ends - times
        scale = np.sum(np.abs(force) * spans)
        impulse = contact.impulse_until(t_end)
        round_off = 1e-12 * scale
        assert impulse == pytest.approx(total.impulse, rel=1e-12, abs=round_off)
        if isinstance(contact.law, ri.Rigid):
            duration = spans[force > 0].sum()
            expected = total.duration
            round_off = 1e-12 * t_end
            assert duration == pytest.approx(expected, rel=1e-12, abs=round_off)
            assert force.max() == total.peak_force
            assert len(contact.episodes) == total.episodes
        else:
            assert contact.episodes == ()  # a bond has none


@given(SEEDS)
def test_velocities_after_are_those_of_the_centres_of_mass(seed):
    """In a random row, each velocity after is the mean velocity of its body at the end
    of the run.
    """
    system = random_system(seed, bonded=False)
    solution = run(system)
    for body, velocity in enumerate(solution.outcome.velocities_after):
        mean = float(solution.mean_velocity(body, solution.t_end))
        assert mean == pytest.approx(velocity, abs=1e-11)


@any_row
@given(SEEDS)
def test_nothing_touches_after_the_proof_of_finality(row, seed):
    """Rigid contacts of a run that goes on long after the proof do not begin again, and
    those that press on do so with a steady force.
    """
    system = row(seed, bodies=4)
    is_rigid = [isinstance(law, ri.Rigid) for law in system.contacts]
    assume(any(is_rigid))
    solution = ri.solve(system, method="fronts", max_events=CAP)
    assume(solution.final)
    much_later = 4 * solution.t_end + horizon(system, 30)

    longer = ri.solve(system, much_later, method="fronts", max_events=10 * CAP)

    just_after_proof = solution.t_proved * (1 + 1e-9)
    for contact in longer.contacts:
        if not isinstance(contact.law, ri.Rigid):
            continue
        for episode in contact.episodes:
            assert episode.start <= just_after_proof
        times, force, _ = contact.breakpoints()
        forces_after_proof = force[times > just_after_proof]
        last_force = force[-1]
        assert (forces_after_proof == last_force).all()


@any_row
@given(SEEDS)
def test_waves_of_a_mirror_image_are_exactly_mirrored(row, seed):
    """Lengths in sixteenths, so that positions measured from the other end are exact
    too.
    """
    system = row(seed, unit=1 / 16)
    solution = run(system)
    assume(solution.stopped_by == "until")

    mirrored_system = system.mirrored()
    image = ri.solve(mirrored_system, solution.t_end, max_events=CAP)

    # The lines from the left end on are those of the image from its right end on.
    lines = waves(solution)[2:]
    image_lines = waves(image, factor=-1.0)[2:]
    impulses = [total.impulse for total in solution.outcome.contacts]
    image_impulses = [total.impulse for total in image.outcome.contacts]
    assert image.stopped_by == "until"
    assert image_lines[::-1] == lines
    mirrored_impulses = image_impulses[::-1]
    assert mirrored_impulses == pytest.approx(impulses, rel=1e-14)


def rescaled_profile(profile, length, velocity):
    """A profile with values times `velocity` and, for steps, positions times `length`."""
    if isinstance(profile, ri.Steps):
        values = [velocity * value for value in profile.values]
        places = [length * place for place in profile.at]
        return ri.Steps(values, places)
    return velocity * profile


def rescaled(system, length=1.0, area=1.0, velocity=1.0, modulus=1.0, density=1.0):
    """The system with all numbers of these kinds multiplied by these factors.

    Strains are multiplied as velocities are, and gaps as lengths and velocities.
    """

    def rescaled_segment(segment):
        material = segment.material
        material = material.replace(
            youngs_modulus=modulus * material.youngs_modulus,
            density=density * material.density,
        )
        return segment.replace(
            length=length * segment.length,
            area=area * segment.area,
            material=material,
        )

    bodies = []
    for body in system.bodies:
        if isinstance(body, ri.Wall):
            wall = ri.Wall(velocity * body.velocity)
            bodies.append(wall)
            continue
        segments = [rescaled_segment(segment) for segment in body.segments]
        rod = ri.Rod(
            segments=segments,
            velocity=rescaled_profile(body.velocity, length, velocity),
            strain=rescaled_profile(body.strain, length, velocity),
        )
        bodies.append(rod)
    gaps = [length * velocity * gap for gap in system.gaps]
    return system.replace(bodies=bodies, gaps=gaps)


@given(SEEDS)
def test_numbers_scaled_by_powers_of_two_scale_waves_and_times_exactly(seed):
    """Lengths, areas, velocities, moduli and densities of a random row are scaled in
    turn.
    """
    system = random_system(seed, bodies=4)
    until = horizon(system, 10)
    reference = ri.solve(system, until, max_events=CAP)
    assume(reference.stopped_by == "until")

    def assert_scales(scaled, time=1.0, factor=1.0):
        """In `time` times the time, waves are `factor` times as large, and have the
        same ticks, since the ticks are as many times as long.
        """
        solution = ri.solve(scaled, until * time)
        assert waves(solution) == waves(reference, factor)

    # Times go as length/sqrt(modulus/density).
    assert_scales(rescaled(system, length=4.0), time=4.0)
    assert_scales(rescaled(system, area=0.5))
    assert_scales(rescaled(system, velocity=2.0), factor=2.0)
    assert_scales(rescaled(system, modulus=4.0, density=4.0))
    # Another wave speed leaves velocities and gaps, but not those that strains make.
    rods = [body for body in system.bodies if isinstance(body, ri.Rod)]
    is_strained = any(rod.strain != 0.0 for rod in rods)
    has_gaps = any(gap != 0 for gap in system.gaps)
    if not is_strained and not has_gaps:
        assert_scales(rescaled(system, modulus=4.0), time=0.5)
        assert_scales(rescaled(system, density=4.0), time=2.0)


def split(system, i):
    """The system with the first segment of body i cut into two bonded halves."""
    rod = system.bodies[i]
    first, *others = rod.segments
    half = first.replace(length=first.length / 2)
    left = rod.replace(segments=[half])
    right = rod.replace(segments=[half, *others])
    bodies = list(system.bodies)
    bodies[i : i + 1] = [left, right]  # in place of the rod
    gaps = list(system.gaps)
    gaps.insert(i, 0.0)
    contacts = list(system.contacts)
    contacts.insert(i, ri.Bonded())
    return ri.System(bodies, gaps, contacts)


@given(SEEDS)
def test_a_rod_that_is_cut_and_bonded_again_moves_as_before(seed):
    """Velocities after are those of the whole rod; only rods without steps of state are
    cut.
    """
    system = random_system(seed, bodies=4)
    is_rod = [isinstance(body, ri.Rod) for body in system.bodies]
    i = is_rod.index(True)  # the first one
    rod = system.bodies[i]
    assume(not isinstance(rod.velocity, ri.Steps))
    assume(not isinstance(rod.strain, ri.Steps))

    whole = run(system, transits=6.0)
    cut_system = split(system, i)
    in_halves = ri.solve(cut_system, whole.t_end, max_events=2 * CAP)

    velocities = list(in_halves.outcome.velocities_after)
    del velocities[i]  # that of one half; the other has the same
    expected = whole.outcome.velocities_after
    assert velocities == pytest.approx(expected, abs=1e-11)


@any_row
@given(SEEDS, st.floats(0.05, 0.95))
def test_a_run_from_a_state_in_between_ends_with_the_same_velocities(row, seed, part):
    """The run is cut after this `part` of its time."""
    system = row(seed, bodies=4)
    until = horizon(system, 8)
    whole = ri.solve(system, until, max_events=CAP)
    assume(whole.stopped_by == "until")
    pause = part * until

    state = whole.system_at(pause)
    second_part = ri.solve(state, until - pause, max_events=2 * CAP)

    end = second_part.t_end
    for body in range(len(system.bodies)):
        velocity = float(second_part.mean_velocity(body, end))
        expected = float(whole.mean_velocity(body, until))
        assert velocity == pytest.approx(expected, abs=1e-10)


@given(SEEDS)
def test_the_film_backwards_comes_to_the_reversed_velocities_without_vibration(seed):
    """Rods without vibration collide; their state at the end is reversed and run for
    the same time.
    """
    system = random_system(
        seed, bodies=4, moving_walls=False, vibrating=False, bonded=False
    )
    forward = ri.solve(system, max_events=CAP // 4)
    n_episodes = [len(contact.episodes) for contact in forward.contacts]
    assume(forward.final and any(n_episodes))
    # Gaps that closed at times that were rounded close a little earlier or later.
    vibration_rtol = 1e-13
    for gap, n in zip(system.gaps, n_episodes, strict=True):
        closed_after_a_gap = (gap > 0 and n > 0) or n > 1
        if closed_after_a_gap:
            vibration_rtol = 1e-9

    end = forward.system_at(forward.t_end)
    reversed_end = end.reversed()
    back = ri.solve(reversed_end, forward.t_end, max_events=CAP)

    for body, velocity in enumerate(forward.outcome.velocities_before):
        reached = float(back.mean_velocity(body, back.t_end))
        assert reached == pytest.approx(-velocity, abs=1e-9)
    vibration = sum(back.outcome.vibration_after)
    assert vibration <= vibration_rtol * forward.outcome.kinetic_before


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
@pytest.mark.parametrize("row", [random_system, with_ends])
@pytest.mark.parametrize("count", few_of([30, 150], [30]))
def test_compiled_and_interpreted_runs_are_bit_identical(row, count):
    for seed in range(count):
        system = row(seed, bodies=4)
        until = horizon(system, transits=4)
        plain = bits_of(system, until, compiling=False)
        compiled = bits_of(system, until, compiling=True)
        assert plain == compiled
