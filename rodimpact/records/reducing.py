"""Reduce a shot: from the gauges of two bars to stress, strain and energy of the specimen."""

import warnings
from typing import Any

import numpy as np

from ..model.arguments import of_kind, scalar
from ..model.bodies import Rod
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..progress import Progress, ProgressFunction, check_progress
from .alignment import Alignment, loading_imbalance
from .bar_reading import Compression, instrumented_bars, rods_of
from .calibration import Calibration, with_gains
from .cut_pulses import CutPulses, gauges_of
from .doubts import DoubtfulReduction, doubts_of
from .reduction import Reduction
from .separation import separated_until
from .shot import Shot
from .specimen import Specimen
from .verdict import verdict_of

MIN_CURVE_SAMPLES = 16
"""Samples of a curve, at least."""


def reduce(
    input_gauges: Any = None,
    output_gauges: Any = None,
    bars: Rod | tuple[Rod, Rod] | Calibration | None = None,
    specimen: Specimen | None = None,
    *,
    pulses: CutPulses | None = None,
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
    pulses : CutPulses, optional
        Incident, reflected and transmitted pulse, each cut out of its record, in place of the
        gauges.
    compression : str
        Sign of a strain that compresses in the records: ``"negative"`` or ``"positive"``.
    align_within : float
        Largest shift of the reflected and of the transmitted wave, s. The shifts balance the forces
        on both faces up to half of the largest stress and, if the specimen has a `youngs_modulus`,
        make the initial slope equal to it. Later they can make the balance worse:
        `Reduction.alignment` has the balance over all loading before and after. 0: only distances
        and wave speeds align the waves.
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
    assert specimen is not None
    limit = scalar("align_within", align_within, "s", "non-negative")
    calibration = None
    rods: Any = bars
    if isinstance(bars, Calibration):
        calibration = bars
        rods = calibration.bars
    if pulses is not None:
        if input_gauges is not None or output_gauges is not None:
            raise invalid_argument("pulses", "give either pulses or gauges, not both")
        of_kind("pulses", pulses, CutPulses, "ri.CutPulses(incident, reflected, ...)")
        input_gauges, output_gauges = gauges_of(pulses, rods_of(rods))
    recorded = instrumented_bars(input_gauges, output_gauges, rods, compression)
    # The curve lasts from the arrival at the specimen as long as the waves are separated.
    input_bar = recorded.input
    travel = float(input_bar.distances[0]) / input_bar.speed
    start = input_bar.pulse_start + travel
    end = min(separated_until(bar) for bar in recorded)
    dt = input_bar.dt
    count = int((end - start) / dt)
    if count < MIN_CURVE_SAMPLES:
        message = (
            f"the wave reaches the specimen at {start:.6g} s, but from {end:.6g} s on "
            "the records do not separate the waves; use longer records or bars, and "
            "check the distances"
        )
        raise invalid_argument("input_gauges", message)
    corrected = recorded
    if calibration is not None:
        corrected = with_gains(calibration, recorded)
    shot = Shot(corrected, specimen, start + dt * np.arange(count, dtype=float))
    with Progress(progress, "reduce", "curves") as report:
        alignment = None
        if limit:
            before = loading_imbalance(shot.curve())
            shot = shot.aligned(limit, report)
            after = loading_imbalance(shot.curve())
            alignment = Alignment(limit, before, after)
        curve = shot.curve()
        bands = shot.bands(curve, calibration, report)
    doubts = doubts_of(recorded, curve, shot.shifts, alignment)
    for doubt in doubts:
        warnings.warn(doubt, DoubtfulReduction, stacklevel=2)
    return Reduction(
        **vars(curve),
        stress_band=bands.stress,
        strain_band=bands.strain,
        one_sample=shot.one_sample(curve),
        shifts=shot.shifts,
        verdict=verdict_of(curve, input_bar.impedance, input_bar.first_pulse.rise),
        alignment=alignment,
        disperses=all(bar.mode for bar in recorded),
        doubts=doubts,
    )
