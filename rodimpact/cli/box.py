"""Replay the textbook's box on the axial collision of elastic rods, in words and figures.

Identical rods, a rod on a rigid wall, and rods of different length: 1 m long and 1 cm^2 thick,
struck at 1 m/s. Then the coefficient of restitution of sixty pairs of rods against the law
e = l1/l2. The figures go to a directory of their own, with a page, index.html, that shows it all.
"""

import argparse
import math
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

from .. import Material, Rod, Solution, System, Wall, collide, solve
from ..materials import TABLE
from ..model.frozen import raise_noted
from ..results.pair_theory import pair_theory
from ..storage.tables import align, as_html, clean
from ..storage.writing import write_text
from ..units import format_si
from . import DONE
from .asking import Given, note, number
from .stages import LEGEND, tell

KEYS = ("identical", "wall", "unequal", "dowel")
VIEWS = ("velocity", "stress", "stages", "contact", "energy")
PAGE = "index.html"
RATIOS = [i / 60 for i in range(1, 61)]  # at which e is compared with l1/l2
AREA = 1e-4  # m^2
DOWEL = 0.9144, math.pi / 4 * 0.0127**2  # 3 ft, m, and half an inch thick, m^2
STAGES = 7  # in a figure
HEAD = """\
<!doctype html>
<html lang="en"><meta charset="utf-8"><title>%s</title>
<style>
body { max-width: 64rem; margin: 2rem auto; font-family: sans-serif; background: %s; color: %s; }
img { max-width: 100%%; }
a { color: inherit; }
</style>"""


