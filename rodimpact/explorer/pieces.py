"""A collision that characteristics solve: runs of the kernels, and what the page shows.

Begin with `solve_by_pieces`. The page has this module as JavaScript.
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
    most_rounded,
)
from ..methods.groups import body_velocities
from ..methods.link import Law
from ..methods.outcome import Motion
from ..methods.pieces import accuracy, layout, march, reading
from ..methods.pieces.accuracy import Ended, max_abs
from ..methods.pieces.layout import InitialLine, RunRequest
from ..methods.pieces.method import RTOL
from ..methods.pieces.records import CONTACT_EVENT, NONE, PIECE, State
from ..methods.pieces.series import N
from ..methods.pieces.totals import (
    accuracy_sentence,
    end_of_run,
    last_of,
    simplifications_text,
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
from .facts import RunSummary, errors_of, facts_of_outcome
from .fronts import FIRST_HORIZON_SHARE, TOO_FAR_APART
from .motion import curve_of, grids_of

INITIAL_LOG_ROWS = 512
"""Rows of the logs of pieces and of contact events at t = 0."""
LOG_GROWTH = 256
"""Rows by which the logs grow. Whenever they grow, the deadline is checked."""
MAX_STEPS = 100_000
"""Steps of a run at most: more take longer than a page may stand still."""
TOO_MUCH_WORK = (
    "This collision takes too long for the page. Usually one rod is very much shorter "
    "than another, or a contact is very stiff. Make the shortest rod longer or that "
    "contact softer; or solve the collision with Python: rodimpact run CASE.toml"
)


# Runs ---------------------------------------------------------------------------------


def clock_of(row: Any, until: Any, share: float) -> Any:
    """The clock of a row with rods; None where times are too far apart for it.

    Without a given end, the clock can count this share of its longest horizon. A
    smaller share has finer ticks.
    """
    transit_times = [segment.transit_time for segment in row.segments]
    reference = largest(transit_times)
    scale = scale_of(row)
    if not scale > 0:  # nothing moves
        scale = 1.0
    end = until
    if until is None:
        crossing_time = crossing_time_of(row)
        flight_time = flight_time_of(row, scale)
        end = default_horizon(reference, crossing_time, flight_time, share)
    total, transits = count_ticks(transit_times, reference, end)
    if total == 0 or min(transits) <= MIN_TRANSIT:
        return None
    tick = reference / total
    last_tick = round(end / tick)
    return Clock(row, tick, transits, frame_of(row), scale, reference, last_tick)


def least_steps(clock: Clock, until: Any) -> float:
    """Lower bound of the steps of a run; to its proof of finality without a given end.

    A step of a node takes at most twice the shorter transit time beside it. A run
    without a given end goes on for a round trip of the longest rod after its proof.
    """
    transits = clock.transits
    duration = 2 * max(transits)
    if until is not None:
        duration = clock.last_tick
    steps = 0.0
    for k in range(1, len(transits)):
        steps += duration / (2 * min(transits[k - 1], transits[k]))
    return steps


def initial_lines(row: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and the lines from outside.

    Returns
    -------
    pieces : list of PIECE
    outside : list of int
        Line of what acts on the left and on the right end, or NONE: a velocity, a force
        or a wave that comes in, which stays constant.
    """
    # Line 2 s is the wave of segment s to the right, line 2 s + 1 the one to the left.
    pieces: list[Any] = []
    for i, body in enumerate(row.system.bodies):
        velocity = body.velocity - clock.frame
        # Spans count the segments from 1; a wall or a mass has the empty span (1, 0).
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            stretch = body.strain * row.segments[s].wave_speed
            pieces.extend(layout.initial_waves(velocity, stretch, clock.transits[s]))
    n_segments = len(row.segments)
    outside = []
    for side, (kind, value) in enumerate(row.boundaries):
        k = side * n_segments  # node at this end of the row
        has_mass = row.first_mass[k] != row.first_mass[k + 1]  # masses left of a node
        # On a mass at a free end acts the force 0, which has a line like any other.
        if kind == "none" and not has_mass:
            outside.append(NONE)
            continue
        action = value  # a force, N
        if kind == "velocity":
            action = -clock.frame + value
        elif kind == "absorbing":
            # The value is the strain of the wave that comes in; the wave is twice its
            # velocity.
            leaving = 0  # line of the wave that leaves the row at this end
            if side == 1:
                leaving = 2 * n_segments - 1
            initial_wave = pieces[leaving].coefficients[0]
            action = initial_wave + value * wave_of_strain(row, side)
        outside.append(len(pieces))
        pieces.append(layout.constant_wave(action))
    return pieces, outside


