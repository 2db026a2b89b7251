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
MAX_SWEEPS = 2000
"""Sweeps over one chain, see `solve_chain`: the last of them counts as it is."""


def solve_link(link: Link, c: float) -> tuple[float, float, float]:
    """Find the mean force F of a compliant contact, or of a joint, in this step.

    It solves x1 = x0 + c - y F(x0, x1), y the self mobility, for F and the overlap x1
    at the end of the step. F of a contact is `contact_laws.mean_force`, and is not
    negative. Its equation is solved by Newton's method, from the guess link.overlap
    for a law that does not yield; after `MAX_NEWTON_STEPS` the last iterate is
    returned, without an error. A joint may pull, see `solve_joint`. The link is not
    changed.

    Parameters
    ----------
    link : Link
        x0, the overlap at the start of the step, is -link.gap.
    c : float
        Closing in this step without the own force, m/s.

    Returns
    -------
    F, x1, dF/dx1
        In N, m/s (time is counted in steps) and N per m/s.
    """
    if link.law == Law.JOINT:
        return solve_joint(link, c)
    x0 = -link.gap
    y = link.self_mobility
    free_x1 = x0 + c  # x1 without the own force, the largest that it may be
    # First guess x of x1, on the right of the root if it can be: the residual
    # x - free_x1 + y F(x0, x) rises with x, and is 0 at the root.
    yields = False  # whether x1 is beyond the overlap at which the contact yields
    if link.law == Law.YIELD:
        elastic_limit = link.yield_force / link.stiffness
        force_at_limit, _ = contact_laws.mean_force(link, x0, elastic_limit)
        residual_at_limit = elastic_limit - free_x1 + y * force_at_limit
        yields = residual_at_limit < 0
        if yields:
            x = free_x1
        else:
            x = min(elastic_limit, free_x1)
    else:
        x = min(link.overlap, free_x1)
    # Newton's method
    F = 0.0
    slope = 0.0  # dF/dx1
    for _ in range(MAX_NEWTON_STEPS):
        F, slope = contact_laws.mean_force(link, x0, x)
        residual = x - free_x1 + y * F
        # The mean force of a contact that yields bends both ways, its work only up.
        # Therefore the root is that of (x - x0) residual. Its derivative, divided by
        # x - x0, is that of the residual, 1 + y slope, and residual/(x - x0).
        further_slope = 0.0
        if yields:
            further_slope = residual / (x - x0)
        step = residual / (1 + y * slope + further_slope)
        F = F - slope * step  # the force at the new x, to first order
        x = min(x - step, free_x1)
        # A step is small beside the overlap, or, if the contact opens in this step,
        # beside the way that it goes.
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
        F = (free_x1 - x) / y
    return max(F, 0 * F), x, slope  # 0 * F is 0 as the same kind of number


def solve_joint(link: Link, c: float) -> tuple[float, float, float]:
    """Find the mean force of a joint in this step; it may pull (F < 0).

    Arguments and results are those of `solve_link`. With the stiffness k and the
    damping d the force is linear, F = k (x0 + x1)/2 + d (x1 - x0), which is
    k x0 + slope (x1 - x0). With x1 - x0 = c - y F this is solved for F.
    """
    x0 = -link.gap
    y = link.self_mobility
    k = link.stiffness
    slope = k / 2 + link.damping
    divisor = 1 + y * slope
    F = (k * x0 + slope * c) / divisor
    x1 = x0 + (c - y * k * x0) / divisor
    return F, x1, slope


def closing_without_own_force(links: Any, i: int) -> float:
    """Closing of link i in this step if its own force were 0, m/s.

    It is that without forces, and what the present forces of the links before and after
    it add. Nothing is changed. The first link has the last one before it, and the last
    has the first one after it: the coupling of links of two chains is 0.
    """
    link = links[i]
    before = links[i - 1]
    after = links[i + 1 - len(links)]  # a negative index counts from the end
    by_before = link.coupling_mobility * before.force
    by_after = after.coupling_mobility * after.force
    c: float = link.force_free_closing + by_before + by_after
    return c


