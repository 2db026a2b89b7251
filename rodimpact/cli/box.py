"""Describe and draw three textbook collisions of elastic rods.

Two identical rods collide, a rod hits a rigid wall, and two rods of different length
collide. The longest rod is 1 m long, the cross-sectional area is 1 cm^2, and the speed
of impact is 1 m/s. The command also solves sixty pairs of rods with the lengths l1 and
l2, and compares the coefficient of restitution e with the ratio l1/l2. The command
writes the figures to the directory of --output, and also a page with all figures,
index.html.
"""

import argparse
import math
import re
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

from .. import Material, Rod, Solution, System, Wall, collide, solve
from ..materials import TABLE
from ..model.frozen import raise_if_problems
from ..results.pair_theory import pair_theory
from ..storage.tables import align, as_html, with_micro_sign, without_round_off
from ..storage.writing import write_text
from ..units import format_si
from .arguments import Arguments, add_number
from .exit_status import DONE, CommandResult
from .messages import print_progress
from .stages import LEGEND, stage_lines

KEYS = ("identical", "wall", "unequal", "dowel")
"""Keys of the collisions, in the names of their files; the dowel is optional."""
VIEWS = ("velocity", "stress", "stages", "contact", "energy")
"""Figures of each collision, in the names of their files."""
PAGE = "index.html"
RATIOS = [i / 60 for i in range(1, 61)]
"""Ratios l1/l2 at which e is compared with the law e = l1/l2."""
AREA = 1e-4
"""Cross-sectional area of the rods, m^2."""
DOWEL_LENGTH = 0.9144
"""3 ft, m."""
DOWEL_AREA = math.pi / 4 * 0.0127**2
"""Cross-sectional area of a dowel half an inch thick, m^2."""
SNAPSHOTS = 7
"""Snapshots in the figure of the stages."""
VIBRATION_ENERGY = (
    "The vibration energy after the collision is (1 - e^2) mu v^2/2, with the reduced\n"
    "mass mu = m1 m2/(m1 + m2); against a wall mu = m1."
)
BOX_ROD_NAMES = ("left rod", "right rod")
HEAD = """\
<!doctype html>
<html lang="en"><meta charset="utf-8"><title>%s</title>
<style>
body { max-width: 64rem; margin: 2rem auto; padding: 0 1.5rem; \
font-family: sans-serif; background: %s; color: %s; }
img { max-width: min(100%%, 44rem); }
pre { font-size: 0.95rem; line-height: 1.4; }
a { color: inherit; }
</style>"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add options: length ratio, material, dowel, and the figures with their folder.

    By default a ratio of 0.4, steel, no dowel, and light PNG files.
    """
    add_number(
        parser,
        "--ratio",
        "dimensionless",
        "ratio l1/l2 of the lengths in the third collision, at most 1; default 0.4",
        default=0.4,
    )
    parser.add_argument(
        "--material",
        choices=TABLE,
        default="steel",
        metavar="NAME",
        help="material of the rods, from `rodimpact materials`; default: steel",
    )
    parser.add_argument(
        "--dowel",
        action="store_true",
        help="add a collision: a wooden dowel, 3 feet long, falls on a stone floor",
    )
    parser.add_argument(
        "--format",
        choices=("png", "svg", "pdf"),
        default="png",
        help="format of the figures; default png",
    )
    parser.add_argument(
        "--dark", action="store_true", help="light lines on a dark background"
    )
    parser.add_argument(
        "-o",
        "--output",
        default="rodimpact-box",
        metavar="DIR",
        help="directory of the figures; default ./rodimpact-box",
    )
    parser.add_argument("--force", action="store_true", help="replace existing figures")


