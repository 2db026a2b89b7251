"""A single collision in plain Python, on numbers of any kind: floats or fractions."""

from collections.abc import Sequence
from typing import Any

from ..record_lists import blank
from ..states import Stop
from . import energy, events, initial_state
from .batch import INITIAL_LOG_ROWS
from .family_layout import FamilyLayout, make_state
from .members import run_to_end
from .records import CHANGE, FRONT, NONE, Amplitude, Front, Run, State


class Simulation(State):
    """A `State` with a single collision, whose records are objects.

    Times and amplitudes are numbers of any kind.
    """

    __slots__ = ()

    @property
    def run(self) -> Run:
        """The record of the run."""
        return self.runs[0]

    @property
    def changes(self) -> list[Front]:
        """Rows of the log in which contacts changed their status."""
        return [row for row in self.log[: self.run.log_rows] if row.line == CHANGE]

    def run_to_proof(self, max_events: int, tolerance: Amplitude = 0.0) -> Stop:
        """Run to one tick after the proof of finality; return why it stopped.

        `max_events` is the cap on events. A change of a wave by at most `tolerance`,
        m/s, is no front. The totals of the nodes are brought up to the end. The reason
        is FINAL, CAP, or CLOCK if the clock ends before a proof.
        """
        self.run.end_tick = NONE
        self.run.ticks_after_proof = 1
        return self._run(max_events, tolerance)

    def run_to(
        self, end_tick: Any, max_events: int, tolerance: Amplitude = 0.0
    ) -> Stop:
        """Run to tick `end_tick`, past any proof; return why it stopped: DONE or CAP.

        `max_events` is the cap on events. A change of a wave by at most `tolerance`,
        m/s, is no front. The totals of the nodes are brought up to the end.
        """
        self.run.end_tick = end_tick  # with an end tick `_run` does not stop at a proof
        return self._run(max_events, tolerance)

    def advance(self, horizon: int) -> None:
        """Solve all events up to tick `horizon`.

        The totals of each node stay those of its own last event. The run also stops at
        the cap on events, or where a proof is due.
        """
        while events.advance(self, horizon) == Stop.FULL:
            self._grow_log()

    def _run(self, max_events: int, tolerance: Amplitude) -> Stop:
        """Run to the end that is set in `run`, and return why it stopped.

        This is `end_tick`, past any proof; or a proof, if `end_tick` is NONE. The log
        grows whenever it is full; the state is changed. The totals of the nodes are
        brought up to the end. Cap and tolerance are stored in `run`.
        """
        run = self.run
        run.max_events = max_events
        run.velocity_tolerance = tolerance
        # Exact numbers have no round-off: no closing is moved to an arrival.
        run.round_off_window = 0
        stop = run_to_end(self)
        while stop == Stop.FULL:
            self._grow_log()
            stop = run_to_end(self)
        events.advance_totals_to(self, run.now)
        return Stop(stop)

    def _grow_log(self) -> None:
        """Make the log twice as long."""
        log: Any = self.log
        log.extend(blank(len(log), FRONT))


def start_simulation(
    layout: FamilyLayout,
    values: Sequence[Any],
    ticks: Sequence[Any],
    tick_duration: Any,
    frame_velocity: Any = 0.0,
) -> Simulation:
    """Build the state of a collision at t = 0, ready to run.

    Times and amplitudes may be floats or fractions, including fractions that record how
    they were computed. The clock is given by `ticks` and `tick_duration`, in place of
    the tick rule.

    Parameters
    ----------
    layout : FamilyLayout
        Layout of a collision in which velocities and strains do not jump.
    values : sequence
        Values of the member, in place of those of the layout and in the same order:
        wave speeds, impedances, and so on, see `initial_state`.
    ticks : [segment]
        Transit times, ticks.
    tick_duration : number
        Duration of a tick, s.
    frame_velocity : number
        Velocity of the frame, m/s.
    """
    # The state has no list of members: `values` are passed on here.
    state = Simulation(*make_state(layout, INITIAL_LOG_ROWS, values=[]))
    # In other runs `initial_state.choose_clock` sets these two, pieces and transits.
    state.run.tick_duration = tick_duration
    state.run.frame_velocity = frame_velocity
    segments = state.segments
    # Without jumps, each segment becomes one piece.
    initial_state.split_at_jumps(state, values)
    n = len(ticks)
    for s in range(1, n + 1):
        segments[s].transit = ticks[s - 1]
        impedance_index = n + s - 1  # the impedances follow n wave speeds
        segments[s].mobility = 1 / values[impedance_index]
    initial_state.initialise_member(state, values)
    events.start(state)  # sets t = 0; no event is solved yet
    energy.update_motion(state)
    energy.store_initial_motion(segments)
    return state
