"""Links on a time step: their laws, and chains of links that are solved together.

A force F > 0 in a link pushes two bodies apart. Over one step the bodies obey linear
laws, so the links close by w = force_free_closing - A F with a tridiagonal Stieltjes
matrix A: the closing of a link depends on its own force and, through the bodies between
the links, on the forces of its two neighbours. The law of the link gives F as a
function of w.

A compliant contact has the overlap x. Its mean force over a step is
(U(x1) - U(x0))/(x1 - x0) with its stored energy U (discrete gradient: Gonzalez, J.
Nonlinear Sci. 6, 1996), plus the mean force of its dashpot over the same path. It never
pulls. This force is convex and increasing in x1, so Newton's method converges to the
root from the right. A joint is a spring and a dashpot that can also pull. A yielding
contact is a spring up to its yield force; x is counted from the permanently displaced
faces. A rigid contact has the force that keeps its closing at or below `max_closing`.
An impact of rigid bodies has the force that leaves a closing velocity of at most -e
times the one before (Moreau, CISM 302, 1988).

Units are those of `records`.
"""

import math
from typing import Any

from .. import contact_laws
from ..link import Law
from .records import Link

EPS = 1 / (1 << 52)  # relative spacing of floats
UNSOLVED_RTOL = 1 / (1 << 24)
"""Change of closings, over the largest speed, above which a chain is not solved."""
NEWTON_RTOL = 1 / (1 << 27)
"""Relative Newton step after which the next step is round-off.

Convergence is quadratic.
"""
MAX_NEWTON_STEPS = 100
"""Largest number of iterations for one contact, not reached in practice."""
MAX_SWEEPS = 2000
"""Largest number of sweeps over one chain, see `solve_chain`."""


def solve_link(link: Link, c: float) -> tuple[float, float, float]:
    """Find the mean force F of a compliant contact, or of a joint, in this step.

    The equation x1 = x0 + c - y F(x0, x1), with the self mobility y, is solved for F
    and the overlap x1 at the end of the step. For a contact F is
    `contact_laws.mean_force`, which is not negative, and the equation is solved by
    Newton's method. The first guess is link.overlap, except for a yielding contact.
    After `MAX_NEWTON_STEPS` the last iterate is returned, without an error. A joint may
    pull, see `solve_joint`. The link is not changed.

    Parameters
    ----------
    link : Link
        The overlap x0 at the start of the step is -link.gap.
    c : float
        Closing in this step without the link's own force, m/s.

    Returns
    -------
    F, x1, dF/dx1
        In N, m/s (time is counted in steps) and N per m/s.
    """
    if link.law == Law.JOINT:
        return solve_joint(link, c)
    x0 = -link.gap
    y = link.self_mobility
    free_x1 = x0 + c  # x1 without the link's own force, an upper bound of x1
    # x is the iterate for x1. The first guess is, if possible, on the right of the
    # root: the residual x - free_x1 + y F(x0, x) increases with x and is 0 at the root.
    yields = False  # whether x1 is beyond the overlap at which the contact yields
    if link.law == Law.YIELD:
        elastic_limit = link.yield_force / link.stiffness
        force_at_limit, _ = contact_laws.mean_force(link, x0, elastic_limit)
        residual_at_limit = elastic_limit - free_x1 + y * force_at_limit
        yields = residual_at_limit < 0  # then the root is beyond the limit
        if yields:
            x = free_x1
        else:
            x = min(elastic_limit, free_x1)  # both are upper bounds of x1
    else:
        x = min(link.overlap, free_x1)
    # Newton's method
    F = 0.0
    slope = 0.0  # dF/dx1
    for _ in range(MAX_NEWTON_STEPS):
        F, slope = contact_laws.mean_force(link, x0, x)
        residual = x - free_x1 + y * F
        # For a contact that yields the mean force is not convex, but its work is. So
        # Newton's method is applied to (x - x0) residual. Its derivative, divided by
        # x - x0, is 1 + y slope (that of the residual) plus residual/(x - x0).
        further_slope = 0.0
        if yields:
            further_slope = residual / (x - x0)
        newton_step = residual / (1 + y * slope + further_slope)
        F = F - slope * newton_step  # the force at the new x, to first order
        x = min(x - newton_step, free_x1)
        # The Newton step is compared with the overlap, or, if the contact opens in this
        # step, with the change of the gap.
        if x > 0:
            size = x
        else:
            size = x0 - x
        # In a soft contact (y slope <= 1) x has the round-off of x0 + c. In a stiff
        # contact the overlap is much smaller than the closing that it stops. The
        # factor 4 is a margin.
        round_off = 0.0
        if y * slope <= 1:
            round_off = 4 * EPS * (abs(x0) + abs(c))
        if abs(newton_step) <= max(NEWTON_RTOL * size, round_off):
            break
    if y * slope > 1:
        # For a stiff contact the equation gives F more accurately than the law, because
        # x is small.
        F = (free_x1 - x) / y
    return max(F, 0 * F), x, slope  # 0 * F is the 0 of the same number type


