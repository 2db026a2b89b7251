"""Differences between predictions and records, which a fit makes small.

A point holds the share of each parameter of the system, then the numbers of the
records: shifts, gains, blurs, offsets and trends. Only a change of shares needs a new
solution; the numbers of the records are applied to the computed signals.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..methods.registry import Options
from ..model import System
from ..model.frozen import InvalidModel
from ..model.quantities import Floats
from ..records import filters
from ..records.comparison import TimeSeries, misfit_of
from ..records.signal import Signal
from ..results.solution import Solution
from .images import Place
from .measured import Measured
from .parameters import (
    BLUR,
    GAIN,
    KINDS,
    OFFSET,
    SHIFT,
    TREND,
    Parameter,
    RecordParameter,
    SystemParameter,
    with_values,
)

CONSTANT_PIECE = 1.0
"""Duration of the constant piece at each end of a curve, s; its value holds beyond."""


def compute_strains(
    system: System,
    options: Options,
    places: Sequence[Place],
    interval: float,
) -> list[Signal]:
    """Solve a system, and return the strains at places, sampled every `interval`, s.

    Raises
    ------
    InvalidModel
        If the run stops before `until`, or a gauge lies outside its rod.
    """
    solution = Solution(options.run(options.method, system), options)
    if solution.stopped_by != "until":
        raise InvalidModel([("until", f"is not reached: {solution.status}")])
    try:
        return [place.strain(solution, interval) for place in places]
    except ValueError as error:
        message = f"the bounds put a gauge outside its rod ({error}); narrow the bounds"
        raise InvalidModel([("vary", message)]) from None


def smooth_curve(signal: Signal, blur: float) -> Any:
    """A signal as a cubic spline, blurred by a Gaussian of this standard deviation, s.

    It is constant before the first sample and after the last one. Its breakpoints are
    the sample times, with one more at each end.
    """
    from scipy.interpolate import CubicSpline

    values = signal.values
    if blur:
        values = filters.blurred(signal.values, signal.dt, blur)
    curve = CubicSpline(signal.times, values)
    # Coefficients of a cubic, the highest power first: only the constant is not 0.
    curve.extend([[0.0], [0.0], [0.0], [values[0]]], [signal.start - CONSTANT_PIECE])
    curve.extend([[0.0], [0.0], [0.0], [values[-1]]], [signal.end + CONSTANT_PIECE])
    return curve


class Start(NamedTuple):
    """A point from which a search may begin."""

    misfit: float  # sum of squares of the differences
    point: Floats


class Objective:
    """Differences of predictions and records, over the levels of the records.

    Attributes
    ----------
    numbers : list of Parameter
        Parameters in the order of a point.
    low, high : [number] array
        Bounds on the scale of a point.
    is_free : [number] array of bool
        Whether the bounds of a number leave it free to vary.
    is_blur : [number] array of bool
    middle : [number] array
        Middle of the bounds; 0 for a number without bounds.
    sample_counts : list of int
        Samples of each record.
    initial_shares : list of float
        Shares of the values that the parameters have in the system.
    """

    def __init__(
        self,
        *,
        system: System,
        measured: Sequence[Measured],
        parameters: Sequence[SystemParameter],
        record_parameters: Sequence[RecordParameter],
        options: Options,
        interval: float,
        executor: Executor | None,
        on_solved: Callable[[], object] | None = None,
    ) -> None:
        """Store bounds and indices of all numbers, and the records over their levels.

        Predictions will be solved by the executor, or one by one without it.
        """
        self.measured = measured
        self.numbers: list[Parameter] = [*parameters, *record_parameters]
        self._on_solved = on_solved
        bounds = np.array([number.scaled_bounds for number in self.numbers])
        self.low = bounds[:, 0]
        self.high = bounds[:, 1]
        self.is_free = self.low < self.high
        self.is_blur = np.zeros(len(self.numbers), bool)
        # Index in a point of each number of each record, [kind, record]. In a point the
        # numbers of records follow those of the system; records may share a number.
        self._index = np.zeros((len(KINDS), len(measured)), int)
        for i, number in enumerate(record_parameters, start=len(parameters)):
            self.is_blur[i] = number.kind == "blur"
            kind = KINDS.index(number.kind)
            self._index[kind, list(number.records)] = i
        self.middle = self._middle()

        self._system = system
        self._parameters = parameters
        self.initial_shares = [  # 0 to 1 between the bounds
            parameter.share(parameter.initial) for parameter in parameters
        ]
        places = [record.place for record in measured]
        self._compute_strains = partial(
            compute_strains, options=options, places=places, interval=interval
        )
        self._map: Any = executor.map if executor else map
        self._recent_signals: dict[bytes, list[Signal]] = {}  # keys: bytes of shares
        self.sample_counts: list[int] = []
        self._levels: list[float] = []
        scaled_records = []
        for record in measured:
            self.sample_counts.append(len(record.signal))
            self._levels.append(record.size)
            scaled_records.append(record.signal.values / record.size)
        self._record_of_sample = np.repeat(range(len(measured)), self.sample_counts)
        self._recorded = np.concatenate(scaled_records)

    def _middle(self) -> Floats:
        """Middle of the bounds of each number; 0 for one without bounds.

        A number that lacks only one of its bounds counts as one without.
        """
        is_bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low = np.where(is_bounded, self.low, 0.0)
        high = np.where(is_bounded, self.high, 0.0)
        return np.asarray((low + high) / 2)

    def system_at(self, point: Floats) -> System:
        """The system at a point; only the shares of parameters in it are needed."""
        values = []
        # `zip` leaves out the numbers of the records, which follow in a point.
        for parameter, share in zip(self._parameters, point.tolist(), strict=False):
            values.append(parameter.value(share))
        return with_values(self._system, self._parameters, values)

    # Predictions

    def signals(self, shares: Iterable[Floats]) -> list[list[Signal]]:
        """Predictions [point][record] of all records at several points.

        A point is an array of shares, see `system_at`. Blur, shift, gain, offset and
        trend are not applied yet. The system of each point is solved once, and
        `on_solved` is called after each system.
        """
        systems = list(map(self.system_at, shares))
        strains_of_systems = self._map(self._compute_strains, systems)
        signals_of_systems = []
        # The map is lazy, so that each round of this loop waits for one system.
        for system, strains in zip(systems, strains_of_systems, strict=True):
            signals = []
            for record, strain in zip(self.measured, strains, strict=True):
                signals.append(record.prediction(strain, system))
            signals_of_systems.append(signals)
            if self._on_solved is not None:
                self._on_solved()
        return signals_of_systems

    def _curves(self, signals: Sequence[Signal], point: Floats) -> list[Any]:
        """Blurred prediction of each record as a spline, before gain and shift."""
        blurs = point[self._index[BLUR]].tolist()
        return list(map(smooth_curve, signals, blurs))

    def _predictions(self, curves: Sequence[Any], point: Floats) -> Floats:
        """Predictions at the samples of all records, one record after another.

        `curves` are the blurred signals by record. Each gets the shift, gain, offset
        and trend that the point has for its record, and is divided by the level of the
        record. The trend is 0 in the middle of the record.
        """
        shifts = point[self._index[SHIFT]]
        gains = point[self._index[GAIN]]
        offsets = point[self._index[OFFSET]]
        trends = point[self._index[TREND]]
        predictions = []
        for k, record in enumerate(self.measured):
            times = record.signal.times
            values = gains[k] * curves[k](times - shifts[k])
            if offsets[k] != 0.0 or trends[k] != 0.0:
                middle = (times[0] + times[-1]) / 2
                values = values + offsets[k] + trends[k] * (times - middle)
            predictions.append(values / self._levels[k])
        return np.concatenate(predictions)

    def residuals(self, point: Floats) -> Floats:
        """Predictions less records, over their levels, one record after another."""
        shares = point[: len(self._parameters)]
        curves = self._curves(self._signals_at(shares), point)
        return np.asarray(self._predictions(curves, point) - self._recorded)

    def _signals_at(self, shares: Floats) -> list[Signal]:
        """Prediction of each record before blur, shift, gain, offset and trend.

        The last few are stored, since a search returns to the same shares after each
        derivative.
        """
        key = shares.tobytes()
        if key not in self._recent_signals:
            # Derivatives need the shares, and one change of each share.
            if len(self._recent_signals) > len(self._parameters) + 1:
                oldest = next(iter(self._recent_signals))
                del self._recent_signals[oldest]
            self._recent_signals[key] = self.signals([shares])[0]
        return self._recent_signals[key]

    # Starts of searches

    def point_at(self, shares: Sequence[float] | Floats) -> Floats:
        """Point with given shares, the least blurs, and the middle of other bounds."""
        point = np.where(self.is_blur, self.low, self.middle)
        point[: len(shares)] = shares
        return point

    def best_start(self, shares: Floats, signals: Sequence[Signal]) -> Start:
        """Point with the best shifts and gains for given shares.

        Blurs are as small as their bounds allow. A shift that several records have in
        common starts from the best shift of one of them, the one with the least misfit.
        """
        point = self.point_at(shares)
        curves = self._curves(signals, point)
        shift_indices = self._index[SHIFT]
        best_shifts = self._best_shifts(curves)
        starts = []
        for index, shift in zip(shift_indices, best_shifts, strict=True):
            start = point.copy()
            start[shift_indices] = best_shifts
            start[index] = shift  # all records with this shift have it in common
            self._set_best_gains(curves, start)
            difference = self._predictions(curves, start) - self._recorded
            starts.append(Start(float(np.sum(difference**2)), start))
        return min(starts, key=lambda start: start.misfit)

    def _best_shifts(self, curves: Sequence[Any]) -> list[float]:
        """Best shift of each record by itself, s, each with its best gain.

        Shifts and gains stay within their bounds.
        """
        shifts = []
        for k, record in enumerate(self.measured):
            shift_index = self._index[SHIFT, k]
            gain_index = self._index[GAIN, k]
            # `smooth_curve` has added one breakpoint to the sample times at each end.
            sample_times = curves[k].x[1:-1]
            misfit = misfit_of(
                TimeSeries(record.signal.times, record.signal.values),
                TimeSeries(sample_times, curves[k](sample_times)),
                (float(self.low[shift_index]), float(self.high[shift_index])),
                (float(self.low[gain_index]), float(self.high[gain_index])),
            )
            shifts.append(misfit.shift)
        return shifts

    def _set_best_gains(self, curves: Sequence[Any], point: Floats) -> None:
        """Set the gains in `point` to the best within their bounds, in place.

        The shifts, blurs and shares in `point` stay as they are.

        Each gain is the least-squares solution sum(m r)/sum(m^2) of gain m = r, with
        predictions m at gain 1 and samples r of all records that share this gain. It is
        1 where all m are 0.
        """
        # By record: index of its gain in `point`; equal where records share a gain
        indices = self._index[GAIN]
        point[indices] = 1.0
        model = self._predictions(curves, point)
        # Index in the point of the gain of each sample
        index_of_sample = indices[self._record_of_sample]
        size = len(point)
        cross = np.bincount(index_of_sample, model * self._recorded, size)
        power = np.bincount(index_of_sample, model * model, size)
        best = np.divide(cross, power, out=np.ones_like(point), where=power > 0)
        point[indices] = np.clip(best, self.low, self.high)[indices]
