"""Kelvin-Voigt damping: decay of modes, e of damped rods, and energy.

- Modes of free and fixed rods with eta c/(E L) = 0.01. The decay rate r follows from
  the velocity v of one point at equally spaced times, for which v(t + dt) + exp(-2 r
  dt) v(t - dt) is a multiple of v(t). The expected rate is eta omega^2/(2 E), to 0.2 %
  with 200 cells: 40 cells in each half wave of the fifth mode.
- Rods of lengths 0.4 and 1, of one material and area, form one rod of length 1.4 while
  they press. The damped modes of this rod give the momentum of the first rod at any
  time. The contact ends when this momentum has its minimum, which gives e. For small
  damping e tends to l1/l2 = 0.4, faster than any power of eta: the force ends at 2
  T_short and the gap opens at 2 T_long, and a front that has spread over (eta
  t/rho)^(1/2) does not reach from one time to the other. Rods of unequal impedance lose
  more in damped material: their e is smaller than that of elastic rods by an amount
  proportional to eta^(1/2).
- The closing remark of the textbook: the vibration dies out. The energy falls from the
  energy after the impact to the energy of the motion as rigid bodies, while the
  momentum is constant. Steel rods of lengths 0.4 and 1 keep 40 % of their initial
  energy; the rest becomes heat. `draw` shows this in ring_down.svg. Finally only the
  lowest mode of the longer rod remains, and the energy falls at twice the rate of this
  mode.

Source: Lord Rayleigh, The Theory of Sound, arts. 45 and 81, for the modes; textbook
section 10.5; `theory.saint_venant` for elastic rods.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import brentq, minimize_scalar

import rodimpact as ri
from rodimpact.plot.panels import format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

from .table import Case, Rows

METHOD = "finite-difference"
STEEL = ri.materials.steel
DAMPED_STEEL = STEEL.damped(loss_factor=0.05, frequency=2.5e3)
AREA = 1e-4  # m^2
SHORT = 0.4  # length of rod 1; that of rod 2 is LONG
LONG = 1.0
TOTAL = SHORT + LONG
MS = 1e3  # milliseconds in a second


def run() -> Rows:
    """Compare decay of modes, restitution of damped pairs, energy of a ringing pair."""
    for ends in ENDS:
        for n in (1, 2, 5):
            yield from mode(ends, n)
    yield from stepped_rod()
    yield from restitution()
    yield from unequal_impedances(Z1=1.0, Z2=2.0)
    yield from unequal_impedances(Z1=2.0, Z2=1.0)
    yield from ringing()


def material(tau: float, Z: float = 1.0) -> ri.Material:
    """A material of wave speed 1, impedance Z at an area of 1, and eta/E = tau."""
    return ri.Material("unit", youngs_modulus=Z, density=Z, viscosity=Z * tau)


# Modes


class Ends(NamedTuple):
    """The ends of a rod of length 1, and the modes between them."""

    name: str
    conditions: tuple[ri.Free | ri.Fixed, ri.Free | ri.Fixed]
    shape: Callable[[np.ndarray], np.ndarray]  # shape over k x
    shift: float  # k = (n - shift) pi
    crest: float  # k x of a largest velocity


CREST_OF_SINE = math.pi / 2
ENDS = (
    Ends("free", (ri.Free(), ri.Free()), np.cos, shift=0.0, crest=0.0),
    Ends("fixed", (ri.Fixed(), ri.Fixed()), np.sin, shift=0.0, crest=CREST_OF_SINE),
    Ends(
        "one end fixed",
        (ri.Fixed(), ri.Free()),
        np.sin,
        shift=0.5,
        crest=CREST_OF_SINE,
    ),
)
TAU = 0.01  # eta c/(E L)
STEP = 0.999 / 200  # time step of 200 cells


def mode(ends: Ends, n: int) -> Rows:
    """Rate of decay of the velocity in mode n, over the expected eta omega^2/(2 E).

    Only this mode is started. The velocity is that at a crest of the mode.
    """
    youngs_modulus = 1.0  # so that the viscosity is TAU
    k = (n - ends.shift) * math.pi  # wave number; the rod has the length 1
    x = np.linspace(0.0, 1.0, 8001)
    velocity = ri.Samples(ends.shape(k * x))
    rod = ri.Rod(1.0, area=1.0, material=material(TAU), velocity=velocity)
    interval = (20 // n) * STEP  # whole steps, fewer for a mode that swings faster
    times = np.arange(1, 61) * interval
    system = ri.System([rod], ends=ends.conditions)
    until = float(times[-1]) + STEP  # so that the last time is inside the run
    solution = ri.solve(
        system,
        method=METHOD,
        dt=STEP,
        until=until,
        snapshots=times,
    )
    x_of_crest = ends.crest / k
    v = solution.velocity(0, x_of_crest, times)
    rate = decay_rate(v, interval)
    omega = k  # the wave speed is 1
    ratio = rate / ri.theory.kelvin_voigt_decay(youngs_modulus, TAU, omega)
    case = Case(f"damped rod, {ends.name}, mode {n}", "eta omega^2/(2 E)")
    yield case.row("rate of decay over expected", 1.0, ratio, 2e-3)


def decay_rate(v: np.ndarray, dt: float) -> float:
    """Rate r of an oscillation that dies out, from its values at equal times.

    v(t + dt) = a v(t) - b v(t - dt) with b = exp(-2 r dt), by least squares.
    """
    middle = v[1:-1]
    before = v[:-2]
    after = v[2:]
    columns = np.stack((middle, -before)).T
    _, b = np.linalg.lstsq(columns, after, rcond=None)[0]
    return -math.log(b) / (2 * dt)


def stepped_rod() -> Rows:
    """Decay time and frequency of the lowest mode of a stepped rod, struck by a mass.

    The higher modes decay faster, so this one remains.
    """
    l1 = 0.4
    l2 = 1.0
    A1 = 3.0
    A2 = 1.0
    tau = 0.02

    def condition(k: float) -> float:
        """0 for the wave number k of a mode of the rod with free ends."""
        return A1 * math.tan(k * l1) + A2 * math.tan(k * l2)

    # The lowest root lies above the pole of tan k l2 at pi/2.
    k = float(brentq(condition, 1.6, 3.0))
    first = ri.Segment(l1, A1, material(tau))
    second = ri.Segment(l2, A2, material(tau))
    striker = ri.RigidMass(0.2, velocity=1.0)
    rod = ri.Rod(segments=[first, second])
    system = ri.System([striker, rod])
    solution = ri.solve(system, method=METHOD, cells=100, until=50.0)
    ring_down = solution.ring_down()
    youngs_modulus = 1.0
    omega = k  # the wave speed is 1
    rate = ri.theory.kelvin_voigt_decay(youngs_modulus, tau, omega)
    decay_time = 1 / (2 * rate)  # of the energy, which falls twice as fast
    frequency = omega / (2 * math.pi)
    case = Case("damped stepped rod, struck by a mass", "A1 tan k l1 + A2 tan k l2 = 0")
    yield case.row(
        "decay time of the energy in the end",
        decay_time,
        ring_down.decay_time,
        0.01 * decay_time,
    )
    yield case.row("frequency of the lowest mode", frequency, ring_down.frequency, 1e-4)


# Restitution


def restitution_by_modes(tau: float) -> float:
    """e of rods 0.4 : 1 from the damped modes of both as one; wave speed, impedance 1.

    While the rods press, they move as one rod of 1.4, of which rod 1 is a part. They
    separate when the momentum of rod 1 is least. The modes cos k x, k = n pi/1.4, have
    amplitudes q with q'' + 2 r q' + k^2 q = 0, r = tau k^2/2; q(0) = 0, q'(0) = 1.
    """
    k = np.arange(1, 4000) * math.pi / TOTAL
    rate = tau * k * k / 2
    share = 2 / TOTAL * (np.sin(k * SHORT) / k) ** 2  # share of the momentum, by mode
    s = np.sqrt(rate * rate - k * k + 0j)
    fast = -rate - s  # the two roots of s^2 + 2 r s + k^2 = 0
    slow = -rate + s

    def momentum(t: float) -> float:
        """Momentum of rod 1: its mass times the mean velocity, and the modes' q'."""
        slow_part = slow * np.exp(slow * t)
        fast_part = fast * np.exp(fast * t)
        v = (slow_part - fast_part) / (2 * s)
        return float(SHORT * SHORT / TOTAL + share @ v.real)

    # The contact ends between the round trips of the short and of the long rod.
    end_bounds = (2 * SHORT, 2 * LONG)
    minimum = minimize_scalar(
        momentum, bounds=end_bounds, method="bounded", options={"xatol": 1e-9}
    )
    impulse = SHORT - float(minimum.fun)  # rod 1 came with the momentum 0.4
    e = impulse * (1 / SHORT + 1 / LONG) - 1
    return round(e, 12)


def solve_damped_pair(tau: float, Z1: float = 1.0, Z2: float = 1.0) -> ri.Outcome:
    """The outcome of damped rods 0.4 : 1 of these impedances, on a grid of 400 cells.

    tau is eta/E. The first rod has the velocity 1, the second one is at rest.
    """
    first = ri.Rod(SHORT, area=1.0, material=material(tau, Z1), velocity=1.0)
    second = ri.Rod(LONG, area=1.0, material=material(tau, Z2))
    system = ri.System([first, second])
    return ri.solve(system, method=METHOD, cells=400, snapshots=2).outcome


def restitution() -> Rows:
    """e and balances of rods of one material and thickness at several dampings.

    At strong damping e is compared with that of the modes, and the balances of energy
    and momentum with 0. At weak damping e alone is compared with l1/l2.
    """
    case = Case("damped rods 0.4 : 1", "conserved")
    for tau in (0.2, 0.1, 0.05, 0.02):
        expected = restitution_by_modes(tau)
        outcome = solve_damped_pair(tau)
        energy = outcome.energy_residual
        momentum = outcome.momentum_residual
        yield case.row(
            f"e at eta c/(E L) = {tau:g}",
            expected,
            outcome.restitution,
            5e-6,
            source="damped modes of one rod of 1.4",
        )
        yield case.row(
            f"energy after - before + heat at {tau:g}, relative", 0.0, energy, 1e-12
        )
        yield case.row(
            f"momentum after - before at {tau:g}, relative", 0.0, momentum, 1e-12
        )
    for tau in (1e-2, 1e-3, 1e-4):
        e = solve_damped_pair(tau).restitution
        quantity = f"e at eta c/(E L) = {tau:g}"
        yield case.row(quantity, SHORT, e, 1e-6, source="no damping: l1/l2")


def unequal_impedances(Z1: float, Z2: float) -> Rows:
    """e of damped rods of unequal impedances, beside e of elastic rods.

    The difference grows as eta^(1/2): it is compared at two values of eta.
    """
    elastic = ri.theory.saint_venant(Z1, SHORT, Z2, LONG).restitution
    loss_at_1e_3 = elastic - solve_damped_pair(tau=1e-3, Z1=Z1, Z2=Z2).restitution
    loss_at_1e_4 = elastic - solve_damped_pair(tau=1e-4, Z1=Z1, Z2=Z2).restitution
    growth = loss_at_1e_3 / loss_at_1e_4
    case = Case(f"damped rods 0.4 : 1, impedances {Z1:g} : {Z2:g}", "conserved")
    yield case.row(
        "e at eta c/(E L) = 1e-4",
        elastic,
        elastic - loss_at_1e_4,
        0.01,
        source="no damping: Saint-Venant",
    )
    yield case.row(
        "e of elastic rods - e at 1e-3, over the same at 1e-4",
        round(math.sqrt(10), 6),
        growth,
        0.1,
        source="eta^(1/2)",
    )


# Energy


def steel_pair(material: ri.Material) -> ri.System:
    """Rods of 0.4 m and 1 m, the first at 1 m/s."""
    first = ri.Rod(SHORT, area=AREA, material=material, velocity=1.0)
    second = ri.Rod(LONG, area=AREA, material=material)
    return ri.System([first, second])


def solve_ringing_pair() -> ri.Solution:
    """Steel rods, damped so that hardly any vibration is left after 15 ms."""
    system = steel_pair(DAMPED_STEEL)
    return ri.solve(system, method=METHOD, cells=150, until=15e-3)


def ringing() -> Rows:
    """Energies, momentum and decay time of the ringing pair at 15 ms.

    The energy falls from that after the impact to that of rigid bodies.
    """
    solution = solve_ringing_pair()
    ring_down = solution.ring_down()
    before = solution.outcome.kinetic_before
    energy = solution.energy(solution.t_end)
    rigid = ring_down.rigid / before
    remaining = float(energy.total) / before
    heat = float(energy.damped + energy.numerical) / before
    residual = float(energy.residual) / before
    round_off = 1e-14 * before
    rises = np.sum(np.diff(ring_down.vibration) > round_off)
    decay_time = MS * ring_down.decay_time
    expected_decay_time = round(MS * longest_decay_time(), 9)
    momentum_change = ring_down.momentum_change
    case = Case("damped steel rods 0.4 m : 1 m", "rigid bodies, e = l1/l2")
    yield case.row("energy of the rigid motion, share", SHORT, rigid, 1e-4)
    yield case.row("energy at the end, share", SHORT, remaining, 1e-4)
    yield case.row(
        "heat, and what the grid loses as the ends meet, share", 1 - SHORT, heat, 1e-4
    )
    yield case.row(
        "energy after - before + heat, share",
        0.0,
        residual,
        1e-12,
        source="conserved",
    )
    yield case.row(
        "largest change of the momentum, relative",
        0.0,
        momentum_change,
        1e-12,
        source="conserved",
    )
    yield case.row("rises of the energy", 0.0, rises, 0.0, source="it falls")
    yield case.row(
        "decay time in the end, ms",
        expected_decay_time,
        decay_time,
        0.01,
        source="lowest mode of the longer rod",
    )


def longest_decay_time() -> float:
    """Time constant of the energy of the longer rod's lowest mode, s."""
    omega = math.pi * float(DAMPED_STEEL.wave_speed) / LONG
    rate = ri.theory.kelvin_voigt_decay(
        DAMPED_STEEL.youngs_modulus, DAMPED_STEEL.viscosity, omega
    )
    return 1 / (2 * float(rate))


