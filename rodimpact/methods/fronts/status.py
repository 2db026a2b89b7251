"""Why a run by fronts ended, in a sentence; the web page has this as JavaScript."""

from typing import Any

from ...model.numbering import contact_names
from ...units import format_si
from ..states import Status
from ..status import RunEnd, describe_end, proof_sentence
from .records import Node, Run
from .run import REASONS

RESTING_FORCE_RTOL = 2.0**-40
"""A contact that presses with less than this part of its peak force is at rest."""


def end_of_run(
    run: Run, contacts: list[Node], system: Any, is_proved: bool, t_final: float
) -> RunEnd:
    """Why a run ended, as a sentence and advice; the advice may be "".

    A final run gives the proof, without advice. A run at the cap without a proof gets
    the advice to make lengths commensurate. If the clock stopped it, as its ticks could
    not be counted any further, a sentence says so. All other runs are left to
    `describe_end`: a given end, or the cap after a proof, which is stated then, too.

    Parameters
    ----------
    run : Run
    contacts : list of Node
    system : System
    is_proved : bool
        Whether the collision is final.
    t_final : float
        End of the last contact, s: `last_contact_end`.
    """
    stopped_by = REASONS[run.stop_reason]
    final = ""
    if is_proved:
        final = final_sentence(contacts, system, t_final)
    advice = ""  # a final run needs none
    if stopped_by == "final":
        return RunEnd(final, advice)
    end_time = format_si(run.now * run.tick_duration, "s")
    if stopped_by == "max_events" and final == "":
        return RunEnd(
            f"Stopped by the cap of {run.max_events} events at {end_time}; fronts "
            "multiply where transit times have no common measure.",
            "Raise max_events, or make lengths commensurate.",
        )
    if stopped_by == "clock":  # its integer ticks would overflow
        return RunEnd(
            f"Stopped by the clock after {end_time}: the next contact may come later "
            "than the clock can count, or never.",
            "Give until= to set another end.",
        )
    return describe_end(stopped_by, final, end_time, f"{run.max_events} events", system)


def final_sentence(contacts: list[Node], system: Any, t_final: float) -> str:
    """Sentence on a collision that is proved final.

    If contacts go on pressing with a force above `RESTING_FORCE_RTOL` of their peak
    force, it names them. Otherwise it is `status.proof_sentence`, which depends on
    whether any contact has pressed, and on `t_final`, the end of the last contact, s.
    `contacts` are the nodes of the contacts.
    """
    pressing: list[int] = []
    has_pressed = False
    for i, node in enumerate(contacts):
        if node.episodes > 0:
            has_pressed = True
        resting_force = RESTING_FORCE_RTOL * node.peak_force
        if node.status == Status.PRESS and node.force > resting_force:
            pressing.append(i)
    if len(pressing) > 0:
        listed = names_of(pressing, system)
        return f"Nothing changes any more; contact {listed} goes on pressing."
    return proof_sentence(has_pressed, t_final)


def faint_sentence(run: Run, contacts: list[Node], system: Any) -> str:
    """Sentence on contacts whose force decays below the tolerance; empty if none does.

    It names these contacts, and says how much longer their forces may last: for ever if
    one of them still grazes at the end of a run without a given end; otherwise the
    longest of their grazing times. The sentence begins with a space.
    """
    faint: list[int] = []
    longest = 0  # ticks of grazing after a faint force
    lasts_for_ever = False
    for i, node in enumerate(contacts):
        if node.faint_ticks > 0:
            faint.append(i)
            longest = max(longest, node.faint_ticks)
        if node.is_faint and run.until < 0:  # no end is given
            lasts_for_ever = True
    if len(faint) == 0:
        return ""
    listed = names_of(faint, system)
    if lasts_for_ever:
        extension = "go on for ever"
    else:
        extension = f"last up to {format_si(longest * run.tick_duration, 's')} longer"
    return (
        f" The force of contact {listed} decays and counts as zero below 2^-48 of the "
        f"velocity scale; it may {extension}."
    )


def names_of(contacts: list[int], system: Any) -> str:
    """Names of contacts, given by their indices, separated by commas."""
    names = contact_names([body.kind for body in system.bodies])
    return ", ".join([names[i] for i in contacts])
