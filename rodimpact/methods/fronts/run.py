"""A finished run of a single collision by fronts: its clock, and why it stopped."""

from functools import cached_property
from typing import Any

from ...model.frozen import InvalidModel
from ..abilities import has_external_drive
from ..clock import Clock, clock_of, too_long, too_short
from ..states import Stop
from .batch import FrontBatch
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
    batch : FrontBatch
        The batch whose only member is this run.
    layout : FamilyLayout
    clock : Clock
    run : records.Run
    segments : list of records.Segment
        The first and the last one lie outside the row.
    nodes : list of records.Node
    contacts : list of records.Node
        The nodes of the contacts.
    lines : list of records.Line
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``.
    proved_tick : int
        Tick at which the collision was proved final; NONE without a proof. A row with
        driven ends has none.

    Raises
    ------
    InvalidModel
        If energies overflow, if the run is too long for a clock, or if transit times
        are too far apart for one clock.
    """

    def __init__(self, batch: FrontBatch) -> None:
        """Take the records of a batch whose only member has run, and make its clock.

        A proof is discarded if an end is driven. InvalidModel is raised if the run has
        no clock, see `_why_no_clock`.
        """
        self.batch = batch
        self.layout = batch.layout
        self.run = batch.progress
        self.segments: list[Segment] = batch.objects("segments")
        self.nodes: list[Node] = batch.objects("nodes")
        self.contacts = [self.nodes[k] for k in self.layout.contacts]
        self.lines: list[Line] = batch.objects("lines")
        if self.run.stop_reason >= Stop.OVERFLOW:  # there is no clock
            raise InvalidModel([self._why_no_clock()])
        self.clock = self._clock()
        self.stopped_by = REASONS[Stop(self.run.stop_reason)]
        self.proved_tick = self.run.proved_tick
        # With a driven end a proof is meaningless, as its bounds do not hold. Such a
        # run always has a given end, and this is checked first as it is quicker.
        if self.run.until >= 0 and has_external_drive(self.layout.row.system):
            self.proved_tick = NONE

    @cached_property
    def log(self) -> Any:
        """Rows of the kernel's log that are in use, an array of `records.FRONT`."""
        return self.batch.array("log")[: self.run.log_rows]

    @property
    def is_proved(self) -> bool:
        """Whether the collision is proved final, see `finality`."""
        return self.proved_tick != NONE

    @property
    def until(self) -> float | None:
        """Given end of the run, s; None if it ran to its proof."""
        if self.run.until < 0:
            return None
        return self.run.until

    def _clock(self) -> Clock:
        """Make the clock of the run, with its rounded transit times.

        Its impedances are those of the segments, with an entry before and after them
        for the outside: the impedance of the outermost segment for a semi-infinite bar,
        else 0.
        """
        row = self.layout.row
        impedance = [0.0]  # outside on the left
        for segment in row.segments:
            impedance.append(float(segment.impedance))
        impedance.append(0.0)  # outside on the right
        if self.segments[0].mobility > 0:  # a semi-infinite bar on the left
            impedance[0] = impedance[1]
        if self.segments[-1].mobility > 0:  # one on the right
            impedance[-1] = impedance[-2]
        ticks = [segment.transit for segment in self.segments[1:-1]]  # without outside
        return clock_of(
            row,
            ticks,
            self.run.tick_duration,
            frame=self.run.frame_velocity,
            impedance=impedance,
        )

    def _why_no_clock(self) -> tuple[str, str]:
        """Path in the model and sentence that say why a collision cannot be run.

        They depend on the stop reason. OVERFLOW: velocities are too large, path
        "bodies". LONG: the run is too long, path "until". SHORT: the shortest segment
        is too short beside the longest; the path is that of the segment.
        """
        run = self.run
        row = self.layout.row
        if run.stop_reason == Stop.OVERFLOW:
            return "bodies", (
                f"have velocities, and strains times wave speed, up to "
                f"{run.velocity_scale!r} m/s, whose energy exceeds the largest float; "
                "use smaller ones"
            )
        transit_times = [float(segment.transit_time) for segment in row.segments]
        longest = max(transit_times)
        if run.stop_reason == Stop.LONG:
            return too_long(run.horizon, longest)
        s = run.shortest_segment  # counted from 1, as `paths` are
        return too_short(row.paths[s], transit_times[s - 1], longest)
