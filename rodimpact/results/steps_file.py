"""Files of schema 3, whose signals were all constant between jumps, made into pieces.

There a contact had the gap as each piece of its force began, m, its rate, m per tick, and the power
of the force, J per tick; the outside had its power, W, and masses their velocities at the edges of
steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..methods.clock import Clock
from ..methods.run import INWARD, ContactSignal, Outside, Signals
from ..methods.signals import Floats, Pieces

SCHEMA = 3
KINDS: dict[str, Any] = {
    "StepSignal": lambda ticks, values: Pieces(ticks, values),
    "ContactSignal": dict, "Outside": dict, "Signals": dict,
    "Clock": lambda **values: Clock(**{k: v for k, v in values.items() if k != "grain"}),
}
"""What the classes of such a file are read as, where they have changed."""


def signals_of(old: Mapping[str, Any], clock: Clock, end: int) -> Signals:
    """Signals to the tick `end`, of what such a file has under that name."""
    outside = [
        side and Outside(side["kind"], side["push"], _ratio(side["power"], side["push"], sign))
        for side, sign in zip(old["outside"], INWARD, strict=True)
    ]
    masses = {body: Pieces.through(old["edges"], V) for body, V in old["masses"].items()}
    contacts = tuple(_contact(contact, clock.tick, end) for contact in old["contacts"])
    return Signals(old["motion"], contacts, (outside[0], outside[1]), old["edges"], masses)


def _contact(old: Mapping[str, Any], tick: float, end: int) -> ContactSignal:
    force, gap, rate = old["force"], old["gap"], old["rate"]
    until = gap + rate * np.diff(force.ticks, append=end)
    return ContactSignal(
        force, Pieces.lines(force.ticks, gap, until, end),
        _ratio(old["power"], force, 1 / tick, -rate / tick), old["episodes"],
    )


def _ratio(power: Pieces, force: Pieces, factor: float, otherwise: Floats | float = 0.0) -> Pieces:
    """The velocity power/force times a factor, and another one where there is no force."""
    velocity = np.zeros(len(force.ticks)) + otherwise
    np.divide(power.values * factor, force.values, out=velocity, where=force.values != 0)
    return Pieces(force.ticks, velocity)
