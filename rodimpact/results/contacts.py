"""What happened at each contact: force, gap, and the episodes of touching."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..methods.fronts.assembly import Assembly
from ..methods.fronts.front_kernel import OPEN, PRESS
from ..model import Bonded, Rigid
from .fields import Fields
from .signals import Floats, Ints, Side, StepSignal
from .wave_fields import WaveFields

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses
FAINT = 1e-6  # of the next mean force: what presses less is round-off
SMOOTH = 0.3  # relative change of forces from step to step, beyond which they jump

Turns: TypeAlias = tuple[list[int], list[int]]


class Episode(NamedTuple):
    """One uninterrupted touching that carried force; times in s.

    start : first force; force_end : end of the last force (nan if it lasts to the end);
    opening : when the gap opens (nan if it has not).
    """

    start: float
    force_end: float
    opening: float


class ContactTally(NamedTuple):
    """Totals of one contact, kept while the run went: SI units, times nan where there was none.

    A bonded contact has an impulse and a largest push; the rest is for contacts that can open.
    """

    impulse: float
    peak_force: float
    duration: float
    first: float
    last: float
    episodes: int


class ContactHistory:
    """Force and gap of one contact.

    Attributes
    ----------
    index : int
        Between body `index` and body `index + 1`, walls counted.
    law : contact law
    impulse : float
        Integral of the force, N s.
    duration : float
        Time under force, s.
    peak_force : float
        N.
    episodes : tuple of Episode
    """

    def __init__(
        self, index: int, fields: Fields, tally: ContactTally, episodes: tuple[Episode, ...],
        force: StepSignal, gap: Floats, rate: Floats, work: StepSignal,
    ) -> None:
        self.index, self.law = index, fields.assembly.system.contacts[index]
        self.impulse, self.duration = tally.impulse, tally.duration
        self.peak_force, self.episodes = tally.peak_force, episodes
        self._fields, self._tick = fields, fields.assembly.tick
        self._force, self._gap, self._rate, self._work = force, gap, rate, work

    @property
    def push(self) -> StepSignal:
        """Force in ticks of the clock."""
        return self._force

    def force(self, t: ArrayLike, side: Side = "right") -> Floats:
        """Contact force, N, positive in compression; `side` decides at jumps.

        The method "characteristics" gives its mean over each step.
        """
        return self._force.at(self._fields.to_ticks(t, side), side)

    def gap(self, t: ArrayLike) -> Floats:
        """Distance between the two bodies, m.

        Exactly 0 while they touch rigidly; minus the indentation in a compliant contact.
        """
        ticks = self._fields.to_ticks(t, "right")
        i = np.searchsorted(self._force.ticks, ticks, "right") - 1
        result: Floats = self._gap[i] + self._rate[i] * (ticks - self._force.ticks[i])
        return np.maximum(result, 0.0) if isinstance(self.law, Rigid) else result

    def breakpoints(self) -> tuple[Floats, Floats, Floats]:
        """Times (s) at which force or gap rate may change, force just after (N), and gap (m)."""
        return self._force.ticks * self._tick, self._force.values.copy(), self._gap.copy()

    def impulse_until(self, t: ArrayLike) -> Floats:
        """Integral of the force from 0 to t, N s, from the signals."""
        return self._force.integral(0, self._fields.to_ticks(t)) * self._tick

    def work_until(self, t: ArrayLike) -> Floats:
        """Work from 0 to t, J, that the two bodies have done on the contact: force times closing.

        A compliant contact stores some of it; the rest is lost there.
        """
        return self._work.integral(0, self._fields.to_ticks(t))

    def __repr__(self) -> str:
        name = type(self.law).__name__
        return (
            f"<contact {self.index} ({name}): {len(self.episodes)} episodes, impulse "
            f"{self.impulse:.6g} N s, peak force {self.peak_force:.6g} N, under force "
            f"{self.duration:.6g} s>"
        )


# From the fronts ----------------------------------------------------------------------------------


def histories_of_fronts(
    fields: WaveFields, assembly: Assembly, turns: list[Turns], tallies: Sequence[ContactTally]
) -> tuple[ContactHistory, ...]:
    """Histories of all contacts, from the waves that arrive there and the changes of status."""
    return tuple(
        _history(i, fields, assembly, *pair)
        for i, pair in enumerate(zip(turns, tallies, strict=True))
    )


def _history(
    index: int, fields: WaveFields, a: Assembly, turns: Turns, tally: ContactTally
) -> ContactHistory:
    node = a.nodes[index]
    changes = StepSignal([-1, *turns[0]], [a.status[node], *turns[1]])
    left, right = (_arrivals(fields, a, node, side) for side in (0, 1))
    ticks = np.unique(np.concatenate(([0], left.ticks, right.ticks, changes.ticks)))
    ticks = ticks[(ticks >= 0) & (ticks <= fields.end)]
    closing = left.at(ticks) - right.at(ticks)
    yielding = sum(1 / a.impedance[s] for s in (node, node + 1) if a.impedance[s])
    status = changes.at(ticks)
    bonded = isinstance(a.system.contacts[index], Bonded)
    pressing = np.full(ticks.shape, True) if bonded else status == PRESS
    force = np.where(pressing, closing / yielding, 0.0)
    opening = np.where(status == OPEN, -closing, 0.0)
    opening[np.abs(opening) <= a.tolerance] = 0.0
    travelled = np.concatenate(([0.0], np.cumsum(opening[:-1] * np.diff(ticks))))
    # every change of status but the initial one leaves the gap at 0
    turn = np.searchsorted(ticks, changes.ticks[1:])
    last = np.searchsorted(changes.ticks[1:], ticks, "right") - 1
    zero = np.append(travelled[turn], -a.gaps[node])[last]
    gap = np.where(status == OPEN, travelled - zero, 0.0)
    episodes = () if bonded else _episodes_of_turns(changes, a.tick)
    rate = opening * a.tick
    return ContactHistory(
        index, fields, tally, episodes, StepSignal(ticks, force), gap * a.tick, rate,
        StepSignal(ticks, -force * rate),
    )


def _arrivals(fields: WaveFields, a: Assembly, node: int, right: int) -> StepSignal:
    segment = node + right
    if not a.impedance[segment]:
        return StepSignal([0], [a.outside[right]])
    wave = fields.waves(segment)[right]
    return StepSignal(wave.ticks + a.ticks[segment], wave.values)


def _episodes_of_turns(changes: StepSignal, beat: float) -> tuple[Episode, ...]:
    found: list[Episode] = []
    start = force_end = np.nan
    touching = False
    for tick, status in zip(changes.ticks[1:], changes.values[1:], strict=True):
        t = float(tick) * beat
        if status == PRESS:
            start, force_end = (start, np.nan) if touching else (t, np.nan)
            touching = True
        elif touching:
            force_end = t if np.isnan(force_end) else force_end
            if status == OPEN:
                found.append(Episode(start, force_end, t))
                touching = False
    if touching:
        found.append(Episode(start, force_end, np.nan))
    return tuple(found)


# From steps ---------------------------------------------------------------------------------------


def histories_of_steps(
    fields: Fields, edges: Ints, forces: Sequence[Floats], gaps: Sequence[Floats],
    paths: Sequence[Floats], tallies: Sequence[ContactTally], least: float,
) -> tuple[ContactHistory, ...]:
    """Histories of all contacts, from the mean force in each step and the gaps at step ends.

    Parameters
    ----------
    fields : Fields
    edges : [steps + 1] array of int
        Ticks.
    forces, gaps, paths : sequence of arrays
        By contact: [steps] N, [steps + 1] m from t = 0 on, and [steps] m by which the bodies
        approach under the force: beside the change of the gap what a grid loses as it shuts.
    tallies : sequence of ContactTally
    least : float
        Gap that counts as an opening, m.
    """
    found = []
    for i, (force, gap, path, tally) in enumerate(
        zip(forces, gaps, paths, tallies, strict=True)
    ):
        bonded = isinstance(fields.assembly.system.contacts[i], Bonded)
        times = edges * fields.assembly.tick
        episodes = () if bonded else _episodes_of_steps(times, force, gap, least)
        lasts = np.diff(edges)
        if not len(force):
            force, gap, path, lasts = np.zeros(1), np.repeat(gap, 2), np.zeros(1), np.ones(1)
        ticks = edges[: len(force)]
        found.append(ContactHistory(
            i, fields, tally, episodes, StepSignal(ticks, force), gap[:-1], np.diff(gap) / lasts,
            StepSignal(ticks, force * path / lasts),
        ))
    return tuple(found)


def pressed_spans(times: Floats, force: Floats, gap: Floats) -> list[tuple[float, float]]:
    """When a contact presses, from the mean force in each step and the gaps at step ends.

    A contact begins where its gap is closed that goes on as in the step before. A compliant one
    ends where its indentation does. The force of a rigid one ends with a jump inside its last step:
    after that share of it which its mean is of what the means before lead to. If it falls evenly,
    it ends where the line through the last means reaches 0.

    Parameters
    ----------
    times : [steps + 1] array
        Ends of steps, s.
    force, gap : [steps], [steps + 1] arrays
        N and m.

    Returns
    -------
    list of (float, float)
        Begin and end of each, s; nan for an end that does not come before the last time.
    """
    found = []
    for i, j in _pressing(force):
        begin = _begin_of_force(times, force, gap, i)
        running = j == len(force)
        end = math.nan if running else max(begin, _end_of_force(times, force, gap, i, j))
        found.append((begin, end))
    return found


def _pressing(force: Floats) -> list[tuple[int, int]]:
    """First and behind the last of the steps in which a contact presses without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], force > 0, [False]))))
    return [(int(i), int(j)) for i, j in edges.reshape(-1, 2)]


