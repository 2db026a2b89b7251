"""Space-time diagram: where every piece of rod is at every time, coloured by its state.

`polygons` or `raster` has the coloured regions, `borders` everything that bounds the
rods, `plane` the two axes; here they are put together.
"""

from collections.abc import Mapping

import numpy as np
from matplotlib import artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..model import Absorbing
from ..model.arguments import check_choice, check_flag
from ..model.frozen import invalid_argument
from ..results.gauges import Gauge, check_gauges
from ..results.solution import Solution, check_has_rod
from .borders import Borders, ContactLines, Cut, apart_style, open_end_style
from .labels import legend_above
from .layout import PictureLayout, choose_layout
from .panels import Draft, Picture, add_colour_bar, axes_or_new, finish
from .plane import Plane, Span
from .polygons import Polygons
from .raster import Raster
from .sampling import is_smooth
from .scales import FIELDS, Scale, axis_scales, field_scale, quantity_text
from .style import centred, styled


@styled
def spacetime(
    solution: Solution,
    ax: Axes | None = None,
    field: str = "velocity",
    dimensionless: bool = False,
    start: float = 0.0,
    stop: float | None = None,
    *,
    magnification: float | None = None,
    coordinates: str = "body",
    across: bool = False,
    gauges: Mapping[str, Gauge] | None = None,
) -> Picture:
    """Draw where every piece of rod is at every time, coloured by its state.

    Each polygon is a region of constant velocity and strain with its exact corners. The
    thin lines between them are wave fronts, darker where the velocity jumps more; if
    they are few, each is named by what it adds to the stress, compression or tension. A
    solution without fronts has flat cells instead, each with the average over its time;
    cells and displacements are pixels in SVG and PDF.

    In material coordinates (``"body"``) rods are laid end to end and nothing moves: all
    fronts of one wave speed are parallel. Ticks show the ends of the rods, their
    lengths, and the instants after whole round trips at which a force ends or a gap
    opens. In laboratory coordinates (``"lab"``) the bodies move. Displacements and gaps
    are magnified by the factor named under the picture; fronts are curved because
    bodies move. Springs are drawn at compliant contacts, and dashed paths for the
    centres of mass. A row that drifts much farther than it deforms is drawn in a moving
    frame, whose speed is named there. A thick line marks a contact that presses, a thin
    line a rigid contact without force, a double line an open gap. Rigid masses are
    strips of the width named under the picture. Fixed ends are hatched like walls,
    absorbing ends are dashed, driven ends have arrow heads.

    Parameters
    ----------
    solution : Solution
    ax : Axes, optional
        By default the Axes of a new figure.
    field : str
        ``"velocity"``, ``"stress"`` or ``"strain"``, both positive in tension,
        ``"displacement"``, or ``"energy"``, kinetic and strain energy per length.
    dimensionless : bool
        Divide times by l1/c and positions by l1, the transit time and length of the
        first rod; velocities by the closing speed v0, stresses by rho c v0, strains by
        v0/c, displacements by l1 v0/c, energies by rho A v0^2 of the first rod.
    start, stop : float
        Interval of time, s; by default the whole solution.
    magnification : float, optional
        Magnification of displacements and gaps in the laboratory; by default 1, 2 or 5
        times a power of ten that shows them well.
    coordinates : "body" or "lab"
    across : bool
        Whether the axis of time is horizontal and that of x vertical, instead of the
        other way round.
    gauges : mapping of str to Gauge, optional
        Strain gauges to draw, by name, as for `gauges_to_csv`.

    Returns
    -------
    Picture
        With `regions`, polygons of constant state, triangles between whose corners
        displacements are linear, or the flat cells [time, x] of a solution without
        fronts, masked between the rods; collections of the `ends` of the rods,
        of contacts `pressing`, `touching` and `apart`; lists of `walls`, which are
        fixed ends too, `masses`, `labels`, `gauges` and `centres`; `colour_bar`; and
        `scale`, which makes its numbers from SI values.

    Raises
    ------
    ValueError
        If a gauge is not a Gauge, the field or the coordinates are unknown, the
        interval is empty, or there are more than 100 000 regions; if the magnification
        is not positive or is given for ``"body"`` coordinates; if `dimensionless` is
        true and no bodies approach each other.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> picture = ri.plot.spacetime(solution, field="stress")
    >>> len(picture.regions.get_paths()) == len(ri.regions_of(solution).body)
    True
    """
    draft = draft_spacetime(
        solution,
        ax,
        field,
        start=start,
        stop=stop,
        dimensionless=dimensionless,
        magnification=magnification,
        coordinates=coordinates,
        across=across,
        gauges=gauges,
    )
    return finish(draft)


