"""The exact solver against brute force in fractions.

The reference shares the physics with the solver and nothing else: time and waves are rational, so
that there is no rounding, no tolerance and no tick; it has no queue, and whenever a wave arrives or
a gap closes anywhere, every end of the row is solved anew.
"""

import random
from bisect import bisect_right
from fractions import Fraction
from itertools import pairwise

import pytest
from exhaustive import few_of

import rodimpact as ri

SEEDS = range(100)
EXACT = 1e-9


class Signal:
    """A step function of rational time, continuous from the right."""

    def __init__(self):
        self.times = []
        self.values = []

    def send(self, t, value):
        if not self.values or value != self.values[-1]:
            self.times.append(t)
            self.values.append(value)

    def at(self, t):
        return self.values[max(0, bisect_right(self.times, t) - 1)]

    def after(self, t):
        return self.times[bisect_right(self.times, t) :][:1]

    def integral(self, start, stop):
        inside = [t for t in self.times if start < t < stop]
        return sum(
            (t1 - t0) * self.at(t0) for t0, t1 in pairwise([start, *inside, stop])
        )


class Piece:
    """A uniform segment: wave a leaves its left end, wave b its right end."""

    def __init__(self, segment):
        c = Fraction(segment.wave_speed)
        assert (
            c * c * Fraction(segment.material.density)
            == segment.material.youngs_modulus
        )
        self.c = c
        self.T = Fraction(segment.length) / c
        self.Z = Fraction(segment.material.density) * Fraction(segment.area) * c
        self.a = Signal()
        self.b = Signal()

    def fill(self, state, left):
        """Make the state at t = 0 the history of the end signals; `left` is the left end's x."""
        cuts = sorted(x - left for x in state.cuts if left < x < left + self.c * self.T)
        edges = [0, *(x / self.c for x in cuts), self.T]
        for t0, t1 in pairwise(edges):
            velocity, strain = state(left + self.c * (t0 + t1) / 2)
            self.b.send(t0 - self.T, velocity + self.c * strain)
        for t0, t1 in reversed(list(pairwise(edges))):
            velocity, strain = state(left + self.c * (t0 + t1) / 2)
            self.a.send(-t1, velocity - self.c * strain)


class InitialState:
    """Velocity and strain along a rod."""

    def __init__(self, rod):
        self.profiles = [
            p if isinstance(p, ri.Steps) else ri.Steps([p], [])
            for p in (rod.velocity, rod.strain)
        ]
        self.cuts = {Fraction(x) for p in self.profiles for x in p.at}

    def __call__(self, x):
        return [Fraction(p.values[bisect_right(p.at, x)]) for p in self.profiles]


class Reference:
    """The row of bodies as pieces and, between and beyond them, joints."""

    def __init__(self, system):
        self.t = Fraction(0)
        self.pieces = []
        self.joints = []
        self.first = []
        self.wall = {}
        laws = [*(law.law for law in system.contacts), "free"]
        if isinstance(system.bodies[0], ri.Rod):
            self.joints.append("free")
        for body, law in zip(system.bodies, laws, strict=True):
            self.first.append(len(self.pieces))
            if isinstance(body, ri.Wall):
                self.wall[len(self.pieces)] = Fraction(body.velocity)
            else:
                left = Fraction(0)
                state = InitialState(body)
                for segment in body.segments:
                    piece = Piece(segment)
                    piece.fill(state, left)
                    left += Fraction(segment.length)
                    self.pieces.append(piece)
                self.joints += ["bonded"] * (len(body.segments) - 1)
            if len(self.joints) <= len(self.pieces):
                self.joints.append(law)
        # the joint of contact i is the one left of body i + 1
        self.contacts = self.first[1:]
        count = len(self.joints)
        self.gap = [Fraction(0)] * count
        for k, gap in zip(self.contacts, system.gaps, strict=True):
            self.gap[k] = Fraction(gap)
        self.rate = [Fraction(0)] * count
        self.force = [Fraction(0)] * count
        self.impulse = [Fraction(0)] * count
        self.pressed = [Fraction(0)] * count
        self.presses = []

    def solve(self, k):
        """Let the waves that arrive at joint k now meet, by the law of the joint."""
        left = self.pieces[k - 1] if k > 0 else None
        right = self.pieces[k] if k < len(self.pieces) else None
        a = left.a.at(self.t - left.T) if left else self.wall.get(k)
        b = right.b.at(self.t - right.T) if right else self.wall.get(k)
        F = rate = Fraction(0)
        if self.joints[k] != "free":
            F = (a - b) / ((1 / left.Z if left else 0) + (1 / right.Z if right else 0))
            if self.joints[k] == "rigid":
                rate = b - a if self.gap[k] > 0 else max(b - a, Fraction(0))
                F = max(F, Fraction(0)) if self.gap[k] == 0 else Fraction(0)
                if F > 0 == self.force[k]:
                    self.presses.append(self.t)
        self.force[k], self.rate[k] = F, rate
        if left:
            left.b.send(self.t, a - 2 * F / left.Z)
        if right:
            right.a.send(self.t, b + 2 * F / right.Z)

    def run(self, until, cap=1500):
        """Go on to t = until; False if that takes more than `cap` events."""
        for _ in range(cap):
            for k in range(len(self.joints)):
                self.solve(k)
            arrivals = [
                t + p.T
                for p in self.pieces
                for s in (p.a, p.b)
                for t in s.after(self.t - p.T)
            ]
            closings = [
                self.t - gap / rate
                for gap, rate in zip(self.gap, self.rate, strict=True)
                if gap > 0 > rate
            ]
            t = min([until, *arrivals, *closings])
            for k, F in enumerate(self.force):
                self.gap[k] += self.rate[k] * (t - self.t)
                self.impulse[k] += F * (t - self.t)
                self.pressed[k] += (t - self.t) * (F > 0)
            self.t = t
            if t == until:
                return True
        return False

    def state(self, piece, part, t):
        """Velocity and strain at a part of a piece's length from its left end."""
        p = self.pieces[piece]
        a = p.a.at(t - part * p.T)
        b = p.b.at(t - (1 - part) * p.T)
        return (a + b) / 2, (b - a) / (2 * p.c)

    def mean_velocity(self, first, last):
        pieces = self.pieces[first:last]
        momentum = sum(
            p.Z * s.integral(self.t - p.T, self.t) / 2
            for p in pieces
            for s in (p.a, p.b)
        )
        return momentum / sum(p.Z * p.T for p in pieces)


