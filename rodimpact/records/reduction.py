"""Stress and strain of a specimen between two bars, with error bands, from the bar strains.

With the strains of the waves at the two faces, compression positive (incident i, reflected r,
transmitted t)::

    F1 = E1 A1 (i + r)   F2 = E2 A2 t      v1 = c1 (i - r)   v2 = c2 t
    strain rate (v1 - v2)/L0               stress F2/A0 (one wave), F1/A0 (two), their mean (three)

H. Kolsky, Proceedings of the Physical Society B 62 (1949) 676; W. Chen and B. Song, Split Hopkinson
(Kolsky) Bar (Springer, 2011). All steps except the last are linear. The error band therefore
follows from two contributions: noise drawn at random from the records, and the errors of a
calibration. Both go through the same linear steps as the curve.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..model.arguments import array, flag, integer, of_kind, scalar
from ..model.bodies import Rod
from ..model.frozen import (
    FrozenDataclass,
    Problems,
    invalid_argument,
    quantity,
    raise_if_problems,
)
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, Report, check_progress
from ..storage.tables import align
from ..units import format_si, shown
from .bars import QUIET, Compression, Side, sides_of
from .calibration import Calibration, with_gains, with_one_error
from .doubts import DoubtfulReduction, Faces, doubts_of
from .signal import Signal
from .together import signals_to_xarray, write_signals

MOST_POINTS = 10**6  # strains of a mean curve
DRAWS = 24  # of the noise; 8 where two gauges make each of them costly
TWO_GAUGE_DRAWS = 8
PIECES = 8  # of the rest before the pulse, of which noise is drawn
COVER = 2.36  # standard errors of 95 %, by Student with as many pieces less one
SHOWN = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5)  # strains of the printed table
ELASTIC = 0.5  # of the largest stress: below it a start is taken to be elastic


class Specimen(FrozenDataclass):
    """A specimen between two bars.

    Parameters
    ----------
    length : float
        L0 before the shot, m.
    area, diameter : float
        A0, m^2, or the diameter of a round specimen, m: one of the two.
    youngs_modulus : float, optional
        Of the initial elastic part, Pa; `reduce` can align the waves with it.
    incompressible : bool
        Whether the volume of the specimen is constant; true stress and strain need this.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Examples
    --------
    >>> copper = Specimen(length=3.2e-3, diameter=6.34e-3, incompressible=True)
    >>> round(copper.section * 1e6, 2)
    31.57
    """

    length: float = quantity("m", "positive", scalar=True)
    _: KW_ONLY
    area: float | None = quantity("m^2", "positive", default=None, scalar=True)
    diameter: float | None = quantity("m", "positive", default=None, scalar=True)
    youngs_modulus: float | None = quantity("Pa", "positive", default=None, scalar=True)
    incompressible: bool = False

    def _check(self, problems: Problems) -> None:
        if (self.area is None) == (self.diameter is None):
            problems.append(("area", "give either area or diameter"))
        flag("incompressible", self.incompressible)

    @property
    def section(self) -> float:
        """A0, m^2."""
        if self.area is not None:
            return self.area
        assert self.diameter is not None
        return math.pi * self.diameter**2 / 4


@dataclass(frozen=True, eq=False)
class Curve:
    """Columns of `Reduction` that are linear in the gauge strains; shape (n,) each."""

    times: Floats
    strain: Floats
    strain_rate: Floats
    input_force: Floats
    output_force: Floats
    input_velocity: Floats
    output_velocity: Floats
    specimen: Specimen

    @property
    def stress(self) -> Floats:
        """Nominal stress from the transmitted wave alone, Pa, shape (n,)."""
        return self.output_force / self.specimen.section

    @property
    def loading(self) -> slice:
        """Samples up to the largest strain."""
        return slice(0, int(self.strain.argmax()) + 1)

    def at_strain(self, strain: Any, column: Floats) -> Floats:
        """A column while loading, at strains instead of times.

        Parameters
        ----------
        strain : float or array
            Strains; below the first and above the largest strain of the shot, its first and its
            last value hold.
        column : array, shape (n,)
            One of the columns, such as ``reduction.stress``.

        Raises
        ------
        InvalidModel
            If the column has not as many numbers as `times`.
        """
        wanted = array("strain", strain, "", "any")
        numbers = array("column", column, "")
        if numbers.shape != self.times.shape:
            message = f"must be a column of {len(self.times)} numbers, such as .stress"
            raise invalid_argument("column", f"{message}, got {shown(column)}")
        up = self.loading
        found: Floats = np.interp(
            wanted, np.maximum.accumulate(self.strain[up]), numbers[up]
        )
        return found


class Shifts(NamedTuple):
    """How much earlier waves are taken than they were recorded, s."""

    reflected: float = 0.0
    transmitted: float = 0.0  # and the wave back to the specimen in the output bar


NO_SHIFTS = Shifts()


@dataclass(frozen=True, eq=False)
class Reduction(Curve):
    """Stress and strain of a specimen over time, compression positive; made by `reduce`.

    Attributes
    ----------
    times : array, shape (n,)
        Times at the faces of the specimen, with the zero of the records, s.
    strain, strain_rate : array, shape (n,)
        Nominal: decrease of length divided by `Specimen.length`, 1 and 1/s.
    stress, two_wave_stress, three_wave_stress : array, shape (n,)
        Nominal, from the force of the output bar, the force of the input bar, and the mean of both,
        Pa.
    input_force, output_force : array, shape (n,)
        On the two faces, N.
    input_velocity, output_velocity : array, shape (n,)
        Of the two faces, m/s.
    stress_band, strain_band : array, shape (n,)
        Half widths of the 95 % bands: noise, errors of a calibration, and the frequencies that the
        bars cannot carry.
    one_sample : array, shape (n,)
        Largest change of `stress` at the same strain if the transmitted wave is shifted by one
        sample, Pa.
    shifts : (reflected, transmitted)
        Times by which the reflected and the transmitted wave were moved earlier to align them, s.
    specimen : Specimen
    disperses : bool
        Whether the waves were propagated with the exact first mode.
    doubts : tuple of str
        Where the records contradict what was given: gauges of one bar that disagree, waves that
        arrive too early or too late, shifts at the limit of `align_within`, forces out of balance.
        One sentence each, with its number and a remedy; empty for a shot without contradictions.

    Examples
    --------
    The specimen of this computed shot is a spring, so its modulus is k L0/A0 = 20 GPa:

    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> middle = abs(found.stress - found.stress.max() / 2).argmin()
    >>> round(found.stress[middle] / found.strain[middle] / 1e9)
    20
    """

    stress_band: Floats
    strain_band: Floats
    one_sample: Floats
    shifts: Shifts
    disperses: bool
    doubts: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<Reduction of {len(self.times)} samples, strain up to {self.strain.max():.3g}>"

    @property
    def two_wave_stress(self) -> Floats:
        """Nominal stress from the incident and the reflected wave, Pa, shape (n,)."""
        return self.input_force / self.specimen.section

    @property
    def three_wave_stress(self) -> Floats:
        """Mean of the stresses at both faces, Pa, shape (n,)."""
        return (self.stress + self.two_wave_stress) / 2

    @property
    def equilibrium(self) -> Floats:
        """Difference of the forces over their mean, 2 (F1 - F2)/(F1 + F2); nan without force."""
        total = self.input_force + self.output_force
        total[np.abs(total) < 1e-2 * np.abs(total).max()] = np.nan
        return 2 * (self.input_force - self.output_force) / total

    @property
    def energy(self) -> Floats:
        """Energy absorbed by the specimen, the integral of F1 v1 - F2 v2, J, shape (n,)."""
        power = (
            self.input_force * self.input_velocity
            - self.output_force * self.output_velocity
        )
        return _integral(power, self.times)

    @property
    def true_strain(self) -> Floats:
        """-ln(1 - strain), shape (n,); ValueError unless the specimen is incompressible."""
        self._keeps_volume()
        return -np.log1p(-self.strain)

    @property
    def true_stress(self) -> Floats:
        """Stress (1 - strain), Pa, shape (n,); ValueError unless the specimen is incompressible."""
        self._keeps_volume()
        return self.stress * (1 - self.strain)

    def _keeps_volume(self) -> None:
        if not self.specimen.incompressible:
            message = "true stress and strain need a constant volume"
            raise invalid_argument(
                "specimen", f"{message}: give Specimen(..., incompressible=True)"
            )

    @property
    def signals(self) -> dict[str, Signal]:
        """All columns as signals, by name."""
        told = {
            "strain": "",
            "strain_rate": "1/s",
            "stress": "Pa",
            "stress_band": "Pa",
            "strain_band": "",
            "one_sample": "Pa",
            "two_wave_stress": "Pa",
            "three_wave_stress": "Pa",
            "input_force": "N",
            "output_force": "N",
            "input_velocity": "m/s",
            "output_velocity": "m/s",
            "energy": "J",
        }
        if self.specimen.incompressible:
            told |= {"true_strain": "", "true_stress": "Pa"}
        return {
            name: Signal(getattr(self, name), self.times, unit=unit, name=name)
            for name, unit in told.items()
        }

    def to_csv(self, path: str, *, force: bool = False) -> None:
        """Write all columns over time; FileExistsError as `write_signals`."""
        write_signals(path, self.signals, force=force)

    def to_xarray(self) -> Any:
        """Return all columns as a Dataset over ``time`` (extra ``xarray``)."""
        return signals_to_xarray(self.signals)

    def __str__(self) -> str:
        """Table of stress at several strains, then alignment, energy and doubts."""
        strain = np.maximum.accumulate(self.strain[self.loading])
        rows = [
            ["strain", "strain rate", "stress", "+-", "one sample", "(F1 - F2)/mean"]
        ]
        for at in (*(e for e in SHOWN if e < strain[-1]), strain[-1]):
            i = int(np.searchsorted(strain, at))
            rows.append(
                [
                    f"{100 * self.strain[i]:.3g} %",
                    f"{self.strain_rate[i]:.0f} 1/s",
                    format_si(self.stress[i], "Pa", 4),
                    format_si(self.stress_band[i], "Pa", 2),
                    format_si(self.one_sample[i], "Pa", 2),
                    f"{100 * self.equilibrium[i]:.1f} %",
                ]
            )
        way = "with the exact first mode" if self.disperses else "without dispersion"
        reflected = f"{1e6 * self.shifts.reflected:.3g} us"
        transmitted = f"{1e6 * self.shifts.transmitted:.3g} us"
        doubts = "".join(f"\ndoubtful: {doubt}" for doubt in self.doubts)
        return align(rows) + (
            f"\nstress from the transmitted wave; waves propagated {way}; reflected wave moved "
            f"{reflected} earlier, transmitted wave {transmitted}\n"
            f"energy absorbed: {format_si(self.energy[self.loading][-1], 'J', 3)}; the waves are "
            f"separated until {1e6 * (self.times[-1] - self.times[0]):.4g} us after they arrive"
            f"{doubts}"
        )


def reduce(
    input_gauges: Any,
    output_gauges: Any,
    bars: Rod | tuple[Rod, Rod] | Calibration,
    specimen: Specimen,
    *,
    compression: Compression = "negative",
    align_within: float = 0.0,
    progress: bool | ProgressFunction = True,
) -> Reduction:
    """Stress, strain and energy of a specimen from the gauges of its two bars.

    Parameters
    ----------
    input_gauges, output_gauges : BarGauge or two of them
        Gauges of the input bar, which the striker hits, and of the output bar. Two gauges on a bar
        separate waves that overlap at each gauge.
    bars : Rod, (Rod, Rod) or Calibration
        Input and output bar, or one rod if both are alike. In a round bar with a Poisson ratio,
        waves disperse as in the exact first mode. The lengths give the times at which waves return
        from the far ends.
    specimen : Specimen
    compression : str
        Sign of a strain that compresses in the records: ``"negative"`` or ``"positive"``.
    align_within : float
        Largest shift of the reflected and of the transmitted wave, s. The shifts make the forces on
        both faces equal and, if the specimen has a `youngs_modulus`, the initial slope equal to it.
        0: only distances and wave speeds align the waves.
    progress : bool or function
        Whether a bar may show how far long work is. A function is called with the number of curves
        that are done, and of all, None where that is not known.

    Returns
    -------
    Reduction

    Raises
    ------
    InvalidModel
        If an argument is invalid, or a record does not begin with rest and then a compression.
    ValueError
        If the incident and the reflected wave overlap at the only gauge of the bar.

    Warns
    -----
    DoubtfulReduction
        For each of `Reduction.doubts`.

    Examples
    --------
    The incident strain, 1e-3, is transmitted fully: the force is E A 1e-3, the specimen strain 0.

    >>> import rodimpact as ri
    >>> shape = 1e-3 * np.clip(np.minimum(np.arange(400) - 100, 250 - np.arange(400)) / 10, 0, 1)
    >>> incident = ri.Signal(-shape, dt=1e-6)
    >>> transmitted = incident.shifted(2e-4).extended(before=2e-4)
    >>> bar = ri.Rod(1.5, area=1e-4, material=ri.Material("m", youngs_modulus=2e11, density=8000))
    >>> found = ri.reduce(ri.BarGauge(incident, 0.5), ri.BarGauge(transmitted, 0.5), bar,
    ...                   ri.Specimen(5e-3, area=1e-4))
    >>> round(found.stress.max() / 1e6), bool(abs(found.strain).max() < 1e-12)
    (200, True)
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    of_kind("specimen", specimen, Specimen, "ri.Specimen(length=5e-3, diameter=8e-3)")
    limit = scalar("align_within", align_within, "s", "non-negative")
    calibration = bars if isinstance(bars, Calibration) else None
    rods = calibration.bars if calibration else bars
    recorded: tuple[Side, ...] = sides_of(
        input_gauges, output_gauges, rods, compression
    )
    # from the arrival at the specimen as long as the records separate the waves
    input_side = recorded[0]
    travel = float(input_side.distances[0]) / input_side.speed
    start = input_side.foot + travel
    end = min(side.clean_until() for side in recorded)
    dt = input_side.dt
    count = int((end - start) / dt)
    if count < QUIET:
        message = (
            f"the wave reaches the specimen at {start:.6g} s, but from {end:.6g} s on "
            "the records do not separate the waves; use longer records or bars, and "
            "check the distances"
        )
        raise invalid_argument("input_gauges", message)
    sides = recorded
    if calibration:
        sides = with_gains(calibration, recorded)
    shot = _Shot(sides, specimen, start + dt * np.arange(count, dtype=float))
    with Progress(progress, "reduce", "curves") as report:
        if limit:
            shot = shot.aligned(limit, report)
        curve = shot.curve()
        stress_band, strain_band = shot.bands(curve, calibration, report)
    disperses = all(side.mode for side in shot.sides)
    faces = Faces(
        curve.specimen.length,
        curve.input_force,
        curve.output_force,
        curve.input_velocity,
    )
    doubts = doubts_of(recorded, faces, shot.shifts, limit)
    for doubt in doubts:
        warnings.warn(doubt, DoubtfulReduction, stacklevel=2)
    return Reduction(
        **vars(curve),
        stress_band=stress_band,
        strain_band=strain_band,
        one_sample=shot.one_sample(curve),
        shifts=shot.shifts,
        disperses=disperses,
        doubts=doubts,
    )


