"""Draw the pictures of the manual: `python -m validation.figures`.

They show collisions of equal and unequal rods, e over lengths, areas and stiffnesses of
ends, chains and cradles, and a ring-down. The files are the same in every run with the
same Matplotlib: no dates, no random ids.
"""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

import rodimpact as ri
from rodimpact.plot.panels import format_axes, new_figure
from rodimpact.plot.style import DASHES, FAINT, SERIES, SMALL, styled

from . import damping, hertz_ends
from .length_effects import chain, cradle

FOLDER = Path(__file__).parent / "figures"
STEEL = ri.materials.steel
AREA = 1e-4  # m^2
OTHER_RATIOS = (0.1 / 0.3, 1 / math.e, math.sqrt(0.5))
TICKS = (0.1, 0.2, 0.3, 0.5, 1, 2, 3, 4, 5, 10)  # ticks of ratios in cradles


def rods(*lengths: float) -> list[ri.Rod]:
    """Steel rods of one thickness; the first comes at 1 m/s, the others are at rest."""
    first, *resting = lengths
    row = [ri.Rod(first, area=AREA, material=STEEL, velocity=1.0)]
    for length in resting:
        row.append(ri.Rod(length, area=AREA, material=STEEL))
    return row


def solved(*lengths: float) -> ri.Solution:
    """The collision of rods of these lengths, m, as in `rods`."""
    system = ri.System(rods(*lengths))
    return ri.solve(system)


def restitution() -> Axes:
    """Draw computed e of two steel rods over l1/l2, up to 1, beside the law."""
    ratios = [i / 20 for i in range(1, 21)]
    ratios += OTHER_RATIOS
    restitutions = []
    for ratio in ratios:
        outcome = ri.collide(*rods(ratio, 1.0))
        restitutions.append(outcome.restitution)
    figure = ri.plot.restitution(np.array(ratios), np.array(restitutions))
    return figure.ax


def restitution_over_length() -> Axes:
    """Draw e of two rods of one area over l1/l2, from 0.02 to 4."""
    lengths = np.linspace(0.02, 4, 200)
    first = ri.Rod(lengths, area=AREA, material=STEEL, velocity=1.0)
    second = ri.Rod(1.0, area=AREA, material=STEEL)
    family = ri.System([first, second])
    ax = ri.plot.sweep(ri.sweep(family)).ax
    ax.set_xlabel("ratio of lengths ℓ₁/ℓ₂")
    return ax


def restitution_map() -> Axes:
    """Draw a map of e over the ratios of length and area of two steel rods.

    Both ratios are from 0.1 to 10, 1000 values each.
    """
    ratios = np.geomspace(0.1, 10, 1000)
    length = 1.0  # m
    area = 1e-6  # m^2
    first = ri.Rod(
        length * ratios[:, None], area=area * ratios, material=STEEL, velocity=1.0
    )
    second = ri.Rod(length, area=area, material=STEEL)
    result = ri.sweep(ri.System([first, second]))
    ax = ri.plot.sweep(result).ax
    ax.set_xlabel("ratio of lengths ℓ₁/ℓ₂")
    ax.set_ylabel("ratio of impedances Z₁/Z₂")
    return ax


def contact_episodes() -> Axes:
    """Draw a map of the number of contacts with a rod that has a head.

    The axes are length and area of the head, which a plain rod strikes.
    """
    lengths = np.geomspace(0.01, 1, 400)[:, None]
    areas = np.geomspace(2e-5, 1e-3, 300)
    head = ri.Segment(lengths, areas, STEEL)
    tail = ri.Segment(1.0, 3e-5, STEEL)
    struck = ri.Rod(segments=[head, tail])
    striker = rods(0.3)[0]
    family = ri.System([striker, struck])
    result = ri.sweep(family)
    ax = ri.plot.sweep(result, quantity="episodes.0").ax
    ax.set_xlabel("length of the head (m)\nstriker 0.3 m, 100 mm²; tail 1 m, 30 mm²")
    ax.set_ylabel("area of the head (mm²)")
    return ax


def draw_law(
    ax: Axes, numbers: np.ndarray, law: np.ndarray, values: list[float], colour: str
) -> None:
    """Draw a broad line for a law over 2 to 10 rods, and dots for computed values.

    `law` has 101 values at evenly spaced numbers of rods, `values` one for each of
    `numbers`.
    """
    ax.plot(np.linspace(2, 10, 101), law, color=colour, alpha=0.4, linewidth=5.0)
    ax.plot(numbers, values, color=colour, linestyle="", marker="o", markersize=4.0)


