"""The state of a rod at one time as profiles, from which a new system can start.

Waves that are constant between fronts become `Steps`, other waves `Polynomials`. Both
represent the waves exactly: a run that continues from them is as exact as one long run.
"""

from typing import NamedTuple

import numpy as np

from ..methods.signals import Floats, Ints
from ..model import Polynomials, Steps
from ..model.frozen import Number
from .fields import Fields
from .segment_waves import SegmentWaves
from .wave_extremes import SLIVER_TICKS
from .wave_fields import WaveFields

CONSTANT_WAVE_RTOL = 1e-14
"""Smaller changes of a wave in a piece, over the largest wave, are round-off."""


class StateProfiles(NamedTuple):
    """State of a rod at one time, as arguments of `Rod`."""

    velocity: Number | Steps | Polynomials  # m/s
    strain: Number | Steps | Polynomials


class WaveSizes(NamedTuple):
    """Sizes of the waves in a rod, m/s."""

    wave: float  # the largest wave
    change: float  # the largest change within a piece of a wave


def state_profiles(fields: Fields, body: int, tick: int, error: float) -> StateProfiles:
    """Velocity and strain of a rod just after `tick`, as profiles along it.

    They are `Polynomials` if a wave changes within a piece by more than round-off. Else
    each is `Steps`, or a number if it is constant along the rod. Only polynomials get
    the stated `error` of velocities, m/s. On a grid each cell is a step, unless its
    neighbour has the same value.
    """
    # The largest wave determines the round-off of steps. It is left at 0 on a grid and
    # for waves that are constant between fronts: there every difference is a step.
    largest_wave = 0.0
    if isinstance(fields, WaveFields) and not fields.constant_between_fronts:
        largest = _largest_waves(fields, body, tick)
        largest_wave = largest.wave
        if largest.change > CONSTANT_WAVE_RTOL * largest.wave:
            return _polynomials(fields, body, tick, error)
    profile = fields.profile(body, tick)
    velocity_round_off = CONSTANT_WAVE_RTOL * largest_wave
    # The fastest segment of the row gives the strictest bound.
    strain_round_off = velocity_round_off / max(fields.clock.wave_speed)
    return StateProfiles(
        velocity=_steps(profile.edges, profile.velocity, velocity_round_off),
        strain=_steps(profile.edges, profile.strain, strain_round_off),
    )


def _largest_waves(fields: WaveFields, body: int, tick: int) -> WaveSizes:
    """Bounds of the waves in a rod at `tick`, m/s, over all its segments.

    No Chebyshev polynomial exceeds 1, so a wave in a piece is at most the sum of its
    absolute coefficients. Its change from the first coefficient, the constant one, is
    at most the sum of the others.
    """
    largest_wave = 0.0
    largest_change = 0.0
    for waves in fields.waves_along(body):
        start = tick - waves.transit
        for wave in (waves.rightward, waves.leftward):
            # [piece, coefficient]
            sizes = np.abs(wave.within(start, tick).coefficients)
            wave_sizes = sizes.sum(axis=1)
            changes = sizes[:, 1:].sum(axis=1)
            largest_wave = max(largest_wave, float(wave_sizes.max()))
            largest_change = max(largest_change, float(changes.max()))
    return WaveSizes(largest_wave, largest_change)


def _polynomials(
    fields: WaveFields, body: int, tick: int, error: float
) -> StateProfiles:
    """Velocity and strain of a rod at `tick`, as `Polynomials`.

    `error` is the error of velocities, m/s; the error of strains is error/c with the
    slowest c. In each interval both waves are single polynomials. An interval has as
    many values as the longest polynomial has coefficients, at Chebyshev-Lobatto points.
    The velocity is (A + B)/2 plus that of the frame, and the strain (B - A)/(2 c), see
    `SegmentWaves`.
    """
    frame = fields.frame_velocity(tick)
    segments = list(fields.waves_along(body))
    count = 2  # values of an interval: `Polynomials` need at least two
    for waves in segments:
        count = max(
            count, waves.rightward.coefficient_count, waves.leftward.coefficient_count
        )
    angles = np.pi * np.arange(count) / (count - 1)
    shares = (1 - np.cos(angles)) / 2  # places of the points in an interval, 0 to 1
    # The values of constant waves are [interval, 1]: times `ones` they are repeated.
    ones = np.ones(count)
    starts: list[float] = []  # left bounds of the intervals, m
    velocities = []  # of each segment, [interval, point]
    strains = []
    ends = fields.edges(body)
    for i, waves in enumerate(segments):
        bounds = _lasting_bounds(waves, tick)
        near = bounds[:-1]
        far = bounds[1:]
        # The part of A that has travelled for n ticks left the left end at tick - n.
        # The earliest part is farthest away, so in order of time A begins at the far
        # bound. [:, ::-1] orders the values from the near bound to the far one; the
        # points are the same, since the shares are symmetric.
        A_in_order_of_time = waves.rightward.inside(tick - far, tick - near, shares)
        A = A_in_order_of_time[:, ::-1]
        # B there has travelled for T - n ticks: it left the right end at tick - T + n.
        start = tick - waves.transit
        B = waves.leftward.inside(start + near, start + far, shares)
        velocities.append((A + B) / 2 * ones + frame)
        strains.append((B - A) / (2 * waves.wave_speed) * ones)
        places = ends[i] + waves.length * (near / waves.transit)
        starts.extend(places.tolist())
    borders = None
    if len(starts) > 1:
        borders = starts[1:]  # the first is the left end of the rod
    velocity = np.concatenate(velocities).ravel()
    strain = np.concatenate(strains).ravel()
    slowest = min(waves.wave_speed for waves in segments)
    return StateProfiles(
        velocity=Polynomials(velocity, borders, error=error),
        strain=Polynomials(strain, borders, error=error / slowest),
    )


def _lasting_bounds(waves: SegmentWaves, tick: int) -> Ints:
    """Bounds of the parts of a segment in which both waves are polynomials, [n + 1].

    They are times of travel from the left end, ticks, from 0 to T. A part of at most
    `SLIVER_TICKS` is due to round-off, and is joined to its neighbour.
    """
    transit = waves.transit
    lasting = [0]
    for bound in waves.smooth_bounds(tick)[1:-1].tolist():
        since_last = bound - lasting[-1]
        if since_last > SLIVER_TICKS and transit - bound > SLIVER_TICKS:
            lasting.append(bound)
    lasting.append(int(transit))
    return np.array(lasting)


def _steps(edges: Floats, values: Floats, round_off: float) -> Number | Steps:
    """Values [n] between edges [n + 1], m, as `Steps`; a number if there is one step.

    A value that differs from its left neighbour by at most `round_off` belongs to the
    same step. The value of a step is its first one.
    """
    jumps = np.abs(np.diff(values)) > round_off
    begins = np.concatenate(([True], jumps))  # whether a step begins with a value
    if begins.sum() == 1:
        return float(values[0])
    starts = edges[:-1][begins]  # the first one is the left end, which is no jump
    return Steps(values[begins].tolist(), starts[1:].tolist())
