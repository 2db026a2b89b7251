"""Profiles of a quantity along a rod or over time: jumps, samples and functions.

A profile is a number, `Steps`, `Samples`, `Polynomials`, or a function. A function
becomes `Samples` when the body or the end is made, so that only numbers are stored and
compared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY
from functools import reduce
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from ..units import one_line, shown
from . import frozen
from .frozen import (
    FrozenDataclass,
    Number,
    NumericOrNone,
    Problems,
    QuantityField,
    add_problem,
    quantity,
)
from .quantities import Floats as Floats
from .quantities import floats

SAMPLES_ALONG_ROD = 1025
"""Number of places at which a function along a rod is sampled."""
SAMPLES_IN_TIME = 4097
"""Number of times at which a function of time is sampled."""
JUMP_RTOL = 1e-9
"""Round-off of a jump between polynomials, relative to their largest value."""
SPLINE_DEGREE = 5
"""Degree of the spline through smooth samples."""
ERROR = QuantityField(sign="non-negative", scalar=True)
"""Error of the values of a profile."""
DURATION = QuantityField("s", "positive", default=None, scalar=True)
"""Time for which a function of time is sampled."""


class Steps(FrozenDataclass):
    """A profile that is constant between jumps, along a rod or in time.

    Parameters
    ----------
    values : sequence of numbers
        One value for each piece, from left to right or from t = 0 on.
    at : sequence of numbers
        Positions of the jumps, m from the left end of the rod, or times of the jumps,
        s. They increase. Their number is the number of values minus one.

    Raises
    ------
    InvalidModel
        When the counts do not fit, the positions do not increase, or a value is not a
        number.

    Examples
    --------
    The left half of a rod of 1 m moves, the right half rests:

    >>> Steps([1.0, 0.0], at=[0.5])
    Steps(values=(1.0, 0.0), at=(0.5,))
    """

    values: Sequence[Any] = quantity("", "sampled", many=True)
    at: Sequence[Any] = quantity("", "positive", many=True)

    def _check(self, problems: Problems) -> None:
        """Add a problem unless jumps increase, and there is one value more than jumps.

        Nothing is checked if there are other problems.
        """
        if problems:
            return
        n_values = len(self.values)
        n_jumps = len(self.at)
        if n_values == n_jumps + 1:
            frozen.require_increasing(problems, "at", self.at)
        else:
            message = (
                f"needs one value more than jumps, got {n_values} values for "
                f"{n_jumps} jumps"
            )
            problems.append(("values", message))


def _is_zero(error: object) -> bool:
    """Whether an error is the float 0; an unchecked error may be any object."""
    return isinstance(error, float) and error == 0.0


class Samples(FrozenDataclass):
    """A profile of values at equal distances.

    Straight lines or a smooth curve connect the values. Along a rod the values are
    given from its left end to its right end. In time the first value belongs to t = 0,
    and the last value continues. A function is converted to samples, with a smooth
    curve if this is more accurate.

    Parameters
    ----------
    values : sequence of numbers, shape (n,)
        At least two; all members of a family share them.
    step : float or array, optional
        Time between neighbouring values, s; None along a rod.
    smooth : bool
        Whether a spline of degree 5 runs through the values, for the method
        "characteristics".
    error : float
        Largest difference between the curve and the sampled function, in the unit of
        the values. The stated errors of "characteristics" include it.

    Raises
    ------
    InvalidModel
        When there are fewer than two values, or one is not a number.

    Examples
    --------
    >>> Samples([0.0, 2e3, 0.0], step=1e-4)
    Samples(values=array(3,), step=0.0001)
    """

    values: Any = quantity("", "sampled")
    step: NumericOrNone = quantity("s", "positive", default=None)
    _: KW_ONLY
    smooth: bool = False
    error: float = 0.0
    _shared_fields: ClassVar[tuple[str, ...]] = ("values", "error")

    def _check(self, problems: Problems) -> None:
        """Check and set the error; add problems of the values and of `smooth`.

        The values must be two or more, in one dimension. `smooth` must be a bool.
        """
        is_list = np.ndim(self.values) == 1 and len(self.values) > 1
        if not problems and not is_list:
            wanted = "must be a list of at least two numbers"
            add_problem(problems, "values", wanted, frozen.json_ready(self.values))
        smooth: Any = self.smooth
        if not isinstance(smooth, bool):
            add_problem(problems, "smooth", "must be True or False", smooth)
        self._set(error=ERROR.checked(problems, "error", self.error))

    def _parameters(self) -> dict[str, Any]:
        """Parameters of the constructor, without `smooth` at False and error at 0."""
        parameters = super()._parameters()
        if parameters.get("smooth") is False:
            del parameters["smooth"]
        if _is_zero(parameters.get("error")):
            del parameters["error"]
        return parameters

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return _renamed(super().to_dict(), "samples")


class Polynomials(FrozenDataclass):
    """A profile of polynomials along a rod, with jumps or kinks between them.

    `Solution.system_at` represents smooth waves exactly by polynomials. In an interval
    of width w that begins at x0, the n values belong to the places x_k = x0 + w (1 -
    cos(pi k/(n - 1)))/2, k = 0 to n - 1. The first and the last value are those at the
    ends of the interval.

    Parameters
    ----------
    values : sequence of numbers, shape (intervals * n,)
        Values interval by interval from left to right, equally many in each, at least
        two.
    at : sequence of numbers, shape (intervals - 1,), optional
        Borders of the intervals, m from the left end of the rod, increasing; None for
        one interval.
    error : float
        Error of the values, in their unit: the stated error of the run from which they
        come. The stated errors of "characteristics" include it.

    Raises
    ------
    InvalidModel
        When the counts do not fit, the borders do not increase, or a value is not a
        number.

    Examples
    --------
    A rod of 1 m whose left half rests, and whose right half moves the faster the
    farther right:

    >>> Polynomials([0.0, 0.0, 0.0, 0.5], at=[0.5])
    Polynomials(values=array(4,), at=array(1,))
    """

    values: Any = quantity("", "sampled")
    at: Any = quantity("", "sampled", default=None)
    _: KW_ONLY
    error: float = 0.0
    _shared_fields: ClassVar[tuple[str, ...]] = ("values", "at", "error")

    def _check(self, problems: Problems) -> None:
        """Check and set the error; add problems of the values and the borders.

        All intervals must have the same number of values, two or more, and borders must
        increase. After other problems only the error is checked.
        """
        self._set(error=ERROR.checked(problems, "error", self.error))
        if problems:
            return
        n_intervals = len(self.inner) + 1
        n_values = np.size(self.values)
        if n_values % n_intervals != 0 or n_values < 2 * n_intervals:
            message = (
                f"needs two values or more, as many for each of {n_intervals} intervals"
            )
            problems.append(("values", f"{message}, got {n_values}"))
        frozen.require_increasing(problems, "at", self.inner)

    @property
    def inner(self) -> list[float]:
        """Borders between intervals, m; an empty list for one interval."""
        if self.at is None:
            return []
        borders: list[float] = np.ravel(self.at).tolist()
        return borders

    def coefficients(self) -> Floats:
        """Chebyshev coefficients of the polynomials.

        Returns
        -------
        [interval, degree] array
            Coefficients of T_k(y), with y from -1 to 1 in each interval.

        Examples
        --------
        >>> Polynomials([0.0, 1.0]).coefficients().round(12).tolist()
        [[0.5, 0.5]]
        """
        n_intervals = len(self.inner) + 1
        values = np.asarray(self.values, dtype=float).reshape(n_intervals, -1)
        n = values.shape[1]  # values of an interval, at Chebyshev points
        y = -np.cos(np.pi * np.arange(n) / (n - 1))  # places of the values, -1 to 1
        coefficients_to_values = chebyshev.chebvander(y, n - 1)  # T_k(y), [place, k]
        values_to_coefficients = np.linalg.inv(coefficients_to_values)  # [k, place]
        coefficients: Floats = values @ values_to_coefficients.T
        return coefficients

    def _parameters(self) -> dict[str, Any]:
        """Parameters of the constructor, without the error if it is 0."""
        parameters = super()._parameters()
        if _is_zero(parameters.get("error")):
            del parameters["error"]
        return parameters

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return _renamed(super().to_dict(), "polynomials")


def _renamed(description: dict[str, Any], key: str) -> dict[str, Any]:
    """Description of a profile with the key "values" renamed to `key`, as first entry.

    The entry "values" is removed from the given description.
    """
    renamed = {key: description.pop("values")}
    renamed.update(description)
    return renamed


Profile: TypeAlias = "Number | Steps | Samples | Polynomials"
ProfileLike: TypeAlias = (
    "ArrayLike | Steps | Samples | Polynomials | Callable[[Any], Any]"
)


def checked_along_rod(
    problems: Problems,
    path: str,
    value: Any,
    field: QuantityField,
    length: Number | None,
) -> Profile:
    """Check a value as a profile along a rod; return it, a function as `Samples`.

    Parameters
    ----------
    problems : list
        Mistakes are noted in it.
    path : str
        Path of the value.
    value : object
        A number, `Steps`, `Samples`, `Polynomials` or a function. `Samples` may not
        have a step. A function is sampled at `SAMPLES_ALONG_ROD` places from end to
        end; it is a mistake if the length is an array.
    field : QuantityField
        Unit and sign of the values; those of `Steps` and `Polynomials` may have any
        sign.
    length : float or array, optional
        Length of the rod, m, inside which jumps must lie. None if a mistake elsewhere
        leaves it unknown: then neither jumps nor a function are checked.

    Returns
    -------
    float, array, Steps, Samples or Polynomials
        After a mistake it is meaningless; a function is returned as it is if the length
        is unknown.
    """
    profile: Profile = value
    if isinstance(value, Steps | Polynomials):
        if length is not None:
            _check_inside(problems, path, value, length)
    elif isinstance(value, Samples):
        if value.step is not None:
            message = (
                "is for samples in time; those of a rod run from end to end; leave it "
                "out"
            )
            problems.append((f"{path}.step", message))
        if field.sign != "any":  # `Samples` has checked that these are numbers
            field.checked(problems, f"{path}.values", value.values)
    elif not callable(value):
        profile = field.checked(problems, path, value)
    elif isinstance(length, np.ndarray):
        message = (
            "is a function, but the members of the family differ in length; give "
            "Samples"
        )
        problems.append((path, message))
    elif length is not None:
        x = np.linspace(0.0, length, SAMPLES_ALONG_ROD)
        profile = _samples_of(problems, path, value, x, field=field, step=None)
    return profile


def _check_inside(
    problems: Problems, path: str, profile: Steps | Polynomials, length: Number
) -> None:
    """Add a problem unless the last jump or border of a profile lies inside the rod.

    A profile without jumps is always accepted. In a family this must hold for every
    member. InvalidModel if the numbers of `Steps` and the length do not broadcast.
    """
    if isinstance(profile, Steps):
        places = list(profile.at)
    else:
        places = profile.inner
    if not places:
        return
    if isinstance(profile, Steps):
        # Numbers of steps may be arrays, and the call raises if they do not broadcast
        # with the length. The numbers of polynomials are the same in all members.
        numbers = [("length", length), *profile._numbers(path)]
        frozen.family_shape(numbers)
    last = places[-1]
    is_inside = np.asarray(last) < length
    message = "must lie inside the rod of length {0!r}, got {1!r}"
    last_path = f"{path}.at.{len(places) - 1}"
    frozen.require(problems, is_inside, last_path, message, length, last)


def in_time(
    value: Any, field: QuantityField, duration: Any, name: str = "value"
) -> Profile:
    """Check the value of a driven end as a profile in time, from t = 0; return it.

    A function becomes `Samples`; `Steps` and `Samples` are returned unchanged.

    Parameters
    ----------
    value : object
        A number, `Steps`, `Samples` or a function. `Samples` need a step, s. A function
        is sampled at `SAMPLES_IN_TIME` times from 0 to the duration.
    field : QuantityField
        Unit and sign of a number, and of the values of a function.
    duration : float, optional
        Time for which a function is sampled, s; it is a mistake with any other value.
    name : str
        Path of mistakes in the value.

    Returns
    -------
    float, array, Steps or Samples

    Raises
    ------
    InvalidModel
        Naming every mistake.
    """
    problems: Problems = []
    profile: Profile = value
    if callable(value):
        if duration is None:
            message = (
                "is missing; give the seconds for which the function is to be sampled"
            )
            problems.append(("duration", message))
        end = DURATION.checked(problems, "duration", duration)
        if not problems:
            times = np.linspace(0.0, end, SAMPLES_IN_TIME)
            step = end / (SAMPLES_IN_TIME - 1)
            profile = _samples_of(problems, name, value, times, field=field, step=step)
    else:
        if duration is not None:
            message = "belongs to a function of time; leave it out"
            add_problem(problems, "duration", message, duration)
        if isinstance(value, Samples) and value.step is None:
            message = "is missing; give the seconds between two samples"
            problems.append((f"{name}.step", message))
        if not isinstance(value, Steps | Samples):
            profile = field.checked(problems, name, value)
    frozen.raise_if_problems(problems)
    return profile


def latest_border(profile: Any) -> float:
    """Time of the last border between polynomials of a profile in time, s.

    0 for one polynomial and for any other profile.
    """
    if isinstance(profile, Polynomials):
        return max(profile.inner, default=0.0)
    return 0.0


def jumps_inside(profile: Any) -> bool:
    """Whether steps, or neighbouring polynomials, jump by more than round-off.

    The result is True for `Steps`, and False for numbers and samples. Round-off is
    `JUMP_RTOL` times the largest magnitude of the values.
    """
    if isinstance(profile, Steps):
        return True
    if not isinstance(profile, Polynomials):
        return False
    n_intervals = len(profile.inner) + 1
    values = np.reshape(profile.values, (n_intervals, -1))  # [interval, place]
    # From the last value of each interval to the first value of the next one
    jumps = np.abs(values[1:, 0] - values[:-1, -1])
    return bool(np.any(jumps > JUMP_RTOL * np.abs(values).max()))


def negative(profile: Profile) -> Profile:
    """Return the profile, or the number, with the opposite sign of all its values."""
    if isinstance(profile, Steps | Samples | Polynomials):
        values = [-value for value in profile.values]
        return profile.replace(values=values)
    return -profile


def scaled(profile: Profile, factor: float) -> Profile:
    """Return the profile, or the number, with all its values times a factor.

    The stated error of samples and polynomials is multiplied by abs(factor).
    """
    if isinstance(profile, Steps | Samples | Polynomials):
        changed: dict[str, Any] = {}
        changed["values"] = [value * factor for value in profile.values]
        if not isinstance(profile, Steps):
            changed["error"] = profile.error * abs(factor)
        return profile.replace(**changed)
    return profile * factor


def flipped(profile: Profile, length: Number) -> Profile:
    """Return the profile along a rod of that length, m, seen from the other end.

    The values are in the opposite order, and places are measured from the other end. A
    piece of `Steps` whose new width is 0 by round-off is left out. A number is returned
    as it is.
    """
    if isinstance(profile, Samples):
        return profile.replace(values=profile.values[::-1])
    if isinstance(profile, Polynomials):
        borders = None
        if profile.at is not None:
            borders = np.asarray(length) - profile.at[::-1]
        return profile.replace(values=profile.values[::-1], at=borders)
    if not isinstance(profile, Steps):
        return profile
    edges: list[Number] = [0.0]  # of the pieces, seen from the other end
    for x in reversed(profile.at):
        edges.append(length - x)
    edges.append(length)
    values = []
    starts = []
    for i, value in enumerate(reversed(profile.values)):
        # Round-off can make two edges equal. A piece without width in any member is
        # left out.
        has_width = np.any(np.asarray(edges[i + 1]) > edges[i])
        if has_width:
            values.append(value)
            starts.append(edges[i])
    return Steps(values, starts[1:])  # the first start, x = 0, is no jump


def extremes(profile: Profile) -> list[Any]:
    """Smallest and largest value of a profile, [smallest, largest].

    They are floats, or arrays over the members if `Steps` or a number vary in a family.
    Only stored values are compared: between them `Polynomials` may be a little smaller
    or larger.
    """
    if isinstance(profile, Samples | Polynomials):
        smallest = float(np.min(profile.values))
        largest = float(np.max(profile.values))
        return [smallest, largest]
    values: Any = [profile]
    if isinstance(profile, Steps):
        values = profile.values
    return [reduce(np.minimum, values), reduce(np.maximum, values)]


def averages(profile: Any, edges: Any, length: float) -> Floats:
    """Mean values of a profile between neighbouring edges.

    Beyond their ends, steps and samples keep their first and last value; polynomials
    count as 0 there.

    Parameters
    ----------
    profile : float, Steps, Samples or Polynomials
        Its numbers are those of a single rod.
    edges : [n + 1] array
        Increasing places, m, or times, s; their order is not checked.
    length : float
        Length of the rod, m, for polynomials and for samples without a step, which run
        from end to end.

    Returns
    -------
    [n] array
        Exact for jumps, polynomials, and straight lines between samples.

    Examples
    --------
    >>> edges = np.array([0.0, 0.5, 2.0])
    >>> averages(Samples([0.0, 1.0, 4.0]), edges, length=2.0).round(9).tolist()
    [0.25, 1.916666667]
    """
    if isinstance(profile, Polynomials):
        return _averages_of_polynomials(profile, edges, length)
    if isinstance(profile, Samples):
        return _averages_of_samples(profile, edges, length)
    if isinstance(profile, Steps):
        return _averages_of_steps(profile, edges)
    # A number is a single step without jumps.
    return _averages_of_steps(Steps([profile], []), edges)


def _averages_of_steps(steps: Steps, edges: Floats) -> Floats:
    """Mean values of steps between n + 1 edges, m or s, shape (n,).

    The first and the last value hold outside the jumps.
    """
    jumps = np.array(steps.at, dtype=float)
    values = np.array(steps.values, dtype=float)  # value i ends at jump i
    # Indices of the values just right of the left edge and just left of the right edge
    # of each interval. So a jump on an edge lies inside neither of its two intervals.
    first = np.searchsorted(jumps, edges[:-1], side="right")
    last = np.searchsorted(jumps, edges[1:], side="left")
    means: Floats = values[first]  # of intervals without a jump
    has_jump = last > first
    for i in np.flatnonzero(has_jump):
        start = edges[i]
        stop = edges[i + 1]
        inner_jumps = jumps[first[i] : last[i]]
        inner_values = values[first[i] : last[i] + 1]  # one more than jumps
        cuts = np.concatenate(([start], inner_jumps, [stop]))
        integral = np.sum(inner_values * np.diff(cuts))
        means[i] = integral / (stop - start)
    return means


def _averages_of_samples(samples: Samples, edges: Floats, length: float) -> Floats:
    """Mean values of lines between samples, between n + 1 edges, shape (n,).

    Samples without a step are spread over `length`, m, from end to end. Outside, the
    first and the last sample hold. Every interval is cut at the samples inside it, and
    the trapezia of its parts are added. The shape is (0,) for fewer than two edges.
    """
    # Differences of one integral from x = 0 would lose small values beside values that
    # are 1e20 times as large.
    if len(edges) < 2:
        return np.zeros(0)
    values = np.asarray(samples.values, dtype=float)
    if samples.step is None:
        width = length / (len(values) - 1)
    else:
        width = float(samples.step)
    knots = width * np.arange(len(values))  # places of the samples
    first = np.searchsorted(knots, edges[0], side="right")
    stop = np.searchsorted(knots, edges[-1], side="left")
    inner = knots[first:stop]  # between the first and the last edge
    # The edges and the samples between them, in order
    cuts = np.insert(edges, np.searchsorted(edges, inner), inner)
    heights = np.interp(cuts, knots, values)
    mean_heights = (heights[1:] + heights[:-1]) / 2
    trapezia = mean_heights * np.diff(cuts)
    first_parts = np.searchsorted(cuts, edges[:-1])  # first part of each interval
    # `reduceat` adds the trapezia from the first part of each interval up to the first
    # part of the next one.
    integrals = np.add.reduceat(trapezia, first_parts)
    return np.asarray(integrals / np.diff(edges))


def _averages_of_polynomials(
    profile: Polynomials, edges: Floats, length: float
) -> Floats:
    """Mean values of polynomials along a rod between n + 1 edges, shape (n,).

    `length` is that of the rod, m; outside of it the values count as 0. The means are
    differences of the integral from x = 0, divided by the distances of the edges. In an
    interval of width w, this integral is its value at the left border plus w/2 times a
    primitive in y, where y runs from -1 to 1 and dx = (w/2) dy.
    """
    borders = np.concatenate(([0.0], profile.inner, [length]))
    widths = np.diff(borders)
    # Primitives that are 0 at y = -1, [interval, degree]. Every T_k(1) is 1, so that at
    # y = 1, the end of the interval, the primitive is the sum of its coefficients.
    primitives = chebyshev.chebint(profile.coefficients(), lbnd=-1, axis=1)
    integrals = primitives.sum(axis=1) * widths / 2
    integral_to_border = np.concatenate(([0.0], np.cumsum(integrals)))
    x = np.clip(edges, 0.0, length)
    # Index of the interval in which each edge lies; the end of the rod is in the last.
    i = np.searchsorted(borders, x, side="right") - 1
    i = np.clip(i, 0, len(widths) - 1)
    y = 2 * (x - borders[i]) / widths[i] - 1  # place in the interval, -1 to 1
    # Each edge has the series of its own interval, [degree, edge].
    primitive = chebyshev.chebval(y, primitives[i].T, tensor=False)
    integral = integral_to_border[i] + primitive * widths[i] / 2
    means: Floats = np.diff(integral) / np.diff(edges)
    return means


def profile_from(data: Any) -> Any:
    """Make the profile that `to_dict` described.

    The kind of profile follows from the key "polynomials", "samples" or "values". All
    other data, such as a number or a dictionary without these keys, are returned as
    they are.
    """
    if not isinstance(data, dict):
        return data
    if "polynomials" in data:
        error = data.get("error", 0.0)
        return Polynomials(data["polynomials"], data.get("at"), error=error)
    if "samples" in data:
        parameters = dict(data)
        values = parameters.pop("samples")
        return Samples(values, **parameters)
    if "values" in data:
        return Steps(**data)
    return data


def _samples_of(
    problems: Problems,
    path: str,
    function: Any,
    places: Floats,
    *,
    field: QuantityField,
    step: float | None,
) -> Profile:
    """Samples of a function at places, m, or times, s, at equal distances.

    The curve between them is a spline (`smooth`) or straight lines, whichever is nearer
    to the function half way between the samples. The largest difference there is the
    error of the samples. `step` is the time between samples, s; None along a rod. A
    mistake is added to `problems`, and 0.0 is returned.
    """
    from scipy.interpolate import make_interp_spline

    middles = (places[1:] + places[:-1]) / 2
    try:
        values = _values_of(function, places, field)
        exact_values = _values_of(function, middles, field)
    except ValueError as error:
        problems.append((path, str(error)))
        return 0.0
    # Values of both curves at the middles
    spline_values = make_interp_spline(places, values, SPLINE_DEGREE)(middles)
    line_values = (values[1:] + values[:-1]) / 2
    spline_error = float(np.max(np.abs(spline_values - exact_values)))
    lines_error = float(np.max(np.abs(line_values - exact_values)))
    return Samples(
        values,
        step,
        smooth=spline_error < lines_error,
        error=min(spline_error, lines_error),
    )


def _values_of(
    function: Callable[[Any], Any], places: Floats, field: QuantityField
) -> Floats:
    """Values of a function at places, in the unit of a field.

    The function is called with a copy of the array of places. If it fails then, or
    returns an array of another shape, it is called with one place after another.
    ValueError if a value is no number, not of the sign of the field, or too large.
    """
    try:
        values = floats(function(places.copy()), field.unit)
    except Exception:
        values = np.zeros(0)  # of a wrong shape
    if values.shape != places.shape:
        values = _values_one_by_one(function, places, field)
    is_allowed = (np.abs(values) <= frozen.LARGEST) & field.holds(values)
    if not is_allowed.all():
        x = float(places[~is_allowed][0])
        value = float(values[~is_allowed][0])
        kind = "finite"
        if field.sign == "positive":
            kind = "positive"
        raise ValueError(
            f"must be a function that returns {kind} numbers, got {value!r} at {x!r}"
        )
    return values


def _values_one_by_one(
    function: Callable[[Any], Any], places: Floats, field: QuantityField
) -> Floats:
    """Values at places of a function that takes single numbers.

    ValueError if the function fails, with its reason, or if it does not return a number
    for each place.
    """
    try:
        returned = [function(x) for x in places.tolist()]
    except Exception as error:
        reason = f"{type(error).__name__}: {one_line(str(error))}"
        message = f"is a function that cannot be evaluated: {reason}"
        raise ValueError(message) from None
    try:
        values = floats(returned, field.unit)
    except ValueError as error:
        message = f"must be a function that returns numbers: {error}"
        raise ValueError(message) from None
    if values.shape != places.shape:
        first = shown(values[0])  # the array that was returned for the place 0.0
        raise ValueError(f"must be a function that returns numbers, got {first} at 0.0")
    return values
