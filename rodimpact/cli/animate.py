"""Make a moving picture of a case: the row, its space-time diagram, and the forces of contacts.

rodimpact animate CASE.toml -o collision.gif

FILE ends in .gif or .mp4 (needs the program ffmpeg); `rodimpact export` makes a page that plays.
[output] of the case is for `rodimpact run`. Exit status 3 if the run stopped before what was asked;
the picture shows what there is.
"""

import argparse

from ..model.frozen import InvalidModel
from ..results.regions import nothing_to_draw
from ..running.solving import solve
from ..units import format_si
from . import DONE
from .asking import Given, add_run_options, note, number, status_of

_NAMES = {
    "path": "--output",
    "magnification": "--magnify",
    "limit": "--until",
    "stop": "--until",
    "solution": "CASE.toml",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, where the picture goes, what it shows, how far to go."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        required=True,
        help="the picture: .gif or .mp4",
    )
    parser.add_argument(
        "--field",
        choices=("velocity", "stress", "strain"),
        default="velocity",
        help="quantity shown in colour; default velocity",
    )
    number(parser, "--frames", "", "2 to 10000; default 120", default=120)
    number(
        parser, "--fps", "dimensionless", "frames a second; default 25", default=25.0
    )
    number(
        parser,
        "--magnify",
        "dimensionless",
        "magnification of displacements and gaps; chosen by default",
    )
    parser.add_argument("--dark", action="store_true", help="light lines on dark paper")
    add_run_options(parser, ("until",))
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(given: Given) -> tuple[str, int]:
    """Check everything, solve, draw, and tell what was made."""
    from .. import plot
    from ..plot.films import check_film
    from ..plot.moving import check_frames

    case = given.read_case()
    options = given.run_options(case)
    given.attempt(check_film, given.output, names=_NAMES)
    given.attempt(check_frames, given.frames, given.fps)
    given.check_outputs("output")

    solution = solve(case.system, **options)
    if reason := nothing_to_draw(solution):
        raise InvalidModel([("solve" if given.until is None else "--until", reason)])
    note("drawing")
    with given.naming(names=_NAMES), plot.look("dark" if given.dark else "light"):
        film = plot.animation(
            solution, given.field, given.frames, given.fps, magnification=given.magnify
        )
    film.save(given.output, force=given.force)
    start, stop = (format_si(float(t), "s") for t in film.times[[0, -1]])
    text = (
        f"{len(film)} frames from {start} to {stop}, {len(film) / film.fps:.3g} s to watch: "
        f"{given.output}"
    )
    status = status_of(solution)
    return text if status == DONE else f"{text}\n{solution.status}", status
