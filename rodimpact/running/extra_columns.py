"""What is read off a finished run for a family that asks for it, beside the outcome."""

from __future__ import annotations

from collections.abc import Sequence

from ..methods.run import largest_error
from ..model import Rod, Yielding
from ..results.solution import Solution


def extra_columns(solution: Solution, also: Sequence[str]) -> dict[str, float]:
    """Columns of what is wanted of `ALSO`, by name."""
    rods = [i for i, body in enumerate(solution.system.bodies) if isinstance(body, Rod)]
    columns = {}
    if "dissipated" in also:
        columns["dissipated"] = solution.outcome.dissipated
    if "set" in also:
        columns |= {f"set.{k}": _set(solution, k)
                    for k, law in enumerate(solution.system.contacts) if isinstance(law, Yielding)}
    if "displacement" in also:
        columns |= {f"displacement.{i}": _moved(solution, i)
                    for i in range(len(solution.system.bodies))}
    if "largest_stress" in also:
        columns |= {f"largest_stress.{i}": solution.fields.largest_stress(i) for i in rods}
    if "accuracy" in also:
        columns["accuracy"] = largest_error(solution.accuracy)
    return columns


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
    fields = solution.fields
    end, tick = fields.end, fields.clock.tick
    time = end * tick
    if not isinstance(solution.system.bodies[body], Rod):
        return float(solution.displacement(body, 0.0, time))
    left, right = (
        solution.contacts[k].push if 0 <= k < len(solution.contacts)
        else outside.push if (outside := solution.run.signals.outside[side]) else None
        for side, k in enumerate((body - 1, body))
    )
    moved = 0.0  # by the two forces: Newton's law, integrated twice
    for push, sign in ((left, 1), (right, -1)):
        if push is not None:
            moved += sign * float(push.integrated_twice(end)) * tick * tick
    start = float(solution.mean_velocity(body, 0.0)) * time
    fallen = float(solution.system.gravity) * time * time / 2
    return start + moved / solution.outcome.masses[body] + fallen
