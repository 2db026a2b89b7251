"""The arrays on which the kernels of the grid work.

Loops over all nodes and cells stream through plain arrays of numbers; all else is records. Cell i
lies between the nodes i - 1 and i, so the cells 0, those between pieces, and the last stand for
nothing. Time is counted in steps: lengths are velocity times steps, and masses and stiffnesses are
scaled to match: M/h, E A h/dx, k h^p for a force k x^p, a dashpot's constant as it is; J/h, G h,
b h, s h and q/h for a radial strain q.
"""

from typing import Any, NamedTuple

import numpy as np

from .. import link

NONE = -1
FAR = (
    1 << 40
) - 1  # n & FAR tells the compiler that n >= 0, so that its loops run in vectors

RUN = np.dtype(
    [
        ("step", "i8"),
        ("first", "i8"),  # steps taken, now and as the arrays of `Track` begin
        ("kept", "i8"),  # states entered there
        ("swells", "i8"),  # 1: cells have radial strains
        ("implicit", "i8"),  # 1: there is damping or lateral inertia
        ("tolerance", "f8"),  # velocity below which contacts graze and impacts rest
    ],
    align=True,
)
PIECE = np.dtype(
    [("start", "i8"), ("place", "f8")], align=True
)  # first node, its displacement
LINK = np.dtype(
    [  # a contact or joint; its `gap` is that of now, or the stretch
        *link.LINK.descr,
        (
            "knot",
            "i8",
        ),  # the next of the knots, from which on YIELD has another hardening
        ("left", "i8"),
        ("right", "i8"),  # nodes
        ("leftmost", "i8"),
        ("rightmost", "i8"),  # nodes that its force moves in the same step
        (
            "last",
            "i8",
        ),  # of those that feel each other, at the first of them; else NONE
        ("own", "f8"),  # half the mobility of both sides together
        ("shared", "f8"),  # half the mobility that it shares with the link before
        ("force", "f8"),
        ("closing", "f8"),  # mean closing velocity of the last step
        ("shut", "i8"),  # 1 while a rigid contact is closed
        ("before", "f8"),  # closing velocity at the start of the step
        ("free", "f8"),  # by how much it would close without forces
        ("limit", "f8"),  # greatest closing of a pressing rigid contact or impact
        ("place", "f8"),  # indentation at the end of the step
        ("slope", "f8"),  # dF/dw, -1 where the closing w is fixed
        ("kept", "f8"),  # force before a Newton step
        ("upper", "f8"),  # for the elimination
        # mean force over a step, and energy lost, as a rigid contact shut before the first kick
        ("early_force", "f8"),
        ("early_loss", "f8"),
    ],
    align=True,
)
END = np.dtype(
    [  # left or right
        ("kind", "i8"),
        ("node", "i8"),
        ("impedance", "f8"),  # of an endless bar
        ("rest", "f8"),  # the wave that comes from it beside the given one
        ("given", "f8"),  # in this step
    ],
    align=True,
)
SIGNAL = np.dtype([("force", "f8"), ("gap", "f8"), ("closing", "f8")])


class Grid(NamedTuple):
    """What a step reads and changes."""

    run: Any  # one RUN
    velocity: Any  # [node]
    force: (
        Any  # [cell] elastic tension in the middle of the last step; 0 between pieces
    )
    into: Any  # [node] multipliers of the elimination, 0 where nothing is implicit
    inverse: Any  # [node] of its diagonal: 1/mass where nothing is implicit; 1 at a given velocity
    back: Any  # [node]
    by_first: Any  # [node] velocity for a unit force on the first node of its piece
    by_last: Any  # [node] on the last one
    stiffness: Any  # [cell]
    piece: Any  # PIECE
    viscous: Any  # [cell] eta A/dx
    lost: Any  # [cell] turned to heat
    old: Any  # [node] velocity before this step, if there is viscosity
    change: Any  # [node] since then
    strain: Any  # [cell] radial strain q in the middle of the last step
    rate: Any  # [cell]
    ease: Any  # [cell] 1/J
    coupling: Any  # [cell] b
    own: Any  # [cell] G - b^2/k
    share: Any  # [cell] b/k
    shear: Any  # [cell] s between it and the next one
    link: Any  # LINK, from left to right
    end: Any  # two END
    watched: Any  # nodes whose velocities are entered after each step
    pulled: Any  # cells whose forces are


class Track(NamedTuple):
    """What is entered of each step, one after the other, and of states that are kept."""

    signal: Any  # [step, link] SIGNAL
    given: Any  # [step, end] force, wave, or velocity at the end of the step
    speed: Any  # [step, watched node] velocity at the end of the step
    pull: Any  # [step, pulled cell] elastic tension in the middle of the step
    when: Any  # [state] at the end of which step
    lost: Any  # [state] turned to heat
    velocity: Any  # [state, node]
    force: Any  # [state, cell]
    place: Any  # [state, piece]
    radial: Any  # [state, cell] radial strains, none where no cell has its own
    radial_rate: Any  # [state, cell]


PER_STATE = Track._fields[4:]
