"""Fields from states of a grid: velocities of nodes and strains of cells at some times.

Between nodes, between the middles of cells, and between two states fields change evenly. At the
ends of a segment the force is what the momentum of the node there asks for: none at a free end,
that of the contact where rods touch, and the same on both sides of a step; strains follow.

Energies are those that the scheme keeps: kinetic energy is less by what the change of velocity
along a cell would strain it in half a step, which keeps both kinetic and strain energy from being
negative.
"""

import itertools
from collections.abc import Iterator
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..methods.grid.measures import largest_force
from ..methods.grid.mesh import STEP_TICKS, GridMotion
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Segment
from ..model.profiles import Samples
from .extreme_stress import ExtremeStress, StressPeak, strongest
from .fields import Fields, Profile

Tables: TypeAlias = dict[int, tuple[Floats, Floats]]
"""By rod: places, m from its left end, and values there, [state, place]."""


class GridFields(Fields):
    """Fields of a row from its states on a grid.

    Parameters
    ----------
    clock : Clock
    end : int
        Last tick.
    signals : Signals
        Whose motion is a `GridMotion`.
    """

    motion: GridMotion
    resolution = STEP_TICKS

    @cached_property
    def known(self) -> Ints:
        """Increasing ticks of the states, at which alone energies are known."""
        return np.asarray(self.motion.when * STEP_TICKS)

    def nearest_known(self, ticks: Ints) -> Ints:
        return self.known[
            np.searchsorted((self.known[1:] + self.known[:-1]) / 2, ticks, "right")
        ]

    # Between states and between nodes -------------------------------------------------------------

    def _in_time(self, table: Floats, place: Any, ticks: Ints) -> Floats:
        """Values of columns of [state, column] at ticks; the two broadcast."""
        when, last = self.known, len(self.known) - 1  # 0 where nothing moves: one state
        i = np.clip(np.searchsorted(when, ticks, "right") - 1, 0, max(last - 1, 0))
        after = np.minimum(i + 1, last)
        share = np.minimum(
            (ticks - when[i]) / np.maximum(when[after] - when[i], 1), 1.0
        )
        return np.asarray(table[i, place] * (1 - share) + table[after, place] * share)

    def _at(self, body: int, x: Floats, ticks: Ints, tables: Tables) -> Floats:
        """Values of a rod at places x, m, between those of its table."""
        self._together(self.locate(body, x)[0], ticks)
        places, table = tables[body]
        i = np.clip(np.searchsorted(places, x, "right") - 1, 0, len(places) - 2)
        share = np.minimum((x - places[i]) / (places[i + 1] - places[i]), 1.0)
        before, after = (self._in_time(table, at, ticks) for at in (i, i + 1))
        return np.asarray(before * (1 - share) + after * share)

    def _places(self, body: int) -> list[Floats]:
        """Of the nodes of each segment of a rod, m from its left end."""
        first, last = self.clock.spans[body]
        counts = self.motion.counts[first - 1 : last]
        ends = itertools.pairwise(self.edges(body))
        return [np.linspace(*of, N + 1) for of, N in zip(ends, counts, strict=True)]

    def _node_places(self, body: int) -> Floats:
        return np.unique(np.concatenate(self._places(body)))

    @cached_property
    def _velocity(self) -> Floats:
        """Velocities of nodes in the frame [state, node], m/s.

        In damped rods these are the rates at which displacements change over two steps,
        (v[n - 1] + 2 v[n] + v[n + 1])/4. Viscosity leaves a motion of the mesh alone that changes
        its sign from node to node and from step to step, since its mean over a step is 0. Contacts
        excite it, and it would be most of the error at an end. It is no part of displacements.
        """
        velocity = self.motion.velocity
        damped = self.motion.cells.viscous[:-1] + self.motion.cells.viscous[1:] > 0
        when = self.motion.when
        if not damped.any() or len(when) < 3:
            return velocity
        places = np.flatnonzero(damped)
        nodes = slice(int(places[0]), int(places[-1]) + 1)
        raw = velocity[:, nodes]
        smooth = raw.copy()
        follows = np.diff(when) == 1
        inside = follows[:-1] & follows[1:]
        mean = raw[:-2] + raw[2:]
        mean += 2 * raw[1:-1]
        mean /= 4
        np.copyto(smooth[1:-1], mean, where=inside[:, None])
        # From one side, with the same error: after t = 0, where velocities may jump, and at
        # the end.
        sides = []
        if when[0] == 0 and len(when) > 4 and follows[:4].all():
            sides.append((1, 1))
        if len(when) > 3 and follows[-3:].all():
            sides.append((len(when) - 1, -1))
        for state, onward in sides:
            second = raw[state + onward]
            third = raw[state + 2 * onward]
            fourth = raw[state + 3 * onward]
            smooth[state] = raw[state] + (second - 2 * third + fourth) / 4
        if damped.all():
            return smooth
        velocities = velocity.copy()
        velocities[:, damped] = smooth[:, damped[nodes]]
        return velocities

    @cached_property
    def _moving(self) -> Tables:
        """Velocities of nodes in the frame, m/s."""
        tables = {}
        for body in self.rods:
            nodes, _, _ = self._span(body)
            tables[body] = self._node_places(body), self._velocity[:, nodes]
        return tables

    @cached_property
    def _stretched(self) -> tuple[Tables, Tables]:
        """Strains and their rates, 1/s.

        Places are the ends of segments, on either side of a step, and the middles of cells.
        """
        found: tuple[Tables, Tables] = {}, {}
        cells, kept = self.motion.cells, np.zeros((2, *self.motion.force.shape))
        kept[0] = self._strain
        kept[1, :, 1:-1] = np.diff(self._velocity, axis=1) / cells.width[1:-1]
        tension = (
            self.motion.force + cells.viscous * cells.width * kept[1]
        )  # none between pieces
        for body, rod in self.rods.items():
            segments = enumerate(rod.segments, self.clock.spans[body][0])
            parts = [
                (
                    np.concatenate((x[:1], (x[1:] + x[:-1]) / 2, x[-1:])),
                    self._held(*of, tension, kept),
                )
                for of, x in zip(segments, self._places(body), strict=True)
            ]
            places, states = (
                np.concatenate(of, axis=-1) for of in zip(*parts, strict=True)
            )
            found[0][body], found[1][body] = ((places, values) for values in states)
        return found

    def _held(self, s: int, segment: Segment, tension: Floats, kept: Floats) -> Floats:
        """Strains of a segment and their rates at its left end, in its cells, at its right end.

        `tension` and `kept`, strains and rates, are those of all cells, [state, cell].

        At the ends both are extrapolated, and then changed to give the stress that the node's
        momentum asks for: in a step, viscosity eta resists a change of strain by eta/step. Where
        lateral inertia takes a share of the force they stay.
        """
        mesh, cells, (E, eta) = self.motion, self.motion.cells, _moduli(segment)
        a, b = mesh.first[s], mesh.last[s]
        held = kept[..., a : b + 2].copy()
        areas = (
            segment.area.values if isinstance(segment.area, Samples) else [segment.area]
        )
        for node, cell, inward, area in (
            (a, a + 1, 1, areas[0]),
            (b, b, -1, areas[-1]),
        ):
            behind, end = cell + inward * (b > a + 1), (inward - 1) // 2
            held[..., end] = strain, rate = (
                1.5 * kept[..., cell] - 0.5 * kept[..., behind]
            )
            if not (
                cells.lateral[node] or cells.lateral[node + 1] or cells.swelling[cell]
            ):
                pull = tension[:, node + 1] - tension[:, node] + self._pushed(node)
                gained = pull * cells.cell_mass[cell] / 2 / mesh.mass[node]
                stress = (tension[:, cell] - inward * gained) / float(area)
                missing = stress - E * strain - eta * rate
                held[0, :, end] += missing / (E + eta / self.step)
                held[1, :, end] += missing / (E * self.step + eta)
        return held

    def _pushed(self, node: int) -> Floats:
        """Force to the right on a node from outside its piece, at the states."""
        F = self.motion.pushes.get(node, np.zeros(1))
        if len(F) < 2:
            return np.repeat(F, len(self.motion.when)) if len(F) else np.zeros(1)
        ends = 1.5 * F[[0, -1]] - 0.5 * F[[1, -2]]
        at_steps = np.concatenate((ends[:1], (F[1:] + F[:-1]) / 2, ends[1:]))
        return np.asarray(at_steps[self.motion.when])

    @cached_property
    def _strain(self) -> Floats:
        """[state, cell]."""
        return np.asarray(self.motion.stretches(self.step) / self.motion.cells.width)

    @cached_property
    def _displaced(self) -> Tables:
        """Displacements of nodes in the frame, m."""
        stretched = np.cumsum(
            self._strain[:, :-1] * self.motion.cells.width[:-1], axis=1
        )
        displaced = {}
        for body, (first, last) in enumerate(self.clock.spans):
            if last:
                a, b = self.motion.first[first], self.motion.last[last]
                piece = int(np.searchsorted(self.motion.starts, a, "right")) - 1
                before = stretched[:, a] - stretched[:, self.motion.starts[piece]]
                left = (
                    self.motion.displacement[:, piece] * self.step + before - before[0]
                )
                moved = stretched[:, a : b + 1] + (left - stretched[:, a])[:, None]
                displaced[body] = self._node_places(body), moved
        return displaced

    # Fields ---------------------------------------------------------------------------------------

    def rod_velocity(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:  # noqa: ARG002
        return self._at(body, x, ticks, self._moving) + self.clock.frame

    def rod_strain(self, body: int, x: Floats, ticks: Ints, side: Side) -> Floats:  # noqa: ARG002
        return self._at(body, x, ticks, self._stretched[0])

    def rod_strain_rate(self, body: int, x: Floats, ticks: Ints) -> Floats:
        return self._at(body, x, ticks, self._stretched[1])

    def rod_displacement(self, body: int, x: Floats, ticks: Ints) -> Floats:
        moved = self._at(body, x, ticks, self._displaced)
        return moved + self.clock.frame * (ticks * self.clock.tick)

    def strained(self, body: int, x: Floats, ticks: Ints) -> Floats:
        strains = self._at(body, x[:, None], self.known, self._stretched[0])
        return np.array(
            [Pieces.through(self.known, of).integral(0, ticks) for of in strains]
        )

    def trace(self, body: int, x: float) -> tuple[Pieces, Pieces, Pieces, float]:
        c, ticks = self.clock.wave_speed[int(self.locate(body, x)[0])], self.known
        place = np.asarray(x)
        v = self._at(body, place, ticks, self._moving)
        stretch = c * self._at(body, place, ticks, self._stretched[0])
        return (
            Pieces.through(ticks, v - stretch),
            Pieces.through(ticks, v + stretch),
            Pieces.through(ticks, 2 * stretch),
            c,
        )

    # Integrals over bodies ------------------------------------------------------------------------

    def _span(self, body: int) -> tuple[slice, slice, Floats]:
        """Nodes and cells of a rod, and the masses of its nodes."""
        first, last = self.clock.spans[body]
        a, b = self.motion.first[first], self.motion.last[last]
        cells = slice(a + 1, b + 1)
        half = self.motion.cells.cell_mass[cells] / 2
        return slice(a, b + 1), cells, np.append(half, 0.0) + np.append(0.0, half)

    def momentum(self, body: int, t: ArrayLike) -> Floats:
        nodes, _, mass = self._span(body)
        own = (self.motion.velocity[:, nodes] * mass).sum(
            axis=1
        )  # state by state the same bits
        ticks = self.to_ticks(t)
        moving = self._in_time(own[:, None], 0, ticks)
        return np.asarray(
            moving + mass.sum() * (self.clock.frame + self._fallen(ticks))
        )

    def energy(self, body: int, tick: int, velocity: float) -> tuple[float, float]:
        a, (nodes, _, mass) = self.clock, self._span(body)
        place = int(np.searchsorted(self.motion.when, tick // STEP_TICKS))
        v = (
            self.motion.velocity[place, nodes]
            + a.frame
            + a.gravity * tick * a.tick
            - velocity
        )
        return self.motion.energies(nodes, mass, place, v, self.step)

    def extreme_stress(self, body: int) -> ExtremeStress:
        peaks = [*self._state_peaks(body), *self._end_peaks(body)]
        tensions = [peak for peak in peaks if peak.stress > 0]
        compressions = [peak for peak in peaks if peak.stress < 0]
        return ExtremeStress(strongest(tensions), strongest(compressions))

    def _state_peaks(self, body: int) -> Iterator[StressPeak]:
        """Highest and lowest stress in a rod of the states that are kept."""
        segments = self.rods[body].segments
        moduli = np.array([_moduli(segment) for segment in segments])
        counts = [len(x) + 1 for x in self._places(body)]
        E, eta = np.repeat(moduli, counts, axis=0).T
        strains, rates = self._stretched
        places, strain = strains[body]
        stress = E * strain + eta * rates[body][1]
        for extreme in (stress.argmax(), stress.argmin()):
            state, place = np.unravel_index(extreme, stress.shape)
            t = float(self.known[state]) * self.clock.tick
            yield StressPeak(float(stress[state, place]), float(places[place]), t)

    def _end_peaks(self, body: int) -> Iterator[StressPeak]:
        """Stress by the largest push and pull on each end of a rod, of all time steps.

        Lateral inertia takes a share of the force on an end.
        """
        segments = self.rods[body].segments
        ends = ((segments[0], 0, 0.0), (segments[-1], -1, self.edges(body)[-1]))
        forces = self._forces_on(body)
        for (segment, last, x), force in zip(ends, forces, strict=True):
            if force is None or segment.lateral_inertia is not None:
                continue
            area = segment.area
            if isinstance(area, Samples):
                area = area.values[last]
            for sign in (1.0, -1.0):
                means = sign * force
                t = (int(np.argmax(means)) + 0.5) * self.step
                stress = -sign * largest_force(means) / float(area)
                yield StressPeak(stress, float(x), t)

    def _forces_on(self, body: int) -> tuple[Floats | None, Floats | None]:
        """Mean push in each step on the left and on the right end of a rod, N."""
        contacts = [contact.force for contact in self.signals.contacts]
        outside = [side and side.push for side in self.signals.outside]
        pushes = [outside[0], *contacts, outside[1]]
        left = pushes[body]
        right = pushes[body + 1]
        return (
            None if left is None else left.values,
            None if right is None else right.values,
        )

    def damped(self, ticks: Ints) -> Floats:
        place = np.searchsorted(self.motion.when, ticks // STEP_TICKS)
        return np.asarray(self.motion.lost[place] * self.step)

    def profile(self, body: int, tick: int) -> Profile:
        nodes, cells, _ = self._span(body)
        v = self._in_time(self.motion.velocity, nodes, np.asarray(tick))
        strain = self._in_time(self._strain, cells, np.asarray(tick))
        drift = self.clock.frame + self.clock.gravity * tick * self.clock.tick
        return Profile(self._node_places(body), (v[1:] + v[:-1]) / 2 + drift, strain)


def _moduli(segment: Segment) -> tuple[float, float]:
    """Young's modulus and viscosity."""
    return float(segment.material.youngs_modulus), float(segment.material.viscosity)
