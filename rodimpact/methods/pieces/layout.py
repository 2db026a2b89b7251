"""From a row, or a family of them, to the records that the kernels of this method work on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from ... import model
from ...model import Rod, Samples, Steps
from ...model.frozen import InvalidModel
from ...model.profiles import extremes
from .. import laws as old
from .. import tick_rule as rule
from ..abilities import driven
from ..compiling import Functions, blank
from ..row import Row
from . import finality, waves
from .records import (
    HARD,
    LINE,
    LINK,
    MASS,
    NEVER,
    NODE,
    NONE,
    PART,
    PIECE,
    RUN,
    SMOOTH,
    Law,
    Part,
    Status,
)
from .series import POINTS

LAWS = {
    old.FREE: Law.PUSH_LEFT, old.FORCE: Law.PUSH_LEFT, old.BOND: Law.BOND, old.JOINT: Law.JOINT,
    old.RIGID: Law.RIGID, old.IMPACT: Law.IMPACT, old.SPRING: Law.SPRING, old.HERTZ: Law.POWER,
    old.HUNT: Law.POWER, old.POWER: Law.POWER, old.YIELD: Law.YIELD, old.OWN: Law.OWN,
}
FLOORS = 128  # in the shortest transit
WINDOW = 2.0**-40  # of the longest transit: what comes nearer is taken together
NEAR = 1e-7  # of the velocity scale: over which the slopes of a law of the user are taken
GRAZE = 2.0**-40  # of the velocity scale: forces that move no faster are none


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Records of every member of a family, [member, ...]; a single collision is a family of one.

    Attributes
    ----------
    row : Row
    tick : [member] array
        s.
    ticks : [member, segment] array
        Transit times.
    run, node, link, mass, line, part
        Records; `run` is [member].
    first : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit : float
        By how much they miss what was given, relative to the velocity scale.
    own : tuple of (int, function)
        Laws of the user, by link.
    """

    row: Row
    tick: Any
    ticks: Any
    run: Any
    node: Any
    link: Any
    mass: Any
    line: Any
    part: Any
    first: Any
    fit: float
    own: Functions


def own_laws(row: Row) -> Functions:
    """Laws of the user, by link."""
    pairs = zip(row.system.contacts, row.contact_link, strict=True)
    return tuple((i, law.force) for law, i in pairs if isinstance(law, model.Law))


def is_even(row: Row) -> bool:
    """Whether all that moves at t = 0, and all that acts from outside, is a number."""
    profiles = [value for _, value in row.outside]
    for body in row.system.bodies:
        profiles += [body.velocity, body.strain] if isinstance(body, Rod) else []
    return not any(isinstance(profile, Steps | Samples) for profile in profiles)


class _Members:
    """Numbers of every member, in C order."""

    def __init__(self, row: Row) -> None:
        self.shape = row.system.shape
        self.count = math.prod(self.shape)

    def __call__(self, value: Any) -> Any:
        if np.ndim(value) == 0:
            return np.full(self.count, float(value))
        return np.broadcast_to(value, self.shape).ravel().astype(float)


