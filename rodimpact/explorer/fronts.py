"""A collision that fronts solve: runs of the kernels, and what the page shows of them.

Begin with `solve_by_fronts`. The page has this module as JavaScript. Tests compare its
results with those of `Solution` and `Outcome`.
"""

from typing import Any, NamedTuple

from ..methods.abilities import has_external_drive
from ..methods.clock import Clock, most_rounded, rod_mass
from ..methods.fronts import events, members
from ..methods.fronts.family_layout import FamilyLayout, lay_out_family, make_state
from ..methods.fronts.initial_state import round_trip
from ..methods.fronts.records import FRONT, IDLE, NONE, Run
from ..methods.fronts.status import end_of_run, faint_sentence
from ..methods.fronts.totals import (
    final_motion,
    initial_motion,
    last_contact_end,
    tally_of,
)
from ..methods.pieces import reading
from ..methods.pieces.layout import piece_of
from ..methods.pieces.records import NEVER
from ..methods.record_lists import blank
from ..methods.row_builder import build_row
from ..methods.scales import smallest
from ..methods.states import Stop
from ..methods.status import RunEnd, rounding_sentence, strain_warning
from ..results.front_polygons import count_of_regions, polygons_of, wave_of
from ..theory import pair_numbers, pair_restitution
from ..units import format_si
from .facts import RunSummary, facts_of_outcome

INITIAL_LOG_ROWS = 32
"""Rows of the log at t = 0; it grows when it is full."""
FIRST_HORIZON_SHARE = 1.0
"""Share of the default horizon that the first clock counts.

The page's clock has fewer bits and begins with a smaller share, so that its ticks are
fine. A run that outlasts its clock is made again.
"""
MAX_REGIONS = 3000
"""Largest number of polygons of constant state that the page draws."""
TOO_FAR_APART = (
    "times too far apart for the clock of this page; rodimpact run may solve it"
)


class PageRun(NamedTuple):
    """A collision, and the records that its run fills."""

    layout: FamilyLayout
    state: Any  # a `State` whose log is a list, which can grow
    record: Run  # the only one of `state.runs`


# Runs ---------------------------------------------------------------------------------


def new_run(layout: Any) -> PageRun:
    """A collision that has not begun, with the records of its run."""
    state = make_state(layout, INITIAL_LOG_ROWS, [layout.values])
    return PageRun(layout, state, state.runs[0])


def run_to_end(request: Any, run_past_proof: bool, run: PageRun) -> PageRun:
    """Run a collision to its given end, or to its proof of finality; return `run`.

    The records of `run` are changed. Without a given end, that is if `until` of the
    request is negative, the clock first counts `FIRST_HORIZON_SHARE` of its longest
    horizon. A run that outlasts its clock begins again on one that counts four times as
    far, up to the whole horizon.

    Parameters
    ----------
    request : RunRequest
    run_past_proof : bool
        Whether it goes on for a round trip after the proof of finality.
    run : PageRun
    """
    record = run.record
    record.max_events = request.max_events
    record.run_past_proof = run_past_proof
    if request.until >= 0:
        record.until = request.until
        run_from_start(run)
        return run
    share = FIRST_HORIZON_SHARE
    record.until = -share  # a negative number asks for this share of the horizon
    run_from_start(run)
    while record.stop_reason == Stop.CLOCK and share < 1:
        share = min(4 * share, 1.0)
        record.until = -share
        run_from_start(run)
    return run


def run_from_start(run: PageRun) -> None:
    """Run from t = 0 on the clock that `record.until` asks for, until the run stops.

    A log that is full becomes four times as long.
    """
    log = run.state.log
    while not members.run_members(run.state):
        log.extend(blank(3 * len(log), FRONT))


# Waves --------------------------------------------------------------------------------


