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

Time is counted in steps: lengths are velocity times steps, and masses and stiffnesses are scaled to
match: M/h, k h^p for a force k x^p, a dashpot's constant as it is. `links` are the columns of
`grid_kernel.Links`, of which `damping` is of YIELD the hardening, as a share of the stiffness, and
`strength` the force at which it yields now.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..laws import HUNT, IMPACT, JOINT, RIGID, SPRING, YIELD

EPS = 1 / (1 << 52)
ROUGH = 1 / (1 << 24)  # of the motion: forces that are no better known are none
ENOUGH = 1 / (1 << 27)  # relative Newton step after which the next one is round-off
NEAR = 1 / (1 << 6)  # relative change below which a difference quotient is a series
NEWTON = 100  # iterations of one contact: a bound that is not met in practice
SWEEPS = 1000  # of one chain, see `balance`


class Tally(NamedTuple):
    """What has passed through each link, kept as the run goes."""

    impulse: Any  # [link] sum of F
    lost: Any  # [link] turned to heat by dashpots and impacts
    numerical: Any  # [link] lost by rigid contacts that close within a step
    episodes: Any  # [link] number of times an open contact began to press


class Chain(NamedTuple):
    """Room for links that are solved together; lists or arrays of floats."""

    free: Any  # by how much the link would close without forces
    own: Any  # mobility of its two sides together
    shared: Any  # mobility that it shares with the link before
    before: Any  # velocity at which an impact closes as it begins
    force: Any
    kept: Any  # forces before a Newton step
    limit: Any  # greatest closing of a pressing rigid contact or impact
    place: Any  # indentation at the step's end
    slope: Any  # dF/dw, -1 where the closing w is fixed
    upper: Any  # for the elimination


def stored(law: int, k: float, p: float, gap: float) -> float:
    """Energy stored in a compliant contact."""
    if law != JOINT and (gap >= 0 or law < SPRING):
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

    SPRING: k q + d dq/dt with q = max(x, 0), as long as that presses; HERTZ: k q^(3/2); HUNT: the
    same times (1 + d dx/dt); POWER: k q^p; averaged along the straight path, cut at 0.
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
    if law == HUNT:
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


def past_yield(
    k: float, hardening: float, strength: float, x0: float, c: float, y: float
) -> tuple[float, float, float]:
    """What `solve_law` returns, if the contact comes past x = strength/k; else x1 is x0.

    From there the force grows by `hardening` k, so that the mean force times the path is quadratic
    in x1, which is without what of it moves the faces for good.
    """
    most = strength / k
    path, F, slope = most - x0, (strength + k * x0) / 2, k / 2
    if x0 < 0:
        share = most / path
        F, slope = strength * share / 2, slope * share * (2 - share)
    if path - c + y * F >= 0:
        return 0.0, x0, 0.0
    soft = hardening * k / 2
    a, b = 1 + y * soft, (c - y * (strength - 2 * soft * path)) / 2
    rest = y * path * (strength - F - soft * path)
    root = math.sqrt(max(b * b + a * rest, 0.0))
    w = (b + root) / a if b >= 0 else rest / (root - b)
    if w <= path:  # round-off: it comes to that point, not past it
        return 0.0, x0, 0.0
    elastic, plastic = path / w, (w - path) / w
    F = elastic * F + plastic * (strength + soft * (w - path))
    slope = elastic * (elastic * slope + plastic * 2 * soft) + plastic * plastic * soft
    if y * slope > 1:
        F = (c - w) / y
    return F, x0 + w, slope


def solve_joint(
    k: float, rate: float, x0: float, c: float, y: float
) -> tuple[float, float, float]:
    """What `solve_law` returns for a spring and a dashpot that pull as well."""
    slope = k / 2 + rate
    ease = 1 + y * slope
    return (k * x0 + slope * c) / ease, x0 + (c - y * k * x0) / ease, slope


def solve_link(
    law: int, k: float, p: float, damping: float, strength: float, x0: float, c: float, y: float,
    w: float,
) -> tuple[float, float, float]:
    """Solve any compliant contact; see `solve_law`."""
    rate = damping
    if law == JOINT:
        return solve_joint(k, rate, x0, c, y)
    if law == YIELD:
        F, x, slope = past_yield(k, damping, strength, x0, c, y)
        if x > strength / k:
            return F, x, slope
        law, rate = SPRING, 0.0
    return solve_law(law, k, p, rate, x0, c, y, w)


def indent(links: Any, tally: Tally, i: int, F: float, x: float) -> float:
    """Enter what compliant contact i loses on its way to x under the mean force F; return its gap.

    One that yields hardens, and its faces move for good.
    """
    law, k, p, gap = links.law[i], links.stiffness[i], links.exponent[i], links.gap[i]
    rest = -x
    if law == YIELD and x > links.strength[i] / k:
        links.strength[i] += links.damping[i] * (k * x - links.strength[i])
        rest = -links.strength[i] / k
    if links.damping[i] > 0 or law == YIELD:
        tally.lost[i] += F * (gap + x) + (stored(law, k, p, gap) - stored(law, k, p, rest))
    return rest