def run(args: Arguments) -> CommandResult:
    """Solve the collisions, describe and draw them, and write the page.

    The result is the text of the page without figures, and the folder of the figures.
    InvalidModel is raised for a wrong ratio, and for files that exist without --force.
    """
    from .. import plot

    if not 0 < args.ratio <= 1:
        message = "must be above 0 and at most 1, the left rod being the shorter"
        args.add_problem("--ratio", f"{message}, got {args.ratio!r}")
    keys = list(KEYS)
    if not args.dowel:
        keys.remove("dowel")
    files = FigureFiles(Path(args.output), keys, args.format)
    _check_files(args, files)
    files.folder.mkdir(parents=True, exist_ok=True)

    material = TABLE[args.material]
    collisions = box_collisions(material, args.ratio)
    replays = []
    for collision in collisions[: len(keys)]:  # without the dowel, which is the last
        solution = solve(System(collision.bodies))
        replays.append(Replay(collision.title, collision.names, solution))
    restitutions = [restitution_of(material, ratio) for ratio in RATIOS]
    texts = [introduction(material)]
    texts += map(describe, replays)
    texts.append(law_text(restitutions))
    print_progress("drawing")
    look = "light"
    if args.dark:
        look = "dark"
    with plot.look(look):
        draw(replays, restitutions, files.paths, args.force)
        # The introduction has no figures; each later text has a group of them.
        page = box_page(texts, [[], *files.groups])
    write_text(files.folder / PAGE, page, force=args.force)
    summary = (
        f"{len(files.names)} figures in {files.folder}, and {PAGE}, which shows them"
    )
    return CommandResult("\n\n\n".join([*texts, summary]), DONE)


# The collisions -----------------------------------------------------------------------


class Collision(NamedTuple):
    """A collision of the textbook's box, to be solved."""

    title: str
    names: tuple[str, str]  # names of the bodies
    bodies: list[Rod | Wall]


class Replay(NamedTuple):
    """A collision of the textbook's box with its solution."""

    title: str
    names: tuple[str, str]
    solution: Solution


def rod(material: Material, length: float, velocity: float = 0.0) -> Rod:
    """A rod of the box: uniform, of the cross-sectional area `AREA`."""
    return Rod(length, area=AREA, material=material, velocity=velocity)


def box_collisions(material: Material, ratio: float) -> list[Collision]:
    """Title and bodies of each collision, not yet solved, in the order of `KEYS`.

    They are identical rods, a rod and a wall, rods of the length ratio l1/l2 = `ratio`,
    and a dowel on a floor, whose material is always oak. The first body moves at 1 m/s.
    """
    striker = rod(material, length=1.0, velocity=1.0)
    struck = rod(material, length=1.0)
    shorter = rod(material, length=ratio, velocity=1.0)
    dowel = Rod(DOWEL_LENGTH, area=DOWEL_AREA, material=TABLE["oak"], velocity=1.0)
    different = f"Rods of different length, l1/l2 = {ratio:g}"
    on_floor = "A wooden dowel, 3 ft long, on a stone floor"
    return [
        Collision("Identical rods", BOX_ROD_NAMES, [striker, struck]),
        Collision("A rod on a rigid wall", ("rod", "wall"), [striker, Wall()]),
        Collision(different, BOX_ROD_NAMES, [shorter, struck]),
        Collision(on_floor, ("dowel", "floor"), [dowel, Wall()]),
    ]


def restitution_of(material: Material, ratio: float) -> float:
    """e of a rod that strikes one of 1 m, with a ratio of their lengths."""
    striker = rod(material, length=ratio, velocity=1.0)
    struck = rod(material, length=1.0)
    return collide(striker, struck).restitution


# The texts ----------------------------------------------------------------------------


def introduction(material: Material) -> str:
    """Text on the rods of the box, their bar speed, and how a collision is described.

    Its first line is the title of the page.
    """
    bar_speed = float(material.wave_speed)
    round_trip = 2 / bar_speed
    return (
        "The axial collision of elastic rods\n"
        f"Rods of {material.name}, cross-sectional area 1 cm^2, the longest 1 m long. "
        "The left rod comes at v = 1 m/s.\n"
        f"The bar speed is {bar_speed:.0f} m/s (3000 to 6000 m/s in metals, not about "
        "1000 m/s). A wave runs twice\n"
        f"along 1 m in {format_si(round_trip, 's')}, so the collision lasts about "
        f"{1e3 * round_trip:.1g} ms.\n\n"
        "Each line shows the velocity and stress of each uniform piece, from left to "
        "right.\n"
        f"{LEGEND}"
    )


