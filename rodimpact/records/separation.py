"""The two waves of a bar at its specimen face, from the strains at its gauges.

One gauge separates the two waves only if they pass it one after the other. Two gauges
at the distances zn (near) and zf (far) from the face separate them at all times after
rest. T(x) is the operator that propagates a wave by the distance x in the first mode.
With the wave i towards the face and the wave a away from it, both at the face, the
records en and ef are::

    en = T(-zn) i + T(zn) a          ef = T(-zf) i + T(zf) a

With D = zf - zn, the waves follow from these records and from their own values of the
time 2 D/c earlier::

    a = T(-zn) (en - T(D) ef) + T(2 D) a          i = T(zf) (ef - T(D) en) + T(2 D) i

An offset of a record is added again after each time 2 D/c. At the frequencies n c/(2 D)
the noise of all passages adds up.
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
    them. One gauge needs an assumption. In the output bar: no wave runs towards the
    specimen. In the input bar: the record is the incident wave alone until the
    reflected wave reaches the gauge.
    """
    if len(bar.distances) == 2:
        return _from_two_gauges(bar)
    strain = bar.strains[0]
    distance = bar.distances[0]
    away = bar.propagated(strain, -distance)  # it was at the face before
    if bar.is_output:
        return Waves(np.zeros(len(strain)), away)
    # Time at which the reflected wave reaches the gauge, s, and the index of its sample
    reflected_start = bar.pulse_start + 2 * distance / bar.speed
    first_reflected = int((reflected_start - bar.times[0]) / bar.dt)
    is_incident = np.arange(len(strain)) < first_reflected
    incident = np.where(is_incident, strain, 0.0)
    # `away` is made from the whole record, with the incident wave in it. At the face
    # this part of `away` ends before the reflected wave begins, so the samples in use
    # are not disturbed.
    return Waves(bar.propagated(incident, distance), away)


def _from_two_gauges(bar: InstrumentedBar) -> Waves:
    """The two waves at the face from the records of two gauges.

    The near gauge, at the distance zn from the face, has the strain en, the far gauge
    at zf the strain ef, and D = zf - zn. T(x) propagates a wave by x. The wave a away
    from the face and the wave i towards it follow from two sums over all passages of
    the distance 2 D (`sum_of_passages`): T(zn) a is that of en - T(D) ef, and T(-zf) i
    is that of ef - T(D) en.
    """
    near = int(bar.distances.argmin())
    far = 1 - near  # the other one of the indices 0 and 1
    near_distance = float(bar.distances[near])
    far_distance = float(bar.distances[far])
    apart = far_distance - near_distance  # D
    near_strain = from_pulse(bar, near)
    far_strain = from_pulse(bar, far)
    base_of_away = near_strain - bar.propagated(far_strain, apart)  # en - T(D) ef
    base_of_towards = far_strain - bar.propagated(near_strain, apart)  # ef - T(D) en
    away_at_near = sum_of_passages(bar.guide, base_of_away, 2 * apart)  # T(zn) a
    # T(-zf) i
    towards_at_far = sum_of_passages(bar.guide, base_of_towards, 2 * apart)
    return Waves(
        towards=bar.propagated(towards_at_far, far_distance),
        away=bar.propagated(away_at_near, -near_distance),
    )


def from_pulse(bar: InstrumentedBar, gauge: int) -> Floats:
    """The strain at a gauge, [sample], with zeros before its first pulse.

    The pulse begins a rise time before `Pulse.start`. `gauge` is the index of the
    gauge.
    """
    pulse = bar.first_pulses[gauge]
    is_moving = bar.times >= pulse.start - pulse.rise
    moving: Floats = np.where(is_moving, bar.strains[gauge], 0.0)
    return moving


def sum_of_passages(guide: Waveguide, wave: Floats, distance: float) -> Floats:
    """Sum w + T(d) w + T(2 d) w + ... of a wave w, [sample], with d = `distance`, m.

    T(x) w is the wave after the distance x. The terms that arrive after the end of the
    record are left out, as they are 0. Sums S(n) of n = 1, 2, 4, ... terms are computed
    one from the other: S(2 n) = S(n) + T(n d) S(n).
    """
    duration = guide.dt * len(wave)
    passages = math.floor(duration * guide.speed / distance)  # index of the last term
    total = wave
    summed = 1  # number of terms in `total`; their indices begin with 0
    while summed <= passages:
        total = total + guide.propagated(total, summed * distance)
        summed *= 2
    return total


def separated_until(bar: InstrumentedBar) -> float:
    """Time at the face up to which the records separate the two waves, s.

    With two gauges it is the last time at which a wave may leave the face and still be
    in the records. With one gauge, this wave must also reach the gauge before the wave
    returned by the other end of the bar. ValueError if the incident and the reflected
    wave overlap at the only gauge of the input bar.
    """
    record_end = float(bar.known_until.min())
    if len(bar.distances) == 2:
        return record_end
    travel = float(bar.distances[0]) / bar.speed  # from the gauge to the face
    round_trip = 2 * float(bar.rod.length) / bar.speed
    if bar.is_output:
        # In the output bar the pulse is at the face before it is at the gauge.
        at_face = bar.pulse_start - travel
    else:
        pulse = bar.first_pulse
        # At this time a pulse with linear ramps falls through half height. The pulse
        # lasts for 5/8 of a rise time more, but the reflected wave begins 7/8 of a rise
        # time after `pulse_start`: a quarter of a rise time is then between the two.
        passed = pulse.start + pulse.width + pulse.rise / 2
        if passed > bar.pulse_start + 2 * travel:
            raise ValueError(
                "the reflected wave reaches the gauge before the incident wave has "
                "passed; give a second gauge on this bar, or use a shorter striker"
            )
        at_face = bar.pulse_start + travel
    # The returned wave runs from the face to the other end and back to the gauge, a
    # path of 2 length - distance. A wave that leaves the face at this time, and runs
    # the distance to the gauge, arrives there together with it.
    meets_returned = at_face + round_trip - 2 * travel
    return min(record_end, meets_returned)
