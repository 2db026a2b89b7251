"""Calibration by a shot without a specimen: wave speeds, gains, reflection, bending.

The pulse of the striker runs through both bars and back from the far end of the output
bar. The time from the first passage of the output gauge to the second gives c0 of that
bar; the time from the input gauge to the output gauge then gives c0 of the input bar. A
striker of the same material and cross-section with the speed V causes the strain
V/(2 c0).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing
from ..model.arguments import check_kind, scalar
from ..model.bodies import Rod
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, check_progress
from ..storage.tables import align
from .bar_gauge import GAUGE_EXAMPLE, BarGauge
from .bar_reading import Compression, instrumented_bars
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .signal import Signal

TRAVEL_RANGE_RTOL = 0.1
"""Largest relative error of the travel times that follow from the given bars."""
PULSE_THRESHOLD = 0.15
"""Samples belong to a pulse if their strain exceeds this part of the largest one."""
SPEED_ITERATIONS = 3
"""Number of iterations for a wave speed.

The predicted pulse depends on the wave speed, since the dispersion does.
"""


REFLECTED_LIMIT = 0.03
"""Largest difference of the reflected strain from the one expected from the impedances.

The difference is relative to the incident strain. Faces that are clean and aligned
reflect 1 or 2 % more than expected.
"""


class DoubtfulCalibration(UserWarning):
    """The records of a shot without a specimen contradict the bars that were given.

    `Calibration.doubts` holds the same sentences.

    Examples
    --------
    The bars differ in area, but are given as equal:

    >>> import warnings, rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> thin = ri.Rod(1.5, area=8e-5, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, thin]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> with warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     found = ri.calibrate(*gauges, bar)
    >>> {each.category.__name__ for each in told}
    {'DoubtfulCalibration'}
    >>> print(found.doubts[0].split(",")[0])
    the joint reflects -11.1 % of the incident strain
    """


@explain_missing()
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
        Standard errors of the gains: from the ringing plateau of the pulse, if a
        striker speed is given, and from the difference between the incident pulse at
        the output gauge and the recorded one.
    reflected : float
        Strain reflected at the joint divided by the incident strain. `expected` is its
        value from the impedances, (Z2 - Z1)/(Z2 + Z1).
    expected : float
    noise : (float, float)
        Standard deviation of the noise divided by the plateau of the pulse.
    bending : (float or None, float or None)
        Largest bending strain divided by the plateau; None without gauges on both
        sides.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)  # c = 5000 m/s
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

    @property
    def doubts(self) -> tuple[str, ...]:
        """Contradictions between records and bars, as sentences: none or one.

        There is one if `reflected` and `expected` differ by more than
        `REFLECTED_LIMIT`. The sentence gives both numbers, the limit and a remedy.
        """
        if abs(self.reflected - self.expected) <= REFLECTED_LIMIT:
            return ()
        doubt = (
            f"the joint reflects {100 * self.reflected:.1f} % of the incident strain, "
            f"{100 * self.reflected**2:.2g} % of its energy; by the impedances of the "
            f"bars it should be {100 * self.expected:.1f} % of the strain, within "
            f"{100 * REFLECTED_LIMIT:g} %: clean and align the faces, or correct "
            "diameter and density of the bars"
        )
        return (doubt,)

    def __str__(self) -> str:
        """Table with a column for each bar, reflection at the joint, and doubts.

        "-" stands for the bending of a bar without gauges on both sides. Each doubt has
        a line.
        """
        columns = [["", "wave speed", "gain", "noise/plateau", "bending/plateau"]]
        for k, title in enumerate(("input bar", "output bar")):
            speed = self.bars[k].segments[0].wave_speed
            bending = self.bending[k]
            bending_text = "-"
            if bending is not None:
                bending_text = f"{100 * bending:.1f} %"
            columns.append(
                [
                    title,
                    f"{speed:.1f} +- {self.speed_errors[k]:.1f} m/s",
                    f"{self.gains[k]:.4f} +- {self.gain_errors[k]:.4f}",
                    f"{100 * self.noise[k]:.2f} %",
                    bending_text,
                ]
            )
        rows = list(zip(*columns, strict=True))  # transposed
        lines = [
            align(rows),
            f"reflected at the joint: {100 * self.reflected:.2f} % of the incident "
            f"strain; expected from the impedances: {100 * self.expected:.2f} %",
        ]
        for doubt in self.doubts:
            lines.append(f"Doubtful: {doubt}")
        return "\n".join(lines)


def with_gains(calibration: Calibration, bars: InstrumentedBars) -> InstrumentedBars:
    """New bars of a shot, with strains multiplied by the gains of a calibration."""
    input_gain, output_gain = calibration.gains
    return InstrumentedBars(
        _amplified(bars.input, input_gain), _amplified(bars.output, output_gain)
    )


def with_one_error(
    calibration: Calibration, bars: InstrumentedBars
) -> Iterator[InstrumentedBars]:
    """Yield four pairs of bars, each with one number larger by its standard error.

    The numbers are, in order: gain and wave speed of the input bar, gain and wave speed
    of the output bar. The given `bars` have the gains of the calibration already and
    are not changed.
    """
    for k, name in enumerate(InstrumentedBars._fields):
        # The strains contain the gain already: they grow by its relative error.
        gain_factor = 1 + calibration.gain_errors[k] / calibration.gains[k]
        yield bars._replace(**{name: _amplified(bars[k], gain_factor)})
        speed = bars[k].speed + calibration.speed_errors[k]
        faster = bars[k]._replace(rod=with_speed(bars[k].rod, speed))
        yield bars._replace(**{name: faster})


def _amplified(bar: InstrumentedBar, gain: float) -> InstrumentedBar:
    """A bar with its strains multiplied by a gain."""
    return bar._replace(strains=gain * bar.strains)


@explain_arguments
def calibrate(
    input_gauges: Any,
    output_gauges: Any,
    bars: Rod | tuple[Rod, Rod],
    *,
    striker_speed: float | None = None,
    compression: Compression = "negative",
    progress: bool | ProgressFunction = True,
) -> Calibration:
    """Wave speeds and gains from a shot with the two bars together and no specimen.

    Parameters
    ----------
    input_gauges, output_gauges : BarGauge
        As in `reduce`, but one gauge a bar.
    bars : Rod or (Rod, Rod)
        Input and output bar, with their true lengths; errors of the wave speeds up to
        10 % are corrected.
    striker_speed : float, optional
        Speed V of a striker with the impedance of the input bar, m/s. Without it the
        gain of the input gauge is 1, and the output gauge is compared with the input
        gauge.
    compression : str
        Sign of a strain that compresses in the records.
    progress : bool or function
        Whether to show a progress bar. A function is called with the number of travel
        times that are done and the number of all of them, 2.

    Returns
    -------
    Calibration
        Pass it to `reduce` in place of the bars.

    Raises
    ------
    InvalidModel
        If an argument is invalid, or the record ends before the pulse returns from the
        far end of the output bar.

    Warns
    -----
    DoubtfulCalibration
        If the joint reflects more or less than expected from the impedances.

    Notes
    -----
    The incident strain is V/(2 c0). The joint transmits the fraction 2 Z2/(Z1 + Z2) of
    a force.

    Examples
    --------
    In a computed shot the gauges are right, so both gains are 1:

    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)  # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, bar]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.calibrate(*gauges, bar, striker_speed=10.0)
    >>> [round(gain, 2) for gain in found.gains]
    [1.0, 1.0]
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    # A bar must have one gauge here; `instrumented_bars` would take two.
    check_kind("input_gauges", input_gauges, BarGauge, GAUGE_EXAMPLE)
    check_kind("output_gauges", output_gauges, BarGauge, GAUGE_EXAMPLE)
    bars_as_given = instrumented_bars(input_gauges, output_gauges, bars, compression)
    with Progress(progress, "calibrate", "travel times") as report:
        timed_output = _with_output_speed(bars_as_given.output)
        report(1, 2)
        timed_input = _with_input_speed(bars_as_given.input, timed_output)
        report(2, 2)
    input_bar = timed_input.bar
    output_bar = timed_output.bar
    incident = input_bar.first_pulse.plateau
    transmitted = output_bar.first_pulse.plateau
    # Without a striker speed the input gain is 1 by definition, without an error.
    input_gain = 1.0
    input_error = 0.0
    if striker_speed is not None:
        V = scalar("striker_speed", striker_speed, "m/s", "positive")
        true_incident = V / (2 * input_bar.speed)
        input_gain = true_incident / incident
        input_error = _plateau_error(input_bar) * input_gain
    Z1 = input_bar.impedance
    Z2 = output_bar.impedance
    # Transmitted strain divided by incident strain. The ratio of the forces is
    # 2 Z2/(Z1 + Z2), and each strain is its force divided by E A of its bar.
    transmission = 2 * Z2 / (Z1 + Z2) * input_bar.stiffness / output_bar.stiffness
    # Incident strain as it would arrive at the output gauge, divided by the strain that
    # is recorded there
    ratio = _ratio(_at_output_gauge(input_bar, output_bar), output_bar)
    output_gain = input_gain * transmission * ratio.value
    # Two independent errors of the output gain: that of the input gain and that of the
    # ratio
    error_by_input_gain = input_error / input_gain * output_gain
    error_by_ratio = input_gain * transmission * ratio.error
    output_error = math.hypot(error_by_input_gain, error_by_ratio)
    input_noise = _noise(input_bar) / incident
    output_noise = _noise(output_bar) / transmitted
    calibration = Calibration(
        bars=(input_bar.rod, output_bar.rod),
        gains=(input_gain, output_gain),
        speed_errors=(timed_input.speed_error, timed_output.speed_error),
        gain_errors=(input_error, output_error),
        reflected=_reflected_ratio(input_bar),
        expected=(Z2 - Z1) / (Z1 + Z2),
        noise=(input_noise, output_noise),
        bending=(
            _bending(input_gauges, input_bar),
            _bending(output_gauges, output_bar),
        ),
    )
    for doubt in calibration.doubts:
        # Level 3 is the user's call: the decorator is a level between.
        warnings.warn(doubt, DoubtfulCalibration, stacklevel=3)
    return calibration


