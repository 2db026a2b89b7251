"""How well a fit knows its numbers, from residuals that are not independent of each other.

Least squares with the derivatives J turn noise of the covariance matrix G into a covariance of the
numbers A J' G J A, with A = (J' J)^-1. G is measured: noise is taken as stationary in each record,
with the autocovariance of the residuals there, up to where this first vanishes. As a fit takes
part of the noise for signal, the squares of its residuals sum up to tr G - tr A J' G J only; G is
raised by that ratio, which is n/(n - p) for independent samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..model.quantities import Floats

FLAT = 1e-12  # of the information about the best known direction: below is none


def covariance(jacobian: Floats, residuals: Floats, lengths: Sequence[int]) -> Floats:
    """Covariance of numbers.

    Parameters
    ----------
    jacobian : [sample, number] array
        Derivatives of the residuals; for a change of a number by 1, all its range. What is less
        well known than that gets a standard error of 1.
    residuals : [sample] array
    lengths : sequence of int
        Samples of each record.
    """
    ends = np.cumsum(lengths)[:-1]
    squares = float(residuals @ residuals)
    records = list(zip(np.split(jacobian, ends), np.split(residuals, ends), strict=True))
    noise = sum(carried(J, r) for J, r in records)  # J' G J
    information, directions = np.linalg.eigh(jacobian.T @ jacobian)
    floor = max(FLAT * information[-1], squares / len(residuals))
    known = information > floor
    basis = directions[:, known] / information[known]
    inside, unknown = basis.T @ noise @ basis, directions[:, ~known]
    taken = float(np.trace(inside * information[known]))
    if 0 < taken < squares:
        inside *= squares / (squares - taken)
    root = directions[:, known]
    total: Floats = root @ inside @ root.T + unknown @ unknown.T
    return total


def carried(jacobian: Floats, residuals: Floats) -> Floats:
    """J' G J of one record, by Fourier transforms: the spectrum of noise over that of J."""
    n = len(residuals)
    transform = np.fft.rfft(residuals, 2 * n)
    correlation = np.fft.irfft(np.abs(transform) ** 2)[:n] / n
    end = int(np.argmax(correlation <= 0)) or n
    correlation[end:] = 0.0
    both_ways = np.concatenate((correlation, [0.0], correlation[:0:-1]))
    spectrum = np.maximum(np.fft.rfft(both_ways).real, 0.0)
    spectrum[1:-1] *= 2  # frequencies below 0
    J = np.fft.rfft(jacobian, 2 * n, axis=0)
    total: Floats = ((J.conj().T * spectrum) @ J).real / (2 * n)
    return total
