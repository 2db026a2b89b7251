"""A page about a collision: velocity and stress in space and time, contacts, energy."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..model import RigidMass, Rod, Wall
from ..results.gauges import Gauge
from ..results.solution import Solution, check_solution
from .diagram import draft_spacetime
from .histories import ContactCurves, draft_contact
from .labels import break_label, wrap_words
from .ledger import TIMES_OF_PANEL, draft_energy
from .panels import Draft, lay_out, new_figure
from .polygons import drawn_until
from .sampling import rods_of
from .scales import (
    closing_speed,
    engineering,
    joined_by_and,
    number_text,
    quantity_text,
    time_scale,
)
from .style import NORMAL, SMALL, styled, wanted_width

PAGE = (11.7, 8.3)  # inches
COLUMN_WIDTH = 4.3  # width of a page that is one column, inches
MIN_PAGE_WIDTH = 5.5  # inches; narrower pages are columns
LAST_ROW_HEIGHT = 2.1  # height of the last row of a column, inches
DIAGRAM_HEIGHT = 1.5  # height of the rows above the last, in heights of the last
CONTACT_HEIGHT = 1.8  # height of force and gap in a column, in heights of the last row
MAX_GAPS = 3  # contacts up to which gaps are drawn, too, and not only forces
MAX_NAMED_BODIES = 6  # bodies up to which velocities fit into the headline
HEADLINE_WIDTH = 1.3  # width of the headline's letters, in widths of normal letters
KINDS = {
    Rod: ("rod", "rods"),
    RigidMass: ("rigid mass", "rigid masses"),
    Wall: ("wall", "walls"),
}


@styled
def overview(solution: Solution, gauges: Mapping[str, Gauge] | None = None) -> Figure:
    """Draw velocity and stress in space and time, contacts, and energy.

    Up to three contacts are drawn with force and gap, more contacts only with their
    forces, one above the other; only contacts that can open are drawn. A row without
    rods has no pictures in space and time. If these pictures end before the solution,
    since it has very many regions, a note says so. The page makes its own figure and
    takes no Axes.

    Parameters
    ----------
    solution : Solution
    gauges : mapping of str to Gauge, optional
        Strain gauges to draw in space and time, by name.

    Returns
    -------
    Figure
        It has the size of a page, 11.7 by 8.3 inches, or is a column if `look` asks for
        less than 140 mm; write it with `save`.

    Raises
    ------
    ValueError
        If the duration of the solution is 0, or `gauges` is not a mapping of names to
        gauges.

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
    time_scale(solution.t_end)  # raises ValueError if the duration is 0

    # What is shown.
    contacts = solution.outcome.unilateral
    is_crowded = len(contacts) > MAX_GAPS
    has_waves = bool(rods_of(solution.system))
    stop = solution.t_end
    if has_waves:
        stop = drawn_until(solution)

    # Where it is shown.
    panels_wanted: list[Any] = []
    if has_waves:
        panels_wanted += ["velocity", "stress"]
    if is_crowded:
        panels_wanted.append("force")
    elif contacts:
        panels_wanted.append([["force"], ["gap"]])
    panels_wanted.append("energy")
    figure, panels = _page(panels_wanted)

    # What is drawn.
    drafts: list[Draft] = []
    if has_waves:
        for field in ("velocity", "stress"):
            ax = panels[field]
            draft = draft_spacetime(solution, ax, field, stop=stop, gauges=gauges)
            drafts.append(draft)
    if is_crowded:
        ContactCurves(solution, contacts).draw_rows(panels["force"])
    elif contacts:
        panels["gap"].sharex(panels["force"])
        pair = (panels["force"], panels["gap"])
        drafts.append(draft_contact(solution, pair, contacts))
        panels["force"].tick_params(labelbottom=False)
    drafts.append(draft_energy(solution, panels["energy"], TIMES_OF_PANEL))
    room = 72 * figure.get_figwidth()
    title = break_label(headline(solution), room / HEADLINE_WIDTH)
    figure.suptitle(title, fontsize=NORMAL + 2)
    notes = [wrap_words(note, room, SMALL + 1) for note in _notes(solution, stop)]
    figure.supxlabel("\n".join(notes), fontsize=SMALL + 1)
    lay_out(figure)
    for draft in drafts:
        draft.write_words()
    return figure


