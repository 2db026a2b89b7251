"""The search for an accurate step: level after level, until what is watched stands still.

A step that is divided by 1, 2, 3, 4, 6, 8, 12, ... gives a level each. Watched are the velocities
of free bodies, and what the contacts did. `go_on` comes back when a level is laid out, so that
waves can be filled in, and when it needs room; called again it goes on where it was.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..clock import STEP_TICKS
from ..contact_law_kernel import IMPACT, JOINT, YIELD, Chain, Tally, stored
from ..measure_kernel import deepest, largest_force, pressed_time, time_of_most
from ..refinement_kernel import SURE, carried_error, carried_on, error_of, factor_of
from .level_kernel import (
    ABRUPT,
    ASKED,
    CAPPED,
    CLOSINGS,
    CUT,
    FACTOR,
    FINEST,
    FIRST_ROOM,
    FRAME,
    FULL,
    GRAVITY,
    HAD,
    KEPT,
    LAID,
    LAYER,
    LOSES,
    PROOF,
    REASON,
    SCALE,
    TAKEN,
    TOO_LONG,
    TRIES,
    UNTIL,
    WHOLE,
    Level,
    Limit,
    Make,
    Numbers,
    begin_of,
    cut_steps,
    extend,
    fill_evenly,
    lay_out,
    near_tick,
    note_closing,
    run_level,
)
from .step_kernel import CLOSED, DONE, Points, Signals, State, choose_step, inside

FIRST = 56  # fewest steps of the longest transit
SHORTEST = 4  # fewest steps of the shortest transit
MOST_STEPS = 1 << 16  # of the longest transit, that the shortest may ask for
MOST_SEARCHED = 10_000  # steps of the longest transit, among which all transits may be whole
MOST_DIVIDED = 1 << 14  # steps of the longest transit in the search for an accurate step
ROUGHEST = 1 << 12  # the same where contacts close and open between steps, of which order 1 is left
BRIEF = 10.0  # steps: parts are graded where a contact loads a rod in less
MOST_LEVELS = 40
FARTHEST = 2.0  # by how much a step is divided at most from one level to the next
VELOCITY, IMPULSE, PEAK, TIME, DURATION = range(5)  # measures, the last of which may stay rough
MEASURES = 5
FILL, TOO_SHORT, BEYOND = 20, 21, 22  # what `go_on` asks for, beside the flags of a level
PREPARE, CHOOSE, LAY, RUN = range(4)  # what comes next
MEMBERS, SEARCH, EVENLY, EXTEND = range(4)  # jobs
# places in Search.at
NEXT, LEVELS, RUNG, NUMBER, FEWEST_STEPS, FITS, MOST_FACTOR, FIXED = range(8)
PEAKS_CARRIED, TIMES_CARRIED = 8, 9


class Search(NamedTuple):
    """How far the search has come, and what it has found."""

    at: Any  # whole numbers, see their places
    goal: Any  # [1]
    sizes: Any  # [level] s
    values: Any  # [level * width] what was measured
    estimates: Any  # [6] errors: of the measures, and of the energy
    mass: Any  # [group] kg
    before: Any  # [group] velocities of the centres of mass, m/s
    after: Any  # [group]
    vibration: Any  # [body] J
    impulse: Any  # [contact that can open] N s
    peak: Any  # [contact that can open] N
    pressed: Any  # [contact that can open] s


def prepare(make: Make, numbers: Numbers, search: Search, level: Level) -> int:
    """Choose the first level; TOO_SHORT where a transit is too short beside the longest."""
    at, longest, shortest = search.at, 0.0, math.inf
    for s in range(len(numbers.transit)):
        longest = max(longest, numbers.transit[s])
        shortest = min(shortest, numbers.transit[s])
    level.at[CLOSINGS] = level.at[KEPT] = level.at[TRIES] = 0
    level.at[CUT], level.at[FACTOR] = make.kind[ABRUPT], 0
    level.at[ASKED], level.at[HAD] = FIRST_ROOM, 0
    at[NEXT], at[LEVELS], at[RUNG] = CHOOSE, 0, 0
    at[PEAKS_CARRIED] = at[TIMES_CARRIED] = 0
    if at[FIXED] > 0:
        at[NEXT] = LAY
        return DONE
    ratio = max(SHORTEST * longest / shortest, longest / numbers.setting[FINEST], FIRST)
    if not ratio <= MOST_STEPS:
        return TOO_SHORT
    least = math.ceil(ratio)
    number, smear = choose_step(
        numbers.transit, least, max(MOST_SEARCHED, 2 * least), WHOLE / STEP_TICKS, 0.0
    )
    fits = smear <= WHOLE / STEP_TICKS
    finest = MOST_DIVIDED if fits or make.kind[ABRUPT] == 0 else ROUGHEST
    at[FITS], at[NUMBER], at[FEWEST_STEPS] = 1 if fits else 0, number, least
    at[MOST_FACTOR] = max(4, 2 * finest // (number if fits else least))
    if not fits:
        level.at[CUT] = 0
    elif numbers.setting[LAYER] * number < BRIEF * longest:
        level.at[CUT] = level.at[FACTOR] = 1
    return DONE


def choose_level(make: Make, numbers: Numbers, search: Search, level: Level) -> bool:
    """Take the next step; False where there is none."""
    at, longest = search.at, 0.0
    factor = factor_of(at[RUNG])
    if factor > at[MOST_FACTOR] or at[LEVELS] == MOST_LEVELS:
        return False
    at[RUNG] += 1
    for s in range(len(numbers.transit)):
        longest = max(longest, numbers.transit[s])
    steps = factor * at[NUMBER]
    if at[FITS] == 0:  # another share of a step on every level
        low = factor * at[FEWEST_STEPS]
        steps, _ = choose_step(
            numbers.transit, low, 4 * low // 3 - 1, WHOLE / STEP_TICKS, float(make.kind[ABRUPT])
        )
    level.step[0] = longest / steps
    level.at[TRIES] = 0
    if level.at[FACTOR] > 0:
        level.at[FACTOR] = factor
    return True


def go_on(
    make: Make, numbers: Numbers, limit: Limit, search: Search, level: Level, state: State,
    tally: Tally, signals: Signals, points: Points, links: Chain, clock: Any,
) -> int:
    """Go on with the search until it is over, or something is asked for.

    Returns
    -------
    DONE: the last level, whose totals are added up, is accurate or as good as it gets; FILL: waves
    at t = 0 and from outside are to be filled in; or a flag of `lay_out` or `run_level`
    """
    at, over = search.at, False
    while not over:
        if at[NEXT] == PREPARE:
            flag = prepare(make, numbers, search, level)
            if flag != DONE:
                return flag
        if at[NEXT] == CHOOSE:
            over = not choose_level(make, numbers, search, level)
            at[NEXT] = LAY
        elif at[NEXT] == LAY:
            cut_steps(make, numbers, level)
            flag = lay_out(make, numbers, limit, level, state, tally, signals, clock)
            if flag == LAID:
                at[NEXT] = RUN
                return FILL
            if flag != TOO_LONG or at[LEVELS] == 0:
                return flag
            repeat_last(search, level)
        else:
            flag = run_level(
                make, numbers, limit, level, state, tally, signals, points, links, clock
            )
            if flag == CLOSED:
                note_closing(numbers, level, state, clock)
            if flag in (CLOSED, FULL):
                at[NEXT] = LAY
            elif flag != DONE:
                return flag
            elif at[FIXED] > 0:
                over = True
            elif level.at[REASON] == CAPPED and at[LEVELS] > 0:
                repeat_last(search, level)
            else:
                measure(make, numbers, search, level, state, tally, signals)
                over = level.at[REASON] == CAPPED or is_met(search)
                at[NEXT] = CHOOSE
                if is_smooth(make, search, level):
                    leave_out(search)
    add_up(make, numbers, search, level, state, tally, signals)
    return DONE


def repeat_last(search: Search, level: Level) -> None:
    """Go back to the level before, which was the finest that can be run."""
    search.at[NEXT], search.at[FIXED], tried = LAY, 1, level.step[0]
    level.step[0] = search.sizes[search.at[LEVELS] - 1]
    level.at[FACTOR] = near_tick(level.at[FACTOR] * tried / level.step[0])
    level.at[CLOSINGS] = max(level.at[KEPT], 0)
    level.at[CUT] = 1 if level.at[KEPT] >= 0 else 0
    for q in range(level.at[CLOSINGS]):
        level.closing_time[q], level.closing_link[q] = level.kept_time[q], level.kept_link[q]


def measure(
    make: Make, numbers: Numbers, search: Search, level: Level, state: State, tally: Tally,
    signals: Signals,
) -> None:
    """Enter what is to stand still of the level that was run, and estimate its error.

    The error of restitution may be twice that of velocities, so each is seen from the next one as
    well. Beside the scale, the round-off of bodies at rest is none. Impacts of rigid bodies have
    neither a largest force nor a time: their impulse grows in jumps. A joint is never done: of it
    counts the impulse up to a given end, beside the largest so far.
    """
    at, values, steps, h = search.at, search.values, level.at[TAKEN], level.step[0]
    n, width, count = at[LEVELS], width_of_measures(make), len(make.opening)
    passed = 0.0
    search.sizes[n] = h
    tick_times(level)
    group_velocities(
        make, numbers, level, signals, state.speed, steps, search.mass, search.after
    )
    p = n * width
    before = math.nan
    for g in range(len(make.held)):
        if make.held[g] == 0:
            values[p] = search.after[g]
            p += 1
            if before == before:
                values[p] = search.after[g] - before
                p += 1
            before = search.after[g]
    marks = (0, p - n * width, width - 3 * count, width - 2 * count, width - count, width)
    for i in range(len(make.law)):
        if make.law[i] == JOINT:
            values[p] = 0.0
            if level.at[REASON] == UNTIL:
                values[p], most = joint_impulse(level, signals, signals.link_start[i], steps)
                passed = max(passed, most)
            p += 1
    for c in range(count):
        i, start = make.opening[c], signals.link_start[make.opening[c]]
        values[p + c] = tally.impulse[i] * h
        values[p + count + c] = values[p + 2 * count + c] = values[p + 3 * count + c] = 0.0
        if make.law[i] != IMPACT:
            values[p + count + c] = peak_force(make, numbers, level, state, signals, i)
            values[p + 2 * count + c] = time_of_most(level.times, signals.force, start, steps)
            values[p + 3 * count + c] = time_under_force(make, numbers, level, signals, i)
        if passed > 0:
            passed = max(passed, values[p + c])
    at[LEVELS], smooth = n + 1, is_smooth(make, search, level)
    lost = energy_lost(make, numbers, level, state, tally, signals) if make.kind[LOSES] > 0 else 0.0
    for name in range(MEASURES):
        scale = 0.0
        if name == VELOCITY:
            scale = numbers.setting[SCALE]
        elif name == IMPULSE:
            scale = passed
        error = error_of(
            values, width, search.sizes, n + 1, marks[name], marks[name + 1], smooth, scale
        )
        search.estimates[name] = max(SURE * error, lost)
    search.estimates[MEASURES] = lost
    at[PEAKS_CARRIED] = at[TIMES_CARRIED] = 0
    if smooth:
        error = carried_error(values, width, search.sizes, n + 1, marks[PEAK], marks[PEAK + 1])
        if error < search.estimates[PEAK]:
            search.estimates[PEAK], at[PEAKS_CARRIED] = error, 1
        error = carried_error(values, width, search.sizes, n + 1, marks[TIME], width)
        if error < search.estimates[TIME]:
            search.estimates[TIME], at[TIMES_CARRIED] = error, 1
            search.estimates[DURATION] = carried_error(
                values, width, search.sizes, n + 1, marks[DURATION], width)
    level.at[KEPT] = level.at[CLOSINGS] if level.at[CUT] > 0 else -1
    for q in range(level.at[CLOSINGS]):
        level.kept_time[q], level.kept_link[q] = level.closing_time[q], level.closing_link[q]


def joint_impulse(level: Level, signals: Signals, start: int, steps: int) -> tuple[float, float]:
    """Impulse of a joint at the end, and the largest until then, N s."""
    impulse = most = 0.0
    for j in range(steps):
        impulse += signals.force[start + j] * (level.times[j + 1] - level.times[j])
        most = max(most, abs(impulse))
    return impulse, most


def peak_force(
    make: Make, numbers: Numbers, level: Level, state: State, signals: Signals, i: int
) -> float:
    """Largest force of a contact, N: that of the largest indentation, if it has no dashpot."""
    start, steps = signals.link_start[i], level.at[TAKEN]
    yields = make.law[i] == YIELD
    if numbers.stiffness[i] > 0 and (numbers.damping[i] == 0 or yields):
        h, p = level.step[0], numbers.exponent[i]
        before = numbers.gap[i] / h
        x = h * deepest(level.times, signals.gap, start, steps, before)
        F = float(numbers.stiffness[i] * (x * math.sqrt(x) if p == 1.5 else x**p))
        return min(F, state.strength[i]) if yields else F
    return largest_force(level.times, signals.force, start, steps)


def time_under_force(
    make: Make, numbers: Numbers, level: Level, signals: Signals, i: int
) -> float:
    """How long a contact presses, s; an impact takes no time, though it takes a step here."""
    start, steps, h = signals.link_start[i], level.at[TAKEN], level.step[0]
    level.gap[0] = numbers.gap[i]
    for j in range(steps):
        level.gap[j + 1] = signals.gap[start + j] * h
    sudden = make.law[i] == IMPACT
    return pressed_time(
        level.times, signals.force, level.gap, start, steps, sudden, h * (1 + 1e-9)
    )


def width_of_measures(make: Make) -> int:
    """How many numbers are kept of a level: those that are watched, and times under force."""
    free = joints = 0
    for g in range(len(make.held)):
        if make.held[g] == 0:
            free += 1
    for i in range(len(make.law)):
        if make.law[i] == JOINT:
            joints += 1
    return free + max(free - 1, 0) + joints + 4 * len(make.opening)


def is_met(search: Search) -> bool:
    """Whether all estimates have come to the goal."""
    worst = 0.0
    for name in range(DURATION):
        worst = max(worst, search.estimates[name])
    return bool(worst <= search.goal[0])


def is_smooth(make: Make, search: Search, level: Level) -> bool:
    """Whether no delay has a fraction, and no force begins with a jump behind t = 0."""
    sudden = make.kind[ABRUPT] > 0 and (level.at[CUT] == 0 or level.at[CLOSINGS] > 0)
    return bool(search.at[FITS] > 0 and not sudden)


def leave_out(search: Search) -> None:
    """Leave out levels that cannot be accurate, if errors fall with the square of the step."""
    at, excess = search.at, 0.0
    for name in range(DURATION):
        excess = max(excess, search.estimates[name] / search.goal[0])
    if excess < math.inf:
        factor = factor_of(at[RUNG] - 1) * min(FARTHEST, math.sqrt(excess))
        while factor_of(at[RUNG]) < factor and factor_of(at[RUNG] + 1) <= at[MOST_FACTOR]:
            at[RUNG] += 1


def tick_times(level: Level) -> None:
    """Times of the edges of the parts that were taken, s."""
    tick = level.step[0] / STEP_TICKS
    for j in range(level.at[TAKEN] + 1):
        level.times[j] = level.edges[j] * tick


def group_velocities(
    make: Make, numbers: Numbers, level: Level, signals: Signals, speed: Any, j: int, mass: Any,
    velocity: Any,
) -> None:
    """Masses of the groups of bonded bodies, and velocities of their centres before part j.

    `speed` are those of the rigid masses then. Where nothing of a group can move, both are 0.
    """
    tick, now = level.step[0] / STEP_TICKS, level.edges[j]
    for g in range(len(mass)):
        mass[g] = velocity[g] = 0.0
    for s in range(1, len(level.ticks) - 1):
        g, Z, T = make.group[s], numbers.impedance[s - 1], level.ticks[s]
        total = 0.0
        for line in (2 * s, 2 * s + 1):
            total += inside_segment(level, signals, line, j, now - T, 0.0, False)
        velocity[g] += Z / 2 * total * tick
        mass[g] += Z * T * tick
    for m in range(len(numbers.mass)):
        g = make.mass_group[m]
        velocity[g] += numbers.mass[m] * speed[m]
        mass[g] += numbers.mass[m]
    fallen = numbers.setting[FRAME] + numbers.setting[GRAVITY] * tick * now
    for g in range(len(mass)):
        if mass[g] > 0:
            velocity[g] = velocity[g] / mass[g] + fallen


def inside_segment(
    level: Level, signals: Signals, line: int, j: int, since: int, v: float, squared: bool
) -> float:
    """Integral over what left since a tick, before part j, of wave - v or of its square."""
    start, total, until = signals.wave_start[line], 0.0, level.edges[j]
    while until > since:
        j -= 1
        begin = max(begin_of(level, j), since)
        w = signals.wave[start + j] - v
        total += (w * w if squared else w) * (until - begin)
        until = begin
    return total


def vibrations(
    make: Make, numbers: Numbers, level: Level, signals: Signals, speed: Any, j: int,
    velocity: Any, vibration: Any,
) -> None:
    """Energy of each body before part j, of strain and of the motion about its group's, J."""
    tick, now = level.step[0] / STEP_TICKS, level.edges[j]
    fallen = numbers.setting[FRAME] + numbers.setting[GRAVITY] * tick * now
    for b in range(len(make.body_first)):
        vibration[b] = 0.0
        for s in range(make.body_first[b], make.body_last[b] + 1):
            v, Z = velocity[make.group[s]] - fallen, numbers.impedance[s - 1]
            for line in (2 * s, 2 * s + 1):
                since = now - level.ticks[s]
                stored = inside_segment(level, signals, line, j, since, v, True)
                vibration[b] += Z / 4 * tick * stored
        m = make.body_mass[b]
        if m >= 0:
            off = speed[m] - (velocity[make.mass_group[m]] - fallen)
            vibration[b] += numbers.weight[b] * off * off / 2


