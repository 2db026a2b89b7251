"""A copper specimen between two Hopkinson bars, driven by the pulse that was measured.

The record of the incident bar up to 115 us, and 0 after, comes in through the end of a bar at its
gauge; between the bars lies a specimen that yields. One fit of its stiffness, yield force and
hardening to the reflected and the transmitted pulse. Misfit is the root of the mean square from
120 to 235 us over the plateau of the incident pulse, the median of its samples above 2.5 V.

Bars without dispersion leave 5.1 % of the reflected pulse and 2.2 % of the transmitted one; with a
spring for the specimen it is 21 and 19. Carried to the specimen and from there to the gauges by the
exact first mode, 2.8 and 2.1. The fit finds 610 +- 110 N/um, 4.0 +- 0.6 kN and 16.4 +- 0.8 N/um,
with dispersion 760 +- 130, 3.5 +- 0.4 and 16.9 +- 0.6. Errors of yield force and hardening go
together (correlation -0.7); model error is not in them.

Expected: 0, with bounds a little above these numbers.

Source: measurements, see records/README.md.
"""

import numpy as np

import rodimpact as ri

from .measured_pulses import TITANIUM, record
from .table import Row, Rows

START, STOP = -20e-6, 115e-6  # s, of the incident pulse
WINDOW = 120e-6, 235e-6  # s, of the reflected and the transmitted one
HIGH = 2.5  # V, above which samples belong to the plateau
STRAIN = 4 / (2.061 * 8.0 * 200)  # for each volt: gauge factor, excitation in V, gain
UNTIL = 3e-4  # s
UNKNOWN = {
    "contacts.0.stiffness": (3e7, 1e10),
    "contacts.0.yield_force": (1e3, 2e4),
    "contacts.0.hardening": (1e5, 2e7),
}  # N/m, N
SPRING = {"contacts.0.stiffness": (1e6, 1e10)}


def fitted(
    specimen: ri.Yielding | ri.Spring, dispersion: bool = False, starts: int = 1
) -> ri.Fit:
    """Fit of a specimen to the reflected and the transmitted pulse."""
    first, last = record(TITANIUM)
    bar, near = TITANIUM.bar, TITANIUM.to_gauge
    c = bar.wave_speed
    pulse = first.resampled(times=np.arange(START, STOP, first.dt))
    level = float(np.median(first.values[first.values > HIGH]))
    late, distance = START, 0.0
    if (
        dispersion
    ):  # pulses run without any in the model, so it is added before and after
        distance, late = near, START - near / c
        pulse = pulse.extended(1e-4, 1e-4).propagated(near, bar).shifted(-near / c)
        pulse = pulse.resampled(times=np.arange(START, STOP + 6e-5, first.dt))
    wave = ri.Samples([*(-STRAIN * pulse.values), 0.0], step=first.dt)
    material = ri.Material(
        "bar",
        youngs_modulus=TITANIUM.density * c**2,
        density=TITANIUM.density,
        poisson_ratio=bar.poisson_ratio,
    )
    bars = [ri.Rod(near, diameter=2 * bar.radius, material=material)] * 2
    system = ri.System(
        bars, contacts=[specimen], ends=[ri.Incoming(wave), ri.Absorbing()]
    )
    records = [
        ri.Measured(
            signal.window(*WINDOW),
            gauge,
            distance,
            bar.radius if distance else None,
            shift=late,
            gain=-1 / STRAIN,
            level=level,
        )
        for signal, gauge in ((first, (0, 0.0)), (last, (1, near)))
    ]
    unknown = UNKNOWN if isinstance(specimen, ri.Yielding) else SPRING
    return ri.fit(system, records, unknown, UNTIL, starts=starts)


def run() -> Rows:
    """Misfits in per cent."""
    copper = ri.Yielding(1e8, 5e3, 1e6)
    cases = [
        ("copper specimen, yielding", fitted(copper, starts=3), (5.2, 2.5)),
        (
            "copper specimen, yielding, dispersion",
            fitted(copper, dispersion=True),
            (3.0, 2.3),
        ),
        ("copper specimen, spring", fitted(ri.Spring(1e8)), (22.0, 20.0)),
    ]
    pulses = "reflected", "transmitted"
    for case, fit, bounds in cases:
        for pulse, misfit, bound in zip(pulses, fit.misfits, bounds, strict=True):
            yield Row(
                case,
                f"misfit of the {pulse} pulse, %",
                "measured, LANL HopPyBar",
                0.0,
                100 * misfit,
                bound,
            )