def _page(wanted: list[Any]) -> tuple[Figure, dict[str, Axes]]:
    """A new page of two columns, or of one if it is narrow, and its Axes by name.

    `wanted` has the names of the panels in order, in the form of `subplot_mosaic`: a
    list [["force"], ["gap"]] stands for panels one above the other. The last panel
    fills the last row. A page is narrow if `look` asks for less than `MIN_PAGE_WIDTH`.
    """
    columns = 2
    if wanted_width(PAGE[0]) < MIN_PAGE_WIDTH:
        columns = 1
    if len(wanted) % columns:  # an odd number: the last panel takes both columns
        wanted = [*wanted, wanted[-1]]
    rows = [wanted[i : i + columns] for i in range(0, len(wanted), columns)]
    heights = [DIAGRAM_HEIGHT] * (len(rows) - 1) + [1.0]
    if columns == 1:
        for k, (panel,) in enumerate(rows):
            if isinstance(panel, list):  # force and gap of a contact
                heights[k] = CONTACT_HEIGHT
    if columns == 2:
        figure = new_figure(*PAGE)
    else:
        height = LAST_ROW_HEIGHT * sum(heights)
        figure = new_figure(COLUMN_WIDTH, height)
    return figure, figure.subplot_mosaic(rows, height_ratios=heights)


def _notes(solution: Solution, stop: float) -> list[str]:
    """Notes below the page; [] for a final solution that is shown until its end.

    One says why a run stopped whose outcome is not final, the other how much is shown
    if the pictures end at `stop`, s, before the end.
    """
    notes = []
    if not solution.final:
        notes.append(solution.status)
    if stop < solution.t_end:
        notes.append(
            f"The upper pictures show the first {quantity_text(stop, 's')}; "
            "a longer interval would have too many regions to be legible."
        )
    return notes


def headline(solution: Solution) -> str:
    """Bodies, closing speed, and results of the collision, in one line.

    The results are e, impulse and force duration. Without an e they are "nothing
    collides", or the velocities of all bodies if there are at most `MAX_NAMED_BODIES`,
    else none.
    """
    outcome = solution.outcome
    has_pressed = any(contact.episodes for contact in outcome.contacts)
    parts = [_bodies(solution)]
    speed = closing_speed(solution)
    if speed:
        parts.append(f"closing speed {quantity_text(speed, 'm/s')}")
    if not outcome.why_no_restitution():  # no reason against: e is known
        parts.append(f"restitution e = {outcome.restitution:.4g}")
        parts.append(f"impulse {quantity_text(outcome.impulse, 'N s')}")
        parts.append(f"force duration {quantity_text(outcome.duration, 's')}")
    elif solution.final and not has_pressed:
        parts.append("nothing collides")
    elif len(solution.system.bodies) <= MAX_NAMED_BODIES:
        parts.append(_velocities(solution))
    return ", ".join(parts)


def _bodies(solution: Solution) -> str:
    """How many rods, masses and walls there are, such as "2 rods and 1 wall".

    Kinds that the row does not have are left out.
    """
    parts = []
    for kind, (singular, plural) in KINDS.items():
        count = sum(isinstance(body, kind) for body in solution.system.bodies)
        if count == 1:
            parts.append(f"1 {singular}")
        elif count > 1:
            parts.append(f"{count} {plural}")
    return joined_by_and(parts)


def _velocities(solution: Solution) -> str:
    """Velocities of all bodies at the end as a text, in the unit of the largest.

    It begins with "velocities after" if the solution is final, else with "velocities at
    the end".
    """
    velocities = solution.outcome.velocities_after
    largest = max(map(abs, velocities))
    scale = engineering("", largest, "m/s")
    values = []
    for velocity in velocities:
        values.append(number_text(velocity * scale.factor, largest * scale.factor))
    when = "after" if solution.final else "at the end"
    return f"velocities {when} {', '.join(values)} {scale.unit}"
