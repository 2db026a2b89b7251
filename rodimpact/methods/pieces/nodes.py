"""The solution of a node over one piece.

A node is the chain of links and masses between two rods. Two incoming waves drive it.

A force F acts in every link. Everything else follows from the forces: the velocities of
the masses, then the closing velocities without the own force, then the overlaps,

    m v' = F_left - F_right,    closing = v_left - v_right,
    d' = closing - Y F.

At the end of a rod the incoming wave, a, takes the place of v in `closing`. The force F
changes the velocity of this end from a to a - F/Z: Y, the mobility of the link, is the
sum of 1/Z of the rod ends beside it. The contact laws give F as a function of d and
`closing`. All these equations are solved by collocation (Radau IIA) and Newton's
method.

Indices: link q of a node lies between its masses q - 1 and q. A rod end is on the left
of link 0, with the wave `incoming[0]`, and on the right of the last link, with
`incoming[1]`. j is a point of the piece: 0 is its start, 1 to N are the stages.
"""

from .. import contact_laws
from ..compiling import borrowed
from ..link import Law
from ..states import Status
from . import series
from .records import NONE, Link, Links, Masses, Node, Run
from .series import POINTS, STAGES, START, TWICE, Matrix, MutableValues, N, Values, X

MAX_NEWTON_STEPS = 30
"""Largest number of Newton steps on one piece; a piece that needs more is shortened."""
DIVERGED = 1e300
"""Relative residual above which Newton's method has diverged."""
PIECE_PER_TRANSIT = 0.1
"""Duration of a typical piece, divided by the shortest transit.

An error of a force is converted to the velocity that it makes in this time.
"""
RESIDUAL_RTOL = 1e-7
"""Largest relative residual of the contact laws before the last Newton step.

Newton's method converges quadratically: the step after it leaves 1e-14, which is
round-off.
"""
CANCELLATION_RTOL = 1e-6
"""Ratio of a force to the terms that cancel in it, below which cancellation matters.

The residual is then relative to this share of the terms, not to the force: a residual
of RESIDUAL_RTOL times the force would be below 1e-13 of the terms, which is round-off.
"""
SWING_FACTOR = 1.1
"""Factor on the deepest value below 0 that was found: the true one may be deeper."""
SWING_ROUND_OFF = 8e-15
"""Round-off of evaluating the polynomial of a force, relative to the largest force."""


# What the links are -------------------------------------------------------------------


def overlap_changes(link: Link) -> bool:
    """Return whether the overlap of a link changes over a piece.

    The overlap is constant in a bond, a push, a contact at rest (REST), and a rigid
    contact that presses. It changes in a joint, although its status is BOND, in a
    compliant contact, and in an open contact, whose gap is minus the overlap.
    """
    if link.status == Status.BOND:  # here the status of bonds, pushes and joints
        return bool(link.law == Law.JOINT)
    is_stiff = link.law == Law.RIGID and link.status == Status.PRESS
    return bool(link.status != Status.REST and not is_stiff)


def elastic_share(link: Link) -> float:
    """Return the elastic share of the overlap rate, d'/(closing - Y F).

    It is the hardening share of a link that yields (PLASTIC), where the rest of the
    rate is plastic deformation. For every other link it is 1.
    """
    if link.status == Status.PLASTIC:
        return link.hardening_share
    return 1.0


def outer_link(node: Node, side: int) -> int:
    """Return the number of the first (side 0) or last (side 1) link of a node."""
    return int(node.first_link + side * (node.link_count - 1))


# Forces and motion --------------------------------------------------------------------


