"""Timing of a pulse."""

from typing import NamedTuple

import numpy as np

from ..model.quantities import Floats

PLATEAU_RATIO = 0.7
"""Smallest part of the largest sample that belongs to the plateau of a pulse."""


class Pulse(NamedTuple):
    """Timing of a pulse.

    Attributes
    ----------
    start : float
        Time at which the pulse exceeds a tenth of the plateau, s.
    width : float
        Duration above half of the plateau, s.
    rise : float
        Time from 10 % to 90 % of the plateau, s.
    plateau : float
        Median of the samples above 0.7 of the largest, with its sign, in the unit of the signal.

    Examples
    --------
    >>> import rodimpact as ri
    >>> pulse = ri.Signal([0.0, 0.0, -2.0, -2.0, -2.0, 0.0, 0.0], dt=1e-6, unit="N").pulse()
    >>> round(pulse.width * 1e6, 6), round(pulse.rise * 1e6, 6), pulse.plateau
    (3.0, 0.8, -2.0)
    """

    start: float
    width: float
    rise: float
    plateau: float


def pulse_of(times: Floats, values: Floats) -> Pulse:
    """Timing of the pulse with the largest sample; ValueError if the record cuts the pulse off."""
    sign = _sign_of(values)
    # samples below any level beyond the ends
    v = np.concatenate(([-np.inf], sign * values, [-np.inf]))
    t = np.concatenate(([np.nan], times, [np.nan]))
    top = _stretch_above(PLATEAU_RATIO * v.max(), t, v)
    level = plateau(v[top.samples])
    foot = _stretch_above(0.1 * level, t, v)
    half = _stretch_above(0.5 * level, t, v)
    if not np.isfinite([foot.rises, half.rises, half.falls]).all():
        raise ValueError(
            "the record cuts the pulse off: before the pulse the signal must be below a tenth of "
            "its plateau, after it below half; use a longer window, or subtract the baseline"
        )
    first_high = int(np.argmax(v[half.samples] >= 0.9 * level))
    i = half.samples.start + first_high
    rise_end = float(np.interp(0.9 * level, v[i - 1 : i + 1], t[i - 1 : i + 1]))
    return Pulse(
        start=foot.rises,
        width=half.falls - half.rises,
        rise=rise_end - foot.rises,
        plateau=sign * level,
    )


class _Stretch(NamedTuple):
    """Samples of a pulse above a level, and the times at which it passes the level, s."""

    samples: slice
    rises: float
    falls: float


def _stretch_above(level: float, times: Floats, values: Floats) -> _Stretch:
    """The stretch about the largest sample; nan as a time if the record cuts it off."""
    below = np.flatnonzero(values < level)
    after_top = int(np.searchsorted(below, values.argmax()))
    i = below[after_top - 1]
    j = below[after_top]
    rises = np.interp(level, values[i : i + 2], times[i : i + 2])
    falls = np.interp(-level, -values[j - 1 : j + 1], times[j - 1 : j + 1])
    return _Stretch(slice(i + 1, j), float(rises), float(falls))


def plateau(values: Floats) -> float:
    """Absolute median of the samples above 0.7 of the largest; ValueError if all samples are 0."""
    height = _sign_of(values) * values
    largest = height.max()
    if largest <= 0:
        raise ValueError("there is no pulse: the signal is 0 everywhere")
    return float(np.median(height[height > PLATEAU_RATIO * largest]))


def _sign_of(values: Floats) -> float:
    """Sign of the sample with the largest absolute value."""
    if values.max() >= -values.min():
        return 1.0
    return -1.0
