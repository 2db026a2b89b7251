"""Tables of a case file, with every mistake noted by its path.

A table has numbers, words and tables by their keys. A class of the model declares its
numbers in `fields`: unit, sign, default. A table is read by these declarations, so a
new field or class needs no line here. A number with a mistake becomes nan, and reading
goes on.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Collection, Mapping
from typing import Any

from .. import units
from ..hints import listed, nearest
from ..model.frozen import MOST_TOLD, REQUIRED, InvalidModel, QuantityField
from ..model.profiles import Polynomials, Samples, Steps
from ..units import shown
from .grids import Grid, Tie

PROFILE_SYNTAX = {  # for messages: how a profile is written, by `QuantityField.along`
    "length": " A profile is written {values = [...], at = [...]} or "
    "{samples = [...]};",
    "time": " A profile is written {values = [...], at = [...]} or "
    "{samples = [...], step = ...};",
}
KEYS_OF_SAMPLE_PATHS = {r"^values\[(\d+)\]": r"samples.\1", "^values": "samples"}
"""Keys of a profile of samples that the model calls otherwise.

Each is a pattern and its replacement.
"""
SAMPLE_STEP = Samples.fields["step"]._replace(default=REQUIRED)
POLYNOMIAL_KEYS = {
    r"^values\[(\d+)\]": r"polynomials.\1",
    "^values": "polynomials",
}
"""Keys of a profile of polynomials, where the model has other names."""
SAME_NAMES: Mapping[str, str] = {}
"""Names of a table whose keys are those of the model."""
MATERIAL_PLACE = "a table of the material, [materials.NAME]"
PLACE_OF_KEY = {
    "E": f"{MATERIAL_PLACE}, as youngs_modulus",
    "density": MATERIAL_PLACE,
    "poisson_ratio": MATERIAL_PLACE,
    "rho": f"{MATERIAL_PLACE}, as density",
    "shaft": "a rod, below its [[bodies]], as the table [bodies.shaft]",
    "soil": "a rod, below its [[bodies]], as the table [bodies.shaft]",
    "viscosity": MATERIAL_PLACE,
    "youngs_modulus": MATERIAL_PLACE,
}
"""Where a key belongs that stands in a table without such a key."""
CURVE_KEYS = ("smooth", "error")
"""Keys of a profile of samples that say how the curve runs between them."""


@dataclasses.dataclass
class Reading:
    """Everything that reading one file collects.

    Attributes
    ----------
    grids : dict of str to Grid or Tie
        By the path of the number that varies.
    numbers : dict of str to None
        Paths of all numbers that can vary, in the order of reading.
    mistakes : dict of str to str
        The first mistake at each path.
    """

    grids: dict[str, Grid | Tie]
    numbers: dict[str, None] = dataclasses.field(default_factory=dict)
    mistakes: dict[str, str] = dataclasses.field(default_factory=dict)

    @property
    def axes(self) -> list[Grid]:
        """The grids in the order of their axes, without the ties."""
        return [grid for grid in self.grids.values() if isinstance(grid, Grid)]


class Table:
    """One table of the file, at its path; "" is the whole file."""

    def __init__(self, reading: Reading, path: str, data: dict[str, Any]) -> None:
        """Keep the path and the entries of a table, and what is read of the whole file.

        No key counts as known yet.
        """
        self.reading = reading
        self.path = path
        self.data = data
        self.keys: dict[str, None] = {}  # known: asked for up to now, in this order

    def where(self, key: str) -> str:
        """Path of an entry in the file: "bodies.0.length"."""
        if not self.path:
            return key
        return f"{self.path}.{key}"

    def note_mistake(
        self, key: str, message: str, word: Any = "", choices: Collection[str] = ()
    ) -> None:
        """Note a mistake at a key of this table.

        With `choices`, the one nearest to `word` is named behind the message, unless
        `MOST_TOLD` mistakes are noted already. An entry has one mistake: further ones
        follow from the first, and are dropped.
        """
        mistakes = self.reading.mistakes
        is_shown = len(mistakes) < MOST_TOLD
        if choices and is_shown:  # the nearest takes long to find
            message = f"{message}; {nearest(word, choices)}"
        mistakes.setdefault(self.where(key), message)

    def has(self, key: str) -> bool:
        """Whether the file has this entry; from now on its key counts as known."""
        self.keys[key] = None
        return key in self.data

    def get(self, key: str, default: Any = None) -> Any:
        """What the file has at this key, else the default.

        From now on the key counts as known.
        """
        self.keys[key] = None
        return self.data.get(key, default)

    def grid_or_tie(self, key: str) -> Grid | Tie | None:
        """The grid or the tie in place of this number; None if there is none.

        Its path is noted as one that can vary.
        """
        path = self.where(key)
        self.reading.numbers[path] = None
        return self.reading.grids.get(path)

    def has_or_varies(self, key: str) -> bool:
        """Whether this number is in the file, or a grid or a tie in its place.

        Its path is noted as one that can vary.
        """
        varying = self.grid_or_tie(key)
        return self.has(key) or varying is not None

    def given_numbers(self, kind: Any, without: Collection[str] = ()) -> dict[str, Any]:
        """Numbers of the class `kind` that are given, varied, or required, by key.

        They are the arguments of its constructor, in SI units. A required one that is
        missing is noted, and nan; an optional one is left out, as those named in
        `without` are.
        """
        numbers = {}
        for key, field in kind.fields.items():
            if key in without:
                continue
            if field.many:  # a list, whose items may vary, but not itself
                is_given = self.has(key)
            else:
                is_given = self.has_or_varies(key)
            if is_given or field.default is REQUIRED:
                numbers[key] = self.number(key, field)
        return numbers

    def number(self, key: str, field: QuantityField) -> Any:
        """A number, an array where it varies, a list, a profile, or a word.

        The field tells which of these may be there, and whether infinity may. Numbers
        are in SI units. A missing or wrong entry is noted; then a number is nan, a list
        or a word None, and a profile 1.
        """
        if field.many:
            return self.number_list(key, field.dimension)
        value = self.get(key)
        # A `Grid` or a `Tie` of this path takes the place of the entry.
        value = self.reading.grids.get(self.where(key), value)
        may_be_profile = field.along != ""  # along a rod or in time
        if may_be_profile and isinstance(value, dict):
            return self.profile(key, field)
        if field.word and isinstance(value, str) and value[:1].isalpha():
            # A text that begins with a letter is no number with a unit.
            return self.word(key, (field.word,))
        may_be_infinite = "infinite" in field.sign  # such as "positive or infinite"
        if may_be_infinite and value in ("inf", math.inf):
            return math.inf
        if value is None:
            choices = ", ".join(units.UNITS.get(field.dimension, ()))
            units_hint = ""
            if choices:
                units_hint = f" or text with one of {choices}"
            self.note_mistake(key, f"is missing; give a number in SI units{units_hint}")
            return math.nan
        profile_hint = PROFILE_SYNTAX.get(field.along, "")
        return self.quantity(key, value, field.dimension, profile_hint)

    def quantity(self, key: str, value: Any, dimension: str, hint: str = "") -> Any:
        """The `value` at a key in SI units: a float, or the array of a grid or a tie.

        A float is made of a number or of a text with a unit of the dimension, such as
        "length". For anything else a mistake is noted, and the result is nan. `hint` is
        added to the mistake for a list in place of a number that can vary.
        """
        try:
            if isinstance(value, Grid | Tie):
                return value.array(dimension)
            return units.parse(value, dimension)
        except ValueError as error:
            path = self.where(key)
            message = str(error)
            # A list is perhaps meant as a profile, or as the values of a grid.
            can_vary = path in self.reading.numbers
            if isinstance(value, list) and can_vary:
                message += f'{hint} vary={{"{path}": "start:stop:count"}} varies it'
            self.note_mistake(key, message)
            return math.nan

    def number_list(self, key: str, dimension: str, vary: bool = True) -> Any:
        """The list at a key as floats in SI units, of a dimension such as "length".

        With `vary` a grid or a tie may take the place of an item, which becomes its
        array. An item with a mistake is nan. For anything but a list the result is
        None. All mistakes are noted.
        """
        values = self.get(key)
        if not isinstance(values, list):
            message = f"must be a list of numbers, got {shown(values)}"
            if values is None:
                message = "is missing; give a list of numbers"
            self.note_mistake(key, message)
            return None
        numbers = []
        for i, value in enumerate(values):
            item_key = f"{key}.{i}"
            if vary:
                varying = self.grid_or_tie(item_key)
                if varying is not None:
                    value = varying
            numbers.append(self.quantity(item_key, value, dimension))
        return numbers

    def profile(self, key: str, field: QuantityField) -> Any:
        """The profile that the table at a key describes; 1 if it has mistakes.

        It is `Samples` if the table has the entry ``samples``, `Polynomials` if it has
        ``polynomials`` and is along a rod, and else `Steps`. Mistakes are noted.
        """
        table = self.table(key)
        if table.has("samples"):
            entries = {
                "values": table.number_list("samples", field.dimension, vary=False)
            }
            if field.along == "time":
                # Unlike samples, the step can vary: the call notes its path.
                table.has_or_varies("step")
                entries["step"] = table.number("step", SAMPLE_STEP)
            for name in CURVE_KEYS:  # "smooth" and "error", as they are
                if table.has(name):
                    entries[name] = table.get(name)
            profile = table.make_or_note(Samples, KEYS_OF_SAMPLE_PATHS, **entries)
        elif table.has("polynomials") and field.along == "length":
            entries = {
                "values": table.number_list("polynomials", field.dimension, vary=False)
            }
            if table.has("at"):
                entries["at"] = table.number_list("at", field.along, vary=False)
            if table.has("error"):
                error = table.get("error")
                entries["error"] = table.quantity("error", error, field.dimension)
            profile = table.make_or_note(Polynomials, POLYNOMIAL_KEYS, **entries)
        else:
            values = table.number_list("values", field.dimension)
            jumps = table.number_list("at", field.along)
            profile = table.make_or_note(Steps, values=values, at=jumps)
        table.note_unknown_keys()
        if profile is None:
            return 1.0  # any number: the mistakes are noted
        return profile

    def word(
        self, key: str, choices: Collection[str], default: str | None = None
    ) -> str | None:
        """The word at a key, one of the choices; the default if there is none.

        For anything else, or none without a default, a mistake is noted, and the result
        is None.
        """
        value = self.get(key, default)
        if isinstance(value, str) and value in choices:
            return value
        if value is None:
            self.note_mistake(key, f"is missing; use one of {listed(list(choices))}")
        else:
            self.note_mistake(key, f"unknown {key} {shown(value)}", value, choices)
        return None

    def table(self, key: str) -> Table:
        """The table of that name; an empty one if there is none.

        Anything else is noted as a mistake, and gives an empty table whose mistakes are
        not noted in this file.
        """
        data = self.get(key, {})
        if isinstance(data, dict):
            return Table(self.reading, self.where(key), data)
        self.note_mistake(key, f"must be a table, got {shown(data)}")
        # Further mistakes go into a reading of their own, which nobody sees.
        unseen = Reading(grids={})
        return Table(unseen, self.where(key), {})

    def tables(self, key: str) -> list[Table]:
        """All tables of that name, in their order; [] if there is none.

        Anything but a list of tables is noted as a mistake, and gives [].
        """
        items = self.get(key, [])
        is_valid = isinstance(items, list)
        if is_valid:
            is_valid = all(isinstance(item, dict) for item in items)
        if not is_valid:
            # A header names no index: [[bodies.segments]] for bodies.0.segments
            header = re.sub(r"\.\d+", "", self.where(key))
            message = f"must be tables that each begin [[{header}]]"
            self.note_mistake(key, f"{message}, got {shown(items)}")
            items = []
        tables = []
        for i, item in enumerate(items):
            tables.append(Table(self.reading, self.where(f"{key}.{i}"), item))
        return tables

    def read_object(self, kind: Any, **entries: Any) -> Any:
        """The object of the class `kind` that this table describes.

        Its numbers are read here; `entries` are its other arguments. It is None if it
        has mistakes. They are noted, and so are unknown keys.
        """
        numbers = self.given_numbers(kind)
        numbers.update(entries)
        built = self.make_or_note(kind, **numbers)
        self.note_unknown_keys()
        return built

    def make_or_note(
        self, kind: Any, names: Mapping[str, str] = SAME_NAMES, /, **entries: Any
    ) -> Any:
        """What `kind`, a class or another callable, makes of these entries.

        If it raises InvalidModel, its mistakes are noted at paths in this table, and
        the result is None. Where the model has other names than the file, `names` has
        patterns of the model's paths, and their replacements.
        """
        try:
            return kind(**entries)
        except InvalidModel as error:
            for path, message in error.problems:
                for pattern, name in names.items():
                    path = re.sub(pattern, name, path)
                self.note_mistake(path, message)
            return None

    def note_unknown_keys(self) -> None:
        """Note every entry that was not asked for, with the nearest known key.

        For a key that belongs to another table, this table is named instead.
        """
        for key in self.data:
            if key in self.keys:
                continue
            if key in PLACE_OF_KEY:
                message = f"unknown key here; it belongs to {PLACE_OF_KEY[key]}"
                self.note_mistake(key, message)
            else:
                self.note_mistake(key, "unknown key", key, self.keys)
