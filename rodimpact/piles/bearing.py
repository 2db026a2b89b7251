"""The bearing graph of a pile: blows a metre of set against each resistance.

E. A. L. Smith, Pile-driving analysis by the wave equation, J. Soil Mech. Found. Div.
ASCE 86 (1960) 35-61: each resistance is shared between shaft and toe, the quakes stay,
and one blow is solved.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..hints import explain_arguments, explain_missing
from ..methods.memory import TooLong
from ..methods.registry import checked_count
from ..methods.signals import Floats
from ..model import Rod, Soil, System
from ..model.arguments import array, demand, integer, scalar
from ..model.frozen import InvalidModel, Problems, invalid_argument, raise_if_problems
from ..model.laws import SmithToe
from ..model.profiles import scaled
from ..progress import Progress, ProgressFunction, check_progress
from ..running.jobs import cut, pool_of, results_of
from ..storage.checkpoint import Span
from ..storage.writing import PathLike, write_lines
from ..units import format_si, shown
from .bearing_report import COLUMNS, bearing_table
from .blows import (
    MIN_CELLS,
    Blow,
    PileRow,
    check_pile,
    shaft_resistance,
    strike,
)
from .resting import CELLS, MAX_CELLS, at_rest

MAX_RESISTANCES = 10_000
"""Largest number of resistances of a bearing graph."""
SET_ERROR_FACTOR = 2.0
"""Stated error of a set over its change from half of the cells to all of them.

The set is of second order in the cells, so that the change is three times the error.
"""
STRESS_ERROR_FACTOR = 8.0
"""Stated error of a stress over its larger change from coarser meshes to all cells.

The largest stress is that of one cell at one step. In 24 random piles, the error
against a mesh with six times as many cells was up to 1.6 times this change for
compression, and up to 6.1 times for tension.
"""
COARSER = (0.5, 0.75)
"""Cells of the coarser meshes, over all cells.

