"""Checks of the sample times of a table.

The times must increase, and no sample may be missing. Rounded times are replaced by
equal steps.
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
"""A step longer than this number of usual steps is a gap: samples are missing there."""
MIN_UNEVEN_SHARE = 0.1
"""Least share of steps that differ from the usual step in uneven or rounded times.

If fewer steps differ, the long ones among them are gaps.
"""
MIN_ROUNDED_SAMPLES = 16
"""Least number of samples of a record whose times can be recognized as rounded."""
MAX_ROUNDING_RATIO = 0.6
"""Largest difference of rounded times from equal steps, over the last digit.

Rounding changes a time by half a digit at most; the rest is the error of the fitted
equal steps.
"""
DIGIT_RTOL = 1e-3
"""Largest difference of a step from the shortest or longest one, over the last digit.

The last digit is the difference between the longest and the shortest step.
"""


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

    Long steps do not count as gaps if at least `MIN_UNEVEN_SHARE` of all steps differ
    from the usual one.

    Parameters
    ----------
    times : array, shape (n,)
        s; not changed.
    name : str
        Name of the column of times, for messages.
    place_of : function
        Line or sample of a row, for messages.
    stacklevel : int
        Level of the warning in the stack of calls, see `warnings.warn`.

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
    # Rounded times neither decrease nor have gaps, so they need no further check.
    if _are_rounded(times, steps):
        equal = _equal_steps(times)
        sentence = _rounding_sentence(name, times, steps, equal)
        warnings.warn(sentence, RoundedTimes, stacklevel)
        return equal

    def refuse_if(is_wrong: Any, message: str) -> None:
        """Raise FileFormatError for the first true value of `is_wrong`, [step]."""
        if not is_wrong.any():
            return
        i = int(is_wrong.argmax())  # the step from time i to time i + 1
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
    # In place, to save memory: `steps` now holds abs(step - usual).
    steps -= usual
    np.abs(steps, out=steps)
    uneven_share = np.mean(steps > EQUAL_STEP_RTOL * usual)
    # Many uneven steps are intended: the instrument did not sample at equal steps.
    if uneven_share < MIN_UNEVEN_SHARE:
        refuse_if(
            is_gap, "samples are missing; cut the record there, or fill in the samples"
        )
    return times


def _are_rounded(times: Floats, steps: Floats) -> bool:
    """Whether times are those of equal steps, rounded to the last digit of the file.

    `steps` are the differences of the times. Rounded times have steps of two values,
    which differ by the last digit, and they differ from equal steps by less than this
    digit. Steps with a missing sample are not mistaken for rounded ones, because they
    are rare and twice as long as the others. The result is false for fewer than
    `MIN_ROUNDED_SAMPLES` times, and for times that decrease.
    """
    if len(times) < MIN_ROUNDED_SAMPLES:
        return False
    # If times are rounded, the longest step exceeds the shortest by the last digit.
    shortest = float(steps.min())
    last_digit = float(steps.max()) - shortest
    has_repeats = shortest == 0  # neighbouring times were rounded to the same time
    if shortest < 0 or last_digit <= EQUAL_STEP_RTOL * shortest:
        return False  # times that decrease, or steps that are equal
    usual = np.median(steps)
    is_uneven = np.abs(steps - usual) > EQUAL_STEP_RTOL * usual
    is_rare = is_uneven.mean() < MIN_UNEVEN_SHARE
    # With a missing sample the longest step is about twice the shortest one, so
    # `last_digit` is about as long as the shortest step.
    if is_rare and shortest < MIN_GAP_RATIO * last_digit:
        return False
    # Repeated times are a sign of rounding in themselves. If no times repeat, each step
    # must be the shortest or the longest one.
    if not has_repeats:
        is_short = steps - shortest < DIGIT_RTOL * last_digit
        is_long = shortest + last_digit - steps < DIGIT_RTOL * last_digit
        if not np.all(is_short | is_long):
            return False
    distance = np.abs(times - _equal_steps(times)).max()
    return bool(distance <= MAX_ROUNDING_RATIO * last_digit)


def _equal_steps(times: Floats) -> Floats:
    """Times with equal steps that fit the times t best, by least squares, s.

    They are mean(t) + n sum(n t)/sum(n^2), where n is the index of a sample minus the
    mean of all indices.
    """
    count = len(times)
    numbers: Floats = np.arange(count, dtype=float) - (count - 1) / 2
    step = float(numbers @ times) / float(numbers @ numbers)
    # In place, to save memory: `equal` takes the array of `numbers`.
    equal = numbers
    equal *= step
    equal += times.mean()
    return equal


def _rounding_sentence(name: str, times: Floats, steps: Floats, equal: Floats) -> str:
    """Sentence of the warning on a column of rounded times.

    It gives the steps of the rounded times, `steps`, and the step of the times that are
    taken in their place, `equal`, all in s.
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
