"""From a run on a grid to what every method hands back: signals, tallies, and a status."""

import math
from functools import partial
from typing import Any

import numpy as np

from ...units import format_si
from ..run import INWARD, Coarser, ContactSignal, ContactTally, Run, Signals
from ..signals import Floats, Pieces
from ..status import ending, last_contact, proof_sentence, strain_warning
from .forces import contact_forces, outside_of, over_steps
from .measures import episodes_from_intervals, largest_force
from .mesh import STEP_TICKS
from .refinement import ROUGH
from .run import OVERSHOOT_STEPS, GridRun
from .smoothness import order_of

LARGE_CHANGE = 1e-2  # of the peak force, from which it is said


def hand_over(run: GridRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`, s."""
    outside = outside_of(run, 0), outside_of(run, 1)
    size = sum(run.mesh.counts)
    forces = contact_forces(run, outside[0])
    pressed = [run.pressed(k) for k in range(len(forces))]
    contacts = tuple(
        _tally(run, k, *of) for k, of in enumerate(zip(forces, pressed, strict=True))
    )
    final, t_final = run.proved >= 0, math.nan
    t_end = until if until is not None else float(run.times[-1])
    t_proved = float(run.times[run.proved]) if final else math.nan
    if final:
        ends = [last[1:] for of in pressed for last in of[-1:].tolist()]
        t_final = last_contact(ends, t_end, 2 * run.clock.longest * run.clock.tick)
    proof = proof_sentence(any(x.episodes for x in contacts), t_final) if final else ""
    events = run.steps * len(run.row.links)
    status = ending(
        run.stopped_by,
        proof,
        format_si(t_end, "s"),
        f"{events} steps times ends",
        run.row.system,
    )
    status += f" Time step {format_si(run.step, 's')}, {size} cells."
    end = run.steps * STEP_TICKS
    if until and not run.steps:
        status += " The run ends before half a step, and none was taken. More cells shorten it."
        end = math.ceil(until / run.clock.tick)
    status += _accuracy(run) + _own_peak(run) + strain_warning(run.largest_strain)
    steep = bool(run.coarser) and order_of(run.row) < 1
    coarser = []
    for share, other in run.coarser:
        coarser.append(Coarser(share, steep, partial(hand_over, other, until)))
    return Run(
        method="finite-difference",
        until=until,
        clock=run.clock,
        end=end,
        t_end=t_end,
        t_final=t_final,
        t_proved=t_proved,
        stopped_by=run.stopped_by,
        status=status,
        events=events,
        contacts=contacts,
        accuracy=run.estimates,
        coarser=tuple(coarser),
        make_signals=lambda: _signals(run, forces, pressed, outside),
    )


def _own_peak(run: GridRun) -> str:
    """A warning of a peak force that is not that of the bodies."""
    reason = ""
    if run.peak_error == math.inf:
        reason = "flat ends meet, and a finer mesh finds a larger force"
    elif run.overshoot > max(run.rtol, LARGE_CHANGE):
        reason = (
            f"waves overshoot beside jumps, and the mean over {OVERSHOOT_STEPS} steps is lower by "
            f"{100 * run.overshoot:.1g} %"
        )
    return f" The peak force is that of this mesh: {reason}." if reason else ""


def _accuracy(run: GridRun) -> str:
    """How wrong the outcome may be, and what makes it less.

    Durations may stay rough: they hang on where faint forces begin and end.
    """
    if not run.estimates:
        return ""
    errors = ", ".join(
        f"{name} {error:.1g}"
        for name, error in run.estimates.items()
        if error < math.inf
    )
    told = f" Stated relative error: {errors}." if errors else ""
    if any(
        error > run.rtol for name, error in run.estimates.items() if name not in ROUGH
    ):
        told += (
            f" Not converged to {run.rtol:g}. Take a larger rtol, or give more cells."
        )
    return told


def _tally(run: GridRun, k: int, force: Floats, pressed: Floats) -> ContactTally:
    """Totals of contact k in SI units."""
    law, (begins, ends) = run.row.system.contacts[k], run.spans(pressed)
    peak = largest_force(force) if law.opens else float(np.max(force, initial=0.0))
    if (
        getattr(law, "restitution", None) is not None
    ):  # takes no time, though it takes a step here
        peak, ends = (
            math.nan,
            np.where(ends - begins <= run.step * (1 + 1e-9), begins, ends),
        )
    first, last = (float(t[0]) if len(t) else math.nan for t in (begins, ends[::-1]))
    return ContactTally(
        float(force.sum() * run.step),
        peak,
        float((ends - begins).sum()),
        first,
        last,
        len(episodes_from_intervals(pressed)),
    )


def _signals(
    run: GridRun, forces: list[Floats], pressed: list[Floats], outside: Any
) -> Signals:
    row, mesh, edges, contacts = run.row, run.mesh, run.edges, []
    pushes: dict[int, Floats] = {}  # by node
    for k, (force, link) in enumerate(zip(forces, row.contact_link, strict=True)):
        gap, closing = np.zeros(run.steps + 1), np.zeros(run.steps)
        if k in row.by_law:
            gap, closing = run.contact(k)[1], run.recorded(link, "closing")
        contacts.append(
            ContactSignal(
                over_steps(run, force),
                Pieces.through(edges, gap),
                over_steps(run, closing),
                episodes_from_intervals(pressed[k]),
            )
        )
        for node, sign in zip(mesh.touching.get(link, ()), INWARD[::-1], strict=False):
            pushes[node] = pushes.get(node, 0.0) + sign * force
    for node, sign, end in zip(mesh.ends, INWARD, outside, strict=True):
        if end is not None:
            pushes[node] = pushes.get(node, 0.0) + sign * end.push.values
    masses = {
        body: Pieces.through(edges, run.mass_velocity(m))
        for body, m in enumerate(row.mass_of)
        if m >= 0
    }
    return Signals(
        run.motion()._replace(pushes=pushes), tuple(contacts), outside, edges, masses
    )
