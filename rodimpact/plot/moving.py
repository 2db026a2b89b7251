"""A moving picture: the row above, its space-time diagram and contact forces growing below it.

Only what moves is drawn anew in each frame, over a picture of all the rest; the future lies under a
cover of the colour of the paper.
"""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from PIL import Image

from ..model.arguments import single
from ..results.placing import placing
from ..results.solution import Solution, check_solution
from .bars import THICKNESS_TOLD, Bars
from .diagram import spacetime
from .film import Film
from .histories import draw_forces, force_scale
from .page import headline
from .polygons import drawn_until
from .scales import Scale, axis_scales, written
from .springs import with_springs
from .style import NORMAL, SMALL, check_choice, colours, dress, legend_above, new_figure, styled

FIELDS = ("velocity", "stress", "strain")
MOST_FRAMES, MOST_PER_SECOND = 10_000, 50
DOTS_PER_INCH = 100
CONTACTS = 5  # shown at most
SAMPLED = 100  # frames by whose largest strain bars swell


class Animation(Film):
    """Frames of a moving picture, drawn when they are asked for; `figure` holds what stands still.

    For the other attributes see `Film`.
    """

    def __init__(
        self, solution: Solution, field: str, times: NDArray[np.float64], fps: float,
        magnification: float | None,
    ) -> None:
        self.times, self.fps, self.title = times, fps, headline(solution)
        self.field, self.colours = field, colours()
        start, stop = float(times[0]), float(times[-1])
        plan = with_springs(placing(solution, start, stop, magnification), times)
        self._time, place = axis_scales(solution, False, stop, plan.row)
        self._bars = Bars(plan, times[:: 1 + times.size // SAMPLED], place)
        self.figure = new_figure(8.4, 6.4)
        self.figure.set_dpi(DOTS_PER_INCH)
        grid = self.figure.add_gridspec(2, 2, height_ratios=(1, 3.6), width_ratios=(3, 1))
        below = self.figure.add_subplot(grid[1, 0])
        picture = spacetime(solution, below, field, start=start, stop=stop,
                            magnification=plan.magnification, coordinates="lab")
        self._norm: Any = picture.regions.norm
        self._factor = picture.scale.factor
        self._row = self.figure.add_subplot(grid[0, 0], sharex=below)
        self._row.set(ylim=(-0.6, 0.6), autoscale_on=False)
        self._row.set_axis_off()
        self._clock = self._words(self.figure.add_subplot(grid[0, 1]), solution, stop)
        growing = [below]
        if solution.outcome.unilateral:
            growing.append(self.figure.add_subplot(grid[1, 1], sharey=below))
            _draw_forces(growing[1], solution, self._time)
        self._covers = [_cover(ax) for ax in growing]
        self._nows: list[Any] = [ax.axhline(start, color=self.colours.ink, linewidth=1.2,
                                            animated=True) for ax in growing]
        self._canvas = cast("Any", FigureCanvasAgg(self.figure))
        self.figure.draw(self._canvas.get_renderer())
        self.figure.set_layout_engine("none")
        self._still = self._canvas.copy_from_bbox(self.figure.bbox)

    def _words(self, ax: Axes, solution: Solution, stop: float) -> Any:
        """Write what the picture shows and how fast; the clock, still empty, is handed back."""
        ax.set_axis_off()
        slowness = (self.times.size - 1) / self.fps / (stop - float(self.times[0]))
        words = [
            *([f"slowed down {_rounded(slowness)} times"] if slowness > 1 else []),
            *([f"first {written(stop, 's')} of {written(solution.t_end, 's')}"]
              if stop < solution.t_end else []),
            f"colour: {self.field}",
            *([f"{self._bars.plan.scale},\nwhich bends fronts"]
              if self._bars.plan.magnification != 1 else []),
            THICKNESS_TOLD,
        ]
        ax.text(0.0, 0.68, "\n".join(words), transform=ax.transAxes, va="top", fontsize=SMALL + 1,
                color=self.colours.ink, linespacing=1.5)
        return ax.text(0.0, 0.75, "", transform=ax.transAxes, va="bottom", fontsize=NORMAL + 4,
                       color=self.colours.ink, animated=True)

    @styled
    def frame(self, number: int) -> NDArray[np.uint8]:  # noqa: D102
        t = float(self.times[number])
        now, end = t * self._time.factor, float(self.times[-1]) * self._time.factor
        self._canvas.restore_region(self._still)
        for cover, line in zip(self._covers, self._nows, strict=True):
            cover.set(y=now, height=end - now)
            line.set_ydata([now, now])
            for artist in (cover, line.axes.spines["left"], line):
                line.axes.draw_artist(artist)
        self._clock.set_text(self.clock(number))
        self._clock.axes.draw_artist(self._clock)
        for artist in self._actors(t):
            self._row.draw_artist(artist)
            artist.remove()
        size = self._canvas.get_width_height()
        drawn = Image.frombuffer("RGBA", size, self._canvas.buffer_rgba(), "raw", "RGBA", 0, 1)
        return np.asarray(drawn.convert("RGB"))

    def _actors(self, t: float) -> list[Artist]:
        """The bodies at a time, in the order in which they are drawn."""
        bars, ax = self._bars, self._row
        bars.at(np.array([t]))
        values = np.array([getattr(piece, self.field) for piece in bars.pieces]) * self._factor
        blocks, faces = bars.walls(ax)
        actors = [*blocks, *faces, bars.rods(ax, values, self._norm), *bars.masses(ax),
                  *bars.ends(ax), bars.outlines(ax), *bars.springs(ax),
                  *bars.contacts(ax)]
        return [actor for actor in actors if actor is not None]

    def clock(self, number: int) -> str:  # noqa: D102
        end = float(self.times[-1]) * self._time.factor
        decimals = max(0, 2 - math.floor(math.log10(end)))
        now = float(self.times[number]) * self._time.factor
        return f"t = {now:.{decimals}f} {self._time.unit}"


@styled
def animation(
    solution: Solution, field: str = "velocity", frames: int = 120, fps: float = 25.0,
    start: float = 0.0, stop: float | None = None, magnification: float | None = None,
) -> Animation:
    """Make a moving picture of a collision; `save` writes it, a notebook plays it.

    Above, the row moves and deforms, with displacements magnified as in `spacetime` and by the
    factor named there; compressed pieces are thicker, stretched ones thinner. Below, the space-time
    diagram grows, and beside it the force of the contacts. They are arranged on a figure of the
    film's own, so it takes no Axes.

    Parameters
    ----------
    solution : Solution
    field : "velocity", "stress" or "strain"
        Tells the colours.
    frames : int
        2 to 10 000 of them, evenly spread from `start` to `stop`.
    fps : float
        Frames a second, 1 to 50.
    start, stop : float
        s; by default the whole solution, or the first half, quarter, ... of one with more than
        20 000 regions of constant state, which is then said in the picture.
    magnification : float, optional
        Of displacements and gaps; by default chosen as in `spacetime`.

    Returns
    -------
    Animation

    Raises
    ------
    ValueError
        For an unknown field, a number of frames or a rate out of range, an empty interval, more
        than 100 000 regions, or a magnification that is not positive.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> film = ri.plot.animation(ri.solve(ri.System([rod, ri.Wall()])), frames=5)
    >>> film.clock(4), film.frame(4).shape
    ('t = 317 µs', (640, 840, 3))
    """
    check_solution(solution)
    check_choice("field", field, FIELDS)
    check_frames(frames, fps)
    start = single("start", start, "s")
    stop = drawn_until(solution) if stop is None else single("stop", stop, "s")
    if not start < stop:
        raise ValueError(f"stop: must be later than start = {start!r} s, got {stop!r}")
    times = np.linspace(start, stop, int(frames))
    return Animation(solution, field, times, float(fps), magnification)


def check_frames(frames: int, fps: float) -> None:
    """Raise ValueError if there cannot be so many frames, or so many a second."""
    count, rate = single("frames", frames, ""), single("fps", fps, "")
    if not 2 <= count <= MOST_FRAMES or count != int(count):
        raise ValueError(f"frames: must be a whole number from 2 to {MOST_FRAMES}, got {frames!r}")
    if not 1 <= rate <= MOST_PER_SECOND:
        raise ValueError(f"fps: must be 1 to {MOST_PER_SECOND} frames a second, got {fps!r}")


def _draw_forces(ax: Axes, solution: Solution, time: Scale) -> None:
    """Forces of the contacts that can open, to the right of the space-time diagram."""
    able = solution.outcome.unilateral
    histories = [solution.contacts[k] for k in able[:CONTACTS]]
    force = force_scale(solution, histories)
    limits = ax.get_ylim()
    drawn = draw_forces(ax, histories, solution.t_end, time, force, up=True)
    ax.set_ylim(limits)
    ax.set_xlim(0, 1.1 * ax.dataLim.xmax or 1.0)
    ax.set_xlabel(force.label)
    dress(ax)
    ax.tick_params(labelleft=False)
    if len(able) > 1:
        more = f"first {CONTACTS} of {len(able)}" if len(able) > CONTACTS else None
        legend_above(ax, drawn, columns=2, size=SMALL, title=more)


def _cover(ax: Axes) -> Rectangle:
    """What hides the future; it is drawn over the Axes, frame by frame."""
    cover = Rectangle((0.0, 0.0), 1.0, 0.0, transform=ax.get_yaxis_transform(), animated=True,
                      facecolor=colours().paper, linewidth=0)
    ax.add_artist(cover)
    return cover


def _rounded(number: float) -> str:
    """A number to two digits, with spaces between thousands."""
    return f"{float(f'{number:.2g}'):,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