def lay_out(
    row: Row, until: float | None, tolerance: float, max_events: int, keep: bool
) -> Layout:
    """Put a row, or a family of even ones, on records.

    Parameters
    ----------
    row : Row
    until : float or None
        s.
    tolerance : float
        Of pieces, relative to the velocity scale.
    max_events : int
        Cap on steps of nodes.
    keep : bool
        Whether to keep forces, overlaps and velocities of masses.

    Raises
    ------
    InvalidModel
        If transit times are too far apart for one clock, or the run is too long for it.
    """
    of = _Members(row)
    reference = reference_time(row, of, until)
    scale = velocity_scale(row, of, reference)
    tick, ticks, jumps, horizon = _clock(row, of, until, scale, reference)
    pieces = _Pieces(row, of, tick, ticks, jumps, tolerance, scale, until)
    node, link, mass, line, part = _records(row, of, ticks, pieces, keep)
    shortest = ticks.min(axis=1) if ticks.size else np.rint(reference / tick).astype(np.int64)
    for m in range(link.shape[1]):
        _set_ease(link[:, m], row, of, m, shortest * tick, scale)
    run = np.zeros(of.count, RUN)
    run["tick"], run["scale"], run["keep"] = tick, scale, keep
    run["tolerance"] = tolerance * scale
    given = pieces.breaks(shortest)
    run["floor"], run["shortest"] = np.maximum(shortest // (FLOORS + 4 * given), 64), shortest
    run["graze"] = GRAZE * scale
    run["window"] = np.maximum(np.rint(reference / tick * WINDOW), 1)
    run["limit"], run["proved"], run["first_rough"] = max_events, NONE, NONE
    run["prove"], run["surveyed"] = not driven(row.system), NONE
    run["check"] = np.where(run["prove"], shortest, NEVER)
    run["end"] = np.rint((horizon if until is None else until) / tick).astype(np.int64)
    spans = [ticks[:, first - 1 : last].sum(axis=1) for first, last in row.spans if last]
    longest = reduce(np.maximum, spans) if spans else shortest
    grounds = part["kind"] == Part.GROUND
    joined = not all(law.opens for law in row.system.contacts)
    run["held"] = np.any(grounds & (part["parts"] != 1), axis=1) | joined
    seen = run["held"].any() or keep  # who wants totals alone needs no more than the proof
    run["extra"] = NEVER if until is not None else 2 * longest if seen else 0
    node["length"] = np.maximum(shortest // 8, 16)[:, None]
    return Layout(
        row=row, tick=tick, ticks=ticks, run=run, node=node, link=link, mass=mass, line=line,
        part=part, first=pieces.records, fit=pieces.fit, own=own_laws(row),
    )


def reference_time(row: Row, of: _Members, until: float | None) -> Any:
    """Longest transit, s; without rods `until`, else the longest time of a contact or a flight."""
    if row.segments:
        return reduce(np.maximum, [of(s.transit_time) for s in row.segments])
    if until:
        return of(until)
    speeds = [of(v) for v in (*row.mass_velocity, *(v for k, v in row.outside if k == "velocity"))]
    v = np.maximum(reduce(np.maximum, speeds) - reduce(np.minimum, speeds), 1e-300)
    m = reduce(np.maximum, [of(m) for m in row.masses])
    times = [of(gap) / v for gap in row.gap]
    for i in range(len(row.laws)):
        if np.any(of(row.stiffness[i]) > 0):
            power = of(row.exponent[i]) + 1
            deepest = (power / 2 * m * v * v / of(row.stiffness[i])) ** (1 / power)
            times.append(3 * deepest / v)
    longest = reduce(np.maximum, times)
    return np.where(longest > 0, longest, 1.0)


def velocity_scale(row: Row, of: _Members, time: Any) -> Any:
    """Scale of velocities, m/s; 1 where nothing moves."""
    if row.segments:
        scale = of(row.scale)
    else:
        moving = [of(v) for v in row.mass_velocity]
        scale = np.abs(of(row.gravity)) * time
        for kind, value in row.outside:
            sizes = [np.abs(of(x)) for x in extremes(value)]
            if kind == "velocity":
                moving += [of(x) for x in extremes(value)]
            elif kind == "force":
                least = reduce(np.minimum, [of(m) for m in row.masses])
                scale = scale + reduce(np.maximum, sizes) * time / least
        scale = scale + reduce(np.maximum, moving) - reduce(np.minimum, moving)
        for i, law in enumerate(row.laws):
            if law == old.JOINT or law >= old.SPRING:  # what is stored in it at t = 0 moves a mass
                least = reduce(np.minimum, [of(m) for m in row.masses])
                d = np.abs(of(row.gap[i])) if law == old.JOINT else np.maximum(-of(row.gap[i]), 0.0)
                stored = of(row.stiffness[i]) * d ** (of(row.exponent[i]) + 1)
                scale = scale + np.sqrt(stored / least)
    return np.where(scale > 0, scale, 1.0)


def _clock(
    row: Row, of: _Members, until: float | None, scale: Any, reference: Any
) -> tuple[Any, Any, list[list[int]], Any]:
    """Duration of a tick, s, transits in ticks, those of jumps in rods, and the horizon, s."""
    transits = [of(s.transit_time) for s in row.segments]
    total = sum(transits, np.zeros(of.count))
    flight = 4 * sum((np.maximum(of(gap), 0.0) for gap in row.gap), np.zeros(of.count)) / scale
    horizon = np.maximum(np.maximum(rule.HORIZON * reference, 16 * total), flight)
    horizon = np.minimum(horizon, reference * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST))
    end = horizon if until is None else of(until)
    tick, ticks = np.zeros(of.count), np.zeros((of.count, len(transits)), np.int64)
    inner = _jumps(row)
    durations = np.empty((of.count, len(transits) + len(inner)))
    for j, transit in enumerate(transits):
        durations[:, j] = transit
    for j, (s, share) in enumerate(inner, len(transits)):
        durations[:, j] = share * durations[:, s]
    jumps = []
    for m in range(of.count):
        bits = rule.clock_bits(float(end[m] / reference[m]))
        if bits < rule.COARSEST:
            raise InvalidModel([_too_long(float(end[m]), float(reference[m]))])
        span = blank(durations.shape[1], rule.SPAN)
        for one, time in zip(span, durations[m].tolist(), strict=True):
            one.time = time
        tick[m] = reference[m] / (rule.assign_ticks(span, bits) if span else 1 << bits)
        made = [one.ticks for one in span]
        ticks[m], more = made[: len(transits)], made[len(transits) :]
        jumps.append(more)
        if len(transits) and ticks[m].min() <= 4096:
            raise InvalidModel([_too_short(row, durations[m], int(ticks[m].argmin()))])
    return tick, ticks, jumps, horizon


def _too_long(end: float, longest: float) -> tuple[str, str]:
    most = longest * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST)
    return "until", (
        f"a run of {end:g} s is {end / longest:.3g} times the longest transit time {longest:g} s, "
        f"more than the clock can count; stop before {most:.3g} s"
    )


