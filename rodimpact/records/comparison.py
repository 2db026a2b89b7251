"""When a pulse comes and how long it lasts, and how far two signals are apart."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from ..model.quantities import Floats

Bounds: TypeAlias = float | tuple[float, float]
Record: TypeAlias = tuple[Floats, Floats]  # times and values

NEAR_TOP = 0.7  # of the largest sample: from here on samples belong to the plateau
SHIFTS = 513  # that are tried before the best is refined, and a quarter as many around the tops
ENOUGH = 10_000  # samples of a record to choose among these


class Pulse(NamedTuple):
    """Timing of a pulse.

    Attributes
    ----------
    start : float
        When it passes a tenth of the plateau, s.
    width : float
        At half of the plateau, s.
    rise : float
        From 10 % to 90 % of the plateau, s.
    plateau : float
        Median of its samples above 0.7 of the largest, in the unit of the signal, with its sign.

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
    """How far a prediction is from a record.

    Attributes
    ----------
    rms : float
        Root of the mean square of the difference over the plateau of the record.
    shift : float
        By which the prediction came later, s.
    scale : float
        By which it was multiplied.

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


def pulse_of(times: Floats, values: Floats) -> Pulse:
    """Timing of the pulse that holds the largest sample; ValueError if it is not whole."""
    top = int(np.abs(values).argmax())
    sign = 1.0 if values[top] >= 0 else -1.0
    v = sign * values
    level = plateau(v[slice(*_stretch(v, top, NEAR_TOP * v[top]))])
    start = _crossing(times, v, *_stretch(v, top, 0.1 * level), level * 0.1)[0]
    first, last = _stretch(v, top, 0.5 * level)
    up, down = _crossing(times, v, first, last, level * 0.5)
    if not np.isfinite([start, up, down]).all():
        raise ValueError(
            "the pulse is not whole in this record: before it the signal must be below a tenth of "
            "its plateau, after it below half; take a longer window, or subtract the baseline"
        )
    high = int(np.argmax(v[first:] >= 0.9 * level)) + first
    reach = times[high]
    if high > 0:
        reach = float(np.interp(0.9 * level, v[high - 1 : high + 1], times[high - 1 : high + 1]))
    return Pulse(start, down - up, float(reach) - start, sign * level)


def plateau(values: Floats) -> float:
    """Median of the samples above 0.7 of the largest, without its sign; ValueError if all are 0."""
    height = values if values.max() >= -values.min() else -values
    largest = height.max()
    if largest <= 0:
        raise ValueError("there is no pulse: the signal is 0 everywhere")
    return float(np.median(height[height > NEAR_TOP * largest]))


def gain_unit(measured: str, predicted: str) -> str:
    """Unit of what takes a prediction in one unit to a record in another; "" if they are alike.

    Examples
    --------
    >>> gain_unit("V", ""), gain_unit("", "V"), gain_unit("N", "V"), gain_unit("V", "V")
    ('V', '1/V', 'N/V', '')
    """
    if measured == predicted:
        return ""
    return f"{measured or 1}/{predicted}" if predicted else measured


def misfit_of(
    record: Record, model: Record, shift: tuple[float, float] | None,
    scale: tuple[float, float] | None,
) -> Misfit:
    """Smallest root of the mean square over the plateau of the record, within bounds."""
    times, values = record
    level = plateau(values)

    def at(shift: float, record: Record = record, model: Record = model) -> tuple[float, float]:
        """Misfit with the best scale, and that scale."""
        y, m = record[1], np.interp(record[0] - shift, *model)
        power = float(m @ m)
        best = float(m @ y) / power if power else 1.0
        if scale is not None:
            best = min(max(best, scale[0]), scale[1])
        return float(np.sqrt(np.mean((best * m - y) ** 2))) / level, best

    def rms(shift: float) -> float:
        return at(shift)[0]

    length = times[-1] - times[0]
    low, high = (-length, length) if shift is None else shift
    best = low
    if high > low:
        from scipy.optimize import minimize_scalar

        tried = np.linspace(low, high, SHIFTS)
        tops = times[np.abs(values).argmax()], model[0][np.abs(model[1]).argmax()]
        wide = length * np.mean(np.abs(values) > level / 2)  # so long is what is high
        together = tops[0] - tops[1] + wide * np.linspace(-1, 1, SHIFTS // 4)
        tried = np.sort(np.concatenate((tried, together[(low < together) & (together < high)])))
        few = _thinned(record), _thinned(model)
        i = int(np.argmin([at(s, *few)[0] for s in tried]))
        around = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
        options = {"xatol": 1e-9 * length}
        refined = minimize_scalar(rms, bounds=around, method="bounded", options=options)
        best = min((float(refined.x), float(tried[i])), key=rms)
    found, factor = at(best)
    return Misfit(found, best, factor)


def _thinned(record: Record) -> Record:
    """One sample in so many that `ENOUGH` are left, or twice as many."""
    times, values = (column[:: max(1, len(column) // ENOUGH)].copy() for column in record)
    return times, values


def _stretch(v: Floats, top: int, level: float) -> tuple[int, int]:
    """First sample of the stretch about `top` that is above a level, and the one past its last."""
    below = v < level
    before, after = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    first = int(before[-1]) + 1 if before.size else 0
    return first, top + int(after[0]) if after.size else len(v)


def _crossing(
    times: Floats, v: Floats, first: int, past: int, level: float
) -> tuple[float, float]:
    """When a stretch rises above a level and when it falls below; nan where the record ends."""
    up = down = np.nan
    if first > 0:
        up = np.interp(level, v[first - 1 : first + 1], times[first - 1 : first + 1])
    if past < len(v):
        down = np.interp(-level, -v[past - 1 : past + 1], times[past - 1 : past + 1])
    return float(up), float(down)
