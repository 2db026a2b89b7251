"""The effective coefficient of restitution of a single contact, or why there is none.

The web page has this as JavaScript.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

PARTING_RTOL = 2.0**-40
"""Parting velocity over closing velocity up to which bodies count as staying together.

It is 256 times the relative tolerance of a front. The least e of a pair of rods is the
least ratio of two transit times in a clock, which is five times larger.
"""


def no_restitution(
    unilateral: Sequence[int],
    before: Sequence[float],
    contacts: Sequence[Any],
    driven: bool,
    final: bool,
    status: str,
) -> str:
    """Why there is no coefficient of restitution; empty if there is one.

    There is one if all of these conditions hold: exactly one contact can open, nothing
    else changes velocities, the contact pressed, the collision is over, and the centres
    of mass approached each other before. The sentence states the first condition that
    fails. It ends without a full stop, unless it ends with `status`.

    Parameters
    ----------
    unilateral : list of int
        Contacts that can open.
    before : list of float
        Velocities of the bodies, m/s.
    contacts : list of ContactTally
    driven : bool
        Whether velocities change besides at contacts: by gravity, a driven end, soil
        or drag.
    final : bool
        Whether the collision is over.
    status : str
        Sentence that says why the run ended; quoted if the contact did not press though
        the bodies approach each other, and if the collision is not over.
    """
    if len(unilateral) == 0:
        return "restitution is undefined: no contact of this row can open"
    if len(unilateral) != 1:
        return (
            f"restitution is defined for one contact, this row has {len(unilateral)}; "
            "read velocities_after instead"
        )
    k = unilateral[0]  # it lies between the bodies k and k + 1
    closing = before[k] - before[k + 1]
    reason = ""
    if driven:
        reason = (
            "gravity, a driven end, soil or drag changes the velocities too; read "
            "impulse and velocities instead"
        )
    elif contacts[k].episodes == 0:
        if closing < 0:
            reason = "nothing collided; the bodies move apart"
        elif closing == 0:
            reason = "nothing collided; the bodies do not approach each other"
        else:
            reason = f"nothing collided; {status}"
    elif not final:
        reason = f"the collision is not over. {status}"
    elif closing <= 0:
        reason = (
            "the centres of mass did not approach each other; only vibration brought "
            "the bodies together"
        )
    if reason == "":
        return ""
    return f"restitution is undefined: {reason}"


def effective_restitution(
    final: Any, episodes: Any, before: Sequence[Any], after: Sequence[Any]
) -> Any:
    """e = (V2+ - V1+)/(V1- - V2-) of one contact; arrays broadcast.

    It is nan if the collision is not over, the contact never pressed, or the centres of
    mass did not approach each other before. It is 0 if the bodies part by no more than
    round-off, or seem to approach each other after their last contact: then they stay
    together, as when a semi-infinite bar is pushed for ever.

    Parameters
    ----------
    final, episodes
        Whether the collision is over, and how many times the contact pressed.
    before, after : pair
        Velocities of the left and of the right centre of mass, m/s.
    """
    closing = before[0] - before[1]
    parting = after[1] - after[0]
    # If `closing` is not positive the result is nan; 1 avoids a division by 0.
    e = parting / np.where(closing > 0, closing, 1.0)
    largest = np.maximum(np.abs(after[0]), np.abs(after[1]))
    # Two units in the last place: round-off of a difference of two velocities
    round_off = 2 * np.spacing(largest)
    # The product of truth values means "and", also on the web page.
    parted = (e > PARTING_RTOL) * (parting > round_off)
    defined = final * (episodes > 0) * (closing > 0)  # e exists
    return np.where(defined, np.where(parted, e, 0.0), math.nan)
