"""Explore a collision: a page in one file, for a notebook, a browser or a handout."""

import html
import json
import os
import tempfile
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..methods.abilities import driven
from ..methods.fronts.family_layout import lay_out_family
from ..methods.laws import Stop
from ..methods.walk import walk
from ..model import System
from ..model.frozen import InvalidModel
from ..results.solution import Solution
from ..running.solving import solve
from ..storage.casefile import Case
from ..storage.writing import PathLike, write_text
from ..units import shown
from ..version import __version__
from .design import LIBRARY, tables_of, with_gauges
from .fronts import motion_of, run_of, space_of
from .page_files import packed, standalone
from .presets import presets
from .scene import scene
from .tables import RULES, asked_of, is_smooth, lacking, system_of

FRAME = "width: 100%; height: 58rem; border: 0"


class Page:
    """A collision to play with in a browser: one file, made by `explore`.

    A notebook shows it. The page solves what its sliders say, and asks no network for anything.

    Attributes
    ----------
    html : str
        The page.
    solution : Solution or None
        Solved by Python where the page cannot solve the collision by itself: the page shows it.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> page = ri.explore(ri.System([left, right]))
    >>> page.html.startswith("<!DOCTYPE html>"), page.solution
    (True, None)
    """

    def __init__(self, html: str, solution: Solution | None) -> None:
        self.html, self.solution = html, solution

    def save(self, path: PathLike, *, force: bool = False) -> None:
        """Write the page.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
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
            The path of the file.
        """
        path = Path(tempfile.mkdtemp(prefix="rodimpact-"), "collision.html")
        self.save(path)
        if browser:
            webbrowser.open(path.as_uri())
        return str(path)

    def _repr_html_(self) -> str:
        inside = html.escape(self.html)
        return f'<iframe srcdoc="{inside}" style="{FRAME}" title="Elastic rods collide"></iframe>'


def explore(case: System | Case) -> Page:
    """Make a page to play with a collision: sliders, the space-time diagram, the rods moving.

    The page solves uniform and stepped rods and rigid masses, in rigid, bonded or compliant
    contact, while its sliders move. A collision that it cannot solve, such as one with damping, is
    solved here once; the page then shows that solution.

    Parameters
    ----------
    case : System or Case
        Of one collision, no family, with a rod at least.

    Returns
    -------
    Page
        A notebook shows it; `Page.open` opens it in the browser, `Page.save` writes it.

    Raises
    ------
    InvalidModel
        If it is no such case, cannot be solved, or lasts no time to show.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> page = ri.explore(ri.System([left, ri.Rod(1.0, area=1e-4, material=steel)]))
    >>> len(page.html) < 200_000, page.solution is None
    (True, True)
    """
    return page_of(case, solve)


def page_of(case: System | Case, solver: Callable[..., Solution]) -> Page:
    """The page of `explore`; `solver` as `rodimpact.solve`."""
    case = Case(case) if isinstance(case, System) else case
    if not isinstance(case, Case):
        raise InvalidModel([("case", f"must be a System or a Case, got {shown(case)}")])
    case = with_gauges(case)
    begin: dict[str, Any] = {
        "version": __version__,
        "design": tables_of(case),
        "materials": LIBRARY,
        "rules": RULES,
        "presets": [
            {"key": key, "title": title, "remark": remark, "design": tables_of(first)}
            for key, title, remark, first in presets()
        ],
        "scene": None,
    }
    solution = None
    if not page_solves(begin["design"]["case"]):
        solution = solver(case.system, **case.solve)
        begin["scene"] = packed(json.dumps(scene(case, solution), allow_nan=False))
    title = (
        os.fsencode(Path(case.path).stem).decode(errors="replace")
        or "Elastic rods collide"
    )
    return Page(standalone(begin, title), solution)


def page_solves(tables: dict[str, Any]) -> bool:
    """Whether the page solves a case by itself, to its end, and has something to show then."""
    if lacking(tables)[1]:
        return False
    row, asked = walk(system_of(tables, LIBRARY)), asked_of(tables)
    if is_smooth(tables):
        return asked.until >= 0 or not driven(row.system)
    run = run_of(asked, True, space_of(lay_out_family(row)))
    return (
        run["run"].stop_reason in (Stop.DONE, Stop.FINAL) and motion_of(run)["now"] > 0
    )
