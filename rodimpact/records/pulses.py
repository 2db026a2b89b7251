"""Timing of a pulse."""

from typing import NamedTuple

import numpy as np

from ..hints import explain_missing
from ..model.quantities import Floats

PLATEAU_RATIO = 0.7
"""Smallest part of the largest sample that belongs to the plateau of a pulse."""
MIN_FIRST_PART_RATIO = 0.4
"""Least ratio of the largest strain of the first part of a wave to that of all.

A smaller part may be ringing.
"""
START_RATIO = 0.1
"""Part of its plateau at which `Pulse.start` is."""
ONSET_RATIO = 0.01
"""Part of its plateau at which a pulse begins, if noise is less."""
ONSET_NOISE_RATIO = 3.0
"""Strain at which a pulse begins over the standard deviation of the noise, at least."""
RISE_BEGIN_RATIO = 0.05
"""Part of its plateau from which the rise of a pulse is extrapolated to its begin."""
RISE_END_RATIO = 0.6
"""Part of its plateau up to which the rise of a pulse is extrapolated to its begin."""
MIN_RISE_SAMPLES = 8
"""Samples between these parts, at least, of a rise that is extrapolated."""
FOOT_TIME_RATIO = 2.5
"""Bounds the time from the begin of a pulse to a tenth of its plateau.

It is relative to the time from there to a fifth: a straight rise needs 1, one with the
square of time 2.4.
"""


@explain_missing()
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
        Median of the samples above 0.7 of the largest, with its sign, in the unit of
        the signal.

    Examples
    --------
    >>> import rodimpact as ri
    >>> force = ri.Signal([0.0, 0.0, -2.0, -2.0, -2.0, 0.0, 0.0], dt=1e-6, unit="N")
    >>> pulse = force.pulse()
    >>> round(pulse.width * 1e6, 6), round(pulse.rise * 1e6, 6), pulse.plateau
    (3.0, 0.8, -2.0)
    """

    start: float
    width: float
    rise: float
    plateau: float


def pulse_of(times: Floats, values: Floats) -> Pulse:
    """Timing of the pulse with the largest sample, of either sign.

    Between samples the values are linear. ValueError if the record cuts the pulse off,
    or is 0 everywhere.
    """
    sign = _sign_of(values)
    # Beyond the ends there are samples below any level. A pulse that begins or ends
    # there has nan as the time.
    v = np.concatenate(([-np.inf], sign * values, [-np.inf]))
    t = np.concatenate(([np.nan], times, [np.nan]))
    top = _stretch_above(PLATEAU_RATIO * v.max(), t, v)
    level = plateau(v[top.samples])
    foot = _stretch_above(START_RATIO * level, t, v)
    half = _stretch_above(0.5 * level, t, v)
    if not np.isfinite([foot.rises, half.rises, half.falls]).all():
        raise ValueError(
            "the record cuts the pulse off: before the pulse the signal must be below "
            "a tenth of its plateau, after it below half; use a longer window, or "
            "subtract the baseline"
        )
    # The first sample i of 0.9 of the level, and the time right before it at which
    # 0.9 of the level is passed
    is_high = v[half.samples] >= 0.9 * level
    i = half.samples.start + int(np.argmax(is_high))
    rise_end = _time_of_level(0.9 * level, t, v, i - 1)
    return Pulse(
        start=foot.rises,
        width=half.falls - half.rises,
        rise=rise_end - foot.rises,
        plateau=sign * level,
    )


class _Stretch(NamedTuple):
    """Samples of a pulse above a level, and the times at which it passes that, s."""

    samples: slice
    rises: float
    falls: float


def _stretch_above(level: float, times: Floats, values: Floats) -> _Stretch:
    """The samples about the largest one that are no lower than a level.

    The times at which the level is passed are linear between samples. A value below the
    level must stand before the largest sample, and one after it; if its time is nan,
    so is the result's.
    """
    below = np.flatnonzero(values < level)
    # The nearest samples below the level: i before the largest sample, j after it
    after_top = int(np.searchsorted(below, values.argmax()))
    i = below[after_top - 1]
    j = below[after_top]
    rises = _time_of_level(level, times, values, i)
    # With the other sign the fall is a rise.
    falls = _time_of_level(-level, times, -values, j - 1)
    return _Stretch(slice(i + 1, j), rises, falls)


def _time_of_level(level: float, times: Floats, values: Floats, i: int) -> float:
    """Time at which values that rise from sample i to the next one pass a level, s."""
    both = slice(i, i + 2)
    return float(np.interp(level, values[both], times[both]))


def plateau(values: Floats) -> float:
    """Median of the samples above 0.7 of the largest one, as a positive number.

    If the largest one is negative, samples below 0.7 of it count. ValueError if all
    samples are 0.
    """
    height = _sign_of(values) * values
    largest = height.max()
    if largest <= 0:
        raise ValueError("there is no pulse: the signal is 0 everywhere")
    is_plateau = height > PLATEAU_RATIO * largest
    return float(np.median(height[is_plateau]))


def _sign_of(values: Floats) -> float:
    """Sign of the sample with the largest absolute value, 1.0 or -1.0."""
    if values.max() >= -values.min():
        return 1.0
    return -1.0


def first_part(times: Floats, values: Floats) -> Pulse:
    """Timing of the first pulse, which a pulse of the other sign may follow.

    The first pulse must reach `MIN_FIRST_PART_RATIO` of the largest sample. The result
    and the errors are those of `pulse_of`. As a specimen unloads, the second part of
    the reflected wave may be the larger one.
    """
    magnitude = np.abs(values)
    is_high = magnitude >= MIN_FIRST_PART_RATIO * magnitude.max()
    first = int(np.argmax(is_high))  # the first sample that is high
    has_turned = values[first:] * values[first] < 0  # whether the sign is another one
    if has_turned.any():
        # Where the sign turns, a sample of 0 ends the first part.
        end = first + int(np.argmax(has_turned))
        values = np.append(values[:end], 0.0)
        times = times[: end + 1]
    return pulse_of(times, values)


def rest_end(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Time before which a record is at rest, s.

    It lies before a tenth of the plateau by 2.5 times the duration from there to a
    fifth, and by one sample at least.
    """
    dt = times[1] - times[0]
    until_fifth = max(_time_at_fifth(times, values, pulse) - pulse.start, dt)
    return float(pulse.start - FOOT_TIME_RATIO * until_fifth)


