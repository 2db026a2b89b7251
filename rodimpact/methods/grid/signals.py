"""The `Run` that all methods return, made from a run on a grid.

It has signals, totals of contacts and a status.
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
"""Smallest relative overshoot of the peak force that the status reports."""
STEP_RTOL = 1e-9
"""Relative round-off of a step: an impact of at most one step is instantaneous."""


def make_run(run: GridRun, until: float | None) -> Run:
    """Make the `Run` that all methods return from a finished run on a grid.

    It has the times of the proof and of the last contact (nan without a proof), totals
    of contacts, the status in sentences, the coarser runs for errors of fields, and a
    function that makes the signals when they are needed. `until` is the end of the run,
    s, or None if it ran to its proof. A run that ends before half a step has no steps;
    its `end` is `until` in ticks, rounded up.
    """
    left = outside_of(run, side=0)
    right = outside_of(run, side=1)
    forces = contact_forces(run, left)
    intervals = []  # times of forces, s [n, 3], by contact
    contacts = []
    for k, force in enumerate(forces):
        contact_times = run.force_intervals(k)
        intervals.append(contact_times)
        contacts.append(_tally(run, k, force, contact_times))
    t_end = until
    if t_end is None:
        t_end = float(run.times[-1])
    t_final = math.nan
    t_proved = math.nan
    proof = ""
    if run.proved >= 0:
        t_proved = float(run.times[run.proved])
        t_final = _last_contact_end(run, intervals, t_end)
        has_touched = any(tally.episodes for tally in contacts)
        proof = proof_sentence(has_touched, t_final)
    events = run.steps * len(run.row.links)  # as `max_events` counts them
    end = run.steps * STEP_TICKS  # ticks
    # A run to an end inside the first step does not take this step.
    if until is not None and run.steps == 0:
        end = math.ceil(until / run.clock.tick)
    # Whether waves jump and stay steep; needed for the coarser runs only
    is_steep = bool(run.coarser) and order_of(run.row) < 1
    coarser = []
    for share, coarser_run in run.coarser:
        make_coarser = partial(make_run, coarser_run, until)  # made when it is needed
        coarser.append(Coarser(share, is_steep, make_coarser))
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
        make_signals=lambda: _signals(run, forces, intervals, (left, right)),
    )


def _last_contact_end(run: GridRun, intervals: list[Floats], t_end: float) -> float:
    """Time at which the last contact ended in a proved run to `t_end`, s.

    It is 0 if no contact had a force, inf if a contact will have a force for ever, and
    nan if bodies still touch and may separate later, see `status.last_contact`.
    `intervals` are the times of `GridRun.force_intervals`, s [n, 3], of each contact.
    """
    # End of the last force of each contact that had one, and the opening after it
    ends = []
    for contact_times in intervals:
        if len(contact_times):
            _, force_end, opening = contact_times[-1].tolist()
            ends.append((force_end, opening))
    round_trip = 2 * run.clock.longest_rod * run.clock.tick  # s
    return last_contact(ends, t_end, round_trip)


# Status -------------------------------------------------------------------------------


def _status(run: GridRun, proof: str, t_end: float, events: int) -> str:
    """Sentences on why the run ended at `t_end`, s, on its mesh and its accuracy.

    `proof` is the sentence of its proof of finality, "" without a proof; `events` is
    the number of steps times links. Warnings of soil and of large strains follow.
    """
    cap = f"{events} steps times ends"  # stated if the cap on events ended the run
    end = format_si(t_end, "s")
    why = describe_end(run.stopped_by, proof, end, cap, run.row.system)
    status = with_advice(why)
    size = sum(run.mesh.counts)
    status += f" Time step {format_si(run.step, 's')}, {size} cells."
    if t_end and not run.steps:  # a run to t = 0 takes no step anyway
        status += (
            " The run ends before half a step, and none was taken. "
            "More cells shorten it."
        )
    status += _accuracy_sentence(run)
    status += _overshoot_sentence(run)
    status += quake_warning(run.row.system)
    return status + strain_warning(run.largest_strain)


def _overshoot_sentence(run: GridRun) -> str:
    """Warning of a peak force that depends on the mesh; "" if it does not.

    The peak force depends on the mesh if flat ends of damped rods or of rods with
    lateral inertia meet, or if waves overshoot by more than the larger one of
    `OVERSHOOT_TO_TELL` and `run.rtol`. The sentence begins with a space.
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
    """Stated errors of the outcome, and a remedy if they are too large.

    Unknown errors (inf) are left out; a run without estimates gives "". The remedy is
    added if an error is larger than `run.rtol` or inf. The errors of peak force and
    duration do not count here: they depend on few steps and on weak forces, and may
    stay large. The sentences begin with a space.
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

    `force` is its mean force in each step, N; `intervals` are the times of
    `GridRun.force_intervals`, s. The peak force of a bond or joint is its largest mean;
    its duration is 0, and its first and last time are nan, as for a contact without a
    force. An impact of rigid bodies has no peak force (nan), and each of its forces
    that lasts at most one step has the duration 0.
    """
    law = run.row.system.contacts[k]
    begins, ends = run.force_spans(intervals)
    if law.opens:
        peak = largest_force(force)
    else:
        peak = float(np.max(force, initial=0.0))
    is_impact = law.law == "rigid" and law.restitution is not None
    if is_impact:
        peak = math.nan
        # STEP_RTOL allows for the round-off of a duration of one step.
        is_instant = ends - begins <= run.step * (1 + STEP_RTOL)
        ends = np.where(is_instant, begins, ends)  # the duration becomes 0
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

    Forces, closing velocities, and forces and powers of soil are means over steps; gaps
    and velocities of masses are straight lines between the ends of steps. The motion
    has the states that were kept, with the forces on pieces. `forces`,
    N [contact][step], and `intervals`, s, are those of the contacts; `outside` are the
    actions on the left and right end, see `forces.outside_of`.
    """
    row = run.row
    edges = run.edges
    contacts = []
    for k, force in enumerate(forces):
        link = row.contact_link[k]
        gap = np.zeros(run.steps + 1)  # a bond has none
        closing = np.zeros(run.steps)
        if k in row.unbonded_links:  # a contact or a joint
            _, gap = run.contact(k)
            closing = run.recorded(link, "closing")
        signal = ContactSignal(
            force=over_steps(run, force),
            gap=Pieces.through(edges, gap),
            closing=over_steps(run, closing),
            episodes=episodes_from_intervals(intervals[k]),
        )
        contacts.append(signal)
    masses = {}
    for body, mass in enumerate(row.mass_of):
        if mass >= 0:  # a rigid mass, not a rod or a wall
            masses[body] = Pieces.through(edges, run.mass_velocity(mass))
    motion = run.motion()._replace(pushes=_pushes_on_nodes(run, forces, outside))
    shafts = {}
    for shaft, body in enumerate(shaft_bodies(row)):
        push = over_steps(run, run.recorded_soil(shaft, "force"))
        power = over_steps(run, run.recorded_soil(shaft, "power"))
        shafts[body] = ShaftAction(push, power)
    return Signals(
        motion=motion,
        contacts=tuple(contacts),
        boundary_actions=outside,
        edges=edges,
        masses=masses,
        shafts=shafts,
    )


def _pushes_on_nodes(
    run: GridRun, forces: list[Floats], outside: Any
) -> dict[int, Floats]:
    """Forces on nodes from outside their piece, to the right, N [step], by node.

    An entry is the mean over a step. They are the forces of contacts and joints on
    their left and right nodes, and the pushes of `outside` on both ends of the row;
    None is a free end. Nodes without such a force are left out. `forces`,
    N [contact][step], are those of all contacts. Forces in bonds are ignored, as a bond
    is inside a piece.
    """
    mesh = run.mesh
    pushes: dict[int, Floats] = {}
    for k, force in enumerate(forces):
        link = run.row.contact_link[k]
        if link in mesh.link_nodes:  # a contact or a joint, not a bond
            left, right = mesh.link_nodes[link]
            pushes[left] = pushes.get(left, 0.0) - force
            pushes[right] = pushes.get(right, 0.0) + force
    for side, end in enumerate(outside):
        if end is not None:
            node = mesh.ends[side]
            pushes[node] = pushes.get(node, 0.0) + INWARD[side] * end.push.values
    return pushes
