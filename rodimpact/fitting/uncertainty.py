"""Covariance of the fitted numbers from residuals that are correlated in time.

Least squares with the derivatives J = Q R turn noise of the covariance matrix G into a
covariance of the numbers, R^-1 (Q' G Q) R^-1'. G is estimated from the residuals; in
each record the noise is assumed to be stationary. The fit explains part of the noise:
residuals have the covariance M G M, M = 1 - Q Q'. The autocovariance of the noise is
therefore that of the residuals, up to its first zero, plus the part that the fit has
removed.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..model.quantities import Floats

MIN_INFORMATION = 1e-12
"""A direction with less information, relative to the best known one, is unknown."""
ROUNDS = 6
"""Rounds in which the part of the noise that the fit has explained is found.

More rounds change the errors by less than 1 %.
"""


def covariance(jacobian: Floats, residuals: Floats, lengths: Sequence[int]) -> Floats:
    """Covariance of the fitted numbers, [number, number].

    It is found in rounds: the noise follows from the residuals and the part that the
    fit has explained, and that part from the noise.

    Parameters
    ----------
    jacobian : [sample, number] array
        Derivatives of the residuals with respect to the numbers, scaled so that the
        range of each number is 1. A direction known less well than that gets the
        standard error 1.
    residuals : [sample] array
    lengths : sequence of int
        Samples of each record.
    """
    ends = np.cumsum(lengths)[:-1]  # where a record ends and the next one begins
    information, directions = np.linalg.eigh(jacobian.T @ jacobian)
    least_information = max(
        MIN_INFORMATION * information[-1], float(np.mean(residuals**2))
    )
    is_known = information > least_information
    # The derivatives are J = Q R in the directions that are known.
    inverse_R = directions[:, is_known] / np.sqrt(information[is_known])
    unknown = directions[:, ~is_known]
    spectra = []  # spectra of the columns of Q, by record
    for Q in np.split(jacobian @ inverse_R, ends):
        spectra.append(np.fft.rfft(Q, 2 * len(Q), axis=0))
    # Autocovariances of each record: of the residuals, and of the noise that the fit
    # has removed from them, which is 0 in the first round.
    observed = list(map(autocovariance, np.split(residuals, ends)))
    explained = list(map(np.zeros_like, observed))
    for _ in range(ROUNDS + 1):
        noise = []  # spectrum of the noise of each record
        for c, c_explained in zip(observed, explained, strict=True):
            noise.append(power_spectrum(c + c_explained))
        # Q' G Q, with the covariance matrix G of the noise of all records
        projected = sum(map(projected_noise, noise, spectra))
        explained = []
        for power, spectrum in zip(noise, spectra, strict=True):
            explained.append(explained_noise(power, spectrum, projected))
    total: Floats = inverse_R @ projected @ inverse_R.T + unknown @ unknown.T
    return total


def autocovariance(residuals: Floats) -> Floats:
    """Mean product of two residuals of a record, [number of samples between them].

    For each distance the sum of the products is divided by the number of all samples,
    not of pairs.
    """
    n = len(residuals)
    # The n zeros that are added keep the end of the record from meeting its beginning.
    power = np.abs(np.fft.rfft(residuals, 2 * n)) ** 2
    products: Floats = np.fft.irfft(power)[:n] / n
    return products


def power_spectrum(correlation: Floats) -> Floats:
    """Spectrum of noise with an autocovariance, which is cut off at its first zero.

    The first zero is the first value that is 0 or negative. The spectrum has
    len(correlation) + 1 frequencies; its negative values are replaced by 0.
    """
    n = len(correlation)
    first_zero = int(np.argmax(correlation <= 0))
    if first_zero == 0:  # argmax found no zero
        first_zero = n
    # Entry k is the autocovariance at lag k, entry 2 n - k that at lag -k: the lags
    # first_zero - 1, ..., 1 in falling order are at the end. Lag 0 is there once.
    symmetric = np.zeros(2 * n)
    symmetric[:first_zero] = correlation[:first_zero]
    symmetric[2 * n - first_zero + 1 :] = correlation[first_zero - 1 : 0 : -1]
    return np.maximum(np.fft.rfft(symmetric).real, 0.0)


def projected_noise(noise: Floats, Q: Any) -> Floats:
    """Q' G Q of one record by Parseval's theorem, G the covariance of its noise.

    Parameters
    ----------
    noise : [frequency] array
        Spectrum of the noise.
    Q : [frequency, number] array
        Spectrum of Q, padded with zeros to twice the samples of the record.
    """
    weights = np.full(len(noise), 2.0)  # each stands for a negative frequency, too
    weights[[0, -1]] = 1.0
    products = (Q.conj().T * (noise * weights)) @ Q
    padded_samples = 2 * len(noise) - 2
    projected: Floats = products.real / padded_samples
    return projected


def explained_noise(noise: Floats, Q: Any, projected: Any) -> Floats:
    """Autocovariance of Q Q' G + G Q Q' - Q (Q' G Q) Q' in one record.

    G is the covariance of the noise. The columns of Q are orthonormal, and Q Q' is the
    projection on the changes of the prediction that the fitted numbers can make. So the
    expression is G minus the covariance of the residuals of the fit.

    Parameters
    ----------
    noise : [frequency] array
        Spectrum of the noise.
    Q : [frequency, number] array
        Spectrum of Q.
    projected : [number, number] array
        Q' G Q of all records.
    """
    n = len(noise) - 1  # samples of the record; the spectra are of 2 n
    filtered = np.fft.irfft(noise[:, None] * Q, 2 * n, axis=0)[:n]  # G Q, in time
    spectrum = np.fft.rfft(filtered, 2 * n, axis=0)
    # Q Q' G and its transpose G Q Q' have the same autocovariance: hence the factor 2.
    power = np.sum(Q.conj() * (2 * spectrum - Q @ projected), axis=1).real
    products: Floats = np.fft.irfft(power, 2 * n)[:n] / n
    return products