def start_forces(links: Links, node: Node) -> int:
    """Set the known forces of links over a piece, and number the unknown ones.

    Three kinds of force are known: a push on an end of the row; 0 in a contact that is
    open or only touches; and the force of a bond or rigid contact that is the only link
    between two rods, which follows from the incoming waves. All other forces are
    unknown, and set to 0 for now. `unknown_index` of a link becomes the number of its
    unknown force, or NONE if the force is known. Return how many are unknown.
    """
    unknown_count = 0
    for q in range(node.link_count):
        link = links[node.first_link + q]
        is_push = link.law == Law.PUSH_LEFT or link.law == Law.PUSH_RIGHT
        is_bond = link.law == Law.BOND
        is_joint = link.law == Law.JOINT
        # The statuses from PRESS on are those of a contact that presses, yields or
        # rests.
        acts = link.status >= Status.PRESS or is_bond or is_joint
        # If the link is alone between two rods, its force is unknown only where it
        # depends on an overlap that changes.
        link.unknown_index = NONE
        if acts and (node.link_count > 1 or overlap_changes(link)):
            link.unknown_index = unknown_count
            unknown_count += 1
        # The force of a closed link is known only between two rods, at a constant d.
        is_closed = is_bond or link.status == Status.PRESS
        follows_from_waves = is_closed and link.unknown_index == NONE
        for j in range(POINTS):
            if is_push:
                side = link.law - Law.PUSH_LEFT  # 0 for PUSH_LEFT, 1 for PUSH_RIGHT
                link.force[j] = node.incoming[side][j]
            elif follows_from_waves:  # d' = closing - Y F = 0
                closing = node.incoming[0][j] - node.incoming[1][j]
                link.force[j] = closing / link.mobility
            else:  # the force is unknown, or no force acts
                link.force[j] = 0.0
    return unknown_count


def integrate(rate: Values, h: float, f: MutableValues) -> None:
    """Integrate a rate over a piece, from the initial value f[0].

    f[1] to f[N] are set to f[0] plus the integral of the rate from the start of the
    piece to that point. The piece has the duration h, s. `rate`, per s, and f are
    values at the points; `rate[0]`, at the start, is not used.
    """
    for j in range(N):  # stage j is point j + 1
        s = 0.0  # integral over y, from -1 at the start of the piece
        weights = STAGES[j]
        for m in range(N):
            s += weights[m] * rate[m + 1]
        f[j + 1] = f[0] + 0.5 * h * s  # y runs through 2 in the time h


def update_motion(links: Links, masses: Masses, node: Node, h: float) -> None:
    """Set the motion of a node over a piece that follows from the present forces.

    The velocities of the masses, and the closing velocities and overlaps of the links,
    are set at the points of the piece, which has the duration h, s:

    m v' = F_left - F_right,  closing = v_left - v_right,
    d' = share (closing - Y F) with the elastic share.

    They start from the velocities and overlaps at the start of the piece. d stays
    constant where `overlap_changes` is false. The closing velocity of a push has no
    meaning. `scratch_values` of the node is overwritten.
    """
    for i in range(node.link_count - 1):
        left_link = links[node.first_link + i]
        right_link = links[node.first_link + i + 1]
        body = masses[node.first_mass + i]
        for j in range(POINTS):
            net_force = left_link.force[j] - right_link.force[j]
            node.scratch_values[j] = net_force / body.mass  # v'
        integrate(node.scratch_values, h, body.velocity)  # from velocity[0] on
    for q in range(node.link_count):
        link = links[node.first_link + q]
        share = 0.0  # the overlap stays constant
        if overlap_changes(link):
            share = elastic_share(link)
        for j in range(POINTS):
            # At the end of a rod the incoming wave takes the place of the velocity; at
            # a wall `incoming` is the velocity of the wall.
            if q == 0:
                v_left = node.incoming[0][j]
            else:
                v_left = masses[node.first_mass + q - 1].velocity[j]
            if q == node.link_count - 1:
                v_right = node.incoming[1][j]
            else:
                v_right = masses[node.first_mass + q].velocity[j]
            closing = v_left - v_right
            link.closing[j] = closing
            link.overlaps[j] = link.overlap  # overlap at the start of the piece
            # d'
            node.scratch_values[j] = share * (closing - link.mobility * link.force[j])
        if share != 0:
            integrate(node.scratch_values, h, link.overlaps)  # from overlaps[0] on


# Newton's method ----------------------------------------------------------------------


