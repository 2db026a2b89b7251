"""From a system to flat lists: segments, nodes, ticks and the waves under way at t = 0.

Bodies are laid end to end as segments 1 to n; the segments 0 and n + 1 are what lies outside. The
initial state is the history of the waves over one transit before t = 0: fronts at negative ticks.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..frozen import InvalidModel, Number
from ..model import Bonded, Rod, Segment, Steps, System, Wall
from . import kernels
from .front_kernel import BOND, FREE, NEVER, OPEN, TOUCH, Log, Row, Tally, begin
from .tick_kernel import assign_ticks

TOLERANCE = 2.0**-48
"""Smallest change of a wave that counts as a front, in units of the velocity scale (the spread of
the velocities plus wave speed times strain); the same margin decides whether contacts press or
graze. The error of a wave is at most this, times the number of ends it has passed."""

WINDOW = 40  # a gap that closes within 2^-40 longest transits of an arrival closes with it
HORIZON = 4096  # longest transits for which the clock has room when no end is given
FINEST, COARSEST = 50, 20  # longest transit in ticks, as a power of two


@dataclass(frozen=True, slots=True)
class Assembly:
    """A single collision in flat lists; index 0 and n + 1 of a segment list are the outside.

    Attributes
    ----------
    system : System
    spans : tuple of (int, int)
        First and last segment of each body; (1, 0) for a wall.
    nodes : tuple of int
        Node of each contact.
    wave_speed, impedance, length : list of float
        By segment, SI.
    ticks : list of int
        Transit times by segment.
    tick : float
        s.
    frame : float
        Velocity of the frame in which waves are given, m/s.
    tolerance : float
        Velocity below which two waves are the same, m/s.
    window : int
        Ticks by which a closing may move to an arrival.
    status : list of int
        Of each node at t = 0, before anything is solved.
    gaps : list of float
        At each node, velocity times ticks.
    outside : (float, float)
        Wave arriving from the left and from the right wall.
    waves : list of list of (int, float)
        By line: ticks at which fronts left (the first at minus one transit) and values behind them.
    transit_error : float
        Largest relative change of a transit time by its rounding to ticks.
    worst : str
        Path of the segment with that error.
    """

    system: System
    spans: tuple[tuple[int, int], ...]
    nodes: tuple[int, ...]
    wave_speed: list[float]
    impedance: list[float]
    length: list[float]
    ticks: list[int]
    tick: float
    frame: float
    tolerance: float
    window: int
    status: list[int]
    gaps: list[float]
    outside: tuple[float, float]
    waves: list[list[tuple[int, float]]]
    transit_error: float
    worst: str

    @property
    def longest(self) -> int:
        """Transit time of the longest body, ticks."""
        return max(sum(self.ticks[first : last + 1]) for first, last in self.spans)

    def mass(self, body: int) -> float:
        """Mass with the transit times in use, kg; infinite for a wall."""
        first, last = self.spans[body]
        if last == 0:
            return math.inf
        return sum(self.impedance[s] * self.ticks[s] for s in range(first, last + 1)) * self.tick


def assemble(system: System, until: float | None = None) -> Assembly:
    """Lay out a single collision for the fronts method.

    Parameters
    ----------
    system : System
        Of shape ().
    until : float, optional
        Time to be reached, s; sets how fine a tick can be.

    Raises
    ------
    InvalidModel
        When velocities overflow, transit times are too far apart for one clock, or a material has
        viscosity.
    """
    bodies = system.bodies
    spans: list[tuple[int, int]] = []
    pieces: list[Segment] = []
    paths: list[str] = []
    for i, body in enumerate(bodies):
        if isinstance(body, Wall):
            spans.append((1, 0))
            continue
        spans.append((len(pieces) + 1, len(pieces) + len(body.segments)))
        pieces += body.segments
        stepped = len(body.segments) > 1
        paths += [f"bodies.{i}.segments.{j}" if stepped else f"bodies.{i}"
                  for j in range(len(body.segments))]
    damped = [
        (f"{path}.material.viscosity", f'method "fronts" has no damping; must be 0, got {eta!r}')
        for path, piece in zip(paths, pieces, strict=True) if (eta := piece.material.viscosity)
    ]
    if damped:
        raise InvalidModel(damped)
    n = len(pieces)
    speed = [0.0, *(float(p.wave_speed) for p in pieces), 0.0]
    impedance = [0.0, *(float(p.impedance) for p in pieces), 0.0]
    length = [0.0, *(float(p.length) for p in pieces), 0.0]
    times = [float(p.transit_time) for p in pieces]

    status = [BOND] * (n + 1)
    status[0] = status[n] = FREE
    gap_widths = [0.0] * (n + 1)
    nodes = tuple(max(0, spans[i][1]) for i in range(len(bodies) - 1))
    for node, gap, law in zip(nodes, system.gaps, system.contacts, strict=True):
        gap_widths[node] = float(gap)
        status[node] = BOND if isinstance(law, Bonded) else OPEN if gap > 0 else TOUCH

    cuts, states = _initial_state(system, spans, length)
    frame, scale = _velocity_scale(system, states, speed)
    if not math.isfinite(scale * scale * max(impedance) * NEVER):
        message = f"velocities and strains of {scale!r} m/s overflow the energy; use smaller ones"
        raise InvalidModel([("bodies", message)])
    longest = max(times)
    horizon = until
    if horizon is None:
        flight = 4 * math.fsum(gap_widths) / scale if scale > 0 else 0.0
        horizon = max(HORIZON * longest, 16 * math.fsum(times), flight)
        horizon = min(horizon, longest * 2.0 ** (61 - COARSEST))
    ratio = horizon / longest
    bits = min(FINEST, 61 - math.ceil(math.log2(ratio))) if 0 < ratio < math.inf else FINEST
    if bits < COARSEST or ratio == math.inf:
        message = (
            f"a run of {horizon:g} s is {ratio:.3g} times the longest transit time {longest:g} s, "
            f"more than the clock can count; stop before {longest * 2.0 ** (61 - COARSEST):.3g} s"
        )
        raise InvalidModel([("until", message)])
    ticks, whole, offsets = _whole_ticks(times, cuts, bits)
    window = max(1, whole >> WINDOW)
    short = min(range(n), key=lambda i: ticks[i + 1])
    if ticks[short + 1] <= 4 * window:
        message = (
            f"its transit time {times[short]:.3g} s is too short beside the longest, "
            f"{longest:.3g} s: one exact clock holds ratios up to about 2e11; leave it out"
        )
        raise InvalidModel([(paths[short], message)])
    tick = longest / whole
    errors = [abs(ticks[i + 1] * tick / times[i] - 1) for i in range(n)]
    worst = max(range(n), key=errors.__getitem__)

    left, right = (
        float(b.velocity) - frame if isinstance(b, Wall) else 0.0 for b in (bodies[0], bodies[-1])
    )
    tolerance = TOLERANCE * scale
    waves: list[list[tuple[int, float]]] = [[], []]
    for s in range(1, n + 1):
        waves += _history(ticks[s], offsets[s], states[s], speed[s], frame, tolerance)
    return Assembly(
        system, tuple(spans), nodes, speed, impedance, length, ticks, tick, frame, tolerance,
        window, status, [g / tick for g in gap_widths], (left, right), waves,
        errors[worst], paths[worst],
    )


def _value(profile: Number | Steps, x: float) -> float:
    if isinstance(profile, Steps):
        return float(profile.values[bisect_right([float(at) for at in profile.at], x)])
    return float(profile)


def _initial_state(
    system: System, spans: list[tuple[int, int]], length: list[float]
) -> tuple[list[list[float]], list[list[tuple[float, float]]]]:
    """By segment: where its profiles jump (as a fraction of its length), and (velocity, strain)."""
    cuts: list[list[float]] = [[] for _ in length]
    states: list[list[tuple[float, float]]] = [[] for _ in length]
    for body, (first, last) in zip(system.bodies, spans, strict=True):
        if not isinstance(body, Rod):
            continue
        profiles = (body.velocity, body.strain)
        jumps = {float(x) for p in profiles if isinstance(p, Steps) for x in p.at}
        left = 0.0
        for s in range(first, last + 1):
            right = left + length[s]
            inside = sorted(x for x in jumps if left < x < right)
            cuts[s] = [(x - left) / length[s] for x in inside]
            edges = [left, *inside, right]
            for x0, x1 in pairwise(edges):
                middle = x0 + (x1 - x0) / 2
                states[s].append((_value(body.velocity, middle), _value(body.strain, middle)))
            left = right
    return cuts, states


def _velocity_scale(
    system: System, states: list[list[tuple[float, float]]], speed: list[float]
) -> tuple[float, float]:
    """Frame (that of the walls, else the middle of all velocities) and scale of velocities."""
    walls = [float(body.velocity) for body in system.bodies if isinstance(body, Wall)]
    velocities = walls + [v for state in states for v, _ in state]
    low, high = min(velocities), max(velocities)
    strained = max(c * abs(eps) for c, state in zip(speed, states, strict=True)
                   for _, eps in state or [(0.0, 0.0)])
    frame = sum(walls) / len(walls) if walls else low / 2 + high / 2
    return frame, high - low + strained


def _whole_ticks(
    times: list[float], cuts: list[list[float]], bits: int
) -> tuple[list[int], int, list[list[int]]]:
    """Ticks of all transits, of the longest, and of the jumps from their segment's left end."""
    marks = [[f * times[s - 1] for f in cuts[s]] if cuts[s] else [] for s in range(len(cuts))]
    distinct = sorted({*times, *(m for mark in marks for m in mark if m > 0)}, reverse=True)
    n = len(distinct)
    kernel = assign_ticks
    if n > 200 and kernels.enabled():
        kernel = kernels.compiled(assign_ticks)
        work = [np.zeros(n, dtype=np.int64) for _ in range(4)]
        whole = kernel(np.array(distinct), bits, *work)
        found = work[3].tolist()
    else:
        found = [0] * n
        whole = kernel(distinct, bits, [0] * n, [0] * n, [0] * n, found)
    table = {0.0: 0, **dict(zip(distinct, found, strict=True))}
    return [0, *(table[t] for t in times), 0], whole, [[table[m] for m in mark] for mark in marks]


