"""The command line: `rodimpact COMMAND ...`, a file for each command.

A command is a module with `add_arguments(parser)` and `run(args)`, which returns a
`CommandResult`. It is imported only when it is called. Where to begin: `main` here,
then `arguments`, which reads and checks the arguments, and a command, such as `run`.
"""

import argparse
import os
import re
import sys
import traceback
import warnings
from collections.abc import Iterable, Sequence
from importlib import import_module
from itertools import pairwise

from ..version import __version__
from .exit_status import DONE, FAULT, MISTAKE, CommandResult
from .exit_status import INTERRUPTED as INTERRUPTED
from .exit_status import STATUSES as STATUSES
from .messages import as_options, complain

COMMANDS = {
    "box": "describe and draw three textbook collisions of elastic rods",
    "run": "solve a case file",
    "sweep": "solve many collisions, in which numbers of a case vary",
    "bearing": "compute the bearing graph of a pile: blows per metre of set",
    "compare": "compare a measured record with computed strains",
    "reduce": "compute stress and strain of a specimen between two bars",
    "explore": "open a page with sliders in the browser",
    "export": "write a page with sliders to a file",
    "animate": "make an animation of a case: GIF or MP4",
    "formula": "solve a case in symbols: formulas and their conditions",
    "rigid": "compute a collision of two rigid bodies",
    "verify": "check each method against a closed form",
    "materials": "list the materials, with the source of each number",
    "help": "show where to find help; help units lists the units of numbers",
    "doctor": "show versions and the folder of compiled code",
}


NO_COMMANDS = {
    "plot": "rodimpact run CASE.toml --plot FILE draws a case",
    "units": "rodimpact help units lists the units",
    "version": "rodimpact --version prints it",
}
"""Words that users take for commands, and the call that they need."""
NO_OPTIONS = {
    ("rodimpact run", "--csv"): (
        "--gauges FILE.csv writes strains over time, --json prints all numbers"
    ),
    ("rodimpact run", "--vary"): "rodimpact sweep solves a family",
    ("rodimpact compare", "--plot"): "--save FILE.png draws the comparison",
    ("rodimpact reduce", "--plot"): "--save FILE.png draws the curve",
    ("rodimpact bearing", "--units"): "results are in SI units",
}
"""Options that users expect of a command, and the call that they need."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command: print its result, or a message on what went wrong.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments after the name of the program; by default those of the process.

    Returns
    -------
    int
        Exit status: that of the command or of the error that it raised, `INTERRUPTED`
        after Ctrl-C, or `FAULT` if the result cannot be written.
    """
    if argv is None:
        argv = sys.argv[1:]
    _replace_closed_streams()
    try:
        result = _run_command(list(argv))
        is_printed = _print(result.text)
    except Exception as error:
        return _complain_of(error)
    except KeyboardInterrupt:
        return complain("interrupted", INTERRUPTED)
    if not is_printed:
        return FAULT
    return result.status


