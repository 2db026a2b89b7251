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
MAX_RATIO_WITH_2_AND_5 = 2e3  # last over first value up to which 2 and 5 have ticks


class FamilyAxis(NamedTuple):
    """An axis of a picture of a family: one of its dimensions, sorted by the values."""

    order: NDArray[np.intp]  # values[order] of the family never decrease
    values: Floats  # in this order, SI
    scale: Scale  # from SI to the numbers on the axis
    label: str  # name and unit, and the names of other numbers that vary along it
    is_ordered: bool  # whether these other numbers rise or fall with the values

    @property
    def numbers(self) -> Floats:
        """The values in the unit of the axis."""
        return self.values * self.scale.factor

    @property
    def is_log(self) -> bool:
        """Whether the axis is logarithmic: it has a wide range, and even logarithms.

        At least three values are positive, and the last is `MIN_LOG_RANGE` times the
        first or more. The unevenness, which is the standard deviation of the steps
        between values divided by the mean step, is less than half as large for the
        logarithms as for the values.
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

        Inner borders lie half-way between two numbers, on a logarithmic axis half-way
        between their logarithms. The outer numbers are in the middles of their cells.
        No border is below 0 if no number is.
        """
        x = self.numbers
        if self.is_log:
            x = np.log(x)
        inner = (x[:-1] + x[1:]) / 2
        # Mirror images of the nearest inner borders in the outer numbers
        first = 2 * x[0] - inner[0]
        last = 2 * x[-1] - inner[-1]
        edges = np.concatenate(([first], inner, [last]))
        if self.is_log:
            edges = np.exp(edges)
        if self.values[0] >= 0:  # the first value is the least
            edges = np.maximum(edges, 0.0)
        return edges


def check_varied(result: SweepResult, varied: Any) -> Sequence[Varied]:
    """The argument `varied`, checked, as a tuple; () for None.

    Raises
    ------
    InvalidModel
        If it is no list or tuple of `Varied`, one for each axis of the family, with as
        many values as the axis has.
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

    The values are those that the user varied, else those of `result.axes`. If they are
    all the same, the members are counted instead, 0, 1, ..., and the axis is called
    "axis" with its number. The label also names the
    first of the other numbers that vary along the dimension, and how many more there
    are, unless `varied` says what the user varied. `is_ordered` is false if one of the
    other numbers, in the order of the values, both rises and falls.

    Parameters
    ----------
    result : SweepResult
    dimension : int
    varied : sequence of Varied
        What the user varied along each axis; () if unknown.
    """
    name, values = result.axes[dimension]
    quantity = quantity_of_parameter(result.system, name)
    if varied:
        name, values, unit = varied[dimension]
        quantity = quantity_of_parameter(result.system, name)
        if quantity.name == name:  # the user's own number, not one of the system
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
    """Numbers that vary along a dimension, by path, each with this dimension first.

    A number with fewer dimensions than the family has the last ones, as in NumPy's
    broadcasting.
    """
    from_end = len(result.shape) - dimension  # the dimension is number -from_end
    varying = {}
    for path, numbers in result.parameters.items():
        if numbers.ndim >= from_end and numbers.shape[-from_end] > 1:
            varying[path] = np.moveaxis(numbers, -from_end, 0)
    return varying


def _is_monotonic(numbers: NDArray[Any]) -> bool:
    """Whether numbers never fall or never rise along their first axis.

    Each column of further axes may do either.
    """
    steps = np.diff(numbers.astype(float), axis=0)
    rises = (steps >= 0).all(axis=0)
    falls = (steps <= 0).all(axis=0)
    return bool((rises | falls).all())


def format_family_axis(axis: Axis, family: FamilyAxis) -> None:
    """Set limits, label, scale and ticks of an axis.

    A logarithmic axis has ticks at 1, 2 and 5 times powers of ten, a long one only at
    powers of ten.
    """
    first, last = family.edges[[0, -1]]
    axis.set_label_text(family.label)
    scale = "log" if family.is_log else "linear"
    if axis is axis.axes.xaxis:
        axis.axes.set(xscale=scale, xlim=(first, last))
    else:
        axis.axes.set(yscale=scale, ylim=(first, last))
    if family.is_log:
        digits: tuple[float, ...] = (1.0,)
        if last < MAX_RATIO_WITH_2_AND_5 * first:
            digits = (1.0, 2.0, 5.0)
        axis.set_major_locator(ticker.LogLocator(subs=digits, numticks=15))
        axis.set_major_formatter(
            ticker.FuncFormatter(lambda value, _: format_factor(value))
        )
        axis.set_minor_formatter(ticker.NullFormatter())
