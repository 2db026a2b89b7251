"""The two waves of a bar at its specimen face, from the strains at its gauges.

A gauge at the distance d from the face records e(t) = i(t + d/c) + r(t - d/c). The wave i runs
towards the face, the wave r away from it; i and r are the strains at the face. Each frequency f
runs at its own phase velocity c(f). Strains are positive in compression here. One gauge separates
the two waves only if they pass it one after the other. Two gauges at the distance D separate them
from rest on: `Side.separated` solves for both waves by least squares; the waves are zero before
the pulse arrives. Two gauges do not determine the frequencies f = n c/(2 D); these are damped.
"""

import math
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from .. import waves
from ..model import Rod, System
from ..model.arguments import of_kind, one_of
from ..model.frozen import FrozenDataclass, Problems, invalid_argument, quantity
from ..model.quantities import Floats
from ..units import shown
from . import filters
from .comparison import Pulse, pulse_of
from .signal import Signal

Compression: TypeAlias = Literal["negative", "positive"]
SIGNS = {"negative": -1.0, "positive": 1.0}
"""Of a record, by the sign that a compression has in it: compressive strains are positive here."""
EXAMPLE = "ri.BarGauge(bridge.strain(volts), distance=0.5)"
QUIET = 16  # samples before the pulse, the fewest that tell baseline and noise
ITERATIONS = 60  # of the least squares of two gauges; more would fit the noise
DAMPING = 1e-3  # of a wave that the gauges do not see


class BarGauge(FrozenDataclass):
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
    distance: float = quantity("m", "non-negative", scalar=True)
    opposite: Signal | None = None
    gain: float = quantity("", default=1.0, scalar=True)

    def _check(self, problems: Problems) -> None:
        for name in (
            ("signal", "opposite") if self.opposite is not None else ("signal",)
        ):
            of_kind(name, getattr(self, name), Signal, "bridge.strain(volts)")
        if self.signal.unit and np.array_equal(self.gain, 1):
            problems.append(
                (
                    "signal",
                    f"must be strain, got {self.signal.unit}; give "
                    "bridge.strain(volts), or a gain",
                )
            )
        if not problems:
            _ = self.strain  # for which the opposite gauge has the same times and unit

    @property
    def strain(self) -> Signal:
        """Mean strain of the cross-section, with the sign of the signal."""
        signal = (
            self.signal if self.opposite is None else (self.signal + self.opposite) / 2
        )
        return (signal * self.gain).replace(unit="")

    @property
    def bending(self) -> Signal | None:
        """Bending strain: half the difference of both sides; None if only one side has a gauge."""
        if self.opposite is None:
            return None
        return ((self.signal - self.opposite) / 2 * self.gain).replace(unit="")


