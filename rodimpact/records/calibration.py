"""Calibration by a shot without a specimen: wave speeds, gains, reflection, bending, noise.

The pulse of the striker runs through both bars and back from the far end of the output bar. The
time from the first passage of the output gauge to the second gives c0 of that bar; the time from
the input gauge to the output gauge then gives c0 of the input bar. A striker of the same material
and cross-section with the speed V causes the strain V/(2 c0).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.arguments import single
from ..model.bodies import Rod
from ..model.frozen import refusal
from ..model.quantities import Floats
from ..storage.tables import align
from . import bars as measuring
from .bars import Compression, Side
from .signal import Signal

SLACK = 0.1  # of a travel time: how far the wave speed that was given may be off
FAINT = 0.15  # of a pulse: what is above it counts
PASSES = 3  # of finding a wave speed, on which the dispersion that finds it depends a little


@dataclass(frozen=True, eq=False)
class Calibration:
    """Properties of both bars from a shot without a specimen; made by `calibrate`.

    Attributes
    ----------
    bars : (Rod, Rod)
        Input and output bar with the measured wave speeds; the densities are unchanged.
    gains : (float, float)
        Factors of the strains of the input gauge and of the output gauge.
    speed_errors : (float, float)
        Standard errors of the wave speeds due to noise, m/s.
    gain_errors : (float, float)
        Standard errors of the gains.
    reflected : float
        Strain reflected at the joint divided by the incident strain. `expected` is its value from
        the impedances, (Z2 - Z1)/(Z2 + Z1).
    expected : float
    noise : (float, float)
        Standard deviation of the noise divided by the plateau of the pulse.
    bending : (float or None, float or None)
        Largest bending strain divided by the plateau; None without gauges on both sides.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, bar]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.calibrate(*gauges, bar)
    >>> (piece,) = found.bars[0].segments
    >>> round(piece.material.wave_speed, -2), round(abs(found.reflected), 2)
    (5000.0, 0.0)
    """

    bars: tuple[Rod, Rod]
    gains: tuple[float, float]
    speed_errors: tuple[float, float]
    gain_errors: tuple[float, float]
    reflected: float
    expected: float
    noise: tuple[float, float]
    bending: tuple[float | None, float | None]

    def applied(self, sides: tuple[Side, Side]) -> tuple[Side, Side]:
        """Sides of a shot with the gains applied."""
        first, second = (_scaled(side, gain) for side, gain in zip(sides, self.gains, strict=True))
        return first, second

    def off_by_one_error(self, sides: tuple[Side, Side]) -> Iterator[tuple[Side, Side]]:
        """Sides in which one gain or one wave speed is changed by its standard error."""
        for i in range(2):
            changed = [
                _scaled(sides[i], 1 + self.gain_errors[i] / self.gains[i]),
                sides[i]._replace(rod=with_speed(sides[i].rod,
                                                 sides[i].speed + self.speed_errors[i])),
            ]
            for side in changed:
                yield (side, sides[1]) if i == 0 else (sides[0], side)

    def __str__(self) -> str:
        """Table with a column for each bar, then the reflection at the joint."""
        speeds = [float(rod.segments[0].wave_speed) for rod in self.bars]
        cells: list[list[str]] = [
            ["wave speed", *(f"{c:.1f} +- {e:.1f} m/s" for c, e in
                             zip(speeds, self.speed_errors, strict=True))],
            ["gain", *(f"{g:.4f} +- {e:.4f}" for g, e in
                       zip(self.gains, self.gain_errors, strict=True))],
            ["noise/plateau", *(f"{100 * n:.2f} %" for n in self.noise)],
            ["bending/plateau", *("-" if b is None else f"{100 * b:.1f} %"
                                       for b in self.bending)],
        ]
        return align([["", "input bar", "output bar"], *cells]) + (
            f"\nreflected at the joint: {100 * self.reflected:.2f} % of the incident strain; "
            f"expected from the impedances: {100 * self.expected:.2f} %")


def calibrate(
    input_gauges: Any, output_gauges: Any, bars: Rod | tuple[Rod, Rod], *,
    striker_speed: float | None = None, compression: Compression = "negative",
) -> Calibration:
    """Wave speeds and gains from a shot with the two bars together and no specimen.

    Parameters
    ----------
    input_gauges, output_gauges : BarGauge
        As in `reduce`.
    bars : Rod or (Rod, Rod)
        Input and output bar, with their true lengths; errors of the wave speeds up to 10 % are
        corrected.
    striker_speed : float, optional
        V of a striker with the impedance of the input bar, m/s. By default the gain of the input
        gauge is 1, and the output gauge is compared with the input gauge.
    compression : str
        Sign of a strain that compresses in the records.

    Returns
    -------
    Calibration
        Pass it to `reduce` in place of the bars.

    Raises
    ------
    InvalidModel
        If an argument is invalid, or the record ends before the pulse returns from the far end of
        the output bar.

    Notes
    -----
    The incident strain is V/(2 c0). The joint transmits the fraction 2 Z2/(Z1 + Z2) of a force.

    Examples
    --------
    In a computed shot the gauges are right, so both gains are 1:

    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, bar]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.calibrate(*gauges, bar, striker_speed=10.0)
    >>> [round(gain, 2) for gain in found.gains]
    [1.0, 1.0]
    """
    first, second = measuring.sides_of(
        _one("input_gauges", input_gauges), _one("output_gauges", output_gauges), bars, compression)
    second, error2 = _timed_back(second)
    first, error1 = _timed_through(first, second, error2)
    impedances = [side.stiffness / side.speed for side in (first, second)]
    total = sum(impedances)
    plateaus = [side.front.plateau for side in (first, second)]
    passed = 2 * impedances[1] / total * first.stiffness / second.stiffness
    gain = 1.0
    if striker_speed is not None:
        gain = single("striker_speed", striker_speed, "m/s", "positive") / (
            2 * first.speed) / plateaus[0]
    gains = gain, gain * passed * plateaus[0] / plateaus[1]
    noise = [float(side.strains[0][: side.quiet].std()) / side.front.plateau
             for side in (first, second)]
    errors = [noise[k] / math.sqrt(max(1.0, side.front.width / side.dt)) * gains[k]
              for k, side in enumerate((first, second))]
    return Calibration(
        (first.rod, second.rod), gains, (error1, error2), (errors[0], errors[1]),
        _reflected(first), (impedances[1] - impedances[0]) / total, (noise[0], noise[1]),
        (_bending(input_gauges, first), _bending(output_gauges, second)))


def with_speed(rod: Rod, speed: float) -> Rod:
    """The rod with another wave speed: E = rho c^2."""
    segment = rod.segments[0]
    material = segment.material
    changed = material.replace(youngs_modulus=material.density * speed**2)
    return rod.replace(segments=[segment.replace(material=changed)])


def _one(name: str, gauge: Any) -> Any:
    """A single gauge, which a calibration wants."""
    if isinstance(gauge, tuple | list):
        raise refusal(name, f"must be one BarGauge, got {len(gauge)}; calibrate each gauge alone")
    return gauge


def _scaled(side: Side, factor: float) -> Side:
    return side._replace(strains=tuple(factor * strain for strain in side.strains))


def _timed_back(side: Side) -> tuple[Side, float]:
    """The output bar with the wave speed by which its pulse comes back, and its error, m/s."""
    path = 2 * (float(side.rod.length) - side.distances[0])
    pulse = _passing(side)
    return _timed(side, path, lambda now: -measuring.carrier(now, path)(pulse))


def _timed_through(first: Side, second: Side, error: float) -> tuple[Side, float]:
    """The input bar with the wave speed by which its pulse reaches the output gauge."""
    pulse = np.interp(second.times, first.times, _passing(first), left=0.0, right=0.0)
    rest = second.distances[0]

    def arriving(now: Side) -> Floats:
        here = now._replace(strains=second.strains, start=second.start, dt=second.dt)
        return measuring.carrier(second, rest)(measuring.carrier(here, now.distances[0])(pulse))

    found, own = _timed(first, first.distances[0], arriving, second)
    other = error / second.speed * rest / second.speed  # s, by which the second bar may be off
    return found, math.hypot(own, found.speed**2 / first.distances[0] * other)


def _timed(
    side: Side, path: float, predicted: Any, record: Side | None = None
) -> tuple[Side, float]:
    """A bar with the wave speed by which a prediction comes when the record has it.

    The standard error of the arrival is s sqrt(2)/sqrt(sum of slope^2), with s the noise.
    """
    seen = record or side
    for _ in range(PASSES):
        travel = path / side.speed
        lag = predicted(side)
        there = np.flatnonzero(np.abs(lag) > FAINT * np.abs(lag).max())
        low, high = seen.times[there[0]], seen.times[there[-1]]
        low, high = low - SLACK * travel, high + SLACK * travel
        if high > seen.times[-1]:
            message = f"the record ends at {seen.times[-1]:.4g} s, before the pulse returns"
            raise refusal("output_gauges", f"{message} from the far end; record up to {high:.4g} s")
        model = Signal(lag, seen.times)
        found = Signal(seen.strains[0], seen.times).window(low, high).misfit(
            model, shift=(-SLACK * travel, SLACK * travel))
        if found.at_limit:
            message = f"the travel time is more than {100 * SLACK:g} % off the expected one"
            raise refusal("bars", f"{message}; correct wave speed, length or distances")
        side = side._replace(rod=with_speed(side.rod, path / (travel + found.shift)))
    slopes = np.diff(lag)[there[0] : there[-1]] / seen.dt
    noise = float(seen.strains[0][: seen.quiet].std())
    late = noise * math.sqrt(2) / math.sqrt(float(slopes @ slopes))
    return side, late * side.speed**2 / path


def _passing(side: Side) -> Floats:
    """The record of a pulse that passes for the first time, zero after it."""
    past = side.front.start + side.front.width + 2 * side.front.rise
    passing: Floats = np.where(side.times < past, side.strains[0], 0.0)
    return passing


def _reflected(side: Side) -> float:
    """Strain that comes back from the joint over the incident one, by least squares."""
    sent = measuring.carrier(side, 2 * side.distances[0])(_passing(side))
    rest = side.strains[0] - _passing(side)
    where = np.abs(sent) > FAINT * np.abs(sent).max()
    return float(sent[where] @ rest[where] / (sent[where] @ sent[where]))


def _bending(gauge: Any, side: Side) -> float | None:
    """Largest bending strain while the pulse passes, over its plateau."""
    bending = gauge.bending
    if bending is None:
        return None
    start = side.front.start
    passing = bending.window(start, start + side.front.width)
    rest = bending.window(bending.start, start).values.mean()
    return float(np.abs(passing.values - rest).max() / abs(side.front.plateau))
