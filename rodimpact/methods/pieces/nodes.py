"""One piece of a node.

A node is the chain of links and masses between two rods, driven by two waves.

In every link acts a force F. All else follows from the forces: velocities of the
masses, then the closing rates without own force, then the overlaps,

    m v' = F before - F behind,    closing = velocity on the left - on the right,
    d' = closing - Y F,            Y the mobility of the link,

where a rod's end counts with the wave that comes in. Forces that depend on this are
found by collocation (Radau IIA) and Newton's method.

Indices: link q of a node lies between its masses q - 1 and q. In front of link 0 and
behind the last link are the ends of rods, with `incoming[0]` on the left and
`incoming[1]` on the right. j is a point of the piece: 0 its start, 1 to N the stages.
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
DIVERGED = 1e300
"""Relative residual from which a Newton iteration has no solution."""
PIECE_PER_TRANSIT = 0.1
"""Duration of a typical piece over the shortest transit.

It makes the tail of a force a velocity: a force acts for about so long before the next
piece.
"""
RESIDUAL_RTOL = 1e-7
"""Residual of the contact laws before the last Newton step, relative to the force.

Newton's method converges quadratically: the step after it leaves 1e-14, which is
round-off.
"""
CANCELLATION_RTOL = 1e-6
"""Force over the terms that cancel in it, below which these measure its residual.

A residual of RESIDUAL_RTOL times the force would then be below 1e-13 of the terms:
round-off.
"""
SWING_FACTOR = 1.1
"""Factor on the deepest swing below 0 of samples: the true one is little deeper."""
SWING_ROUND_OFF = 8e-15
"""Round-off of evaluating the polynomial of a force, over the largest force."""


# What the links are -------------------------------------------------------------------


def overlap_changes(link: Link) -> bool:
    """Return whether the overlap of a link changes over a piece.

    That of a bond, of bodies at rest, and of a rigid contact that presses is constant.
    That of a joint, which has the status BOND, changes; so does that of an open
    contact, as a gap.
    """
    if link.status == Status.BOND:
        return bool(link.law == Law.JOINT)
    is_stiff = link.law == Law.RIGID and link.status == Status.PRESS
    return bool(link.status != Status.REST and not is_stiff)


def elastic_share(link: Link) -> float:
    """Return the elastic part of the overlap rate, over the whole: d'/(closing - Y F).

    It is 1, but for a link that yields: there it is the hardening share, and the rest
    is plastic.
    """
    if link.status == Status.PLASTIC:
        return link.hardening_share
    return 1.0


def outer_link(node: Node, side: int) -> int:
    """Return the number of the first (side 0) or last (side 1) link of a node."""
    return int(node.first_link + side * (node.link_count - 1))


# Forces and motion --------------------------------------------------------------------


def start_forces(links: Links, node: Node) -> int:
    """Start a piece: set given forces of links, and number the unknown ones.

    Given are pushes on the ends, 0 in contacts that are open or only touch, and the
    force of a bond or rigid contact alone between two rods, which follows from the
    waves. An unknown force is 0 until it is found; its number is `unknown_index`, NONE
    of a given one. Return the number of unknown forces.
    """
    unknown_count = 0
    for q in range(node.link_count):
        link = links[node.first_link + q]
        is_push = link.law == Law.PUSH_LEFT or link.law == Law.PUSH_RIGHT
        is_bond = link.law == Law.BOND
        # A contact from PRESS on presses, yields or rests.
        acts = link.status >= Status.PRESS or is_bond or link.law == Law.JOINT
        # Alone between two rods, only a force by a law of the overlap is unknown.
        link.unknown_index = NONE
        if acts and (node.link_count > 1 or overlap_changes(link)):
            link.unknown_index = unknown_count
            unknown_count += 1
        holds = is_bond or link.status == Status.PRESS
        follows_from_waves = holds and link.unknown_index == NONE
        for j in range(POINTS):
            if is_push:
                side = link.law - Law.PUSH_LEFT  # 0 for PUSH_LEFT, 1 for PUSH_RIGHT
                link.force[j] = node.incoming[side][j]
            elif follows_from_waves:  # both faces have one velocity: closing - Y F = 0
                closing = node.incoming[0][j] - node.incoming[1][j]
                link.force[j] = closing / link.mobility
            else:  # it is unknown, or no force acts
                link.force[j] = 0.0
    return unknown_count


def integrate(rate: Values, h: float, f: MutableValues) -> None:
    """Set f after f[0] to f[0] plus the integral of a rate.

    The piece has the duration h, s. f and the rate, which is the rate per s, are values
    at the points; that of the rate at the start is not used.
    """
    for j in range(N):
        s = 0.0  # integral over y, from -1 at the start of the piece to 1 at its end
        stages = STAGES[j]
        for m in range(N):
            s += stages[m] * rate[m + 1]
        f[j + 1] = f[0] + 0.5 * h * s


def update_motion(links: Links, masses: Masses, node: Node, h: float) -> None:
    """Set velocities of masses, and closing and overlaps of links, by present forces.

    They are those at the points of a piece of duration h, s, from the states at its
    start:

    m v' = F before - F behind,  closing = velocity on the left - on the right,
    d' = share (closing - Y F) with the elastic share; d stays where `overlap_changes`
    is false.

    `scratch_values` of the node holds derivatives meanwhile.
    """
    for i in range(node.link_count - 1):
        before = links[node.first_link + i]
        behind = links[node.first_link + i + 1]
        body = masses[node.first_mass + i]
        for j in range(POINTS):
            node.scratch_values[j] = (before.force[j] - behind.force[j]) / body.mass
        integrate(node.scratch_values, h, body.velocity)  # from velocity[0] on
    for q in range(node.link_count):
        link = links[node.first_link + q]
        share = 0.0
        if overlap_changes(link):
            share = elastic_share(link)
        for j in range(POINTS):
            # An end of a rod counts with the wave that comes in.
            if q == 0:
                left = node.incoming[0][j]
            else:
                left = masses[node.first_mass + q - 1].velocity[j]
            if q == node.link_count - 1:
                right = node.incoming[1][j]
            else:
                right = masses[node.first_mass + q].velocity[j]
            closing = left - right
            link.closing[j] = closing
            link.overlaps[j] = link.overlap  # that at the start of the piece
            node.scratch_values[j] = share * (closing - link.mobility * link.force[j])
        if share != 0:
            integrate(node.scratch_values, h, link.overlaps)  # from overlaps[0] on


# Newton's method ----------------------------------------------------------------------


def linearise(link: Link, h: float, is_first: bool) -> float:
    """Set the tangent of the force of a link at each stage, and return the residual.

    The tangent is F = base + by_overlap d + by_closing closing. In the first Newton
    step it is taken at the extrapolated overlap d + d' u + d'' u^2/2, u the time since
    the start of the piece, whose duration is h, s.

    The residual is the largest difference of the law from the present force, relative
    to the largest force, or to the round-off of the terms that cancel in it: a law with
    damping has almost no force where bodies part almost as fast as it lets go. Without
    any force it is 0.
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
        largest = max(largest, abs(F), CANCELLATION_RTOL * abs(base))
    if largest > 0:
        return residual / largest
    return 0.0


