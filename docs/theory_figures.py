"""Draw the figures of the theory page: `python docs/theory_figures.py`.

Each figure has the name of its section. Fields, forces and restitutions are computed by
the solvers.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

import rodimpact as ri
from rodimpact.plot.panels import add_grid, format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

FOLDER = Path(__file__).parent / "figures"
STEEL = ri.materials.steel
AREA = 1e-4  # m^2
C = STEEL.wave_speed
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)  # bar speed 1
BLUE, ORANGE, GREY = SERIES[:3]
BLACK = "#1a1a1a"
SHORT = 0.4  # length of the short rod over that of the long one
CELLS = (25, 50, 100, 200, 400)  # of grids whose errors are shown
ROUND_OFF = 1e-16  # added to errors, so that an error of 0 has a logarithm


def steel_pair(l1: float | np.ndarray, l2: float, *contacts: ri.Hertz) -> ri.System:
    """Two steel rods of these lengths, the first at 1 m/s."""
    first = ri.Rod(l1, area=AREA, material=STEEL, velocity=1.0)
    second = ri.Rod(l2, area=AREA, material=STEEL)
    return ri.System([first, second], contacts=contacts or None)


def draw_arrow(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], colour: str
) -> None:
    """An arrow from one point to another."""
    style = {
        "arrowstyle": "-|>",
        "linewidth": 1.2,
        "shrinkA": 0,
        "shrinkB": 0,
        "color": colour,
    }
    ax.annotate("", end, start, arrowprops=style)


def new_panel(width: float, height: float) -> Axes:
    """Formatted Axes of a new figure."""
    ax = new_figure(width, height).add_subplot()
    format_axes(ax)
    return ax


def new_panels(rows: int, columns: int, width: float, height: float) -> list[Axes]:
    """Formatted Axes of a new figure, in reading order."""
    figure = new_figure(width, height)
    panels = np.ravel(figure.subplots(rows, columns)).tolist()
    for ax in panels:
        format_axes(ax)
    return panels


def pulse(x: np.ndarray) -> np.ndarray:
    """A smooth pulse of height 1 and width 0.4 around 0."""
    height = np.cos(np.pi * x / 0.4) ** 2
    return np.where(np.abs(x) < 0.2, height, 0.0)


@styled
def signs() -> Axes:
    """A slice of a rod: axis, velocity, and stress in tension."""
    ax = new_figure(5.2, 1.9).add_subplot()
    ax.fill_between([0.0, 1.0], -0.5, 0.5, color=FAINT, alpha=0.25)
    ax.fill_between([0.4, 0.6], -0.5, 0.5, color=BLUE, alpha=0.35)
    draw_arrow(ax, (0.4, 0.0), (0.26, 0.0), ORANGE)
    draw_arrow(ax, (0.6, 0.0), (0.74, 0.0), ORANGE)
    draw_arrow(ax, (0.42, 0.68), (0.58, 0.68), BLUE)
    draw_arrow(ax, (0.0, -0.85), (1.0, -0.85), GREY)
    ax.text(0.24, 0.0, "σ A", ha="right", va="center", color=ORANGE)
    ax.text(0.76, 0.0, "(σ + dσ) A", va="center", color=ORANGE)
    ax.text(0.5, 0.85, "velocity v = ∂u/∂t", ha="center", color=BLUE)
    ax.text(0.5, 0.0, "ρ A dx", ha="center", va="center")
    ax.text(1.01, -0.85, "x", va="center", color=GREY)
    ax.text(0.5, -0.68, "dx", ha="center", va="center")
    ax.set(xlim=(-0.02, 1.06), ylim=(-1.0, 1.1))
    ax.axis("off")
    return ax


@styled
def waves() -> Axes:
    """A disturbance at rest splits into two waves."""
    rod = ri.Rod(2.0, area=1.0, material=UNIT, velocity=lambda x: pulse(x - 1.0))
    solution = ri.solve(ri.System([rod]), until=0.7)
    x = np.linspace(0, 2, 401)
    axes = new_panels(3, 1, 5.2, 3.4)
    times = (0.0, 0.15, 0.5)
    for ax, t in zip(axes, times, strict=True):
        rightward = pulse(x - 1 - t) / 2
        leftward = pulse(x - 1 + t) / 2
        velocity = solution.velocity(0, x, t)
        ax.plot(x, rightward, color=BLUE, linestyle=DASHES[1], linewidth=1.0)
        ax.plot(x, leftward, color=ORANGE, linestyle=DASHES[1], linewidth=1.0)
        ax.plot(x, velocity, color=BLACK, linewidth=1.4)
        ax.set_title(f"t = {t:g} L/c", loc="left", fontsize=8, pad=2)
        ax.set(ylim=(-0.05, 1.1), xlim=(0, 2), yticks=[0, 1], ylabel="v")
        ax.tick_params(labelbottom=ax is axes[-1])
    last = axes[-1]
    draw_arrow(last, (1.55, 0.75), (1.8, 0.75), BLUE)
    draw_arrow(last, (0.45, 0.75), (0.2, 0.75), ORANGE)
    last.text(1.52, 0.75, "a/2 runs right", ha="right", va="center", color=BLUE)
    last.text(0.48, 0.75, "b/2 runs left", va="center", color=ORANGE)
    last.set_xlabel("x/L")
    return axes[0]


def solve_reflection(end: ri.Free | ri.Fixed) -> ri.Solution:
    """A pulse of pressure runs right to the end of a rod."""
    rod = ri.Rod(
        1.0,
        area=1.0,
        material=UNIT,
        velocity=lambda x: pulse(x - 0.6),
        strain=lambda x: -pulse(x - 0.6),
    )
    system = ri.System([rod], ends=[ri.Absorbing(), end])
    return ri.solve(system, until=0.9)


def draw_reflection(ax: Axes, field: Callable[..., np.ndarray], letter: str) -> None:
    """A field along the rod before and after the reflection."""
    x = np.linspace(0, 1, 401)
    ax.plot(x, field(0, x, 0.0), color=BLUE, linestyle="-", label="before")
    ax.plot(x, field(0, x, 0.8), color=ORANGE, linestyle="--", label="after")
    ax.set(ylim=(-1.2, 1.2), yticks=[-1, 0, 1], xlim=(0, 1.02), ylabel=letter)


def draw_end(velocity_ax: Axes, stress_ax: Axes, end: ri.Free | ri.Fixed) -> None:
    """Velocity above, stress below; the end is a line, broad for a fixed end."""
    solution = solve_reflection(end)
    linewidth = 1
    if end == ri.Fixed():
        linewidth = 4
    draw_reflection(velocity_ax, solution.velocity, "v")
    draw_reflection(stress_ax, solution.stress, "σ")
    for ax in (velocity_ax, stress_ax):
        ax.axvline(1.0, color=FAINT, linewidth=linewidth)
    velocity_ax.tick_params(labelbottom=False)
    stress_ax.tick_params(labelbottom=True)
    stress_ax.set_xlabel("x/L")


@styled
def ends() -> Axes:
    """A pulse of pressure before and after its reflection at a free and a fixed end."""
    axes = new_panels(2, 2, 5.8, 3.2)
    free_velocity, fixed_velocity, free_stress, fixed_stress = axes
    draw_end(free_velocity, free_stress, ri.Free())
    draw_end(fixed_velocity, fixed_stress, ri.Fixed())
    free_velocity.set_title("free end")
    fixed_velocity.set_title("fixed end")
    free_velocity.legend(loc="lower left", frameon=False, fontsize=8)
    return free_velocity


@styled
def contact() -> Axes:
    """Force over gap of a rigid contact, and of a compliant one."""
    ax = new_panel(4.4, 2.6)
    ax.plot(
        [0, 0, 2],
        [2, 0, 0],
        color=BLUE,
        linewidth=2.5,
        label="rigid: g ≥ 0, F ≥ 0, F g = 0",
    )
    overlap = np.linspace(0, 1.5, 100)
    force = overlap**1.5
    ax.plot(-overlap, force, color=ORANGE, linestyle="--", label="Hertz: F = k δ³ᐟ²")
    ax.text(1.0, 0.08, "open: no force", ha="center")
    ax.text(0.06, 0.9, "closed:\nforce as needed")
    ax.set(
        xlabel="gap g = −δ, with the overlap δ",
        ylabel="contact force F",
        xlim=(-1.5, 2),
        ylim=(-0.15, 2.0),
        xticks=[0],
        yticks=[0],
    )
    ax.legend(loc="upper right", frameon=False, fontsize=8)
    return ax


def spacetime(l1: float, l2: float, title: str) -> Axes:
    """Space-time diagram of two rods."""
    ax = new_figure(5.2, 3.4).add_subplot()
    diagram = ri.plot.spacetime(ri.solve(steel_pair(l1, l2)), ax=ax)
    diagram.colour_bar.remove()  # velocities stand in the regions
    ax.set_title(title, pad=22)
    return ax


@styled
def box_short() -> Axes:
    """A short rod hits a long one."""
    return spacetime(SHORT, 1.0, "ℓ₁ < ℓ₂")


@styled
def box_long() -> Axes:
    """A long rod hits a short one."""
    return spacetime(1.0, SHORT, "ℓ₁ > ℓ₂")


def draw_impulse(ax: Axes, l1: float, l2: float, title: str) -> None:
    """Mean velocities of both rods before and while they press."""
    solution = ri.solve(steel_pair(l1, l2))
    force_duration = 2 * min(l1, l2) / C
    times = np.array([0, 1, 2]) * force_duration
    places = [-0.3, 0, 1, 2]  # of these times, and of one before the contact
    first = [1.0, *solution.mean_velocity(0, times)]
    second = [0.0, *solution.mean_velocity(1, times)]
    ax.plot(places, first, color=BLUE, linestyle="-", label="rod 1")
    ax.plot(places, second, color=ORANGE, linestyle="--", label="rod 2")
    ax.axvspan(0, 1, color=FAINT, alpha=0.15)
    ax.set(xlabel="t c/(2 ℓ)", title=title, ylim=(-0.05, 1.1))


@styled
def impulse() -> Axes:
    """Mean velocities of both rods while they press, for both orders of the lengths."""
    left, right = new_panels(1, 2, 5.6, 2.6)
    draw_impulse(left, SHORT, 1.0, "ℓ₁ < ℓ₂")
    draw_impulse(right, 1.0, SHORT, "ℓ₁ > ℓ₂")
    left.set_ylabel("mean velocity over v")
    left.legend(frameon=False, fontsize=8)
    return left


@styled
def balance() -> Axes:
    """Where the energy is after the collision, over the ratio of lengths."""
    ratio = np.linspace(0.05, 3, 60)
    result = ri.sweep(steel_pair(ratio, 1.0))
    V1, V2 = result.velocities_after
    m1 = ratio  # in units of rod 2
    m2 = 1.0
    before = m1 / 2
    common = m1**2 / (2 * (m1 + m2))  # energy of the common centre of mass
    relative = (m1 * V1**2 + m2 * V2**2) / 2 - common
    vibration = before - common - relative
    shares = np.array([common, relative, vibration]) / before

    ax = new_panel(5.2, 2.8)
    ax.stackplot(ratio, shares, colors=[FAINT, BLUE, ORANGE], alpha=0.6)
    ax.text(2.0, 0.3, "common centre of mass", ha="center")
    ax.text(1.0, 0.66, "relative\nmotion", ha="center", va="center")
    ax.text(2.3, 0.88, "vibration", ha="center", va="center")
    ax.text(0.35, 0.8, "vibration", ha="center", va="center")
    ax.set(xlabel="ℓ₁/ℓ₂", ylabel="share of the energy", xlim=(0.05, 3), ylim=(0, 1))
    return ax


@styled
def impedances() -> Axes:
    """Contact force in time, and e over transit times, by ratio of impedances."""
    force_ax, restitution_ax = new_panels(1, 2, 5.8, 2.7)
    t = np.linspace(0, 6.5, 1301)
    ratio = np.geomspace(0.1, 1, 300)
    for i, Z in enumerate((0.5, 1.0, 2.0)):
        style = {"color": SERIES[i], "linestyle": DASHES[i]}
        force = ri.theory.saint_venant_force(t, Z, 1.0, 1.0, 3.0)
        e = ri.theory.saint_venant(Z, ratio, 1.0, 1.0).restitution
        force_ax.plot(t / 2, force / Z, **style)
        restitution_ax.plot(ratio, e, label=f"Z/Z′ = {Z:g}", **style)
    force_ax.set(xlabel="t/(2 T)", ylabel="contact force over Z v", title="T′ = 3 T")
    restitution_ax.set(xlabel="T/T′", ylabel="e", ylim=(0, 1.05))
    restitution_ax.legend(frameon=False, fontsize=8)
    add_grid(force_ax)
    add_grid(restitution_ax)
    return force_ax


def restitution_over_stiffness(length: float, kappas: np.ndarray) -> np.ndarray:
    """e of a rod of this length on a rod of length 1, both with rounded ends."""
    first = ri.Rod(length, area=1.0, material=UNIT, velocity=1.0)
    second = ri.Rod(1.0, area=1.0, material=UNIT)
    family = ri.System([first, second], contacts=[ri.Hertz(kappas)])
    return ri.sweep(family, rtol=1e-5).restitution


@styled
def kappa() -> Axes:
    """e of rods with rounded ends, over the dimensionless stiffness."""
    ax = new_panel(5.2, 3.0)
    kappas = np.geomspace(1e-2, 1e5, 57)
    for i, length in enumerate((SHORT, 0.7)):
        colour = SERIES[i]
        e = restitution_over_stiffness(length, kappas)
        label = f"ℓ₁/ℓ₂ = {length}"
        ax.plot(kappas, e, color=colour, linestyle=DASHES[i], label=label)
        ax.axhline(length, color=colour, linestyle=":", linewidth=0.8)
    ax.set(
        xlabel="κ = k (v ℓ₂/c)$^{1/2}$ ℓ₂/(E A)",
        xscale="log",
        ylim=(0, 1.05),
        ylabel="e",
    )
    ax.text(1.2e-2, 0.9, "soft, round ends:\nas rigid balls", va="top")
    ax.text(8e4, 0.3, "flat ends: e = ℓ₁/ℓ₂", ha="right")
    ax.legend(frameon=False, fontsize=8)
    add_grid(ax)
    return ax


@styled
def dispersion() -> Axes:
    """Phase velocity in a round bar: the exact first mode and three theories."""
    ax = new_panel(5.2, 3.0)
    nu = 0.29
    ratio = np.linspace(0.005, 0.6, 120)
    k = 2 * np.pi * ratio  # for radius 1
    slow_branch, _ = ri.waves.mindlin_herrmann(ratio, nu)
    curves = {
        "exact first mode": ri.waves.first_mode(ratio, nu),
        "Mindlin and Herrmann": slow_branch,
        "Rayleigh and Love": ri.theory.rayleigh_love_speed(1.0, nu, np.sqrt(0.5), k),
        "wave equation": np.ones(ratio.size),
    }
    for i, label in enumerate(curves):
        speed = curves[label]
        ax.plot(ratio, speed, color=SERIES[i], linestyle=DASHES[i], label=label)
    ax.set(
        xlabel="radius over wavelength",
        ylabel="phase velocity over c",
        ylim=(0.55, 1.05),
        xlim=(0, 0.6),
    )
    ax.legend(frameon=False, fontsize=8)
    add_grid(ax)
    return ax


def draw_errors_over_tolerance(ax: Axes, system: ri.System, exact: float) -> None:
    """True and stated error of e by characteristics, over the tolerance."""
    tolerances = np.geomspace(1e-3, 1e-9, 7)
    true_errors = []
    stated_errors = []
    for rtol in tolerances.tolist():
        solution = ri.solve(system, rtol=rtol)
        error = solution.outcome.restitution - exact
        true_errors.append(abs(error))
        stated_errors.append(solution.accuracy["velocity"])
    ax.loglog(tolerances, true_errors, "o", color=BLUE, label="true error")
    ax.loglog(tolerances, stated_errors, color=ORANGE, label="stated error")
    ax.set(xlabel="tolerance rtol", ylabel="error of e")
    ax.set_title("characteristics, Hertz contact")


def grid_errors(system: ri.System, exact: float) -> list[float]:
    """Errors of e by finite differences, one a number of cells."""
    grid_error = []
    for cells in CELLS:
        solution = ri.solve(system, method="finite-difference", cells=cells)
        error = solution.outcome.restitution - exact
        grid_error.append(abs(error) + ROUND_OFF)
    return grid_error


@styled
def errors() -> Axes:
    """Error of e: characteristics over the tolerance, the grid over its cells."""
    hertz = steel_pair(SHORT, 1.0, ri.Hertz(1e10))
    exact = ri.solve(hertz, rtol=1e-12).outcome.restitution
    by_tolerance, by_cells = new_panels(1, 2, 5.8, 2.7)
    draw_errors_over_tolerance(by_tolerance, hertz, exact)
    curves = {
        "Hertz contact": grid_errors(hertz, exact),
        "flat ends": grid_errors(steel_pair(SHORT, 1.0), SHORT),
    }
    for i, label in enumerate(curves):
        by_cells.loglog(
            CELLS,
            curves[label],
            color=SERIES[i],
            marker="o",
            linestyle=DASHES[i],
            label=label,
        )
    by_cells.set(xlabel="cells along rod 2", title="finite-difference")
    by_cells.set_xticks(CELLS, CELLS)
    for ax in (by_tolerance, by_cells):
        ax.minorticks_off()
        ax.legend(frameon=False, fontsize=8)
        add_grid(ax)
    return by_tolerance


FIGURES = (
    signs,
    waves,
    ends,
    contact,
    box_short,
    box_long,
    impulse,
    balance,
    impedances,
    kappa,
    dispersion,
    errors,
)


def main() -> None:
    """Draw every figure."""
    for draw in FIGURES:
        path = FOLDER / f"theory_{draw.__name__}.svg"
        ri.plot.save(draw().figure, path, force=True)
        kilobytes = path.stat().st_size / 1e3
        print(f"{kilobytes:6.1f} kB  {path.name}")  # noqa: T201


if __name__ == "__main__":
    main()