def motion_of_fronts(run: PageRun) -> Any:
    """Motion of a run, in the form of the module `motion`, with constant waves.

    Its end ``now`` is the end of the run, halved until at most `MAX_REGIONS` regions
    are to be drawn. The lists of masses and springs are empty. The entry ``rods`` has
    the same waves in the form of `polygons_of`.
    """
    record = run.record
    row = run.layout.row
    transits = transits_of(run)
    waves = waves_of_fronts(run)
    rods = rods_of(row, transits, waves)
    now: int = record.now
    while now > 0 and count_of_regions(rods, 0, now, MAX_REGIONS) > MAX_REGIONS:
        now //= 2
    return {
        "row": row,
        "tick": record.tick_duration,
        "frame": record.frame_velocity,
        "transits": transits,
        "now": now,
        "waves": waves,
        "masses": [],
        "springs": [],
        "exact": True,
        "draft": False,
        "rods": rods,
    }


def transits_of(run: PageRun) -> list[Any]:
    """Transit times of the segments from left to right, ticks."""
    # The first and the last segment of the state lie outside the row.
    inside = run.state.segments[1 : len(run.layout.row.segments) + 1]
    return [segment.transit for segment in inside]


def waves_of_fronts(run: PageRun) -> list[Any]:
    """Waves of all segments in the form of `reading.waves_of`, two for each segment.

    The waves of the outside on the right follow as the last two. Each front begins a
    constant piece, which counts until the next piece of its line begins.
    """
    state = run.state
    pieces: list[Any] = []
    for front in state.log[: run.record.log_rows]:
        # Line -1 stands for a change of a contact, 0 and 1 for the outside on the left.
        if front.line > 1:
            piece = piece_of(front.tick, NEVER, [front.value])
            piece.line = front.line - 2  # the first line inside the row becomes 0
            piece.break_order = 0  # the wave itself jumps at its start
            pieces.append(piece)
    return reading.waves_of(pieces, len(state.lines) - 2)


def rods_of(row: Any, transits: list[Any], waves: list[Any]) -> list[Any]:
    """For each body its segments with numbers and waves, in the form of `polygons_of`.

    `transits` are in ticks, and `waves` has two for each segment. A wall or a mass has
    no segments.
    """
    rods = []
    for i in range(len(row.spans)):
        pieces = []
        # Spans count the segments from 1; a wall or a mass has the empty span (1, 0).
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            segment = row.segments[s]
            pieces.append(
                {
                    "length": segment.length,
                    "wave_speed": segment.wave_speed,
                    "youngs_modulus": segment.material.youngs_modulus,
                    "ticks": transits[s],
                    "rightward": constant_wave(waves[2 * s]),
                    "leftward": constant_wave(waves[2 * s + 1]),
                }
            )
        rods.append({"body": i, "pieces": pieces})
    return rods


def constant_wave(wave: Any) -> Any:
    """A wave of `waves_of` with constant pieces, in the form of `front_polygons`."""
    values = [piece.coefficients[0] for piece in wave["piece"]]
    return wave_of(wave["start"], values)


# Contacts -----------------------------------------------------------------------------


def contact_curves(run: PageRun, stop: int) -> list[Any]:
    """Curves of the ``force``, N, and of the ``gap``, m, of each contact.

    They have points at t = 0, at each change of the contact, and at the tick `stop`.
    The gap of a bond is None. The kernel runs again for these curves, event by event,
    on new records.
    """
    second_run = new_run(run.layout)
    state = second_run.state
    record = second_run.record
    record.until = run.record.until
    record.max_events = 0  # stops the run after the events at t = 0
    record.run_past_proof = 1
    run_from_start(second_run)
    record.max_events = run.record.max_events
    record.next_proof_event = IDLE  # no proof is tried: the first run has it
    curves = []
    for contact in run.layout.row.system.contacts:
        curves.append(empty_curves(contact))
    now = 0
    while now <= stop:
        for i, node in enumerate(contacts_of(second_run)):
            has_changed = node.solved_tick == now
            if has_changed or now in (0, stop):
                add_change(curves[i], node, now, run.record.tick_duration)
        if now < stop:
            now = min(state.queue[1], stop)  # tick of the next event
        else:
            now = stop + 1  # ends the loop
        # The run goes on to the tick `now`. A full log stops it; it is made longer.
        while events.advance(state, min(now, stop)) == Stop.FULL:
            state.log.extend(blank(len(state.log), FRONT))
    return curves


