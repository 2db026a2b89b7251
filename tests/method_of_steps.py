"""An independent solver of rows for tests: delay differential equations by the method of steps.

Waves travel along a uniform segment unchanged, so that what happens between two segments (a node: a
chain of links and rigid masses) is a small system of ordinary differential equations, driven by
waves that left the neighbouring nodes earlier. SciPy's DOP853 integrates it between breaks. A break
is where a wave, or one of its first derivatives, jumps; breaks follow from earlier ones by adding
transit times, or from events, such as the closing of a contact. Times of breaks are whole ticks, so
that sums of transit times are exact.

A force F > 0 pushes the two sides of a link apart, d is their overlap and v the velocity with which
they would close without F. Velocities count in the frame that falls with the row.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import DOP853, OdeSolution
from scipy.optimize import brentq

import rodimpact as ri

TICKS = 2.0**46  # of the longest transit, about
NEAR = 4  # ticks; breaks that are so near are one: the transits are rounded
SMOOTH = 7  # a break of the seventh derivative or a later one is none
ORDER = 12  # of the polynomials that store waves, overlaps and forces
POINTS = np.cos(np.pi * np.arange(ORDER + 1) / ORDER)
FIT = np.linalg.inv(chebyshev.chebvander(POINTS, ORDER))
OPEN, PRESS, SLACK, PLASTIC = "open", "press", "slack", "plastic"
LENGTH, VELOCITY, FORCE = range(3)
TOLERANCE = (1e-14, 1e-12, 1e-12)  # below which overlap, velocity and force have no sign
REST = 1e-6  # of the scale: masses that strike more slowly stay together


def value_at(c, x):
    """A Chebyshev series at x, by Clenshaw's rule."""
    b0 = b1 = 0.0
    for coefficient in c[:0:-1]:
        b0, b1 = coefficient + 2 * x * b0 - b1, b0
    return c[0] + x * b0 - b1


