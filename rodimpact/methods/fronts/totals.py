"""What a run of the method "fronts" adds up to, from its kernel's tallies and the waves left.

The signals are not needed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...model import Absorbing, Bonded, Fixed, Free
from ..groups import body_velocities, groups
from ..run import ContactTally, Totals
from .assembly import Assembly
from .layout_kernel import TOLERANCE
from .tracking import FrontRun


def totals_of(run: FrontRun, tallies: Sequence[ContactTally]) -> Totals:
    """Read the totals off a finished run."""
    a = run.assembly
    system, count, first = a.system, len(a.spans), [span[0] for span in a.spans]
    masses = [a.mass(i) for i in range(count)]
    stocks = (run.opening, run.closing)
    before, after = (
        [float(v) for v in velocities] for velocities in
        body_velocities(system, first, a.frame, *(stock.velocity for stock in stocks))
    )
    vibration_before, vibration_after = (
        [math.fsum(stock.vibration[s : e + 1]) * a.tick for s, e in a.spans] for stock in stocks
    )
    kinetic_before, kinetic_after = (
        sum(m * (stock.velocity[s] + a.frame) ** 2 / 2
            for m, (s, e) in zip(masses, a.spans, strict=True) if e) for stock in stocks
    )
    absolute = _absolute_momentum(a)
    outside_impulse = wall_work = lent = 0.0
    for i, k, sign in ((0, 0, 1), (count - 1, count - 2, -1)):
        if masses[i] == math.inf:
            impulse = sign * tallies[k].impulse
            outside_impulse += impulse
            wall_work += impulse * after[i]
            absolute += abs(impulse)
            if isinstance(system.contacts[k], Bonded):  # the wall lends energy and takes it back
                group = next(g for g in groups(system) if i in g)
                swinging = sum(masses[j] for j in group if masses[j] < math.inf)
                lent += swinging * abs(after[i]) * a.tolerance / TOLERANCE
    drive_work = radiated = 0.0
    for end, node, sign in zip(system.ends, (0, -1), (1, -1), strict=True):
        if isinstance(end, Free):
            continue
        impulse = run.tally.impulse[node] * a.tick
        work = sign * (run.tally.work[node] * a.tick + a.frame * impulse)
        outside_impulse += sign * impulse
        absolute += abs(impulse)
        if isinstance(end, Absorbing):
            radiated -= work
        elif not isinstance(end, Fixed):
            drive_work += work
        if not isinstance(end, Fixed):  # what goes in and out again is no more exact than this
            scale = a.tolerance / TOLERANCE
            mass = sum(m for m in masses if m < math.inf)
            absolute += mass * scale
            lent += mass * scale**2 / 2
    gained = math.fsum(run.closing.momentum) - math.fsum(run.opening.momentum)
    missing = gained * a.tick - outside_impulse
    energy_before = kinetic_before + sum(vibration_before)
    energy_gained = kinetic_after + sum(vibration_after) - energy_before
    turnover = energy_before + abs(wall_work) + lent + abs(drive_work) + abs(radiated)
    return Totals(
        masses=masses, velocities=(before, after), kinetic=(kinetic_before, kinetic_after),
        vibration=(vibration_before, vibration_after),
        momentum=(missing, absolute),
        energy=(energy_gained - wall_work - drive_work + radiated, turnover),
        works={"wall_work": wall_work, "drive_work": drive_work, "radiated": radiated},
    )


def tallies_of(run: FrontRun) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    t, tick = run.tally, run.assembly.tick
    return tuple(
        ContactTally(
            impulse=t.impulse[k] * tick, peak_force=t.peak[k], duration=t.pressed[k] * tick,
            first=t.first[k] * tick if t.first[k] >= 0 else math.nan,
            last=t.last[k] * tick if t.last[k] >= 0 else math.nan, episodes=t.episodes[k],
        )
        for k in run.assembly.nodes
    )


def _absolute_momentum(a: Assembly) -> float:
    """Total of the absolute momenta of all waves at t = 0, kg m/s."""
    total = 0.0
    for line, fronts in enumerate(a.waves[2:-2], 2):
        ends = [tick for tick, _ in fronts[1:]] + [0]
        half = a.impedance[line // 2] / 2
        for (tick, wave), end in zip(fronts, ends, strict=True):
            total += half * (end - tick) * a.tick * abs(wave + a.frame)
    return total