def run_of(
    row: Any,
    request: Any,
    tolerance: float,
    keep: bool,
    earlier: Any,
    deadline: float = math.inf,
) -> Any:
    """Run a row once, on the finest clock that counts to its end.

    Parameters
    ----------
    row : Row
    request : RunRequest
    tolerance : float
        Of pieces, relative to the velocity scale.
    keep : bool
        Whether all waves are kept.
    earlier : dict or None
        A run at a finer tolerance, which this one is to be like.
    deadline : float
        Time of the clock `monotonic`, s, at which a run is given up. Steps alone do not
        bound its time, since each proof of finality reads all waves that are under way.

    Returns
    -------
    dict
        The ``row``, its ``clock``, ``ended``, the records of `Ended`, ``masses`` and
        ``log``, the number of ``lines``, ``until`` of the request, and the tick ``now``
        to which all is known; or a ``problem``, path and sentence.
    """
    until = until_of(request)
    run: Any = None
    for share in horizon_shares(until):
        clock = clock_of(row, until, share)
        if clock is None:
            return {"problem": ("bodies", TOO_FAR_APART)}
        if least_steps(clock, until) > MAX_STEPS:
            return {"problem": ("", TOO_MUCH_WORK)}
        run = run_on_clock(clock, request, tolerance, keep, earlier, deadline)
        if not outlasts_clock(run):
            break
    return run


def until_of(request: Any) -> Any:
    """The given end of a run, s; None for a request whose end is negative: none."""
    if request.until >= 0:
        return request.until
    return None


def horizon_shares(until: Any) -> list[float]:
    """Shares of the longest horizon to be tried one after the other, up to 1.

    Only 1 with a given end; else each is four times the one before it.
    """
    if until is not None:
        return [1.0]
    shares = [FIRST_HORIZON_SHARE]
    while shares[-1] < 1:
        shares.append(min(4 * shares[-1], 1.0))
    return shares


def outlasts_clock(run: Any) -> bool:
    """Whether a run without a given end came to the end of its clock without a proof.

    A run that failed with a problem did not.
    """
    if "problem" in run or run["until"] >= 0:
        return False
    record = run["ended"].run
    return bool(record.stop_reason == Stop.DONE and record.proved_tick < 0)


def run_on_clock(
    clock: Clock,
    request: Any,
    tolerance: float,
    keep: bool,
    earlier: Any,
    deadline: float,
) -> Any:
    """Run the row of a clock once; arguments and result are those of `run_of`."""
    row = clock.row
    log, outside = initial_lines(row, clock)
    for l in range(len(log)):
        log[l].line = l
    options = RunRequest(until_of(request), tolerance, request.max_events, keep)
    one_piece_each = [InitialLine(1, 0, 1) for _ in log]
    runs, nodes, links, masses, lines, parts = layout.lay_out(
        row, clock, options, one_piece_each, outside
    )
    run = runs[0]
    contact_events = blank(INITIAL_LOG_ROWS + march.MAX_STATUS_CHANGES, CONTACT_EVENT)
    log.extend(blank(INITIAL_LOG_ROWS, PIECE))
    if earlier is not None:
        # This run is to end as the earlier one did.
        accuracy.prepare_second_run(earlier["ended"].run, run)
    matrix = empty_matrix(nodes)
    state = State(runs, nodes, links, masses, lines, parts, log, contact_events, matrix)
    while march.run_nodes(state) == Stop.FULL:
        if monotonic() > deadline:
            return {"problem": ("", TOO_MUCH_WORK)}
        log.extend(blank(LOG_GROWTH, PIECE))
        contact_events.extend(blank(LOG_GROWTH, CONTACT_EVENT))
    earliest = nodes[march.earliest_node(nodes)]
    if run.stop_reason == Stop.STUCK:
        return {"problem": why_stuck(row, earliest, clock.tick * earliest.now)}
    return {
        "row": row,
        "clock": clock,
        "ended": Ended(run, links, parts),
        "masses": masses,
        "log": log[: run.piece_count],
        "lines": len(lines),
        "until": request.until,
        "now": min(run.end_tick, earliest.now),
    }


