"""Finite differences against closed forms: gravity, masses, ends, a Hopkinson bar.

The cases of `doyen`, `mass_on_rod` and `hopkinson` are solved by the method
"finite-difference" with given cells. Quantities that begin or end with a jump have
errors of about one cell. When a rigid contact closes, the energy of the nodes that meet
is lost; this loss is proportional to the cell length. The energy balance still closes
to round-off, because this loss has its own entry.

Source: closed forms, as in these cases; a constant force F on a free rod of mass m
moves its centre by F t^2/(2 m), and a pulse that reaches an absorbing end leaves with
all its energy.
"""

import math

import numpy as np

import rodimpact as ri

from . import doyen, hopkinson, mass_on_rod
from .table import Case, Rows
from .unit import rod

METHOD = "finite-difference"
CELLS = (100, 200, 400)  # cells with which the loss at a contact is compared


def run() -> Rows:
    """Compare gravity, mass on rod, loss at contact, ends, Hopkinson bar."""
    yield from dropped_bar()
    for mass_ratio in mass_on_rod.FREE_MASSES:
        yield from struck_rod(mass_ratio)
    yield from loss_at_contact()
    yield from pushed_rod()
    yield from absorbed_pulse()
    yield from hopkinson_bar()


def dropped_bar() -> Rows:
    """Doyen's bar with gravity, one period: contacts, force, height and energy.

    The grid has 400 cells. The references are values by hand.
    """
    solution = ri.solve(
        doyen.falling_bar(),
        method=METHOD,
        until=doyen.PERIOD,
        cells=400,
        snapshots=50,
    )
    floor = solution.contacts[0]
    case = Case("Doyen et al., bar dropped on floor, 400 cells", doyen.SOURCE)
    contacts = len(floor.episodes)
    yield case.row("contacts", 2.0, contacts, 0.0)
    starts = (1.0, 11 / 3)
    for i, start in enumerate(starts):
        episode = floor.episodes[i]
        force_end = start + doyen.FORCE_DURATION
        impulse = floor.impulse_until(episode.force_end)
        impulse -= floor.impulse_until(episode.start)
        name = f"contact {i + 1}"
        yield case.row(f"{name} begins", start, episode.start, 5e-3)
        yield case.row(f"{name} ends", force_end, episode.force_end, 5e-3)
        yield case.row(f"{name}, impulse", doyen.IMPULSE, impulse, 0.8)

    impulse = floor.impulse_until(1.6) - floor.impulse_until(1.1)
    mean_force = impulse / 0.5
    expected = 300 + 300 * 0.35  # the ramp at 1.35, the middle of this time
    t = np.linspace(1.1, 1.6, 50)
    ramp = 300 + 300 * (t - 1)
    difference = floor.force(t) - ramp
    force_error = np.abs(difference).mean()
    height = floor.gap(doyen.PERIOD)
    residual = solution.energy(doyen.PERIOD).residual
    yield case.row(
        "mean force from 1.1 to 1.6", expected, mean_force, 1e-2, source="by hand"
    )
    yield case.row(
        "force, mean difference from the ramp",
        0.0,
        force_error,
        0.5,
        source="by hand",
    )
    yield case.row("height after the period", doyen.HEIGHT, height, 0.05)
    yield case.row(
        "energy after - before - work of gravity + losses",
        0.0,
        residual,
        1e-9,
        source="conserved",
    )


def struck_rod(mass_ratio: float) -> Rows:
    """e, impulse, contact time and energy of a mass that strikes a free rod.

    The grid has 400 cells. The reference is the closed form.
    """
    striker = ri.RigidMass(mass_ratio, velocity=1.0)
    system = ri.System([striker, mass_on_rod.ROD])
    outcome = ri.solve(system, method=METHOD, cells=400).outcome
    exact = mass_on_rod.exact_on_free_rod(mass_ratio)
    residual = outcome.energy_residual
    e = outcome.restitution
    impulse = outcome.impulse
    duration = outcome.duration
    name = f"mass on free rod, M/m = {mass_ratio:g}, 400 cells"
    case = Case(name, mass_on_rod.SOURCE)
    yield case.row("e", exact.restitution, e, 2e-3)
    yield case.row("impulse over m V", exact.impulse, impulse, 2e-3)
    yield case.row("contact time, L/c", 2.0, duration, 1e-2)
    yield case.row(
        "energy after - before + losses, relative",
        0.0,
        residual,
        1e-13,
        source="conserved",
    )


def loss_at_contact() -> Rows:
    """Energy that a rigid contact on a grid loses as it closes: share and order.

    The share is that of the kinetic energy before, on the finest grid. The loss falls
    as cells^-order.
    """
    first = rod(0.4, velocity=1.0)
    second = rod(1.0)
    system = ri.System([first, second])
    shares = []
    for cells in CELLS:
        outcome = ri.solve(system, method=METHOD, cells=cells).outcome
        shares.append(outcome.numerical / outcome.kinetic_before)
    ratio = shares[0] / shares[-1]
    # loss ~ cells^-order, and from 100 to 400 cells they double twice
    order = math.log2(ratio) / 2
    case = Case("rods 0.4 : 1", "none")
    yield case.row(
        "energy lost as the contact closes, share, 400 cells", 0.0, shares[-1], 5e-3
    )
    yield case.row(
        "order of this loss, cells 100 to 400", 1.0, order, 0.05, source="one cell"
    )


