"""A copper specimen between two Hopkinson bars, driven by the pulse that was measured.

The incoming wave is the record of the incident bar up to 115 us, and 0 afterwards. It
enters through the end of a bar at the position of the gauge. A yielding specimen lies
between the bars. The stiffness, the yield force and the hardening of the specimen are
fitted to the reflected and the transmitted pulse together. The misfit is the root mean
square from 120 to 235 us, divided by the plateau of the incident pulse. The plateau is
the median of the samples above 2.5 V.

With bars without dispersion the misfit is 5.1 % for the reflected pulse and 2.2 % for
the transmitted pulse. With a spring in place of the specimen it is 21 and 19 %. If the
exact first mode propagates the pulses to the specimen and to the gauges, it is 2.8 and
2.1 %. Without dispersion the fit finds 610 +- 110 N/um, 4.0 +- 0.6 kN and 16.4 +- 0.8
N/um. With dispersion it finds 760 +- 130 N/um, 3.5 +- 0.4 kN and 16.9 +- 0.6 N/um. The
errors of yield force and hardening are correlated (-0.7). These errors do not include
the error of the model.

The expected misfit is 0, with bounds slightly above these numbers.

Source: measurements, see records/README.md.
"""

from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .measured_pulses import TITANIUM, record
from .table import Case, Rows

BAR = TITANIUM.bar
GAUGE_DISTANCE = TITANIUM.to_gauge  # distance from the specimen, m
START = -20e-6  # start of the incident pulse, s
STOP = 115e-6
WINDOW = (120e-6, 235e-6)  # span of the reflected and the transmitted pulse, s
PLATEAU_VOLTAGE = 2.5  # least voltage of samples of the plateau, V
GAUGE_FACTOR = 2.061
EXCITATION = 8.0  # V
GAIN = 200
STRAIN_PER_VOLT = 4 / (GAUGE_FACTOR * EXCITATION * GAIN)
UNTIL = 3e-4  # s
DISPERSION_MARGIN = 1e-4  # zeros before and after a pulse that is dispersed, s
DISPERSED_TAIL = 6e-5  # time that a dispersed pulse lasts longer, s
YIELDING_BOUNDS = {
    "contacts.0.stiffness": (3e7, 1e10),  # N/m
    "contacts.0.yield_force": (1e3, 2e4),  # N
    "contacts.0.hardening": (1e5, 2e7),  # N/m
}
SPRING_BOUNDS = {"contacts.0.stiffness": (1e6, 1e10)}  # N/m


class BarModel(NamedTuple):
    """How the pulses get from the gauges to the specimen and back."""

    pulse: ri.Signal  # pulse that enters the end of the incident bar, V
    interval: float  # interval of its samples, s
    distance: float  # distance over which signals of the model are dispersed, m
    shift: float  # shift of the clock of the records, s


def without_dispersion(incident: ri.Signal) -> BarModel:
    """Bars begin at the gauges, and waves keep their shape."""
    times = np.arange(START, STOP, incident.dt)
    pulse = incident.resampled(times=times)
    return BarModel(pulse, incident.dt, distance=0.0, shift=START)


def with_dispersion(incident: ri.Signal) -> BarModel:
    """Model in which the exact first mode carries pulses to the specimen and back.

    In the solver pulses keep their shape, so dispersion is added before and after it:
    here to the incident pulse, by the fit to the reflected and the transmitted one.
    """
    travel_time = GAUGE_DISTANCE / BAR.wave_speed
    pulse = without_dispersion(incident).pulse
    pulse = pulse.extended(DISPERSION_MARGIN, DISPERSION_MARGIN)
    # The shift back takes off the travel time: only the change of shape is left.
    pulse = pulse.propagated(GAUGE_DISTANCE, BAR).shifted(-travel_time)
    times = np.arange(START, STOP + DISPERSED_TAIL, incident.dt)
    pulse = pulse.resampled(times=times)
    shift = START - travel_time
    return BarModel(pulse, incident.dt, distance=GAUGE_DISTANCE, shift=shift)


