"""What acts between bodies on a time step: the laws of contact, and links solved together.

A force F > 0 in a link pushes two bodies apart. Over one step the bodies obey linear laws, so links
close by w = free - A F, with A a tridiagonal Stieltjes matrix: a link feels its own force, and
through the body between them those of its two neighbours. Its law gives F from w.

Laws: a compliant contact has the indentation x, and over a step the force (U(x1) - U(x0))/(x1 - x0)
of its stored energy U (discrete gradient: Gonzalez, J. Nonlinear Sci. 6, 1996), the dashpot's mean
over the same path, and pulls nowhere; this is convex and increasing in x1, so Newton's method falls
on the root from the right. A joint is a spring and a dashpot that pull as well. What yields is a
spring up to its strength; x counts from where its faces have moved to. A rigid contact takes the
force that keeps its closing below a limit. An impact of rigid bodies takes the force that leaves a
closing velocity of at most -e times the one before (Moreau, CISM 302, 1988).

Units are those of `records`.
"""

from __future__ import annotations

import math
from typing import Any

from ..laws import Law

EPS = 1 / (1 << 52)
ROUGH = 1 / (1 << 24)  # of the motion: forces that are no better known are none
ENOUGH = 1 / (1 << 27)  # relative Newton step after which the next one is round-off
NEAR = 1 / (1 << 6)  # relative change below which a difference quotient is a series
NEWTON = 100  # iterations of one contact: a bound that is not met in practice
SWEEPS = 1000  # of one chain, see `balance`


def stored(law: int, k: float, p: float, gap: float) -> float:
    """Energy stored in a compliant contact."""
    if law != Law.JOINT and (gap >= 0 or law < Law.SPRING):
        return 0.0
    if p == 1:
        return k * gap * gap / 2
    if p == 1.5:
        return 2 * k * gap * gap * math.sqrt(-gap) / 5
    energy: float = k * (-gap) ** (p + 1) / (p + 1)
    return energy


