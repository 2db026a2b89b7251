"""Finite differences against the two other methods: the orders of their errors in the cell.

Twelve systems by "fronts", which is exact: the last case of two unequal rods with and without a
gap, stepped rods, a wall, rows of three and four, a bonded contact, initial strain, and two pairs
of stepped rods that meet again after they have parted. Errors of the centres' velocities, of the
impulses, and the mean of that of the velocity field over the rods at five times, at 100 to 1600
cells in the segment of the longest transit, half an octave apart, give an order each by least
squares. (In plain Python the cells end at 800.)

At a jump a grid of second order that loses no energy makes a wave train instead: its front grows
as cell^(2/3), the train behind it falls off slowly, and the field converges in the mean with about
half an order or more. Measured: 0.53 to 0.77 for the fields, the least where strain jumps at the
start; 0.74 to 1.11 for velocities and impulses. Single errors pass through zero here and there:
over whole octaves alone, one system of the twelve comes down to 0.60.

Where everything is smooth the order is 2: a pulse that passes a step of the impedance, of which
d'Alembert gives the whole field, and compliant ends, against "characteristics" at a relative
accuracy of 1e-9 and the method of steps of `sphere_on_wall`.

Source: `fronts`, itself proved on rationals (`rational_proof`); for the orders at jumps
P. Brenner, V. Thomée, L. B. Wahlbin, Besov Spaces and Applications to Difference Methods for
Initial Value Problems, Lecture Notes in Mathematics 434, Springer 1975.
"""

import math

import numpy as np

import rodimpact as ri
from rodimpact.methods import kernels

from .sphere_on_wall import method_of_steps
from .table import Case, Rows

FINEST = 16 if kernels.enabled() else 8  # plain Python takes too long for more
CELLS = tuple(round(100 * 2 ** (i / 2)) for i in range(2 * FINEST.bit_length() - 1))
SHOWN = 800  # cells in the segment of the longest transit, as all of these
SMOOTH = (100, 200, 400)
PLACES = 3000  # in each rod, at which fields are compared


def segment(Z: float, c: float, T: float) -> ri.Segment:
    """Of impedance, wave speed and transit time."""
    return ri.Segment(
        T * c, 1.0, ri.Material("unit", youngs_modulus=Z * c, density=Z / c)
    )


def rod(
    *segments: tuple[float, float, float],
    velocity: float = 0.0,
    strain: ri.Steps | float = 0.0,
) -> ri.Rod:
    """Segments of impedance, wave speed and transit time."""
    return ri.Rod(
        segments=[segment(*x) for x in segments], velocity=velocity, strain=strain
    )


def run() -> Rows:
    """Jumps, then what is smooth."""
    return jumps(), pulse(), compliant()


def systems() -> dict[str, ri.System]:
    """Twelve, of transit times that have no common step."""
    last = [rod((1, 1, 0.7), velocity=1.0), rod((0.5, 1.3, 1.1 / 1.3))]
    head = rod((1, 1, 0.5), (3, 1.2, 0.37), velocity=1.0)
    strained = rod((1, 1, 0.7), velocity=1.0, strain=ri.Steps([0.0, -0.3], [0.31]))
    return {
        "two rods that differ in everything": ri.System(last),
        "the same with a gap": ri.System(last, gaps=[0.0317]),
        "short rod of high impedance": ri.System(
            [rod((3, 1, 0.5), velocity=1.0), rod((1, 1.7, 1.37))]
        ),
        "stepped rod on uniform rod": ri.System([head, rod((2, 0.9, math.sqrt(2)))]),
        "uniform rod on rod of three segments": ri.System(
            [
                rod((1.5, 1.1, 0.61), velocity=1.0),
                rod((2, 1, 0.4), (0.7, 1.3, 0.53), (1.1, 0.8, 0.3)),
            ]
        ),
        "stepped rod on wall": ri.System([head, ri.Wall()], gaps=[0.2]),
        "three rods": ri.System(
            [rod((1, 1, 0.5), velocity=1.0), rod((2, 1.3, 0.8)), rod((0.7, 0.9, 0.6))],
            gaps=[0.0, 0.02],
        ),
        "four rods": ri.System(
            [
                rod((1, 1, 0.5), velocity=1.0),
                rod((1.5, 1, 0.7)),
                rod((2, 1, 0.3)),
                rod((0.8, 1, 0.45)),
            ],
            gaps=[0.01, 0.0, 0.03],
        ),
        "two rods bonded": ri.System(
            [rod((1, 1, 0.5), velocity=1.0), rod((1.5, 1, 0.7)), rod((2, 1.1, 0.3))],
            contacts=[ri.Rigid(), ri.Bonded()],
        ),
        "initial strain": ri.System([strained, rod((0.5, 1.3, 1.1))], gaps=[0.05]),
        "stepped rods that meet twice": ri.System(
            [
                rod((1.9, 1, 0.69), (0.9, 1.1, 0.28), velocity=1.0),
                rod((2, 1.2, 0.59), (0.3, 1.3, 0.29), (2.9, 1, 0.85)),
            ]
        ),
        "stepped rod that meets a uniform one twice": ri.System(
            [
                rod((1.1, 1.1, 0.29), (0.4, 0.9, 1.02), (1.7, 1, 0.18), velocity=1.0),
                rod((2.6, 0.9, 0.76)),
            ]
        ),
    }


