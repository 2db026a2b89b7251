"""solve() and collide(): choose the method, run it, wrap what it found."""

from __future__ import annotations

import math
import warnings
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .arguments import array
from .fields import Fields
from .front_totals import totals_of_fronts
from .frozen import InvalidModel, Number, Problems, number
from .grid_fields import GridFields, outer_forces
from .methods import characteristics, finite_difference
from .methods.abilities import LACKS, choose, refuse
from .methods.assembly import assemble
from .methods.fronts import MAX_EVENTS, FrontRun, track
from .model import Body, ContactLaw, System
from .outcome import Outcome, outcome_of
from .quantities import numbers_in
from .records import FrontRecord
from .solution import Solution
from .status import describe, describe_steps
from .stepped import Run, read_record, totals_of_steps
from .wave_fields import WaveFields

METHODS = tuple(LACKS)
Progress = finite_difference.Progress


class LongRun(UserWarning):
    """A run will take over a minute; the message says how long, and what takes less."""


def solve(
    system: System, until: float | None = None, method: str = "auto", *,
    max_events: int = MAX_EVENTS, dt: float | None = None, rtol: float | None = None,
    cells: int | None = None, snapshots: int | ArrayLike | None = None,
    progress: Progress | None = None,
) -> Solution:
    """Solve a collision.

    Parameters
    ----------
    system : System
        A single collision, of shape ().
    until : float, optional
        Time to run to, s. By default the run goes on until it is proved that no contact can happen
        again, and one round trip of the longest rod more.
    method : str
        ``"fronts"``: exact wave-front tracking. ``"characteristics"``: end signals averaged over a
        time step; has rigid masses, compliant contacts, gravity, smooth initial states and drives.
        ``"finite-difference"``: a staggered grid; has damping, tapered rods and lateral inertia as
        well. ``"auto"`` takes the first that can do the job.
    max_events : int
        Arrivals at ends after which the run gives up; `Solution.status` then says so. On a time
        step, steps times ends, where `until` is not given.
    dt : float, optional
        Time step, s, of a method that has one; on a grid less where `until` is no multiple of it.
        By default it is chosen, so that transit times are whole numbers of steps where they can be,
        and divided until the outcome stands still.
    rtol : float, optional
        By how much the outcome may be wrong, as far as comparing steps can tell: velocities,
        impulses, contact times and, for "characteristics", largest forces, each relative to the
        largest; 1e-5 for "characteristics" and 1e-3 for "finite-difference". `Solution.accuracy`
        has what was reached.
    cells : int, optional
        Of the segment with the longest transit, for "finite-difference", which "auto" then takes;
        each other one gets as many as its waves cross in whole steps. By default doubled until the
        outcome stands still.
    snapshots : int or array_like, optional
        For "finite-difference", which "auto" then takes: how many states to keep at most, at equal
        distances, or the times at which to keep them, s. Between them fields change evenly, and
        energies are those of the nearest one. By default all steps, as far as they fit into 64 MB.
    progress : function, optional
        For "finite-difference": called during long runs with the steps that are done, and about how
        many there will be.

    Returns
    -------
    Solution

    Raises
    ------
    InvalidModel
        If the system is a family or cannot be put on one clock, or an argument is wrong or missing:
        a row with driven ends, or gravity and something that holds it, needs `until`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> solution = ri.solve(ri.System([left, right]))
    >>> round(float(solution.velocity(body=0, x=0.2, t=solution.t_end)), 12)
    0.0
    """
    chosen = check(system, until, method, max_events, dt, rtol, cells, snapshots)
    until, dt, rtol = numbers_in(until, "s"), numbers_in(dt, "s"), numbers_in(rtol, "")
    end = None if until is None else float(until)
    if chosen == "fronts":
        return wrap(track(assemble(system, end), end, int(max_events)), end)
    if chosen == "characteristics":
        return wrap_steps(characteristics.follow(system, end, int(max_events), dt, rtol), end)
    kept: Any = snapshots
    if kept is not None:
        kept = int(kept) if _is_count(kept) else array("snapshots", kept, "s")
    run = finite_difference.follow(
        system, end, int(max_events), cells=cells, dt=dt, rtol=rtol, snapshots=kept,
        progress=progress, announce=_announce,
    )
    return wrap_steps(run, end)


def collide(left: Body, right: Body, gap: float = 0.0,
            contact: ContactLaw | None = None) -> Outcome:
    """Let two bodies collide; shorthand for ``solve(System([left, right])).outcome``.

    Parameters
    ----------
    left, right : Rod, RigidMass or Wall
    gap : float
        Initial distance, m.
    contact : contact law, optional
        Default `Rigid`.

    Returns
    -------
    Outcome

    Raises
    ------
    InvalidModel
        As `solve`.

    Examples
    --------
    Rods of one material and area: e is the ratio of their lengths.

    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> round(ri.collide(left, right).restitution, 12)
    0.4
    """
    system = System([left, right], [gap], None if contact is None else [contact])
    if check(system, None, "auto", MAX_EVENTS) != "fronts":
        return solve(system).outcome
    run = track(assemble(system))
    return outcome_of(system, totals_of_fronts(run), run.settled >= 0, describe(run))


def _announce(sentence: str) -> None:
    warnings.warn(sentence, LongRun, stacklevel=3)


