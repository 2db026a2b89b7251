"""Linear filters at equal time steps: the effects of gauges, amplifiers and bars.

A record is continued by its first value before its start and by its last value after
its end.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..units import format_si

MAX_SAMPLES = 10**7
"""Largest number of samples of a record with its margins."""
MIN_FREQUENCY_STEP = 1e-9
"""Least product of the frequency of an amplifier and the time step.

If it is smaller, round-off dominates.
"""
DISPERSION_TAIL = 3
"""Duration of the response of a bar, divided by the travel time of long waves.

The slowest waves are at most 1.15 travel times late.
"""
MIN_MEAN_STEPS = 1e-6
"""Least duration of a mean, in time steps; round-off would dominate shorter means."""


def gaussian(values: Floats, dt: float, frequency: float) -> Floats:
    """Values after a Gaussian filter whose gain is 1/sqrt(2) at a frequency, Hz.

    The values are at equal steps of `dt`, s; the record is continued by its first and
    its last value. The result has as many values, without delay. InvalidModel if the
    record with its margins exceeds `MAX_SAMPLES`.
    """
    # The response lasts 1/frequency before and after: 7.5 standard deviations.
    tail = math.ceil(min(1 / dt / frequency, MAX_SAMPLES))  # samples
    exponent = math.log(2) / 2  # the gain at `frequency` is exp(-exponent) = 1/sqrt(2)

    def gain(f: Floats) -> Floats:
        gains: Floats = np.exp(-exponent * (f / frequency) ** 2)
        return gains

    return _filter(values, dt, gain, tail)


def blurred(values: Floats, dt: float, deviation: float) -> Floats:
    """Values after a Gaussian filter whose response has the standard deviation given.

    `deviation` and the equal steps `dt` of the values are in s. The gain at the
    frequency f is exp(-(2 pi f deviation)^2/2).
    """
    # This gain is 1/sqrt(2) if 2 pi f deviation = sqrt(ln 2).
    frequency = math.sqrt(math.log(2)) / (2 * math.pi * deviation)
    return gaussian(values, dt, frequency)


def amplified(values: Floats, dt: float, frequency: float, order: int) -> Floats:
    """Values after a Butterworth amplifier that has settled at the first value.

    The values are at equal steps of `dt`, s; the response is exact for straight lines
    between them. The gain is 1/sqrt(2) at the frequency, Hz; the order is 1 or 2.
    InvalidModel if frequency times `dt` is below `MIN_FREQUENCY_STEP`.
    """
    from scipy import signal

    if frequency * dt < MIN_FREQUENCY_STEP:
        lowest = format_si(MIN_FREQUENCY_STEP / dt, "Hz")
        raise invalid_argument(
            "frequency", f"must be {lowest} or more, got {frequency}"
        )
    analog = signal.butter(order, 2 * math.pi * frequency, analog=True)
    # "foh" (first-order hold): the input is linear between samples.
    top, bottom, _ = signal.cont2discrete(analog, dt, method="foh")
    # `lfilter` assumes an input of 0 before the record: it gets values - values[0].
    change = signal.lfilter(np.ravel(top), bottom, values - values[0])
    result: Floats = values[0] + change
    return result


LOW_PASS: dict[str, Callable[[Floats, float, float], Floats]] = {
    "gaussian": gaussian,
    "first-order": partial(amplified, order=1),
    "second-order": partial(amplified, order=2),
}


def averaged(values: Floats, times: Floats, duration: float) -> Floats:
    """Moving means over a duration, s, centred at each sample.

    The steps of `times`, s, may differ. Values are linear between samples, and the
    record is continued by its first and its last value. If the duration is shorter than
    `MIN_MEAN_STEPS` times the shortest step, the values themselves are returned.
    """
    if duration < MIN_MEAN_STEPS * np.diff(times).min():
        return values
    from scipy.interpolate import make_interp_spline

    # One more point beyond each end: a mean needs half a duration there.
    around = np.concatenate(([times[0] - duration], times, [times[-1] + duration]))
    lines = make_interp_spline(around, np.pad(values, 1, "edge"), k=1)
    integral = lines.antiderivative()
    late = integral(times + duration / 2)
    early = integral(times - duration / 2)
    means: Floats = (late - early) / duration  # integral over the duration
    return means


def dispersed(values: Floats, dt: float, distance: float, bar: Any) -> Floats:
    """Values of a pulse after a distance, m, along a `waves.Bar`.

    The values are at equal steps of `dt`, s. Only the shape changes: the delay of long
    waves, distance/c0, is left out. A negative distance reverses the dispersion.
    Frequencies above the cut-off are removed, also if the distance is 0. InvalidModel
    if the record with its margins exceeds `MAX_SAMPLES`.
    """
    duration = DISPERSION_TAIL * abs(distance) / bar.wave_speed
    # In samples. The limit makes `_filter` refuse the record; without it `ceil` would
    # fail for an infinite duration.
    tail = math.ceil(min(duration / dt, MAX_SAMPLES))

    def gain(f: Floats) -> Any:
        return first_mode(f, distance, bar)

    return _filter(values, dt, gain, tail)


def first_mode(f: Floats, distance: float, bar: Any) -> Any:
    """Complex factors of the spectrum over a distance, m, along a `waves.Bar`.

    They belong to the frequencies f, Hz, which are evenly spaced from 0 on. Their
    phases contain the delays relative to long waves only. They are 0 above the cut-off.
    """
    # Each frequency stands for a band of the width of a step; its factor contains the
    # share of this band below the cut-off.
    step = f[1]  # as f[0] is 0
    share_below = np.clip((bar.cut_off - f) / step + 0.5, 0.0, 1.0)
    carried = np.minimum(f, bar.cut_off)  # `delays` are not defined above the cut-off
    delays = bar.delays(carried)  # s for each metre
    return share_below * np.exp(-2j * np.pi * carried * delays * distance)


def _filter(
    values: Floats, dt: float, gain: Callable[[Floats], Any], tail: int
) -> Floats:
    """Values, at equal steps of `dt`, s, after a linear filter.

    `gain` returns the complex gains at frequencies, Hz; the response of the filter
    lasts `tail` samples. Before the Fourier transform the record is extended by its
    first and its last value, over a longer time than the response, and by a smooth
    curve from the last value back to the first one, since the transform is periodic.
    InvalidModel if the extended record exceeds `MAX_SAMPLES`.
    """
    from scipy import fft

    # Number of samples added at each end, and least length of the curve back: the
    # response and a reserve, a quarter of the record and 64 samples
    margin = tail + len(values) // 4 + 64
    if len(values) + 3 * margin > MAX_SAMPLES:
        message = f"{dt!r} makes the filtered record longer than {MAX_SAMPLES} samples"
        remedy = "use resampled(dt) with a longer dt, or a shorter distance"
        raise invalid_argument("dt", f"{message}; {remedy}")
    # Number of samples of the period: values, two margins and the curve back
    count = fft.next_fast_len(len(values) + 3 * margin, real=True)
    first = values[0]
    last = values[-1]
    after = np.full(margin, last)
    before = np.full(margin, first)
    # The rest of the period leads back to the first value, by half a cosine.
    back_count = count - len(values) - 2 * margin
    back = np.arange(1, back_count + 1)
    weight_of_last = (1 + np.cos(np.pi * back / (back_count + 1))) / 2  # from 1 to 0
    curve_back = first + (last - first) * weight_of_last
    # The values come first, so `before` stands at the end of the period.
    period = np.concatenate((values, after, curve_back, before))
    spectrum = fft.rfft(period) * gain(fft.rfftfreq(count, dt))
    result: Floats = fft.irfft(spectrum, count)[: len(values)]
    return result
