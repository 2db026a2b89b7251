"""Numbers of a case that vary: the text "0.1:1:200" becomes an array along an axis of its own."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from .. import units
from ..model.frozen import MOST_MEMBERS, Number, invalid_argument
from ..model.quantities import MAX_AXES, Floats
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


class Grid:
    """The text of a grid, which stands in for the number at a path.

    Attributes
    ----------
    varied : Varied or None
        The values, once the number is read and its dimension is known.
    """

    def __init__(self, path: str, text: Any, shape: list[int]) -> None:
        self.path = path
        self.text = text
        self.varied: Varied | None = None
        self._shape = (
            shape  # shape of the array: -1 along the axis of this grid, else 1
        )

    def array(self, dimension: str) -> Number:
        """Values of the number along the axis of this grid; ValueError if it is no grid."""
        values = grid_values(self.text, dimension)
        self.varied = Varied(self.path, values, units.si_unit(dimension))
        return values.reshape(self._shape)


def read_grids(vary: Mapping[str, str] | None) -> dict[str, Grid]:
    """Return the grids by their paths, the k-th along axis k; InvalidModel for anything else."""
    texts: Any = vary
    if vary is None:
        texts = {}
    is_mapping = isinstance(texts, Mapping)
    if not is_mapping or not all(isinstance(path, str) for path in texts):
        message = "must name numbers by their paths, each with a grid"
        raise invalid_argument("vary", f"{message}, got {shown(texts)}")
    if len(texts) > MAX_AXES:
        message = f"is one of {len(texts)} numbers; at most {MAX_AXES} vary at once"
        raise invalid_argument(list(texts)[MAX_AXES], message)
    grids = {}
    for axis, path in enumerate(texts):
        shape = [1] * len(texts)
        shape[axis] = -1
        grids[path] = Grid(path, texts[path], shape)
    return grids


def grid_values(text: Any, dimension: str) -> Floats:
    """All values of a grid, shape (n,), in SI units; ValueError unless a text in `FORM`."""
    if isinstance(text, str) and ":" not in text:
        return np.array([units.parse(number, dimension) for number in text.split(",")])
    spaced = None
    if isinstance(text, str):
        spaced = SPACED.fullmatch(text)
    if spaced is None or not 1 <= int(spaced["count"]) <= MOST_MEMBERS:
        message = f"must be {FORM}, with 1 to {MOST_MEMBERS} values"
        raise ValueError(f"{message}; got {shown(text)}")
    start = units.parse(spaced["start"], dimension)
    stop = units.parse(spaced["stop"], dimension)
    count = int(spaced["count"])
    if count == 1 and start != stop:
        message = "one value cannot be at both ends; raise the count in"
        raise ValueError(f"{message} {shown(text)}")
    if spaced["log"] and min(start, stop) <= 0:
        raise ValueError(f"needs ends above 0 for equal ratios, got {shown(text)}")
    with np.errstate(all="ignore"):
        if spaced["log"]:
            values = np.geomspace(start, stop, count)
        else:
            values = np.linspace(start, stop, count)
    if not np.isfinite(values).all():
        raise ValueError(f"the ends of {shown(text)} are too far apart")
    return values
