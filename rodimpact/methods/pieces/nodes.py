"""One piece of a node: the chain of links and masses between two rods, driven by two waves.

In every link acts a force F. All else follows from the forces: velocities of the masses, then the
closing rates without own force, then the overlaps,
m v' = F before - F behind,  closing = velocity on the left - on the right,  d' = closing - Y F,
where a rod's end counts with the wave that comes in. Forces that depend on this are found by
collocation and Newton's method.
"""

from typing import Any

from .. import contact_laws
from ..link import Law
from ..states import Status
from . import series
from .records import NONE
from .series import POINTS, STAGES, START, TWICE, N, X

ITERATIONS = 30
FELT = 0.1  # of the velocity that a force makes in the shortest transit: what a piece makes
QUADRATIC = (
    1e-7  # by which forces miss their laws, relative: after the next step by round-off
)
CANCELLED = 1e-6  # force over its terms: less than that cannot be told more precisely
ROUND_OFF = 1e-13  # by which the start of a piece may break what keeps a status
CLEAR_OF_ZERO = (
    0.1  # of the largest value at the points: no swing of a smooth force is so deep
)
SWING_FACTOR = 1.1  # over the deepest swing that samples show
FORCE_ROUND_OFF = (
    8e-15  # of the largest force: what evaluating a polynomial may add to a swing
)
SOON = 1e-3  # of the way to the next point: where what starts at 0 is seen to rise


def deforms(it: Any) -> bool:
    """Whether the overlap of a link changes."""
    if it.status == Status.BOND:
        return bool(it.law == Law.JOINT)
    return bool(
        it.status != Status.REST
        and not (it.law == Law.RIGID and it.status == Status.PRESS)
    )


def share(it: Any) -> float:
    """Part of the closing that is elastic: what yields hardens with the rest."""
    return it.hardening_share if it.status == Status.PLASTIC else 1.0


def set_forces(link: Any, at: Any) -> int:
    """Set forces that are given, number the unknown ones, 0 for now; return how many these are."""
    n = 0
    for q in range(at.links):
        it = link[at.first + q]
        it.unknown = NONE
        acts = it.status >= Status.PRESS or it.law == Law.BOND or it.law == Law.JOINT
        if acts and (at.links > 1 or deforms(it)):
            it.unknown = n
            n += 1
        for j in range(POINTS):
            it.force[j] = 0.0
            if it.law == Law.PUSH_LEFT or it.law == Law.PUSH_RIGHT:
                it.force[j] = at.incoming[it.law - Law.PUSH_LEFT][j]
            elif it.unknown == NONE and (
                it.law == Law.BOND or it.status == Status.PRESS
            ):
                # two rods, nothing else
                it.force[j] = (at.incoming[0][j] - at.incoming[1][j]) / it.mobility
    return n


def integrate(rate: Any, h: float, f: Any) -> None:
    """Let f grow at this rate from its first point on, over a piece of duration h."""
    for j in range(N):
        s, stages = 0.0, STAGES[j]
        for m in range(N):
            s += stages[m] * rate[m + 1]
        f[j + 1] = f[0] + 0.5 * h * s


def follow(link: Any, mass: Any, at: Any, h: float) -> None:
    """Set what follows from the forces."""
    for i in range(at.links - 1):
        before, behind, body = (
            link[at.first + i],
            link[at.first + i + 1],
            mass[at.mass + i],
        )
        for j in range(POINTS):
            at.rate[j] = (before.force[j] - behind.force[j]) / body.mass
        integrate(at.rate, h, body.speed)
    for q in range(at.links):
        it = link[at.first + q]
        part = share(it) if deforms(it) else 0.0
        for j in range(POINTS):
            v = at.incoming[0][j] if q == 0 else mass[at.mass + q - 1].speed[j]
            w = at.incoming[1][j] if q == at.links - 1 else mass[at.mass + q].speed[j]
            it.closing[j], it.overlaps[j] = v - w, it.overlap
            at.rate[j] = part * (v - w - it.mobility * it.force[j])
        if part != 0:
            integrate(at.rate, h, it.overlaps)


