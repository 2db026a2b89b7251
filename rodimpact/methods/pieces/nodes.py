"""One piece of a node: the chain of links and masses between two rods, driven by two waves.

In every link acts a force F. All else follows from the forces: velocities of the masses, then the
closing rates without own force, then the overlaps,
m v' = F before - F behind,  closing = velocity on the left - on the right,  d' = closing - Y F,
where a rod's end counts with the wave that comes in. Forces that depend on this are found by
collocation (Radau IIA) and Newton's method.
"""

from .. import contact_laws
from ..compiling import borrowed
from ..link import Law
from ..states import Status
from . import series
from .records import NONE, Link, Links, Masses, Node, Run
from .series import POINTS, STAGES, START, TWICE, Matrix, MutableValues, N, Values, X

MAX_NEWTON_STEPS = 30
"""Newton steps on one piece; a piece that needs more is shortened."""
PIECE_PER_TRANSIT = 0.1
"""Duration of a typical piece over the shortest transit.

It makes the tail of a force a velocity: a force acts for about so long before the next piece.
"""
RESIDUAL_RTOL = 1e-7
"""Residual of the contact laws before the last Newton step, relative to the force.

Newton's method converges quadratically: the step after it leaves 1e-14, which is round-off.
"""
CANCELLATION_RTOL = 1e-6
"""Force over the terms that cancel in it, below which its residual is measured by these terms.

A residual of RESIDUAL_RTOL times the force would then be below 1e-13 of the terms: round-off.
"""
ROUND_OFF = 1e-13
"""Value below 0, without dimension, down to which an event function counts as 0."""
POSITIVE_RTOL = 0.1
"""Smallest over largest value at the points, above which a polynomial has no zero between them."""
SWING_FACTOR = 1.1
"""Factor on the deepest swing below 0 that samples show: the true one is little deeper."""
SWING_ROUND_OFF = 8e-15
"""Round-off of evaluating the polynomial of a force, over the largest force."""
FIRST_RISE = 1e-3
"""Part of the way to the next point at which an event function that starts at 0 shows its sign."""


def overlap_changes(link: Link) -> bool:
    """Return whether the overlap of a link changes."""
    if link.status == Status.BOND:
        return bool(link.law == Law.JOINT)
    return bool(
        link.status != Status.REST
        and not (link.law == Law.RIGID and link.status == Status.PRESS)
    )


def elastic_share(link: Link) -> float:
    """Return the elastic part of the closing rate; a link that yields takes up the rest."""
    if link.status == Status.PLASTIC:
        return link.hardening_share
    return 1.0


def set_forces(links: Links, node: Node) -> int:
    """Set the given forces, number the unknown ones and set them to 0; return their number."""
    unknown_count = 0
    for q in range(node.link_count):
        link = links[node.first_link + q]
        link.unknown_index = NONE
        acts = (
            link.status >= Status.PRESS or link.law == Law.BOND or link.law == Law.JOINT
        )
        if acts and (node.link_count > 1 or overlap_changes(link)):
            link.unknown_index = unknown_count
            unknown_count += 1
        for j in range(POINTS):
            link.force[j] = 0.0
            if link.law == Law.PUSH_LEFT or link.law == Law.PUSH_RIGHT:
                link.force[j] = node.incoming[link.law - Law.PUSH_LEFT][j]
            elif link.unknown_index == NONE and (
                link.law == Law.BOND or link.status == Status.PRESS
            ):
                # The waves of two rods decide, with nothing else between them.
                closing = node.incoming[0][j] - node.incoming[1][j]
                link.force[j] = closing / link.mobility
    return unknown_count


def integrate(rate: Values, h: float, f: MutableValues) -> None:
    """Set f to f[0] plus the integral of a rate, at the points of a piece of duration h."""
    for j in range(N):
        s = 0.0
        stages = STAGES[j]
        for m in range(N):
            s += stages[m] * rate[m + 1]
        f[j + 1] = f[0] + 0.5 * h * s


def update_motion(links: Links, masses: Masses, node: Node, h: float) -> None:
    """Set velocities, closing rates and overlaps, which follow from the forces."""
    for i in range(node.link_count - 1):
        before = links[node.first_link + i]
        behind = links[node.first_link + i + 1]
        body = masses[node.first_mass + i]
        for j in range(POINTS):
            node.scratch_values[j] = (before.force[j] - behind.force[j]) / body.mass
        integrate(node.scratch_values, h, body.velocity)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        share = 0.0
        if overlap_changes(link):
            share = elastic_share(link)
        for j in range(POINTS):
            if q == 0:
                v = node.incoming[0][j]
            else:
                v = masses[node.first_mass + q - 1].velocity[j]
            if q == node.link_count - 1:
                w = node.incoming[1][j]
            else:
                w = masses[node.first_mass + q].velocity[j]
            link.closing[j] = v - w
            link.overlaps[j] = link.overlap
            node.scratch_values[j] = share * (v - w - link.mobility * link.force[j])
        if share != 0:
            integrate(node.scratch_values, h, link.overlaps)