def mean_power(k: float, p: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean of k x^p from x0 > 0 to x1 > 0, and its derivative by x1; accurate where they are near.

    With h = x1/x0 - 1 it is k x0^p ((1 + h)^(p+1) - 1)/((p + 1) h), or its series in h.
    """
    q, w = p + 1, x1 - x0
    h = w / x0
    force: float = k * x0**p
    if abs(h) > 0.5:
        F = (k * x1**p * x1 - force * x0) / (q * w)
    elif h != 0:
        F = force * math.expm1(q * math.log1p(h)) / (q * h)
    else:
        F = force
    if abs(q * h) > NEAR:
        return F, (k * x1**p - F) / w
    third = (p - 1) * h
    fourth = third * (p - 2) * h
    return F, force / x0 * p * (1 / 2 + third / 3 + fourth / 8 + fourth * (p - 3) * h / 30)


def mean_force(law: int, k: float, p: float, d: float, x0: float, x1: float) -> tuple[float, float]:
    """Mean force of a compliant contact while its indentation goes from x0 to x1, and dF/dx1.

    SPRING: k q + d dq/dt with q = max(x, 0), as long as that presses; POWER: k q^p (1 + d dx/dt);
    averaged along the straight path, cut at 0.
    """
    if x0 <= 0 and x1 <= 0:
        return 0.0, 0.0
    if p == 1:
        w = x1 - x0
        if k * x1 + d * w < 0:  # it lets go on the way
            first = max(k * x0 + d * w, 0.0)
            share = first / (-k * w) if first > 0 else 0.0
            F, dF = first * share / 2, share * (d + k * share / 2)
        elif x0 < 0:
            share = x1 / (x1 - x0)
            F, dF = k * x1 * share / 2 + d * x1, k * share * (2 - share) / 2 + d
        else:
            F, dF = k * (x0 + x1) / 2 + d * w, k / 2 + d
    elif p == 1.5:
        if x1 <= 0:
            F = 2 * k * x0 * x0 * math.sqrt(x0) / (5 * (x0 - x1))
            dF = F / (x0 - x1)
        elif x0 < 0:
            s, share = math.sqrt(x1), x1 / (x1 - x0)
            F, dF = 2 * k * x1 * s * share / 5, k * s * share * (5 - 2 * share) / 5
        else:
            r, s = math.sqrt(x0), math.sqrt(x1)
            rr, rs, ss, sum_ = r * r, r * s, s * s, r + s
            F = 2 * k * (ss * (ss + rs + rr) + rs * rr + rr * rr) / (5 * sum_)
            dF = k * (3 * ss * s + 6 * ss * r + 4 * s * rr + 2 * rr * r) / (5 * sum_ * sum_)
    elif x1 <= 0:
        F = k * x0**p * x0 / ((p + 1) * (x0 - x1))
        dF = F / (x0 - x1)
    elif x0 <= 0:
        share = x1 / (x1 - x0) / (p + 1)
        F, dF = k * x1**p * share, k * x1 ** (p - 1) * share * (p + 1) * (1 - share)
    else:
        F, dF = mean_power(k, p, x0, x1)
    if law == Law.POWER and d > 0:
        stretch = 1 + d * (x1 - x0)
        F, dF = F * stretch, dF * stretch + F * d
    if F <= 0:
        return 0.0, 0.0
    return F, dF


def solve_law(
    law: int, k: float, p: float, d: float, x0: float, c: float, y: float, w: float
) -> tuple[float, float, float]:
    """Solve x1 = x0 + c - y F(x0, x1) for a compliant contact.

    Parameters
    ----------
    x0 : indentation at the step's start
    c : by how much the contact would close without force
    y : mobility of both sides together
    w : guess of how much it closes

    Returns
    -------
    F, x1, dF/dx1
    """
    top = x0 + c
    x = min(x0 + w, top)
    F = slope = 0.0
    for _ in range(NEWTON):
        F, slope = mean_force(law, k, p, d, x0, x)
        r = x - x0 - c + y * F
        step = r / (1 + y * slope)
        F, x = F - slope * step, min(x - step, top)
        size = x if x > 0 else x0 - x
        # the indentation of a stiff contact is small beside what it stops
        near = 0.0 if y * slope > 1 else 4 * EPS * (abs(x0) + abs(c))
        if abs(step) <= max(ENOUGH * size, near):
            break
    if y * slope > 1:  # and its force better known from that
        F = (top - x) / y
    return max(F, 0 * F), x, slope


def past_yield(at: Any, x0: float, c: float, y: float) -> tuple[float, float, float]:
    """What `solve_law` returns, if the contact comes past x = strength/k; else x1 is x0.

    From there the force grows along straight lines, so that the mean force times the path is
    quadratic in x1 on each, which is without what of it moves the faces for good.
    """
    k, force = at.stiffness, at.strength
    most = force / k
    way = most - x0
    mean = (force + k * x0) / 2
    if x0 < 0:
        mean = force * (most / way) / 2
    if way - c + y * mean >= 0:
        return 0.0, x0, 0.0
    energy = mean * way
    w, soft, knot = way, at.damping * k / 2, at.knot
    while True:  # over the lines of the table
        a, b = 1 + y * soft, (c - y * (force - 2 * soft * way)) / 2
        rest = y * (energy - way * (force - soft * way))
        root = math.sqrt(max(b * b - a * rest, 0.0))
        w = (b + root) / a if b >= 0 else rest / (b - root)
        if soft * (w - way) * 2 <= at.knots[knot] - force:
            break
        part = (at.knots[knot] - force) / (2 * soft)
        energy += part * (force + at.knots[knot]) / 2
        way, force = way + part, at.knots[knot]
        soft = at.shares[knot] * k / 2
        knot += 1
    if w <= most - x0:  # round-off: it comes to that point, not past it
        return 0.0, x0, 0.0
    end = force + 2 * soft * (w - way)
    F = (energy + (w - way) * (force + end) / 2) / w
    slope = max((end - F) / w, 0.0)
    if y * slope > 1:
        F = (c - w) / y
    return F, x0 + w, slope


def harden(at: Any) -> None:
    """Enter the strength of what has come past its yield point, along the lines of its table."""
    further = at.place - at.strength / at.stiffness
    while True:
        grown = at.strength + at.damping * at.stiffness * further
        if grown <= at.knots[at.knot]:
            at.strength = grown
            return
        further -= (at.knots[at.knot] - at.strength) / (at.damping * at.stiffness)
        at.strength, at.damping = at.knots[at.knot], at.shares[at.knot]
        at.knot += 1


def solve_joint(
    k: float, rate: float, x0: float, c: float, y: float
) -> tuple[float, float, float]:
    """What `solve_law` returns for a spring and a dashpot that pull as well."""
    slope = k / 2 + rate
    ease = 1 + y * slope
    return (k * x0 + slope * c) / ease, x0 + (c - y * k * x0) / ease, slope


def solve_link(at: Any, c: float) -> tuple[float, float, float]:
    """Solve any compliant contact that closes by c without its own force; see `solve_law`."""
    k, p, x0, y, rate = at.stiffness, at.exponent, -at.gap, at.own, at.damping
    if at.law == Law.JOINT:
        return solve_joint(k, rate, x0, c, y)
    if at.law == Law.YIELD:
        F, x, slope = past_yield(at, x0, c, y)
        if x > at.strength / k:
            return F, x, slope
        rate = 0.0
    return solve_law(at.law, k, p, rate, x0, c, y, at.place + at.gap)


def indent(at: Any) -> float:
    """Enter what a compliant contact loses on its way to `at.place` under the mean force.

    One that yields hardens, and its faces move for good.

    Returns
    -------
    float
        Its gap.
    """
    k, p, x = at.stiffness, at.exponent, at.place
    rest: float = -x
    if at.law == Law.YIELD and x > at.strength / k:
        harden(at)
        rest = -at.strength / k
    if at.damping > 0 or at.law == Law.YIELD:
        energy = stored(at.law, k, p, at.gap) - stored(at.law, k, p, rest)
        at.lost += at.force * (at.gap + x) + energy
    return rest


def pushed(link: Any, i: int, first: int, last: int) -> float:
    """By how much link i would close without its own force."""
    c: float = link[i].free
    if i > first:
        c += link[i].shared * link[i - 1].force
    if i < last:
        c += link[i + 1].shared * link[i + 1].force
    return c


def relax(link: Any, first: int, last: int) -> float:
    """Solve link after link, the others as they are; return the largest change of a closing."""
    change = 0.0
    for i in range(first, last + 1):
        at, c = link[i], pushed(link, i, first, last)
        if at.law == Law.RIGID or at.law == Law.IMPACT:
            F, slope = (c - at.limit) / at.own, -1.0
            if F <= 0:
                F = slope = 0.0
        else:
            F, at.place, slope = solve_link(at, c)
        change = max(change, abs(F - at.force) * at.own)
        at.force, at.slope = F, slope
    return change


def newton(link: Any, first: int, last: int) -> None:
    """Take a Newton step for all links together, each law replaced by its tangent."""
    for i in range(first, last + 1):
        at, s = link[i], link[i].slope
        if s < 0:
            s, middle, right = -s, at.own, at.free - at.limit
        else:
            middle = 1 + s * at.own
            right = at.force + s * (at.free - at.place - at.gap)
        pivot = middle
        if i > first:
            right += s * at.shared * link[i - 1].force
            pivot += s * at.shared * link[i - 1].upper
        if pivot <= 4 * EPS * middle:
            pivot = middle
        at.force, at.upper = right / pivot, 0.0
        if i < last:
            at.upper = -s * link[i + 1].shared / pivot
    for i in range(last, first - 1, -1):
        at = link[i]
        if i < last:
            at.force -= at.upper * link[i + 1].force
        if at.law >= Law.RIGID:
            at.force = max(at.force, 0.0)


def balance(link: Any, first: int, last: int, speed: float) -> bool:
    """Find the forces of a chain; return False where there are none (a mass squeezed by walls).

    Sweeps of `relax` descend on a convex function, the dual energy of the step, and so always
    converge, if slowly; a Newton step is kept where it halves what the next sweep has to change.
    One link alone needs one sweep. `speed` is that of the bodies, whose round-off is no change.
    """
    left, tried, size = math.inf, False, speed
    for _ in range(2 * SWEEPS):
        new = relax(link, first, last)
        if tried and new > left / 2:
            for i in range(first, last + 1):
                link[i].force = link[i].kept
            tried = False
            continue
        left, tried, size = new, True, speed
        for i in range(first, last + 1):
            size = max(size, speed + abs(link[i].force) * link[i].own)
            link[i].kept = link[i].force
        if first == last or left <= 8 * EPS * size:
            return True
        newton(link, first, last)
    return bool(left <= ROUGH * size)


def start_impacts(link: Any, first: int, last: int, tol: float) -> bool:
    """Let impacts happen whose gaps would close in this step; return whether there is a new one.

    An impact waits with an infinite limit.
    """
    struck = False
    for i in range(first, last + 1):
        at = link[i]
        if at.law == Law.IMPACT and at.limit == math.inf:
            w = pushed(link, i, first, last) - at.force * at.own
            if at.gap - w < -tol:
                u = at.before
                at.limit = 0.0 if u <= tol else (1 - at.damping) * u / 2
                struck = True
    return struck


def settle(at: Any, w: float, tol: float) -> float:
    """Enter what a link loses while it closes by w; return its gap at the end of the step."""
    F: float = at.force
    rest: float = at.gap - w
    if at.law == Law.RIGID:
        at.numerical += F * w
        shut = at.shut > 0
        at.shut = 1
        if shut and F <= 0 and 2 * w - at.before < -tol:
            at.shut = 0
            rest = at.before / 2 - w
        elif shut:
            rest = 0.0
        elif F <= 0:
            at.shut = 0
    elif at.law == Law.IMPACT:
        if F > 0:
            at.lost += F * at.limit
            rest = at.gap - at.limit
        elif at.gap <= 0 and abs(w) <= tol:
            rest = at.gap
    else:
        rest = indent(at)
    return rest


def count(at: Any, resolution: float) -> None:
    """Enter the force of a step in the totals of a link; a joint never opens."""
    F = at.force
    if F > 0 or at.law == Law.JOINT:
        at.impulse += F
    if at.law == Law.JOINT:
        return
    if F > 0:
        at.episodes += at.open
        at.open = 0
    elif at.gap > resolution:
        at.open = 1
