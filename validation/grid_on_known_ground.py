"""Finite differences where the answer is known: gravity, masses, ends, a Hopkinson bar.

The same cases as in `doyen`, `mass_on_rod` and `hopkinson`, by the method "finite-difference" with
given cells. What begins or ends with a jump is right to about a cell; a rigid contact loses, as it
closes, the energy of the nodes that meet, which halves with the cells. The energy ledger closes to
round-off all the same, for that loss has its entry.

Source: closed forms, as there; a constant force F on a free rod of mass m moves its centre by
F t^2/(2 m), and a pulse that reaches an absorbing end leaves with all its energy.
"""

from __future__ import annotations

import math

import numpy as np

import rodimpact as ri

from . import hopkinson, mass_on_rod
from .doyen import MATERIAL, PERIOD
from .doyen import SOURCE as DOYEN
from .table import Row

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)  # impedance = area, transit = length
METHOD = "finite-difference"


def run() -> list[Row]:
    """Gravity, mass on rod, loss at contact, ends, Hopkinson bar."""
    return dropped() + struck() + loss() + pushed() + absorbed() + specimen()


def bar(length: float, **moving: ri.Samples | float) -> ri.Rod:
    """A bar of impedance and wave speed 1."""
    return ri.Rod(length, area=1.0, material=UNIT, **moving)


def dropped() -> list[Row]:
    """Doyen's bar with gravity, one period."""
    case = "Doyen et al., bar dropped on floor, 400 cells"
    rod = ri.Rod(10.0, area=1.0, material=MATERIAL)
    row = ri.System([ri.Wall(), rod], gaps=[5.0], gravity=-10.0)
    solution = ri.solve(row, method=METHOD, until=PERIOD, cells=400, snapshots=50)
    floor, book = solution.contacts[0], solution.energy(PERIOD)
    rows = [Row(case, "contacts", DOYEN, 2.0, float(len(floor.episodes)), 0.0)]
    for i, (episode, start) in enumerate(zip(floor.episodes, (1.0, 11 / 3), strict=True)):
        handed = floor.impulse_until(episode.force_end) - floor.impulse_until(episode.start)
        rows += [
            Row(case, f"contact {i + 1} begins", DOYEN, start, episode.start, 5e-3),
            Row(case, f"contact {i + 1} ends", DOYEN, start + 2 / 3, episode.force_end, 5e-3),
            Row(case, f"contact {i + 1}, impulse", DOYEN, 800 / 3, float(handed), 0.8),
        ]
    t = np.linspace(1.1, 1.6, 50)
    mean = (floor.impulse_until(1.6) - floor.impulse_until(1.1)) / 0.5
    return [
        *rows,
        Row(case, "mean force from 1.1 to 1.6", "by hand", 300 + 300 * 0.35, float(mean), 1e-2),
        Row(case, "force, mean difference from the ramp", "by hand", 0.0,
            float(np.abs(floor.force(t) - (300 + 300 * (t - 1))).mean()), 0.5),
        Row(case, "height after the period", DOYEN, 5.0, float(floor.gap(PERIOD)), 0.05),
        Row(case, "energy after - before - work of gravity + losses", "conserved", 0.0,
            float(book.residual), 1e-9),
    ]


def struck() -> list[Row]:
    """A rigid mass on a free rod, 400 cells."""
    rows = []
    for ratio in (0.25, 1.0, 4.0):
        row = ri.System([ri.RigidMass(ratio, velocity=1.0), mass_on_rod.ROD])
        o = ri.solve(row, method=METHOD, cells=400).outcome
        e, impulse = mass_on_rod.exact(ratio)
        case = f"mass on free rod, M/m = {ratio:g}, 400 cells"
        rows += [
            Row(case, "e", mass_on_rod.SOURCE, e, o.restitution, 2e-3),
            Row(case, "impulse over m V", mass_on_rod.SOURCE, impulse, o.impulse, 2e-3),
            Row(case, "contact time, L/c", mass_on_rod.SOURCE, 2.0, o.duration, 1e-2),
            Row(case, "energy after - before + losses, relative", "conserved", 0.0,
                o.energy_residual, 1e-13),
        ]
    return rows


def loss() -> list[Row]:
    """What a rigid contact loses as it closes."""
    row = ri.System([bar(0.4, velocity=1.0), bar(1.0)])
    lost = [ri.solve(row, method=METHOD, cells=N).outcome for N in (100, 200, 400)]
    shares = [o.numerical / o.kinetic_before for o in lost]
    case = "rods 0.4 : 1"
    return [
        Row(case, "energy lost as the contact closes, share, 400 cells", "none", 0.0, shares[-1],
            5e-3),
        Row(case, "order of this loss, cells 100 to 400", "one cell", 1.0,
            math.log2(shares[0] / shares[-1]) / 2, 0.05),
    ]


