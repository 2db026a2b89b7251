"""The plane of a space-time diagram: units of its axes, and which way time runs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ..methods.signals import Floats
from .scales import Scale
from .style import broken


class Plane(NamedTuple):
    """Axes of a space-time diagram.

    Attributes
    ----------
    time, place : Scale
    span : (float, float)
        Interval of time, s.
    across : bool
        Whether time runs to the right and places lie upward, instead of the other way round.
    """

    time: Scale
    place: Scale
    span: tuple[float, float]
    across: bool

    def points(self, places: Floats, times: Floats) -> Floats:
        """Points [..., 2] of the picture, from places, m, and times, s."""
        both = (places * self.place.factor, times * self.time.factor)
        return np.stack(both[::-1] if self.across else both, axis=-1)

    def dress(self, ax: Axes, places: str) -> None:
        """Limits and labels of the Axes; `places` is the label of places."""
        start, stop = (t * self.time.factor for t in self.span)
        ax.use_sticky_edges = False
        ax.autoscale_view()
        if self.across:
            ax.margins(x=0, y=0.02)
            ax.set_xlim(start, stop)
            ax.set_xlabel(self.time.label)
            ax.set_ylabel(broken(places, ax.get_window_extent().height))
        else:
            ax.margins(x=0.02, y=0)
            ax.set_ylim(start, stop)
            ax.set_ylabel(self.time.label)
            ax.set_xlabel(broken(places, ax.get_window_extent().width))
