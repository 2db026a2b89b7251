"""Waves along a uniform rod: each frequency runs at its own phase velocity."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .. import waves
from ..model.bodies import Rod
from ..model.quantities import Floats
from . import filters

SLOW_WAVE_RATIO = 3
"""Assumed travel time of the slowest waves, divided by that of long waves."""


class Waveguide(NamedTuple):
    """A uniform rod, and the time step of the records of waves in it."""

    rod: Rod
    dt: float  # s

    @property
    def speed(self) -> float:
        """Bar speed c0, m/s."""
        return float(self.rod.segments[0].wave_speed)

    @property
    def stiffness(self) -> float:
        """Young's modulus times cross-sectional area, E A, N."""
        segment = self.rod.segments[0]
        return float(segment.material.youngs_modulus) * float(np.asarray(segment.area))

    @property
    def impedance(self) -> float:
        """Force over particle velocity in a wave, E A/c0, kg/s."""
        return self.stiffness / self.speed

    @property
    def mode(self) -> waves.Bar | None:
        """The exact first mode, if the bar is round and has a Poisson ratio.

        None for other bars, whose waves do not disperse.
        """
        segment = self.rod.segments[0]
        if segment.solid_round and segment.material.poisson_ratio is not None:
            return waves.Bar.of(self.rod)
        return None

    @property
    def cut_off(self) -> float:
        """Cut-off frequency of the first mode, Hz; infinite without dispersion."""
        if self.mode is None:
            return math.inf
        return self.mode.cut_off

    def transfer_function(self, count: int, distance: float) -> TransferFunction:
        """Factors of a distance, m, for the spectrum of `count` samples.

        In a round bar with a Poisson ratio each frequency runs at its own phase
        velocity, and frequencies above the cut-off of the first mode are removed. The
        transform is periodic: it is longer than the samples, so that no delayed wave
        appears again at their beginning.
        """
        from scipy import fft

        travel = abs(distance) / self.speed / self.dt  # of long waves, in samples
        slowest_travel = math.ceil(SLOW_WAVE_RATIO * travel)
        size = fft.next_fast_len(2 * count + slowest_travel, real=True)
        f = fft.rfftfreq(size, self.dt)
        factors = np.exp(-2j * np.pi * f * distance / self.speed)  # delay by distance/c
        mode = self.mode
        if mode is not None:
            # The delays of `first_mode` are additional to distance/c.
            factors *= filters.first_mode(f, distance, mode)
        return TransferFunction(size, factors)

    def propagated(self, strain: Floats, distance: float) -> Floats:
        """Strain of a wave after a distance, m, along the bar, at the same times.

        The wave is delayed by its travel time; a negative distance makes it earlier.
        The bar is assumed to be at rest before the first time. The part of the wave
        that would come after the last time, or before the first, is lost.
        """
        from scipy import fft

        size, factors = self.transfer_function(len(strain), distance)
        later = fft.irfft(fft.rfft(strain, size) * factors, size)
        propagated: Floats = later[: len(strain)]
        return propagated


class TransferFunction(NamedTuple):
    """Complex factors by which a distance along a bar multiplies a spectrum."""

    size: int  # number of samples of the transform
    factors: Any  # [frequency]
