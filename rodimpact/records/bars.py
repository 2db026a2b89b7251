"""The two waves of a bar at its specimen face, from the strains at its gauges.

A gauge at the distance d from the face records e(t) = i(t + d/c) + r(t - d/c). The wave i runs
towards the face, the wave r away from it; i and r are the strains at the face. Each frequency f
runs at its own phase velocity c(f). Strains are positive in compression here. One gauge separates
the two waves only if they pass it one after the other. Two gauges at the distance D separate them
from rest on: `separated` solves for both waves by least squares; the waves are zero before the
pulse arrives. Two gauges do not determine the frequencies f = n c/(2 D); these are damped.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from .. import waves
from ..model.arguments import of_kind
from ..model.bodies import Rod
from ..model.frozen import Declared, Problems, quantity, refusal
from ..model.quantities import Floats
from ..units import shown
from . import filters
from .comparison import Pulse, pulse_of
from .signal import Signal

Compression: TypeAlias = Literal["negative", "positive"]
EXAMPLE = "ri.BarGauge(bridge.strain(volts), distance=0.5)"
QUIET = 16  # samples before the pulse, the fewest that tell baseline and noise
ITERATIONS = 60  # of the least squares of two gauges; more would fit the noise
DAMPING = 1e-3  # of a wave that the gauges do not see


class BarGauge(Declared):
    """A strain gauge on a bar, what it recorded, and how far it is from the specimen.

    Parameters
    ----------
    signal : Signal
        Record of strain, or of volts if a `gain` is given. The time steps are equal, and the bar is
        at rest before the pulse.
    distance : float
        From the gauge to the face of the bar at the specimen, m.
    opposite : Signal, optional
        Record of the gauge on the opposite side of the bar, at the same times. Bending drops out of
        the mean of both records.
    gain : float
        Strain for each unit of the signal.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Examples
    --------
    >>> BarGauge(Signal([0.0, -1e-3, 0.0], dt=1e-6), distance=0.5).distance
    0.5
    """

    signal: Signal
    distance: float = quantity("m", "non-negative", single=True)
    opposite: Signal | None = None
    gain: float = quantity("", default=1.0, single=True)

    def _check(self, problems: Problems) -> None:
        given: dict[str, Any] = {"signal": self.signal}
        if self.opposite is not None:
            given["opposite"] = self.opposite
        for name, signal in given.items():
            if not isinstance(signal, Signal):
                problems.append((name, f"must be a Signal, got {shown(signal)}"))
            elif signal.unit and type(self.gain) is float and self.gain == 1:
                message = f"must be strain, got {signal.unit}; give bridge.strain(volts), or a gain"
                problems.append((name, message))
            else:
                try:
                    _ = signal.dt
                except ValueError as error:
                    problems.append((name, str(error)))
        if type(self.gain) is float and self.gain == 0:
            problems.append(("gain", "must not be 0"))
        if not problems and len({(s.unit, s.times.tobytes()) for s in given.values()}) > 1:
            message = "must have the same unit and times as signal"
            problems.append(("opposite", f"{message}; give opposite.resampled(times=signal.times)"))

    @property
    def strain(self) -> Signal:
        """Mean strain of the cross-section, with the sign of the signal."""
        signal = self.signal if self.opposite is None else (self.signal + self.opposite) / 2
        return signal.replace(values=self.gain * signal.values, unit="")

    @property
    def bending(self) -> Signal | None:
        """Bending strain: half the difference of both sides; None if only one side has a gauge."""
        if self.opposite is None:
            return None
        half = (self.signal - self.opposite) / 2
        return half.replace(values=self.gain * half.values, unit="")


class Side(NamedTuple):
    """One bar with its gauges: compressive strains at equal time steps, all from the same instant.

    `quiet` is the number of samples before the pulse. `front` is the first pulse at the first
    gauge: it runs towards the specimen in the input bar, away from it in the output bar.
    """

    rod: Rod
    distances: tuple[float, ...]
    strains: tuple[Floats, ...]
    start: float
    dt: float
    quiet: int
    front: Pulse

    @property
    def speed(self) -> float:
        """Bar speed c0, m/s."""
        return float(self.rod.segments[0].wave_speed)

    @property
    def stiffness(self) -> float:
        """Young's modulus times cross-sectional area, E A, N."""
        segment = self.rod.segments[0]
        return float(segment.material.youngs_modulus) * float(np.asarray(segment.area))

    @property
    def disperses(self) -> bool:
        """Whether the exact first mode is used: the bar is round and has a Poisson ratio."""
        segment = self.rod.segments[0]
        return segment.solid_round and segment.material.poisson_ratio is not None

    @property
    def cut_off(self) -> float:
        """Cut-off frequency of the first mode, Hz; infinite without dispersion."""
        return waves.Bar.of(self.rod).cut_off if self.disperses else math.inf

    @property
    def settling(self) -> float:
        """Duration of the ringing about a jump that the cut-off causes, s."""
        return max(self.dt, 2 / self.cut_off)

    @property
    def foot(self) -> float:
        """Begin of the pulse at the first gauge, s: one rise time before a tenth of the plateau."""
        return self.front.start - self.front.rise

    @property
    def times(self) -> Floats:
        """Times of the samples, s."""
        times: Floats = self.start + self.dt * np.arange(len(self.strains[0]), dtype=float)
        return times


