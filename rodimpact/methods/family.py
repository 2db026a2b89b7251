"""What became of the members of a family, whatever method ran them together."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..model.frozen import Number
from .row import Array
from .signals import Floats, Ints

STOPPED_BY = ("final", "max_events", "clock", "refused", "until")
"""Why a member stopped; where it cannot be solved it is refused."""

now = getattr(time, "thread_time", time.perf_counter)  # a browser has no clock of threads


class Stopped(Exception):
    """A run was told to stop."""


class FamilyRun(NamedTuple):
    """Totals of every member, in C order and SI units; nan where a member was refused.

    before, after : by body, velocity; vibration : energy left in all bodies together;
    contacts : by the names of `ContactTally`, by contact, nan where it cannot open;
    final : whether it is proved that nothing meets again; stopped_by : place in `STOPPED_BY`.
    """

    before: Sequence[Floats]
    after: Sequence[Floats]
    vibration: Floats
    contacts: Mapping[str, Sequence[Floats]]
    final: Floats
    stopped_by: Ints


def table(columns: Sequence[Number], shape: tuple[int, ...]) -> Array:
    """Numbers of a family of some shape, with a row for each member in C order."""
    given = np.empty((int(np.prod(shape)), len(columns)))
    for place, column in enumerate(columns):
        given[:, place] = column if isinstance(column, float) else np.broadcast_to(
            column, shape).ravel()
    return given
