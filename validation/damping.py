"""Kelvin-Voigt damping: how modes die out, and what becomes of e = l1/l2 and of its energy.

- Modes of free and fixed rods, eta c/(E L) = 0.01: the rate r is read off the velocity of one place
  at equal times, for which v(t + dt) + exp(-2 r dt) v(t - dt) is a multiple of v(t). Expected
  eta omega^2/(2 E), to 0.2 % with 200 cells, 40 in each half wave of the fifth mode.
- Rods 0.4 : 1 of one material and thickness are, while they press, one rod of 1.4. Its damped modes
  give the momentum that the first rod has kept at any time; contact ends where that is least, which
  gives e. As the damping goes, e tends to l1/l2 = 0.4, and it comes there faster than by any power:
  the force ends at 2 T_short and the gap opens at 2 T_long, and fronts that have spread by
  (eta t/rho)^(1/2) do not reach from the one to the other. Rods of unequal impedance lose more in
  damped material: e falls short of that of elastic rods by a share of eta^(1/2).
- The closing remark of the textbook: vibration dies out, and the energy falls from that after the
  impact to that of the motion as rigid bodies, while momentum stays. Steel rods 0.4 : 1 keep 40 %
  of the energy that they came with, the rest becomes heat. `draw` shows this in ring_down.svg. The
  lowest mode of the longer rod remains, and in the end the energy falls at twice its rate.

Source: Lord Rayleigh, The Theory of Sound, arts. 45 and 81, for the modes; textbook section 10.5;
`theory.saint_venant` for elastic rods.
"""

import math

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import brentq, minimize_scalar

import rodimpact as ri
from rodimpact.plot.panels import format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

from .table import Case, Row, Rows

STEEL, AREA = ri.materials.steel, 1e-4
DAMPED = STEEL.damped(loss_factor=0.05, frequency=2.5e3)
SHORT, LONG = 0.4, 1.0
METHOD = "finite-difference"


def run() -> Rows:
    """Modes, restitution, energy."""
    return modes(), modes_of_unequal_thickness(), restitution(), ringing()


def material(tau: float, Z: float = 1.0) -> ri.Material:
    """Of wave speed 1, impedance Z at an area of 1, and eta/E = tau."""
    return ri.Material("unit", youngs_modulus=Z, density=Z, viscosity=Z * tau)


# Modes --------------------------------------------------------------------------------------------


def modes() -> Rows:
    """Two ends free, two fixed, one of each; first, second and fifth mode."""
    tau, dt = 0.01, 0.999 / 200
    for case, ends, shape, shift in (
        ("free", (ri.Free(), ri.Free()), np.cos, 0.0),
        ("fixed", (ri.Fixed(), ri.Fixed()), np.sin, 0.0),
        ("one end fixed", (ri.Fixed(), ri.Free()), np.sin, 0.5),
    ):
        for n in (1, 2, 5):
            k = (n - shift) * math.pi
            start = ri.Samples(shape(k * np.linspace(0.0, 1.0, 8001)))
            rod = ri.Rod(1.0, area=1.0, material=material(tau), velocity=start)
            apart = 20 // n * dt
            times = np.arange(1, 61) * apart
            solution = ri.solve(
                ri.System([rod], ends=ends),
                method=METHOD,
                dt=dt,
                until=float(times[-1]) + dt,
                snapshots=times,
            )
            crest = 0.0 if shape is np.cos else math.pi / 2 / k
            rate = decay(solution.velocity(0, crest, times), apart)
            expected = ri.theory.kelvin_voigt_decay(1.0, tau, k)
            yield Row(
                f"damped rod, {case}, mode {n}",
                "rate of decay over expected",
                "eta omega^2/(2 E)",
                1.0,
                rate / expected,
                2e-3,
            )


def decay(v: np.ndarray, dt: float) -> float:
    """Rate of an oscillation that dies out, from its values at equal times."""
    neighbours = np.stack((v[1:-1], -v[:-2])).T
    _, b = np.linalg.lstsq(neighbours, v[2:], rcond=None)[0]
    return -math.log(b) / (2 * dt)


