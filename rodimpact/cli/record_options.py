"""Options for the files of a record, their form, and the bridge that measured it."""

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from .. import Bridge, Signal, read_signals
from ..hints import nearest
from ..records.bridge import GAUGES_ALONG
from .arguments import Arguments, add_number
from .gauge_options import add_gauge_option
from .messages import option_of


class BridgeNumber(NamedTuple):
    """A number of a bridge, as an option takes it."""

    dimension: str
    meaning: str


BRIDGE_NUMBERS = {
    "gauge_factor": BridgeNumber("dimensionless", "gauge factor of the strain gauges"),
    "excitation": BridgeNumber("voltage", "supply voltage of the bridge"),
    "gain": BridgeNumber(
        "dimensionless",
        "gain of the amplifier, negative if it inverts the signal; default 1",
    ),
    "poisson_ratio": BridgeNumber(
        "dimensionless",
        "Poisson's ratio of the bar, if gauges measure transverse strain",
    ),
}
"""Numbers of a bridge, by the names of its arguments."""


def add_case_and_record(parser: argparse.ArgumentParser) -> None:
    """Add the case, the record, the positions of its gauges, and the outputs.

    The record may be several files. The outputs are --json, --save and --force.
    """
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument(
        "record",
        metavar="RECORD.csv",
        nargs="+",
        help="the record: a text table, a workbook or a TDMS file; or several files, "
        "such as one for each channel",
    )
    add_gauge_option(parser, "a channel of the record and the position of its gauge")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--save", metavar="FILE", help="draw the result: .png, .svg or .pdf"
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")


def add_record_options(parser: argparse.ArgumentParser) -> None:
    """Add two groups of options: the form of the record, and its bridge."""
    record = parser.add_argument_group(
        "format of the record, if the file does not state it"
    )
    record.add_argument("--time", metavar="COLUMN", help="name of the column of times")
    record.add_argument(
        "--time-unit", metavar="UNIT", help="unit of the times: s, ms, us or ns"
    )
    add_number(
        record, "--rate", "frequency", "sampling rate, if the record has no times"
    )
    record.add_argument(
        "--decimal", metavar="SIGN", help="decimal sign of the numbers: . or ,"
    )
    record.add_argument(
        "--unit",
        metavar="[CHANNEL=]UNIT",
        action="append",
        default=[],
        help="unit of all channels, or of one channel",
    )
    bridge = parser.add_argument_group("strain from the output voltage of a bridge")
    bridge.add_argument(
        "--bridge",
        choices=tuple(GAUGES_ALONG),
        help="type of the bridge; needs --gauge-factor and --excitation",
    )
    for name, number in BRIDGE_NUMBERS.items():
        add_number(bridge, option_of(name), number.dimension, number.meaning)


def read_record(args: Arguments, wanted: Iterable[str]) -> dict[str, Signal]:
    """All channels of the record, the wanted ones as strain if there is a bridge.

    A problem is added for each wanted name that is no channel. The result is empty, and
    problems are added, if the record or its bridge is invalid. The record is not read
    if the call has problems already.
    """
    bridge = _bridge(args)
    if args.problems:
        return {}
    signals = _read_files(args)
    if not signals:
        return {}
    for name in wanted:
        if name not in signals:
            hint = nearest(name, signals)
            message = f"the record has no channel {name!r}; {hint}"
            args.add_problem(f"--gauge {name}", message)
        elif bridge is not None:
            with args.naming_mistakes(names={"volts": f"--bridge of {name}"}):
                signals[name] = bridge.strain(signals[name])
    return signals


def _read_files(args: Arguments) -> dict[str, Signal]:
    """Channels of all files of the record.

    A single file gives the channels their names. If there are several files, the name
    is FILE, or FILE.CHANNEL for a file with several channels; FILE is without folder
    and suffix, and a problem is added if two files share it. The result is empty, and a
    problem is added, if a file cannot be read.
    """
    signals: dict[str, Signal] = {}
    for path in args.record:
        try:
            channels = args.build_or_add_problems(
                read_signals,
                path,
                time=args.time,
                time_unit=args.time_unit,
                rate=args.rate,
                units=_units(args.unit),
                decimal=args.decimal,
                names={"units": "--unit"},
            )
        except OSError as error:
            reason = error.strerror if error.strerror else error
            args.problems.append((path, f"cannot be read: {reason}"))
            return {}
        except ImportError as error:  # a package that reads workbooks or TDMS files
            args.problems.append((path, str(error)))
            return {}
        if not channels:  # None: the reader has found mistakes, which are added
            return {}
        if len(args.record) == 1:
            return channels
        stem = Path(path).stem
        for name, signal in channels.items():
            full_name = stem
            if len(channels) > 1:
                full_name = f"{stem}.{name}"
            if full_name in signals:
                args.add_problem(path, f"two files are called {stem}; rename one")
            signals[full_name] = signal
    return signals


def _units(texts: list[str]) -> Any:
    """Unit of all channels, or units by channel; None if none is given.

    A text is a unit, such as "V", or a channel and its unit, such as "gauge 1=V". The
    last of several texts on the same channels counts. If both kinds of text are given,
    the key "" has the unit without a channel, and `read_signals` refuses this key.
    """
    units = {}  # by channel; "" is the channel of a text without "="
    for text in texts:
        channel, _, unit = text.rpartition("=")
        units[channel] = unit
    if not units:
        return None
    only_for_all = units.keys() == {""}
    if only_for_all:
        return units[""]
    return units


def _bridge(args: Arguments) -> Bridge | None:
    """The bridge of the call; None without --bridge.

    It is also None if the bridge is invalid; then problems are added. A problem is
    added, too, for each number of a bridge without --bridge.
    """
    numbers = {}
    for name in BRIDGE_NUMBERS:
        number = getattr(args, name)
        if number is not None:
            numbers[name] = number
    if args.bridge is None:
        for name in numbers:
            message = "needs --bridge, the kind of the bridge"
            args.problems.append((option_of(name), message))
        return None
    missing = [name for name in ("gauge_factor", "excitation") if name not in numbers]
    for name in missing:
        args.problems.append((option_of(name), "is missing; --bridge needs it"))
    if missing:
        return None
    return args.build_or_add_problems(
        Bridge, args.bridge, **numbers, names={"kind": "--bridge"}
    )
