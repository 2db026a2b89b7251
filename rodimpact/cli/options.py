"""Messages name the arguments of Python; on the command line they name its options."""

import re

_BARE = ("max_events", "rtol", "dt")  # no words of English
_NAMED = (
    *_BARE,
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
)
_NAMES = {"units": "unit", "allow_energy_release": "energy_release"}
_BEFORE = (
    r"(?<![-\w.'\"])"  # neither options, keys of a case file nor what somebody wrote
)
_ARGUMENT = re.compile(
    rf'{_BEFORE}(?:({"|".join(_NAMED)})=(?:True|"([^"]*)")?|({"|".join(_BARE)})\b|\(until\))'
)
_GRID = re.compile(r'vary=\{"([^"]+)": "([^"]+)"\}')


def flag(argument: str) -> str:
    """The option of this argument."""
    return "--" + argument.replace("_", "-")


def as_options(text: str) -> str:
    """The text with the options of the command line in place of the arguments of Python.

    Examples
    --------
    >>> as_options('leave out until= to run to the proof, raise max_events or give force=True')
    'leave out --until to run to the proof, raise --max-events or give --force'
    """
    return "\n".join(
        _ARGUMENT.sub(
            _key if line.startswith(("solve.", "solve:")) else _option,
            _GRID.sub(r"rodimpact sweep --vary \1=\2", line),
        )
        for line in text.split("\n")
    )


def _key(found: re.Match[str]) -> str:
    """The key of a case file, for what is told of [solve]."""
    named, value, bare = found.groups()
    return f"solve.{named or bare or 'until'}" + (f' = "{value}"' if value else "")


def _option(found: re.Match[str]) -> str:
    named, value, bare = found.groups()
    if named is None and bare is None:
        return "(--until)"
    name = flag(_NAMES.get(named, named or bare))
    return f"{name} {value}" if value else name
