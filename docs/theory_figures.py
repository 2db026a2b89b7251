"""The figures of the theory page, drawn anew: `python docs/theory_figures.py`.

Each is named after its section. What a solver can compute is computed, not sketched.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

import rodimpact as ri
from rodimpact.plot.panels import add_grid, format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, styled

FOLDER = Path(__file__).parent / "figures"
STEEL, AREA = ri.materials.steel, 1e-4
C = STEEL.wave_speed
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)  # bar speed 1
BLUE, ORANGE, GREY = SERIES[:3]
SOFT = {"arrowstyle": "-|>", "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}


def rods(l1: float | np.ndarray, l2: float, *contacts: ri.Hertz) -> ri.System:
    """Two steel rods, the first at 1 m/s."""
    pair = [
        ri.Rod(l1, area=AREA, material=STEEL, velocity=1.0),
        ri.Rod(l2, area=AREA, material=STEEL),
    ]
    return ri.System(pair, contacts=contacts or None)


def arrow(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], colour: str
) -> None:
    """An arrow from a place to another."""
    ax.annotate("", end, start, arrowprops={**SOFT, "color": colour})


def panels(rows: int, columns: int, width: float, height: float) -> list[Axes]:
    """Dressed Axes in reading order."""
    found = np.ravel(new_figure(width, height).subplots(rows, columns)).tolist()
    for ax in found:
        format_axes(ax)
    return found


def bump(x: np.ndarray) -> np.ndarray:
    """A smooth pulse of height 1 and width 0.4 about 0."""
    return np.where(np.abs(x) < 0.2, np.cos(np.pi * x / 0.4) ** 2, 0.0)


@styled
def signs() -> Axes:
    """A slice of a rod: axis, velocity, and stress in tension."""
    ax = new_figure(5.2, 1.9).add_subplot()
    ax.fill_between([0.0, 1.0], -0.5, 0.5, color=FAINT, alpha=0.25)
    ax.fill_between([0.4, 0.6], -0.5, 0.5, color=BLUE, alpha=0.35)
    for start, end in (((0.4, 0.0), (0.26, 0.0)), ((0.6, 0.0), (0.74, 0.0))):
        arrow(ax, start, end, ORANGE)
    arrow(ax, (0.42, 0.68), (0.58, 0.68), BLUE)
    arrow(ax, (0.0, -0.85), (1.0, -0.85), GREY)
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
    rod = ri.Rod(2.0, area=1.0, material=UNIT, velocity=lambda x: bump(x - 1.0))
    run = ri.solve(ri.System([rod]), until=0.7)
    x = np.linspace(0, 2, 401)
    axes = panels(3, 1, 5.2, 3.4)
    for ax, t in zip(axes, (0.0, 0.15, 0.5), strict=True):
        ax.plot(x, bump(x - 1 - t) / 2, color=BLUE, linestyle=DASHES[1], linewidth=1.0)
        ax.plot(
            x, bump(x - 1 + t) / 2, color=ORANGE, linestyle=DASHES[1], linewidth=1.0
        )
        ax.plot(x, run.velocity(0, x, t), color="#1a1a1a", linewidth=1.4)
        ax.set_title(f"t = {t:g} L/c", loc="left", fontsize=8, pad=2)
        ax.set(ylim=(-0.05, 1.1), xlim=(0, 2), yticks=[0, 1], ylabel="v")
        ax.tick_params(labelbottom=ax is axes[-1])
    arrow(axes[2], (1.55, 0.75), (1.8, 0.75), BLUE)
    arrow(axes[2], (0.45, 0.75), (0.2, 0.75), ORANGE)
    axes[2].text(1.52, 0.75, "a/2 runs right", ha="right", va="center", color=BLUE)
    axes[2].text(0.48, 0.75, "b/2 runs left", va="center", color=ORANGE)
    axes[2].set_xlabel("x/L")
    return axes[0]


@styled
def ends() -> Axes:
    """A pulse of pressure before and after a free and a fixed end, beside both at once."""
    x = np.linspace(0, 1, 401)
    axes = panels(2, 2, 5.8, 3.2)
    for column, (end, words) in enumerate(
        ((ri.Free(), "free end"), (ri.Fixed(), "fixed end"))
    ):
        rod = ri.Rod(
            1.0,
            area=1.0,
            material=UNIT,
            velocity=lambda x: bump(x - 0.6),
            strain=lambda x: -bump(x - 0.6),
        )
        run = ri.solve(ri.System([rod], ends=[ri.Absorbing(), end]), until=0.9)
        for row, (field, letter) in enumerate(((run.velocity, "v"), (run.stress, "σ"))):
            ax = axes[2 * row + column]
            for t, colour, dash in ((0.0, BLUE, "-"), (0.8, ORANGE, "--")):
                ax.plot(
                    x,
                    field(0, x, t),
                    color=colour,
                    linestyle=dash,
                    label="before" if t == 0 else "after",
                )
            ax.axvline(1.0, color=FAINT, linewidth=4 if end == ri.Fixed() else 1)
            ax.set(ylim=(-1.2, 1.2), yticks=[-1, 0, 1], xlim=(0, 1.02), ylabel=letter)
            ax.tick_params(labelbottom=row == 1)
        axes[column].set_title(words)
        axes[2 + column].set_xlabel("x/L")
    axes[0].legend(loc="lower left", frameon=False, fontsize=8)
    return axes[0]


@styled
def contact() -> Axes:
    """Force over gap of a rigid contact, and of a compliant one."""
    ax = new_figure(4.4, 2.6).add_subplot()
    format_axes(ax)
    overlap = np.linspace(0, 1.5, 100)
    ax.plot(
        [0, 0, 2],
        [2, 0, 0],
        color=BLUE,
        linewidth=2.5,
        label="rigid: g ≥ 0, F ≥ 0, F g = 0",
    )
    ax.plot(
        -overlap, overlap**1.5, color=ORANGE, linestyle="--", label="Hertz: F = k d³ᐟ²"
    )
    ax.text(1.0, 0.08, "open: no force", ha="center")
    ax.text(0.06, 0.9, "closed:\nforce as needed")
    ax.set(
        xlabel="gap g = −d, d the overlap",
        ylabel="contact force F",
        xlim=(-1.5, 2),
        ylim=(-0.15, 2.0),
        xticks=[0],
        yticks=[0],
    )
    ax.legend(loc="upper right", frameon=False, fontsize=8)
    return ax


def spacetime(l1: float, l2: float, words: str) -> Axes:
    """Space-time diagram of two rods."""
    ax = new_figure(5.2, 3.4).add_subplot()
    ri.plot.spacetime(
        ri.solve(rods(l1, l2)), ax=ax
    ).colour_bar.remove()  # numbers are in place
    ax.set_title(words, pad=22)
    return ax


@styled
def box_short() -> Axes:
    """A short rod hits a long one."""
    return spacetime(0.4, 1.0, "ℓ₁ < ℓ₂")


@styled
def box_long() -> Axes:
    """A long rod hits a short one."""
    return spacetime(1.0, 0.4, "ℓ₁ > ℓ₂")


@styled
def impulse() -> Axes:
    """Mean velocities of both rods while they press, for both orders of the lengths."""
    axes = panels(1, 2, 5.6, 2.6)
    for ax, (l1, l2), words in zip(
        axes, ((0.4, 1.0), (1.0, 0.4)), ("ℓ₁ < ℓ₂", "ℓ₁ > ℓ₂"), strict=True
    ):
        run = ri.solve(rods(l1, l2))
        pressing = 2 * min(l1, l2) / C
        times = np.array([0, 1, 2]) * pressing
        for body, colour, dash in ((0, BLUE, "-"), (1, ORANGE, "--")):
            v = [1.0 - body, *run.mean_velocity(body, times)]
            ax.plot(
                [-0.3, 0, 1, 2],
                v,
                color=colour,
                linestyle=dash,
                label=f"rod {body + 1}",
            )
        ax.axvspan(0, 1, color=FAINT, alpha=0.15)
        ax.set(xlabel="t c/(2 ℓ)", title=words, ylim=(-0.05, 1.1))
    axes[0].set_ylabel("mean velocity over v")
    axes[0].legend(frameon=False, fontsize=8)
    return axes[0]


@styled
def balance() -> Axes:
    """Where the energy is after the collision, over the ratio of lengths."""
    ax = new_figure(5.2, 2.8).add_subplot()
    format_axes(ax)
    ratio = np.linspace(0.05, 3, 60)
    family = ri.sweep(rods(ratio, 1.0))
    m1, m2 = ratio, 1.0  # in units of rod 2
    before = m1 / 2
    V1, V2 = family.velocities_after
    together = m1**2 / (2 * (m1 + m2))
    rebound = (m1 * V1**2 + m2 * V2**2) / 2 - together
    ax.stackplot(
        ratio,
        np.array([together, rebound, before - together - rebound]) / before,
        colors=[FAINT, BLUE, ORANGE],
        alpha=0.6,
    )
    ax.text(2.0, 0.3, "common centre of mass", ha="center")
    ax.text(1.0, 0.66, "relative\nmotion", ha="center", va="center")
    ax.text(2.3, 0.88, "vibration", ha="center", va="center")
    ax.text(0.35, 0.8, "vibration", ha="center", va="center")
    ax.set(xlabel="ℓ₁/ℓ₂", ylabel="share of the energy", xlim=(0.05, 3), ylim=(0, 1))
    return ax


@styled
def impedances() -> Axes:
    """Contact force in time, and e over the ratio of transit times, by ratio of impedances."""
    axes = panels(1, 2, 5.8, 2.7)
    t, ratio = np.linspace(0, 6.5, 1301), np.geomspace(0.1, 1, 300)
    for i, Z in enumerate((0.5, 1.0, 2.0)):
        style = {"color": SERIES[i], "linestyle": DASHES[i]}
        F = ri.theory.saint_venant_force(t, Z, 1.0, 1.0, 3.0)
        axes[0].plot(t / 2, F / Z, **style)
        e = ri.theory.saint_venant(Z, ratio, 1.0, 1.0).restitution
        axes[1].plot(ratio, e, label=f"Z/Z′ = {Z:g}", **style)
    axes[0].set(xlabel="t/(2 T)", ylabel="contact force over Z v", title="T′ = 3 T")
    axes[1].set(xlabel="T/T′", ylabel="e", ylim=(0, 1.05))
    axes[1].legend(frameon=False, fontsize=8)
    for ax in axes:
        add_grid(ax)
    return axes[0]


@styled
def kappa() -> Axes:
    """e of rods with rounded ends, over the dimensionless stiffness."""
    ax = new_figure(5.2, 3.0).add_subplot()
    format_axes(ax)
    kappas = np.geomspace(1e-2, 1e5, 57)
    for i, length in enumerate((0.4, 0.7)):
        pair = [
            ri.Rod(length, area=1.0, material=UNIT, velocity=1.0),
            ri.Rod(1.0, area=1.0, material=UNIT),
        ]
        family = ri.sweep(ri.System(pair, contacts=[ri.Hertz(kappas)]), rtol=1e-5)
        ax.plot(
            kappas,
            family.restitution,
            color=SERIES[i],
            linestyle=DASHES[i],
            label=f"ℓ₁/ℓ₂ = {length}",
        )
        ax.axhline(length, color=SERIES[i], linestyle=":", linewidth=0.8)
    ax.set(
        xlabel="κ = k (v T)$^{1/2}$ ℓ₂/(E A)", xscale="log", ylim=(0, 1.05), ylabel="e"
    )
    ax.text(1.2e-2, 0.9, "soft, round ends:\nas rigid balls", va="top")
    ax.text(8e4, 0.3, "flat ends: e = ℓ₁/ℓ₂", ha="right")
    ax.legend(frameon=False, fontsize=8)
    add_grid(ax)
    return ax


@styled
def dispersion() -> Axes:
    """Phase velocity in a round bar: the exact first mode and three theories."""
    ax = new_figure(5.2, 3.0).add_subplot()
    format_axes(ax)
    nu, ratio = 0.29, np.linspace(0.005, 0.6, 120)
    k = 2 * np.pi * ratio  # for radius 1
    curves = {
        "exact first mode": ri.waves.first_mode(ratio, nu),
        "Mindlin and Herrmann": ri.waves.mindlin_herrmann(ratio, nu)[0],
        "Rayleigh and Love": ri.theory.rayleigh_love_speed(1.0, nu, np.sqrt(0.5), k),
        "wave equation": np.ones(ratio.size),
    }
    for i, (words, speed) in enumerate(curves.items()):
        ax.plot(ratio, speed, color=SERIES[i], linestyle=DASHES[i], label=words)
    ax.set(
        xlabel="radius over wavelength",
        ylabel="phase velocity over c",
        ylim=(0.55, 1.05),
        xlim=(0, 0.6),
    )
    ax.legend(frameon=False, fontsize=8)
    add_grid(ax)
    return ax


@styled
def errors() -> Axes:
    """Error of e: pieces over the tolerance asked for, the grid over its cells."""
    axes = panels(1, 2, 5.8, 2.7)
    hertz = rods(0.4, 1.0, ri.Hertz(1e10))
    best = ri.solve(hertz, rtol=1e-12).outcome.restitution
    tolerances = np.geomspace(1e-3, 1e-9, 7)
    runs = [ri.solve(hertz, rtol=float(rtol)) for rtol in tolerances]
    axes[0].loglog(
        tolerances,
        [abs(run.outcome.restitution - best) for run in runs],
        "o",
        color=BLUE,
        label="true error",
    )
    axes[0].loglog(
        tolerances,
        [run.accuracy["velocity"] for run in runs],
        color=ORANGE,
        label="stated error",
    )
    axes[0].set(
        xlabel="tolerance rtol", ylabel="error of e", title="pieces, Hertz contact"
    )
    cells = np.array([25, 50, 100, 200, 400])
    for i, (system, exact, words) in enumerate(
        ((hertz, best, "Hertz contact"), (rods(0.4, 1.0), 0.4, "flat ends"))
    ):
        e = [
            ri.solve(
                system, method="finite-difference", cells=int(n)
            ).outcome.restitution
            for n in cells
        ]
        axes[1].loglog(
            cells,
            np.abs(np.array(e) - exact) + 1e-16,
            color=SERIES[i],
            marker="o",
            linestyle=DASHES[i],
            label=words,
        )
    axes[1].set(xlabel="cells along rod 2", title="grid")
    axes[1].set_xticks(cells, cells)
    for ax in axes:
        ax.minorticks_off()
        ax.legend(frameon=False, fontsize=8)
        add_grid(ax)
    return axes[0]


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
        print(f"{path.stat().st_size / 1e3:6.1f} kB  {path.name}")  # noqa: T201


if __name__ == "__main__":
    main()