def law_text(restitutions: list[float]) -> str:
    """Text with the largest difference of e from the law e = l1/l2, over `RATIOS`."""
    differences = []
    for e, ratio in zip(restitutions, RATIOS, strict=True):
        differences.append(abs(e - ratio))
    return (
        f"Length ratios from {RATIOS[0]:.3g} to 1\n"
        f"{len(RATIOS)} pairs of rods solved: e agrees with l1/l2 to "
        f"{max(differences):.1e}."
    )


def describe(replay: Replay) -> str:
    """The stages of a collision, and its result beside the closed form."""
    stages = stage_lines(replay.solution, replay.names)
    table = align(list(_result_rows(replay)))
    return f"{replay.title}\n\n{stages}\n\n{table}\n\n{_remark(replay)}"


def _result_rows(replay: Replay) -> Iterator[list[str]]:
    """Rows of the table, header first: results of the solver beside the theory.

    Rows of the velocities, without theory, follow, then rows of the errors of the
    momentum and energy balances, whose theory is 0.
    """
    outcome = replay.solution.outcome
    theory: Any = pair_theory(replay.solution.system)
    expected = theory.collision()
    episode = replay.solution.contacts[0].episodes[0]
    opening = episode.opening - episode.start
    vibration = without_round_off(
        sum(outcome.vibration_after), scale=outcome.kinetic_before
    )
    yield ["", "found", "theory"]
    for quantity, unit, computed, closed_form in (
        (
            "coefficient of restitution e",
            "",
            outcome.restitution,
            expected.restitution,
        ),
        ("force duration", "s", outcome.duration, expected.duration),
        ("time until the gap opens", "s", opening, expected.opening),
        ("peak force", "N", outcome.peak_force, expected.peak_force),
        ("vibration energy after", "J", vibration, expected.vibration_energy),
    ):
        computed_text = format_si(float(computed), unit)
        yield [quantity, computed_text, format_si(float(closed_form), unit)]
    for name, v in zip(replay.names, outcome.velocities_after, strict=True):
        velocity = f"{without_round_off(v, scale=1.0):.6g} m/s"
        yield [f"velocity of the {name} afterwards", velocity, ""]
    momentum_error = f"{abs(outcome.momentum_residual):.2g}"
    yield ["momentum balance, relative error", momentum_error, "0"]
    energy_error = f"{abs(outcome.energy_residual):.2g}"
    yield ["energy balance, relative error", energy_error, "0"]


def _remark(replay: Replay) -> str:
    """Remark on the round-trip times 2 l/c, and on the definition of vibration energy.

    If the gap opens later than the force ends, the remark also explains that.
    """
    duration = replay.solution.outcome.duration
    episode = replay.solution.contacts[0].episodes[0]
    round_trips = []
    for name, body in zip(replay.names, replay.solution.system.bodies, strict=True):
        if isinstance(body, Rod):
            round_trip = 2 * float(body.transit_time)
            round_trips.append(f"{format_si(round_trip, 's')} for the {name}")
    remark = f"2 l/c is {' and '.join(round_trips)}"
    if episode.opening > episode.force_end:
        opening = episode.opening - episode.start
        remark += (
            f".\nThe force ends after {format_si(duration, 's')}. In the textbook the "
            "rods part then. In fact they touch\nwithout force until the wave of the "
            "long rod is back; the gap opens after "
            f"{format_si(opening, 's')}"
        )
    return f"{remark}.\n{VIBRATION_ENERGY}"


# The files ----------------------------------------------------------------------------