def with_speed(rod: Rod, speed: float) -> Rod:
    """The uniform rod with another wave speed, m/s; only E = rho c^2 changes."""
    segment = rod.segments[0]
    material = segment.material
    changed = material.replace(youngs_modulus=material.density * speed**2)
    return rod.replace(segments=[segment.replace(material=changed)])


class _Timed(NamedTuple):
    """A bar with its measured wave speed, and the standard error of the speed, m/s."""

    bar: InstrumentedBar
    speed_error: float


def _with_output_speed(output_bar: InstrumentedBar) -> _Timed:
    """The output bar with its wave speed, fitted to the echo from the far end.

    The first pulse passes the output gauge, is reflected at the far end and passes the
    gauge again. The time between the two passages gives the speed and its standard
    error. InvalidModel if the record ends before the echo, or if the speed is far from
    the given one.
    """
    to_far_end = float(output_bar.rod.length) - float(output_bar.distances[0])
    path = 2 * to_far_end  # there and back, m
    passing = _first_pulse_alone(output_bar)

    def returned(bar: InstrumentedBar) -> Floats:
        """Strain of the echo at the gauge, [sample].

        The reflection at the free far end reverses the sign of the strain.
        """
        return -bar.propagated(passing, path)

    return _fit_wave_speed(
        output_bar, path=path, recording=output_bar, predict=returned
    )