def linearise_links(links: Links, node: Node, h: float, is_first: bool) -> float:
    """Linearise all links of a node whose forces are unknown.

    Return the largest residual of the nonlinear laws, in the first step 1, as its
    tangents are taken at an extrapolation. A linear law needs one Newton step, whatever
    its residual: without others 0 is returned.
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
    """Set the equations G of a Newton step, so that forces fulfil the tangent laws.

    Each of the `unknown_count` forces has an equation at each of the N stages: that of
    force u at stage j is row N u + j of `G`, and its change is column N u + j. The
    column behind these is the right side.

    The tangent law of a link, which `linearise_links` has set, is F = base + by_overlap
    d + by_closing closing, with d and closing after the step. So the right side is the
    force by the law at the present d and closing, less the present force, N. A link at
    rest (REST) has no law: its force makes `closing` 0, and the right side is the
    present `closing`, m/s.
    """
    right_side = N * unknown_count
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index == NONE:
            continue
        for p in range(node.link_count):
            unknown = links[node.first_link + p].unknown_index
            if unknown != NONE:
                by_impulse = closing_by_impulse(masses, node, q, p)
                is_same = p == q
                set_block(link, by_impulse, is_same, h, G, N * unknown)
        for j in range(N):
            if link.status == Status.REST:
                present = 0.0  # its tangent is that of `closing`, not of a force
            else:
                present = link.force[j + 1]  # stage j is point j + 1
            G[N * link.unknown_index + j][right_side] = (
                link.base[j + 1]
                + link.by_overlap[j + 1] * link.overlaps[j + 1]
                + link.by_closing[j + 1] * link.closing[j + 1]
                - present
            )


def closing_by_impulse(masses: Masses, node: Node, q: int, p: int) -> float:
    """Return the change of the closing of link q by a unit impulse in link p, 1/kg.

    An impulse in the link itself drives the masses on both sides apart: -1/m_left -
    1/m_right. One in a neighbour pushes the mass between them towards link q: 1/m.
    Links further away change nothing: 0. The end of a rod counts as a mass without end.
    """
    # 1/m of the masses on both sides of link q; 0 for the end of a rod
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
    """Set the N by N block of G in the rows of a link, from `column` on.

    Its columns are the forces of a second link, which may be the same. `by_impulse` is
    the change of the closing rate of `link` by a unit impulse in the second one, 1/kg;
    `is_same` says that both are one. Changes x of the second force, at the stages,
    change

        closing by (h/2) by_impulse S x,
        d by share (h/2) S (change of closing - Y x if same),

    with S = STAGES, S S = TWICE and the elastic share. The block is I - a S - b S S,
    where (a S + b S S) x is the change of the force by the tangent law of `link`, and I
    is 1 for the same link, unless it is at rest, else 0.
    """
    half = 0.5 * h
    closing_factor = half * by_impulse  # closing changes by this times S x
    overlap_factor = half * elastic_share(link)  # d by this times S (...)
    own_factor = 0.0  # share (h/2) Y, if same
    identity = 0.0
    if is_same:
        own_factor = overlap_factor * link.mobility
        if link.status != Status.REST:
            identity = 1.0
    # Columns to which S S adds: a force changes the velocity of a mass, and that the
    # overlap. Without a mass between both links `by_impulse` is 0.
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
    """Add the changes of forces to the forces, and update the motion.

    The changes are the last column of G. A link is stiff where the velocity scale would
    change its force in the time h by more than the force itself. Its overlap, a small
    difference of large numbers, is then not the integral of the closing rate, but d =
    (F - base - by_closing closing)/by_overlap, from its tangent law.
    """
    solution = N * unknown_count  # column of G with the changes
    for q in range(node.link_count):
        link = links[node.first_link + q]
        stages = N
        if link.unknown_index == NONE:
            stages = 0  # its force is given and does not change
        for j in range(stages):
            link.force[j + 1] += G[N * link.unknown_index + j][solution]
    update_motion(links, masses, node, h)
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.unknown_index != NONE and overlap_changes(link):
            for j in range(1, POINTS):
                typical_rise = link.by_overlap[j] * run.velocity_scale * h  # N
                if typical_rise > abs(link.force[j]):  # it is stiff
                    damped = link.by_closing[j] * link.closing[j]
                    elastic = link.force[j] - link.base[j] - damped
                    link.overlaps[j] = elastic / link.by_overlap[j]


def collocate(
    run: Run, links: Links, masses: Masses, node: Node, h: float, G: Matrix
) -> bool:
    """Solve a node over a piece; return whether Newton's method converged.

    The piece has the duration h, s. Forces, velocities, closing rates and overlaps at
    the points of the piece are set, from the incoming waves of the node and the states
    of its links and masses. G is scratch. Newton's method fails if it diverges, or
    takes more than MAX_NEWTON_STEPS.

    Radau IIA is stiffly accurate: contacts far stiffer than the piece is long do no
    harm.
    """
    # Machine code counts no references to borrowed arrays.
    links = borrowed(links)
    masses = borrowed(masses)
    G = borrowed(G)
    # Given forces are set here, the unknown ones counted.
    unknown_count = start_forces(links, node)
    # Residual before the last step: if it was large, another step follows. No step was
    # taken yet, so that the number here is any large one.
    residual = 1.0
    steps = 0
    update_motion(links, masses, node, h)
    while unknown_count > 0 and residual >= RESIDUAL_RTOL:
        if steps == MAX_NEWTON_STEPS or not residual < DIVERGED:  # NaN is not below it
            return False
        is_first_step = steps == 0
        residual = linearise_links(links, node, h, is_first_step)
        set_equations(links, masses, node, h, G, unknown_count)
        # The forces of neighbours are coupled, whose columns are less than 2 N apart.
        series.eliminate(G, N * unknown_count, 2 * N)
        take_step(run, links, masses, node, h, G, unknown_count)
        steps += 1
    set_initial_forces(links, node)
    return True


def set_initial_forces(links: Links, node: Node) -> None:
    """Set the unknown forces at the start of a piece, and their derivatives.

    The contact laws give them, by the state of the link and its closing at the start.
    The force between bodies at rest follows no law: it is extrapolated from the stages,
    and its derivatives stay.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        if link.status == Status.REST:
            # `start_forces` has set force[0] to 0.
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
    """Let no contact of a node pull at any time in the piece.

    Only its forces are changed, and their impulse stays as before. Where a force falls
    to 0 its polynomial may swing below 0 by about the tolerance. Let m > 0 (`swing`) be
    at least as large as that, and J the integral of F over y, whose duration is 2. Then
    (F + m) J/(J + 2 m) is never negative and has the integral J, too: it takes the
    place of F. If J is not positive, F becomes 0.
    """
    for q in range(node.link_count):
        link = links[node.first_link + q]
        largest = series.largest(link.force)
        smallest = series.smallest(link.force)
        # If the force is well above 0 at all points, it has no zero between them.
        may_swing = smallest < series.POSITIVE_RTOL * largest
        # From PRESS on: a contact that presses, yields or rests, and no bond or joint
        if link.status >= Status.PRESS and may_swing:
            # This sets `scratch_series` to the coefficients of the force.
            series.set_series(link.force, node.scratch_series)
            # A minimum well above 0 makes `swing` negative: the force stays as it is.
            deepest = -series.minimum(node.scratch_series)
            swing = SWING_FACTOR * deepest + SWING_ROUND_OFF * largest
            impulse = series.integral(link.force)
            if swing > 0:
                if impulse > 0:
                    share = impulse / (impulse + 2 * swing)  # it keeps the impulse
                else:
                    share = 0.0
                for j in range(POINTS):
                    link.force[j] = max(0.0, (link.force[j] + swing) * share)


