"""Snapshots: the row at chosen instants, one below the other, as in a textbook figure."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Text

from ..methods.signals import Floats
from ..model import RigidMass, Rod
from ..model.arguments import array
from ..model.frozen import refusal
from ..model.numbering import body_names
from ..results.gauges import Gauge, check_gauges
from ..results.solution import Solution, check_waves
from . import scales, style
from .bars import TOLD, Bars, joined
from .moments import happening, moments
from .placing import placing

BESIDE = (
    0.36  # from the middle of a row to numbers that have no room in a bar, up or down
)
ALIKE = 0.02  # velocities of a stretch that bears one label, in parts of the largest


@style.styled
def snapshots(
    solution: Solution,
    ax: Axes | None = None,
    times: Sequence[float] | Floats | None = None,
    magnification: float | None = None,
    gauges: Mapping[str, Gauge] | None = None,
) -> style.Picture:
    """Draw the row at chosen times, one below the other, coloured by velocity.

    Every uniform piece is labelled with its velocity in the frame of the picture, as a multiple of
    the closing speed v. If no bodies approach each other, the unit is named under the picture.
    Displacements and gaps are magnified as in `spacetime`. Compressed pieces are drawn shorter and
    thicker, stretched pieces longer and thinner. A thick line marks a contact that presses. Small
    triangles above a bar show the direction of a front. Without fronts there is a colour bar, and
    parts of nearly equal velocity are labelled with their mean, to two digits. Rigid masses are
    dark blocks of the width named under the picture, with their velocity below. Fixed ends are
    hatched like walls, absorbing ends are dashed, driven ends have arrow heads.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.
    times : sequence of float, optional
        Times, s; by default start, waves half-way, reflections, events at the contacts, and end.
    magnification : float, optional
        Of displacements and gaps; by default chosen as in `spacetime`.
    gauges : mapping of str to Gauge, optional
        Strain gauges to be marked, by name, as for `gauges_to_csv`.

    Returns
    -------
    Picture
        With `bars`, a polygon for each uniform piece, row by row (without fronts, many pieces to a
        rod, with `outlines` and a `colour_bar`, otherwise None); `times`, `labels`, `fronts`,
        `walls`, which are fixed ends too, and `masses`.

    Raises
    ------
    ValueError
        If a time is outside the solution, `times` is empty, or the magnification is not positive.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> picture = ri.plot.snapshots(solution, times=[0.0, 1e-4])
    >>> bool(picture.ax.figure.get_figwidth() > 0)
    True
    """
    check_waves(solution)
    when = moments(solution) if times is None else array("times", times, "s").ravel()
    if when.size == 0:
        raise refusal("times", "needs at least one time, got none")
    solution.fields.to_ticks(when)  # refuses times outside the solution
    last = float(when.max())
    plan = placing(solution, 0.0, last, magnification)
    place = scales.place_scale(plan.row)
    ax = style.axes(ax, 9.6, 0.9 + 0.72 * when.size)

    drawn = Bars(ax, plan, when, place)
    velocities, stepped, bar = drawn.pieces.velocity, drawn.stepped, None
    norm = style.centred(velocities, plan.frame)
    bars, outlines, fronts = (
        drawn.rods(velocities, norm),
        drawn.outlines(),
        drawn.fronts(),
    )
    walls, masses = drawn.walls(), drawn.masses()
    drawn.marks()
    drawn.gauges(check_gauges(gauges or {}))
    ax.use_sticky_edges = False
    ax.margins(x=0.1 if masses else 0.03)  # room for velocities below masses
    ax.autoscale_view()
    ax.set_ylim(0.45 - when.size, 0.8)
    for i in range(len(solution.system.bodies) - 1):
        ax.axvline(
            float(drawn.end(i, True)[0]),
            color=drawn.colours.faint,
            linewidth=0.6,
            linestyle=(0, (4, 4)),
            zorder=1,
        )

    _name_rows(ax, solution, when)
    largest, closing = float(np.abs(velocities).max()), scales.closing_speed(solution)
    scale = scales.engineering("velocity", largest, "m/s")
    unit = (
        f"closing speed v = {scales.written(closing, 'm/s')}"
        if closing
        else (f"velocities ({scale.unit})")
    )
    ax.set_xlabel(
        "\n".join(
            style.broken(label, style.extent(ax)[0])
            for label in (scales.place_label(plan, place), unit, TOLD)
        )
    )
    if stepped:
        bar = style.colour_bar(
            ax,
            bars,
            scale.label,
            plan.frame,
            location="bottom",
            fraction=0.03,
            aspect=50,
            shrink=0.6,
            format=lambda value, _: scales.digits(value * scale.factor, 0.0),
        )
    style.figure_of(
        ax
    ).draw_without_rendering()  # so that it is known how wide the Axes are

    def write(velocity: float) -> str:  # where it varies along the rods, to hundredths
        part = (velocity - plan.frame * bool(closing)) / (closing or largest or 1.0)
        part = round(part, 2) if stepped else part
        return (
            scales.multiple(part, "v")
            if closing
            else scales.digits(part * largest * scale.factor, largest * scale.factor)
        )

    labels = _labels(drawn, norm, write) + _mass_labels(drawn, write)
    names = body_names(solution.system.kinds)
    for i, body in enumerate(solution.system.bodies):
        wide = plan.widths[i] * place.factor > _width(ax, names[i])
        if wide and isinstance(body, Rod):
            middle = float(plan.middle(i, when[0])) * place.factor
            _write(ax, middle, 0.5, names[i], drawn.colours.ink, "bottom")
    return style.Picture(
        ax=ax,
        times=when,
        bars=bars,
        labels=labels,
        fronts=fronts,
        walls=walls,
        masses=masses,
        outlines=outlines,
        colour_bar=bar,
    )


def _name_rows(ax: Axes, solution: Solution, when: Floats) -> None:
    """To the left of each row its time, to the right what happens then."""
    style.dress(ax)
    time = scales.engineering("time", solution.t_end, "s")
    rod, length = scales.first_rod(solution)
    ax.set_yticks(
        -np.arange(when.size),
        [
            f"{t * time.factor:.4g} {time.unit}\n{t / float(rod.transit_time):.3g} {length}/c"
            for t in when.tolist()
        ],
    )
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    for row, t in enumerate(when.tolist()):
        words = [
            style.broken(line, style.extent(ax)[0] / 3)
            for line in happening(solution, t).splitlines()
        ]
        ax.text(
            1.01,
            -row,
            "\n".join(words),
            transform=ax.get_yaxis_transform(),
            va="center",
            fontsize=style.SMALL + 1,
        )


def _mass_labels(drawn: Bars, write: Callable[[float], str]) -> list[Text]:
    """Velocity of each mass, below it; of every second of neighbours above it."""
    labels, above, times = [], True, drawn.times
    for i, body in enumerate(drawn.system.bodies):
        above = not (above and isinstance(body, RigidMass))
        up, va = (BESIDE, "bottom") if above else (-BESIDE, "top")
        if isinstance(body, RigidMass):
            middle = drawn.plan.middle(i, times) * drawn.place.factor
            speeds = drawn.plan.solution.velocity(i, 0.0, times).tolist()
            labels += [
                _write(drawn.ax, middle[row], up - row, write(v), drawn.colours.ink, va)
                for row, v in enumerate(speeds)
            ]
    return labels


def _labels(drawn: Bars, norm: Any, write: Callable[[float], str]) -> list[Text]:
    """Write the velocity into each piece, or below it where it is too narrow.

    Where velocities vary along the rods, into stretches in which they hardly do, and never below.
    """
    labels: list[Text] = []
    row, taken, ax, pieces = -1, -math.inf, drawn.ax, drawn.pieces
    if drawn.stepped:
        pieces = joined(pieces, ALIKE * float(norm.vmax - norm.vmin) / 2)
    for piece in pieces:
        text = write(piece.velocity)
        width = _width(ax, text)
        x = (piece.left + piece.right) / 2
        if piece.right - piece.left > width:
            labels.append(
                _write(
                    ax,
                    x,
                    float(-piece.row),
                    text,
                    style.ink_on(norm, piece.velocity),
                    "center_baseline",
                )
            )
        elif not drawn.stepped and (row != piece.row or x - width / 2 > taken):
            labels.append(
                _write(ax, x, -piece.row - BESIDE, text, drawn.colours.ink, "top")
            )
            row, taken = piece.row, x + width / 2
    return labels


def _width(ax: Axes, text: str) -> float:
    """Width of a text on the axis of places."""
    points = float(style.extent(ax)[0] / np.ptp(ax.get_xlim()))  # of a unit
    return style.LETTER * (style.SMALL + 1) * (len(text) + 0.5) / points


def _write(ax: Axes, x: float, y: float, text: str, colour: str, va: str) -> Text:
    return ax.text(
        x, y, text, color=colour, ha="center", va=va, fontsize=style.SMALL + 1, zorder=5
    )