def order(errors: np.ndarray | list[float], cells: tuple[int, ...]) -> float:
    """Of the error in the size of the cells, by least squares."""
    return -float(np.polyfit(np.log(cells), np.log(errors), 1)[0])


def jumps() -> Rows:
    """Errors at 800 cells, and their orders."""
    quantities = ("velocities after", "impulses", "velocity field in L1")
    for name, system in systems().items():
        case = Case(name, "fronts")
        free = ri.solve(system)
        end = 1.2 * max(
            x.force_end for contact in free.contacts for x in contact.episodes
        )
        exact = ri.solve(system, until=end)
        solutions = [on_grid(system, exact, N) for N in CELLS]
        presses = [
            float(sum(c.episodes for c in x.outcome.contacts))
            for x in (exact, solutions[-1])
        ]
        errors = np.array([error(system, exact, x) for x in solutions]).T
        yield case.row("contacts in all", *presses, 0.0)
        for quantity, off, bound in zip(
            quantities, errors, (1e-3, 1e-3, 1e-2), strict=True
        ):
            yield case.row(
                f"{quantity}, error with {SHOWN} cells",
                0.0,
                off[CELLS.index(SHOWN)],
                bound,
            )
        for quantity, off, (expected, bound) in zip(
            quantities, errors, ((1.0, 0.4), (1.0, 0.4), (0.7, 0.3)), strict=True
        ):
            yield case.at_least(
                f"{quantity}, order of the error", expected, order(off, CELLS), bound
            )


def on_grid(system: ri.System, exact: ri.Solution, N: int) -> ri.Solution:
    """The same by finite differences, with N cells and five states kept."""
    times = np.linspace(0.2, 1.0, 5) * exact.t_end
    return ri.solve(
        system, method="finite-difference", cells=N, until=exact.t_end, snapshots=times
    )


def error(
    system: ri.System, exact: ri.Solution, stepped: ri.Solution
) -> tuple[float, float, float]:
    """Largest of a velocity after, largest relative one of an impulse, L1 of the field."""
    o, e = stepped.outcome, exact.outcome
    velocity = float(np.abs(np.subtract(o.velocities_after, e.velocities_after)).max())
    impulse = max(
        abs(a.impulse / b.impulse - 1)
        for a, b in zip(o.contacts, e.contacts, strict=True)
        if b.episodes
    )
    times = np.linspace(0.2, 1.0, 5) * exact.t_end
    off = length = 0.0
    for i, body in enumerate(system.bodies):
        if isinstance(body, ri.Rod):
            x = (np.arange(PLACES)[:, None] + 0.5) / PLACES * float(body.length)
            apart = np.abs(stepped.velocity(i, x, times) - exact.velocity(i, x, times))
            off += float(apart.mean() * body.length)
            length += float(body.length)
    return velocity, impulse, off / length