class Wave:
    """A function of time, as polynomials between whole ticks, and its breaks with their orders."""

    def __init__(self):
        self.starts, self.stops, self.pieces, self.breaks = [], [], [], {}

    def add(self, start, stop, coefficients):
        self.starts.append(start)
        self.stops.append(stop)
        self.pieces.append(coefficients)

    def fit(self, start, stop, f, depth=0):
        """Add a function of ticks, halved until the polynomials are good."""
        half = (stop - start) / 2
        c = FIT @ (f(start + half * (1 + POINTS)) + 0 * POINTS)
        size = np.max(np.abs(c))
        if depth < 10 and np.max(np.abs(c[-3:])) > 2e-15 * size:
            self.fit(start, start + int(half), f, depth + 1)
            self.fit(start + int(half), stop, f, depth + 1)
        elif stop > start:
            self.add(start, stop, trimmed(c, size))

    def between(self, i0, i1, tick):
        """A function of the seconds since tick i0; what lies outside i0 to i1 is extrapolated."""
        first = bisect_right(self.stops, min(i0 + NEAR, (i0 + i1) // 2))
        last = max(bisect_right(self.starts, max(i1 - NEAR - 1, (i0 + i1) // 2)) - 1, first)
        pieces = self.pieces[first : last + 1]
        if first == last and len(pieces[0]) == 1:
            constant = pieces[0][0]
            return lambda s: constant
        starts = [(i - i0) * tick for i in self.starts[first : last + 1]]
        rates = [2 / ((b - a) * tick) for a, b in
                 zip(self.starts[first : last + 1], self.stops[first : last + 1], strict=True)]

        def value(s):
            if isinstance(s, np.ndarray):
                return np.array([value(x) for x in s.tolist()])
            j = bisect_right(starts, s, 1) - 1
            return value_at(pieces[j], (s - starts[j]) * rates[j] - 1)

        return value

    def at(self, tick):
        """Value at a tick, from the left."""
        j = max(bisect_right(self.starts, tick - 1) - 1, 0)
        a, b = self.starts[j], self.stops[j]
        return value_at(self.pieces[j], 2 * (tick - a) / (b - a) - 1)

    def integral(self, i0, i1):
        """Between two ticks, times ticks."""
        total = []
        for a, b, c in zip(self.starts, self.stops, self.pieces, strict=True):
            low, high = max(a, i0), min(b, i1)
            if low < high:
                ends = [2 * (i - a) / (b - a) - 1 for i in (low, high)]
                x0, x1 = chebyshev.chebval(ends, chebyshev.chebint(c))
                total.append((x1 - x0) * (b - a) / 2)
        return math.fsum(total)

    def largest(self):
        """Largest value."""
        best = -math.inf
        for c in self.pieces:
            turns = chebyshev.chebroots(chebyshev.chebder(c)) if len(c) > 2 else []
            inside = [float(x.real) for x in turns if abs(x.imag) < 1e-9 and abs(x.real) < 1]
            best = max(best, *(value_at(c, x) for x in (-1.0, 1.0, *inside)))
        return best

    def derivatives(self, j, x, T):
        """Value, T times the slope and T^2/2 times the second derivative; T in ticks."""
        c, rate = np.asarray(self.pieces[j]), 2 * T / (self.stops[j] - self.starts[j])
        return [chebyshev.chebval(x, chebyshev.chebder(c, n)) * rate**n / max(n, 1)
                for n in range(3)]


class Link:
    """What acts between two neighbours; see `rodimpact.model.laws` for the numbers."""

    def __init__(self, kind, d=0.0, k=0.0, p=1.0, c=0.0, **more):
        self.kind, self.d, self.k, self.p, self.c = kind, d, k, p, c
        self.strength, self.hardening = more.get("strength", math.inf), more.get("hardening", 0.0)
        self.restitution, self.push = more.get("restitution", 0.0), more.get("push")
        self.status = PRESS if kind in ("push", "bond", "joint") else OPEN
        self.force_signal, self.overlap, self.spans, self.blows = Wave(), Wave(), [], []

    @property
    def moves(self):
        """Whether the overlap changes."""
        rigid = self.kind in ("rigid", "impact")
        return self.kind not in ("push", "bond") and not (rigid and self.status == PRESS)

    @property
    def lag(self):
        """By how many orders a break is smoother behind the link."""
        if self.kind == "push" or self.status in (OPEN, SLACK):
            return SMOOTH
        return int(self.c == 0 and self.kind in ("joint", "spring", "yield", "impact"))

    def force(self, d, v, Y):
        """F = F(d, d') with d' = v - Y F."""
        kind, k, c = self.kind, self.k, self.c
        if self.status in (OPEN, SLACK) or kind == "impact":
            return 0.0
        if kind in ("bond", "rigid"):
            return v / Y
        if kind in ("joint", "dashpot"):
            return (k * d + c * v) / (1 + c * Y)
        elastic = k * (d * (d > 0)) ** self.p
        return elastic * (1 + c * v) / (1 + c * elastic * Y) if kind == "hunt" else elastic

    def guards(self, d, v, F, Y):
        """What must not be negative for the status to last: (value, its scale, next status)."""
        kind, k, c = self.kind, self.k, self.c
        if self.status == OPEN:
            return ((-d, LENGTH, PRESS),)
        if kind == "rigid":
            return ((v, VELOCITY, OPEN),)
        if kind == "impact":
            return ((F, FORCE, OPEN),)
        if self.status == PLASTIC:
            return ((v - Y * F, VELOCITY, PRESS),)
        if kind == "spring":
            return ((d, LENGTH, OPEN),)
        if kind == "yield":
            return (d, LENGTH, OPEN), (self.strength / k - d, LENGTH, PLASTIC)
        if kind not in ("dashpot", "hunt"):
            return ()
        pressing = v + (k * d if kind == "dashpot" else 1.0) / c
        if self.status == SLACK:
            return (-pressing, VELOCITY, PRESS), (d, LENGTH, OPEN)
        slack = (pressing, VELOCITY, SLACK)
        return (slack,) if kind == "dashpot" else ((d, LENGTH, OPEN), slack)

    def switch(self, status):
        """Take the next status; the overlap is then known exactly."""
        if self.status == PLASTIC:
            self.strength = max(self.k * self.d, self.strength)
        elif status == PLASTIC:
            self.d = self.strength / self.k
        elif status == OPEN or self.status == OPEN:
            self.d = 0.0
        self.status = status


class Side:
    """What stands at one side of a node: the wave that comes in, with its delay, and 1/Z."""

    def __init__(self, wave, delay=0, Y=0.0, out=None):
        self.wave, self.delay, self.Y, self.out = wave, delay, Y, out


class Node:
    """The links and masses between two sides."""

    def __init__(self, row, left=None):
        self.row, self.sides = row, [left, None]
        self.links, self.masses, self.speeds = [], [], []
        self.now, self.step, self.chunk, self.restarts = 0, row.longest * row.tick, 1, 0

    def finish(self):
        self.sides = [side or Side(None) for side in self.sides]
        last = len(self.links) - 1
        self.Y = [(i == 0) * self.sides[0].Y + (i == last) * self.sides[1].Y
                  for i in range(last + 1)]
        V, T, Z = self.row.scale
        sizes = [min(V * T, (V * Z / n.k) ** (1 / n.p) if n.k else V * T) for n in self.links]
        self.atol = np.array([*(0.1 * size for size in sizes), *[V] * len(self.masses)])
        self.atol *= self.row.rtol

    def known(self):
        """Tick until which what comes in is known."""
        stops = [s.wave.stops[-1] + s.delay for s in self.sides if s.wave is not None]
        return min([*stops, self.row.end])

    def next_break(self, stop):
        """First break of what comes in after now, and none nearer than NEAR to now."""
        for wave, delay in self.inputs():
            for i in reversed(wave.breaks):
                if i + delay <= self.now + NEAR:
                    break
                stop = min(stop, i + delay)
        return stop

    def inputs(self):
        for side in self.sides:
            if side.wave is not None:
                yield side.wave, side.delay
        for link in self.links:
            if link.push is not None:
                yield link.push, 0

    # The equations -----------------------------------------------------------------------------

    def forces(self, s, y):
        """Forces, and velocities of closing without and with them."""
        n = len(self.links)
        v = [self.waves[0](s), *y[n:], self.waves[1](s)]
        free = [v[i] - v[i + 1] for i in range(n)]
        F = [self.pushes[i](s) if link.kind == "push" else link.force(y[i], free[i], self.Y[i])
             for i, link in enumerate(self.links)]
        held = [i for i, link in enumerate(self.links)
                if link.kind == "impact" and link.status == PRESS]
        if held:
            for i, P in zip(held, self.constraint(held, F), strict=True):
                F[i] = P
        closing = [v - Y * f for v, Y, f in zip(free, self.Y, F, strict=True)]
        return F, free, closing, v

    def mobility(self, links):
        """How forces in some links between masses change the closing of each, per time."""
        inverse = [0.0, *(1 / m for m in self.masses), 0.0]
        A = np.zeros((len(links), len(links)))
        for p, i in enumerate(links):
            for q, j in enumerate(links):
                if i == j:
                    A[p, q] = inverse[i] + inverse[i + 1]
                elif abs(i - j) == 1:
                    A[p, q] = -inverse[max(i, j)]
        return A, inverse

    def constraint(self, held, F):
        """Forces that keep masses together; what stands outside does not fall."""
        A, inverse = self.mobility(held)
        G = [0.0 if i in held else f for i, f in enumerate(F)]
        masses = [(G[j] - G[j + 1]) * inverse[j + 1] for j in range(len(self.masses))]
        rate = [-self.row.gravity, *masses, -self.row.gravity]
        return np.linalg.solve(A, np.array(np.broadcast_arrays(
            *(rate[i] - rate[i + 1] for i in held))))

    def rates(self, s, y):
        F, _, closing, _ = self.forces(s, y)
        d = [0.0 if not link.moves else u * link.hardening / link.k if link.status == PLASTIC
             else u for link, u in zip(self.links, closing, strict=True)]
        return [*d, *((F[j] - F[j + 1]) / m for j, m in enumerate(self.masses))]

    def impact(self, s):
        """Masses that touch strike: no closing is more than -e times the one before (Moreau)."""
        touching = [i for i, link in enumerate(self.links)
                    if link.kind == "impact" and link.d >= -NEAR * self.row.least[LENGTH]]
        _, _, before, _ = self.forces(s, self.state())
        A, inverse = self.mobility(touching)
        u = np.array([before[i] for i in touching])
        rest = u < REST * self.row.scale[0]
        e = np.where(rest, 0.0, [self.links[i].restitution for i in touching])
        wanted = u + e * np.maximum(u, 0)
        for subset in range(1 << len(touching)):
            on = [q for q in range(len(touching)) if subset >> q & 1]
            P = np.zeros(len(touching))
            P[on] = np.linalg.solve(A[np.ix_(on, on)], wanted[on]) if on else 0
            if np.all(P >= 0) and np.all(wanted - A @ P <= self.row.least[VELOCITY]):
                break
        after = u - A @ P
        for q, i in enumerate(touching):
            if P[q] > 0:
                self.links[i].blows.append(P[q])
                self.links[i].spans.append((self.now, self.now, True, False))
            if i < len(self.masses):
                self.speeds[i] += float(P[q] * inverse[i + 1])
            if i > 0:
                self.speeds[i - 1] -= float(P[q] * inverse[i])
            stays = after[q] >= -self.row.least[VELOCITY]
            self.links[i].d, self.links[i].status = 0.0, PRESS if stays else OPEN

    # Marching ----------------------------------------------------------------------------------

    def state(self):
        return [*(link.d for link in self.links), *self.speeds]

    def keep(self, y):
        for link, d in zip(self.links, y, strict=False):
            link.d = float(d) if link.moves else link.d
        self.speeds = [float(v) for v in y[len(self.links) :]]

    def advance(self, stop):
        """Go on to a tick to which all that comes in is known."""
        same, tick = 0, self.row.tick
        while self.now < stop:
            i0, i1 = self.now, self.next_break(stop)
            self.restarts += 1
            none = lambda s: 0.0  # noqa: E731
            self.waves = [none if side.wave is None else
                          side.wave.between(i0 - side.delay, i1 - side.delay, tick)
                          for side in self.sides]
            self.pushes = [link.push and link.push.between(i0, i1, tick) for link in self.links]
            self.settle()
            self.fresh = [True, True]
            self.march(i0, (i1 - i0) * tick, same > 8)
            same = same + 1 if self.now == i0 else 0

    def settle(self):
        """Change statuses that do not suit what comes in from now on."""
        least = self.row.least
        for _ in range(50):
            changed = False
            y = self.state()
            F, free, closing, _ = self.forces(0.0, y)
            for i, link in enumerate(self.links):
                status = None
                for g, scale, after in link.guards(y[i], free[i], F[i], self.Y[i]):
                    if g < -least[scale]:
                        status = after
                touching = link.kind not in ("push", "bond", "joint") and abs(y[i]) <= least[LENGTH]
                if touching and link.status == OPEN and free[i] > least[VELOCITY]:
                    status = PRESS
                if (touching and link.status == PRESS and link.kind in ("spring", "hunt", "yield")
                        and closing[i] < -least[VELOCITY]):
                    status = OPEN
                if status:
                    self.change(link, status, 0.0)
                    changed = True
                    break
            if not changed:
                return

    def change(self, link, status, s):
        if link.kind == "impact" and status == PRESS:
            link.d = 0.0
            self.impact(s)
        else:
            link.switch(status)

    def march(self, i0, h, stuck):
        """Integrate from tick i0 for h seconds, or to the first event."""
        y0 = np.array(self.state())
        if not self.masses and not any(link.moves for link in self.links):
            state = lambda s: np.multiply.outer(y0, np.ones_like(s))  # noqa: E731
            event = self.event(0.0, h, state, 33, stuck)
            self.put(i0, 0.0, event[0] if event else h, state)
            self.leave(y0, event)
            return
        longest = self.row.longest * self.row.tick / 8
        solver = DOP853(self.rates, 0.0, y0, h, rtol=self.row.rtol, atol=self.atol,
                        first_step=min(h, self.step, longest), max_step=longest)
        times, parts, event = [0.0], [], None
        while solver.status == "running" and not event:
            solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"DOP853 fails at tick {i0}")
            state, step = solver.dense_output(), solver.t - solver.t_old
            self.step = max(step, self.step * (solver.status != "running"))  # the last is cut short
            event = self.event(solver.t_old, solver.t, state, 7, stuck)
            end = event[0] if event else solver.t
            if end > times[-1]:
                times.append(end)
                parts.append(state)
            if parts and (event or len(parts) >= self.chunk or solver.status != "running"):
                good = self.put(i0, times[0], end, OdeSolution(times, parts))
                self.chunk = min(2 * self.chunk, 64) if good else max(self.chunk // 2, 1)
                times, parts = [end], []
        self.leave(state(end), event)

    def event(self, s0, s1, state, points, stuck):
        """Look for the first event of a step: its time, link and next status, or None."""
        times = np.linspace(s0, s1, points)[1:]
        bad = {}
        for i, n, g, scale, _ in self.guarded(times, state(times)):
            broken = np.flatnonzero(g + 0 * times < -self.row.least[scale])
            if broken.size:
                bad.setdefault(int(broken[0]), []).append((i, n))
        if not bad:
            return None
        first = min(bad)
        s = float(times[first])
        before = float(times[first - 1]) if first else s0
        end, i, n = min((self.root(*which, before, s, state), *which) for which in bad[first])
        end = s if stuck else end
        return end, i, self.guarded(end, state(end), i)[n][4]

    def leave(self, y, event):
        """End a march: keep the state, and change what the event changes."""
        self.keep(y)
        if event:
            self.change(self.links[event[1]], event[2], event[0])

    def put(self, i0, s0, s1, state):
        """Store what happened from s0 to s1; return whether it took one piece."""
        start, stop = (i0 + round(s / self.row.tick) for s in (s0, s1))
        if stop <= start:
            return True
        self.now = stop
        return self.store(i0, start, stop, state, 0)

    def guarded(self, s, y, only=None):
        F, free, _, _ = self.forces(s, list(y))
        return [(i, n, *guard) for i, link in enumerate(self.links) if only in (None, i)
                for n, guard in enumerate(link.guards(y[i], free[i], F[i], self.Y[i]))]

    def root(self, i, n, before, s, state):
        """When a guard passes 0; if it was no more than round-off before, when it leaves that."""
        value = lambda s: self.guarded(s, state(s), i)[n][2]  # noqa: E731
        scale = self.guarded(s, state(s), i)[n][3]
        first = value(before)
        if first > 0:
            return brentq(value, before, s, xtol=1e-300, rtol=1e-15)
        if first <= -self.row.least[scale]:
            return before
        return brentq(lambda s: value(s) + self.row.least[scale], before, s, xtol=1e-300,
                      rtol=1e-15)

    # What leaves -------------------------------------------------------------------------------

    def leaving(self, s, y):
        """Waves that leave to the left and to the right, then forces and overlaps."""
        F, _, _, v = self.forces(s, y)
        left = v[0] - 2 * self.sides[0].Y * F[0]
        right = v[-1] + 2 * self.sides[1].Y * F[-1]
        return np.array([x + 0 * s for x in (left, right, *F, *y[: len(F)])])

    def store(self, i0, start, stop, state, depth):
        """Store from tick to tick as polynomials, halved until they are good."""
        half = (stop - start) / 2
        times = (start - i0 + half * (1 + POINTS)) * self.row.tick
        values = self.leaving(times, list(state(times))).T
        c = FIT @ values
        n = len(self.links)
        V, T, Z = self.row.scale
        sizes = np.array([V, V, *[V * Z] * n, *[V * T] * n])
        tail = np.max(np.abs(c[-2:]), axis=0)
        if np.any(tail > self.row.rtol * sizes) and depth < 10 and stop - start > 256:
            middle = (start + stop) // 2
            self.store(i0, start, middle, state, depth + 1)
            self.store(i0, middle, stop, state, depth + 1)
            return False
        keep = np.abs(c) > 4e-17 * sizes
        series = [tuple(float(a) for a in c[: max(np.flatnonzero(keep[:, q]), default=0) + 1, q])
                  for q in range(2 + 2 * n)]
        for k, side in enumerate(self.sides):
            if side.out is not None:
                side.out.add(start, stop, series[k])
                if self.fresh[k]:
                    self.mark(k, side, start)
        for q, link in enumerate(self.links):
            link.force_signal.add(start, stop, series[2 + q])
            link.overlap.add(start, stop, series[2 + n + q])
            pressed = np.max(values[:, 2 + q]) > 1e-11 * V * Z
            parted = np.min(values[:, 2 + n + q]) < -1e-12 * V * T
            link.spans.append((start, stop, bool(pressed), bool(parted)))
        return True

    def mark(self, k, side, start):
        """Enter a break of what leaves a side: what its first derivatives jump by says its order.

        Breaks that came in become smoother on the way through links and masses.
        """
        self.fresh[k] = False
        out, T = side.out, self.row.longest
        if len(out.pieces) < 2:
            out.breaks[start] = 0
            return
        through = sum(link.lag for link in self.links) + len(self.masses)
        tracked = SMOOTH
        for q, other in enumerate(self.sides):
            for i, order in (other.wave.breaks.items() if other.wave is not None else ()):
                if abs(i + other.delay - start) <= NEAR:
                    tracked = min(tracked, order + (q != k) * through)
        if tracked == SMOOTH:  # an event, or a drive
            tracked = 0
        left, right = out.derivatives(-2, 1.0, T), out.derivatives(-1, -1.0, T)
        seen = 0
        while seen < 3 and abs(left[seen] - right[seen]) <= 1e-13 * self.row.scale[0]:
            seen += 1
        order = max(tracked, seen)
        if order < SMOOTH and not (tracked == 0 and seen == 3):
            out.breaks[start] = order


@dataclass
class Contact:
    """What a contact did; times in s, see `rodimpact.methods.run.Episode`.

    Where masses strike each other the peak force is nan.
    """

    impulse: float
    peak_force: float
    duration: float
    episodes: list
    gap: object  # function of time, s


@dataclass
class Reference:
    """Contacts of the row (None between rigid bodies that are bonded) and velocities at the end."""

    contacts: list
    velocities: list
    restarts: int


def edges_of(profile, length):
    """Where a profile along a rod, or over time, jumps or bends."""
    if isinstance(profile, ri.Steps):
        return list(profile.at)
    if isinstance(profile, ri.Samples):
        n = len(profile.values) - 1
        return [i * (profile.step or length / n) for i in range(n + 1)]
    return []


def piece_of(profile, length, x):
    """The smooth function that a profile is around x."""
    if isinstance(profile, ri.Samples):
        v, n = profile.values.tolist(), len(profile.values) - 1
        h = profile.step or length / n
        i = min(int(x / h), n)
        slope = v[i + 1] - v[i] if i < n else 0.0
        return lambda s: v[i] + slope * (s / h - i)
    if isinstance(profile, ri.Steps):
        profile = profile.values[bisect_right(profile.at, x)]
    return profile if callable(profile) else lambda s: profile


class RowOfNodes:
    """A system in the falling frame as nodes between waves."""

    def __init__(self, system, until, rtol, drives):
        self.system, self.rtol, self.gravity = system, rtol, float(system.gravity)
        rods = [b for b in system.bodies if isinstance(b, ri.Rod)]
        transits = [s.length / s.material.wave_speed for rod in rods for s in rod.segments]
        T = max(transits)
        ratios = [Fraction(t / T).limit_denominator(1000) for t in transits]
        whole = math.lcm(*(r.denominator for r, t in zip(ratios, transits, strict=True)
                           if abs(float(r) - t / T) < 1e-15))
        self.longest = whole * max(round(TICKS / whole), 1)
        self.tick = T / self.longest
        self.end = round(until / self.tick)
        Z = [s.material.density * s.material.wave_speed * s.area for r in rods for s in r.segments]
        self.nodes, self.contacts, self.bodies = [Node(self)], [], []
        for i, body in enumerate(system.bodies):
            self.enter(i, body, drives)
        if not isinstance(system.bodies[-1], ri.Wall):
            self.outside(1, drives.get(1))
        V = self.largest_velocity(min(Z), T)
        self.scale = V, T, min(Z)
        sizes = V * T, V, V * min(Z)
        self.least = [share * size for share, size in zip(TOLERANCE, sizes, strict=True)]
        for node in self.nodes:
            node.finish()

    def largest_velocity(self, Z, T):
        """Scale of velocities: what the waves and masses differ by, and forces over Z."""
        speeds = [v for node in self.nodes for v in node.speeds]
        others = [abs(self.gravity) * T]
        for node in self.nodes:
            speeds += [sum(c) for side in node.sides if side for c in side.wave.pieces]
            speeds += [c[0] for side in node.sides if side for c in side.wave.pieces]
            for link in node.links:
                others += [max(abs(sum(c)), abs(c[0])) / Z for c in (link.push or Wave()).pieces]
                others.append(link.k * abs(link.d) / Z * (link.kind == "joint"))
        return max(max(speeds) - min(speeds), *others, 1e-300)

    def enter(self, i, body, drives):
        system, node = self.system, self.nodes[-1]
        merged = i > 0 and isinstance(system.contacts[i - 1], ri.Bonded) and not any(
            isinstance(b, ri.Rod) for b in system.bodies[i - 1 : i + 1])
        if merged:
            self.contacts.append(None)
            if isinstance(body, ri.Wall):  # the mass before it is held
                node.masses.pop()
                node.speeds.pop()
                held = self.bodies[-1]
                self.bodies = [("wall", body) if b == held else b for b in self.bodies]
                self.bodies.append(("wall", body))
                node.sides[1] = Side(self.drive(body.velocity, falls=True))
                return
            if self.bodies[-1][0] == "mass":
                node.masses[-1] += body.mass
            self.bodies.append(self.bodies[-1])
            return
        if i > 0:
            node.links.append(link_of(system.contacts[i - 1], float(system.gaps[i - 1])))
            self.contacts.append(node.links[-1])
        elif not isinstance(body, ri.Wall):
            self.outside(0, drives.get(0))
        if isinstance(body, ri.Wall):
            node.sides[0 if i == 0 else 1] = Side(self.drive(body.velocity, falls=True))
            self.bodies.append(("wall", body))
        elif isinstance(body, ri.RigidMass):
            node.masses.append(body.mass)
            node.speeds.append(body.velocity)
            self.bodies.append(("mass", node, len(node.masses) - 1))
        else:
            self.bodies.append(("rod", self.rod(body)))

    def rod(self, rod):
        """Lay the segments; return their (lines, impedance, ticks)."""
        laid, x = [], 0.0
        for j, segment in enumerate(rod.segments):
            if j:
                self.nodes[-1].links.append(Link("bond"))
            c, L = segment.material.wave_speed, segment.length
            Z, N = segment.material.density * c * segment.area, round(L / c / self.tick)
            a, b = self.initial(rod, x, L, c, N, -1), self.initial(rod, x, L, c, N, 1)
            self.nodes[-1].sides[1] = Side(b, N, 1 / Z, a)
            self.nodes.append(Node(self, Side(a, N, 1 / Z, b)))
            laid.append((a, b, Z, N))
            x += L
        return laid

    def initial(self, rod, x, L, c, N, sign):
        """The wave that left an end of a segment from tick -N to 0: velocity + sign c strain."""
        wave, both = Wave(), (rod.velocity, rod.strain)
        inside = {e - x for p in both for e in edges_of(p, rod.length) if x < e < x + L}
        if sign < 0:  # to the right, from the left end
            inside = {L - s for s in inside}
        edges = sorted({-N, 0, *(round((s / L - 1) * N) for s in inside)})
        place = lambda i: x + L * (1 + i / N if sign > 0 else -i / N)  # noqa: E731
        for start, stop in pairwise(edges):
            v, e = (piece_of(p, rod.length, place((start + stop) / 2)) for p in both)
            wave.breaks[start] = 0
            wave.fit(start, stop, lambda i, v=v, e=e: v(place(i)) + sign * c * e(place(i)))
        return wave

    def drive(self, profile, factor=1.0, offset=0.0, falls=False):
        """What is given outside over time, in the falling frame."""
        wave, g = Wave(), self.gravity * falls
        at = [round(t / self.tick) for t in edges_of(profile, 0.0)]
        for start, stop in pairwise(sorted({0, self.end, *(i for i in at if 0 < i < self.end)})):
            f = piece_of(profile, 0.0, (start + stop) / 2 * self.tick)
            wave.breaks[start] = 0
            wave.fit(start, stop, lambda i, f=f: factor * f(i * self.tick) + offset
                     - g * i * self.tick)
        return wave

    def outside(self, side, drive):
        """Enter the left or right end of the row."""
        node, end = self.nodes[-1], self.system.ends[side]
        value = drive or getattr(end, "value", 0.0)
        if isinstance(end, ri.Free | ri.Pushed):
            node.links.append(Link("push", push=self.drive(value)))
            return
        node.links.append(Link("bond"))
        if isinstance(end, ri.Fixed | ri.Moved):
            node.sides[side] = Side(self.drive(value, falls=True))
            return
        rod = self.system.bodies[-side]
        segment, x = rod.segments[-side], rod.length * side
        sign, c = (-1, 1)[side], segment.material.wave_speed
        v, e = (piece_of(p, rod.length, x)(x) for p in (rod.velocity, rod.strain))
        Y = 1 / (segment.material.density * c * segment.area)
        node.sides[side] = Side(self.drive(value, sign * 2 * c, v + sign * c * e), Y=Y)

    def solve(self):
        while True:
            node = min(self.nodes, key=lambda node: node.now)
            if node.now >= self.end:
                return self
            node.advance(node.known())

    def results(self):
        fall = self.gravity * self.end * self.tick
        velocities = []
        for kind, *what in self.bodies:
            if kind == "wall":
                velocities.append(what[0].velocity)
            elif kind == "mass":
                velocities.append(what[0].speeds[what[1]] + fall)
            else:
                momentum = math.fsum(Z / 2 * (a.integral(self.end - N, self.end)
                                              + b.integral(self.end - N, self.end))
                                     for a, b, Z, N in what[0])
                velocities.append(momentum / math.fsum(Z * N for _, _, Z, N in what[0]) + fall)
        contacts = [None if link is None else self.contact(link) for link in self.contacts]
        return Reference(contacts, velocities, sum(node.restarts for node in self.nodes))

    def contact(self, link):
        force, tick = link.force_signal, self.tick
        impulse = force.integral(0, self.end) * tick + math.fsum(link.blows)
        peak = math.nan if link.blows else max(force.largest(), 0.0)
        pressed = math.fsum((b - a) * tick for a, b, presses, _ in link.spans if presses)
        return Contact(impulse, peak, pressed, episodes(link.spans, tick),
                       lambda t: -link.overlap.at(round(t / tick)))


def trimmed(series, size):
    series = [float(a) for a in series]
    while len(series) > 1 and abs(series[-1]) <= 4e-17 * size:
        series.pop()
    return tuple(series)


def link_of(law, gap):
    d = -gap
    if isinstance(law, ri.Bonded):
        return Link("bond")
    if isinstance(law, ri.Joint):
        return Link("joint", -law.stretch, law.stiffness, c=law.damping)
    if isinstance(law, ri.Rigid):
        if law.restitution is None:
            return Link("rigid", d)
        return Link("impact", d, restitution=law.restitution)
    if isinstance(law, ri.Yielding):
        return Link("yield", d, law.stiffness, strength=law.yield_force, hardening=law.hardening)
    damping = getattr(law, "damping", 0.0)
    kind = "spring" if not damping else "hunt" if isinstance(law, ri.HuntCrossley) else "dashpot"
    return Link(kind, d, law.stiffness, law.exponent, damping)


def episodes(spans, tick):
    """Touchings that carried force: [start, end of the force, opening], nan where none came."""
    found, presses = [], False
    for start, stop, pressed, parted in spans:
        if pressed:
            if not found or not math.isnan(found[-1][2]):
                found.append([start * tick, math.nan, math.nan])
            found[-1][1] = stop * tick
        elif parted and found and math.isnan(found[-1][2]):
            found[-1][2] = start * tick
        presses = pressed
    if presses:
        found[-1][1] = math.nan
    return found


def solve(system, until, rtol=1e-13, drives=None):
    """Solve a row; `drives` replaces the value of an end, by side, by a smooth function of time."""
    return RowOfNodes(system, until, rtol, drives or {}).solve().results()
