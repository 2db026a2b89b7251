"""What acts between two neighbours, or on an end, as every method counts it."""

from enum import IntEnum


class Law(IntEnum):
    """What acts in a link."""

    BOND = 0
    PUSH_LEFT = 1  # the force of what stands outside the left end, none at a free one
    PUSH_RIGHT = 2
    JOINT = 3
    RIGID = 4  # from here on links can open
    IMPACT = 5  # between rigid bodies: momentum jumps
    SPRING = 6
    POWER = 7
    YIELD = 8
    OWN = 9  # a function of the user