def linearise(link: Link, h: float, is_first: bool) -> float:
    """Set the tangent law of a link at each stage, and return the residual.

    The tangent law is F = base + by_overlap d + by_closing closing, taken at the
    present d and closing. In the first Newton step (`is_first`) d is extrapolated: it
    is d + d' u + d'' u^2/2, with the values at the start of the piece and u the time
    since then, s. The piece has the duration h, s. For a link at rest (REST) `closing`
    takes the place of F: base and by_overlap are 0, by_closing is 1, and the residual
    has no meaning.

    The residual is the largest difference between the force by the contact law and the
    present force, divided by the largest force. Large terms may cancel in the force,
    for instance shortly before damping ends it: then CANCELLATION_RTOL times these
    terms is the divisor. If all forces are 0, the residual is 0.
    """
    residual = 0.0
    largest = 0.0
    for j in range(1, POINTS):
        closing = link.closing[j]
        if is_first:
            u = 0.5 * h * (X[j] + 1)  # time since the start of the piece
            # The mean of d' + d'' t over t from 0 to u
            mean_rate = link.overlap_rate + 0.5 * u * link.overlap_acceleration
            d = link.overlap + u * mean_rate
        else:
            d = link.overlaps[j]
        F, by_overlap, by_closing = contact_laws.force(link, d, closing)
        base = F - by_overlap * d - by_closing * closing
        link.by_overlap[j] = by_overlap
        link.by_closing[j] = by_closing
        link.base[j] = base
        residual = max(residual, abs(F - link.force[j]))
        # The terms that may cancel in F are about as large as `base`.
        largest = max(largest, abs(F), CANCELLATION_RTOL * abs(base))
    if largest > 0:
        return residual / largest
    return 0.0


def linearise_links(links: Links, node: Node, h: float, is_first: bool) -> float:
    """Set the tangent laws of all links of a node whose forces are unknown.

    Return the largest relative residual of the nonlinear laws, see `linearise`. In the
    first Newton step it is set to 1, since the overlaps are only extrapolated. Linear
    laws do not count, as one Newton step solves them: without nonlinear ones 0 is
    returned.
    """
    residual = 0.0
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index != NONE:
            link_residual = linearise(link, h, is_first)
            if contact_laws.is_nonlinear(link):
                if is_first:
                    link_residual = 1.0
                residual = max(residual, link_residual)
    return residual


def set_equations(
    links: Links, masses: Masses, node: Node, h: float, G: Matrix, unknown_count: int
) -> None:
    """Set the linear equations G of a Newton step for the changes of the forces.

    Each of the `unknown_count` forces has an equation at each of the N stages. With the
    `unknown_index` u of a link, row N u + j of `G` is the equation of its force at
    stage j, column N u + j belongs to the change of this force, and column
    N unknown_count is the right side.

    The equation says that F = base + by_overlap d + by_closing closing holds after the
    step: this is the tangent law of the link, which `linearise_links` has set. The left
    side is the change of F minus the changes of d and `closing` times their factors,
    which follow from the changes of all forces of the node, see `set_block`. The right
    side is the force by this law at the present d and closing, minus the present force,
    N. For a link at rest (REST) the equation is 0 = closing, with base = by_overlap = 0
    and by_closing = 1: F is not in it, and the right side is the present `closing`,
    m/s.
    """
    right_side = N * unknown_count
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index == NONE:
            continue
        for p in range(node.link_count):
            unknown = links[node.first_link + p].unknown_index
            if unknown != NONE:
                # The left side: a block in the rows of link q and the columns of the
                # force of link p, the factors of its changes in the equations of q.
                # `is_same` adds the change of F itself.
                by_impulse = closing_by_impulse(masses, node, q, p)
                is_same = p == q
                set_block(link, by_impulse, is_same, h, G, N * unknown)
        for j in range(N):
            if link.status == Status.REST:
                present = 0.0  # 0 = closing takes the place of F = ...
            else:
                present = link.force[j + 1]  # F; stage j is point j + 1
            G[N * link.unknown_index + j][right_side] = (
                link.base[j + 1]
                + link.by_overlap[j + 1] * link.overlaps[j + 1]
                + link.by_closing[j + 1] * link.closing[j + 1]
                - present
            )


