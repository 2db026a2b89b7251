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
"""Bounds the error of the travel times of the given bars, over these times."""
PULSE_THRESHOLD = 0.15
"""Smallest strain that counts to a pulse, over its largest."""
SPEED_ITERATIONS = 3
"""Iterations for a wave speed.

The dispersion that predicts the pulse depends on the wave speed.
"""


REFLECTED_LIMIT = 0.03
"""Bounds the difference of the reflected strain from that of the impedances.

It is relative to the incident strain. Faces that are clean and aligned reflect 1 or 2 %
more than the impedances tell.
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
        """Contradictions between records and bars, as sentences: at most one.

        The joint reflects another strain than the impedances tell, by more than
        `REFLECTED_LIMIT` of the incident strain. The sentence has the numbers, the
        limit and a remedy.
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

        Bending without gauges on both sides is "-". Each doubt has a line.
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
        rows = list(zip(*columns, strict=True))
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
    """Bars in which one gain or one wave speed is larger by its standard error.

    They are four pairs of bars: with the gain and then the speed of the input bar, then
    those of the output bar. The given `bars` have the gains of the calibration already.
    """
    for k, name in enumerate(InstrumentedBars._fields):
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
        V of a striker with the impedance of the input bar, m/s. By default the gain of
        the input gauge is 1, and the output gauge is compared with the input gauge.
    compression : str
        Sign of a strain that compresses in the records.
    progress : bool or function
        Whether a bar may show how far long work is. A function is called with the
        number of travel times that are done, and of all.

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
        If the joint reflects more or less than the impedances of the bars tell.

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
    input_gain = 1.0  # by definition, without an error
    input_error = 0.0
    if striker_speed is not None:
        V = scalar("striker_speed", striker_speed, "m/s", "positive")
        true_incident = V / (2 * input_bar.speed)
        input_gain = true_incident / incident
        input_error = _plateau_error(input_bar) * input_gain
    Z1 = input_bar.impedance
    Z2 = output_bar.impedance
    # The transmitted strain divided by the incident one: the ratio of the forces, each
    # divided by E A of its bar
    transmission = 2 * Z2 / (Z1 + Z2) * input_bar.stiffness / output_bar.stiffness
    # The incident strain that comes to the output gauge, divided by the strain that is
    # recorded there
    ratio = _ratio(_at_output_gauge(input_bar, output_bar), output_bar)
    output_gain = input_gain * transmission * ratio.value
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
        # The decorator stands between this function and the call of the user.
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
    """Time the pulse that comes back to the output gauge from the far end of its bar.

    The result is the bar with the wave speed that this time gives, and the error of the
    speed. InvalidModel if the record ends too early, or the speed is far off.
    """
    to_far_end = float(output_bar.rod.length) - float(output_bar.distances[0])
    path = 2 * to_far_end
    passing = _first_pulse_alone(output_bar)

    def returned(bar: InstrumentedBar) -> Floats:
        """The pulse as it comes back to the gauge.

        The far end is free, which turns the sign of the strain.
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
        """The incident pulse as it passes the output gauge."""
        return _at_output_gauge(bar, output_bar)

    # The shift of the prediction corrects the travel time over `path`.
    timed = _fit_wave_speed(
        input_bar, path=input_path, recording=output_bar, predict=transmitted
    )
    relative_error = output.speed_error / output_bar.speed
    # Error of the travel time in the output bar, path/speed
    output_time_error = relative_error * output_path / output_bar.speed
    # As speed = path/time, its error is speed^2/path times that of the time.
    speed_error_from_output = timed.bar.speed**2 / input_path * output_time_error
    speed_error = math.hypot(timed.speed_error, speed_error_from_output)
    return timed._replace(speed_error=speed_error)


def _fit_wave_speed(
    bar: InstrumentedBar,
    path: float,
    recording: InstrumentedBar,
    predict: Callable[[InstrumentedBar], Floats],
) -> _Timed:
    """Fit the wave speed of a bar so that a pulse arrives when it is in the record.

    The pulse runs along `path`, m, of the bar and is recorded by the gauge of
    `recording`. `predict` takes the bar with a wave speed and gives the strain of the
    pulse there, [sample]. `SPEED_ITERATIONS` times, the best shift of this prediction
    against the record corrects the travel time and so the speed. InvalidModel if the
    record ends too early, or the speed is far off the given one.
    """
    record = Signal(recording.strains[0], recording.times)
    for _ in range(SPEED_ITERATIONS):
        travel = path / bar.speed
        predicted = predict(bar)
        magnitude = np.abs(predicted)
        pulse = np.flatnonzero(magnitude > PULSE_THRESHOLD * magnitude.max())
        first = pulse[0]
        last = pulse[-1]
        slack = TRAVEL_RANGE_RTOL * travel
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
    # Noise s shifts a pulse by s/sqrt(sum of slope^2). The prediction is made from a
    # record, too, and so has noise of its own: hence the sqrt(2).
    slopes = np.diff(predicted)[first:last] / recording.dt
    steepness = math.sqrt(float(slopes @ slopes))
    arrival_error = _noise(recording) * math.sqrt(2) / steepness
    # As speed = path/time, its error is speed^2/path times that of the time.
    return _Timed(bar, arrival_error * bar.speed**2 / path)


def _check_record_end(recording: InstrumentedBar, last: int, magnitude: Floats) -> None:
    """InvalidModel if the record ends before a predicted pulse is over.

    `magnitude` is the absolute strain of the prediction [sample], and `last` the index
    of the last sample that counts to the pulse. The error tells how long to record.
    """
    end = recording.times[-1]
    is_over = last < len(magnitude) - 1
    if is_over:
        return
    pulse = recording.first_pulse
    is_half = magnitude >= 0.5 * abs(pulse.plateau)
    half = int(np.argmax(is_half))  # the first such sample; 0 without any
    needed = max(recording.times[half], end) + pulse.width + 2 * pulse.rise
    message = f"the record ends at {end:.4g} s, before the pulse returns"
    remedy = f"from the far end; record up to {needed:.4g} s"
    raise invalid_argument("output_gauges", f"{message} {remedy}")


def _reflected_ratio(input_bar: InstrumentedBar) -> float:
    """Strain reflected at the joint divided by the incident strain, by least squares.

    The incident pulse, as if all of it came back to the gauge with its sign, is fitted
    to what the gauge records after the incident pulse.
    """
    incident = _first_pulse_alone(input_bar)
    returned = input_bar.propagated(incident, 2 * float(input_bar.distances[0]))
    magnitude = np.abs(returned)
    is_pulse = magnitude > PULSE_THRESHOLD * magnitude.max()
    full_reflection = returned[is_pulse]
    # The record of the gauge, 0 while the incident pulse passes
    after_incident = input_bar.strains[0] - incident
    reflection = after_incident[is_pulse]
    squares = full_reflection @ full_reflection
    return float(full_reflection @ reflection / squares)


def _noise(bar: InstrumentedBar) -> float:
    """Standard deviation of the strain at the first gauge before the pulse."""
    return float(bar.strains[0, : bar.rest_samples].std())


def _at_output_gauge(input_bar: InstrumentedBar, output_bar: InstrumentedBar) -> Floats:
    """The incident pulse at the output gauge, if the joint transmitted all of it.

    It is the strain at the times of the output bar, without the gains of the bars.
    """
    passing = _first_pulse_alone(input_bar)
    # The input gauge records its pulse at other times than the output gauge.
    pulse = np.interp(output_bar.times, input_bar.times, passing, left=0.0, right=0.0)
    with_steps_of_output = input_bar._replace(dt=output_bar.dt)
    at_joint = with_steps_of_output.propagated(pulse, float(input_bar.distances[0]))
    return output_bar.propagated(at_joint, float(output_bar.distances[0]))


class _Ratio(NamedTuple):
    """A factor between two pulses, and its standard error."""

    value: float
    error: float


def _ratio(predicted: Floats, bar: InstrumentedBar) -> _Ratio:
    """Factor from the pulse that a bar recorded to the predicted one, and its error.

    By least squares, with the predicted pulse p and the recorded one r, it is
    sum(p r)/sum(r^2), and its error is that of sum(r (p - ratio r))/sum(r^2). Residuals
    are correlated over a rise time, so the error of the sum is that of blocks of this
    length.
    """
    magnitude = np.abs(predicted)
    is_pulse = magnitude > PULSE_THRESHOLD * magnitude.max()
    p = predicted[is_pulse]
    r = bar.strains[0][is_pulse]
    sum_of_squares = float(r @ r)
    ratio = float(p @ r) / sum_of_squares
    sums = _block_sums(r * (p - ratio * r), bar)
    error_of_sum = math.sqrt(float(sums @ sums))  # the blocks are independent
    return _Ratio(ratio, error_of_sum / sum_of_squares)


def _plateau_error(bar: InstrumentedBar) -> float:
    """Standard error of the level of the first pulse's plateau, divided by this level.

    The plateau of a pulse oscillates, so each rise time counts as one measurement of
    its level. The level is a median, which noise and the ends of the plateau shift: its
    difference from the mean is added in quadrature. If the plateau has fewer than two
    samples, the error is the noise of the record divided by the level.
    """
    pulse = bar.first_pulse
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

    A block lasts the rise time of the bar's first pulse, and at least one sample; the
    last one may be shorter.
    """
    block_samples = max(1, round(bar.first_pulse.rise / bar.dt))
    starts = np.arange(0, len(values), block_samples)
    sums: Floats = np.add.reduceat(values, starts)
    return sums


def _first_pulse_alone(bar: InstrumentedBar) -> Floats:
    """The record of the first gauge until its first pulse has passed, zero after it."""
    pulse = bar.first_pulse
    # The width is that at half height: both feet take up to a rise time more.
    end = pulse.start + pulse.width + 2 * pulse.rise
    passing: Floats = np.where(bar.times < end, bar.strains[0], 0.0)
    return passing


def _bending(gauge: BarGauge, bar: InstrumentedBar) -> float | None:
    """Largest bending strain while the pulse passes, divided by its plateau.

    The pulse is the first one of the bar: the mean of both sides. Bending counts from
    its level before the pulse. None if only one side has a gauge.
    """
    bending = gauge.bending
    if bending is None:
        return None
    pulse = bar.first_pulse
    from_rest = bending.baseline(bending.start, pulse.start)
    passing = from_rest.window(pulse.start, pulse.start + pulse.width)
    return float(np.abs(passing.values).max() / abs(pulse.plateau))
