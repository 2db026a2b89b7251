"""Rods with rounded ends: e falls from 1 to l1/l2 for stiffer ends or higher speeds.

Two rods of one material and area, with lengths 0.4 and 1, collide with the Hertz
contact F = k d^(3/2). For given lengths e depends only on the dimensionless stiffness

kappa = k (V T)^(1/2) L/(E A),  L and T of the longer rod.

So e also depends on the closing speed V, because kappa is proportional to V^(1/2).

Results. If the ends are much softer than the rods, the contact lasts many round trips
of a wave. Hardly any vibration remains, and e = 1, as for spheres. From kappa = 0.02 to
0.4, e varies between 0.998 and 1, because the remaining vibration depends on the number
of its periods during the contact. For larger kappa the contact time approaches the
round trip of the longer rod, and e falls: 0.944 at kappa = 1, 0.617 at 10, 0.451 at 100
and 0.411 at 1000. The limit l1/l2 = 0.4 is approached slowly, with e - 0.4 proportional
to kappa^(-2/3): the rise time of the force must be short compared with the round trip
of the shorter rod. For a given pair of rods e falls with increasing speed: from 0.944
to 0.451 over four decades of speed, starting at kappa = 1. Steel rods 0.2 m and 0.5 m
long, with a diameter of 10 mm, collide at 0.1 m/s with e = 0.97 if their ends are half
spheres. For a radius of 50 mm, e = 0.83. For a radius of 1 m the ends look flat, and
still e = 0.61. Measured values for real rods are also nearer to 1 than to l1/l2.

`draw` shows this in the figure hertz_ends.svg.

Expected: e at these values of kappa to 1e-3. One e at small kappa, and e at three
closing speeds, agree with the method of steps of `sphere_on_wall` to 1e-6 at the
default tolerance. All k and V with the same kappa give the same e.

Source: H. Hertz, Journal für die reine und angewandte Mathematik 92 (1881); for real
rods R. Cross, European Journal of Physics 42 (2021), doi 10.1088/1361-6404/ac25d2.
"""

import math

import numpy as np
from matplotlib.axes import Axes

import rodimpact as ri
from rodimpact.plot.panels import format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

from .sphere_on_wall import STEEL, StruckRod, method_of_steps
from .table import Case, Rows, largest_magnitude
from .unit import rod

SHORT = 0.4  # length of the first rod; that of the second is 1
BY_DECADE = {-3: 1.0, 0: 0.944, 1: 0.617, 3: 0.411, 5: 0.4005}  # log10 kappa: e
SPEEDS = (0.01, 1.0, 100.0)
STEEL_DIAMETER = 0.01  # diameter of steel rods 0.2 m and 0.5 m long, m
RADII = {"5 mm": 0.005, "50 mm": 0.05, "1 m": 1.0, "20 m": 20.0}  # radii of ends, m


def solve_pair(k: float, V: float = 1.0) -> ri.Outcome:
    """Outcome of rods 0.4 and 1 long with Hertz ends, closing at speed V.

    Impedance and wave speed are 1, so kappa is k V^(1/2).
    """
    short = rod(SHORT, velocity=V)
    long = rod(1.0)
    contact = ri.Hertz(k)
    system = ri.System([short, long], contacts=[contact])
    return ri.solve(system).outcome


def restitution(kappa: float) -> float:
    """e of rods 0.4 : 1 by the dimensionless stiffness."""
    return solve_pair(kappa).restitution


def restitution_by_steps(k: float, V: float = 1.0, until: float = 3.0) -> float:
    """e by the method of steps, to 7 digits: P (1/m1 + 1/m2)/V - 1.

    P is the impulse on rods of the lengths `SHORT` and 1, of impedance and wave speed
    1.
    """
    short = StruckRod(impedance=1.0, transit_time=SHORT)
    long = StruckRod(impedance=1.0, transit_time=1.0)
    reference = method_of_steps(k, V, [short, long], until=until)
    e = reference.impulse * (1 / SHORT + 1) / V - 1
    return float(f"{e:.7g}")


def run() -> Rows:
    """Compare values by kappa, limits, closing speeds."""
    yield from by_stiffness()
    yield from by_speed()
    yield from one_stiffness()


def by_stiffness() -> Rows:
    """e at each decade of the dimensionless stiffness: from 1 it falls to l1/l2.

    Rows compare e at some decades with two other computations, its fall from decade to
    decade, its approach to l1/l2, and one value with the method of steps.
    """
    e = {n: restitution(10.0**n) for n in range(-3, 7)}
    name = "Hertz ends, rods 0.4 : 1"
    case = Case(name, "two computations independent of this one")
    for n, expected in BY_DECADE.items():
        yield case.row(f"e at kappa = 1e{n}", expected, e[n], 1e-3)
    yield case.row("e at kappa = 1e6", SHORT, e[6], 1e-3, source="rigid ends: l1/l2")
    falling = [e[n] for n in range(-1, 7)]
    changes = np.diff(falling)
    rises = np.sum(changes > 0)
    yield case.row(
        "rises of e from kappa = 0.1 to 1e6, a decade a step",
        0.0,
        rises,
        0.0,
        source="e falls",
    )
    excess = e[3] - SHORT
    decay = excess / (e[4] - SHORT)
    yield case.row(
        "e - l1/l2 at kappa = 1e3 over that at 1e4",
        4.6416,  # 10^(2/3)
        decay,
        0.01,
        source="kappa^(-2/3)",
    )
    exact = restitution_by_steps(k=0.2, until=5.0)
    in_ripples = restitution(kappa=0.2)
    yield case.row(
        "e at kappa = 0.2, in the ripples",
        exact,
        in_ripples,
        1e-7,
        source="method of steps",
    )