class FigureFiles:
    """Files of the figures.

    Attributes
    ----------
    folder : Path
    groups : list of list of str
        Names of the figures of each collision, and of the last figure.
    """

    def __init__(self, folder: Path, keys: Sequence[str], file_format: str) -> None:
        """Name a file for each view of each collision, and one for the restitution.

        `keys` are the keys of the collisions. `groups` gets the file names of each
        collision, in this order, and last the file name of the restitution.
        """
        self.folder = folder
        self.groups: list[list[str]] = []
        for key in keys:
            self.groups.append([f"{key}-{view}.{file_format}" for view in VIEWS])
        self.groups.append([f"restitution.{file_format}"])

    @property
    def names(self) -> list[str]:
        """Names of all figures."""
        names = []
        for group in self.groups:
            names += group
        return names

    @property
    def paths(self) -> list[Path]:
        """Paths of all figures."""
        return [self.folder / name for name in self.names]


def _check_files(args: Arguments, files: FigureFiles) -> None:
    """Raise InvalidModel for all mistakes of the call so far, and of its folder.

    The folder must not be a file. Figures in it must not exist without --force.
    """
    folder = files.folder
    existing = [name for name in (*files.names, PAGE) if (folder / name).exists()]
    if folder.exists() and not folder.is_dir():
        message = f"{args.output!r} is not a directory; name another"
        args.add_problem("--output", message)
    elif existing and not args.force:
        message = (
            f"{folder} holds {', '.join(existing)} already; give --force to replace "
            "them, or name another"
        )
        args.add_problem("--output", message)
    raise_if_problems(args.problems)


def draw(
    replays: list[Replay], restitutions: list[float], paths: list[Path], force: bool
) -> None:
    """Draw all `VIEWS` of all collisions, and e over the ratio of lengths, into files.

    `paths` has the files in this order: the views of the first collision, of the
    second, ..., then e.
    """
    from .. import plot
    from ..plot.moments import moments

    figures: list[Any] = []
    for replay in replays:
        solution = replay.solution
        times = moments(solution, SNAPSHOTS)
        axes = [
            plot.spacetime(solution, field="velocity").ax,
            plot.spacetime(solution, field="stress").ax,
            plot.snapshots(solution, times=times).ax,
            plot.contact(solution).force_ax,
            plot.energy(solution).ax,
        ]
        title = replay.title.replace("l1/l2", "ℓ₁/ℓ₂")
        for ax in axes:
            ax.set_title(title, loc="left", pad=18)
        figures += axes
    figures.append(plot.restitution(RATIOS, restitutions).ax)
    for path, figure in zip(paths, figures, strict=True):
        plot.save(figure, path, force=force)


def box_page(texts: list[str], groups: list[list[str]]) -> str:
    """The page, in HTML: each text with its heading, and its figures below it.

    Parameters
    ----------
    texts : list of str
        Their first lines become headings.
    groups : list of list of str
        Names of the figures below each text.
    """
    from ..plot.style import colours

    title, _, _ = texts[0].partition("\n")
    look = colours()
    lines = [HEAD % (escape(title), look.paper, look.ink)]
    for text, figures in zip(texts, groups, strict=True):
        heading, _, paragraphs = text.partition("\n")
        level = "h2"
        if text is texts[0]:
            level = "h1"
        lines.append(f"<{level}>{escape(heading)}</{level}>")
        for block in paragraphs.strip("\n").split("\n\n"):
            lines.append(_block_as_html(block))
        for name in figures:
            alternative = f"{escape(heading)}: {Path(name).stem}"
            picture = f'<img src="{name}" alt="{alternative}">'
            lines.append(f'<p><a href="{name}">{picture}</a></p>')
    return "\n".join([*lines, "</html>", ""])


def _block_as_html(block: str) -> str:
    """A paragraph, or a table, which has columns: two spaces side by side."""
    if "  " in block:
        return as_html(block)
    return f"<p>{escape(_with_symbols(block))}</p>"


def _with_symbols(text: str) -> str:
    """A text for a page, with μ for the reduced mass, and cm² and e² for cm^2 and e^2.

    A terminal may lack these signs.
    """
    with_powers = with_micro_sign(text).replace("^2", "²")
    return re.sub(r"\bmu\b", "\N{GREEK SMALL LETTER MU}", with_powers)
