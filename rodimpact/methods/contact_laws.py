"""Contact laws in kernels, for both methods that have compliant contacts.

Compression is positive: F > 0 presses two neighbours apart, d > 0 is their overlap, and
d' its rate.

The method "characteristics" needs the force of a link as a function of d and `closing`,
the rate at which the link would close without its own force: d' = closing - Y F, with Y
the mobility beside the link. It also needs the guards that end the status of a link.
The grid needs the mean force over a time step.

A new law is a branch in `force` and in `mean_force`, and in `pressing_sign` if its
force can end while there is still overlap. The web page has the part for
characteristics as JavaScript.

Letters: k stiffness, p exponent, c damping of a dashpot, chi damping of Hunt and
Crossley, Y mobility, F force.
"""

import math
from typing import Any

from ..model.laws import UNREACHED
from .link import Law
from .states import Status

MAX_ITERATIONS = 20
"""Largest number of Newton steps for a force that depends on the closing rate.

The result of the last step is used, converged or not.
"""
FORCE_RTOL = 1e-14
"""Relative change of this force in the last Newton step; the next is round-off."""
SERIES_RANGE = 1 / (1 << 6)
"""Relative change of the overlap below which a difference quotient becomes a series.

Below it the quotient loses 6 bits or more. The series neglects the fourth power.
"""


# Kinds of force -----------------------------------------------------------------------


def has_dashpot(link: Any) -> bool:
    """Whether a link is a contact with a spring and a parallel dashpot.

    A dashpot presses without overlap, too. Joints do not count, and neither does the
    damping chi of other laws, which multiplies their force.
    """
    return bool(link.law == Law.SPRING and link.damping > 0)


def force_jumps(link: Any) -> bool:
    """Whether the force of a link jumps when the link closes.

    It does for a rigid link and for a spring with a dashpot.
    """
    return bool(link.law == Law.RIGID or has_dashpot(link))


def is_nonlinear(link: Any) -> bool:
    """Whether a Newton iteration for the force of a link needs more than one step.

    It does for power laws, laws of the user, and yielding laws with damping. Without
    damping a yielding law is piecewise linear.
    """
    law = link.law
    is_straight = law == Law.YIELD and link.damping == 0
    # In `Law`, POWER, YIELD and OWN follow SPRING.
    return bool(law > Law.SPRING and not is_straight)


def lets_go(link: Any) -> bool:
    """Whether `pressing_sign` is an additional guard of a link that presses.

    It is for a power law, a yielding law or a law of the user with losses, which can
    end the force while there is still overlap. For a spring with a dashpot the result
    is False: its force can end in the same way, but it also presses without overlap, so
    that `pressing_sign` is its only guard, see `guard`.
    """
    # In `Law`, POWER, YIELD and OWN follow SPRING.
    return bool(link.law > Law.SPRING and link.damping > 0)


# Force and derivatives ----------------------------------------------------------------


def force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force F of a link that is not open, N, with dF/dd, N/m, and dF/dclosing, N s/m.

    d is the overlap, m; `closing`, m/s, is the rate at which it would grow without F. A
    law that depends on the true rate d' = closing - Y F is solved for F. For d < 0 a
    power law continues as an odd function, so that Newton's method and the search for
    d = 0 do not fail. At a bond or a rigid contact d' = 0, so that F = closing/Y; there
    is a rod beside it, so that Y > 0.

    A link at rest (REST) has no law: its force is such that `closing` is 0. In place of
    F this residual, `closing`, is returned, with its derivatives 0 and 1.
    """
    law = link.law
    if link.status == Status.REST:
        return closing, 0.0, 1.0
    if law == Law.BOND or law == Law.RIGID:
        Y = link.mobility
        return closing / Y, 0.0, 1 / Y
    if law == Law.OWN:
        return own_force(link, d, closing)
    if is_nonlinear(link):  # a power law, or a yielding law with damping
        return power_force(link, d, closing)
    # A spring, a joint, or a yielding law without damping
    return spring_force(link, d, closing)


def spring_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = k d + c d', N, with dF/dd, N/m, and dF/dclosing, N s/m.

    d' = closing - Y F, where `closing` is the rate without F and Y the mobility of the
    link. Solved for F, with share = 1/(1 + c Y):
    F = (k d + c closing) share,  dF/dd = k share,  dF/dclosing = c share.
    F may be negative. For a yielding law c = 0.
    """
    k = link.stiffness
    c = link.damping
    Y = link.mobility
    share = 1 / (1 + c * Y)
    F = (k * d + c * closing) * share
    return F, k * share, c * share