def by_speed() -> Rows:
    """e of rods 0.4 : 1 at three closing speeds, beside the method of steps."""
    k = 10.0
    case = Case(f"Hertz ends, k = {k:g}", "method of steps")
    for V in SPEEDS:
        exact = restitution_by_steps(k, V)
        e = solve_pair(k, V).restitution
        yield case.row(f"e at closing speed {V:g}", exact, e, 1e-7)


def one_stiffness() -> Rows:
    """Largest difference of e for several stiffnesses and closing speeds of one kappa.

    The closing speed V = 1 is compared with 1e-4 and 100, each with the stiffness k for
    which kappa = k V^(1/2) is the same.
    """
    kappa = 10.0
    differences = []
    for V in (1e-4, 1e2):
        k = kappa / math.sqrt(V)
        e = solve_pair(k, V).restitution
        differences.append(e - restitution(kappa))  # the latter at V = 1
    largest_difference = largest_magnitude(differences)
    case = Case(f"Hertz ends, kappa = {kappa:g}", "one number decides")
    yield case.row(
        "e at closing speeds 1e-4, 1, 100, largest difference",
        0.0,
        largest_difference,
        1e-10,
    )


def steel_restitution(V: float, contact: ri.Hertz) -> float:
    """e of steel rods 0.2 m and 0.5 m long, 10 mm thick, that meet at V m/s.

    The second rod is at rest. The method is characteristics, as the contact is
    compliant.
    """
    area = math.pi * STEEL_DIAMETER**2 / 4
    first = ri.Rod(0.2, area=area, material=STEEL, velocity=V)
    second = ri.Rod(0.5, area=area, material=STEEL)
    system = ri.System([first, second], contacts=[contact])
    return ri.solve(system).outcome.restitution


def draw_limit(ax: Axes, e: float) -> None:
    """Draw a dotted line at a limit of e."""
    ax.axhline(e, color=FAINT, linewidth=1.0, linestyle=":")


def draw_by_stiffness(ax: Axes) -> None:
    """Draw e over kappa, with values of the method of steps.

    The curve is computed by characteristics, the dots by the method of steps. Dotted
    lines are at the limits l1/l2 and 1.
    """
    draw_limit(ax, SHORT)
    draw_limit(ax, 1.0)
    kappas = np.geomspace(1e-3, 1e6, 55).tolist()
    e = [restitution(kappa) for kappa in kappas]
    ax.plot(kappas, e, color=SERIES[0])
    kappas = np.geomspace(1, 1000, 7).tolist()
    e = [restitution_by_steps(kappa) for kappa in kappas]
    ax.plot(
        kappas,
        e,
        color=SERIES[1],
        linestyle="",
        marker="o",
        markersize=4.0,
    )
    ax.text(1.5e-3, 0.97, "soft ends: e = 1", va="top")
    ax.text(8e5, 0.34, "rigid ends: e = ℓ₁/ℓ₂", ha="right")
    ax.text(25, 0.6, "dots: method of steps")
    ax.set(
        xlabel="dimensionless stiffness κ = k (V T)$^{1/2}$ ℓ₂/(E A)",
        xscale="log",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
    )


def draw_by_speed(ax: Axes) -> None:
    """Draw e over closing speed of steel rods with rounded ends.

    There is a curve for each radius of the ends in `RADII`.
    """
    speeds = np.geomspace(0.01, 10, 25).tolist()
    for i, label in enumerate(RADII):
        radius = RADII[label]
        contact = ri.Hertz.from_radii(
            radius, radius, left_material=STEEL, right_material=STEEL
        )
        e = [steel_restitution(V, contact) for V in speeds]
        ax.plot(speeds, e, color=SERIES[i], linestyle=DASHES[i], label=label)
    draw_limit(ax, SHORT)
    ax.set(
        xlabel="closing speed (m/s)\nsteel rods 0.2 m and 0.5 m, 10 mm thick",
        xscale="log",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
    )
    ax.legend(title="radius of the ends", loc="lower left", frameon=False)


@styled
def draw() -> Axes:
    """Draw e over kappa, and e over closing speed for steel; return the left Axes."""
    left, right = new_figure(width=9.5, height=3.8).subplots(1, 2)
    draw_by_stiffness(left)
    draw_by_speed(right)
    for ax in (left, right):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return left
