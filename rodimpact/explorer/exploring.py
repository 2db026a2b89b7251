"""Explore a collision: a page in one file, for a notebook, a browser or a handout."""

import html
import os
import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from ..hints import explain_arguments, explain_missing
from ..methods.fronts.family_layout import lay_out_family
from ..methods.registry import Options
from ..methods.row_builder import build_row
from ..methods.run import MAX_EVENTS
from ..methods.states import Stop
from ..model import System
from ..model.arguments import check_flag
from ..model.frozen import InvalidModel, defaults_of, invalid_argument
from ..storage.casefile import Case, parse_case
from ..storage.writing import PathLike, check_ending, write_text
from ..units import shown
from ..version import __version__
from .design import LIBRARY, tables_of, with_gauges
from .fronts import new_run, run_to_end, solve_by_fronts
from .page_files import standalone
from .presets import presets
from .tables import is_smooth, lacking, request_of, system_of

FRAME_STYLE = "width: 100%; height: 58rem; border: 0"
"""Style of the frame of the page in a notebook."""
REMEDY = "rodimpact animate CASE.toml -o FILE.gif makes a moving picture"
"""Way to see a collision that the page cannot solve."""
DEFAULT_TITLE = "Elastic rods collide"


def check_page_name(path: Any) -> None:
    """Raise InvalidModel unless the name of a file ends in ``.html`` or ``.htm``."""
    remedy = "a figure is drawn by plot.save(plot.overview(solution), path)"
    check_ending(path, (".html", ".htm"), remedy)


@explain_missing()
class Page:
    """A page with sliders for a collision: one file, made by `explore`.

    A notebook shows the page. The page solves the collision of its sliders, and needs
    no network. With the extra ``notebook`` (``pip install 'rodimpact[notebook]'``) a
    page in a notebook also returns the system of its sliders: see `system`.

    Attributes
    ----------
    html : str
        The page.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> page = ri.explore(ri.System([left, right]))
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    >>> page.system.bodies[0].length
    0.4
    """

    def __init__(self, html: str, system: System) -> None:
        """Take the text of the page, and the system with which it begins."""
        self.html = html
        self._system = system
        self._widget: Any = None  # made when a notebook first shows the page

    def __repr__(self) -> str:
        kilobytes = len(self.html.encode()) / 1000
        ways = "save(FILE.html) writes it, open() opens it in the browser"
        return f"<Page: {kilobytes:.0f} kB; {ways}>"

    @property
    def system(self) -> System:
        """The system that the page shows.

        In a notebook with the extra ``notebook`` this is the system of the sliders. An
        invalid entry, such as a length below 0, is ignored until it is corrected.
        Without the extra, and outside a notebook, this is the system from which the
        page was made.
        """
        if self._widget is None or self._widget.case == "":
            return self._system
        return parse_case(self._widget.case).system

    def save(self, path: PathLike, *, force: bool = False) -> None:
        """Write the page.

        Parameters
        ----------
        path : path-like
            Name of the file, which ends in ``.html`` or ``.htm``.
        force : bool
            Whether an existing file is replaced.

        Raises
        ------
        InvalidModel
            For any other ending.
        FileExistsError
            If the file is there and `force` is false.
        """
        check_page_name(path)
        write_text(path, self.html, force=force)

    def open(self, browser: bool = True) -> str:
        """Write the page to a temporary file, which stays, and open it.

        Parameters
        ----------
        browser : bool
            Whether a browser opens the file.

        Returns
        -------
        str
            Path of the file.
        """
        check_flag("browser", browser)
        path = Path(tempfile.mkdtemp(prefix="rodimpact-"), "collision.html")
        self.save(path)
        if browser:
            webbrowser.open(path.as_uri())
        return str(path)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """What a notebook shows, by MIME type: a widget, or the frame of `_repr_html_`.

        The widget is made at the first call and kept; from it the system of the sliders
        is read. Without the package anywidget the result is the frame, and a text.
        """
        if self._widget is None:
            try:
                from .notebook import PageWidget
            except ModuleNotFoundError:
                return {"text/html": self._repr_html_(), "text/plain": repr(self)}
            self._widget = PageWidget(page=self.html)
        return self._widget._repr_mimebundle_(**options)

    def _repr_html_(self) -> str:
        """HTML of a frame for a notebook, with the whole page as its content."""
        page = html.escape(self.html)
        return (
            f'<iframe srcdoc="{page}" style="{FRAME_STYLE}" title="{DEFAULT_TITLE}">'
            "</iframe>"
        )


