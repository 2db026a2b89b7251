"""The command line: `rodimpact COMMAND ...`, one file a command, imported only when it is called.

A command is a module with `add_arguments(parser)` and `run(given)`, which returns the text for
standard output, or its lines, and the exit status, one of `STATUSES`.
"""

import argparse
import difflib
import os
import re
import sys
import traceback
import warnings
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module

from ..version import __version__
from .options import as_options

COMMANDS = {
    "box": "replay the textbook's collisions of elastic rods, in words and figures",
    "run": "solve a case file",
    "sweep": "map a family of collisions over one or more numbers of a case",
    "compare": "compare a measured record with the gauges of a case",
    "reduce": "read stress and strain of a specimen off the gauges of two bars",
    "explore": "play with a collision in the browser",
    "export": "write a collision as a page to hand out",
    "animate": "make a moving picture of a case: GIF or MP4",
    "formula": "solve a case in symbols: e as a formula, and when it holds",
    "rigid": "collide two rigid bodies",
    "verify": "check each method against a closed form",
    "materials": "list materials, with the source of each number",
    "help": "list the units that a number may have",
    "doctor": "show versions, and where compiled code is kept",
}
DONE, FAULT, MISTAKE, INCOMPLETE, UNVERIFIED, INTERRUPTED = 0, 1, 2, 3, 4, 130
STATUSES = {
    DONE: "done",
    FAULT: "an output cannot be written, or a fault of rodimpact",
    MISTAKE: "a mistake in the call or in the case, or a file that exists, without --force",
    INCOMPLETE: "a run stopped before what was asked; what is known is printed",
    UNVERIFIED: "verification failed",
    INTERRUPTED: "interrupted by Ctrl-C",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments after the name of the program; by default those of the process.

    Returns
    -------
    int
        Exit status.
    """
    for name in ("stdout", "stderr"):
        if (
            getattr(sys, name) is None
        ):  # closed; what is printed to None goes to the other
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    try:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _show_warning
                text, status = _run(sys.argv[1:] if argv is None else list(argv))
        except SystemExit as stop:  # argparse has printed help or a mistake
            text, status = "", int(stop.code or DONE)
        return status if _print(text) else FAULT
    except KeyboardInterrupt:
        return complain("interrupted", INTERRUPTED)
    except OSError as error:
        return complain(
            str(error), MISTAKE if isinstance(error, FileExistsError) else FAULT
        )
    except MemoryError:
        remedy = "ask for a shorter run, fewer events or fewer values"
        return complain(f"not enough memory; {remedy}", FAULT)
    except (OverflowError, FloatingPointError) as error:
        return complain(
            f"a number is too large or too small to compute with: {error}", MISTAKE
        )
    except Exception as error:
        if not hasattr(error, "problems"):
            traceback.print_exc()
            return complain(
                "a fault of rodimpact, not yours; please report the lines above", FAULT
            )
        return complain(str(error), MISTAKE)


def _run(argv: list[str]) -> tuple[str | Iterable[str], int]:
    parser_of = partial(
        argparse.ArgumentParser,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser = parser_of(
        prog="rodimpact",
        description="Collisions of elastic rods: exact waves, and the restitution that follows.",
        epilog="commands:\n"
        + "\n".join(f"  {name:10} {what}" for name, what in COMMANDS.items())
        + "\n\nexit status:\n"
        + "\n".join(f"  {status:<10} {what}" for status, what in STATUSES.items())
        + "\n\nrodimpact COMMAND --help tells more about a command.",
    )
    parser.add_argument(
        "--version", action="version", version=f"rodimpact {__version__}"
    )
    parser.add_argument(
        "command",
        nargs="?",
        default="",
        metavar="COMMAND",
        help="what to do, see below",
    )
    parser.add_argument(
        "rest", nargs=argparse.REMAINDER, metavar="...", help="its arguments"
    )
    called = parser.parse_args(argv)
    if called.command not in COMMANDS:
        near = difflib.get_close_matches(called.command, COMMANDS, n=1)
        hint = (
            f"perhaps {near[0]} is meant"
            if near
            else f"choose one of {', '.join(COMMANDS)}"
        )
        parser.error(f"unknown command {called.command!r}; {hint}")
    asking = import_module(".asking", __name__)  # which imports this package
    command = import_module(f".{called.command}", __name__)
    own = parser_of(prog=f"rodimpact {called.command}", description=command.__doc__)
    command.add_arguments(own)
    # what begins as a number is a value, such as -20cm/s or -5.npz; no option does
    own._negative_number_matcher = re.compile(r"-\.?[0-9]")
    os.environ["MPLBACKEND"] = "agg"  # no command opens a window
    return command.run(own.parse_args(called.rest, asking.Given(own)))  # type: ignore[no-any-return]


def _print(text: str | Iterable[str]) -> bool:
    """Print the result. False if it cannot be written; a reader who has gone is no failure."""
    lines = [text] * bool(text) if isinstance(text, str) else text
    try:
        encoding = sys.stdout.encoding or "utf-8"
        for line in lines:
            sys.stdout.write(
                line.encode(encoding, "backslashreplace").decode(encoding) + "\n"
            )
        sys.stdout.flush()
    except OSError as error:
        # nothing may be left to write when the interpreter ends
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            complain(f"cannot write the result: {error.strerror or error}", FAULT)
            return False
    return True


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning without the place in the code, which is not the user's."""
    complain(str(message), DONE)


def complain(message: str, status: int) -> int:
    """Print a mistake or fault; returns the exit status that goes with it."""
    with suppress(OSError):  # nobody reads it
        for line in as_options(message).splitlines():
            print(f"rodimpact: {line}", file=sys.stderr)
    return status
