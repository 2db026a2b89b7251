"""What a load cell and a gap gauge would record: exact steps, nothing sampled.

Of very many steps the least and the largest in each of a thousand intervals are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import StepPatch
from matplotlib.text import Annotation

from ..methods.signals import Floats
from ..model import Bonded, Joint, Rigid
from ..model.arguments import array
from ..model.frozen import refusal
from ..results.contacts import ContactHistory
from ..results.solution import Solution, check_solution
from .sampling import fine
from .scales import Scale, engineering, time_scale, written
from .showing import picture
from .stairs import stairs
from .style import DASHES, SMALL, colours, dress, legend_above, new_figure, styled, two_axes
from .thinning import INTERVALS, evenly, telling

MARKED_UP_TO = 3  # episodes of contact
NAMED_UP_TO = 12  # contacts in a row


@picture
class Contact(NamedTuple):
    """Artists of a contact's history: steps of force, lines of gap, marks of what happens when."""

    force_ax: Axes
    gap_ax: Axes
    forces: list[StepPatch]
    gaps: list[Line2D]
    marks: list[Annotation]


@styled
def contact(
    solution: Solution, ax: Sequence[Axes] | None = None, contact: int | Sequence[int] = 0
) -> Contact:
    """Draw force and gap of a contact, or of several together, against time.

    A gap below 0 is the indentation of a compliant contact; that of a joint is its stretch. An
    impact of two rigid bodies lasts no time: its force is the mean over the time that the label
    names, the time step of a grid or a thousandth of the run.

    Parameters
    ----------
    solution : Solution
    ax : two Axes, optional
        For force and gap; by default those of a new figure, one above the other.
    contact : int or sequence of int
        Index of the contact: between body `contact` and the next, walls counted. The times at which
        force ends and gap opens are marked if it is only one and has up to three episodes.

    Returns
    -------
    Contact

    Raises
    ------
    ValueError
        If there is no such contact, the `ax` is no pair, or the solution lasts no time.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> picture = ri.plot.contact(ri.solve(ri.System([rod, ri.Wall()])))
    >>> picture.force_ax.get_ylabel()
    'contact force (kN)'
    """
    check_solution(solution)
    chosen = array("contact", contact, "").ravel().tolist()
    count = len(solution.contacts)
    if not chosen:
        raise refusal("contact", "must be an index or several, got none")
    for index in chosen:
        if index not in range(count):
            have = f"from 0 to {count - 1}" if count else "given only where there are two bodies"
            raise refusal("contact", f"must be {have}, got {index:g}")
    if ax is None:
        ax = new_figure(5.6, 4.2).subplots(2, 1, sharex=True).tolist()
    force_ax, gap_ax = two_axes(ax, "force and gap")
    histories = [solution.contacts[int(index)] for index in chosen]
    end = solution.t_end
    time = time_scale(end)
    records = [_record(history, end) for history in histories]
    force = force_scale(solution, histories)
    low, high = min(g.min() for *_, g in records), max(g.max() for *_, g in records)
    laws = {type(history.law) for history in histories}
    indented = low < 0 and not laws <= {Rigid, Bonded, Joint}
    word = "gap, below 0\nindentation" if indented else "gap"
    if Joint in laws:
        word = f"{word},\nor stretch" if laws > {Joint} else "stretch"
    gap = engineering(word, max(-low, high), "m")

    forces = draw_forces(force_ax, histories, end, time, force)
    gaps: list[Line2D] = []
    for i, (times, _, g) in enumerate(records):
        at = telling(g)
        gaps += gap_ax.plot(times[at] * time.factor, g[at] * gap.factor, linewidth=1.5, **_line(i))
    if indented or Joint in laws:
        gap_ax.axhline(0.0, color=colours().faint, linewidth=0.6, zorder=0)
    for each, scale, column in ((force_ax, force, 1), (gap_ax, gap, 2)):
        dress(each)
        each.set(xlim=(0, end * time.factor), ylabel=scale.label)
        _show(each, np.concatenate([record[column] for record in records]) * scale.factor)
    gap_ax.set_xlabel(time.label)
    if len(histories) > 1:
        legend_above(force_ax, forces, columns=4)
    marks = _marks(histories[0], force_ax, gap_ax, time) if len(histories) == 1 else []
    return Contact(force_ax, gap_ax, forces, gaps, marks)