def _begin_of_force(times: Floats, force: Floats, gap: Floats, i: int) -> float:
    """When the force begins that first presses in step i."""
    start, width = float(times[i]), float(times[i + 1] - times[i])
    if i + 1 < len(force) and force[i] <= FAINT * force[i + 1]:
        return start + width
    before = max(i - 1, 0)
    fell = float(gap[before] - gap[before + 1]) / float(times[before + 1] - times[before]) * width
    return start + (width * float(gap[i]) / fell if 0 < gap[i] < LATEST * fell else 0.0)


def _end_of_force(times: Floats, force: Floats, gap: Floats, i: int, j: int) -> float:
    """When the force ends that presses in the steps i to j - 1."""
    start, end = float(times[j - 1]), float(times[j])
    if gap[j - 1] < 0:
        through = gap[j - 1] / (gap[j - 1] - gap[j]) if gap[j] > 0 else 1.0
        return start + (end - start) * float(through)
    if j - i >= 3:
        middles = (times[j - 3 : j + 1] + times[j - 2 : j + 2]) / 2
        fall, last_fall = (-np.diff(force[j - 3 : j]) / np.diff(middles[:-1])).tolist()
        if 0 < fall <= 2 * last_fall <= 4 * fall:
            zero = float(middles[2] + force[j - 1] / last_fall)
            if zero <= middles[3]:
                return zero
    return start + (end - start) * _share_of_jump(force[max(i, j - 4) : j][::-1])


