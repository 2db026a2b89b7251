"""Absorbing and driven ends, carried by the fronts themselves."""

import numpy as np
import pytest
from exhaustive import few_of
from hypothesis import assume, given
from hypothesis import strategies as st
from networks import unit_rod
from numpy.random import default_rng
from runs import group_of, tracked
from systems import horizon, random_end, random_system, with_ends

import rodimpact as ri

CAP = 20_000  # events
SEEDS = st.integers(0, 10**6)


def commensurate(seed):
    """Bonded rods with transit times of whole quarters of a second, with any ends."""
    rng = default_rng(seed)
    rods = []
    for _ in range(rng.integers(1, 4)):
        length = float(rng.integers(2, 9)) / 4
        middle = length / 2
        velocities = rng.uniform(-1, 1, 2)
        velocity = ri.Steps(velocities.tolist(), at=[middle])
        strains = rng.uniform(-1, 1, 2)
        strain = ri.Steps(strains.tolist(), at=[middle])
        area = float(rng.uniform(0.3, 3))
        rod = unit_rod(length, area=area, velocity=velocity, strain=strain)
        rods.append(rod)
    left = random_end(rng, rods[0], time=1.0, driven=True)
    right = random_end(rng, rods[-1], time=1.0, driven=True)
    n_bonds = len(rods) - 1
    bonds = [ri.Bonded()] * n_bonds
    return ri.System(rods, contacts=bonds, ends=(left, right))


# Against the other method
# --------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=few_of(range(30), range(3)))
def by_both_methods(request):
    """Solutions of a random row until 8 s, by fronts and by characteristics."""
    system = commensurate(request.param)
    fronts = ri.solve(system, until=8.0, method="fronts")
    pieces = ri.solve(system, until=8.0, method="characteristics")
    return fronts, pieces


def test_fields_by_fronts_are_those_by_characteristics(by_both_methods):
    """Velocities and strains agree at nine places of each rod and 128 times at which no
    front passes.
    """
    fronts, pieces = by_both_methods
    # Fronts pass the places below at multiples of 1/32 s, and drives jump at those of
    # 1/16 s: no front passes at these times.
    t = (np.arange(128) + 0.55) / 16
    for body, rod in enumerate(fronts.system.bodies):
        length = float(rod.length)
        x = np.linspace(0, length, 9)[:, None]
        velocity = fronts.velocity(body, x, t)
        velocity_error = velocity - pieces.velocity(body, x, t)
        assert np.abs(velocity_error).max() < 1e-9
        strain = fronts.strain(body, x, t)
        strain_error = strain - pieces.strain(body, x, t)
        assert np.abs(strain_error).max() < 1e-9


OUTCOMES = [
    "velocities_after",
    "velocities_before",
    "vibration_after",
    "radiated",
    "drive_work",
    "kinetic_after",
    "driven",
]


def test_the_outcome_by_fronts_is_that_by_characteristics(by_both_methods):
    """All entries named in `OUTCOMES` agree."""
    fronts, pieces = by_both_methods
    for name in OUTCOMES:
        value = getattr(fronts.outcome, name)
        expected = getattr(pieces.outcome, name)
        assert value == pytest.approx(expected, abs=1e-9), name


FAST = ri.Material("fast", youngs_modulus=4.0, density=1.0)  # wave speed 2
STRAINS = [-0.1, -0.3, 0.05, 0.0]  # of the wave that comes in
JUMPS = [0.25, 1.0, 1.5]  # times at which they change, s
BAR = ri.Rod(1.5, area=1.0, material=FAST, velocity=0.2)
STRUCK = ri.Rod(2.0, area=0.7, material=FAST)


def with_long_rod():
    """A rod with a wave in it, bonded to a bar that strikes another."""
    c = 2.0
    length = 6.0
    # What enters the bar first lies nearest to the right end of the rod.
    places = [length - c * t for t in reversed(JUMPS)]
    strain = ri.Steps(STRAINS[::-1], at=places)
    # A wave to the right has the velocity -c strain, beside that of the bar.
    velocities = [0.2 - c * value for value in strain.values]
    velocity = ri.Steps(velocities, at=places)
    rod = ri.Rod(length, area=1.0, material=FAST, strain=strain, velocity=velocity)
    laws = [ri.Bonded(), ri.Rigid()]
    return ri.System([rod, BAR, STRUCK], gaps=[0.0, 0.1], contacts=laws)


def with_incoming_wave():
    """The bar and the other, with the wave coming in through the end of the bar."""
    wave = ri.Steps(STRAINS, at=JUMPS)
    ends = (ri.Incoming(wave), ri.Free())
    return ri.System([BAR, STRUCK], gaps=[0.1], ends=ends)


