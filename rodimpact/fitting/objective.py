"""Differences between predictions and records.

A point holds the scaled value of each parameter of the system, 0 at its lower and 1 at its upper
bound (called its share), then shift, gain and blur of the records. Only a change of shares needs a
new solution; shift, gain and blur are applied to the computed signals.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from functools import partial
from typing import Any

import numpy as np

from ..methods.registry import Options
from ..model import System
from ..model.frozen import InvalidModel
from ..model.quantities import Floats
from ..records import filters
from ..records.comparison import misfit_of
from ..records.signal import Signal
from ..results.solution import Solution
from .measured import Measured
from .parameters import KINDS, Parameter, changed

BEYOND = 1.0  # s, before and after a signal: a knot from which on it is constant
SHIFT, GAIN, BLUR = range(3)  # of `KINDS`


def smooth(signal: Signal, blur: float) -> Any:
    """The samples after a Gaussian average of this standard deviation, s, as a cubic spline.

    It is constant before the first sample and after the last one.
    """
    from scipy.interpolate import CubicSpline

    values = filters.blurred(signal.values, signal.dt, blur) if blur else signal.values
    curve = CubicSpline(signal.times, values)
    for end, value in (
        (signal.start - BEYOND, values[0]),
        (signal.end + BEYOND, values[-1]),
    ):
        curve.extend([[0.0], [0.0], [0.0], [value]], [end])
    return curve


def computed(
    system: System,
    options: Options,
    gauges: Sequence[tuple[int, float]],
    interval: float,
) -> list[Signal]:
    """Strains at the gauges; InvalidModel if the run stops before `until`."""
    solution = Solution(options.run(options.method, system), options)
    if solution.stopped_by != "until":
        raise InvalidModel([("until", f"is not reached: {solution.status}")])
    try:
        return [solution.gauge(*gauge).signal(interval) for gauge in gauges]
    except ValueError as error:
        message = f"the bounds put a gauge outside its rod ({error}); narrow the bounds"
        raise InvalidModel([("vary", message)]) from None


class Objective:
    """Differences of predictions and records, over the record levels."""

    def __init__(
        self,
        system: System,
        measured: Sequence[Measured],
        parameters: Sequence[Parameter],
        of_records: Sequence[Parameter],
        options: Options,
        interval: float,
        executor: Executor | None,
    ) -> None:
        self.system, self.measured, self.parameters = system, measured, parameters
        self.all = [*parameters, *of_records]  # in the order of the point
        self.run: Callable[[System], list[Signal]] = partial(
            computed,
            options=options,
            gauges=[m.gauge for m in measured],
            interval=interval,
        )
        self.map: Any = executor.map if executor else map
        self.solved = 0  # collisions
        self.heard: Callable[[int], None] = lambda _: None  # of each of them
        self.known: dict[bytes, list[Signal]] = {}  # of the last few shares
        self.places = np.zeros((len(KINDS), len(measured)), int)  # in the point
        for i, number in enumerate(of_records, len(parameters)):
            self.places[KINDS.index(number.kind), list(number.records)] = i
        self.levels = [m.size for m in measured]
        self.lengths = [len(m.signal) for m in measured]
        self.record = np.repeat(range(len(measured)), self.lengths)
        self.recorded = np.concatenate([m.signal.values / m.size for m in measured])
        self.low, self.high = np.array([n.ends for n in self.all]).T
        self.free = self.low < self.high
        self.is_blur = np.array([n.kind == "blur" for n in self.all])
        self.middle = self._middle()

    def _middle(self) -> Floats:
        """The middle of the bounds of each number; 0 where there are no bounds."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low = np.where(bounded, self.low, 0.0)
        high = np.where(bounded, self.high, 0.0)
        return np.asarray((low + high) / 2)

    def system_at(self, point: Floats) -> System:
        """The system with the parameter values of a point, or of its shares alone."""
        values = [
            p.value(s) for p, s in zip(self.parameters, point.tolist(), strict=False)
        ]
        return changed(self.system, self.parameters, values)

    def signals(self, points: Iterable[Floats]) -> list[list[Signal]]:
        """Predictions of each record for several points' shares, before shift, gain and blur."""
        systems = [self.system_at(shares) for shares in points]
        found = []
        for system, strains in zip(systems, self.map(self.run, systems), strict=True):
            found.append(
                [
                    m.carried(strain, system)
                    for m, strain in zip(self.measured, strains, strict=True)
                ]
            )
            self.solved += 1
            self.heard(self.solved)
        return found

    def blurred(self, signals: Sequence[Signal], point: Floats) -> list[Any]:
        """Predictions of each record as smooth curves, before gain and shift."""
        return list(map(smooth, signals, point[self.places[BLUR]].tolist()))

    def started(
        self, shares: Floats, signals: Sequence[Signal]
    ) -> tuple[float, Floats]:
        """Least sum of squares over shifts and gains at these shares, and its point.

        Blurs are as small as their bounds allow. A shift that several records have in common starts
        from the best shift of one of them.
        """
        point = np.where(self.is_blur, self.low, self.middle)
        point[: len(shares)] = shares
        curves = self.blurred(signals, point)
        own = []
        for m, c, i in zip(self.measured, curves, self.places.T.tolist(), strict=True):
            bounds = [(float(self.low[j]), float(self.high[j])) for j in i[:BLUR]]
            times = c.x[1:-1]  # of its samples
            pair = (m.signal.times, m.signal.values), (times, c(times))
            own.append(misfit_of(*pair, *bounds).shift)
        ends, gains = [], self.places[GAIN]
        for place, shift in zip(self.places[SHIFT], own, strict=True):
            end = point.copy()
            end[self.places[SHIFT]] = own
            end[place] = shift
            end[gains] = 1.0  # then the best gains for its shifts
            model = self._predicted(curves, end)
            cross, power = (
                np.bincount(gains[self.record], model * each, len(end))
                for each in (self.recorded, model)
            )
            best = np.divide(cross, power, out=np.ones_like(end), where=power > 0)
            end[gains] = np.clip(best, self.low, self.high)[gains]
            apart = self._predicted(curves, end) - self.recorded
            ends.append((float(np.sum(apart**2)), end))
        return min(ends, key=lambda end: end[0])

    def residuals(self, point: Floats) -> Floats:
        """Predictions less records, over their levels, one record after another."""
        curves = self.blurred(self._signals_at(point), point)
        return np.asarray(self._predicted(curves, point) - self.recorded)

    def _signals_at(self, point: Floats) -> list[Signal]:
        """Signals for the shares of a point; a derivative comes back to the shares before it."""
        shares = point[: len(self.parameters)]
        key = shares.tobytes()
        if key not in self.known:
            if len(self.known) > len(self.parameters) + 1:
                oldest = next(iter(self.known))
                del self.known[oldest]
            (self.known[key],) = self.signals([shares])
        return self.known[key]

    def _predicted(self, curves: Sequence[Any], point: Floats) -> Floats:
        """Predictions at the times of all records, over their levels."""
        each = zip(
            self.measured, self.levels, curves, point[self.places].T, strict=True
        )
        return np.concatenate(
            [
                gain * c(m.signal.times - shift) / level
                for m, level, c, (shift, gain, _) in each
            ]
        )
