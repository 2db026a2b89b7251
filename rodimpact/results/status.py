"""Why a run ended, and how accurate it is: sentences with the remedy."""

from __future__ import annotations

import math

import numpy as np

from ..methods.abilities import driven
from ..methods.contact_law_kernel import RIGID
from ..methods.fronts.front_kernel import PRESS
from ..methods.fronts.method import FrontRun
from ..methods.grid.method import RINGING, GridRun
from ..model import Bonded, System, Wall
from ..units import format_si
from .stepped import Run

LARGE_STRAIN = 0.01  # from which the linear theory is doubtful
LARGE_CHANGE = 1e-2  # of the largest force, from which it is said
ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest


def describe(run: FrontRun) -> str:
    """Of a run of the method "fronts"."""
    a = run.assembly
    end, proof = format_si(run.end * a.tick, "s"), format_si(run.settled * a.tick, "s")
    final = "" if run.settled < 0 else _pressing(run) or _final(
        any(run.tally.episodes), run.stopped_by == "until" and run.settled >= run.end, proof
    )
    if run.stopped_by == "max_events" and not final:
        said = (
            f"Stopped by the cap of {run.events} events at {end}; fronts multiply where transit "
            "times have no common measure. Raise max_events, or make lengths commensurate."
        )
    elif run.stopped_by == "clock":
        said = (
            f"Stopped by the clock after {end}: a contact may close later than it can count, if "
            "ever. Give until= to set another end."
        )
    else:
        said = _ended(a.system, run.stopped_by, final, end, f"{run.events} events")
    if a.transit_error > 2.0**-36:
        said += (
            f" The transit time of {a.worst} was rounded by {a.transit_error:.2g} of itself to "
            "fit the clock."
        )
    return said + _large(float(np.abs(run.log.value).max()) / min(a.wave_speed[1:-1]))


def describe_steps(run: Run, until: float | None = None) -> str:
    """Of a run on a time step."""
    times = run.edges * run.clockwork.tick
    end = format_si(float(times[-1]) if until is None else until, "s")
    final = "" if run.settled < 0 else _final(
        any(run.tally.episodes), run.stopped_by == "until" and run.settled >= run.steps,
        format_si(float(times[run.settled]), "s"),
    )
    cap = f"{run.events} steps times ends"
    said = _ended(run.plan.system, run.stopped_by, final, end, cap)
    said += f" Time step {format_si(run.step, 's')}"
    if isinstance(run, GridRun):
        said += f", {sum(run.mesh.counts)} cells"
    said += "."
    if until and not run.steps:
        said += " The end comes before half a step: none was taken. More cells shorten it."
    if run.estimates and any(i >= 0 and run.plan.laws[i] >= RIGID for i in run.plan.contact_link):
        said += _accuracy(run)
    if isinstance(run, GridRun):
        said += _own_peak(run)
    return said + _large(run.largest_strain)


def _ended(system: System, stopped_by: str, final: str, end: str, cap: str) -> str:
    """Why a run ended, with what its proof says, if it has one."""
    if stopped_by == "final":
        return final
    if stopped_by == "until" and final:
        return f"Stopped at the time asked for. {final}"
    if stopped_by == "until":
        asked = f"Stopped at the time asked for, {end}, before the collision was final"
        return f"{asked}; {_way_to_the_proof(system)}."
    if final:
        return (
            f"{final} The cap of {cap} ended the run at {end}; raise max_events to see more of the "
            "vibration."
        )
    return (
        f"Stopped by the cap of {cap} at {end}, before the collision was final. Raise max_events, "
        "or give until= to set another end."
    )


def _way_to_the_proof(system: System) -> str:
    ends = ((0, 0), (len(system.bodies) - 1, -1))
    walls = [system.contacts[k] for i, k in ends if isinstance(system.bodies[i], Wall)]
    if driven(system):
        what = "gravity acts" if system.gravity else "an end is driven"
        return f"while {what}, no contact is known to be the last"
    if len(walls) == 2 or any(isinstance(law, Bonded) for law in walls):
        return "a row between walls, or bonded to one, may never come to an end"
    return "leave out until= to run to the proof"


def _final(met: bool, at_the_end: bool, proof: str) -> str:
    """What the proof of finality says."""
    if not met:
        return "No collision happens, now or later."
    after = "" if at_the_end else f" after {proof}"
    return f"The collision is final: no new impact can happen{after}."


def _pressing(run: FrontRun) -> str:
    """What is said where contacts go on pressing for ever."""
    row = run.row
    found = ", ".join(
        str(i) for i, node in enumerate(run.assembly.nodes)
        if row.status[node] == PRESS and row.force[node] > ROUND_OFF * run.tally.peak[node]
    )
    return f"Nothing changes any more; contact {found} goes on pressing." if found else ""


def _accuracy(run: Run) -> str:
    """How wrong the outcome may be."""
    late = {name: value for name, value in run.estimates.items() if value > run.rtol}
    if not late:
        worst = max(run.estimates.values())
        return f" Comparing steps, the outcome is wrong by {worst:.1g} of itself at most."
    finer = "more cells" if isinstance(run, GridRun) else "a smaller dt"
    which = ", ".join(f"{name} to {value:.1g}" for name, value in late.items() if value < math.inf)
    return (
        f" Not converged to {run.rtol:g}: {which or 'too long a run to divide the step'}; "
        f"a larger rtol is soon reached, {finer} goes on."
    )


def _own_peak(run: GridRun) -> str:
    """A warning of a largest force that is not that of the bodies."""
    reasons, large = [], max(run.rtol, LARGE_CHANGE)
    if run.peak_change > large:
        reasons.append(f"refining changed it by {run.peak_change:.1g}")
    if run.overshoot > large:
        reasons.append(
            f"beside jumps waves overshoot, and over {RINGING} steps it is less by "
            f"{run.overshoot:.1g} of itself"
        )
    return f" The largest force is that of this mesh: {'; '.join(reasons)}." if reasons else ""


def _large(strain: float) -> str:
    """A warning of strains that are not small."""
    if strain <= LARGE_STRAIN:
        return ""
    return (
        f" Strains reach up to {strain:.2g}, where the linear theory of small strains "
        "(about 1 %) does not hold; check units and velocities."
    )
