"""What a run of fronts comes to: velocities, contacts, energies, e, and why it ended.

Plain Python, which the page has as JavaScript. Tests hold all of it against `Outcome`.
"""

from __future__ import annotations

import math
from typing import Any

from ..methods.fronts.layout import round_trip
from ..methods.fronts.method import status_of
from ..methods.fronts.records import NONE
from ..methods.groups import groups_between, velocities_on_ground
from ..methods.laws import Stop
from ..methods.status import rounding, strain_warning
from ..results.outcome import ROUND_OFF, no_restitution
from ..theory import pair_numbers, pair_restitution
from .runs import run_of, space_of
from .tables import row_of
from .texts import contacts_of


def groups_of(row: Any) -> list[list[int]]:
    """Bodies that are bonded together, from left to right."""
    return groups_between([not bonded for bonded in row["bonded"]])


def velocities_of(row: Any, own: list[float]) -> list[float]:
    """Velocity of each body: `own` of its group, or of the wall or fixed end that holds that."""
    found: list[float] = []
    bodies = row["bodies"]
    for g, group in enumerate(groups_of(row)):
        inside = [i for i in group if bodies[i]["kind"] != "wall"]
        ground = []
        for end, i in ((0, group[0]), (1, group[-1])):
            if i == end * (len(bodies) - 1) and bodies[i]["kind"] == "wall":
                ground.append(bodies[i]["velocity"])
            elif i == end * (len(bodies) - 1) and row["ends"][end] == "fixed":
                ground.append(0.0)
        found.extend(velocities_on_ground(ground, group, inside, own[g]))
    return found


def before_and_after(row: Any, run: Any) -> Any:
    """Velocities of the bodies before and after."""
    frame, inside = run["run"].frame, []  # a segment of each group
    for group in groups_of(row):
        rods = [row["bodies"][i]["first"] for i in group if row["bodies"][i]["kind"] == "rod"]
        inside.append(run["segment"][rods[0] if len(rods) > 0 else 0])
    return (velocities_of(row, [it.initial + frame for it in inside]),
            velocities_of(row, [it.velocity + frame for it in inside]))


def outcome_of(row: Any, run: Any) -> Any:
    """What the collision did: velocities, contacts, energies, and e, or why there is none."""
    it, segment, node = run["run"], run["segment"], run["node"]
    before, after = before_and_after(row, run)
    contacts = [{
        "impulse": node[k].impulse * it.tick, "peak_force": node[k].peak,
        "duration": node[k].pressed * it.tick, "episodes": node[k].episodes,
    } for k in row["nodes"]]
    kinetic = vibration_before = vibration_after = 0.0
    for body in row["bodies"]:
        for s in range(body["first"], body["last"] + 1):
            v = segment[s].initial + it.frame
            kinetic += row["segments"][s - 1]["mass"] * v * v / 2
            vibration_before += segment[s].initial_vibration * it.tick
            vibration_after += segment[s].vibration * it.tick
    able, final, status = able_of(row), proof_of(row, run) != NONE, sentence_of(row, run)
    why = why_no_restitution(row, [c["episodes"] for c in contacts], before, final, status)
    e, error = math.nan, 0.0
    if why == "":
        e = restitution(able[0], before, after)
        error = error_of(row, run) / (before[able[0]] - before[able[0] + 1])
    return {
        "before": before, "after": after, "contacts": contacts, "able": able,
        "final": final, "status": status, "why": why, "restitution": e, "error": error,
        "energy_before": kinetic + vibration_before, "vibration_after": vibration_after,
    }


def error_of(row: Any, run: Any) -> float:
    """By how much two velocities may be wrong together, m/s, where the clock rounds transits."""
    it, longest = run["run"], 1
    for at in run["segment"]:
        longest = max(longest, at.transit)
    rounded, _ = transit_error_of(row, run)
    return float(2 * (rounded + 1 / longest) * it.events * it.scale)


def driven_ends(row: Any) -> bool:
    """Whether something acts on an end from outside."""
    return any(end in ("force", "velocity", "incoming") for end in row["ends"])


def is_held(row: Any) -> bool:
    """Whether walls hold the row: one at both ends, or one that is bonded to it."""
    walls = [i for i, body in enumerate(row["bodies"]) if body["kind"] == "wall"]
    last = len(row["bonded"]) - 1
    return len(walls) == 2 or any(row["bonded"][min(i, last)] for i in walls)


