"""Values along a rod, or over time: jumps, samples and functions.

A profile is a number, `Steps`, `Samples`, `Polynomials`, or a function, which becomes `Samples`
when the body or the drive is made: what is stored and compared are numbers only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY
from functools import reduce
from itertools import pairwise
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from ..units import one_line, shown
from . import frozen
from .frozen import Declared, Field, Number, NumericOrNone, Problems, note, quantity
from .quantities import Floats as Floats
from .quantities import floats

ALONG_ROD = 1025  # places at which a function along a rod is sampled
IN_TIME = 4097  # times at which a function of time is sampled
ERROR = Field(sign="non-negative", single=True)


class Steps(Declared):
    """A profile that is constant between jumps, along a rod or in time.

    Parameters
    ----------
    values : sequence of numbers
        One value for each piece, from left to right or from t = 0 on.
    at : sequence of numbers
        Where the jumps are, increasing: m from the left end of the rod, or s after t = 0; one fewer
        than values.

    Raises
    ------
    InvalidModel
        When the counts do not fit, the positions do not increase, or a value is not a number.

    Examples
    --------
    The left half of a rod of 1 m moves, the right half rests:

    >>> Steps([1.0, 0.0], at=[0.5])
    Steps(values=(1.0, 0.0), at=(0.5,))
    """

    values: Sequence[Any] = quantity("", "sampled", many=True)
    at: Sequence[Any] = quantity("", "positive", many=True)

    def _check(self, problems: Problems) -> None:
        if not problems and len(self.values) != len(self.at) + 1:
            message = f"needs one value more than jumps, got {len(self.values)} values"
            problems.append(("values", f"{message} for {len(self.at)} jumps"))
        if not problems:
            frozen.increasing(problems, "at", self.at)


class Samples(Declared):
    """A profile of values at equal distances, with straight lines or a smooth curve between them.

    Along a rod the values run from its left end to its right end. In time they begin at t = 0, and
    the last one holds on. A function becomes samples, with a smooth curve where that fits better.

    Parameters
    ----------
    values : sequence of numbers, shape (n,)
        At least two; all members of a family share them.
    step : float or array, optional
        Time between neighbouring values, s; None along a rod.
    smooth : bool
        Whether a spline of degree 5 runs through the values, for the method "characteristics".
    error : float
        How far the curve is from what the samples stand for, in the unit of the values. Results of
        "characteristics" count it.

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
    _whole: ClassVar[tuple[str, ...]] = ("values", "error")

    def _check(self, problems: Problems) -> None:
        if not problems and not (np.ndim(self.values) == 1 and len(self.values) > 1):
            wanted = "must be a list of at least two numbers"
            note(problems, "values", wanted, frozen.plain(self.values))
        smooth: Any = self.smooth
        if not isinstance(smooth, bool):
            note(problems, "smooth", "must be True or False", smooth)
        self._set(error=ERROR.checked(problems, "error", self.error))

    def _parameters(self) -> dict[str, Any]:
        given = super()._parameters().items()
        return {name: v for name, v in given if name not in ("smooth", "error") or v}

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        given = super().to_dict()
        return {"samples": given.pop("values"), **given}


