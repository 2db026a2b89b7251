"""The search for a stepped striker that gives a wanted pulse.

A wave from the struck end reaches a segment and is back one round trip later than for
the segment before it. So step k of the pulse depends on segment k and on those before
it, which are known (layer peeling): the force is linear in the reflection at the near
end of segment k. Two solutions give that line: one with a bar that absorbs all waves
behind the known segments, and one with a free end there. Steps that no area gives, and
the ringing afterwards, are left to least squares.
"""

import math
from typing import NamedTuple

import numpy as np

from ..model import Absorbing, Bonded, Free, Material, Rigid, Rod, Segment, System
from ..model.ends import FREE
from ..model.quantities import Floats
from ..records.signal import Signal
from ..running.solving import solve
from .pulses import MIN_DURATION_RTOL, differences, no_force, staircase

REFLECTION_MARGIN = 1e-6
"""Distance of a start from reflections and velocities that no finite area gives.

Reflections stay so far from -1 and 1, and velocities, relative to that of the striker,
so far from 0 and 1.
"""
MAX_EVALUATIONS = 8
"""Cap on the evaluations of least squares for each number of segments."""


class Striker(NamedTuple):
    """A striker, and the misfit of its pulse over the peak of the wanted force."""

    logarithms: Floats  # [segment] of area over bar's area, from the struck end on
    misfit: float
    misfit_within_steps: float  # part of the misfit that no areas can change


class Misfits(NamedTuple):
    """Parts of the misfit by the steps of the pulse, [step] each.

    The sum of all squares is the square of the misfit.
    """

    of_means: Floats  # mean difference in each step
    within_steps: Floats  # standard deviation of the difference in each step


