"""Links on a time step: their laws, and chains of links that are solved together.

A force F > 0 in a link pushes two bodies apart. Over one step the bodies obey linear
laws, so the links close by w = force_free_closing - A F, with A a tridiagonal Stieltjes
matrix: a link feels its own force, and through the body between them the forces of its
two neighbours. Its law gives F of w.

A compliant contact has the overlap x, and over a step the force
(U(x1) - U(x0))/(x1 - x0) of its stored energy U (discrete gradient: Gonzalez, J.
Nonlinear Sci. 6, 1996), and the mean force of its dashpot over the same path. It pulls
nowhere. This force is convex and increasing in x1, so Newton's method falls on the root
from the right. A joint is a spring and a dashpot that pull as well. A yielding contact
is a spring up to its yield force; x counts from where its faces have moved to. A rigid
contact takes the force that keeps its closing below `max_closing`. An impact of rigid
bodies takes the force that leaves a closing velocity of at most -e times the one before
(Moreau, CISM 302, 1988).

Units are those of `records`.
"""

import math
from typing import Any

from .. import contact_laws
from ..link import Law
from .records import Link

EPS = 1 / (1 << 52)
UNSOLVED_RTOL = 1 / (1 << 24)
"""Change of closings, over the largest speed, at which a chain has no solution."""
NEWTON_RTOL = 1 / (1 << 27)
"""Relative Newton step after which the next one is round-off.

Convergence is quadratic.
"""
MAX_NEWTON_STEPS = 100
"""Iterations of one contact: a bound that is not met in practice."""
MAX_SWEEPS = 1000
"""Sweeps over one chain, see `solve_chain`."""


def solve_link(link: Link, c: float) -> tuple[float, float, float]:
    """Solve x1 = x0 + c - y F(x0, x1) for a compliant contact or joint, y its mobility.

    The link is not changed.

    Parameters
    ----------
    link : Link
        x0 is -link.gap, and link.overlap a guess of x1.
    c : float
        Closing in this step without the own force.

    Returns
    -------
    F, x1, dF/dx1
    """
    x0 = -link.gap
    y = link.self_mobility
    top = x0 + c  # x1 without the own force, the largest that it may be
    if link.law == Law.JOINT:  # which pulls as well
        # F = k (x0 + x1)/2 + d (x1 - x0) = k x0 + slope (x1 - x0) is linear; d is the
        # damping, as force by closing in a step.
        k = link.stiffness
        slope = k / 2 + link.damping
        divisor = 1 + y * slope
        F = (k * x0 + slope * c) / divisor
        x1 = x0 + (c - y * k * x0) / divisor
        return F, x1, slope
    # x is the guess of x1, which Newton's method mends.
    yields = False  # whether x1 is beyond the elastic limit
    if link.law == Law.YIELD:
        # The mean force bends both ways, its work only up:
        # begin on the right of the root.
        elastic_limit = link.yield_force / link.stiffness
        force_at_limit, _ = contact_laws.mean_force(link, x0, elastic_limit)
        # The residual of Newton's method, below,
        # is < 0 at the limit if the root is beyond.
        yields = elastic_limit - top + y * force_at_limit < 0
        if yields:
            x = top
        else:
            x = min(elastic_limit, top)
    else:
        x = min(link.overlap, top)
    F = 0.0
    slope = 0.0  # dF/dx1
    for _ in range(MAX_NEWTON_STEPS):
        F, slope = contact_laws.mean_force(link, x0, x)
        residual = x - top + y * F
        # Where the contact yields, Newton's method is for (x - x0) residual, which only
        # bends up. Its slope, divided by x - x0, is that of the residual and one term
        # more.
        further_slope = 0.0
        if yields:
            further_slope = residual / (x - x0)
        step = residual / (1 + y * slope + further_slope)
        F = F - slope * step  # the force at the new x, to first order
        x = min(x - step, top)
        # What the step is to be small beside: the overlap, or, without one, the way
        if x > 0:
            size = x
        else:
            size = x0 - x
        # In a contact that is not stiff, round-off of the closing is round-off of x.
        # The overlap of a stiff one is small beside the closing that it stops.
        tolerance = 0.0
        if y * slope <= 1:
            tolerance = 4 * EPS * (abs(x0) + abs(c))
        if abs(step) <= max(NEWTON_RTOL * size, tolerance):
            break
    if y * slope > 1:
        # For a stiff contact this is more accurate than the law, because x is small.
        F = (top - x) / y
    return max(F, 0 * F), x, slope  # 0 * F is 0 as the same kind of number