@pytest.mark.parametrize("mirrored", few_of([False, True], [True]))
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_an_incoming_wave_is_that_of_a_long_rod(method, mirrored):
    """A wave that comes out of a long rod, and the same one that comes in through an
    end, drive a bar alike, which strikes another.
    """
    whole = with_long_rod()
    cut = with_incoming_wave()
    # Bodies 0 and 1 of the cut row are 1 and 2 of the whole one.
    bodies = [(1, 0), (2, 1)]  # in whole, in cut
    if mirrored:
        whole = whole.mirrored()
        cut = cut.mirrored()
        bodies = [(1, 1), (0, 0)]

    expected = ri.solve(whole, until=5.0, method=method)
    solution = ri.solve(cut, until=5.0, method=method)

    t = np.linspace(0.013, 4.95, 100)
    for body_of_whole, body in bodies:
        velocity = solution.velocity(body, 0.7, t)
        expected_velocity = expected.velocity(body_of_whole, 0.7, t)
        error = velocity - expected_velocity
        assert np.abs(error).max() < 1e-14
    impulse = solution.outcome.contacts[0].impulse
    expected_impulse = expected.outcome.contacts[0].impulse
    assert impulse == pytest.approx(expected_impulse)
    residual = solution.energy(t).residual
    assert np.abs(residual).max() < 1e-13


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_an_incoming_wave_brings_its_energy(method, mirrored):
    """An incoming wave counts as negative radiated energy: E A c times strain squared,
    over the time that the wave lasts; nothing has come back yet. Also mirrored.
    """
    system = with_incoming_wave()
    if mirrored:
        system = system.mirrored()
    at_rest = [body.replace(velocity=0.0) for body in system.bodies]
    durations = np.diff([0.0, *JUMPS])
    E = 4.0
    A = 1.0
    c = 2.0
    strains = np.array(STRAINS[:-1])  # the last one, 0, goes on for ever
    energy = E * A * c * np.sum(durations * strains**2)
    end = JUMPS[-1]  # of the wave

    system_at_rest = system.replace(bodies=at_rest)
    solution = ri.solve(system_at_rest, until=end, method=method)

    radiated = solution.energy(end).radiated
    assert radiated == pytest.approx(-energy, rel=1e-13)


# Forces
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", few_of(range(30), range(6)))
def test_the_peak_force_of_any_contact_is_the_largest_of_its_forces(seed):
    """Forces count that last for 2^-40 of the longest transit or longer; shorter ones
    are errors of rounding.
    """
    system = with_ends(seed)
    until = horizon(system, transits=4.0)

    solution = ri.solve(system, until=until, method="fronts", max_events=CAP)

    shortest = solution.fields.clock.longest_rod >> 40  # ticks
    totals = solution.outcome.contacts
    for contact, total in zip(solution.contacts, totals, strict=True):
        pushes = contact.push
        durations = np.diff(pushes.ticks, append=solution.fields.end)
        is_long = durations > shortest
        forces = pushes.values[is_long]
        largest = forces.max(initial=0.0)  # tension has no peak
        assert total.peak_force == pytest.approx(largest, rel=1e-9, abs=1e-9)


# Finality
# --------------------------------------------------------------------------------------


def random_vibrating_rod(seed):
    """A rod of the segments of a random row, with jumps of velocity and of strain."""
    system = random_system(seed, bodies=3, walls=False)
    segments = []
    for body in system.bodies:
        segments.extend(body.segments)
    length = sum(float(segment.length) for segment in segments)
    rng = default_rng(seed)
    velocities = rng.uniform(-1, 1, 2)
    strains = 1e-4 * rng.uniform(-1, 1, 2)
    velocity_jump = length * 0.3  # m
    strain_jump = length * 0.7
    velocity = ri.Steps(velocities.tolist(), at=[velocity_jump])
    strain = ri.Steps(strains.tolist(), at=[strain_jump])
    return ri.Rod(segments=segments, velocity=velocity, strain=strain)


