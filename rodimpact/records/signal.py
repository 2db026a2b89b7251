"""A measured or computed time series, with its unit and its name.

>>> import rodimpact as ri
>>> ramp = ri.Signal([0.0, 1.0, 2.0, 2.0, 2.0], dt=1e-6, unit="V", name="incident")
>>> (2 * ramp).shifted(1.0).at(1.0)
0.0

Between samples a signal is linear. Signals are immutable: every method returns another
signal.
"""

from __future__ import annotations

import math
import os
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import units
from ..model.arguments import (
    Array,
    array,
    check_choice,
    check_kind,
    demand,
    float_or_array,
    scalar,
)
from ..model.bodies import Rod, Segment
from ..model.frozen import SMALLEST, Frozen, Number, invalid_argument
from ..model.quantities import Floats, is_integer
from ..storage.extras import optional
from ..storage.tables import heading, write_table
from ..units import shown
from . import filters
from .comparison import Bounds, Misfit, Range, TimeSeries, misfit_of
from .pulses import Pulse, pulse_of

EQUAL_STEP_RTOL = 0.05
"""Largest difference of a time from the time with equal steps, divided by the step.

Times are rounded in files.
"""
RECORD_END_RTOL = 1e-9
"""Largest time beyond an end of a record that counts as this end, over its length."""