def solve_joint(link: Link, c: float) -> tuple[float, float, float]:
    """Find the mean force of a joint in this step; it may pull (F < 0).

    Arguments and results are those of `solve_link`: F, x1, dF/dx1. With the stiffness k
    and the damping d the force is linear: F = k (x0 + x1)/2 + d (x1 - x0), which is
    k x0 + slope (x1 - x0). Together with x1 - x0 = c - y F this is solved for F.
    """
    x0 = -link.gap
    y = link.self_mobility
    k = link.stiffness
    slope = k / 2 + link.damping
    divisor = 1 + y * slope
    F = (k * x0 + slope * c) / divisor
    x1 = x0 + (c - y * k * x0) / divisor  # this is x0 + c - y F
    return F, x1, slope


def closing_without_own_force(links: Any, i: int) -> float:
    """Closing of link i in this step if its own force were 0, m/s.

    It is the closing without any forces plus the closings by the present forces of the
    links before and after it. Nothing is changed.
    """
    link = links[i]
    # Indices wrap around: -1 is the last link, and after the last link comes the first.
    # This does no harm, as the coupling between two chains is 0.
    before = links[i - 1]
    after = links[i + 1 - len(links)]
    by_before = link.coupling_mobility * before.force
    by_after = after.coupling_mobility * after.force
    c: float = link.force_free_closing + by_before + by_after
    return c


def gauss_seidel_sweep(
    links: Any, first: int, last: int, speed: float
) -> tuple[float, float]:
    """Set the forces of the links of a chain once, one after the other.

    Each force is found from the present forces of the other links. A rigid contact or
    an impact has F = max(0, (c - max_closing)/mobility), where c is its closing without
    F; other links are solved by `solve_link`. `force` and `force_slope` of the links
    are set, and `overlap` of those that are neither rigid nor impacts. A rigid contact
    or impact with a force has the slope -1, as its closing is fixed.

    Parameters
    ----------
    links : list of LINK
    first, last : int
        First and last link of the chain.
    speed : float
        Largest speed of the bodies, m/s.

    Returns
    -------
    float
        Largest change in this sweep of a force times the mobility of its link, m/s.
    float
        `speed` plus the largest force times mobility after the sweep, m/s.
    """
    change = 0.0
    largest_speed = speed
    for i in range(first, last + 1):
        link = links[i]
        c = closing_without_own_force(links, i)
        has_max_closing = link.law == Law.RIGID or link.law == Law.IMPACT
        if has_max_closing:
            F = (c - link.max_closing) / link.self_mobility
            slope = -1.0  # the closing is fixed
            if F <= 0:  # the closing is less than `max_closing` without a force
                F = 0.0
                slope = 0.0
        else:
            F, link.overlap, slope = solve_link(link, c)
        change_of_force = abs(F - link.force)
        change = max(change, change_of_force * link.self_mobility)
        link.force = F
        link.force_slope = slope
        largest_speed = max(largest_speed, speed + abs(F) * link.self_mobility)
    return change, largest_speed


def take_newton_step(links: Any, first: int, last: int) -> None:
    """Take a Newton step for the forces of all links of a chain together.

    With the tangent of its law of slope s, each link has F = F0 + s (x1 - overlap),
    where x1 = -gap + closing depends on the forces of its neighbours. A link of slope
    -1, as a rigid contact with a force, has the fixed closing `max_closing` instead.
    The equations are tridiagonal: they are eliminated from the first link to the last
    and solved by back substitution.

    `force` of the links is set; except in joints it is not negative. The forces before
    the step are stored in `force_before`; `upper` is work space. Overlaps and slopes
    are not changed.
    """
    # The equation of link i is: diagonal F = right_side + s (closing by the forces of
    # the links before and after it). The two loops eliminate and substitute back.
    for i in range(first, last + 1):
        link = links[i]
        # Indices wrap around, as in `closing_without_own_force`.
        before = links[i - 1]
        after = links[i + 1 - len(links)]
        if link.force_slope < 0:
            # mobility F = (closing without F) - max_closing: s is 1 in this equation
            s = 1.0
            diagonal = link.self_mobility
            right_side = link.force_free_closing - link.max_closing
        else:
            # (1 + s mobility) F = F0 + s ((closing without F) - overlap - gap)
            s = link.force_slope
            diagonal = 1 + s * link.self_mobility
            rest = link.force_free_closing - link.overlap - link.gap
            right_side = link.force + s * rest
        # The link before is eliminated: its force is before.force - before.upper F.
        right_side += s * link.coupling_mobility * before.force
        pivot = diagonal + s * link.coupling_mobility * before.upper
        if pivot <= 4 * EPS * diagonal:  # only round-off is left
            pivot = diagonal
        # The force of this link is link.force - link.upper after.force: the second term
        # is subtracted below.
        link.force_before = link.force
        link.force = right_side / pivot
        link.upper = -s * after.coupling_mobility / pivot
    for i in range(last, first - 1, -1):
        link = links[i]
        after = links[i + 1 - len(links)]
        link.force -= link.upper * after.force
        if link.law >= Law.RIGID:  # a contact or impact, which does not pull
            link.force = max(link.force, 0.0)


