"""The members of a family, one after the other: initialised, run, and measured.

A run ends at a given time, or some ticks after the proof that the collision is final.
After a proof that failed, the next one waits until one event a node and an eighth of
the events so far have been added, so that proofs cost no more than the run itself.
"""

from collections.abc import Sequence

from ..states import Stop
from . import energy, events, finality, initial_state
from .records import CHANGE, IDLE, NEVER, NONE, NodeResult, Run, State


def run_members(state: State) -> bool:
    """Run every member to its end, and set its results; return whether all have ended.

    False is returned if the log is full: call this again with a longer log, and the
    present member goes on. A member without a clock is not run: its result
    `stop_reason` says why, and its other results are meaningless.
    """
    run = state.runs[0]
    segments = state.segments
    all_values = state.values
    all_results = state.results
    # Whether the present member has already begun, in a call that ended with a full log
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
        is_resumed = False  # for the next members
        if run.stop_reason < Stop.DONE:  # NONE or FULL: it has a clock
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
    """Run to `end_tick`; if that is NONE, to `ticks_after_proof` after the proof.

    Returns
    -------
    int
        `states.Stop`: DONE (`end_tick` is reached), FINAL (proved, and run on), FULL
        (grow the log and call again), CAP (the cap on events) or CLOCK (the last tick
        of the clock came before a proof). `Run.now` is the tick reached.

    Notes
    -----
    CHECK is never returned: `events.advance` stops with it when a proof is due; the
    proof is tried here, and the run goes on. A proof is due after `next_proof_tick`,
    the earliest tick at which it can succeed, and only once the number of events is
    `next_proof_event`.
    """
    run = state.runs[0]
    runs_to_proof = run.end_tick == NONE
    if not runs_to_proof:
        run.next_proof_event = IDLE  # no proof is due before the end
    stop = Stop.NONE.value
    is_running = True
    while is_running:
        # An end is given, or was set by a proof; otherwise the horizon is the end of
        # the clock.
        horizon_is_end = run.end_tick != NONE or run.proved_tick != NONE
        horizon = find_horizon(run)
        stop = events.advance(state, horizon)
        if stop == Stop.DONE and horizon_is_end:
            run.now = horizon  # all events up to the horizon have happened
        if stop != Stop.FULL and run.proved_tick == NONE:
            try_proof(state, stop)
        # Go on after a CHECK, or to the end that a proof has just set.
        proof_sets_end = not horizon_is_end and run.proved_tick != NONE
        is_running = stop == Stop.CHECK or (stop == Stop.DONE and proof_sets_end)
    if stop == Stop.DONE and runs_to_proof:
        stop = Stop.FINAL.value
        if run.proved_tick == NONE:  # no proof came before the clock ended
            stop = Stop.CLOCK.value
    return stop


def find_horizon(run: Run) -> int:
    """Tick at which a run ends, as far as is known.

    It is `end_tick` if an end is given. Otherwise it is `ticks_after_proof` after the
    proof, but not after the last tick of the clock; without a proof so far, it is the
    last tick of the clock.
    """
    if run.end_tick != NONE:
        return run.end_tick
    if run.proved_tick == NONE:
        return NEVER - 1  # the last tick of the clock
    return min(run.proved_tick + run.ticks_after_proof, NEVER - 1)


def try_proof(state: State, stop: int) -> None:
    """Try to prove the collision final; set `proved_tick`, or when to try again.

    `stop` is the reason why the run stopped, as `states.Stop`. If the proof fails, the
    next attempt is set only for CHECK: with any other reason the run has ended.
    """
    run = state.runs[0]
    node_count = len(state.nodes)
    if stop == Stop.CHECK:
        # The next event is after this tick, so that the state at the tick is known.
        now = max(run.now, run.next_proof_tick)
    else:
        now = run.now
    # `now` if the collision is final, else a later tick at which it may be final
    tick = finality.finality_tick(state, now)
    if tick == now:
        run.proved_tick = now
        run.next_proof_event = IDLE  # no further proof
    elif stop == Stop.CHECK:
        run.next_proof_tick = tick
        # The longer the run, the rarer the proofs: they take only a part of its time.
        run.next_proof_event = run.events + node_count + run.events // 8


# Results ------------------------------------------------------------------------------


def find_max_wave(state: State) -> None:
    """Set `max_wave` of the run, the largest absolute wave of all fronts, m/s.

    Divided by the least wave speed, it bounds the strains.
    """
    run = state.runs[0]
    log = state.log
    run.max_wave = 0 * run.tick_duration  # 0 of the same kind of number
    for r in range(run.log_rows):
        if log[r].line != CHANGE:  # other rows are changes of status
            run.max_wave = max(run.max_wave, abs(log[r].value))


def store_member_result(state: State, results: Sequence[NodeResult]) -> None:
    """Set the results, [node], of the member that has run, in SI units.

    The results of segment k are stored at node k, on its right, and the results of the
    run at node 0, where those of a segment have no meaning. The vibration energy of the
    run is the sum over the segments.
    """
    run = state.runs[0]
    tick_duration = run.tick_duration
    time = run.now * tick_duration
    vibration_energy = 0.0
    for k in range(len(state.nodes)):
        segment = state.segments[k]  # on the left of the node; 0 lies outside
        node = state.nodes[k]
        result = results[k]
        # integral(F t dt), N s^2: both F t and dt are in ticks
        moment = node.impulse_moment * tick_duration * tick_duration
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
