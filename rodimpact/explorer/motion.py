"""What moves in a run of fronts: polygons of constant state, forces, gaps, gauges and energies.

Plain Python, which the page has as JavaScript. Tests hold all of it against `Solution`.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any

from ..methods.fronts.records import CHANGE
from ..methods.groups import groups
from ..results.front_polygons import at, count_of, wave_of
from .runs import advance, begun

MOST_REGIONS = 3000  # that are drawn
MOST_TIMES = 400  # of a curve of energy
PARTS = 6  # lines that a parabola is drawn with, at least
POINTS = 240  # of a curve of energy, about


def rods_of(run: Any) -> Any:
    """The bodies with their waves, as `polygons_of` has them; walls have no pieces."""
    ticks: list[list[int]] = [[] for _ in run["line"]]
    values: list[list[float]] = [[] for _ in run["line"]]
    for r in range(run["run"].rows):
        front = run["log"][r]
        if front.line != CHANGE:
            ticks[front.line].append(front.tick)
            values[front.line].append(front.value)
    row = run["plan"].row
    return [{"body": i, "pieces": [
        {"length": row.segments[s - 1].length, "wave_speed": row.segments[s - 1].wave_speed,
         "area": row.segments[s - 1].area, "mass": row.segments[s - 1].mass,
         "youngs_modulus": row.segments[s - 1].material.youngs_modulus,
         "ticks": run["segment"][s].transit, "rightward": wave_of(ticks[2 * s], values[2 * s]),
         "leftward": wave_of(ticks[2 * s + 1], values[2 * s + 1])}
        for s in range(first, last + 1)
    ]} for i, (first, last) in enumerate(row.spans)]


def end_of_picture(rods: Any, stop: int) -> int:
    """Last tick up to which there are few enough regions to draw; 0 if there is none."""
    while stop > 0 and count_of(rods, 0, stop, MOST_REGIONS) > MOST_REGIONS:
        stop //= 2
    return stop


def contact_curves(run: Any, stop: int) -> list[Any]:
    """Force, N, and gap, m, of each contact, at the times at which the contact changes.

    The kernel runs again, event by event, to `stop`.
    """
    again, tick = begun(run), run["run"].tick
    contacts, laws = run["plan"].contacts, run["plan"].row.system.contacts
    curves: list[Any] = [
        {"force": ([], []), "gap": ([], []) if law.opens else None} for law in laws]
    now = 0
    while now < stop:
        now = min(again["tree"][1], stop)
        advance(again, now)
        for i, k in enumerate(contacts):
            at = again["node"][k]
            if at.since == now or now in (0, stop):
                curves[i]["force"][0].append(now * tick)
                curves[i]["force"][1].append(at.force)
                if laws[i].opens:
                    gap = at.gap + at.rate * (now - at.since)
                    curves[i]["gap"][0].append(now * tick)
                    curves[i]["gap"][1].append(max(gap, 0.0) * tick)
    return curves


def gauge_curve(piece: Any, tick: float, x: float, stop: int) -> Any:
    """Times, s, and strains from then on, at a place of a segment, m from its left end."""
    a, b, T = piece["rightward"], piece["leftward"], piece["ticks"]
    offset = max(0, min(T, round(x / piece["length"] * T)))
    arrivals = [sent + offset for sent in a["tick"]]
    arrivals.extend([0, *[sent + T - offset for sent in b["tick"]]])
    times, strains, before = [], [], -1
    for arrival in sorted(arrivals):
        if before < arrival < stop:
            strain = at(b, arrival - T + offset) - at(a, arrival - offset)
            times.append(arrival * tick)
            strains.append(strain * (0.5 / piece["wave_speed"]))
            before = arrival
    times.append(stop * tick)
    strains.append(strains[-1])
    return times, strains


def energy_curves(system: Any, rods: Any, tiling: Any) -> Any:
    """Energy by kind over time, J, from the widths of the polygons.

    Between the times of all corners the widths are linear, so momentum, kinetic and strain energy
    are; the rest is their parabolas.
    """
    knots = times_of(tiling["t"])
    moving, strained = [0.0 for _ in knots], [0.0 for _ in knots]
    momenta = [[0.0 for _ in knots] for _ in system.bodies]
    for i, body in enumerate(tiling["body"]):
        piece = rods[body]["pieces"][tiling["segment"][i]]
        first, end = tiling["start"][i], tiling["start"][i + 1]
        per_length, v = piece["mass"] / piece["length"], tiling["velocity"][i]
        x, t = tiling["x"][first:end], tiling["t"][first:end]
        low, high = t[0], t[0]
        for when in t:
            low, high = min(low, when), max(high, when)
        for k in range(max(0, bisect_right(knots, low) - 1), bisect_right(knots, high)):
            width = width_at(x, t, knots[k])
            moving[k] += per_length * v * v / 2 * width
            strained[k] += piece["area"] * tiling["stress"][i] * tiling["strain"][i] / 2 * width
            momenta[body][k] += per_length * v * width
    parts = max(PARTS, POINTS // len(knots)) if len(knots) <= MOST_TIMES else 1
    found: Any = {"t": [], "moving as a whole": [], "vibration": [], "strain": [], "total": []}
    for k in range(len(knots)):
        for part in range(parts if k < len(knots) - 1 else 1):
            share, after = part / parts, min(k + 1, len(knots) - 1)
            whole = energy_as_a_whole(system, [
                p[k] + (p[after] - p[k]) * share for p in momenta])
            kinetic = moving[k] + (moving[after] - moving[k]) * share
            strain = strained[k] + (strained[after] - strained[k]) * share
            found["t"].append(knots[k] + (knots[after] - knots[k]) * share)
            found["moving as a whole"].append(whole)
            found["vibration"].append(kinetic - whole)
            found["strain"].append(strain)
            found["total"].append(kinetic + strain)
    return found


def energy_as_a_whole(system: Any, momenta: list[float]) -> float:
    """Energy of the motion of the centres of mass, J, from the momenta of the bodies."""
    whole = 0.0
    for group in groups(system):
        mass, momentum = 0.0, 0.0
        for i in group:
            mass += system.bodies[i].mass
            momentum += momenta[i]
        whole += momentum * momentum / (2 * mass) if mass > 0 else 0.0
    return whole


def times_of(corners: list[float]) -> list[float]:
    """Each time once, in order; even ones, if they are too many."""
    found: list[float] = []
    for t in sorted(corners):
        if len(found) == 0 or t > found[-1]:
            found.append(t)
    if len(found) <= MOST_TIMES:
        return found
    return [found[-1] * i / MOST_TIMES for i in range(MOST_TIMES + 1)]


def width_at(x: list[float], t: list[float], when: float) -> float:
    """Width of a polygon at a time, m."""
    low, high = math.inf, -math.inf
    for k in range(len(t)):
        after = (k + 1) % len(t)
        if min(t[k], t[after]) <= when <= max(t[k], t[after]):
            share = 0.0 if t[k] == t[after] else (when - t[k]) / (t[after] - t[k])
            place = x[k] + (x[after] - x[k]) * share
            low, high = min(low, place), max(high, place)
            if t[k] == t[after]:
                low, high = min(low, x[after]), max(high, x[after])
    return high - low if high > low else 0.0
