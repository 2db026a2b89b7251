"""The state of a rod at one time as profiles with which a system can begin.

Waves that are constant between fronts make `Steps`, exactly. Others make `Samples`, as many as
straight lines between them need. A sample is the mean over the distance of two samples, so that
momentum and stretch are kept where the state jumps, too.
"""

import math
from typing import Any

import numpy as np

from ..methods.signals import Floats
from ..model import Samples, Steps
from ..model.frozen import Number
from .fields import Fields
from .wave_fields import WaveFields

ACCURACY = (
    1e-10  # of the largest wave, to which samples follow the state where it is smooth
)
FEWEST, MOST = 1 << 10, 1 << 16  # distances between samples of a rod
FLAT = 1e-14  # change within a piece, of the largest wave, that is round-off


def state_profiles(fields: Fields, body: int, tick: int) -> dict[str, Any]:
    """Velocity, m/s, and strain of a rod just after `tick`, as profiles, by name."""
    count, scale = 0, 0.0
    if isinstance(fields, WaveFields) and not fields.constant_between_fronts:
        count, scale = _distances(fields, body, tick)
        if count:
            return _samples(fields, body, tick, count)
    profile = fields.profile(body, tick)
    alike = FLAT * scale
    return {
        "velocity": _steps(profile.edges, profile.velocity, alike),
        "strain": _steps(
            profile.edges, profile.strain, alike / max(fields.clock.wave_speed)
        ),
    }


def _distances(fields: WaveFields, body: int, tick: int) -> tuple[int, float]:
    """How many distances between samples the waves in a rod need, 0 if none; the largest wave."""
    a, length = fields.clock, float(fields.edges(body)[-1])
    waves = [
        (wave.within(tick - T, tick), T / a.length[s])  # with its speed, ticks a m
        for s, T, *both in fields.along(body)
        for wave in both
    ]
    scale = max(float(np.abs(wave.coefficients).sum(axis=1).max()) for wave, _ in waves)
    swing = max(
        float(np.abs(wave.coefficients[:, 1:]).sum(axis=1).max()) for wave, _ in waves
    )
    bend = max(
        float((w.bends * (2 * speed / w.widths) ** 2).max()) for w, speed in waves
    )
    if swing <= FLAT * scale:
        return 0, scale
    # a straight line over h is off by h^2/8 of the second derivative, a mean over h by h^2/24
    needed = length * math.sqrt(bend / (6 * ACCURACY * scale))
    return int(min(max(FEWEST, math.ceil(needed)), MOST)), scale


def _samples(fields: WaveFields, body: int, tick: int, count: int) -> dict[str, Any]:
    """Means around even places; at the ends the values there."""
    a, corners = fields.clock, fields.edges(body)
    borders = corners[-1] / count * (np.arange(count + 2) - 0.5)
    borders[[0, -1]] = 0.0, corners[-1]
    moved = stretched = np.zeros(count + 2)
    for (s, T, *waves), corner in zip(fields.along(body), corners, strict=False):
        share = (borders - corner) / a.length[s]
        offset = np.rint(np.clip(share, 0.0, 1.0) * T).astype(np.int64)
        A, B = (wave.within(tick - T, tick) for wave in waves)
        right, left = (
            A.integral(tick - offset, tick),
            B.integral(tick - T, tick - T + offset),
        )
        moved = moved + (left + right) / 2 * (a.length[s] / T)
        stretched = stretched + (left - right) / 2 * (a.length[s] / T / a.wave_speed[s])
    velocity, strain = (
        np.diff(total) / np.diff(borders) for total in (moved, stretched)
    )
    velocity += a.frame + a.gravity * tick * a.tick
    for values, field in ((velocity, fields.velocity), (strain, fields.strain)):
        values[[0, -1]] = field(body, corners[[0, -1]], tick * a.tick)
    return {"velocity": Samples(velocity), "strain": Samples(strain)}


def _steps(edges: Floats, values: Floats, alike: float) -> Number | Steps:
    keep = np.concatenate(([True], np.abs(np.diff(values)) > alike))
    if keep.sum() == 1:
        return float(values[0])
    return Steps(values[keep].tolist(), edges[:-1][keep][1:].tolist())
