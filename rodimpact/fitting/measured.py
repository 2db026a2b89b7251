"""A measured record, and the steps from the computed strain to its prediction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from ..methods.registry import check_function
from ..model import Rod, System
from ..model.arguments import check_choice, check_kind, integer, scalar
from ..model.frozen import FrozenDataclass, Problems, invalid_argument, quantity
from ..records.comparison import Bounds
from ..records.pulses import plateau
from ..records.signal import Signal, bounds_of
from ..units import shown
from .images import Place


class Measured(FrozenDataclass):
    """A record, its gauge, and its measuring chain.

    Parameters
    ----------
    signal : Signal
        The record, cut by `Signal.window` to the part that is fitted.
    gauge : (int, float)
        Index of the body, and distance from its left end, m, where the strain is
        computed.
    distance : float, optional
        Distance from that place to the gauge of the record, m, negative if the pulse
        runs to the left. The strain is propagated over it by the exact first mode, as
        in `Signal.propagated`.
    passages : {"first", "all"}
        With "first" the strain at the place is a pulse that passes once. With "all" the
        record may contain waves that come back from the ends: the strain at the gauge
        of the record is that of images of the forces on both ends of the rod, each by
        the exact first mode over its own distance, `rodimpact.fitting.images`. Each end
        must be free or touch another body.
    radius : float, optional
        Radius of the round rod for this propagation, m; by default half the diameter of
        the rod.
    shift : float or (float, float), optional
        Delay of the computed signal, s: a fixed value, or bounds; by default free.
    gain : float or (float, float), optional
        Factor from strain to signal: a fixed value, or bounds; by default free.
    blur : float or (float, float)
        Standard deviation of the Gaussian by which the measuring chain averages over
        time, s: a fixed value, or bounds. It is 0.1325/f for a low-pass filter of f Hz,
        and 0.289 L/c for a gauge of length L at the wave speed c.
    offset : float or (float, float), optional
        Value that the record has in its middle without a pulse, in its unit: a fixed
        value, or bounds; None is free.
    trend : float or (float, float), optional
        Slope of this value over time, in the unit of the signal over s: a fixed value,
        or bounds; None is free.
    seen : function, optional
        Any other effect of gauge and amplifier on the computed signal, such as
        ``lambda strain: strain.low_pass(100e3, "first-order")``.
    level : float, optional
        Value by which misfits are divided, in the unit of the signal; by default its
        plateau.

    Raises
    ------
    ValueError
        If an argument is invalid.

    Examples
    --------
    >>> pulse = Signal([0.0, 2.0, 2.0, 0.0], dt=1e-5, unit="V", name="incident")
    >>> limits = Measured(pulse, gauge=(1, 0.5), shift=(-1e-5, 1e-5)).limits
    >>> limits["shift"], limits["gain"], limits["trend"]
    ((-1e-05, 1e-05), None, (0.0, 0.0))
    """

    signal: Signal
    gauge: tuple[int, float]
    distance: float = quantity("m", default=0.0, scalar=True)
    radius: float | None = quantity("m", "positive", default=None, scalar=True)
    shift: Bounds | None = None
    gain: Bounds | None = None
    blur: Bounds = 0.0
    offset: Bounds | None = 0.0
    trend: Bounds | None = 0.0
    seen: Callable[[Signal], Signal] | None = None
    level: float | None = None
    passages: Literal["first", "all"] = "first"

    def _check(self, problems: Problems) -> None:
        """Raise InvalidModel for wrong arguments; add a wrong `seen` to the problems.

        Invalid bounds and a signal without a plateau are wrong, too. `gauge` and
        `level` are replaced by plain numbers in SI units.
        """
        check_kind(
            "signal", self.signal, Signal, "read_signals('record.csv')['incident']"
        )
        if not isinstance(self.gauge, tuple | list) or len(self.gauge) != 2:
            raise invalid_argument(
                "gauge", f"must be (body, x), such as (1, 0.5), got {shown(self.gauge)}"
            )
        body, x = self.gauge
        self._set(gauge=(body, scalar("gauge", x, "m")))
        check_choice("passages", self.passages, ("first", "all"))
        check_function(problems, "seen", self.seen)
        if self.level is not None:
            self._set(level=scalar("level", self.level, self.signal.unit, "positive"))
        # These properties raise an error for invalid bounds, and for a signal without a
        # plateau.
        _ = self.limits
        _ = self.size

    @property
    def limits(self) -> dict[str, tuple[float, float] | None]:
        """Bounds of shift, s, gain, blur, s, offset and trend, by kind.

        The bounds are None for a free number; both are the value of a fixed number. A
        blur that is free or may be negative raises InvalidModel.
        """
        blur = bounds_of("blur", self.blur, "s")
        if blur is None or blur[0] < 0:
            raise invalid_argument(
                "blur", f"must be 0 s or more, or (low, high), got {shown(self.blur)}"
            )
        unit = self.signal.unit
        return {
            "shift": bounds_of("shift", self.shift, "s"),
            "gain": bounds_of("gain", self.gain, ""),
            "blur": blur,
            "offset": bounds_of("offset", self.offset, unit),
            "trend": bounds_of("trend", self.trend, trend_unit(unit)),
        }

    @property
    def size(self) -> float:
        """Value by which misfits are divided, in the unit of the signal."""
        if self.level is not None:
            return self.level
        return plateau(self.signal.values)

    @property
    def title(self) -> str:
        """Name of the record in tables: that of its signal, or the gauge's position."""
        if self.signal.name:
            return self.signal.name
        body, x = self.gauge
        return f"gauge {body}, {x:g} m"

    @property
    def place(self) -> Place:
        """Where the strain is computed.

        For the first passage of a pulse this is `gauge`. For all passages it is the
        gauge of the record itself, at `distance` from there, by images.
        """
        body, x = self.gauge
        if self.passages == "first":
            return Place(body, x)
        return Place(body, x + self.distance, by_images=True, radius=self.radius)

    def overlapping_shifts(self, until: float, system: System) -> tuple[float, float]:
        """Smallest and largest shift of a prediction that overlaps the record, s.

        The prediction is that of a collision from 0 to `until`, s.
        """
        until = scalar("until", until, "s", "non-negative")
        # The prediction lasts from -delay to until + delay, and a shift is added to it.
        delay = self._propagation_time(system)
        smallest = self.signal.start - (until + delay)
        largest = self.signal.end + delay
        return smallest, largest

    def _propagation_time(self, system: System) -> float:
        """Time in which waves run on from the place where the strain is computed, s."""
        if self.passages == "all":
            return 0.0
        return abs(self.distance) / float(self._rod(system).segments[0].wave_speed)

    def _rod(self, system: System) -> Rod:
        """The rod with the gauge; InvalidModel for a family, or if it is no rod.

        InvalidModel is also raised if the system has no body of this index.
        """
        check_kind("system", system, System, "System([rod, Wall()])")
        if system.shape:
            raise invalid_argument(
                "system", f"must be a single system, got {shown(system)}"
            )
        body = integer("gauge", self.gauge[0], 0, len(system.bodies) - 1)
        rod = system.bodies[body]
        check_kind(
            f"bodies.{body}", rod, Rod, "Rod(1.0, diameter=0.01, material=steel)"
        )
        assert isinstance(rod, Rod)
        return rod

    def prediction(self, strain: Signal, system: System) -> Signal:
        """Prediction of the record from the strain at `place`.

        The strain is propagated over `distance` if only the first passage counts; then
        `seen` is applied. Blur, gain, shift, offset and trend are not.
        """
        check_kind("strain", strain, Signal, "solution.gauge(1, 0.5).signal(1e-7)")
        rod = self._rod(system)
        if self.distance and self.passages == "first":
            # `propagated` delays and widens the pulse, perhaps beyond the ends of the
            # signal: its first and last values are repeated before and after it.
            margin = self._propagation_time(system)
            extended = strain.extended(margin, margin)
            strain = extended.propagated(self.distance, rod, radius=self.radius)
        if self.seen is not None:
            strain = self.seen(strain)
            check_kind("seen(strain)", strain, Signal, "strain.low_pass(100e3)")
        return strain


def trend_unit(unit: str) -> str:
    """Unit of a slope over time of a signal in this unit."""
    if unit == "":
        return "1/s"
    return f"{unit}/s"
