"""solve() and collide(): run the method that can do it, wrap what it found."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods.fronts.assembly import assemble
from ..methods.fronts.method import FrontRun, track
from ..methods.grid import method as finite_difference
from ..methods.options import MAX_EVENTS, Options
from ..methods.steps import method as characteristics
from ..model import Body, ContactLaw, System
from ..model.frozen import InvalidModel
from ..results.fields import Fields
from ..results.front_totals import totals_of_fronts
from ..results.grid_fields import GridFields, outer_forces
from ..results.outcome import Outcome, outcome_of
from ..results.records import FrontRecord
from ..results.solution import Solution
from ..results.status import describe, describe_steps
from ..results.stepped import Run, read_record, totals_of_steps
from ..results.wave_fields import WaveFields

AUTO = Options()
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
    options = Options(until, method, max_events, dt, rtol, cells, snapshots)
    chosen = options.method_for(system)
    if system.shape != ():
        message = (
            f"this is a family of shape {system.shape}, which is for sweep(system); or "
            "solve a member, solve(system[index]). Values along a rod are Steps(values, at)"
        )
        raise InvalidModel([("system", message)])
    return run_method(system, chosen, options, progress)


def run_method(
    system: System, method: str, options: Options, progress: Progress | None = None
) -> Solution:
    """Solve a single collision by the method that `Options.method_for` chose."""
    end, cap = options.until, options.max_events
    if method == "fronts":
        return wrap(track(assemble(system, end), end, cap), end)
    if method == "characteristics":
        return wrap_steps(
            characteristics.follow(system, end, cap, options.dt, options.rtol), end
        )
    kept: Any = options.snapshots
    found = finite_difference.follow(
        system, end, cap, cells=options.cells, dt=options.dt, rtol=options.rtol,
        snapshots=np.array(kept) if isinstance(kept, tuple) else kept,
        progress=progress, announce=_announce,
    )
    return wrap_steps(found, end)


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
    if system.shape or AUTO.method_for(system) != "fronts":
        return solve(system).outcome
    run = track(assemble(system))
    return outcome_of(system, totals_of_fronts(run), run.settled >= 0, describe(run))


def _announce(sentence: str) -> None:
    warnings.warn(sentence, LongRun, stacklevel=3)


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
