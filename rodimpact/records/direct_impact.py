"""A direct impact: a striker hits the specimen, which lies on a bar with a gauge.

The forces on both faces of the specimen are assumed equal, F. The velocity v1 of the
striker's face follows from F and the speed V of the striker. A rigid striker of the
mass m has v1 = V - int F dt/m. In a rod striker of the impedance Z, the bar speed c and
the length L, a wave of the strain g leaves the face and returns from the free far end.
T(2 L) g is this wave after the distance 2 L::

    Z c g = F + Z c T(2 L) g          v1 = V - c (g + T(2 L) g)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..model.bodies import RigidMass, Rod
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..units import format_si, shown
from .bar_reading import is_family, is_uniform_rod
from .calibration import Calibration
from .curve import Curve, Faces, curve_of, integral
from .instrumented_bar import InstrumentedBar
from .noise import noise_of_bar
from .pulses import extrapolated_onset, first_part
from .separation import sum_of_passages, waves_at_face
from .specimen import Specimen
from .waveguide import Waveguide

TIMING_PERIODS = 0.15
"""Error of the time of an impact, in periods of the first mode's cut-off frequency.

Higher frequencies are lost, so the record shows the begin of a force rounded and with
ringing. In computed shots, whose time of impact is known, the error is at most 0.1
periods.
"""


@dataclass(frozen=True)
class DirectImpactShot:
    """An output bar, the striker, and the times at which the output face is known."""

    output: InstrumentedBar
    striker: Rod | RigidMass
    specimen: Specimen
    times: Floats  # s, from the impact on

    def curve(self) -> Curve:
        """Forces, velocities and strain if the forces on both faces are equal.

        With the compressive strains of the waves at the output face, F1 = F2 = E A
        (away + towards) and v2 = c (away - towards). The velocity v1 of the input face
        is the speed of the striker minus `_lost_velocity`, which the force causes. The
        force is set to 0 before the impact. The curve is at `times`, which begin with
        the impact.
        """
        bar = self.output
        waves = waves_at_face(bar)
        force = bar.stiffness * (waves.away + waves.towards)  # N, at the bar's times
        # Before the impact no force acts; the record is noise.
        force[bar.times < self.times[0]] = 0.0
        input_velocity = self._speed() - self._lost_velocity(force)
        output_velocity = bar.speed * (waves.away - waves.towards)
        force_at_times = np.interp(self.times, bar.times, force)
        faces = Faces(
            input_force=force_at_times,
            output_force=force_at_times,
            input_velocity=np.interp(self.times, bar.times, input_velocity),
            output_velocity=np.interp(self.times, bar.times, output_velocity),
        )
        return curve_of(faces, self.specimen, self.times)

    def _speed(self) -> float:
        """Speed of the striker before the impact, m/s."""
        return float(np.asarray(self.striker.velocity))

    def _lost_velocity(self, force: Floats) -> Floats:
        """Decrease of the velocity of the striker's face by a force, m/s.

        Force, N, and decrease are at the times of the bar, [sample]. For a rigid
        striker the decrease is the impulse over the mass, int F dt/m. For a rod of the
        length L with a free far end it is c (g + T(2 L) g): g is the strain of the wave
        that leaves the face, and T(2 L) g is this wave after its return. The force and
        the returned wave make g = F/(E A) + T(2 L) g, which `sum_of_passages` solves.
        """
        striker = self.striker
        if isinstance(striker, RigidMass):
            return integral(force, self.output.times) / float(striker.mass)
        guide = Waveguide(striker, self.output.dt)
        round_trip = 2 * float(striker.length)
        # g and T(2 L) g
        leaving_strain = sum_of_passages(guide, force / guide.stiffness, round_trip)
        returned_strain = guide.propagated(leaving_strain, round_trip)
        return guide.speed * (leaving_strain + returned_strain)

    def with_noise_alone(self, rng: np.random.Generator) -> DirectImpactShot:
        """The shot with gauges that record nothing but noise, and a striker at rest.

        `noise_of_bar` draws the noise by `rng`.
        """
        return replace(
            self,
            output=noise_of_bar(self.output, rng),
            striker=self.striker.replace(velocity=0.0),
        )

    def with_errors(self, calibration: Calibration) -> Iterator[DirectImpactShot]:
        """No shots at all: a calibration belongs to two bars."""
        del calibration
        return iter(())

    def with_later_output(self, delay: float) -> DirectImpactShot:
        """The shot with `delay`, s, added to the times of the output bar."""
        later = self.output._replace(times=self.output.times + delay)
        return replace(self, output=later)

    def method_sentence(self) -> str:
        """Phrase on the source of the input velocity, and on the error of impact time.

        It names the kind of the striker, a rigid mass or a rod.
        """
        kind = "a rigid mass"
        if isinstance(self.striker, Rod):
            kind = "a rod with a free far end"
        timing_error = format_si(timing_error_of(self.output), "s", digits=2)
        return (
            f"velocity of the input face from the momentum of the striker, {kind}; the "
            "impact is when the force begins to rise from zero, within some "
            f"{timing_error}"
        )


def start_of_impact(bar: InstrumentedBar) -> float:
    """Time at which the striker hits the specimen, s.

    It is the begin of the force on the output face: its rise is extrapolated to zero,
    see `extrapolated_onset`.
    """
    # Until a wave returns, the wave away from the face has the strain F/(E A).
    force_strain = waves_at_face(bar).away
    pulse = first_part(bar.times, force_strain)
    return extrapolated_onset(bar.times, force_strain, pulse)


def timing_error_of(bar: InstrumentedBar) -> float:
    """Error of the time of the impact, s.

    It is one sample or, if longer, `TIMING_PERIODS` periods of the cut-off frequency.
    """
    return max(bar.dt, TIMING_PERIODS / bar.guide.cut_off)


def check_striker(striker: Any) -> None:
    """Raise InvalidModel unless the striker is a moving rigid mass or uniform rod.

    It must be a single body, not a family. Its velocity must be a single number above
    0, not a profile.
    """
    example = "ri.Rod(0.2, diameter=0.016, material=ri.materials.steel, velocity=12.0)"
    is_striker = is_uniform_rod(striker)
    if isinstance(striker, RigidMass):
        is_striker = not is_family(striker)
    if not is_striker:
        message = "must be a rigid mass or a uniform rod, a single one, such as"
        raise invalid_argument("striker", f"{message} {example}, got {shown(striker)}")
    velocity = np.asarray(striker.velocity)
    # A velocity profile becomes an array of the dtype object.
    is_number = velocity.ndim == 0 and velocity.dtype != object
    if not is_number or not velocity > 0:
        message = "must have a velocity above 0, its speed at the impact"
        raise invalid_argument("striker", f"{message}, got {shown(striker.velocity)}")
