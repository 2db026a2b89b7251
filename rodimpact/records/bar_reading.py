"""Check the bars and gauges of a shot, and sample the gauges of a bar together.

All gauges of a bar then have the same times.
"""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ..model import Rod, System
from ..model.arguments import check_choice, check_kind
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..units import format_si, shown
from .bar_gauge import GAUGE_EXAMPLE, BarGauge
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .pulses import Pulse, pulse_of, rest_end
from .signal import Signal

Compression: TypeAlias = Literal["negative", "positive"]
SIGN_OF_COMPRESSION = {"negative": -1.0, "positive": 1.0}
"""Factor from a record to compressive strain, by the sign of compression there."""
MIN_REST_SAMPLES = 16
"""Samples before the pulse, at least, from which baseline and noise are taken."""
SMOOTHED_SAMPLES = 5
"""Samples of the mean by which the first pulse is found.

One sample of noise is no pulse.
"""
FIRST_PULSE_RATIO = 0.4
"""Bounds the strain of the first pulse over the largest strain of the record."""


def instrumented_bars(
    input_gauges: Any, output_gauges: Any, bars: Any, compression: Any
) -> InstrumentedBars:
    """Both bars with the records of their gauges.

    The arguments are those of `reduce`, with `bars` one rod or two; InvalidModel names
    a wrong one.
    """
    check_choice("compression", compression, SIGN_OF_COMPRESSION)
    rods = rods_of(bars)
    return InstrumentedBars(
        input=_instrumented_bar(
            "input_gauges",
            input_gauges,
            rods.input,
            is_output=False,
            compression=compression,
        ),
        output=_instrumented_bar(
            "output_gauges",
            output_gauges,
            rods.output,
            is_output=True,
            compression=compression,
        ),
    )


def output_bar_of(gauges: Any, bar: Any, compression: Any) -> InstrumentedBar:
    """The output bar of a direct impact with the records of its gauges.

    InvalidModel unless `bar` is one uniform rod, and for gauges that are wrong.
    """
    check_choice("compression", compression, SIGN_OF_COMPRESSION)
    if not _is_uniform(bar):
        message = "must be the output bar alone, a uniform Rod"
        raise invalid_argument("bars", f"{message}, got {shown(bar)}")
    return _instrumented_bar(
        "output_gauges", gauges, bar, is_output=True, compression=compression
    )


class Rods(NamedTuple):
    """The input bar and the output bar."""

    input: Rod
    output: Rod


def rods_of(bars: Any) -> Rods:
    """Input and output bar; one uniform rod stands for both.

    InvalidModel unless the argument is one uniform rod or two.
    """
    rods = bars
    if not isinstance(bars, tuple | list):
        rods = (bars, bars)
    if len(rods) != 2 or not all(map(_is_uniform, rods)):
        message = "must be a uniform Rod, two uniform Rods, or a Calibration"
        raise invalid_argument("bars", f"{message}, got {shown(bars)}")
    return Rods(*rods)


def _is_uniform(rod: Any) -> bool:
    """Whether a rod is a single one, of one section and one material.

    A family of rods is not.
    """
    if not isinstance(rod, Rod) or len(rod.segments) != 1:
        return False
    is_family = bool(System([rod]).shape)
    return not rod.segments[0].tapered and not is_family


class _Record(NamedTuple):
    """One gauge, its first pulse, and its compressive strain at the bar's times."""

    gauge: BarGauge
    first_pulse: Pulse
    strain: Floats


def _instrumented_bar(
    name: str, gauges: Any, rod: Rod, is_output: bool, compression: str
) -> InstrumentedBar:
    """A bar with the records of its gauges, which are the argument `name`.

    The records are sampled at the same times, positive in compression, and begin from a
    level of 0 at rest. The gauges come in the order in which the first pulse arrives at
    them. Records of an output bar that begin too late are preceded by more rest, see
    `_from_arrival_at_face`.
    """
    checked = _checked_gauges(name, gauges, rod)
    signals = [gauge.strain for gauge in checked]
    times = _common_times(name, signals)
    records = []
    for gauge, signal in zip(checked, signals, strict=True):
        # The last time may lie beyond the end by round-off.
        strain = np.asarray(signal.at(np.minimum(times.values, times.end)))
        compressive = SIGN_OF_COMPRESSION[compression] * strain
        pulse = _first_pulse(name, times.values, compressive, compression)
        records.append(_Record(gauge, pulse, compressive))
    records.sort(key=lambda record: record.first_pulse.start)
    rest_samples = _rest_samples(name, times, records[0])
    distances = []
    strains = []
    for record in records:
        distances.append(record.gauge.distance)
        strains.append(record.strain - record.strain[:rest_samples].mean())
    bar = InstrumentedBar(
        rod=rod,
        is_output=is_output,
        gauges=tuple(record.gauge for record in records),
        first_pulses=tuple(record.first_pulse for record in records),
        distances=np.array(distances),
        strains=np.array(strains),
        times=times.values,
        dt=times.dt,
        rest_samples=rest_samples,
    )
    return _from_arrival_at_face(bar)