def energy_lost(
    make: Make, numbers: Numbers, level: Level, state: State, tally: Tally, signals: Signals
) -> float:
    """Energy lost to the time step, of that which was there at t = 0 in the frame of the row.

    Where rigid contacts close inside a part, and, of a mean of two averages, their variance.
    """
    tick, lost, there = level.step[0] / STEP_TICKS, 0.0, 0.0
    for i in range(len(tally.numerical)):
        lost += tally.numerical[i] * level.step[0]
        there += stored(make.law[i], numbers.stiffness[i], numbers.exponent[i], numbers.gap[i])
    for m in range(len(numbers.mass)):
        there += numbers.mass[m] * numbers.speed[m] * numbers.speed[m] / 2
    for s in range(1, len(level.ticks) - 1):
        Z, fraction = numbers.impedance[s - 1], level.ticks[s] % STEP_TICKS
        for line in (2 * s, 2 * s + 1):
            held = inside_segment(level, signals, line, 0, -level.ticks[s], 0.0, True)
            there += Z * tick / 4 * held
            start = signals.wave_start[line] - inside(state, s)
            if fraction > 0:
                for j in range(level.at[TAKEN]):
                    lasts = level.edges[j + 1] - level.edges[j]
                    w = min(1.0, fraction / lasts)
                    change = signals.wave[start + j + 1] - signals.wave[start + j]
                    lost += Z * tick * w * (1 - w) * change * change * lasts / 4
    if there > 0:
        lost /= there
    return lost if lost == lost else math.inf


