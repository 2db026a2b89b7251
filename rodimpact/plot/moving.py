"""Animation: the row above, its growing space-time diagram and contact forces below.

It begins before the contact and names the events at contacts. The diagram and the
forces are drawn once, complete. In each frame only the bodies and the words are drawn
anew, and all that lies after the time of the frame is painted in the colour of the
paper.
"""

import io
import math
import os
from collections.abc import Iterator
from contextvars import copy_context
from typing import Any, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from numpy.typing import NDArray

from ..methods.signals import Floats
from ..model.arguments import check_choice, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..progress import (
    Progress,
    ProgressFunction,
    ProgressReport,
    check_progress,
    no_report,
)
from ..results.solution import Solution, check_has_rod
from ..storage import writing
from ..units import shown
from . import films
from .bars import LEGEND, Bars
from .diagram import draft_spacetime
from .files import as_image
from .histories import ContactCurves
from .labels import break_label, legend_above, wrap_words
from .layout import PictureLayout, choose_layout
from .moments import contact_event_times, events_at
from .page import headline
from .panels import format_axes, lay_out, new_figure, size_in_points
from .polygons import drawn_until
from .scales import axis_scales, quantity_text, with_minus_signs
from .style import NORMAL, SMALL, colours, styled

MAX_FRAMES = 10_000
MAX_FRAMES_PER_SECOND = 50
DOTS_PER_INCH = 100
MAX_CONTACTS = 5  # contacts whose forces are shown
FRAMES_OF_STRAIN = 100  # about so many frames give the largest strain of the film
MAX_CAPTION_LINES = 3
MAX_APPROACH_FRAMES = 0.2  # largest share of the frames before contact
MAX_APPROACH_WAY = 0.12  # largest gap that closes before contact, in lengths of the row
APPROACH_MARGIN = 0.02  # room beside approaching bodies, in lengths of the row
NOW_LINE = 2  # thickness of the line at the time of a frame, pixels
CLOCK_HEIGHT = 19.0  # height of the line with the time, above the caption, points
WORDS_BESIDE = 0.2  # width of a caption beside the row, in widths of the film
WORDS_ABOVE = 0.38  # width of a caption above the row, in widths of a narrow film
MIN_WIDE = 6.0  # inches, width of a film with words beside the row
MIN_HEIGHT = 5.4  # inches


class _GridCells(NamedTuple):
    """Cells of the figure's grid in which the panels of a film stand."""

    words: Any
    row: Any
    diagram: Any
    forces: Any


