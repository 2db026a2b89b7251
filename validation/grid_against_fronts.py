"""Finite differences against the two other methods: the orders of their errors.

Twelve systems are solved by "fronts", which is exact: two different rods with and
without a gap, stepped rods, a wall, rows of three and four rods, a bonded contact,
initial strain, and two pairs of stepped rods that touch again. The velocities of the
centres of mass, the impulses and the velocity fields are compared. The error of a field
is its mean over the rods at five times. The grids have 100 to 1600 cells in the segment
with the longest transit time, and the number of cells grows by half an octave. In plain
Python the largest number is 800. The order of each error is found by least squares.

A grid of second order without energy loss turns a jump into a wave train. The width of
its front is proportional to h^(2/3), with the cell length h. The train behind the front
decreases slowly, and the mean error of the field is of order one half or more. The
measured orders are 0.53 to 0.77 for fields, smallest for initial strain with jumps, and
0.74 to 1.11 for velocities and impulses. Single errors change their sign: with whole
octaves only, one of the twelve systems has the order 0.60.

For smooth waves the order is 2. One system is a pulse that passes a step of the
impedance, with the field of d'Alembert. The others have compliant ends, and are
compared with "characteristics" at a relative accuracy of 1e-9 and with the method of
steps of `sphere_on_wall`.

Source: `fronts`, which is proved on fractions (`rational_proof`); for the orders at
jumps P. Brenner, V. Thomée, L. B. Wahlbin, Besov Spaces and Applications to Difference
Methods for Initial Value Problems, Lecture Notes in Mathematics 434, Springer 1975.
"""

import math
from typing import NamedTuple

import numpy as np

import rodimpact as ri
from rodimpact.methods import kernels

from .sphere_on_wall import StruckRod, method_of_steps
from .table import Case, Rows, largest_magnitude

METHOD = "finite-difference"


def half_octaves(finest: int) -> tuple[int, ...]:
    """Cells in the segment of the longest transit, from 100 to 100 `finest`.

    They are half an octave apart: 100, 141, 200 and so on. `finest` is a power of 2.
    """
    cells = []
    # 16 = 2^4 has 5 binary digits: 4 octaves, 9 numbers with both ends.
    for i in range(2 * finest.bit_length() - 1):
        cells.append(round(100 * 2 ** (i / 2)))
    return tuple(cells)


CELLS = half_octaves(16)
if not kernels.enabled():
    CELLS = half_octaves(8)  # plain Python takes too long for more
SHOWN_CELLS = 800  # cells with which errors are shown
SMOOTH_CELLS = (100, 200, 400)  # cells for systems in which everything is smooth
PLACES = 3000  # places in each rod at which fields are compared
STIFFNESS = 10.0  # stiffness of a Hertz contact


def run() -> Rows:
    """Compare jumps, then systems in which everything is smooth."""
    for name, system in systems_with_jumps().items():
        yield from jumps(name, system)
    yield from pulse()
    yield from compliant()


def segment(Z: float, c: float, T: float) -> ri.Segment:
    """A segment of impedance, wave speed and transit time; its area is 1."""
    material = ri.Material("unit", youngs_modulus=Z * c, density=Z / c)
    return ri.Segment(T * c, 1.0, material)


def rod(
    *segments: ri.Segment, velocity: float = 0.0, strain: ri.Steps | float = 0.0
) -> ri.Rod:
    """A rod of one or more segments."""
    return ri.Rod(segments=segments, velocity=velocity, strain=strain)


def different_rods() -> list[ri.Rod]:
    """Two rods that differ in length, area and material."""
    first = rod(segment(1, 1, 0.7), velocity=1.0)
    second = rod(segment(0.5, 1.3, 1.1 / 1.3))
    return [first, second]


def short_rod(velocity: float = 0.0) -> ri.Rod:
    """The first rod of several rows."""
    return rod(segment(1, 1, 0.5), velocity=velocity)


def stepped_rod() -> ri.Rod:
    """A striker of two segments."""
    return rod(segment(1, 1, 0.5), segment(3, 1.2, 0.37), velocity=1.0)


def pairs() -> dict[str, ri.System]:
    """Six systems by name: pairs of rods, with and without a gap, and a rod and a wall.

    No common step of time divides their transit times.
    """
    heavy = rod(segment(3, 1, 0.5), velocity=1.0)
    light = rod(segment(1, 1.7, 1.37))
    uniform = rod(segment(2, 0.9, math.sqrt(2)))
    striker = rod(segment(1.5, 1.1, 0.61), velocity=1.0)
    three_segments = rod(
        segment(2, 1, 0.4),
        segment(0.7, 1.3, 0.53),
        segment(1.1, 0.8, 0.3),
    )
    return {
        "two rods that differ in everything": ri.System(different_rods()),
        "the same with a gap": ri.System(different_rods(), gaps=[0.0317]),
        "short rod of high impedance": ri.System([heavy, light]),
        "stepped rod on uniform rod": ri.System([stepped_rod(), uniform]),
        "uniform rod on rod of three segments": ri.System([striker, three_segments]),
        "stepped rod on wall": ri.System([stepped_rod(), ri.Wall()], gaps=[0.2]),
    }


