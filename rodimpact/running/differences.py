"""Derivatives on both sides of a point, by Richardson's extrapolation.

It starts from values at halved steps. A polynomial through the values at a few
consecutive steps is extrapolated to the step 0. Such a window of steps has a bound: how
far it lies from the window of one step less, and what noise of the values may do to it.
Windows are taken from the smallest steps to the largest. The first that contradicts
those before it reaches beyond a kink, and ends the search. The window with the least
bound is the result.

C. Brezinski, M. Redivo Zaglia, Extrapolation Methods, North-Holland 1991.
"""

import math
from typing import NamedTuple

import numpy as np

from ..methods.row import Array

MAX_ORDER = 5  # order of a window: higher ones amplify noise, and gain nothing
TRUNCATION_SAFETY = 10.0  # stated truncation error over the change by the last order


class Estimate(NamedTuple):
    """A limit for steps that go to 0."""

    value: Array
    error: Array  # stated error: inf where there is no limit


def _difference(below: Estimate, above: Estimate) -> Estimate:
    """The second estimate minus the first one; the errors add up."""
    return Estimate(above.value - below.value, above.error + below.error)


class Sides(NamedTuple):
    """A function at a point: derivatives and values on both sides.

    The central derivative is here, too.
    """

    below: Estimate  # derivative on the side of smaller arguments
    above: Estimate  # derivative on the side of larger arguments
    value_below: Estimate  # limit of the function itself
    value_above: Estimate
    central: Estimate  # derivative, if it is the same on both sides

    @property
    def jump(self) -> Estimate:
        """Value above minus value below."""
        return _difference(self.value_below, self.value_above)

    @property
    def bend(self) -> Estimate:
        """Derivative above minus derivative below."""
        return _difference(self.below, self.above)

    @property
    def smooth(self) -> Array:
        """Whether values and derivatives on both sides agree within their errors."""
        continuous = np.abs(self.jump.value) <= self.jump.error
        straight = np.abs(self.bend.value) <= self.bend.error
        return np.asarray(continuous & straight)


def sides_of(below: Array, above: Array, steps: Array, noise: Array) -> Sides:
    """Derivatives and values of a function at a point, extrapolated from both sides.

    The central derivative is there as well. Each is an `Estimate` of the shape [...],
    with its error; where it cannot be found it is nan, with the error inf.

    Parameters
    ----------
    below, above : [step, ...] array
        Values of the function at the point minus and plus each step; nan where it has
        none.
    steps : [step, ...] array
        Each half the one before.
    noise : [...] array
        Bound of the error of the values.
    """
    # Distance between the arguments of neighbouring steps, [step - 1, ...]. The later
    # one is nearer to the point: below it is the larger argument, above the smaller.
    between = steps[:-1] - steps[1:]
    slopes_below = (below[1:] - below[:-1]) / between
    slopes_above = (above[:-1] - above[1:]) / between
    central_slopes = (above - below) / (2 * steps)
    # A slope has the noise of two values, over their distance.
    amplification = 2 / between
    central_amplification = 1 / steps
    ones = np.ones_like(steps)
    return Sides(
        below=limit(slopes_below, amplification, noise, ratio=2),
        above=limit(slopes_above, amplification, noise, ratio=2),
        value_below=limit(below, ones, noise, ratio=2),
        value_above=limit(above, ones, noise, ratio=2),
        # The error of a central slope is a series of even powers: it falls by 4.
        central=limit(central_slopes, central_amplification, noise, ratio=4),
    )


def limit(first: Array, amplification: Array, noise: Array, ratio: int) -> Estimate:
    """Limit of a sequence at halved steps, by the window with the least error.

    A window, some consecutive steps, is extrapolated. Windows are tried from the
    smallest step on, up to the first that contradicts those before it. The limit is
    nan, with the error inf, where no window has a finite error.

    Parameters
    ----------
    first : [step, ...] array
        Its error is a series of powers of the step: of all, or of the even powers.
    amplification : [step, ...] array
        Error of `first` over that of the values of which it is made.
    noise : [...] array
        Bound of the error of these values.
    ratio : int
        Factor by which the first term of the error falls from step to step: 2 or 4.
    """
    shape = first.shape[1:]
    value = np.full(shape, math.nan)
    error = np.full(shape, math.inf)
    low = np.full(shape, -math.inf)  # bounds of the limit by all windows so far
    high = np.full(shape, math.inf)
    in_agreement = np.full(shape, True)
    for window in windows_of(first, amplification * noise, ratio):
        exists = np.isfinite(window.error)
        lower = window.value - window.error
        upper = window.value + window.error
        # Whether the interval of this window overlaps that of all windows so far
        agrees = (lower <= high) & (upper >= low)
        contradicts = exists & ~agrees
        in_agreement &= ~contradicts  # False from the first that contradicts on
        used = exists & in_agreement
        low = np.where(used, np.maximum(low, lower), low)
        high = np.where(used, np.minimum(high, upper), high)
        better = used & (window.error < error)
        value = np.where(better, window.value, value)
        error = np.where(better, window.error, error)
    return Estimate(value, error)


def windows_of(first: Array, noise: Array, ratio: int) -> list[Estimate]:
    """For each step, the estimate with the least error by windows that begin there.

    A window begins at its largest step. The smallest step comes first in the list; no
    window begins there, so its estimate is nan, with the error inf. `noise` is the
    bound of the error of `first` by the values, [step, ...]; see `limit`. A window of
    order n removes the first n terms of the error by n + 1 steps. With the two windows
    S of order n - 1 in it, Richardson's extrapolation is

        S(smaller steps) + (S(smaller steps) - S(larger steps))/(ratio^n - 1).
    """
    count = len(first)
    values = np.full(first.shape, math.nan)
    errors = np.full(first.shape, math.inf)
    order_below = first  # windows of the order below, [step at which they begin]
    noise_below = noise
    highest_order = min(MAX_ORDER, count - 1)
    for order in range(1, highest_order + 1):
        factor = float(ratio**order)
        # Of two neighbours in `order_below`, the later one has the smaller steps.
        change = (order_below[1:] - order_below[:-1]) / (factor - 1)
        this_order = order_below[1:] + change
        # The window is (factor S(smaller steps) - S(larger steps))/(factor - 1).
        noise_sum = factor * noise_below[1:] + noise_below[:-1]
        this_noise = noise_sum / (factor - 1)
        bounds = TRUNCATION_SAFETY * np.abs(change) + this_noise
        for begin in range(count - order):
            better = bounds[begin] < errors[begin]
            values[begin] = np.where(better, this_order[begin], values[begin])
            errors[begin] = np.where(better, bounds[begin], errors[begin])
        order_below = this_order
        noise_below = this_noise
    windows = []
    for begin in reversed(range(count)):  # from the smallest step
        windows.append(Estimate(values[begin], errors[begin]))
    return windows