def modes_of_unequal_thickness() -> Rows:
    """The lowest mode of a stepped rod of one material, which remains of a blow."""
    (L1, A1), (L2, A2), tau = (0.4, 3.0), (1.0, 1.0), 0.02
    k = float(brentq(lambda k: A1 * math.tan(k * L1) + A2 * math.tan(k * L2), 1.6, 3.0))
    stepped = ri.Rod(
        segments=[ri.Segment(L, A, material(tau)) for L, A in ((L1, A1), (L2, A2))]
    )
    striker = ri.RigidMass(0.2, velocity=1.0)
    row = ri.System([striker, stepped])
    ring_down = ri.solve(row, method=METHOD, cells=100, until=50.0).ring_down()
    case = Case("damped stepped rod, struck by a mass", "A1 tan k l1 + A2 tan k l2 = 0")
    expected = 1 / (2 * ri.theory.kelvin_voigt_decay(1.0, tau, k))
    yield case.row(
        "decay time of the energy in the end",
        expected,
        ring_down.decay_time,
        0.01 * expected,
    )
    yield case.row(
        "frequency of the lowest mode", k / (2 * math.pi), ring_down.frequency, 1e-4
    )


# Restitution --------------------------------------------------------------------------------------


def joined(tau: float) -> float:
    """e of rods 0.4 : 1 from the damped modes of both as one; wave speed, impedance 1."""
    L = SHORT + LONG
    k = np.arange(1, 4000) * math.pi / L
    r, share = tau * k * k / 2, 2 / L * (np.sin(k * SHORT) / k) ** 2
    s = np.sqrt(r * r - k * k + 0j)

    def kept(t: float) -> float:
        """Momentum of the first rod."""
        fast, slow = -r - s, -r + s
        v = (slow * np.exp(slow * t) - fast * np.exp(fast * t)) / (2 * s)
        return float(SHORT * SHORT / L + share @ v.real)

    least = minimize_scalar(
        kept, bounds=(2 * SHORT, 2 * LONG), method="bounded", options={"xatol": 1e-9}
    )
    return round((SHORT - float(least.fun)) * (1 / SHORT + 1 / LONG) - 1, 12)


def damped_pair(
    tau: float, Z1: float = 1.0, Z2: float = 1.0, cells: int = 400
) -> ri.Outcome:
    """Rods 0.4 : 1 of these impedances."""
    rods = [
        ri.Rod(length, area=1.0, material=material(tau, Z), velocity=v)
        for length, Z, v in ((SHORT, Z1, 1.0), (LONG, Z2, 0.0))
    ]
    return ri.solve(ri.System(rods), method=METHOD, cells=cells, snapshots=2).outcome


def restitution() -> Rows:
    """One material and thickness, then unequal impedances."""
    case = Case("damped rods 0.4 : 1", "conserved")
    for tau in (0.2, 0.1, 0.05, 0.02):
        o = damped_pair(tau)
        yield case.row(
            f"e at eta c/(E L) = {tau:g}",
            joined(tau),
            o.restitution,
            5e-6,
            "damped modes of one rod of 1.4",
        )
        yield case.row(
            f"energy after - before + heat at {tau:g}, relative",
            0.0,
            o.energy_residual,
            1e-12,
        )
        yield case.row(
            f"momentum after - before at {tau:g}, relative",
            0.0,
            o.momentum_residual,
            1e-12,
        )
    for tau in (1e-2, 1e-3, 1e-4):
        yield case.row(
            f"e at eta c/(E L) = {tau:g}",
            SHORT,
            damped_pair(tau).restitution,
            1e-6,
            "no damping: l1/l2",
        )
    for Z1, Z2 in ((1.0, 2.0), (2.0, 1.0)):
        elastic = ri.theory.saint_venant(Z1, SHORT, Z2, LONG).restitution
        short_of = [
            elastic - damped_pair(tau, Z1, Z2).restitution for tau in (1e-3, 1e-4)
        ]
        case = Case(f"damped rods 0.4 : 1, impedances {Z1:g} : {Z2:g}", "conserved")
        yield case.row(
            "e at eta c/(E L) = 1e-4",
            elastic,
            elastic - short_of[1],
            0.01,
            "no damping: Saint-Venant",
        )
        yield case.row(
            "e of elastic rods - e at 1e-3, over the same at 1e-4",
            round(math.sqrt(10), 6),
            short_of[0] / short_of[1],
            0.1,
            "eta^(1/2)",
        )


# Energy -------------------------------------------------------------------------------------------