def draw_level(ax: Axes, energy: float, label: str, offset: float) -> None:
    """Draw a dotted line at an energy, and a label an offset above or below it.

    A positive `offset` puts the label above the line.
    """
    ax.axhline(energy, color=FAINT, linewidth=1.0, linestyle=":")
    alignment = "top"
    if offset > 0:
        alignment = "bottom"
    ax.text(8.0, energy + offset, label, ha="right", va=alignment)


def draw_energy(ax: Axes, solution: ri.Solution) -> None:
    """Draw the total energy over time, as a share of the energy before the impact.

    It falls to the energy of rigid bodies. Dotted lines are at the energies of elastic
    rods after the impact: with and without vibration.
    """
    before = solution.outcome.kinetic_before
    elastic = ri.solve(steel_pair(STEEL)).outcome
    after = (elastic.kinetic_after + sum(elastic.vibration_after)) / before
    rigid = elastic.kinetic_after / before
    t = np.linspace(0.0, 8e-3, 801)
    energy = solution.energy(t).total
    ax.plot(MS * t, energy / before, color=SERIES[0])
    draw_level(ax, after, "after the impact: kinetic + vibration", offset=0.02)
    draw_level(ax, rigid, "as rigid bodies, e = ℓ₁/ℓ₂", offset=-0.02)
    ax.set(
        xlabel="time (ms)",
        ylabel="energy over that before the impact",
        ylim=(0, 1.1),
        xlim=(0, 8),
    )


