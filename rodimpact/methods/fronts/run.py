"""A finished run of a single collision by fronts: its clock, its records, and why it stopped."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from ...model.frozen import InvalidModel
from .. import tick_rule as rule
from ..abilities import driven
from ..clock import Clock
from ..compiling import as_objects, as_records
from .driver import Members
from .records import NONE, ROW, Stop

REASONS = {Stop.FINAL: "final", Stop.CAP: "max_events", Stop.CLOCK: "clock", Stop.DONE: "until"}


class FrontRun:
    """A finished run of a single collision.

    Attributes
    ----------
    members : Members
        As the kernel left them.
    clock : Clock
    plan : Plan
    run, segment, node, line
        The kernel's records as objects, or lists of them.
    gaps : list of float
        Of each contact at t = 0, velocity times ticks.
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    finality_time : int
        Tick at which the collision was proved final, -1 without proof, as where ends are driven.
    """

    def __init__(self, members: Members) -> None:
        self.members, self.plan = members, members.plan
        (self.run,), self.segment, self.node, self.line = (
            as_objects(records) if members.fast else records
            for records in (members.run, members.segment, members.node, members.line))
        if self.run.stop >= Stop.OVERFLOW:
            raise InvalidModel([_refusal(self)])
        self.clock, self.stopped_by = _clock(self), REASONS[Stop(self.run.stop)]
        self.gaps = [it / self.clock.tick for it in map(float, self.plan.row.system.gaps)]
        pushed = self.run.until >= 0 and driven(self.plan.row.system)
        self.finality_time = NONE if pushed else self.run.proved

    @cached_property
    def log(self) -> Any:
        """Rows of the kernel's log."""
        rows = self.members.log[: self.run.rows]
        return rows if self.members.fast else as_records(rows, ROW)


def _clock(run: FrontRun) -> Clock:
    """The clock of a run, and what of its row fields need to know."""
    row, tick, pieces = run.plan.row, run.run.tick, run.plan.row.segments
    ticks = [s.transit for s in run.segment]
    length, speed = ([0.0, *(float(getattr(p, name)) for p in pieces), 0.0]
                     for name in ("length", "wave_speed"))
    impedance = [0.0, *(float(p.impedance) for p in pieces), 0.0]
    for at, beside in ((0, 1), (-1, -2)):
        impedance[at] = impedance[beside] if run.segment[at].mobility else 0.0
    errors = [abs(ticks[s] * tick / (length[s] / speed[s]) - 1) for s in range(1, len(ticks) - 1)]
    worst = max(range(len(errors)), key=errors.__getitem__)
    return Clock(
        system=row.system, spans=row.spans, wave_speed=speed, impedance=impedance, length=length,
        ticks=ticks, tick=tick, frame=run.run.frame, transit_error=errors[worst],
        worst=row.paths[worst + 1],
    )


def _refusal(run: FrontRun) -> tuple[str, str]:
    """Path and sentence for a collision that cannot be laid out."""
    it, pieces = run.run, run.plan.row.segments
    if it.stop == Stop.OVERFLOW:
        return "bodies", (
            f"velocities and strains of {it.scale!r} m/s overflow the energy; use smaller")
    times = [float(p.length) / float(p.wave_speed) for p in pieces]
    longest = max(times)
    if it.stop == Stop.LONG:
        most = longest * 2.0 ** (rule.CLOCK_BITS - 1 - rule.COARSEST)
        return "until", (
            f"a run of {it.horizon:g} s is {it.horizon / longest:.3g} times the longest transit "
            f"time {longest:g} s, more than the clock can count; stop before {most:.3g} s"
        )
    return run.plan.row.paths[it.short], (
        f"its transit time {times[it.short - 1]:.3g} s is too short beside the longest, "
        f"{longest:.3g} s: one exact clock holds ratios up to about 2e11; leave it out"
    )
