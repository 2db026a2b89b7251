"""A family of collisions: a curve over one axis, a map over two, and theory where there is some."""

from __future__ import annotations

import difflib
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..model.arguments import of_kind
from ..model.frozen import refusal
from ..results.labels import outcome
from ..results.pair_theory import COLUMNS, pair_theory
from ..running.sweep_result import SweepResult
from ..units import shown
from .curves import Curve, draw_curve
from .maps import Map, draw_map
from .scales import scale_of
from .sides import Shown, side_of
from .style import axes, styled


@styled
def sweep(
    result: SweepResult, ax: Axes | None = None, quantity: str = "restitution"
) -> Curve | Map:
    """Draw one quantity of a family of collisions: a curve over one axis, a map over two.

    An axis is logarithmic where its values come nearer to a geometric than to an arithmetic
    sequence. Collisions without a value leave gaps. For two uniform bodies that do not vibrate the
    closed form is drawn under the curve; on a map of two such rods a full line marks equal transit
    times, where e = 1, and a dashed one equal impedances, where the force duration jumps.

    Parameters
    ----------
    result : SweepResult
    ax : Axes, optional
        By default the Axes of a new figure.
    quantity : str
        A name of ``result.columns``, such as ``"restitution"``, ``"duration.0"`` of contact 0 or
        ``"velocity_after.1"`` of body 1.

    Returns
    -------
    Curve or Map

    Raises
    ------
    ValueError
        For an unknown quantity, one without any value in this family, and a family that has no
        axis or more than two; axes with a single value do not count.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod([0.2, 0.4, 0.8], area=1e-4, material=steel, velocity=1.0)
    >>> family = ri.sweep(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> ri.plot.sweep(family, quantity="velocity_after.1").ax.get_xlabel()
    'length of rod 1 (m)'
    """
    of_kind("result", result, SweepResult, "rodimpact.sweep(family)")
    column = _column(result, quantity)
    sides = [side_of(result, i) for i in _dimensions(result)]
    order = np.ix_(*(side.order for side in sides))

    def arranged(table: NDArray[Any]) -> NDArray[Any]:
        return table.reshape([side.order.size for side in sides])[order]

    values = arranged(column).astype(float)
    largest = float(np.nanmax(np.abs(values)))
    scale = scale_of(outcome(result.system, quantity), largest)
    family = pair_theory(result.system) if quantity in COLUMNS else None
    theory = None if family is None else family.each(arranged)
    shown = Shown(quantity, values * scale.factor, scale, column.dtype.kind in "iub")
    if len(sides) == 1:
        return draw_curve(axes(ax, 5.6, 3.6), sides[0], shown, theory)
    return draw_map(axes(ax, 6.0, 4.6), sides[0], sides[1], shown, theory)


def _column(result: SweepResult, quantity: str) -> NDArray[Any]:
    """Values of a quantity; ValueError if there is none of this name, or no value at all."""
    if not isinstance(quantity, str) or quantity not in result.columns:
        near = [name for name in result.columns if name.startswith(f"{quantity}.")]
        near = near or difflib.get_close_matches(shown(quantity), result.columns, n=1)
        hint = f"; perhaps {near[0]!r} is meant" if near else ""
        groups = [list(g) for _, g in groupby(result.columns, lambda name: name.partition(".")[0])]
        known = [f"{first} to {others[-1].partition('.')[2]}" if others else first
                 for first, *others in groups]
        message = f"must be one of {', '.join(known)}, got {shown(quantity)}{hint}"
        raise refusal("quantity", f"{message}")
    column: NDArray[Any] = result.columns[quantity]
    if not np.isfinite(column).any():
        raise refusal(
            "quantity", f"{quantity!r} has no value anywhere in this family; "
            "result.explain(index) says why"
        )
    return column


def _dimensions(result: SweepResult) -> list[int]:
    """Dimensions with more than one value; ValueError unless they are one or two."""
    wide = [i for i, count in enumerate(result.shape) if count > 1]
    if not wide:
        raise refusal(
            "result", f"has shape {result.shape}, a single collision, and nothing to draw it over; "
            "give an array for a number of the system, such as length=np.linspace(0.1, 1, 50)"
        )
    if len(wide) > 2:
        raise refusal(
            "result",
            f"has shape {result.shape}, and a map shows two axes; sweep a smaller family, "
            f"such as system[{', '.join(['0'] * (len(result.shape) - 2))}]"
        )
    return wide
