"""What becomes of the vibration that a collision leaves: it dies out in damped material.

The energy of a row falls from that after the impact to that of the rigid motion of its bodies,
whose momentum stays. A mode of angular frequency omega in a rod of one Kelvin-Voigt material decays
as exp(-eta omega^2 t/(2E)), and its energy twice as fast (A. D. Nashif, D. I. G. Jones and
J. P. Henderson, Vibration Damping, Wiley 1985, ch. 3); so high modes go first and the
lowest one of the longest lasting rod remains.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..methods.grid.mesh import lasting_mode
from ..methods.signals import Floats
from ..model.frozen import refusal
from .energy import bonded_groups
from .fields import Fields

SAMPLES, FEWEST = 400, 50
TAIL = 3  # the decay is read off the last third
ENOUGH = 1e-12  # of the energy of the motion, below which vibration is round-off


@dataclass(frozen=True)
class RingDown:
    """How vibration dies out after a collision.

    Attributes
    ----------
    times : [n] array
        s, from the proof that the collision is over to the end of the solution.
    vibration : [n] array
        Kinetic and strain energy relative to the rigid motion, J.
    rigid : float
        Energy of the rigid motion, J, to which the total falls.
    momentum_change : float
        Largest change of the momentum of the row, relative to the momenta of its bodies together.
    decay_time : float
        Time in which the vibration energy falls to 1/e, s, over the last third; inf if it does not.
    modal_decay_time : float
        The same of the mode that lasts longest, s, of the rods each free by itself: E/(eta omega^2)
        for a uniform one; inf without damping.
    body : int
        The rod of that mode.
    frequency : float
        Of that mode, Hz.

    Examples
    --------
    >>> import rodimpact as ri
    >>> lossy = ri.materials.steel.damped(loss_factor=0.02, frequency=5e3)
    >>> rods = [ri.Rod(length, area=1e-4, material=lossy, velocity=v)
    ...         for length, v in ((0.4, 1.0), (1.0, 0.0))]
    >>> found = ri.solve(ri.System(rods), until=5e-3, cells=50).ring_down()
    >>> found.body, bool(found.vibration[-1] < found.vibration[0])
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
    """Read how vibration dies out from `start` to `end`, s; see `Solution.ring_down`."""
    even = np.linspace(start, end, SAMPLES + 1)
    ticks = np.unique(fields.nearest_known(fields.to_ticks(even)))
    if len(ticks) < FEWEST and end - start > FEWEST * fields.step:
        message = f"only {len(ticks)} states were kept after the collision"
        raise refusal(
            "ring_down", f"{message}; leave snapshots out, or give more of them"
        )
    times = ticks * fields.clock.tick
    states = bonded_groups(fields, ticks)
    rigid, vibration = states.kinetic, states.vibration.sum(axis=0)
    masses = [fields.clock.mass(i) for group in states.bodies for i in group]
    scale = sum(m * math.sqrt(2 * (rigid + vibration).max() / m) for m in masses)
    modes = {i: lasting_mode(rod.segments) for i, rod in fields.rods.items()}
    slowest = max(
        (1 / (2 * rate) if rate > 0 else math.inf, i, omega / (2 * math.pi))
        for i, (omega, rate) in modes.items()
    )
    return RingDown(
        times,
        vibration,
        float(rigid[-1]),
        float(np.ptp(states.momentum)) / scale if scale else 0.0,
        _decay_time(times, vibration, ENOUGH * float(rigid.max() + vibration.max())),
        *slowest,
    )


def _decay_time(times: Floats, vibration: Floats, least: float) -> float:
    """Of the straight line through the logarithm of the last third."""
    audible = vibration > least
    t, E = times[audible], vibration[audible]
    late = t >= t[0] + (t[-1] - t[0]) * (1 - 1 / TAIL) if len(t) else t
    if np.count_nonzero(late) < 3:
        return math.inf
    rate = -float(np.polyfit(t[late] - t[0], np.log(E[late]), 1)[0])
    return 1 / rate if rate > 1e-9 / (t[-1] - t[0]) else math.inf
