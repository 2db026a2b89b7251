"""The link of a row, as numbers for kernels.

A link is a contact, a joint, a bond, or the push on an end. It has the numbers of its
law, each with the same meaning in all methods. The class of a contact law states which
of these numbers the law sets (`fills_link`), and which branch of the kernels it uses
(`acts_as`). Methods append fields of their own to `LINK`, for the state of a link
during a run.
"""

from enum import IntEnum
from typing import Annotated, Any

from ..model import laws as contact_laws
from ..model.laws import CONTACT_LAWS, KNOTS
from .record_lists import blank, dtype_of


class Law(IntEnum):
    """The kind of law of a link.

    The order has a meaning. <= PUSH_RIGHT: a bond or a given force. >= JOINT: the two
    neighbours can move relative to each other, so that there is an overlap or a gap.
    >= RIGID: a contact that can open. >= SPRING: a contact whose force follows from its
    overlap. > SPRING: such a contact with another law than a spring.
    """

    BOND = 0
    PUSH_LEFT = 1  # a given force on the left end, 0 at a free end
    PUSH_RIGHT = 2  # the same at the right end
    JOINT = 3
    RIGID = 4
    IMPACT = 5  # rigid bodies that exchange momentum instantly
    SPRING = 6
    POWER = 7
    YIELD = 8
    OWN = 9  # a function of the user


class Link:
    """Numbers of a link; in a family they are arrays.

    For a yielding contact the yield force and the next line of its table change during
    a run.
    """

    law: int  # kind of law, `Law`: the branch of the kernels
    gap: float  # distance of the two faces at t = 0, m; below 0 an overlap
    stretch: float  # stretch of a joint at t = 0, m
    stiffness: float  # k, N/m; N/m^p for a power law
    exponent: float  # p of the force k d^p
    # c of a dashpot (JOINT, SPRING), N s/m; for other laws chi of Hunt and Crossley,
    # s/m
    damping: float
    restitution: float  # e of an impact between rigid bodies
    yield_force: float  # force at which the contact yields, N
    hardening_share: float  # slope of the force while it yields, over the stiffness
    knots: Annotated[list[float], f"{KNOTS}f8"]  # forces at which further lines of the
    # table begin, N
    shares: Annotated[list[float], f"{KNOTS}f8"]  # slopes of these lines, over the
    # stiffness


LINK = dtype_of(Link)

FIELDS = list(Link.__annotations__)
ALL_LAWS: dict[str, Any] = {**CONTACT_LAWS, contact_laws.Law.law: contact_laws.Law}

KINDS = {name: Law[law.acts_as.upper()] for name, law in ALL_LAWS.items()}
"""Kind of law of a link, by the name of the contact law."""

FILLED = {name: law.fills_link for name, law in ALL_LAWS.items()}
"""Fields of the link that are attributes of the contact law, by the name of the law."""


def link_of(law: int) -> Any:
    """Make a link with this kind of law, the exponent 1, and all other numbers 0."""
    link = blank(1, LINK)[0]
    link.law = law
    link.exponent = 1.0
    return link


def link_of_contact(law: Any, gap: Any) -> Any:
    """Make the link of a contact with this contact law; `gap` in m.

    The attributes of the law that its class lists in `fills_link` become fields of the
    link; its other numbers are those of `link_of`. A rigid contact with a coefficient
    of restitution gets the kind IMPACT. The web page has this function as JavaScript.
    """
    link = link_of(KINDS[law.law])  # law.law is the name of the contact law
    link.gap = gap
    # The attributes of the law and the fields of the link have the same names.
    for name in FILLED[law.law]:
        setattr(link, name, getattr(law, name))
    # Only a contact of two rigid masses can have a given restitution; beside a rod it
    # follows from the waves.
    if link.law == Law.RIGID and law.restitution is not None:
        link.law = Law.IMPACT
        link.restitution = law.restitution
    return link


def in_steps(links: Any, step: float) -> dict[str, Any]:
    """Fields of links that change if time is counted in steps, by name; `step` in s.

    Velocities remain in m/s and forces in N, and a length d becomes x = d/step, m/s. So
    the stiffness k of a force k d^p becomes k step^p. The field "gap" becomes the gap
    of a contact, or the stretch of a joint, divided by the step. The damping does not
    change, as it multiplies a velocity. Both fields are new arrays, [link]; `links` is
    not changed.
    """
    return {
        "stiffness": links["stiffness"] * step ** links["exponent"],
        # A contact has the stretch 0, a joint has the gap 0.
        "gap": (links["gap"] + links["stretch"]) / step,
    }


def initial_gap(link: Any) -> Any:
    """Gap of a contact, or stretch of a joint, at t = 0, m; below 0 an overlap."""
    if link.law == Law.JOINT:
        return link.stretch
    return link.gap