def linearise(it: Any, h: float, first: bool) -> float:
    """Set F = base + by_overlap d + by_closing closing; return by how much forces miss the law.

    At first it is taken where the overlap comes to if it goes on as it went before. The miss is
    relative to the largest force, or to the round-off of the terms that cancel in it: a law with
    damping has almost no force where bodies part almost as fast as it lets go.
    """
    missed = top = 0.0
    for j in range(1, POINTS):
        d, closing, u = it.overlaps[j], it.closing[j], 0.5 * h * (X[j] + 1)
        if first:
            d = it.overlap + u * (it.rate + 0.5 * u * it.bend)
        F, it.by_overlap[j], it.by_closing[j] = contact_laws.force(it, d, closing)
        it.base[j] = F - it.by_overlap[j] * d - it.by_closing[j] * closing
        missed = max(missed, abs(F - it.force[j]))
        top = max(top, abs(F), CANCELLED * abs(it.base[j]))
    return missed / top if top > 0 else 0.0


def set_equations(link: Any, mass: Any, at: Any, h: float, G: Any, n: int) -> None:
    """Equations of the changes of forces after which they follow the linear laws."""
    for q in range(at.links):
        it = link[at.first + q]
        if it.unknown == NONE:
            continue
        for p in range(at.links):
            column = link[at.first + p].unknown
            if column != NONE:
                set_block(it, felt(mass, at, q, p), p == q, h, G, N * column)
        for j in range(N):
            own = 0.0 if it.status == Status.REST else it.force[j + 1]
            G[N * it.unknown + j][N * n] = (
                it.base[j + 1]
                + it.by_overlap[j + 1] * it.overlaps[j + 1]
                + it.by_closing[j + 1] * it.closing[j + 1]
                - own
            )


def felt(mass: Any, at: Any, q: int, p: int) -> float:
    """Change of the closing of link q by the impulse of the force of link p."""
    left = 1 / mass[at.mass + q - 1].mass if q > 0 else 0.0
    right = 1 / mass[at.mass + q].mass if q < at.links - 1 else 0.0
    if p == q:
        return -left - right
    if p == q - 1:
        return left
    return right if p == q + 1 else 0.0


def set_block(it: Any, felt: float, own: bool, h: float, G: Any, column: int) -> None:
    """Set the 8 by 8 equations that couple the forces of two links, or one with itself."""
    half = 0.5 * h
    by_closing, part = half * felt, half * share(it)
    by_force = part * it.mobility if own else 0.0
    same = 1.0 if own and it.status != Status.REST else 0.0
    for j in range(N):
        line, stages, twice = G[N * it.unknown + j], STAGES[j], TWICE[j]
        a = it.by_closing[j + 1] * by_closing - it.by_overlap[j + 1] * by_force
        b = it.by_overlap[j + 1] * part * by_closing
        for m in range(N):
            line[column + m] = -a * stages[m]
        for m in range(N if felt != 0 else 0):
            line[column + m] -= b * twice[m]
        line[column + j] += same


def take_step(
    run: Any, link: Any, mass: Any, at: Any, h: float, G: Any, n: int
) -> None:
    """Change the forces, and all that follows.

    Where a link is stiffer than the piece is long, its overlap is a small difference of large
    numbers, and follows from its force.
    """
    for q in range(at.links):
        it = link[at.first + q]
        for j in range(N if it.unknown != NONE else 0):
            it.force[j + 1] += G[N * it.unknown + j][N * n]
    follow(link, mass, at, h)
    for q in range(at.links):
        it = link[at.first + q]
        if it.unknown != NONE and deforms(it):
            for j in range(1, POINTS):
                if it.by_overlap[j] * run.scale * h > abs(it.force[j]):
                    F = it.force[j] - it.base[j] - it.by_closing[j] * it.closing[j]
                    it.overlaps[j] = F / it.by_overlap[j]