def linearise(link: Link, h: float, first: bool) -> float:
    """Set the tangent F = base + by_overlap d + by_closing closing; return the relative residual.

    In the first Newton step the tangent is taken at the extrapolated overlap d + d' u + d'' u^2/2,
    u the time since the start of the piece. The residual is relative to the largest force, or to
    the round-off of the terms that cancel in it: a law with damping has almost no force where
    bodies part almost as fast as it lets go.
    """
    residual = 0.0
    largest = 0.0
    for j in range(1, POINTS):
        d = link.overlaps[j]
        closing = link.closing[j]
        if first:
            u = 0.5 * h * (X[j] + 1)
            d = link.overlap + u * (
                link.overlap_rate + 0.5 * u * link.overlap_acceleration
            )
        F, by_overlap, by_closing = contact_laws.force(link, d, closing)
        link.by_overlap[j] = by_overlap
        link.by_closing[j] = by_closing
        link.base[j] = F - by_overlap * d - by_closing * closing
        residual = max(residual, abs(F - link.force[j]))
        largest = max(largest, abs(F), CANCELLATION_RTOL * abs(link.base[j]))
    if largest > 0:
        return residual / largest
    return 0.0


def set_equations(
    links: Links, masses: Masses, node: Node, h: float, G: Matrix, unknown_count: int
) -> None:
    """Set the equations of a Newton step: its changes of forces fulfil the tangent laws.

    Each of the `unknown_count` forces has an equation at each of the N stages. The column of `G`
    behind those of the unknowns is the right side, in newtons. The tangent law of a link is
    F = base + by_overlap d + by_closing closing, with d and closing after the step. So the right
    side is the force by the present d and closing, less the present force. A link at rest (REST)
    has no law: its force is such that `closing` becomes 0, and the right side is the present
    `closing`, m/s.
    """
    right_side = N * unknown_count
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index == NONE:
            continue
        for p in range(node.link_count):
            column = links[node.first_link + p].unknown_index
            if column != NONE:
                change = closing_by_impulse(masses, node, q, p)
                set_block(link, change, p == q, h, G, N * column)
        for j in range(N):
            present = link.force[j + 1]
            if link.status == Status.REST:
                present = 0.0
            G[N * link.unknown_index + j][right_side] = (
                link.base[j + 1]
                + link.by_overlap[j + 1] * link.overlaps[j + 1]
                + link.by_closing[j + 1] * link.closing[j + 1]
                - present
            )


def closing_by_impulse(masses: Masses, node: Node, q: int, p: int) -> float:
    """Return the change of the closing rate of link q by a unit impulse in link p, 1/kg."""
    left = 0.0
    right = 0.0
    if q > 0:
        left = 1 / masses[node.first_mass + q - 1].mass
    if q < node.link_count - 1:
        right = 1 / masses[node.first_mass + q].mass
    if p == q:
        return -left - right
    if p == q - 1:
        return left
    if p == q + 1:
        return right
    return 0.0


def set_block(
    link: Link, by_impulse: float, is_same: bool, h: float, G: Matrix, column: int
) -> None:
    """Set the N by N equations that couple the forces of two links, or one with itself.

    `by_impulse` is the change of the closing rate of the link by a unit impulse of the other;
    `is_same` says that both are one.
    """
    half = 0.5 * h
    by_closing = half * by_impulse
    share = half * elastic_share(link)
    by_force = 0.0
    identity = 0.0
    if is_same:
        by_force = share * link.mobility
        if link.status != Status.REST:
            identity = 1.0
    coupled = N  # number of stages by which a mass between both links couples them
    if by_impulse == 0:
        coupled = 0
    for j in range(N):
        row = G[N * link.unknown_index + j]
        stages = STAGES[j]
        twice = TWICE[j]
        a = link.by_closing[j + 1] * by_closing - link.by_overlap[j + 1] * by_force
        b = link.by_overlap[j + 1] * share * by_closing
        for m in range(N):
            row[column + m] = -a * stages[m]
        for m in range(coupled):
            row[column + m] -= b * twice[m]
        row[column + j] += identity


