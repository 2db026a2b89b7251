"""Values that spoil an argument: numbers that hurt, and things of every other kind."""

import datetime
import decimal
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from fuzz import good_calls

import rodimpact as ri


class Hostile:
    """No number, with a long repr and control characters in it."""

    def __repr__(self):
        return "\x1b[31mHostile" * 1000


BAD_NUMBERS: dict[str, Callable[[], Any]] = {
    "nan": lambda: math.nan,
    "inf": lambda: math.inf,
    "-inf": lambda: -math.inf,
    "-1": lambda: -1,
    "0": lambda: 0,
    "0.5": lambda: 0.5,
    "3": lambda: 3,
    "1.7e308": lambda: 1.7e308,
    "-1.7e308": lambda: -1.7e308,
    "5e-324": lambda: 5e-324,
    "10**18": lambda: 10**18,
    "10**400": lambda: 10**400,
    "int8": lambda: np.int8(3),
    "signalling nan": lambda: decimal.Decimal("sNaN"),
    "array of one": lambda: np.array(0.3),
    "array of two": lambda: np.array([0.1, 0.2]),
    "array of two axes": lambda: np.array([[0.1, 0.2], [0.3, 0.4]]),
    "list of two": lambda: [0.1, 0.2],
    "whole numbers": lambda: (1, 2),
    "range": lambda: range(3),
}
"""Numbers, some of which are right for some arguments."""

BAD_WORDS: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "True": lambda: True,
    "empty text": lambda: "",
    "x": lambda: "x",
    "1 kg": lambda: "1 kg",
    "escape": lambda: "\x1b[31mred",
    "long text": lambda: "long" * 5000,
    "zero byte": lambda: "x\0",
    "empty list": list,
    "empty array": lambda: np.array([]),
    "array without columns": lambda: np.ones((2, 0)),
    "list of None": lambda: [None],
    "list of text": lambda: ["x"],
    "ragged list": lambda: [1, [2, 3]],
    "empty dict": dict,
    "dict": lambda: {"a": 1},
    "generator": lambda: iter([1.0]),
    "function": lambda: lambda *given: 0.0,
    "rod": lambda: good_calls.ROD,
    "family of rods": lambda: good_calls.FAMILY.bodies[0],
    "list of rods": lambda: [good_calls.ROD, ri.Wall()],
    "wall": ri.Wall,
    "law": lambda: ri.Spring(1e7),
    "end": lambda: ri.Pushed(10.0),
    "steps": lambda: ri.Steps([1.0, 0.0], [0.1]),
    "samples": lambda: ri.Samples([1.0, 2.0]),
    "system": lambda: good_calls.HERTZIAN,
    "family": lambda: good_calls.FAMILY,
    "options": ri.Options,
    "signal": lambda: good_calls.VOLTS,
    "material": lambda: good_calls.STEEL,
}
"""Things of other kinds, some of which are right for some arguments."""

NEVER_RIGHT: dict[str, Callable[[], Any]] = {
    "complex": lambda: 1j,
    "complex array": lambda: np.array([1j]),
    "bytes": lambda: b"1",
    "date": lambda: datetime.date(2000, 1, 1),
    "datetime64": lambda: np.datetime64("2000-01-01"),
    "timedelta64": lambda: np.timedelta64(1, "s"),
    "dates": lambda: np.array(["2000-01-01", "2000-01-02"], dtype="datetime64[s]"),
    "masked array": lambda: np.ma.masked_array([1.0, 2.0], [True, False]),
    "set": lambda: {1, 2},
    "object": object,
    "hostile": Hostile,
    "class": lambda: ri.Rod,
    "module": lambda: math,
}
"""Things that are right for no argument, so every call must refuse them."""

BAD_VALUES = BAD_NUMBERS | BAD_WORDS | NEVER_RIGHT
