"""The curve of a shot from the waves in its bars, its alignment, and its error bands.

With the strains of the waves at the two faces, compression positive (incident i, reflected r,
transmitted t)::

    F1 = E1 A1 (i + r)   F2 = E2 A2 t      v1 = c1 (i - r)   v2 = c2 t
    strain rate (v1 - v2)/L0               stress F2/A0 (one wave), F1/A0 (two), their mean (three)

H. Kolsky, Proceedings of the Physical Society B 62 (1949) 676; W. Chen and B. Song, Split Hopkinson
(Kolsky) Bar (Springer, 2011). All steps except the last are linear. The error band therefore
follows from two contributions: noise drawn at random from the records, and the errors of a
calibration. Both go through the same linear steps as the curve.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..model.quantities import Floats
from ..progress import Report
from .calibration import Calibration, with_one_error
from .curve import Curve, integral
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .separation import waves_at_face
from .signal import Signal
from .specimen import Specimen

NOISE_DRAWS = 24
"""Number of draws of the noise."""
TWO_GAUGE_NOISE_DRAWS = 8
"""Number of draws of the noise where two gauges make each of them costly."""
NOISE_BLOCKS = 8
"""Number of blocks in the rest before the pulse, from which noise is drawn."""
STANDARD_ERRORS = 2.36
"""Half width of a 95 % band in standard errors, by Student with `NOISE_BLOCKS` - 1."""
ELASTIC_RATIO = 0.5
"""Stress over the largest stress, up to which the start is taken as elastic."""


class Shifts(NamedTuple):
    """How much earlier waves are taken than they were recorded, s."""

    reflected: float = 0.0
    transmitted: float = 0.0  # and the wave back to the specimen in the output bar


NO_SHIFTS = Shifts()


class Bands(NamedTuple):
    """Half widths of the 95 % bands."""

    stress: Floats  # Pa
    strain: Floats


@dataclass(frozen=True)
class Shot:
    """Both bars of a shot, the times at which both faces are known, and the alignment."""

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
        """
        input_bar = self.bars.input
        output_bar = self.bars.output
        input_waves = waves_at_face(input_bar)
        output_waves = waves_at_face(output_bar)
        shifts = self.shifts
        incident = self._sampled(input_bar, input_waves.towards, 0.0)
        reflected = self._sampled(input_bar, input_waves.away, shifts.reflected)
        returning = self._sampled(output_bar, output_waves.towards, shifts.transmitted)
        transmitted = self._sampled(output_bar, output_waves.away, shifts.transmitted)

        input_velocity = input_bar.speed * (incident - reflected)
        output_velocity = output_bar.speed * (transmitted - returning)
        rate = (input_velocity - output_velocity) / self.specimen.length
        return Curve(
            times=self.times,
            strain=integral(rate, self.times),
            strain_rate=rate,
            input_force=input_bar.stiffness * (incident + reflected),
            output_force=output_bar.stiffness * (transmitted + returning),
            input_velocity=input_velocity,
            output_velocity=output_velocity,
            specimen=self.specimen,
        )

    def _sampled(self, bar: InstrumentedBar, wave: Floats, shift: float) -> Floats:
        """A wave at the times of the curve, taken earlier by a shift, s."""
        sampled: Floats = np.interp(self.times + shift, bar.times, wave)
        return sampled

    def aligned(self, limit: float, report: Report) -> Shot:
        """The shot with the shifts that make its start elastic and its forces alike."""
        from scipy.optimize import least_squares

        stress = self.curve().stress
        largest = stress.max()
        start = slice(0, int(np.argmax(stress > ELASTIC_RATIO * largest)) + 1)
        modulus = self.specimen.youngs_modulus
        curves = 0

        def residuals(shifts: Floats) -> Floats:
            """Imbalance of forces, and distance from the elastic line, over the stress."""
            nonlocal curves
            curves += 1
            report(curves, None)
            curve = replace(self, shifts=Shifts(*shifts)).curve()
            imbalance = curve.input_force - curve.output_force
            parts = [imbalance[start] / self.specimen.section]
            if modulus is not None:
                parts.append((curve.stress - modulus * curve.strain)[start])
            relative: Floats = np.concatenate(parts) / largest
            return relative

        solution = least_squares(
            residuals,
            (0.0, 0.0),
            bounds=(-limit, limit),
            diff_step=1e-3,
            x_scale=self.bars.input.dt,
        )
        return replace(self, shifts=Shifts(*solution.x.tolist()))

    def one_sample(self, curve: Curve) -> Floats:
        """Change of the stress at equal strain by a sample of the transmitted wave, Pa."""
        dt = self.bars.output.dt
        stresses = []
        for step in (-dt, dt):
            shifts = self.shifts._replace(transmitted=self.shifts.transmitted + step)
            moved = replace(self, shifts=shifts).curve()
            stresses.append(moved.at_strain(curve.strain, moved.stress))
        change: Floats = np.abs(np.array(stresses) - curve.stress).max(axis=0)
        return change

    def bands(
        self, curve: Curve, calibration: Calibration | None, report: Report
    ) -> Bands:
        """Bands of 95 %: from noise, from errors of a calibration, and from lost frequencies."""
        rng = np.random.default_rng(0)
        n_draws = NOISE_DRAWS
        if max(len(bar.distances) for bar in self.bars) > 1:
            n_draws = TWO_GAUGE_NOISE_DRAWS
        drawn = []
        for k in range(n_draws):
            noise = InstrumentedBars(
                input=_with_noise_alone(self.bars.input, rng),
                output=_with_noise_alone(self.bars.output, rng),
            )
            drawn.append(replace(self, bars=noise).curve())
            report(k + 1, n_draws)
        changed = []
        if calibration is not None:
            for bars in with_one_error(calibration, self.bars):
                changed.append(replace(self, bars=bars).curve())

        def band(name: str) -> Floats:
            column = getattr(curve, name)
            noises = [getattr(each, name) for each in drawn]
            variance = np.mean([noise**2 for noise in noises], axis=0)
            calibration_variance = 0.0
            for each in changed:
                difference = getattr(each, name) - column
                calibration_variance = calibration_variance + difference**2
            variance += calibration_variance
            powers = [self._high_frequency_power(noise) for noise in noises]
            power = self._high_frequency_power(column)
            lost = np.maximum(power - np.mean(powers, axis=0), 0.0)
            return np.asarray(STANDARD_ERRORS * np.sqrt(variance + lost))

        return Bands(band("stress"), band("strain"))

    def _high_frequency_power(self, column: Floats) -> Floats:
        """Local mean square of the last octave of frequencies that records and bars carry.

        Higher frequencies are lost; behind a kink of the curve they have the same power.
        """
        bar = self.bars.input
        octave_start = min(bar.cut_off, 0.5 / bar.dt) / 2
        low = Signal(column, dt=bar.dt).low_pass(octave_start).values
        width = min(2 * math.ceil(1 / octave_start / bar.dt) + 1, len(column))
        window = np.full(width, 1 / width)
        power: Floats = np.convolve((column - low) ** 2, window, "same")
        return power


def _with_noise_alone(
    bar: InstrumentedBar, rng: np.random.Generator
) -> InstrumentedBar:
    """A bar whose gauges record nothing but noise.

    The noise is a block bootstrap of the record before the pulse. Blocks keep the correlation of
    the noise. They are short, since the mean over the whole rest was subtracted as the baseline.
    """
    block = max(2, bar.rest_samples // NOISE_BLOCKS)
    count = len(bar.times)
    drawn = []
    for strain in bar.strains:
        starts = rng.integers(0, bar.rest_samples - block + 1, count // block + 1)
        noise = strain[starts[:, None] + np.arange(block)].ravel()[:count]
        drawn.append(noise - noise[: bar.rest_samples].mean())
    # sums of blocks vary less by this factor, because the rest has the mean 0
    shrinkage = math.sqrt(1 - block / bar.rest_samples)
    return bar._replace(strains=np.array(drawn) / shrinkage)
