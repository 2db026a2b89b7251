"""What a run adds up to: the energy ledger at its beginning and its end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..methods.groups import groups, velocities_in_group
from ..methods.run import INWARD, Run, Totals
from .bonded_groups import bonded_groups
from .contacts import ContactHistory
from .energy import ledger
from .fields import Fields


def totals_of(run: Run, fields: Fields, contacts: Sequence[ContactHistory]) -> Totals:
    """Read the totals off the fields of a finished run."""
    system, clock, signals = run.system, run.clock, run.signals
    count, ticks = len(system.bodies), np.unique(fields.nearest_known(np.array([0, run.end])))
    states = bonded_groups(system, fields, ticks)
    book = ledger(fields, contacts, signals.outside, states)
    masses = [clock.mass(i) for i in range(count)]
    velocity, vibration = np.zeros((2, count)), (states.moving + states.strained).T
    own = {inside[0]: v[[0, -1]] for inside, v in zip(states.bodies, states.velocity, strict=True)}
    for g, group in enumerate(groups(system)):
        inside = next((x for x in states.bodies if x[0] in group), [])
        mean = own[inside[0]] if inside else np.zeros(2)
        if run.groups:
            mean = np.array([run.groups.before[g], run.groups.after[g]])
        for place in (0, -1):
            velocity[place, group] = velocities_in_group(system, group, inside, mean[place])
    if run.groups:
        vibration[-1] = run.groups.vibration
    impulse = sum(
        sign * float(side.push.integral(0, ticks[-1])) * clock.tick
        for side, sign in zip(signals.outside, INWARD, strict=True) if side is not None
    )
    total = float(states.mass.sum())
    gained = float(states.momentum[-1] - states.momentum[0])
    missing = gained - impulse - total * clock.gravity * float(ticks[-1]) * clock.tick
    pushed = sum(abs(tally.impulse) for tally in run.contacts if tally.impulse == tally.impulse)
    absolute = total * clock.scale + pushed
    energy = book.total
    turnover = float(energy[0]) + abs(float(book.gravity_work[-1])) + sum(
        abs(float(x[-1])) for x in (book.wall_work, book.drive_work, book.radiated)
    ) + total * clock.scale**2 / 2
    works = ("wall_work", "drive_work", "gravity_work", "radiated", "dissipated", "damped",
             "numerical")
    return Totals(
        masses=masses, velocities=(velocity[0].tolist(), velocity[-1].tolist()),
        kinetic=(float(book.kinetic[0]), float(book.kinetic[-1])),
        vibration=(vibration[0].tolist(), vibration[-1].tolist()),
        momentum=(missing, absolute), energy=(float(book.residual[-1]), turnover),
        works={"contact_energy": float(book.contact[-1]),
               "contact_energy_before": float(book.contact[0]),
               **{name: float(getattr(book, name)[-1]) for name in works}},
    )