def pushed(chain: Chain, q: int, last: int) -> float:
    """By how much link q would close without its own force."""
    c: float = chain.free[q]
    if q > 0:
        c += chain.shared[q] * chain.force[q - 1]
    if q < last:
        c += chain.shared[q + 1] * chain.force[q + 1]
    return c


def relax(links: Any, chain: Chain, i0: int, last: int) -> float:
    """Solve link after link, the others as they are; return the largest change of a closing."""
    change = 0.0
    for q in range(last + 1):
        i, y, c = i0 + q, chain.own[q], pushed(chain, q, last)
        law, slope = links.law[i], 0.0
        if law in (RIGID, IMPACT):
            F = (c - chain.limit[q]) / y
            slope = -1.0
            if F <= 0:
                F = slope = 0.0
        else:
            gap = links.gap[i]
            F, chain.place[q], slope = solve_link(
                law, links.stiffness[i], links.exponent[i], links.damping[i], links.strength[i],
                -gap, c, y, chain.place[q] + gap,
            )
        change = max(change, abs(F - chain.force[q]) * y)
        chain.force[q], chain.slope[q] = F, slope
    return change


def newton(links: Any, chain: Chain, i0: int, last: int) -> None:
    """Take a Newton step for all links together, each law replaced by its tangent."""
    F, upper = chain.force, chain.upper
    for q in range(last + 1):
        y, s, c = chain.own[q], chain.slope[q], chain.free[q]
        if s < 0:
            s, middle, right = -s, y, c - chain.limit[q]
        else:
            middle = 1 + s * y
            right = F[q] + s * (c - chain.place[q] - links.gap[i0 + q])
        pivot = middle
        if q > 0:
            right += s * chain.shared[q] * F[q - 1]
            pivot += s * chain.shared[q] * upper[q - 1]
        if pivot <= 4 * EPS * middle:
            pivot = middle
        F[q], upper[q] = right / pivot, 0.0
        if q < last:
            upper[q] = -s * chain.shared[q + 1] / pivot
    for q in range(last, -1, -1):
        if q < last:
            F[q] -= upper[q] * F[q + 1]
        if links.law[i0 + q] >= RIGID:
            F[q] = max(F[q], 0.0)


def balance(links: Any, chain: Chain, i0: int, last: int, speed: float) -> bool:
    """Find the forces of a chain; return False where there are none (a mass squeezed by walls).

    Sweeps of `relax` descend on a convex function, the dual energy of the step, and so always
    converge, if slowly; a Newton step is kept where it halves what the next sweep has to change.
    One link alone needs one sweep. `speed` is that of the bodies, whose round-off is no change.
    """
    left, tried, size = math.inf, False, speed
    for _ in range(2 * SWEEPS):
        new = relax(links, chain, i0, last)
        if tried and new > left / 2:
            for q in range(last + 1):
                chain.force[q] = chain.kept[q]
            tried = False
            continue
        left, tried, size = new, True, speed
        for q in range(last + 1):
            size = max(size, speed + abs(chain.force[q]) * chain.own[q])
            chain.kept[q] = chain.force[q]
        if last == 0 or left <= 8 * EPS * size:
            return True
        newton(links, chain, i0, last)
    return bool(left <= ROUGH * size)


def start_impacts(links: Any, chain: Chain, i0: int, last: int, tol: float) -> bool:
    """Let impacts happen whose gaps would close in this step; return whether there is a new one.

    An impact waits with an infinite limit.
    """
    struck = False
    for q in range(last + 1):
        i = i0 + q
        if links.law[i] == IMPACT and chain.limit[q] == math.inf:
            w = pushed(chain, q, last) - chain.force[q] * chain.own[q]
            if links.gap[i] - w < -tol:
                u = chain.before[q]
                chain.limit[q] = 0.0 if u <= tol else (1 - links.damping[i]) * u / 2
                struck = True
    return struck


def record_step(
    links: Any, tally: Tally, signals: Any, i: int, j: int, F: float, gap: float
) -> None:
    """Enter step j of contact i: its force, and the gap at the end.

    `links.open` is 1 once the contact has opened; a joint never does.
    """
    start = signals.link_start[i]
    if start >= 0:
        signals.force[start + j] = F
        signals.gap[start + j] = gap
    links.force[i], links.gap[i] = F, gap
    if F > 0 or links.law[i] == JOINT:
        tally.impulse[i] += F
    if links.law[i] == JOINT:
        return
    if F > 0:
        tally.episodes[i] += links.open[i]
        links.open[i] = 0
    elif gap > 0:
        links.open[i] = 1
