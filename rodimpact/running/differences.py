"""Derivatives on both sides of a point, by Richardson's extrapolation.

The function is known at a sequence of steps, each half the previous one. A few
consecutive steps are a window: a polynomial through the values at its steps is
extrapolated to the step 0. Each window has an error bound: ten times its difference
from the window of one step less, plus the amplified error (noise) of the values.
Windows are examined from the smallest steps to the largest. The search ends at the
first window that contradicts the windows before it, since it reaches beyond a kink. The
window with the smallest bound is the result.

C. Brezinski, M. Redivo Zaglia, Extrapolation Methods, North-Holland 1991.
"""

import math
from typing import NamedTuple

import numpy as np

from ..methods.row import Array

MAX_ORDER = 5  # largest order of a window: higher orders only amplify the noise
TRUNCATION_SAFETY = 10.0  # stated truncation error over the change by the last order


class Estimate(NamedTuple):
    """Limit of a quantity as the step goes to 0, with its stated error."""

    value: Array  # nan where no limit was found
    error: Array  # inf where no limit was found


def _difference(below: Estimate, above: Estimate) -> Estimate:
    """Difference above - below of two estimates; the errors of both are added."""
    return Estimate(above.value - below.value, above.error + below.error)


class Sides(NamedTuple):
    """One-sided derivatives and limits of a function at a point; central derivative."""

    below: Estimate  # derivative on the side of smaller arguments
    above: Estimate  # derivative on the side of larger arguments
    value_below: Estimate  # limit of the function from smaller arguments
    value_above: Estimate  # limit of the function from larger arguments
    central: Estimate  # derivative by central differences, valid without a kink

    @property
    def jump(self) -> Estimate:
        """Limit from larger arguments minus limit from smaller arguments."""
        return _difference(self.value_below, self.value_above)

    @property
    def bend(self) -> Estimate:
        """Derivative on the side of larger arguments minus that of smaller ones."""
        return _difference(self.below, self.above)

    @property
    def smooth(self) -> Array:
        """Whether limits and derivatives on both sides agree within their errors."""
        continuous = np.abs(self.jump.value) <= self.jump.error
        straight = np.abs(self.bend.value) <= self.bend.error
        return np.asarray(continuous & straight)


def sides_of(below: Array, above: Array, steps: Array, noise: Array) -> Sides:
    """One-sided derivatives and limits of a function at a point, by extrapolation.

    The central derivative is added. Each result is an `Estimate` with arrays of the
    shape [...]. An entry that cannot be found is nan, with the error inf.

    Parameters
    ----------
    below, above : [step, ...] array
        Values of the function at the point minus and plus each step; nan where the
        function has no value.
    steps : [step, ...] array
        Steps, > 0; each is half the previous one.
    noise : [...] array
        Bound of the absolute error of the values.
    """
    # Distance between the arguments of neighbouring steps, [step - 1, ...]. The later
    # step is shorter. Its argument is the larger one of both below the point and the
    # smaller one above it, so the two differences have opposite order.
    between = steps[:-1] - steps[1:]
    slopes_below = (below[1:] - below[:-1]) / between
    slopes_above = (above[:-1] - above[1:]) / between
    central_slopes = (above - below) / (2 * steps)
    # Error of a slope over that of a value: 2 values over the distance between them
    amplification = 2 / between
    central_amplification = 1 / steps  # 2/(2 step)
    ones = np.ones_like(steps)
    # Errors on one side are series of all powers of the step: if the step is halved,
    # the first term falls by the factor 2.
    return Sides(
        below=limit(slopes_below, amplification, noise, ratio=2),
        above=limit(slopes_above, amplification, noise, ratio=2),
        value_below=limit(below, ones, noise, ratio=2),
        value_above=limit(above, ones, noise, ratio=2),
        # The error of a central slope is a series of even powers: factor 4.
        central=limit(central_slopes, central_amplification, noise, ratio=4),
    )


