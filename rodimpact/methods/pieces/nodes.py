"""One piece of a node: the chain of links and masses between two rods, driven by two waves.

States in the order of the chain: overlap of a link, velocity of the mass behind it, overlap of the
next link, and so on:
d' = closing - Y F,  m v' = F before - F behind,  closing = velocity on the left - on the right,
where a rod's end counts with the wave that comes in. They are solved for by collocation, Newton's
method on all states that matter to a force; the others follow from the forces.
"""

from __future__ import annotations

from typing import Any

from ..laws import Law, Status
from . import laws, series
from .records import NONE
from .series import POINTS, STAGES, START, N, X

ITERATIONS = 30
FELT = 0.1  # of the velocity that a force makes in the shortest transit: what a piece makes
QUADRATIC = 1e-7  # relative Newton step after which the next one is round-off
ROUND_OFF = 1e-13  # by which the start of a piece may break what keeps a status
SOON = 1e-3  # of the way to the next point: where what starts at 0 is seen to rise


def acts(it: Any) -> bool:
    """Whether a link has a force that depends on the state."""
    if it.status == Status.BOND:
        return bool(it.law == Law.BOND or it.law == Law.JOINT)
    return bool(it.status >= Status.PRESS)


def is_stiff(it: Any) -> bool:
    """Whether the force of a link that acts follows from velocities alone."""
    return bool(it.status != Status.REST and (it.law == Law.BOND or it.law == Law.RIGID))


def number_unknowns(link: Any, mass: Any, at: Any) -> int:
    """Number the states on which forces depend; return how many there are."""
    n, before = 0, False
    for q in range(at.links):
        it = link[at.first + q]
        now = acts(it)
        if q > 0:
            mass[at.mass + q - 1].unknown = NONE
            if before or now:
                mass[at.mass + q - 1].unknown = n
                n += 1
        it.unknown = NONE
        if now and not is_stiff(it):
            it.unknown = n
            n += 1
        before = now
    return n


def is_linear(link: Any, at: Any) -> bool:
    """Whether one Newton step solves the chain."""
    for q in range(at.links):
        it = link[at.first + q]
        if it.unknown != NONE and (it.law == Law.POWER or it.law == Law.OWN):
            return False
    return True


def set_forces(link: Any, mass: Any, at: Any) -> None:
    """Closing rates without own force, forces and their derivatives at all points."""
    for q in range(at.links):
        it = link[at.first + q]
        pushed = it.law == Law.PUSH_LEFT or it.law == Law.PUSH_RIGHT
        acting, resting = acts(it), it.status == Status.REST
        for j in range(POINTS):
            v = at.left[j] if q == 0 else mass[at.mass + q - 1].speed[j]
            w = at.right[j] if q == at.links - 1 else mass[at.mass + q].speed[j]
            it.closing[j] = v - w
            if acting and not resting:
                F, by_overlap, by_closing = laws.force(it, it.overlaps[j], v - w)
                it.force[j], it.by_overlap[j], it.by_closing[j] = F, by_overlap, by_closing
            else:
                if pushed:
                    it.force[j] = v if it.law == Law.PUSH_LEFT else w
                elif not resting:
                    it.force[j] = 0.0
                it.by_overlap[j] = 1.0 if resting else 0.0  # its force is the unknown itself
                it.by_closing[j] = 0.0


def share(it: Any) -> float:
    """Part of the closing that is elastic: what yields hardens with the rest."""
    return it.hardening if it.status == Status.PLASTIC else 1.0


def set_rate(link: Any, mass: Any, at: Any, s: int) -> None:
    """Rate of state s at the points."""
    q = s // 2
    if s % 2 == 1:
        before, behind, m = link[at.first + q], link[at.first + q + 1], mass[at.mass + q].mass
        for j in range(1, POINTS):
            at.rate[j] = (before.force[j] - behind.force[j]) / m
        return
    it = link[at.first + q]
    part = share(it)
    for j in range(1, POINTS):
        at.rate[j] = part * (it.closing[j] - it.mobility * it.force[j])


def slope(link: Any, mass: Any, at: Any, s: int, u: int, j: int) -> float:
    """Derivative of the rate of state s by state u at point j; of the closing if a link rests."""
    q = s // 2
    if s % 2 == 0:
        it = link[at.first + q]
        if it.status == Status.REST:
            return 0.0 if u == s else (1.0 if u < s else -1.0)
        part = share(it)
        if u == s:
            return -part * it.mobility * it.by_overlap[j]
        own = part * (1 - it.mobility * it.by_closing[j])
        return own if u < s else -own
    before, behind = link[at.first + q], link[at.first + q + 1]
    f = 0.0
    if u == s - 1:
        f = before.by_overlap[j]
    elif u == s + 1:
        f = -behind.by_overlap[j]
    elif u == s:
        f = -before.by_closing[j] - behind.by_closing[j]
    elif u < s:
        f = before.by_closing[j]
    else:
        f = behind.by_closing[j]
    return f / mass[at.mass + q].mass


