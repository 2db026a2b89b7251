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
"""Largest number of steps of a run: more take longer than a page may stand still."""
TOO_MUCH_WORK = (
    "This collision takes too long for the page. Usually one rod is very much shorter "
    "than another, or a contact is very stiff. Make the shortest rod longer or that "
    "contact softer; or solve the collision with Python: rodimpact run CASE.toml"
)


# Runs ---------------------------------------------------------------------------------


def clock_of(row: Any, until: Any, share: float) -> Any:
    """The clock of a row with rods, or None if there is no clock that fits.

    None is returned if a transit time has too few ticks, because the transit times are
    too far apart or the end of the run is too late.

    Parameters
    ----------
    row : Row
    until : float or None
        Given end of the run, s.
    share : float
        Used if no end is given: the clock must count to this share of the longest
        horizon. A smaller share makes finer ticks.
    """
    transit_times = [segment.transit_time for segment in row.segments]
    reference = largest(transit_times)
    scale = scale_of(row)  # of velocities, m/s
    if not scale > 0:  # nothing moves
        scale = 1.0
    end = until
    if until is None:
        crossing_time = crossing_time_of(row)
        flight_time = flight_time_of(row, scale)
        end = default_horizon(reference, crossing_time, flight_time, share)
    # Ticks of the longest transit time, and of that of each segment
    total, transits = count_ticks(transit_times, reference, end)
    # If no clock counts to the end, the total is 0.
    if total == 0 or min(transits) <= MIN_TRANSIT:
        return None
    tick = reference / total
    last_tick = round(end / tick)
    return Clock(row, tick, transits, frame_of(row), scale, reference, last_tick)


def least_steps(clock: Clock, until: Any) -> float:
    """Lower bound of the number of steps of a run.

    A step of the node between two segments takes at most twice the shorter of their
    transit times. A run without a given end takes at least a round trip in the longest
    segment, for which it goes on after its proof of finality.
    """
    transits = clock.transits
    duration = 2 * max(transits)  # least duration of the run, ticks
    if until is not None:
        duration = clock.last_tick
    steps = 0.0
    for k in range(1, len(transits)):  # node between the segments k - 1 and k
        steps += duration / (2 * min(transits[k - 1], transits[k]))
    return steps


def initial_lines(row: Any, clock: Clock) -> Any:
    """Pieces of all lines that are known at t = 0, and the lines from outside.

    Returns
    -------
    pieces : list of PIECE
        One for each line: two for each segment, then those from outside.
    outside : list of int
        Line of the action on the left and on the right end of the row: a velocity, a
        force or an incoming wave, which stays constant. NONE at the free end of a rod.
    """
    # Line 2 s is the wave of segment s to the right, line 2 s + 1 the one to the left.
    pieces: list[Any] = []
    for i, body in enumerate(row.system.bodies):
        velocity = body.velocity - clock.frame
        # Spans count the segments from 1; a wall or a mass has the empty span (1, 0).
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            c_strain = body.strain * row.segments[s].wave_speed  # m/s
            pieces.extend(layout.initial_waves(velocity, c_strain, clock.transits[s]))
    n_segments = len(row.segments)
    outside = []
    for side, (kind, value) in enumerate(row.boundaries):  # 0 left, 1 right
        k = side * n_segments  # node at this end of the row
        # Numbers of masses to the left of this node and of the next one
        has_mass = row.first_mass[k] != row.first_mass[k + 1]
        # A mass at a free end has the force 0 acting on it, which needs a line.
        if kind == "none" and not has_mass:
            outside.append(NONE)
            continue
        action = value  # a force, N
        if kind == "velocity":
            action = -clock.frame + value  # in the frame of the clock
        elif kind == "absorbing":
            # The value is the strain of the incoming wave. This wave is added to the
            # initial one that runs into the row from this end.
            inward_line = 0
            if side == 1:
                inward_line = 2 * n_segments - 1
            initial_wave = pieces[inward_line].coefficients[0]
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
    """Run a row to its end, on the finest clock that can count to this end.

    Without a given end, clocks with growing horizons are tried until one suffices.

    Parameters
    ----------
    row : Row
    request : RunRequest
    tolerance : float
        Tolerance of pieces, relative to the velocity scale.
    keep : bool
        Whether all waves are kept.
    earlier : dict or None
        A run at a finer tolerance, with which this run is to be compared.
    deadline : float
        Time of the clock `monotonic`, s, at which the run is given up. The number of
        steps alone does not bound its time, since each proof of finality reads all
        waves that are under way.

    Returns
    -------
    dict
        The ``row``, its ``clock``, the records ``ended`` (an `Ended`), ``masses`` and
        ``log``, the number of ``lines``, ``until`` of the request, and the tick ``now``
        up to which all waves are known; or a ``problem``, path and sentence.
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
    """The given end of a run, s; None if the end of the request is negative."""
    if request.until >= 0:
        return request.until
    return None


def horizon_shares(until: Any) -> list[float]:
    """Shares of the longest horizon for which clocks are tried in turn; the last is 1.

    The only share is 1 if there is a given end. Otherwise each share is four times the
    share before it, from `FIRST_HORIZON_SHARE` on.
    """
    if until is not None:
        return [1.0]
    shares = [FIRST_HORIZON_SHARE]
    while shares[-1] < 1:
        shares.append(min(4 * shares[-1], 1.0))
    return shares


def outlasts_clock(run: Any) -> bool:
    """Whether a run without a given end came to the end of its clock without a proof.

    False for a run with a problem. Without a given end, the end of the clock is the end
    that the kernel is asked for: the run then stops with DONE.
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
    """Run the row of a clock once; further arguments and the result as in `run_of`.

    Without a given end, a run without proof stops at the end of the clock. The logs
    grow when they are full. A ``problem`` is returned after the deadline, or if the
    kernel cannot go on.
    """
    row = clock.row
    log, outside = initial_lines(row, clock)
    for line in range(len(log)):  # the log has one piece of each line in order
        log[line].line = line
    options = RunRequest(until_of(request), tolerance, request.max_events, keep)
    constant_line = InitialLine(1, 0, 1)  # one piece, no breaks, of one tick
    initial = [constant_line for _ in log]
    runs, nodes, links, masses, lines, parts = layout.lay_out(
        row, clock, options, initial, outside
    )
    run = runs[0]
    contact_events = blank(INITIAL_LOG_ROWS + march.MAX_STATUS_CHANGES, CONTACT_EVENT)
    log.extend(blank(INITIAL_LOG_ROWS, PIECE))
    if earlier is not None:
        # This run is to end as the earlier one did.
        accuracy.prepare_second_run(earlier["ended"].run, run)
    matrix = empty_matrix(nodes)
    state = State(runs, nodes, links, masses, lines, parts, log, contact_events, matrix)
    # A run stops with FULL when a log is full; with longer logs it goes on.
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
    """Matrix of zeros for the equations of the node with the most links.

    It has a row for each of the N Gauss stages of each link, and one column more than
    rows for the right side of the equations.
    """
    size = N * max([node.link_count for node in nodes])
    matrix = []
    for _ in range(size):
        matrix.append([0.0] * (size + 1))
    return matrix


