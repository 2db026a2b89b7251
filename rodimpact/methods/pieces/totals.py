"""Totals and status of a run, from its records.

The web page has these functions as JavaScript.
"""

import math
from typing import Any

from ...units import format_si
from ..link import Law
from ..run import ContactTally
from ..states import Status, Stop
from ..status import RunEnd, describe_end, last_contact, proof_sentence

MISSED_GOAL_FACTOR = 10.0
"""Stated error over rtol, above which the status says that rtol was not reached."""


def tally_of(link: Any, tick: float, now: int) -> ContactTally:
    """Totals of a contact, in SI units, from its link, in a run up to tick `now`.

    `tick` is the duration of a tick, s. The peak force of an impact contact is nan.
    Without any force the times of the first and the last force are nan. If a force
    still acts, the last time is that of `now`.
    """
    is_impact = link.law == Law.IMPACT
    if is_impact:
        peak = math.nan
    else:
        peak = link.peak_force
    still_acts = link.logged_status == Status.PRESS and not is_impact
    if link.first_force_tick < 0:  # there was no force
        first = math.nan
        last = math.nan
    else:
        first = link.first_force_tick * tick
        if still_acts:
            last = now * tick
        else:
            last = link.last_force_tick * tick
    return ContactTally(
        link.impulse, peak, link.force_ticks * tick, first, last, link.episodes
    )


def last_of(run: Any, links: Any, end: float, round_trip: float) -> float:
    """Time of the end of the last contact in a run, s; nan without a proof.

    `status.last_contact` computes it from two times of each contact that has pressed:
    the end of its force, nan while a force acts, and its last opening, nan while it is
    closed. The result is 0 if no contact has pressed, and inf if one presses for ever.
    `end` is the end of the run, s, and `round_trip` the longest time in which a wave
    goes through a body and back, s.
    """
    if run.proved_tick < 0:
        return math.nan
    contact_ends = []  # pairs: end of the force, last opening
    for link in links:
        can_open = link.law >= Law.RIGID
        if can_open and link.episodes > 0:
            # The force of an impact is over at once, although the last logged status is
            # PRESS: if the contact is open now, its bodies have parted.
            has_parted = link.law == Law.IMPACT and link.status == Status.OPEN
            if link.logged_status == Status.PRESS and not has_parted:
                force_end = math.nan
            else:
                force_end = link.last_force_tick * run.tick_duration
            is_open = link.logged_status == Status.OPEN or has_parted
            if is_open and link.last_opening_tick >= 0:
                opening = link.last_opening_tick * run.tick_duration
            else:
                opening = math.nan
            contact_ends.append((force_end, opening))
    return last_contact(contact_ends, end, round_trip)


def why_stopped(run: Any, has_given_end: bool) -> str:
    """The reason why a run ended: "max_events", "until", "final" or "clock".

    These are the cap on steps, the given end, the proof of finality, and the end of the
    clock. If several apply, the first one in this order is returned.
    """
    if run.stop_reason == Stop.CAP:
        return "max_events"
    if has_given_end:
        # Only the cap ends such a run before its given end; a proof does not.
        return "until"
    if run.proved_tick >= 0:
        return "final"
    return "clock"


def end_of_run(
    run: Any, links: Any, system: Any, stopped_by: str, end: float, t_final: float
) -> RunEnd:
    """Why a run ended, in sentences, with its proof if there was one.

    The end of the clock has its own sentence; `describe_end` has the others.

    Parameters
    ----------
    run : RUN
    links : list of LINK
    system : System
    stopped_by : str
        Result of `why_stopped`.
    end : float
        End of the run, s.
    t_final : float
        End of the last contact, s, the result of `last_of`.
    """
    proof = ""
    if run.proved_tick >= 0:
        has_contact = any(link.episodes > 0 for link in links)
        proof = proof_sentence(has_contact, t_final)
    end_time = format_si(end, "s")
    if stopped_by == "clock":  # there is no proof, see `why_stopped`
        return RunEnd(
            f"Stopped at the end of the clock, {end_time}, before the collision was "
            "final.",
            "Give until= to set another end.",
        )
    work = f"{run.steps} steps of nodes"
    return describe_end(stopped_by, proof, end_time, work, system)


def accuracy_sentence(worst: float, goal: float) -> str:
    """Sentence of the status on the largest stated error, `worst`.

    If it is more than MISSED_GOAL_FACTOR times the goal, rtol, a second sentence says
    that it is more than rtol.
    """
    text = f" Stated relative error: {worst:.1g}."
    if worst > MISSED_GOAL_FACTOR * goal:
        text += f" That is more than rtol = {goal:.6g} asks for."
    return text


def simplifications_text(run: Any) -> str:
    """Sentences of the status on simplifications in a run; empty if there are none.

    The first one is about waves that were smoothed, as their jumps were too dense, the
    second one about rigid bodies that were set at rest after an impact. Each sentence
    begins with a space, as the text is appended to others.
    """
    text = ""
    if run.averaged_steps:
        start = format_si(run.first_averaged_tick * run.tick_duration, "s")
        # The quotient below is the number of averaging pieces in the shortest transit,
        # rounded down. Waves are smoothed only where one of them has more jumps.
        text += (
            f" From {start} on, waves jump more than "
            f"{run.shortest_transit // run.min_break_spacing} times in the shortest "
            "transit time. Such waves are smoothed, which keeps their momentum."
        )
    if run.resting_impacts:
        text += (
            " Rigid bodies that parted very slowly were set at rest against each other."
        )
    return text


def why_stuck(row: Any, node: Any, seconds: float) -> tuple[str, str]:
    """Path and sentence of the error if a node has no solution at a time, s.

    No forces satisfy the laws of its links. If its masses are between two ends without
    a rod, the sentence says that walls squeeze a mass, and the path is "contacts".
    Otherwise it says that numbers may be out of range, and the path is that of the last
    contact in the node, or "contacts" if it has none.
    """
    time = format_si(seconds, "s")
    # `mobility` is 0 on a side without a rod. Only between two walls can rigid masses
    # have no solution.
    if node.link_count > 1 and node.mobility[0] == 0 and node.mobility[1] == 0:
        return (
            "contacts",
            f"two walls squeeze a rigid mass at {time}; give one of its contacts a "
            "compliant law",
        )
    path = "contacts"
    for k, link in enumerate(row.contact_link):
        if node.first_link <= link < node.first_link + node.link_count:
            path = f"contacts.{k}"
    return (
        path,
        f"no force satisfies the law at {time}; its numbers may be out of range: give "
        "others",
    )
