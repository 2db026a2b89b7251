"""Waves between fronts in plain lists, and the polygons of constant state that they cut.

For figures and, as JavaScript, for the page. A wave is a table of lists: `tick` of its fronts,
`value` from each of them on, and `passed`, its integral from its first front to each of them.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from .clipping import region, spans


def wave_of(ticks: list[int], values: list[float]) -> Any:
    """A wave, from its fronts."""
    passed = [0.0]
    for i in range(len(ticks) - 1):
        passed.append(passed[i] + values[i] * (ticks[i + 1] - ticks[i]))
    return {"tick": ticks, "value": values, "passed": passed}


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


def stretch_of(piece: Any) -> float:
    """How much longer a segment is at t = 0 than without strain, velocity times ticks."""
    a, b, T = piece["rightward"], piece["leftward"], piece["ticks"]
    return (passed_by(b, 0) - passed_by(b, -T) - passed_by(a, 0) + passed_by(a, -T)) / 2


def count_of(rods: Any, start: int, stop: int, limit: float) -> int:
    """Number of regions; of more than `limit` not all are counted."""
    count = 0
    for rod in rods:
        for piece in rod["pieces"]:
            T = piece["ticks"]
            if count <= limit:
                ps = edges_of(piece["rightward"], start - T, stop)
                qs = edges_of(piece["leftward"], start - T, stop)
                for low, high in spans(ps, qs, T, start, stop):
                    count += high - low
    return count


def polygons_of(rods: Any, tick: float, frame: float, start: int, stop: int) -> Any:
    """Polygons of constant state between two ticks, as `Regions` has them.

    Parameters
    ----------
    rods : list of dict
        Each with its ``body`` and its ``pieces``: ``ticks``, ``length``, ``wave_speed`` and
        ``youngs_modulus`` of a segment, and the waves ``rightward`` and ``leftward`` that leave
        its ends, velocities in a frame.
    tick : float
        s.
    frame : float
        Its velocity, m/s.
    start, stop : int
    """
    found: Any = {"body": [], "segment": [], "start": [0], "x": [], "t": [], "displacement": [],
                  "velocity": [], "strain": [], "stress": []}
    for rod in rods:
        left, moved = 0.0, 0.0
        for s, piece in enumerate(rod["pieces"]):
            a, b, T, length = piece["rightward"], piece["leftward"], piece["ticks"], piece["length"]
            ps, qs = edges_of(a, start - T, stop), edges_of(b, start - T, stop)
            begun, ready = passed_by(a, 0), passed_by(b, -T)
            for k, (low, high) in enumerate(spans(ps, qs, T, start, stop)):
                right = at(a, ps[k])
                for j in range(low, high):
                    back = at(b, qs[j])
                    strain = (back - right) * (0.5 / piece["wave_speed"])
                    found["body"].append(rod["body"])
                    found["segment"].append(s)
                    found["velocity"].append((right + back) / 2 + frame)
                    found["strain"].append(strain)
                    found["stress"].append(strain * piece["youngs_modulus"])
                    for p, q in region(ps[k], ps[k + 1], qs[j], qs[j + 1], T, start, stop):
                        u = passed_by(a, p) - begun + passed_by(b, q) - ready + frame * (p + q + T)
                        found["x"].append(left + (q - p + T) / 2 / T * length)
                        found["t"].append((p + q + T) / 2 * tick)
                        found["displacement"].append(u / 2 * tick + moved)
                    found["start"].append(len(found["x"]))
            left += length
            moved += stretch_of(piece) * tick
    return found
