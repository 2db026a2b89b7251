"""Force and gap of contacts over time: exact steps, not samples.

If there are very many steps, only the least and the largest in each of a thousand
intervals are drawn.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch
from matplotlib.text import Annotation

from ..methods.signals import Floats
from ..model import Bonded, Joint, Rigid
from ..model.arguments import array
from ..model.frozen import invalid_argument
from ..model.numbering import contact_names
from ..results.contacts import ContactHistory
from ..results.solution import Solution, check_solution
from ..units import shown
from .labels import break_label, text_width
from .moments import round_trips
from .panels import (
    Draft,
    Picture,
    draw_zero,
    finish,
    format_axes,
    size_in_points,
    two_axes_or_new,
)
from .sampling import (
    INTERVALS,
    StepCurve,
    evenly,
    extreme_indices,
    steps_until,
    thinned,
)
from .scales import Scale, engineering, largest_of, quantity_text, time_scale
from .style import DASHES, SMALL, colours, styled

MAX_MARKED_EPISODES = 3  # episodes of a contact up to which their ends are marked
MAX_NAMED_CONTACTS = 12  # most contacts that are drawn together, or named in rows
ROW_FILL = 0.85  # height of the largest force, in distances between rows
HEADROOM = 1.3  # upper limit of an axis over the largest value: room for words
CAPTION_HEIGHT = 11  # points from one caption to the next
CAPTION_GAP = 4.0  # points between a caption and its line


@styled
def contact(
    solution: Solution,
    ax: Sequence[Axes] | None = None,
    contact: int | Sequence[int] | None = None,
) -> Picture:
    """Draw force and gap of all contacts, or of some of them, against time.

    A negative gap is the overlap of a compliant contact; the gap of a joint is its
    extension. The impact of two rigid bodies has no duration: its force is drawn as a
    mean over the time that the label names, which is the time step of a grid or a
    thousandth of the run.

    Parameters
    ----------
    solution : Solution
    ax : two Axes, optional
        Axes of force and gap; by default those of a new figure, one above the other.
    contact : int or sequence of int, optional
        Index of the contact: it is between body `contact` and the next body; walls are
        counted. By default all contacts are drawn, but only the twelve with the largest
        forces if there are more, which the title says. The legend names the contacts; a
        single contact is named by the label of its force. If a single contact has up to
        three episodes, the times at which its force ends and its gap opens are marked.
        Times of whole round trips of a wave are named, such as 2 l1/c.

    Returns
    -------
    Picture
        With `force_ax` and `gap_ax`, a step patch for each of `forces`, lines of
        `gaps`, and the annotations `marks`.

    Raises
    ------
    ValueError
        If there is no such contact, `ax` is not a pair, or the duration of the solution
        is 0.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> picture = ri.plot.contact(ri.solve(ri.System([rod, ri.Wall()])))
    >>> picture.force_ax.get_ylabel()
    'contact force (kN)'
    """
    check_solution(solution)
    count = len(solution.contacts)
    if contact is None and count:
        return finish(draft_contact(solution, ax, _most_pressed(solution)))
    chosen = []
    if contact is not None:
        chosen = array("contact", contact, "").ravel().tolist()
    all_exist = set(chosen) <= set(range(count))
    if not chosen or not all_exist:
        allowed = "given only where there are two bodies"
        if count:
            allowed = f"from 0 to {count - 1}"
        raise invalid_argument("contact", f"must be {allowed}, got {shown(contact)}")
    contacts = [int(k) for k in chosen]
    return finish(draft_contact(solution, ax, contacts))


def draft_contact(
    solution: Solution, ax: Sequence[Axes] | None, contacts: Sequence[int]
) -> Draft:
    """Draft of `contact` for the contacts of these indices: all curves, without marks.

    Several contacts have a legend; a title says how many of all contacts are drawn if
    they are a selection. `write_words` of the draft labels the axes again for the final
    sizes, and marks force ends and openings of a single contact.
    """
    force_ax, gap_ax = two_axes_or_new(ax, "force and gap", height=4.2, ratios=(1, 1))

    # What is measured.
    curves = ContactCurves(solution, contacts)
    gap_scale = curves.gap_scale()

    # What is drawn.
    forces = curves.draw(force_ax)
    gaps = _draw_gaps(gap_ax, curves, forces, gap_scale.factor)
    if gap_scale.name != "gap":  # 0 is inside the axis
        draw_zero(gap_ax)
    named: Sequence[StepPatch] = ()
    if len(forces) > 1:
        named = forces
    end = solution.t_end * curves.time.factor
    format_axes(force_ax, named, xlim=(0, end))
    format_axes(gap_ax, xlim=(0, end), xlabel=curves.time.label)
    _set_height(force_ax)
    _set_height(gap_ax)

    def label() -> None:
        """Label both axes in lines as long as the Axes are high at present."""
        for each, scale in ((force_ax, curves.scale), (gap_ax, gap_scale)):
            _, height = size_in_points(each)
            each.set_ylabel(break_label(scale.label, height))

    label()
    is_full = len(contacts) == MAX_NAMED_CONTACTS
    are_all_drawn = len(contacts) == len(solution.contacts)
    if is_full and not are_all_drawn:  # the selection of `_most_pressed`
        force_ax.set_title(
            f"{len(contacts)} of {len(solution.contacts)} contacts",
            loc="left",
            fontsize=SMALL + 1,
        )
    picture = Picture(
        ax=force_ax,
        force_ax=force_ax,
        gap_ax=gap_ax,
        forces=forces,
        gaps=gaps,
        marks=[],
    )

    def write_words() -> None:
        """Label the axes anew; mark the episodes of a single contact."""
        label()
        if len(contacts) == 1:
            picture.marks = _mark_ends(solution, curves, force_ax, gap_ax)

    return Draft(picture, write_words)


def _most_pressed(solution: Solution) -> list[int]:
    """Indices of the contacts with the largest peak forces, from left to right.

    There are `MAX_NAMED_CONTACTS` of them, or all contacts if they are fewer.
    """
    contacts = list(range(len(solution.contacts)))
    if len(contacts) <= MAX_NAMED_CONTACTS:
        return contacts
    peaks = np.nan_to_num([each.peak_force for each in solution.contacts])
    largest = np.argsort(-peaks, kind="stable")[:MAX_NAMED_CONTACTS]
    return sorted(largest.tolist())


def _draw_gaps(
    ax: Axes, curves: "ContactCurves", forces: Sequence[StepPatch], factor: float
) -> list[Line2D]:
    """Draw gaps over time, each with the colour and dashes of its contact's force.

    A gap in metres times `factor` is the number on the axis.
    """
    lines: list[Line2D] = []
    for force, gap in zip(forces, curves.gaps, strict=True):
        lines += ax.plot(
            gap.times * curves.time.factor,
            gap.values * factor,
            linewidth=1.5,
            color=force.get_edgecolor(),
            linestyle=force.get_linestyle(),
        )
    return lines


def _set_height(ax: Axes) -> None:
    """Set the vertical limits so that they include all curves and 0.

    There is room for words above the curves. If all values are 0, the limits are 0 and
    1, with one tick at 0.
    """
    low = min(0.0, ax.dataLim.y0)
    high = HEADROOM * max(0.0, ax.dataLim.y1)
    if high == 0 and low == 0:  # a value that is 0 throughout has no scale
        high = 1.0
        ax.set_yticks([0])
    elif high == 0:  # no value is positive: a tenth of the range is left above 0
        high = -0.1 * low
    ax.set_ylim(1.1 * low, high)


def _mark_ends(
    solution: Solution, curves: "ContactCurves", force_ax: Axes, gap_ax: Axes
) -> list[Annotation]:
    """Mark when the force ends and the gap opens in each episode of a single contact.

    The contact is the first one of `curves`. Each time has a dotted line in both Axes.
    Its caption is in the Axes of the force or of the gap, one line lower for each later
    episode. The captions are returned. Events that have not happened in this run have
    no marks; a contact with more than `MAX_MARKED_EPISODES` episodes has none at all.
    """
    episodes = curves.histories[0].episodes
    if len(episodes) > MAX_MARKED_EPISODES:
        return []
    trips = round_trips(solution)
    marks = []
    for k, episode in enumerate(episodes):
        for ax, t, event in (
            (force_ax, episode.force_end, "force ends"),
            (gap_ax, episode.opening, "gap opens"),
        ):
            if not t < np.inf:  # NaN or inf: the event is not in this run
                continue
            x = t * curves.time.factor
            for each in (force_ax, gap_ax):
                each.axvline(
                    x, color=colours().faint, linewidth=0.8, linestyle=":", zorder=0
                )
            trip = ""
            if t in trips:
                trip = f"{trips[t]} = "
            caption = f"{event} at {trip}{curves.time.write(t)}"
            marks.append(_write_caption(ax, x, caption, k))
    return marks


def _write_caption(ax: Axes, x: float, caption: str, line: int) -> Annotation:
    """Write a caption beside the upright line at x, on the side with more room.

    A caption without room on either side crosses the line, and stays inside the Axes.
    `line` is the number of captions above it.
    """
    low, high = ax.get_xlim()
    width = size_in_points(ax)[0]
    # Points from the line at x to the right and to the left side of the Axes
    to_right = (high - x) / (high - low) * width
    to_left = width - to_right
    needed = text_width(caption, SMALL + 1) + CAPTION_GAP
    # The side of the caption named `side` is `shift` points to the right of the line.
    shift = CAPTION_GAP
    side = "left"
    if to_left > to_right:
        shift = -CAPTION_GAP
        side = "right"
    has_room = needed <= max(to_left, to_right)
    if not has_room and side == "left":  # it ends at the right side of the Axes
        shift = to_right
        side = "right"
    elif not has_room:  # it begins at the left side of the Axes
        shift = -to_left
        side = "left"
    below_top = 3 + CAPTION_HEIGHT * line  # points
    return ax.annotate(
        caption,
        xy=(x, 1.0),
        xytext=(shift, -below_top),
        xycoords=ax.get_xaxis_transform(),
        textcoords="offset points",
        ha=side,
        va="top",
        fontsize=SMALL + 1,
        color=colours().ink,
        bbox={"facecolor": colours().paper, "edgecolor": "none", "pad": 0.5},
    )


class GapCurve(NamedTuple):
    """Gap of a contact over time."""

    times: Floats  # s
    values: Floats  # m


class ContactCurves:
    """Forces and gaps of contacts, to be drawn together.

    Attributes
    ----------
    histories : list of ContactHistory
    names : list of str
        Such as "contact 1-2".
    forces : list of StepCurve
        N, over s.
    gaps : list of GapCurve
    time : Scale
        Scale of times.
    scale : Scale
        Scale of forces; its name says so if some forces are means over a time.
    largest : float
        Largest absolute force of all contacts, N.
    """

    def __init__(self, solution: Solution, contacts: Sequence[int]) -> None:
        """Measure forces and gaps of the contacts with these indices, until the end.

        Long curves are thinned to their extreme values. A contact of rigid bodies,
        whose impacts take no time, has the mean force over equal intervals, which the
        name of the axis states.
        """
        numbers = contact_names(solution.system.kinds)
        self.histories = [solution.contacts[k] for k in contacts]
        self.names = [f"contact {numbers[k]}" for k in contacts]
        self.end = solution.t_end
        self.time = time_scale(self.end)
        self.forces: list[StepCurve] = []
        self.gaps: list[GapCurve] = []
        mean = ""
        for history in self.histories:
            if _has_impacts(history):
                force = self._mean_force(history)
                # A grid has spread the impact over its own step, which may be longer.
                step = max(solution.fields.step, self.end / INTERVALS)
                mean = f",\nmean over {quantity_text(step, 's')}"
            else:
                times, values, _ = history.breakpoints()
                # A force constant between its times has one coefficient each.
                is_smooth = history.push.coefficient_count > 1
                force = steps_until(self.end, times, values, is_smooth)
            gap = history.gap(force.edges)  # linear between these times
            chosen = extreme_indices(gap)
            times = force.edges[chosen]
            self.forces.append(thinned(force))
            self.gaps.append(GapCurve(times, gap[chosen]))
        self.largest = 0.0
        for force in self.forces:
            self.largest = max(self.largest, largest_of(force.values))
        name = "contact force"
        is_one_of_several = len(contacts) == 1 and len(solution.contacts) > 1
        if is_one_of_several:
            name = f"force at {self.names[0]}"
        self.scale = engineering(f"{name}{mean}", self.largest, "N")

    def _mean_force(self, history: ContactHistory) -> StepCurve:
        """Mean force over `INTERVALS` equal intervals: impulse divided by duration."""
        edges: Floats = np.linspace(0.0, self.end, INTERVALS + 1)
        impulse = np.diff(history.impulse_until(edges))
        return StepCurve(impulse / np.diff(edges), edges)

    def gap_scale(self) -> Scale:
        """Scale of the gaps, with the name of the axis.

        The name is "gap". It says that negative gaps are overlaps if there are any at
        compliant contacts, and that gaps of joints are stretches.
        """
        gaps = np.concatenate([gap.values for gap in self.gaps])
        low = float(gaps.min())
        high = float(gaps.max())
        laws = {type(history.law) for history in self.histories}
        laws_without_overlap = {Rigid, Bonded, Joint}
        has_compliant_contact = not laws <= laws_without_overlap
        name = "gap"
        if low < 0 and has_compliant_contact:
            name = "gap, below 0\noverlap"
        if laws == {Joint}:
            name = "stretch"
        elif Joint in laws:
            name = f"{name},\nor stretch"
        return engineering(name, max(-low, high), "m")

    def draw(self, ax: Axes, is_upward: bool = False) -> list[StepPatch]:
        """Draw the forces together, against time to the right or upward.

        Each has a colour and dashes of its own, and its name for a legend; the filled
        curves are returned.
        """
        series = colours().series
        steps = []
        for i, force in enumerate(self.forces):
            colour = series[i % len(series)]
            patch = ax.stairs(
                force.values * self.scale.factor,
                force.edges * self.time.factor,
                baseline=0.0,
                fill=True,
                facecolor=(colour, 0.15),
                edgecolor=colour,
                label=self.names[i],
                linewidth=1.5,
                linestyle=DASHES[i % len(DASHES)],
                orientation="horizontal" if is_upward else "vertical",
            )
            steps.append(patch)
        return steps

    def draw_rows(self, ax: Axes) -> None:
        """Draw the forces of many contacts one above the other, to one scale.

        The rows are one unit apart; ticks name at most `MAX_NAMED_CONTACTS` of them.
        The largest force fills `ROW_FILL` of a row, and the title gives its value.
        """
        series = colours().series
        largest = self.largest
        if largest == 0:
            largest = 1.0
        factor = ROW_FILL / largest  # rows for one newton
        for row, force in enumerate(self.forces):
            colour = series[row % len(series)]
            ax.stairs(
                force.values * factor + row,
                force.edges * self.time.factor,
                baseline=float(row),
                fill=True,
                facecolor=(colour, 0.15),
                edgecolor=colour,
                linewidth=1.5,
            )
        named = evenly(len(self.forces), MAX_NAMED_CONTACTS)
        ax.set_yticks(named, [self.names[i] for i in named])
        format_axes(
            ax,
            xlim=(0, self.end * self.time.factor),
            ylim=(0, len(self.forces)),
            xlabel=self.time.label,
        )
        ax.set_title(
            f"{self.scale.name}, largest {self.scale.write(self.largest)}",
            loc="left",
            fontsize=SMALL + 1,
        )


def _has_impacts(history: ContactHistory) -> bool:
    """Whether a contact is of rigid bodies with a given restitution.

    Their impacts take no time.
    """
    law = history.law
    return isinstance(law, Rigid) and law.restitution is not None
