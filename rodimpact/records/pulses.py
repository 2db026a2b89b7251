"""Timing of a pulse."""

from typing import NamedTuple

import numpy as np

from ..hints import explain_missing
from ..model.quantities import Floats

PLATEAU_RATIO = 0.7
"""Samples belong to the plateau of a pulse above this part of the largest sample."""
MIN_FIRST_PART_RATIO = 0.4
"""Least height of the first part of a wave, divided by the largest height of the wave.

A smaller part may be ringing.
"""
START_RATIO = 0.1
"""Ratio of the strain at `Pulse.start` to the plateau."""
ONSET_RATIO = 0.01
"""Ratio of the strain at which a pulse begins to the plateau, if noise is smaller."""
ONSET_NOISE_RATIO = 3.0
"""Least strain at which a pulse begins, over the standard deviation of the noise."""
RISE_BEGIN_RATIO = 0.05
"""Strain at the begin of the rise to which a parabola is fitted, over the plateau."""
RISE_END_RATIO = 0.6
"""Strain at the end of the rise to which a parabola is fitted, over the plateau."""
MIN_RISE_SAMPLES = 8
"""Least number of samples of a rise to which a parabola is fitted."""
FOOT_TIME_RATIO = 2.5
"""Largest time from the begin of a pulse to a tenth of its plateau.

It is divided by the time from a tenth to a fifth. The ratio is 1 for a linear rise, and
2.4 for a rise with the square of time.
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
    """Timing of the pulse that contains the largest absolute value.

    The plateau has the sign of the pulse. Values between samples are interpolated
    linearly. ValueError if the record cuts the pulse off, or is 0 everywhere.
    """
    sign = _sign_of(values)
    # A sample of -inf at the time nan is added at each end. A pulse that is cut off
    # there passes the level at the time nan.
    v = np.concatenate(([-np.inf], sign * values, [-np.inf]))
    t = np.concatenate(([np.nan], times, [np.nan]))
    # The plateau is taken from the samples around the largest one.
    top = _stretch_above(PLATEAU_RATIO * v.max(), t, v)
    level = plateau(v[top.samples])
    foot = _stretch_above(START_RATIO * level, t, v)  # only its rise is used
    half = _stretch_above(0.5 * level, t, v)
    if not np.isfinite([foot.rises, half.rises, half.falls]).all():
        raise ValueError(
            "the record cuts the pulse off: before the pulse the signal must be below "
            "a tenth of its plateau, after it below half; use a longer window, or "
            "subtract the baseline"
        )
    # Sample i is the first of 0.9 of the level or more: the rise passes this height
    # between the samples i - 1 and i.
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
    """Consecutive samples of a pulse that are not below a level."""

    samples: slice
    rises: float  # time at which the pulse rises through the level, s
    falls: float  # time at which the pulse falls through the level, s


def _stretch_above(level: float, times: Floats, values: Floats) -> _Stretch:
    """The samples around the largest one, up to the nearest ones below a level.

    The times at which the level is passed are interpolated linearly; they are nan next
    to a sample whose time is nan. There must be a value below the level before the
    largest sample, and another one after it.
    """
    below = np.flatnonzero(values < level)
    # The nearest samples below the level: i before the largest sample, j after it.
    # `after_top` is the position of j in `below`.
    after_top = int(np.searchsorted(below, values.argmax()))
    i = below[after_top - 1]
    j = below[after_top]
    rises = _time_of_level(level, times, values, i)
    # With the opposite sign the fall becomes a rise.
    falls = _time_of_level(-level, times, -values, j - 1)
    return _Stretch(slice(i + 1, j), rises, falls)


def _time_of_level(level: float, times: Floats, values: Floats, i: int) -> float:
    """Time at which values that rise from sample i to sample i + 1 pass a level, s."""
    both = slice(i, i + 2)  # the samples i and i + 1
    return float(np.interp(level, values[both], times[both]))


def plateau(values: Floats) -> float:
    """Median of the samples above 0.7 of the largest one, as a positive number.

    The largest sample is the one with the largest absolute value. If it is negative,
    the signs of all samples are reversed first. ValueError if all samples are 0.
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
    """Timing of the first pulse of a wave, before a part of the opposite sign.

    The first pulse begins where a sample reaches `MIN_FIRST_PART_RATIO` of the largest
    absolute value. It ends where the sign changes. The later part may be larger: it is
    so in some reflected waves, when the specimen unloads. Result and errors are those
    of `pulse_of`.
    """
    magnitude = np.abs(values)
    is_high = magnitude >= MIN_FIRST_PART_RATIO * magnitude.max()
    first = int(np.argmax(is_high))  # the first sample that is high
    has_turned = values[first:] * values[first] < 0  # the opposite sign of the first
    if has_turned.any():
        # A sample of 0 takes the place of the first sample of the opposite sign.
        end = first + int(np.argmax(has_turned))
        values = np.append(values[:end], 0.0)
        times = times[: end + 1]
    return pulse_of(times, values)


