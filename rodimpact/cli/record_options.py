"""Options for the places of gauges, for the form of a record, and for its conversion to strain.

--gauge incident=1:0.5 is 0.5 m into body 1; without --gauge the gauges are those of the case.
"""

import argparse
from collections.abc import Iterable
from typing import Any, TypeAlias

from .. import Bridge, Case, Rod, Signal, read_signals
from ..model.frozen import nearest
from ..model.numbering import body_names
from ..records.bridge import ALONG
from .asking import Given, number
from .options import flag

_BRIDGE = {
    "gauge_factor": "dimensionless",
    "excitation": "voltage",
    "gain": "dimensionless",
    "poisson_ratio": "dimensionless",
}
Places: TypeAlias = dict[str, tuple[int, float]]
FORM = "NAME=BODY:X"


def add_gauge_option(parser: argparse.ArgumentParser, what: str) -> None:
    """The option --gauge, which may be given again and again."""
    parser.add_argument(
        "--gauge",
        metavar=FORM,
        action="append",
        default=[],
        help=f"{what}: incident=1:0.5 is 0.5 m into body 1",
    )


def gauge_places(given: Given, case: Case | None) -> Places:
    """Bodies and places of gauges by name: those given, or else those of the case."""
    places: Places = {}
    bodies = case.system.bodies if case else ()
    rods = {
        i: float(body.length) for i, body in enumerate(bodies) if isinstance(body, Rod)
    }
    names = body_names([body.kind for body in bodies])
    for i, gauge in enumerate(case.gauges if case and not given.gauge else ()):
        far = gauge.fraction * rods[gauge.body]
        name = gauge.name or f"{names[gauge.body]} at {far:g} m"
        if name in places:
            given.problems.append(
                (f"gauges.{i}", f"two gauges are called {name}; rename one")
            )
        places[name] = gauge.body, far
    for text in given.gauge:
        name, _, place = text.rpartition("=")
        number, _, x = place.partition(":")
        if not name or not number.strip().isdecimal() or not x or name in places:
            message = (
                f"must be {FORM}, such as incident=1:0.5, each name once, got {text!r}"
            )
            given.problems.append(("--gauge", message))
            continue
        option = f"--gauge {name}"
        places[name] = body, at = int(number), given.number(option, x, "length")
        if case and body not in rods:
            message = (
                f"body {number} is no rod; the rods are {', '.join(map(str, rods))}"
            )
            given.note(option, message)
        elif case and not 0 <= at <= rods[body]:
            message = f"must lie in body {number}, 0 to {rods[body]!r} m, got {x!r}"
            given.note(option, message)
    return places


def add_case_and_record(parser: argparse.ArgumentParser) -> None:
    """The case, the record, the places of its gauges, and the output."""
    parser.add_argument("case", metavar="CASE.toml", help="the case file")
    parser.add_argument("record", metavar="RECORD.csv", help="the record, a text table")
    add_gauge_option(parser, "a channel of the record and the place of its gauge")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--save", metavar="FILE", help="draw the result: .png, .svg or .pdf"
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")


def add_record_options(parser: argparse.ArgumentParser) -> None:
    """How to read the record, and its bridge."""
    record = parser.add_argument_group(
        "form of the record, where the file does not state it"
    )
    record.add_argument("--time", metavar="COLUMN", help="the column of times")
    record.add_argument("--time-unit", metavar="UNIT", help="s, ms, us or ns")
    number(record, "--rate", "frequency", "sampling rate of a record without times")
    record.add_argument("--decimal", metavar="SIGN", help="decimal sign: . or ,")
    record.add_argument(
        "--unit",
        metavar="[CHANNEL=]UNIT",
        action="append",
        default=[],
        help="unit of all channels, or of one",
    )
    bridge = parser.add_argument_group("strain from the volts of a bridge")
    bridge.add_argument("--bridge", choices=tuple(ALONG))
    for name, dimension in _BRIDGE.items():
        number(bridge, flag(name), dimension, "")


def _bridge(given: Given) -> Bridge | None:
    """The bridge, if one is named."""
    own = {
        name: number for name in _BRIDGE if (number := getattr(given, name)) is not None
    }
    if given.bridge is None:
        given.problems += [
            (flag(name), "needs --bridge, the kind of the bridge") for name in own
        ]
        return None
    missing = [name for name in ("gauge_factor", "excitation") if name not in own]
    given.problems += [
        (flag(name), "is missing; --bridge needs it") for name in missing
    ]
    if missing:
        return None
    return given.attempt(Bridge, given.bridge, **own, names={"kind": "--bridge"})


def read_record(given: Given, wanted: Iterable[str]) -> dict[str, Signal]:
    """Channels of the record, the wanted ones as strain if there is a bridge.

    None, and its mistakes noted, if one cannot be read.
    """
    bridge = _bridge(given)
    units: Any = dict(text.rpartition("=")[::2] for text in given.unit) or None
    if units and units.keys() == {""}:
        units = units[""]  # for all channels
    if given.problems:
        return {}
    try:
        signals = (
            given.attempt(
                read_signals,
                given.record,
                time=given.time,
                time_unit=given.time_unit,
                rate=given.rate,
                units=units,
                decimal=given.decimal,
                names={"units": "--unit"},
            )
            or {}
        )
    except OSError as error:
        given.problems.append(
            (given.record, f"cannot be read: {error.strerror or error}")
        )
        return {}
    for name in wanted if signals else ():
        if name not in signals:
            near = nearest(name, signals)
            given.note(f"--gauge {name}", f"the record has no channel {name!r}; {near}")
        elif bridge:
            with given.naming(names={"volts": f"--bridge of {name}"}):
                signals[name] = bridge.strain(signals[name])
    return signals
