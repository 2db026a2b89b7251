"""What acts between bodies on a time step: the laws of contact, and links solved together.

A force F > 0 in a link pushes two bodies apart. Over one step the bodies obey linear laws, so links
close by w = free - A F, with A a tridiagonal Stieltjes matrix: a link feels its own force, and
through the body between them those of its two neighbours. Its law gives F from w.

Laws: a compliant contact has the indentation x, and over a step the force (U(x1) - U(x0))/(x1 - x0)
of its stored energy U (discrete gradient: Gonzalez, J. Nonlinear Sci. 6, 1996), the dashpot's mean
over the same path, and pulls nowhere; this is convex and increasing in x1, so Newton's method falls
on the root from the right. A joint is a spring and a dashpot that pull as well. What yields is a
spring up to its yield force; x counts from where its faces have moved to. A rigid contact takes the
force that keeps its closing below a limit. An impact of rigid bodies takes the force that leaves a
closing velocity of at most -e times the one before (Moreau, CISM 302, 1988).

Units are those of `records`.
"""

import math
from typing import Any

from ..laws import Law

EPS = 1 / (1 << 52)
ROUGH = 1 / (1 << 24)  # of the motion: forces that are no better known are none
ENOUGH = 1 / (1 << 27)  # relative Newton step after which the next one is round-off
NEAR = 1 / (1 << 6)  # relative change below which a difference quotient is a series
NEWTON = 100  # iterations of one contact: a bound that is not met in practice
SWEEPS = 1000  # of one chain, see `balance`


