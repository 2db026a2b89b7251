"""A row on traced fractions: its numbers, and a run of the kernel of "fronts".

The mechanics is made of transit times T and impedances Z. They follow from lengths,
areas and materials, or are given themselves, as if they stood in the case:
`bodies.0.transit_time`, `bodies.0.impedance`.
"""

import math
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

from ..methods.fronts import energy
from ..methods.fronts.family_layout import lay_out_family
from ..methods.fronts.simulation import Simulation, start_simulation
from ..methods.groups import anchor_velocities, groups, unilateral
from ..methods.row import Row
from ..methods.states import Status, Stop
from ..model import Bonded, Segment
from .exact_results import Exact
from .traced_fraction import ZERO, TracedFraction

TICKS_PER_SHORTEST_TRANSIT = 1 << 20
"""Smallest number of ticks in a transit.

The kernel may wait a tick for its proof of finality: a tick must be short compared with
any transit time.
"""


# Numbers of a row ---------------------------------------------------------------------


class RowNumbers(NamedTuple):
    """Numbers of a row that enter the mechanics."""

    transit_times: list[TracedFraction]  # [segment], s
    impedances: list[TracedFraction]  # [segment], kg/s
    velocities: list[TracedFraction]  # [body], m/s
    gaps: list[TracedFraction]  # [contact], m


class WaveMaterial(NamedTuple):
    """Properties of a material that waves depend on."""

    wave_speed: TracedFraction  # m/s
    density: TracedFraction  # kg/m^3


class NumberSource(Protocol):
    """Source of the numbers of a row, path by path."""

    def number(self, path: str, value: Any) -> Any:
        """Number at a path where the system has `value`.

        None for a transit time or an impedance that follows from other numbers.
        """

    def material(self, path: str, segment: Segment) -> WaveMaterial:
        """Wave speed and density of the segment at a path."""


def read_numbers(row: Row, source: NumberSource) -> RowNumbers:
    """Numbers of a row, each from its source.

    A transit time that the source does not give is l/c, and an impedance rho A c.
    """
    transit_times = []
    impedances = []
    paths = row.paths[1:]  # the first one lies outside the row
    for segment, path in zip(row.segments, paths, strict=True):
        T = source.number(f"{path}.transit_time", segment.transit_time)
        Z = source.number(f"{path}.impedance", segment.impedance)
        if T is None:
            length = source.number(f"{path}.length", segment.length)
            T = length / source.material(path, segment).wave_speed
        if Z is None:
            material = source.material(path, segment)
            area = source.number(f"{path}.area", segment.area)
            Z = material.density * area * material.wave_speed
        transit_times.append(T)
        impedances.append(Z)
    velocities = []
    for i, body in enumerate(row.system.bodies):
        velocities.append(source.number(f"bodies.{i}.velocity", body.velocity))
    gaps = []
    for k, gap in enumerate(row.system.gaps):
        gaps.append(source.number(f"contacts.{k}.gap", float(gap)))
    return RowNumbers(transit_times, impedances, velocities, gaps)


# Runs ---------------------------------------------------------------------------------


class ExactRun(NamedTuple):
    """A finished run of the kernel."""

    row: Row
    nodes: list[int]  # [contact]
    numbers: RowNumbers
    tick_rate: Fraction  # ticks in a unit of the model's time
    simulation: Simulation  # its times are ticks
    is_final: bool  # the collision was proved to be over
    results: Exact  # traced fractions


class BodyMotion(NamedTuple):
    """Velocity before and after the collision, m/s, of what moves with a body.

    It is the velocity of the centre of mass of all bodies that are bonded to the body,
    or the velocity of the wall if one of them is a wall.
    """

    before: TracedFraction
    after: TracedFraction


def run_exactly(row: Row, numbers: RowNumbers, max_events: int) -> ExactRun:
    """Run the kernel to the proof that the collision is final, or to the cap.

    The results are traced fractions in the units of the model. Without a proof they are
    those at the cap, and the restitution is None.
    """
    layout = lay_out_family(row)  # a family of this row only
    tick_rate = _tick_rate(numbers)  # ticks in a unit of time
    ticks = [T * tick_rate for T in numbers.transit_times]
    simulation = start_simulation(
        layout,
        _kernel_values(numbers),
        ticks,
        tick_duration=1 / tick_rate,
        frame_velocity=ZERO,
    )
    is_final = simulation.run_to_proof(max_events, tolerance=ZERO) == Stop.FINAL
    # `_motion` needs the velocities of groups, the rods and masses bonded together.
    energy.update_motion(simulation)
    motions = []
    velocities_after = []
    for body in range(len(row.spans)):
        motion = _motion(row, simulation, body)
        motions.append(motion)
        velocities_after.append(motion.after)
    restitution = None
    if is_final:
        restitution = _restitution(row, layout.contacts, simulation, motions)
    results = Exact(
        restitution,
        tuple(velocities_after),
        _impulses(row, layout.contacts, numbers, simulation, motions, tick_rate),
        _contact_times(layout.contacts, simulation, tick_rate),
    )
    return ExactRun(
        row, layout.contacts, numbers, tick_rate, simulation, is_final, results
    )


