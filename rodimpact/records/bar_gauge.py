"""A strain gauge on a bar: its record, and its distance from the specimen."""

import numpy as np

from ..model.arguments import check_kind
from ..model.frozen import FrozenDataclass, Problems, quantity
from .signal import Signal

SIGNAL_EXAMPLE = "bridge.strain(volts)"
GAUGE_EXAMPLE = "ri.BarGauge(bridge.strain(volts), distance=0.5)"


class BarGauge(FrozenDataclass):
    """A strain gauge on a bar: its record, and its distance from the specimen.

    Parameters
    ----------
    signal : Signal
        Record of strain, or of volts if a `gain` is given. The time steps are equal,
        and the bar is at rest before the pulse.
    distance : float
        Distance of the gauge from the face of the bar at the specimen, m.
    opposite : Signal, optional
        Record of the gauge on the opposite side of the bar, at the same times. The
        bending strains cancel in the mean of both records.
    gain : float
        Factor from the signal to strain.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Examples
    --------
    >>> BarGauge(Signal([0.0, -1e-3, 0.0], dt=1e-6), distance=0.5).distance
    0.5
    """

    signal: Signal
    distance: float = quantity("m", "non-negative", scalar=True)
    opposite: Signal | None = None
    gain: float = quantity("", default=1.0, scalar=True)

    def _check(self, problems: Problems) -> None:
        """Add a problem if the record has a unit, but the gain is 1.

        InvalidModel is raised at once for a record that is not a Signal. If there is no
        problem, ValueError is raised for two records of different times or units.
        """
        check_kind("signal", self.signal, Signal, SIGNAL_EXAMPLE)
        if self.opposite is not None:
            check_kind("opposite", self.opposite, Signal, SIGNAL_EXAMPLE)
        if self.signal.unit and np.array_equal(self.gain, 1):
            message = f"must be strain, got {self.signal.unit}"
            problems.append(
                ("signal", f"{message}; give bridge.strain(volts), or a gain")
            )
        if not problems:
            # `strain` adds both records, which must have the same times and units.
            _ = self.strain

    @property
    def strain(self) -> Signal:
        """Strain of the gauge, or mean strain of both gauges of a pair; dimensionless.

        It is the gain times the signal, with the sign of the signal.
        """
        signal = self.signal
        if self.opposite is not None:
            signal = (signal + self.opposite) / 2
        return (signal * self.gain).replace(unit="")

    @property
    def bending(self) -> Signal | None:
        """Bending strain: half the difference of the strains of both sides.

        None if only one side has a gauge.
        """
        if self.opposite is None:
            return None
        return ((self.signal - self.opposite) / 2 * self.gain).replace(unit="")
