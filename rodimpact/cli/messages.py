"""Messages to the user, on standard error.

The library names arguments and calls of Python in its messages. On the command line
they become options, and entries of a case file.
"""

import re
import sys
from contextlib import suppress

ONLY_ARGUMENTS = ("max_events", "rtol", "dt", "align_within", "equal_forces")
"""Arguments that are no words of English, so they are replaced wherever they stand."""
ARGUMENTS = (
    *ONLY_ARGUMENTS,
    "until",
    "cells",
    "method",
    "force",
    "time",
    "time_unit",
    "rate",
    "units",
    "decimal",
    "radius",
    "allow_energy_release",
    "clock",
    "compression",
)
"""Arguments that are replaced if a value is given, as in ``force=True``."""
OPTION_OF = {"units": "unit", "allow_energy_release": "energy_release"}
"""Options that do not bear the name of their argument."""

PHRASES = {
    r"read velocities_after instead": "read the velocities instead",
    r"use (outcome|result)\.contacts": "each contact has its own",
    r"give rod\.in_steps\(n\)": "give the area in steps, {values = [...], at = [...]}",
    r"give Rod\(area=Steps\(\.\.\.\)\)": "give the rod this area and no segments",
    r"give Rigid\(restitution=\.\.\.\) or a compliant law such as Hertz": (
        'give it a restitution or a compliant law such as "hertz"'
    ),
    r"must be a Material with a poisson_ratio, or None for a rigid face": (
        "must be a material with a poisson_ratio"
    ),
    r"or solve\(\)": "or take rodimpact run",
    r"result\.explain\(index\) says why": "the status of each says why",
    r", such as plot\.sweep\(.*\)\)": "",
    r"use (\.?resampled\(\S*\))( with the times of one( of them)?)?": (
        "record at equal steps, and all channels at the same times"
    ),
    r"give cut pulses, ri\.reduce\(pulses=\.\.\.\)": (
        "give cut pulses, --incident, --reflected and --transmitted"
    ),
    r" alone, ri\.BarGauge\(\w+, distance\)": " alone",
    r"reverse it by BarGauge\(\.\.\., gain=-1\)": (
        "reverse the numbers of this channel in the record"
    ),
    r"which ri\.calibrate measures": "which a shot with the bars together measures",
    r"\(ri\.calibrate finds gains from a shot with the bars together\)": (
        "(a shot with the bars together shows gains)"
    ),
    r"Specimen\(wave_speed=\.\.\.\)": "--wave-speed",
    r"Specimen\(\.\.\., incompressible=True\)": "--incompressible",
    r"give youngs_modulus=": "give the bar youngs_modulus = ",
    r'save\("run\.toml"\)': "rodimpact run --save run.toml",
    r"solve its system again, and": "solve its case again by",
    r"a figure is drawn by plot\.save\(plot\.overview\(solution\), path\)": (
        "rodimpact run CASE.toml --plot FILE draws a figure"
    ),
    r"result\.to_csv\(path\) writes a table": (
        "--csv prints a table: end the command with > FILE.csv"
    ),
    r"write solution\.system as a case file": "save its system as a case file",
}
"""Words of the command line in place of calls of Python, by a pattern of their text."""

NOT_QUOTED = r"(?<![-\w.'\"])"  # no option, key of a case file, or text of the user
_WITH_VALUE = rf'(?P<named>{"|".join(ARGUMENTS)})=(?:True|"(?P<value>[^"]*)")?'
_BARE = rf"(?P<bare>{'|'.join(ONLY_ARGUMENTS)})\b"
_ARGUMENT = re.compile(rf"{NOT_QUOTED}(?:{_WITH_VALUE}|{_BARE}|\(until\))")
_GRID = re.compile(r'vary=\{"([^"]+)": "([^"]+)"\}')


def complain(message: str, status: int) -> int:
    """Print a message on standard error, in words of the command line; return `status`.

    Each of its lines begins with "rodimpact: ". Nothing is printed if the stream is
    closed.
    """
    with suppress(OSError):  # standard error is closed
        for line in as_options(message).splitlines():
            print(f"rodimpact: {line}", file=sys.stderr)
    return status


def print_progress(text: str) -> None:
    """Print how far the work is, at a terminal only.

    A program that reads the results never sees it.
    """
    if sys.stderr.isatty():
        print(text, file=sys.stderr)


def option_of(argument: str) -> str:
    """The option of this argument: ``--max-events`` of ``max_events``."""
    return "--" + argument.replace("_", "-")


def as_options(text: str) -> str:
    """The text with arguments and calls of Python in the words of the command line.

    Arguments become options; in a line about the table [solve] they become its entries.

    Examples
    --------
    >>> as_options('leave out until= to run to the proof, or give force=True')
    'leave out --until to run to the proof, or give --force'
    """
    lines = []
    for line in text.split("\n"):
        line = _GRID.sub(r"rodimpact sweep --vary \1=\2", line)
        for pattern, phrase in PHRASES.items():
            line = re.sub(pattern, phrase, line)
        if line.startswith(("solve.", "solve:")):
            line = _ARGUMENT.sub(_as_key, line)
        else:
            line = _ARGUMENT.sub(_as_option, line)
        lines.append(line)
    return "\n".join(lines)


def _as_key(match: re.Match[str]) -> str:
    """The key that replaces an argument in a line about the table [solve] of a case.

    A value that the message gives in quotation marks follows as `key = "value"`.
    """
    argument = _argument_in(match)
    if match["value"]:
        return f'solve.{argument} = "{match["value"]}"'
    return f"solve.{argument}"


def _as_option(match: re.Match[str]) -> str:
    """The option that replaces an argument, with its value if the message gives one.

    "(until)" becomes "(--until)".
    """
    if match[0] == "(until)":  # an example: "lower the cap, or stop earlier (until)"
        return "(--until)"
    argument = _argument_in(match)
    option = option_of(OPTION_OF.get(argument, argument))
    if match["value"]:
        return f"{option} {match['value']}"
    return option


def _argument_in(match: re.Match[str]) -> str:
    """Name of the argument in a match of `_ARGUMENT`, for "(until)" "until"."""
    for group in ("named", "bare"):
        if match[group] is not None:
            return match[group]
    return "until"  # The text "(until)" is the only match without a group.
