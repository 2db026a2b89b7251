"""Fields from states of a grid: velocities of nodes and strains of cells at some times.

Between nodes, between the middles of cells, and between two states fields change evenly. At the
ends of a segment the force is what the momentum of the node there asks for: none at a free end,
that of the contact where rods touch, and the same on both sides of a step; strains follow.

Energies are those that the scheme keeps: kinetic energy is less by what the change of velocity
along a cell would strain it in half a step, which keeps both kinetic and strain energy from being
negative.
"""

from __future__ import annotations

import itertools
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..methods.grid.mesh import STEP_TICKS, GridMotion
from ..methods.signals import Floats, Ints, Pieces, Side
from ..model import Material, Rod
from ..model.profiles import Samples
from .fields import Fields, Profile, Trace

_FAINT = np.errstate(under="ignore")  # ahead of the waves strains are next to nothing


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
        return np.asarray(self.motion.when * STEP_TICKS)

    @property
    def _step(self) -> float:
        return self.clock.tick * STEP_TICKS

    # Between the states ---------------------------------------------------------------------------

    def _when(self, ticks: Ints) -> tuple[Ints, Floats]:
        """The state before each tick, and the share of the next one."""
        when = self.known
        if len(when) == 1:
            return np.zeros(np.shape(ticks), np.int64), np.zeros(np.shape(ticks))
        i = np.clip(np.searchsorted(when, ticks, "right") - 1, 0, len(when) - 2)
        share = np.minimum((ticks - when[i]) / (when[i + 1] - when[i]), 1.0)
        return i, share

    def _in_time(self, table: Floats, place: Any, ticks: Ints) -> Floats:
        """Values of columns of [state, column] at ticks; the two broadcast."""
        i, share = self._when(ticks)
        following = np.minimum(i + 1, len(table) - 1)
        return np.asarray(table[i, place] * (1 - share) + table[following, place] * share)

    # Between the nodes ----------------------------------------------------------------------------

    def _at(
        self, table: Floats, starts: Any, body: int, x: ArrayLike, ticks: Ints,
        cells: bool = False,
    ) -> Floats:
        """Values at places of a table [state, column]; a segment's columns begin at its start.

        They are those of its nodes, or of its `cells` and their ends as in `_stretch`.
        """
        segment, inside = self.locate(body, x)
        N = self._counts[segment]
        y = inside / np.array(self.clock.length)[segment] * N
        if cells:
            y = np.where(y < 0.5, 2 * y, np.where(y > N - 0.5, 2 * y - N + 1, y + 0.5))
        i = np.clip(np.floor(y), 0.0, N - 1.0 + cells)
        share = np.clip(y - i, 0.0, 1.0)
        place = np.asarray(starts)[segment] + i.astype(np.int64)
        self._together(place, ticks)
        before, after = (self._in_time(table, at, ticks) for at in (place, place + 1))
        between: Floats = before * (1 - share) + after * share
        return between

    @cached_property
    def _counts(self) -> Ints:
        """Cells by segment."""
        return np.array([0, *self.motion.counts])

    @cached_property
    def _edge(self) -> Ints:
        """By segment: the column of `_stretch` that is its left end."""
        return np.cumsum([-2, *(self._counts + 2)[:-1]])

    @cached_property
    def _stretch(self) -> Floats:
        """Strains: of each segment at its left end, in its cells, and at its right end."""
        return self._with_ends(self._strain, self._at_ends[0])

    @cached_property
    def _stretching(self) -> Floats:
        """Rates of strain, as in `_stretch`."""
        return self._with_ends(self._rate, self._at_ends[1])

    def _with_ends(self, table: Floats, ends: Floats) -> Floats:
        mesh, edge = self.motion, self._edge[1:]
        columns = [np.arange(a, b + 2) for a, b in zip(mesh.first[1:], mesh.last[1:], strict=True)]
        values: Floats = table[:, np.concatenate(columns)]
        values[:, edge], values[:, edge + self._counts[1:] + 1] = ends[:, ::2], ends[:, 1::2]
        return values

    @cached_property
    @_FAINT
    def _at_ends(self) -> tuple[Floats, Floats]:
        """Strains and their rates [state, end], left and right end of segment after segment.

        Both are extrapolated, and then changed to give the stress that the node's momentum asks
        for: in a step, viscosity eta resists a change of strain by eta/step. Where lateral inertia
        takes a share of the force they stay.
        """
        mesh, strains, rates = self.motion, [], []
        rods = [body for body in self.clock.system.bodies if isinstance(body, Rod)]
        segments = [segment for rod in rods for segment in rod.segments]
        for segment, a, b, N in zip(
            segments, mesh.first[1:], mesh.last[1:], mesh.counts, strict=True
        ):
            E, eta = float(segment.material.youngs_modulus), float(segment.material.viscosity)
            areas = segment.area.values if isinstance(segment.area, Samples) else [segment.area]
            for node, cell, inward, area in ((a, a + 1, 1, areas[0]), (b, b, -1, areas[-1])):
                behind = cell + inward * (N > 1)
                strain = 1.5 * self._strain[:, cell] - 0.5 * self._strain[:, behind]
                rate = 1.5 * self._rate[:, cell] - 0.5 * self._rate[:, behind]
                swells = mesh.cells.swelling[cell]
                if not (mesh.cells.lateral[node] or mesh.cells.lateral[node + 1] or swells):
                    pull = self._pull(node + 1) - self._pull(node) + self._pushed(node)
                    gained = pull * mesh.cells.cell_mass[cell] / 2 / mesh.mass[node]
                    stress = (self._pull(cell) - inward * gained) / float(area)
                    missing = stress - E * strain - eta * rate
                    strain += missing / (E + eta / self._step)
                    rate += missing / (E * self._step + eta)
                strains.append(strain)
                rates.append(rate)
        return np.array(strains).T, np.array(rates).T

    def _pull(self, cell: int) -> Floats:
        """Elastic and viscous tension of a cell, at the states; none between pieces."""
        cells = self.motion.cells
        pull: Floats = self.motion.force[:, cell]
        if cells.viscous[cell]:
            pull = pull + cells.viscous[cell] * cells.width[cell] * self._rate[:, cell]
        return pull

    def _pushed(self, node: int) -> Floats:
        """Force to the right on a node from outside its piece, at the states."""
        F = self.motion.pushes.get(node, np.zeros(1))
        if len(F) < 2:
            return np.repeat(F, len(self.motion.when)) if len(F) else np.zeros(1)
        ends = 1.5 * F[[0, -1]] - 0.5 * F[[1, -2]]
        at_steps = np.concatenate((ends[:1], (F[1:] + F[:-1]) / 2, ends[1:]))
        return np.asarray(at_steps[self.motion.when])

    @cached_property
    @_FAINT
    def _strain(self) -> Floats:
        """[state, cell]."""
        return np.asarray(self.motion.stretches(self._step) / self.motion.cells.width)

    @cached_property
    @_FAINT
    def _rate(self) -> Floats:
        """[state, cell] rates of strain."""
        rates: Floats = np.zeros(self.motion.force.shape)
        rates[:, 1:-1] = np.diff(self.motion.velocity, axis=1) / self.motion.cells.width[1:-1]
        return rates

    @cached_property
    @_FAINT
    def _displaced(self) -> dict[int, Floats]:
        """By rod: [state, node of the rod] displacements in the frame, m."""
        stretched = np.cumsum(self._strain[:, :-1] * self.motion.cells.width[:-1], axis=1)
        displaced = {}
        for body, (first, last) in enumerate(self.clock.spans):
            if last:
                a, b = self.motion.first[first], self.motion.last[last]
                piece = int(np.searchsorted(self.motion.starts, a, "right")) - 1
                before = stretched[:, a] - stretched[:, self.motion.starts[piece]]
                left = self.motion.place[:, piece] * self._step + before - before[0]
                displaced[body] = stretched[:, a : b + 1] + (left - stretched[:, a])[:, None]
        return displaced

    # Fields ---------------------------------------------------------------------------------------

    def velocity(self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right") -> Floats:
        ticks = self.to_ticks(t, side)
        v = self._at(self.motion.velocity, self.motion.first, body, x, ticks)
        return v + self.clock.frame + self._fallen(t)

    def strain(self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right") -> Floats:
        return self._at(self._stretch, self._edge, body, x, self.to_ticks(t, side), True)

    def strain_rate(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        return self._at(self._stretching, self._edge, body, x, self.to_ticks(t), True)

    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        a, ticks = self.clock, self.to_ticks(t)
        time, starts = ticks * a.tick, np.array(self.motion.first) - self._span(body)[0].start
        moved = self._at(self._displaced[body], starts, body, x, ticks)
        return moved + a.frame * time + a.gravity * time * time / 2

    @_FAINT
    def averaged(self, body: int, x: Floats, t: Floats) -> tuple[Floats, Floats]:
        ticks, traces = self.to_ticks(t), [self.trace(body, place) for place in x.tolist()]
        velocity = np.diff(self.displacement(body, x[:, None], t))
        strain = [np.diff(p.stretch.integral(0, ticks)) / (2 * p.wave_speed) for p in traces]
        lasts = np.diff(ticks)
        return velocity / (lasts * self.clock.tick), np.array(strain) / lasts

    @_FAINT
    def trace(self, body: int, x: float) -> Trace:
        a = self.clock
        ticks = self.known
        c = a.wave_speed[int(self.locate(body, x)[0])]
        v = self._at(self.motion.velocity, self.motion.first, body, x, ticks)
        stretch = c * self._at(self._stretch, self._edge, body, x, ticks, True)
        right, left, change = (
            Pieces.through(ticks, values) for values in (v - stretch, v + stretch, 2 * stretch)
        )
        return Trace(right, left, change, c)

    # Integrals over bodies ------------------------------------------------------------------------

    def _span(self, body: int) -> tuple[slice, slice, Floats]:
        """Nodes and cells of a rod, and the masses of its nodes."""
        first, last = self.clock.spans[body]
        a, b = self.motion.first[first], self.motion.last[last]
        cells = slice(a + 1, b + 1)
        half = self.motion.cells.cell_mass[cells] / 2
        return slice(a, b + 1), cells, np.append(half, 0.0) + np.append(0.0, half)

    @_FAINT
    def momentum(self, body: int, t: ArrayLike) -> Floats:
        nodes, _, mass = self._span(body)
        own = (self.motion.velocity[:, nodes] * mass).sum(axis=1)  # state by state the same bits
        moving = self._in_time(own[:, None], 0, self.to_ticks(t))
        momentum: Floats = moving + mass.sum() * (self.clock.frame + self._fallen(t))
        return momentum

    @_FAINT
    def energy(self, body: int, tick: int, velocity: float) -> tuple[float, float]:
        a, (nodes, _, mass) = self.clock, self._span(body)
        place = int(np.searchsorted(self.motion.when, tick // STEP_TICKS))
        v = self.motion.velocity[place, nodes] + a.frame + a.gravity * tick * a.tick - velocity
        return self.motion.energies(nodes, mass, place, v, self._step)

    @_FAINT
    def _largest_stress(self, segment: int, material: Material) -> float:
        """Of the states that were kept."""
        columns = slice(self._edge[segment], self._edge[segment] + self._counts[segment] + 2)
        stress = float(material.youngs_modulus) * self._stretch[:, columns]
        if float(material.viscosity):
            stress = stress + float(material.viscosity) * self._stretching[:, columns]
        return float(np.abs(stress).max())

    def damped(self, ticks: Ints) -> Floats:
        place = np.searchsorted(self.motion.when, ticks // STEP_TICKS)
        lost: Floats = self.motion.lost[place] * self._step
        return lost

    def profile(self, body: int, tick: int) -> Profile:
        nodes, cells, _ = self._span(body)
        first, last = self.clock.spans[body]
        counts = self.motion.counts[first - 1 : last]
        ends = itertools.pairwise(self.edges(body))
        starts = [np.linspace(*of, N + 1)[:-1] for of, N in zip(ends, counts, strict=True)]
        edges = np.append(np.concatenate(starts), self.edges(body)[-1])
        v = self._in_time(self.motion.velocity, nodes, np.asarray(tick))
        strain = self._in_time(self._strain, cells, np.asarray(tick))
        drift = self.clock.frame + self.clock.gravity * tick * self.clock.tick
        segments = np.repeat(np.arange(first, last + 1), counts)
        return Profile(edges, (v[1:] + v[:-1]) / 2 + drift, strain, segments)