def _with_input_speed(input_bar: InstrumentedBar, output: _Timed) -> _Timed:
    """The input bar with its wave speed, fitted to the pulse in the output bar.

    The pulse is propagated from the input gauge through the joint of the bars to the
    output gauge and compared with the record there. `output` is the output bar with its
    measured speed. The standard error of the fitted speed has two independent parts:
    that of the arrival and that of the travel time in the output bar. InvalidModel is
    raised if the record ends too early, or if the speed is far from the given one.
    """
    output_bar = output.bar
    # Distances of the first gauges from the joint, m
    input_path = float(input_bar.distances[0])
    output_path = float(output_bar.distances[0])

    def transmitted(bar: InstrumentedBar) -> Floats:
        """Strain of the incident pulse at the output gauge, [sample]."""
        return _at_output_gauge(bar, output_bar)

    # The shift of the prediction corrects the travel time over `path`.
    timed = _fit_wave_speed(
        input_bar, path=input_path, recording=output_bar, predict=transmitted
    )
    relative_error = output.speed_error / output_bar.speed
    # The travel time in the output bar is path/speed: it has the same relative error.
    output_time_error = relative_error * output_path / output_bar.speed
    # The speed is path/time, so its error is speed^2/path times the error of the time.
    speed_error_from_output = timed.bar.speed**2 / input_path * output_time_error
    speed_error = math.hypot(timed.speed_error, speed_error_from_output)
    return timed._replace(speed_error=speed_error)


