"""Computed shots: Mindlin-Herrmann rods on a grid, and a specimen that is a short rod
with mass.

`reduce` propagates waves by the exact first mode and knows no specimen: this route
shares nothing with it.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

STEEL = ri.Material("steel", youngs_modulus=2e11, density=7850.0, poisson_ratio=0.29)
SOFT = ri.Material("soft", youngs_modulus=1.5e9, density=1200.0, poisson_ratio=0.3)
POLYMER = ri.Material("polymer", youngs_modulus=6e9, density=1200.0, poisson_ratio=0.3)
DIAMETER = 0.016  # m
BAR = ri.Rod(1.5, diameter=DIAMETER, material=STEEL)
SPECIMEN = ri.Specimen(4e-3, diameter=0.012)
PULSE_STRAIN = 1.2e-3
DT = 5e-7  # interval of a record, s
INPUT_BAR = 0  # index of the body in the row of a `Shot`
OUTPUT_BAR = 2
keep_last = lru_cache(maxsize=1)
"""Keeps one shot of each kind: with a state for each sample it takes up to a gigabyte.
"""


def noisy_gauge(record, distance, noise, seed, dt):
    """A gauge at a distance from the specimen, of what a rod strains at one place.

    It begins with a rest of 100 us. The standard deviation of its noise is `noise`
    times `PULSE_STRAIN`; `dt` is its interval, s.
    """
    record_at_steps = record.signal(dt)
    clean = record_at_steps.extended(before=1e-4)
    rng = default_rng(seed)
    white = rng.standard_normal(len(clean))
    noisy = clean.values + noise * PULSE_STRAIN * white
    noisy_signal = clean.replace(values=noisy)
    return ri.BarGauge(noisy_signal, distance)


class Shot(NamedTuple):
    """A solved row of an input bar or a striker, a specimen and an output bar."""

    solution: ri.Solution
    specimen: ri.Specimen = SPECIMEN

    def gauge(self, body, distance, noise=0.002, seed=0, dt=DT):
        """A `noisy_gauge` of `INPUT_BAR` or `OUTPUT_BAR` at a distance from the
        specimen, m.
        """
        x = distance
        if body == INPUT_BAR:
            input_rod = self.solution.system.bodies[0]
            x = float(input_rod.length) - distance
        record = self.solution.gauge(body, x)
        return noisy_gauge(record, distance, noise, seed, dt)

    def strain(self, times):
        """Nominal compressive strain of the specimen; 0 before the run, at t < 0."""
        times = np.maximum(times, 0.0)
        input_rod = self.solution.system.bodies[0]
        end = float(input_rod.length)
        input_face = self.solution.displacement(0, end, times)
        output_face = self.solution.displacement(2, 0.0, times)
        approach = input_face - output_face
        return approach / self.specimen.length

    def stress(self, times):
        """Mean of the nominal stresses at both faces, Pa."""
        times = np.maximum(times, 0.0)
        forces = [contact.force(times) for contact in self.solution.contacts]
        mean_force = np.mean(forces, axis=0)
        return mean_force / self.specimen.section


def rod(length, diameter=DIAMETER, material=STEEL, **changes):
    """A round rod by the theory of Mindlin and Herrmann; `changes` are other arguments
    of `ri.Rod`.
    """
    return ri.Rod(
        length,
        diameter=diameter,
        material=material,
        lateral_inertia="mindlin-herrmann",
        **changes,
    )


def specimen_rod(material=POLYMER):
    """The specimen as a short rod."""
    return rod(SPECIMEN.length, SPECIMEN.diameter, material)


def solved(row, until, cells):
    """A run that keeps a state for each sample of the gauges; fewer would be
    interpolated.
    """
    times_of_samples = np.arange(0.0, until, DT)
    return ri.solve(
        row,
        until=until,
        method="finite-difference",
        cells=cells,
        snapshots=tuple(times_of_samples.tolist()),
        progress=False,
    )


class CalibrationShot(NamedTuple):
    """A striker and two bars without a specimen."""

    solution: ri.Solution

    def gauge(self, body, distance, noise, seed):
        """A `noisy_gauge` on bar 1 or 2, at a distance from the joint of the bars, m."""
        x = distance
        if body == 1:
            first_bar = self.solution.system.bodies[1]
            x = float(first_bar.length) - distance
        record = self.solution.gauge(body, x)
        return noisy_gauge(record, distance, noise, seed, DT)


@keep_last
def calibration_shot():
    """A striker hits a bar that touches another one; the ends of the striker are
    round. It is solved once: a `CalibrationShot`.
    """
    striker = rod(0.3, velocity=12.0)
    bodies = [striker, rod(1.5), rod(1.5)]
    laws = [ri.Hertz(6e10), ri.Rigid()]
    row = ri.System(bodies, contacts=laws)
    solution = solved(row, until=1.4e-3, cells=450)
    return CalibrationShot(solution)


def trapezoid(duration, rise):
    """Levels from 0 to 1 at whole microseconds, of a pulse whose half height lasts
    `duration`, s.
    """
    times = np.arange(0, duration + 2 * rise, 1e-6)
    time_to_end = duration + rise - times
    up = np.clip(times / rise, 0, 1)
    down = np.clip(time_to_end / rise, 0, 1)
    return np.minimum(up, down)


@keep_last
def pressure_bar_shot(
    duration=150e-6, rise=30e-6, length=1.5, until=7e-4, material=POLYMER, cells=450
):
    """A trapezoidal pulse runs through the input bar to the specimen: a solved `Shot`.

    The pulse has a duration and a rise, s; both bars have a length, m.
    """
    level = trapezoid(duration, rise)
    bodies = [rod(length), specimen_rod(material), rod(length)]
    row = row_under_pulse(bodies, level)
    return Shot(solved(row, until, cells))


def row_under_pulse(bodies, level):
    """System of three rods, into which a pulse runs from the left; it is not solved.

    The pulse is a compression of `PULSE_STRAIN` times `level`, at whole microseconds.
    """
    strain = -PULSE_STRAIN * level
    wave = ri.Samples([*strain, 0.0], step=1e-6)  # nothing follows the pulse
    laws = [ri.Rigid(), ri.Rigid()]
    ends = [ri.Incoming(wave), ri.Free()]
    return ri.System(bodies, contacts=laws, ends=ends)


STRIKER = ri.Rod(0.4, diameter=DIAMETER, material=STEEL, velocity=12.0)


@keep_last
def direct_impact(until=7e-4, cells=450):
    """A striker hits a soft specimen with mass, which lies on the output bar: a solved
    `Shot`.
    """
    striker = rod(0.4, velocity=12.0)
    bodies = [striker, specimen_rod(SOFT), rod(1.5)]
    laws = [ri.Rigid(), ri.Rigid()]
    row = ri.System(bodies, contacts=laws)
    return Shot(solved(row, until, cells))


class LawShot(NamedTuple):
    """A striker that hits a bar through a specimen without mass, a contact law."""

    solution: ri.Solution
    specimen: ri.Specimen = SPECIMEN

    def gauge(self, distance, noise=0.002, seed=0, dt=DT):
        """A `noisy_gauge` of the bar at a distance from the specimen, m."""
        record = self.solution.gauge(1, distance)
        return noisy_gauge(record, distance, noise, seed, dt)

    def strain(self, times):
        """Nominal compressive strain of the specimen; 0 before the run, at t < 0."""
        times = np.maximum(times, 0.0)
        striker = self.solution.system.bodies[0]
        length = getattr(striker, "length", 0.0)  # a rigid mass has none
        striker_face = self.solution.displacement(0, length, times)
        bar_face = self.solution.displacement(1, 0.0, times)
        approach = striker_face - bar_face
        return approach / self.specimen.length

    def stress(self, times):
        """Nominal stress of the specimen, Pa."""
        times = np.maximum(times, 0.0)
        (contact,) = self.solution.contacts
        force = contact.force(times)
        return force / self.specimen.section


@keep_last
def direct_impact_on_law(is_rigid=False, until=7e-4, cells=450):
    """A rod or a rigid mass hits a specimen that yields and hardens: a solved
    `LawShot`.
    """
    striker = rod(0.4, velocity=12.0)
    if is_rigid:
        striker = ri.RigidMass(STRIKER.mass, velocity=12.0)
    law = ri.Yielding(stiffness=1.5e8, yield_force=15e3, hardening=8e6)
    row = ri.System([striker, rod(1.5)], contacts=[law])
    return LawShot(solved(row, until, cells))


# Shots whose rise the bars carry: thin bars, and 1 % of strain takes many of their
# diameters

THIN_DIAMETER = 0.008  # m
THIN_BAR = ri.Rod(1.5, diameter=THIN_DIAMETER, material=STEEL)
THIN_SPECIMEN = ri.Specimen(4e-3, diameter=0.006)
SLOW_SPECIMEN = ri.Specimen(8e-3, diameter=0.006)
SLOW_STRIKER = ri.Rod(0.4, diameter=THIN_DIAMETER, material=STEEL, velocity=3.0)
SLOW_STRAIN = 3.0 / (2 * STEEL.wave_speed)
"""Strain of the wave of the striker against a stiff specimen."""


@keep_last
def smooth_shot(duration, until, rise=80e-6):
    """A solved `Shot`: a pulse with smooth corners, of this duration and rise, s, runs
    through a thin input bar to a polymer specimen.
    """
    level = trapezoid(duration, rise)
    smooth_level = level**2 * (3 - 2 * level)
    bar = rod(1.5, THIN_DIAMETER)
    specimen = rod(THIN_SPECIMEN.length, THIN_SPECIMEN.diameter, POLYMER)
    row = row_under_pulse([bar, specimen, bar], smooth_level)
    return Shot(solved(row, until, cells=1500), THIN_SPECIMEN)


@keep_last
def slow_direct_impact(until=7e-4):
    """A striker of 3 m/s hits a specimen without mass that yields at 1 % of strain."""
    law = ri.Yielding(stiffness=2.1e7, yield_force=1.7e3, hardening=1e6)
    striker = rod(0.4, THIN_DIAMETER, velocity=3.0)
    bar = rod(1.5, THIN_DIAMETER)
    row = ri.System([striker, bar], contacts=[law])
    return LawShot(solved(row, until, cells=450), SLOW_SPECIMEN)


@keep_last
def slow_direct_impact_with_mass(until=7e-4):
    """A striker of 3 m/s hits a specimen that is a short rod on the output bar."""
    striker = rod(0.4, THIN_DIAMETER, velocity=3.0)
    specimen = rod(SLOW_SPECIMEN.length, SLOW_SPECIMEN.diameter, POLYMER)
    bar = rod(1.5, THIN_DIAMETER)
    bodies = [striker, specimen, bar]
    laws = [ri.Rigid(), ri.Rigid()]
    row = ri.System(bodies, contacts=laws)
    return Shot(solved(row, until, cells=450), SLOW_SPECIMEN)
