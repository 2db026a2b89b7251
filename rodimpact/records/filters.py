"""Linear filters at equal time steps: the effects of gauges, amplifiers and bars.

Before the record its first value holds, after the record its last value.
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
"""Samples of a record with its margins, at most."""
MIN_FREQUENCY_STEP = 1e-9
"""Least frequency of a low pass times the time step.

A lower one ends in round-off.
"""
DISPERSION_TAIL = 3
"""Duration of the response of a bar in travel times.

Its slowest waves are 1.15 travel times late at most.
"""
MIN_MEAN_STEPS = 1e-6
"""Duration of a mean over a step, at least; round-off would dominate shorter means."""


def gaussian(values: Floats, dt: float, frequency: float) -> Floats:
    """Values after a Gaussian filter whose gain is 1/sqrt(2) at a frequency, Hz.

    The values are at equal steps of `dt`, s; beyond the ends the first and the last
    value hold. InvalidModel if the filtered record is too long.
    """
    # The response lasts 1/frequency to either side: 7.5 standard deviations.
    tail = math.ceil(min(1 / dt / frequency, MAX_SAMPLES))  # samples
    exponent = math.log(2) / 2  # exp(-exponent) is 1/sqrt(2)

    def gain(f: Floats) -> Floats:
        gains: Floats = np.exp(-exponent * (f / frequency) ** 2)
        return gains

    return _filter(values, dt, gain, tail)


def blurred(values: Floats, dt: float, deviation: float) -> Floats:
    """Values after a Gaussian filter of this standard deviation, s.

    The values are at equal steps of `dt`, s. The gain exp(-(2 pi f deviation)^2/2) is
    1/sqrt(2) where 2 pi f deviation = sqrt(ln 2).
    """
    frequency = math.sqrt(math.log(2)) / (2 * math.pi * deviation)
    return gaussian(values, dt, frequency)


def amplified(values: Floats, dt: float, frequency: float, order: int) -> Floats:
    """Response of a Butterworth amplifier, at rest at the first value before it.

    The values are at equal steps of `dt`, s; the response is exact for straight lines
    between them. The gain is 1/sqrt(2) at the frequency, Hz; the order is 1 or 2.
    InvalidModel for a frequency that is too low for the steps.
    """
    from scipy import signal

    if frequency * dt < MIN_FREQUENCY_STEP:
        lowest = format_si(MIN_FREQUENCY_STEP / dt, "Hz")
        raise invalid_argument(
            "frequency", f"must be {lowest} or more, got {frequency}"
        )
    analog = signal.butter(order, 2 * math.pi * frequency, analog=True)
    # "foh", a first-order hold, takes straight lines between samples.
    top, bottom, _ = signal.cont2discrete(analog, dt, method="foh")
    # `lfilter` begins at rest at 0: it takes differences from the first value.
    change = signal.lfilter(np.ravel(top), bottom, values - values[0])
    result: Floats = values[0] + change
    return result


LOW_PASS: dict[str, Callable[[Floats, float, float], Floats]] = {
    "gaussian": gaussian,
    "first-order": partial(amplified, order=1),
    "second-order": partial(amplified, order=2),
}


def averaged(values: Floats, times: Floats, duration: float) -> Floats:
    """Means over a duration, s, centred at each sample.

    They are exact for straight lines between samples; beyond the ends the first and the
    last value hold. Steps may differ. Means over less than `MIN_MEAN_STEPS` of the
    shortest step are the values themselves.
    """
    if duration < MIN_MEAN_STEPS * np.diff(times).min():
        return values
    from scipy.interpolate import make_interp_spline

    # One more point beyond each end, out of reach of the means
    around = np.concatenate(([times[0] - duration], times, [times[-1] + duration]))
    lines = make_interp_spline(around, np.pad(values, 1, "edge"), k=1)
    integral = lines.antiderivative()
    late = integral(times + duration / 2)
    early = integral(times - duration / 2)
    means: Floats = (late - early) / duration
    return means


def dispersed(values: Floats, dt: float, distance: float, bar: Any) -> Floats:
    """The pulse after a distance, m, along a `waves.Bar`.

    The values are at equal steps of `dt`, s. The travel time of long waves is left out,
    so that the times stay the same. Frequencies above the cut-off are removed, also
    over no distance. InvalidModel if the filtered record is too long.
    """
    duration = DISPERSION_TAIL * abs(distance) / bar.wave_speed
    # Samples. `_filter` refuses more than the limit; an infinite number has no `ceil`.
    tail = math.ceil(min(duration / dt, MAX_SAMPLES))

    def gain(f: Floats) -> Any:
        return first_mode(f, distance, bar)

    return _filter(values, dt, gain, tail)


def first_mode(f: Floats, distance: float, bar: Any) -> Any:
    """Complex gain of a distance, m, along a `waves.Bar`, at frequencies f, Hz.

    The frequencies are evenly spaced from 0 on. Delays count from the arrival of long
    waves; no wave above the cut-off goes on.
    """
    # A frequency stands for a band as wide as a step, and the share of this band below
    # the cut-off is carried.
    step = f[1]
    share_below = np.clip((bar.cut_off - f) / step + 0.5, 0.0, 1.0)
    carried = np.minimum(f, bar.cut_off)
    delays = bar.delays(carried)  # s, of each metre
    return share_below * np.exp(-2j * np.pi * carried * delays * distance)


def _filter(
    values: Floats, dt: float, gain: Callable[[Floats], Any], tail: int
) -> Floats:
    """Values, at equal steps of `dt`, s, after a filter.

    `gain` takes frequencies, Hz; the response of the filter lasts `tail` samples.
    Beyond the ends the first and the last value hold, as far as the filter reaches. The
    transform is periodic, so a smooth curve then leads from the last value back to the
    first one. InvalidModel if the record is longer than `MAX_SAMPLES` with all this.
    """
    from scipy import fft

    # Samples that are held at either end, and the least length of the curve back: the
    # response, and as a reserve a quarter of the record and 64 samples for short ones
    margin = tail + len(values) // 4 + 64
    if len(values) + 3 * margin > MAX_SAMPLES:
        message = f"{dt!r} makes the filtered record longer than {MAX_SAMPLES} samples"
        remedy = "use resampled(dt) with a longer dt, or a shorter distance"
        raise invalid_argument("dt", f"{message}; {remedy}")
    count = fft.next_fast_len(len(values) + 3 * margin, real=True)  # of the period
    first = values[0]
    last = values[-1]
    after = np.full(margin, last)
    before = np.full(margin, first)
    # The rest of the period leads back, by half a period of a cosine.
    back_count = count - len(values) - 2 * margin
    back = np.arange(1, back_count + 1)
    weight_of_last = (1 + np.cos(np.pi * back / (back_count + 1))) / 2  # from 1 to 0
    curve_back = first + (last - first) * weight_of_last
    period = np.concatenate((values, after, curve_back, before))
    spectrum = fft.rfft(period) * gain(fft.rfftfreq(count, dt))
    result: Floats = fft.irfft(spectrum, count)[: len(values)]
    return result
