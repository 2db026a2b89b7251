"""The pictures of the README, drawn anew: `python -m validation.figures`.

The files are the same in every run with the same matplotlib: no dates, no random ids.
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
STEEL, AREA = ri.materials.steel, 1e-4


def rods(*lengths: float) -> list[ri.Rod]:
    """Steel rods of one thickness; the first comes at 1 m/s, the others are at rest."""
    return [
        ri.Rod(length, area=AREA, material=STEEL, velocity=0.0 if i else 1.0)
        for i, length in enumerate(lengths)
    ]


def restitution_of_lengths() -> tuple[list[float], list[float]]:
    """Ratios of lengths, simple and not, and the e that comes out."""
    ratios = [*(i / 20 for i in range(1, 21)), 0.1 / 0.3, 1 / math.e, math.sqrt(0.5)]
    return ratios, [ri.collide(*rods(ratio, 1.0)).restitution for ratio in ratios]


def restitution_over_length() -> Axes:
    """e of two rods of one material and thickness, the first from much shorter to much longer."""
    rod = ri.Rod(np.linspace(0.02, 4, 200), area=AREA, material=STEEL, velocity=1.0)
    ax = ri.plot.sweep(ri.sweep(ri.System([rod, *rods(0.4, 1.0)[1:]]))).ax
    ax.set_xlabel("ratio of lengths ℓ₁/ℓ₂")
    return ax


def restitution_map() -> Axes:
    """e of two rods of one material, a million pairs."""
    ratios, metre, square = np.geomspace(0.1, 10, 1000), 1.0, 1e-6
    first = ri.Rod(
        metre * ratios[:, None], area=square * ratios, material=STEEL, velocity=1.0
    )
    second = ri.Rod(metre, area=square, material=STEEL)
    ax = ri.plot.sweep(ri.sweep(ri.System([first, second]))).ax
    ax.set_xlabel("ratio of lengths ℓ₁/ℓ₂")
    ax.set_ylabel("ratio of impedances Z₁/Z₂")
    return ax


def contact_episodes() -> Axes:
    """Contacts of a rod that strikes another one's head, over length and area of the head."""
    head = ri.Segment(
        np.geomspace(0.01, 1, 400)[:, None], np.geomspace(2e-5, 1e-3, 300), STEEL
    )
    struck = ri.Rod(segments=[head, ri.Segment(1.0, 3e-5, STEEL)])
    ax = ri.plot.sweep(
        ri.sweep(ri.System([*rods(0.3), struck])), quantity="episodes.0"
    ).ax
    ax.set_xlabel("length of the head (m)\nstriker 0.3 m, 100 mm²; tail 1 m, 30 mm²")
    ax.set_ylabel("area of the head (mm²)")
    return ax


@styled
def chains() -> Axes:
    """Restitution of chains of equal rods, and where the unequal rods of a cradle go."""
    equal, longer, thicker = new_figure(10.5, 3.6).subplots(1, 3)
    counts, smooth = np.arange(2, 11), np.linspace(2, 10, 101)
    of_all, of_last = np.array([chain(n)[1:] for n in counts.tolist()]).T
    for values, law, colour, words, place in (
        (
            of_last,
            np.ones(smooth.size),
            SERIES[0],
            "first and last rod: e = 1",
            (4.3, 0.93),
        ),
        (
            of_all,
            1 / (smooth - 1),
            SERIES[1],
            "first rod and the centre of\nmass of all others: e = 1/(n \N{MINUS SIGN} 1)",
            (4.3, 0.4),
        ),
    ):
        equal.plot(smooth, law, color=colour, alpha=0.4, linewidth=5.0)
        equal.plot(
            counts, values, color=colour, linestyle="", marker="o", markersize=4.0
        )
        equal.text(*place, words, va="center")
    equal.set(
        xlabel="number n of equal rods",
        ylabel="effective coefficient of restitution e",
        ylim=(0, 1.05),
        xticks=counts,
    )
    for ax, what, last in ((longer, "length", 4), (thicker, "area", 10)):
        ratio = np.geomspace(1 / last if what == "area" else 0.26, last, 401)
        for i, v in enumerate(cradle(**{what: ratio}).velocities_after):
            ax.plot(
                ratio,
                v,
                color=SERIES[i],
                linestyle=DASHES[i],
                linewidth=1.5,
                label=f"rod {i + 1}",
            )
        ticks = [
            x for x in (0.1, 0.2, 0.3, 0.5, 1, 2, 3, 4, 5, 10) if ratio[0] <= x <= last
        ]
        ax.set(
            xlabel=f"{what} of rods 2 to 5 over that of rod 1",
            xscale="log",
            ylabel="velocity after (m/s)",
        )
        ax.set_xticks(ticks, [f"{x:g}" for x in ticks])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.legend(loc="upper right", frameon=False, fontsize=SMALL + 1)
    for ax in (equal, longer, thicker):
        ax.grid(color=FAINT, alpha=0.3, linewidth=0.5)
        format_axes(ax)
    return equal


def key_stages(solution: ri.Solution) -> list[float]:
    """Start, wave half-way, at the end, force ends, gap opens, end."""
    episode = solution.contacts[0].episodes[0]
    return [
        0.0,
        episode.force_end / 4,
        episode.force_end / 2,
        episode.force_end,
        episode.opening,
        solution.t_end,
    ]


def main() -> None:
    """Draw every picture."""
    FOLDER.mkdir(exist_ok=True)
    unequal = ri.solve(ri.System(rods(0.4, 1.0)))
    equal = ri.solve(ri.System(rods(1.0, 1.0)))
    cradle_of_five = ri.solve(ri.System(rods(*[0.2] * 5)))
    pictures = {
        "unequal_rods": ri.plot.spacetime(unequal).ax,
        "unequal_rods_stages": ri.plot.snapshots(unequal, times=key_stages(unequal)).ax,
        "unequal_rods_contact": ri.plot.contact(unequal).force_ax,
        "unequal_rods_energy": ri.plot.energy(unequal).ax,
        "equal_rods": ri.plot.spacetime(equal).ax,
        "cradle": ri.plot.spacetime(cradle_of_five).ax,
        "restitution": ri.plot.restitution(*map(np.array, restitution_of_lengths())).ax,
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
        print(f"{path.stat().st_size / 1e3:6.1f} kB  {path}")
    with ri.plot.look(width=170):
        film = ri.plot.animation(unequal, frames=60, fps=20)
    film.save(FOLDER / "unequal_rods.gif", force=True)


if __name__ == "__main__":
    main()
