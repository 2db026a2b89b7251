"""Option for positions of gauges.

--gauge incident=1:0.5 is 0.5 m into body 1; without --gauge the gauges are those of the
case.
"""

import argparse
from typing import NamedTuple, TypeAlias

from .. import Case, Rod
from ..model.numbering import body_names
from ..units import shown
from .arguments import Arguments

GAUGE_FORM = "NAME=BODY:X"


class GaugePosition(NamedTuple):
    """Position of a gauge."""

    body: int
    x: float  # distance from the left end of the body, m


GaugePositions: TypeAlias = dict[str, GaugePosition]
"""Positions of gauges by name."""


def add_gauge_option(parser: argparse.ArgumentParser, meaning: str) -> None:
    """Add the option --gauge, which may be given several times.

    The help begins with `meaning`. Without the option its list is empty.
    """
    parser.add_argument(
        "--gauge",
        metavar=GAUGE_FORM,
        action="append",
        default=[],
        help=f"{meaning}: incident=1:0.5 is 0.5 m from the left end of body 1; the "
        "first body is body 0",
    )


def gauge_positions(args: Arguments, case: Case | None) -> GaugePositions:
    """Positions of the gauges in --gauge, or without it those of the case.

    Mistakes are added to the problems of the call. The result is empty without --gauge
    and case.
    """
    if not args.gauge:
        return _positions_in_case(args, case)
    return positions_in(args, case, "--gauge", args.gauge)


def positions_in(
    args: Arguments, case: Case | None, option: str, texts: list[str]
) -> GaugePositions:
    """Positions of gauges, which an option gives as texts of the form `GAUGE_FORM`.

    Problems are added: of texts of another form, names that occur twice, and gauges
    outside the rods of the case.
    """
    positions: GaugePositions = {}
    for text in texts:
        name, _, position_text = text.rpartition("=")
        number, _, x = position_text.partition(":")
        has_body = number.strip().isdecimal()
        is_complete = name != "" and has_body and x != ""
        if not is_complete or name in positions:
            message = (
                f"must be {GAUGE_FORM}, such as incident=1:0.5, each name once, got "
                f"{shown(text)}"
            )
            args.problems.append((option, message))
            continue
        path = f"{option} {name}"
        position = GaugePosition(int(number), args.number(path, x, "length"))
        positions[name] = position
        if case is not None:
            _check_position(args, path, position, x, case)
    return positions


def _check_position(
    args: Arguments, option: str, position: GaugePosition, x: str, case: Case
) -> None:
    """Add a problem if a gauge lies in no rod; `x` is the text of its position."""
    lengths = _rod_lengths(case)
    if position.body not in lengths:
        rods = ", ".join(map(str, lengths))
        message = f"body {position.body} is no rod; the rods are {rods}"
        args.add_problem(option, message)
        return
    length = lengths[position.body]
    if not 0 <= position.x <= length:
        message = f"must lie in body {position.body}, 0 to {length!r} m, got {x!r}"
        args.add_problem(option, message)


def _positions_in_case(args: Arguments, case: Case | None) -> GaugePositions:
    """Positions of the gauges in a case, by name; {} without a case.

    A gauge without a name is named by body and position. A problem is added for two
    gauges with one name.
    """
    positions: GaugePositions = {}
    if case is None:
        return positions
    lengths = _rod_lengths(case)
    names_of_bodies = body_names([body.kind for body in case.system.bodies])
    for i, gauge in enumerate(case.gauges):
        x = gauge.fraction * lengths[gauge.body]
        name = gauge.name
        if not name:
            name = f"{names_of_bodies[gauge.body]} at {x:g} m"
        if name in positions:
            message = f"two gauges are called {name}; rename one"
            args.problems.append((f"gauges.{i}", message))
        positions[name] = GaugePosition(gauge.body, x)
    return positions


def _rod_lengths(case: Case) -> dict[int, float]:
    """Lengths of the rods, m, by the index of the body."""
    lengths = {}
    for i, body in enumerate(case.system.bodies):
        if isinstance(body, Rod):
            lengths[i] = float(body.length)
    return lengths
