"""Which of very many values to draw, so that the picture is the same and the file small."""

from __future__ import annotations

import numpy as np

from ..methods.signals import Floats, Ints

INTERVALS = 1000


def telling(values: Floats) -> Ints:
    """Indices of the least and the largest value of each of `INTERVALS`, of the first and last.

    All indices of up to twice as many values.
    """
    if values.size <= 2 * INTERVALS:
        return np.arange(values.size)
    edges = np.linspace(0, values.size, INTERVALS + 1).astype(np.int64)
    kept = [0, values.size - 1]
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        part = values[start:stop]
        kept += [start + int(part.argmin()), start + int(part.argmax())]
    return np.unique(kept)
