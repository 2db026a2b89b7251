"""The result of every method for a collision: a `Run`, in plain numbers and arrays.

Totals are known when the run ends. Signals are made on request, so that a user who
wants only the outcome does not wait for them.
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
"""Default cap on the events of a run: arrivals at ends."""
MEASURES = ("velocity", "impulse", "peak force", "duration", "time")
VELOCITY, IMPULSE, PEAK_FORCE, DURATION, TIME = MEASURES
"""Measures that can have a stated error.

The times are those at which forces begin and end, and at which gaps open.
"""
STOPPED_BY = ("final", "max_events", "clock", "refused", "until")
"""Reasons why a member stopped; a member that cannot be solved is refused."""

READ = ("dissipated", "set", "largest_stress", "displacement")
ALSO = (*READ, "accuracy")
"""Results of a member that are found only on request, as they take longer.

They are, in this order: the energy lost in contacts, J; the permanent set of each
yielding contact, m; the largest absolute stress in each rod, Pa; the displacement of
the centre of mass of each body at the end of the run, m; and the largest stated
relative error of velocities, impulses and peak forces.
"""


def largest_error(accuracy: Mapping[str, float]) -> float:
    """Largest stated relative error of velocities, impulses and peak forces.

    `accuracy` has the errors by measure; a measure that it lacks counts as 0. Errors of
    durations and times do not count, as they may depend on faint forces.
    """
    stated = [accuracy.get(name, 0.0) for name in (VELOCITY, IMPULSE, PEAK_FORCE)]
    return max(stated)


@explain_missing()
class Episode(NamedTuple):
    """One uninterrupted touching that carried force.

    Attributes
    ----------
    start : float
        Time at which the force begins, s.
    force_end : float
        Time at which the last force ends, s; nan if it lasts to the end of the run.
    opening : float
        Time at which the gap opens, s; nan if it has not opened.

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

    At each of `ticks` the contact takes on the `Status` with the same index in
    `statuses`: PRESS, GRAZE or OPEN. An episode lasts from PRESS to OPEN; GRAZE ends
    only its force, and a further PRESS continues the episode. If the last episode has
    not ended, its opening is nan, and so is its `force_end` if it still presses. `tick`
    is the duration of a tick, s.
    """
    episodes: list[Episode] = []
    start = math.nan  # nan while no episode is under way
    force_end = math.nan  # nan while the contact presses
    for change_tick, status in zip(ticks, statuses, strict=True):
        t = float(change_tick) * tick
        if status == Status.PRESS:
            force_end = math.nan
            if math.isnan(start):  # an episode begins
                start = t
        elif not math.isnan(start):
            if math.isnan(force_end):  # the force ends now
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
        Times at which the force first begins and last ends, s; nan if there was no
        force.
    episodes : int
        Number of times that the contact closed and pressed.

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
    """Signals and episodes of one contact, from t = 0 on.

    Attributes
    ----------
    force : Pieces
        Contact force, N; positive if it presses the two bodies apart.
    gap : Pieces
        m; if there is an overlap, minus the overlap.
    closing : Pieces
        Velocity of the left body's face minus that of the right body's face, m/s.
        Force times this velocity is the power that the contact takes up.
    episodes : tuple of Episode
    """

    force: Pieces
    gap: Pieces
    closing: Pieces
    episodes: tuple[Episode, ...]


class BoundaryAction(NamedTuple):
    """The action from outside on one end of the row.

    Attributes
    ----------
    kind : str
        ``"wall"``, ``"drive"`` or ``"absorbing"``.
    push : Pieces
        Force on the row, N, positive inward: to the right at the left end, to the left
        at the right end.
    speed : Pieces
        Velocity of the point on which the push acts, m/s, positive to the right. The
        power is push times speed, with the sign of `INWARD`.
    """

    kind: str
    push: Pieces
    speed: Pieces


INWARD = (1, -1)
"""Direction in which a positive push acts on the left and right end of the row."""


class ShaftAction(NamedTuple):
    """The action of soil or drag on a rod along its shaft.

    Attributes
    ----------
    push : Pieces
        Force on the rod, N, positive to the right.
    power : Pieces
        Power into the rod, W; negative where energy is taken from the rod.
    """

    push: Pieces
    power: Pieces


class Waves(NamedTuple):
    """End signals by line, m/s.

    Line 2 s is the wave that leaves the left end of segment s, line 2 s + 1 the wave
    that leaves its right end, in the frame of the clock. A line without waves is None.
    """

    lines: Sequence[Pieces | None]


class Signals(NamedTuple):
    """The motion in a run, as signals.

    Attributes
    ----------
    motion : Waves or GridMotion
    contacts : tuple of ContactSignal
    boundary_actions : (BoundaryAction or None, BoundaryAction or None)
        At the left and the right end; None at a free or fixed end.
    edges : [n] array of int or None
        Ends of the time steps of a grid, ticks, from 0 on: its signals are means
        between them. None for other methods.
    masses : dict of int to Pieces
        Velocities of rigid masses, by body, m/s, in the frame of the clock.
    shafts : dict of int to ShaftAction
        By the number of the rod, for rods on which soil or drag acts.
    """

    motion: Any
    contacts: tuple[ContactSignal, ...]
    boundary_actions: tuple[BoundaryAction | None, BoundaryAction | None]
    edges: Ints | None = None
    masses: Mapping[int, Pieces] = {}
    shafts: Mapping[int, ShaftAction] = {}


class Stopped(Exception):
    """A run was stopped at the request of its caller."""


class Coarser(NamedTuple):
    """The same collision on a coarser mesh, with which fields are compared.

    Attributes
    ----------
    share : float
        Bound of the error of a field on the finer mesh, divided by the difference of
        the fields on both meshes.
    steep : bool
        Whether waves jump and stay steep: then velocity and stress at a jump converge
        on no mesh.
    make_run : function
        Makes the `Run` on the coarser mesh.
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
        The given end, s.
    clock : Clock
    end : int
        Last tick.
    t_end, t_final, t_proved : float
        Times, s: the end of the run; the end of the last contact, see
        `status.last_contact`; and the proof that no contact can press again, nan
        without a proof.
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    status : str
        The reason why the run stopped in a sentence, with the remedy.
    events : int
        Arrivals at ends, steps of nodes, or time steps times ends.
    contacts : tuple of ContactTally
    totals : Totals or None
        None if they are to be computed from the fields.
    motion : (Motion, Motion) or None
        Motion before and after, if the kernel computes it; the motion before has only
        velocities.
    accuracy : dict of str to float
        Stated relative errors by measure, one of `MEASURES`; velocities are relative to
        the velocity scale, others to the largest value. A measure without a stated
        error is missing.
    coarser : tuple of Coarser
        Empty if a single mesh was requested, for a run from a file, or if the method
        has no mesh.
    make_signals : function
        Called without arguments, makes the `Signals`.
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
        """Whether it is proved that no contact can press again."""
        return not math.isnan(self.t_proved)

    @cached_property
    def signals(self) -> Signals:
        """All signals of the run, made when they are first asked for."""
        signals = self.make_signals()
        # The old function holds the records of the run, which are no longer needed.
        # `_replace` without arguments returns the same signals. The class is frozen.
        object.__setattr__(self, "make_signals", signals._replace)
        return signals

    def __getstate__(self) -> dict[str, Any]:
        """The pickled attributes: all of them and the signals, but no coarser runs."""
        return {"signals": self.signals, **vars(self), "coarser": ()}
