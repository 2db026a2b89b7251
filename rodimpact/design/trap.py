"""A momentum trap: a rod behind a bar that takes over what arrives after the first pulse.

At its free end the bar throws the first pulse back, and that end has moved by the integral of its
velocity. A rod that lies just so far behind is met as the pulse has gone: what arrives next finds
no end but more bar, and runs over. Faces push and never pull, so the rod leaves with what its own
free end throws back; it is long enough if that comes no sooner than the last of what it is to take.
In a tension bar this gap lies between flange and trap: S. Nemat-Nasser, J. B. Isaacs and
J. E. Starrett, Proceedings of the Royal Society A 435 (1991) 371. Without a gap the rod takes the
first pulse, as one behind a transmission bar does.
"""

from typing import Any

import numpy as np

from ..model import Free, Material, Rigid, Rod, System
from ..model.arguments import of_kind, single
from ..model.frozen import refusal
from ..results.solution import Solution
from ..running.solving import solve
from .pulses import PulseDesign, differences, staircase

FAINTEST = 1e-3  # of the peak force: a trap need not be longer for less
ROUND_OFF = 1e-9  # of times and displacements


def momentum_trap(
    system: System,
    *,
    until: float,
    after: float = 0.0,
    material: Material | None = None,
) -> PulseDesign:
    """Find the rod behind a row that takes the waves that arrive there after the first pulse.

    Parameters
    ----------
    system : System
        The row without the trap. Its last body is a rod with a free right end.
    until : float
        The trap takes all waves that arrive up to this time, s.
    after : float
        Time at which the first pulse has left the right end, s; 0 for a trap that takes it, too.
    material : Material, optional
        Of the trap; by default that of the bar. Its area makes the impedance equal.

    Returns
    -------
    PulseDesign
        `wanted` and `reached` are the wave that runs back from the right end into the bar, N. From
        `after` on it should be 0; `misfit` is its size then, over the largest wave that arrives.

    Raises
    ------
    InvalidModel or ValueError
        If an argument is wrong; if the right end would have hit the trap before `after`; or if no
        pushing wave arrives between `after` and `until`.

    Examples
    --------
    The striker's pulse goes to and fro in the bar; its second push leaves with the trap, whose gap
    is what the striker would have moved in that time, and which is as long as the striker:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0)
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> c = steel.wave_speed
    >>> found = momentum_trap(ri.System([striker, bar]), after=1.4 / c, until=3.4 / c)
    >>> round(found.system.gaps[1] / (10.0 * 0.4 / c), 9), round(found.system.bodies[2].length, 9)
    (1.0, 0.2)
    >>> round(found.misfit, 9)
    0.0
    """
    of_kind("system", system, System, "System([striker, bar])")
    bar = system.bodies[-1]
    if not isinstance(bar, Rod) or not isinstance(system.ends[1], Free):
        raise refusal("system", "must end on the right with a rod whose end is Free()")
    end = single("until", until, "s", "positive")
    passed = single("after", after, "s")
    if not 0 <= passed < end:
        raise refusal(
            "after", f"must be from 0 to before until = {end!r} s, got {passed!r}"
        )
    steel = bar.segments[-1].material if material is None else material
    of_kind("material", steel, Material, "materials.steel")

    alone, last = solve(system, until=end), len(system.bodies) - 1
    times, arriving, returned = _waves(alone, last)
    before = times < passed * (1 - ROUND_OFF)
    place = alone.displacement(last, float(bar.length), [0.0, *times[before], passed])
    gap, furthest = float(place[-1] - place[0]), float(place.max() - place[0])
    if furthest > gap + ROUND_OFF * float(np.ptp(place)):
        message = f"the right end is at {gap:.6g} m at {passed!r} s, and was at {furthest:.6g} m"
        raise refusal(
            "after", f"{message} before; take the time at which it is furthest"
        )

    area = float(bar.segments[-1].impedance) / float(steel.density * steel.wave_speed)

    def behind(length: float) -> System:
        trap = Rod(length, area=area, material=steel)
        return System(
            [*system.bodies, trap],
            [*system.gaps, max(gap, 0.0)],
            [*system.contacts, Rigid()],
            gravity=system.gravity,
            ends=system.ends,
        )

    c = float(steel.wave_speed)
    breaks, force, _ = solve(behind(c * end), until=end).contacts[-1].breakpoints()
    due = (breaks >= passed * (1 - ROUND_OFF)) & (breaks < end)
    pressed = np.flatnonzero(due & (force > FAINTEST * force.max()))
    if not pressed.size:
        message = f"nothing pushes on the right end from {passed!r} to {end!r} s"
        raise refusal("until", f"{message}; take a later time")
    released = min(end, float(np.append(breaks, end)[pressed[-1] + 1]))
    found = behind(c * (released - float(breaks[pressed[0]])) / 2)

    times_now, _, reached = _waves(solve(found, until=end), last)
    got = staircase(times_now, reached, end, "force of the wave back into the bar")
    wanted = staircase(
        [*times[before], passed], [*returned[before], 0.0], end, "wanted"
    )
    (mean,), (variance,) = differences(wanted, got, np.array([passed, end]))
    misfit = float(np.sqrt(mean**2 + variance) / np.abs(arriving).max())
    return PulseDesign(found, last + 1, wanted, got, misfit, 0.0)


def _waves(solution: Solution, body: int) -> tuple[Any, ...]:
    """Times, and forces, N, of the waves that come to the right end of a rod and that leave it."""
    rod = solution.system.bodies[body]
    assert isinstance(rod, Rod)
    piece, gauge = rod.segments[-1], solution.gauge(body, float(rod.length))
    stiffness = float(piece.impedance * piece.wave_speed)
    return gauge.times, -stiffness * gauge.rightward, -stiffness * gauge.leftward