def _too_short(row: Row, durations: Any, place: int) -> tuple[str, str]:
    return row.paths[place + 1], (
        f"its transit time {durations[place]:.3g} s is too short beside the longest, "
        f"{max(durations):.3g} s: one clock holds ratios up to about 2e11; leave it out"
    )


def _jumps(row: Row) -> list[tuple[int, float]]:
    """Where the initial state jumps inside of a segment: its place, share of it from the left."""
    found = []
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        profiles = (body.velocity, body.strain) if isinstance(body, Rod) else ()
        at = [float(x) for p in profiles if isinstance(p, Steps) for x in p.at]
        begin = 0.0
        for s in range(first - 1, last if at else first - 1):
            L = float(row.segments[s].length)
            found += [(s, (x - begin) / L) for x in at if begin < x < begin + L]
            begin += L
    return found


class _Pieces:
    """What is known of all lines at t = 0: waves under way, then what comes from outside."""

    def __init__(
        self, row: Row, of: _Members, tick: Any, ticks: Any, jumps: list[list[int]],
        tolerance: float, scale: Any, until: float | None,
    ) -> None:
        self._row, self._of, self._tick, self._ticks, self._jumps = row, of, tick, ticks, jumps
        self._tolerance, self._until = tolerance / 4 * float(scale[0]), until
        self._scale = float(scale[0])
        self.fit = 0.0
        self.lines: list[Any] = []  # PIECE [member, piece] of each line
        for s in range(len(row.segments)):
            self._under_way(s)
        self.outside = [self._outside(side) for side in (0, 1)]
        self.records = np.concatenate([np.zeros((of.count, 0), PIECE), *self.lines], axis=1)

    def _piece(self, start: Any, stop: Any, coefficients: Sequence[Any]) -> Any:
        piece = np.zeros((self._of.count, 1), PIECE)
        piece["start"][:, 0], piece["stop"][:, 0], piece["order"] = start, stop, SMOOTH
        for m, c in enumerate(coefficients):
            piece["coefficient"][:, 0, m] = c
        piece["degree"] = POINTS - 1 if np.any(piece["coefficient"][..., 1:]) else 0
        return piece

    def _fitted(self, curve: waves.Curve) -> Any:
        made = waves.fitted(curve, self._tolerance)
        self.fit = max(self.fit, made.error / self._scale)
        piece = np.zeros((1, len(made.order)), PIECE)
        piece["start"], piece["stop"], piece["order"] = made.ticks[:-1], made.ticks[1:], made.order
        piece["coefficient"] = made.coefficients
        piece["degree"] = np.where(np.any(made.coefficients[:, 1:], axis=1), POINTS - 1, 0)
        return piece

    def _under_way(self, s: int) -> None:
        """Waves that run through segment s at t = 0: a = v - c strain, and b = v + c strain."""
        row, of = self._row, self._of
        body = next(i for i, (first, last) in enumerate(row.spans) if first <= s + 1 <= last)
        rod: Any = row.system.bodies[body]
        c = row.segments[s].wave_speed
        if not isinstance(rod.velocity, Steps | Samples) and (
            not isinstance(rod.strain, Steps | Samples)
        ):
            v, stretch = of(rod.velocity) - of(row.frame), of(rod.strain) * of(c)
            for wave in (v - stretch, v + stretch):
                self.lines.append(self._piece(-self._ticks[:, s], 0, [wave]))
            return
        L, T = float(row.segments[s].length), int(self._ticks[0, s])
        begin = sum(float(row.segments[i].length) for i in range(row.spans[body][0] - 1, s))
        length = float(rod.length)
        state = [waves.part_of(waves.curve_of(p, length), begin, begin + L)
                 for p in (rod.velocity, rod.strain)]
        self._miss(rod.velocity, 1.0)
        self._miss(rod.strain, float(c))
        marks = {share: tick for (place, share), tick in
                 zip(_jumps(row), self._jumps[0], strict=True) if place == s}
        for sign in (-1, 1):
            wave = waves.sum_of(state[0], state[1], sign * float(c))
            shares = (wave.edges - begin) / L
            edges = np.rint(shares * T).astype(np.int64)
            for share, tick in marks.items():
                edges[np.abs(shares - share) < 1e-12] = tick
            edges[0], edges[-1] = 0, T
            values = wave.values - float(row.frame)
            if sign < 0:  # what is at x left the left end x/c ago
                self.lines.append(self._fitted(
                    waves.Curve(-edges[::-1], values[::-1, ::-1], wave.smooth)))
            else:
                self.lines.append(self._fitted(waves.Curve(edges - T, values, wave.smooth)))

    def breaks(self, time: Any) -> Any:
        """How many breaks are given in so many ticks, where they are densest."""
        most = np.zeros(self._of.count, np.int64)
        for known in self.lines:
            hard = (known["order"][:, 1:] <= HARD).sum(axis=1)
            span = known["stop"][:, -1] - known["start"][:, 0]
            most = np.maximum(most, (hard * (time / np.maximum(span, 1))).astype(np.int64))
        return most

    def _miss(self, profile: Any, factor: float) -> None:
        """Count the error of samples, in the unit of velocities."""
        if isinstance(profile, Samples):
            self.fit = max(self.fit, abs(factor) * profile.error / self._scale)

    def _outside(self, side: int) -> int:
        """What comes from outside an end; returns its line, NONE for the free end of a rod."""
        row, of = self._row, self._of
        kind, value = row.outside[side]
        first, stop = row.first[-2:] if side else row.first[:2]
        if kind == "none" and first == stop:
            return NONE
        factor, start, slope = 1.0, np.zeros(of.count), np.zeros(of.count)
        if kind == "velocity":
            start, slope = -of(row.frame), -of(row.gravity)
        elif kind == "absorbing":
            wave = self.lines[2 * (len(row.segments) - 1) + 1 if side else 0]
            start = wave["coefficient"][:, -1].sum(axis=1)  # at the end of its last piece
        if kind == "absorbing" and not isinstance(value, Steps | Samples):
            start = start + of(value) * of(row.wave_of_strain(side))
            value = 0.0
        elif kind == "absorbing":
            factor = float(row.wave_of_strain(side))
        self.lines.append(self._driven(side, value, factor, start, slope))
        return len(self.lines) - 1

    def _driven(
        self, side: int, value: Any, factor: float, start: Any, slope: Any
    ) -> Any:
        of, tick = self._of, self._tick
        if not isinstance(value, Steps | Samples):
            start = start + of(value) * factor
            if not np.any(slope):
                return self._piece(0, NEVER, [start])
            stop = np.rint(self._until / tick).astype(np.int64) + 1
            half = slope * stop * tick / 2
            return self._piece(0, stop, [start + half, half])
        assert self._until is not None
        end = max(self._until, float(tick[0]))
        drive = waves.curve_of(value, end)
        edges = np.rint(drive.edges / tick[0]).astype(np.int64)
        edges[-1] += 1
        times = edges[:-1, None] + np.diff(edges)[:, None] * waves.SHARES
        shift = float(start[0]) + float(slope[0]) * times * tick[0]
        least = min((float(s.impedance) for s in self._row.segments), default=math.inf)
        self._miss(value, 2 / least if self._row.outside[side][0] == "force" else factor)
        return self._fitted(waves.Curve(edges, drive.values * factor + shift, drive.smooth))