def add_up(
    make: Make, numbers: Numbers, search: Search, level: Level, state: State, tally: Tally,
    signals: Signals,
) -> None:
    """Enter what the last level comes to: velocities, vibration, and totals of the contacts."""
    at, steps, h = search.at, level.at[TAKEN], level.step[0]
    tick_times(level)
    group_velocities(make, numbers, level, signals, numbers.speed, 0, search.mass, search.before)
    group_velocities(
        make, numbers, level, signals, state.speed, steps, search.mass, search.after
    )
    vibrations(
        make, numbers, level, signals, state.speed, steps, search.after, search.vibration
    )
    for c in range(len(make.opening)):
        i = make.opening[c]
        search.impulse[c] = tally.impulse[i] * h
        search.peak[c] = math.nan
        if make.law[i] != IMPACT:
            search.peak[c] = peak_force(make, numbers, level, state, signals, i)
        search.pressed[c] = time_under_force(make, numbers, level, signals, i)
        n, width, count = at[LEVELS], width_of_measures(make), len(make.opening)
        if at[PEAKS_CARRIED] > 0 and make.law[i] != IMPACT:
            search.peak[c] = carried_on(
                search.values, width, search.sizes, n, 1, width - 3 * count + c)
        if at[TIMES_CARRIED] > 0 and make.law[i] != IMPACT:
            search.pressed[c] = carried_on(
                search.values, width, search.sizes, n, 1, width - count + c)


