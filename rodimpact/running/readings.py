"""Readings that a sweep takes of each member, in addition to its outcome.

They are strains at gauges at given times, and further columns.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..methods.run import ALSO
from ..model import Rod, System
from ..model.frozen import Problems, QuantityField, quantity
from ..model.quantities import is_integer
from ..units import shown

GAUGE_PLACE = quantity("m", "non-negative", scalar=True)
TIMES = QuantityField("s", "non-negative")


class RequestedReadings(NamedTuple):
    """Readings that `sweep` takes of each member, in addition to its outcome.

    Attributes
    ----------
    gauges : tuple of (int, float)
        Strain gauges: index of the body, and distance from its left end, m.
    times : [time] array
        Times at which the gauges are read, s.
    also : tuple of str
        Names of further columns, of `ALSO`.
    """

    gauges: tuple[tuple[int, float], ...] = ()
    times: Any = np.zeros(0)
    also: tuple[str, ...] = ()


def check_readings(
    problems: Problems, system: System, gauges: Any, times: Any
) -> RequestedReadings:
    """Check the arguments `gauges` and `times` of `sweep`, and return them as readings.

    Mistakes are added to `problems`. The readings are empty if neither argument is
    given, if only one is given (a mistake), or if `gauges` is not a sequence (another
    mistake). Gauges that `_check_gauge` refuses are left out. Further columns stay
    empty: `check_also` reads them.
    """
    is_sequence = isinstance(gauges, Sequence | np.ndarray)
    # An array of ndim 0 is a single number; other sequences have no attribute ndim.
    has_items = getattr(gauges, "ndim", 1) > 0
    if not is_sequence or not has_items:
        message = f"must be [(body, x), ...], got {shown(gauges)}"
        problems.append(("gauges", message))
        return RequestedReadings()
    has_gauges = len(gauges) > 0
    has_times = times is not None
    if has_gauges != has_times:
        message = "go with gauges=[(body, x), ...]; give both or neither"
        problems.append(("times", message))
    if not has_gauges or not has_times:
        return RequestedReadings()
    checked_gauges = []
    for i, gauge in enumerate(gauges):
        checked = _check_gauge(problems, system, f"gauges.{i}", gauge)
        if checked is not None:
            checked_gauges.append(checked)
    checked_times: Any = TIMES.checked(problems, "times", times)
    if np.ndim(checked_times) != 1:
        message = f"must be a list of times, got {shown(times)}"
        problems.append(("times", message))
    return RequestedReadings(tuple(checked_gauges), checked_times)


def _check_gauge(
    problems: Problems, system: System, path: str, gauge: Any
) -> tuple[int, float] | None:
    """Index of the body of a gauge, and its distance x from the left end, m.

    `gauge` must be such a pair, and must lie in a rod of every member; if not, a
    problem is added, and the result is None. An x that is negative or not a number is a
    problem, too, but the pair is returned.
    """
    try:
        body, x = gauge
    except (TypeError, ValueError):
        message = f"must be (body, x), such as (1, 0.5), got {shown(gauge)}"
        problems.append((path, message))
        return None
    x = GAUGE_PLACE.checked(problems, f"{path}.x", x)
    lengths = {}  # lengths of the rods, by their index in the row
    for index, member in enumerate(system.bodies):
        if isinstance(member, Rod):
            lengths[index] = member.length
    if not is_integer(body) or body not in lengths:
        rods = ", ".join(map(str, lengths))  # their indices
        message = f"must be a rod, {rods}; got {shown(body)}"
        problems.append((f"{path}.body", message))
        return None
    shortest = float(np.min(lengths[int(body)]))  # shortest length of all members
    if np.all(x > shortest):  # x may be an array, which is a problem already
        message = (
            f"must lie in body {body} of every member, 0 to {shortest!r} m, got {x!r}"
        )
        problems.append((f"{path}.x", message))
        return None
    return int(body), x


def check_also(problems: Problems, names: Any, until: float | None) -> tuple[str, ...]:
    """Check the argument `also` of `sweep`, and return its known names.

    Each name is returned once, in the order of `ALSO`. Mistakes are added to
    `problems`: unknown names, "displacement" without `until`, and anything that is not
    a list; in the last case the result is ().
    """
    choices = ", ".join(f'"{name}"' for name in ALSO)
    is_text = isinstance(names, str | bytes)
    is_list = isinstance(names, Sequence) and not is_text
    if not is_list:
        message = f"must be a list of {choices}, got {shown(names)}"
        problems.append(("also", message))
        return ()
    for name in names:
        if not isinstance(name, str) or name not in ALSO:
            message = f"must be of {choices}, got {shown(name)}"
            problems.append(("also", message))
    if "displacement" in names and until is None:
        message = "a body that flies on has no last displacement; give the time (until)"
        problems.append(("also", message))
    return tuple(name for name in ALSO if name in names)
