"""How well a fit knows its numbers, from residuals that are not independent of each other.

Two measures, of which along every direction the larger counts. One leaves out blocks of the
records, halves to sixths, each in turn, and takes by how much the numbers move then (delete-block
jackknife, in linear approximation; the mean over these divisions). The other takes n samples for
n/tau independent ones, with the correlation time tau of the residuals in samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..model.quantities import Floats

DIVISIONS = (2, 3, 4, 5, 6)
KEPT = 0.002  # of what a block tells of a number, where nothing else tells it
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
    n, p = jacobian.shape
    ends = np.cumsum(lengths)[:-1]
    variance = float(residuals @ residuals) / max(n - p, 1)
    variance *= correlation_time(np.split(residuals, ends))
    information, directions = np.linalg.eigh(jacobian.T @ jacobian)
    known = information > max(variance, FLAT * information[-1])
    basis = directions[:, known] / np.sqrt(information[known])  # in which all is known alike
    J, eye = jacobian @ basis, np.eye(basis.shape[1])
    moved = np.zeros_like(eye)
    for parts in DIVISIONS:
        moves = []
        for block in [b for record in np.split(np.arange(n), ends)
                      for b in np.array_split(record, parts)]:
            told = J[block].T @ J[block]
            moves.append(np.linalg.solve((1 + KEPT) * eye - told, J[block].T @ residuals[block]))
        D = np.array(moves)
        moved += (1 - 1 / len(D)) / len(DIVISIONS) * (D.T @ D)
    size, axes = np.linalg.eigh(moved)
    root = basis @ axes * np.sqrt(np.maximum(size, variance))
    unknown = directions[:, ~known]
    total: Floats = root @ root.T + unknown @ unknown.T
    return total


def correlation_time(records: Sequence[Floats]) -> float:
    """Samples for each independent one: 1 + 2 times the correlations, up to where they end."""
    longest = max(map(len, records))
    together = np.zeros(longest)
    for r in records:
        together[: len(r)] += np.correlate(r, r, "full")[len(r) - 1 :]
    end = int(np.argmax(together <= 0)) or longest
    return float(1 + 2 * together[1:end].sum() / together[0]) if together[0] else 1.0