def _from_arrival_at_face(bar: InstrumentedBar) -> InstrumentedBar:
    """The bar with records that begin before the pulse is at the face.

    More rest is put before its records. The wave in the output bar is at the face
    before it is at a gauge. The added samples are those at rest again and again, so
    that level and noise stay the same.
    """
    if not bar.is_output:
        return bar
    longest_travel = bar.distances.max() / bar.speed
    at_face = bar.pulse_start - longest_travel
    missing_samples = math.ceil((bar.times[0] - at_face) / bar.dt)
    if missing_samples <= 0:
        return bar
    count = missing_samples + MIN_REST_SAMPLES
    earlier = bar.times[0] - bar.dt * np.arange(count, 0, -1)
    strains = []
    for strain in bar.strains:
        at_rest = strain[: bar.rest_samples]
        added = np.resize(at_rest, count)  # repeated as often as it takes
        strains.append(np.concatenate((added, strain)))
    return bar._replace(
        strains=np.array(strains),
        times=np.concatenate((earlier, bar.times)),
        rest_samples=bar.rest_samples + count,
    )


def _checked_gauges(name: str, gauges: Any, rod: Rod) -> list[BarGauge]:
    """The one gauge or two of a bar, as a list.

    InvalidModel for anything else, a gauge beyond the bar, or two at one distance.
    """
    checked: list[Any] = [gauges]
    if isinstance(gauges, tuple | list):
        checked = list(gauges)
    distances = set()
    for gauge in checked:
        check_kind(name, gauge, BarGauge, GAUGE_EXAMPLE)
        distances.add(gauge.distance)
        if gauge.distance >= float(rod.length):
            message = f"a gauge is {gauge.distance:g} m from the specimen"
            raise invalid_argument(
                name, f"{message}, but the bar is only {float(rod.length):g} m long"
            )
    is_one_or_two = 1 <= len(checked) <= 2
    if not is_one_or_two or len(distances) < len(checked):
        raise invalid_argument(name, "must be one gauge, or two at different distances")
    return checked


class _Times(NamedTuple):
    """The times at which all gauges of a bar are sampled, s."""

    values: Floats
    dt: float
    end: float  # last time that all records contain


def _common_times(name: str, strains: list[Signal]) -> _Times:
    """Times that all records of a bar contain, at the steps of the first one.

    InvalidModel, which names the argument `name`, if they contain too few in common.
    """
    dt = strains[0].dt
    start = max(strain.start for strain in strains)
    end = min(strain.end for strain in strains)
    if end - start < 2 * MIN_REST_SAMPLES * dt:
        raise invalid_argument(name, "the records of the gauges do not overlap in time")
    # Rounded down, but for a last sample that is late by no more than round-off
    steps = int((end - start) / dt * (1 + 1e-12))
    values = start + dt * np.arange(steps + 1, dtype=float)
    return _Times(values, dt, end)


def _rest_samples(name: str, times: _Times, first: _Record) -> int:
    """Number of samples at rest before the first pulse of a bar.

    InvalidModel if they are too few. `first` is the record of the gauge at which the
    pulse arrives first.
    """
    level = np.median(first.strain[:MIN_REST_SAMPLES])
    end = rest_end(times.values, first.strain - level, first.first_pulse)
    count = int(np.searchsorted(times.values, end))
    if count < MIN_REST_SAMPLES:
        duration = format_si(MIN_REST_SAMPLES * times.dt, "s", digits=3)
        message = f"the record has {count} samples at rest before the pulse rises"
        remedy = (
            f"{MIN_REST_SAMPLES} are needed, {duration}, for its level and noise; "
            "record earlier, or give cut pulses, ri.reduce(pulses=...)"
        )
        raise invalid_argument(name, f"{message}; {remedy}")
    return count


def _first_pulse(name: str, times: Floats, strain: Floats, compression: str) -> Pulse:
    """Timing of the first pulse of a record, which is cut off where this pulse is over.

    `strain` is positive in compression if `compression`, the sign in the records, is
    right. InvalidModel, which names the argument `name`, if the first pulse is a
    tension, or none can be timed.
    """
    values = strain - np.median(strain[:MIN_REST_SAMPLES])
    window = np.ones(SMOOTHED_SAMPLES) / SMOOTHED_SAMPLES
    smooth = np.convolve(values, window, "same")
    is_high = np.abs(smooth) > FIRST_PULSE_RATIO * np.abs(values).max()
    first = int(np.argmax(is_high))  # the first sample that is high
    if smooth[first] <= 0:
        (other,) = SIGN_OF_COMPRESSION.keys() - {compression}
        raise invalid_argument(
            name,
            "must begin with a compression; if the signs of all gauges differ, give "
            f'compression="{other}"; if that of this one alone does, '
            "reverse it by BarGauge(..., gain=-1)",
        )
    below = np.flatnonzero(smooth[first:] <= 0)
    stop = len(values)  # index behind the last sample of the pulse
    if below.size:
        stop = first + int(below[0]) + 1
    # How the pulse ends does not matter here: a sample of 0 ends it.
    ended = np.append(values[:stop], 0.0)
    dt = times[1] - times[0]
    try:
        return pulse_of(times[0] + dt * np.arange(stop + 1), ended)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
