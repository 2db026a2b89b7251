"""The `Run` that all methods return, made of a run on a grid.

It has signals, tallies and a status.
"""

import math
from functools import partial
from typing import Any

import numpy as np

from ...units import format_si
from ..run import (
    INWARD,
    Coarser,
    ContactSignal,
    ContactTally,
    Run,
    ShaftAction,
    Signals,
)
from ..signals import Floats, Pieces
from ..status import (
    describe_end,
    last_contact,
    proof_sentence,
    quake_warning,
    strain_warning,
    with_advice,
)
from .forces import contact_forces, outside_of, over_steps
from .measures import episodes_from_intervals, largest_force
from .mesh import STEP_TICKS
from .refinement import UNREFINED
from .run import OVERSHOOT_STEPS, GridRun
from .smoothness import order_of
from .soil import shaft_bodies

OVERSHOOT_TO_TELL = 1e-2
"""Relative overshoot of the peak force from which the status tells it."""
STEP_RTOL = 1e-9
"""An impact that lasts no longer than a step, to this part of it, takes no time."""


def make_run(run: GridRun, until: float | None) -> Run:
    """Make the `Run` that all methods return of a finished run on a grid to `until`, s.

    It has the times of the proof and of the last contact, totals of contacts, the
    status in sentences, the coarser runs for errors of fields, and a function that
    makes the signals.
    """
    outside = outside_of(run, 0), outside_of(run, 1)
    forces = contact_forces(run, outside[0])
    intervals = []
    contacts = []
    for k, force in enumerate(forces):
        of_contact = run.force_intervals(k)
        intervals.append(of_contact)
        contacts.append(_tally(run, k, force, of_contact))
    t_end = until
    if t_end is None:
        t_end = float(run.times[-1])
    t_final = math.nan
    t_proved = math.nan
    proof = ""
    if run.proved >= 0:
        t_proved = float(run.times[run.proved])
        t_final = _last_contact_end(run, intervals, t_end)
        proof = proof_sentence(any(x.episodes for x in contacts), t_final)
    events = run.steps * len(run.row.links)
    end = run.steps * STEP_TICKS
    if until and not run.steps:  # the run ends before half a step
        end = math.ceil(until / run.clock.tick)
    steep = bool(run.coarser) and order_of(run.row) < 1
    coarser = []
    for share, other in run.coarser:
        coarser.append(Coarser(share, steep, partial(make_run, other, until)))
    return Run(
        method="finite-difference",
        until=until,
        clock=run.clock,
        end=end,
        t_end=t_end,
        t_final=t_final,
        t_proved=t_proved,
        stopped_by=run.stopped_by,
        status=_status(run, proof, t_end, events),
        events=events,
        contacts=tuple(contacts),
        accuracy=run.estimates,
        coarser=tuple(coarser),
        make_signals=lambda: _signals(run, forces, intervals, outside),
    )


def _last_contact_end(run: GridRun, intervals: list[Floats], t_end: float) -> float:
    """Time at which the last contact ended in a proved run to `t_end`, s.

    It is found by `status.last_contact`, which says when it is 0, inf or nan.
    `intervals` are the times of `GridRun.force_intervals` of each contact.
    """
    # End of the last force of each contact, and the opening after it
    ends = []
    for of_contact in intervals:
        if len(of_contact):
            ends.append(of_contact[-1, 1:].tolist())
    round_trip = 2 * run.clock.longest_rod * run.clock.tick  # s
    return last_contact(ends, t_end, round_trip)


# Status -------------------------------------------------------------------------------


def _status(run: GridRun, proof: str, t_end: float, events: int) -> str:
    """Sentences on why the run ended, its mesh, and how accurate it is.

    `proof` is the sentence of its proof of finality, `events` the number of steps times
    links.
    """
    cap = f"{events} steps times ends"
    end = format_si(t_end, "s")
    why = describe_end(run.stopped_by, proof, end, cap, run.row.system)
    status = with_advice(why)
    size = sum(run.mesh.counts)
    status += f" Time step {format_si(run.step, 's')}, {size} cells."
    if t_end and not run.steps:
        status += (
            " The run ends before half a step, and none was taken. "
            "More cells shorten it."
        )
    status += _accuracy_sentence(run)
    status += _overshoot_sentence(run)
    status += quake_warning(run.row.system)
    return status + strain_warning(run.largest_strain)


