"""Reduce a shot: from gauges of bars to stress, strain and energy of the specimen."""

from __future__ import annotations

import warnings
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments
from ..model.arguments import check_flag, check_kind, scalar
from ..model.bodies import RigidMass, Rod
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, ProgressReport, check_progress
from .alignment import Alignment, loading_imbalance
from .bar_reading import Compression, instrumented_bars, output_bar_of, rods_of
from .calibration import Calibration, with_gains
from .curve import Curve
from .cut_pulses import CutPulses, gauges_of
from .direct_impact import (
    DirectImpactShot,
    check_striker,
    start_of_impact,
    timing_error_of,
)
from .doubts import (
    DoubtfulReduction,
    doubts_of,
    doubts_of_direct_impact,
    doubts_of_equal_forces,
)
from .equal_forces import EqualForceShot
from .instrumented_bar import InstrumentedBar, InstrumentedBars
from .reduction import Reduction
from .separation import separated_until
from .shot import BAND_STANDARD_ERRORS, Resolution, Shot, bands_of, one_sample_of
from .specimen import Specimen
from .two_bar_shot import NO_SHIFTS, Shifts, TwoBarShot
from .verdict import Verdict, verdict_of, verdict_of_equal_forces

MIN_CURVE_SAMPLES = 16
"""Least number of samples of a curve."""