def rest_end(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Time before which a record is at rest, s.

    It is `pulse.start`, at a tenth of the plateau, minus `FOOT_TIME_RATIO` times the
    rise time from a tenth to a fifth, which counts as one time step at least. The steps
    must be equal.
    """
    dt = times[1] - times[0]
    until_fifth = max(_time_at_fifth(times, values, pulse) - pulse.start, dt)
    return float(pulse.start - FOOT_TIME_RATIO * until_fifth)


def onset_of(times: Floats, values: Floats, pulse: Pulse, noise: float) -> float:
    """Last time before `pulse.start` at which a pulse rises out of the noise, s.

    The pulse then passes the larger of two levels: a hundredth of its plateau, and
    three times `noise`, the standard deviation of the noise. The time is interpolated
    linearly between samples. If no sample before `pulse.start` is that low, it is the
    first time of the record.
    """
    level = max(ONSET_RATIO * abs(pulse.plateau), ONSET_NOISE_RATIO * noise)
    height = np.sign(pulse.plateau) * values  # positive in the pulse
    is_low = (times < pulse.start) & (height <= level)
    if not is_low.any():
        return float(times[0])
    i = int(np.flatnonzero(is_low)[-1])  # the last low sample
    return _time_of_level(level, times, height, i)


def line_onset(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Begin of a steep pulse, s: zero of the line through a tenth and a fifth.

    The points of the line are those where the pulse passes a tenth and a fifth of its
    plateau.
    """
    until_fifth = _time_at_fifth(times, values, pulse) - pulse.start
    # The line rises from zero to a tenth in the same time as from a tenth to a fifth.
    return float(pulse.start - until_fifth)


def extrapolated_onset(times: Floats, values: Floats, pulse: Pulse) -> float:
    """Begin of a pulse that rises over many samples, s.

    A parabola is fitted to the rise from a twentieth to 0.6 of the plateau; the pulse
    begins at its zero. (The bar distorts the first moments of the rise, and less so the
    later ones.) The result is `line_onset` if the rise has fewer than
    `MIN_RISE_SAMPLES`, or if the parabola has no zero before the end of the rise.
    """
    # Values divided by the plateau, positive in the pulse
    relative = np.sign(pulse.plateau) * values / abs(pulse.plateau)
    # The rise has the samples from `begin` to `end` - 1.
    is_after_rise = (times > pulse.start) & (relative >= RISE_END_RATIO)
    end = int(np.argmax(is_after_rise))  # the first such sample
    is_low = relative[:end] < RISE_BEGIN_RATIO
    begin = 0
    if is_low.any():
        begin = int(np.flatnonzero(is_low)[-1]) + 1  # after the last low sample
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

    The time is interpolated linearly between samples.
    """
    height = np.sign(pulse.plateau) * values  # positive in the pulse
    fifth = 2 * START_RATIO * abs(pulse.plateau)  # twice a tenth
    is_above = (times > pulse.start) & (height >= fifth)
    i = int(np.argmax(is_above))  # index of the first such sample
    return _time_of_level(fifth, times, height, i - 1)
