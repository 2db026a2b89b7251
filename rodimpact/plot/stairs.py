"""Curves that are constant between edges."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import StepPatch

from ..methods.signals import Floats


def stairs(
    ax: Axes, values: Floats, edges: Floats, color: str, *, baseline: float | None = 0.0,
    fill: bool = False, up: bool = False, **how: Any,
) -> StepPatch:
    """Draw a value between each two edges, to the right or upward.

    `Axes.stairs` looks for its limits corner by corner, which takes longer than all else.
    """
    paint = {"facecolor": color, "linewidth": 0.0} if fill else {"edgecolor": color}
    patch = StepPatch(
        values, edges, baseline=baseline, fill=fill,  # type: ignore[arg-type]  # None may be
        orientation="horizontal" if up else "vertical", **(paint | how))
    ax.add_artist(patch)
    ends = [float(np.min(values)), float(np.max(values))]
    if baseline is not None:
        ends.append(baseline)
        (patch.sticky_edges.x if up else patch.sticky_edges.y).append(baseline)
    corners = [(edges[0], min(ends)), (edges[-1], max(ends))]
    ax.update_datalim([corner[::-1] for corner in corners] if up else corners)
    ax.autoscale_view()
    return patch
