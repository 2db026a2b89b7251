"""The two waves of a bar at its specimen face, from the strains at its gauges.

One gauge separates the two waves only if they pass it one after the other. Two gauges at the
distance D separate them from rest on, by least squares for both waves; the waves are zero before
the pulse arrives. Two gauges do not determine the frequencies f = n c/(2 D); these are damped.
"""

from typing import Any, NamedTuple

import numpy as np

from ..model.quantities import Floats
from .instrumented_bar import InstrumentedBar

LEAST_SQUARES_ITERATIONS = 60
"""Steps of the least squares of two gauges; more would fit the noise."""
WAVE_DAMPING = 1e-3
"""Damping of waves that the gauges do not record, in the least squares of two gauges."""


class Waves(NamedTuple):
    """Compressive strains of both waves at the face, at the times of the records."""

    towards: Floats
    away: Floats


def waves_at_face(bar: InstrumentedBar) -> Waves:
    """Waves at the face, towards the specimen and away from it."""
    if len(bar.distances) == 2:
        return _from_two_gauges(bar)
    strain = bar.strains[0]
    distance = bar.distances[0]
    away = bar.propagated(strain, -distance)
    if bar.is_output:
        return Waves(np.zeros(len(strain)), away)
    reflected_start = bar.pulse_start + 2 * distance / bar.speed
    split = int((reflected_start - bar.times[0]) / bar.dt)
    # The incident wave propagated back ends before the reflected wave begins, so it does not
    # disturb the samples of the reflected wave that are used.
    incident = np.where(np.arange(len(strain)) < split, strain, 0.0)
    return Waves(bar.propagated(incident, distance), away)


def _from_two_gauges(bar: InstrumentedBar) -> Waves:
    """The two waves from the records of two gauges, by damped least squares.

    LSQR finds the waves at the face, as samples in time, by iterations. Each one propagates them
    to the gauges by their spectra.
    """
    from scipy import fft
    from scipy.sparse.linalg import LinearOperator, lsqr

    count = len(bar.times)
    # The wave towards the face passes the gauges before it, the other one after it.
    signed_distances = bar.distances[:, None, None] * [[-1.0], [1.0]]  # [gauge, wave]
    size, factors = bar.guide.transfer_functions(count, signed_distances)
    travel = bar.distances[0] / bar.speed
    # Time from which the face moves, s
    face_start = bar.pulse_start + travel
    if bar.is_output:
        face_start = bar.pulse_start - travel
    face_moves = np.arange(count) >= int((face_start - bar.times[0]) / bar.dt)
    # The last samples of a record do not count, see `known_until` [gauge, sample].
    is_known = bar.times < bar.known_until[:, None]

    def at_gauges(waves: Floats) -> Any:
        spectra = fft.rfft(face_moves * waves.reshape(2, count), size)
        strains = fft.irfft((factors * spectra).sum(axis=1), size)
        return (is_known * strains[:, :count]).ravel()

    def adjoint(strains: Floats) -> Any:
        # The adjoint of propagation is propagation back.
        spectra = fft.rfft(is_known * strains.reshape(2, count), size)
        waves = fft.irfft((factors.conj() * spectra[:, None]).sum(axis=0), size)
        return (face_moves * waves[:, :count]).ravel()

    shape = (2 * count, 2 * count)
    gauges: Any = LinearOperator(shape, at_gauges, adjoint, dtype=float)
    solution = lsqr(
        gauges,
        (is_known * bar.strains).ravel(),
        damp=WAVE_DAMPING,
        iter_lim=LEAST_SQUARES_ITERATIONS,
        atol=1e-10,
        btol=1e-10,
    )[0]
    return Waves(*solution.reshape(2, count))


def separated_until(bar: InstrumentedBar) -> float:
    """Time at the face up to which the records separate the two waves, s.

    At this time the record ends or, with one gauge, the wave from the far end of the bar is back
    at the gauge. ValueError if the incident and the reflected wave overlap at a single gauge.
    """
    end = float(bar.known_until.min())
    if len(bar.distances) == 2:
        return end
    travel = float(bar.distances[0]) / bar.speed
    round_trip = 2 * float(bar.rod.length) / bar.speed
    if bar.is_output:
        return min(end, bar.pulse_start - travel + round_trip - 2 * travel)
    pulse = bar.first_pulse
    passed = pulse.start + pulse.width + pulse.rise / 2
    if passed > bar.pulse_start + 2 * travel:
        raise ValueError(
            "the reflected wave reaches the gauge before the incident wave has passed; "
            "give a second gauge on this bar, or use a shorter striker"
        )
    return min(end, bar.pulse_start + travel + round_trip - 2 * travel)