Two meshes may have nearly the same largest tension by chance; three hardly do.
"""


@explain_missing()
class BearingPoint(NamedTuple):
    """One blow on a pile against one resistance; a row of a bearing graph.

    Attributes
    ----------
    resistance, shaft, toe : float
        Ultimate resistance and its two parts, N.
    set : float
        m.
    blow_count : float
        Blows per metre of set, 1/m; inf without set.
    compression, compression_x, compression_t : float
        Largest compressive stress in the pile, Pa, positive; its distance from the
        head, m; and its time after the impact, s.
    tension, tension_x, tension_t : float
        Largest tensile stress, Pa, its distance from the head, m, and its time, s; 0,
        nan and nan without tension.
    set_error, compression_error, tension_error : float
        Stated relative errors of set, compression and tension. They follow from the
        changes of the results between half, three quarters and all of the cells; 0
        without a change.
    is_over : bool
        Whether the blow came to its end, so that the set is final.
    status : str
        The same in a sentence.

    Examples
    --------
    >>> import rodimpact as ri
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel)
    >>> toe = ri.SmithToe(resistance=1.0, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> (point,) = ri.bearing_graph(system, 400e3, cells=20).points
    >>> point.toe, round(1 / point.blow_count, 3) == round(point.set, 3)
    (400000.0, True)
    """

    resistance: float
    shaft: float
    toe: float
    set: float
    blow_count: float
    compression: float
    compression_x: float
    compression_t: float
    tension: float
    tension_x: float
    tension_t: float
    set_error: float
    compression_error: float
    tension_error: float
    is_over: bool
    status: str


@explain_missing()
@dataclass(frozen=True)
class BearingGraph:
    """Blow count and stresses of a pile against its resistance.

    Attributes
    ----------
    system : System
        The pile as it was given.
    shaft_share : float
        Part of the resistance that acts along the shaft.
    points : tuple of BearingPoint
        In the order of the resistances that were given.

    Examples
    --------
    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=1.0, quake=2.5e-3, damping=0.16)
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel, shaft=soil)
    >>> toe = ri.SmithToe(resistance=1.0, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> graph = ri.bearing_graph(system, [400e3, 800e3], cells=20)
    >>> graph["blow_count"].round().tolist()
    [28.0, 56.0]
    """

    system: System
    shaft_share: float
    points: tuple[BearingPoint, ...]

    def __getitem__(self, name: str) -> Floats:
        """A column: the numbers of that name of all points, [point].

        Parameters
        ----------
        name : str
            A number of `BearingPoint`, such as ``"blow_count"``.

        Raises
        ------
        KeyError
            If the points have no such number.
        """
        if not isinstance(name, str) or name not in COLUMNS:
            wanted = f"must be one of {', '.join(COLUMNS)}"
            raise KeyError(f"name: {wanted}, got {shown(name)}")
        return np.array([getattr(point, name) for point in self.points])

    @property
    def is_over(self) -> bool:
        """Whether every blow came to its end."""
        return all(point.is_over for point in self.points)

    def csv_lines(self) -> Iterator[str]:
        """Lines of a table, one for each point, names first; nan is an empty cell.

        The columns are those of `COLUMNS` and `is_over`.
        """
        yield ",".join([*COLUMNS, "is_over"])
        for point in self.points:
            cells = []
            for name in COLUMNS:
                value = getattr(point, name)
                cells.append("" if np.isnan(value) else repr(value))
            cells.append(str(point.is_over))
            yield ",".join(cells)

    def to_csv(self, path: PathLike, *, force: bool = False) -> None:
        """Write a table of all points, in SI units.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        write_lines(path, self.csv_lines(), force=force)

    def __str__(self) -> str:
        """The table of all points for people."""
        return bearing_table(self)


@explain_arguments
def bearing_graph(
    system: System,
    resistances: ArrayLike,
    *,
    shaft_share: float | None = None,
    cells: int = CELLS,
    until: float | None = None,
    workers: int | None = None,
    progress: bool | ProgressFunction = True,
) -> BearingGraph:
    """Blow count and largest stresses of a pile for each of several resistances.

    Each resistance is divided between shaft and toe. Along the shaft it is distributed
    as in the system. Quakes and damping stay the same. One blow is solved for each
    resistance. Before the blow the soil is unloaded, or it carries the pile at rest if
    gravity acts.

    Parameters
    ----------
    system : System
        From left to right: a moving ram, masses such as a helmet, the pile, and a wall
        below its toe. The contact of the pile with the wall is a `SmithToe`.
    resistances : array_like
        Ultimate resistances of shaft and toe together, N.
    shaft_share : float, optional
        Fraction of the resistance that acts along the shaft, from 0 to less than 1;
        default: as in the system.
    cells : int, optional
        Cells of the segment with the longest transit time. For the stated errors each
        blow is also solved on half and on three quarters of these cells.
    until : float, optional
        Duration of a blow, s, as for `blows`.
    workers : int, optional
        Number of threads; default: one for each processor.
    progress : bool or function
        As for `sweep`; it counts resistances.

    Returns
    -------
    BearingGraph

    Raises
    ------
    InvalidModel
        If the system is no pile, an argument is wrong, or soil of a resistance cannot
        carry the pile at rest or would let the ram drive it farther than its length.

    Examples
    --------
    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=1.0, quake=2.5e-3, damping=0.16)
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel, shaft=soil)
    >>> toe = ri.SmithToe(resistance=1.0, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> graph = ri.bearing_graph(system, [400e3, 800e3], shaft_share=0.25, cells=20)
    >>> [point.shaft for point in graph.points]
    [100000.0, 200000.0]
    """
    row = check_pile(system)
    share = _checked_share(system, row, shaft_share)
    R = array("resistances", resistances, "N", "positive").ravel()
    message = f"must be 1 to {MAX_RESISTANCES} numbers"
    demand(1 <= R.size <= MAX_RESISTANCES, "resistances", message)
    cells = integer("cells", cells, 2 * MIN_CELLS, MAX_CELLS)
    if until is not None:
        until = scalar("until", until, "s", "positive")
    problems: Problems = []
    if workers is not None:
        workers = checked_count(problems, "workers", workers)
    check_progress(problems, progress)
    raise_if_problems(problems)
    if until is None and system.gravity == 0:  # with gravity `at_rest` checks the soil
        _check_strength(system, row, R)
    settings = Settings(row, share, cells, until)
    points: dict[int, BearingPoint] = {}
    with (
        Progress(progress, "bearing graph", "resistances") as report,
        pool_of(None, workers) as pool,
    ):

        def submit(start: int, _: int) -> Any:
            """Start the blow against resistance number `start` in the pool."""
            return pool.executor.submit(_point, system, float(R[start]), settings)

        jobs = cut([Span(0, R.size)], 1)  # one resistance a job
        for results in results_of(jobs, submit, pool.workers):
            for job in results:
                points[job.start] = job.result
            report(len(points), R.size)
    in_order = tuple(points[i] for i in range(R.size))  # jobs end in any order
    return BearingGraph(system, share, in_order)


def _check_strength(system: System, row: PileRow, R: Floats) -> None:
    """Raise InvalidModel if soil would let the ram drive the pile beyond its length.

    The distance is the ram's energy over the resistance. To solve such a blow to its
    end would take very long. `R` are the resistances, N; a cause may be numbers that
    were meant in kN.
    """
    ram: Any = system.bodies[0]
    energy = float(ram.mass) * float(ram.velocity) ** 2 / 2
    length = 0.0  # of the pile, m
    for body in system.bodies[row.pile :]:
        length += float(getattr(body, "length", 0.0))
    for i, resistance in enumerate(R.tolist()):
        distance = energy / resistance
        if distance > length:
            message = (
                f"{format_si(resistance, 'N', digits=3)} is too small: the "
                f"{format_si(energy, 'J', digits=3)} of the ram would drive the pile "
                f"by {format_si(distance, 'm', digits=3)}, more than its length of "
                f"{format_si(length, 'm', digits=3)}; a number without a unit is in "
                "N; raise it, or end the blow by until="
            )
            raise invalid_argument(f"resistances[{i}]", message)


class Settings(NamedTuple):
    """How the blows of a bearing graph are solved."""

    row: PileRow
    shaft_share: float  # part of the resistance along the shaft
    cells: int  # of the segment with the longest transit time
    until: float | None  # s


def _checked_share(system: System, row: PileRow, share: Any) -> float:
    """Part of the resistance along the shaft; by default that of the system.

    InvalidModel is raised unless it is 0 to less than 1, 0 without soil along the
    shaft, and the law of the toe is `SmithToe`.
    """
    toe: Any = system.contacts[row.toe]
    message = "must be SmithToe, whose resistance varies at constant quake"
    demand(isinstance(toe, SmithToe), f"contacts.{row.toe}", message)
    on_shaft = shaft_resistance(system)
    if share is None:
        return on_shaft / (on_shaft + float(toe.resistance))
    part = scalar("shaft_share", share, "", "non-negative")
    demand(part < 1, "shaft_share", "must be below 1, got {0!r}", part)
    message = "must be 0 for a pile without soil along its shaft, got {0!r}"
    is_possible = part == 0 or on_shaft > 0
    demand(is_possible, "shaft_share", message, part)
    return part


def with_resistance(
    system: System, row: PileRow, resistance: float, shaft_share: float
) -> System:
    """The pile with this ultimate resistance of its soil, N, all unloaded.

    The share acts along the shaft, distributed as in the system, the rest at the toe.
    Without a share of the shaft its soil is left out. Rods lose their strain, and
    overlaps of contacts, which are negative gaps, become 0.
    """
    on_shaft = shaft_resistance(system)
    bodies: list[Any] = []
    for body in system.bodies:
        if isinstance(body, Rod):
            shaft = body.shaft
            if isinstance(shaft, Soil):
                shaft = None
                if shaft_share > 0:
                    factor = shaft_share * resistance / on_shaft
                    shaft = _unloaded(body.shaft, factor)
            body = body.replace(shaft=shaft, strain=0.0)
        bodies.append(body)
    contacts = list(system.contacts)
    toe: Any = contacts[row.toe]
    contacts[row.toe] = toe.replace(resistance=(1 - shaft_share) * resistance)
    gaps = [max(0.0, float(gap)) for gap in system.gaps]
    return system.replace(bodies=bodies, contacts=contacts, gaps=gaps)


def _unloaded(soil: Any, factor: float) -> Soil:
    """Soil of a resistance larger by a factor, with nothing mobilised."""
    resistance = scaled(soil.resistance, factor)
    unloaded: Soil = soil.replace(resistance=resistance, mobilised=0.0)
    return unloaded


def _point(system: System, resistance: float, settings: Settings) -> BearingPoint:
    """Result of a blow against one resistance, with stated errors.

    The blow is solved on all cells and on the coarser meshes, whose changes give the
    errors. InvalidModel is raised if a coarser mesh has too few cells.
    """
    row = settings.row
    share = settings.shaft_share
    pile = with_resistance(system, row, resistance, share)
    fine = _blow(pile, resistance, settings)
    compression = -fine.compression.stress
    tension = fine.tension.stress
    set_change = 0.0
    compression_change = 0.0
    tension_change = 0.0
    for part in COARSER:
        # Runs of the same duration contain the same stress peaks.
        cells = int(part * settings.cells)
        coarser = settings._replace(cells=cells, until=fine.t_end)
        try:
            coarse = _blow(pile, resistance, coarser)
        except InvalidModel as error:
            message = f"half of them are too few for the stated errors: {error}"
            raise invalid_argument("cells", message) from error
        if part == COARSER[0]:
            set_change = fine.set - coarse.set
        coarse_compression = -coarse.compression.stress
        change = abs(compression - coarse_compression)
        compression_change = max(compression_change, change)
        change = abs(tension - coarse.tension.stress)
        tension_change = max(tension_change, change)
    return BearingPoint(
        resistance=resistance,
        shaft=share * resistance,
        toe=(1 - share) * resistance,
        set=fine.set,
        blow_count=fine.blow_count,
        compression=compression,
        compression_x=fine.compression.x,
        compression_t=fine.compression.t,
        tension=tension,
        tension_x=fine.tension.x,
        tension_t=fine.tension.t,
        set_error=SET_ERROR_FACTOR * _relative(set_change, fine.set),
        compression_error=STRESS_ERROR_FACTOR
        * _relative(compression_change, compression),
        tension_error=STRESS_ERROR_FACTOR * _relative(tension_change, tension),
        is_over=fine.is_over,
        status=fine.status,
    )


def _blow(pile: System, resistance: float, settings: Settings) -> Blow:
    """The blow on a pile, which is first put at rest if gravity acts.

    InvalidModel is raised if the soil cannot carry the pile, or the run is too long.
    """
    cells = settings.cells
    if pile.gravity != 0:
        try:
            pile = at_rest(pile, cells)
        except InvalidModel as error:
            message = f"of {format_si(resistance, 'N')}: {error}"
            raise invalid_argument("resistances", message) from error
    try:
        return strike(pile, pile, settings.row, cells, settings.until)
    except TooLong as error:
        # The remedy of the error is one for single runs.
        if settings.until is not None:
            message = f"{error.size}; end the blow earlier, or take fewer cells"
            raise invalid_argument("until", message) from error
        message = (
            f"of {format_si(resistance, 'N')}: {error.size}; end the blow by until="
        )
        raise invalid_argument("resistances", message) from error


def _relative(change: float, value: float) -> float:
    """Absolute change over a value; 0 without a change, else inf without a value."""
    if change == 0:
        return 0.0
    return abs(change) / value if value > 0 else np.inf
