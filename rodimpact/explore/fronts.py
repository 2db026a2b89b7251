"""A collision of fronts, from its row of tables to what happened, as the page solves it.

The kernels are those of the method "fronts"; around them stands plain Python, which the page has as
JavaScript: runs, polygons of constant state, forces, gaps, gauges and energies, and what the
collision comes to. Tests hold all of it against `Solution`.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any

from ..methods.fronts.assembly import sizes_of, work_space
from ..methods.fronts.front_kernel import (
    CAP,
    CLOCK,
    EVENTS,
    FINAL,
    FINALITY,
    FULL,
    IDLE,
    NOW,
    OPEN,
    REST,
    ROWS,
    GroupState,
    advance,
    final_state,
    initial_state,
    load,
    play,
    segment_totals,
)
from ..methods.fronts.layout_kernel import LAID, Layout, Work, lay_out, round_trip
from ..methods.fronts.method import cut_short, pressing, rounding
from ..methods.status import ending, proof_sentence, strain_warning
from ..results.cutting import region, spans
from ..results.outcome import ROUND_OFF, no_restitution
from ..theory import pair_numbers, pair_restitution
from ..units import format_si
from .tables import row_of

ROOM = 256  # rows of the log at first
FINE = 1.0  # share of the usual room of the clock that is tried first, where it has few bits
MOST_REGIONS = 3000  # that are drawn
MOST_TIMES = 400  # of a curve of energy
PARTS = 6  # lines that a parabola is drawn with, at least
RATIOS = 80  # of the lengths, on the curve of e
POINTS = 240  # of a curve of energy, about


def known_of(row: Any, gauges: Any) -> Any:
    """What `picture` shows of a row of fronts.

    Parameters
    ----------
    row : dict
        As `row_of` makes it.
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.

    Returns
    -------
    dict
        Or one with a ``problem``, path and sentence, where there is nothing to show.
    """
    run = run_of(row, True, space_of(row))
    if run["why"] < 0:
        message = "times too far apart for the clock of this page; rodimpact run may solve it"
        return {"problem": ("bodies", message)}
    layout, clock, outcome = run["layout"], run["clock"], outcome_of(row, run)
    waves, tick = waves_of(row, run), layout.tick_seconds[0]
    stop = end_of_picture(row, run, waves)
    if stop == 0:
        message = "lasts no time to show" if clock[NOW] == 0 else "has too many fronts to show"
        return {"problem": ("solve", f"{message}. {outcome['status']}")}
    notes = [outcome["status"]]
    if stop < clock[NOW]:
        end = format_si(stop * tick, "s", 4)
        notes.append(f"The picture ends at {end}: too many regions later.")
    polygons, positions, place, strain = tiling_of(row, run, waves, stop), [], 0.0, 0.0
    for e in polygons["strain"]:
        strain = max(strain, abs(e))
    for i, body in enumerate(row["bodies"]):
        place += row["gaps"][i - 1] if i > 0 else 0.0
        positions.append(place)
        for s in range(body["first"], body["last"] + 1):
            stretched = stretch_of(waves, s, layout.transit[s]) * tick
            place += row["segments"][s - 1]["length"] + stretched
    slowest, held = outcome["before"][0], False
    for i, body in enumerate(row["bodies"]):
        rests = (i == 0 and row["ends"][0] in ("fixed", "velocity")) or (
            i == len(row["bodies"]) - 1 and row["ends"][1] in ("fixed", "velocity"))
        v = 0.0 if rests else outcome["before"][i]
        fixed = rests or body["kind"] == "wall"
        if (fixed and not held) or (fixed == held and abs(v) < abs(slowest)):
            slowest, held = v, fixed
    curves, energy = contact_curves(row, run, stop), energy_curves(row, polygons)
    names = [f"contact {i}-{i + 1}" for i in range(len(curves))]
    opening = outcome["able"]
    return {
        "method": "fronts", "exact": True, "notes": notes, "curve": None,
        "closed_form": closed_form_of(row, outcome["before"]),
        "bodies": [body_of(row, body, stop * tick) for body in row["bodies"]],
        "positions": positions, "polygons": polygons, "strain": strain, "slowest": slowest,
        "contacts": [{"index": i, "bonded": bonded, "compliant": False}
                     for i, bonded in enumerate(row["bonded"])],
        "gauges": gauges, "outcome": outcome,
        "plots": [
            plot_of("force", "Contact force", "N", [
                series_of(names[i], curve["t"], curve["force"], True)
                for i, curve in enumerate(curves)]),
            plot_of("gap", "Gap", "m", [
                series_of(names[i], curves[i]["t"], curves[i]["gap"], False) for i in opening]),
            plot_of("energy", "Energy", "J", [
                series_of("moving as a whole", energy["t"], energy["whole"], False),
                series_of("vibration", energy["t"], energy["vibration"], False),
                series_of("strain", energy["t"], energy["strain"], False),
                series_of("total", energy["t"], energy["total"], False)]),
            plot_of("gauge", "Strain gauges", "µε", [
                gauge_series(row, run, waves, gauge, stop) for gauge in gauges]),
        ],
    }


def body_of(row: Any, body: Any, end: float) -> Any:
    """What `picture` shows of a body."""
    velocity, path = body["velocity"], None
    speed = None if isinstance(velocity, dict) else velocity
    if body["kind"] == "wall":
        path = {"t": [0.0, end], "displacement": [0.0, velocity * end]}
    return {
        "kind": body["kind"], "velocity": speed, "path": path, "mass": body["mass"],
        "approach": speed if body["strain"] == 0.0 else None,
        "pieces": [
            {**row["segments"][s - 1], "areas": [row["segments"][s - 1]["area"]]}
            for s in range(body["first"], body["last"] + 1)
        ],
    }


def plot_of(key: str, title: str, unit: str, series: list[Any]) -> Any:
    """A figure of curves over time."""
    return {"key": key, "title": title, "unit": unit, "series": series}


def series_of(name: str, t: list[float], y: list[float], steps: bool) -> Any:
    """A curve over time; with `steps` each value holds until the next time."""
    return {"name": name, "t": [*t], "y": y, "steps": steps}


def gauge_series(row: Any, run: Any, waves: list[Any], gauge: Any, stop: int) -> Any:
    """The curve of a gauge, in 1e-6."""
    length, body = 0.0, row["bodies"][gauge["body"]]
    for s in range(body["first"], body["last"] + 1):
        length += row["segments"][s - 1]["length"]
    x = gauge["fraction"] * length
    curve = gauge_curve(row, run, waves, gauge["body"], x, stop)
    strain = [1e6 * e for e in curve["strain"]]
    name = f"rod {gauge['body']} at {format_si(x, 'm', 4)}"
    return series_of(name, curve["t"], strain, True)


def run_of(row: Any, further: bool, space: Any) -> Any:
    """Run a row to its end; `further` goes on for a round trip after the proof of finality.

    Returns
    -------
    dict
        ``layout`` and ``status`` of its nodes at t = 0; ``state``, ``tally``, ``log`` and ``clock``
        of the kernel; ``opening`` and ``closing`` stocks; ``why`` it stopped: the kernel's flag,
        -1 where its times do not fit on a clock. All but ``status`` and ``why`` is the `space`.
    """
    if row["until"] >= 0:
        return run_on(row, further, row["until"], space)
    share = FINE
    run = run_on(row, further, -share, space)
    while run["why"] == CLOCK and share < 1:
        share = min(4 * share, 1.0)
        run = run_on(row, further, -share, space)
    return run


def run_on(row: Any, further: bool, until: float, space: Any) -> Any:
    """Run a row; `until` as of `lay_out`, all else as of `run_of`."""
    layout, make = space["layout"], row["make"]
    if lay_out(make, row["given"], 0, until, layout, space["work"]) != LAID:
        return {**space, "why": -1}
    status = [OPEN if gap > 0 else at for gap, at in zip(layout.gap, row["status"], strict=True)]
    opening, target = space["opening"], layout.target[0]
    if further and target < 0:
        target = -round_trip(make, 0, layout)
    while True:
        state, tally, log, clock = space["state"], space["tally"], space["log"], space["clock"]
        if layout.count[0] + 2 <= len(log.tick):
            load(state, tally, log, clock, layout, 0, status)
            initial_state(state, log, opening)
            segment_totals(state, log, 0, opening)
            tol, window = layout.tolerance[0], layout.window[0]
            flag = play(state, tally, log, clock, target, row["max_events"], tol, window)
            if flag != FULL:
                break
        space.update(work_of(len(row["segments"]), 4 * len(log.tick)))
    final_state(state, tally, log, clock[NOW], opening, space["closing"])
    return {**space, "why": flag, "status": status}


def space_of(row: Any) -> Any:
    """Space for runs of rows of one make."""
    n = len(row["segments"])
    layout, work = sizes_of(row["make"])
    return {
        "layout": Layout(*[[0] * size for size in layout]),
        "work": Work(*[[0] * size for size in work]),
        "opening": stock_of(n), "closing": stock_of(n), **work_of(n, ROOM),
    }


def work_of(n: int, room: int) -> Any:
    """Space for the kernel."""
    state, tally, log, clock = work_space(n, room)
    return {"state": state, "tally": tally, "log": log, "clock": clock}


def stock_of(n: int) -> Any:
    """Space for what n segments hold."""
    return GroupState([0.0] * (n + 2), [0.0] * (n + 2), [0.0] * (n + 2))


# What it comes to ---------------------------------------------------------------------------------


def groups_of(row: Any) -> list[list[int]]:
    """Bodies that are bonded together, from left to right."""
    groups = [[0]]
    for i, bonded in enumerate(row["bonded"]):
        if bonded:
            groups[-1].append(i + 1)
        else:
            groups.append([i + 1])
    return groups


def velocities_of(row: Any, stock: Any, frame: float) -> list[float]:
    """Velocity of each body: of its group, or of the wall or fixed end that holds that."""
    found: list[float] = []
    bodies = row["bodies"]
    for group in groups_of(row):
        inside = [i for i in group if bodies[i]["kind"] == "rod"]
        own = stock.velocity[bodies[inside[0]]["first"]] + frame if len(inside) > 0 else 0.0
        held = []
        for end, i in ((0, group[0]), (1, group[-1])):
            if bodies[i]["kind"] == "wall" and end == (0 if i == 0 else 1):
                held.append(bodies[i]["velocity"])
            elif i == end * (len(bodies) - 1) and row["ends"][end] == "fixed":
                held.append(0.0)
        shared = held[0] if len(held) == 1 or (len(held) == 2 and held[0] == held[1]) else own
        found.extend([
            shared if bodies[i]["kind"] == "rod" else bodies[i]["velocity"] for i in group])
    return found


def outcome_of(row: Any, run: Any) -> Any:
    """What the collision did: velocities, contacts, energies, and e, or why there is none."""
    layout, tally, count = run["layout"], run["tally"], len(row["gaps"])
    tick, frame, nodes = layout.tick_seconds[0], layout.frame[0], row["make"].node
    before, after = (
        velocities_of(row, run["opening"], frame), velocities_of(row, run["closing"], frame)
    )
    contacts = [{
        "impulse": tally.impulse[k] * tick, "peak_force": tally.peak[k],
        "duration": tally.pressed[k] * tick, "episodes": tally.episodes[k],
    } for k in nodes]
    kinetic = vibration_before = vibration_after = 0.0
    for body in row["bodies"]:
        for s in range(body["first"], body["last"] + 1):
            v = run["opening"].velocity[s] + frame
            kinetic += row["segments"][s - 1]["mass"] * v * v / 2
            vibration_before += run["opening"].vibration[s] * tick
            vibration_after += run["closing"].vibration[s] * tick
    able = [k for k in range(count) if not row["bonded"][k]]
    status = sentence_of(row, run)
    why = why_no_restitution(row, run, able, before, status)
    e = math.nan if why != "" else restitution(able[0], before, after)
    return {
        "before": before, "after": after, "contacts": contacts, "able": able,
        "final": proof_of(row, run) >= 0, "status": status, "why": why, "restitution": e,
        "energy_before": kinetic + vibration_before, "vibration_after": vibration_after,
    }


def driven_ends(row: Any) -> bool:
    """Whether something acts on an end from outside."""
    return any(end in ("force", "velocity", "incoming") for end in row["ends"])


def proof_of(row: Any, run: Any) -> int:
    """Tick at which the collision was proved to be over; -1 if it was not."""
    if row["until"] >= 0 and driven_ends(row):
        return -1
    at: int = run["clock"][FINALITY]
    return at


def sentence_of(row: Any, run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    layout, clock, segments = run["layout"], run["clock"], row["segments"]
    tick, proof, stopped_by = layout.tick_seconds[0], proof_of(row, run), "until"
    if run["why"] == FINAL:
        stopped_by = "final"
    elif run["why"] == CAP:
        stopped_by = "max_events"
    elif run["why"] == CLOCK:
        stopped_by = "clock"
    met = any(count > 0 for count in run["tally"].episodes)
    final, end = "", format_si(clock[NOW] * tick, "s")
    if proof >= 0:
        final = pressing(run["state"], run["tally"], row["make"].node)
        if final == "":
            late = stopped_by == "until" and proof >= clock[NOW]
            final = proof_sentence(met, late, proof * tick)
    sentence = cut_short(stopped_by, final, clock[EVENTS], end)
    if sentence == "":
        walls = [i for i, body in enumerate(row["bodies"]) if body["kind"] == "wall"]
        last = len(row["bonded"]) - 1
        held = len(walls) == 2 or any(row["bonded"][min(i, last)] for i in walls)
        acting = "an end is driven" if driven_ends(row) else ""
        sentence = ending(stopped_by, final, end, f"{clock[EVENTS]} events", acting, held)
    error, worst = transit_error_of(row, run)
    fastest, slowest = 0.0, math.inf
    for piece in segments:
        slowest = min(slowest, piece["wave_speed"])
    for r in range(clock[ROWS]):
        fastest = max(fastest, abs(run["log"].value[r]))
    return sentence + rounding(error, worst) + strain_warning(fastest / slowest)


def transit_error_of(row: Any, run: Any) -> Any:
    """Largest relative change of a transit time by its rounding to the clock, and where."""
    layout, error, worst = run["layout"], -1.0, ""
    for s, piece in enumerate(row["segments"]):
        ticks = layout.transit[s + 1]
        off = abs(ticks * layout.tick_seconds[0] / piece["transit_time"] - 1)
        if off > error:
            error, worst = off, piece["path"]
    return error, worst


def why_no_restitution(
    row: Any, run: Any, able: list[int], before: list[float], status: str
) -> str:
    """Why there is no e, as `Outcome` has it; "" if there is one."""
    episodes, closing = 0, 0.0
    if len(able) == 1:
        episodes = run["tally"].episodes[row["make"].node[able[0]]]
        closing = before[able[0]] - before[able[0] + 1]
    final = proof_of(row, run) >= 0
    return no_restitution(len(able), driven_ends(row), episodes, final, closing, status)


def restitution(contact: int, before: list[float], after: list[float]) -> float:
    """e of a contact from the velocities of the bodies."""
    parting = after[contact + 1] - after[contact]
    e = parting / (before[contact] - before[contact + 1])
    stays = parting <= ROUND_OFF * max(abs(after[contact]), abs(after[contact + 1]))
    return 0.0 if e <= ROUND_OFF or stays else e


def restitutions(case: Any, library: Any, path: list[Any], values: list[float]) -> list[Any]:
    """e for each value of a number of a case; None where there is none."""
    found: list[Any] = []
    space = space_of(row_of(case, library))
    for value in values:
        row = row_of(changed(case, path, value), library)
        run = run_of(row, False, space)
        able = [k for k, bonded in enumerate(row["bonded"]) if not bonded]
        e = None
        if run["why"] >= 0:
            frame = run["layout"].frame[0]
            before = velocities_of(row, run["opening"], frame)
            if why_no_restitution(row, run, able, before, "") == "":
                after = velocities_of(row, run["closing"], frame)
                e = restitution(able[0], before, after)
        found.append(e)
    return found


def closed_form_of(row: Any, before: list[float]) -> Any:
    """e of a pair for which theory knows it, and the source; None for any other row."""
    bodies, walls = row["bodies"], 0
    if len(bodies) != 2 or row["bonded"][0] or before[0] <= before[1]:
        return None
    for body, end in zip(bodies, row["ends"], strict=True):
        walls += 1 if body["kind"] == "wall" else 0
        whole = not isinstance(body["velocity"], dict) and body["strain"] == 0.0
        if not whole or end != "free" or body["last"] > body["first"]:
            return None
    if walls > 0:
        return {"restitution": 1.0, "source": "textbook, box 10.4"}
    left, right = row["segments"]
    short_time, long_time, q, p, log_q = pair_numbers(
        left["impedance"], left["transit_time"], right["impedance"], right["transit_time"])
    e = pair_restitution(short_time, long_time, q, p, log_q) * 1.0
    return {"restitution": e, "source": "Saint-Venant 1867"}


def changed(tree: Any, path: list[Any], value: float) -> Any:
    """The tables with another number at a path."""
    if len(path) == 0:
        return value
    copy = [*tree] if isinstance(tree, list) else {**tree}
    copy[path[0]] = changed(tree[path[0]], path[1:], value)
    return copy


def curve_of(case: Any, library: Any, ratio: float) -> Any:
    """e over l1/l2 of two uniform rods, l1 varied and all else as it is.

    None where the left one has a profile, which is bound to the length it was made for.
    """
    left, reach = case["bodies"][0], 2.0
    if isinstance(left.get("velocity", 0.0), dict) or isinstance(left.get("strain", 0.0), dict):
        return None
    while reach < 1.1 * ratio:
        reach *= 2
    ratios = [reach * (k + 1) / RATIOS for k in range(RATIOS)]
    lengths = [r * case["bodies"][1]["length"] for r in ratios]
    values = restitutions(case, library, ["bodies", 0, "length"], lengths)
    return {"ratios": ratios, "values": values, "source": f"solved at {RATIOS} ratios"}


# What is drawn ------------------------------------------------------------------------------------


def waves_of(row: Any, run: Any) -> list[Any]:
    """Ticks and values of the fronts of each line, and the integral up to each of them."""
    log, lines = run["log"], 2 * len(row["segments"]) + 4
    waves: list[Any] = [{"tick": [], "value": [], "passed": []} for _ in range(lines)]
    for r in range(run["clock"][ROWS]):
        wave = waves[log.line[r]]
        count = len(wave["tick"])
        passed = 0.0
        if count > 0:
            lasted = log.tick[r] - wave["tick"][count - 1]
            passed = wave["passed"][count - 1] + wave["value"][count - 1] * lasted
        wave["tick"].append(log.tick[r])
        wave["value"].append(log.value[r])
        wave["passed"].append(passed)
    return waves


def at(wave: Any, tick: int) -> float:
    """Value of a wave from a tick on."""
    value: float = wave["value"][max(0, bisect_right(wave["tick"], tick) - 1)]
    return value


def passed_by(wave: Any, tick: int) -> float:
    """Integral of a wave from its first front to a tick, velocity times ticks."""
    i = max(0, bisect_right(wave["tick"], tick) - 1)
    passed: float = wave["passed"][i] + wave["value"][i] * (tick - wave["tick"][i])
    return passed


def edges_of(wave: Any, start: int, stop: int) -> list[int]:
    """Ticks of the fronts of a wave between two ticks, and these."""
    return [start, *[tick for tick in wave["tick"] if start < tick < stop], stop]


def stretch_of(waves: list[Any], s: int, T: int) -> float:
    """How much longer segment s is at t = 0 than without strain, velocity times ticks."""
    a, b = waves[2 * s], waves[2 * s + 1]
    return (passed_by(b, 0) - passed_by(b, -T) - passed_by(a, 0) + passed_by(a, -T)) / 2


def end_of_picture(row: Any, run: Any, waves: list[Any]) -> int:
    """Last tick up to which there are few enough regions to draw; 0 if there is none."""
    transit = run["layout"].transit
    stop: int = run["clock"][NOW]
    while stop > 0:
        count = 0
        for s in range(1, len(row["segments"]) + 1):
            T = transit[s]
            ps, qs = edges_of(waves[2 * s], -T, stop), edges_of(waves[2 * s + 1], -T, stop)
            for low, high in spans(ps, qs, T, 0, stop):
                count += high - low
        if count <= MOST_REGIONS:
            break
        stop //= 2
    return stop


def tiling_of(row: Any, run: Any, waves: list[Any], stop: int) -> Any:
    """Polygons of constant state, as `Regions`, up to a tick."""
    layout = run["layout"]
    tick, frame = layout.tick_seconds[0], layout.frame[0]
    found: Any = {"body": [], "segment": [], "start": [0], "x": [], "t": [], "displacement": [],
                  "velocity": [], "strain": [], "stress": []}
    for i, body in enumerate(row["bodies"]):
        left, moved = 0.0, 0.0
        for s in range(body["first"], body["last"] + 1):
            T, piece = layout.transit[s], row["segments"][s - 1]
            a, b = waves[2 * s], waves[2 * s + 1]
            ps, qs = edges_of(a, -T, stop), edges_of(b, -T, stop)
            begun, ready = passed_by(a, 0), passed_by(b, -T)
            for k, (low, high) in enumerate(spans(ps, qs, T, 0, stop)):
                right = at(a, ps[k])
                for j in range(low, high):
                    back = at(b, qs[j])
                    strain = (back - right) * (0.5 / piece["wave_speed"])
                    found["body"].append(i)
                    found["segment"].append(s)
                    found["velocity"].append((right + back) / 2 + frame)
                    found["strain"].append(strain)
                    found["stress"].append(strain * piece["youngs_modulus"])
                    for p, q in region(ps[k], ps[k + 1], qs[j], qs[j + 1], T, 0, stop):
                        u = passed_by(a, p) - begun + passed_by(b, q) - ready + frame * (p + q + T)
                        found["x"].append(left + (q - p + T) / 2 / T * piece["length"])
                        found["t"].append((p + q + T) / 2 * tick)
                        found["displacement"].append(u / 2 * tick + moved)
                    found["start"].append(len(found["x"]))
            left += piece["length"]
            moved += stretch_of(waves, s, T) * tick
    return found


def contact_curves(row: Any, run: Any, stop: int) -> list[Any]:
    """Times, s, at which a contact changes, force from then on, N, and gap, m, of each contact.

    The kernel runs again, event by event, to `stop`.
    """
    layout, nodes = run["layout"], row["make"].node
    state, tally, log, clock = work_space(len(row["segments"]), len(run["log"].tick))
    tick, tol, window = layout.tick_seconds[0], layout.tolerance[0], layout.window[0]
    load(state, tally, log, clock, layout, 0, run["status"])
    clock[REST] = IDLE
    curves: list[Any] = [{"t": [], "force": [], "gap": []} for _ in nodes]
    now = 0
    while now < stop:
        now = min(state.tree[1], stop)
        advance(state, tally, log, clock, now, run["clock"][EVENTS], tol, window)
        for i, node in enumerate(nodes):
            if state.since[node] == now or now in (0, stop):
                gap = state.gap[node] + state.rate[node] * (now - state.since[node])
                curves[i]["t"].append(now * tick)
                curves[i]["force"].append(state.force[node])
                curves[i]["gap"].append(0.0 if row["bonded"][i] else max(gap, 0.0) * tick)
    return curves


def gauge_curve(row: Any, run: Any, waves: list[Any], body: int, x: float, stop: int) -> Any:
    """Times, s, and strain from then on, at a place of a rod, m from its left end."""
    layout, s, left = run["layout"], row["bodies"][body]["first"], 0.0
    while s < row["bodies"][body]["last"] and left + row["segments"][s - 1]["length"] <= x:
        left += row["segments"][s - 1]["length"]
        s += 1
    piece, T, a, b = row["segments"][s - 1], layout.transit[s], waves[2 * s], waves[2 * s + 1]
    offset = max(0, min(T, round((x - left) / piece["length"] * T)))
    arrivals = [tick + offset for tick in a["tick"]]
    arrivals.extend([0, *[tick + T - offset for tick in b["tick"]]])
    times, strains, before = [], [], -1
    for tick in sorted(arrivals):
        if before < tick < stop:
            strain = at(b, tick - T + offset) - at(a, tick - offset)
            times.append(tick * layout.tick_seconds[0])
            strains.append(strain * (0.5 / piece["wave_speed"]))
            before = tick
    times.append(stop * layout.tick_seconds[0])
    strains.append(strains[-1])
    return {"t": times, "strain": strains}


def energy_curves(row: Any, tiling: Any) -> Any:
    """Energy by kind over time, J, from the widths of the polygons.

    Between the times of all corners the widths are linear, so momentum, kinetic and strain energy
    are; the rest is their parabolas.
    """
    knots = times_of(tiling["t"])
    moving, strained = [0.0 for _ in knots], [0.0 for _ in knots]
    momenta = [[0.0 for _ in knots] for _ in row["bodies"]]
    for i, body in enumerate(tiling["body"]):
        piece = row["segments"][tiling["segment"][i] - 1]
        first, end = tiling["start"][i], tiling["start"][i + 1]
        per_length, v = piece["mass"] / piece["length"], tiling["velocity"][i]
        x, t = tiling["x"][first:end], tiling["t"][first:end]
        low, high = t[0], t[0]
        for when in t:
            low, high = min(low, when), max(high, when)
        for k in range(max(0, bisect_right(knots, low) - 1), bisect_right(knots, high)):
            width = width_at(x, t, knots[k])
            moving[k] += per_length * v * v / 2 * width
            strained[k] += piece["area"] * tiling["stress"][i] * tiling["strain"][i] / 2 * width
            momenta[body][k] += per_length * v * width
    parts = max(PARTS, POINTS // len(knots)) if len(knots) <= MOST_TIMES else 1
    found: Any = {"t": [], "whole": [], "vibration": [], "strain": [], "total": []}
    for k in range(len(knots)):
        for part in range(parts if k < len(knots) - 1 else 1):
            share, after, whole = part / parts, min(k + 1, len(knots) - 1), 0.0
            for group in groups_of(row):
                mass, momentum = 0.0, 0.0
                for i in group:
                    mass += row["bodies"][i]["mass"]
                    momentum += momenta[i][k] + (momenta[i][after] - momenta[i][k]) * share
                whole += momentum * momentum / (2 * mass) if mass > 0 else 0.0
            kinetic = moving[k] + (moving[after] - moving[k]) * share
            strain = strained[k] + (strained[after] - strained[k]) * share
            found["t"].append(knots[k] + (knots[after] - knots[k]) * share)
            found["whole"].append(whole)
            found["vibration"].append(kinetic - whole)
            found["strain"].append(strain)
            found["total"].append(kinetic + strain)
    return found


def times_of(corners: list[float]) -> list[float]:
    """Each time once, in order; even ones, if they are too many."""
    found: list[float] = []
    for t in sorted(corners):
        if len(found) == 0 or t > found[-1]:
            found.append(t)
    if len(found) <= MOST_TIMES:
        return found
    return [found[-1] * i / MOST_TIMES for i in range(MOST_TIMES + 1)]


def width_at(x: list[float], t: list[float], when: float) -> float:
    """Width of a polygon at a time, m."""
    low, high = math.inf, -math.inf
    for k in range(len(t)):
        after = (k + 1) % len(t)
        if min(t[k], t[after]) <= when <= max(t[k], t[after]):
            share = 0.0 if t[k] == t[after] else (when - t[k]) / (t[after] - t[k])
            place = x[k] + (x[after] - x[k]) * share
            low, high = min(low, place), max(high, place)
            if t[k] == t[after]:
                low, high = min(low, x[after]), max(high, x[after])
    return high - low if high > low else 0.0
