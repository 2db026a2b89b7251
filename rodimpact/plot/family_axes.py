"""Axes of a family: along each of them one number varies, or several together."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib import ticker
from matplotlib.axis import Axis
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model.frozen import invalid_argument
from ..results.labels import Quantity, quantity_of_parameter
from ..running.sweep_result import SweepResult
from ..storage.grids import Varied
from ..units import format_factor, shown
from .scales import Scale, scale_of

MIN_LOG_RANGE = 3.0  # last over first value from which an axis may be logarithmic
MAX_DECADES_WITH_2_AND_5 = 2e3  # last over first value up to which 2 and 5 have ticks


class FamilyAxis(NamedTuple):
    """An axis of the family: the order in which its values increase, and the values."""

    order: NDArray[np.intp]
    values: Floats
    scale: Scale
    label: str  # name and unit, and the name of what varies along with it
    is_ordered: bool  # whether all that varies along it rises or falls with the values

    @property
    def numbers(self) -> Floats:
        """Numbers on the axis."""
        return self.values * self.scale.factor

    @property
    def is_log(self) -> bool:
        """Whether the range is wide and logarithms are spread more evenly.

        Unevenness is the standard deviation of the steps between values, divided by the
        mean step; that of the logarithms must be less than half.
        """
        first, last = self.values[[0, -1]]
        if self.values.size < 3 or first <= 0 or last < MIN_LOG_RANGE * first:
            return False
        steps = np.diff(self.values)
        log_steps = np.diff(np.log(self.values))
        unevenness = np.std(steps) / np.mean(steps)
        log_unevenness = np.std(log_steps) / np.mean(log_steps)
        return bool(log_unevenness < unevenness / 2)

    @property
    def edges(self) -> Floats:
        """Borders [n + 1] of cells about the numbers [n] on the axis.

        They lie half-way between the numbers, by their logarithms if the axis is
        logarithmic, and as far beyond the outer ones, but not below 0.
        """
        x = self.numbers
        if self.is_log:
            x = np.log(x)
        middle = (x[:-1] + x[1:]) / 2
        first = 2 * x[0] - middle[0]
        last = 2 * x[-1] - middle[-1]
        edges = np.concatenate(([first], middle, [last]))
        if self.is_log:
            edges = np.exp(edges)
        if self.values[0] >= 0:
            edges = np.maximum(edges, 0.0)
        return edges


def check_varied(result: SweepResult, varied: Any) -> Sequence[Varied]:
    """What the user varied along each axis of a family, () for None.

    Raises
    ------
    InvalidModel
        If it is no list or tuple of `Varied` that has the shape of the family.
    """
    if varied is None:
        return ()
    is_right = isinstance(varied, list | tuple)
    is_right = is_right and all(isinstance(axis, Varied) for axis in varied)
    if is_right:
        shape = tuple(axis.values.size for axis in varied)
        is_right = shape == result.shape
    if not is_right:
        message = f"must be the `varied` of the case of this family, {result.shape}"
        raise invalid_argument("varied", f"{message}; got {shown(varied)}")
    return tuple(varied)


def family_axis(
    result: SweepResult, dimension: int, varied: Sequence[Varied] = ()
) -> FamilyAxis:
    """The axis of a dimension of the family: order, values, scale and label.

    Members are counted, 0, 1, ..., if all values along the dimension are the same. The
    label names what else varies along it.

    Parameters
    ----------
    result : SweepResult
    dimension : int
    varied : sequence of Varied
        What the user varied along each axis, and follows on the axis alone; () if
        unknown.
    """
    name, values = result.axes[dimension]
    quantity = quantity_of_parameter(result.system, name)
    if varied:
        name, values, unit = varied[dimension]
        quantity = quantity_of_parameter(result.system, name)
        if quantity.name == name:  # no number of the system
            quantity = Quantity(name, unit or "1")
    values = np.asarray(values, dtype=float)
    if values.min() == values.max():
        name = f"axis {dimension}"
        values = np.arange(values.size, dtype=float)
        quantity = quantity_of_parameter(result.system, name)
    order = np.argsort(values, kind="stable")
    scale = scale_of(quantity, float(np.abs(values).max()))

    companions = []
    is_ordered = True
    for path, numbers in _varying_along(result, dimension).items():
        if path == name:
            continue
        if not varied:
            companions.append(quantity_of_parameter(result.system, path).name)
        if not _is_monotonic(numbers[order]):
            is_ordered = False
    label = scale.label
    if companions:
        label += f"\nwith {companions[0]}"
    if len(companions) > 1:
        label += f" and {len(companions) - 1} more"
    return FamilyAxis(order, values[order], scale, label, is_ordered)


def _varying_along(result: SweepResult, dimension: int) -> dict[str, NDArray[Any]]:
    """Numbers that vary along a dimension, by path, each with the dimension first.

    Numbers with fewer dimensions than the family vary along its last ones.
    """
    from_end = len(result.shape) - dimension
    varying = {}
    for path, numbers in result.parameters.items():
        if numbers.ndim >= from_end and numbers.shape[-from_end] > 1:
            varying[path] = np.moveaxis(numbers, -from_end, 0)
    return varying


def _is_monotonic(numbers: NDArray[Any]) -> bool:
    """Whether numbers never fall or never rise along their first axis."""
    steps = np.diff(numbers.astype(float), axis=0)
    rises = (steps >= 0).all(axis=0)
    falls = (steps <= 0).all(axis=0)
    return bool((rises | falls).all())


def format_family_axis(axis: Axis, family: FamilyAxis) -> None:
    """Set limits, label, scale and ticks of an axis: 1, 2, 5 if it is logarithmic."""
    first, last = family.edges[[0, -1]]
    axis.set_label_text(family.label)
    scale = "log" if family.is_log else "linear"
    if axis is axis.axes.xaxis:
        axis.axes.set(xscale=scale, xlim=(first, last))
    else:
        axis.axes.set(yscale=scale, ylim=(first, last))
    if family.is_log:
        digits: tuple[float, ...] = (1.0,)
        if last < MAX_DECADES_WITH_2_AND_5 * first:
            digits = (1.0, 2.0, 5.0)
        axis.set_major_locator(ticker.LogLocator(subs=digits, numticks=15))
        axis.set_major_formatter(
            ticker.FuncFormatter(lambda value, _: format_factor(value))
        )
        axis.set_minor_formatter(ticker.NullFormatter())
