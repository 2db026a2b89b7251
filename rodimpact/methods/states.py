"""States that kernels and files hold as whole numbers: of an end, a link and a run.

The order of the states has a meaning: kernels compare states where a statement holds
for several of them. Each class says what its bounds mean.
"""

from enum import IntEnum


class BoundaryKind(IntEnum):
    """The kind of boundary beyond an end of the row."""

    STEADY = 0  # nothing, a wall or a fixed end
    MOVED = 1  # a given velocity over time
    PUSHED = 2  # a given force over time
    ENDLESS = 3  # a semi-infinite bar, through which a wave may arrive


class Status(IntEnum):
    """The status of a link.

    The order has a meaning. < OPEN: no contact, or one that cannot open. >= OPEN: a
    contact that can open. >= GRAZE: closed, and it has pressed since it closed.
    >= PRESS: its force follows from its state.
    """

    FREE = 0  # a free end
    BOND = 1  # a link that cannot open
    PUSH = 2  # an end under a given force
    OPEN = 3  # there is a gap, or it opens
    TOUCH = 4  # closed; it has not pressed since it closed
    GRAZE = 5  # closed, without force; it has pressed since it closed
    PRESS = 6  # closed, with a force
    PLASTIC = 7  # it presses, and yields
    REST = 8  # rigid bodies that rest against each other


class Stop(IntEnum):
    """The reason why a run stops.

    The order has a meaning. < DONE: the run has not ended, and can go on. >= DONE: it
    has ended. >= OVERFLOW: it has no result, and the member is refused.
    """

    NONE = 0  # it has not stopped, or not begun
    FULL = 1  # there is no room in the log
    CHECK = 2  # a proof of finality is due
    DONE = 3  # the given end is reached
    FINAL = 4  # the collision is proved final, and the run has gone on for some time
    CAP = 5  # the largest number of events is reached
    CLOCK = 6  # the last tick of the clock is reached
    OVERFLOW = 7  # energies could exceed the largest float
    LONG = 8  # the run takes more ticks than a clock has
    SHORT = 9  # a transit time has too few ticks
    STUCK = 10  # there is no solution: walls squeeze a rigid mass
