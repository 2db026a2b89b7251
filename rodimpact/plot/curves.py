"""A family of collisions with one axis: a curve, or steps, over the closed form if there is one.

Results jump: the force duration where one impedance passes the other, velocities where a contact
more or less happens. A curve is broken where neighbours differ far more than those around them do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..results.pair_theory import PairTheory
from .scales import ROUND_OFF
from .sides import Shown, Side, count_ticks, dress_side
from .style import COMPUTED, colours, dress, grid, legend_above, picture

FEW = 40  # points of a curve that are marked
SMOOTH = 400  # points of a curve of theory, at least
AROUND = 3  # differences on either side of one whose median is the usual difference there
LEAP = 8.0  # usual differences that a jump surpasses
SEEN = 0.02  # of a quantity's range: a smaller jump is not seen


@picture
class Curve(NamedTuple):
    """Artists of a family with one axis; `theory` is the closed form, if there is one."""

    ax: Axes
    values: Line2D | StepPatch
    theory: Line2D | None


def draw_curve(ax: Axes, side: Side, shown: Shown, theory: PairTheory | None) -> Curve:
    """Draw values over one axis."""
    dress_side(ax, "x", side)
    ink = colours().ink
    law = None if theory is None else _law(ax, side, shown, theory)
    drawn: Line2D | StepPatch
    if shown.is_count:
        drawn = ax.stairs(shown.values, side.edges, baseline=None, color=ink, linewidth=1.4)
        count_ticks(ax.yaxis, shown)
    else:
        x, y = _broken(side.numbers, shown.values)
        gaps = np.isnan(np.pad(y, 1, constant_values=np.nan))
        few = side.values.size <= FEW
        single = np.flatnonzero(~gaps[1:-1] & gaps[:-2] & gaps[2:]).tolist()
        (drawn,) = ax.plot(
            x, y, color=ink, linewidth=1.2, linestyle="-" if law is None or not few else "",
            markevery=1 if few else single or None,
            **COMPUTED | {"marker": "o" if few or single else ""})
    least = float(np.nanmin(shown.values))
    low, high = min(0.0, least), max(0.0, float(np.nanmax(shown.values)))
    room = 0.05 * (high - low) or 1.0
    ax.set(ylim=(low if least > low + room else low - room, high + room),
           ylabel=shown.scale.label)
    grid(ax)
    if law is not None:
        legend_above(ax, [law, drawn])
    dress(ax)
    return Curve(ax, drawn, law)


def _law(ax: Axes, side: Side, shown: Shown, theory: PairTheory) -> Line2D:
    """Draw the closed form as a wide line, smooth between the values of the family."""
    known = np.log(side.values) if side.values[0] > 0 else side.values
    count = side.values.size - 1
    parts = -(-SMOOTH // count)
    wanted = np.interp(np.arange(count * parts + 1) / parts, np.arange(count + 1), known)
    values = theory.along(known, wanted).column(shown.quantity)
    at = np.exp(wanted) if side.values[0] > 0 else wanted
    (law,) = ax.plot(*_broken(at * side.scale.factor, values * shown.scale.factor),
                     color=colours().series[1], alpha=0.45, linewidth=5.0, label="closed form",
                     solid_capstyle="butt")
    return law


def _broken(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """A curve with NaN inserted where it jumps."""
    after = np.flatnonzero(jumps(y)) + 1
    return np.insert(x, after, (x[after - 1] + x[after]) / 2), np.insert(y, after, np.nan)


def jumps(values: Floats) -> NDArray[np.bool_]:
    """Whether each difference along the first axis is a jump: far larger than those around it."""
    steps = np.abs(np.diff(values, axis=0))
    outside = [(AROUND, AROUND), *[(0, 0)] * (steps.ndim - 1)]
    around = sliding_window_view(
        np.pad(steps, outside, constant_values=np.nan), 2 * AROUND + 1, axis=0).copy()
    around[..., AROUND] = np.nan_to_num(steps)
    least = max(SEEN * (np.nanmax(values) - np.nanmin(values)),
                ROUND_OFF * np.nanmax(np.abs(values)))
    return np.asarray(steps > np.maximum(LEAP * np.nanmedian(around, axis=-1), least))
