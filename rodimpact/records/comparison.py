"""Misfit between a prediction and a record, with the best shift and scale."""

from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ..hints import explain_missing
from ..model.quantities import Floats
from .pulses import plateau

Bounds: TypeAlias = float | tuple[float, float]
Range: TypeAlias = tuple[float, float]
"""Lower and upper bound."""

MAX_GRID_SAMPLES = 1 << 16
"""Largest number of grid steps in the record and the range of shifts together."""
NEGLIGIBLE_POWER_RTOL = 1e-12
"""Sum of squares of a shifted model, over that of the whole model, that counts as 0.

Smaller sums are round-off.
"""
REFINED_SHIFTS = 4
"""Number of best shifts on the grid that are refined."""
AT_BOUND_RTOL = 1e-3
"""Distance from a bound, over the range of the bounds, that counts as at the bound."""


class TimeSeries(NamedTuple):
    """Values over times, s; linear between them."""

    times: Floats
    values: Floats

    def at(self, times: Floats) -> Any:
        """Values at other times, s; beyond the ends, the first or the last value."""
        return np.interp(times, self.times, self.values)


@explain_missing()
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
        ``"shift"`` and ``"scale"``, if they lie at a bound. A free shift is bounded
        too: the two signals must overlap.

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


def gain_unit(measured: str, predicted: str) -> str:
    """Unit of the factor from the prediction to the record; "" if the units are equal.

    Examples
    --------
    >>> gain_unit("V", ""), gain_unit("", "V"), gain_unit("N", "V"), gain_unit("V", "V")
    ('V', '1/V', 'N/V', '')
    """
    if measured == predicted:
        return ""
    if not predicted:
        return measured
    if not measured:
        return f"1/{predicted}"
    return f"{measured}/{predicted}"


def misfit_of(
    record: TimeSeries,
    model: TimeSeries,
    shift_range: Range | None,
    scale_range: Range | None,
) -> Misfit:
    """Misfit of a model to a record with the best shift, s, and the best scale.

    Equal bounds fix a number. Without bounds (None) the scale is free, and the shift is
    bounded by the condition that model and record overlap. `at_limit` names the number,
    shift or scale, that is not fixed and lies at a bound. ValueError for a record that
    is 0 everywhere.
    """
    comparison = _Comparison(record, model, plateau(record.values), scale_range)
    if shift_range is None:
        # Delayed by `low` the model ends where the record begins; delayed by `high` it
        # begins where the record ends.
        low = record.times[0] - model.times[-1]
        high = record.times[-1] - model.times[0]
    else:
        low, high = shift_range
    shift = low  # a fixed shift, if both bounds are equal
    near_bound = 0.0  # a shift this near to a bound, s, counts as being at the bound
    if high > low:
        step = _grid_step(record, model, high - low)
        shift = _best_shift(comparison, low, high, step)
        near_bound = AT_BOUND_RTOL * (high - low)
        if shift_range is None:
            near_bound = step  # the overlap is then a step or less
    best = comparison.with_shift(shift)
    at_limit = []
    if _is_at_bound(shift, low, high, near_bound):
        at_limit.append("shift")
    if scale_range is not None:
        least, most = scale_range
        if _is_at_bound(best.scale, least, most, AT_BOUND_RTOL * (most - least)):
            at_limit.append("scale")
    return Misfit(rms=best.rms, shift=shift, scale=best.scale, at_limit=tuple(at_limit))


class _Scaled(NamedTuple):
    """Misfit of a shifted model with its best scale; tuples compare by `rms` first."""

    rms: float  # divided by the plateau of the record
    scale: float


@dataclass(frozen=True)
class _Comparison:
    """A record, a model to be shifted and scaled, and the bounds of the scale."""

    record: TimeSeries
    model: TimeSeries
    plateau: float
    scale_range: Range | None

    def with_shift(self, shift: float) -> _Scaled:
        """Misfit of the model delayed by `shift`, s, with the best scale.

        The misfit is the rms of (scale model - record) over all samples of the record,
        divided by the plateau of the record. The scale lies within `scale_range`.
        """
        values = self.record.values
        # The delayed model at the time t is the model at t - shift.
        shifted = self.model.at(self.record.times - shift)
        scale = float(self.best_scale(shifted @ values, shifted @ shifted))
        residuals = scale * shifted - values
        rms = float(np.sqrt(np.mean(residuals**2)))
        return _Scaled(rms / self.plateau, scale)

    def best_scale(self, product: Any, power: Any) -> Any:
        """Scale by least squares, product/power, clipped to `scale_range`.

        `product` is the sum of model times record over the samples, and `power` the sum
        of model^2; both are numbers, or arrays over shifts. If the power is 0, the
        scale is 1 before clipping.
        """
        divisor = np.where(power > 0, power, 1.0)  # avoids a division by 0
        best = np.where(power > 0, product / divisor, 1.0)
        if self.scale_range is None:
            return best
        return np.clip(best, *self.scale_range)