def _tick_rate(numbers: RowNumbers) -> Fraction:
    """Ticks in a unit of time, a power of two.

    The shortest transit has at least `TICKS_PER_SHORTEST_TRANSIT` ticks, and less than
    twice as many.
    """
    shortest = min(numbers.transit_times)
    _, exponent = math.frexp(float(shortest))  # 2^(exponent - 1) <= shortest
    # The bit length of 2^n is n + 1, so the shortest transit has at least 2^n ticks.
    return Fraction(2) ** (TICKS_PER_SHORTEST_TRANSIT.bit_length() - exponent)


def _kernel_values(numbers: RowNumbers) -> list[Any]:
    """Values of the member in the order of the kernel, see `initial_state`.

    They are wave speeds, impedances, lengths, the frame, gaps, and velocity and strain
    of each body. Waves run 1 m in 1 s there, so that transit times are lengths.
    """
    wave_speeds = [1] * len(numbers.transit_times)
    lengths = numbers.transit_times
    frame = [ZERO, ZERO]
    values: list[Any] = [
        *wave_speeds,
        *numbers.impedances,
        *lengths,
        *frame,
        *numbers.gaps,
    ]
    for velocity in numbers.velocities:
        strain = ZERO
        values += [velocity, strain]
    return values


def _motion(row: Row, simulation: Simulation, body: int) -> BodyMotion:
    """Motion of a body: that of its bonded group, or of the wall that holds it.

    The velocity of a wall is the same before and after.
    """
    group = next(group for group in groups(row.system) if body in group)
    is_held = len(anchor_velocities(row.system, group)) > 0
    if is_held:
        # A wall acts as a wave that comes from outside: the velocity of the wall.
        line_from_outside = simulation.lines[-1]
        if group[0] == 0:
            line_from_outside = simulation.lines[0]
        wall_velocity = line_from_outside.incoming_wave
        return BodyMotion(wall_velocity, wall_velocity)
    first_segment, _ = row.spans[body]
    segment = simulation.segments[first_segment]
    return BodyMotion(segment.initial_group_velocity, segment.group_velocity)


def _restitution(
    row: Row, nodes: list[int], simulation: Simulation, motions: list[BodyMotion]
) -> TracedFraction | None:
    """Coefficient of restitution of the only contact that can open, if it collides.

    e = (V2 - V1)/(v1 - v2), with velocities V after and v before the collision. None if
    several contacts or none can open, or nothing collides. `nodes` has the number of
    the kernel's node of each contact.
    """
    contacts = unilateral(row.system)
    if len(contacts) != 1:
        return None
    k = contacts[0]
    left = motions[k]
    right = motions[k + 1]
    has_pressed = simulation.nodes[nodes[k]].episodes > 0
    bodies_approach = left.before > right.before
    if not has_pressed or not bodies_approach:
        return None
    return (right.after - left.after) / (left.before - right.before)


def _impulses(
    row: Row,
    nodes: list[int],
    numbers: RowNumbers,
    simulation: Simulation,
    motions: list[BodyMotion],
    tick_rate: Fraction,
) -> tuple[TracedFraction, ...]:
    """Impulse of each contact, N s; of a bond, whose force goes on, the average.

    The average follows from the momentum of the rod on the left of the bond.
    """
    impulses: list[TracedFraction] = []
    impulse_from_left = ZERO
    for i, law in enumerate(row.system.contacts):
        impulse = simulation.nodes[nodes[i]].impulse / tick_rate
        if isinstance(law, Bonded):
            # The impulse on the right body is the momentum m (v - V) that body i loses,
            # plus the impulse on body i from its left.
            velocity_lost = numbers.velocities[i] - motions[i].after
            momentum_lost = _mass(row, numbers, i) * velocity_lost
            impulse = momentum_lost + impulse_from_left
        impulses.append(impulse)
        impulse_from_left = impulse
    return tuple(impulses)


def _mass(row: Row, numbers: RowNumbers, body: int) -> TracedFraction:
    """Mass of a rod, the sum of T Z over its segments, kg."""
    first, last = row.spans[body]
    mass = ZERO
    for s in range(first, last + 1):  # segments count from 1, numbers from 0
        mass = mass + numbers.transit_times[s - 1] * numbers.impedances[s - 1]
    return mass


def _contact_times(
    nodes: list[int], simulation: Simulation, tick_rate: Fraction
) -> tuple[Any, ...]:
    """Start and end of the force of each contact, for each of its finished episodes.

    Changes between other states, without a force before and after, are ignored.
    """
    times: dict[int, list[TracedFraction]] = {node: [] for node in nodes}
    for change in simulation.changes:
        node = change.next_row  # this field of a change, unlike a front, is its node
        times_at_node = times[node]  # a start, its end, the next start, ...
        is_pressing = change.value == Status.PRESS
        was_pressing = len(times_at_node) % 2 == 1
        if is_pressing != was_pressing:
            tick = change.tick + ZERO  # a traced fraction, also if it is a plain 0
            times_at_node.append(tick / tick_rate)
    episodes = []
    for times_at_node in times.values():
        starts = times_at_node[::2]
        ends = times_at_node[1::2]
        # An unfinished episode has a start without an end: `zip` leaves it out.
        episodes.append(tuple(zip(starts, ends, strict=False)))
    return tuple(episodes)
