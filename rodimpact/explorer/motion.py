"""What moves in a run of fronts: polygons of constant state, forces, gaps, gauges and energies.

Plain Python, which the page has as JavaScript. Tests hold all of it against `Solution`.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any

from ..methods.fronts.records import CHANGE
from ..results.clipping import region, spans
from .outcome import groups_of
from .runs import advance, begun

MOST_REGIONS = 3000  # that are drawn
MOST_TIMES = 400  # of a curve of energy
PARTS = 6  # lines that a parabola is drawn with, at least
POINTS = 240  # of a curve of energy, about


def waves_of(run: Any) -> list[Any]:
    """Ticks and values of the fronts of each line, and the integral up to each of them."""
    waves: list[Any] = [{"tick": [], "value": [], "passed": []} for _ in run["line"]]
    for r in range(run["run"].rows):
        front = run["log"][r]
        if front.line != CHANGE:
            wave = waves[front.line]
            count = len(wave["tick"])
            passed = 0.0
            if count > 0:
                lasted = front.tick - wave["tick"][count - 1]
                passed = wave["passed"][count - 1] + wave["value"][count - 1] * lasted
            wave["tick"].append(front.tick)
            wave["value"].append(front.value)
            wave["passed"].append(passed)
    return waves


def at(wave: Any, tick: int) -> float:
    """Value of a wave from a tick on."""
    value: float = wave["value"][max(0, bisect_right(wave["tick"], tick) - 1)]
    return value


def passed_by(wave: Any, tick: int) -> float:
    """Integral of a wave from its first front to a tick, velocity times ticks."""
    i = max(0, bisect_right(wave["tick"], tick) - 1)
    passed: float = wave["passed"][i] + wave["value"][i] * (tick - wave["tick"][i])
    return passed


def edges_of(wave: Any, start: int, stop: int) -> list[int]:
    """Ticks of the fronts of a wave between two ticks, and these."""
    return [start, *[tick for tick in wave["tick"] if start < tick < stop], stop]


def stretch_of(waves: list[Any], s: int, T: int) -> float:
    """How much longer segment s is at t = 0 than without strain, velocity times ticks."""
    a, b = waves[2 * s], waves[2 * s + 1]
    return (passed_by(b, 0) - passed_by(b, -T) - passed_by(a, 0) + passed_by(a, -T)) / 2


def end_of_picture(row: Any, run: Any, waves: list[Any]) -> int:
    """Last tick up to which there are few enough regions to draw; 0 if there is none."""
    stop: int = run["run"].now
    while stop > 0:
        count = 0
        for s in range(1, len(row["segments"]) + 1):
            T = run["segment"][s].transit
            ps, qs = edges_of(waves[2 * s], -T, stop), edges_of(waves[2 * s + 1], -T, stop)
            for low, high in spans(ps, qs, T, 0, stop):
                count += high - low
        if count <= MOST_REGIONS:
            break
        stop //= 2
    return stop


def tiling_of(row: Any, run: Any, waves: list[Any], stop: int) -> Any:
    """Polygons of constant state, as `Regions`, up to a tick."""
    tick, frame = run["run"].tick, run["run"].frame
    found: Any = {"body": [], "segment": [], "start": [0], "x": [], "t": [], "displacement": [],
                  "velocity": [], "strain": [], "stress": []}
    for i, body in enumerate(row["bodies"]):
        left, moved = 0.0, 0.0
        for s in range(body["first"], body["last"] + 1):
            T, piece = run["segment"][s].transit, row["segments"][s - 1]
            a, b = waves[2 * s], waves[2 * s + 1]
            ps, qs = edges_of(a, -T, stop), edges_of(b, -T, stop)
            begun, ready = passed_by(a, 0), passed_by(b, -T)
            for k, (low, high) in enumerate(spans(ps, qs, T, 0, stop)):
                right = at(a, ps[k])
                for j in range(low, high):
                    back = at(b, qs[j])
                    strain = (back - right) * (0.5 / piece["wave_speed"])
                    found["body"].append(i)
                    found["segment"].append(s)
                    found["velocity"].append((right + back) / 2 + frame)
                    found["strain"].append(strain)
                    found["stress"].append(strain * piece["youngs_modulus"])
                    for p, q in region(ps[k], ps[k + 1], qs[j], qs[j + 1], T, 0, stop):
                        u = passed_by(a, p) - begun + passed_by(b, q) - ready + frame * (p + q + T)
                        found["x"].append(left + (q - p + T) / 2 / T * piece["length"])
                        found["t"].append((p + q + T) / 2 * tick)
                        found["displacement"].append(u / 2 * tick + moved)
                    found["start"].append(len(found["x"]))
            left += piece["length"]
            moved += stretch_of(waves, s, T) * tick
    return found


def contact_curves(row: Any, run: Any, stop: int) -> list[Any]:
    """Times, s, at which a contact changes, force from then on, N, and gap, m, of each contact.

    The kernel runs again, event by event, to `stop`.
    """
    again, tick = begun(row, True, run["run"].until), run["run"].tick
    curves: list[Any] = [{"t": [], "force": [], "gap": []} for _ in row["nodes"]]
    now = 0
    while now < stop:
        now = min(again["tree"][1], stop)
        advance(again, now)
        for i, k in enumerate(row["nodes"]):
            at = again["node"][k]
            if at.since == now or now in (0, stop):
                gap = at.gap + at.rate * (now - at.since)
                curves[i]["t"].append(now * tick)
                curves[i]["force"].append(at.force)
                curves[i]["gap"].append(0.0 if row["bonded"][i] else max(gap, 0.0) * tick)
    return curves


def gauge_curve(row: Any, run: Any, waves: list[Any], body: int, x: float, stop: int) -> Any:
    """Times, s, and strain from then on, at a place of a rod, m from its left end."""
    s, left = row["bodies"][body]["first"], 0.0
    while s < row["bodies"][body]["last"] and left + row["segments"][s - 1]["length"] <= x:
        left += row["segments"][s - 1]["length"]
        s += 1
    piece, T = row["segments"][s - 1], run["segment"][s].transit
    a, b = waves[2 * s], waves[2 * s + 1]
    offset = max(0, min(T, round((x - left) / piece["length"] * T)))
    arrivals = [tick + offset for tick in a["tick"]]
    arrivals.extend([0, *[tick + T - offset for tick in b["tick"]]])
    times, strains, before = [], [], -1
    for tick in sorted(arrivals):
        if before < tick < stop:
            strain = at(b, tick - T + offset) - at(a, tick - offset)
            times.append(tick * run["run"].tick)
            strains.append(strain * (0.5 / piece["wave_speed"]))
            before = tick
    times.append(stop * run["run"].tick)
    strains.append(strains[-1])
    return {"t": times, "strain": strains}


def energy_curves(row: Any, tiling: Any) -> Any:
    """Energy by kind over time, J, from the widths of the polygons.

    Between the times of all corners the widths are linear, so momentum, kinetic and strain energy
    are; the rest is their parabolas.
    """
    knots = times_of(tiling["t"])
    moving, strained = [0.0 for _ in knots], [0.0 for _ in knots]
    momenta = [[0.0 for _ in knots] for _ in row["bodies"]]
    for i, body in enumerate(tiling["body"]):
        piece = row["segments"][tiling["segment"][i] - 1]
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
    found: Any = {"t": [], "whole": [], "vibration": [], "strain": [], "total": []}
    for k in range(len(knots)):
        for part in range(parts if k < len(knots) - 1 else 1):
            share, after, whole = part / parts, min(k + 1, len(knots) - 1), 0.0
            for group in groups_of(row):
                mass, momentum = 0.0, 0.0
                for i in group:
                    mass += row["bodies"][i]["mass"]
                    momentum += momenta[i][k] + (momenta[i][after] - momenta[i][k]) * share
                whole += momentum * momentum / (2 * mass) if mass > 0 else 0.0
            kinetic = moving[k] + (moving[after] - moving[k]) * share
            strain = strained[k] + (strained[after] - strained[k]) * share
            found["t"].append(knots[k] + (knots[after] - knots[k]) * share)
            found["whole"].append(whole)
            found["vibration"].append(kinetic - whole)
            found["strain"].append(strain)
            found["total"].append(kinetic + strain)
    return found


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
