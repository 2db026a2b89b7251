"""A shot that gives a curve, and the error bands of this curve.

All steps from the records to the curve are linear, except the last. The error band
therefore follows from two contributions: noise drawn at random from the records, and
the errors of a calibration. Both go through the same linear steps as the curve.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np

from ..model.quantities import Floats
from ..progress import ProgressReport
from .calibration import Calibration
from .curve import Curve
from .signal import Signal

NOISE_DRAWS = 24
"""Number of draws of the noise."""
BAND_STANDARD_ERRORS = 2.36
"""Half width of a 95 % band in standard errors.

It is that of Student's distribution with 7 degrees of freedom, one less than the blocks
of noise.
"""


class Shot(Protocol):
    """Records of a shot, and how the curve of the specimen follows from them."""

    def curve(self) -> Curve:
        """Forces, velocities and strain from the strains of the bars."""

    def with_noise_alone(self, rng: np.random.Generator) -> Shot:
        """The shot with gauges that record nothing but noise."""

    def with_errors(self, calibration: Calibration) -> Iterator[Shot]:
        """Shots in which one constant of a bar is changed by its standard error."""

    def with_later_output(self, delay: float) -> Shot:
        """The shot with an output bar that records later by a delay, s."""


class Resolution(NamedTuple):
    """What the records and the bars carry."""

    dt: float  # time step of the output bar, s
    cut_off: float  # highest frequency, Hz


class Bands(NamedTuple):
    """Half widths of the 95 % bands."""

    stress: Floats  # Pa
    strain: Floats


def one_sample_of(shot: Shot, curve: Curve, dt: float) -> Floats:
    """Change of the stress at equal strain by a shift of the output record, Pa.

    The record is taken later, and earlier, by one sample, `dt`, s. The result is the
    larger absolute change of both, [sample].
    """
    stresses = []  # [shift, sample]
    for delay in (dt, -dt):
        moved = shot.with_later_output(delay).curve()
        stresses.append(moved.at_strain(curve.strain, moved.stress))
    change: Floats = np.abs(np.array(stresses) - curve.stress).max(axis=0)
    return change


def bands_of(
    shot: Shot,
    curve: Curve,
    calibration: Calibration | None,
    resolution: Resolution,
    report: ProgressReport,
) -> Bands:
    """Half widths of bands of 95 %: noise, errors of a calibration, lost frequencies.

    The noise goes through the reduction alone, since that is linear; its draws are the
    same in each call. Without a calibration, None, it has no errors. `report` is told
    how many draws are done, and of how many.
    """
    rng = np.random.default_rng(0)
    noise_curves = []
    for k in range(NOISE_DRAWS):
        noise_curves.append(shot.with_noise_alone(rng).curve())
        report(k + 1, NOISE_DRAWS)
    changed_curves = []
    if calibration is not None:
        for changed in shot.with_errors(calibration):
            changed_curves.append(changed.curve())

    def band(name: str) -> Floats:
        """Half width of the band of the column of that name, [sample]."""
        column = getattr(curve, name)
        noises = [getattr(noise_curve, name) for noise_curve in noise_curves]
        variance = np.mean([noise**2 for noise in noises], axis=0)
        calibration_variance = 0.0
        for changed_curve in changed_curves:
            difference = getattr(changed_curve, name) - column
            calibration_variance = calibration_variance + difference**2
        variance += calibration_variance
        # The frequencies that were lost have about the power of the last octave that
        # was kept, less that of the noise in it.
        noise_powers = [high_frequency_power(noise, resolution) for noise in noises]
        power = high_frequency_power(column, resolution)
        lost = np.maximum(power - np.mean(noise_powers, axis=0), 0.0)
        return np.asarray(BAND_STANDARD_ERRORS * np.sqrt(variance + lost))

    return Bands(band("stress"), band("strain"))


def high_frequency_power(column: Floats, resolution: Resolution) -> Floats:
    """Local mean square of the last octave of frequencies that records and bars carry.

    The mean runs over two of its longest periods, and the result has the shape of the
    column. Higher frequencies are lost; behind a kink of the curve they have the same
    power.
    """
    dt = resolution.dt
    octave_start = resolution.cut_off / 2
    low = Signal(column, dt=dt).low_pass(octave_start).values
    period = math.ceil(1 / octave_start / dt)  # the longest of the octave, samples
    width = min(2 * period + 1, len(column))
    window = np.full(width, 1 / width)
    power: Floats = np.convolve((column - low) ** 2, window, "same")
    return power
