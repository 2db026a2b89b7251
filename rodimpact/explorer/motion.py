"""What moves in a run of any method: grids of cells, paths, curves, gauges and energies.

A run is a table: its ``row``; ``tick``, s, and velocity of its ``frame``; ``transits`` of the
segments and the last tick ``now``; ``waves``, two a segment, to the right and to the left, as
`reading.waves_of` has them; waves of the velocities of ``masses``; ``springs``, pairs of the link
and the wave of its overlap. It is ``exact`` if waves are constant between their jumps, and a
``draft`` if it is to be quick. Plain Python, which the page has as JavaScript.
"""

from typing import Any

from ..methods.groups import groups
from ..methods.pieces import lines, reading
from ..storage.tables import clean
from .tiling import ROWS, across_of, add_cells, no_cells

SAMPLES = 400  # of a path
INSIDE = 8  # points of a curve in one piece
FINEST = 5e-5  # of the run, between two of them
MOMENTS, FEW = 100, 30  # of the energy: of a solution, and of a draft
MOST_TIMES = 400  # of the energy, with those at which something changes
SAME = 1e-9  # of the run: times that are one
POINTS = 32  # of a segment, for its strain energy
KINDS = [
    "moving as a whole",
    "vibration, kinetic part",
    "strain",
    "total",
    "in compliant contacts",
]
"""Of energy, in the order of `energies_at`."""


def grids_of(run: Any) -> Any:
    """Grids of equal height, as of `tiling`."""
    row, tick, frame, found = run["row"], run["tick"], run["frame"], no_cells()
    for i, body in enumerate(row.system.bodies):
        left, moved = 0.0, 0.0
        for j, piece in enumerate(body.segments):
            s = row.spans[i][0] - 1 + j
            T, a, b = run["transits"][s], run["waves"][2 * s], run["waves"][2 * s + 1]
            begun, across = reading.passed_by(a, 0)[0], across_of(row.system, piece)
            rows: list[list[float]] = []
            for k in range(ROWS + 1):
                now = run["now"] * k / ROWS
                rows.append(
                    [
                        (
                            (
                                reading.passed_by(a, now - T * m / across)[0]
                                - begun
                                + reading.passed_by(b, now - T + T * m / across)[0]
                            )
                            / 2
                            + frame * now
                        )
                        * tick
                        + moved
                        for m in range(across + 1)
                    ]
                )
            add_cells(found, i, piece, left, run["now"] * tick, rows)
            left += piece.length
            moved += body.strain * piece.length
    return found


def path_of(run: Any, i: int) -> Any:
    """Times, s, and displacement of a body without inside, m; None for a rod."""
    body, tick = run["row"].system.bodies[i], run["tick"]
    if body.kind == "rod":
        return None
    if body.kind == "wall":
        end = run["now"] * tick
        return {"t": [0.0, end], "displacement": [0.0, body.velocity * end]}
    even = [run["now"] * k / SAMPLES for k in range(SAMPLES + 1)]
    wave = run["masses"][run["row"].mass_of[i]]
    return {
        "t": [at * tick for at in even],
        "displacement": [
            (reading.passed_by(wave, at)[0] + run["frame"] * at) * tick for at in even
        ],
    }


def curve_of(run: Any, terms: Any) -> Any:
    """Curve of a sum of waves, each with its delay, ticks, and its factor: ``t``, s, and ``y``.

    As close as pieces bend; where the sum jumps there are two values at one time.
    """
    now, breaks = run["now"], [0, run["now"]]
    for wave, delay, _ in terms:
        breaks.extend(
            [start + delay for start in wave["start"] if 0 < start + delay < now]
        )
    breaks = sorted(breaks)
    times, values, last, least = [], [], -now, 0.0 if run["exact"] else FINEST * now
    for i in range(len(breaks) - 1):
        low, high = breaks[i], breaks[i + 1]
        if high > low and high - last > least:
            parts = 1 if run["exact"] else INSIDE
            for k in range(parts + 1):
                at = low + (high - low) * k / parts
                if k in (0, parts) or at - last > least:
                    times.append(at * run["tick"])
                    values.append(
                        sum(
                            factor * held_at(wave, low - delay, at - delay)
                            for wave, delay, factor in terms
                        )
                    )
                    last = at
    return {"t": times, "y": values}


def held_at(wave: Any, since: float, tick: float) -> float:
    """Value at a tick of what a wave holds since another one."""
    piece = wave["piece"][reading.place_of(wave, since)]
    return float(lines.at(piece, reading.share_of(piece, tick)))


