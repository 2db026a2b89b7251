"""What every method hands back of a collision: a `Run`, in plain numbers and arrays.

Totals are known when the run ends; signals are made when they are asked for, so that
who wants the outcome alone does not wait for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from ..hints import explain_missing
from ..model import System
from .clock import Clock
from .outcome import Motion, Totals
from .signals import Ints, Pieces
from .states import Status

MAX_EVENTS = 5_000_000
"""Arrivals at ends after which a run gives up where nothing else is asked for."""
MEASURES = ("velocity", "impulse", "peak force", "duration", "time")
VELOCITY, IMPULSE, PEAK_FORCE, DURATION, TIME = MEASURES
"""What can have a stated error.

Times are those at which forces begin and end, and gaps open.
"""
STOPPED_BY = ("final", "max_events", "clock", "refused", "until")
"""Why a member stopped; where it cannot be solved it is refused."""

READ = ("dissipated", "set", "largest_stress", "displacement")
ALSO = (*READ, "accuracy")
"""What is found of a member only if it is asked for, as that takes longer.

It is the energy lost in contacts, J; how far each yielding contact has yielded for
good, m; the largest absolute stress in each rod, Pa; how far the centre of mass of each
body has moved at the end of the run, m; and the largest stated relative error of
velocities, impulses and peak forces.
"""


def largest_error(accuracy: Mapping[str, float]) -> float:
    """Largest stated error of velocities, impulses and peak forces.

    It is 0 if none is stated.

    Those of durations and times do not count, as they may hang on faint forces.
    """
    return max((accuracy.get(name, 0.0) for name in MEASURES[:3]), default=0.0)


@explain_missing()
class Episode(NamedTuple):
    """One uninterrupted touching that carried force.

    Attributes
    ----------
    start : float
        When the force begins, s.
    force_end : float
        When the last force ends, s; nan if it lasts to the end of the run.
    opening : float
        When the gap opens, s; nan if it has not.

    Examples
    --------
    The force ends after 2 l1/c, the gap opens after 2 l2/c:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> (episode,) = ri.solve(ri.System([left, right])).contacts[0].episodes
    >>> c = steel.wave_speed
    >>> round(episode.force_end * c / 2, 12), round(episode.opening * c / 2, 12)     # m
    (0.4, 1.0)
    """

    start: float
    force_end: float
    opening: float


def episodes_of(ticks: Any, statuses: Any, tick: float) -> tuple[Episode, ...]:
    """Episodes with force, from the changes of a contact in order of time.

    At each of the `ticks` the contact takes on the `Status` of the same place: PRESS,
    GRAZE or OPEN. An episode lasts from PRESS to OPEN; GRAZE only ends its force, and
    PRESS goes on with it. The last episode may be under way: then its opening is nan,
    and its `force_end` too if it presses. `tick` is the duration of a tick, s.
    """
    episodes: list[Episode] = []
    start = math.nan  # nan while no episode is under way
    force_end = math.nan  # nan while the contact presses
    for when, status in zip(ticks, statuses, strict=True):
        t = float(when) * tick
        if status == Status.PRESS:
            force_end = math.nan
            if math.isnan(start):  # it begins
                start = t
        elif not math.isnan(start):
            if math.isnan(force_end):  # its force has just ended
                force_end = t
            if status == Status.OPEN:
                episodes.append(Episode(start, force_end, t))
                start = math.nan
    if not math.isnan(start):
        episodes.append(Episode(start, force_end, math.nan))
    return tuple(episodes)


@explain_missing()
class ContactTally(NamedTuple):
    """Totals of one contact.

    A bonded contact or a joint has an impulse and a peak force. The other totals belong
    to contacts that can open.

    Attributes
    ----------
    impulse : float
        Integral of the force, N s.
    peak_force : float
        N.
    duration : float
        Force duration, s: total time with force. By fronts, forces that give velocities
        below 2^-48 of the largest difference count as zero: a force that decays for
        ever ends there, and `Solution.accuracy` states the error of durations and
        times.
    first, last : float
        When the force first begins and last ends, s; nan if there was none.
    episodes : int
        How often the contact pressed.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> outcome = ri.solve(ri.System([left, right])).outcome
    >>> tally = outcome.contacts[0]
    >>> round(tally.impulse / left.mass, 12), tally.episodes     # J = m1 v
    (1.0, 1)
    """

    impulse: float
    peak_force: float
    duration: float
    first: float
    last: float
    episodes: int


class ContactSignal(NamedTuple):
    """What passed at one contact, from t = 0 on.

    Attributes
    ----------
    force : Pieces
        N; a push of the two bodies apart is positive.
    gap : Pieces
        m; minus the overlap.
    closing : Pieces
        Velocity of the left body's face minus that of the right one, m/s: the power of
        the force.
    episodes : tuple of Episode
    """

    force: Pieces
    gap: Pieces
    closing: Pieces
    episodes: tuple[Episode, ...]


class BoundaryAction(NamedTuple):
    """What acts on one end of the row.

    Attributes
    ----------
    kind : str
        ``"wall"``, ``"drive"`` or ``"absorbing"``.
    push : Pieces
        Force on the row, N: to the right at the left end, to the left at the right end.
    speed : Pieces
        Velocity of the point on which it acts, m/s, to the right. The power is push
        times speed, with the sign of `INWARD`.
    """

    kind: str
    push: Pieces
    speed: Pieces


INWARD = (1, -1)
"""Direction in which a positive push acts on the left and right end of the row."""


class ShaftAction(NamedTuple):
    """What soil or drag does to a rod along its shaft.

    Attributes
    ----------
    push : Pieces
        Force on the rod, N, to the right.
    power : Pieces
        W; negative where energy is taken from the rod.
    """

    push: Pieces
    power: Pieces


class Waves(NamedTuple):
    """End signals by line, m/s.

    They are what left the left (2s) and the right end (2s + 1) of segment s, in the
    frame of the clock; None where there is none.
    """

    lines: Sequence[Pieces | None]


class Signals(NamedTuple):
    """All that a run knows of the motion.

    Attributes
    ----------
    motion : Waves or GridMotion
    contacts : tuple of ContactSignal
    boundary_actions : (BoundaryAction or None, BoundaryAction or None)
        Left and right.
    edges : [n] array of int or None
        Ticks from 0 on between which the signals of a grid are means.
    masses : dict of int to Pieces
        Velocities of rigid masses, by body, m/s, in the frame of the clock.
    shafts : dict of int to ShaftAction
        By rod on which soil or drag acts.
    """

    motion: Any
    contacts: tuple[ContactSignal, ...]
    boundary_actions: tuple[BoundaryAction | None, BoundaryAction | None]
    edges: Ints | None = None
    masses: Mapping[int, Pieces] = {}
    shafts: Mapping[int, ShaftAction] = {}


class Stopped(Exception):
    """A run was told to stop."""


class Coarser(NamedTuple):
    """The same collision on a coarser mesh, with which fields are compared.

    Attributes
    ----------
    share : float
        Error of a field on the finer mesh over its difference from that on this one, at
        most.
    steep : bool
        Whether waves jump and stay steep, so that no mesh has the velocity and the
        stress there.
    make_run : function
        Makes the `Run`.
    """

    share: float
    steep: bool
    make_run: Callable[[], Run]


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A finished run of any method.

    Attributes
    ----------
    method : str
    until : float or None
        The end that was asked for, s.
    clock : Clock
    end : int
        Last tick.
    t_end, t_final, t_proved : float
        s; until when it ran; when the last contact ended, see `status.last_contact`;
        and when the run proved that no contact can happen again, nan without proof.
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    status : str
        The same in a sentence, with the remedy.
    events : int
        Arrivals at ends, steps of nodes, or time steps times ends.
    contacts : tuple of ContactTally
    totals : Totals or None
        None where they are to be read off the fields.
    motion : (Motion, Motion) or None
        Motion before and after, where the kernel adds it up; of that before only
        velocities.
    accuracy : dict of str to float
        Stated error of those of `MEASURES` that the method knows, relative to the
        largest value of each, where the method is not exact.
    coarser : tuple of Coarser
        None where a single mesh was asked for, in a file, or where the method has none.
    make_signals : function
    """

    method: str
    until: float | None
    clock: Clock
    end: int
    t_end: float
    t_final: float
    stopped_by: str
    status: str
    events: int
    contacts: tuple[ContactTally, ...]
    totals: Totals | None = None
    motion: tuple[Motion, Motion] | None = None
    accuracy: Mapping[str, float] = field(default_factory=dict)
    coarser: tuple[Coarser, ...] = ()
    make_signals: Callable[[], Signals]
    t_proved: float = math.nan

    @property
    def system(self) -> System:
        """The system that was run."""
        return self.clock.system

    @property
    def final(self) -> bool:
        """Whether it is proved that no contact can happen again."""
        return not math.isnan(self.t_proved)

    @cached_property
    def signals(self) -> Signals:
        """All signals of the run, made when they are first asked for."""
        signals = self.make_signals()
        # From now on the same signals are handed out, as `_replace` without arguments
        # does, so that the records behind `make_signals` may go.
        object.__setattr__(self, "make_signals", signals._replace)
        return signals

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled: all with the signals, but without coarser runs."""
        return {"signals": self.signals, **vars(self), "coarser": ()}
