"""The exact solver against brute force in fractions.

The reference shares the physics with the solver and nothing else: time and waves are
rational, so that there is no rounding, no tolerance and no tick; it has no queue, and
whenever a wave arrives or a gap closes anywhere, every end of the row is solved anew.
"""

import random
from bisect import bisect_right
from fractions import Fraction
from itertools import pairwise

import pytest
from exhaustive import few_of

import rodimpact as ri

SEEDS = range(100)
TOLERANCE = 1e-9  # relative, and absolute near 0


class Signal:
    """A step function of rational time, continuous from the right."""

    def __init__(self):
        self.times = []
        self.values = []

    def set_from(self, t, value):
        """Take on a value from time t on, which is later than all before."""
        if not self.values or value != self.values[-1]:
            self.times.append(t)
            self.values.append(value)

    def at(self, t):
        """Value at time t; before the first time the first value."""
        begun = bisect_right(self.times, t)
        return self.values[max(0, begun - 1)]

    def next_jump(self, t):
        """The first time after t at which it jumps, in a list; or an empty list."""
        begun = bisect_right(self.times, t)
        return self.times[begun : begun + 1]

    def integral(self, start, stop):
        """Integral from `start` to `stop`, exactly."""
        inside = [t for t in self.times if start < t < stop]
        total = Fraction(0)
        for begin, end in pairwise([start, *inside, stop]):
            total += (end - begin) * self.at(begin)
        return total


class Segment:
    """A uniform segment: wave a leaves its left end, wave b its right end.

    c, T and Z are its wave speed, transit time and impedance. The velocity is the mean
    of a and b, the strain (b - a)/(2 c).
    """

    def __init__(self, segment):
        """Wave speed, transit time and impedance of a segment in fractions, with empty
        signals of both waves. The wave speed must be exact.
        """
        density = Fraction(segment.material.density)
        c = Fraction(segment.wave_speed)
        assert c * c * density == segment.material.youngs_modulus  # no rounding
        self.c = c
        self.T = Fraction(segment.length) / c
        self.Z = density * Fraction(segment.area) * c
        self.a = Signal()
        self.b = Signal()

    def fill(self, state, left):
        """Make the state at t = 0 the history of the end signals; `left` is the left
        end's x.
        """
        right = left + self.c * self.T
        cuts = sorted(x - left for x in state.cuts if left < x < right)
        edges = [Fraction(0), *(x / self.c for x in cuts), self.T]
        parts = list(pairwise(edges))  # in transit time from the left end
        # The wave b that is at t0 from the left end now left the right end at t0 - T.
        for t0, t1 in parts:
            middle = left + self.c * (t0 + t1) / 2
            velocity, strain = state(middle)
            self.b.set_from(t0 - self.T, velocity + self.c * strain)
        # The wave a that is at t1 now left the left end at -t1: the farthest first.
        for t0, t1 in reversed(parts):
            middle = left + self.c * (t0 + t1) / 2
            velocity, strain = state(middle)
            self.a.set_from(-t1, velocity - self.c * strain)


class InitialState:
    """Initial velocity and strain as functions of x; `cuts` are the positions of their
    jumps.
    """

    def __init__(self, rod):
        """Keep the velocity and the strain of a rod as steps, and in `cuts` the exact
        positions of both.
        """
        self.velocity = self.as_steps(rod.velocity)
        self.strain = self.as_steps(rod.strain)
        places = [*self.velocity.at, *self.strain.at]
        self.cuts = {Fraction(x) for x in places}

    @staticmethod
    def as_steps(profile):
        """A profile as it is, or a number as `Steps` without a jump."""
        if isinstance(profile, ri.Steps):
            return profile
        return ri.Steps([profile], at=[])

    def __call__(self, x):
        """Velocity and strain at x, as exact fractions; at a jump, those on its right."""
        step_of_velocity = bisect_right(self.velocity.at, x)
        velocity = self.velocity.values[step_of_velocity]
        step_of_strain = bisect_right(self.strain.at, x)
        strain = self.strain.values[step_of_strain]
        return Fraction(velocity), Fraction(strain)


