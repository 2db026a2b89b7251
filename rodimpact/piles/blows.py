"""Blows on a pile, one after another, each until the soil can yield no more.

The ram is caught at the top of its bounce at the latest, and so are masses such as a
helmet that rise from the pile with it: the pile then comes to rest without them. A blow
is over when the remaining motion has too little energy to make soil yield again. The
set is then known, and so is the equilibrium to which damping brings the pile: the next
blow begins there.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing
from ..methods.status import quake_warning
from ..model import Plastic, RigidMass, Rod, Soil, System, Wall
from ..model.arguments import check_kind, demand, integer, scalar
from ..model.ends import FREE
from ..model.frozen import InvalidModel, Problems, raise_if_problems
from ..model.soil import resistances
from ..progress import Progress, ProgressFunction, check_progress
from ..results.extreme_stress import ExtremeStress, StressPeak, strongest
from ..results.grid_fields import GridFields
from ..results.solution import Solution
from ..running.solving import solve
from ..units import format_si
from .resting import CELLS, MAX_CELLS, at_rest, resting_system
from .statics import (
    Chain,
    Equilibrium,
    can_yield,
    chain_of,
    find_equilibrium,
    nodes_of,
    potential_energy,
)

MIN_CELLS = 2
"""Smallest number of cells that a call may ask for."""
MAX_BLOWS = 10_000
"""Largest number of blows that a call may ask for."""
TRANSITS_OF_BLOW = 10
"""Transit times of the pile in the usual duration of a blow."""
MAX_LENGTHENINGS = 5
"""How often the usual duration of a blow is doubled at most."""
CATCH_SAMPLES = 4001
"""Times of a run at which the motion of the ram and the masses below is examined."""
ROUND_TRIP_SAMPLES = 401
"""Times in a round trip of waves at which the gap below the ram is examined."""


class PileRow(NamedTuple):
    """The parts of a row that drives a pile."""

    pile: int  # index of the first body of the pile, the first rod after the ram
    toe: int  # index of the contact between the last rod and the wall below it


@explain_missing()
class Blow(NamedTuple):
    """Result of one blow on a pile.

    Attributes
    ----------
    solution : Solution
        The blow from the impact on, until it is over or the ram is caught.
    settling : Solution or None
        The continued run of the pile, without the ram and the masses that were caught
        with it. Its time 0 is ``solution.t_end``. None if the blow was over before.
    set : float
        Permanent displacement of the soil below the toe, m.
    displacement : float
        Displacement of the toe from rest to rest, m; nan if the blow is not over. It is
        equal to the set if the residual stresses no longer change, as from the second
        or third blow on.
    compression, tension : StressPeak
        Largest stresses in the pile from the impact until the blow is over, Pa, with
        the distance x from the head of the pile, m, and the time t after the impact, s.
    is_over : bool
        Whether it is certain that no soil can yield any more.
    status : str
        The same in a sentence, with the remedy.
    next_system : System or None
        The pile at rest after the blow, with the hammer ready for the next blow. None
        if the blow is not over, or if the pile does not stay at rest; see `status`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=300e3, quake=2.5e-3, damping=0.16)
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel, shaft=soil)
    >>> toe = ri.SmithToe(resistance=300e3, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> (blow,) = ri.blows(system, 1, cells=50)
    >>> blow.is_over, round(blow.blow_count)
    (True, 41)
    """

    solution: Solution
    settling: Solution | None
    set: float
    displacement: float
    compression: StressPeak
    tension: StressPeak
    is_over: bool
    status: str
    next_system: System | None

    @property
    def blow_count(self) -> float:
        """Blows for a metre of set, 1/m; inf without set."""
        if self.set <= 0:
            return math.inf
        return 1 / self.set

    @property
    def t_end(self) -> float:
        """End of the blow, s after the impact."""
        return _total_time(_runs_of(self.solution, self.settling))

    def __repr__(self) -> str:
        return f"<Blow: {self}>"

    def __str__(self) -> str:
        """Set, largest stresses and status."""
        permanent_set = format_si(self.set, "m")
        compression = _peak_text("compression", self.compression)
        tension = _peak_text("tension", self.tension)
        return f"set {permanent_set}, {compression}, {tension}. {self.status}"


def _peak_text(name: str, peak: StressPeak) -> str:
    """A largest stress with its position and time as a text; "no ..." if it is 0."""
    if peak.stress == 0:
        return f"no {name}"
    stress = format_si(abs(peak.stress), "Pa", digits=4)
    place = format_si(peak.x, "m", digits=4)
    time = format_si(peak.t, "s", digits=4)
    return f"largest {name} {stress} at {place} from the head after {time}"


class Aftermath(NamedTuple):
    """The pile at the end of a run, and the rest to which it will come."""

    row: PileRow  # without bodies that were caught before the run
    is_over: bool
    energy: float  # remaining energy above that of the equilibrium, J
    chain: Chain
    equilibrium: Equilibrium  # the equilibrium to which damping brings the pile


@explain_arguments
def blows(
    system: System,
    count: int,
    *,
    cells: int = CELLS,
    until: float | None = None,
    progress: bool | ProgressFunction = True,
) -> list[Blow]:
    """Strike a pile several times; each blow starts from the state after the last one.

    The permanent set of the soil and the residual stresses of the pile are kept. The
    ram, the helmet and the cushions start each time in their initial state.

    Parameters
    ----------
    system : System
        From left to right: a moving ram, masses such as a helmet, the pile, and a wall
        below its toe. The law of the toe is `SmithToe` or another yielding law. If
        gravity acts, begin with ``at_rest(system)``.
    count : int
        Number of blows.
    cells : int, optional
        Cells of the segment with the longest transit time.
    until : float, optional
        Duration of a blow, s. By default a blow goes on until it is over, up to 32
        times its usual duration: the momentum of the ram over the resistance, and ten
        transit times of the pile.
    progress : bool or function
        As for `solve`; it counts blows.

    Returns
    -------
    list of Blow
        Fewer than `count` if a blow is not over, or the pile does not stay at rest
        after it: see the `status` of the last one.

    Raises
    ------
    InvalidModel
        If the system is no pile, or an argument is wrong.

    Examples
    --------
    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=300e3, quake=2.5e-3, damping=0.16)
    >>> pile = ri.Rod(15.0, area=9.4e-3, material=ri.materials.steel, shaft=soil)
    >>> toe = ri.SmithToe(resistance=300e3, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4536.0, velocity=3.466)
    >>> system = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> first, second, third = ri.blows(system, 3, cells=50)
    >>> first.set < second.set, abs(third.displacement / third.set - 1) < 0.01
    (True, True)
    """
    row = check_pile(system)
    count = integer("count", count, 1, MAX_BLOWS)
    cells = integer("cells", cells, MIN_CELLS, MAX_CELLS)
    if until is not None:
        until = scalar("until", until, "s", "positive")
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    series: list[Blow] = []
    state = system
    with Progress(progress, "blows", "blows") as report:
        while len(series) < count:
            report(len(series), count)
            blow = strike(system, state, row, cells, until)
            series.append(blow)
            if blow.next_system is None:
                break
            state = blow.next_system
    return series


# What is a pile
# -----------------------------------------------------------------------------------


def check_pile(system: Any) -> PileRow:
    """The parts of a row that drives a pile; InvalidModel for another row.

    From left to right the row must have a ram that moves to the right, any number of
    rigid masses, a rod, and a wall as the last body, all but the ram at rest. Its ends
    must be free, and the law at the wall must yield.
    """
    check_kind(
        "system", system, System, "rodimpact.System([ram, pile, rodimpact.Wall()])"
    )
    demand(system.shape == (), "system", "is a family; strike its members one by one")
    demand(
        system.ends == (FREE, FREE), "ends", "must be free; a wall stands below the toe"
    )
    bodies = system.bodies
    wall_message = "must end with a wall, the ground far below the toe"
    demand(isinstance(bodies[-1], Wall), "bodies", wall_message)
    count_message = (
        "must be a ram, perhaps masses such as a helmet, a pile and a wall; "
        f"these {len(bodies)} lack the ram or the pile"
    )
    demand(len(bodies) >= 3, "bodies", count_message)
    ram_message = "must be the ram: a RigidMass or Rod with a velocity to the right"
    is_body = isinstance(bodies[0], Rod | RigidMass)
    demand(is_body and _velocity(bodies[0]) > 0, "bodies.0", ram_message)
    pile = 1
    while isinstance(bodies[pile], RigidMass):
        pile += 1
    demand(
        isinstance(bodies[pile], Rod),
        "bodies",
        "must have a Rod, the pile, before the wall",
    )
    for i, body in enumerate(bodies[1:], start=1):
        message = "must be at rest before the blow; the ram alone moves"
        demand(_velocity(body) == 0, f"bodies.{i}", message)
    toe = len(bodies) - 2
    toe_message = "must be SmithToe, or another law that yields, below the toe"
    demand(isinstance(system.contacts[toe], Plastic), f"contacts.{toe}", toe_message)
    return PileRow(pile, toe)


def _velocity(body: Any) -> float:
    """Velocity of a body, m/s; nan if it varies along it."""
    if isinstance(body.velocity, int | float):
        return float(body.velocity)
    return math.nan


def shaft_resistance(system: System) -> float:
    """Ultimate resistance of the soil along all shafts, N."""
    total = 0.0
    for body in system.bodies:
        if isinstance(body, Rod) and isinstance(body.shaft, Soil):
            length = float(body.length)
            total += float(resistances(body.shaft, [0.0, length], length).sum())
    return total


# One blow
# ------------------------------------------------------------------------------------


def strike(
    system: System, state: System, row: PileRow, cells: int, until: float | None
) -> Blow:
    """Strike a pile once: solve the blow to its end, and find the state of rest after.

    If the blow is not over when the ram leaves, the pile goes on without the bodies
    that have left it. If the blow does not end, or the pile does not stay at rest, the
    result has no `next_system`, and its `status` says why.

    Parameters
    ----------
    system : System
        The pile before its first blow, with the hammer as it is before each.
    state : System
        The pile before this blow.
    row : PileRow
    cells : int
    until : float, optional
        Duration, s. By default the blow goes on until it is over, with a limit.
    """
    if until is None:
        usual = _usual_duration(state, row)
        longest = 2**MAX_LENGTHENINGS * usual
    else:
        usual = until
        longest = until
    solution = _solve_impact(state, row, cells, usual, longest)
    settling = None
    aftermath = _aftermath(solution, row)
    time_left = longest - solution.t_end  # s
    if not aftermath.is_over and time_left > 0:
        pile = _without_caught(solution, row)
        # The first run of the settling is as long as the blow so far.
        duration = min(solution.t_end, time_left)
        if until is not None:
            duration = time_left
        settling = _solve_settling(pile, cells, duration, time_left)
        aftermath = _aftermath(settling, pile.row)
    runs = _runs_of(solution, settling)
    displacement = math.nan
    next_system = None
    status = _status(aftermath, _total_time(runs))
    if aftermath.is_over:
        displacement = _toe_displacement(runs, aftermath)
        try:
            next_system = _next_system(system, row, aftermath, cells)
        except InvalidModel as error:
            status += f" No other one can follow: {error}."
    status += quake_warning(system)
    extreme = _extreme_stress(runs, row)
    return Blow(
        solution=solution,
        settling=settling,
        set=_permanent_set(runs),
        displacement=displacement,
        compression=extreme.compression,
        tension=extreme.tension,
        is_over=aftermath.is_over,
        status=status,
        next_system=next_system,
    )


def _solve_impact(
    state: System, row: PileRow, cells: int, duration: float, longest: float
) -> Solution:
    """Solve from the impact until the blow is over, or the ram is caught or has left.

    The run is solved anew with twice the duration until one of these has happened, or
    the longest duration is reached.

    Parameters
    ----------
    state : System
    row : PileRow
    cells : int
    duration, longest : float
        First and longest duration, s.
    """
    while True:
        solution = _solve(state, cells, duration)
        catch = _time_of_catch(solution, row)
        if catch < duration:
            return _solve(state, cells, catch)
        has_left = _bodies_that_left(solution, row) > 0
        if has_left or duration >= longest or _aftermath(solution, row).is_over:
            return solution
        duration = min(2 * duration, longest)


def _solve(state: System, cells: int, duration: float) -> Solution:
    """Solve a system on a grid, for a duration in s."""
    return solve(state, duration, "finite-difference", cells=cells, progress=False)


def _time_of_catch(solution: Solution, row: PileRow) -> float:
    """Time at which the ram is caught, s; inf if that does not happen in the run.

    This is when the ram begins to come down again after it has left the pile, or a mass
    below it does while the ram is off: another, weaker impact would follow. A body has
    left if it rises and has not touched the body below for a round trip of waves.
    """
    times = np.linspace(0.0, solution.t_end, CATCH_SAMPLES)
    round_trip = _round_trip(solution.system, row)
    catch = math.inf
    ram_has_left = np.ones(CATCH_SAMPLES, dtype=bool)
    for body in range(row.pile):
        is_off = solution.contacts[body].gap(times) > 0
        # Time of the last touch up to each time; 0 before the first
        last_touch = np.maximum.accumulate(np.where(is_off, 0.0, times))
        is_off_for_long = times - last_touch >= round_trip
        velocity = solution.mean_velocity(body, times)  # positive is down
        has_left = is_off_for_long & (velocity <= 0)
        if body == 0:
            ram_has_left = has_left
        comes_down = is_off & (velocity > 0)
        # It turns between a time at which it rises and the next, at which it falls.
        turns = ram_has_left[:-1] & has_left[:-1] & comes_down[1:]
        if turns.any():
            catch = min(catch, float(times[turns.argmax()]))
    return catch


def _round_trip(system: System, row: PileRow) -> float:
    """Time in which waves run down the pile and up again, s.

    A body that has been off the pile for a shorter time may be struck again from below.
    """
    transit = 0.0
    for body in system.bodies[row.pile :]:
        transit += float(getattr(body, "transit_time", 0.0))
    return 2 * transit


class CaughtPile(NamedTuple):
    """A pile without the ram and masses that were caught."""

    state: System
    row: PileRow  # indices in this state


def _without_caught(solution: Solution, row: PileRow) -> CaughtPile:
    """State of the pile at the end of a run, without the bodies that have left it."""
    state = solution.system_at(solution.t_end)
    caught = _bodies_that_left(solution, row)
    state = state.replace(
        bodies=state.bodies[caught:],
        gaps=state.gaps[caught:],
        contacts=state.contacts[caught:],
    )
    return CaughtPile(state, PileRow(row.pile - caught, row.toe - caught))


def _solve_settling(
    pile: CaughtPile, cells: int, duration: float, longest: float
) -> Solution:
    """Solve a pile without its ram until the blow is over, or for the longest time, s.

    The run is solved anew with twice the duration as long as the blow is not over.
    """
    while True:
        solution = _solve(pile.state, cells, duration)
        if duration >= longest or _aftermath(solution, pile.row).is_over:
            return solution
        duration = min(2 * duration, longest)


def _runs_of(solution: Solution, settling: Solution | None) -> list[Solution]:
    """The runs of a blow, one or two, in order of time."""
    runs = [solution]
    if settling is not None:
        runs.append(settling)
    return runs


def _total_time(runs: list[Solution]) -> float:
    """Duration of all runs, s."""
    return sum(run.t_end for run in runs)


def _usual_duration(system: System, row: PileRow) -> float:
    """Usual duration of a blow, s.

    It is the momentum of the ram over the resistance of the soil, and
    `TRANSITS_OF_BLOW` transit times of the pile.
    """
    ram: Any = system.bodies[0]
    momentum = float(ram.mass) * _velocity(ram)
    transit = _round_trip(system, row) / 2
    toe: Any = system.contacts[row.toe]
    resistance = float(toe.yield_force) + shaft_resistance(system)
    return momentum / resistance + TRANSITS_OF_BLOW * transit


def _aftermath(solution: Solution, row: PileRow) -> Aftermath:
    """Whether a blow is over when a run ends, and the equilibrium that will follow.

    Bodies that have left the pile are ignored. The others have the remaining energy:
    kinetic energy, and the potential energy above that of the equilibrium.
    """
    fields = solution.fields
    assert isinstance(fields, GridFields)
    state = solution.system_at(solution.t_end)
    left = _bodies_that_left(solution, row)
    bodies = list(state.bodies)
    kinetic = 0.0
    for i in range(left, len(bodies) - 1):  # without the wall
        kinetic += _kinetic_energy(solution, i)
        bodies[i] = bodies[i].replace(velocity=0.0)
    motionless = state.replace(bodies=bodies)
    chain = chain_of(motionless, list(fields.motion.counts), left)
    equilibrium = find_equilibrium(chain)
    energy = kinetic + potential_energy(chain, equilibrium)
    is_over = not can_yield(chain, equilibrium, energy)
    return Aftermath(row, is_over, energy, chain, equilibrium)


def _bodies_that_left(solution: Solution, row: PileRow) -> int:
    """Number of bodies at the left end that have left the pile when a run ends.

    A body has left if it rises and its contact with the body below has been open for a
    round trip of waves in the pile. A mass can only leave if the bodies above it have.
    In a run shorter than a round trip no body has left.
    """
    end = solution.t_end
    round_trip = _round_trip(solution.system, row)
    if end < round_trip:
        return 0
    times = np.linspace(end - round_trip, end, ROUND_TRIP_SAMPLES)
    left = 0
    while left < row.pile:
        is_off = bool(np.all(solution.contacts[left].gap(times) > 0))
        rises = float(solution.mean_velocity(left, end)) <= 0  # positive is down
        if not (is_off and rises):
            break
        left += 1
    return left


def _kinetic_energy(solution: Solution, body: int) -> float:
    """Kinetic energy of a body at the end of a run, J."""
    fields = solution.fields
    description: Any = solution.system.bodies[body]
    if isinstance(description, Rod):
        return fields.energy(body, fields.end, velocity=0.0).kinetic
    velocity = float(solution.velocity(body, 0.0, solution.t_end))
    return float(description.mass) * velocity**2 / 2


def _status(aftermath: Aftermath, t_end: float) -> str:
    """Sentence that says whether a blow is over after a time, s; if not, a remedy."""
    duration = format_si(t_end, "s")
    energy = format_si(aftermath.energy, "J")
    if aftermath.is_over:
        return (
            f"Over after {duration}: the {energy} of motion that are left cannot make "
            "the soil yield."
        )
    return (
        f"Not over after {duration}: the {energy} of motion that are left can make the "
        "soil yield again; raise until=, or give damping to soil and cushion."
    )


def _permanent_set(runs: list[Solution]) -> float:
    """Permanent set of the soil below the toe, m: the sum over all runs."""
    total = 0.0
    for run in runs:
        total += run.contacts[-1].permanent_set()
    return total


def _toe_displacement(runs: list[Solution], aftermath: Aftermath) -> float:
    """Displacement of the toe from the beginning of a blow to rest, m.

    It is the displacement in all runs, and that from the last state to equilibrium.
    """
    chain = aftermath.chain
    body = aftermath.row.toe
    toe_node = nodes_of(chain.row, chain.mesh, body).stop - 1
    total = float(aftermath.equilibrium.displacement[toe_node])
    for run in runs:
        bottom = len(run.system.bodies) - 2  # the body above the wall
        length = float(getattr(run.system.bodies[bottom], "length", 0.0))
        start, end = run.displacement(bottom, length, [0.0, run.t_end])
        total += float(end - start)
    return total


def _next_system(
    system: System, row: PileRow, aftermath: Aftermath, cells: int
) -> System:
    """System for the next blow: the pile at rest after this one, and the first hammer.

    The hammer, everything above the pile, is that of `system`, as before the first
    blow.

    Raises
    ------
    InvalidModel
        If nothing holds the pile, or soil yields when a ram that lay on the pile is
        lifted.
    """
    is_held = shaft_resistance(system) > 0 or system.gravity > 0
    demand(is_held, "gravity", "must be positive for a pile that no soil holds")
    after = resting_system(aftermath.chain, aftermath.equilibrium)
    pile = row.pile
    pile_after = aftermath.row.pile  # smaller, if bodies above the pile were caught
    return at_rest(
        system.replace(
            bodies=system.bodies[:pile] + after.bodies[pile_after:],
            gaps=system.gaps[:pile] + after.gaps[pile_after:],
            contacts=system.contacts[:pile] + after.contacts[pile_after:],
        ),
        cells,
    )


def _extreme_stress(runs: list[Solution], row: PileRow) -> ExtremeStress:
    """Largest tension and compression in the rods of the pile over all runs.

    Positions count from the head of the pile, m, and times from the impact, s.
    """
    tensions = []
    compressions = []
    start = 0.0  # of the run, s after the impact
    for run in runs:
        caught = len(runs[0].system.bodies) - len(run.system.bodies)
        first_of_pile = row.pile - caught
        left_end = 0.0  # of the rod, m from the head of the pile
        for i, body in enumerate(run.system.bodies):
            if i < first_of_pile or not isinstance(body, Rod):
                continue
            extreme = run.extreme_stress(i)
            tensions.append(_moved(extreme.tension, left_end, start))
            compressions.append(_moved(extreme.compression, left_end, start))
            left_end += float(body.length)
        start += run.t_end
    return ExtremeStress(strongest(tensions), strongest(compressions))


def _moved(peak: StressPeak, x: float, t: float) -> StressPeak:
    """The peak with x, m, added to its position and t, s, to its time."""
    return peak._replace(x=peak.x + x, t=peak.t + t)
