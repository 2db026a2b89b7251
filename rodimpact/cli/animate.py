"""Make a moving picture of a case: the row, its space-time diagram, and the forces of contacts.

rodimpact animate CASE.toml -o collision.gif

FILE ends in .gif or .mp4 (needs the program ffmpeg); `rodimpact export` makes a page that plays.
[output] of the case is for `rodimpact run`. Exit status 3 if the run stopped before what was asked;
the picture shows what there is.
"""

from __future__ import annotations

import argparse

from ..model.frozen import InvalidModel, Problems
from ..results.regions import nothing_to_draw
from ..storage.casefile import read_case
from ..units import format_si
from . import DONE
from .asking import attempt, check_outputs, naming, note, numbers
from .options import as_keys
from .progress import progress_bar, solved, status_of
from .run_options import add_run_options, run_options

_OPTIONS = {"path": "--output", "field": "--field", "frames": "--frames", "fps": "--fps",
            "magnification": "--magnify", "limit": "--until", "stop": "--until",
            "solution": "CASE.toml"}
_NUMBERS = {"frames": "", "fps": "dimensionless", "magnify": "dimensionless"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, where the picture goes, what it shows, how far to go."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("-o", "--output", metavar="FILE", required=True,
                        help="the picture: .gif or .mp4")
    parser.add_argument("--field", choices=("velocity", "stress", "strain"), default="velocity",
                        help="quantity shown in colour; default velocity")
    parser.add_argument("--frames", metavar="N", default="120", help="2 to 10000; default 120")
    parser.add_argument("--fps", metavar="N", default="25", help="frames a second; default 25")
    parser.add_argument("--magnify", metavar="X",
                        help="magnification of displacements and gaps; chosen by default")
    parser.add_argument("--dark", action="store_true", help="light lines on dark paper")
    add_run_options(parser, ("until",))
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Check everything, solve, draw, and tell what was made."""
    from .. import plot
    from ..plot.files import check_film
    from ..plot.moving import check_frames

    problems: Problems = []
    shown = numbers(problems, arguments, _NUMBERS)
    case = attempt(problems, read_case, arguments.case)
    options = run_options(problems, arguments, case)
    if arguments.output.lower().endswith((".html", ".htm")):
        message = f"must end in .gif or .mp4, got {arguments.output!r}"
        problems.append(("--output", f"{message}; a page that plays is made by rodimpact export"))
    attempt(problems, check_film, arguments.output, options=_OPTIONS)
    attempt(problems, check_frames, shown["frames"], shown["fps"], options=_OPTIONS)
    check_outputs(problems, {"--output": arguments.output}, arguments.force)
    assert case is not None  # or there were problems

    solution = solved(case.system, **options)
    too_short = arguments.until is not None and solution.stopped_by == "until"  # that is told below
    if not too_short and (reason := nothing_to_draw(solution)):
        raise InvalidModel([(case.path, as_keys(reason))])
    note("drawing")
    with (naming(_OPTIONS),
          plot.look("dark" if arguments.dark else "light")):
        film = plot.animation(solution, arguments.field, shown["frames"], shown["fps"],
                              magnification=shown.get("magnify"))
    with progress_bar("frames") as bar:
        film.save(arguments.output, force=arguments.force, progress=bar)
    start, stop = (format_si(float(t), "s") for t in film.times[[0, -1]])
    text = (f"{len(film)} frames from {start} to {stop}, {len(film) / film.fps:.3g} s to watch: "
            f"{arguments.output}")
    status = status_of(solution)
    return text if status == DONE else f"{text}\n{solution.status}", status
