"""Replay the textbook's box on the axial collision of elastic rods, in words and figures.

Identical rods, a rod on a rigid wall, and rods of different length: steel, 1 m long and 1 cm^2
thick, struck at 1 m/s. Then the coefficient of restitution of sixty pairs of rods against the law
e = l1/l2. The figures go to a directory of their own.
"""

from __future__ import annotations

import argparse
import textwrap
from pathlib import Path
from typing import NamedTuple

from ..explore.presets import steel_rod
from ..model import Rod, System, Wall
from ..model.frozen import InvalidModel, Problems
from ..results.closed_forms import closed_form
from ..results.solution import Solution
from ..running.solving import collide, solve
from ..storage.tables import align, clean
from ..units import format_si
from . import DONE
from .asking import note, quantity
from .stages import LEGEND, stages, tell

FIGURES = [
    *(f"{row}-{view}.png" for row in ("identical", "wall", "unequal")
      for view in ("velocity", "stress", "stages", "contact", "energy")),
    "restitution.png",
]
PAIRS = 60  # length ratios at which e is compared with l1/l2


class Replay(NamedTuple):
    """One collision of the box: what it is called, what its bodies are, and its solution."""

    title: str
    names: tuple[str, str]
    solution: Solution


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A ratio of lengths, and where the figures go."""
    parser.add_argument("--ratio", default="0.4", metavar="R",
                        help="l1/l2 of the rods of different length, up to 1; default 0.4")
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
    directory = Path(arguments.output)
    if directory.exists() and not directory.is_dir():
        problems.append(("--output", f"{arguments.output!r} is not a directory; name another"))
    elif not arguments.force and (there := [n for n in FIGURES if (directory / n).exists()]):
        message = f"{directory} holds {', '.join(there)} already"
        problems.append(("--output", f"{message}; give --force to replace them, or name another"))
    if problems:
        raise InvalidModel(problems)
    directory.mkdir(parents=True, exist_ok=True)

    replays = solve_all(ratio)
    ratios = [i / PAIRS for i in range(1, PAIRS + 1)]
    values = [restitution(r) for r in ratios]
    note("drawing")
    draw(replays, ratios, values, directory, arguments.force)
    largest = max(abs(e - r) for e, r in zip(values, ratios, strict=True))
    blocks = [
        introduction(),
        *(describe(replay) for replay in replays),
        f"Length ratios from {ratios[0]:.3g} to 1\n"
        f"{PAIRS} pairs of rods solved: e is l1/l2 but for {largest:.1e} at most.",
        f"{len(FIGURES)} figures in {directory}\n"
        + textwrap.fill(", ".join(FIGURES), 98, break_on_hyphens=False),
    ]
    return "\n\n\n".join(blocks), DONE


def solve_all(ratio: float) -> list[Replay]:
    """Solve the three collisions of the box, in the order of FIGURES."""
    title, both = f"Rods of different length, l1/l2 = {ratio:g}", ("left rod", "right rod")
    pairs: list[tuple[str, tuple[str, str], float, Rod | Wall]] = [
        ("Identical rods", both, 1.0, steel_rod(1.0)),
        ("A rod on a rigid wall", ("rod", "wall"), 1.0, Wall()),
        (title, both, ratio, steel_rod(1.0)),
    ]
    return [
        Replay(title, names, solve(System([steel_rod(length, 1.0), right])))
        for title, names, length, right in pairs
    ]


def restitution(ratio: float) -> float:
    """Coefficient of restitution of two rods whose lengths have this ratio."""
    return collide(steel_rod(ratio, 1.0), steel_rod(1.0)).restitution


def introduction() -> str:
    """What is collided, and how fast that is."""
    rod = steel_rod(1.0)
    c = float(rod.segments[0].wave_speed)
    trips = format_si(2 * float(rod.transit_time), "s")
    return (
        "The axial collision of elastic rods\n"
        "Steel rods of 1 cm^2, the longest 1 m long; the left one comes at v = 1 m/s.\n"
        f"Waves run along a steel bar at {c:.0f} m/s, about 5000 m/s, not 1000 m/s: two trips\n"
        f"along 1 m take {trips}, so the collision lasts about 0.4 ms, not a few ms.\n\n"
        f"What is where, from left to right: velocity and stress of each uniform piece.\n{LEGEND}"
    )


def describe(replay: Replay) -> str:
    """The stages of a collision, and its result beside theory."""
    solution, names = replay.solution, replay.names
    rods = [i for i, body in enumerate(solution.system.bodies) if isinstance(body, Rod)]
    story = tell(stages(solution, names), names, rods)
    return f"{replay.title}\n\n{story}\n\n{results(replay)}"


def results(replay: Replay) -> str:
    """What the collision did, beside the closed form."""
    o, system = replay.solution.outcome, replay.solution.system
    known = closed_form(system)
    assert known is not None
    theory = known.collision()
    e = o.restitution
    episode = replay.solution.contacts[0].episodes[0]

    def energy(value: float) -> str:
        return format_si(clean(value, o.kinetic_before), "J")

    after = (f"{clean(v, 1.0):.6g} m/s" for v in o.velocities_after)
    table = align([
        ["", "found", "theory"],
        ["coefficient of restitution e", f"{e:.9g}", f"{float(theory.restitution):.9g}"],
        ["contact force lasts", format_si(o.duration, "s"), format_si(float(theory.duration), "s")],
        ["gap opens after", format_si(episode.opening - episode.start, "s"),
         format_si(float(theory.opening), "s")],
        ["contact force", format_si(o.peak_force, "N"), format_si(float(theory.peak_force), "N")],
        ["energy left in vibration", energy(sum(o.vibration_after)),
         energy(float(theory.vibration_energy))],
        *([f"velocity of the {name} afterwards", v, ""]
          for name, v in zip(replay.names, after, strict=True)),
        ["momentum balance, relative error", f"{abs(o.momentum_residual):.2g}", "0"],
        ["energy balance, relative error", f"{abs(o.energy_residual):.2g}", "0"],
    ])
    left, right = system.bodies
    assert isinstance(left, Rod)
    trip = 2 * float(left.transit_time)
    remark = f"2 l/c of the {replay.names[0]} is {format_si(trip, 's')}"
    if isinstance(right, Rod):
        remark += f", of the {replay.names[1]} {format_si(2 * float(right.transit_time), 's')}"
    return f"{table}\n{remark}. Vibration keeps (1 - e^2) m_coll v^2/2."


def draw(
    replays: list[Replay], ratios: list[float], values: list[float], directory: Path, force: bool
) -> None:
    """Draw every collision, and e against the ratio of lengths."""
    from .. import plot

    figures = [plot.restitution(ratios, values).ax.figure]
    for replay in reversed(replays):
        solution = replay.solution
        times = {t for s in stages(solution, replay.names) for t in (s.time, s.middle)}
        axes = (
            plot.spacetime(solution, field="velocity").ax,
            plot.spacetime(solution, field="stress").ax,
            plot.snapshots(solution, times=sorted(times)).ax,
            plot.contact(solution).force_ax,
            plot.energy(solution).ax,
        )
        for ax in axes:
            ax.set_title(replay.title, loc="left", pad=18)
        figures[:0] = [ax.figure for ax in axes]
    for name, figure in zip(FIGURES, figures, strict=True):
        plot.save(figure, directory / name, force=force)
