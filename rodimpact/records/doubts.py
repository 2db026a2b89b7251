"""Doubts about a reduction: contradictions between the records and the arguments.

Five things are checked: the specimen fits between the bars, gauges of one bar agree,
each wave arrives at the time that follows from distances and wave speeds, no alignment
ends at the limit of its search, and the forces on both faces of the specimen balance. A
doubt is a sentence with the number that was found, its limit and a remedy. Doubts do
not change the curve.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from ..model.quantities import Floats
from ..units import format_si
from .alignment import Alignment
from .bar_gauge import BarGauge
from .comparison import TimeSeries, misfit_of
from .curve import Curve
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .pulses import FOOT_TIME_RATIO, PLATEAU_RATIO, START_RATIO, Pulse, first_part
from .specimen import Specimen
from .two_bar_shot import Shifts

MIN_COMPARED_SAMPLES = 16
"""Least number of samples over which two records of a pulse are compared."""

MAX_SECTION_RATIO = 1.02
"""Largest section of a specimen divided by the section of a bar.

A bar must cover the whole face of the specimen. Rounded areas differ by some percent.
"""
MIN_OPPOSITE_RATIO = 0.6
"""Least strain of a gauge divided by that of the opposite gauge, over a whole pulse.

Bending of a tenth of the axial strain leaves 0.8; a bridge or gain that is wrong by a
factor of two leaves 0.5, a dead gauge 0.
"""
MIN_STATION_RATIO = 0.8
"""Least ratio of the smaller to the larger strain of one pulse at two gauges of a bar.

Such gauges differ by some percent, and by a tenth each if bending is not cancelled.
"""
TRAVEL_RTOL = 0.05
"""Largest error of a predicted travel time, divided by this time.

Wave speeds from tables are off by 2 or 3 %, and distances by 1 % with the length of a
gauge.
"""
SLOWEST_SPECIMEN_SPEED = 500.0
"""Lowest wave speed in a specimen, m/s; it bounds the travel time of a wave there.

A foam has some 500 m/s, and every metal is faster.
"""
MIN_REFLECTED_RATIO = 0.1
"""Least reflected strain, divided by the incident strain, of a wave that is evaluated.

A weaker wave cannot be told from the ringing that follows a pulse in a bar.
"""
ECHO_RTOL = 0.01
"""Largest relative difference between the bar speed and the measured speed of an echo.

An echo is the pulse that comes back from the far end of the output bar.
"""
ECHO_MISFIT = 0.1
"""Largest misfit of an echo to its prediction, divided by the plateau of the echo.

If the misfit is larger, the recorded wave is not the echo.
"""
ECHO_SEARCH_RTOL = 0.1
"""Largest relative error of the echo's travel time in the search for the echo."""
MIN_WORSE_IMBALANCE = 0.05
"""Imbalance over all loading below which an alignment never counts as worse."""
WORSE_IMBALANCE_RATIO = 1.5
"""Largest ratio of the imbalance with an alignment to that without it.

If the ratio is larger, the alignment counts as worse. Both imbalances are taken over
all loading.
"""
SHIFT_LIMIT_RTOL = 0.01
"""Distance of a shift from its limit, over the limit, that counts as at the limit."""
IMBALANCE_LIMIT = 0.15
"""Largest median of abs(F1 - F2) over the plateau, relative to the mean force.

The mean force is the median of (abs(F1) + abs(F2))/2, so the ratio cannot exceed about
2. Shots in equilibrium stay below a tenth.
"""
INPUT_FORCE_RTOL = 0.02
"""Largest error of F1 divided by the incident force.

F1 is the difference of two waves, whose strains are known to 1 or 2 %. With a soft
specimen, F1 is much smaller than the force of either wave.
"""


