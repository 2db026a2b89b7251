"""Force and gap of contacts, and records of strain gauges, over time: exact steps, not samples.

Of very many steps the least and the largest in each of a thousand intervals are drawn.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle, StepPatch
from matplotlib.text import Annotation

from ..methods.signals import Floats
from ..model import Bonded, Joint, Rigid
from ..model.arguments import array, of_kind
from ..model.frozen import refusal
from ..model.numbering import contact_names
from ..results.gauges import Gauge
from ..results.solution import Solution, check_solution
from ..units import shown
from . import style
from .moments import round_trips
from .sampling import INTERVALS, evenly, steps_until, telling, thinned_steps
from .scales import Scale, engineering, listed, place_scale, time_scale, written

MARKED_UP_TO = 3  # episodes of contact
NAMED_UP_TO = 12  # contacts in a row
BOLD_UP_TO = 200  # steps of a record of strain
FAINTEST = 0.01  # of the largest strain that a wave carries: less is no pulse


@style.styled
def contact(
    solution: Solution,
    ax: Sequence[Axes] | None = None,
    contact: int | Sequence[int] = 0,
) -> style.Picture:
    """Draw force and gap of a contact, or of several together, against time.

    A negative gap is the overlap of a compliant contact; the gap of a joint is its extension. The
    impact of two rigid bodies has no duration: its force is drawn as a mean over the time that the
    label names, which is the time step of a grid or a thousandth of the run.

    Parameters
    ----------
    solution : Solution
    ax : two Axes, optional
        For force and gap; by default those of a new figure, one above the other.
    contact : int or sequence of int
        Index of the contact: it is between body `contact` and the next body; walls are counted. For
        a single contact with up to three episodes, the times at which the force ends and the gap
        opens are marked. Times of whole round trips of a wave are named, such as 2 l1/c.

    Returns
    -------
    Picture
        With `force_ax` and `gap_ax`, a step patch for each of `forces`, lines of `gaps`, and the
        annotations `marks`.

    Raises
    ------
    ValueError
        If there is no such contact, `ax` is not a pair, or the duration of the solution is 0.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> picture = ri.plot.contact(ri.solve(ri.System([rod, ri.Wall()])))
    >>> picture.force_ax.get_ylabel()
    'contact force (kN)'
    """
    check_solution(solution)
    chosen, count = (
        array("contact", contact, "").ravel().tolist(),
        len(solution.contacts),
    )
    if not chosen or not set(chosen) <= set(range(count)):
        have = (
            f"from 0 to {count - 1}"
            if count
            else "given only where there are two bodies"
        )
        raise refusal("contact", f"must be {have}, got {shown(contact)}")
    force_ax, gap_ax = style.two_axes(ax, "force and gap", 4.2, (1, 1))
    drawn = Forces(solution, list(map(int, chosen)))
    low = min(float(gap.min()) for _, gap in drawn.gaps)
    high = max(float(gap.max()) for _, gap in drawn.gaps)
    laws = {type(history.law) for history in drawn.histories}
    overlaps = low < 0 and not laws <= {Rigid, Bonded, Joint}
    word = "gap, below 0\noverlap" if overlaps else "gap"
    if Joint in laws:
        word = f"{word},\nor stretch" if laws > {Joint} else "stretch"
    scale = engineering(word, max(-low, high), "m")

    forces, time, (_, ink, faint, *_) = (
        drawn.draw(force_ax),
        drawn.time.factor,
        style.colours(),
    )
    gaps = [
        line
        for force, (times, gap) in zip(forces, drawn.gaps, strict=True)
        for line in gap_ax.plot(
            times * time,
            gap * scale.factor,
            linewidth=1.5,
            color=force.get_edgecolor(),
            linestyle=force.get_linestyle(),
        )
    ]
    if overlaps or Joint in laws:
        gap_ax.axhline(0.0, color=faint, linewidth=0.6, zorder=0)
    gap_ax.set_xlabel(drawn.time.label)
    for each, label, named in (
        (force_ax, drawn.scale.label, forces[len(forces) == 1 :]),
        (gap_ax, scale.label, ()),
    ):
        low, high = min(0.0, each.dataLim.y0), max(0.0, each.dataLim.y1)
        high = 1.3 * high or (1.0 if low == 0 else -0.1 * low)  # room for words
        style.dress(
            each,
            named,
            ylabel=style.broken(label, style.extent(each)[1]),
            xlim=(0, solution.t_end * time),
            ylim=(1.1 * low, high),
        )
    marks: list[Annotation] = []
    episodes, names = drawn.histories[0].episodes, round_trips(solution)
    few = len(gaps) == 1 and len(episodes) <= MARKED_UP_TO
    for k, (_, force_end, opening) in enumerate(episodes if few else ()):
        for on, t, what in (
            (force_ax, force_end, "force ends"),
            (gap_ax, opening, "gap opens"),
        ):
            if not t < np.inf:
                continue
            x = t * time
            for each in (force_ax, gap_ax):
                each.axvline(x, color=faint, linewidth=0.8, linestyle=":", zorder=0)
            left = x > np.mean(on.get_xlim())  # where there is more room
            name = f"{names[t]} = " if t in names else ""
            marks.append(
                on.annotate(
                    f"{what} at {name}{drawn.time.write(t)}",
                    (x, 1.0),
                    (-4 if left else 4, -3 - 11 * k),
                    on.get_xaxis_transform(),
                    "offset points",
                    ha="right" if left else "left",
                    va="top",
                    fontsize=style.SMALL + 1,
                    color=ink,
                )
            )
    return style.Picture(
        ax=force_ax,
        force_ax=force_ax,
        gap_ax=gap_ax,
        forces=forces,
        gaps=gaps,
        marks=marks,
    )


class Forces:
    """Records of contacts, to be drawn together.

    Attributes
    ----------
    histories : list of ContactHistory
    forces : list of (force [n], edges of its steps [n + 1])
        SI values.
    gaps : list of (times, gap at them)
        SI values.
    time, scale : Scale
        Of times and forces; its name says so if some forces are means over a time.
    """

    def __init__(self, solution: Solution, contacts: Sequence[int]) -> None:
        self.histories = [solution.contacts[k] for k in contacts]
        names, self.end = contact_names(solution.system.kinds), solution.t_end
        self.names = [f"contact {names[k]}" for k in contacts]
        self.time, fields, mean = time_scale(self.end), solution.fields, ""
        self.forces, self.gaps = [], []
        for history in self.histories:
            times, force, _ = history.breakpoints()
            if (
                getattr(history.law, "restitution", None) is not None
            ):  # an impact takes no time
                edges: Floats = np.linspace(0.0, self.end, INTERVALS + 1)
                force = np.diff(history.impulse_until(edges)) / np.diff(edges)
                step = max(fields.step, self.end / INTERVALS)
                mean = f",\nmean over {written(step, 's')}"
            else:
                edges, force = steps_until(
                    self.end, times, force, smooth=history.push.size > 1
                )
            gap = history.gap(edges)
            self.forces.append(thinned_steps(edges, force))
            self.gaps.append((edges[telling(gap)], gap[telling(gap)]))
        self.largest = max(float(np.abs(force).max()) for force, _ in self.forces)
        self.scale = engineering(f"contact force{mean}", self.largest, "N")

    def draw(self, ax: Axes, up: bool = False, rows: bool = False) -> list[StepPatch]:
        """Draw the forces against time to the right, or upward, together or in rows."""
        factor = 0.85 / (self.largest or 1.0) if rows else self.scale.factor
        series, drawn = style.colours().series, []
        for i, (force, edges) in enumerate(self.forces):
            colour, base = series[i % len(series)], float(i * rows)
            drawn.append(
                ax.stairs(
                    force * factor + base,
                    edges * self.time.factor,
                    baseline=base,
                    fill=True,
                    facecolor=(colour, 0.15),
                    edgecolor=colour,
                    label=self.names[i],
                    linewidth=1.5,
                    linestyle="-" if rows else style.DASHES[i % len(style.DASHES)],
                    orientation="horizontal" if up else "vertical",
                )
            )
        return drawn

    def draw_rows(self, ax: Axes) -> None:
        """Draw the forces of many contacts one above the other, to one scale."""
        self.draw(ax, rows=True)
        named = evenly(len(self.forces), NAMED_UP_TO)
        ax.set_yticks(named, [self.names[i] for i in named])
        style.dress(
            ax,
            xlim=(0, self.end * self.time.factor),
            ylim=(0, len(self.forces)),
            xlabel=self.time.label,
        )
        ax.set_title(
            f"{self.scale.name}, largest {self.scale.write(self.largest)}",
            loc="left",
            fontsize=style.SMALL + 1,
        )


@style.styled
def gauge(
    record: Gauge, ax: Axes | None = None, transmitted: Gauge | None = None
) -> style.Picture:
    """Draw the record of a strain gauge, its two waves, and its pulses.

    The first wave at the gauge is the incident pulse. The first later wave in the opposite
    direction is the reflected pulse. The first wave at a second gauge, beyond the specimen, is the
    transmitted pulse. The incident pulse lasts while its wave exceeds a hundredth of the largest
    strain of a wave at the gauge. The windows of the other pulses begin at their arrival and are as
    long. Each window is shaded on the side of its sign. A bar that vibrates at t = 0 has no such
    pulses.

    Strain is given in microstrain.

    Parameters
    ----------
    record : Gauge
        From `Solution.gauge`.
    ax : Axes, optional
        By default the Axes of a new figure.
    transmitted : Gauge, optional
        Record of a gauge on the bar beyond the specimen, of the same solution.

    Returns
    -------
    Picture
        With the steps `strain`, `rightward`, `leftward`, and `transmitted` or None; the rectangles
        `windows` of the pulses by name.

    Raises
    ------
    ValueError
        If the duration of the record is 0.

    Examples
    --------
    The pulse of a striker is twice as long as the striker:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bars = [ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0),
    ...         ri.Rod(1.0, area=1e-4, material=steel)]
    >>> picture = ri.plot.gauge(ri.solve(ri.System(bars)).gauge(1, 0.5))
    >>> window = picture.windows["incident"]
    >>> print(f"{window.get_width():.2f} {2e6 * bars[0].transit_time:.2f}")
    79.25 79.25
    """
    records = [record] if transmitted is None else [record, transmitted]
    for each in records:
        of_kind("record", each, Gauge, "solution.gauge(1, 0.5)")
    ax = style.axes(ax, 5.6, 3.0)
    time, scale = time_scale(record.end), Scale(1e6, "strain", "microstrain")

    def steps(of: Gauge, values: Floats, name: str, **how: Any) -> StepPatch:
        smooth = of.record.size > 2  # waves of a grid are drawn state by state
        values, edges = thinned_steps(*steps_until(of.end, of.times, values, smooth))
        return ax.stairs(
            values * scale.factor,
            edges * time.factor,
            baseline=None,
            label=name,
            **{"linewidth": 1.4, **how},
        )

    faint, series = style.colours().faint, style.colours().series
    shades = {"incident": series[0], "reflected": series[1], "transmitted": series[3]}
    width = 5.0 if record.times.size <= BOLD_UP_TO else 2.5
    strain = steps(
        record, record.strain, "strain", color=faint, linewidth=width, zorder=1
    )
    rightward = steps(record, record.rightward, "wave running right", color=series[0])
    leftward = steps(
        record, record.leftward, "wave running left", color=series[1], linestyle="--"
    )
    beyond = (
        None
        if transmitted is None
        else steps(
            transmitted,
            transmitted.strain,
            "transmitted strain",
            color=series[3],
            linestyle="-.",
        )
    )
    ax.axhline(0.0, color=faint, linewidth=0.6, zorder=0)
    low, high = ax.get_ylim()
    style.dress(
        ax,
        xlim=(0, record.end * time.factor),
        ylim=(low, high),
        xlabel=time.label,
        ylabel=scale.label,
    )
    pulses = dict(zip(("incident", "reflected"), _passing(record), strict=True))
    if transmitted is not None:
        pulses["transmitted"] = _passing(transmitted)[0]
    (first, last, _), *others = pulses.values()
    vibrates = any(
        start == 0 for start, *_ in others
    )  # a bar that does has no such pulses
    windows = {
        name: ax.add_patch(
            Rectangle(
                (start * time.factor, 0.0),
                min(last - first, record.end - start) * time.factor,
                high if tension else low,
                color=shades[name],
                alpha=0.18,
                linewidth=0,
                zorder=0,
                label=name,
            )
        )
        for name, (start, _, tension) in pulses.items()
        if start < record.end and not vibrates
    }
    lines = (strain, rightward, leftward, beyond, *windows.values())
    places = listed([f"{r.name} at {place_scale(r.x).write(r.x)}" for r in records])
    style.legend_above(ax, lines, title=f"gauge on {places}")
    return style.Picture(
        ax=ax,
        strain=strain,
        rightward=rightward,
        leftward=leftward,
        transmitted=beyond,
        windows=windows,
    )


def _passing(record: Gauge) -> list[tuple[float, float, bool]]:
    """When each of two waves is more than faint for the first time, the earlier wave first."""
    waves, times = (
        (record.rightward, record.leftward),
        np.append(record.times, record.end),
    )
    least, pulses = FAINTEST * np.abs(waves).max(), []
    for wave in waves:
        strong = np.abs(wave) > least
        first = int(np.append(strong, True).argmax())  # the end if it never is
        after = first + int(np.append(strong[first:], False).argmin())
        pulses.append(
            (
                float(times[first]),
                float(times[after]),
                bool(wave[first:after].sum() > 0),
            )
        )
    return sorted(pulses)
