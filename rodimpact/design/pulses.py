"""A pulse that was wanted and the one that a design reaches, and how far they are apart.

A pulse is a `Signal`: straight between samples. One of jumps has two samples at each, as near to
each other as floats are. Every integral here is exact: that of a cubic, by Gauss's two points in
each stretch without a kink.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..model import Rod, System
from ..model.frozen import refusal
from ..model.profiles import Steps
from ..model.quantities import Floats
from ..records.signal import Signal
from ..results.notebook import Shown
from ..storage.tables import align
from ..units import format_si, shown

INSTANT = 2.0**-40  # of a pulse: what is shorter is round-off of its times


@dataclass(frozen=True)
class PulseDesign(Shown):
    """A body that was designed for a pulse.

    Attributes
    ----------
    system : System
        The row with it.
    body : int
        Which of the row it is.
    wanted, reached : Signal
        Force over time, N, positive in compression; `reached` is exact for the system.
    misfit : float
        Root of the mean square of their difference over the peak: for a striker until the end of
        `wanted`, for a trap from when on nothing is wanted.
    staircase : float
        The part of the misfit by what the difference varies within steps: a striker of such steps
        leaves it whatever its areas. 0 without steps.
    bounded : dict of int to str
        ``"smallest"`` or ``"largest"`` for each segment whose area is the smallest or the largest
        that was allowed.

    Examples
    --------
    A constant force for 80 us asks for a uniform striker:

    >>> import numpy as np, rodimpact as ri
    >>> bar = ri.Rod(2.0, area=1e-4, material=ri.materials.steel)
    >>> force = bar.segments[0].impedance * 10.0 / 2
    >>> wanted = ri.Signal([force, force], [0.0, 80e-6], unit="N")
    >>> found = ri.design.striker(wanted, bar, velocity=10.0, duration=80e-6, segments=1)
    >>> round(found.system.bodies[found.body].segments[0].area * 1e4, 6)
    1.0
    """

    system: System
    body: int
    wanted: Signal
    reached: Signal
    misfit: float
    staircase: float
    bounded: dict[int, str] = field(default_factory=dict)

    @property
    def percent(self) -> str:
        """The misfit as it is shown."""
        return f"{100 * self.misfit:.3g} %"

    def __str__(self) -> str:
        rod = self.system.bodies[self.body]
        assert isinstance(rod, Rod)
        rows = [["segment", "length", "area", "diameter if round", "limit"]]
        for i, piece in enumerate(rod.segments):
            area = float(piece.area)  # type: ignore[arg-type]
            diameter = math.sqrt(4 * area / math.pi)
            rows.append(
                [
                    str(i),
                    format_si(float(piece.length), "m"),
                    format_si(area, "m^2"),
                    format_si(diameter, "m"),
                    self.bounded.get(i, ""),
                ]
            )
        facts = [["misfit, of the peak", self.percent]]
        if self.body:
            facts[:0] = [
                [
                    "gap before it",
                    format_si(float(self.system.gaps[self.body - 1]), "m"),
                ]
            ]
        blocks = [
            align(rows if self.bounded else [row[:-1] for row in rows]),
            align(facts),
        ]
        if self.bounded:
            blocks.append(
                f"{len(self.bounded)} of {len(rod.segments)} areas are at a limit of area_ratio. "
                "The wanted force may be out of reach; another velocity or wider limits may bring "
                "the pulse nearer to it."
            )
        return "\n\n".join(blocks)


def staircase(times: Any, values: Any, end: float, name: str) -> Signal:
    """Forces, N, that hold from each time, s, to the next, and to the end."""
    t, v = np.asarray(times, float), np.asarray(values, float)
    lasting = np.diff(np.minimum(np.append(t, end), end)) > INSTANT * end
    t, v = t[lasting], v[lasting]
    both = np.column_stack([t, np.nextafter(np.append(t[1:], end), -np.inf)])
    return Signal(np.repeat(v, 2), both.ravel(), unit="N", name=name)


def force_over_time(given: object, end: float) -> Signal:
    """The wanted force, N, until `end`, s; ValueError if it is none."""
    if isinstance(given, Steps) and not any(map(np.ndim, (*given.values, *given.at))):
        return staircase([0.0, *given.at], given.values, end, "wanted")
    if not isinstance(given, Signal) or given.unit != "N":
        example = "Signal(values, dt=1e-6, unit='N') or Steps"
        raise refusal(
            "wanted", f"must be a force over time, {example}, got {shown(given)}"
        )
    outside = np.nextafter([given.start, given.end], [-np.inf, np.inf])
    times = np.unique(np.concatenate([[0.0, end], outside, given.times]))
    times = times[(times >= 0) & (times <= end)]
    values = np.interp(times, given.times, given.values, left=0.0, right=0.0)
    return Signal(values, times, unit="N", name="wanted")


def differences(
    wanted: Signal, reached: Signal, edges: Floats
) -> tuple[Floats, Floats]:
    """Mean difference reached - wanted between edges, s, and its variance there."""
    kinks = np.concatenate([edges, wanted.times, reached.times])
    kinks = np.unique(kinks[(kinks >= edges[0]) & (kinks <= edges[-1])])
    lasting = np.diff(kinks) > INSTANT * edges[-1]
    middle, half = (
        ((kinks[1:] + kinks[:-1]) / 2)[lasting],
        (np.diff(kinks) / 2)[lasting],
    )
    points = np.column_stack(
        [middle - half / math.sqrt(3), middle + half / math.sqrt(3)]
    )
    difference = np.interp(points, reached.times, reached.values) - np.interp(
        points, wanted.times, wanted.values
    )
    place = np.searchsorted(edges[1:-1], middle, "right")

    def mean(values: Floats) -> Floats:
        return np.bincount(place, half * values.sum(axis=1), len(edges) - 1) / np.diff(
            edges
        )

    first = mean(difference)
    return first, mean((difference - first[place, None]) ** 2)
