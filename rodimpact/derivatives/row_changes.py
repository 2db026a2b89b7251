"""How what a row begins with changes with its numbers, and then the motion of its bodies."""

from __future__ import annotations

import numpy as np

from ..methods.fronts.front_kernel import BOND, FINAL, Results
from ..methods.fronts.layout_kernel import ENDLESS, Make
from ..methods.row import Array
from .tangent_kernel import LEAST, PARTING, SMOOTH, Begin, Derivatives


class RowChanges:
    """Changes of rows: [member, segment, direction], per unit of what changes.

    Parameters
    ----------
    make : Make
    status : list of int
        Of the nodes.
    given : [member, number of a row]
    slope : [member, direction, number of a row]

    Attributes
    ----------
    size : [member, direction]
        Largest change of a number, relative to what is as much as all of a length.
    """

    def __init__(self, make: Make, status: list[int], given: Array, slope: Array) -> None:
        n, (count, P, _) = make.size[0], slope.shape
        self.make, self.status, self.given, self.moved = make, status, given, slope.swapaxes(1, 2)
        spans = zip(make.profile, make.first, make.last, strict=True)
        self.places = [place for place, first, last in spans for _ in range(first, last + 1)]
        self.segments = given[:, : 3 * n].reshape(count, 3, n, 1)
        relative = self.moved[:, : 3 * n].reshape(count, 3, n, P) / self.segments
        self.transit, self.impedance = relative[:, 2] - relative[:, 0], relative[:, 1]
        after, first = 3 * n, 3 * n + len(make.node)
        states, sizes, speed = given[:, first:], given.copy(), given[:, :n].max(axis=1)
        scale = np.ptp(states[:, ::2], axis=1) + speed * np.abs(states[:, 1::2]).max(axis=1)
        longest = (given[:, 2 * n : after] / given[:, :n]).max(axis=1)
        sizes[:, after:first] = (scale * longest)[:, None]
        sizes[:, first::2], sizes[:, first + 1 :: 2] = scale[:, None], (scale / speed)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):  # of what does not move
            self.size = np.max(np.abs(slope) / sizes[:, None], axis=2)
            least = LEAST * self.size * scale[:, None]
        self.scale, self.least = scale, np.where(np.isfinite(least), least, 0.0)

    def begin(self) -> Begin:
        """What changes at t = 0."""
        make, moved, (count, n, P) = self.make, self.moved, self.transit.shape
        gap, outside = np.zeros((count, n + 1, P)), np.zeros((count, 2, P))
        gap[:, make.node] = moved[:, 3 * n : 3 * n + len(make.node)]
        strains = [place + 1 for place in self.places]
        stretching = moved[:, :n] * self.given[:, strains, None]
        stretching += self.segments[:, 0] * moved[:, strains]
        velocity = moved[:, self.places]
        for end, sign in ((0, -1), (-1, 1)):
            if make.outside[end] == ENDLESS:  # what comes in is what left last
                outside[:, end] = velocity[:, end] + sign * stretching[:, end]
            elif make.last[end] == 0:
                outside[:, end] = moved[:, make.profile[end]]
        return Begin(
            self.transit, self.impedance, velocity, stretching, gap, outside, self.least)

    def motion(self, results: Results, found: Derivatives) -> tuple[Array, Array]:
        """Of the velocities of what is bonded together, before and after; noted where they meet."""
        n, make = self.transit.shape[1], self.make
        starts = [s for s in range(n) if s == 0 or self.status[s] != BOND]
        ends = [*starts[1:], n]
        c, Z, L = self.segments.swapaxes(0, 1)
        mass = Z * L / c
        growth = mass * (self.transit + self.impedance)
        excess = self.given[:, self.places, None] - results.before[:, 1:-1, None]
        momentum = growth * excess + mass * self.moved[:, self.places]
        mass, growth, momentum = (
            np.add.reduceat(x, starts, axis=1) for x in (mass, growth, momentum))
        push = (results.impulse[:, starts] - results.impulse[:, ends])[..., None] / mass
        before = momentum / mass
        after = before + (found.impulse[:, starts] - found.impulse[:, ends] - push * growth) / mass
        lengths = np.subtract(ends, starts)
        before, after = (np.repeat(x, lengths, axis=1) for x in (before, after))
        endless = {node for node, kind in zip((ends[0], starts[-1]), make.outside, strict=True)
                   if kind == ENDLESS}  # beside which no group has its last velocity yet
        for k in {*starts[1:]} - endless:
            apart = results.after[:, k + 1] - results.after[:, k]
            met = (results.flag == FINAL) & (np.abs(apart) <= LEAST * self.scale)
            if met.any():
                parting = np.abs(after[:, k] - after[:, k - 1]) > self.least
                noted = met[:, None] & parting & (found.event == SMOOTH)
                found.event[noted], found.where[noted] = PARTING, k
        return before, after
