"""What lies along the sides of a picture of a family, and what is shown in it."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..results.labels import parameter
from ..running.sweep_result import STATUS, SweepResult
from ..units import format_factor, format_power
from .scales import Scale, scale_of

WIDE = 3.0  # last over first value from which an axis may be logarithmic


class Side(NamedTuple):
    """An axis of the family: the order in which its values increase, and these values."""

    order: NDArray[np.intp]
    values: Floats
    scale: Scale
    beside: list[str]  # what varies along with it

    @property
    def numbers(self) -> Floats:
        """Numbers on the axis."""
        return self.values * self.scale.factor

    @property
    def is_log(self) -> bool:
        """Whether the values have a wide range and are spread more evenly by their logarithms."""
        first, last = self.values[[0, -1]]
        if self.values.size < 3 or first <= 0 or last < WIDE * first:
            return False
        steps, ratios = np.diff(self.values), np.diff(np.log(self.values))
        return bool(np.std(ratios) / np.mean(ratios) < np.std(steps) / np.mean(steps) / 2)

    @property
    def edges(self) -> Floats:
        """Borders half-way between the numbers and as far beyond the outer ones, not beyond 0."""
        x = np.log(self.numbers) if self.is_log else self.numbers
        middle = (x[:-1] + x[1:]) / 2
        edges = np.concatenate(([2 * x[0] - middle[0]], middle, [2 * x[-1] - middle[-1]]))
        if self.is_log:
            return np.exp(edges)
        return np.maximum(edges, 0.0) if x[0] >= 0 else edges


class Shown(NamedTuple):
    """What is drawn, in the unit of the scale."""

    quantity: str
    values: Floats
    scale: Scale
    is_count: bool

    @property
    def words(self) -> tuple[str, ...]:
        """What the counts 0, 1, ... stand for, if they are no numbers."""
        return {"final": ("not proved", "proved"), "status": STATUS}.get(self.quantity, ())


def side_of(result: SweepResult, dimension: int) -> Side:
    """What lies along a dimension of the family; members are counted if that is all the same."""
    name, values = result.axes[dimension]
    values = np.asarray(values, dtype=float)
    if values.min() == values.max():
        name, values = f"axis {dimension}", np.arange(values.size, dtype=float)
    order = np.argsort(values, kind="stable")
    quantity = parameter(result.system, name)
    from_end = len(result.shape) - dimension
    beside = [parameter(result.system, path).name for path, numbers in result.parameters.items()
              if path != name and numbers.ndim >= from_end and numbers.shape[-from_end] > 1]
    return Side(order, values[order], scale_of(quantity, float(np.abs(values).max())), beside)


def dress_side(ax: Axes, which: Literal["x", "y"], side: Side) -> None:
    """Limits, label and ticks of an axis of the family."""
    label = side.scale.label
    if side.beside:
        more = f" and {len(side.beside) - 2} more" if len(side.beside) > 2 else ""
        label += f"\nwith {', '.join(side.beside[:2])}{more}"
    first, last = side.edges[[0, -1]]
    ax.set(**{f"{which}scale": "log" if side.is_log else "linear", f"{which}label": label,
              f"{which}lim": (first, last)})
    if side.is_log:
        axis = ax.xaxis if which == "x" else ax.yaxis
        subs = (1.0, 2.0, 5.0) if last < 2e3 * first else (1.0,)
        axis.set_major_locator(LogLocator(subs=subs, numticks=15))
        axis.set_major_formatter(FuncFormatter(lambda value, _: _plain(value)))
        axis.set_minor_formatter(NullFormatter())


def _plain(value: float) -> str:
    """A tick of a logarithmic axis: a number, or a power of ten if it is small."""
    return format_factor(value) if value > 0.9e-3 else format_power(round(math.log10(value)))


def count_ticks(axis: Axis, shown: Shown) -> None:
    """Ticks at whole numbers, or what they stand for."""
    if shown.words:
        axis.set_ticks(range(len(shown.words)), shown.words)
    else:
        axis.set_major_locator(MaxNLocator(12, integer=True))
        axis.set_minor_locator(NullLocator())