def able_of(row: Any) -> list[int]:
    """Contacts that can open."""
    return [k for k, bonded in enumerate(row["bonded"]) if not bonded]


def proof_of(row: Any, run: Any) -> int:
    """Tick at which the collision was proved to be over; NONE if it was not."""
    if row["until"] >= 0 and driven_ends(row):
        return NONE
    at: int = run["run"].proved
    return at


def sentence_of(row: Any, run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    it, slowest = run["run"], math.inf
    for piece in row["segments"]:
        slowest = min(slowest, piece["wave_speed"])
    error, worst = transit_error_of(row, run)
    text = status_of(it, run["node"], row["nodes"], {
        "proved": proof_of(row, run) != NONE,
        "round_trip": round_trip(run["body"], run["segment"]) * it.tick,
        "acting": "an end is driven" if driven_ends(row) else "", "held": is_held(row),
        "names": contacts_of(row["bodies"]),
    })
    return text + rounding(error, worst) + strain_warning(it.fastest / slowest)


def transit_error_of(row: Any, run: Any) -> Any:
    """Largest relative change of a transit time by its rounding to the clock, and where."""
    error, worst = -1.0, ""
    for s, piece in enumerate(row["segments"]):
        off = abs(run["segment"][s + 1].transit * run["run"].tick / piece["transit_time"] - 1)
        if off > error:
            error, worst = off, piece["path"]
    return error, worst


def why_no_restitution(
    row: Any, episodes: list[int], before: list[float], final: bool, status: str
) -> str:
    """Why there is no e, as `Outcome` has it; "" if there is one. `episodes` are by contact."""
    able, count, closing = able_of(row), 0, 0.0
    if len(able) == 1:
        count, closing = episodes[able[0]], before[able[0]] - before[able[0] + 1]
    return no_restitution(len(able), driven_ends(row), count, final, closing, status)


def restitution(contact: int, before: list[float], after: list[float]) -> float:
    """e of a contact from the velocities of the bodies."""
    parting = after[contact + 1] - after[contact]
    e = parting / (before[contact] - before[contact + 1])
    stays = parting <= ROUND_OFF * max(abs(after[contact]), abs(after[contact + 1]))
    return 0.0 if e <= ROUND_OFF or stays else e


def restitutions(case: Any, library: Any, path: list[Any], values: list[float]) -> list[Any]:
    """e for each value of a number of a case; None where there is none."""
    found: list[Any] = []
    space = space_of(row_of(case, library))
    for value in values:
        row = row_of(changed(case, path, value), library)
        run = run_of(row, False, space)
        e = None
        if run["run"].stop < Stop.OVERFLOW:
            before, after = before_and_after(row, run)
            episodes = [run["node"][k].episodes for k in row["nodes"]]
            if why_no_restitution(row, episodes, before, proof_of(row, run) != NONE, "") == "":
                e = restitution(able_of(row)[0], before, after)
        found.append(e)
    return found


def closed_form_of(row: Any, before: list[float]) -> Any:
    """e of a pair for which theory knows it, and the source; None for any other row."""
    bodies, walls = row["bodies"], 0
    if len(bodies) != 2 or row["bonded"][0] or before[0] <= before[1]:
        return None
    for body, end in zip(bodies, row["ends"], strict=True):
        walls += 1 if body["kind"] == "wall" else 0
        whole = not isinstance(body["velocity"], dict) and body["strain"] == 0.0
        if not whole or end != "free" or body["last"] > body["first"]:
            return None
    if walls > 0:
        return {"restitution": 1.0, "source": "textbook, box 10.4"}
    left, right = row["segments"]
    short_time, long_time, q, p, log_q = pair_numbers(
        left["impedance"], left["transit_time"], right["impedance"], right["transit_time"])
    e = pair_restitution(short_time, long_time, q, p, log_q) * 1.0
    return {"restitution": e, "source": "Saint-Venant 1867"}


def changed(tree: Any, path: list[Any], value: float) -> Any:
    """The tables with another number at a path."""
    if len(path) == 0:
        return value
    copy = [*tree] if isinstance(tree, list) else {**tree}
    copy[path[0]] = changed(tree[path[0]], path[1:], value)
    return copy
