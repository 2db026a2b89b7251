"""From a run on a grid to what every method hands back: signals, tallies, and a status."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...units import format_si
from ..groups import fill_bonds
from ..run import INWARD, ContactSignal, ContactTally, Episode, Outside, Run, Signals
from ..signals import Floats, Pieces
from ..status import acting_and_held, ending, last_contact, proof_sentence, strain_warning
from .measures import episodes_of_steps, largest_force, pressed_spans
from .mesh import STEP_TICKS
from .refinement import ROUGH
from .run import RINGING, GridRun

LARGE_CHANGE = 1e-2  # of the peak force, from which it is said


class Contact(NamedTuple):
    """What passed at a contact: means over steps, and what is between them.

    force [steps] N; gap [steps + 1] m; path [steps] m by which the bodies approach under the force:
    beside the change of the gap what a grid loses as it shuts; spans [n, 2] in which it pressed, s,
    and episodes, none of a contact that cannot open.
    """

    force: Floats
    gap: Floats
    path: Floats
    spans: Floats
    episodes: tuple[Episode, ...]


def hand_over(run: GridRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`, s."""
    outside, size = _outside(run), sum(run.mesh.counts)
    contacts = _contacts(run, outside[0].push.values if outside[0] else np.zeros(run.steps))
    final, t_final = run.proved >= 0, math.nan
    t_end = until if until is not None else float(run.times[-1])
    t_proved = float(run.times[run.proved]) if final else math.nan
    if final:
        ends = [contact.episodes[-1][1:] for contact in contacts if contact.episodes]
        t_final = last_contact(ends, t_end, 2 * run.clock.longest * run.clock.tick)
    proof = proof_sentence(any(run.grid.link["episodes"]), t_final) if final else ""
    events = run.steps * len(run.row.laws)
    status = ending(run.stopped_by, proof, format_si(t_end, "s"), f"{events} steps times ends",
                    *acting_and_held(run.row.system))
    status += f" Time step {format_si(run.step, 's')}, {size} cells."
    if until and not run.steps:
        status += " The run ends before half a step, and none was taken. More cells shorten it."
    status += _accuracy(run) + _own_peak(run) + strain_warning(run.largest_strain)
    end = run.steps * STEP_TICKS
    if until and not run.steps:
        end = math.ceil(until / run.clock.tick)
    return Run(
        method="finite-difference", until=until, clock=run.clock, end=end, t_end=t_end,
        t_final=t_final, t_proved=t_proved, stopped_by=run.stopped_by, status=status,
        events=events, contacts=tuple(_tally(run, k, x) for k, x in enumerate(contacts)),
        accuracy=run.estimates, make_signals=lambda: _signals(run, contacts, outside),
    )


def _own_peak(run: GridRun) -> str:
    """A warning of a peak force that is not that of the bodies."""
    reason = ""
    if run.peak_error == math.inf:
        reason = "flat ends meet, and a finer mesh finds a larger force"
    elif run.overshoot > max(run.rtol, LARGE_CHANGE):
        reason = (f"waves overshoot beside jumps, and the mean over {RINGING} steps is lower by "
                  f"{100 * run.overshoot:.1g} %")
    return f" The peak force is that of this mesh: {reason}." if reason else ""


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
        f" Not converged to {run.rtol:g}: {which or 'too long a run to divide the step'}. Take a "
        "larger rtol, or give more cells."
    )


def _contacts(run: GridRun, pushed: Floats) -> list[Contact]:
    """What passed at each contact; `pushed` is the force of what is outside the left end."""
    row, still = run.row, np.zeros(run.steps)
    known = [run.contact(k)[0] if k in row.by_law else None if link < 0 else run.bond(link)
             for k, link in enumerate(row.contact_link)]

    def spent(body: int) -> Floats:
        mass = float(row.system.bodies[body].mass)
        return np.asarray(mass * np.diff(run.speed(row.mass_of[body])) / run.step)

    found = []
    for k, force in enumerate(fill_bonds(row.system, known, spent, pushed)):
        contact = Contact(force, np.zeros(run.steps + 1), still, np.zeros((0, 2)), ())
        if k in row.by_law:
            contact = contact._replace(gap=run.contact(k)[1], path=run.path(k))
        if k in row.opening:
            spans = pressed_spans(force, contact.gap)
            episodes = episodes_of_steps(force, contact.gap, run.resolved, spans)
            times = (run.step * np.array(episodes).reshape(-1, 3)).tolist()
            contact = contact._replace(
                spans=run.step * np.array(spans).reshape(-1, 2),
                episodes=tuple(Episode(*steps) for steps in times))
        found.append(contact)
    return found


def _tally(run: GridRun, k: int, contact: Contact) -> ContactTally:
    """Totals of contact k in SI units."""
    law, force = run.row.system.contacts[k], contact.force
    if not law.opens:
        return ContactTally(float(force.sum() * run.step), float(np.max(force, initial=0.0)), 0.0,
                            math.nan, math.nan, 0)
    link, sudden = run.grid.link[run.place(k)], getattr(law, "restitution", None) is not None
    begins, ends = contact.spans.T
    ends = np.nan_to_num(ends, nan=run.times[-1])
    if sudden:  # an impact takes no time, though it takes a step here
        ends = np.where(ends - begins <= run.step * (1 + 1e-9), begins, ends)
    return ContactTally(
        impulse=float(link["impulse"]) * run.step, duration=float((ends - begins).sum()),
        peak_force=math.nan if sudden else largest_force(force),
        first=float(begins[0]) if len(begins) else math.nan,
        last=float(ends[-1]) if len(ends) else math.nan, episodes=int(link["episodes"]),
    )


def _outside(run: GridRun) -> tuple[Outside | None, Outside | None]:
    """What acted on the left and on the right end."""
    found: list[Outside | None] = []
    for side, (kind, _) in enumerate(run.row.outside):
        if kind == "none" or not run.steps:
            found.append(None)
            continue
        force, speed = (Pieces(run.edges[:-1], means) for means in run.outer(side))
        found.append(Outside(run.row.outside_name(side), force, speed))
    return found[0], found[1]


def _signals(run: GridRun, contacts: list[Contact], outside: Any) -> Signals:
    row, edges, still = run.row, run.edges, Pieces([0], [0.0])

    def over(means: Floats) -> Pieces:
        return Pieces(edges[:-1], means) if run.steps else still

    signals = tuple(
        ContactSignal(over(contact.force), Pieces.through(edges, contact.gap),
                      over(contact.path / run.step), contact.episodes) for contact in contacts)
    masses = {
        body: Pieces.through(edges, run.speed(m)) for body, m in enumerate(row.mass_of) if m >= 0
    }
    motion = run.motion(pushes=_pushes(run, contacts, outside))
    return Signals(motion, signals, outside, edges, masses)


def _pushes(run: GridRun, contacts: list[Contact], outside: Any) -> dict[int, Floats]:
    """By node: forces to the right of contacts that are not bonded and of what is outside, N."""
    row, mesh = run.row, run.mesh
    pushes: dict[int, Floats] = {}
    for contact, link in zip(contacts, row.contact_link, strict=True):
        for node, sign in zip(mesh.touching.get(link, ()), INWARD[::-1], strict=False):
            pushes[node] = pushes.get(node, 0.0) + sign * contact.force
    for node, sign, link, end in zip(
        mesh.ends, INWARD, (0, len(row.laws) - 1), outside, strict=True
    ):
        if end is not None and link not in mesh.touching:
            pushes[node] = pushes.get(node, 0.0) + sign * end.push.values
    return pushes
