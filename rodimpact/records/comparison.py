"""Timing of a pulse, and misfit between two signals."""

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ..model.quantities import Floats

Bounds: TypeAlias = float | tuple[float, float]
Record: TypeAlias = tuple[Floats, Floats]  # times and values

NEAR_TOP = 0.7  # of the largest sample: from here on samples belong to the plateau
MOST_LAGS = (
    1 << 16
)  # samples of a record and its shifts, among which the best is chosen
FAINT = 1e-12  # of the power of a model: less is round-off
REFINED = 4  # of the best shifts of a sample each
AT_LIMIT = 1e-3  # of the range between two limits


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


class Misfit(NamedTuple):
    """Misfit between a prediction and a record.

    Attributes
    ----------
    rms : float
        Root mean square of the difference, divided by the plateau of the record.
    shift : float
        Delay that was added to the prediction, s.
    scale : float
        Factor by which the prediction was multiplied.
    at_limit : tuple of str
        ``"shift"`` and ``"scale"``, if they lie at a bound. A free shift is bounded too: the two
        signals must overlap.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> record = ri.Signal(np.hanning(201), dt=1e-6)
    >>> found = record.misfit((0.5 * record).shifted(-3e-6))
    >>> round(found.shift * 1e6, 6), round(found.scale, 6)
    (3.0, 2.0)
    """

    rms: float
    shift: float
    scale: float
    at_limit: tuple[str, ...] = ()


def pulse_of(times: Floats, values: Floats) -> Pulse:
    """Timing of the pulse with the largest sample; ValueError if the record cuts the pulse off."""
    sign = 1.0 if values.max() >= -values.min() else -1.0
    v = np.concatenate(
        ([-np.inf], sign * values, [-np.inf])
    )  # below any level beyond the ends
    t = np.concatenate(([np.nan], times, [np.nan]))
    top = int(v.argmax())

    def stretch(level: float) -> tuple[slice, float, float]:
        """Samples about the top down to a level, and when the pulse rises above it and falls."""
        below = np.flatnonzero(v < level)
        i, j = below[np.searchsorted(below, top) + np.array([-1, 0])]
        up = np.interp(level, v[i : i + 2], t[i : i + 2])
        down = np.interp(-level, -v[j - 1 : j + 1], t[j - 1 : j + 1])
        return slice(i + 1, j), float(up), float(down)

    level = plateau(v[stretch(NEAR_TOP * v[top])[0]])
    _, start, _ = stretch(0.1 * level)
    above, up, down = stretch(0.5 * level)
    if not np.isfinite([start, up, down]).all():
        raise ValueError(
            "the record cuts the pulse off: before the pulse the signal must be below a tenth of "
            "its plateau, after it below half; use a longer window, or subtract the baseline"
        )
    high = above.start + int(np.argmax(v[above] >= 0.9 * level))
    reach = float(
        np.interp(0.9 * level, v[high - 1 : high + 1], t[high - 1 : high + 1])
    )
    return Pulse(start, down - up, reach - start, sign * level)


def plateau(values: Floats) -> float:
    """Absolute median of the samples above 0.7 of the largest; ValueError if all samples are 0."""
    height = values if values.max() >= -values.min() else -values
    largest = height.max()
    if largest <= 0:
        raise ValueError("there is no pulse: the signal is 0 everywhere")
    return float(np.median(height[height > NEAR_TOP * largest]))


def gain_unit(measured: str, predicted: str) -> str:
    """Unit of the factor from the prediction to the record; "" if both have the same unit.

    Examples
    --------
    >>> gain_unit("V", ""), gain_unit("", "V"), gain_unit("N", "V"), gain_unit("V", "V")
    ('V', '1/V', 'N/V', '')
    """
    if measured == predicted:
        return ""
    return f"{measured or 1}/{predicted}" if predicted else measured


def misfit_of(
    record: Record,
    model: Record,
    shift: tuple[float, float] | None,
    scale: tuple[float, float] | None,
) -> Misfit:
    """Misfit with the best shift and scale within their bounds."""
    times, values = record
    level = plateau(values)

    def at(shift: float) -> tuple[float, float]:
        """Misfit with the best scale, and that scale."""
        m = np.interp(times - shift, *model)
        best = float(_best_scale(m @ values, m @ m, scale))
        return float(np.sqrt(np.mean((best * m - values) ** 2))) / level, best

    # a free shift is one with which the two overlap
    low, high = shift or (times[0] - model[0][-1], times[-1] - model[0][0])
    best, near = low, 0.0
    if high > low:
        from scipy.optimize import minimize_scalar

        # of all shifts by whole samples those that suit best; the sums of products for all shifts
        # at once are a correlation, by Fourier transforms
        length = times[-1] - times[0]
        step = float(
            max(
                min(np.diff(times).min(), np.diff(model[0]).min()),
                (length + high - low) / MOST_LAGS,
            )
        )
        n, lags = int(length / step) + 1, int((high - low) / step) + 1
        y = np.interp(times[0] + step * np.arange(n), times, values)
        m = np.interp(times[0] - high + step * np.arange(n + lags - 1), *model)
        size = 1 << (len(m) - 1).bit_length()
        cross = np.fft.irfft(
            np.fft.rfft(m, size) * np.conj(np.fft.rfft(y, size)), size
        )[:lags]
        sums = np.concatenate(([0.0], np.cumsum(m * m)))
        power = sums[n : n + lags] - sums[:lags]
        power[power <= FAINT * sums[-1]] = 0.0
        c = _best_scale(cross, power, scale)
        error = np.concatenate(([np.inf], c * c * power - 2 * c * cross, [np.inf]))
        least = np.flatnonzero((error[1:-1] <= error[:-2]) & (error[1:-1] <= error[2:]))
        chosen = least[np.argsort(error[least + 1], kind="stable")[:REFINED]]
        shifts = [float(min(max(high - j * step, low), high)) for j in chosen]
        options = {"xatol": 1e-9 * length}
        refined = [
            float(
                minimize_scalar(
                    lambda x: at(x)[0],
                    method="bounded",
                    options=options,
                    bounds=(max(s - step, low), min(s + step, high)),
                ).x
            )
            for s in shifts
        ]
        best = min([*refined, *shifts], key=at)
        near = step if shift is None else AT_LIMIT * (high - low)
    found, factor = at(best)
    limits = {"shift": (best, low, high, near)}
    if scale is not None:
        limits["scale"] = (factor, *scale, AT_LIMIT * (scale[1] - scale[0]))
    told = tuple(
        name
        for name, (x, least, most, apart) in limits.items()
        if least < most and not least + apart < x < most - apart
    )
    return Misfit(found, best, factor, told)


def _best_scale(cross: Any, power: Any, scale: tuple[float, float] | None) -> Any:
    """What multiplies a model best: of its products with the record and with itself."""
    best = np.where(power > 0, cross / np.where(power > 0, power, 1.0), 1.0)
    return best if scale is None else np.clip(best, *scale)