@dataclass(frozen=True)
class _Shot:
    """Both bars of a shot, the times at which both faces are known, and the alignment."""

    sides: tuple[Side, ...]  # input bar, output bar
    specimen: Specimen
    times: Floats
    shifts: Shifts = NO_SHIFTS

    def curve(self) -> Curve:
        """Forces, velocities and strain of the strains that the sides hold.

        With the compressive strains of the waves at the faces::

            v1 = c1 (incident - reflected)       F1 = E1 A1 (incident + reflected)
            v2 = c2 (transmitted - returning)    F2 = E2 A2 (transmitted + returning)
            strain rate = (v1 - v2)/length
        """
        input_bar, output_bar = self.sides
        towards, away = input_bar.at_face()
        incident = self._sampled(input_bar, towards, 0.0)
        reflected = self._sampled(input_bar, away, self.shifts.reflected)
        towards, away = output_bar.at_face()
        returning = self._sampled(output_bar, towards, self.shifts.transmitted)
        transmitted = self._sampled(output_bar, away, self.shifts.transmitted)

        input_velocity = input_bar.speed * (incident - reflected)
        output_velocity = output_bar.speed * (transmitted - returning)
        rate = (input_velocity - output_velocity) / self.specimen.length
        return Curve(
            times=self.times,
            strain=_integral(rate, self.times),
            strain_rate=rate,
            input_force=input_bar.stiffness * (incident + reflected),
            output_force=output_bar.stiffness * (transmitted + returning),
            input_velocity=input_velocity,
            output_velocity=output_velocity,
            specimen=self.specimen,
        )

    def _sampled(self, side: Side, wave: Floats, shift: float) -> Floats:
        """A wave at the times of the curve, taken earlier by a shift, s."""
        sampled: Floats = np.interp(self.times + shift, side.times, wave)
        return sampled

    def aligned(self, limit: float, report: Report) -> _Shot:
        """The shot with the shifts that make its start elastic and its forces alike."""
        from scipy.optimize import least_squares

        stress = self.curve().stress
        largest = stress.max()
        start = slice(0, int(np.argmax(stress > ELASTIC * largest)) + 1)
        modulus = self.specimen.youngs_modulus
        curves = 0

        def residuals(shifts: Floats) -> Floats:
            """Imbalance of forces, and distance from the elastic line, over the stress."""
            nonlocal curves
            curves += 1
            report(curves, None)
            curve = replace(self, shifts=Shifts(*shifts)).curve()
            imbalance = curve.input_force - curve.output_force
            parts = [imbalance[start] / self.specimen.section]
            if modulus is not None:
                parts.append((curve.stress - modulus * curve.strain)[start])
            relative: Floats = np.concatenate(parts) / largest
            return relative

        solution = least_squares(
            residuals,
            (0.0, 0.0),
            bounds=(-limit, limit),
            diff_step=1e-3,
            x_scale=self.sides[0].dt,
        )
        return replace(self, shifts=Shifts(*solution.x.tolist()))

    def one_sample(self, curve: Curve) -> Floats:
        """Change of the stress at equal strain by a sample of the transmitted wave, Pa."""
        dt = self.sides[1].dt
        stresses = []
        for step in (-dt, dt):
            shifts = self.shifts._replace(transmitted=self.shifts.transmitted + step)
            moved = replace(self, shifts=shifts).curve()
            stresses.append(moved.at_strain(curve.strain, moved.stress))
        change: Floats = np.abs(np.array(stresses) - curve.stress).max(axis=0)
        return change

    def bands(
        self, curve: Curve, known: Calibration | None, report: Report
    ) -> tuple[Floats, Floats]:
        """Bands of 95 % of stress and strain: from noise, and from other constants of the bars."""
        rng = np.random.default_rng(0)
        count = DRAWS
        if max(len(side.distances) for side in self.sides) > 1:
            count = TWO_GAUGE_DRAWS
        drawn = []
        for k in range(count):
            noise = tuple(_noise(side, rng) for side in self.sides)
            drawn.append(replace(self, sides=noise).curve())
            report(k + 1, count)
        with_errors = []
        if known is not None:
            for sides in with_one_error(known, self.sides):
                with_errors.append(replace(self, sides=sides).curve())

        def band(column: Callable[[Curve], Floats]) -> Floats:
            variance = np.mean([column(each) ** 2 for each in drawn], axis=0)
            variance += sum((column(each) - column(curve)) ** 2 for each in with_errors)
            kept = np.mean([self._fine(column(each)) for each in drawn], axis=0)
            lost = np.maximum(self._fine(column(curve)) - kept, 0.0)
            return np.asarray(COVER * np.sqrt(variance + lost))

        return band(lambda each: each.stress), band(lambda each: each.strain)

    def _fine(self, column: Floats) -> Floats:
        """Local mean square of what lies in the last octave that records and bars carry.

        What lies above it is lost; behind a kink the two are of one size.
        """
        side = self.sides[0]
        half = min(side.cut_off, 0.5 / side.dt) / 2
        fine = column - Signal(column, dt=side.dt).low_pass(half).values
        width = min(2 * math.ceil(1 / half / side.dt) + 1, len(column))
        square: Floats = np.convolve(fine**2, np.full(width, 1 / width), "same")
        return square


