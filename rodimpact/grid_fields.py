"""Fields from states of a grid: velocities of nodes and strains of cells at some times.

Between nodes, between the middles of cells, and between two states fields change evenly. Energies
are those that the scheme keeps: kinetic energy is less by what the change of velocity along a cell
would strain it in half a step, which keeps both kinetic and strain energy from being negative.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .fields import Fields, Profile, Trace
from .methods.clockwork import PARTS, Clockwork
from .methods.finite_difference_kernel import States
from .methods.mesh import Mesh
from .signals import Floats, Ints, Side


class GridFields(Fields):
    """Fields of a row from its states on a grid.

    Parameters
    ----------
    assembly : Clockwork
    mesh : Mesh
    states : States
        `when` [state] in steps; velocity [state, node] in m/s, in the frame; force [state, cell]
        in N; place [state, piece] in m/s times steps; lost [state] in W times steps.
    end : int
        Last tick.
    masses : mapping of int to array
        As in `Fields`.
    """

    def __init__(
        self, assembly: Clockwork, mesh: Mesh, states: States, end: int,
        masses: Mapping[int, Floats],
    ) -> None:
        super().__init__(assembly, end, masses)
        self.mesh, self.states = mesh, states

    @property
    def _step(self) -> float:
        return self.assembly.tick * PARTS

    # Between the states ---------------------------------------------------------------------------

    def _when(self, ticks: Ints) -> tuple[Ints, Floats]:
        """The state before each tick, and the share of the next one."""
        when = self.states.when * PARTS
        if len(when) == 1:
            return np.zeros(np.shape(ticks), np.int64), np.zeros(np.shape(ticks))
        i = np.clip(np.searchsorted(when, ticks, "right") - 1, 0, len(when) - 2)
        share = np.minimum((ticks - when[i]) / (when[i + 1] - when[i]), 1.0)
        return i, share

    def _in_time(self, table: Floats, place: Any, ticks: Ints) -> Floats:
        """Values of columns of [state, column] at ticks; the two broadcast."""
        i, share = self._when(ticks)
        following = np.minimum(i + 1, len(table) - 1)
        found: Floats = table[i, place] * (1 - share) + table[following, place] * share
        return found

    # Between the nodes ----------------------------------------------------------------------------

    def _cell(self, body: int, segment: Ints, x: Floats, shift: float) -> tuple[Ints, Floats]:
        """Node before each place, moved by so many cells, and share; inside the segment."""
        first, a = self.assembly.spans[body][0], self.assembly
        begin = self.edges(body)[segment - first]
        counts = np.array([0, *self.mesh.counts])[segment]
        y = (x - begin) / np.array(a.length)[segment] * counts + shift
        low, high = 0.0, counts - 1.0
        if shift:
            y = np.clip(y, 0.0, counts - 1.0)
            high = np.maximum(counts - 2.0, 0.0)
        i = np.clip(np.floor(y), low, high)
        return np.array(self.mesh.first)[segment] + i.astype(np.int64), np.clip(y - i, 0.0, 1.0)

    def _at_nodes(
        self, table: Floats, body: int, x: ArrayLike, ticks: Ints, first: int = 0
    ) -> Floats:
        segment = self.segment_at(body, x)
        n, share = self._cell(body, segment, np.asarray(x, dtype=np.float64), 0.0)
        n = n - first
        self._together(n, ticks)
        before, after = (self._in_time(table, place, ticks) for place in (n, n + 1))
        found: Floats = before * (1 - share) + after * share
        return found

    def _at_cells(self, table: Floats, body: int, x: ArrayLike, ticks: Ints) -> Floats:
        segment = self.segment_at(body, x)
        c, share = self._cell(body, segment, np.asarray(x, dtype=np.float64), -0.5)
        self._together(c, ticks)
        last = np.array(self.mesh.last)[segment]
        before, after = (
            self._in_time(table, np.minimum(place, last), ticks) for place in (c + 1, c + 2)
        )
        found: Floats = before * (1 - share) + after * share
        return found

    @cached_property
    def _strain(self) -> Floats:
        """[state, cell]."""
        stiff = np.where(self.mesh.stiffness > 0, self.mesh.stiffness, np.inf)
        found: Floats = self.states.force / stiff / self.mesh.width
        return found

    @cached_property
    def _rate(self) -> Floats:
        """[state, cell] rates of strain."""
        found: Floats = np.zeros(self.states.force.shape)
        found[:, 1:-1] = np.diff(self.states.velocity, axis=1) / self.mesh.width[1:-1]
        return found

    @cached_property
    def _displaced(self) -> dict[int, Floats]:
        """By rod: [state, node of the rod] displacements in the frame, m."""
        stretched = np.cumsum(self._strain[:, :-1] * self.mesh.width[:-1], axis=1)
        found = {}
        for body, (first, last) in enumerate(self.assembly.spans):
            if last:
                a, b = self.mesh.first[first], self.mesh.last[last]
                piece = self.mesh.piece_of(a)
                before = stretched[:, a] - stretched[:, self.mesh.starts[piece]]
                left = self.states.place[:, piece] * self._step + before - before[0]
                found[body] = stretched[:, a : b + 1] + (left - stretched[:, a])[:, None]
        return found

    # Fields ---------------------------------------------------------------------------------------

    def velocity(  # noqa: D102
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        found = self._at_nodes(self.states.velocity, body, x, self.to_ticks(t, side))
        return found + self.assembly.frame + self._fallen(t)

    def strain(  # noqa: D102
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        return self._at_cells(self._strain, body, x, self.to_ticks(t, side))

    def strain_rate(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:  # noqa: D102
        return self._at_cells(self._rate, body, x, self.to_ticks(t))

    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:  # noqa: D102
        a, ticks = self.assembly, self.to_ticks(t)
        time = ticks * a.tick
        moved = self._at_nodes(self._displaced[body], body, x, ticks, self._span(body)[0].start)
        return moved + a.frame * time + a.gravity * time * time / 2

    def averaged(self, body: int, x: Floats, t: Floats) -> tuple[Floats, Floats]:  # noqa: D102
        u = self.displacement(body, np.asarray(x)[:, None], t)
        velocity = np.diff(u) / np.diff(self.to_ticks(t) * self.assembly.tick)
        when = self.states.when * PARTS
        strain = self.strain(body, np.asarray(x)[:, None], when * self.assembly.tick)
        passed = np.zeros_like(strain)
        passed[:, 1:] = np.cumsum((strain[:, 1:] + strain[:, :-1]) / 2 * np.diff(when), axis=1)
        ticks = self.to_ticks(t)
        i, share = self._when(ticks)
        following = np.minimum(i + 1, len(when) - 1)
        s = share * (when[following] - when[i])
        here = strain[:, i]
        total = passed[:, i] + (here + (here * (1 - share) + strain[:, following] * share)) / 2 * s
        return velocity, np.diff(total) / np.diff(ticks)

    def trace(self, body: int, x: float) -> Trace:  # noqa: D102
        a = self.assembly
        ticks = self.states.when * PARTS
        times = ticks * a.tick
        c = a.wave_speed[int(self.segment_at(body, x))]
        v = self._at_nodes(self.states.velocity, body, x, ticks)
        stretch = c * self._at_cells(self._strain, body, x, ticks)
        return Trace(times, v - stretch, v + stretch, a.frame + a.gravity * times, c)

    # Integrals over bodies ------------------------------------------------------------------------

    def _span(self, body: int) -> tuple[slice, slice, Floats]:
        """Nodes and cells of a rod, and the masses of its nodes."""
        first, last = self.assembly.spans[body]
        a, b = self.mesh.first[first], self.mesh.last[last]
        cells = slice(a + 1, b + 1)
        half = self.mesh.cell_mass[cells] / 2
        return slice(a, b + 1), cells, np.append(half, 0.0) + np.append(0.0, half)

    def momentum(self, body: int, t: ArrayLike) -> Floats:  # noqa: D102
        nodes, _, mass = self._span(body)
        own = self.states.velocity[:, nodes] @ mass
        moving = self._in_time(own[:, None], 0, self.to_ticks(t))
        found: Floats = moving + mass.sum() * (self.assembly.frame + self._fallen(t))
        return found

    def energy(  # noqa: D102
        self, body: int, tick: int, velocity: float
    ) -> tuple[float, float]:
        a, (nodes, cells, mass) = self.assembly, self._span(body)
        place = int(np.searchsorted(self.states.when, tick // PARTS))
        v = self.states.velocity[place, nodes] + a.frame + a.gravity * tick * a.tick - velocity
        change, k = np.diff(v), self.mesh.stiffness[cells]
        bound = self.mesh.lateral[cells] - k * self._step**2 / 4
        kinetic = float(mass @ (v * v) + bound @ (change * change)) / 2
        return kinetic, float(np.sum(self.states.force[place, cells] ** 2 / k)) / 2

    def whole(self, ticks: Ints) -> Ints:  # noqa: D102
        when = self.states.when * PARTS
        middles = (when[1:] + when[:-1]) / 2
        found: Ints = when[np.searchsorted(middles, ticks, "right")]
        return found

    def damped(self, ticks: Ints) -> Floats:  # noqa: D102
        place = np.searchsorted(self.states.when, ticks // PARTS)
        lost: Floats = self.states.lost[place] * self._step
        return lost

    def profile(self, body: int, tick: int) -> Profile:  # noqa: D102
        nodes, cells, _ = self._span(body)
        x = np.concatenate([
            np.linspace(left, right, N + 1)[:-1] for left, right, N in zip(
                self.edges(body)[:-1], self.edges(body)[1:], self._counts(body), strict=True)
        ])
        edges = np.append(x, self.edges(body)[-1])
        first, last = self.assembly.spans[body]
        v = self._in_time(self.states.velocity, nodes, np.asarray(tick))
        strain = self._in_time(self._strain, cells, np.asarray(tick))
        drift = self.assembly.frame + self.assembly.gravity * tick * self.assembly.tick
        segments = np.repeat(np.arange(first, last + 1), self._counts(body))
        return Profile(edges, (v[1:] + v[:-1]) / 2 + drift, strain, segments)

    def _counts(self, body: int) -> list[int]:
        first, last = self.assembly.spans[body]
        return self.mesh.counts[first - 1 : last]