def pulse() -> Rows:
    """A smooth pulse runs to the right, meets a step of the impedance, and is split."""
    case = Case("smooth pulse in a stepped rod", "d'Alembert")
    (Z1, c1, T1), (Z2, c2, T2) = (1.0, 1.0, 1.5), (3.0, 1.2, 1.9)
    x1, x2 = np.linspace(0.0, T1 * c1, 3001)[:-1], np.linspace(0.0, T2 * c2, 4001)
    times = np.array(
        [0.4, 0.8, 1.6]
    )  # of arrival at the step, while it is there, behind it

    def passing(delay: np.ndarray) -> np.ndarray:
        """Velocity of the pulse so long after its middle."""
        return np.exp(-((delay / 0.12) ** 2))

    places = np.linspace(0.0, T1 * c1 + T2 * c2, 40_001)
    start = passing(places / c1 - T1 + 0.8)
    system = ri.System(
        [
            ri.Rod(
                segments=[segment(Z1, c1, T1), segment(Z2, c2, T2)],
                velocity=ri.Samples(start),
                strain=ri.Samples(-start / c1),
            )
        ]
    )
    arriving, back = times - 0.8, (Z1 - Z2) / (Z1 + Z2)
    before, behind = T1 - x1[:, None] / c1, x2[:, None] / c2
    exact = np.concatenate(
        (
            passing(arriving + before) + back * passing(arriving - before),
            (1 + back) * passing(arriving - behind),
        )
    )
    x = np.concatenate((x1, T1 * c1 + x2))[:, None]
    errors = [
        float(
            np.abs(
                ri.solve(
                    system,
                    method="finite-difference",
                    cells=N,
                    until=1.7,
                    snapshots=times,
                ).velocity(0, x, times)
                - exact
            ).mean()
        )
        for N in CELLS
    ]
    yield case.row(
        f"velocity field in L1, error with {SHOWN} cells",
        0.0,
        errors[CELLS.index(SHOWN)],
        2e-5,
    )
    yield case.at_least(
        "velocity field in L1, order of the error", 2.0, order(errors, CELLS), 0.1
    )


def compliant() -> Rows:
    """Hertz ends and springs."""
    pair = [rod((1, 1, 0.7), velocity=1.0), rod((0.5, 1.3, 1.1 / 1.3))]
    halves = [rod((1, 1, 0.4), velocity=1.0), rod((1, 1, 1.0))]
    struck = [ri.RigidMass(1.0, velocity=1.0), halves[1]]
    hertz, spring = ri.Hertz(10.0), ri.Spring(3.0)
    steps, pieces = "method of steps", "characteristics"
    for case, bodies, law in (
        (Case("Hertz ends, rods 0.4 : 1", steps), halves, hertz),
        (Case("mass on rod with a Hertz end", steps), struck, hertz),
        (Case("Hertz ends, two rods that differ in everything", pieces), pair, hertz),
        (
            Case("spring between two rods that differ in everything", pieces),
            pair,
            spring,
        ),
    ):
        system = ri.System(bodies, contacts=[law])
        masses = [body.mass for body in bodies]
        if case.source == steps:
            rods = [
                (1.0, float(body.length)) for body in bodies if isinstance(body, ri.Rod)
            ]
            mass = math.inf if len(rods) == 2 else 1.0
            exact = method_of_steps(hertz.stiffness, 1.0, rods, mass, until=4.0).impulse
        else:
            exact = ri.solve(system, method=pieces, rtol=1e-9).outcome.impulse
        e = exact * (1 / masses[0] + 1 / masses[1]) - 1
        outcomes = [
            ri.solve(system, method="finite-difference", cells=N).outcome
            for N in SMOOTH
        ]
        for name, off in (
            ("e", [abs(o.restitution - e) for o in outcomes]),
            ("impulse", [abs(o.impulse / exact - 1) for o in outcomes]),
        ):
            yield case.row(f"{name}, error with {SMOOTH[-1]} cells", 0.0, off[-1], 2e-6)
            yield case.at_least(
                f"{name}, order of the error", 2.0, order(off, SMOOTH), 0.1
            )
