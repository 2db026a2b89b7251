"""momentum_trap(): a rod behind a bar that takes over the waves after the first pulse.

At its free end the bar reflects the first pulse, and that end moves by the integral of
its velocity. A rod with a gap of this width is met when the pulse has left. The next
wave finds no free end but more bar, and runs into the rod. Faces push and never pull,
so the rod leaves with the wave that its own free end reflects. It is long enough if
this reflection comes back after the last wave that the rod is to take. In a tension bar
the gap lies between flange and trap: S. Nemat-Nasser, J. B. Isaacs and J. E. Starrett,
Proceedings of the Royal Society A 435 (1991) 371. Without a gap the rod takes the first
pulse, as one behind a transmission bar does.
"""

from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments
from ..model import Free, Material, Rigid, Rod, System
from ..model.arguments import check_kind, scalar
from ..model.frozen import InvalidModel, invalid_argument
from ..results.solution import Solution
from ..running.solving import solve
from .pulses import PulseDesign, differences, staircase

LEAST_FORCE_RTOL = 1e-3
"""A force below this part of the peak force does not make the trap longer."""
TIME_RTOL = 1e-9
"""Relative round-off of times."""
DISPLACEMENT_RTOL = 1e-9
"""Round-off of displacements, relative to their range."""


@explain_arguments
def momentum_trap(
    system: System,
    *,
    until: float,
    after: float = 0.0,
    material: Material | None = None,
) -> PulseDesign:
    """Find a rod behind a row that carries off the waves after the first pulse.

    Parameters
    ----------
    system : System
        The row without the trap. Its last body is a rod with a free right end.
    until : float
        The trap carries off all waves that arrive up to this time, s.
    after : float
        Time at which the first pulse has left the right end, s. With 0 the trap carries
        off the first pulse as well.
    material : Material, optional
        Material of the trap, by default that of the bar. The area of the trap is such
        that trap and bar have the same impedance.

    Returns
    -------
    PulseDesign
        `wanted` and `reached` are the force of the wave that the right end reflects
        into the bar, N. It should be 0 from the time `after`. `misfit` is the root mean
        square of this force from then on, over the largest wave that arrives.

    Raises
    ------
    InvalidModel or ValueError
        If an argument is invalid, if the right end would hit the trap before `after`,
        or if no compressive wave arrives between `after` and `until`.

    Examples
    --------
    The pulse of the striker runs to and fro in the bar. The trap carries off its second
    arrival. The trap is as long as the striker, and the gap is the distance that the
    striker would travel in the duration of the pulse:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0)
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> c = steel.wave_speed
    >>> design = momentum_trap(ri.System([striker, bar]), after=1.4 / c, until=3.4 / c)
    >>> round(design.system.gaps[1] / (10.0 * 0.4 / c), 9)
    1.0
    >>> round(design.system.bodies[2].length, 9)
    0.2
    >>> round(design.misfit, 9)
    0.0
    """
    check_kind("system", system, System, "System([striker, bar])")
    bar = system.bodies[-1]
    if not isinstance(bar, Rod) or not isinstance(system.ends[1], Free):
        raise invalid_argument(
            "system", "must end on the right with a rod whose end is Free()"
        )
    end = scalar("until", until, "s", "positive")
    passed = scalar("after", after, "s")
    if not 0 <= passed < end:
        raise invalid_argument(
            "after", f"must be from 0 to before until = {end!r} s, got {passed!r}"
        )
    if material is None:
        material = bar.segments[-1].material
    check_kind("material", material, Material, "materials.steel")

    untrapped = solve(system, until=end)
    bar_index = len(system.bodies) - 1
    waves = _end_waves(untrapped, bar_index)
    is_before = waves.times < passed * (1 - TIME_RTOL)
    times_before = waves.times[is_before]
    gap = _gap(untrapped, bar_index, times_before, passed)
    row = _TrappedRow(system, bar, material, gap)
    largest_wave = np.abs(waves.rightward).max()
    if largest_wave == 0:
        raise _nothing_pushes(passed, end)
    force_start, force_end = _pressed_interval(row, passed, end)
    wave_speed = float(material.wave_speed)
    # The wave that the trap's far end reflects must come back after the force has
    # ended: 2 L/c is the duration of the force.
    duration = force_end - force_start
    trapped = row.with_length(wave_speed * duration / 2)

    trapped_waves = _end_waves(solve(trapped, until=end), bar_index)
    reached = staircase(
        trapped_waves.times,
        trapped_waves.leftward,
        end,
        "force of the wave back into the bar",
    )
    # The wanted force is the first pulse as it is without the trap, then 0.
    times = [*times_before, passed]
    forces = [*waves.leftward[is_before], 0.0]
    wanted = staircase(times, forces, end, "wanted")
    edges = np.array([passed, end])
    after_pulse = differences(wanted, reached, edges)
    mean = after_pulse.mean[0]
    variance = after_pulse.variance[0]
    mean_square = mean**2 + variance
    root_mean_square = np.sqrt(mean_square)
    misfit = float(root_mean_square / largest_wave)
    return PulseDesign(trapped, bar_index + 1, wanted, reached, misfit, staircase=0.0)


