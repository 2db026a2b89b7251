"""Mean curve of several shots, and their scatter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing
from ..model.arguments import integer
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..storage.tables import align
from ..units import format_si, shown
from .reduction import Reduction
from .strain_table import strain_label, table_strains

MAX_CURVE_POINTS = 10**6
"""Largest number of strains of a mean curve."""


@explain_missing()
class MeanCurve(NamedTuple):
    """Mean curve of several shots.

    Attributes
    ----------
    strain : array, shape (n,)
        Strains from 0 to the largest strain that all shots reach.
    stress, strain_rate : array, shape (n,)
        Means over the shots, Pa and 1/s.
    scatter : array, shape (n,)
        Standard deviation of the stress from shot to shot, Pa.
    shots : int
        Number of shots.

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

    def __str__(self) -> str:
        """Number of shots, peak of the mean stress, and a table at round strains."""
        peak = int(self.stress.argmax())
        at_peak = float(self.strain[peak])
        strains = table_strains(at_peak, float(self.strain[-1]))
        rows = [["strain", "strain rate", "mean stress", "scatter"]]
        for strain in strains:
            rate = float(np.interp(strain, self.strain, self.strain_rate))
            stress = float(np.interp(strain, self.strain, self.stress))
            scatter = float(np.interp(strain, self.strain, self.scatter))
            rows.append(
                [
                    strain_label(strain, at_peak),
                    f"{rate:.0f} 1/s",
                    format_si(stress, "Pa", digits=4),
                    format_si(scatter, "Pa", digits=2),
                ]
            )
        title = (
            f"mean of {self.shots} shots: peak stress "
            f"{format_si(self.stress[peak], 'Pa', 4)} at {100 * at_peak:.3g} % of "
            "strain; scatter is the standard deviation from shot to shot"
        )
        return f"{title}\n{align(rows)}"

    def __repr__(self) -> str:
        return f"<MeanCurve of {self.shots} shots, strain up to {self.strain[-1]:.3g}>"


@explain_arguments
def mean_of_shots(shots: Sequence[Reduction], points: int = 201) -> MeanCurve:
    """Mean and scatter of the stress of several shots over their strain.

    The common strains go from 0 to the largest strain that all shots reach. The scatter
    is the standard deviation of the stress from shot to shot.

    Parameters
    ----------
    shots : sequence of Reduction
        Two or more.
    points : int
        Number of common strains, 2 or more.

    Raises
    ------
    InvalidModel
        If there are fewer than two shots, or `points` is out of bounds.

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
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> mean = ri.mean_of_shots([found, found])
    >>> mean.shots, float(mean.scatter.max())
    (2, 0.0)
    """
    is_sequence = isinstance(shots, Sequence) and len(shots) > 1
    if not is_sequence or not all(isinstance(shot, Reduction) for shot in shots):
        raise invalid_argument(
            "shots",
            f"must be two or more Reductions from ri.reduce, got {shown(shots)}",
        )
    points = integer("points", points, low=2, high=MAX_CURVE_POINTS)
    common_strain = min(float(shot.strain.max()) for shot in shots)
    strain = np.linspace(0, common_strain, points)
    stresses = []
    rates = []
    for shot in shots:
        stresses.append(shot.at_strain(strain, shot.stress))
        rates.append(shot.at_strain(strain, shot.strain_rate))
    return MeanCurve(
        strain=strain,
        stress=np.mean(stresses, axis=0),
        strain_rate=np.mean(rates, axis=0),
        # `ddof`: divided by n - 1, since the mean is taken from the same n shots
        scatter=np.std(stresses, axis=0, ddof=1),
        shots=len(shots),
    )
