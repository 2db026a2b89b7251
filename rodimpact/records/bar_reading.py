"""Check the bars and gauges of a shot, and sample the gauges of a bar together.

All gauges of a bar then have the same times.
"""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ..model import RigidMass, Rod, System
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
"""Factor from recorded to compressive strain, by the sign of compression in records."""
MIN_REST_SAMPLES = 16
"""Least number of samples before the pulse; they give level at rest and noise."""
SMOOTHED_SAMPLES = 5
"""Number of samples of the moving mean with which the first pulse is searched.

The mean suppresses single samples of noise.
"""
FIRST_PULSE_RATIO = 0.4
"""The first pulse begins above this part of the largest strain of the record."""


def instrumented_bars(
    input_gauges: Any, output_gauges: Any, bars: Any, compression: Any
) -> InstrumentedBars:
    """Both bars with the records of their gauges, see `_instrumented_bar`.

    The arguments are those of `reduce`, but `bars` must be one rod or two rods. Invalid
    arguments raise InvalidModel, which names the argument.
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

    The arguments are those of `reduce`, where `bar` is called `bars`: it must be one
    uniform rod. Invalid arguments raise InvalidModel, which names the argument.
    """
    check_choice("compression", compression, SIGN_OF_COMPRESSION)
    if not is_uniform_rod(bar):
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
    """Input and output bar from one uniform rod, used for both, or from two of them.

    Two rods are a tuple or a list. InvalidModel for anything else.
    """
    rods = bars
    if not isinstance(bars, tuple | list):
        rods = (bars, bars)
    if len(rods) != 2 or not all(map(is_uniform_rod, rods)):
        message = "must be a uniform Rod, two uniform Rods, or a Calibration"
        raise invalid_argument("bars", f"{message}, got {shown(bars)}")
    return Rods(*rods)


def is_uniform_rod(rod: Any) -> bool:
    """Whether the argument is a single rod of constant section and one material.

    The result is false for a family of rods, and for any other object.
    """
    if not isinstance(rod, Rod) or len(rod.segments) != 1:
        return False
    return not rod.tapered and not is_family(rod)


def is_family(body: Rod | RigidMass) -> bool:
    """Whether any parameter of a body is an array, with one value for each member."""
    return bool(System([body]).shape)  # the shape of a single system is ()


class _Record(NamedTuple):
    """One gauge, its first pulse, and its compressive strain at the bar's times."""

    gauge: BarGauge
    first_pulse: Pulse
    strain: Floats


def _instrumented_bar(
    name: str, gauges: Any, rod: Rod, is_output: bool, compression: str
) -> InstrumentedBar:
    """A bar with the records of its gauges.

    The records are sampled at common times, made positive in compression, and their
    level at rest is subtracted. The gauges are put in the order in which the first
    pulse arrives at them. Records of an output bar that begin too late are padded, see
    `_padded_to_face_arrival`. InvalidModel, which names the argument `name`, for wrong
    gauges, too little rest, or a first pulse in tension.
    """
    checked = _checked_gauges(name, gauges, rod)
    signals = [gauge.strain for gauge in checked]
    times = _common_times(name, signals)
    records = []
    for gauge, signal in zip(checked, signals, strict=True):
        # The last common time may lie beyond the end of the records by round-off.
        within_record = np.minimum(times.values, times.end)
        strain = np.asarray(signal.at(within_record))
        compressive = SIGN_OF_COMPRESSION[compression] * strain
        # `compression` is passed for the message about a pulse of the wrong sign.
        pulse = _first_pulse(name, times.values, compressive, compression)
        records.append(_Record(gauge, pulse, compressive))
    records.sort(key=lambda record: record.first_pulse.start)
    rest_samples = _rest_samples(name, times, records[0])
    distances = []
    strains = []
    for record in records:
        level = record.strain[:rest_samples].mean()
        distances.append(record.gauge.distance)
        strains.append(record.strain - level)
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
    return _padded_to_face_arrival(bar)


def _padded_to_face_arrival(bar: InstrumentedBar) -> InstrumentedBar:
    """The bar with records that begin before the pulse arrives at the specimen face.

    In an output bar the pulse is at the face before it reaches a gauge. If the records
    begin after its arrival at the face, the missing samples and `MIN_REST_SAMPLES` more
    are added at the front. They repeat the samples at rest, so that level and noise
    stay the same; `times` and `rest_samples` include them. An input bar, and a bar
    whose records begin early enough, are returned unchanged.
    """
    if not bar.is_output:
        return bar
    longest_travel = bar.distances.max() / bar.speed
    # Earliest possible arrival of the wave at the face, s
    at_face = bar.pulse_start - longest_travel
    missing_samples = math.ceil((bar.times[0] - at_face) / bar.dt)
    if missing_samples <= 0:
        return bar
    count = missing_samples + MIN_REST_SAMPLES  # with some rest before the arrival
    earlier = bar.times[0] - bar.dt * np.arange(count, 0, -1)  # in increasing order
    strains = []
    for strain in bar.strains:
        at_rest = strain[: bar.rest_samples]
        added = np.resize(at_rest, count)  # repeated as often as necessary
        strains.append(np.concatenate((added, strain)))
    return bar._replace(
        strains=np.array(strains),
        times=np.concatenate((earlier, bar.times)),
        rest_samples=bar.rest_samples + count,
    )


