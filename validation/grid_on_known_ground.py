"""Finite differences where the answer is known: gravity, masses, ends, a Hopkinson bar.

The same cases as in `doyen`, `mass_on_rod` and `hopkinson`, by the method "finite-difference" with
given cells. What begins or ends with a jump is right to about a cell; a rigid contact loses, as it
closes, the energy of the nodes that meet, which halves with the cells. The energy ledger closes to
round-off all the same, for that loss has its entry.

Source: closed forms, as there; a constant force F on a free rod of mass m moves its centre by
F t^2/(2 m), and a pulse that reaches an absorbing end leaves with all its energy.
"""

import math

import numpy as np

import rodimpact as ri

from . import hopkinson, mass_on_rod
from .doyen import MATERIAL, PERIOD
from .doyen import SOURCE as DOYEN
from .table import Case, Rows
from .unit import rod

METHOD = "finite-difference"


def run() -> Rows:
    """Gravity, mass on rod, loss at contact, ends, Hopkinson bar."""
    return dropped(), struck(), loss(), pushed(), absorbed(), specimen()


def dropped() -> Rows:
    """Doyen's bar with gravity, one period."""
    case = Case("Doyen et al., bar dropped on floor, 400 cells", DOYEN)
    falling = ri.Rod(10.0, area=1.0, material=MATERIAL)
    row = ri.System([ri.Wall(), falling], gaps=[5.0], gravity=-10.0)
    solution = ri.solve(row, method=METHOD, until=PERIOD, cells=400, snapshots=50)
    floor, book = solution.contacts[0], solution.energy(PERIOD)
    yield case.row("contacts", 2.0, len(floor.episodes), 0.0)
    for i, (episode, start) in enumerate(
        zip(floor.episodes, (1.0, 11 / 3), strict=True)
    ):
        handed = floor.impulse_until(episode.force_end) - floor.impulse_until(
            episode.start
        )
        yield case.row(f"contact {i + 1} begins", start, episode.start, 5e-3)
        yield case.row(f"contact {i + 1} ends", start + 2 / 3, episode.force_end, 5e-3)
        yield case.row(f"contact {i + 1}, impulse", 800 / 3, handed, 0.8)
    t = np.linspace(1.1, 1.6, 50)
    mean = (floor.impulse_until(1.6) - floor.impulse_until(1.1)) / 0.5
    yield case.row(
        "mean force from 1.1 to 1.6", 300 + 300 * 0.35, mean, 1e-2, "by hand"
    )
    yield case.row(
        "force, mean difference from the ramp",
        0.0,
        np.abs(floor.force(t) - (300 + 300 * (t - 1))).mean(),
        0.5,
        "by hand",
    )
    yield case.row("height after the period", 5.0, floor.gap(PERIOD), 0.05)
    yield case.row(
        "energy after - before - work of gravity + losses",
        0.0,
        book.residual,
        1e-9,
        "conserved",
    )


def struck() -> Rows:
    """A rigid mass on a free rod, 400 cells."""
    for ratio in (0.25, 1.0, 4.0):
        row = ri.System([ri.RigidMass(ratio, velocity=1.0), mass_on_rod.ROD])
        o = ri.solve(row, method=METHOD, cells=400).outcome
        e, impulse = mass_on_rod.exact(ratio)
        case = Case(f"mass on free rod, M/m = {ratio:g}, 400 cells", mass_on_rod.SOURCE)
        yield case.row("e", e, o.restitution, 2e-3)
        yield case.row("impulse over m V", impulse, o.impulse, 2e-3)
        yield case.row("contact time, L/c", 2.0, o.duration, 1e-2)
        yield case.row(
            "energy after - before + losses, relative",
            0.0,
            o.energy_residual,
            1e-13,
            "conserved",
        )


def loss() -> Rows:
    """What a rigid contact loses as it closes."""
    row = ri.System([rod(0.4, velocity=1.0), rod(1.0)])
    lost = [ri.solve(row, method=METHOD, cells=N).outcome for N in (100, 200, 400)]
    shares = [o.numerical / o.kinetic_before for o in lost]
    case = Case("rods 0.4 : 1", "none")
    yield case.row(
        "energy lost as the contact closes, share, 400 cells", 0.0, shares[-1], 5e-3
    )
    yield case.row(
        "order of this loss, cells 100 to 400",
        1.0,
        math.log2(shares[0] / shares[-1]) / 2,
        0.05,
        "one cell",
    )


