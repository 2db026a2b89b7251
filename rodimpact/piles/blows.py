"""Blows on a pile, one after another, each until the soil can yield no more.

A blow is over when the ram has left, and what is left of the motion has too little
energy to make soil yield again. The set is then known, and so is the equilibrium to
which damping brings the pile: the next blow begins there.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..hints import explain_arguments, explain_missing
from ..model import Plastic, RigidMass, Rod, Soil, System, Wall
from ..model.arguments import demand, integer, of_kind, scalar
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
"""Fewest cells that may be asked for."""
MAX_BLOWS = 10_000
"""Most blows that may be asked for."""
TRANSITS_OF_BLOW = 10
"""Transit times of the pile that a blow takes at least, about."""
MAX_LENGTHENINGS = 5
"""How often the duration of a blow is doubled, where none is given."""


class PileRow(NamedTuple):
    """The parts of a row that drives a pile."""

    pile: int  # the first rod after the ram
    toe: int  # the contact of the last rod with the wall below it


@explain_missing()
class Blow(NamedTuple):
    """What one blow did to a pile.

    Attributes
    ----------
    solution : Solution
        The blow, from the impact on.
    set : float
        How far the soil below the toe has yielded for good, m.
    displacement : float
        Displacement of the toe from rest to rest, m; nan if the blow is not over. From
        the second or third blow on it is the set, when the residual stresses no longer
        change.
    compression, tension : StressPeak
        Largest stresses in the pile, Pa, with place x, m from the head of the pile, and
        time.
    is_over : bool
        Whether it is certain that no soil yields any more.
    status : str
        The same in a sentence, with the remedy.
    next_system : System or None
        The pile at rest after the blow, with the hammer ready for the next one; None if
        the blow is not over, or the pile does not stay, as the `status` says.

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


