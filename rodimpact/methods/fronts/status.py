"""Why a run by fronts ended, in a sentence; the page has this as JavaScript."""

from typing import Any

from ...model.numbering import contact_names
from ...units import format_si
from ..laws import Status
from ..status import ending, proof_sentence
from .records import Node, Run
from .run import REASONS

ROUND_OFF = 2.0**-40  # of the peak force: a contact that presses less has come to rest


def status_of(
    run: Run, contacts: list[Node], system: Any, proved: bool, t_final: float
) -> str:
    """Why a run ended.

    Parameters
    ----------
    run : Run
    contacts : list of Node
    system : System
    proved : bool
        Whether nothing meets again.
    t_final : float
        As of `last_of`, s.
    """
    stopped_by = REASONS[run.stop]
    final = ""
    if proved:
        final = final_sentence(contacts, system, t_final)
    if stopped_by == "final":
        return final
    end = format_si(run.now * run.tick, "s")
    if stopped_by == "max_events" and final == "":
        return (
            f"Stopped by the cap of {run.events} events at {end}; fronts multiply "
            "where transit times have no common measure. Raise max_events, or make "
            "lengths commensurate."
        )
    if stopped_by == "clock":
        return (
            f"Stopped by the clock after {end}: the next contact may come later than "
            "the clock can count, or never. Give until= to set another end."
        )
    return ending(stopped_by, final, end, f"{run.events} events", system)


def final_sentence(contacts: list[Node], system: Any, t_final: float) -> str:
    """What is said of a collision that is proved final."""
    names = contact_names([body.kind for body in system.bodies])
    pressing: list[str] = []
    met = False
    for i, node in enumerate(contacts):
        if node.episodes > 0:
            met = True
        lasting_force = ROUND_OFF * node.peak_force
        if node.status == Status.PRESS and node.force > lasting_force:
            pressing.append(names[i])
    if len(pressing) > 0:
        those = ", ".join(pressing)
        return f"Nothing changes any more; contact {those} goes on pressing."
    return proof_sentence(met, t_final)