class DoubtfulReduction(UserWarning):
    """The records of a shot contradict distances, wave speeds or gains that were given.

    `Reduction.doubts` holds the same sentences.

    Examples
    --------
    The output gauge lies 0.5 m from the specimen, but 0.2 m is given:

    >>> import warnings, numpy as np, rodimpact as ri
    >>> k = np.arange(400)
    >>> shape = 1e-3 * np.clip(np.minimum(k - 100, 250 - k) / 10, 0, 1)
    >>> incident = ri.Signal(-shape, dt=1e-6)
    >>> transmitted = incident.shifted(2e-4).extended(before=2e-4)
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> gauges = ri.BarGauge(incident, 0.5), ri.BarGauge(transmitted, 0.2)
    >>> with warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=1e-4))
    >>> {each.category.__name__ for each in told}
    {'DoubtfulReduction'}
    >>> print(found.doubts[0].split(";")[0])
    the transmitted wave arrives 200 us after the incident wave
    """


def doubts_of(
    bars: InstrumentedBars,
    curve: Curve,
    shifts: Shifts,
    alignment: Alignment | None,
) -> tuple[str, ...]:
    """Sentences on all doubts about a two-bar shot, which was aligned by `shifts`, s.

    They concern the size of the specimen, gauges of a bar that contradict each other,
    times of arrival, the alignment (unless it is None), and the balance of the forces.
    The tuple is empty if there is no doubt. The bars hold the strains as recorded,
    without the gains of a calibration.
    """
    doubts: list[str] = []
    doubts += _oversized_specimen(curve.specimen, bars)
    for bar in bars:
        doubts += _unlike_opposite_gauges(bar)
        doubts += _unlike_stations(bar)
        doubts += _second_gauge_off_time(bar)
    doubts += _reflected_wave_off_time(bars.input)
    doubts += _transmitted_wave_off_time(bars, curve.specimen.length)
    doubts += _echo_off_time(bars.output)
    if alignment is not None:
        doubts += _shifts_at_limit(shifts, alignment.limit)
        doubts += _balance_made_worse(alignment)
    doubts += _forces_out_of_balance(curve, bars.input.impedance)
    return tuple(doubts)


def doubts_of_equal_forces(
    bars: InstrumentedBars, specimen: Specimen
) -> tuple[str, ...]:
    """Sentences on all doubts about a shot with one gauge a bar and equal forces.

    They concern the size of the specimen, opposite gauges, and times of arrival. The
    reflected wave overlaps the incident one, so its arrival is not checked.
    """
    doubts: list[str] = []
    doubts += _oversized_specimen(specimen, bars)
    for bar in bars:
        doubts += _unlike_opposite_gauges(bar)
    doubts += _transmitted_wave_off_time(bars, specimen.length)
    doubts += _echo_off_time(bars.output)
    return tuple(doubts)


def doubts_of_direct_impact(
    bar: InstrumentedBar, specimen: Specimen
) -> tuple[str, ...]:
    """Sentences on all doubts about a specimen and the gauges of its output bar.

    They concern the size of the specimen, gauges that contradict each other, and the
    measured speed of the echo from the far end of the bar.
    """
    doubts: list[str] = []
    doubts += _oversized_specimen(specimen, [bar])
    doubts += _unlike_opposite_gauges(bar)
    doubts += _unlike_stations(bar)
    doubts += _second_gauge_off_time(bar)
    doubts += _echo_off_time(bar)
    return tuple(doubts)


def _bar_name(bar: InstrumentedBar) -> str:
    """Name of a bar in sentences."""
    if bar.is_output:
        return "output bar"
    return "input bar"


def _percent(ratio: float) -> str:
    """A ratio in whole percents."""
    return f"{100 * ratio:.0f} %"


# Gauges of one bar that disagree


