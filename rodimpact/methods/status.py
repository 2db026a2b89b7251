"""Why a run ended, and how accurate it is: sentences with the remedy."""

import math
from collections.abc import Sequence
from typing import Any

from ..units import format_si
from .abilities import has_external_drive

LARGE_STRAIN = 0.01
"""Strain from which the linear theory of small strains is doubtful: squares count a percent."""
ROUNDED = 2.0**-36
"""Relative change of a transit time by rounding from which a status states it."""


def is_held(system: Any) -> bool:
    """Whether walls hold a row in: one at both ends, or one that is joined to it."""
    last = len(system.bodies) - 1
    wall_count = 0
    is_joined = False
    for body, contact in ((0, 0), (last, last - 1)):
        if system.bodies[body].kind == "wall":
            wall_count += 1
            if not system.contacts[contact].opens:
                is_joined = True
    return wall_count == 2 or is_joined


def ending(stopped_by: str, final: str, end: str, cap: str, system: Any) -> str:
    """Why a run ended, with the remedy; the page has this as JavaScript."""
    if stopped_by == "final":
        return final
    if stopped_by == "until" and final != "":
        return f"Stopped at the time asked for. {final}"
    if stopped_by == "until":
        way = "leave out until= to run to the proof"
        if has_external_drive(system):
            acting = "an end is driven"
            if system.gravity != 0:
                acting = "gravity acts"
            way = f"while {acting}, no contact is known to be the last"
        elif is_held(system):
            way = "a row between walls, or joined to one, may never come to an end"
        stopped = (
            f"Stopped at the time asked for, {end}, before the collision was final"
        )
        return f"{stopped}; {way}."
    if final != "":
        return (
            f"{final} The cap of {cap} ended the run at {end}; raise max_events to see more of the "
            "vibration."
        )
    return (
        f"Stopped by the cap of {cap} at {end}, before the collision was final. Raise max_events, "
        "or give until= to set another end."
    )


def last_contact(
    ends: Sequence[Sequence[float]], t_end: float, round_trip: float
) -> float:
    """When the last contact ended, s, in a run that is proved final.

    Bodies that touch without force part as soon as a wave that pulls arrives. If none has come in a
    round trip of the longest body, none will: they rest against each other, and the end of the
    force counts.

    Parameters
    ----------
    ends : list of (float, float)
        Of each contact that pressed, when its last force ended and when its gap opened then, s; nan
        for what has not come before the end of the run.
    t_end, round_trip : float
        End of the run, and how long waves take to the far end of the longest body and back, s.

    Returns
    -------
    float
        0 if no contact pressed; inf if one goes on pressing for ever; nan if bodies still touch at
        the end of the run and may part later.
    """
    latest = 0.0
    for force_end, opening in ends:
        if force_end != force_end:
            latest = math.inf
        elif opening == opening:
            latest = max(latest, opening)
        elif t_end - force_end >= round_trip * (1 - 1e-9):
            latest = max(latest, force_end)
        else:
            return math.nan
    return latest


def proof_sentence(met: bool, t_final: float) -> str:
    """What the proof of finality says; `t_final`, s, as of `last_contact`."""
    if not met:
        return "No collision happens, now or later."
    if t_final != t_final:
        reason = "no new impact can happen. Bodies still touch at the end of the run"
    elif t_final == math.inf:
        reason = "bodies stay in contact"
    else:
        reason = f"the last contact ended at {format_si(t_final, 's')}"
    return f"The collision is final: {reason}."


def rounding(error: float, path: str) -> str:
    """What is told of transit times that the clock has changed by so much of themselves."""
    if error <= ROUNDED:
        return ""
    return f" The clock rounds the transit time of {path}: relative change {error:.2g}."


def strain_warning(strain: float) -> str:
    """A warning of strains that are not small."""
    if strain <= LARGE_STRAIN:
        return ""
    return (
        f" Strains reach up to {strain:.2g}, where the linear theory of small strains "
        "(about 1 %) does not hold; check units and velocities."
    )
