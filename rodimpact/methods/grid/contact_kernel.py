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

from .. import contact_laws
from ..link import Law

EPS = 1 / (1 << 52)
ROUGH = 1 / (1 << 24)  # of the motion: forces that are no better known are none
ENOUGH = 1 / (1 << 27)  # relative Newton step after which the next one is round-off
NEWTON = 100  # iterations of one contact: a bound that is not met in practice
SWEEPS = 1000  # of one chain, see `balance`


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
        yields = most - top + y * contact_laws.mean_force(at, x0, most)[0] < 0
        x = top if yields else min(most, top)
    F = slope = 0.0
    for _ in range(NEWTON):
        F, slope = contact_laws.mean_force(at, x0, x)
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
        at.yield_force, _, knot = contact_laws.load_plastically(at, -at.gap, at.place)
        if knot > at.knot:
            at.knot, at.hardening_share = knot, at.shares[knot - 1]
        rest = -at.yield_force / at.stiffness
    return rest