def mean_spring(k: float, d: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean of k x + d dx/dt from x0 to x1 as long as x > 0 and this presses; derivative by x1."""
    w = x1 - x0
    last = k * x1 + d * w
    if x0 >= 0 and last >= 0:
        return k * (x0 + x1) / 2 + d * w, k / 2 + d
    least = max(-d * w / k, 0.0)  # where it lets go, or begins
    a, b = max(x0, least), max(x1, least)
    share = (b - a) / w
    F = share * (k * (a + b) / 2 + d * w)
    return F, (max(last, 0.0) - F) / w + share * d


def mean_power(k: float, p: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean of k x^p, 0 for x < 0, from x0 to x1, and its derivative by x1.

    It is the difference quotient of k x^(p + 1)/(p + 1). Where x1 is near x0, so that this loses
    digits, with h = x1/x0 - 1 it is k x0^p ((1 + h)^(p+1) - 1)/((p + 1) h), or its series in h.
    """
    q, w = p + 1, x1 - x0
    first, last = k * max(x0, 0.0) ** p, k * max(x1, 0.0) ** p
    if x0 <= 0 or abs(w) > x0 / 2:
        F = (last * x1 - first * x0) / (q * w)
        return F, (last - F) / w
    F, h = first, w / x0
    if h != 0:
        F = first * math.expm1(q * math.log1p(h)) / (q * h)
    if abs(q * h) > NEAR:
        return F, (last - F) / w
    third = (p - 1) * h
    fourth = third * (p - 2) * h
    return F, first / x0 * p * (
        1 / 2 + third / 3 + fourth / 8 + fourth * (p - 3) * h / 30
    )


def loaded(at: Any, x0: float, x1: float) -> tuple[float, float, int]:
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
    k, force, knot = at.stiffness, at.yield_force, at.knot
    x, start, slope = force / k, max(x0, 0.0), at.hardening_share * k
    work = (x - start) * (force + k * start) / 2
    while force + slope * (x1 - x) > at.knots[knot]:
        part = (at.knots[knot] - force) / slope
        work += part * (force + at.knots[knot]) / 2
        x, force, slope = x + part, at.knots[knot], at.shares[knot] * k
        knot += 1
    end = force + slope * (x1 - x)
    return end, work + (x1 - x) * (force + end) / 2, knot


def mean_force(at: Any, x0: float, x1: float) -> tuple[float, float]:
    """Mean force of a compliant contact while its indentation goes from x0 to x1, and dF/dx1.

    SPRING: k q + d dq/dt with q = max(x, 0), as long as that presses; POWER: k q^p (1 + d dx/dt);
    averaged along the straight path, cut at 0.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    k, d, w = at.stiffness, at.damping, x1 - x0
    if at.law == Law.POWER:
        F, dF = mean_power(k, at.exponent, x0, x1)
        stretch = 1 + d * w
        F, dF = F * stretch, dF * stretch + F * d
    elif at.law == Law.YIELD and x1 > at.yield_force / k:
        end, work, _ = loaded(at, x0, x1)
        F = work / w
        dF = max((end - F) / w, 0.0)
    else:
        F, dF = mean_spring(k, d if at.law == Law.SPRING else 0.0, x0, x1)
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def solve_link(at: Any, c: float) -> tuple[float, float, float]:
    """Solve x1 = x0 + c - y F(x0, x1) for a compliant contact or joint, y its mobility.

    Parameters
    ----------
    at : LINK
        x0 is -at.gap, and at.place a guess of x1.
    c : by how much it would close without its own force

    Returns
    -------
    F, x1, dF/dx1
    """
    x0, y = -at.gap, at.own
    top = x0 + c
    if at.law == Law.JOINT:  # which pulls as well
        k, slope = at.stiffness, at.stiffness / 2 + at.damping
        ease = 1 + y * slope
        return (k * x0 + slope * c) / ease, x0 + (c - y * k * x0) / ease, slope
    x, yields = min(at.place, top), False
    if (
        at.law == Law.YIELD
    ):  # the mean force bends both ways, its work only up: from the right
        most = at.yield_force / at.stiffness
        yields = most - top + y * mean_force(at, x0, most)[0] < 0
        x = top if yields else min(most, top)
    F = slope = 0.0
    for _ in range(NEWTON):
        F, slope = mean_force(at, x0, x)
        r = x - top + y * F
        step = r / (1 + y * slope + (r / (x - x0) if yields else 0.0))
        F, x = F - slope * step, min(x - step, top)
        size = x if x > 0 else x0 - x
        # the indentation of a stiff contact is small beside what it stops
        near = 0.0 if y * slope > 1 else 4 * EPS * (abs(x0) + abs(c))
        if abs(step) <= max(ENOUGH * size, near):
            break
    if y * slope > 1:  # and its force better known from that
        F = (top - x) / y
    return max(F, 0 * F), x, slope


def pushed(link: Any, i: int) -> float:
    """By how much link i would close without its own force.

    The first link of a chain shares nothing with what comes before it; behind the last of all links
    comes the first.
    """
    at, after = link[i], link[i + 1 - len(link)]
    c: float = at.free + at.shared * link[i - 1].force + after.shared * after.force
    return c


def relax(link: Any, first: int, last: int, speed: float) -> tuple[float, float]:
    """Solve link after link, the others as they are.

    Returns
    -------
    float
        The largest change of a closing.
    float
        The largest speed there is: that of the bodies, and what a force changes in a closing.
    """
    change, size = 0.0, speed
    for i in range(first, last + 1):
        at, c = link[i], pushed(link, i)
        if at.law == Law.RIGID or at.law == Law.IMPACT:
            F, slope = (c - at.limit) / at.own, -1.0
            if F <= 0:
                F = slope = 0.0
        else:
            F, at.place, slope = solve_link(at, c)
        change = max(change, abs(F - at.force) * at.own)
        at.force, at.slope = F, slope
        size = max(size, speed + abs(F) * at.own)
    return change, size


def newton(link: Any, first: int, last: int) -> None:
    """Take a Newton step for all links together, each law replaced by its tangent.

    The forces before it are kept.
    """
    for i in range(first, last + 1):
        at, before, s = link[i], link[i - 1], link[i].slope
        if s < 0:
            s, middle, right = -s, at.own, at.free - at.limit
        else:
            middle = 1 + s * at.own
            right = at.force + s * (at.free - at.place - at.gap)
        right += s * at.shared * before.force
        pivot = middle + s * at.shared * before.upper
        if pivot <= 4 * EPS * middle:
            pivot = middle
        at.kept, at.force = at.force, right / pivot
        at.upper = -s * link[i + 1 - len(link)].shared / pivot
    for i in range(last, first - 1, -1):
        at = link[i]
        at.force -= at.upper * link[i + 1 - len(link)].force
        if at.law >= Law.RIGID:
            at.force = max(at.force, 0.0)


def balance(link: Any, first: int, last: int, speed: float) -> bool:
    """Find the forces of a chain; return False where there are none (a mass squeezed by walls).

    Sweeps of `relax` descend on a convex function, the dual energy of the step, and so always
    converge, if slowly; a Newton step is kept where it halves what the next sweep has to change.
    One link alone needs one sweep. `speed` is that of the bodies, whose round-off is no change.
    """
    left, size, tried, sweeps = math.inf, speed, False, 2 * SWEEPS
    while sweeps > 0:
        new, large = relax(link, first, last, speed)
        sweeps -= 1
        if tried and new > left / 2:
            tried = False
            for i in range(first, last + 1):
                link[i].force = link[i].kept
        else:
            left, size, tried = new if first < last else 0.0, large, True
            if left > 8 * EPS * size:
                newton(link, first, last)
            else:
                sweeps = 0
    return bool(left <= ROUGH * size)


def start_impacts(link: Any, first: int, last: int, tol: float) -> bool:
    """Let impacts happen whose gaps would close in this step; return whether there is a new one.

    An impact waits with an infinite limit.
    """
    struck = False
    for i in range(first, last + 1):
        at, w = link[i], pushed(link, i) - link[i].force * link[i].own
        if at.limit == math.inf and at.gap - w < -tol:
            u = at.before
            at.limit = 0.0 if u <= tol else (1 - at.restitution) * u / 2
            struck = True
    return struck


def settle(at: Any, w: float, tol: float) -> float:
    """Return the gap of a link at the end of a step in which it closes by w."""
    stiff = at.law == Law.RIGID or at.law == Law.IMPACT
    rest: float = at.gap - w if stiff else -at.place
    if at.law == Law.RIGID:
        if at.shut == 0:
            at.shut = 1 if at.force > 0 else 0
        elif at.force <= 0 and 2 * w - at.before < -tol:
            at.shut, rest = 0, at.before / 2 - w
        else:
            rest = 0.0
    elif at.law == Law.IMPACT and at.force <= 0 and at.gap <= 0 and abs(w) <= tol:
        rest = at.gap
    elif at.law == Law.YIELD and at.place > at.yield_force / at.stiffness:
        # it hardens, and its faces move for good
        at.yield_force, _, knot = loaded(at, -at.gap, at.place)
        if knot > at.knot:
            at.knot, at.hardening_share = knot, at.shares[knot - 1]
        rest = -at.yield_force / at.stiffness
    return rest