def closing_by_impulse(masses: Masses, node: Node, q: int, p: int) -> float:
    """Return the change of the closing velocity of link q by an impulse in link p.

    It is the change for an impulse of 1 N s, 1/kg. An impulse in link q itself drives
    the masses on both sides apart: -1/m_left - 1/m_right. An impulse in a neighbouring
    link pushes the mass m between both links towards link q: 1/m. Links further away
    change nothing: 0. The end of a rod counts as infinitely heavy here, since its
    motion is in the term Y F.
    """
    # 1/m of the masses on both sides of link q, which are the masses q - 1 and q of the
    # node; 0 for the end of a rod
    inverse_left = 0.0
    inverse_right = 0.0
    if q > 0:
        inverse_left = 1 / masses[node.first_mass + q - 1].mass
    if q < node.link_count - 1:
        inverse_right = 1 / masses[node.first_mass + q].mass
    if p == q:
        return -inverse_left - inverse_right
    if p == q - 1:
        return inverse_left
    if p == q + 1:
        return inverse_right
    return 0.0


def set_block(
    link: Link, by_impulse: float, is_same: bool, h: float, G: Matrix, column: int
) -> None:
    """Set the N by N block of G in the rows of a link, from `column` on.

    The columns of the block belong to the force of a second link, which may be the same
    link (`is_same`). `by_impulse` is the change of the closing velocity of `link` by an
    impulse of 1 N s in the second link, 1/kg. h is the duration of the piece, s. If the
    second force changes by x at the stages,

        closing changes by (h/2) by_impulse S x,
        d changes by share (h/2) S (change of closing - Y x); Y x only if `is_same`,

    with the matrices of integration S = STAGES and S S = TWICE, and the elastic share.
    By the tangent law this changes the force of `link` by (a S + b S S) x. The block is
    I - a S - b S S. I is the identity matrix for the same link, unless it is at rest,
    and 0 otherwise.
    """
    half_duration = 0.5 * h
    closing_factor = half_duration * by_impulse  # closing changes by this times S x
    overlap_factor = half_duration * elastic_share(link)
    own_factor = 0.0  # share (h/2) Y for the same link
    identity = 0.0  # diagonal of I
    if is_same:
        own_factor = overlap_factor * link.mobility
        if link.status != Status.REST:
            identity = 1.0
    # A force changes the velocity of a mass, and the velocity changes the overlap: two
    # integrals, S S. No mass takes part if `by_impulse` is 0, and no column gets S S.
    if by_impulse == 0:
        twice_columns = 0
    else:
        twice_columns = N
    for j in range(N):
        row = G[N * link.unknown_index + j]
        stages = STAGES[j]
        twice = TWICE[j]
        # Stage j is point j + 1.
        by_closing = link.by_closing[j + 1]
        by_overlap = link.by_overlap[j + 1]
        a = by_closing * closing_factor - by_overlap * own_factor
        b = by_overlap * overlap_factor * closing_factor
        for m in range(N):
            row[column + m] = -a * stages[m]
        for m in range(twice_columns):
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
    """Take a Newton step: add the changes to the forces, and update the motion.

    The changes of the `unknown_count` forces are in column N unknown_count of G. h is
    the duration of the piece, s.

    The integral that gives the overlap of a stiff link is a small difference of large
    numbers. It is replaced by d = (F - base - by_closing closing)/by_overlap, from the
    tangent law. A link counts as stiff at a stage where the velocity scale would change
    its force in the time h by more than the force itself.
    """
    solution_column = N * unknown_count
    for q in range(node.link_count):
        link = links[node.first_link + q]
        stages = N  # number of stages at which the force changes
        if link.unknown_index == NONE:
            stages = 0  # its force is known
        for j in range(stages):  # stage j is point j + 1
            link.force[j + 1] += G[N * link.unknown_index + j][solution_column]
    update_motion(links, masses, node, h)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index != NONE and overlap_changes(link):
            for j in range(1, POINTS):
                typical_rise = link.by_overlap[j] * run.velocity_scale * h  # N
                if typical_rise > abs(link.force[j]):  # it is stiff
                    closing_force = link.by_closing[j] * link.closing[j]  # N
                    overlap_force = link.force[j] - link.base[j] - closing_force  # N
                    link.overlaps[j] = overlap_force / link.by_overlap[j]