def solve_chain(links: Any, first: int, last: int, speed: float) -> bool:
    """Set the forces of the links from `first` to `last`, a chain.

    False is returned if the forces were not found, as for a mass squeezed between
    walls; the links then keep the last forces. Gauss-Seidel sweeps reduce a convex
    function, the dual energy of the step, so they always converge, though slowly. A
    Newton step is taken between two sweeps. If it does not halve the change in the
    sweep after it, it is undone together with this sweep. A single link needs one sweep
    and is always solved. `speed`, m/s, is the largest speed of the bodies; changes
    within its round-off do not count.
    """
    # Results of `gauss_seidel_sweep` for the last sweep that is kept
    change = math.inf
    largest_speed = speed
    newton_taken = False
    sweeps_left = MAX_SWEEPS  # 0 ends the iteration
    while sweeps_left > 0:
        new_change, new_speed = gauss_seidel_sweep(links, first, last, speed)
        sweeps_left -= 1
        newton_failed = newton_taken and new_change > change / 2
        if newton_failed:  # undo the Newton step and the sweep after it
            newton_taken = False
            for i in range(first, last + 1):
                links[i].force = links[i].force_before  # from `take_newton_step`
        else:
            change = new_change
            if first == last:
                change = 0.0  # one sweep solves a single link
            largest_speed = new_speed
            # A change of a few round-offs is the end of the iteration. A Newton step is
            # taken if another sweep is left to judge it.
            still_changes = change > 8 * EPS * largest_speed
            if still_changes and sweeps_left > 0:
                take_newton_step(links, first, last)
                newton_taken = True
            else:
                sweeps_left = 0
    return bool(change <= UNSOLVED_RTOL * largest_speed)


def start_impacts(links: Any, first: int, last: int, tolerance: float) -> bool:
    """Let impacts of a chain begin if their gaps would close in this step.

    Return whether any impact begins. Only an impact that has not begun has an infinite
    `max_closing`. It begins if its gap at the end of the step would be less than
    -`tolerance`, m/s (time is counted in steps); `max_closing` is then set. The closing
    velocity u at the start of the step shall become -e u at its end, so the mean is
    (1 - e) u/2, or 0 if u is at most `tolerance`. Forces are not changed: the caller
    has to solve for them again.
    """
    has_new_impact = False
    for i in range(first, last + 1):
        link = links[i]
        # Closing in this step with all present forces
        w = closing_without_own_force(links, i) - link.force * link.self_mobility
        is_waiting = link.max_closing == math.inf  # an impact that has not begun
        gap_would_close = link.gap - w < -tolerance
        if is_waiting and gap_would_close:
            u = link.old_closing
            link.max_closing = 0.0
            if u > tolerance:
                link.max_closing = (1 - link.restitution) * u / 2
            has_new_impact = True
    return has_new_impact


def updated_gap(link: Link, w: float, tolerance: float) -> float:
    """Return the gap of a link at the end of a step in which it closes by w, m/s.

    Time is counted in steps, so w is also the mean closing velocity. link.gap is not
    changed. The gap becomes

    - link.gap - w for an open rigid contact, which a force closes (`is_closed` is set);
    - 0 for a closed rigid contact, until it opens: without a force, faster than
      `tolerance`, m/s. It then has half of its opening velocity after the step;
    - link.gap - w for an impact; closed and without a force it keeps its gap if abs(w)
      is at most `tolerance`;
    - -(yield force)/stiffness for a contact that yields in this step: its yield force
      and its position in the hardening table are set first;
    - -link.overlap for any other link.
    """
    gap: float
    if link.law == Law.RIGID:
        # w is the mean of the closing velocities before and after the step.
        new_closing = 2 * w - link.old_closing
        opens = link.force <= 0 and new_closing < -tolerance
        if link.is_closed == 0:
            gap = link.gap - w
            if link.force > 0:  # it closes in this step
                link.is_closed = 1
        elif opens:
            # The kick in the middle of the step opens it. In the second half of the
            # step the gap grows to -new_closing/2, which is old_closing/2 - w.
            link.is_closed = 0
            gap = link.old_closing / 2 - w
        else:  # it stays closed
            gap = 0.0
    elif link.law == Law.IMPACT:
        is_at_rest = link.force <= 0 and link.gap <= 0 and abs(w) <= tolerance
        if is_at_rest:
            gap = link.gap  # w is round-off
        else:
            gap = link.gap - w
    elif link.law == Law.YIELD and link.overlap > link.yield_force / link.stiffness:
        # The contact yields in this step. It hardens, and its faces are displaced
        # permanently: relative to the new positions its overlap is the elastic one at
        # the new yield force.
        link.yield_force, _, next_knot = contact_laws.load_plastically(
            link, -link.gap, link.overlap
        )
        if next_knot > link.next_knot:  # it has reached the next row of its table
            link.next_knot = next_knot
            # The row of the table that begins at knot i has the entry i of `shares`.
            link.hardening_share = link.shares[next_knot - 1]
        gap = -link.yield_force / link.stiffness
    else:
        gap = -link.overlap
    return gap
