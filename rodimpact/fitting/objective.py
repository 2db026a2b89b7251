"""Differences between predictions and records, and their derivatives.

A point holds the scaled value of each parameter of the system, 0 at its lower and 1 at its upper
bound (called its share), then shift, gain and blur of the records. Only a change of shares needs a
new solution; shift, gain and blur are applied to the computed signals.
"""

from __future__ import annotations

import math
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
from ..records.comparison import misfit_of
from ..records.signal import Signal
from ..results.solution import Solution
from .measured import Measured
from .parameters import Parameter, changed
from .ties import KINDS

CHANGE = 1e-3  # of the plateau, by which signals are to change for a quotient of differences
FIRST, LEAST, MOST = 1e-4, 1e-6, 1e-2  # steps between the bounds for that
TOO_FAR = 4.0  # times the right step, beyond which the quotient is taken anew


class Curve(NamedTuple):
    """A computed signal as a smooth function of time, constant beyond its ends."""

    spline: Any
    ends: tuple[float, float]

    @classmethod
    def through(cls, signal: Signal, blur: float) -> Curve:
        """The curve through all samples after a Gaussian average of this standard deviation, s."""
        from scipy.interpolate import CubicSpline

        values = filters.blurred(signal.values, signal.dt, blur) if blur else signal.values
        return cls(CubicSpline(signal.times, values), (signal.start, signal.end))

    def at(self, t: Floats) -> Floats:
        """Values at times, s."""
        values: Floats = self.spline(np.clip(t, *self.ends))
        return values

    def slope(self, t: Floats) -> Floats:
        """Derivatives at times, 1/s."""
        inside = (t >= self.ends[0]) & (t <= self.ends[1])
        return np.where(inside, self.spline(t, 1), 0.0)


def computed(
    system: System, options: Options, gauges: Sequence[tuple[int, float]], interval: float
) -> list[Signal]:
    """Strains at the gauges; InvalidModel if the run stops before `until`."""
    solution = Solution(options.run(options.method, system))
    if solution.stopped_by != "until":
        raise InvalidModel([("until", f"is not reached: {solution.status}")])
    try:
        return [solution.gauge(*gauge).signal(interval) for gauge in gauges]
    except ValueError as error:
        message = f"the bounds put a gauge outside its rod ({error}); narrow the bounds"
        raise InvalidModel([("vary", message)]) from None


