"""The times of the samples of a table, checked.

They increase, no sample is missing, and none is rounded.
"""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from ..model.quantities import Floats
from ..storage.reading import FileFormatError
from ..units import format_si
from .signal import EQUAL_STEP_RTOL

MIN_GAP_RATIO = 1.5
"""Smallest time step between which samples are missing, over the usual step."""
MIN_UNEVEN_SHARE = 0.1
"""Least share of steps unlike the usual one by which times count as uneven or rounded.

With fewer such steps, the unlike ones are gaps.
"""
MIN_ROUNDED_SAMPLES = 16
"""Samples of a record whose times can be seen to be rounded, at least."""
MAX_ROUNDING_RATIO = 0.6
"""Largest distance of rounded times from equal steps, over the last digit.

It would be half a digit but for the line through the times.
"""
DIGIT_RTOL = 1e-3
"""Bounds the distance of steps from whole last digits, over the last digit."""


class RoundedTimes(UserWarning):
    """The times of a record have too few digits: equal steps are taken in their place.

    Examples
    --------
    >>> import pathlib, tempfile, warnings, rodimpact as ri
    >>> rows = [f"{0.4 * i:.0f},{i % 7}" for i in range(40)]
    >>> catching = warnings.catch_warnings(record=True)
    >>> with tempfile.TemporaryDirectory() as folder, catching as told:
    ...     warnings.simplefilter("always")
    ...     path = pathlib.Path(folder, "shot.csv")
    ...     _ = path.write_text(chr(10).join(["t [us],bar [V]", *rows]))
    ...     record = ri.read_signals(path)
    >>> [each.category.__name__ for each in told], round(record["bar"].dt * 1e6, 1)
    (['RoundedTimes'], 0.4)
    """


def checked_times(
    times: Floats, name: str, place_of: Callable[[int], str], stacklevel: int
) -> Floats:
    """The times, s, if they increase without gaps; equal steps if they are rounded.

    Uneven steps are no gaps if `MIN_UNEVEN_SHARE` of all steps are.

    Parameters
    ----------
    times : array, shape (n,)
    name : str
        Name of their column, for messages.
    place_of : function
        Line or sample of a row, for messages.
    stacklevel : int
        Calls between the warning and the code that reads the file.

    Warns
    -----
    RoundedTimes
        If the times are rounded.

    Raises
    ------
    FileFormatError
        If times do not increase, or samples are missing.
    """
    steps = np.diff(times)
    if _are_rounded(times, steps):  # then none decreases, and no sample is missing
        equal = _equal_steps(times)
        sentence = _rounding_sentence(name, times, steps, equal)
        warnings.warn(sentence, RoundedTimes, stacklevel)
        return equal

    def refuse_if(is_wrong: Any, message: str) -> None:
        """FileFormatError that names the first wrong step, if there is one; [step]."""
        if not is_wrong.any():
            return
        i = int(is_wrong.argmax())
        raise FileFormatError(
            f"{place_of(i + 1)}, column {name}: {times[i + 1]:.9g}"
            f" s comes after {times[i]:.9g} s; {message}"
        )

    refuse_if(
        steps <= 0,
        "times must increase; if the times have too few digits, remove the column "
        "and give rate",
    )
    usual = np.median(steps)
    is_gap = steps > MIN_GAP_RATIO * usual
    # `steps` become their distances from the usual step, in place to save memory.
    steps -= usual
    np.abs(steps, out=steps)
    uneven_share = np.mean(steps > EQUAL_STEP_RTOL * usual)
    # Many uneven steps are so on purpose.
    if uneven_share < MIN_UNEVEN_SHARE:
        refuse_if(
            is_gap, "samples are missing; cut the record there, or fill in the samples"
        )
    return times


def _are_rounded(times: Floats, steps: Floats) -> bool:
    """Whether times are those of equal steps, rounded to the last digit of the file.

    `steps` are their differences. Of rounded times a step has one of two values, which
    differ by the last digit, and the times are as near to equal steps as this digit. A
    missing sample makes another step, too: this is not taken for rounding, since it is
    rare and its step is twice the usual one. False for fewer than `MIN_ROUNDED_SAMPLES`
    times, and for times that do not increase.
    """
    if len(times) < MIN_ROUNDED_SAMPLES:
        return False
    # Of rounded times the longest step exceeds the shortest by the last digit.
    shortest = float(steps.min())
    last_digit = float(steps.max()) - shortest
    has_repeats = shortest == 0  # neighbouring times were rounded to one
    if shortest < 0 or last_digit <= EQUAL_STEP_RTOL * shortest:
        return False  # times that do not increase, or equal steps
    usual = np.median(steps)
    is_uneven = np.abs(steps - usual) > EQUAL_STEP_RTOL * usual
    is_rare = is_uneven.mean() < MIN_UNEVEN_SHARE
    # A missing sample makes the longest step twice the shortest one: the supposed last
    # digit, their difference, is about as long as the shortest.
    if is_rare and shortest < MIN_GAP_RATIO * last_digit:
        return False
    if not has_repeats:  # each step must be the shortest or the longest one
        is_short = steps - shortest < DIGIT_RTOL * last_digit
        is_long = shortest + last_digit - steps < DIGIT_RTOL * last_digit
        if not np.all(is_short | is_long):
            return False
    distance = np.abs(times - _equal_steps(times)).max()
    return bool(distance <= MAX_ROUNDING_RATIO * last_digit)


def _equal_steps(times: Floats) -> Floats:
    """Times with equal steps nearest to the times, by least squares, s.

    With the numbers n of the samples, less their mean, they are
    mean(t) + n sum(n t)/sum(n^2).
    """
    count = len(times)
    numbers: Floats = np.arange(count, dtype=float) - (count - 1) / 2
    step = float(numbers @ times) / float(numbers @ numbers)
    # In place, to save memory
    equal = numbers
    equal *= step
    equal += times.mean()
    return equal


def _rounding_sentence(name: str, times: Floats, steps: Floats, equal: Floats) -> str:
    """Sentence of the warning: which column was rounded, and which times are taken.

    `steps` are those of the rounded times, and `equal` the times that are taken, s.
    """
    distance = format_si(float(np.abs(times - equal).max()), "s", digits=2)
    shortest = format_si(float(steps.min()), "s", digits=3)
    longest = format_si(float(steps.max()), "s", digits=3)
    step = format_si(float(equal[1] - equal[0]), "s", digits=4)
    return (
        f"column {name}: the times are rounded, their steps are {shortest} to "
        f"{longest}; equal steps of {step} are taken, which agree with all times "
        f"within {distance}; if you "
        "know the sampling rate, remove the column and give rate"
    )