def take_step(
    run: Run,
    links: Links,
    masses: Masses,
    node: Node,
    h: float,
    G: Matrix,
    unknown_count: int,
) -> None:
    """Add the changes of a Newton step to the forces, and update the motion.

    Where dF/dd times scale times h is above the force, the link is stiff: its overlap is a small
    difference of large numbers. It is then computed from the force, as integrating the closing
    rate would lose digits.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        stages = N
        if link.unknown_index == NONE:
            stages = 0
        for j in range(stages):
            link.force[j + 1] += G[N * link.unknown_index + j][N * unknown_count]
    update_motion(links, masses, node, h)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index != NONE and overlap_changes(link):
            for j in range(1, POINTS):
                if link.by_overlap[j] * run.velocity_scale * h > abs(link.force[j]):
                    damped = link.by_closing[j] * link.closing[j]
                    elastic = link.force[j] - link.base[j] - damped
                    link.overlaps[j] = elastic / link.by_overlap[j]


def collocate(
    run: Run, links: Links, masses: Masses, node: Node, h: float, G: Matrix
) -> bool:
    """Solve a node over a piece of duration h; return whether Newton's method converged.

    Radau IIA is stiffly accurate: contacts far stiffer than the piece is long do no harm.
    """
    links = borrowed(links)
    masses = borrowed(masses)
    G = borrowed(G)
    unknown_count = set_forces(links, node)
    residual = 1.0
    steps = 0
    update_motion(links, masses, node, h)
    while unknown_count > 0 and residual >= RESIDUAL_RTOL:
        if steps == MAX_NEWTON_STEPS or not residual < 1e300:
            return False
        residual = 0.0
        for q in range(node.link_count):
            link = links[node.first_link + q]
            if link.unknown_index != NONE:
                missed = linearise(link, h, steps == 0)
                if contact_laws.is_nonlinear(link):
                    if steps == 0:
                        missed = 1.0  # the first tangent was taken at an extrapolation
                    residual = max(residual, missed)
        set_equations(links, masses, node, h, G, unknown_count)
        series.eliminate(G, N * unknown_count, 2 * N)
        take_step(run, links, masses, node, h, G, unknown_count)
        steps += 1
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.status == Status.REST:
            # Its force is known at the stages alone, and extrapolated to the start.
            for j in range(N):
                link.force[0] += START[j] * link.force[j + 1]
        elif link.unknown_index != NONE:
            force, by_overlap, by_closing = contact_laws.force(
                link, link.overlap, link.closing[0]
            )
            link.force[0] = force
            link.by_overlap[0] = by_overlap
            link.by_closing[0] = by_closing
    return True


def forbid_pulling(links: Links, node: Node) -> None:
    """Let no contact of a node pull, at any time in the piece, with the same impulse as before.

    Where a force falls to 0 its polynomial may swing below 0 by about the tolerance. With m > 0 at
    least as large as the swing, and J the integral of F over the piece of duration h,
    F := (F + m) J/(J + m h) is never negative and has the integral J.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        largest = series.largest(link.force)
        smallest = series.smallest(link.force)
        if link.status >= Status.PRESS and smallest < POSITIVE_RTOL * largest:
            series.coefficients(link.force, node.scratch_series)
            deepest = -series.minimum(node.scratch_series)
            swing = SWING_FACTOR * deepest + SWING_ROUND_OFF * largest
            impulse = series.integral(link.force)
            if swing > 0:
                share = 0.0
                if impulse > 0:
                    share = impulse / (impulse + 2 * swing)
                for j in range(POINTS):
                    link.force[j] = max(0.0, (link.force[j] + swing) * share)


def set_outgoing(links: Links, node: Node, side: int) -> None:
    """Set the wave that leaves a node.

    To the left goes a - 2 F/Z with the force of the first link, to the right b + 2 F/Z with that
    of the last.
    """
    link = links[node.first_link + side * (node.link_count - 1)]
    velocity_by_force = (4 * side - 2) * node.mobility[side]
    incoming = node.incoming[side]
    for j in range(POINTS):
        node.outgoing[j] = incoming[j] + velocity_by_force * link.force[j]


def truncation_error(links: Links, masses: Masses, node: Node) -> float:
    """Return the truncation error of a piece, m/s: the largest tail of its series.

    The series are those of incoming and leaving waves, of velocities of masses, and of forces.
    Incoming waves count too, as they may cancel in leaving ones.
    """
    worst = 0.0
    for side in range(2):
        link = links[node.first_link + side * (node.link_count - 1)]
        velocity = 1.0
        if link.law == Law.PUSH_LEFT + side:
            velocity = 2 * link.effective_mobility  # the input is a force, not a wave
        worst = max(worst, series.truncation_estimate(node.incoming[side]) * velocity)
        if node.mobility[side] > 0:
            set_outgoing(links, node, side)
            worst = max(worst, series.truncation_estimate(node.outgoing))
    for i in range(node.link_count - 1):
        worst = max(
            worst, series.truncation_estimate(masses[node.first_mass + i].velocity)
        )
    count = node.link_count
    if count == 1:
        count = 0  # the force between two rods is seen in the leaving waves
    for q in range(count):
        link = links[node.first_link + q]
        if overlap_changes(link):
            worst = max(
                worst,
                PIECE_PER_TRANSIT
                * link.effective_mobility
                * series.truncation_estimate(link.force),
            )
    return worst


