"""How far predictions are from records, and how that changes with what is fitted.

A point holds the share of the way between its bounds for each parameter, then the shift of each
record, s, then their scales. Only other shares need another solution: shifts and scales follow.
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
from ..records.comparison import misfit_of
from ..records.signal import Signal
from ..results.solution import Solution
from .measured import Measured
from .parameters import Parameter, changed

CHANGE = 1e-3  # of the plateau, by which signals are to change for a quotient of differences
FIRST, LEAST, MOST = 1e-4, 1e-6, 1e-2  # steps between the bounds for that
TOO_FAR = 4.0  # times the right step, beyond which the quotient is taken anew


class Curve(NamedTuple):
    """A computed signal as a smooth function of time; beyond its ends it keeps its value."""

    spline: Any
    ends: tuple[float, float]

    @classmethod
    def through(cls, signal: Signal) -> Curve:
        """The curve through all samples."""
        from scipy.interpolate import CubicSpline

        return cls(CubicSpline(signal.times, signal.values), (signal.start, signal.end))

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
    """Strains at the gauges; InvalidModel if the run does not come to its end."""
    solution = Solution(options.run(options.method, system))
    if solution.stopped_by != "until":
        raise InvalidModel([("until", f"is not reached: {solution.status}")])
    try:
        return [solution.gauge(*gauge).signal(interval) for gauge in gauges]
    except ValueError as error:
        message = f"the gauge leaves its rod between the bounds: {error}"
        raise InvalidModel([("vary", message)]) from None


class Objective:
    """Differences of predictions and records over the levels of these, and their derivatives."""

    def __init__(
        self, system: System, measured: Sequence[Measured], parameters: Sequence[Parameter],
        options: Options, interval: float, executor: Executor | None,
    ) -> None:
        self.system, self.measured, self.parameters = system, measured, parameters
        self.run: Callable[[System], list[Signal]] = partial(
            computed, options=options, gauges=[m.gauge for m in measured], interval=interval
        )
        self.map: Any = executor.map if executor else map
        self.solved = 0  # collisions
        self.heard: Callable[[int], None] = lambda _: None  # of each of them
        self.steps = np.full(len(parameters), FIRST)
        self.known: tuple[bytes, list[Curve]] = b"", []
        beside = [(what, m) for what in ("shift", "scale") for m in measured]
        which = [f".{k}" for k in range(len(measured))] if len(measured) > 1 else [""]
        assert options.until is not None
        limits = [(0.0, 1.0)] * len(parameters)
        limits += [m.shifts(options.until, system) for m in measured]
        limits += [m.limits[1] or (-math.inf, math.inf) for m in measured]
        self.low, self.high = np.array(limits).T
        self.free = self.low < self.high
        names = [p.path for p in parameters] + [
            what + k for what in ("shift", "scale") for k in which
        ]
        units = [p.unit for p in parameters] + [
            "s" if what == "shift" else m.signal.unit for what, m in beside
        ]
        self.names, self.units = ([x for x, free in zip(xs, self.free, strict=True) if free]
                                  for xs in (names, units))

    def numbers(self, point: Floats) -> Floats:
        """A point in SI units: numbers of the system in place of shares."""
        shares, *others = self._parts(point)
        values = [p.value(s) for p, s in zip(self.parameters, shares.tolist(), strict=True)]
        return np.concatenate((values, *others))

    def slopes(self, point: Floats) -> Floats:
        """Derivatives of `numbers` with respect to each number of the point."""
        shares, *others = self._parts(point)
        slopes = [p.slope(s) for p, s in zip(self.parameters, shares.tolist(), strict=True)]
        return np.concatenate((slopes, *map(np.ones_like, others)))

    def system_at(self, point: Floats) -> System:
        """The system with other numbers; of the point its shares are enough."""
        values = self.numbers(point).tolist()[: len(self.parameters)]
        return changed(self.system, self.parameters, values)

    def curves(self, points: Iterable[Floats]) -> list[list[Curve]]:
        """Predictions for the shares of several points, of each record before shift and scale."""
        systems = [self.system_at(shares) for shares in points]
        found = []
        for system, strains in zip(systems, self.map(self.run, systems), strict=True):
            found.append([Curve.through(m.carried(strain, system))
                          for m, strain in zip(self.measured, strains, strict=True)])
            self.solved += 1
            self.heard(self.solved)
        return found

    def started(self, shares: Floats, curves: Sequence[Curve]) -> tuple[float, Floats]:
        """Sum of squares, and the point, where shifts and scales suit these shares best."""
        total, shifts, scales = 0.0, [], []
        first = len(self.parameters)
        bounds = zip(self.low[first:], self.high[first:], strict=True)
        for m, c, (low, high) in zip(self.measured, curves, bounds, strict=False):
            t, values = m.signal.times, m.signal.values
            pair = (t, values), (c.spline.x, c.at(c.spline.x))
            _, shift, scale, _ = misfit_of(*pair, (low, high), m.limits[1])
            total += float(np.sum(((scale * c.at(t - shift) - values) / m.size) ** 2))
            shifts.append(shift)
            scales.append(scale)
        return total, np.concatenate((shares, shifts, scales))

    def residuals(self, point: Floats) -> Floats:
        """All records, one after another."""
        shares, shifts, scales = self._parts(point)
        if self.known[0] != shares.tobytes():
            self.known = shares.tobytes(), self.curves([shares])[0]
        return np.concatenate([
            (scale * c.at(m.signal.times - shift) - m.signal.values) / m.size
            for m, c, shift, scale in zip(self.measured, self.known[1], shifts, scales, strict=True)
        ])

    def derivatives(self, point: Floats) -> Floats:
        """Of the residuals with respect to every number of the point, shape (sample, number).

        With respect to shares they are central differences, over steps at which the signals change
        by about `CHANGE`.
        """
        shares, shifts, scales = self._parts(point)
        self.residuals(point)
        steps = np.diag(self.steps)
        beside = [np.clip(shares + sign * step, 0, 1) for step in steps for sign in (1, -1)]
        curves = self.curves(beside)
        blocks = []
        for k, (m, shift, scale) in enumerate(zip(self.measured, shifts, scales, strict=True)):
            t, base = m.signal.times - shift, self.known[1][k]
            block = np.zeros((len(t), len(point)))
            for j in range(len(shares)):
                up, down = curves[2 * j][k], curves[2 * j + 1][k]
                apart = beside[2 * j][j] - beside[2 * j + 1][j]
                block[:, j] = scale * (up.at(t) - down.at(t)) / apart
            block[:, len(shares) + k] = -scale * base.slope(t)
            block[:, len(shares) + len(shifts) + k] = base.at(t)
            blocks.append(block / m.size)
        jacobian = np.concatenate(blocks)
        rates = np.sqrt(np.mean(jacobian[:, : len(shares)] ** 2, axis=0))
        taken, self.steps = self.steps, np.clip(CHANGE / np.maximum(rates, CHANGE), LEAST, MOST)
        return self.derivatives(point) if (taken > TOO_FAR * self.steps).any() else jacobian

    def _parts(self, point: Floats) -> tuple[Floats, Floats, Floats]:
        n, m = len(self.parameters), len(self.measured)
        return point[:n], point[n : n + m], point[n + m :]
