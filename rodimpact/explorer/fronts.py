"""A collision that fronts carry: runs of the kernels, and what they come to.

Plain Python around the kernels, which the page has as JavaScript. Tests hold all of it against
`Solution` and `Outcome`.
"""

from typing import Any

from ..methods.abilities import has_external_drive
from ..methods.clock import Clock, mass_of, most_rounded
from ..methods.fronts import events, members
from ..methods.fronts.family_layout import lay_out_family, make_state
from ..methods.fronts.initial_state import round_trip
from ..methods.fronts.records import FRONT, IDLE, NONE
from ..methods.fronts.status import faint_sentence, status_of
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
from ..methods.status import rounding, strain_warning
from ..results.front_polygons import count_of, polygons_of, wave_of
from ..theory import pair_numbers, pair_restitution
from ..units import format_si
from .known import Ending, outcome_shown

ROOM = 32  # rows of the log at first
FIRST_HORIZON_SHARE = 1.0
"""Share of the default horizon that the first clock counts.

The page's clock has fewer bits and begins with less, so that its ticks are fine. A run that
outlasts its clock is made again.
"""
MOST_REGIONS = 3000  # that are drawn
TOO_FAR_APART = (
    "times too far apart for the clock of this page; rodimpact run may solve it"
)


# Runs ---------------------------------------------------------------------------------------------


def run_of(asked: Any, further: bool, space: Any) -> Any:
    """Run a plan to its end; `further` goes on for a round trip after the proof of finality.

    Returns
    -------
    dict
        The `space`, whose records the kernels have left.
    """
    run = space["run"]
    run.max_events = asked.max_events
    run.run_past_proof = further
    if asked.until >= 0:
        run.until = asked.until
        go(space)
        return space
    share = FIRST_HORIZON_SHARE
    run.until = -share
    go(space)
    while run.stop_reason == Stop.CLOCK and share < 1:
        share = min(4 * share, 1.0)
        run.until = -share
        go(space)
    return space


def go(space: Any) -> None:
    """Run from t = 0 on, on the clock that `until` asks for."""
    log = space["state"].log
    while not members.run_members(space["state"]):
        log.extend(blank(3 * len(log), FRONT))


def space_of(plan: Any) -> Any:
    """Space for runs of a plan: the ``plan``, the ``state``, and its ``run``."""
    state = make_state(plan, ROOM, [plan.values])
    return {"plan": plan, "state": state, "run": state.runs[0]}


# What moves ---------------------------------------------------------------------------------------


def motion_of(run: Any) -> Any:
    """A run as `motion` has it, whose waves are constant pieces; it ends where too much is drawn.

    ``rods`` are its waves as `polygons_of` has them.
    """
    it, row, state = run["run"], run["plan"].row, run["state"]
    pieces: list[Any] = []
    for front in state.log[: it.log_rows]:
        if front.line > 1:
            piece = piece_of(
                front.tick, NEVER, [front.value]
            )  # until the next one begins
            piece.line, piece.break_order = front.line - 2, 0
            pieces.append(piece)
    waves = reading.waves_of(pieces, len(state.lines) - 2)
    transits = [at.transit for at in state.segments[1 : len(row.segments) + 1]]
    steady = [
        wave_of(wave["start"], [piece.coefficients[0] for piece in wave["piece"]])
        for wave in waves
    ]
    rods = [
        {
            "body": i,
            "pieces": [
                {
                    "length": row.segments[s].length,
                    "wave_speed": row.segments[s].wave_speed,
                    "youngs_modulus": row.segments[s].material.youngs_modulus,
                    "ticks": transits[s],
                    "rightward": steady[2 * s],
                    "leftward": steady[2 * s + 1],
                }
                for s in range(first - 1, last)
            ],
        }
        for i, (first, last) in enumerate(row.spans)
    ]
    now: int = it.now
    while now > 0 and count_of(rods, 0, now, MOST_REGIONS) > MOST_REGIONS:
        now //= 2
    return {
        "row": row,
        "tick": it.tick_duration,
        "frame": it.frame_velocity,
        "transits": transits,
        "now": now,
        "waves": waves,
        "masses": [],
        "springs": [],
        "exact": True,
        "draft": False,
        "rods": rods,
    }


