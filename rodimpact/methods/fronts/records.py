"""The records that the kernels of this method work on, one kind each.

Node k joins the segments k and k + 1; line 2s carries what travels to the right through segment s,
line 2s + 1 what travels to the left. The segments 0 and n + 1 stand for what lies outside: nothing,
a wall, which is a segment of mobility 0, or an endless bar. Waves are velocities in a frame chosen
by the caller, times whole ticks, lengths velocity times ticks, impulses velocity times ticks over
mobility.
"""

import numpy as np

from ..tick_rule import SPAN

NEVER = 1 << 62  # the clock ends here
IDLE = (1 << 63) - 1  # tick of a node at which nothing is due
NONE = -1

SEGMENT = np.dtype([
    # of the first of a body, or of what holds or drives an end; without values it is neither
    ("profile", "i8"),  # place among the numbers of a member of values, where they jump,
    ("velocities", "i8"), ("strains", "i8"),  # so many velocities, then so many strains
    ("outside", "i8"),
    ("transit", "i8"), ("mobility", "f8"),  # 1/Z; 0 of a wall
    ("first", "i8"), ("last", "i8"),  # of the segments bonded to it and to each other; 1, 0 outside
    ("piece", "i8"),  # first of its pieces of constant state at t = 0
    ("initial", "f8"), ("initial_momentum", "f8"), ("initial_vibration", "f8"),
    ("velocity", "f8"),  # of the motion about which it vibrates, as `initial` at t = 0
    ("momentum", "f8"), ("vibration", "f8"),  # energy
    ("parted", "f8"),  # largest difference of its two waves
    # of the group whose end stands here at a contact
    ("mean", "f8"), ("low", "f8"), ("high", "f8"),  # its velocity, and bounds of its end's
    ("bounded", "i8"),  # 1: they hold
    ("deviation", "f8"), ("bound", "f8"),  # of the end from its mean motion, and its square
    ("slack", "f8"),  # this over twice the energy of vibration
], align=True)
NODE = np.dtype([
    ("kind", "i8"),  # its status while the gap is 0, before anything is solved
    ("contact", "i8"),  # which one; NONE for a joint or an end
    ("status", "i8"), ("since", "i8"),  # tick at which it was last solved
    ("gap", "f8"), ("rate", "f8"),  # of the gap
    ("force", "f8"),  # on the right segment
    ("speed", "f8"),  # of the left segment's right end
    ("impulse", "f8"), ("work", "f8"),  # energy handed from left to right
    ("lever", "f8"),  # integral of the force times the tick at which it acts
    ("peak", "f8"),  # largest force that lasted longer than the window
    ("first", "i8"), ("last", "i8"),  # when the first force began, the last one ended, or NONE
    ("opened", "i8"),  # when the gap last opened after a force, or NONE
    ("pressed", "i8"),  # ticks under force
    ("episodes", "i8"),  # how often a closed contact began to press
], align=True)
LINE = np.dtype([
    ("arrived", "f8"),  # wave at the receiving end
    ("first", "i8"), ("head", "i8"),  # row of the log: at t = 0, next to arrive; NONE if none is
    ("due", "i8"),  # when that arrives; IDLE if none is under way
    ("tail", "i8"),  # last sent; NONE for lines that lead outside
], align=True)
ROW = np.dtype([
    ("tick", "i8"), ("value", "f8"),  # when a front left its end, and the wave behind it
    ("after", "i4"),  # next front of its line, or NONE
    ("line", "i4"),
], align=True)
"""Row of the log: a front; if `line` is CHANGE the node `after` changed to the status `value`."""
CHANGE = -1

PIECE = np.dtype([*SPAN.descr, ("known", "f8"), ("velocity", "f8"), ("strain", "f8")], align=True)
"""A piece of constant state, and a duration of which `known` was the last member's: transit times,
times from the left end of a segment to its jumps, and those at which drives jump."""

PART = np.dtype([
    # of the segment left of a node
    ("before", "f8"), ("after", "f8"),  # velocities at t = 0 and at the end, m/s
    ("momentum", "f8"),  # of its motion in the frame at t = 0, kg m/s
    ("parted", "f8"),  # largest difference of its two waves, m/s
    # of the node
    ("impulse", "f8"), ("carried", "f8"),  # N s, and integrated over time, N s^2
    ("peak_force", "f8"), ("duration", "f8"),  # N, s
    ("episodes", "i4"),
    # of the run, told at its first node
    ("stop", "i1"), ("proved", "i1"),  # 1: nothing meets again
    ("vibration", "f8"), ("time", "f8"), ("frame", "f8"),  # energy left, J; its end, s; m/s
], align=True)
"""What a member of a family comes to, by node."""

RUN = np.dtype([
    ("until", "f8"),  # s; without an end, minus the share of `HORIZON` for which there is room
    ("limit", "i8"),  # events
    ("reads", "i8"),  # 1: waves are read
    ("further", "i8"),  # 1: it runs on for a round trip, and what balances need is added up, too
    ("lasting", "i8"),  # 1: after the proof momenta go on to change, by bonds and endless bars
    ("beside", "i8"),  # 1: transit times that the clock rounds are a tick beyond the true ones
    ("member", "i8"), ("row", "i8"),  # which one runs, and where its numbers begin
    ("late", "i8"),  # how often what drives its ends jumps
    ("longest", "f8"),  # transit time, s
    ("bits", "i8"), ("total", "i8"),  # ticks of the longest transit: about 2^bits
    ("tick", "f8"), ("frame", "f8"), ("scale", "f8"), ("horizon", "f8"),  # s, m/s, m/s, s
    ("tolerance", "f8"),  # smallest change of a wave that is a front
    ("window", "i8"),  # ticks by which a closing may move to an arrival
    ("target", "i8"),  # tick to run to, or if negative ticks to run on after the proof
    ("short", "i8"),  # segment with the shortest transit
    ("absolute", "f8"),  # sum of the absolute momenta of all waves at t = 0, kg m/s
    ("fastest", "f8"),  # largest absolute wave, m/s
    ("now", "i8"), ("rows", "i8"), ("started", "i8"),  # rows that fill the segments at t = 0
    ("events", "i8"), ("probe", "i8"), ("rest", "i8"),  # when, and after how many, to try a proof
    ("proved", "i8"), ("stop", "i8"),
], align=True)