class Results(NamedTuple):
    """What became of the members of a family, each as wide as what it comes from, row after row."""

    flag: Any  # [member] DONE, or what stopped it
    reason: Any  # [member]
    final: Any  # [member] 1 with a proof
    before: Any
    after: Any
    vibration: Any
    impulse: Any
    peak: Any
    pressed: Any
    episodes: Any


def solve_members(
    make: Make, numbers: Numbers, limit: Limit, search: Search, level: Level, state: State,
    tally: Tally, signals: Signals, points: Points, links: Chain, clock: Any, given: Any,
    beyond: Any, step: float, results: Results,
) -> int:
    """Solve members of a family, whose numbers are rows of `given`.

    `step`, s, is chosen where it is 0. Those that are `beyond` what steps can do are left out.

    Returns
    -------
    How many of the first members were solved, before one for which there is no room.
    """
    for member in range(len(beyond)):
        if beyond[member]:
            results.flag[member] = BEYOND
            continue
        take(given, member, numbers)
        search.at[NEXT], search.at[FIXED], level.step[0] = PREPARE, 1 if step > 0 else 0, step
        flag = FILL
        while flag == FILL:
            flag = go_on(
                make, numbers, limit, search, level, state, tally, signals, points, links, clock
            )
            if flag == FILL:
                fill_evenly(make, numbers, level, state, signals)
        if flag == FULL:
            return member
        results.flag[member] = flag
        if flag == DONE:
            enter(make, search, level, tally, results, member)
    return len(beyond)


