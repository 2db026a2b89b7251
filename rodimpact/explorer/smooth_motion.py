"""What moves in a run of characteristics: grids of cells, forces, gaps, gauges and energies.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.laws import Law
from ..methods.pieces import lines, reading
from .outcome import groups_of

CELLS, ROWS = 2000, 50  # in all, about, and one above the other
SAMPLES = 400  # of a curve
INSIDE = 8  # points of a curve in one piece
FINEST = 5e-5  # of the run, between two of them
MOMENTS = 100  # of the energy
POINTS = 32  # of a segment, for its strain energy


def waves_of(run: Any) -> list[Any]:
    """What every line holds."""
    pieces = run["log"][: run["ended"].run.pieces]
    return reading.waves_of(pieces, len(run["line"]))


def grids_of(row: Any, run: Any, frame: float, waves: list[Any]) -> Any:
    """Grids of equal height with cells of about equal width, as `tiling.grids`."""
    tick, total = run["clock"].tick, 0.0
    for piece in row["segments"]:
        total += piece["length"]
    found: Any = {"start": [0], "body": [], "across": [], "x": [], "t": [], "displacement": [],
                  "velocity": [], "strain": [], "stress": []}
    for i, body in enumerate(row["bodies"]):
        left, moved = 0.0, 0.0
        for s in range(body["first"] - 1, body["last"]):
            T, piece = run["clock"].transits[s], row["segments"][s]
            a, b, L = waves[2 * s], waves[2 * s + 1], piece["length"]
            across = max(1, round(CELLS / ROWS * L / total))
            begun = reading.passed_by(a, 0)
            before: list[float] = []
            for j in range(ROWS + 1):
                now = run["now"] * j / ROWS
                here: list[float] = []
                for k in range(across + 1):
                    p, q = now - T * k / across, now - T + T * k / across
                    u = (reading.passed_by(a, p) - begun + reading.passed_by(b, q)) / 2
                    here.append((u + frame * now) * tick + moved)
                    found["x"].append(left + L * k / across)
                    found["t"].append(now * tick)
                for k in range(across if j > 0 else 0):
                    strain = (here[k + 1] - here[k] + before[k + 1] - before[k]) / 2 * across / L
                    rise = here[k] + here[k + 1] - before[k] - before[k + 1]
                    found["velocity"].append(rise / 2 / (run["now"] * tick / ROWS))
                    found["strain"].append(strain)
                    found["stress"].append(strain * piece["youngs_modulus"])
                found["displacement"].extend(here)
                before = here
            found["body"].append(i)
            found["across"].append(across)
            found["start"].append(len(found["x"]))
            left += L
            moved += body["strain"] * L
    return found


def line_curve(run: Any, wave: Any, factor: float) -> Any:
    """Times, s, and values of a line times a factor, as close as its pieces bend.

    Where pieces are many, values at even times.
    """
    tick, now = run["clock"].tick, run["now"]
    found: list[Any] = []
    for piece in wave["piece"]:
        stop = min(piece.stop, now)
        parts = 1 if piece.degree == 0 else INSIDE
        for k in range(parts + 1 if stop > piece.start else 0):
            at = piece.start + (stop - piece.start) * k / parts
            last = found[-1][0] if len(found) > 0 else -now
            if at in (last, now) or at - last > FINEST * now:  # two at once where it jumps
                found.append((at, lines.at(piece, reading.share_of(piece, at))))
    if len(found) > 2 * SAMPLES:
        even = [now * k / SAMPLES for k in range(SAMPLES + 1)]
        found = [(at, reading.value_at(wave, at)) for at in even]
    return {"t": [at * tick for at, _ in found], "y": [value * factor for _, value in found]}


def path_of(run: Any, frame: float, wave: Any) -> Any:
    """Times, s, and displacement of a mass, m."""
    tick, even = run["clock"].tick, [run["now"] * k / SAMPLES for k in range(SAMPLES + 1)]
    return {"t": [at * tick for at in even],
            "displacement": [(reading.passed_by(wave, at) + frame * at) * tick for at in even]}


def gauge_curve(row: Any, run: Any, waves: list[Any], body: Any, x: float) -> Any:
    """Times, s, and strain at a place of a rod, m from its left end."""
    s, left = body["first"] - 1, 0.0
    while s < body["last"] - 1 and left + row["segments"][s]["length"] <= x:
        left += row["segments"][s]["length"]
        s += 1
    piece, T, tick = row["segments"][s], run["clock"].transits[s], run["clock"].tick
    after, a, b = (x - left) / piece["length"] * T, waves[2 * s], waves[2 * s + 1]
    even = [run["now"] * k / SAMPLES for k in range(SAMPLES + 1)]
    return {"t": [at * tick for at in even], "strain": [
        (reading.value_at(b, at - T + after) - reading.value_at(a, at - after))
        * (0.5 / piece["wave_speed"]) for at in even]}


def strain_energy(row: Any, run: Any, waves: list[Any], now: float) -> float:
    """Strain energy of all rods at a tick, J: from states at even places between jumps."""
    total = 0.0
    for s, piece in enumerate(row["segments"]):
        a, b, T = waves[2 * s], waves[2 * s + 1], run["clock"].transits[s]
        edges = [0.0, *[now - tick for tick in jumps_between(a, now - T, now)]]
        edges.extend([tick - now + T for tick in jumps_between(b, now - T, now)])
        edges = [*sorted(edges), T]
        for i in range(len(edges) - 1):
            wide, square = edges[i + 1] - edges[i], 0.0
            count = 1 + int(POINTS * wide / T)
            for k in range(count):
                after = edges[i] + wide * (k + 0.5) / count
                square += (reading.value_at(b, now - T + after)
                           - reading.value_at(a, now - after)) ** 2
            total += piece["mass"] * wide / T * square / count / 8
    return total


def jumps_between(wave: Any, start: float, stop: float) -> list[float]:
    """Ticks between two at which a wave jumps."""
    first, last = reading.place_of(wave, start) + 1, reading.place_of(wave, stop)
    found = [piece.start for piece in wave["piece"][first : last + 1] if piece.order == 0]
    return found if len(found) < POINTS else []


def energy_curves(row: Any, known: Any, run: Any, waves: list[Any]) -> Any:
    """Energy by kind over time, J."""
    found: Any = {"t": [], "whole": [], "vibration": [], "strain": [], "contact": [], "total": []}
    given, tick, link = known["given"], run["clock"].tick, run["ended"].link
    for j in range(MOMENTS + 1):
        now = run["now"] * j / MOMENTS
        inside, whole, contact = 0.0, 0.0, 0.0
        speeds, m = [], 0
        for body in row["bodies"]:
            momentum = body["mass"] * given.frame
            for s in range(body["first"] - 1, body["last"]):
                mean, square = means_of(run, waves, s, now)
                momentum += given.weight[s] * mean
                inside += given.weight[s] * (square + given.frame * (mean + given.frame / 2))
            if body["kind"] == "mass":
                v = reading.value_at(waves[run["mass"][m].line], now)
                momentum += body["mass"] * v
                inside += body["mass"] * (v + given.frame) ** 2 / 2
                m += 1
            speeds.append(momentum)
        for group in groups_of(row):
            momentum, mass = 0.0, 0.0
            for i in group:
                momentum += speeds[i]
                mass += row["bodies"][i]["mass"]
            whole += momentum**2 / (2 * mass) if mass > 0 else 0.0
        for i in known["links"]:
            if link[i].law >= Law.SPRING:
                d = max(0.0, reading.value_at(waves[link[i].overlap_line], now))
                power = link[i].exponent + 1
                contact += link[i].stiffness * d**power / power
        strain = strain_energy(row, run, waves, now)
        found["t"].append(now * tick)
        found["whole"].append(whole)
        found["vibration"].append(max(0.0, inside - whole - strain))
        found["strain"].append(strain)
        found["contact"].append(contact)
        found["total"].append(inside + contact)
    return found


def means_of(run: Any, waves: list[Any], s: int, now: float) -> Any:
    """Mean velocity of a segment in the frame, and energy over mass, (m/s)^2."""
    T, mean, square = run["clock"].transits[s], 0.0, 0.0
    for wave in waves[2 * s : 2 * s + 2]:
        mean += (reading.passed_by(wave, now) - reading.passed_by(wave, now - T)) / T / 2
        square += (reading.squares_by(wave, now) - reading.squares_by(wave, now - T)) / T / 4
    return mean, square
