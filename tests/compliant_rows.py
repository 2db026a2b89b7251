"""Random rows for comparison with the method of steps: uniform rods, masses, walls, all
laws.
"""

from itertools import pairwise

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

SLOW = ri.Material("slow", youngs_modulus=1.0, density=1.0)
QUICK = ri.Material("quick", youngs_modulus=3.0, density=1.5)
KINDS = ("power", "dashpot", "yielding", "mixed")
"""Laws of a row: powers of the overlap, such with dashpots, yielding ones, or any of
these and rigid contacts.
"""


def between(rng, low, high):
    """A random number between two, its logarithm evenly distributed."""
    exponent = rng.uniform(np.log(low), np.log(high))
    return float(np.exp(exponent))


def random_contact(rng, kind):
    """A contact law of a kind, for rods with impedances and transit times of the order
    of 1.
    """
    stiffness = between(rng, 0.05, 300.0)
    choice = rng.integers(3)
    if kind == "power":
        if choice == 0:
            return ri.Spring(stiffness)
        if choice == 1:
            return ri.Hertz(stiffness)
        exponent = float(rng.uniform(1.0, 4.0))
        return ri.PowerLaw(stiffness, exponent=exponent)
    if kind == "dashpot":
        if choice < 2:
            damping = between(rng, 0.02, 5.0)
            return ri.SpringDashpot(stiffness, damping=damping)
        damping = between(rng, 0.05, 2.0)
        return ri.HuntCrossley(stiffness, damping=damping)
    hardening = float(rng.choice([0.0, 0.1, 0.6])) * stiffness
    yield_force = between(rng, 0.03, 0.5)
    return ri.Yielding(stiffness, yield_force, hardening)


def uniform_rod(rng, speed):
    """A uniform rod of random length, section and material with a velocity, m/s."""
    length = float(rng.uniform(0.3, 1.0))
    area = between(rng, 0.3, 3.0)
    material = SLOW if rng.random() < 0.7 else QUICK
    return ri.Rod(length, area=area, material=material, velocity=speed)


def random_law_between(rng, kind, before, behind):
    """A contact law of a kind that may stand between two bodies.

    Of the kind "mixed" it is of any kind, or rigid; a rigid one needs a rod beside it.
    """
    law_kind = kind
    if kind == "mixed":
        law_kind = str(rng.choice(["power", "dashpot", "yielding", "rigid"]))
    if law_kind != "rigid":
        return random_contact(rng, law_kind)
    if isinstance(before, ri.Rod) or isinstance(behind, ri.Rod):
        return ri.Rigid()
    return random_contact(rng, "power")


def random_compliant_row(kind, seed):
    """A row of a kind (see `KINDS`), and the time to which to run it, s.

    It has two or three rods; a mixed one perhaps a mass; perhaps a wall on the right.
    The first rod moves at 1 m/s and no rod is faster, so that something meets.
    """
    rng = default_rng([KINDS.index(kind), seed])
    bodies = []
    for i in range(rng.integers(2, 4)):
        any_speed = rng.uniform(-1, 1)
        speed = float(rng.choice([0.0, -0.5, any_speed]))
        if i == 0:
            speed = 1.0
        bodies.append(uniform_rod(rng, speed))
    if kind == "mixed" and rng.random() < 0.5:
        kilograms = between(rng, 0.1, 2.0)
        velocity = float(rng.uniform(-1, 1))
        mass = ri.RigidMass(kilograms, velocity=velocity)
        place = rng.integers(len(bodies) + 1)
        bodies.insert(place, mass)
    if rng.random() < 0.25:
        bodies.append(ri.Wall())
    contacts = []
    gaps = []
    for before, behind in pairwise(bodies):
        law = random_law_between(rng, kind, before, behind)
        contacts.append(law)
        gap = 0.0
        if rng.random() < 0.4:
            gap = float(rng.uniform(0, 0.3))
        gaps.append(gap)
    until = float(rng.uniform(2.0, 5.0))
    system = ri.System(bodies, gaps, contacts)
    return system, until
