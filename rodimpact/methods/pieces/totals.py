"""What a run comes to, from its records; the page has this as JavaScript."""

import math
from typing import Any

from ...units import format_si
from ..link import Law
from ..run import ContactTally
from ..states import Status, Stop
from ..status import ending, last_contact, proof_sentence

MORE = 10.0  # times rtol, from which it is said that it was not reached


def tally_of(it: Any, tick: float, now: int) -> ContactTally:
    """Totals of the contact that a link is, in SI units, in a run that has come to a tick."""
    sudden, met = it.law == Law.IMPACT, it.first >= 0
    last = now if it.touch == Status.PRESS and not sudden else it.last
    return ContactTally(
        it.impulse,
        math.nan if sudden else it.peak,
        it.pressed * tick,
        it.first * tick if met else math.nan,
        last * tick if met else math.nan,
        it.episodes,
    )


def last_of(run: Any, link: Any, end: float, round_trip: float) -> float:
    """When the last contact ended, s, as of `last_contact`; nan without a proof."""
    ends, tick = [], run.tick
    for it in link:
        if it.law >= Law.RIGID and it.episodes > 0:
            struck = it.law == Law.IMPACT and it.status == Status.OPEN
            pressing = it.touch == Status.PRESS and not struck
            apart = it.apart if it.touch == Status.OPEN or struck else -1
            ends.append(
                (
                    math.nan if pressing else it.last * tick,
                    apart * tick if apart >= 0 else math.nan,
                )
            )
    return last_contact(ends, end, round_trip) if run.proved >= 0 else math.nan


def why_stopped(run: Any, asked: bool) -> str:
    """Why a run ended, in one word; `asked` says whether for an end."""
    if run.stop == Stop.CAP:
        return "max_events"
    if asked:
        return "until"
    return "final" if run.proved >= 0 else "clock"


def status_of(
    run: Any, link: Any, system: Any, stopped_by: str, end: float, t_final: float
) -> str:
    """Why a run ended.

    Parameters
    ----------
    run : RUN
    link : list of LINK
    system : System
    stopped_by : str
    end, t_final : float
        End of the run, and of the last contact, as of `last_of`, s.
    """
    met = any(it.episodes > 0 for it in link)
    proof = proof_sentence(met, t_final) if run.proved >= 0 else ""
    return ending(
        stopped_by, proof, format_si(end, "s"), f"{run.steps} steps of nodes", system
    )


def stated(worst: float, goal: float) -> str:
    """What is told of the largest stated error, where `goal` was asked for."""
    late = (
        f" That is more than rtol = {goal:.6g} asks for." if worst > MORE * goal else ""
    )
    return f" Stated relative error: {worst:.1g}.{late}"


def told_of(run: Any) -> str:
    """What is told of breaks too dense to follow, and of rigid bodies that rest."""
    told = ""
    if run.rough:
        told += (
            f" From {format_si(run.first_rough * run.tick, 's')} on, waves jump more than "
            f"{run.shortest // run.floor} times in the shortest transit time. Such waves are "
            "smoothed, which keeps their momentum."
        )
    if run.rested:
        told += (
            " Rigid bodies that parted very slowly were set at rest against each other."
        )
    return told


def why_stuck(row: Any, node: Any, seconds: float) -> tuple[str, str]:
    """What to refuse where no forces in the links of a node satisfy their laws: path, sentence."""
    time = format_si(seconds, "s")
    if node.links > 1 and node.mobility[0] == 0 and node.mobility[1] == 0:
        return (
            "contacts",
            f"two walls squeeze a rigid mass at {time}; give one of its contacts a compliant law",
        )
    path = "contacts"
    for k, link in enumerate(row.contact_link):
        if node.first <= link < node.first + node.links:
            path = f"contacts.{k}"
    return (
        path,
        f"no force satisfies the law at {time}; its numbers may be out of range: give others",
    )
