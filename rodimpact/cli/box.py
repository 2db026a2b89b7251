"""Replay the textbook's box on the axial collision of elastic rods, in words and figures.

Identical rods, a rod on a rigid wall, and rods of different length: 1 m long and 1 cm^2 thick,
struck at 1 m/s. Then the coefficient of restitution of sixty pairs of rods against the law
e = l1/l2. The figures go to a directory of their own, with a page, index.html, that shows it all.
"""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..materials import TABLE
from ..model import Material, Rod, System, Wall
from ..model.frozen import Problems, raise_noted
from ..results.pair_theory import pair_theory
from ..results.solution import Solution
from ..running.solving import collide, solve
from ..storage.tables import align, as_html, clean
from ..storage.writing import write_text
from ..units import format_si
from . import DONE
from .asking import note, quantity
from .stages import LEGEND, tell

if TYPE_CHECKING:
    from ..plot.style import Colours

KEYS = ("identical", "wall", "unequal", "dowel")
VIEWS = ("velocity", "stress", "stages", "contact", "energy")
PAGE = "index.html"
PAIRS = 60  # length ratios at which e is compared with l1/l2
AREA = 1e-4  # m^2
DOWEL = 0.9144, math.pi / 4 * 0.0127**2  # 3 ft, m, and half an inch thick, m^2
STAGES = 6  # in a figure
STYLE = """\
body { max-width: 64rem; margin: 2rem auto; padding: 0 1rem; font: 1rem/1.5 sans-serif;
       background: %s; color: %s; }
figure { margin: 1.5rem 0; }
img { max-width: 100%%; }
a { color: inherit; }
"""


class Replay(NamedTuple):
    """One collision of the box: what it is called, what its bodies are, and its solution."""

    key: str  # in the names of its figures
    title: str
    names: tuple[str, str]
    solution: Solution


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A ratio of lengths, and where the figures go."""
    parser.add_argument("--ratio", default="0.4", metavar="R",
                        help="l1/l2 of the rods of different length, up to 1; default 0.4")
    parser.add_argument("--material", choices=TABLE, default="steel", metavar="NAME",
                        help="of the rods, from rodimpact materials; default steel")
    parser.add_argument("--dowel", action="store_true",
                        help="also drop a 3-foot wooden dowel on a stone floor")
    parser.add_argument("--format", choices=("png", "svg", "pdf"), default="png",
                        help="of the figures; default png")
    parser.add_argument("--dark", action="store_true", help="light lines on dark paper")
    parser.add_argument("-o", "--output", default="rodimpact-box", metavar="DIR",
                        help="directory of the figures; default ./rodimpact-box")
    parser.add_argument("--force", action="store_true", help="replace existing figures")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Solve, tell, and draw."""
    problems: Problems = []
    ratio = quantity(problems, "--ratio", arguments.ratio, "dimensionless")
    if not problems and not 0 < ratio <= 1:
        message = f"must be above 0 and at most 1, the left rod being the shorter, got {ratio!r}"
        problems.append(("--ratio", message))
    suffix, keys = arguments.format, KEYS if arguments.dowel else KEYS[:-1]
    figures = {key: [f"{key}-{view}.{suffix}" for view in VIEWS] for key in keys}
    figures["restitution"] = [f"restitution.{suffix}"]
    names = [name for group in figures.values() for name in group]
    directory = Path(arguments.output)
    if directory.exists() and not directory.is_dir():
        problems.append(("--output", f"{arguments.output!r} is not a directory; name another"))
    elif not arguments.force and (there := [
            name for name in (*names, PAGE) if (directory / name).exists()]):
        message = f"{directory} holds {', '.join(there)} already"
        problems.append(("--output", f"{message}; give --force to replace them, or name another"))
    raise_noted(problems)
    directory.mkdir(parents=True, exist_ok=True)

    material = TABLE[arguments.material]
    replays = solve_all(ratio, material, keys)
    ratios, struck = [i / PAIRS for i in range(1, PAIRS + 1)], rod(material, 1.0)
    values = [collide(rod(material, r, 1.0), struck).restitution for r in ratios]
    note("drawing")
    draw(replays, ratios, values, [directory / name for name in names], arguments)
    largest = max(abs(e - r) for e, r in zip(values, ratios, strict=True))
    law = (f"Length ratios from {ratios[0]:.3g} to 1\n"
           f"{PAIRS} pairs of rods solved: e agrees with l1/l2 to {largest:.1e}.")
    parts = [(introduction(material), []),
             *((describe(replay), figures[replay.key]) for replay in replays),
             (law, figures["restitution"])]
    write_text(directory / PAGE, box_page(parts, look_of(arguments)), force=arguments.force)
    listed = (f"{len(names)} figures in {directory}, and {PAGE}, which shows them\n"
              + textwrap.fill(", ".join(names), 98, break_on_hyphens=False))
    return "\n\n\n".join([*(text for text, _ in parts), listed]), DONE


def look_of(arguments: argparse.Namespace) -> Colours:
    """Colours of the figures and of their page."""
    from ..plot.style import LOOKS

    return LOOKS["dark" if arguments.dark else "light"]


def rod(material: Material, length: float, velocity: float = 0.0) -> Rod:
    """A rod of the box."""
    return Rod(length, area=AREA, material=material, velocity=velocity)