def closing_without_own_force(links: Any, i: int) -> float:
    """Closing of link i in this step without its own force.

    The forces of both neighbours count. The first link of a chain shares nothing with
    the one before it: its coupling is 0. Behind the last of all links comes the first.
    """
    link = links[i]
    after = links[i + 1 - len(links)]  # an index below 0 counts from the end
    c: float = (
        link.force_free_closing
        + link.coupling_mobility * links[i - 1].force
        + after.coupling_mobility * after.force
    )
    return c


def gauss_seidel_sweep(
    links: Any, first: int, last: int, speed: float
) -> tuple[float, float]:
    """Set the forces of the links of a chain one after the other.

    Each is found with the others as they are.

    Their slopes are set too, and the overlaps of those that are not rigid. The closing
    without the own force is c. A rigid link, or an impact, takes F = max(0,
    (c - max_closing)/mobility); other links are solved by `solve_link`.

    Parameters
    ----------
    links : list of LINK
    first, last : int
        First and last link of the chain.
    speed : float
        Speed of the bodies.

    Returns
    -------
    float
        The largest change of a closing.
    float
        The largest speed: that of the bodies, and the closings that single forces
        change.
    """
    change = 0.0
    largest = speed
    for i in range(first, last + 1):
        link = links[i]
        c = closing_without_own_force(links, i)
        if link.law == Law.RIGID or link.law == Law.IMPACT:
            F = (c - link.max_closing) / link.self_mobility
            slope = -1.0  # its closing is fixed
            if F <= 0:
                F = 0.0
                slope = 0.0
        else:
            F, link.overlap, slope = solve_link(link, c)
        # Change of its closing by its own force
        change = max(change, abs(F - link.force) * link.self_mobility)
        link.force = F
        link.force_slope = slope
        largest = max(largest, speed + abs(F) * link.self_mobility)
    return change, largest


def take_newton_step(links: Any, first: int, last: int) -> None:
    """Take a Newton step for the forces of all links of a chain together.

    With the tangent of its law each link has F = F0 + s (x1 - overlap), s the slope,
    and x1 = -gap + closing, which the forces of neighbours change. Where the closing is
    fixed, as at a rigid contact, that condition takes its place. The equations are
    tridiagonal: they are eliminated from the first link to the last, and solved back.

    The forces before it are stored in `force_before`. Contacts never pull. Indices
    count round: the link behind i is i + 1 - len(links).
    """
    for i in range(first, last + 1):
        link = links[i]
        before = links[i - 1]  # its coupling with the first link is 0
        s = link.force_slope
        # Slope -1: the closing is fixed, mobility F = closing without F - max_closing.
        # Else (1 + s mobility) F = F0 + s (closing without F - overlap - gap).
        if s < 0:
            s = -s
            middle = link.self_mobility
            right = link.force_free_closing - link.max_closing
        else:
            middle = 1 + s * link.self_mobility
            right = link.force + s * (link.force_free_closing - link.overlap - link.gap)
        # The link before is eliminated: its force is before.force - before.upper F.
        right += s * link.coupling_mobility * before.force
        pivot = middle + s * link.coupling_mobility * before.upper
        if pivot <= 4 * EPS * middle:  # nothing but round-off is left
            pivot = middle
        link.force_before = link.force
        link.force = right / pivot
        link.upper = -s * links[i + 1 - len(links)].coupling_mobility / pivot
    for i in range(last, first - 1, -1):
        link = links[i]
        link.force -= link.upper * links[i + 1 - len(links)].force
        if link.law >= Law.RIGID:  # a contact, not a joint
            link.force = max(link.force, 0.0)


