"""What happened at each contact: force, gap, and the episodes of touching."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from .fields import Fields
from .methods.assembly import Assembly
from .methods.clockwork import PARTS
from .methods.front_kernel import OPEN, PRESS
from .model import Bonded, Rigid
from .signals import Floats, Side, StepSignal
from .wave_fields import WaveFields

Turns: TypeAlias = tuple[list[int], list[int]]

LATEST = 2.0  # steps, by which a gap can close later than its contact first presses


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
    fields: Fields, forces: Sequence[Floats], gaps: Sequence[Floats], paths: Sequence[Floats],
    tallies: Sequence[ContactTally], least: float,
) -> tuple[ContactHistory, ...]:
    """Histories of all contacts, from the mean force in each step and the gaps at step ends.

    Parameters
    ----------
    fields : Fields
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
        ticks = PARTS * np.arange(max(1, len(force)))
        if not len(force):
            force, gap, path = np.zeros(1), np.repeat(gap, 2), np.zeros(1)
        bonded = isinstance(fields.assembly.system.contacts[i], Bonded)
        episodes = () if bonded else _episodes_of_steps(
            force, gap, PARTS * fields.assembly.tick, least
        )
        found.append(ContactHistory(
            i, fields, tally, episodes, StepSignal(ticks, force), gap[:-1], np.diff(gap) / PARTS,
            StepSignal(ticks, force * path / PARTS),
        ))
    return tuple(found)


def _episodes_of_steps(
    force: Floats, gap: Floats, step: float, least: float
) -> tuple[Episode, ...]:
    """Touchings that carried force: from the first force until a gap has opened.

    A gap has opened once it passes `least`, if it does so before the next force.
    """
    pressing = np.flatnonzero(force > 0)
    opened = np.flatnonzero((force <= 0) & (gap[1:] > least))
    found, j = [], 0
    while j < len(pressing):
        start = int(pressing[j])
        k = int(np.searchsorted(opened, start))
        end = int(opened[k]) if k < len(opened) else len(force)
        after = int(np.searchsorted(pressing, end))
        last = int(pressing[after - 1])
        force_end = opening = np.nan
        if last + 1 < len(force):
            force_end = max(_end_of_force(gap, last), _closing(gap, start))
        if k < len(opened):
            opening = max(_opening(gap, end), force_end)
        found.append(Episode(_closing(gap, start) * step, force_end * step, opening * step))
        j = after
    return tuple(found)


def _closing(gap: Floats, j: int) -> float:
    """When a contact closed that presses in step j for the first time; in steps.

    Its gap goes on as in the step before.
    """
    fell = float(gap[j - 1] - gap[j]) if j else float(gap[0] - gap[1])
    return j + (float(gap[j]) / fell if 0 < gap[j] < LATEST * fell else 0.0)


def _end_of_force(gap: Floats, j: int) -> float:
    """When a force ends that acts in step j for the last time; in steps."""
    return j + (float(gap[j] / (gap[j] - gap[j + 1])) if gap[j] < 0 < gap[j + 1] else 1.0)


def _opening(gap: Floats, j: int) -> float:
    """When a gap that is open at the end of step j was 0 for the last time; in steps."""
    shut = np.flatnonzero(gap[: j + 1] <= 0)
    if not len(shut):
        return j
    i = int(shut[-1])
    return i + float(gap[i] / (gap[i] - gap[i + 1]))
