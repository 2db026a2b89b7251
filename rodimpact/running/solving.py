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
"""Units of work that a progress bar counts, by method."""


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
        after the proof that no contact can press again.
    method : str
        ``"fronts"``: exact tracking of wave fronts. ``"characteristics"``: waves are
        pieces of polynomials in time, without a time step. This method also solves
        rigid masses, compliant contacts, joints, gravity, smooth initial states and
        driven ends. ``"finite-difference"``: a staggered grid. This method also solves
        damping, tapered rods and lateral inertia. ``"auto"`` uses the first method that
        can solve the system.
    max_events : int
        Limit on the work. If it is reached, `Solution.status` says so. "fronts" counts
        arrivals at ends, "characteristics" the steps of contacts and ends.
        "finite-difference" counts time steps times contacts and ends, if `until` is not
        given.
    dt : float, optional
        Time step of "finite-difference", s. It is shortened if `until` is not a
        multiple of it. By default the step is chosen automatically, and divided until
        the outcome no longer changes.
    rtol : float, optional
        Accepted relative error of velocities and impulses; default 1e-8 for
        "characteristics" and 1e-3 for "finite-difference". "fronts" is exact to
        round-off and has no rtol, so "auto" chooses "characteristics" if rtol is given.
        `Solution.accuracy` gives the stated errors.
    cells : int, optional
        For "finite-difference": cells of the segment with the longest transit time. The
        cells of each other segment follow from the time step. By default the number is
        doubled until the outcome no longer changes.
    snapshots : int or array_like, optional
        For "finite-difference": the largest number of states to store, at equal
        intervals, or the times of these states, s. Fields are interpolated between
        states. Energies are those of the nearest state. By default all steps are
        stored, up to 64 MB. `dt`, `cells` and `snapshots` do not choose the method:
        they are refused if "auto" chooses another method.
    progress : bool or function
        Whether a progress bar may be shown, after two seconds of work, on a terminal or
        in a notebook. A function is called with the number of completed steps (events
        of "fronts") and an estimate of their total number, or None if it is not known.
        An exception that the function raises ends the run.

    Returns
    -------
    Solution

    Raises
    ------
    InvalidModel
        If the system is a family or cannot be put on one clock, or an argument is wrong
        or missing: `until` is needed for a row with driven ends, and for a row with
        gravity and a support that holds it.

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
    """Solve the collision of two bodies and return its outcome.

    The result is ``solve(System([left, right], [gap], [contact])).outcome``.

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
        For the same reasons as in `solve`, and if a number is an array.

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
    if run.totals:  # the method has found the totals itself: fields are not needed
        return outcome_of(run, run.totals)
    return Solution(run, DEFAULT_OPTIONS).outcome
