"""A shot with one gauge a bar, whose overlapping waves are separated by equal forces.

The forces on both faces of the specimen are assumed equal.

T(x) is the operator that propagates a wave by the distance x in the first mode. Let z
be the distance of a gauge from the specimen, and L the length of the output bar, whose
far end is free. With the strains of the waves at the faces (incident i, reflected r,
transmitted t, returning s), the records e1 of the input gauge and e2 of the output
gauge are::

    e2 = T(z) t - T(2 L - z) t        so  t = T(-z) e2 + T(2 L - 2 z) t,   s = -T(2 L) t
    e1 = T(-z) i + T(z) r             so  i = T(z) e1 - T(2 z) f + T(2 z) i

with the strain f = i + r = E2 A2 (t + s)/(E1 A1) at the face of the input bar. Each
equation gives a wave from its own values of an earlier time. So an offset of the input
record is added again after each time 2 z/c.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..model.quantities import Floats
from ..units import format_si
from .calibration import Calibration, with_one_error
from .curve import Curve, Faces, curve_of
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .noise import noise_of_bars
from .separation import Waves, from_pulse, sum_of_passages
from .specimen import Specimen


@dataclass(frozen=True)
class EqualForceShot:
    """Both bars with one gauge each, and the times at which both faces are known."""

    bars: InstrumentedBars
    specimen: Specimen
    times: Floats  # s

    def curve(self) -> Curve:
        """Forces, velocities and strain if the forces on both faces are equal.

        With the compressive strains of the waves at the faces::

            F1 = F2 = E2 A2 (away + towards)     v2 = c2 (away - towards)
            incident + reflected = F1/(E1 A1)    v1 = c1 (incident - reflected)

        The curve is at `times`.
        """
        input_bar = self.bars.input
        output_bar = self.bars.output
        output_waves = waves_with_free_end(output_bar)
        force = output_bar.stiffness * (output_waves.away + output_waves.towards)
        # The times of the output bar may begin later than those of the input bar: the
        # force is 0 before.
        face_force = np.interp(input_bar.times, output_bar.times, force, left=0.0)
        face_strain = face_force / input_bar.stiffness
        incident = _incident_wave(input_bar, face_strain)
        reflected = face_strain - incident
        input_velocity = input_bar.speed * (incident - reflected)
        output_velocity = output_bar.speed * (output_waves.away - output_waves.towards)
        force_at_times = np.interp(self.times, output_bar.times, force)
        faces = Faces(
            input_force=force_at_times,
            output_force=force_at_times,
            input_velocity=np.interp(self.times, input_bar.times, input_velocity),
            output_velocity=np.interp(self.times, output_bar.times, output_velocity),
        )
        return curve_of(faces, self.specimen, self.times)

    def with_noise_alone(self, rng: np.random.Generator) -> EqualForceShot:
        """The shot with gauges that record nothing but noise, drawn by `rng`."""
        return replace(self, bars=noise_of_bars(self.bars, rng))

    def with_errors(self, calibration: Calibration) -> Iterator[EqualForceShot]:
        """Yield shots with one gain or wave speed larger by its standard error."""
        for bars in with_one_error(calibration, self.bars):
            yield replace(self, bars=bars)

    def with_later_output(self, delay: float) -> EqualForceShot:
        """The shot with `delay`, s, added to the times of the output bar."""
        output = self.bars.output._replace(times=self.bars.output.times + delay)
        return replace(self, bars=self.bars._replace(output=output))

    def method_sentence(self) -> str:
        """Phrase on the time for which waves are separated, and on the final offset.

        The offset is an error of the incident wave, in percent. It is caused by the
        error of the level at rest of the input record, and grows with each passage of
        the waves between gauge and specimen.
        """
        input_bar = self.bars.input
        duration = self.times[-1] - self.times[0]
        # Time of a wave from the gauge to the specimen and back, s
        period = 2 * float(input_bar.distances[0]) / input_bar.speed
        passages = math.ceil(duration / period)
        noise = input_bar.strains[0, : input_bar.rest_samples].std()
        level_error = noise / math.sqrt(input_bar.rest_samples)
        # The error of the level is added once in each passage of the waves.
        offset = 100 * passages * level_error / input_bar.first_pulse.plateau  # percent
        return (
            "waves separated by equal forces and a free far end of the output bar, "
            f"for {format_si(duration, 's', 4)}; an offset of the input record adds "
            f"once every {format_si(period, 's', 3)}: the error of its level at rest "
            f"grows to {offset:.2g} % "
            "of the incident wave by then"
        )


def waves_with_free_end(bar: InstrumentedBar) -> Waves:
    """Waves at the face of an output bar with one gauge, whose far end is free.

    Both waves are compressive strains at the times of the bar, [sample]. T(x) a is the
    wave a after the distance x. The bar has the length L, and its gauge the distance z
    from the face. If a runs away from the face, the wave towards the face is -T(2 L) a.
    The strain at the gauge is e = T(z) a - T(2 L - z) a, so that
    a = T(-z) e + T(2 (L - z)) a, which `sum_of_passages` solves. e is set to 0 before
    the first pulse.
    """
    strain = from_pulse(bar, 0)
    distance = float(bar.distances[0])
    length = float(bar.rod.length)
    gauge_at_face = bar.propagated(strain, -distance)  # T(-z) e
    # Waves that leave the face later reach the gauge after the end of its record.
    gauge_at_face[bar.times > bar.known_until[0]] = 0.0
    away = sum_of_passages(bar.guide, gauge_at_face, 2 * (length - distance))
    return Waves(towards=-bar.propagated(away, 2 * length), away=away)


def _incident_wave(bar: InstrumentedBar, face_strain: Floats) -> Floats:
    """Incident wave i at the face of an input bar with one gauge.

    All strains are at the times of the bar, [sample]. The strain at the face,
    `face_strain`, is f = i + r with the reflected wave r. T(x) i is the wave i after
    the distance x, and z is the distance of the gauge from the face. The strain at the
    gauge is e = T(-z) i + T(z) (f - i), so that i = T(z) e - T(2 z) f + T(2 z) i, which
    `sum_of_passages` solves.
    """
    distance = float(bar.distances[0])
    gauge_strain = from_pulse(bar, 0)
    gauge_at_face = bar.propagated(gauge_strain, distance)  # T(z) e
    face_strain_later = bar.propagated(face_strain, 2 * distance)  # T(2 z) f
    return sum_of_passages(
        bar.guide, gauge_at_face - face_strain_later, distance=2 * distance
    )
