"""Wheatstone bridges: the strain of a bar from the output voltage of the amplifier."""

from dataclasses import KW_ONLY

from ..model.arguments import check_choice, check_kind
from ..model.frozen import FrozenDataclass, Problems, invalid_argument, quantity
from ..units import shown
from .signal import Signal

GAUGES_ALONG = {"quarter": 1, "half": 2, "full": 2}
"""Number of gauges along the bar; for a half bridge, that without gauges across."""
VOLTS_EXAMPLE = "read_signals('shot.csv', rate=1e7, units='V')['CH1']"


class Bridge(FrozenDataclass):
    """A bridge of strain gauges with its amplifier.

    Parameters
    ----------
    kind : str
        ``"quarter"``: one gauge along the bar. ``"half"``: two gauges along the bar, on
        opposite sides and in opposite arms, so that the bending strains cancel; with a
        `poisson_ratio`, one gauge along and one across. ``"full"``: two gauges along
        and two across.
    gauge_factor : float
        Gauge factor of the strain gauges.
    excitation : float
        Voltage that feeds the bridge, V.
    gain : float
        Gain of the amplifier; negative if it inverts the signal.
    poisson_ratio : float, optional
        Poisson's ratio of the bar; needed if gauges lie across the bar.

    Raises
    ------
    InvalidModel
        If an argument is invalid; the error names every invalid argument.

    Notes
    -----
    ``strain = 4 V/(n gauge_factor excitation gain)``, with n the sum of the strains of
    all arms divided by the strain along the bar: 1 for a quarter bridge, 2 or 1 + nu
    for a half bridge, 2 (1 + nu) for a full bridge. The nonlinearity of a quarter
    bridge is neglected: its relative error is half the gauge factor times the strain,
    0.2 % at 2000 microstrain.

    Examples
    --------
    >>> bridge = Bridge("quarter", gauge_factor=2.061, excitation=8.0, gain=200.0)
    >>> volts = Signal([0.0, 1.0, 1.0], dt=1e-6, unit="V", name="incident")
    >>> (bridge.strain(volts).values * 1e6).round().tolist()
    [0.0, 1213.0, 1213.0]
    """

    kind: str
    _: KW_ONLY
    gauge_factor: float = quantity("", "positive", scalar=True)
    excitation: float = quantity("V", "positive", scalar=True)
    gain: float = quantity(default=1.0, scalar=True)
    poisson_ratio: float | None = quantity("", "[0, 0.5]", default=None, scalar=True)

    def _check(self, problems: Problems) -> None:
        """Add a problem for a gain of 0, and for a missing or useless Poisson ratio.

        A full bridge needs the ratio, and a quarter bridge does not use it.
        InvalidModel is raised at once for an unknown kind.
        """
        # A gain that is not a number is among the problems already.
        if isinstance(self.gain, float) and self.gain == 0:
            problems.append(("gain", "must not be 0"))
        check_choice("kind", self.kind, GAUGES_ALONG)
        if self.kind == "full" and self.poisson_ratio is None:
            message = (
                "is missing; a full bridge needs it, two gauges lie across the bar"
            )
            problems.append(("poisson_ratio", message))
        elif self.kind == "quarter" and self.poisson_ratio is not None:
            message = "is for gauges across the bar, and a quarter bridge has none"
            problems.append(("poisson_ratio", f"{message}; leave it out"))

    @property
    def strain_per_volt(self) -> float:
        """Strain along the bar per volt at the output of the amplifier, 1/V.

        It is 4/(n gauge_factor excitation gain), where n is the sum of the strains of
        all arms divided by the strain along the bar.
        """
        nu = self.poisson_ratio
        n = float(GAUGES_ALONG[self.kind])  # without gauges across the bar
        if nu is not None and self.kind == "half":
            n = 1 + nu  # one gauge along the bar and one across
        elif nu is not None:
            n = 2 * (1 + nu)  # a full bridge: two gauges along and two across
        return 4 / (n * self.gauge_factor * self.excitation * self.gain)

    def strain(self, volts: Signal) -> Signal:
        """Return the strain along the bar, positive in tension, at the same times.

        Raises
        ------
        ValueError
            If the signal is not in volts.
        """
        check_kind("volts", volts, Signal, VOLTS_EXAMPLE)
        if volts.unit != "V":
            unit = "pure numbers"
            if volts.unit:
                unit = volts.unit
            message = f"must be a signal in V, got {shown(volts.name)} in {unit}"
            raise invalid_argument("volts", message)
        return volts.replace(values=volts.values * self.strain_per_volt, unit="")