def collocate(run: Any, link: Any, mass: Any, at: Any, h: float, G: Any) -> bool:
    """Solve a node over a piece of duration h; return whether there is a solution.

    Radau IIA is stiffly accurate: contacts far stiffer than the piece is long do no harm.
    """
    n, worst, iterations = set_forces(link, at), 1.0, 0
    follow(link, mass, at, h)
    while n > 0 and worst >= QUADRATIC:
        if iterations == ITERATIONS or not worst < 1e300:
            return False
        worst = 0.0
        for q in range(at.links):
            it = link[at.first + q]
            if it.unknown != NONE:
                missed = linearise(it, h, iterations == 0)
                if contact_laws.is_nonlinear(it):
                    worst = max(worst, 1.0 if iterations == 0 else missed)
        set_equations(link, mass, at, h, G, n)
        series.eliminate(G, N * n, 2 * N)
        take_step(run, link, mass, at, h, G, n)
        iterations += 1
    for q in range(at.links):
        it = link[at.first + q]
        if it.status == Status.REST:  # known at the stages alone
            for j in range(N):
                it.force[0] += START[j] * it.force[j + 1]
        elif it.unknown != NONE:
            it.force[0], it.by_overlap[0], it.by_closing[0] = contact_laws.force(
                it, it.overlap, it.closing[0]
            )
    return True


def forbid_pulling(link: Any, at: Any) -> None:
    """Let no contact of a node pull, at any time in the piece, with the same impulse as before.

    Where a force falls to 0 its polynomial may swing below 0 by about the tolerance. With m > 0 at
    least as large as the swing, and J the integral of F over the piece of duration h,
    F := (F + m) J/(J + m h) is never negative and has the integral J.
    """
    for q in range(at.links):
        it = link[at.first + q]
        top = series.largest(it.force)
        least = series.smallest(it.force)
        if it.status >= Status.PRESS and least < CLEAR_OF_ZERO * top:
            series.coefficients(it.force, at.series)
            swing = SWING_FACTOR * -series.minimum(at.series) + FORCE_ROUND_OFF * top
            impulse = series.integral(it.force)
            if swing > 0:
                share = 0.0
                if impulse > 0:
                    share = impulse / (impulse + 2 * swing)
                for j in range(POINTS):
                    it.force[j] = max(0.0, (it.force[j] + swing) * share)


def set_leaving(link: Any, at: Any, side: int) -> None:
    """What leaves a node: to the left a - 2 F/Z of its first link, to the right b + 2 F/Z."""
    F, y = (
        link[at.first + side * (at.links - 1)].force,
        (4 * side - 2) * at.mobility[side],
    )
    came = at.incoming[side]
    for j in range(POINTS):
        at.leaving[j] = came[j] + y * F[j]


def roughness(link: Any, mass: Any, at: Any) -> float:
    """The largest tail of what comes in and leaves, of velocities of masses, and of forces.

    What comes in counts too, as it may cancel in what leaves.
    """
    worst = 0.0
    for side in range(2):
        it = link[at.first + side * (at.links - 1)]
        pushes = it.law == Law.PUSH_LEFT + side
        worst = max(
            worst, series.tail(at.incoming[side]) * (2 * it.ease if pushes else 1.0)
        )
        if at.mobility[side] > 0:
            set_leaving(link, at, side)
            worst = max(worst, series.tail(at.leaving))
    for i in range(at.links - 1):
        worst = max(worst, series.tail(mass[at.mass + i].speed))
    for q in range(at.links if at.links > 1 else 0):
        it = link[at.first + q]
        if deforms(it):
            worst = max(worst, FELT * it.ease * series.tail(it.force))
    return worst