def sides_of(
    input_gauges: Any, output_gauges: Any, bars: Any, compression: Any
) -> tuple[Side, Side]:
    """Both bars with the records of their gauges."""
    if not isinstance(compression, str) or compression not in ("negative", "positive"):
        message = f'must be "negative" or "positive", got {shown(compression)}'
        raise refusal("compression", message)
    pair = bars if isinstance(bars, tuple | list) else (bars, bars)
    if len(pair) != 2 or not all(map(_is_bar, pair)):
        message = "must be a uniform Rod, two uniform Rods, or a Calibration"
        raise refusal("bars", f"{message}, got {shown(bars)}")
    sign = 1.0 if compression == "positive" else -1.0
    return (_side_of("input_gauges", input_gauges, pair[0], sign),
            _side_of("output_gauges", output_gauges, pair[1], sign))


def _is_bar(rod: Any) -> bool:
    return isinstance(rod, Rod) and len(rod.segments) == 1 and not rod.segments[0].tapered


def _side_of(name: str, given: Any, rod: Rod, sign: float) -> Side:
    """Read the gauges of a bar; `sign` makes compression positive."""
    gauges = list(given) if isinstance(given, tuple | list) else [given]
    for gauge in gauges:
        of_kind(name, gauge, BarGauge, EXAMPLE)
    if not 1 <= len(gauges) <= 2:
        raise refusal(name, f"must be one gauge or two, got {len(gauges)}")
    if len(gauges) == 2 and gauges[0].distance == gauges[1].distance:
        raise refusal(name, f"both distances are {gauges[0].distance:g} m; give different ones")
    for gauge in gauges:
        if gauge.distance >= float(rod.length):
            message = f"a gauge is {gauge.distance:g} m from the specimen"
            raise refusal(name, f"{message}, but the bar is only {float(rod.length):g} m long")
    strains = [gauge.strain for gauge in gauges]
    dt = strains[0].dt
    start, end = max(s.start for s in strains), min(s.end for s in strains)
    if end - start < 2 * QUIET * dt:
        raise refusal(name, "the records of the gauges do not overlap in time")
    times = start + dt * np.arange(int((end - start) / dt * (1 + 1e-12)) + 1)
    values = [sign * np.asarray(strain.at(np.minimum(times, end))) for strain in strains]
    fronts = [_front_of(name, times, each, sign) for each in values]
    order = sorted(range(len(gauges)), key=lambda i: fronts[i].start)
    front = fronts[order[0]]
    quiet = int((front.start - 1.5 * front.rise - start) / dt)
    if quiet < QUIET:
        message = f"the record begins {front.start - start:.3g} s before the pulse"
        raise refusal(name, f"{message}; {QUIET} samples before it are needed for the baseline")
    return Side(
        rod, tuple(gauges[i].distance for i in order),
        tuple(values[i] - values[i][:quiet].mean() for i in order), start, dt, quiet, front)


def _front_of(name: str, times: Floats, strain: Floats, sign: float) -> Pulse:
    """The first compressive pulse of a record; the rest of it is cut off where it is over."""
    values = strain - np.median(strain[:QUIET])
    largest = np.abs(values).max()
    smooth = np.convolve(values, np.ones(5) / 5, "same")  # one sample of noise is no pulse
    first = int(np.argmax(np.abs(smooth) > 0.4 * largest))
    if largest == 0 or smooth[first] < 0:
        way = "negative" if sign > 0 else "positive"
        message = "must begin with a compression, but the strain is constant" if largest == 0 else (
            f'must begin with a compression; give compression="{way}" if the signs differ')
        raise refusal(name, message)
    below = np.flatnonzero(smooth[first:] <= 0)
    past = first + int(below[0]) + 1 if below.size else len(values)
    ended = np.append(values[:past], 0.0)  # how the pulse ends does not matter here
    try:
        return pulse_of(times[0] + (times[1] - times[0]) * np.arange(past + 1), ended)
    except ValueError as error:
        raise refusal(name, str(error)) from None


