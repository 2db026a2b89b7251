"""A shot between two bars whose gauges separate all waves, and its alignment.

With the strains of the waves at the two faces, compression positive (incident i,
reflected r, transmitted t)::

    F1 = E1 A1 (i + r)   F2 = E2 A2 t      v1 = c1 (i - r)   v2 = c2 t
    strain rate (v1 - v2)/L0
    stress F2/A0 (one wave), F1/A0 (two waves), their mean (three waves)

H. Kolsky, Proceedings of the Physical Society B 62 (1949) 676; W. Chen and B. Song,
Split Hopkinson (Kolsky) Bar (Springer, 2011).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..model.quantities import Floats
from ..progress import ProgressReport
from .calibration import Calibration, with_one_error
from .curve import Curve, Faces, curve_of
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .noise import noise_of_bars
from .separation import waves_at_face
from .specimen import Specimen

ELASTIC_RATIO = 0.5
"""Stress divided by the largest stress up to which a shot counts as elastic."""


class Shifts(NamedTuple):
    """Times by which waves are moved earlier than recorded, s."""

    reflected: float = 0.0
    transmitted: float = 0.0  # for both waves of the output bar


NO_SHIFTS = Shifts()


@dataclass(frozen=True)
class TwoBarShot:
    """Both bars of a shot, times at which both faces are known, and the alignment."""

    bars: InstrumentedBars
    specimen: Specimen
    times: Floats  # s
    shifts: Shifts = NO_SHIFTS

    def curve(self) -> Curve:
        """Forces, velocities and strain from the strains of the bars.

        With the compressive strains of the waves at the faces::

            v1 = c1 (incident - reflected)       F1 = E1 A1 (incident + reflected)
            v2 = c2 (transmitted - returning)    F2 = E2 A2 (transmitted + returning)
            strain rate = (v1 - v2)/length

        The reflected wave, and both waves of the output bar, are moved earlier by their
        `shifts`. The curve is at `times`.
        """
        input_bar = self.bars.input
        output_bar = self.bars.output
        input_waves = waves_at_face(input_bar)
        output_waves = waves_at_face(output_bar)
        shifts = self.shifts
        incident = self._sampled(input_bar, input_waves.towards, shift=0.0)
        reflected = self._sampled(input_bar, input_waves.away, shift=shifts.reflected)
        returning = self._sampled(
            output_bar, output_waves.towards, shift=shifts.transmitted
        )
        transmitted = self._sampled(
            output_bar, output_waves.away, shift=shifts.transmitted
        )
        faces = Faces(
            input_force=input_bar.stiffness * (incident + reflected),
            output_force=output_bar.stiffness * (transmitted + returning),
            input_velocity=input_bar.speed * (incident - reflected),
            output_velocity=output_bar.speed * (transmitted - returning),
        )
        return curve_of(faces, self.specimen, self.times)

    def _sampled(self, bar: InstrumentedBar, wave: Floats, shift: float) -> Floats:
        """A wave of a bar at the times of the curve, moved earlier by a shift, s."""
        sampled: Floats = np.interp(self.times + shift, bar.times, wave)
        return sampled

    def aligned(self, limit: float, report: ProgressReport) -> TwoBarShot:
        """The shot with shifts that balance the forces at its start, by least squares.

        Both shifts lie between -limit and limit, s. The start lasts until the stress
        first exceeds half of its largest value (`ELASTIC_RATIO`). If the specimen has a
        Young's modulus E, the deviation of the start from stress = E strain is
        minimized, too. `report` is called with the number of curves computed so far.
        """
        from scipy.optimize import least_squares

        stress = self.curve().stress
        largest = stress.max()
        first_above = int(np.argmax(stress > ELASTIC_RATIO * largest))
        start = slice(0, first_above + 1)  # samples
        modulus = self.specimen.youngs_modulus
        curves = 0  # number of curves computed, for `report`

        def residuals(shifts: Floats) -> Floats:
            """Imbalance, and deviation from the elastic line, at the start, [number].

            Both are stresses divided by the largest stress, in one array. If the
            specimen has no Young's modulus, the array holds the imbalance alone.
            """
            nonlocal curves
            curves += 1
            report(curves, None)  # the total number is unknown
            curve = replace(self, shifts=Shifts(*shifts)).curve()
            imbalance = curve.input_force - curve.output_force
            parts = [imbalance[start] / self.specimen.section]
            if modulus is not None:
                from_elastic_line = curve.stress - modulus * curve.strain
                parts.append(from_elastic_line[start])
            relative: Floats = np.concatenate(parts) / largest
            return relative

        solution = least_squares(
            residuals,
            x0=(0.0, 0.0),
            bounds=(-limit, limit),
            diff_step=1e-3,  # relative step of a shift, for derivatives
            x_scale=self.bars.input.dt,  # typical size of a shift, s
        )
        return replace(self, shifts=Shifts(*solution.x.tolist()))

    def with_noise_alone(self, rng: np.random.Generator) -> TwoBarShot:
        """The shot with gauges that record nothing but noise, drawn by `rng`."""
        return replace(self, bars=noise_of_bars(self.bars, rng))

    def with_errors(self, calibration: Calibration) -> Iterator[TwoBarShot]:
        """Yield shots with one gain or wave speed larger by its standard error."""
        for bars in with_one_error(calibration, self.bars):
            yield replace(self, bars=bars)

    def with_later_output(self, delay: float) -> TwoBarShot:
        """The shot with the waves of the output bar later by `delay`, s."""
        # `shifts` move waves earlier, so a delay is a negative shift.
        transmitted = self.shifts.transmitted - delay
        return replace(self, shifts=self.shifts._replace(transmitted=transmitted))
