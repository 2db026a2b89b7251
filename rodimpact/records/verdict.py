"""The verdict on a shot: equilibrium, peak stress, strain rate and energy.

A specimen is in equilibrium while the forces on its two faces are equal. Before that,
the stress computed from one face does not characterize the material.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..hints import explain_missing
from ..model.quantities import Floats
from ..units import format_si
from .curve import Curve
from .doubts import INPUT_FORCE_RTOL
from .pulses import PLATEAU_RATIO

Bools: TypeAlias = NDArray[np.bool_]

EQUILIBRIUM_RTOL = 0.05
"""Largest abs(F1 - F2) in equilibrium, divided by the mean of both forces."""
MIN_BALANCED_RATIO = 0.5
"""Least part of the plateau with balanced forces if a shot is in equilibrium."""
MAX_UNSTEADY_RATIO = 0.5
"""Largest scatter of a difference F1 - F2 that counts as nearly constant.

The scatter is the median of the deviations of F1 - F2 from its median on the plateau,
divided by the median of abs(F1 - F2). Waves that still run in the specimen make the
difference oscillate or decay.
"""
SMOOTHING_RATIO = 0.25
"""Duration of the moving means of forces, over the rise time of the incident wave."""
SMALLEST_SHOWN_RATIO = 1e-4
"""Ratio below which the sentences say "less than" this ratio."""
EQUILIBRIUM_TRANSITS = 4.0
"""Typical number of transit times of the specimen until its forces are nearly equal.

