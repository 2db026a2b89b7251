"""The arrays on which the kernels of the grid work.

Loops over all nodes and cells stream through plain arrays of numbers; all else is records. Cell i
lies between the nodes i - 1 and i, so the cells 0, those between pieces, and the last stand for
nothing. Time is counted in steps: lengths are velocity times steps, and masses and stiffnesses are
scaled to match: M/h, E A h/dx, k h^p for a force k x^p, a dashpot's constant as it is; J/h, G h,
b h, s h and q/h for a radial strain q.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np


class End(IntEnum):
    """What acts on an end of the row."""

    FREE = 0
    PUSHED = 1
    MOVED = 2
    ENDLESS = 3


NONE = -1
FAR = (1 << 40) - 1  # n & FAR tells the compiler that n >= 0, so that its loops run in vectors

RUN = np.dtype([
    ("step", "i8"), ("first", "i8"),  # steps taken, now and as the arrays of `Track` begin
    ("kept", "i8"),  # states entered there
    ("tolerance", "f8"),  # velocity below which contacts graze and impacts rest
    ("resolution", "f8"),  # gap that counts as no opening: the mesh does not see it
], align=True)
STRETCH = np.dtype([  # of nodes of a segment, or of cells with radial strains
    ("first", "i8"), ("last", "i8"), ("implicit", "i8"),  # 1: kicked with its piece
    ("opens", "i8"),  # 1: its first node is not the last one of the stretch before
    ("kick", "f8"), ("stiffness", "f8"),  # of its inner nodes and its cells, -1 if they differ
], align=True)
PIECE = np.dtype([("start", "i8"), ("place", "f8")], align=True)  # first node, its displacement
IMPLICIT = np.dtype([  # a piece with damping or lateral inertia
    ("first", "i8"), ("middle", "i8"), ("last", "i8"),  # nodes
    ("left", "f8"), ("right", "f8"),  # what the middle takes from its neighbours
], align=True)
NODE = np.dtype([  # of an implicit piece
    ("into", "f8"), ("back", "f8"), ("inverse", "f8"),  # multipliers of the elimination
    ("by_first", "f8"), ("by_last", "f8"),  # velocity for a unit force on either end of the piece
], align=True)
LINK = np.dtype([  # a contact or joint
    ("law", "i8"), ("stiffness", "f8"), ("exponent", "f8"),
    ("damping", "f8"),  # of YIELD the hardening, as a share of the stiffness
    ("strength", "f8"),  # force at which it yields now
    ("left", "i8"), ("right", "i8"),  # nodes
    ("left_implicit", "i8"), ("right_implicit", "i8"),  # pieces, NONE if explicit
    ("left_group", "i8"), ("right_group", "i8"),
    ("last", "i8"),  # of those that feel each other, at the first of them; else NONE
    ("own", "f8"),  # half the mobility of both sides together
    ("shared", "f8"),  # half the mobility that it shares with the link before
    ("gap", "f8"), ("force", "f8"), ("closing", "f8"),  # mean closing velocity of the last step
    ("open", "i8"),  # 1 if the gap has opened since the contact last pressed
    ("shut", "i8"),  # 1 while a rigid contact is closed
    ("before", "f8"),  # closing velocity at the start of the step
    ("free", "f8"),  # by how much it would close without forces
    ("limit", "f8"),  # greatest closing of a pressing rigid contact or impact
    ("place", "f8"),  # indentation at the end of the step
    ("slope", "f8"),  # dF/dw, -1 where the closing w is fixed
    ("kept", "f8"),  # force before a Newton step
    ("upper", "f8"),  # for the elimination
    ("impulse", "f8"),  # sum of forces
    ("lost", "f8"),  # turned to heat by dashpots and impacts
    ("numerical", "f8"),  # lost by rigid contacts that close within a step
    ("episodes", "i8"),  # number of times an open contact began to press
], align=True)
BOND = np.dtype([  # an interface in a piece whose force is asked for: F > 0 pushes the parts apart
    ("node", "i8"), ("mass", "f8"),  # of what stands at the node on one side of the interface
    ("side", "i8"),  # on which side: 0 left, 1 right
    ("cell", "i8"), ("viscous", "f8"), ("bound", "f8"),  # that pulls at it
    ("link", "i8"),  # that pushes it
    ("end", "i8"),  # of the row that pushes it
    ("here", "f8"), ("there", "f8"),  # velocities before the step: of it, of the cell's other node
], align=True)
END = np.dtype([  # left or right
    ("kind", "i8"), ("node", "i8"), ("impedance", "f8"),  # of an endless bar
    ("rest", "f8"),  # the wave that comes from it beside the given one
    ("given", "f8"), ("old", "f8"),  # of this step, and the velocity before it
], align=True)
SIGNAL = np.dtype([("force", "f8"), ("gap", "f8"), ("closing", "f8")])
OUTER = np.dtype([
    ("given", "f8"),  # force, wave, or velocity at the end of the step
    ("push", "f8"), ("speed", "f8"),  # force of the outside to the inside, mean velocity of the end
])
STATE = np.dtype([("when", "i8"), ("lost", "f8")], align=True)

# what the proof of finality asks for
GROUP = np.dtype([("first", "i8"), ("last", "i8")])  # nodes of pieces that are joined
CELL = np.dtype([
    ("mass", "f8"), ("held", "i8"),  # of the node to its right; 1 if its velocity is given
    ("shear", "f8"),  # between it and the next cell
    ("lateral", "f8"),  # inertia that resists changes of its length
    ("relaxed", "f8"),  # stiffness where the radial strain follows
    ("joint", "i8"),  # link that stands there, NONE without
    ("ease", "f8"), ("coupling", "f8"), ("own", "f8"), ("share", "f8"),  # as in `Grid`
    # and what is found
    ("loose", "f8"),  # constant of a joint that is a dashpot alone
    ("slack", "f8"),  # stiffness as long as nothing moves
    ("strain", "f8"), ("moving", "f8"), ("strained", "f8"), ("radial", "f8"),  # energies
], align=True)


class Grid(NamedTuple):
    """What a step reads and changes."""

    run: Any  # one RUN
    velocity: Any  # [node]
    force: Any  # [cell] elastic tension in the middle of the last step; 0 between pieces
    mobility: Any  # [node] 1/mass; 0 where the velocity is given, or the piece is implicit
    stiffness: Any  # [cell]
    stretch: Any  # STRETCH
    piece: Any  # PIECE
    implicit: Any  # IMPLICIT
    node: Any  # [node] NODE
    viscous: Any  # [cell] eta A/dx
    lost: Any  # [cell] turned to heat
    change: Any  # [node] of the velocity in this step, in implicit pieces
    old: Any  # [node] velocity before it
    swollen: Any  # STRETCH of cells that have radial strains
    strain: Any  # [cell] radial strain q in the middle of the last step
    rate: Any  # [cell]
    ease: Any  # [cell] 1/J
    coupling: Any  # [cell] b
    own: Any  # [cell] G - b^2/k
    share: Any  # [cell] b/k
    shear: Any  # [cell] s between it and the next one
    link: Any  # LINK, from left to right
    bond: Any  # BOND
    end: Any  # two END
    mass: Any  # [mass] node


class Track(NamedTuple):
    """What is entered of each step, one after the other, and of states that are kept."""

    signal: Any  # [step, link] SIGNAL
    outer: Any  # [step, end] OUTER
    bonded: Any  # [step, bond] force
    speed: Any  # [step, mass]
    state: Any  # [state] STATE: at the ends of the steps `when`, the first of them 0
    velocity: Any  # [state, node]
    force: Any  # [state, cell]
    place: Any  # [state, piece]
    radial: Any  # [state, cell] radial strains, none where no cell has its own
    radial_rate: Any


PER_STEP, PER_STATE = Track._fields[:4], Track._fields[4:]