class Objective:
    """Differences of predictions and records over the record levels, and their derivatives."""

    def __init__(
        self, system: System, measured: Sequence[Measured], parameters: Sequence[Parameter],
        of_records: Sequence[Parameter], options: Options, interval: float,
        executor: Executor | None,
    ) -> None:
        self.system, self.measured, self.parameters = system, measured, parameters
        self.all = [*parameters, *of_records]  # in the order of the point
        self.run: Callable[[System], list[Signal]] = partial(
            computed, options=options, gauges=[m.gauge for m in measured], interval=interval
        )
        self.map: Any = executor.map if executor else map
        self.solved = 0  # collisions
        self.heard: Callable[[int], None] = lambda _: None  # of each of them
        self.steps = np.full(len(parameters), FIRST)
        self.known: tuple[bytes, list[Signal]] = b"", []
        self.places = np.zeros((len(measured), len(KINDS)), int)  # in the point
        for i, number in enumerate(of_records, len(parameters)):
            self.places[list(number.records), KINDS.index(number.kind)] = i
        self.low, self.high = np.array([n.ends for n in self.all]).T
        self.free = self.low < self.high
        self.middle = [(n.low + n.high) / 2 if math.isfinite(n.high) else 0.0 for n in of_records]

    def system_at(self, point: Floats) -> System:
        """The system with the parameter values of a point, or of its shares alone."""
        values = [p.value(s) for p, s in zip(self.parameters, point.tolist(), strict=False)]
        return changed(self.system, self.parameters, values)

    def signals(self, points: Iterable[Floats]) -> list[list[Signal]]:
        """Predictions of each record for several points' shares, before shift, gain and blur."""
        systems = [self.system_at(shares) for shares in points]
        found = []
        for system, strains in zip(systems, self.map(self.run, systems), strict=True):
            found.append([m.carried(strain, system)
                          for m, strain in zip(self.measured, strains, strict=True)])
            self.solved += 1
            self.heard(self.solved)
        return found

    def blurred(self, signals: Sequence[Signal], point: Floats) -> list[Curve]:
        """Predictions of each record as smooth curves, before gain and shift."""
        blurs = point[self.places[:, KINDS.index("blur")]].tolist()
        return list(map(Curve.through, signals, blurs))

    def started(self, shares: Floats, signals: Sequence[Signal]) -> tuple[float, Floats]:
        """Least sum of squares over shifts and gains at these shares, and its point.

        A shift that several records have in common starts from the best shift of one of them.
        """
        point = np.concatenate((shares, self.middle))
        curves = self.blurred(signals, point)
        own = []
        for m, c, (shift, gain, _) in zip(self.measured, curves, self.places, strict=True):
            pair = (m.signal.times, m.signal.values), (c.spline.x, c.spline(c.spline.x))
            bounds = [(float(self.low[i]), float(self.high[i])) for i in (shift, gain)]
            own.append(misfit_of(*pair, *bounds).shift)
        ends = []
        for first in range(len(own)):
            order = [k for k in range(len(own)) if k != first] + [first]
            end = point.copy()
            end[self.places[order, 0]] = [own[k] for k in order]  # what is written last stays
            self._set_gains(end, curves)
            ends.append((float(np.sum(self._apart(curves, end) ** 2)), end))
        return min(ends, key=lambda end: end[0])

    def _set_gains(self, point: Floats, curves: Sequence[Curve]) -> None:
        """Set the gains of a point to the best ones for its shifts."""
        cross, power = np.zeros_like(point), np.zeros_like(point)
        for m, c, (shift, gain, _) in zip(self.measured, curves, self.places, strict=True):
            model, record = c.at(m.signal.times - point[shift]) / m.size, m.signal.values / m.size
            cross[gain] += model @ record
            power[gain] += model @ model
        gains = np.unique(self.places[:, KINDS.index("gain")])
        best = np.divide(cross, power, out=np.ones_like(point), where=power > 0)
        point[gains] = np.clip(best, self.low, self.high)[gains]

    def residuals(self, point: Floats) -> Floats:
        """All records, one after another."""
        return self._apart(self.blurred(self._signals_at(point), point), point)

    def _signals_at(self, point: Floats) -> list[Signal]:
        shares = point[: len(self.parameters)]
        if self.known[0] != shares.tobytes():
            self.known = shares.tobytes(), self.signals([shares])[0]
        return self.known[1]

    def _apart(self, curves: Sequence[Curve], point: Floats) -> Floats:
        return np.concatenate([
            (point[gain] * c.at(m.signal.times - point[shift]) - m.signal.values) / m.size
            for m, c, (shift, gain, _) in zip(self.measured, curves, self.places, strict=True)
        ])

    def derivatives(self, point: Floats) -> Floats:
        """Derivatives of the residuals by each number of the point, shape (sample, number).

        The derivatives with respect to shares and blurs are central differences. Their steps change
        the signals by about `CHANGE`.
        """
        shares, wider, narrower = point[: len(self.parameters)], point.copy(), point.copy()
        blurs = self.places[:, KINDS.index("blur")]
        wider[blurs] *= 1 + CHANGE
        narrower[blurs] *= 1 - CHANGE
        curves, *by_blur = (self.blurred(self._signals_at(at), at)
                            for at in (point, wider, narrower))
        beside = [np.clip(shares + sign * step, 0, 1)
                  for step in np.diag(self.steps) for sign in (1, -1)]
        near = [self.blurred(signals, point) for signals in self.signals(beside)]
        blocks = []
        for k, (m, c, place) in enumerate(zip(self.measured, curves, self.places, strict=True)):
            shift, gain, blur = point[place]
            t = m.signal.times - shift
            block = np.zeros((len(t), len(point)))
            for j in range(len(shares)):
                apart = beside[2 * j][j] - beside[2 * j + 1][j]
                block[:, j] = gain * (near[2 * j][k].at(t) - near[2 * j + 1][k].at(t)) / apart
            block[:, place[:2]] = np.stack([-gain * c.slope(t), c.at(t)], axis=1)
            if blur:
                up, down = (curves[k].at(t) for curves in by_blur)
                block[:, place[2]] = gain * (up - down) / (2 * CHANGE * blur)
            blocks.append(block / m.size)
        jacobian = np.concatenate(blocks)
        rates = np.sqrt(np.mean(jacobian[:, : len(shares)] ** 2, axis=0))
        taken, self.steps = self.steps, np.clip(CHANGE / np.maximum(rates, CHANGE), LEAST, MOST)
        return self.derivatives(point) if (taken > TOO_FAR * self.steps).any() else jacobian