def solve_chain(links: Any, first: int, last: int, speed: float) -> bool:
    """Set the forces of a chain; return False if they were not found.

    There are none where walls squeeze a mass. Gauss-Seidel sweeps descend on a convex
    function, the dual energy of the step, and so always converge, if slowly. A Newton
    step is kept where it halves the change in the next sweep. One link alone needs one
    sweep. `speed` is that of the bodies, whose round-off is no change.
    """
    change = math.inf  # largest change of a closing in the last sweep that is kept
    largest = speed  # largest speed in it
    newton_taken = False
    sweeps = 2 * MAX_SWEEPS  # those that are left; 0 ends the iteration
    while sweeps > 0:
        new_change, new_largest = gauss_seidel_sweep(links, first, last, speed)
        sweeps -= 1
        if newton_taken and new_change > change / 2:  # take the Newton step back
            newton_taken = False
            for i in range(first, last + 1):
                links[i].force = links[i].force_before  # of `take_newton_step`
        else:
            if first < last:
                change = new_change
            else:
                change = 0.0  # one link alone is solved
            largest = new_largest
            # A Newton step is taken if another sweep is left to judge it.
            if change > 8 * EPS * largest and sweeps > 0:
                take_newton_step(links, first, last)
                newton_taken = True
            else:
                sweeps = 0
    return bool(change <= UNSOLVED_RTOL * largest)


def start_impacts(links: Any, first: int, last: int, tolerance: float) -> bool:
    """Let impacts of a chain begin whose gaps would close in this step.

    Return whether one does. An impact that has not begun has an infinite `max_closing`.
    The one that begins at the closing velocity u is to leave -e u: the mean over the
    step is (1 - e) u/2. Gaps within `tolerance`, m/s, below 0 are closed already, and
    closing velocities within it are 0.
    """
    has_new_impact = False
    for i in range(first, last + 1):
        link = links[i]
        # Closing in this step with the own force
        w = closing_without_own_force(links, i) - link.force * link.self_mobility
        # It has not begun, and its gap at the end of the step would be below 0.
        if link.max_closing == math.inf and link.gap - w < -tolerance:
            u = link.initial_closing
            link.max_closing = 0.0
            if u > tolerance:
                link.max_closing = (1 - link.restitution) * u / 2
            has_new_impact = True
    return has_new_impact


def updated_gap(link: Link, w: float, tolerance: float) -> float:
    """Return the gap of a link at the end of a step in which it closes by w.

    A grid counts time in steps and lengths in m/s: w is also the mean closing velocity.
    Set what else has changed: whether a rigid contact is closed, and yield force and
    hardening of one that yields. A closed rigid contact opens with more than
    `tolerance`, m/s, and an impact rests with less. The gap in the link stays that at
    the start of the step.
    """
    gap: float
    if link.law == Law.RIGID or link.law == Law.IMPACT:  # these have no overlap
        gap = link.gap - w
    else:
        gap = -link.overlap
    final_closing = 2 * w - link.initial_closing  # as w is the mean of both
    # Of bodies that an impact has left at rest
    is_at_rest = link.force <= 0 and link.gap <= 0 and abs(w) <= tolerance
    if link.law == Law.RIGID:
        if link.is_closed == 0:
            if link.force > 0:  # it closes in this step
                link.is_closed = 1
        elif link.force <= 0 and final_closing < -tolerance:
            # It opens at the kick in the middle of the step: the gap is
            # -final_closing/2.
            link.is_closed = 0
            gap = link.initial_closing / 2 - w
        else:  # it stays closed
            gap = 0.0
    elif link.law == Law.IMPACT and is_at_rest:
        gap = link.gap  # the round-off of w does not move it
    elif link.law == Law.YIELD and link.overlap > link.yield_force / link.stiffness:
        # It hardens, and its faces move for good: from where they are now its overlap
        # is the elastic one at the new yield force.
        link.yield_force, _, next_knot = contact_laws.load_plastically(
            link, -link.gap, link.overlap
        )
        if next_knot > link.next_knot:
            link.next_knot = next_knot
            link.hardening_share = link.shares[next_knot - 1]
        gap = -link.yield_force / link.stiffness
    return gap