def carrier(side: Side, distance: float) -> Callable[[Floats], Floats]:
    """Function that returns the strain, at rest before, after a distance, m, along the bar.

    In a round bar with a Poisson ratio each frequency runs at its own phase velocity, and
    frequencies above the cut-off of the first mode are removed.
    """
    from scipy import fft

    count = len(side.strains[0])
    lasting = math.ceil(3 * abs(distance) / side.speed / side.dt)  # of the slowest waves
    size = fft.next_fast_len(2 * count + lasting, real=True)
    f = fft.rfftfreq(size, side.dt)
    transfer = np.exp(-2j * np.pi * f * distance / side.speed)
    if side.disperses:
        transfer = transfer * filters.first_mode(f, distance, waves.Bar.of(side.rod))

    def carried(strain: Floats) -> Floats:
        later: Floats = fft.irfft(fft.rfft(strain, size) * transfer, size)[:count]
        return later

    return carried


def at_face(side: Side, leaving: bool) -> tuple[Floats, Floats]:
    """Waves at the face, towards the specimen and away from it, at the times of the records.

    If `leaving`, the pulse of this side comes from the specimen; otherwise from the striker.
    """
    if len(side.strains) == 2:
        return separated(side, leaving)
    (strain,), (distance,) = side.strains, side.distances
    if leaving:
        return np.zeros(len(strain)), carrier(side, -distance)(strain)
    split = int((side.foot + 2 * distance / side.speed - side.start) / side.dt)
    passing = np.where(np.arange(len(strain)) < split, strain, 0.0)
    # carried back, the incident wave lies before all that is asked of the reflected one
    return carrier(side, distance)(passing), carrier(side, -distance)(strain)


def separated(side: Side, leaving: bool) -> tuple[Floats, Floats]:
    """The two waves at the face from the records of two gauges, by damped least squares."""
    from scipy.sparse.linalg import LinearOperator, lsqr

    count = len(side.strains[0])
    coming = [carrier(side, -d) for d in side.distances]
    going = [carrier(side, d) for d in side.distances]
    travel = side.distances[0] / side.speed
    rest = max(0, int((side.foot - side.start + (-travel if leaving else travel)) / side.dt))
    moving = np.arange(count) >= rest
    # what a gauge records last reaches the face only after the end
    last = [side.times[-1] - d / side.speed - side.settling for d in side.distances]
    told = np.concatenate([side.times < end for end in last])

    def seen(pair: Floats) -> Floats:
        towards, away = np.where(moving, pair.reshape(2, count), 0.0)
        both = [c(towards) + g(away) for c, g in zip(coming, going, strict=True)]
        return np.where(told, np.concatenate(both), 0.0)

    def adjoint(records: Floats) -> Floats:  # of carrying forth is carrying back
        each = np.where(told, records, 0.0).reshape(2, count)
        towards = sum(g(record) for g, record in zip(going, each, strict=True))
        away = sum(c(record) for c, record in zip(coming, each, strict=True))
        return np.concatenate([np.where(moving, wave, 0.0) for wave in (towards, away)])

    gauges: Any = LinearOperator((2 * count, 2 * count), seen, adjoint, dtype=float)
    records = np.where(told, np.concatenate(side.strains), 0.0)
    found = lsqr(gauges, records, damp=DAMPING, iter_lim=ITERATIONS,
                 atol=1e-10, btol=1e-10)[0]
    towards, away = found.reshape(2, count)
    return towards, away


def clean_until(side: Side, leaving: bool) -> float:
    """Time at the face up to which the records separate the two waves, s.

    At this time the record ends or, with one gauge, the wave from the far end of the bar is back at
    the gauge. ValueError if the incident and the reflected wave overlap at a single gauge.
    """
    longest = max(side.distances) / side.speed
    end = float(side.times[-1]) - longest - side.settling
    if len(side.distances) == 2:
        return end
    travel = side.distances[0] / side.speed
    around = 2 * float(side.rod.length) / side.speed
    arrival = side.foot + (-travel if leaving else travel)
    if not leaving:
        passed = side.front.start + side.front.width + side.front.rise / 2
        if passed > side.foot + 2 * travel:
            raise ValueError(
                "the reflected wave reaches the gauge before the incident wave has passed; "
                "give a second gauge on this bar, or use a shorter striker"
            )
    return min(end, arrival + around - 2 * travel)
