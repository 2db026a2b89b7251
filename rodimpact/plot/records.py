"""Records: measured and predicted signal with the residual, and what they say of a specimen."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..fitting.result import Fit
from ..methods.signals import Floats
from ..model.arguments import of_kind, whole
from ..model.frozen import refusal
from ..records.comparison import Bounds, gain_unit, plateau
from ..records.reduction import Reduction
from ..records.signal import Signal
from ..units import TIMES
from .sampling import telling
from .scales import engineering, signed
from .style import SMALL, Picture, colours, dress, grid, new_figure, styled, two_axes


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
    """Draw a record over its prediction, and below the residual, measured minus predicted.

    The prediction is drawn with the given shift and scale, by default with those of the smallest
    misfit; its label names both. The misfit is the root mean square of the residual divided by the
    plateau of the record.

    Parameters
    ----------
    measured : Signal
        The record, cut to the part to be compared by `Signal.window`.
    predicted : Signal
        The prediction. Before it its first value holds, after it its last value.
    ax : two Axes, optional
        For signals and residual; by default those of a new figure, one above the other.
    shift, scale : float or (float, float), optional
        Of the prediction, s and a factor: fixed, or between bounds, as for `Signal.misfit`.
    band : Signal, optional
        Half width of a band about the prediction, such as two standard errors, over the times and
        in the unit of the prediction.

    Returns
    -------
    Picture
        With `residual_ax`, the lines `measured`, `predicted` and `residual`, the `band` or None,
        and the numbers `misfit`.

    Raises
    ------
    ValueError
        If `ax` is not a pair, or the units of band and prediction differ; also the errors of
        `Signal.misfit`.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> pulse = ri.Signal(np.hanning(201), dt=1e-6, name="incident")
    >>> picture = ri.plot.comparison(pulse, (0.5 * pulse).shifted(-3e-6))
    >>> picture.predicted.get_label().replace(ri.units.TIMES, 'times')
    'predicted, 3 µs later, times 2'
    """
    of_kind("measured", measured, Signal, "read_signals('shot.csv')['incident']")
    found = measured.misfit(predicted, shift=shift, scale=scale)
    t, values = measured.times, measured.values
    model: Floats = found.scale * np.interp(
        t - found.shift, predicted.times, predicted.values
    )
    upper, lower = two_axes(ax, "signals and residual", 4.2, (3, 1))

    time = engineering("time t", float(np.abs(t).max()), "s")
    unit = engineering(
        measured.name or "signal", float(np.abs(values).max()), measured.unit
    )
    percent = 100 / plateau(values)
    series, faint = colours().series, colours().faint
    area = None
    if band is not None:
        of_kind("band", band, Signal, "0.02 * predicted")
        if band.unit != predicted.unit:
            raise refusal(
                "band",
                f"must be in the unit of the prediction, {predicted.unit!r}, "
                f"got {band.unit!r}",
            )
        wide = abs(found.scale) * np.interp(
            t - found.shift, band.times, np.abs(band.values)
        )
        filled: Any = {"color": series[1], "alpha": 0.25, "linewidth": 0}
        area = upper.fill_between(
            t * time.factor,
            (model - wide) * unit.factor,
            (model + wide) * unit.factor,
            label="its band",
            **filled,
        )
        lower.fill_between(t * time.factor, -wide * percent, wide * percent, **filled)

    def line(on: Axes, y: Floats, factor: float, **how: Any) -> Line2D:
        kept = telling(y)
        return on.plot(t[kept] * time.factor, y[kept] * factor, **how)[0]

    told = "predicted"  # and its shift and scale in words, if it was changed
    if found.shift:
        late = engineering("", abs(found.shift), "s").write(abs(found.shift))
        told += f", {late} {'later' if found.shift > 0 else 'earlier'}"
        told += " (at its limit)" if "shift" in found.at_limit else ""
    if found.scale != 1:
        gain = gain_unit(measured.unit, predicted.unit)
        told += f", {TIMES} {signed(f'{found.scale:.4g} {gain}')}".rstrip()
        told += " (at its limit)" if "scale" in found.at_limit else ""
    one = line(
        upper, values, unit.factor, color=series[0], linewidth=1.2, label="measured"
    )
    other = line(
        upper,
        model,
        unit.factor,
        color=series[1],
        linewidth=1.2,
        linestyle="--",
        label=told,
    )
    left = line(lower, values - model, percent, color=colours().ink, linewidth=0.9)
    for each, named in ((upper, [one, other, area]), (lower, ())):
        each.axhline(0.0, color=faint, linewidth=0.6, zorder=0)
        grid(each)
        dress(each, named, xlim=(t[0] * time.factor, t[-1] * time.factor))
    upper.set_ylabel(unit.label, parse_math=False)
    lower.set(xlabel=time.label, ylabel="residual\n(% of plateau)")
    reach = 1.9 * max(map(abs, lower.get_ylim()))
    lower.set_ylim(-reach, reach)
    lower.text(
        0.01,
        0.97,
        f"misfit {100 * found.rms:.3g} % of the plateau",
        transform=lower.transAxes,
        va="top",
        fontsize=SMALL + 1,
        color=colours().ink,
    )
    return Picture(
        ax=upper,
        residual_ax=lower,
        measured=one,
        predicted=other,
        residual=left,
        band=area,
        misfit=found,
    )


def fit(found: Fit, ax: Sequence[Axes] | None = None, record: int = 0) -> Picture:
    """Draw a record over its prediction with a band of two standard errors, the residual below.

    The band follows from the standard errors of the fitted numbers; it does not include model
    error.

    Parameters
    ----------
    found : Fit
    ax : two Axes, optional
        For signals and residual; by default those of a new figure, one above the other.
    record : int
        Which of the records.

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
    of_kind("found", found, Fit, "fit(system, measured, vary, until)")
    record = whole("record", record, 0, len(found.measured) - 1)
    predicted = found.predicted[record]
    return comparison(
        found.measured[record].signal,
        predicted,
        ax,
        shift=0.0,
        scale=1.0,
        band=predicted.replace(values=2 * found.bands[record]),
    )


