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
    """Both bars with the records of their gauges, see `_instrumented_bar`.

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

    The arguments are those of `reduce`. InvalidModel names a wrong one: `bar`, called
    "bars" there, must be one uniform rod.
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
    """Input and output bar from one uniform rod, which stands for both, or from two.

    InvalidModel for anything else.
    """
    rods = bars
    if not isinstance(bars, tuple | list):
        rods = (bars, bars)
    if len(rods) != 2 or not all(map(is_uniform_rod, rods)):
        message = "must be a uniform Rod, two uniform Rods, or a Calibration"
        raise invalid_argument("bars", f"{message}, got {shown(bars)}")
    return Rods(*rods)


def is_uniform_rod(rod: Any) -> bool:
    """Whether the argument is a single rod of one section and one material.

    A family of rods is not, nor is anything else than a rod.
    """
    if not isinstance(rod, Rod) or len(rod.segments) != 1:
        return False
    return not rod.tapered and not is_family(rod)


def is_family(body: Rod | RigidMass) -> bool:
    """Whether any number of a body is an array, one value for each member."""
    return bool(System([body]).shape)  # the shape of a single system is ()


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
    `_padded_to_face_arrival`. InvalidModel for wrong gauges, too little rest, or a
    first pulse in tension.
    """
    checked = _checked_gauges(name, gauges, rod)
    signals = [gauge.strain for gauge in checked]
    times = _common_times(name, signals)
    records = []
    for gauge, signal in zip(checked, signals, strict=True):
        # The last time may lie beyond the end by round-off.
        within_record = np.minimum(times.values, times.end)
        strain = np.asarray(signal.at(within_record))
        compressive = SIGN_OF_COMPRESSION[compression] * strain
        # The error for a wrong sign tells the argument `compression`.
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
    """The output bar with records that begin before the pulse arrives at its face.

    The wave in an output bar is at the face before it is at a gauge. Records that begin
    after its arrival at the face are padded at the front, by `MIN_REST_SAMPLES` more
    samples than are missing. The padding repeats the samples at rest, so that level and
    noise stay the same; `times` and `rest_samples` include it. An input bar, and a bar
    whose records begin early enough, are returned as they are.
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
    """The one gauge or two of a bar, as a list in the given order.

    InvalidModel, which names the argument `name`, for anything else, a gauge at the far
    end of the bar or beyond it, or two at one distance.
    """
    listed: list[Any] = [gauges]
    if isinstance(gauges, tuple | list):
        listed = list(gauges)
    length = float(rod.length)
    distances = set()
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
    """Times that all records of a bar contain, at the steps of the first one.

    The last of them may lie beyond the common `end` by round-off. InvalidModel, which
    names the argument `name`, if fewer than twice `MIN_REST_SAMPLES` steps are common.
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

    `first` is the record of the gauge at which the pulse arrives first. InvalidModel,
    which names the argument `name`, for fewer than `MIN_REST_SAMPLES`.
    """
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
    """Timing of the first pulse of a record, without what the record has after it.

    The record, less its median at rest, is cut where the first pulse ends; `pulse_of`
    times what is left. The pulse is found by the mean of `SMOOTHED_SAMPLES`: it is
    where this first exceeds `FIRST_PULSE_RATIO` of the largest strain, and ends where
    this is back at rest.
    `strain` is positive in compression if `compression`, the sign in the records, is
    right. InvalidModel, which names the argument `name`, if the first pulse is a
    tension, or none can be timed, or single samples stand far above all others.
    """
    values = strain - np.median(strain[:MIN_REST_SAMPLES])
    window = np.ones(SMOOTHED_SAMPLES) / SMOOTHED_SAMPLES
    smooth = np.convolve(values, window, "same")
    largest = np.abs(values).max()
    is_high = np.abs(smooth) > FIRST_PULSE_RATIO * largest
    if largest > 0 and not is_high.any():
        wrong = int(np.abs(values).argmax())
        time = format_si(times[wrong], "s")
        raise invalid_argument(
            name,
            f"has single samples far above all others, at {time} a strain of "
            f"{strain[wrong]:.3g}; remove wrong samples from the record",
        )
    first = int(np.argmax(is_high))  # the first sample that is high
    is_tension = smooth[first] <= 0
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
    below = np.flatnonzero(smooth[first:] <= 0)
    stop = len(values)  # index behind the last sample of the pulse
    if below.size:
        stop = first + int(below[0]) + 1
    # How the pulse ends does not matter here: one more sample, of 0, ends it.
    ended = np.append(values[:stop], 0.0)
    dt = times[1] - times[0]
    ended_times = times[0] + dt * np.arange(stop + 1)
    try:
        return pulse_of(ended_times, ended)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
