"""Rods with rounded ends: from e = 1 to e = l1/l2 as the ends grow stiffer, or the blow faster.

Two rods of one material and thickness, lengths 0.4 : 1, meet with a Hertz contact F = k d^(3/2).
The only number besides the lengths is the dimensionless stiffness

    kappa = k (V T)^(1/2) L/(E A),  L and T of the longer rod,

so e depends on the closing speed as well, as kappa grows with its square root.

What is measured. With ends far softer than the rods the blow lasts many round trips, the waves even
out and e = 1, as for spheres. From kappa = 0.02 to 0.4 it ripples below that, between 0.998 and 1,
as the vibration left behind depends on how many of its periods the contact lasts. Then e falls, all
the way, as the contact time comes near the round trip of the longer rod: 0.944 at kappa = 1, 0.617
at 10, 0.451 at 100, 0.411 at 1000. It comes to l1/l2 = 0.4 slowly, e - 0.4 falling as
kappa^(-2/3): only then the time in which the force comes up is short against the round trip of the
shorter rod. A given pair of rods loses more the faster it meets: over four decades of speed from
kappa = 1 on, e falls from 0.944 to 0.451. Steel rods 0.2 m and 0.5 m long and 10 mm thick meet at
0.1 m/s with e = 0.97 if their ends are half spheres, 0.83 if rounded to 50 mm, and 0.61 even where
they look flat, rounded to 1 m: real rods, too, are found nearer to e = 1 than to l1/l2.

`draw` shows this in the figure hertz_ends.svg.

Expected: the values of kappa to 1e-3; one in the ripples and those at three closing speeds to 1e-6
at the default tolerance, against the method of steps of `sphere_on_wall`; e the same for every k
and V of one kappa.

Source: H. Hertz, Journal für die reine und angewandte Mathematik 92 (1881); for real rods R. Cross,
European Journal of Physics 42 (2021), doi 10.1088/1361-6404/ac25d2.
"""

import math

import numpy as np
from matplotlib.axes import Axes

import rodimpact as ri
from rodimpact.plot.panels import format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

from .sphere_on_wall import STEEL, method_of_steps
from .table import Case, Row, Rows
from .unit import rod

SHORT = 0.4
BY_DECADE = {-3: 1.0, 0: 0.944, 1: 0.617, 3: 0.411, 5: 0.4005}  # log10 kappa: e


def collision(k: float, V: float = 1.0) -> ri.Outcome:
    """Rods 0.4 and 1 long, impedance and wave speed 1."""
    return ri.solve(
        ri.System([rod(SHORT, velocity=V), rod(1.0)], contacts=[ri.Hertz(k)])
    ).outcome


def restitution(kappa: float) -> float:
    """e by the dimensionless stiffness."""
    return collision(kappa).restitution


def independent(k: float, V: float = 1.0, until: float = 3.0) -> float:
    """e by the method of steps, to 7 digits."""
    exact = method_of_steps(k, V, [(1.0, SHORT), (1.0, 1.0)], until=until)
    return float(f"{exact.impulse * (1 / SHORT + 1) / V - 1:.7g}")


def run() -> Rows:
    """Values by kappa, limits, closing speeds."""
    case = Case("Hertz ends, rods 0.4 : 1", "two computations independent of this one")
    e = {n: restitution(10.0**n) for n in range(-3, 7)}
    for n, expected in BY_DECADE.items():
        yield case.row(f"e at kappa = 1e{n}", expected, e[n], 1e-3)
    yield case.row("e at kappa = 1e6", SHORT, e[6], 1e-3, "rigid ends: l1/l2")
    yield case.row(
        "rises of e from kappa = 0.1 to 1e6, a decade a step",
        0.0,
        np.sum(np.diff([e[n] for n in range(-1, 7)]) > 0),
        0.0,
        "e falls",
    )
    yield case.row(
        "e - l1/l2 at kappa = 1e3 over that at 1e4",
        4.6416,
        (e[3] - SHORT) / (e[4] - SHORT),
        0.01,
        "kappa^(-2/3)",
    )
    yield case.row(
        "e at kappa = 0.2, in the ripples",
        independent(0.2, until=5.0),
        restitution(0.2),
        1e-7,
        "method of steps",
    )
    for V in (0.01, 1.0, 100.0):
        yield Row(
            "Hertz ends, k = 10",
            f"e at closing speed {V:g}",
            "method of steps",
            independent(10.0, V),
            collision(10.0, V).restitution,
            1e-7,
        )
    scaled = [collision(10.0 / math.sqrt(V), V).restitution for V in (1e-4, 1e2)]
    apart = float(np.abs(np.array(scaled) - restitution(10.0)).max())
    yield Row(
        "Hertz ends, kappa = 10",
        "e at closing speeds 1e-4, 1, 100, largest difference",
        "one number decides",
        0.0,
        apart,
        1e-10,
    )


def of_steel(V: float, law: ri.Hertz) -> float:
    """e of steel rods 0.2 m and 0.5 m long, 10 mm thick."""
    area = math.pi * 0.01**2 / 4
    rods = [
        ri.Rod(0.2, area=area, material=STEEL, velocity=V),
        ri.Rod(0.5, area=area, material=STEEL),
    ]
    return ri.solve(ri.System(rods, contacts=[law])).outcome.restitution


@styled
def draw() -> Axes:
    """e over kappa, and over closing speed for steel rods with rounded ends."""
    by_kappa, by_speed = new_figure(9.5, 3.8).subplots(1, 2)
    kappas = np.geomspace(1e-3, 1e6, 55)
    by_kappa.axhline(SHORT, color=FAINT, linewidth=1.0, linestyle=":")
    by_kappa.axhline(1.0, color=FAINT, linewidth=1.0, linestyle=":")
    by_kappa.plot(kappas, [restitution(x) for x in kappas.tolist()], color=SERIES[0])
    places = np.geomspace(1, 1000, 7)
    by_kappa.plot(
        places,
        [independent(x) for x in places.tolist()],
        color=SERIES[1],
        linestyle="",
        marker="o",
        markersize=4.0,
    )
    by_kappa.text(1.5e-3, 0.97, "soft ends: e = 1", va="top")
    by_kappa.text(8e5, 0.34, "rigid ends: e = ℓ₁/ℓ₂", ha="right")
    by_kappa.text(25, 0.6, "dots: method of steps")
    by_kappa.set(
        xlabel="dimensionless stiffness κ = k (V T)$^{1/2}$ ℓ₂/(E A)",
        xscale="log",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
    )
    speeds = np.geomspace(0.01, 10, 25)
    for i, (radius, words) in enumerate(
        ((0.005, "5 mm"), (0.05, "50 mm"), (1.0, "1 m"), (20.0, "20 m"))
    ):
        law = ri.Hertz.from_radii(
            radius, radius, left_material=STEEL, right_material=STEEL
        )
        e = [of_steel(V, law) for V in speeds.tolist()]
        by_speed.plot(speeds, e, color=SERIES[i], linestyle=DASHES[i], label=words)
    by_speed.axhline(SHORT, color=FAINT, linewidth=1.0, linestyle=":")
    by_speed.set(
        xlabel="closing speed (m/s)\nsteel rods 0.2 m and 0.5 m, 10 mm thick",
        xscale="log",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
    )
    by_speed.legend(title="radius of the ends", loc="lower left", frameon=False)
    for ax in (by_kappa, by_speed):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return by_kappa
