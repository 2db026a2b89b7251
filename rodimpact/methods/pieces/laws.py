"""What acts in a link: its force, and what must not fall below 0 for its status to last."""

import math
from typing import Any

from ...model.laws import UNREACHED
from ..laws import Law, Status

ROUNDS, ENOUGH = (
    20,
    1e-14,
)  # to find a force that depends on the rate it makes; relative


def own(function: int, d: float, rate: float) -> float:  # noqa: ARG001
    """Force of a law of the user: where there is one, its function stands in place of this."""
    return 0.0


def of_function(it: Any, d: float, rate: float) -> float:
    """Force of a law of the user, which goes on below d = 0, where nobody has defined it."""
    if d < 0:
        return own(it.function, 0.0, rate) - own(it.function, -d, 0.0)
    return own(it.function, d, rate)


def force_of_own(it: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force F = f(d, closing - Y F) of a law of the user, and its derivatives by differences."""
    F, slope = of_function(it, d, closing), 0.0
    for _ in range(ROUNDS):
        rate = closing - it.mobility * F
        f = of_function(it, d, rate)
        slope = (of_function(it, d, rate + it.near_rate) - f) / it.near_rate
        change = (f - F) / (1 + it.mobility * slope)
        F += change
        if abs(change) <= ENOUGH * abs(F):
            break
    rate = closing - it.mobility * F
    by_overlap = (
        of_function(it, d + it.near, rate) - of_function(it, d, rate)
    ) / it.near
    share = 1 / (1 + it.mobility * slope)
    return F, by_overlap * share, slope * share


def force(it: Any, d: float, closing: float) -> tuple[float, float, float]:
    """Force of a link that is not open, and its derivatives by overlap d and `closing`.

    A dashpot feels the rate d' = closing - Y F, which holds the force itself; the laws are solved
    for it: F = k d + c d' and F = g (1 + c d') with g = k d^p (Hunt and Crossley 1975).
    Beyond d = 0 a power goes on as an odd function: Newton's method and the search for d = 0 pass.
    """
    if it.status == Status.REST:  # whatever force it takes
        return closing, 0.0, 1.0
    if it.law == Law.BOND or it.law == Law.RIGID:
        return closing / it.mobility, 0.0, 1 / it.mobility
    if it.law == Law.OWN:
        return force_of_own(it, d, closing)
    if it.law != Law.POWER:
        share = 1 / (1 + it.damping * it.mobility)
        F = (it.stiffness * d + it.damping * closing) * share
        return F, it.stiffness * share, it.damping * share
    x = abs(d)
    if it.exponent == 1.5:
        root = math.sqrt(x)
    else:
        root = x ** (it.exponent - 1)
    g, slope = it.stiffness * d * root, it.exponent * it.stiffness * root
    if it.damping == 0 or d < 0:
        return g, slope, 0.0
    share = 1 / (1 + g * it.damping * it.mobility)
    pressed = (1 + it.damping * closing) * share
    return g * pressed, slope * pressed * share, g * it.damping * share


def guards(it: Any) -> int:
    """How many numbers keep the status of a link."""
    if it.status == Status.BOND:
        return 0
    if it.status == Status.PLASTIC and it.knots[it.knot] < UNREACHED:
        return 2
    damped = it.law == Law.OWN or (it.law == Law.POWER and it.damping > 0)
    if it.status == Status.GRAZE or (
        it.status == Status.PRESS and (it.law == Law.YIELD or damped)
    ):
        return 2
    return 1


def guard(
    it: Any, which: int, d: float, closing: float, F: float, scale: float, length: float
) -> tuple[float, int]:
    """What must not fall below 0 for the status to last, without dimension, and the next status.

    A dashpot lets go while there is still overlap: SLACK, until that is gone or it presses again.
    What yields goes on as elastic, with a new yield force, once it no longer closes; at a knot of
    its table it goes on with another hardening.
    """
    if it.status == Status.OPEN:
        return -d / length, Status.PRESS.value
    if it.status == Status.REST:
        return F / it.resting_force, Status.OPEN.value
    if it.status == Status.PLASTIC and which == 1:
        return 1 - F / it.knots[it.knot], Status.PLASTIC.value
    if it.status == Status.PLASTIC:
        return (closing - it.mobility * F) / scale, Status.PRESS.value
    if it.status == Status.PRESS and it.law == Law.RIGID:
        return F * it.mobility / scale, Status.OPEN.value
    dashpot = it.law == Law.SPRING and it.damping > 0
    if it.law == Law.OWN:
        drive = of_function(it, d, closing - it.mobility * F) * it.ease / scale
    elif dashpot:
        drive = (it.stiffness * d / it.damping + closing) / scale
    else:
        drive = 1 + it.damping * closing
    if it.status == Status.GRAZE and which == 1:
        return -drive, Status.PRESS.value
    if it.law == Law.YIELD and which == 1:
        return 1 - F / it.yield_force, Status.PLASTIC.value
    if it.status == Status.PRESS and (which == 1 or dashpot):
        return drive, Status.GRAZE.value
    return d / length, Status.OPEN.value


def follows_overlap(it: Any, which: int) -> bool:
    """Whether a guard is the overlap or the gap; others jump where an incoming wave does."""
    if it.status == Status.OPEN:
        return True
    if which == 1 or it.status > Status.PRESS:
        return False
    if it.status == Status.PRESS:
        dashpot = it.law == Law.SPRING and it.damping > 0
        return not (it.law == Law.RIGID or dashpot)
    return True


def smooths(it: Any, order: int) -> int:
    """Order of the break in a force that a break in the velocity beside the link makes."""
    if it.status == Status.OPEN or it.status == Status.GRAZE:
        return int(it.order)
    if it.law <= Law.PUSH_RIGHT or it.law == Law.RIGID or it.damping > 0:
        return min(it.order, order)
    return min(it.order, order + 1)