class Polynomials(Declared):
    """A profile of polynomials along a rod, between places where it may jump or bend.

    `Solution.system_at` makes it of smooth waves, exactly. In an interval of width w that begins at
    x0, the n values belong to the places x_k = x0 + w (1 - cos(pi k/(n - 1)))/2, k = 0 to n - 1, so
    that the first and the last one are those at its ends.

    Parameters
    ----------
    values : sequence of numbers, shape (intervals * n,)
        Values interval by interval from left to right, as many in each, at least two.
    at : sequence of numbers, shape (intervals - 1,), optional
        Borders of the intervals, m from the left end of the rod, increasing; None for one interval.
    error : float
        How far the values are from what they stand for, in their unit: the stated error of the run
        that they come from. Results of "characteristics" count it.

    Raises
    ------
    InvalidModel
        When the counts do not fit, the borders do not increase, or a value is not a number.

    Examples
    --------
    A rod of 1 m whose left half rests, and whose right half moves the faster the farther right:

    >>> Polynomials([0.0, 0.0, 0.0, 0.5], at=[0.5])
    Polynomials(values=array(4,), at=array(1,))
    """

    values: Any = quantity("", "sampled")
    at: Any = quantity("", "sampled", default=None)
    _: KW_ONLY
    error: float = 0.0
    _whole: ClassVar[tuple[str, ...]] = ("values", "at", "error")

    def _check(self, problems: Problems) -> None:
        if problems:
            return
        inner = self.inner
        intervals = len(inner) + 1
        count = np.size(self.values)
        if count % intervals or count < 2 * intervals:
            message = (
                f"needs two values or more, as many for each of {intervals} intervals"
            )
            problems.append(("values", f"{message}, got {count}"))
        frozen.increasing(problems, "at", inner)

    @property
    def inner(self) -> list[float]:
        """Borders between intervals, m, none for one interval."""
        if self.at is None:
            return []
        borders: list[float] = np.ravel(self.at).tolist()
        return borders

    def coefficients(self) -> Floats:
        """Chebyshev coefficients of each interval, [interval, degree], of y from -1 to 1."""
        table = np.asarray(self.values, dtype=float).reshape(len(self.inner) + 1, -1)
        count = table.shape[1]
        places = -np.cos(np.pi * np.arange(count) / (count - 1))
        inverse = np.linalg.inv(chebyshev.chebvander(places, count - 1))
        found: Floats = table @ inverse.T
        return found

    def _parameters(self) -> dict[str, Any]:
        given = super()._parameters()
        if not self.error:
            given.pop("error", None)
        return given

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        given = super().to_dict()
        return {"polynomials": given.pop("values"), **given}


Profile: TypeAlias = "Number | Steps | Samples | Polynomials"
ProfileLike: TypeAlias = (
    "ArrayLike | Steps | Samples | Polynomials | Callable[[Any], Any]"
)


def along_rod(
    problems: Problems, path: str, value: Any, field: Field, length: Number | None
) -> Profile:
    """Return `value` as a profile along a rod of that length, m; note a mistake in `problems`.

    A function is sampled at `ALONG_ROD` places from end to end. Without a length, which a mistake
    elsewhere leaves unknown, only what does not depend on it is checked. `Steps` bear any sign.
    """
    held: Profile = value
    if type(value) is float or not (
        isinstance(value, Steps | Samples | Polynomials) or callable(value)
    ):
        held = field.checked(problems, path, value)
    elif isinstance(value, Steps | Polynomials):
        if isinstance(value, Steps):
            borders = value.at
        else:
            borders = value.inner
        if borders and length is not None:
            if isinstance(value, Steps):
                frozen.family_shape([("length", length), *value._numbers(path)])
            last, end = f"{path}.at.{len(borders) - 1}", borders[-1]
            message = "must lie inside the rod of length {0!r}, got {1!r}"
            frozen.require(
                problems, np.asarray(end) < length, last, message, length, end
            )
    elif isinstance(value, Samples):
        if value.step is not None:
            message = "is for samples in time; those of a rod run from end to end; leave it out"
            problems.append((f"{path}.step", message))
        if field.sign != "any":
            field.checked(problems, f"{path}.values", value.values)
    elif isinstance(length, np.ndarray):
        message = "is a function, but the members of the family differ in length; give Samples"
        problems.append((path, message))
    elif length is not None:
        held = _curve(
            problems, path, value, np.linspace(0.0, length, ALONG_ROD), field, None
        )
    return held


