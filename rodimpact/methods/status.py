"""Sentences on why a run ended, with the remedy, and on its accuracy."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from ..units import format_si
from .abilities import has_external_drive

LARGE_STRAIN = 0.01
"""Strain above which linear theory is doubtful: quadratic terms reach a percent."""
LARGE_QUAKE = 0.1
"""Quake above which its unit is probably wrong, m: quakes of soil are millimetres."""
ROUNDED = 2.0**-36
"""Relative change of a transit time by rounding above which a status states it."""
ROUND_TRIP_RTOL = 1e-9
"""Relative round-off of the time from the last force to the end of a run."""


class RunEnd(NamedTuple):
    """Why a run ended, in sentences."""

    statement: str  # why it ended
    advice: str  # the argument of Python that changes it; "" if there is none


def is_held(system: Any) -> bool:
    """Whether walls hold a row, so that the bodies cannot all part.

    It is so if there are walls at both ends, or if the contact of a wall cannot open.
    """
    has_left_wall: bool = system.bodies[0].kind == "wall"
    has_right_wall: bool = system.bodies[-1].kind == "wall"
    is_between_walls = has_left_wall and has_right_wall
    is_joined_left: bool = has_left_wall and not system.contacts[0].opens
    is_joined_right: bool = has_right_wall and not system.contacts[-1].opens
    return is_between_walls or is_joined_left or is_joined_right


def describe_end(
    stopped_by: str, final: str, end: str, cap: str, system: Any
) -> RunEnd:
    """Why a run ended, as a statement and advice.

    The advice names the argument that lets the run go on, to the proof or past the cap;
    it is "" if there is no such argument. The web page has this function as JavaScript.

    Parameters
    ----------
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    final : str
        Sentence of the proof that the collision is final; "" without a proof.
    end, cap : str
        End of the run and cap of its work, each with its unit, such as "10 events".
    system : System
        It determines why a run to a given end is not proved final.
    """
    if stopped_by == "final":
        return RunEnd(final, "")
    if stopped_by == "until" and final != "":
        return RunEnd(f"Stopped at the time asked for. {final}", "")
    if stopped_by == "until":
        statement = (
            f"Stopped at the time asked for, {end}, before the collision was final"
        )
        if has_external_drive(system):
            if system.gravity != 0:
                acting = "gravity acts"
            elif system.has_shaft:  # soil or drag along a rod
                acting = "soil or drag acts"
            else:
                acting = "an end is driven"
            reason = f"while {acting}, no contact is known to be the last"
            return RunEnd(f"{statement}; {reason}.", "")
        if is_held(system):
            reason = "a row between walls, or joined to one, may never come to an end"
            return RunEnd(f"{statement}; {reason}.", "")
        return RunEnd(f"{statement}.", "Leave out until= to run to the proof.")
    # The remaining case is "max_events".
    if final != "":
        return RunEnd(
            f"{final} The cap of {cap} ended the run at {end}.",
            "Raise max_events to see more of the vibration.",
        )
    return RunEnd(
        f"Stopped by the cap of {cap} at {end}, before the collision was final.",
        "Raise max_events, or give until= to set another end.",
    )


def with_advice(end: RunEnd) -> str:
    """Statement and advice, if there is any, joined by a space."""
    if end.advice == "":
        return end.statement
    return f"{end.statement} {end.advice}"


def last_contact(
    ends: Sequence[Sequence[float]], t_end: float, round_trip: float
) -> float:
    """Time at which the last contact ended, s, in a run that is proved final.

    A contact ends when its gap opens. Bodies that touch without force part as soon as a
    tensile wave arrives. If none has arrived within a round trip of the longest body,
    none will: the bodies rest against each other, and their contact ends with the
    force.

    Parameters
    ----------
    ends : list of (float, float)
        For each contact that pressed, the time at which its last force ended, and the
        time at which its gap opened afterwards, s; nan if this has not happened.
    t_end, round_trip : float
        End of the run, and the time of a wave through the longest body and back, s.

    Returns
    -------
    float
        The latest of these ends; 0 if no contact pressed. nan if bodies still touch
        without force at the end of the run and may part later. Otherwise inf if a
        contact goes on pressing.
    """
    latest = 0.0
    for force_end, opening in ends:
        # Only nan differs from itself; the web page needs no function for this test.
        if force_end != force_end:  # nan: the contact still presses
            latest = math.inf
        elif opening == opening:  # not nan: the gap has opened
            latest = max(latest, opening)
        elif t_end - force_end >= round_trip * (1 - ROUND_TRIP_RTOL):
            # The bodies still touch, but no wave has parted them in a round trip.
            latest = max(latest, force_end)
        else:  # a wave may still part the bodies
            return math.nan
    return latest


def proof_sentence(has_pressed: bool, t_final: float) -> str:
    """Sentence on the result of the proof of finality.

    `has_pressed` says whether any contact pressed; if none did, nothing else matters.
    `t_final`, s, is the result of `last_contact`: nan if bodies may part later, inf if
    they stay in contact.
    """
    if not has_pressed:
        return "No collision happens, now or later."
    if t_final != t_final:  # nan
        reason = "no new impact can happen. Bodies still touch at the end of the run"
    elif t_final == math.inf:
        reason = "bodies stay in contact"
    else:
        reason = f"the last contact ended at {format_si(t_final, 's')}"
    return f"The collision is final: {reason}."


def rounding_sentence(error: float, path: str) -> str:
    """Sentence on the rounding of transit times by the clock; "" up to `ROUNDED`.

    `error` is the largest relative change of a transit time, and `path` the path of its
    segment in the model. The sentence begins with a space.
    """
    if error <= ROUNDED:
        return ""
    return f" The clock rounds the transit time of {path}: relative change {error:.2g}."


def strain_warning(strain: float) -> str:
    """Sentence that warns of a strain above `LARGE_STRAIN`; "" if it is smaller.

    `strain` is the largest strain, or a bound of it. The sentence begins with a space.
    """
    if strain <= LARGE_STRAIN:
        return ""
    return (
        f" Strains may reach up to {strain:.2g}, where the linear theory of small "
        "strains (about 1 %) does not hold; check units and velocities."
    )


def quake_warning(system: Any) -> str:
    """Sentence that warns of the first quake above `LARGE_QUAKE`; "" if there is none.

    A quake is the overlap or displacement at which soil yields, m. Soil along the rods
    is checked first, then soil at contacts. The sentence begins with a space.
    """
    quakes = []  # (path, quake in m); a quake of 0 if there is no soil
    for i, body in enumerate(system.bodies):
        shaft = getattr(body, "shaft", None)
        quakes.append((f"bodies.{i}.shaft.quake", getattr(shaft, "quake", 0.0)))
    for k, law in enumerate(system.contacts):
        quakes.append((f"contacts.{k}.quake", getattr(law, "quake", 0.0)))
    for path, quake in quakes:
        if quake > LARGE_QUAKE:
            return (
                f" {path} is {format_si(quake, 'm')}: quakes of soil are a few "
                "millimetres; check its unit."
            )
    return ""