def _oversized_specimen(
    specimen: Specimen, bars: Iterable[InstrumentedBar]
) -> Iterator[str]:
    """A doubt if the specimen is longer than a bar, and one if its section is larger.

    The section may be `MAX_SECTION_RATIO` times that of a bar. The usual cause of such
    a large specimen is a length in millimetres that is given as metres.
    """
    shortest = math.inf
    smallest_section = math.inf
    for bar in bars:
        segment = bar.rod.segments[0]  # bars are uniform: they have one segment
        shortest = min(shortest, float(bar.rod.length))
        section = float(np.asarray(segment.area))
        smallest_section = min(smallest_section, section)
    remedy = "numbers without a unit are in metres, and 5 mm are 0.005"
    if specimen.length > shortest:
        yield (
            f"the specimen is {format_si(specimen.length, 'm', 3)} long, longer than "
            f"a bar of {format_si(shortest, 'm', 3)}; {remedy}"
        )
    if specimen.section > MAX_SECTION_RATIO * smallest_section:
        # Diameters of circles with the areas of specimen and bar
        diameter = math.sqrt(4 * specimen.section / math.pi)
        bar_diameter = math.sqrt(4 * smallest_section / math.pi)
        yield (
            f"the specimen is {format_si(diameter, 'm', 3)} thick (as a circle of "
            f"its area), thicker than a bar of {format_si(bar_diameter, 'm', 3)}; "
            f"{remedy}"
        )


def _unlike_opposite_gauges(bar: InstrumentedBar) -> Iterator[str]:
    """A doubt for each pair of opposite gauges of which one records too little strain.

    The scalar product of each record with the mean of both, over the first pulse,
    measures its strain. A gauge records too little if its product is less than
    `MIN_OPPOSITE_RATIO` of that of the other gauge. A gauge without an opposite one is
    skipped.
    """
    for gauge, pulse in zip(bar.gauges, bar.first_pulses, strict=True):
        if gauge.opposite is None:
            continue
        pair = _in_first_pulse(gauge, pulse)
        # The bending strains of the two sides cancel in the mean.
        mean = (pair.signal + pair.opposite) / 2
        signal_share = float(pair.signal @ mean)
        opposite_share = float(pair.opposite @ mean)
        # `weaker` and `stronger` are names of arguments of BarGauge, for the message.
        if signal_share > opposite_share:
            weaker = "opposite"
            stronger = "signal"
            ratio = opposite_share / signal_share
        else:
            weaker = "signal"
            stronger = "opposite"
            ratio = signal_share / opposite_share
        if ratio < MIN_OPPOSITE_RATIO:
            yield (
                f"of the gauges on opposite sides of the {_bar_name(bar)}, "
                f"{format_si(gauge.distance, 'm', 3)} from the specimen, `{weaker}` "
                f"records {_percent(ratio)} of the strain of `{stronger}`; at least "
                f"{_percent(MIN_OPPOSITE_RATIO)} is expected; check its bridge and "
                f"gain, or give the record of `{stronger}` alone, "
                f"ri.BarGauge({stronger}, distance)"
            )


class _OppositeStrains(NamedTuple):
    """Records on both sides of a bar, without their levels at rest."""

    signal: Floats
    opposite: Floats


def _in_first_pulse(gauge: BarGauge, pulse: Pulse) -> _OppositeStrains:
    """Both records of a gauge during its first pulse, minus their levels at rest.

    The gauge must have an opposite record. The samples are those from `pulse.start` to
    one width of the pulse later, in the unit of the records. The level at rest is the
    mean of the record before the pulse.
    """
    assert gauge.opposite is not None
    times = gauge.signal.times
    # `pulse.start` is at a tenth of the plateau; the pulse begins up to one rise time
    # earlier.
    is_rest = times < pulse.start - pulse.rise
    is_pulse = (times >= pulse.start) & (times <= pulse.start + pulse.width)
    signal = gauge.signal.values - gauge.signal.values[is_rest].mean()
    opposite = gauge.opposite.values - gauge.opposite.values[is_rest].mean()
    return _OppositeStrains(signal[is_pulse], opposite[is_pulse])


