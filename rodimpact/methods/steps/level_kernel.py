"""One run with a given step: how the row is laid out on it, and how far it goes.

A run ends at `until`, or where it is proved that nothing meets again, or at the cap on steps. Where
all delays are whole steps, steps are cut where contacts close whose force begins with a jump: the
run stops at the first closing inside a part of a step, to be laid out anew with a cut there.

The force of a stiff contact grows within a time, its layer, that may be far shorter than a step,
and does so again wherever waves come back. Then parts are laid out over a period, of which all
transit times are whole numbers, and grow from each cut on, from a share of the layer to a step.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..clock import STEP_TICKS
from ..contact_law_kernel import BOND, IMPACT, Chain, Tally
from ..finality_kernel import NEVER
from .step_kernel import (
    CUTS,
    DONE,
    LINK,
    STEP,
    Points,
    Signals,
    State,
    abrupt,
    finality_time,
    inside,
    run,
)

NONE, VELOCITY, FORCED, ABSORBING = range(4)  # what acts on an end of the row
FRAME, GRAVITY, SCALE, FINEST, LAYER = range(5)  # places in Numbers.setting
WHOLE = 4  # ticks by which a transit may miss a whole number of steps: round-off
TOLERANCE = 1 / (1 << 48)  # of the velocities, below which contacts graze
LEAST = 1 / (1 << 800)  # stiffness, where time is counted in steps
MOST_CUTS = 24  # of a step, where contacts close
MOST_PLACES = 4 * MOST_CUTS + 2
GROWTH = 0.09  # of graded parts: by how much of their distance from a cut, and of the layer
WIDEST = 1.6  # steps, that a graded part may last
EARLIER = 4  # layers, by which steps are cut before a stiff contact closes
MOMENT = STEP_TICKS >> 21  # ticks before and after an impact
SAME = 1 / 16  # steps: a contact that closes so near to where it did was placed badly before
MOST_OF_TRANSIT = 2.0**26  # steps; more are too many for memory, and for whole numbers
MOST_PARTS = 2.0**52
LAID, FULL, TOO_LONG, VANISHED = range(10, 14)  # how laying out went
FINAL, UNTIL, CAPPED = range(3)  # why a run stopped
DRIVEN, ABRUPT, LOSES = range(3)  # places in Make.kind: no proof is to be looked for; the force of
# a contact begins with a jump; energy is lost where rigid contacts close
FIRST_ROOM, LEAST_ROOM = 8, 3  # transits of the longest rod
# places in Level.at
PARTS, ROOM, ASKED, LONGEST, PROOF, TAKEN, REASON, CUT, CLOSINGS, KEPT, TRIES, HAD = range(12)
PERIOD, FACTOR = 12, 13  # in ticks; by what steps are divided whose parts are graded, or 0


class Make(NamedTuple):
    """What a family of rows has in common; whole numbers."""

    first: Any  # [node + 1] first mass at the node
    law: Any  # [link]
    opening: Any  # [contact that can open] its link
    group: Any  # [segment] group of bonded bodies
    mass_group: Any  # [mass]
    held: Any  # [group] 1 where a wall, a drive or an endless bar holds it
    body_first: Any  # [body] segments of its rod; 1 and 0 for others
    body_last: Any
    body_mass: Any  # [body] its mass, -1 without
    outside: Any  # [2] NONE, VELOCITY, FORCED or ABSORBING
    jump_segment: Any  # [jump] where the initial state jumps; 0 for a jump of a drive
    kind: Any  # [3] see its places


class Numbers(NamedTuple):
    """What members of a family differ in; SI units."""

    transit: Any  # [n] s
    impedance: Any  # [n] kg/s
    right: Any  # [n] waves at t = 0 that run to the right and to the left, m/s, where all is even
    left: Any  # [n]
    stiffness: Any  # [link]
    exponent: Any  # [link]
    damping: Any  # [link]
    strength: Any  # [link] N
    gap: Any  # [link] m
    mass: Any  # [mass] kg
    speed: Any  # [mass] in the frame
    weight: Any  # [body] mass of a rigid body, kg
    outside: Any  # [2] velocity or force of an end, or wave that comes in, m/s
    jump_place: Any  # [jump] share of the segment, or time in s
    setting: Any  # [5] frame, gravity, scale of velocities, shortest step that contacts ask for,
    # and the least time in which one loads a rod


class Level(NamedTuple):
    """A layout on a step, and how far the run on it came."""

    at: Any  # whole numbers, see their places
    step: Any  # [1] s
    ticks: Any  # [segment] transit times
    places: Any  # where in a period its parts begin, and where it ends
    edges: Any  # [part + 1] ticks
    share: Any  # [segment] room for the shares of a part
    closing_time: Any  # contacts that close, s, and their links
    closing_link: Any
    kept_time: Any  # the same of the level before
    kept_link: Any
    times: Any  # [part + 1] the edges, s
    gap: Any  # [part + 1] room for the gap of a contact, m


class Limit(NamedTuple):
    """What a run may take."""

    until: Any  # [1] s, -1 without
    steps: Any  # [1] parts of steps
    numbers: Any  # [3] that memory holds; that a part takes; that an average from before t = 0 does


def near_tick(x: float) -> int:
    """Nearest whole number."""
    return math.floor(x + 0.5)


def edge(level: Level, j: int) -> int:
    """Tick at which part j begins, which may lie before t = 0."""
    parts = level.at[PARTS]
    tick: int = j // parts * level.at[PERIOD] + level.places[j % parts]
    return tick


def begin_of(level: Level, j: int) -> int:
    """The same, behind the last part the tick at which the run ends."""
    tick: int = level.edges[j] if j >= 0 else edge(level, j)
    return tick


def put_on_ticks(numbers: Numbers, level: Level) -> bool:
    """Transit times on the clock of the step, and its period; whether all are whole steps."""
    h, fits, period = level.step[0], True, 0
    for s in range(len(numbers.transit)):
        steps = min(numbers.transit[s] / h, MOST_OF_TRANSIT)
        ticks = max(STEP_TICKS, near_tick(steps * STEP_TICKS))
        near = (ticks + STEP_TICKS // 2) // STEP_TICKS * STEP_TICKS
        if abs(ticks - near) <= WHOLE + (ticks >> 50):
            ticks = near
        level.ticks[s + 1] = ticks
        fits = fits and ticks % STEP_TICKS == 0
        period = math.gcd(period, ticks)
    level.at[PERIOD] = period if fits and level.at[FACTOR] > 0 else STEP_TICKS
    return fits


def cut_at(level: Level, tick: int, count: int) -> int:
    """Enter the place in a period of a tick in order; return how many there are."""
    x, i = tick % level.at[PERIOD], count
    if x <= WHOLE or level.at[PERIOD] - x <= WHOLE:
        return count
    for q in range(count):
        if abs(level.places[q] - x) <= WHOLE:
            return count
    while i > 0 and level.places[i - 1] > x:
        level.places[i] = level.places[i - 1]
        i -= 1
    level.places[i] = x
    return count + 1


def cut_steps(make: Make, numbers: Numbers, level: Level) -> None:
    """Transit times on the clock of the step, and places at which each period is cut into parts.

    Where jumps of the initial state and of drives pass the ends of segments, if these are no more
    than a step is cut for; and where contacts close. The bodies of an impact change their velocity
    in the middle of a part, so that is short.
    """
    places, at, h = level.places, level.at, level.step[0]
    if not put_on_ticks(numbers, level):
        at[CUT] = at[CLOSINGS] = 0
    places[0], count = 0, 1
    if at[CUT] > 0:
        for q in range(len(make.jump_segment)):
            s, x = make.jump_segment[q], numbers.jump_place[q]
            tick = near_tick(x * level.ticks[s] if s > 0 else x / h * STEP_TICKS)
            if count <= MOST_CUTS + 1:
                count = cut_at(level, tick, count)
            if s > 0 and count <= MOST_CUTS + 1:
                count = cut_at(level, -tick, count)
        for i in range(len(make.law)):
            if make.law[i] == IMPACT and numbers.gap[i] == 0 and count <= MOST_CUTS + 1:
                count = cut_at(level, MOMENT, count)
        if count > MOST_CUTS + 1:
            count = 1
        for q in range(at[CLOSINGS]):
            tick = near_tick(level.closing_time[q] / h * STEP_TICKS)
            if make.law[level.closing_link[q]] == IMPACT:
                count = cut_at(level, tick - MOMENT, count)
                count = cut_at(level, tick + MOMENT, count)
            else:
                count = cut_at(level, tick, count)
    places[count] = at[PERIOD]
    at[PARTS] = count
    if at[FACTOR] > 0:
        grade(level, numbers.setting[LAYER] / h * STEP_TICKS)


def grade(level: Level, layer: float) -> None:
    """Divide what lies between places into parts that grow, if there is room; count them.

    At a time t behind a place a part lasts GROWTH (layer + t) over the factor of the level, and
    WIDEST at most. Hence log(1 + t/layer) is divided evenly, and then what is left.
    """
    at, places, count, total = level.at, level.places, level.at[PARTS], 0
    for q in range(count):
        total += graded_parts(level, layer, places[q + 1] - places[q])[0]
    at[PARTS] = total
    if total >= len(places):
        return
    growth, widest = GROWTH / at[FACTOR], WIDEST * STEP_TICKS
    logs = math.log1p(max(widest / growth - layer, 0.0) / layer) / growth
    places[total] = places[count]
    for q in range(count - 1, -1, -1):
        begin = places[q]
        parts, steps = graded_parts(level, layer, places[q + 1] - begin)
        total -= parts
        for m in range(parts):
            x = m * steps / parts
            t = layer * math.expm1(growth * min(x, logs)) + max(x - logs, 0.0) * widest
            places[total + m] = begin + near_tick(t)


def graded_parts(level: Level, layer: float, ticks: int) -> tuple[int, float]:
    """Into how many graded parts so many ticks are divided: a multiple of the factor, and exact."""
    growth, widest = GROWTH / level.at[FACTOR], WIDEST * STEP_TICKS
    even = max(widest / growth - layer, 0.0)  # from where on parts no longer grow
    exact = math.log1p(min(ticks, even) / layer) / growth + max(ticks - even, 0.0) / widest
    if exact <= 1:
        return 1, exact
    return math.ceil(exact / level.at[FACTOR]) * level.at[FACTOR], exact


def note_closing(numbers: Numbers, level: Level, state: State, clock: Any) -> None:
    """Remember the contact that has closed inside a part; cut no more where there are too many."""
    at, h, link = level.at, level.step[0], clock[LINK]
    when = (clock[STEP] // at[PARTS] * (at[PERIOD] // STEP_TICKS) + state.closed[0]) * h
    if not abrupt(state, link):
        when = max(0.0, when - EARLIER * numbers.setting[LAYER])
    count = 0
    for q in range(at[CLOSINGS]):
        other = level.closing_link[q]
        if other != link or abs(level.closing_time[q] - when) > SAME * h:
            level.closing_time[count], level.closing_link[count] = level.closing_time[q], other
            count += 1
    level.closing_time[count], level.closing_link[count] = when, link
    at[CLOSINGS] = count + 1
    at[TRIES] += 1
    if count + 1 > MOST_CUTS or at[TRIES] > MOST_CUTS:
        at[CUT] = at[CLOSINGS] = 0


def lay_out(
    make: Make, numbers: Numbers, limit: Limit, level: Level, state: State, tally: Tally,
    signals: Signals, clock: Any,
) -> int:
    """Lay out a row on the step of a level, all but waves and what comes from outside.

    Transit times are on its ticks, and steps are cut at its places, of which Level.at[PARTS] begin.

    Returns
    -------
    LAID; FULL: the signals have no room, which is to be given for Level.at[ROOM] parts; TOO_LONG:
    that takes too much memory; VANISHED: a force is less than a double holds
    """
    at, h, n = level.at, level.step[0], len(numbers.transit)
    parts, period = at[PARTS], at[PERIOD]
    periods = limit.until[0] / (h * (period // STEP_TICKS))
    if periods * parts > MOST_PARTS:
        return TOO_LONG
    for s in range(n):
        if numbers.transit[s] / h > MOST_OF_TRANSIT:
            return TOO_LONG
    count = total = 0
    for body in range(len(make.body_first)):
        ticks = 0
        for s in range(make.body_first[body], make.body_last[body] + 1):
            ticks += level.ticks[s]
            total += level.ticks[s] // period * parts
            if level.ticks[s] % period > 0:
                total += 1
        count = max(count, -(-ticks // period))
    at[LONGEST] = count * parts
    left = limit.numbers[0] - total * limit.numbers[2]
    room = at[ASKED] * at[LONGEST]
    if limit.until[0] >= 0:
        room = near_tick(periods) * parts + parts
    elif room * limit.numbers[1] > left:  # as much as there is, if that is more than before
        least = max(LEAST_ROOM, at[HAD] + 1)
        most = left / (at[LONGEST] * limit.numbers[1])
        if most >= least:
            room = math.floor(most) * at[LONGEST]
    at[ROOM] = room
    if room * limit.numbers[1] > left:
        return TOO_LONG
    if room + 1 > len(level.edges) or not place_signals(make, level, signals):
        return FULL
    for s in range(n + 2):
        ticks = level.ticks[s]
        state.steps[s] = ticks // period * parts
        state.share[s] = ticks % STEP_TICKS / STEP_TICKS
        state.transit[s] = ticks / STEP_TICKS
        state.mobility[s] = 1 / numbers.impedance[s - 1] if 1 <= s <= n else 0.0
    for side in range(2):
        if make.outside[side] == ABSORBING:
            state.mobility[(n + 1) * side] = state.mobility[1 if side == 0 else n]
    state.parts[0] = parts
    state.layer[0] = numbers.setting[LAYER] / h if at[FACTOR] > 0 else math.inf
    for m in range(parts):
        state.part[m] = (level.places[m + 1] - level.places[m]) / STEP_TICKS
    for i in range(len(make.law)):
        p, k = numbers.exponent[i], numbers.stiffness[i]
        if p == 1:
            state.stiffness[i] = k * h
        elif p == 1.5:
            state.stiffness[i] = k * h * math.sqrt(h)
        else:
            state.stiffness[i] = k * h**p
        if k > 0 and state.stiffness[i] < LEAST:
            return VANISHED
        state.exponent[i], state.damping[i] = p, numbers.damping[i]
        state.strength[i] = numbers.strength[i]
        state.gap[i] = numbers.gap[i] / h
        state.force[i] = state.closing[i] = 0.0
        state.open[i] = 1
        tally.impulse[i] = tally.lost[i] = tally.numerical[i] = tally.peak[i] = 0.0
        tally.first[i] = tally.last[i] = -1
        tally.pressed[i] = tally.episodes[i] = 0
    for m in range(len(numbers.mass)):
        state.mass[m], state.speed[m] = numbers.mass[m] / h, numbers.speed[m]
    begin = m = 0
    for j in range(room + 1):
        level.edges[j] = begin + level.places[m]
        m += 1
        if m == parts:
            begin, m = begin + period, 0
    at[PROOF], at[TAKEN] = -1, 0
    clock[STEP] = clock[LINK] = 0
    clock[CUTS] = at[CUT]
    if limit.until[0] >= 0:
        end = near_tick(limit.until[0] / h * STEP_TICKS)
        j = 0
        while level.edges[j] < end:
            j += 1
        level.edges[j] = end
        at[ROOM] = j
    return LAID


def place_signals(make: Make, level: Level, signals: Signals) -> bool:
    """Say where each signal begins; False where there is no room."""
    n, room, size = len(level.ticks) - 2, level.at[ROOM], 0
    parts = level.at[PARTS]
    for line in range(2 * n + 4):
        s = line // 2
        signals.wave_start[line] = -1
        ahead = 1
        if 1 <= s <= n:
            ahead = level.ticks[s] // level.at[PERIOD] * parts
            if level.ticks[s] % level.at[PERIOD] > 0:
                ahead += 1
        kept = 1 <= s <= n
        if line == 0 or line == 2 * n + 3:
            kept = make.outside[0 if line == 0 else 1] != NONE
        if kept:
            signals.wave_start[line] = size + ahead
            size += ahead + room
    wanted = 0
    for i in range(len(make.law)):
        signals.link_start[i] = -1
        if make.law[i] > BOND:
            signals.link_start[i] = wanted * room
            wanted += 1
    for m in range(len(signals.mass_start)):
        signals.mass_start[m] = m * room
    return (size <= len(signals.wave) and wanted * room <= len(signals.force)
            and len(signals.mass_start) * room <= len(signals.speed))


def fill_evenly(
    make: Make, numbers: Numbers, level: Level, state: State, signals: Signals
) -> None:
    """Fill in waves at t = 0, and what comes from outside, of a row where all that is even."""
    n, at = len(numbers.transit), level.at
    for s in range(1, n + 1):
        for line, value in ((2 * s, numbers.right[s - 1]), (2 * s + 1, numbers.left[s - 1])):
            start = signals.wave_start[line]
            for i in range(start - inside(state, s), start):
                signals.wave[i] = value
    for side in range(2):
        line, own = (0, 2) if side == 0 else (2 * n + 3, 2 * n + 1)
        kind, start, value = make.outside[side], signals.wave_start[line], numbers.outside[side]
        if kind == NONE:
            continue
        fall = 0.0
        if kind == ABSORBING:
            value += signals.wave[signals.wave_start[own] - 1]
        elif kind == VELOCITY:
            value -= numbers.setting[FRAME]
            fall = numbers.setting[GRAVITY] * level.step[0] / (2 * STEP_TICKS)
        signals.wave[start - 1] = value - fall * (edge(level, -1))
        for j in range(at[ROOM]):
            signals.wave[start + j] = value - fall * (level.edges[j] + level.edges[j + 1])


def run_level(
    make: Make, numbers: Numbers, limit: Limit, level: Level, state: State, tally: Tally,
    signals: Signals, points: Points, links: Chain, clock: Any,
) -> int:
    """Run from t = 0 to the end; see the file.

    Returns
    -------
    DONE, CLOSED, SQUEEZED; FULL: there is no room to go on
    """
    at, flag = level.at, DONE
    tol = TOLERANCE * numbers.setting[SCALE]
    longest, room = at[LONGEST], at[ROOM]
    driven = make.kind[DRIVEN] > 0
    if limit.until[0] >= 0:
        at[REASON] = UNTIL
        even = room
        if room > 0 and level.edges[room] < edge(level, room):
            even = room - 1
        flag = run(state, tally, signals, points, links, clock, even, tol)
        if flag == DONE and not driven and finality_time(state, signals, even, tol) == 0:
            at[PROOF] = even
        if flag == DONE and even < room:
            flag = run_part(level, state, tally, signals, points, links, clock, tol)
        at[TAKEN] = clock[STEP]
        return flag
    cap = limit.steps[0]
    j, at[REASON] = 0, CAPPED
    while j < cap:
        wait = finality_time(state, signals, j, tol)
        if wait == 0:
            at[REASON], at[PROOF] = FINAL, j
            flag = run(state, tally, signals, points, links, clock, j + 1, tol)
            break
        # an eighth more each time, so that proofs cost no more than the run
        pause, half = 0, (longest + 1) // 2
        if wait < NEVER // at[PARTS]:
            pause = min(wait * at[PARTS] * STEP_TICKS // at[PERIOD], 8 * longest)
        j = min(cap, j + max(half, pause, j // 8))
        if j + 2 * longest + 2 > room:
            at[HAD] = room // longest
            at[ASKED] *= 4
            return FULL
        flag = run(state, tally, signals, points, links, clock, j, tol)
        if flag != DONE:
            break
    at[TAKEN] = clock[STEP]
    return flag


def run_part(
    level: Level, state: State, tally: Tally, signals: Signals, points: Points, links: Chain,
    clock: Any, tol: float,
) -> int:
    """Run the last part, of which there is less than of others."""
    j, n = clock[STEP], len(level.ticks)
    m = j % level.at[PARTS]
    part = state.part[m]
    d = (level.edges[j + 1] - level.edges[j]) / STEP_TICKS
    for s in range(n):
        level.share[s] = state.share[s]
        state.share[s] = min(1.0, state.share[s] / d)
    state.part[m] = d
    flag: int = run(state, tally, signals, points, links, clock, j + 1, tol)
    state.part[m] = part
    for s in range(n):
        state.share[s] = level.share[s]
    return flag


def extend(
    numbers: Numbers, level: Level, state: State, tally: Tally, signals: Signals, points: Points,
    links: Chain, clock: Any,
) -> int:
    """Run on after the proof, to a round trip of the longest rod from there."""
    end, clock[CUTS] = level.at[TAKEN] + 2 * level.at[LONGEST] - 1, 0
    tol = TOLERANCE * numbers.setting[SCALE]
    flag: int = run(state, tally, signals, points, links, clock, end, tol)
    level.at[TAKEN] = end
    return flag
