"""The records that the kernels of this method work on.

Conventions. Compression is positive: F > 0 presses two neighbours apart, `overlap` > 0 is their
overlap (below 0: the gap), `closing` the rate at which a link would close without its own force,
`mobility` the sum of 1/Z of the rod ends that it joins. Times are ticks, velocities m/s in the
frame of the run, forces N.
"""

from enum import IntEnum

import numpy as np

from .. import link
from .series import POINTS


class Part(IntEnum):
    """What a group of bonded bodies is made of."""

    SEGMENT = 0
    MASS = 1
    JOINT = 2
    WALL = 3  # from here on what holds the group
    ENDLESS = 4


SMOOTH = 99  # order of a break that is none
HARD = 2  # breaks up to this derivative end a piece
NONE = -1
NEVER = 1 << 61  # tick

PIECE = np.dtype(
    [
        ("start", "i8"),
        ("stop", "i8"),
        ("order", "i8"),  # of the break at its start
        ("degree", "i8"),
        ("line", "i8"),
        ("after", "i8"),  # next piece of the same line
        ("coefficient", "f8", (POINTS,)),
    ],
    align=True,
)
LINE = np.dtype(
    [
        ("delay", "i8"),
        ("first", "i8"),
        ("head", "i8"),  # piece that is being read
        ("tail", "i8"),
        ("hard", "i8"),  # hard breaks that were sent and not yet read
    ],
    align=True,
)
NODE = np.dtype(
    [
        ("now", "i8"),
        ("length", "i8"),  # ticks that the next piece shall last
        ("first", "i8"),
        ("links", "i8"),
        ("mass", "i8"),
        ("mirror", "i8"),  # 1: a free end
        ("rough", "i8"),  # 1: breaks come too densely
        # on the left and on the right: the lines that come in and go out, and 1/Z of the rod
        ("source", "i8", (2,)),
        ("target", "i8", (2,)),
        ("mobility", "f8", (2,)),
        ("incoming", "f8", (2, POINTS)),  # over a piece
        ("leaving", "f8", (POINTS,)),
        ("rate", "f8", (POINTS,)),
        ("series", "f8", (POINTS,)),  # scratch
    ],
    align=True,
)
LINK = np.dtype(
    [
        *link.LINK.descr,
        ("status", "i8"),
        ("order", "i8"),  # of the break that its own event makes
        ("function", "i8"),
        ("near", "f8"),
        ("near_rate", "f8"),  # of a law of the user: m, m/s
        ("resting_force", "f8"),  # scale of forces between bodies that rest, N
        ("mobility", "f8"),
        (
            "knot",
            "i8",
        ),  # the next of these forces, from which on what yields has another hardening
        ("overlap", "f8"),
        ("rate", "f8"),
        ("bend", "f8"),  # and derivatives, as the last piece ended
        ("ease", "f8"),  # velocity that a force makes in about the shortest transit
        ("rate_after", "f8"),  # of an impact: closing that it leaves
        (
            "kept",
            "i8",
        ),  # first of the lines that keep the force, the overlap and the closing
        ("left_group", "i8"),
        ("right_group", "i8"),  # their first parts
        ("touch", "i8"),
        ("unknown", "i8"),
        ("impulse", "f8"),
        ("peak", "f8"),
        ("peak_error", "f8"),  # estimated error of `peak`, N
        ("first", "i8"),
        ("last", "i8"),
        ("apart", "i8"),
        ("opened", "i8"),
        ("pressed", "i8"),
        ("faint", "i8"),  # ticks since it closed, with a force that is none yet
        ("episodes", "i8"),
        ("overlaps", "f8", (POINTS,)),
        ("closing", "f8", (POINTS,)),
        ("force", "f8", (POINTS,)),
        ("by_overlap", "f8", (POINTS,)),
        ("by_closing", "f8", (POINTS,)),  # derivatives of the force
        ("base", "f8", (POINTS,)),  # what these leave of it
    ],
    align=True,
)
MASS = np.dtype(
    [
        ("mass", "f8"),
        ("speed", "f8", (POINTS,)),
        ("line", "i8"),
    ],
    align=True,
)
TURN = np.dtype(
    [
        ("tick", "i8"),
        ("link", "i8"),
        ("touch", "i8"),
        ("impulse", "f8"),  # of an impact
        ("closing", "f8"),  # mean of that before and after it
    ],
    align=True,
)
PART = np.dtype(
    [
        ("kind", "i8"),
        ("index", "i8"),
        ("parts", "i8"),  # of the group, at its first part
        ("held", "i8"),  # line of what holds the group
        ("mass", "f8"),
        ("compliance", "f8"),  # m/N
        ("own", "f8"),
        ("energy", "f8"),  # mean velocity of the part; J about that of its group
        ("wave", "f8", (2,)),
        ("tilt", "f8", (2,)),  # moments of both waves in a segment
        # of the group, at its first part
        ("initial", "f8"),
        ("mean", "f8"),  # velocity of its centre of mass at t = 0, and now
        (
            "speed",
            "f8",
        ),  # of the motion about which it swings: that, or of what holds it
        ("low", "f8"),
        ("high", "f8"),  # bounds of the waves under way
        ("plain", "i8"),  # whether its ends can move with no others
        ("bound", "f8"),  # energy about that motion, J
        ("deviation", "f8", (2,)),  # of the left and the right end from that motion, m
        ("slack", "f8", (2,)),  # m/N
    ],
    align=True,
)
RUN = np.dtype(
    [
        ("tick", "f8"),
        ("scale", "f8"),  # s; of velocities, m/s
        ("tolerance", "f8"),  # of a piece, m/s
        ("floor", "i8"),
        ("window", "i8"),
        ("shortest", "i8"),  # ticks
        ("end", "i8"),
        ("limit", "i8"),
        ("keep", "i8"),
        ("proved", "i8"),
        ("held", "i8"),  # 1: bodies are joined to others, a wall or an endless rod
        ("surveyed", "i8"),  # when its groups were looked at last
        (
            "check",
            "i8",
        ),  # when they are to be looked at again, NEVER where nothing is to be proved
        ("proof_interval", "i8"),  # least time between two looks for a proof, ticks
        ("extra", "i8"),  # ticks to go on after the proof
        ("pieces", "i8"),
        ("turns", "i8"),
        ("steps", "i8"),
        ("rough", "i8"),
        ("first_rough", "i8"),
        ("roughest", "f8"),  # largest tail that was accepted, m/s
        (
            "shared",
            "f8",
        ),  # largest error of a piece that any tolerance makes alike, m/s
        ("rested", "i8"),
        ("stop", "i8"),
        ("graze", "f8"),  # m/s; forces that move no faster are none
    ],
    align=True,
)