@explain_arguments
def reduce(
    input_gauges: Any = None,
    output_gauges: Any = None,
    bars: Rod | tuple[Rod, Rod] | Calibration | None = None,
    specimen: Specimen | None = None,
    *,
    pulses: CutPulses | None = None,
    equal_forces: bool = False,
    striker: Rod | RigidMass | None = None,
    compression: Compression = "negative",
    align_within: float = 0.0,
    progress: bool | ProgressFunction = True,
) -> Reduction:
    """Stress, strain and energy of a specimen from the gauges of its two bars.

    Parameters
    ----------
    input_gauges, output_gauges : BarGauge or two of them
        Gauges of the input bar, which the striker hits, and of the output bar. Two
        gauges on a bar separate waves that overlap at each gauge.
    bars : Rod, (Rod, Rod) or Calibration
        Input and output bar, or one rod if both are alike. In a round bar with a
        Poisson ratio, waves disperse as in the exact first mode. A record that was
        computed without `lateral_inertia` has no dispersion: reduce it with bars
        without a Poisson ratio. The lengths give the times at which waves return from
        the far ends.
    specimen : Specimen
    pulses : CutPulses, optional
        Incident, reflected and transmitted pulse, each cut out of its record, in place
        of the gauges.
    equal_forces : bool
        Whether to assume equal forces on both faces of the specimen, and a free far end
        of the output bar. Then one gauge a bar separates waves that overlap. The
        specimen is in equilibrium by assumption.
    striker : Rod or RigidMass, optional
        Striker of a direct impact, with its velocity: it hits the specimen, which lies
        on the output bar. Give `output_gauges` and, as `bars`, the output bar; there is
        no input bar. Equal forces on both faces are assumed.
    compression : str
        Sign of a strain that compresses in the records: ``"negative"`` or
        ``"positive"``.
    align_within : float
        Largest shift of the reflected and of the transmitted wave, s. The shifts
        balance the forces on both faces up to half of the largest stress and, if the
        specimen has a `youngs_modulus`, make the initial slope equal to it. At larger
        strains they can make the balance worse: `Reduction.alignment` has the balance
        over all loading without and with the shifts. If 0, the waves are aligned by
        distances and wave speeds alone.
    progress : bool or function
        Whether to show a progress bar. A function is called with the number of curves
        that are done and the number of all curves, which is None if it is unknown.

    Returns
    -------
    Reduction

    Raises
    ------
    InvalidModel
        If an argument is invalid, or a record does not begin with rest and then a
        compression.
    ValueError
        If the incident and the reflected wave overlap at the only gauge of the bar.

    Warns
    -----
    DoubtfulReduction
        For each of `Reduction.doubts`.

    Examples
    --------
    The incident strain, 1e-3, is transmitted fully: the force is E A 1e-3, and the
    specimen has no strain.

    >>> import rodimpact as ri
    >>> k = np.arange(400)
    >>> shape = 1e-3 * np.clip(np.minimum(k - 100, 250 - k) / 10, 0, 1)
    >>> incident = ri.Signal(-shape, dt=1e-6)
    >>> transmitted = incident.shifted(2e-4).extended(before=2e-4)
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> specimen = ri.Specimen(5e-3, area=1e-4)
    >>> input_gauge = ri.BarGauge(incident, 0.5)
    >>> output_gauge = ri.BarGauge(transmitted, 0.5)
    >>> found = ri.reduce(input_gauge, output_gauge, bar, specimen)
    >>> round(found.stress.max() / 1e6), bool(abs(found.strain).max() < 1e-12)
    (200, True)
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    check_kind(
        "specimen", specimen, Specimen, "ri.Specimen(length=5e-3, diameter=8e-3)"
    )
    assert specimen is not None  # `check_kind` has refused the default, None
    limit = scalar("align_within", align_within, "s", "non-negative")
    check_flag("equal_forces", equal_forces)
    _check_combination(
        input_gauges, output_gauges, pulses, equal_forces, striker, limit
    )
    with Progress(progress, "reduce", "curves") as report:
        if striker is not None:
            check_striker(striker)
            output_bar = output_bar_of(output_gauges, bars, compression)
            reduction = _reduce_direct_impact(output_bar, striker, specimen, report)
        else:
            calibration = None
            rods: Any = bars
            if isinstance(bars, Calibration):
                calibration = bars
                rods = calibration.bars
            velocity_error = 0.0
            if pulses is not None:
                pair = gauges_of(pulses, rods_of(rods))
                input_gauges = pair.input
                output_gauges = pair.output
                velocity_error = pair.velocity_error
            recorded = instrumented_bars(input_gauges, output_gauges, rods, compression)
            records = _Records(recorded, calibration, specimen, velocity_error)
            if equal_forces:
                reduction = _reduce_with_equal_forces(records, report)
            else:
                reduction = _reduce_two_bars(records, limit, report)
    for doubt in reduction.doubts:
        # Level 3 is the user's call: the decorator is a level between.
        warnings.warn(doubt, DoubtfulReduction, stacklevel=3)
    return reduction


def _check_combination(
    input_gauges: Any,
    output_gauges: Any,
    pulses: Any,
    equal_forces: bool,
    striker: Any,
    limit: float,
) -> None:
    """Raise InvalidModel for arguments that exclude each other, or for wrong `pulses`.

    Gauges and striker may be anything here; they are checked later. `limit` is the
    argument `align_within`, s.
    """
    if pulses is not None:
        check_kind(
            "pulses", pulses, CutPulses, "ri.CutPulses(incident, reflected, ...)"
        )
        if input_gauges is not None or output_gauges is not None:
            raise invalid_argument("pulses", "give either pulses or gauges, not both")
    if striker is not None and (input_gauges is not None or pulses is not None):
        message = "a direct impact has an output bar only; give output_gauges alone"
        raise invalid_argument("striker", message)
    if equal_forces and pulses is not None:
        message = "cut pulses are separated already; leave equal_forces out"
        raise invalid_argument("equal_forces", message)
    if limit and (equal_forces or striker is not None):
        message = "balances two forces, but equal forces are assumed; leave it out"
        raise invalid_argument("align_within", message)


class _Records(NamedTuple):
    """The records of a shot between two bars."""

    bars: InstrumentedBars  # with the strains as recorded
    calibration: Calibration | None
    specimen: Specimen
    # Error of v1 - v2, m/s, due to errors of the levels at rest of cut pulses; 0 for
    # whole records
    velocity_error: float

    @property
    def corrected(self) -> InstrumentedBars:
        """The bars with the gains of the calibration, or as recorded without one."""
        if self.calibration is None:
            return self.bars
        return with_gains(self.calibration, self.bars)

    @property
    def arrival(self) -> float:
        """Time at which the incident wave reaches the specimen, s."""
        bar = self.bars.input
        travel = float(bar.distances[0]) / bar.speed
        return bar.pulse_start + travel


def _reduce_two_bars(
    records: _Records, limit: float, report: ProgressReport
) -> Reduction:
    """Reduce a shot whose gauges separate all waves, and judge its equilibrium.

    If the limit is above 0, s, the waves are first aligned by shifts up to this limit.
    `records.velocity_error` is a constant error of the strain rate, so the error of the
    strain grows in proportion to time; it is added to the band of the strain.
    InvalidModel if the curve is too short.
    """
    recorded = records.bars
    input_bar = recorded.input
    # The curve begins when the incident wave reaches the specimen, and ends when the
    # first of the two bars no longer separates its waves.
    end = min(separated_until(bar) for bar in recorded)
    times = _times_between(records.arrival, end, input_bar.dt, blamed="input_gauges")
    shot = TwoBarShot(records.corrected, records.specimen, times)
    alignment = None
    if limit:
        before = loading_imbalance(shot.curve())
        shot = shot.aligned(limit, report)
        after = loading_imbalance(shot.curve())
        alignment = Alignment(limit, before, after)
    curve = shot.curve()
    rate_error = records.velocity_error / records.specimen.length  # standard error
    strain_error = BAND_STANDARD_ERRORS * rate_error * (times - times[0])
    verdict = verdict_of(curve, input_bar.impedance, input_bar.first_pulse.rise)
    # Doubts compare the strains as recorded, without the gains.
    doubts = doubts_of(recorded, curve, shot.shifts, alignment)
    return _reduction(
        shot,
        curve,
        bars=list(recorded),
        verdict=verdict,
        doubts=doubts,
        report=report,
        calibration=records.calibration,
        shifts=shot.shifts,
        alignment=alignment,
        strain_error=strain_error,
    )


def _reduce_with_equal_forces(records: _Records, report: ProgressReport) -> Reduction:
    """Reduce a shot with one gauge a bar and overlapping waves.

    The band of the strain includes the change of the strain that a shift of the output
    record by one sample causes. InvalidModel for two gauges on a bar, for an input
    gauge at the specimen, and if the curve is too short.
    """
    recorded = records.bars
    for name, bar in zip(("input_gauges", "output_gauges"), recorded, strict=True):
        if len(bar.distances) > 1:
            message = "two gauges of a bar separate the waves; leave equal_forces out"
            raise invalid_argument(name, message)
    if recorded.input.distances[0] == 0:
        message = (
            "a gauge at the specimen records the force alone; give one further away"
        )
        raise invalid_argument("input_gauges", message)
    input_bar = recorded.input
    end = min(float(recorded.output.known_until[0]), float(input_bar.times[-1]))
    times = _times_between(records.arrival, end, input_bar.dt, blamed="output_gauges")
    shot = EqualForceShot(records.corrected, records.specimen, times)
    curve = shot.curve()
    # The times of both records agree to one sample only. Each passage of the wave in
    # the input bar adds this error, which no noise shows.
    later = shot.with_later_output(recorded.output.dt).curve()
    strain_error = later.strain - curve.strain
    return _reduction(
        shot,
        curve,
        bars=list(recorded),
        verdict=verdict_of_equal_forces(curve, shot.method_sentence()),
        doubts=doubts_of_equal_forces(recorded, records.specimen),
        report=report,
        calibration=records.calibration,
        strain_error=strain_error,
    )


def _reduce_direct_impact(
    bar: InstrumentedBar,
    striker: Rod | RigidMass,
    specimen: Specimen,
    report: ProgressReport,
) -> Reduction:
    """Reduce the impact of a striker on a specimen that lies on an output bar.

    An error dt of the time of the impact causes an error v1 dt/L0 of the strain, with
    the velocity v1 of the input face at the impact; it is added to the band of the
    strain. InvalidModel if the curve is too short.
    """
    start = start_of_impact(bar)
    times = _times_between(start, separated_until(bar), bar.dt, blamed="output_gauges")
    shot = DirectImpactShot(bar, striker, specimen, times)
    curve = shot.curve()
    strain_error = curve.input_velocity[0] * timing_error_of(bar) / specimen.length
    return _reduction(
        shot,
        curve,
        bars=[bar],
        verdict=verdict_of_equal_forces(curve, shot.method_sentence()),
        doubts=doubts_of_direct_impact(bar, specimen),
        report=report,
        strain_error=strain_error,
    )


def _times_between(start: float, end: float, dt: float, *, blamed: str) -> Floats:
    """Times of a curve from `start` on, at steps of `dt`, all before `end`, s.

    InvalidModel, which names the argument `blamed`, for fewer than `MIN_CURVE_SAMPLES`.
    """
    count = int((end - start) / dt)
    if count < MIN_CURVE_SAMPLES:
        message = (
            f"the wave reaches the specimen at {start:.6g} s, but from {end:.6g} s on "
            "the records do not separate the waves; use longer records or bars, and "
            "check the distances"
        )
        raise invalid_argument(blamed, message)
    times: Floats = start + dt * np.arange(count, dtype=float)
    return times


def _reduction(
    shot: Shot,
    curve: Curve,
    bars: list[InstrumentedBar],
    verdict: Verdict,
    doubts: tuple[str, ...],
    report: ProgressReport,
    *,
    calibration: Calibration | None = None,
    shifts: Shifts = NO_SHIFTS,
    alignment: Alignment | None = None,
    strain_error: Floats | float = 0.0,
) -> Reduction:
    """The curve of a shot with its error bands, verdict and doubts.

    `bars` are the bars with gauges; the output bar is the last. `strain_error` is the
    half width of a band of the strain that noise does not include. It is added to the
    band of the noise in quadrature.
    """
    # The input bar; in a direct impact the output bar, the only one
    first = bars[0]
    half_sampling_rate = 0.5 / first.dt  # Hz
    cut_off = min(first.guide.cut_off, half_sampling_rate)
    resolution = Resolution(first.dt, cut_off)
    bands = bands_of(shot, curve, calibration, resolution, report)
    # Change of the stress by a shift of the output record by one of its samples
    one_sample = one_sample_of(shot, curve, dt=bars[-1].dt)
    # `mode` is None for a bar without dispersion.
    disperses = all(bar.guide.mode for bar in bars)
    return Reduction(
        **vars(curve),  # the fields that Reduction inherits from Curve
        stress_band=bands.stress,
        strain_band=np.hypot(bands.strain, strain_error),
        one_sample=one_sample,
        shifts=shifts,
        verdict=verdict,
        alignment=alignment,
        disperses=disperses,
        doubts=doubts,
    )
