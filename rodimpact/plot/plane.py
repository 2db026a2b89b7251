"""The axes of a space-time diagram: which way time runs, and ticks where the lengths of rods count.

In material coordinates the axis of places has a tick at both ends of every rod, and its length
between them. The axis of time has a tick at each instant at which a force ends or a gap opens after
whole round trips of a wave, such as 2 l1/c.
"""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import AutoLocator
from numpy.typing import ArrayLike

from ..methods.signals import Floats
from ..model import Rod
from ..model.numbering import body_names
from .moments import length_name, round_trips
from .placing import Placing
from .scales import Scale, digits, place_label
from .style import LETTER, NORMAL, broken, dress, extent


class Plane(NamedTuple):
    """Axes of a space-time diagram.

    Attributes
    ----------
    ax : Axes
    plan : Placing
        Of the row.
    time, place : Scale
    span : (float, float)
        Interval of time, s.
    across : bool
        Whether time runs to the right and places lie upward, instead of the other way round.
    """

    ax: Axes
    plan: Placing
    time: Scale
    place: Scale
    span: tuple[float, float]
    across: bool

    def points(self, places: Floats, times: Floats) -> Floats:
        """Points [..., 2] of the picture, from places, m, and times, s."""
        both = np.broadcast_arrays(places * self.place.factor, times * self.time.factor)
        return np.stack(both[::-1] if self.across else both, axis=-1)

    def path(self, body: int, x: ArrayLike, times: Floats) -> Floats:
        """Points of a place in a body, m from its left end, at times, s."""
        return self.points(self.plan.point(body, x, times), times)

    def dress(self) -> None:
        """Limits, labels and ticks of the Axes."""
        ax, plan = self.ax, self.plan
        dress(ax)
        ax.use_sticky_edges = False
        ax.margins(*(0.0, 0.02) if self.across else (0.02, 0.0))
        ax.autoscale_view()
        times, places = (ax.xaxis, ax.yaxis) if self.across else (ax.yaxis, ax.xaxis)
        along, length = (
            extent(ax) if self.across else extent(ax)[::-1]
        )  # of time, of places
        times.set_label_text(self.time.label)
        places.set_label_text(broken(place_label(plan, self.place), length))
        low, high = (t * self.time.factor for t in self.span)
        (ax.set_xlim if self.across else ax.set_ylim)(low, high)
        marks = {
            t * self.time.factor: name
            for t, name in round_trips(plan.solution).items()
            if self.span[0] < t <= self.span[1]
        }
        if marks:
            least = (3.0 if self.across else 1.3) * NORMAL * (high - low) / along
            numbers = [
                x
                for x in AutoLocator().tick_values(low, high)
                if low <= x <= high and all(abs(x - mark) > least for mark in marks)
            ]
            times.set_ticks(
                [*numbers, *marks],
                labels=[*(digits(x, high) for x in numbers), *marks.values()],
            )
        per_point = np.ptp(places.get_view_interval()) / length
        least = (1.5 if self.across else 5 * LETTER) * NORMAL * per_point
        system, names = plan.solution.system, body_names(plan.solution.system.kinds)
        ends = {
            i: [
                float(plan.end(i, right, self.span[0])) * self.place.factor
                for right in (False, True)
            ]
            for i, body in enumerate(system.bodies)
            if isinstance(body, Rod)
        }
        wide = {
            i: (left + right) / 2
            for i, (left, right) in ends.items()
            if right - left > least
        }
        words = [
            names[i] if plan.magnification else f"{length_name(system, i)}\n{names[i]}"
            for i in wide
        ]
        if not plan.magnification:
            # a mass between rods widens the picture; the numbers are the material coordinates
            numbers_at: dict[float, float] = {}
            for i, both in ends.items():
                for x, coordinate in zip(both, plan.material(i), strict=True):
                    if not numbers_at or x - max(numbers_at) > least:
                        numbers_at[x] = coordinate * self.place.factor
            last = max(numbers_at.values())
            places.set_ticks(
                list(numbers_at), labels=[digits(x, last) for x in numbers_at.values()]
            )
        elif not self.across:
            words = [f"\n{word}" for word in words]
        places.set_ticks(list(wide.values()), labels=words, minor=True)
        places.set_tick_params(which="minor", length=0)
