"""Restitution of many pairs of rods against the law e = l1/l2."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import ArrayLike

from ..model.arguments import array
from ..model.frozen import refusal
from .scales import MINUS
from .style import COMPUTED, SMALL, axes, colours, dress, grid, picture, styled


@picture
class Restitution(NamedTuple):
    """Artists of restitution against the ratio of lengths."""

    ax: Axes
    law: Line2D
    points: Line2D
    residual: Text


@styled
def restitution(ratios: ArrayLike, values: ArrayLike, ax: Axes | None = None) -> Restitution:
    """Draw computed coefficients of restitution against the law e = l1/l2, and note the residual.

    The law holds for two rods of one material and cross-section, the second at rest inside and
    longer than the first.

    Parameters
    ----------
    ratios : array_like
        Shorter length over longer one, l1/l2.
    values : array_like, same shape
        Computed e; NaN, for a collision without one, is left out.
    ax : Axes, optional
        By default the Axes of a new figure.

    Returns
    -------
    Restitution

    Raises
    ------
    ValueError
        If the shapes differ, or no value is a number.
    """
    x, e = array("ratios", ratios, ""), array("values", values, "")
    if x.shape != e.shape:
        raise refusal("values", f"must have the shape {x.shape} of ratios, got {e.shape}")
    known = np.isfinite(x) & np.isfinite(e)
    if not known.any():
        raise refusal("values", "needs at least one finite coefficient of restitution, got none")
    x, e = x[known], e[known]
    ax = axes(ax, 4.2, 4.0)
    reach = max(1.0, float(x.max()))
    (law,) = ax.plot([0, reach], [0, reach], color=colours().series[1], linewidth=1.2,
                     label="e = ℓ₁/ℓ₂")
    (points,) = ax.plot(x, e, linestyle="", color=colours().ink, **COMPUTED)
    note = f"largest |e {MINUS} ℓ₁/ℓ₂| = {np.abs(e - x).max():.1e}\nin {e.size} collisions"
    residual = ax.text(0.98, 0.04, note, transform=ax.transAxes, ha="right", va="bottom",
                       fontsize=SMALL + 1)
    ax.set(xlim=(0, reach), ylim=(0, max(reach, 1.05 * float(e.max()))), aspect="equal",
           xlabel="ratio of lengths ℓ₁/ℓ₂", ylabel="coefficient of restitution e")
    grid(ax)
    ax.legend(loc="upper left", frameon=False, fontsize=SMALL + 1)
    dress(ax)
    return Restitution(ax, law, points, residual)
