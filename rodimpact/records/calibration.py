"""Calibration by a shot without a specimen: wave speeds, gains, reflection, bending, noise.

The pulse of the striker runs through both bars and back from the far end of the output bar. The
time from the first passage of the output gauge to the second gives c0 of that bar; the time from
the input gauge to the output gauge then gives c0 of the input bar. A striker of the same material
and cross-section with the speed V causes the strain V/(2 c0).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.arguments import of_kind, scalar
from ..model.bodies import Rod
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..model.quantities import Floats
from ..progress import Progress, ProgressFunction, check_progress
from ..storage.tables import align
from .bars import EXAMPLE, BarGauge, Compression, Side, sides_of
from .signal import Signal

SLACK = 0.1  # of a travel time: how far the wave speed that was given may be off
FAINT = 0.15  # of a pulse: what is above it counts
PASSES = (
    3  # of finding a wave speed, on which the dispersion that finds it depends a little
)


@dataclass(frozen=True, eq=False)
class Calibration:
    """Properties of both bars from a shot without a specimen; made by `calibrate`.

    Attributes
    ----------
    bars : (Rod, Rod)
        Input and output bar with the measured wave speeds; the densities are unchanged.
    gains : (float, float)
        Factors of the strains of the input gauge and of the output gauge.
    speed_errors : (float, float)
        Standard errors of the wave speeds due to noise, m/s.
    gain_errors : (float, float)
        Standard errors of the gains.
    reflected : float
        Strain reflected at the joint divided by the incident strain. `expected` is its value from
        the impedances, (Z2 - Z1)/(Z2 + Z1).
    expected : float
    noise : (float, float)
        Standard deviation of the noise divided by the plateau of the pulse.
    bending : (float or None, float or None)
        Largest bending strain divided by the plateau; None without gauges on both sides.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, bar]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.calibrate(*gauges, bar)
    >>> (piece,) = found.bars[0].segments
    >>> round(piece.material.wave_speed, -2), round(abs(found.reflected), 2)
    (5000.0, 0.0)
    """

    bars: tuple[Rod, Rod]
    gains: tuple[float, float]
    speed_errors: tuple[float, float]
    gain_errors: tuple[float, float]
    reflected: float
    expected: float
    noise: tuple[float, float]
    bending: tuple[float | None, float | None]

    def __str__(self) -> str:
        """Table with a column for each bar, then the reflection at the joint."""
        rows = [["", "wave speed", "gain", "noise/plateau", "bending/plateau"]]
        for k, title in enumerate(("input bar", "output bar")):
            bending, speed = self.bending[k], self.bars[k].segments[0].wave_speed
            rows.append(
                [
                    title,
                    f"{speed:.1f} +- {self.speed_errors[k]:.1f} m/s",
                    f"{self.gains[k]:.4f} +- {self.gain_errors[k]:.4f}",
                    f"{100 * self.noise[k]:.2f} %",
                    "-" if bending is None else f"{100 * bending:.1f} %",
                ]
            )
        return align(list(zip(*rows, strict=True))) + (
            f"\nreflected at the joint: {100 * self.reflected:.2f} % of the incident strain; "
            f"expected from the impedances: {100 * self.expected:.2f} %"
        )


def with_gains(known: Calibration, sides: tuple[Side, ...]) -> tuple[Side, ...]:
    """Sides of a shot with the gains of a calibration applied."""
    corrected = []
    for side, gain in zip(sides, known.gains, strict=True):
        corrected.append(side._replace(strains=gain * side.strains))
    return tuple(corrected)


def with_one_error(
    known: Calibration, sides: tuple[Side, ...]
) -> Iterator[tuple[Side, ...]]:
    """Sides in which one gain or one wave speed is changed by its standard error."""
    for i, side in enumerate(sides):
        gain = 1 + known.gain_errors[i] / known.gains[i]
        faster = with_speed(side.rod, side.speed + known.speed_errors[i])
        for changed in (
            side._replace(strains=gain * side.strains),
            side._replace(rod=faster),
        ):
            yield (*sides[:i], changed, *sides[i + 1 :])


def calibrate(
    input_gauges: Any,
    output_gauges: Any,
    bars: Rod | tuple[Rod, Rod],
    *,
    striker_speed: float | None = None,
    compression: Compression = "negative",
    progress: bool | ProgressFunction = True,
) -> Calibration:
    """Wave speeds and gains from a shot with the two bars together and no specimen.

    Parameters
    ----------
    input_gauges, output_gauges : BarGauge
        As in `reduce`.
    bars : Rod or (Rod, Rod)
        Input and output bar, with their true lengths; errors of the wave speeds up to 10 % are
        corrected.
    striker_speed : float, optional
        V of a striker with the impedance of the input bar, m/s. By default the gain of the input
        gauge is 1, and the output gauge is compared with the input gauge.
    compression : str
        Sign of a strain that compresses in the records.
    progress : bool or function
        Whether a bar may show how far long work is. A function is called with the number of
        travel times that are done, and of all.

    Returns
    -------
    Calibration
        Pass it to `reduce` in place of the bars.

    Raises
    ------
    InvalidModel
        If an argument is invalid, or the record ends before the pulse returns from the far end of
        the output bar.

    Notes
    -----
    The incident strain is V/(2 c0). The joint transmits the fraction 2 Z2/(Z1 + Z2) of a force.

    Examples
    --------
    In a computed shot the gauges are right, so both gains are 1:

    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> shot = ri.solve(ri.System([striker, bar, bar]), until=1.5e-3)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.calibrate(*gauges, bar, striker_speed=10.0)
    >>> [round(gain, 2) for gain in found.gains]
    [1.0, 1.0]
    """
    problems: Problems = []
    check_progress(problems, progress)
    raise_if_problems(problems)
    for name, given in (
        ("input_gauges", input_gauges),
        ("output_gauges", output_gauges),
    ):
        of_kind(
            name, given, BarGauge, EXAMPLE
        )  # each gauge of a bar is calibrated alone
    first, second = sides_of(input_gauges, output_gauges, bars, compression)
    # the pulse comes back to the output gauge from the far end of its bar
    back = 2 * (float(second.rod.length) - float(second.distances[0]))
    passed_second = _passing(second)
    with Progress(progress, "calibrate", "travel times") as report:
        second, error2 = _timed(
            second, back, second, lambda now: -now.carried(passed_second, back)
        )
        report(1, 2)
        # from the input gauge it goes through the rest of both bars to the output gauge
        pulse = np.interp(
            second.times, first.times, _passing(first), left=0.0, right=0.0
        )
        path, rest = float(first.distances[0]), float(second.distances[0])
        first, own = _timed(
            first,
            path,
            second,
            lambda now: second.carried(
                now._replace(dt=second.dt).carried(pulse, path), rest
            ),
        )
        report(2, 2)
    other = (
        error2 / second.speed * rest / second.speed
    )  # s, by which the second bar may be off
    error1 = math.hypot(own, first.speed**2 / path * other)
    # strain that comes back from the joint over the incident one, by least squares
    sent = first.carried(_passing(first), 2 * path)
    where = np.abs(sent) > FAINT * np.abs(sent).max()
    back_again = (first.strains[0] - _passing(first))[where]
    reflected = float(sent[where] @ back_again / (sent[where] @ sent[where]))
    Z1, Z2 = (side.stiffness / side.speed for side in (first, second))
    struck, passed = first.front.plateau, second.front.plateau
    gain = 1.0
    if striker_speed is not None:
        V = scalar("striker_speed", striker_speed, "m/s", "positive")
        gain = V / (2 * first.speed) / struck
    transmitted = 2 * Z2 / (Z1 + Z2) * first.stiffness / second.stiffness
    gains = gain, gain * transmitted * struck / passed
    noise = _noise(first) / struck, _noise(second) / passed
    errors = [
        share / math.sqrt(max(1.0, side.front.width / side.dt)) * gain
        for share, side, gain in zip(noise, (first, second), gains, strict=True)
    ]
    return Calibration(
        (first.rod, second.rod),
        gains,
        (error1, error2),
        (errors[0], errors[1]),
        reflected,
        (Z2 - Z1) / (Z1 + Z2),
        noise,
        (_bending(input_gauges, first), _bending(output_gauges, second)),
    )


def with_speed(rod: Rod, speed: float) -> Rod:
    """The rod with another wave speed: E = rho c^2."""
    segment = rod.segments[0]
    material = segment.material
    changed = material.replace(youngs_modulus=material.density * speed**2)
    return rod.replace(segments=[segment.replace(material=changed)])


def _noise(side: Side) -> float:
    """Standard deviation before the pulse."""
    return float(side.strains[0, : side.quiet].std())


def _timed(
    side: Side, path: float, seen: Side, predicted: Callable[[Side], Floats]
) -> tuple[Side, float]:
    """A bar with the wave speed by which a prediction comes when the record of `seen` has it.

    The standard error of the arrival is s sqrt(2)/sqrt(sum of slope^2), with s the noise.
    """
    for _ in range(PASSES):
        travel = path / side.speed
        lag = predicted(side)
        there = np.flatnonzero(np.abs(lag) > FAINT * np.abs(lag).max())
        low, high = seen.times[there[[0, -1]]] + SLACK * travel * np.array([-1, 1])
        if high > seen.times[-1]:
            message = (
                f"the record ends at {seen.times[-1]:.4g} s, before the pulse returns"
            )
            raise invalid_argument(
                "output_gauges",
                f"{message} from the far end; record up to {high:.4g} s",
            )
        found = (
            Signal(seen.strains[0], seen.times)
            .window(low, high)
            .misfit(Signal(lag, seen.times), shift=(-SLACK * travel, SLACK * travel))
        )
        if found.at_limit:
            message = (
                f"the travel time is more than {100 * SLACK:g} % off the expected one"
            )
            raise invalid_argument(
                "bars", f"{message}; correct wave speed, length or distances"
            )
        side = side._replace(rod=with_speed(side.rod, path / (travel + found.shift)))
    slopes = np.diff(lag)[there[0] : there[-1]] / seen.dt
    late = _noise(seen) * math.sqrt(2) / math.sqrt(float(slopes @ slopes))
    return side, late * side.speed**2 / path


def _passing(side: Side) -> Floats:
    """The record of a pulse that passes for the first time, zero after it."""
    past = side.front.start + side.front.width + 2 * side.front.rise
    passing: Floats = np.where(side.times < past, side.strains[0], 0.0)
    return passing


def _bending(gauge: BarGauge, side: Side) -> float | None:
    """Largest bending strain while the pulse passes, over its plateau."""
    if (bending := gauge.bending) is None:
        return None
    start, width, _, plateau = side.front
    passing = bending.baseline(bending.start, start).window(start, start + width)
    return float(np.abs(passing.values).max() / abs(plateau))
