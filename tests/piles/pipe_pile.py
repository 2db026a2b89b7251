"""A steel pipe pile under a Vulcan 010 hammer, as it stands in the literature."""

import math

import rodimpact as ri

STEEL = ri.Material("pile steel", youngs_modulus=200e9, density=78.5e3 / 9.81)
WALL = 0.009525  # m
DIAMETER = 0.3239  # m, outside
AREA = math.pi * WALL * (DIAMETER - WALL)  # m^2
LENGTH = 15.0  # m
QUAKE = 2.5e-3  # m
CUSHION = 5e8  # N/m
RAM = ri.RigidMass(4536.19, velocity=3.466251)


def pipe_pile(law, helmet=None, head=None):
    """The system of ram, helmet if there is one, pile and wall below the toe.

    Half of the resistance of 600 kN acts along the shaft, by a law of `ri.Soil`:
    "smith" or "viscous". `head` is the contact of helmet and pile, rigid by default.
    """
    soil = ri.Soil(300e3, QUAKE, damping=0.16, law=law)
    pile = ri.Rod(LENGTH, area=AREA, material=STEEL, shaft=soil)
    toe = ri.SmithToe(300e3, QUAKE, damping=0.5)
    cushion = ri.Cushion(CUSHION, restitution=0.8)
    if helmet is None:
        return ri.System([RAM, pile, ri.Wall()], contacts=[cushion, toe])
    if head is None:
        head = ri.Rigid()
    bodies = [RAM, helmet, pile, ri.Wall()]
    return ri.System(bodies, contacts=[cushion, head, toe])