def _replace_closed_streams() -> None:
    """Replace closed standard streams, which are None, by streams to the null device.

    `print` ignores a stream that is None, but `sys.stdout.write` would fail.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115


def _complain_of(error: Exception) -> int:
    """Print an error of a command; return its exit status.

    The status is MISTAKE for a file that exists, for numbers that overflow, and for
    InvalidModel. It is FAULT for other errors of files, for too little memory, and for
    all other errors, which are printed with a traceback as faults of rodimpact.
    """
    if isinstance(error, FileExistsError):
        return complain(str(error), MISTAKE)
    if isinstance(error, OSError):
        return complain(str(error), FAULT)
    if isinstance(error, MemoryError):
        remedy = "ask for a shorter run, fewer events or fewer values"
        return complain(f"not enough memory; {remedy}", FAULT)
    if isinstance(error, OverflowError | FloatingPointError):
        return complain(
            f"a number is too large or too small to compute with: {error}", MISTAKE
        )
    if hasattr(error, "problems"):  # InvalidModel, whose import would take long
        return complain(str(error), MISTAKE)
    traceback.print_exception(error)
    return complain(
        "a fault of rodimpact, not yours; please report the lines above", FAULT
    )


def _run_command(argv: list[str]) -> CommandResult:
    """Result of a command; warnings are printed as messages.

    Argparse itself prints help and mistakes of the call, and exits: then the result has
    no text. Its status is that of argparse, or DONE if argparse gives no number.
    """
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning
            return _parse_and_run(argv)
    except SystemExit as stop:
        status = DONE
        if isinstance(stop.code, int):
            status = stop.code
        return CommandResult("", status)


def _check_source_date() -> None:
    """Raise InvalidModel if the variable SOURCE_DATE_EPOCH is no date of files.

    NumPy and Matplotlib read it, too.
    """
    date = os.environ.get("SOURCE_DATE_EPOCH")
    if date is None or re.fullmatch("[0-9]{1,11}", date.strip()):
        return
    from ..model.frozen import invalid_argument
    from ..units import shown

    wanted = "must be a whole number of seconds since 1970, below 10^11"
    message = f"{wanted}, got {shown(date)}; correct or unset this variable"
    raise invalid_argument("SOURCE_DATE_EPOCH", message)


def _parse_and_run(argv: list[str]) -> CommandResult:
    """Find the command, parse its arguments and run it; return its result.

    An unknown command, help and mistakes in the arguments end in SystemExit. Matplotlib
    is told to open no window. Errors of the command are raised.
    """
    parser = _program_parser()
    call = parser.parse_args(argv)
    if call.command not in COMMANDS:
        parser.error(_command_hint(call.command))
    _check_source_date()
    # These import NumPy, which --version and --help need not wait for.
    arguments = import_module(".arguments", __name__)
    command = import_module(f".{call.command}", __name__)
    command_parser = _new_parser(
        prog=f"rodimpact {call.command}", description=command.__doc__
    )
    command.add_arguments(command_parser)
    # an argument that begins like a number is a value, such as -20cm/s; no option does
    command_parser._negative_number_matcher = re.compile(r"-\.?[0-9]")
    args = command_parser.parse_args(
        call.arguments, arguments.Arguments(command_parser)
    )
    os.environ["MPLBACKEND"] = "agg"  # no command opens a window
    result: CommandResult = command.run(args)
    return result


def _command_hint(command: str) -> str:
    """Message on a missing or unknown command, which is not in `COMMANDS`.

    It gives the call from `NO_COMMANDS`, the command that may be meant, or all of them.
    """
    from ..hints import similar

    if command in NO_COMMANDS:
        return f"unknown command {command!r}; {NO_COMMANDS[command]}"
    meant = similar(command, COMMANDS)
    if meant is not None:
        return f"unknown command {command!r}; perhaps {meant} is meant"
    choices = f"choose one of {', '.join(COMMANDS)}"
    if command == "":
        return f"a command is missing; {choices}"
    return f"unknown command {command!r}; {choices}"


class _Parser(argparse.ArgumentParser):
    """A parser that answers an unknown option with the one that may be meant."""

    def parse_args(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        namespace: argparse.Namespace | None = None,
    ) -> argparse.Namespace:
        """Parse arguments as argparse does, except for the message on an unknown word.

        The message says that a number lacks quotes, or is that of `_hint`; then the
        program exits.
        """
        parsed, unknown = self.parse_known_args(args, namespace)
        if unknown:
            words = sys.argv[1:]
            if args is not None:
                words = list(args)
            parted = _parted_number(words)
            if parted:
                self.error(f"the number {parted} is parted; write it in quotes")
            self.error(self._hint(unknown[0]))
        return parsed

    def _hint(self, word: str) -> str:
        """Message on an unknown word, with a remedy.

        An unknown option is answered by a call from `NO_OPTIONS`, or by the nearest
        option. Another word may be the name of a file for an output that is printed.
        """
        from ..hints import nearest

        if not word.startswith("-"):
            remedy = f"{self.prog} --help shows what it takes"
            # A file such as out.csv may be meant for the output of --csv, which is
            # printed. An action whose `nargs` is 0 is an option without a value.
            ending = word.lower().rpartition(".")[2]
            for action in self._actions:
                if f"--{ending}" in action.option_strings and action.nargs == 0:
                    remedy = f"--{ending} prints; end the command with > {word}"
            if all(action.nargs == 0 for action in self._actions):
                remedy = f"leave it out: {self.prog} takes options only"
            return f"does not take {word!r}; {remedy}"
        options: list[str] = []
        for action in self._actions:
            options.extend(action.option_strings)
        option = word.partition("=")[0]
        if (self.prog, option) in NO_OPTIONS:
            return f"unknown option {option}; {NO_OPTIONS[self.prog, option]}"
        return f"unknown option {option}; {nearest(option, options)}"


def _parted_number(words: list[str]) -> str:
    """The first number whose unit is a word of its own, such as "2 ms"; "" if none.

    The shell separates them if the quotes are missing. The result is in quotes.
    """
    from ..units import DIMENSION_OF_UNIT, is_amount

    for number, unit in pairwise(words):
        quantity = f"{number} {unit}"
        if unit in DIMENSION_OF_UNIT and is_amount(quantity):
            return f'"{quantity}"'
    return ""


def _program_parser() -> argparse.ArgumentParser:
    """Parser of the program: the command, and its arguments, which it does not read.

    Its help lists the commands and the exit statuses. Without a command, `command` is
    "".
    """
    lines = ["commands:"]
    for name, purpose in COMMANDS.items():
        lines.append(f"  {name:10} {purpose}")
    lines += ["", "exit status:"]
    for status, meaning in STATUSES.items():
        lines.append(f"  {status:<10} {meaning}")
    lines += ["", "rodimpact COMMAND --help explains a command."]
    parser = _new_parser(
        prog="rodimpact",
        description=(
            "Collisions of elastic rods, computed from the waves that run through them."
        ),
        epilog="\n".join(lines),
    )
    parser.add_argument(
        "--version", action="version", version=f"rodimpact {__version__}"
    )
    parser.add_argument(
        "command",
        nargs="?",
        default="",
        metavar="COMMAND",
        help="one of the commands below",
    )
    parser.add_argument(
        "arguments",
        nargs=argparse.REMAINDER,
        metavar="...",
        help="arguments of the command",
    )
    return parser


def _new_parser(
    prog: str, description: str | None, epilog: str | None = None
) -> argparse.ArgumentParser:
    """A parser that keeps the lines of its texts, and takes no abbreviated options."""
    return _Parser(
        prog=prog,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )


def _print(text: str | Iterable[str]) -> bool:
    """Print a result; return False, after a message, if it could not be written.

    Nothing is printed for "". A closed pipe, whose reader has gone, is no failure.
    Signs that the stream cannot encode are escaped. A text has calls of Python replaced
    by options; lines are data, which stay as they are.
    """
    lines = text
    if text == "":
        lines = []
    elif isinstance(text, str):
        lines = [as_options(text)]
    encoding = sys.stdout.encoding
    if not encoding:
        encoding = "utf-8"
    try:
        for line in lines:
            printable = line.encode(encoding, "backslashreplace").decode(encoding)
            sys.stdout.write(printable + "\n")
        sys.stdout.flush()
    except OSError as error:
        # At its end the interpreter flushes the stream again: into the null device.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            reason = error.strerror if error.strerror else error
            complain(f"cannot write the result: {reason}", FAULT)
            return False
    return True


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    """Print a warning without its place in the code, which is not the user's."""
    complain(str(message), DONE)
