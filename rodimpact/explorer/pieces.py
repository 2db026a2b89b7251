"""A collision that characteristics carry: runs of the kernels, and what they come to.

Plain Python around the kernels, which the page has as JavaScript.
"""

import math
from time import monotonic
from typing import Any

from ..methods.clock import (
    MIN_TRANSIT,
    Clock,
    count_ticks,
    crossing_time_of,
    flight_time_of,
)
from ..methods.groups import body_velocities
from ..methods.link import Law
from ..methods.outcome import Motion
from ..methods.pieces import accuracy, layout, march, reading
from ..methods.pieces.accuracy import Ended, size_of
from ..methods.pieces.layout import InitialLine, RunRequest
from ..methods.pieces.method import RTOL
from ..methods.pieces.records import CONTACT_EVENT, NONE, PIECE, State
from ..methods.pieces.series import N
from ..methods.pieces.totals import (
    last_of,
    simplifications_text,
    stated,
    status_of,
    tally_of,
    why_stopped,
    why_stuck,
)
from ..methods.record_lists import blank
from ..methods.row_builder import build_row
from ..methods.scales import frame_of, largest, scale_of, wave_of_strain
from ..methods.states import Stop
from ..methods.status import strain_warning
from ..methods.tick_rule import default_horizon
from .fronts import TOO_FAR_APART
from .known import Ending, errors_of, outcome_shown
from .motion import curve_of, grids_of

ROOM = 512  # of the log at first
MAX_STEPS = (
    100_000  # of a run that starts: more take longer than a page may stand still
)
LOG_GROWTH = 256  # rows that logs grow by; whenever they grow, the deadline is checked
TOO_MUCH_WORK = (
    "This collision takes too long for the page. Usually one rod is very much shorter than "
    "another, or a contact is very stiff. Make the shortest rod longer or that contact softer; or "
    "solve the collision with Python: rodimpact run CASE.toml"
)


def clock_of(row: Any, until: Any) -> Any:
    """The clock of a row with rods; None where times are too far apart for it."""
    transits = [s.transit_time for s in row.segments]
    reference = largest(transits)
    scale = scale_of(row)
    if not scale > 0:
        scale = 1.0
    end = until
    if until is None:
        crossing_time = crossing_time_of(row)
        flight_time = flight_time_of(row, scale)
        end = default_horizon(reference, crossing_time, flight_time, 1.0)
    total, ticks = count_ticks(transits, reference, end)
    if total == 0 or any(transit <= MIN_TRANSIT for transit in ticks):
        return None
    tick = reference / total
    last_tick = round(end / tick)
    return Clock(row, tick, ticks, frame_of(row), scale, reference, last_tick)


def least_steps(clock: Clock, until: Any) -> float:
    """Lower bound of the steps of one member; to its proof of finality where no end is given.

    A node goes on by twice the shorter transit time beside it at most. A run without an end goes on
    for a round trip of the longest rod after its proof.
    """
    transits = clock.transits
    duration = 2 * max(transits)
    if until is not None:
        duration = clock.last_tick
    steps = 0.0
    for k in range(1, len(transits)):
        steps += duration / (2 * min(transits[k - 1], transits[k]))
    return steps


