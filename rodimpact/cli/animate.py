"""Make an animation of a case: rods, space-time diagram, contact forces.

rodimpact animate CASE.toml -o collision.gif

FILE ends in .gif or .mp4; a .mp4 file needs ffmpeg. `rodimpact export` makes a page
with a play button. The command ignores [output] of the case. If the run stopped early,
the animation ends at the same time as the run, and the exit status is 3.
"""

import argparse

from ..model.frozen import InvalidModel
from ..results.regions import nothing_to_draw
from ..running.solving import solve
from ..units import format_si
from .arguments import COUNT, Arguments, add_number, add_run_options, status_of
from .exit_status import DONE, CommandResult
from .messages import print_progress

NAMES = {
    "path": "--output",
    "magnification": "--magnify",
    "limit": "--until",
    "stop": "--until",
}
"""Names of arguments of the library in messages."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the case, the file, what a frame shows, the end of the run.

    --output is required. By default the velocity is shown, in 120 frames, 25 a second.
    """
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        required=True,
        help="file of the animation: .gif or .mp4",
    )
    parser.add_argument(
        "--field",
        choices=("velocity", "stress", "strain"),
        default="velocity",
        help="quantity shown in colour; default velocity",
    )
    add_number(
        parser,
        "--frames",
        COUNT,
        "number of frames, 2 to 10000; default 120",
        default=120,
    )
    add_number(
        parser, "--fps", "dimensionless", "frames per second; default 25", default=25.0
    )
    add_number(
        parser,
        "--magnify",
        "dimensionless",
        "magnification of displacements and gaps; default: chosen automatically",
    )
    parser.add_argument(
        "--dark", action="store_true", help="light lines on a dark background"
    )
    add_run_options(parser, ("until",))
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(args: Arguments) -> CommandResult:
    """Check all arguments, solve, write the film, and describe it in a line.

    If the run stopped early, a second line says why, and the status is INCOMPLETE.
    InvalidModel is raised for mistakes in the arguments, before the case is solved, and
    for a run that lasts no time.
    """
    from .. import plot
    from ..plot.films import check_film
    from ..plot.moving import check_frames

    case = args.read_case()
    options = args.run_options(case)
    args.build_or_add_problems(check_film, args.output, names=NAMES)
    args.build_or_add_problems(check_frames, args.frames, args.fps)
    if case is not None and "rod" not in case.system.kinds:
        message = (
            "needs at least one rod, whose waves the picture shows; for rigid masses "
            f"`rodimpact run {args.case} --plot FILE.png` draws the contacts and the "
            "energy"
        )
        args.add_problem("bodies", message)
    args.check_outputs("output")

    with args.naming_mistakes():
        solution = solve(case.system, **options)
    reason = nothing_to_draw(solution)
    if reason:
        path = "--until"
        if args.until is None:
            path = "solve"  # the table of the case, which has the end of the run
        raise InvalidModel([(path, reason)])
    print_progress("drawing")
    look = "light"
    if args.dark:
        look = "dark"
    with args.naming_mistakes(names=NAMES), plot.look(look):
        film = plot.animation(
            solution, args.field, args.frames, args.fps, magnification=args.magnify
        )
    film.save(args.output, force=args.force)

    start = format_si(float(film.times[0]), "s")
    stop = format_si(float(film.times[-1]), "s")
    seconds = len(film) / film.fps
    text = (
        f"{len(film)} frames from {start} to {stop}, {seconds:.3g} s to watch: "
        f"{args.output}"
    )
    status = status_of(solution)
    if status != DONE:
        text = f"{text}\n{args.name_entries(solution.status)}"
    return CommandResult(text, status)