def limit(sequence: Array, amplification: Array, noise: Array, ratio: int) -> Estimate:
    """Limit at the step 0 of a quantity known at halved steps, with its error, [...].

    It is the extrapolation by the window, some consecutive steps, with the smallest
    error. Windows are tried from the smallest step on, up to the first that contradicts
    the windows before it. The limit is nan, with the error inf, where no window has a
    finite error.

    Parameters
    ----------
    sequence : [step, ...] array
        The quantity at each step. Its error is a series of all powers of the step
        (`ratio` 2), or of the even powers (`ratio` 4).
    amplification : [step, ...] array
        Error of `sequence` over the error of the function values from which it is made.
    noise : [...] array
        Bound of the error of these function values.
    ratio : int
        Factor by which the first term of the error falls if the step is halved: 2 or 4.
    """
    shape = sequence.shape[1:]
    value = np.full(shape, math.nan)
    error = np.full(shape, math.inf)
    # Interval of the limit: intersection of the intervals of all windows so far
    low = np.full(shape, -math.inf)
    high = np.full(shape, math.inf)
    in_agreement = np.full(shape, True)
    for window in windows_of(sequence, amplification * noise, ratio):
        # Comparisons with nan are False: a window that does not exist changes nothing.
        exists = np.isfinite(window.error)
        lower = window.value - window.error
        upper = window.value + window.error
        # Whether the interval of this window overlaps the one so far
        agrees = (lower <= high) & (upper >= low)
        contradicts = exists & ~agrees
        in_agreement &= ~contradicts  # stays False after the first contradiction
        used = exists & in_agreement
        low = np.where(used, np.maximum(low, lower), low)
        high = np.where(used, np.minimum(high, upper), high)
        better = used & (window.error < error)
        value = np.where(better, window.value, value)
        error = np.where(better, window.error, error)
    return Estimate(value, error)


def windows_of(sequence: Array, noise: Array, ratio: int) -> list[Estimate]:
    """For each step, the extrapolation with the smallest error bound.

    The list has one estimate, [...], per step, the smallest step first. It is the best
    of the windows that begin at this step, which is their largest one. No window begins
    at the smallest step, so the first estimate is nan, with the error inf.

    `sequence` and `ratio` are those of `limit`; `noise` is the bound of the error of
    `sequence`, [step, ...]. A window of order n consists of n + 1 steps and removes the
    first n terms of the error. Richardson's extrapolation combines its two windows S of
    order n - 1:

        S(smaller steps) + (S(smaller steps) - S(larger steps))/(ratio^n - 1).
    """
    count = len(sequence)
    values = np.full(sequence.shape, math.nan)
    errors = np.full(sequence.shape, math.inf)
    order_below = sequence  # windows of order n - 1, [step at which they begin, ...]
    noise_below = noise  # bounds of their errors by noise
    highest_order = min(MAX_ORDER, count - 1)
    for order in range(1, highest_order + 1):
        factor = float(ratio**order)
        # The later one of two neighbours in `order_below` has the smaller steps.
        change = (order_below[1:] - order_below[:-1]) / (factor - 1)
        this_order = order_below[1:] + change
        # The same window is (factor S(smaller steps) - S(larger steps))/(factor - 1):
        # the errors of both terms add.
        noise_sum = factor * noise_below[1:] + noise_below[:-1]
        this_noise = noise_sum / (factor - 1)
        bounds = TRUNCATION_SAFETY * np.abs(change) + this_noise
        for begin in range(count - order):  # a window has order + 1 steps
            better = bounds[begin] < errors[begin]
            values[begin] = np.where(better, this_order[begin], values[begin])
            errors[begin] = np.where(better, bounds[begin], errors[begin])
        order_below = this_order
        noise_below = this_noise
    windows = []
    for begin in reversed(range(count)):  # from the smallest step
        windows.append(Estimate(values[begin], errors[begin]))
    return windows
