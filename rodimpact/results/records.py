"""What a method keeps besides the waves: contact signals, and what acts from outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..methods.fronts.assembly import Assembly
from ..model import Absorbing, Fixed, Free, Wall
from .contacts import ContactHistory, ContactTally, Turns, histories_of_fronts, histories_of_steps
from .energy import Outside
from .fields import Fields
from .signals import Floats, Ints, StepSignal
from .wave_fields import WaveFields

Ends = tuple[Outside | None, Outside | None]


class Record(Protocol):
    """What a solution asks of its method's record."""

    def histories(
        self, fields: Fields, tallies: Sequence[ContactTally]
    ) -> tuple[ContactHistory, ...]:
        """History of each contact."""

    def outside(self, fields: Fields, contacts: Sequence[ContactHistory]) -> Ends:
        """What acts on the left and on the right end of the row."""


@dataclass(frozen=True)
class FrontRecord:
    """Of the method "fronts": ticks and values of the changes of status of each contact."""

    turns: list[Turns]

    def histories(  # noqa: D102
        self, fields: Fields, tallies: Sequence[ContactTally]
    ) -> tuple[ContactHistory, ...]:
        assert isinstance(fields, WaveFields)
        assert isinstance(fields.assembly, Assembly)
        return histories_of_fronts(fields, fields.assembly, self.turns, tallies)

    def outside(self, fields: Fields, contacts: Sequence[ContactHistory]) -> Ends:  # noqa: D102
        found: list[Outside | None] = []
        system = fields.assembly.system
        for place, sign, end in ((0, 1, system.ends[0]), (-1, -1, system.ends[1])):
            wall = system.bodies[place]
            if isinstance(wall, Wall):
                push = contacts[place].push
                power = StepSignal(push.ticks, sign * float(wall.velocity) * push.values)
                found.append(Outside("wall", push, power))
            elif isinstance(end, Free | Fixed):
                found.append(None)
            else:
                kind = "absorbing" if isinstance(end, Absorbing) else "drive"
                assert isinstance(fields, WaveFields)
                found.append(_at_end(fields, place, sign, kind))
        return found[0], found[1]


def _at_end(fields: WaveFields, place: int, sign: int, kind: str) -> Outside:
    """What acts on the first (0) or the last (-1) end, from the waves there."""
    a = fields.assembly
    s = range(len(a.ticks))[1:-1][place]
    inward, outward = fields.waves(s)[:: 1 if place == 0 else -1]
    T = a.ticks[s]
    ticks = np.unique(np.concatenate(([0], inward.ticks, outward.ticks + T)))
    ticks = ticks[(ticks >= 0) & (ticks <= fields.end)]
    new, old = inward.at(ticks), outward.at(ticks - T)
    push = sign * a.impedance[s] * (new - old) / 2
    speed = (new + old) / 2 + a.frame
    return Outside(kind, StepSignal(ticks, push), StepSignal(ticks, sign * push * speed))


@dataclass(frozen=True)
class StepRecord:
    """Of the methods on a time step.

    Attributes
    ----------
    edges : [steps + 1] array of int
        Ticks from 0 to the end, between which forces are means.
    forces, gaps : list of arrays
        By contact: [steps] mean force, N, and [steps + 1] gap, m, from t = 0 on.
    paths : list of arrays
        By contact: [steps] how far it closes under its force, m.
    least : float
        Gap that counts as an opening, m: what the method can tell from none.
    ends : list of (str, array, array) or None
        Left and right: kind, force on the row, N, and its velocity, m/s, by step.
    """

    edges: Ints
    forces: list[Floats]
    gaps: list[Floats]
    paths: list[Floats]
    ends: list[tuple[str, Floats, Floats] | None]
    least: float = 0.0

    def histories(  # noqa: D102
        self, fields: Fields, tallies: Sequence[ContactTally]
    ) -> tuple[ContactHistory, ...]:
        return histories_of_steps(
            fields, self.edges, self.forces, self.gaps, self.paths, tallies, self.least
        )

    def outside(  # noqa: D102
        self, fields: Fields, contacts: Sequence[ContactHistory]  # noqa: ARG002
    ) -> Ends:
        found: list[Outside | None] = []
        for end, sign in zip(self.ends, (1, -1), strict=True):
            if end is None or not len(end[1]):
                found.append(None)
                continue
            kind, force, velocity = end
            ticks = self.edges[:-1]
            found.append(Outside(
                kind, StepSignal(ticks, force), StepSignal(ticks, sign * force * velocity)
            ))
        return found[0], found[1]