def random_row(seed):
    """A row whose lengths, impedances, speeds and gaps are small whole numbers or dyadic."""
    pick = random.Random(seed)
    impedances = pick.choice([(1,), (1, 2, 3, 5), (1, 7, 50), (2, 3)])
    longest = pick.choice([3, 6, 12])

    def segment():
        c = pick.choice([1, 1, 2])
        T = pick.randint(1, longest)
        material = ri.Material("m", youngs_modulus=float(c * c), density=1.0)
        return ri.Segment(float(c * T), pick.choice(impedances) / c, material)

    def rod():
        segments = [segment() for _ in range(pick.choice([1, 1, 1, 2, 3]))]
        total = int(sum(s.length for s in segments))
        jumps = pick.randint(0, min(2, total - 1)) if pick.random() < 0.3 else None
        if jumps is None:
            return ri.Rod(segments=segments, velocity=pick.randint(-3, 3))
        at = sorted(pick.sample(range(1, total), jumps))
        profiles = [
            ri.Steps([pick.randint(-n, n) for _ in range(jumps + 1)], at)
            for n in (3, 2)
        ]
        return ri.Rod(segments=segments, velocity=profiles[0], strain=profiles[1])

    row = [rod() for _ in range(pick.choice([1, 2, 2, 3, 4, 5]))]
    if pick.random() < 0.4:
        row.insert(0, ri.Wall(pick.choice([0, 0, 1, -1])))
    if pick.random() < 0.4 or len(row) == 1:
        row.append(ri.Wall(pick.choice([0, 0, 1, -1])))
    laws = [ri.Bonded() if pick.random() < 0.12 else ri.Rigid() for _ in row[1:]]
    gaps = [
        pick.randint(1, 12) / pick.choice([1, 4, 64])
        if isinstance(law, ri.Rigid) and pick.random() < 0.5
        else 0
        for law in laws
    ]
    return ri.System(row, gaps, laws), pick


@pytest.mark.parametrize("seed", few_of(SEEDS, range(25)))
def test_agrees_with_brute_force(seed):
    system, pick = random_row(seed)
    until = Fraction(pick.randint(10, 50)) + Fraction(1, 7)
    reference = Reference(system)
    assert reference.run(until)
    solution = ri.solve(system, until=float(until))
    near = {"rel": EXACT, "abs": EXACT}
    proof = ri.solve(system, max_events=3000)
    if proof.final:
        assert float(max(reference.presses, default=0)) <= proof.t_final * (1 + EXACT)
    for contact, k in zip(solution.contacts, reference.contacts, strict=True):
        assert contact.impulse == pytest.approx(float(reference.impulse[k]), **near)
        assert float(contact.gap(float(until))) == pytest.approx(
            float(reference.gap[k]), **near
        )
        if isinstance(contact.law, ri.Rigid):
            assert contact.duration == pytest.approx(
                float(reference.pressed[k]), **near
            )
    for body, (first, rod) in enumerate(
        zip(reference.first, system.bodies, strict=True)
    ):
        if isinstance(rod, ri.Wall):
            continue
        mean = float(solution.mean_velocity(body, float(until)))
        expected = reference.mean_velocity(first, first + len(rod.segments))
        assert mean == pytest.approx(float(expected), **near)
        left = 0.0
        for i, segment in enumerate(rod.segments):
            for _ in range(8):
                part = pick.random()
                t = pick.random() * float(until)
                x = left + part * segment.length
                found = [
                    float(f(body, x, t)) for f in (solution.velocity, solution.strain)
                ]
                expected = reference.state(first + i, Fraction(part), Fraction(t))
                assert found == pytest.approx([float(y) for y in expected], **near)
            left += segment.length


def test_the_rows_are_not_easy():
    rows = [ri.solve(random_row(seed)[0], until=50.0) for seed in SEEDS]
    episodes = [len(c.episodes) for s in rows for c in s.contacts]
    assert sum(n > 1 for n in episodes) > 0.2 * len(episodes)  # re-contact
    assert sum(s.final for s in rows) > 0.4 * len(rows)
    assert any(isinstance(c.law, ri.Bonded) for s in rows for c in s.contacts)
    assert any(
        e.force_end < e.opening for s in rows for c in s.contacts for e in c.episodes
    )
