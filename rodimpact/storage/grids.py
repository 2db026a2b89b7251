"""Numbers of a case that vary: the text "0.1:1:200" becomes an array along an axis of its own."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from .. import units
from ..model.frozen import MOST_MEMBERS, Number, refusal
from ..model.quantities import MOST_AXES, Floats
from ..units import shown

FORM = "start:stop:count, start:stop:count:log or a list such as 0.1,0.2,0.4"
SPACED = re.compile(
    r"(?P<start>[^:]*):(?P<stop>[^:]*):\s*(?P<count>[0-9]{1,20})\s*(?P<log>:\s*log\s*)?"
)


class Varied(NamedTuple):
    """A number of a case that runs through a grid.

    path : such as ``bodies.0.length``; values : array of shape (n,), in `unit`;
    unit : of SI, "" for a pure number.
    """

    path: str
    values: Floats
    unit: str


class Grids:
    """The numbers to vary: hands out the array of each when it is asked for by its path."""

    def __init__(self, vary: Mapping[str, str] | None = None) -> None:
        given: Any = {} if vary is None else vary
        if not isinstance(given, Mapping) or not all(
            isinstance(path, str) for path in given
        ):
            message = f"must name numbers by their paths, each with a grid, got {shown(given)}"
            raise refusal("vary", message)
        self.texts: dict[str, Any] = dict(given)
        self.known: dict[str, None] = {}  # all numbers that can be varied
        self.taken: dict[str, Varied] = {}
        if len(self.texts) > MOST_AXES:
            message = (
                f"is one of {len(self.texts)} numbers; at most {MOST_AXES} vary at once"
            )
            raise refusal(list(self.texts)[MOST_AXES], message)

    def ask(self, path: str) -> bool:
        """Whether this number is varied."""
        self.known[path] = None
        return path in self.texts

    def take(self, path: str, dimension: str) -> Number:
        """Array along the axis of this grid; ValueError for a text that is none."""
        values = _values(self.texts[path], dimension)
        self.taken[path] = Varied(path, values, units.si_unit(dimension))
        return values.reshape([-1 if other == path else 1 for other in self.texts])


def _values(text: Any, dimension: str) -> Floats:
    """All values of a grid, shape (n,), in SI units."""
    if isinstance(text, str) and ":" not in text:
        return np.array([units.parse(number, dimension) for number in text.split(",")])
    found = SPACED.fullmatch(text) if isinstance(text, str) else None
    if found is None or not 1 <= int(found["count"]) <= MOST_MEMBERS:
        raise ValueError(
            f"must be {FORM}, with 1 to {MOST_MEMBERS} values; got {shown(text)}"
        )
    start, stop = (units.parse(found[end], dimension) for end in ("start", "stop"))
    size = int(found["count"])
    if size == 1 and start != stop:
        raise ValueError(
            f"one value cannot be at both ends; raise the count in {shown(text)}"
        )
    if found["log"] and min(start, stop) <= 0:
        raise ValueError(f"needs ends above 0 for equal ratios, got {shown(text)}")
    with np.errstate(all="ignore"):
        values = (np.geomspace if found["log"] else np.linspace)(start, stop, size)
    if not np.isfinite(values).all():
        raise ValueError(f"the ends of {shown(text)} are too far apart")
    return values
