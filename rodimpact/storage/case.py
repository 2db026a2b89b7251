"""What a case file describes: a collision, or a family of them, and what to do with it."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..model import System
from .grids import Varied
from .saved_result import SavedResult

SCHEMA = 1
MOST_BYTES = 10**7
"""Size of a case file, at most. Python takes up to a hundred bytes of memory for each."""


class GaugePlace(NamedTuple):
    """A strain gauge on a rod.

    body; fraction of its length, from the left end; name : of its column or channel, or "".
    """

    body: int
    fraction: float
    name: str = ""


@dataclass(frozen=True)
class Case:
    """A collision, or a family of them, and what to do with it.

    Attributes
    ----------
    system : System
        Of shape (), or where numbers are varied of shape (n_0, n_1, ...), one axis a grid.
    solve : dict
        Those of `until` (s), `method`, `max_events`, `dt` (s), `rtol`, `cells` and `snapshots` that
        were given, for ``ri.solve``.
    output : dict of str
        Those of `plot` and `save` that were given: names of files.
    path : str
        Where it was read from; empty if from nowhere.
    varied : tuple of Varied
        What varies along each axis; the system holds the same numbers in its own terms.
    gauges : tuple of GaugePlace
        Strain gauges that the page of ``rodimpact explore`` shows, ``run --gauges`` writes and
        ``compare`` lays beside a record.
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
    # not compared: a nan, such as the first force of a contact without any, equals nothing
    result: SavedResult | None = field(default=None, compare=False)
