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
    """The masses of a pile, their springs, and the soil at each of them.

    There are as many springs as segments, and one mass more: [mass] from the head to
    the toe. The two at the ends have half the mass and half the soil of the others.
    """

    def __init__(self, pile, segments):
        """`segments` springs and one mass more, at rest; the end masses, and the shares
        of the shaft at them, are half as large as the others.
        """
        self.pile = pile
        cell = pile.length / segments
        share = np.full(segments + 1, 1 / segments)
        share[[0, -1]] /= 2
        mass_of_cell = pile.density * pile.area * cell
        mass = np.full(segments + 1, mass_of_cell)
        mass[[0, -1]] /= 2
        self.mass = mass  # kg
        self.stiffness = pile.modulus * pile.area / cell  # N/m, of each spring
        self.ultimate = pile.shaft_resistance * share  # N, of the soil at each mass
        self.u = np.zeros(segments + 1)  # displacements, m
        self.resistance = np.zeros(segments + 1)  # N, static, as blows have left it
        self.toe_set = 0.0  # m, by all blows so far

    def strike(self, duration, step):
        """Integrate a blow of `duration` in steps of `step`, s; return a `LumpedBlow`.

        Each step takes velocities first, then displacements. The pile begins at rest,
        as the blow before has left it, and the ram at its head.
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
            head = u[0]
            toe_displacement = u[-1]
            cushion = max(0.0, pile.cushion * (ram - head))
            static_toe = toe_stiffness * max(0.0, toe_displacement - toe_set)
            damping_factor = 1 + pile.toe_damping * v[-1]
            toe = max(0.0, static_toe * damping_factor)
            damped = np.abs(resistance)
            if pile.is_viscous:
                damped = self.ultimate
            damping = pile.shaft_damping * damped  # N s/m, at each mass
            pulled_down = np.append(tension, 0.0)  # by the spring below each mass
            pulled_up = np.append(0.0, tension)  # by the spring above it
            force = pulled_down - pulled_up
            force[0] += cushion
            force[-1] -= toe
            # m (v - v_before)/step = force - resistance - damping (v + v_before)/2
            v_before = v
            half_damping = step * damping / 2
            kept_momentum = v_before * (mass - half_damping)
            impulse = step * (force - resistance)
            v = (kept_momentum + impulse) / (mass + half_damping)
            mean = (v + v_before) / 2
            soil_force = resistance + damping * mean
            soil_work += step * float(soil_force @ mean)
            ram_velocity -= step * cushion / pile.ram_mass
            u = u + step * v
            ram += step * ram_velocity
            elastic = resistance + soil_stiffness * step * v
            resistance = np.clip(elastic, -self.ultimate, self.ultimate)
            toe_set = max(toe_set, u[-1] - pile.quake)
        set_of_blow = toe_set - self.toe_set
        self.u = u
        self.resistance = resistance
        self.toe_set = toe_set
        return LumpedBlow(set_of_blow, float(u[-1]), soil_work, largest)


def strike(pile, segments, duration, step):
    """The first blow on a pile: a `LumpedBlow`."""
    return Chain(pile, segments).strike(duration, step)


def strike_again(pile, count, segments, duration, step):
    """Sets of the toe, m, by each of `count` blows one after the other.

    The pile has to come to rest within `duration`, s, of each.
    """
    chain = Chain(pile, segments)
    sets = []
    for _ in range(count):
        blow = chain.strike(duration, step)
        sets.append(blow.toe_set)
    return sets