def _noise(side: Side, rng: np.random.Generator) -> Side:
    """A side that records nothing but noise: pieces of its rest, drawn at random.

    Pieces, not samples, since noise may be coloured; short ones, since the mean of all of the rest
    is 0, as that of the noise is not.
    """
    piece = max(2, side.quiet // PIECES)
    count = len(side.times)
    drawn = []
    for strain in side.strains:
        starts = rng.integers(0, side.quiet - piece + 1, count // piece + 1)
        noise = strain[starts[:, None] + np.arange(piece)].ravel()[:count]
        drawn.append(noise - noise[: side.quiet].mean())
    less = math.sqrt(1 - piece / side.quiet)  # by so much the sums of pieces vary less
    return side._replace(strains=np.array(drawn) / less)


def _integral(rate: Floats, times: Floats) -> Floats:
    """Integral from the first time on, by trapezia."""
    from scipy.integrate import cumulative_trapezoid

    total: Floats = cumulative_trapezoid(rate, times, initial=0)
    return total


class Shots(NamedTuple):
    """Mean curve of several shots.

    Attributes
    ----------
    strain : array, shape (n,)
        From 0 to the largest strain that all shots reach.
    stress, strain_rate : array, shape (n,)
        Means, Pa and 1/s.
    scatter : array, shape (n,)
        Standard deviation of the stress from shot to shot, Pa.
    shots : int
        How many.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> mean = ri.mean_of_shots([found, found], points=11)
    >>> len(mean.strain), bool(mean.strain[-1] == found.strain.max())
    (11, True)
    """

    strain: Floats
    stress: Floats
    strain_rate: Floats
    scatter: Floats
    shots: int


def mean_of_shots(shots: Sequence[Reduction], points: int = 201) -> Shots:
    """Mean and scatter of the stress of several shots over their strain.

    Parameters
    ----------
    shots : sequence of Reduction
        Two or more.
    points : int
        Number of common strains, 2 or more.

    Raises
    ------
    InvalidModel
        If there are fewer than two shots.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> mean = ri.mean_of_shots([found, found])
    >>> mean.shots, float(mean.scatter.max())
    (2, 0.0)
    """
    given = isinstance(shots, Sequence) and len(shots) > 1
    if not given or not all(isinstance(each, Reduction) for each in shots):
        raise invalid_argument(
            "shots",
            f"must be two or more Reductions from ri.reduce, got {shown(shots)}",
        )
    points = integer("points", points, 2, MOST_POINTS)
    strain = np.linspace(0, min(float(each.strain.max()) for each in shots), points)
    columns = np.array(
        [
            [
                each.at_strain(strain, each.stress),
                each.at_strain(strain, each.strain_rate),
            ]
            for each in shots
        ]
    )
    stress, rate = columns.mean(axis=0)
    scatter = columns[:, 0].std(axis=0, ddof=1)
    return Shots(strain, stress, rate, scatter, len(shots))
