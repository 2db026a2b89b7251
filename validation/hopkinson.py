"""Pulses in Hopkinson bars: striker, incident bar, spring as specimen, other bar.

A striker of length L hits a bar of the same impedance Z at the speed v. The striker
stops, and a pulse with the force F = Z v/2 and the duration D = 2 L/c runs into the
bar. A spring of stiffness k between two equal bars represents the specimen. With a = 2
k/Z, and t from the arrival of the pulse,

    transmitted force while the pulse loads the spring: F (1 - exp(-a t)),
    reflected tension, at first F: F exp(-a t),
    reflected share of the energy: (1 - exp(-a D))/(a D).

After the pulse the energy of the spring goes into both bars, with forces proportional
to exp(-a t). All energy that is not reflected leaves through the absorbing end of the
transmitted bar. Forces, times and energies must agree with the exact solution to
round-off.

Measured pulses are records of the examples of HopPyBar. Their durations are measured at
half height. Titanium bars of 9.47 mm have E = 109.3 GPa, rho = 4416 kg/m^3, c = 4975
m/s and a striker of 127 mm. Aluminium bars of 2.11 mm square have E = 71.7 GPa, rho =
2810 kg/m^3, c = 5051 m/s, a striker of 25.4 mm, and a gauge 102.02 mm before the end.
Lateral inertia and imperfect contact, which this model does not contain, round these
pulses. With the bar speed of E and rho the agreement is 3 % for titanium. With the
calibrated wave speed, 4865.9 m/s, the agreement is 1 %. For aluminium the pulse length
and the delay agree to 1 %.

Source: K. F. Graff, Wave Motion in Elastic Solids, split Hopkinson bar; the spring by
hand; LANL HopPyBar (https://github.com/lanl/HopPyBar), examples LANLstandard/Cu and
mini-Kolsky/PMMA-13.
"""

import math
from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import rod

# Lengths, impedance, wave speed and speed of the striker are numbers without units.
STRIKER_LENGTH = 0.5
INCIDENT_LENGTH = 5.0
TRANSMITTED_LENGTH = 1.0
STIFFNESS = 1.5
PULSE_DURATION = 2 * STRIKER_LENGTH  # D = 2 L/c
RATE = 2 * STIFFNESS  # a = 2 k/Z
END = 11.0  # the reflected pulse is not yet back at the specimen
GRAFF = "Graff"
MEASURED = "measured, LANL HopPyBar"

# Measured bars: moduli in Pa, densities in kg/m^3, lengths in m.
TITANIUM_MODULUS = 109.3e9
TITANIUM_DENSITY = 4416.0
CALIBRATED_WAVE_SPEED = 4865.9  # wave speed of titanium, m/s
TITANIUM_STRIKER = 0.127
TITANIUM_GAUGE = 0.381  # distance from the end of the bar
ALUMINIUM_MODULUS = 71.7e9
ALUMINIUM_DENSITY = 2810.0
ALUMINIUM_STRIKER = 0.0254
ALUMINIUM_GAUGE = 0.10202
BY_HAND = "spring between bars, by hand"


def run() -> Rows:
    """Compare the closed form, a jump on a spring between bars, and measured pulses."""
    yield from bars_and_specimen()
    yield from endless_bars()
    yield from measured_pulses()


def pressure_bar() -> ri.System:
    """System of striker, incident bar, spring and endless transmitted bar.

    The striker moves at 1. Impedances and wave speeds are 1.
    """
    striker = rod(STRIKER_LENGTH, velocity=1.0)
    incident = rod(INCIDENT_LENGTH)
    transmitted = rod(TRANSMITTED_LENGTH)
    return ri.System(
        [striker, incident, transmitted],
        contacts=[ri.Rigid(), ri.Spring(STIFFNESS)],
        ends=(ri.Free(), ri.Absorbing()),
    )


def loading(t: np.ndarray) -> np.ndarray:
    """1 - exp(-a t) for t > 0, else 0."""
    return -np.expm1(-RATE * np.maximum(t, 0.0))


def specimen_force(t: np.ndarray) -> np.ndarray:
    """Force in the spring at times t: the pulse loads it, and then it unloads."""
    since_arrival = t - INCIDENT_LENGTH
    return (loading(since_arrival) - loading(since_arrival - PULSE_DURATION)) / 2


def reflected_share() -> float:
    """Share of the energy that is reflected: (1 - exp(-a D))/(a D)."""
    return -math.expm1(-RATE * PULSE_DURATION) / (RATE * PULSE_DURATION)