class Side(NamedTuple):
    """One bar with its gauges: compressive strains at equal time steps, all at the same times.

    `strains` has the shape (gauge, sample). `quiet` is the number of samples before the pulse.
    `fronts` are the first pulses at the gauges, in the order of their arrival. They run towards the
    specimen in the input bar, away from it in the output bar; there the side is `leaving`.
    """

    rod: Rod
    leaving: bool
    distances: Floats
    strains: Floats
    times: Floats
    dt: float
    quiet: int
    gauges: tuple[BarGauge, ...]
    fronts: tuple[Pulse, ...]

    @property
    def front(self) -> Pulse:
        """The first pulse at the first gauge."""
        return self.fronts[0]

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
    def mode(self) -> waves.Bar | None:
        """The exact first mode, if the bar is round and has a Poisson ratio."""
        segment = self.rod.segments[0]
        exact = segment.solid_round and segment.material.poisson_ratio is not None
        return waves.Bar.of(self.rod) if exact else None

    @property
    def cut_off(self) -> float:
        """Cut-off frequency of the first mode, Hz; infinite without dispersion."""
        return self.mode.cut_off if self.mode else math.inf

    @property
    def foot(self) -> float:
        """Begin of the pulse at the first gauge, s: one rise time before a tenth of the plateau."""
        return self.front.start - self.front.rise

    @property
    def known_until(self) -> Floats:
        """For each gauge the time of the last wave at the face that its record tells, s.

        Before the end of a record, a jump rings for as long as the cut-off makes it.
        """
        travels, ringing = self.distances / self.speed, max(self.dt, 2 / self.cut_off)
        return self.times[-1] - travels - ringing  # type: ignore[no-any-return]

    def transfer(self, count: int, distances: Any) -> tuple[int, Any]:
        """Length of transforms of `count` samples, and what distances, m, make of frequencies.

        In a round bar with a Poisson ratio each frequency runs at its own phase velocity, and
        frequencies above the cut-off of the first mode are removed.
        """
        from scipy import fft

        lasting = math.ceil(
            3 * np.abs(distances).max() / self.speed / self.dt
        )  # of slow waves
        size = fft.next_fast_len(2 * count + lasting, real=True)
        f = fft.rfftfreq(size, self.dt)
        transfer = np.exp(-2j * np.pi * f * distances / self.speed)
        if mode := self.mode:
            transfer *= filters.first_mode(f, distances, mode)
        return size, transfer

    def carried(self, strain: Floats, distance: float) -> Floats:
        """The strain, at rest before, after a distance, m, along the bar."""
        from scipy import fft

        size, transfer = self.transfer(len(strain), distance)
        later: Floats = fft.irfft(fft.rfft(strain, size) * transfer, size)[
            : len(strain)
        ]
        return later

    def at_face(self) -> tuple[Floats, Floats]:
        """Waves at the face, towards the specimen and away from it, at the times of the records."""
        if len(self.distances) == 2:
            return self.separated()
        strain, distance = self.strains[0], self.distances[0]
        if self.leaving:
            return np.zeros(len(strain)), self.carried(strain, -distance)
        split = int((self.foot + 2 * distance / self.speed - self.times[0]) / self.dt)
        passing = np.where(np.arange(len(strain)) < split, strain, 0.0)
        # carried back, the incident wave lies before all that is asked of the reflected one
        return self.carried(passing, distance), self.carried(strain, -distance)

    def separated(self) -> tuple[Floats, Floats]:
        """The two waves at the face from the records of two gauges, by damped least squares."""
        from scipy import fft
        from scipy.sparse.linalg import LinearOperator, lsqr

        count = len(self.times)
        gauge_and_wave = self.distances[:, None, None] * [[-1.0], [1.0]]
        size, transfer = self.transfer(count, gauge_and_wave)
        travel = self.distances[0] / self.speed
        arrival = self.foot + (-travel if self.leaving else travel)
        moving = np.arange(count) >= int((arrival - self.times[0]) / self.dt)
        told = self.times < self.known_until[:, None]

        def seen(pair: Floats) -> Any:
            spectra = fft.rfft(moving * pair.reshape(2, count), size)
            both = fft.irfft((transfer * spectra).sum(axis=1), size)
            return (told * both[:, :count]).ravel()

        def adjoint(records: Floats) -> Any:  # of carrying forth is carrying back
            spectra = fft.rfft(told * records.reshape(2, count), size)
            pair = fft.irfft((transfer.conj() * spectra[:, None]).sum(axis=0), size)
            return (moving * pair[:, :count]).ravel()

        gauges: Any = LinearOperator((2 * count, 2 * count), seen, adjoint, dtype=float)
        found = lsqr(
            gauges,
            (told * self.strains).ravel(),
            damp=DAMPING,
            iter_lim=ITERATIONS,
            atol=1e-10,
            btol=1e-10,
        )[0]
        towards, away = found.reshape(2, count)
        return towards, away

    def clean_until(self) -> float:
        """Time at the face up to which the records separate the two waves, s.

        At this time the record ends or, with one gauge, the wave from the far end of the bar is
        back at the gauge. ValueError if the incident and the reflected wave overlap at a single
        gauge.
        """
        end = float(self.known_until.min())
        if len(self.distances) == 2:
            return end
        travel = float(self.distances[0]) / self.speed
        around = 2 * float(self.rod.length) / self.speed
        if self.leaving:
            return min(end, self.foot - travel + around - 2 * travel)
        passed = self.front.start + self.front.width + self.front.rise / 2
        if passed > self.foot + 2 * travel:
            raise ValueError(
                "the reflected wave reaches the gauge before the incident wave has passed; "
                "give a second gauge on this bar, or use a shorter striker"
            )
        return min(end, self.foot + travel + around - 2 * travel)


