"""Messages name the arguments of Python; on the command line they name its options."""

from __future__ import annotations

import re

_BARE = ("max_events", "rtol", "dt")  # no words of English
_NAMED = (*_BARE, "until", "cells", "method", "force", "time", "time_unit", "rate", "units",
          "decimal", "radius", "on_error", "allow_energy_release")
_NAMES = {"units": "unit", "allow_energy_release": "energy_release"}
_BEFORE = r"(?<![-\w.'\"])"  # neither options, keys of a case file nor what somebody wrote
_ARGUMENT = re.compile(
    rf'{_BEFORE}(?:({"|".join(_NAMED)})=(?:True|"([^"]*)")?|({"|".join(_BARE)})\b|\(until\))')
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
    return "\n".join(as_keys(line) if line.startswith(("solve.", "solve:")) else _told(line)
                     for line in text.split("\n"))


def as_keys(text: str) -> str:
    """The text with the keys of a case file in their place, for commands without these options."""
    return _ARGUMENT.sub(_key, text)


def _told(line: str) -> str:
    line = _GRID.sub(r"rodimpact sweep --vary \1=\2", line)
    return _ARGUMENT.sub(_option, line)


def _key(found: re.Match[str]) -> str:
    named, value, bare = found.groups()
    return f"solve.{named or bare or 'until'}" + (f' = "{value}"' if value else "")


def _option(found: re.Match[str]) -> str:
    named, value, bare = found.groups()
    if named is None and bare is None:
        return "(--until)"
    name = flag(_NAMES.get(named, named or bare))
    return f"{name} {value}" if value else name
