"""What became of the members of a family, whatever method ran them together."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .signals import Floats, Ints

STOPPED_BY = ("final", "max_events", "clock", "refused", "until")
"""Why a member stopped; where it cannot be solved it is refused."""

READ = ("dissipated", "set", "largest_stress", "displacement")
ALSO = (*READ, "accuracy")
"""What is found of a member only if it is asked for, as that takes longer: the energy lost in
contacts, J; how far each yielding contact has yielded for good, m; the largest absolute stress in
each rod, Pa; how far the centre of mass of each body has moved at the end of the run, m; and the
largest stated relative error of velocities, impulses and peak forces."""

now = getattr(time, "thread_time", time.perf_counter)  # a browser has no clock of threads


class Stopped(Exception):
    """A run was told to stop."""


class FamilyRun(NamedTuple):
    """Totals of every member, in C order and SI units; nan where a member was refused.

    before, after : by body, velocity; vibration : energy left in all bodies together;
    contacts : by the names of `ContactTally`, by contact;
    final : whether it is proved that nothing meets again; stopped_by : place in `STOPPED_BY`;
    further : columns of what was asked for of `ALSO`, by name: ``"dissipated"``; ``"set.k"`` of
    contact k if it yields; ``"largest_stress.i"`` of body i if it is a rod; ``"displacement.i"``;
    ``"accuracy"``.
    """

    before: Sequence[Floats]
    after: Sequence[Floats]
    vibration: Floats
    contacts: Mapping[str, Sequence[Floats]]
    final: Floats
    stopped_by: Ints
    further: Mapping[str, Floats] = {}
