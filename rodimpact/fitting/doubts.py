"""Notes on a fit: parameters that are not determined, at a bound, or dependent on the start."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..model.quantities import Floats
from ..units import format_si
from .result import Descent, Fitted, correlation_of

LOOSE = 0.5  # of the range: a number with a larger standard error is not determined
AT_BOUND = 1e-3  # of the range
ALIKE = 0.98  # correlation from which on two numbers are hardly told apart
SAME, NONE = 1e-3, 1e-9  # differences of misfits that count as none: of them, of the level
APART = 0.3  # standard errors by which searches may end apart


def doubts(
    fitted: Sequence[Fitted], relative: Floats, descents: Sequence[Descent]
) -> Iterator[str]:
    """Notes on the parameters; `relative` is their covariance relative to their ranges."""
    errors = np.sqrt(np.diag(relative))
    open_ones = errors > LOOSE
    for f, is_open in zip(fitted, open_ones, strict=True):
        if is_open:
            yield (f"{f.name} is not determined: its standard error is as large as its range. "
                   "Fix this parameter, or add a record that depends on it.")
        if not f.high - f.low < np.inf:
            continue
        for end, remedy in ((f.low, "lower"), (f.high, "raise")):
            if abs(f.value - end) <= AT_BOUND * (f.high - f.low):
                yield (f"{f.name} is at its bound, {format_si(end, f.unit)}, so its "
                       f"standard error is not reliable: {remedy} the bound, or fix the parameter.")
    correlation = correlation_of(relative)
    for i, j in np.argwhere(np.triu(np.abs(correlation) > ALIKE, 1)):
        if not (open_ones[i] or open_ones[j]):
            yield (f"{fitted[i].name} and {fitted[j].name} are hardly distinguishable: the "
                   f"correlation of their errors is {correlation[i, j]:.3f}. Fix one of them.")
    best, *others = descents
    if not best.complete:
        yield "The best search was stopped before it reached a minimum."
    worse = [d.misfit for d in others if d.misfit > (1 + SAME) * best.misfit + NONE]
    if worse:
        yield (f"{len(worse)} of {len(descents)} searches ended at larger misfits, "
               f"{100 * min(worse):.3g} % and more: there are several minima. Use more starts or "
               "narrower bounds to test whether this minimum is the best.")
    for f in fitted:
        same = [d.values[f.name] for d in descents if d.misfit <= (1 + SAME) * best.misfit]
        if np.ptp(same) > APART * f.standard_error:
            ends = f"{format_si(min(same), f.unit)} to {format_si(max(same), f.unit)}"
            yield f"Searches with the same misfit ended at different values of {f.name}: {ends}."