def solve_all(ratio: float, material: Material, keys: Sequence[str]) -> list[Replay]:
    """Solve these collisions of the box."""
    title, both = f"Rods of different length, l1/l2 = {ratio:g}", ("left rod", "right rod")
    metre, struck = rod(material, 1.0, 1.0), rod(material, 1.0)
    length, area = DOWEL
    wood = Rod(length, area=area, material=TABLE["oak"], velocity=1.0)
    rows: dict[str, tuple[str, tuple[str, str], list[Rod | Wall]]] = {
        "identical": ("Identical rods", both, [metre, struck]),
        "wall": ("A rod on a rigid wall", ("rod", "wall"), [metre, Wall()]),
        "unequal": (title, both, [rod(material, ratio, 1.0), struck]),
        "dowel": ("A wooden dowel, 3 ft long, on a stone floor", ("dowel", "floor"),
                  [wood, Wall()]),
    }
    return [Replay(key, *rows[key][:2], solve(System(rows[key][2]))) for key in keys]


def introduction(material: Material) -> str:
    """What is collided, and how fast that is."""
    trips = 2 / float(material.wave_speed)
    return (
        "The axial collision of elastic rods\n"
        f"Rods of {material.name}, cross-sectional area 1 cm^2, the longest 1 m long. The left rod "
        "comes at v = 1 m/s.\n"
        f"The bar speed is {material.wave_speed:.0f} m/s (3000 to 6000 m/s in metals, not about "
        "1000 m/s). A wave runs twice\n"
        f"along 1 m in {format_si(trips, 's')}, so the collision lasts about {1e3 * trips:.1g} "
        "ms.\n\n"
        "Each line shows the velocity and stress of each uniform piece, from left to right.\n"
        f"{LEGEND}"
    )


def describe(replay: Replay) -> str:
    """The stages of a collision, and its result beside theory."""
    story = tell(replay.solution, replay.names)
    return f"{replay.title}\n\n{story}\n\n{results(replay)}"


def results(replay: Replay) -> str:
    """What the collision did, beside the closed form."""
    o, system = replay.solution.outcome, replay.solution.system
    theory: Any = pair_theory(system)
    theory = theory.collision()
    episode = replay.solution.contacts[0].episodes[0]
    compared = (
        ("contact force lasts", "s", o.duration, theory.duration),
        ("gap opens after", "s", episode.opening - episode.start, theory.opening),
        ("contact force", "N", o.peak_force, theory.peak_force),
        ("energy left in vibration", "J", sum(o.vibration_after), theory.vibration_energy),
    )
    table = align([
        ["", "found", "theory"],
        ["coefficient of restitution e", f"{o.restitution:.9g}", f"{theory.restitution:.9g}"],
        *([name, *(format_si(clean(float(x), o.kinetic_before if unit == "J" else 0.0), unit)
                   for x in numbers)] for name, unit, *numbers in compared),
        *([f"velocity of the {name} afterwards", f"{clean(v, 1.0):.6g} m/s", ""]
          for name, v in zip(replay.names, o.velocities_after, strict=True)),
        ["momentum balance, relative error", f"{abs(o.momentum_residual):.2g}", "0"],
        ["energy balance, relative error", f"{abs(o.energy_residual):.2g}", "0"],
    ])
    trips = [f"of the {name} {'' if i else 'is '}{format_si(2 * float(body.transit_time), 's')}"
             for i, (name, body) in enumerate(zip(replay.names, system.bodies, strict=True))
             if isinstance(body, Rod)]
    remark = f"2 l/c {', '.join(trips)}"
    if episode.opening > episode.force_end:
        remark += (
            f".\nThe force ends after {format_si(o.duration, 's')}. In the textbook the rods part "
            "then. In fact they touch\nwithout force until the wave of the long rod is back; the "
            f"gap opens after {format_si(episode.opening - episode.start, 's')}")
    return f"{table}\n{remark}.\nThe vibration energy is (1 - e^2) m_coll v^2/2."


def draw(
    replays: list[Replay], ratios: list[float], values: list[float], paths: list[Path],
    arguments: argparse.Namespace,
) -> None:
    """Draw every collision, and e against the ratio of lengths."""
    from .. import plot
    from ..plot.moments import moments

    with plot.style.coloured(look_of(arguments)):
        figures: list[Any] = []
        for replay in replays:
            solution = replay.solution
            axes = (
                plot.spacetime(solution, field="velocity").ax,
                plot.spacetime(solution, field="stress").ax,
                plot.snapshots(solution, times=moments(solution, STAGES)).ax,
                plot.contact(solution).force_ax,
                plot.energy(solution).ax,
            )
            for ax in axes:
                ax.set_title(replay.title.replace("l1/l2", "ℓ₁/ℓ₂"), loc="left", pad=18)
            figures += axes
        figures.append(plot.restitution(ratios, values).ax)
        for path, figure in zip(paths, figures, strict=True):
            plot.save(figure, path, force=arguments.force)


def box_page(parts: Sequence[tuple[str, list[str]]], colours: Colours) -> str:
    """Write the page.

    Parameters
    ----------
    parts : sequence of (str, list of str)
        Text, whose first line is a heading, and names of figures, which lie beside the page.
    colours : Colours
        Of paper and letters.

    Returns
    -------
    str
        HTML.
    """
    titles = [escape(text.partition("\n")[0]) for text, _ in parts]
    lines = [
        '<!doctype html>', '<html lang="en">', '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{titles[0]}</title>", f"<style>\n{STYLE % colours[:2]}</style>",
    ]
    for level, title, (text, figures) in zip("1" + "2" * len(parts), titles, parts, strict=False):
        lines += [f"<h{level}>{title}</h{level}>", as_html(text.partition("\n")[2].strip("\n"))]
        lines += [_figure(name, f"{title}: {name.rpartition('.')[0]}") for name in figures]
    return "\n".join([*lines, "</html>", ""])


def _figure(name: str, words: str) -> str:
    """A figure, or a link to one that no page shows."""
    shown = name if name.endswith(".pdf") else f'<img src="{name}" alt="{words}">'
    return f'<figure><a href="{name}">{shown}</a></figure>'
