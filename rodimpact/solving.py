"""solve() and collide(): run the method that can do it, wrap what it found."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .fields import Fields
from .frozen import InvalidModel
from .grid_fields import GridFields, outer_forces
from .methods import characteristics, finite_difference
from .methods.abilities import driven
from .methods.assembly import Assembly, assemble
from .methods.front_kernel import PRESS
from .methods.fronts import MAX_EVENTS, FrontRun, track
from .methods.link_kernel import RIGID
from .model import Body, Bonded, ContactLaw, System, Wall
from .options import Options
from .outcome import Outcome, read_outcome
from .records import FrontRecord
from .solution import Solution
from .stepped import Run, read_record, read_stepped
from .units import format_si
from .wave_fields import WaveFields

AUTO = Options()
Progress = finite_difference.Progress
LARGE_CHANGE = 0.01  # of the largest force, from which it is named
LARGE_STRAIN = 0.01  # from which the linear theory is doubtful
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest


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
    found = track(assemble(system))
    return read_outcome(found, describe(found))


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
        a.system, WaveFields.from_log(a, log, run.end), read_outcome(run, status),
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
    return Solution(
        run.plan.system, fields, read_stepped(run, fields, record, status), record,
        method=method, until=until, stopped_by=run.stopped_by, status=status,
        t_end=until if until is not None else float(run.edges[-1]) * tick,
        t_final=float(run.edges[run.settled]) * tick if run.settled >= 0 else math.nan,
        events=run.events, accuracy=run.estimates,
    )


def _plain(column: Any) -> list[int]:
    return column if isinstance(column, list) else column.tolist()


def describe(run: FrontRun) -> str:
    """Why the run ended, in a sentence with the remedy."""
    a = run.assembly
    end = format_si(run.end * a.tick, "s")
    final = _final(run) if run.settled >= 0 else ""
    if run.stopped_by == "final":
        said = final
    elif run.stopped_by == "until" and final:
        said = f"Stopped at the time asked for. {final}"
    elif run.stopped_by == "until":
        walls = _at_walls(a)
        endless = len(walls) == 2 or any(isinstance(law, Bonded) for law in walls)
        remedy = (
            "while an end is driven, no contact is known to be the last" if driven(a.system)
            else "a row between walls, or bonded to one, may never come to an end" if endless
            else "leave out until= to run to the proof"
        )
        said = f"Stopped at the time asked for, {end}, before the collision was final; {remedy}."
    elif run.stopped_by == "max_events" and final:
        said = (
            f"{final} The cap of {run.events} events ended the run at {end}; raise max_events to "
            "see more of the vibration."
        )
    elif run.stopped_by == "max_events":
        said = (
            f"Stopped by the cap of {run.events} events at {end}; fronts multiply where transit "
            "times have no common measure. Raise max_events, or make lengths commensurate."
        )
    else:
        said = (
            f"Stopped by the clock after {end}: a contact may close later than it can count, if "
            "ever. Give until= to set another end."
        )
    if a.transit_error > 2.0**-36:
        said += (
            f" The transit time of {a.worst} was rounded by {a.transit_error:.2g} of itself to "
            "fit the clock."
        )
    return said + _large(float(np.abs(run.log.value).max()) / min(a.wave_speed[1:-1]))


def _large(strain: float) -> str:
    """A warning of strains that are not small."""
    if strain <= LARGE_STRAIN:
        return ""
    return (
        f" Strains reach up to {strain:.2g}, where the linear theory of small strains "
        "(about 1 %) does not hold; check units and velocities."
    )


def _final(run: FrontRun) -> str:
    """What the proof of finality says."""
    a = run.assembly
    pressing = [
        str(i) for i, node in enumerate(a.nodes)
        if run.row.status[node] == PRESS and run.row.force[node] > ROUND_OFF * run.tally.peak[node]
    ]
    if pressing:
        return f"Nothing changes any more; contact {', '.join(pressing)} goes on pressing."
    if not any(run.tally.episodes):
        return "No collision happens, now or later."
    if run.stopped_by == "until" and run.settled >= run.end:
        return "The collision is final: no new impact can happen."
    proof = format_si(run.settled * a.tick, "s")
    return f"The collision is final: no new impact can happen after {proof}."


def _at_walls(a: Assembly) -> list[ContactLaw]:
    """Contact laws at the walls of the row."""
    bodies, laws = a.system.bodies, a.system.contacts
    ends = ((0, 0), (len(bodies) - 1, -1))
    return [laws[k] for i, k in ends if isinstance(bodies[i], Wall)]


def _own_peak(run: finite_difference.GridRun) -> str:
    """A warning of a largest force that is not that of the bodies."""
    reasons, large = [], max(run.rtol, LARGE_CHANGE)
    if run.peak_change > large:
        reasons.append(f"refining changed it by {run.peak_change:.1g}")
    if run.overshoot > large:
        reasons.append(
            f"beside jumps waves overshoot, and over {finite_difference.RINGING} steps it is less "
            f"by {run.overshoot:.1g} of itself"
        )
    return f" The largest force is that of this mesh: {'; '.join(reasons)}." if reasons else ""


def describe_steps(run: Run, until: float | None = None) -> str:
    """Why a run on a time step ended, and how accurate it is, with the remedy."""
    times = run.edges * run.clockwork.tick
    end = format_si(float(times[-1]) if until is None else until, "s")
    contacts = [run.plan.laws[i] >= RIGID for i in run.plan.contact_link if i >= 0]
    if run.settled >= 0:
        proof = f" after {format_si(float(times[run.settled]), 's')}"
        if run.stopped_by == "until" and run.settled >= run.steps:
            proof = ""
        met = any(run.tally.episodes)
        said = (
            f"The collision is final: no new impact can happen{proof}."
            if met else "No collision happens, now or later."
        )
        if run.stopped_by == "until":
            said = f"Stopped at the time asked for. {said}"
    elif run.stopped_by == "until":
        said = f"Stopped at the time asked for, {end}, before the collision was final."
    else:
        said = (
            f"Stopped by the cap of {run.events} steps times ends at {end}, before the collision "
            "was final. Raise max_events, or give until= to set another end."
        )
    step = format_si(run.step, "s")
    said += f" Time step {step}"
    if isinstance(run, finite_difference.GridRun):
        said += f", {sum(run.mesh.counts)} cells"
    if run.clockwork.transit_error > 2.0**-36:
        said += (
            f", for which the transit time of {run.clockwork.worst} changed by "
            f"{run.clockwork.transit_error:.2g} of itself"
        )
    said += "."
    if until and not run.steps:
        said += " The end comes before half a step: none was taken. More cells shorten it."
    if run.estimates and any(contacts):
        finer = "more cells" if isinstance(run, finite_difference.GridRun) else "a smaller dt"
        late = {name: value for name, value in run.estimates.items() if value > run.rtol}
        if late:
            which = ", ".join(
                f"{name} to {value:.1g}" for name, value in late.items() if value < math.inf
            )
            said += (
                f" Not converged to {run.rtol:g}: {which or 'too long a run to divide the step'}; "
                f"a larger rtol is soon reached, {finer} goes on."
            )
        else:
            worst = max(run.estimates.values())
            said += f" Comparing steps, the outcome is wrong by {worst:.1g} of itself at most."
    if isinstance(run, finite_difference.GridRun):
        said += _own_peak(run)
    return said + _large(run.largest_strain)