class Signal(Frozen):
    """A time series.

    Parameters
    ----------
    values : array, shape (n,)
        Two samples or more, in `unit`.
    times : array, shape (n,), optional
        Times of the samples, increasing, s; or give `dt` instead.
    dt : float, optional
        Time between two samples, s.
    start : float
        Time of the first sample, s, where `dt` is given.
    unit : str
        SI unit of the values: ``"V"``, ``"N"``, ``"m/s"``; ``""`` for strain and other
        dimensionless numbers.
    name : str
        Name of the channel.

    Attributes
    ----------
    times, values : array, shape (n,)
        s and `unit`; read-only.
    unit, name : str

    Raises
    ------
    InvalidModel
        If times do not increase, a sample is not finite, the unit is not an SI unit, or
        another argument is invalid.

    Examples
    --------
    >>> Signal([0.0, 1.0, 1.0], dt=1e-6, unit="V", name="incident")
    Signal(values=array(3,), times=array(3,), unit='V', name='incident')
    """

    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {
        "dt": ("times",),
        "start": ("times",),
    }
    _shared_fields: ClassVar[tuple[str, ...]] = ("values", "times")
    __array_ufunc__: ClassVar[None] = None
    """Arrays leave sums and products to this class, which takes single numbers."""
    values: Floats
    times: Floats
    unit: str
    name: str

    def __init__(
        self,
        values: ArrayLike,
        times: ArrayLike | None = None,
        *,
        dt: float | None = None,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        """Check the arguments, and keep values and times as read-only arrays.

        Without `times`, they are computed from `start` and `dt`. InvalidModel for a
        wrong argument, such as "ms", a known unit that is not an SI unit. An unknown
        unit is accepted.
        """
        _check_word("unit", unit)
        _check_word("name", name)
        conversion = units.conversion(unit)  # None for an unknown unit
        if conversion is not None and conversion.factor != 1:
            si_unit = "units"  # for a dimensionless unit such as "%"
            if conversion.unit:
                si_unit = conversion.unit
            message = f"must be an SI unit, got {shown(unit)}; give the values in "
            factor = float(conversion.factor)
            raise invalid_argument(
                "unit", f"{message}{si_unit}, multiplied by {factor:g}"
            )
        v = _samples("values", values, unit)
        if (times is None) == (dt is None):  # both or neither are given
            raise invalid_argument(
                "times", "give either the times, or dt between two samples"
            )
        if times is None:
            step = scalar("dt", dt, "s", "positive")
            times = scalar("start", start, "s") + step * np.arange(v.size)
        t = _samples("times", times, "s")
        if t.shape != v.shape:
            raise invalid_argument(
                "times", f"must be as many as values, got {t.size} for {v.size}"
            )
        # `demand` puts the first pair that does not increase in place of {0} and {1}.
        demand(
            np.diff(t) > 0,
            "times",
            "must increase, got {1!r} after {0!r}",
            t[:-1],
            t[1:],
        )
        self._set(values=v, times=t, unit=unit, name=name)

    @property
    def start(self) -> float:
        """Time of the first sample, s."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return float(self.times[-1])

    @property
    def dt(self) -> float:
        """Time between two samples, s.

        Raises
        ------
        ValueError
            If the steps are not equal, apart from rounded times.
        """
        count = len(self.times) - 1  # number of steps
        step = (self.end - self.start) / count
        equal = self.start + step * np.arange(count + 1)
        is_off = np.abs(self.times - equal) > EQUAL_STEP_RTOL * step
        if is_off.any():
            i = int(is_off.argmax())
            raise ValueError(
                f"{self._title}: the samples are not at equal steps (sample {i} is at "
                f"{float(self.times[i])!r} s); use resampled(dt)"
            )
        return step

    @property
    def _title(self) -> str:
        """The signal in messages: with its name, if it has one."""
        if self.name:
            return f"signal {self.name!r}"
        return "signal"

    def __len__(self) -> int:
        return len(self.values)

    def at(self, t: ArrayLike) -> Number:
        """Values at times in s, linear between samples; a float for a single time.

        ValueError for a time outside the record. A time that is beyond an end of the
        record by round-off only (`RECORD_END_RTOL`) has the value at this end.
        """
        t = array("t", t, "s")
        slack = RECORD_END_RTOL * (self.end - self.start)
        inside = (t >= self.start - slack) & (t <= self.end + slack)
        # `demand` puts the first value outside in place of {0!r}.
        message = (
            f"must be from {self.start!r} to {self.end!r} s, as the signal is, got "
            "{0!r}"
        )
        demand(inside, "t", message, t)
        return float_or_array(np.interp(t, self.times, self.values))

    def resampled(
        self, dt: float | None = None, *, times: ArrayLike | None = None
    ) -> Signal:
        """Return the signal at steps of `dt`, s, from its start, or at given times.

        The new samples are interpolated linearly. Before you increase the time step,
        remove the frequencies above half of the new sampling rate with `low_pass`.

        Raises
        ------
        ValueError
            If a time lies outside the record, `dt` makes fewer than two samples or too
            many, or if both or neither of `dt` and `times` are given.
        """
        if (dt is None) == (times is None):  # both or neither are given
            raise invalid_argument("dt", "give either dt or times")
        if times is None:
            step = scalar("dt", dt, "s", "positive")
            # `int` rounds this number down; the last factor keeps the last step in
            # spite of round-off.
            steps = (self.end - self.start) / step * (1 + 1e-12)
            if not 1 <= steps < filters.MAX_SAMPLES:
                message = f"{step} makes {steps + 1:.3g} samples of {self._title}"
                raise invalid_argument(
                    "dt", f"{message}; give a dt that makes 2 to {filters.MAX_SAMPLES}"
                )
            times = self.start + step * np.arange(int(steps) + 1)
        return self.replace(values=self.at(times), times=times)

    def shifted(self, delay: float) -> Signal:
        """Return the signal with `delay`, s, added to all times; it may be negative."""
        return self.replace(times=self.times + scalar("delay", delay, "s"))

    def window(self, start: float, end: float) -> Signal:
        """Return the samples from start to end, s, both included.

        ValueError if there are fewer than two.
        """
        inside = self._within(start, end)
        return self.replace(values=self.values[inside], times=self.times[inside])

    def extended(self, before: float = 0.0, after: float = 0.0) -> Signal:
        """Return the signal with samples added over these times, s, at both ends.

        The times are rounded up to whole steps. All samples added before the record
        have its first value, those added after it have its last value. Extend a
        record that begins just before its pulse: `low_pass` and `propagated` widen the
        pulse beyond the record.

        Raises
        ------
        ValueError
            If the samples are not at equal steps, or a time is negative or takes too
            many samples.
        """
        step = self.dt
        n_before = _number_of_steps("before", before, step)
        n_after = _number_of_steps("after", after, step)
        # Steps before the start: n_before, ..., 2, 1
        times_before = self.start - step * np.arange(n_before, 0, -1)
        times_after = self.end + step * np.arange(1, n_after + 1)
        times = np.concatenate((times_before, self.times, times_after))
        values = np.pad(self.values, (n_before, n_after), "edge")
        return self.replace(values=values, times=times)

    def baseline(self, start: float, end: float) -> Signal:
        """Return the whole signal minus its mean value from start to end, s.

        ValueError if fewer than two samples lie between these times.
        """
        return self - float(self.values[self._within(start, end)].mean())

    def _within(self, start: float, end: float) -> Any:
        """Booleans, [sample]: true from time `start` to time `end`, s, both included.

        InvalidModel if there are fewer than two.
        """
        low = scalar("start", start, "s")
        high = scalar("end", end, "s")
        inside = (self.times >= low) & (self.times <= high)
        if inside.sum() < 2:
            message = f"fewer than two samples lie from {low!r} to {high!r} s"
            raise invalid_argument(
                "start, end",
                f"{message}; the {self._title} runs from {self.start!r} to "
                f"{self.end!r} s",
            )
        return inside

    def low_pass(
        self,
        frequency: float,
        kind: Literal["gaussian", "first-order", "second-order"] = "gaussian",
    ) -> Signal:
        """Return the signal without its frequencies above a limit.

        Parameters
        ----------
        frequency : float
            Frequency at which the gain is 1/sqrt(2), Hz; below half of the sampling
            rate.
        kind : str
            ``"gaussian"`` has no delay and suits data. ``"first-order"`` and
            ``"second-order"`` (Butterworth) are amplifiers: their output depends on the
            past only. The filter continues the record with its first value before it
            and with its last value after it. If a record begins with its pulse, call
            `extended` first.

        Raises
        ------
        ValueError
            If the samples are not at equal steps, or an argument is invalid.

        Examples
        --------
        A step through an amplifier of 100 kHz becomes 1 - exp(-2 pi f t):

        >>> step = Signal([0.0, *[1.0] * 99], dt=1e-7)
        >>> round(step.low_pass(100e3, "first-order").at(50e-7), 3)
        0.955
        """
        check_choice("kind", kind, filters.LOW_PASS)
        f = scalar("frequency", frequency, "Hz", "positive")
        if f * self.dt >= 0.5:  # half of the sampling rate, 1/dt
            rate = units.format_si(1 / self.dt, "Hz")
            raise invalid_argument(
                "frequency", f"must be below half of the sampling rate, {rate}, got {f}"
            )
        filtered = filters.LOW_PASS[kind](self.values, self.dt, f)
        return self.replace(values=filtered)

    def propagated(
        self, distance: float, bar: Any, *, radius: float | None = None
    ) -> Signal:
        """Return the pulse at another position on a round bar, by the exact first mode.

        Each frequency of the record runs at its own phase velocity. Frequencies above
        the cut-off of the first mode, `waves.CUT_OFF`, are removed, in both directions.
        The sample times include the travel time of long waves.

        Parameters
        ----------
        distance : float
            m; negative towards the origin of the pulse.
        bar : waves.Bar, Rod or Segment
            A rod must fulfil the conditions of `waves.Bar.of`.
        radius : float, optional
            Equivalent radius of a rod that is not round, m.

        Raises
        ------
        InvalidModel
            If the rod is not uniform, is not declared round, or has no Poisson ratio.
        ValueError
            If the samples are not at equal steps, or the distance is too long for their
            time step.

        Notes
        -----
        A. Tyas and A. J. Watson, An investigation of frequency domain dispersion
        correction of pressure bar signals, International Journal of Impact Engineering
        25 (2001) 87. Differences of the amplitude over the cross-section are not
        corrected.
        """
        from .. import waves

        z = scalar("distance", distance, "m")
        if isinstance(bar, Rod | Segment):
            bar = waves.Bar.of(bar, radius)
        elif radius is not None:
            raise invalid_argument(
                "radius", "belongs to a rod; a waves.Bar has its own"
            )
        check_kind(
            "bar",
            bar,
            waves.Bar,
            "waves.Bar(wave_speed=5000, poisson_ratio=0.3, radius=0.01)",
        )
        # `dispersed` changes the shape only; the travel time of long waves is added to
        # the times.
        values = filters.dispersed(self.values, self.dt, z, bar)
        return self.replace(values=values, times=self.times + z / bar.wave_speed)

    def as_measured(
        self,
        *,
        gauge_length: float = 0.0,
        wave_speed: float | None = None,
        bandwidth: float | None = None,
        order: int = 1,
        scale: float = 1.0,
        offset: float = 0.0,
    ) -> Signal:
        """Return a computed signal as a gauge and its amplifier would record it.

        The gauge averages first; then the amplifier filters, scales and shifts the
        signal.

        Parameters
        ----------
        gauge_length : float
            Length over which the gauge averages, m.
        wave_speed : float, optional
            Speed at which the pulse passes the gauge, m/s; needed with a gauge length.
        bandwidth : float, optional
            Frequency at which the gain of the amplifier is 1/sqrt(2), Hz.
        order : int
            Order of the amplifier: 1, or 2 (Butterworth).
        scale, offset : float
            The record is ``scale * signal + offset``; the offset is in `unit`.

        Raises
        ------
        ValueError
            If an argument is invalid.
        """
        signal = self
        length = scalar("gauge_length", gauge_length, "m", "non-negative")
        if not is_integer(order) or order not in (1, 2):
            raise invalid_argument("order", f"must be 1 or 2, got {shown(order)}")
        if length or wave_speed is not None:  # `scalar` refuses a missing speed
            c = scalar("wave_speed", wave_speed, "m/s", "positive")
            averaged = filters.averaged(self.values, self.times, length / c)
            signal = self.replace(values=averaged)
        if bandwidth is not None:
            kind: Literal["first-order", "second-order"] = "first-order"
            if order == 2:
                kind = "second-order"
            signal = signal.low_pass(bandwidth, kind)
        return signal * scalar("scale", scale, "") + scalar("offset", offset, self.unit)

    def pulse(self) -> Pulse:
        """Timing of the pulse that contains the largest absolute value.

        Cut other pulses off with `window`.

        Raises
        ------
        ValueError
            If the signal is 0 everywhere, is not below a tenth of its plateau before
            the pulse, or not below half of it after the pulse.

        Examples
        --------
        >>> times = [0, 2e-6, 4e-6, 10e-6, 12e-6, 14e-6, 20e-6]
        >>> trapezoid = Signal([0, 0, 1, 1, 1, 0, 0], times)
        >>> pulse = trapezoid.pulse()
        >>> round(pulse.width * 1e6, 9), round(pulse.rise * 1e6, 9), pulse.plateau
        (10.0, 1.6, 1.0)
        """
        try:
            return pulse_of(self.times, self.values)
        except ValueError as error:
            raise ValueError(f"{self._title}: {error}") from None

    def misfit(
        self, other: Signal, *, shift: Bounds | None = None, scale: Bounds | None = None
    ) -> Misfit:
        """Misfit of another signal to this one, with the best shift and scale.

        Parameters
        ----------
        other : Signal
            The prediction. It is continued by its first value before its start and by
            its last value after its end.
        shift : float or (float, float), optional
            Delay of the prediction, s: a fixed value, or bounds. By default the delay
            with the smallest misfit at which the two signals overlap.
        scale : float or (float, float), optional
            Factor of the prediction: a fixed value, or bounds. By default the factor
            with the smallest misfit; it may convert units, such as volts to strain.

        Returns
        -------
        Misfit
            Its `rms` is the root mean square of the difference, divided by the plateau
            of this signal: the median of the samples above 0.7 of the largest.

        Raises
        ------
        ValueError
            If a scale is given and the units differ, if this signal is 0 everywhere, or
            if bounds are not two increasing numbers.

        Examples
        --------
        >>> shape = Signal(np.hanning(101), dt=1e-6)
        >>> fit = shape.misfit(0.5 * shape.shifted(-7.3e-6))
        >>> fit.rms < 1e-2, round(fit.scale, 2), round(fit.shift * 1e6, 1)
        (True, 2.0, 7.3)
        """
        check_kind("other", other, Signal, "solution.gauge(1, 0.5).signal(1e-7)")
        if scale is not None:
            self._require_same_unit(
                other, what_cannot_be="compared with a fixed scale; leave scale out"
            )
        return misfit_of(
            TimeSeries(self.times, self.values),
            TimeSeries(other.times, other.values),
            bounds_of("shift", shift, "s"),
            bounds_of("scale", scale, ""),
        )

    def _require_same_unit(self, other: Signal, what_cannot_be: str) -> None:
        """Raise ValueError unless both signals have the same unit.

        The message ends with "they cannot be" and the text `what_cannot_be`.
        """
        if self.unit != other.unit:
            raise ValueError(
                f"{self._title} is in {_unit_text(self.unit)} and {other._title} in "
                f"{_unit_text(other.unit)}; they cannot be {what_cannot_be}"
            )

    def _operand(self, other: Any, done: str) -> Any:
        """The addend: a number in `self.unit`, or the array of values of a signal.

        ValueError for a signal of another unit or with other times, and for an array.
        `done` is the participle in error messages: "added" or "subtracted".
        """
        if not isinstance(other, Signal):
            return _single_number(other, self.unit)
        self._require_same_unit(other, what_cannot_be=done)
        if not np.array_equal(self.times, other.times):
            raise ValueError(
                f"{self._title} and {other._title} have different times; use "
                f".resampled(times=...) with the times of one before they are {done}"
            )
        return other.values

    def __add__(self, other: Signal | float) -> Signal:
        return self.replace(values=self.values + self._operand(other, "added"))

    def __sub__(self, other: Signal | float) -> Signal:
        return self.replace(values=self.values - self._operand(other, "subtracted"))

    def __mul__(self, number: float) -> Signal:
        return self.replace(values=self.values * _single_number(number, ""))

    def __truediv__(self, number: float) -> Signal:
        """The signal divided by a dimensionless number.

        InvalidModel for a number whose absolute value is below `SMALLEST`, and for an
        array or another signal.
        """
        divisor = _single_number(number, "")
        # The doubled braces leave {0!r} in the text, which `demand` replaces.
        message = f"must not be 0, but {SMALLEST:g} or more in size, got {{0!r}}"
        demand(abs(divisor) >= SMALLEST, "number", message, divisor)
        return self.replace(values=self.values / divisor)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Signal:
        return self * -1.0

    def __rsub__(self, number: float) -> Signal:
        return -self + number

    def to_csv(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write a table of times and values with units in the heads.

        Raises
        ------
        FileExistsError
            If the file exists and `force` is false.
        InvalidModel
            If the name of the signal cannot be a head of the table.
        """
        name = self.name if self.name else "signal"
        headers = (heading("time", "s"), heading(name, self.unit))
        columns = (self.times, self.values)
        write_table(path, headers, [columns], force=force)  # all rows in one block

    def to_dataframe(self) -> Any:
        """The signal as a pandas DataFrame (extra ``dataframe``).

        The columns are ``time`` and the name of the signal, or ``signal``. The units of
        both are in ``attrs["units"]``.

        Examples
        --------
        >>> import rodimpact as ri
        >>> force = ri.Signal([0.0, 5.0], [0.0, 1e-6], unit="N", name="force")
        >>> frame = force.to_dataframe()
        >>> frame["force"].tolist(), frame.attrs["units"]
        ([0.0, 5.0], {'time': 's', 'force': 'N'})
        """
        pandas = optional("pandas", "dataframe")
        name = self.name if self.name else "signal"
        frame = pandas.DataFrame({"time": self.times, name: self.values})
        frame.attrs["units"] = {"time": "s", name: self.unit}
        return frame

    def to_xarray(self) -> Any:
        """Return an xarray DataArray over ``time``, with units (extra ``xarray``).

        The name of the array is that of the signal, or None for an empty name. The
        attribute ``units`` is "1" for a dimensionless signal; ``long_name`` is the
        name, or "signal".
        """
        xarray = optional("xarray", "xarray")
        time = ("time", self.times, {"long_name": "time", "units": "s"})
        attributes = {"long_name": "signal", "units": "1"}
        name = None
        if self.name:
            name = self.name
            attributes["long_name"] = name
        if self.unit:
            attributes["units"] = self.unit
        return xarray.DataArray(self.values, {"time": time}, "time", name, attributes)

    @classmethod
    def from_xarray(cls, data: Any) -> Signal:
        """Make a signal in SI units, with the same name, from a DataArray over time.

        The array and its time coordinate must have an attribute ``units``.

        Raises
        ------
        ValueError
            If the DataArray does not have one dimension, if units are missing or
            unknown, or if the coordinate is not a time. The error may be an
            InvalidModel, which is a ValueError.
        """
        if len(getattr(data, "dims", ())) != 1:
            raise invalid_argument(
                "data", f"must be a DataArray of one dimension, got {shown(data)}"
            )
        axis = data[data.dims[0]]
        times, time_unit = units.in_si(axis.values, axis.attrs.get("units"))
        values, unit = units.in_si(data.values, data.attrs.get("units"))
        if time_unit != "s":
            message = "must be times, with .attrs['units'] = 's'"
            raise invalid_argument(
                data.dims[0], f"{message}, got {shown(axis.attrs['units'])}"
            )
        name = ""
        if data.name:
            name = str(data.name)
        return cls(values, times, unit=unit, name=name)


def signal_of(values: Floats, times: Floats, unit: str, name: str) -> Signal:
    """A signal that holds these arrays themselves, not copies, to save memory.

    The caller has checked the arrays and made them read-only; they are not changed
    later.
    """
    # Signal.__init__, which copies the arrays, is not called.
    signal = object.__new__(Signal)
    signal._set(values=values, times=times, unit=unit, name=name)
    return signal


def _single_number(number: Any, unit: str) -> float:
    """A term or factor for all samples as a float; a quantity is converted to `unit`.

    InvalidModel for an array, and for an argument that is not a number.
    """
    checked = array("number", number, unit, "any")
    if checked.ndim:
        message = "must be a single number or a signal; make a signal of an array"
        raise invalid_argument(
            "number", f"{message} by replace(values=...), got {shown(number)}"
        )
    return checked.item()


def _samples(name: str, numbers: Any, unit: str) -> Array:
    """Samples in this unit as a new read-only array, shape (n,).

    InvalidModel, which names the argument `name`, for fewer than two samples, and for
    samples that are not finite.
    """
    samples = array(name, numbers, unit, "any")
    if samples.ndim != 1 or samples.size < 2:
        raise invalid_argument(
            name, f"must be a list of two or more numbers, got {shown(numbers)}"
        )
    samples.flags.writeable = False
    return samples


def _check_word(name: str, word: Any) -> None:
    """Raise InvalidModel unless the argument is a printable text; "" is allowed."""
    if not isinstance(word, str) or not word.isprintable():
        raise invalid_argument(name, f"must be a word, got {shown(word)}")


def _unit_text(unit: str) -> str:
    """Name of a unit in messages; "pure numbers" for ""."""
    if unit:
        return unit
    return "pure numbers"


def _number_of_steps(name: str, duration: Any, step: float) -> int:
    """Least number of steps of `step`, s, that cover a duration, s.

    InvalidModel, which names the argument `name`, if the duration is negative or takes
    `MAX_SAMPLES` steps or more.
    """
    steps = scalar(name, duration, "s") / step  # not rounded yet
    if not 0 <= steps < filters.MAX_SAMPLES:
        message = f"must be 0 or more, and at most {filters.MAX_SAMPLES} samples"
        raise invalid_argument(name, f"{message}, got {duration}")
    return math.ceil(steps * (1 - 1e-12))  # the factor: round-off must not add a step


def bounds_of(name: str, bounds: Any, unit: str) -> Range | None:
    """The pair (lower bound, upper bound) in `unit`; None stays None.

    A single number is both bounds. InvalidModel, which names the argument `name`, for
    anything else than one number, or two numbers of which the first is not the larger.
    """
    if bounds is None:
        return None
    ends = array(name, bounds, unit, "any")
    if ends.ndim == 0:
        return ends.item(), ends.item()
    if ends.shape != (2,) or ends[0] > ends[1]:
        raise invalid_argument(
            name, f"must be a number, or (low, high), got {shown(bounds)}"
        )
    return float(ends[0]), float(ends[1])