class Replay(NamedTuple):
    """A collision of the box: its title, what to call its bodies, and its solution."""

    title: str
    names: tuple[str, str]
    solution: Solution


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A ratio of lengths, and where the figures go."""
    number(
        parser,
        "--ratio",
        "dimensionless",
        "l1/l2 of the rods of different length, up to 1; default 0.4",
        default=0.4,
    )
    parser.add_argument(
        "--material",
        choices=TABLE,
        default="steel",
        metavar="NAME",
        help="of the rods, from rodimpact materials; default steel",
    )
    parser.add_argument(
        "--dowel",
        action="store_true",
        help="also drop a 3-foot wooden dowel on a stone floor",
    )
    parser.add_argument(
        "--format",
        choices=("png", "svg", "pdf"),
        default="png",
        help="of the figures; default png",
    )
    parser.add_argument("--dark", action="store_true", help="light lines on dark paper")
    parser.add_argument(
        "-o",
        "--output",
        default="rodimpact-box",
        metavar="DIR",
        help="directory of the figures; default ./rodimpact-box",
    )
    parser.add_argument("--force", action="store_true", help="replace existing figures")


def run(given: Given) -> tuple[str, int]:
    """Solve, tell, and draw."""
    from .. import plot

    if not 0 < given.ratio <= 1:
        message = "must be above 0 and at most 1, the left rod being the shorter"
        given.note("--ratio", f"{message}, got {given.ratio!r}")
    folder, keys = Path(given.output), KEYS if given.dowel else KEYS[:-1]
    groups = [[f"{key}-{view}.{given.format}" for view in VIEWS] for key in keys]
    groups.append([f"restitution.{given.format}"])
    names = [name for group in groups for name in group]
    there = [name for name in (*names, PAGE) if (folder / name).exists()]
    if folder.exists() and not folder.is_dir():
        given.note("--output", f"{given.output!r} is not a directory; name another")
    elif there and not given.force:
        message = f"{folder} holds {', '.join(there)} already"
        given.note(
            "--output", f"{message}; give --force to replace them, or name another"
        )
    raise_noted(given.problems)
    folder.mkdir(parents=True, exist_ok=True)

    material = TABLE[given.material]
    replays = [
        Replay(title, names, solve(System(bodies)))
        for title, names, bodies in collisions(material, given.ratio)[: len(keys)]
    ]
    struck = rod(material, 1.0)
    values = [collide(rod(material, r, 1.0), struck).restitution for r in RATIOS]
    largest = max(abs(e - r) for e, r in zip(values, RATIOS, strict=True))
    law = (
        f"Length ratios from {RATIOS[0]:.3g} to 1\n"
        f"{len(RATIOS)} pairs of rods solved: e agrees with l1/l2 to {largest:.1e}."
    )
    texts = [introduction(material), *map(describe, replays), law]
    note("drawing")
    with plot.look("dark" if given.dark else "light"):
        draw(replays, values, [folder / name for name in names], given.force)
        page = box_page(texts, [[], *groups])
    write_text(folder / PAGE, page, force=given.force)
    listed = f"{len(names)} figures in {folder}, and {PAGE}, which shows them"
    return "\n\n\n".join([*texts, listed]), DONE


def rod(material: Material, length: float, velocity: float = 0.0) -> Rod:
    """A rod of the box."""
    return Rod(length, area=AREA, material=material, velocity=velocity)


def collisions(material: Material, ratio: float) -> list[tuple[Any, ...]]:
    """Title, names of the bodies, and the bodies of each collision of the box."""
    both = "left rod", "right rod"
    metre, struck = rod(material, 1.0, 1.0), rod(material, 1.0)
    shorter = rod(material, ratio, 1.0)
    dowel = Rod(DOWEL[0], area=DOWEL[1], material=TABLE["oak"], velocity=1.0)
    return [
        ("Identical rods", both, [metre, struck]),
        ("A rod on a rigid wall", ("rod", "wall"), [metre, Wall()]),
        (f"Rods of different length, l1/l2 = {ratio:g}", both, [shorter, struck]),
        (
            "A wooden dowel, 3 ft long, on a stone floor",
            ("dowel", "floor"),
            [dowel, Wall()],
        ),
    ]


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
    """The stages of a collision, and its result beside the closed form."""
    o, system = replay.solution.outcome, replay.solution.system
    theory = pair_theory(system).collision()  # type: ignore[union-attr]
    episode = replay.solution.contacts[0].episodes[0]
    opens = episode.opening - episode.start
    vibration = clean(sum(o.vibration_after), o.kinetic_before)
    rows = [["", "found", "theory"]]
    for what, unit, *numbers in (
        ("coefficient of restitution e", "", o.restitution, theory.restitution),
        ("contact force lasts", "s", o.duration, theory.duration),
        ("gap opens after", "s", opens, theory.opening),
        ("contact force", "N", o.peak_force, theory.peak_force),
        ("energy left in vibration", "J", vibration, theory.vibration_energy),
    ):
        rows.append([what, *(format_si(float(x), unit) for x in numbers)])
    for name, v in zip(replay.names, o.velocities_after, strict=True):
        rows.append(
            [f"velocity of the {name} afterwards", f"{clean(v, 1.0):.6g} m/s", ""]
        )
    rows += [
        ["momentum balance, relative error", f"{abs(o.momentum_residual):.2g}", "0"],
        ["energy balance, relative error", f"{abs(o.energy_residual):.2g}", "0"],
    ]
    trips = [
        f"{format_si(2 * float(body.transit_time), 's')} for the {name}"
        for name, body in zip(replay.names, system.bodies, strict=True)
        if isinstance(body, Rod)
    ]
    remark = f"2 l/c is {' and '.join(trips)}"
    if episode.opening > episode.force_end:
        remark += (
            f".\nThe force ends after {format_si(o.duration, 's')}. In the textbook the rods part "
            "then. In fact they touch\nwithout force until the wave of the long rod is back; the "
            f"gap opens after {format_si(opens, 's')}"
        )
    remark += ".\nThe vibration energy is (1 - e^2) m_coll v^2/2."
    story = tell(replay.solution, replay.names)
    return f"{replay.title}\n\n{story}\n\n{align(rows)}\n{remark}"


def draw(
    replays: list[Replay], values: list[float], paths: list[Path], force: bool
) -> None:
    """Draw every collision, and e against the ratio of lengths."""
    from .. import plot
    from ..plot.moments import moments

    figures: list[Any] = []
    for title, _, solution in replays:
        axes = (
            plot.spacetime(solution, field="velocity").ax,
            plot.spacetime(solution, field="stress").ax,
            plot.snapshots(solution, times=moments(solution, STAGES)).ax,
            plot.contact(solution).force_ax,
            plot.energy(solution).ax,
        )
        for ax in axes:
            ax.set_title(title.replace("l1/l2", "ℓ₁/ℓ₂"), loc="left", pad=18)
        figures += axes
    figures.append(plot.restitution(RATIOS, values).ax)
    for path, figure in zip(paths, figures, strict=True):
        plot.save(figure, path, force=force)


def box_page(texts: list[str], groups: list[list[str]]) -> str:
    """The page, in HTML: texts whose first line is a heading, each with its figures below it."""
    from ..plot.style import colours

    lines = [HEAD % (texts[0].partition("\n")[0], *colours()[:2])]
    for text, figures in zip(texts, groups, strict=True):
        title, _, rest = text.partition("\n")
        level = "h1" if text is texts[0] else "h2"
        lines += [f"<{level}>{escape(title)}</{level}>", as_html(rest.strip("\n"))]
        for name in figures:
            picture = f'<img src="{name}" alt="{escape(title)}: {Path(name).stem}">'
            lines.append(f'<p><a href="{name}">{picture}</a></p>')
    return "\n".join([*lines, "</html>", ""])
