"""End signals on a common time step: rods as delay lines, everything else at their ends.

In a uniform segment the velocity is v = (a + b)/2 with a travelling right and b travelling left,
and what leaves one end arrives at the other a transit time later. Signals are averages over steps.
Where transit times are whole numbers of steps a delay is exact; otherwise what arrives in a step is
the mean of what left during that time, (1 - w) of one step and w of the one before it, which keeps
the momentum and never adds energy. Where all delays are whole, each step may be cut at the same
places into parts, or each period of several steps: then a jump that begins at a cut, as where a
rigid contact closes, lies between two parts for ever after. Places in signals are counted in parts,
lengths of time in steps.

Node k joins the segments k and k + 1; line 2s carries a and line 2s + 1 carries b through
segment s. The segments 0 and n + 1 stand for what lies outside: lines 0 and 2n + 3 bring what comes
from there, filled in advance: the velocity of a wall or a drive (mobility 0), the wave that comes
through an endless bar (absorbing end), or under the law FORCE the force itself.

At a node stands a chain of points: the left rod end, masses, the right rod end; and of links, one
between neighbours. A force F > 0 in a link pushes its two points apart. Over one part of a step
every point obeys v = v_free +- y F: a rod end with the arriving average and its mobility y = 1/Z, a
mass M with its velocity V at the start and y = d/(2M) (midpoint rule, V_end = 2v - V), d the
duration. Hence a link closes by d (c - A F) with A a tridiagonal Stieltjes matrix, and its law
gives F from that. The links of one node are solved together; different nodes meet only one transit
later. A rigid contact leaves a gap >= 0 at the end. Laws and units: see `contact_law_kernel`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..contact_law_kernel import (
    BOND,
    FORCE,
    FREE,
    IMPACT,
    JOINT,
    RIGID,
    SPRING,
    Chain,
    Tally,
    balance,
    indent,
    pushed,
    record_step,
    solve_link,
    start_impacts,
)
from ..finality_kernel import (
    NEVER,
    UNDECIDED,
    Side,
    bound_of,
    by_velocities,
    separation_time,
)

DONE, SQUEEZED, CLOSED = range(3)  # why a run stopped
STEP, LINK, CUTS = range(3)  # places in the clock
EARLY = 1 / (1 << 34)  # of one step's motion, by which a gap may close early
PLACED = 1 / (1 << 20)  # of a step: how near to its ends a contact closes as if there


class State(NamedTuple):
    """A row of n segments and m masses: lists or arrays; the last eight change in place."""

    steps: Any  # [segment] whole parts of steps in the transit time, 0 outside
    share: Any  # [segment] what of one more step there is
    transit: Any  # [segment] both together, in steps
    parts: Any  # [1] into how many parts each step is cut, or each period of steps
    part: Any  # [part] their durations
    mobility: Any  # [segment] 1/Z; 0 for a wall, that of the rod for an absorbing end
    first: Any  # [node + 1] first mass at the node; links of node k begin at k + first[k]
    mass: Any  # [mass]
    law: Any  # [link]
    stiffness: Any  # [link] of what is compliant
    exponent: Any  # [link] of the indentation
    damping: Any  # [link] of HUNT: F = k x^(3/2) (1 + damping w); of JOINT and SPRING; of IMPACT e;
    # of YIELD the hardening
    strength: Any  # [link] of YIELD, N
    gap: Any  # [link] minus the indentation, the stretch of a JOINT
    force: Any  # [link] of the last step
    closing: Any  # [link] by how much it closed in the last step
    open: Any  # [link] 1 if the gap has opened since the contact last pressed
    speed: Any  # [mass] velocity
    closed: Any  # [1] where in its period a contact closed, in steps, after CLOSED
    layer: Any  # [1] steps: longer parts do not resolve how the force of a stiff contact begins


class Signals(NamedTuple):
    """Averages of waves and forces, and gaps and velocities at the ends, by parts of steps.

    Entry j of a signal stands at its start + j. Lines have as many entries before as their segment
    has parts, and one for a share: the initial state. The outside lines 0 and 2n + 3 have one;
    start -1 is not kept.
    """

    wave: Any
    wave_start: Any  # [line]
    force: Any
    gap: Any
    link_start: Any  # [link]
    speed: Any
    mass_start: Any  # [mass]


class Points(NamedTuple):
    """Room for the points of one node; lists or arrays of floats, two longer than the masses."""

    free: Any  # velocity without forces
    mobility: Any  # mobility


class Group(NamedTuple):
    """What is bonded and joined together on one side of a contact."""

    mass: float
    momentum: float
    mean: float  # velocity of the centre of mass; of the wall or the endless bar, if there is one
    low: float  # bounds of the end's velocity as long as it is free; infinite if not known
    high: float
    ground: int  # 1 if bonded to a wall, 2 to an endless bar, else 0


def arriving(state: State, signals: Signals, line: int, s: int, j: int) -> float:
    """What comes through a line of segment s in part j."""
    i, w = signals.wave_start[line] + j - state.steps[s], state.share[s]
    wave: float = signals.wave[i]
    if w > 0:
        wave += w * (signals.wave[i - 1] - wave)
    return wave


def reflect(state: State, signals: Signals, k: int, j0: int, j1: int) -> None:
    """Free end at either end of the row."""
    wave, start = signals.wave, signals.wave_start
    come, go = (3, 2) if k == 0 else (2 * k, 2 * k + 1)
    p, q, w = start[come] - state.steps[come // 2], start[go], state.share[come // 2]
    for j in range(j0, j1):
        a = wave[p + j]
        if w > 0:
            a += w * (wave[p + j - 1] - a)
        wave[q + j] = a


def join(state: State, tally: Tally, signals: Signals, k: int, j0: int, j1: int) -> None:
    """Two rod ends that share velocity and force; or an end under a given force."""
    wave, start, Yl, Yr = signals.wave, signals.wave_start, state.mobility[k], state.mobility[k + 1]
    i, n = k + state.first[k], len(state.steps) - 2
    p, q = start[2 * k] - state.steps[k], start[2 * k + 3] - state.steps[k + 1]
    left, right = start[2 * k + 1], start[2 * k + 2]
    wl, wr = state.share[k], state.share[k + 1]
    forced = state.law[i] == FORCE
    impulse, F = tally.impulse[i], state.force[i]
    parts = state.parts[0]
    m = j0 % parts
    for j in range(j0, j1):
        a, b = wave[p + j], wave[q + j]
        if wl > 0:
            a += wl * (wave[p + j - 1] - a)
        if wr > 0:
            b += wr * (wave[q + j - 1] - b)
        if not forced:
            F = (a - b) / (Yl + Yr)
        else:
            F = a if k == 0 else b
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        if k == 0 or k == n:
            impulse += F * state.part[m]
        m = m + 1 if m + 1 < parts else 0
    tally.impulse[i], state.force[i] = impulse, F


def touch(
    state: State, tally: Tally, signals: Signals, clock: Any, k: int, j0: int, j1: int, tol: float
) -> int:
    """Rigid contact between two rod ends, or between a rod end and a wall.

    With r = d (a - b) - gap, F = max(0, r/(d (Y1 + Y2))) leaves no gap behind. |r| <= tol is
    grazing: closed, without force. What closes inside a part loses F gap, unless the run is to
    stop there.
    """
    wave, start, Yl, Yr = signals.wave, signals.wave_start, state.mobility[k], state.mobility[k + 1]
    i, n = k + state.first[k], len(state.steps) - 2
    p, q = start[2 * k] - state.steps[k], start[2 * k + 3] - state.steps[k + 1]
    left, right, own = start[2 * k + 1], start[2 * k + 2], signals.link_start[i]
    wl, wr = state.share[k], state.share[k + 1]
    Z, gap, F = 1 / (Yl + Yr), state.gap[i], state.force[i]
    impulse, peak = tally.impulse[i], tally.peak[i]
    last, pressed = tally.last[i], tally.pressed[i]
    parts = state.parts[0]
    m = j0 % parts
    for j in range(j0, j1):
        a, b, d = wave[p + j], wave[q + j], state.part[m]
        if wl > 0:
            a += wl * (wave[p + j - 1] - a)
        if wr > 0:
            b += wr * (wave[q + j - 1] - b)
        rest = gap - d * (a - b)
        window = d * max(tol, EARLY * (a - b))
        if rest < -window:
            F = -rest * Z / d
            if gap > 0:
                if clock[CUTS] > 0 and closes_inside(state, clock, i, j, gap / (a - b)):
                    return CLOSED
                tally.numerical[i] += F * gap
                gap = 0.0
            if tally.first[i] < 0:
                tally.first[i] = j
            if state.open[i] > 0:
                tally.episodes[i] += 1
                state.open[i] = 0
            impulse += F * d
            peak = max(peak, F)
            pressed += 1
            last = j + 1
        else:
            F = gap = 0.0
            if rest > window:
                gap = rest
                state.open[i] = 1
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        signals.force[own + j] = F
        signals.gap[own + j] = gap
        m = m + 1 if m + 1 < parts else 0
    state.gap[i], state.force[i] = gap, F
    tally.impulse[i], tally.peak[i] = impulse, peak
    tally.last[i], tally.pressed[i] = last, pressed
    return DONE


def abrupt(state: State, i: int) -> bool:
    """Whether the force of link i begins with a jump."""
    law = state.law[i]
    return bool(RIGID <= law < SPRING or (law == SPRING and state.damping[i] > 0))


def closes_inside(state: State, clock: Any, i: int, j: int, after: float) -> bool:
    """Note where in its period link i closes, `after` part j begins, if that is inside the part."""
    m = j % state.parts[0]
    if after <= PLACED or after >= state.part[m] - PLACED:
        return False
    before: float = 0.0
    for q in range(m):
        before += state.part[q]
    state.closed[0] = before + after
    clock[STEP], clock[LINK] = j, i
    return True


def press(
    state: State, tally: Tally, signals: Signals, clock: Any, k: int, j0: int, j1: int
) -> int:
    """Compliant contact or joint between two rod ends, or between a rod end and a wall.

    A dashpot's force begins with a jump: as in `touch`, the run may be to stop where it does.
    """
    wave, start, Yl, Yr = signals.wave, signals.wave_start, state.mobility[k], state.mobility[k + 1]
    i, n = k + state.first[k], len(state.steps) - 2
    p, q = start[2 * k] - state.steps[k], start[2 * k + 3] - state.steps[k + 1]
    left, right = start[2 * k + 1], start[2 * k + 2]
    wl, wr = state.share[k], state.share[k + 1]
    law, stiffness, exponent = state.law[i], state.stiffness[i], state.exponent[i]
    damping, w = state.damping[i], state.closing[i]
    parts = state.parts[0]
    m = j0 % parts
    for j in range(j0, j1):
        a, b, gap, d = wave[p + j], wave[q + j], state.gap[i], state.part[m]
        if wl > 0:
            a += wl * (wave[p + j - 1] - a)
        if wr > 0:
            b += wr * (wave[q + j - 1] - b)
        F, rest = 0.0, gap - d * (a - b)
        if gap < 0 or rest < 0 or law == JOINT:
            sudden = gap > 0 and law != JOINT and (d > state.layer[0] or abrupt(state, i))
            if clock[CUTS] > 0 and sudden and closes_inside(state, clock, i, j, gap / (a - b)):
                return CLOSED
            F, x, _ = solve_link(
                law, stiffness, exponent, damping, state.strength[i], d, -gap, d * (a - b),
                d * (Yl + Yr), w,
            )
            w, rest = x + gap, indent(state, tally, i, F, x)
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        record_step(state, tally, signals, i, j, F, rest, d)
        m = m + 1 if m + 1 < parts else 0
    state.closing[i] = w
    return DONE


def gather(
    state: State, signals: Signals, points: Points, links: Chain, k: int, j: int, d: float
) -> float:
    """Lay out the chain at node k: what its points would do in part j, of duration d, unforced.

    Returns the largest velocity of two neighbours together.
    """
    m0, m1, n = state.first[k], state.first[k + 1], len(state.steps) - 2
    i0 = k + m0
    for q in range(m1 - m0):
        points.free[q + 1] = state.speed[m0 + q]
        points.mobility[q + 1] = d / (2 * state.mass[m0 + q])
    for q in range(m1 - m0 + 1):
        i = i0 + q
        links.force[q], links.slope[q] = state.force[i], 0.0
        links.place[q] = state.closing[i] - state.gap[i]
        links.limit[q] = state.gap[i] if state.law[i] == RIGID else 0.0
        if state.law[i] == IMPACT:
            links.limit[q], links.before[q] = math.inf, approach(state, signals, k, q, j)
    for line, s, p, q in ((2 * k, k, 0, 0), (2 * k + 3, k + 1, m1 - m0 + 1, m1 - m0)):
        law = state.law[i0 + q]
        value = 0.0
        if law != FREE:
            value = arriving(state, signals, line, s, j)
        outside = s == 0 or s == n + 1
        points.free[p], points.mobility[p] = value, state.mobility[s]
        if outside and law <= FORCE:
            points.free[p], points.mobility[p], links.limit[q] = 0.0, 0.0, value
    speed = 0.0
    for q in range(m1 - m0 + 1):
        u, v = points.free[q], points.free[q + 1]
        links.free[q], links.own[q] = d * (u - v), d * (points.mobility[q] + points.mobility[q + 1])
        links.shared[q] = d * points.mobility[q]
        speed = max(speed, abs(u) + abs(v))
    return speed


def apart(state: State, links: Chain, i0: int, last: int, graze: float) -> bool:
    """Whether nothing presses in this part, as all that could stays apart; if so, lay it out."""
    for q in range(last + 1):
        law, gap = state.law[i0 + q], state.gap[i0 + q]
        if law != FREE and (law < RIGID or law == IMPACT or gap <= 0):
            return False
        if law != FREE and gap - links.free[q] <= graze:
            return False
    for q in range(last + 1):
        links.force[q], links.place[q] = 0.0, links.free[q] - state.gap[i0 + q]
    return True


def approach(state: State, signals: Signals, k: int, q: int, j: int) -> float:
    """Velocity at which the points of an impact approach each other as step j begins."""
    m0, m1, n = state.first[k], state.first[k + 1], len(state.steps) - 2
    left: float = 0.0
    right: float = 0.0
    if q > 0:
        left = state.speed[m0 + q - 1]
    elif k == 0:
        r = signals.wave_start[0] + j
        left = (signals.wave[r - 1] + signals.wave[r]) / 2
    if q < m1 - m0:
        right = state.speed[m0 + q]
    elif k == n:
        r = signals.wave_start[2 * n + 3] + j
        right = (signals.wave[r - 1] + signals.wave[r]) / 2
    return left - right


def settle(
    state: State, tally: Tally, links: Chain, i: int, q: int, F: float, w: float, d: float,
    tol: float,
) -> float:
    """Enter what link i of a chain loses while it closes by w in d; return its gap at the end."""
    law = state.law[i]
    gap: float = state.gap[i]
    state.closing[i] = w
    if law <= BOND:
        return gap
    rest: float = gap - w
    if law == RIGID:
        tally.numerical[i] += F * gap
        return 0.0 if F > 0 or rest <= max(d * tol, EARLY * w) else rest
    if law == IMPACT:
        if F > 0:
            tally.lost[i] += F * links.limit[q]
            return gap - float(links.limit[q])
        return gap if gap <= 0 and abs(w) <= d * tol else rest
    return indent(state, tally, i, F, links.place[q])


def resolve_contact(
    state: State, tally: Tally, signals: Signals, points: Points, links: Chain, clock: Any, k: int,
    j: int, tol: float,
) -> int:
    """Masses and contacts at node k in part j; SQUEEZED where they cannot move."""
    m0, i0, last = state.first[k], k + state.first[k], state.first[k + 1] - state.first[k]
    n, free, mobility, force = len(state.steps) - 2, points.free, points.mobility, links.force
    d: float = state.part[j % state.parts[0]]
    speed = gather(state, signals, points, links, k, j, d)
    struck = not apart(state, links, i0, last, d * tol)
    while struck:
        if not balance(state, links, i0, last, speed, d):
            clock[STEP], clock[LINK] = j, i0
            return SQUEEZED
        struck = start_impacts(state, links, i0, last, tol, d)
    for q in range(last + 1):
        i = i0 + q
        if RIGID <= state.law[i] <= IMPACT and force[q] * (mobility[q] + mobility[q + 1]) <= tol:
            force[q] = 0.0
        sudden = state.law[i] >= RIGID and (d > state.layer[0] or abrupt(state, i))
        if clock[CUTS] > 0 and sudden and force[q] > 0 and state.gap[i] > 0:
            speed = pushed(links, q, last) / d
            if closes_inside(state, clock, i, j, state.gap[i] / speed):
                return CLOSED
    v = free[0] - mobility[0] * force[0]
    for q in range(last + 1):
        i, F = i0 + q, force[q]
        right = free[q + 1] + mobility[q + 1] * F
        if q < last:
            right -= mobility[q + 1] * force[q + 1]
            state.speed[m0 + q] = 2 * right - free[q + 1]
        gap = settle(state, tally, links, i, q, F, d * (v - right), d, tol)
        if state.law[i] <= BOND:
            tally.impulse[i] += F * d
            state.force[i] = F
        else:
            record_step(state, tally, signals, i, j, F, gap, d)
        v = right
    for q in range(last):
        if signals.mass_start[m0 + q] >= 0:
            signals.speed[signals.mass_start[m0 + q] + j] = state.speed[m0 + q]
    if k > 0:
        signals.wave[signals.wave_start[2 * k + 1] + j] = free[0] - 2 * mobility[0] * force[0]
    if k < n:
        out = free[last + 1] + 2 * mobility[last + 1] * force[last]
        signals.wave[signals.wave_start[2 * k + 2] + j] = out
    return DONE


def run(
    state: State, tally: Tally, signals: Signals, points: Points, links: Chain, clock: Any,
    end: int, tol: float,
) -> int:
    """Go on from part clock[STEP] to part `end`.

    What leaves an end comes to the next node no sooner than after the shortest transit, so each
    node is taken that many parts at a time.

    Parameters
    ----------
    state, tally, signals, points, links
    clock : [3] int
        Next part; link of the trouble after SQUEEZED, or of the contact after CLOSED; whether to
        stop where a contact closes inside a part whose force begins with a jump.
    end : int
    tol : float
        Velocity below which contacts graze and impacts rest.

    Returns
    -------
    DONE; SQUEEZED: a rigid mass was caught between walls that leave it no room; or CLOSED: a
    contact whose force begins with a jump closes inside a part, state.closed[0] steps after its
    step began. After the last two the run cannot go on.
    """
    n = len(state.steps) - 2
    block = end
    for s in range(1, n + 1):
        block = min(block, state.steps[s])
    j = clock[STEP]
    while j < end:
        stop = min(j + block, end)
        for k in range(n + 1):
            law, flag = state.law[k + state.first[k]], DONE
            if state.first[k + 1] > state.first[k]:
                for i in range(j, stop):
                    flag = resolve_contact(state, tally, signals, points, links, clock, k, i, tol)
                    if flag != DONE:
                        break
            elif law == FREE:
                reflect(state, signals, k, j, stop)
            elif law <= BOND:
                join(state, tally, signals, k, j, stop)
            elif law == RIGID:
                flag = touch(state, tally, signals, clock, k, j, stop, tol)
            else:
                flag = press(state, tally, signals, clock, k, j, stop)
            if flag != DONE:
                return flag
        j = clock[STEP] = stop
    return DONE


def beyond(state: State, k: int, q: int, right: bool) -> tuple[int, int, int]:
    """What stands on one side of link q of node k, and the next link on that side.

    Returns
    -------
    element, k, q : int
        s for segment s, -m for mass m - 1, NEVER for what lies outside.
    """
    m0, last = state.first[k], state.first[k + 1] - state.first[k]
    if right:
        if q < last:
            return -(m0 + q + 1), k, q + 1
        if k == len(state.steps) - 2:
            return NEVER, k, q
        return k + 1, k + 1, 0
    if q > 0:
        return -(m0 + q), k, q - 1
    if k == 0:
        return NEVER, k, q
    return k, k - 1, state.first[k] - state.first[k - 1]


def inside(state: State, s: int) -> int:
    """How many averages of a line are on their way through segment s."""
    count: int = state.steps[s]
    return count + 1 if state.share[s] > 0 else count


def stay(state: State, s: int, i: int, j: int) -> float:
    """How long, of what left in part i, is still on its way through segment s before part j."""
    if i < j - state.steps[s]:
        return float(state.share[s])
    return float(state.part[(i + 2 * state.steps[s]) % state.parts[0]])


def group_motion(
    state: State, signals: Signals, k: int, q: int, right: bool, j: int, tol: float
) -> Group:
    """Motion of all that hangs together on one side of contact q of node k, before part j."""
    mass = momentum = mean = 0.0
    ground, parts, low, high = 0, 0, math.inf, -math.inf
    while True:
        element, k, q = beyond(state, k, q, right)
        parts += 1
        if element == NEVER:
            outside = 2 * len(state.steps) - 1 if right else 0
            ground = 2 if state.mobility[outside // 2] > 0 else 1
            mean = signals.wave[signals.wave_start[outside] + j - 1]
            low, high = min(low, mean), max(high, mean)
            break
        if element < 0:
            v = state.speed[-element - 1]
            mass += state.mass[-element - 1]
            momentum += state.mass[-element - 1] * v
            low, high = min(low, v), max(high, v)
        else:
            Z = 1 / state.mobility[element]
            mass += state.transit[element] * Z
            for l in (2 * element, 2 * element + 1):
                for p in range(j - inside(state, element), j):
                    v, d = signals.wave[signals.wave_start[l] + p], stay(state, element, p, j)
                    momentum += Z * v * d / 2
                    low, high = min(low, v), max(high, v)
        i = k + state.first[k] + q
        if not BOND <= state.law[i] <= JOINT:
            mean = momentum / mass
            break
        if state.law[i] == JOINT and state.gap[i] != 0:
            low, high = -math.inf, math.inf
    uniform = parts == 1 or (parts == 2 and ground == 2)
    if not uniform and high - low > tol:  # waves grow where impedance changes
        low, high = -math.inf, math.inf
    return Group(mass, momentum, mean, low, high, ground)


def deviation_bound(
    state: State, signals: Signals, k: int, q: int, right: bool, j: int, group: Group, tol: float
) -> tuple[float, float]:
    """How far a group's end at a contact is from its mean motion, and can ever get.

    A wall at the far end has all the mass. A far endless bar of impedance Z gives way by the
    momentum it has taken, over Z, so that momentum, of which there is at most sqrt(2 m E), counts
    as well. So does a joint that is a dashpot alone, by the change of momentum over c.

    Returns
    -------
    d, bound : length
        Deviation now, positive to the right, and its bound.
    """
    mass, mean, ground = group.mass, group.mean, group.ground
    energy = slack = d = loose = 0.0
    g, Y = 1.0, 0.0
    while True:
        element, k, q = beyond(state, k, q, right)
        if element == NEVER:
            Y = state.mobility[len(state.steps) - 1 if right else 0]
            break
        if element < 0:
            v = state.speed[-element - 1] - mean
            energy += state.mass[-element - 1] * v * v / 2
            if ground == 0:
                g -= state.mass[-element - 1] / mass
        else:
            T, y = state.transit[element], state.mobility[element]
            g0 = g
            if ground == 0:
                g -= T / (y * mass)
            slack += y * T * (g0 * g0 + g0 * g + g * g) / 3
            for l in (2 * element, 2 * element + 1):
                sign = 1 if l % 2 == 1 else -1
                passed = 0.0
                for i in range(j - 1, j - 1 - inside(state, element), -1):
                    v = signals.wave[signals.wave_start[l] + i] - mean
                    lasts = stay(state, element, i, j)
                    place = (passed + lasts / 2) / T
                    if (l % 2 == 1) == right:  # runs towards the contact
                        place = 1 - place
                    passed += lasts
                    energy += lasts * v * v / (4 * y)
                    d += lasts * sign * v * (g0 + (g - g0) * place) / 2
        link = k + state.first[k] + q
        if not BOND <= state.law[link] <= JOINT:
            break
        if state.law[link] == JOINT and state.stiffness[link] > 0:
            stretch, stiff = state.gap[link], state.stiffness[link]
            energy += stiff * stretch * stretch / 2
            slack += g * g / stiff
            d += g * stretch
        elif state.law[link] == JOINT:
            loose += 2 * g / state.damping[link]
    if right:
        d = -d
    if ground == 2:
        d -= (group.momentum - mass * mean) * Y
        slack = 2 * (slack + mass * Y * Y)
    if loose > 0:
        slack = 2 * (slack + mass * loose * loose)
    if group.high - group.low <= tol:
        return d, 0.0
    return d, bound_of(energy, slack)


def finality_time(state: State, signals: Signals, j: int, tol: float) -> int:
    """Steps until it may be proved that nothing meets again: 0 if it is, NEVER if not as it is.

    For rows whose walls move steadily and whose ends are not driven: no bound holds for a body
    that falls on a floor, or that is pushed.
    """
    wait = 0
    for k in range(len(state.first) - 1):
        for q in range(state.first[k + 1] - state.first[k] + 1):
            if state.law[k + state.first[k] + q] >= RIGID and wait < NEVER:
                wait = max(wait, contact_time(state, signals, k, q, j, tol))
    return wait


def contact_time(state: State, signals: Signals, k: int, q: int, j: int, tol: float) -> int:
    """The same of contact q of node k; deviations are summed up only where they decide."""
    gap = state.gap[k + state.first[k] + q]
    if gap < 0:
        return NEVER
    left = group_motion(state, signals, k, q, False, j, tol)
    right = group_motion(state, signals, k, q, True, j, tol)
    answer = by_velocities(gap, left, right, tol)
    if answer != UNDECIDED:
        return answer
    dl, bl = deviation_bound(state, signals, k, q, False, j, left, tol)
    dr, br = deviation_bound(state, signals, k, q, True, j, right, tol)
    return separation_time(
        gap, Side(left.mean, left.low, left.high, dl, bl),
        Side(right.mean, right.low, right.high, dr, br), tol,
    )


def choose_step(
    transits: Any, least: int, most: int, enough: float, power: float
) -> tuple[int, float]:
    """Choose into how many steps the longest transit is divided.

    A transit that is no whole number of steps, but w more, smears a jump by w (1 - w) of a step.
    Of the numbers from `least` to `most`, the first for which no transit smears by more than
    `enough`; without one, that with the least smear, divided by number^power.

    Returns
    -------
    number : int
    smear : float
        Largest w (1 - w) of a transit.
    """
    longest = 0.0
    for T in transits:
        longest = max(longest, T)
    best, smear, least_cost = least, math.inf, math.inf
    for number in range(least, most + 1):
        scale = number**power
        worst = 0.0
        for T in transits:
            steps = T / longest * number
            w = steps - math.floor(steps)
            worst = max(worst, w * (1 - w))
            if worst >= least_cost * scale:
                break
        if worst < least_cost * scale:
            best, smear, least_cost = number, worst, worst / scale
            if worst <= enough:
                break
    return best, smear
