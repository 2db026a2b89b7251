"""The largest tension and compression in a rod, with place and time."""

from collections.abc import Iterable
from typing import NamedTuple

from ..hints import explain_missing

EQUAL_STRESS_RTOL = 1e-12
"""Stresses whose relative difference is at most this are equal up to round-off."""


@explain_missing()
class StressPeak(NamedTuple):
    """A stress, and the position and the first time at which a rod reaches it.

    Attributes
    ----------
    stress : float
        Pa, positive in tension.
    x : float
        m from the left end of the rod; nan if the rod never has stress of this sign.
    t : float
        s; nan if the rod never has stress of this sign.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> rod = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> peak = ri.solve(ri.System([rod, ri.Wall()])).extreme_stress(0).compression
    >>> round(peak.stress / (steel.density * steel.wave_speed), 12), peak.x, peak.t
    (-1.0, 0.4, 0.0)
    """

    stress: float
    x: float
    t: float


NO_STRESS = StressPeak(0.0, float("nan"), float("nan"))
"""The peak of a rod that never has stress of a sign."""


@explain_missing("tension")
class ExtremeStress(NamedTuple):
    """Largest tension and compression in a rod, at any place and time of the run.

    Attributes
    ----------
    tension : StressPeak
        The highest stress; 0 if the rod is never in tension.
    compression : StressPeak
        The lowest stress, which is negative; 0 if the rod is never in compression.

    Examples
    --------
    The shorter rod is compressed by rho c v/2. Where the longer one is in tension
    first, both reflected waves meet:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> extreme = ri.solve(ri.System([left, right])).extreme_stress(1)
    >>> unit = steel.density * steel.wave_speed
    >>> tension = extreme.tension
    >>> round(extreme.compression.stress / unit, 12), round(tension.stress / unit, 12)
    (-0.5, 0.5)
    >>> round(tension.x, 12), round(tension.t * steel.wave_speed, 12)
    (0.6, 1.4)
    """

    tension: StressPeak
    compression: StressPeak

    @property
    def largest(self) -> float:
        """The largest absolute stress, Pa."""
        return max(self.tension.stress, -self.compression.stress)


def strongest(peaks: Iterable[StressPeak]) -> StressPeak:
    """The peak of largest absolute stress; `NO_STRESS` if there is none, or all are 0.

    Among peaks that are equal up to round-off, `EQUAL_STRESS_RTOL`, it is the earliest
    one, and among several at that time the leftmost.
    """
    candidates = [NO_STRESS, *peaks]  # a stress of 0, so that there is a largest one
    largest = max(abs(peak.stress) for peak in candidates)  # Pa
    if largest == 0:
        return NO_STRESS
    equal = []
    for peak in candidates:
        if abs(peak.stress) >= largest * (1 - EQUAL_STRESS_RTOL):
            equal.append(peak)
    return min(equal, key=lambda peak: (peak.t, peak.x))
