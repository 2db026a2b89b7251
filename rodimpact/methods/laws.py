"""Kinds of links, as every method counts them: what stands between two bodies, or at an end."""

FREE, FORCE, BOND, JOINT, RIGID, IMPACT, SPRING, HERTZ, HUNT, POWER, YIELD, OWN = range(12)
"""From RIGID on they can open."""
COMPLIANT = {  # and their names in the model
    "spring": SPRING, "spring-dashpot": SPRING, "hertz": HERTZ, "hunt-crossley": HUNT,
    "power": POWER,
}
