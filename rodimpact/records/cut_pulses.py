"""Incident, reflected and transmitted pulse, each cut out of its record.

The pulses of the input gauge are set into one record, at the times at which the gauge
saw them. Between them, where nothing was given, the strain is zero. From there on they
are reduced as a record of one gauge is.
"""

import math
from typing import NamedTuple

import numpy as np

from ..model.arguments import check_choice, check_kind
from ..model.bodies import Rod
from ..model.frozen import FrozenDataclass, Problems, invalid_argument
from ..model.quantities import Floats
from .bar_gauge import GAUGE_EXAMPLE, BarGauge
from .bar_reading import Rods
from .pulses import first_part, onset_of, rest_end
from .signal import Signal

CLOCKS = ("common", "own")
"""The times of all pulses count from one instant, or those of each from its own."""
MIN_LEVEL_SAMPLES = 4
"""Least number of samples at rest for the level of a cut pulse.

With fewer samples the level is 0.
"""
ADDED_REST_SAMPLES = 64
"""Samples at rest that are put before the incident and the transmitted pulse."""
MAX_END_RATIO = 0.2
"""Largest last strain of an incident pulse that is over, over its largest strain."""


class CutPulses(FrozenDataclass):
    """Incident, reflected and transmitted pulse, cut out of the records of two gauges.

    Parameters
    ----------
    incident, reflected, transmitted : BarGauge
        Each pulse with the distance of its gauge from the specimen. Incident and
        reflected pulse are of one gauge. If a pulse begins with 4 samples at rest or
        more, their mean is its zero.
    clock : str
        ``"common"``: the times are those of the records, and distances and wave speeds
        align the pulses. ``"own"``: each pulse has a time of its own; they are aligned
        so that they begin together at the specimen.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> shape = np.clip(np.minimum(np.arange(80) - 5, 75 - np.arange(80)) / 10, 0, 1)
    >>> pulse = ri.Signal(-1e-3 * shape, dt=1e-6)
    >>> gauges = [ri.BarGauge(factor * pulse, 0.5) for factor in (1.0, -0.4, 0.6)]
    >>> pulses = ri.CutPulses(*gauges, clock="own")
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> specimen = ri.Specimen(5e-3, area=1e-4)
    >>> found = ri.reduce(pulses=pulses, bars=bar, specimen=specimen)
    >>> round(found.stress.max() / 1e6)
    120
    """

    incident: BarGauge
    reflected: BarGauge
    transmitted: BarGauge
    clock: str = "common"

    def _check(self, problems: Problems) -> None:
        """Add a problem if incident and reflected pulse have different distances.

        InvalidModel at once for a pulse that is no gauge, or an unknown clock.
        """
        for name in ("incident", "reflected", "transmitted"):
            check_kind(name, getattr(self, name), BarGauge, GAUGE_EXAMPLE)
        check_choice("clock", self.clock, CLOCKS)
        if self.incident.distance != self.reflected.distance:
            message = "must be that of the incident pulse, which the same gauge records"
            problems.append(("reflected", f"its distance {message}"))


class _Pulse(NamedTuple):
    """A pulse from its level at rest, and its first sample above the rest."""

    signal: Signal
    rest_strain: Floats  # samples before the pulse, without their level
    onset: float  # s

    @property
    def level_error(self) -> float:
        """Standard error of the level of n samples at rest, std/sqrt(n); 0 without."""
        count = len(self.rest_strain)
        if not count:
            return 0.0
        return float(self.rest_strain.std()) / math.sqrt(count)


class GaugePair(NamedTuple):
    """Gauges of the input and the output bar, with the pulses in one record each."""

    input: BarGauge
    output: BarGauge
    velocity_error: float  # standard error of v1 - v2 by the levels at rest, m/s


