"""What is known of a collision that characteristics carry, as `picture` shows it.

Plain Python, which the page has as JavaScript.
"""

from __future__ import annotations

from typing import Any

from ..methods.abilities import has_driven_end
from ..methods.groups import body_velocities
from ..methods.laws import Stop
from ..methods.pieces.accuracy import size_of
from ..methods.pieces.layout import longest_of
from ..methods.pieces.method import RTOL
from ..methods.pieces.totals import stated, status_of, tally_of, told_of, why_stopped
from ..methods.row import STIFFEST
from ..methods.status import DRIVEN, is_held, strain_warning
from ..methods.walk import largest, scale_of, smallest, walk
from .fronts import TOO_FAR_APART
from .known import curves_of, described, gauge_of, outcome_told, positions_of
from .smooth_motion import energy_curves, gauge_curve, grids_of, line_curve, path_of, waves_of
from .smooth_runs import run_of, solved
from .tables import asked_of, system_of

QUICK = 1e-6  # tolerance of curves and maps


def smooth_known(system: Any, asked: Any, gauges: Any, tolerance: float = RTOL) -> Any:
    """What `picture` shows of a system with compliant contacts or rigid masses.

    Parameters
    ----------
    system : Row
    asked : Asked
    gauges : list of dict
        Each with its ``body`` and ``fraction`` of the length.
    tolerance : float
        Of pieces of waves.

    Returns
    -------
    dict
        Or one with a ``problem``, path and sentence, where there is nothing to show.
    """
    row = walk(system)
    problem = refused(row, asked)
    if problem is not None:
        return {"problem": problem}
    run = solved(row, asked, tolerance)
    if run is None:
        return {"problem": ("bodies", TOO_FAR_APART)}
    if run["ended"].run.stop == Stop.STUCK:
        message = "a rigid mass is squeezed between walls; give a contact there a compliant law"
        return {"problem": ("contacts", message)}
    outcome = smooth_outcome(run)
    if run["now"] == 0:
        return {"problem": ("solve", f"lasts no time to show. {outcome['status']}")}
    waves, end, lengths, paths = waves_of(run), run["now"] * run["clock"].tick, [], []
    for i, body in enumerate(system.bodies):
        length, path = 0.0, None
        for piece in body.segments:
            length += piece.length * (1 + body.strain)
        if body.kind == "mass":
            path = path_of(run, waves[run["mass"][row.mass_of[i]].line])
        elif body.kind == "wall":
            path = {"t": [0.0, end], "displacement": [0.0, body.velocity * end]}
        lengths.append(length)
        paths.append(path)
    records, contacts = [], []
    for gauge in gauges:
        s, x, name = gauge_of(system, gauge)
        t, strain = gauge_curve(run, waves, row.spans[gauge["body"]][0] - 1 + s, x)
        records.append((name, t, strain))
    for i, law in enumerate(system.contacts):
        it = run["ended"].link[row.contact_link[i]]
        times, force = line_curve(run, waves[it.force_line], 1.0)
        if force[0] != 0:  # it jumps at t = 0
            times, force = [0.0, *times], [0.0, *force]
        gap = line_curve(run, waves[it.overlap_line], -1.0) if law.opens else None
        contacts.append({"force": (times, force), "gap": gap})
    return {
        **described(system, paths, positions_of(system, lengths), grids_of(run, waves), outcome),
        "method": "characteristics", "exact": False, "closed_form": None, "gauges": gauges,
        "notes": [outcome["status"], "The picture shows means over cells."],
        "plots": curves_of(system, contacts, energy_curves(run, waves), records, False),
    }


def refused(row: Any, asked: Any) -> Any:
    """Path and sentence of what nobody can solve; None if there is nothing."""
    for i, place in enumerate(row.contact_link):
        if is_beyond(row, place):
            return (f"contacts.{i}.stiffness", "is as good as rigid here; make it less stiff")
    if has_driven_end(row.system) and asked.until < 0:
        return ("solve.until", "must be given where an end is driven")
    return None


def is_beyond(row: Any, i: int) -> bool:
    """Whether a link is too stiff to be told from a rigid one."""
    T, scale = largest([s.transit_time for s in row.segments]), scale_of(row)
    stiff = row.stiffness[i] * (T / smallest([s.impedance for s in row.segments]))
    return not stiff * ((scale if scale > 0 else 1.0) * T) ** (row.exponent[i] - 1) <= STIFFEST


def smooth_outcome(run: Any) -> Any:
    """What the collision did, as `outcome_told` has it."""
    row, ended, tick, frame = run["row"], run["ended"], run["clock"].tick, run["clock"].frame
    heads, it = [part for part in ended.part if part.parts > 0], ended.run
    contacts = [tally_of(ended.link[i], tick, run["now"]) for i in row.contact_link]
    vibration, energy, momentum = 0.0, 0.0, 0.0  # momentum: what a velocity can make of energy
    for part in ended.part:
        vibration += part.energy
    for body in row.system.bodies:
        energy += body.mass * body.velocity**2 / 2
        momentum += body.mass * it.scale
        for piece in body.segments:
            energy += piece.mass * (piece.wave_speed * body.strain) ** 2 / 2
    speed = run["errors"][0] * it.scale
    return outcome_told(row.system, {
        "before": body_velocities(row.system, [part.initial + frame for part in heads]),
        "after": body_velocities(row.system, [part.mean + frame for part in heads]),
        "contacts": contacts, "final": it.proved >= 0, "status": smooth_sentence(run),
        "energy_before": energy, "vibration_after": vibration,
        "errors": {
            "velocity": speed, "energy": momentum * speed,
            "impulse": run["errors"][1] * size_of([c.impulse for c in contacts]),
            "peak_force": run["errors"][2] * size_of([c.peak_force for c in contacts]),
            "duration": run["errors"][3] * size_of([c.duration for c in contacts]),
        },
    })


def smooth_sentence(run: Any) -> str:
    """Why the run ended, as `Solution.status` has it."""
    row, ended, tick, fastest = run["row"], run["ended"], run["clock"].tick, 0.0
    it = ended.run
    for piece in run["log"][: it.pieces]:
        if piece.line < 2 * len(row.segments):
            speed = 0.0
            for c in piece.coefficient:
                speed += abs(c)
            fastest = max(fastest, speed / row.segments[piece.line // 2].wave_speed)
    sentence = status_of(it, ended.link, {
        "stopped_by": why_stopped(it, run["until"] >= 0), "end": run["now"] * tick,
        "round_trip": 2 * longest_of(row, run["clock"], 0) * tick,
        "acting": DRIVEN if has_driven_end(row.system) else "", "held": is_held(row.system),
    })
    return sentence + stated(size_of(run["errors"][:3]), run["goal"]) + told_of(it) + (
        strain_warning(fastest))


def smooth_restitution(case: Any, library: Any) -> Any:
    """e of a case, as quickly as a curve needs it; None where there is none."""
    row, asked = walk(system_of(case, library)), asked_of(case)
    stiff = any(is_beyond(row, i) for i in row.contact_link)
    run = None if stiff else run_of(row, asked, QUICK, False, None)
    if run is None or run["ended"].run.stop == Stop.STUCK:
        return None
    outcome = smooth_outcome({**run, "errors": [0.0 for _ in range(5)], "goal": QUICK})
    return outcome["restitution"] if outcome["why"] == "" else None
