"""Effects of gauges, amplifiers and bars on a pulse: linear filters at equal time steps.

Before the record its first value holds, after the record its last value.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..model.frozen import refusal
from ..model.quantities import Floats

MOST = 10**7  # samples of a record with its margins
SHORT = 1e-6  # of a step: what a mean over less would tell is lost in round-off


def gaussian(values: Floats, dt: float, frequency: float) -> Floats:
    """Gaussian filter whose gain falls to 1/sqrt(2) at a frequency, Hz."""
    tail = math.ceil(min(1 / dt / frequency, MOST))  # 7.5 standard deviations
    half = math.log(2) / 2
    return _through(values, dt, lambda f: np.exp(-half * (f / frequency) ** 2), tail)


def blurred(values: Floats, dt: float, deviation: float) -> Floats:
    """Gaussian filter of this standard deviation, s."""
    return gaussian(values, dt, math.sqrt(math.log(2)) / (2 * math.pi * deviation))


def amplified(values: Floats, dt: float, frequency: float, order: int) -> Floats:
    """Response of a Butterworth amplifier at rest before, exact for lines between samples."""
    from scipy import signal

    analog = signal.butter(order, 2 * math.pi * frequency, analog=True)
    top, bottom, _ = signal.cont2discrete(analog, dt, method="foh")
    result: Floats = values[0] + signal.lfilter(
        np.ravel(top), bottom, values - values[0]
    )
    return result


LOW_PASS: dict[str, Callable[[Floats, float, float], Floats]] = {
    "gaussian": gaussian,
    "first-order": partial(amplified, order=1),
    "second-order": partial(amplified, order=2),
}


def averaged(values: Floats, times: Floats, duration: float) -> Floats:
    """Means over a duration centred at each sample, exact for straight lines; steps may differ."""
    if duration < SHORT * np.diff(times).min():
        return values
    from scipy.interpolate import make_interp_spline

    around = np.concatenate(([times[0] - duration], times, [times[-1] + duration]))
    integral = make_interp_spline(around, np.pad(values, 1, "edge"), 1).antiderivative()
    late, early = integral(times + duration / 2), integral(times - duration / 2)
    means: Floats = (late - early) / duration
    return means


def dispersed(values: Floats, dt: float, distance: float, bar: Any) -> Floats:
    """The pulse after a distance, m, along a `waves.Bar`, without the travel time of long waves."""
    tail = math.ceil(min(3 * abs(distance) / bar.wave_speed / dt, MOST))
    return _through(values, dt, lambda f: first_mode(f, distance, bar), tail)


def first_mode(f: Floats, distance: float, bar: Any) -> Any:
    """What a distance in m along a `waves.Bar` makes of evenly spaced frequencies from 0 on.

    Delays count from the arrival of long waves; nothing above the cut-off goes on.
    """
    below = np.clip(
        (bar.cut_off - f) / f[1] + 0.5, 0.0, 1.0
    )  # share of what f stands for
    carried = np.minimum(f, bar.cut_off)
    return below * np.exp(-2j * np.pi * carried * bar.delays(carried) * distance)


def _through(
    values: Floats, dt: float, transfer: Callable[[Floats], Any], tail: int
) -> Floats:
    """Values after a filter of that gain over frequency, whose answers last `tail` samples.

    A smooth way leads from the last value back to the first, out of reach of the record.
    """
    from scipy import fft

    margin = tail + len(values) // 4 + 64
    if len(values) + 3 * margin > MOST:
        message = f"{dt!r} makes the filtered record longer than {MOST} samples"
        raise refusal(
            "dt",
            f"{message}; use resampled(dt) with a longer dt, or a shorter distance",
        )
    count = fft.next_fast_len(len(values) + 3 * margin, real=True)
    back = np.arange(1, count - len(values) - 2 * margin + 1)
    weight = (1 + np.cos(np.pi * back / (len(back) + 1))) / 2
    first, last = values[0], values[-1]
    whole = np.concatenate(
        (
            values,
            np.full(margin, last),
            first + (last - first) * weight,
            np.full(margin, first),
        )
    )
    spectrum = fft.rfft(whole) * transfer(fft.rfftfreq(count, dt))
    result: Floats = fft.irfft(spectrum, count)[: len(values)]
    return result
