"""Why a run ended, and how accurate it is: sentences with the remedy."""

from __future__ import annotations

from ..model import System, Wall
from ..units import format_si
from .abilities import driven

LARGE_STRAIN = 0.01  # from which the linear theory is doubtful


def end_sentence(system: System, stopped_by: str, final: str, end: str, cap: str) -> str:
    """Why a run ended, with what its proof says, if it has one."""
    ends = ((0, 0), (len(system.bodies) - 1, -1))
    walls = [system.contacts[k] for i, k in ends if isinstance(system.bodies[i], Wall)]
    held = len(walls) == 2 or not all(law.opens for law in walls)
    acting = driven(system) and ("gravity acts" if system.gravity else "an end is driven")
    return ending(stopped_by, final, end, cap, acting or "", held)


def ending(stopped_by: str, final: str, end: str, cap: str, acting: str, held: bool) -> str:
    """Why a run ended: `acting` says what drives the row, `held` that walls hold it in."""
    if stopped_by == "final":
        return final
    if stopped_by == "until" and final != "":
        return f"Stopped at the time asked for. {final}"
    if stopped_by == "until":
        way = "leave out until= to run to the proof"
        if acting != "":
            way = f"while {acting}, no contact is known to be the last"
        elif held:
            way = "a row between walls, or joined to one, may never come to an end"
        asked = f"Stopped at the time asked for, {end}, before the collision was final"
        return f"{asked}; {way}."
    if final != "":
        return (
            f"{final} The cap of {cap} ended the run at {end}; raise max_events to see more of the "
            "vibration."
        )
    return (
        f"Stopped by the cap of {cap} at {end}, before the collision was final. Raise max_events, "
        "or give until= to set another end."
    )


def proof_sentence(met: bool, at_the_end: bool, proof: float) -> str:
    """What the proof of finality says, that was found at a time, s, at the end or before."""
    if not met:
        return "No collision happens, now or later."
    after = "" if at_the_end else f" after {format_si(proof, 's')}"
    return f"The collision is final: no new impact can happen{after}."


def strain_warning(strain: float) -> str:
    """A warning of strains that are not small."""
    if strain <= LARGE_STRAIN:
        return ""
    return (
        f" Strains reach up to {strain:.2g}, where the linear theory of small strains "
        "(about 1 %) does not hold; check units and velocities."
    )
