"""Contact laws in kernels.

They say what each law says, for both methods that carry compliant contacts. Compression
is positive: F > 0 presses two neighbours apart, d > 0 is their overlap, d' its rate.

The method "characteristics" asks for the force of a link by d and by `closing`, the
rate at which the link would close without its own force: d' = closing - Y F, Y the
mobility beside the link. It asks as well what ends the status of a link. The grid asks
for the mean force over a time step.

A new law is a branch in `force` and in `mean_force`, and in `pressing_sign` if its
force can end while there is still overlap. The page has the part for characteristics as
JavaScript.

Letters: k stiffness, p exponent, c damping of a dashpot, chi damping of Hunt and
Crossley, Y mobility, F force.
"""

import math
from typing import Any

from ..model.laws import UNREACHED
from .link import Law
from .states import Status

MAX_ITERATIONS = 20
"""Most steps to find a force that depends on the rate which it makes.

The last one counts.
"""
FORCE_RTOL = 1e-14
"""Relative change of that force in the last step; the next is below round-off."""
SERIES_RANGE = 1 / (1 << 6)
"""Relative change of the overlap below which a difference is taken as a series.

Below it the difference quotient loses 6 bits and more; the series leaves out the fourth
power.
"""


# What kind of force -------------------------------------------------------------------


def has_dashpot(link: Any) -> bool:
    """Whether a link has a dashpot beside its spring.

    A dashpot presses without overlap too. The damping of a contact that yields is no
    such dashpot.
    """
    return bool(link.law == Law.SPRING and link.damping > 0)


def force_jumps(link: Any) -> bool:
    """Whether the force of a link jumps as the link closes."""
    return bool(link.law == Law.RIGID or has_dashpot(link))


def is_nonlinear(link: Any) -> bool:
    """Whether a Newton iteration for the force of a link needs more than one step.

    All laws do but springs, and what yields along straight lines without damping.
    """
    law = link.law
    is_straight = law == Law.YIELD and link.damping == 0
    # Behind SPRING come powers, yielding laws and those of the user.
    return bool(law > Law.SPRING and not is_straight)


def lets_go(link: Any) -> bool:
    """Whether losses can end the force of a link while there is still overlap.

    False for a spring with a dashpot, of which this holds, too: it presses without
    overlap as well, so that `pressing_sign` is its first guard, not an additional one.
    """
    # Behind SPRING come powers, yielding laws and those of the user.
    return bool(link.law > Law.SPRING and link.damping > 0)


# Force and derivatives ----------------------------------------------------------------


def force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force F of a link that is not open, N, with dF/dd, N/m, and dF/dclosing, N s/m.

    d is the overlap, m; `closing`, m/s, is the rate at which it would grow without F. A
    law that feels the true rate d' = closing - Y F is solved for F. Below d = 0 a power
    goes on as an odd function, so that Newton's method and the search for d = 0 pass. A
    bond or a rigid contact takes all closing away, F = closing/Y; a rod is beside it,
    so that Y is positive.

    A link at rest (REST) has no law: its force is such that `closing` is 0. In place of
    F stands what must become 0, `closing`.
    """
    law = link.law
    if link.status == Status.REST:
        return closing, 0.0, 1.0
    if law == Law.BOND or law == Law.RIGID:
        Y = link.mobility
        return closing / Y, 0.0, 1 / Y
    if law == Law.OWN:
        return own_force(link, d, closing)
    if is_nonlinear(link):  # a power, or what yields with damping
        return power_force(link, d, closing)
    # A spring, a joint, or what yields along straight lines
    return spring_force(link, d, closing)


def spring_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = k d + c d', N, with dF/dd, N/m, and dF/dclosing, N s/m.

    d' = closing - Y F, where `closing` is the rate without F and Y the mobility of the
    link. Solved for F, with share = 1/(1 + c Y):
    F = (k d + c closing) share,  dF/dd = k share,  dF/dclosing = c share.
    F may be below 0.
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

    Below d = 0 there is no damping: F = -k abs(d)^p, and dF/dclosing = 0. Soil at a toe
    is the same with p = 1 and its J for chi (Smith 1960).
    """
    k = link.stiffness
    p = link.exponent
    chi = link.damping
    x = abs(d)
    if p == 1.5:
        root = math.sqrt(x)
    else:
        root = x ** (p - 1)  # 1 if the law is linear
    g = k * d * root  # odd in d
    slope = p * k * root  # dg/dd
    if chi == 0 or d < 0:
        return g, slope, 0.0
    Y = link.mobility
    share = 1 / (1 + g * chi * Y)
    ratio = (1 + chi * closing) * share  # F/g
    # dF/dd is slope dF/dg.
    return g * ratio, slope * ratio * share, g * chi * share


