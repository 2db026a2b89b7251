"""striker(): a stepped striker whose first pulse follows a wanted shape.

The search is in `striker_search`. All waves are those of `rodimpact.solve`.
"""

import numpy as np

from ..hints import explain_arguments
from ..model import Bonded, Material, Rigid, Rod, System
from ..model.arguments import array, check_kind, integer, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..model.laws import RIGID
from ..model.profiles import Steps
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, check_progress
from ..records.signal import Signal
from ..units import shown
from .pulses import MIN_DURATION_RTOL, PulseDesign, force_over_time, no_force
from .striker_search import Striker, StrikerSearch

AREA_RATIO = (1 / 9, 9 / 4)
"""Default limits of areas: diameters from a third to one and a half times the bar's."""
MAX_SEGMENTS = 50
MAX_UNTIL = 20
"""Largest `until` of a wanted pulse, over its duration."""
EXACT_MISFIT = 1e-12
"""A smaller misfit is round-off."""
BETTER_MISFIT_RTOL = 1e-9
"""A smaller improvement of the misfit is no reason for more segments."""
AT_LIMIT_RTOL = 1e-6
"""Relative distance at which an area is at a limit: a difference of logarithms."""


@explain_arguments
def striker(
    wanted: Signal | Steps,
    bar: Rod,
    *,
    velocity: float,
    duration: float,
    until: float | None = None,
    segments: int = 10,
    area_ratio: tuple[float, float] = AREA_RATIO,
    material: Material | None = None,
    contact: Rigid | Bonded = RIGID,
    progress: bool | ProgressFunction = True,
) -> PulseDesign:
    """Find a stepped striker that sends a pulse of a wanted shape into a bar.

    Parameters
    ----------
    wanted : Signal or Steps
        Force on the struck end of the bar over the time since impact, N, positive in
        compression. A signal counts as 0 outside its record.
    bar : Rod
        A uniform rod at rest. Its far end is ignored: the bar counts as semi-infinite.
    velocity : float
        Velocity of the striker, m/s.
    duration : float
        Duration of the pulse, s, which is two transit times of the striker. All
        segments of the striker have equal transit times.
    until : float, optional
        End of the time in which the pulse is compared with `wanted`, s. By default
        twice the duration, so that ringing after the pulse counts.
    segments : int
        Largest number of segments of the striker, from 1 to 50. The striker has fewer
        segments if fewer give a smaller misfit, so the misfit never grows with this
        number. Ten segments take about two seconds, forty a minute.
    area_ratio : (float, float)
        Smallest and largest area of a segment over that of the bar. The default allows
        diameters from a third to one and a half times that of the bar, which can be
        turned on a lathe.
    material : Material, optional
        Material of the striker; by default that of the bar.
    contact : Rigid or Bonded
        By default the faces only push, and a tensile force is 0. For a wanted pulse
        with tension choose `Bonded`.
    progress : bool or function
        Whether a bar may show the progress of the search. A function is called with the
        number of runs done and the number of all runs.

    Returns
    -------
    PulseDesign
        The striker is body 0. Its last segment strikes the bar. `bounded` names the
        segments whose area is at a limit of `area_ratio`. A wider `area_ratio` may then
        give a smaller misfit.

    Raises
    ------
    InvalidModel or ValueError
        If an argument is invalid, or the wanted force pulls at a contact that cannot
        pull.

    Notes
    -----
    If a striker of `n` segments can make the pulse, the first `n` steps of the pulse
    determine its areas. Round-off errors grow behind a large change of area. Such a
    change reflects nearly all of a wave, so the segments behind it hardly change the
    force.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> bar = ri.Rod(2.0, area=3e-4, material=ri.materials.steel)
    >>> peak = 0.4 * bar.segments[0].impedance * 10.0
    >>> ramp = ri.Signal([0.0, peak], [0.0, 100e-6], unit="N")
    >>> design = ri.design.striker(ramp, bar, velocity=10.0, duration=100e-6)
    >>> len(design.system.bodies[0].segments), round(100 * design.misfit, 1)
    (10, 12.9)
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    check_kind("bar", bar, Rod, "Rod(2.0, area=1e-4, material=materials.steel)")
    if material is None:
        material = bar.segments[0].material
    check_kind("material", material, Material, "materials.steel")
    _check_bodies(bar, material, contact)
    V = scalar("velocity", velocity, "m/s", "positive")
    T = scalar("duration", duration, "s", "positive")
    end = 2 * T
    if until is not None:
        end = scalar("until", until, "s", "positive")
    segments = integer("segments", segments, 1, MAX_SEGMENTS)
    if not T * (1 - MIN_DURATION_RTOL) <= end <= MAX_UNTIL * T:
        message = f"must be from the duration, {T!r} s, to {MAX_UNTIL} times that"
        raise invalid_argument("until", f"{message}, got {end!r}")
    ratios = array("area_ratio", area_ratio, "", "positive")
    if ratios.shape != (2,) or not ratios[0] < ratios[1]:
        raise invalid_argument(
            "area_ratio", f"must be (smallest, largest), got {shown(area_ratio)}"
        )
    force = _checked_force(wanted, end, contact)

    search = StrikerSearch(
        bar=bar,
        material=material,
        velocity=V,
        duration=T,
        contact=contact,
        wanted=force,
        bounds=np.log(ratios),
        segments=segments,
    )
    best = _exact_striker(search)
    if best is None:
        strikers = _strikers(search, progress)
        best = _simplest_best(strikers)
    n_segments = len(best.logarithms)
    search = search._replace(segments=n_segments)
    return PulseDesign(
        system=search.system(best.logarithms),
        body=0,
        wanted=force,
        reached=search.force(best.logarithms, force.end),
        misfit=best.misfit,
        staircase=best.misfit_within_steps,
        # Logarithms count from the struck end, segments from the left: reversed.
        bounded=_bounded_segments(best.logarithms[::-1], search.bounds),
    )


def _check_bodies(bar: Rod, material: Material, contact: object) -> None:
    """Raise InvalidModel unless the search can take a bar, a material and a contact.

    The bar must be a single uniform rod at rest and no family, the material without
    viscosity, the contact rigid or bonded.
    """
    is_family = System([bar]).shape != ()
    # A family is refused first: its velocities may be arrays, which `or` does not take.
    if len(bar.segments) != 1 or is_family or bar.velocity or bar.strain:
        raise invalid_argument(
            "bar", f"must be a single uniform rod at rest, got {shown(bar)}"
        )
    if np.any(material.viscosity):
        raise invalid_argument(
            "material", f"must have no viscosity, got {shown(material.name)}"
        )
    if not isinstance(contact, Rigid | Bonded):
        raise invalid_argument(
            "contact", f"must be Rigid() or Bonded(), got {shown(contact)}"
        )


def _checked_force(wanted: object, end: float, contact: Rigid | Bonded) -> Signal:
    """The wanted force until `end`, s, as a signal.

    InvalidModel is raised if it is no force over time, is always 0, or is tensile
    somewhere with a contact that cannot pull.
    """
    force = force_over_time(wanted, end)
    if not force.values.any():
        raise invalid_argument(
            "wanted", "is 0 from impact on; give the force over the time since then"
        )
    lowest = float(force.values.min())
    if lowest < 0 and isinstance(contact, Rigid):
        raise invalid_argument(
            "wanted",
            f"pulls with {-lowest!r} N, and faces only push; make it 0 there, "
            "or take contact=Bonded()",
        )
    return force


def _exact_striker(search: StrikerSearch) -> Striker | None:
    """A striker with all segments that gives the wanted force exactly, else None.

    Exactly means to within `EXACT_MISFIT`. Only a force that is constant within each
    step can be given exactly.
    """
    # The misfit of no force within steps is the variation of the wanted force there.
    misfits = search.misfits(no_force(search.wanted.end))
    if misfits.within_steps.max() > EXACT_MISFIT:
        return None
    striker = search.best_striker(coarser=np.zeros(0))
    if striker.misfit >= EXACT_MISFIT:
        return None
    return striker


def _strikers(
    search: StrikerSearch, progress: bool | ProgressFunction
) -> list[Striker]:
    """The best striker of each number of segments, from 1 to that of the search.

    Each search also starts from the striker with one segment less.
    """

    def runs_up_to(n: int) -> int:
        """Sum of k + 1 for k = 1 to n segments: runs for a step of least squares."""
        return n * (n + 3) // 2

    segments = search.segments
    strikers = []
    coarser = np.zeros(0)  # the striker before, a start for the next one
    with Progress(progress, "striker", "runs") as report:
        for n in range(1, segments + 1):
            striker = search._replace(segments=n).best_striker(coarser)
            strikers.append(striker)
            coarser = striker.logarithms
            report(runs_up_to(n), runs_up_to(segments))
    return strikers


def _simplest_best(strikers: list[Striker]) -> Striker:
    """The striker with the fewest segments among those with the least misfit.

    `strikers` are in the order of their numbers of segments, the fewest first. Misfits
    that differ by `BETTER_MISFIT_RTOL` are the same.
    """
    least = min(striker.misfit for striker in strikers)
    for striker in strikers:
        if striker.misfit * (1 - BETTER_MISFIT_RTOL) <= least:
            return striker
    return strikers[-1]  # only if misfits are NaN


def _bounded_segments(logarithms: Floats, bounds: Floats) -> dict[int, str]:
    """Limit, "smallest" or "largest", of each segment whose area is at a limit.

    The keys are indices of `logarithms`; `bounds` are the smallest and the largest
    logarithm.
    """
    bounded = {}
    for bound, name in zip(bounds, ("smallest", "largest"), strict=True):
        is_at_limit = np.abs(logarithms - bound) <= AT_LIMIT_RTOL
        indices = np.flatnonzero(is_at_limit)
        for i in indices.tolist():
            bounded[i] = name
    return bounded