def _unlike_stations(bar: InstrumentedBar) -> Iterator[str]:
    """A doubt if two gauges of a bar record different strains of the first pulse.

    The record of the first gauge, propagated to the second gauge, predicts the record
    there until another wave arrives. The ratio of record to prediction must lie between
    `MIN_STATION_RATIO` and its inverse. There is no doubt for a bar with one gauge, or
    if fewer than `MIN_COMPARED_SAMPLES` can be compared.
    """
    if len(bar.distances) < 2:
        return
    # Distances from the specimen, m; the pulse arrives at the first gauge first.
    first_distance = bar.distances[0]
    second_distance = bar.distances[1]
    apart = abs(first_distance - second_distance)
    propagated = bar.propagated(bar.strains[0], apart)
    arrival = bar.pulse_start + apart / bar.speed
    until = arrival + _time_alone_at_second_gauge(bar)
    is_alone = (bar.times >= arrival) & (bar.times < until)
    if is_alone.sum() < MIN_COMPARED_SAMPLES:
        return
    recorded = bar.strains[1][is_alone]
    expected = propagated[is_alone]
    # Factor from the expected strain to the recorded one, by least squares
    ratio = float(recorded @ expected) / float(expected @ expected)
    most = 1 / MIN_STATION_RATIO
    if not MIN_STATION_RATIO <= ratio <= most:
        yield (
            f"of the two gauges of the {_bar_name(bar)}, the one "
            f"{format_si(second_distance, 'm', 3)} from the specimen records "
            f"{_percent(ratio)} of the pulse that passes the one at "
            f"{format_si(first_distance, 'm', 3)}; at least "
            f"{_percent(MIN_STATION_RATIO)} and at most {_percent(most)} is expected; "
            "check bridges and gains of both"
        )


def _time_alone_at_second_gauge(bar: InstrumentedBar) -> float:
    """Time from the arrival of the first pulse at the second gauge to its return, s.

    In the input bar the pulse returns from the specimen, in the output bar from the far
    end. The bar must have two gauges.
    """
    distance = float(bar.distances[1])  # from the specimen
    to_reflection = distance
    if bar.is_output:
        to_reflection = float(bar.rod.length) - distance
    return 2 * to_reflection / bar.speed  # there and back


# Waves that arrive too early or too late


class _Onset(NamedTuple):
    """Bounds of the time at which a pulse began, s."""

    earliest: float
    latest: float  # the pulse then has a tenth of its plateau


def _onset(times: Floats, strain: Floats, pulse: Pulse) -> _Onset:
    """Bounds of the time at which a pulse began, s.

    The latest time is `pulse.start`, where the pulse has a tenth of its plateau. The
    rise to a tenth takes at most `FOOT_TIME_RATIO` times as long as the rise from a
    tenth to a fifth, which gives the earliest time.
    """
    fifth = 2 * START_RATIO * abs(pulse.plateau)  # twice a tenth
    is_above = (times > pulse.start) & (np.abs(strain) >= fifth)
    first_above = int(np.argmax(is_above))  # index of the first such sample
    until_fifth = float(times[first_above]) - pulse.start
    earliest = pulse.start - FOOT_TIME_RATIO * until_fifth
    return _Onset(earliest, latest=pulse.start)


def _first_onset(bar: InstrumentedBar, gauge: int = 0) -> _Onset:
    """Bounds of the time at which the first pulse began at a gauge of a bar, s.

    `gauge` is the index of the gauge, 0 or 1.
    """
    return _onset(bar.times, bar.strains[gauge], bar.first_pulses[gauge])


class _Delay(NamedTuple):
    """Time between the onsets of two pulses, s."""

    least: float
    most: float
    at_tenth: float  # between the times at which both reach a tenth of their plateaus

    def contradicts(self, travel: float, later: float = 0.0) -> bool:
        """Whether the delay is too long or too short for a predicted travel time, s.

        The travel time may have the relative error `TRAVEL_RTOL`, and may in addition
        be longer by up to `later`, s.
        """
        slack = TRAVEL_RTOL * travel
        # `least` and `most` are the bounds of the observed delay.
        is_late = travel + slack + later < self.least
        is_early = self.most < travel - slack
        return is_late or is_early


