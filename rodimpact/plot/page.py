"""One page about one collision: velocity and stress in space and time, contacts, energy."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import wrap

from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from ..model import RigidMass, Rod, Wall
from ..results.gauges import Gauge
from ..results.solution import Solution, check_solution
from .diagram import spacetime
from .histories import Forces, contact
from .ledger import energy
from .polygons import drawn_until
from .scales import closing_speed, digits, engineering, listed, time_scale, written
from .style import LETTER, NORMAL, SMALL, broken, colours, new_figure, styled, wanted_width

PAGE, COLUMN = (11.7, 8.3), (4.3, 10.8)  # inches; the column has its panels one below the other
NARROW = 5.5  # inches, below which a page is a column
WAVES, CONTACT, ENERGY = 1.5, 1.5, 1.0  # relative heights of panels
TOGETHER = 3  # contacts whose forces and gaps are drawn over each other; more have a line each
NAMED_UP_TO = 6  # bodies whose velocities fit into the headline


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
    waves = any(isinstance(body, Rod) for body in solution.system.bodies)  # masses have none
    figure, panels = _panels(waves, bool(able))
    if waves:
        stop = drawn_until(solution)
        for field in ("velocity", "stress"):
            spacetime(solution, figure.add_subplot(panels.pop(0)), field, stop=stop, gauges=gauges)
    if len(able) > TOGETHER:
        Forces(solution, able).draw_rows(figure.add_subplot(panels.pop(0)))
    elif able:
        both = panels.pop(0).subgridspec(2, 1)
        force_ax = figure.add_subplot(both[0])
        contact(solution, (force_ax, figure.add_subplot(both[1], sharex=force_ax)), able)
        force_ax.tick_params(labelbottom=False)
    energy(solution, figure.add_subplot(panels.pop(0)))
    room = 72 * figure.get_figwidth()
    figure.suptitle(broken(headline(solution), room / 1.3), fontsize=NORMAL + 2,
                    color=colours().ink)
    notes = [] if solution.final else [solution.status]
    if stop < solution.t_end:
        notes.append(f"The upper pictures show the first {written(stop, 's')}; "
                     "a longer interval would have too many regions to be legible.")
    letters = int(room / (LETTER * (SMALL + 1)))
    figure.supxlabel("\n".join(line for note in notes for line in wrap(note, letters)),
                     fontsize=SMALL + 1, color=colours().ink)
    return figure


def _panels(waves: bool, contacts: bool) -> tuple[Figure, list[SubplotSpec]]:
    """A figure with places for two pictures of waves, one of contacts, and one of energy."""
    if wanted_width(PAGE[0]) < NARROW:
        heights = [WAVES] * 2 * waves + [CONTACT] * contacts + [ENERGY]
        figure = new_figure(COLUMN[0], COLUMN[1] * sum(heights) / (2 * WAVES + CONTACT + ENERGY))
        grid = figure.add_gridspec(len(heights), 1, height_ratios=heights)
        return figure, [grid[i, 0] for i in range(len(heights))]
    figure = new_figure(*PAGE)
    grid = figure.add_gridspec(1 + waves, 2, height_ratios=[WAVES] * waves + [ENERGY])
    return figure, [*([grid[0, 0], grid[0, 1]] if waves else []),
                    *([grid[-1, 0], grid[-1, 1]] if contacts else [grid[-1, :]])]


def headline(solution: Solution) -> str:
    """Bodies, closing speed, and results of the collision."""
    bodies = solution.system.bodies
    rods, masses, walls = (sum(isinstance(body, kind) for body in bodies)
                           for kind in (Rod, RigidMass, Wall))
    row = ["One rod" if rods == 1 else f"{rods} rods"]
    row += ["a rigid mass" if masses == 1 else f"{masses} rigid masses"] if masses else []
    row += ["a wall"] if walls == 1 else []
    parts = [listed(row) + (" between two walls" if walls == 2 else "")]
    v, outcome = closing_speed(solution), solution.outcome
    if v:
        parts.append(f"closing speed {written(v, 'm/s')}")
    if not outcome.why_no_restitution():
        parts.append(f"restitution e = {outcome.restitution:.4g}, "
                    f"impulse {written(outcome.impulse, 'N s')}, "
                    f"force duration {written(outcome.duration, 's')}")
    elif solution.final and not any(c.episodes for c in outcome.contacts):
        parts.append("nothing collides")
    elif len(bodies) <= NAMED_UP_TO:
        largest = max(map(abs, outcome.velocities_after))
        scale = engineering("", largest, "m/s")
        values = [digits(v * scale.factor, largest * scale.factor)
                  for v in outcome.velocities_after]
        when = "after" if solution.final else "at the end"
        parts.append(f"velocities {when} {', '.join(values)} {scale.unit}")
    return ", ".join(parts)
