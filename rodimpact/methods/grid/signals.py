"""From a run on a grid to what every method hands back: signals, tallies, and a status."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...model import Wall
from ...units import format_si
from ..run import ContactSignal, ContactTally, Episode, Outside, Run, Signals
from ..signals import Floats, Pieces
from ..status import end_sentence, last_contact, proof_sentence, strain_warning
from .measures import episodes_of_steps, largest_force, pressed_spans
from .mesh import STEP_TICKS
from .refinement import ROUGH
from .run import RINGING, GridRun

LARGE_CHANGE = 1e-2  # of the peak force, from which it is said
KINDS = {"velocity": "drive", "force": "drive", "absorbing": "absorbing"}


class StepRecord(NamedTuple):
    """Means over steps, and what is between them.

    forces, gaps, paths : by contact, [steps] N, [steps + 1] m, and [steps] m by which the bodies
    approach under the force: beside the change of the gap what a grid loses as it shuts.
    spans : by contact, when it pressed, s; none of one that cannot open.
    ends : left and right, kind, [steps] force on the row, N, and velocity, m/s, or None.
    """

    forces: list[Floats]
    gaps: list[Floats]
    paths: list[Floats]
    spans: list[list[tuple[float, float]]]
    ends: list[tuple[str, Floats, Floats] | None]


def hand_over(run: GridRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`, s."""
    record, tick, size = _record(run), run.clock.tick, sum(run.mesh.counts)
    final = run.proved >= 0
    t_end = until if until is not None else float(run.times[-1])
    t_proved = float(run.times[run.proved]) if final else math.nan
    t_final = math.nan
    if final:
        times = [episodes[-1][1:] for episodes in _episodes(run, record) if episodes]
        t_final = last_contact(times, t_end, 2 * run.clock.longest * tick)
    proof = proof_sentence(any(run.grid.link["episodes"]), t_final) if final else ""
    events = run.steps * len(run.row.laws)
    status = end_sentence(
        run.row.system, run.stopped_by, proof, format_si(t_end, "s"), f"{events} steps times ends")
    status += f" Time step {format_si(run.step, 's')}, {size} cells."
    if until and not run.steps:
        status += " The end comes before half a step: none was taken. More cells shorten it."
    status += _accuracy(run) + _own_peak(run) + strain_warning(run.largest_strain)
    end = run.steps * STEP_TICKS
    if until and not run.steps:
        end = math.ceil(until / run.clock.tick)
    return Run(
        method="finite-difference", until=until, clock=run.clock, end=end, t_end=t_end,
        t_final=t_final, t_proved=t_proved, stopped_by=run.stopped_by, status=status,
        events=events, contacts=_tallies(run, record), accuracy=run.estimates,
        make_signals=lambda: _signals(run, record),
    )


def _own_peak(run: GridRun) -> str:
    """A warning of a peak force that is not that of the bodies."""
    reasons, large = [], max(run.rtol, LARGE_CHANGE)
    if run.peak_change > large:
        reasons.append(f"refining changed it by {run.peak_change:.1g}")
    if run.overshoot > large:
        reasons.append(
            f"beside jumps waves overshoot, and over {RINGING} steps it is less by "
            f"{run.overshoot:.1g} of itself"
        )
    return f" The peak force is that of this mesh: {'; '.join(reasons)}." if reasons else ""


def _accuracy(run: GridRun) -> str:
    """How wrong the outcome may be, where contacts follow laws, and what makes it less.

    Durations may stay rough: they hang on where faint forces begin and end.
    """
    errors = {name: value for name, value in run.estimates.items() if name not in ROUGH}
    if not errors or not run.row.by_law:
        return ""
    late = {name: value for name, value in errors.items() if value > run.rtol}
    if not late:
        worst = max(errors.values())
        rough = "".join(
            f", {name} {run.estimates[name]:.1g}" for name in ROUGH
            if worst < run.estimates.get(name, 0.0) < math.inf)
        return f" Stated relative error: {worst:.1g}{rough}."
    which = ", ".join(f"{name} to {value:.1g}" for name, value in late.items() if value < math.inf)
    return (
        f" Not converged to {run.rtol:g}: {which or 'too long a run to divide the step'}; "
        f"a larger rtol is soon reached, more cells goes on."
    )


