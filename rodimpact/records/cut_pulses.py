"""Incident, reflected and transmitted pulse, each cut out of its record.

Incident and reflected pulse are joined to one record of the input gauge, each at the
time at which it passed the gauge. Between them the strain is zero. The result is
reduced as a shot with one gauge a bar.
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
"""Whether all pulses have the same zero of time, or each pulse its own."""
MIN_LEVEL_SAMPLES = 4
"""Least number of samples at rest for the level of a cut pulse.

With fewer samples the level is 0.
"""
ADDED_REST_SAMPLES = 64
"""Number of samples at rest added before the incident and the transmitted pulse."""
MAX_END_RATIO = 0.2
"""Largest ratio of the last to the largest strain of an incident pulse that is over."""


class CutPulses(FrozenDataclass):
    """Incident, reflected and transmitted pulse, cut out of the records of two gauges.

    Parameters
    ----------
    incident, reflected, transmitted : BarGauge
        Each pulse with the distance of its gauge from the specimen. Incident and
        reflected pulse are recorded by the same gauge. If a pulse begins with 4 samples
        at rest or more, their mean is subtracted from it.
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

        InvalidModel is raised at once for a pulse that is not a BarGauge, and for an
        unknown clock.
        """
        for name in ("incident", "reflected", "transmitted"):
            check_kind(name, getattr(self, name), BarGauge, GAUGE_EXAMPLE)
        check_choice("clock", self.clock, CLOCKS)
        if self.incident.distance != self.reflected.distance:
            message = "must be that of the incident pulse, which the same gauge records"
            problems.append(("reflected", f"its distance {message}"))


class _Pulse(NamedTuple):
    """A cut pulse without its level at rest."""

    signal: Signal  # strain minus the level at rest
    rest_strain: Floats  # [sample at rest], minus the level; empty without a level
    onset: float  # time at which the pulse rises out of the noise, s

    @property
    def level_error(self) -> float:
        """Standard error std/sqrt(n) of the level of n samples at rest; 0 for n = 0."""
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

    Each record begins with added samples at rest. If each pulse has its own zero of
    time, reflected and transmitted pulse are shifted to the times that follow from the
    incident pulse, distances and bar speeds. InvalidModel if a pulse cannot be timed,
    if the incident pulse is cut off, or if the reflected pulse begins before it.
    """
    incident = _pulse_from_rest("incident", pulses.incident)
    reflected = _pulse_from_rest("reflected", pulses.reflected)
    transmitted = _pulse_from_rest("transmitted", pulses.transmitted)
    _check_end(incident)
    input_speed = _speed_of(rods.input)
    output_speed = _speed_of(rods.output)
    input_travel = pulses.incident.distance / input_speed  # to the specimen, s
    output_travel = pulses.transmitted.distance / output_speed  # from the specimen, s
    reflected_signal = reflected.signal
    transmitted_signal = transmitted.signal
    if pulses.clock == "own":
        # Reflected and transmitted pulse leave the specimen when the incident pulse
        # arrives there, and then run to their gauges.
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
    # With the strains i, r and t of the pulses, v1 - v2 is c1 (i - r) - c2 t. Each
    # pulse has its own level, so the three errors are independent: squares add up.
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
    """Bar speed c0 of a uniform rod, m/s."""
    return float(rod.segments[0].wave_speed)


def _pulse_from_rest(name: str, gauge: BarGauge) -> _Pulse:
    """The strain of a pulse minus its level at rest, and its onset.

    With fewer than `MIN_LEVEL_SAMPLES` samples at rest the level is taken as 0, and the
    result has no samples at rest. InvalidModel, which names the argument `name`, if the
    pulse cannot be timed.
    """
    strain = gauge.strain
    try:
        # A sample of 0 is added at the end, so that a pulse that was cut before it fell
        # below half of its plateau can be timed.
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
    """Raise InvalidModel if the incident pulse is cut off before it is over.

    The last sample must not exceed `MAX_END_RATIO` times the largest, in absolute
    value.
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
    """Both pulses in one record, with zeros between them.

    The record has the time step of the first pulse, and lasts from the begin of the
    first to the end of the second pulse. Strains that overlap are added.
    """
    dt = first.dt
    count = round((second.end - first.start) / dt)
    times = first.start + dt * np.arange(count + 1)
    values = np.interp(times, first.times, first.values, left=0.0, right=0.0)
    values += np.interp(times, second.times, second.values, left=0.0, right=0.0)
    return Signal(values, times)


def _with_rest(signal: Signal, rest_strain: Floats) -> Signal:
    """The record with `ADDED_REST_SAMPLES` more samples before it, at its steps.

    The added samples repeat `rest_strain`; they are 0 if it is empty.
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
