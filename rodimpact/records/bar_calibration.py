"""Calibration of one bar: wave speed and Poisson ratio from a pulse at two distances.

The same pulse is recorded twice, by two gauges, or by one gauge before and after a
reflection. The first record, propagated by the exact first mode, must agree with the
second one. The arrival time determines the bar speed c0, the change of shape determines
Poisson's ratio. The length of the bar is not used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .. import waves
from ..hints import explain_arguments, explain_missing
from ..model.arguments import check_kind, scalar
from ..model.bodies import Rod
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from . import filters
from .calibration import with_speed
from .pulses import plateau
from .signal import Signal

SEARCHED_SPEED_RTOL = 0.1
"""Largest relative error of the given bar speed."""
USUAL_POISSON_RATIO = 0.3
"""Poisson's ratio at which the search begins if the material has none."""
POISSON_BOUNDS = (0.0, 0.499)
"""Bounds of the search for Poisson's ratio."""
SPEED_STEP = 1e-6
"""Relative step of the bar speed in finite differences."""
POISSON_STEP = 1e-3
"""Step of Poisson's ratio in finite differences."""
SEARCH_TOLERANCE = 1e-6
"""Relative change of the cost or of the numbers at which the search ends."""
MIN_COMPARED_SAMPLES = 32
"""Least number of samples of the second record that may contain the pulse."""
GOOD_MISFIT = 0.05
"""Misfit over the plateau above which the two records are not one pulse."""


@explain_missing()
@dataclass(frozen=True, eq=False)
class BarCalibration:
    """Wave speed and Poisson ratio of one bar; made by `calibrate_bar`.

    Attributes
    ----------
    bar : Rod
        The bar with the measured wave speed and Poisson ratio; its density is
        unchanged.
    wave_speed, wave_speed_error : float
        c0 and its standard error, m/s. The error of the distance is not included: it
        causes the same relative error of c0.
    poisson_ratio, poisson_ratio_error : float
    gain, gain_error : float
        Factor from the propagated first record to the second record: the ratio of the
        gains of the gauges, negative after a reflection at a free end.
    misfit : float
        Root mean square of the difference between the second record and its prediction,
        divided by the plateau. Both contain only the frequencies below the cut-off
        frequency of the first mode.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.Material(
    ...     "steel", youngs_modulus=2e11, density=8000, poisson_ratio=0.29
    ... )
    >>> bar = ri.Rod(3.0, diameter=0.02, material=steel)       # c0 = 5000 m/s
    >>> k = np.arange(400)
    >>> shape = np.clip(np.minimum(k - 50, 170 - k) / 10, 0, 1)
    >>> first = ri.Signal(shape, dt=5e-7)
    >>> second = first.extended(after=2e-4).propagated(2.0, bar)
    >>> other = steel.replace(youngs_modulus=2.1e11, poisson_ratio=0.33)
    >>> guess = bar.replace(material=other)
    >>> found = ri.calibrate_bar(first, second, 2.0, guess)
    >>> round(found.wave_speed, 1), round(found.poisson_ratio, 3)
    (5000.0, 0.29)
    """

    bar: Rod
    wave_speed: float
    wave_speed_error: float
    poisson_ratio: float
    poisson_ratio_error: float
    gain: float
    gain_error: float
    misfit: float

    def __str__(self) -> str:
        """Wave speed, Poisson ratio, gain, their standard errors, and the misfit.

        They stand in four lines. A misfit above `GOOD_MISFIT` adds a line of doubt.
        """
        lines = [
            f"wave speed: {self.wave_speed:.2f} +- {self.wave_speed_error:.2f} m/s",
            f"Poisson ratio: {self.poisson_ratio:.5f} +- "
            f"{self.poisson_ratio_error:.5f}",
            f"second record over the first: {self.gain:.4f} +- {self.gain_error:.4f}",
            f"misfit: {100 * self.misfit:.2f} % of the plateau",
        ]
        if self.misfit > GOOD_MISFIT:
            lines.append(
                "Doubtful: the second record is not the first one after this distance; "
                "give windows that hold one passage of the pulse each"
            )
        return "\n".join(lines)


