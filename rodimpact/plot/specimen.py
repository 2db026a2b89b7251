"""Specimen between two bars: stress over strain with its error band, and the strain rate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

from ..model.arguments import of_kind
from ..records.reduction import Reduction
from .scales import engineering
from .style import colours, dress, grid, new_figure, picture, styled, two_axes


@picture
class Reduced(NamedTuple):
    """Artists of a reduction."""

    ax: Axes
    rate_ax: Axes
    stress: Line2D
    two_wave: Line2D
    band: PolyCollection
    rate: Line2D


@styled
def reduction(found: Reduction, ax: Sequence[Axes] | None = None) -> Reduced:
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
    Reduced

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
    of_kind("found", found, Reduction, "ri.reduce(input_gauge, output_gauge, bar, specimen)")
    if ax is None:
        figure = new_figure(5.6, 4.6)
        ax = figure.subplots(2, sharex=True, height_ratios=(3, 1)).tolist()
    upper, lower = two_axes(ax, "stress and strain rate")
    up, first, second = found.loading, *colours().series[:2]
    strain, stress, around = 100 * found.strain[up], found.stress[up], found.stress_band[up]
    unit = engineering("stress", float(np.abs(stress).max()), "Pa")
    (one,) = upper.plot(strain, stress * unit.factor, color=first, linewidth=1.3,
                        label="transmitted wave")
    (two,) = upper.plot(strain, found.two_wave_stress[up] * unit.factor, color=second,
                        linewidth=0.9, linestyle="--", label="incident and reflected wave")
    band = upper.fill_between(
        strain, (stress - around) * unit.factor, (stress + around) * unit.factor, color=first,
        alpha=0.25, linewidth=0, label="95 % band")
    (rate,) = lower.plot(strain, found.strain_rate[up], color=first, linewidth=1.1)
    dress(upper, [one, two, band], xlim=(0, 1.02 * strain[-1]), ylabel=unit.label)
    dress(lower, xlabel="strain (%)", ylabel="strain rate\n(1/s)")
    for each in (upper, lower):
        grid(each)
        each.set_ylim(bottom=0)
    return Reduced(upper, lower, one, two, band, rate)