def longer_rows() -> dict[str, ri.System]:
    """Two rows of three rods and one of four, by name.

    The second row of three has a bonded contact; the others have gaps.
    """
    moving = short_rod(velocity=1.0)
    second = rod(segment(2, 1.3, 0.8))
    third = rod(segment(0.7, 0.9, 0.6))
    three = ri.System([moving, second, third], gaps=[0.0, 0.02])

    second = rod(segment(1.5, 1, 0.7))
    third = rod(segment(2, 1, 0.3))
    fourth = rod(segment(0.8, 1, 0.45))
    four = ri.System([moving, second, third, fourth], gaps=[0.01, 0.0, 0.03])

    third = rod(segment(2, 1.1, 0.3))
    contacts = [ri.Rigid(), ri.Bonded()]
    bonded = ri.System([moving, second, third], contacts=contacts)
    return {"three rods": three, "four rods": four, "two rods bonded": bonded}


def strained_rods() -> ri.System:
    """A rod with a jump of its initial strain meets a uniform rod."""
    strain = ri.Steps([0.0, -0.3], [0.31])
    strained = rod(segment(1, 1, 0.7), velocity=1.0, strain=strain)
    uniform = rod(segment(0.5, 1.3, 1.1))
    return ri.System([strained, uniform], gaps=[0.05])


def meeting_twice() -> dict[str, ri.System]:
    """Pairs of rods, by name, that meet again after they have parted.

    The left rod is stepped and moves at 1, the right one rests.
    """
    first = rod(segment(1.9, 1, 0.69), segment(0.9, 1.1, 0.28), velocity=1.0)
    second = rod(segment(2, 1.2, 0.59), segment(0.3, 1.3, 0.29), segment(2.9, 1, 0.85))
    stepped = rod(
        segment(1.1, 1.1, 0.29),
        segment(0.4, 0.9, 1.02),
        segment(1.7, 1, 0.18),
        velocity=1.0,
    )
    uniform = rod(segment(2.6, 0.9, 0.76))
    return {
        "stepped rods that meet twice": ri.System([first, second]),
        "stepped rod that meets a uniform one twice": ri.System([stepped, uniform]),
    }


def systems_with_jumps() -> dict[str, ri.System]:
    """Twelve systems of rods by name; their waves jump."""
    systems = pairs()
    systems.update(longer_rows())
    systems["initial strain"] = strained_rods()
    systems.update(meeting_twice())
    return systems


def order(errors: np.ndarray | list[float], cells: tuple[int, ...]) -> float:
    """Order of the error in the size of the cells, by least squares.

    The error falls as cells^-order.
    """
    x = np.log(cells)
    y = np.log(errors)
    slope, _ = np.polyfit(x, y, 1)
    return -float(slope)


def contacts_in_all(solution: ri.Solution) -> float:
    """Number of episodes of all contacts of a run."""
    counts = [tally.episodes for tally in solution.outcome.contacts]
    return float(sum(counts))


def last_force(solution: ri.Solution) -> float:
    """Time at which the last force of all contacts ends."""
    ends = []
    for contact in solution.contacts:
        for episode in contact.episodes:
            ends.append(episode.force_end)
    return max(ends)


class Errors(NamedTuple):
    """Errors of a run on a grid."""

    velocity: float  # largest absolute error of a velocity after, m/s
    impulse: float  # largest relative error of an impulse
    field: float  # mean absolute error of the velocity over rods and times, m/s


