"""What stands between two bodies or at an end, as every method counts it."""

from enum import IntEnum


class Law(IntEnum):
    """Of a link. From RIGID on it can open."""

    FREE = 0
    FORCE = 1
    BOND = 2
    JOINT = 3
    RIGID = 4
    IMPACT = 5  # between rigid bodies: momentum jumps
    SPRING = 6
    HERTZ = 7
    HUNT = 8
    POWER = 9
    YIELD = 10
    OWN = 11  # a function of the user


FREE, FORCE, BOND, JOINT, RIGID, IMPACT, SPRING, HERTZ, HUNT, POWER, YIELD, OWN = Law
COMPLIANT = {  # and their names in the model
    "spring": SPRING, "spring-dashpot": SPRING, "hertz": HERTZ, "hunt-crossley": HUNT,
    "power": POWER,
}
