"""Conditions of a cell: numbers that are positive while a collision goes as in a run.

Between contacts the mechanics is linear: in which order fronts reach free ends and
joints changes no result. Only the contacts decide. So a collision goes the same way if

- each contact that presses keeps pressing, and each that is open stays open, until
  the next change of its status (`contact_phases`),
- its changes come in the same order, and
- the contacts do not press again for the same reason (`separation`).
"""

from ..methods.fronts.simulation import Simulation
from ..methods.groups import unilateral
from ..methods.states import Stop
from .checks import FormulaTooLong
from .contact_phases import phase_conditions, phases_of_contact
from .exact_run import ExactRun
from .separation import separation_of
from .traced_fraction import HALF, ZERO, TracedFraction

EVENTS_PAST_PROOF = 8
"""Cap on the events of a run that is continued past its proof, over the cap before.

The run continues for up to two transits of the longest body. A row of similar rods then
has at most 6 times as many events as at the proof.
"""


def cell_conditions(run: ExactRun, *, in_order: bool) -> list[TracedFraction]:
    """Numbers that are positive throughout the cell of a run, and depend on names.

    They come from the separation and from the phases of each contact that can open, and
    from the ticks of the fronts that are in flight at the end. Numbers that are 0 in
    this run are left out.

    Parameters
    ----------
    run : ExactRun
        A run that is final. It is continued here, beyond its proof.
    in_order : bool
        Whether fronts must reach each contact in the order of the run. The conditions
        are then rational functions. Otherwise some contain unit steps, which floats can
        evaluate, and the cell is larger.

    Raises
    ------
    FormulaTooLong
        If the continued run has more than `EVENTS_PAST_PROOF` times the events
        that its cap allows: transit times are too different.
    """
    simulation = run.simulation
    max_events = EVENTS_PAST_PROOF * simulation.run.max_events
    contacts = unilateral(run.row.system)
    proof_tick = _proof_tick(simulation, max_events)
    # A proof just after a contact has opened would hold in a small cell only. So the
    # proof is taken later: by half of the time for which contacts had been open.
    margin = (proof_tick - _last_change(simulation, proof_tick)) * HALF
    end = proof_tick + margin
    _run_on(simulation, end, max_events)
    conditions: list[TracedFraction] = []
    uses_energy = False
    for contact in contacts:
        separation = separation_of(run, contact, end)
        conditions += separation.conditions
        uses_energy |= separation.uses_energy
    # Fronts in flight must not arrive before the end. The run is continued until they
    # arrive: each meets a contact within a round trip of its body.
    until_arrivals = end + margin + 2 * _longest_transit(run)
    _run_on(simulation, until_arrivals, max_events)
    for contact in contacts:
        # Events up to end + margin keep their phases; later ones come after the end.
        history = phases_of_contact(run, contact, end + margin)
        last_change = history.phases[-1].start
        for arrival in history.later_ticks:
            # Elsewhere in the cell the end may lie before the last change: a later
            # arrival stays after both.
            conditions.append(arrival - end)
            conditions.append(arrival - last_change)
        if uses_energy:
            # The energy of vibration is that after the last change. So this change must
            # stay on its side of the end, whichever side that is. The absolute value is
            # 0 where it crosses the end.
            conditions.append(abs(end - last_change))
        for phase in history.phases:
            conditions += phase_conditions(phase, in_order)
    if in_order:
        # Such a run is made at a generic point near the system, where two conditions
        # have equal values only if they are the same function.
        condition_by_value = {x.value: x for x in conditions}
        conditions = list(condition_by_value.values())
    return [x for x in conditions if x.expression is not None and x.value != 0]


def _proof_tick(simulation: Simulation, max_events: int) -> TracedFraction:
    """Tick of the proof as a traced fraction, a function of the names.

    The kernel finds its proof at the tick of an event, or between two events. In the
    latter case `simulation` is run on to the next event, and the tick of this event is
    returned.
    """
    # Adding ZERO makes a traced fraction of an integer.
    proof_tick: TracedFraction = simulation.run.proved_tick + ZERO
    # The tick of an event is a function of the names already. A tick between two events
    # is a mere integer, which does not depend on them.
    for row in simulation.log[: simulation.run.log_rows]:
        if proof_tick == row.tick:
            return proof_tick
    next_tick: TracedFraction = simulation.queue[1]  # root of the tree: the earliest
    _run_on(simulation, next_tick, max_events)
    return next_tick


def _run_on(simulation: Simulation, end: TracedFraction, max_events: int) -> None:
    """Let a run go on to a tick; FormulaTooLong if its cap on events stops it."""
    stop = simulation.run_to(end, max_events, tolerance=ZERO)
    if stop == Stop.CAP:
        message = (
            f"where the formula holds is not known after {max_events} events, "
            f"{EVENTS_PAST_PROOF} times this cap; raise it, or make transit times less "
            "different"
        )
        raise FormulaTooLong([("max_events", message)])


def _last_change(simulation: Simulation, end: TracedFraction) -> TracedFraction:
    """Tick of the last change of a contact up to `end`; 0 without a change."""
    last_change = ZERO
    for change in simulation.changes:
        tick = change.tick + ZERO  # an integer becomes traced
        if tick <= end and tick > last_change:
            last_change = tick
    return last_change


def _longest_transit(run: ExactRun) -> TracedFraction:
    """Longest transit time of a body, the sum over its segments, ticks."""
    longest = ZERO
    for first, last in run.row.spans:
        if last == 0:  # a wall has no segments
            continue
        transit = ZERO
        for segment in run.simulation.segments[first : last + 1]:
            transit = transit + segment.transit
        if transit > longest:
            longest = transit
    return longest
