"""What moves in a run of characteristics: grids of cells, forces, gaps, gauges and energies.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.laws import Law
from ..methods.pieces import lines, reading
from ..methods.pieces.method import RTOL
from .motion import energy_as_a_whole
from .tiling import ROWS, across_of, add_cells, no_cells

SAMPLES = 400  # of a curve
INSIDE = 8  # points of a curve in one piece
FINEST = 5e-5  # of the run, between two of them
MOMENTS, FEW = 100, 30  # of the energy: of a solution, and of a draft
POINTS = 32  # of a segment, for its strain energy


def waves_of(run: Any) -> list[Any]:
    """What every line holds."""
    pieces = run["log"][: run["ended"].run.pieces]
    return reading.waves_of(pieces, len(run["line"]))


def grids_of(run: Any, waves: list[Any]) -> Any:
    """Grids of equal height, as of `tiling`."""
    row, tick, frame, found = run["row"], run["clock"].tick, run["clock"].frame, no_cells()
    for i, body in enumerate(row.system.bodies):
        left, moved = 0.0, 0.0
        for j, piece in enumerate(body.segments):
            s = row.spans[i][0] - 1 + j
            T, a, b = run["clock"].transits[s], waves[2 * s], waves[2 * s + 1]
            begun, across = reading.passed_by(a, 0)[0], across_of(row.system, piece)
            rows: list[list[float]] = []
            for k in range(ROWS + 1):
                now = run["now"] * k / ROWS
                rows.append([
                    ((reading.passed_by(a, now - T * m / across)[0] - begun
                      + reading.passed_by(b, now - T + T * m / across)[0]) / 2
                     + frame * now) * tick + moved for m in range(across + 1)])
            add_cells(found, i, piece, left, run["now"] * tick, rows)
            left += piece.length
            moved += body.strain * piece.length
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
    return [at * tick for at, _ in found], [value * factor for _, value in found]


def path_of(run: Any, wave: Any) -> Any:
    """Times, s, and displacement of a mass, m."""
    tick, frame = run["clock"].tick, run["clock"].frame
    even = [run["now"] * k / SAMPLES for k in range(SAMPLES + 1)]
    return {"t": [at * tick for at in even],
            "displacement": [(reading.passed_by(wave, at)[0] + frame * at) * tick for at in even]}


def gauge_curve(run: Any, waves: list[Any], s: int, x: float) -> Any:
    """Times, s, and strains at a place of segment s, m from its left end."""
    piece, T, tick = run["row"].segments[s], run["clock"].transits[s], run["clock"].tick
    after, a, b = x / piece.length * T, waves[2 * s], waves[2 * s + 1]
    even = [run["now"] * k / SAMPLES for k in range(SAMPLES + 1)]
    return [at * tick for at in even], [
        (reading.value_at(b, at - T + after) - reading.value_at(a, at - after))
        * (0.5 / piece.wave_speed) for at in even]


def strain_energy(run: Any, waves: list[Any], now: float) -> float:
    """Strain energy of all rods at a tick, J: from states at even places between jumps."""
    total = 0.0
    for s, piece in enumerate(run["row"].segments):
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
            total += piece.mass * wide / T * square / count / 8
    return total


def jumps_between(wave: Any, start: float, stop: float) -> list[float]:
    """Ticks between two at which a wave jumps."""
    first, last = reading.place_of(wave, start) + 1, reading.place_of(wave, stop)
    found = [piece.start for piece in wave["piece"][first : last + 1] if piece.order == 0]
    return found if len(found) < POINTS else []


def energy_curves(run: Any, waves: list[Any]) -> Any:
    """Energy by kind over time, J."""
    row, frame, link = run["row"], run["clock"].frame, run["ended"].link
    soft = "in compliant contacts"
    found: Any = {"t": [], "moving as a whole": [], "vibration": [], "strain": [], "total": []}
    springs = [i for i in row.contact_link if link[i].law >= Law.SPRING]
    if len(springs) > 0:
        found[soft] = []
    moments = FEW if run["goal"] > RTOL else MOMENTS
    for j in range(moments + 1):
        now, inside, contact = run["now"] * j / moments, 0.0, 0.0
        momenta = []
        for i, body in enumerate(row.system.bodies):
            momentum, m = body.mass * frame, row.mass_of[i]
            for s in range(row.spans[i][0] - 1, row.spans[i][1]):
                mean, square = means_of(run, waves, s, now)
                momentum += row.segments[s].mass * mean
                inside += row.segments[s].mass * (square + frame * (mean + frame / 2))
            if m >= 0:
                v = reading.value_at(waves[run["mass"][m].line], now)
                momentum += body.mass * v
                inside += body.mass * (v + frame) ** 2 / 2
            momenta.append(momentum)
        for i in springs:
            d, power = max(0.0, reading.value_at(waves[link[i].overlap_line], now)), 1.0
            power += link[i].exponent
            contact += link[i].stiffness * d**power / power
        whole, strain = energy_as_a_whole(row.system, momenta), strain_energy(run, waves, now)
        found["t"].append(now * run["clock"].tick)
        found["moving as a whole"].append(whole)
        found["vibration"].append(max(0.0, inside - whole - strain))
        found["strain"].append(strain)
        if len(springs) > 0:
            found[soft].append(contact)
        found["total"].append(inside + contact)
    return found


def means_of(run: Any, waves: list[Any], s: int, now: float) -> Any:
    """Mean velocity of a segment in the frame, and energy over mass, (m/s)^2."""
    T, mean, square = run["clock"].transits[s], 0.0, 0.0
    for wave in waves[2 * s : 2 * s + 2]:
        passed, squares = reading.passed_by(wave, now)
        before, squares_before = reading.passed_by(wave, now - T)
        mean += (passed - before) / T / 2
        square += (squares - squares_before) / T / 4
    return mean, square