def jumps(name: str, system: ri.System) -> Rows:
    """Number of contacts on the finest grid, errors at 800 cells, and their orders.

    The reference is the run by fronts, which lasts a fifth longer than the force.
    """
    until = 1.2 * last_force(ri.solve(system))
    exact = ri.solve(system, until=until)
    errors = []
    for cells in CELLS:
        stepped = on_grid(system, exact, cells)
        errors.append(errors_of(system, exact, stepped))
    shown = errors[CELLS.index(SHOWN_CELLS)]
    velocities = [error.velocity for error in errors]
    impulses = [error.impulse for error in errors]
    fields = [error.field for error in errors]
    velocity = shown.velocity
    impulse = shown.impulse
    field = shown.field
    case = Case(name, "fronts")
    exact_contacts = contacts_in_all(exact)
    contacts = contacts_in_all(stepped)  # the last run, on the finest grid
    yield case.row("contacts in all", exact_contacts, contacts, 0.0)

    shown_error = f"error with {SHOWN_CELLS} cells"
    yield case.row(f"velocities after, {shown_error}", 0.0, velocity, 1e-3)
    yield case.row(f"impulses, {shown_error}", 0.0, impulse, 1e-3)
    yield case.row(f"velocity field in L1, {shown_error}", 0.0, field, 1e-2)

    velocity_order = order(velocities, CELLS)
    impulse_order = order(impulses, CELLS)
    field_order = order(fields, CELLS)
    order_of = "order of the error"
    yield case.at_least(f"velocities after, {order_of}", 1.0, velocity_order, 0.4)
    yield case.at_least(f"impulses, {order_of}", 1.0, impulse_order, 0.4)
    yield case.at_least(f"velocity field in L1, {order_of}", 0.7, field_order, 0.3)


def compared_times(exact: ri.Solution) -> np.ndarray:
    """Five times at which fields are compared."""
    return np.linspace(0.2, 1.0, 5) * exact.t_end


def on_grid(system: ri.System, exact: ri.Solution, cells: int) -> ri.Solution:
    """The run `exact` of a system by finite differences, until the same end.

    States are stored at the `compared_times`.
    """
    return ri.solve(
        system,
        method=METHOD,
        cells=cells,
        until=exact.t_end,
        snapshots=compared_times(exact),
    )


def errors_of(system: ri.System, exact: ri.Solution, stepped: ri.Solution) -> Errors:
    """Errors of a run on a grid, in which at least one contact presses.

    They are the largest error of a velocity afterwards, the largest relative error of
    an impulse of the contacts that press in `exact`, and the `field_error`.
    """
    velocities = stepped.outcome.velocities_after
    exact_velocities = exact.outcome.velocities_after
    velocity = largest_magnitude(np.subtract(velocities, exact_velocities))
    impulse_errors = []
    contacts = zip(stepped.outcome.contacts, exact.outcome.contacts, strict=True)
    for computed, expected in contacts:
        if expected.episodes:
            ratio = computed.impulse / expected.impulse
            impulse_errors.append(abs(ratio - 1))
    field = field_error(system, exact, stepped)
    return Errors(velocity, max(impulse_errors), field)


def field_error(system: ri.System, exact: ri.Solution, stepped: ri.Solution) -> float:
    """Mean absolute error of the velocity over the compared times and all rods.

    Rods count by their lengths; other bodies are left out.
    """
    times = compared_times(exact)
    places = np.arange(PLACES)[:, None]
    shares = (places + 0.5) / PLACES
    integral = 0.0
    length = 0.0
    for i, body in enumerate(system.bodies):
        if not isinstance(body, ri.Rod):
            continue
        x = shares * float(body.length)
        velocity = stepped.velocity(i, x, times)
        exact_velocity = exact.velocity(i, x, times)
        difference = np.abs(velocity - exact_velocity)
        integral += float(difference.mean() * body.length)
        length += float(body.length)
    return integral / length


PULSE_WIDTH = 0.12  # time in which the pulse falls to 1/e of its height
PULSE_DISTANCE = 0.8  # time at which the middle of the pulse is at the step


def pulse_velocity(delay: np.ndarray) -> np.ndarray:
    """Velocity of the pulse at a time after its middle has passed."""
    return np.exp(-((delay / PULSE_WIDTH) ** 2))


def pulse() -> Rows:
    """A smooth pulse runs to the right, meets a step of the impedance, and is split.

    By d'Alembert the step sends back (Z1 - Z2)/(Z1 + Z2) of its velocity.
    """
    Z1 = 1.0
    c1 = 1.0
    T1 = 1.5
    Z2 = 3.0
    c2 = 1.2
    T2 = 1.9
    step = T1 * c1
    places = np.linspace(0.0, step + T2 * c2, 40_001)
    # At t = 0; the pulse is symmetric, so the sign of the delay does not matter.
    start = pulse_velocity(places / c1 - T1 + PULSE_DISTANCE)
    first = segment(Z1, c1, T1)
    second = segment(Z2, c2, T2)
    stepped_rod = ri.Rod(
        segments=[first, second],
        velocity=ri.Samples(start),
        strain=ri.Samples(-start / c1),
    )
    system = ri.System([stepped_rod])

    # The pulse has arrived at the step at none, at half and at all of these times.
    times = np.array([0.4, 0.8, 1.6])
    x1 = np.linspace(0.0, step, 3001)[:-1]  # the step is the first place of x2
    x2 = np.linspace(0.0, T2 * c2, 4001)
    before_step = T1 - x1[:, None] / c1  # time from a place to the step
    behind_step = x2[:, None] / c2  # time from the step to a place
    arriving = times - PULSE_DISTANCE
    reflection = (Z1 - Z2) / (Z1 + Z2)
    incident = pulse_velocity(arriving + before_step)
    reflected = reflection * pulse_velocity(arriving - before_step)
    transmitted = (1 + reflection) * pulse_velocity(arriving - behind_step)
    exact = np.concatenate((incident + reflected, transmitted))
    x = np.concatenate((x1, step + x2))[:, None]

    errors = []
    for cells in CELLS:
        solution = ri.solve(
            system, method=METHOD, cells=cells, until=1.7, snapshots=times
        )
        velocity = solution.velocity(0, x, times)
        difference = np.abs(velocity - exact)
        errors.append(float(difference.mean()))
    shown = errors[CELLS.index(SHOWN_CELLS)]
    case = Case("smooth pulse in a stepped rod", "d'Alembert")
    quantity = "velocity field in L1"
    yield case.row(f"{quantity}, error with {SHOWN_CELLS} cells", 0.0, shown, 2e-5)
    measured_order = order(errors, CELLS)
    yield case.at_least(f"{quantity}, order of the error", 2.0, measured_order, 0.1)