def in_time(value: Any, field: Field, duration: Any) -> Profile:
    """Return the `value` of a drive as a profile from t = 0 on; InvalidModel if it is none.

    A function is sampled at `IN_TIME` times from 0 to `duration`, s, which only a function has.
    """
    problems: Problems = []
    held: Profile = value
    if callable(value):
        if duration is None:
            message = (
                "is missing; give the seconds for which the function is to be sampled"
            )
            problems.append(("duration", message))
        end = Field("s", "positive", default=None, single=True).checked(
            problems, "duration", duration
        )
        if not problems:
            times, step = np.linspace(0.0, end, IN_TIME), end / (IN_TIME - 1)
            held = _curve(problems, "value", value, times, field, step)
    else:
        if duration is not None:
            note(
                problems,
                "duration",
                "belongs to a function of time; leave it out",
                duration,
            )
        if isinstance(value, Samples) and value.step is None:
            problems.append(
                ("value.step", "is missing; give the seconds between two samples")
            )
        if not isinstance(value, Steps | Samples):
            held = field.checked(problems, "value", value)
    frozen.raise_noted(problems)
    return held


def negative(profile: Profile) -> Profile:
    """Return minus the profile."""
    if isinstance(profile, Steps | Samples | Polynomials):
        return profile.replace(values=[-v for v in profile.values])
    return -profile


def flipped(profile: Profile, length: Number) -> Profile:
    """Return the profile along a rod of that length, m, seen from the other end."""
    if isinstance(profile, Samples):
        return profile.replace(values=profile.values[::-1])
    if isinstance(profile, Polynomials):
        borders = None
        if profile.at is not None:
            borders = np.asarray(length) - profile.at[::-1]
        return profile.replace(values=profile.values[::-1], at=borders)
    if not isinstance(profile, Steps):
        return profile
    # next to the other end two places may round to one; the piece between them has no width
    edges = [0.0, *(length - x for x in profile.at[::-1]), length]
    kept = [i for i, (a, b) in enumerate(pairwise(edges)) if np.any(np.asarray(b) > a)]
    return Steps([profile.values[::-1][i] for i in kept], [edges[i] for i in kept[1:]])


def extremes(profile: Profile) -> list[Any]:
    """Smallest and largest value of a profile, of each member of a family.

    Polynomials may be a little larger between their places.
    """
    if isinstance(profile, Samples | Polynomials):
        return [float(np.min(profile.values)), float(np.max(profile.values))]
    values: Any = profile.values if isinstance(profile, Steps) else [profile]
    return [reduce(np.minimum, values), reduce(np.maximum, values)]


def averages(profile: Any, edges: Any, length: float) -> Floats:
    """Mean values of a profile between neighbouring edges.

    Parameters
    ----------
    profile : float, Steps or Samples
    edges : [n + 1] array
        Increasing places, m, or times, s.
    length : float
        Of the rod, m, for samples that run from end to end.

    Returns
    -------
    [n] array
        Exact for jumps and for straight lines between samples.

    Examples
    --------
    >>> averages(Samples([0.0, 1.0, 4.0]), np.array([0.0, 0.5, 2.0]), length=2.0).round(9).tolist()
    [0.25, 1.916666667]
    """
    if isinstance(profile, Polynomials):
        return _averages_of_polynomials(profile, edges, length)
    if not isinstance(profile, Samples):
        steps = profile if isinstance(profile, Steps) else Steps([profile], [])
        at, values = (
            np.array(steps.at, dtype=float),
            np.array(steps.values, dtype=float),
        )
        first, last = (
            np.searchsorted(at, edges[:-1], "right"),
            np.searchsorted(at, edges[1:]),
        )
        means: Floats = values[first]
        for i in np.flatnonzero(last > first):
            cuts = np.concatenate(([edges[i]], at[first[i] : last[i]], [edges[i + 1]]))
            means[i] = np.sum(values[first[i] : last[i] + 1] * np.diff(cuts)) / (
                edges[i + 1] - edges[i]
            )
        return means
    values = np.asarray(profile.values, dtype=float)
    width = length / (len(values) - 1) if profile.step is None else float(profile.step)
    knots = width * np.arange(len(values))
    total = np.concatenate(([0.0], np.cumsum((values[1:] + values[:-1]) / 2) * width))
    inside = np.clip(edges, 0.0, knots[-1])
    i = np.clip((inside / width).astype(int), 0, len(values) - 2)
    s = inside - knots[i]
    slope = (values[i + 1] - values[i]) / width
    integral = total[i] + values[i] * s + slope * s * s / 2
    integral += values[-1] * np.maximum(edges - knots[-1], 0.0)
    integral += values[0] * np.minimum(edges, 0.0)
    return np.asarray(np.diff(integral) / np.diff(edges))


