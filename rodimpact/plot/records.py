"""Records: measured and predicted signals, and the curve of a specimen."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

from ..fitting.result import Fit
from ..hints import explain_arguments
from ..methods.signals import Floats
from ..model.arguments import check_kind, integer
from ..model.frozen import invalid_argument
from ..records.comparison import Bounds, Misfit, gain_unit
from ..records.pulses import plateau
from ..records.reduction import Reduction
from ..records.signal import Signal
from ..units import TIMES
from .panels import (
    Picture,
    add_grid,
    draw_zero,
    format_axes,
    new_figure,
    two_axes_or_new,
)
from .sampling import extreme_indices
from .scales import engineering, largest_of, quantity_text, with_minus_signs
from .style import SMALL, colours, styled

RESIDUAL_RANGE = 1.9  # length of the axis of the residual, in largest residuals
BAND_ALPHA = 0.25
MIN_SEEN_BAND_RATIO = 0.01
"""Width of a band, over the range of the curves, below which lines hide it."""


@styled
def comparison(
    measured: Signal,
    predicted: Signal,
    ax: Sequence[Axes] | None = None,
    *,
    shift: Bounds | None = None,
    scale: Bounds | None = None,
    band: Signal | None = None,
) -> Picture:
    """Draw a record over its prediction; below, the residual, measured minus predicted.

    The prediction is drawn with the given shift and scale, by default with those of the
    smallest misfit; its label names both. The misfit is the root mean square of the
    residual divided by the plateau of the record.

    Parameters
    ----------
    measured : Signal
        The record, cut to the part to be compared by `Signal.window`.
    predicted : Signal
        The prediction. Before it its first value holds, after it its last value.
    ax : two Axes, optional
        Axes of signals and residual; by default those of a new figure, one above the
        other.
    shift, scale : float or (float, float), optional
        Shift of the prediction, s, and factor: fixed, or between bounds, as for
        `Signal.misfit`.
    band : Signal, optional
        Half width of a band about the prediction, such as two standard errors, over the
        times and in the unit of the prediction.

    Returns
    -------
    Picture
        With `residual_ax`, the lines `measured`, `predicted` and `residual`, the `band`
        or None, and the numbers `misfit`.

    Raises
    ------
    ValueError
        If `ax` is not a pair, or the units of band and prediction differ; also the
        errors of `Signal.misfit`.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> pulse = ri.Signal(np.hanning(201), dt=1e-6, name="incident")
    >>> picture = ri.plot.comparison(pulse, (0.5 * pulse).shifted(-3e-6))
    >>> picture.predicted.get_label().replace(ri.units.TIMES, 'times')
    'predicted, 3 µs later, times 2'
    """
    # What is measured.
    check_kind("measured", measured, Signal, "read_signals('shot.csv')['incident']")
    misfit = measured.misfit(predicted, shift=shift, scale=scale)
    t = measured.times
    values = measured.values
    shifted = t - misfit.shift
    # The prediction with its shift and scale, at the times of the record
    model: Floats = misfit.scale * np.interp(shifted, predicted.times, predicted.values)
    half_width = None
    if band is not None:
        _check_band(band, predicted)
        half_width = np.interp(shifted, band.times, np.abs(band.values))
        half_width = abs(misfit.scale) * half_width
    time = engineering("time t", largest_of(t), "s")
    name = measured.name or "signal"
    unit = engineering(name, largest_of(values), measured.unit)
    percent = 100 / plateau(values)  # factor from the unit of the record to %

    # What is drawn.
    upper, lower = two_axes_or_new(
        ax, "signals and residual", height=4.2, ratios=(3, 1)
    )
    x = t * time.factor
    area = None
    if half_width is not None:
        area = _fill_band(upper, x, model * unit.factor, half_width * unit.factor)
        name_of_band = "its band"
        widest = 2 * half_width.max()
        height_of_axes = np.ptp(values) + widest  # about the range of the axis
        if widest < MIN_SEEN_BAND_RATIO * height_of_axes:
            name_of_band = "its band, narrower than the line"
        area.set_label(name_of_band)
        _fill_band(lower, x, 0.0 * x, half_width * percent)
    measured_line = _draw_line(
        upper, x, values * unit.factor, color=colours().series[0], label="measured"
    )
    predicted_line = _draw_line(
        upper,
        x,
        model * unit.factor,
        color=colours().series[1],
        linestyle="--",
        label=_predicted(misfit, measured, predicted),
    )
    residual = _draw_line(
        lower, x, (values - model) * percent, color=colours().ink, linewidth=0.9
    )
    draw_zero(upper)
    draw_zero(lower)
    add_grid(upper)
    add_grid(lower)
    format_axes(upper, [measured_line, predicted_line, area], xlim=x[[0, -1]])
    upper.set_ylabel(unit.label, parse_math=False)
    format_axes(
        lower,
        xlim=x[[0, -1]],
        xlabel=time.label,
        ylabel="residual\n(% of plateau)",
    )
    limit = RESIDUAL_RANGE * max(map(abs, lower.get_ylim()))
    lower.set_ylim(-limit, limit)  # with room for the misfit above the curve
    lower.text(
        0.01,
        0.97,
        f"misfit {100 * misfit.rms:.3g} % of the plateau",
        transform=lower.transAxes,
        va="top",
        fontsize=SMALL + 1,
        color=colours().ink,
    )
    return Picture(
        ax=upper,
        residual_ax=lower,
        measured=measured_line,
        predicted=predicted_line,
        residual=residual,
        band=area,
        misfit=misfit,
    )


def _check_band(band: Signal, predicted: Signal) -> None:
    """Raise ValueError unless a band is a Signal in the unit of the prediction."""
    check_kind("band", band, Signal, "0.02 * predicted")
    if band.unit != predicted.unit:
        raise invalid_argument(
            "band",
            f"must be in the unit of the prediction, {predicted.unit!r}, "
            f"got {band.unit!r}",
        )


def _fill_band(
    ax: Axes, x: Floats, middle: Floats, half_width: Floats
) -> PolyCollection:
    """Fill a band around the curve `middle`, of `half_width` above and below it."""
    return ax.fill_between(
        x,
        middle - half_width,
        middle + half_width,
        color=colours().series[1],
        alpha=BAND_ALPHA,
        linewidth=0,
    )


def _draw_line(ax: Axes, x: Floats, y: Floats, **style: Any) -> Line2D:
    """Draw a curve; of very many points only those of `extreme_indices`."""
    style.setdefault("linewidth", 1.2)
    chosen = extreme_indices(y)
    (line,) = ax.plot(x[chosen], y[chosen], **style)
    return line


def _predicted(misfit: Misfit, measured: Signal, predicted: Signal) -> str:
    """Name of a prediction: "predicted", with its shift and its scale in words.

    A shift of 0 and a scale of 1 are left out. A shift or scale that is at a bound of
    its interval is followed by "(at its limit)".
    """
    name = "predicted"
    if misfit.shift:
        direction = "later" if misfit.shift > 0 else "earlier"
        name += f", {quantity_text(abs(misfit.shift), 's')} {direction}"
        if "shift" in misfit.at_limit:
            name += " (at its limit)"
    if misfit.scale != 1:
        unit = gain_unit(measured.unit, predicted.unit)
        factor = f"{misfit.scale:.4g} {unit}".rstrip()  # a factor may have no unit
        name += f", {TIMES} {with_minus_signs(factor)}"
        if "scale" in misfit.at_limit:
            name += " (at its limit)"
    return name


@explain_arguments
def fit(result: Fit, ax: Sequence[Axes] | None = None, record: int = 0) -> Picture:
    """Draw a record over its prediction, with a band of two standard errors.

    The residual is below. The band follows from the standard errors of the fitted
    numbers; it does not include model error.

    Parameters
    ----------
    result : Fit
    ax : two Axes, optional
        Axes of signals and residual; by default those of a new figure, one above the
        other.
    record : int
        Index of the record.

    Returns
    -------
    Picture
        That of `comparison`.

    Raises
    ------
    ValueError
        If there is no such record, or `ax` is not a pair.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0), bar])
    >>> record = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> guess = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=5.0), bar])
    >>> found = ri.fit(guess, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4, starts=1)
    >>> picture = ri.plot.fit(found)
    >>> type(picture).__name__
    'Picture'
    """
    check_kind("result", result, Fit, "fit(system, measured, vary, until)")
    record = integer("record", record, 0, len(result.measured) - 1)
    predicted = result.predicted[record]
    # The prediction is fitted already: `comparison` must not fit shift and scale.
    return comparison(
        result.measured[record].signal,
        predicted,
        ax,
        shift=0.0,
        scale=1.0,
        band=predicted.replace(values=2 * result.bands[record]),
    )


@styled
def side_by_side(count: int) -> list[tuple[Axes, Axes]]:
    """Pairs of Axes for signals and residual of `count` comparisons, on a new figure.

    The pairs stand side by side, in each pair the Axes of the signals above.
    """
    figure = new_figure(width=5.6 * count, height=4.2)
    grid = figure.subplots(2, count, squeeze=False, sharex="col", height_ratios=(3, 1))
    upper, lower = grid.tolist()  # rows of the grid
    return list(zip(upper, lower, strict=True))


@styled
def reduction(curve: Reduction, ax: Sequence[Axes] | None = None) -> Picture:
    """Draw stress over strain of a specimen up to the largest; below, the strain rate.

    Stress and strain are nominal, and positive in compression. The stress from the
    transmitted wave has an error band. Where the stress from the incident and the
    reflected wave differs from it, the forces on the two faces are not yet equal.

    Parameters
    ----------
    curve : Reduction
    ax : two Axes, optional
        Axes of stress and strain rate; by default those of a new figure, one above the
        other.

    Returns
    -------
    Picture
        With `rate_ax`, the lines `stress`, `two_wave` and `rate`, and the `band`.

    Raises
    ------
    ValueError
        If `ax` is not a pair.

    Examples
    --------
    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> picture = ri.plot.reduction(found)
    >>> picture is not None
    True
    """
    check_kind(
        "curve", curve, Reduction, "ri.reduce(input_gauge, output_gauge, bar, specimen)"
    )

    # What is measured.
    loading = curve.loading  # the samples up to the largest strain
    strain = 100 * curve.strain[loading]  # %
    stress = curve.stress[loading]
    half_width = curve.stress_band[loading]
    two_wave_stress = curve.two_wave_stress[loading]
    unit = engineering("nominal stress", largest_of(stress), "Pa")

    # What is drawn.
    upper, lower = two_axes_or_new(
        ax, "stress and strain rate", height=4.6, ratios=(3, 1)
    )
    first_colour, second_colour = colours().series[:2]
    (from_transmitted,) = upper.plot(
        strain,
        stress * unit.factor,
        color=first_colour,
        linewidth=1.3,
        label="transmitted wave",
    )
    (from_two_waves,) = upper.plot(
        strain,
        two_wave_stress * unit.factor,
        color=second_colour,
        linewidth=0.9,
        linestyle="--",
        label="incident and reflected wave",
    )
    band = upper.fill_between(
        strain,
        (stress - half_width) * unit.factor,
        (stress + half_width) * unit.factor,
        color=first_colour,
        alpha=BAND_ALPHA,
        linewidth=0,
        label="95 % band",
    )
    (rate,) = lower.plot(
        strain, curve.strain_rate[loading], color=first_colour, linewidth=1.1
    )
    format_axes(
        upper,
        [from_transmitted, from_two_waves, band],
        xlim=(0, 1.02 * strain[-1]),
        ylabel=unit.label,
    )
    strain_label = "nominal strain (%), positive in compression"
    format_axes(lower, xlabel=strain_label, ylabel="strain rate\n(1/s)")
    for each in (upper, lower):
        add_grid(each)
    lower.set_ylim(bottom=0)
    # While the forces on the two faces differ much, the second stress may be negative.
    if two_wave_stress.min() >= 0:
        upper.set_ylim(bottom=0)
    else:
        draw_zero(upper)
    return Picture(
        ax=upper,
        rate_ax=lower,
        stress=from_transmitted,
        two_wave=from_two_waves,
        band=band,
        rate=rate,
    )