def _fit_wave_speed(
    bar: InstrumentedBar,
    path: float,
    recording: InstrumentedBar,
    predict: Callable[[InstrumentedBar], Floats],
) -> _Timed:
    """The bar with its wave speed fitted to the arrival of a pulse, and the error.

    The pulse runs along `path`, m, of the bar and is recorded by the first gauge of
    `recording`. `predict` returns the strain of the pulse at this gauge, [sample], for
    the bar with a trial speed. In each of `SPEED_ITERATIONS` iterations the best shift
    of the prediction against the record corrects the travel time and so the speed.
    InvalidModel if the record ends before the pulse is over, or if the travel time is
    off by more than `TRAVEL_RANGE_RTOL`.
    """
    record = Signal(recording.strains[0], recording.times)
    for _ in range(SPEED_ITERATIONS):
        travel = path / bar.speed
        predicted = predict(bar)
        magnitude = np.abs(predicted)
        pulse = np.flatnonzero(magnitude > PULSE_THRESHOLD * magnitude.max())
        first = pulse[0]  # index of the first sample of the predicted pulse
        last = pulse[-1]
        slack = TRAVEL_RANGE_RTOL * travel  # largest shift, s
        _check_record_end(recording, last, magnitude)  # refuses a pulse not yet over
        earliest = recording.times[first] - slack
        latest = min(recording.times[last] + slack, recording.times[-1])
        searched = record.window(earliest, latest)
        prediction = Signal(predicted, recording.times)
        misfit = searched.misfit(prediction, shift=(-slack, slack))
        if misfit.at_limit:
            percent = 100 * TRAVEL_RANGE_RTOL
            message = f"the travel time is more than {percent:g} % off the expected one"
            raise invalid_argument(
                "bars", f"{message}; correct wave speed, length or distances"
            )
        measured_speed = path / (travel + misfit.shift)
        bar = bar._replace(rod=with_speed(bar.rod, measured_speed))
    # Noise of the standard deviation s shifts a pulse by s/sqrt(sum of slope^2). The
    # factor sqrt(2): the prediction has the same noise, as it is made from a record.
    # Slopes between the samples `first` to `last` of the pulse
    slopes = np.diff(predicted)[first:last] / recording.dt
    steepness = math.sqrt(float(slopes @ slopes))
    arrival_error = _noise(recording) * math.sqrt(2) / steepness
    # The speed is path/time, so its error is speed^2/path times the error of the time.
    return _Timed(bar, arrival_error * bar.speed**2 / path)  # bar, speed_error


def _check_record_end(recording: InstrumentedBar, last: int, magnitude: Floats) -> None:
    """Raise InvalidModel if the record ends before a predicted pulse is over.

    `magnitude` is the absolute strain of the prediction, [sample], and `last` the index
    of the last sample of the pulse. The message gives the time up to which to record.
    """
    end = recording.times[-1]
    is_over = last < len(magnitude) - 1
    if is_over:
        return
    pulse = recording.first_pulse
    is_half = magnitude >= 0.5 * abs(pulse.plateau)
    half = int(np.argmax(is_half))  # index of the first such sample; 0 if there is none
    # After half height the pulse lasts for its width and for the rest of its fall.
    needed = max(recording.times[half], end) + pulse.width + 2 * pulse.rise
    message = f"the record ends at {end:.4g} s, before the pulse returns"
    remedy = f"from the far end; record up to {needed:.4g} s"
    raise invalid_argument("output_gauges", f"{message} {remedy}")


def _reflected_ratio(input_bar: InstrumentedBar) -> float:
    """Strain reflected at the joint divided by the incident strain, by least squares.

    The incident pulse, propagated from the gauge to the joint and back, is the record
    of a full reflection without change of sign. The result is the factor with which it
    fits the record after the incident pulse best.
    """
    incident = _first_pulse_alone(input_bar)
    returned = input_bar.propagated(incident, 2 * float(input_bar.distances[0]))
    magnitude = np.abs(returned)
    is_pulse = magnitude > PULSE_THRESHOLD * magnitude.max()
    full_reflection = returned[is_pulse]
    # The record of the gauge, with zeros while the incident pulse passes
    after_incident = input_bar.strains[0] - incident
    reflection = after_incident[is_pulse]
    squares = full_reflection @ full_reflection
    return float(full_reflection @ reflection / squares)


def _noise(bar: InstrumentedBar) -> float:
    """Standard deviation of the strain at the first gauge, at rest before the pulse."""
    return float(bar.strains[0, : bar.rest_samples].std())


