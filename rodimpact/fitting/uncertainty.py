"""Covariance of the fitted numbers from residuals that are correlated in time.

Least squares with the derivatives J = Q R turn noise of the covariance matrix G into a covariance
of the numbers, R^-1 (Q' G Q) R^-1'. G is estimated from the residuals; in each record the noise is
assumed to be stationary. The fit explains part of the noise: residuals have the covariance M G M, M
= 1 - Q Q'. The autocovariance of the noise is therefore that of the residuals, up to its first
zero, plus the part that the fit has removed.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..model.quantities import Floats

FLAT = 1e-12  # of the information about the best known direction: below is none
ROUNDS = 6  # of finding what the fit has taken: more change errors by less than 1 %


def covariance(jacobian: Floats, residuals: Floats, lengths: Sequence[int]) -> Floats:
    """Covariance of numbers.

    Parameters
    ----------
    jacobian : [sample, number] array
        Derivatives of the residuals with respect to the numbers, scaled so that the range of each
        number is 1. A direction known less well than that gets the standard error 1.
    residuals : [sample] array
    lengths : sequence of int
        Samples of each record.
    """
    ends = np.cumsum(lengths)[:-1]
    information, directions = np.linalg.eigh(jacobian.T @ jacobian)
    known = information > max(FLAT * information[-1], float(np.mean(residuals**2)))
    root, unknown = (
        directions[:, known] / np.sqrt(information[known]),
        directions[:, ~known],
    )
    spectra = [
        np.fft.rfft(Q, 2 * len(Q), axis=0) for Q in np.split(jacobian @ root, ends)
    ]
    seen = [autocovariance(r) for r in np.split(residuals, ends)]
    taken = [np.zeros_like(c) for c in seen]
    for _ in range(ROUNDS + 1):
        noise = [power_of(c + more) for c, more in zip(seen, taken, strict=True)]
        carried = sum(map(carried_by, noise, spectra))  # Q' G Q
        taken = [
            taken_by_fit(S, Q, carried) for S, Q in zip(noise, spectra, strict=True)
        ]
    total: Floats = root @ carried @ root.T + unknown @ unknown.T
    return total


def autocovariance(residuals: Floats) -> Floats:
    """Mean products of two residuals of one record, by the number of samples between them."""
    n = len(residuals)
    products: Floats = np.fft.irfft(np.abs(np.fft.rfft(residuals, 2 * n)) ** 2)[:n] / n
    return products


def power_of(correlation: Floats) -> Floats:
    """Spectrum, not below 0, of noise with this autocovariance up to its first zero."""
    n = len(correlation)
    kept = correlation[: int(np.argmax(correlation <= 0)) or n]
    both_ways = np.zeros(2 * n)
    both_ways[: len(kept)] = kept
    both_ways[2 * n - len(kept) + 1 :] = kept[:0:-1]
    return np.maximum(np.fft.rfft(both_ways).real, 0.0)


def carried_by(noise: Floats, Q: Any) -> Floats:
    """Q' G Q of one record, by the spectra of noise and of Q."""
    twice = np.full(len(noise), 2.0)  # frequencies below 0 as well
    twice[[0, -1]] = 1.0
    return ((Q.conj().T * (noise * twice)) @ Q).real / (2 * len(noise) - 2)  # type: ignore[no-any-return]


def taken_by_fit(noise: Floats, Q: Any, carried: Any) -> Floats:
    """Autocovariance of Q Q' G + G Q Q' - Q (Q' G Q) Q' in one record."""
    n = len(noise) - 1
    felt = np.fft.rfft(
        np.fft.irfft(noise[:, None] * Q, 2 * n, axis=0)[:n], 2 * n, axis=0
    )
    power = np.sum(Q.conj() * (2 * felt - Q @ carried), axis=1).real
    products: Floats = np.fft.irfft(power, 2 * n)[:n] / n
    return products