@explain_arguments
def explore(case: System | Case) -> Page:
    """Make a page with sliders for a collision.

    The page shows sliders, the space-time diagram, and the rods in motion. While a
    slider moves, the page solves uniform and stepped rods and rigid masses, in rigid,
    bonded or compliant contact. `rodimpact.plot.animation` shows all other collisions.
    A case without gauges gets one in the middle of its last rod.

    Parameters
    ----------
    case : System or Case
        One collision, no family, with at least one rod.

    Returns
    -------
    Page
        A notebook shows it; `Page.open` opens it in the browser, `Page.save` writes it.
        In a notebook with the extra ``notebook``, `Page.system` is the system of the
        sliders.

    Raises
    ------
    InvalidModel
        If the argument is no such case, the page cannot solve it, or its run lasts no
        time.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> page = ri.explore(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> len(page.html) < 200_000
    True
    """
    if isinstance(case, System):
        case = Case(case)
    if not isinstance(case, Case):
        raise invalid_argument("case", f"must be a System or a Case, got {shown(case)}")
    case = with_gauges(case)
    design = tables_of(case)
    check_solvable(case, design["case"])
    embedded: dict[str, Any] = {
        "version": __version__,
        "design": design,
        "materials": LIBRARY,
        "presets": preset_tables(),
    }
    # The name of a file may have bytes that are no text.
    title = os.fsencode(Path(case.path).stem).decode(errors="replace")
    if not title:
        title = DEFAULT_TITLE
    return Page(standalone(embedded, title), case.system)


def preset_tables() -> list[dict[str, Any]]:
    """Presets as dictionaries for the page, in the order of `presets`.

    Each has the ``key``, ``title`` and ``remark`` of the preset, and as ``design`` the
    `tables_of` its case.
    """
    tables = []
    for preset in presets():
        tables.append(
            {
                "key": preset.key,
                "title": preset.title,
                "remark": preset.remark,
                "design": tables_of(preset.case),
            }
        )
    return tables


def check_solvable(case: Case, tables: dict[str, Any]) -> None:
    """Raise InvalidModel if the page cannot solve a case, with the path of the cause.

    These are physics that the page lacks, wrong options, and, if fronts solve the case,
    a collision that has no solution on the page, or whose run hits a limit of the page.
    To find the latter, the collision is solved by the code of the page, in Python.

    Parameters
    ----------
    case : Case
    tables : dict
        Tables of the case, from `tables_of`.
    """
    # Physics comes first: an option that it needs would be given in vain.
    path, physics = lacking(tables)
    if physics:
        raise invalid_argument(path, f"the page cannot solve {physics}; {REMEDY}")
    check_options(case)
    if is_smooth(tables):  # the page itself tells when characteristics take too long
        return
    request = request_of(tables)
    system = system_of(tables, LIBRARY)
    solution = solve_by_fronts(system, request)
    if "problem" in solution:
        path, message = solution["problem"]
        raise invalid_argument(path, f"{message} {solution['advice']}".strip())
    # The solution does not tell which limit its run hit, so the page's run is repeated.
    run = new_run(lay_out_family(build_row(system)))
    run_to_end(request, run_past_proof=True, run=run)
    stop_reason = run.record.stop_reason
    # Otherwise the user's own cap stops the run, which is no fault.
    is_cap_of_page = request.max_events < case.solve.get("max_events", MAX_EVENTS)
    limit = ""
    if stop_reason == Stop.CLOCK:
        limit = "the clock of the page ends before the collision"
    elif stop_reason == Stop.CAP and is_cap_of_page:
        limit = f"the page follows {request.max_events} arrivals of waves at most"
    if limit:
        raise invalid_argument("solve", f"{limit}; give an earlier until=, or {REMEDY}")


def check_options(case: Case) -> None:
    """Raise InvalidModel for the wrong options of a case, and for a wrong method.

    In the error, paths of options begin with ``solve.``, as in a case file.
    """
    try:
        Options(**case.solve).method_for(case.system)
    except InvalidModel as error:
        problems = []
        for path, message in error.problems:
            if path in defaults_of(Options):
                path = f"solve.{path}"
            problems.append((path, message))
        raise InvalidModel(problems) from None