@styled
def side_by_side(count: int) -> list[tuple[Axes, Axes]]:
    """Axes for signals and residual of so many comparisons, on a new figure."""
    figure = new_figure(5.6 * count, 4.2)
    grid = figure.subplots(2, count, squeeze=False, sharex="col", height_ratios=(3, 1))
    return list(zip(*grid.tolist(), strict=True))


@styled
def reduction(found: Reduction, ax: Sequence[Axes] | None = None) -> Picture:
    """Draw the stress of a specimen over its strain up to the largest, and below the strain rate.

    The stress from the transmitted wave has an error band. Where the stress from the incident and
    the reflected wave differs from it, the forces on the two faces are not yet equal.

    Parameters
    ----------
    found : Reduction
    ax : two Axes, optional
        For stress and strain rate; by default those of a new figure, one above the other.

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
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)     # c = 5000 m/s
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
    of_kind(
        "found", found, Reduction, "ri.reduce(input_gauge, output_gauge, bar, specimen)"
    )
    upper, lower = two_axes(ax, "stress and strain rate", 4.6, (3, 1))
    up, first, second = found.loading, *colours().series[:2]
    strain, stress, around = (
        100 * found.strain[up],
        found.stress[up],
        found.stress_band[up],
    )
    unit = engineering("stress", float(np.abs(stress).max()), "Pa")
    (one,) = upper.plot(
        strain,
        stress * unit.factor,
        color=first,
        linewidth=1.3,
        label="transmitted wave",
    )
    (two,) = upper.plot(
        strain,
        found.two_wave_stress[up] * unit.factor,
        color=second,
        linewidth=0.9,
        linestyle="--",
        label="incident and reflected wave",
    )
    band = upper.fill_between(
        strain,
        (stress - around) * unit.factor,
        (stress + around) * unit.factor,
        color=first,
        alpha=0.25,
        linewidth=0,
        label="95 % band",
    )
    (rate,) = lower.plot(strain, found.strain_rate[up], color=first, linewidth=1.1)
    dress(upper, [one, two, band], xlim=(0, 1.02 * strain[-1]), ylabel=unit.label)
    dress(lower, xlabel="strain (%)", ylabel="strain rate\n(1/s)")
    for each in (upper, lower):
        grid(each)
        each.set_ylim(bottom=0)
    return Picture(
        ax=upper, rate_ax=lower, stress=one, two_wave=two, band=band, rate=rate
    )