def _delay(before: _Onset, after: _Onset) -> _Delay:
    """Time from the onset of one pulse to the onset of a later one, s.

    Each pulse may have begun at any time from `earliest` to `latest`, so the result has
    bounds, `least` and `most`. At `latest` a pulse has a tenth of its plateau: if both
    pulses have the same shape, the delay is `at_tenth`.
    """
    return _Delay(
        least=after.earliest - before.latest,
        most=after.latest - before.earliest,
        at_tenth=after.latest - before.latest,
    )


def _second_gauge_off_time(bar: InstrumentedBar) -> Iterator[str]:
    """A doubt if the first pulse passes from gauge to gauge in an unexpected time.

    The expected time is the distance of the gauges divided by the bar speed. There is
    no doubt for a bar with one gauge.
    """
    if len(bar.distances) < 2:
        return
    apart = abs(float(bar.distances[1] - bar.distances[0]))
    travel = apart / bar.speed
    delay = _delay(_first_onset(bar, 0), _first_onset(bar, 1))
    if delay.contradicts(travel):
        fitting = delay.at_tenth * bar.speed  # distance that fits the delay, m
        yield (
            f"the pulse takes {format_si(delay.at_tenth, 's', 3)} from the first gauge "
            f"of the {_bar_name(bar)} to the second; their distance, "
            f"{format_si(apart, 'm', 3)}, and the bar speed, {bar.speed:.0f} m/s, say "
            f"{format_si(travel, 's', 3)}; check both distances (the delay fits "
            f"{format_si(fitting, 'm', 3)} between the gauges) and the bar speed"
        )


def _reflected_wave_off_time(bar: InstrumentedBar) -> Iterator[str]:
    """A doubt if the reflected wave does not arrive at the expected time.

    The wave runs from the only gauge of the input bar to the specimen and back at the
    bar speed. There is no doubt for two gauges, or if no reflected wave is found.
    """
    if len(bar.distances) > 1:
        return
    reflected = _reflected_onset(bar)
    if reflected is None:
        return
    distance = float(bar.distances[0])
    travel = 2 * distance / bar.speed
    delay = _delay(_first_onset(bar), reflected)
    if delay.contradicts(travel):
        # Distance of the gauge that fits the delay, m; the wave runs it twice.
        fitting = delay.at_tenth * bar.speed / 2
        yield (
            f"the reflected wave arrives {format_si(delay.at_tenth, 's', 3)} after the "
            "incident wave; the distance of the input gauge, "
            f"{format_si(distance, 'm', 3)}, and the bar speed, {bar.speed:.0f} m/s, "
            f"say {format_si(travel, 's', 3)}; check the distance (the delay fits "
            f"{format_si(fitting, 'm', 3)}) and the bar speed, which "
            "ri.calibrate measures"
        )


def _reflected_onset(bar: InstrumentedBar) -> _Onset | None:
    """Onset of the first wave that passes the input gauge after the incident wave.

    The search ends when the reflected wave can be back from the struck end of the bar.
    None if no wave reaches `MIN_REFLECTED_RATIO` of the incident strain, or if the
    record cuts the wave off.
    """
    incident = bar.first_pulse
    passed = incident.start + incident.width + incident.rise  # end of the wave, s
    # A wave that returns to the gauge after both reflections, at the specimen and at
    # the struck end, has travelled twice the length of the bar, wherever the gauge is.
    returned = bar.pulse_start + 2 * float(bar.rod.length) / bar.speed
    between = (bar.times > passed) & (bar.times < returned)
    strain = bar.strains[0][between]
    times = bar.times[between]
    is_faint = np.abs(strain) < MIN_REFLECTED_RATIO * abs(incident.plateau)
    # The samples before the first faint one are the end of the incident wave.
    is_after_incident = np.logical_or.accumulate(is_faint)
    # Also false if there is no faint sample
    stands_out = not is_faint[is_after_incident].all()
    if not stands_out:
        return None
    strain = strain[is_after_incident]
    times = times[is_after_incident]
    try:
        pulse = first_part(times, strain)
    except ValueError:
        return None
    return _onset(times, strain, pulse)


