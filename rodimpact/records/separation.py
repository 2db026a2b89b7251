"""The two waves of a bar at its specimen face, from the strains at its gauges.

One gauge separates the two waves only if they pass it one after the other. Two gauges
at the distance D = zf - zn separate them from rest on. In the first mode a wave that
runs on by x is multiplied by T(x). With the wave i towards the face and the wave a away
from it, the records are::

    en = T(-zn) i + T(zn) a          ef = T(-zf) i + T(zf) a

    a = T(-zn) (en - T(D) ef) + T(2 D) a          i = T(zf) (ef - T(D) en) + T(2 D) i

Each passage of 2 D uses what the one before gave. An offset of a record adds once every
2 D/c; the frequencies n c/(2 D) add the noise of all passages.
"""

import math
from typing import NamedTuple

import numpy as np

from ..model.quantities import Floats
from .instrumented_bar import InstrumentedBar
from .waveguide import Waveguide


class Waves(NamedTuple):
    """Compressive strains of both waves at the face, at the times of the records."""

    towards: Floats
    away: Floats


def waves_at_face(bar: InstrumentedBar) -> Waves:
    """Waves at the face, towards the specimen and away from it.

    They are compressive strains at the times of the bar, [sample]. Two gauges separate
    them. With one gauge it is assumed that no wave comes back towards the specimen in
    the output bar, and that the record of the input bar is the incident wave up to the
    begin of the reflected one.
    """
    if len(bar.distances) == 2:
        return _from_two_gauges(bar)
    strain = bar.strains[0]
    distance = bar.distances[0]
    away = bar.propagated(strain, -distance)
    if bar.is_output:
        return Waves(np.zeros(len(strain)), away)
    # The time and the sample at which the reflected wave reaches the gauge
    reflected_start = bar.pulse_start + 2 * distance / bar.speed
    first_reflected = int((reflected_start - bar.times[0]) / bar.dt)
    is_incident = np.arange(len(strain)) < first_reflected
    incident = np.where(is_incident, strain, 0.0)
    # `away` is of the whole record. The incident wave in it, propagated back, ends
    # before the reflected wave begins, so it does not disturb the samples in use.
    return Waves(bar.propagated(incident, distance), away)


def _from_two_gauges(bar: InstrumentedBar) -> Waves:
    """The two waves at the face from the records of two gauges, passage by passage.

    The near gauge has the strain en and the distance zn, the far one ef and zf; D is
    zf - zn. T(x) e is e after the distance x. The sum over all passages of 2 D of
    en - T(D) ef is T(zn) times the wave away, and that of ef - T(D) en is T(-zf) times
    the wave towards the face.
    """
    near = int(bar.distances.argmin())
    far = 1 - near
    near_distance = float(bar.distances[near])
    far_distance = float(bar.distances[far])
    apart = far_distance - near_distance  # D
    near_strain = from_pulse(bar, near)
    far_strain = from_pulse(bar, far)
    base_of_away = near_strain - bar.propagated(far_strain, apart)
    base_of_towards = far_strain - bar.propagated(near_strain, apart)
    away_at_near = sum_of_passages(bar.guide, base_of_away, 2 * apart)
    towards_at_far = sum_of_passages(bar.guide, base_of_towards, 2 * apart)
    return Waves(
        towards=bar.propagated(towards_at_far, far_distance),
        away=bar.propagated(away_at_near, -near_distance),
    )


def from_pulse(bar: InstrumentedBar, gauge: int) -> Floats:
    """The record of a gauge from its first pulse on, zero before it.

    The pulse begins a rise time before its start.
    """
    pulse = bar.first_pulses[gauge]
    is_moving = bar.times >= pulse.start - pulse.rise
    moving: Floats = np.where(is_moving, bar.strains[gauge], 0.0)
    return moving


def sum_of_passages(guide: Waveguide, wave: Floats, distance: float) -> Floats:
    """Sum of a wave and of all its passages of a distance, m, while the record lasts.

    With T(x) w, the wave w after the distance x, it is w + T(distance) w +
    T(2 distance) w + ... Sums S of 1, 2, 4, ... terms follow from each other:
    S(2 n) = S(n) + T(n distance) S(n).
    """
    duration = guide.dt * len(wave)
    passages = math.floor(duration * guide.speed / distance)
    total = wave
    summed = 1  # terms of the total
    while summed <= passages:  # terms beyond all passages are 0
        total = total + guide.propagated(total, summed * distance)
        summed *= 2
    return total


def separated_until(bar: InstrumentedBar) -> float:
    """Time at the face up to which the records separate the two waves, s.

    A wave that leaves the face later reaches the gauge after the end of the record or,
    with one gauge, when the wave from the other end of the bar is there. ValueError if
    the incident and the reflected wave overlap at a single gauge.
    """
    record_end = float(bar.known_until.min())
    if len(bar.distances) == 2:
        return record_end
    travel = float(bar.distances[0]) / bar.speed  # from the gauge to the face
    round_trip = 2 * float(bar.rod.length) / bar.speed
    if bar.is_output:
        # The pulse is at the face before it is at the gauge.
        at_face = bar.pulse_start - travel
    else:
        pulse = bar.first_pulse
        passed = pulse.start + pulse.width + pulse.rise / 2
        if passed > bar.pulse_start + 2 * travel:
            raise ValueError(
                "the reflected wave reaches the gauge before the incident wave has "
                "passed; give a second gauge on this bar, or use a shorter striker"
            )
        at_face = bar.pulse_start + travel
    # A wave that leaves the face then meets at the gauge the wave that the other end
    # has returned.
    meets_returned = at_face + round_trip - 2 * travel
    return min(record_end, meets_returned)