def _records(
    row: Row, of: _Members, ticks: Any, pieces: _Pieces, keep: bool
) -> tuple[Any, ...]:
    """Nodes, links, masses, lines and parts of all members."""
    n, count = len(row.segments), of.count
    node, link = np.zeros((count, n + 1), NODE), np.zeros((count, len(row.laws)), LINK)
    mass = np.zeros((count, len(row.masses)), MASS)
    mass["mass"], mass["line"] = [of(m) for m in row.masses] and np.stack(
        [of(m) for m in row.masses], axis=1), NONE
    for m, v in enumerate(row.mass_velocity):
        mass["speed"][:, m, :] = (of(v) - of(row.frame))[:, None]
    for name in ("in_left", "in_right", "out_left", "out_right", "speed_line"):
        node[name] = NONE
    mobility = np.array([1 / of(s.impedance) for s in row.segments]).reshape(n, count)
    for k in range(n + 1):
        at = node[:, k]
        at["first"], at["mass"] = k + row.first[k], row.first[k]
        at["links"] = row.first[k + 1] - row.first[k] + 1
        if k > 0:
            at["in_left"], at["out_left"] = 2 * k - 2, 2 * k - 1
            at["mobility_left"] = mobility[k - 1]
        if k < n:
            at["in_right"], at["out_right"] = 2 * k + 1, 2 * k
            at["mobility_right"] = mobility[k]
    for side, k in ((0, 0), (1, n)):
        name, at = ("left", "right")[side], node[:, k]
        if pieces.outside[side] == NONE:
            at["mirror"] = 1
            continue
        at[f"in_{name}"] = pieces.outside[side]
        if row.outside[side][0] == "absorbing":
            at[f"mobility_{name}"] = mobility[k - side]
    _set_links(row, of, node, link)
    extra: list[int] = []
    if keep:
        extra = _kept(row, link, mass, len(pieces.lines))
    line = np.zeros((count, len(pieces.lines) + len(extra)), LINE)
    line["first"] = line["head"] = line["tail"] = NONE
    first = 0
    for l, known in enumerate(pieces.lines):
        stop = first + known.shape[1]
        line["delay"][:, l] = ticks[:, l // 2] if l < 2 * n else 0
        line["first"][:, l] = line["head"][:, l] = first
        line["tail"][:, l] = stop - 1
        line["hard"][:, l] = (known["order"][:, 1:] <= HARD).sum(axis=1)
        pieces.records["line"][:, first:stop] = l
        pieces.records["after"][:, first:stop] = [*range(first + 1, stop), NONE]
        first = stop
    part = _parts(row, of, link, pieces)
    return node, link, mass, line, part


def _set_links(row: Row, of: _Members, node: Any, link: Any) -> None:
    """Laws and numbers of all links."""
    for name in ("force_line", "overlap_line", "closing_line", "first", "last", "apart",
                 "left_group", "right_group"):
        link[name] = NONE
    link["order"], link["opened"] = SMOOTH, 1
    for k in range(node.shape[1]):
        first, stop = k + row.first[k], k + 1 + row.first[k + 1]
        for i in range(first, stop):
            it, law = link[:, i], LAWS[row.laws[i]]
            if law == Law.PUSH_LEFT and i > 0 and i == len(row.laws) - 1:
                law = Law.PUSH_RIGHT
            it["law"], it["stiffness"], it["exponent"] = law, of(row.stiffness[i]), of(
                row.exponent[i])
            it["strength"], it["overlap"] = of(row.strength[i]), -of(row.gap[i])
            name = {Law.IMPACT: "restitution", Law.YIELD: "hardening"}.get(law, "damping")
            it[name] = of(row.damping[i])
            opens = law >= Law.RIGID
            it["status"] = np.where(of(row.gap[i]) > 0, Status.OPEN, Status.PRESS) if opens else (
                Status.FIXED)
            if law == Law.IMPACT:  # what touches is struck by the first look at it
                it["status"] = Status.OPEN
            if i == first:
                it["mobility"] += node["mobility_left"][:, k]
            if i == stop - 1:
                it["mobility"] += node["mobility_right"][:, k]


def _set_ease(it: Any, row: Row, of: _Members, i: int, time: Any, scale: Any) -> None:
    """Set the velocity that a force in a link makes in a time; the force of impacts that is one."""
    ease = it["mobility"].copy()
    for kind, m in row.beside[i]:
        if kind == "mass":
            ease += time / of(row.masses[m])
    it["ease"] = ease
    if row.laws[i] == old.IMPACT:
        it["strength"] = scale / ease
    elif row.laws[i] == old.OWN:
        it["function"], it["near"], it["near_rate"] = i, NEAR * scale * time, NEAR * scale


def _kept(row: Row, link: Any, mass: Any, count: int) -> list[int]:
    """Number the lines that keep what happens in links and masses, from `count` on."""
    extra: list[int] = []

    def next_line() -> int:
        extra.append(count + len(extra))
        return extra[-1]

    for i in range(link.shape[1]):
        link["force_line"][:, i] = next_line()
        if row.laws[i] == old.JOINT or row.laws[i] >= old.RIGID:
            link["overlap_line"][:, i] = next_line()
        if row.laws[i] == old.YIELD:
            link["closing_line"][:, i] = next_line()
    for m in range(mass.shape[1]):
        mass["line"][:, m] = next_line()
    return extra


def _parts(row: Row, of: _Members, link: Any, pieces: _Pieces) -> Any:
    """What groups of bodies between contacts that open are made of, from left to right."""
    parts: list[Any] = []
    heads: list[int] = []
    begun = False

    def add(kind: Part, index: int, mass: Any = 0.0, compliance: Any = 0.0) -> None:
        nonlocal begun
        if not begun:
            heads.append(len(parts))
            begun = True
        it = np.zeros(of.count, PART)
        it["kind"], it["index"], it["mass"], it["compliance"], it["held"] = (
            kind, index, mass, compliance, NONE)
        parts.append(it)

    for i, ((kind, at), _) in enumerate(row.beside):
        _add_side(row, of, add, kind, at)
        if row.laws[i] >= old.RIGID:
            link["left_group"][:, i], link["right_group"][:, i] = heads[-1], len(parts)
            begun = False
        elif row.laws[i] == old.JOINT:
            k = of(row.stiffness[i])
            add(Part.JOINT, i, 0.0, np.divide(1.0, k, out=np.zeros_like(k), where=k > 0))
    _add_side(row, of, add, *row.beside[-1][1])
    table = np.stack(parts, axis=1)
    for head, stop in zip(heads, [*heads[1:], len(parts)], strict=True):
        table["parts"][:, head] = stop - head
        for p in range(head, stop):
            if table["kind"][0, p] == Part.GROUND:
                side = int(p != 0)
                table["held"][:, head] = pieces.outside[side]
                table["index"][:, p] = (
                    finality.ENDLESS if row.outside[side][0] == "absorbing" else finality.WALL)
                if row.outside[side][0] == "absorbing":
                    table["compliance"][:, p] = 1e300
    return table


def _add_side(row: Row, of: _Members, add: Any, kind: str, at: int) -> None:
    if kind == "segment":
        s = row.segments[at - 1]
        add(Part.SEGMENT, at - 1, of(s.mass), of(s.transit_time) / of(s.impedance))
    elif kind == "mass":
        add(Part.MASS, at, of(row.masses[at]))
    elif row.outside[at][0] in ("velocity", "absorbing"):
        add(Part.GROUND, at)
