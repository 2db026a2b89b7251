"""Where strain gauges sit: --gauge incident=1:0.5 is 0.5 m into body 1; else as the case says."""

from __future__ import annotations

import argparse
from typing import TypeAlias

from ..model import Rod
from ..model.frozen import Problems
from ..model.numbering import body_names
from ..storage.casefile import Case
from .asking import quantity

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