def collocate(
    run: Run, links: Links, masses: Masses, node: Node, h: float, G: Matrix
) -> bool:
    """Solve a node over a piece; return whether Newton's method converged.

    The piece has the duration h, s. Forces, velocities, closing velocities and overlaps
    at the points of the piece are set. They follow from the incoming waves of the node,
    and from the states of its links and masses at the start of the piece. G is scratch.
    False is returned if Newton's method diverges, or would need more than
    MAX_NEWTON_STEPS.

    Radau IIA is stiffly accurate: contacts with much shorter time constants than h do
    no harm.
    """
    # For speed: machine code does not count references to borrowed arrays.
    links = borrowed(links)
    masses = borrowed(masses)
    G = borrowed(G)
    unknown_count = start_forces(links, node)
    # Residual before the last step: another step follows if it was large. It starts at
    # 1, so that there is a first step.
    residual = 1.0
    steps = 0
    update_motion(links, masses, node, h)
    while unknown_count > 0 and residual >= RESIDUAL_RTOL:
        has_diverged = not residual < DIVERGED  # true for NaN, too
        if steps == MAX_NEWTON_STEPS or has_diverged:
            return False
        is_first_step = steps == 0
        residual = linearise_links(links, node, h, is_first_step)
        set_equations(links, masses, node, h, G, unknown_count)
        # Only neighbouring links are coupled: all coefficients are less than 2 N from
        # the diagonal.
        band = 2 * N
        series.eliminate(G, N * unknown_count, band)
        take_step(run, links, masses, node, h, G, unknown_count)
        steps += 1
    set_initial_forces(links, node)
    return True


def set_initial_forces(links: Links, node: Node) -> None:
    """Set the unknown forces at point 0, the start of a piece, and their derivatives.

    Newton's method has found them at the stages only. The contact laws give them at the
    start, from the overlap and the closing velocity there. The force between bodies at
    rest (REST) follows no law: it is extrapolated from the stages, and its derivatives
    are left as they are.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.status == Status.REST:
            # `start_forces` has set force[0] to 0. Stage j is point j + 1.
            for j in range(N):
                link.force[0] += START[j] * link.force[j + 1]
        elif link.unknown_index != NONE:
            force, by_overlap, by_closing = contact_laws.force(
                link, link.overlap, link.closing[0]
            )
            link.force[0] = force
            link.by_overlap[0] = by_overlap
            link.by_closing[0] = by_closing


# After the solution -------------------------------------------------------------------


def forbid_pulling(links: Links, node: Node) -> None:
    """Remove negative values from the forces of the contacts of a node over a piece.

    Where a force falls to 0, its polynomial may fall slightly below 0. Let m > 0
    (`swing`) be at least as large as its deepest value below 0, and J the integral of F
    over y from -1 to 1. Then F is replaced by (F + m) J/(J + 2 m), which is never
    negative. It has the integral J, too, as 2 m is that of m: the impulse does not
    change. If J is not positive, F becomes 0. Nothing but forces is changed. Forces of
    bonds and joints may be negative, and stay.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        largest = series.largest(link.force)
        smallest_at_points = series.smallest(link.force)
        # If the force is well above 0 at all points, it is positive between them, too.
        may_swing = smallest_at_points < series.POSITIVE_RTOL * largest
        # The statuses from PRESS on are those of contacts that press, yield or rest.
        if link.status >= Status.PRESS and may_swing:
            # This sets `scratch_series` to the coefficients of the force.
            series.set_series(link.force, node.scratch_series)
            # The minimum of the polynomial, between the points, too. If it is well
            # above 0, `swing` is negative, and the force stays as it is.
            depth = -series.minimum(node.scratch_series)
            swing = SWING_FACTOR * depth + SWING_ROUND_OFF * largest
            impulse = series.integral(link.force)  # J, N
            if swing > 0:
                if impulse > 0:
                    share = impulse / (impulse + 2 * swing)
                else:
                    share = 0.0
                for j in range(POINTS):
                    link.force[j] = max(0.0, (link.force[j] + swing) * share)