def empty_curves(contact: Any) -> Any:
    """Curves ``force`` and ``gap`` of a contact without any point.

    The gap of a bond is None.
    """
    gap: Any = None
    if contact.opens:
        gap = {"t": [], "y": []}
    return {"force": {"t": [], "y": []}, "gap": gap}


def add_change(curves: Any, node: Any, now: int, tick_duration: float) -> None:
    """Add the force and the gap of a contact at the tick `now` to its curves.

    The force is a step curve: two points are added, with the force before and after
    `now`; to an empty curve only the latter. To the curve of the gap one point is
    added: the gap at `solved_tick`, which changes at `gap_rate` until `now`. A bond has
    no curve of the gap.
    """
    t = now * tick_duration
    force = curves["force"]
    if len(force["t"]) > 0:  # the force held until now
        force["t"].append(t)
        force["y"].append(force["y"][-1])
    force["t"].append(t)
    force["y"].append(node.force)
    gap = curves["gap"]
    if gap is not None:
        gap_now = node.gap + node.gap_rate * (now - node.solved_tick)  # m/s times ticks
        gap_now = max(gap_now, 0.0)  # round-off may make it negative
        gap["t"].append(t)
        gap["y"].append(gap_now * tick_duration)


# Outcome ------------------------------------------------------------------------------


def outcome_of(run: PageRun, status: str) -> Any:
    """The outcome of a collision, a dictionary of `facts_of_outcome`.

    `status` says why the run ended. The only stated error is that of velocities.
    """
    record = run.record
    row = run.layout.row
    segments = run.state.segments
    clock = clock_of(run)
    # A transit time is rounded by the part `error` of itself, an event by a tick.
    error, _ = most_rounded(row, clock.transits, clock.tick)
    error_of_event = (error + 1 / max(clock.transits)) * record.velocity_scale  # m/s
    contacts = [tally_of(node, clock.tick) for node in contacts_of(run)]
    errors = {"velocity": error_of_event * record.events}
    summary = RunSummary(contacts, is_proved(run), status, errors)
    masses = [rod_mass(clock, i) for i in range(len(row.spans))]
    before = initial_motion(clock, masses, segments)
    after = final_motion(clock, masses, segments)
    return facts_of_outcome(row.system, before, after, summary)


def clock_of(run: PageRun) -> Clock:
    """The clock of a run, with its ticks, transit times, frame and impedances.

    Its scale, reference and last tick, which nobody reads, are 0.
    """
    record = run.record
    row = run.layout.row
    transits = transits_of(run)
    # By segment, with 0 for the outside at both ends
    impedance = [0.0, *[segment.impedance for segment in row.segments], 0.0]
    tick = record.tick_duration
    scale = 0.0
    reference = 0.0
    last_tick = 0
    frame = record.frame_velocity
    return Clock(row, tick, transits, frame, scale, reference, last_tick, impedance)


def contacts_of(run: PageRun) -> list[Any]:
    """The nodes of the contacts in the state of a run, from left to right."""
    return [run.state.nodes[k] for k in run.layout.contacts]


def is_proved(run: PageRun) -> bool:
    """Whether the outcome is proved to be final.

    It never is if a driven end acts until a given end of the run.
    """
    record = run.record
    has_proof: bool = record.proved_tick != NONE
    is_driven_to_end = record.until >= 0 and has_external_drive(run.layout.row.system)
    return has_proof and not is_driven_to_end