def run_with_errors(row: Any, request: Any, tolerance: float, deadline: float) -> Any:
    """A run of `run_of` with its stated ``errors``, and its ``goal``, the tolerance.

    The errors are relative, one for each of the `MEASURES` of `accuracy`. Each is the
    sum of an estimate from the difference to a coarser second run, of errors that both
    runs share, and of the error by rounded transit times. If either run has a problem,
    a dictionary with this ``problem`` is returned instead.
    """
    keep_waves = True
    no_earlier_run = None
    fine = run_of(row, request, tolerance, keep_waves, no_earlier_run, deadline)
    if "problem" in fine:
        return fine
    coarser = accuracy.COARSER * tolerance
    keep_waves = False
    coarse = run_of(row, request, coarser, keep_waves, fine, deadline)
    if "problem" in coarse:
        return coarse
    transit_error, _ = most_rounded(row, fine["clock"].transits, fine["clock"].tick)
    rounding = accuracy.rounding_errors(fine["ended"], transit_error)
    misfit = 0.0  # of given functions, of which the page has only constants
    hidden = accuracy.hidden_errors(fine["ended"], misfit)
    errors = []
    by_difference = accuracy.errors_of_two_runs(fine["ended"], coarse["ended"])
    for i, error in enumerate(by_difference):
        errors.append(error + hidden[i] + rounding[i])
    fine["errors"] = errors
    fine["goal"] = tolerance
    return fine


# Outcome ------------------------------------------------------------------------------


def outcome_of(run: Any, errors: list[float], status: str) -> Any:
    """The outcome of a collision, a dictionary of `facts_of_outcome`.

    `errors` are the relative errors of `run_with_errors`, and `status` says why the run
    ended.
    """
    row = run["row"]
    clock = run["clock"]
    ended = run["ended"]
    record = ended.run
    contacts = [
        tally_of(ended.links[i], clock.tick, run["now"]) for i in row.contact_link
    ]
    total_mass = sum([body.mass for body in row.system.bodies])
    stated_errors = errors_of(errors, record.velocity_scale, contacts)
    # errors[0] is that of velocities.
    stated_errors["energy"] = (
        errors[0] * record.velocity_scale * record.velocity_scale * total_mass
    )
    is_final = record.proved_tick >= 0
    summary = RunSummary(contacts, is_final, status, stated_errors)
    before = initial_motion(row, clock, ended)
    after = final_motion(row, clock, ended)
    return facts_of_outcome(row.system, before, after, summary)