def draw_equal_rods(ax: Axes) -> None:
    """Draw e of chains of equal rods over their number, by law and computed.

    There are two pairs of a line and dots: for e of the first and the last rod, and for
    e of the first rod and the centre of mass of all others.
    """
    numbers = np.arange(2, 11)
    collisions = [chain(n) for n in numbers.tolist()]
    last_rod = [collision.restitution_of_last for collision in collisions]
    all_others = [collision.restitution_of_all for collision in collisions]
    n = np.linspace(2, 10, 101)
    draw_law(ax, numbers, np.ones(n.size), last_rod, SERIES[0])
    ax.text(4.3, 0.93, "first and last rod: e = 1", va="center")
    draw_law(ax, numbers, 1 / (n - 1), all_others, SERIES[1])
    label = (
        "first rod and the centre of\nmass of all others: e = 1/(n \N{MINUS SIGN} 1)"
    )
    ax.text(4.3, 0.4, label, va="center")
    ax.set(
        xlabel="number n of equal rods",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
        xticks=numbers,
    )


def draw_cradle(
    ax: Axes, quantity: str, ratio: np.ndarray, result: ri.SweepResult
) -> None:
    """Draw the velocities after of a cradle over a ratio, on a logarithmic axis.

    `quantity`, "length" or "area", is that of rods 2 to 5 over that of rod 1.
    """
    for i, velocity in enumerate(result.velocities_after):
        ax.plot(
            ratio,
            velocity,
            color=SERIES[i],
            linestyle=DASHES[i],
            linewidth=1.5,
            label=f"rod {i + 1}",
        )
    ax.set(
        xlabel=f"{quantity} of rods 2 to 5 over that of rod 1",
        xscale="log",
        ylabel="velocity after (m/s)",
    )
    ticks = [tick for tick in TICKS if ratio[0] <= tick <= ratio[-1]]
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.xaxis.set_minor_locator(NullLocator())
    ax.legend(loc="upper right", frameon=False, fontsize=SMALL + 1)


@styled
def chains() -> Axes:
    """Draw a panel of chains and two of cradles; return the left Axes."""
    equal, longer, thicker = new_figure(width=10.5, height=3.6).subplots(1, 3)
    draw_equal_rods(equal)
    length_ratio = np.geomspace(0.26, 4, 401)
    draw_cradle(longer, "length", length_ratio, cradle(length=length_ratio))
    area_ratio = np.geomspace(1 / 10, 10, 401)
    draw_cradle(thicker, "area", area_ratio, cradle(area=area_ratio))
    for ax in (equal, longer, thicker):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return equal


def key_times(solution: ri.Solution) -> list[float]:
    """Six times of the stages of a collision of two rods, s.

    They are the start, the wave half-way along the short rod, the wave at its end, the
    end of the force, the opening of the gap, and the end of the run.
    """
    episode = solution.contacts[0].episodes[0]
    force_end = episode.force_end  # after a round trip in the short rod
    end = solution.t_end
    return [0.0, force_end / 4, force_end / 2, force_end, episode.opening, end]


def main() -> None:
    """Draw every picture and the film, and write them as files.

    Existing files are replaced; a line with the size of each figure is printed.
    """
    FOLDER.mkdir(exist_ok=True)
    unequal = solved(0.4, 1.0)
    equal = solved(1.0, 1.0)
    five = solved(0.2, 0.2, 0.2, 0.2, 0.2)
    stages = ri.plot.snapshots(unequal, times=key_times(unequal))
    pictures = {
        "unequal_rods": ri.plot.spacetime(unequal).ax,
        "unequal_rods_stages": stages.ax,
        "unequal_rods_contact": ri.plot.contact(unequal).force_ax,
        "unequal_rods_energy": ri.plot.energy(unequal).ax,
        "equal_rods": ri.plot.spacetime(equal).ax,
        "cradle": ri.plot.spacetime(five).ax,
        "restitution": restitution(),
        "restitution_over_length": restitution_over_length(),
        "restitution_map": restitution_map(),
        "contact_episodes": contact_episodes(),
        "chains": chains(),
        "hertz_ends": hertz_ends.draw(),
        "ring_down": damping.draw(),
    }
    for name, ax in pictures.items():
        path = FOLDER / f"{name}.svg"
        ri.plot.save(ax.figure, path, force=True)
        kilobytes = path.stat().st_size / 1e3
        print(f"{kilobytes:6.1f} kB  {path}")
    with ri.plot.look(width=170):  # mm
        film = ri.plot.animation(unequal, frames=60, fps=20)
    film.save(FOLDER / "unequal_rods.gif", force=True)


if __name__ == "__main__":
    main()
