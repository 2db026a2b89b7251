"""Contact laws in kernels: what each law says, for both methods that carry compliant contacts.

Compression is positive: F > 0 presses two neighbours apart, d > 0 is their overlap, d' its rate.

The method "characteristics" asks for the force of a link by d and by `closing`, the rate at which
the link would close without its own force: d' = closing - Y F, Y the mobility beside the link. It
asks as well what ends the status of a link. The grid asks for the mean force over a time step.

A new law is a branch in `force` and in `mean_force`, and in `drive` if it can let go while there is
still overlap. The page has the part for characteristics as JavaScript.
"""

import math
from typing import Any

from ..model.laws import UNREACHED
from .link import Law
from .states import Status

MAX_ITERATIONS = 20
"""Most steps to find a force that depends on the rate which it makes; the last one counts."""
FORCE_RTOL = 1e-14
"""Relative change of that force in the last step: the next change is below round-off."""
SERIES_RANGE = 1 / (1 << 6)
"""Relative change of the overlap below which a difference quotient is taken as a series.

Below it the quotient loses 6 bits and more; the series leaves out the fourth power.
"""


# What kind of force -------------------------------------------------------------------


def has_dashpot(link: Any) -> bool:
    """Whether a link has a dashpot beside its spring, which presses without overlap too."""
    return bool(link.law == Law.SPRING and link.damping > 0)


def force_jumps(link: Any) -> bool:
    """Whether the force of a link jumps as the link closes."""
    return bool(link.law == Law.RIGID or has_dashpot(link))


def is_nonlinear(link: Any) -> bool:
    """Whether a Newton iteration for the force of a link needs more than one step.

    All laws do but springs, and what yields along straight lines without damping.
    """
    return bool(link.law > Law.SPRING and (link.law != Law.YIELD or link.damping > 0))


def lets_go(link: Any) -> bool:
    """Whether a link has `drive` as its second guard: a loss can end its force before its overlap.

    So can a dashpot beside a spring, which presses without overlap too: `drive` is its one guard.
    """
    return bool(link.law > Law.SPRING and link.damping > 0)


# Force and derivatives ----------------------------------------------------------------


def force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force of a link that is not open, and its derivatives by overlap d and by `closing`.

    A dashpot feels the rate d' = closing - Y F, which holds the force itself; the laws are solved
    for it. Beyond d = 0 a power goes on as an odd function: Newton's method and the search for
    d = 0 pass.
    """
    if (
        link.status == Status.REST
    ):  # the force is the unknown itself, which `closing` holds
        return closing, 0.0, 1.0
    if link.law == Law.BOND or link.law == Law.RIGID:
        return closing / link.mobility, 0.0, 1 / link.mobility
    if link.law == Law.OWN:
        return own_force(link, d, closing)
    if is_nonlinear(link):  # a power, or what yields with damping
        return power_force(link, d, closing)
    return spring_force(link, d, closing)


def spring_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = k d + c d', N, and its derivatives by d and by `closing`.

    `closing` is the rate without the own force: d' = closing - Y F, Y the mobility. Solved for F,
    F = (k d + c closing)/(1 + c Y), whose divisor makes `share`.
    """
    share = 1 / (1 + link.damping * link.mobility)
    F = (link.stiffness * d + link.damping * closing) * share
    return F, link.stiffness * share, link.damping * share


def power_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """F = g (1 + chi d'), N, with g = k d^p (Hunt and Crossley 1975), and its derivatives.

    `closing` is the rate without the own force: d' = closing - Y F, Y the mobility. Solved for F,
    F = g (1 + chi closing)/(1 + g chi Y), whose divisor makes `share`. The derivatives are those
    by d and by `closing`.

    Soil at a toe is the same with p = 1 and its J for chi (Smith 1960).
    """
    x = abs(d)
    if link.exponent == 1.5:
        root = math.sqrt(x)
    else:
        root = x ** (link.exponent - 1)
    g = link.stiffness * d * root
    slope = link.exponent * link.stiffness * root
    if link.damping == 0 or d < 0:
        return g, slope, 0.0
    share = 1 / (1 + g * link.damping * link.mobility)
    pressed = (1 + link.damping * closing) * share
    return g * pressed, slope * pressed * share, g * link.damping * share


def user_force(function: int, d: float, rate: float) -> float:  # noqa: ARG001
    """Force of a law of the user: where there is one, its function stands in place of this."""
    return 0.0


def odd_user_force(link: Any, d: float, rate: float) -> float:
    """Force of a law of the user, which goes on below d = 0, where nobody has defined it."""
    if d < 0:
        return user_force(link.function, 0.0, rate) - user_force(link.function, -d, 0.0)
    return user_force(link.function, d, rate)