def remainder(link: Any, at: Any, integrated: bool) -> float:
    """Estimate of the error of the waves of a piece, or of their integrals over it, m/s."""
    largest = 0.0
    for side in range(2):
        largest = max(largest, series.remainder(at.incoming[side], integrated))
        if at.mobility[side] > 0:
            set_leaving(link, at, side)
            largest = max(largest, series.remainder(at.leaving, integrated))
    return largest


def crossing(at: Any, j: int) -> float:
    """Where a guard, given at the points, falls below 0: it is negative at point j, the first.

    It is -1 if the guard does so at once.
    """
    series.coefficients(at.rate, at.series)
    low = X[j - 1]
    zero = -1.0
    if at.rate[j - 1] <= 0:
        low += SOON * (X[j] - X[j - 1])
    if series.value(at.series, low) > 0:
        zero = series.first_zero(at.series, low, X[j])
    elif j > 1:
        zero = X[j - 1]
    return zero


def dip(at: Any, depth: float) -> float:
    """Where a guard falls below 0 between two points; 2 if it does not, or by less than `depth`.

    A contact may close or let go for a shorter time than points are apart.
    """
    zero = 2.0
    least = series.smallest(at.rate)
    if least < CLEAR_OF_ZERO * series.largest(at.rate):
        j = 0
        while at.rate[j] > least:
            j += 1
        low = X[max(j - 1, 0)]
        series.coefficients(at.rate, at.series)
        monotonic = False  # from the end of the piece at which it is lowest
        if j == 0:
            monotonic = series.slope_at_end(at.series, -1.0) >= 0
        elif j == N:
            monotonic = series.slope_at_end(at.series, 1.0) <= 0
        if not monotonic:
            bottom = series.lowest(at.series, low, X[min(j + 1, N)])
            if bottom > low and series.value(at.series, bottom) < -depth:
                zero = series.first_zero(at.series, low, bottom)
    return zero


def next_event(run: Any, link: Any, at: Any, h: float) -> tuple[float, int, int]:
    """First event of a piece: where, -1 if at once and 1 if none; in which link; its new status.

    Round-off at the first point decides nothing: what falls below 0 at a later point did so at once
    if the series does not rise before.
    """
    where, which, status = 1.0, NONE, 0
    length = 0.01 * run.scale * h
    for q in range(at.links):
        it = link[at.first + q]
        for i in range(contact_laws.guards(it)):
            to = 0
            for j in range(POINTS):
                g, to = contact_laws.guard(
                    it,
                    i,
                    it.overlaps[j],
                    it.closing[j],
                    it.force[j],
                    run.scale,
                    length,
                )
                at.rate[j] = g
            overlap = contact_laws.follows_overlap(it, i)
            ignored = ROUND_OFF
            if overlap and at.rate[N] > 0:
                # a force that starts softly is a polynomial that swings a little below 0
                ignored = max(ignored, run.graze * run.shortest * run.tick / length)
            j = 1
            while j < POINTS and at.rate[j] >= -ignored:
                j += 1
            deep = max(ignored, run.tolerance / run.scale)
            zero = 2.0
            if at.rate[0] < -deep and not overlap and it.status != Status.REST:
                zero = -1.0  # for a shorter time than to the first point, perhaps
            elif j == POINTS:
                zero = dip(at, deep)
            else:
                zero = crossing(at, j)
            if zero > 1:
                continue
            if which == NONE or zero < where:
                where, which, status = zero, at.first + q, to
    return where, which, status


def restrict_piece(link: Any, mass: Any, at: Any, y: float) -> None:
    """Restrict everything that is known of a piece to the part up to y."""
    for side in range(2):
        series.restrict(at.incoming[side], y, at.series)
    for q in range(at.links):
        it = link[at.first + q]
        series.restrict(it.force, y, at.series)
        series.restrict(it.overlaps, y, at.series)
        series.restrict(it.closing, y, at.series)
        if q > 0:
            series.restrict(mass[at.mass + q - 1].speed, y, at.series)
