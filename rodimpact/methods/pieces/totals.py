"""Totals and status of a run, from its records; the page has this as JavaScript."""

import math
from typing import Any

from ...units import format_si
from ..link import Law
from ..run import ContactTally
from ..states import Status, Stop
from ..status import RunEnd, describe_end, last_contact, proof_sentence

MISSED_GOAL_FACTOR = 10.0
"""Stated error over rtol above which the status says that rtol was not reached."""


def tally_of(link: Any, tick: float, now: int) -> ContactTally:
    """Totals of the contact that a link is, in SI units, in a run up to tick `now`.

    `tick` is the duration of a tick, s. An impact has no peak force: it is nan. Without
    any force the times of first and last force are nan; the last one is `now` while a
    force acts.
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
    """Time of the end of the last contact, s; nan without a proof.

    It is 0 if no contact pressed, and inf if one presses for ever.
    `status.last_contact` finds it, from the ends of force and the openings of all
    contacts that have pressed; an end is nan while the force acts, an opening while
    there is none. An impact is over at once: one that is open now has parted, even
    though PRESS was logged last, as it struck.

    `end` is the end of the run, s, `round_trip` the longest time in a body there and
    back, s.
    """
    if run.proved_tick < 0:
        return math.nan
    ends = []  # ends of the force and of touching, by contact
    for link in links:
        can_open = link.law >= Law.RIGID
        if can_open and link.episodes > 0:
            has_struck = link.law == Law.IMPACT and link.status == Status.OPEN
            if link.logged_status == Status.PRESS and not has_struck:
                force_end = math.nan
            else:
                force_end = link.last_force_tick * run.tick_duration
            is_open = link.logged_status == Status.OPEN or has_struck
            if is_open and link.last_opening_tick >= 0:
                opening = link.last_opening_tick * run.tick_duration
            else:
                opening = math.nan
            ends.append((force_end, opening))
    return last_contact(ends, end, round_trip)


def why_stopped(run: Any, has_given_end: bool) -> str:
    """The reason why a run ended: "max_events", "until", "final" or "clock".

    The cap on steps comes first, then the given end, then a proof. "clock" is the end
    of the clock without any of these.
    """
    if run.stop_reason == Stop.CAP:
        return "max_events"
    if has_given_end:
        return "until"
    if run.proved_tick >= 0:
        return "final"
    return "clock"


def end_of_run(
    run: Any, links: Any, system: Any, stopped_by: str, end: float, t_final: float
) -> RunEnd:
    """Sentences on why a run ended, with its proof if there was one.

    Parameters
    ----------
    run : RUN
    links : list of LINK
    system : System
    stopped_by : str
        As of `why_stopped`.
    end, t_final : float
        End of the run, and of the last contact, as of `last_of`, s.
    """
    proof = ""
    if run.proved_tick >= 0:
        has_contact = any(link.episodes > 0 for link in links)
        proof = proof_sentence(has_contact, t_final)
    work = f"{run.steps} steps of nodes"
    return describe_end(stopped_by, proof, format_si(end, "s"), work, system)


def accuracy_sentence(worst: float, goal: float) -> str:
    """Sentence of the status on the largest stated error; `goal` is rtol.

    If the error is more than MISSED_GOAL_FACTOR times the goal, another sentence says
    so.
    """
    text = f" Stated relative error: {worst:.1g}."
    if worst > MISSED_GOAL_FACTOR * goal:
        text += f" That is more than rtol = {goal:.6g} asks for."
    return text


def simplifications_text(run: Any) -> str:
    """Sentences of the status on what the run has simplified; empty if nothing.

    These are jumps too dense to follow, which are smoothed, and rigid bodies set at
    rest.
    """
    text = ""
    if run.averaged_steps:
        start = format_si(run.first_averaged_tick * run.tick_duration, "s")
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
    """Path and sentence of the error where a node has no solution.

    No forces in it satisfy the laws of its links. The reason is two walls that squeeze
    a rigid mass, or else numbers out of range; the path is that of all contacts, or of
    the last contact in the node.
    """
    time = format_si(seconds, "s")
    # Mobility is 0 where no rod begins:
    # what leaves such masses no solution are two walls.
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