def pressure_bar(model: BarModel, specimen: ri.Yielding | ri.Spring) -> ri.System:
    """Two titanium bars and the specimen; the pulse comes in on the left.

    The pulse of the model is a voltage, which becomes the strain of the incoming wave.
    The far end absorbs.
    """
    density = TITANIUM.density
    material = ri.Material(
        "bar",
        youngs_modulus=density * BAR.wave_speed**2,
        density=density,
        poisson_ratio=BAR.poisson_ratio,
    )
    bar = ri.Rod(GAUGE_DISTANCE, diameter=2 * BAR.radius, material=material)
    strain = -STRAIN_PER_VOLT * model.pulse.values
    wave = ri.Samples([*strain, 0.0], step=model.interval)
    ends = [ri.Incoming(wave), ri.Absorbing()]
    return ri.System([bar, bar], contacts=[specimen], ends=ends)


def measured(
    signal: ri.Signal, gauge: tuple[int, float], model: BarModel, level: float
) -> ri.Measured:
    """The reflected or the transmitted pulse, for a fit.

    A positive voltage means compression, a negative strain; so the gain is negative.
    Without dispersion, that is at `distance` 0, the pulse is not propagated.
    """
    radius = None
    if model.distance:
        radius = BAR.radius
    return ri.Measured(
        signal.window(*WINDOW),
        gauge,
        distance=model.distance,
        radius=radius,
        shift=model.shift,
        gain=-1 / STRAIN_PER_VOLT,
        level=level,
    )


def fitted(
    specimen: ri.Yielding | ri.Spring, dispersion: bool = False, starts: int = 1
) -> ri.Fit:
    """Fit of a specimen to the reflected and the transmitted pulse.

    Without `dispersion` the bars do not disperse the pulses. The bounds of the unknown
    numbers are those for a yielding specimen or for a spring.
    """
    first, last = record(TITANIUM)
    plateau = first.values[first.values > PLATEAU_VOLTAGE]
    level = float(np.median(plateau))
    model = without_dispersion(first)
    if dispersion:
        model = with_dispersion(first)
    system = pressure_bar(model, specimen)
    reflected = measured(first, (0, 0.0), model, level)
    transmitted = measured(last, (1, GAUGE_DISTANCE), model, level)
    bounds = SPRING_BOUNDS
    if isinstance(specimen, ri.Yielding):
        bounds = YIELDING_BOUNDS
    return ri.fit(system, [reflected, transmitted], bounds, UNTIL, starts=starts)


def misfits(
    name: str, fit: ri.Fit, max_reflected: float, max_transmitted: float
) -> Rows:
    """Misfits of both pulses, per cent, and their bounds."""
    case = Case(name, "measured, LANL HopPyBar")
    reflected = 100 * fit.misfits[0]
    transmitted = 100 * fit.misfits[1]
    yield case.row("misfit of the reflected pulse, %", 0.0, reflected, max_reflected)
    yield case.row(
        "misfit of the transmitted pulse, %", 0.0, transmitted, max_transmitted
    )


def run() -> Rows:
    """Misfits of fits to the measured pulses: a yielding specimen, and a spring.

    The yielding specimen is fitted without and with dispersion in the bars.
    """
    copper = ri.Yielding(stiffness=1e8, yield_force=5e3, hardening=1e6)
    yielding = fitted(copper, starts=3)
    name = "copper specimen, yielding"
    yield from misfits(name, yielding, max_reflected=5.2, max_transmitted=2.5)
    dispersed = fitted(copper, dispersion=True)
    name = "copper specimen, yielding, dispersion"
    yield from misfits(name, dispersed, max_reflected=3.0, max_transmitted=2.3)
    spring = fitted(ri.Spring(1e8))
    name = "copper specimen, spring"
    yield from misfits(name, spring, max_reflected=22.0, max_transmitted=20.0)