def pushed() -> list[Row]:
    """A constant force on the left end of a free rod, 200 cells."""
    case = "force of 1 on a free rod of mass 1, 200 cells"
    times = np.array([0.5, 1.5, 3.7])
    row = ri.System([bar(1.0)], ends=(ri.Pushed(1.0), ri.Free()))
    solution = ri.solve(row, method=METHOD, cells=200, until=3.8, snapshots=times)
    book = solution.energy(3.8)
    x = ((np.arange(400) + 0.5) / 400)[:, None]
    centre = solution.displacement(0, x, times).mean(axis=0)
    end = solution.displacement(0, 0.0, times[:2])
    return [
        Row(case, "velocity of the centre - F t/m, largest difference", "Newton", 0.0,
            float(np.abs(solution.mean_velocity(0, times) - times).max()), 1e-7),
        Row(case, "place of the centre - F t^2/(2 m), largest difference", "Newton", 0.0,
            float(np.abs(centre - times**2 / 2).max()), 1e-4),
        Row(case, "displacement of the end that is pushed, largest difference", "F t/Z", 0.0,
            float(np.abs(end - times[:2]).max()), 5e-3),
        Row(case, "work - energy", "conserved", 0.0, float(book.residual), 1e-12),
    ]


def absorbed() -> list[Row]:
    """A smooth pulse runs out of a bar, 200 cells."""
    case = "smooth pulse and an absorbing end, 200 cells"
    v = np.exp(-((np.linspace(-0.5, 0.5, 4001) / 0.08) ** 2))
    rod = bar(1.0, velocity=ri.Samples(v), strain=ri.Samples(-v))
    row = ri.System([rod], ends=(ri.Free(), ri.Absorbing()))
    book = ri.solve(row, method=METHOD, cells=200, until=1.2, snapshots=4).energy([0.0, 1.2])
    before = float(book.total[0])
    return [
        Row(case, "energy left, share", "all leaves", 0.0, float(book.total[1]) / before, 1e-6),
        Row(case, "energy radiated, share", "all leaves", 1.0, float(book.radiated[1]) / before,
            1e-6),
        Row(case, "energy after - before + radiated, share", "conserved", 0.0,
            float(book.residual[1]) / before, 1e-12),
    ]


def specimen() -> list[Row]:
    """Striker, incident bar, spring, transmitted bar; 500 cells in the incident bar."""
    case = "striker, incident bar, spring, transmitted bar, 500 cells"
    row = ri.System(
        [bar(hopkinson.STRIKER, velocity=1.0), bar(hopkinson.INCIDENT), bar(hopkinson.TRANSMITTED)],
        contacts=[ri.Rigid(), ri.Spring(hopkinson.STIFFNESS)], ends=(ri.Free(), ri.Absorbing()),
    )
    solution = ri.solve(row, method=METHOD, cells=500, until=hopkinson.END)
    begins, ends, _ = hopkinson.pulse(solution.gauge(1, hopkinson.INCIDENT / 2))
    t = np.linspace(0.05, hopkinson.END - 0.05, 400)
    late = t - hopkinson.INCIDENT
    rising, falling = (1 - np.exp(-hopkinson.RATE * np.maximum(s, 0.0))
                       for s in (late, late - hopkinson.PULSE))
    force = solution.contacts[1].force(t)
    energy, started = solution.energy(hopkinson.END), hopkinson.STRIKER / 2
    reflected = -math.expm1(-hopkinson.RATE * hopkinson.PULSE) / (hopkinson.RATE * hopkinson.PULSE)
    return [
        Row(case, "pulse at the gauge begins", hopkinson.GRAFF, hopkinson.INCIDENT / 2, begins,
            0.02),
        Row(case, "pulse length", f"{hopkinson.GRAFF}: 2 L/c", hopkinson.PULSE, ends - begins,
            0.02),
        Row(case, "force in the specimen, mean difference", "spring between bars, by hand", 0.0,
            float(np.abs(force - (rising - falling) / 2).mean()), 2e-3),
        Row(case, "share of the energy transmitted", "spring between bars, by hand",
            round(1 - reflected, 12), float(energy.radiated) / started, 0.01),
        Row(case, "share of the energy reflected", "spring between bars, by hand",
            round(reflected, 12), float(energy.total) / started, 0.01),
        Row(case, "energy after - before + radiated + losses", "conserved", 0.0,
            float(energy.residual), 1e-12),
    ]
