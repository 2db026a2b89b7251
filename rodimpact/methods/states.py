"""States that kernels hold as whole numbers.

They are those of what is beyond an end, of a link, and of a run. In files and in
kernels these are whole numbers; only their order here has a meaning. Kernels compare by
it where a statement holds for several states; each class says what its bounds mean.
"""

from enum import IntEnum


class BoundaryKind(IntEnum):
    """What is beyond an end of the row."""

    STEADY = 0  # nothing, or a wall
    MOVED = 1  # a velocity over time
    PUSHED = 2  # a force
    ENDLESS = 3  # a bar, with a wave that comes in


class Status(IntEnum):
    """What a link does.

    The order counts: >= OPEN is a contact that can open, and < OPEN a link that is
    none; >= GRAZE is closed, and has pressed since it closed; >= PRESS has a force that
    follows from its state.
    """

    FREE = 0  # an end that nothing acts on
    BOND = 1  # it cannot open
    PUSH = 2  # an end under a given force
    OPEN = 3  # a gap, or parting
    TOUCH = 4  # closed, not yet pressed since it closed
    GRAZE = 5  # closed, pressed before, without force now
    PRESS = 6
    PLASTIC = 7  # it presses, and yields
    REST = 8  # rigid bodies that lie on each other


class Stop(IntEnum):
    """Why a run returns.

    The order counts: < DONE has not ended, and goes on; >= DONE has; >= OVERFLOW has no
    result, and the member is refused.
    """

    NONE = 0  # it goes on, or is not laid out
    FULL = 1  # no room in the log
    CHECK = 2  # a proof of finality is due
    DONE = 3  # the time asked for is reached
    FINAL = 4  # proved, and run on
    CAP = 5  # more events than the limit
    CLOCK = 6  # its ticks are over
    OVERFLOW = 7  # no clock: the energy of such velocities and strains is no float
    LONG = 8  # the time asked for takes more ticks than a clock has
    SHORT = 9  # a transit time is too few ticks
    STUCK = 10  # no solution: a mass between closing walls
