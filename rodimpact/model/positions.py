"""Velocity of an end with a prescribed position: exact derivative of its curve."""

from typing import Any

import numpy as np

from .frozen import Problems, add_problem
from .profiles import SPLINE_DEGREE, Polynomials, Profile, Samples, Steps

VALUES_PER_INTERVAL = SPLINE_DEGREE
"""Number of values of the velocity in an interval.

The velocity is a polynomial of one degree less than the position.
"""
SHARES = (
    1 - np.cos(np.pi * np.arange(VALUES_PER_INTERVAL) / (VALUES_PER_INTERVAL - 1))
) / 2
"""Places of these values in an interval, as shares of its width: Chebyshev points."""


def velocity_of(problems: Problems, position: Profile) -> Any:
    """Velocity over time of an end with this position, m/s; 0 after the last sample.

    Parameters
    ----------
    problems : list of (path, message)
        Mistakes are added. The velocity that is returned then is 0.
    position : float, array or Samples
        m; only its changes count.

    Returns
    -------
    float, array, Steps or Polynomials
        0 for a number or an array, of its shape. For samples `Steps` if they are joined
        by straight lines, or `Polynomials` if they are those of a smooth curve.
    """
    if not isinstance(position, Samples):
        return 0.0 * position  # type: ignore[operator]
    if position.smooth:
        return _of_spline(problems, position)
    return _of_lines(position)


def _of_lines(position: Samples) -> Any:
    """Velocity of straight lines between samples, m/s, and 0 after the last one.

    It is `Steps`: neighbouring lines of equal slope make one step. If the end never
    moves it is 0, a number, or an array if the step of the samples is one.
    """
    dt: Any = position.step  # between samples, s
    rises = np.diff(position.values)
    # Whether a line has another slope than the line before: then a step begins.
    is_new = np.append(True, rises[1:] != rises[:-1])
    values = []
    starts = []
    for i in np.flatnonzero(is_new).tolist():
        values.append(float(rises[i]) / dt)
        starts.append(i * dt)
    if rises[-1] != 0:  # after the last sample the end stays where it is
        values.append(0.0)
        starts.append(len(rises) * dt)
    if len(values) == 1:  # the end never moves: a motion has a second step, the stop
        return values[0]
    return Steps(values, starts[1:])  # the first start, t = 0, is no jump


def _of_spline(problems: Problems, position: Samples) -> Any:
    """Velocity of the spline through smooth samples, m/s, as `Polynomials`.

    Each interval between samples is one polynomial; one more, 0, follows the last
    sample. A time step that is an array, or too few samples, are a problem; then the
    number 0.0 is returned.
    """
    from scipy.interpolate import make_interp_spline

    samples = np.asarray(position.values)
    if isinstance(position.step, np.ndarray):
        message = "must be a single number for a smooth curve"
        add_problem(problems, "position.step", message, position.step)
        return 0.0
    if len(samples) <= SPLINE_DEGREE:
        message = f"must be more than {SPLINE_DEGREE} samples for a smooth curve"
        add_problem(problems, "position.values", message, samples.tolist())
        return 0.0
    step: Any = position.step
    times = step * np.arange(len(samples))
    velocity = make_interp_spline(times, samples, SPLINE_DEGREE).derivative()
    values = velocity(times[:-1, None] + step * SHARES)  # [interval, place]
    # Neighbouring polynomials get equal values at their border, without round-off, so
    # that there is no jump.
    values[:, 0] = velocity(times[:-1])
    values[:, -1] = velocity(times[1:])
    at_rest = np.zeros(VALUES_PER_INTERVAL)  # after the last sample
    all_values = np.append(values.ravel(), at_rest).tolist()
    borders = times[1:].tolist()
    # The error of the position is 0 at the samples. Its slope is estimated as that of a
    # sine with the step as half period.
    error = np.pi * position.error / step
    return Polynomials(all_values, borders, error=error)
