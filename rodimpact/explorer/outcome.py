"""What a run of fronts comes to: velocities, contacts, energies, and why it ended.

Plain Python, which the page has as JavaScript. Tests hold all of it against `Outcome`.
"""

from __future__ import annotations

from typing import Any

from ..methods.abilities import has_driven_end
from ..methods.clock import most_rounded
from ..methods.fronts.layout import round_trip
from ..methods.fronts.method import last_of, status_of, tally_of
from ..methods.fronts.plan import plan_of
from ..methods.fronts.records import NONE
from ..methods.groups import body_velocities, heads
from ..methods.laws import Stop
from ..methods.status import DRIVEN, is_held, rounding, strain_warning
from ..methods.walk import smallest, walk
from ..model.numbering import contact_names
from ..theory import pair_numbers, pair_restitution
from .known import outcome_told
from .runs import run_of, space_of
from .tables import asked_of, system_of


def outcome_of(run: Any) -> Any:
    """What the collision did, as `outcome_told` has it."""
    it, segment, row = run["run"], run["segment"], run["plan"].row
    first, longest = heads(row.system, row.spans), 1
    kinetic = vibration_before = vibration_after = 0.0
    for s, piece in enumerate(row.segments):
        at = segment[s + 1]
        longest = max(longest, at.transit)
        kinetic += piece.mass * (at.initial + it.frame) ** 2 / 2
        vibration_before += at.initial_vibration * it.tick
        vibration_after += at.vibration * it.tick
    proved = it.proved != NONE and not (it.until >= 0 and has_driven_end(row.system))
    ticks = [at.transit for at in segment[1 : len(row.segments) + 1]]
    rounded, worst = most_rounded(row, ticks, it.tick)
    trip, contacts = round_trip(run["body"], segment) * it.tick, run["plan"].contacts
    text = status_of(it, run["node"], contacts, {
        "proved": proved, "t_final": last_of(it, run["node"], contacts, trip),
        "acting": DRIVEN if has_driven_end(row.system) else "", "held": is_held(row.system),
        "names": contact_names([body.kind for body in row.system.bodies]),
    })
    strain = it.fastest / smallest([piece.wave_speed for piece in row.segments])
    return outcome_told(row.system, {
        "before": body_velocities(row.system, [segment[s].initial + it.frame for s in first]),
        "after": body_velocities(row.system, [segment[s].velocity + it.frame for s in first]),
        "contacts": [tally_of(run["node"][k], it.tick) for k in run["plan"].contacts],
        "final": proved, "status": text + rounding(rounded, worst) + strain_warning(strain),
        "errors": {"velocity": (rounded + 1 / longest) * it.events * it.scale},
        "energy_before": kinetic + vibration_before, "vibration_after": vibration_after,
    })


def restitutions(case: Any, library: Any, path: list[Any], values: list[float]) -> list[Any]:
    """e for each value of a number of a case; None where there is none."""
    found: list[Any] = []
    space, asked = space_of(plan_of(walk(system_of(case, library)))), asked_of(case)
    for value in values:
        space["plan"] = plan_of(walk(system_of(changed(case, path, value), library)))
        run, e = run_of(asked, False, space), None
        if run["run"].stop < Stop.OVERFLOW:
            outcome = outcome_of(run)
            e = outcome["restitution"] if outcome["why"] == "" else None
        found.append(e)
    return found


def closed_form_of(system: Any, before: list[float]) -> Any:
    """e of a pair for which theory knows it, and the source; None for any other row."""
    pieces, walls = [], 0
    if len(system.bodies) != 2 or not system.contacts[0].opens or before[0] <= before[1]:
        return None
    for body, end in zip(system.bodies, system.ends, strict=True):
        walls += 1 if body.kind == "wall" else 0
        pieces.extend(body.segments)
        even = isinstance(body.velocity, float) and body.strain == 0.0
        if not even or end.kind != "free" or len(body.segments) > 1:
            return None
    if walls > 0:
        return {"restitution": 1.0, "source": "textbook, box 10.4"}
    left, right = pieces
    short_time, long_time, q, p, log_q = pair_numbers(
        left.impedance, left.transit_time, right.impedance, right.transit_time)
    e = pair_restitution(short_time, long_time, q, p, log_q) * 1.0
    return {"restitution": e, "source": "Saint-Venant 1867"}


def changed(tree: Any, path: list[Any], value: float) -> Any:
    """The tables with another number at a path."""
    if len(path) == 0:
        return value
    copy = [*tree] if isinstance(tree, list) else {**tree}
    copy[path[0]] = changed(tree[path[0]], path[1:], value)
    return copy
