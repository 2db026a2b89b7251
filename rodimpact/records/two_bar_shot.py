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
"""Stress over the largest stress, up to which the start is taken as elastic."""


class Shifts(NamedTuple):
    """How much earlier waves are taken than they were recorded, s."""

    reflected: float = 0.0
    transmitted: float = 0.0  # and the wave back to the specimen in the output bar


NO_SHIFTS = Shifts()


@dataclass(frozen=True)
class TwoBarShot:
    """Both bars of a shot, the times with both faces known, and the alignment."""

    bars: InstrumentedBars
    specimen: Specimen
    times: Floats
    shifts: Shifts = NO_SHIFTS

    def curve(self) -> Curve:
        """Forces, velocities and strain from the strains of the bars.

        With the compressive strains of the waves at the faces::

            v1 = c1 (incident - reflected)       F1 = E1 A1 (incident + reflected)
            v2 = c2 (transmitted - returning)    F2 = E2 A2 (transmitted + returning)
            strain rate = (v1 - v2)/length

        The reflected wave, and both waves of the output bar, are taken earlier by their
        shifts. The curve is at `times`.
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
        """A wave at the times of the curve, taken earlier by a shift, s."""
        sampled: Floats = np.interp(self.times + shift, bar.times, wave)
        return sampled

    def aligned(self, limit: float, report: ProgressReport) -> TwoBarShot:
        """The shot with shifts that balance the forces at its start, by least squares.

        Both shifts, s, lie within a limit to either side. The start goes up to
        `ELASTIC_RATIO`, half, of the largest stress. If the specimen has a Young's
        modulus E, the shifts also make the start elastic, stress = E strain. `report`
        is told how many curves are done.
        """
        from scipy.optimize import least_squares

        stress = self.curve().stress
        largest = stress.max()
        first_above = int(np.argmax(stress > ELASTIC_RATIO * largest))
        start = slice(0, first_above + 1)  # samples
        modulus = self.specimen.youngs_modulus
        curves = 0

        def residuals(shifts: Floats) -> Floats:
            """Imbalance and distance from the elastic line at the samples of the start.

            Both are stresses divided by the largest one, one behind the other.
            """
            nonlocal curves
            curves += 1
            report(curves, None)  # nobody knows how many there will be
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
            diff_step=1e-3,
            x_scale=self.bars.input.dt,
        )
        return replace(self, shifts=Shifts(*solution.x.tolist()))

    def with_noise_alone(self, rng: np.random.Generator) -> TwoBarShot:
        """The shot with gauges that record nothing but noise."""
        return replace(self, bars=noise_of_bars(self.bars, rng))

    def with_errors(self, calibration: Calibration) -> Iterator[TwoBarShot]:
        """Shots in which one constant of a bar is changed by its standard error."""
        for bars in with_one_error(calibration, self.bars):
            yield replace(self, bars=bars)

    def with_later_output(self, delay: float) -> TwoBarShot:
        """The shot with an output bar that records later by a delay, s."""
        transmitted = self.shifts.transmitted - delay
        return replace(self, shifts=self.shifts._replace(transmitted=transmitted))
