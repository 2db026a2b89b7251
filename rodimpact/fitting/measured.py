"""A record, and how what is computed becomes comparable with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..methods.registry import check_function
from ..model import Rod, System
from ..model.arguments import of_kind, single
from ..model.frozen import Problems, raise_noted, refusal
from ..records.comparison import Bounds, overlaps, plateau
from ..records.signal import Signal, bounds_of
from ..units import shown


@dataclass(frozen=True)
class Measured:
    """A record, and where and how it was measured.

    Parameters
    ----------
    signal : Signal
        Cut by `Signal.window` to what is to be explained.
    gauge : (int, float)
        Body, and place in m from its left end, where strain is computed.
    distance : float, optional
        From there to the gauge of the record, m, negative where the pulse runs to the left: exact
        waves carry it so far, as `Signal.propagated` does.
    radius : float, optional
        Of the round rod in which they do, m, unless it is given by its diameter.
    shift : float or (float, float), optional
        By which the computed signal comes later, s: fixed, or between bounds; by default free.
    gain : float or (float, float), optional
        By which strain is multiplied to be the signal: fixed, or between bounds; by default free.
    blur : float or (float, float)
        Standard deviation of the bell by which the measuring chain averages over time, s: fixed, or
        between bounds. It is 0.1325/f for a low-pass of f Hz, and 0.289 L/c for a gauge of length L
        at the wave speed c.
    seen : function, optional
        Any other effect of gauge and amplifier on the computed signal, such as
        ``lambda strain: strain.low_pass(100e3, "first-order")``.
    level : float, optional
        What misfits are relative to, in the unit of the signal; by default its plateau.

    Raises
    ------
    ValueError
        If an argument is not what it should be.

    Examples
    --------
    >>> pulse = Signal([0.0, 2.0, 2.0, 0.0], dt=1e-5, unit="V", name="incident")
    >>> Measured(pulse, gauge=(1, 0.5), shift=(-1e-5, 1e-5)).limits
    {'shift': (-1e-05, 1e-05), 'gain': None, 'blur': (0.0, 0.0)}
    """

    signal: Signal
    gauge: tuple[int, float]
    distance: float = 0.0
    radius: float | None = None
    shift: Bounds | None = None
    gain: Bounds | None = None
    blur: Bounds = 0.0
    seen: Callable[[Signal], Signal] | None = None
    level: float | None = None

    def __post_init__(self) -> None:
        of_kind("signal", self.signal, Signal, "read_signals('record.csv')['incident']")
        if not isinstance(self.gauge, tuple | list) or len(self.gauge) != 2:
            raise refusal("gauge", f"must be (body, x), such as (1, 0.5), got {shown(self.gauge)}")
        body, x = self.gauge
        self._set("gauge", (body, single("gauge", x, "m")))
        self._set("distance", single("distance", self.distance, "m"))
        problems: Problems = []
        check_function(problems, "seen", self.seen)
        raise_noted(problems)
        if self.level is not None:
            unit = self.signal.unit
            self._set("level", single("level", self.level, unit, "positive"))
        _ = self.limits, self.size

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    @cached_property
    def limits(self) -> dict[str, tuple[float, float] | None]:
        """Bounds of shift, s, gain, and blur, s; None where the number is free."""
        blur = bounds_of("blur", self.blur, "s")
        if blur is None or blur[0] < 0:
            raise refusal("blur", f"must be 0 s or more, or (low, high), got {shown(self.blur)}")
        return {"shift": bounds_of("shift", self.shift, "s"),
                "gain": bounds_of("gain", self.gain, ""), "blur": blur}

    @cached_property
    def size(self) -> float:
        """What misfits are relative to, in the unit of the signal."""
        return self.level or plateau(self.signal.values)

    @property
    def title(self) -> str:
        """What a table calls it."""
        return self.signal.name or f"gauge {self.gauge[0]}, {self.gauge[1]:g} m"

    def shifts(self, until: float, system: System) -> tuple[float, float]:
        """All shifts, s, by which a collision to `until` overlaps the record."""
        longer = self._lasting(system)
        return overlaps((self.signal.start, self.signal.end), (-longer, until + longer))

    def _lasting(self, system: System) -> float:
        """How long waves take over `distance`, s."""
        if not self.distance:
            return 0.0
        rod = system.bodies[self.gauge[0]]
        assert isinstance(rod, Rod)
        return abs(self.distance) / float(rod.segments[0].wave_speed)

    def carried(self, strain: Signal, system: System) -> Signal:
        """What is compared with the record, but for shift, gain and blur."""
        if self.distance:
            lasting, rod = self._lasting(system), system.bodies[self.gauge[0]]
            assert isinstance(rod, Rod)
            longer = strain.extended(lasting, lasting)
            strain = longer.propagated(self.distance, rod, radius=self.radius)
        if self.seen is None:
            return strain
        seen = self.seen(strain)
        of_kind("seen(strain)", seen, Signal, "strain.low_pass(100e3)")
        return seen