def ringing_pair() -> ri.Solution:
    """Steel rods of 0.4 m and 1 m, damped so that hardly any vibration is left after 15 ms."""
    rods = [
        ri.Rod(length, area=AREA, material=DAMPED, velocity=v)
        for length, v in ((SHORT, 1.0), (LONG, 0.0))
    ]
    return ri.solve(ri.System(rods), method=METHOD, cells=150, until=15e-3)


def ringing() -> Rows:
    """From the energy after the impact to that of rigid bodies."""
    solution = ringing_pair()
    end = solution.ring_down()
    case = Case("damped steel rods 0.4 m : 1 m", "rigid bodies, e = l1/l2")
    came = solution.outcome.kinetic_before
    book = solution.energy(solution.t_end)
    yield case.row("energy of the rigid motion, share", SHORT, end.rigid / came, 1e-4)
    yield case.row("energy at the end, share", SHORT, float(book.total) / came, 1e-4)
    yield case.row(
        "heat, and what the grid loses as the ends meet, share",
        1 - SHORT,
        float(book.damped + book.numerical) / came,
        1e-4,
    )
    yield case.row(
        "energy after - before + heat, share",
        0.0,
        float(book.residual) / came,
        1e-12,
        "conserved",
    )
    yield case.row(
        "largest change of the momentum, relative",
        0.0,
        end.momentum_change,
        1e-12,
        "conserved",
    )
    yield case.row(
        "rises of the energy",
        0.0,
        np.sum(np.diff(end.vibration) > 1e-14 * came),
        0.0,
        "it falls",
    )
    yield case.row(
        "decay time in the end, ms",
        round(1e3 * slowest(), 9),
        1e3 * end.decay_time,
        0.01,
        "lowest mode of the longer rod",
    )


def slowest() -> float:
    """Time constant of the energy of the longer rod's lowest mode, s."""
    omega = math.pi * float(DAMPED.wave_speed) / LONG
    return 1 / (
        2
        * float(
            ri.theory.kelvin_voigt_decay(DAMPED.youngs_modulus, DAMPED.viscosity, omega)
        )
    )


@styled
def draw() -> Axes:
    """Energy falls to that of rigid bodies; vibration, and the mode that lasts longest."""
    total, vibration = new_figure(9.5, 3.6).subplots(1, 2)
    solution = ringing_pair()
    o, end, ms = solution.outcome, solution.ring_down(), 1e3
    t = np.linspace(0.0, 8e-3, 801)
    book = solution.energy(t)
    came = o.kinetic_before
    total.plot(ms * t, book.total / came, color=SERIES[0])
    elastic = ri.solve(
        ri.System(
            [
                ri.Rod(length, area=AREA, material=STEEL, velocity=v)
                for length, v in ((SHORT, 1.0), (LONG, 0.0))
            ]
        )
    ).outcome
    after = (elastic.kinetic_after + sum(elastic.vibration_after)) / came
    rigid = elastic.kinetic_after / came
    for level, words, above in (
        (after, "after the impact: kinetic + vibration", 0.02),
        (rigid, "as rigid bodies, e = ℓ₁/ℓ₂", -0.02),
    ):
        total.axhline(level, color=FAINT, linewidth=1.0, linestyle=":")
        total.text(
            8.0, level + above, words, ha="right", va="bottom" if above > 0 else "top"
        )
    total.set(
        xlabel="time (ms)",
        ylabel="energy over that before the impact",
        ylim=(0, 1.1),
        xlim=(0, 8),
    )
    vibration.plot(
        ms * end.times, end.vibration / came, color=SERIES[0], label="vibration"
    )
    late = end.times > end.times[-1] / 2
    modal = np.exp(-end.times / slowest())
    modal *= np.exp(np.mean(np.log(end.vibration[late] / came / modal[late])))
    vibration.plot(
        ms * end.times,
        modal,
        color=SERIES[1],
        linestyle=DASHES[1],
        label="lowest mode of the longer rod",
    )
    vibration.set(
        xlabel="time (ms)\nsteel rods 0.4 m : 1 m, loss factor 0.05 at 2.5 kHz",
        yscale="log",
        ylabel="energy over that before the impact",
    )
    vibration.legend(loc="upper right", frameon=False)
    for ax in (total, vibration):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return total