def set_outgoing(links: Links, node: Node, side: int) -> None:
    """Set `node.outgoing` to the wave that leaves a node on a side, m/s.

    It is that at the points of the piece. On the left (side 0) the wave a comes in and
    a - 2 F/Z leaves, F the force of the first link. On the right (side 1) b comes in
    and b + 2 F/Z leaves, F the force of the last link.
    """
    link = links[outer_link(node, side)]
    mobility = node.mobility[side]
    velocity_by_force = (4 * side - 2) * mobility  # -2/Z on the left, 2/Z on the right
    incoming = node.incoming[side]
    for j in range(POINTS):
        node.outgoing[j] = incoming[j] + velocity_by_force * link.force[j]


def truncation_error(links: Links, masses: Masses, node: Node) -> float:
    """Return the truncation error of a piece, m/s: the largest tail of its series.

    The series are those of incoming and leaving waves, of velocities of masses, and of
    forces; `node.outgoing` is overwritten. Incoming waves count too, as they may cancel
    in leaving ones. Forces count as velocities: a push as 2 Y F, the force of a link as
    the velocity that it makes in a typical piece. That of a single link between two
    rods is seen in the waves.
    """
    worst = 0.0
    for side in range(2):
        link = links[outer_link(node, side)]
        # PUSH_LEFT is of side 0, PUSH_RIGHT, the next number, of side 1.
        if link.law == Law.PUSH_LEFT + side:  # the input on this side is a force
            velocity_by_input = 2 * link.effective_mobility
        else:  # it is a wave
            velocity_by_input = 1.0
        error = series.truncation_estimate(node.incoming[side]) * velocity_by_input
        worst = max(worst, error)
        if node.mobility[side] > 0:  # there is a rod, into which a wave leaves
            set_outgoing(links, node, side)
            worst = max(worst, series.truncation_estimate(node.outgoing))
    for i in range(node.link_count - 1):
        body = masses[node.first_mass + i]
        worst = max(worst, series.truncation_estimate(body.velocity))
    if node.link_count == 1:
        count = 0  # the force between two rods is seen in the leaving waves
    else:
        count = node.link_count
    for q in range(count):
        link = links[node.first_link + q]
        if overlap_changes(link):
            # Velocity that 1 N makes in a typical piece;
            # the mobility is that of a whole transit.
            velocity_by_force = PIECE_PER_TRANSIT * link.effective_mobility
            error = velocity_by_force * series.truncation_estimate(link.force)
            worst = max(worst, error)
    return worst


def wave_remainder(links: Links, node: Node, integrated: bool) -> float:
    """Return the largest `series.remainder` of the waves of a piece, m/s.

    They are those that arrive and leave. The remainder is an estimate of their error,
    or of the error of their integrals if `integrated`. `node.outgoing` is overwritten.
    """
    largest = 0.0
    for side in range(2):
        largest = max(largest, series.remainder(node.incoming[side], integrated))
        if node.mobility[side] > 0:  # there is a rod, into which a wave leaves
            set_outgoing(links, node, side)
            largest = max(largest, series.remainder(node.outgoing, integrated))
    return largest


def restrict_piece(links: Links, masses: Masses, node: Node, y: float) -> None:
    """Cut a piece of a node at y, and keep the part before.

    y is -1 at its start and 1 at its end. The values of its incoming waves, forces,
    overlaps, closing rates and velocities become those of the same polynomials at the
    points of that part. `node.scratch_series` is overwritten.
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
