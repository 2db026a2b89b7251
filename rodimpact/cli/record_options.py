"""Options for the form of a record, and for its conversion to strain."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable
from typing import Any

from ..model.frozen import Problems, nearest
from ..records.bridge import ALONG, Bridge
from ..records.reading import read_signals
from ..records.signal import Signal
from .asking import attempt
from .gauge_places import add_gauge_option
from .options import flag
from .progress import progress_bar

_BRIDGE = {"gauge_factor": "dimensionless", "excitation": "voltage", "gain": "dimensionless",
           "poisson_ratio": "dimensionless"}
RECORD = {"rate": "frequency", **_BRIDGE}
"""Dimensions of the numbers among these options."""
_OPTIONS = {"time": "--time", "time_unit": "--time-unit", "rate": "--rate", "units": "--unit",
            "decimal": "--decimal", "kind": "--bridge"}


def add_case_and_record(parser: argparse.ArgumentParser) -> None:
    """The case, the record, the places of its gauges, and the output."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("record", metavar="RECORD.csv", help="the record, a text table")
    add_gauge_option(parser, "a channel of the record and the place of its gauge")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--save", metavar="FILE", help="draw the result: .png, .svg or .pdf")
    parser.add_argument("--force", action="store_true", help="replace existing files")


def add_record_options(parser: argparse.ArgumentParser) -> None:
    """How to read the record, and its bridge."""
    record = parser.add_argument_group("form of the record, where the file does not state it")
    for name, metavar, what in (
        ("time", "COLUMN", "the column of times"), ("time-unit", "UNIT", "s, ms, us or ns"),
        ("rate", "FREQUENCY", "sampling rate of a record without times"),
        ("decimal", "SIGN", "decimal sign: . or ,"),
    ):
        record.add_argument(f"--{name}", metavar=metavar, help=what)
    record.add_argument("--unit", metavar="[CHANNEL=]UNIT", action="append", default=[],
                        help="unit of all channels, or of one")
    bridge = parser.add_argument_group("strain from the volts of a bridge")
    bridge.add_argument("--bridge", choices=tuple(ALONG))
    for name in _BRIDGE:
        bridge.add_argument(flag(name), metavar="X")


def bridge_of(
    problems: Problems, arguments: argparse.Namespace, numbers: dict[str, float]
) -> Bridge | None:
    """The bridge, if one is named."""
    given = {name: numbers[name] for name in _BRIDGE if name in numbers}
    if arguments.bridge is None:
        problems += [(flag(name), "needs --bridge, the kind of the bridge") for name in given]
        return None
    missing = [name for name in ("gauge_factor", "excitation") if name not in given]
    problems += [(flag(name), "is missing; --bridge needs it") for name in missing]
    if missing or not all(map(math.isfinite, given.values())):
        return None
    options = {name: flag(name) for name in _BRIDGE}
    return attempt(problems, Bridge, arguments.bridge, **given, options=options)


def read_record(
    problems: Problems, arguments: argparse.Namespace, numbers: dict[str, float],
    wanted: Iterable[str],
) -> dict[str, Signal]:
    """Channels of the record; none, and an entry in `problems`, if one cannot be read."""
    by_channel = dict(text.rsplit("=", 1) for text in arguments.unit if "=" in text)
    for_all = [text for text in arguments.unit if "=" not in text]
    if for_all and len(arguments.unit) > 1:
        problems.append(("--unit", "give one unit for all channels, or CHANNEL=UNIT for each"))
    if problems:
        return {}
    units: Any = for_all[0] if for_all else by_channel or None
    try:
        with progress_bar("characters") as bar:
            signals = attempt(
                problems, read_signals, arguments.record, time=arguments.time,
                time_unit=arguments.time_unit, rate=numbers.get("rate"), units=units,
                decimal=arguments.decimal, progress=bar, options=_OPTIONS,
            ) or {}
    except OSError as error:
        problems.append((arguments.record, f"cannot be read: {error.strerror or error}"))
        return {}
    problems += [
        (f"--gauge {name}", f"the record has no channel {name!r}; {nearest(name, signals)}")
        for name in wanted if signals and name not in signals
    ]
    return signals