def _transmitted_wave_off_time(bars: InstrumentedBars, length: float) -> Iterator[str]:
    """A doubt if the transmitted wave does not arrive at the expected time.

    The expected time follows from distances of gauges and bar speeds. The specimen, of
    this `length`, m, may delay the wave by up to length/`SLOWEST_SPECIMEN_SPEED`.
    """
    input_distance = float(bars.input.distances[0])
    output_distance = float(bars.output.distances[0])
    input_speed = bars.input.speed
    output_speed = bars.output.speed
    travel = input_distance / input_speed + output_distance / output_speed
    delay = _delay(_first_onset(bars.input), _first_onset(bars.output))
    # The specimen can only delay the wave, at most by the travel time in it.
    longest_in_specimen = length / SLOWEST_SPECIMEN_SPEED
    if delay.contradicts(travel, later=longest_in_specimen):
        yield (
            "the transmitted wave arrives "
            f"{format_si(delay.at_tenth, 's', 3)} after the "
            "incident wave; the distances of the gauges from the specimen, "
            f"{format_si(input_distance, 'm', 3)} and "
            f"{format_si(output_distance, 'm', 3)}, and the bar "
            f"speeds, {input_speed:.0f} m/s and {output_speed:.0f} m/s, say "
            f"{format_si(travel, 's', 3)}; check the distances, that "
            "both records have one zero of time, and the bar speeds, which "
            "ri.calibrate measures"
        )


def _echo_off_time(bar: InstrumentedBar) -> Iterator[str]:
    """A doubt if the echo in the output bar contradicts the bar speed.

    The echo is the first pulse after its reflection at the far end; it measures the bar
    speed. This speed may differ from that of E and density by `ECHO_RTOL`. There is no
    doubt without an echo (record too short, a trap or a damper at the far end).
    """
    speed = _speed_of_echo(bar)
    if speed is None or abs(speed / bar.speed - 1) <= ECHO_RTOL:
        return
    density = float(bar.rod.segments[0].material.density)
    modulus = format_si(density * speed**2, "Pa", digits=4)  # E = rho c^2
    # The stress is proportional to E.
    stress_error = _percent(abs((bar.speed / speed) ** 2 - 1))
    yield (
        "the transmitted wave comes back from the far end of the output bar at "
        f"{speed:.0f} m/s; Young's modulus and density of the bar say {bar.speed:.0f} "
        f"m/s, so the stress may be wrong by {stress_error}; give "
        f"youngs_modulus={modulus}, which is density times the "
        "square of the measured speed, or correct the length of the bar"
    )


