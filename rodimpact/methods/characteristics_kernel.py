"""End signals on a common time step: rods as delay lines, everything else at their ends.

In a uniform segment the velocity is v = (a + b)/2 with a travelling right and b travelling left,
and a transit time is a whole number of steps. Signals are averages over steps, so a delay is
exact. Node k joins the segments k and k + 1; line 2s carries a and line 2s + 1 carries b through
segment s. The segments 0 and n + 1 stand for what lies outside: lines 0 and 2n + 3 bring what comes
from there, filled in advance: the velocity of a wall or a drive (mobility 0), the constant wave
of an endless bar (absorbing end), or under the law FORCE the force itself.

At a node stands a chain of points: the left rod end, masses, the right rod end; and of links, one
between neighbours. A force F > 0 in a link pushes its two points apart. Over one step every point
obeys v = v_free +- y F: a rod end with the arriving average and its mobility y = 1/Z, a mass M with
its velocity V at the step's start and y = 1/(2M) (midpoint rule, V_end = 2v - V). Hence a link
closes by w = c - A F with A a tridiagonal Stieltjes matrix, and its law gives F from w. The
links of one node are solved together; different nodes meet only one transit later.

Laws: a compliant contact has the indentation x, and over a step the force (U(x1) - U(x0))/(x1 - x0)
of its stored energy U (discrete gradient: Gonzalez, J. Nonlinear Sci. 6, 1996), the dashpot's mean
over the same path, and never pulls; this is convex and increasing in x1, so Newton's method falls
on the root from the right. A rigid contact takes the force that leaves gap >= 0 at the step's end.
An impact of rigid bodies takes the force that leaves a closing velocity of at most -e times the one
before (Moreau, CISM 302, 1988).

Kernels: time is counted in steps, so lengths are velocity times steps, masses and stiffnesses
are scaled to match: M/h, k h (spring), k h^(3/2) (Hertz), a dashpot's constant as it is.
They run on lists and on NumPy arrays, bit for bit alike.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

FREE, FORCE, BOND, RIGID, IMPACT, SPRING, HERTZ, HUNT = range(8)  # laws of links
DONE, SQUEEZED = range(2)  # why a run stopped
STEP, NODE = range(2)  # places in the clock
EPS = 1 / (1 << 52)
SNAP = 1 / (1 << 24)  # of one step's motion, by which a gap may close early
ENOUGH = 1 / (1 << 27)  # relative Newton step after which the next one is round-off
NEWTON = 100  # iterations of one contact: a bound that is not met in practice
SWEEPS = 1000  # of one chain, see `balance`
NEVER = 1 << 62


class Row(NamedTuple):
    """A row of n segments and m masses: lists or arrays; the last five change in place."""

    steps: Any  # [segment] transit time, 0 outside
    mobility: Any  # [segment] 1/Z; 0 for a wall, that of the rod for an absorbing end
    first: Any  # [node + 1] first mass at the node; links of node k begin at k + first[k]
    mass: Any  # [mass]
    law: Any  # [link]
    stiffness: Any  # [link] of SPRING, HERTZ, HUNT
    damping: Any  # [link] of SPRING and HUNT: F = k x^(3/2) (1 + damping w); of IMPACT e
    gap: Any  # [link] minus the indentation
    force: Any  # [link] of the last step
    closing: Any  # [link] w of the last step
    open: Any  # [link] 1 if the gap has opened since the contact last pressed
    speed: Any  # [mass] velocity


class Signals(NamedTuple):
    """Step averages of waves and forces, and gaps and velocities at step ends, one after the other.

    Entry j of a signal stands at its start + j. Lines have as many entries before as their segment
    has steps: the initial state. The outside lines 0 and 2n + 3 have one; start -1 is not kept.
    """

    wave: Any
    wave_start: Any  # [line]
    force: Any
    gap: Any
    link_start: Any  # [link]
    speed: Any
    mass_start: Any  # [mass]


class Tally(NamedTuple):
    """What has passed through each link, kept as the run goes."""

    impulse: Any  # [link] sum of F
    lost: Any  # [link] turned to heat by dashpots and impacts
    numerical: Any  # [link] lost by rigid contacts that close within a step
    peak: Any  # [link] largest F
    first: Any  # [link] first step under force, -1 before
    last: Any  # [link] end of the last step under force, -1 before
    pressed: Any  # [link] steps under force
    episodes: Any  # [link] number of times an open contact began to press


class Work(NamedTuple):
    """Room for the chain of one node; lists or arrays of floats, two longer than the masses."""

    free: Any  # [point] velocity without forces
    ease: Any  # [point] mobility
    force: Any  # [link]
    kept: Any  # [link] forces before a Newton step
    limit: Any  # [link] w of a pressing rigid contact or impact; a given force
    place: Any  # [link] indentation at the step's end
    slope: Any  # [link] dF/dw, -1 where w is fixed
    upper: Any  # [link] for the elimination


class Group(NamedTuple):
    """What is bonded together on one side of a contact."""

    mass: float
    momentum: float
    mean: float  # velocity of the centre of mass; of the wall or the endless bar, if there is one
    low: float  # least wave or velocity of a mass
    high: float
    ground: int  # 1 if bonded to a wall, 2 to an endless bar, else 0
    plain: bool  # low and high bound the velocity of the end at the contact as long as it is free


def stored(law: int, k: float, gap: float) -> float:
    """Energy stored in a compliant contact."""
    if gap >= 0 or law < SPRING:
        return 0.0
    if law == SPRING:
        return k * gap * gap / 2
    return 2 * k * gap * gap * math.sqrt(-gap) / 5


def mean_force(law: int, k: float, d: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean force of a compliant contact while its indentation goes from x0 to x1, and dF/dx1.

    SPRING: k p + d dp/dt with p = max(x, 0); HERTZ: k p^(3/2); HUNT: the same times (1 + d dx/dt);
    averaged along the straight path, cut at 0.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    if law == SPRING:
        if x1 <= 0:
            share = x0 / (x0 - x1)
            F, dF = k * x0 * share / 2 - d * x0, k * share * share / 2
        elif x0 < 0:
            share = x1 / (x1 - x0)
            F, dF = k * x1 * share / 2 + d * x1, k * share * (2 - share) / 2 + d
        else:
            F, dF = k * (x0 + x1) / 2 + d * (x1 - x0), k / 2 + d
    else:
        if x1 <= 0:
            F = 2 * k * x0 * x0 * math.sqrt(x0) / (5 * (x0 - x1))
            dF = F / (x0 - x1)
        elif x0 < 0:
            s, share = math.sqrt(x1), x1 / (x1 - x0)
            F, dF = 2 * k * x1 * s * share / 5, k * s * share * (5 - 2 * share) / 5
        else:
            p, s = math.sqrt(x0), math.sqrt(x1)
            pp, ps, ss, sum_ = p * p, p * s, s * s, p + s
            F = 2 * k * (ss * (ss + ps + pp) + ps * pp + pp * pp) / (5 * sum_)
            dF = k * (3 * ss * s + 6 * ss * p + 4 * s * pp + 2 * pp * p) / (5 * sum_ * sum_)
        if law == HUNT:
            stretch = 1 + d * (x1 - x0)
            F, dF = F * stretch, dF * stretch + F * d
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def squeeze(
    law: int, k: float, d: float, x0: float, c: float, y: float, w: float
) -> tuple[float, float, float]:
    """Solve x1 = x0 + c - y F(x0, x1) for a compliant contact.

    Parameters
    ----------
    x0 : indentation at the step's start
    c : velocity at which the contact would close without force
    y : mobility of both sides together
    w : guess of the velocity at which it closes

    Returns
    -------
    F, x1, dF/dx1
    """
    top = x0 + c
    x = min(x0 + w, top)
    F = slope = 0.0
    for _ in range(NEWTON):
        F, slope = mean_force(law, k, d, x0, x)
        r = x - x0 - c + y * F
        step = r / (1 + y * slope)
        F, x = F - slope * step, min(x - step, top)
        size = x if x > 0 else x0 - x
        if abs(step) <= max(ENOUGH * size, 4 * EPS * (abs(x0) + abs(c))):
            break
    return max(F, 0 * F), x, slope


def book(
    row: Row, tally: Tally, signals: Signals, i: int, j: int, F: float, gap: float
) -> None:
    """Enter step j of contact i: force, and gap at the end."""
    start = signals.link_start[i]
    if start >= 0:
        signals.force[start + j] = F
        signals.gap[start + j] = gap
    row.force[i], row.gap[i] = F, gap
    if F > 0:
        tally.impulse[i] += F
        tally.peak[i] = max(tally.peak[i], F)
        if tally.first[i] < 0:
            tally.first[i] = j
        tally.last[i] = j + 1
        tally.pressed[i] += 1
        tally.episodes[i] += row.open[i]
        row.open[i] = 0
    elif gap > 0:
        row.open[i] = 1


def reflect(row: Row, signals: Signals, k: int, j0: int, j1: int) -> None:
    """Free end at either end of the row."""
    wave, start = signals.wave, signals.wave_start
    come, go = (3, 2) if k == 0 else (2 * k, 2 * k + 1)
    p, q = start[come] - row.steps[come // 2], start[go]
    for j in range(j0, j1):
        wave[q + j] = wave[p + j]


def join(row: Row, tally: Tally, signals: Signals, k: int, j0: int, j1: int) -> None:
    """Two rod ends that share velocity and force; or an end under a given force."""
    wave, start, Yl, Yr = signals.wave, signals.wave_start, row.mobility[k], row.mobility[k + 1]
    i, n = k + row.first[k], len(row.steps) - 2
    p, q = start[2 * k] - row.steps[k], start[2 * k + 3] - row.steps[k + 1]
    left, right = start[2 * k + 1], start[2 * k + 2]
    given = row.law[i] == FORCE
    impulse, F = tally.impulse[i], row.force[i]
    for j in range(j0, j1):
        a, b = wave[p + j], wave[q + j]
        if not given:
            F = (a - b) / (Yl + Yr)
        else:
            F = a if k == 0 else b
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        if k == 0 or k == n:
            impulse += F
    tally.impulse[i], row.force[i] = impulse, F


def touch(
    row: Row, tally: Tally, signals: Signals, k: int, j0: int, j1: int, tol: float
) -> None:
    """Rigid contact between two rod ends, or between a rod end and a wall.

    With r = a - b - gap, F = max(0, r/(Y1 + Y2)) leaves no gap behind. |r| <= tol is grazing:
    closed, without force. What closes only in part of a step loses F gap.
    """
    wave, start, Yl, Yr = signals.wave, signals.wave_start, row.mobility[k], row.mobility[k + 1]
    i, n = k + row.first[k], len(row.steps) - 2
    p, q = start[2 * k] - row.steps[k], start[2 * k + 3] - row.steps[k + 1]
    left, right, kept = start[2 * k + 1], start[2 * k + 2], signals.link_start[i]
    Z, gap, F = 1 / (Yl + Yr), row.gap[i], row.force[i]
    impulse, peak = tally.impulse[i], tally.peak[i]
    last, pressed = tally.last[i], tally.pressed[i]
    for j in range(j0, j1):
        a, b = wave[p + j], wave[q + j]
        rest = gap - a + b
        window = max(tol, SNAP * (a - b))
        if rest < -window:
            F = -rest * Z
            if gap > 0:
                tally.numerical[i] += F * gap
                gap = 0.0
            if tally.first[i] < 0:
                tally.first[i] = j
            if row.open[i] > 0:
                tally.episodes[i] += 1
                row.open[i] = 0
            impulse += F
            peak = max(peak, F)
            pressed += 1
            last = j + 1
        else:
            F = gap = 0.0
            if rest > window:
                gap = rest
                row.open[i] = 1
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        signals.force[kept + j] = F
        signals.gap[kept + j] = gap
    row.gap[i], row.force[i] = gap, F
    tally.impulse[i], tally.peak[i] = impulse, peak
    tally.last[i], tally.pressed[i] = last, pressed


def press(row: Row, tally: Tally, signals: Signals, k: int, j0: int, j1: int) -> None:
    """Compliant contact between two rod ends, or between a rod end and a wall."""
    wave, start, Yl, Yr = signals.wave, signals.wave_start, row.mobility[k], row.mobility[k + 1]
    i, n = k + row.first[k], len(row.steps) - 2
    p, q = start[2 * k] - row.steps[k], start[2 * k + 3] - row.steps[k + 1]
    left, right = start[2 * k + 1], start[2 * k + 2]
    law, stiffness, damping, w = row.law[i], row.stiffness[i], row.damping[i], row.closing[i]
    for j in range(j0, j1):
        a, b, gap = wave[p + j], wave[q + j], row.gap[i]
        F, rest = 0.0, gap - a + b
        if gap < 0 or rest < 0:
            F, x, _ = squeeze(law, stiffness, damping, -gap, a - b, Yl + Yr, w)
            w, rest = x + gap, -x
            if damping > 0:
                drop = stored(law, stiffness, gap) - stored(law, stiffness, rest)
                tally.lost[i] += F * w + drop
        if k > 0:
            wave[left + j] = a - 2 * F * Yl
        if k < n:
            wave[right + j] = b + 2 * F * Yr
        book(row, tally, signals, i, j, F, rest)
    row.closing[i] = w


def gather(row: Row, signals: Signals, work: Work, k: int, j: int) -> None:
    """Lay out the chain at node k: what its points would do in step j without forces."""
    m0, m1, i0, n = row.first[k], row.first[k + 1], k + row.first[k], len(row.steps) - 2
    for q in range(m1 - m0):
        work.free[q + 1], work.ease[q + 1] = row.speed[m0 + q], 1 / (2 * row.mass[m0 + q])
    for q in range(m1 - m0 + 1):
        i = i0 + q
        work.force[q], work.slope[q] = row.force[i], 0.0
        work.place[q] = row.closing[i] - row.gap[i]
        work.limit[q] = row.gap[i] if row.law[i] == RIGID else 0.0
        if row.law[i] == IMPACT:
            work.limit[q] = math.inf
    for line, s, p, q in ((2 * k, k, 0, 0), (2 * k + 3, k + 1, m1 - m0 + 1, m1 - m0)):
        law = row.law[i0 + q]
        value = 0.0
        if law != FREE:
            value = signals.wave[signals.wave_start[line] + j - row.steps[s]]
        outside = s == 0 or s == n + 1
        work.free[p], work.ease[p] = value, row.mobility[s]
        if outside and law <= FORCE:
            work.free[p], work.ease[p], work.limit[q] = 0.0, 0.0, value


def relax(row: Row, work: Work, i0: int, last: int) -> float:
    """Solve link after link, the others as they are; return the largest change, as a velocity."""
    change = 0.0
    for q in range(last + 1):
        i, y, z = i0 + q, work.ease[q], work.ease[q + 1]
        c = work.free[q] - work.free[q + 1]
        if q > 0:
            c += y * work.force[q - 1]
        if q < last:
            c += z * work.force[q + 1]
        law, slope = row.law[i], 0.0
        if law <= FORCE:
            F = work.limit[q]
        elif law <= IMPACT:
            F = (c - work.limit[q]) / (y + z)
            slope = -1.0
            if law != BOND and F <= 0:
                F = slope = 0.0
        else:
            gap = row.gap[i]
            guess = work.place[q] + gap
            F, work.place[q], slope = squeeze(
                law, row.stiffness[i], row.damping[i], -gap, c, y + z, guess
            )
        change = max(change, abs(F - work.force[q]) * (y + z))
        work.force[q], work.slope[q] = F, slope
    return change


def newton(row: Row, work: Work, i0: int, last: int) -> None:
    """Take a Newton step for all links together, each law replaced by its tangent."""
    F, upper, c = work.force, work.upper, 0.0
    for q in range(last + 1):
        y, z, s = work.ease[q], work.ease[q + 1], work.slope[q]
        c = work.free[q] - work.free[q + 1]
        if s < 0:
            s, middle, right = -s, y + z, c - work.limit[q]
        else:
            middle = 1 + s * (y + z)
            right = F[q] + s * (c - work.place[q] - row.gap[i0 + q])
        pivot = middle
        if q > 0:
            right += s * y * F[q - 1]
            pivot += s * y * upper[q - 1]
        if pivot <= 4 * EPS * middle:
            pivot = middle
        F[q], upper[q] = right / pivot, -s * z / pivot
    for q in range(last, -1, -1):
        if q < last:
            F[q] -= upper[q] * F[q + 1]
        if row.law[i0 + q] >= RIGID:
            F[q] = max(F[q], 0.0)


def balance(row: Row, work: Work, i0: int, last: int) -> bool:
    """Find the forces of a chain; return False where there are none (a mass squeezed by walls).

    Sweeps of `relax` descend on a convex function, the dual energy of the step, and so always
    converge, if slowly; a Newton step is kept where it halves what the next sweep has to change.
    """
    left = relax(row, work, i0, last)
    for _ in range(SWEEPS):
        size = 0.0
        for q in range(last + 1):
            y, z = work.ease[q], work.ease[q + 1]
            pushed = abs(work.force[q]) * (y + z)
            size = max(size, abs(work.free[q]) + abs(work.free[q + 1]) + pushed)
        if left <= 8 * EPS * size:
            return True
        for q in range(last + 1):
            work.kept[q] = work.force[q]
        newton(row, work, i0, last)
        new = relax(row, work, i0, last)
        if new > left / 2:
            for q in range(last + 1):
                work.force[q] = work.kept[q]
            new = relax(row, work, i0, last)
        left = new
    return bool(left <= SNAP * size)


def approach(row: Row, signals: Signals, k: int, q: int, j: int) -> float:
    """Velocity at which the points of an impact approach each other as step j begins."""
    m0, m1, n = row.first[k], row.first[k + 1], len(row.steps) - 2
    left: float = 0.0
    right: float = 0.0
    if q > 0:
        left = row.speed[m0 + q - 1]
    elif k == 0:
        r = signals.wave_start[0] + j
        left = (signals.wave[r - 1] + signals.wave[r]) / 2
    if q < m1 - m0:
        right = row.speed[m0 + q]
    elif k == n:
        r = signals.wave_start[2 * n + 3] + j
        right = (signals.wave[r - 1] + signals.wave[r]) / 2
    return left - right


def strike(row: Row, signals: Signals, work: Work, k: int, j: int, tol: float) -> bool:
    """Let impacts happen whose gaps would close in step j; return whether there is a new one."""
    m0, i0, last = row.first[k], k + row.first[k], row.first[k + 1] - row.first[k]
    found = False
    for q in range(last + 1):
        if row.law[i0 + q] == IMPACT and work.limit[q] == math.inf:
            w = work.free[q] - work.free[q + 1] - work.force[q] * (work.ease[q] + work.ease[q + 1])
            if q > 0:
                w += work.ease[q] * work.force[q - 1]
            if q < last:
                w += work.ease[q + 1] * work.force[q + 1]
            if row.gap[m0 + k + q] - w < -tol:
                u = approach(row, signals, k, q, j)
                work.limit[q] = 0.0 if u <= tol else (1 - row.damping[i0 + q]) * u / 2
                found = True
    return found


def settle(
    row: Row, tally: Tally, work: Work, i: int, q: int, F: float, w: float, tol: float
) -> float:
    """Enter what link i of a chain loses while it closes by w; return its gap at the end."""
    law = row.law[i]
    gap: float = row.gap[i]
    row.closing[i] = w
    if law <= BOND:
        return gap
    if law == RIGID:
        tally.numerical[i] += F * gap
        rest = gap - w
        return 0.0 if F > 0 or rest <= max(tol, SNAP * w) else rest
    if law == IMPACT:
        if F > 0:
            tally.lost[i] += F * work.limit[q]
            return gap - float(work.limit[q])
        return gap if gap <= 0 and abs(w) <= tol else gap - w
    rest = -float(work.place[q])
    if row.damping[i] > 0:
        drop = stored(law, row.stiffness[i], gap) - stored(law, row.stiffness[i], rest)
        tally.lost[i] += F * (gap - rest) + drop
    return rest


def chain(
    row: Row, tally: Tally, signals: Signals, work: Work, k: int, j: int, tol: float
) -> bool:
    """Masses and contacts at node k in step j; return False where they cannot move."""
    m0, i0, last = row.first[k], k + row.first[k], row.first[k + 1] - row.first[k]
    n, free, ease, force = len(row.steps) - 2, work.free, work.ease, work.force
    gather(row, signals, work, k, j)
    if not balance(row, work, i0, last):
        return False
    while strike(row, signals, work, k, j, tol):
        if not balance(row, work, i0, last):
            return False
    for q in range(last + 1):
        if RIGID <= row.law[i0 + q] <= IMPACT and force[q] * (ease[q] + ease[q + 1]) <= tol:
            force[q] = 0.0
    v = free[0] - ease[0] * force[0]
    for q in range(last + 1):
        i, F = i0 + q, force[q]
        right = free[q + 1] + ease[q + 1] * F
        if q < last:
            right -= ease[q + 1] * force[q + 1]
            row.speed[m0 + q] = 2 * right - free[q + 1]
        gap = settle(row, tally, work, i, q, F, v - right, tol)
        if row.law[i] <= BOND:
            tally.impulse[i] += F
            row.force[i] = F
        else:
            book(row, tally, signals, i, j, F, gap)
        v = right
    for q in range(last):
        if signals.mass_start[m0 + q] >= 0:
            signals.speed[signals.mass_start[m0 + q] + j] = row.speed[m0 + q]
    if k > 0:
        signals.wave[signals.wave_start[2 * k + 1] + j] = free[0] - 2 * ease[0] * force[0]
    if k < n:
        out = free[last + 1] + 2 * ease[last + 1] * force[last]
        signals.wave[signals.wave_start[2 * k + 2] + j] = out
    return True


def run(
    row: Row, tally: Tally, signals: Signals, work: Work, clock: Any, end: int, tol: float
) -> int:
    """Go on from step clock[STEP] to step `end`.

    What leaves an end comes to the next node no sooner than after the shortest transit, so each
    node is taken that many steps at a time.

    Parameters
    ----------
    row, tally, signals, work
    clock : [2] int
        Next step; node of the trouble after SQUEEZED.
    end : int
    tol : float
        Velocity below which contacts graze and impacts rest.

    Returns
    -------
    DONE, or SQUEEZED: a rigid mass was caught between walls that leave it no room.
    """
    n = len(row.steps) - 2
    block = end
    for s in range(1, n + 1):
        block = min(block, row.steps[s])
    j = clock[STEP]
    while j < end:
        stop = min(j + block, end)
        for k in range(n + 1):
            law = row.law[k + row.first[k]]
            if row.first[k + 1] > row.first[k]:
                for i in range(j, stop):
                    if not chain(row, tally, signals, work, k, i, tol):
                        clock[STEP], clock[NODE] = i, k
                        return SQUEEZED
            elif law == FREE:
                reflect(row, signals, k, j, stop)
            elif law <= BOND:
                join(row, tally, signals, k, j, stop)
            elif law == RIGID:
                touch(row, tally, signals, k, j, stop, tol)
            else:
                press(row, tally, signals, k, j, stop)
        j = clock[STEP] = stop
    return DONE


def beyond(row: Row, k: int, q: int, right: bool) -> tuple[int, int, int]:
    """What stands on one side of link q of node k, and the next link on that side.

    Returns
    -------
    element, k, q : int
        s for segment s, -m for mass m - 1, NEVER for what lies outside.
    """
    m0, last = row.first[k], row.first[k + 1] - row.first[k]
    if right:
        if q < last:
            return -(m0 + q + 1), k, q + 1
        if k == len(row.steps) - 2:
            return NEVER, k, q
        return k + 1, k + 1, 0
    if q > 0:
        return -(m0 + q), k, q - 1
    if k == 0:
        return NEVER, k, q
    return k, k - 1, row.first[k] - row.first[k - 1]


def motion(
    row: Row, signals: Signals, k: int, q: int, right: bool, j: int, tol: float
) -> Group:
    """Motion of everything bonded together on one side of contact q of node k, before step j."""
    mass = momentum = mean = 0.0
    ground, parts, low, high = 0, 0, math.inf, -math.inf
    while True:
        element, k, q = beyond(row, k, q, right)
        parts += 1
        if element == NEVER:
            outside = 2 * len(row.steps) - 1 if right else 0
            ground = 2 if row.mobility[outside // 2] > 0 else 1
            mean = signals.wave[signals.wave_start[outside] + j - 1]
            low, high = min(low, mean), max(high, mean)
            break
        if element < 0:
            v = row.speed[-element - 1]
            mass += row.mass[-element - 1]
            momentum += row.mass[-element - 1] * v
            low, high = min(low, v), max(high, v)
        else:
            N, Z = row.steps[element], 1 / row.mobility[element]
            mass += N * Z
            for l in (2 * element, 2 * element + 1):
                start = signals.wave_start[l] + j - N
                for i in range(start, start + N):
                    v = signals.wave[i]
                    momentum += Z * v / 2
                    low, high = min(low, v), max(high, v)
        if row.law[k + row.first[k] + q] != BOND:
            mean = momentum / mass
            break
    plain = parts == 1 or (parts == 2 and ground == 2) or high - low <= tol
    return Group(mass, momentum, mean, low, high, ground, plain)


def sway(
    row: Row, signals: Signals, k: int, q: int, right: bool, j: int, group: Group, tol: float
) -> tuple[float, float]:
    """How far a group's end at a contact is from its mean motion, and can ever get.

    The end of a free group deviates from the motion of the centre of mass by
    d = integral(strain * g dx), g the mass fraction beyond x as seen from that end, hence by at
    most sqrt(2 E integral(g^2 dx/(E A))), E the energy of vibration. A wall at the far end has all
    the mass. A far endless bar of impedance Z gives way by the momentum it has taken, over Z, so
    that momentum, of which there is at most sqrt(2 m E), counts as well.

    Returns
    -------
    d : length
        Deviation now, positive to the right.
    bound2 : length squared
        The bound's square.
    """
    mass, mean, ground = group.mass, group.mean, group.ground
    energy = slack = d = 0.0
    g, Y = 1.0, 0.0
    while True:
        element, k, q = beyond(row, k, q, right)
        if element == NEVER:
            Y = row.mobility[len(row.steps) - 1 if right else 0]
            break
        if element < 0:
            v = row.speed[-element - 1] - mean
            energy += row.mass[-element - 1] * v * v / 2
            if ground == 0:
                g -= row.mass[-element - 1] / mass
        else:
            N, y = row.steps[element], row.mobility[element]
            g0 = g
            if ground == 0:
                g -= N / (y * mass)
            slack += y * N * (g0 * g0 + g0 * g + g * g) / 3
            for l in (2 * element, 2 * element + 1):
                sign = 1 if l % 2 == 1 else -1
                start = signals.wave_start[l] + j - N
                for i in range(N):
                    v = signals.wave[start + i] - mean
                    place = (2 * i + 1) / (2 * N)
                    if (l % 2 == 1) != right:  # runs away from the contact
                        place = 1 - place
                    energy += v * v / (4 * y)
                    d += sign * v * (g0 + (g - g0) * place) / 2
        if row.law[k + row.first[k] + q] != BOND:
            break
    if right:
        d = -d
    if ground == 2:
        d -= (group.momentum - mass * mean) * Y
        slack = 2 * (slack + mass * Y * Y)
    if group.high - group.low <= tol:
        return d, 0.0
    return d, 2 * energy * slack


def parting(row: Row, signals: Signals, k: int, q: int, j: int, tol: float) -> int:
    """Steps until contact q of node k may be proved not to close again: 0 if it is, or NEVER."""
    i = k + row.first[k] + q
    if row.gap[i] < 0:
        return NEVER
    left = motion(row, signals, k, q, False, j, tol)
    right = motion(row, signals, k, q, True, j, tol)
    if left.plain and right.plain and right.low - left.high >= -tol:
        return 0
    opening = right.mean - left.mean
    if opening < -tol:
        return NEVER
    dl, bl = sway(row, signals, k, q, False, j, left, tol)
    dr, br = sway(row, signals, k, q, True, j, right, tol)
    gap = row.gap[i] - dr + dl
    if gap > 0 and gap * gap > 2 * (bl + br):
        return 0
    if opening <= tol:
        return NEVER
    wait = (math.sqrt(2 * (bl + br)) - gap) / opening
    return NEVER if wait > NEVER // 2 else int(wait) + 1


def settled(row: Row, signals: Signals, j: int, tol: float) -> int:
    """Steps until it may be proved that nothing meets again: 0 if it is, NEVER if not as it is.

    For rows whose walls move steadily and whose ends are not driven: no bound holds for a body
    that falls on a floor, or that is pushed.
    """
    wait = 0
    for k in range(len(row.first) - 1):
        for q in range(row.first[k + 1] - row.first[k] + 1):
            if row.law[k + row.first[k] + q] >= RIGID and wait < NEVER:
                wait = max(wait, parting(row, signals, k, q, j, tol))
    return wait


def choose_step(transits: Any, least: int, most: int, enough: float) -> tuple[int, float]:
    """Choose into how many steps the longest transit is divided.

    Of the numbers from `least` to `most`, the first for which no transit changes by more than
    `enough` of itself when it becomes a whole number of steps; without one, that with the smallest
    change (simultaneous rational approximation; with n incommensurate transits the change falls
    like most^-(1 + 1/(n - 1))).

    Returns
    -------
    number : int
    error : float
        Largest relative change of a transit.
    """
    longest = 0.0
    for T in transits:
        longest = max(longest, T)
    best, error = least, math.inf
    for number in range(least, most + 1):
        worst = 0.0
        for T in transits:
            ratio = T / longest * number
            off = abs(max(1, int(ratio + 0.5)) / ratio - 1)
            worst = max(worst, off)
            if worst >= error:
                break
        if worst < error:
            best, error = number, worst
            if error <= enough:
                break
    return best, error