def waves_at_start(row: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and lines of what comes from outside."""
    pieces, outside, last = [], [], len(row.segments) - 1
    for i, body in enumerate(row.system.bodies):
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            stretch = body.strain * row.segments[s].wave_speed
            pieces.extend(
                layout.initial_waves(
                    body.velocity - clock.frame, stretch, clock.transits[s]
                )
            )
    for side, (kind, value) in enumerate(row.boundaries):
        k, came, factor = side * (last + 1), 0.0, 1.0
        if kind == "none" and row.first[k] == row.first[k + 1]:
            outside.append(NONE)
            continue
        if kind == "velocity":
            came = -clock.frame
        elif kind == "absorbing":
            came = pieces[2 * last + 1 if side == 1 else 0].coefficients[0]
            factor = wave_of_strain(row, side)
        outside.append(len(pieces))
        pieces.append(layout.constant_wave(came + value * factor))
    return pieces, outside


def run_of(
    row: Any,
    asked: Any,
    tolerance: float,
    keep: bool,
    earlier: Any,
    deadline: float = math.inf,
) -> Any:
    """Run a row; like an `earlier` run at a finer tolerance, where there is one.

    A run that is not over when the clock `monotonic` reaches its deadline, s, is a problem: steps
    alone do not bound its time, since each proof of finality reads all waves that are under way.

    Returns
    -------
    dict
        The `row`, its ``clock``, ``ended``, the records of `Ended`, ``masses`` and ``log``, the
        tick ``now`` to which all is known; or a ``problem``, path and sentence.
    """
    until = asked.until if asked.until >= 0 else None
    clock = clock_of(row, until)
    if clock is None:
        return {"problem": ("bodies", TOO_FAR_APART)}
    if least_steps(clock, until) > MAX_STEPS:
        return {"problem": ("", TOO_MUCH_WORK)}
    log, outside = waves_at_start(row, clock)
    for l in range(len(log)):
        log[l].line = l
    wanted = RunRequest(until, tolerance, asked.max_events, keep)
    initial_lines = [InitialLine(1, 0, 1) for _ in log]
    runs, nodes, links, masses, lines, parts = layout.lay_out(
        row, clock, wanted, initial_lines, outside
    )
    run = runs[0]
    turns = blank(ROOM + march.MAX_STATUS_CHANGES, CONTACT_EVENT)
    log.extend(blank(ROOM, PIECE))
    if earlier is not None:
        accuracy.compare(earlier["ended"].run, run)
    unknowns = N * max([node.link_count for node in nodes])
    matrix = [[0.0] * (unknowns + 1) for _ in range(unknowns)]
    state = State(runs, nodes, links, masses, lines, parts, log, turns, matrix)
    while march.run_nodes(state) == Stop.FULL:
        if monotonic() > deadline:
            return {"problem": ("", TOO_MUCH_WORK)}
        log.extend(blank(LOG_GROWTH, PIECE))
        turns.extend(blank(LOG_GROWTH, CONTACT_EVENT))
    if run.stop_reason == Stop.STUCK:
        stuck = nodes[march.earliest_node(nodes)]
        return {"problem": why_stuck(row, stuck, clock.tick * stuck.now)}
    return {
        "row": row,
        "clock": clock,
        "ended": Ended(run, links, parts),
        "masses": masses,
        "log": log[: run.piece_count],
        "lines": len(lines),
        "until": asked.until,
        "now": min([run.end_tick, *[node.now for node in nodes]]),
    }


def solved(row: Any, asked: Any, tolerance: float, deadline: float) -> Any:
    """A run, as of `run_of`, with the stated ``errors`` of the `MEASURES`, and their ``goal``."""
    fine = run_of(row, asked, tolerance, True, None, deadline)
    if "problem" in fine:
        return fine
    coarser = accuracy.COARSER * tolerance
    coarse = run_of(row, asked, coarser, False, fine, deadline)
    if "problem" in coarse:
        return coarse
    rounding = max([1 / T for T in fine["clock"].transits])  # to whole ticks
    stated = accuracy.stated(fine["ended"], coarse["ended"])
    left = accuracy.left_open(fine["ended"], 0.0)
    errors = [stated[i] + max(left[i], rounding) for i in range(len(stated))]
    return {**fine, "errors": errors, "goal": tolerance}


def outcome_of(run: Any, errors: list[float], status: str) -> Any:
    """What the collision did, as of `outcome_shown`."""
    row = run["row"]
    clock = run["clock"]
    ended = run["ended"]
    record = ended.run
    contacts = [
        tally_of(ended.link[i], clock.tick, run["now"]) for i in row.contact_link
    ]
    total_mass = sum([body.mass for body in row.system.bodies])
    energy_error = (
        errors[0] * record.velocity_scale * record.velocity_scale * total_mass
    )
    ending = Ending(
        contacts,
        record.proved_tick >= 0,
        status,
        {**errors_of(errors, record.velocity_scale, contacts), "energy": energy_error},
    )
    return outcome_shown(
        row.system,
        initial_motion(row, clock, ended),
        final_motion(row, clock, ended),
        ending,
    )


def initial_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies at t = 0; each has one velocity and one strain."""
    groups = [part for part in ended.part if part.part_count > 0]
    velocities = [part.initial_velocity + clock.frame for part in groups]
    kinetic = 0.0
    strain_energies = []
    for body in row.system.bodies:
        kinetic += body.mass * body.velocity**2 / 2
        strain_energy = 0.0
        for piece in body.segments:
            strain_energy += piece.mass * (piece.wave_speed * body.strain) ** 2 / 2
        strain_energies.append(strain_energy)
    return Motion(body_velocities(row.system, velocities), strain_energies, kinetic)


def final_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies when it was measured last; vibration is that of the parts."""
    groups = [part for part in ended.part if part.part_count > 0]
    velocities = [part.group_velocity + clock.frame for part in groups]
    vibration = [part.vibration_energy for part in ended.part]
    return Motion(body_velocities(row.system, velocities), vibration, math.nan)


def sentence_of(run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    row, ended, tick, it = (
        run["row"],
        run["ended"],
        run["clock"].tick,
        run["ended"].run,
    )
    strains = [
        sum(abs(c) for c in piece.coefficients)
        / row.segments[piece.line // 2].wave_speed
        for piece in run["log"]
        if piece.line < 2 * len(row.segments)
    ]
    end, round_trip = (
        run["now"] * tick,
        2 * layout.longest_of(row, run["clock"], 0) * tick,
    )
    sentence = status_of(
        it,
        ended.link,
        row.system,
        why_stopped(it, run["until"] >= 0),
        end,
        last_of(it, ended.link, end, round_trip),
    )
    return (
        sentence
        + stated(size_of(run["errors"][:3]), run["goal"])
        + simplifications_text(it)
        + (strain_warning(max(strains)))
    )


def solved_by_pieces(
    system: Any, asked: Any, tolerance: float, seconds: float = math.inf
) -> Any:
    """A collision as `solved.shown_of` takes it; or a ``problem``, path and sentence.

    It is a problem as well if the runs take longer than so many seconds.
    """
    row = build_row(system)
    run = solved(row, asked, tolerance, monotonic() + seconds)
    if "problem" in run:
        return run
    outcome = outcome_of(run, run["errors"], sentence_of(run))
    link, clock = run["ended"].link, run["clock"]
    if run["now"] == 0:
        return {"problem": ("solve", f"lasts no time to show. {outcome['status']}")}
    waves = reading.waves_of(run["log"], run["lines"])
    motion = {
        "row": row,
        "tick": clock.tick,
        "frame": clock.frame,
        "transits": clock.transits,
        "now": run["now"],
        "waves": waves,
        "masses": [waves[mass.history_line] for mass in run["masses"]],
        "springs": [
            (link[i], waves[link[i].history_line + 1])
            for i in row.contact_link
            if link[i].law >= Law.SPRING
        ],
        "exact": False,
        "draft": tolerance > RTOL,
    }
    contacts = []
    for i, law in enumerate(system.contacts):
        it = link[row.contact_link[i]]
        contacts.append(
            {
                "force": curve_of(motion, [(waves[it.history_line], 0, 1.0)]),
                "gap": curve_of(motion, [(waves[it.history_line + 1], 0, -1.0)])
                if law.opens
                else None,
            }
        )
    return {
        "motion": motion,
        "outcome": outcome,
        "method": "characteristics",
        "closed_form": None,
        "notes": [outcome["status"], "The picture shows means over cells."],
        "contacts": contacts,
        "tiling": grids_of(motion),
    }
