"""solve() and collide(): one collision, by the method that can do it."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..hints import explain_arguments
from ..methods.registry import Options
from ..methods.run import MAX_EVENTS
from ..model import Body, ContactLaw, System
from ..model.arguments import check_kind
from ..model.frozen import Problems, raise_if_problems
from ..progress import Progress, ProgressFunction, check_progress
from ..results.outcome import Outcome, outcome_of
from ..results.solution import Solution

DEFAULT_OPTIONS = Options()
WORK_UNITS = {
    "fronts": "events",
    "characteristics": "steps",
    "finite-difference": "steps",
}
"""Work that each method counts as it goes on, for a progress bar."""


@explain_arguments
def solve(
    system: System,
    until: float | None = None,
    method: str = "auto",
    *,
    max_events: int = MAX_EVENTS,
    dt: float | None = None,
    rtol: float | None = None,
    cells: int | None = None,
    snapshots: int | ArrayLike | None = None,
    progress: bool | ProgressFunction = True,
) -> Solution:
    """Solve a collision.

    Parameters
    ----------
    system : System
        A single collision, of shape ().
    until : float, optional
        End of the run, s. By default the run ends one round trip of the longest rod
        after the proof that no contact can happen again.
    method : str
        ``"fronts"``: exact wave-front tracking. ``"characteristics"``: waves are
        polynomial pieces in time, and there is no time step; has rigid masses,
        compliant contacts, joints, gravity, smooth initial states and drives.
        ``"finite-difference"``: a staggered grid; has damping, tapered rods and lateral
        inertia as well. ``"auto"`` takes the first that can do the job.
    max_events : int
        Cap on the work. If it is reached, `Solution.status` says so. "fronts" counts
        arrivals at ends, "characteristics" the steps of contacts and ends.
        "finite-difference" counts time steps times contacts and ends, if `until` is not
        given.
    dt : float, optional
        Time step of "finite-difference", s. It is shortened if `until` is no multiple
        of it. By default it is chosen, and divided until the outcome no longer changes.
    rtol : float, optional
        Relative accuracy: 1e-8 by default for "characteristics", 1e-3 for
        "finite-difference", of velocities and impulses. "fronts" is exact to round-off
        and takes no rtol, so "auto" chooses "characteristics" if it is given.
        `Solution.accuracy` states the errors that were reached.
    cells : int, optional
        For "finite-difference": cells of the segment with the longest transit time. The
        cells of each other segment follow from the time step. By default the number is
        doubled until the outcome no longer changes.
    snapshots : int or array_like, optional
        For "finite-difference": the largest number of states to keep, at equal
        intervals, or the times at which to keep them, s. Fields are interpolated
        between states; energies are those of the nearest state. By default all steps
        are kept, up to 64 MB. `dt`, `cells` and `snapshots` do not choose the method:
        if "auto" takes another one, they are refused.
    progress : bool or function
        Whether a bar may show how far a long run is: after two seconds of work, on a
        terminal or in a notebook. A function is called with the number of steps (events
        of "fronts") that are done and an estimate of all, None where that is not known;
        what it raises ends the run.

    Returns
    -------
    Solution

    Raises
    ------
    InvalidModel
        If the system is a family or cannot be put on one clock, or an argument is wrong
        or missing: a row with driven ends, or gravity and something that holds it,
        needs `until`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> solution = ri.solve(ri.System([left, right]))
    >>> round(float(solution.velocity(body=0, x=0.2, t=solution.t_end)), 12)
    0.0
    """
    check_kind("system", system, System, "System([left, right])")
    options = Options(
        until=until,
        method=method,
        max_events=max_events,
        dt=dt,
        rtol=rtol,
        cells=cells,
        snapshots=snapshots,
    )
    chosen = options.method_for(system)
    problems: Problems = []
    check_progress(problems, progress)
    if system.shape != ():
        message = (
            f"is a family of shape {system.shape}; solve all by sweep(system), or one "
            "by solve(system[index]). Values along a rod are Steps(values, at)"
        )
        problems.append(("system", message))
    raise_if_problems(problems)
    with Progress(progress, "solve", WORK_UNITS[chosen]) as report:
        run = options._run_checked(chosen, system, report)
    return Solution(run, options)


@explain_arguments
def collide(
    left: Body, right: Body, gap: float = 0.0, contact: ContactLaw | None = None
) -> Outcome:
    """Let two bodies collide, and return the outcome, as `solve` does for a row of two.

    It is ``solve(System([left, right], [gap], [contact])).outcome``.

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
    contacts = None
    if contact is not None:
        contacts = [contact]
    system = System([left, right], [gap], contacts)
    if system.shape != ():
        return solve(system).outcome  # raises: `solve` refuses a family
    method = DEFAULT_OPTIONS.method_for(system)
    with Progress(progress=True, name="collide", unit=WORK_UNITS[method]) as report:
        run = DEFAULT_OPTIONS._run_checked(method, system, report)
    if run.totals:  # the method has found them itself: no fields are needed
        return outcome_of(run, run.totals)
    return Solution(run, DEFAULT_OPTIONS).outcome