def unknown(link: Any, mass: Any, at: Any, s: int) -> int:
    """Number of state s among the unknowns."""
    if s % 2 == 0:
        return int(link[at.first + s // 2].unknown)
    return int(mass[at.mass + s // 2].unknown)


def set_equations(link: Any, mass: Any, at: Any, h: float, G: Any, n: int) -> None:
    """Newton's equations: y(-1) + h/2 sum STAGES y' - y = 0 at every point, for every unknown."""
    states = 2 * at.links - 1
    for s in range(states):
        row = unknown(link, mass, at, s)
        if row == NONE:
            continue
        resting = s % 2 == 0 and link[at.first + s // 2].status == Status.REST
        set_rate(link, mass, at, s)
        for j in range(N):
            G[N * row + j][N * n] = defect(link, mass, at, s, h, j)
            if resting:
                G[N * row + j][N * n] = -link[at.first + s // 2].closing[j + 1]
        for u in range(max(0, s - 2), min(states, s + 3)):
            column = unknown(link, mass, at, u)
            if column != NONE and (abs(u - s) < 2 or s % 2 == 1):
                for m in range(N):
                    at.rate[m] = slope(link, mass, at, s, u, m + 1)
                set_block(at.rate, u == s, resting, 0.5 * h, G, N * row, N * column)


def set_block(
    g: Any, same: bool, resting: bool, half: float, G: Any, row: int, column: int
) -> None:
    """Set the 8 by 8 equations that couple two states, or one with itself."""
    for j in range(N):
        line, stages = G[row + j], STAGES[j]
        for m in range(N):
            line[column + m] = 0.0 if resting else -half * stages[m] * g[m]
        if resting:
            line[column + j] = g[j]
        elif same:
            line[column + j] += 1.0


def defect(link: Any, mass: Any, at: Any, s: int, h: float, j: int) -> float:
    """By how much state s at point j + 1 lacks what the rates, as set, make of it."""
    f, stages = 0.0, STAGES[j]
    for m in range(N):
        f += stages[m] * at.rate[m + 1]
    f *= 0.5 * h
    if s % 2 == 0:
        it = link[at.first + s // 2]
        return it.overlap + f - it.overlaps[j + 1]
    body = mass[at.mass + s // 2]
    return body.speed[0] + f - body.speed[j + 1]


def clear(G: Any, n: int) -> None:
    """Zeros where equations do not couple, as elimination left numbers there."""
    for i in range(N * n):
        row = G[i]
        for j in range(N * n):
            row[j] = 0.0


def take_step(link: Any, mass: Any, at: Any, scale: float, G: Any, n: int) -> float:
    """Add Newton's step to the states; return the largest relative change."""
    worst = 0.0
    for s in range(2 * at.links - 1):
        row = unknown(link, mass, at, s)
        if row == NONE:
            continue
        big, change = (scale, 0.0) if s % 2 == 1 else (0.0, 0.0)
        for j in range(1, POINTS):
            x = G[N * row + j - 1][N * n]
            if s % 2 == 1:
                mass[at.mass + s // 2].speed[j] += x
                y = mass[at.mass + s // 2].speed[j]
            elif link[at.first + s // 2].status == Status.REST:
                link[at.first + s // 2].force[j] += x
                y, x = 1.0, 0.0
            else:
                link[at.first + s // 2].overlaps[j] += x
                y = link[at.first + s // 2].overlaps[j]
            big, change = max(big, abs(y)), max(change, abs(x))
        if big > 0:
            worst = max(worst, change / big)
    return worst


def collocate(run: Any, link: Any, mass: Any, at: Any, h: float, G: Any) -> bool:
    """Solve a node over a piece of duration h; return whether there is a solution.

    Radau IIA is stiffly accurate: contacts far stiffer than the piece is long do no harm.
    """
    n = number_unknowns(link, mass, at)
    for q in range(at.links):
        it = link[at.first + q]
        for j in range(POINTS):
            u = 0.5 * h * (X[j] + 1)
            it.overlaps[j] = it.overlap
            if it.unknown != NONE and it.status != Status.REST:  # a guess: as it went on before
                it.overlaps[j] += u * (it.rate + 0.5 * u * it.bend)
            if q > 0:
                mass[at.mass + q - 1].speed[j] = mass[at.mass + q - 1].speed[0]
    linear, worst = is_linear(link, at), 1.0
    iterations = 0
    while n > 0 and worst >= QUADRATIC:
        if iterations == ITERATIONS or not worst < 1e300:
            return False
        set_forces(link, mass, at)
        if at.links > 1:
            clear(G, n)
        set_equations(link, mass, at, h, G, n)
        series.eliminate(G, N * n, 3 * N)
        worst = take_step(link, mass, at, run.scale, G, n)
        if linear:
            worst = 0.0
        iterations += 1
    set_forces(link, mass, at)
    follow(link, mass, at, h)
    for q in range(at.links):
        it = link[at.first + q]
        if it.status == Status.REST:  # known at the stages alone
            F = 0.0
            for j in range(N):
                F += START[j] * it.force[j + 1]
            it.force[0] = F
    return True


def follow(link: Any, mass: Any, at: Any, h: float) -> None:
    """What follows from the forces: first masses that feel given ones, then open gaps."""
    moved = False
    for q in range(at.links - 1):
        body = mass[at.mass + q]
        if body.unknown == NONE:
            set_rate(link, mass, at, 2 * q + 1)
            for j in range(N):
                body.speed[j + 1] += defect(link, mass, at, 2 * q + 1, h, j)
            moved = True
    if moved:
        set_forces(link, mass, at)
    for q in range(at.links):
        it = link[at.first + q]
        if it.status == Status.OPEN or it.status == Status.GRAZE:
            set_rate(link, mass, at, 2 * q)
            for j in range(N):
                it.overlaps[j + 1] += defect(link, mass, at, 2 * q, h, j)


def set_leaving(link: Any, at: Any, right: bool) -> None:
    """What leaves a node: to the left a - 2 F/Z of its first link, to the right b + 2 F/Z."""
    if right:
        F, y = link[at.first + at.links - 1].force, 2 * at.mobility_right
        for j in range(POINTS):
            at.leaving[j] = at.right[j] + y * F[j]
    else:
        F, y = link[at.first].force, 2 * at.mobility_left
        for j in range(POINTS):
            at.leaving[j] = at.left[j] - y * F[j]


def roughness(link: Any, mass: Any, at: Any) -> float:
    """The largest tail of what comes in and leaves, of velocities of masses, and of forces.

    What comes in counts too, as it may cancel in what leaves.
    """
    first, last = link[at.first], link[at.first + at.links - 1]
    worst = series.tail(at.left) * (2 * first.ease if first.law == Law.PUSH_LEFT else 1.0)
    worst = max(
        worst, series.tail(at.right) * (2 * last.ease if last.law == Law.PUSH_RIGHT else 1.0))
    if at.mobility_left > 0:
        set_leaving(link, at, False)
        worst = series.tail(at.leaving)
    if at.mobility_right > 0:
        set_leaving(link, at, True)
        worst = max(worst, series.tail(at.leaving))
    for i in range(at.links - 1):
        worst = max(worst, series.tail(mass[at.mass + i].speed))
    for q in range(at.links if at.links > 1 else 0):
        it = link[at.first + q]
        if it.unknown != NONE and it.status != Status.REST:
            worst = max(worst, FELT * it.ease * series.tail(it.force))
    return worst


def next_event(run: Any, link: Any, at: Any, h: float) -> tuple[float, int, int]:
    """First event of a piece: where, -1 if at once and 1 if none; in which link; its new status.

    The first point alone decides nothing, as round-off does there: what falls below 0 at a later
    point did so at once if the series does not rise before.
    """
    where, which, status = 1.0, NONE, 0
    for q in range(at.links):
        it = link[at.first + q]
        for i in range(laws.guards(it)):
            to = 0
            for j in range(POINTS):
                g, to = laws.guard(it, i, it.overlaps[j], it.closing[j], it.force[j], run.scale,
                                   0.01 * run.scale * h)
                at.rate[j] = g
            j = 1
            while j < POINTS and at.rate[j] >= -ROUND_OFF:
                j += 1
            if j == POINTS:
                continue
            series.coefficients(at.rate, at.series)
            low, zero = X[j - 1], -1.0
            if at.rate[j - 1] <= 0:
                low += SOON * (X[j] - X[j - 1])
            if series.value(at.series, low) > 0:
                zero = series.first_zero(at.series, low, X[j])
            elif j > 1:
                zero = X[j - 1]
            if which == NONE or zero < where:
                where, which, status = zero, at.first + q, to
    return where, which, status


def cut(link: Any, mass: Any, at: Any, y: float) -> None:
    """Restrict everything that is known of a piece to the part up to y."""
    series.restrict(at.left, y, at.series)
    series.restrict(at.right, y, at.series)
    for q in range(at.links):
        it = link[at.first + q]
        series.restrict(it.force, y, at.series)
        series.restrict(it.overlaps, y, at.series)
        series.restrict(it.closing, y, at.series)
        if q > 0:
            series.restrict(mass[at.mass + q - 1].speed, y, at.series)