def _record(run: GridRun) -> StepRecord:
    row, forces, gaps, paths, spans = run.row, [], [], [], []
    for k, link in enumerate(row.contact_link):
        if k in row.by_law:
            force, gap = run.contact(k)
            forces.append(force)
            gaps.append(gap)
            paths.append(run.path(k))
            spans.append(pressed_spans(run.times, force, gaps[-1]) if k in row.opening else [])
        else:
            forces.append(run.bond(link) if link >= 0 else np.full(run.steps, math.nan))
            gaps.append(np.zeros(run.steps + 1))
            paths.append(np.zeros(run.steps))
            spans.append([])
    ends: list[tuple[str, Floats, Floats] | None] = []
    for side, (kind, _) in enumerate(row.outside):
        wall = isinstance(row.system.bodies[-side], Wall)
        ends.append(None if kind == "none" else ("wall" if wall else KINDS[kind], *run.outer(side)))
    _join_rigid_bodies(run, forces, [end[1] if end else np.zeros(run.steps) for end in ends])
    return StepRecord(forces, gaps, paths, spans, ends)


def _join_rigid_bodies(run: GridRun, forces: list[Floats], pushes: list[Floats]) -> None:
    """Fill in the forces between bonded rigid bodies, from Newton's law for one after the other.

    `pushes` act on the two ends of the row, to the inside.
    """
    bodies: Any = run.row.system.bodies
    rigid = [i < 0 for i in run.row.contact_link]

    def spent(body: int) -> Floats:
        gained = float(bodies[body].mass) * np.diff(run.speed(run.row.mass_of[body]))
        return np.asarray(gained / run.step)

    held = rigid.index(False) if isinstance(bodies[0], Wall) and False in rigid else 0
    for k in range(held - 1, -1, -1):
        forces[k] = forces[k + 1] + spent(k + 1)
    for k in range(held, len(forces)):
        if rigid[k]:
            forces[k] = (forces[k - 1] if k else pushes[0]) - spent(k)


def _tallies(run: GridRun, record: StepRecord) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    tallies, totals, times = [], run.grid.link, run.times
    for k, (force, spans) in enumerate(zip(record.forces, record.spans, strict=True)):
        law = run.row.system.contacts[k]
        if not law.opens:
            impulse = float(force.sum() * run.step)
            tallies.append(ContactTally(impulse, float(np.max(force, initial=0.0)), 0.0,
                                        math.nan, math.nan, 0))
            continue
        link = run.place(k)
        begins, ends = np.array(spans).reshape(-1, 2).T
        ends = np.nan_to_num(ends, nan=times[-1])
        sudden = getattr(law, "restitution", None) is not None
        if sudden:  # an impact takes no time, though it takes a step here
            ends = np.where(ends - begins <= run.step * (1 + 1e-9), begins, ends)
        highest = largest_force(times, force)
        tallies.append(ContactTally(
            impulse=float(totals["impulse"][link]) * run.step,
            duration=float((ends - begins).sum()),
            peak_force=math.nan if sudden else highest,
            first=float(begins[0]) if spans else math.nan,
            last=float(ends[-1]) if spans else math.nan, episodes=int(totals["episodes"][link]),
        ))
    return tuple(tallies)


def _episodes(run: GridRun, record: StepRecord) -> list[tuple[Episode, ...]]:
    """Touchings of each contact."""
    columns = record.forces, record.gaps, record.spans
    return [episodes_of_steps(run.times, force, gap, run.resolved, spans) if spans else ()
            for force, gap, spans in zip(*columns, strict=True)]


def _signals(run: GridRun, record: StepRecord) -> Signals:
    row, edges, contacts = run.row, run.edges, []
    for force, gap, path, episodes in zip(*record[:3], _episodes(run, record), strict=True):
        if len(force):
            contacts.append(ContactSignal(
                Pieces(edges[:-1], force), Pieces.through(edges, gap),
                Pieces(edges[:-1], path / run.step), episodes,
            ))
        else:
            still = Pieces([0], [0.0])
            contacts.append(ContactSignal(still, Pieces([0], gap), still, episodes))
    left, right = (
        Outside(end[0], Pieces(edges[:-1], end[1]), Pieces(edges[:-1], end[2]))
        if end is not None and len(end[1]) else None for end in record.ends
    )
    masses = {
        body: Pieces.through(edges, run.speed(m)) for body, m in enumerate(row.mass_of) if m >= 0
    }
    motion = run.motion(pushes=run.mesh.outer_forces(record.forces, record.ends))
    return Signals(motion, tuple(contacts), (left, right), edges, masses)