@given(SEEDS, st.booleans(), st.booleans())
def test_an_end_stays_as_near_to_its_mean_motion_as_the_proof_bounds(
    seed, right, endless
):
    """A vibrating rod lies on the `right`, or the left, of a gap of 10 m. For 60
    transits, its end at the gap deviates from its mean motion by the bound of the proof
    at most. An `endless` rod, whose far end absorbs, comes to rest in its mean motion.
    """
    rod = random_vibrating_rod(seed)
    material = rod.segments[0].material
    far_end = ri.Absorbing() if endless else ri.Free()
    leaving = ri.Rod(0.1, area=1e-4, material=material, velocity=9.0)
    if right:
        leaving = leaving.replace(velocity=-9.0)
        ends = (ri.Free(), far_end)
        system = ri.System([leaving, rod], gaps=[10.0], ends=ends)
        x = 0.0
    else:
        ends = (far_end, ri.Free())
        system = ri.System([rod, leaving], gaps=[10.0], ends=ends)
        x = float(rod.length)
    run = tracked(system, until=0.0)
    motion = group_of(run, 0, right=right)
    clock = run.clock
    # In SI units: the proof has ticks, and the frame of the clock
    bound_in_ticks = np.sqrt(motion.deviation_bound_squared)
    bound = bound_in_ticks * clock.tick
    deviation_at_start = motion.end_deviation * clock.tick
    velocity = motion.mean_velocity + clock.frame

    until = horizon(system, transits=60.0)
    solution = ri.solve(system, until=until, max_events=10 * CAP)

    assume(solution.stopped_by == "until")
    t = np.linspace(0, until, 2000)
    body = int(right)  # the rod is body 1 if it lies on the right of the gap, else 0
    displacement = solution.displacement(body, x, t)
    change = displacement - displacement[0]
    mean_motion = velocity * t
    deviation = np.abs(deviation_at_start + change - mean_motion)
    round_off = 1e-12 * np.abs(displacement).max()
    largest_deviation = deviation.max()
    assert largest_deviation <= bound * (1 + 1e-9) + round_off
    if endless:
        late_deviation = deviation[t > 0.9 * until]
        assert late_deviation.max() <= 0.25 * bound + round_off


@pytest.mark.parametrize("area", [0.3, 1.0, 1.1, 2.0, 10.0])
def test_a_striker_on_an_endless_bar_comes_to_its_end(area):
    """A striker hits a bar whose far end absorbs: the collision is final with e = (1 -
    r)/(1 + r), r the ratio of the impedances of striker and bar, or 0 if r > 1.
    """
    striker = unit_rod(1.0, area=area, velocity=1e-3)
    endless_bar = unit_rod(0.5)  # its far end absorbs
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([striker, endless_bar], ends=ends)

    solution = ri.solve(system)

    assert solution.final
    assert "The collision is final" in solution.status
    ratio = area  # of impedances
    e = max(0.0, (1 - ratio) / (1 + ratio))
    restitution = solution.outcome.restitution
    assert restitution == pytest.approx(e, abs=1e-12)


# Times
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("trips", [1, 3, 40])
def test_a_drive_that_ends_as_a_wave_returns_leaves_no_sliver(trips):
    """The drive ends at the very tick of the wave, not a few ticks beside it.

    Transit times in aluminium and steel are in no whole ratio. The drive is timed by
    the aluminium.
    """
    materials = ri.materials
    aluminium = ri.Rod(0.3, area=1e-4, material=materials.aluminium)
    steel = ri.Rod(0.7, area=2e-4, material=materials.steel)
    round_trips = trips * 2 * float(aluminium.transit_time)
    force = ri.Steps([1e3, 0.0], at=[round_trips])
    ends = (ri.Pushed(force), ri.Absorbing())
    bonds = [ri.Bonded()]
    system = ri.System([aluminium, steel], contacts=bonds, ends=ends)

    solution = ri.solve(system, until=1.25 * round_trips)

    lines = solution.fields.motion.lines  # waves that leave ends
    transit_ticks = solution.fields.clock.ticks[1]  # of the aluminium
    end_of_push = trips * 2 * transit_ticks
    wave_into_steel = lines[2].ticks.tolist()
    assert end_of_push in wave_into_steel
    for wave in lines:
        if wave:
            intervals = np.diff(wave.ticks)  # between jumps of the wave
            longer_than_all = 2**63 - 1  # for a wave of one jump
            shortest = intervals.min(initial=longer_than_all)
            assert shortest > 2**20  # slivers have a few


def test_times_beyond_the_longest_transit_change_no_transit():
    """Lengths 0.3 and 0.1 stay 3 to 1, whatever the times of the drive are."""
    rods = [unit_rod(0.3), unit_rod(0.1)]
    times = [0.1 * np.pi, 7.0, 1e3]  # s
    force = ri.Steps([0.0, 1.0, 2.0, 3.0], at=times)
    ends = (ri.Pushed(force), ri.Free())
    system = ri.System(rods, ends=ends)

    run = tracked(system, until=50.0)

    _, first, second, _ = run.clock.ticks
    assert first == 3 * second
    assert run.clock.transit_error < 1e-15
    log = run.log[: run.run.initial_rows]
    drive = log[log["line"] == 0]
    values = drive["value"].tolist()
    assert values[0] == 0.0
    _, t1, t2 = drive["tick"].tolist()  # the last jump, at 1000 s, is never reached
    time_of_t1 = t1 * run.clock.tick
    assert time_of_t1 == pytest.approx(0.1 * np.pi, rel=1e-14)
    assert 3 * t2 == 70 * first  # 7 s are 70/3 of 0.3 s