class _EndWaves(NamedTuple):
    """Waves at the right end of a rod, which hold from each time to the next."""

    times: Any  # s
    rightward: Any  # force of the wave that arrives at the end, N
    leftward: Any  # force of the wave that leaves the end, N


def _end_waves(solution: Solution, body: int) -> _EndWaves:
    """Waves at the right end of a rod, as forces -E A strain, N.

    Compressive waves are positive.
    """
    rod: Any = solution.system.bodies[body]
    segment = rod.segments[-1]
    length = float(rod.length)
    gauge = solution.gauge(body, length)
    stiffness = float(segment.impedance * segment.wave_speed)  # E A = Z c
    arriving = -stiffness * gauge.rightward
    leaving = -stiffness * gauge.leftward
    return _EndWaves(gauge.times, arriving, leaving)


def _gap(solution: Solution, body: int, times: Any, passed: float) -> float:
    """Gap of the trap, m: displacement of the free end when the first pulse has passed.

    Parameters
    ----------
    solution : Solution
        The row without the trap.
    body : int
        Index of the bar.
    times : array
        Times before `passed` at which the velocity of the end changes, s.
    passed : float
        Time at which the first pulse has left the end, s.

    Raises
    ------
    InvalidModel
        If the end would have hit the trap before.
    """
    rod: Any = solution.system.bodies[body]
    times = [0.0, *times, passed]
    length = float(rod.length)
    displacements = solution.displacement(body, length, times)
    start = displacements[0]
    gap = float(displacements[-1] - start)
    furthest = float(displacements.max() - start)
    range_of_displacements = np.ptp(displacements)
    round_off = DISPLACEMENT_RTOL * float(range_of_displacements)
    if furthest > gap + round_off:
        message = (
            f"the right end is at {gap:.6g} m at {passed!r} s, and was at "
            f"{furthest:.6g} m before; take the time at which it is furthest"
        )
        raise invalid_argument("after", message)
    return gap


class _TrappedRow(NamedTuple):
    """A row with a trap, whose length is still free."""

    system: System  # without the trap
    bar: Rod
    material: Material
    gap: float  # m

    def with_length(self, length: float) -> System:
        """The row with a trap of this length, m, and of the bar's impedance rho A c.

        The trap lies behind the gap and pushes only. A negative gap counts as 0.
        """
        impedance = float(self.bar.segments[-1].impedance)
        material = self.material
        area = impedance / float(material.density * material.wave_speed)
        trap = Rod(length, area=area, material=material)
        system = self.system
        gap = max(self.gap, 0.0)  # round-off may make it negative
        return System(
            [*system.bodies, trap],
            [*system.gaps, gap],
            [*system.contacts, Rigid()],
            gravity=system.gravity,
            ends=system.ends,
        )


def _nothing_pushes(passed: float, end: float) -> InvalidModel:
    """The error, to be raised, that no wave pushes on the trap between two times, s."""
    message = f"nothing pushes on the right end from {passed!r} to {end!r} s"
    return invalid_argument("until", f"{message}; take a later time")


def _pressed_interval(
    row: _TrappedRow, passed: float, end: float
) -> tuple[float, float]:
    """Start and end of the contact force on a trap that is long enough, s.

    The force counts from `passed` to `end`, and if it is not small, see
    `LEAST_FORCE_RTOL`.

    Raises
    ------
    InvalidModel
        If there is no such force.
    """
    # No wave comes back from the far end of such a trap before `end`.
    endless_length = float(row.material.wave_speed) * end
    trapped = row.with_length(endless_length)
    solution = solve(trapped, until=end)
    times, force, _ = solution.contacts[-1].breakpoints()
    has_passed = times >= passed * (1 - TIME_RTOL)
    least_force = LEAST_FORCE_RTOL * force.max()
    is_pressed = force > least_force
    is_early = times < end
    pressed = np.flatnonzero(has_passed & is_early & is_pressed)
    if not pressed.size:
        raise _nothing_pushes(passed, end)
    first = pressed[0]
    last = pressed[-1]
    start = float(times[first])
    next_times = np.append(times[1:], end)  # each force lasts until the next time
    stop = min(end, float(next_times[last]))
    return start, stop
