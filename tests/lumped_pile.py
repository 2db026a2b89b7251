"""A pile as Smith's chain of lumped masses, without code of the package."""

from dataclasses import dataclass

import numpy as np


@dataclass
class LumpedPile:
    """A ram, a cushion and a pile in soil: masses, springs, and Smith's soil at each of
    them.

    Attributes
    ----------
    ram_mass, ram_velocity : float
        kg and m/s.
    cushion : float
        Stiffness of an elastic cushion that pushes and does not pull, N/m.
    length, area, modulus, density : float
        Of the pile, SI.
    shaft_resistance, toe_resistance : float
        N, that of the shaft spread evenly.
    quake : float
        m, of shaft and toe.
    shaft_damping, toe_damping : float
        J, s/m.
    is_viscous : bool
        Whether the damping of the shaft is in proportion to the ultimate resistance.
    """

    ram_mass: float
    ram_velocity: float
    cushion: float
    length: float
    area: float
    modulus: float
    density: float
    shaft_resistance: float
    toe_resistance: float
    quake: float
    shaft_damping: float = 0.0
    toe_damping: float = 0.0
    is_viscous: bool = False


@dataclass
class LumpedBlow:
    """What a blow did."""

    toe_set: float  # m
    toe_displacement: float  # m, at the end
    soil_work: float  # J, taken by the soil at the shaft
    largest_compression: float  # N, in the pile


class Chain:
    """The masses of a pile, their springs, and the soil at each of them."""

    def __init__(self, pile, segments):
        self.pile = pile
        cell = pile.length / segments
        mass = np.full(segments + 1, pile.density * pile.area * cell)
        mass[[0, -1]] /= 2
        share = np.full(segments + 1, 1 / segments)
        share[[0, -1]] /= 2
        self.mass = mass
        self.stiffness = pile.modulus * pile.area / cell
        self.ultimate = pile.shaft_resistance * share
        self.u = np.zeros(segments + 1)
        self.resistance = np.zeros(segments + 1)
        self.toe_set = 0.0

    def strike(self, duration, step):
        """Integrate a blow in steps of so many seconds: velocities first, then
        displacements.

        The pile begins at rest, as the blow before has left it, and the ram at its
        head.
        """
        pile = self.pile
        soil_stiffness = self.ultimate / pile.quake
        toe_stiffness = pile.toe_resistance / pile.quake
        mass = self.mass
        u = self.u
        v = np.zeros(len(u))
        resistance = self.resistance
        toe_set = self.toe_set
        ram = u[0]
        ram_velocity = pile.ram_velocity
        soil_work = 0.0
        largest = 0.0
        for _ in range(round(duration / step)):
            tension = self.stiffness * np.diff(u)
            largest = max(largest, float(-tension.min()))
            cushion = max(0.0, pile.cushion * (ram - u[0]))
            toe = toe_stiffness * max(0.0, u[-1] - toe_set)
            toe = max(0.0, toe * (1 + pile.toe_damping * v[-1]))
            damped = np.abs(resistance)
            if pile.is_viscous:
                damped = self.ultimate
            damping = pile.shaft_damping * damped
            force = np.concatenate((tension, [0.0])) - np.concatenate(([0.0], tension))
            force[0] += cushion
            force[-1] -= toe
            before = v
            v = (v * (mass - step * damping / 2) + step * (force - resistance)) / (
                mass + step * damping / 2
            )
            mean = (v + before) / 2
            soil_work += step * float((resistance + damping * mean) @ mean)
            ram_velocity -= step * cushion / pile.ram_mass
            u = u + step * v
            ram += step * ram_velocity
            resistance = np.clip(
                resistance + soil_stiffness * step * v, -self.ultimate, self.ultimate
            )
            toe_set = max(toe_set, u[-1] - pile.quake)
        set_of_blow = toe_set - self.toe_set
        self.u = u
        self.resistance = resistance
        self.toe_set = toe_set
        return LumpedBlow(set_of_blow, float(u[-1]), soil_work, largest)


def strike(pile, segments, duration, step):
    """The first blow on a pile."""
    return Chain(pile, segments).strike(duration, step)


def strike_again(pile, count, segments, duration, step):
    """Sets of the toe by blows one after the other, each so long that the pile rests,
    m.
    """
    chain = Chain(pile, segments)
    return [chain.strike(duration, step).toe_set for _ in range(count)]