def _speed_of_echo(bar: InstrumentedBar) -> float | None:
    """Bar speed of an output bar, m/s, measured by the echo of its first pulse.

    The echo is predicted: the first pulse, propagated to the far end and back to the
    first gauge with its sign reversed. The best shift of this prediction against the
    record gives the speed. None without a clear echo: if the record is too short, if
    the pulse is not over when its echo arrives, or if the record does not fit.
    """
    # The distance of a gauge is measured from the specimen, m.
    to_far_end = float(bar.rod.length) - float(bar.distances[0])
    path = 2 * to_far_end
    travel = path / bar.speed  # s
    slack = ECHO_SEARCH_RTOL * travel  # largest shift, s
    pulse = bar.first_pulse
    # The width is measured at half height; the pulse may be longer by one rise time at
    # either end.
    pulse_end = pulse.start + pulse.width + 2 * pulse.rise
    # The echo is expected between these times.
    echo_start = pulse.start + travel - slack
    echo_end = pulse_end + travel + slack
    is_separate = pulse_end <= echo_start
    is_recorded = echo_end <= bar.times[-1]
    if not is_separate or not is_recorded:
        return None
    passing = np.where(bar.times < pulse_end, bar.strains[0], 0.0)
    # The free end reverses the sign of the strain.
    predicted = TimeSeries(bar.times, -bar.propagated(passing, path))
    is_echo = (bar.times >= echo_start) & (bar.times <= echo_end)
    recorded = TimeSeries(bar.times[is_echo], bar.strains[0][is_echo])
    # The far end may return only a part of the pulse, so the scale is free.
    misfit = misfit_of(
        recorded, predicted, shift_range=(-slack, slack), scale_range=None
    )
    if misfit.rms > ECHO_MISFIT or misfit.scale <= 0 or misfit.at_limit:
        return None
    return path / (travel + misfit.shift)


# Alignment and forces


def _shifts_at_limit(shifts: Shifts, limit: float) -> Iterator[str]:
    """A doubt for each wave whose shift, s, of either sign, is at the limit, s."""
    for wave, shift in shifts._asdict().items():
        if abs(shift) >= (1 - SHIFT_LIMIT_RTOL) * limit:
            yield (
                f"the alignment moves the {wave} wave by {format_si(shift, 's', 3)}, "
                "the limit of its search, and would move it further; give a larger "
                f"align_within than {format_si(limit, 's', 3)}, or correct distances "
                "and bar speeds"
            )


def _balance_made_worse(alignment: Alignment) -> Iterator[str]:
    """A doubt if the alignment makes the balance over all loading much worse.

    The imbalance then exceeds both `MIN_WORSE_IMBALANCE` and `WORSE_IMBALANCE_RATIO`
    times the imbalance without alignment.
    """
    before = alignment.imbalance_before
    after = alignment.imbalance_after
    if after > MIN_WORSE_IMBALANCE and after > WORSE_IMBALANCE_RATIO * before:
        yield (
            "the alignment, which balances the start of loading, makes the balance "
            f"over all loading worse: |F1 - F2| is {_percent(after)} of the mean "
            f"force, {_percent(before)} without it; leave align_within out, or correct "
            "distances and bar speeds"
        )


def _forces_out_of_balance(curve: Curve, impedance: float) -> Iterator[str]:
    """A doubt if the forces on both faces differ on the plateau of the output force.

    The median of abs(F1 - F2) over the plateau is compared with a limit: the sum of
    `IMBALANCE_LIMIT` times the mean force and `INPUT_FORCE_RTOL` times the largest
    incident force. `impedance` is Z of the input bar, kg/s.
    """
    output_size = np.abs(curve.output_force)
    is_plateau = output_size >= PLATEAU_RATIO * output_size.max()
    input_force = curve.input_force[is_plateau]
    output_force = curve.output_force[is_plateau]
    mean_size = float(np.median(np.abs(input_force) + np.abs(output_force))) / 2
    difference = float(np.median(np.abs(input_force - output_force)))
    # The incident strain i and the reflected strain r make the force F1 = Z c (i + r)
    # and the velocity v1 = c (i - r): the incident force is Z c i = (F1 + Z v1)/2.
    incident_force = (curve.input_force + impedance * curve.input_velocity) / 2
    input_error = INPUT_FORCE_RTOL * np.abs(incident_force).max()
    limit = IMBALANCE_LIMIT * mean_size + input_error
    if difference > limit:
        yield (
            f"the forces on the two faces differ by {_percent(difference / mean_size)} "
            f"of their mean size on the plateau; at most {_percent(limit / mean_size)} "
            "is expected; check distances and gains (ri.calibrate finds gains from a "
            "shot with the bars together); if they are right, the specimen was not in "
            "equilibrium: use a shorter specimen or a slower rise of the pulse"
        )