def power_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = g (1 + chi d'), N, with g = k d^p; dF/dd, N/m, and dF/dclosing, N s/m.

    This is the law of Hunt and Crossley (1975). d' = closing - Y F, where `closing` is
    the rate without F and Y the mobility of the link. Solved for F, with
    share = 1/(1 + g chi Y):
    F = g (1 + chi closing) share,  dF/dg = (1 + chi closing) share^2,
    dF/dclosing = g chi share.

    For d < 0 there is no damping: F = -k abs(d)^p, and dF/dclosing = 0. Soil at a toe
    is the same with p = 1 and its damping factor J as chi (Smith 1960).
    """
    k = link.stiffness
    p = link.exponent
    chi = link.damping
    x = abs(d)
    if p == 1.5:
        root = math.sqrt(x)
    else:
        root = x ** (p - 1)
    g = k * d * root  # an odd function of d
    slope = p * k * root  # dg/dd
    if chi == 0 or d < 0:
        return g, slope, 0.0
    Y = link.mobility
    share = 1 / (1 + g * chi * Y)
    ratio = (1 + chi * closing) * share  # F/g
    # dF/dd = dg/dd dF/dg, with dF/dg = ratio share
    return g * ratio, slope * ratio * share, g * chi * share


def user_force(function: int, d: float, rate: float) -> float:  # noqa: ARG001
    """Force f(d, d') of the law of the user with the number `function`, N.

    This body is a placeholder that never runs: `compiling` replaces it by calls of the
    laws of the user.
    """
    return 0.0


def odd_user_force(link: Any, d: float, rate: float) -> float:
    """Force of the law f of the user, N, at the overlap d, m, and its rate d', m/s.

    It is f(d, d') for d >= 0. For d < 0, where the user has not defined f, it is
    f(0, d') - f(-d, 0): it continues to fall, so that Newton's method and the search
    for d = 0 do not fail.
    """
    number = link.function
    if d < 0:
        return user_force(number, 0.0, rate) - user_force(number, -d, 0.0)
    return user_force(number, d, rate)


def own_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = f(d, d'), N, of a law of the user, with dF/dd, N/m, and dF/dclosing, N s/m.

    d' = closing - Y F, where `closing` is the rate without F and Y the mobility of the
    link. F is found by Newton's method for f(d, closing - Y F) - F = 0, with
    difference quotients as the derivatives of f. After `MAX_ITERATIONS` steps F is
    used, converged or not. The derivatives of F are those of f times
    share = 1/(1 + Y df/dd'), as the force reduces the rate on which it depends.
    """
    Y = link.mobility
    F = odd_user_force(link, d, closing)  # first guess: d' = closing
    rate_step = link.rate_step
    by_rate = 0.0  # df/dd'
    for _ in range(MAX_ITERATIONS):
        rate = closing - Y * F
        f = odd_user_force(link, d, rate)
        f_faster = odd_user_force(link, d, rate + rate_step)
        by_rate = (f_faster - f) / rate_step
        change = (f - F) / (1 + Y * by_rate)
        F += change
        if abs(change) <= FORCE_RTOL * abs(F):
            break
    rate = closing - Y * F
    f = odd_user_force(link, d, rate)
    overlap_step = link.overlap_step
    f_deeper = odd_user_force(link, d + overlap_step, rate)
    by_overlap = (f_deeper - f) / overlap_step  # df/dd
    # `by_rate` is the derivative before the last change of F, which is small.
    share = 1 / (1 + Y * by_rate)
    return F, by_overlap * share, by_rate * share


# What ends a status -------------------------------------------------------------------


def guard_count(link: Any) -> int:
    """Number of guards that watch the status of a link, see `guard`.

    It is 0 for BOND, 2 for GRAZE, and 1 for OPEN and REST. For PLASTIC it is 2 if the
    table has a next knot, else 1. For PRESS it is 1, plus 1 if the link can yield, plus
    1 if `lets_go` is true.
    """
    status = link.status
    count = 1
    if status == Status.BOND:
        count = 0
    elif status == Status.GRAZE:
        count = 2  # it opens, or presses again
    elif status == Status.PLASTIC:
        # Without a next knot, the table has UNREACHED in its place.
        if link.knots[link.next_knot] < UNREACHED:
            count = 2
    elif status == Status.PRESS:
        if link.law == Law.YIELD:
            count += 1
        if lets_go(link):
            count += 1
    return count


def pressing_sign(link: Any, d: float, closing: float, F: float, scale: float) -> float:
    """Dimensionless number that has the sign of the force of a law with losses.

    It is f Y/scale for a law f of the user, (k d/c + closing)/scale for a spring with a
    dashpot, and 1 + chi closing for any other law. The last two use `closing`, the rate
    without the force F, in place of d': both are equal where F = 0. `scale` is the
    velocity scale, m/s. Y is `effective_mobility`, as the mobility beside a link
    between masses is 0.
    """
    damping = link.damping
    if link.law == Law.OWN:
        rate = closing - link.mobility * F
        f = odd_user_force(link, d, rate)
        sign = f * link.effective_mobility / scale
    elif has_dashpot(link):
        sign = (link.stiffness * d / damping + closing) / scale
    else:
        sign = 1 + damping * closing
    return sign  # type: ignore[no-any-return]


def guard(
    link: Any,
    which: int,
    d: float,
    closing: float,
    F: float,
    scale: float,
    length: float,
) -> tuple[float, int]:
    """Dimensionless value of guard `which` of a link, and the status that follows it.

    The status of the link lasts until one of its guards falls below 0; the next status
    is the one that belongs to this guard. Damping can end the force while there is
    still overlap: the status is then GRAZE, until the overlap is 0 (OPEN) or the force
    is positive again (PRESS). PLASTIC lasts until the contact no longer closes (PRESS,
    with a new yield force), or until the force reaches a knot of the table (PLASTIC,
    with the next hardening).

    Parameters
    ----------
    link : LINK
    which : int
        Number of the guard, from 0 to `guard_count` - 1; see the table below.
    d, closing, F : float
        Overlap, m, closing rate without the force, m/s, and force, N.
    scale, length : float
        Scales of velocities, m/s, and of overlaps, m.

    Notes
    -----
    The guards by status, for PRESS also by kind of link. "Lack" is the relative
    difference by which the force is smaller::

        status                  guard 0          guard 1              guard 2
        OPEN                    gap
        REST                    force
        PLASTIC                 rate of closing  lack to next knot
        GRAZE                   overlap          -pressing_sign
        PRESS, rigid            force
        PRESS, with dashpot     pressing_sign
        PRESS, yields           overlap          lack to yield force
        PRESS, yields, damping  overlap          lack to yield force  pressing_sign
        PRESS, other            overlap          pressing_sign

    The guard `pressing_sign` beside an overlap exists only with losses, see `lets_go`.
    """
    status = link.status
    if status == Status.OPEN:
        gap = -d
        return gap / length, Status.PRESS.value
    if status == Status.REST:
        return F / link.resting_force, Status.OPEN.value
    if status == Status.PLASTIC and which == 1:
        knot = link.next_knot
        return 1 - F / link.knots[knot], Status.PLASTIC.value
    if status == Status.PLASTIC:
        rate = closing - link.mobility * F
        return rate / scale, Status.PRESS.value
    if status == Status.PRESS and link.law == Law.RIGID:
        return F * link.mobility / scale, Status.OPEN.value
    # The remaining cases are GRAZE, and PRESS of a law that is not rigid.
    sign = pressing_sign(link, d, closing, F, scale)
    if status == Status.GRAZE and which == 1:
        return -sign, Status.PRESS.value
    if link.law == Law.YIELD and which == 1:
        # Yielding begins when the force without damping reaches the yield force.
        if link.damping > 0:
            static_force = link.stiffness * d
        else:
            static_force = F
        return 1 - static_force / link.yield_force, Status.PLASTIC.value
    # `pressing_sign` is the last guard of PRESS: 0 with a dashpot, otherwise 1 or 2.
    if status == Status.PRESS and (which > 0 or has_dashpot(link)):
        return sign, Status.GRAZE.value
    # Guard 0 of GRAZE, and of PRESS without a dashpot: the overlap
    return d / length, Status.OPEN.value


def follows_overlap(link: Any, which: int) -> bool:
    """Whether guard number `which` of a link is its overlap or its gap, without jumps.

    It is for guard 0 of OPEN, of GRAZE, and of PRESS if `force_jumps` is false. Other
    guards jump where an incoming wave jumps.
    """
    status = link.status
    if status == Status.OPEN:  # its only guard
        return True
    if which > 0 or status > Status.PRESS:  # PLASTIC and REST follow PRESS
        return False
    if status == Status.PRESS:
        return not force_jumps(link)
    return True  # guard 0 of GRAZE


def break_order(link: Any, order: int) -> Any:
    """Order of the break in the force of a link: of the lowest derivative that jumps.

    The velocity beside the link has a break of order `order`. The force of a rigid
    link, a bond or a damped link depends on velocities, so that its order is `order`.
    The force of a spring depends on their integral, so that its order is `order` + 1.
    The break of the link itself, from its last event, has the order `link.break_order`.
    The lower order is returned. A link that is OPEN or in GRAZE has no force: its own
    order is returned.
    """
    status = link.status
    law = link.law
    own_order = link.break_order
    if status == Status.OPEN or status == Status.GRAZE:
        return int(own_order)
    is_bond_or_push = law <= Law.PUSH_RIGHT  # bonds and pushes are first in `Law`
    if is_bond_or_push or law == Law.RIGID or link.damping > 0:
        return min(own_order, order)
    return min(own_order, order + 1)


# Mean force over a time step ----------------------------------------------------------


def mean_force(link: Any, x0: float, x1: float) -> tuple[float, float]:
    """Mean force F of a compliant contact over a time step, N, and dF/dx1.

    Its overlap x goes from x0 to x1 at a constant rate. Time is counted in steps, and
    lengths are divided by the step, m/s, so that dx/dt = x1 - x0 = w. The link is not
    changed.

    SPRING: mean of max(k x + c w, 0) for x > 0, with 0 for x < 0.
    POWER: mean of k x^p for x > 0, times 1 + chi w.
    YIELD: work along the lines of its table, divided by w, times 1 + chi w.
    F and dF/dx1 are 0 if x is never positive, or if the mean is not positive.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    k = link.stiffness
    law = link.law
    damping = link.damping
    w = x1 - x0
    if law == Law.POWER:
        F, dF = mean_power(k, link.exponent, x0, x1)
    elif law == Law.YIELD:
        yields = w > 0 and x1 > link.yield_force / k
        if yields:
            # Except for round-off, x0 is at most the overlap at which it yields.
            end_force, work, _ = load_plastically(link, x0, x1)
            F = work / w
            # d(work)/dx1 is the force at x1, and dw/dx1 = 1.
            dF = max((end_force - F) / w, 0.0)
        else:  # it is elastic in this step; its damping is a factor, below
            no_dashpot = 0.0
            F, dF = mean_spring(k, no_dashpot, x0, x1)
    else:  # a spring, which may have a dashpot
        F, dF = mean_spring(k, damping, x0, x1)
    # The damping of power and yielding laws is chi, and their factor 1 + chi w. The
    # mean of a spring already includes its dashpot. A yielding contact without damping
    # has the factor 1.
    if law == Law.POWER or (law == Law.YIELD and damping > 0):
        factor = 1 + damping * w
        dF = dF * factor + F * damping  # product rule, as dw/dx1 = 1
        F = F * factor
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def mean_spring(k: float, c: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean force F of a spring with a dashpot from x0 to x1, N, and dF/dx1.

    The overlap goes from x0 to x1, at least one of them positive, at the constant rate
    w = x1 - x0, in the units of `mean_force`. The force is max(k x + c w, 0), and 0 for
    x < 0; k > 0. If it presses between the overlaps a and b,
    F = (b - a)/w (k (a + b)/2 + c w).
    """
    w = x1 - x0
    end_force = k * x1 + c * w  # at x1
    if x0 >= 0 and end_force >= 0:  # it presses all the way: a = x0, b = x1
        return k * (x0 + x1) / 2 + c * w, k / 2 + c
    # It presses where x is above this overlap: for an opening contact (w < 0) where
    # k x + c w > 0, for a closing one where x > 0.
    press_from = max(-c * w / k, 0.0)
    a = max(x0, press_from)
    b = max(x1, press_from)
    share = (b - a) / w  # fraction of the step in which it presses
    F = share * (k * (a + b) / 2 + c * w)
    # F w is the integral of the force over x, in which w is also the rate. So
    # d(F w)/dx1 = max(end_force, 0) + c (b - a), and dw/dx1 = 1.
    return F, (max(end_force, 0.0) - F) / w + share * c


def mean_power(k: float, p: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean F of the force k x^p from x0 to x1, N, and dF/dx1; the force is 0 for x < 0.

    At least one of x0 and x1 is positive. With w = x1 - x0 and x0, x1 >= 0,
    F = k (x1^(p + 1) - x0^(p + 1))/((p + 1) w), and dF/dx1 = (k x1^p - F)/w. For a
    negative x0 or x1 its power is 0.

    If x1 is near x0, both formulas lose digits. Then, with h = w/x0 and q = p + 1,
    F = k x0^p ((1 + h)^q - 1)/(q h). For the smallest h the derivative is a series,
    dF/dx1 = k x0^(p - 1) p (1/2 + (p - 1) h/3 + (p - 1)(p - 2) h^2/8 + ...).
    """
    q = p + 1
    w = x1 - x0
    start_force = k * max(x0, 0.0) ** p  # at x0
    end_force = k * max(x1, 0.0) ** p  # at x1
    if x0 <= 0 or abs(w) > x0 / 2:  # x1 is not near x0
        # k x^(p + 1) is the force at x times x.
        F = (end_force * x1 - start_force * x0) / (q * w)
        return F, (end_force - F) / w
    h = w / x0
    if h == 0:
        F = start_force
    else:
        # (1 + h)^q - 1 without cancellation
        F = start_force * math.expm1(q * math.log1p(h)) / (q * h)
    if abs(q * h) > SERIES_RANGE:  # the difference loses few digits
        return F, (end_force - F) / w
    # 1/2 + (p - 1) h/3 + (p - 1)(p - 2) h^2/8 + (p - 1)(p - 2)(p - 3) h^3/30
    of_h = (p - 1) * h  # the product in the term with h
    of_h2 = of_h * (p - 2) * h
    series = 1 / 2 + of_h / 3 + of_h2 / 8 + of_h2 * (p - 3) * h / 30
    return F, start_force / x0 * p * series


def load_plastically(link: Any, x0: float, x1: float) -> tuple[float, float, int]:
    """Load a yielding contact from overlap x0 to x1, along its table.

    Overlaps do not contain the permanent indentation, so that the elastic force is k x,
    with the stiffness k. x0 < 0 is a gap, without force. x0 is at most the overlap at
    which the contact yields, and x1 is larger. The force rises to the yield force, then
    with the slope `hardening_share` k, that of the present row of the table, to the
    force knots[next_knot], and after this and each later knot i with the slope
    shares[i] k. The table ends with a force that is never reached. The link is not
    changed.

    Returns
    -------
    float
        Force at x1, the yield force from then on, N.
    float
        Work from x0 to x1: the area below the lines, N times the unit of x.
    int
        Index of the next knot, the first one that is not reached.
    """
    k = link.stiffness
    knot = link.next_knot
    # (x, force) is the point of the load line reached so far. It begins at the yield
    # point, which is still on the elastic line F = k x.
    force = link.yield_force
    x = force / k
    start = max(x0, 0.0)  # there is no force in a gap
    work = (x - start) * (force + k * start) / 2  # trapezium of the elastic line
    slope = link.hardening_share * k  # of the present row, up to knots[knot]
    knots = link.knots
    # Go to the next knot if the present line reaches its force before x1.
    while force + slope * (x1 - x) > knots[knot]:
        knot_force = knots[knot]
        rise = (knot_force - force) / slope  # of the overlap, up to the knot
        work += rise * (force + knot_force) / 2  # trapezium up to the knot
        x = x + rise
        force = knot_force
        slope = link.shares[knot] * k
        knot += 1
    last_rise = x1 - x
    end_force = force + slope * last_rise
    work = work + last_rise * (force + end_force) / 2  # trapezium up to x1
    return end_force, work, knot