def work_on(
    make: Make, numbers: Numbers, limit: Limit, search: Search, level: Level, state: State,
    tally: Tally, signals: Signals, points: Points, links: Chain, clock: Any, given: Any,
    beyond: Any, step: float, results: Results, job: int,
) -> int:
    """Do a job of a run, or of a family; this is the one kernel of which there is machine code."""
    if job == MEMBERS:
        return solve_members(
            make, numbers, limit, search, level, state, tally, signals, points, links, clock,
            given, beyond, step, results,
        )
    if job == SEARCH:
        return go_on(
            make, numbers, limit, search, level, state, tally, signals, points, links, clock
        )
    if job == EVENLY:
        fill_evenly(make, numbers, level, state, signals)
        return DONE
    return extend(numbers, level, state, tally, signals, points, links, clock)


def take(given: Any, member: int, numbers: Numbers) -> None:
    """Read the numbers of a member."""
    width = 0
    for column in numbers:
        width += len(column)
    p = member * width
    for column in numbers:
        for i in range(len(column)):
            column[i] = given[p + i]
        p += len(column)


def enter(
    make: Make, search: Search, level: Level, tally: Tally, results: Results, member: int
) -> None:
    """Enter the totals of a member."""
    results.reason[member] = level.at[REASON]
    results.final[member] = 1 if level.at[PROOF] >= 0 else 0
    groups, bodies, contacts = len(search.mass), len(search.vibration), len(search.impulse)
    for g in range(groups):
        results.before[member * groups + g] = search.before[g]
        results.after[member * groups + g] = search.after[g]
    for b in range(bodies):
        results.vibration[member * bodies + b] = search.vibration[b]
    for c in range(contacts):
        p = member * contacts + c
        results.impulse[p], results.peak[p] = search.impulse[c], search.peak[c]
        results.pressed[p] = search.pressed[c]
        results.episodes[p] = tally.episodes[make.opening[c]]