@explain_arguments
def calibrate_bar(
    first: Signal, second: Signal, distance: float, bar: Rod
) -> BarCalibration:
    """Wave speed and Poisson ratio of a round bar from one pulse at two distances.

    Parameters
    ----------
    first : Signal
        The pulse at the gauge that it passes first, with some rest before it. Cut other
        waves off with `Signal.window`.
    second : Signal
        The pulse in the second record, with the same zero of time.
    distance : float
        Path of the pulse between both records, m: from gauge to gauge, also through the
        joint of two equal bars, or from a gauge to the free end and back.
    bar : Rod
        Uniform and round. Errors of its wave speed up to 10 % are corrected. Its
        Poisson ratio may be missing.

    Returns
    -------
    BarCalibration

    Raises
    ------
    InvalidModel
        If an argument is invalid, or the second record does not contain the pulse.

    Notes
    -----
    c0, nu, a gain and an offset are fitted by least squares; the result leaves out the
    offset. The standard errors are computed from the residual as if it were white noise
    below the cut-off frequency.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.Material(
    ...     "steel", youngs_modulus=2e11, density=8000, poisson_ratio=0.29
    ... )
    >>> bar = ri.Rod(3.0, diameter=0.02, material=steel)       # c0 = 5000 m/s
    >>> k = np.arange(400)
    >>> shape = np.clip(np.minimum(k - 50, 170 - k) / 10, 0, 1)
    >>> first = ri.Signal(shape, dt=5e-7)
    >>> second = first.extended(after=2e-4).propagated(2.0, bar)
    >>> other = steel.replace(youngs_modulus=2.1e11, poisson_ratio=0.33)
    >>> guess = bar.replace(material=other)
    >>> found = ri.calibrate_bar(first, second, 2.0, guess)
    >>> round(found.wave_speed, 1), round(found.poisson_ratio, 3)
    (5000.0, 0.29)
    """
    check_kind("first", first, Signal, "incident.window(0.0, 2e-4)")
    check_kind("second", second, Signal, "incident.window(4e-4, 6e-4)")
    distance = scalar("distance", distance, "m", "positive")
    check_kind("bar", bar, Rod, "Rod(2.0, diameter=0.02, material=steel)")
    if first.unit != second.unit:
        message = f"must be in the unit of first, {first.unit!r}, got {second.unit!r}"
        raise invalid_argument("second", message)
    if bar.segments[0].material.poisson_ratio is None:
        bar = _with_poisson_ratio(bar, USUAL_POISSON_RATIO)
    mode = waves.Bar.of(bar)  # refuses a bar that is not uniform and round
    pair = _pair_with_estimate(first, second, distance, mode)  # refuses a lost pulse
    search_end = _least_squares(pair)
    values = search_end.values
    errors = search_end.errors
    return BarCalibration(
        bar=with_speed(_with_poisson_ratio(bar, values.nu), values.speed),
        wave_speed=values.speed,
        wave_speed_error=errors.speed,
        poisson_ratio=values.nu,
        poisson_ratio_error=errors.nu,
        gain=values.gain,
        gain_error=errors.gain,
        misfit=search_end.misfit,
    )


def _with_poisson_ratio(bar: Rod, poisson_ratio: float) -> Rod:
    """The bar, which has one segment, with another Poisson ratio."""
    segment = bar.segments[0]
    material = segment.material.replace(poisson_ratio=poisson_ratio)
    return bar.replace(segments=[segment.replace(material=material)])


class _Numbers(NamedTuple):
    """The four fitted numbers, or their standard errors."""

    speed: float  # c0, m/s
    nu: float
    gain: float  # of the second record over the first
    offset: float  # of the second record, in its unit


