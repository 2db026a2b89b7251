"""A finished run on a time step: its row and its clock, and what passed in each step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from .clock import STEP_TICKS, Clock
from .contact_law_kernel import Tally
from .row import Array, Row
from .run import GroupTotals


@dataclass(frozen=True, kw_only=True)
class SteppedRun(ABC):
    """A finished run on a time step.

    Attributes
    ----------
    clock : Clock
        Its tick is the step's `STEP_TICKS`-th part.
    row : Row
    step : float
        s.
    edges : [steps + 1] array of int
        Ticks from 0 on, between which signals are averages: steps, or parts of steps.
    end : int
        Last tick: of the steps, or of an end that comes before half of one.
    events : int
        Steps taken, times ends solved.
    tally, signals
        The kernel's, on arrays.
    finality_time : int
        Place in `edges` where the collision was proved final, -1 without proof.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Error of each measure of the outcome, relative to its largest value, as `refined` finds it;
        empty where the step was given.
    rtol : float
        What they were to come to.
    resolved : float
        Gap that counts as an opening, m.
    totals : GroupTotals or None
        At the proof of finality, or at the end; None where they are to be read off the fields.
    """

    clock: Clock
    row: Row
    step: float
    edges: Array
    end: int
    events: int
    tally: Tally
    signals: Any
    finality_time: int
    stopped_by: str
    estimates: dict[str, float] = field(default_factory=dict)
    rtol: float = 0.0
    resolved: float = 0.0
    totals: GroupTotals | None = None
    rough: ClassVar[Sequence[str]] = ("duration",)  # what need not come to `rtol`

    @property
    def steps(self) -> int:
        """Steps taken, or parts of steps."""
        return len(self.edges) - 1

    @property
    def durations(self) -> Array:
        """Of the steps, s."""
        return np.asarray(np.diff(self.edges) * self.clock.tick)

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; not of a bonded contact."""
        place = self.place(contact)
        gap = self.by_link(self.signals.gap, place) * self.step
        return self.by_link(self.signals.force, place), gap

    def by_link(self, column: Array, place: int) -> Array:
        """What a column of the signals has of a link, by its place in the tally."""
        return self.by_step(column, int(self.signals.link_start[place]))

    def by_step(self, column: Array, start: int) -> Array:
        """What a column of the signals has from `start` on."""
        return column[start : start + self.steps]

    @property
    @abstractmethod
    def largest_strain(self) -> float:
        """A bound of the strains."""

    @abstractmethod
    def place(self, contact: int) -> int:
        """Place in the tally of a contact that is not bonded."""

    @abstractmethod
    def path(self, contact: int) -> Array:
        """How far a contact that is not bonded closes in each step, m."""

    @abstractmethod
    def bond(self, contact: int) -> Array:
        """Mean force in a bonded contact in each step, N."""

    @abstractmethod
    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """

    @abstractmethod
    def speed(self, mass: int) -> Array:
        """Velocity of a mass at `edges`, in the frame, m/s."""


def clock_of_steps(
    row: Row, ticks: Sequence[int], step: float, impedance: Sequence[float], **rounding: Any
) -> Clock:
    """Put a row on the clock of a time step, s.

    Parameters
    ----------
    row : Row
    ticks, impedance : by segment
        Transit times, and kg/s.
    step : float
        s.
    **rounding
        `transit_error` and `worst` of the clock.
    """
    segments = row.segments
    return Clock(
        system=row.system, spans=row.spans, ticks=[0, *ticks, 0], tick=step / STEP_TICKS,
        wave_speed=[0.0, *(float(s.wave_speed) for s in segments), 0.0],
        impedance=[0.0, *impedance, 0.0],
        length=[0.0, *(float(s.length) for s in segments), 0.0],
        frame=row.frame, scale=row.scale, gravity=float(row.gravity), grain=STEP_TICKS, **rounding,
    )