def contact_curves(run: Any, stop: int) -> list[Any]:
    """Force, N, and gap, m, of each contact, at the times at which the contact changes.

    The kernel runs again, event by event, to `stop`.
    """
    again, tick, now = space_of(run["plan"]), run["run"].tick_duration, 0
    it, state = again["run"], again["state"]
    it.until = run["run"].until
    it.max_events = 0
    it.run_past_proof = 1
    go(again)  # what happens at t = 0
    it.max_events = run["run"].max_events
    it.next_proof_event = IDLE  # nothing is to be proved
    contacts, laws = run["plan"].contacts, run["plan"].row.system.contacts
    changes: list[Any] = [[] for _ in contacts]  # time, force, gap
    while now <= stop:
        for i, k in enumerate(contacts):
            at = state.nodes[k]
            if at.solved_tick == now or now in (0, stop):
                gap = max(at.gap + at.gap_rate * (now - at.solved_tick), 0.0)
                changes[i].append((now * tick, at.force, gap * tick))
        now = min(state.queue[1], stop) if now < stop else stop + 1
        while events.advance(state, min(now, stop)) == Stop.FULL:
            state.log.extend(blank(len(state.log), FRONT))
    return [
        {  # of forces the one before, and the new one
            "force": {
                "t": [at[0] for at in of for _ in (0, 1)][1:],
                "y": [at[1] for at in of for _ in (0, 1)][:-1],
            },
            "gap": {"t": [at[0] for at in of], "y": [at[2] for at in of]}
            if law.opens
            else None,
        }
        for law, of in zip(laws, changes, strict=True)
    ]


# What it comes to ---------------------------------------------------------------------------------


def outcome_of(run: Any, status: str) -> Any:
    """What the collision did, as of `outcome_shown`."""
    record = run["run"]
    row = run["plan"].row
    segments = run["state"].segments
    clock = clock_of(run)
    rounded, _ = most_rounded(row, clock.transits, clock.tick)
    error_of_event = (rounded + 1 / max(clock.transits)) * record.velocity_scale
    ending = Ending(
        [tally_of(node, clock.tick) for node in contacts_of(run)],
        is_proved(run),
        status,
        {"velocity": error_of_event * record.events},
    )
    masses = [mass_of(clock, i) for i in range(len(row.spans))]
    before = initial_motion(clock, masses, segments)
    after = final_motion(clock, masses, segments)
    return outcome_shown(row.system, before, after, ending)


def clock_of(run: Any) -> Clock:
    """The clock of a run."""
    record = run["run"]
    row = run["plan"].row
    inside = run["state"].segments[1 : len(row.segments) + 1]
    transits = [segment.transit for segment in inside]
    impedance = [0.0, *[piece.impedance for piece in row.segments], 0.0]
    tick = record.tick_duration
    return Clock(row, tick, transits, record.frame_velocity, 0.0, 0.0, 0, impedance)


def contacts_of(run: Any) -> list[Any]:
    """The nodes of the contacts."""
    return [run["state"].nodes[k] for k in run["plan"].contacts]


def is_proved(run: Any) -> bool:
    """Whether the outcome is final."""
    it, system = run["run"], run["plan"].row.system
    proved: bool = it.proved_tick != NONE and not (
        it.until >= 0 and has_external_drive(system)
    )
    return proved


def sentence_of(run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    it, row, contacts = run["run"], run["plan"].row, contacts_of(run)
    segments = run["state"].segments
    last = last_contact_end(it, contacts, round_trip(segments) * it.tick_duration)
    sentence = status_of(it, contacts, row.system, is_proved(run), last)
    faint = faint_sentence(it, contacts, row.system)
    ticks = [at.transit for at in segments[1 : len(row.segments) + 1]]
    rounded, worst = most_rounded(row, ticks, it.tick_duration)
    strain = it.max_wave / smallest([piece.wave_speed for piece in row.segments])
    return sentence + rounding(rounded, worst) + strain_warning(strain) + faint


def solved_by_fronts(system: Any, asked: Any) -> Any:
    """A collision as `solved.shown_of` takes it; or a ``problem``, path and sentence."""
    run = run_of(asked, True, space_of(lay_out_family(build_row(system))))
    if run["run"].stop_reason >= Stop.OVERFLOW:
        return {"problem": ("bodies", TOO_FAR_APART)}
    outcome, motion = outcome_of(run, sentence_of(run)), motion_of(run)
    stop, tick = motion["now"], motion["tick"]
    if stop == 0:
        message = (
            "lasts no time to show"
            if run["run"].now == 0
            else "has too many fronts to show"
        )
        return {"problem": ("solve", f"{message}. {outcome['status']}")}
    notes = [outcome["status"]]
    if stop < run["run"].now:
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
    """e of a pair for which theory knows it, and the source; None for any other row."""
    bodies = system.bodies
    if len(bodies) != 2 or not system.contacts[0].opens or before[0] <= before[1]:
        return None
    if any(
        not isinstance(body.velocity, float)
        or body.strain != 0.0
        or len(body.segments) > 1
        for body in bodies
    ) or any(end.kind != "free" for end in system.ends):
        return None
    if any(body.kind == "wall" for body in bodies):
        return {"restitution": 1.0, "source": "textbook, box 10.4"}
    left, right = [body.segments[0] for body in bodies]
    numbers = pair_numbers(
        left.impedance, left.transit_time, right.impedance, right.transit_time
    )
    e = pair_restitution(numbers)
    return {"restitution": e * 1.0, "source": "Saint-Venant 1867"}