def initial_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies at t = 0: velocities, strain energies, and kinetic energy.

    On the page each body has one velocity and one strain.
    """
    velocities = []  # one for each group of bonded bodies
    for part in ended.parts:
        if part.part_count > 0:  # the first part of a group, which has its motion
            # Records have velocities in the moving frame of the clock.
            velocities.append(part.initial_velocity + clock.frame)
    kinetic = 0.0
    strain_energies = []
    for body in row.system.bodies:
        kinetic += body.mass * body.velocity**2 / 2
        strain_energy = 0.0
        for segment in body.segments:
            c_strain = segment.wave_speed * body.strain  # m/s
            strain_energy += segment.mass * c_strain**2 / 2
        strain_energies.append(strain_energy)
    return Motion(body_velocities(row.system, velocities), strain_energies, kinetic)


def final_motion(row: Any, clock: Clock, ended: Ended) -> Motion:
    """Motion of the bodies at the last measurement of their groups.

    The vibration energies are those of the parts of groups. The kinetic energy is not
    measured: it is NaN.
    """
    velocities = []  # one for each group of bonded bodies
    vibration = []
    for part in ended.parts:
        vibration.append(part.vibration_energy)
        if part.part_count > 0:  # the first part of a group, which has its motion
            # Records have velocities in the moving frame of the clock.
            velocities.append(part.group_velocity + clock.frame)
    return Motion(body_velocities(row.system, velocities), vibration, math.nan)


def status_of(run: Any) -> str:
    """Sentences on a run of `run_with_errors`: `Solution.status` without advice.

    They say why it ended, its largest stated error, then, if there are any,
    simplifications, and a warning of strains that are not small.
    """
    row = run["row"]
    record = run["ended"].run
    links = run["ended"].links
    tick = run["clock"].tick
    end = run["now"] * tick
    without_rods = 0  # time for a row without rods, which the page does not solve
    longest_time = layout.longest_body_time(row, run["clock"], without_rods)  # ticks
    round_trip = 2 * longest_time * tick
    last = last_of(record, links, end, round_trip)
    has_given_end = run["until"] >= 0
    stopped_by = why_stopped(record, has_given_end)
    why = end_of_run(record, links, row.system, stopped_by, end, last)
    # The first three measures are velocities, impulses and peak forces.
    error_sentence = accuracy_sentence(max_abs(run["errors"][:3]), run["goal"])
    warning = strain_warning(largest_strain(row, run["log"]))
    return why.statement + error_sentence + simplifications_text(record) + warning


def largest_strain(row: Any, log: list[Any]) -> float:
    """Upper bound of the absolute strain in all segments.

    With the waves a and b the strain is (b - a)/(2 c): at most v/c if abs(a) and abs(b)
    are at most v. A piece of a wave is a series in functions between -1 and 1, so that
    v = sum(abs(coefficients)) is a bound.
    """
    strains = []
    for piece in log:
        # Further lines come from outside, or are histories of links and masses.
        is_wave = piece.line < 2 * len(row.segments)
        if is_wave:
            v = sum(abs(c) for c in piece.coefficients)
            segment = row.segments[piece.line // 2]  # two lines a segment
            strains.append(v / segment.wave_speed)
    strain: float = max(strains)
    return strain


# Solution -----------------------------------------------------------------------------


def solve_by_pieces(
    system: Any, request: Any, tolerance: float, seconds: float = math.inf
) -> Any:
    """Solve a collision by characteristics, for the page, with stated errors.

    Parameters
    ----------
    system : System
    request : RunRequest
    tolerance : float
        Tolerance of the pieces of waves. Above `RTOL` the solution is a draft with
        fewer points.
    seconds : float
        Time after which the runs are given up.

    Returns
    -------
    dict
        The solution, in the form that `solved.scene_of_solution` takes; or a
        ``problem``, path and sentence, if there is no solution, the runs take too long,
        or they last no time.
    """
    row = build_row(system)
    run = run_with_errors(row, request, tolerance, monotonic() + seconds)
    if "problem" in run:
        return run
    outcome = outcome_of(run, run["errors"], status_of(run))
    if run["now"] == 0:  # the last tick of the run
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
    """Motion of a run, in the form of the module `motion`, which calls it a run.

    Its waves are smooth between breaks. The line `history_line` of a link has its
    force, the next line its overlap.
    """
    row = run["row"]
    clock = run["clock"]
    links = run["ended"].links
    waves = reading.waves_of(run["log"], run["lines"])
    springs = []
    for i in row.contact_link:
        link = links[i]
        if link.law >= Law.SPRING:  # this law and those after it have an overlap
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
    """Curves of the ``force``, N, and of the ``gap``, m, of each contact.

    The gap of a bond is None. The lines of a link are those that `motion_of_pieces`
    describes.
    """
    row = run["row"]
    waves = motion["waves"]
    no_delay = 0
    curves = []
    for i, contact in enumerate(row.system.contacts):
        link = run["ended"].links[row.contact_link[i]]
        gap = None
        if contact.opens:
            overlap = waves[link.history_line + 1]
            gap = curve_of(motion, [(overlap, no_delay, -1.0)])  # the gap is -overlap
        force = curve_of(motion, [(waves[link.history_line], no_delay, 1.0)])
        curves.append({"force": force, "gap": gap})
    return curves
