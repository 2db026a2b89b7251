"""Animation: the row above, its growing space-time diagram and contact forces below.

It begins before the contact and names the events at contacts. The
Axes of bodies and words are drawn again in each frame, over a picture of the others at the end of
the film, whose later times get the colour of the paper.
"""

import io
import math
import os
from collections.abc import Iterator
from contextvars import copy_context
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model.arguments import one_of, single
from ..model.frozen import Problems, raise_noted, refusal
from ..progress import (
    Progress,
    ProgressFunction,
    Report,
    check_progress,
    no_report,
)
from ..results.solution import Solution, check_waves
from ..storage import writing
from . import files, style
from .bars import TOLD, Bars
from .diagram import spacetime
from .histories import Forces
from .moments import contact_turns, happening
from .page import headline
from .placing import Placing, placing
from .polygons import drawn_until
from .scales import axis_scales, signed, written

MOST_FRAMES, MOST_PER_SECOND = 10_000, 50
DOTS_PER_INCH = 100
CONTACTS = 5  # shown at most
SAMPLED = 100  # frames by whose largest strain bars swell
APPROACH = 0.2  # largest share of the frames before contact
APPROACH_WAY = 0.12  # largest part of the row that closes before contact


class Animation:
    """Frames of an animation, drawn when they are needed; `figure` holds the artists at rest.

    Attributes
    ----------
    times : array
        s; one for each frame.
    fps : float
        Frames a second.
    title : str
    colours : Colours
        Of paper and lines.
    """

    def __init__(
        self,
        plan: Placing,
        field: str,
        times: Floats,
        fps: float,
    ) -> None:
        solution = plan.solution
        self.fps = fps
        self.title = headline(solution)
        self._look = copy_context()
        self.field = field
        self.colours = style.colours()
        self.times = times
        times = times[np.searchsorted(times, 0.0) :]  # without the approach
        start = float(times[0])
        stop = float(times[-1])
        # times at which something happens at contacts, and what to read before and after each
        self._turns = sorted({t for t in contact_turns(solution) if start <= t <= stop})
        self._captions = ["before contact" if start == 0 and self._turns else ""]
        for t in self._turns:
            lines = [f"{written(t, 's')}:", *happening(solution, t).splitlines()]
            self._captions.append("\n".join(lines[:3]) + ", ..." * (len(lines) > 3))
        self._time, place = axis_scales(solution, False, stop, plan.row)
        self.figure = style.new_figure(8.4, 6.8)
        self.figure.suptitle(
            style.broken(self.title, 72 * self.figure.get_figwidth()),
            fontsize=style.NORMAL + 1,
        )
        self.figure.set_dpi(DOTS_PER_INCH)
        grid = self.figure.add_gridspec(
            2, 2, height_ratios=(1.2, 3.6), width_ratios=(3, 1)
        )
        below = self.figure.add_subplot(grid[1, 0])
        picture = spacetime(
            solution,
            below,
            field,
            start=start,
            stop=stop,
            magnification=plan.magnification,
            coordinates="lab",
        )
        self._norm: Any = picture.regions.norm
        self._factor = picture.scale.factor
        self._row = self.figure.add_subplot(grid[0, 0], sharex=below, animated=True)
        self._row.set(ylim=(-0.6, 0.6), autoscale_on=False)
        self._row.set_axis_off()
        self._bars = Bars(self._row, plan, times[:: 1 + times.size // SAMPLED], place)
        first = [
            float(plan.end(i, False, self.times[0])) for i in range(len(plan.left))
        ]
        below.set_xlim(
            left=min(below.get_xlim()[0], (min(first) - 0.02 * plan.row) * place.factor)
        )
        self._words = self.figure.add_subplot(grid[0, 1], animated=True)
        self._clock, self._caption = self._write(solution, times)
        self._growing = [below]
        if solution.outcome.unilateral:
            self._growing.append(self.figure.add_subplot(grid[1, 1], sharey=below))
            _draw_forces(self._growing[1], solution)
        self._canvas = cast("Any", FigureCanvasAgg(self.figure))
        self.figure.draw(self._canvas.get_renderer())
        self.figure.set_layout_engine("none")
        self._still = self._canvas.copy_from_bbox(self.figure.bbox)

    def _write(self, solution: Solution, times: Floats) -> list[Text]:
        """Write how slow the film is and what bars show; return the texts of clock and caption."""
        self._words.set_axis_off()
        stop = float(times[-1])
        slowness = (times.size - 1) / self.fps / (stop - float(times[0]))
        rounded = f"{float(f'{slowness:.2g}'):,.0f}".replace(
            ",", "\N{NARROW NO-BREAK SPACE}"
        )
        words = [f"slowed down {rounded} times"] * (slowness > 1)
        words += [f"first {written(stop, 's')} of {written(solution.t_end, 's')}"] * (
            stop < solution.t_end
        )
        words.append(TOLD.replace(", ", ",\n"))
        self._words.text(
            0.0,
            0.0,
            "\n".join(words),
            fontsize=style.SMALL + 1,
            color=self.colours.faint,
            linespacing=1.4,
        )
        return [
            self._words.text(
                0.0, height, "", va="top", fontsize=size, color=self.colours.ink
            )
            for height, size in ((1.0, style.NORMAL + 4), (0.85, style.NORMAL))
        ]

    @style.styled
    def frame(self, number: int) -> NDArray[np.uint8]:
        """Picture [height, width, 3] of one frame, red, green and blue from 0 to 255."""
        t = float(self.times[number])
        self._canvas.restore_region(self._still)
        self._clock.set_text(self.clock(number))
        self._caption.set_text(
            self._captions[np.searchsorted(self._turns, t, side="right")]
        )
        self._look.run(self._draw_bodies, t)
        for ax in (self._row, self._words):
            self.figure.draw_artist(ax)
        for actor in [*self._row.collections, *self._row.patches, *self._row.lines]:
            actor.remove()
        picture = np.array(self._canvas.buffer_rgba())[..., :3]
        paper, ink = (
            255 * np.array(to_rgb(c)) for c in (self.colours.paper, self.colours.ink)
        )
        for ax in self._growing:  # nothing is seen of the future
            left, bottom, right, top = np.rint(ax.bbox.extents).astype(int)
            now = round(
                ax.transData.transform((0.0, max(t, 0.0) * self._time.factor))[1]
            )
            future = picture[::-1][max(bottom, now) : top, left + 1 : right]
            future[:] = paper
            future[:2] = ink
        return picture

    def _draw_bodies(self, t: float) -> None:
        """Draw the bodies at a time; nothing else is on their Axes."""
        bars = self._bars
        bars.at(np.array([t]))
        bars.rods(bars.pieces[self.field] * self._factor, self._norm)
        for draw in (bars.walls, bars.masses, bars.outlines, bars.marks):
            draw()

    def clock(self, number: int) -> str:
        """Time of a frame, in words."""
        now, end = self.times[[number, -1]] * self._time.factor
        return signed(
            f"t = {now:.{max(0, 2 - math.floor(math.log10(end)))}f} {self._time.unit}"
        )

    def __len__(self) -> int:
        return len(self.times)

    def frames(self, report: Report = no_report) -> Iterator[NDArray[np.uint8]]:
        """All frames, one after the other."""
        for number in range(len(self)):
            yield self.frame(number)
            report(number + 1, len(self))

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        force: bool = False,
        progress: bool | ProgressFunction = True,
    ) -> None:
        """Write a GIF or an MP4, whichever the suffix names.

        A GIF shows each frame for a whole number of hundredths of a second. An MP4 is made by the
        program ffmpeg.

        Parameters
        ----------
        path : path
        force : bool
            Replace an existing file.
        progress : bool or function
            Whether a bar may show how many frames are drawn. A function is called with the number
            of frames drawn and of all.

        Raises
        ------
        ValueError
            For any other suffix.
        FileExistsError
            If the file exists and `force` is false.
        OSError
            If the file cannot be written, or if an MP4 is wanted and ffmpeg is not installed.
        """
        problems: Problems = []
        check_progress(problems, progress)
        raise_noted(problems)
        write = files.WRITERS[files.check_film(path)]
        with (
            writing.written(path, force=force) as file,
            Progress(progress, "film", "frames") as report,
        ):
            write(file, self, report)

    def _repr_html_(self) -> str:
        memory = io.BytesIO()
        with Progress(True, "film", "frames") as report:
            files.write_gif(memory, self, report)
        return files.as_image(memory.getvalue(), "gif", self.title)


@style.styled
def animation(
    solution: Solution,
    field: str = "velocity",
    frames: int = 120,
    fps: float = 25.0,
    start: float = 0.0,
    stop: float | None = None,
    magnification: float | None = None,
) -> Animation:
    """Make a moving picture of a collision; `save` writes it, a notebook plays it.

    Above, the row moves and deforms. Displacements are magnified as in `spacetime`, by the factor
    named in the picture; compressed pieces are thicker, stretched pieces thinner. Below, the
    space-time diagram and the forces of the contacts grow. The film makes its own figure and takes
    no Axes. If bodies touch at t = 0, a film from t = 0 begins with their approach. In a GIF the
    last frame stays for 1.5 s.

    Parameters
    ----------
    solution : Solution
    field : "velocity", "stress" or "strain"
        Quantity that the colours show.
    frames : int
        2 to 10 000 of them, evenly spread up to `stop`; at most a fifth shows the approach.
    fps : float
        Frames a second, 1 to 50.
    start, stop : float
        Interval of time, s; by default the whole solution. If it has more than 20 000 regions of
        constant state, the first half, quarter, ... is shown, and the picture states this.
    magnification : float, optional
        Of displacements and gaps; by default chosen as in `spacetime`.

    Returns
    -------
    Animation

    Raises
    ------
    ValueError
        If the field is unknown, `frames` or `fps` is out of range, the interval is empty, there are
        more than 100 000 regions, or the magnification is not positive.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> film = ri.plot.animation(ri.solve(ri.System([rod, ri.Wall()])), frames=5)
    >>> film.clock(len(film) - 1), film.frame(4).shape
    ('t = 317 µs', (680, 840, 3))
    """
    check_waves(solution)
    one_of("field", field, ("velocity", "stress", "strain"))
    check_frames(frames, fps)
    start = single("start", start, "s")
    stop = drawn_until(solution) if stop is None else single("stop", stop, "s")
    if not start < stop:
        raise refusal("stop", f"must be later than start = {start!r} s, got {stop!r}")
    plan = placing(solution, start, stop, magnification)
    approach = _approach_frames(plan, start, stop, int(frames))
    times = np.linspace(start, stop, int(frames) - approach)
    before = np.arange(-approach, 0, dtype=np.float64) * (times[1] - times[0])
    return Animation(plan, field, np.concatenate([before, times]), float(fps))


def check_frames(frames: int, fps: float) -> None:
    """Raise ValueError if there cannot be so many frames, or so many a second."""
    count, rate = single("frames", frames, ""), single("fps", fps, "")
    if not 2 <= count <= MOST_FRAMES or count != int(count):
        raise refusal(
            "frames", f"must be a whole number from 2 to {MOST_FRAMES}, got {frames!r}"
        )
    if not 1 <= rate <= MOST_PER_SECOND:
        raise refusal(
            "fps", f"must be 1 to {MOST_PER_SECOND} frames a second, got {fps!r}"
        )


def _approach_frames(plan: Placing, start: float, stop: float, frames: int) -> int:
    """Number of frames before t = 0, in which bodies come that touch at t = 0."""
    solution = plan.solution
    velocities = solution.outcome.velocities_before
    closing = []
    for k, gap in enumerate(solution.system.gaps):
        if gap == 0:
            closing.append(float(velocities[k] - velocities[k + 1]))
    if start != 0 or max(closing, default=0.0) <= 0 or min(closing) < 0:
        return 0
    way = APPROACH_WAY * plan.row / plan.magnification
    duration = way / max(closing)
    # n frames before 0 and frames - n up to stop have one step, and n steps last no longer
    most = duration / (stop + duration) * (frames - 1)
    return int(min(most, APPROACH * frames))


def _draw_forces(ax: Axes, solution: Solution) -> None:
    """Forces of the contacts that can open, to the right of the space-time diagram."""
    able, limits = solution.outcome.unilateral, ax.get_ylim()
    forces = Forces(solution, able[:CONTACTS])
    drawn = forces.draw(ax, up=True)
    style.dress(
        ax,
        xlim=(0, 1.1 * ax.dataLim.xmax or 1.0),
        ylim=limits,
        xlabel=forces.scale.label,
    )
    ax.tick_params(labelleft=False)
    if len(able) > 1:
        more = f"first {CONTACTS} of {len(able)}" if len(able) > CONTACTS else None
        style.legend_above(ax, drawn, more)
