"""Numbers of a case that vary: the text "0.1:1:200" becomes an array along an axis of its own."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from .. import units
from ..model.frozen import MOST_MEMBERS, InvalidModel, Number
from ..model.quantities import MOST_AXES, Floats
from ..units import shown

FORM = "start:stop:count, start:stop:count:log or a list such as 0.1,0.2,0.4"


class Varied(NamedTuple):
    """A number of a case that runs through a grid.

    path : such as ``bodies.0.length``; values : array of shape (n,), in `unit`;
    unit : of SI, "" for a pure number.
    """

    path: str
    values: Floats
    unit: str


class Grid(NamedTuple):
    """A grid as its text describes it.

    text : as given; numbers : those in it, with their units; size : count of values;
    ratio : whether their ratio is constant, not their difference.
    """

    text: str
    numbers: list[str]
    size: int
    ratio: bool = False

    @classmethod
    def of(cls, text: Any) -> Grid:
        """Read the text of a grid; ValueError if it is none."""
        if not isinstance(text, str):
            raise ValueError(f"must be the text of a grid, {FORM}, got {shown(text)}")
        first, *rest = (part.strip() for part in text.split(":"))
        if not rest:
            numbers = first.split(",")
            return cls(text, numbers, len(numbers))
        if len(rest) != 2 and rest[2:] != ["log"]:
            raise ValueError(f"must be {FORM}, got {shown(text)}")
        stop, count = rest[:2]
        if not re.fullmatch("0{0,9}[1-9][0-9]{0,9}", count):
            raise ValueError(
                f"needs a whole number of values from 1 to {MOST_MEMBERS}, as in {FORM}; "
                f"got {shown(count)} in {shown(text)}"
            )
        return cls(text, [first, stop], int(count), len(rest) == 3)

    def values(self, dimension: str) -> Floats:
        """All values, shape (n,), in SI units; ValueError where the numbers make none."""
        numbers = [units.parse(text, dimension) for text in self.numbers]
        if ":" not in self.text:
            return np.array(numbers)
        start, stop = numbers
        if self.ratio and min(numbers) <= 0:
            raise ValueError(f"needs ends above 0 for equal ratios, got {shown(self.text)}")
        if self.size == 1 and start != stop:
            message = "one value cannot be at both ends; raise the count in"
            raise ValueError(f"{message} {shown(self.text)}")
        with np.errstate(all="ignore"):
            values = (np.geomspace if self.ratio else np.linspace)(start, stop, self.size)
        if not np.isfinite(values).all():
            raise ValueError(f"the ends of {shown(self.text)} are too far apart")
        return values


class Grids:
    """The numbers to vary: hands out the array of each when it is asked for by its path."""

    def __init__(self, vary: Mapping[str, str] | None = None) -> None:
        given: Any = {} if vary is None else vary
        if not isinstance(given, Mapping) or not all(isinstance(path, str) for path in given):
            message = f"must name numbers by their paths, each with a grid, got {shown(given)}"
            raise InvalidModel([("vary", message)])
        self.texts: dict[str, Any] = dict(given)
        self.known: dict[str, None] = {}  # all numbers that can be varied
        self.taken: dict[str, Varied] = {}
        if len(self.texts) > MOST_AXES:
            message = f"is one of {len(self.texts)} numbers; at most {MOST_AXES} vary at once"
            raise InvalidModel([(list(self.texts)[MOST_AXES], message)])
        counts = []
        for text in self.texts.values():
            with suppress(ValueError):  # it is said when the grid is taken
                counts.append(Grid.of(text).size)
        if math.prod(counts) > MOST_MEMBERS:  # said alone: nothing of it can be laid out
            made = " x ".join(map(str, counts))
            message = f"the grids make {made} collisions, more than {MOST_MEMBERS}"
            remedy = "take fewer values, or sweep one part after another"
            raise InvalidModel([(next(iter(self.texts)), f"{message}; {remedy}")])

    def ask(self, path: str) -> bool:
        """Whether this number is varied."""
        self.known[path] = None
        return path in self.texts

    def take(self, path: str, dimension: str) -> Number:
        """Array along the axis of this grid; ValueError for a text that is none."""
        values = Grid.of(self.texts[path]).values(dimension)
        self.taken[path] = Varied(path, values, units.si_unit(dimension))
        return values.reshape([-1 if other == path else 1 for other in self.texts])
