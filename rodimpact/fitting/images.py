"""Strain at a gauge over many passages, by images of the forces on both ends of a rod.

A rod that is struck at its left end by the force F carries the strain -F/(E A) to the
right. A free end turns a wave back with the other sign, so the strain at x is that of
images of the force: at the distances x + 2 n L with this sign, and at 2 L - x + 2 n L
with the other one, n = 0, 1, ... Forces on the right end have the same images, L - x in
place of x. Each distance disperses a wave by the exact first mode. The forces are those
of the solution; they hold whatever touches the ends, and when.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from .. import waves
from ..model import Free, Rod
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..records import filters
from ..records.signal import Signal
from ..records.waveguide import SLOW_WAVE_RATIO, Waveguide
from ..results.solution import Solution


class Place(NamedTuple):
    """Where the strain of a record is computed, and how."""

    body: int
    x: float  # distance from the left end, m
    by_images: bool = False
    radius: float | None = None  # m, of the round bar for the images

    def strain(self, solution: Solution, interval: float) -> Signal:
        """Strain at this place over time, sampled every `interval`, s.

        It is the strain of the solution's gauge, or with `by_images` the strain of
        images of the forces on both ends of the rod.

        Raises
        ------
        ValueError
            If the place lies outside its rod, or images of an end do not exist: it is
            neither free nor touches another body.
        """
        signal = solution.gauge(self.body, self.x).signal(interval)
        if not self.by_images:
            return signal
        return signal.replace(values=self._by_images(solution, signal))

    def _by_images(self, solution: Solution, signal: Signal) -> Floats:
        """Strain at the times of a signal by images of the forces on both ends.

        The images of a force stand for the wave that the force sends out and for its
        reflections at both ends; each wave is dispersed by the exact first mode. A free
        end has no force. The signal must begin at t = 0.
        """
        from scipy import fft

        rod = solution.system.bodies[self.body]
        assert isinstance(rod, Rod)
        bar = waves.Bar.of(rod, self.radius)
        stiffness = Waveguide(rod, signal.dt).stiffness  # E A
        length = float(rod.length)
        # Longest path of a wave that arrives in time, and a round trip more
        farthest = signal.end * bar.wave_speed + 2 * length
        # Time of travel over this path, in samples
        travel_samples = farthest / bar.wave_speed / signal.dt
        # Zeros are added so that slow waves do not wrap round to the beginning.
        padded_size = 2 * len(signal) + math.ceil(SLOW_WAVE_RATIO * travel_samples)
        size = fft.next_fast_len(padded_size, real=True)
        frequencies = fft.rfftfreq(size, signal.dt)
        spectrum = np.zeros(len(frequencies), complex)
        distances = (self.x, length - self.x)  # distance from each end
        for side, distance in enumerate(distances):
            force = _force_on_end(solution, self.body, side, signal.times)
            if force is not None:
                gain = _gain_of_images(frequencies, distance, length, farthest, bar)
                # minus: compression is negative strain
                spectrum -= gain * fft.rfft(force / stiffness, size)
        strain: Floats = fft.irfft(spectrum, size)[: len(signal)]
        return strain


def _force_on_end(solution: Solution, body: int, side: int, times: Floats) -> Any:
    """Compressive force on the left (side 0) or right end (side 1) of a body, N.

    It is that of the contact there at each of the times; None for a free end.

    Raises
    ------
    InvalidModel
        If no body touches the end, and it is not free either.
    """
    contact = body - 1 + side  # contact k lies between the bodies k and k + 1
    if 0 <= contact < len(solution.contacts):
        return solution.contacts[contact].force(times)
    end = solution.system.ends[side]
    if isinstance(end, Free):
        return None
    message = f"must be free, or touch another body, for passages='all', got {end}"
    raise invalid_argument(f"ends.{side}", message)


def _gain_of_images(
    frequencies: Floats, distance: float, length: float, farthest: float, bar: Any
) -> Any:
    """Complex gain from the strain that a force makes at an end to that at a place.

    It is the sum over all images of the force, [frequency].

    Parameters
    ----------
    frequencies : [frequency] array
        Hz.
    distance : float
        From this end to the place, m.
    length : float
        Length of the rod, m.
    farthest : float
        Round trips are added up to this distance, m; later waves do not count.
    bar : waves.Bar
    """
    gain = np.zeros(len(frequencies), complex)
    round_trips = 0.0  # 2 n L, the length of n round trips
    # The direct path, and the path by the other end, which reflects with the sign -1
    paths = ((distance, 1.0), (2 * length - distance, -1.0))
    while round_trips < farthest:
        for path, sign in paths:
            travelled = round_trips + path
            shift = np.exp(-2j * np.pi * frequencies * travelled / bar.wave_speed)
            # `first_mode` adds only the delay beyond the arrival of long waves.
            gain += sign * shift * filters.first_mode(frequencies, travelled, bar)
        round_trips += 2 * length
    return gain
