"""What a sweep reads of each member beside its outcome: gauges, times, and further columns."""

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


class Readings(NamedTuple):
    """What is read of each member beside its outcome.

    Attributes
    ----------
    gauges : tuple of (int, float)
        Strain gauges: body, and place in m from its left end.
    times : [time] array
        When the gauges are read, s.
    also : tuple of str
        Names of `ALSO`.
    """

    gauges: tuple[tuple[int, float], ...] = ()
    times: Any = np.zeros(0)
    also: tuple[str, ...] = ()


def check_readings(
    problems: Problems, system: System, gauges: Any, times: Any
) -> Readings:
    """Check gauges and the times at which they are read; note mistakes."""
    is_list = isinstance(gauges, Sequence | np.ndarray)
    if not is_list or getattr(gauges, "ndim", 1) == 0:
        problems.append(("gauges", f"must be [(body, x), ...], got {shown(gauges)}"))
        return Readings()
    if (times is None) == bool(len(gauges)):
        problems.append(
            ("times", "go with gauges=[(body, x), ...]; give both or neither")
        )
    if times is None or not len(gauges):
        return Readings()
    places = []
    for i, gauge in enumerate(gauges):
        place = _check_gauge(problems, system, f"gauges.{i}", gauge)
        if place is not None:
            places.append(place)
    instants: Any = TIMES.checked(problems, "times", times)
    if np.ndim(instants) != 1:
        problems.append(("times", f"must be a list of times, got {shown(times)}"))
    return Readings(tuple(places), instants)


def _check_gauge(
    problems: Problems, system: System, path: str, gauge: Any
) -> tuple[int, float] | None:
    """Body and place of a gauge; None and a problem where it lies in no rod."""
    try:
        body, x = gauge
    except (TypeError, ValueError):
        problems.append(
            (path, f"must be (body, x), such as (1, 0.5), got {shown(gauge)}")
        )
        return None
    x = GAUGE_PLACE.checked(problems, f"{path}.x", x)
    lengths = {}
    for index, each in enumerate(system.bodies):
        if isinstance(each, Rod):
            lengths[index] = each.length
    if not is_integer(body) or body not in lengths:
        rods = ", ".join(map(str, lengths))
        problems.append((f"{path}.body", f"must be a rod, {rods}; got {shown(body)}"))
        return None
    shortest = float(np.min(lengths[int(body)]))
    if np.all(x > shortest):
        message = (
            f"must lie in body {body} of every member, 0 to {shortest!r} m, got {x!r}"
        )
        problems.append((f"{path}.x", message))
        return None
    return int(body), x


def check_also(problems: Problems, names: Any, until: float | None) -> tuple[str, ...]:
    """Check the names of further columns; note mistakes."""
    known = ", ".join(f'"{name}"' for name in ALSO)
    if isinstance(names, str | bytes) or not isinstance(names, Sequence):
        problems.append(("also", f"must be a list of {known}, got {shown(names)}"))
        return ()
    for name in names:
        if not isinstance(name, str) or name not in ALSO:
            problems.append(("also", f"must be of {known}, got {shown(name)}"))
    if "displacement" in names and until is None:
        message = "a body that flies on has no last displacement; give the time (until)"
        problems.append(("also", message))
    return tuple(name for name in ALSO if name in names)
