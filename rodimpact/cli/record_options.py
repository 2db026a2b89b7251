"""Options for the places of gauges, for the form of a record, and for its conversion to strain.

--gauge incident=1:0.5 is 0.5 m into body 1; without --gauge the gauges are those of the case.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from ..model import Rod
from ..model.frozen import Problems, nearest
from ..model.numbering import body_names
from ..records.bridge import ALONG, Bridge
from ..records.reading import read_signals
from ..records.signal import Signal
from ..storage.casefile import Case, read_case
from .asking import attempt, numbers, quantity
from .options import flag
from .progress import progress_bar

_BRIDGE = {"gauge_factor": "dimensionless", "excitation": "voltage", "gain": "dimensionless",
           "poisson_ratio": "dimensionless"}
_RECORD = {"rate": "frequency", **_BRIDGE}  # dimensions of the numbers among these options
_OPTIONS = {"time": "--time", "time_unit": "--time-unit", "rate": "--rate", "units": "--unit",
            "decimal": "--decimal", "kind": "--bridge"}
Places: TypeAlias = dict[str, tuple[int, float]]
FORM = "NAME=BODY:X"


def add_gauge_option(parser: argparse.ArgumentParser, what: str) -> None:
    """The option --gauge, which may be given again and again."""
    parser.add_argument("--gauge", metavar=FORM, action="append", default=[],
                        help=f"{what}: incident=1:0.5 is 0.5 m into body 1")


def gauge_places(problems: Problems, given: list[str], case: Case | None) -> Places:
    """Bodies and places of gauges by name: those given, or else those of the case."""
    places: Places = {}
    bodies = case.system.bodies if case else ()
    names = body_names([body.kind for body in bodies])
    for i, gauge in enumerate(case.gauges if case and not given else ()):
        rod = bodies[gauge.body]
        far = gauge.fraction * float(rod.length)  # type: ignore[union-attr]
        name = gauge.name or f"{names[gauge.body]} at {far:g} m"
        if name in places:
            problems.append((f"gauges.{i}", f"two gauges are called {name}; rename one"))
        places[name] = gauge.body, far
    for text in given:
        name, _, place = text.rpartition("=")
        number, _, x = place.partition(":")
        if not name or not number.strip().isdecimal() or not x or name in places:
            message = f"must be {FORM}, such as incident=1:0.5, each name once, got {text!r}"
            problems.append(("--gauge", message))
            continue
        option = f"--gauge {name}"
        places[name] = body, at = int(number), quantity(problems, option, x, "length")
        rods = {i: float(b.length) for i, b in enumerate(bodies) if isinstance(b, Rod)}
        if case and body not in rods:
            message = f"body {number} is no rod; the rods are {', '.join(map(str, rods))}"
            problems.append((option, message))
        elif case and not 0 <= at <= rods[body]:
            message = f"must lie in body {number}, 0 to {rods[body]!r} m, got {x!r}"
            problems.append((option, message))
    return places


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


def asked(
    problems: Problems, arguments: argparse.Namespace, dimensions: Mapping[str, str]
) -> tuple[Case | None, Places, dict[str, Any], Bridge | None]:
    """The case, the places of the gauges, the numbers that options give, and the bridge."""
    case = attempt(problems, read_case, arguments.case)
    places = gauge_places(problems, arguments.gauge, case)
    given = numbers(problems, arguments, {**dimensions, **_RECORD})
    return case, places, given, _bridge(problems, arguments, given)


def _bridge(
    problems: Problems, arguments: argparse.Namespace, given: dict[str, float]
) -> Bridge | None:
    """The bridge, if one is named."""
    own = {name: given[name] for name in _BRIDGE if name in given}
    if arguments.bridge is None:
        problems += [(flag(name), "needs --bridge, the kind of the bridge") for name in own]
        return None
    missing = [name for name in ("gauge_factor", "excitation") if name not in own]
    problems += [(flag(name), "is missing; --bridge needs it") for name in missing]
    if missing or not all(map(math.isfinite, own.values())):
        return None
    options = {name: flag(name) for name in _BRIDGE}
    return attempt(problems, Bridge, arguments.bridge, **own, options=options)


def read_record(
    problems: Problems, arguments: argparse.Namespace, given: dict[str, float],
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
                time_unit=arguments.time_unit, rate=given.get("rate"), units=units,
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