def bars_and_specimen() -> Rows:
    """Pulse, force in the spring, and shares of the energy in a Hopkinson bar, by hand.

    The spring is the specimen. What passes it is radiated through the transmitted bar;
    what remains is reflected.
    """
    solution = ri.solve(pressure_bar(), until=END)
    striker_contact = solution.contacts[0]
    spring = solution.contacts[1]
    pulse = first_pulse(solution.gauge(1, INCIDENT_LENGTH / 2))
    t = np.linspace(0.0, END, 2001)
    force_error = spring.force(t) - specimen_force(t)
    after_contact = INCIDENT_LENGTH  # a time: the wave speed is 1
    striker_velocity = solution.mean_velocity(0, after_contact)
    energy = solution.energy(END)
    kinetic_before = STRIKER_LENGTH / 2  # m v^2/2, the mass is the length
    transmitted_energy = energy.radiated / kinetic_before
    remaining_energy = energy.total / kinetic_before
    reflected = reflected_share()
    expected_transmitted = round(1 - reflected, 12)
    expected_reflected = round(reflected, 12)
    start = pulse.start
    duration = pulse.duration
    height = pulse.height
    residual = energy.residual
    case = Case("striker, incident bar, spring, transmitted bar", GRAFF)
    arrival = INCIDENT_LENGTH / 2
    yield case.row("pulse at the gauge begins", arrival, start, 1e-12)
    yield case.row("pulse length", PULSE_DURATION, duration, 1e-12, detail="2 L/c")
    yield case.row("pulse, force over Z", 0.5, height, 1e-12, detail="v/2")
    yield case.row(
        "time of contact with the striker",
        PULSE_DURATION,
        striker_contact.duration,
        1e-12,
        detail="2 L/c",
    )
    yield case.row("velocity of the striker after", 0.0, striker_velocity, 1e-12)
    yield case.zero(
        "force in the specimen, largest difference", force_error, 1e-10, source=BY_HAND
    )
    yield case.row(
        "share of the energy transmitted",
        expected_transmitted,
        transmitted_energy,
        1e-10,
        source=BY_HAND,
    )
    yield case.row(
        "share of the energy reflected",
        expected_reflected,
        remaining_energy,
        1e-10,
        source=BY_HAND,
    )
    yield case.row(
        "energy after - before + radiated",
        0.0,
        residual,
        1e-13,
        source="conserved",
    )


def endless_bars() -> Rows:
    """Force in a spring between endless bars; a constant wave of force 1 arrives."""
    left = rod(1.0, velocity=1.0, strain=-1.0)
    right = rod(1.0)
    spring = ri.Spring(STIFFNESS)
    endless = ri.Absorbing()
    system = ri.System([left, right], contacts=[spring], ends=(endless, endless))
    t = np.linspace(0.0, 4.0, 801)
    solution = ri.solve(system, until=4.0)
    contact = solution.contacts[0]
    error = contact.force(t) - loading(t)
    case = Case("spring between two endless bars", "by hand")
    yield case.zero("force - F (1 - exp(-2 k t/Z)), largest difference", error, 1e-10)


class Pulse(NamedTuple):
    """A pulse of compression, whose start and end are read off at half its height."""

    start: float  # s
    end: float  # s
    height: float  # c times the strain, m/s

    @property
    def duration(self) -> float:
        """Length of the pulse, s."""
        return self.end - self.start


def first_pulse(gauge: ri.Gauge) -> Pulse:
    """The compression that runs right past a gauge, from first to last half height.

    The half is that of the largest compression; this is the height of the pulse.
    """
    compression = -gauge.rightward
    height = compression.max()
    inside = np.flatnonzero(compression > height / 2)
    start = gauge.times[inside[0]]
    end = gauge.times[inside[-1] + 1]  # a value lasts until the next time
    return Pulse(float(start), float(end), float(height))


class Delays(NamedTuple):
    """Times that the gauge of a bar shows, us."""

    pulse_length: float
    reflection: float  # time from the start of the pulse to that of its reflection


def gauge_delays(material: ri.Material, striker_length: float, gauge: float) -> Delays:
    """Duration of a pulse, and delay of its reflection behind it, both in us.

    The gauge is `gauge` m from the free end of the bar, at which the pulse turns back.
    The reflection starts when it first exceeds half of its peak.
    """
    bar_length = 4 * gauge  # so long that both pulses pass the gauge one by one
    striker = ri.Rod(striker_length, area=1e-4, material=material, velocity=10.0)
    bar = ri.Rod(bar_length, area=1e-4, material=material)
    system = ri.System([striker, bar])
    solution = ri.solve(system)
    record = solution.gauge(1, bar_length - gauge)
    pulse = first_pulse(record)
    reflected = record.leftward
    inside = np.flatnonzero(reflected > reflected.max() / 2)
    reflection_start = float(record.times[inside[0]])
    return Delays(1e6 * pulse.duration, 1e6 * (reflection_start - pulse.start))


def measured_pulses() -> Rows:
    """Incident pulses, and the delay of the reflected one, in microseconds.

    Measured values are compared with runs of uniform bars, whose wave speed follows
    from E and rho or is calibrated.
    """
    density = TITANIUM_DENSITY
    titanium = ri.Material(
        "Ti-6Al-4V", youngs_modulus=TITANIUM_MODULUS, density=density
    )
    modulus = density * CALIBRATED_WAVE_SPEED**2
    calibrated = ri.Material(
        "Ti-6Al-4V, calibrated", youngs_modulus=modulus, density=density
    )
    aluminium = ri.Material(
        "Al 7075-T6", youngs_modulus=ALUMINIUM_MODULUS, density=ALUMINIUM_DENSITY
    )

    delays = gauge_delays(titanium, TITANIUM_STRIKER, TITANIUM_GAUGE)
    by_moduli = delays.pulse_length
    delays = gauge_delays(calibrated, TITANIUM_STRIKER, TITANIUM_GAUGE)
    by_wave_speed = delays.pulse_length
    from_moduli = "pulse length, us, from E and rho"
    from_wave_speed = "pulse length, us, from calibrated wave speed"
    case = Case("titanium bars, striker 127 mm", MEASURED)
    yield case.row(from_moduli, 52.64, by_moduli, 1.6)
    yield case.row(from_wave_speed, 52.64, by_wave_speed, 0.5)

    delays = gauge_delays(aluminium, ALUMINIUM_STRIKER, ALUMINIUM_GAUGE)
    pulse_length = delays.pulse_length
    reflection = delays.reflection
    case = Case("aluminium bars, striker 25.4 mm", MEASURED)
    yield case.row(from_moduli, 10.08, pulse_length, 0.05)
    yield case.row(
        "delay of the reflected pulse, us, from E and rho",
        40.14,
        reflection,
        0.3,
    )