def set_outgoing(links: Links, node: Node, side: int) -> None:
    """Set `node.outgoing` to the wave that leaves a node on a side, m/s.

    The piece has been solved; the wave is set at its points. On the left (side 0) the
    wave a comes in and a - 2 F/Z leaves, with the force F of the first link. On the
    right (side 1) the wave b comes in and b + 2 F/Z leaves, with the force F of the
    last link.
    """
    link = links[outer_link(node, side)]
    mobility = node.mobility[side]  # 1/Z
    velocity_by_force = (4 * side - 2) * mobility  # -2/Z on the left, 2/Z on the right
    incoming = node.incoming[side]
    for j in range(POINTS):
        node.outgoing[j] = incoming[j] + velocity_by_force * link.force[j]


def velocity_by_input(links: Links, node: Node, side: int) -> float:
    """Return the velocity that a unit of `node.incoming` on a side makes, m/s.

    It is 1 if `incoming` is a wave, m/s. At a pushed end `incoming` is a force F, N,
    that makes the wave 2 F `effective_mobility`.
    """
    link = links[outer_link(node, side)]
    velocity = 1.0
    # PUSH_LEFT belongs to side 0, PUSH_RIGHT = PUSH_LEFT + 1 to side 1.
    if link.law == Law.PUSH_LEFT + side:
        velocity = 2 * link.effective_mobility
    return velocity


def truncation_error(links: Links, masses: Masses, node: Node) -> float:
    """Return the truncation error of a piece, m/s: the largest tail of its series.

    The tail of a series is its last two coefficients, see `series.truncation_estimate`.
    The series are those of incoming waves, leaving waves, velocities of masses, pushes,
    and forces of links whose overlap changes. Incoming waves count too, as they may
    cancel in the leaving ones. Forces are converted to velocities: a push F to
    2 F `effective_mobility`, the force of a link to the velocity that it makes in a
    typical piece. The force of a link that is alone in its node does not count, as it
    is seen in the leaving waves. `node.outgoing` is overwritten.
    """
    worst = 0.0
    for side in range(2):
        error = series.truncation_estimate(node.incoming[side])
        worst = max(worst, error * velocity_by_input(links, node, side))
        if node.mobility[side] > 0:  # there is a rod, into which a wave leaves
            set_outgoing(links, node, side)
            worst = max(worst, series.truncation_estimate(node.outgoing))
    for i in range(node.link_count - 1):
        body = masses[node.first_mass + i]
        worst = max(worst, series.truncation_estimate(body.velocity))
    if node.link_count == 1:
        counted_links = 0  # the force of this link is seen in the leaving waves
    else:
        counted_links = node.link_count
    for q in range(counted_links):
        link = links[node.first_link + q]
        if overlap_changes(link):
            # `effective_mobility` is the velocity that 1 N makes in a whole transit.
            velocity_by_force = PIECE_PER_TRANSIT * link.effective_mobility
            error = velocity_by_force * series.truncation_estimate(link.force)
            worst = max(worst, error)
    return worst


def wave_remainder(links: Links, node: Node, integrated: bool) -> float:
    """Return the largest estimated error of the waves of a piece, m/s.

    It is the `series.remainder` of the waves that arrive at the node and that leave it,
    or of their integrals over y if `integrated`. A push F counts as the wave
    2 F `effective_mobility`, as in `truncation_error`. `node.outgoing` is overwritten.
    """
    largest = 0.0
    for side in range(2):
        error = series.remainder(node.incoming[side], integrated)
        largest = max(largest, error * velocity_by_input(links, node, side))
        if node.mobility[side] > 0:  # there is a rod, into which a wave leaves
            set_outgoing(links, node, side)
            largest = max(largest, series.remainder(node.outgoing, integrated))
    return largest


def restrict_piece(links: Links, masses: Masses, node: Node, y: float) -> None:
    """Shorten a solved piece of a node: keep the part from its start to y.

    y is -1 at the start of the piece and 1 at its end. Incoming waves, forces,
    overlaps, closing velocities and velocities of masses get the values of the same
    polynomials at the points of the part. `node.scratch_series` is overwritten.
    """
    for side in range(2):
        series.restrict(node.incoming[side], y, node.scratch_series)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        series.restrict(link.force, y, node.scratch_series)
        series.restrict(link.overlaps, y, node.scratch_series)
        series.restrict(link.closing, y, node.scratch_series)
    for i in range(node.link_count - 1):
        body = masses[node.first_mass + i]
        series.restrict(body.velocity, y, node.scratch_series)
