"""A finished run of a single collision by fronts: its clock, and why it stopped."""

from functools import cached_property
from typing import Any

from ...model.frozen import InvalidModel
from ..abilities import driven
from ..clock import Clock, clock_of, too_long, too_short
from ..laws import Stop
from .driver import Batch
from .records import NONE, Line, Node, Segment

REASONS: dict[int, str] = {
    Stop.FINAL: "final",
    Stop.CAP: "max_events",
    Stop.CLOCK: "clock",
    Stop.DONE: "until",
}


class FrontRun:
    """A finished run of a single collision.

    Attributes
    ----------
    batch : Batch
        As the kernel left it.
    plan : Plan
    clock : Clock
    run : records.Run
    segments : list of records.Segment
    nodes : list of records.Node
    lines : list of records.Line
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    finality_time : int
        Tick at which the collision was proved final, -1 without proof, as where ends
        are driven.

    Raises
    ------
    InvalidModel
        When velocities overflow, or transit times are too far apart for one clock.
    """

    def __init__(self, batch: Batch) -> None:
        self.batch = batch
        self.plan = batch.plan
        self.run = batch.progress
        self.segments: list[Segment] = batch.objects("segments")
        self.nodes: list[Node] = batch.objects("nodes")
        self.lines: list[Line] = batch.objects("lines")
        if self.run.stop >= Stop.OVERFLOW:
            raise InvalidModel([self._why_no_clock()])
        self.clock = self._clock()
        self.stopped_by = REASONS[Stop(self.run.stop)]
        self.finality_time = self.run.proved
        if self.run.until >= 0 and driven(self.plan.row.system):
            self.finality_time = NONE

    @cached_property
    def log(self) -> Any:
        """Rows of the kernel's log, an array of records."""
        return self.batch.array("log")[: self.run.rows]

    @property
    def proved(self) -> bool:
        """Whether it is proved that nothing meets again."""
        return self.finality_time != NONE

    @property
    def contacts(self) -> list[Node]:
        """The nodes of the contacts."""
        return [self.nodes[k] for k in self.plan.contacts]

    def _clock(self) -> Clock:
        """The clock; an endless bar outside has the impedance of what it goes on."""
        row = self.plan.row
        impedance = [0.0, *(float(s.impedance) for s in row.segments), 0.0]
        if self.segments[0].mobility:
            impedance[0] = impedance[1]
        if self.segments[-1].mobility:
            impedance[-1] = impedance[-2]
        ticks = [segment.transit for segment in self.segments[1:-1]]
        return clock_of(
            row, ticks, self.run.tick, frame=self.run.frame, impedance=impedance
        )

    def _why_no_clock(self) -> tuple[str, str]:
        """Path and sentence for a collision that has no clock."""
        run = self.run
        row = self.plan.row
        if run.stop == Stop.OVERFLOW:
            scale = f"velocities and strains of {run.scale!r} m/s"
            return "bodies", f"{scale} overflow the energy; use smaller"
        times = [float(segment.transit_time) for segment in row.segments]
        longest = max(times)
        if run.stop == Stop.LONG:
            return too_long(run.horizon, longest)
        return too_short(row.paths[run.shortest], times[run.shortest - 1], longest)