def remainder(links: Links, node: Node, integrated: bool) -> float:
    """Return an estimate of the error of the waves of a piece, or of their integrals, m/s."""
    largest = 0.0
    for side in range(2):
        largest = max(largest, series.remainder(node.incoming[side], integrated))
        if node.mobility[side] > 0:
            set_outgoing(links, node, side)
            largest = max(largest, series.remainder(node.outgoing, integrated))
    return largest


def find_crossing(node: Node, j: int) -> float:
    """Return the place at which an event function falls below 0, or -1 if it does so at once.

    `node.scratch_values` has its values at the points; the first negative one is that at point j.
    """
    series.coefficients(node.scratch_values, node.scratch_series)
    low = X[j - 1]
    zero = -1.0
    if node.scratch_values[j - 1] <= 0:
        low += FIRST_RISE * (X[j] - X[j - 1])
    if series.value(node.scratch_series, low) > 0:
        zero = series.first_zero(node.scratch_series, low, X[j])
    elif j > 1:
        zero = X[j - 1]
    return zero


def find_dip(node: Node, depth: float) -> float:
    """Return the place at which an event function falls below 0 between two points.

    It is 2 if the function does not, or by less than `depth`. A contact may close or let go for a
    shorter time than points are apart.
    """
    zero = 2.0
    least = series.smallest(node.scratch_values)
    if least < POSITIVE_RTOL * series.largest(node.scratch_values):
        j = 0
        while node.scratch_values[j] > least:
            j += 1
        low = X[max(j - 1, 0)]
        series.coefficients(node.scratch_values, node.scratch_series)
        monotonic = (
            False  # whether it rises from the end of the piece at which it is lowest
        )
        if j == 0:
            monotonic = series.slope_at_end(node.scratch_series, -1.0) >= 0
        elif j == N:
            monotonic = series.slope_at_end(node.scratch_series, 1.0) <= 0
        if not monotonic:
            bottom = series.lowest(node.scratch_series, low, X[min(j + 1, N)])
            if bottom > low and series.value(node.scratch_series, bottom) < -depth:
                zero = series.first_zero(node.scratch_series, low, bottom)
    return zero


def next_event(run: Run, links: Links, node: Node, h: float) -> tuple[float, int, int]:
    """Return the first event of a piece: its place, its link, and the new status of the link.

    The place is -1 if the event is at the start, and 1 if there is none. An event function that is
    about 0 at the first point is not trusted there: if it is negative at a later point and does
    not become positive in between, the event is at the start.
    """
    where = 1.0
    which = NONE
    status = 0
    length = 0.01 * run.velocity_scale * h
    for q in range(node.link_count):
        link = links[node.first_link + q]
        for i in range(contact_laws.guards(link)):
            next_status = 0
            for j in range(POINTS):
                value, next_status = contact_laws.guard(
                    link,
                    i,
                    link.overlaps[j],
                    link.closing[j],
                    link.force[j],
                    run.velocity_scale,
                    length,
                )
                node.scratch_values[j] = value
            overlap = contact_laws.follows_overlap(link, i)
            ignored = ROUND_OFF
            if overlap and node.scratch_values[N] > 0:
                # A force that starts softly is a polynomial that swings a little below 0.
                ignored = max(
                    ignored,
                    run.graze_velocity
                    * run.shortest_transit
                    * run.tick_duration
                    / length,
                )
            j = 1
            while j < POINTS and node.scratch_values[j] >= -ignored:
                j += 1
            depth = max(ignored, run.tolerance / run.velocity_scale)
            zero = 2.0
            if (
                node.scratch_values[0] < -depth
                and not overlap
                and link.status != Status.REST
            ):
                zero = -1.0  # it may rise again before the first point
            elif j == POINTS:
                zero = find_dip(node, depth)
            else:
                zero = find_crossing(node, j)
            if zero > 1:
                continue
            if which == NONE or zero < where:
                where = zero
                which = node.first_link + q
                status = next_status
    return where, which, status


def restrict_piece(links: Links, masses: Masses, node: Node, y: float) -> None:
    """Restrict all series of a piece to the part up to y."""
    for side in range(2):
        series.restrict(node.incoming[side], y, node.scratch_series)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        series.restrict(link.force, y, node.scratch_series)
        series.restrict(link.overlaps, y, node.scratch_series)
        series.restrict(link.closing, y, node.scratch_series)
        if q > 0:
            series.restrict(
                masses[node.first_mass + q - 1].velocity, y, node.scratch_series
            )