def impulse_by_steps(rods: list[ri.Rod], mass: float = math.inf) -> float:
    """Impulse of a Hertz contact that closes at speed 1, by the method of steps.

    Impedances and wave speeds of the rods are 1.
    """
    struck = []
    for body in rods:
        struck.append(StruckRod(impedance=1.0, transit_time=float(body.length)))
    reference = method_of_steps(k=STIFFNESS, V=1.0, rods=struck, mass=mass, until=4.0)
    return reference.impulse


def impulse_by_characteristics(system: ri.System) -> float:
    """Impulse of the contact of two bodies, at a relative tolerance of 1e-9."""
    solution = ri.solve(system, method="characteristics", rtol=1e-9)
    return solution.outcome.impulse


def compliant() -> Rows:
    """Orders of the errors with Hertz ends and springs, where everything is smooth.

    There are no fronts in them: the references are the method of steps, and the method
    of characteristics where the rods differ in everything.
    """
    hertz = ri.Hertz(STIFFNESS)
    short = rod(segment(1, 1, 0.4), velocity=1.0)
    long = rod(segment(1, 1, 1.0))
    mass = ri.RigidMass(1.0, velocity=1.0)

    case = Case("Hertz ends, rods 0.4 : 1", "method of steps")
    system = ri.System([short, long], contacts=[hertz])
    impulse = impulse_by_steps([short, long])
    yield from smooth_orders(case, system, impulse)

    case = Case("mass on rod with a Hertz end", "method of steps")
    system = ri.System([mass, long], contacts=[hertz])
    impulse = impulse_by_steps([long], mass=1.0)
    yield from smooth_orders(case, system, impulse)

    name = "Hertz ends, two rods that differ in everything"
    case = Case(name, "characteristics")
    system = ri.System(different_rods(), contacts=[hertz])
    impulse = impulse_by_characteristics(system)
    yield from smooth_orders(case, system, impulse)

    name = "spring between two rods that differ in everything"
    case = Case(name, "characteristics")
    spring = ri.Spring(3.0)
    system = ri.System(different_rods(), contacts=[spring])
    impulse = impulse_by_characteristics(system)
    yield from smooth_orders(case, system, impulse)


def smooth_orders(case: Case, system: ri.System, exact_impulse: float) -> Rows:
    """Errors of e and of the impulse on the finest grid, and their orders.

    The error of the impulse is relative. `exact_impulse` is that of two bodies that
    close at speed 1.
    """
    first, second = system.bodies
    inverse_masses = 1 / first.mass + 1 / second.mass
    exact_e = exact_impulse * inverse_masses - 1  # at a closing speed of 1
    e_errors = []
    impulse_errors = []
    for cells in SMOOTH_CELLS:
        outcome = ri.solve(system, method=METHOD, cells=cells).outcome
        e_error = outcome.restitution - exact_e
        impulse_error = outcome.impulse / exact_impulse - 1
        e_errors.append(abs(e_error))
        impulse_errors.append(abs(impulse_error))
    shown_error = f"error with {SMOOTH_CELLS[-1]} cells"
    e_order = order(e_errors, SMOOTH_CELLS)
    impulse_order = order(impulse_errors, SMOOTH_CELLS)
    yield case.row(f"e, {shown_error}", 0.0, e_errors[-1], 2e-6)
    yield case.at_least("e, order of the error", 2.0, e_order, 0.1)
    yield case.row(f"impulse, {shown_error}", 0.0, impulse_errors[-1], 2e-6)
    yield case.at_least("impulse, order of the error", 2.0, impulse_order, 0.1)
