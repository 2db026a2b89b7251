"""How wrong a run may be: from a second run at a coarser tolerance, and what pieces leave open.

The page has this as JavaScript.
"""

from typing import Any, NamedTuple

import numpy as np

from ..laws import Law

COARSER = 5.0  # tolerance of the run that the first is compared with, over its own
COARSER_FLOOR = 2  # its floor, if breaks come too densely to be followed
COARSEST = 1e-2
ROUND_OFF = 1e-14
DOUBT, SHARED = (
    2.2,
    0.5,
)  # times what two runs are apart; share of the worst that all may be off
FAINT = 3.0  # times more for times, which may hang on faint forces
SMOOTH, ORDER = (
    5000.0,
    1.8,
)  # times tail^1.8: what both runs leave open if they took the same steps
MISSED = 4.0  # times by how much pieces miss a function that was given
SHOWN = 3  # measures that are not times: their errors fall evenly


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


def left_open(run: Any, fit: float) -> float:
    """Relative error that a second run does not show."""
    smooth: float = (run.roughest / run.scale) ** ORDER
    return ROUND_OFF + SMOOTH * smooth + MISSED * fit


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


def apart(fine: Ended, coarse: Ended) -> list[float]:
    """Error of each of the `MEASURES`, from how far two runs are apart, over its largest value.

    Errors fall by five or more from one run to the other. Where two numbers agree by chance, others
    do not: none is said to be much better known than the worst.
    """
    found, sizes, other = [], [], measured(coarse)
    for i, values in enumerate(measured(fine)):
        size = size_of(values)
        sizes.append(size)
        off = size_of([a - b for a, b in zip(values, other[i], strict=True)])
        whole = fine.run.scale if i == 0 else size
        found.append(off / whole if whole > 0 else 0.0)
    least = SHARED * max(found[0], found[1], found[2])
    return [
        DOUBT * (FAINT if i >= SHOWN else 1.0) * max(off, least)
        if sizes[i] != 0
        else 0.0
        for i, off in enumerate(found)
    ]


def size_of(values: list[float]) -> float:
    """Largest absolute value."""
    return max([0.0, *[abs(value) for value in values]])
