"""A finished run of a single collision by fronts: its clock, its records, and why it stopped."""

from functools import cached_property
from typing import Any

from ...model.frozen import InvalidModel
from ..abilities import driven
from ..clock import Clock, clock_of, too_long, too_short
from ..laws import Stop
from .driver import Members
from .records import NONE

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
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    finality_time : int
        Tick at which the collision was proved final, -1 without proof, as where ends are driven.
    """

    def __init__(self, members: Members) -> None:
        self.members, self.plan = members, members.plan
        (self.run,), self.segment, self.node, self.line = map(
            members.objects, ("run", "segment", "node", "line"))
        if self.run.stop >= Stop.OVERFLOW:
            raise InvalidModel([_refusal(self)])
        self.clock, self.stopped_by = _clock(self), REASONS[Stop(self.run.stop)]
        pushed = self.run.until >= 0 and driven(self.plan.row.system)
        self.finality_time = NONE if pushed else self.run.proved

    @cached_property
    def log(self) -> Any:
        """Rows of the kernel's log."""
        return self.members.arrays("log")[: self.run.rows]


def _clock(run: FrontRun) -> Clock:
    """The clock of a run; an endless bar outside has the impedance of what it goes on."""
    pieces = run.plan.row.segments
    impedance = [0.0, *(float(piece.impedance) for piece in pieces), 0.0]
    for at, beside in ((0, 1), (-1, -2)):
        impedance[at] = impedance[beside] if run.segment[at].mobility else 0.0
    return clock_of(run.plan.row, [s.transit for s in run.segment[1:-1]], run.run.tick,
                    frame=run.run.frame, impedance=impedance)


def _refusal(run: FrontRun) -> tuple[str, str]:
    """Path and sentence for a collision that cannot be laid out."""
    it, row = run.run, run.plan.row
    if it.stop == Stop.OVERFLOW:
        return "bodies", (
            f"velocities and strains of {it.scale!r} m/s overflow the energy; use smaller")
    times = [float(piece.transit_time) for piece in row.segments]
    if it.stop == Stop.LONG:
        return too_long(it.horizon, max(times))
    return too_short(row.paths[it.short], times[it.short - 1], max(times))