def user_force(function: int, d: float, rate: float) -> float:  # noqa: ARG001
    """Force f(d, d') of the law of the user with this number, N.

    This text stands for laws of the user, and is never run: `compiling` puts theirs in
    its place.
    """
    return 0.0


def odd_user_force(link: Any, d: float, rate: float) -> float:
    """Force of the law f of the user, N, at the overlap d, m, and its rate d', m/s.

    It is f(d, d') for d >= 0, and f(0, d') - f(-d, 0) below. Nobody has defined f for
    d < 0. It goes on falling there, so that Newton's method and the search for d = 0
    pass.
    """
    number = link.function
    if d < 0:
        return user_force(number, 0.0, rate) - user_force(number, -d, 0.0)
    return user_force(number, d, rate)


def own_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = f(d, d'), N, of a law of the user, with dF/dd, N/m, and dF/dclosing, N s/m.

    d' = closing - Y F, where `closing` is the rate without F and Y the mobility of the
    link. F is found by Newton's method for f(d, closing - Y F) - F = 0, with
    differences for the derivatives of f; the last of `MAX_ITERATIONS` steps counts in
    any case. The derivatives of F are smaller than those of f by
    share = 1/(1 + Y df/dd'), as the force slows down the closing that makes it.
    """
    Y = link.mobility
    F = odd_user_force(link, d, closing)  # first guess: the force does not slow it down
    rate_step = link.rate_step
    slope = 0.0  # df/dd'
    for _ in range(MAX_ITERATIONS):
        rate = closing - Y * F
        f = odd_user_force(link, d, rate)
        f_faster = odd_user_force(link, d, rate + rate_step)
        slope = (f_faster - f) / rate_step
        change = (f - F) / (1 + Y * slope)
        F += change
        if abs(change) <= FORCE_RTOL * abs(F):
            break
    rate = closing - Y * F
    f = odd_user_force(link, d, rate)
    overlap_step = link.overlap_step
    f_deeper = odd_user_force(link, d + overlap_step, rate)
    by_overlap = (f_deeper - f) / overlap_step  # df/dd
    share = 1 / (1 + Y * slope)
    return F, by_overlap * share, slope * share


# What ends a status -------------------------------------------------------------------


def guard_count(link: Any) -> int:
    """Number of guards that keep the status of a link, see `guard`.

    It is 0 for BOND, 2 for GRAZE, and 1 for OPEN and REST. PLASTIC has 2 if its table
    has a next knot, else 1. PRESS has 1 and one more each if the link yields and if
    `lets_go` holds.
    """
    status = link.status
    count = 1
    if status == Status.BOND:
        count = 0
    elif status == Status.GRAZE:
        count = 2  # it opens, or presses again
    elif status == Status.PLASTIC:
        if link.knots[link.next_knot] < UNREACHED:  # there is a next knot
            count = 2
    elif status == Status.PRESS:
        if link.law == Law.YIELD:
            count += 1
        if lets_go(link):
            count += 1
    return count


def pressing_sign(link: Any, d: float, closing: float, F: float, scale: float) -> float:
    """A number without dimension that has the sign of the force of a law with losses.

    That is f Y/scale for a law f of the user, (k d/c + closing)/scale for a dashpot
    beside a spring, and 1 + chi closing else: there `closing`, the rate without the
    force F, stands for d', which is the same where F is 0. `scale` is that of
    velocities, m/s. In f Y/scale `effective_mobility` is taken for Y, as Y is 0 between
    masses.
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
    """Value of guard number `which` of a link, and the status that follows it.

    The value has no dimension. The status of the link lasts until one of its guards
    falls below 0; that guard tells the next status. Damping can end the force while
    there is still overlap (GRAZE), until the overlap is gone (OPEN) or it presses again
    (PRESS). PLASTIC lasts until the contact no longer closes (PRESS, with a new yield
    force), or comes to a knot of its table (PLASTIC, with another hardening).

    Parameters
    ----------
    link : LINK
    which : int
        Which guard, from 0 to `guard_count` - 1; see the table below.
    d, closing, F : float
        Overlap, m, closing without the own force, m/s, and force, N.
    scale, length : float
        Scales of velocities, m/s, and of overlaps, m.

    Notes
    -----
    The guards by status, and of PRESS by kind of link ("lack": what the force lacks)::

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
    # What is left is GRAZE, and PRESS of a law that is not rigid.
    sign = pressing_sign(link, d, closing, F, scale)
    if status == Status.GRAZE and which == 1:
        return -sign, Status.PRESS.value
    if link.law == Law.YIELD and which == 1:
        # It begins to yield at the force that it would have without damping.
        if link.damping > 0:
            static_force = link.stiffness * d
        else:
            static_force = F
        return 1 - static_force / link.yield_force, Status.PLASTIC.value
    # The last guard of PRESS, in the table: 0 with a dashpot, else 1 or 2
    if status == Status.PRESS and (which > 0 or has_dashpot(link)):
        return sign, Status.GRAZE.value
    # Guard 0 of GRAZE, and of PRESS without a dashpot: the overlap
    return d / length, Status.OPEN.value


def follows_overlap(link: Any, which: int) -> bool:
    """Whether guard number `which` of a link is its overlap or its gap, without jumps.

    That is guard 0 of OPEN, of GRAZE, and of PRESS if the force of the link does not
    jump as it closes. Other guards jump where an incoming wave does.
    """
    status = link.status
    if status == Status.OPEN:
        return True
    if which > 0 or status > Status.PRESS:  # PLASTIC or REST: it yields, or rests
        return False
    if status == Status.PRESS:
        return not force_jumps(link)
    return True  # guard 0 of GRAZE


def break_order(link: Any, order: int) -> Any:
    """Order of the break in the force of a link: of the lowest derivative that jumps.

    The velocity beside the link has a break of `order`. The force of a rigid link, a
    bond or a damped one follows velocities: the order is the same. That of a spring
    follows their integral: it is one order smoother. A link that is open or lets go has
    no force that follows. A break of the link itself, at its last event, counts if it
    is rougher.
    """
    status = link.status
    law = link.law
    own_order = link.break_order
    if status == Status.OPEN or status == Status.GRAZE:
        return int(own_order)
    is_bond_or_push = law <= Law.PUSH_RIGHT  # bonds and pushes come first in `Law`
    if is_bond_or_push or law == Law.RIGID or link.damping > 0:
        return min(own_order, order)
    return min(own_order, order + 1)


# Mean force over a time step ----------------------------------------------------------


def mean_force(link: Any, x0: float, x1: float) -> tuple[float, float]:
    """Mean force F of a compliant contact over a time step, N, and dF/dx1.

    Its overlap x goes from x0 to x1 at a constant rate. Time is counted in steps and
    lengths in m/s, so that dx/dt = x1 - x0 = w. The link is not changed.

    SPRING: mean of k x + c w where x > 0 and this presses.
    POWER: mean of k x^p where x > 0, times 1 + chi w.
    YIELD: work along the lines of its table over w, times 1 + chi w.
    Both are 0 without overlap, or if the mean is not above 0.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    k = link.stiffness
    law = link.law
    damping = link.damping
    w = x1 - x0
    if law == Law.POWER:
        F, dF = mean_power(k, link.exponent, x0, x1)
    elif law == Law.YIELD and w > 0 and x1 > link.yield_force / k:
        # x0 is at most the overlap at which it yields, but for round-off.
        end_force, work, _ = load_plastically(link, x0, x1)
        F = work / w
        # The derivative of work/w is this, as that of the work is the force at its end.
        dF = max((end_force - F) / w, 0.0)
    elif law == Law.YIELD:
        F, dF = mean_spring(k, 0.0, x0, x1)
    else:  # a spring, which may have a dashpot
        F, dF = mean_spring(k, damping, x0, x1)
    # Powers and what yields are damped by the factor 1 + chi w, `damping` being chi. A
    # spring is not: its mean has the dashpot already.
    if law == Law.POWER or (law == Law.YIELD and damping > 0):
        factor = 1 + damping * w
        dF = dF * factor + F * damping  # product rule, as dw/dx1 = 1
        F = F * factor
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def mean_spring(k: float, c: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean F of max(k x + c w, 0), and 0 where x < 0, from x0 to x1, N, and dF/dx1.

    x0 or x1 is positive, and w = x1 - x0. With a and b the ends of the part of the way
    on which it presses, F = (b - a)/w (k (a + b)/2 + c w).
    """
    w = x1 - x0
    last = k * x1 + c * w  # force at the end of the way
    if x0 >= 0 and last >= 0:  # it presses all the way: a is x0, b is x1
        return k * (x0 + x1) / 2 + c * w, k / 2 + c
    # Overlap above which it presses: an opening contact lets go there, a closing one
    # begins at 0.
    least = max(-c * w / k, 0.0)
    a = max(x0, least)
    b = max(x1, least)
    share = (b - a) / w  # part of the way on which it presses
    F = share * (k * (a + b) / 2 + c * w)
    # d(F w)/dx1 = max(last, 0) + c (b - a): the force at the end of the way, and the
    # rise of the rate w all along it
    return F, (max(last, 0.0) - F) / w + share * c


def mean_power(k: float, p: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean F of k x^p, 0 for x < 0, from x0 to x1, N, and dF/dx1.

    x0 or x1 is positive. F = k (x1^(p + 1) - x0^(p + 1))/((p + 1) w) with w = x1 - x0,
    and dF/dx1 = (k x1^p - F)/w.

    Where x1 is near x0 both lose digits. There, with h = w/x0 and q = p + 1,
    F = k x0^p ((1 + h)^q - 1)/(q h). For the smallest h the derivative is a series,
    dF/dx1 = k x0^(p - 1) p (1/2 + (p - 1) h/3 + (p - 1)(p - 2) h^2/8 + ...).
    """
    q = p + 1
    w = x1 - x0
    first = k * max(x0, 0.0) ** p  # force at x0
    last = k * max(x1, 0.0) ** p  # force at x1
    if x0 <= 0 or abs(w) > x0 / 2:  # x1 is not near x0
        F = (last * x1 - first * x0) / (q * w)
        return F, (last - F) / w
    h = w / x0
    if h == 0:
        F = first
    else:
        # (1 + h)^q - 1 without cancellation
        F = first * math.expm1(q * math.log1p(h)) / (q * h)
    if abs(q * h) > SERIES_RANGE:  # the derivative still has its digits
        return F, (last - F) / w
    # 1/2 + (p - 1) h/3 + (p - 1)(p - 2) h^2/8 + (p - 1)(p - 2)(p - 3) h^3/30
    third = (p - 1) * h
    fourth = third * (p - 2) * h
    series = 1 / 2 + third / 3 + fourth / 8 + fourth * (p - 3) * h / 30
    return F, first / x0 * p * series


def load_plastically(link: Any, x0: float, x1: float) -> tuple[float, float, int]:
    """Load a yielding contact from overlap x0 to x1, along its table.

    x0 is at most the overlap at which it yields, x1 is more. The force rises with the
    stiffness k to the yield force, then with the slope `hardening_share` k to the next
    force of `knots`, and after knots[i] with the slope shares[i] k. The link is not
    changed.

    Returns
    -------
    float
        Force at x1, which is its yield force from then on, N.
    float
        Work on the way, J: the area below the lines.
    int
        Number of the next knot, the first that is not reached.
    """
    k = link.stiffness
    knot = link.next_knot
    # `x` and `force` are the point that the load has reached: first where it yields.
    force = link.yield_force
    x = force / k
    start = max(x0, 0.0)  # a gap has no force
    work = (x - start) * (force + k * start) / 2  # the elastic part, from start to x
    slope = link.hardening_share * k
    knots = link.knots
    # Go on from knot to knot, as long as the force at x1 on this line is beyond it.
    while force + slope * (x1 - x) > knots[knot]:
        knot_force = knots[knot]
        way = (knot_force - force) / slope  # overlap up to the knot, m
        work += way * (force + knot_force) / 2
        x = x + way
        force = knot_force
        slope = link.shares[knot] * k
        knot += 1
    last_way = x1 - x
    end_force = force + slope * last_way
    work = work + last_way * (force + end_force) / 2
    return end_force, work, knot