def force_scale(solution: Solution, histories: Sequence[ContactHistory]) -> Scale:
    """Scale of an axis of contact forces; it says so if some are means over a time."""
    fields, mean = solution.fields, ""
    if any(map(_is_impact, histories)):
        step = fields.resolution * fields.clock.tick
        mean = f",\nmean over {written(max(step, solution.t_end / INTERVALS), 's')}"
    largest = max(np.abs(_record(history, solution.t_end)[1]).max() for history in histories)
    return engineering(f"contact force{mean}", largest, "N")


def draw_forces(
    ax: Axes, histories: Sequence[ContactHistory], end: float, time: Scale, force: Scale,
    up: bool = False,
) -> list[StepPatch]:
    """Draw the forces of contacts until `end`, s, against time to the right, or upward."""
    drawn = []
    for i, history in enumerate(histories):
        times, f, _ = _record(history, end)
        kept = telling(f)
        values, edges = f[kept] * force.factor, np.append(times[kept], times[-1]) * time.factor
        stairs(ax, values, edges, _line(i)["color"], fill=True, alpha=0.15, up=up)
        drawn.append(stairs(
            ax, values, edges, linewidth=1.5, label=f"contact {history.index}", up=up, **_line(i)))
    return drawn


def draw_row_of_forces(ax: Axes, solution: Solution, contacts: Sequence[int]) -> None:
    """Draw the forces of many contacts against time, one above the other, to one scale."""
    histories = [solution.contacts[k] for k in contacts]
    force = force_scale(solution, histories)
    time = time_scale(solution.t_end)
    records = [_record(history, solution.t_end) for history in histories]
    largest = max(float(np.abs(f).max()) for _, f, _ in records) or 1.0
    for i, (times, f, _) in enumerate(records):
        kept, colour = telling(f), _line(i)["color"]
        edges = np.append(times[kept], times[-1]) * time.factor
        stairs(ax, i + 0.85 * f[kept] / largest, edges, colour, baseline=i, fill=True, alpha=0.35)
        ax.axhline(i, color=colours().faint, linewidth=0.6, zorder=0)
    shown = evenly(len(records), NAMED_UP_TO)
    ax.set_yticks(shown, [f"contact {contacts[i]}" for i in shown])
    ax.set(xlim=(0, solution.t_end * time.factor), ylim=(0, len(records)), xlabel=time.label)
    ax.set_title(f"{force.name}, largest {force.write(largest)}", loc="left", fontsize=SMALL + 1)
    dress(ax)


def _line(i: int) -> dict[str, Any]:
    """Colour and dashes of the i-th of several curves."""
    series = colours().series
    return {"color": series[i % len(series)], "linestyle": DASHES[i % len(DASHES)]}


def _is_impact(history: ContactHistory) -> bool:
    """Whether two rigid bodies collide, which takes no time."""
    return getattr(history.law, "restitution", None) is not None


def _record(history: ContactHistory, end: float) -> tuple[Floats, Floats, Floats]:
    """Break times with the end [n + 1], force between them [n], and gap at them [n + 1]."""
    if _is_impact(history):
        edges: Floats = np.linspace(0.0, end, INTERVALS + 1)
        return edges, np.diff(history.impulse_until(edges)) / np.diff(edges), history.gap(edges)
    times, force, gap = history.breakpoints()
    if history.push.size > 1:
        edges, force = fine(times, force)
        return edges, force, history.gap(edges)
    inside = times < end
    return (np.append(times[inside], end), force[inside],
            np.append(gap[inside], float(history.gap(end))))


def _show(ax: Axes, values: Floats) -> None:
    """Limits that hold all values and 0, with room for words above."""
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    ax.set_ylim(1.1 * low, 1.3 * high or (1.0 if low == 0 else -0.1 * low))


def _marks(history: ContactHistory, force_ax: Axes, gap_ax: Axes, time: Scale) -> list[Annotation]:
    """Lines at the times when force ends and gap opens, each with its words."""
    if len(history.episodes) > MARKED_UP_TO:
        return []
    marks, (_, ink, faint, *_) = [], colours()
    for k, (_, force_end, opening) in enumerate(history.episodes):
        for ax, t, what in ((force_ax, force_end, "force ends"), (gap_ax, opening, "gap opens")):
            if not t < np.inf:
                continue
            for each in (force_ax, gap_ax):
                each.axvline(t * time.factor, color=faint, linewidth=0.8, linestyle=":", zorder=0)
            right = t * time.factor > 0.7 * ax.get_xlim()[1]
            marks.append(ax.annotate(
                f"{what} at {time.write(t)}", (t * time.factor, 1.0),
                (-4 if right else 4, -3 - 11 * k),
                ax.get_xaxis_transform(), "offset points", ha="right" if right else "left",
                va="top", fontsize=SMALL + 1, color=ink))
    return marks
