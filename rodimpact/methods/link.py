"""The link of a row, as numbers for kernels.

It is a contact, a joint, a bond, or the push on an end. A link has the numbers of its
law, each with one meaning, whatever the method. A contact law states in its class which
of them it fills, and by which branch of the kernels it acts (`acts_as`). Methods append
fields of their own to `LINK`: what a link does during a run.
"""

from enum import IntEnum
from typing import Annotated, Any

from ..model import laws as contact_laws
from ..model.laws import CONTACT_LAWS, KNOTS
from .record_lists import blank, dtype_of


class Law(IntEnum):
    """What acts in a link.

    The order counts: <= PUSH_RIGHT is no law of an overlap, but a bond or a given
    force; >= JOINT lets its two neighbours move against each other, so that it has an
    overlap or a gap; >= RIGID is a contact that can open; >= SPRING is one whose force
    follows from its overlap; > SPRING is one whose force is not that of a spring.
    """

    BOND = 0
    PUSH_LEFT = 1  # the force of what stands outside the left end, none at a free one
    PUSH_RIGHT = 2
    JOINT = 3
    RIGID = 4
    IMPACT = 5  # rigid bodies exchange momentum at once
    SPRING = 6
    POWER = 7
    YIELD = 8
    OWN = 9  # a function of the user


class Link:
    """Numbers of a link; in a family they are arrays.

    Of what yields, the numbers are those of now: yielding raises the yield force, and
    goes on along the next line of a table.
    """

    law: int  # kind of law, `Law`: the branch of the kernels
    gap: float  # distance of the two faces at t = 0, m; below 0 an overlap
    stretch: float  # s of a joint at t = 0, m
    stiffness: float  # k, N/m; N/m^p for a power
    exponent: float  # p of the force k d^p
    # c of a dashpot (JOINT, SPRING), N s/m; else chi of Hunt and Crossley, s/m
    damping: float
    restitution: float  # e of an impact between rigid bodies
    yield_force: float  # force from which on the contact yields, N
    hardening_share: float  # slope of the force while it yields, over the stiffness
    knots: Annotated[list[float], f"{KNOTS}f8"]  # forces at which lines begin, N
    shares: Annotated[list[float], f"{KNOTS}f8"]  # their slopes, over the stiffness


LINK = dtype_of(Link)

FIELDS = list(Link.__annotations__)
ALL_LAWS: dict[str, Any] = {**CONTACT_LAWS, contact_laws.Law.law: contact_laws.Law}

KINDS = {name: Law[law.acts_as.upper()] for name, law in ALL_LAWS.items()}
"""Kind of law of a link, by the name of the contact law."""

FILLED = {name: law.fills_link for name, law in ALL_LAWS.items()}
"""Fields of the link that are attributes of the contact law, by the name of the law."""


def link_of(law: int) -> Any:
    """A new link of this kind of law: its exponent is 1, its other numbers are 0."""
    link = blank(1, LINK)[0]
    link.law = law
    link.exponent = 1.0
    return link


def link_of_contact(law: Any, gap: Any) -> Any:
    """The link of a contact with this law; `gap` in m.

    It has those attributes of the law that its class names as numbers of a link; its
    other numbers are those of `link_of`. A rigid contact with a restitution is an
    impact (IMPACT). The page of `explorer` has this function as JavaScript.
    """
    link = link_of(KINDS[law.law])  # law.law is the name of its kind
    link.gap = gap
    # Fields of the link have the names of the law's attributes.
    for name in FILLED[law.law]:
        setattr(link, name, getattr(law, name))
    # Only a contact of two rigid bodies may have a restitution: waves decide elsewhere.
    if link.law == Law.RIGID and law.restitution is not None:
        link.law = Law.IMPACT
        link.restitution = law.restitution
    return link


def in_steps(links: Any, step: float) -> dict[str, Any]:
    """Fields of links that change where time is counted in steps, by name; `step` in s.

    Velocities stay in m/s, so that lengths d become x = d/step, m/s; forces stay in N.
    The stiffness k of a force k d^p becomes k step^p, and the gap that of a contact, or
    the stretch of a joint, over the step. Damping stays, as it multiplies a velocity.
    Both fields are new arrays, [link].
    """
    return {
        "stiffness": links["stiffness"] * step ** links["exponent"],
        "gap": (links["gap"] + links["stretch"]) / step,  # one of them is 0
    }


def initial_gap(link: Any) -> Any:
    """Gap of a contact, or stretch of a joint, at t = 0, m; below 0 an overlap."""
    if link.law == Law.JOINT:
        return link.stretch
    return link.gap