def _checked_gauges(name: str, gauges: Any, rod: Rod) -> list[BarGauge]:
    """The gauges of a bar, one or two, as a list in the given order.

    InvalidModel, which names the argument `name`, for any other argument, for a gauge
    at the far end of the bar or beyond it, and for two gauges at the same distance.
    """
    listed: list[Any] = [gauges]
    if isinstance(gauges, tuple | list):
        listed = list(gauges)
    length = float(rod.length)
    distances = set()  # equal distances count once
    for gauge in listed:
        check_kind(name, gauge, BarGauge, GAUGE_EXAMPLE)
        distances.add(gauge.distance)
        if gauge.distance >= length:
            message = f"a gauge is {gauge.distance:g} m from the specimen"
            raise invalid_argument(
                name, f"{message}, but the bar is only {length:g} m long"
            )
    is_one_or_two = 1 <= len(listed) <= 2
    some_are_at_one_place = len(distances) < len(listed)
    if not is_one_or_two or some_are_at_one_place:
        raise invalid_argument(name, "must be one gauge, or two at different distances")
    return listed


class _Times(NamedTuple):
    """The times at which all gauges of a bar are sampled, s."""

    values: Floats
    dt: float
    end: float  # last time that all records contain


def _common_times(name: str, strains: list[Signal]) -> _Times:
    """Times that all records of a bar contain, at the steps of the first record.

    The last of the times may lie beyond the common `end` by round-off. InvalidModel,
    which names the argument `name`, if the records have fewer than
    2 `MIN_REST_SAMPLES` steps in common.
    """
    dt = strains[0].dt
    start = max(strain.start for strain in strains)
    end = min(strain.end for strain in strains)
    if end - start < 2 * MIN_REST_SAMPLES * dt:
        raise invalid_argument(name, "the records of the gauges do not overlap in time")
    # `int` rounds down; the last factor keeps the last step in spite of round-off.
    steps = int((end - start) / dt * (1 + 1e-12))
    values = start + dt * np.arange(steps + 1, dtype=float)
    return _Times(values, dt, end)


def _rest_samples(name: str, times: _Times, first: _Record) -> int:
    """Number of samples at rest before the first pulse of a bar.

    `first` is the record of the gauge at which the pulse arrives first. InvalidModel,
    which names the argument `name`, for fewer than `MIN_REST_SAMPLES`.
    """
    # The number of samples at rest is not known yet: the first ones give the level.
    level = np.median(first.strain[:MIN_REST_SAMPLES])
    end = rest_end(times.values, first.strain - level, first.first_pulse)  # s
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
    """Timing of the first pulse of a record; later waves are ignored.

    The median at rest is subtracted first. The pulse is where the moving mean of
    `SMOOTHED_SAMPLES` first exceeds `FIRST_PULSE_RATIO` of the largest strain; it ends
    where this mean is back at 0, and `pulse_of` gives its timing. InvalidModel, which
    names the argument `name`, if the first pulse is negative (a tension) or cannot be
    timed, if the record is 0 everywhere, or if single samples are far above all others.
    `compression` is the sign in the records, for messages.
    """
    values = strain - np.median(strain[:MIN_REST_SAMPLES])
    window = np.ones(SMOOTHED_SAMPLES) / SMOOTHED_SAMPLES
    smooth = np.convolve(values, window, "same")
    largest = np.abs(values).max()
    is_high = np.abs(smooth) > FIRST_PULSE_RATIO * largest
    # A single sample far above all others is spread by the mean: no sample is high.
    if largest > 0 and not is_high.any():
        wrong = int(np.abs(values).argmax())
        time = format_si(times[wrong], "s")
        raise invalid_argument(
            name,
            f"has single samples far above all others, at {time} a strain of "
            f"{strain[wrong]:.3g}; remove wrong samples from the record",
        )
    first = int(np.argmax(is_high))  # index of the first high sample
    is_tension = smooth[first] <= 0  # also if the record is 0 everywhere
    if is_tension:
        other = "negative"
        if compression == "negative":
            other = "positive"
        raise invalid_argument(
            name,
            "must begin with a compression; if the signs of all gauges differ, give "
            f'compression="{other}"; if that of this one alone does, '
            "reverse it by BarGauge(..., gain=-1)",
        )
    below = np.flatnonzero(smooth[first:] <= 0)  # counted from `first`
    stop = len(values)  # index after the last sample of the pulse
    if below.size:
        stop = first + int(below[0]) + 1
    # A sample of 0 is added, so that `pulse_of` also accepts a pulse that is cut off.
    ended = np.append(values[:stop], 0.0)
    dt = times[1] - times[0]
    ended_times = times[0] + dt * np.arange(stop + 1)
    try:
        return pulse_of(ended_times, ended)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
