"""One page about one collision: velocity and stress in space and time, contacts, energy."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecBase

from ..model import RigidMass, Rod, Wall
from ..results.gauges import Gauge
from ..results.solution import Solution, check_solution
from .diagram import spacetime
from .histories import contact, draw_row_of_forces
from .ledger import energy
from .polygons import drawn_until
from .scales import closing_speed, digits, engineering, listed, time_scale, written
from .style import NORMAL, SMALL, colours, new_figure, styled

TOGETHER = 3  # contacts whose forces and gaps are drawn over each other; more have a line each
NAMED_UP_TO = 6  # bodies whose velocities fit into the headline


@styled
def overview(solution: Solution, gauges: Mapping[str, Gauge] | None = None) -> Figure:
    """Draw velocity and stress in space and time, contacts, and energy.

    Of up to three contacts force and gap are drawn, of more the forces, one above the other.

    Its many Axes are arranged on a figure of its own, so it takes none.

    Parameters
    ----------
    solution : Solution
    gauges : mapping of str to Gauge, optional
        Stations to draw in space and time, by name.

    Returns
    -------
    Figure
        Of the size of a page, 11.7 by 8.3 inches; write it with `save`.

    Raises
    ------
    ValueError
        If the solution lasts no time, or `gauges` are no gauges by name.
    """
    check_solution(solution)
    time_scale(solution.t_end)  # refuses what lasts no time
    figure = new_figure(11.7, 8.3)
    halves = figure.add_gridspec(2, 1, height_ratios=(1.5, 1.0))
    upper = halves[0].subgridspec(1, 2)
    lower: GridSpecBase = halves[1].subgridspec(2, 2)
    stop = solution.t_end
    if any(isinstance(body, Rod) for body in solution.system.bodies):
        stop = drawn_until(solution)
        for column, field in enumerate(("velocity", "stress")):
            spacetime(solution, figure.add_subplot(upper[column]), field, stop=stop, gauges=gauges)
    else:  # masses have no waves
        lower = figure.add_gridspec(2, 2)
    able_to_open = solution.outcome.unilateral
    if len(able_to_open) > TOGETHER:
        draw_row_of_forces(figure.add_subplot(lower[:, 0]), solution, able_to_open)
    elif able_to_open:
        force_ax = figure.add_subplot(lower[0, 0])
        contact(solution, (force_ax, figure.add_subplot(lower[1, 0], sharex=force_ax)),
                able_to_open)
    energy(solution, figure.add_subplot(lower[:, 1 if able_to_open else slice(None)]))
    figure.suptitle(headline(solution), fontsize=NORMAL + 3, color=colours().ink)
    notes = [] if solution.final else [solution.status]
    if stop < solution.t_end:
        notes.append(f"The upper pictures show the first {written(stop, 's')}; "
                     "later ones would have too many regions to be read.")
    figure.supxlabel("\n".join(notes), fontsize=SMALL + 1, color=colours().ink)
    return figure


def headline(solution: Solution) -> str:
    """What collided, how fast, and with what result."""
    bodies = solution.system.bodies
    walls = sum(isinstance(body, Wall) for body in bodies)
    masses = sum(isinstance(body, RigidMass) for body in bodies)
    rods = len(bodies) - walls - masses
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