def gauges_of(pulses: CutPulses, rods: Rods) -> GaugePair:
    """One gauge for each bar, with the bar's pulses in one record.

    Each record begins with added rest. Pulses with clocks of their own are moved to
    when they must come after the incident one. The result has an error of v1 - v2 by
    the levels at rest, too. InvalidModel if the incident pulse is cut off, or the
    reflected one begins before it.
    """
    incident = _pulse_from_rest("incident", pulses.incident)
    reflected = _pulse_from_rest("reflected", pulses.reflected)
    transmitted = _pulse_from_rest("transmitted", pulses.transmitted)
    _check_end(incident)
    input_speed = _speed_of(rods.input)
    output_speed = _speed_of(rods.output)
    input_travel = pulses.incident.distance / input_speed  # to the specimen, s
    output_travel = pulses.transmitted.distance / output_speed
    reflected_signal = reflected.signal
    transmitted_signal = transmitted.signal
    if pulses.clock == "own":
        # Both pulses leave the specimen when the incident pulse has come there, and run
        # to their gauges.
        reflected_delay = incident.onset + 2 * input_travel - reflected.onset
        reflected_signal = reflected_signal.shifted(reflected_delay)
        transmitted_delay = (
            incident.onset + input_travel + output_travel - transmitted.onset
        )
        transmitted_signal = transmitted_signal.shifted(transmitted_delay)
    if reflected_signal.start < incident.signal.start:
        raise invalid_argument(
            "pulses",
            "the reflected pulse begins before the incident one; "
            'give clock="own" if each pulse has a time of its own',
        )
    input_record = _joined(incident.signal, reflected_signal)
    # With the pulses i, r and t, v1 - v2 is c1 (i - r) - c2 t. Each pulse has a level
    # of its own, so the three errors are independent.
    velocity_error = math.hypot(
        input_speed * incident.level_error,
        input_speed * reflected.level_error,
        output_speed * transmitted.level_error,
    )
    input_signal = _with_rest(input_record, incident.rest_strain)
    output_signal = _with_rest(transmitted_signal, transmitted.rest_strain)
    return GaugePair(
        input=BarGauge(input_signal, pulses.incident.distance),
        output=BarGauge(output_signal, pulses.transmitted.distance),
        velocity_error=velocity_error,
    )


def _speed_of(rod: Rod) -> float:
    """Bar speed, m/s."""
    return float(rod.segments[0].wave_speed)


def _pulse_from_rest(name: str, gauge: BarGauge) -> _Pulse:
    """The strain of a pulse, less its level at rest, and its onset.

    With fewer than `MIN_LEVEL_SAMPLES` samples at rest the level is 0, and the result
    has no samples at rest. InvalidModel, which names the argument `name`, if the pulse
    cannot be timed.
    """
    strain = gauge.strain
    try:
        # One sample of 0 after the last, at `end`, ends a pulse that was cut off there.
        times = np.append(strain.times, strain.end + strain.dt)
        values = np.append(strain.values, 0.0)
        pulse = first_part(times, values)
    except ValueError as error:
        raise invalid_argument(name, str(error)) from None
    is_rest = strain.times < rest_end(strain.times, strain.values, pulse)
    rest_strain = strain.values[is_rest]
    level = 0.0
    noise = 0.0
    if len(rest_strain) >= MIN_LEVEL_SAMPLES:
        level = float(rest_strain.mean())
        noise = float(rest_strain.std())
    else:
        rest_strain = np.zeros(0)
    onset = onset_of(strain.times, strain.values - level, pulse, noise)
    return _Pulse(strain - level, rest_strain - level, onset)


def _check_end(incident: _Pulse) -> None:
    """InvalidModel if the incident pulse is cut off before it is over.

    Its last sample must not exceed `MAX_END_RATIO` of its largest.
    """
    values = np.abs(incident.signal.values)
    ratio = float(values[-1] / values.max())
    if ratio > MAX_END_RATIO:
        raise invalid_argument(
            "incident",
            f"ends at {100 * ratio:.0f} % of its largest strain; cut it later, at most "
            f"{100 * MAX_END_RATIO:.0f} % are left of a pulse that is over",
        )


def _joined(first: Signal, second: Signal) -> Signal:
    """Both pulses in one record at the steps of the first one, zero between them.

    It lasts from the begin of the first to the end of the second one. Where they
    overlap the strains are added.
    """
    dt = first.dt
    count = round((second.end - first.start) / dt)
    times = first.start + dt * np.arange(count + 1)
    values = np.interp(times, first.times, first.values, left=0.0, right=0.0)
    values += np.interp(times, second.times, second.values, left=0.0, right=0.0)
    return Signal(values, times)


def _with_rest(signal: Signal, rest_strain: Floats) -> Signal:
    """The record with `ADDED_REST_SAMPLES` more samples before it, at its steps.

    They are the samples at rest, `rest_strain`, again and again, or zeros without any.
    """
    dt = signal.dt
    times = signal.start - dt * np.arange(ADDED_REST_SAMPLES, 0, -1)
    values = np.zeros(ADDED_REST_SAMPLES)
    if rest_strain.size:
        values = np.resize(rest_strain, ADDED_REST_SAMPLES)  # repeated or cut
    return Signal(
        np.concatenate((values, signal.values)),
        np.concatenate((times, signal.times)),
    )