def sides_of(
    input_gauges: Any, output_gauges: Any, bars: Any, compression: Any
) -> tuple[Side, Side]:
    """Both bars with the records of their gauges."""
    one_of("compression", compression, SIGNS)
    pair = bars if isinstance(bars, tuple | list) else (bars, bars)
    if len(pair) != 2 or not all(map(_is_uniform, pair)):
        message = "must be a uniform Rod, two uniform Rods, or a Calibration"
        raise invalid_argument("bars", f"{message}, got {shown(bars)}")
    # the first pulses run towards the specimen in the input bar, and leave it in the output bar
    return (
        _side_of("input_gauges", input_gauges, pair[0], False, compression),
        _side_of("output_gauges", output_gauges, pair[1], True, compression),
    )


def _is_uniform(rod: Any) -> bool:
    """Whether it is a single rod of one section and one material."""
    if not isinstance(rod, Rod) or len(rod.segments) != 1:
        return False
    return not rod.segments[0].tapered and not System([rod]).shape


def _side_of(name: str, given: Any, rod: Rod, leaving: bool, compression: str) -> Side:
    """Read the gauges of a bar."""
    gauges = list(given) if isinstance(given, tuple | list) else [given]
    for gauge in gauges:
        of_kind(name, gauge, BarGauge, EXAMPLE)
        if gauge.distance >= float(rod.length):
            message = f"a gauge is {gauge.distance:g} m from the specimen"
            raise invalid_argument(
                name, f"{message}, but the bar is only {float(rod.length):g} m long"
            )
    if not 1 <= len(gauges) <= 2 or len({gauge.distance for gauge in gauges}) < len(
        gauges
    ):
        raise invalid_argument(name, "must be one gauge, or two at different distances")
    strains = [gauge.strain for gauge in gauges]
    dt = strains[0].dt
    start, end = max(s.start for s in strains), min(s.end for s in strains)
    if end - start < 2 * QUIET * dt:
        raise invalid_argument(name, "the records of the gauges do not overlap in time")
    times = start + dt * np.arange(int((end - start) / dt * (1 + 1e-12)) + 1)
    read = []
    for gauge, strain in zip(gauges, strains, strict=True):
        values = SIGNS[compression] * np.asarray(strain.at(np.minimum(times, end)))
        front = _front_of(name, times, values, compression)
        read.append(_Station(gauge, front, values))
    read.sort(key=lambda station: station.front.start)
    front = read[0].front
    quiet = int((front.start - 1.5 * front.rise - start) / dt)
    if quiet < QUIET:
        message = f"the record begins {front.start - start:.3g} s before the pulse"
        raise invalid_argument(
            name, f"{message}; {QUIET} samples before it are needed for the baseline"
        )
    return Side(
        rod,
        leaving,
        np.array([station.gauge.distance for station in read]),
        np.array([each.strain - each.strain[:quiet].mean() for each in read]),
        times,
        dt,
        quiet,
        tuple(station.gauge for station in read),
        tuple(station.front for station in read),
    )


class _Station(NamedTuple):
    """One gauge, its first pulse, and its compressive strain at the times of its side."""

    gauge: BarGauge
    front: Pulse
    strain: Floats


def _front_of(name: str, times: Floats, strain: Floats, compression: str) -> Pulse:
    """Timing of the first pulse of a record, which is cut off where this pulse is over.

    `strain` is positive in compression if `compression`, the sign in the records, is right.
    """
    values = strain - np.median(strain[:QUIET])
    # one sample of noise is no pulse
    smooth = np.convolve(values, np.ones(5) / 5, "same")
    first = int(np.argmax(np.abs(smooth) > 0.4 * np.abs(values).max()))
    if smooth[first] <= 0:
        (other,) = SIGNS.keys() - {compression}
        raise invalid_argument(
            name,
            "must begin with a compression; give "
            f'compression="{other}" if the signs differ',
        )
    below = np.flatnonzero(smooth[first:] <= 0)
    past = first + int(below[0]) + 1 if below.size else len(values)
    ended = np.append(values[:past], 0.0)  # how the pulse ends does not matter here
    try:
        return pulse_of(times[0] + (times[1] - times[0]) * np.arange(past + 1), ended)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