def own_force(link: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force F = f(d, d'), N, of a law of the user, and its derivatives by d and by `closing`.

    `closing` is the rate without the own force: d' = closing - Y F, Y the mobility. F is found by
    Newton's method, derivatives of f are differences. Those of F are smaller by the factor `share`,
    as the force slows down the closing that makes it.
    """
    F = odd_user_force(link, d, closing)
    slope = 0.0  # derivative by the rate
    for _ in range(MAX_ITERATIONS):
        rate = closing - link.mobility * F
        f = odd_user_force(link, d, rate)
        f_faster = odd_user_force(link, d, rate + link.rate_step)
        slope = (f_faster - f) / link.rate_step
        change = (f - F) / (1 + link.mobility * slope)
        F += change
        if abs(change) <= FORCE_RTOL * abs(F):
            break
    rate = closing - link.mobility * F
    f = odd_user_force(link, d, rate)
    f_deeper = odd_user_force(link, d + link.overlap_step, rate)
    by_overlap = (f_deeper - f) / link.overlap_step
    share = 1 / (1 + link.mobility * slope)
    return F, by_overlap * share, slope * share


# What ends a status -------------------------------------------------------------------


def guards(link: Any) -> int:
    """How many guards keep the status of a link, see `guard`."""
    if link.status == Status.BOND:
        return 0
    if link.status == Status.PLASTIC and link.knots[link.next_knot] < UNREACHED:
        return 2
    if link.status == Status.GRAZE:
        return 2
    if link.status == Status.PRESS:
        return 1 + (link.law == Law.YIELD) + lets_go(link)  # type: ignore[no-any-return]
    return 1


def drive(link: Any, d: float, closing: float, F: float, scale: float) -> float:
    """What has the sign of the force of a law with losses, without dimension; see `guard`.

    Where it is 0, `closing` is the rate of the overlap.
    """
    if link.law == Law.OWN:
        user_force_now = odd_user_force(link, d, closing - link.mobility * F)
        pressing = user_force_now * link.effective_mobility / scale
    elif has_dashpot(link):
        pressing = (link.stiffness * d / link.damping + closing) / scale
    else:
        pressing = 1 + link.damping * closing
    return pressing  # type: ignore[no-any-return]


def guard(
    link: Any,
    which: int,
    d: float,
    closing: float,
    F: float,
    scale: float,
    length: float,
) -> tuple[float, int]:
    """What must not fall below 0 for the status to last, without dimension, and the next status.

    A dashpot lets go while there is still overlap: GRAZE, until that is gone or it presses again.
    What yields goes on as elastic, with a new yield force, once it no longer closes; at a knot of
    its table it goes on with another hardening.

    Parameters
    ----------
    link : LINK
    which : int
        Which guard, from 0 to `guards` - 1. Guard 0 is the gap (OPEN), the force (REST, and PRESS
        of a rigid link), the rate of closing (PLASTIC), `drive` (PRESS of a spring with a
        dashpot), and else the overlap. Guard 1 is what a force lacks to the next knot (PLASTIC)
        or to the yield force (PRESS of what yields), -`drive` (GRAZE), and else `drive` (PRESS).
        Guard 2 is `drive`, of a contact that yields with damping (PRESS).
    d, closing, F : float
        Overlap, m, closing without the own force, m/s, and force, N.
    scale, length : float
        Scales of velocities, m/s, and of overlaps, m.
    """
    if link.status == Status.OPEN:
        return -d / length, Status.PRESS.value
    if link.status == Status.REST:
        return F / link.resting_force, Status.OPEN.value
    if link.status == Status.PLASTIC and which == 1:
        return 1 - F / link.knots[link.next_knot], Status.PLASTIC.value
    if link.status == Status.PLASTIC:
        return (closing - link.mobility * F) / scale, Status.PRESS.value
    if link.status == Status.PRESS and link.law == Law.RIGID:
        return F * link.mobility / scale, Status.OPEN.value
    pressing = drive(link, d, closing, F, scale)
    if link.status == Status.GRAZE and which == 1:
        return -pressing, Status.PRESS.value
    if link.law == Law.YIELD and which == 1:
        S = F  # static force
        if link.damping > 0:
            S = link.stiffness * d
        return 1 - S / link.yield_force, Status.PLASTIC.value
    if link.status == Status.PRESS and (which > 0 or has_dashpot(link)):
        return pressing, Status.GRAZE.value
    # Guard 0 of GRAZE, and of PRESS without a dashpot: the overlap
    return d / length, Status.OPEN.value


def follows_overlap(link: Any, which: int) -> bool:
    """Whether a guard is the overlap or the gap; others jump where an incoming wave does."""
    if link.status == Status.OPEN:
        return True
    if which > 0 or link.status > Status.PRESS:
        return False
    if link.status == Status.PRESS:
        return not force_jumps(link)
    return True


def break_order(link: Any, order: int) -> Any:
    """Order of the break in a force that a break in the velocity beside the link makes."""
    if link.status == Status.OPEN or link.status == Status.GRAZE:
        return int(link.break_order)
    if link.law <= Law.PUSH_RIGHT or link.law == Law.RIGID or link.damping > 0:
        return min(link.break_order, order)
    return min(link.break_order, order + 1)


# Mean force over a time step ----------------------------------------------------------


def mean_force(link: Any, x0: float, x1: float) -> tuple[float, float]:
    """Mean force of a compliant contact while its overlap goes from x0 to x1, and dF/dx1.

    SPRING: k q + d dq/dt with q = max(x, 0), as long as that presses; POWER: k q^p (1 + d dx/dt);
    averaged along the straight path, cut at 0. Time is counted in steps: dx/dt = x1 - x0.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    k = link.stiffness
    w = x1 - x0
    if link.law == Law.POWER:
        elastic, by_overlap = mean_power(k, link.exponent, x0, x1)
        factor = 1 + link.damping * w
        F = elastic * factor
        dF = by_overlap * factor + elastic * link.damping
    elif link.law == Law.YIELD and x1 > link.yield_force / k:
        end, work, _ = load_plastically(link, x0, x1)
        F = work / w
        dF = max((end - F) / w, 0.0)
    elif link.law == Law.YIELD:
        F, dF = mean_spring(k, 0.0, x0, x1)
    else:
        F, dF = mean_spring(k, link.damping, x0, x1)
    if link.law == Law.YIELD and link.damping > 0:
        factor = 1 + link.damping * w
        dF = dF * factor + F * link.damping
        F = F * factor
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def mean_spring(k: float, d: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean of k x + d dx/dt from x0 to x1 as long as x > 0 and this presses; derivative by x1."""
    w = x1 - x0
    last = k * x1 + d * w
    if x0 >= 0 and last >= 0:
        return k * (x0 + x1) / 2 + d * w, k / 2 + d
    least = max(-d * w / k, 0.0)  # overlap at which it lets go, or begins
    a = max(x0, least)
    b = max(x1, least)
    share = (b - a) / w
    F = share * (k * (a + b) / 2 + d * w)
    return F, (max(last, 0.0) - F) / w + share * d


def mean_power(k: float, p: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean of k x^p, 0 for x < 0, from x0 to x1, and its derivative by x1.

    It is the difference quotient of k x^(p + 1)/(p + 1). Where x1 is near x0, so that this loses
    digits, with h = x1/x0 - 1 it is k x0^p ((1 + h)^(p+1) - 1)/((p + 1) h), or its series in h.
    """
    q = p + 1
    w = x1 - x0
    first = k * max(x0, 0.0) ** p
    last = k * max(x1, 0.0) ** p
    if x0 <= 0 or abs(w) > x0 / 2:
        F = (last * x1 - first * x0) / (q * w)
        return F, (last - F) / w
    F = first
    h = w / x0
    if h != 0:
        F = first * math.expm1(q * math.log1p(h)) / (q * h)
    if abs(q * h) > SERIES_RANGE:
        return F, (last - F) / w
    third = (p - 1) * h
    fourth = third * (p - 2) * h
    series = 1 / 2 + third / 3 + fourth / 8 + fourth * (p - 3) * h / 30
    return F, first / x0 * p * series


def load_plastically(link: Any, x0: float, x1: float) -> tuple[float, float, int]:
    """What yields, pressed from x0 to x1 past its yield force, along the lines of its table.

    Returns
    -------
    float
        Force at x1, which is its yield force from then on.
    float
        Work on the way.
    int
        The next knot.
    """
    k = link.stiffness
    force = link.yield_force
    knot = link.next_knot
    x = force / k
    start = max(x0, 0.0)
    slope = link.hardening_share * k
    work = (x - start) * (force + k * start) / 2
    while force + slope * (x1 - x) > link.knots[knot]:
        knot_force = link.knots[knot]
        part = (knot_force - force) / slope
        work += part * (force + knot_force) / 2
        x = x + part
        force = knot_force
        slope = link.shares[knot] * k
        knot += 1
    part = x1 - x
    end = force + slope * part
    work = work + part * (force + end) / 2
    return end, work, knot