class Reference:
    """The row of bodies as segments and, between and beyond them, nodes with a law."""

    def __init__(self, system):
        """Nodes, laws, gaps and segments of a row of rods and walls at time 0, in
        fractions; no force has acted yet.
        """
        self.t = Fraction(0)
        self.segments = []
        self.laws = []  # of nodes: "free", "bonded" or "rigid"
        self.first = []  # first segment of each body
        self.wall = {}  # velocity of walls by their node
        self.presses = []  # times at which a force begins anywhere
        laws_after = [*(contact.law for contact in system.contacts), "free"]
        if isinstance(system.bodies[0], ri.Rod):
            self.laws.append("free")
        for body, law in zip(system.bodies, laws_after, strict=True):
            self.first.append(len(self.segments))
            if isinstance(body, ri.Wall):
                self.wall[len(self.segments)] = Fraction(body.velocity)
            else:
                self.add_rod(body)
            if len(self.laws) <= len(self.segments):
                self.laws.append(law)
        # The node of contact i is the one left of body i + 1.
        self.contacts = self.first[1:]
        count = len(self.laws)
        self.gap = [Fraction(0)] * count
        for k, gap in zip(self.contacts, system.gaps, strict=True):
            self.gap[k] = Fraction(gap)
        self.rate = [Fraction(0)] * count  # of the gap
        self.force = [Fraction(0)] * count
        self.impulse = [Fraction(0)] * count
        self.pressed = [Fraction(0)] * count  # duration of forces

    def add_rod(self, rod):
        """Append the segments of a rod, which are bonded to each other."""
        left = Fraction(0)
        state = InitialState(rod)
        for part in rod.segments:
            segment = Segment(part)
            segment.fill(state, left)
            left += Fraction(part.length)
            self.segments.append(segment)
        self.laws += ["bonded"] * (len(rod.segments) - 1)

    def solve(self, k):
        """Let the waves that arrive at node k now meet, by its law.

        On the side of a wall the wave is the velocity of the wall, without mobility.
        """
        a = self.wall.get(k)  # from the left
        b = self.wall.get(k)  # from the right
        mobility = Fraction(0)
        left = None
        right = None
        if k > 0:
            left = self.segments[k - 1]
            a = left.a.at(self.t - left.T)
            mobility += 1 / left.Z
        if k < len(self.segments):
            right = self.segments[k]
            b = right.b.at(self.t - right.T)
            mobility += 1 / right.Z
        F = Fraction(0)
        rate = Fraction(0)
        if self.laws[k] == "bonded":
            F = (a - b) / mobility
        elif self.laws[k] == "rigid" and self.gap[k] > 0:
            rate = b - a
        elif self.laws[k] == "rigid":
            F = max((a - b) / mobility, Fraction(0))
            rate = max(b - a, Fraction(0))
            if F > 0 and self.force[k] == 0:
                self.presses.append(self.t)
        self.force[k] = F
        self.rate[k] = rate
        if left:
            left.b.set_from(self.t, a - 2 * F / left.Z)
        if right:
            right.a.set_from(self.t, b + 2 * F / right.Z)

    def next_time(self, until):
        """Time, a fraction, at which the next wave arrives or the next gap closes,
        `until` at the latest.
        """
        times = [until]
        for segment in self.segments:
            left = self.t - segment.T  # when a wave left that arrives now
            jumps = [*segment.a.next_jump(left), *segment.b.next_jump(left)]
            for jump in jumps:
                times.append(jump + segment.T)
        for gap, rate in zip(self.gap, self.rate, strict=True):
            if gap > 0 > rate:
                times.append(self.t - gap / rate)
        return min(times)

    def run(self, until, cap=1500):
        """Follow the row until t = `until`, exactly; False, and no further, if that
        takes more than `cap` events.
        """
        for _ in range(cap):
            for k in range(len(self.laws)):
                self.solve(k)
            t = self.next_time(until)
            duration = t - self.t
            for k, F in enumerate(self.force):
                self.gap[k] += self.rate[k] * duration
                self.impulse[k] += F * duration
                if F > 0:
                    self.pressed[k] += duration
            self.t = t
            if t == until:
                return True
        return False

    def state(self, index, part, t):
        """Velocity and strain in segment `index`, at `part` of its length from its left
        end, at time t.
        """
        segment = self.segments[index]
        a = segment.a.at(t - part * segment.T)
        b = segment.b.at(t - (1 - part) * segment.T)
        return (a + b) / 2, (b - a) / (2 * segment.c)

    def mean_velocity(self, first, last):
        """Mean velocity, by mass, of the segments from `first` to `last` - 1 at the
        present time.
        """
        momentum = Fraction(0)
        mass = Fraction(0)
        for segment in self.segments[first:last]:
            for wave in (segment.a, segment.b):
                under_way = wave.integral(self.t - segment.T, self.t)
                momentum += segment.Z * under_way / 2
            mass += segment.Z * segment.T
        return momentum / mass


def random_row(seed):
    """A row whose transit times, impedances and velocities are small whole numbers, and
    whose gaps are dyadic; and the generator that made it, for further random numbers.
    """
    pick = random.Random(seed)
    impedances = pick.choice([(1,), (1, 2, 3, 5), (1, 7, 50), (2, 3)])
    longest = pick.choice([3, 6, 12])
    n_rods = [1, 2, 2, 3, 4, 5]
    bodies = []
    for _ in range(pick.choice(n_rods)):
        bodies.append(random_rod(pick, impedances, longest))
    if pick.random() < 0.4:
        bodies.insert(0, ri.Wall(pick.choice([0, 0, 1, -1])))
    if pick.random() < 0.4 or len(bodies) == 1:
        bodies.append(ri.Wall(pick.choice([0, 0, 1, -1])))
    laws = []
    for _ in bodies[1:]:
        laws.append(ri.Bonded() if pick.random() < 0.12 else ri.Rigid())
    gaps = []
    for law in laws:
        gap = 0
        if isinstance(law, ri.Rigid) and pick.random() < 0.5:
            gap = pick.randint(1, 12) / pick.choice([1, 4, 64])
        gaps.append(gap)
    return ri.System(bodies, gaps=gaps, contacts=laws), pick