def empty_matrix(nodes: list[Any]) -> list[list[float]]:
    """Matrix of zeros for the forces of the node with the most links.

    It has a row for each of the N Gauss stages of each link, and a column more for the
    right side of the equations.
    """
    size = N * max([node.link_count for node in nodes])
    matrix = []
    for _ in range(size):
        matrix.append([0.0] * (size + 1))
    return matrix


def run_with_errors(row: Any, request: Any, tolerance: float, deadline: float) -> Any:
    """A run of `run_of` with the stated ``errors`` of the `MEASURES` and its ``goal``.

    The errors are its difference to a coarser run in other pieces, what is left open at
    its end, and the rounding of the transit times. A problem of either run is returned
    in its place.
    """
    fine = run_of(row, request, tolerance, True, None, deadline)
    if "problem" in fine:
        return fine
    coarser = accuracy.COARSER * tolerance
    coarse = run_of(row, request, coarser, False, fine, deadline)
    if "problem" in coarse:
        return coarse
    transit_error, _ = most_rounded(row, fine["clock"].transits, fine["clock"].tick)
    rounding = accuracy.rounding_errors(fine["ended"], transit_error)
    hidden = accuracy.hidden_errors(fine["ended"], 0.0)
    errors = []
    two_runs = accuracy.errors_of_two_runs(fine["ended"], coarse["ended"])
    for i, error in enumerate(two_runs):
        errors.append(error + hidden[i] + rounding[i])
    fine["errors"] = errors
    fine["goal"] = tolerance
    return fine


# Outcome ------------------------------------------------------------------------------


def outcome_of(run: Any, errors: list[float], status: str) -> Any:
    """The outcome of a collision, in the form of `facts_of_outcome`."""
    row = run["row"]
    clock = run["clock"]
    ended = run["ended"]
    record = ended.run
    contacts = [
        tally_of(ended.links[i], clock.tick, run["now"]) for i in row.contact_link
    ]
    total_mass = sum([body.mass for body in row.system.bodies])
    stated_errors = errors_of(errors, record.velocity_scale, contacts)
    stated_errors["energy"] = (
        errors[0] * record.velocity_scale * record.velocity_scale * total_mass
    )
    summary = RunSummary(contacts, record.proved_tick >= 0, status, stated_errors)
    before = initial_motion(row, clock, ended)
    after = final_motion(row, clock, ended)
    return facts_of_outcome(row.system, before, after, summary)


def initial_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies at t = 0; each has one velocity and one strain.

    Velocities of parts are those in the moving frame of the clock.
    """
    velocities = []  # one for each group of bonded bodies
    for part in ended.parts:
        if part.part_count > 0:  # the first part of a group, which has its motion
            velocities.append(part.initial_velocity + clock.frame)
    kinetic = 0.0
    strain_energies = []
    for body in row.system.bodies:
        kinetic += body.mass * body.velocity**2 / 2
        strain_energy = 0.0
        for segment in body.segments:
            stretch = segment.wave_speed * body.strain
            strain_energy += segment.mass * stretch**2 / 2
        strain_energies.append(strain_energy)
    return Motion(body_velocities(row.system, velocities), strain_energies, kinetic)


def final_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies of a row at its last measurement.

    The vibration energies are those of the parts, whose velocities are those in the
    moving frame of the clock. The kinetic energy is not measured, so it is NaN.
    """
    velocities = []  # one for each group of bonded bodies
    vibration = []
    for part in ended.parts:
        vibration.append(part.vibration_energy)
        if part.part_count > 0:  # the first part of a group, which has its motion
            velocities.append(part.group_velocity + clock.frame)
    return Motion(body_velocities(row.system, velocities), vibration, math.nan)