def gauss_seidel_sweep(
    links: Any, first: int, last: int, speed: float
) -> tuple[float, float]:
    """Set the forces of the links of a chain once, one after the other.

    Each force is found with the others as they are: a rigid link, or an impact, takes
    F = max(0, (c - max_closing)/mobility), c its closing without F; other links are
    solved by `solve_link`. `force` and `force_slope` of the links are set, and the
    `overlap` of those that are not rigid. A rigid link with a force has the slope -1.

    Parameters
    ----------
    links : list of LINK
    first, last : int
        First and last link of the chain.
    speed : float
        Speed of the bodies, m/s.

    Returns
    -------
    float
        The largest change, in this sweep, of the closing that a link's own force takes
        away, m/s.
    float
        `speed` plus the largest of these closings, m/s.
    """
    change = 0.0
    largest_speed = speed
    for i in range(first, last + 1):
        link = links[i]
        c = closing_without_own_force(links, i)
        if link.law == Law.RIGID or link.law == Law.IMPACT:
            F = (c - link.max_closing) / link.self_mobility
            slope = -1.0  # its closing is fixed
            if F <= 0:  # it closes less than it may, and needs no force
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

    With the tangent of its law each link has F = F0 + s (x1 - overlap), s the slope,
    and x1 = -gap + closing, which the forces of neighbours change. A link with the
    slope -1, as a rigid contact that presses, has a fixed closing in place of this,
    max_closing. The equations are tridiagonal: they are eliminated from the first link
    to the last, and solved back.

    `force` of the links is set, not below 0 but at joints. Their forces before are
    stored in `force_before`; `upper` is work space. Overlaps and slopes stay.
    """
    # The equation of link i is middle F = right + s (closing by the forces of the links
    # before and after). Indices count round: after the last of all links comes the
    # first, and the coupling of links of two chains is 0.
    for i in range(first, last + 1):
        link = links[i]
        before = links[i - 1]
        after = links[i + 1 - len(links)]  # a negative index counts from the end
        if link.force_slope < 0:
            # mobility F = closing without F - max_closing: s is 1 in this equation
            s = 1.0
            middle = link.self_mobility
            right = link.force_free_closing - link.max_closing
        else:
            # (1 + s mobility) F = F0 + s (closing without F - overlap - gap)
            s = link.force_slope
            middle = 1 + s * link.self_mobility
            right = link.force + s * (link.force_free_closing - link.overlap - link.gap)
        # The link before is eliminated: its force is before.force - before.upper F.
        right += s * link.coupling_mobility * before.force
        pivot = middle + s * link.coupling_mobility * before.upper
        if pivot <= 4 * EPS * middle:  # nothing but round-off is left
            pivot = middle
        # Until it is solved back, its force is link.force - link.upper after.force.
        link.force_before = link.force
        link.force = right / pivot
        link.upper = -s * after.coupling_mobility / pivot
    for i in range(last, first - 1, -1):
        link = links[i]
        after = links[i + 1 - len(links)]
        link.force -= link.upper * after.force
        if link.law >= Law.RIGID:  # contacts do not pull, joints do
            link.force = max(link.force, 0.0)


def solve_chain(links: Any, first: int, last: int, speed: float) -> bool:
    """Set the forces of the links from `first` to `last`, a chain.

    Return False if they were not found, as where walls squeeze a mass; the links keep
    the last forces then. Gauss-Seidel sweeps descend on a convex function, the dual
    energy of the step, and so always converge, if slowly. Between two sweeps stands a
    Newton step; it is taken back if it does not halve the change in the sweep after it.
    One link alone needs one sweep, and is always found. `speed`, m/s, is that of the
    bodies, whose round-off is no change.
    """
    change = math.inf  # largest change of a closing in the last sweep that is kept
    largest_speed = speed  # in it
    newton_taken = False
    sweeps_left = MAX_SWEEPS  # 0 ends the iteration
    while sweeps_left > 0:
        new_change, new_speed = gauss_seidel_sweep(links, first, last, speed)
        sweeps_left -= 1
        newton_failed = newton_taken and new_change > change / 2
        if newton_failed:  # take the step back, and the sweep after it
            newton_taken = False
            for i in range(first, last + 1):
                links[i].force = links[i].force_before  # from `take_newton_step`
        else:
            change = new_change
            if first == last:
                change = 0.0  # a sweep solves one link alone
            largest_speed = new_speed
            # A Newton step is taken if another sweep is left to judge it.
            if change > 8 * EPS * largest_speed and sweeps_left > 0:
                take_newton_step(links, first, last)
                newton_taken = True
            else:
                sweeps_left = 0
    return bool(change <= UNSOLVED_RTOL * largest_speed)


def start_impacts(links: Any, first: int, last: int, tolerance: float) -> bool:
    """Let impacts of a chain begin whose gaps would close in this step.

    Return whether one does. An impact that has not begun has an infinite `max_closing`,
    no other link has. It begins if its gap at the end of the step would be less than
    -`tolerance`, m/s (time is counted in steps), and `max_closing` is set: of the
    closing velocity u at the start of the step -e u is to be left at its end, so that
    the mean is (1 - e) u/2, or 0 if u is within `tolerance`. Forces stay: they have to
    be solved again.
    """
    has_new_impact = False
    for i in range(first, last + 1):
        link = links[i]
        # Closing in this step with the own force
        w = closing_without_own_force(links, i) - link.force * link.self_mobility
        is_waiting = link.max_closing == math.inf
        if is_waiting and link.gap - w < -tolerance:
            u = link.initial_closing
            link.max_closing = 0.0
            if u > tolerance:
                link.max_closing = (1 - link.restitution) * u / 2
            has_new_impact = True
    return has_new_impact


def updated_gap(link: Link, w: float, tolerance: float) -> float:
    """Return the gap of a link at the end of a step in which it closes by w, m/s.

    Time is counted in steps, so w is also the mean closing velocity. The gap of a rigid
    contact or impact is link.gap - w, that of any other link -link.overlap, whatever w
    is. A closed rigid contact keeps the gap 0 until it opens, without a force, at more
    than `tolerance`, m/s; an impact without a force keeps its gap if w is within it. A
    contact that has yielded has the gap -yield force/stiffness.

    `is_closed` of a rigid contact is set, and of one that yields the yield force and
    the part of its table. link.gap stays that at the start of the step.
    """
    gap: float
    if link.law == Law.RIGID:
        final_closing = 2 * w - link.initial_closing  # as w is the mean of both
        opens = link.force <= 0 and final_closing < -tolerance
        if link.is_closed == 0:
            gap = link.gap - w
            if link.force > 0:  # it closes in this step
                link.is_closed = 1
        elif opens:
            # The kick in the middle of the step opens it. For the other half the gap
            # grows with the final closing velocity, to -final_closing/2.
            link.is_closed = 0
            gap = link.initial_closing / 2 - w
        else:  # it stays closed
            gap = 0.0
    elif link.law == Law.IMPACT:
        is_at_rest = link.force <= 0 and link.gap <= 0 and abs(w) <= tolerance
        if is_at_rest:
            gap = link.gap  # the round-off of w does not move it
        else:
            gap = link.gap - w
    elif link.law == Law.YIELD and link.overlap > link.yield_force / link.stiffness:
        # It hardens, and its faces move for good: from where they are now its overlap
        # is the elastic one at the new yield force.
        link.yield_force, _, next_knot = contact_laws.load_plastically(
            link, -link.gap, link.overlap
        )
        if next_knot > link.next_knot:  # it has come to a new line of its table
            link.next_knot = next_knot
            link.hardening_share = link.shares[next_knot - 1]
        gap = -link.yield_force / link.stiffness
    else:
        gap = -link.overlap
    return gap
