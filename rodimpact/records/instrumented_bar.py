"""A bar with the strains at its gauges, and how waves run along it.

A gauge at the distance d from the face of the bar at the specimen records
e(t) = i(t + d/c) + r(t - d/c). The wave i runs towards the face, the wave r away from
it; i(t) and r(t) are their strains at the face. In a bar with dispersion each frequency
f has its own phase velocity c(f). Strains are positive in compression here.
"""

from __future__ import annotations

from typing import NamedTuple

from ..model.bodies import Rod
from ..model.quantities import Floats
from .bar_gauge import BarGauge
from .pulses import Pulse
from .waveguide import Waveguide


class InstrumentedBar(NamedTuple):
    """One bar with its gauges: compressive strains at equal time steps.

    All gauges have the same times. The gauges are in the order in which the first pulse
    arrives. This pulse runs towards the specimen in the input bar, away from it in the
    output bar.
    """

    rod: Rod
    is_output: bool  # whether it is the output bar
    gauges: tuple[BarGauge, ...]
    first_pulses: tuple[Pulse, ...]  # one at each gauge
    distances: Floats  # [gauge], m from the specimen
    strains: Floats  # [gauge, sample], minus the level at rest
    times: Floats  # s
    dt: float  # s
    rest_samples: int  # number of samples at rest before the first pulse

    @property
    def first_pulse(self) -> Pulse:
        """The first pulse at the first gauge."""
        return self.first_pulses[0]

    @property
    def guide(self) -> Waveguide:
        """Waves along the bar at the steps of the records."""
        return Waveguide(self.rod, self.dt)

    @property
    def speed(self) -> float:
        """Bar speed c0, m/s."""
        return self.guide.speed

    @property
    def stiffness(self) -> float:
        """Young's modulus times cross-sectional area, E A, N."""
        return self.guide.stiffness

    @property
    def impedance(self) -> float:
        """Force over particle velocity in a wave, E A/c0, kg/s."""
        return self.guide.impedance

    @property
    def pulse_start(self) -> float:
        """Estimated begin of the first pulse at the first gauge, s.

        It is one rise time before the time at which the pulse has a tenth of its
        plateau.
        """
        return self.first_pulse.start - self.first_pulse.rise

    @property
    def known_until(self) -> Floats:
        """Time up to which the record of each gauge shows the waves at the face, s.

        A wave that leaves the face at this time reaches the gauge just before the end
        of the record: two periods of the cut-off frequency before, or one sample if it
        is longer. In this last part the end of the record disturbs the waves. The shape
        is [gauge].
        """
        travels = self.distances / self.speed
        ringing = max(self.dt, 2 / self.guide.cut_off)  # the cut-off may be infinite
        until: Floats = self.times[-1] - travels - ringing
        return until

    def propagated(self, strain: Floats, distance: float) -> Floats:
        """Strain of a wave after a distance, m, along the bar, at the same times.

        The wave is delayed by its travel time; a negative distance makes it earlier.
        The bar is assumed to be at rest before the first time.
        """
        return self.guide.propagated(strain, distance)


class InstrumentedBars(NamedTuple):
    """The input bar, which the striker hits, and the output bar."""

    input: InstrumentedBar
    output: InstrumentedBar
