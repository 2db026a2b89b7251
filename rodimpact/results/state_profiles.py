"""The state of a rod at one time as profiles with which a system can begin.

Waves that are constant between fronts make `Steps`, others `Polynomials`. Both are the waves
themselves: a run that goes on from them is as exact as one that did not stop.
"""

from typing import Any

import numpy as np

from ..methods.signals import Floats, Ints, Pieces, each_once
from ..model import Polynomials, Steps
from ..model.frozen import Number
from .fields import Fields
from .wave_extremes import SLIVER_TICKS
from .wave_fields import WaveFields

FLAT = 1e-14  # change within a piece, of the largest wave, that is round-off


def state_profiles(
    fields: Fields, body: int, tick: int, error: float
) -> dict[str, Any]:
    """Velocity, m/s, and strain of a rod just after `tick`, as profiles, by name.

    `error` is the stated error of velocities, m/s.
    """
    scale = 0.0
    if isinstance(fields, WaveFields) and not fields.constant_between_fronts:
        scale, swing = _sizes(fields, body, tick)
        if swing > FLAT * scale:
            return _polynomials(fields, body, tick, error)
    profile = fields.profile(body, tick)
    alike = FLAT * scale
    return {
        "velocity": _steps(profile.edges, profile.velocity, alike),
        "strain": _steps(
            profile.edges, profile.strain, alike / max(fields.clock.wave_speed)
        ),
    }


def _sizes(fields: WaveFields, body: int, tick: int) -> tuple[float, float]:
    """Largest wave in a rod, and largest change within a piece of a wave, m/s."""
    scale = 0.0
    swing = 0.0
    for _, transit, *waves in fields.waves_along(body):
        for wave in waves:
            sizes = np.abs(wave.within(tick - transit, tick).coefficients)
            scale = max(scale, float(sizes.sum(axis=1).max()))
            swing = max(swing, float(sizes[:, 1:].sum(axis=1).max()))
    return scale, swing


def _polynomials(
    fields: WaveFields, body: int, tick: int, error: float
) -> dict[str, Any]:
    """Both profiles, in intervals in which both waves are single polynomials."""
    clock = fields.clock
    corners = fields.edges(body)
    fall = clock.frame + clock.gravity * tick * clock.tick
    count = max(
        2, *(wave.size for _, _, *waves in fields.waves_along(body) for wave in waves)
    )
    shares = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    borders: list[float] = []
    velocities = []
    strains = []
    for (s, transit, right, left), corner in zip(
        fields.waves_along(body), corners, strict=False
    ):
        edges = _edges_of_waves(right, left, tick, transit)
        # what is at `edge` ticks from the left end left that end so many ticks ago
        a = right.inside(tick - edges[1:], tick - edges[:-1], shares)[:, ::-1]
        b = left.inside(tick - transit + edges[:-1], tick - transit + edges[1:], shares)
        ones = np.ones(count)
        velocities.append((a + b) / 2 * ones + fall)
        strains.append((b - a) / (2 * clock.wave_speed[s]) * ones)
        places = corner + clock.length[s] * (edges / transit)
        borders.extend(places[:-1].tolist())
    inner = None
    if len(borders) > 1:
        inner = borders[1:]
    slowest = min(clock.wave_speed[s] for s, *_ in fields.waves_along(body))
    return {
        "velocity": Polynomials(np.concatenate(velocities).ravel(), inner, error=error),
        "strain": Polynomials(
            np.concatenate(strains).ravel(), inner, error=error / slowest
        ),
    }


def _edges_of_waves(right: Pieces, left: Pieces, tick: int, transit: int) -> Ints:
    """Places in a segment at which one of its waves breaks, ticks from its left end.

    Intervals that last no longer than a sliver come of round-off, and are left out.
    """
    start = tick - transit
    from_right = tick - right.breaks_in(start, tick)
    from_left = left.breaks_in(start, tick) - start
    edges = each_once([0], from_right, from_left, [transit])
    kept = [0]
    for edge in edges[1:-1].tolist():
        if edge - kept[-1] > SLIVER_TICKS and transit - edge > SLIVER_TICKS:
            kept.append(edge)
    kept.append(int(transit))
    return np.array(kept)


def _steps(edges: Floats, values: Floats, alike: float) -> Number | Steps:
    keep = np.concatenate(([True], np.abs(np.diff(values)) > alike))
    if keep.sum() == 1:
        return float(values[0])
    return Steps(values[keep].tolist(), edges[:-1][keep][1:].tolist())
