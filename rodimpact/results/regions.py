"""The exact picture of a solution: polygons of constant state in the (x, t) plane.

The two families of fronts cut each segment's strip of the plane into regions in which
velocity and strain are constant. Plots, page and animation draw these polygons.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing
from ..methods.signals import Floats, Ints
from ..model import Segment
from ..model.arguments import UNCHECKED, demand, scalar
from ..model.frozen import invalid_argument
from .front_polygons import count_of_regions, polygons_of, wave_of
from .segment_waves import SegmentWaves
from .solution import Solution, check_solution
from .wave_fields import WaveFields


class Interval(NamedTuple):
    """An interval of time."""

    first_tick: int
    last_tick: int


@explain_missing()
@dataclass(frozen=True)
class Regions:
    """Polygons of constant state, ordered by body and segment.

    Attributes
    ----------
    body, segment : [n] int
        Body (including walls) and segment of this body.
    velocity, strain, stress : [n]
        m/s, 1, Pa.
    start : [n + 1] int
        Polygon i has the vertices start[i] to start[i + 1].
    x, t, displacement : [vertices]
        m from the left end of the body, s, and m.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> regions = ri.regions_of(ri.solve(ri.System([left, right])), stop=1e-5)
    >>> regions.body.tolist(), regions.velocity.round(12).tolist()
    ([0, 0, 1, 1], [1.0, 0.5, 0.0, 0.5])
    """

    body: Ints
    segment: Ints
    velocity: Floats
    strain: Floats
    stress: Floats
    start: Ints
    x: Floats
    t: Floats
    displacement: Floats

    def __len__(self) -> int:
        return len(self.body)

    def body_of_vertices(self) -> Ints:
        """Index of the body to which each vertex belongs, [vertices]."""
        return np.repeat(self.body, np.diff(self.start))


@explain_arguments
def regions_of(
    solution: Solution,
    start: float = 0.0,
    stop: float | None = None,
    limit: float = 100_000,
) -> Regions:
    """Cut the (x, t) plane of every rod into regions of constant state.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        Interval of time, s; by default the whole solution.
    limit : float
        Largest allowed number of regions, 1 or more; ``math.inf`` for no limit.

    Returns
    -------
    Regions

    Raises
    ------
    ValueError
        If there are more regions than `limit`, the limit is below 1, the interval is
        empty or outside the solution, or the method has no fronts.

    Examples
    --------
    Before the first wave comes back there are two regions in each rod:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> regions = ri.regions_of(ri.solve(ri.System([left, right])), stop=1e-5)
    >>> sorted(regions.velocity.round(12).tolist())
    [0.0, 0.5, 0.5, 1.0]
    """
    check_solution(solution)
    fields = _constant_fields(solution)
    if stop is None:
        stop = solution.t_end
    first_tick, last_tick = _interval(fields, start, stop)
    limit = scalar("limit", limit, unit="", sign=UNCHECKED)
    demand(limit >= 1, "limit", "must be 1 or more, got {0:g}", limit)
    rods = _rods(fields)
    if count_of_regions(rods, first_tick, last_tick, limit) > limit:
        message = f"more than {limit:.15g} regions; choose a shorter interval"
        raise invalid_argument("limit", message)
    clock = fields.clock
    frame_velocity = clock.frame
    polygons = polygons_of(rods, clock.tick, frame_velocity, first_tick, last_tick)
    arrays = {}
    for name, values in polygons.items():
        arrays[name] = np.array(values)
    return Regions(**arrays)


def nothing_to_draw(solution: Solution) -> str:
    """Reason why there is no picture of a solution, a sentence; "" if there is one.

    There is no picture if the run ended at t = 0; then the text includes its status.
    """
    if solution.fields.end > 0:
        return ""
    ended = f"the run ended at {solution.t_end:.3g} s. {solution.status}"
    return f"there is nothing to draw, {ended}"


def readable_until(solution: Solution, limit: int) -> float:
    """Time, s, from t = 0 up to which there are at most `limit` regions.

    The result is the first of the times t_end, t_end/2, t_end/4 ... with this property.

    Raises
    ------
    ValueError
        If there are more at all these times, the solution lasts no time, or the method
        has no fronts.
    """
    fields = _constant_fields(solution)
    stop = solution.t_end
    _, last_tick = _interval(fields, 0.0, stop)  # from t = 0; raises without duration
    rods = _rods(fields)
    while last_tick > 0 and count_of_regions(rods, 0, last_tick, limit) > limit:
        stop /= 2
        last_tick = int(fields.to_ticks(stop))
    if last_tick == 0:
        message = (
            f"has more than {limit} regions of constant state at the start, too many "
            "for a picture; describe the row in fewer pieces"
        )
        raise invalid_argument("solution", message)
    return stop


def _constant_fields(solution: Solution) -> WaveFields:
    """Fields of a solution if they are constant between fronts; else InvalidModel."""
    fields = solution.fields
    if not isinstance(fields, WaveFields) or not fields.constant_between_fronts:
        message = f'method "{solution.method}" has no fronts to draw between'
        raise invalid_argument("solution", message)
    return fields


def _interval(fields: WaveFields, start: float, stop: float) -> Interval:
    """First and last tick of the interval between two times, s.

    InvalidModel if `stop` is not at least a tick later than `start`, or if a time is
    not a number. ValueError for times outside the solution.
    """
    start_time = scalar("start", start, "s", sign=UNCHECKED)
    stop_time = scalar("stop", stop, "s", sign=UNCHECKED)
    first_tick = int(fields.to_ticks(start_time))
    last_tick = int(fields.to_ticks(stop_time))
    message = f"must be later than start = {start!r} s, got {stop!r}"
    demand(last_tick > first_tick, "stop", message)
    return Interval(first_tick, last_tick)


def _rods(fields: WaveFields) -> list[dict[str, Any]]:
    """The rods with their waves, as `polygons_of` takes them.

    Each is a dictionary of ``body``, the index of the rod, and ``pieces``, its segments
    from left to right as `_piece` makes them.
    """
    rods = []
    for body, rod in fields.rods.items():
        pieces = []
        for waves, segment in zip(fields.waves_along(body), rod.segments, strict=True):
            pieces.append(_piece(waves, segment))
        rods.append({"body": body, "pieces": pieces})
    return rods


def _piece(waves: SegmentWaves, segment: Segment) -> dict[str, Any]:
    """A segment with its waves as a dictionary that `polygons_of` takes.

    It has the transit time in ticks, length, wave speed, Young's modulus, and the waves
    ``rightward`` and ``leftward``, each as lists of its ticks, values and integral, see
    `wave_of`.
    """
    rightward = waves.rightward
    leftward = waves.leftward
    return {
        "ticks": waves.transit,  # for a wave from end to end
        "length": waves.length,
        "wave_speed": waves.wave_speed,
        "youngs_modulus": float(segment.material.youngs_modulus),
        "rightward": wave_of(rightward.ticks.tolist(), rightward.values.tolist()),
        "leftward": wave_of(leftward.ticks.tolist(), leftward.values.tolist()),
    }
