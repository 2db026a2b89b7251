"""Content of a case file: a collision or a family, options, outputs and gauges."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..hints import explain_missing, nearest
from ..methods.registry import Options
from ..model import System
from ..model.arguments import check_kind
from ..model.frozen import (
    InvalidModel,
    Problems,
    add_problem,
    defaults_of,
    raise_if_problems,
)
from ..units import shown
from .grids import Varied
from .saved_result import SavedResult

CASE_SCHEMA = 1
"""Version of the case files; readers refuse files of other versions."""
OUTPUTS = ("plot", "save")
MAX_CASE_BYTES = 10**7
"""Largest size of a case file, bytes.

Reading takes up to a hundred bytes of memory for each byte of the file.
"""


class GaugePlace(NamedTuple):
    """A strain gauge on a rod.

    body : index of the rod; fraction : distance from its left end over its length;
    name : name of the gauge's column or channel, "" if it has none.
    """

    body: int
    fraction: float
    name: str = ""


@explain_missing("system")
@dataclass(frozen=True)
class Case:
    """Content of a case file: a collision or a family, options, outputs and gauges.

    Attributes
    ----------
    system : System
        A single collision, of shape (); if numbers vary, a family of shape
        (n_0, n_1, ...), with one axis per grid.
    solve : dict
        Options for ``ri.solve`` that were given: some of `until` (s), `method`,
        `max_events`, `dt` (s), `rtol`, `cells` and `snapshots`.
    output : dict of str
        Names of files that were given: `plot` and `save`.
    path : str
        Name of the file that was read; empty without a file.
    varied : tuple of Varied
        The number or variable that varies along each axis. The system has the values,
        too.
    gauges : tuple of GaugePlace
        Strain gauges that the page of ``rodimpact explore`` shows, ``run --gauges``
        writes and ``compare`` compares with a record.
    result : SavedResult or None
        Outcome of a saved solution, which is compared when the case is solved again.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> case = ri.Case(ri.System([rod, ri.Wall()]), solve={"until": 1e-3})
    >>> ri.solve(case.system, **case.solve).t_end
    0.001
    """

    system: System
    solve: dict[str, Any] = field(default_factory=dict)
    output: dict[str, str] = field(default_factory=dict)
    path: str = ""
    varied: tuple[Varied, ...] = field(default=(), compare=False)
    gauges: tuple[GaugePlace, ...] = ()
    # Not compared: nan, such as the time of the first force of a contact without force,
    # is unequal to itself.
    result: SavedResult | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        """Raise InvalidModel if an entry is not of its class, or has a wrong value.

        A wrong `system` is raised at once; all other mistakes are raised together.
        """
        check_kind("system", self.system, System, "System([rod, Wall()])")
        problems: Problems = []
        _check_options(problems, self.solve)
        _check_output(problems, self.output)
        path: Any = self.path
        if not isinstance(path, str):
            add_problem(problems, "path", "must be the name of a file", path)
        for name, kind in (("varied", Varied), ("gauges", GaugePlace)):
            entries: Any = getattr(self, name)
            is_valid = isinstance(entries, tuple | list)  # a list is accepted, too
            if is_valid:
                is_valid = all(isinstance(entry, kind) for entry in entries)
            if not is_valid:
                wanted = f"must be a tuple of {kind.__name__}"
                add_problem(problems, name, wanted, entries)
        result: Any = self.result
        if not isinstance(result, SavedResult | None):
            add_problem(problems, "result", "must be a SavedResult or None", result)
        raise_if_problems(problems)


def _check_options(problems: Problems, options: Any) -> None:
    """Add a problem for each option that `solve` does not have, or else a wrong value.

    Values are checked only if all names are known. The path of each problem begins with
    "solve."; options that are not a mapping are one problem at "solve".
    """
    if not isinstance(options, Mapping):
        add_problem(problems, "solve", "must be arguments of ri.solve by name", options)
        return
    arguments = defaults_of(Options)
    unknown = [name for name in options if name not in arguments]
    for name in unknown:
        message = f"is no option of ri.solve; {nearest(name, arguments)}"
        problems.append((f"solve.{shown(name)}", message))
    if unknown:
        return  # `Options` takes no other names
    try:
        Options(**options)
    except InvalidModel as error:
        for path, message in error.problems:
            problems.append((f"solve.{path}", message))


def _check_output(problems: Problems, output: Any) -> None:
    """Add a problem at "output" unless it maps words of `OUTPUTS` to names of files.

    Several wrong entries give a single problem.
    """
    if not isinstance(output, Mapping):
        add_problem(
            problems, "output", "must be names of files by what they hold", output
        )
        return
    for name, path in output.items():
        if name not in OUTPUTS or not isinstance(path, str):
            wanted = f"must be names of files for {' and '.join(OUTPUTS)}"
            add_problem(problems, "output", wanted, output)
            return