def why_ended(run: PageRun) -> RunEnd:
    """Why the run ended: a statement, and advice to users of Python."""
    record = run.record
    contacts = contacts_of(run)
    longest_trip = round_trip(run.state.segments) * record.tick_duration  # s
    last = last_contact_end(record, contacts, longest_trip)  # end of the last contact
    return end_of_run(record, contacts, run.layout.row.system, is_proved(run), last)


def status_of(run: PageRun) -> str:
    """Sentences on a run: `Solution.status` without advice.

    They say why it ended, then, if there are any, name transit times that the clock
    rounds, strains that are not small, and contacts whose force decays below the
    tolerance.
    """
    record = run.record
    row = run.layout.row
    contacts = contacts_of(run)
    tick = record.tick_duration
    error, path = most_rounded(row, transits_of(run), tick)
    wave_speeds = [segment.wave_speed for segment in row.segments]
    # With the waves a and b the strain is (b - a)/(2 c): at most the largest wave over
    # the least c.
    strain = record.max_wave / smallest(wave_speeds)
    remarks = rounding_sentence(error, path) + strain_warning(strain)
    decaying = faint_sentence(record, contacts, row.system)
    return why_ended(run).statement + remarks + decaying


# Solution -----------------------------------------------------------------------------


def solve_by_fronts(system: Any, request: Any) -> Any:
    """Solve a collision by fronts, for the page.

    Returns
    -------
    dict
        The solution, in the form that `solved.scene_of_solution` takes. If there is no
        result, or nothing to show, a ``problem``, path and sentence, and ``advice`` to
        users of Python.
    """
    run = new_run(lay_out_family(build_row(system)))
    run_past_proof = True  # the page shows a round trip after the proof
    run_to_end(request, run_past_proof, run)
    record = run.record
    if record.stop_reason >= Stop.OVERFLOW:  # there is no result
        return {"problem": ("bodies", TOO_FAR_APART), "advice": ""}
    outcome = outcome_of(run, status_of(run))
    motion = motion_of_fronts(run)
    stop = motion["now"]  # the end of the run, halved until all regions can be drawn
    tick = motion["tick"]
    if stop == 0:
        message = "has too many fronts to show"
        if record.now == 0:
            message = "lasts no time to show"
        sentences = f"{message}. {outcome['status']}"
        return {"problem": ("solve", sentences), "advice": why_ended(run).advice}
    notes = [outcome["status"]]
    if stop < record.now:
        end = format_si(stop * tick, "s", 4)
        notes.append(f"The picture ends at {end}: too many regions later.")
    return {
        "motion": motion,
        "outcome": outcome,
        "method": "fronts",
        "notes": notes,
        "closed_form": closed_form_of(system, outcome["before"]),
        "contacts": contact_curves(run, stop),
        "tiling": polygons_of(motion["rods"], tick, motion["frame"], 0, stop),
    }


def closed_form_of(system: Any, before: list[float]) -> Any:
    """``restitution`` e of a pair in closed form, and its ``source``, else None.

    A closed form exists for two uniform rods, or a rod and a wall, that approach each
    other, with a contact that can open, free ends, one velocity each and no strain. On
    a wall e is 1.

    Parameters
    ----------
    system : System
    before : list of float
        Velocities of the bodies before the collision, m/s.
    """
    bodies = system.bodies
    if len(bodies) != 2 or not system.contacts[0].opens:
        return None
    if before[0] <= before[1]:  # they do not approach
        return None
    for body in bodies:
        has_one_velocity = isinstance(body.velocity, float)
        if not has_one_velocity or body.strain != 0.0 or len(body.segments) > 1:
            return None
    for end in system.ends:
        if end.kind != "free":
            return None
    if any(body.kind == "wall" for body in bodies):
        return {"restitution": 1.0, "source": "textbook, box 10.4"}
    left = bodies[0].segments[0]
    right = bodies[1].segments[0]
    numbers = pair_numbers(
        left.impedance, left.transit_time, right.impedance, right.transit_time
    )
    e = float(pair_restitution(numbers))
    return {"restitution": e, "source": "Saint-Venant 1867"}