def check(
    system: Any, until: float | None, method: str, max_events: Any, dt: Any = None,
    rtol: Any = None, cells: Any = None, snapshots: Any = None,
) -> str:
    """Check the arguments of `solve`; return the method that is to run."""
    problems: Problems = []
    if not isinstance(system, System):
        message = f"must be a System, such as System([rod, Wall()]), got {system!r}"
        raise InvalidModel([("system", message)])
    if system.shape != ():
        message = (
            f"this is a family of shape {system.shape}, which is for sweep(system); or "
            "solve a member, solve(system[index]). Values along a rod are Steps(values, at)"
        )
        problems.append(("system", message))
    for name, value, sign in (
        ("until", until, "non-negative"), ("dt", dt, "positive"), ("rtol", rtol, "positive"),
    ):
        if value is not None:
            unit = "" if name == "rtol" else "s"
            found: Number = number(problems, name, value, unit, sign)
            if not isinstance(found, float):
                problems.append((name, f"must be a single number, got {value!r}"))
    for name, fixed in (("dt", dt), ("cells", cells)):
        if fixed is not None and rtol is not None:
            problems.append((name, "fixes the step, rtol chooses it; give one of them"))
    if cells is not None and not _is_count(cells):
        problems.append(("cells", f"must be a positive whole number, got {cells!r}"))
    if snapshots is not None:
        _check_snapshots(problems, snapshots, until)
    if method not in ("auto", *METHODS):
        known = ", ".join(f'"{m}"' for m in ("auto", *METHODS))
        problems.append(("method", f"must be one of {known}, got {method!r}"))
    if not _is_count(max_events):
        problems.append(("max_events", f"must be a positive whole number, got {max_events!r}"))
    if problems:
        raise InvalidModel(problems)
    stepping = [name for name, v in (("dt", dt), ("rtol", rtol)) if v is not None]
    gridded = [name for name, v in (("cells", cells), ("snapshots", snapshots)) if v is not None]
    if method == "auto":
        method = choose(system, 2 if gridded else 1 if stepping else 0)
    refuse(method, system)
    if method == "fronts" and stepping:
        problems = [(n, 'method "fronts" is exact and has no time step; leave it out')
                    for n in stepping]
    if method != "finite-difference":
        problems += [(n, f'is for method "finite-difference", not "{method}"; leave it out')
                     for n in gridded]
    if problems:
        raise InvalidModel(problems)
    return method


def _is_count(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, Integral) and int(value) >= 1


def _check_snapshots(problems: Problems, snapshots: Any, until: float | None) -> None:
    if _is_count(snapshots):
        return
    try:
        times = array("snapshots", snapshots, "s")
    except (TypeError, ValueError):
        times = np.zeros(0)
    if times.ndim != 1 or not times.size or isinstance(snapshots, str):
        message = f"must be a positive whole number, or a list of times, got {snapshots!r}"
        problems.append(("snapshots", message))
        return
    good = np.isfinite(times) & (times >= 0)
    if not good.all():
        bad = float(times[~good][0])
        problems.append(("snapshots", f"must be times of 0 s or more, got {bad!r}"))
    elif isinstance(until, int | float) and times.max() > until:
        message = f"must lie before until = {until!r} s, got {float(times.max())!r}"
        problems.append(("snapshots", message))


def wrap(run: FrontRun, until: float | None = None) -> Solution:
    """Make a solution of a run that was assembled and tracked with this `until`."""
    a = run.assembly
    status = describe(run)
    turns: dict[int, tuple[list[int], list[int]]] = {node: ([], []) for node in a.nodes}
    log = run.log
    for tick, node, value in zip(
        *(_plain(x) for x in (log.turn_tick, log.turn_node, log.turn_status)), strict=True
    ):
        turns[node][0].append(tick)
        turns[node][1].append(value)
    reached = run.end * a.tick
    return Solution(
        a.system, WaveFields.from_log(a, log, run.end),
        outcome_of(a.system, totals_of_fronts(run), run.settled >= 0, status),
        FrontRecord([turns[node] for node in a.nodes]),
        method="fronts", until=until, stopped_by=run.stopped_by, status=status,
        t_end=until if until is not None and run.stopped_by == "until" else reached,
        t_final=run.settled * a.tick if run.settled >= 0 else math.nan, events=run.events,
    )


def wrap_steps(run: Run, until: float | None = None) -> Solution:
    """Make a solution of a run on a time step."""
    status = describe_steps(run, until)
    masses = {body: run.speed(m) for body, m in enumerate(run.plan.mass_of) if m >= 0}
    record, tick = read_record(run), run.clockwork.tick
    fields: Fields
    if isinstance(run, finite_difference.GridRun):
        method = "finite-difference"
        pushes = outer_forces(run.mesh, record.forces, record.ends)
        fields = GridFields(run.clockwork, run.mesh, run.states, run.end, masses, pushes)
    else:
        method = "characteristics"
        waves = [run.wave(line) for line in range(2, 2 * len(run.row.steps) - 2)]
        fields = WaveFields.from_steps(run.clockwork, waves, run.edges, run.edges_before, masses)
    system = run.plan.system
    outcome = outcome_of(system, totals_of_steps(run, fields, record), run.settled >= 0, status)
    return Solution(
        system, fields, outcome, record,
        method=method, until=until, stopped_by=run.stopped_by, status=status,
        t_end=until if until is not None else float(run.edges[-1]) * tick,
        t_final=float(run.edges[run.settled]) * tick if run.settled >= 0 else math.nan,
        events=run.events, accuracy=run.estimates,
    )


def _plain(column: Any) -> list[int]:
    return column if isinstance(column, list) else column.tolist()