class StrikerSearch(NamedTuple):
    """Strikers of a number of segments that are to send a force into a bar.

    An array of logarithms stands for a striker, see `Striker`.
    """

    bar: Rod
    material: Material
    velocity: float  # m/s
    duration: float  # duration of the pulse, s
    contact: Rigid | Bonded
    wanted: Signal  # force, N
    bounds: Floats  # smallest and largest logarithm
    segments: int

    @property
    def bar_area(self) -> float:
        """Area of the bar, m^2."""
        area = self.bar.segments[0].area
        return float(np.asarray(area))

    @property
    def edges(self) -> Floats:
        """Times between the steps of the pulse, s, from 0 to the end of `wanted`.

        A step is a round trip in a segment; the last one may be shorter.
        """
        step = self.duration / self.segments
        end = self.wanted.end
        # Round-off must not add a step.
        count = math.ceil(end / step * (1 - MIN_DURATION_RTOL))
        return np.append(step * np.arange(count), end)

    def system(self, logarithms: Floats, left_end: Free | Absorbing = FREE) -> System:
        """The row of the striker and the semi-infinite bar.

        Segments of the system count from the left, logarithms from the struck end,
        which is on the right.
        """
        material = self.material
        transit_time = self.duration / 2
        length = transit_time * material.wave_speed / self.segments
        segments = []
        for logarithm in logarithms[::-1]:
            area = self.bar_area * math.exp(logarithm)
            segment = Segment(length, area, material)
            segments.append(segment)
        striker = Rod(segments=segments, velocity=self.velocity)
        contacts = [self.contact]
        ends = (left_end, Absorbing())
        return System([striker, self.bar], contacts=contacts, ends=ends)

    def force(
        self, logarithms: Floats, until: float, left_end: Free | Absorbing = FREE
    ) -> Signal:
        """Force on the bar over time, N, until a time, s, in constant steps.

        The collision is solved by fronts. `left_end` is the far end of the striker.
        """
        system = self.system(logarithms, left_end)
        solution = solve(system, until=until, method="fronts")
        contact = solution.contacts[0]
        times, force, _ = contact.breakpoints()
        return staircase(times, force, until, "force on the bar")

    def misfits(self, reached: Signal) -> Misfits:
        """Misfits of a force on the bar in each step, relative to the peak of `wanted`.

        They are those of the mean over the step, and of the variation within it. Each
        step counts by its share of the time up to the end of `wanted`.
        """
        wanted = self.wanted
        peak = np.abs(wanted.values).max()
        durations = np.diff(self.edges)
        weights = durations / wanted.end / peak**2
        mean, variance = differences(wanted, reached, self.edges)
        of_means = np.sqrt(weights) * mean
        within_steps = np.sqrt(weights * variance)
        return Misfits(of_means, within_steps)

    # Starts

    def matched(self, force: Floats) -> Floats:
        """Logarithms of areas, each of which alone would give its step of the force, N.

        A uniform striker of impedance Z1 presses with F = V Z Z1/(Z + Z1) on a bar of
        impedance Z, whose end moves at F/Z. The logarithms stay within the bounds.
        """
        bar = self.bar.segments[0]
        velocity_ratio = force / (bar.impedance * self.velocity)
        highest_ratio = 1 - REFLECTION_MARGIN
        velocity_ratio = np.clip(velocity_ratio, REFLECTION_MARGIN, highest_ratio)
        # F/(Z V) = Z1/(Z + Z1), solved for Z1
        impedance = velocity_ratio / (1 - velocity_ratio) * bar.impedance
        material = self.material
        areas = impedance / (material.density * material.wave_speed)
        logarithms = np.log(areas / self.bar_area)
        return np.clip(logarithms, *self.bounds)

    def peeled(self, force: Floats) -> Floats:
        """Logarithms of areas that give the first steps of the force, N, in turn.

        They stay within the bounds. With the contact bonded, the last force of the
        segments so far is F0 if their far end absorbs, and F1 if it is free. For the
        wanted force F the next step of area must reflect r = (F - F0)/(F1 - F0). It
        reflects nothing if F1 = F0, and never all of a wave.
        """
        first_force = force[:1]
        logarithms = self.matched(first_force)  # the first segment alone
        strongest = 1 - REFLECTION_MARGIN
        # A contact that never opens: the force, also below 0, is linear in reflections.
        bonded = self._replace(contact=Bonded())
        for k in range(1, len(force)):
            until = self.edges[k + 1]  # the end of step k
            # An absorbing end reflects 0, a free end 1; the force is linear between.
            if_absorbing = bonded.force(logarithms, until, Absorbing())
            if_free = bonded.force(logarithms, until, FREE)
            # The force is constant in a step, so its last value is that of step k.
            force_without_reflection = if_absorbing.values[-1]
            slope = if_free.values[-1] - force_without_reflection
            reflection = 0.0
            if slope:
                change = force[k] - force_without_reflection
                reflection = change / slope
            reflection = max(reflection, -strongest)
            reflection = min(reflection, strongest)
            # A step of area from A to A' reflects r = (A - A')/(A + A').
            area_ratio = (1 - reflection) / (1 + reflection)
            step = math.log(area_ratio)
            logarithm = np.clip(logarithms[-1] + step, *self.bounds)
            logarithms = np.append(logarithms, logarithm)
        return logarithms

    # Least squares

    def best_striker(self, coarser: Floats) -> Striker:
        """Striker by one least-squares search, from the start with the least misfit.

        The starts are `peeled`, `matched` and the coarser striker. The residuals are
        the mean differences of the steps. The misfit of the result also contains the
        differences within steps.

        Parameters
        ----------
        coarser : array
            A striker of fewer segments, the third start; empty for none.
        """
        from scipy.optimize import least_squares

        end = self.wanted.end

        def residuals(logarithms: Floats) -> Floats:
            """Mean differences of the steps, relative to the peak."""
            force = self.force(logarithms, end)
            return self.misfits(force).of_means

        def sum_of_squares(logarithms: Floats) -> float:
            """Sum of the squares of the residuals."""
            squares = residuals(logarithms) ** 2
            return float(np.sum(squares))

        # The mean difference of the wanted force from no force is its mean.
        nothing = no_force(end)
        steps = differences(nothing, self.wanted, self.edges)
        force = steps.mean[: self.segments]  # the steps after these are ringing
        peeled = self.peeled(force)
        matched = self.matched(force)
        starts = [peeled, matched]
        if coarser.size:
            positions = _middles(self.segments)
            coarser_positions = _middles(coarser.size)
            starts.append(np.interp(positions, coarser_positions, coarser))
        start = min(starts, key=sum_of_squares)
        best = least_squares(
            residuals,
            start,
            bounds=tuple(self.bounds),
            method="dogbox",
            diff_step=1e-5,
            max_nfev=MAX_EVALUATIONS,
            ftol=1e-4,
            xtol=1e-8,
            gtol=None,
        ).x
        reached = self.force(best, end)
        misfits = self.misfits(reached)
        of_means = np.linalg.norm(misfits.of_means)
        within_steps = float(np.linalg.norm(misfits.within_steps))
        return Striker(
            best,
            misfit=math.hypot(of_means, within_steps),
            misfit_within_steps=within_steps,
        )


def _middles(segments: int) -> Floats:
    """Middles of segments along a striker of length 1."""
    numbers = np.arange(segments)
    middles: Floats = (numbers + 0.5) / segments
    return middles