class _Pair(NamedTuple):
    """Two records of one pulse, and the numbers from which the search begins."""

    first: Signal
    second: Signal
    distance: float  # path of the pulse between both records, m
    start: _Numbers
    radius: float  # of the bar, m
    compared: Any  # [sample of second] bool: the first record predicts this sample
    level: float  # plateau of the second record, in its unit

    def prediction(self, speed: float, nu: float) -> Floats:
        """The first record, propagated over the distance, [compared sample].

        `speed` is c0, m/s, and `nu` Poisson's ratio. Gain and offset are not applied.
        The record is interpolated by a cubic spline, and continued by its first and its
        last value.
        """
        from scipy.interpolate import CubicSpline

        bar = waves.Bar(speed, nu, self.radius)
        moved = self.first.propagated(self.distance, bar)
        times = self.second.times[self.compared]
        curve = CubicSpline(moved.times, moved.values)
        predicted: Floats = curve(np.clip(times, moved.start, moved.end))
        return predicted

    def record(self, speed: float, nu: float) -> Floats:
        """The compared samples of the second record, below the cut-off frequency.

        The cut-off of the first mode follows from `speed`, c0 in m/s, and Poisson's
        ratio `nu`.
        """
        # Over the distance 0 the pulse keeps its shape: `dispersed` only removes the
        # frequencies above the cut-off.
        bar = waves.Bar(speed, nu, self.radius)
        carried = filters.dispersed(
            self.second.values, self.second.dt, distance=0.0, bar=bar
        )
        compared: Floats = carried[self.compared]
        return compared

    def residuals(self, numbers: _Numbers) -> Floats:
        """Prediction minus second record, divided by the plateau, [compared sample].

        The prediction includes gain and offset.
        """
        predicted = self.prediction(numbers.speed, numbers.nu)
        recorded = self.record(numbers.speed, numbers.nu)
        difference = numbers.gain * predicted + numbers.offset - recorded
        return np.asarray(difference / self.level)


def _pair_with_estimate(
    first: Signal, second: Signal, distance: float, bar: waves.Bar
) -> _Pair:
    """Both records with a first estimate of bar speed and gain.

    The first record is propagated over the distance, m, in the given bar. Its best
    shift against the second record, at most `SEARCHED_SPEED_RTOL` of the travel time,
    gives the bar speed. The search begins with the offset 0 and with nu of the bar.
    InvalidModel if the second record has too few samples at these times, or if the best
    shift is at its limit.
    """
    travel = distance / bar.wave_speed
    slack = SEARCHED_SPEED_RTOL * travel  # largest shift, s
    moved = first.propagated(distance, bar)
    earliest = max(second.start, moved.start - slack)
    latest = min(second.end, moved.end + slack)
    may_be_pulse = (second.times >= earliest) & (second.times <= latest)
    if np.count_nonzero(may_be_pulse) < MIN_COMPARED_SAMPLES:
        message = (
            f"must contain the pulse at {moved.start:.4g} to {moved.end:.4g} s, "
            f"got {second.start:.4g} to {second.end:.4g} s"
        )
        raise invalid_argument("second", f"{message}; give that part of the record")
    searched = second.window(earliest, latest)
    misfit = searched.misfit(moved, shift=(-slack, slack))
    if misfit.at_limit:
        percent = 100 * SEARCHED_SPEED_RTOL
        message = f"takes {percent:g} % more or less time than the bar speed says"
        raise invalid_argument(
            "distance", f"{message}; correct the distance, or the bar's wave speed"
        )
    measured_travel = travel + misfit.shift
    # The first record, later by the travel time, lies between these times: only there
    # does it predict the second record.
    start_there = first.start + measured_travel
    end_there = first.end + measured_travel
    compared = (second.times >= start_there) & (second.times <= end_there)
    start = _Numbers(
        speed=distance / measured_travel,
        nu=bar.poisson_ratio,
        gain=misfit.scale,
        offset=0.0,
    )
    level = plateau(second.values[compared])
    return _Pair(
        first=first,
        second=second,
        distance=distance,
        start=start,
        radius=bar.radius,
        compared=compared,
        level=level,
    )


