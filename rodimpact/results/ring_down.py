"""Decay of the vibration that a collision leaves, in damped material.

After the impact the energy of a row falls to the energy of the rigid motion of its
bodies, whose momentum is conserved. A mode of angular frequency omega in a rod of one
Kelvin-Voigt material decays as exp(-eta omega^2 t/(2E)), and its energy twice as fast
(A. D. Nashif, D. I. G. Jones and J. P. Henderson, Vibration Damping, Wiley 1985, ch.
3). So high modes decay first, and the lowest mode of one of the rods decays last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..hints import explain_missing
from ..methods.grid.mesh import lasting_mode
from ..methods.signals import Floats
from ..model.frozen import invalid_argument
from .energy import BondedGroups, bonded_groups
from .fields import Fields

DECAY_SAMPLES = 400  # number of intervals between the times of the vibration energies
MIN_DECAY_SAMPLES = 50  # a grid that kept fewer states is refused
UNFITTED_SHARE = 1 - 1 / 3
"""Share of the record before its last third: this last third is fitted."""
VIBRATION_RTOL = 1e-12  # vibration below this share of all energy is round-off
DECAY_RATE_RTOL = 1e-9  # slower decay, relative to one over the record, is round-off


@explain_missing()
@dataclass(frozen=True)
class RingDown:
    """Decay of the vibration after a collision.

    Attributes
    ----------
    times : [n] array
        s, from the proof that the collision is over to the end of the solution.
    vibration : [n] array
        Kinetic and strain energy relative to the rigid motion, J.
    rigid : float
        Energy of the rigid motion, J; the total energy tends to this value.
    momentum_change : float
        Largest change of the momentum of the row, relative to the sum of the momenta of
        its bodies.
    decay_time : float
        Time in which the vibration energy falls to 1/e, s, from the last third of the
        times; inf if it does not fall.
    modal_decay_time : float
        Time in which the energy of the slowest mode falls to 1/e, s, for free rods:
        E/(eta omega^2) for a uniform rod; inf without damping.
    body : int
        The rod of the slowest mode.
    frequency : float
        Frequency of the slowest mode, Hz.

    Examples
    --------
    >>> import rodimpact as ri
    >>> lossy = ri.materials.steel.damped(loss_factor=0.02, frequency=5e3)
    >>> rods = [ri.Rod(length, area=1e-4, material=lossy, velocity=v)
    ...         for length, v in ((0.4, 1.0), (1.0, 0.0))]
    >>> ringing = ri.solve(ri.System(rods), until=5e-3, cells=50).ring_down()
    >>> ringing.body, bool(ringing.vibration[-1] < ringing.vibration[0])
    (1, True)
    """

    times: Floats
    vibration: Floats
    rigid: float
    momentum_change: float
    decay_time: float
    modal_decay_time: float
    body: int
    frequency: float

    def __str__(self) -> str:
        from ..storage.report import ring_down_table

        return ring_down_table(self)


def ring_down(fields: Fields, start: float, end: float) -> RingDown:
    """Decay of the vibration from time `start` to `end`, s; see `Solution.ring_down`.

    Energies are taken at `DECAY_SAMPLES` + 1 equally spaced times, or at the states of
    a grid nearest to them. The decay time is fitted to them. It is compared with the
    mode that decays most slowly among those of all rods, each free by itself. The row
    must have a rod. InvalidModel is raised if a grid has kept fewer than
    `MIN_DECAY_SAMPLES` states of more steps than that.
    """
    even_times = np.linspace(start, end, DECAY_SAMPLES + 1)
    known_ticks = fields.nearest_energy_ticks(fields.to_ticks(even_times))
    ticks = np.unique(known_ticks)  # several times may have the same nearest state
    # Few states are a mistake only if the grid took more steps than it kept: a short
    # time may have few steps, all of which were kept.
    had_more_steps = end - start > MIN_DECAY_SAMPLES * fields.step
    if len(ticks) < MIN_DECAY_SAMPLES and had_more_steps:
        message = (
            f"only {len(ticks)} states were kept after the collision; leave snapshots "
            "out, or give more of them"
        )
        raise invalid_argument("ring_down", message)
    times = ticks * fields.clock.tick
    groups = bonded_groups(fields, ticks)
    # Vibration energy of all bodies, J [time]. `groups.kinetic` [time] is the kinetic
    # energy of the centres of mass of all groups.
    vibration = groups.vibration.sum(axis=0)
    largest_energy = float(groups.kinetic.max() + vibration.max())
    round_off = VIBRATION_RTOL * largest_energy
    slowest = _slowest_mode(fields)
    return RingDown(
        times=times,
        vibration=vibration,
        rigid=float(groups.kinetic[-1]),
        momentum_change=_momentum_change(fields, groups, vibration),
        decay_time=_decay_time(times, vibration, round_off),
        modal_decay_time=slowest.decay_time,
        body=slowest.body,
        frequency=slowest.frequency,
    )


class RodMode(NamedTuple):
    """A mode of vibration of a rod."""

    decay_time: float  # time in which its energy falls to 1/e, s
    body: int
    frequency: float  # Hz


def _slowest_mode(fields: Fields) -> RodMode:
    """The mode whose decay time is the longest, of all rods, each free by itself.

    The decay time is inf without damping. There must be a rod. Among rods with equal
    decay times it is the mode of the last one.
    """
    modes = []
    for body, rod in fields.rods.items():
        # Angular frequency, rad/s, and decay rate of the amplitude, 1/s
        omega, amplitude_rate = lasting_mode(rod.segments)
        decay_time = math.inf
        if amplitude_rate > 0:
            # The energy decays twice as fast as the amplitude.
            decay_time = 1 / (2 * amplitude_rate)
        frequency = omega / (2 * math.pi)
        modes.append(RodMode(decay_time, body, frequency))
    return max(modes)  # by the first field, the decay time, then by the body


def _momentum_change(fields: Fields, groups: BondedGroups, vibration: Floats) -> float:
    """Largest change of the row's momentum, divided by a scale; 0 if nothing moves.

    The scale is the sum over the movable bodies of m sqrt(2 E/m), the momentum of a
    body of mass m with all the energy E of the row. E is the largest sum of kinetic
    energy and `vibration`, J [time].
    """
    largest_energy = (groups.kinetic + vibration).max()
    scale = 0.0  # kg m/s
    for group in groups.movable_bodies:
        for body in group:
            mass = fields.clock.mass(body)
            scale += mass * math.sqrt(2 * largest_energy / mass)
    if scale == 0:
        return 0.0
    largest_change = float(np.ptp(groups.momentum))  # largest less smallest
    return largest_change / scale


def _decay_time(times: Floats, vibration: Floats, round_off: float) -> float:
    """Time, s, in which the vibration energy, J [time], falls to 1/e.

    A straight line, log(vibration) = constant - rate t, is fitted in the last third of
    the record; the time is 1/rate. Energies of no more than `round_off`, J, are left
    out before. The time is inf if the vibration does not fall, or if fewer than three
    energies are left in this third.
    """
    is_counted = vibration > round_off
    t = times[is_counted]
    energy = vibration[is_counted]
    if len(t) == 0:
        return math.inf
    duration = t[-1] - t[0]
    is_late = t >= t[0] + duration * UNFITTED_SHARE
    if np.count_nonzero(is_late) < 3:
        return math.inf
    since_start = t[is_late] - t[0]
    # The degree 1 is a straight line.
    slope, _ = np.polyfit(since_start, np.log(energy[is_late]), 1)
    rate = -float(slope)  # 1/s
    lowest_rate = DECAY_RATE_RTOL / duration  # 1/s; slower decay is round-off
    if rate > lowest_rate:
        return 1 / rate
    return math.inf