def _share_of_jump(force: Floats) -> float:
    """Share of its step that a force presses which jumps, from up to four means, its own first.

    All of it where the mean differs from what those beside lead to by no more than their curvature.
    """
    own, *beside = force.tolist()
    if not beside:
        return 1.0
    smooth = len(beside) > 1 and max(beside) - min(beside) <= SMOOTH * beside[0]
    led = 2 * beside[0] - beside[1] if smooth else beside[0]
    curvature = abs(beside[0] - 2 * beside[1] + beside[2]) if smooth and len(beside) > 2 else 0.0
    return 1.0 if led - own <= 2 * curvature else float(own / led)


def _episodes_of_steps(
    times: Floats, force: Floats, gap: Floats, least: float
) -> tuple[Episode, ...]:
    """Touchings that carried force: from the first force until a gap has opened.

    A gap has opened once it passes `least`, if it does so before the next force.
    """
    steps, spans = _pressing(force), pressed_spans(times, force, gap)
    far, shut = np.flatnonzero(gap > least), np.flatnonzero(gap <= 0)
    found: list[Episode] = []
    for n, ((_, j), (begin, end)) in enumerate(zip(steps, spans, strict=True)):
        if found and found[-1].opening != found[-1].opening:
            begin = found.pop().start
        k = int(np.searchsorted(far, j))
        last = steps[n + 1][0] if n + 1 < len(steps) else len(force)
        opens = k < len(far) and far[k] <= last
        opening = max(_opening(times, gap, shut, int(far[k])), end) if opens else math.nan
        found.append(Episode(begin, end, opening))
    return tuple(found)


def _opening(times: Floats, gap: Floats, shut: Ints, k: int) -> float:
    """When a gap that is open at step end k was 0 for the last time; `shut` are all such ends."""
    last = int(np.searchsorted(shut, k)) - 1
    if last < 0:
        return float(times[max(k - 1, 0)])
    i = int(shut[last])
    share = float(gap[i] / (gap[i] - gap[i + 1]))
    return float(times[i]) + share * float(times[i + 1] - times[i])
