"""Columns of a family of collisions, by their public names; one entry a member.

A method that runs many members in one call returns these columns. For a refused member
they are nan, or 0 in columns of whole numbers.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..model import System
from .groups import unilateral
from .restitution import effective_restitution
from .run import STOPPED_BY
from .signals import Floats, Ints

Columns = dict[str, Any]
"""Arrays by name: [member], or in the shape of the family."""

CONTACT_COLUMNS = ("impulse", "peak_force", "duration", "episodes")
"""Totals of a contact, as `ContactTally` and users name them."""


def family_columns(
    system: System,
    *,
    before: Sequence[Floats],
    after: Sequence[Floats],
    vibration: Floats,
    contacts: Mapping[str, Sequence[Any]],
    final: Any,
    status: Ints,
) -> Columns:
    """Columns that every family has, by name.

    They are "restitution", "vibration", "final", "status", the velocity of each body
    after the run, such as "velocity_after.0", and each total of each contact, such as
    "impulse.0". All but "restitution" are the arrays of the arguments, not copied. It
    is nan unless exactly one contact can open, and for members to which
    `effective_restitution` gives nan: the collision is not final, the contact never
    pressed, or the bodies did not approach each other before.

    Parameters
    ----------
    system : System
    before, after : list of [member] arrays
        Velocities of the bodies, m/s.
    vibration : [member] array
        Energy left in all bodies together, J.
    contacts : mapping
        For each name of `CONTACT_COLUMNS`, a list of [member] arrays, one a contact.
    final : [member] array of bool
        Whether it is proved that no bodies will meet again.
    status : [member] array of int
        Indices into `STOPPED_BY`.
    """
    restitution = np.full(len(final), math.nan)
    contacts_that_open = unilateral(system)
    if len(contacts_that_open) == 1:
        k = contacts_that_open[0]  # it lies between the bodies k and k + 1
        restitution = effective_restitution(
            final, contacts["episodes"][k], before[k : k + 2], after[k : k + 2]
        )
    columns: Columns = {
        "restitution": restitution,
        "vibration": vibration,
        "final": final,
        "status": status,
    }
    for i, velocity in enumerate(after):
        columns[f"velocity_after.{i}"] = velocity
    for name in CONTACT_COLUMNS:
        for k, values in enumerate(contacts[name]):
            columns[f"{name}.{k}"] = values
    return columns


def status_column(refused: Any, final: Any, capped: Any, until: float | None) -> Ints:
    """Index into `STOPPED_BY` of the reason why each member stopped, [member].

    The first reason that applies is taken: the member was refused; its collision was
    final, in a run without a given end; it reached the cap on events. Otherwise it ran
    to the given end `until`, or to the end of the clock if `until` is None. The first
    three arguments are [member] arrays of bool.
    """
    if until is None:
        ended_by_proof = final
        otherwise = "clock"
    else:  # a proof does not end such a run
        ended_by_proof = np.zeros_like(final)
        otherwise = "until"
    # `np.select` takes the first reason that is True.
    reasons = {"refused": refused, "final": ended_by_proof, "max_events": capped}
    indices = [STOPPED_BY.index(name) for name in reasons]
    return np.select(
        list(reasons.values()), indices, default=STOPPED_BY.index(otherwise)
    )