def _grid_step(record: TimeSeries, model: TimeSeries, span: float) -> float:
    """Time step of the grid on which record and model are compared, s.

    It is the shortest step of both. It is longer if the record and the range of shifts,
    `span`, s, would have more than `MAX_GRID_SAMPLES` such steps.
    """
    shortest = min(np.diff(record.times).min(), np.diff(model.times).min())
    length = record.times[-1] - record.times[0]
    return float(max(shortest, (length + span) / MAX_GRID_SAMPLES))


def _best_shift(comparison: _Comparison, low: float, high: float, step: float) -> float:
    """The shift from `low` to `high`, s, with the smallest misfit.

    The best shifts on a grid of `step`, s, are refined within one step to either side.
    The result is the best of all these shifts, refined or not.
    """
    from scipy.optimize import minimize_scalar

    times = comparison.record.times
    options = {"xatol": 1e-9 * (times[-1] - times[0])}  # error of a shift, s
    on_grid = _best_shifts_on_grid(comparison, low, high, step)
    refined = []
    for shift in on_grid:
        solution = minimize_scalar(
            lambda x: comparison.with_shift(x).rms,
            method="bounded",
            options=options,
            bounds=(max(shift - step, low), min(shift + step, high)),
        )
        refined.append(float(solution.x))
    # `min` compares the tuples (misfit, scale) of `with_shift`: the misfit decides.
    return min([*refined, *on_grid], key=comparison.with_shift)


def _best_shifts_on_grid(
    comparison: _Comparison, low: float, high: float, step: float
) -> list[float]:
    """Shifts, s, at the best local minima of the misfit, among ``high - j step``.

    The best shift comes first, and there are at most `REFINED_SHIFTS`. With the model
    m, the record y and the scale c the squared misfit is ``c^2 sum(m^2) - 2 c sum(m y)
    + sum(y^2)``. The sums of m y for all shifts are a correlation, which is computed by
    Fourier transforms.
    """
    times = comparison.record.times
    n = int((times[-1] - times[0]) / step) + 1  # samples of the record
    n_shifts = int((high - low) / step) + 1
    # The record at the time t is compared with the model at t - shift. For the shift
    # high - j step this is m[j : j + n], and power[j] is the sum of its squares.
    y_times = times[0] + step * np.arange(n)
    m_times = times[0] - high + step * np.arange(n + n_shifts - 1)
    y = comparison.record.at(y_times)
    m = comparison.model.at(m_times)
    size = 1 << (len(m) - 1).bit_length()  # the least power of two >= len(m)
    spectrum = np.fft.rfft(m, size) * np.conj(np.fft.rfft(y, size))
    product = np.fft.irfft(spectrum, size)[:n_shifts]  # sum(m y) for each j
    sums = np.concatenate(([0.0], np.cumsum(m * m)))  # sums[i] is the sum over m[:i]
    power = sums[n : n + n_shifts] - sums[:n_shifts]  # sums[j + n] - sums[j]
    power[power <= NEGLIGIBLE_POWER_RTOL * sums[-1]] = 0.0  # less is round-off
    c = comparison.best_scale(product, power)
    # The term sum(y^2) is left out, since it is the same for all shifts.
    misfit = c * c * power - 2 * c * product
    # A local minimum is not larger than its left neighbour, padded[:-2], and its right
    # one, padded[2:]; the neighbours beyond the ends are inf.
    padded = np.concatenate(([np.inf], misfit, [np.inf]))
    is_minimum = (misfit <= padded[:-2]) & (misfit <= padded[2:])
    minima = np.flatnonzero(is_minimum)
    order = np.argsort(misfit[minima], kind="stable")
    best_first = minima[order]
    shifts = []
    for j in best_first[:REFINED_SHIFTS]:
        shift = min(max(high - j * step, low), high)  # round-off may pass `low`
        shifts.append(float(shift))
    return shifts


def _is_at_bound(value: float, low: float, high: float, near: float) -> bool:
    """Whether a value is at one of its bounds: no further from it than `near`.

    The result is false for a fixed value, whose bounds are equal.
    """
    is_inside = low + near < value < high - near
    return low < high and not is_inside