def status_of(run: Any) -> str:
    """Why the run ended, and what to mind: `Solution.status` without advice on Python.

    Sentences follow on the largest stated error, on simplifications and on strains that
    are not small; the last two are empty if there are none.
    """
    row = run["row"]
    record = run["ended"].run
    links = run["ended"].links
    tick = run["clock"].tick
    end = run["now"] * tick
    # The last argument is for rows without rods, which the page does not solve.
    round_trip = 2 * layout.longest_body_time(row, run["clock"], 0) * tick
    last = last_of(record, links, end, round_trip)
    stopped_by = why_stopped(record, run["until"] >= 0)
    why = end_of_run(record, links, row.system, stopped_by, end, last)
    error_sentence = accuracy_sentence(max_abs(run["errors"][:3]), run["goal"])
    warning = strain_warning(largest_strain(row, run["log"]))
    return why.statement + error_sentence + simplifications_text(record) + warning


def largest_strain(row: Any, log: list[Any]) -> float:
    """Bound of the absolute strain in all segments, without dimension: the largest v/c.

    By the waves a and b of a segment, each twice its velocity, the strain is
    (b - a)/(2 c). With abs(a) and abs(b) up to v, it is at most v/c. A piece of a wave
    is a series in functions between -1 and 1, so that v is at most
    sum(abs(coefficients)).
    """
    strains = []
    for piece in log:
        # Lines beyond those of the segments come from outside, or are histories.
        if piece.line < 2 * len(row.segments):
            # The bound of abs(a) or abs(b)
            bound = sum(abs(c) for c in piece.coefficients)
            strains.append(bound / row.segments[piece.line // 2].wave_speed)
    strain: float = max(strains)
    return strain


# Solution -----------------------------------------------------------------------------


def solve_by_pieces(
    system: Any, request: Any, tolerance: float, seconds: float = math.inf
) -> Any:
    """Solve a collision by characteristics, for the page, with stated errors.

    Returns
    -------
    dict
        The solution, in the form that `solved.scene_of_solution` takes; or a
        ``problem``, path and sentence: also if the runs take longer than so many
        seconds.
    """
    row = build_row(system)
    run = run_with_errors(row, request, tolerance, monotonic() + seconds)
    if "problem" in run:
        return run
    outcome = outcome_of(run, run["errors"], status_of(run))
    if run["now"] == 0:
        return {"problem": ("solve", f"lasts no time to show. {outcome['status']}")}
    motion = motion_of_pieces(run)
    motion["draft"] = tolerance > RTOL
    return {
        "motion": motion,
        "outcome": outcome,
        "method": "characteristics",
        "closed_form": None,
        "notes": [outcome["status"], "The picture shows means over cells."],
        "contacts": contact_curves(run, motion),
        "tiling": grids_of(motion),
    }


def motion_of_pieces(run: Any) -> Any:
    """Motion of a run, a dictionary (see the module `motion`), of smooth waves.

    The line `history_line` of a link has its force, the next line its overlap.
    """
    row = run["row"]
    clock = run["clock"]
    links = run["ended"].links
    waves = reading.waves_of(run["log"], run["lines"])
    springs = []
    for i in row.contact_link:
        link = links[i]
        if link.law >= Law.SPRING:  # the link has an overlap
            overlap = waves[link.history_line + 1]
            springs.append((link, overlap))
    return {
        "row": row,
        "tick": clock.tick,
        "frame": clock.frame,
        "transits": clock.transits,
        "now": run["now"],
        "waves": waves,
        "masses": [waves[mass.history_line] for mass in run["masses"]],
        "springs": springs,
        "exact": False,
        "draft": False,
    }


def contact_curves(run: Any, motion: Any) -> list[Any]:
    """Curves of the force, N, and of the gap, m, of each contact; no gap for a bond.

    The lines of a link are those that `motion_of_pieces` describes.
    """
    row = run["row"]
    waves = motion["waves"]
    curves = []
    for i, contact in enumerate(row.system.contacts):
        link = run["ended"].links[row.contact_link[i]]
        gap = None
        if contact.opens:
            overlap = waves[link.history_line + 1]
            gap = curve_of(motion, [(overlap, 0, -1.0)])
        force = curve_of(motion, [(waves[link.history_line], 0, 1.0)])
        curves.append({"force": force, "gap": gap})
    return curves