def _averages_of_polynomials(
    profile: Polynomials, edges: Floats, length: float
) -> Floats:
    borders = np.concatenate(([0.0], profile.inner, [length]))
    widths = np.diff(borders)
    primitives = chebyshev.chebint(profile.coefficients(), lbnd=-1, axis=1)
    whole = primitives.sum(axis=1) * widths / 2
    before = np.concatenate(([0.0], np.cumsum(whole)))
    places = np.clip(edges, 0.0, length)
    interval = np.clip(
        np.searchsorted(borders, places, "right") - 1, 0, len(widths) - 1
    )
    y = 2 * (places - borders[interval]) / widths[interval] - 1
    inside = chebyshev.chebval(y, primitives[interval].T, tensor=False)
    integral = before[interval] + inside * widths[interval] / 2
    means: Floats = np.diff(integral) / np.diff(edges)
    return means


def profile_from(data: Any) -> Any:
    """Make the profile that `to_dict` described; what is none stays as it is."""
    if not isinstance(data, dict):
        return data
    if "polynomials" in data:
        return Polynomials(
            data["polynomials"], data.get("at"), error=data.get("error", 0.0)
        )
    if "samples" in data:
        return Samples(
            **{"values" if key == "samples" else key: v for key, v in data.items()}
        )
    return Steps(**data) if "values" in data else data


def _curve(
    problems: Problems,
    path: str,
    function: Any,
    places: Floats,
    field: Field,
    step: Any,
) -> Profile:
    """Samples of a function, with the curve between them that is nearer to it half way."""
    from scipy.interpolate import make_interp_spline

    middles = (places[1:] + places[:-1]) / 2
    try:
        values, true = (_sampled(function, x, field) for x in (places, middles))
    except ValueError as error:
        problems.append((path, str(error)))
        return 0.0
    curve, lines = (
        make_interp_spline(places, values, 5)(middles),
        (values[1:] + values[:-1]) / 2,
    )
    bent, straight = (float(np.max(np.abs(given - true))) for given in (curve, lines))
    return Samples(values, step, smooth=bent < straight, error=min(bent, straight))


def _sampled(function: Callable[[Any], Any], places: Floats, field: Field) -> Floats:
    """Values of a function of arrays, or else of numbers; ValueError says why it has none."""
    try:
        values = floats(function(places.copy()), field.unit)
    except Exception:
        values = np.zeros(0)
    if values.shape != places.shape:
        try:
            returned = [function(x) for x in places.tolist()]
        except Exception as error:
            reason = f"{type(error).__name__}: {one_line(str(error))}"
            raise ValueError(
                f"is a function that cannot be evaluated: {reason}"
            ) from None
        try:
            values = floats(returned, field.unit)
        except ValueError as error:
            raise ValueError(
                f"must be a function that returns numbers: {error}"
            ) from None
    if values.shape != places.shape:
        raise ValueError(
            f"must be a function that returns numbers, got {shown(values[0])} at 0.0"
        )
    good = (np.abs(values) <= frozen.LARGEST) & field.holds(values)
    if not good.all():
        x, got = float(places[~good][0]), float(values[~good][0])
        kind = "positive" if field.sign == "positive" else "finite"
        raise ValueError(
            f"must be a function that returns {kind} numbers, got {got!r} at {x!r}"
        )
    return values
