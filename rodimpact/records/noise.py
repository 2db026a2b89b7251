"""Noise of the gauges of a shot, drawn at random from the records before the pulse."""

import math

import numpy as np

from .instrumented_bar import InstrumentedBar, InstrumentedBars

NOISE_BLOCKS = 8
"""Number of blocks in the rest before the pulse, from which noise is drawn."""


def noise_of_bars(bars: InstrumentedBars, rng: np.random.Generator) -> InstrumentedBars:
    """Both bars, with gauges that record nothing but noise, drawn by `rng`."""
    return InstrumentedBars(
        input=noise_of_bar(bars.input, rng), output=noise_of_bar(bars.output, rng)
    )


def noise_of_bar(bar: InstrumentedBar, rng: np.random.Generator) -> InstrumentedBar:
    """The bar with gauges that record nothing but noise, drawn by `rng`.

    The noise of a gauge, at all times of the bar, consists of blocks of its record at
    rest, drawn at random (block bootstrap). As in a record, the mean over the first
    `rest_samples` is subtracted. Blocks keep the correlation of the noise. The record
    itself has lost its mean over the rest, so its noise is too small: the result is
    enlarged to make up for that.
    """
    block = max(2, bar.rest_samples // NOISE_BLOCKS)  # samples of a block
    count = len(bar.times)
    n_blocks = count // block + 1  # enough; the last one is cut
    drawn = []
    for strain in bar.strains:
        # First sample of each block, anywhere in the rest (the upper bound is excluded)
        starts = rng.integers(0, bar.rest_samples - block + 1, n_blocks)
        samples = starts[:, None] + np.arange(block)  # indices [block, sample in block]
        noise = strain[samples].ravel()[:count]
        baseline = noise[: bar.rest_samples].mean()
        drawn.append(noise - baseline)
    # The record at rest has the mean 0. So sums over its blocks vary less, by this
    # factor, than sums over blocks of the true noise.
    shrinkage = math.sqrt(1 - block / bar.rest_samples)
    return bar._replace(strains=np.array(drawn) / shrinkage)