class Aftermath(NamedTuple):
    """A blow at the end of its solution."""

    is_over: bool
    energy: float  # of motion that is left, above that of the equilibrium, J
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
    """Strike a pile again and again; each blow finds it as the one before has left it.

    The plastic set of the soil and the residual stresses of the pile are kept. Ram,
    helmet and cushions begin anew.

    Parameters
    ----------
    system : System
        From left to right: a ram that moves, masses such as a helmet, the pile, and a
        wall below its toe. The law of the toe is `SmithToe` or another that yields.
        Where gravity acts, begin with ``at_rest(system)``.
    count : int
        Number of blows.
    cells : int, optional
        Cells of the segment with the longest transit time.
    until : float, optional
        Longest duration of a blow, s. By default a blow goes on until it is over, up to
        32 times its usual duration: the momentum of the ram over the resistance, and
        ten transit times of the pile.
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
    """The parts of a row that drives a pile; InvalidModel for another row."""
    of_kind("system", system, System, "rodimpact.System([ram, pile, rodimpact.Wall()])")
    demand(system.shape == (), "system", "is a family; strike its members one by one")
    demand(
        system.ends == (FREE, FREE), "ends", "must be free; a wall stands below the toe"
    )
    bodies = system.bodies
    wall_message = "must end with a Wall, the ground far below the toe"
    demand(len(bodies) >= 3 and isinstance(bodies[-1], Wall), "bodies", wall_message)
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
    """Strike a pile once.

    Parameters
    ----------
    system : System
        The pile before its first blow, with the hammer as it is before each.
    state : System
        The pile before this blow.
    row : PileRow
    cells : int
    until : float, optional
        Longest duration, s.
    """
    duration = until
    lengthenings = 0
    if duration is None:
        duration = _usual_duration(state, row)
        lengthenings = MAX_LENGTHENINGS
    while True:
        solution = solve(
            state, duration, "finite-difference", cells=cells, progress=False
        )
        aftermath = _aftermath(solution, row)
        if aftermath.is_over or lengthenings == 0:
            break
        duration *= 2
        lengthenings -= 1
    displacement = math.nan
    next_system = None
    status = _status(aftermath, solution.t_end)
    if aftermath.is_over:
        displacement = _toe_displacement(solution, row, aftermath)
        try:
            next_system = _next_system(system, row, aftermath, cells)
        except InvalidModel as error:
            status += f" No other one can follow: {error}."
    extreme = _extreme_stress(solution, row)
    return Blow(
        solution=solution,
        set=solution.contacts[row.toe].permanent_set(),
        displacement=displacement,
        compression=extreme.compression,
        tension=extreme.tension,
        is_over=aftermath.is_over,
        status=status,
        next_system=next_system,
    )


def _usual_duration(system: System, row: PileRow) -> float:
    """Time in which the soil stops the ram, and waves run up and down the pile, s."""
    ram: Any = system.bodies[0]
    momentum = float(ram.mass) * _velocity(ram)
    transit = 0.0
    for body in system.bodies[row.pile :]:
        transit += float(getattr(body, "transit_time", 0.0))
    toe: Any = system.contacts[row.toe]
    resistance = float(toe.yield_force) + shaft_resistance(system)
    return momentum / resistance + TRANSITS_OF_BLOW * transit


def _aftermath(solution: Solution, row: PileRow) -> Aftermath:
    """Whether a blow is over when its solution ends, and where the pile rests."""
    fields = solution.fields
    assert isinstance(fields, GridFields)
    state = solution.system_at(solution.t_end)
    left = _bodies_that_left(solution, state, row)
    bodies = list(state.bodies)
    kinetic = 0.0
    for i in range(left, len(bodies) - 1):
        kinetic += _kinetic_energy(solution, i)
        bodies[i] = bodies[i].replace(velocity=0.0)
    motionless = state.replace(bodies=bodies)
    chain = chain_of(motionless, list(fields.motion.counts), left)
    equilibrium = find_equilibrium(chain)
    energy = kinetic + potential_energy(chain, equilibrium)
    is_over = not can_yield(chain, equilibrium, energy)
    return Aftermath(is_over, energy, chain, equilibrium)


def _bodies_that_left(solution: Solution, state: System, row: PileRow) -> int:
    """Number of bodies at the left end that have left the pile for good.

    The ram has left when it is off and rises: it is caught. Masses below it leave in
    the same way if no gravity brings them back, and none catches up with the one above
    it.
    """
    left = 0
    fastest = -math.inf  # velocity of the body before, m/s
    while left < row.pile:
        velocity = float(solution.mean_velocity(left, solution.t_end))
        is_off = state.gaps[left] > 0 and fastest <= velocity <= 0
        if not is_off or (left > 0 and state.gravity > 0):
            break
        fastest = velocity
        left += 1
    return left


def _kinetic_energy(solution: Solution, body: int) -> float:
    """Kinetic energy of a body at the end of a run, J."""
    fields = solution.fields
    description: Any = solution.system.bodies[body]
    if isinstance(description, Rod):
        return fields.energy(body, fields.end, 0.0).kinetic
    velocity = float(solution.velocity(body, 0.0, solution.t_end))
    return float(description.mass) * velocity**2 / 2


def _status(aftermath: Aftermath, t_end: float) -> str:
    """Whether a blow is over, in a sentence."""
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


def _toe_displacement(solution: Solution, row: PileRow, aftermath: Aftermath) -> float:
    """Displacement of the toe from the beginning of a blow to rest, m."""
    body = row.toe
    length = float(getattr(solution.system.bodies[body], "length", 0.0))
    start, end = solution.displacement(body, length, [0.0, solution.t_end])
    chain = aftermath.chain
    toe_node = nodes_of(chain.row, chain.mesh, body).stop - 1
    return float(end - start + aftermath.equilibrium.displacement[toe_node])


def _next_system(
    system: System, row: PileRow, aftermath: Aftermath, cells: int
) -> System:
    """The pile as a blow has left it, at rest, below the hammer as it was at first.

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
    return at_rest(
        system.replace(
            bodies=system.bodies[:pile] + after.bodies[pile:],
            gaps=system.gaps[:pile] + after.gaps[pile:],
            contacts=system.contacts[:pile] + after.contacts[pile:],
        ),
        cells,
    )


def _extreme_stress(solution: Solution, row: PileRow) -> ExtremeStress:
    """Largest stresses in the rods of the pile, with places from its head on, m."""
    tensions = []
    compressions = []
    head = 0.0  # left end of the rod, m from the head of the pile
    for i, body in enumerate(solution.system.bodies):
        if i < row.pile or not isinstance(body, Rod):
            continue
        extreme = solution.extreme_stress(i)
        tensions.append(extreme.tension._replace(x=extreme.tension.x + head))
        compressions.append(
            extreme.compression._replace(x=extreme.compression.x + head)
        )
        head += float(body.length)
    return ExtremeStress(strongest(tensions), strongest(compressions))
