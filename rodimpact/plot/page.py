"""One page about one collision: velocity and stress in space and time, contacts, energy."""

from collections.abc import Mapping
from textwrap import wrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..model import RigidMass, Rod, Wall
from ..results.gauges import Gauge
from ..results.solution import Solution, check_solution
from .diagram import spacetime
from .histories import Forces, contact
from .ledger import energy
from .polygons import drawn_until
from .scales import closing_speed, digits, engineering, listed, time_scale, written
from .style import LETTER, NORMAL, SMALL, broken, new_figure, styled, wanted_width

PAGE, COLUMN = (11.7, 8.3), 4.3  # inches; a column has its panels one below the other
NARROW = 5.5  # inches, below which a page is a column
ROW = 1.96  # height of the lowest row of a column, inches
TALLER = 1.5  # of the rows above it, relatively
TOGETHER = (
    3  # contacts whose forces and gaps are drawn over each other; more have a line each
)
NAMED_UP_TO = 6  # bodies whose velocities fit into the headline
KINDS = {
    Rod: ("rod", "rods"),
    RigidMass: ("rigid mass", "rigid masses"),
    Wall: ("wall", "walls"),
}


@styled
def overview(solution: Solution, gauges: Mapping[str, Gauge] | None = None) -> Figure:
    """Draw velocity and stress in space and time, contacts, and energy.

    For up to three contacts force and gap are drawn, for more contacts only the forces, one above
    the other. The page makes its own figure and takes no Axes.

    Parameters
    ----------
    solution : Solution
    gauges : mapping of str to Gauge, optional
        Strain gauges to draw in space and time, by name.

    Returns
    -------
    Figure
        Of the size of a page, 11.7 by 8.3 inches, or a column if `look` asks for less than 140 mm;
        write it with `save`.

    Raises
    ------
    ValueError
        If the duration of the solution is 0, or `gauges` is not a mapping of names to gauges.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> len(ri.plot.overview(solution).axes) > 3
    True
    """
    check_solution(solution)
    time_scale(solution.t_end)  # refuses what lasts no time
    able, stop = solution.outcome.unilateral, solution.t_end
    waves = any(
        isinstance(body, Rod) for body in solution.system.bodies
    )  # masses have none
    many = len(able) > TOGETHER
    contacts: list[Any] = ["force" if many else [["force"], ["gap"]]] if able else []
    names = [*["velocity", "stress"] * waves, *contacts, "energy"]
    columns = 1 if wanted_width(PAGE[0]) < NARROW else 2
    names += names[-1:] * (
        len(names) % columns
    )  # the energy is below, or in the last row
    rows = [names[i : i + columns] for i in range(0, len(names), columns)]
    heights = [*[TALLER] * (len(rows) - 1), 1.0]
    figure = new_figure(*PAGE if columns == 2 else (COLUMN, ROW * sum(heights)))
    panels: dict[str, Axes] = figure.subplot_mosaic(rows, height_ratios=heights)
    if waves:
        stop = drawn_until(solution)
        for field in ("velocity", "stress"):
            spacetime(solution, panels[field], field, stop=stop, gauges=gauges)
    if many:
        Forces(solution, able).draw_rows(panels["force"])
    elif able:
        panels["gap"].sharex(panels["force"])
        contact(solution, (panels["force"], panels["gap"]), able)
        panels["force"].tick_params(labelbottom=False)
    energy(solution, panels["energy"])
    room = 72 * figure.get_figwidth()
    figure.suptitle(broken(headline(solution), room / 1.3), fontsize=NORMAL + 2)
    notes = [] if solution.final else [solution.status]
    if stop < solution.t_end:
        notes.append(
            f"The upper pictures show the first {written(stop, 's')}; "
            "a longer interval would have too many regions to be legible."
        )
    letters = int(room / (LETTER * (SMALL + 1)))
    figure.supxlabel(
        "\n".join(line for note in notes for line in wrap(note, letters)),
        fontsize=SMALL + 1,
    )
    return figure


def headline(solution: Solution) -> str:
    """Bodies, closing speed, and results of the collision."""
    bodies = solution.system.bodies
    counts = {kind: sum(isinstance(body, kind) for body in bodies) for kind in KINDS}
    parts = [listed([f"{n} {KINDS[kind][n > 1]}" for kind, n in counts.items() if n])]
    v, outcome = closing_speed(solution), solution.outcome
    if v:
        parts.append(f"closing speed {written(v, 'm/s')}")
    if not outcome.why_no_restitution():
        parts.append(
            f"restitution e = {outcome.restitution:.4g}, "
            f"impulse {written(outcome.impulse, 'N s')}, "
            f"force duration {written(outcome.duration, 's')}"
        )
    elif solution.final and not any(c.episodes for c in outcome.contacts):
        parts.append("nothing collides")
    elif len(bodies) <= NAMED_UP_TO:
        largest = max(map(abs, outcome.velocities_after))
        scale = engineering("", largest, "m/s")
        values = ", ".join(
            digits(v * scale.factor, largest * scale.factor)
            for v in outcome.velocities_after
        )
        when = "after" if solution.final else "at the end"
        parts.append(f"velocities {when} {values} {scale.unit}")
    return ", ".join(parts)
