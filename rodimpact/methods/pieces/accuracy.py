"""How wrong a run may be: from a second run at a coarser tolerance, and what pieces leave open.

The page has this as JavaScript.
"""

from typing import Any, NamedTuple

import numpy as np

from ..link import Law
from .records import Part

COARSER = 5.0  # tolerance of the run that the first is compared with, over its own
COARSER_FLOOR = 2  # its floor, if breaks come too densely to be followed
COARSEST = 1e-2
ROUND_OFF = 1e-14
DIFFERENCE_FACTOR = 3.0  # stated error over the difference of two runs
TIME_FACTOR = 2.0  # times more for times, which may hang on faint forces
LEAST_SHARE = 0.1  # share of the worst difference that all measures may be off
LEAST_SHARE_OF_TIMES = 0.05
SHARED_FACTOR = 2.0  # over the estimate for steps that both runs took alike
SHARED_TIME_FACTOR = 2.2  # for times, which may hang on faint forces
LOOSE_FACTOR = 2e7  # times tail^2.5: errors of loose tolerances do not fall evenly
LOOSE_POWER = 2.5
MISSED = 4.0  # times by how much pieces miss a function that was given
SHOWN = 3  # measures that are not times: their errors fall evenly
PEAK_FORCE = 2  # its place among the measures


class Ended(NamedTuple):
    """Records of a run that has come to its end: that of the run, and lists of the others."""

    run: Any
    link: Any
    part: Any


def compare(fine: Any, coarse: Any) -> None:
    """Let runs at a coarser tolerance end as finer ones did, and on other floors.

    Parameters
    ----------
    fine, coarse : RUN
        Of all members.
    """
    coarse.extra = fine.extra
    coarse.floor = np.where(fine.rough > 0, COARSER_FLOOR * coarse.floor, coarse.floor)


def left_open(fine: Ended, fit: float) -> list[float]:
    """Relative error of each of the `MEASURES` that a second run does not show.

    With large tails, errors are not small enough to fall evenly from run to run. A peak force is
    one value of a polynomial: two runs may miss it alike, by about `peak_error`.
    """
    run = fine.run
    loose = LOOSE_FACTOR * (run.roughest / run.scale) ** LOOSE_POWER
    common = ROUND_OFF + loose + MISSED * fit
    found = [common, common, common, common, common]
    if all(part.kind != Part.SEGMENT for part in fine.part):
        add_faint_times(fine, found)
    peak = size_of([it.peak for it in fine.link])
    if peak > 0:
        found[PEAK_FORCE] += size_of([it.peak_error for it in fine.link]) / peak
    return found


def add_faint_times(fine: Ended, found: list[float]) -> None:
    """Add the error of durations and times of a row without rods, where a flight may be long.

    A contact does not press while its overlap is less than the length that `graze` makes in the
    reference time of the run, at its beginning and at its end.
    """
    run = fine.run
    episodes = max([1, *[it.episodes for it in fine.link]])
    faint = 2 * run.graze / run.scale * run.shortest * run.tick * episodes
    values = measured(fine)
    for i in range(SHOWN, len(found)):
        longest = size_of(values[i])
        if longest > 0:
            found[i] += faint / longest


def measured(r: Ended) -> list[list[float]]:
    """What a run comes to, in the order of `MEASURES`."""
    link = [it for it in r.link if it.law >= Law.JOINT]
    tick, times = r.run.tick, [t for it in link for t in (it.first, it.last, it.apart)]
    moving = [it.mean for it in r.part if it.parts > 0]
    if (
        r.run.held
    ):  # after the proof, at whatever time it came, other groups go on evenly
        moving = [it.own for it in r.part]
    return [
        moving,
        [it.impulse for it in link],
        [it.peak for it in link],
        [it.pressed * tick for it in link],
        [t * tick for t in times],
    ]


def differences(fine: Ended, coarse: Ended) -> list[float]:
    """How far two runs are apart in each of the `MEASURES`, over its largest value."""
    found = []
    other = measured(coarse)
    for i, values in enumerate(measured(fine)):
        whole = size_of(values)
        if i == 0 and whole > 0:
            whole = fine.run.scale
        off = size_of([a - b for a, b in zip(values, other[i], strict=True)])
        found.append(off / whole if whole > 0 else 0.0)
    return found


def stated(fine: Ended, apart: list[float]) -> list[float]:
    """Error of each of the `MEASURES`, from how far two runs are apart.

    Errors fall by five or more from one run to the other. Where two numbers agree by chance, others
    do not: none is said to be much better known than the worst. Both runs take the same steps where
    these are as long as breaks allow, and share their errors: `run.shared` estimates the largest.
    """
    estimate = fine.run.shared / fine.run.scale
    worst = max(apart[0], apart[1], apart[2])
    found = []
    for i, values in enumerate(measured(fine)):
        share = LEAST_SHARE
        factor = DIFFERENCE_FACTOR
        shared = SHARED_FACTOR * estimate
        if i >= SHOWN:
            share = LEAST_SHARE_OF_TIMES
            factor *= TIME_FACTOR
            shared = SHARED_TIME_FACTOR * estimate
        error = 0.0
        if size_of(values) > 0:
            error = max(factor * max(apart[i], share * worst), shared)
        found.append(error)
    return found


def size_of(values: list[float]) -> float:
    """Largest absolute value."""
    return max([0.0, *[abs(value) for value in values]])