def draft_spacetime(
    solution: Solution,
    ax: Axes | None,
    field: str,
    *,
    start: float = 0.0,
    stop: float | None = None,
    dimensionless: bool = False,
    magnification: float | None = None,
    coordinates: str = "body",
    across: bool = False,
    gauges: Mapping[str, Gauge] | None = None,
) -> Draft:
    """Draft of `spacetime`, with the same parameters: all but words and numbers.

    Its regions are polygons between fronts, or the cells of a smooth solution. Wrong
    arguments are refused as by `spacetime`.
    """
    check_has_rod(solution)
    check_choice("field", field, FIELDS)
    check_choice("coordinates", coordinates, ("lab", "body"))
    check_flag("dimensionless", dimensionless)
    check_flag("across", across)
    stations: Mapping[str, Gauge] = {}
    if gauges is not None:
        stations = check_gauges(gauges)
    if coordinates == "body" and magnification is not None:
        raise invalid_argument(
            "magnification",
            'nothing moves in coordinates="body"; leave it out, or give '
            'coordinates="lab"',
        )

    # What is measured: regions with values, and where the row is in the picture.
    cut: Cut
    if is_smooth(solution):
        cut = Raster(solution, start, stop)
    else:
        cut = Polygons(solution, start, stop)
    if stop is None:
        stop = solution.t_end
    layout = choose_layout(
        solution, start, stop, magnification, still=coordinates == "body"
    )
    values = cut.values(field, layout.frame)
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    scale = field_scale(solution, field, dimensionless, max(abs(low), abs(high)))
    scale = _with_frame(scale, field, layout)
    scale = _with_average(scale, field, cut)
    reference = 0.0  # value in the middle of the colours, on the scale
    if field == "velocity":
        reference = layout.frame * scale.factor

    # What is drawn.
    if across:
        ax = axes_or_new(ax, width=6.6, height=4.4)
    else:
        ax = axes_or_new(ax, width=5.6, height=5.2)
    scales = axis_scales(
        solution, dimensionless, duration=stop, width=layout.row_length
    )
    plane = Plane(ax, layout, scales, Span(start, stop), across)
    norm = centred([low * scale.factor, high * scale.factor], reference)
    regions = cut.draw(plane, values * scale.factor, norm)
    borders = Borders(plane, cut)
    walls = borders.walls()
    ends = borders.ends()
    contacts = borders.contacts()
    masses = borders.masses()
    joints = borders.joints()
    drives = borders.drives()
    springs = borders.springs()
    paths = borders.gauges(stations)
    centres = borders.centres()
    plane.format()
    bar = add_colour_bar(ax, regions, scale.label, reference)

    # The legend has only the first of several artists with one name.
    named = _named_contacts(contacts)
    for kind in (springs, masses, joints):
        named += kind[:1]
    named += [*drives, *centres[:1]]
    if any(isinstance(end, Absorbing) for end in solution.system.ends):
        named.append(Line2D([], [], label="absorbing end", **open_end_style()))
    legend_above(ax, named)

    picture = Picture(
        ax=ax,
        regions=regions,
        ends=ends,
        pressing=contacts.pressing,
        touching=contacts.touching,
        apart=contacts.apart,
        walls=walls,
        labels=[],
        colour_bar=bar,
        masses=masses,
        scale=scale,
        gauges=paths,
        centres=centres,
    )

    def write_words() -> None:
        """Fit labels and legend to the final size; write words and numbers."""
        plane.fit_labels()
        legend_above(ax, named)
        picture.labels = cut.write()

    return Draft(picture, write_words)


def _named_contacts(contacts: ContactLines) -> list[artist.Artist]:
    """Legend entries of those of the three kinds of contact lines that are not empty.

    Pressing and touching lines are entries themselves. The double lines of contacts
    that are apart have a single line of this style as entry, because a legend does not
    draw a collection with two colours.
    """
    named: list[artist.Artist] = []
    for lines in (contacts.pressing, contacts.touching):
        if lines.get_segments():
            named.append(lines)
    if contacts.apart.get_segments():
        named.append(Line2D([], [], label="apart", **apart_style()))
    return named


def _with_average(scale: Scale, field: str, cut: Cut) -> Scale:
    """The scale with a line "mean over ..." in its name if its values are averages.

    They are those of a raster whose cells last longer than a tick: a short peak is
    higher than such an average. Displacements and values of polygons are no averages;
    their scale is returned as it is.
    """
    if not isinstance(cut, Raster) or field == "displacement":
        return scale
    if cut.averaged_over == 0:
        return scale
    average = quantity_text(cut.averaged_over, "s")
    return scale._replace(name=f"{scale.name}\nmean over {average}")


def _with_frame(scale: Scale, field: str, layout: PictureLayout) -> Scale:
    """The scale of displacements or energies with the moving frame in its name.

    The scale of another field, or in a frame at rest, is returned as it is.
    """
    if not layout.frame or field not in ("displacement", "energy"):
        return scale
    frame = quantity_text(layout.frame, "m/s")
    return scale._replace(name=f"{scale.name}\nin a frame moving at {frame}")
