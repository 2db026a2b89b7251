"""A stepped striker whose first pulse follows a wanted shape.

The struck bar hears of a segment one round trip after the segment before it, so step k of the pulse
decides segment k when those before are known (layer peeling): the force is a straight line in the
reflection from there, and two solutions, with nothing and with a free end behind what is known,
give that line. Steps that no area gives, and the ringing afterwards, are left to least squares.
All waves are those of `rodimpact.solve`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..model import Absorbing, Bonded, Free, Material, Rigid, Rod, Segment, System
from ..model.arguments import array, of_kind, single, whole
from ..model.ends import FREE
from ..model.frozen import Problems, raise_noted, refusal
from ..model.laws import RIGID
from ..model.profiles import Steps
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, check_progress
from ..records.signal import Signal
from ..running.solving import solve
from ..units import shown
from .pulses import INSTANT, PulseDesign, differences, force_over_time, staircase

AREA_RATIO = (
    1 / 9,
    9 / 4,
)  # diameters from a third to one and a half times that of the bar
MOST_SEGMENTS = 50
LONGEST = 20  # durations until when the pulse may be asked for
LEAST = 1e-6  # parts of the speed, or of a wave, by which a start keeps off what has no area
MOST_STEPS = 8  # of least squares for each number of segments
PERFECT = 1e-12  # misfit that is round-off
BETTER = 1e-9  # of a misfit: less is round-off, and no reason for more segments
AT_BOUND = 1e-6  # of an area, by which it is at an end of what is allowed


class _Search(NamedTuple):
    """Strikers of so many segments that are to send a force, N, into a bar.

    An array of logarithms is a striker: of areas over that of the bar, from the struck end on.
    """

    bar: Rod
    material: Material
    velocity: float
    duration: float  # of the pulse, s
    contact: Rigid | Bonded
    wanted: Signal
    bounds: Floats  # of the logarithms
    segments: int

    @property
    def area(self) -> float:
        """Of the bar, m^2."""
        return float(np.asarray(self.bar.segments[0].area))

    @property
    def edges(self) -> Floats:
        """Times of the steps, s."""
        step, end = self.duration / self.segments, self.wanted.end
        return np.append(step * np.arange(math.ceil(end / step * (1 - INSTANT))), end)

    def system(self, logarithms: Floats, behind: Free | Absorbing = FREE) -> System:
        """The striker and the bar."""
        length = self.duration / 2 * self.material.wave_speed / self.segments
        segments = [
            Segment(length, self.area * math.exp(each), self.material)
            for each in logarithms[::-1]
        ]
        row = [Rod(segments=segments, velocity=self.velocity), self.bar]
        return System(row, contacts=[self.contact], ends=(behind, Absorbing()))

    def force(
        self, logarithms: Floats, until: float, behind: Free | Absorbing = FREE
    ) -> Signal:
        """Force on the bar, N."""
        run = solve(self.system(logarithms, behind), until=until, method="fronts")
        times, force, _ = run.contacts[0].breakpoints()
        return staircase(times, force, until, "force on the bar")

    def matched(self, force: Floats) -> Floats:
        """The striker each of whose areas alone would give its step of the force, N."""
        bar = self.bar.segments[0]
        velocity = np.clip(force / (bar.impedance * self.velocity), LEAST, 1 - LEAST)
        impedance = velocity / (1 - velocity) * bar.impedance
        areas = impedance / (self.material.density * self.material.wave_speed)
        return np.clip(np.log(areas / self.area), *self.bounds)

    def peeled(self, force: Floats) -> Floats:
        """The striker that gives these first steps, N, one after the other, within the bounds."""
        found = self.matched(force[:1])
        bonded = self._replace(contact=Bonded())
        for k in range(1, len(force)):
            silent, free = (
                bonded.force(found, self.edges[k + 1], behind).values[-1]
                for behind in (Absorbing(), FREE)
            )
            heard = free - silent
            reflection = (force[k] - silent) / heard if heard else 0.0
            reflection = min(max(reflection, LEAST - 1), 1 - LEAST)
            step = math.log((1 - reflection) / (1 + reflection))
            found = np.append(found, np.clip(found[-1] + step, *self.bounds))
        return found

    def parts(self, reached: Signal) -> tuple[Floats, Floats]:
        """Mean and standard deviation of the difference in each step, as parts of the misfit."""
        share = (
            np.diff(self.edges)
            / self.wanted.end
            / np.abs(self.wanted.values).max() ** 2
        )
        mean, variance = differences(self.wanted, reached, self.edges)
        return np.sqrt(share) * mean, np.sqrt(share * variance)

    def descend(self, coarser: Floats) -> _Found:
        """Least squares from the best of three starts, one of them a striker of fewer segments."""
        from scipy.optimize import least_squares

        def residual(logarithms: Floats) -> Floats:
            return self.parts(self.force(logarithms, self.wanted.end))[0]

        silence = staircase([0.0], [0.0], self.wanted.end, "nothing")
        force = differences(silence, self.wanted, self.edges)[0][: self.segments]
        starts = [self.peeled(force), self.matched(force)]
        if coarser.size:
            here, there = (
                (np.arange(n) + 0.5) / n for n in (self.segments, coarser.size)
            )
            starts.append(np.interp(here, there, coarser))
        best = least_squares(
            residual,
            min(starts, key=lambda start: float(np.sum(residual(start) ** 2))),
            bounds=tuple(self.bounds),
            method="dogbox",
            diff_step=1e-5,
            max_nfev=MOST_STEPS,
            ftol=1e-4,
            xtol=1e-8,
            gtol=None,
        ).x
        mean, within = map(
            np.linalg.norm, self.parts(self.force(best, self.wanted.end))
        )
        return _Found(best, math.hypot(mean, within), float(within))


class _Found(NamedTuple):
    """A striker, and the misfit: all of it, within steps."""

    logarithms: Floats
    misfit: float
    within: float


def striker(
    wanted: Signal | Steps,
    bar: Rod,
    *,
    velocity: float,
    duration: float,
    until: float | None = None,
    segments: int = 10,
    area_ratio: tuple[float, float] = AREA_RATIO,
    material: Material | None = None,
    contact: Rigid | Bonded = RIGID,
    progress: bool | ProgressFunction = True,
) -> PulseDesign:
    """Find a stepped striker that sends a pulse of a wanted shape into a bar.

    Parameters
    ----------
    wanted : Signal or Steps
        Force on the struck end of the bar over the time since impact, N, positive in compression;
        a signal is 0 outside of its record.
    bar : Rod
        Uniform, at rest; it is taken to go on for ever.
    velocity : float
        Of the striker, m/s.
    duration : float
        Of the pulse, s: two transits of the striker, whose segments all have the same.
    until : float, optional
        Time over which the pulse is to be as wanted, s; by default twice the duration, so that
        ringing counts.
    segments : int
        Of the striker at most, from 1 to 50. Where fewer meet the pulse better, it has fewer; so
        more segments never meet it worse. Ten take about two seconds, forty a minute.
    area_ratio : (float, float)
        Smallest and largest area of a segment over that of the bar. By default diameters are from a
        third to one and a half times that of the bar, which a lathe can make.
    material : Material, optional
        Of the striker; by default that of the bar.
    contact : Rigid or Bonded
        By default the faces only push, so that a force that would pull is 0; the exact inverse of
        a pulse that pulls is found for faces that are `Bonded`.
    progress : bool or function
        Whether a bar may show how far the search is. A function is called with the runs that are
        done, and how many there are.

    Returns
    -------
    PulseDesign
        Its striker is body 0, the last of whose segments strikes the bar. It says which areas are
        at an end of `area_ratio`: the wanted force may then be out of reach.

    Raises
    ------
    InvalidModel or ValueError
        If an argument is not what it should be, or the wanted force pulls at a contact that cannot.

    Notes
    -----
    Areas of `n` steps follow from the first `n` steps of a pulse that a striker can make, to
    round-off times how much the outer segments hide those behind them: steep steps reflect nearly
    all, and what is behind them is hardly heard.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> bar = ri.Rod(2.0, area=3e-4, material=ri.materials.steel)
    >>> peak = 0.4 * bar.segments[0].impedance * 10.0
    >>> ramp = ri.Signal([0.0, peak], [0.0, 100e-6], unit="N")
    >>> found = ri.design.striker(ramp, bar, velocity=10.0, duration=100e-6)
    >>> len(found.system.bodies[0].segments), round(100 * found.misfit, 1)
    (10, 12.9)
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_noted(problems)
    of_kind("bar", bar, Rod, "Rod(2.0, area=1e-4, material=materials.steel)")
    steel = bar.segments[0].material if material is None else material
    of_kind("material", steel, Material, "materials.steel")
    if len(bar.segments) != 1 or System([bar]).shape or bar.velocity or bar.strain:
        raise refusal("bar", f"must be a single uniform rod at rest, got {shown(bar)}")
    if np.any(steel.viscosity):
        raise refusal("material", f"must have no viscosity, got {shown(steel.name)}")
    if not isinstance(contact, Rigid | Bonded):
        raise refusal("contact", f"must be Rigid() or Bonded(), got {shown(contact)}")
    V = single("velocity", velocity, "m/s", "positive")
    T = single("duration", duration, "s", "positive")
    end = 2 * T if until is None else single("until", until, "s", "positive")
    segments = whole("segments", segments, 1, MOST_SEGMENTS)
    if not T * (1 - INSTANT) <= end <= LONGEST * T:
        message = f"must be from the duration, {T!r} s, to {LONGEST} times that"
        raise refusal("until", f"{message}, got {end!r}")
    ratios = array("area_ratio", area_ratio, "", "positive")
    if ratios.shape != (2,) or not ratios[0] < ratios[1]:
        raise refusal(
            "area_ratio", f"must be (smallest, largest), got {shown(area_ratio)}"
        )
    force = force_over_time(wanted, end)
    if not force.values.any():
        raise refusal(
            "wanted", "is 0 from impact on; give the force over the time since then"
        )
    lowest = float(force.values.min())
    if lowest < 0 and isinstance(contact, Rigid):
        raise refusal(
            "wanted",
            f"pulls with {-lowest!r} N, and faces only push; make it 0 there, "
            "or take contact=Bonded()",
        )
    search = _Search(bar, steel, V, T, contact, force, np.log(ratios), segments)
    found: list[_Found] = []
    silence = staircase([0.0], [0.0], search.wanted.end, "nothing")
    if search.parts(silence)[1].max() <= PERFECT:  # steps: they may be met exactly
        found = [search.descend(np.zeros(0))]
    if not found or found[0].misfit >= PERFECT:
        # a striker of n segments takes n + 1 runs a step
        total = segments * (segments + 3) // 2
        found = []
        with Progress(progress, "striker", "runs") as report:
            for n in range(1, segments + 1):
                coarser = found[-1].logarithms if found else np.zeros(0)
                found.append(search._replace(segments=n).descend(coarser))
                report(n * (n + 3) // 2, total)
    least = min(each.misfit for each in found)
    best = next(each for each in found if each.misfit * (1 - BETTER) <= least)
    search = search._replace(segments=len(best.logarithms))
    bounded = {
        i: name
        for bound, name in zip(search.bounds, ("smallest", "largest"), strict=True)
        for i in np.flatnonzero(
            np.abs(best.logarithms[::-1] - bound) <= AT_BOUND
        ).tolist()
    }
    return PulseDesign(
        search.system(best.logarithms),
        0,
        search.wanted,
        search.force(best.logarithms, search.wanted.end),
        best.misfit,
        best.within,
        bounded,
    )
