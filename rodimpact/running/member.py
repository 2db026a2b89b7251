"""What a finished run is in the table of its family."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..methods.run import INWARD, largest_error
from ..model import Plastic, Rod
from ..results.solution import Solution
from . import sweep_result as table


def row_of(solution: Solution, readings: table.Readings) -> dict[str, Any]:
    """Columns of a member, by name."""
    o, also, system = solution.outcome, readings.also, solution.system
    row = {
        "restitution": math.nan if o.why_no_restitution() else o.restitution,
        "vibration": sum(o.vibration_after), "final": o.final,
        "status": table.STATUS.index(solution.stopped_by),
        **{f"velocity_after.{i}": v for i, v in enumerate(o.velocities_after)},
        **{f"{name}.{k}": getattr(tally, name) for k, tally in enumerate(o.contacts)
           for name in table.ContactColumns._fields},
    }
    if "dissipated" in also:
        row["dissipated"] = o.dissipated
    if "set" in also:
        row |= {f"set.{k}": _set(solution, k)
                for k, law in enumerate(system.contacts) if isinstance(law, Plastic)}
    if "displacement" in also:
        row |= {f"displacement.{i}": _moved(solution, i) for i in range(len(system.bodies))}
    if "largest_stress" in also:
        row |= {f"largest_stress.{i}": solution.fields.largest_stress(i)
                for i, body in enumerate(system.bodies) if isinstance(body, Rod)}
    if "accuracy" in also:
        row["accuracy"] = largest_error(solution.accuracy)
    if readings.gauges:
        inside = readings.times <= solution.t_end * (1 + 1e-12)
        row["strain"] = np.full((len(readings.gauges), len(inside)), math.nan)
        for g, gauge in enumerate(readings.gauges):
            row["strain"][g, inside] = solution.gauge(*gauge).strain_at(readings.times[inside])
    return row


def _set(solution: Solution, contact: int) -> float:
    """How far a contact has yielded for good, m: its gap counts from the faces as they are."""
    times = [0.0, solution.fields.end * solution.fields.clock.tick]
    body = solution.system.bodies[contact]
    length = float(body.length) if isinstance(body, Rod) else 0.0
    left = solution.displacement(contact, length, times)
    right = solution.displacement(contact + 1, 0.0, times)
    start, end = solution.contacts[contact].gap(times) - (right - left)
    return max(0.0, float(end - start))


def _moved(solution: Solution, body: int) -> float:
    """How far the centre of mass of a body has moved at the end, m."""
    signals, end, tick = solution.run.signals, solution.fields.end, solution.fields.clock.tick
    time = end * tick
    if not isinstance(solution.system.bodies[body], Rod):
        return float(solution.displacement(body, 0.0, time))
    left, right = (side and side.push for side in signals.outside)
    pushes = [left, *(contact.force for contact in signals.contacts), right]
    moved = 0.0  # by the forces on its two faces: Newton's law, integrated twice
    for push, sign in zip(pushes[body : body + 2], INWARD, strict=True):
        if push is not None:
            moved += sign * float(push.integrated_twice(end)) * tick * tick
    start = float(solution.mean_velocity(body, 0.0)) * time
    fallen = float(solution.system.gravity) * time * time / 2
    return start + moved / solution.outcome.masses[body] + fallen