def onset_of(times: Floats, values: Floats, pulse: Pulse, noise: float) -> float:
    """Last time before `pulse.start` at which a pulse rises out of the noise, s.

    There it passes a hundredth of its plateau, or three times `noise`, its standard
    deviation, if that is larger. The time is linear between samples. It is the first
    time of the record if no sample is as low.
    """
    level = max(ONSET_RATIO * abs(pulse.plateau), ONSET_NOISE_RATIO * noise)
    height = np.sign(pulse.plateau) * values  # positive in the pulse
    is_low = (times < pulse.start) & (height <= level)
    if not is_low.any():
        return float(times[0])
    i = int(np.flatnonzero(is_low)[-1])  # the last low sample
    return _time_of_level(level, times, height, i)


def line_onset(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Begin of a steep pulse, s.

    The line through a tenth and a fifth of the plateau is zero there.
    """
    until_fifth = _time_at_fifth(times, values, pulse) - pulse.start
    return float(pulse.start - until_fifth)


def extrapolated_onset(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Begin of a pulse that rises over many samples, s.

    It is the zero of the parabola through the rise, from a twentieth to 0.6 of the
    plateau. The bar has lost the first moments of the rise; most of the rest of it is
    known. A steep pulse, of fewer than `MIN_RISE_SAMPLES` there, and one whose parabola
    has no zero before the end of the rise, begin at their `line_onset`.
    """
    relative = np.sign(pulse.plateau) * values / abs(pulse.plateau)
    # The rise has the samples from `begin` to `end` - 1.
    is_behind_rise = (times > pulse.start) & (relative >= RISE_END_RATIO)
    end = int(np.argmax(is_behind_rise))  # the first such sample
    is_low = relative[:end] < RISE_BEGIN_RATIO
    begin = 0
    if is_low.any():
        begin = int(np.flatnonzero(is_low)[-1]) + 1
    if end - begin < MIN_RISE_SAMPLES:
        return line_onset(times, values, pulse)
    rise_times = times[begin:end] - pulse.start
    parabola = np.polyfit(rise_times, relative[begin:end], 2)
    # The pulse begins at the zero that lies nearest to the first sample of the rise.
    zeros = np.roots(parabola)
    real_zeros = zeros[np.isreal(zeros)].real
    earlier = real_zeros[real_zeros < rise_times[-1]]
    if not earlier.size:
        return line_onset(times, values, pulse)
    nearest = int(np.abs(earlier - rise_times[0]).argmin())
    return float(pulse.start + earlier[nearest])


def _time_at_fifth(times: Floats, values: Floats, pulse: Pulse) -> float:
    """First time after `pulse.start` at which a pulse has a fifth of its plateau, s.

    The time is linear between samples.
    """
    height = np.sign(pulse.plateau) * values  # positive in the pulse
    fifth = 2 * START_RATIO * abs(pulse.plateau)  # the ratio is a tenth
    is_above = (times > pulse.start) & (height >= fifth)
    i = int(np.argmax(is_above))  # the first such sample
    return _time_of_level(fifth, times, height, i - 1)