def pushed() -> Rows:
    """A constant force on the left end of a free rod, 200 cells."""
    case = Case("force of 1 on a free rod of mass 1, 200 cells", "Newton")
    times = np.array([0.5, 1.5, 3.7])
    row = ri.System([rod(1.0)], ends=(ri.Pushed(1.0), ri.Free()))
    solution = ri.solve(row, method=METHOD, cells=200, until=3.8, snapshots=times)
    book = solution.energy(3.8)
    x = ((np.arange(400) + 0.5) / 400)[:, None]
    centre = solution.displacement(0, x, times).mean(axis=0)
    end = solution.displacement(0, 0.0, times[:2])
    yield case.zero(
        "velocity of the centre - F t/m, largest difference",
        solution.mean_velocity(0, times) - times,
        1e-7,
    )
    yield case.zero(
        "place of the centre - F t^2/(2 m), largest difference",
        centre - times**2 / 2,
        1e-4,
    )
    yield case.zero(
        "displacement of the end that is pushed, largest difference",
        end - times[:2],
        5e-3,
        "F t/Z",
    )
    yield case.row("work - energy", 0.0, book.residual, 1e-12, "conserved")


def absorbed() -> Rows:
    """A smooth pulse runs out of a bar, 200 cells."""
    case = Case("smooth pulse and an absorbing end, 200 cells", "all leaves")
    v = np.exp(-((np.linspace(-0.5, 0.5, 4001) / 0.08) ** 2))
    moving = rod(1.0, velocity=ri.Samples(v), strain=ri.Samples(-v))
    row = ri.System([moving], ends=(ri.Free(), ri.Absorbing()))
    book = ri.solve(row, method=METHOD, cells=200, until=1.2, snapshots=4).energy(
        [0.0, 1.2]
    )
    before = float(book.total[0])
    yield case.row("energy left, share", 0.0, float(book.total[1]) / before, 1e-6)
    yield case.row(
        "energy radiated, share", 1.0, float(book.radiated[1]) / before, 1e-6
    )
    yield case.row(
        "energy after - before + radiated, share",
        0.0,
        float(book.residual[1]) / before,
        1e-12,
        "conserved",
    )


def specimen() -> Rows:
    """Striker, incident bar, spring, transmitted bar; 500 cells in the incident bar."""
    case = Case(
        "striker, incident bar, spring, transmitted bar, 500 cells",
        "spring between bars, by hand",
    )
    row = ri.System(
        [
            rod(hopkinson.STRIKER, velocity=1.0),
            rod(hopkinson.INCIDENT),
            rod(hopkinson.TRANSMITTED),
        ],
        contacts=[ri.Rigid(), ri.Spring(hopkinson.STIFFNESS)],
        ends=(ri.Free(), ri.Absorbing()),
    )
    solution = ri.solve(row, method=METHOD, cells=500, until=hopkinson.END)
    begins, ends, _ = hopkinson.pulse(solution.gauge(1, hopkinson.INCIDENT / 2))
    t = np.linspace(0.05, hopkinson.END - 0.05, 400)
    late = t - hopkinson.INCIDENT
    rising, falling = (
        1 - np.exp(-hopkinson.RATE * np.maximum(s, 0.0))
        for s in (late, late - hopkinson.PULSE)
    )
    force = solution.contacts[1].force(t)
    energy, started = solution.energy(hopkinson.END), hopkinson.STRIKER / 2
    reflected = -math.expm1(-hopkinson.RATE * hopkinson.PULSE) / (
        hopkinson.RATE * hopkinson.PULSE
    )
    yield case.row(
        "pulse at the gauge begins",
        hopkinson.INCIDENT / 2,
        begins,
        0.02,
        hopkinson.GRAFF,
    )
    yield case.row(
        "pulse length",
        hopkinson.PULSE,
        ends - begins,
        0.02,
        f"{hopkinson.GRAFF}: 2 L/c",
    )
    yield case.row(
        "force in the specimen, mean difference",
        0.0,
        np.abs(force - (rising - falling) / 2).mean(),
        2e-3,
    )
    yield case.row(
        "share of the energy transmitted",
        round(1 - reflected, 12),
        float(energy.radiated) / started,
        0.01,
    )
    yield case.row(
        "share of the energy reflected",
        round(reflected, 12),
        float(energy.total) / started,
        0.01,
    )
    yield case.row(
        "energy after - before + radiated + losses",
        0.0,
        energy.residual,
        1e-12,
        "conserved",
    )
