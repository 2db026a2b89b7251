"""What must hold for every row, whatever is in it."""

from functools import partial

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from runs import bits_of
from systems import horizon, random_system, with_ends

import rodimpact as ri
from rodimpact.methods import kernels

seeds = st.integers(0, 10**6)
CAP = 20_000
any_row = pytest.mark.parametrize(
    "row",
    [random_system, partial(with_ends, driven=False)],
    ids=["free ends", "any ends"],
)


def run(system, transits=15.0):
    return ri.solve(system, until=horizon(system, transits), max_events=CAP)


def waves(solution, sign=1.0):
    lines = solution.fields.motion.lines
    return [w and (w.ticks.tolist(), (sign * w.values).tolist()) for w in lines]


@given(seeds)
def test_signorini_holds_at_every_event(seed):
    for contact in run(random_system(seed, bonded=False)).contacts:
        _, force, gap = contact.breakpoints()
        assert (force >= 0).all()
        assert (gap >= 0).all()
        assert (force * gap == 0).all()


@given(seeds)
def test_tallies_agree_with_the_signals(seed):
    solution = run(random_system(seed))
    t = solution.t_end
    for contact, tally in zip(
        solution.contacts, solution.outcome.contacts, strict=True
    ):
        times, force, _ = contact.breakpoints()
        spans = np.diff(np.append(times, t))
        scale = np.sum(np.abs(force) * spans)
        expected = pytest.approx(tally.impulse, rel=1e-12, abs=1e-12 * scale)
        assert contact.impulse_until(t) == expected
        if isinstance(contact.law, ri.Rigid):
            assert force.max() == tally.peak_force
            assert spans[force > 0].sum() == pytest.approx(
                tally.duration, rel=1e-12, abs=1e-12 * t
            )
            assert len(contact.episodes) == tally.episodes
        else:
            assert contact.episodes == ()
    for body, velocity in enumerate(solution.outcome.velocities_after):
        if not any(isinstance(c, ri.Bonded) for c in solution.system.contacts):
            assert float(solution.mean_velocity(body, t)) == pytest.approx(
                velocity, abs=1e-11
            )


@any_row
@given(seeds)
def test_nothing_touches_after_the_proof_of_finality(row, seed):
    system = row(seed, bodies=4)
    assume(any(isinstance(law, ri.Rigid) for law in system.contacts))
    solution = ri.solve(system, method="fronts", max_events=CAP)
    assume(solution.final)
    far = 4 * solution.t_end + horizon(system, 30)
    longer = ri.solve(system, far, "fronts", max_events=10 * CAP)
    just_after = solution.t_proved * (1 + 1e-9)
    for contact in longer.contacts:
        if isinstance(contact.law, ri.Rigid):
            assert all(episode.start <= just_after for episode in contact.episodes)
            times, force, _ = contact.breakpoints()
            steady = force[-1]
            assert (force[times > just_after] == steady).all()


@any_row
@given(seeds)
def test_mirror_is_exact(row, seed):
    """Lengths in sixteenths, so that positions measured from the other end are exact too."""
    system = row(seed, unit=1 / 16)
    solution = run(system)
    assume(solution.stopped_by == "until")
    mirrored = ri.solve(system.mirrored(), solution.t_end, max_events=CAP)
    assert mirrored.stopped_by == "until"
    lines = waves(solution)
    images = waves(mirrored, -1.0)
    last = len(lines) + 1
    assert all(lines[i] == images[last - i] for i in range(2, len(lines)))
    impulses = [c.impulse for c in solution.outcome.contacts]
    images = [c.impulse for c in mirrored.outcome.contacts][::-1]
    assert impulses == pytest.approx(images, rel=1e-14)


def rescaled(system, length=1.0, area=1.0, velocity=1.0, modulus=1.0, density=1.0):
    def profile(p):
        if isinstance(p, ri.Steps):
            return ri.Steps(
                [velocity * v for v in p.values], [length * x for x in p.at]
            )
        return velocity * p

    def segment(s):
        m = s.material
        m = m.replace(
            youngs_modulus=modulus * m.youngs_modulus, density=density * m.density
        )
        return s.replace(length=length * s.length, area=area * s.area, material=m)

    bodies = [
        b.replace(velocity=velocity * b.velocity)
        if isinstance(b, ri.Wall)
        else ri.Rod(
            segments=[segment(s) for s in b.segments],
            velocity=profile(b.velocity),
            strain=profile(b.strain),
        )
        for b in system.bodies
    ]
    return system.replace(
        bodies=bodies, gaps=[length * velocity * g for g in system.gaps]
    )


