"""solve() and collide(): choose the method, run it, wrap what it found."""

from __future__ import annotations

import math
from numbers import Integral
from typing import Any

import numpy as np

from .fields import WaveFields
from .frozen import InvalidModel, Number, Problems, number
from .methods.assembly import Assembly, assemble
from .methods.front_kernel import PRESS
from .methods.fronts import MAX_EVENTS, FrontRun, track
from .model import Bonded, ContactLaw, Rod, System, Wall
from .outcome import Outcome, read_outcome
from .solution import Solution
from .units import format_si

METHODS = ("fronts",)
LARGE_STRAIN = 0.01  # from which the linear theory is doubtful


def solve(
    system: System, until: float | None = None, method: str = "auto", *,
    max_events: int = MAX_EVENTS,
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
        ``"fronts"``, exact wave-front tracking; ``"auto"`` chooses it.
    max_events : int
        Arrivals at ends after which the run gives up; `Solution.status` then says so.

    Returns
    -------
    Solution

    Raises
    ------
    InvalidModel
        If the system is a family or cannot be put on one clock, or an argument is wrong.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> solution = ri.solve(ri.System([left, right]))
    >>> round(float(solution.velocity(body=0, x=0.2, t=solution.t_end)), 12)
    0.0
    """
    run = run_fronts(system, until, method, max_events)
    return wrap(run, None if until is None else float(until))


def collide(left: Rod | Wall, right: Rod | Wall, gap: float = 0.0,
            contact: ContactLaw | None = None) -> Outcome:
    """Let two bodies collide; shorthand for ``solve(System([left, right])).outcome``.

    Parameters
    ----------
    left, right : Rod or Wall
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
    run = run_fronts(system, None, "auto", MAX_EVENTS)
    return read_outcome(run, describe(run))


def run_fronts(
    system: Any, until: float | None, method: str, max_events: Any
) -> FrontRun:
    """Check the arguments and run the method."""
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
    if until is not None:
        end: Number = number(problems, "until", until, " of seconds", "non-negative")
        if not isinstance(end, float):
            problems.append(("until", f"must be a single time, got {until!r}"))
    if method not in ("auto", *METHODS):
        known = ", ".join(f'"{m}"' for m in ("auto", *METHODS))
        problems.append(("method", f"must be one of {known}, got {method!r}"))
    if isinstance(max_events, bool) or not isinstance(max_events, Integral) or max_events < 1:
        problems.append(("max_events", f"must be a positive whole number, got {max_events!r}"))
    if problems:
        raise InvalidModel(problems)
    end_time = None if until is None else float(until)
    return track(assemble(system, end_time), end_time, int(max_events))


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
        [turns[node] for node in a.nodes],
        until=until, stopped_by=run.stopped_by, status=status,
        t_end=until if until is not None and run.stopped_by == "until" else reached,
        t_final=run.settled * a.tick if run.settled >= 0 else math.nan, events=run.events,
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
            "a row between walls, or bonded to one, may never come to an end" if endless
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
    strain = float(np.abs(run.log.value).max()) / min(a.wave_speed[1:-1])
    if strain > LARGE_STRAIN:
        said += (
            f" Strains reach up to {strain:.2g}, where the linear theory of small strains "
            "(about 1 %) does not hold; check units and velocities."
        )
    return said


def _final(run: FrontRun) -> str:
    """What the proof of finality says."""
    a = run.assembly
    pressing = [str(i) for i, node in enumerate(a.nodes) if run.row.status[node] == PRESS]
    if pressing:
        return f"Nothing changes any more; contact {', '.join(pressing)} goes on pressing."
    if not any(run.tally.episodes):
        return "No collision happens, now or later."
    proof = format_si(run.settled * a.tick, "s")
    return f"The collision is final: no new impact can happen after {proof}."


def _at_walls(a: Assembly) -> list[ContactLaw]:
    """Contact laws at the walls of the row."""
    bodies, laws = a.system.bodies, a.system.contacts
    ends = ((0, 0), (len(bodies) - 1, -1))
    return [laws[k] for i, k in ends if isinstance(bodies[i], Wall)]