def draw_vibration(ax: Axes, solution: ri.Solution) -> None:
    """Draw the energy of vibration, and that of the lowest mode of the longer rod.

    The energy of the mode is an exponential, fitted to the later half of the vibration.
    """
    before = solution.outcome.kinetic_before
    ring_down = solution.ring_down()
    times = ring_down.times
    vibration = ring_down.vibration / before
    lowest_mode = np.exp(-times / longest_decay_time())
    # The mode's energy is fitted to the late vibration: the mean of the logarithms.
    is_late = times > times[-1] / 2
    ratio = ring_down.vibration[is_late] / before / lowest_mode[is_late]
    lowest_mode *= np.exp(np.mean(np.log(ratio)))
    ax.plot(MS * times, vibration, color=SERIES[0], label="vibration")
    ax.plot(
        MS * times,
        lowest_mode,
        color=SERIES[1],
        linestyle=DASHES[1],
        label="lowest mode of the longer rod",
    )
    ax.set(
        xlabel="time (ms)\nsteel rods 0.4 m : 1 m, loss factor 0.05 at 2.5 kHz",
        yscale="log",
        ylabel="energy over that before the impact",
    )
    ax.legend(loc="upper right", frameon=False)


@styled
def draw() -> Axes:
    """Draw two panels: energy; vibration and its lowest mode. Return the left Axes."""
    left, right = new_figure(width=9.5, height=3.6).subplots(1, 2)
    solution = solve_ringing_pair()
    draw_energy(left, solution)
    draw_vibration(right, solution)
    for ax in (left, right):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return left