def random_segment(pick, impedances, longest):
    """A segment with one of these impedances and a transit time up to the longest."""
    c = pick.choice([1, 1, 2])
    T = pick.randint(1, longest)
    material = ri.Material("m", youngs_modulus=float(c * c), density=1.0)
    return ri.Segment(float(c * T), area=pick.choice(impedances) / c, material=material)


def random_rod(pick, impedances, longest):
    """A rod that moves; some have steps of velocity and strain."""
    segments = []
    for _ in range(pick.choice([1, 1, 1, 2, 3])):
        segments.append(random_segment(pick, impedances, longest))
    if pick.random() >= 0.3:
        return ri.Rod(segments=segments, velocity=pick.randint(-3, 3))
    length = int(sum(segment.length for segment in segments))
    jumps = pick.randint(0, min(2, length - 1))
    places = sorted(pick.sample(range(1, length), jumps))
    velocities = [pick.randint(-3, 3) for _ in range(jumps + 1)]
    strains = [pick.randint(-2, 2) for _ in range(jumps + 1)]
    return ri.Rod(
        segments=segments,
        velocity=ri.Steps(velocities, at=places),
        strain=ri.Steps(strains, at=places),
    )


def near(exact):
    """Equal to an exact number within `TOLERANCE`."""
    return pytest.approx(float(exact), rel=TOLERANCE, abs=TOLERANCE)


@pytest.mark.parametrize("seed", few_of(SEEDS, range(5)))
def test_contacts_motion_and_fields_agree_with_brute_force(seed):
    """Contacts, motion and fields of a random row are those of `Reference`; no force
    begins after the time at which `solve` says that the collision is over.
    """
    system, pick = random_row(seed)
    until = Fraction(pick.randint(10, 50)) + Fraction(1, 7)  # no wave arrives then
    reference = Reference(system)
    assert reference.run(until)  # within its cap on events

    solution = ri.solve(system, until=float(until))

    assert_contacts_agree(solution, reference)
    assert_motion_agrees(solution, reference)
    assert_fields_agree(solution, reference, pick)
    without_end = ri.solve(system, max_events=3000)
    if without_end.final:
        last_press = float(max(reference.presses, default=0))
        assert last_press <= without_end.t_final * (1 + TOLERANCE)


def assert_contacts_agree(solution, reference):
    """At the end of the run, impulse and gap of each contact, and of rigid ones the
    duration, are those of the reference.
    """
    for contact, k in zip(solution.contacts, reference.contacts, strict=True):
        assert contact.impulse == near(reference.impulse[k])
        assert float(contact.gap(solution.t_end)) == near(reference.gap[k])
        if isinstance(contact.law, ri.Rigid):
            assert contact.duration == near(reference.pressed[k])


def rods_of(system, reference):
    """Yield body index, index of its first segment, and rod, for each rod of a system."""
    for body, first in enumerate(reference.first):
        rod = system.bodies[body]
        if isinstance(rod, ri.Rod):
            yield body, first, rod


def assert_motion_agrees(solution, reference):
    """The mean velocity of each rod at the end of the run is that of the reference."""
    for body, first, rod in rods_of(solution.system, reference):
        velocity = float(solution.mean_velocity(body, solution.t_end))
        exact = reference.mean_velocity(first, first + len(rod.segments))
        assert velocity == near(exact)


def assert_fields_agree(solution, reference, pick):
    """Velocities and strains of a solution are those of the reference, at eight random
    positions and times in each segment.
    """
    for body, first, rod in rods_of(solution.system, reference):
        left = 0.0
        for i, segment in enumerate(rod.segments):
            for _ in range(8):
                part = pick.random()
                t = pick.random() * solution.t_end
                exact_state = reference.state(first + i, Fraction(part), Fraction(t))
                exact_velocity, exact_strain = exact_state
                x = left + part * segment.length
                velocity = float(solution.velocity(body, x, t))
                assert velocity == near(exact_velocity)
                strain = float(solution.strain(body, x, t))
                assert strain == near(exact_strain)
            left += segment.length


def test_many_random_rows_meet_again_come_to_an_end_and_touch_without_force():
    """So that comparisons with them show something. Some have bonds."""
    solutions = []
    for seed in SEEDS:
        system, _ = random_row(seed)
        solutions.append(ri.solve(system, until=50.0))
    contacts = []
    for solution in solutions:
        contacts.extend(solution.contacts)
    episodes = []
    for contact in contacts:
        episodes.extend(contact.episodes)
    n_meet_again = sum(len(contact.episodes) > 1 for contact in contacts)
    n_final = sum(solution.final for solution in solutions)
    assert n_meet_again > 0.2 * len(contacts)
    assert n_final > 0.4 * len(solutions)
    assert any(isinstance(contact.law, ri.Bonded) for contact in contacts)
    assert any(episode.force_end < episode.opening for episode in episodes)