It is 3 to 5 for most rise times.
"""


@explain_missing()
class Verdict(NamedTuple):
    """What a shot shows about its specimen; `Reduction.verdict`.

    The plateau is the loading with a force on the output face of at least 0.7 of its
    peak.

    Attributes
    ----------
    in_equilibrium : bool or None
        Whether abs(F1 - F2) stays below 5 % of the mean force over half of the plateau
        or more. None if equal forces were assumed, or if F1 is too small a difference
        of two waves to tell.
    equilibrium_from : float
        Strain from which the forces are balanced; nan if this is not known.
    imbalance : float
        Median of abs(F1 - F2) on the plateau, divided by the mean force; nan if equal
        forces were assumed.
    peak_stress : float
        Largest nominal stress while loading, Pa.
    strain_at_peak : float
        Nominal strain at this stress.
    mean_strain_rate : float
        Mean of the strain rate on the plateau, 1/s.
    energy : float
        Energy absorbed up to the largest strain, J.
    sentences : tuple of str
        The verdict in sentences; ``str(verdict)`` has each of them in a line.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)  # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> verdict = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5)).verdict
    >>> verdict.in_equilibrium, round(verdict.peak_stress / 1e6)
    (True, 400)
    """

    in_equilibrium: bool | None
    equilibrium_from: float
    imbalance: float
    peak_stress: float
    strain_at_peak: float
    mean_strain_rate: float
    energy: float
    sentences: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join(self.sentences)


def verdict_of(curve: Curve, impedance: float, rise: float) -> Verdict:
    """Verdict on a curve with measured forces on both faces.

    The first sentence has one of three statements: equilibrium cannot be judged
    (`in_equilibrium` is None); equilibrium is reached at a strain, `equilibrium_from`;
    or it is not reached. In the first and in the last case `equilibrium_from` is nan.

    Parameters
    ----------
    curve : Curve
    impedance : float
        Impedance of the input bar, kg/s.
    rise : float
        Rise time of the incident wave, s.
    """
    plateau = _plateau(curve)
    balance = _balance(curve, rise)
    imbalance = float(np.median(balance.imbalance[plateau]))
    resolution = _resolution(curve, plateau, impedance)
    is_equal_on_plateau = balance.is_equal & plateau
    balanced_samples = is_equal_on_plateau.sum()
    is_balanced = balanced_samples >= MIN_BALANCED_RATIO * plateau.sum()
    in_equilibrium: bool | None = bool(is_balanced)
    equilibrium_from = math.nan
    if resolution > EQUILIBRIUM_RTOL:  # the error of F1 exceeds the bound
        in_equilibrium = None
        sentence = (
            "equilibrium cannot be judged: F1 is the difference of two waves, each "
            f"right to {_percent(INPUT_FORCE_RTOL)}, so it is known to "
            f"{_percent(resolution)} of the mean force only; |F1 - F2| is "
            f"{_percent(imbalance)} of it on the plateau"
        )
    elif in_equilibrium:
        # The first balanced sample of the plateau, or an earlier one: balanced samples
        # right before the plateau count as well.
        first = int(is_equal_on_plateau.argmax())
        while first > 0 and balance.is_equal[first - 1]:
            first -= 1
        equilibrium_from = float(curve.strain[first])
        delay = curve.times[first] - curve.times[0]
        sentence = (
            f"equilibrium is reached at {_percent(equilibrium_from)} of strain, "
            f"{format_si(delay, 's', 3)} after the wave arrives; |F1 - F2| is "
            f"{_percent(imbalance)} of the mean force on the plateau"
        )
    else:
        sentence = (
            f"equilibrium is not reached: |F1 - F2| is {_percent(imbalance)} of the "
            f"mean force on the plateau, and stays below {_percent(EQUILIBRIUM_RTOL)} "
            "for less than half of it; "
        )
        # A nearly constant difference has a smaller scatter than its size.
        difference = balance.difference[plateau]
        from_median = np.abs(difference - np.median(difference))
        unsteadiness = float(np.median(from_median))
        if unsteadiness < MAX_UNSTEADY_RATIO * imbalance:
            sentence += (
                "the difference is nearly constant there, as wrong gains or distances "
                "of gauges make it: check them first (ri.calibrate finds gains from a "
                "shot with the bars together), then "
            )
        sentence += "use a shorter specimen or a slower rise of the pulse"
    return _with_numbers(
        curve,
        plateau,
        in_equilibrium=in_equilibrium,
        equilibrium_from=equilibrium_from,
        imbalance=imbalance,
        sentence=sentence,
    )


def verdict_of_equal_forces(curve: Curve, method: str) -> Verdict:
    """Verdict on a curve for which equal forces on both faces were assumed.

    `in_equilibrium` is None, `equilibrium_from` and `imbalance` are nan. If the wave
    speed of the specimen is known, the first sentence estimates the time until the
    forces are equal. `method`, on how the input velocity was found, is the last
    sentence.
    """
    sentence = "equilibrium is assumed, not measured: one force stands for both faces"
    wave_speed = curve.specimen.wave_speed
    if wave_speed is None:
        sentence += (
            "; give Specimen(wave_speed=...) for an estimate of the time that this "
            "takes"
        )
    else:
        time = EQUILIBRIUM_TRANSITS * curve.specimen.length / wave_speed
        strain = float(np.interp(curve.times[0] + time, curve.times, curve.strain))
        sentence += (
            f"; it takes some {format_si(time, 's', 3)}, {EQUILIBRIUM_TRANSITS:g} "
            f"transit times of the specimen, so expect it from {_percent(strain)} of "
            "strain on"
        )
    plateau = _plateau(curve)
    verdict = _with_numbers(
        curve,
        plateau,
        in_equilibrium=None,
        equilibrium_from=math.nan,
        imbalance=math.nan,
        sentence=sentence,
    )
    return verdict._replace(sentences=(*verdict.sentences, method))


def _with_numbers(
    curve: Curve,
    plateau: Bools,
    in_equilibrium: bool | None,
    equilibrium_from: float,
    imbalance: float,
    sentence: str,
) -> Verdict:
    """The verdict from its statements on equilibrium, completed by other numbers.

    These are the peak stress and its strain, the mean strain rate on the plateau, and
    the energy absorbed while loading; they form the second sentence. `sentence` is the
    first one. `plateau` selects the samples of the plateau, [sample].
    """
    loading = curve.loading
    peak = int(curve.stress[loading].argmax())  # also an index of the whole curve
    strain_rate = float(curve.strain_rate[plateau].mean())
    energy = float(curve.energy[loading][-1])
    start = _percent(curve.strain[plateau][0])
    end = _percent(curve.strain[plateau][-1])
    numbers = (
        f"peak stress {format_si(curve.stress[peak], 'Pa', 4)} at "
        f"{_percent(curve.strain[peak])} of strain; mean strain rate {strain_rate:.0f} "
        f"1/s from {start} to {end} of strain; energy absorbed "
        f"{format_si(energy, 'J', 3)}"
    )
    return Verdict(
        in_equilibrium=in_equilibrium,
        equilibrium_from=equilibrium_from,
        imbalance=imbalance,
        peak_stress=float(curve.stress[peak]),
        strain_at_peak=float(curve.strain[peak]),
        mean_strain_rate=strain_rate,
        energy=energy,
        sentences=(sentence, numbers),
    )


def _plateau(curve: Curve) -> Bools:
    """Booleans, [sample]: true while loading, with an output force near its peak."""
    is_loading = np.arange(len(curve.times)) < curve.loading.stop
    force = np.where(is_loading, curve.output_force, -np.inf)
    is_high: Bools = force >= PLATEAU_RATIO * force.max()
    return is_high


class _Balance(NamedTuple):
    """Balance of the forces over time."""

    difference: Floats  # F1 - F2 over the mean force
    imbalance: Floats  # absolute value of the difference
    is_equal: Bools  # imbalance within `EQUILIBRIUM_RTOL`, while loading


def _balance(curve: Curve, rise: float) -> _Balance:
    """Balance of the forces over time, [sample].

    Moving means of the forces over `SMOOTHING_RATIO` times the rise time, s, are
    compared, since noise disturbs them less. `is_equal` is false after the loading, and
    if the mean of both forces is 0 or less.
    """
    dt = curve.times[1] - curve.times[0]
    width = max(1, round(SMOOTHING_RATIO * rise / dt))
    window = np.full(width, 1 / width)
    difference = np.convolve(curve.input_force - curve.output_force, window, "same")
    mean = np.convolve(curve.input_force + curve.output_force, window, "same") / 2
    with np.errstate(divide="ignore", invalid="ignore"):  # a mean of 0: inf or nan
        relative = difference / mean
    imbalance = np.abs(relative)
    is_equal = (imbalance <= EQUILIBRIUM_RTOL) & (mean > 0)
    is_equal[curve.loading.stop :] = False
    return _Balance(relative, imbalance, is_equal)


def _resolution(curve: Curve, plateau: Bools, impedance: float) -> float:
    """Error of F1 divided by the median of F2 on the plateau.

    F1 is the difference of two waves: its error is `INPUT_FORCE_RTOL` of the largest
    force of the incident wave. `impedance` is Z of the input bar, kg/s.
    """
    # The incident strain i and the reflected strain r make the force F1 = Z c (i + r)
    # and the velocity v1 = c (i - r): the incident force is Z c i = (F1 + Z v1)/2.
    incident_force = (curve.input_force + impedance * curve.input_velocity) / 2
    plateau_force = np.median(curve.output_force[plateau])
    return float(INPUT_FORCE_RTOL * np.abs(incident_force).max() / plateau_force)


def _percent(ratio: float) -> str:
    """A ratio in percents; "less than 0.01 %" if it is smaller."""
    if abs(ratio) < SMALLEST_SHOWN_RATIO:
        return f"less than {100 * SMALLEST_SHOWN_RATIO:g} %"
    return f"{100 * ratio:.3g} %"