def pushed_rod() -> Rows:
    """Motion of a free rod whose left end a constant force pushes, beside F = m a.

    Velocity and position of the centre of mass, the displacement of the pushed end, and
    the balance of work and energy are compared.
    """
    times = np.array([0.5, 1.5, 3.7])
    ends = (ri.Pushed(1.0), ri.Free())
    system = ri.System([rod(1.0)], ends=ends)
    solution = ri.solve(system, method=METHOD, cells=200, until=3.8, snapshots=times)
    middles = (np.arange(400) + 0.5) / 400
    x = middles[:, None]
    velocity_error = solution.mean_velocity(0, times) - times  # F t/m = t
    displacement = solution.displacement(0, x, times)
    centre = displacement.mean(axis=0)
    centre_error = centre - times**2 / 2
    early = times[:2]  # before the wave is back at the pushed end, at t = 2
    end_error = solution.displacement(0, 0.0, early) - early  # F t/Z = t
    residual = solution.energy(3.8).residual
    case = Case("force of 1 on a free rod of mass 1, 200 cells", "Newton")
    yield case.zero(
        "velocity of the centre - F t/m, largest difference", velocity_error, 1e-7
    )
    yield case.zero(
        "place of the centre - F t^2/(2 m), largest difference", centre_error, 1e-4
    )
    yield case.zero(
        "displacement of the end that is pushed, largest difference",
        end_error,
        5e-3,
        source="F t/Z",
    )
    yield case.row("work - energy", 0.0, residual, 1e-12, source="conserved")


def absorbed_pulse() -> Rows:
    """Energies after a smooth pulse has run out of a bar through an absorbing end.

    They are the energy that is left, 0, the energy that was radiated, all of it, and
    the residual of the balance of energy, 0. All are shares of the energy before.
    """
    x = np.linspace(-0.5, 0.5, 4001)
    v = np.exp(-((x / 0.08) ** 2))
    velocity = ri.Samples(v)
    strain = ri.Samples(-v)  # -v/c, with c = 1: the pulse runs to the right
    bar = rod(1.0, velocity=velocity, strain=strain)
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([bar], ends=ends)
    solution = ri.solve(system, method=METHOD, cells=200, until=1.2, snapshots=4)
    energy = solution.energy([0.0, 1.2])
    before = float(energy.total[0])
    left = float(energy.total[1]) / before
    radiated = float(energy.radiated[1]) / before
    residual = float(energy.residual[1]) / before
    case = Case("smooth pulse and an absorbing end, 200 cells", "all leaves")
    yield case.row("energy left, share", 0.0, left, 1e-6)
    yield case.row("energy radiated, share", 1.0, radiated, 1e-6)
    yield case.row(
        "energy after - before + radiated, share",
        0.0,
        residual,
        1e-12,
        source="conserved",
    )


def hopkinson_bar() -> Rows:
    """Pulse, force and energies of a Hopkinson bar, 500 cells in the incident bar.

    The case is that of `hopkinson.pressure_bar`, on a grid; the references are the
    same.
    """
    end = hopkinson.END
    system = hopkinson.pressure_bar()
    solution = ri.solve(system, method=METHOD, cells=500, until=end)
    arrival = hopkinson.INCIDENT_LENGTH / 2
    gauge = solution.gauge(1, hopkinson.INCIDENT_LENGTH / 2)
    pulse = hopkinson.first_pulse(gauge)
    t = np.linspace(0.05, end - 0.05, 400)
    spring = solution.contacts[1]
    difference = spring.force(t) - hopkinson.specimen_force(t)
    force_error = np.abs(difference).mean()
    energy = solution.energy(end)
    kinetic_before = hopkinson.STRIKER_LENGTH / 2  # m v^2/2, the mass is the length
    transmitted_share = float(energy.radiated) / kinetic_before
    # What has not left through the transmitted bar was reflected.
    remaining_share = float(energy.total) / kinetic_before
    reflected = hopkinson.reflected_share()
    expected_transmitted = round(1 - reflected, 12)
    expected_reflected = round(reflected, 12)
    start = pulse.start
    duration = pulse.duration
    residual = energy.residual
    case = Case(
        "striker, incident bar, spring, transmitted bar, 500 cells",
        hopkinson.BY_HAND,
    )
    yield case.row(
        "pulse at the gauge begins",
        arrival,
        start,
        0.02,
        source=hopkinson.GRAFF,
    )
    yield case.row(
        "pulse length",
        hopkinson.PULSE_DURATION,
        duration,
        0.02,
        source=hopkinson.GRAFF,
        detail="2 L/c",
    )
    yield case.row("force in the specimen, mean difference", 0.0, force_error, 2e-3)
    yield case.row(
        "share of the energy transmitted",
        expected_transmitted,
        transmitted_share,
        0.01,
    )
    yield case.row(
        "share of the energy reflected", expected_reflected, remaining_share, 0.01
    )
    yield case.row(
        "energy after - before + radiated + losses",
        0.0,
        residual,
        1e-12,
        source="conserved",
    )
