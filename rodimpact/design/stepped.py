"""A stepped striker whose first pulse follows a wanted shape.

The struck bar hears of a segment one round trip after the segment before it, so step k of the pulse
decides segment k when those before are known (layer peeling): the force is a straight line in the
reflection from there, and two solutions, with nothing and with a free end behind what is known,
give that line. Steps that no area gives, and the ringing afterwards, are left to least squares.
All waves are those of `rodimpact.solve`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..model import Absorbing, Bonded, Free, Material, Rigid, Rod, Segment, System
from ..model.arguments import array, of_kind, positive, single
from ..model.ends import FREE
from ..model.laws import RIGID
from ..model.profiles import Steps
from ..model.quantities import Floats
from ..records.signal import Signal
from ..running.solving import solve
from ..units import shown
from .pulses import PulseDesign, differences, force_over_time, staircase

WIDEST = (math.exp(-4.0), math.exp(1.5))  # area ratios
MOST_SEGMENTS = 100
MOST_STEPS = 30  # of least squares from each start
PERFECT = 1e-12  # misfit that is round-off


class _Shot(NamedTuple):
    """What is not varied: bar, material and speed of the striker, length of a segment, contact."""

    bar: Rod
    material: Material
    velocity: float
    length: float
    contact: Rigid | Bonded

    @property
    def impedance(self) -> float:
        """Of the striker, for each m^2 of its area, kg/(m^2 s)."""
        return float(self.material.density * self.material.wave_speed)

    def system(self, areas: Floats, behind: Free | Absorbing = FREE) -> System:
        """The shot; areas from the struck end on, in m^2."""
        segments = [Segment(self.length, float(area), self.material) for area in areas[::-1]]
        row = [Rod(segments=segments, velocity=self.velocity), self.bar]
        return System(row, contacts=[self.contact], ends=(behind, Absorbing()))

    def force(self, system: System, until: float) -> Signal:
        """Force on the bar, N."""
        times, force, _ = solve(system, until=until, method="fronts").contacts[0].breakpoints()
        return staircase(times, force, until, "force on the bar")

    def peeled(self, force: Floats, low: float, high: float) -> Floats:
        """Areas within bounds, m^2, that give these first steps, N, one after the other."""
        step = 2 * self.length / float(self.material.wave_speed)
        speed = self.velocity - force[0] / float(self.bar.segments[0].impedance)
        first = force[0] / (speed * self.impedance) if speed > 0 else high
        areas = [min(max(first, low), high)]
        bonded = self._replace(contact=Bonded())
        for k in range(1, len(force)):
            silent, free = (
                bonded.force(bonded.system(np.array(areas), behind), (k + 1) * step).values[-1]
                for behind in (Absorbing(), FREE))
            reflection = (force[k] - silent) / (free - silent)
            reflection = min(max(reflection, -0.999), 0.999)
            area = areas[-1] * (1 - reflection) / (1 + reflection)
            areas.append(min(max(area, low), high))
        return np.array(areas)


def striker(
    wanted: Signal | Steps, bar: Rod, *, velocity: float, duration: float,
    until: float | None = None, segments: int = 10, area_ratio: tuple[float, float] = WIDEST,
    material: Material | None = None, contact: Rigid | Bonded = RIGID,
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
        Of the striker, from 1 to 100.
    area_ratio : (float, float)
        Smallest and largest area of a segment over that of the bar.
    material : Material, optional
        Of the striker; by default that of the bar.
    contact : Rigid or Bonded
        By default the faces only push, so that a force that would pull is 0; the exact inverse of
        a pulse that pulls is found for faces that are `Bonded`.

    Returns
    -------
    PulseDesign

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
    (10, 12.8)
    """
    of_kind("bar", bar, Rod, "Rod(2.0, area=1e-4, material=materials.steel)")
    if len(bar.segments) != 1 or not bar.segments[0].ideal or System([bar]).shape:
        raise ValueError(f"bar: must be a single uniform rod without damping, got {shown(bar)}")
    if bar.velocity != 0 or bar.strain != 0:
        raise ValueError("bar: must be at rest and free of strain before impact")
    of_kind("material", material or bar.segments[0].material, Material, "materials.steel")
    if not isinstance(contact, Rigid | Bonded):
        raise ValueError(f"contact: must be Rigid() or Bonded(), got {shown(contact)}")
    V, T = (positive(name, single(name, value, unit), unit).item() for name, value, unit in
            (("velocity", velocity, "m/s"), ("duration", duration, "s")))
    end = 2 * T if until is None else positive("until", single("until", until, "s"), "s").item()
    if isinstance(segments, bool) or segments not in range(1, MOST_SEGMENTS + 1):
        message = f"must be a whole number from 1 to {MOST_SEGMENTS}"
        raise ValueError(f"segments: {message}, got {shown(segments)}")
    ratios = positive("area_ratio", array("area_ratio", area_ratio, ""), "")
    if ratios.shape != (2,) or not ratios[0] < ratios[1]:
        raise ValueError(f"area_ratio: must be (smallest, largest), got {shown(area_ratio)}")
    step = T / segments
    if not end >= T * (1 - 1e-9):
        raise ValueError(f"until: must not be below duration, {T!r} s, got {end!r}")
    force = force_over_time("wanted", wanted, end)
    peak = float(np.abs(force.values).max())
    if peak == 0:
        raise ValueError("wanted: is 0 from impact to `until`; give the force over time since then")
    if force.values.min() < 0 and isinstance(contact, Rigid):
        message = f"pulls, {float(force.values.min())!r} N, and faces only push"
        raise ValueError(f"wanted: {message}; make it 0 there, or take contact=Bonded()")

    steel = bar.segments[0].material if material is None else material
    shot = _Shot(bar, steel, V, step / 2 * float(steel.wave_speed), contact)
    impedance = float(bar.segments[0].impedance)
    area = impedance / float(bar.segments[0].material.density * bar.segments[0].wave_speed)
    edges = np.unique([*(step * np.arange(math.ceil(end / step - 1e-9))), end])
    widths = np.sqrt(np.diff(edges) / end)

    def residual(logarithm: Floats) -> Floats:
        reached = shot.force(shot.system(area * np.exp(logarithm)), end)
        return widths * differences(force, reached, edges)[0] / peak

    bounds = np.log(ratios)
    zero = Signal([0.0, 0.0], [0.0, end], unit="N")
    means = differences(zero, force, edges)[0][:segments]
    starts = [np.log(shot.peeled(means, *(area * ratios)) / area)]
    alone = np.clip(means / (V * impedance), 1e-9, 0.99)
    starts.append(np.log(alone / (1 - alone) * impedance / area / shot.impedance))
    tries: list[Any] = []
    for start in starts:
        tries.append(least_squares(
            residual, np.clip(start, *bounds), bounds=tuple(bounds), method="dogbox",
            diff_step=1e-5, max_nfev=MOST_STEPS, ftol=1e-4, xtol=1e-8, gtol=None))
        if tries[-1].cost < PERFECT**2:
            break
    system = shot.system(area * np.exp(min(tries, key=lambda tried: tried.cost).x))
    reached = shot.force(system, end)
    mean, square = differences(force, reached, edges)
    share = np.diff(edges) / end / peak**2
    return PulseDesign(system, 0, force, reached, float(np.sqrt(share @ mean**2)),
                       float(np.sqrt(np.maximum(0.0, share @ (square - mean**2)))))
