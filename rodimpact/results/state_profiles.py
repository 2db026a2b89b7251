"""The state of a rod at one time as profiles with which a system can begin.

Waves that are constant between fronts make `Steps`, others `Polynomials`. Both are the waves
themselves: a run that goes on from them is as exact as one that did not stop.
"""

import math
from typing import NamedTuple

import numpy as np

from ..methods.signals import Floats, Ints, each_once
from ..model import Polynomials, Steps
from ..model.frozen import Number
from .fields import Fields
from .wave_extremes import SLIVER_TICKS
from .wave_fields import SegmentWaves, WaveFields

CONSTANT_WAVE_RTOL = 1e-14
"""Smaller changes of a wave in a piece, over the largest wave, are round-off."""


class StateProfiles(NamedTuple):
    """State of a rod at one time, as arguments of `Rod`."""

    velocity: Number | Steps | Polynomials  # m/s
    strain: Number | Steps | Polynomials


def state_profiles(fields: Fields, body: int, tick: int, error: float) -> StateProfiles:
    """State of a rod just after `tick`, with the stated error of velocities, m/s."""
    largest_wave = 0.0
    if isinstance(fields, WaveFields) and not fields.constant_between_fronts:
        largest_wave, largest_change = _sizes(fields, body, tick)
        if largest_change > CONSTANT_WAVE_RTOL * largest_wave:
            return _polynomials(fields, body, tick, error)
    profile = fields.profile(body, tick)
    velocity_doubt = CONSTANT_WAVE_RTOL * largest_wave
    strain_doubt = velocity_doubt / max(fields.clock.wave_speed)
    return StateProfiles(
        velocity=_steps(profile.edges, profile.velocity, velocity_doubt),
        strain=_steps(profile.edges, profile.strain, strain_doubt),
    )


def _sizes(fields: WaveFields, body: int, tick: int) -> tuple[float, float]:
    """Largest wave in a rod, and largest change within a piece of a wave, m/s."""
    largest_wave = 0.0
    largest_change = 0.0
    for waves in fields.waves_along(body):
        for wave in (waves.rightward, waves.leftward):
            in_segment = wave.within(tick - waves.transit, tick)
            sizes = np.abs(in_segment.coefficients)
            largest_wave = max(largest_wave, float(sizes.sum(axis=1).max()))
            largest_change = max(largest_change, float(sizes[:, 1:].sum(axis=1).max()))
    return largest_wave, largest_change


def _polynomials(
    fields: WaveFields, body: int, tick: int, error: float
) -> StateProfiles:
    """Both profiles, in intervals in which both waves are single polynomials."""
    clock = fields.clock
    frame = clock.frame + clock.gravity * tick * clock.tick
    segments = list(fields.waves_along(body))
    count = 2
    for waves in segments:
        count = max(count, waves.rightward.size, waves.leftward.size)
    shares = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    ones = np.ones(count)  # for waves that are constant, and have one value an interval
    inner: list[float] = []
    velocities = []
    strains = []
    slowest = math.inf
    for waves, left in zip(segments, fields.edges(body), strict=False):
        T = waves.transit
        edges = _edges_of_waves(waves, tick)
        # What is at `edge` ticks from the left end left that end so many ticks ago.
        A = waves.rightward.inside(tick - edges[1:], tick - edges[:-1], shares)[:, ::-1]
        start = tick - T
        B = waves.leftward.inside(start + edges[:-1], start + edges[1:], shares)
        wave_speed = clock.wave_speed[waves.segment]
        slowest = min(slowest, wave_speed)
        velocities.append((A + B) / 2 * ones + frame)
        strains.append((B - A) / (2 * wave_speed) * ones)
        places = left + clock.length[waves.segment] * (edges / T)
        inner.extend(places[:-1].tolist())
    borders = None
    if len(inner) > 1:
        borders = inner[1:]  # the first is the left end of the rod
    velocity = np.concatenate(velocities).ravel()
    strain = np.concatenate(strains).ravel()
    return StateProfiles(
        velocity=Polynomials(velocity, borders, error=error),
        strain=Polynomials(strain, borders, error=error / slowest),
    )


def _edges_of_waves(waves: SegmentWaves, tick: int) -> Ints:
    """Places in a segment at which one of its waves breaks, ticks from its left end.

    Intervals that last no longer than a sliver come of round-off, and are left out.
    """
    transit = waves.transit
    start = tick - transit
    in_rightward = tick - waves.rightward.breaks_in(start, tick)
    in_leftward = waves.leftward.breaks_in(start, tick) - start
    edges = each_once([0], in_rightward, in_leftward, [transit])
    lasting = [0]
    for edge in edges[1:-1].tolist():
        if edge - lasting[-1] > SLIVER_TICKS and transit - edge > SLIVER_TICKS:
            lasting.append(edge)
    lasting.append(int(transit))
    return np.array(lasting)


def _steps(edges: Floats, values: Floats, doubt: float) -> Number | Steps:
    """Values between edges as steps; those that differ by up to `doubt` are one."""
    differs = np.concatenate(([True], np.abs(np.diff(values)) > doubt))
    if differs.sum() == 1:
        return float(values[0])
    starts = edges[:-1][differs]
    return Steps(values[differs].tolist(), starts[1:].tolist())