class Animation:
    """Frames of an animation, drawn when needed; `figure` holds the artists at rest.

    Attributes
    ----------
    times : array
        s; one for each frame.
    fps : float
        Frames a second.
    title : str
    colours : Colours
        Colours of paper and lines.
    """

    def __init__(
        self, layout: PictureLayout, field: str, times: Floats, fps: float
    ) -> None:
        """Draw all that stays the same in each frame, and keep its pixels.

        These are the title, the space-time diagram of `field`, and the forces of
        contacts that can open. They begin with the first of the `times` that is not
        negative; times before 0 show the approach of the bodies.
        """
        solution = layout.solution
        self.fps = fps
        self.title = headline(solution)
        self.field = field
        self.times = times
        self.colours = colours()
        self._style_context = copy_context()  # colours and style of the film
        shown = times[np.searchsorted(times, 0.0) :]  # without the approach
        start = float(shown[0])
        stop = float(shown[-1])
        scales = axis_scales(
            solution, dimensionless=False, duration=stop, width=layout.row_length
        )
        self._time = scales.time

        self.figure = new_figure(width=8.4, height=6.8, least_height=MIN_HEIGHT)
        self.figure.set_dpi(DOTS_PER_INCH)
        self._find_captions(solution, start, stop)
        room = 72 * self.figure.get_figwidth()
        self.figure.suptitle(break_label(self.title, room), fontsize=NORMAL + 1)
        cells = self._grid_cells()
        diagram_ax = self.figure.add_subplot(cells.diagram)
        diagram = draft_spacetime(
            solution,
            diagram_ax,
            field,
            start=start,
            stop=stop,
            magnification=layout.magnification,
            coordinates="lab",
        )
        self._norm: Any = diagram.picture.regions.norm
        self._factor = diagram.picture.scale.factor
        # Artists that are "animated" are drawn by `frame`, not with the figure.
        self._row = self.figure.add_subplot(cells.row, sharex=diagram_ax, animated=True)
        self._row.set(ylim=(-0.6, 0.6), autoscale_on=False)
        self._row.set_axis_off()
        # The largest strain at about `FRAMES_OF_STRAIN` times sets the thickness of the
        # bars for the whole film.
        step = 1 + shown.size // FRAMES_OF_STRAIN
        self._bars = Bars(self._row, layout, shown[::step], scales.x)
        self._show_approach(diagram_ax, layout)
        self._words = self.figure.add_subplot(cells.words, animated=True)
        self._words.set_axis_off()
        self._write_notes(solution, shown)
        self._clock = self._write_line(below=0.0, size=NORMAL + 4)
        self._caption = self._write_line(below=CLOCK_HEIGHT, size=NORMAL)
        self._growing = [diagram_ax]  # Axes whose later times `frame` hides
        if solution.outcome.unilateral:
            forces = self.figure.add_subplot(cells.forces, sharey=diagram_ax)
            _draw_forces(forces, solution)
            self._growing.append(forces)
        lay_out(self.figure)
        diagram.write_words()
        self._canvas = cast("Any", FigureCanvasAgg(self.figure))
        self.figure.draw(self._canvas.get_renderer())
        self.figure.set_layout_engine("none")  # nothing may move from frame to frame
        self._still = self._canvas.copy_from_bbox(self.figure.bbox)

    def _grid_cells(self) -> "_GridCells":
        """Add a grid to the figure: words beside the row, above it in a narrow film.

        The cells are returned. The diagram is below the row, the forces beside the
        diagram.
        """
        if self._is_narrow():
            grid = self.figure.add_gridspec(
                3, 2, height_ratios=(1.0, 0.7, 3.6), width_ratios=(3, 1)
            )
            return _GridCells(
                words=grid[0, :], row=grid[1, 0], diagram=grid[2, 0], forces=grid[2, 1]
            )
        grid = self.figure.add_gridspec(
            2, 2, height_ratios=(1.2, 3.6), width_ratios=(3, 1)
        )
        return _GridCells(
            words=grid[0, 1], row=grid[0, 0], diagram=grid[1, 0], forces=grid[1, 1]
        )

    def _is_narrow(self) -> bool:
        """Whether the film is too narrow for words beside the row."""
        return bool(self.figure.get_figwidth() < MIN_WIDE)

    def _find_captions(self, solution: Solution, start: float, stop: float) -> None:
        """Set `_event_times`, s, and `_captions`, texts of the events at contacts.

        Events from `start` to `stop` count. With n events there are n + 1 captions. The
        first one, "before contact" or "", holds until the first event. Each other one
        has the time and the events of an instant, and holds until the next; it has at
        most `MAX_CAPTION_LINES` lines.
        """
        times = {t for t in contact_event_times(solution) if start <= t <= stop}
        self._event_times = sorted(times)
        share = WORDS_ABOVE if self._is_narrow() else WORDS_BESIDE
        room = share * 72 * self.figure.get_figwidth()  # points
        first = ""
        if start == 0 and times:
            first = "before contact"
        self._captions = [first]
        for t in self._event_times:
            events = events_at(solution, t).splitlines()
            lines = [f"{quantity_text(t, 's')}:"]
            for event in events:
                lines += wrap_words(event, room).split("\n")
            caption = "\n".join(lines[:MAX_CAPTION_LINES])
            if len(lines) > MAX_CAPTION_LINES:
                caption += ", ..."
            self._captions.append(caption)

    def _show_approach(self, ax: Axes, layout: PictureLayout) -> None:
        """Widen the axis of x so that it includes all bodies in the first frame.

        There they are farthest apart. The axis never becomes shorter.
        """
        left_ends = []
        right_ends = []
        for body in range(len(layout.left)):
            left_end = layout.end(body, is_right=False, t=self.times[0])
            left_ends.append(float(left_end))
            right_end = layout.end(body, is_right=True, t=self.times[0])
            right_ends.append(float(right_end))
        margin = APPROACH_MARGIN * layout.row_length
        factor = self._bars.x_scale.factor
        left = (min(left_ends) - margin) * factor
        right = (max(right_ends) + margin) * factor
        shown_left, shown_right = ax.get_xlim()
        ax.set_xlim(min(shown_left, left), max(shown_right, right))

    def _write_notes(self, solution: Solution, times: Floats) -> None:
        """Write how slow the film is, what part it shows, and what the bars show.

        The first line is left out for a film that is not slower than the collision, the
        second for one that shows all of the solution.
        """
        stop = float(times[-1])
        seconds = (times.size - 1) / self.fps  # duration of the film
        slowness = seconds / (stop - float(times[0]))
        lines = []
        if slowness > 1:
            two_digits = float(f"{slowness:.2g}")
            with_commas = f"{two_digits:,.0f}"
            number = with_commas.replace(",", "\N{NARROW NO-BREAK SPACE}")
            lines.append(f"slowed down {number} times")
        if stop < solution.t_end:
            end = quantity_text(solution.t_end, "s")
            lines.append(f"first {quantity_text(stop, 's')} of {end}")
        lines.append(LEGEND.replace(", ", ",\n"))
        position: dict[str, Any] = {"x": 0.0, "y": 0.0, "va": "baseline"}
        if self._is_narrow():
            position = {"x": 0.45, "y": 1.0, "va": "top"}
        self._words.text(
            s="\n".join(lines),
            **position,
            fontsize=SMALL + 1,
            color=self.colours.faint,
            linespacing=1.4,
        )

    def _write_line(self, below: float, size: float) -> Text:
        """Add an empty line of text, `below` points below the top of the words' panel.

        `size` is the height of its letters, points.
        """
        return self._words.annotate(
            "",
            xy=(0.0, 1.0),
            xytext=(0.0, -below),
            xycoords="axes fraction",
            textcoords="offset points",
            va="top",
            fontsize=size,
            color=self.colours.ink,
        )

    @styled
    def frame(self, number: int) -> NDArray[np.uint8]:
        """Picture [height, width, 3] of one frame, red, green and blue from 0 to 255.

        Bodies and words are drawn over the kept pixels, and the bodies are removed from
        the figure again. In the diagram and the forces, times after that of the frame
        are painted over.
        """
        t = float(self.times[number])
        self._canvas.restore_region(self._still)
        self._clock.set_text(self.clock(number))
        n_past = np.searchsorted(self._event_times, t, side="right")  # events until t
        self._caption.set_text(self._captions[n_past])
        self._style_context.run(self._draw_bodies, t)
        for ax in (self._row, self._words):
            self.figure.draw_artist(ax)
        for drawn in [*self._row.collections, *self._row.patches, *self._row.lines]:
            drawn.remove()
        picture = np.array(self._canvas.buffer_rgba())[..., :3]  # without opacity
        for ax in self._growing:
            self._hide_future(picture, ax, t)
        return picture

    def _hide_future(self, picture: NDArray[np.uint8], ax: Axes, t: float) -> None:
        """Paint over the times after `t` of an Axes in `picture`, and draw a line at t.

        `picture` is changed. Time runs upward; before 0 all times are painted over.
        """
        left, bottom, right, top = np.rint(ax.bbox.extents).astype(int)  # pixels
        height = max(t, 0.0) * self._time.factor
        _, y_now = ax.transData.transform((0.0, height))
        now = round(y_now)  # row of pixels, counted from below
        upward = picture[::-1]  # a view; the rows of a picture are counted from above
        # The first column has the frame of the Axes, which stays.
        future = upward[max(bottom, now) : top, left + 1 : right]
        future[:] = 255 * np.array(to_rgb(self.colours.paper))
        future[:NOW_LINE] = 255 * np.array(to_rgb(self.colours.ink))

    def _draw_bodies(self, t: float) -> None:
        """Draw the bodies at time t, s, on their own Axes.

        They are rods in the colours of the field, with outlines, walls, masses, and
        marks of ends and contacts. What is drawn already stays: `frame` removes it.
        """
        bars = self._bars
        bars.move_to(np.array([t]))
        # Values in the unit of the colour scale
        values = bars.pieces[self.field] * self._factor
        bars.draw_rods(values, self._norm)
        bars.draw_walls()
        bars.draw_masses()
        bars.draw_outlines()
        bars.draw_marks()

    def clock(self, number: int) -> str:
        """Time of a frame as a text, such as "t = 317 µs".

        All frames have one unit and one number of decimals, with which the last time
        has three digits or more.
        """
        now, end = self.times[[number, -1]] * self._time.factor
        power = math.floor(math.log10(end))  # of ten, of the leading digit of the end
        decimals = max(0, 2 - power)  # the end has three digits
        return with_minus_signs(f"t = {now:.{decimals}f} {self._time.unit}")

    def __len__(self) -> int:
        return len(self.times)

    def frames(self, report: ProgressReport = no_report) -> Iterator[NDArray[np.uint8]]:
        """Yield the picture of each frame in order; `report` is called after each."""
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

        A GIF shows each frame for a whole number of hundredths of a second. An MP4 is
        made by the program ffmpeg.

        Parameters
        ----------
        path : path
        force : bool
            Replace an existing file.
        progress : bool or function
            Whether a bar may show how many frames are drawn. A function is called with
            the number of frames drawn and of all.

        Raises
        ------
        ValueError
            For any other suffix.
        FileExistsError
            If the file exists and `force` is false.
        OSError
            If the file cannot be written, or if an MP4 is wanted and ffmpeg is not
            installed.
        """
        problems: Problems = []
        check_progress(problems, progress)
        raise_if_problems(problems)
        kind = films.check_film(path)  # "gif" or "mp4"
        write = films.WRITERS[kind]
        with (
            writing.open_for_writing(path, force=force) as file,
            Progress(progress, "film", "frames") as report,
        ):
            write(file, self, report)

    def _repr_html_(self) -> str:
        """The film as HTML with a GIF inside, for a notebook; a bar shows progress."""
        memory = io.BytesIO()
        with Progress(True, "film", "frames") as report:
            films.write_gif(memory, self, report)
        return as_image(memory.getvalue(), "gif", self.title)


@styled
def animation(
    solution: Solution,
    field: str = "velocity",
    frames: int = 120,
    fps: float = 25.0,
    start: float = 0.0,
    stop: float | None = None,
    *,
    magnification: float | None = None,
) -> Animation:
    """Make a moving picture of a collision; `save` writes it, a notebook plays it.

    Above, the row moves and deforms. Displacements are magnified as in `spacetime`, by
    the factor named in the picture; compressed pieces are thicker, stretched pieces
    thinner. Below, the space-time diagram and the forces of the contacts grow. The film
    makes its own figure and takes no Axes. If bodies touch at t = 0, a film from t = 0
    begins with their approach. In a GIF the last frame stays for 1.5 s.

    Parameters
    ----------
    solution : Solution
    field : "velocity", "stress" or "strain"
        Quantity that the colours show.
    frames : int
        2 to 10 000 of them, evenly spread up to `stop`; at most a fifth shows the
        approach.
    fps : float
        Frames a second, 1 to 50.
    start, stop : float
        Interval of time, s. By default it is the whole solution, or its first half,
        quarter, ... if it has more than 20 000 regions of constant state; the picture
        states this.
    magnification : float, optional
        Factor of displacements and gaps; by default chosen as in `spacetime`.

    Returns
    -------
    Animation

    Raises
    ------
    ValueError
        If the field is unknown, `frames` or `fps` is out of range, the interval is
        empty, there are more than 100 000 regions, or the magnification is not
        positive.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> film = ri.plot.animation(ri.solve(ri.System([rod, ri.Wall()])), frames=5)
    >>> film.clock(len(film) - 1), film.frame(4).shape
    ('t = 317 µs', (680, 840, 3))
    """
    check_has_rod(solution)
    check_choice("field", field, ("velocity", "stress", "strain"))
    check_frames(frames, fps)
    start = scalar("start", start, "s")
    if stop is None:
        stop = drawn_until(solution)
    else:
        stop = scalar("stop", stop, "s")
    if not start < stop:
        raise invalid_argument(
            "stop", f"must be later than start = {start!r} s, got {stop!r}"
        )
    layout = choose_layout(solution, start, stop, magnification)
    n_before = _approach_frames(layout, start, stop, int(frames))
    times = np.linspace(start, stop, int(frames) - n_before)
    step = times[1] - times[0]
    before = np.arange(-n_before, 0, dtype=np.float64) * step  # negative times
    return Animation(layout, field, np.concatenate([before, times]), float(fps))


def check_frames(frames: int, fps: float) -> None:
    """Raise ValueError unless `frames` is a whole number, and both are in range.

    `frames` may be 2 to `MAX_FRAMES`, `fps` 1 to `MAX_FRAMES_PER_SECOND`.
    """
    count = scalar("frames", frames, "")
    rate = scalar("fps", fps, "")
    if not 2 <= count <= MAX_FRAMES or count != int(count):
        raise invalid_argument(
            "frames",
            f"must be a whole number from 2 to {MAX_FRAMES}, got {shown(frames)}",
        )
    if not 1 <= rate <= MAX_FRAMES_PER_SECOND:
        raise invalid_argument(
            "fps",
            f"must be 1 to {MAX_FRAMES_PER_SECOND} frames a second, got {shown(fps)}",
        )


def _approach_frames(
    layout: PictureLayout, start: float, stop: float, frames: int
) -> int:
    """Number of frames before t = 0, which show bodies that will touch at t = 0.

    In these frames the gap that closes fastest is at most `MAX_APPROACH_WAY`, and they
    are at most the share `MAX_APPROACH_FRAMES` of all frames. There are none if the
    film does not begin at 0, or if of the bodies that touch none approach or some move
    apart.
    """
    solution = layout.solution
    velocities = solution.outcome.velocities_before
    closing = []  # closing velocities of the bodies that touch, m/s
    for k, gap in enumerate(solution.system.gaps):
        if gap == 0:
            closing.append(float(velocities[k] - velocities[k + 1]))
    if start != 0:
        return 0
    if max(closing, default=0.0) <= 0:  # none approach, or none touch
        return 0
    if min(closing) < 0:  # before 0 these bodies would overlap
        return 0
    largest_gap = MAX_APPROACH_WAY * layout.row_length / layout.magnification
    duration = largest_gap / max(closing)
    # All frames have one step, so n of them before 0 take the share n/(frames - 1) of
    # the whole film. This share is at most duration/(stop + duration).
    fitting = duration / (stop + duration) * (frames - 1)
    return int(min(fitting, MAX_APPROACH_FRAMES * frames))


def _draw_forces(ax: Axes, solution: Solution) -> None:
    """Draw the forces of the first `MAX_CONTACTS` contacts that can open, on an Axes.

    Time runs upward: the Axes stands to the right of the space-time diagram and shares
    its axis of time. A legend names several contacts, and says how many there are if
    some are left out.
    """
    contacts = solution.outcome.unilateral
    limits = ax.get_ylim()  # limits of the diagram, which drawing would change
    curves = ContactCurves(solution, contacts[:MAX_CONTACTS])
    forces = curves.draw(ax, is_upward=True)
    right = 1.1 * ax.dataLim.xmax
    if right == 0:  # no force at all
        right = 1.0
    room_of_label = 1.5 * size_in_points(ax)[0]  # it may be wider than the Axes
    format_axes(
        ax,
        xlim=(0, right),
        ylim=limits,
        xlabel=break_label(curves.scale.label, room_of_label),
    )
    ax.tick_params(labelleft=False)
    if len(contacts) > 1:
        title = None
        if len(contacts) > MAX_CONTACTS:
            title = f"first {MAX_CONTACTS} of {len(contacts)}"
        legend_above(ax, forces, title)
