"""How wrong a run may be: from a second run at a coarser tolerance, and what pieces leave open."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..run import MEASURES, VELOCITY
from .records import Law

COARSER = 5.0  # tolerance of the run that the first is compared with, over its own
COARSER_FLOOR = 2  # its floor, if breaks come too densely to be followed
COARSEST = 1e-2
ROUND_OFF = 1e-14
DOUBT, SHARED = 2.2, 0.5  # times what two runs are apart; share of the worst that all may be off
FAINT = 3.0  # times more for times, which may hang on faint forces
SMOOTH, ORDER = 5000.0, 1.8  # times tail^1.8: what both runs leave open if they took the same steps
MISSED = 4.0  # times by how much pieces miss a function that was given


def compare(fine: Any, coarse: Any) -> None:
    """Let runs at a coarser tolerance, [member] RUN, end as finer ones did, and on other floors."""
    coarse["extra"] = fine["extra"]
    coarse["floor"] = np.where(fine["rough"] > 0, COARSER_FLOOR * coarse["floor"], coarse["floor"])


def left_open(run: Any, fit: float) -> float:
    """Relative error that a second run does not show."""
    return ROUND_OFF + SMOOTH * float(run["roughest"] / run["scale"]) ** ORDER + MISSED * fit


def measured(r: dict[str, Any]) -> dict[str, Any]:
    """What the records of a run come to, by the names of `MEASURES`."""
    tick, link = float(r["run"][0]["tick"]), r["link"][r["link"]["law"] >= Law.JOINT]
    times = np.array([link["first"], link["last"], link["apart"]]) * tick
    part = r["part"]  # after the proof, at whatever time it came, groups go on evenly
    moving = part["own"] if r["run"][0]["held"] else part["mean"][part["parts"] > 0]
    return {
        "velocity": moving, "impulse": link["impulse"], "peak force": link["peak"],
        "duration": link["pressed"] * tick, "time": times,
    }


def apart(fine: dict[str, Any], coarse: dict[str, Any]) -> dict[str, float]:
    """Error of each measure, from how far two runs are apart, relative to its largest value.

    Errors fall by five or more from one run to the other. Where two numbers agree by chance, others
    do not: none is said to be much better known than the worst.
    """
    a, b, scale = measured(fine), measured(coarse), float(fine["run"][0]["scale"])
    found = {}
    for name in MEASURES:
        size = scale if name == VELOCITY else size_of(a[name])
        off = size_of(a[name] - b[name])
        found[name] = off / size if size > 0 else 0.0
    least = SHARED * max(found[name] for name in MEASURES[:3])
    return {name: DOUBT * (FAINT if name in MEASURES[3:] else 1.0) * max(off, least)
            if size_of(a[name]) else 0.0 for name, off in found.items()}


def size_of(values: Any) -> float:
    """Largest absolute value."""
    return float(np.max(np.abs(values), initial=0.0))