def _history(
    transit: int, offsets: list[int], states: list[tuple[float, float]], c: float, frame: float,
    tolerance: float,
) -> tuple[list[tuple[int, float]], list[tuple[int, float]]]:
    """Fronts of the two lines of one segment that fill it with its initial state."""
    edges = [0, *(min(offset, transit) for offset in offsets), transit]
    kept = [(x0, x1, v - frame - c * eps, v - frame + c * eps)
            for x0, x1, (v, eps) in zip(edges, edges[1:], states, strict=False) if x1 > x0]
    right: list[tuple[int, float]] = []
    for _, x1, a, _ in reversed(kept):
        if not right or abs(a - right[-1][1]) > tolerance:
            right.append((-x1, a))
    left: list[tuple[int, float]] = []
    for x0, _, _, b in kept:
        if not left or abs(b - left[-1][1]) > tolerance:
            left.append((x0 - transit, b))
    return right, left


def start(
    ticks: Sequence[int],
    mobility: Sequence[Any],
    status: Sequence[int],
    gaps: Sequence[Any],
    outside: tuple[Any, Any],
    waves: Sequence[Sequence[tuple[int, Any]]],
    room: int = 256,
) -> tuple[Row, Tally, Log, list[int]]:
    """Make the kernel's state at t = 0, on lists, of whatever kind of number the amplitudes are.

    Parameters
    ----------
    ticks, mobility : [n + 2]
        Transit times and 1/Z by segment, 0 outside.
    status, gaps : [n + 1]
        By node.
    outside : pair
        Waves of the walls.
    waves : [2 n + 2] lists of (tick, value)
        By line; those of line 0 and 1 are empty.
    room : int
        Log rows to provide beyond the initial ones.
    """
    n = len(ticks) - 2
    zero = 0 * mobility[1]
    more = [0] * room
    turns = [0] * room
    fronts = [(t, l, wave) for l, line in enumerate(waves) for t, wave in line]
    log = Log(
        [t for t, _, _ in fronts] + more, [-1] * (len(fronts) + room),
        [l for _, l, _ in fronts] + more, [wave for _, _, wave in fronts] + [zero] * room,
        turns, turns[:], turns[:],
    )
    nodes, lines = [zero] * (n + 1), [-1] * (2 * n + 4)
    arrived = [outside[0], *[zero] * (2 * n + 2), outside[1]]
    row = Row(
        list(ticks), list(mobility), list(status), [0] * (n + 1), list(gaps), nodes, nodes[:],
        nodes[:], arrived, lines, lines[:], [0] * (2 << n.bit_length()),
    )
    counts = [0] * (n + 1)
    tally = Tally(nodes[:], nodes[:], nodes[:], counts, counts[:], counts[:], counts[:])
    clock = [0] * 7
    begin(row, tally, log, clock, len(fronts))
    return row, tally, log, clock