@given(seeds)
def test_scaling_by_powers_of_two_is_exact(seed):
    system = random_system(seed, bodies=4)
    until = horizon(system, 10)
    reference = ri.solve(system, until, max_events=CAP)
    assume(reference.stopped_by == "until")

    def same(scaled, time=1.0, factor=1.0):
        other = ri.solve(scaled, until * time)
        return waves(other) == [
            w and (w[0], [factor * v for v in w[1]]) for w in waves(reference)
        ]

    assert same(rescaled(system, length=4.0), time=4.0)
    assert same(rescaled(system, area=0.5))
    assert same(rescaled(system, velocity=2.0), factor=2.0)
    assert same(rescaled(system, modulus=4.0, density=4.0))
    if all(g == 0 for g in system.gaps):
        unstrained = all(
            b.strain == 0.0 for b in system.bodies if isinstance(b, ri.Rod)
        )
        if unstrained:
            assert same(rescaled(system, modulus=4.0), time=0.5)
            assert same(rescaled(system, density=4.0), time=2.0)


@given(seeds)
def test_bonded_split_changes_nothing(seed):
    system = random_system(seed, bodies=4)
    i = next(k for k, b in enumerate(system.bodies) if isinstance(b, ri.Rod))
    rod = system.bodies[i]
    assume(
        not isinstance(rod.velocity, ri.Steps) and not isinstance(rod.strain, ri.Steps)
    )
    first = rod.segments[0]
    half = ri.Segment(first.length / 2, first.area, first.material)
    parts = [
        ri.Rod(segments=[half], velocity=rod.velocity, strain=rod.strain),
        ri.Rod(
            segments=[half, *rod.segments[1:]], velocity=rod.velocity, strain=rod.strain
        ),
    ]
    split = ri.System(
        [*system.bodies[:i], *parts, *system.bodies[i + 1 :]],
        [*system.gaps[:i], 0.0, *system.gaps[i:]],
        [*system.contacts[:i], ri.Bonded(), *system.contacts[i:]],
    )
    whole = run(system, 6.0)
    pieces = ri.solve(split, whole.t_end, max_events=2 * CAP)
    velocities = list(pieces.outcome.velocities_after)
    del velocities[i]
    assert velocities == pytest.approx(whole.outcome.velocities_after, abs=1e-11)


@any_row
@given(seeds, st.floats(0.05, 0.95))
def test_a_state_can_be_continued(row, seed, part):
    system = row(seed, bodies=4)
    until = horizon(system, 8)
    whole = ri.solve(system, until, max_events=CAP)
    assume(whole.stopped_by == "until")
    t = part * until
    rest = ri.solve(whole.system_at(t), until - t, max_events=2 * CAP)
    for body in range(len(system.bodies)):
        there = float(rest.mean_velocity(body, rest.t_end))
        assert there == pytest.approx(
            float(whole.mean_velocity(body, until)), abs=1e-10
        )


@given(seeds)
def test_the_film_runs_backwards(seed):
    system = random_system(
        seed, bodies=4, moving_walls=False, vibrating=False, bonded=False
    )
    forward = ri.solve(system, max_events=CAP // 4)
    assume(forward.final and any(contact.episodes for contact in forward.contacts))
    back = ri.solve(
        forward.system_at(forward.t_end).reversed(), forward.t_end, max_events=CAP
    )
    energy = forward.outcome.kinetic_before
    for body, velocity in enumerate(forward.outcome.velocities_before):
        assert float(back.mean_velocity(body, back.t_end)) == pytest.approx(
            -velocity, abs=1e-9
        )
    met_later = any(
        (gap > 0 and contact.episodes) or len(contact.episodes) > 1
        for gap, contact in zip(system.gaps, forward.contacts, strict=True)
    )
    vibration = sum(back.outcome.vibration_after)
    assert vibration <= (1e-9 if met_later else 1e-13) * energy


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
@pytest.mark.parametrize(("row", "count"), [(random_system, 150), (with_ends, 50)])
def test_compiled_and_interpreted_runs_are_bit_identical(row, count):
    for seed in range(count):
        system = row(seed, bodies=4)
        plain, fast = (
            bits_of(system, horizon(system, 4), how) for how in (False, True)
        )
        assert plain == fast
