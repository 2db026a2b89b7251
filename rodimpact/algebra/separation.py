"""Why a contact does not press again: the last conditions of a cell.

There are three reasons. No front is in flight beside the contact, and its gap does not
close. Or the waves beside it circulate in uniform bodies unchanged, and no velocity on
its right is below one on its left. Or the mean motions go apart, and the gap between
them is wider than vibration can bridge.
"""

from itertools import pairwise
from typing import Any, NamedTuple

from ..methods.fronts import finality
from ..methods.fronts.records import NONE
from ..methods.fronts.simulation import Simulation
from ..model import Wall
from .exact_run import ExactRun
from .traced_fraction import HALF, ZERO, TracedFraction


class Separation(NamedTuple):
    """Conditions under which a contact does not press again after a tick."""

    conditions: list[TracedFraction]
    uses_energy: bool  # whether they bound vibration by its energy


def separation_of(run: ExactRun, contact: int, tick: Any) -> Separation:
    """Conditions under which a contact does not press again after a tick of the run.

    There are three reasons; the first that holds in the run gives the conditions:

    - No front is in flight, and the gap does not close: its opening velocity.
    - Each wave that circulates on the right has a particle velocity at least as large
      as each on the left: the order of these waves, and the differences of their
      velocities.
    - Otherwise, vibration cannot bridge the gap: the mean opening velocity, the mean
      gap, and the square of this gap less the square that vibration can bridge.

    The tick is a traced fraction.
    """
    simulation = run.simulation
    k = run.nodes[contact]
    node = simulation.nodes[k]
    left = simulation.segments[k]
    right = simulation.segments[k + 1]
    last = max(k, right.group_last)  # outside the row, `group_last` is 0
    is_still = finality.no_front_in_flight(simulation.lines, left.group_first, last)
    if is_still and node.gap_rate >= 0:
        return Separation([node.gap_rate], uses_energy=False)

    # The kernel writes its findings into the segments on both sides.
    finality.find_mean_motions(simulation, k, tick)
    is_bounded = left.is_end_velocity_bounded and right.is_end_velocity_bounded
    if is_bounded and right.min_end_velocity >= left.max_end_velocity:
        return Separation(_wave_conditions(run, k), uses_energy=False)

    finality.set_deviations(simulation, k, tick)
    # Gap at the tick if both faces were where the mean motions of their bodies put them
    mean_gap = (
        node.gap
        + node.gap_rate * (tick - node.solved_tick)
        - right.end_deviation
        + left.end_deviation
    )
    opening = right.mean_velocity - left.mean_velocity
    # Vibration of energy E bridges a gap g with g^2 = 2 E (C_left + C_right), where C
    # are the compliance integrals. The bound is that of
    # `finality_kernel.separation_time`, but with the energy of all vibration, which is
    # a function of velocities and impulses.
    compliance_integral = left.compliance_integral + right.compliance_integral
    bridged_squared = 2 * _vibration_energy(run) * compliance_integral
    conditions = [opening, mean_gap, mean_gap * mean_gap - bridged_squared]
    return Separation(conditions, uses_energy=True)


def _vibration_energy(run: ExactRun) -> TracedFraction:
    """Energy of vibration in the end, in the kernel's units.

    It is the energy that the centres of mass have lost, sum(m (v^2 - V^2)/2), and the
    work of moving walls.
    """
    numbers = run.numbers
    # impulses[i] acts on the left face of body i, impulses[i + 1] on the right one.
    impulses = [ZERO, *run.results.impulses, ZERO]
    energy = ZERO
    for i, body in enumerate(run.row.system.bodies):
        v = numbers.velocities[i]  # before
        V = run.results.velocities_after[i]
        if isinstance(body, Wall):
            # Impulse of the wall on its neighbours, by reaction, in the kernel's unit
            impulse_on_row = (impulses[i + 1] - impulses[i]) * run.tick_rate
            energy = energy + impulse_on_row * v
        first, last = run.row.spans[i]
        for s in range(first, last + 1):  # none in a wall
            # Segments count from 1, as 0 is outside; their impedances from 0.
            mass = run.simulation.segments[s].transit * numbers.impedances[s - 1]
            energy = energy + mass * (v * v - V * V) * HALF
    return energy


class CirculatingWave(NamedTuple):
    """A front that goes round in a uniform body, and the wave behind it."""

    velocity: TracedFraction  # m/s
    tick: TracedFraction  # when the front leaves the body's far end for the contact


def _wave_conditions(run: ExactRun, k: int) -> list[TracedFraction]:
    """Conditions of waves that circulate beside node k, as numbers that are positive.

    On each side the waves leave the far end in the order of the run. The particle
    velocity of each wave on the right exceeds that of each wave on the left.
    """
    left_waves = _circulating_waves(run, k, is_right=False)
    right_waves = _circulating_waves(run, k, is_right=True)
    conditions = []
    for waves in (left_waves, right_waves):
        for wave, next_wave in pairwise(waves):
            conditions.append(next_wave.tick - wave.tick)
    for right_wave in right_waves:
        for left_wave in left_waves:
            conditions.append(right_wave.velocity - left_wave.velocity)
    return conditions


def _circulating_waves(
    run: ExactRun, k: int, *, is_right: bool
) -> list[CirculatingWave]:
    """Waves in the body on the left or right of node k, the next to arrive first.

    The tick of a wave is that at which its front leaves the far end for the node.
    Without a front in flight there is one wave, at tick 0: the constant incoming wave.
    With fronts in flight the body must be a single segment.
    """
    simulation = run.simulation
    lines = simulation.lines
    # Node k lies between the segments k and k + 1. Line 2 s has the wave of segment s
    # to the right, line 2 s + 1 the one to the left.
    group = simulation.segments[k]
    incoming_line = 2 * k
    if is_right:
        group = simulation.segments[k + 1]
        incoming_line = 2 * k + 3
    s = group.group_first
    last = group.group_last
    is_outside = last == 0  # outside the row, the group is the empty range 1 to 0
    if is_outside or finality.no_front_in_flight(lines, s, last):
        return [CirculatingWave(lines[incoming_line].incoming_wave, tick=ZERO)]
    # Where fronts are in flight, only a uniform body, the segment s, gets here. A
    # receding front turns at the far end, one transit after it left the contact.
    approaching = 2 * s
    receding = 2 * s + 1
    if is_right:
        approaching = 2 * s + 1
        receding = 2 * s
    waves = _waves_in_flight(simulation, approaching)
    for wave in _waves_in_flight(simulation, receding):
        turning_tick = wave.tick + simulation.segments[s].transit
        waves.append(CirculatingWave(wave.velocity, turning_tick))
    return waves


def _waves_in_flight(simulation: Simulation, line: int) -> list[CirculatingWave]:
    """Waves behind the fronts in flight on a line, the one that arrives next first.

    Here the tick of a wave is when its front left the beginning of the line: the
    contact on a receding line, the far end on an approaching one.
    """
    waves = []
    r = simulation.lines[line].next_row
    while r != NONE:
        front = simulation.log[r]
        tick = front.tick + ZERO  # traced, also if it is an integer
        waves.append(CirculatingWave(front.value, tick))
        r = front.next_row
    return waves
