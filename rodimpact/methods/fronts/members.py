"""The members of a family, one after the other: laid out, run, and added up.

A run ends at the time asked for, or some ticks after the proof that no contact can
press again. After a proof that failed the next one waits for an eighth more events, so
that proofs cost no more than the run itself.
"""

from typing import Any

from ..laws import Stop
from . import energy, events, finality, initial_state
from .records import CHANGE, IDLE, NEVER, NONE, Run, State


def run_members(state: State) -> bool:
    """Run every member to its end; return whether all are done.

    Where the log is full, call this again with a longer one: the member goes on.
    """
    run = state.runs[0]
    segments = state.segments
    all_numbers = state.numbers
    all_totals = state.totals
    if run.stop != Stop.FULL:
        run.member = 0
    while run.member < len(all_totals):
        if run.stop != Stop.FULL:
            numbers = all_numbers[run.member]
            initial_state.choose_clock(state, numbers)
            if run.stop == Stop.NONE:
                initial_state.lay_out(state, numbers)
                events.start(state)
                energy.update(state)
                energy.keep_initial(segments)
        if run.stop < Stop.DONE:
            run.stop = run_to_end(state)
            if run.stop == Stop.FULL:
                return False
            events.close_books(state, run.now)
            energy.update(state)
            if run.goes_on:
                find_wave_scales(state)
            if run.reads_waves:
                energy.find_wave_differences(state)
        write_totals(state, all_totals[run.member])
        run.member += 1
    return True


def run_to_end(state: State) -> int:
    """Run to tick `target`, or if that is negative to the proof and -target ticks more.

    Returns
    -------
    int
        `laws.Stop`: DONE (reached `target`), FINAL (proved, and run on), FULL (grow the
        log and call again), CAP (more events than the limit) or CLOCK (its ticks are
        over). At the end `Run.now` is the tick reached.
    """
    run = state.runs[0]
    proves = run.target < 0
    if not proves:
        run.proof_events = IDLE  # nothing is to be proved on the way
    stop = Stop.NONE.value
    going = True
    while going:
        end_is_known = not proves or run.proved != NONE
        horizon = end_of_run(run)
        stop = events.advance(state, horizon)
        if stop == Stop.DONE and end_is_known:
            run.now = horizon
        if stop != Stop.FULL and run.proved == NONE:
            try_proof(state, stop)
        waits = stop == Stop.DONE and not end_is_known and run.proved != NONE
        going = stop == Stop.CHECK or waits
    if stop == Stop.DONE and proves:
        return Stop.CLOCK.value if run.proved == NONE else Stop.FINAL.value
    return stop


def end_of_run(run: Run) -> int:
    """Tick at which a run ends, as far as is known: without a proof, with its clock."""
    if run.target >= 0:
        return run.target
    if run.proved == NONE:
        return NEVER - 1
    return min(run.proved - run.target, NEVER - 1)


def try_proof(state: State, stop: int) -> None:
    """Try to prove the collision final, or find when to try again."""
    run = state.runs[0]
    nodes = len(state.nodes)
    now = run.now
    if stop == Stop.CHECK:
        now = max(run.now, run.proof_tick)
    tick = finality.finality_tick(state, now)
    if tick == now:
        run.proved = now
        run.proof_events = IDLE
    elif stop == Stop.CHECK:
        run.proof_tick = tick
        run.proof_events = run.events + nodes + run.events // 8


# Totals -------------------------------------------------------------------------------


def find_wave_scales(state: State) -> None:
    """Find the fastest wave, and the sum of the absolute momenta of all at t = 0."""
    run = state.runs[0]
    log = state.log
    run.fastest_wave = 0 * run.tick
    for r in range(run.rows):
        if log[r].line != CHANGE:
            run.fastest_wave = max(run.fastest_wave, abs(log[r].value))
    run.absolute_momentum = 0 * run.tick
    for r in range(run.initial_rows):
        front = log[r]
        if 1 < front.line < len(state.lines) - 2:
            end = 0
            if front.next_row != NONE:
                end = min(log[front.next_row].tick, 0)
            mobility = state.segments[front.line // 2].mobility
            weight = (end - front.tick) * run.tick / (2 * mobility)
            run.absolute_momentum += weight * abs(front.value + run.frame)


def write_totals(state: State, totals: Any) -> None:
    """Write the totals of the member that has run, in SI units."""
    run = state.runs[0]
    tick = run.tick
    time = run.now * tick
    energy_left = 0.0
    for k in range(len(state.nodes)):
        segment = state.segments[k]
        node = state.nodes[k]
        own = totals[k]
        own.velocity_before = segment.initial_velocity + run.frame
        own.velocity_after = segment.velocity + run.frame
        own.momentum = segment.initial_momentum * tick
        own.wave_difference = segment.wave_difference
        own.impulse = node.impulse * tick
        own.carried = node.impulse * tick * time - node.moment * tick * tick
        own.peak_force = node.peak_force
        own.duration = node.pressed * tick
        own.episodes = node.episodes
        energy_left += segment.vibration
    whole = totals[0]
    whole.stop = run.stop
    whole.proved = 0 if run.proved == NONE else 1
    whole.vibration = energy_left * tick
    whole.time = time
    whole.frame = run.frame