def _at_output_gauge(input_bar: InstrumentedBar, output_bar: InstrumentedBar) -> Floats:
    """Strain of the incident pulse as it would arrive at the output gauge, [sample].

    The joint is assumed to transmit the whole strain. The samples are at the times of
    the output bar, and the gains are not applied.
    """
    passing = _first_pulse_alone(input_bar)
    # The two records may have different times and time steps: the pulse is interpolated
    # to the times of the output bar, and propagated with its time step.
    pulse = np.interp(output_bar.times, input_bar.times, passing, left=0.0, right=0.0)
    with_steps_of_output = input_bar._replace(dt=output_bar.dt)
    at_joint = with_steps_of_output.propagated(pulse, float(input_bar.distances[0]))
    return output_bar.propagated(at_joint, float(output_bar.distances[0]))


class _Ratio(NamedTuple):
    """A factor between two pulses, and its standard error."""

    value: float
    error: float


def _ratio(predicted: Floats, bar: InstrumentedBar) -> _Ratio:
    """Factor from the recorded pulse of a bar to a predicted one, and its error.

    The factor of the recorded pulse r that fits the predicted pulse p best, by least
    squares, is sum(p r)/sum(r^2). Its standard error is that of
    sum(r (p - ratio r))/sum(r^2). The residuals are correlated over a rise time, so
    their sums over blocks of this length count as the independent errors.
    """
    magnitude = np.abs(predicted)
    is_pulse = magnitude > PULSE_THRESHOLD * magnitude.max()
    p = predicted[is_pulse]
    r = bar.strains[0][is_pulse]
    sum_of_squares = float(r @ r)
    ratio = float(p @ r) / sum_of_squares
    sums = _block_sums(r * (p - ratio * r), bar)
    error_of_sum = math.sqrt(float(sums @ sums))  # squares of the block sums add up
    return _Ratio(ratio, error_of_sum / sum_of_squares)


def _plateau_error(bar: InstrumentedBar) -> float:
    """Relative standard error of the plateau of the first pulse at the first gauge.

    The plateau of a pulse oscillates, so each rise time counts as one measurement of
    its level. `Pulse.plateau` is a median, which noise and the ends of the plateau
    shift: its difference from the mean is added in quadrature. If the plateau has fewer
    than two samples, the error is the noise divided by the plateau.
    """
    pulse = bar.first_pulse
    # The pulse rises at `pulse.start` and falls about one `pulse.width` later. One rise
    # time is left out at each of these two ends.
    begin = pulse.start + pulse.rise
    end = pulse.start + pulse.width - pulse.rise
    is_plateau = (bar.times >= begin) & (bar.times <= end)
    plateau = bar.strains[0][is_plateau]
    if len(plateau) < 2:
        return _noise(bar) / pulse.plateau
    # Sum of the deviations in each rise time. These sums are independent, so their
    # squares add up.
    sums = _block_sums(plateau - plateau.mean(), bar)
    error_of_sum = math.sqrt(float(sums @ sums))
    error_of_mean = error_of_sum / len(plateau)
    shift_of_median = float(plateau.mean()) - pulse.plateau
    return math.hypot(error_of_mean, shift_of_median) / pulse.plateau


def _block_sums(values: Floats, bar: InstrumentedBar) -> Floats:
    """Sums of values, [sample], over blocks of consecutive samples, [block].

    A block lasts the rise time of the bar's first pulse, and at least one sample. The
    last block may be shorter.
    """
    block_samples = max(1, round(bar.first_pulse.rise / bar.dt))
    starts = np.arange(0, len(values), block_samples)
    sums: Floats = np.add.reduceat(values, starts)
    return sums


def _first_pulse_alone(bar: InstrumentedBar) -> Floats:
    """Strain at the first gauge, [sample], with zeros after the first pulse."""
    pulse = bar.first_pulse
    # The width is measured at half height; the pulse may be longer by one rise time at
    # either end.
    end = pulse.start + pulse.width + 2 * pulse.rise
    passing: Floats = np.where(bar.times < end, bar.strains[0], 0.0)
    return passing


def _bending(gauge: BarGauge, bar: InstrumentedBar) -> float | None:
    """Largest absolute bending strain in the first pulse, divided by the plateau.

    The plateau is that of the mean of both sides. The bending strain is measured from
    its level before the pulse. None if only one side of the bar has a gauge.
    """
    bending = gauge.bending
    if bending is None:
        return None
    pulse = bar.first_pulse
    from_rest = bending.baseline(bending.start, pulse.start)
    passing = from_rest.window(pulse.start, pulse.start + pulse.width)
    return float(np.abs(passing.values).max() / abs(pulse.plateau))