class _SearchEnd(NamedTuple):
    """Result of the least-squares search."""

    values: _Numbers
    errors: _Numbers  # standard errors
    misfit: float  # rms of the residuals, which are relative to the plateau


def _least_squares(pair: _Pair) -> _SearchEnd:
    """Best numbers, their standard errors and the misfit, by least squares.

    The numbers are speed, nu, gain and offset. The search runs over dimensionless
    variables x = 1 + (number - start)/unit, which begin at 1. The unit of speed and
    gain is the start value, that of nu is 1, and that of the offset is the plateau.
    """
    from scipy.optimize import least_squares

    start = np.array(pair.start)
    units = np.array(
        _Numbers(
            speed=pair.start.speed, nu=1.0, gain=pair.start.gain, offset=pair.level
        )
    )

    def numbers_at(x: Floats) -> _Numbers:
        """The numbers for these values of the variables."""
        numbers = start + units * (x - 1.0)
        return _Numbers(*numbers.tolist())

    def residuals(x: Floats) -> Floats:
        """Prediction minus second record, divided by the plateau, [compared sample]."""
        return pair.residuals(numbers_at(x))

    def jacobian(x: Floats) -> Floats:
        """Derivatives of the residuals by the variables x, [compared sample, variable].

        The derivatives by speed and nu are finite differences. The derivatives by gain
        and offset are exact, since the residuals are linear in these.
        """
        numbers = numbers_at(x)
        predicted = pair.prediction(numbers.speed, numbers.nu)
        here = pair.residuals(numbers)
        faster = numbers._replace(speed=numbers.speed * (1 + SPEED_STEP))
        wider = numbers._replace(nu=numbers.nu + POISSON_STEP)
        by_numbers = [
            (pair.residuals(faster) - here) / (numbers.speed * SPEED_STEP),
            (pair.residuals(wider) - here) / POISSON_STEP,
            predicted / pair.level,
            np.full(len(here), 1 / pair.level),
        ]
        # Chain rule: the derivative of a number by its x is the unit of the number.
        by_variables: Floats = np.stack(by_numbers, axis=1) * units
        return by_variables

    # Only nu is bounded. Its variable is x = 1 + nu - start, since its unit is 1.
    low = np.full(len(start), -np.inf)
    high = np.full(len(start), np.inf)
    nu_index = _Numbers._fields.index("nu")
    low[nu_index] = 1.0 + POISSON_BOUNDS[0] - pair.start.nu
    high[nu_index] = 1.0 + POISSON_BOUNDS[1] - pair.start.nu
    end = least_squares(
        residuals,
        x0=np.ones(len(start)),
        jac=jacobian,
        bounds=(low, high),
        x_scale="jac",
        ftol=SEARCH_TOLERANCE,
        xtol=SEARCH_TOLERANCE,
    )
    bar = waves.Bar(pair.start.speed, pair.start.nu, pair.radius)
    mean_square = float(np.mean(end.fun**2))  # `fun`: the residuals at the end
    # Noise below the cut-off frequency has two independent samples in each period of
    # that frequency. Their share of all samples enters the covariance, as only
    # independent samples reduce the error.
    independent_share = min(1.0, 2 * bar.cut_off * pair.second.dt)
    covariance = np.linalg.inv(end.jac.T @ end.jac) * mean_square / independent_share
    errors = units * np.sqrt(np.diag(covariance))  # of the numbers, not of x
    return _SearchEnd(
        values=numbers_at(end.x),
        errors=_Numbers(*errors.tolist()),
        misfit=math.sqrt(mean_square),
    )
