"""Effect of the alignment of the waves of a shot on the balance of its forces."""

from typing import NamedTuple

import numpy as np

from ..hints import explain_missing
from ..units import format_si
from .curve import Curve
from .two_bar_shot import Shifts


@explain_missing()
class Alignment(NamedTuple):
    """Imbalance of the forces without and with the alignment of the waves.

    The alignment shifts waves so that the forces balance in the elastic start of the
    loading. The imbalance over all loading is the mean of abs(F1 - F2) divided by the
    mean of (F1 + F2)/2.

    Attributes
    ----------
    limit : float
        Largest shift that was allowed, s.
    imbalance_before, imbalance_after : float
        Imbalance over all loading without the shifts, and with them.

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
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5), align_within=1e-6)
    >>> found.alignment.limit, found.alignment.imbalance_before < 0.01
    (1e-06, True)
    """

    limit: float
    imbalance_before: float
    imbalance_after: float


def alignment_sentence(alignment: Alignment, shifts: Shifts) -> str:
    """Phrase on an alignment: its limit, both shifts, and the imbalance of the forces.

    The imbalance is that over all loading, in percent of the mean force, with the
    shifts and without them.
    """
    return (
        "aligned by the start of loading alone, up to half of the peak stress, within "
        f"{format_si(alignment.limit, 's', 3)}: reflected wave taken "
        f"{_how_much_earlier(shifts.reflected)}, transmitted wave "
        f"{_how_much_earlier(shifts.transmitted)}; |F1 - F2| over all loading is "
        f"{100 * alignment.imbalance_after:.1f} % of the mean force, "
        f"{100 * alignment.imbalance_before:.1f} % without alignment"
    )


def _how_much_earlier(shift: float) -> str:
    """A shift, s, in words: "433 ns earlier" for 433e-9, "433 ns later" for -433e-9."""
    direction = "earlier"
    if shift < 0:
        direction = "later"
    return f"{format_si(abs(shift), 's', 3)} {direction}"


def loading_imbalance(curve: Curve) -> float:
    """Mean of abs(F1 - F2) divided by the mean of (F1 + F2)/2, while loading.

    Loading is the time up to the largest strain.
    """
    input_force = curve.input_force[curve.loading]
    output_force = curve.output_force[curve.loading]
    difference = np.abs(input_force - output_force).mean()
    mean_force = (input_force + output_force).mean() / 2
    return float(difference / mean_force)
