"""A shot that gives a curve, and the error bands of this curve.

The columns of a curve are linear in the records. So the error due to noise is the curve
of noise alone, which is drawn at random from the records at rest. The error due to a
calibration is the change of the curve if one of its numbers is changed. Frequencies
that the bars or the records do not carry add a third error.
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

It is that of Student's distribution with 7 degrees of freedom, one less than the number
of blocks from which noise is drawn.
"""


class Shot(Protocol):
    """Records of a shot, and how the curve of the specimen follows from them."""

    def curve(self) -> Curve:
        """Forces, velocities and strain from the strains of the bars."""

    def with_noise_alone(self, rng: np.random.Generator) -> Shot:
        """The shot with gauges that record nothing but noise, drawn by `rng`."""

    def with_errors(self, calibration: Calibration) -> Iterator[Shot]:
        """Yield shots with one gain or wave speed larger by its standard error."""

    def with_later_output(self, delay: float) -> Shot:
        """The shot with the waves of the output bar later by `delay`, s."""


class Resolution(NamedTuple):
    """Time step and highest frequency of the records."""

    dt: float  # time step of the curve, s
    cut_off: float  # highest frequency that bars and records carry, Hz


class Bands(NamedTuple):
    """Half widths of the 95 % bands."""

    stress: Floats  # Pa
    strain: Floats


def one_sample_of(shot: Shot, curve: Curve, dt: float) -> Floats:
    """Change of the stress at equal strain by a shift of the output record, Pa.

    The record is shifted by one sample, `dt`, s, once later and once earlier. The
    result is the larger of the two absolute changes, at each sample of the curve.
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
    """Half widths of the 95 % bands: noise, errors of a calibration, lost frequencies.

    The variances of the three errors are added. The draws of the noise are the same in
    each call. Without a calibration (None) there are two errors. `report` is called
    with the number of draws done so far and the number of all draws.
    """
    rng = np.random.default_rng(0)  # a fixed seed: each call has the same draws
    noise_curves = []
    for k in range(NOISE_DRAWS):
        noise_curves.append(shot.with_noise_alone(rng).curve())
        report(k + 1, NOISE_DRAWS)
    changed_curves = []  # each with one number of the calibration changed
    if calibration is not None:
        for changed in shot.with_errors(calibration):
            changed_curves.append(changed.curve())

    def band(name: str) -> Floats:
        """Half width of the band of the column called `name`, [sample]."""
        column = getattr(curve, name)
        noises = [getattr(noise_curve, name) for noise_curve in noise_curves]
        # The noise has the mean 0.
        variance = np.mean([noise**2 for noise in noises], axis=0)
        calibration_variance = 0.0
        for changed_curve in changed_curves:
            difference = getattr(changed_curve, name) - column
            calibration_variance = calibration_variance + difference**2
        variance += calibration_variance
        # The lost frequencies have about the power of the last octave that is carried,
        # minus the power of the noise in it.
        noise_powers = [high_frequency_power(noise, resolution) for noise in noises]
        power = high_frequency_power(column, resolution)
        lost = np.maximum(power - np.mean(noise_powers, axis=0), 0.0)
        return np.asarray(BAND_STANDARD_ERRORS * np.sqrt(variance + lost))

    return Bands(band("stress"), band("strain"))


def high_frequency_power(column: Floats, resolution: Resolution) -> Floats:
    """Local mean square of a column in the highest octave of frequencies, [sample].

    The octave ends at `resolution.cut_off`. The moving mean has the width of two of its
    longest periods. The frequencies above the octave are lost; after a kink of the
    curve they have about the same power.
    """
    dt = resolution.dt
    octave_start = resolution.cut_off / 2
    low = Signal(column, dt=dt).low_pass(octave_start).values
    period = math.ceil(1 / octave_start / dt)  # longest period of the octave, samples
    width = min(2 * period + 1, len(column))  # odd, so the mean is centred
    window = np.full(width, 1 / width)
    power: Floats = np.convolve((column - low) ** 2, window, "same")
    return power