def _overshoot_sentence(run: GridRun) -> str:
    """Warning of a peak force that depends on the mesh; empty if it does not.

    It does where flat ends of damped rods or of rods with lateral inertia meet, and
    where waves overshoot by more than is told.
    """
    reason = ""
    if run.peak_error == math.inf:
        reason = "flat ends meet, and a finer mesh finds a larger force"
    elif run.overshoot > max(run.rtol, OVERSHOOT_TO_TELL):
        reason = (
            f"waves overshoot beside jumps, and the mean over {OVERSHOOT_STEPS} steps "
            f"is lower by {100 * run.overshoot:.1g} %"
        )
    if reason == "":
        return ""
    return f" The peak force is that of this mesh: {reason}."


def _accuracy_sentence(run: GridRun) -> str:
    """Stated errors of the outcome, and the remedy where they are too large.

    Peak forces and durations may stay inaccurate: they depend on few steps and on weak
    forces.
    """
    stated = []
    for name, error in run.estimates.items():
        if error < math.inf:
            stated.append(f"{name} {error:.1g}")
    sentence = ""
    if stated:
        sentence = f" Stated relative error: {', '.join(stated)}."
    for name, error in run.estimates.items():
        if error > run.rtol and name not in UNREFINED:
            remedy = "Take a larger rtol, or give more cells."
            return f"{sentence} Not converged to {run.rtol:g}. {remedy}"
    return sentence


# Contacts and signals -----------------------------------------------------------------


def _tally(run: GridRun, k: int, force: Floats, intervals: Floats) -> ContactTally:
    """Totals of contact k in SI units.

    `force` is its mean force in each step, `intervals` are the times of
    `GridRun.force_intervals`. An impact has no peak force (nan).
    """
    law = run.row.system.contacts[k]
    begins, ends = run.force_spans(intervals)
    if law.opens:
        peak = largest_force(force)
    else:
        peak = float(np.max(force, initial=0.0))
    if law.law == "rigid" and law.restitution is not None:
        # An impact takes no time, though it takes a step here.
        peak = math.nan
        is_instant = ends - begins <= run.step * (1 + STEP_RTOL)
        ends = np.where(is_instant, begins, ends)
    first = math.nan
    last = math.nan
    if len(begins):
        first = float(begins[0])
        last = float(ends[-1])
    return ContactTally(
        impulse=float(force.sum() * run.step),
        peak_force=peak,
        duration=float((ends - begins).sum()),
        first=first,
        last=last,
        episodes=len(episodes_from_intervals(intervals)),
    )


def _signals(
    run: GridRun, forces: list[Floats], intervals: list[Floats], outside: Any
) -> Signals:
    """Signals of contacts, ends, masses and soil, and the motion.

    The motion has the forces between pieces. `forces`, N, and `intervals`, s, are those
    of the contacts; `outside` acts on both ends.
    """
    row = run.row
    edges = run.edges
    contacts = []
    for k, force in enumerate(forces):
        link = row.contact_link[k]
        gap = np.zeros(run.steps + 1)  # a bond has none
        closing = np.zeros(run.steps)
        if k in row.by_law:
            gap = run.contact(k)[1]
            closing = run.recorded(link, "closing")
        signal = ContactSignal(
            over_steps(run, force),
            Pieces.through(edges, gap),
            over_steps(run, closing),
            episodes_from_intervals(intervals[k]),
        )
        contacts.append(signal)
    masses = {}
    for body, mass in enumerate(row.mass_of):
        if mass >= 0:
            masses[body] = Pieces.through(edges, run.mass_velocity(mass))
    motion = run.motion()._replace(pushes=_pushes_on_nodes(run, forces, outside))
    shafts = {}
    for shaft, body in enumerate(shaft_bodies(row)):
        push = over_steps(run, run.recorded_soil(shaft, "force"))
        shafts[body] = ShaftAction(
            push, over_steps(run, run.recorded_soil(shaft, "power"))
        )
    return Signals(motion, tuple(contacts), outside, edges, masses, shafts)


def _pushes_on_nodes(
    run: GridRun, forces: list[Floats], outside: Any
) -> dict[int, Floats]:
    """Mean forces to the right from outside a piece in each step, N [step], by node.

    `forces` are those of the contacts, of which bonds lie inside a piece; `outside`
    acts on both ends of the row.
    """
    mesh = run.mesh
    pushes: dict[int, Floats] = {}
    for k, force in enumerate(forces):
        link = run.row.contact_link[k]
        if link in mesh.touching:
            left, right = mesh.touching[link]
            pushes[left] = pushes.get(left, 0.0) - force
            pushes[right] = pushes.get(right, 0.0) + force
    for side, end in enumerate(outside):
        if end is not None:
            node = mesh.ends[side]
            pushes[node] = pushes.get(node, 0.0) + INWARD[side] * end.push.values
    return pushes