def gauge_curve(run: Any, s: int, x: float) -> Any:
    """Curve of the strain at a place of segment s, m from its left end."""
    piece, T = run["row"].segments[s], run["transits"][s]
    after, factor = max(0, min(T, round(x / piece.length * T))), 0.5 / piece.wave_speed
    return curve_of(
        run,
        [
            (run["waves"][2 * s + 1], T - after, factor),
            (run["waves"][2 * s], after, -factor),
        ],
    )


def energy_curves(run: Any, corners: list[float]) -> Any:
    """Energy by kind over time, J, at even times and at `corners`, s, if they are few."""
    moments = FEW if run["draft"] else MOMENTS
    times = sorted(
        [
            *corners,
            *[run["now"] * k / moments * run["tick"] for k in range(moments + 1)],
        ]
    )
    least = SAME * times[-1]
    times = [t for i, t in enumerate(times) if i == 0 or t > times[i - 1] + least]
    if len(times) > MOST_TIMES:
        times = [times[-1] * i / MOST_TIMES for i in range(MOST_TIMES + 1)]
    found, rows = {"t": times}, [energies_at(run, t / run["tick"]) for t in times]
    for i, name in enumerate(KINDS if len(run["springs"]) > 0 else KINDS[:4]):
        found[name] = [row[i] for row in rows]
    return found


def energies_at(run: Any, now: float) -> list[float]:
    """Energies at a tick, J, in the order of `KINDS`."""
    row, frame, inside, contact, momenta = run["row"], run["frame"], 0.0, 0.0, []
    for i, body in enumerate(row.system.bodies):
        momentum, m = body.mass * frame, row.mass_of[i]
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            mean, square = means_of(run, s, now)
            momentum += row.segments[s].mass * mean
            inside += row.segments[s].mass * (square + frame * (mean + frame / 2))
        if m >= 0:
            v = reading.value_at(run["masses"][m], now)
            momentum += body.mass * v
            inside += body.mass * (v + frame) ** 2 / 2
        momenta.append(momentum)
    for link, overlap in run["springs"]:
        d, power = max(0.0, reading.value_at(overlap, now)), 1 + link.exponent
        contact += link.stiffness * d**power / power
    whole, strain = energy_as_a_whole(row.system, momenta), strain_energy(run, now)
    vibration = max(0.0, clean(inside - whole - strain, inside))
    return [whole, vibration, strain, inside + contact, contact]


def means_of(run: Any, s: int, now: float) -> Any:
    """Mean velocity of a segment in the frame, and energy over mass, (m/s)^2."""
    T, mean, square = run["transits"][s], 0.0, 0.0
    for wave in run["waves"][2 * s : 2 * s + 2]:
        passed, squares = reading.passed_by(wave, now)
        before, squares_before = reading.passed_by(wave, now - T)
        mean += (passed - before) / T / 2
        square += (squares - squares_before) / T / 4
    return mean, square


def strain_energy(run: Any, now: float) -> float:
    """Strain energy of all rods at a tick, J: from states at even places between jumps."""
    total = 0.0
    for s, piece in enumerate(run["row"].segments):
        a, b, T = run["waves"][2 * s], run["waves"][2 * s + 1], run["transits"][s]
        edges = [0.0, *[now - tick for tick in jumps_between(run, a, now - T, now)]]
        edges.extend([tick - now + T for tick in jumps_between(run, b, now - T, now)])
        edges = [*sorted(edges), T]
        for i in range(len(edges) - 1):
            wide = edges[i + 1] - edges[i]
            count = 1 if run["exact"] else 1 + int(POINTS * wide / T)
            after = [edges[i] + wide * (k + 0.5) / count for k in range(count)]
            square = sum(
                (reading.value_at(b, now - T + x) - reading.value_at(a, now - x)) ** 2
                for x in after
            )
            total += piece.mass * wide / T * square / count / 8
    return total


def jumps_between(run: Any, wave: Any, start: float, stop: float) -> list[float]:
    """Ticks between two at which a wave jumps."""
    first, last = reading.place_of(wave, start) + 1, reading.place_of(wave, stop)
    found = [
        piece.start for piece in wave["piece"][first : last + 1] if piece.order == 0
    ]
    return found if run["exact"] or len(found) < POINTS else []


def energy_as_a_whole(system: Any, momenta: list[float]) -> float:
    """Energy of the motion of the centres of mass, J, from the momenta of the bodies."""
    whole = 0.0
    for group in groups(system):
        mass = sum(system.bodies[i].mass for i in group)
        momentum = sum(momenta[i] for i in group)
        whole += momentum * momentum / (2 * mass) if mass > 0 else 0.0
    return whole
