"""The members of a family, one after the other: initialised, run, and measured.

A run ends at the time asked for, or some ticks after the proof that the collision is
final. After a proof that failed the next one waits for an event a node and an eighth
more events, so that proofs cost no more than the run itself.
"""

from collections.abc import Sequence

from ..states import Stop
from . import energy, events, finality, initial_state
from .records import CHANGE, IDLE, NEVER, NONE, NodeResult, Run, State


def run_members(state: State) -> bool:
    """Run every member to its end, and set its results; return whether all have ended.

    If the log is full it returns False: call this again with a longer one, and the
    member goes on. A member without a clock is not run; of its results `stop_reason`
    says so, and the others mean nothing.
    """
    run = state.runs[0]
    segments = state.segments
    all_values = state.values
    all_results = state.results
    # Whether the present member has begun already: the log was full in its run.
    is_resumed = run.stop_reason == Stop.FULL
    if not is_resumed:
        run.member = 0
    while run.member < len(all_results):
        if not is_resumed:  # begin the member
            values = all_values[run.member]
            initial_state.choose_clock(state, values)
            if run.stop_reason == Stop.NONE:  # there is a clock
                initial_state.initialise_member(state, values)
                events.start(state)
                energy.update_motion(state)
                energy.store_initial_motion(segments)
        is_resumed = False  # the members after it have not begun
        if run.stop_reason < Stop.DONE:  # the member has a clock, and has not ended
            run.stop_reason = run_to_end(state)
            if run.stop_reason == Stop.FULL:
                return False
            events.advance_totals_to(state, run.now)
            energy.update_motion(state)
            if run.run_past_proof:
                find_max_wave(state)
            if run.record_max_stress:
                energy.find_wave_differences(state)
        store_member_result(state, all_results[run.member])
        run.member += 1
    return True


def run_to_end(state: State) -> int:
    """Run to tick `end_tick`; without one to the proof and `ticks_after_proof` more.

    Returns
    -------
    int
        `states.Stop`: DONE (reached `end_tick`), FINAL (proved, and run on), FULL (grow
        the log and call again), CAP (more events than the limit) or CLOCK (its ticks
        are over). At the end `Run.now` is the tick reached.

    Notes
    -----
    CHECK never comes back: `events.advance` stops with it where a proof is due, which
    is tried here, and the run goes on. A proof is due after the tick `next_proof_tick`,
    the earliest that the last attempt left possible, and not before the number of
    events is `next_proof_event`, so that proofs cost no more than the run.
    """
    run = state.runs[0]
    runs_to_proof = run.end_tick == NONE
    if not runs_to_proof:
        run.next_proof_event = IDLE  # no proof stops the run on its way
    stop = Stop.NONE.value
    is_running = True
    while is_running:
        # Whether the horizon is the end of the run, and not that of the clock
        had_end = run.end_tick != NONE or run.proved_tick != NONE
        horizon = find_horizon(run)
        stop = events.advance(state, horizon)
        if stop == Stop.DONE and had_end:
            run.now = horizon  # no event is left up to there
        if stop != Stop.FULL and run.proved_tick == NONE:
            try_proof(state, stop)
        # A proof sets the end: the run goes on to it.
        proof_sets_end = not had_end and run.proved_tick != NONE
        is_running = stop == Stop.CHECK or (stop == Stop.DONE and proof_sets_end)
    if stop == Stop.DONE and runs_to_proof:
        stop = Stop.FINAL.value
        if run.proved_tick == NONE:  # no proof came before the clock ended
            stop = Stop.CLOCK.value
    return stop


def find_horizon(run: Run) -> int:
    """Tick at which a run ends, as far as is known.

    It is `end_tick` where an end was asked for; else `ticks_after_proof` after the
    proof; the last tick of the clock as long as there is no proof.
    """
    if run.end_tick != NONE:
        return run.end_tick
    if run.proved_tick == NONE:
        return NEVER - 1  # the last tick of the clock
    return min(run.proved_tick + run.ticks_after_proof, NEVER - 1)


def try_proof(state: State, stop: int) -> None:
    """Try to prove the collision final; set `proved_tick`, or when to try again.

    `stop` is why the run stopped, as `states.Stop`. A proof that fails is tried again
    only if this is CHECK; else the run does not go on.
    """
    run = state.runs[0]
    node_count = len(state.nodes)
    if stop == Stop.CHECK:
        # No event comes before, so that the state at that tick is known.
        now = max(run.now, run.next_proof_tick)
    else:
        now = run.now
    # `now` if the collision is final, else a later tick at which it may be
    tick = finality.finality_tick(state, now)
    if tick == now:
        run.proved_tick = now
        run.next_proof_event = IDLE  # no further proof
    elif stop == Stop.CHECK:
        run.next_proof_tick = tick
        # Proofs are rarer in a longer run, so that they take a part of its time only.
        run.next_proof_event = run.events + node_count + run.events // 8


# Results ------------------------------------------------------------------------------


def find_max_wave(state: State) -> None:
    """Set `max_wave` of the run, the largest absolute wave of all fronts, m/s.

    The largest strain follows from it.
    """
    run = state.runs[0]
    log = state.log
    run.max_wave = 0 * run.tick_duration  # 0 of the type of number of this run
    for r in range(run.log_rows):
        if log[r].line != CHANGE:  # changes of status are in the log, too
            run.max_wave = max(run.max_wave, abs(log[r].value))


def store_member_result(state: State, results: Sequence[NodeResult]) -> None:
    """Set the results, [node], of the member that has run, in SI units.

    Those of segment k are at node k, those of the run at node 0.
    """
    run = state.runs[0]
    tick_duration = run.tick_duration
    time = run.now * tick_duration
    vibration_energy = 0.0
    for k in range(len(state.nodes)):
        segment = state.segments[k]  # the segment on the left of the node
        node = state.nodes[k]
        result = results[k]
        moment = node.impulse_moment * tick_duration * tick_duration  # N s^2
        result.velocity_before = segment.initial_group_velocity + run.frame_velocity
        result.velocity_after = segment.group_velocity + run.frame_velocity
        result.initial_momentum = segment.initial_momentum * tick_duration
        result.max_wave_difference = segment.max_wave_difference
        result.impulse = node.impulse * tick_duration
        # integral(J dt) up to t is J t - integral(F t dt), by parts.
        result.impulse_time_integral = node.impulse * tick_duration * time - moment
        result.peak_force = node.peak_force
        result.duration = node.force_ticks * tick_duration
        result.episodes = node.episodes
        vibration_energy += segment.vibration_energy
    member = results[0]
    member.stop_reason = run.stop_reason
    member.is_proved = 0
    if run.proved_tick != NONE:
        member.is_proved = 1
    member.vibration_energy = vibration_energy * tick_duration
    member.end_time = time
    member.frame_velocity = run.frame_velocity
