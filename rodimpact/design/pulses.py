"""Pulses of a design: the wanted one, the one that is reached, and their difference.

A pulse is a `Signal`: straight between samples. At a jump it has two samples, as near
to each other as floats are. Every integral here is exact: Gauss's two points integrate
the cubic in each interval without a kink.
"""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_missing
from ..model import System
from ..model.frozen import invalid_argument
from ..model.profiles import Steps
from ..model.quantities import Floats
from ..records.signal import Signal
from ..results.notebook import Shown
from ..storage.tables import align
from ..units import format_si, shown

MIN_DURATION_RTOL = 2.0**-40
"""A shorter part of a pulse comes from round-off of its times."""


@explain_missing("system")
@dataclass(frozen=True)
class PulseDesign(Shown):
    """A body that was designed for a pulse.

    Attributes
    ----------
    system : System
        The row with the body.
    body : int
        Index of the body in the row.
    wanted, reached : Signal
        Force over time, N, positive in compression. `reached` is the exact force of the
        system.
    misfit : float
        Root mean square of `reached` - `wanted` over the peak. For a striker the mean
        ends with `wanted`. For a trap it begins when the wanted force becomes 0.
    staircase : float
        Part of the misfit that no choice of areas can remove, because the force of a
        stepped striker is constant within each step. 0 without steps.
    bounded : dict of int to str
        ``"smallest"`` or ``"largest"`` for each segment whose area is at the lower or
        upper limit of `area_ratio`.

    Examples
    --------
    A uniform striker gives a constant force for 80 us:

    >>> import numpy as np, rodimpact as ri
    >>> bar = ri.Rod(2.0, area=1e-4, material=ri.materials.steel)
    >>> force = bar.segments[0].impedance * 10.0 / 2
    >>> wanted = ri.Signal([force, force], [0.0, 80e-6], unit="N")
    >>> design = ri.design.striker(wanted, bar, velocity=10.0, duration=80e-6,
    ...                            segments=1)
    >>> striker = design.system.bodies[design.body]
    >>> round(striker.segments[0].area * 1e4, 6)
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
        """The misfit as a text, in per cent of the peak."""
        return f"{100 * self.misfit:.3g} %"

    def __str__(self) -> str:
        """Tables of segments, gap and misfit; a note follows if areas are at limits."""
        tables = [self._table_of_segments(), self._table_of_facts()]
        blocks = list(map(align, tables))
        if self.bounded:
            rod: Any = self.system.bodies[self.body]
            blocks.append(
                f"{len(self.bounded)} of {len(rod.segments)} areas are at a limit of "
                "area_ratio. The wanted force may be out of reach; another velocity or "
                "wider limits may bring the pulse nearer to it."
            )
        return "\n\n".join(blocks)

    def _table_of_segments(self) -> list[list[str]]:
        """Rows of the table of segments, header first: length, area, diameter.

        If areas are at limits, a last column says "smallest" or "largest".
        """
        rod: Any = self.system.bodies[self.body]
        header = ["segment", "length", "area", "diameter if round"]
        if self.bounded:
            header.append("limit")
        rows = [header]
        for i, segment in enumerate(rod.segments):
            length = float(segment.length)
            area = float(segment.area)
            diameter = math.sqrt(4 * area / math.pi)
            row = [str(i)]
            row.append(format_si(length, "m"))
            row.append(format_si(area, "m^2"))
            row.append(format_si(diameter, "m"))
            if self.bounded:
                row.append(self.bounded.get(i, ""))
            rows.append(row)
        return rows

    def _table_of_facts(self) -> list[list[str]]:
        """Rows of the gap on the left of the body, if it is not body 0, and misfit."""
        rows = []
        if self.body > 0:
            gap = float(self.system.gaps[self.body - 1])
            rows.append(["gap before it", format_si(gap, "m")])
        rows.append(["misfit, of the peak", self.percent])
        return rows


def staircase(times: Any, values: Any, end: float, name: str) -> Signal:
    """Signal of forces, N: each acts from its time, s, to the next, the last to `end`.

    Parts that begin after the end, or are so short that they come from round-off, are
    left out. Each other part has two samples: one at its start, and one just before the
    next start, so that the force jumps there.
    """
    starts = np.asarray(times, float)
    forces = np.asarray(values, float)
    edges = np.minimum(np.append(starts, end), end)
    shortest = MIN_DURATION_RTOL * end
    is_kept = np.diff(edges) > shortest
    starts = starts[is_kept]
    forces = forces[is_kept]
    next_starts = np.append(starts[1:], end)
    ends = np.nextafter(next_starts, -np.inf)
    limits = np.column_stack([starts, ends])
    sample_times = limits.ravel()
    samples = np.repeat(forces, 2)
    return Signal(samples, sample_times, unit="N", name=name)


def no_force(end: float) -> Signal:
    """A force of 0 N until `end`, s."""
    return staircase([0.0], [0.0], end, "nothing")


def force_over_time(wanted: object, end: float) -> Signal:
    """The wanted force from 0 to `end`, s, as a signal in N.

    `wanted` is `Steps` of numbers, or a `Signal` in N, which is 0 outside its record.
    The force jumps between steps, and at both ends of a record.

    Raises
    ------
    InvalidModel
        If `wanted` is anything else, such as `Steps` of arrays.
    """
    if isinstance(wanted, Steps) and not _is_family(wanted):
        starts = [0.0, *wanted.at]
        return staircase(starts, wanted.values, end, "wanted")
    if not isinstance(wanted, Signal) or wanted.unit != "N":
        example = "Signal(values, dt=1e-6, unit='N') or Steps"
        raise invalid_argument(
            "wanted", f"must be a force over time, {example}, got {shown(wanted)}"
        )
    # the force is 0 before and after the record, with jumps at both ends
    before = np.nextafter(wanted.start, -np.inf)
    after = np.nextafter(wanted.end, np.inf)
    times = np.unique([0.0, end, before, *wanted.times, after])
    times = _between(times, 0.0, end)
    values = np.interp(times, wanted.times, wanted.values, left=0.0, right=0.0)
    return Signal(values, times, unit="N", name="wanted")


def _is_family(steps: Steps) -> bool:
    """Whether any number of a profile is an array."""
    numbers = (*steps.values, *steps.at)
    return any(map(np.ndim, numbers))


def _between(times: Floats, start: float, end: float) -> Floats:
    """Times from `start` to `end`."""
    return times[(times >= start) & (times <= end)]


class StepDifferences(NamedTuple):
    """Difference of two pulses in intervals of time; [interval] arrays."""

    mean: Floats  # N
    variance: Floats  # about the mean, N^2


def differences(wanted: Signal, reached: Signal, edges: Floats) -> StepDifferences:
    """Mean and variance of reached - wanted in each of the intervals between edges, s.

    The integrals are exact: Gauss's two points, at half a duration over sqrt(3) from
    the middle, are taken in each part between two kinks of the pulses. Very short
    parts, which come from round-off, are left out.
    """
    times = np.concatenate([edges, wanted.times, reached.times])
    end = edges[-1]
    times = _between(times, edges[0], end)
    kinks = np.unique(times)
    durations = np.diff(kinks)
    is_long = durations > MIN_DURATION_RTOL * end
    starts = kinks[:-1]
    ends = kinks[1:]
    middles = (starts + ends)[is_long] / 2
    half_durations = durations[is_long] / 2
    offsets = half_durations / math.sqrt(3)
    earlier = middles - offsets
    later = middles + offsets
    gauss_points = np.column_stack([earlier, later])
    reached_force = np.interp(gauss_points, reached.times, reached.values)
    wanted_force = np.interp(gauss_points, wanted.times, wanted.values)
    difference = reached_force - wanted_force
    # Interval of each part: the number of inner edges to the left of its middle.
    interval = np.searchsorted(edges[1:-1], middles, "right")
    n_intervals = len(edges) - 1

    def mean(values: Floats) -> Floats:
        """Mean over each interval, from values at Gauss's points."""
        integrals = half_durations * values.sum(axis=1)  # both points have weight 1
        sums = np.bincount(interval, integrals, n_intervals)
        return sums / np.diff(edges)

    means = mean(difference)
    deviation = difference - means[interval, None]
    variances = mean(deviation**2)
    return StepDifferences(means, variances)
